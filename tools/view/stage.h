/* stage.h: one renderer, the blocks that it lives in, and the picture that it draws.
 *
 *   block       host memory, from malloc            \ kept from one start to the next where they are
 *   blocks[]    device memory, one per role          / large enough, else exchanged for larger ones
 *   target      an RGBA8 storage image of the output size, in TRANSFER_SRC_OPTIMAL between frames
 *
 * A start with another description is how a setting, a size or a scene changes: masu_destroy, then
 * masu_init in the same blocks. A description that cannot be is refused before anything is destroyed. */
#ifndef MASU_VIEW_STAGE_H
#define MASU_VIEW_STAGE_H

#include "headless.h"
#include "masu.h"

typedef struct masu_stage {
    masu_headless *host; /* NULL: it was never started */
    masu_renderer *m;    /* NULL: there is none now */
    masu_desc desc;      /* that m was made from; `scene` is the viewer's */
    masu_memory need;    /* of m */
    masu_detail detail;  /* of the last failure */
    void *block;
    uint64_t block_bytes;
    masu_device_block blocks[MASU_ROLE_COUNT];
    masu_headless_target target;
    double start_ms;       /* how long the last start took, masu_init and masu_load */
    double init_ms;        /* masu_init alone */
    bool in_place;         /* it fitted into the blocks that were there */
    uint64_t frames;       /* handed out since the last start */
    masu_commands last;    /* of the newest one */
} masu_stage;

/* Everything of `desc` but targets and device blocks is given; the blob of its scene is readable. The
 * device is idle. On false `error` holds one line; s->m is NULL if nothing could be kept, else the
 * renderer of before, untouched. */
bool masu_stage_start(masu_stage *s, masu_headless *host, const masu_desc *desc, char *error,
                      size_t size);

/* Another size, up to that of the last start: the target is made anew, the renderer stays (masu_resize).
 * False with s->m as it was: it takes a start, or, with s->m NULL, there is nothing left but that. The device
 * is idle. */
bool masu_stage_resize(masu_stage *s, VkExtent2D output, char *error, size_t size);

/* Frees all of it; harmless on a zeroed struct. The device is idle. */
void masu_stage_close(masu_stage *s);

#endif

/* stage.h: one renderer with its memory blocks and its target image.
 *
 *   block       host memory, from malloc            \ kept from one start to the next if they are
 *   blocks[]    device memory, one per role          / large enough, else replaced by larger ones
 *   target      an RGBA8 storage image of the output size, in TRANSFER_SRC_OPTIMAL between frames
 *
 * A new setting, size or scene is a start with another description: masu_destroy, then masu_init in
 * the same blocks. An invalid description is rejected before anything is destroyed. */
#ifndef MASU_VIEW_STAGE_H
#define MASU_VIEW_STAGE_H

#include "headless.h"
#include "masu.h"

typedef struct masu_stage {
    masu_headless *host; /* NULL: never started */
    masu_renderer *m;    /* NULL: no renderer */
    masu_desc desc;      /* of m; `scene` belongs to the viewer */
    masu_memory need;    /* of m */
    masu_detail detail;  /* of the last failure */
    void *block;
    uint64_t block_bytes;
    masu_device_block blocks[MASU_ROLE_COUNT];
    masu_headless_target target;
    double start_ms;       /* duration of the last start, with masu_init and masu_load */
    double init_ms;        /* duration of masu_init */
    bool in_place;         /* the last start fitted into the existing blocks */
    uint64_t frames;       /* rendered since the last start */
    masu_commands last;    /* of the newest frame */
} masu_stage;

/* `desc` is complete except for targets and device blocks; the blob of its scene is readable. The
 * device is idle. On false `error` holds one line; s->m is the unchanged previous renderer, or NULL
 * if it could not be kept. */
bool masu_stage_start(masu_stage *s, masu_headless *host, const masu_desc *desc, char *error,
                      size_t size);

/* Changes the size, up to the size of the last start: recreates the target and keeps the renderer
 * (masu_resize). On false a start is needed; s->m is unchanged or NULL. The device is idle. */
bool masu_stage_resize(masu_stage *s, VkExtent2D output, char *error, size_t size);

/* Frees everything; harmless on a zeroed struct. The device is idle. */
void masu_stage_close(masu_stage *s);

#endif

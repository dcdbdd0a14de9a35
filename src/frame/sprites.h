/* sprites.h: a frame's particles, decals and debug lines. masu_frame reads the host's arrays and
 * writes them to the slot's part of one buffer (layout in masu_shared.h). Recordings contain
 * indirect draws and a dispatch, whose counts are in the same buffer. Empty and without work if
 * desc.reserve has none. */
#ifndef MASU_SPRITES_H
#define MASU_SPRITES_H

#include "frame/frame_data.h"
#include "frame/transparents.h"

/* How many of each a slot's frame draws. */
typedef struct masu_sprite_counts {
    uint32_t particles, decals, lines, segments;
} masu_sprite_counts;

typedef struct masu_sprites {
    masu_back_to_front *order; /* twice the particles and trail points of desc.reserve */
    masu_sprite_counts slots[MASU_MAX_FLIGHT];
} masu_sprites;

void masu_sprites_alloc(masu_sprites *s, masu_arena *arena, const masu_frame_plan *plan);

/* MASU_ERROR_LIMIT: more than desc.reserve. MASU_ERROR_ARGUMENT: NULL with a count. */
masu_result masu_sprites_check(const masu_desc *d, const masu_frame_desc *frame,
                               masu_detail *detail);

/* After masu_transparents_write, which chooses the transparents that are drawn between the
 * particles. */
void masu_sprites_write(masu_sprites *s, const masu_transparents *transparents,
                        const masu_frame_data *f);

#endif

/* sprites.h: what a frame brings with it: particles, decals, debug lines. The host's arrays are read in masu_frame and
 * written to the slot's part of one buffer, whose layout masu_shared.h has; recordings hold indirect draws and a
 * dispatch whose counts lie there too. Of no length and no work where desc.reserve has none. */
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
masu_result masu_sprites_check(const masu_desc *d, const masu_frame_desc *frame, masu_detail *detail);

/* After masu_transparents_write, which says what is drawn among the particles. */
void masu_sprites_write(masu_sprites *s, const masu_transparents *transparents, const masu_frame_data *f);

#endif

/* sprite_kinds.h: one writer each for particles, decals and debug lines: writes the visible
 * elements of the host's arrays to the slot, in the shaders' layout. sprites.c calls the writers
 * and owns their memory; no writer can fail. */
#ifndef MASU_SPRITE_KINDS_H
#define MASU_SPRITE_KINDS_H

#include "frame/frame_data.h"
#include "frame/transparents.h"

#include <math.h>

typedef struct masu_sprite_eye {
    double at[3];
    double right[3], up[3], forward[3]; /* unit */
    double tan_x, tan_y, near_distance;
    double middle[2]; /* of the image, in units of the tangents: 0, 0 except with a custom window */
} masu_sprite_eye;

/* A point in camera space: x to the right, y up, z ahead; sheared for off-axis windows so that
 * the image centre is at x = y = 0. */
static inline void masu_to_eye(const masu_sprite_eye *e, const double rel[3], double out[3]) {
    out[0] = rel[0] * e->right[0] + rel[1] * e->right[1] + rel[2] * e->right[2];
    out[1] = rel[0] * e->up[0] + rel[1] * e->up[1] + rel[2] * e->up[2];
    out[2] = rel[0] * e->forward[0] + rel[1] * e->forward[1] + rel[2] * e->forward[2];
    out[0] -= e->middle[0] * e->tan_x * out[2];
    out[1] += e->middle[1] * e->tan_y * out[2];
}

/* No number becomes the lower bound. */
static inline float masu_clamped(float v, float low, float high) {
    return !(v > low) ? low : v > high ? high : v;
}

/* Whether a cell of a texture has only numbers. */
static inline int masu_is_cell(const float uv[4]) {
    return isfinite(uv[0]) && isfinite(uv[1]) && isfinite(uv[2]) && isfinite(uv[3]);
}

/* A cell to two corners within 0..1; of all 0 the whole texture. */
static inline void masu_cell_write(const float uv[4], float to[4]) {
    static const float whole[4] = {0.0f, 0.0f, 1.0f, 1.0f};
    int none = 1;
    for (uint32_t k = 0; k < 4; k++) none &= uv[k] == 0.0f;
    for (uint32_t k = 0; k < 4; k++) to[k] = none ? whole[k] : masu_clamped(uv[k], 0.0f, 1.0f);
}

/* Each writes its elements to `to` and returns their number. draws: of the particles, before
 * each slot of transparents and after the last; *segments: the number of trail segments in the
 * result. part: the smallest rectangle of pixels around all decals: x, y, width, height. */
uint32_t masu_particles_write(const masu_frame_data *f, const masu_sprite_eye *eye,
                              masu_back_to_front *order, const masu_back_to_front *blended,
                              uint32_t blended_count, VkDrawIndirectCommand *draws,
                              unsigned char *to, uint32_t *segments);
/* Segments of trails. masu_trails_sort appends the visible segments to `order`, with the index
 * of their first point among all points plus desc.reserve.particles, and returns their number.
 * masu_trails_write writes segment i as particle places[i].thing; UINT32_MAX: not drawn. */
uint32_t masu_trails_sort(const masu_frame_data *f, const masu_sprite_eye *eye,
                          masu_back_to_front *order);
void masu_trails_write(const masu_frame_data *f, const masu_sprite_eye *eye,
                       const masu_back_to_front *places, unsigned char *to);
uint32_t masu_decals_write(const masu_frame_data *f, const masu_sprite_eye *eye, unsigned char *to,
                           uint32_t part[4]);
uint32_t masu_debug_lines_write(const masu_frame_data *f, const masu_sprite_eye *eye,
                                unsigned char *to);

#endif

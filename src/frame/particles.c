/* particles.c: writes particles to the slot, the farthest first, interleaved with transparent
 * surfaces.
 *
 * Both are sorted by the same key. The recording has a draw of particles before each slot of
 * transparents (transparents.c) and one after the last; each draws the particles between two
 * transparents as vertices from 6 * first on: firstInstance is always 0, since other values
 * would need the feature drawIndirectFirstInstance. */
#include "frame/sprite_kinds.h"

#include <math.h>
#include <string.h>

static const double farthest = 1e15;
static const float largest = 1e9f, brightest = 4096.0f;

/* The squared distance of a visible particle; negative: culled. */
static double square_of(const masu_particle *p, const masu_sprite_eye *eye) {
    double rel[3], seen[3];
    int fine = isfinite(p->half_width) && isfinite(p->half_height) && isfinite(p->rotation) &&
               isfinite(p->opacity) && isfinite(p->edge) && isfinite(p->soft);
    if (p->texture)
        fine &= masu_is_cell(p->uv) && isfinite(p->uv_next[0]) && isfinite(p->uv_next[1]) &&
                isfinite(p->blend);
    for (uint32_t k = 0; k < 3; k++) {
        fine &= fabs(p->position[k]) <= farthest && isfinite(p->color[k]);
        rel[k] = p->position[k] - eye->at[k];
    }
    if (!fine || !(p->half_width > 0.0f) || p->half_height < 0.0f || !(p->opacity > 0.0f))
        return -1.0;
    masu_to_eye(eye, rel, seen);
    if (!(seen[2] > eye->near_distance)) return -1.0;
    return rel[0] * rel[0] + rel[1] * rel[1] + rel[2] * rel[2];
}

static void write_particle(const masu_particle *p, const masu_sprite_eye *eye, uint32_t bytes,
                           unsigned char *to) {
    float v[4 * MASU_TEXTURED_PARTICLE_VEC4S] = {0};
    const uint32_t flags = p->flags & (MASU_PARTICLE_LIT | MASU_PARTICLE_ADDITIVE);
    double turn = fmod((double)p->rotation, 6.283185307179586);
    for (uint32_t k = 0; k < 3; k++) {
        v[k] = (float)(p->position[k] - eye->at[k]);
        v[8 + k] = masu_clamped(p->color[k], 0.0f, brightest);
    }
    v[3] = masu_clamped(p->soft, 0.0f, largest);
    v[4] = masu_clamped(p->half_width, 0.0f, largest);
    v[5] = p->half_height > 0.0f ? masu_clamped(p->half_height, 0.0f, largest) : v[4];
    v[6] = (float)cos(turn);
    v[7] = (float)sin(turn);
    v[11] = masu_clamped(p->opacity, 0.0f, 1.0f);
    memcpy(&v[12], &flags, sizeof flags);
    v[13] = masu_clamped(p->edge, 0.0f, 1.0f);
    if (p->texture) {
        memcpy(&v[14], &p->texture, sizeof p->texture);
        v[15] = masu_clamped(p->blend, 0.0f, 1.0f);
        masu_cell_write(p->uv, &v[16]);
        for (uint32_t k = 0; k < 2; k++) v[20 + k] = masu_clamped(p->uv_next[k], 0.0f, 1.0f);
    }
    memcpy(to, v, bytes);
}

uint32_t masu_particles_write(const masu_frame_data *f, const masu_sprite_eye *eye,
                              masu_back_to_front *order, const masu_back_to_front *blended,
                              uint32_t blended_count, VkDrawIndirectCommand *draws,
                              unsigned char *to, uint32_t *segments) {
    const masu_particle *particles = f->desc.particles;
    const masu_reserve *r = &f->plan->desc.reserve;
    const uint32_t bytes = f->plan->sprites.particle * (uint32_t)sizeof(masu_vec4);
    uint32_t count = 0, next = 0, slots = f->plan->scene.transparents;
    for (uint32_t i = 0; i < f->desc.particle_count; i++) {
        double square = square_of(&particles[i], eye);
        if (square >= 0.0) order[count++] = (masu_back_to_front){(float)fmin(square, 3e38), i};
    }
    *segments = masu_trails_sort(f, eye, order + count);
    count += *segments;
    masu_back_to_front *scratch = order + r->particles + r->trail_points;
    const masu_back_to_front *sorted = masu_sort_back_to_front(order, scratch, count);
    masu_back_to_front *places = sorted == order ? scratch : order; /* the other half is free */
    for (uint32_t i = 0; i < r->trail_points; i++) places[i].thing = UINT32_MAX;
    for (uint32_t k = 0; k < count; k++) {
        uint32_t thing = sorted[k].thing;
        if (thing < r->particles)
            write_particle(&particles[thing], eye, bytes, to + (size_t)k * bytes);
        else
            places[thing - r->particles].thing = k;
    }
    if (*segments) masu_trails_write(f, eye, places, to);
    for (uint32_t k = 0; k <= slots; k++) {
        uint32_t first = next;
        if (k == slots) next = count;
        while (k < blended_count && next < count && sorted[next].key > blended[k].key) next++;
        const VkDrawIndirectCommand draw = {6 * (next - first), 1, 6 * first, 0};
        memcpy(&draws[k], &draw, sizeof draw);
    }
    return count;
}

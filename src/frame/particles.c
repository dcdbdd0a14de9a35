/* particles.c: particles to the slot, the farthest first, and among what is blended.
 *
 * Both are sorted by the same key. The recording has a draw of particles before each slot of what is blended
 * (transparents.c) and one behind the last; each draws the run of them that lies between, as vertices from
 * 6 * first on: firstInstance stays 0, since another one would need the feature drawIndirectFirstInstance. */
#include "frame/sprite_kinds.h"

#include <math.h>
#include <string.h>

static const double farthest = 1e15;
static const float largest = 1e9f, brightest = 4096.0f;

/* Of one that is drawn the square of its distance, else below 0. */
static double square_of(const masu_particle *p, const masu_sprite_eye *eye) {
    double rel[3], seen[3];
    int fine = isfinite(p->half_width) && isfinite(p->half_height) && isfinite(p->rotation) &&
               isfinite(p->opacity) && isfinite(p->edge) && isfinite(p->soft);
    for (uint32_t k = 0; k < 3; k++) {
        fine &= fabs(p->position[k]) <= farthest && isfinite(p->color[k]);
        rel[k] = p->position[k] - eye->at[k];
    }
    if (!fine || !(p->half_width > 0.0f) || p->half_height < 0.0f || !(p->opacity > 0.0f)) return -1.0;
    masu_to_eye(eye, rel, seen);
    if (!(seen[2] > eye->near_distance)) return -1.0;
    return rel[0] * rel[0] + rel[1] * rel[1] + rel[2] * rel[2];
}

static void write_particle(const masu_particle *p, const masu_sprite_eye *eye, unsigned char *to) {
    float v[4 * MASU_PARTICLE_VEC4S] = {0};
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
    memcpy(to, v, sizeof v);
}

uint32_t masu_particles_write(const masu_frame_data *f, const masu_sprite_eye *eye, masu_back_to_front *order,
                              const masu_back_to_front *blended, uint32_t blended_count,
                              VkDrawIndirectCommand *draws, unsigned char *to) {
    const masu_particle *particles = f->desc.particles;
    uint32_t count = 0, next = 0, slots = f->plan->scene.transparents;
    for (uint32_t i = 0; i < f->desc.particle_count; i++) {
        double square = square_of(&particles[i], eye);
        if (square >= 0.0) order[count++] = (masu_back_to_front){(float)fmin(square, 3e38), i};
    }
    const masu_back_to_front *sorted = masu_sort_back_to_front(order, order + f->plan->desc.reserve.particles, count);
    for (uint32_t k = 0; k < count; k++)
        write_particle(&particles[sorted[k].thing], eye, to + k * MASU_PARTICLE_VEC4S * sizeof(masu_vec4));
    for (uint32_t k = 0; k <= slots; k++) {
        uint32_t first = next;
        if (k == slots) next = count;
        while (k < blended_count && next < count && sorted[next].key > blended[k].key) next++;
        const VkDrawIndirectCommand draw = {6 * (next - first), 1, 6 * first, 0};
        memcpy(&draws[k], &draw, sizeof draw);
    }
    return count;
}

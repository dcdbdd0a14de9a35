/* temporal.c: see temporal.h. */
#include "frame/temporal.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Frames for which a change may affect the history: enough to put samples all over a pixel, and
 * as long as a cascade of the shadow map may take to show it. */
#define SETTLING 16u

static uint32_t settling(const masu_frame_data *f) {
    const masu_rung *rung = masu_frame_rung(f);
    uint32_t most = 0;
    for (uint32_t k = 0; k < MASU_MAX_CASCADES && masu_frame_rung_plan(f)->slow; k++)
        most = rung->shadow_refresh[k] > most ? rung->shadow_refresh[k] : most;
    return SETTLING + most;
}

/* Whether two rungs differ only in render size. */
static int shows_the_same(const masu_rung *a, const masu_rung *b) {
    masu_rung other = *b;
    other.scale = a->scale;
    other.upscale = a->upscale;
    other.easu = a->easu;
    other.sharpen = a->sharpen;
    other.sharpness = a->sharpness;
    return memcmp(a, &other, sizeof other) == 0;
}

/* The digits of n, mirrored at the point (J. Halton, "Algorithm 247: Radical-inverse
 * quasi-random point sequence", 1964). */
static float mirrored(uint32_t n, uint32_t base) {
    double value = 0.0, digit = 1.0;
    for (; n; n /= base) {
        digit /= base;
        value += digit * (n % base);
    }
    return (float)value;
}

static int has_resolve(const masu_frame_data *f) {
    return masu_has_pass(&masu_frame_rung_plan(f)->active, MASU_PASS_TEMPORAL_FIND);
}

/* From 1 on: the first point of Halton's sequence is the corner. */
void masu_temporal_place(VkExtent2D render, VkExtent2D shown, uint64_t frame, float place[2]) {
    double pixels = (double)render.width * render.height;
    double phases = fmin(ceil(16.0 * shown.width * shown.height / pixels), 1024.0);
    uint32_t phase = (uint32_t)(frame % (uint64_t)phases);
    place[0] = mirrored(phase + 1, 2) - 0.5f;
    place[1] = mirrored(phase + 1, 3) - 0.5f;
}

float masu_temporal_jitter(const masu_frame_data *f, float jitter[2]) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    jitter[0] = jitter[1] = 0.0f;
    if (!has_resolve(f)) return 0.0f;
    masu_temporal_place((VkExtent2D){rp->render_width, rp->render_height}, f->plan->desc.output,
                        f->number, jitter);
    return 0.5f;
}

/* Whether the light or the SDF differs from that of the frame before, or is metered and may. */
static int has_changed(const struct masu_frame_uniforms *now,
                       const struct masu_frame_uniforms *before, const masu_frame_plan *plan) {
    size_t from = offsetof(struct masu_frame_uniforms, sun_direction);
    size_t to = offsetof(struct masu_frame_uniforms, air);
    if (plan->needs.metered) return 1;
    if (memcmp((const char *)now + from, (const char *)before + from, to - from) != 0) return 1;
    /* air[0] also depends on the camera. */
    if (memcmp(now->air + 1, before->air + 1, 3 * sizeof *now->air) != 0) return 1;
    float higher = (now->eye_hi[1] - now->air[0]) - (before->eye_hi[1] - before->air[0]);
    if (now->fog[3] > 0.0f && fabsf(higher) > 1e-3f * (1.0f + fabsf(now->eye_hi[1]))) return 1;
    if (plan->needs.timed && now->eye_hi[3] != before->eye_hi[3]) return 1;
    if (memcmp(now->environment, before->environment, sizeof now->environment) != 0 ||
        memcmp(now->background, before->background, sizeof now->background) != 0)
        return 1;
    return memcmp(now->sdf_params, before->sdf_params, sizeof now->sdf_params) != 0;
}

/* Whether the camera has moved since the previous frame: its static sky is then disoccluded. */
static int eye_moves(const struct masu_frame_uniforms *now,
                     const struct masu_frame_uniforms *before) {
    return memcmp(now->eye_hi, before->eye_hi, 3 * sizeof *now->eye_hi) != 0 ||
           memcmp(now->eye_lo, before->eye_lo, 3 * sizeof *now->eye_lo) != 0;
}

/* Or looks elsewhere, or sees more or less. */
static int view_moves(const struct masu_frame_uniforms *now,
                      const struct masu_frame_uniforms *before) {
    return eye_moves(now, before) || memcmp(now->right, before->right, sizeof now->right) != 0 ||
           memcmp(now->up, before->up, sizeof now->up) != 0 ||
           memcmp(now->forward, before->forward, sizeof now->forward) != 0;
}

static uint64_t hash_words(uint64_t hash, const void *data, size_t bytes) {
    for (size_t at = 0; at + 8 <= bytes; at += 8) {
        uint64_t word;
        memcpy(&word, (const char *)data + at, sizeof word);
        hash = (hash ^ word) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 29;
    }
    return hash;
}

_Static_assert(sizeof(masu_particle) == 24 + 18 * sizeof(float) &&
                   sizeof(masu_decal) == 24 + 28 * sizeof(float),
               "whole words, without padding");

/* A number behind 40 bytes, which padding follows. */
static uint64_t hash_odd(uint64_t hash, const void *first, float last) {
    uint32_t bits;
    memcpy(&bits, &last, sizeof bits);
    return hash_words(hash ^ bits, first, 40);
}

_Static_assert(offsetof(masu_trail_point, opacity) == 40 &&
                   offsetof(masu_trail, offset) - offsetof(masu_trail, point_count) == 40,
               "one number is left");

/* Hash of a frame's particles, trails and decals, whose images are in the history like
 * everything else. */
static uint64_t sprites_of(const masu_frame_desc *d) {
    uint64_t hash =
        hash_words(d->particle_count, d->particles, d->particle_count * sizeof *d->particles);
    hash = hash_words(hash ^ d->decal_count, d->decals, d->decal_count * sizeof *d->decals);
    for (uint32_t i = 0; i < d->trail_count; i++) {
        const masu_trail *t = &d->trails[i];
        hash = hash_odd(hash, &t->point_count, t->offset);
        for (uint32_t k = 0; k < t->point_count; k++)
            hash = hash_odd(hash, &t->points[k], t->points[k].opacity);
    }
    return hash;
}

/* For an output of twice the size, along axis k: positions of output pixels between texels, and
 * the texels' weights, by the tent filters of shaders/temporal.comp. */
static void find_between(struct masu_frame_uniforms *u, int k) {
    /* An odd pixel is a quarter of a texel after a texel's centre, without jitter. The first of
     * two pixels is the one whose partner is before the next texel. */
    float odd = 0.25f - u->shifts[k], lies = odd - floorf(odd) < 0.5f ? odd : odd + 0.5f;
    float before = floorf(lies), off = lies - before;
    u->between[k] = lies == odd ? 1 : 2;
    u->between[2 + k] = (uint32_t)((int32_t)before - 1);
    masu_vec4 *pixels = k == 0 ? u->columns : u->rows;
    for (int i = 0; i < 2; i++) {
        float f = off + 0.5f * (float)i;
        pixels[i][0] = f;
        pixels[i][1] = fminf(fmaxf(1.5f - 4.0f * (i == 0 ? f : 1.0f - f), 0.0f), 1.0f);
        pixels[i][2] = fmaxf(1.0f - 1.6f * f, 0.0f);
        pixels[i][3] = fmaxf(1.0f - 1.6f * (1.0f - f), 0.0f);
    }
}

void masu_temporal_read(masu_temporal *t, const masu_history *history, const masu_instances *in,
                        const masu_lights *lights, const masu_materials *materials,
                        const masu_textures *textures, const masu_post_state *post,
                        masu_frame_data *f) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    int kept = t->kept && !f->cut;
    if (!kept) t->changed = 0;
    t->kept = has_resolve(f) || masu_has_pass(&rp->active, MASU_PASS_SPECULAR_TEMPORAL);
    if (!t->kept) return;
    uint64_t sprites = sprites_of(&f->desc);
    const float size[2] = {(float)rp->render_width, (float)rp->render_height};
    for (int k = 0; k < 2; k++) {
        f->u.shifts[k] = 0.5f * f->u.jitter[2 + k] * size[k];
        f->u.shifts[2 + k] =
            kept ? 0.5f * (history->previous->jitter[2 + k] - f->u.jitter[2 + k]) * size[k] : 0.0f;
        find_between(&f->u, k);
    }
    if (kept) {
        int changed = has_changed(&f->u, history->previous, f->plan) ||
                      t->instances != in->changes + in->looks.changes ||
                      t->lights != lights->changes || t->sprites != sprites ||
                      t->materials != materials->changes || t->post != post->changes ||
                      textures->count || f->desc.textures_changed ||
                      !shows_the_same(masu_frame_rung(f), &f->plan->desc.rungs[t->rung]);
        t->changed = changed ? settling(f) : t->changed ? t->changed - 1 : 0;
        f->u.temporal[0] = t->size[0];
        f->u.temporal[1] = t->size[1];
        f->u.temporal[2] =
            (t->changed || eye_moves(&f->u, history->previous) ? MASU_TEMPORAL_CHANGES : 0) |
            (view_moves(&f->u, history->previous) ? MASU_TEMPORAL_MOVES : 0);
    }
    t->size[0] = has_resolve(f) ? rp->render_width : 0;
    t->size[1] = has_resolve(f) ? rp->render_height : 0;
    t->lights = lights->changes;
    t->materials = materials->changes;
    t->post = post->changes;
    t->instances = in->changes + in->looks.changes;
    t->sprites = sprites;
    t->rung = f->desc.rung;
}

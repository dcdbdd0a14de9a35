/* push.c: see push.h. */
#include "plan/push.h"

#include "plan/output.h"
#include "quality/knobs.h"

#include <math.h>
#include <string.h>

static int is_temporal(const masu_push_input *in) {
    return masu_has_pass(&in->plan->rungs[in->rung].active, MASU_PASS_TEMPORAL_FIND);
}

/* At a lower render size, mips as fine as for the output size, because EASU cannot restore detail
 * that is missing. Temporal upscaling averages samples all over a pixel, each of which may cover
 * only a part of the pixel: two mips finer have the lowest error for a stationary camera, and at
 * full size in motion (docs/design/17-temporal-upscaling.md). */
static float masu_mip_bias(const masu_push_input *in) {
    const masu_desc *d = &in->plan->desc;
    const masu_rung *rung = &d->rungs[in->rung];
    float own = log2f(rung->scale) - (is_temporal(in) ? 2.0f : 0.0f);
    return (d->debug.no_bias ? 0.0f : own) + d->debug.mip_bias;
}

/* Mip levels that gbuffer.frag adds back in proportion to the speed of a pixel, up to 2.3 times
 * this value: the levels that the render scale has subtracted. Moving pixels accumulate few
 * samples, and detail that these do not average is noise. */
static float masu_mip_moving(const masu_push_input *in) {
    const masu_desc *d = &in->plan->desc;
    return is_temporal(in) && !d->debug.no_bias ? -log2f(d->rungs[in->rung].scale) : 0.0f;
}

/* Largest output value, in units of white. */
static float masu_peak(const masu_targets *t) {
    return t->encoding == MASU_ENCODING_SRGB ? 1.0f : t->peak / t->white;
}

/* Whether the output size equals the render size. */
static int shows_each_pixel(const masu_push_input *in) {
    const masu_rung_plan *rp = &in->plan->rungs[in->rung];
    return rp->render_width == in->plan->desc.output.width &&
           rp->render_height == in->plan->desc.output.height;
}

/* Sharpening of rung.temporal (shaders/upscale/history.glsl), for a stationary and a moving
 * view. */
static float calm_sharpening(const masu_rung *r) { return 0.03f - 0.02f * r->scale; }
static float moving_sharpening(const masu_rung *r) { return 0.22f - 0.15f * r->scale; }

/* Largest coordinate for a linear fetch, with texel centres at the integers. Samplers round to
 * 1/256, so a fetch at the last centre would also read the texel behind it. */
static float last_place(uint32_t size) { return (float)size - 1.005f; }

/* The depth image that a pass reads. It has the size of the largest rung with this image, which may
 * differ from other images. */
static const masu_image_plan *depth_of(const masu_push_input *in) {
    const masu_rung_plan *rp = &in->plan->rungs[in->rung];
    for (uint32_t a = 0; a < rp->access_count[in->pass]; a++) {
        uint32_t image = rp->access[in->pass][a].image;
        if (rp->access[in->pass][a].usage == MASU_READ && image < MASU_IMAGE_COUNT &&
            masu_images[image].class_of == MASU_CLASS_DEPTH)
            return &in->plan->images[image];
    }
    return &in->plan->images[MASU_IMAGE_SCENE_DEPTH];
}

/* Second texture coordinates and colours of vertices in TEXCOORDS, in 32-bit values; 0: none. */
static uint32_t masu_second_texcoords_at(const masu_push_input *in) {
    const masu_scene_data *s = &in->plan->scene;
    return s->second_texcoords ? (uint32_t)(masu_texcoord_layout(s).second / 4) : 0;
}

static uint32_t masu_vertex_colors_at(const masu_push_input *in) {
    const masu_scene_data *s = &in->plan->scene;
    return s->vertex_colors ? (uint32_t)(masu_texcoord_layout(s).colors / 4) : 0;
}

/* Per SMAA preset: the luma threshold in the steps of smaa/color.glsl, the search steps, and the
 * diagonal search steps. */
static float masu_smaa_threshold(masu_aa aa) {
    static const float thresholds[] = {0.15f, 0.1f, 0.1f, 0.05f};
    return 2550000.0f * thresholds[aa - MASU_AA_SMAA_LOW];
}

static uint32_t masu_smaa_steps(masu_aa aa) {
    static const uint32_t steps[] = {4, 8, 16, MASU_SMAA_STEPS_MAX};
    return steps[aa - MASU_AA_SMAA_LOW];
}

static uint32_t masu_smaa_diagonal_steps(masu_aa aa) {
    static const uint32_t steps[] = {0, 0, 8, MASU_SMAA_DIAGONAL_STEPS_MAX};
    return steps[aa - MASU_AA_SMAA_LOW];
}

/* Output of the march for later passes: 0 none, 1 lists of primitives per tile, 2 also term masks
 * per block (with debug.all_terms, the masks have all terms of the tile). */
static uint32_t march_listed(const masu_rung *r) {
#ifdef MASU_LAB
    masu_needs n = {.march = r->march};
    return masu_march_has_blocks(&n) ? 2 : masu_march_has_tiles(&n) ? 1 : 0;
#else
    (void)r;
    return 2;
#endif
}

/* ---- Rows ------------------------------------------------------------------------------------ */

#define UINT(name, value)                                                                          \
    if (i < MASU_PUSH_OWN) block->own.word[i++] = (uint32_t)(value);
#define FLOAT(name, value)                                                                         \
    if (i < MASU_PUSH_OWN) block->own.real[i++] = (float)(value);
#define PUSH(...) __VA_ARGS__

#define PASS(ID, name, purpose, kind, extent, when, push, ...)                                     \
    static void fill_##name(const masu_push_input *in, masu_push_block *block) {                   \
        const masu_rung *r = &in->plan->desc.rungs[in->rung];                                      \
        const masu_needs *n = &in->plan->needs;                                                    \
        const masu_exposure *e = &in->plan->desc.exposure;                                         \
        const masu_targets *t = &in->plan->desc.targets;                                           \
        uint32_t i = 0;                                                                            \
        (void)r, (void)n, (void)e, (void)t;                                                        \
        push(void) i;                                                                              \
        (void)block;                                                                               \
    }
#include "plan/passes.inc"
#undef PASS
#undef UINT
#undef FLOAT

/* The build fails if a row has more push constants than fit. */
#define UINT(name, value) +1
#define FLOAT(name, value) +1
#define PASS(ID, name, purpose, kind, extent, when, push, ...)                                     \
    _Static_assert(0 push <= MASU_PUSH_OWN, #name ": MASU_PUSH_OWN");
#include "plan/passes.inc"
#undef PASS

static void (*const fills[MASU_PASS_COUNT])(const masu_push_input *in, masu_push_block *block) = {
#define PASS(ID, name, ...) [MASU_PASS_##ID] = fill_##name,
#include "plan/passes.inc"
#undef PASS
};

masu_push_block masu_push_of(const masu_frame_plan *plan, uint32_t rung, uint32_t pass,
                             uint32_t few) {
    const masu_rung_plan *rp = &plan->rungs[rung];
    VkExtent2D render = {rp->render_width, rp->render_height}, input = render;
    VkExtent2D output = masu_plan_extent(plan, masu_passes[pass].extent, render);
    masu_push_block block;
    memset(&block, 0, sizeof block);
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) { /* the first sampled image */
        if (rp->access[pass][a].usage != MASU_READ) continue;
        if (masu_images[rp->access[pass][a].image].extent == MASU_EXTENT_OUTPUT)
            input = plan->desc.output;
        break;
    }
    masu_push_input in = {plan, rung, pass, few,
                          {(float)input.width * (1.0f / (float)output.width),
                           (float)input.height * (1.0f / (float)output.height)}};
    block.sizes.render_width = input.width;
    block.sizes.render_height = input.height;
    block.sizes.output_width = output.width;
    block.sizes.output_height = output.height;
    masu_output_push(plan, rp, pass, &block.sizes);
    fills[pass](&in, &block);
    return block;
}

/* push.c: see push.h. */
#include "plan/push.h"

#include "plan/output.h"
#include "quality/knobs.h"

#include <math.h>
#include <string.h>

static int is_temporal(const masu_push_input *in) {
    return masu_has_pass(&in->plan->rungs[in->rung].active, MASU_PASS_TEMPORAL_FIND);
}

/* Fewer pixels than are shown: mips as fine as the output's pixels ask for, since what EASU gets blurred it
 * cannot bring back. The mean over frames is of samples all over a pixel, each of which may look at a part of it alone:
 * two mips finer have the least error at rest, and at full size in motion
 * (docs/design/17-temporal-upscaling.md). */
static float masu_mip_bias(const masu_push_input *in) {
    const masu_desc *d = &in->plan->desc;
    const masu_rung *rung = &d->rungs[in->rung];
    float own = log2f(rung->scale) - (is_temporal(in) ? 2.0f : 0.0f);
    return (d->debug.no_bias ? 0.0f : own) + d->debug.mip_bias;
}

/* Levels that gbuffer.frag gives back by the speed of what moves, from 2.3 times these on down: those that the scale has added. Of what
 * moves few samples of before count, and what they do not smooth is noise. */
static float masu_mip_moving(const masu_push_input *in) {
    const masu_desc *d = &in->plan->desc;
    return is_temporal(in) && !d->debug.no_bias ? -log2f(d->rungs[in->rung].scale) : 0.0f;
}

/* The most that is shown, in whites. */
static float masu_peak(const masu_targets *t) {
    return t->encoding == MASU_ENCODING_SRGB ? 1.0f : t->peak / t->white;
}

/* Whether the output has the render size. */
static int shows_each_pixel(const masu_push_input *in) {
    const masu_rung_plan *rp = &in->plan->rungs[in->rung];
    return rp->render_width == in->plan->desc.output.width && rp->render_height == in->plan->desc.output.height;
}

/* By how much rung.temporal sharpens what it shows (shaders/upscale/history.glsl), at rest and while the view moves. */
static float calm_sharpening(const masu_rung *r) { return 0.03f - 0.02f * r->scale; }
static float moving_sharpening(const masu_rung *r) { return 0.22f - 0.15f * r->scale; }

/* The farthest that a linear fetch may lie in an image of that size whose texels' middles are whole numbers: samplers round to 1/256,
 * and the last middle would be read with what lies beyond it. */
static float last_place(uint32_t size) { return (float)size - 1.005f; }

/* The image of depth that a pass reads: as large as the largest rung that has it, which other images need not be. */
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

/* Of the four settings of SMAA: the threshold of luma in the steps of smaa/color.glsl, steps of a search, and
 * of one along a diagonal. */
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

/* What is there of the march for passes behind it: 0 nothing, 1 the tiles' lists of parts, 2 what matters to blocks, too (with
 * debug.all_terms that is all of the tile). */
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

/* A row that tells more than there is room for stops the build. */
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
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) { /* the first image that is read */
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

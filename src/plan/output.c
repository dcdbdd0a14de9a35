/* output.c: see output.h. */
#include "plan/output.h"

#include "base/error.h"

#include <math.h>

/* Formats that a target may have: bits of the least precise channel, and how the target is
 * written. */
typedef struct target_format {
    VkFormat format;
    uint32_t bits;
    uint32_t steps[3];
    int srgb;    /* sRGB format: the target receives the same bytes as with UNORM */
    int swapped; /* blue is first in memory */
} target_format;

static const target_format target_formats[] = {
    {VK_FORMAT_R8G8B8A8_UNORM, 8, {255, 255, 255}, 0, 0},
    {VK_FORMAT_B8G8R8A8_UNORM, 8, {255, 255, 255}, 0, 1},
    {VK_FORMAT_A8B8G8R8_UNORM_PACK32, 8, {255, 255, 255}, 0, 0},
    {VK_FORMAT_R8G8B8A8_SRGB, 8, {255, 255, 255}, 1, 0},
    {VK_FORMAT_B8G8R8A8_SRGB, 8, {255, 255, 255}, 1, 1},
    {VK_FORMAT_A8B8G8R8_SRGB_PACK32, 8, {255, 255, 255}, 1, 0}, /* little-endian: r first */
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, 10, {1023, 1023, 1023}, 0, 0},
    {VK_FORMAT_A2R10G10B10_UNORM_PACK32, 10, {1023, 1023, 1023}, 0, 0},
    {VK_FORMAT_R5G6B5_UNORM_PACK16, 5, {31, 63, 31}, 0, 0},
    {VK_FORMAT_B5G6R5_UNORM_PACK16, 5, {31, 63, 31}, 0, 0},
    {VK_FORMAT_R16G16B16A16_UNORM, 16, {0, 0, 0}, 0, 0},
    {VK_FORMAT_R16G16B16A16_SFLOAT, 16, {0, 0, 0}, 0, 0}};

static const target_format *format_of(const masu_desc *d) {
    for (size_t i = 0; i < sizeof target_formats / sizeof *target_formats; i++) {
        if (target_formats[i].format == d->targets.format) return &target_formats[i];
    }
    return NULL;
}

int masu_output_copies(const masu_desc *d) {
    const target_format *f = format_of(d);
    return f && f->srgb;
}

void masu_output_defaults(masu_desc *d) {
    const target_format *f = format_of(d);
    masu_targets *t = &d->targets;
    uint32_t bits = f ? f->bits : 8;
    if (d->tone == MASU_TONE_AUTO) d->tone = MASU_TONE_ACES;
    /* The rest depends on the scene. A host may resolve the default rungs before it has one. */
    if (!d->scene) return;
    if (t->encoding == MASU_ENCODING_AUTO) {
        t->encoding = t->format == VK_FORMAT_R16G16B16A16_SFLOAT ? MASU_ENCODING_LINEAR
                                                                 : MASU_ENCODING_SRGB;
    }
    if (t->white == 0.0f) t->white = t->encoding == MASU_ENCODING_PQ ? 203.0f : 80.0f;
    if (t->peak == 0.0f) t->peak = t->white > 1000.0f ? t->white : 1000.0f;
    if (d->dither == MASU_AUTO) d->dither = !t->storage && bits <= 8 ? MASU_ON : MASU_OFF;
    if (d->deep_color == MASU_AUTO) d->deep_color = bits > 8 ? MASU_ON : MASU_OFF;
    masu_exposure *e = &d->exposure;
    const masu_scene_data *s = masu_scene_data_of(d->scene);
    if (e->metered == MASU_AUTO) e->metered = s->metered ? MASU_ON : MASU_OFF;
    if (e->brighten == 0.0f) e->brighten = s->brighten;
    if (e->darken == 0.0f) e->darken = s->darken;
    if (e->brighten == 0.0f) e->brighten = 1.0f;
    if (e->darken == 0.0f) e->darken = 3.0f;
    if (e->low == 0.0f) e->low = 0.1f;
    if (e->high == 0.0f) e->high = 0.1f;
    if (e->min == 0.0f) e->min = 1.0f / 1024.0f;
    if (e->max == 0.0f) e->max = 1024.0f;
}

static masu_result bad(masu_detail *detail, const char *what, uint64_t needed, uint64_t given,
                       const char *problem) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, needed, given, "%s is %llu: %s", what,
                     (unsigned long long)given, problem);
}

static masu_result bad_float(masu_detail *detail, const char *what, float given,
                             const char *problem) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s is %g: %s", what, (double)given,
                     problem);
}

static masu_result check_targets(const masu_desc *d, masu_detail *detail) {
    const masu_targets *t = &d->targets;
    const target_format *f = format_of(d);
    int floats = t->format == VK_FORMAT_R16G16B16A16_SFLOAT;
    if (!f) {
        return bad(
            detail, "targets.format", VK_FORMAT_B8G8R8A8_UNORM, (uint64_t)t->format,
            "offered are R8G8B8A8, B8G8R8A8, A8B8G8R8 (UNORM 37, 44, 51; SRGB 43, 50, 57), 10 "
            "bits (58, 64), R5G6B5 (4, 5), R16G16B16A16 (UNORM 91, SFLOAT 97)");
    }
    if (t->storage && t->format != VK_FORMAT_R8G8B8A8_UNORM && !(floats && d->scene)) {
        return bad(detail, "targets.format", VK_FORMAT_R8G8B8A8_UNORM, (uint64_t)t->format,
                   "storage targets are VK_FORMAT_R8G8B8A8_UNORM (37) or, of scenes, "
                   "R16G16B16A16_SFLOAT (97); targets.storage 0 has it filled by a blit");
    }
    if (!d->scene && (f->srgb || floats)) {
        return bad(detail, "targets.format", VK_FORMAT_B8G8R8A8_UNORM, (uint64_t)t->format,
                   "without a scene it is a UNORM format, as VK_FORMAT_B8G8R8A8_UNORM (44)");
    }
    if ((unsigned)t->encoding > MASU_ENCODING_PQ)
        return bad(detail, "targets.encoding", MASU_ENCODING_PQ, (unsigned)t->encoding, "unknown");
    if (!d->scene && t->encoding > MASU_ENCODING_SRGB)
        return bad(detail, "targets.encoding", MASU_ENCODING_SRGB, (unsigned)t->encoding,
                   "without a scene it is MASU_ENCODING_SRGB");
    if (!d->scene) return MASU_OK;
    if (t->encoding == MASU_ENCODING_LINEAR && !floats) {
        return bad(detail, "targets.encoding", MASU_ENCODING_SRGB, (unsigned)t->encoding,
                   "MASU_ENCODING_LINEAR takes VK_FORMAT_R16G16B16A16_SFLOAT (97)");
    }
    if (t->encoding == MASU_ENCODING_PQ && f->bits < 10) {
        return bad(detail, "targets.encoding", MASU_ENCODING_SRGB, (unsigned)t->encoding,
                   "MASU_ENCODING_PQ takes a format of 10 or 16 bits, as "
                   "VK_FORMAT_A2B10G10R10_UNORM_PACK32 (64)");
    }
    if (!(t->white >= 1.0f && t->white <= 10000.0f))
        return bad_float(detail, "targets.white", t->white, "allowed are 1 to 10000 nits");
    if (!(t->peak >= t->white && t->peak <= 10000.0f))
        return bad_float(detail, "targets.peak", t->peak, "allowed are white to 10000 nits");
    if ((unsigned)d->deep_color > MASU_ON || (unsigned)d->dither > MASU_ON) {
        return (unsigned)d->dither > MASU_ON
                   ? bad(detail, "dither", MASU_ON, (unsigned)d->dither, "no masu_switch")
                   : bad(detail, "deep_color", MASU_ON, (unsigned)d->deep_color, "no masu_switch");
    }
    if (d->deep_color == MASU_ON && t->storage && !floats) {
        return bad(detail, "deep_color", MASU_OFF, (unsigned)d->deep_color,
                   "storage targets of 8 bits are written in 8 bits; targets.storage 0 has them "
                   "filled by a blit");
    }
    if (d->deep_color == MASU_ON && f->srgb) {
        return bad(
            detail, "deep_color", MASU_OFF, (unsigned)d->deep_color,
            "a target of an SRGB format gets a copy of bytes; the UNORM format of the same bits is "
            "filled by a blit");
    }
    int needs_deep = (floats && t->storage) || t->encoding != MASU_ENCODING_SRGB;
    if (d->deep_color == MASU_OFF && needs_deep) {
        return bad(detail, "deep_color", MASU_ON, (unsigned)d->deep_color,
                   "targets of floats and encodings beyond white are written in 16-bit floats");
    }
    return MASU_OK;
}

/* Without a scene these are unused, but must be finite. */
static masu_result check_unused(const masu_desc *d, masu_detail *detail) {
    const masu_exposure *e = &d->exposure;
    const struct {
        const char *name;
        float value;
    } numbers[] = {{"targets.white", d->targets.white},
                   {"targets.peak", d->targets.peak},
                   {"exposure.brighten", e->brighten},
                   {"exposure.darken", e->darken},
                   {"exposure.low", e->low},
                   {"exposure.high", e->high},
                   {"exposure.min", e->min},
                   {"exposure.max", e->max}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        if (!isfinite(numbers[i].value))
            return bad_float(detail, numbers[i].name, numbers[i].value,
                             "allowed are finite numbers");
    }
    return MASU_OK;
}

masu_result masu_output_check(const masu_desc *d, masu_detail *detail) {
    masu_result result = check_targets(d, detail);
    if (result) return result;
    const masu_exposure *e = &d->exposure;
    if ((unsigned)d->tone > MASU_TONE_NEUTRAL)
        return bad(detail, "tone", MASU_TONE_NEUTRAL, (unsigned)d->tone, "no masu_tone");
    if (!d->scene) return check_unused(d, detail);
    if ((unsigned)e->metered > MASU_ON)
        return bad(detail, "exposure.metered", MASU_ON, (unsigned)e->metered, "no masu_switch");
    if (!(e->brighten > 0.0f && e->brighten <= 1e6f))
        return bad_float(detail, "exposure.brighten", e->brighten,
                         "allowed are 0 to 1e6 per second");
    if (!(e->darken > 0.0f && e->darken <= 1e6f))
        return bad_float(detail, "exposure.darken", e->darken, "allowed are 0 to 1e6 per second");
    float low = e->low < 0.0f ? 0.0f : e->low, high = e->high < 0.0f ? 0.0f : e->high;
    if (!(high < 1.0f)) return bad_float(detail, "exposure.high", e->high, "allowed are below 1");
    if (!(low + high < 1.0f))
        return bad_float(detail, "exposure.low", e->low, "with exposure.high it is less than 1");
    if (!(e->min >= 1e-9f && e->min <= 1e9f))
        return bad_float(detail, "exposure.min", e->min, "allowed are 1e-9 to 1e9");
    if (!(e->max >= e->min && e->max <= 1e9f))
        return bad_float(detail, "exposure.max", e->max, "allowed are exposure.min to 1e9");
    return MASU_OK;
}

void masu_output_plan(masu_frame_plan *plan) {
    const masu_desc *d = &plan->desc;
    const target_format *f = format_of(d);
    plan->copies = masu_output_copies(d);
    if (!d->scene) return; /* a source image is upscaled without changes to its encoding */
    plan->deep = d->deep_color == MASU_ON;
    int dither = d->dither == MASU_ON && f->steps[0];
    /* Rounds half floats, and bytes for targets with fewer bits, in the shader, so that the
     * driver's conversion does not round again. */
    if (dither || plan->deep || f->bits < 8) {
        int bytes = !plan->deep && f->bits > 8; /* the last image before the blit has 8 bits */
        for (uint32_t c = 0; c < 3; c++) plan->output.steps[c] = bytes ? 255 : f->steps[c];
    }
    plan->output.flags = MASU_OUTPUT_LAST | (dither ? MASU_OUTPUT_DITHER : 0) |
                         (f->srgb && f->swapped ? MASU_OUTPUT_SWAP : 0);
}

void masu_output_push(const masu_frame_plan *plan, const masu_rung_plan *rung, uint32_t pass,
                      struct masu_push *push) {
    if (!plan->needs.scene || !masu_comes_last(rung, pass)) return;
    const uint32_t *steps = plan->output.steps;
    push->output_steps = steps[0] | steps[1] << 10 | steps[2] << 20;
    push->output_flags = plan->output.flags;
}

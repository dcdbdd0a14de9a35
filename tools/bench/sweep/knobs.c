/* knobs.c: see knobs.h. */
#include "bench/sweep/knobs.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const masu_knob_words switches = {"MASU_", 3, {"auto", "off", "on"}};
static const masu_knob_words easus = {"MASU_EASU_", 4, {"auto", "full", "fast", "bilinear"}};
static const masu_knob_words aas = {
    "MASU_AA_", 7, {"auto", "off", "fxaa", "smaa-low", "smaa-medium", "smaa-high", "smaa-ultra"}};
static const masu_knob_words marches = {
    "MASU_MARCH_",
    8,
    {"auto", "plain", "fragment", "seed", "cone8", "cones", "checkerboard", "unpruned"}};

#define AT(field, kind, use) #field, offsetof(masu_rung, field), MASU_KNOB_##kind, MASU_USE_##use
#define WORDS(field, use, words)                                                                   \
    { AT(field, WORD, use), &words, 0, 0, 0 }
#define SCALAR(field, use, low, high)                                                              \
    { AT(field, SCALAR, use), NULL, low, high, 0 }
#define NUMBER(field, use, high)                                                                   \
    { AT(field, NUMBER, use), NULL, 0, high, 0 }

const masu_knob masu_knobs[MASU_KNOBS] = {
    SCALAR(scale, ALWAYS, 0, 1),
    WORDS(upscale, UPSCALED, switches),
    WORDS(easu, UPSCALED, easus),
    WORDS(sharpen, SHARPEN, switches),
    SCALAR(sharpness, SHARPENED, 0, 64),
    WORDS(fuse, UPSCALED, switches),
    WORDS(aa, ALWAYS, aas),
    WORDS(march, SDF, marches),
    NUMBER(march_steps, SDF, 2048),
    WORDS(frustum, POLYGONS, switches),
    WORDS(occlusion, OCCLUDERS, switches),
    SCALAR(lod_error, LODS, -1e9, 1e9),
    WORDS(ao, AO, switches),
    NUMBER(ao_slices, AO, 8),
    NUMBER(ao_steps, AO, 16),
    NUMBER(shadow_cascades, SHADOWS, MASU_MAX_CASCADES),
    {AT(shadow_resolution, NUMBER, SHADOWS), NULL, 0, 8192, 16},
    SCALAR(shadow_distance, SHADOWS, 0, 1e30),
    {AT(shadow_refresh, REFRESH, SHADOWS), NULL, 0, MASU_MAX_REFRESH, 0},
    WORDS(light_tiles, LIGHTS, switches),
    WORDS(specular, SPECULAR, switches),
    SCALAR(specular_cutoff, SPECULAR, 0, 1),
    WORDS(specular_reuse, SPECULAR, switches),
    WORDS(specular_temporal, SPECULAR, switches),
    WORDS(specular_fine, SPECULAR, switches),
    WORDS(specular_filter, SPECULAR, switches),
    WORDS(specular_taa, SPECULAR, switches),
    NUMBER(specular_reuse_taps, SPECULAR, 16),
    NUMBER(specular_filter_taps, SPECULAR, 32),
    NUMBER(specular_frames, SPECULAR, 240),
};

/* 29 knobs of four bytes and one of sixteen: a knob that is not in the table stops the build. */
_Static_assert(sizeof(masu_rung) == 4 * (MASU_KNOBS - 1) + 4 * MASU_MAX_CASCADES,
               "masu_knobs has every knob of masu_rung");
_Static_assert(sizeof(masu_switch) == 4 && sizeof(masu_easu) == 4 && sizeof(masu_aa) == 4 &&
                   sizeof(masu_march) == 4,
               "enums are as wide as uint32_t");

size_t masu_knob_bytes(const masu_knob *k) {
    return k->kind == MASU_KNOB_REFRESH ? 4 * MASU_MAX_CASCADES : 4;
}

bool masu_knob_differs(const masu_knob *k, const masu_rung *a, const masu_rung *b) {
    return memcmp((const char *)a + k->offset, (const char *)b + k->offset, masu_knob_bytes(k)) !=
           0;
}

void masu_knob_copy(const masu_knob *k, masu_rung *to, const masu_rung *from) {
    memcpy((char *)to + k->offset, (const char *)from + k->offset, masu_knob_bytes(k));
}

uint32_t masu_knob_number(const masu_knob *k, const masu_rung *rung) {
    uint32_t value;
    memcpy(&value, (const char *)rung + k->offset, sizeof value);
    return value;
}

double masu_knob_scalar(const masu_knob *k, const masu_rung *rung) {
    float value;
    memcpy(&value, (const char *)rung + k->offset, sizeof value);
    return (double)value;
}

const char *masu_knob_name(uint32_t i) { return i < MASU_KNOBS ? masu_knobs[i].name : NULL; }

/* The fewest digits that read back as the same float; nine always do (FLT_DECIMAL_DIG). */
static void scalar_text(double value, char *out, size_t size) {
    for (int digits = 4; digits <= 9; digits++) {
        snprintf(out, size, "%.*g", digits, value);
        float back = strtof(out, NULL), is = (float)value;
        if (!memcmp(&back, &is, sizeof is)) return;
    }
}

void masu_knob_json(uint32_t i, const masu_rung *rung, char *out, size_t size) {
    const masu_knob *k = &masu_knobs[i];
    const uint32_t *r = rung->shadow_refresh;
    switch (k->kind) {
    case MASU_KNOB_SCALAR: scalar_text(masu_knob_scalar(k, rung), out, size); break;
    case MASU_KNOB_NUMBER: snprintf(out, size, "%u", masu_knob_number(k, rung)); break;
    case MASU_KNOB_WORD:
        snprintf(out, size, "\"%s\"", k->words->words[masu_knob_number(k, rung)]);
        break;
    case MASU_KNOB_REFRESH: snprintf(out, size, "[%u, %u, %u, %u]", r[0], r[1], r[2], r[3]); break;
    }
}

void masu_knob_c(uint32_t i, const masu_rung *rung, char *out, size_t size) {
    const masu_knob *k = &masu_knobs[i];
    const uint32_t *r = rung->shadow_refresh;
    char text[40];
    switch (k->kind) {
    case MASU_KNOB_SCALAR:
        scalar_text(masu_knob_scalar(k, rung), text, sizeof text);
        snprintf(out, size, "%s%sf", text, strpbrk(text, ".e") ? "" : ".0");
        break;
    case MASU_KNOB_NUMBER: snprintf(out, size, "%u", masu_knob_number(k, rung)); break;
    case MASU_KNOB_WORD:
        snprintf(text, sizeof text, "%s", k->words->words[masu_knob_number(k, rung)]);
        for (char *c = text; *c; c++) *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
        snprintf(out, size, "%s%s", k->words->prefix, text);
        break;
    case MASU_KNOB_REFRESH: snprintf(out, size, "{%u, %u, %u, %u}", r[0], r[1], r[2], r[3]); break;
    }
}

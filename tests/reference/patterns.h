/* patterns.h: deterministic test images, so that no image file is needed.
 *
 * Six kinds, each difficult for another algorithm: a photo-like image, a zone plate, hard edges,
 * noise (white and binary), thin marks (text and dots), and smooth areas (ramp and flat). The same
 * pattern, seed and size give the same bytes on every machine and compiler. */
#ifndef MASU_TESTS_REFERENCE_PATTERNS_H
#define MASU_TESTS_REFERENCE_PATTERNS_H

#include <stdint.h>

enum masu_pattern {
    MASU_PATTERN_PHOTO,        /* shaded objects over a gradient, 1/f texture, soft and hard rims */
    MASU_PATTERN_ZONE_PLATE,   /* cosine rings, up to 0.45 cycles a pixel in the far corner */
    MASU_PATTERN_HARD_EDGES,   /* flat polygons and discs without anti-aliasing */
    MASU_PATTERN_WHITE_NOISE,  /* each channel independent and uniform in 0..255 */
    MASU_PATTERN_BINARY_NOISE, /* each channel independently 0 or 255 */
    MASU_PATTERN_TEXT,         /* dark glyph-like one-pixel strokes on a light page */
    MASU_PATTERN_DOTS,         /* single bright pixels, about 1 in 40, on dark */
    MASU_PATTERN_RAMP,         /* three linear ramps: x in red, y in green, the diagonal in blue */
    MASU_PATTERN_FLAT,         /* one colour, picked by the seed: 0, 1, 128, 255, then any */
    MASU_PATTERN_COUNT
};

/* Lower-case name for messages, "?" for a value out of range. */
const char *masu_pattern_name(enum masu_pattern pattern);

/* Fills width * height RGBA texels, alpha 255, tightly packed. Sizes from 1x1. */
void masu_pattern_fill(enum masu_pattern pattern, uint32_t seed, uint32_t width, uint32_t height,
                       uint8_t *rgba);

/* The generator behind them: a well-mixed 32-bit hash, useful to tests on its own. */
uint32_t masu_pattern_hash(uint32_t x);

/* FNV-1a over bytes: the short name of an image in tests and logs. */
uint32_t masu_pattern_fnv1a(const uint8_t *bytes, uint64_t count);

#endif

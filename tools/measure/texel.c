/* texel.c: see texel.h. */
#include "measure/texel.h"

#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

static const double range = 16, least = 1.0 / 1024;

static double clamped(double x, double low, double high) {
    return x > low ? x < high ? x : high : low;
}

static double brightest_of(const double c[3]) { return fmax(c[0], fmax(c[1], c[2])); }

/* Quantizes x in 0..1 to one of `steps` + 1 levels. */
static uint32_t level_of(double x, double steps) {
    return (uint32_t)(clamped(x, 0, 1) * steps + 0.5);
}

static bool emits(const double material[8]) { return brightest_of(material + 4) >= least; }

bool masu_texel_unlit(const double m[8]) {
    return emits(m) && !(brightest_of(m) > 0) && !(m[3] < 1);
}

bool masu_texel_is_unlit(uint32_t normal) {
    return (normal >> 30 & MASU_SURFACE_EMISSIVE) != 0 && (normal >> 26 & 15) == 0;
}

static void unpack_word(const uint8_t texel[4], uint32_t form, double m[8]) {
    uint32_t word;
    memcpy(&word, texel, sizeof word);
    uint32_t hue = word >> 23, channel = hue / 169;
    double level = (word >> 16 & 127) / 127.0, next = hue / 13 % 13 / 12.0, last = hue % 13 / 12.0;
    level *= level;
    level *= level * range;
    for (int c = 0; c < 3; c++) {
        double root = (word >> 5 * c & 31) / 31.0;
        m[c] = root * root;
    }
    m[3] = (form - 1) / 13.0;
    m[4 + channel % 3] = level;
    m[4 + (channel + 1) % 3] = level * next * next;
    m[4 + (channel + 2) % 3] = level * last * last;
    m[7] = word >> 15 & 1;
}

void masu_texel_unpack(const uint8_t texel[4], uint32_t normal, double m[8]) {
    uint32_t form = normal >> 26 & 15;
    bool shines = (normal >> 30 & MASU_SURFACE_EMISSIVE) != 0;
    memset(m, 0, 8 * sizeof *m);
    for (int c = 0; c < 3; c++) {
        double root = texel[c] / 255.0;
        m[c] = root * root;
    }
    m[3] = texel[3] / 255.0;
    m[7] = !shines ? form / 15.0 : form ? (form - 1) / 14.0 : 0;
}

void masu_texel_pack(const double m[8], uint8_t texel[4], uint32_t *normal) {
    for (int c = 0; c < 3; c++) texel[c] = (uint8_t)level_of(sqrt(clamped(m[c], 0, 1)), 255);
    texel[3] = (uint8_t)level_of(m[3], 255);
    uint32_t metal = masu_texel_unlit(m) ? 0 : 1 + level_of(m[7], 14);
    *normal = emits(m) ? MASU_SURFACE_EMISSIVE << 30 | metal << 26 : level_of(m[7], 15) << 26;
}

void masu_texel_unpack_met(const uint8_t texel[4], uint32_t normal, double m[8]) {
    uint32_t form = normal >> 26 & 15;
    bool shines = (normal >> 30 & MASU_SURFACE_EMISSIVE) != 0;
    memset(m, 0, 8 * sizeof *m);
    if (shines && form > 0 && form < 15) {
        unpack_word(texel, form, m);
        return;
    }
    for (int c = 0; c < 3; c++) {
        double root = texel[c] / 255.0;
        m[shines ? 4 + c : c] = shines ? range * root * root : root * root;
    }
    m[3] = shines && !form ? 1 : texel[3] / 255.0; /* light.comp ignores it */
    m[7] = shines ? 0 : form / 15.0;
}

void masu_texel_pack_met(const double m[8], uint8_t texel[4], uint32_t *normal) {
    bool shines = emits(m), black = !(brightest_of(m) > 0) && !(m[7] >= 0.5);
    for (int c = 0; c < 3; c++)
        texel[c] = (uint8_t)level_of(sqrt(clamped(shines ? m[4 + c] / range : m[c], 0, 1)), 255);
    texel[3] = (uint8_t)level_of(m[3], 255);
    *normal = shines ? MASU_SURFACE_EMISSIVE << 30 : level_of(m[7], 15) << 26;
    if (!shines || masu_texel_unlit(m)) return;
    if (black) {
        *normal |= 15u << 26;
        return;
    }
    double glow[3], most;
    for (int c = 0; c < 3; c++) glow[c] = clamped(m[4 + c], 0, range);
    most = brightest_of(glow);
    uint32_t channel = glow[0] >= most ? 0 : glow[1] >= most ? 1 : 2;
    uint32_t next = level_of(sqrt(glow[(channel + 1) % 3] / most), 12);
    uint32_t last = level_of(sqrt(glow[(channel + 2) % 3] / most), 12);
    uint32_t word =
        level_of(sqrt(sqrt(most / range)), 127) << 16 | ((channel * 13 + next) * 13 + last) << 23;
    for (int c = 0; c < 3; c++) word |= level_of(sqrt(clamped(m[c], 0, 1)), 31) << 5 * c;
    if (m[7] >= 0.5) word |= 1u << 15;
    memcpy(texel, &word, sizeof word);
    *normal |= (1 + level_of(m[3], 13)) << 26;
}

float masu_texel_half(uint16_t bits) {
    uint32_t exponent = bits >> 10 & 31u, fraction = bits & 0x3FFu;
    float value = exponent == 31 ? (fraction ? NAN : INFINITY)
                  : exponent     ? ldexpf((float)(fraction | 0x400u), (int)exponent - 25)
                                 : ldexpf((float)fraction, -24);
    return bits & 0x8000u ? -value : value;
}

/*
 * patterns.c: see patterns.h. Everything is a pure function of (pattern, seed, x, y, size): no
 * state, no allocation, no failure. Arithmetic is integer or double rounded to a byte; the only
 * library function is cos, whose last-digit differences between libraries do not reach a byte.
 */
#include "reference/patterns.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

struct canvas {
    uint32_t width, height, seed;
};

struct colour {
    double r, g, b; /* 0..1 */
};

const char *masu_pattern_name(enum masu_pattern pattern)
{
    static const char *const names[MASU_PATTERN_COUNT] = {
        [MASU_PATTERN_PHOTO] = "photo",
        [MASU_PATTERN_ZONE_PLATE] = "zone plate",
        [MASU_PATTERN_HARD_EDGES] = "hard edges",
        [MASU_PATTERN_WHITE_NOISE] = "white noise",
        [MASU_PATTERN_BINARY_NOISE] = "binary noise",
        [MASU_PATTERN_TEXT] = "text",
        [MASU_PATTERN_DOTS] = "dots",
        [MASU_PATTERN_RAMP] = "ramp",
        [MASU_PATTERN_FLAT] = "flat",
    };
    return (unsigned)pattern < MASU_PATTERN_COUNT ? names[pattern] : "?";
}

/* Two multiply-xorshift rounds: every input bit reaches every output bit. */
uint32_t masu_pattern_hash(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7FEB352Du;
    x ^= x >> 15;
    x *= 0x846CA68Bu;
    x ^= x >> 16;
    return x;
}

uint32_t masu_pattern_fnv1a(const uint8_t *bytes, uint64_t count)
{
    uint32_t h = 0x811C9DC5u;
    for (uint64_t i = 0; i < count; i++) {
        h = (h ^ bytes[i]) * 0x01000193u;
    }
    return h;
}

static uint32_t hash_at(uint32_t seed, uint32_t x, uint32_t y)
{
    return masu_pattern_hash(x + masu_pattern_hash(y + masu_pattern_hash(seed)));
}

static double unit_at(uint32_t seed, uint32_t x, uint32_t y)
{
    return (double)hash_at(seed, x, y) / 4294967295.0;
}

static double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

static double clamp01(double x)
{
    return x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
}

static double smooth(double edge0, double edge1, double x)
{
    double t = clamp01((x - edge0) / (edge1 - edge0));
    return t * t * (3.0 - 2.0 * t);
}

static struct colour grey(double v)
{
    return (struct colour){ v, v, v };
}

/* Lattice noise, smoothly interpolated; cell is the lattice spacing in pixels. */
static double value_noise(uint32_t seed, double x, double y, double cell)
{
    double u = x / cell;
    double v = y / cell;
    double fu = floor(u);
    double fv = floor(v);
    uint32_t ix = (uint32_t)fu;
    uint32_t iy = (uint32_t)fv;
    double tu = smooth(0.0, 1.0, u - fu);
    double tv = smooth(0.0, 1.0, v - fv);
    double top = mix(unit_at(seed, ix, iy), unit_at(seed, ix + 1, iy), tu);
    double bottom = mix(unit_at(seed, ix, iy + 1), unit_at(seed, ix + 1, iy + 1), tu);
    return mix(top, bottom, tv);
}

/* Octaves whose amplitude falls as their frequency rises: the spectrum of natural images. */
static double texture(const struct canvas *c, uint32_t salt, double x, double y)
{
    double sum = 0.0;
    double weight = 0.0;
    double amplitude = 1.0;
    double cell = 64.0;
    for (uint32_t octave = 0; octave < 6; octave++) {
        sum += amplitude * value_noise(c->seed + salt + octave, x, y, cell);
        weight += amplitude;
        amplitude *= 0.5;
        cell *= 0.5;
    }
    return sum / weight;
}

static double shorter_side(const struct canvas *c)
{
    return (double)(c->width < c->height ? c->width : c->height);
}

/* Sky gradient, then eight lit balls painted back to front. Distant ones have a soft rim (defocus),
 * near ones a one-pixel rim, as in an anti-aliased photograph. */
static struct colour photo(const struct canvas *c, uint32_t px, uint32_t py)
{
    double x = (double)px;
    double y = (double)py;
    double down = y / (double)c->height;
    double grain = texture(c, 100, x, y);
    struct colour out = { mix(0.35, 0.75, down) + 0.15 * (grain - 0.5),
                          mix(0.50, 0.65, down) + 0.15 * (grain - 0.5),
                          mix(0.80, 0.45, down) + 0.10 * (grain - 0.5) };
    for (uint32_t i = 0; i < 8; i++) {
        double radius = shorter_side(c) * mix(0.06, 0.22, unit_at(c->seed, i, 1001));
        double dx = x - (double)c->width * unit_at(c->seed, i, 1002);
        double dy = y - (double)c->height * unit_at(c->seed, i, 1003);
        double rim = i < 3 ? 6.0 : 1.0;
        double distance = sqrt(dx * dx + dy * dy);
        double inside = 1.0 - smooth(radius - rim, radius + rim, distance);
        if (!(inside > 0.0)) {
            continue;
        }
        double height = sqrt(clamp01(1.0 - (distance / radius) * (distance / radius)));
        double light = clamp01((-0.5 * dx - 0.6 * dy) / radius * 0.7 + 0.6 * height);
        double shade = 0.12 + 0.88 * light;
        shade *= 0.6 + 0.8 * (texture(c, 200 + 16 * i, x, y) - 0.25);
        out.r = mix(out.r, shade * mix(0.2, 1.0, unit_at(c->seed, i, 1004)), inside);
        out.g = mix(out.g, shade * mix(0.2, 1.0, unit_at(c->seed, i, 1005)), inside);
        out.b = mix(out.b, shade * mix(0.2, 1.0, unit_at(c->seed, i, 1006)), inside);
    }
    return out;
}

static struct colour zone_plate(const struct canvas *c, uint32_t px, uint32_t py)
{
    double x = (double)px;
    double y = (double)py;
    double reach = sqrt((double)c->width * c->width + (double)c->height * c->height);
    double phase = pi * 0.45 * (x * x + y * y) / reach;
    return grey(0.5 + 0.5 * cos(phase + (double)c->seed));
}

/* Half planes and discs of random flat colours: every rim is a step in one pixel. */
static struct colour hard_edges(const struct canvas *c, uint32_t px, uint32_t py)
{
    uint32_t owner = 0;
    for (uint32_t i = 1; i < 24; i++) {
        double dx = (double)px - (double)c->width * unit_at(c->seed, i, 2001);
        double dy = (double)py - (double)c->height * unit_at(c->seed, i, 2002);
        double reach = shorter_side(c) * mix(0.05, 0.3, unit_at(c->seed, i, 2003));
        double turn = 2.0 * pi * unit_at(c->seed, i, 2004);
        double along = dx * cos(turn) + dy * cos(turn - pi / 2.0);
        double across = dy * cos(turn) - dx * cos(turn - pi / 2.0);
        int disc = dx * dx + dy * dy < reach * reach;
        int box = fabs(along) < reach && fabs(across) < 0.35 * reach;
        if ((i & 1u) ? disc : box) {
            owner = i;
        }
    }
    uint32_t h = hash_at(c->seed, owner, 2005);
    return (struct colour){ (h & 255u) / 255.0, (h >> 8 & 255u) / 255.0, (h >> 16 & 255u) / 255.0 };
}

static struct colour noise(const struct canvas *c, uint32_t x, uint32_t y, int binary)
{
    uint32_t h = hash_at(c->seed, x, y);
    if (binary) {
        return (struct colour){ h & 1u, h >> 1 & 1u, h >> 2 & 1u };
    }
    return (struct colour){ (h & 255u) / 255.0, (h >> 8 & 255u) / 255.0, (h >> 16 & 255u) / 255.0 };
}

/* Glyphs of 7x9 pixels on an 8x12 pitch, each a random choice of seven one-pixel strokes. */
static struct colour text(const struct canvas *c, uint32_t x, uint32_t y)
{
    uint32_t h = hash_at(c->seed, x / 8, y / 12);
    uint32_t u = x % 8;
    uint32_t v = y % 12;
    int ink = 0;
    if (h % 6 != 0 && u < 7 && v >= 1 && v < 10) { /* one cell in six is a space */
        uint32_t s = h >> 8;
        ink |= (s & 1u) && u == 1;
        ink |= (s & 2u) && u == 5;
        ink |= (s & 4u) && v == 1 && u >= 1 && u <= 5;
        ink |= (s & 8u) && v == 5 && u >= 1 && u <= 5;
        ink |= (s & 16u) && v == 9 && u >= 1 && u <= 5;
        ink |= (s & 32u) && u == v - 2;
        ink |= (s & 64u) && u + v == 9;
    }
    return ink ? (struct colour){ 0.08, 0.08, 0.12 } : (struct colour){ 0.96, 0.95, 0.90 };
}

static struct colour dots(const struct canvas *c, uint32_t x, uint32_t y)
{
    uint32_t h = hash_at(c->seed, x, y);
    if (h % 40 != 0) {
        return (struct colour){ 0.02, 0.02, 0.03 };
    }
    return (struct colour){ 1.0, (h >> 8 & 255u) / 255.0, (h >> 16 & 255u) / 255.0 };
}

static struct colour ramp(const struct canvas *c, uint32_t x, uint32_t y)
{
    double u = c->width > 1 ? (double)x / (c->width - 1) : 0.0;
    double v = c->height > 1 ? (double)y / (c->height - 1) : 0.0;
    return (struct colour){ u, v, 0.5 * (u + v) };
}

static struct colour flat(const struct canvas *c)
{
    static const double first[] = { 0.0, 1.0 / 255.0, 128.0 / 255.0, 1.0 };
    if (c->seed < 4) {
        return grey(first[c->seed]);
    }
    return noise(c, 0, 0, 0);
}

static struct colour colour_at(enum masu_pattern pattern, const struct canvas *c, uint32_t x,
                               uint32_t y)
{
    switch (pattern) {
    case MASU_PATTERN_PHOTO: return photo(c, x, y);
    case MASU_PATTERN_ZONE_PLATE: return zone_plate(c, x, y);
    case MASU_PATTERN_HARD_EDGES: return hard_edges(c, x, y);
    case MASU_PATTERN_WHITE_NOISE: return noise(c, x, y, 0);
    case MASU_PATTERN_BINARY_NOISE: return noise(c, x, y, 1);
    case MASU_PATTERN_TEXT: return text(c, x, y);
    case MASU_PATTERN_DOTS: return dots(c, x, y);
    case MASU_PATTERN_RAMP: return ramp(c, x, y);
    case MASU_PATTERN_FLAT: return flat(c);
    case MASU_PATTERN_COUNT: break;
    }
    return grey(0.0);
}

static uint8_t byte_of(double v)
{
    return (uint8_t)(clamp01(v) * 255.0 + 0.5);
}

void masu_pattern_fill(enum masu_pattern pattern, uint32_t seed, uint32_t width, uint32_t height,
                       uint8_t *rgba)
{
    struct canvas canvas = { width, height, seed };
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++, rgba += 4) {
            struct colour c = colour_at(pattern, &canvas, x, y);
            rgba[0] = byte_of(c.r);
            rgba[1] = byte_of(c.g);
            rgba[2] = byte_of(c.b);
            rgba[3] = 255;
        }
    }
}

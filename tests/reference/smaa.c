/* smaa.c: see smaa.h. Equations: Jimenez et al., "SMAA" (Eurographics 2012), section 4; Lottes,
 * "FXAA" (2009). */
#include "reference/smaa.h"

#include "generate/smaa_tables.h"

#include <math.h>

struct masu_ref_smaa masu_ref_smaa_preset(int preset) {
    static const struct masu_ref_smaa presets[] = {
        {0.15f, 4, 0, 0}, {0.1f, 8, 0, 0}, {0.1f, 16, 8, 1}, {0.05f, 32, 16, 1}};
    return presets[preset];
}

static int clamped(int v, int low, int high) { return v < low ? low : v > high ? high : v; }

static void read_rgb(const struct masu_ref_image *in, int x, int y, float rgb[3]) {
    uint32_t stride = in->stride ? in->stride : in->width;
    const float *from = in->rgb + 3 * ((size_t)clamped(y, 0, (int)in->height - 1) * stride +
                                       (size_t)clamped(x, 0, (int)in->width - 1));
    for (int c = 0; c < 3; c++) {
        float v = isfinite(from[c]) ? from[c] : 0.0f;
        rgb[c] = v < 0.0f ? 0.0f : v > 1.0f ? 1.0f : v;
    }
}

/* Whole numbers up to 2 550 000. */
static double luma_of(const float rgb[3]) {
    return 2126.0 * nearbyint((double)rgb[0] * 255) + 7152.0 * nearbyint((double)rgb[1] * 255) +
           722.0 * nearbyint((double)rgb[2] * 255);
}

static double luma(const struct masu_ref_image *in, int x, int y) {
    float rgb[3];
    read_rgb(in, x, y, rgb);
    return luma_of(rgb);
}

static double decode(double v) { return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4); }

static double encode(double v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
}

/* ---- Edges ----------------------------------------------------------------------------------- */

static double largest(double a, double b) { return a > b ? a : b; }

void masu_ref_smaa_edges(const struct masu_ref_image *in, const struct masu_ref_smaa *with,
                         uint8_t *edges) {
    double threshold = 2550000.0 * (double)with->threshold;
    for (int y = 0; y < (int)in->height; y++) {
        for (int x = 0; x < (int)in->width; x++, edges += 2) {
            double here = luma(in, x, y), left = luma(in, x - 1, y), top = luma(in, x, y - 1);
            double dx = fabs(here - left), dy = fabs(here - top), most = largest(dx, dy);
            most = largest(most, fabs(here - luma(in, x + 1, y)));
            most = largest(most, fabs(here - luma(in, x, y + 1)));
            most = largest(most, fabs(left - luma(in, x - 2, y)));
            most = largest(most, fabs(top - luma(in, x, y - 2)));
            edges[0] = dx >= threshold && 2 * dx >= most ? 255 : 0;
            edges[1] = dy >= threshold && 2 * dy >= most ? 255 : 0;
        }
    }
}

/* ---- Weights --------------------------------------------------------------------------------- */

typedef struct edge_image {
    const uint8_t *bytes;
    int width, height;
} edge_image;

typedef struct pair {
    float r, g;
} pair;

static pair texel(const edge_image *e, int x, int y) {
    const uint8_t *at = e->bytes + 2 * ((size_t)clamped(y, 0, e->height - 1) * (size_t)e->width +
                                        (size_t)clamped(x, 0, e->width - 1));
    return (pair){at[0] / 255.0f, at[1] / 255.0f};
}

/* Bilinear; x and y are pixels, whole at their centres. */
static pair fetch(const edge_image *e, float x, float y) {
    int i = (int)floorf(x), j = (int)floorf(y);
    float u = x - floorf(x), v = y - floorf(y);
    pair a = texel(e, i, j), b = texel(e, i + 1, j), c = texel(e, i, j + 1),
         d = texel(e, i + 1, j + 1);
    return (pair){(a.r * (1 - u) + b.r * u) * (1 - v) + (c.r * (1 - u) + d.r * u) * v,
                  (a.g * (1 - u) + b.g * u) * (1 - v) + (c.g * (1 - u) + d.g * u) * v};
}

/* The same with x and y swapped, and the two edges swapped: rows and columns behave alike. */
static pair fetch_along(const edge_image *e, int column, float along, float across) {
    pair p = column ? fetch(e, across, along) : fetch(e, along, across);
    return column ? (pair){p.g, p.r} : p;
}

static const uint8_t *area_table(void) {
    static uint8_t table[MASU_SMAA_AREA_BYTES];
    static int made;
    if (!made) masu_smaa_area_texture(table, 1);
    made = 1;
    return table;
}

static const uint8_t *search_table(void) {
    static uint8_t table[MASU_SMAA_SEARCH_BYTES];
    static int made;
    if (!made) masu_smaa_search_texture(table);
    made = 1;
    return table;
}

/* How many of the last two pixels still belong to the line. `across` is the edge that would end
 * it. */
static float search_length(float across, float line, int ahead) {
    int x = (int)floorf(32 * across + 0.5f) + (ahead ? 33 : 0);
    int y = 32 - (int)floorf(32 * line + 0.5f);
    return search_table()[clamped(y, 0, 15) * MASU_SMAA_SEARCH_WIDTH + clamped(x, 0, 63)] / 127.0f;
}

/* Finds the end of the line, from pixel p of row or column q. way -1: back, 1: ahead. */
static float search(const edge_image *e, int column, int p, int q, int way, int steps) {
    float at = (float)p + (way < 0 ? -0.25f : 1.25f), across = (float)q - 0.125f;
    float end = at + (float)(2 * way * steps);
    pair f = {0, 1};
    while ((way < 0 ? at > end : at < end) && f.g > 0.8281f && f.r == 0.0f) {
        f = fetch_along(e, column, at, across);
        at += (float)(2 * way);
    }
    return at - (float)way * (3.25f - search_length(f.r, f.g, way > 0));
}

static void area_at(float x, float y, float out[2]) {
    int i = (int)floorf(x), j = (int)floorf(y);
    float u = x - floorf(x), v = y - floorf(y);
    const uint8_t *t = area_table();
    for (int c = 0; c < 2; c++) {
        const uint8_t *a = t + 2 * (j * MASU_SMAA_AREA_WIDTH + i) + c;
        const uint8_t *b = a + 2 * MASU_SMAA_AREA_WIDTH;
        out[c] = (((float)a[0] * (1 - u) + (float)a[2] * u) * (1 - v) +
                  ((float)b[0] * (1 - u) + (float)b[2] * u) * v) /
                 255;
    }
}

static void straight(const edge_image *e, const struct masu_ref_smaa *with, int column, int p,
                     int q, float w[2]) {
    float from = search(e, column, p, q, -1, with->steps),
          to = search(e, column, p, q, 1, with->steps);
    float left = fetch_along(e, column, from, (float)q - 0.25f).r;
    float right = fetch_along(e, column, to + 1, (float)q - 0.25f).r;
    float d[2] = {fabsf(roundf(from - (float)p)), fabsf(roundf(to - (float)p))};
    area_at(16 * roundf(4 * left) + sqrtf(d[0]), 16 * roundf(4 * right) + sqrtf(d[1]), w);
    if (!with->corners) return;
    float near[2] = {d[1] >= d[0] ? 1.0f : 0.0f, d[0] >= d[1] ? 1.0f : 0.0f};
    float both = near[0] + near[1];
    for (int c = 0; c < 2; c++) {
        float row = (float)(c ? q - 2 : q + 1);
        float factor = 1 - 0.75f * near[0] / both * fetch_along(e, column, from, row).r -
                       0.75f * near[1] / both * fetch_along(e, column, to + 1, row).r;
        w[c] *= factor < 0 ? 0 : factor > 1 ? 1 : factor;
    }
}

/* Follows a staircase whose steps have both edges at one pixel, or (apart 1) the left edge at the
 * next pixel. Returns the number of steps; `last` are the edges at the step that ended the search,
 * `open` whether there were none. */
static int search_stair(const edge_image *e, int x, int y, int dx, int dy, int apart, int steps,
                        pair *last, int *open) {
    int n = -1;
    *open = 1;
    while (n < steps - 1 && *open) {
        x += dx;
        y += dy;
        n++;
        *last = (pair){texel(e, x + apart, y).r, texel(e, x, y).g};
        *open = last->r + last->g > 1.5f;
    }
    return n;
}

static void diagonal_area(int left, int right, int a, int b, float out[2]) {
    const uint8_t *t =
        area_table() + 2 * ((20 * right + b) * MASU_SMAA_AREA_WIDTH + 80 + 20 * left + a);
    out[0] = t[0] / 255.0f;
    out[1] = t[1] / 255.0f;
}

static int set(float edge) { return edge > 0.5f; }

static void diagonal(const edge_image *e, const struct masu_ref_smaa *with, int x, int y,
                     float w[2]) {
    int steps = with->diagonal_steps, a = 0, b, a_open = 0, b_open, left, right;
    pair last;
    float area[2];
    if (set(texel(e, x, y).r)) {
        a = search_stair(e, x, y, -1, 1, 0, steps, &last, &a_open);
        a += set(last.g);
    }
    b = search_stair(e, x, y, 1, -1, 0, steps, &last, &b_open);
    if (a + b > 2) {
        left = a_open ? 0 : 2 * set(texel(e, x - a - 1, y + a).g) + set(texel(e, x - a, y + a).r);
        right = b_open
                    ? 0
                    : 2 * set(texel(e, x + b + 1, y - b).g) + set(texel(e, x + b + 1, y - b - 1).r);
        diagonal_area(left, right, a, b, area);
        w[0] += area[0];
        w[1] += area[1];
    }
    a = search_stair(e, x, y, -1, -1, 1, steps, &last, &a_open);
    b = b_open = 0;
    if (set(texel(e, x + 1, y).r)) {
        b = search_stair(e, x, y, 1, 1, 1, steps, &last, &b_open);
        b += set(last.g);
    }
    if (a + b > 2) {
        left =
            a_open ? 0 : 2 * set(texel(e, x - a - 1, y - a).g) + set(texel(e, x - a, y - a - 1).r);
        right =
            b_open ? 0 : 2 * set(texel(e, x + b + 1, y + b).g) + set(texel(e, x + b + 1, y + b).r);
        diagonal_area(left, right, a, b, area);
        w[0] += area[1]; /* for the mirrored line */
        w[1] += area[0];
    }
}

static uint8_t to_byte(float v) { return (uint8_t)nearbyintf(255 * (v < 0 ? 0 : v > 1 ? 1 : v)); }

void masu_ref_smaa_weights(const uint8_t *edges, uint32_t width, uint32_t height,
                           const struct masu_ref_smaa *with, uint8_t *weights) {
    edge_image e = {edges, (int)width, (int)height};
    for (int y = 0; y < e.height; y++) {
        for (int x = 0; x < e.width; x++, weights += 4) {
            pair here = texel(&e, x, y);
            float w[4] = {0, 0, 0, 0};
            if (set(here.g) && with->diagonal_steps) diagonal(&e, with, x, y, w);
            if (w[0] + w[1] == 0) {
                if (set(here.g)) straight(&e, with, 0, x, y, w);
                if (set(here.r)) straight(&e, with, 1, y, x, w + 2);
            }
            for (int c = 0; c < 4; c++) weights[c] = to_byte(w[c]);
        }
    }
}

/* ---- Blending -------------------------------------------------------------------------------- */

static void light_at(const struct masu_ref_image *in, int x, int y, double light[3]) {
    float rgb[3];
    read_rgb(in, x, y, rgb);
    for (int c = 0; c < 3; c++) light[c] = decode((double)rgb[c]);
}

void masu_ref_smaa_blend(const struct masu_ref_image *in, const uint8_t *weights, float *out) {
    int width = (int)in->width, height = (int)in->height;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++, out += 3) {
            const uint8_t *own = weights + 4 * ((size_t)y * in->width + (size_t)x);
            const uint8_t *right = x + 1 < width ? own + 4 : own;
            const uint8_t *below = y + 1 < height ? own + 4 * in->width : own;
            double a[4] = {right[3] / 255.0, below[1] / 255.0, own[2] / 255.0, own[0] / 255.0};
            int sideways = largest(a[0], a[2]) > largest(a[1], a[3]);
            double ahead = a[sideways ? 0 : 1], behind = a[sideways ? 2 : 3];
            double here[3], there[3], back[3];
            read_rgb(in, x, y, out);
            if (a[0] + a[1] + a[2] + a[3] < 1e-5) continue;
            light_at(in, x, y, here);
            light_at(in, x + sideways, y + !sideways, there);
            light_at(in, x - sideways, y - !sideways, back);
            for (int c = 0; c < 3; c++) {
                double one = here[c] + (there[c] - here[c]) * ahead;
                double two = here[c] + (back[c] - here[c]) * behind;
                out[c] = (float)encode((ahead * one + behind * two) / (ahead + behind));
            }
        }
    }
}

/* ---- FXAA ------------------------------------------------------------------------------------ */

/* Here linear light is the square of the value. */
static void add_light(const struct masu_ref_image *in, double x, double y, double share,
                      double sum[3]) {
    int i = (int)floor(x), j = (int)floor(y);
    double u = x - floor(x), v = y - floor(y);
    for (int k = 0; k < 4; k++) {
        double part = (k & 1 ? u : 1 - u) * (k & 2 ? v : 1 - v);
        float rgb[3];
        read_rgb(in, i + (k & 1), j + (k >> 1), rgb);
        for (int c = 0; c < 3; c++) sum[c] += share * part * (double)rgb[c] * (double)rgb[c];
    }
}

static double within(double v, double low, double high) {
    return v < low ? low : v > high ? high : v;
}

static void fxaa_pixel(const struct masu_ref_image *in, int x, int y, float out[3]) {
    double l[3][3], least = 1e30, most = -1e30;
    for (int pass = 0; pass < 2; pass++) { /* the four direct neighbours, then the corners */
        for (int k = 0; k < 9; k++) {
            int i = k % 3, j = k / 3, cross = i == 1 || j == 1;
            if (cross == pass) continue; /* not in this pass */
            l[j][i] = luma(in, x + i - 1, y + j - 1);
            least = l[j][i] < least ? l[j][i] : least;
            most = largest(most, l[j][i]);
        }
        if (!pass && most - least < largest(2550000.0 / 24, most / 8)) return;
    }
    double ax = (l[0][0] + 2 * l[0][1] + l[0][2]) - (l[2][0] + 2 * l[2][1] + l[2][2]);
    double ay = (l[0][2] + 2 * l[1][2] + l[2][2]) - (l[0][0] + 2 * l[1][0] + l[2][0]);
    double length = sqrt(ax * ax + ay * ay);
    if (length * length <= 1) return;
    ax /= length;
    ay /= length;
    double smaller = largest(8 * (fabs(ax) < fabs(ay) ? fabs(ax) : fabs(ay)), 1e-3);
    double fx = within(ax / smaller, -2, 2), fy = within(ay / smaller, -2, 2);
    double near[3] = {0, 0, 0}, wide[3] = {0, 0, 0};
    add_light(in, x - ax / 2, y - ay / 2, 0.5, near);
    add_light(in, x + ax / 2, y + ay / 2, 0.5, near);
    for (int c = 0; c < 3; c++) wide[c] = near[c] / 2;
    add_light(in, x - fx, y - fy, 0.25, wide);
    add_light(in, x + fx, y + fy, 0.25, wide);
    for (int c = 0; c < 3; c++) out[c] = (float)sqrt(wide[c]);
    double there = luma_of(out);
    if (there >= least && there <= most) return;
    for (int c = 0; c < 3; c++) out[c] = (float)sqrt(near[c]);
}

void masu_ref_fxaa(const struct masu_ref_image *in, float *out) {
    for (int y = 0; y < (int)in->height; y++) {
        for (int x = 0; x < (int)in->width; x++, out += 3) {
            read_rgb(in, x, y, out);
            fxaa_pixel(in, x, y, out);
        }
    }
}

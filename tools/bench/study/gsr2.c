/* gsr2.c: see gsr2.h. Constants are those of its shaders. */
#include "bench/study/gsr2.h"

#include "bench/measure/picture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float clamped(float v, float low, float high) { return fminf(fmaxf(v, low), high); }
static float unit(float v) { return clamped(v, 0.0f, 1.0f); }
static float mixed(float a, float b, float t) { return a + (b - a) * t; }

bool masu_gsr2_open(masu_gsr2 *g, const uint32_t from[2], const uint32_t to[2]) {
    size_t pixels = (size_t)from[0] * from[1], shown = (size_t)to[0] * to[1];
    memset(g, 0, sizeof *g);
    memcpy(g->from, from, sizeof g->from);
    memcpy(g->to, to, sizeof g->to);
    float *all = calloc(6 * pixels + 6 * shown, sizeof *all);
    if (!all) return false;
    g->color = all;
    g->moves = all + 3 * pixels;
    g->history[0] = all + 6 * pixels;
    g->history[1] = g->history[0] + 3 * shown;
    return true;
}

void masu_gsr2_close(masu_gsr2 *g) {
    free(g->color);
    memset(g, 0, sizeof *g);
}

static size_t texel(const uint32_t size[2], int x, int y) {
    int most[2] = {(int)size[0] - 1, (int)size[1] - 1};
    x = x < 0 ? 0 : x > most[0] ? most[0] : x;
    y = y < 0 ? 0 : y > most[1] ? most[1] : y;
    return (size_t)y * size[0] + (size_t)x;
}

/* Four texels of three floats; at: texels, 0.5 is the middle of the first. */
static void bilinear(const float *image, const uint32_t size[2], const float at[2], float out[3]) {
    float base[2] = {floorf(at[0] - 0.5f), floorf(at[1] - 0.5f)};
    float u = at[0] - 0.5f - base[0], v = at[1] - 0.5f - base[1];
    for (int k = 0; k < 3; k++) out[k] = 0.0f;
    for (int i = 0; i < 4; i++) {
        float weight = (i & 1 ? u : 1.0f - u) * (i & 2 ? v : 1.0f - v);
        const float *from = image + 3 * texel(size, (int)base[0] + (i & 1), (int)base[1] + (i >> 1));
        for (int k = 0; k < 3; k++) out[k] += weight * from[k];
    }
}

/* ---- First pass: of the render size ------------------------------------------------------------ */

/* Bright things count less; then luma and two chromas, in 11, 11 and 10 bits. */
static void convert_color(const uint8_t rgba[4], float out[3]) {
    float c[3], most = 1.0f;
    for (int k = 0; k < 3; k++) c[k] = masu_picture_decoded(rgba[k]);
    most += fmaxf(fmaxf(c[0], c[1]), c[2]);
    for (int k = 0; k < 3; k++) c[k] /= most;
    float luma = 0.25f * (c[0] + 2.0f * c[1] + c[2]), orange = unit(0.5f * c[0] + 0.5f - 0.5f * c[2]);
    float green = unit(luma + orange - c[0]);
    out[0] = rintf(luma * 2047.0f) / 2047.0f;
    out[1] = rintf(orange * 2046.0f) / 2046.0f - 0.5f;
    out[2] = rintf(green * 1022.0f) / 1022.0f - 0.5f;
}

static float nearest(const masu_gsr2 *g, const float *depth, int x, int y, int columns, int rows, size_t *where) {
    float most = -1.0f;
    for (int j = 0; j < rows; j++) {
        for (int i = 0; i < columns; i++) {
            size_t at = texel(g->from, x + i, y + j);
            if (depth[at] <= most) continue;
            most = depth[at];
            if (where) *where = at;
        }
    }
    return most;
}

/* In each corner of 4x4 pixels, whether what is nearest there is the surface in the middle. */
static float depth_breaks(const masu_gsr2 *g, const masu_gsr2_frame *f, int x, int y) {
    float middle = nearest(g, f->depth, x, y, 2, 2, NULL), same = 0.0f;
    if (!(middle > 1e-5f)) return 0.0f;
    float apart = 1.37e-5f * f->tan_x * hypotf((float)g->from[0], (float)g->from[1]) * middle;
    for (int i = 0; i < 4; i++) {
        float corner = nearest(g, f->depth, x - 1 + 2 * (i & 1), y - 1 + 2 * (i >> 1), 2, 2, NULL);
        same += unit(apart / (fabsf(middle - corner) + 1.19e-7f));
    }
    return unit(1.0f - 0.25f * same);
}

static void convert(masu_gsr2 *g, const masu_gsr2_frame *f) {
    for (int y = 0; y < (int)g->from[1]; y++) {
        for (int x = 0; x < (int)g->from[0]; x++) {
            size_t at = texel(g->from, x, y), front = at;
            convert_color(f->rgba + 4 * at, g->color + 3 * at);
            nearest(g, f->depth, x - 1, y - 1, 3, 3, &front);
            g->moves[3 * at] = f->motion[2 * front];
            g->moves[3 * at + 1] = f->motion[2 * front + 1];
            g->moves[3 * at + 2] = depth_breaks(g, f, x, y);
        }
    }
}

/* ---- Second pass: of the output ---------------------------------------------------------------- */

typedef struct samples {
    float mean[3]; /* by a kernel about the pixel of the output */
    float weight;  /* of that kernel, a third of the sum */
    float low[3], high[3], middle[3], deviation[3];
} samples;

/* Nine samples where the camera is still, else the cross of five. at: of the output's pixel, in pixels of the render
 * size; sampled: the same without the jitter, within the picture. */
static samples gather(const masu_gsr2 *g, const masu_gsr2_frame *f, const float at[2], const float sampled[2], float kernel,
                      float fall) {
    samples s = {{0}, 0.0f, {1, 1, 1}, {-1, -1, -1}, {0}, {0}};
    float box = 0.0f, squares[3] = {0};
    int base[2] = {(int)sampled[0], (int)sampled[1]};
    for (int i = 0; i < 9; i++) {
        int x = i % 3 - 1, y = i / 3 - 1;
        if (!f->still && x && y) continue;
        float dx = (float)(base[0] + x) + 0.5f + f->jitter[0] - at[0];
        float dy = (float)(base[1] + y) + 0.5f + f->jitter[1] - at[1];
        float far = dx * dx + dy * dy, lobe = unit(far * kernel * kernel) - 1.0f;
        float weight = (0.75f * lobe + lobe * lobe) * lobe * lobe, near = expf(far * fall);
        const float *c = g->color + 3 * texel(g->from, base[0] + x, base[1] + y);
        s.weight += weight;
        box += near;
        for (int k = 0; k < 3; k++) {
            s.mean[k] += weight * c[k];
            s.low[k] = fminf(s.low[k], c[k]);
            s.high[k] = fmaxf(s.high[k], c[k]);
            s.middle[k] += near * c[k];
            squares[k] += near * c[k] * c[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        s.middle[k] /= box;
        s.deviation[k] = sqrtf(fabsf(squares[k] / box - s.middle[k] * s.middle[k]));
        s.mean[k] = clamped(s.mean[k] / s.weight, s.low[k] - 0.05f, s.high[k] + 0.05f);
    }
    s.weight /= 3.0f;
    return s;
}

/* What of the past is believed: its share, and within what the samples show. */
static float believe(const samples *s, float breaks, float length, float box, float rest, float past[3]) {
    float share = 1.0f - breaks;
    bool outside = false;
    share = fminf(share, mixed(share, 10.0f * s->weight, unit(10.0f * length)));
    share = fminf(share, mixed(share, s->weight, unit(0.05f * length)));
    box = mixed(box, 1.0f, fmaxf(breaks, unit(0.05f * length)));
    float held[3];
    for (int k = 0; k < 3; k++) {
        float low = fmaxf(s->low[k], s->middle[k] - box * s->deviation[k]);
        float high = fminf(s->high[k], s->middle[k] + box * s->deviation[k]);
        held[k] = fminf(fmaxf(past[k], low), high);
        outside = outside || past[k] < low || past[k] > high;
    }
    if (!outside) return share;
    for (int k = 0; k < 3; k++) past[k] = mixed(held[k], past[k], rest);
    return mixed(fminf(share, 0.1f), share, rest);
}

static void show(const float c[3], uint8_t rgba[4]) {
    float rgb[3] = {unit(c[0] - c[2] + c[1]), unit(c[0] + c[2]), unit(c[0] - c[2] - c[1])};
    float most = fmaxf(fmaxf(rgb[0], rgb[1]), rgb[2]), scale = 1.0f / fmaxf(1.0f - most, 1e-3f);
    for (int k = 0; k < 3; k++) rgba[k] = masu_picture_encoded(rgb[k] * scale);
    rgba[3] = 255;
}

static void upscale_pixel(masu_gsr2 *g, const masu_gsr2_frame *f, uint32_t x, uint32_t y, uint8_t *rgba) {
    const float ratio[2] = {(float)g->to[0] / (float)g->from[0], (float)g->to[1] / (float)g->from[1]};
    const float middle[2] = {(float)x + 0.5f, (float)y + 0.5f};
    const float at[2] = {middle[0] / ratio[0], middle[1] / ratio[1]};
    const float sampled[2] = {clamped(at[0] - f->jitter[0], 0.0f, (float)g->from[0]),
                              clamped(at[1] - f->jitter[1], 0.0f, (float)g->from[1])};
    const bool cut = f->cut || !g->frames;
    size_t pixel = (size_t)y * g->to[0] + x;
    float moved[3], past[3], was[2];
    bilinear(g->moves, g->from, sampled, moved);
    for (int k = 0; k < 2; k++) was[k] = clamped(middle[k] + moved[k] * ratio[k], 0.0f, (float)g->to[k]);
    bilinear(g->history[g->frames & 1], g->to, was, past);
    /* The original's motion is of clip space, twice as long. */
    float length = 2.0f * hypotf(moved[0] * ratio[0], moved[1] * ratio[1]);
    float wide = cut ? 0.0f : fminf(ratio[0], 1.99f), narrow = fmaxf(1.0f, 0.3f + 0.3f * wide);
    float kernel = 0.5f * mixed(wide, narrow, cut ? 1.0f : 0.25f * moved[2]);
    samples s = gather(g, f, at, sampled, kernel, mixed(-2.0f, -3.0f, unit(0.02f * length)));
    float area = ratio[0] * ratio[1], box = fminf(20.0f, area * area * area);
    bool moves = length > 1e-6f * (float)g->to[0];
    float share = believe(&s, moved[2], length, box, moves ? 0.0f : f->rest, past);
    float new = cut ? 1.0f : unit(s.weight / fmaxf(1.192e-7f, share + s.weight));
    float *out = g->history[~g->frames & 1] + 3 * pixel;
    for (int k = 0; k < 3; k++) out[k] = mixed(past[k], s.mean[k], new);
    show(out, rgba + 4 * pixel);
}

void masu_gsr2_add(masu_gsr2 *g, const masu_gsr2_frame *frame, uint8_t *rgba) {
    convert(g, frame);
    for (uint32_t y = 0; y < g->to[1]; y++) {
        for (uint32_t x = 0; x < g->to[0]; x++) upscale_pixel(g, frame, x, y, rgba);
    }
    g->frames++;
}

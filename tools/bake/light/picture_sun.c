/* picture_sun.c: see picture_sun.h. The candidate is the spot around the brightest pixel;
 * masu_bake_cut_sun has the conditions. */
#include "bake/light/picture_sun.h"

#include "bake/scene/sun.h"
#include "cli/cli.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI MASU_BAKE_PI
#define DEGREE (PI / 180)
/* A sun has this share of all light, */
#define SHARE_MIN 0.1
/* and this share of the light of its surroundings within the cone: softer sources are lamps and
 * windows, which the harmonics and mips resolve. */
#define CONE (1.5 * DEGREE)
#define FOCUS_MIN 0.9
#define SURROUNDINGS (6 * DEGREE)
/* The background of the surroundings is the median of the ring beyond. */
#define BACKGROUND (12 * DEGREE)
/* Pixels of the cone are lowered to the median of this ring: the sky between the sun and its
 * aureole has no hole. */
#define RIM (3 * DEGREE)

enum { RED, GREEN, BLUE, LUMINANCE, CHANNELS };

typedef struct pixel {
    double angle; /* from the centre */
    double direction[3];
    double solid_angle;
    double light[CHANNELS]; /* radiance */
} pixel;

typedef void (*visitor)(void *context, const pixel *v, float *rgb);

static void read_pixel(const masu_bake_panorama *p, const float *rgb, double light[CHANNELS]) {
    for (uint32_t c = 0; c < 3; c++) light[c] = p->factor * (double)rgb[c];
    light[LUMINANCE] = 0.2126 * light[RED] + 0.7152 * light[GREEN] + 0.0722 * light[BLUE];
}

/* All pixels whose centres are within an angle of the centre. */
static void visit_disc(const masu_bake_panorama *p, const double centre[3], double radius,
                       visitor visit, void *context) {
    double polar = acos(fmin(fmax(centre[1], -1), 1)), row_height = PI / p->height;
    for (uint32_t y = 0; y < p->height; y++) {
        if (fabs((y + 0.5) * row_height - polar) > radius) continue;
        for (uint32_t x = 0; x < p->width; x++) {
            pixel v;
            masu_bake_panorama_pixel(p, x, y, v.direction, &v.solid_angle);
            double across = 0;
            for (uint32_t k = 0; k < 3; k++) across += pow(v.direction[k] - centre[k], 2);
            v.angle = 2 * asin(fmin(0.5 * sqrt(across), 1));
            if (v.angle > radius) continue;
            float *rgb = p->rgb + 3 * ((size_t)y * p->width + x);
            read_pixel(p, rgb, v.light);
            visit(context, &v, rgb);
        }
    }
}

/* ---- Medians --------------------------------------------------------------------------------- */

typedef struct ring {
    double inner;
    size_t count;
    double *values[CHANNELS]; /* NULL: only counts */
} ring;

static void add_to_ring(void *context, const pixel *v, float *rgb) {
    (void)rgb;
    ring *r = context;
    if (v->angle <= r->inner) return;
    for (uint32_t c = 0; c < CHANNELS && r->values[c]; c++) r->values[c][r->count] = v->light[c];
    r->count++;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void median_of_ring(const masu_bake_panorama *p, const double centre[3], double inner,
                           double outer, double out[CHANNELS]) {
    ring r = {.inner = inner};
    visit_disc(p, centre, outer, add_to_ring, &r);
    double *all = malloc((r.count + 1) * CHANNELS * sizeof *all);
    if (!all) {
        masu_cli_error("no memory for %zu pixels around the sun", r.count);
        exit(1);
    }
    for (uint32_t c = 0; c < CHANNELS; c++) r.values[c] = all + c * r.count;
    r.count = 0;
    visit_disc(p, centre, outer, add_to_ring, &r);
    for (uint32_t c = 0; c < CHANNELS; c++) {
        out[c] = 0;
        if (!r.count) continue;
        qsort(r.values[c], r.count, sizeof(double), by_value);
        out[c] = r.values[c][r.count / 2];
    }
    free(all);
}

/* ---- The spot -------------------------------------------------------------------------------- */

/* Light above the background: radiance times solid angle. */
typedef struct spot {
    double background, whole, within;
    double toward[3]; /* directions weighted by it, of the cone */
} spot;

static void add_to_spot(void *context, const pixel *v, float *rgb) {
    (void)rgb;
    spot *s = context;
    double light = fmax(v->light[LUMINANCE] - s->background, 0) * v->solid_angle;
    s->whole += light;
    if (v->angle > CONE) return;
    s->within += light;
    for (uint32_t k = 0; k < 3; k++) s->toward[k] += light * v->direction[k];
}

static bool normalize(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (uint32_t k = 0; k < 3; k++) v[k] /= length;
    return isfinite(length) && length > 0 && isfinite(1 / length);
}

static spot measure(const masu_bake_panorama *p, const double centre[3]) {
    double median[CHANNELS];
    median_of_ring(p, centre, SURROUNDINGS, BACKGROUND, median);
    spot s = {.background = median[LUMINANCE]};
    visit_disc(p, centre, SURROUNDINGS, add_to_spot, &s);
    return s;
}

typedef struct cut {
    double rim[CHANNELS], factor;
    double sum[3], toward[3];
} cut;

static void cut_pixel(void *context, const pixel *v, float *rgb) {
    cut *t = context;
    for (uint32_t c = 0; c < 3; c++) {
        double excess = v->light[c] - t->rim[c];
        if (!(excess > 0)) continue;
        t->sum[c] += excess * v->solid_angle;
        for (uint32_t k = 0; k < 3; k++) t->toward[k] += excess * v->solid_angle * v->direction[k];
        rgb[c] = (float)(t->rim[c] / t->factor);
    }
}

/* The brightest pixel and the luminance of the whole sphere, times solid angle. */
static double brightest(const masu_bake_panorama *p, double direction[3]) {
    double total = 0, most = 0, light[CHANNELS], d[3], solid_angle;
    for (uint32_t y = 0; y < p->height; y++) {
        masu_bake_panorama_pixel(p, 0, y, d, &solid_angle);
        for (uint32_t x = 0; x < p->width; x++) {
            read_pixel(p, p->rgb + 3 * ((size_t)y * p->width + x), light);
            total += light[LUMINANCE] * solid_angle;
            if (!(light[LUMINANCE] > most)) continue;
            most = light[LUMINANCE];
            masu_bake_panorama_pixel(p, x, y, direction, &solid_angle);
        }
    }
    return total;
}

bool masu_bake_cut_sun(masu_bake_panorama *p, masu_bake_picture_sun *out) {
    double centre[3] = {0, 1, 0}, total = brightest(p, centre);
    /* A pixel wider than the cone has no information about the size of the source. */
    if (!(total > 0) || PI / p->height > CONE || 2 * PI / p->width > CONE) return false;
    spot s = measure(p, centre);
    /* The brightest pixel of an overexposed sun can be anywhere on its disc: repeat around the
     * centroid. */
    memcpy(centre, s.toward, sizeof centre);
    if (!normalize(centre)) return false;
    s = measure(p, centre);
    if (!(s.within >= SHARE_MIN * total) || !(s.within >= FOCUS_MIN * s.whole)) return false;
    cut t = {.factor = p->factor};
    median_of_ring(p, centre, CONE, RIM, t.rim);
    visit_disc(p, centre, CONE, cut_pixel, &t);
    if (!normalize(t.toward)) return false;
    memcpy(out->direction, t.toward, sizeof out->direction);
    for (uint32_t c = 0; c < 3; c++) out->color[c] = fmin(t.sum[c] / PI, MASU_BAKE_SUN_COLOR_MAX);
    return true;
}

/* sky.c: see sky.h. */
#include "lab/reference/sky.h"

#include <stdlib.h>
#include <string.h>

enum { POINTS = 3, GRID_MOST = 1024 };
#define FLOOR 0.02 /* fraction of samples that ignore the map: its density is nowhere 0 */

/* ---- Radiance -------------------------------------------------------------------------------- */

static ref_vec texel_9995(uint32_t texel) {
    double unit = ldexp(1, (int)(texel >> 27) - 24);
    return ref_scale(ref_v(texel & 511, texel >> 9 & 511, texel >> 18 & 511), unit);
}

/* Beyond an edge of the square is the same edge, in the opposite direction. */
static ref_vec octahedron_texel(const ref_sky *s, int64_t x, int64_t y) {
    int64_t n = s->size;
    if (x < 0 || x >= n) {
        x = x < 0 ? -1 - x : 2 * n - 1 - x;
        y = n - 1 - y;
    }
    if (y < 0 || y >= n) {
        y = y < 0 ? -1 - y : 2 * n - 1 - y;
        x = n - 1 - x;
    }
    return texel_9995(s->octahedron[y * n + x]);
}

static ref_vec octahedron_at(const ref_sky *s, ref_vec d) {
    double sum = fabs(d.x) + fabs(d.y) + fabs(d.z), x = d.x / sum, z = d.z / sum;
    if (d.y < 0) {
        double old = x;
        x = (1 - fabs(z)) * (old < 0 ? -1 : 1);
        z = (1 - fabs(old)) * (z < 0 ? -1 : 1);
    }
    double u = (x * 0.5 + 0.5) * s->size - 0.5, v = (z * 0.5 + 0.5) * s->size - 0.5;
    int64_t i = (int64_t)floor(u), k = (int64_t)floor(v);
    double pu = u - floor(u), pv = v - floor(v);
    ref_vec top = ref_mix(octahedron_texel(s, i, k), octahedron_texel(s, i + 1, k), pu);
    return ref_mix(
        top, ref_mix(octahedron_texel(s, i, k + 1), octahedron_texel(s, i + 1, k + 1), pu), pv);
}

static ref_vec pixel(const ref_sky *s, double column, double row) {
    double w = s->width, x = column - w * floor(column / w), y = ref_clamp(row, 0, s->height - 1.0);
    const float *p = s->panorama + 3 * ((size_t)y * s->width + (size_t)fmin(x, w - 1));
    return ref_of(p);
}

/* The azimuth increases from +Z to +X, to the left of the image's centre. */
static ref_vec panorama_at(const ref_sky *s, ref_vec d) {
    double azimuth = atan2(d.x, d.z), polar = acos(ref_clamp(d.y / ref_length(d), -1, 1));
    double x = (0.5 - (azimuth - s->turn) / (2 * REF_PI)) * s->width - 0.5;
    double y = polar / REF_PI * s->height - 0.5, px = x - floor(x), py = y - floor(y);
    ref_vec top = ref_mix(pixel(s, floor(x), floor(y)), pixel(s, floor(x) + 1, floor(y)), px);
    ref_vec low =
        ref_mix(pixel(s, floor(x), floor(y) + 1), pixel(s, floor(x) + 1, floor(y) + 1), px);
    return ref_scale(ref_mix(top, low, py), s->factor);
}

ref_vec ref_sky_at(const ref_sky *s, ref_vec d) {
    if (s->panorama) return panorama_at(s, d);
    if (s->octahedron) return octahedron_at(s, d);
    return ref_mix(s->horizon, s->zenith, sqrt(ref_clamp(d.y, 0, 1)));
}

ref_vec ref_sky_soft(const ref_sky *s, ref_vec d) {
    return ref_sky_is_map(s) ? ref_sky_at(s, d) : s->ambient;
}

/* ---- Distribution ---------------------------------------------------------------------------- */

/* The panorama's pixels, or cells with the size of the octahedron's texels. */
static ref_vec direction_at(const ref_sky *s, double column, double row) {
    double polar = REF_PI * row / s->grid_height;
    double azimuth = s->turn + (0.5 - column / s->grid_width) * 2 * REF_PI;
    return ref_v(sin(polar) * sin(azimuth), cos(polar), sin(polar) * cos(azimuth));
}

static double solid_angle(const ref_sky *s, uint32_t row) {
    double a = cos(REF_PI * row / s->grid_height), b = cos(REF_PI * (row + 1) / s->grid_height);
    return (a - b) * 2 * REF_PI / s->grid_width;
}

/* Includes corners: a bilinear lookup spreads a bright pixel over its neighbours. */
static double cell(const ref_sky *s, uint32_t column, uint32_t row) {
    double sum = 0;
    for (int i = 0; i < POINTS * POINTS; i++) {
        ref_vec d = direction_at(s, column + (i % POINTS) * (1.0 / (POINTS - 1)),
                                 row + (i / POINTS) * (1.0 / (POINTS - 1)));
        sum += ref_luminance(ref_sky_at(s, d));
    }
    return sum * solid_angle(s, row);
}

bool ref_sky_prepare(ref_sky *s) {
    if (!ref_sky_is_map(s)) return true;
    uint32_t w = s->panorama ? s->width : 4 * s->size, h = s->panorama ? s->height : 2 * s->size;
    while (w > GRID_MOST) w = (w + 1) / 2, h = (h + 1) / 2;
    s->grid_width = w < 2 ? 2 : w;
    s->grid_height = h < 2 ? 2 : h;
    s->rows = calloc(s->grid_height + 1, sizeof *s->rows);
    s->columns = calloc((size_t)s->grid_height * s->grid_width + 1, sizeof *s->columns);
    if (!s->rows || !s->columns) return false;
    for (uint32_t y = 0; y < s->grid_height; y++) {
        double *row = s->columns + (size_t)y * s->grid_width, sum = 0;
        for (uint32_t x = 0; x < s->grid_width; x++) row[x] = sum += cell(s, x, y);
        for (uint32_t x = 0; x < s->grid_width; x++)
            row[x] = sum > 0 ? row[x] / sum : (x + 1.0) / s->grid_width;
        s->rows[y] = sum + (y ? s->rows[y - 1] : 0);
    }
    double all = s->rows[s->grid_height - 1];
    for (uint32_t y = 0; y < s->grid_height; y++)
        s->rows[y] = all > 0 ? s->rows[y] / all : (y + 1.0) / s->grid_height;
    return true;
}

void ref_sky_close(ref_sky *s) {
    free(s->rows);
    free(s->columns);
    s->rows = s->columns = NULL;
}

/* The first entry whose cumulative share exceeds u. */
static uint32_t find(const double *shares, uint32_t count, double u) {
    uint32_t low = 0, high = count - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (shares[middle] > u)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static double share(const double *shares, uint32_t i) {
    return shares[i] - (i ? shares[i - 1] : 0);
}

double ref_sky_pdf(const ref_sky *s, ref_vec d) {
    double azimuth = atan2(d.x, d.z) - s->turn, polar = acos(ref_clamp(d.y / ref_length(d), -1, 1));
    double x = 0.5 - azimuth / (2 * REF_PI);
    x -= floor(x);
    uint32_t column = (uint32_t)ref_clamp(x * s->grid_width, 0, s->grid_width - 1.0);
    uint32_t row = (uint32_t)ref_clamp(polar / REF_PI * s->grid_height, 0, s->grid_height - 1.0);
    double p = share(s->rows, row) * share(s->columns + (size_t)row * s->grid_width, column);
    return (1 - FLOOR) * p / solid_angle(s, row) + FLOOR / (4 * REF_PI);
}

ref_vec ref_sky_sample(const ref_sky *s, ref_random *r, double *pdf) {
    double which = ref_draw(r);
    double u = ref_draw(r);
    double v = ref_draw(r);
    double x = ref_draw(r);
    double y = ref_draw(r);
    ref_vec d;
    if (which < FLOOR) {
        double up = 1 - 2 * u, phi = 2 * REF_PI * v, flat = sqrt(fmax(1 - up * up, 0));
        d = ref_v(flat * sin(phi), up, flat * cos(phi));
    } else {
        uint32_t row = find(s->rows, s->grid_height, u);
        uint32_t column = find(s->columns + (size_t)row * s->grid_width, s->grid_width, v);
        double a = cos(REF_PI * row / s->grid_height), b = cos(REF_PI * (row + 1) / s->grid_height);
        double up = a + y * (b - a), flat = sqrt(fmax(1 - up * up, 0));
        double azimuth = s->turn + (0.5 - (column + x) / s->grid_width) * 2 * REF_PI;
        d = ref_v(flat * sin(azimuth), up, flat * cos(azimuth));
    }
    *pdf = ref_sky_pdf(s, d);
    return d;
}

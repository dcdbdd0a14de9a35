/* make.c: procedural asphalt, gravel and grass. All random numbers are from one integer generator
 * that starts at the seed, so that a patch is the same on every machine. Lengths are fractions of
 * the period, which represents some 16 cm of asphalt, 40 cm of gravel, 30 cm of grass.
 *
 *   asphalt  a height field: rounded stones in binder, rolled flat on top, with a second, finer
 *            roughness on stones and binder
 *   gravel   a mesh: a pile of ellipsoids, with overhangs and holes
 *   grass    a mesh: blades as curved strips over soil, darker at the root */
#include "meso/patch.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

const char *const masu_meso_made[] = {"asphalt", "gravel", "grass", NULL};

#define PI MASU_BAKE_PI

/* SplitMix64 (Steele, Lea and Flood, OOPSLA 2014): every seed is good. */
static double random_unit(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static double random_in(uint64_t *state, double low, double high) {
    return low + (high - low) * random_unit(state);
}

/* Signed distance of a and b on a circle of length 1, -0.5..0.5. */
static double around(double a, double b) {
    double d = a - b;
    return d - floor(d + 0.5);
}

/* ---- asphalt ---- */

typedef struct disc {
    double x, z, radius, top, turn, longer, shade;
} disc;

/* Smooth value noise over `cells` cells of the period, -1..1. */
static double noise(double x, double z, int cells, uint64_t seed) {
    double fx = x * cells, fz = z * cells, value[2][2];
    int ix = (int)floor(fx), iz = (int)floor(fz);
    double u = fx - ix, v = fz - iz;
    for (int j = 0; j < 2; j++) {
        for (int i = 0; i < 2; i++) {
            uint64_t cx = (uint64_t)((ix + i + 4 * cells) % cells);
            uint64_t state = seed + (uint64_t)((iz + j + 4 * cells) % cells) * 7919u + cx;
            value[j][i] = 2 * random_unit(&state) - 1;
        }
    }
    u = u * u * (3 - 2 * u);
    v = v * v * (3 - 2 * v);
    return (value[0][0] * (1 - u) + value[0][1] * u) * (1 - v) +
           (value[1][0] * (1 - u) + value[1][1] * u) * v;
}

/* Places random discs without overlap; the radius decreases with the number of attempts. */
static uint32_t throw_discs(disc *discs, uint32_t most, uint64_t *state) {
    uint32_t count = 0;
    for (uint32_t t = 0; t < 40000 && count < most; t++) {
        double ease = t / 40000.0;
        disc d = {
            random_unit(state), random_unit(state), 0.055 * (1 - ease) + 0.014 * ease, 0, 0, 0, 0};
        d.radius *= random_in(state, 0.8, 1.2);
        bool fits = true;
        for (uint32_t i = 0; i < count && fits; i++) {
            double dx = around(d.x, discs[i].x), dz = around(d.z, discs[i].z);
            double gap = 0.92 * (d.radius + discs[i].radius);
            fits = dx * dx + dz * dz > gap * gap;
        }
        if (!fits) continue;
        d.top = random_in(state, -0.006, 0.004);
        d.turn = random_in(state, 0, PI);
        d.longer = random_in(state, 1.0, 1.35);
        d.shade = random_in(state, 0.75, 1.25);
        discs[count++] = d;
    }
    return count;
}

static void make_asphalt(uint32_t detail, uint64_t state, masu_meso_patch *patch) {
    enum { MOST = 1500 };
    uint32_t size = 96 * detail;
    uint64_t seed = state * 1013904223u + 17;
    disc *discs = malloc(MOST * sizeof *discs);
    double *height = malloc((size_t)size * size * sizeof *height);
    double *color = malloc((size_t)size * size * 3 * sizeof *color);
    if (!discs || !height || !color) exit(masu_cli_error("out of memory"));
    uint32_t count = throw_discs(discs, MOST, &state);
    for (uint32_t j = 0; j < size; j++) {
        for (uint32_t i = 0; i < size; i++) {
            double x = (double)i / size, z = (double)j / size, shade = 1, stone = 0;
            double h = -0.028 + 0.004 * noise(x, z, 24, seed); /* the binder between the stones */
            for (uint32_t k = 0; k < count; k++) {
                const disc *d = &discs[k];
                double dx = around(x, d->x), dz = around(z, d->z);
                if (dx * dx + dz * dz > 2 * d->radius * d->radius) continue;
                double u = (dx * cos(d->turn) + dz * sin(d->turn)) / (d->radius * d->longer);
                double v = (dz * cos(d->turn) - dx * sin(d->turn)) / d->radius;
                double r = u * u + v * v;
                if (r >= 1) continue;
                /* an ellipsoid with its top rolled flat */
                double s = sqrt(1 - r), flat = s < 0.75 ? s : 0.75 + 0.25 * (s - 0.75);
                double y = d->top + (flat - 0.8) * 0.9 * d->radius;
                if (y > h) {
                    h = y;
                    stone = 1;
                    shade = d->shade;
                }
            }
            h += 0.0012 * noise(x, z, 96, seed + 1) + 0.0022 * noise(x, z, 48, seed + 2);
            double *c = color + 3 * ((size_t)j * size + i);
            height[(size_t)j * size + i] = h;
            for (int k = 0; k < 3; k++) {
                static const double stone_color[3] = {0.16, 0.155, 0.145};
                static const double binder[3] = {0.055, 0.055, 0.058};
                c[k] = stone > 0 ? stone_color[k] * shade : binder[k];
            }
        }
    }
    masu_meso_patch_from_grid(patch, height, color, NULL, size);
    patch->roughness = 0.5;
    free(discs);
    free(height);
    free(color);
}

/* ---- gravel ---- */

typedef struct stone {
    masu_meso_vec3 center, axis[3]; /* axes as long as the half extents */
    double shade;
} stone;

/* Top of the ellipsoid above (x, z), or -1. With p = c + A q, |q| = 1, the vertical line through
 * (x, z) intersects it at the roots of a quadratic in y. */
static double stone_top(const stone *s, double x, double z) {
    double dx = around(x, s->center.x), dz = around(z, s->center.z), a = 0, b = 0, c = -1;
    for (int k = 0; k < 3; k++) {
        double l2 = masu_bake_dot(s->axis[k], s->axis[k]);
        double up = s->axis[k].y / l2, side = (s->axis[k].x * dx + s->axis[k].z * dz) / l2;
        a += up * up;
        b += up * side;
        c += side * side;
    }
    double d = b * b - a * c;
    return d < 0 ? -1 : s->center.y + (-b + sqrt(d)) / a;
}

static void random_axes(uint64_t *state, masu_meso_vec3 axis[3]) {
    masu_meso_vec3 v[2];
    for (int k = 0; k < 2; k++) {
        v[k] =
            masu_bake_v3(random_in(state, -1, 1), random_in(state, -1, 1), random_in(state, -1, 1));
    }
    /* Stones are flat rather than upright: the short axis leans towards the vertical. */
    axis[2] = masu_bake_v3(v[0].x * 0.6, 1, v[0].z * 0.6);
    masu_bake_normalize(&axis[2]);
    axis[0] = masu_bake_cross(v[1], axis[2]);
    if (!masu_bake_normalize(&axis[0])) axis[0] = masu_bake_v3(1, 0, 0);
    axis[1] = masu_bake_cross(axis[2], axis[0]);
}

/* A sphere of rings, scaled to the ellipsoid, with small dents so that no two are alike. */
static void add_stone(const stone *s, uint32_t rings, uint64_t *state, const double tint[3],
                      masu_meso_patch *patch) {
    double phase[3] = {random_in(state, 0, 6), random_in(state, 0, 6), random_in(state, 0, 6)};
    uint32_t around_count = 2 * rings, first = patch->vertex_count;
    double color[3];
    for (int k = 0; k < 3; k++) color[k] = tint[k] * s->shade;
    for (uint32_t j = 0; j <= rings; j++) {
        for (uint32_t i = 0; i < around_count; i++) {
            double t = PI * j / rings, f = 2 * PI * i / around_count;
            double q[3] = {sin(t) * cos(f), sin(t) * sin(f), cos(t)};
            double dent = 1 + 0.07 * sin(3 * q[0] + phase[0]) * sin(3 * q[1] + phase[1]) +
                          0.05 * sin(5 * q[2] + phase[2]);
            masu_meso_vec3 p = s->center;
            for (int k = 0; k < 3; k++) p = masu_bake_mad(p, s->axis[k], q[k] * dent);
            masu_meso_vertex(patch, p, color);
        }
    }
    for (uint32_t j = 0; j < rings; j++) {
        for (uint32_t i = 0; i < around_count; i++) {
            uint32_t a = first + j * around_count + i;
            uint32_t b = first + j * around_count + (i + 1) % around_count;
            if (j > 0) masu_meso_triangle(patch, a, b, a + around_count);
            if (j + 1 < rings) masu_meso_triangle(patch, b, b + around_count, a + around_count);
        }
    }
}

static void add_ground(masu_meso_patch *patch, const double color[3]) {
    enum { SIDE = 4 };
    double height[SIDE * SIDE] = {0};
    masu_meso_patch_from_grid(patch, height, NULL, color, SIDE);
}

static void make_gravel(uint32_t detail, uint64_t state, masu_meso_patch *patch) {
    enum { MOST = 420 };
    stone *stones = malloc(MOST * sizeof *stones);
    if (!stones) exit(masu_cli_error("out of memory"));
    static const double soil[3] = {0.10, 0.085, 0.07}, tint[3] = {0.32, 0.30, 0.27};
    add_ground(patch, soil);
    for (uint32_t i = 0; i < MOST; i++) {
        stone *s = &stones[i];
        double size = random_in(&state, 0.028, 0.052);
        s->center = masu_bake_v3(random_unit(&state), 0, random_unit(&state));
        random_axes(&state, s->axis);
        static const double share[3] = {1.15, 0.9, 0.65};
        for (int k = 0; k < 3; k++) {
            s->axis[k] = masu_bake_mad(masu_bake_v3(0, 0, 0), s->axis[k], size * share[k]);
        }
        s->shade = random_in(&state, 0.6, 1.4);
        /* The stone rests on the surface below its centre and four points around it: the mean of
         * the two highest, so that stones touch without standing on points. */
        double top[2] = {0, 0};
        for (int k = 0; k < 5; k++) {
            double x = s->center.x + (k == 1 ? 0.5 : k == 2 ? -0.5 : 0) * size;
            double z = s->center.z + (k == 3 ? 0.5 : k == 4 ? -0.5 : 0) * size, here = 0;
            for (uint32_t j = 0; j < i; j++) here = fmax(here, stone_top(&stones[j], x, z));
            if (here > top[0]) {
                top[1] = top[0];
                top[0] = here;
            } else if (here > top[1]) {
                top[1] = here;
            }
        }
        s->center.y = 0.5 * (top[0] + top[1]) + 0.35 * size * share[2];
        /* Limits the height of the pile: higher stones are placed lower. */
        if (s->center.y > 0.075) s->center.y = random_in(&state, 0.05, 0.075);
        add_stone(s, 6 + 4 * detail, &state, tint, patch);
    }
    patch->roughness = 0.6;
    free(stones);
}

/* ---- grass ---- */

static void add_blade(uint32_t parts, uint64_t *state, masu_meso_patch *patch) {
    double x = random_unit(state), z = random_unit(state);
    double length = random_in(state, 0.10, 0.19), width = random_in(state, 0.0055, 0.0095);
    double heading = random_in(state, 0, 2 * PI), lean = random_in(state, 0.05, 0.55);
    double bend = random_in(state, 0.2, 1.3), twist = random_in(state, -0.8, 0.8);
    double dry = random_unit(state) < 0.12 ? 1 : 0, shade = random_in(state, 0.8, 1.2);
    masu_meso_vec3 p = masu_bake_v3(x, 0, z);
    uint32_t before[2] = {0, 0};
    for (uint32_t i = 0; i <= parts; i++) {
        double t = (double)i / parts, angle = lean + bend * t;
        double turn = heading + PI / 2 + twist * t;
        double half = 0.5 * width * (1 - 0.9 * t * t);
        static const double root[3] = {0.045, 0.060, 0.020}, tip[3] = {0.085, 0.160, 0.035};
        static const double straw[3] = {0.26, 0.21, 0.09};
        double color[3];
        for (int k = 0; k < 3; k++) {
            double green = root[k] + (tip[k] - root[k]) * t;
            color[k] = shade * (dry > 0 ? straw[k] * (0.6 + 0.4 * t) : green);
        }
        masu_meso_vec3 side = masu_bake_v3(cos(turn) * half, 0, sin(turn) * half);
        uint32_t left = masu_meso_vertex(patch, masu_bake_mad(p, side, -1), color);
        uint32_t right = masu_meso_vertex(patch, masu_bake_mad(p, side, 1), color);
        if (i > 0) {
            masu_meso_triangle(patch, before[0], before[1], left);
            masu_meso_triangle(patch, before[1], right, left);
        }
        before[0] = left;
        before[1] = right;
        masu_meso_vec3 ahead =
            masu_bake_v3(sin(angle) * cos(heading), cos(angle), sin(angle) * sin(heading));
        p = masu_bake_mad(p, ahead, length / parts);
    }
}

static void make_grass(uint32_t detail, uint64_t state, masu_meso_patch *patch) {
    static const double soil[3] = {0.07, 0.055, 0.04};
    add_ground(patch, soil);
    for (uint32_t i = 0; i < 1500; i++) add_blade(2 + 2 * detail, &state, patch);
    patch->roughness = 0.55;
}

bool masu_meso_make(const char *name, uint32_t detail, uint32_t seed, masu_meso_patch *patch) {
    *patch = (masu_meso_patch){0};
    uint64_t state = seed;
    if (!strcmp(name, "asphalt")) {
        make_asphalt(detail, state, patch);
    } else if (!strcmp(name, "gravel")) {
        make_gravel(detail, state, patch);
    } else if (!strcmp(name, "grass")) {
        make_grass(detail, state, patch);
    } else {
        return false;
    }
    masu_meso_patch_finish(patch);
    return true;
}

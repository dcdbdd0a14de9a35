/* fit.c: see fit.h. */
#include "meso/fit.h"

#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

/* facet is measured, not fitted */
#define FREE 20u
#define STEPS 60
/* Number of reweightings of angles, and the wanted improvement over plain normal mapping at each
 * angle. */
#define ROUNDS 4
#define WANTED 3.0
/* The filtered residuals use every n-th light and view of the setup. */
#define FILTERED_LIGHTS 5u
/* Weight of the light that a mip must preserve. With 1.2 grass has an error of 5.2 % from above;
 * with 5 mips preserve no more light, and the error of grass at 88 degrees is 9 times lower instead
 * of 10. */
#define KEEP 2.5

typedef union numbers {
    masu_meso_curves curves;
    double v[MASU_MESO_NUMBERS];
} numbers;

_Static_assert(sizeof(masu_meso_curves) == MASU_MESO_NUMBERS * sizeof(double), "no gaps");

/* Limits of each number, and a weight (HOLD) towards its start: otherwise fits to a finite set of
 * lights would gain a thousandth with absurd curves. */
typedef struct limit {
    double low, high;
} limit;

static const limit limits[MASU_MESO_NUMBERS] = {
    {-2, 3}, {-6, 6}, {-6, 6}, {0, 1},    /* tilt, facet */
    {-2, 2}, {-5, 5}, {-5, 5}, {-4, 8},   /* rough, spread */
    {-3, 5}, {-8, 8}, {-8, 8}, {0, 4},    /* ao, alpha */
    {-3, 3}, {-6, 6}, {-6, 6}, {0, 2},    /* gain, offset */
    {-3, 3}, {-3, 3}, {-3, 3}, {-30, 30}, /* tint, spread by y */
    {0, 1},  {-3, 3}, {-3, 3}, {-30, 30}, /* specular, spread by y^2 */
};
#define HOLD 0.002
/* For spread1 and spread2: they multiply a spread far below 1, so they are larger numbers. */
#define HOLD_SPREAD 0.0005

typedef struct problem {
    const masu_meso_samples *s;
    masu_meso_shader shader;
    masu_meso_texel mean, fine_mean; /* of the samples' texels */
    double near_mean;
    double weight[MASU_MESO_VIEWS_MAX], plain[MASU_MESO_VIEWS_MAX];
    size_t residuals;
    numbers start;
    /* Directions of the setup's lights and of the near ones: constant, used in every evaluation. */
    masu_meso_vec3 light[MASU_MESO_LIGHTS_MAX], near_light[MASU_MESO_NEAR_LIGHTS_MAX];
} problem;

static size_t far_count(const masu_meso_samples *s) {
    return (size_t)s->setup->view_count * (s->setup->light_count + 1) * 3;
}
static size_t near_count(const masu_meso_samples *s) {
    return (size_t)s->texel_count * s->near_count * 3;
}
static uint32_t filtered_lights(const masu_meso_samples *s) {
    return (s->setup->light_count + FILTERED_LIGHTS - 1) / FILTERED_LIGHTS;
}
static size_t filtered_count(const masu_meso_samples *s) {
    return (size_t)s->setup->view_count * filtered_lights(s) * 3;
}

static size_t kept_count(const masu_meso_samples *s) { return (size_t)s->setup->view_count * 3; }

static double mean_radiance(const masu_meso_view *view, uint32_t lights) {
    double sum = 0;
    for (uint32_t j = 0; j < lights; j++) {
        for (int k = 0; k < 3; k++) sum += view->sun[j][k] + MASU_MESO_SKY * view->sky[k];
    }
    return fmax(sum / (3.0 * lights), 1e-6);
}

static double *far_residuals(const problem *p, double *r) {
    const masu_meso_samples *s = p->s;
    for (uint32_t i = 0; i < s->setup->view_count; i++) {
        const masu_meso_view *view = &s->views[i];
        masu_meso_vec3 v = masu_meso_from_above(view->angle, 0);
        masu_meso_surface seen = masu_meso_seen(&p->shader, &s->mean, v);
        double sky[3] = {0, 0, 0};
        double mean = mean_radiance(view, s->setup->light_count) / p->weight[i];
        masu_meso_add_sky(&p->shader, &seen, v, MASU_MESO_SKY, sky);
        for (uint32_t j = 0; j < s->setup->light_count; j++) {
            double got[3] = {sky[0], sky[1], sky[2]};
            masu_meso_add_sun(&p->shader, &seen, v, p->light[j], got);
            for (int k = 0; k < 3; k++) {
                *r++ = (got[k] - view->sun[j][k] - MASU_MESO_SKY * view->sky[k]) / mean;
            }
        }
        /* Weighs the sky separately again: it must not compensate for the sun. */
        for (int k = 0; k < 3; k++) {
            *r++ = 4 * (sky[k] - MASU_MESO_SKY * view->sky[k]) / mean;
        }
    }
    return r;
}

/* A view is weighted by the error of plain normal mapping: the aim is the improvement by the
 * curves, including the worst angle. */
static void weigh_views(problem *p, double *r) {
    uint32_t numbers = (p->s->setup->light_count + 1) * 3;
    for (uint32_t i = 0; i < p->s->setup->view_count; i++) p->weight[i] = 1;
    p->shader.way = MASU_MESO_PLAIN;
    far_residuals(p, r);
    p->shader.way = MASU_MESO_CURVES;
    for (uint32_t i = 0; i < p->s->setup->view_count; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < numbers - 3; k++) sum += r[i * numbers + k] * r[i * numbers + k];
        double plain = sqrt(sum / (numbers - 3));
        p->plain[i] = fmax(plain, 1e-3);
        p->weight[i] = fmin(fmax(0.3 / p->plain[i], 0.2), 1.5);
    }
}

/* Increases the weight of angles at which the curves improve by less than WANTED. Returns false if
 * there are none. */
static bool weigh_again(problem *p, const numbers *n, double *r) {
    uint32_t views = p->s->setup->view_count, numbers = (p->s->setup->light_count + 1) * 3;
    bool again = false;
    p->shader.curves = n->curves;
    far_residuals(p, r);
    for (uint32_t i = 0; i < views; i++) {
        double sum = 0;
        for (uint32_t k = 0; k < numbers - 3; k++) sum += r[i * numbers + k] * r[i * numbers + k];
        double share = sqrt(sum / (numbers - 3)) / p->weight[i] / p->plain[i];
        if (share * WANTED > 1) {
            p->weight[i] *= fmin(share * WANTED, 1.6);
            again = true;
        }
    }
    return again;
}

static double *near_residuals(const problem *p, double weight, double *r) {
    const masu_meso_samples *s = p->s;
    const masu_meso_vec3 v = {0, 1, 0};
    const double *want = s->near;
    for (uint32_t t = 0; t < s->texel_count; t++) {
        masu_meso_surface seen = masu_meso_seen(&p->shader, &s->texels[t], v);
        double sky[3] = {0, 0, 0};
        masu_meso_add_sky(&p->shader, &seen, v, MASU_MESO_SKY, sky);
        for (uint32_t j = 0; j < s->near_count; j++) {
            double got[3] = {sky[0], sky[1], sky[2]};
            masu_meso_add_sun(&p->shader, &seen, v, p->near_light[j], got);
            for (int k = 0; k < 3; k++) *r++ = weight * (got[k] - *want++) / p->near_mean;
        }
    }
    return r;
}

static double *filtered_residuals(const problem *p, double weight, double *r) {
    const masu_meso_samples *s = p->s;
    uint32_t lights = filtered_lights(s);
    for (uint32_t i = 0; i < s->setup->view_count; i++) {
        masu_meso_vec3 v = masu_meso_from_above(s->views[i].angle, 0);
        double scale = weight / mean_radiance(&s->views[i], s->setup->light_count);
        memset(r, 0, lights * 3 * sizeof *r);
        for (uint32_t t = 0; t <= s->texel_count; t++) {
            bool last = t == s->texel_count;
            double part = last ? -scale : scale / s->texel_count;
            masu_meso_surface seen = masu_meso_seen(&p->shader, last ? &p->mean : &s->texels[t], v);
            for (uint32_t j = 0; j < lights; j++) {
                double got[3] = {0, 0, 0};
                masu_meso_add_sun(&p->shader, &seen, v, p->light[j * FILTERED_LIGHTS], got);
                for (int k = 0; k < 3; k++) r[3 * j + (uint32_t)k] += part * got[k];
            }
        }
        r += lights * 3;
    }
    return r;
}

/* Mean over lights of the radiance of the mean texel against that of the map's own texels: a mip
 * may move a highlight, but must preserve the light. */
static double *kept_residuals(const problem *p, double weight, double *r) {
    const masu_meso_samples *s = p->s;
    uint32_t lights = filtered_lights(s);
    for (uint32_t i = 0; i < s->setup->view_count; i++) {
        masu_meso_vec3 v = masu_meso_from_above(s->views[i].angle, 0);
        double mean[2][3] = {{0, 0, 0}, {0, 0, 0}};
        for (uint32_t t = 0; t <= s->fine_count; t++) {
            bool last = t == s->fine_count;
            masu_meso_surface seen =
                masu_meso_seen(&p->shader, last ? &p->fine_mean : &s->fine[t], v);
            double got[3] = {0, 0, 0};
            masu_meso_add_sky(&p->shader, &seen, v, MASU_MESO_SKY * lights, got);
            for (uint32_t j = 0; j < lights; j++)
                masu_meso_add_sun(&p->shader, &seen, v, p->light[j * FILTERED_LIGHTS], got);
            for (int k = 0; k < 3; k++) mean[last][k] += last ? got[k] : got[k] / s->fine_count;
        }
        double scale = 0;
        for (int k = 0; k < 3; k++) scale += mean[0][k] / 3;
        scale = weight / fmax(scale, 1e-6);
        for (int k = 0; k < 3; k++) *r++ = scale * (mean[1][k] - mean[0][k]);
    }
    return r;
}

/* Each kind is weighted by its mean square; the far kind has the largest weight, because it is the
 * requirement. */
static double evaluate(problem *p, const numbers *n, double *r) {
    const masu_meso_samples *s = p->s;
    double far = (double)far_count(s), near = (double)near_count(s);
    p->shader.curves = n->curves;
    double *end = far_residuals(p, r);
    end = near_residuals(p, 0.6 * sqrt(far / near), end);
    end = filtered_residuals(p, 0.8 * sqrt(far / (double)filtered_count(s)), end);
    end = kept_residuals(p, KEEP * sqrt(far / (double)kept_count(s)), end);
    for (uint32_t i = 0; i < MASU_MESO_NUMBERS; i++) {
        *end++ = (i == 19 || i == 23 ? HOLD_SPREAD : HOLD) * (n->v[i] - p->start.v[i]) * sqrt(far);
    }
    double sum = 0;
    for (double *x = r; x < end; x++) sum += *x * *x;
    return sum;
}

/* Symmetric and positive definite by its diagonal: elimination without pivoting. */
static void solve(double a[FREE][FREE + 1], double x[FREE]) {
    for (uint32_t i = 0; i < FREE; i++) {
        for (uint32_t j = i + 1; j < FREE; j++) {
            double f = a[j][i] / a[i][i];
            for (uint32_t k = i; k <= FREE; k++) a[j][k] -= f * a[i][k];
        }
    }
    for (uint32_t i = FREE; i-- > 0;) {
        x[i] = a[i][FREE];
        for (uint32_t j = i + 1; j < FREE; j++) x[i] -= a[i][j] * x[j];
        x[i] /= a[i][i];
    }
}

/* The fitted numbers: all except the facets' roughness and the tint, which are measured. */
static uint32_t number_of(uint32_t k) {
    static const uint8_t number[FREE] = {0,  1,  2,  4,  5,  6,  7,  8,  9,  10,
                                         11, 12, 13, 14, 15, 19, 20, 21, 22, 23};
    return number[k];
}

/* Excludes numbers at their limit whose step would exceed it: clamping after the step would spoil
 * the step of the others. */
static void hold_at_limits(const numbers *n, double a[FREE][FREE + 1]) {
    for (uint32_t k = 0; k < FREE; k++) {
        double v = n->v[number_of(k)], push = a[k][FREE];
        const limit *l = &limits[number_of(k)];
        if (!((v <= l->low && push < 0) || (v >= l->high && push > 0))) continue;
        for (uint32_t i = 0; i < FREE; i++) a[k][i] = a[i][k] = 0;
        a[k][k] = 1;
        a[k][FREE] = 0;
    }
}

static double improve(problem *p, numbers *n, double *r, double *trial, double *jacobian) {
    double best = evaluate(p, n, r), damping = 1e-2;
    size_t count = p->residuals;
    static double normal[FREE][FREE + 1], a[FREE][FREE + 1];
    for (int step = 0; step < STEPS; step++) {
        for (uint32_t k = 0; k < FREE; k++) {
            numbers moved = *n;
            moved.v[number_of(k)] += 1e-4;
            evaluate(p, &moved, trial);
            for (size_t i = 0; i < count; i++) {
                jacobian[k * count + i] = (trial[i] - r[i]) * 1e4;
            }
        }
        for (uint32_t i = 0; i < FREE; i++) {
            const double *row = jacobian + i * count;
            for (uint32_t j = i; j < FREE; j++) {
                double sum = 0;
                const double *column = jacobian + j * count;
                for (size_t k = 0; k < count; k++) sum += row[k] * column[k];
                normal[i][j] = normal[j][i] = sum;
            }
            normal[i][FREE] = 0;
            for (size_t k = 0; k < count; k++) normal[i][FREE] -= row[k] * r[k];
        }
        double before = best;
        for (int attempt = 0; attempt < 8 && best == before; attempt++) {
            double x[FREE];
            memcpy(a, normal, sizeof a);
            for (uint32_t i = 0; i < FREE; i++) a[i][i] += damping * a[i][i] + 1e-9;
            hold_at_limits(n, a);
            solve(a, x);
            numbers moved = *n;
            for (uint32_t k = 0; k < FREE; k++) {
                double *v = &moved.v[number_of(k)];
                const limit *l = &limits[number_of(k)];
                *v = fmin(fmax(*v + x[k], l->low), l->high);
            }
            double now = evaluate(p, &moved, trial);
            if (now < best) {
                *n = moved;
                best = now;
                memcpy(r, trial, count * sizeof *r);
                damping *= 0.3;
            } else {
                damping *= 5;
            }
        }
        if (!(best < before * (1 - 1e-5))) break;
    }
    return best;
}

/* Least squares for color(y) = color(0) (1 + y^2 tint). */
static void measured_tint(const masu_meso_samples *s, double tint[3]) {
    for (int k = 0; k < 3; k++) {
        double top = 0, below = 0;
        for (uint32_t i = 0; i < s->setup->view_count; i++) {
            double y = 1 - cos(s->views[i].angle * MASU_BAKE_PI / 180), y2 = y * y;
            double was = fmax(s->mean.color[k], 1e-4);
            top += y2 * (s->views[i].color[k] / was - 1);
            below += y2 * y2;
        }
        tint[k] = below > 0 ? fmin(fmax(top / below, -0.9), 3) : 0;
    }
}

masu_meso_curves masu_meso_fit(const masu_meso_samples *samples, const masu_meso_sky_table *table,
                               double facet, masu_meso_misfit *misfit) {
    problem p = {.s = samples, .shader = {.table = table, .way = MASU_MESO_CURVES}};
    for (uint32_t j = 0; j < samples->setup->light_count; j++)
        p.light[j] = masu_meso_light_direction(&samples->setup->light[j], 0, 1);
    for (uint32_t j = 0; j < samples->near_count; j++)
        p.near_light[j] = masu_meso_light_direction(&samples->near_light[j], 0, 1);
    p.mean = masu_meso_mean_texel(samples->texels, samples->texel_count);
    p.fine_mean = masu_meso_mean_texel(samples->fine, samples->fine_count);
    for (size_t i = 0; i < near_count(samples); i++) p.near_mean += samples->near[i];
    p.near_mean = fmax(p.near_mean / (double)near_count(samples), 1e-6);
    size_t far = far_count(samples), near = near_count(samples), filtered = filtered_count(samples);
    p.residuals = far + near + filtered + kept_count(samples) + MASU_MESO_NUMBERS;
    double *r = malloc(p.residuals * sizeof *r), *trial = malloc(p.residuals * sizeof *trial);
    double *jacobian = malloc(p.residuals * FREE * sizeof *jacobian);
    if (!r || !trial || !jacobian) exit(masu_cli_error("out of memory"));
    weigh_views(&p, r);

    /* Tilt, offset, alpha: starting points that lead to known minima. */
    static const double starts[][3] = {
        {0.3, 0.8, 0.5}, {0.1, 0.9, 0.3}, {0.8, 1.0, 1.0}, {0.0, 1.2, 1.5}};
    double tint[3];
    measured_tint(samples, tint);
    numbers best = {.curves = masu_meso_identity(facet)};
    double least = 1e300;
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        masu_cli_progress("fitting: start %zu of 4", i + 1);
        numbers n = {.curves = masu_meso_identity(facet)};
        n.curves.tilt[0] = starts[i][0];
        n.curves.offset = starts[i][1];
        n.curves.alpha = starts[i][2];
        n.curves.specular[0] = 0.95; /* inside the limit, where differences do not vanish */
        memcpy(n.curves.tint, tint, sizeof tint);
        n.curves.spread = 1;
        n.curves.ao[0] = 0.2;
        p.start = n;
        double now = improve(&p, &n, r, trial, jacobian);
        if (now < least) {
            least = now;
            best = n;
        }
    }
    for (int round = 0; round < ROUNDS; round++) {
        p.start = best;
        if (!weigh_again(&p, &best, r)) break;
        improve(&p, &best, r, trial, jacobian);
    }
    evaluate(&p, &best, r);
    double sum[3] = {0, 0, 0};
    for (size_t i = 0; i < far + near + filtered; i++) {
        sum[i < far ? 0 : i < far + near ? 1 : 2] += r[i] * r[i] / (double)far;
    }
    *misfit = (masu_meso_misfit){sqrt(sum[0]), sqrt(sum[1]) / 0.6, sqrt(sum[2]) / 0.8};
    free(r);
    free(trial);
    free(jacobian);
    return best.curves;
}

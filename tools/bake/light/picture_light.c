/* picture_light.c: see picture_light.h. Start at masu_bake_fit_irradiance.
 *
 * Order 2 (Ramamoorthi and Hanrahan, SIGGRAPH 2001) omits the bands 4, 6, ... of the irradiance;
 * the odd bands above 1 are zero. The omitted bands are largest around a bright source, so that one
 * lobe contains most of their energy: the clamped cosine with a rounded corner that the analytic
 * sky has (src/frame/sky.c, shared/sky.h). The shader evaluates the lobe for every sky, and also
 * Legendre's P4 along the vertical. For each of many lobe directions, least squares fits all
 * coefficients. It minimises the error relative to the irradiance, because an absolute error is
 * most visible on the dark side. */
#include "bake/light/picture_light.h"

#include "cli/cli.h"
#include "shared/sky.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI MASU_BAKE_PI
#define W ((double)MASU_SKY_ROUND)

/* The panorama is summed over cells of this grid. */
#define CELL_ROWS 64u
#define CELLS (2u * CELL_ROWS * CELL_ROWS)
#define NORMALS 2000u
#define CANDIDATES 400u /* of a hemisphere: the fitted function is even */
#define REFINEMENTS 12u
/* Irradiance, as a share of the mean, that is added before an error is divided by it. */
#define FLOOR 0.1

enum { HARMONICS = 9, RING = 9, LOBE = 10, FUNCTIONS = 11 };

typedef struct cell {
    double light[3]; /* radiance times solid angle / pi */
    double direction[3];
} cell;

typedef struct equations {
    double matrix[FUNCTIONS][FUNCTIONS], right[FUNCTIONS][3], square[3];
} equations;

typedef struct fit {
    cell cells[CELLS];
    double normal[NORMALS][3], light[NORMALS][3]; /* irradiance / pi */
    double weight[NORMALS];
    double function[NORMALS][FUNCTIONS]; /* that of the lobe apart */
    equations shared;                    /* without the lobe's */
} fit;

typedef double coefficients[FUNCTIONS][3];

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double lobe(double cosine) {
    double corner = fmax(cosine + W, 0);
    return cosine > W ? cosine : corner * corner / (4 * W);
}

/* All but the lobe. */
static void functions(const double n[3], double out[FUNCTIONS]) {
    double y2 = n[1] * n[1];
    out[0] = 1;
    for (uint32_t k = 0; k < 3; k++) out[1 + k] = n[k];
    out[4] = n[0] * n[1];
    out[5] = n[1] * n[2];
    out[6] = n[2] * n[0];
    out[7] = 3 * y2 - 1;
    out[8] = n[0] * n[0] - n[2] * n[2];
    out[RING] = (35 * y2 * y2 - 30 * y2 + 3) / 8;
}

/* Points spread evenly: the i-th of `count` over the sphere's upper part, down to the height `low`.
 */
static void spread(uint32_t i, uint32_t count, double low, double out[3]) {
    double y = 1 - (1 - low) * (i + 0.5) / count, flat = sqrt(fmax(1 - y * y, 0)),
           turn = 2.399963229728653 * i;
    out[0] = flat * cos(turn);
    out[1] = y;
    out[2] = flat * sin(turn);
}

/* ---- Light ----------------------------------------------------------------------------------- */

/* A small image is sampled at more points than it has pixels. */
static void fill_cells(const masu_bake_panorama *p, fit *f) {
    uint32_t across = (4 * CELL_ROWS - 1) / p->width + 1,
             down = (2 * CELL_ROWS - 1) / p->height + 1;
    masu_bake_panorama grid = *p;
    grid.width *= across;
    grid.height *= down;
    for (uint32_t y = 0; y < grid.height; y++) {
        for (uint32_t x = 0; x < grid.width; x++) {
            double d[3], solid_angle, light[3], sum = 0;
            masu_bake_panorama_pixel(&grid, x, y, d, &solid_angle);
            if (across * down > 1) {
                masu_bake_panorama_at(p, d, light);
            } else {
                const float *pixel = p->rgb + 3 * ((size_t)y * p->width + x);
                for (uint32_t c = 0; c < 3; c++) light[c] = p->factor * (double)pixel[c];
            }
            size_t row = (size_t)y * CELL_ROWS / grid.height,
                   column = (size_t)x * 2 * CELL_ROWS / grid.width;
            cell *to = &f->cells[row * 2 * CELL_ROWS + column];
            for (uint32_t c = 0; c < 3; c++) {
                light[c] = fmin(light[c], MASU_BAKE_RADIANCE_MAX) * solid_angle / PI;
                to->light[c] += light[c];
                sum += light[c];
            }
            for (uint32_t k = 0; k < 3; k++) to->direction[k] += sum * d[k];
        }
    }
    for (uint32_t i = 0; i < CELLS; i++) {
        double length = sqrt(dot(f->cells[i].direction, f->cells[i].direction));
        for (uint32_t k = 0; k < 3 && length > 0; k++) f->cells[i].direction[k] /= length;
    }
}

static void integrate(fit *f) {
    double mean = 0;
    for (uint32_t i = 0; i < NORMALS; i++) {
        spread(i, NORMALS, -1, f->normal[i]);
        for (uint32_t j = 0; j < CELLS; j++) {
            double cosine = dot(f->normal[i], f->cells[j].direction);
            for (uint32_t c = 0; c < 3 && cosine > 0; c++)
                f->light[i][c] += cosine * f->cells[j].light[c];
        }
        for (uint32_t c = 0; c < 3; c++) mean += f->light[i][c] / NORMALS;
    }
    for (uint32_t i = 0; i < NORMALS; i++) {
        double light = f->light[i][0] + f->light[i][1] + f->light[i][2] + FLOOR * mean;
        f->weight[i] = mean > 0 ? mean * mean / (light * light) : 1;
    }
}

/* ---- Least squares --------------------------------------------------------------------------- */

static void add_row(const fit *f, uint32_t i, uint32_t j, double value, equations *e) {
    const double *b = f->function[i], w = f->weight[i] * value;
    for (uint32_t k = 0; k < j; k++) e->matrix[j][k] += w * b[k];
    e->matrix[j][j] += w * value;
    for (uint32_t c = 0; c < 3; c++) e->right[j][c] += w * f->light[i][c];
}

static void set_up(fit *f) {
    equations *e = &f->shared;
    for (uint32_t i = 0; i < NORMALS; i++) {
        functions(f->normal[i], f->function[i]);
        for (uint32_t j = 0; j < LOBE; j++) add_row(f, i, j, f->function[i][j], e);
        for (uint32_t c = 0; c < 3; c++)
            e->square[c] += f->weight[i] * f->light[i][c] * f->light[i][c];
    }
}

/* Cholesky's decomposition of the first `count` equations, whose functions are independent for any
 * direction. */
static void decompose(const equations *e, uint32_t count, double lower[FUNCTIONS][FUNCTIONS]) {
    for (uint32_t j = 0; j < count; j++) {
        for (uint32_t k = 0; k <= j; k++) {
            double sum = e->matrix[j][k];
            for (uint32_t i = 0; i < k; i++) sum -= lower[j][i] * lower[k][i];
            lower[j][k] = k < j ? sum / lower[k][k] : sqrt(fmax(sum, 1e-12 * e->matrix[j][j]));
        }
    }
}

/* One channel; returns the squared error. */
static double solve(const equations *e, uint32_t count, double lower[FUNCTIONS][FUNCTIONS],
                    uint32_t channel, coefficients out) {
    double v[FUNCTIONS], left = e->square[channel];
    for (uint32_t j = 0; j < count; j++) {
        v[j] = e->right[j][channel];
        for (uint32_t k = 0; k < j; k++) v[j] -= lower[j][k] * v[k];
        v[j] /= lower[j][j];
        left -= v[j] * v[j];
    }
    for (uint32_t j = FUNCTIONS; j-- > 0;) {
        out[j][channel] = j < count ? v[j] : 0;
        for (uint32_t k = j + 1; k < count && j < count; k++)
            out[j][channel] -= lower[k][j] * out[k][channel];
        if (j < count) out[j][channel] /= lower[j][j];
    }
    return left;
}

/* The error left by a lobe of that direction, whose colour is not negative. */
static double fit_all(const fit *f, const double direction[3], coefficients out) {
    equations e;
    double lower[FUNCTIONS][FUNCTIONS], error = 0;
    e = f->shared;
    for (uint32_t i = 0; i < NORMALS; i++) {
        double value = lobe(dot(f->normal[i], direction));
        if (value > 0) add_row(f, i, LOBE, value, &e);
    }
    decompose(&e, FUNCTIONS, lower);
    for (uint32_t c = 0; c < 3; c++) {
        double left = solve(&e, FUNCTIONS, lower, c, out);
        if (out[LOBE][c] < 0) left = solve(&e, LOBE, lower, c, out);
        error += left;
    }
    return error;
}

/* The direction whose fit is best, and that fit. */
static void find_lobe(const fit *f, double direction[3], coefficients out) {
    double best = 0, step = 0.07; /* radians: half of the candidates' distance */
    for (uint32_t i = 0; i < CANDIDATES; i++) {
        coefficients with;
        double at[3];
        spread(i, CANDIDATES, 0, at);
        double error = fit_all(f, at, with);
        if (i > 0 && !(error < best)) continue;
        best = error;
        memcpy(direction, at, sizeof at);
        memcpy(out, with, sizeof with);
    }
    for (uint32_t round = 0; round < REFINEMENTS; round++) {
        const double from[3] = {direction[0], direction[1], direction[2]};
        for (uint32_t k = 0; k < 6; k++) {
            double at[3] = {from[0], from[1], from[2]};
            coefficients with;
            at[k % 3] += k < 3 ? step : -step;
            double length = sqrt(dot(at, at));
            for (uint32_t j = 0; j < 3; j++) at[j] /= length;
            double error = fit_all(f, at, with);
            if (!(error < best)) continue;
            best = error;
            memcpy(direction, at, sizeof at);
            memcpy(out, with, sizeof with);
        }
        if (memcmp(from, direction, sizeof from) == 0) step *= 0.5;
    }
}

void masu_bake_fit_irradiance(const masu_bake_panorama *p, masu_blob_environment_map *out) {
    double direction[3] = {0, 1, 0};
    coefficients all;
    fit *f = calloc(1, sizeof *f);
    if (!f) {
        masu_cli_error("no memory for an environment's irradiance");
        exit(1);
    }
    fill_cells(p, f);
    integrate(f);
    set_up(f);
    find_lobe(f, direction, all);
    free(f);
    bool shines = all[LOBE][0] > 0 || all[LOBE][1] > 0 || all[LOBE][2] > 0;
    for (uint32_t k = 0; k < HARMONICS; k++) {
        for (uint32_t c = 0; c < 3; c++) out->sh[k][c] = (float)all[k][c];
        out->sh[k][3] = (float)(k < 3   ? all[LOBE][k]
                                : k < 6 ? (shines ? direction[k - 3] : 0)
                                        : all[RING][k - 6]);
    }
}

void masu_bake_irradiance_at(const masu_blob_environment_map *map, const double normal[3],
                             double out[3]) {
    const float(*sh)[4] = map->sh;
    const double direction[3] = {(double)sh[3][3], (double)sh[4][3], (double)sh[5][3]};
    double b[FUNCTIONS];
    functions(normal, b);
    b[LOBE] = lobe(dot(normal, direction));
    for (uint32_t c = 0; c < 3; c++) {
        out[c] = b[LOBE] * (double)sh[c][3] + b[RING] * (double)sh[6 + c][3];
        for (uint32_t k = 0; k < HARMONICS; k++) out[c] += b[k] * (double)sh[k][c];
        out[c] = fmax(out[c], 0);
    }
}

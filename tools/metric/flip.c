/* flip.c: see flip.h. Its planes exist during a call.
 *
 * Colour: sRGB -> YCxCz; each channel is filtered by the contrast sensitivity of human vision;
 * clamped to the gamut of a screen; L*a*b*, chroma scaled by lightness (Hunt); HyAB distance,
 * raised to 0.7 and mapped to 0..1 so that 40 % of the largest possible distance is an error of
 * 0.95.
 *
 * Features: first and second derivatives of a Gaussian on the unfiltered lightness detect edges and
 * points. If one image has a feature that the other lacks, the colour error is amplified: error =
 * colour ^ (1 - feature).
 *
 * All filters are sums of separable kernels: the contrast sensitivities are Gaussians (blue-yellow
 * the sum of two), and x g(x,y) is x g(x) times g(y). */
#include "metric/flip.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
enum { RADIUS_MAX = 256, TAPS_MAX = 2 * RADIUS_MAX + 1 };

typedef struct kernel {
    int radius;
    double tap[TAPS_MAX];
} kernel;

typedef struct size2 {
    uint32_t width, height;
} size2;

/* ---- Colour ---------------------------------------------------------------------------------- */

/* Linear sRGB to XYZ, D65. White is the XYZ of (1,1,1): the sums of the rows. */
static const double to_xyz[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

static double decode(uint8_t byte) {
    double x = byte / 255.0;
    return x > 0.04045 ? pow((x + 0.055) / 1.055, 2.4) : x / 12.92;
}

/* XYZ divided by the white point. */
static void relative_xyz(const double rgb[3], double out[3]) {
    for (int r = 0; r < 3; r++) {
        const double *m = to_xyz[r];
        out[r] = (m[0] * rgb[0] + m[1] * rgb[1] + m[2] * rgb[2]) / (m[0] + m[1] + m[2]);
    }
}

static void opponent(const double xyz[3], double out[3]) {
    out[0] = 116 * xyz[1] - 16;
    out[1] = 500 * (xyz[0] - xyz[1]);
    out[2] = 200 * (xyz[1] - xyz[2]);
}

/* Cramer's rule on the matrix above, so that both directions share one matrix. */
static void linear_rgb(const double relative[3], double out[3]) {
    double v[3], inverse[3][3];
    for (int r = 0; r < 3; r++) v[r] = relative[r] * (to_xyz[r][0] + to_xyz[r][1] + to_xyz[r][2]);
    double det = 0.0;
    for (int r = 0; r < 3; r++) {
        int a = (r + 1) % 3, b = (r + 2) % 3;
        for (int c = 0; c < 3; c++) {
            int d = (c + 1) % 3, e = (c + 2) % 3;
            inverse[c][r] = to_xyz[a][d] * to_xyz[b][e] - to_xyz[a][e] * to_xyz[b][d];
        }
        det += to_xyz[r][0] * inverse[0][r];
    }
    for (int r = 0; r < 3; r++) {
        out[r] = (inverse[r][0] * v[0] + inverse[r][1] * v[1] + inverse[r][2] * v[2]) / det;
    }
}

/* CIE L*a*b*, then Hunt: chroma is less visible in the dark. */
static void hunt_lab(const double rgb[3], double out[3]) {
    double xyz[3];
    relative_xyz(rgb, xyz);
    const double delta = 6.0 / 29;
    for (int i = 0; i < 3; i++) {
        xyz[i] =
            xyz[i] > delta * delta * delta ? cbrt(xyz[i]) : xyz[i] / (3 * delta * delta) + 4.0 / 29;
    }
    opponent(xyz, out);
    out[1] *= 0.01 * out[0];
    out[2] *= 0.01 * out[0];
}

static double hyab(const double a[3], const double b[3]) {
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

/* The largest possible distance of two colours, after the exponent: green against blue. */
static double largest_distance(void) {
    const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double a[3], b[3];
    hunt_lab(green, a);
    hunt_lab(blue, b);
    return pow(hyab(a, b), 0.7);
}

static double redistributed(double distance, double most) {
    const double pc = 0.4, pt = 0.95;
    double knee = pc * most;
    return distance < knee ? pt / knee * distance
                           : pt + (distance - knee) / (most - knee) * (1 - pt);
}

/* ---- Filters --------------------------------------------------------------------------------- */

static uint32_t clamped(int64_t at, uint32_t size) {
    return at < 0 ? 0 : at >= (int64_t)size ? size - 1 : (uint32_t)at;
}

/* out (+)= horizontal * vertical * in, with the image's edge repeated. scratch has the size of
 * in. */
static void filter(const double *in, size2 s, const kernel *horizontal, const kernel *vertical,
                   bool add, double *scratch, double *out) {
    int r = horizontal->radius;
    for (uint32_t y = 0; y < s.height; y++) {
        const double *row = in + (size_t)y * s.width;
        for (uint32_t x = 0; x < s.width; x++) {
            double sum = 0.0;
            for (int k = -r; k <= r; k++)
                sum += horizontal->tap[k + r] * row[clamped((int64_t)x + k, s.width)];
            scratch[(size_t)y * s.width + x] = sum;
        }
    }
    r = vertical->radius;
    for (uint32_t y = 0; y < s.height; y++) {
        double *row = out + (size_t)y * s.width;
        if (!add) memset(row, 0, s.width * sizeof *row);
        for (int k = -r; k <= r; k++) {
            const double *from = scratch + (size_t)clamped((int64_t)y + k, s.height) * s.width;
            double weight = vertical->tap[k + r];
            for (uint32_t x = 0; x < s.width; x++) row[x] += weight * from[x];
        }
    }
}

static double kernel_sum(const kernel *k) {
    double sum = 0.0;
    for (int i = 0; i <= 2 * k->radius; i++) sum += k->tap[i];
    return sum;
}

static int radius_of(double r) {
    double up = ceil(r);
    return up > RADIUS_MAX ? RADIUS_MAX : up < 1 ? 1 : (int)up;
}

/* exp(-pi^2 x^2 / b) in degrees: the Fourier transform of a Gaussian sensitivity of spread b. All
 * channels use the radius of the widest. */
static void sensitivity(double b, double ppd, kernel *out) {
    out->radius = radius_of(3 * sqrt(0.04 / (2 * PI * PI)) * ppd);
    for (int i = -out->radius; i <= out->radius; i++)
        out->tap[i + out->radius] = exp(-PI * PI * (i / ppd) * (i / ppd) / b);
}

typedef struct bank {
    kernel achromatic[2], red_green[2], blue_yellow[2][2]; /* horizontal, vertical */
    kernel gauss, edge, point;
} bank;

/* A separable pair, scaled to a total of `share`. */
static void pair(double b, double share, double ppd, kernel out[2]) {
    sensitivity(b, ppd, &out[0]);
    out[1] = out[0];
    double sum = kernel_sum(&out[0]);
    for (int i = 0; i <= 2 * out[0].radius; i++) {
        out[0].tap[i] *= share / sum;
        out[1].tap[i] /= sum;
    }
}

/* Normalizes positive taps to a sum of 1 and negative ones to -1, like the paper's 2-D kernels: the
 * Gaussian of the other axis is positive, so signs and sums separate too. */
static void balance(kernel *k) {
    double up = 0.0, down = 0.0;
    for (int i = 0; i <= 2 * k->radius; i++) *(k->tap[i] > 0 ? &up : &down) += fabs(k->tap[i]);
    for (int i = 0; i <= 2 * k->radius && up > 0 && down > 0; i++)
        k->tap[i] /= k->tap[i] > 0 ? up : down;
}

static void make_bank(double ppd, bank *b) {
    pair(0.0047, 1.0, ppd, b->achromatic);
    pair(0.0053, 1.0, ppd, b->red_green);
    /* Blue-yellow: 34.1 sqrt(pi/b1) G1 + 13.5 sqrt(pi/b2) G2, the whole normalised to 1. */
    kernel one;
    double total[2];
    const double amplitude[2] = {34.1, 13.5}, spread[2] = {0.04, 0.025};
    for (int i = 0; i < 2; i++) {
        sensitivity(spread[i], ppd, &one);
        double sum = kernel_sum(&one);
        total[i] = amplitude[i] * sqrt(PI / spread[i]) * sum * sum;
    }
    for (int i = 0; i < 2; i++)
        pair(spread[i], total[i] / (total[0] + total[1]), ppd, b->blue_yellow[i]);
    double sigma = 0.5 * 0.082 * ppd;
    int r = radius_of(3 * sigma);
    b->gauss.radius = b->edge.radius = b->point.radius = r;
    for (int i = -r; i <= r; i++) {
        double g = exp(-i * i / (2 * sigma * sigma));
        b->gauss.tap[i + r] = g;
        b->edge.tap[i + r] = -i * g;
        b->point.tap[i + r] = (i * i / (sigma * sigma) - 1) * g;
    }
    double sum = kernel_sum(&b->gauss);
    for (int i = 0; i <= 2 * r; i++) b->gauss.tap[i] /= sum;
    balance(&b->edge);
    balance(&b->point);
}

/* ---- One image ------------------------------------------------------------------------------- */

enum { L, A, B, EDGE, POINT, LAB_PLANES }; /* planes of an image */
enum { YY, CX, CZ, FX, FY, SCRATCH, WORK_PLANES };

static void magnitude(double *x, const double *y, size_t n) {
    for (size_t i = 0; i < n; i++) x[i] = hypot(x[i], y[i]);
}

/* One of the images: 4 bytes of sRGB per pixel, or 3 doubles of linear light. */
typedef struct picture {
    const uint8_t *rgba;
    const double *rgb;
} picture;

static void look(picture from, size2 s, const bank *b, double *work, double *out) {
    size_t n = (size_t)s.width * s.height;
    double *p[WORK_PLANES], *o[LAB_PLANES], linear[256];
    for (size_t i = 0; i < WORK_PLANES; i++) p[i] = work + i * n;
    for (size_t i = 0; i < LAB_PLANES; i++) o[i] = out + i * n;
    for (int i = 0; i < 256; i++) linear[i] = decode((uint8_t)i);
    for (size_t i = 0; i < n; i++) {
        double rgb[3], xyz[3], ycc[3];
        for (size_t c = 0; c < 3; c++)
            rgb[c] = from.rgba ? linear[from.rgba[4 * i + c]] : from.rgb[3 * i + c];
        relative_xyz(rgb, xyz);
        opponent(xyz, ycc);
        p[YY][i] = ycc[0];
        p[CX][i] = ycc[1];
        p[CZ][i] = ycc[2];
    }
    filter(p[YY], s, &b->achromatic[0], &b->achromatic[1], false, p[SCRATCH], o[L]);
    filter(p[CX], s, &b->red_green[0], &b->red_green[1], false, p[SCRATCH], o[A]);
    for (int g = 0; g < 2; g++)
        filter(p[CZ], s, &b->blue_yellow[g][0], &b->blue_yellow[g][1], g > 0, p[SCRATCH], o[B]);
    for (size_t i = 0; i < n; i++) {
        double y = (o[L][i] + 16) / 116, rgb[3], lab[3];
        const double xyz[3] = {y + o[A][i] / 500, y, y - o[B][i] / 200};
        linear_rgb(xyz, rgb);
        for (int c = 0; c < 3; c++) rgb[c] = rgb[c] < 0 ? 0 : rgb[c] > 1 ? 1 : rgb[c];
        hunt_lab(rgb, lab);
        o[L][i] = lab[0];
        o[A][i] = lab[1];
        o[B][i] = lab[2];
    }
    for (size_t i = 0; i < n; i++) p[YY][i] = (p[YY][i] + 16) / 116;
    const kernel *derivative[2] = {&b->edge, &b->point};
    for (int d = 0; d < 2; d++) {
        double *to = o[EDGE + d];
        filter(p[YY], s, derivative[d], &b->gauss, false, p[SCRATCH], to);
        filter(p[YY], s, &b->gauss, derivative[d], false, p[SCRATCH], p[FY]);
        magnitude(to, p[FY], n);
    }
}

/* ---- Both ------------------------------------------------------------------------------------ */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

void masu_flip_summarise(double *errors, size_t n, float *map, masu_flip *out) {
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) {
        sum += errors[i];
        if (map) map[i] = (float)errors[i];
    }
    qsort(errors, n, sizeof *errors, compare);
    out->mean = sum / (double)n;
    out->p99 = errors[(size_t)(0.99 * (double)(n - 1) + 0.5)];
    out->max = errors[n - 1];
}

/* errors: one per pixel; NULL: at the start of the returned block. Returns NULL if there is no
 * memory. */
static double *measure(picture reference, picture test, size2 s, double ppd, double *errors) {
    size_t n = (size_t)s.width * s.height;
    bank *b = malloc(sizeof *b);
    double *planes = malloc((WORK_PLANES + 2 * LAB_PLANES) * n * sizeof *planes);
    if (!b || !planes || !n) {
        free(b);
        free(planes);
        return NULL;
    }
    make_bank(ppd > 0.0 ? ppd : MASU_FLIP_PPD, b);
    double *of[2] = {planes + WORK_PLANES * n, planes + (WORK_PLANES + LAB_PLANES) * n};
    look(reference, s, b, planes, of[0]);
    look(test, s, b, planes, of[1]);
    double most = largest_distance();
    if (!errors) errors = planes;
    for (size_t i = 0; i < n; i++) {
        double u[LAB_PLANES], v[LAB_PLANES];
        for (size_t k = 0; k < LAB_PLANES; k++) {
            u[k] = of[0][k * n + i];
            v[k] = of[1][k * n + i];
        }
        double color = redistributed(pow(hyab(u, v), 0.7), most);
        double feature = fmax(fabs(u[EDGE] - v[EDGE]), fabs(u[POINT] - v[POINT]));
        errors[i] = pow(color, 1 - sqrt(feature * sqrt(0.5)));
    }
    free(b);
    return planes;
}

bool masu_metric_flip(const uint8_t *reference, const uint8_t *test, uint32_t width,
                      uint32_t height, double ppd, float *map, masu_flip *out) {
    double *errors = measure((picture){reference, NULL}, (picture){test, NULL},
                             (size2){width, height}, ppd, NULL);
    if (errors) masu_flip_summarise(errors, (size_t)width * height, map, out);
    free(errors);
    return errors != NULL;
}

bool masu_metric_flip_linear(const double *reference, const double *test, uint32_t width,
                             uint32_t height, double ppd, double *errors) {
    double *planes = measure((picture){NULL, reference}, (picture){NULL, test},
                             (size2){width, height}, ppd, errors);
    free(planes);
    return planes != NULL;
}

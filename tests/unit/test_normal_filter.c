/* test_normal_filter.c: normal maps under minification. The reference is the mean light returned by
 * the texels under a pixel, each with its own normal and roughness. It is compared with one mean
 * normal and the roughness that tools/bake/texture/texture.c gives the mip. */
#include "bake/texture/texel.h"
#include "reference/brdf.h"
#include "reference/vec.h"
#include "split_sum.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

enum { SIDE = 16, TEXELS = SIDE * SIDE, SUNS = 9 };

typedef struct texel {
    double n[3], roughness;
} texel;

typedef struct relief {
    const char *name;
    double height; /* maximum slope, approximately */
    int waves_x, waves_y;
    double smooth, rough; /* of checkered texels */
} relief;

static const relief reliefs[] = {
    {"waves, slope 0.1", 0.1, 2, 3, 0.2, 0.2},
    {"waves, slope 0.3", 0.3, 2, 3, 0.2, 0.2},
    {"waves, slope 0.3, rough", 0.3, 2, 3, 0.5, 0.5},
    {"waves, slope 0.6", 0.6, 3, 2, 0.3, 0.3},
    {"grooves, slope 0.3", 0.3, 3, 0, 0.3, 0.3},
    {"waves, two roughnesses", 0.15, 2, 3, 0.15, 0.6},
    {"flat, two roughnesses", 0, 0, 0, 0.15, 0.6},
};
enum { RELIEFS = sizeof reliefs / sizeof *reliefs };

static void make(const relief *r, texel out[TEXELS]) {
    const double turn = 6.283185307179586 / SIDE;
    for (int i = 0; i < TEXELS; i++) {
        double x = i % SIDE + 0.5, y = i / SIDE + 0.5, a = turn * (r->waves_x * x + r->waves_y * y),
               b = turn * (r->waves_y * x - r->waves_x * y);
        out[i].n[0] = r->height * (cos(a) + (r->waves_y ? 0.7 * sin(b) : 0));
        out[i].n[1] = r->height * (r->waves_y ? 0.8 * sin(a + 1) - 0.5 * cos(b) : 0);
        out[i].n[2] = 1;
        unit3(out[i].n);
        out[i].roughness = (i % SIDE / 2 + i / SIDE / 2) % 2 ? r->rough : r->smooth;
    }
}

/* The light that a surface with normal n returns, times pi. */
static double shade(const double n[3], double roughness, const double v[3], const double l[3]) {
    brdf_surface s = {{0.5, 0.5, 0.5}, roughness, 1, 0.5, 0, 0};
    double x[3] = {n[2], 0, -n[0]}, y[3], out[3];
    unit3(x);
    y[0] = n[1] * x[2] - n[2] * x[1];
    y[1] = n[2] * x[0] - n[0] * x[2];
    y[2] = n[0] * x[1] - n[1] * x[0];
    const double to_v[3] = {dot3(x, v), dot3(y, v), dot3(n, v)};
    const double to_l[3] = {dot3(x, l), dot3(y, l), dot3(n, l)};
    brdf_eval(masu_split_sum, &s, to_v, to_l, out);
    return out[0];
}

static void direction(double degrees, double around, double out[3]) {
    double a = degrees * 0.017453292519943295;
    out[0] = sin(a) * cos(around);
    out[1] = sin(a) * sin(around);
    out[2] = cos(a);
}

/* Methods to compute one roughness for a pixel. */
enum {
    PLAIN,    /* the mean roughness: the variance of the normals is lost */
    FOLDED,   /* that, plus the variance of the normals: the method of masu-bake */
    OF_ALPHA, /* the same, from the mean of alpha^2 */
    WAYS
};

/* Relative RMSE over views and suns. */
static void compare(const texel *t, double out[WAYS]) {
    double mean[3] = {0, 0, 0}, roughness = 0, alpha2 = 0, error[WAYS] = {0}, sum = 0;
    for (int i = 0; i < TEXELS; i++) {
        for (int k = 0; k < 3; k++) mean[k] += t[i].n[k] / TEXELS;
        roughness += t[i].roughness / TEXELS;
        alpha2 += pow(t[i].roughness, 4) / TEXELS;
    }
    float length = (float)sqrt(dot3(mean, mean));
    unit3(mean);
    const double rough[WAYS] = {roughness, (double)masu_texel_rougher((float)roughness, length),
                                (double)masu_texel_rougher((float)pow(alpha2, 0.25), length)};
    for (int view = 0; view < 3; view++) {
        double v[3];
        direction(5 + 25 * view, 0.3, v);
        for (int i = 0; i < SUNS * 2 * SUNS; i++) {
            double l[3], truth = 0;
            direction(80.0 * (i % SUNS) / (SUNS - 1), 3.141592653589793 * (i / SUNS) / SUNS, l);
            for (int k = 0; k < TEXELS; k++) truth += shade(t[k].n, t[k].roughness, v, l) / TEXELS;
            sum += truth * truth;
            for (int way = 0; way < WAYS; way++)
                error[way] += pow(shade(mean, rough[way], v, l) - truth, 2);
        }
    }
    for (int way = 0; way < WAYS; way++) out[way] = sqrt(error[way] / sum);
}

static void folded_normals_are_nearer_to_the_relief_than_plain_ones(void **state) {
    (void)state;
    print_message("  relative RMSE over 486 pairs of view and sun, metal:\n"
                  "  %-26s %8s %8s %11s\n",
                  "", "plain", "folded", "of alpha^2");
    for (int i = 0; i < RELIEFS; i++) {
        static texel texels[TEXELS];
        double off[WAYS];
        make(&reliefs[i], texels);
        compare(texels, off);
        print_message("  %-26s %8.3f %8.3f %11.3f\n", reliefs[i].name, off[PLAIN], off[FOLDED],
                      off[OF_ALPHA]);
        /* One lobe is no sum of lobes: the remaining error is their shape. */
        int even = reliefs[i].smooth == reliefs[i].rough;
        assert_true(off[FOLDED] < (even ? 0.6 : 0.9));
        if (even) assert_true(off[FOLDED] < off[PLAIN] / 3);
        if (!even) assert_true(off[FOLDED] < off[OF_ALPHA]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(folded_normals_are_nearer_to_the_relief_than_plain_ones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

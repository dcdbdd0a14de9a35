/* test_stiff.c: the sphere tracer on difficult fields and views: steep, thin, infinite, tiny, huge,
 * far away, empty, and invalid parameters. Each case states its maximum difference from the field
 * traced in double precision, and the reason.
 *
 * The bounds are a quarter above the measured values (evaluations: a half), which are the same on
 * lavapipe 22.3 and 25.0 and SwiftShader. They are to be lowered when the tracer improves. Depth is
 * the distance along the ray, relative; at a silhouette it may be that of the surface behind, so
 * depth_max is bounded only in cases without silhouettes. */
#include "support/stiff.h"

#include "measure/truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

static masu_detail failure; /* of the last call that failed */

#define ANY_DEPTH 1.0 /* of the distance */
#define NO_CLAIM (-1.0) /* a figure without a bound and without a claim */

#define LOOK(x, y, z, fx, fy, fz, fov, near)                                                       \
    { .position = {x, y, z}, .forward = {fx, fy, fz}, .fov_y = fov, .near_distance = near }

/* ---- Steep fields ---------------------------------------------------------------------------- */

static const stiff_case steep[] = {
    {.name = "displace, sine, L = 50",
     .scene = "displace_sine",
     .camera = LOOK(0.4, 0.5, 3.2, -0.1f, -0.15f, -1, 0.9f, 0.05f),
     .width = 128,
     .height = 96,
     .least_hits = 50,
     .most = {0.37, 0, 2.9e-05, 0.059, ANY_DEPTH, 1.1, 119, 145, 0},
     .why = "needles 4 pixels apart; the steps are a fiftieth of the field, hence the "
            "evaluations, and the rays that differ from the reference pass between needles"},
    {.name = "displace, noise, L = 43",
     .scene = "displace_noise",
     .camera = LOOK(0.4, 0.5, 3.2, -0.1f, -0.15f, -1, 0.9f, 0.05f),
     .width = 128,
     .height = 96,
     .least_hits = 50,
     .most = {0.18, 0, 6.1e-05, 0.05, ANY_DEPTH, 1.1, 127, 172, 0},
     .why = "as with the sine"},
    {.name = "twist of 20 rad/unit",
     .scene = "twist",
     .camera = LOOK(0.5, 0.6, 3.2, -0.15f, -0.2f, -1, 0.7f, 0.05f),
     .width = 128,
     .height = 128,
     .least_hits = 25,
     .most = {0.032, 0, 3.4e-05, 0.00061, 0.15, 0.13, 40, 13, 0},
     .why = "L = 10.7; at edges of the twisted bar a ray hits the next winding"},
};

/* ---- Deep zooms ------------------------------------------------------------------------------ */

static const stiff_case fractals[] = {
    {.name = "Menger, 1e-3 of its size",
     .scene = "menger",
     .camera = LOOK(0.9, 0.9, 1.002, -0.2f, -0.2f, -1, 0.8f, 1e-5f),
     .width = 128,
     .height = 96,
     .stride = 3,
     .least_hits = 99,
     .most = {0, 0, 2e-06, 0.011, 0.039, 0.08, 133, 24, 0},
     .why = "a pixel is 100 ulp wide: faces are exact; at the rims of holes it is one side or the "
            "other"},
    {.name = "Menger, 1e-4",
     .scene = "menger",
     .camera = LOOK(0.2642, -0.6638, 1.0003, -0.1f, -0.1f, -1, 0.8f, 1e-6f),
     .width = 128,
     .height = 96,
     .stride = 3,
     .least_hits = 99,
     .most = {0, 0, 0.00021, 0.4, 0.66, 0.08, 157, 13, 0},
     .why = "a pixel is 15 ulp wide: hits are as near as fp32 gets, 8 ulp"},
    {.name = "Menger, 1e-6",
     .scene = "menger",
     .camera = LOOK(0.401, 0.402, 1.000003, -0.3f, -0.2f, -0.2f, 0.8f, 1e-8f),
     .width = 128,
     .height = 96,
     .stride = 3,
     .least_hits = 50,
     .most = {0.093, 0, 0.053, 0.39, 0.48, 0.08, 0.25, 14, 0.061},
     .why = "the camera stands 25 ulp before the face, and hits are 8 ulp thick"},
    {.name = "Sierpinski, 1e-2",
     .scene = "sierpinski",
     .camera = LOOK(1.02, 1.01, 1.015, -0.021f, -0.011f, -0.016f, 0.8f, 1e-4f),
     .width = 128,
     .height = 96,
     .stride = 3,
     .least_hits = 35,
     .most = {0.093, 0, 6.2e-07, 0.0094, ANY_DEPTH, 0.08, 137, 42, 0.028},
     .why = "it is full of holes: at their rims it is one side or the other"},
    {.name = "Sierpinski, 1e-3",
     .scene = "sierpinski",
     .camera = LOOK(1.002, 1.001, 1.0015, -0.0021f, -0.0011f, -0.0016f, 0.8f, 1e-5f),
     .width = 128,
     .height = 96,
     .stride = 3,
     .least_hits = 35,
     .most = {0.093, 0, 6.5e-06, 0.09, ANY_DEPTH, 0.08, 137, 41, 0.044},
     .why = "beneath its finest level; rims, and rays that creep through the inner holes"},
    {.name = "Mandelbulb",
     .scene = "mandelbulb",
     .camera = LOOK(0.5, 0.6, 3.2, -0.15f, -0.2f, -1, 0.7f, 0.05f),
     .width = 96,
     .height = 96,
     .stride = 3,
     .least_hits = 55,
     .most = {0.61, 0, 0.0015, 0.057, 0.24, 92, NO_CLAIM, 80, 0},
     .why = "an estimate, in the fuzz much below the distance, and detail far beneath a pixel: no "
            "two hits have the same normal"},
    {.name = "Mandelbulb, 1e-2",
     .scene = "mandelbulb",
     .camera = LOOK(0.3, 0.2, 0.80, -0.1f, -0.1f, -1, 0.7f, 1e-4f),
     .width = 96,
     .height = 96,
     .stride = 3,
     .least_hits = 99,
     .most = {0, 0, 0.0026, 0.19, 0.64, 76, NO_CLAIM, 130, 0.042},
     .why = "as above"},
    {.name = "Mandelbulb, 1e-3",
     .scene = "mandelbulb",
     .camera = LOOK(0.3, 0.2, 0.7805, -0.1f, -0.1f, -1, 0.7f, 1e-5f),
     .width = 96,
     .height = 96,
     .stride = 3,
     .least_hits = 99,
     .most = {0, 0, 0.024, 0.41, 0.88, 69, NO_CLAIM, 94, 0.053},
     .why = "as above; the powers of fp32 differ between drivers by 1 % of the distance"},
};

/* ---- Thin and infinite objects --------------------------------------------------------------- */

static const stiff_case thin[] = {
    {.name = "rods of 0.2 pixel",
     .scene = "rods",
     .camera = LOOK(0, 0, 5, 0, 0, -1, 0.7f, 0.05f),
     .width = 128,
     .height = 96,
     .least_hits = 2,
     .most = {1.6, 0, 1e-07, 3e-05, 0.24, 4.1, 8.3, 9.7, 0},
     .why = "none may be lost; too many are two columns of pixels whose rays pass a rod at 0.0008 "
            "pixel: hits are 0.002 pixel thick"},
};

static const stiff_case grazing[] = {
    {.name = "plain to 1e5 units, from 1 unit",
     .scene = "ground",
     .camera = LOOK(0, 1, 0, 0, -0.02f, -1, 0.3f, 0.1f),
     .width = 128,
     .height = 96,
     .least_hits = 60,
     .most = {0, 0, 1.1e-07, 1e-06, 3.3e-05, 0.08, 0.25, 2.2, 0},
     .why = "a half-space is intersected in closed form, at any angle"},
    {.name = "plain to 1e5 units, from 0.01",
     .scene = "ground",
     .camera = LOOK(0, 0.01, 0, 0, 0, -1, 0.3f, 0.01f),
     .width = 128,
     .height = 96,
     .least_hits = 50,
     .most = {0, 0, 1e-07, 4.8e-06, 4.9e-06, 0.08, 0.25, 2.3, 0},
     .why = "as from 1 unit"},
};

/* ---- Camera positions ------------------------------------------------------------------------ */

static const stiff_case cameras[] = {
    {.name = "inside a solid",
     .scene = "figures",
     .camera = LOOK(-1.2, 1.1, 0.1, -0.2f, -0.2f, -1, 0.8f, 0.05f),
     .width = 96,
     .height = 64,
     .least_hits = 100,
     .most = {0, 0, 1e-07, 1e-06, 1e-06, 0.081, 0.25, 7.7, 0},
     .why = "the near plane cuts the solid, exactly there"},
    {.name = "on a plane, along it",
     .scene = "figures",
     .camera = LOOK(0, 0, 6, 0.1f, 0, -1, 0.8f, 0.01f),
     .width = 96,
     .height = 64,
     .least_hits = 50,
     .most = {0.036, 0, 1e-07, 6.9e-06, ANY_DEPTH, 0.08, 0.27, 4.9, 0},
     .why = "half of the rays begin in the solid; the line at the horizon may fall to either side"},
    {.name = "on a ball, along it",
     .scene = "figures",
     .camera = LOOK(-1, 1, 1, 0.1f, 0.1f, 0, 0.8f, 0.001f),
     .width = 96,
     .height = 64,
     .least_hits = 49,
     .most = {0, 0, 1e-07, 1e-06, 1e-06, 0.08, 0.25, 11, 0},
     .why = "the tangent plane divides the image; rays of one side begin in the solid"},
    {.name = "on a ball, inwards",
     .scene = "figures",
     .camera = LOOK(-1, 1, 1, 0, 0.1f, -1, 0.8f, 0.001f),
     .width = 96,
     .height = 64,
     .least_hits = 100,
     .most = {0, 0, 1e-07, 1e-06, 1e-06, 0.08, 0.25, 7.7, 0},
     .why = "as inside"},
};

#define FIGURES(s, x, z)                                                                           \
    LOOK((x) + 1.5 * (s), 2.2 * (s), (z) + 6 * (s), -0.25f, -0.28f, -1, 0.7f, 0.05f * (float)(s))

enum { HERE, SMALL, LARGE, FAR, FIGURES_COUNT };

static const stiff_case figures[FIGURES_COUNT] = {
    [HERE] = {.name = "figures",
              .scene = "figures",
              .camera = FIGURES(1, 0, 0),
              .width = 128,
              .height = 96,
              .least_hits = 70,
              .most = {0, 0, 1e-07, 3.5e-06, ANY_DEPTH, 0.08, 0.25, 6, 0},
              .why = "nothing is special here"},
    [SMALL] = {.name = "figures, 1e-4 of their size",
               .scene = "figures_small",
               .camera = FIGURES(1e-4, 0, 0),
               .width = 128,
               .height = 96,
               .least_hits = 70,
               .most = {0, 0, 1e-07, 3.3e-06, ANY_DEPTH, 0.08, 0.25, 6, 0},
               .why = "no constant of the march has a unit: as at their own size"},
    [LARGE] = {.name = "figures, 1e4 times their size",
               .scene = "figures_large",
               .camera = FIGURES(1e4, 0, 0),
               .width = 128,
               .height = 96,
               .least_hits = 70,
               .most = {0, 0, 1e-07, 3.4e-06, ANY_DEPTH, 0.08, 0.25, 6, 0},
               .why = "as at their own size"},
    [FAR] = {.name = "figures, 1e6 units away",
             .scene = "figures_far",
             .camera = FIGURES(1, 1e6, -1e6),
             .width = 128,
             .height = 96,
             .least_hits = 70,
             .most = {0, 0, 1e-07, 3.5e-06, ANY_DEPTH, 0.08, 0.25, 6, 0},
             .why = "the field is anchored near the camera (docs/sdf.md): same as at the origin"},
};

/* Percentage of pixels whose depth differs by more than `by` from the first's. */
static double differing(const float *here, const float *there, uint32_t count, double by) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++)
        n += fabs((double)there[i] - (double)here[i]) > by * (double)here[i];
    return 100.0 * n / count;
}

/* ---- Sizes of zero, many parts, equal surfaces ----------------------------------------------- */

static const stiff_case sizes[] = {
    {.name = "parts of size zero",
     .scene = "zero",
     .camera = LOOK(0, 0, 5, 0, 0, -1, 0.8f, 0.05f),
     .width = 128,
     .height = 96,
     .least_hits = 4,
     .most = {0, 0, 1e-07, 1e-06, 1e-06, 113, 113, 1.4, 0},
     .why = "points and lines are invisible unless a ray hits them exactly; plates are exact. On "
            "a plate the gradient is zero: it has no normal to compare"},
};

static const stiff_case point = {
    .name = "bounds that are a point",
    .scene = "point",
    .camera = LOOK(0, 0, 5, 0, 0, -1, 0.8f, 0.05f),
    .width = 128,
    .height = 96,
    .least_hits = 0,
    .most = {0, 0, 1e-07, 1e-06, 1e-06, 0.08, 0.25, 0.05, 0},
    .why = "one pixel of 12,288 at most; only the tile around the point may be evaluated"};

static const stiff_case blends[] = {
    {.name = "smooth union of radius 0",
     .scene = "blend",
     .camera = LOOK(0.5, 0.6, 4, -0.12f, -0.15f, -1, 0.8f, 0.05f),
     .width = 96,
     .height = 64,
     .params = {0},
     .param_count = 1,
     .least_hits = 18,
     .most = {0, 0, 1e-07, 0.00041, 0.0011, 0.08, 0.25, 3.8, 0},
     .why = "a union: at silhouettes and in the crease it is one side or the other"},
    {.name = "smooth union of radius 2",
     .scene = "blend",
     .camera = LOOK(0.5, 0.6, 4, -0.12f, -0.15f, -1, 0.8f, 0.05f),
     .width = 96,
     .height = 64,
     .params = {2},
     .param_count = 1,
     .least_hits = 29,
     .most = {0, 0, 1e-07, 1.6e-05, 0.0017, 0.08, 0.25, 5.9, 0},
     .why = "larger than both parts"},
    {.name = "smooth union of radius 1e9",
     .scene = "blend",
     .camera = LOOK(0.5, 0.6, 4, -0.12f, -0.15f, -1, 0.8f, 0.05f),
     .width = 96,
     .height = 64,
     .params = {1e9f},
     .param_count = 1,
     .least_hits = 100,
     .most = {0, 0, 1e-07, 1e-06, 1e-06, 37, 71, 6.4, 0},
     .why = "all of space is solid: the near plane. A field of -2.5e8 has no digits for a normal"},
};

static const stiff_case many[] = {
    {.name = "4096 parts, some in each tile",
     .scene = "many",
     .camera = LOOK(0, 14, 3, 0.1f, -1, -0.2f, 0.8f, 0.05f),
     .width = 96,
     .height = 64,
     .stride = 2,
     .least_hits = 40,
     .most = {0, 0, 2.1e-07, 6.5e-05, ANY_DEPTH, 0.24, 0.53, 14, 0},
     .why = "balls of 3 pixels"},
};

/* In a separate test: Mesa 22.3's lavapipe silently ends every loop of an invocation after 65,535
 * iterations of all its loops together; 4096 parts are 16 samples. */
static const stiff_case many_at_once = {
    .name = "4096 parts, all in a tile",
    .scene = "many",
    .camera = LOOK(0, 8, 38, 0, -0.3f, -1, 0.8f, 0.05f),
    .width = 96,
    .height = 64,
    .stride = 4,
    .least_hits = 40,
    .most = {0.33, 0, 2.3e-05, 8.7e-05, 0.0042, 0.39, 1.5, 22, 0},
    .why = "balls of a pixel near the horizon"};

static const stiff_case coincident = {.name = "two surfaces in one place",
                                      .scene = "coincident",
                                      .camera = LOOK(0.5, 0.6, 5, -0.12f, -0.15f, -1, 0.8f, 0.05f),
                                      .width = 128,
                                      .height = 96,
                                      .least_hits = 17,
                                      .most = {0, 0, 1e-07, 4e-06, 0.00053, 0.08, 0.25, 3.3, 0},
                                      .why = "depth and normal are the same whichever wins"};

static const stiff_case few_steps = {
    .name = "figures, 5 steps a ray",
    .scene = "figures",
    .camera = FIGURES(1, 0, 0),
    .width = 128,
    .height = 96,
    .steps = 5,
    .least_hits = 70,
    .most = {2.1, 0, 1e-07, 0.36, ANY_DEPTH, 0.08, 171, 5, 21},
    .why = "what is not within 2 pixels when the steps are used up is a miss, and never a hit: a "
           "third of the rays end so"};

/* ---- Tests ----------------------------------------------------------------------------------- */

static void run_all(const stiff_case *cases, size_t count) {
    for (size_t i = 0; i < count; i++) stiff_run(&cases[i]);
}

#define RUN(cases) run_all(cases, sizeof(cases) / sizeof *(cases))

static void fields_of_lipschitz_constant_50_are_met(void **state) {
    (void)state;
    RUN(steep);
}

static void deep_zooms_on_fractals_are_met(void **state) {
    (void)state;
    RUN(fractals);
}

static void rods_thinner_than_a_pixel_are_not_lost(void **state) {
    (void)state;
    RUN(thin);
}

static void a_plain_is_met_to_its_horizon(void **state) {
    (void)state;
    RUN(grazing);
}

static void a_camera_in_or_on_a_solid_sees_it(void **state) {
    (void)state;
    RUN(cameras);
}

static void scenes_scaled_and_moved_are_the_same_picture(void **state) {
    (void)state;
    static float here[128 * 96];
    /* % of the pixels that may differ from the first's by more than 1e-5, whose own error is twice
     * the rounding of the coordinates. */
    static const double most[FIGURES_COUNT] = {0, 0.1, 0.1, 0.1};
    memcpy(here, stiff_run(&figures[HERE])->depth, sizeof here);
    for (int i = SMALL; i < FIGURES_COUNT; i++) {
        const stiff_picture *p = stiff_run(&figures[i]);
        double percent = differing(here, p->depth, 128 * 96, 1e-5);
        printf("  %s: %.3f %% of the pixels differ\n", figures[i].name, percent);
        if (!(percent <= most[i])) fail_msg("%s: %g %%", figures[i].name, percent);
    }
}

static void parts_of_size_zero_are_met(void **state) {
    (void)state;
    RUN(sizes);
}

static void a_part_whose_bounds_are_a_point_is_not_seen(void **state) {
    (void)state;
    stiff_run(&point);
}

static void smooth_unions_of_any_radius_are_met(void **state) {
    (void)state;
    RUN(blends);
}

static void as_many_parts_as_there_may_be_are_met(void **state) {
    (void)state;
    RUN(many);
}

static void as_many_parts_in_one_tile_are_met(void **state) {
    (void)state;
    stiff_run(&many_at_once);
}

static void of_two_surfaces_in_one_place_the_first_part_shows(void **state) {
    (void)state;
    const stiff_picture *p = stiff_run(&coincident);
    uint32_t count[2][2] = {{0}};
    for (uint32_t i = 0; i < coincident.width * coincident.height; i++) {
        if (!(p->depth[i] > 0)) continue;
        const uint8_t *a = &p->albedo[4 * i];
        assert_true(abs((int)a[0] - (int)a[2]) > 100); /* one or the other, nothing between */
        count[i % coincident.width > coincident.width / 2][a[2] > a[0]]++;
    }
    /* The same shape, hence the same number: on ties the part declared first wins. The crate's
     * shapes round differently: either may win, the same one in each frame (stiff_draw). */
    assert_true(count[0][0] > 500);
    assert_int_equal(count[0][1], 0);
    assert_true(count[1][0] + count[1][1] > 500);
}

static void rays_without_steps_miss(void **state) {
    (void)state;
    assert_true(stiff_run(&few_steps)->figures.unconverged > 1);
}

/* ---- Parameters of a frame ------------------------------------------------------------------- */

enum { PARAMS = 5 };

static const float senseless[] = {1e30f,  -1e30f, 3.4e38f,  -3.4e38f, 0.0f,  -0.0f,
                                  1e-40f, -1.0f,  1.2e-38f, 1e10f,    -1e5f, 6.2831853e6f};

static void a_parameter_of_any_number_gives_a_finite_picture(void **state) {
    (void)state;
    stiff_case c = {.name = "parameters",
                    .scene = "extremes",
                    .camera = LOOK(0, 0.5, 5, 0, -0.1f, -1, 0.8f, 0.05f),
                    .width = 64,
                    .height = 48,
                    .param_count = PARAMS};
    static const float usual[PARAMS] = {1, 0, 0.3f, 0, 0};
    masu_session s;
    stiff_open(&s, &c);
    for (size_t v = 0; v < sizeof senseless / sizeof *senseless; v++) {
        for (uint32_t p = 0; p <= PARAMS; p++) { /* each separately, then all together */
            memcpy(c.params, usual, sizeof usual);
            for (uint32_t i = 0; i < PARAMS; i++)
                if (i == p || p == PARAMS) c.params[i] = senseless[v];
            stiff_frame(&s, &c);
        }
    }
    close_session(&s);
}

static void a_parameter_that_is_no_number_is_refused_and_nothing_is_written(void **state) {
    (void)state;
    static const float none[] = {(float)NAN, (float)INFINITY, (float)-INFINITY};
    stiff_case c = {.name = "parameters",
                    .scene = "extremes",
                    .camera = LOOK(0, 0.5, 5, 0, -0.1f, -1, 0.8f, 0.05f),
                    .width = 64,
                    .height = 48,
                    .param_count = PARAMS};
    static uint8_t before[64 * 48 * 4];
    masu_session s;
    stiff_open(&s, &c);
    memcpy(before, stiff_frame(&s, &c), sizeof before);
    for (size_t v = 0; v < 3; v++) {
        for (uint32_t p = 0; p < PARAMS; p++) {
            float params[PARAMS] = {1, 0, 0.3f, 0, 0};
            char text[64];
            masu_commands commands;
            params[p] = none[v];
            masu_frame_desc frame = {
                MASU_FRAME_DESC,
                .camera = &c.camera, .sdf_params = params, .sdf_param_count = PARAMS};
            assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
            snprintf(text, sizeof text, "sdf_params[%u] is %g, allowed are finite numbers", p,
                     (double)none[v]);
            assert_string_equal(failure.text, text);
        }
    }
    const float more[PARAMS + 1] = {0};
    masu_commands commands;
    masu_frame_desc frame = {MASU_FRAME_DESC, .sdf_params = more, .sdf_param_count = PARAMS + 1};
    assert_int_equal(masu_frame(s.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "sdf_param_count is 6, the scene has 5");
    assert_memory_equal(before, stiff_frame(&s, &c), sizeof before);
    close_session(&s);
}

static int head(void **state) {
    (void)state;
    stiff_head();
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fields_of_lipschitz_constant_50_are_met),
        cmocka_unit_test(deep_zooms_on_fractals_are_met),
        cmocka_unit_test(rods_thinner_than_a_pixel_are_not_lost),
        cmocka_unit_test(a_plain_is_met_to_its_horizon),
        cmocka_unit_test(a_camera_in_or_on_a_solid_sees_it),
        cmocka_unit_test(scenes_scaled_and_moved_are_the_same_picture),
        cmocka_unit_test(parts_of_size_zero_are_met),
        cmocka_unit_test(a_part_whose_bounds_are_a_point_is_not_seen),
        cmocka_unit_test(smooth_unions_of_any_radius_are_met),
        cmocka_unit_test(as_many_parts_as_there_may_be_are_met),
        cmocka_unit_test(as_many_parts_in_one_tile_are_met),
        cmocka_unit_test(of_two_surfaces_in_one_place_the_first_part_shows),
        cmocka_unit_test(rays_without_steps_miss),
        cmocka_unit_test(a_parameter_of_any_number_gives_a_finite_picture),
        cmocka_unit_test(a_parameter_that_is_no_number_is_refused_and_nothing_is_written),
    };
    return cmocka_run_group_tests_name("stiff", tests, head, NULL);
}

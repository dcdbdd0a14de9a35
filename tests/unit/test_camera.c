/* test_camera.c: the uniforms of a frame: the scene's camera path, the camera's matrix (compared
 * with an explicit projection in double precision), light, SDF parameters, and rejected frames.
 * Without a GPU: see tests/support/dry_renderer.h. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "support/bind.h"
#include "support/files.h"
#include "support/random.h"
#include "support/dry_renderer.h"
#include "reference/vec.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static masu_camera good_camera(void) {
    return (masu_camera){
        .position = {1.0, 2.0, 3.0}, .forward = {0.0f, 0.0f, -2.0f}, .fov_y = 1.0f};
}

static masu_light good_light(void) {
    return (masu_light){.sun_direction = {0.0f, 2.0f, 0.0f}, .sun_color = {1.0f, 2.0f, 3.0f}};
}

/* ---- The camera path ------------------------------------------------------------------------- */

static void assert_near(double a, double b, double tolerance) {
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.9g is not %.9g", a, b);
}

static void the_camera_path_is_linear_between_its_keys_and_held_at_its_ends(void **state) {
    (void)state;
    static const struct {
        double time, position[3], target[3], fov;
    } cases[] = {
        {-10.0, {0, 1, 5}, {0, 0, 0}, 0.8},           {0.0, {0, 1, 5}, {0, 0, 0}, 0.8},
        {0.75, {2.5, 1, 2.5}, {0, 0.25, 0}, 0.85},    {1.5, {5, 1, 0}, {0, 0.5, 0}, 0.9},
        {2.75, {2.5, 1, -2.5}, {0, 0.25, 0.5}, 0.95}, {4.0, {0, 1, -5}, {0, 0, 1}, 1.0},
        {1e300, {0, 1, -5}, {0, 0, 1}, 1.0},
    };
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(cases); i++) {
        masu_camera c;
        assert_int_equal(masu_camera_at(&m, cases[i].time, &c, NULL), MASU_OK);
        for (int k = 0; k < 3; k++) {
            assert_near(c.position[k], cases[i].position[k], 1e-6);
            assert_near((double)c.forward[k], cases[i].target[k] - cases[i].position[k], 1e-6);
            assert_true((double)c.up[k] == 0.0);
        }
        assert_near((double)c.fov_y, cases[i].fov, 1e-6);
        assert_true((double)c.near_distance == 0.0);
    }
}

static void a_camera_path_that_is_missing_or_asked_for_nonsense_says_so(void **state) {
    (void)state;
    masu_camera c;
    masu_detail detail;
    make_renderer(SUPPORT_ALL, 0);
    assert_int_equal(masu_camera_at(&m, (double)NAN, &c, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_camera_at(&m, (double)INFINITY, &c, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_camera_at(&m, 0.0, NULL, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_camera_at(NULL, 0.0, &c, NULL), MASU_ERROR_ARGUMENT);
    make_renderer(SUPPORT_RASTER, 0);
    assert_int_equal(masu_camera_at(&m, 0.0, &c, NULL), MASU_ERROR_STATE);
    masu_frame_desc f = {.time = 0.0};
    assert_int_equal(write_frame(&f, 0, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "camera");
}

static void a_path_of_one_key_stands_still(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    m.plan.scene.camera_keys = 1;
    for (double time = -3.0; time < 4.0; time += 1.0) {
        masu_camera c;
        assert_int_equal(masu_camera_at(&m, time, &c, NULL), MASU_OK);
        assert_near(c.position[2], 5.0, 0.0);
        assert_near((double)c.fov_y, 0.8, 1e-6);
    }
}

/* Half-way, position and target coincide: the direction is undefined there. */
static void keys_that_cross_over_keep_a_direction(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    keys[0] = (masu_blob_camera_key){0.0f, {-1.0f, 0.0f, 0.0f}, {1.0f, 0.0f, 0.0f}, 1.0f};
    keys[1] = (masu_blob_camera_key){2.0f, {1.0f, 0.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}, 1.0f};
    m.plan.scene.camera_keys = 2;
    masu_camera c;
    assert_int_equal(masu_camera_at(&m, 1.0, &c, NULL), MASU_OK);
    assert_near((double)c.forward[0], 2.0, 0.0);
    masu_frame_desc f = {.time = 1.0};
    write_good(&f, 0);
}

/* ---- The camera's uniforms ------------------------------------------------------------------- */

static void direction_of(const float v[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = (double)v[k];
    unit3(out);
}

/* clip = matrix * (rel, 1) */
static void project(const struct masu_frame_uniforms *u, const double rel[3], double clip[4]) {
    for (int row = 0; row < 4; row++) {
        clip[row] = (double)u->clip_from_rel[12 + row];
        for (int k = 0; k < 3; k++) clip[row] += (double)u->clip_from_rel[4 * k + row] * rel[k];
    }
}

static void the_matrix_projects_as_a_camera_does(void **state) {
    (void)state;
    uint64_t random = 5;
    make_renderer(SUPPORT_ALL, 0);
    for (int n = 0; n < 500; n++) {
        masu_camera c = {.fov_y = (float)random_between(&random, 0.1, 2.5),
                         .near_distance = (float)random_between(&random, 0.01, 2.0)};
        for (int k = 0; k < 3; k++) {
            c.position[k] = random_between(&random, -100.0, 100.0);
            c.forward[k] = (float)random_between(&random, -3.0, 3.0);
            c.up[k] = (float)random_between(&random, -3.0, 3.0);
        }
        for (int k = 0; k < 2 && n % 2; k++)
            c.jitter[k] = (float)random_between(&random, -1.0, 1.0);
        double left = 2.0 * (double)c.jitter[0] / 1280.0, above = 2.0 * (double)c.jitter[1] / 720.0;
        double forward[3], wish[3], right[3], up[3], clip[4];
        direction_of(c.forward, forward);
        direction_of(c.up, wish);
        if (fabs(dot3(forward, wish)) > 0.99) continue; /* almost parallel */
        cross3(forward, wish, right);
        unit3(right);
        cross3(right, forward, up);
        double tan_y = tan((double)c.fov_y / 2.0), tan_x = tan_y * 1280.0 / 720.0;
        if (n % 3 == 0) { /* any window */
            double x = random_between(&random, -3.0, 3.0), y = random_between(&random, -3.0, 3.0);
            c.left = (float)x, c.right = (float)(x + random_between(&random, 0.5, 3.0));
            c.bottom = (float)y, c.top = (float)(y + random_between(&random, 0.5, 3.0));
            c.fov_y = n % 2 ? 0.0f : 9.0f;
            tan_x = 0.5 * ((double)c.right - (double)c.left),
            tan_y = 0.5 * ((double)c.top - (double)c.bottom);
            left += 0.5 * ((double)c.right + (double)c.left) / tan_x;
            above -= 0.5 * ((double)c.top + (double)c.bottom) / tan_y;
        }
        masu_frame_desc f = {.camera = &c};
        write_good(&f, 0);
        struct masu_frame_uniforms u = uniforms(0);
        for (int p = 0; p < 8; p++) {
            double x = random_between(&random, -2.0, 2.0);
            double y = random_between(&random, -2.0, 2.0);
            double z = random_between(&random, 0.1, 50.0), rel[3];
            for (int k = 0; k < 3; k++) {
                rel[k] = z * (forward[k] + x * tan_x * right[k] + y * tan_y * up[k]);
            }
            project(&u, rel, clip);
            assert_near(clip[3], z, 1e-5 * z + 1e-5);
            assert_near(clip[0] / clip[3], x - left, 2e-5 * (1 + fabs(left)));
            assert_near(clip[1] / clip[3], -y - above,
                        2e-5 * (1 + fabs(above))); /* down is positive */
            assert_near(clip[2] / clip[3], (double)c.near_distance / z, 1e-5);
        }
        assert_near((double)u.jitter[0], left, 2e-6 * (1 + fabs(left)));
        assert_near((double)u.jitter[1], above, 2e-6 * (1 + fabs(above)));
        assert_near((double)u.jitter[2], 2.0 * (double)c.jitter[0] / 1280.0, 1e-6);
        assert_near((double)u.jitter[3], 2.0 * (double)c.jitter[1] / 720.0, 1e-6);
        for (int k = 0; k < 3; k++) { /* the basis of the sphere tracer's rays */
            assert_near((double)u.right[k], right[k] * tan_x, 1e-5);
            assert_near((double)u.up[k], up[k] * tan_y, 1e-5);
            assert_near((double)u.forward[k], forward[k], 1e-6);
        }
        assert_near((double)u.right[3], tan_x, 1e-5);
        assert_near((double)u.up[3], tan_y, 1e-5);
        assert_true(u.forward[3] == c.near_distance);
    }
}

/* The formula in the header for hosts that render something themselves. */
static void the_header_has_the_matrix(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    masu_camera c = good_camera();
    c.left = -0.25f, c.right = 1.0f, c.bottom = -2.0f, c.top = -1.5f;
    c.jitter[0] = 0.5f, c.jitter[1] = -0.75f;
    write_good(&(masu_frame_desc){.camera = &c}, 0);
    struct masu_frame_uniforms u = uniforms(0);
    double forward[3], right[3], up[3], rel[3], clip[4];
    direction_of(u.forward, forward);
    direction_of(u.right, right);
    direction_of(u.up, up);
    double x = 1.5, y = -3.75, z = 2.0, w = 1280, h = 720;
    for (int k = 0; k < 3; k++) rel[k] = x * right[k] + y * up[k] + z * forward[k];
    project(&u, rel, clip);
    double l = -0.25, r = 1.0, b = -2.0, t = -1.5;
    assert_near(clip[0], (2 * x - (r + l) * z) / (r - l) - 2 * 0.5 / w * z, 1e-5);
    assert_near(clip[1], -(2 * y - (t + b) * z) / (t - b) - 2 * -0.75 / h * z, 1e-4);
    assert_near(clip[2], (double)u.forward[3], 0);
    assert_near(clip[3], z, 1e-5);
}

/* A symmetric window given by fov_y: bit-identical. */
static void a_window_straight_ahead_is_a_field_of_view(void **state) {
    (void)state;
    static struct masu_frame_uniforms by_fov, by_window;
    make_renderer(SUPPORT_ALL, 0);
    masu_camera c = good_camera();
    c.fov_y = 2.0f * atanf(0.5f);
    double tan_y = tan((double)c.fov_y * 0.5);
    write_good(&(masu_frame_desc){.camera = &c, .cut = 1}, 0);
    by_fov = uniforms(0);
    c.top = (float)tan_y, c.bottom = -c.top;
    c.right = (float)(tan_y * 1280.0 / 720.0), c.left = -c.right;
    write_good(&(masu_frame_desc){.camera = &c, .cut = 1}, 0);
    by_window = uniforms(0);
    for (int k = 0; k < 4; k++) {
        assert_near((double)by_window.right[k], (double)by_fov.right[k], 0);
        assert_near((double)by_window.up[k], (double)by_fov.up[k], 0);
        assert_near((double)by_window.jitter[k], 0, 0);
    }
    for (int k = 0; k < 16; k++)
        assert_near((double)by_window.clip_from_rel[k], (double)by_fov.clip_from_rel[k], 2e-7);
}

static void the_eye_keeps_its_precision_in_two_floats(void **state) {
    (void)state;
    static const double places[] = {0.1, 123456.789, -1e6 - 0.0625, 1e9 / 3.0, 0.0};
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(places); i++) {
        masu_camera c = good_camera();
        c.position[1] = places[i];
        masu_frame_desc f = {.camera = &c};
        write_good(&f, 1);
        struct masu_frame_uniforms u = uniforms(1);
        assert_true(u.eye_hi[1] == (float)places[i]);
        assert_near((double)u.eye_hi[1] + (double)u.eye_lo[1], places[i],
                    fabs(places[i]) / 70368744177664.0); /* 2^46 */
    }
}

/* Inputs of temporal rungs about the previous frame: whether the view differs, and whether the
 * world may differ. */
static void a_past_is_told_what_has_moved(void **state) {
    (void)state;
    enum {
        NOTHING = 0,
        MOVES = MASU_TEMPORAL_MOVES,
        BOTH = MASU_TEMPORAL_MOVES | MASU_TEMPORAL_CHANGES
    };
    static const struct {
        double to;
        float right, fov_y, jitter;
        uint32_t told;
    } frames[] = {{0, 0, 1, 0, NOTHING},         {0, 0, 1, 0, NOTHING},
                  {0, 0.1f, 1, 0, MOVES},        {0, 0.1f, 1, 0, NOTHING},
                  {0, 0.1f, 1.1f, 0, MOVES},     {0, 0.1f, 1.1f, 0.3f, NOTHING},
                  {0.5, 0.1f, 1.1f, 0.3f, BOTH}, {0.5, 0.1f, 1.1f, 0, NOTHING}};
    masu_rung rung = {.scale = 1.0f, .temporal = MASU_ON};
    make_renderer_with(SUPPORT_RASTER, 0, &rung, 1);
    masu_light light = good_light();
    for (uint32_t i = 0; i < COUNT(frames); i++) {
        masu_camera camera = good_camera();
        camera.position[0] += frames[i].to;
        camera.forward[0] = frames[i].right;
        camera.fov_y = frames[i].fov_y;
        camera.jitter[0] = frames[i].jitter;
        m.timeline.frame = i; /* the first is a cut */
        write_good(&(masu_frame_desc){.camera = &camera, .light = &light}, i & 1);
        if (uniforms(i & 1).temporal[2] != frames[i].told)
            fail_msg("frame %u: the flags are %u, not %u", i, uniforms(i & 1).temporal[2],
                     frames[i].told);
    }
}

static void looking_straight_up_or_down_needs_no_up(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    for (int sign = -1; sign <= 1; sign += 2) {
        masu_camera c = good_camera();
        c.forward[0] = c.forward[2] = 0.0f;
        c.forward[1] = (float)sign;
        masu_frame_desc f = {.camera = &c};
        write_good(&f, 0);
        struct masu_frame_uniforms u = uniforms(0);
        double right[3], up[3], forward[3];
        direction_of(u.right, right);
        direction_of(u.up, up);
        direction_of(u.forward, forward);
        assert_near(dot3(right, up), 0.0, 1e-6);
        assert_near(dot3(right, forward), 0.0, 1e-6);
        assert_near(dot3(up, forward), 0.0, 1e-6);
    }
}

static void the_near_distance_of_the_scene_is_the_default(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    masu_camera c = good_camera();
    masu_frame_desc f = {.camera = &c};
    write_good(&f, 0);
    assert_true(uniforms(0).forward[3] == 0.05f);
    assert_true(uniforms(0).clip_from_rel[14] == 0.05f);
}

/* ---- Rejected frames ------------------------------------------------------------------------- */

static masu_detail detail; /* of the last rejected frame */

static void assert_frame_refused(const masu_frame_desc *f, const char *what) {
    static unsigned char before[ROOM];
    memcpy(before, memory[MASU_ROLE_UPLOAD], ROOM);
    memset(&detail, 0, sizeof detail);
    if (!write_frame(f, 1, &detail)) fail_msg("%s was accepted", what);
    assert_int_equal(detail.result, MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, what);
    /* The text has the name, the given value and the allowed range. */
    if (strncmp(detail.text, what, strlen(what)) || !strstr(detail.text, " is ") ||
        (!strstr(detail.text, ", allowed are ") && !strstr(detail.text, ", needed is ") &&
         !strstr(detail.text, ", the scene has "))) {
        fail_msg("%s: \"%s\"", what, detail.text);
    }
    assert_memory_equal(memory[MASU_ROLE_UPLOAD], before, ROOM);
}

#define BAD_CAMERA(what, ...)                                                                      \
    do {                                                                                           \
        masu_camera c = good_camera();                                                             \
        masu_frame_desc f = {.camera = &c};                                                        \
        __VA_ARGS__;                                                                               \
        assert_frame_refused(&f, what);                                                            \
    } while (0)

static const float not_finite[] = {(float)NAN, (float)INFINITY, (float)-INFINITY};

static void a_bad_camera_is_named(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        for (int k = 0; k < 3; k++) {
            BAD_CAMERA("camera.position", c.position[k] = (double)not_finite[i]);
            BAD_CAMERA("camera.forward", c.forward[k] = not_finite[i]);
            BAD_CAMERA("camera.up", c.up[k] = not_finite[i]);
        }
        BAD_CAMERA("camera.fov_y", c.fov_y = not_finite[i]);
        BAD_CAMERA("camera.near_distance", c.near_distance = not_finite[i]);
    }
    BAD_CAMERA("camera.position", c.position[0] = 1.1e15);
    BAD_CAMERA("camera.forward", c.forward[2] = 0.0f);
    BAD_CAMERA("camera.up", c.up[2] = 3.0f);
    BAD_CAMERA("camera.up", c.up[2] = -3.0f);
    BAD_CAMERA("camera.fov_y", c.fov_y = 0.0f);
    BAD_CAMERA("camera.fov_y", c.fov_y = 3.11f);
    BAD_CAMERA("camera.near_distance", c.near_distance = -1.0f);
    BAD_CAMERA("camera.near_distance", c.near_distance = 1.1e9f);
}

#define WINDOW(l, r, b, t) (c.left = l, c.right = r, c.bottom = b, c.top = t)

static void a_bad_window_is_named(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        BAD_CAMERA("camera.left", WINDOW(not_finite[i], 1, -1, 1));
        BAD_CAMERA("camera.right", WINDOW(-1, not_finite[i], -1, 1));
        BAD_CAMERA("camera.bottom", WINDOW(-1, 1, not_finite[i], 1));
        BAD_CAMERA("camera.top", WINDOW(-1, 1, -1, not_finite[i]));
    }
    BAD_CAMERA("camera.right", WINDOW(1, 1, -1, 1));
    BAD_CAMERA("camera.right", WINDOW(1, -1, -1, 1));
    BAD_CAMERA("camera.right", WINDOW(0, 0, -1, 1));
    BAD_CAMERA("camera.top", WINDOW(-1, 1, 0, 0));
    BAD_CAMERA("camera.top", WINDOW(-1, 1, 1, -1));
    BAD_CAMERA("camera.left", WINDOW(-101, 1, -1, 1));
    BAD_CAMERA("camera.top", WINDOW(-1, 1, -1, 100.1f));
    BAD_CAMERA("camera.right", WINDOW(99.95f, 100, -1, 1));
    if (strcmp(detail.text,
               "camera.right is 100, needed is camera.left (99.95) + 0.0976562 or more"))
        fail_msg("\"%s\"", detail.text);
}

#define BAD_LIGHT(what, ...)                                                                       \
    do {                                                                                           \
        masu_light l = good_light();                                                               \
        masu_frame_desc f = {.light = &l};                                                         \
        __VA_ARGS__;                                                                               \
        assert_frame_refused(&f, what);                                                            \
    } while (0)

static void a_bad_light_is_named(void **state) {
    (void)state;
    static const float bad[] = {(float)NAN, (float)INFINITY, -0.1f, 1.1e9f};
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(bad); i++) {
        for (int k = 0; k < 3; k++) {
            BAD_LIGHT("light.sun_color", l.sun_color[k] = bad[i]);
            BAD_LIGHT("light.ambient", l.ambient[k] = bad[i]);
            BAD_LIGHT("light.sky_zenith", l.sky_zenith[k] = bad[i]);
            BAD_LIGHT("light.sky_horizon", l.sky_horizon[k] = bad[i]);
            if (i < 2) BAD_LIGHT("light.sun_direction", l.sun_direction[k] = bad[i]);
        }
        BAD_LIGHT("light.exposure", l.exposure = bad[i]);
    }
    BAD_LIGHT("light.sun_direction", l.sun_direction[1] = 0.0f);
    BAD_LIGHT("light.fog_density", l.fog_density = -1.0f);
    BAD_LIGHT("light.fog_density", l.fog_density = 0.1f); /* the scene has no fog */
    BAD_LIGHT("light.fog_height", l.fog_height = 2e9f);
    BAD_LIGHT("light.fog_falloff", l.fog_falloff = -1.0f);
    BAD_LIGHT("light.fog_start", l.fog_start = -1.0f);
    BAD_LIGHT("light.fog_color", l.fog_color[2] = -1.0f);
    BAD_LIGHT("light.turbidity", l.turbidity = 1.0f);
    BAD_LIGHT("light.ground", (l.turbidity = 2.0f, l.ground[1] = 2.0f));
    BAD_LIGHT("light.turbidity", l.turbidity = 2.0f); /* the scene has no analytic sky */
}

/* An environment map replaces the sky and the ambient light: black, and the values of
 * masu_light_of, change nothing. */
static void a_light_that_an_environment_map_replaces_is_named(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    m.plan.needs.environment = 1;
    for (uint32_t i = 0; i < 3; i++) {
        masu_light l = good_light();
        float *colors[] = {l.ambient, l.sky_zenith, l.sky_horizon};
        static const char *const names[] = {"light.ambient", "light.sky_zenith",
                                            "light.sky_horizon"};
        for (uint32_t k = 0; k < 3; k++) memset(colors[k], 0, sizeof l.ambient);
        masu_frame_desc f = {.light = &l};
        assert_int_equal(write_frame(&f, 0, &detail), MASU_OK);
        colors[i][2] = 0.375f;
        assert_frame_refused(&f, names[i]);
        assert_non_null(strstr(detail.text, "[2] is 0.375"));
    }
    masu_light hazy = good_light();
    memset(hazy.ambient, 0, sizeof hazy.ambient);
    memset(hazy.sky_zenith, 0, sizeof hazy.sky_zenith);
    memset(hazy.sky_horizon, 0, sizeof hazy.sky_horizon);
    hazy.turbidity = 3.0f;
    m.plan.needs.sky = 1; /* desc.analytic_sky: half of the light would come from the map */
    assert_frame_refused(&(masu_frame_desc){.light = &hazy}, "light.turbidity");
    m.plan.needs.sky = 0;
    masu_light own;
    assert_int_equal(masu_light_of(&m, &own, NULL), MASU_OK);
    own.exposure = 2.0f;
    masu_frame_desc f = {.light = &own};
    assert_int_equal(write_frame(&f, 0, &detail), MASU_OK);
}

static void the_text_has_what_is_given(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
#define TEXT(...)                                                                                  \
    do {                                                                                           \
        if (strcmp(detail.text, __VA_ARGS__)) fail_msg("\"%s\"", detail.text);                     \
    } while (0)
    BAD_CAMERA("camera.fov_y", c.fov_y = 4.0f);
    TEXT("camera.fov_y is 4, allowed are 0.0005 to 3.1 radians");
    BAD_CAMERA("camera.position", c.position[1] = -2e15);
    TEXT("camera.position[1] is -2e+15, allowed are -1e15 to 1e15 m");
    BAD_CAMERA("camera.jitter", c.jitter[1] = 1.5f);
    TEXT("camera.jitter[1] is 1.5, allowed are -1 to 1 pixels");
    BAD_LIGHT("light.sky_zenith", l.sky_zenith[2] = -3.0f);
    TEXT("light.sky_zenith[2] is -3, allowed are 0 to 1e9");
    masu_frame_desc f = {.time = 2e15};
    assert_frame_refused(&f, "time");
    TEXT("time is 2e+15, allowed are -1e15 to 1e15 s");
    f = (masu_frame_desc){.time_step = (float)-INFINITY};
    assert_frame_refused(&f, "time_step");
    TEXT("time_step is -inf, allowed are -1e15 to 1e15 s");
}

static void a_bad_sdf_parameter_is_named(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(not_finite); i++) {
        float values[3] = {0.5f, not_finite[i], 0.0f};
        masu_frame_desc f = {.sdf_params = values, .sdf_param_count = 2};
        assert_frame_refused(&f, "sdf_params");
        f.sdf_param_count = 3;
        assert_frame_refused(&f, "sdf_param_count");
        f.sdf_param_count = UINT32_MAX;
        assert_frame_refused(&f, "sdf_param_count");
        f.sdf_param_count = 1; /* the bad parameter is not given */
        write_good(&f, 0);
    }
}

static void the_extremes_of_each_range_are_accepted(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    masu_camera c = good_camera();
    masu_light l = good_light();
    masu_frame_desc f = {.camera = &c, .light = &l};
    c.position[0] = 1e15, c.position[1] = -1e15;
    c.fov_y = 0.0005f, c.near_distance = 1e-9f, l.exposure = 1e-9f, l.ambient[0] = 1e9f;
    write_good(&f, 0);
    c.fov_y = 3.1f, c.near_distance = 1e9f, l.exposure = 1e9f, l.sky_horizon[2] = 1e9f;
    write_good(&f, 0);
    WINDOW(-100, 100, -100, 100);
    write_good(&f, 0);
    WINDOW(99.9f, 100, 0, 1.01e-4f);
    write_good(&f, 0);
}

/* The shaders rely on finite uniforms, so every accepted frame must have them. */
static void whatever_is_accepted_makes_finite_uniforms(void **state) {
    (void)state;
    static const float values[] = {0.0f,   -0.0f,  1.0f,   -1.0f,  1e-45f,  -1e-45f, FLT_MIN,
                                   1e-30f, 1e-20f, 1e-9f,  0.001f, 3.1f,    1e9f,    -1e9f,
                                   1e15f,  1e20f,  -1e20f, 1e30f,  FLT_MAX, -FLT_MAX};
    static const double times[] = {0.0, -1.0, 1e9, 1e38, 3.5e38, -3.5e38, 1e300, DBL_MAX, 5e-324};
    uint64_t random = 9;
    uint32_t accepted = 0;
#define PICK values[support_random(&random) % COUNT(values)]
    make_renderer(SUPPORT_ALL, 0);
    for (int n = 0; n < (int)trials(200000, 50000, 20000); n++) {
        masu_camera c = good_camera();
        masu_light l = good_light();
        float given[2] = {PICK, PICK};
        for (int k = 0; k < 3; k++) {
            if (support_random(&random) % 2) c.position[k] = (double)PICK * 1e-3;
            if (support_random(&random) % 2) c.forward[k] = PICK;
            if (support_random(&random) % 4 == 0) c.up[k] = PICK;
            if (support_random(&random) % 4 == 0) l.sun_direction[k] = PICK;
            if (support_random(&random) % 8 == 0) l.sky_zenith[k] = PICK;
        }
        if (support_random(&random) % 4 == 0) c.fov_y = PICK;
        if (support_random(&random) % 4 == 0) c.near_distance = PICK;
        if (support_random(&random) % 4 == 0) WINDOW(PICK, PICK, PICK, PICK);
        if (support_random(&random) % 4 == 0) l.exposure = PICK;
        masu_frame_desc f = {.camera = &c,
                             .light = support_random(&random) % 2 ? &l : NULL,
                             .time = times[support_random(&random) % COUNT(times)],
                             .time_step = PICK,
                             .sdf_params = given,
                             .sdf_param_count = 2};
        memset(memory[MASU_ROLE_UPLOAD], 0xFF, ROOM); /* not finite */
        masu_detail detail;
        if (write_frame(&f, 0, &detail)) continue;
        float all[sizeof(struct masu_frame_uniforms) / sizeof(float)];
        memcpy(all, slot_bytes(MASU_BUFFER_FRAME, 0), sizeof all);
        accepted++;
        for (size_t i = 0; i < COUNT(all); i++) {
            if (!isfinite(all[i])) fail_msg("case %d: float %zu is %g", n, i, (double)all[i]);
        }
    }
    assert_true(accepted > 1000);
}

/* ---- The SDF's space ------------------------------------------------------------------------- */

static void the_anchor_is_on_a_grid_near_an_eye_that_is_far_out(void **state) {
    (void)state;
    uint64_t random = 9;
    make_renderer(SUPPORT_ALL, 0);
    for (int n = 0; n < 2000; n++) {
        m.plan.scene.sdf_anchored = n % 4 != 0;
        double reach = n % 2 ? 1e7 : 6000, most = 0;
        masu_camera c = {.forward = {0, 0, -1}, .fov_y = 1, .near_distance = 0.1f};
        for (int k = 0; k < 3; k++) {
            c.position[k] = reach * ((double)(support_random(&random) >> 11) / (1ull << 52) - 1);
            most = fmax(most, fabs(c.position[k]));
        }
        masu_frame_desc f = {.camera = &c};
        write_good(&f, 0);
        struct masu_frame_uniforms u = uniforms(0);
        int far = n % 4 != 0 && most >= MASU_ANCHOR_FROM;
        float largest = 0;
        for (int k = 0; k < 3; k++) largest = fmaxf(largest, fabsf(u.sdf_eye_hi[k]));
        assert_true(u.sdf_eye_hi[3] == 8 * FLT_EPSILON * largest);
        for (int k = 0; k < 3; k++) {
            double anchor = (double)u.anchor[k];
            double eye = (double)u.sdf_eye_hi[k] + (double)u.sdf_eye_lo[k];
            assert_near(fmod(anchor, MASU_ANCHOR_GRID), 0, 0);
            assert_near(anchor + eye, c.position[k], 1e-8);
            assert_near((double)u.sdf_min[k] + anchor, (double)m.sdf.bounds[0][k], 1);
            assert_near((double)u.sdf_max[k] + anchor, (double)m.sdf.bounds[1][k], 1);
            if (far) assert_near(eye, 0, MASU_ANCHOR_GRID / 2 + 1e-8);
            if (!far) assert_near(anchor, 0, 0);
            if (!far) assert_true(u.sdf_eye_hi[k] == u.eye_hi[k] && u.sdf_eye_lo[k] == u.eye_lo[k]);
        }
    }
}

/* ---- Light and parameters -------------------------------------------------------------------- */

static void the_light_of_the_scene_is_the_default(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    masu_frame_desc f = {.time = 0.5, .time_step = 0.25f};
    write_good(&f, 0);
    struct masu_frame_uniforms u = uniforms(0);
    const float sun[] = {0.6f, 0.8f, 0.0f, 1.5f}, color[] = {2.0f, 1.5f, 1.0f};
    for (int k = 0; k < 4; k++) assert_near((double)u.sun_direction[k], (double)sun[k], 1e-6);
    assert_memory_equal(u.sun_color, color, sizeof color);
    assert_true(u.ambient[2] == 0.3f && u.sky_zenith[2] == 0.8f && u.sky_horizon[1] == 0.7f);
    assert_true(u.eye_hi[3] == 0.5f && u.eye_lo[3] == 0.25f);
    assert_true(u.sdf_min[0] == -10.0f && u.sdf_min[3] == 0.5f);
    assert_true(u.sdf_max[1] == 4.0f && u.sdf_max[3] == 100.0f);
}

static void a_given_light_takes_its_place(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    masu_light l = good_light();
    masu_frame_desc f = {.light = &l};
    write_good(&f, 0);
    struct masu_frame_uniforms u = uniforms(0);
    assert_true(u.sun_direction[1] == 1.0f); /* brought to unit length */
    assert_true(u.sun_direction[3] == 1.0f); /* exposure 0 is 1 */
    assert_true(u.sun_color[2] == 3.0f);
    assert_true(u.ambient[0] == 0.0f);
}

static void sdf_parameters_are_defaulted_and_clamped(void **state) {
    (void)state;
    static const struct {
        float given[2];
        uint32_t count;
        float expected[2];
    } cases[] = {{{0.0f, 0.0f}, 0, {0.5f, -1.0f}},
                 {{1.5f, 0.0f}, 1, {1.5f, -1.0f}},
                 {{1.5f, 0.25f}, 2, {1.5f, 0.25f}},
                 {{-9.0f, 9.0f}, 2, {0.0f, 1.0f}},
                 {{FLT_MAX, -FLT_MAX}, 2, {2.0f, -1.0f}}};
    make_renderer(SUPPORT_ALL, 0);
    for (size_t i = 0; i < COUNT(cases); i++) {
        masu_frame_desc f = {.sdf_params = cases[i].given, .sdf_param_count = cases[i].count};
        write_good(&f, 0);
        struct masu_frame_uniforms u = uniforms(0);
        assert_true(u.sdf_params[0][0] == cases[i].expected[0]);
        assert_true(u.sdf_params[0][1] == cases[i].expected[1]);
        assert_true(u.sdf_params[0][2] == 0.0f);
    }
    masu_frame_desc none = {.sdf_param_count = 0};
    write_good(&none, 0);
    assert_true(uniforms(0).sdf_params[0][0] == 0.5f);
    for (uint32_t count = 1; count <= 3; count++) { /* one less than the scene has, all, one more */
        none.sdf_param_count = count;
        assert_frame_refused(&none, count <= 2 ? "sdf_params" : "sdf_param_count");
    }
}

static void a_frame_is_written_to_its_slot_alone(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL, 0);
    static unsigned char expected[ROOM];
    /* data that frames do not write: commands, as init left them */
    memcpy(expected, memory[MASU_ROLE_UPLOAD], ROOM);
    masu_frame_desc f = {.time = 1.0};
    write_good(&f, 1);
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        const masu_buffer_plan *p = &m.plan.buffers[b];
        if (!p->bytes || !p->stride || p->role != MASU_ROLE_UPLOAD) continue;
        uint64_t at = p->offset + p->stride;
        memcpy(expected + at, memory[MASU_ROLE_UPLOAD] + at, p->stride);
    }
    assert_memory_equal(memory[MASU_ROLE_UPLOAD], expected, ROOM);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_camera_path_is_linear_between_its_keys_and_held_at_its_ends),
        cmocka_unit_test(a_camera_path_that_is_missing_or_asked_for_nonsense_says_so),
        cmocka_unit_test(a_path_of_one_key_stands_still),
        cmocka_unit_test(keys_that_cross_over_keep_a_direction),
        cmocka_unit_test(the_matrix_projects_as_a_camera_does),
        cmocka_unit_test(the_header_has_the_matrix),
        cmocka_unit_test(a_window_straight_ahead_is_a_field_of_view),
        cmocka_unit_test(the_eye_keeps_its_precision_in_two_floats),
        cmocka_unit_test(a_past_is_told_what_has_moved),
        cmocka_unit_test(looking_straight_up_or_down_needs_no_up),
        cmocka_unit_test(the_near_distance_of_the_scene_is_the_default),
        cmocka_unit_test(a_bad_camera_is_named),
        cmocka_unit_test(a_bad_window_is_named),
        cmocka_unit_test(a_bad_light_is_named),
        cmocka_unit_test(a_light_that_an_environment_map_replaces_is_named),
        cmocka_unit_test(the_text_has_what_is_given),
        cmocka_unit_test(a_bad_sdf_parameter_is_named),
        cmocka_unit_test(the_extremes_of_each_range_are_accepted),
        cmocka_unit_test(whatever_is_accepted_makes_finite_uniforms),
        cmocka_unit_test(the_anchor_is_on_a_grid_near_an_eye_that_is_far_out),
        cmocka_unit_test(the_light_of_the_scene_is_the_default),
        cmocka_unit_test(a_given_light_takes_its_place),
        cmocka_unit_test(sdf_parameters_are_defaulted_and_clamped),
        cmocka_unit_test(a_frame_is_written_to_its_slot_alone),
    };
    return cmocka_run_group_tests_name("camera", tests, support_make_edge, NULL);
}

/* test_sdf_casters.c: shadows of point and spot lights cast by the SDF, against rays to its balls
 * and boxes in double precision: on polygons, on the SDF itself, on a pane, on a particle and in a
 * mirror; polygons also cast theirs on the SDF; a light inside its bulb; a moving field. Visibility
 * is the image with shadows divided by the one without. */
#include "support/support.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/shadow.h"

#include "reference/vec.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 130, HEIGHT = 94, PIXELS = WIDTH * HEIGHT, SHADOWS = 0, NONE = 1, SETTLED = 24 };

static uint64_t evals; /* of the field, in the last images */
static uint32_t faces;
static float lit[4 * PIXELS], open[4 * PIXELS], depths[PIXELS];

/* ---- Occluders ------------------------------------------------------------------------------- */

typedef struct shape {
    int box;
    double middle[3], half[3]; /* a ball: its radius in half[0] */
} shape;

static const shape *shapes;
static uint32_t shape_count;

static int inside(const shape *s, const double p[3]) {
    double d[3], square = 0;
    int in = 1;
    for (int k = 0; k < 3; k++) {
        d[k] = p[k] - s->middle[k];
        square += d[k] * d[k];
        in &= fabs(d[k]) < s->half[k];
    }
    return s->box ? in : square < s->half[0] * s->half[0];
}

static int blocks(const shape *s, const double from[3], const double to[3]) {
    double enter = 0, leave = 1, o[3], d[3];
    for (int k = 0; k < 3; k++) o[k] = from[k] - s->middle[k], d[k] = to[k] - from[k];
    if (!s->box) {
        double a = dot3(d, d), b = dot3(o, d), c = dot3(o, o) - s->half[0] * s->half[0],
               root = b * b - a * c;
        if (root < 0) return 0;
        enter = fmax(enter, (-b - sqrt(root)) / a), leave = fmin(leave, (-b + sqrt(root)) / a);
        return enter < leave;
    }
    for (int k = 0; k < 3; k++) {
        double x = (-s->half[k] - o[k]) / d[k], y = (s->half[k] - o[k]) / d[k];
        enter = fmax(enter, fmin(x, y)), leave = fmin(leave, fmax(x, y));
    }
    return enter < leave;
}

/* Approximate distance from the surface of a shape. */
static double off(const shape *s, const double p[3]) {
    double d[3], most = -1e9;
    for (int k = 0; k < 3; k++) {
        d[k] = p[k] - s->middle[k];
        most = fmax(most, fabs(d[k]) - s->half[k]);
    }
    return s->box ? most : sqrt(dot3(d, d)) - s->half[0];
}

/* Whether only `own` is between a point and the light. Shapes that contain the light do not block
 * it. */
static int sees(const double at[3], const double light[3], uint32_t own) {
    for (uint32_t i = 0; i < shape_count; i++) {
        if (i != own && blocks(&shapes[i], at, light) && !inside(&shapes[i], light)) return 0;
    }
    return 1;
}

/* 1: visible from all around, within the filter's extent across the light's rays; 0: from no point
 * there; -1: an edge. at: slightly off its surface. */
static int around(const double at[3], const double light[3]) {
    double to[3], u[3], v[3], up[3] = {0.1, 1, 0.2}, reach = 0;
    uint32_t own = shape_count;
    for (int k = 0; k < 3; k++) to[k] = light[k] - at[k], reach += to[k] * to[k];
    reach = 2.5 * (2.0 / 124) * sqrt(reach); /* texels of the smallest tile */
    for (uint32_t i = 0; i < shape_count; i++) own = fabs(off(&shapes[i], at)) < 0.03 ? i : own;
    cross3(to, up, u);
    unit3(u);
    cross3(to, u, v);
    unit3(v);
    int here = sees(at, light, shape_count);
    for (int i = 0; i < 12; i++) {
        double from[3], part = reach * (i < 4 ? 0.5 : 1), turn = 0.785398 * i;
        for (int k = 0; k < 3; k++) from[k] = at[k] + part * (cos(turn) * u[k] + sin(turn) * v[k]);
        if (sees(from, light, own) != here) return -1;
    }
    return here;
}

/* ---- Images ---------------------------------------------------------------------------------- */

static const masu_camera camera = {
    .position = {0, 3, 8}, .forward = {0, -0.3f, -1}, .fov_y = 0.8f, .near_distance = 0.1f};

static void ray_of(uint32_t x, uint32_t y, double out[3]) {
    double f[3], r[3], u[3], up[3] = {0, 1, 0}, tan_y = tan((double)camera.fov_y / 2);
    for (int k = 0; k < 3; k++) f[k] = (double)camera.forward[k];
    unit3(f);
    cross3(f, up, r);
    unit3(r);
    cross3(r, f, u);
    double a = ((x + 0.5) / WIDTH * 2 - 1) * tan_y * WIDTH / HEIGHT,
           b = ((y + 0.5) / HEIGHT * 2 - 1) * tan_y;
    for (int k = 0; k < 3; k++) out[k] = f[k] + r[k] * a - u[k] * b;
}

static void bake(const char *name, const char *models, const char *sdf, const char *lights,
                 const char *more) {
    char json[4096];
    write_text("casters.sdf", sdf);
    assert_true(
        (size_t)snprintf(json, sizeof json,
                         "{\"models\": [%s], \"ambient\": [0, 0, 0], \"sun\": {\"intensity\": 0}, "
                         "\"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]}, "
                         "\"ambient_occlusion\": false, "
                         "\"sdf\": {\"source\": \"casters.sdf\", \"bounds\": [[-6, -2, -6], [6, 6, "
                         "6]], \"shadows\": false, "
                         "\"ambient_occlusion\": false}, \"lights\": [%s]%s}",
                         models, lights, more) < sizeof json);
    bake_scene(name, json);
}

static void open_scene(masu_session *s, const char *name) {
    masu_session_desc d = test_desc(NULL, WIDTH, HEIGHT);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH;
    d.desc.frames_in_flight = 1;
    d.desc.rung_count = 2;
    d.desc.rungs[NONE].local_shadows = MASU_OFF;
    d.desc.reserve.particles = 1;
    d.desc.debug.poison = 1;
    open_session(s, &d);
}

static void render(masu_session *s, uint32_t rung, uint32_t frames, masu_frame_desc frame,
                   float *hdr) {
    masu_commands commands;
    frame.camera = &camera;
    frame.rung = rung;
    faces = 0, evals = 0;
    for (uint32_t i = 0; i < frames; i++) {
        draw(s, &frame, &commands, NULL);
        masu_stats_info stats = stats_of(s, commands.slot);
        faces += stats.local_shadow_faces, evals += stats.shadow_evals;
    }
    floats_of_halves(read_image(s, commands.slot, MASU_READBACK_HDR), hdr, 4 * PIXELS);
    memcpy(depths, read_image(s, commands.slot, MASU_READBACK_DEPTH), sizeof depths);
    assert_int_equal(stats_of(s, commands.slot).replaced, 0);
}

typedef struct tally {
    uint32_t dark, bright, wrong, leaks, acne;
} tally;

/* Adds a pixel with an unambiguous reference, for the surface at `at`. */
static void take(tally *t, uint32_t pixel, const double at[3], const double light[3]) {
    double without = (double)open[4 * pixel], with = (double)lit[4 * pixel];
    if (!(without > 2e-3)) return;
    double to[3], p[3];
    for (int k = 0; k < 3; k++) to[k] = light[k] - at[k];
    unit3(to);
    for (int k = 0; k < 3; k++) p[k] = at[k] + 0.02 * to[k];
    int truth = around(p, light);
    if (truth < 0) return;
    double seen = with / without;
    if (truth) t->bright++; else t->dark++;
    t->wrong += fabs(seen - truth) > 0.1;
    t->leaks += !truth && seen > 0.1;
    t->acne += truth && seen < 0.99;
}

static const double by_depth = (double)NAN;

/* plane_z: the surface is a pane there, which is in no depth image; or by_depth. */
static tally compare(const double light[3], double plane_z) {
    tally t = {0};
    for (uint32_t i = 0; i < PIXELS; i++) {
        double ray[3], at[3],
            z = depths[i] > 0 ? (double)camera.near_distance / (double)depths[i] : 0;
        ray_of(i % WIDTH, i / WIDTH, ray);
        double forward = (ray[1] * -0.3 - ray[2]) / sqrt(1.09);
        if (!isnan(plane_z)) z = (plane_z - camera.position[2]) / ray[2] * forward;
        if (!(z > 0)) continue;
        for (int k = 0; k < 3; k++) at[k] = camera.position[k] + z / forward * ray[k];
        take(&t, i, at, light);
    }
    return t;
}

static void expect(const char *what, tally t, uint32_t dark, uint32_t bright, int blurred) {
    print_message("%-34s %5u dark, %5u bright, %u with an error over 0.1, %u below 0.99\n",
                  what, t.dark, t.bright, t.wrong, t.acne);
    if (t.dark < dark || t.bright < bright) fail_msg("%s: too few pixels", what);
    if (t.wrong * 100 > t.dark + t.bright)
        fail_msg("%s: %u of %u pixels", what, t.wrong, t.dark + t.bright);
    if (t.leaks * 20 > t.dark) fail_msg("%s: %u of %u dark pixels are lit", what, t.leaks, t.dark);
    if (!blurred && t.acne * 200 > t.bright) fail_msg("%s: acne, %u of %u", what, t.acne, t.bright);
}

/* ---- Tests ----------------------------------------------------------------------------------- */

#define GROUND                                                                                     \
    "{\"mesh\": {\"plane\": {\"size_x\": 24, \"size_z\": 24}}, \"material\": {\"roughness\": 1}}"
#define POINT "{\"type\": \"point\", \"position\": [1, 4, 1.5], \"intensity\": 30, \"range\": 20}"
#define SPOT                                                                                                      \
    "{\"type\": \"spot\", \"position\": [1, 4, 1.5], \"direction\": [-1, -4, -1], \"outer\": 40, \"inner\": 35, " \
    "\"intensity\": 30, \"range\": 20}"

static const shape ball_and_box[] = {{0, {-1.2, 1, 0}, {0.8, 0, 0}},
                                     {1, {1.5, 0.7, -1}, {0.5, 0.7, 0.6}}};
static const char ball_and_box_text[] =
    "part a = translate((-1.2, 1, 0), sphere(0.8));\n"
    "part b = translate((1.5, 0.7, -1), box((0.5, 0.7, 0.6)));\n";
static const double lamp[3] = {1, 4, 1.5};

static void points_and_spots_see_the_sdf(void **state) {
    (void)state;
    static const char *const lights[] = {POINT, SPOT};
    shapes = ball_and_box, shape_count = 2;
    for (int i = 0; i < 2; i++) {
        masu_session s;
        bake("casters", GROUND, ball_and_box_text, lights[i], ", \"reflections\": false");
        open_scene(&s, "casters");
        render(&s, NONE, 1, (masu_frame_desc){0}, open);
        render(&s, SHADOWS, SETTLED, (masu_frame_desc){0}, lit);
        print_message("%u faces, %.1f samples of the field for each of 128x128 texels\n", faces,
                      (double)evals / (faces * 128 * 128));
        expect(i ? "spot: ground and itself" : "point: ground and itself", compare(lamp, by_depth),
               100, 2000, 0);
        close_session(&s);
    }
}

/* No polygon at all; many parts, whose lists contain numbers. */
static void the_sdf_alone_has_shadows(void **state) {
    (void)state;
    char text[8192];
    static shape balls[81];
    size_t used = (size_t)snprintf(text, sizeof text, "part ground = plane((0, 1, 0), 0);\n");
    masu_session s;
    for (int i = 0; i < 81; i++) {
        double at[3] = {(i % 9 - 4) * 0.9, 0.5 + 0.1 * (i % 5), (i / 9 - 5) * 0.9};
        balls[i] = (shape){0, {at[0], at[1], at[2]}, {0.25, 0, 0}};
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "part p%d = translate((%.9g, %.9g, %.9g), sphere(0.25));\n", i,
                                 at[0], at[1], at[2]);
    }
    shapes = balls, shape_count = 81;
    bake("alone", "", text, POINT, ", \"reflections\": false");
    open_scene(&s, "alone");
    render(&s, NONE, 1, (masu_frame_desc){0}, open);
    render(&s, SHADOWS, SETTLED, (masu_frame_desc){0}, lit);
    print_message("%u faces, %.1f samples of the field for each of 128x128 texels\n", faces,
                  (double)evals / (faces * 128 * 128));
    expect("81 balls over a half-space", compare(lamp, by_depth), 80, 1000, 0);
    close_session(&s);
}

static void polygons_shade_the_sdf(void **state) {
    (void)state;
    shape both[] = {{1, {0, 1.5, 0}, {0.8, 0.1, 0.8}}, {0, {0.3, 0.5, 0.3}, {0.4, 0, 0}}};
    masu_session s;
    shapes = both, shape_count = 2;
    bake("roof",
         "{\"mesh\": {\"box\": {\"size\": [1.6, 0.2, 1.6]}}, \"name\": \"roof\", \"translate\": "
         "[0, 1.5, 0]}",
         "part ground = plane((0, 1, 0), 0);\npart ball = translate((0.3, 0.5, 0.3), "
         "sphere(0.4));\n",
         POINT, ", \"reflections\": false");
    open_scene(&s, "roof");
    render(&s, NONE, 1, (masu_frame_desc){0}, open);
    render(&s, SHADOWS, SETTLED, (masu_frame_desc){0}, lit);
    expect("a polygon over the SDF", compare(lamp, by_depth), 150, 1500, 0);
    assert_true(evals > 0);
    /* The SDF's part of the faces is kept while only a polygon moves. */
    both[0].middle[0] = 0.4;
    move_instance(&s, "roof", 0.4f, 1.5f, 0, 1);
    render(&s, SHADOWS, 8, (masu_frame_desc){0}, lit);
    assert_true(faces > 0);
    assert_int_equal(evals, 0);
    render(&s, NONE, 1, (masu_frame_desc){0}, open);
    expect("the same, moved", compare(lamp, by_depth), 150, 1500, 0);
    close_session(&s);
}

/* A lamp in its bulb below a roof, both of the SDF: it lights the ground, but not an object on the
 * roof. */
static void a_bulb_lets_its_light_out_and_a_roof_does_not(void **state) {
    (void)state;
    static const shape lantern[] = {{0, {0, 1, 0}, {0.15, 0, 0}}, {1, {0, 1.5, 0}, {1, 0.1, 1}}};
    const double bulb[3] = {0, 1, 0};
    masu_session s;
    shapes = lantern, shape_count = 2;
    bake("lantern",
         GROUND ", {\"mesh\": {\"box\": {\"size\": [5, 0.05, 0.3]}}, \"translate\": [0, 2.4, 0], "
                "\"rotate\": [-60, 0, 0]}",
         "part bulb = translate((0, 1, 0), sphere(0.15));\npart roof = translate((0, 1.5, 0), "
         "box((1, 0.1, 1)));\n",
         "{\"type\": \"point\", \"position\": [0, 1, 0], \"intensity\": 10, \"range\": 12, "
         "\"radius\": 0.05}",
         ", \"reflections\": false");
    open_scene(&s, "lantern");
    render(&s, NONE, 1, (masu_frame_desc){0}, open);
    render(&s, SHADOWS, SETTLED, (masu_frame_desc){0}, lit);
    expect("a lamp below its roof", compare(bulb, by_depth), 20, 2000, 0);
    close_session(&s);
}

static void a_pane_and_a_particle_lie_in_the_shadow(void **state) {
    (void)state;
    masu_session s;
    shapes = ball_and_box, shape_count = 2;
    bake("pane",
         "{\"mesh\": {\"plane\": {\"size_x\": 20, \"size_z\": 20}}, \"rotate\": [90, 0, 0], "
         "\"translate\": [0, 0, -2.5], "
         "\"material\": {\"roughness\": 1, \"opacity\": 0.5}}",
         ball_and_box_text,
         "{\"type\": \"point\", \"position\": [0, 1, 4], \"intensity\": 30, \"range\": 20}",
         ", \"reflections\": false");
    open_scene(&s, "pane");
    const double front[3] = {0, 1, 4};
    masu_particle spark = {.half_width = 0.3f,
                           .color = {1, 1, 1},
                           .opacity = 1,
                           .edge = 1,
                           .flags = MASU_PARTICLE_LIT};
    render(&s, NONE, 1, (masu_frame_desc){0}, open);
    render(&s, SHADOWS, SETTLED, (masu_frame_desc){0}, lit);
    for (uint32_t i = 0; i < PIXELS; i++) {
        if (depths[i] > 0) open[4 * i] = 0; /* a surface in front of it */
    }
    expect("a pane behind", compare(front, -2.5), 200, 2000, 0);
    /* Behind the ball, visible above it; and next to it. */
    for (int bright = 0; bright < 2; bright++) {
        spark.position[0] = bright ? 0.4 : -2.1, spark.position[1] = bright ? 2.4 : 1.8,
        spark.position[2] = -2;
        masu_frame_desc frame = {.particles = &spark, .particle_count = 1};
        render(&s, NONE, 1, frame, open);
        render(&s, SHADOWS, SETTLED, frame, lit);
        assert_int_equal(around(spark.position, front), bright);
        double want = 0, is = 0;
        for (uint32_t i = 0; i < PIXELS; i++) {
            double ray[3], x[2];
            ray_of(i % WIDTH, i / WIDTH, ray);
            for (int k = 0; k < 2; k++)
                x[k] = camera.position[k] + ray[k] * (-2 - camera.position[2]) / ray[2] -
                       spark.position[k];
            if (hypot(x[0], x[1]) > 0.2 || depths[i] > 0) continue;
            want += (double)open[4 * i], is += (double)lit[4 * i];
        }
        print_message("a particle %s: %.4f of its light\n", bright ? "beside" : "behind",
                      is / want);
        assert_true(want > 0.1 && (bright ? is > 0.99 * want : is < 0.01 * want));
    }
    close_session(&s);
}

/* A mirror as the floor in front of a wall: the wall's reflection is as dark as the wall. */
static void a_mirror_shows_the_shadow(void **state) {
    (void)state;
    masu_session s;
    tally t = {0};
    shapes = ball_and_box, shape_count = 1;
    bake("mirror",
         "{\"mesh\": {\"plane\": {\"size_x\": 24, \"size_z\": 24}}, \"traced\": true, "
         "\"material\": {\"roughness\": 0.0, \"metallic\": 1}}, "
         "{\"mesh\": {\"box\": {\"size\": [20, 12, 1]}}, \"translate\": [0, 0, -3.5], \"traced\": "
         "true, \"material\": {\"roughness\": 1}}",
         "part a = translate((-1.2, 1, 0), sphere(0.8));\n",
         "{\"type\": \"point\", \"position\": [-1, 1, 4], \"intensity\": 30, \"range\": 20}",
         ", \"reflections\": {}");
    const double front[3] = {-1, 1, 4};
    open_scene(&s, "mirror");
    render(&s, NONE, SETTLED, (masu_frame_desc){0}, open);
    render(&s, SHADOWS, 2 * SETTLED, (masu_frame_desc){0}, lit);
    for (uint32_t i = 0; i < PIXELS; i++) {
        double ray[3], at[3], floor_t, wall_t;
        ray_of(i % WIDTH, i / WIDTH, ray);
        floor_t = -camera.position[1] / ray[1];
        for (int k = 0; k < 3; k++) at[k] = camera.position[k] + floor_t * ray[k];
        if (!(floor_t > 0) || at[2] < -2.9 || at[2] > 3.5 || !sees(at, camera.position, 1))
            continue;
        wall_t = (-3 - at[2]) / ray[2];
        const double on_floor[3] = {at[0], 1e-3, at[2]};
        for (int k = 0; k < 3; k++) at[k] += wall_t * (k == 1 ? -ray[k] : ray[k]);
        if (at[1] > 5 || !sees(on_floor, at, 1)) continue; /* the ball is reflected there */
        take(&t, i, at, front);
    }
    expect("in a mirror", t, 100, 1000, 1);
    close_session(&s);
}

/* A ball moved by a parameter: faces are rendered again, and shadows follow. */
static void shadows_follow_a_parameter(void **state) {
    (void)state;
    masu_session s;
    shape ball = {0, {0, 1, 0}, {0.5, 0, 0}};
    shapes = &ball, shape_count = 1;
    bake("moves", GROUND, "param x = 0 [-3, 3];\npart a = translate((x, 1, 0), sphere(0.5));\n",
         POINT, ", \"reflections\": false");
    open_scene(&s, "moves");
    for (int i = 0; i < 2; i++) {
        float x = i ? -1.5f : 1.0f;
        masu_frame_desc frame = {.sdf_params = &x, .sdf_param_count = 1};
        ball.middle[0] = (double)x;
        render(&s, NONE, 1, frame, open);
        render(&s, SHADOWS, SETTLED, frame, lit);
        expect(i ? "a ball after its motion" : "a ball in motion", compare(lamp, by_depth), 40,
               2000, 0);
        if (i) break;
        /* From frame to frame of the same rung, with two frames for the faces of a point light. */
        x = ball.middle[0] = -0.5;
        render(&s, SHADOWS, 4, frame, lit);
        render(&s, NONE, 1, frame, open);
        expect("the next frames", compare(lamp, by_depth), 40, 2000, 0);
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_and_spots_see_the_sdf),
        cmocka_unit_test(the_sdf_alone_has_shadows),
        cmocka_unit_test(polygons_shade_the_sdf),
        cmocka_unit_test(a_bulb_lets_its_light_out_and_a_roof_does_not),
        cmocka_unit_test(a_pane_and_a_particle_lie_in_the_shadow),
        cmocka_unit_test(a_mirror_shows_the_shadow),
        cmocka_unit_test(shadows_follow_a_parameter),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

/* test_far.c: an SDF scene a million and ten million metres from the origin gives the same image as
 * at the origin: coverage, depth, material and velocity. The scene is written and baked here, with
 * another offset each time; without anchors the same comparison fails. Polygons, lights and decals
 * with double positions give the same image as at the origin, too. */
#include "scene/scene.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 130, H = 72 };

/* Position of the visible region's centre, from the offset: at a border of the anchor's grid, so
 * that small movements of the camera change the anchor. */
#define MIDDLE 32

/* Offsets are multiples of the periods 4, 3.2 and 1000000 / 303000, so that repeated parts without
 * an offset look the same. The rotated part's centre is rotated back by hand. */
static const char *const text =
    "param radius = 0.5 [0.2, 0.9];\n"
    "let o = (%d + %d, 0, %d); let a = 0.3;\n"
    "let turned = (cos(a) * o.x - sin(a) * o.z, 0, sin(a) * o.x + cos(a) * o.z);\n"
    "material red { albedo (0.8, 0.2, 0.2); roughness 0.5 }\n"
    "material green { albedo (0.2, 0.8, 0.2); roughness 0.5 }\n"
    "material blue { albedo (0.2, 0.2, 0.8); roughness 0.5 }\n"
    "material grey { albedo 0.5; roughness 0.5 }\n"
    "part ground : grey = plane((0, 1, 0), -1);\n"
    "part slope : blue = translate(o + (-3, 0, 0), plane((0.8, 0.6, 0), -1.2));\n"
    "part ball : red = translate(o + (-1.3, 0, 0.3), sphere(radius));\n"
    "part crate : green = translate(o + (0.1 * time, 0.1, 0), rotate((1, 2, 3), 0.7 + 0.3 * time,\n"
    "    scale(1 + 0.1 * time, box((0.5, 0.4, 0.3)))));\n"
    "part wheel : blue = rotate((0, 1, 0), a, translate(turned, torus(2, 0.1)));\n"
    "part drops : red = repeat((4, 0, 3.2), translate((0.3, 2, 0.4), sphere(0.2)));\n"
    "part rows : green = repeat((0, 0, 1000000 / 303000), translate((%d + %d + 1.6, -0.5, 0.7),\n"
    "    box((0.2, 0.5, 0.3))));\n"
    "part blend : red = smooth_union(0.3, translate(o + (1.2, 0, 0.5), sphere(0.4)),\n"
    "    translate(o + (1.2, 0.6, 0.5), displace(0.05, (5, 6, 7), box((0.3, 0.2, 0.2)))));\n"
    "part pair : blue = translate(o + (0, 1.1, 0), mirror((1, 0, 0), translate((0.4, 0, 0),\n"
    "    octahedron(0.3))));\n"
    "part flat : grey = translate(o + (-0.6, 0.9, 1), scale((1, 0.5, 1.5), sphere(0.3)));\n";

typedef struct picture {
    float depth[W * H]; /* view depth, 0: nothing */
    uint8_t albedo[W * H * 4];
    double velocity[W * H][4];
} picture;

/* The blob, baked on first use. member: a member of the SDF's description, or "". */
static const char *baked(int offset, const char *member) {
    static char scene[4096], json[1024], name[64], blob[80];
    snprintf(name, sizeof name, "%d-%zu", offset, strlen(member));
    snprintf(blob, sizeof blob, "%s.masu", name);
    if (is_in_scratch(blob)) return in_scratch(blob);
    snprintf(scene, sizeof scene, text, offset, MIDDLE, -offset, offset, MIDDLE);
    write_text("s.sdf", scene);
    snprintf(json, sizeof json,
             "{\"camera\": {\"near\": 0.1}, \"sdf\": {\"source\": \"s.sdf\", \"bounds\": "
             "[[%d, -2, %d], [%d, 8, %d]], \"max_distance\": 100%s}}",
             offset + MIDDLE - 40, -offset - 40, offset + MIDDLE + 40, -offset + 40, member);
    bake_scene(name, json);
    return baked_scene(name);
}

static void open_at(masu_session *s, int offset, const char *member) {
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked(offset, member);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_ALBEDO | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    open_session(s, &d);
}

/* Frame 0 or 1 of a camera that passes the centre, while the crate moves and the ball grows. */
static void take(masu_session *s, int offset, int number, picture *p) {
    masu_commands commands;
    float radius = 0.5f + 0.03f * (float)number;
    masu_camera c = {.position = {offset + MIDDLE - 0.04 + 0.08 * number, 1.4, -offset + 5.0},
                     .forward = {0.02f * (float)number, -0.25f, -1},
                     .fov_y = 0.9f,
                     .near_distance = 0.1f};
    masu_frame_desc frame = {
        .camera = &c, .time = 0.5 + 0.1 * number, .sdf_params = &radius, .sdf_param_count = 1};
    draw(s, &frame, &commands, NULL);
    view_depths(read_image(s, commands.slot, MASU_READBACK_DEPTH), &c, p->depth, W * H);
    memcpy(p->albedo, read_image(s, commands.slot, MASU_READBACK_ALBEDO), sizeof p->albedo);
    const uint16_t *velocity = read_image(s, commands.slot, MASU_READBACK_VELOCITY);
    for (uint32_t i = 0; i < 4 * W * H; i++) p->velocity[i / 4][i % 4] = half_float(velocity[i]);
}

/* The depth changes within a pixel: at a silhouette, the smallest rounding decides whether a ray
 * hits, so depth differences there count as another surface. */
static int near_a_border(const picture *a, uint32_t i) {
    for (int dy = -1; dy <= 1; dy++) {
        for (int dx = -1; dx <= 1; dx++) {
            int x = (int)(i % W) + dx, y = (int)(i / W) + dy;
            if (x < 0 || y < 0 || x >= W || y >= H) continue;
            float z = a->depth[y * W + x];
            if ((z > 0) != (a->depth[i] > 0) || fabsf(z - a->depth[i]) > 0.05f * z) return 1;
        }
    }
    return 0;
}

typedef struct difference {
    uint32_t hits, coverage, surface; /* pixels; with a hit in one image only, or on different
                                         surfaces */
    double depth, velocity;           /* among the others: relative, pixels */
    uint32_t deep;                    /* among the others: pixels with a depth difference over
                                         1e-4 */
} difference;

static difference compare(const picture *a, const picture *b) {
    difference d;
    memset(&d, 0, sizeof d);
    for (uint32_t i = 0; i < W * H; i++) {
        int here = a->depth[i] > 0, there = b->depth[i] > 0;
        d.hits += (uint32_t)here;
        d.coverage += here != there;
        if (!here || !there) continue;
        double off = fabs((double)b->depth[i] / (double)a->depth[i] - 1);
        if (memcmp(a->albedo + 4 * i, b->albedo + 4 * i, 4) != 0 ||
            (off > 1e-4 && near_a_border(a, i))) {
            d.surface++;
            continue;
        }
        d.depth = worst_of(d.depth, off);
        d.deep += off > 1e-4;
        d.velocity = worst_of(d.velocity, hypot(a->velocity[i][0] - b->velocity[i][0],
                                            a->velocity[i][1] - b->velocity[i][1]));
    }
    return d;
}

static picture here[2], there[2];

static void take_both(int offset, const char *member, picture p[2]) {
    masu_session s;
    open_at(&s, offset, member);
    for (int i = 0; i < 2; i++) take(&s, offset, i, &p[i]);
    close_session(&s);
}

static difference largest_of(const char *what) {
    difference worst = {0};
    for (int i = 0; i < 2; i++) {
        difference d = compare(&here[i], &there[i]);
        print_message("  %s, frame %d: %u hits; %u pixels differ in coverage, %u at borders; depth "
                      "by %.1e (%u pixels above 1e-4), velocity by %.4f px\n",
                      what, i, d.hits, d.coverage, d.surface, d.depth, d.deep, d.velocity);
        assert_true(d.hits > W * H / 2);
        if (d.coverage > worst.coverage) worst.coverage = d.coverage;
        if (d.surface > worst.surface) worst.surface = d.surface;
        if (d.deep > worst.deep) worst.deep = d.deep;
        worst.velocity = worst_of(worst.velocity, d.velocity);
        worst.depth = worst_of(worst.depth, d.depth);
    }
    return worst;
}

static void far_from_the_origin_it_looks_the_same(void **state) {
    (void)state;
    static const struct {
        int offset;
        const char *member, *what;
    } cases[] = {{0, ", \"anchored\": true", "at the origin, anchored"},
                 {1000000, "", "1e6 m away"},
                 {10000000, "", "1e7 m away"}};
    take_both(0, "", here);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (i == 1 && !long_run()) continue; /* 1e7 m are harder */
        take_both(cases[i].offset, cases[i].member, there);
        difference d = largest_of(cases[i].what);
        assert_true(d.coverage <= 4);
        assert_true(d.surface <= 30);
        assert_true(d.depth < 1e-4);
        assert_true(d.velocity < 0.02);
    }
}

/* The comparison can fail: world coordinates in single precision are 0.06 m apart there. */
static void without_anchors_it_does_not(void **state) {
    (void)state;
    take_both(0, "", here);
    take_both(1000000, ", \"anchored\": false", there);
    difference d = largest_of("1e6 m away, not anchored");
    assert_true(d.surface > 300 && d.deep > 100);
}

static void the_plan_says_whether_it_is_anchored(void **state) {
    (void)state;
    static const char *const why[] = {
        "the SDF depends on parameters or time",
        "the SDF has a floating origin"};
    for (int i = 0; i < 2; i++) {
        masu_session s;
        masu_plan_info plan;
        open_at(&s, i * 10000000, "");
        assert_int_equal(masu_scene_data_of(&s.scene)->sdf_anchored, i);
        masu_plan_of(s.m, &plan);
        for (uint32_t p = 0; p < plan.pass_count; p++) {
            if (!strcmp(plan.passes[p].name, "update")) {
                assert_string_equal(plan.passes[p].why, why[i]);
            }
        }
        close_session(&s);
    }
}

/* A ground of 3 km: normals as exact as on a small ball, in scenes with a floating origin and
 * without. In single precision the difference of two lengths rotates them by up to 20 degrees near
 * the camera. */
static void a_large_ball_is_a_smooth_ground(void **state) {
    (void)state;
    static float depths[W * H];
    const masu_camera c = {
        .position = {0, 1.7, 0}, .forward = {0, -0.2f, -1}, .fov_y = 0.9f, .near_distance = 0.1f};
    write_text("ball.sdf", "material m { albedo 0.5; roughness 1 } part ground : m = translate((0, "
                           "-3000, 0), sphere(3000));\n");
    for (int anchored = 0; anchored < 2; anchored++) {
        char json[256];
        masu_session s;
        masu_commands commands;
        double worst = 0;
        uint32_t hits = 0;
        snprintf(json, sizeof json,
                 "{\"camera\": {\"near\": 0.1}, \"sdf\": {\"source\": \"ball.sdf\", \"bounds\": "
                 "[[-200, -9, -200], [200, 9, 200]], \"max_distance\": 150, \"anchored\": %s}}",
                 anchored ? "true" : "false");
        bake_scene(anchored ? "ball1" : "ball0", json);
        masu_session_desc d = test_desc(NULL, W, H);
        d.scene_path = baked_scene(anchored ? "ball1" : "ball0");
        d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_NORMAL;
        d.desc.rung_count = 1;
        open_session(&s, &d);
        draw(&s, &(masu_frame_desc){.camera = &c}, &commands, NULL);
        view_depths(read_image(&s, commands.slot, MASU_READBACK_DEPTH), &c, depths, W * H);
        const uint32_t *normals = read_image(&s, commands.slot, MASU_READBACK_NORMAL);
        const double length = sqrt(1 + 0.2 * 0.2), tan_y = tan(0.45);
        for (uint32_t i = 0; i < W * H; i++) {
            if (!(depths[i] > 0)) continue;
            float n[3];
            double z = (double)depths[i], x = ((i % W + 0.5) / W * 2 - 1) * tan_y * W / H * z,
                   y = (1 - (i / W + 0.5) / H * 2) * tan_y * z;
            double at[3] = {x, 1.7 + (y - 0.2 * z) / length, -(z + 0.2 * y) / length}, away = 0,
                   size = 0;
            masu_unpack_normal(normals[i], n);
            at[1] += 3000;
            for (int k = 0; k < 3; k++) size += at[k] * at[k];
            for (int k = 0; k < 3; k++) away += pow((double)n[k] - at[k] / sqrt(size), 2);
            worst = worst_of(worst, sqrt(away));
            hits++;
        }
        close_session(&s);
        print_message("  %s: %u hits, normals within %.5f\n", anchored ? "anchored" : "plain", hits,
                      worst);
        assert_true(hits > W * H / 4 && worst < 0.002);
    }
}

/* ---- Polygons -------------------------------------------------------------------------------- */

static masu_detail failure;

typedef struct placed {
    uint8_t color[W * H * 4], albedo[W * H * 4];
    float depth[W * H];
    uint16_t velocity[W * H * 4];
} placed;

static placed near_by[2], far_out[2];

static const struct {
    const char *name;
    double at[3];
} movers[] = {{"ground", {0, 0, 0}},
              {"block", {-1.3, 0.5, 0.3}},
              {"ball", {0.4, 0.6, -0.5}},
              {"pane", {1.1, 0.7, 1.2}}};
enum { MOVERS = sizeof movers / sizeof *movers };

static const char *const polygons =
    "{\"camera\": {\"near\": 0.1}, \"ambient\": [0.2, 0.2, 0.25], \"ambient_occlusion\": false,"
    "\"sun\": {\"azimuth\": 40, \"elevation\": 50, \"shadows\": false}, \"reflections\": {}, "
    "\"models\": ["
    "{\"name\": \"ground\", \"mesh\": {\"plane\": {\"size_x\": 20, \"size_z\": 20}}, \"moving\": "
    "true,"
    " \"material\": {\"base_color\": [0.5, 0.5, 0.5], \"roughness\": 0.1, \"metallic\": 0.9}},"
    "{\"name\": \"block\", \"mesh\": {\"box\": {\"size\": [1, 1, 1]}}, \"rotate_y\": 30, "
    "\"moving\": true,"
    " \"material\": {\"base_color\": [0.8, 0.2, 0.2]}},"
    "{\"name\": \"ball\", \"mesh\": {\"sphere\": {\"radius\": 0.5, \"subdivisions\": 3}}, "
    "\"moving\": true,"
    " \"material\": {\"base_color\": [0.2, 0.8, 0.2]}},"
    "{\"name\": \"pane\", \"mesh\": {\"box\": {\"size\": [1, 1, 0.05]}}, \"moving\": true,"
    " \"material\": {\"base_color\": [0.2, 0.3, 0.9], \"opacity\": 0.5}}],"
    "\"lights\": [{\"name\": \"lamp\", \"type\": \"point\", \"color\": [4, 3, 2], \"range\": 6,"
    " \"position\": [0, 1.5, 0], \"instance\": \"ball\"}]}";

/* The ball as an instance, the others as models. */
static void place_all(masu_session *s, const double offset[3], int number, int doubles) {
    for (uint32_t i = 0; i < MOVERS; i++) {
        masu_model model = masu_model_find(s->m, movers[i].name);
        double at[3];
        for (int k = 0; k < 3; k++) at[k] = offset[k] + movers[i].at[k];
        at[0] += i == 1 ? 0.03 * number : 0;
        const float rows[12] = {1, 0, 0, (float)at[0], 0, 1, 0, (float)at[1],
                                0, 0, 1, (float)at[2]};
        if (!doubles)
            assert_int_equal(masu_model_set_transform(s->m, model, rows, &failure), MASU_OK);
        else if (i == 2)
            assert_int_equal(
                masu_instance_set_position(s->m, masu_instance_find(s->m, "ball"), at, &failure),
                MASU_OK);
        else
            assert_int_equal(masu_model_set_position(s->m, model, at, &failure), MASU_OK);
    }
}

/* Three frames: the camera crosses the border at which the device's origin moves, and the block
 * moves. The last two frames are kept. */
static void take_polygons(const double offset[3], int doubles, placed out[2]) {
    masu_session s;
    masu_commands commands;
    if (!is_in_scratch("polygons.masu")) bake_scene("polygons", polygons);
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene("polygons");
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_ALBEDO | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    d.desc.double_positions = (uint32_t)doubles;
    d.desc.reserve.decals = 1;
    open_session(&s, &d);
    for (int i = 0; i < 3; i++) {
        masu_camera c = {.position = {offset[0] - 0.06 + 0.04 * i, offset[1] + 1.4, offset[2] + 5},
                         .forward = {0.02f * (float)i, -0.2f, -1},
                         .fov_y = 0.9f,
                         .near_distance = 0.1f};
        const double at[3] = {offset[0] - 0.2, offset[1], offset[2] + 1.5};
        masu_decal decal = {.rows = {0.5f, 0, 0, 0, 0, 0, 0.5f, 0, 0, -0.4f, 0, 0},
                            .color = {0.9f, 0.7f, 0.1f},
                            .opacity = 1,
                            .roughness = 0.8f};
        for (int k = 0; k < 3; k++) {
            if (doubles)
                decal.position[k] = at[k];
            else
                decal.rows[4 * k + 3] = (float)at[k];
        }
        place_all(&s, offset, i, doubles);
        draw(&s,
             &(masu_frame_desc){
                 .camera = &c, .time_step = 0.02f, .decals = &decal, .decal_count = 1},
             &commands, out[i ? i - 1 : 0].color);
        if (!i) continue;
        placed *p = &out[i - 1];
        view_depths(read_image(&s, commands.slot, MASU_READBACK_DEPTH), &c, p->depth, W * H);
        memcpy(p->albedo, read_image(&s, commands.slot, MASU_READBACK_ALBEDO), sizeof p->albedo);
        memcpy(p->velocity, read_image(&s, commands.slot, MASU_READBACK_VELOCITY),
               sizeof p->velocity);
    }
    close_session(&s);
}

typedef struct placed_difference {
    uint32_t hits, steps, velocity; /* pixels; with colours more than 1/255 apart; with velocities
                                       0.01 px apart */
    int worst;                      /* of the colours */
} placed_difference;

static placed_difference compare_placed(const char *what) {
    placed_difference d = {0, 0, 0, 0};
    for (int n = 0; n < 2; n++) {
        const placed *a = &near_by[n], *b = &far_out[n];
        for (uint32_t i = 0; i < W * H; i++) {
            int off = 0;
            for (uint32_t k = 0; k < 3; k++) {
                int one = abs(a->color[4 * i + k] - b->color[4 * i + k]);
                off = one > off ? one : off;
            }
            d.hits += a->depth[i] > 0;
            d.steps += off > 1;
            d.worst = off > d.worst ? off : d.worst;
            d.velocity += hypot(half_float(a->velocity[4 * i]) - half_float(b->velocity[4 * i]),
                                half_float(a->velocity[4 * i + 1]) -
                                    half_float(b->velocity[4 * i + 1])) > 0.01;
        }
    }
    print_message(
        "  polygons, %s: %u hits; %u pixels more than 1/255 off, at most %d; %u move otherwise\n",
        what, d.hits, d.steps, d.worst, d.velocity);
    return d;
}

static void double_positions_look_as_at_the_origin(void **state) {
    (void)state;
    const double origin[3] = {0, 0, 0}, away[3] = {10000032, 0, -10000000},
                 odd[3] = {10000032.375, 1000.5, -9999968.25};
    take_polygons(origin, 0, near_by);
    take_polygons(origin, 1, far_out);
    placed_difference d = compare_placed("at the origin, by doubles");
    assert_true(d.hits > W * H / 2 && !d.worst && !d.velocity);
    take_polygons(away, 1, far_out);
    d = compare_placed("1e7 m away");
    assert_true(d.steps == 0 && d.velocity == 0);
    take_polygons(odd, 1, far_out);
    d = compare_placed("1e7 m away, between floats");
    assert_true(d.steps <= 8 && d.velocity <= 8);
    take_polygons(odd, 0, far_out); /* the comparison can fail */
    d = compare_placed("1e7 m away, by floats");
    assert_true(d.steps > 1000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(far_from_the_origin_it_looks_the_same),
        cmocka_unit_test(without_anchors_it_does_not),
        cmocka_unit_test(a_large_ball_is_a_smooth_ground),
        cmocka_unit_test(the_plan_says_whether_it_is_anchored),
        cmocka_unit_test(double_positions_look_as_at_the_origin),
    };
    return cmocka_run_group_tests_name("far", tests, make_scratch, remove_scratch);
}

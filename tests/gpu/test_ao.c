/* test_ao.c: screen-space ambient occlusion: its error in scenes with a closed-form reference (a
 * corner of three planes, a ball on a floor), and that reference against ray tracing
 * (tests/support/ao.h). Properties that hold at any error: planes do not occlude themselves, a
 * stationary camera gives a constant image, nothing outside of the rendered rectangle is read, the
 * SDF's own occlusion is kept, and scenes that do not request it have no cost. */
#include "support/files.h"
#include "support/floats.h"
#include "support/shadow.h"

#include "support/ao.h"
#include "image.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 160, H = 120, RAYS = 512 };

static masu_session s;
static uint32_t slot; /* of the last rendered frame */

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* models: the members of the scene except the occlusion. radius 0: it requests none. */
static void bake_ao(const char *name, double radius, const char *members) {
    char json[2048];
    if (radius > 0) {
        snprintf(json, sizeof json, "{\"ambient_occlusion\": {\"radius\": %.9g}, %s}", radius,
                 members);
    } else {
        snprintf(json, sizeof json, "{%s}", members);
    }
    bake_scene(name, json);
}

static void open_ao(const char *name, uint32_t width, uint32_t height, const masu_rung *rung) {
    masu_session_desc d = test_desc(NULL, width, height);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_ALL;
    d.desc.rung_count = 1;
    if (rung) d.desc.rungs[0] = *rung;
    open_session(&s, &d);
}

static void draw_from(const masu_camera *camera) {
    masu_frame_desc frame = {.camera = camera};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    slot = commands.slot;
}

static const char corner[] =
    "\"models\": [{\"mesh\": {\"box\": {\"size\": [20, 1, 20]}}, \"translate\": [10, -0.5, 10]},"
    "{\"mesh\": {\"box\": {\"size\": [1, 20, 22]}}, \"translate\": [-0.5, 9.5, 10]},"
    "{\"mesh\": {\"box\": {\"size\": [22, 20, 1]}}, \"translate\": [10, 9.5, -0.5]}],"
    "\"camera\": {\"fov_y\": 50, \"near\": 0.05, \"keys\": [{\"position\": [3, 1.8, 4], "
    "\"target\": [0.5, 0.4, 0.5]}]}";

static const char ball[] =
    "\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 60, \"size_z\": 60}}},"
    "{\"mesh\": {\"sphere\": {\"radius\": 0.5, \"subdivisions\": 6}}, \"translate\": [0, 0.5, 0]}],"
    "\"camera\": {\"fov_y\": 40, \"near\": 0.05, \"keys\": [{\"position\": [0, 1.6, 2.6], "
    "\"target\": [0, 0.35, 0]}]}";

static const char floor_alone[] =
    "\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 200, \"size_z\": 200}}}],"
    "\"camera\": {\"fov_y\": 70, \"near\": 0.05, \"keys\": [{\"position\": [0, 0.4, 0], "
    "\"target\": [0.3, 0.3, -2]}]}";

/* A plate in front of a wall with the same orientation. */
static const char plate[] =
    "\"models\": [{\"mesh\": {\"box\": {\"size\": [8, 8, 0.1]}}, \"translate\": [0, 0, -0.05]},"
    "{\"mesh\": {\"box\": {\"size\": [1, 1, 0.02]}}, \"translate\": [0, 0, 0.29]}],"
    "\"camera\": {\"fov_y\": 40, \"near\": 0.05, \"keys\": [{\"position\": [0, 0, 4], \"target\": "
    "[0, 0, 0]}]}";

/* ---- Reference ------------------------------------------------------------------------------- */

/* Distance of the nearest surface along a ray that starts on a surface, by formula. */
static double corner_at(const double p[3], const double d[3]) {
    double nearest = 1e30;
    for (int k = 0; k < 3; k++) {
        if (d[k] < 0 && p[k] > 1e-3) nearest = fmin(nearest, -p[k] / d[k]);
    }
    return nearest;
}

static double ball_at(const double p[3], const double d[3]) {
    double c[3] = {p[0], p[1] - 0.5, p[2]}, b = 0, e = -0.25;
    for (int k = 0; k < 3; k++) b += c[k] * d[k], e += c[k] * c[k];
    double nearest = d[1] < 0 && p[1] > 1e-3 ? -p[1] / d[1] : 1e30;
    if (e > 3e-3 && b < 0 && b * b - e >= 0) nearest = fmin(nearest, -b - sqrt(b * b - e));
    return nearest;
}

static double true_seen(double (*at)(const double *, const double *), const double p[3],
                        const double n[3], double radius) {
    double u[3] = {1, 0, 0}, v[3], length = 0, sum = 0;
    if (fabs(n[0]) > 0.9) u[0] = 0, u[1] = 1;
    double along = u[0] * n[0] + u[1] * n[1] + u[2] * n[2];
    for (int k = 0; k < 3; k++) u[k] -= along * n[k], length += u[k] * u[k];
    for (int k = 0; k < 3; k++) u[k] /= sqrt(length);
    for (int k = 0; k < 3; k++)
        v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
    for (int i = 0; i < RAYS; i++) {
        double r2 = (i + 0.5) / RAYS, a = 2.399963229728653 * i, d[3];
        for (int k = 0; k < 3; k++)
            d[k] = n[k] * sqrt(1 - r2) + sqrt(r2) * (u[k] * cos(a) + v[k] * sin(a));
        sum += fmin(at(p, d) / radius, 1);
    }
    return sum / RAYS;
}

typedef struct surface {
    double at[3], normal[3], z;
} surface;

/* 0: the sky. */
static int surface_at(const masu_camera *c, double near, uint32_t i, surface *out) {
    const float *depths = read_image(&s, slot, MASU_READBACK_DEPTH);
    const uint32_t *normals = read_image(&s, slot, MASU_READBACK_NORMAL);
    double f[3], length = 0, flat, right[3], up[3], n[3];
    float unpacked[3];
    if (!(depths[i] > 0)) return 0;
    for (int k = 0; k < 3; k++) length += (double)c->forward[k] * (double)c->forward[k];
    for (int k = 0; k < 3; k++) f[k] = (double)c->forward[k] / sqrt(length);
    flat = hypot(f[0], f[2]);
    right[0] = -f[2] / flat, right[1] = 0, right[2] = f[0] / flat;
    for (int k = 0; k < 3; k++)
        up[k] = right[(k + 1) % 3] * f[(k + 2) % 3] - right[(k + 2) % 3] * f[(k + 1) % 3];
    double ty = tan((double)c->fov_y / 2), tx = ty * W / H;
    double x = ((i % W + 0.5) / W * 2 - 1) * tx, y = ((i / W + 0.5) / H * 2 - 1) * ty;
    out->z = near / (double)depths[i];
    masu_unpack_normal(normals[i], unpacked);
    length = 0;
    for (int k = 0; k < 3; k++) n[k] = (double)unpacked[k], length += n[k] * n[k];
    for (int k = 0; k < 3; k++) {
        out->at[k] = c->position[k] + (f[k] + right[k] * x - up[k] * y) * out->z;
        out->normal[k] = n[k] / sqrt(length);
    }
    return 1;
}

typedef struct errors {
    /* rays: RMS difference of the ray-traced reference; none: error of a constant 1 */
    double rmse, mean, worst, rays, none;
    uint32_t count;
} errors;

static errors compare(const char *name, double (*at)(const double *, const double *),
                      double radius) {
    errors e = {0};
    masu_camera camera;
    masu_ao_world world;
    masu_scene scene;
    masu_detail detail;
    uint8_t *blob = NULL;
    size_t bytes = 0;
    char error[ERROR_SIZE];
    assert_int_equal(masu_camera_at(s.m, 0, &camera, NULL), MASU_OK);
    assert_ok(masu_file_read(baked_scene(name), 1u << 30, &blob, &bytes, error, sizeof error));
    assert_int_equal(masu_scene_bind(blob, bytes, &scene, &detail), MASU_OK);
    assert_ok(masu_ao_open(&scene, &world, error, sizeof error));
    const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
    for (uint32_t i = 0; i < W * H; i += trials(3, 7, 7)) {
        surface p;
        if (!surface_at(&camera, 0.05, i, &p)) continue;
        double truth = true_seen(at, p.at, p.normal, radius), d = ambient_share(seen, i) - truth;
        /* SwiftShader's depths put points of a large floor more than a millimetre below it. */
        double rays = masu_ao_seen(&world, p.at, p.normal, 5e-3, radius, 256, i);
        e.rmse += d * d;
        e.mean += d;
        e.worst = worst_of(e.worst, fabs(d));
        e.rays += (rays - truth) * (rays - truth);
        e.none += (1 - truth) * (1 - truth);
        e.count++;
    }
    masu_ao_close(&world);
    free(blob);
    assert_true(e.count > 1000);
    e.rmse = sqrt(e.rmse / e.count);
    e.rays = sqrt(e.rays / e.count);
    e.none = sqrt(e.none / e.count);
    e.mean /= e.count;
    print_message(
        "%s: rmse %.4f, mean %+.4f, worst %.3f of %u; without %.4f; rays against formula %.4f\n",
        name, e.rmse, e.mean, e.worst, e.count, e.none, e.rays);
    return e;
}

static void the_error_against_the_truth_is_as_stated(void **state) {
    (void)state;
    static const struct {
        const char *name, *members;
        double (*at)(const double *, const double *);
        double radius, rmse, mean, worst;
    } stated[] = {{"corner", corner, corner_at, 1.0, 0.045, 0.02, 0.45},
                  {"ball", ball, ball_at, 0.6, 0.05, 0.02, 0.45}};
    for (size_t i = 0; i < sizeof stated / sizeof *stated; i++) {
        bake_ao(stated[i].name, stated[i].radius, stated[i].members);
        open_ao(stated[i].name, W, H, NULL);
        draw_from(NULL);
        errors e = compare(stated[i].name, stated[i].at, stated[i].radius);
        close_session(&s);
        assert_true(2 * e.rmse < e.none); /* than without ambient occlusion */
        assert_true(e.rays < 0.02);
        assert_true(e.rmse <= stated[i].rmse && fabs(e.mean) <= stated[i].mean &&
                    e.worst <= stated[i].worst);
    }
}

/* More samples have a lower error. */
static void more_samples_are_nearer_to_the_truth(void **state) {
    (void)state;
    double before = 1;
    static const uint32_t samples[3][2] = {{1, 2}, {2, 4}, {8, 16}};
    bake_ao("corner", 1, corner);
    for (int i = 0; i < 3; i++) {
        masu_rung rung = {.scale = 1, .ao_slices = samples[i][0], .ao_steps = samples[i][1]};
        open_ao("corner", W, H, &rung);
        draw_from(NULL);
        double rmse = compare("corner", corner_at, 1).rmse;
        close_session(&s);
        assert_true(rmse < before);
        before = rmse;
    }
}

/* ---- Properties at any error ----------------------------------------------------------------- */

static void a_plane_hides_nothing_of_itself(void **state) {
    (void)state;
    static const double radii[] = {0.05, 1, 1000};
    /* On SwiftShader and GPUs, depths of a floor that the near plane clips have errors of up to
     * millimetres. */
    const char *driver = getenv("MASU_TEST_DRIVER");
    int third = driver && strstr(driver, "swiftshader");
    for (int i = 0; i < 3; i++) {
        bake_ao("floor", radii[i], floor_alone);
        open_ao("floor", 250, 192, NULL);
        draw_from(NULL);
        bool coarse = third || on_gpu(&s);
        const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
        const float *depths = read_image(&s, slot, MASU_READBACK_DEPTH);
        uint32_t sky = 0, surface = 0, low = 0;
        double least = 1, sum = 0;
        for (uint32_t k = 0; k < 250 * 192; k++) {
            /* no shadow map, no SDF: the sun is fully visible */
            assert_int_equal(seen[k] & 0xFFFF, 0xFFFF);
            if (!(depths[k] > 0)) {
                assert_int_equal(seen[k] >> 16, 0xFFFF);
                sky++;
                continue;
            }
            surface++;
            least = fmin(least, ambient_share(seen, k));
            sum += ambient_share(seen, k);
            low += ambient_share(seen, k) < 0.985;
        }
        close_session(&s);
        print_message("radius %g: visibility on a plane %.4f at least, %.4f in the mean, %u of %u "
                      "below 0.985\n",
                      radii[i], least, sum / surface, low, surface);
        assert_true(sky > 1000 && surface > 1000);
        assert_true(least > (coarse ? 0.85 : 0.985));
        assert_true(sum / surface > (coarse ? 0.98 : 0.99));
    }
}

/* Occlusion of the wall near the plate's edge is only on the wall: the plate is unoccluded. */
static void what_lies_behind_darkens_nothing_before_it(void **state) {
    (void)state;
    bake_ao("plate", 1, plate);
    open_ao("plate", 250, 192, NULL);
    draw_from(NULL);
    const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
    const float *depths = read_image(&s, slot, MASU_READBACK_DEPTH);
    uint32_t before = 0, dark = 0;
    double least = 1;
    for (uint32_t k = 0; k < 250 * 192; k++) {
        double z = 0.05 / (double)depths[k], share = ambient_share(seen, k);
        if (fabs(z - 3.7) < 0.01) least = fmin(least, share), before++;
        if (fabs(z - 4.0) < 0.01) dark += share < 0.8;
    }
    close_session(&s);
    print_message("%u pixels of the plate, visibility %.4f at least; %u dark ones of the wall\n",
                  before, least, dark);
    assert_true(before > 1000 && dark > 200);
    assert_true(least > 0.97);
}

static void a_camera_at_rest_sees_a_picture_at_rest(void **state) {
    (void)state;
    static uint32_t before[W * H];
    masu_frame_desc frame = {0};
    masu_commands commands;
    bake_ao("ball", 0.6, ball);
    open_ao("ball", W, H, NULL);
    for (int i = 0; i < 5; i++) {
        frame.time = i * 0.37;
        draw(&s, &frame, &commands, NULL);
        slot = commands.slot;
        const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
        if (i) assert_memory_equal(seen, before, sizeof before);
        memcpy(before, seen, sizeof before);
    }
    close_session(&s);
}

/* Moves by an eighth of a pixel at the ball, sixteen times. The pattern of directions is fixed on
 * the screen, the surfaces move under it. */
static void a_camera_that_creeps_changes_it_little(void **state) {
    (void)state;
    static double before[W * H];
    masu_camera camera;
    double squares = 0, most = 0;
    uint32_t count = 0, jumps = 0;
    bake_ao("ball", 0.6, ball);
    open_ao("ball", W, H, NULL);
    assert_int_equal(masu_camera_at(s.m, 0, &camera, NULL), MASU_OK);
    double x = camera.position[0];
    for (int i = 0; i < 17; i++) {
        camera.position[0] = x + i / 8.0 * 2.6 * 2 * tan((double)camera.fov_y / 2) / H;
        draw_from(&camera);
        const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
        const uint32_t *normals = read_image(&s, slot, MASU_READBACK_NORMAL);
        for (uint32_t k = 0; k < W * H; k++) {
            float n[3];
            masu_unpack_normal(normals[k], n);
            double now = ambient_share(seen, k), d = fabs(now - before[k]);
            /* The ball's outline moves over the pixels: jumps are allowed there. */
            if (i && n[1] > 0.999f)
                squares += d * d, most = worst_of(most, d), jumps += d > 0.1, count++;
            before[k] = now;
        }
    }
    close_session(&s);
    print_message("an eighth of a pixel changes the floor's by %.5f (rms), %.3f (most), %u of %u "
                  "by over 0.1\n",
                  sqrt(squares / count), most, jumps, count);
    assert_true(count > 10000);
    assert_true(sqrt(squares / count) < 0.01);
    assert_true(jumps * 1000 <= count);
}

/* Two sizes in the same images, with and without NaN in everything that this frame has not
 * written. */
static void nothing_outside_of_the_rectangle_is_looked_at(void **state) {
    (void)state;
    static uint32_t kept[2][W * H];
    bake_ao("corner", 1, corner);
    for (uint32_t poison = 0; poison < 4; poison++) {
        masu_session_desc d = test_desc(NULL, W, H);
        d.scene_path = baked_scene("corner");
        d.desc.readback = MASU_READBACK_OCCLUSION;
        d.desc.debug.poison = poison;
        d.desc.rung_count = 2;
        d.desc.rungs[0].scale = 1;
        d.desc.rungs[1].scale = 0.39f; /* odd sizes */
        open_session(&s, &d);
        for (uint32_t r = 0; r < 2; r++) {
            masu_readback_image out;
            masu_frame_desc frame = {.rung = r};
            masu_commands commands;
            draw(&s, &frame, &commands, NULL);
            assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_OCCLUSION, &out, NULL),
                             MASU_OK);
            assert_int_equal(out.width, r ? 62 : W);
            for (uint32_t y = 0; y < out.height; y++) {
                const uint32_t *line =
                    (const void *)((const uint8_t *)out.pixels + y * out.row_bytes);
                if (poison) assert_memory_equal(line, kept[r] + y * W, out.width * 4);
                memcpy(kept[r] + y * W, line, out.width * 4);
            }
        }
        close_session(&s);
    }
}

static const char sdf_members[] =
    "\"camera\": {\"fov_y\": 50, \"near\": 0.05, \"keys\": [{\"position\": [0, 2, 4], "
    "\"target\": [0, 0.4, 0]}]}, \"sdf\": {\"source\": \"ao.sdf\", \"bounds\": [[-20, -1, -20], "
    "[20, 6, 20]], \"max_distance\": 60%s}";

/* The smaller of both, at each pixel. */
static void of_both_occlusions_the_lesser_counts(void **state) {
    (void)state;
    static uint32_t own[W * H], screen[W * H];
    char text[512];
    write_text("ao.sdf",
               "part ground = plane((0, 1, 0), 0);\npart a = translate((0, 0.6, 0), sphere(0.6));\n"
               "part b = translate((0.9, 0.3, 0.3), box((0.3, 0.3, 0.3)));\n");
    for (int i = 0; i < 3; i++) { /* the SDF's own, screen space, both */
        snprintf(text, sizeof text, sdf_members, i == 1 ? "" : ", \"ambient_occlusion\": {}");
        bake_ao("field", i ? 1 : 0, text);
        open_ao("field", W, H, NULL);
        draw_from(NULL);
        const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
        uint32_t less = 0;
        for (uint32_t k = 0; k < W * H && i == 2; k++) {
            uint32_t a = own[k] >> 16, b = screen[k] >> 16;
            assert_int_equal(seen[k] >> 16, a < b ? a : b);
            less += a < b;
        }
        if (i == 2) assert_in_range(less, 100, W * H - 100); /* neither is always the smaller one */
        if (i < 2) memcpy(i ? screen : own, seen, sizeof own);
        close_session(&s);
    }
}

static void scenes_that_do_not_ask_have_none_of_it(void **state) {
    (void)state;
    static masu_plan_info plan;
    static uint8_t lit[3][4 * W * H];
    uint64_t device[3], host[3], texels[3] = {0};
    masu_readback_image out;
    for (int i = 0; i < 3; i++) { /* not requested; requested but off in the rung; on */
        masu_session_desc d = test_desc(NULL, W, H);
        bake_ao("corner", i ? 1 : 0, corner);
        d.scene_path = baked_scene("corner");
        d.desc.rung_count = 1;
        d.desc.rungs[0].ao = i == 1 ? MASU_OFF : MASU_AUTO;
        d.desc.readback = MASU_READBACK_OCCLUSION;
        open_session(&s, &d);
        draw_rung(&s, 0, lit[i]);
        masu_plan_of(s.m, &plan);
        assert_int_equal(pass_of(&plan, "ao")->active, i == 2);
        assert_int_equal(pass_of(&plan, "ao_upsample")->active, i == 2);
        assert_int_equal(pass_of(&plan, "light")->active, i < 2);
        assert_int_equal(pass_of(&plan, "light_occluded")->active, i == 2);
        assert_int_equal(masu_readback(s.m, 0, MASU_READBACK_OCCLUSION, &out, NULL),
                         i == 2 ? MASU_OK : MASU_ERROR_ARGUMENT);
        for (uint32_t k = 0; k < plan.image_count; k++) {
            if (!strcmp(plan.images[k].name, "ao") || !strcmp(plan.images[k].name, "occlusion"))
                texels[i] += (uint64_t)plan.images[k].width * plan.images[k].height;
        }
        device[i] = s.need.device_bytes;
        host[i] = s.need.host_bytes;
        close_session(&s);
    }
    assert_int_equal(texels[0], 0);
    assert_int_equal(texels[1], 0);
    assert_int_equal(texels[2], W * H + W / 2 * (H / 2));
    assert_int_equal(device[0], device[1]);
    assert_int_equal(host[0], host[1]);
    assert_true(device[2] > device[0]);
    assert_memory_equal(lit[0], lit[1], sizeof lit[0]);
    uint64_t with = 0, without = 0; /* it only darkens */
    for (size_t k = 0; k < sizeof lit[0]; k++) {
        assert_true(lit[2][k] <= lit[0][k] + 1);
        with += lit[2][k];
        without += lit[0][k];
    }
    assert_true(with < without);
}

static void extremes_give_finite_pixels(void **state) {
    (void)state;
    static const VkExtent2D sizes[] = {{1, 1}, {2, 1}, {1, 3}, {5, 7}, {66, 48}};
    static const double radii[] = {1e-3, 1, 1e6};
    static const char *const cameras[] = {
        "{\"fov_y\": 50, \"near\": 0.05, \"keys\": [{\"position\": [3, 2, 4], \"target\": [0, 0.4, "
        "0]}]}",
        "{\"fov_y\": 170, \"near\": 1e-6, \"keys\": [{\"position\": [0.01, 0.001, 0.5], "
        "\"target\": [0, 0, 0]}]}",
        "{\"fov_y\": 0.1, \"near\": 1e6, \"keys\": [{\"position\": [3e6, 2e6, 4e6], \"target\": "
        "[0, 0.4, 0]}]}"};
    masu_rung rung = {.scale = 1, .ao_slices = 8, .ao_steps = 16};
    for (int i = 0; i < 9; i++) {
        char text[1024];
        double scale = i % 3 == 2 ? 1e6 : 1;
        snprintf(text, sizeof text,
                 "\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 60, \"size_z\": 60}}, "
                 "\"scale\": %g}, "
                 "{\"mesh\": {\"sphere\": {}}, \"scale\": %g}], \"camera\": %s",
                 scale, scale, cameras[i % 3]);
        bake_ao("extreme", radii[i / 3], text);
        for (int k = 0; k < 5; k++) {
            uint32_t pixels = sizes[k].width * sizes[k].height;
            open_ao("extreme", sizes[k].width, sizes[k].height, k % 2 ? &rung : NULL);
            draw_from(NULL);
            const uint16_t *hdr = read_image(&s, slot, MASU_READBACK_HDR);
            for (uint32_t c = 0; c < 4 * pixels; c++) assert_true((hdr[c] & 0x7C00) != 0x7C00);
            assert_int_equal(stats_of(&s, 0).replaced, 0);
            const uint32_t *seen = read_image(&s, slot, MASU_READBACK_OCCLUSION);
            for (uint32_t p = 0; p < pixels; p++) assert_true(sun_share(seen, p) > 0.999);
            close_session(&s);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_error_against_the_truth_is_as_stated),
        cmocka_unit_test(more_samples_are_nearer_to_the_truth),
        cmocka_unit_test(a_plane_hides_nothing_of_itself),
        cmocka_unit_test(what_lies_behind_darkens_nothing_before_it),
        cmocka_unit_test(a_camera_at_rest_sees_a_picture_at_rest),
        cmocka_unit_test(a_camera_that_creeps_changes_it_little),
        cmocka_unit_test(nothing_outside_of_the_rectangle_is_looked_at),
        cmocka_unit_test(of_both_occlusions_the_lesser_counts),
        cmocka_unit_test(scenes_that_do_not_ask_have_none_of_it),
        cmocka_unit_test(extremes_give_finite_pixels),
    };
    return cmocka_run_group_tests_name("ao", tests, make_scratch, remove_scratch);
}

/* test_occluders.c: occlusion culling never removes visible objects. Every object has a different
 * colour, so albedo and depth at full resolution are an ID buffer; it is bit-identical with and
 * without culling. Scenes are random (boxes rotated, stretched, sheared, mirrored and flat; cameras
 * in, at and between them; near planes that cut them open), or have gaps narrower than a texel of
 * the atlas. */
#include "scene/scene.h"
#include "support/files.h"
#include "support/random.h"
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WALLS = 24, THINGS = 40, PIXELS_MOST = 768 * 256 };
enum { ON, OFF };

static uint8_t albedo[2][PIXELS_MOST * 4], depth[2][PIXELS_MOST * 4];
static uint64_t seed;

static void open_scene(masu_session *s, uint32_t width, uint32_t height) {
    masu_session_desc d = test_desc("test_occluders", width, height);
    d.desc.rung_count = 2;
    d.desc.rungs[OFF].occlusion = MASU_OFF;
    d.desc.readback = MASU_READBACK_ALBEDO | MASU_READBACK_DEPTH;
    open_session(s, &d);
    assert_int_equal(masu_scene_data_of(&s->scene)->placed_occluders,
                     WALLS + 1); /* and of hollow0 */
}

static void place(masu_session *s, const char *kind, uint32_t i, const float rows[12]) {
    char name[16];
    (void)snprintf(name, sizeof name, "%s%u", kind, i);
    place_instance(s, name, rows);
}

static void place_box(masu_session *s, const char *kind, uint32_t i, double x, double y, double z,
                      double w, double h, double d) {
    const float rows[12] = {(float)w, 0, 0, (float)x, 0, (float)h, 0, (float)y, 0, 0, (float)d,
                            (float)z};
    place(s, kind, i, rows);
}

/* Renders both ways and compares every pixel. Returns the statistics with occlusion culling. */
static masu_stats_info compare(masu_session *s, const masu_camera *c, int cut, const char *what,
                               uint64_t number) {
    masu_stats_info stats[2];
    size_t bytes = (size_t)s->desc.output.width * s->desc.output.height * 4;
    for (uint32_t way = ON; way <= OFF; way++) {
        masu_frame_desc f = {.camera = c, .rung = way, .cut = (uint32_t)cut};
        masu_commands commands;
        draw(s, &f, &commands, NULL);
        stats[way] = stats_of(s, commands.slot);
        memcpy(albedo[way], read_image(s, commands.slot, MASU_READBACK_ALBEDO), bytes);
        memcpy(depth[way], read_image(s, commands.slot, MASU_READBACK_DEPTH), bytes);
    }
    for (size_t i = 0; i < bytes; i += 4) {
        /* Albedo is undefined where no surface is. */
        uint32_t here;
        memcpy(&here, depth[OFF] + i, 4);
        if (memcmp(depth[ON] + i, depth[OFF] + i, 4) ||
            (here && memcmp(albedo[ON] + i, albedo[OFF] + i, 4))) {
            fail_msg("%s %llu: pixel %zu differs", what, (unsigned long long)number, i / 4);
        }
    }
    return stats[ON];
}

/* ---- Random scenes --------------------------------------------------------------------------- */

/* Orthonormal vectors, by rotation about the three axes. */
static void turn(double out[3][3]) {
    double a[3] = {random_between(&seed, 0, 6.3), random_between(&seed, 0, 6.3),
                   random_between(&seed, 0, 6.3)};
    if (random_between(&seed, 0, 1) < 0.3) a[0] = a[1] = a[2] = 0;
    memset(out, 0, 9 * sizeof out[0][0]);
    for (int i = 0; i < 3; i++) out[i][i] = 1;
    for (int axis = 0; axis < 3; axis++) {
        int p = (axis + 1) % 3, q = (axis + 2) % 3;
        for (int i = 0; i < 3; i++) {
            double u = out[i][p], v = out[i][q];
            out[i][p] = cos(a[axis]) * u - sin(a[axis]) * v;
            out[i][q] = sin(a[axis]) * u + cos(a[axis]) * v;
        }
    }
}

static void place_random(masu_session *s, const char *kind, uint32_t i, double space, double size,
                         const double around[3]) {
    double axes[3][3], scale[3];
    float rows[12];
    turn(axes);
    for (int k = 0; k < 3; k++) {
        scale[k] = exp(random_between(&seed, log(size * 0.1), log(size)));
        if (random_between(&seed, 0, 1) < 0.1) scale[k] = -scale[k];
        if (random_between(&seed, 0, 1) < 0.02) scale[k] = 0;
    }
    for (int r = 0; r < 3; r++) {
        for (int k = 0; k < 3; k++) {
            rows[4 * r + k] = (float)(axes[k][r] * scale[k]);
            if (i % 5 == 0 && k) rows[4 * r + k] += 0.5f * rows[4 * r]; /* sheared */
        }
        rows[4 * r + 3] = (float)(around[r] + random_between(&seed, -space, space));
    }
    place(s, kind, i, rows);
}

static uint32_t colours_seen(size_t pixels) {
    static uint32_t seen[256];
    uint32_t n = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t c, z, k = 0;
        memcpy(&z, depth[OFF] + 4 * i, 4);
        memcpy(&c, albedo[OFF] + 4 * i, 4);
        if (!z) continue;
        while (k < n && seen[k] != c) k++;
        if (k == n && n < 256) seen[n++] = c;
    }
    return n;
}

static void random_scenes(uint32_t width, uint32_t height, uint64_t trials) {
    masu_session s;
    uint64_t kept = 0, left = 0, visible = 0;
    open_scene(&s, width, height);
    for (uint64_t t = 0; t < trials; t++) {
        seed = t * 977 + width;
        double far = random_between(&seed, 0, 1) < 0.2 ? 1e5 : 0, center[3] = {far, 0, -far};
        double space = exp(random_between(&seed, log(3), log(60)));
        for (uint32_t i = 0; i < WALLS; i++) place_random(&s, "wall", i, space, space, center);
        for (uint32_t i = 0; i < THINGS; i++)
            place_random(&s, "thing", i, space, space * 0.2, center);
        for (uint32_t view = 0; view < 3; view++) {
            masu_camera c = {
                .fov_y = (float)random_between(&seed, 0.2, view ? 1.5 : 2.8),
                .near_distance =
                    (float)(view == 1 ? random_between(&seed, 0.1, space * 0.3) : 0.05)};
            for (int k = 0; k < 3; k++) {
                c.position[k] =
                    center[k] + random_between(&seed, -1.5, 1.5) * space * (view ? 1.0 : 0.3);
                c.forward[k] = (float)(center[k] - c.position[k] +
                                       random_between(&seed, -0.5, 0.5) * space);
            }
            /* A cut, then frames with visibility from the previous frame. */
            for (int frame = 0; frame < 2; frame++) {
                masu_stats_info stats = compare(&s, &c, frame == 0 && view == 0, "scene", t);
                if (!frame) continue;
                kept += stats.views[0].instances;
                left += stats.views[0].visible_instances;
                visible += colours_seen((size_t)width * height);
            }
        }
    }
    print_message("%ux%u: in view %llu, not occluded %llu, visible %llu\n", width, height,
                  (unsigned long long)kept, (unsigned long long)left, (unsigned long long)visible);
    assert_true(left < kept * 9 / 10);
    assert_true(left >= visible);
    close_session(&s);
}

static void nothing_that_is_seen_is_left_out_at_more_than_a_pixel_per_texel(void **state) {
    (void)state;
    if (whole_run()) random_scenes(384, 256, trials(60, 15, 15));
    else random_scenes(256, 170, 8); /* still 192 texels */
}

static void nothing_that_is_seen_is_left_out_at_less_than_a_pixel_per_texel(void **state) {
    (void)state;
    random_scenes(96, 50, trials(200, 50, 10));
}

/* ---- Gaps ------------------------------------------------------------------------------------ */

enum { GAP_W = 768, GAP_H = 32 };

/* Two walls at 10 m with a gap of a fraction of a texel between them, and behind it an object as
 * wide as both. */
static void gaps_narrower_than_a_texel_are_looked_through(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, GAP_W, GAP_H);
    for (uint32_t i = 0; i < WALLS; i++) place_box(&s, "wall", i, 0, 0, 1e4, 1, 1, 1);
    for (uint32_t i = 0; i < THINGS; i++) place_box(&s, "thing", i, 0, 0, 1e4, 1, 1, 1);
    /* 768x32 of 90 degrees in width: at 10 m, a texel of 192 is 20/192 m wide. */
    float fov = 2.0f * atanf((float)GAP_H / GAP_W);
    masu_camera c = {.forward = {0, 0, -1}, .fov_y = fov, .near_distance = 0.1f};
    const uint32_t gaps = trials(240, 80, 24);
    uint32_t through = 0, hidden = 0;
    for (uint32_t n = 0; n < gaps; n++) {
        seed = n;
        double gap = n % 8 == 0 ? -0.01 : random_between(&seed, 0.0, 1.0) * 20.0 / 192.0;
        double at = random_between(&seed, -6.0, 6.0),
               depth_of = n % 2 ? 0.0 : random_between(&seed, 0.0, 3.0);
        double height = 30.0, width = 6.0;
        int lying = n % 3 == 2; /* one above the other */
        double low = at - gap / 2 - width / 2, high = at + gap / 2 + width / 2;
        if (lying) {
            double y = random_between(&seed, -0.3, 0.3), g = gap / 3;
            place_box(&s, "wall", 0, 0, y - g / 2 - 2, -10.0, 40, 4, 0.02);
            place_box(&s, "wall", 1, 0, y + g / 2 + 2, -10.0, 40, 4, 0.02);
        } else {
            place_box(&s, "wall", 0, low, 0, -10.0, width, height, 0.02);
            place_box(&s, "wall", 1, high, 0, -10.0 - depth_of, width, height, 0.02);
        }
        place_box(&s, "thing", 1, lying ? 0 : at * 1.5, 0, -15.5, lying ? 12 : 2, lying ? 0.2 : 1,
                  1);
        masu_stats_info stats = compare(&s, &c, n % 5 == 0, "gap", n);
        int seen = colours_seen((size_t)GAP_W * GAP_H) > 2;
        through += (uint32_t)seen;
        hidden += stats.views[0].visible_instances < 3;
        if (seen) assert_int_equal(stats.views[0].visible_instances, 3);
    }
    print_message("%u of %u visible through a gap, %u occluded\n", through, gaps, hidden);
    assert_true(through > gaps / 4);
    close_session(&s);
}

/* An occluder smaller than its mesh is valid only for the whole mesh. If the near plane has cut the
 * mesh open, or the camera is inside, objects behind the occluder can be visible. */
static void a_mesh_that_is_cut_open_hides_nothing(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, 96, 64);
    for (uint32_t i = 0; i < WALLS; i++) place_box(&s, "wall", i, 0, -1e4, 0, 1, 1, 1);
    for (uint32_t i = 0; i < THINGS; i++) place_box(&s, "thing", i, 0, -1e4, 0, 1, 1, 1);
    place_box(&s, "hollow", 0, 0, 0, 0, 10, 10, 10);
    place_box(&s, "thing", 1, 0, 0, -4, 1, 1, 1);
    uint32_t seen = 0, gone = 0, eyes = 0;
    for (uint32_t n = 0; n < 40; n += whole_run() ? 1 : 3) { /* near planes of both alternately */
        eyes++;
        masu_camera c = {.position = {0.1 * (n % 5), 0.1, 3.2 + 0.1 * n},
                         .forward = {0, 0, -1},
                         .fov_y = 1.0f,
                         .near_distance = n % 2 ? 0.5f : 0.05f};
        masu_stats_info stats = compare(&s, &c, 1, "eye", n);
        seen += colours_seen(96 * 64) > 1;
        gone += stats.views[0].visible_instances == 1;
    }
    assert_true(seen * 20 > 9 * eyes); /* from inside */
    assert_true(gone * 8 > eyes);      /* from outside */
    close_session(&s);
}

/* A wall along the street: across a texel its depth goes from near to far. An object just before
 * its far part is closer than the wall's depth at the texel's centre. */
static void what_stands_before_a_slanted_wall_is_drawn(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, GAP_W, GAP_H);
    for (uint32_t i = 0; i < WALLS; i++) place_box(&s, "wall", i, 0, 0, 1e4, 1, 1, 1);
    for (uint32_t i = 0; i < THINGS; i++) place_box(&s, "thing", i, 0, 0, 1e4, 1, 1, 1);
    masu_camera c = {.forward = {0, 0, -1},
                     .fov_y = 2.0f * atanf((float)GAP_H / GAP_W),
                     .near_distance = 0.1f};
    /* From (2, 0, -6) to (30, 0, -60): 6 to 60 m in 16 texels. */
    const double a[2] = {2, -6}, b[2] = {30, -60}, half[2] = {(b[0] - a[0]) / 2, (b[1] - a[1]) / 2};
    const float wall[12] = {(float)(2 * half[0]), 0, 0.01f, (float)(a[0] + half[0]), 0, 60, 0, 0,
                            (float)(2 * half[1]), 0, 0.01f, (float)(a[1] + half[1])};
    const uint32_t places = trials(150, 60, 20);
    uint32_t seen = 0;
    place(&s, "wall", 3, wall);
    for (uint32_t n = 0; n < places; n++) {
        seed = n;
        double u = random_between(&seed, 0.1, 0.95);
        double x = a[0] + u * (b[0] - a[0]), z = a[1] + u * (b[1] - a[1]);
        /* 1 to 6 % closer than the wall, a third of a texel wide. */
        double nearer = random_between(&seed, 0.94, 0.99), size = -z * 0.0035;
        place_box(&s, "thing", 1, x * nearer, 0, z * nearer, size, 4 * size, size * 0.1);
        (void)compare(&s, &c, n % 5 == 0, "thing", n);
        seen += colours_seen((size_t)GAP_W * GAP_H) > 1;
    }
    print_message("%u of %u visible before the wall\n", seen, places);
    assert_true(seen > places * 2 / 3);
    close_session(&s);
}

/* The reverse: an object well behind a wall is culled, from every side and at any rotation of the
 * wall, from the first frame in which it is occluded to the last. */
static void what_a_wall_hides_is_not_drawn(void **state) {
    (void)state;
    masu_session s;
    uint32_t hidden = 0;
    const uint32_t turns = trials(64, 64, 24); /* 24 are a full circle */
    open_scene(&s, 96, 64);
    for (uint32_t i = 0; i < WALLS; i++) place_box(&s, "wall", i, 0, -1e4, 0, 1, 1, 1);
    for (uint32_t i = 0; i < THINGS; i++) place_box(&s, "thing", i, 0, -1e4, 0, 1, 1, 1);
    for (uint32_t n = 0; n < turns; n++) {
        double a = n * 0.3, ca = cos(a), sa = sin(a), b = n * 0.17;
        const float wall[12] = {(float)(8 * cos(b)), 0, (float)(2 * sin(b)), (float)(10 * ca),
                                0, 4, 0, 0,
                                (float)(-8 * sin(b)), 0, (float)(2 * cos(b)), (float)(10 * sa)};
        place(&s, "wall", 3, wall);
        /* Small, behind the wall's centre; every fourth time high above it. */
        place_box(&s, "thing", 7, 30 * ca, n % 4 == 3 ? 14 : 0.3, 30 * sa, 0.5, 0.5, 0.5);
        masu_camera c = {.forward = {(float)ca, 0, (float)sa}, .fov_y = 1.2f};
        masu_stats_info stats = compare(&s, &c, 0, "wall", n);
        int gone = stats.views[0].visible_instances == 1;
        assert_int_equal(stats.views[0].instances, 2);
        if (n % 4 == 3) assert_false(gone);
        /* A visible object is tested again within five frames with culling. */
        for (int again = 0; again < 4 && n % 4 != 3 && !gone; again++) {
            gone = compare(&s, &c, 0, "wall", n).views[0].visible_instances == 1;
        }
        hidden += (uint32_t)gone;
    }
    assert_int_equal(hidden, turns * 3 / 4);
    close_session(&s);
}

/* The rasterizer's depth of an object is exact to 2^-13: one that lies deeper in a wall by less may
 * show through it, and is drawn; one that lies deeper by four times as much is not. */
static void what_lies_in_a_wall_by_less_than_the_rounding_is_drawn(void **state) {
    (void)state;
    masu_session s;
    open_scene(&s, 96, 64);
    for (uint32_t i = 0; i < WALLS; i++) place_box(&s, "wall", i, 0, -1e4, 0, 1, 1, 1);
    for (uint32_t i = 0; i < THINGS; i++) place_box(&s, "thing", i, 0, -1e4, 0, 1, 1, 1);
    masu_camera c = {.forward = {0, 0, -1}, .fov_y = 1.2f};
    for (uint32_t n = 0; n < 8; n++) {
        const double z = 4 + 3 * n, thick = 0.1 * z;
        place_box(&s, "wall", 3, 0, 0, -z - thick / 2, z, z, thick);
        for (int deep = 0; deep < 2; deep++) {
            double front = z * (1 + (deep ? 4 : 0.8) / 8192.0), size = 0.02 * z;
            place_box(&s, "thing", 7, size * n, 0, -front - size / 2, size, size, size);
            masu_view_stats view = compare(&s, &c, 1, "deep", n).views[0];
            assert_int_equal(view.instances, 2);
            assert_int_equal(view.visible_instances, deep ? 1 : 2);
        }
    }
    close_session(&s);
}

static void scenes_without_occluders_have_none_of_it(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_velocity_mesh", 32, 32);
    masu_session s;
    masu_plan_info plan;
    open_session(&s, &d);
    masu_plan_of(s.m, &plan);
    for (uint32_t p = 0; p < plan.pass_count; p++) {
        const char *name = plan.passes[p].name;
        if (!strcmp(name, "occluders") || !strcmp(name, "cull") || !strcmp(name, "compact"))
            assert_int_equal(plan.passes[p].active, 0);
    }
    for (uint32_t i = 0; i < plan.image_count; i++) {
        if (!strcmp(plan.images[i].name, "occluders")) assert_int_equal(plan.images[i].used, 0);
    }
    masu_memory_row rows[MEMORY_ROWS];
    uint32_t n = memory_rows(s.m, rows);
    for (uint32_t i = 0; i < n; i++) assert_string_not_equal(rows[i].name, "seen");
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_that_is_seen_is_left_out_at_more_than_a_pixel_per_texel),
        cmocka_unit_test(nothing_that_is_seen_is_left_out_at_less_than_a_pixel_per_texel),
        cmocka_unit_test(gaps_narrower_than_a_texel_are_looked_through),
        cmocka_unit_test(a_mesh_that_is_cut_open_hides_nothing),
        cmocka_unit_test(what_stands_before_a_slanted_wall_is_drawn),
        cmocka_unit_test(what_a_wall_hides_is_not_drawn),
        cmocka_unit_test(what_lies_in_a_wall_by_less_than_the_rounding_is_drawn),
        cmocka_unit_test(scenes_without_occluders_have_none_of_it),
    };
    return cmocka_run_group_tests_name("occlusion", tests, NULL, NULL);
}

/* test_culling.c: what is not drawn cannot be seen: pictures with and without culling are the same
 * in every bit, wherever the camera turns and whatever moves, and less is drawn. */
#include "support.h"

#include <math.h>
#include <string.h>

enum { W = 64, H = 40, BYTES = W * H * 4, FRAMES = 200 };

static uint8_t pixels[2][BYTES];

/* Rung 0 culls, rung 1 does not. */
static masu_session_desc town_desc(void) {
    masu_session_desc d = test_desc("test_town", W, H);
    d.desc.rung_count = 2;
    d.desc.rungs[1].frustum = MASU_OFF;
    return d;
}

/* Fast turns, all around and up and down, through the town's streets; an own field of view in
 * each frame, and now and then a cut. */
static masu_camera path(uint32_t frame) {
    double t = frame;
    masu_camera c = {
        .position = {35.0 * sin(t * 0.05), 1.0 + 12.0 * (frame % 50 > 40), 30.0 * sin(t * 0.031)},
        .forward = {(float)cos(t * 0.37), (float)(0.8 * sin(t * 0.23)), (float)sin(t * 0.37)},
        .fov_y = 0.3f + 2.5f * (float)(frame % 7) / 7.0f};
    if (frame % 60 == 59) { /* beyond the town, looking away */
        c.position[0] += 1000.0;
        c.forward[0] = 2.0f;
    }
    return c;
}

static masu_stats_info draw_frame(masu_session *s, uint32_t frame, uint32_t rung, uint8_t *out) {
    masu_camera c = path(frame);
    masu_frame_desc f = {.camera = &c, .rung = rung, .cut = frame % 60 == 59};
    masu_commands commands;
    masu_stats_info stats;
    draw(s, &f, &commands, out);
    assert_int_equal(masu_stats(s->m, commands.slot, &stats), MASU_OK);
    return stats;
}

static void move(masu_session *s, const char *name, float x, float y, float z, float size) {
    masu_instance i = masu_instance_find(s->m, name);
    const float rows[12] = {size, 0, 0, x, 0, size, 0, y, 0, 0, size, z};
    assert_int_not_equal(i.id, 0);
    assert_int_equal(masu_instance_set_transform(s->m, i, rows), MASU_OK);
}

static void compare_path(masu_session *s, int moving) {
    uint64_t kept = 0, all = 0, seen = 0;
    for (uint32_t frame = 0; frame < FRAMES; frame++) {
        if (moving) {
            float t = (float)frame;
            move(s, "ball2", 30.0f * sinf(t * 0.2f), 1.0f, 30.0f * cosf(t * 0.13f), 1.0f);
            /* These stand in groups, which do not know where they are now. */
            move(s, "late1", 25.0f * cosf(t * 0.3f), 3.0f, 3.0f, 2.0f);
            move(s, "b17/block", 20.0f * sinf(t * 0.11f), 0.0f, 30.0f, frame % 20 < 10 ? 3.0f : 0.0f);
        }
        masu_stats_info culled = draw_frame(s, frame, 0, pixels[0]);
        masu_stats_info whole = draw_frame(s, frame, 1, pixels[1]);
        if (max_difference(pixels[0], pixels[1], BYTES)) fail_msg("frame %u differs", frame);
        assert_int_equal(whole.triangles, s->scene.triangles);
        assert_int_equal(whole.draws, s->scene.draws);
        assert_int_equal(whole.views[0].instances, s->scene.instances);
        assert_int_equal(whole.views[0].plane_tests, 0);
        assert_int_equal(culled.view_count, 1);
        assert_int_equal(culled.views[0].triangles, culled.triangles);
        assert_true(culled.views[0].groups > 0);
        kept += culled.triangles;
        all += whole.triangles;
        for (uint32_t i = 0; i < BYTES; i += 4) seen += memcmp(pixels[0], pixels[0] + i, 4) != 0;
        if (frame % 60 == 59) assert_int_equal(culled.triangles, 0);
    }
    print_message("triangles: %llu of %llu\n", (unsigned long long)kept, (unsigned long long)all);
    assert_true(kept < all / 2);
    assert_true(seen > (uint64_t)FRAMES * W * H / 8); /* there is something to compare */
}

static void the_picture_is_the_same_without_culling(void **state) {
    (void)state;
    masu_session_desc d = town_desc();
    masu_session s;
    open_session(&s, &d);
    assert_true(s.scene.groups > 5);
    compare_path(&s, 0);
    close_session(&s);
}

static void what_moves_is_culled_where_it_is(void **state) {
    (void)state;
    masu_session_desc d = town_desc();
    masu_session s;
    open_session(&s, &d);
    compare_path(&s, 1);
    close_session(&s);
}

/* Velocities read the frame before by the same list of instances. */
static void velocities_are_the_same_without_culling(void **state) {
    (void)state;
    static uint8_t velocity[2][W * H * 8];
    masu_session_desc d = town_desc();
    d.desc.readback = MASU_READBACK_VELOCITY;
    masu_session s[2];
    uint64_t moving = 0;
    for (uint32_t i = 0; i < 2; i++) open_session(&s[i], &d);
    for (uint32_t frame = 0; frame < 20; frame++) {
        for (uint32_t i = 0; i < 2; i++) {
            masu_camera c = path(60);
            masu_frame_desc f = {.camera = &c, .rung = i};
            masu_commands commands;
            masu_readback_image image;
            move(&s[i], "ball3", (float)c.position[0] + 4.0f * c.forward[0],
                 1.0f + 0.1f * (float)frame, (float)c.position[2] + 4.0f * c.forward[2], 1.0f);
            draw(&s[i], &f, &commands, NULL);
            assert_int_equal(
                masu_readback(s[i].m, commands.slot, MASU_READBACK_VELOCITY, &image), MASU_OK);
            for (uint32_t y = 0; y < H; y++) {
                memcpy(velocity[i] + (size_t)y * W * 8,
                       (const uint8_t *)image.pixels + y * image.row_bytes, W * 8);
            }
        }
        assert_memory_equal(velocity[0], velocity[1], sizeof velocity[0]);
        for (uint32_t i = 0; i < W * H; i++) moving += velocity[0][8 * i + 2] != 0;
    }
    assert_true(moving > 100);
    for (uint32_t i = 0; i < 2; i++) close_session(&s[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_is_the_same_without_culling),
        cmocka_unit_test(what_moves_is_culled_where_it_is),
        cmocka_unit_test(velocities_are_the_same_without_culling),
    };
    return cmocka_run_group_tests_name("culling", tests, NULL, NULL);
}

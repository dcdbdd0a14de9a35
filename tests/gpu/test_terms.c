/* test_terms.c: terms that the march skips because they do not affect a block of pixels: the result
 * is bit-identical with and without skipping, in scenes with unions, cuts, blends, repetitions,
 * fractals, moving parts, lists of parts, and a hand-written field. Also the cost of the selection,
 * which the counter of evaluations does not show. */
#include "support/files.h"
#include "support/support.h"

#include <stdlib.h>
#include <string.h>

enum { W = 130, H = 72 };

static masu_session s;

typedef struct picture {
    uint32_t albedo[W * H], normal[W * H];
    float depth[W * H];
    uint8_t shown[4 * W * H]; /* silhouettes use it as well */
    uint64_t evaluations;
} picture;

static void march(const char *scene, int all_terms, masu_switch share, float scale, double time,
                  picture *out) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_ALBEDO | MASU_READBACK_NORMAL | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = scale, .silhouettes = MASU_ON, .specular = MASU_OFF};
    /* A tile here may evaluate all of 300 parts, and for silhouettes an invocation marches three
     * rays: Mesa 22.3 ends loops after 65,535 iterations in all. */
    if (!strcmp(scene, "parts300")) d.desc.rungs[0].march_steps = 48;
    d.desc.debug.all_terms = (uint32_t)all_terms;
    d.desc.debug.share_rays = share;
    d.desc.debug.counters = 1;
    open_session(&s, &d);
    masu_frame_desc frame = {.time = time};
    masu_commands commands;
    memset(out, 0, sizeof *out);
    draw(&s, &frame, &commands, out->shown);
    uint32_t w = (uint32_t)(W * scale), h = (uint32_t)(H * scale);
    memcpy(out->albedo, read_image(&s, commands.slot, MASU_READBACK_ALBEDO),
           sizeof(uint32_t) * w * h);
    memcpy(out->normal, read_image(&s, commands.slot, MASU_READBACK_NORMAL),
           sizeof(uint32_t) * w * h);
    memcpy(out->depth, read_image(&s, commands.slot, MASU_READBACK_DEPTH), sizeof(float) * w * h);
    out->evaluations = stats_of(&s, commands.slot).sdf_evals;
    close_session(&s);
}

static void same(const char *scene, float scale, double time) {
    picture *all = malloc(sizeof *all), *chosen = malloc(sizeof *chosen),
            *shared = malloc(sizeof *shared);
    assert_true(all && chosen && shared);
    march(scene, 1, MASU_OFF, scale, time, all);
    march(scene, 0, MASU_OFF, scale, time, chosen);
    march(scene, 0, MASU_ON, scale, time, shared);
    uint32_t hits = 0;
    for (uint32_t i = 0; i < W * H; i++) hits += all->depth[i] > 0;
    print_message("%s at %g, second %g: %u pixels hit, %llu evaluations, %llu for the selection\n",
                  scene, (double)scale, time, hits, (unsigned long long)all->evaluations,
                  (unsigned long long)(chosen->evaluations - all->evaluations));
    assert_true(hits > (uint32_t)(W * H * scale * scale / 4));
    assert_memory_equal(all->depth, chosen->depth, sizeof all->depth);
    for (uint32_t i = 0; i < W * H; i++) { /* pixels without a surface are not written */
        if (!(all->depth[i] > 0)) continue;
        assert_int_equal(all->normal[i], chosen->normal[i]);
        assert_int_equal(all->albedo[i], chosen->albedo[i]);
    }
    assert_memory_equal(all->shown, chosen->shown, sizeof all->shown);
    /* The invocation that marches a ray does not matter either. */
    assert_memory_equal(all->shown, shared->shown, sizeof all->shown);
    assert_memory_equal(chosen->depth, shared->depth, sizeof chosen->depth);
    for (uint32_t i = 0; i < W * H; i++) {
        if (!(all->depth[i] > 0)) continue;
        assert_int_equal(chosen->normal[i], shared->normal[i]);
        assert_int_equal(chosen->albedo[i], shared->albedo[i]);
    }
    assert_int_equal(chosen->evaluations, shared->evaluations);
    /* Each block evaluates at most once for each of its pieces. */
    assert_true(chosen->evaluations > all->evaluations);
    assert_true(chosen->evaluations - all->evaluations <= (uint64_t)W * H / 16 * 4);
    free(all);
    free(chosen);
    free(shared);
}

static void unions_cuts_and_repetitions(void **state) {
    (void)state;
    same("city", 1, 0);
    if (long_run()) same("tunnel", 1, 0); /* otherwise one of its kind: a scene takes seconds to
                                             compile */
    same("rods", 1, 0);
}

static void blends_and_parts_that_move(void **state) {
    (void)state;
    same("blobs", 1, 0.7);
    same("blobs", 1, 3.1);
    same("creature", 1, 0.4);
    if (long_run()) same("wet_city", 1, 2.3);
}

static void lists_of_parts(void **state) {
    (void)state;
    same("parts300", 1, 0);
}

static void fractals_and_an_estimate(void **state) {
    (void)state;
    same("fractals", 1, 0);
}

static void a_field_written_by_hand(void **state) {
    (void)state;
    same("engine", 1, 0);
    same("engine", 0.5f, 6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unions_cuts_and_repetitions), cmocka_unit_test(blends_and_parts_that_move),
        cmocka_unit_test(lists_of_parts),              cmocka_unit_test(fractals_and_an_estimate),
        cmocka_unit_test(a_field_written_by_hand),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

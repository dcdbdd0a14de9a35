/* test_soak.c: long runs with random rungs, cameras, times, cuts, materials, added and removed
 * models, sizes and scenes. No stored value is replaced, the image at the end is bit-identical to
 * the one at the start, and the process's memory grows only by the driver's own allocations. For
 * comparison, the growth when the same number of recordings is submitted without calls of the
 * library is printed.
 *
 * SOAK_FRAMES: 1,000, and 20,000 with `make soak`. */
#include "support/files.h"
#include "support/random.h"
#include "support/support.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 66, H = 36, BYTES = W * H * 4, SCENES = 3, SCENE_FRAMES = 100, SIZE_FRAMES = 20 };

static const char *const scenes[SCENES] = {"test_live", "test_velocity", "test_sky"};
static masu_session opened[SCENES]; /* the first has the device */
static masu_pipelines pool;
static uint8_t first[SCENES][BYTES], now[BYTES];
static uint64_t random_state = 12345;

static uint32_t roll(uint32_t n) { return random_word(&random_state) % n; }
static float share(void) { return random_float(&random_state); }

static uint64_t heap(void) { return mallinfo2().uordblks + mallinfo2().hblkhd; }

static double resident_mb(void) {
    long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (f && fscanf(f, "%*d %ld", &pages) != 1) pages = 0;
    if (f) fclose(f);
    return (double)pages * 4096 / 1e6;
}

static void make(own_renderer *x, uint32_t scene) {
    masu_session *s = &opened[0];
    masu_desc d = s->desc;
    d.scene = &opened[scene].scene;
    d.vulkan.pipelines = &pool;
    d.output = (VkExtent2D){W, H};
    d.resizable = 1;
    d.mutable_materials = 1;
    d.governor.mode = MASU_GOVERNOR_ON;
    d.rung_count = 5;
    d.rungs[0] = (masu_rung){.scale = 1.0f, .aa = MASU_AA_SMAA_HIGH};
    d.rungs[1] = (masu_rung){.scale = 0.6f, .temporal = MASU_ON};
    d.rungs[2] = (masu_rung){.scale = 0.7f, .easu = MASU_EASU_FAST, .aa = MASU_AA_FXAA};
    d.rungs[3] = (masu_rung){.scale = 1.0f, .temporal = MASU_ON};
    d.rungs[4] = (masu_rung){.scale = 0.3f, .temporal = MASU_OFF};
    make_own(s, x, &d);
}

static VkCommandBuffer frame_of(own_renderer *x, const masu_frame_desc *frame) {
    char error[ERROR_SIZE];
    masu_commands commands;
    masu_stats_info stats;
    if (masu_frame(x->m, frame, &commands, &failure)) fail_msg("%s", failure.text);
    assert_ok(masu_headless_run(&opened[0].host, commands.buffer, error, sizeof error));
    masu_frame_wall(x->m, commands.slot, 0.1 + 30.0 * (double)share());
    assert_int_equal(masu_stats(x->m, commands.slot, &stats, &failure), MASU_OK);
    if (stats.replaced)
        fail_msg("frame %llu: %llu values replaced", (unsigned long long)commands.frame,
                 (unsigned long long)stats.replaced);
    return commands.buffer;
}

static void picture_of(own_renderer *x, uint8_t *out) {
    char error[ERROR_SIZE];
    assert_ok(masu_headless_target_read(&opened[0].host, &x->target, error, sizeof error));
    memcpy(out, x->target.mapped, BYTES);
}

static void resize(own_renderer *x, uint32_t w, uint32_t h) {
    masu_detail detail;
    masu_headless_target_destroy(&opened[0].host, &x->target);
    make_target(&opened[0], x, w, h, 1);
    const masu_targets t = {
        .images = &x->target.image, .views = &x->target.view, .count = 1, .storage = 1};
    if (masu_resize(x->m, (VkExtent2D){w, h}, &t, NULL, &detail)) fail_msg("%s", detail.text);
}

static void change(own_renderer *x, uint32_t scene) {
    masu_material material = masu_material_at(x->m, scene ? 0 : roll(2));
    masu_material_state state;
    if (!masu_material_get(x->m, material, &state, &failure)) {
        state.roughness = share();
        state.emissive[roll(3)] = share() < 0.1f ? 1e6f : share();
        assert_int_equal(masu_material_set(x->m, material, &state, &failure), MASU_OK);
    }
    if (scene) return;
    masu_model truck = masu_model_find(x->m, "truck"), added;
    const float rows[12] = {1, 0, 0, share() - 0.5f, 0, 1, 0, 0, 0, 0, share(), share()};
    assert_int_equal(masu_model_show(x->m, truck, roll(2), &failure), MASU_OK);
    assert_int_equal(masu_model_set_transform(x->m, truck, rows, &failure), MASU_OK);
    if (!masu_model_add(x->m, truck, rows, &added, &failure) && roll(2))
        assert_int_equal(masu_model_remove(x->m, added, &failure), MASU_OK);
}

/* Random frames; a new renderer every SCENE_FRAMES. */
static void soak(uint32_t frames) {
    own_renderer x = {0};
    uint32_t scene = 0;
    for (uint32_t i = 0; i < frames; i++) {
        if (i % SCENE_FRAMES == 0) {
            if (x.m) unmake_own(&opened[0], &x);
            scene = i / SCENE_FRAMES % SCENES;
            make(&x, scene);
            frame_of(&x, &(masu_frame_desc){MASU_FRAME_DESC, .cut = 1});
            picture_of(&x, now);
            if (i / SCENE_FRAMES < SCENES) memcpy(first[scene], now, BYTES);
            assert_memory_equal(now, first[scene], BYTES); /* for any history */
        }
        if (i % SIZE_FRAMES == SIZE_FRAMES - 1) resize(&x, 1 + roll(W), 1 + roll(H));
        if (roll(4) == 0) change(&x, scene);
        masu_camera c = {
            .position = {4 * (double)share() - 2, 0.5 + 2 * (double)share(), 6 * (double)share()},
            .forward = {share() - 0.5f, share() - 0.7f, -1},
            .fov_y = 0.2f + 2.5f * share(),
            .near_distance = 0.05f};
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = roll(3) ? &c : NULL,
                                 .time = 100.0 * (double)share(),
                                 .time_step = roll(5) ? 1.0f / 60 : 10 * share(),
                                 .rung = roll(6) == 5 ? MASU_RUNG_AUTO : roll(5),
                                 .cut = roll(20) == 0};
        frame_of(&x, &frame);
    }
    unmake_own(&opened[0], &x);
}

/* The driver's own growth: frames of each scene, submitted again and again. */
static int64_t bare(uint32_t frames) {
    int64_t grown = 0;
    for (uint32_t scene = 0; scene < SCENES; scene++) {
        own_renderer x;
        char error[ERROR_SIZE];
        VkCommandBuffer rungs[5];
        make(&x, scene);
        for (uint32_t r = 0; r < 5; r++)
            rungs[r] = frame_of(&x, &(masu_frame_desc){MASU_FRAME_DESC, .rung = r});
        uint64_t before = heap();
        for (uint32_t i = 0; i < frames / SCENES; i++)
            assert_ok(masu_headless_run(&opened[0].host, rungs[i % 5], error, sizeof error));
        int64_t more = (int64_t)heap() - (int64_t)before;
        printf("  bare: %s: %.3f KB a frame\n", scenes[scene],
               (double)more / 1e3 / (frames / SCENES));
        grown += more;
        unmake_own(&opened[0], &x);
    }
    return grown;
}

static void memory_is_flat_and_nothing_is_left_of_what_was(void **state) {
    (void)state;
    const char *asked = getenv("SOAK_FRAMES");
    uint32_t frames = asked && atoi(asked) > 0 ? (uint32_t)atoi(asked) : 1000;
    uint32_t round = SCENES * SCENE_FRAMES;
    for (uint32_t i = 0; i < SCENES; i++) {
        masu_session_desc d = test_desc(scenes[i], W, H);
        d.no_renderer = true;
        d.host.validate = false; /* the layer allocates for itself */
        /* then the memory figures are meaningless */
        if (getenv("SOAK_VALIDATE")) d.host.validate = true;
        open_session(&opened[i], &d);
    }
    soak(round); /* objects compiled and cached once */
    double resident = resident_mb();
    uint64_t before = heap();
    uint32_t parts = frames / round > 10 ? 10 : frames / round;
    for (uint32_t p = 0; p < parts; p++) {
        soak(frames / parts);
        printf("  %u frames: heap %+.3f MB, resident %.1f MB\n", frames / parts * (p + 1),
               ((double)heap() - (double)before) / 1e6, resident_mb());
        fflush(stdout);
    }
    int64_t grown = (int64_t)heap() - (int64_t)before;
    const uint32_t bare_frames = frames < 9000 ? frames / 3 : 3000;
    int64_t own = bare(bare_frames);
    double per = (double)own / bare_frames;
    printf("  soak: %.3f KB a frame, resident %+.1f MB; the driver by itself: %.3f KB a frame\n",
           (double)grown / 1e3 / frames, resident_mb() - resident, per / 1e3);
    if (!getenv("SOAK_VALIDATE")) assert_true((double)grown <= 1.25 * per * frames + 1e6);
    masu_pipelines_destroy(&opened[0].desc.vulkan, &pool);
    for (uint32_t i = SCENES; i-- > 0;) close_session(&opened[i]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_is_flat_and_nothing_is_left_of_what_was)};
    return cmocka_run_group_tests_name("soak", tests, NULL, NULL);
}

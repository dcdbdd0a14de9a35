/* test_marches.c: the lab's marches find the same surfaces as the product's march: `plain`, the
 * baseline; `checkerboard`, whose restarts are safe; and `seed`, whose restarts are not, within the
 * tenth of a metre that its rule allows. */
#include "support/support.h"
#include "support/files.h"

#include <math.h>
#include <string.h>

enum { W = 160, H = 90, PIXELS = W * H };

static float own[PIXELS], other[PIXELS];

static void draw_march(const char *name, masu_march march, float *depths) {
    masu_session s;
    masu_session_desc d = test_desc(NULL, W, H);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    d.desc.rungs[0].march = march;
    open_session(&s, &d);
    masu_frame_desc frame = {0};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    memcpy(depths, read_image(&s, 0, MASU_READBACK_DEPTH), sizeof own);
    close_session(&s);
}

/* Pixels where only one march finds a surface, or their distances differ by more than that share.
 * Depth is near / distance. */
static uint32_t differing(double share) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double a = (double)own[i], b = (double)other[i];
        count += (a > 0) != (b > 0) || (a > 0 && fabs(a - b) > share * a);
    }
    return count;
}

static void all_marches_find_the_same_surface(void **state) {
    (void)state;
    static const char *const scenes[] = {"blobs", "spheres", "city"};
    static const struct {
        masu_march march;
        const char *name;
        double share, most; /* of the distance; of the pixels */
    } marches[] = {{MASU_MARCH_PLAIN, "plain", 0.01, 0.04}, /* it stops 0.1 pixel before a surface:
                                                             * far at grazing angles */
                   {MASU_MARCH_CHECKERBOARD, "checkerboard", 0.01, 0.01},
                   {MASU_MARCH_SEED, "seed", 0.1, 0.05}};
    for (size_t i = 0; i < (long_run() ? sizeof scenes / sizeof *scenes : 1); i++) {
        if (shell("%s/bin/masu-bake scenes/%s.json -o %s --variants --quiet", build_dir(),
                  scenes[i], baked_scene(scenes[i])))
            fail_msg("%s is not baked", scenes[i]);
        draw_march(scenes[i], MASU_MARCH_AUTO, own);
        for (size_t k = 0; k < sizeof marches / sizeof *marches; k++) {
            draw_march(scenes[i], marches[k].march, other);
            uint32_t count = differing(marches[k].share);
            print_message("  %-8s %-12s %u of %d pixels differ\n", scenes[i], marches[k].name,
                          count, PIXELS);
            assert_true(count <= marches[k].most * PIXELS);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_marches_find_the_same_surface)};
    return cmocka_run_group_tests_name("marches", tests, make_scratch, remove_scratch);
}

/* test_gpu_av.c: shaders read and write only what is theirs. Software rasterisers check bounds
 * silently, so this is invisible without the layer's GPU-assisted mode; a planted fault proves that
 * the mode is awake. */
#include "support/support.h"
#include "support/files.h"

enum { W = 48, H = 32 };

static masu_session_desc gpu_av_desc(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.host.validate = false;
    d.host.gpu_av = true;
    d.desc.debug.timestamps = 1;
    d.desc.readback = MASU_READBACK_ALL;
    return d;
}

static void every_pass_stays_inside_its_buffers_and_images(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_both", "test_broken_field", "test_shadows", "engine",
                                         "textures"};
    for (size_t i = 0; i < (whole_run() ? sizeof scenes / sizeof *scenes : 1); i++) {
        masu_session_desc d = gpu_av_desc(scenes[i]);
        masu_session s;
        open_session(&s, &d);
        for (uint32_t r = 0; r < 3; r++) draw_rung(&s, r, NULL);
        close_session(&s);
    }
}

static void a_planted_fault_is_seen(void **state) {
    (void)state;
    masu_session_desc d = gpu_av_desc("test_planted_fault");
    masu_session s;
    masu_commands commands;
    float offset = 0;
    masu_frame_desc frame = {.sdf_params = &offset, .sdf_param_count = 1};
    d.host.message = NULL; /* expected: not shown */
    open_session(&s, &d);
    draw(&s, &frame, &commands, NULL);
    assert_int_equal(s.host.messages, 0);
    offset = 500000;
    draw(&s, &frame, &commands, NULL);
    assert_true(s.host.messages > 0);
    masu_session_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pass_stays_inside_its_buffers_and_images),
        cmocka_unit_test(a_planted_fault_is_seen),
    };
    return cmocka_run_group_tests_name("gpu_av", tests, NULL, NULL);
}

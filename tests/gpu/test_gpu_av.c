/* test_gpu_av.c: shaders access only their own memory. Software rasterisers check bounds silently,
 * so violations are invisible without the layer's GPU-assisted mode; a planted fault proves that
 * the mode is active. `make gpu-av` names scenes in GPU_AV_SCENES: each is rendered for two frames
 * at each of two rungs, with the layer's best practices too. */
#include "support/support.h"
#include "support/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    /* The first three have the passes of the others; an instrumented pipeline takes long to
     * compile. */
    static const char *const scenes[] = {"test_both", "test_shadows", "textures",
                                         "test_broken_field", "engine"};
    for (size_t i = 0; i < trials(5, 3, 1); i++) {
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

/* A message that was reported, by its name in brackets at the start. */
enum { KINDS = 64 };
/* Advice that is not followed. */
static const struct {
    const char *name, *why;
} declined[] = {
    {"BestPractices-DevLimit-", "the tests' host queries once, with room for the maximum"},
    {"BestPractices-pipeline-stage-flags",
     "loading, and the barriers around a pass of the host, wait for everything"},
    {"BestPractices-vkCmdBeginRenderPass-ClearValue",
     "one array for all passes; values for absent or loaded images are ignored"},
    {"BestPractices-ImageBarrierAccessLayout",
     "the renderer does not know the host's copy, which waits for this"},
    {"BestPractices-TransitionUndefinedToReadOnly",
     "a history that nothing has been written to is not looked at"},
};
static struct {
    char name[128], text[512];
    uint32_t count;
} kinds[KINDS];
static uint32_t kind_count, lost;

static void note(void *user, const char *text) {
    const char *from = strchr(text, '['), *to = from ? strchr(from, ']') : NULL;
    (void)user;
    if (!to) from = text, to = text + strlen(text);
    int length = (int)(to - from) < 120 ? (int)(to - from) : 120;
    char name[128];
    snprintf(name, sizeof name, "%.*s", length, from);
    uint32_t k = 0;
    while (k < kind_count && strcmp(kinds[k].name, name)) k++;
    if (k == KINDS) {
        lost++;
        return;
    }
    if (k == kind_count) {
        kind_count++;
        memcpy(kinds[k].name, name, sizeof name);
        snprintf(kinds[k].text, sizeof kinds[k].text, "%s", text);
    }
    kinds[k].count++;
}

/* Messages of all scenes are gathered, so that one does not hide the next. */
static void each_scene_asked_for_stays_inside(void **state) {
    (void)state;
    char *list = getenv("GPU_AV_SCENES"), *rest = list;
    uint32_t scenes = 0, wrong = 0;
    if (!list || !*list) return; /* takes minutes: not requested */
    for (char *path = strtok_r(list, " ", &rest); path; path = strtok_r(NULL, " ", &rest)) {
        char error[ERROR_SIZE];
        masu_session_desc d = gpu_av_desc(NULL);
        masu_session s;
        d.scene_path = path;
        d.host.best = true;
        d.host.message = note;
        d.desc.readback = 0;
        d.desc.rung_count = 1;
        d.desc.rungs[0] = (masu_rung){.scale = 0.6f, .temporal = MASU_ON};
        if (!masu_session_open(&d, &s, error, sizeof error)) fail_msg("%s: %s", path, error);
        for (uint32_t k = 0; k < 2; k++) draw_rung(&s, 0, NULL);
        masu_session_close(&s);
        scenes++;
        printf("  %s: %u messages\n", path, s.host.messages);
        fflush(stdout);
    }
    for (uint32_t k = 0; k < kind_count; k++) {
        const char *why = NULL;
        for (size_t i = 0; i < sizeof declined / sizeof *declined; i++)
            if (strstr(kinds[k].name, declined[i].name)) why = declined[i].why;
        printf("  %6u messages of %s: %s\n", kinds[k].count, kinds[k].name + 1,
               why ? why : kinds[k].text);
        wrong += !why;
    }
    printf("  %u scenes, %u kinds of messages that are faults\n", scenes, wrong);
    assert_int_equal(wrong + lost, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_pass_stays_inside_its_buffers_and_images),
        cmocka_unit_test(a_planted_fault_is_seen),
        cmocka_unit_test(each_scene_asked_for_stays_inside),
    };
    return cmocka_run_group_tests_name("gpu_av", tests, NULL, NULL);
}

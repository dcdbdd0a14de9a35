/* support.c: see support.h. */
#include "support/support.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *scene_path(const char *name) {
    static char paths[4][512];
    static uint32_t next;
    const char *build = getenv("BUILD");
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/scenes/%s.masu", build ? build : "build", name);
    return path;
}

static void show_message(void *user, const char *text) {
    (void)user;
    print_error("validation: %s\n", text);
}

masu_session_desc test_desc(const char *scene, uint32_t width, uint32_t height) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = scene ? scene_path(scene) : NULL;
    d.desc.output = (VkExtent2D){width, height};
    d.desc.targets.storage = 1;
    d.desc.debug.counters = 1;
    d.host.validate = true;
    d.host.message = show_message;
    return d;
}

void open_session(masu_session *s, const masu_session_desc *d) {
    char error[ERROR_SIZE];
    if (!masu_session_open(d, s, error, sizeof error)) fail_msg("masu_session_open: %s", error);
    if (d->host.validate || d->host.gpu_av) assert_true(s->host.validating);
}

void close_session(masu_session *s) {
    /* Destruction is validated too: count after it. */
    masu_session_close(s);
    if (s->host.messages)
        fail_msg("%u validation messages, first: %s", s->host.messages, s->host.first_message);
}

void draw(masu_session *s, const masu_frame_desc *frame, masu_commands *commands, uint8_t *pixels) {
    char error[ERROR_SIZE];
    assert_ok(masu_session_frame(s, frame, true, commands, error, sizeof error));
    if (!pixels) return;
    masu_headless_target *t = &s->targets[frame->target];
    assert_ok(masu_headless_target_read(&s->host, t, error, sizeof error));
    memcpy(pixels, t->mapped, (size_t)t->width * t->height * 4);
}

void draw_rung(masu_session *s, uint32_t rung, uint8_t *pixels) {
    masu_frame_desc frame = {.rung = rung};
    masu_commands commands;
    draw(s, &frame, &commands, pixels);
}

uint32_t max_difference(const uint8_t *a, const uint8_t *b, size_t bytes) {
    uint32_t most = 0;
    for (size_t i = 0; i < bytes; i++) {
        uint32_t d = (uint32_t)abs((int)a[i] - (int)b[i]);
        if (d > most) most = d;
    }
    return most;
}

/* support.h: what the GPU tests share: sessions under the validation layer, and pictures compared.
 *
 * Every session validates (core and synchronisation); a message fails the test that closes it. The
 * driver is the one that the environment names: tests/run.sh runs each program once per driver. */
#ifndef MASU_TEST_SUPPORT_H
#define MASU_TEST_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "session.h"

#define ERROR_SIZE 1024u

/* $BUILD/scenes/NAME.masu; static storage, four names at a time. */
const char *scene_path(const char *name);

/* A description with validation, counters and a storage target. scene may be NULL. */
masu_session_desc test_desc(const char *scene, uint32_t width, uint32_t height);

/* Open, asserting success; close, asserting that the layer was there and stayed silent. */
void open_session(masu_session *s, const masu_session_desc *d);
void close_session(masu_session *s);

/* One frame, waited for. Pixels (width * height * 4 bytes) may be NULL. */
void draw(masu_session *s, const masu_frame_desc *frame, masu_commands *commands, uint8_t *pixels);
/* The same with nothing but a rung. */
void draw_rung(masu_session *s, uint32_t rung, uint8_t *pixels);

/* Largest difference of any byte. */
uint32_t max_difference(const uint8_t *a, const uint8_t *b, size_t bytes);

#define assert_ok(call)                                                                            \
    do {                                                                                           \
        if (!(call)) fail_msg("%s: %s", #call, error);                                             \
    } while (0)

#endif

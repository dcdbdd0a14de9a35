/* test_exr.c: OpenEXR files. Floats are read back bit for bit, compressed files of other writers
 * are read, damaged ones are rejected with one line. tests/scripts/compare.sh exchanges files with
 * ImageMagick. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700
#endif

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "image.h"
#include "support/files.h"

static char error[300];

static int remove_files(void **state) {
    (void)unlink(in_scratch("a.exr"));
    return remove_empty_scratch(state);
}

static void refused(const uint8_t *bytes, size_t count, const char *reason) {
    struct masu_image image;
    memset(&image, 0x5A, sizeof image);
    assert_false(masu_image_decode_exr("a.exr", bytes, count, &image, error, sizeof error));
    assert_null(image.values);
    if (!strstr(error, reason) || strncmp(error, "a.exr: ", 7) != 0 || strchr(error, '\n'))
        fail_msg("\"%s\" is not one line of a.exr with \"%s\"", error, reason);
}

static void floats_come_back_bit_for_bit(void **state) {
    (void)state;
    enum { W = 5, H = 3 };
    const char *path = in_scratch("a.exr");
    float values[3 * W * H];
    for (int i = 0; i < 3 * W * H; i++) values[i] = ldexpf(1.0f + (float)i / 7.0f, i - 20);
    values[4] = 1e30f, values[5] = -3.0f, values[6] = HUGE_VALF, values[7] = nanf("");
    assert_true(masu_image_save_linear(path, values, W, H, error, sizeof error));
    struct masu_image image;
    assert_true(masu_image_load(path, &image, error, sizeof error));
    assert_int_equal(image.width, W);
    assert_int_equal(image.height, H);
    assert_int_equal(image.channels, 3);
    assert_null(image.rgba);
    assert_memory_equal(image.values, values, sizeof values);
    masu_image_free(&image);
}

/* ---- A file by hand -------------------------------------------------------------------------- */

typedef struct made {
    uint8_t bytes[1024];
    size_t count;
} made;

static void add(made *m, const void *bytes, size_t count) {
    assert_true(m->count + count <= sizeof m->bytes);
    memcpy(m->bytes + m->count, bytes, count);
    m->count += count;
}

static void add_number(made *m, uint32_t value) {
    uint8_t bytes[4] = {(uint8_t)value, (uint8_t)(value >> 8), (uint8_t)(value >> 16),
                        (uint8_t)(value >> 24)};
    add(m, bytes, 4);
}

static void add_attribute(made *m, const char *name, const char *type, uint32_t count) {
    add(m, name, strlen(name) + 1);
    add(m, type, strlen(type) + 1);
    add_number(m, count);
}

/* Half floats A, B, G, R; a window that does not start at 0. */
static made header(uint32_t flags, uint8_t compression, uint32_t width, uint32_t height) {
    made m = {.count = 0};
    add(&m, "\x76\x2F\x31\x01", 4);
    add_number(&m, flags);
    add_attribute(&m, "compression", "compression", 1);
    add(&m, &compression, 1);
    add_attribute(&m, "channels", "chlist", 4 * 18 + 1);
    for (const char *name = "ABGR"; *name; name++) {
        add(&m, name, 1);
        add(&m, "", 1);
        add_number(&m, 1);
        add_number(&m, 0);
        add_number(&m, 1);
        add_number(&m, 1);
    }
    add(&m, "", 1);
    add_attribute(&m, "dataWindow", "box2i", 16);
    add_number(&m, 10);
    add_number(&m, 0xFFFFFFFDu); /* -3 */
    add_number(&m, 10 + width - 1);
    add_number(&m, 0xFFFFFFFDu + height - 1);
    add(&m, "", 1);
    return m;
}

/* 4x1 of 1.0: bytes 00 3C; as differences plus 128, low bytes first: 00, 15 x 80, BC, 15 x 80. */
static made run_lengths(void) {
    made m = header(2, 1, 4, 1);
    add(&m, "\0\0\0\0\0\0\0", 8);
    add_number(&m, 0xFFFFFFFDu);
    add_number(&m, 8);
    add(&m, "\x00\x00\x0E\x80\xFF\xBC\x0E\x80", 8);
    return m;
}

static void run_lengths_are_read(void **state) {
    (void)state;
    struct masu_image image;
    made m = run_lengths();
    if (!masu_image_decode_exr("a.exr", m.bytes, m.count, &image, error, sizeof error))
        fail_msg("%s", error);
    assert_int_equal(image.width, 4);
    assert_int_equal(image.channels, 3);
    for (int i = 0; i < 12; i++) assert_true(image.values[i] == 1.0f);
    masu_image_free(&image);
}

static void other_kinds_are_named(void **state) {
    (void)state;
    refused((const uint8_t *)"not an image at all", 19, "is not an OpenEXR file");
    made m = header(2, 4, 4, 1); /* PIZ */
    refused(m.bytes, m.count, "expected none, RLE, ZIPS or ZIP");
    m = header(2 | 0x200, 0, 4, 1);
    refused(m.bytes, m.count, "found tiles");
    m = header(2 | 0x1000, 0, 4, 1);
    refused(m.bytes, m.count, "several parts");
    m = header(1, 0, 4, 1);
    refused(m.bytes, m.count, "another version");
    m = header(2, 0, 20000, 1);
    refused(m.bytes, m.count, "larger than 16384");
    m = header(2, 0, 0, 1);
    refused(m.bytes, m.count, "empty");
    m = header(2, 0, 16000, 4000);
    refused(m.bytes, m.count, "truncated or damaged");
}

/* Each block is a separate allocation, so that sanitizers detect a read beyond it. */
static void damaged_files_are_refused_or_read(void **state) {
    (void)state;
    made m = run_lengths();
    struct masu_image image;
    for (size_t n = 0; n < m.count; n++) {
        uint8_t *part = malloc(n + 1);
        memcpy(part, m.bytes, n);
        assert_false(masu_image_decode_exr("a.exr", part, n, &image, error, sizeof error));
        free(part);
    }
    for (size_t i = 0; i < m.count; i++) {
        for (int bit = 0; bit < 8; bit++) {
            uint8_t *changed = malloc(m.count);
            memcpy(changed, m.bytes, m.count);
            changed[i] ^= (uint8_t)(1 << bit);
            if (masu_image_decode_exr("a.exr", changed, m.count, &image, error, sizeof error))
                masu_image_free(&image);
            free(changed);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(floats_come_back_bit_for_bit, make_scratch, remove_files),
        cmocka_unit_test(run_lengths_are_read),
        cmocka_unit_test(other_kinds_are_named),
        cmocka_unit_test(damaged_files_are_refused_or_read),
    };
    return cmocka_run_group_tests_name("exr", tests, NULL, NULL);
}

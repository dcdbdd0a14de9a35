/* test_image.c: image files. Written images must read back identically; damaged, oversized or
 * unwritable files must be rejected with one line that names the file, and leave nothing behind.
 *
 * Each test has a new directory, removed afterwards. A file that the tested code leaves there makes
 * the removal, and so the test, fail. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700
#endif

#include <dirent.h>
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "image.h"
#include "reference/patterns.h"
#include "support/files.h"

/* Made by another encoder (zlib, by hand), so that reader and writer cannot share a mistake. */

/* 2x2, 2 bits of palette: red, green / blue, white of alpha 128. */
static const uint8_t palette_png[] = {
    0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x02, 0x03, 0x00, 0x00, 0x00, 0x0F, 0xD8, 0xE5,
    0xB7, 0x00, 0x00, 0x00, 0x0C, 0x50, 0x4C, 0x54, 0x45, 0xFF, 0x00, 0x00, 0x00, 0xFF, 0x00, 0x00,
    0x00, 0xFF, 0xFF, 0xFF, 0xFF, 0xFB, 0x00, 0x60, 0xF6, 0x00, 0x00, 0x00, 0x04, 0x74, 0x52, 0x4E,
    0x53, 0xFF, 0xFF, 0xFF, 0x80, 0xAD, 0x92, 0x2A, 0xD4, 0x00, 0x00, 0x00, 0x0C, 0x49, 0x44, 0x41,
    0x54, 0x78, 0xDA, 0x63, 0x10, 0x60, 0xD8, 0x00, 0x00, 0x00, 0xE4, 0x00, 0xC1, 0x19, 0x55, 0x3B,
    0xFB, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82,
};

/* 2x1, 16-bit grey: 0x1234, 0xFEDC. */
static const uint8_t grey16_png[] = {
    0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x81, 0xD9, 0xFC,
    0x15, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x44, 0x41, 0x54, 0x78, 0xDA, 0x63, 0x10, 0x32, 0xF9, 0x77,
    0x07, 0x00, 0x03, 0xC1, 0x02, 0x21, 0xD2, 0xBD, 0x55, 0x22, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45,
    0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82,
};

/* 2x2 RGB with the Sub and Up row filters: (10,20,30) (40,60,80) / (11,22,33) (44,66,88). */
static const uint8_t filtered_png[] = {
    0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52,
    0x00, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x02, 0x08, 0x02, 0x00, 0x00, 0x00, 0xFD, 0xD4, 0x9A,
    0x73, 0x00, 0x00, 0x00, 0x16, 0x49, 0x44, 0x41, 0x54, 0x78, 0xDA, 0x63, 0xE4, 0x12, 0x91, 0x93,
    0xD3, 0x30, 0x62, 0x62, 0x64, 0x62, 0x66, 0x61, 0xE3, 0x00, 0x00, 0x07, 0x46, 0x00, 0xD0, 0xA5,
    0x23, 0x67, 0x96, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82,
};

static char error[256];

static int make_directory(void **state)
{
    memset(error, 0, sizeof error);
    return make_scratch(state);
}

static int files_in_directory(void)
{
    int count = 0;
    DIR *dir = opendir(scratch);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir)) != NULL;) {
        count += entry->d_name[0] != '.';
    }
    (void)closedir(dir);
    return count;
}

/* Tests give files only these names, so that any other file is a leftover. */
static int remove_directory(void **state)
{
    static const char *const known[] = { "a.png", "b.png", "a.pfm", "a.bin", "link.png", "pipe" };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        (void)unlink(in_scratch(known[i]));
    }
    return remove_empty_scratch(state);
}

static void assert_error_mentions(const char *path, const char *reason)
{
    if (!strstr(error, path) || !strstr(error, reason) || strchr(error, '\n')) {
        fail_msg("\"%s\" is not one line with \"%s\" and \"%s\"", error, path, reason);
    }
}

static void assert_png_is_refused(const void *bytes, size_t count, const char *reason)
{
    const char *path = write_bytes("a.png", bytes, count);
    struct masu_image image;
    memset(&image, 0x5A, sizeof image);
    assert_false(masu_image_load_png(path, &image, error, sizeof error));
    assert_null(image.rgba);
    assert_int_equal(image.width, 0);
    assert_error_mentions(path, reason);
}

/* ---- PNG ---- */

static void a_png_comes_back_as_it_was_written(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = { { 1, 1 }, { 7, 5 }, { 1, 300 }, { 300, 1 }, { 64, 48 } };
    const char *path = in_scratch("a.png");
    for (int p = 0; p < MASU_PATTERN_COUNT; p++) {
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
            uint32_t w = sizes[s][0], h = sizes[s][1];
            uint8_t pixels[64 * 48 * 4];
            masu_pattern_fill((enum masu_pattern)p, 1, w, h, pixels);
            for (uint32_t i = 0; i < w * h; i++) {
                pixels[i * 4 + 3] = (uint8_t)(i * 37); /* alpha must be kept too */
            }
            struct masu_image image;
            assert_true(masu_image_save_png(path, pixels, w, h, 0, error, sizeof error));
            assert_true(masu_image_load_png(path, &image, error, sizeof error));
            assert_int_equal(image.width, w);
            assert_int_equal(image.height, h);
            assert_int_equal(image.channels, 4);
            assert_null(image.values);
            assert_memory_equal(image.rgba, pixels, w * h * 4);
            masu_image_free(&image);
            assert_null(image.rgba);
        }
    }
    assert_string_equal(error, "");
}

static void padding_between_rows_is_not_written(void **state)
{
    (void)state;
    const char *path = in_scratch("a.png");
    uint8_t padded[3 * 20];
    memset(padded, 0xEE, sizeof padded);
    for (uint32_t i = 0; i < 3 * 4 * 4; i++) {
        padded[i / 16 * 20 + i % 16] = (uint8_t)i;
    }
    struct masu_image image;
    assert_true(masu_image_save_png(path, padded, 4, 3, 20, error, sizeof error));
    assert_true(masu_image_load_png(path, &image, error, sizeof error));
    for (uint32_t i = 0; i < 3 * 4 * 4; i++) {
        assert_int_equal(image.rgba[i], i);
    }
    masu_image_free(&image);
    assert_false(masu_image_save_png(path, padded, 4, 3, 15, error, sizeof error));
    assert_error_mentions(path, "15 bytes");
}

static void other_kinds_of_png_arrive_as_8_bit_rgba(void **state)
{
    (void)state;
    const char *path = in_scratch("a.png");
    struct masu_image image;

    static const uint8_t palette[] = { 255, 0, 0,   255, 0,   255, 0,   255,
                                       0,   0, 255, 255, 255, 255, 255, 128 };
    write_bytes("a.png", palette_png, sizeof palette_png);
    assert_true(masu_image_load_png(path, &image, error, sizeof error));
    assert_memory_equal(image.rgba, palette, sizeof palette);
    masu_image_free(&image);

    static const uint8_t grey[] = { 0x12, 0x12, 0x12, 255, 0xFE, 0xFE, 0xFE, 255 };
    write_bytes("a.png", grey16_png, sizeof grey16_png);
    assert_true(masu_image_load_png(path, &image, error, sizeof error));
    assert_int_equal(image.width, 2);
    assert_int_equal(image.height, 1);
    assert_memory_equal(image.rgba, grey, sizeof grey);
    masu_image_free(&image);

    static const uint8_t filtered[] = { 10, 20, 30, 255, 40, 60, 80, 255,
                                        11, 22, 33, 255, 44, 66, 88, 255 };
    write_bytes("a.png", filtered_png, sizeof filtered_png);
    assert_true(masu_image_load_png(path, &image, error, sizeof error));
    assert_memory_equal(image.rgba, filtered, sizeof filtered);
    masu_image_free(&image);
}

static void a_png_cut_anywhere_is_refused(void **state)
{
    (void)state;
    for (size_t n = 0; n < sizeof palette_png; n++) {
        assert_png_is_refused(palette_png, n, n < 8 ? "not a PNG" : "truncated");
    }
}

static void a_png_with_any_byte_changed_is_refused(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof palette_png; i++) {
        for (int bit = 0; bit < 8; bit += 3) {
            uint8_t bytes[sizeof palette_png];
            memcpy(bytes, palette_png, sizeof bytes);
            bytes[i] ^= (uint8_t)(1 << bit);
            assert_png_is_refused(bytes, sizeof bytes, "PNG");
        }
    }
}

/* Bit by bit, unlike the code under test. */
static void seal(uint8_t *chunk)
{
    uint32_t count = (uint32_t)chunk[2] << 8 | chunk[3];
    uint32_t crc = 0xFFFFFFFFu;
    for (uint32_t i = 4; i < 8 + count; i++) {
        crc ^= chunk[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = crc >> 1 ^ (crc & 1u ? 0xEDB88320u : 0u);
        }
    }
    for (int b = 0; b < 4; b++) {
        chunk[8 + count + (uint32_t)b] = (uint8_t)(~crc >> (24 - 8 * b));
    }
}

static void assert_header_size_is_refused(uint32_t width, uint32_t height, const char *reason)
{
    uint8_t bytes[sizeof grey16_png];
    memcpy(bytes, grey16_png, sizeof bytes);
    for (int b = 0; b < 4; b++) {
        bytes[16 + b] = (uint8_t)(width >> (24 - 8 * b));
        bytes[20 + b] = (uint8_t)(height >> (24 - 8 * b));
    }
    seal(bytes + 8);
    assert_png_is_refused(bytes, sizeof bytes, reason);
}

static void a_png_of_a_forbidden_size_is_refused_by_its_header(void **state)
{
    (void)state;
    assert_header_size_is_refused(0, 1, "empty");
    assert_header_size_is_refused(2, 0, "empty");
    assert_header_size_is_refused(16385, 1, "16385x1 is larger than 16384");
    assert_header_size_is_refused(1, 0xFFFFFFFFu, "larger than 16384");
    assert_header_size_is_refused(16384, 16384, "more than 67108864 pixels");
    assert_header_size_is_refused(3, 1, "decode"); /* allowed, but the samples are too few */
}

static void a_sealed_but_senseless_png_is_refused(void **state)
{
    (void)state;
    uint8_t bytes[sizeof grey16_png];
    memcpy(bytes, grey16_png, sizeof bytes);
    bytes[33 + 8] = 0x00; /* not a zlib stream */
    seal(bytes + 33);
    assert_png_is_refused(bytes, sizeof bytes, "decode");

    /* IDAT before IHDR: drop the header chunk. */
    memcpy(bytes, grey16_png, sizeof bytes);
    memmove(bytes + 8, bytes + 33, sizeof bytes - 33);
    assert_png_is_refused(bytes, sizeof bytes - 25, "does not begin with its header");

    assert_png_is_refused("GIF89a, honestly", 16, "not a PNG");
}

static void a_picture_of_a_forbidden_size_is_not_written(void **state)
{
    (void)state;
    const char *path = in_scratch("a.png");
    uint8_t pixel[4] = { 0 };
    float value = 0.0f;
    assert_false(masu_image_save_png(path, pixel, 0, 1, 0, error, sizeof error));
    assert_error_mentions(path, "empty");
    assert_false(masu_image_save_png(path, pixel, 1, 16385, 0, error, sizeof error));
    assert_error_mentions(path, "1x16385");
    assert_false(masu_image_save_png(path, pixel, 16384, 4097, 0, error, sizeof error));
    assert_error_mentions(path, "16384x4097");
    assert_false(masu_image_save_pfm(path, &value, 0, 0, 1, error, sizeof error));
    assert_false(masu_image_save_pfm(path, &value, 1, 1, 2, error, sizeof error));
    assert_error_mentions(path, "not 2");
    assert_int_equal(files_in_directory(), 0);
}

/* ---- PFM ---- */

static void a_pfm_comes_back_bit_for_bit(void **state)
{
    (void)state;
    static const uint32_t special[] = { 0x7FC01234u, 0xFF800000u, 0x80000000u, 0x00000001u,
                                        0x3F800000u, 0x7F7FFFFFu };
    const char *path = in_scratch("a.pfm");
    for (uint32_t channels = 1; channels <= 3; channels += 2) {
        float values[5 * 4 * 3];
        for (uint32_t i = 0; i < 5 * 4 * channels; i++) {
            uint32_t bits = i < 6 ? special[i] : masu_pattern_hash(i);
            memcpy(&values[i], &bits, 4);
        }
        struct masu_image image;
        assert_true(masu_image_save_pfm(path, values, 5, 4, channels, error, sizeof error));
        assert_true(masu_image_load_pfm(path, &image, error, sizeof error));
        assert_int_equal(image.width, 5);
        assert_int_equal(image.height, 4);
        assert_int_equal(image.channels, channels);
        assert_null(image.rgba);
        assert_memory_equal(image.values, values, 5 * 4 * channels * sizeof(float));
        masu_image_free(&image);
    }
}

/* Little-endian, bottom row first: the layout that other programs expect. */
static void a_pfm_has_the_documented_bytes(void **state)
{
    (void)state;
    static const uint8_t expected[] = "Pf\n1 2\n-1.0\n\x00\x00\x00\xC0\x00\x00\x80\x3F";
    static const float values[2] = { 1.0f, -2.0f }; /* top, bottom */
    const char *path = in_scratch("a.pfm");
    uint8_t *bytes;
    size_t count;
    assert_true(masu_image_save_pfm(path, values, 1, 2, 1, error, sizeof error));
    assert_true(masu_file_read(path, 1000, &bytes, &count, error, sizeof error));
    assert_int_equal(count, sizeof expected - 1);
    assert_memory_equal(bytes, expected, count);
    free(bytes);
}

static void a_big_endian_pfm_is_read(void **state)
{
    (void)state;
    static const uint8_t file[] = "PF 1 1 1.0 \x3F\x80\x00\x00\x40\x00\x00\x00\xC0\x40\x00\x00";
    struct masu_image image;
    write_bytes("a.pfm", file, sizeof file - 1);
    assert_true(masu_image_load_pfm(in_scratch("a.pfm"), &image, error, sizeof error));
    assert_true(image.values[0] == 1.0f && image.values[1] == 2.0f && image.values[2] == -3.0f);
    masu_image_free(&image);
}

static void a_damaged_pfm_is_refused(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        const char *reason;
    } cases[] = {
        { "", "not a PFM" },
        { "P6\n1 1\n255\nxyz", "not a PFM" },
        { "PF\n1 1\n0.0\n............", "not a PFM" },
        { "PF\n1 1\nnan\n............", "not a PFM" },
        { "PF\n1 one\n-1.0\n............", "not a PFM" },
        { "PF\n1 1\n-1.0", "not a PFM" },
        { "PF\n0 1\n-1.0\n", "empty" },
        { "PF\n-1 1\n-1.0\n............", "larger than" },
        { "PF\n99999999999 1\n-1.0\n", "larger than" },
        { "Pf\n16384 16384\n-1.0\n....", "more than" },
        { "PF\n1 1\n-1.0\n...........", "needs 12 bytes of samples, has 11" },
        { "PF\n1 1\n-1.0\n.............", "needs 12 bytes of samples, has 13" },
        { "Pf\n2 1\n-1.0\n", "needs 8 bytes of samples, has 0" },
    };
    const char *path = in_scratch("a.pfm");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct masu_image image;
        write_bytes("a.pfm", cases[i].text, strlen(cases[i].text));
        int loaded = masu_image_load_pfm(path, &image, error, sizeof error);
        if (loaded || image.values) {
            fail_msg("case %zu was accepted", i);
        }
        assert_error_mentions(path, cases[i].reason);
    }
}

/* ---- files ---- */

static void a_missing_file_is_named(void **state)
{
    (void)state;
    struct masu_image image;
    const char *path = in_scratch("a.png");
    assert_false(masu_image_load_png(path, &image, error, sizeof error));
    assert_error_mentions(path, "No such file");
    assert_false(masu_image_load_pfm(path, &image, error, sizeof error));
    assert_error_mentions(path, "No such file");
    assert_false(masu_image_load_png(scratch, &image, error, sizeof error));
    assert_error_mentions(scratch, "not a regular file");
}

static void an_unwritable_place_is_named_and_left_alone(void **state)
{
    (void)state;
    uint8_t pixel[4] = { 1, 2, 3, 4 };
    const char *path = in_scratch("nowhere/a.png");
    assert_false(masu_image_save_png(path, pixel, 1, 1, 0, error, sizeof error));
    assert_error_mentions(path, "No such file");
    assert_false(masu_image_save_png(scratch, pixel, 1, 1, 0, error, sizeof error));
    assert_error_mentions(scratch, "directory");
    assert_int_equal(files_in_directory(), 0);
}

static void a_failed_write_keeps_the_old_file_and_no_other(void **state)
{
    (void)state;
    const char *path = in_scratch("a.bin");
    static const uint8_t large[100000];
    write_bytes("a.bin", "old", 3);

    /* The limit makes the write stop half-way, as a full disk does. */
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    struct rlimit small = { .rlim_cur = 5000, .rlim_max = before.rlim_max };
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    bool written = masu_file_write(path, large, sizeof large, error, sizeof error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    (void)signal(SIGXFSZ, handler);

    assert_false(written);
    assert_error_mentions(path, "cannot write");
    assert_int_equal(files_in_directory(), 1);
    uint8_t *bytes;
    size_t count;
    assert_true(masu_file_read(path, 100, &bytes, &count, error, sizeof error));
    assert_int_equal(count, 3);
    assert_memory_equal(bytes, "old", 3);
    free(bytes);
}

static void a_write_replaces_the_file_whole(void **state)
{
    (void)state;
    const char *path = in_scratch("a.bin");
    mode_t mask = umask(0027);
    assert_true(masu_file_write(path, "a longer first text", 19, error, sizeof error));
    (void)umask(mask);
    struct stat info;
    assert_int_equal(stat(path, &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);

    int open_before = open(path, O_RDONLY);
    assert_true(masu_file_write(path, "short", 5, error, sizeof error));
    uint8_t *bytes;
    size_t count;
    assert_true(masu_file_read(path, 100, &bytes, &count, error, sizeof error));
    assert_int_equal(count, 5);
    free(bytes);
    char old[32];
    assert_int_equal(read(open_before, old, sizeof old), 19); /* readers keep the opened file */
    (void)close(open_before);
    assert_int_equal(files_in_directory(), 1);
}

static void a_link_is_followed_and_a_pipe_is_not_replaced(void **state)
{
    (void)state;
    const char *link = in_scratch("link.png");
    assert_true(masu_file_write(in_scratch("b.png"), "1", 1, error, sizeof error));
    assert_int_equal(symlink("b.png", link), 0);
    assert_true(masu_file_write(link, "22", 2, error, sizeof error));
    struct stat info;
    assert_int_equal(lstat(link, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(stat(in_scratch("b.png"), &info), 0);
    assert_int_equal(info.st_size, 2);

    /* A pipe represents everything that is not a regular file, such as a replaced /dev/null. */
    const char *pipe = in_scratch("pipe");
    assert_int_equal(mkfifo(pipe, 0600), 0);
    int reader = open(pipe, O_RDONLY | O_NONBLOCK);
    assert_true(reader >= 0);
    assert_true(masu_file_write(pipe, "333", 3, error, sizeof error));
    char got[8];
    assert_int_equal(read(reader, got, sizeof got), 3);
    (void)close(reader);
    assert_int_equal(stat(pipe, &info), 0);
    assert_true(S_ISFIFO(info.st_mode));
}

static void reading_respects_the_limit(void **state)
{
    (void)state;
    const char *path = in_scratch("a.bin");
    uint8_t *bytes;
    size_t count;
    write_bytes("a.bin", "12345", 5);
    assert_true(masu_file_read(path, 5, &bytes, &count, error, sizeof error));
    free(bytes);
    assert_false(masu_file_read(path, 4, &bytes, &count, error, sizeof error));
    assert_null(bytes);
    assert_error_mentions(path, "5 bytes, more than the limit of 4");
    write_bytes("a.bin", "", 0);
    assert_true(masu_file_read(path, 4, &bytes, &count, error, sizeof error));
    assert_int_equal(count, 0);
    free(bytes);
}

static void the_error_buffer_may_be_short_or_absent(void **state)
{
    (void)state;
    struct masu_image image;
    char tiny[8];
    memset(tiny, 'x', sizeof tiny);
    assert_false(masu_image_load_png(in_scratch("a.png"), &image, tiny, 4));
    assert_memory_equal(tiny, "/tm\0xxxx", 8);
    assert_false(masu_image_load_png(in_scratch("a.png"), &image, NULL, 0));
    masu_image_free(&image);
}

/* The bytes needed do not depend on the room, and nothing is written beyond it. */
static void a_jpeg_is_cut_at_its_room(void **state) {
    (void)state;
    static uint8_t rgba[33 * 17 * 4], whole[8192], part[8192];
    for (uint32_t i = 0; i < sizeof rgba; i++) rgba[i] = (uint8_t)(i * i >> 3);
    assert_int_equal(masu_image_encode_jpeg(rgba, 33, 17, 0, whole, sizeof whole), 0);
    assert_int_equal(masu_image_encode_jpeg(rgba, 33, 17, 101, whole, sizeof whole), 0);
    assert_int_equal(masu_image_encode_jpeg(rgba, 0, 17, 50, whole, sizeof whole), 0);
    size_t low = masu_image_encode_jpeg(rgba, 33, 17, 1, whole, sizeof whole);
    size_t high = masu_image_encode_jpeg(rgba, 33, 17, 100, whole, sizeof whole);
    assert_true(low > 300 && high > 2 * low && high < sizeof whole);
    assert_memory_equal(whole, "\xFF\xD8\xFF", 3);
    assert_memory_equal(whole + high - 2, "\xFF\xD9", 2);
    for (size_t most = 0; most <= high + 1; most++) {
        memset(part, 0xA5, sizeof part);
        assert_int_equal(masu_image_encode_jpeg(rgba, 33, 17, 100, part, most), high);
        assert_memory_equal(part, whole, most < high ? most : high);
        assert_int_equal(part[most < high ? most : high], 0xA5);
    }
    assert_int_equal(masu_image_encode_jpeg(rgba, 33, 17, 100, NULL, 0), high);
}

#define IN_A_DIRECTORY(test) cmocka_unit_test_setup_teardown(test, make_directory, remove_directory)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_jpeg_is_cut_at_its_room),
        IN_A_DIRECTORY(a_png_comes_back_as_it_was_written),
        IN_A_DIRECTORY(padding_between_rows_is_not_written),
        IN_A_DIRECTORY(other_kinds_of_png_arrive_as_8_bit_rgba),
        IN_A_DIRECTORY(a_png_cut_anywhere_is_refused),
        IN_A_DIRECTORY(a_png_with_any_byte_changed_is_refused),
        IN_A_DIRECTORY(a_png_of_a_forbidden_size_is_refused_by_its_header),
        IN_A_DIRECTORY(a_sealed_but_senseless_png_is_refused),
        IN_A_DIRECTORY(a_picture_of_a_forbidden_size_is_not_written),
        IN_A_DIRECTORY(a_pfm_comes_back_bit_for_bit),
        IN_A_DIRECTORY(a_pfm_has_the_documented_bytes),
        IN_A_DIRECTORY(a_big_endian_pfm_is_read),
        IN_A_DIRECTORY(a_damaged_pfm_is_refused),
        IN_A_DIRECTORY(a_missing_file_is_named),
        IN_A_DIRECTORY(an_unwritable_place_is_named_and_left_alone),
        IN_A_DIRECTORY(a_failed_write_keeps_the_old_file_and_no_other),
        IN_A_DIRECTORY(a_write_replaces_the_file_whole),
        IN_A_DIRECTORY(a_link_is_followed_and_a_pipe_is_not_replaced),
        IN_A_DIRECTORY(reading_respects_the_limit),
        IN_A_DIRECTORY(the_error_buffer_may_be_short_or_absent),
    };
    return cmocka_run_group_tests_name("image", tests, NULL, NULL);
}

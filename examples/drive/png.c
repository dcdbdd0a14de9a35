/* png.c: see png.h. Nothing is compressed: each row is a stored block of deflate in a chunk of its own. */
#include "png.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define WIDEST 8192 /* a row has to fit into a stored block, which holds 65535 bytes */

static uint8_t *big_endian(uint8_t *to, uint32_t x) {
    for (int i = 0; i < 4; i++) to[i] = (uint8_t)(x >> (24 - 8 * i));
    return to + 4;
}

static bool chunk(int file, const char *type, uint8_t *bytes, uint32_t count) {
    uint32_t crc = UINT32_MAX; /* `bytes` has 8 free before it and 4 behind */
    big_endian(bytes - 8, count);
    memcpy(bytes - 4, type, 4);
    for (const uint8_t *at = bytes - 4; at < bytes + count; at++) {
        crc ^= *at;
        for (int i = 0; i < 8; i++) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
    }
    big_endian(bytes + count, ~crc);
    return write(file, bytes - 8, count + 12) == (ssize_t)count + 12;
}

static bool write_rows(int file, const uint8_t *pixels, uint32_t width, uint32_t height, bool bgr) {
    static uint8_t buffer[WIDEST * 3 + 32];
    uint8_t *bytes = buffer + 8;
    uint32_t a = 1, b = 0, row = width * 3 + 1; /* of Adler-32 */
    memcpy(big_endian(big_endian(bytes, width), height), "\x08\x02\0\0", 5);
    bool good = write(file, "\x89PNG\r\n\x1a\n", 8) == 8 && chunk(file, "IHDR", bytes, 13);
    memcpy(bytes, "\x78\x01", 2);
    good = good && chunk(file, "IDAT", bytes, 2);
    for (uint32_t y = 0; good && y < height; y++) {
        uint8_t *to = bytes;
        *to++ = y + 1 == height; /* the last block */
        *to++ = (uint8_t)row, *to++ = (uint8_t)(row >> 8);
        *to++ = (uint8_t)~row, *to++ = (uint8_t)(~row >> 8);
        *to++ = 0; /* no filter */
        for (uint32_t x = 0; x < width; x++, pixels += 4) {
            *to++ = pixels[bgr ? 2 : 0], *to++ = pixels[1], *to++ = pixels[bgr ? 0 : 2];
        }
        for (const uint8_t *at = bytes + 5; at < to; at++) a = (a + *at) % 65521, b = (b + a) % 65521;
        good = chunk(file, "IDAT", bytes, row + 5);
    }
    big_endian(bytes, b << 16 | a);
    return good && chunk(file, "IDAT", bytes, 4) && chunk(file, "IEND", bytes, 0);
}

bool png_write(const char *path, const uint8_t *pixels, uint32_t width, uint32_t height, bool bgr) {
    int file = width <= WIDEST ? open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666) : -1;
    bool good = file >= 0 && write_rows(file, pixels, width, height, bgr);
    if (file >= 0) good = close(file) == 0 && good;
    if (!good) fprintf(stderr, "drive: cannot write %s: %s\n", path, strerror(errno));
    return good;
}

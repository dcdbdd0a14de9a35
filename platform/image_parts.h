/* image_parts.h: functions shared by image.c, image_write.c and exr.c, which alone include it. */
#ifndef MASU_PLATFORM_IMAGE_PARTS_H
#define MASU_PLATFORM_IMAGE_PARTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Writes one line to `error`; always false, so that a failing branch is one statement. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
bool masu_image_fail(char *error, size_t error_size, const char *format, ...);

/* Whether images of that size are allowed. */
bool masu_image_size_allowed(const char *path, uint32_t width, uint32_t height, char *error,
                             size_t error_size);

/* Decompresses a zlib stream of exactly `bytes` bytes. */
bool masu_image_inflate(const uint8_t *from, size_t count, uint8_t *to, size_t bytes);

bool masu_image_is_exr(const uint8_t *bytes, size_t count);

#endif

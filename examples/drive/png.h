/* png.h: pictures to files, without a heap. */
#ifndef DRIVE_PNG_H
#define DRIVE_PNG_H

#include <stdbool.h>
#include <stdint.h>

/* Rows of 4 bytes a pixel, blue first if `bgr`; the fourth is left out. False, with a line on stderr: it
 * could not be written. */
bool png_write(const char *path, const uint8_t *pixels, uint32_t width, uint32_t height, bool bgr);

#endif

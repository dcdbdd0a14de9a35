/* image.h: reads and writes images: 8-bit RGBA as PNG, floats as PFM and OpenEXR. Writes JPEG.
 *
 * Host side only; the library itself does no I/O. Every function returns true on success. On
 * failure it returns false, leaves its output empty, and writes one line, without a newline, with
 * the file and the reason to `error` (may be NULL with size 0).
 *
 * Writes are atomic: the bytes go to a new file next to the target, which is then renamed to the
 * target. A crash, a full disk or a failed write leaves the old file or none, never a partial file,
 * and no temporary file. Symbolic links are followed; a target that is not a regular file
 * (/dev/null, a pipe with a reader) is written directly.
 *
 * Pixels are tightly packed, top row first. Memory is from malloc: free with masu_image_free. */
#ifndef MASU_PLATFORM_IMAGE_H
#define MASU_PLATFORM_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Larger images are rejected before any allocation. */
#define MASU_IMAGE_SIDE_MAX 16384u
#define MASU_IMAGE_PIXELS_MAX (64u * 1024u * 1024u)
#define MASU_IMAGE_FILE_BYTES_MAX (1024u * 1024u * 1024u)

struct masu_image {
    uint32_t width, height; /* pixels */
    uint32_t channels;      /* 4 in rgba, 1 or 3 in values */
    uint8_t *rgba;          /* 8-bit image, or NULL */
    float *values;          /* float image, or NULL */
};

/* Releases the pixels and zeroes the struct; harmless on a zeroed one. */
void masu_image_free(struct masu_image *image);

/* Every kind of PNG (palette, grey, 16 bits, interlaced) becomes 8-bit RGBA; without an alpha
 * channel alpha is 255. Unlike most readers this one verifies the chunks' checksums. */
bool masu_image_load_png(const char *path, struct masu_image *image, char *error,
                         size_t error_size);

/* The same for a file in memory; the path is for messages. */
bool masu_image_decode_png(const char *path, const uint8_t *bytes, size_t count,
                           struct masu_image *image, char *error, size_t error_size);

/* The size in the header of a complete file within the limits; nothing is decoded. */
bool masu_image_png_size(const char *path, const uint8_t *bytes, size_t count, uint32_t *width,
                         uint32_t *height, char *error, size_t error_size);

/* 16-bit grey values, width * height, freed by free(). On NULL `error` has the reason. */
uint16_t *masu_image_decode_gray(const char *path, const uint8_t *bytes, size_t count,
                                 uint32_t *width, uint32_t *height, char *error, size_t error_size);

/* rgba: height rows of width * 4 bytes, row_bytes apart (0 = tightly packed). */
bool masu_image_save_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                         size_t row_bytes, char *error, size_t error_size);

/* JPEG in memory, without alpha; quality 1 to 100. Returns the bytes that it needs, of which the
 * first `most` are in `bytes`. 0: the size or the quality is not allowed. */
size_t masu_image_encode_jpeg(const uint8_t *rgba, uint32_t width, uint32_t height, int quality,
                              uint8_t *bytes, size_t most);

/* PFM: 1 channel ("Pf") or 3 ("PF"), 32-bit floats of either byte order, with bits unchanged
 * (including NaN; the magnitude of the scale is not applied). Writes little-endian. */
bool masu_image_load_pfm(const char *path, struct masu_image *image, char *error,
                         size_t error_size);
bool masu_image_save_pfm(const char *path, const float *values, uint32_t width, uint32_t height,
                         uint32_t channels, char *error, size_t error_size);

/* OpenEXR, scan lines of one part. Reads: channels R, G, B of half, float or integer (else Y as one
 * channel); no compression, RLE, ZIPS, ZIP. Writes: R, G, B as 32-bit floats without
 * compression. */
bool masu_image_decode_exr(const char *path, const uint8_t *bytes, size_t count,
                           struct masu_image *image, char *error, size_t error_size);
bool masu_image_save_exr(const char *path, const float *values, uint32_t width, uint32_t height,
                         char *error, size_t error_size);

/* Extensions of images that programs write: linear light (scene-linear RGB of BT.709 before
 * exposure and tone curve) in PFM and OpenEXR, 8-bit sRGB in PNG. */
#define MASU_IMAGE_ENDS ".png .pfm .exr"
/* Whether the extension is one of linear light. */
bool masu_image_is_linear(const char *path);
/* Three floats per pixel, in the format of the extension: .exr, else PFM. */
bool masu_image_save_linear(const char *path, const float *values, uint32_t width, uint32_t height,
                            char *error, size_t error_size);
/* Reads PNG to rgba, PFM and OpenEXR to values, recognised by content. */
bool masu_image_load(const char *path, struct masu_image *image, char *error, size_t error_size);

/* Whether the path exists. */
bool masu_file_exists(const char *path);
bool masu_file_is_regular(const char *path);

/* Whether a file can be written there at present; creates nothing. A FIFO needs a reader, and
 * remains open. */
bool masu_file_writable(const char *path, char *error, size_t error_size);

/* Creates a folder and its parents; an existing one must be writable. */
bool masu_folder_make(const char *path, char *error, size_t error_size);

/* Writes any file atomically, like the save functions (statistics, baked scenes). */
bool masu_file_write(const char *path, const void *bytes, size_t count, char *error,
                     size_t error_size);

/* Reads a whole file into one malloc'ed block, at most `limit` bytes. An empty file is not an
 * error; anything but a regular file is, and is not waited for. */
bool masu_file_read(const char *path, size_t limit, uint8_t **bytes, size_t *count, char *error,
                    size_t error_size);

#endif

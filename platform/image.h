/*
 * image.h: images in files: 8-bit RGBA as PNG, floats as PFM and OpenEXR.
 *
 * Host side only; the library itself does no I/O. Every function returns true on success. On
 * failure it returns false, leaves its output empty, and writes one line, without a newline, that
 * names the file and the reason into `error` (may be NULL with size 0).
 *
 * Writes are atomic: the bytes go to a new file beside the target, which is then renamed over it. A
 * crash, a full disk or a failed write leaves the old file, or none, never half a file, and removes
 * the temporary one. A symbolic link is followed; something that is not a regular file (/dev/null,
 * a pipe with a reader) is written straight.
 *
 * Pixels are tightly packed, top row first. Memory comes from malloc: free with masu_image_free.
 */
#ifndef MASU_PLATFORM_IMAGE_H
#define MASU_PLATFORM_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Larger pictures are refused before anything is allocated for them. */
#define MASU_IMAGE_SIDE_MAX 16384u
#define MASU_IMAGE_PIXELS_MAX (64u * 1024u * 1024u)
#define MASU_IMAGE_FILE_BYTES_MAX (1024u * 1024u * 1024u)

struct masu_image {
    uint32_t width, height; /* pixels */
    uint32_t channels;      /* 4 in rgba, 1 or 3 in values */
    uint8_t *rgba;          /* 8-bit picture, or NULL */
    float *values;          /* float picture, or NULL */
};

/* Releases the pixels and zeroes the struct; harmless on a zeroed one. */
void masu_image_free(struct masu_image *image);

/* Any PNG kind (palette, grey, 16 bits, interlaced) arrives as 8-bit RGBA; without an alpha channel
 * alpha is 255. Unlike most readers this one checks the chunks' checksums. */
bool masu_image_load_png(const char *path, struct masu_image *image, char *error,
                         size_t error_size);

/* The same of a file's bytes; the path is for messages. */
bool masu_image_decode_png(const char *path, const uint8_t *bytes, size_t count, struct masu_image *image,
                           char *error, size_t error_size);

/* Of a file that is whole and within the limits; nothing is decoded. */
bool masu_image_png_size(const char *path, const uint8_t *bytes, size_t count, uint32_t *width, uint32_t *height,
                         char *error, size_t error_size);

/* Grey values of 16 bits, width * height, freed by free(); NULL: `error` says why. */
uint16_t *masu_image_decode_gray(const char *path, const uint8_t *bytes, size_t count, uint32_t *width,
                                 uint32_t *height, char *error, size_t error_size);

/* rgba: height rows of width * 4 bytes, row_bytes apart (0 = tightly packed). */
bool masu_image_save_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height,
                         size_t row_bytes, char *error, size_t error_size);

/* PFM: 1 channel ("Pf") or 3 ("PF"), 32-bit floats of either byte order, kept bit for bit (NaN too;
 * the scale's magnitude is not applied). Written little-endian. */
bool masu_image_load_pfm(const char *path, struct masu_image *image, char *error,
                         size_t error_size);
bool masu_image_save_pfm(const char *path, const float *values, uint32_t width, uint32_t height,
                         uint32_t channels, char *error, size_t error_size);

/* OpenEXR, scan lines of one part. Read: channels R, G, B of half, float or integer (else Y as one
 * channel); no compression, RLE, ZIPS, ZIP. Written: R, G, B as 32-bit floats without
 * compression. */
bool masu_image_decode_exr(const char *path, const uint8_t *bytes, size_t count,
                           struct masu_image *image, char *error, size_t error_size);
bool masu_image_save_exr(const char *path, const float *values, uint32_t width, uint32_t height,
                         char *error, size_t error_size);

/* Ends of the names of images that programs write: linear light (scene-linear RGB of BT.709 before
 * exposure and tone curve) in PFM and OpenEXR, 8 bits of sRGB in PNG. */
#define MASU_IMAGE_ENDS ".png .pfm .exr"
/* Whether a file of that name has linear light. */
bool masu_image_is_linear(const char *path);
/* Three floats a pixel, in the format that the name says: .exr, else PFM. */
bool masu_image_save_linear(const char *path, const float *values, uint32_t width, uint32_t height,
                            char *error, size_t error_size);
/* PNG to rgba, PFM and OpenEXR to values, recognised by their content. */
bool masu_image_load(const char *path, struct masu_image *image, char *error, size_t error_size);

/* Whether there is something of this name. */
bool masu_file_exists(const char *path);
bool masu_file_is_regular(const char *path);

/* Whether a file could be written there at present; leaves nothing behind. A FIFO needs a reader,
 * and stays open. */
bool masu_file_writable(const char *path, char *error, size_t error_size);

/* Makes a folder and those above it; one that is there must be writable. */
bool masu_folder_make(const char *path, char *error, size_t error_size);

/* What the save functions end with, for other files (statistics, baked scenes). */
bool masu_file_write(const char *path, const void *bytes, size_t count, char *error,
                     size_t error_size);

/* The whole file in one malloc'ed block, at most limit bytes. An empty file is not an error;
 * anything but a regular file is, without waiting for it. */
bool masu_file_read(const char *path, size_t limit, uint8_t **bytes, size_t *count, char *error,
                    size_t error_size);

#endif

/* image.c: see image.h. Order: files, then PNG, then PFM. exr.c: OpenEXR.
 * image_write.c: writers of PNG and JPEG.
 *
 * stb decodes PNG. It trusts chunk lengths too much for untrusted files and ignores
 * checksums. So the chunks are validated here first; the decoder only receives files that are
 * complete and whose header is within the limits. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 /* realpath, fsync */
#endif

#include "image.h"
#include "atomic_file.h"
#include "file_kind.h"
#include "image_parts.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* A few kilobytes of PNG can decompress to any size. 16-bit RGBA of the largest size is half
 * this. */
#define DECODER_BYTES_MAX ((size_t)1 << 30)

static void *bounded_realloc(void *block, size_t bytes) {
    return bytes > DECODER_BYTES_MAX ? NULL : realloc(block, bytes);
}

/* Hidden: a shared library in the process may contain its own stb, built with other options, which
 * must not resolve to this one. */
#if defined(__GNUC__)
#define STBIDEF extern __attribute__((visibility("hidden")))
#else
#define STBIDEF extern
#endif

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_MAX_DIMENSIONS (1 << 14)
#define STBI_MALLOC(bytes) bounded_realloc(NULL, bytes)
#define STBI_REALLOC(block, bytes) bounded_realloc(block, bytes)
#define STBI_FREE(block) free(block)
#include <stb/stb_image.h>

_Static_assert(MASU_IMAGE_SIDE_MAX == STBI_MAX_DIMENSIONS, "one limit, stated twice");

#define fail masu_image_fail
#define size_is_allowed masu_image_size_allowed

bool masu_image_fail(char *error, size_t error_size, const char *format, ...) {
    if (error && error_size) {
        va_list arguments;
        va_start(arguments, format);
        (void)vsnprintf(error, error_size, format, arguments);
        va_end(arguments);
    }
    return false;
}

void masu_image_free(struct masu_image *image) {
    free(image->rgba);
    free(image->values);
    *image = (struct masu_image){0};
}

bool masu_image_size_allowed(const char *path, uint32_t width, uint32_t height, char *error,
                            size_t error_size) {
    if (width == 0 || height == 0) {
        return fail(error, error_size, "%s: the image is empty (%ux%u)", path, width, height);
    }
    if (width > MASU_IMAGE_SIDE_MAX || height > MASU_IMAGE_SIDE_MAX) {
        return fail(error, error_size, "%s: %ux%u is larger than %u pixels per side", path, width,
                    height, MASU_IMAGE_SIDE_MAX);
    }
    if ((uint64_t)width * height > MASU_IMAGE_PIXELS_MAX) {
        return fail(error, error_size, "%s: %ux%u is more than %u pixels", path, width, height,
                    MASU_IMAGE_PIXELS_MAX);
    }
    return true;
}

/* ---- files ---- */

/* Reads until `count` bytes or the end of the file; returns the number of bytes, or -1 with errno
 * set. */
static ssize_t read_up_to(int file, uint8_t *bytes, size_t count) {
    size_t done = 0;
    while (done < count) {
        ssize_t n = read(file, bytes + done, count - done);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n < 0) {
            return -1;
        }
        if (n == 0) {
            break;
        }
        done += (size_t)n;
    }
    return (ssize_t)done;
}

bool masu_file_exists(const char *path) {
    struct stat info;
    return stat(path, &info) == 0;
}

bool masu_file_is_regular(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode);
}

bool masu_file_read(const char *path, size_t limit, uint8_t **bytes, size_t *count, char *error,
                    size_t error_size) {
    *bytes = NULL;
    *count = 0;
    int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC); /* a FIFO must not block */
    if (file < 0) {
        return fail(error, error_size, "%s: cannot open: %s", path, strerror(errno));
    }
    struct stat info;
    if (fstat(file, &info) != 0 || !S_ISREG(info.st_mode)) {
        (void)close(file);
        return fail(error, error_size, "%s: is not a regular file", path);
    }
    if (info.st_size < 0 || (uintmax_t)info.st_size > limit) {
        (void)close(file);
        return fail(error, error_size, "%s: %jd bytes, more than the limit of %zu", path,
                    (intmax_t)info.st_size, limit);
    }
    size_t size = (size_t)info.st_size;
    uint8_t *block = malloc(size ? size : 1);
    ssize_t got = block ? read_up_to(file, block, size) : -1;
    int why = block ? errno : ENOMEM;
    (void)close(file);
    if (got < 0) {
        free(block);
        return fail(error, error_size, "%s: cannot read: %s", path, strerror(why));
    }
    *bytes = block;
    *count = (size_t)got; /* fewer than size if the file shrank meanwhile */
    return true;
}

static bool write_all(int file, const uint8_t *bytes, size_t count) {
    size_t done = 0;
    while (done < count) {
        ssize_t n = write(file, bytes + done, count - done);
        if (n < 0 && errno == EINTR) {
            continue;
        }
        if (n <= 0) {
            return false;
        }
        done += (size_t)n;
    }
    return true;
}

/* A FIFO without a reader fails with ENXIO instead of blocking. */
static int open_straight(const char *path, char *error, size_t error_size) {
    struct stat info;
    int file = open(path, O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) {
        const char *why = strerror(errno);
        bool lonely = errno == ENXIO && stat(path, &info) == 0 && S_ISFIFO(info.st_mode);
        (void)fail(error, error_size, "%s: cannot write: %s", path,
                   lonely ? "no program reads from this FIFO" : why);
    } else {
        (void)fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
    }
    return file;
}

static bool write_straight(const char *path, const void *bytes, size_t count, char *error,
                           size_t error_size) {
    int file = open_straight(path, error, error_size);
    if (file < 0) {
        return false;
    }
    bool good = write_all(file, bytes, count);
    int why = errno;
    if (close(file) != 0 && good) {
        good = false;
        why = errno;
    }
    return good || fail(error, error_size, "%s: cannot write: %s", path, strerror(why));
}

/* Leaves no temporary files behind: atomic_file.h. */
static bool write_beside_and_rename(const char *path, const char *target, const void *bytes,
                                    size_t count, char *error, size_t error_size) {
    masu_atomic_file draft;
    int problem = masu_atomic_file_open(&draft, target);
    if (!problem) {
        problem = masu_atomic_file_write(&draft, bytes, count);
        if (problem)
            masu_atomic_file_discard(&draft);
        else
            problem = masu_atomic_file_commit(&draft, target);
    }
    return !problem || fail(error, error_size, "%s: cannot write: %s", path, strerror(problem));
}

/* Checks for obstacles before writing. */
static bool may_write(const char *path, bool *exists, bool *special, char *error,
                      size_t error_size) {
    struct stat info;
    *exists = stat(path, &info) == 0;
    *special = *exists && !S_ISREG(info.st_mode);
    if (*exists && S_ISDIR(info.st_mode))
        return fail(error, error_size, "%s: cannot write: it is a directory", path);
    /* Renaming over a read-only file would succeed, against its owner's intention. */
    if (*exists && access(path, W_OK) != 0)
        return fail(error, error_size, "%s: cannot write: %s", path, strerror(errno));
    return true;
}

bool masu_folder_make(const char *path, char *error, size_t error_size) {
    char *at = strdup(path);
    if (!at) return fail(error, error_size, "%s: out of memory", path);
    bool good = true;
    for (char *end = at; good && (end = strchr(end + 1, '/'));) {
        *end = '\0';
        good = mkdir(at, 0777) == 0 || errno == EEXIST;
        *end = '/';
    }
    good = good && (mkdir(at, 0777) == 0 || errno == EEXIST);
    int problem = good ? 0 : errno;
    free(at);
    struct stat info;
    if (good && (stat(path, &info) != 0 || !S_ISDIR(info.st_mode))) problem = ENOTDIR;
    if (!problem && access(path, W_OK | X_OK) != 0) problem = errno;
    return !problem || fail(error, error_size, "%s: cannot create the folder or write to it: %s",
                            path, strerror(problem));
}

bool masu_file_writable(const char *path, char *error, size_t error_size) {
    bool exists, special;
    if (!may_write(path, &exists, &special, error, error_size)) return false;
    /* Left open: closing a FIFO would end its reader's input. */
    if (special) return open_straight(path, error, error_size) >= 0;
    char *resolved = exists ? realpath(path, NULL) : NULL;
    masu_atomic_file draft;
    int problem = masu_atomic_file_open(&draft, resolved ? resolved : path);
    if (!problem) masu_atomic_file_discard(&draft);
    free(resolved);
    return !problem || fail(error, error_size, "%s: cannot write: %s", path, strerror(problem));
}

bool masu_file_write(const char *path, const void *bytes, size_t count, char *error,
                     size_t error_size) {
    bool exists, special;
    if (!may_write(path, &exists, &special, error, error_size)) return false;
    if (special) return write_straight(path, bytes, count, error, error_size);
    char *resolved = exists ? realpath(path, NULL) : NULL;
    bool good =
        write_beside_and_rename(path, resolved ? resolved : path, bytes, count, error, error_size);
    free(resolved);
    return good;
}

/* ---- PNG ---- */

static uint32_t big_endian(const uint8_t *p) {
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* CRC-32 of ISO 3309, four bits at a time, which keeps the table small. */
static uint32_t crc32_of(const uint8_t *bytes, size_t count) {
    static const uint32_t nibble[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u,
        0x4DB26158u, 0x5005713Cu, 0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu,
        0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu,
    };
    uint32_t crc = 0xFFFFFFFFu;
    for (size_t i = 0; i < count; i++) {
        crc ^= bytes[i];
        crc = crc >> 4 ^ nibble[crc & 15u];
        crc = crc >> 4 ^ nibble[crc & 15u];
    }
    return ~crc;
}

/* A chunk is length, name, data, checksum of name and data. */
static bool chunk_is_whole(const char *path, const uint8_t *chunk, size_t left, char *error,
                           size_t error_size) {
    if (left < 12 || big_endian(chunk) > left - 12) {
        return fail(error, error_size, "%s: the PNG file is truncated", path);
    }
    size_t data = big_endian(chunk);
    if (crc32_of(chunk + 4, data + 4) != big_endian(chunk + 8 + data)) {
        return fail(error, error_size, "%s: the PNG file is damaged (wrong checksum)", path);
    }
    return true;
}

/* Checks the IHDR chunk: its size, its position as first chunk, and the limits of the image. */
static bool header_is_allowed(const char *path, const uint8_t *chunk, char *error,
                              size_t error_size) {
    if (memcmp(chunk + 4, "IHDR", 4) != 0 || big_endian(chunk) != 13) {
        return fail(error, error_size, "%s: the PNG file does not begin with its header", path);
    }
    return size_is_allowed(path, big_endian(chunk + 8), big_endian(chunk + 12), error, error_size);
}

static bool png_is_whole(const char *path, const uint8_t *bytes, size_t count, char *error,
                         size_t error_size) {
    static const uint8_t signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
    if (count < 8 || memcmp(bytes, signature, 8) != 0) {
        return fail(error, error_size, "%s: is not a PNG file%s", path,
                    masu_file_hint(path, bytes, count, MASU_FILE_IMAGE));
    }
    for (size_t at = 8;;) {
        const uint8_t *chunk = bytes + at;
        if (!chunk_is_whole(path, chunk, count - at, error, error_size)) {
            return false;
        }
        if (at == 8 && !header_is_allowed(path, chunk, error, error_size)) {
            return false;
        }
        if (memcmp(chunk + 4, "IEND", 4) == 0) {
            return true;
        }
        at += (size_t)big_endian(chunk) + 12;
    }
}

bool masu_image_decode_png(const char *path, const uint8_t *bytes, size_t count,
                           struct masu_image *image, char *error, size_t error_size) {
    int width = 0, height = 0;
    *image = (struct masu_image){0};
    if (!png_is_whole(path, bytes, count, error, error_size)) {
        return false;
    }
    uint8_t *rgba = stbi_load_from_memory(bytes, (int)count, &width, &height, NULL, 4);
    if (!rgba) {
        return fail(error, error_size, "%s: cannot decode the PNG file: %s", path,
                    stbi_failure_reason());
    }
    image->width = (uint32_t)width;
    image->height = (uint32_t)height;
    image->channels = 4;
    image->rgba = rgba; /* stb allocates with malloc */
    return true;
}

bool masu_image_png_size(const char *path, const uint8_t *bytes, size_t count, uint32_t *width,
                         uint32_t *height, char *error, size_t error_size) {
    if (!png_is_whole(path, bytes, count, error, error_size)) {
        return false;
    }
    *width = big_endian(bytes + 16);
    *height = big_endian(bytes + 20);
    return true;
}

uint16_t *masu_image_decode_gray(const char *path, const uint8_t *bytes, size_t count,
                                 uint32_t *width, uint32_t *height, char *error,
                                 size_t error_size) {
    int w = 0, h = 0;
    if (!png_is_whole(path, bytes, count, error, error_size)) {
        return NULL;
    }
    uint16_t *values = stbi_load_16_from_memory(bytes, (int)count, &w, &h, NULL, 1);
    if (!values) {
        (void)fail(error, error_size, "%s: cannot decode the PNG file: %s", path,
                   stbi_failure_reason());
        return NULL;
    }
    *width = (uint32_t)w;
    *height = (uint32_t)h;
    return values;
}

bool masu_image_load_png(const char *path, struct masu_image *image, char *error,
                         size_t error_size) {
    uint8_t *bytes;
    size_t count;
    *image = (struct masu_image){0};
    if (!masu_file_read(path, MASU_IMAGE_FILE_BYTES_MAX, &bytes, &count, error, error_size)) {
        return false;
    }
    bool good = masu_image_decode_png(path, bytes, count, image, error, error_size);
    free(bytes);
    return good;
}

/* ---- PFM ---- */

#define PFM_HEADER_MAX 64 /* "PF\n16384 16384\n-1.0\n" needs 22 */

struct pfm_header {
    uint32_t width, height, channels;
    bool big;      /* byte order of the samples */
    size_t length; /* of the header, bytes */
};

/* The header is text: kind, width, height, scale, each followed by white space, then the
 * samples. */
static bool parse_pfm(const uint8_t *bytes, size_t count, struct pfm_header *header) {
    char text[PFM_HEADER_MAX + 1];
    size_t kept = count < PFM_HEADER_MAX ? count : PFM_HEADER_MAX;
    memcpy(text, bytes, kept);
    text[kept] = '\0';

    char kind;
    unsigned long width, height;
    float scale;
    int used = 0;
    if (sscanf(text, "P%c %9lu %9lu %15f%n", &kind, &width, &height, &scale, &used) != 4) {
        return false;
    }
    char ended_by = text[used];
    bool ended = ended_by == '\n' || ended_by == ' ' || ended_by == '\t' || ended_by == '\r';
    bool signless = !(scale < 0.0f || scale > 0.0f); /* its sign is the byte order */
    if ((kind != 'F' && kind != 'f') || !ended || signless) {
        return false;
    }
    header->width = (uint32_t)width;
    header->height = (uint32_t)height;
    header->channels = kind == 'F' ? 3 : 1;
    header->big = scale > 0.0f;
    header->length = (size_t)used + 1;
    return true;
}

static uint32_t sample_bits(const uint8_t *p, bool big) {
    if (big) {
        return big_endian(p);
    }
    return (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0];
}

static bool decode_pfm(const char *path, const uint8_t *bytes, size_t count,
                       struct masu_image *image, char *error, size_t error_size) {
    struct pfm_header header;
    if (!parse_pfm(bytes, count, &header)) {
        return fail(error, error_size, "%s: is not a PFM file%s", path,
                    masu_file_hint(path, bytes, count, MASU_FILE_IMAGE));
    }
    if (!size_is_allowed(path, header.width, header.height, error, error_size)) {
        return false;
    }
    size_t row = (size_t)header.width * header.channels;
    size_t needed = row * header.height * 4;
    size_t given = count - header.length;
    if (given != needed) {
        return fail(error, error_size, "%s: a %ux%u PFM file needs %zu bytes of samples, has %zu",
                    path, header.width, header.height, needed, given);
    }
    float *values = malloc(needed);
    if (!values) {
        return fail(error, error_size, "%s: out of memory for %zu bytes", path, needed);
    }
    const uint8_t *sample = bytes + header.length;
    for (uint32_t y = 0; y < header.height; y++) {
        float *out = values + row * (header.height - 1 - y); /* the file starts at the bottom */
        for (size_t i = 0; i < row; i++, sample += 4) {
            uint32_t bits = sample_bits(sample, header.big);
            memcpy(&out[i], &bits, 4);
        }
    }
    image->width = header.width;
    image->height = header.height;
    image->channels = header.channels;
    image->values = values;
    return true;
}

bool masu_image_load_pfm(const char *path, struct masu_image *image, char *error,
                         size_t error_size) {
    *image = (struct masu_image){0};
    uint8_t *bytes;
    size_t count;
    if (!masu_file_read(path, MASU_IMAGE_FILE_BYTES_MAX, &bytes, &count, error, error_size)) {
        return false;
    }
    bool good = decode_pfm(path, bytes, count, image, error, error_size);
    free(bytes);
    return good;
}

bool masu_image_save_pfm(const char *path, const float *values, uint32_t width, uint32_t height,
                         uint32_t channels, char *error, size_t error_size) {
    if (!size_is_allowed(path, width, height, error, error_size)) {
        return false;
    }
    if (channels != 1 && channels != 3) {
        return fail(error, error_size, "%s: a PFM file has 1 or 3 channels, not %u", path,
                    channels);
    }
    char header[PFM_HEADER_MAX];
    int length = snprintf(header, sizeof header, "%s\n%u %u\n-1.0\n", channels == 3 ? "PF" : "Pf",
                          width, height);
    size_t row = (size_t)width * channels;
    size_t count = (size_t)length + row * height * 4;
    uint8_t *bytes = malloc(count);
    if (!bytes) {
        return fail(error, error_size, "%s: out of memory for %zu bytes", path, count);
    }
    memcpy(bytes, header, (size_t)length);
    uint8_t *sample = bytes + length;
    for (uint32_t y = height; y-- > 0;) {
        for (size_t i = 0; i < row; i++, sample += 4) {
            uint32_t bits;
            memcpy(&bits, &values[row * y + i], 4);
            for (int b = 0; b < 4; b++) {
                sample[b] = (uint8_t)(bits >> (8 * b));
            }
        }
    }
    bool good = masu_file_write(path, bytes, count, error, error_size);
    free(bytes);
    return good;
}

/* ---- Any format ---- */

bool masu_image_inflate(const uint8_t *from, size_t count, uint8_t *to, size_t bytes) {
    return count <= INT32_MAX && bytes <= INT32_MAX &&
           stbi_zlib_decode_buffer((char *)to, (int)bytes, (const char *)from, (int)count) ==
               (int)bytes;
}

bool masu_image_is_linear(const char *path) {
    size_t n = strlen(path);
    return n > 4 && (!strcasecmp(path + n - 4, ".pfm") || !strcasecmp(path + n - 4, ".exr"));
}

bool masu_image_save_linear(const char *path, const float *values, uint32_t width, uint32_t height,
                            char *error, size_t error_size) {
    size_t n = strlen(path);
    return n > 4 && !strcasecmp(path + n - 4, ".exr")
               ? masu_image_save_exr(path, values, width, height, error, error_size)
               : masu_image_save_pfm(path, values, width, height, 3, error, error_size);
}

bool masu_image_load(const char *path, struct masu_image *image, char *error, size_t error_size) {
    *image = (struct masu_image){0};
    uint8_t *bytes;
    size_t count;
    if (!masu_file_read(path, MASU_IMAGE_FILE_BYTES_MAX, &bytes, &count, error, error_size)) {
        return false;
    }
    struct pfm_header header;
    bool good = masu_image_is_exr(bytes, count)
                    ? masu_image_decode_exr(path, bytes, count, image, error, error_size)
                : parse_pfm(bytes, count, &header) || (count > 2 && !memcmp(bytes, "PF", 2))
                    ? decode_pfm(path, bytes, count, image, error, error_size)
                    : masu_image_decode_png(path, bytes, count, image, error, error_size);
    free(bytes);
    return good;
}

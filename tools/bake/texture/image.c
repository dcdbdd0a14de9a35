/* image.c: see image.h. The child writes a header to the pipe, then the texels or the text of the
 * error. */
#define _POSIX_C_SOURCE 200809L
#include "bake/texture/image.h"
#include "bake/base/file.h"
#include "bake/base/process.h"
#include "cli/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include <wand/MagickWand.h>

typedef struct head {
    uint32_t width, height; /* 0: error text follows */
    uint32_t whole[2], bits; /* as in masu_bake_picture */
} head;

const char *masu_bake_image_format(const unsigned char *data, size_t bytes, const char *name) {
    static const struct {
        const char *format, *magic;
        size_t offset, length;
    } rows[] = {{"PNG", "\x89PNG\r\n\x1A\n", 0, 8},
                {"JPEG", "\xFF\xD8\xFF", 0, 3},
                {"SGI", "\x01\xDA", 0, 2},
                {"DDS", "DDS ", 0, 4},
                {"BMP", "BM", 0, 2},
                {"GIF", "GIF8", 0, 4},
                {"TIFF", "II*\0", 0, 4},
                {"TIFF", "MM\0*", 0, 4},
                {"WEBP", "WEBP", 8, 4},
                {"PSD", "8BPS", 0, 4},
                {"PPM", "P6", 0, 2},
                {"PGM", "P5", 0, 2}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (bytes >= rows[i].offset + rows[i].length &&
            memcmp(data + rows[i].offset, rows[i].magic, rows[i].length) == 0) {
            return rows[i].format;
        }
    }
    size_t length = strlen(name);
    return bytes > 18 && length > 4 && strcasecmp(name + length - 4, ".tga") == 0 ? "TGA" : NULL;
}

/* ---- the child process ---- */

typedef struct job {
    const masu_bake_content *content;
    const masu_bake_image *image;
    const char *name, *directories;
    int sizes;
} job;

static void give_up(int fd, const char *why) {
    head h = {0};
    masu_bake_send(fd, &h, sizeof h);
    masu_bake_send(fd, why, strlen(why));
}

static FILE *open_regular(const char *path, off_t *bytes) {
    struct stat about;
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC); /* a FIFO must not block */
    if (fd < 0) return NULL;
    bool regular = fstat(fd, &about) == 0 && S_ISREG(about.st_mode);
    FILE *file = regular ? fdopen(fd, "rb") : NULL;
    if (!file) {
        if (!regular) errno = EINVAL;
        int cause = errno;
        close(fd);
        errno = cause;
        return NULL;
    }
    *bytes = about.st_size;
    return file;
}

/* Opens the file's own path, else the last part of its name in one of the directories: models often
 * contain paths of another machine. */
static FILE *find(const job *j, off_t *bytes) {
    FILE *file = j->image->outside ? NULL : open_regular(j->name, bytes);
    int cause = j->image->outside ? EACCES : errno;
    const char *slash = strrchr(j->name, '/'), *base = slash ? slash + 1 : j->name;
    for (const char *at = j->directories; !file && at && *at;) {
        size_t length = strcspn(at, ":");
        masu_bake_buffer path = {0};
        masu_bake_append(&path, at, length);
        masu_bake_append(&path, "/", 1);
        if (masu_bake_append_spelling(&path, base))
            file = open_regular((const char *)path.data, bytes);
        masu_bake_release(&path);
        at += length + (at[length] == ':');
    }
    if (!file) errno = cause;
    return file;
}

static unsigned char *read_bytes(const job *j, int fd, size_t *bytes) {
    off_t size = 0;
    FILE *file = find(j, &size);
    if (!file) {
        give_up(fd, j->image->outside
                        ? "is outside of its model's folder (--texture-path adds folders)"
                    : errno == EINVAL ? "not a regular file"
                                      : strerror(errno));
        return NULL;
    }
    if (size < 1 || (uint64_t)size > MASU_BAKE_IMAGE_BYTES) {
        give_up(fd, size < 1 ? "the file is empty" : "the file is larger than 256 MiB");
        return NULL;
    }
    unsigned char *data = malloc((size_t)size);
    if (!data || fread(data, 1, (size_t)size, file) != (size_t)size) {
        give_up(fd, "cannot be read to its end");
        return NULL;
    }
    *bytes = (size_t)size;
    return data;
}

static size_t power_near(size_t size) {
    size_t power = 1;
    while (power * 3 / 2 <= size && power < MASU_TEXTURE_SIZE_MAX) power *= 2;
    return power;
}

static void choose_size(int sizes, size_t *width, size_t *height) {
    if (sizes != MASU_BAKE_SIZE_KEPT) {
        *width = power_near(*width);
        *height = power_near(*height);
    }
    if (sizes == MASU_BAKE_SIZE_SQUARE) {
        if (*width < *height) *width = *height;
        *height = *width;
    }
    /* Both sides are scaled by the same factor, which keeps the aspect ratio. */
    size_t larger = *width > *height ? *width : *height;
    if (larger > MASU_TEXTURE_SIZE_MAX) {
        *width = *width * MASU_TEXTURE_SIZE_MAX / larger;
        *height = *height * MASU_TEXTURE_SIZE_MAX / larger;
    }
    if (*width < 1) *width = 1;
    if (*height < 1) *height = 1;
}

static void set_limits(void) {
    MagickSetResourceLimit(WidthResource, MASU_BAKE_IMAGE_SIDE);
    MagickSetResourceLimit(HeightResource, MASU_BAKE_IMAGE_SIDE);
    MagickSetResourceLimit(AreaResource, (MagickSizeType)1 << 26);
    MagickSetResourceLimit(MemoryResource, (MagickSizeType)1 << 30);
    MagickSetResourceLimit(MapResource, 0);
    MagickSetResourceLimit(DiskResource, 0);
    MagickSetResourceLimit(ThreadResource, 1);
}

static void complain(MagickWand *wand, int fd) {
    ExceptionType severity;
    char *text = MagickGetException(wand, &severity);
    char line[256];
    snprintf(line, sizeof line, "%s", text && *text ? text : "no reason is given");
    for (char *c = line; *c; c++) {
        if ((unsigned char)*c < 0x20) *c = ' ';
    }
    give_up(fd, line);
}

/* solid: the image has no alpha. For some of these, such as 24-bit TGA, ImageMagick returns
 * uninitialised memory as alpha. */
static void send_texels(MagickWand *wand, int sizes, bool solid, int fd) {
    size_t width = MagickGetImageWidth(wand), height = MagickGetImageHeight(wand);
    size_t w = width, h = height, bits = MagickGetImageDepth(wand);
    /* the bits that the values need */
    if (bits > 8) bits = MagickGetImageChannelDepth(wand, AllChannels);
    choose_size(sizes, &w, &h);
    unsigned char *texels = malloc(w * h * 4);
    if (!texels) {
        give_up(fd, "out of memory");
        return;
    }
    if (((w != width || h != height) &&
         MagickResizeImage(wand, w, h, BoxFilter, 1.0) == MagickFalse) ||
        MagickExportImagePixels(wand, 0, 0, w, h, "RGBA", CharPixel, texels) == MagickFalse) {
        complain(wand, fd);
        return;
    }
    for (size_t i = 0; i < w * h && (solid || !MagickGetImageAlphaChannel(wand)); i++)
        texels[4 * i + 3] = 255;
    head answer = {(uint32_t)w, (uint32_t)h, {0, 0}, bits > 8 ? (uint32_t)bits : 0};
    if (width > MASU_TEXTURE_SIZE_MAX || height > MASU_TEXTURE_SIZE_MAX) {
        answer.whole[0] = (uint32_t)width;
        answer.whole[1] = (uint32_t)height;
    }
    masu_bake_send(fd, &answer, sizeof answer);
    masu_bake_send(fd, texels, w * h * 4);
}

static void decode(const job *j, const unsigned char *data, size_t bytes, int fd) {
    MagickWandGenesis();
    set_limits();
    MagickWand *wand = NewMagickWand();
    if (j->image->raw_width) {
        if (MagickConstituteImage(wand, j->image->raw_width, j->image->raw_height, "BGRA",
                                  CharPixel, (void *)(uintptr_t)data) == MagickFalse) {
            complain(wand, fd);
        } else {
            send_texels(wand, j->sizes, false, fd);
        }
        return;
    }
    const char *format = masu_bake_image_format(data, bytes, j->name);
    if (!format) {
        bool ktx = bytes > 12 && memcmp(data, "\xABKTX 20\xBB\r\n\x1A\n", 12) == 0;
        give_up(fd, ktx ? "a KTX2 (Basis) image, which is not supported: use PNG, JPEG or WebP"
                        : "not an image in a supported format");
        return;
    }
    char forced[16];
    snprintf(forced, sizeof forced, "%s:", format);
    MagickSetFilename(wand, forced);
    MagickSetFormat(wand, format);
    if (MagickReadImageBlob(wand, data, bytes) == MagickFalse) {
        complain(wand, fd);
        return;
    }
    MagickSetFirstIterator(wand); /* the first of several images, such as mips */
    /* A TGA file may store its lowest row first and has a flag for it; ImageMagick does not flip
     * it. */
    if (!strcmp(format, "TGA")) MagickAutoOrientImage(wand);
    if (MagickGetImageColorspace(wand) == CMYKColorspace) {
        MagickTransformImageColorspace(wand, sRGBColorspace);
    }
    bool solid = !strcmp(format, "TGA") && bytes > 17 && data[data[1] == 1 ? 7 : 16] == 24;
    send_texels(wand, j->sizes, solid, fd);
}

static void read_in_child(void *argument, int fd) {
    const job *j = argument;
    size_t bytes = (size_t)j->image->data_bytes;
    const unsigned char *data = bytes ? j->content->image_data.data + j->image->data
                                      : read_bytes(j, fd, &bytes);
    if (data) decode(j, data, bytes, fd);
}

/* ---- the parent process ---- */

static bool warn(const char *name, const char *why) {
    masu_cli_warn("texture %s: %s; ignored", name, why);
    return false;
}

bool masu_bake_read_image(const masu_bake_content *content, uint32_t image, const char *directories,
                          int sizes, masu_bake_picture *picture) {
    const masu_bake_image *about = &MASU_BAKE_IMAGES(content)[image];
    const char *name = (const char *)content->image_text.data + about->name;
    job j = {content, about, name, directories, sizes};
    *picture = (masu_bake_picture){0};
    masu_bake_buffer *out = &picture->rgba;
    masu_bake_result result = masu_bake_fork(read_in_child, &j, MASU_BAKE_IMAGE_SECONDS, out);
    head h = {0};
    bool good = false;
    if (result.end == MASU_BAKE_TIMEOUT) {
        warn(name, "decoding took too long");
    } else if (result.end != MASU_BAKE_EXITED || result.code || out->bytes < sizeof h) {
        warn(name, "the decoder crashed or ran out of memory");
    } else {
        memcpy(&h, out->data, sizeof h);
        good = h.width > 0 && h.width <= MASU_TEXTURE_SIZE_MAX && h.height > 0 &&
               h.height <= MASU_TEXTURE_SIZE_MAX &&
               out->bytes == sizeof h + (size_t)h.width * h.height * 4;
        if (!good) {
            masu_bake_append(out, "", 1);
            warn(name, h.width ? "the decoder returned invalid data"
                               : (const char *)out->data + sizeof h);
        }
    }
    if (!good) {
        masu_bake_release(out);
        return false;
    }
    memmove(out->data, out->data + sizeof h, out->bytes - sizeof h);
    out->bytes -= sizeof h;
    picture->width = h.width;
    picture->height = h.height;
    picture->whole_width = h.whole[0];
    picture->whole_height = h.whole[1];
    picture->bits = h.bits;
    return true;
}

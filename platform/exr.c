/* exr.c: OpenEXR files of one part, scan lines, without compression or with RLE, ZIPS or ZIP
 * (OpenEXR "File Layout" of the Academy Software Foundation). Writes 32-bit floats B, G, R without
 * compression.
 *
 * Files are untrusted: every read of the header and of a chunk is bounded by the remaining
 * bytes. */
#include "image.h"
#include "image_parts.h"

#include "file_kind.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAGIC = 20000630, VERSION = 2, TILED = 0x200, DEEP = 0x800, PARTS = 0x1000 };
enum { CHANNELS_MAX = 64 };
enum { COMPRESSION_NONE, COMPRESSION_RLE, COMPRESSION_ZIPS, COMPRESSION_ZIP, COMPRESSIONS_READ };
enum { SAMPLE_UINT, SAMPLE_HALF, SAMPLE_FLOAT };

#define NAME_MAX_BYTES 256

/* ---- Writing --------------------------------------------------------------------------------- */

typedef struct writer {
    uint8_t *at;
} writer;

static void put(writer *w, const void *bytes, size_t count) {
    memcpy(w->at, bytes, count);
    w->at += count;
}

static void put_text(writer *w, const char *text) { put(w, text, strlen(text) + 1); }

static void put_number(writer *w, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) *w->at++ = (uint8_t)(value >> (8 * i));
}

static void put_attribute(writer *w, const char *name, const char *type, uint32_t bytes) {
    put_text(w, name);
    put_text(w, type);
    put_number(w, bytes, 4);
}

static void put_window(writer *w, const char *name, uint32_t width, uint32_t height) {
    put_attribute(w, name, "box2i", 16);
    put_number(w, 0, 8);
    put_number(w, width - 1, 4);
    put_number(w, height - 1, 4);
}

static void put_header(writer *w, uint32_t width, uint32_t height) {
    static const uint32_t one = 0x3F800000; /* 1.0f */
    put_number(w, MAGIC, 4);
    put_number(w, VERSION, 4);
    put_attribute(w, "channels", "chlist", 3 * 18 + 1);
    for (const char *name = "BGR"; *name; name++) {
        put(w, name, 1);
        put_number(w, 0, 1);
        put_number(w, SAMPLE_FLOAT, 4);
        put_number(w, 0, 4); /* not perceptually linear; reserved */
        put_number(w, 1, 4); /* sampling along x and y */
        put_number(w, 1, 4);
    }
    put_number(w, 0, 1);
    put_attribute(w, "compression", "compression", 1);
    put_number(w, COMPRESSION_NONE, 1);
    put_window(w, "dataWindow", width, height);
    put_window(w, "displayWindow", width, height);
    put_attribute(w, "lineOrder", "lineOrder", 1);
    put_number(w, 0, 1); /* top row first */
    put_attribute(w, "pixelAspectRatio", "float", 4);
    put_number(w, one, 4);
    put_attribute(w, "screenWindowCenter", "v2f", 8);
    put_number(w, 0, 8);
    put_attribute(w, "screenWindowWidth", "float", 4);
    put_number(w, one, 4);
    put_number(w, 0, 1);
}

bool masu_image_save_exr(const char *path, const float *values, uint32_t width, uint32_t height,
                         char *error, size_t error_size) {
    enum { HEADER_MAX = 512 };
    if (!masu_image_size_allowed(path, width, height, error, error_size)) return false;
    const size_t row = (size_t)width * 12, chunk = row + 8;
    uint8_t *bytes = malloc(HEADER_MAX + (8 + chunk) * height);
    if (!bytes)
        return masu_image_fail(error, error_size, "%s: out of memory for the OpenEXR file", path);
    writer w = {bytes};
    put_header(&w, width, height);
    const size_t first = (size_t)(w.at - bytes) + 8 * (size_t)height;
    for (uint32_t y = 0; y < height; y++) put_number(&w, first + chunk * y, 8);
    for (uint32_t y = 0; y < height; y++) {
        put_number(&w, y, 4);
        put_number(&w, row, 4);
        for (size_t c = 3; c-- > 0;) {
            for (size_t x = 0; x < width; x++) {
                uint32_t bits;
                memcpy(&bits, &values[3 * (width * (size_t)y + x) + c], 4);
                put_number(&w, bits, 4);
            }
        }
    }
    bool good = masu_file_write(path, bytes, (size_t)(w.at - bytes), error, error_size);
    free(bytes);
    return good;
}

/* ---- Reading the header ---------------------------------------------------------------------- */

typedef struct reader {
    const uint8_t *at, *end;
} reader;

typedef struct exr_channel {
    uint32_t type;
    int to; /* 0 to 2: R, G, B; 3: luminance; -1: not read */
} exr_channel;

typedef struct exr_header {
    exr_channel channels[CHANNELS_MAX];
    uint32_t channel_count, compression, width, height;
    int32_t left, top;
    size_t row; /* bytes of all channels */
    bool color;
    bool has_channels, has_compression, has_window;
} exr_header;

static uint32_t number_of(const uint8_t *p) {
    return (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | p[0];
}

static bool take(reader *r, size_t count, const uint8_t **out) {
    if ((size_t)(r->end - r->at) < count) return false;
    *out = r->at;
    r->at += count;
    return true;
}

static bool take_number(reader *r, uint32_t *out) {
    const uint8_t *p;
    if (!take(r, 4, &p)) return false;
    *out = number_of(p);
    return true;
}

static bool take_text(reader *r, const char **out) {
    size_t left = (size_t)(r->end - r->at);
    const uint8_t *end =
        left ? memchr(r->at, 0, left < NAME_MAX_BYTES ? left : NAME_MAX_BYTES) : NULL;
    if (!end) return false;
    *out = (const char *)r->at;
    r->at = end + 1;
    return true;
}

/* Returns false if damaged or subsampled. */
static bool read_channels(reader value, exr_header *h) {
    static const char *const names[] = {"R", "G", "B", "Y"};
    bool found[4] = {false};
    while (value.at < value.end && *value.at) {
        const char *name;
        const uint8_t *p;
        if (!take_text(&value, &name) || !take(&value, 16, &p) || h->channel_count == CHANNELS_MAX)
            return false;
        exr_channel *c = &h->channels[h->channel_count++];
        *c = (exr_channel){number_of(p), -1};
        if (c->type > SAMPLE_FLOAT || number_of(p + 8) != 1 || number_of(p + 12) != 1) return false;
        h->row += c->type == SAMPLE_HALF ? 2 : 4;
        for (int i = 0; i < 4; i++) {
            if (strcmp(name, names[i]) != 0) continue;
            c->to = i;
            found[i] = true;
        }
    }
    h->color = found[0] && found[1] && found[2];
    h->has_channels = h->color || found[3];
    return true;
}

static bool read_window(reader value, exr_header *h) {
    uint32_t v[4];
    for (int i = 0; i < 4; i++) {
        if (!take_number(&value, &v[i])) return false;
    }
    int64_t width = (int64_t)(int32_t)v[2] - (int32_t)v[0] + 1,
            height = (int64_t)(int32_t)v[3] - (int32_t)v[1] + 1;
    h->left = (int32_t)v[0];
    h->top = (int32_t)v[1];
    h->width = width > 0 && width < 1 << 30 ? (uint32_t)width : 0;
    h->height = height > 0 && height < 1 << 30 ? (uint32_t)height : 0;
    h->has_window = true;
    return true;
}

static bool read_header(reader *r, exr_header *h) {
    while (r->at < r->end && *r->at) {
        const char *name, *type;
        const uint8_t *p;
        uint32_t bytes;
        if (!take_text(r, &name) || !take_text(r, &type) || !take_number(r, &bytes) ||
            !take(r, bytes, &p))
            return false;
        reader value = {p, p + bytes};
        if (!strcmp(name, "channels") && (h->channel_count || !read_channels(value, h)))
            return false;
        if (!strcmp(name, "dataWindow") && !read_window(value, h)) return false;
        if (!strcmp(name, "compression") && bytes) h->compression = *p, h->has_compression = true;
    }
    const uint8_t *end;
    return take(r, 1, &end);
}

/* ---- Reading the samples --------------------------------------------------------------------- */

/* Signed counts: if negative, that many bytes follow; otherwise one byte is repeated count + 1
 * times. */
static bool unpack_runs(const uint8_t *from, size_t count, uint8_t *to, size_t bytes) {
    const uint8_t *end = from + count, *full = to + bytes;
    while (from < end) {
        int8_t n = (int8_t)*from++;
        size_t length = n < 0 ? (size_t)-n : (size_t)n + 1, needs = n < 0 ? length : 1;
        if ((size_t)(end - from) < needs || (size_t)(full - to) < length) return false;
        if (n < 0) memcpy(to, from, length);
        else memset(to, *from, length);
        from += needs;
        to += length;
    }
    return to == full;
}

/* Compressed chunks hold byte differences; even bytes come before odd ones. */
static void undo_prediction(const uint8_t *from, size_t bytes, uint8_t *to, uint8_t *last) {
    const size_t half = (bytes + 1) / 2;
    for (size_t i = 0; i < bytes; i++) {
        *last = (uint8_t)(i ? *last + from[i] - 128 : from[i]);
        to[i < half ? 2 * i : 2 * (i - half) + 1] = *last;
    }
}

static bool unpack(const exr_header *h, const uint8_t *from, size_t count, uint8_t *scratch,
                   uint8_t *to, size_t bytes) {
    uint8_t last = 0;
    /* Stored uncompressed if compression gains nothing. */
    if (count == bytes) return memcpy(to, from, bytes), true;
    if (h->compression == COMPRESSION_NONE || count > bytes) return false;
    bool good = h->compression == COMPRESSION_RLE ? unpack_runs(from, count, scratch, bytes)
                                                  : masu_image_inflate(from, count, scratch, bytes);
    if (good) undo_prediction(scratch, bytes, to, &last);
    return good;
}

static float half_value(uint32_t bits) {
    uint32_t sign = (bits & 0x8000u) << 16, exponent = bits >> 10 & 31u, mantissa = bits & 0x3FFu,
             out;
    if (exponent == 0) {
        float value = (float)mantissa * 0x1p-24f;
        return sign ? -value : value;
    }
    out = sign | (exponent == 31 ? 0x7F800000u : (exponent + 112u) << 23) | mantissa << 13;
    float value;
    memcpy(&value, &out, 4);
    return value;
}

static float sample_value(uint32_t type, const uint8_t *p) {
    if (type == SAMPLE_HALF) return half_value((uint32_t)p[1] << 8 | p[0]);
    uint32_t bits = number_of(p);
    float value = (float)bits;
    if (type == SAMPLE_FLOAT) memcpy(&value, &bits, 4);
    return value;
}

static void read_row(const exr_header *h, const uint8_t *row, float *out) {
    const uint32_t channels = h->color ? 3 : 1;
    for (uint32_t c = 0; c < h->channel_count; c++) {
        const exr_channel *channel = &h->channels[c];
        const size_t bytes = channel->type == SAMPLE_HALF ? 2 : 4;
        const int to = h->color ? channel->to : channel->to == 3 ? 0 : -1;
        for (size_t x = 0; x < h->width && to >= 0 && to < 3; x++)
            out[channels * x + (size_t)to] = sample_value(channel->type, row + bytes * x);
        row += bytes * h->width;
    }
}

static bool read_chunks(reader *r, const exr_header *h, uint8_t *scratch, float *values) {
    const uint32_t rows = h->compression == COMPRESSION_ZIP ? 16 : 1;
    const uint32_t chunks = (h->height + rows - 1) / rows;
    const size_t row = h->row * h->width;
    const uint8_t *p;
    /* The table of offsets is skipped: chunks contain their row. */
    if (!take(r, 8 * (size_t)chunks, &p)) return false;
    for (uint32_t i = 0; i < chunks; i++) {
        uint32_t y, bytes;
        if (!take_number(r, &y) || !take_number(r, &bytes) || !take(r, bytes, &p)) return false;
        y -= (uint32_t)h->top;
        if (y >= h->height || y % rows) return false;
        const uint32_t here = h->height - y < rows ? h->height - y : rows;
        uint8_t *plain = scratch + row * rows;
        if (!unpack(h, p, bytes, scratch, plain, row * here)) return false;
        for (uint32_t k = 0; k < here; k++)
            read_row(h, plain + row * k, values + (h->color ? 3 : 1) * (size_t)h->width * (y + k));
    }
    return true;
}

bool masu_image_is_exr(const uint8_t *bytes, size_t count) {
    return count >= 8 && number_of(bytes) == MAGIC;
}

/* One line about an unsupported feature; NULL: none. */
static const char *unread(uint32_t flags, const exr_header *h) {
    if ((flags & 0xFF) != VERSION) return "found another version of OpenEXR, expected 2";
    if (flags & TILED) return "found tiles, expected scan lines";
    if (flags & (DEEP | PARTS))
        return "found deep data or several parts, expected one part of scan lines";
    if (!h->has_channels) return "found no channels R, G, B or Y without subsampling";
    if (!h->has_window || !h->has_compression)
        return "the header has no dataWindow or no compression";
    if (h->compression >= COMPRESSIONS_READ)
        return "found another compression, expected none, RLE, ZIPS or ZIP";
    return NULL;
}

bool masu_image_decode_exr(const char *path, const uint8_t *bytes, size_t count,
                           struct masu_image *image, char *error, size_t error_size) {
    *image = (struct masu_image){0};
    if (!masu_image_is_exr(bytes, count)) {
        return masu_image_fail(error, error_size, "%s: is not an OpenEXR file%s", path,
                               masu_file_hint(path, bytes, count, MASU_FILE_IMAGE));
    }
    reader r = {bytes + 8, bytes + count};
    exr_header h;
    memset(&h, 0, sizeof h);
    uint32_t flags = number_of(bytes + 4);
    bool whole = read_header(&r, &h);
    const char *why =
        whole || flags & (TILED | DEEP | PARTS) ? unread(flags, &h) : "the header is damaged";
    if (why) return masu_image_fail(error, error_size, "%s: %s", path, why);
    if (!masu_image_size_allowed(path, h.width, h.height, error, error_size)) return false;
    size_t channels = h.color ? 3 : 1, row = h.row * h.width;
    if (row * h.height > MASU_IMAGE_FILE_BYTES_MAX || row * 16 > INT32_MAX)
        return masu_image_fail(error, error_size,
                               "%s: found %u channels of %ux%u, more than can be read", path,
                               h.channel_count, h.width, h.height);
    float *values = calloc(channels * h.width * h.height, sizeof *values);
    uint8_t *scratch = malloc(2 * row * 16);
    bool good = values && scratch;
    if (!good) (void)masu_image_fail(error, error_size, "%s: out of memory", path);
    else if (!read_chunks(&r, &h, scratch, values))
        good = masu_image_fail(error, error_size, "%s: the OpenEXR file is truncated or damaged",
                               path);
    free(scratch);
    if (!good) {
        free(values);
        return false;
    }
    *image = (struct masu_image){
        .width = h.width, .height = h.height, .channels = (uint32_t)channels, .values = values};
    return true;
}

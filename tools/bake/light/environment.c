/* environment.c: see environment.h.
 *
 * Mip m is for roughness m / (mips - 1): the image averaged by the GGX lobe of the mirror direction
 * at normal incidence, weighted by the cosine (Karis, Real Shading in Unreal Engine 4, SIGGRAPH
 * 2013 course). The lobe is importance-sampled. Each sample reads a mip of the unblurred map that
 * matches the distance between samples (Krivanek and Colbert, Real-time Shading with Filtered
 * Importance Sampling, EGSR 2008), so that a bright spot is neither missed nor aliased. */
#include "bake/light/environment.h"

#include "bake/base/file.h"
#include "bake/light/picture_light.h"
#include "cli/cli.h"
#include "image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLES 512
#define BYTES_MAX (512u * 1024u * 1024u)
#define RADIANCE_MAX MASU_BAKE_RADIANCE_MAX
#define PI MASU_BAKE_PI

/* ---- Files ----------------------------------------------------------------------------------- */

typedef struct rgbe_reader {
    const uint8_t *at, *end;
} rgbe_reader;

/* One line without its end. */
static bool next_line(rgbe_reader *r, char *line, size_t size) {
    size_t n = 0;
    while (r->at < r->end && *r->at != '\n') {
        if (n + 1 >= size) return false;
        line[n++] = (char)*r->at++;
    }
    if (r->at == r->end) return false;
    r->at++;
    line[n] = 0;
    return true;
}

/* One channel of a row in runs: a count above 128 repeats the next byte, others precede bytes. */
static bool read_runs(rgbe_reader *r, uint8_t *out, uint32_t width) {
    for (uint32_t x = 0; x < width;) {
        if (r->end - r->at < 2) return false;
        uint32_t count = *r->at++;
        if (count > 128) {
            count -= 128;
            if (count > width - x) return false;
            memset(out + x, *r->at++, count);
        } else {
            if (!count || count > width - x || (size_t)(r->end - r->at) < count) return false;
            memcpy(out + x, r->at, count);
            r->at += count;
        }
        x += count;
    }
    return true;
}

/* row: four channels of `width` bytes each. */
static bool read_row(rgbe_reader *r, uint8_t *row, uint32_t width) {
    if (r->end - r->at < 4) return false;
    if (width >= 8 && width < 32768 && r->at[0] == 2 && r->at[1] == 2 && !(r->at[2] & 128)) {
        if ((uint32_t)(r->at[2] << 8 | r->at[3]) != width) return false;
        r->at += 4;
        for (uint32_t c = 0; c < 4; c++)
            if (!read_runs(r, row + c * width, width)) return false;
        return true;
    }
    if ((size_t)(r->end - r->at) < 4 * (size_t)width) return false;
    for (uint32_t x = 0; x < width; x++)
        for (uint32_t c = 0; c < 4; c++) row[c * width + x] = *r->at++;
    return true;
}

static bool read_hdr(const char *path, rgbe_reader r, masu_bake_panorama *out) {
    char line[256];
    unsigned height = 0, width = 0;
    bool rgbe = false;
    if (!next_line(&r, line, sizeof line) || strncmp(line, "#?", 2) != 0)
        return masu_cli_error("%s: not a Radiance image", path), false;
    while (next_line(&r, line, sizeof line) && line[0])
        rgbe |= strcmp(line, "FORMAT=32-bit_rle_rgbe") == 0;
    if (!rgbe || !next_line(&r, line, sizeof line) ||
        sscanf(line, "-Y %u +X %u", &height, &width) != 2) {
        return masu_cli_error("%s: not an RGBE image with rows from top to bottom", path), false;
    }
    if (width < 1 || height < 1 || width > MASU_IMAGE_SIDE_MAX || height > MASU_IMAGE_SIDE_MAX)
        return masu_cli_error("%s: found %ux%u pixels, expected 1 to %u per side", path, width,
                              height, MASU_IMAGE_SIDE_MAX),
               false;
    out->rgb = calloc((size_t)width * height, 3 * sizeof(float));
    uint8_t *row = malloc(4 * (size_t)width);
    bool good = out->rgb && row;
    if (!good) masu_cli_error("%s: no memory for %ux%u pixels", path, width, height);
    for (uint32_t y = 0; y < height && good; y++) {
        good = read_row(&r, row, width);
        if (!good) masu_cli_error("%s: truncated or damaged in row %u of %u", path, y, height);
        for (uint32_t x = 0; x < width && good; x++) {
            float unit = row[3 * width + x] ? ldexpf(1.0f, row[3 * width + x] - 136) : 0.0f;
            for (uint32_t c = 0; c < 3; c++)
                out->rgb[3 * ((size_t)y * width + x) + c] = (float)row[c * width + x] * unit;
        }
    }
    free(row);
    out->width = width;
    out->height = height;
    return good;
}

static bool read_pfm(const char *path, masu_bake_panorama *out) {
    struct masu_image image;
    char error[1024];
    if (!masu_image_load_pfm(path, &image, error, sizeof error))
        return masu_cli_error("%s", error), false;
    size_t pixels = (size_t)image.width * image.height;
    out->width = image.width;
    out->height = image.height;
    out->rgb = malloc(3 * pixels * sizeof(float));
    for (size_t i = 0; i < 3 * pixels && out->rgb; i++)
        out->rgb[i] = image.values[image.channels == 3 ? i : i / 3];
    masu_image_free(&image);
    if (!out->rgb) masu_cli_error("%s: no memory", path);
    return out->rgb != NULL;
}

static bool ends_in(const char *path, const char *end) {
    size_t a = strlen(path), b = strlen(end);
    return a >= b && strcmp(path + a - b, end) == 0;
}

bool masu_bake_load_panorama(const char *path, masu_bake_panorama *out) {
    memset(out, 0, sizeof *out);
    out->factor = 1;
    out->name = path;
    bool good = false;
    if (ends_in(path, ".pfm")) {
        good = read_pfm(path, out);
    } else if (ends_in(path, ".hdr")) {
        masu_bake_buffer bytes = {0};
        good = masu_bake_read_file(path, BYTES_MAX, &bytes);
        const uint8_t *from = (const uint8_t *)bytes.data;
        if (good) good = read_hdr(path, (rgbe_reader){from, from + bytes.bytes}, out);
        free(bytes.data);
    } else {
        masu_cli_error("%s: expected a .hdr or .pfm file", path);
    }
    for (size_t i = 0; good && i < 3 * (size_t)out->width * out->height; i++) {
        good = out->rgb[i] >= 0.0f && isfinite(out->rgb[i]);
        if (!good) masu_cli_error("%s: pixel %zu is negative or not finite", path, i / 3);
    }
    if (!good) {
        free(out->rgb);
        out->rgb = NULL;
    }
    return good;
}

/* ---- Directions ------------------------------------------------------------------------------ */

/* From 0..1 on both axes (Cigolle et al., JCGT 3-2, 2014), +y at the centre. */
void masu_bake_octahedral(double x, double y, double out[3]) {
    double u = 2 * x - 1, v = 2 * y - 1, up = 1 - fabs(u) - fabs(v);
    if (up < 0) {
        double t = u;
        u = (1 - fabs(v)) * (u < 0 ? -1 : 1);
        v = (1 - fabs(t)) * (v < 0 ? -1 : 1);
    }
    double length = sqrt(u * u + v * v + up * up);
    out[0] = u / length;
    out[1] = up / length;
    out[2] = v / length;
}

static void octahedral_square(const double d[3], double out[2]) {
    double sum = fabs(d[0]) + fabs(d[1]) + fabs(d[2]);
    double u = d[0] / sum, v = d[2] / sum;
    if (d[1] < 0) {
        double t = u;
        u = (1 - fabs(v)) * (u < 0 ? -1 : 1);
        v = (1 - fabs(t)) * (v < 0 ? -1 : 1);
    }
    out[0] = 0.5 * u + 0.5;
    out[1] = 0.5 * v + 0.5;
}

void masu_bake_panorama_pixel(const masu_bake_panorama *p, uint32_t x, uint32_t y,
                              double direction[3], double *solid_angle) {
    double up = cos(PI * (y + 0.5) / p->height), flat = sqrt(fmax(1 - up * up, 0));
    double azimuth = p->turn + (0.5 - (x + 0.5) / p->width) * 2 * PI;
    direction[0] = flat * sin(azimuth);
    direction[1] = up;
    direction[2] = flat * cos(azimuth);
    *solid_angle = (cos(PI * y / p->height) - cos(PI * (y + 1.0) / p->height)) * 2 * PI / p->width;
}

void masu_bake_panorama_at(const masu_bake_panorama *p, const double d[3], double out[3]) {
    double azimuth = atan2(d[0], d[2]), polar = acos(fmin(fmax(d[1], -1), 1));
    double x = (0.5 - (azimuth - p->turn) / (2 * PI)) * p->width - 0.5;
    double y = fmin(fmax(polar / PI * p->height - 0.5, 0), p->height - 1.0);
    double left = floor(x), fx = x - left;
    uint32_t top = (uint32_t)fmin(y, fmax(p->height - 2.0, 0)), w = p->width;
    double fy = y - top;
    int64_t wrapped = (int64_t)left % (int64_t)w;
    uint32_t x0 = (uint32_t)(wrapped < 0 ? wrapped + w : wrapped), x1 = (x0 + 1) % w;
    uint32_t below = top + 1 < p->height ? top + 1 : top;
    const float *a = p->rgb + 3 * (size_t)w * top, *b = p->rgb + 3 * (size_t)w * below;
    for (uint32_t c = 0; c < 3; c++) {
        double high = (double)a[3 * x0 + c] * (1 - fx) + (double)a[3 * x1 + c] * fx;
        double low = (double)b[3 * x0 + c] * (1 - fx) + (double)b[3 * x1 + c] * fx;
        out[c] = p->factor * (high * (1 - fy) + low * fy);
    }
}

/* ---- Texels ---------------------------------------------------------------------------------- */

/* Khronos Data Format Specification 1.3, section 10.3. */
uint32_t masu_bake_pack_9995(const double rgb[3]) {
    double v[3], most = 0;
    for (uint32_t c = 0; c < 3; c++) {
        v[c] = fmin(fmax(rgb[c], 0), RADIANCE_MAX);
        most = fmax(most, v[c]);
    }
    int exponent = most > 0 ? (int)fmax(-16, floor(log2(most))) + 16 : 0;
    double unit = ldexp(1, exponent - 24);
    if (floor(most / unit + 0.5) > 511) {
        exponent++;
        unit *= 2;
    }
    uint32_t word = (uint32_t)exponent << 27;
    for (uint32_t c = 0; c < 3; c++) word |= (uint32_t)floor(v[c] / unit + 0.5) << 9 * c;
    return word;
}

void masu_bake_unpack_9995(uint32_t texel, double out[3]) {
    for (uint32_t c = 0; c < 3; c++) out[c] = ldexp(texel >> 9 * c & 511, (int)(texel >> 27) - 24);
}

/* Across an edge of the square, the neighbours are on the same edge, in reverse order. */
static size_t wrapped_texel(int32_t x, int32_t y, int32_t size) {
    if (x < 0 || x >= size) {
        x = x < 0 ? -1 - x : 2 * size - 1 - x;
        y = size - 1 - y;
    }
    if (y < 0 || y >= size) {
        y = y < 0 ? -1 - y : 2 * size - 1 - y;
        x = size - 1 - x;
    }
    return (size_t)y * (size_t)size + (size_t)x;
}

/* The four texels of a bilinear lookup and their weights. */
typedef struct corners {
    size_t texel[4];
    double weight[4];
} corners;

static inline corners corners_at(int32_t size, const double square[2]) {
    double x = square[0] * size - 0.5, y = square[1] * size - 0.5;
    int32_t x0 = (int32_t)x, y0 = (int32_t)y;
    x0 -= x < x0;
    y0 -= y < y0;
    bool inside = x0 >= 0 && y0 >= 0 && x0 + 1 < size && y0 + 1 < size;
    corners out;
    for (int32_t k = 0; k < 4; k++) {
        int32_t i = x0 + (k & 1), j = y0 + (k >> 1);
        double wx = k & 1 ? x - x0 : 1 - (x - x0), wy = k & 2 ? y - y0 : 1 - (y - y0);
        out.texel[k] = inside ? (size_t)(j * size + i) : wrapped_texel(i, j, size);
        out.weight[k] = wx * wy;
    }
    return out;
}

static void packed_at(const uint32_t *texels, uint32_t size, const double square[2],
                      double out[3]) {
    const corners at = corners_at((int32_t)size, square);
    out[0] = out[1] = out[2] = 0;
    for (uint32_t k = 0; k < 4; k++) {
        double texel[3];
        masu_bake_unpack_9995(texels[at.texel[k]], texel);
        for (uint32_t c = 0; c < 3; c++) out[c] += at.weight[k] * texel[c];
    }
}

static void plain_at(const float *texels, uint32_t size, const double square[2], double out[3]) {
    const corners at = corners_at((int32_t)size, square);
    out[0] = out[1] = out[2] = 0;
    for (uint32_t k = 0; k < 4; k++) {
        const float *texel = texels + 3 * at.texel[k];
        for (uint32_t c = 0; c < 3; c++) out[c] += at.weight[k] * (double)texel[c];
    }
}

void masu_bake_environment_at(const masu_blob_environment_map *map, const uint32_t *texels,
                              const double direction[3], double roughness, double out[3]) {
    double square[2], level = roughness * (map->mips - 1), near[3], far[3];
    uint32_t mip = (uint32_t)level, next = mip + 1 < map->mips ? mip + 1 : mip;
    size_t first[2] = {0, 0};
    for (uint32_t k = 0; k < next; k++) {
        size_t count = (size_t)(map->size >> k) * (map->size >> k);
        if (k < mip) first[0] += count;
        first[1] += count;
    }
    octahedral_square(direction, square);
    packed_at(texels + first[0], map->size >> mip, square, near);
    packed_at(texels + first[1], map->size >> next, square, far);
    for (uint32_t c = 0; c < 3; c++) out[c] = near[c] + (level - mip) * (far[c] - near[c]);
}

/* ---- Mips ------------------------------------------------------------------------------------ */

#define LEVELS 11

/* The unblurred map and its halves down to one texel, float rgb. */
typedef struct pyramid {
    uint32_t size, levels;
    float *level[LEVELS];
} pyramid;

static float *floats(size_t texels) {
    float *v = malloc(3 * texels * sizeof *v);
    if (!v) {
        masu_cli_error("no memory for an environment of %zu texels", texels);
        exit(1);
    }
    return v;
}

static void make_pyramid(const masu_bake_panorama *p, uint32_t size, pyramid *out) {
    double per = sqrt((double)p->width * p->height) / size;
    uint32_t n = (uint32_t)fmin(fmax(ceil(2 * per), 2), 12);
    out->size = size;
    out->level[0] = floats((size_t)size * size);
    for (uint32_t y = 0; y < size; y++) {
        for (uint32_t x = 0; x < size; x++) {
            double sum[3] = {0, 0, 0}, d[3], light[3];
            for (uint32_t k = 0; k < n * n; k++) {
                masu_bake_octahedral((x + (k % n + 0.5) / n) / size, (y + (k / n + 0.5) / n) / size,
                                     d);
                masu_bake_panorama_at(p, d, light);
                for (uint32_t c = 0; c < 3; c++) sum[c] += fmin(light[c], RADIANCE_MAX);
            }
            for (uint32_t c = 0; c < 3; c++)
                out->level[0][3 * ((size_t)y * size + x) + c] = (float)(sum[c] / (n * n));
        }
    }
    out->levels = 1;
    for (uint32_t s = size / 2; s >= 1; s /= 2, out->levels++) {
        const float *from = out->level[out->levels - 1];
        float *to = out->level[out->levels] = floats((size_t)s * s);
        for (size_t i = 0; i < 3 * (size_t)s * s; i++) {
            size_t x = i / 3 % s, y = i / 3 / s, c = i % 3, row = 2 * (size_t)s;
            const float *at = from + 3 * (2 * y * row + 2 * x) + c;
            to[i] = 0.25f * (at[0] + at[3] + at[3 * row] + at[3 * row + 3]);
        }
    }
}

static void trilinear(const pyramid *p, const double d[3], double lod, double out[3]) {
    double square[2], near[3], far[3];
    lod = fmin(fmax(lod, 0), p->levels - 1.0);
    uint32_t level = (uint32_t)fmin(lod, fmax(p->levels - 2.0, 0));
    uint32_t next = level + 1 < p->levels ? level + 1 : level;
    octahedral_square(d, square);
    plain_at(p->level[level], p->size >> level, square, near);
    plain_at(p->level[next], p->size >> next, square, far);
    for (uint32_t c = 0; c < 3; c++) out[c] = near[c] + (lod - level) * (far[c] - near[c]);
}

/* The samples of a lobe around +z: direction, weight, and the map's level to look it up in. */
typedef struct lobe_sample {
    double direction[3], weight, lod;
} lobe_sample;

static double radical_inverse(uint32_t i) {
    double v = 0, unit = 0.5;
    for (; i; i >>= 1, unit *= 0.5) v += unit * (i & 1);
    return v;
}

static uint32_t make_lobe(double roughness, uint32_t size, lobe_sample out[SAMPLES]) {
    double a = roughness * roughness, a2 = a * a, sum = 0;
    uint32_t n = 0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        double u = (i + 0.5) / SAMPLES, angle = 2 * PI * radical_inverse(i);
        double cos2 = (1 - u) / (1 + (a2 - 1) * u), sine = sqrt(fmax(1 - cos2, 0)), h = sqrt(cos2);
        lobe_sample *s = &out[n];
        s->direction[0] = 2 * h * sine * cos(angle);
        s->direction[1] = 2 * h * sine * sin(angle);
        s->direction[2] = s->weight = 2 * cos2 - 1;
        if (!(s->weight > 0)) continue;
        /* The density of light directions: D cos / (4 cos), at normal incidence. */
        double k = cos2 * (a2 - 1) + 1, density = a2 / (PI * k * k) / 4;
        double apart = 1 / (SAMPLES * density), texel = 4 * PI / ((double)size * size);
        s->lod = 0.5 * log2(apart / texel) + 0.5;
        sum += s->weight;
        n++;
    }
    for (uint32_t i = 0; i < n; i++) out[i].weight /= sum;
    return n;
}

static void blur(const pyramid *p, const lobe_sample *lobe, uint32_t n, const double d[3],
                 double out[3]) {
    double s = d[2] < 0 ? -1 : 1, a = -1 / (s + d[2]), b = d[0] * d[1] * a;
    const double u[3] = {1 + s * d[0] * d[0] * a, s * b, -s * d[0]};
    const double v[3] = {b, s + d[1] * d[1] * a, -d[1]};
    out[0] = out[1] = out[2] = 0;
    for (uint32_t i = 0; i < n; i++) {
        const double *l = lobe[i].direction;
        double world[3], light[3];
        for (uint32_t k = 0; k < 3; k++) world[k] = l[0] * u[k] + l[1] * v[k] + l[2] * d[k];
        trilinear(p, world, lobe[i].lod, light);
        for (uint32_t c = 0; c < 3; c++) out[c] += lobe[i].weight * light[c];
    }
}

static void warn_of_clamped(const masu_bake_panorama *p) {
    size_t count = 0, pixels = (size_t)p->width * p->height;
    double most = 0;
    for (size_t i = 0; i < pixels; i++) {
        const float *c = p->rgb + 3 * i;
        double own = p->factor * (double)fmaxf(c[0], fmaxf(c[1], c[2]));
        count += own > RADIANCE_MAX;
        most = fmax(most, own);
    }
    if (count)
        masu_cli_warn("%s: %zu of %zu pixels are above %g: clamped (the largest is %g)",
                      p->name ? p->name : "environment", count, pixels, RADIANCE_MAX, most);
}

void masu_bake_add_environment(const masu_bake_panorama *p, uint32_t size,
                               masu_bake_content *content) {
    warn_of_clamped(p);
    masu_blob_environment_map map = {.size = size};
    masu_bake_buffer *texels = &content->section[MASU_BLOB_ENVIRONMENT_TEXELS];
    pyramid source;
    lobe_sample lobe[SAMPLES];
    /* With four texels per edge, bilinear filtering has an error of 3 % even at roughness 1. */
    while (map.mips < 8 && (map.mips < 2 || size >> map.mips >= 8)) map.mips++;
    make_pyramid(p, size, &source);
    masu_bake_fit_irradiance(p, &map);
    for (uint32_t mip = 0; mip < map.mips; mip++) {
        uint32_t edge = size >> mip;
        uint32_t n = mip ? make_lobe((double)mip / (map.mips - 1), size, lobe) : 0;
        masu_cli_progress("environment: mip %u of %u", mip + 1, map.mips);
        for (uint32_t i = 0; i < edge * edge; i++) {
            double d[3], light[3];
            masu_bake_octahedral((i % edge + 0.5) / edge, (i / edge + 0.5) / edge, d);
            if (mip) {
                blur(&source, lobe, n, d, light);
            } else {
                for (uint32_t c = 0; c < 3; c++) light[c] = (double)source.level[0][3 * i + c];
            }
            uint32_t word = masu_bake_pack_9995(light);
            masu_bake_append(texels, &word, sizeof word);
        }
    }
    masu_bake_append(&content->section[MASU_BLOB_ENVIRONMENT_MAP], &map, sizeof map);
    for (uint32_t i = 0; i < source.levels; i++) free(source.level[i]);
}

/* patches.c: see patches.h. */
#include "measure/patches.h"

#include "image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { BYTES_MOST = 1 << 28, SIDE_MOST = 4096 };
#define TOLERANCE 0.01 /* relative error of a patch with the same weight as one standard error */
#define DARK 0.01 /* of the image's mean: darker patches use this as their base */

/* ---- Patches --------------------------------------------------------------------------------- */

void masu_patches_of(const float *pixels, const float *errors, uint32_t width, uint32_t height,
                     masu_patch out[MASU_PATCHES]) {
    for (uint32_t i = 0; i < MASU_PATCHES; i++) {
        uint32_t column = i % MASU_PATCH_COLUMNS, row = i / MASU_PATCH_COLUMNS;
        uint32_t x0 = column * width / MASU_PATCH_COLUMNS,
                 x1 = (column + 1) * width / MASU_PATCH_COLUMNS;
        uint32_t y0 = row * height / MASU_PATCH_ROWS, y1 = (row + 1) * height / MASU_PATCH_ROWS;
        double sum[3] = {0}, square[3] = {0}, count = (double)(x1 - x0) * (y1 - y0);
        for (uint32_t y = y0; y < y1; y++) {
            for (size_t k = 0; k < 3 * (size_t)(x1 - x0); k++) {
                size_t at = 3 * ((size_t)y * width + x0) + k;
                sum[k % 3] += (double)pixels[at];
                if (errors) square[k % 3] += (double)errors[at] * (double)errors[at];
            }
        }
        for (int c = 0; c < 3; c++) {
            out[i].mean[c] = count > 0 ? (float)(sum[c] / count) : 0.0f;
            out[i].error[c] = count > 0 ? (float)(sqrt(square[c]) / count) : 0.0f;
        }
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

static uint16_t half_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    uint32_t sign = bits >> 16 & 0x8000u;
    double size = fabs((double)value);
    if (!(size < 65504)) return (uint16_t)(sign | 0x7BFFu); /* the largest half; also for NaN */
    if (size < 0x1p-14) return (uint16_t)(sign | (uint32_t)lrint(size * 0x1p24));
    int exponent;
    double part = frexp(size, &exponent); /* 0.5 <= part < 1 */
    uint32_t rounded = ((uint32_t)(exponent + 14) << 10) + (uint32_t)lrint((2 * part - 1) * 1024);
    return (uint16_t)(sign | rounded);
}

static float float_of(uint16_t half) {
    double part = half & 1023,
           size = half >> 10 & 31 ? ldexp(1024 + part, (half >> 10 & 31) - 25) : ldexp(part, -24);
    return (float)(half & 0x8000 ? -size : size);
}

bool masu_reference_save(const char *path, const masu_reference *r, char *error,
                         size_t error_size) {
    size_t values = 3 * (size_t)r->width * r->height;
    size_t bytes = 2048 + 2 * values + sizeof r->patches;
    uint8_t *file = malloc(bytes);
    if (!file) {
        snprintf(error, error_size, "%s: out of memory", path);
        return false;
    }
    size_t at =
        (size_t)snprintf((char *)file, 2048, "masu-reference 1\nsize %ux%u\ncommand %s\nend\n",
                         r->width, r->height, r->command);
    for (size_t i = 0; i < values; i++) {
        uint16_t half = half_of(r->pixels[i]);
        file[at++] = (uint8_t)half;
        file[at++] = (uint8_t)(half >> 8);
    }
    memcpy(file + at, r->patches, sizeof r->patches);
    bool good = masu_file_write(path, file, at + sizeof r->patches, error, error_size);
    free(file);
    return good;
}

static bool broken(const char *path, const char *what, char *error, size_t error_size) {
    snprintf(error, error_size, "%s: not a stored reference: %s", path, what);
    return false;
}

static bool parse(const char *path, const uint8_t *file, size_t count, masu_reference *r,
                  char *error, size_t size) {
    static const char end[] = "\nend\n";
    char head[2048];
    size_t most = count < sizeof head - 1 ? count : sizeof head - 1;
    memcpy(head, file, most);
    head[most] = 0;
    char *stop = strstr(head, end), *command = strstr(head, "\ncommand ");
    if (!stop || sscanf(head, "masu-reference 1\nsize %5ux%5u\n", &r->width, &r->height) != 2)
        return broken(path, "no header", error, size);
    if (r->width < MASU_PATCH_COLUMNS || r->height < MASU_PATCH_ROWS || r->width > SIDE_MOST ||
        r->height > SIDE_MOST)
        return broken(path, "sides beyond 16x9 to 4096", error, size);
    *stop = 0;
    if (command) snprintf(r->command, sizeof r->command, "%s", command + 9);
    size_t values = 3 * (size_t)r->width * r->height, at = (size_t)(stop - head) + sizeof end - 1;
    if (count != at + 2 * values + sizeof r->patches)
        return broken(path, "wrong length", error, size);
    r->pixels = malloc(values * sizeof *r->pixels);
    if (!r->pixels) return broken(path, "out of memory", error, size);
    for (size_t i = 0; i < values; i++)
        r->pixels[i] = float_of((uint16_t)(file[at + 2 * i] | file[at + 2 * i + 1] << 8));
    memcpy(r->patches, file + at + 2 * values, sizeof r->patches);
    return true;
}

bool masu_reference_load(const char *path, masu_reference *r, char *error, size_t error_size) {
    uint8_t *file = NULL;
    size_t count;
    memset(r, 0, sizeof *r);
    if (!masu_file_read(path, BYTES_MOST, &file, &count, error, error_size)) return false;
    bool good = parse(path, file, count, r, error, error_size);
    free(file);
    if (!good) masu_reference_free(r);
    return good;
}

bool masu_reference_is_named(const char *path) {
    const size_t n = strlen(path);
    return n > 4 && !strcasecmp(path + n - 4, ".ref");
}

void masu_reference_free(masu_reference *r) {
    free(r->pixels);
    r->pixels = NULL;
}

/* ---- Judgement ------------------------------------------------------------------------------- */

static int rising(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

masu_patch_judgement masu_patches_judge(const masu_patch reference[MASU_PATCHES],
                                        const masu_patch image[MASU_PATCHES]) {
    masu_patch_judgement out = {.ratio = 1};
    double squares[3 * MASU_PATCHES], off[MASU_PATCHES], mean[3] = {0}, other = 0, all = 0;
    for (int i = 0; i < MASU_PATCHES; i++) {
        for (int c = 0; c < 3; c++) {
            mean[c] += (double)reference[i].mean[c] / MASU_PATCHES;
            other += (double)image[i].mean[c] / MASU_PATCHES;
        }
    }
    all = mean[0] + mean[1] + mean[2];
    if (all > 0) out.ratio = other / all;
    for (int i = 0; i < MASU_PATCHES; i++) {
        off[i] = 0;
        double worst = 0;
        for (int c = 0; c < 3; c++) {
            double r = (double)reference[i].mean[c], d = (double)image[i].mean[c] - r;
            double base = fmax(fabs(r), fmax(DARK * all / 3, 1e-9));
            double s = hypot((double)reference[i].error[c], (double)image[i].error[c]);
            double z = d / hypot(s, TOLERANCE * base);
            squares[3 * i + c] = z * z;
            off[i] = fmax(off[i], fmax(fabs(d) - 3 * s, 0) / base);
            worst = fmax(worst, fabs(d) / base);
        }
        if (worst > out.worst_by) out.worst_by = worst, out.worst = (uint32_t)i;
    }
    qsort(squares, 3 * MASU_PATCHES, sizeof *squares, rising);
    qsort(off, MASU_PATCHES, sizeof *off, rising);
    uint32_t kept = 3 * MASU_PATCHES * 9 / 10;
    for (uint32_t i = 0; i < kept; i++) out.trimmed += squares[i] / kept;
    out.p95 = off[MASU_PATCHES * 95 / 100];
    return out;
}

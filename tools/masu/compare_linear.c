/* compare_linear.c: `masu compare` of linear light: PFM and OpenEXR images, and stored references
 * with known errors. */
#include "masu/compare.h"
#include "command/output.h"

#include "image.h"
#include "measure/patches.h"
#include "metric/hdr_flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>


typedef struct linear {
    uint32_t width, height;
    float *rgb;
    bool noisy; /* has standard errors */
    masu_patch patches[MASU_PATCHES];
} linear;

bool masu_compare_is_linear(const char *path) {
    return masu_reference_is_named(path) || masu_image_is_linear(path);
}

/* A single channel is expanded to three. */
static bool load(const char *path, linear *out, char *error, size_t size) {
    memset(out, 0, sizeof *out);
    if (masu_reference_is_named(path)) {
        masu_reference r;
        if (!masu_reference_load(path, &r, error, size)) return false;
        *out = (linear){.width = r.width, .height = r.height, .rgb = r.pixels, .noisy = true};
        memcpy(out->patches, r.patches, sizeof out->patches);
        return true;
    }
    struct masu_image image;
    if (!masu_image_load(path, &image, error, size)) return false;
    if (!image.values) {
        snprintf(error, size,
                 "%.1500s: found 8-bit sRGB, expected linear light (PFM, OpenEXR, .ref) as the "
                 "other image",
                 path);
        masu_image_free(&image);
        return false;
    }
    *out = (linear){.width = image.width, .height = image.height};
    size_t pixels = (size_t)image.width * image.height;
    out->rgb = malloc(3 * pixels * sizeof *out->rgb);
    for (size_t i = 0; i < 3 * pixels && out->rgb; i++)
        out->rgb[i] = image.values[image.channels == 3 ? i : i / 3];
    masu_image_free(&image);
    if (!out->rgb) snprintf(error, size, "%.1500s: out of memory", path);
    return out->rgb != NULL;
}

static bool same_size(const char *path, const linear *of, const char *as_path, const linear *as,
                      char *error, size_t size) {
    if (of->width == as->width && of->height == as->height) return true;
    snprintf(error, size, "%.1500s: found %ux%u, expected %ux%u as in %.1500s", path, of->width,
             of->height, as->width, as->height, as_path);
    return false;
}

/* Means of both images' patches, and the standard errors of the reference. */
static bool find_patches(const char *const files[2], linear images[2], const char *errors,
                         char *error, size_t size) {
    linear deviations = {0};
    bool good = !errors || (load(errors, &deviations, error, size) &&
                            same_size(errors, &deviations, files[0], &images[0], error, size));
    if (good && !images[0].noisy)
        masu_patches_of(images[0].rgb, deviations.rgb, images[0].width, images[0].height,
                        images[0].patches);
    if (good && !images[1].noisy)
        masu_patches_of(images[1].rgb, NULL, images[1].width, images[1].height, images[1].patches);
    images[0].noisy |= errors != NULL;
    free(deviations.rgb);
    return good;
}

static bool save_map(const char *path, const float *map, const linear *as, char *error,
                     size_t size) {
    size_t pixels = (size_t)as->width * as->height;
    uint8_t *rgba = malloc(4 * pixels);
    for (size_t i = 0; i < pixels && rgba; i++) {
        memset(rgba + 4 * i, (int)(255.0f * fminf(map[i], 1.0f) + 0.5f), 3);
        rgba[4 * i + 3] = 255;
    }
    bool good = rgba && masu_image_save_png(path, rgba, as->width, as->height, 0, error, size);
    free(rgba);
    return good;
}

static int report(const masu_compare_options *o, const linear images[2],
                  const masu_relative_error *e, const masu_flip *flip) {
    const bool noisy = images[0].noisy || images[1].noisy;
    const masu_patch_judgement j = masu_patches_judge(images[0].patches, images[1].patches);
    if (e->left_out)
        masu_cli_warn("%llu pixels are not finite and are left out",
                      (unsigned long long)e->left_out);
    if (o->json) {
        json_t *root =
            json_pack("{s:f, s:f, s:f, s:f, s:f, s:i, s:f, s:f, s:f}", "relative_rmse", e->rmse,
                      "relmse", e->relmse, "mean_ratio", j.ratio, "patch_p95", j.p95, "patch_worst",
                      j.worst_by, "patch_worst_index", (int)j.worst, "hdr_flip", flip->mean,
                      "hdr_flip_p99", flip->p99, "hdr_flip_max", flip->max);
        json_object_set_new(root, "patch_z2", noisy ? json_real(j.trimmed) : json_null());
        return masu_json_write(root, o->json);
    }
    printf("relative RMSE %.5f, relMSE %.6f, HDR-FLIP %.5f (p99 %.4f, max %.4f)\n"
           "mean ratio %.5f, patches: 95th percentile of |ratio - 1| %.5f, largest %.4f at column "
           "%u, row %u",
           e->rmse, e->relmse, flip->mean, flip->p99, flip->max, j.ratio, j.p95, j.worst_by,
           j.worst % MASU_PATCH_COLUMNS, j.worst / MASU_PATCH_COLUMNS);
    if (noisy) printf(", trimmed mean of z^2 %.3f", j.trimmed);
    printf("\n");
    return MASU_CLI_OK;
}

int masu_compare_linear(const char *const files[2], const masu_compare_options *o) {
    static linear images[2];
    char error[4096] = "out of memory for the comparison";
    masu_flip flip;
    bool good = load(files[0], &images[0], error, sizeof error) &&
                load(files[1], &images[1], error, sizeof error) &&
                same_size(files[1], &images[1], files[0], &images[0], error, sizeof error);
    const uint32_t width = images[0].width, height = images[0].height;
    if (good && (width < MASU_PATCH_COLUMNS || height < MASU_PATCH_ROWS)) {
        snprintf(error, sizeof error,
                 "%.1500s: found %ux%u, expected at least 16x9 pixels for patches", files[0], width,
                 height);
        good = false;
    }
    good = good && find_patches(files, images, o->errors, error, sizeof error);
    float *map = good ? malloc(sizeof *map * width * height) : NULL;
    good = map &&
           masu_metric_hdr_flip(images[0].rgb, images[1].rgb, width, height, o->ppd, map, &flip) &&
           (!o->map || save_map(o->map, map, &images[0], error, sizeof error));
    int code = MASU_CLI_FAILURE;
    if (good) {
        masu_relative_error e = masu_metric_relative(images[0].rgb, images[1].rgb, width * height);
        code = report(o, images, &e, &flip);
    } else {
        code = masu_cli_error("%s", error);
    }
    free(map);
    free(images[0].rgb);
    free(images[1].rgb);
    return code;
}

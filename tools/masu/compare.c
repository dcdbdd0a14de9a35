/* compare.c: `masu compare`: the error of one image against another, by the metrics of all benches
 * (metric/image.h, metric/flip.h). tests/scripts/compare.sh checks them against other programs.
 * Needs no device. */
#include "masu/cmd.h"
#include "masu/compare.h"
#include "command/options.h"

#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct differences {
    double rmse, psnr, ssim;
    masu_flip flip;
} differences;

static bool measure(const struct masu_image *reference, const struct masu_image *test, double ppd,
                    float *map, differences *d) {
    uint32_t w = reference->width, h = reference->height;
    d->rmse = masu_metric_rmse(reference->rgba, test->rgba, w, h);
    d->psnr = masu_metric_psnr(d->rmse);
    d->ssim = masu_metric_ssim(reference->rgba, test->rgba, w, h);
    return !isnan(d->ssim) &&
           masu_metric_flip(reference->rgba, test->rgba, w, h, ppd, map, &d->flip);
}

/* Saves the map as grey levels; 0: no visible difference. Overwrites `pixels`. */
static bool save_map(const char *path, const float *map, struct masu_image *pixels, char *error,
                     size_t error_size) {
    size_t n = (size_t)pixels->width * pixels->height;
    for (size_t i = 0; i < n; i++) {
        memset(pixels->rgba + 4 * i, (int)(255.0f * fminf(map[i], 1.0f) + 0.5f), 3);
        pixels->rgba[4 * i + 3] = 255;
    }
    return masu_image_save_png(path, pixels->rgba, pixels->width, pixels->height, 0, error,
                               error_size);
}

static int write_json(const differences *d, const char *path) {
    /* JSON has no infinity: the PSNR of equal images is null. */
    json_t *psnr = isfinite(d->psnr) ? json_real(d->psnr) : json_null();
    json_t *root = json_pack("{s:f, s:o, s:f, s:f, s:f, s:f}", "rmse", 255.0 * d->rmse, "psnr_db",
                             psnr, "ssim", d->ssim, "flip", d->flip.mean, "flip_p99", d->flip.p99,
                             "flip_max", d->flip.max);
    return masu_json_write(root, path);
}

static int compare(const char *const files[2], const masu_compare_options *o) {
    struct masu_image images[2];
    differences d;
    char error[4096] = "out of memory for the comparison";
    memset(images, 0, sizeof images);
    bool good = masu_image_load_png(files[0], &images[0], error, sizeof error) &&
                masu_image_load_png(files[1], &images[1], error, sizeof error);
    if (good && (images[0].width != images[1].width || images[0].height != images[1].height)) {
        snprintf(error, sizeof error, "%.1500s: found %ux%u, expected %ux%u as in %.1500s",
                 files[1], images[1].width, images[1].height, images[0].width, images[0].height,
                 files[0]);
        good = false;
    }
    float *map = NULL;
    if (good && o->map) {
        map = malloc(sizeof *map * images[0].width * images[0].height);
        good = map != NULL;
    }
    good = good && measure(&images[0], &images[1], o->ppd, map, &d);
    if (good && o->map) good = save_map(o->map, map, &images[1], error, sizeof error);
    free(map);
    masu_image_free(&images[0]);
    masu_image_free(&images[1]);
    if (!good) return masu_cli_error("%s", error);
    if (o->json) return write_json(&d, o->json);
    printf("RMSE %.4f of 255, PSNR %.3f dB, SSIM %.5f, FLIP %.5f (p99 %.4f, max %.4f)\n",
           255.0 * d.rmse, d.psnr, d.ssim, d.flip.mean, d.flip.p99, d.flip.max);
    return MASU_CLI_OK;
}

static const masu_option rows[] = {
    MASU_PNG(masu_compare_options, map, "map",
             "write FLIP per pixel as a grey image; black is no difference"),
    MASU_REAL(masu_compare_options, ppd, "ppd", "N", 1.0, 1000.0,
              "pixels per degree of the viewer's field of view, 1 to 1000\n"
              "(default 67.02: a 4K screen at 0.7 m)"),
    MASU_OUTPUT(masu_compare_options, json, "json", "FILE",
                "write the metrics there as JSON, and print no text; '-' is stdout"),
    MASU_TEXT(masu_compare_options, errors, "error", "FILE",
              "standard error of each value of the reference, linear light (.pfm, .exr)"),
    {.name = NULL}};

static int run(masu_cli *cli) {
    masu_compare_options o = {.ppd = 0.0};
    masu_given given = {.most = 2, .excess = "expected one reference and one image"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (given.count < 2)
        return masu_cli_usage_error("expected a reference and an image: REFERENCE IMAGE");
    if (masu_compare_is_linear(given.arguments[0]) || masu_compare_is_linear(given.arguments[1]))
        return masu_compare_linear(given.arguments, &o);
    if (o.errors) return masu_cli_usage_error("--error needs images of linear light (.pfm, .exr)");
    return compare(given.arguments, &o);
}

const masu_cli_command masu_cmd_compare = {
    .name = "compare",
    .arguments = "REFERENCE IMAGE [options]",
    .summary = "print the error of an image against a reference: RMSE, PSNR, SSIM, FLIP, ratios of "
               "patches",
    .details = "Both images must have the same size. PNGs are read as sRGB; alpha is ignored. SSIM "
               "is computed on\n"
               "luma.\n\n"
               "Linear light (PFM, OpenEXR, a .ref of `masu-lab reference`): relative RMSE (of the "
               "reference's\n"
               "mean), relMSE, HDR-FLIP, and statistics of 16x9 patches: the ratio of the means, "
               "the 95th\n"
               "percentile of |patch ratio - 1| beyond three standard errors, and with --error or "
               "a .ref the\n"
               "mean of z^2 over the nine tenths of the patches with the least, z = difference / "
               "sqrt(standard\n"
               "error^2 + (1 % of the patch)^2). Limits for equal images: 0.8 %, 3.5 %, 1.02.\n\n"
               "Exit codes:\n"
               "  0  success, for any error\n"
               "  1  a file could not be read or written, or the sizes differ\n"
               "  2  the command line is wrong\n\n"
               "Examples:\n"
               "  masu compare reference.png frame.png\n"
               "  masu compare reference.exr frame.exr --error sigma.pfm\n"
               "  masu compare reference.png frame.png --map flip.png --json -\n",
    .run = run};

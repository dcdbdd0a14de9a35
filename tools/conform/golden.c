/* golden.c: see golden.h. */
#include "conform/golden.h"

#include "measure/rest.h"
#include "metric/flip.h"
#include "metric/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>


const char *masu_golden_path(const masu_suite *suite, const masu_case *of, char path[4096]) {
    const char *slash = strrchr(suite->file, '/');
    if (!of->golden) return NULL;
    snprintf(path, 4096, "%.*s%s", slash ? (int)(slash - suite->file) + 1 : 0, suite->file,
             of->golden);
    return path;
}

bool masu_golden_judge(const char *path, const masu_case *of, masu_session *s,
                       const masu_frame_desc *frame, double values[MASU_MEASURE_COUNT], char *error,
                       size_t error_size) {
    static masu_patch golden[MASU_PATCHES], drawn[MASU_PATCHES];
    if (!masu_rest_load(path, golden, error, error_size) ||
        !masu_rest_patches(s, *frame, of->positions, drawn, error, error_size)) {
        return false;
    }
    const masu_patch_judgement j = masu_patches_judge(golden, drawn);
    values[MASU_MEASURE_MEAN_OFF] = fabs(j.ratio - 1.0);
    values[MASU_MEASURE_PATCH_P95] = j.p95;
    values[MASU_MEASURE_PATCH_Z2] = j.trimmed;
    return true;
}

uint32_t masu_golden_differing(const uint8_t *a, const uint8_t *b, const masu_case *of,
                               uint32_t *steps) {
    uint32_t pixels = 0;
    *steps = 0;
    for (size_t i = 0; i < (size_t)of->width * of->height; i++) {
        uint32_t most = 0;
        for (size_t k = 0; k < 4; k++) {
            uint32_t step = (uint32_t)abs(a[4 * i + k] - b[4 * i + k]);
            most = step > most ? step : most;
        }
        pixels += most != 0;
        *steps = most > *steps ? most : *steps;
    }
    return pixels;
}

void masu_golden_compare(const uint8_t *truth, const uint8_t *picture, const masu_case *of,
                         double values[MASU_MEASURE_COUNT]) {
    masu_flip flip;
    uint32_t steps = 0, pixels = masu_golden_differing(truth, picture, of, &steps);
    double rmse = masu_metric_rmse(truth, picture, of->width, of->height);
    values[MASU_MEASURE_PIXELS] = pixels;
    values[MASU_MEASURE_STEPS] = steps;
    values[MASU_MEASURE_RMSE] = 255.0 * rmse;
    values[MASU_MEASURE_PSNR] = masu_metric_psnr(rmse);
    values[MASU_MEASURE_SSIM] = masu_metric_ssim(truth, picture, of->width, of->height);
    if (masu_metric_flip(truth, picture, of->width, of->height, 0, NULL, &flip)) {
        values[MASU_MEASURE_FLIP] = flip.mean;
        values[MASU_MEASURE_FLIP_P99] = flip.p99;
    }
}

/* height.c: see input.h. The image is untrusted: an incomplete PNG, or one whose header does not
 * describe a period, is not decoded. */
#include "meso/input.h"

#include <stdlib.h>

#include "cli/cli.h"
#include "image.h"

static bool fits(const char *path, uint32_t width, uint32_t height) {
    if (width != height) {
        masu_cli_error("%s: expected a square image, found %ux%u", path, width, height);
        return false;
    }
    if (width < 4 || width > MASU_MESO_HEIGHT_SIDE_MAX) {
        masu_cli_error("%s: expected 4 to %u pixels per side, found %u", path,
                       MASU_MESO_HEIGHT_SIDE_MAX, width);
        return false;
    }
    return true;
}

bool masu_meso_read_heights(const char *path, const masu_meso_input *input,
                            masu_meso_patch *patch) {
    char error[1024];
    uint8_t *bytes = NULL;
    size_t count = 0;
    *patch = (masu_meso_patch){0};
    if (!masu_file_read(path, MASU_IMAGE_FILE_BYTES_MAX, &bytes, &count, error, sizeof error)) {
        masu_cli_error("%s", error);
        return false;
    }
    uint32_t width = 0, height = 0;
    uint16_t *values = NULL;
    bool good = masu_image_png_size(path, bytes, count, &width, &height, error, sizeof error);
    if (!good) {
        masu_cli_error("%s", error);
    } else if ((good = fits(path, width, height))) {
        values = masu_image_decode_gray(path, bytes, count, &width, &height, error, sizeof error);
        if (!values) masu_cli_error("%s", error);
        good = values != NULL;
    }
    free(bytes);
    if (!good) return false;
    size_t texels = (size_t)width * width;
    double *heights = malloc(texels * sizeof *heights);
    if (!heights) exit(masu_cli_error("out of memory"));
    for (size_t i = 0; i < texels; i++) heights[i] = input->height * values[i] / 65535.0;
    free(values);
    masu_meso_patch_from_grid(patch, heights, NULL, input->albedo, width);
    free(heights);
    patch->roughness = input->roughness;
    masu_meso_patch_finish(patch);
    return true;
}

/* height.c: see input.h. stb reads the picture; its code is part of the platform library. */
#include "meso/input.h"

#include <stdlib.h>

#include "cli/cli.h"
#include "image.h"

/* As platform/image.c defines them: the header then declares what is there. */
#if defined(__GNUC__)
#define STBIDEF extern __attribute__((visibility("hidden")))
#endif
#define STBI_ONLY_PNG
#define STBI_NO_STDIO
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#include <stb/stb_image.h>

static bool fits(const char *path, int width, int height) {
    if (width != height) {
        masu_cli_error("%s: a period is square, this is %dx%d", path, width, height);
        return false;
    }
    if (width < 4 || (uint32_t)width > MASU_MESO_HEIGHT_SIDE_MAX) {
        masu_cli_error("%s: an edge is from 4 to %u pixels, not %d", path,
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
    if (!masu_file_read(path, (size_t)256 << 20, &bytes, &count, error, sizeof error)) {
        masu_cli_error("%s", error);
        return false;
    }
    int width = 0, height = 0, channels = 0;
    stbi_us *values = NULL;
    bool good = stbi_info_from_memory(bytes, (int)count, &width, &height, &channels) != 0;
    if (!good) {
        masu_cli_error("%s: no PNG: %s", path, stbi_failure_reason());
    } else if ((good = fits(path, width, height))) {
        values = stbi_load_16_from_memory(bytes, (int)count, &width, &height, &channels, 1);
        if (!values) masu_cli_error("%s: broken PNG: %s", path, stbi_failure_reason());
        good = values != NULL;
    }
    free(bytes);
    if (!good) return false;
    size_t texels = (size_t)width * (size_t)width;
    double *heights = malloc(texels * sizeof *heights);
    if (!heights) exit(masu_cli_error("out of memory"));
    for (size_t i = 0; i < texels; i++) heights[i] = input->height * values[i] / 65535.0;
    free(values);
    masu_meso_patch_from_grid(patch, heights, NULL, input->albedo, (uint32_t)width);
    free(heights);
    patch->roughness = input->roughness;
    masu_meso_patch_finish(patch);
    return true;
}

/* rest.c: see rest.h. */
#include "measure/rest.h"

#include "image.h"
#include "measure/linear.h"
#include "measure/picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool add_frame(masu_session *s, const masu_frame_desc *frame, VkExtent2D *size, float **sum,
                      char *error, size_t error_size) {
    masu_commands commands;
    masu_plan_info plan;
    if (!masu_session_frame(s, frame, true, &commands, error, error_size)) return false;
    masu_plan_of(s->m, &plan);
    *size = (VkExtent2D){plan.rungs[commands.rung].render_width,
                         plan.rungs[commands.rung].render_height};
    const size_t values = 3 * (size_t)size->width * size->height;
    if (!*sum) *sum = calloc(2 * values, sizeof **sum);
    if (!*sum || !masu_linear_read(s->m, commands.slot, *size, *sum + values)) {
        snprintf(error, error_size, *sum ? "no linear light to read back" : "out of memory");
        return false;
    }
    for (size_t i = 0; i < values; i++) (*sum)[i] += (*sum)[values + i];
    return true;
}

bool masu_rest_patches(masu_session *s, masu_frame_desc frame, uint32_t count,
                       masu_patch out[MASU_PATCHES], char *error, size_t error_size) {
    masu_camera camera;
    VkExtent2D size = {0, 0};
    float *sum = NULL;
    if (!masu_picture_camera(s, &frame, &camera, error, error_size)) return false;
    bool good = true;
    for (uint32_t i = 0; i < count && good; i++) {
        masu_picture_place(i, count, camera.jitter);
        good = add_frame(s, &frame, &size, &sum, error, error_size);
    }
    if (good && (size.width < MASU_PATCH_COLUMNS || size.height < MASU_PATCH_ROWS)) {
        snprintf(error, error_size, "found %ux%u, expected at least 16x9 pixels for patches",
                 size.width, size.height);
        good = false;
    }
    const size_t values = 3 * (size_t)size.width * size.height;
    for (size_t i = 0; i < values && good; i++) sum[i] /= (float)count;
    if (good) masu_patches_of(sum, NULL, size.width, size.height, out);
    free(sum);
    return good;
}

bool masu_rest_load(const char *path, masu_patch out[MASU_PATCHES], char *error,
                    size_t error_size) {
    if (masu_reference_is_named(path)) {
        masu_reference r;
        if (!masu_reference_load(path, &r, error, error_size)) return false;
        memcpy(out, r.patches, sizeof r.patches);
        masu_reference_free(&r);
        return true;
    }
    struct masu_image image;
    if (!masu_image_load(path, &image, error, error_size)) return false;
    bool good = image.values && image.channels == 3 && image.width >= MASU_PATCH_COLUMNS &&
                image.height >= MASU_PATCH_ROWS;
    if (good) masu_patches_of(image.values, NULL, image.width, image.height, out);
    else
        snprintf(error, error_size,
                 "%.900s: expected linear light of three channels and at least 16x9 pixels", path);
    masu_image_free(&image);
    return good;
}

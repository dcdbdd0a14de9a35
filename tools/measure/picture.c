/* picture.c: see picture.h. */
#include "measure/picture.h"

#include "measure/specular.h"
#include "image.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Digits of i to the base of two, mirrored at the point (J. G. van der Corput, 1935). */
static double mirrored(uint32_t i) {
    double value = 0.0, digit = 0.5;
    for (; i; i >>= 1, digit *= 0.5) value += i & 1u ? digit : 0.0;
    return value;
}

void masu_picture_place(uint32_t i, uint32_t n, float out[2]) {
    double half = 0.5 / (double)n;
    out[0] = (float)((double)i / (double)n + half - 0.5);
    out[1] = (float)(fmin(mirrored(i) + half, 1.0) - 0.5);
}

/* IEC 61966-2-1. */
float masu_picture_decoded(uint8_t encoded) {
    double v = (double)encoded / 255.0;
    return (float)(v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4));
}

uint8_t masu_picture_encoded(float linear) {
    double v = linear > 0.0f ? fmin((double)linear, 1.0) : 0.0;
    v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1.0 / 2.4) - 0.055;
    return (uint8_t)(255.0 * v + 0.5);
}

/* The march is AUTO's, and not the plain one: it finds surfaces to 0.002 of a pixel, with steps
 * that are checked and starts that are proven; the plain one stops at 0.1, and rims are thicker
 * by that. */
static const masu_rung exact_rung = {.scale = 1.0f,
                                     .upscale = MASU_OFF,
                                     .sharpen = MASU_OFF,
                                     .march_steps = MASU_MARCH_STEPS_MAX,
                                     .occlusion = MASU_OFF,
                                     .lod_error = -1.0f,
                                     .ao_slices = MASU_AO_SLICES_MAX,
                                     .ao_steps = MASU_AO_STEPS_MAX};

masu_session_desc masu_picture_session(const char *scene_path, VkExtent2D size,
                                       const masu_headless_desc *host) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = scene_path;
    d.host = *host;
    d.desc.output = size;
    d.desc.targets.storage = 1;
    d.desc.vulkan.max_anisotropy = 1.0f;
    return d;
}

bool masu_picture_open(const masu_session_desc *d, uint32_t positions, masu_session *s, char *error,
                       size_t error_size) {
    masu_session_desc own = *d;
    own.desc.rung_count = 1;
    own.desc.rungs[0] = exact_rung;
    own.desc.debug.reference = 1;
    own.desc.debug.ao_full = 1;
    /* Mips as the picture of that many times the pixels would take them. With them a texture seen
     * at a slant is right too, up to as many pixels to one as there are positions along an axis:
     * no anisotropy is needed, which a CPU driver has at forty times the price. */
    own.desc.vulkan.max_anisotropy = 0.0f;
    own.desc.debug.mip_bias = -0.5f * log2f((float)positions);
    return masu_session_open(&own, s, error, error_size);
}

uint32_t masu_picture_frames(const masu_session *s, uint32_t positions, uint32_t rays) {
    if (!(masu_scene_features(&s->scene) & MASU_SCENE_HAS_REFLECTIONS) || rays <= positions)
        return 1;
    return (rays + positions - 1) / positions;
}

/* One position: the first frame is a cut, with which the reference begins a new sum. Rays differ
 * by the number of the frame, so that no position gets those of another. */
static bool draw_position(masu_session *s, masu_frame_desc frame, uint32_t frames, char *error,
                          size_t error_size) {
    masu_commands commands;
    for (uint32_t k = 0; k < frames; k++) {
        frame.cut = k == 0;
        if (!masu_session_frame(s, &frame, k + 1 == frames, &commands, error, error_size))
            return false;
    }
    return masu_headless_target_read(&s->host, &s->targets[0], error, error_size);
}

static bool add_radiance(masu_session *s, size_t pixels, float *one, float *sum, char *error,
                         size_t error_size) {
    if (!masu_specular_read(s, one)) {
        snprintf(error, error_size, "no radiance to read back");
        return false;
    }
    for (size_t i = 0; i < 3 * pixels; i++) sum[i] += one[i];
    return true;
}

static void say_position(uint32_t i, uint32_t of, void (*progress)(const char *text)) {
    char text[64];
    snprintf(text, sizeof text, "ground truth: sample %u of %u", i + 1, of);
    if (progress) progress(text);
}

bool masu_picture_truth(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                        uint32_t rays, uint8_t *rgba, void (*progress)(const char *text),
                        char *error, size_t error_size) {
    return masu_picture_truth_hdr(s, frame, positions, rays, rgba, NULL, progress, error,
                                  error_size);
}

bool masu_picture_truth_hdr(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                            uint32_t rays, uint8_t *rgba, float *radiance,
                            void (*progress)(const char *text), char *error,
                            size_t error_size) {
    size_t pixels = (size_t)s->desc.output.width * s->desc.output.height;
    uint32_t frames = masu_picture_frames(s, positions, rays);
    masu_frame_desc own = *frame;
    masu_camera camera;
    float decoded[256];
    if (frame->camera) {
        camera = *frame->camera;
    } else if (masu_camera_at(s->m, frame->time, &camera)) {
        snprintf(error, error_size, "the scene has no camera");
        return false;
    }
    for (uint32_t v = 0; v < 256; v++) decoded[v] = masu_picture_decoded((uint8_t)v);
    float *sum = calloc(3 * pixels * (radiance ? 2 : 1), sizeof *sum), *one = sum + 3 * pixels;
    if (!sum) {
        snprintf(error, error_size, "out of memory");
        return false;
    }
    if (radiance) memset(radiance, 0, 3 * pixels * sizeof *radiance);
    own.camera = &camera;
    own.rung = 0;
    own.time_step = MASU_PICTURE_STEP;
    bool good = true;
    for (uint32_t i = 0; i < positions && good; i++) {
        say_position(i, positions, progress);
        masu_picture_place(i, positions, camera.jitter);
        good = draw_position(s, own, frames, error, error_size);
        const uint8_t *from = s->targets[0].mapped;
        for (size_t p = 0; p < pixels && good; p++) {
            for (size_t k = 0; k < 3; k++) sum[3 * p + k] += decoded[from[4 * p + k]];
        }
        good = good && (!radiance || add_radiance(s, pixels, one, radiance, error, error_size));
    }
    for (size_t i = 0; i < 3 * pixels && good && radiance; i++) radiance[i] /= (float)positions;
    for (size_t p = 0; p < pixels && good; p++) {
        for (size_t k = 0; k < 3; k++)
            rgba[4 * p + k] = masu_picture_encoded(sum[3 * p + k] / (float)positions);
        rgba[4 * p + 3] = 255;
    }
    free(sum);
    return good;
}

bool masu_picture_load(const char *path, VkExtent2D size, uint8_t *rgba, char *error,
                       size_t error_size) {
    struct masu_image image;
    if (!masu_image_load_png(path, &image, error, error_size)) return false;
    bool fits = image.width == size.width && image.height == size.height;
    if (fits) {
        memcpy(rgba, image.rgba, 4 * (size_t)size.width * size.height);
    } else {
        snprintf(error, error_size, "%.500s: found %ux%u, expected %ux%u", path, image.width,
                 image.height, size.width, size.height);
    }
    masu_image_free(&image);
    return fits;
}

bool masu_picture_find(const masu_session_desc *d, masu_picture_want *t, uint8_t *rgba, char *error,
                       size_t error_size) {
    static masu_session s; /* may not move, and is large */
    VkExtent2D size = d->desc.output;
    t->messages = 0;
    if (t->path && masu_file_exists(t->path)) return masu_picture_load(t->path, size, rgba, error, error_size);
    if (!masu_picture_open(d, t->positions, &s, error, error_size)) return false;
    masu_frame_desc frame = {.time = t->time};
    bool good =
        masu_picture_truth(&s, &frame, t->positions, t->rays, rgba, t->progress, error, error_size);
    masu_session_close(&s);
    t->messages = s.host.messages;
    return good && (!t->path || masu_image_save_png(t->path, rgba, size.width, size.height, 0,
                                                    error, error_size));
}

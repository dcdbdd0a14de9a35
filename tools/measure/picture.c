/* picture.c: see picture.h. */
#include "measure/picture.h"

#include "measure/linear.h"
#include "measure/specular.h"
#include "image.h"
#include "scene/scene_data.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The binary digits of i, mirrored at the point (J. G. van der Corput, 1935). */
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

/* March AUTO, not the plain one: AUTO finds surfaces to 0.002 of a pixel, with verified steps and
 * proven starts. The plain march stops at 0.1 of a pixel, which thickens rims. */
static const masu_rung exact_rung = {.scale = 1.0f,
                                     .upscale = MASU_OFF,
                                     .sharpen = MASU_OFF,
                                     .march_steps = MASU_MARCH_STEPS_MAX,
                                     .occlusion = MASU_OFF,
                                     .lod_error = -1.0f,
                                     .local_shadow_atlas = 4096,
                                     .local_shadow_lights = 64,
                                     .local_shadow_faces = 16,
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
    /* Uses the mip levels of an image with `positions` times as many pixels. A texture at a grazing
     * angle is then also correct, for as many pixels per texel as there are positions along an
     * axis. This needs no anisotropic filtering, which costs forty times as much on a CPU
     * driver. */
    own.desc.vulkan.max_anisotropy = 0.0f;
    own.desc.debug.mip_bias = -0.5f * log2f((float)positions);
    own.desc.readback |= MASU_READBACK_HDR;
    own.no_renderer = true;
    if (!masu_session_open(&own, s, error, error_size)) return false;
    if (masu_linear_is_metered(s)) s->desc.debug.counters = 1; /* masu_linear_exposure */
    if (masu_session_start(s, error, error_size)) return true;
    masu_session_close(s);
    return false;
}

uint32_t masu_picture_frames(const masu_session *s, uint32_t positions, uint32_t rays) {
    if (!(masu_scene_features(&s->scene) & MASU_SCENE_HAS_REFLECTIONS) || rays <= positions)
        return 1;
    return (rays + positions - 1) / positions;
}

/* Renders one position. The first frame is a cut, which restarts the sum of the reference. Rays
 * depend on the frame number, so that no two positions use the same rays. */
static bool draw_position(masu_session *s, masu_frame_desc frame, uint32_t frames, char *error,
                          size_t error_size) {
    masu_commands commands;
    for (uint32_t k = 0; k < frames; k++) {
        frame.cut = k == 0;
        if (!masu_session_frame(s, &frame, k + 1 == frames, &commands, error, error_size))
            return false;
    }
    return true;
}

static void say_position(uint32_t i, uint32_t of, void (*progress)(const char *text)) {
    char text[64];
    snprintf(text, sizeof text, "ground truth: sample %u of %u", i + 1, of);
    if (progress) progress(text);
}

bool masu_picture_camera(masu_session *s, masu_frame_desc *frame, masu_camera *camera, char *error,
                         size_t error_size) {
    if (frame->camera) {
        *camera = *frame->camera;
    } else if (masu_camera_at(s->m, frame->time, camera, NULL)) {
        snprintf(error, error_size, "the scene has no camera");
        return false;
    }
    frame->camera = camera;
    return true;
}

/* Sums over all positions; `one` holds the newest image. */
typedef struct sums {
    float *linear, *display, *one;
} sums;

static bool add_position(masu_session *s, const masu_light *light, sums *sum, char *error,
                         size_t error_size) {
    const size_t pixels = (size_t)s->desc.output.width * s->desc.output.height;
    const uint32_t slot = masu_specular_slot(s);
    const double exposure = masu_linear_exposure(s, slot, light);
    if (!masu_linear_read(s->m, slot, s->desc.output, sum->one)) {
        snprintf(error, error_size, "no radiance to read back");
        return false;
    }
    for (size_t i = 0; i < 3 * pixels; i++) sum->linear[i] += sum->one[i];
    masu_linear_show(s, sum->one, pixels, exposure, sum->one);
    for (size_t i = 0; i < 3 * pixels; i++) sum->display[i] += sum->one[i];
    return true;
}

/* After a cut, live probes have traced all their ray sets after 20 rounds; in the other 236 the
 * bounces between probes converge. */
int masu_picture_settles(const masu_stats_info *stats) {
    return stats->local_shadow_waiting || stats->local_shadow_faces ||
           stats->bounce_rounds_left > 236;
}

static bool settle_lights(masu_session *s, const masu_frame_desc *frame, char *error,
                          size_t error_size) {
    enum { FRAMES_MAX = 256 };
    masu_stats_info stats = {.local_shadow_waiting = 1};
    const masu_scene_data *scene = masu_scene_data_of(&s->scene);
    if (!scene->shadow_lights && !scene->bounce) return true;
    for (int k = 0; k < FRAMES_MAX && masu_picture_settles(&stats); k++) {
        masu_commands commands;
        if (!masu_session_frame(s, frame, true, &commands, error, error_size)) return false;
        if (masu_stats(s->m, commands.slot, &stats, NULL)) stats.local_shadow_waiting = 1;
    }
    return true;
}

static bool add_positions(masu_session *s, masu_frame_desc frame, uint32_t positions, uint32_t rays,
                          sums *sum, void (*progress)(const char *text), char *error,
                          size_t error_size) {
    masu_camera camera;
    if (!masu_picture_camera(s, &frame, &camera, error, error_size)) return false;
    frame.rung = 0;
    frame.time_step = MASU_PICTURE_STEP;
    if (!settle_lights(s, &frame, error, error_size)) return false;
    for (uint32_t i = 0; i < positions; i++) {
        say_position(i, positions, progress);
        masu_picture_place(i, positions, camera.jitter);
        if (!draw_position(s, frame, masu_picture_frames(s, positions, rays), error, error_size) ||
            !add_position(s, frame.light, sum, error, error_size)) {
            return false;
        }
    }
    return true;
}

bool masu_picture_truth(masu_session *s, const masu_frame_desc *frame, uint32_t positions,
                        uint32_t rays, const masu_picture_means *out,
                        void (*progress)(const char *text), char *error, size_t error_size) {
    const size_t pixels = (size_t)s->desc.output.width * s->desc.output.height, values = 3 * pixels;
    sums sum = {calloc(3 * values, sizeof(float)), NULL, NULL};
    if (!sum.linear) {
        snprintf(error, error_size, "out of memory");
        return false;
    }
    sum.display = sum.linear + values;
    sum.one = sum.display + values;
    bool good = add_positions(s, *frame, positions, rays, &sum, progress, error, error_size);
    for (size_t i = 0; i < 2 * values && good; i++) sum.linear[i] /= (float)positions;
    if (good && out->linear) memcpy(out->linear, sum.linear, values * sizeof(float));
    if (good && out->display) masu_srgb_encode(sum.display, pixels, out->display);
    free(sum.linear);
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
    static masu_session s; /* static: it may not move, and is large */
    VkExtent2D size = d->desc.output;
    t->messages = 0;
    if (t->path && masu_file_exists(t->path))
        return masu_picture_load(t->path, size, rgba, error, error_size);
    if (!masu_picture_open(d, t->positions, &s, error, error_size)) return false;
    masu_frame_desc frame = {.time = t->time};
    bool good =
        masu_picture_truth(&s, &frame, t->positions, t->rays,
                           &(masu_picture_means){.display = rgba}, t->progress, error, error_size);
    masu_session_close(&s);
    t->messages = s.host.messages;
    return good && (!t->path || masu_image_save_png(t->path, rgba, size.width, size.height, 0,
                                                    error, error_size));
}

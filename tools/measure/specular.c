/* specular.c: see specular.h. */
#include "measure/specular.h"

#include "measure/texel.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

uint32_t masu_specular_slot(const masu_session *s) {
    uint32_t flights = masu_session_resolved(&s->desc).frames_in_flight;
    return (s->next_slot + flights - 1) % flights;
}

static const uint8_t *row_of(const masu_readback_image *image, uint32_t y) {
    return (const uint8_t *)image->pixels + (size_t)y * image->row_bytes;
}

bool masu_specular_read(masu_session *s, float *rgb) {
    masu_readback_image image;
    if (masu_readback(s->m, masu_specular_slot(s), MASU_READBACK_HDR, &image, NULL)) return false;
    const VkExtent2D size = s->desc.output;
    for (uint32_t y = 0; y < size.height; y++) {
        for (uint32_t x = 0; x < size.width; x++) {
            uint16_t texel[4];
            memcpy(texel, row_of(&image, y) + 8 * (size_t)x, sizeof texel);
            for (int k = 0; k < 3; k++) *rgb++ = masu_texel_half(texel[k]);
        }
    }
    return true;
}

/* Moves the object for a frame; `left`: number of frames that follow. */
static bool place(masu_session *s, const masu_specular_run *run, uint32_t frame, uint32_t left) {
    float rows[12];
    memcpy(rows, run->rows, sizeof rows);
    if (run->motion == MASU_SPECULAR_OBJECT)
        rows[3] -= (float)(run->distance * (double)left * (double)run->step);
    if (run->motion == MASU_SPECULAR_JUMP && frame < run->frames) rows[3] -= (float)run->distance;
    if (run->motion != MASU_SPECULAR_OBJECT && run->motion != MASU_SPECULAR_JUMP) return true;
    return masu_instance_set_transform(s->m, run->object, rows, NULL) == MASU_OK;
}

static double difference(const uint8_t *a, const uint8_t *b, const uint8_t *classes,
                         uint32_t pixels) {
    double sum = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < pixels; i++) {
        if (classes[i] == 0xFF) continue;
        for (int k = 0; k < 3; k++)
            sum += abs((int)a[4 * i + (uint32_t)k] - (int)b[4 * i + (uint32_t)k]);
        count += 3;
    }
    return count ? sum / count : 0;
}

bool masu_specular_draw(masu_session *s, const masu_specular_run *run, float *rgb,
                        const uint8_t *classes, double *flicker, char *error, size_t error_size) {
    uint32_t total = run->frames + (run->motion == MASU_SPECULAR_JUMP ? run->after : 0);
    uint32_t pixels = s->desc.output.width * s->desc.output.height, differences = 0;
    uint8_t *before = flicker ? malloc(4 * (size_t)pixels) : NULL;
    masu_commands commands = {0};
    bool good = !flicker || before;
    if (!good) snprintf(error, error_size, "out of memory");
    if (flicker) *flicker = 0;
    for (uint32_t k = 0; k < total && good; k++) {
        masu_camera camera;
        double time = run->time;
        if (run->motion == MASU_SPECULAR_CAMERA)
            time -= (double)(total - 1 - k) * (double)run->step;
        if (masu_camera_at(s->m, time, &camera, NULL) || !place(s, run, k, total - 1 - k)) {
            snprintf(error, error_size, "no camera, or nothing to move");
            good = false;
            break;
        }
        masu_frame_desc frame = {.camera = &camera,
                                 .time = run->time,
                                 .time_step = run->step,
                                 .rung = run->rung,
                                 .cut = k == 0};
        good = masu_session_frame(s, &frame, true, &commands, error, error_size);
        if (!good || !flicker || k < 16) continue;
        good = masu_headless_target_read(&s->host, &s->targets[0], error, error_size);
        if (!good) break;
        if (k > 16) {
            *flicker += difference(s->targets[0].mapped, before, classes, pixels);
            differences++;
        }
        memcpy(before, s->targets[0].mapped, 4 * (size_t)pixels);
    }
    if (flicker && differences) *flicker /= differences;
    free(before);
    if (good && rgb && !masu_specular_read(s, rgb)) {
        snprintf(error, error_size, "no readback");
        good = false;
    }
    return good;
}

bool masu_specular_classes(masu_session *s, float cutoff, uint8_t *classes) {
    masu_readback_image albedo, normal, depth;
    uint32_t slot = masu_specular_slot(s);
    if (masu_readback(s->m, slot, MASU_READBACK_ALBEDO, &albedo, NULL) ||
        masu_readback(s->m, slot, MASU_READBACK_NORMAL, &normal, NULL) ||
        masu_readback(s->m, slot, MASU_READBACK_DEPTH, &depth, NULL)) {
        return false;
    }
    const VkExtent2D size = s->desc.output;
    for (uint32_t y = 0; y < size.height; y++) {
        for (uint32_t x = 0; x < size.width; x++) {
            uint32_t packed;
            float z, roughness = (float)row_of(&albedo, y)[4 * (size_t)x + 3] / 255.0f;
            memcpy(&packed, row_of(&normal, y) + 4 * (size_t)x, sizeof packed);
            memcpy(&z, row_of(&depth, y) + 4 * (size_t)x, sizeof z);
            int none = !(z > 0.0f) || roughness >= cutoff || masu_texel_is_unlit(packed);
            *classes++ = none                  ? 0xFF
                         : roughness < 0.05f   ? MASU_SPECULAR_MIRROR
                         : roughness < 0.15f   ? MASU_SPECULAR_FILTERED
                         : roughness < 0.25f   ? MASU_SPECULAR_SATIN
                                               : MASU_SPECULAR_ROUGH;
        }
    }
    return true;
}

masu_specular_error masu_specular_compare(const float *rgb, const float *truth,
                                          const uint8_t *classes, uint32_t pixels) {
    masu_specular_error e;
    memset(&e, 0, sizeof e);
    for (uint32_t i = 0; i < pixels; i++) {
        if (classes[i] == 0xFF) continue;
        double sum = 0;
        for (uint32_t k = 0; k < 3; k++) {
            double x = (double)rgb[3 * i + k], t = (double)truth[3 * i + k];
            sum += (x - t) * (x - t) / (t * t + 0.01) / 3;
        }
        e.value[classes[i]] += sum;
        e.pixels[classes[i]]++;
    }
    for (int c = 0; c < MASU_SPECULAR_ALL; c++) {
        e.value[MASU_SPECULAR_ALL] += e.value[c];
        e.pixels[MASU_SPECULAR_ALL] += e.pixels[c];
    }
    for (int c = 0; c < MASU_SPECULAR_CLASSES; c++) {
        if (e.pixels[c]) e.value[c] /= e.pixels[c];
    }
    return e;
}

bool masu_specular_place(const masu_scene *scene, const char *name, float rows[12]) {
    masu_scene_view v = masu_scene_view_of(scene);
    for (uint32_t i = 0; i < masu_scene_count(scene, MASU_SCENE_INSTANCE); i++) {
        if (v.instances[i].name == MASU_BLOB_NONE) continue;
        if (strcmp(v.names + v.instances[i].name, name) != 0) continue;
        memcpy(rows, v.instances[i].transform, sizeof v.instances[i].transform);
        return true;
    }
    return false;
}

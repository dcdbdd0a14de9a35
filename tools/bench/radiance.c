/* radiance.c: see radiance.h. */
#include "bench/radiance.h"

#include "bench/settings.h"
#include "measure/specular.h"
#include "image.h"
#include "metric/hdr_flip.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct result {
    masu_rung key;
    masu_radiance_error error;
} result;

struct masu_radiance_bench {
    masu_radiance_desc d;
    masu_session s;
    bool traced;
    uint32_t pixels, messages, result_count;
    uint8_t *classes;         /* of pixels that trace; NULL if the scene traces none */
    float *reflections, *rgb; /* the reference; the newest image */
    result results[MASU_SETTINGS_MOST];
    char *error;
    size_t error_size;
};

static bool failed(masu_radiance_bench *b, const char *text) {
    snprintf(b->error, b->error_size, "%s: %s", b->d.session.scene_path, text);
    return false;
}

static void close_session(masu_radiance_bench *b) {
    masu_session_close(&b->s);
    b->messages += b->s.host.messages;
}

/* ---- The reference of reflections ------------------------------------------------------------ */

static bool load(masu_radiance_bench *b, bool *there) {
    struct masu_image image;
    VkExtent2D size = b->d.session.desc.output;
    *there = masu_file_exists(b->d.reflections);
    if (!*there) return true;
    if (!masu_image_load_pfm(b->d.reflections, &image, b->error, b->error_size)) return false;
    bool fits = image.width == size.width && image.height == size.height && image.channels == 3;
    if (fits) memcpy(b->reflections, image.values, 3 * sizeof(float) * b->pixels);
    masu_image_free(&image);
    return fits || failed(b, "the reflection reference has another size");
}

/* Renders all rays if there is no file. Otherwise a single frame is enough to find the pixels that
 * trace. */
static bool draw_reference(masu_radiance_bench *b) {
    VkExtent2D size = b->d.session.desc.output;
    masu_specular_run run = {.frames = b->d.rays, .time = b->d.motion.time};
    bool there;
    b->classes = malloc(b->pixels);
    b->reflections = malloc(3 * sizeof(float) * b->pixels);
    if (!b->classes || !b->reflections) return failed(b, "out of memory");
    if (!load(b, &there)) return false;
    if (there) run.frames = 1;
    if (b->d.progress && !there) b->d.progress("reference of reflections");
    if (!masu_specular_draw(&b->s, &run, there ? NULL : b->reflections, NULL, NULL, b->error,
                            b->error_size)) {
        return false;
    }
    if (!masu_specular_classes(&b->s, masu_scene_specular_cutoff(&b->s.scene), b->classes))
        return failed(b, "nothing to read back");
    return there || masu_image_save_pfm(b->d.reflections, b->reflections, size.width, size.height,
                                        3, b->error, b->error_size);
}

static bool find_reference(masu_radiance_bench *b) {
    masu_session_desc d = b->d.session;
    d.desc.debug.reference = 1;
    d.desc.rung_count = 1;
    d.desc.readback =
        MASU_READBACK_HDR | MASU_READBACK_DEPTH | MASU_READBACK_NORMAL | MASU_READBACK_ALBEDO;
    d.no_renderer = true;
    if (!masu_session_open(&d, &b->s, b->error, b->error_size)) return false;
    b->traced = masu_scene_class_of(&b->s.scene) >= MASU_SCENE_POLYGONS_TRACED;
    bool good =
        !b->traced || (masu_session_start(&b->s, b->error, b->error_size) && draw_reference(b));
    close_session(b);
    return good;
}

/* ---- Settings -------------------------------------------------------------------------------- */

static bool whole(const masu_rung *rung) { return rung->scale >= 1.0f; }

/* Clears the knobs that act after the tone curve: they do not affect radiance. */
static masu_rung key_of(const masu_rung *rung) {
    masu_rung key = *rung;
    key.upscale = key.sharpen = MASU_OFF;
    key.sharpness = 0.0f;
    key.easu = MASU_EASU_AUTO;
    key.aa = MASU_AA_OFF;
    return key;
}

static bool shown_as_it_is(const masu_rung *rung) {
    return (rung->aa == MASU_AA_AUTO || rung->aa == MASU_AA_OFF) && rung->sharpen != MASU_ON;
}

static const result *find(const masu_radiance_bench *b, const masu_rung *key) {
    for (uint32_t i = 0; i < b->result_count; i++) {
        if (!memcmp(&b->results[i].key, key, sizeof *key)) return &b->results[i];
    }
    return NULL;
}

static bool draw_key(masu_radiance_bench *b, uint32_t rung, const masu_rung *key, uint64_t *next) {
    VkExtent2D size = b->d.session.desc.output;
    masu_flip flip;
    if (!masu_motion_draw(&b->s, &b->d.motion, rung, key, next, b->error, b->error_size))
        return false;
    if (!masu_specular_read(&b->s, b->rgb)) return failed(b, "no radiance to read back");
    if (!masu_metric_hdr_flip(b->d.truth, b->rgb, size.width, size.height, 0, NULL, &flip))
        return failed(b, "out of memory");
    result *r = &b->results[b->result_count++];
    *r = (result){*key, {flip.mean, (double)NAN}};
    if (!b->traced) return true;
    masu_specular_error e = masu_specular_compare(b->rgb, b->reflections, b->classes, b->pixels);
    if (e.pixels[MASU_SPECULAR_ALL]) r->error.specular_relmse = e.value[MASU_SPECULAR_ALL];
    return true;
}

static bool draw_keys(masu_radiance_bench *b, const masu_rung *keys, uint32_t count) {
    masu_session_desc d = b->d.session;
    uint64_t next = 0;
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = count;
    memcpy(d.desc.rungs, keys, count * sizeof *keys);
    if (!masu_session_open(&d, &b->s, b->error, b->error_size)) return false;
    bool good = true;
    for (uint32_t k = 0; k < count && good; k++) good = draw_key(b, k, &keys[k], &next);
    close_session(b);
    return good;
}

bool masu_radiance_measure(masu_radiance_bench *b, const masu_rung *rungs, uint32_t count,
                           masu_radiance_error *out, char *error, size_t error_size) {
    masu_rung keys[MASU_MAX_RUNGS];
    /* The noise of reflections depends on the frame number, so each setting needs its own
     * renderer. */
    uint32_t n = 0, most = b->d.motion.remembers ? 1 : MASU_MAX_RUNGS;
    b->error = error;
    b->error_size = error_size;
    for (uint32_t i = 0; i < count; i++) {
        const masu_rung key = key_of(&rungs[i]);
        bool there = !whole(&rungs[i]) || find(b, &key);
        for (uint32_t k = 0; k < n && !there; k++) there = !memcmp(&keys[k], &key, sizeof key);
        if (there) continue;
        keys[n++] = key;
        if (n + b->result_count > MASU_SETTINGS_MOST) return failed(b, "too many settings");
        if (n < most) continue;
        if (!draw_keys(b, keys, n)) return false;
        n = 0;
    }
    if (n && !draw_keys(b, keys, n)) return false;
    for (uint32_t i = 0; i < count; i++) {
        const masu_rung key = key_of(&rungs[i]);
        const result *r = whole(&rungs[i]) ? find(b, &key) : NULL;
        out[i] = (masu_radiance_error){(double)NAN, (double)NAN};
        if (!r) continue;
        out[i].specular_relmse = r->error.specular_relmse;
        if (shown_as_it_is(&rungs[i])) out[i].hdr_flip = r->error.hdr_flip;
    }
    return true;
}

masu_radiance_bench *masu_radiance_open(const masu_radiance_desc *d, char *error,
                                        size_t error_size) {
    masu_radiance_bench *b = calloc(1, sizeof *b);
    if (!b) {
        snprintf(error, error_size, "%s: out of memory", d->session.scene_path);
        return NULL;
    }
    b->d = *d;
    b->error = error;
    b->error_size = error_size;
    b->pixels = d->session.desc.output.width * d->session.desc.output.height;
    b->rgb = malloc(3 * sizeof *b->rgb * b->pixels);
    bool good = b->rgb || failed(b, "out of memory");
    if (good && find_reference(b)) return b;
    masu_radiance_close(b);
    return NULL;
}

uint32_t masu_radiance_messages(const masu_radiance_bench *b) { return b->messages; }

void masu_radiance_close(masu_radiance_bench *b) {
    if (!b) return;
    free(b->classes);
    free(b->reflections);
    free(b->rgb);
    free(b);
}

/* light.c: see light.h. */
#include "lab/study/light.h"

#include "image.h"
#include "lab/reference/render.h"
#include "measure/linear.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AROUND = 16 }; /* pixels to each side in which the edge of a leak is searched */

typedef struct point {
    ref_vec p, n;
    bool met; /* the frame and the reference show the same surface */
} point;

typedef struct study {
    const masu_seen_desc *d;
    masu_seen *out;
    char *error;
    size_t error_size, pixels;
    ref_scene scene;
    ref_field field;
    ref_world world;
    bool has_field;
    double exposure;
    point *points;
    float *dark, *lit, *open; /* linear images */
    int8_t *expected;         /* 0, 1; -1: penumbra or not lit */
    uint8_t *picture;
    masu_session s;
} study;

static bool failed(study *w, const char *text) {
    snprintf(w->error, w->error_size, "%s", text);
    return false;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* Without sun, sky and ambient light; the last of `frames` frames of one moment. */
static bool draw(study *w, uint32_t frames, float *rgb) {
    masu_light light;
    masu_commands commands = {.slot = 0};
    if (masu_light_of(w->s.m, &light, NULL) != MASU_OK) return failed(w, "the scene has no light");
    memset(light.sun_color, 0, sizeof light.sun_color);
    memset(light.ambient, 0, sizeof light.ambient);
    memset(light.sky_zenith, 0, sizeof light.sky_zenith);
    memset(light.sky_horizon, 0, sizeof light.sky_horizon);
    light.fog_density = 0;
    masu_frame_desc frame = {.light = &light, .time = w->d->time};
    for (uint32_t i = 0; i < frames; i++) {
        frame.cut = i == 0;
        frame.time_step = i ? 1.0f / 60.0f : 0.0f;
        if (!masu_session_frame(&w->s, &frame, true, &commands, w->error, w->error_size))
            return false;
    }
    return masu_linear_read(w->s.m, commands.slot, w->d->size, rgb) ||
           failed(w, "no image of linear light");
}

/* Only light i; UINT32_MAX: no light. */
static bool choose(study *w, uint32_t chosen, bool shadows,
                   const masu_punctual_light_state *states) {
    for (uint32_t i = 0; i < w->scene.light_count; i++) {
        masu_punctual_light_state state = states[i];
        if (i != chosen) memset(state.color, 0, sizeof state.color);
        state.no_shadow = !shadows;
        if (masu_punctual_light_set(w->s.m, masu_punctual_light_at(w->s.m, i), &state, NULL) !=
            MASU_OK)
            return failed(w, "a light cannot be changed");
    }
    return true;
}

static bool read_states(study *w, masu_punctual_light_state *states) {
    for (uint32_t i = 0; i < w->scene.light_count; i++) {
        if (masu_punctual_light_get(w->s.m, masu_punctual_light_at(w->s.m, i), &states[i], NULL) !=
            MASU_OK)
            return failed(w, "the renderer and the reference count the lights differently");
    }
    return true;
}

static double added(const study *w, const float *rgb, size_t at) {
    double sum = 0;
    for (size_t k = 0; k < 3; k++) sum += (double)rgb[3 * at + k] - (double)w->dark[3 * at + k];
    return sum / 3;
}

/* ---- The reference --------------------------------------------------------------------------- */

static ref_vec pixel_ray(const study *w, const ref_camera *c, size_t at) {
    VkExtent2D size = w->d->size;
    return ref_camera_ray(c, ((double)(at % size.width) + 0.5) / size.width,
                          ((double)(at / size.width) + 0.5) / size.height,
                          (double)size.width / size.height);
}

/* The surface at each pixel's centre, and whether the frame has the same depth there. */
static bool find_points(study *w, uint32_t slot) {
    masu_readback_image depth;
    ref_camera c = ref_camera_at(&w->scene.blob, w->d->time);
    const double near = (double)w->scene.environment->near_distance;
    if (masu_readback(w->s.m, slot, MASU_READBACK_DEPTH, &depth, NULL) != MASU_OK)
        return failed(w, "no depth");
    for (size_t at = 0; at < w->pixels; at++) {
        ref_hit hit, front;
        ref_vec d = pixel_ray(w, &c, at);
        size_t x = at % w->d->size.width, y = at / w->d->size.width;
        const float *row = (const void *)((const uint8_t *)depth.pixels + y * depth.row_bytes);
        w->points[at].met = false;
        if (!ref_world_trace(&w->world, c.eye, d, HUGE_VAL, REF_RAY_ONE_SIDED | REF_RAY_NO_BLENDS,
                             &hit) ||
            !(row[x] > 0))
            continue;
        /* A transparent surface in front reflects the light too, which cannot be separated here. */
        if (ref_world_trace(&w->world, c.eye, d, hit.t * (1 - 1e-6), REF_RAY_ONE_SIDED, &front))
            continue;
        double z = near / (double)row[x], expected = hit.t * ref_dot(d, c.forward);
        if (!(fabs(z - expected) < 0.003 * expected)) continue;
        w->points[at] = (point){ref_world_leave(&w->world, &hit, hit.ng), hit.ng, true};
    }
    return true;
}

/* Visibility of the source from a point: all (1), none (0) or a part (-1). */
static int8_t seen_from(const study *w, const ref_light *light, ref_vec p) {
    ref_vec to = ref_sub(light->position, p), l = ref_unit(to);
    ref_frame f = ref_frame_of(l);
    double golden = REF_PI * (3 - sqrt(5));
    uint32_t met = 0, n = w->d->rays;
    for (uint32_t i = 0; i < n; i++) {
        /* from the centre to the edge */
        double wide = light->radius * sqrt((double)i / (n > 1 ? n - 1 : 1)), phi = i * golden;
        ref_vec q =
            ref_add(light->position, ref_from(&f, ref_v(wide * cos(phi), wide * sin(phi), 0)));
        ref_vec d = ref_sub(q, p);
        /* The bulb blocks nothing; the reference hits an SDF slightly before its surface. */
        double length = ref_length(d), free = length - 1.05 * light->radius;
        met += !(free > 0) ||
               !ref_world_occluded(&w->world, p, ref_scale(d, 1 / length), free, REF_RAY_NO_BLENDS);
    }
    return met == 0 ? 0 : met == n ? 1 : -1;
}

/* ---- Comparison ------------------------------------------------------------------------------ */

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Distance, in texels, from the centre of a pixel to a position that may be lit: the nearest pixel
 * that may be, or the nearest of points around it on its tangent plane, since a pixel may be larger
 * than texels. */
static double depth_of(const study *w, const ref_light *light, size_t at) {
    const int width = (int)w->d->size.width, height = (int)w->d->size.height;
    const int x0 = (int)(at % (size_t)width), y0 = (int)(at / (size_t)width);
    ref_vec p = w->points[at].p;
    double least = HUGE_VAL, half = light->outer >= 0 ? fmin(light->outer, 1.3) : REF_PI / 4;
    for (int y = y0 - AROUND; y <= y0 + AROUND; y++) {
        for (int x = x0 - AROUND; x <= x0 + AROUND; x++) {
            if (x < 0 || y < 0 || x >= width || y >= height) continue;
            size_t other = (size_t)y * (size_t)width + (size_t)x;
            if (w->points[other].met && w->expected[other])
                least = fmin(least, ref_length(ref_sub(w->points[other].p, p)));
        }
    }
    double texel = 2 * tan(half) * ref_length(ref_sub(light->position, p)) / 512;
    static const double radii[] = {0.25, 0.5, 1, 1.5, 2, 3, 4, 6, 8};
    ref_frame f = ref_frame_of(w->points[at].n);
    for (size_t i = 0; i < 12 * sizeof radii / sizeof *radii; i++) {
        double r = radii[i / 12] * texel, phi = (double)(i % 12) * REF_PI / 6;
        if (r >= least) break;
        ref_vec q = ref_add(p, ref_from(&f, ref_v(r * cos(phi), r * sin(phi), 0)));
        if (seen_from(w, light, q)) least = r;
    }
    return least / texel;
}

static bool compare(study *w, uint32_t number, masu_seen_row *row) {
    const ref_light *light = &w->scene.lights[number];
    double *leaks = calloc(w->pixels, sizeof *leaks);
    size_t count = 0;
    if (!leaks) return failed(w, "out of memory");
    *row = (masu_seen_row){.light = number, .spot = light->outer >= 0};
    for (size_t at = 0; at < w->pixels; at++) {
        w->expected[at] = -1;
        if (!w->points[at].met || !(added(w, w->open, at) * w->exposure > 1 / 255.0)) continue;
        row->lit++;
        w->expected[at] = seen_from(w, light, w->points[at].p);
        row->compared += w->expected[at] >= 0;
    }
    for (size_t at = 0; at < w->pixels; at++) {
        memset(w->picture + 4 * at, 255, 4);
        if (w->expected[at] < 0) {
            memset(w->picture + 4 * at, 64, 3);
            continue;
        }
        double found = added(w, w->lit, at) / added(w, w->open, at);
        bool bright = found > w->expected[at] + 0.1, dark = found < w->expected[at] - 0.1;
        row->bright += bright;
        row->dark += dark;
        if (bright && found > 0.5) leaks[count++] = depth_of(w, light, at);
        memset(w->picture + 4 * at, w->expected[at] ? 200 : 110, 3);
        if (bright) w->picture[4 * at] = 255, w->picture[4 * at + 1] = w->picture[4 * at + 2] = 0;
        if (dark) w->picture[4 * at + 2] = 255, w->picture[4 * at] = w->picture[4 * at + 1] = 0;
    }
    qsort(leaks, count, sizeof *leaks, by_value);
    row->leak = count ? leaks[(count * 99) / 100] : 0;
    free(leaks);
    if (!w->d->image_dir) return true;
    char file[4096];
    snprintf(file, sizeof file, "%s/%u.png", w->d->image_dir, number);
    return masu_image_save_png(file, w->picture, w->d->size.width, w->d->size.height, 0, w->error,
                               w->error_size);
}

/* The lights that add the most, brightest first. */
static bool rank(study *w, const masu_punctual_light_state *states, uint32_t *chosen,
                 uint32_t *count) {
    double sums[MASU_SEEN_LIGHTS];
    *count = 0;
    for (uint32_t i = 0; i < w->scene.light_count; i++) {
        double sum = 0;
        uint32_t at = *count;
        if (states[i].shape >= MASU_SHAPE_CAPSULE) continue;
        if (!choose(w, i, false, states) || !draw(w, 1, w->open)) return false;
        for (size_t p = 0; p < w->pixels; p++) sum += fmin(added(w, w->open, p) * w->exposure, 1);
        while (at > 0 && sums[at - 1] < sum) at--;
        if (!(sum > 0) || at >= w->d->lights) continue;
        if (*count < w->d->lights) (*count)++;
        for (uint32_t k = *count - 1; k > at; k--) sums[k] = sums[k - 1], chosen[k] = chosen[k - 1];
        sums[at] = sum;
        chosen[at] = i;
    }
    return true;
}

static bool measure(study *w, masu_punctual_light_state *states) {
    uint32_t chosen[MASU_SEEN_LIGHTS], count;
    masu_commands commands;
    masu_frame_desc frame = {.time = w->d->time, .cut = 1};
    w->exposure = (double)w->scene.environment->exposure;
    if (!masu_session_frame(&w->s, &frame, true, &commands, w->error, w->error_size) ||
        !find_points(w, commands.slot) || !read_states(w, states) ||
        !choose(w, UINT32_MAX, false, states) || !draw(w, 2, w->dark) ||
        !rank(w, states, chosen, &count))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        char text[96];
        snprintf(text, sizeof text, "light %u, %u of %u", chosen[i], i + 1, count);
        if (w->d->progress) w->d->progress(text);
        if (!choose(w, chosen[i], false, states) || !draw(w, 2, w->open) ||
            !choose(w, chosen[i], true, states) || !draw(w, w->d->frames, w->lit) ||
            !compare(w, chosen[i], &w->out->rows[w->out->row_count]))
            return false;
        w->out->row_count++;
    }
    return true;
}

/* ---- The scene, twice ------------------------------------------------------------------------ */

static bool open_reference(study *w) {
    const masu_seen_desc *d = w->d;
    if (!ref_scene_open(d->scene_path, d->time, false, &w->scene, w->error, w->error_size))
        return false;
    if (w->scene.sdf && !d->field_path)
        return failed(w, "the scene has a signed distance field: give its source by --sdf FILE");
    if (w->scene.sdf) {
        w->has_field = ref_field_open(d->field_path, &w->scene.blob, d->time, &w->field, w->error,
                                      w->error_size);
        if (!w->has_field) return false;
    }
    return ref_world_open(&w->scene, w->has_field ? &w->field : NULL,
                          ref_camera_at(&w->scene.blob, d->time).eye, &w->world, w->error,
                          w->error_size);
}

static bool open_renderer(study *w) {
    masu_session_desc d = {.scene_path = w->d->scene_path, .host = w->d->host};
    d.desc.output = w->d->size;
    d.desc.targets.storage = 1;
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){
        .scale = 1, .temporal = MASU_OFF, .specular = MASU_OFF, .bounce = MASU_OFF};
    if (!masu_session_open(&d, &w->s, w->error, w->error_size)) return false;
    snprintf(w->out->driver, sizeof w->out->driver, "%s", w->s.host.driver);
    return true;
}

bool masu_seen_run(const masu_seen_desc *desc, masu_seen *out, char *error, size_t error_size) {
    static study w; /* a session must not move, and is large */
    memset(&w, 0, sizeof w);
    memset(out, 0, sizeof *out);
    w.d = desc;
    w.out = out;
    w.error = error;
    w.error_size = error_size;
    w.pixels = (size_t)desc->size.width * desc->size.height;
    float *memory = calloc(9 * w.pixels, sizeof *memory);
    w.points = calloc(w.pixels, sizeof *w.points);
    w.expected = calloc(w.pixels, 1);
    w.picture = calloc(w.pixels, 4);
    w.dark = memory;
    masu_punctual_light_state *states = NULL;
    bool good = memory && w.points && w.expected && w.picture;
    if (!good) failed(&w, "out of memory");
    good = good && open_reference(&w);
    if (good) {
        w.lit = memory + 3 * w.pixels;
        w.open = memory + 6 * w.pixels;
        states = calloc(w.scene.light_count + 1, sizeof *states);
        good = states != NULL || failed(&w, "out of memory");
    }
    if (good && open_renderer(&w)) {
        good = measure(&w, states);
        masu_session_close(&w.s);
        out->messages = w.s.host.messages;
    } else {
        good = false;
    }
    ref_world_close(&w.world);
    if (w.has_field) ref_field_close(&w.field);
    ref_scene_close(&w.scene);
    free(states);
    free(memory);
    free(w.points);
    free(w.expected);
    free(w.picture);
    return good;
}

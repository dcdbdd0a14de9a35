/* render.c: see render.h. */
#include "lab/reference/render.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { THREADS_MOST = 64 };

ref_camera ref_camera_at(const ref_blob *blob, double time) {
    const masu_blob_camera_key *k = blob->section[MASU_BLOB_CAMERA_KEYS];
    uint64_t count = blob->count[MASU_BLOB_CAMERA_KEYS], i = 0;
    while (i + 1 < count && (double)k[i + 1].time <= time) i++;
    uint64_t next = i + 1 < count ? i + 1 : i;
    double share = 0;
    if (next > i && time > (double)k[i].time)
        share = (time - (double)k[i].time) / ((double)k[next].time - (double)k[i].time);
    ref_camera c;
    c.eye = ref_mix(ref_of(k[i].position), ref_of(k[next].position), share);
    c.forward =
        ref_unit(ref_sub(ref_mix(ref_of(k[i].target), ref_of(k[next].target), share), c.eye));
    c.right = ref_cross(c.forward, ref_v(0, 1, 0));
    c.right = ref_length(c.right) > 1e-9 ? ref_unit(c.right) : ref_v(1, 0, 0);
    c.up = ref_cross(c.right, c.forward);
    c.tangent = tan(0.5 * ((1 - share) * (double)k[i].fov_y + share * (double)k[next].fov_y));
    return c;
}

ref_vec ref_camera_ray(const ref_camera *c, double x, double y, double aspect) {
    ref_vec d = ref_along(c->forward, c->tangent * (2 * x - 1) * aspect, c->right);
    return ref_unit(ref_along(d, c->tangent * (1 - 2 * y), c->up));
}

typedef struct work {
    const ref_render *r;
    ref_image *image;
    atomic_uint next_row;
} work;

static void add(double value, double *sum, double *square) {
    *sum += value;
    *square += value * value;
}

static void pixel(const ref_render *r, ref_image *image, uint32_t x, uint32_t y) {
    double sum[3] = {0}, square[3] = {0}, n = r->paths;
    size_t at = (size_t)y * image->width + x;
    double aspect = (double)image->width / image->height;
    for (uint32_t i = 0; i < r->paths; i++) {
        ref_random random = ref_random_at(r->seed, at, i);
        double px = ref_draw(&random);
        double py = ref_draw(&random);
        ref_vec d =
            ref_camera_ray(&r->camera, (x + px) / image->width, (y + py) / image->height, aspect);
        ref_vec light = ref_radiance(r->tracer, d, &random);
        add(light.x, &sum[0], &square[0]);
        add(light.y, &sum[1], &square[1]);
        add(light.z, &sum[2], &square[2]);
    }
    for (size_t k = 0; k < 3; k++) {
        double mean = sum[k] / n,
               variance = n > 1 ? fmax(square[k] / n - mean * mean, 0) / (n - 1) : 0;
        image->mean[3 * at + k] = (float)mean;
        image->error[3 * at + k] = (float)sqrt(variance);
    }
}

static void rows(work *w, bool reports) {
    for (;;) {
        uint32_t y = atomic_fetch_add(&w->next_row, 1);
        if (y >= w->image->height) return;
        if (reports && w->r->progress) w->r->progress((double)y / w->image->height);
        for (uint32_t x = 0; x < w->image->width; x++) pixel(w->r, w->image, x, y);
    }
}

static void *helper(void *user) {
    rows(user, false);
    return NULL;
}

bool ref_render_image(const ref_render *r, ref_image *image) {
    pthread_t threads[THREADS_MOST];
    uint32_t started = 0, most = r->threads < THREADS_MOST ? r->threads : THREADS_MOST;
    size_t values = 3 * (size_t)image->width * image->height;
    work w = {.r = r, .image = image};
    atomic_init(&w.next_row, 0);
    image->mean = calloc(values, sizeof *image->mean);
    image->error = calloc(values, sizeof *image->error);
    if (!image->mean || !image->error) {
        ref_image_free(image);
        return false;
    }
    ref_ggx_tables();
    while (started + 1 < most && !pthread_create(&threads[started], NULL, helper, &w)) started++;
    rows(&w, true);
    for (uint32_t i = 0; i < started; i++) pthread_join(threads[i], NULL);
    return true;
}

void ref_image_free(ref_image *image) {
    free(image->mean);
    free(image->error);
    image->mean = image->error = NULL;
}

/* shadow.c: see shadow.h. */
#include "support/files.h"
#include "support/shadow.h"

#include "reference/vec.h"
#include "scene/scene.h"
#include "support/scene_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void shadow_open(shadow_test *t, const char *name, uint32_t width, uint32_t height,
                 const masu_rung *rung) {
    size_t bytes;
    memset(t, 0, sizeof *t);
    t->width = width;
    t->height = height;
    masu_session_desc d = test_desc(NULL, width, height);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_ALL & ~(uint32_t)MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    if (rung) d.desc.rungs[0] = *rung;
    open_session(&t->s, &d);
    void *blob = read_file(baked_scene(name), &bytes);
    assert_int_equal(masu_scene_bind(blob, bytes, &t->scene, NULL), MASU_OK);
    masu_scene_view v = masu_scene_view_of(&t->scene);
    double length = 0;
    for (int k = 0; k < 3; k++) {
        t->sun[k] = (double)v.environment->sun_direction[k];
        length += t->sun[k] * t->sun[k];
    }
    for (int k = 0; k < 3; k++) t->sun[k] /= sqrt(length);
    assert_true(masu_ref_triangles_open(&t->scene, &t->world));
    free(blob);
    support_scene_data(&t->scene)->blob = NULL;
}

void shadow_close(shadow_test *t) {
    masu_ref_triangles_close(&t->world);
    close_session(&t->s);
}

void shadow_draw(shadow_test *t, const masu_camera *camera, uint32_t cut) {
    masu_frame_desc frame = {.camera = camera, .cut = cut};
    if (t->own_light) frame.light = &t->light;
    masu_commands commands;
    draw(&t->s, &frame, &commands, NULL);
}

void shadow_sun(shadow_test *t, double azimuth, double elevation) {
    double a = azimuth * (3.14159265358979 / 180), e = elevation * (3.14159265358979 / 180);
    double sun[3] = {cos(e) * sin(a), sin(e), cos(e) * cos(a)}, length = 0;
    t->light = (masu_light){.sun_color = {1, 1, 1}, .exposure = 1};
    for (int k = 0; k < 3; k++) {
        t->light.sun_direction[k] = (float)sun[k];
        t->sun[k] = (double)t->light.sun_direction[k]; /* rounded to float, as on the GPU */
        length += t->sun[k] * t->sun[k];
    }
    for (int k = 0; k < 3; k++) t->sun[k] /= sqrt(length);
    t->own_light = 1;
}

const void *shadow_image(shadow_test *t, masu_readback_bits which) {
    masu_readback_image out;
    masu_stats_info a, b;
    uint32_t slot = 0; /* of the newest frame */
    assert_int_equal(masu_stats(t->s.m, 0, &a, NULL), MASU_OK);
    if (masu_stats(t->s.m, 1, &b, NULL) == MASU_OK && b.frame > a.frame) slot = 1;
    assert_int_equal(masu_readback(t->s.m, slot, which, &out, NULL), MASU_OK);
    return out.pixels;
}

/* ---- Reference ------------------------------------------------------------------------------- */

/* Direction of a pixel's ray, of view depth 1. */
static void ray_of(const shadow_test *t, const masu_camera *c, uint32_t x, uint32_t y,
                   double out[3]) {
    double f[3], r[3], u[3];
    for (int k = 0; k < 3; k++) f[k] = (double)c->forward[k];
    unit3(f);
    r[0] = -f[2], r[1] = 0, r[2] = f[0]; /* forward x up, up is +y */
    unit3(r);
    u[0] = r[1] * f[2] - r[2] * f[1];
    u[1] = r[2] * f[0] - r[0] * f[2];
    u[2] = r[0] * f[1] - r[1] * f[0];
    double tan_y = tan((double)c->fov_y / 2), tan_x = tan_y * t->width / t->height;
    double a = ((x + 0.5) / t->width * 2 - 1) * tan_x, b = ((y + 0.5) / t->height * 2 - 1) * tan_y;
    for (int k = 0; k < 3; k++) out[k] = f[k] + r[k] * a - u[k] * b;
}

int shadow_point_at(const shadow_test *t, const masu_camera *c, const float *depths, uint32_t x,
                    uint32_t y, shadow_point *out) {
    double d[3], back[3];
    double near_distance = (double)c->near_distance;
    float depth = depths[y * t->width + x];
    ray_of(t, c, x, y, d);
    int64_t hit = masu_ref_hit(&t->world, c->position, d, near_distance, HUGE_VAL, &out->z);
    if (hit < 0 || !(depth > 0.0f)) return 0;
    if (fabs(near_distance / (double)depth - out->z) > 1e-3 * out->z) return 0;
    out->triangle = (uint32_t)hit;
    for (int k = 0; k < 3; k++) {
        out->at[k] = c->position[k] + d[k] * out->z;
        back[k] = -d[k];
    }
    if (!masu_ref_normal(&t->world.triangles[hit], t->sun, out->normal)) return 0;
    out->n_l = dot3(out->normal, t->sun);
    out->faces = dot3(out->normal, back) > 0;
    return 1;
}

double shadow_texel(const shadow_test *t, const masu_camera *c, const shadow_point *p,
                    double near_distance, uint32_t *cascade) {
    masu_shadow_view v;
    const masu_rung *rung = &t->s.desc.rungs[0];
    memset(&v, 0, sizeof v);
    double y = tan((double)c->fov_y / 2), x = y * t->width / t->height;
    for (int k = 0; k < 3; k++) {
        v.eye[k] = c->position[k];
        v.forward[k] = (double)c->forward[k];
        v.sun[k] = t->sun[k];
        v.casters[0][k] = 1;
    }
    unit3(v.forward);
    v.tan2 = x * x + y * y;
    v.near_distance = near_distance;
    uint32_t n = masu_scene_shadow_cascades(&t->scene, NULL),
             size = masu_scene_data_of(&t->scene)->shadow_resolution;
    double distance = (double)masu_scene_shadow_distance(&t->scene);
    if (rung->shadow_cascades && rung->shadow_cascades < n) n = rung->shadow_cascades;
    if (rung->shadow_resolution && rung->shadow_resolution < size) size = rung->shadow_resolution;
    for (uint32_t k = 0; k < n; k++) {
        double depth = masu_shadow_split(
            near_distance, distance, (double)masu_scene_data_of(&t->scene)->shadow_lambda, k, n);
        masu_cascade cascade_k = masu_cascade_fit(&v, depth, 0, size);
        double d[3], far = 0;
        for (int i = 0; i < 3; i++) d[i] = p->at[i] - cascade_k.center[i];
        for (int i = 0; i < 2; i++)
            far = fmax(far, fabs(dot3(cascade_k.axis[i], d)) / cascade_k.half);
        /* The next cascade is blended in over the last tenth. */
        *cascade = k;
        if (far <= 0.9 - 3.0 / size || (k + 1 == n && far <= 1)) return 2 * cascade_k.half / size;
    }
    return 0;
}

int shadow_truth(const shadow_test *t, const shadow_point *p) {
    return masu_ref_sun_share(&t->world, p->at, p->triangle, t->sun, 0, 1) > 0.5;
}

double shadow_edge(const shadow_test *t, const shadow_point *p, double texel, double most) {
    double axis[3][3];
    int is = shadow_truth(t, p);
    masu_shadow_axes(t->sun, axis);
    for (int ring = 1; ring <= (int)(4 * most); ring++) {
        for (int i = 0; i < 24; i++) {
            shadow_point q = *p;
            double a = i * (3.14159265358979 / 12), r = 0.25 * ring * texel, d[3];
            for (int k = 0; k < 3; k++) d[k] = r * (axis[0][k] * cos(a) + axis[1][k] * sin(a));
            double along = -dot3(p->normal, d) / p->n_l;
            for (int k = 0; k < 3; k++) q.at[k] += d[k] + along * t->sun[k];
            if (shadow_truth(t, &q) != is) return 0.25 * ring;
        }
    }
    return most + 1;
}

/* camera.c: see camera.h. */
#include "bake/scene/camera.h"

#include <stdio.h>
#include <string.h>

#define FOV_LEAST (0.1 * MASU_BAKE_PI / 180)
#define FOV_MOST (170 * MASU_BAKE_PI / 180)
#define HEIGHT_MOST 1e9

uint32_t masu_bake_camera_count(const masu_bake_content *content) {
    return (uint32_t)(content->cameras.bytes / sizeof(masu_bake_camera));
}

void masu_bake_add_camera(masu_bake_content *content, const char *name, double fov_y, double height,
                          masu_bake_vec3 position, masu_bake_vec3 direction) {
    masu_bake_camera c;
    memset(&c, 0, sizeof c);
    if (!masu_bake_sane(position) || !masu_bake_normalize(&direction) ||
        !(height >= 0 && height <= HEIGHT_MOST) || !(fov_y >= FOV_LEAST && fov_y <= FOV_MOST))
        return;
    snprintf(c.name, sizeof c.name, "%s", name);
    for (char *at = c.name; *at; at++) {
        if ((unsigned char)*at < 0x20 || *at == 0x7F) *at = '?';
    }
    c.fov_y = (float)fov_y;
    c.height = (float)height;
    masu_bake_store(position, c.position);
    masu_bake_store(direction, c.direction);
    masu_bake_append(&content->cameras, &c, sizeof c);
}

const char *masu_bake_check_cameras(const masu_bake_content *piece) {
    if (piece->cameras.bytes % sizeof(masu_bake_camera)) return "half a camera";
    for (uint32_t i = 0; i < masu_bake_camera_count(piece); i++) {
        const masu_bake_camera *c = &MASU_BAKE_CAMERAS(piece)[i];
        const char *end = memchr(c->name, '\0', sizeof c->name);
        if (!end || c->own > (size_t)(end - c->name)) return "a camera whose name does not end";
        double length = masu_bake_length(masu_bake_v3f(c->direction));
        if (!masu_bake_sane(masu_bake_v3f(c->position)) || !(length > 0.99 && length < 1.01) ||
            !((double)c->height >= 0 && (double)c->height <= HEIGHT_MOST * 1.01) ||
            !((double)c->fov_y >= FOV_LEAST * 0.99 && (double)c->fov_y <= FOV_MOST * 1.01))
            return "a camera out of range";
    }
    return NULL;
}

void masu_bake_place_cameras(masu_bake_content *scene, const masu_bake_content *piece,
                             const masu_bake_affine *placement, const char *prefix) {
    const masu_bake_vec3 origin = {0, 0, 0};
    for (uint32_t i = 0; i < masu_bake_camera_count(piece); i++) {
        const masu_bake_camera *from = &MASU_BAKE_CAMERAS(piece)[i];
        masu_bake_vec3 zero = masu_bake_apply(placement, origin);
        masu_bake_vec3 ahead =
            masu_bake_sub(masu_bake_apply(placement, masu_bake_v3f(from->direction)), zero);
        char name[2 * MASU_BAKE_CAMERA_NAME];
        bool named = prefix && *prefix;
        snprintf(name, sizeof name, "%.120s%s%.120s", named ? prefix : "", named ? "/" : "",
                 from->name + from->own);
        uint32_t before = masu_bake_camera_count(scene);
        masu_bake_add_camera(scene, name, (double)from->fov_y,
                             (double)from->height * masu_bake_length(ahead),
                             masu_bake_apply(placement, masu_bake_v3f(from->position)), ahead);
        if (!named || masu_bake_camera_count(scene) == before) continue;
        masu_bake_camera *made = &MASU_BAKE_CAMERAS(scene)[before];
        size_t own = strnlen(prefix, 120) + 1;
        made->own = (uint32_t)(own < strlen(made->name) ? own : 0);
    }
}

const masu_bake_camera *masu_bake_find_camera(const masu_bake_content *content, const char *name) {
    const masu_bake_camera *all = MASU_BAKE_CAMERAS(content);
    for (uint32_t i = 0; i < masu_bake_camera_count(content); i++) {
        if (strcmp(all[i].name, name) == 0) return &all[i];
    }
    for (uint32_t i = 0; i < masu_bake_camera_count(content); i++) {
        if (strcmp(all[i].name + all[i].own, name) == 0) return &all[i];
    }
    return NULL;
}

/* sun.c: see sun.h. */
#include "bake/scene/sun.h"

#include <stdio.h>
#include <string.h>

uint32_t masu_bake_sun_count(const masu_bake_content *content) {
    return (uint32_t)(content->suns.bytes / sizeof(masu_bake_sun));
}

void masu_bake_add_sun(masu_bake_content *content, const char *name, masu_bake_vec3 direction,
                       const double color[3]) {
    masu_bake_sun sun;
    memset(&sun, 0, sizeof sun);
    if (!masu_bake_normalize(&direction) || !(fmax(color[0], fmax(color[1], color[2])) > 0)) return;
    masu_bake_store(direction, sun.direction);
    for (int k = 0; k < 3; k++)
        sun.color[k] = (float)fmin(fmax(color[k], 0), MASU_BAKE_SUN_COLOR_MAX);
    snprintf(sun.name, sizeof sun.name, "%s", name);
    for (char *at = sun.name; *at; at++) {
        if ((unsigned char)*at < 0x20 || *at == 0x7F) *at = '?';
    }
    masu_bake_append(&content->suns, &sun, sizeof sun);
}

const char *masu_bake_check_suns(const masu_bake_content *piece) {
    if (piece->suns.bytes % sizeof(masu_bake_sun)) return "half a directional light";
    for (uint32_t i = 0; i < masu_bake_sun_count(piece); i++) {
        const masu_bake_sun *s = &MASU_BAKE_SUNS(piece)[i];
        double length = masu_bake_length(masu_bake_v3f(s->direction));
        bool good = length > 0.99 && length < 1.01 && memchr(s->name, '\0', sizeof s->name);
        for (int k = 0; k < 3; k++)
            good = good && s->color[k] >= 0 && (double)s->color[k] <= MASU_BAKE_SUN_COLOR_MAX;
        if (!good) return "a directional light out of range";
    }
    return NULL;
}

void masu_bake_place_suns(masu_bake_content *scene, const masu_bake_content *piece,
                          const masu_bake_affine *placement, double factor) {
    const masu_bake_vec3 origin = {0, 0, 0};
    masu_bake_vec3 zero = masu_bake_apply(placement, origin);
    for (uint32_t i = 0; i < masu_bake_sun_count(piece); i++) {
        const masu_bake_sun *s = &MASU_BAKE_SUNS(piece)[i];
        const double color[3] = {(double)s->color[0] * factor, (double)s->color[1] * factor,
                                 (double)s->color[2] * factor};
        masu_bake_vec3 end = masu_bake_apply(placement, masu_bake_v3f(s->direction));
        masu_bake_add_sun(scene, s->name, masu_bake_sub(end, zero), color);
    }
}

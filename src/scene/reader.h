/* reader.h: what checks a blob: scene.c, check_light.c for what lights it, and
 * check_trace.c for what rays are traced through. */
#ifndef MASU_SCENE_READER_H
#define MASU_SCENE_READER_H

#include "base/error.h"
#include "scene/scene.h"

#include <math.h>

typedef struct reader {
    const unsigned char *bytes;
    masu_scene_view view;
    uint64_t counts[MASU_BLOB_KIND_COUNT];
    masu_detail *detail;
} reader;

static inline masu_result bad(reader *r, const char *what, uint64_t element, const char *problem) {
    return masu_fail(r->detail, MASU_ERROR_SCENE, what, 0, element, "scene blob: %s[%llu]: %s",
                     what, (unsigned long long)element, problem);
}

static inline int finite_all(const float *v, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) {
        if (!isfinite(v[i])) return 0;
    }
    return 1;
}

static inline int within(const float *v, uint32_t n, float low, float high) {
    for (uint32_t i = 0; i < n; i++) {
        if (!(v[i] >= low && v[i] <= high)) return 0;
    }
    return 1;
}

static inline int unit_vector(const float v[3]) {
    float square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    return square > 0.98f && square < 1.02f;
}

static inline int name_ok(const reader *r, uint32_t name) {
    return name == MASU_BLOB_NONE || name < r->view.name_bytes;
}

/* Materials beyond their colours, local lights, probes, the sky and fog. After geometry and
 * textures have passed. */
masu_result masu_check_lighting(reader *r);
void masu_look_at_lighting(const reader *r, masu_scene *out);

/* What rays are traced through. After geometry has passed. */
masu_result masu_check_trace(reader *r);
void masu_look_at_trace(const reader *r, masu_scene *out);

#endif

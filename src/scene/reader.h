/* reader.h: reads the container of a blob: its header and section table. Every number of a blob is
 * hostile until it is checked. Sums are computed so that they cannot wrap. Counts fit into 32 bits,
 * which is checked for each section; products are computed in 64 bits. */
#ifndef MASU_SCENE_READER_H
#define MASU_SCENE_READER_H

#include "base/error.h"
#include "scene/blob_section.h"

#include <math.h>

#define MASU_SECTION_MOST 0x7FFFFFFFu /* maximum number of elements of a section */

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

/* Whether box [low, high] contains box [from, to], which may be a point. Culling relies on bounds,
 * so they are validated with this. */
static inline int box_holds(const float *low, const float *high, const float *from,
                            const float *to) {
    for (uint32_t k = 0; k < 3; k++) {
        if (!(low[k] <= from[k] && to[k] <= high[k])) return 0;
    }
    return 1;
}

/* Validates the header of `given` bytes: magic, version, length, hash. */
masu_result masu_read_header(reader *r, uint64_t given);
/* Fills view and counts; call after masu_read_header. */
masu_result masu_read_sections(reader *r, uint64_t given);
/* Name of a section kind for messages. */
const char *masu_section_name(uint32_t kind);

#endif

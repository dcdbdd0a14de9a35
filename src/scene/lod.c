/* lod.c: see lod.h. Comparisons are written so that NaN selects the full-detail mesh. */
#include "scene/lod.h"

#include <math.h>

float masu_lod_scale(const float transform[12]) {
    const float *a = transform, *b = transform + 4, *c = transform + 8;
    float sum = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
    sum = sum + b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
    return sqrtf(sum + c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
}

uint32_t masu_lod_choose(const masu_blob_lod *lods, uint32_t count, float scale, float depth,
                         float pixels, float threshold) {
    uint32_t chosen = 0;
    if (!(depth > 0.0f)) return 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!(lods[i].error * scale * pixels <= threshold * depth)) break;
        chosen = i + 1;
    }
    return chosen;
}

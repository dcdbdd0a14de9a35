/* lod.c: see lod.h. Comparisons are written so that NaN selects the full-detail mesh. */
#include "scene/lod.h"

#include <math.h>

float masu_lod_scale(const float transform[12]) {
    float sum = 0.0f;
    for (int row = 0; row < 3; row++) {
        for (int k = 0; k < 3; k++) sum += transform[row * 4 + k] * transform[row * 4 + k];
    }
    return sqrtf(sum);
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

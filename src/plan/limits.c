/* limits.c: see limits.h. */
#include "plan/limits.h"

#include "base/error.h"
#include "scene/blob.h"
#include "scene/scene.h"

#include <stddef.h>
#include <string.h>

#define LIMIT_ROW(id, most, costs)                                                                 \
    {.name = #id, .offset = offsetof(masu_limits, id), .max = (most), .text = costs},
static const masu_limit limits[] = {MASU_LIMITS(LIMIT_ROW){.name = NULL}};

/* The names as in masu_detail.what. */
#define WHAT(name, ...) "limits." #name,
static const char *const whats[] = {MASU_LIMITS(WHAT)};

/* The members of masu_limits and masu_peak_info have the same offsets. */
#define SAME_PLACE(name, ...)                                                                      \
    _Static_assert(offsetof(masu_limits, name) == offsetof(masu_peak_info, name), #name);
MASU_LIMITS(SAME_PLACE)
#define ONE(...) +1
_Static_assert(sizeof(masu_limits) == sizeof(uint64_t) * (0 MASU_LIMITS(ONE)),
               "masu_limits has members without a row: make docs-tables");

const masu_limit *masu_limit_table(void) { return limits; }

/* ---- Needs ----------------------------------------------------------------------------------- */

void masu_shadow_peak(const masu_desc *d, uint32_t *cascades, uint32_t *size) {
    *cascades = *size = 0;
    uint32_t most, own = masu_scene_shadow_cascades(d->scene, &most);
    for (uint32_t r = 0; r < d->rung_count && own; r++) {
        uint32_t n = masu_at_most(d->rungs[r].shadow_cascades, own);
        uint32_t s = masu_at_most(d->rungs[r].shadow_resolution, most);
        if (*cascades < n) *cascades = n;
        if (*size < s) *size = s;
    }
}

int masu_keeps_blocks(const masu_desc *d) {
    return d->vulkan.texture_compression_bc && !d->deny.compressed_textures;
}

uint64_t masu_desc_texture_bytes(const masu_desc *d) {
    if (!d->scene) return 0;
    return masu_scene_texture_bytes(d->scene, masu_keeps_blocks(d));
}

/* The scene's requirement for each limit, without those that depend on rungs or on the device. */
masu_limits masu_limits_needed(const masu_desc *d) {
    static const masu_limits none;
    if (!d->scene) return none;
    masu_limits needed;
    masu_scene_usage(d->scene, &needed);
    uint32_t cascades, size;
    masu_shadow_peak(d, &cascades, &size);
    needed.shadow_cascades = cascades;
    needed.shadow_resolution = size;
    needed.texture_bytes = masu_desc_texture_bytes(d);
    return needed;
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static masu_result check(const char *what, uint64_t needed, uint64_t limit, masu_detail *detail) {
    if (!limit || needed <= limit) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_LIMIT, what, needed, limit,
                     "%s: the scene needs %llu, the limit is %llu", what,
                     (unsigned long long)needed, (unsigned long long)limit);
}

static uint64_t value_of(const masu_limits *of, uint32_t i) {
    uint64_t value;
    memcpy(&value, (const char *)of + limits[i].offset, sizeof value);
    return value;
}

masu_result masu_limits_check(const masu_desc *d, masu_detail *detail) {
    const masu_limits needed = masu_limits_needed(d);
    masu_result result = MASU_OK;
    for (uint32_t i = 0; limits[i].name && !result; i++) {
        result = check(whats[i], value_of(&needed, i), value_of(&d->limits, i), detail);
        if (!result) result = check(whats[i], value_of(&needed, i), limits[i].max, detail);
    }
    if (result || !d->scene) return result;
    uint64_t sets = masu_scene_data_of(d->scene)->transparent_sets;
    result = check("transparent texture sets", sets, MASU_TRANSPARENT_SETS_MAX, detail);
    if (result) return result;
    return check("transparents times their texture sets", needed.transparents * sets,
                 MASU_TRANSPARENT_DRAWS_MAX, detail);
}

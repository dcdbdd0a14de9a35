/* handles.c: see handles.h. */
#include "frame/handles.h"

#include "base/error.h"

/* Every bit of the result depends on every bit of the number (the last steps of splitmix64). */
static uint64_t mix(uint64_t v) {
    v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9u;
    v = (v ^ v >> 27) * 0x94D049BB133111EBu;
    return v ^ v >> 31;
}

masu_handles masu_handles_of(uint64_t scene, masu_handle_kind kind, uint32_t count,
                             uint32_t reserve, uint32_t *lives) {
    uint32_t offset = (uint32_t)(mix(mix(scene) + (uint64_t)kind) % UINT32_MAX);
    for (uint32_t i = 0; i < reserve; i++) lives[i] = 0;
    return (masu_handles){offset, count + reserve, reserve, lives};
}

uint64_t masu_handle_at(const masu_handles *handles, uint32_t index) {
    uint32_t own = handles->count - handles->reserve;
    if (!masu_handle_lives(handles, index)) return 0;
    uint64_t low = 1 + ((uint64_t)handles->offset + index) % UINT32_MAX;
    uint64_t generation = index < own ? 0 : handles->lives[index - own] >> 1;
    return generation << 32 | low;
}

uint32_t masu_handle_index(const masu_handles *handles, uint64_t id) {
    uint32_t low = (uint32_t)id;
    if (!low) return UINT32_MAX;
    uint32_t index = (uint32_t)(((uint64_t)low - 1 + UINT32_MAX - handles->offset) % UINT32_MAX);
    return masu_handle_at(handles, index) == id ? index : UINT32_MAX;
}

uint32_t masu_handle_free(const masu_handles *handles, uint32_t first, uint32_t count) {
    for (uint32_t i = first; i < first + count; i++) {
        uint32_t lives = handles->lives[i - (handles->count - handles->reserve)];
        if (!(lives & 1u) && lives != MASU_HANDLE_RETIRED) return i;
    }
    return UINT32_MAX;
}

masu_result masu_handle_check(const masu_handles *handles, const char *what, uint64_t id,
                              uint32_t *index, masu_detail *detail) {
    *index = masu_handle_index(handles, id);
    if (*index != UINT32_MAX) return MASU_OK;
    if (!id) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                         "%s handle 0 means none, an object is required", what);
    }
    if (handles->reserve) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                         "%s handle %llu is not of this renderer, or was removed", what,
                         (unsigned long long)id);
    }
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                     "%s handle %llu is not of this renderer's scene, which has %u", what,
                     (unsigned long long)id, handles->count);
}

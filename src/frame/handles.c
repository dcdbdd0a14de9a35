/* handles.c: see handles.h. */
#include "frame/handles.h"

#include "base/error.h"

/* Lives that are told apart, where so many ids are not more than a quarter of all. */
#define GENERATIONS 65536u
#define GENERATIONS_ROOM 0x40000000u

/* Every bit of the result depends on every bit of the number (the last steps of splitmix64). */
static uint64_t mix(uint64_t v) {
    v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9u;
    v = (v ^ v >> 27) * 0x94D049BB133111EBu;
    return v ^ v >> 31;
}

masu_handles masu_handles_of(uint64_t scene, masu_handle_kind kind, uint32_t count, uint32_t reserve,
                             uint32_t *lives) {
    uint32_t generations = reserve > GENERATIONS_ROOM / GENERATIONS ? GENERATIONS_ROOM / reserve : GENERATIONS;
    uint64_t ids = count + (uint64_t)reserve * generations;
    uint64_t places = (uint64_t)UINT32_MAX - ids + 1; /* so that the last is UINT32_MAX at most */
    uint64_t place = mix(mix(scene) + (uint64_t)kind) % places;
    for (uint32_t i = 0; i < reserve; i++) lives[i] = 0;
    return (masu_handles){(uint32_t)(place + 1), count + reserve, reserve, generations, lives};
}

/* Which of the lives that are told apart a number of turns is in. */
static uint32_t generation_of(const masu_handles *handles, uint32_t life) {
    return (life >> 1) % handles->generations;
}

uint32_t masu_handle_at(const masu_handles *handles, uint32_t index) {
    uint32_t own = handles->count - handles->reserve;
    if (!masu_handle_lives(handles, index)) return 0;
    if (index < own) return handles->first + index;
    return handles->first + index + generation_of(handles, handles->lives[index - own]) * handles->reserve;
}

uint32_t masu_handle_index(const masu_handles *handles, uint32_t id) {
    uint32_t own = handles->count - handles->reserve;
    uint32_t index = id - handles->first; /* what lies below wraps to beyond the last */
    if (index < own || !handles->reserve) return index;
    index = own + (index - own) % handles->reserve;
    return masu_handle_at(handles, index) == id ? index : UINT32_MAX;
}

uint32_t masu_handle_free(const masu_handles *handles) {
    for (uint32_t i = handles->count - handles->reserve; i < handles->count; i++) {
        if (!masu_handle_lives(handles, i)) return i;
    }
    return UINT32_MAX;
}

masu_result masu_handle_check(const masu_handles *handles, const char *what, uint32_t id,
                              uint32_t *index, masu_detail *detail) {
    *index = masu_handle_index(handles, id);
    if (*index < handles->count) return MASU_OK;
    if (!id) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                         "%s handle 0 is none of the scene's %u", what, handles->count);
    }
    if (handles->reserve) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                         "%s handle %u is none of this renderer's, or was removed", what, id);
    }
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                     "%s handle %u is not of this renderer's scene, which has %u", what, id,
                     handles->count);
}

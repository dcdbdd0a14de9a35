/* handles.c: see handles.h. */
#include "frame/handles.h"

#include "base/error.h"

/* Every bit of the result depends on every bit of the number (the last steps of splitmix64). */
static uint64_t mix(uint64_t v) {
    v = (v ^ v >> 30) * 0xBF58476D1CE4E5B9u;
    v = (v ^ v >> 27) * 0x94D049BB133111EBu;
    return v ^ v >> 31;
}

masu_handles masu_handles_of(uint64_t scene, masu_handle_kind kind, uint32_t count) {
    uint64_t places = (uint64_t)UINT32_MAX - count + 1; /* so that the last is UINT32_MAX at most */
    uint64_t place = mix(mix(scene) + (uint64_t)kind) % places;
    return (masu_handles){(uint32_t)(place + 1), count};
}

masu_result masu_handle_check(const masu_handles *handles, const char *what, uint32_t id,
                              uint32_t *index, masu_detail *detail) {
    *index = masu_handle_index(handles, id);
    if (*index < handles->count) return MASU_OK;
    if (!id) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                         "%s handle 0 is none of the scene's %u", what, handles->count);
    }
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, handles->count, id,
                     "%s handle %u is not of this renderer's scene, which has %u", what, id,
                     handles->count);
}

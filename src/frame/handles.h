/* handles.h: what a handle of the public interface is made of: the one place that makes and checks them.
 *
 * The handles of one kind are a range of `count` numbers that starts at a place of its own, which follows from
 * the scene's hash and the kind: a handle is that place plus the index. So a handle of another scene, or of
 * another kind, lies outside of the range but for `count` chances in 2^32, and all 2^32 - 1 ids are left for
 * counting. 0 is never in a range: it is "none". Renderers of the same scene have the same ranges, where the
 * same handle means the same thing. (Bits set aside for a stamp would catch less, and bound the count.) */
#ifndef MASU_HANDLES_H
#define MASU_HANDLES_H

#include "masu.h"

typedef enum masu_handle_kind {
    MASU_HANDLE_INSTANCE = 1,
    MASU_HANDLE_MODEL = 2,
    MASU_HANDLE_LIGHT = 3
} masu_handle_kind;

typedef struct masu_handles {
    uint32_t first; /* the id of index 0, at least 1 */
    uint32_t count;
} masu_handles;

/* `scene` is the hash of the blob. */
masu_handles masu_handles_of(uint64_t scene, masu_handle_kind kind, uint32_t count);

/* The id of an index; 0 beyond the last. */
static inline uint32_t masu_handle_at(const masu_handles *handles, uint32_t index) {
    return index < handles->count ? handles->first + index : 0;
}

/* The index of an id, or `count` or more where it is none of these. */
static inline uint32_t masu_handle_index(const masu_handles *handles, uint32_t id) {
    return id - handles->first; /* what lies below wraps to beyond the last */
}

/* The same for what the host gives. MASU_ERROR_ARGUMENT: the detail names `what` ("instance"). */
masu_result masu_handle_check(const masu_handles *handles, const char *what, uint32_t id,
                              uint32_t *index, masu_detail *detail);

#endif

/* handles.h: what a handle of the public interface is made of: the one place that makes and checks them.
 *
 * The handles of one kind are a range of `count` numbers that starts at a place of its own, which follows from
 * the scene's hash and the kind: a handle is that place plus the index. So a handle of another scene, or of
 * another kind, lies outside of the range but for `count` chances in 2^32, and all 2^32 - 1 ids are left for
 * counting. 0 is never in a range: it is "none". Renderers of the same scene have the same ranges, where the
 * same handle means the same thing. (Bits set aside for a stamp would catch less, and bound the count.)
 *
 * RESERVE. What comes and goes has the last `reserve` indices. Its part of the range is longer: once for each life,
 * 65536 lives where there is room, so that the handle of what was removed is none of what took its place. Lives are
 * counted by the owner: an odd number is alive. The place of the range then follows from the reserve too. */
#ifndef MASU_HANDLES_H
#define MASU_HANDLES_H

#include "masu.h"

typedef enum masu_handle_kind {
    MASU_HANDLE_INSTANCE = 1,
    MASU_HANDLE_MODEL = 2,
    MASU_HANDLE_LIGHT = 3,
    MASU_HANDLE_MATERIAL = 4
} masu_handle_kind;

typedef struct masu_handles {
    uint32_t first; /* the id of index 0, at least 1 */
    uint32_t count; /* with the reserve */
    uint32_t reserve;
    uint32_t generations; /* lives that are told apart */
    uint32_t *lives;      /* [reserve]: how often it has come and gone */
} masu_handles;

/* `scene` is the hash of the blob; `count` is without the reserve. `lives`: zero here, and kept; NULL without one. */
masu_handles masu_handles_of(uint64_t scene, masu_handle_kind kind, uint32_t count, uint32_t reserve,
                             uint32_t *lives);

/* Whether an index of the reserve is taken; others always are. */
static inline int masu_handle_lives(const masu_handles *handles, uint32_t index) {
    uint32_t own = handles->count - handles->reserve;
    return index < own || (index < handles->count && (handles->lives[index - own] & 1u));
}

/* The id of an index; 0 beyond the last, and of the reserve where nothing is. */
uint32_t masu_handle_at(const masu_handles *handles, uint32_t index);

/* The index of an id, or `count` or more where it is none of these. */
uint32_t masu_handle_index(const masu_handles *handles, uint32_t id);

/* It comes, or goes: of the reserve. */
static inline void masu_handle_turn(masu_handles *handles, uint32_t index) {
    handles->lives[index - (handles->count - handles->reserve)]++;
}

/* The first free index of the reserve; UINT32_MAX: none. */
uint32_t masu_handle_free(const masu_handles *handles);

/* The same for what the host gives. MASU_ERROR_ARGUMENT: the detail names `what` ("instance"). */
masu_result masu_handle_check(const masu_handles *handles, const char *what, uint32_t id,
                              uint32_t *index, masu_detail *detail);

#endif

/* handles.h: the ids of the public interface. Only this file makes and checks them.
 *
 * The low 32 bits of an id are 1 + an index that is shifted by an offset, which follows from the
 * hash of the scene and the kind. They are never 0, so id 0 is no object. A handle of another scene
 * or of another kind is accepted with a probability of `count` / 2^32. Renderers of the same scene
 * have the same ids.
 *
 * RESERVE. Objects that are added and removed have the last `reserve` indices. `lives` counts
 * additions and removals in a slot: an odd number is alive. The high 32 bits of the id are the
 * number of objects that the slot has had before. A slot is used 2^31 - 1 times, then it is
 * retired, so no id is ever used twice in a renderer. */
#ifndef MASU_HANDLES_H
#define MASU_HANDLES_H

#include "masu.h"

typedef enum masu_handle_kind {
    MASU_HANDLE_INSTANCE = 1,
    MASU_HANDLE_MODEL = 2,
    MASU_HANDLE_LIGHT = 3,
    MASU_HANDLE_MATERIAL = 4
} masu_handle_kind;

#define MASU_HANDLE_RETIRED (UINT32_MAX - 1) /* `lives` of a slot that is used no more */

typedef struct masu_handles {
    uint32_t offset; /* of the low half of the ids, below UINT32_MAX */
    uint32_t count;  /* with the reserve */
    uint32_t reserve;
    uint32_t *lives; /* [reserve] */
} masu_handles;

/* `scene` is the hash of the blob; `count` is without the reserve. `lives` is zeroed here and kept;
 * NULL without a reserve. */
masu_handles masu_handles_of(uint64_t scene, masu_handle_kind kind, uint32_t count,
                             uint32_t reserve, uint32_t *lives);

/* Whether an index is in use: those outside of the reserve always are. */
static inline int masu_handle_lives(const masu_handles *handles, uint32_t index) {
    uint32_t own = handles->count - handles->reserve;
    return index < own || (index < handles->count && (handles->lives[index - own] & 1u));
}

/* The id of an index; 0 beyond the last one, and for a slot of the reserve that is free. */
uint64_t masu_handle_at(const masu_handles *handles, uint32_t index);

/* The index of an id; UINT32_MAX if it is 0, removed, or of another scene or kind. */
uint32_t masu_handle_index(const masu_handles *handles, uint64_t id);

/* An object is added to a slot of the reserve, or removed. */
static inline void masu_handle_turn(masu_handles *handles, uint32_t index) {
    handles->lives[index - (handles->count - handles->reserve)]++;
}

/* The first free one of `count` indices of the reserve from `first` on; UINT32_MAX: none. */
uint32_t masu_handle_free(const masu_handles *handles, uint32_t first, uint32_t count);

/* As masu_handle_index, for ids that the host gives. MASU_ERROR_ARGUMENT: the detail names `what`,
 * "instance" for example. */
masu_result masu_handle_check(const masu_handles *handles, const char *what, uint64_t id,
                              uint32_t *index, masu_detail *detail);

#endif

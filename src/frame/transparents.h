/* transparents.h: what is seen through: one thing for each primitive of a blended material and each
 * instance of its mesh, drawn one by one, the farthest first. transparents.c says how. */
#ifndef MASU_TRANSPARENTS_H
#define MASU_TRANSPARENTS_H

#include "device/vk.h"

#include <stdint.h>

#define MASU_TRANSPARENTS_MAX 4096u       /* things of a scene */
#define MASU_TRANSPARENT_SETS_MAX 64u     /* texture sets that they use */
#define MASU_TRANSPARENT_DRAWS_MAX 65536u /* the product of both */
#define MASU_TRANSPARENT_WORDS 6u         /* of a slot in the buffer of drawn instances */

typedef struct masu_transparent {
    VkDrawIndexedIndirectCommand draw;
    uint32_t instance, material, flags, layers;
    float detail[2];
    uint32_t column; /* which of the texture sets */
    float center[3]; /* of its box, object space */
} masu_transparent;

typedef struct masu_far_first {
    float key; /* the larger comes first; no NaN */
    uint32_t thing;
} masu_far_first;

/* Sorts by falling key; equal keys stay as they are. `scratch` has room for n too. Which of the two
 * arrays holds the result is returned. n log2 n steps, whatever the keys. */
masu_far_first *masu_sort_far_first(masu_far_first *entries, masu_far_first *scratch, uint32_t n);

#endif

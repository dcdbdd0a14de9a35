/*
 * counters.glsl: 64-bit counts of a frame, for masu_stats. Compute only. Each invocation adds to
 * shared memory, one invocation of the group adds the sums to the buffer: one atomic per group
 * instead of one per pixel.
 *
 * masu_count_begin and masu_count_end hold a barrier each: every invocation of the group must reach
 * both.
 */
#ifndef MASU_COUNTERS_GLSL
#define MASU_COUNTERS_GLSL

#include "shared/counters.h"
#include "shared/types.h"

layout(constant_id = 0) const bool masu_counting = false;

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_COUNTERS, std430) buffer Counters
{
    uint masu_counters[2 * MASU_COUNTER_COUNT];
};

shared uint masu_group_counts[MASU_COUNTER_COUNT];

void masu_count_begin()
{
    if (masu_counting) {
        if (gl_LocalInvocationIndex < MASU_COUNTER_COUNT) {
            masu_group_counts[gl_LocalInvocationIndex] = 0u;
        }
        barrier();
    }
}

void masu_count(uint counter, uint n)
{
    if (masu_counting && n > 0u) {
        atomicAdd(masu_group_counts[counter], n);
    }
}

void masu_count_end()
{
    if (masu_counting) {
        barrier();
        uint i = gl_LocalInvocationIndex;
        if (i < MASU_COUNTER_COUNT && masu_group_counts[i] > 0u) {
            uint n = masu_group_counts[i];
            uint low = atomicAdd(masu_counters[2u * i], n);
            if (low + n < low) {
                atomicAdd(masu_counters[2u * i + 1u], 1u);
            }
        }
    }
}

#define MASU_COUNT_REPLACED(n) masu_count(MASU_COUNTER_REPLACED, n)

#endif

/* random.h: the random numbers of the unit tests: splitmix64 (S. Vigna), the same sequence
 * with every compiler. A seed is the number of the case, so that a failing case can be named. */
#ifndef SUPPORT_RANDOM_H
#define SUPPORT_RANDOM_H

#include <stdint.h>

static inline uint64_t support_random(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

/* low .. high, both included; good enough for spans far below 2^64. */
static inline uint64_t support_random_in(uint64_t *state, uint64_t low, uint64_t high) {
    return low + support_random(state) % (high - low + 1);
}

#endif

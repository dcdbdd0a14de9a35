/* random.h: the random numbers of the tests: splitmix64 (S. Vigna), the same sequence with every
 * compiler. The seed is the number of the case, so that a failing case can be reported. */
#ifndef SUPPORT_RANDOM_H
#define SUPPORT_RANDOM_H

#include <math.h>
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

/* Uniform in [0, 1), in steps of 2^-53. */
static inline double random_unit(uint64_t *state) {
    return (double)(support_random(state) >> 11) * 0x1p-53;
}

static inline double random_between(uint64_t *state, double low, double high) {
    return low + (high - low) * random_unit(state);
}

/* Log-uniform. */
static inline double random_spread(uint64_t *state, double low, double high) {
    return exp(random_between(state, log(low), log(high)));
}

/* 32 random bits, and a float in [0, 1) made from them, in steps of 2^-24: for data that shaders
 * read. */
static inline uint32_t random_word(uint64_t *state) { return (uint32_t)support_random(state); }
static inline float random_float(uint64_t *state) {
    return (float)(random_word(state) >> 8) * 0x1p-24f;
}

#endif

/* floats.h: floats and their bits, and half floats as in the images of a frame. */
#ifndef SUPPORT_FLOATS_H
#define SUPPORT_FLOATS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Value of a 16-bit float; NaN and infinities are kept. */
static inline double half_float(uint16_t half) {
    int exponent = half >> 10 & 31, mantissa = half & 1023;
    double v = exponent == 31 ? (mantissa ? (double)NAN : (double)INFINITY)
               : exponent     ? ldexp(mantissa + 1024, exponent - 25)
                              : ldexp(mantissa, -24);
    return half & 0x8000 ? -v : v;
}

/* Converts all channels of a half-float image. */
static inline void floats_of_halves(const void *halves, float *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = (float)half_float(((const uint16_t *)halves)[i]);
}

/* The larger of two errors. NaN is treated as larger than any number and is kept, unlike in fmax. */
static inline double worst_of(double worst, double error) {
    return isnan(worst) || error <= worst ? worst : error;
}

static inline float float_of_bits(uint32_t bits) {
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

static inline uint32_t bits_of_float(float f) {
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits;
}

#endif

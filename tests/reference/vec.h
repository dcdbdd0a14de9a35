/* vec.h: 3D vectors in double precision: a struct, for readable expressions, and an array, for
 * loops over axes. */
#ifndef MASU_REF_VEC_H
#define MASU_REF_VEC_H

#include <math.h>

typedef struct vec {
    double x, y, z;
} vec;

static inline vec vec_of(const float v[3]) {
    return (vec){(double)v[0], (double)v[1], (double)v[2]};
}
static inline vec vec_add(vec a, vec b) { return (vec){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline vec vec_scale(vec a, double s) { return (vec){a.x * s, a.y * s, a.z * s}; }
static inline vec vec_sub(vec a, vec b) { return (vec){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline double vec_dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec vec_cross(vec a, vec b) {
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec vec_unit(vec a) { return vec_scale(a, 1.0 / sqrt(vec_dot(a, a))); }

static inline double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross3(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Normalises it, unless its length is 0; returns the length. */
static inline double unit3(double v[3]) {
    double length = sqrt(dot3(v, v));
    for (int k = 0; k < 3; k++) v[k] /= length > 0 ? length : 1;
    return length;
}

#endif

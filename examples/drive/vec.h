/* vec.h: vectors of doubles: +Y is up, metres. */
#ifndef DRIVE_VEC_H
#define DRIVE_VEC_H

#include <math.h>

#define PI 3.14159265358979323846

typedef struct vec {
    double x, y, z;
} vec;

static inline vec add(vec a, vec b, double times) {
    return (vec){a.x + b.x * times, a.y + b.y * times, a.z + b.z * times};
}
static inline vec mix(vec a, vec b, double t) { return add(add(a, a, -t), b, t); }
static inline double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec cross(vec a, vec b) {
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec unit(vec a) {
    double length = sqrt(dot(a, a));
    return length > 1e-12 ? (vec){a.x / length, a.y / length, a.z / length} : (vec){1, 0, 0};
}
static inline double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

#endif

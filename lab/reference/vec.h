/* vec.h: vectors of three doubles, frames around a direction, and the random numbers of the
 * reference path tracer. */
#ifndef LAB_REFERENCE_VEC_H
#define LAB_REFERENCE_VEC_H

#include <math.h>
#include <stdint.h>

#define REF_PI 3.14159265358979323846

typedef struct ref_vec {
    double x, y, z;
} ref_vec;

static inline ref_vec ref_v(double x, double y, double z) { return (ref_vec){x, y, z}; }
static inline ref_vec ref_splat(double s) { return (ref_vec){s, s, s}; }
static inline ref_vec ref_of(const float f[3]) {
    return (ref_vec){(double)f[0], (double)f[1], (double)f[2]};
}
static inline ref_vec ref_add(ref_vec a, ref_vec b) {
    return ref_v(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline ref_vec ref_sub(ref_vec a, ref_vec b) {
    return ref_v(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline ref_vec ref_mul(ref_vec a, ref_vec b) {
    return ref_v(a.x * b.x, a.y * b.y, a.z * b.z);
}
static inline ref_vec ref_scale(ref_vec a, double s) { return ref_v(a.x * s, a.y * s, a.z * s); }
/* a + s b */
static inline ref_vec ref_along(ref_vec a, double s, ref_vec b) {
    return ref_v(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline ref_vec ref_mix(ref_vec a, ref_vec b, double t) {
    return ref_add(ref_scale(a, 1 - t), ref_scale(b, t));
}
static inline double ref_dot(ref_vec a, ref_vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline ref_vec ref_cross(ref_vec a, ref_vec b) {
    return ref_v(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double ref_length(ref_vec a) { return sqrt(ref_dot(a, a)); }
static inline ref_vec ref_unit(ref_vec a) {
    double l = ref_length(a);
    return l > 0 ? ref_scale(a, 1 / l) : ref_v(0, 1, 0);
}
static inline double ref_max(ref_vec a) { return fmax(a.x, fmax(a.y, a.z)); }
static inline double ref_luminance(ref_vec a) { return 0.2126 * a.x + 0.7152 * a.y + 0.0722 * a.z; }
static inline double ref_clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}
static inline ref_vec ref_reflect(ref_vec v, ref_vec n) { /* v points away from the surface */
    return ref_sub(ref_scale(n, 2 * ref_dot(v, n)), v);
}

/* An orthonormal frame with n as z (Duff et al., JCGT 6-1, 2017). */
typedef struct ref_frame {
    ref_vec x, y, z;
} ref_frame;
static inline ref_frame ref_frame_of(ref_vec n) {
    double sign = copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
    return (ref_frame){ref_v(1 + sign * n.x * n.x * a, sign * b, -sign * n.x),
                       ref_v(b, sign + n.y * n.y * a, -n.y), n};
}
static inline ref_vec ref_to(const ref_frame *f, ref_vec w) {
    return ref_v(ref_dot(w, f->x), ref_dot(w, f->y), ref_dot(w, f->z));
}
static inline ref_vec ref_from(const ref_frame *f, ref_vec w) {
    return ref_along(ref_along(ref_scale(f->x, w.x), w.y, f->y), w.z, f->z);
}

/* ---- Random numbers
 * SplitMix64 (Steele, Lea, Flood 2014) from a counter that starts at a hash of pixel and sample. So
 * a path's numbers do not depend on the number of threads. Draw one per statement: C does not
 * define the order of two calls in one expression. */

typedef struct ref_random {
    uint64_t state;
} ref_random;

static inline uint64_t ref_hash(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}
static inline ref_random ref_random_at(uint64_t seed, uint64_t pixel, uint64_t sample) {
    uint64_t h = ref_hash(seed + 0x9E3779B97F4A7C15u);
    h = ref_hash(h ^ (pixel * 0xD1342543DE82EF95u + 1));
    return (ref_random){ref_hash(h ^ (sample * 0xDABA0B6EB09322E3u + 7))};
}
/* 0 <= u < 1 */
static inline double ref_draw(ref_random *r) {
    r->state += 0x9E3779B97F4A7C15u;
    return (double)(ref_hash(r->state) >> 11) * 0x1p-53;
}

static inline ref_vec ref_cosine_sample(double u, double v) {
    double r = sqrt(u), phi = 2 * REF_PI * v;
    return ref_v(r * cos(phi), r * sin(phi), sqrt(fmax(1 - u, 0)));
}

#endif

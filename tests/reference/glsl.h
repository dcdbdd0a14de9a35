/* glsl.h: the part of GLSL and of shaders/shared/guard.glsl that sources without vector arithmetic
 * need to compile as C: shaders/brdf/vndf.glsl, shaders/noise/sequence.glsl. Include it last, and
 * the shader sources after it; it redefines min, sqrt and uint(x). Its floats are floats, but
 * constants are doubles, so that results are at least as precise as on a device. */
#ifndef MASU_REFERENCE_GLSL_H
#define MASU_REFERENCE_GLSL_H

#include <math.h>
#include <stdint.h>

typedef uint32_t uint;
typedef struct vec2 {
    float x, y;
} vec2;
typedef struct vec3 {
    float x, y, z;
} vec3;
typedef struct masu_axes masu_axes;
typedef struct masu_vndf_ray masu_vndf_ray;

#define vec2(x, y) ((vec2){(float)(x), (float)(y)})
#define vec3(x, y, z) ((vec3){(float)(x), (float)(y), (float)(z)})
#define min(a, b) fminf((float)(a), (float)(b))
#define max(a, b) fmaxf((float)(a), (float)(b))
#define sqrt(x) sqrtf((float)(x))
#define sin(x) sinf((float)(x))
#define cos(x) cosf((float)(x))

static inline float dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/* As defined in guard.glsl. */
#define MASU_GUARD_GLSL
static inline float masu_sane(float x, double lo, double hi) {
    return min(max(isfinite(x) ? x : 0, lo), hi);
}
static inline float masu_rsqrt(float x) { return isfinite(x) && x > 1e-30f ? 1 / sqrtf(x) : 0; }
static inline vec3 masu_normalize(vec3 v, vec3 fallback) {
    float largest = fmaxf(fabsf(v.x), fmaxf(fabsf(v.y), fabsf(v.z)));
    if (!isfinite(v.x) || !isfinite(v.y) || !isfinite(v.z) || !(largest > 1e-30f)) return fallback;
    if (!(largest < 1e30f)) return fallback;
    vec3 u = {v.x / largest, v.y / largest, v.z / largest};
    float r = 1 / sqrtf(dot(u, u));
    return vec3(u.x * r, u.y * r, u.z * r);
}

/* The last: casts above are C's. There is no float(x), because clang warns about it. */
#define uint(x) ((uint)(x))

#endif

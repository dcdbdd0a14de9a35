/* math.h: the little linear algebra of masu-bake, in double precision: blob floats are rounded
 * once, at the end. */
#ifndef MASU_BAKE_MATH_H
#define MASU_BAKE_MATH_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

#define MASU_BAKE_PI 3.14159265358979323846

/* Larger coordinates are treated as damage: their squares, which shaders compute, must be finite
 * in fp32. */
#define MASU_BAKE_COORDINATE_MAX 1e15

typedef struct masu_bake_vec3 {
    double x, y, z;
} masu_bake_vec3;

/* Rows of a 3x4 matrix: p -> M p + t with t in m[3], m[7], m[11]. */
typedef struct masu_bake_affine {
    double m[12];
} masu_bake_affine;

typedef struct masu_bake_box {
    masu_bake_vec3 low, high; /* low > high: empty */
} masu_bake_box;

static inline masu_bake_vec3 masu_bake_v3(double x, double y, double z) {
    return (masu_bake_vec3){x, y, z};
}
static inline masu_bake_vec3 masu_bake_v3f(const float *f) {
    return (masu_bake_vec3){(double)f[0], (double)f[1], (double)f[2]};
}
/* As the blob stores it. */
static inline void masu_bake_store(masu_bake_vec3 v, float out[3]) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}
static inline masu_bake_vec3 masu_bake_sub(masu_bake_vec3 a, masu_bake_vec3 b) {
    return masu_bake_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline masu_bake_vec3 masu_bake_mad(masu_bake_vec3 a, masu_bake_vec3 b, double s) {
    return masu_bake_v3(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline double masu_bake_dot(masu_bake_vec3 a, masu_bake_vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline masu_bake_vec3 masu_bake_cross(masu_bake_vec3 a, masu_bake_vec3 b) {
    return masu_bake_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double masu_bake_length(masu_bake_vec3 a) { return sqrt(masu_bake_dot(a, a)); }

/* Degrees: the azimuth from +Z towards +X, the elevation above the horizon. */
static inline masu_bake_vec3 masu_bake_direction(double azimuth, double elevation) {
    double a = azimuth * (MASU_BAKE_PI / 180.0), e = elevation * (MASU_BAKE_PI / 180.0);
    return masu_bake_v3(cos(e) * sin(a), sin(e), cos(e) * cos(a));
}

static inline bool masu_bake_sane(masu_bake_vec3 a) {
    const double most = MASU_BAKE_COORDINATE_MAX; /* written so that NaN fails */
    return fabs(a.x) <= most && fabs(a.y) <= most && fabs(a.z) <= most;
}

/* Normalizes; false if the vector is zero or not finite. Divides by the largest component first,
 * so that neither tiny nor huge vectors lose their length to the range of double. */
static inline bool masu_bake_normalize(masu_bake_vec3 *a) {
    double most = fmax(fabs(a->x), fmax(fabs(a->y), fabs(a->z)));
    if (!(most > 0.0 && most <= DBL_MAX) || isnan(a->x + a->y + a->z)) return false;
    masu_bake_vec3 v = masu_bake_v3(a->x / most, a->y / most, a->z / most);
    double length = masu_bake_length(v);
    *a = masu_bake_v3(v.x / length, v.y / length, v.z / length);
    return true;
}

static inline masu_bake_affine masu_bake_identity(void) {
    return (masu_bake_affine){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}};
}
static inline masu_bake_affine masu_bake_translation(masu_bake_vec3 t) {
    return (masu_bake_affine){{1, 0, 0, t.x, 0, 1, 0, t.y, 0, 0, 1, t.z}};
}
static inline masu_bake_affine masu_bake_scaling(masu_bake_vec3 s) {
    return (masu_bake_affine){{s.x, 0, 0, 0, 0, s.y, 0, 0, 0, 0, s.z, 0}};
}

/* Counter-clockwise about the axis 0, 1, 2 = x, y, z, viewed from its positive end. */
static inline masu_bake_affine masu_bake_rotation(int axis, double degrees) {
    double angle = degrees * (MASU_BAKE_PI / 180.0), c = cos(angle), s = sin(angle);
    /* Multiples of 90 degrees are common and should be exact, without 6e-17. */
    double quarters = degrees / 90.0;
    if (quarters == floor(quarters)) {
        c = round(c);
        s = round(s);
    }
    if (axis == 0) return (masu_bake_affine){{1, 0, 0, 0, 0, c, -s, 0, 0, s, c, 0}};
    if (axis == 1) return (masu_bake_affine){{c, 0, s, 0, 0, 1, 0, 0, -s, 0, c, 0}};
    return (masu_bake_affine){{c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0}};
}

/* a after b. */
static inline masu_bake_affine masu_bake_multiply(const masu_bake_affine *a,
                                                  const masu_bake_affine *b) {
    masu_bake_affine r;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            double sum = j == 3 ? a->m[i * 4 + 3] : 0.0;
            for (int k = 0; k < 3; k++) sum += a->m[i * 4 + k] * b->m[k * 4 + j];
            r.m[i * 4 + j] = sum;
        }
    }
    return r;
}

/* False: it has no inverse. */
static inline bool masu_bake_invert(const masu_bake_affine *a, masu_bake_affine *out) {
    const double *m = a->m;
    masu_bake_vec3 r[3];
    for (int i = 0; i < 3; i++) r[i] = masu_bake_v3(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
    masu_bake_vec3 c[3] = {masu_bake_cross(r[1], r[2]), masu_bake_cross(r[2], r[0]),
                           masu_bake_cross(r[0], r[1])};
    double d = masu_bake_dot(r[0], c[0]);
    if (!(fabs(d) > 0.0 && fabs(d) <= DBL_MAX)) return false;
    for (int i = 0; i < 3; i++) { /* columns of the inverse are the cross products of the rows */
        out->m[i] = c[i].x / d;
        out->m[4 + i] = c[i].y / d;
        out->m[8 + i] = c[i].z / d;
    }
    for (int i = 0; i < 12; i += 4) {
        double sum = 0.0;
        for (int k = 0; k < 3; k++) sum += out->m[i + k] * m[4 * k + 3];
        out->m[i + 3] = -sum;
    }
    return true;
}

static inline masu_bake_vec3 masu_bake_apply(const masu_bake_affine *a, masu_bake_vec3 p) {
    const double *m = a->m;
    return masu_bake_v3(m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
                        m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                        m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]);
}

static inline bool masu_bake_affine_sane(const masu_bake_affine *a) {
    for (int i = 0; i < 12; i++) {
        if (!(fabs(a->m[i]) <= MASU_BAKE_COORDINATE_MAX)) return false;
    }
    return true;
}

static inline masu_bake_box masu_bake_box_empty(void) {
    return (masu_bake_box){{DBL_MAX, DBL_MAX, DBL_MAX}, {-DBL_MAX, -DBL_MAX, -DBL_MAX}};
}
static inline bool masu_bake_box_is_empty(const masu_bake_box *b) {
    return !(b->low.x <= b->high.x);
}

static inline void masu_bake_box_grow(masu_bake_box *b, masu_bake_vec3 p) {
    b->low = masu_bake_v3(fmin(b->low.x, p.x), fmin(b->low.y, p.y), fmin(b->low.z, p.z));
    b->high = masu_bake_v3(fmax(b->high.x, p.x), fmax(b->high.y, p.y), fmax(b->high.z, p.z));
}

#endif

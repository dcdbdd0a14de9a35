/* punctual_light.c: see punctual_light.h. Computes in double precision until the result is
 * stored. */
#include "scene/punctual_light.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846
/* Bounding spheres are enlarged by this fraction of all lengths involved: 64 ulp of fp32.
 * light_tiles.comp and lights.glsl together lose fewer than 40 ulp. */
#define SLACK 0x1p-17
/* A smaller range is treated as 0: its square has no finite reciprocal. */
#define RANGE_LEAST 1e-15

static double length_of(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/* ---- Checks ---------------------------------------------------------------------------------- */

/* Area of the parallelogram of two half axes. */
static double area_of(const float u[3], const float v[3]) {
    double c[3];
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t i = (k + 1) % 3, j = (k + 2) % 3;
        c[k] = (double)u[i] * (double)v[j] - (double)u[j] * (double)v[i];
    }
    return length_of(c);
}

static const char *axis_wrong(const float axis[3], double *length) {
    double v[3] = {(double)axis[0], (double)axis[1], (double)axis[2]};
    *length = length_of(v);
    return *length >= 1e-6 && *length <= 1e9 ? NULL : "a half axis is not 1e-6 to 1e9 m long";
}

static const char *shape_wrong(const masu_punctual_light_state *s, double *value) {
    double u = 0, v = 0;
    *value = (double)s->shape;
    if ((uint32_t)s->shape > MASU_SHAPE_RECTANGLE) return "shape is not 0 to 3";
    if (s->shape && s->spot) return "spot is 1, but the shape is not a point";
    *value = (double)s->two_sided;
    if (s->two_sided > 1) return "two_sided is neither 0 nor 1";
    *value = (double)s->has_surface;
    if (s->has_surface > 1) return "has_surface is neither 0 nor 1";
    if (s->has_surface && !s->shape) return "has_surface is 1, but the shape is a point";
    if (s->shape < MASU_SHAPE_CAPSULE) return NULL;
    const char *wrong = axis_wrong(s->direction, value);
    u = *value;
    if (wrong || s->shape == MASU_SHAPE_CAPSULE) return wrong;
    wrong = axis_wrong(s->half_axis, value);
    if (wrong) return wrong;
    v = *value;
    *value = area_of(s->direction, s->half_axis) / (u * v);
    return *value >= 1e-3 ? NULL : "the sine of the angle between the half axes is below 0.001";
}

const char *masu_light_state_wrong(const masu_punctual_light_state *s, double *value) {
    float direction = 0.0f;
    for (uint32_t k = 0; k < 3; k++) {
        *value = s->position[k];
        if (!(fabs(s->position[k]) <= 1e15)) return "position is not finite or beyond 1e15 m";
        *value = (double)s->color[k];
        if (!(s->color[k] >= 0.0f && s->color[k] <= 1e9f)) return "color is not 0 to 1e9";
        *value = (double)s->direction[k];
        if (!(fabsf(s->direction[k]) <= 1e15f)) return "direction is not finite or beyond 1e15";
        direction = fmaxf(direction, fabsf(s->direction[k]));
    }
    *value = (double)s->range;
    if (!(s->range >= 0.0f && s->range <= 1e15f)) return "range is not 0 to 1e15 m";
    *value = (double)s->radius;
    if (!(s->radius >= 1e-6f && s->radius <= 1e9f)) return "radius is not 1e-6 to 1e9 m";
    *value = (double)s->spot;
    if (s->spot > 1) return "spot is neither 0 nor 1";
    *value = (double)s->outer;
    if (!(s->outer >= 0.0f && s->outer <= 3.1415928f)) return "outer is not 0 to pi";
    *value = (double)s->inner;
    if (!(s->inner >= 0.0f && s->inner <= s->outer)) return "inner is not 0 to outer";
    *value = (double)s->no_shadow;
    if (s->no_shadow > 1) return "no_shadow is neither 0 nor 1";
    *value = (double)direction;
    if (s->spot && !(direction > 1e-15f)) return "direction of a spot is zero";
    return shape_wrong(s, value);
}

masu_punctual_light_state masu_light_state_of(const masu_blob_light *light) {
    uint32_t type = light->type & MASU_LIGHT_TYPE;
    masu_punctual_light_state s = {.range = light->range,
                                .radius = light->radius,
                                .spot = type == MASU_LIGHT_SPOT,
                                .shape = type > MASU_LIGHT_SPOT
                                             ? (masu_light_shape)(type - MASU_LIGHT_SPOT)
                                             : MASU_SHAPE_POINT,
                                .two_sided = (light->type & MASU_LIGHT_TWO_SIDED) != 0,
                                .has_surface = (light->type & MASU_LIGHT_SURFACE) != 0,
                                .no_shadow = (light->type & MASU_LIGHT_NO_SHADOW) != 0,
                                .inner = light->inner,
                                .outer = light->outer};
    for (uint32_t k = 0; k < 3; k++) {
        s.position[k] = (double)light->position[k];
        s.direction[k] = light->direction[k];
        s.color[k] = light->color[k];
        s.half_axis[k] = light->half_axis[k];
    }
    if (light->parent != MASU_BLOB_NONE) s.instance.id = light->parent + 1;
    return s;
}

double masu_light_solid(const masu_punctual_light_state *s) {
    double u = 0.0, v = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        u += (double)s->direction[k] * (double)s->direction[k];
        v += (double)s->half_axis[k] * (double)s->half_axis[k];
    }
    if (!s->has_surface) return (double)s->radius;
    if (s->shape < MASU_SHAPE_CAPSULE) return 1.02 * (double)s->radius;
    return (double)s->radius + sqrt(u + (s->shape == MASU_SHAPE_RECTANGLE ? v : 0.0));
}

double masu_light_intensity(const masu_punctual_light_state *s, const double direction[3]) {
    double brightest = fmax((double)s->color[0], fmax((double)s->color[1], (double)s->color[2]));
    double radius = (double)s->radius, along = 0.0, across = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        along += direction[k] * direction[k];
        across += (double)s->half_axis[k] * (double)s->half_axis[k];
    }
    switch (s->shape) { /* radiance times projected area, / pi */
    case MASU_SHAPE_SPHERE: return brightest * radius * radius;
    case MASU_SHAPE_CAPSULE: return brightest * (radius * radius + 4.0 / PI * sqrt(along) * radius);
    case MASU_SHAPE_RECTANGLE: return brightest * (4.0 / PI) * sqrt(along * across);
    default: return brightest;
    }
}

/* ---- One light ------------------------------------------------------------------------------- */

/* Bounding sphere of a cone with half angle `angle` and slant length `range`. Below 45 degrees: the
 * sphere through apex and rim. Below 90 degrees: the sphere around the disc of the rim. Otherwise:
 * the sphere of the whole range. */
static masu_light_bound bound_of(const double position[3], const double axis[3], double range,
                                 double angle) {
    masu_light_bound b = {{position[0], position[1], position[2]}, range};
    double along = 0.0;
    if (angle < 0.25 * PI) {
        along = b.radius = range / (2.0 * cos(angle));
    } else if (angle < 0.5 * PI) {
        along = range * cos(angle);
        b.radius = range * sin(angle);
    }
    for (uint32_t k = 0; k < 3; k++) b.center[k] += axis[k] * along;
    b.radius += SLACK * (length_of(position) + length_of(b.center) + range);
    return b;
}

static double versine(double angle) {
    double s = sin(0.5 * angle);
    return 2.0 * s * s;
}

/* Fills the fields of capsules, rectangles, and spheres that are given by their radiance. Returns 0
 * if the light is off. */
static int place_shape(const masu_punctual_light_state *s, const double direction[3],
                       struct masu_punctual_light_data *out) {
    if (s->shape == MASU_SHAPE_SPHERE) {
        for (uint32_t k = 0; k < 3; k++) out->color[k] *= s->radius * s->radius;
    } else {
        for (uint32_t k = 0; k < 3; k++) {
            out->axis[k] = (float)direction[k];
            out->cone[k] = s->shape == MASU_SHAPE_RECTANGLE ? s->half_axis[k] : 0.0f;
        }
        out->cone[3] = s->shape == MASU_SHAPE_RECTANGLE ? 2.0f : 1.0f;
        if (s->shape == MASU_SHAPE_RECTANGLE) {
            out->color[3] = s->two_sided ? 1.0f : 0.0f;
            out->axis[3] = s->radius;
        }
        /* transformed by its instance out of the range */
        if (!(length_of(direction) <= 1e15)) return 0;
        for (uint32_t k = 0; k < 3; k++) {
            if (!(fabsf(out->cone[k]) <= 1e15f)) return 0;
        }
    }
    if (s->has_surface) out->cone[3] += (float)MASU_LIGHT_SHARED;
    return 1;
}

int masu_light_place(const masu_punctual_light_state *s, const double position[3],
                     const double direction[3], struct masu_punctual_light_data *out) {
    double axis[3] = {0, 0, 0}, range = (double)s->range, length = length_of(direction);
    double outer = fmin((double)s->outer, PI);
    int spot = s->spot && (double)s->inner < PI - 1e-6; /* else the light is a point light */
    memset(out, 0, sizeof *out);
    if (!(range >= RANGE_LEAST) || !(length_of(position) <= 1e16)) return 0;
    if (!(s->color[0] > 0.0f || s->color[1] > 0.0f || s->color[2] > 0.0f)) return 0;
    if (spot && !(length > 0.0 && length <= 1e300 && outer > 0.0)) return 0;
    for (uint32_t k = 0; k < 3 && spot; k++) axis[k] = direction[k] / length;
    masu_light_bound b = bound_of(position, axis, range, spot ? outer : PI);
    for (uint32_t k = 0; k < 3; k++) {
        out->position[k] = (float)position[k];
        out->color[k] = s->color[k];
        out->axis[k] = (float)axis[k];
        out->bound[k] = (float)b.center[k];
    }
    out->position[3] = (float)(1.0 / (range * range));
    out->color[3] = s->radius * s->radius;
    out->bound[3] = (float)b.radius;
    /* Point light: every direction has a versine below 4. */
    out->axis[3] = 4.0f;
    out->cone[0] = 1.0f;
    if (s->shape) return place_shape(s, direction, out);
    if (!spot) return 1;
    /* A sharper edge than fp32 can resolve would be noise. */
    double edge = versine(outer) - versine((double)s->inner), sharpest = 0x1p-22 * versine(outer);
    out->axis[3] = (float)versine(outer);
    out->cone[0] = (float)fmin(1.0 / fmax(edge, sharpest), 1e30);
    out->cone[1] = (float)sin(outer);
    out->cone[2] = (float)cos(outer);
    return 1;
}

int masu_light_outside(const float bound[4], const float c[16]) {
    for (uint32_t plane = 0; plane < 5; plane++) {
        double n[3], at = 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            double side = plane < 4 ? (double)c[4 * k + plane / 2] : 0.0;
            n[k] = (double)c[4 * k + 3] + (plane % 2 ? -side : side);
            at += n[k] * (double)bound[k];
        }
        if (at < -(double)bound[3] * length_of(n)) return 1;
    }
    return 0;
}

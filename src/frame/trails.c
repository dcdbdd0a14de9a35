/* trails.c: writes segments of trails to the slot, each as one of the particles (particles.c),
 * with which they are sorted. A segment has a side vector at both ends: perpendicular to the
 * trail and to the line of sight. Two adjacent segments share the side at their joint, the mitre
 * of both. */
#include "frame/sprite_kinds.h"

#include <math.h>
#include <string.h>

static const double farthest = 1e15;
static const float largest = 1e9f, brightest = 4096.0f;
/* of half the joint's angle: a mitre is at most twice as long */
static const double least_cosine = 0.5;

static int is_point(const masu_trail_point *p) {
    int fine = isfinite(p->half_width) && isfinite(p->opacity);
    for (uint32_t k = 0; k < 3; k++)
        fine &= fabs(p->position[k]) <= farthest && isfinite(p->color[k]);
    return fine;
}

static int is_trail(const masu_trail *t) {
    return t->point_count > 1 && isfinite(t->edge) && isfinite(t->soft) && isfinite(t->repeat) &&
           isfinite(t->offset) && (!t->texture || masu_is_cell(t->uv));
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = a[i] * b[j] - a[j] * b[i];
    }
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Unit direction from point i to the next one; returns their distance, 0: there is no segment. */
static double direction_of(const masu_trail *t, uint32_t i, double out[3]) {
    if (i + 1 >= t->point_count) return 0.0; /* also before the first point */
    const masu_trail_point *a = &t->points[i], *b = &t->points[i + 1];
    if (!is_point(a) || !is_point(b)) return 0.0;
    for (uint32_t k = 0; k < 3; k++) out[k] = b->position[k] - a->position[k];
    double length = sqrt(dot(out, out));
    for (uint32_t k = 0; k < 3 && length > 0.0; k++) out[k] /= length;
    return length;
}

/* Unit vector to the left of the trail at a point relative to the camera. */
static void left_of(const double direction[3], const double rel[3], const masu_sprite_eye *eye,
                    double out[3]) {
    cross(direction, rel, out);
    double length = sqrt(dot(out, out));
    int seen_along = !(length > 1e-9 * sqrt(dot(rel, rel)));
    for (uint32_t k = 0; k < 3; k++) out[k] = seen_along ? eye->up[k] : out[k] / length;
}

/* The left side of point i, whose segments have these directions; a length of 0: there is none. */
static void side_of(const masu_trail_point *p, const masu_sprite_eye *eye, const double before[3],
                    double before_length, const double after[3], double after_length,
                    float out[3]) {
    double rel[3], a[3], b[3], sum[3];
    for (uint32_t k = 0; k < 3; k++) rel[k] = p->position[k] - eye->at[k];
    left_of(before_length > 0.0 ? before : after, rel, eye, a);
    left_of(after_length > 0.0 ? after : before, rel, eye, b);
    for (uint32_t k = 0; k < 3; k++) sum[k] = a[k] + b[k];
    double length = sqrt(dot(sum, sum)), cosine = 1.0;
    if (length > 1e-3)
        cosine = fmax(0.5 * length, least_cosine);
    else
        memcpy(sum, b, sizeof sum), length = 1.0; /* reverses direction */
    double width = (double)masu_clamped(p->half_width, 0.0f, largest) / (length * cosine);
    for (uint32_t k = 0; k < 3; k++) out[k] = (float)(sum[k] * width);
}

/* Square of the distance of a segment's centre, or below 0 if it is not drawn. */
static double square_of(const masu_trail *t, uint32_t i, const masu_sprite_eye *eye) {
    const masu_trail_point *p = &t->points[i];
    double unused[3], rel[2][3], seen[2][3], square = 0.0;
    if (!(direction_of(t, i, unused) > 0.0)) return -1.0;
    if (!(p[0].opacity > 0.0f || p[1].opacity > 0.0f) ||
        !(p[0].half_width > 0.0f || p[1].half_width > 0.0f))
        return -1.0;
    for (uint32_t e = 0; e < 2; e++) {
        for (uint32_t k = 0; k < 3; k++) rel[e][k] = p[e].position[k] - eye->at[k];
        masu_to_eye(eye, rel[e], seen[e]);
    }
    if (!(seen[0][2] > eye->near_distance || seen[1][2] > eye->near_distance)) return -1.0;
    for (uint32_t k = 0; k < 3; k++) {
        double middle = 0.5 * (rel[0][k] + rel[1][k]);
        square += middle * middle;
    }
    return square;
}

uint32_t masu_trails_sort(const masu_frame_data *f, const masu_sprite_eye *eye,
                          masu_back_to_front *order) {
    uint32_t count = 0, first = f->plan->desc.reserve.particles;
    for (uint32_t n = 0; n < f->desc.trail_count; n++) {
        const masu_trail *t = &f->desc.trails[n];
        for (uint32_t i = 0; is_trail(t) && i + 1 < t->point_count; i++) {
            double square = square_of(t, i, eye);
            if (square >= 0.0)
                order[count++] = (masu_back_to_front){(float)fmin(square, 3e38), first + i};
        }
        first += t->point_count;
    }
    return count;
}

static void write_point(const masu_trail_point *p, float to[4]) {
    for (uint32_t k = 0; k < 3; k++) to[k] = masu_clamped(p->color[k], 0.0f, brightest);
    to[3] = masu_clamped(p->opacity, 0.0f, 1.0f);
}

/* u: texture coordinates of both ends; sides: of both. */
static void write_segment(const masu_trail *t, uint32_t i, const masu_sprite_eye *eye,
                          const double u[2], float sides[2][3], unsigned char *to) {
    float v[4 * MASU_TEXTURED_PARTICLE_VEC4S] = {0};
    const masu_trail_point *p = &t->points[i];
    const uint32_t flags =
        (t->flags & (MASU_PARTICLE_LIT | MASU_PARTICLE_ADDITIVE)) | MASU_SPRITE_SEGMENT;
    double whole = floor(u[0]); /* a float has no precision left for many repetitions */
    for (uint32_t k = 0; k < 3; k++) {
        v[k] = (float)(p[0].position[k] - eye->at[k]);
        v[4 + k] = (float)(p[1].position[k] - eye->at[k]);
        v[20 + k] = sides[0][k];
        v[24 + k] = sides[1][k];
    }
    v[3] = masu_clamped(t->soft, 0.0f, largest);
    v[7] = (float)(u[0] - whole);
    write_point(&p[0], &v[8]);
    memcpy(&v[12], &flags, sizeof flags);
    v[13] = (float)fmin(u[1] - whole, 1e6);
    memcpy(&v[14], &t->texture, sizeof t->texture);
    if (t->texture) masu_cell_write(t->uv, &v[16]);
    v[23] = masu_clamped(t->edge, 0.0f, 1.0f);
    write_point(&p[1], &v[28]);
    memcpy(to, v, sizeof v);
}

static void write_trail(const masu_trail *t, const masu_sprite_eye *eye,
                        const masu_back_to_front *places, unsigned char *to) {
    double d[3][3], lengths[3] = {0.0, direction_of(t, 0, d[1]), 0.0}, whole = 0.0, at = 0.0;
    float sides[2][3];
    if (t->repeat > 0.0f) {
        whole = (double)t->repeat;
        at = (double)t->offset;
    } else {
        for (uint32_t i = 0; i + 1 < t->point_count; i++) whole += direction_of(t, i, d[2]);
    }
    memset(d[0], 0, sizeof d[0]);
    for (uint32_t i = 0; i + 1 < t->point_count; i++) {
        lengths[2] = direction_of(t, i + 1, d[2]);
        const double u[2] = {at / whole, (at + lengths[1]) / whole};
        if (places[i].thing != UINT32_MAX) {
            side_of(&t->points[i], eye, d[0], lengths[0], d[1], lengths[1], sides[0]);
            side_of(&t->points[i + 1], eye, d[1], lengths[1], d[2], lengths[2], sides[1]);
            write_segment(t, i, eye, u, sides,
                          to + (size_t)places[i].thing * MASU_TEXTURED_PARTICLE_VEC4S *
                                   sizeof(masu_vec4));
        }
        at += lengths[1];
        memmove(d[0], d[1], 2 * sizeof d[0]);
        lengths[0] = lengths[1], lengths[1] = lengths[2];
    }
}

void masu_trails_write(const masu_frame_data *f, const masu_sprite_eye *eye,
                       const masu_back_to_front *places, unsigned char *to) {
    for (uint32_t n = 0; n < f->desc.trail_count; n++) {
        const masu_trail *t = &f->desc.trails[n];
        if (is_trail(t)) write_trail(t, eye, places, to);
        places += t->point_count;
    }
}

/* debug_lines.c: writes debug lines to the slot as two image positions each. Lines are clipped
 * in double at the near plane and at the image edges, so that all values fit into a float and 1
 * / depth is linear between the ends. */
#include "frame/sprite_kinds.h"

#include <math.h>
#include <string.h>

enum { SIDES = 5 };

/* How far a point is inside of each side; all are linear in it. */
static void inside(const masu_sprite_eye *e, const double p[3], double out[SIDES]) {
    out[0] = p[2] - e->near_distance;
    out[1] = p[2] * e->tan_x - p[0];
    out[2] = p[2] * e->tan_x + p[0];
    out[3] = p[2] * e->tan_y - p[1];
    out[4] = p[2] * e->tan_y + p[1];
}

/* The visible part from t[0] to t[1]; returns 0 if there is none. */
static int clip(const masu_sprite_eye *e, const double a[3], const double b[3], double t[2]) {
    double from[SIDES], to[SIDES];
    inside(e, a, from);
    inside(e, b, to);
    t[0] = 0.0, t[1] = 1.0;
    for (uint32_t k = 0; k < SIDES; k++) {
        if (from[k] < 0.0 && to[k] < 0.0) return 0;
        double cut = from[k] / (from[k] - to[k]);
        if (from[k] < 0.0) t[0] = fmax(t[0], cut);
        if (to[k] < 0.0) t[1] = fmin(t[1], cut);
    }
    return t[0] <= t[1];
}

static int is_fine(const masu_line *l) {
    int fine = 1;
    for (uint32_t k = 0; k < 3; k++) fine &= fabs(l->from[k]) <= 1e15 && fabs(l->to[k]) <= 1e15;
    return fine;
}

static void write_end(const masu_line *l, const masu_sprite_eye *e, const double a[3],
                      const double b[3], double t, float out[4]) {
    double p[3];
    uint32_t word = (l->flags & MASU_LINE_ON_TOP) << 24;
    for (uint32_t k = 0; k < 3; k++) {
        p[k] = a[k] + (b[k] - a[k]) * t;
        double c =
            (double)l->from_color[k] + ((double)l->to_color[k] - (double)l->from_color[k]) * t;
        word |= (uint32_t)(c + 0.5) << 8 * k;
    }
    double z = fmax(p[2], e->near_distance);
    out[0] = masu_clamped((float)(p[0] / (z * e->tan_x)), -1.0f, 1.0f);
    out[1] = masu_clamped((float)(-p[1] / (z * e->tan_y)), -1.0f, 1.0f);
    out[2] = (float)(e->near_distance / z);
    memcpy(&out[3], &word, sizeof word);
}

uint32_t masu_debug_lines_write(const masu_frame_data *f, const masu_sprite_eye *eye,
                                unsigned char *to) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < f->desc.line_count; i++) {
        const masu_line *l = &f->desc.lines[i];
        double rel[2][3], ends[2][3], t[2];
        for (uint32_t k = 0; k < 3; k++) {
            rel[0][k] = l->from[k] - eye->at[k];
            rel[1][k] = l->to[k] - eye->at[k];
        }
        masu_to_eye(eye, rel[0], ends[0]);
        masu_to_eye(eye, rel[1], ends[1]);
        if (!is_fine(l) || !clip(eye, ends[0], ends[1], t)) continue;
        float v[4 * MASU_LINE_VEC4S];
        write_end(l, eye, ends[0], ends[1], t[0], v);
        write_end(l, eye, ends[0], ends[1], t[1], v + 4);
        memcpy(to + count++ * sizeof v, v, sizeof v);
    }
    return count;
}

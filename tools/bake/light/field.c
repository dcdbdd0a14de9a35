/* field.c: see field.h. A ray marches each part separately, within the part's box, always in the
 * part that it could hit first: most parts are evaluated once or never. */
#include "bake/light/field.h"
#include "bake/base/file.h"
#include "bake/shader/sdf.h"
#include "cli/cli.h"
#include "sdfc/sdfc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MAX 1024
#define NEAR_ENOUGH 2e-5 /* metres, and of the way to there */
#define ROOM_MAX 4096u   /* variables of a part */
#define PARTS_MAX MASU_SDFC_PARTS_MAX

/* A part, and the box that holds it. */
typedef struct boxed {
    double low[3], high[3];
    double lipschitz;
    uint32_t part;
} boxed;

struct masu_bake_field {
    masu_bake_buffer text;
    masu_sdfc_field *field;
    boxed *parts;
    uint32_t count;
    boxed all;
    double longest;
};

/* fmax and fmin of a libm are calls. NaN in b: a. */
static double larger(double a, double b) { return b > a ? b : a; }
static double smaller(double a, double b) { return b < a ? b : a; }

masu_bake_field *masu_bake_field_make(const masu_bake_content *content, const char *source) {
    if (!source || !masu_bake_count(content, MASU_BLOB_SDF)) return NULL;
    if (!masu_bake_is_sdf(source)) {
        masu_cli_warn(
            "%s: light probes do not know hand-written GLSL: it blocks no light of theirs", source);
        return NULL;
    }
    const masu_blob_sdf *sdf = MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, const masu_blob_sdf);
    masu_bake_field *f = masu_bake_allocate(sizeof *f);
    memset(f, 0, sizeof *f);
    if (masu_bake_read_file(source, MASU_SDFC_SOURCE_MAX, &f->text))
        f->field = masu_sdfc_field_open((const char *)f->text.data, f->text.bytes, source);
    if (!f->field || masu_sdfc_field_room(f->field) > ROOM_MAX) {
        masu_cli_warn("%s: light probes cannot evaluate it: it blocks no light of theirs", source);
        masu_bake_field_release(f);
        return NULL;
    }
    uint32_t count, unknown = 0;
    const masu_sdfc_part *parts = masu_sdfc_field_parts(f->field, &count);
    f->parts = masu_bake_allocate((count + 1) * sizeof *f->parts);
    for (uint32_t i = 0; i < count; i++) {
        boxed *b = &f->parts[f->count];
        unknown += parts[i].user;
        if (parts[i].user) continue;
        for (int k = 0; k < 3; k++) {
            b->low[k] = parts[i].low[k] - 1e-3;
            b->high[k] = parts[i].high[k] + 1e-3;
        }
        b->lipschitz = fmax(parts[i].lipschitz, 1e-6);
        b->part = i;
        f->count++;
    }
    if (unknown)
        masu_cli_warn(
            "%s: light probes do not know the GLSL of %u parts: they block no light of theirs",
            source, unknown);
    for (int k = 0; k < 3; k++) {
        f->all.low[k] = (double)sdf->bounds_min[k];
        f->all.high[k] = (double)sdf->bounds_max[k];
    }
    f->longest = (double)sdf->max_distance;
    return f;
}

void masu_bake_field_release(masu_bake_field *f) {
    if (!f) return;
    masu_sdfc_field_close(f->field);
    masu_bake_release(&f->text);
    free(f->parts);
    free(f);
}

/* The part of the ray within a box. */
static bool clip(const boxed *box, const double o[3], const double d[3], double *near,
                 double *far) {
    double from = *near, to = *far;
    for (int k = 0; k < 3; k++) {
        if (fabs(d[k]) < 1e-12) {
            if (!(o[k] >= box->low[k] && o[k] <= box->high[k])) return false;
            continue;
        }
        double a = (box->low[k] - o[k]) / d[k], b = (box->high[k] - o[k]) / d[k];
        from = larger(from, smaller(a, b));
        to = smaller(to, larger(a, b));
        if (!(from < to)) return false;
    }
    *near = from;
    *far = to;
    return from < to;
}

/* A part that the ray could hit: not before `until`, and not from `end` on. */
typedef struct waiting {
    double until, end;
    const boxed *part;
} waiting;

typedef struct met {
    double room[ROOM_MAX];
    waiting parts[PARTS_MAX];
    uint32_t count;
} met;

static void list_parts(const masu_bake_field *f, const double o[3], const double d[3], double near,
                       double far, met *m) {
    m->count = 0;
    for (uint32_t i = 0; i < f->count; i++) {
        waiting *w = &m->parts[m->count];
        *w = (waiting){near, far, &f->parts[i]};
        m->count += clip(w->part, o, d, &w->until, &w->end);
    }
}

static void fill(const masu_bake_field *f, met *m, const double p[3], const float d[3], double t,
                 bool back, uint32_t part, masu_bake_hit *hit) {
    double n[3], length = 0, look[MASU_SDFC_MATERIAL_SLOTS], h = 1e-5 * (1 + t), towards = 0;
    for (int k = 0; k < 3; k++) {
        double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[k] += h;
        b[k] -= h;
        n[k] = masu_sdfc_field_run(f->field, part, a, m->room) -
               masu_sdfc_field_run(f->field, part, b, m->room);
        length += n[k] * n[k];
    }
    length = sqrt(length);
    for (int k = 0; k < 3; k++) {
        n[k] = length > 0 ? n[k] / length : -(double)d[k];
        towards += n[k] * (double)d[k];
    }
    masu_sdfc_field_material(f->field, part, p, n, 0, m->room, look);
    for (int k = 0; k < 3; k++) {
        hit->normal[k] = (float)(towards > 0 ? -n[k] : n[k]);
        hit->position[k] = (float)(p[k] + 4 * (NEAR_ENOUGH * (1 + t)) * (double)hit->normal[k]);
        hit->albedo[k] = (float)fmin(fmax(look[k], 0), 1);
        hit->emissive[k] = (float)fmax(look[4 + k], 0);
    }
    hit->t = (float)t;
    hit->back = back;
}

bool masu_bake_field_ray(const masu_bake_field *f, const float origin[3], const float direction[3],
                         float far, masu_bake_hit *hit) {
    double o[3], d[3], start = 0, end = smaller((double)far, f->longest);
    met m;
    for (int k = 0; k < 3; k++) o[k] = (double)origin[k], d[k] = (double)direction[k];
    if (!clip(&f->all, o, d, &start, &end)) return false;
    list_parts(f, o, d, start, end, &m);
    for (int i = 0; i < STEPS_MAX && m.count; i++) {
        uint32_t next = 0;
        for (uint32_t k = 1; k < m.count; k++) {
            if (m.parts[k].until < m.parts[next].until) next = k;
        }
        waiting *w = &m.parts[next];
        double t = w->until, enough = NEAR_ENOUGH * (1 + t);
        const double p[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
        double away =
            masu_sdfc_field_run(f->field, w->part->part, p, m.room) / w->part->lipschitz;
        if (away < enough && !(t == 0 && away > 0)) {
            if (hit) fill(f, &m, p, direction, t, t == 0, w->part->part, hit);
            return true;
        }
        w->until = t + larger(enough, away);
        if (w->until >= w->end) *w = m.parts[--m.count];
    }
    return false;
}

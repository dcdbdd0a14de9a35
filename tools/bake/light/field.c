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

struct masu_bake_field {
    masu_bake_buffer text;
    masu_sdfc_field *field;
    const masu_sdfc_part *parts;
    uint32_t count;
    double low[3], high[3], longest;
};

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
    f->parts = masu_sdfc_field_parts(f->field, &f->count);
    uint32_t unknown = 0;
    for (uint32_t i = 0; i < f->count; i++) unknown += f->parts[i].user;
    if (unknown)
        masu_cli_warn(
            "%s: light probes do not know the GLSL of %u parts: they block no light of theirs",
            source, unknown);
    for (int k = 0; k < 3; k++) {
        f->low[k] = (double)sdf->bounds_min[k];
        f->high[k] = (double)sdf->bounds_max[k];
    }
    f->longest = (double)sdf->max_distance;
    return f;
}

void masu_bake_field_release(masu_bake_field *f) {
    if (!f) return;
    masu_sdfc_field_close(f->field);
    masu_bake_release(&f->text);
    free(f);
}

/* The part of the ray within a box. */
static bool clip(const double low[3], const double high[3], const double o[3], const double d[3],
                 double *near, double *far) {
    for (int k = 0; k < 3; k++) {
        if (fabs(d[k]) < 1e-12) {
            if (!(o[k] >= low[k] && o[k] <= high[k])) return false;
            continue;
        }
        double a = (low[k] - o[k]) / d[k], b = (high[k] - o[k]) / d[k];
        *near = fmax(*near, fmin(a, b));
        *far = fmin(*far, fmax(a, b));
    }
    return *near < *far;
}

/* A part that the ray could hit: not before `until`, and not from `end` on. */
typedef struct waiting {
    uint32_t part;
    double until, end;
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
        const masu_sdfc_part *p = &f->parts[i];
        double low[3], high[3];
        waiting *w = &m->parts[m->count];
        if (p->user) continue;
        for (int k = 0; k < 3; k++) {
            low[k] = p->low[k] - 1e-3;
            high[k] = p->high[k] + 1e-3;
        }
        *w = (waiting){i, near, far};
        m->count += clip(low, high, o, d, &w->until, &w->end);
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
    double o[3], d[3], start = 0, end = fmin((double)far, f->longest);
    met m;
    for (int k = 0; k < 3; k++) o[k] = (double)origin[k], d[k] = (double)direction[k];
    if (!clip(f->low, f->high, o, d, &start, &end)) return false;
    list_parts(f, o, d, start, end, &m);
    for (int i = 0; i < STEPS_MAX && m.count; i++) {
        uint32_t next = 0;
        for (uint32_t k = 1; k < m.count; k++) {
            if (m.parts[k].until < m.parts[next].until) next = k;
        }
        waiting *w = &m.parts[next];
        double t = w->until, enough = NEAR_ENOUGH * (1 + t);
        const double p[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
        double away = masu_sdfc_field_run(f->field, w->part, p, m.room) /
                      fmax(f->parts[w->part].lipschitz, 1e-6);
        if (away < enough && !(t == 0 && away > 0)) {
            if (hit) fill(f, &m, p, direction, t, t == 0, w->part, hit);
            return true;
        }
        w->until = t + fmax(away, enough);
        if (w->until >= w->end) *w = m.parts[--m.count];
    }
    return false;
}

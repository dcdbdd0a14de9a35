/* field.c: see field.h. A ray marches only those parts whose bounding sphere it meets. */
#include "bake/light/field.h"
#include "bake/base/file.h"
#include "bake/shader/sdf.h"
#include "cli/cli.h"
#include "sdfc/sdfc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STEPS_MAX 256
#define NEAR_ENOUGH 2e-5 /* metres, and of the way to there */
#define ROOM_MAX 4096u   /* variables of a part */
#define MET_MAX 512u     /* parts that a ray may meet; of more all are marched */

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
        masu_cli_warn("%s: light probes do not know hand-written GLSL: it blocks no light of theirs", source);
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
        masu_cli_warn("%s: light probes do not know the GLSL of %u parts: they block no light of theirs", source, unknown);
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

/* The part of the ray within the bounds. */
static bool clip(const masu_bake_field *f, const double o[3], const double d[3], double *near, double *far) {
    for (int k = 0; k < 3; k++) {
        if (fabs(d[k]) < 1e-12) {
            if (o[k] < f->low[k] || o[k] > f->high[k]) return false;
            continue;
        }
        double a = (f->low[k] - o[k]) / d[k], b = (f->high[k] - o[k]) / d[k];
        *near = fmax(*near, fmin(a, b));
        *far = fmin(*far, fmax(a, b));
    }
    return *near < *far;
}

static bool can_meet(const masu_sdfc_part *p, const double o[3], const double d[3], double near, double far) {
    double along = 0, square = 0;
    if (p->user) return false;
    if (!(p->radius >= 0)) return true;
    for (int k = 0; k < 3; k++) along += (p->center[k] - o[k]) * d[k];
    along = fmin(fmax(along, near), far);
    for (int k = 0; k < 3; k++) {
        double off = o[k] + along * d[k] - p->center[k];
        square += off * off;
    }
    double reach = p->radius + 1e-4;
    return square <= reach * reach;
}

typedef struct met {
    double room[ROOM_MAX];
    uint32_t parts[MET_MAX], count;
    bool all;
} met;

static double distance(const masu_bake_field *f, met *m, const double p[3], uint32_t *part) {
    double least = HUGE_VAL;
    uint32_t count = m->all ? f->count : m->count;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t n = m->all ? i : m->parts[i];
        if (f->parts[n].user) continue;
        double d = masu_sdfc_field_run(f->field, n, p, m->room) / fmax(f->parts[n].lipschitz, 1e-6);
        if (d < least) least = d, *part = n;
    }
    return least;
}

static void fill(const masu_bake_field *f, met *m, const double p[3], const float d[3], double t, bool back,
                 uint32_t part, masu_bake_hit *hit) {
    double n[3], length = 0, look[MASU_SDFC_MATERIAL_SLOTS], h = 1e-5 * (1 + t), towards = 0;
    for (int k = 0; k < 3; k++) {
        double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[k] += h;
        b[k] -= h;
        n[k] = masu_sdfc_field_run(f->field, part, a, m->room) - masu_sdfc_field_run(f->field, part, b, m->room);
        length += n[k] * n[k];
    }
    length = sqrt(length);
    for (int k = 0; k < 3; k++) {
        n[k] = length > 0 ? n[k] / length : -(double)d[k];
        towards += n[k] * (double)d[k];
    }
    masu_sdfc_field_material(f->field, part, look);
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
    double o[3], d[3], t = 0, end = fmin((double)far, f->longest);
    met m;
    m.count = 0;
    m.all = false;
    for (int k = 0; k < 3; k++) o[k] = (double)origin[k], d[k] = (double)direction[k];
    if (!clip(f, o, d, &t, &end)) return false;
    for (uint32_t i = 0; i < f->count && !m.all; i++) {
        if (!can_meet(&f->parts[i], o, d, t, end)) continue;
        m.all = m.count == MET_MAX;
        if (!m.all) m.parts[m.count++] = i;
    }
    if (!m.count) return false;
    bool first = t == 0;
    for (int i = 0; i < STEPS_MAX && t < end; i++, first = false) {
        const double p[3] = {o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]};
        uint32_t part = 0;
        double least = distance(f, &m, p, &part);
        if (least < NEAR_ENOUGH * (1 + t) && !(first && least > 0)) {
            if (hit) fill(f, &m, p, direction, t, first, part, hit);
            return true;
        }
        t += fmax(least, NEAR_ENOUGH * (1 + t));
    }
    return false;
}

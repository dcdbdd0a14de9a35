/* facts.c: boxes and spheres around solids; see facts.h. */
#include "sdfc/facts.h"

#include <string.h>

/* ---- boxes and spheres ---- */

bool sdfc_bounded(const sdfc_box *b) {
    for (int i = 0; i < 3; i++) {
        if (!isfinite(b->low[i]) || !isfinite(b->high[i])) return false;
    }
    return true;
}

double sdfc_corner(const sdfc_box *b, int i) { return fmax(fabs(b->low[i]), fabs(b->high[i])); }

double sdfc_norm3(const double v[3]) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

sdfc_box sdfc_symmetric_box(double x, double y, double z) {
    return (sdfc_box){{-x, -y, -z}, {x, y, z}};
}

void sdfc_tighten(sdfc_facts *f) {
    double half[3], center[3];
    if (!sdfc_bounded(&f->box)) return;
    for (int i = 0; i < 3; i++) {
        half[i] = (f->box.high[i] - f->box.low[i]) / 2;
        center[i] = f->box.low[i] + half[i];
    }
    double radius = sdfc_norm3(half);
    if (radius < f->radius) {
        f->radius = radius;
        memcpy(f->center, center, sizeof center);
    }
}

void sdfc_sphere_of_box(sdfc_facts *f) {
    f->radius = SDFC_INFINITY;
    memset(f->center, 0, sizeof f->center);
    sdfc_tighten(f);
}

void sdfc_box_of_sphere(sdfc_facts *f) {
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = f->center[i] - f->radius;
        f->box.high[i] = f->center[i] + f->radius;
    }
}

void sdfc_widen(sdfc_facts *f, double by) {
    for (int i = 0; i < 3; i++) {
        f->box.low[i] -= by;
        f->box.high[i] += by;
    }
    f->radius += by;
}

void sdfc_join(sdfc_facts *f, const sdfc_facts *g) {
    for (int i = 0; i < 3; i++) {
        f->box.low[i] = fmin(f->box.low[i], g->box.low[i]);
        f->box.high[i] = fmax(f->box.high[i], g->box.high[i]);
    }
    if (!isfinite(f->radius) || !isfinite(g->radius)) {
        f->radius = SDFC_INFINITY;
        return;
    }
    double d[3] = {g->center[0] - f->center[0], g->center[1] - f->center[1],
                   g->center[2] - f->center[2]};
    double apart = sdfc_norm3(d);
    if (apart + g->radius <= f->radius) return;
    if (apart + f->radius <= g->radius) {
        f->radius = g->radius;
        memcpy(f->center, g->center, sizeof f->center);
        return;
    }
    double radius = (apart + f->radius + g->radius) / 2;
    double t = apart > 0 ? (radius - f->radius) / apart : 0;
    for (int i = 0; i < 3; i++) f->center[i] += d[i] * t;
    f->radius = radius * (1 + 1e-12);
}

double sdfc_reach(const sdfc_facts *f, int i, int j) {
    double r = hypot(sdfc_corner(&f->box, i), sdfc_corner(&f->box, j));
    if (isfinite(f->radius)) r = fmin(r, hypot(f->center[i], f->center[j]) + f->radius);
    return r;
}

/* ---- arguments ---- */

void sdfc_unit_vector(sdfc *c, const sdfc_shape *s, int *v, const char *what) {
    double u[3];
    for (int i = 0; i < 3; i++) {
        if (!sdfc_constant(c, v[i])) {
            sdfc_fail(c, s->token, "%s: expected %s known at compile time",
                      sdfc_kinds[s->kind].name, what);
        }
        u[i] = c->exprs[v[i]].value;
    }
    double length = sdfc_norm3(u);
    if (!(length > 1e-12)) {
        sdfc_fail(c, s->token, "%s: expected %s that is not zero", sdfc_kinds[s->kind].name, what);
    }
    for (int i = 0; i < 3; i++) v[i] = sdfc_number(c, u[i] / length);
}

/* facts.h: helpers for the rules of the analysis: the intervals of expressions, bounding boxes and
 * spheres of solids. See analyse.c. */
#ifndef MASU_SDFC_FACTS_H
#define MASU_SDFC_FACTS_H

#include "sdfc/internal.h"

#define SDFC_EVERYWHERE                                                                            \
    ((sdfc_box){{-SDFC_INFINITY, -SDFC_INFINITY, -SDFC_INFINITY},                                  \
                {SDFC_INFINITY, SDFC_INFINITY, SDFC_INFINITY}})

static inline double sdfc_high(const sdfc *c, int e) { return c->exprs[e].high; }
static inline double sdfc_low(const sdfc *c, int e) { return c->exprs[e].low; }
static inline double sdfc_most(const sdfc *c, int e) {
    return fmax(fabs(sdfc_low(c, e)), fabs(sdfc_high(c, e)));
}
static inline double sdfc_size_of(const sdfc *c, int e) { return fmax(sdfc_high(c, e), 0); }

static inline int sdfc_apply1(sdfc *c, int op, int x) { return sdfc_apply(c, op, x, x, x); }
static inline int sdfc_apply2(sdfc *c, int op, int x, int y) { return sdfc_apply(c, op, x, y, x); }

bool sdfc_bounded(const sdfc_box *b);
/* The largest absolute coordinate of a box along axis i. */
double sdfc_corner(const sdfc_box *b, int i);
double sdfc_norm3(const double v[3]);
sdfc_box sdfc_symmetric_box(double x, double y, double z);
/* Replaces the sphere by the one around its box, if that is smaller. Both keep their growth. */
void sdfc_tighten(sdfc_facts *f);
void sdfc_sphere_of_box(sdfc_facts *f);
void sdfc_box_of_sphere(sdfc_facts *f);
void sdfc_widen(sdfc_facts *f, double by);
/* Around both. */
void sdfc_join(sdfc_facts *f, const sdfc_facts *g);
/* Largest distance of the bounds from an axis: that of the sphere or of its box, whichever is
 * smaller. */
double sdfc_reach(const sdfc_facts *f, int i, int j);
/* Normalises a vector of compile-time constants; other vectors are an error. */
void sdfc_unit_vector(sdfc *c, const sdfc_shape *s, int *v, const char *what);

/* A solid of constant 1 in a box around the origin, with these mirrors. */
sdfc_facts sdfc_solid(double x, double y, double z, unsigned symmetric);

/* ---- the rules ---- */

/* Both also replace the shape's arguments by derived ones. */
sdfc_facts sdfc_primitive_facts(sdfc *c, sdfc_shape *s);
sdfc_facts sdfc_joined_facts(sdfc *c, sdfc_shape *s);
sdfc_facts sdfc_more_facts(sdfc *c, sdfc_shape *s);
sdfc_facts sdfc_operator_facts(sdfc *c, sdfc_shape *s);

#endif

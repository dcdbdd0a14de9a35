/* lower.h: writers of a part's operations; see lower.c.
 *
 *   lower.c             points and offsets, translations, operators with one child
 *   lower_repeat.c      repetitions and rotational symmetry
 *   lower_join.c        unions, cuts, blends
 *   lower_primitive.c   shapes without children
 *   lower_local.c       materials that vary over the surface, and the cells around shapes */
#ifndef MASU_SDFC_LOWER_H
#define MASU_SDFC_LOWER_H

#include "sdfc/internal.h"

enum { SDFC_CELLS_DEEP = 4 };

typedef struct sdfc_point {
    int x, y, z;
    int offset[3]; /* expressions + 1, to be added; 0: nothing */
} sdfc_point;

/* The material values of a shape at the point of evaluation: operands. */
typedef struct sdfc_look {
    bool painted;
    int value[MASU_SDFC_MATERIAL_SLOTS];
} sdfc_look;

typedef struct sdfc_lowering {
    sdfc *c;
    sdfc_program *program;
    int function; /* being written */
    bool root;    /* only translations, rotations and scalings so far */
    double stretch; /* local metres per metre in world space, at most; 0: unknown */
    /* axes with a jump between cells: only functions that are equal on both sides are continuous */
    unsigned folded;
    bool at_fold;    /* nothing has been done to the point since */
    /* in a repetition that evaluates several cells: skipping a cut's operand makes a cell closer */
    bool in_cells;
    /* that it stands in; operands: of sectors their number */
    int cell[SDFC_CELLS_DEEP], seed[SDFC_CELLS_DEEP], cells;
    bool sector[SDFC_CELLS_DEEP];
    /* of the function that makes materials */
    bool surface;
    bool shallow; /* it needs only the part's own space, not the shape */
    int material; /* of unpainted surfaces */
    sdfc_look look, plain;
    sdfc_point own, world, here; /* of the part; of the scene; of the painted shape */
    double scale;                /* local metres per metre in world space */
    int fractal;                 /* the shape whose levels are evaluated, or -1 */
    sdfc_point fractal_at;
} sdfc_lowering;

int sdfc_argument(sdfc_lowering *l, int expr);
int sdfc_literal(sdfc_lowering *l, double value);
sdfc_instr *sdfc_add_instr(sdfc_lowering *l, int op);
int sdfc_last_variable(const sdfc_lowering *l);
int sdfc_op_n(sdfc_lowering *l, int op, int count, const int *operands);
#define OP(l, op, ...)                                                                             \
    sdfc_op_n(l, SDFC_##op, (int)(sizeof((int[]){__VA_ARGS__}) / sizeof(int)), (int[]){__VA_ARGS__})
int sdfc_open_function(sdfc_lowering *l); /* returns the one that was open */

bool sdfc_has_offset(const sdfc_point *p);
int sdfc_against(sdfc_lowering *l, const sdfc_point *p, int axis);
sdfc_point sdfc_settled(sdfc_lowering *l, sdfc_point p);
int sdfc_relative(sdfc_lowering *l, const sdfc_point *p, int axis, double value);

/* The distance at p; writes the material values to l->look, if they are requested. */
int sdfc_lower_shape(sdfc_lowering *l, int shape, sdfc_point p);
int sdfc_lower_whole(sdfc_lowering *l, int shape, sdfc_point p);
int sdfc_lower_primitive(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p);
int sdfc_lower_ground(sdfc_lowering *l, const int c[3], int radius, sdfc_point p);
bool sdfc_is_large(const sdfc *c, const sdfc_shape *s);
int sdfc_lower_repeat(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p);
int sdfc_lower_polar(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p);
int sdfc_lower_joined(sdfc_lowering *l, const sdfc_shape *s, sdfc_point p);
int sdfc_child_function(sdfc_lowering *l, int shape, bool join_box, const sdfc_shape *owner,
                        const int offset[3]);
int sdfc_capped(sdfc_lowering *l, int d, int least, const sdfc_facts *f, sdfc_point p);
int sdfc_outside_box(sdfc_lowering *l, const sdfc_box *b, sdfc_point p);
bool sdfc_has_terms(const sdfc_lowering *l, const sdfc_shape *s);
void sdfc_add_term(sdfc_lowering *l, const sdfc_shape *s, int child, int first, int smooth);

/* ---- lower_local.c ---- */

int sdfc_lower_expr(sdfc_lowering *l, int expr); /* of a local one: an operand */
/* The values of a material at p, after the shape has been lowered. */
sdfc_look sdfc_lower_material(sdfc_lowering *l, int material, sdfc_point p);
/* a and b, mixed; `share` is the weight of b */
sdfc_look sdfc_mixed_look(sdfc_lowering *l, sdfc_look a, sdfc_look b, int share, bool whole);
/* The function that makes the materials of a part, if its material is not the same everywhere. */
void sdfc_lower_surface(sdfc *c, sdfc_part *part);

#endif

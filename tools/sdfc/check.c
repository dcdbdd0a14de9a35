/* check.c: tests the results of the analysis in double precision, on points from a fixed seed: the
 * same text always has the same result.
 *
 *   constant   |f(p) - f(q)| <= L |p - q| for distant pairs, close pairs, and pairs on both sides
 *              of the border of two cells of a repetition, found by bisection
 *   estimates  (fractals) there is no solid within f / L of a point
 *   bounds     outside the box and the sphere, f is positive and at least growth * distance
 *   mirrors    a shape in mirrored sectors (polar) equals its mirror image: a wrongly mirrored
 *              field is a valid field, but of another shape
 *
 * Parameters are first at their defaults, then anywhere in their ranges; the same for time. A
 * violation is an error of the analysis (or of a measured constant), and fails the compilation. */
#include "sdfc/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ENVIRONMENTS 16
#define OPERATIONS_MAX 6e7 /* in all; about a second */
#define FAR_AWAY 40.0      /* size used for unbounded shapes */

/* ---- running ---- */

/* Which cell the point fell into, for the operations that choose one. */
static void note_cell(uint64_t *cells, int op, double x, double inverse, double result) {
    double cell;
    switch (op) {
    case SDFC_fold:
    case SDFC_fold_row:
    case SDFC_beside_row:
    case SDFC_window_row: cell = floor((x - result) * inverse * 2 + 0.5); break;
    case SDFC_beside: cell = x < 0; break;
    case SDFC_polar_angle: cell = floor(result * 1e6 + 0.5); break;
    default: return;
    }
    *cells = (*cells ^ (uint64_t)(int64_t)fmax(fmin(cell, 1e15), -1e15)) * 0x100000001B3u;
}

static double value_of(const sdfc *c, const sdfc_program *p, const double *v, int operand) {
    return operand >= 0 ? v[operand] : c->values[p->args[~operand]];
}

static double run_function(const sdfc *c, const sdfc_program *p, int function,
                           const double point[3], const double *inputs, const sdfc_place_of *at,
                           double *variables, uint64_t *cells);

/* The least of the values at the points, or the number of the point that has it. */
static double run_call(const sdfc *c, const sdfc_program *p, const sdfc_instr *i, const double *v,
                       double *variables, uint64_t *cells) {
    double least = 1e30, number = 0, a[SDFC_OPERANDS_MAX];
    int count = i->named || i->around ? SDFC_OPERANDS_MAX : 12;
    for (int j = 0; j < count; j++) a[j] = value_of(c, p, v, i->operand[j]);
    for (int n = 0; n < i->points; n++) {
        double q[3], inputs[SDFC_OPERANDS_MAX];
        for (int j = 0; j < 3; j++) {
            int cell = i->select[j] ? n >> (i->select[j] - 1) & ((1 << i->bits[j]) - 1) : 0;
            q[j] = a[4 * j + cell];
        }
        for (int j = 0; j < i->around; j++) inputs[j] = a[24 + j];
        if (i->named == 2) {
            inputs[i->around] = a[18 + (n & 1)];
        } else if (i->named) {
            const double seed[9] = {a[18], a[19], a[20], q[0], q[1], q[2], a[21], a[22], a[23]};
            static const int32_t operand[9] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
            inputs[i->around] = sdfc_run_op(SDFC_cell_seed, operand, seed);
        }
        double d = run_function(c, p, i->aux, q, inputs, NULL, variables, cells);
        if (d < least) number = n;
        least = d < least ? d : least;
    }
    return i->op == SDFC_CALL_NEAREST ? number : least;
}

static double run_function(const sdfc *c, const sdfc_program *p, int function,
                           const double point[3], const double *inputs, const sdfc_place_of *at,
                           double *variables, uint64_t *cells) {
    const sdfc_function *f = &p->functions[function];
    double *v = variables + f->first_variable;
    for (int k = 0; k < 3; k++) v[k] = point[k];
    for (int k = 0; k < f->count; k++) {
        const sdfc_instr *i = &f->instrs[k];
        double r = 1e30;
        if (!cells) {
            k += sdfc_run_ops(i, f->count - k, v, p->args, c->values, v + 3 + k);
            if (k == f->count) break;
            i = &f->instrs[k];
        }
        switch (i->op) {
        case SDFC_CALL_MIN:
        case SDFC_CALL_NEAREST: r = run_call(c, p, i, v, variables, cells); break;
        case SDFC_CALL_USER: break;
        case SDFC_INPUT: r = inputs[k]; break;
        case SDFC_NORMAL: r = at ? at->normal[i->aux] : 0; break;
        case SDFC_FOOTPRINT: r = at ? at->footprint : 0; break;
        default:
            sdfc_run_ops(i, 1, v, p->args, c->values, &r);
            if (cells)
                note_cell(cells, i->op, value_of(c, p, v, i->operand[0]),
                          value_of(c, p, v, i->operand[2]), r);
        }
        v[3 + k] = r;
    }
    return value_of(c, p, v, f->result);
}

double sdfc_run(const sdfc *c, const sdfc_program *p, const double p3[3], uint64_t *cells) {
    return run_function(c, p, 0, p3, NULL, NULL, c->variables, cells);
}

double sdfc_run_in(const sdfc *c, const sdfc_program *p, const double p3[3], double *room) {
    return run_function(c, p, 0, p3, NULL, NULL, room, NULL);
}

void sdfc_run_look(const sdfc *c, const sdfc_part *part, const double p3[3],
                   const sdfc_place_of *at, double *room, double out[8]) {
    const sdfc_program *p = &part->program;
    if (p->surface) run_function(c, p, p->surface, p3, NULL, at, room, NULL);
    for (int k = 0; k < 8; k++) {
        int operand = p->look[k];
        if (!p->surface)
            out[k] = c->values[c->materials[part->material].value[k]];
        else
            out[k] = value_of(c, p, room + p->functions[p->surface].first_variable, operand);
    }
}

/* ---- random points ---- */

typedef struct checker {
    sdfc *c;
    const sdfc_part *part;
    const sdfc_facts *facts;
    uint64_t random;
    double center[3], half[3], size;
    double params[MASU_SDFC_PARAMS_MAX], time;
    double tiny;
    int tried, broken; /* estimates */
} checker;

static double unit(checker *k) {
    uint64_t z = k->random += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return (double)((z ^ z >> 31) >> 11) / 9007199254740992.0;
}

static void direction(checker *k, double out[3]) {
    double n;
    do {
        for (int i = 0; i < 3; i++) out[i] = 2 * unit(k) - 1;
        n = out[0] * out[0] + out[1] * out[1] + out[2] * out[2];
    } while (n > 1 || n < 1e-6);
    for (int i = 0; i < 3; i++) out[i] /= sqrt(n);
}

static void any_point(checker *k, double out[3]) {
    static const double scales[] = {0.3, 1, 1.2, 4};
    double scale = scales[(int)(unit(k) * 4)];
    for (int i = 0; i < 3; i++) {
        out[i] = k->center[i] + (2 * unit(k) - 1) * scale * (k->half[i] + 0.1 * k->size);
    }
}

static double field(checker *k, const double p[3], uint64_t *cells) {
    return sdfc_run(k->c, &k->part->program, p, cells);
}

static double distance(const double p[3], const double q[3]) {
    double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* ---- the two claims ---- */

static void check_pair(checker *k, const double p[3], const double q[3], double fp, double fq) {
    double allowed = k->facts->lipschitz * distance(p, q) * (1 + 1e-9);
    allowed += k->tiny * (1 + fabs(fp) + fabs(fq)) * fmax(k->facts->lipschitz, 1);
    if (fabs(fp - fq) <= allowed) return;
    sdfc_fail(k->c, k->part->token,
              "part %s: the field is steeper than its Lipschitz constant %.9g: f(%.17g, %.17g, "
              "%.17g) = %.17g, f(%.17g, %.17g, %.17g) = %.17g at time %.17g",
              k->part->name, k->facts->lipschitz, p[0], p[1], p[2], fp, q[0], q[1], q[2], fq,
              k->time);
}

static void check_border(checker *k, double p[3], double q[3], uint64_t from) {
    for (int step = 0; step < 60 && distance(p, q) > 1e-9 * k->size; step++) {
        double m[3];
        uint64_t cells = 0;
        for (int i = 0; i < 3; i++) m[i] = (p[i] + q[i]) / 2;
        field(k, m, &cells);
        memcpy(cells == from ? p : q, m, sizeof m);
    }
    check_pair(k, p, q, field(k, p, NULL), field(k, q, NULL));
}

static void check_constant(checker *k, bool borders) {
    double p[3], q[3], way[3];
    uint64_t cells_p = 0, cells_q = 0;
    any_point(k, p);
    if (unit(k) < 0.3) {
        any_point(k, q);
    } else {
        double length = k->size * pow(10, -6 * unit(k));
        direction(k, way);
        for (int i = 0; i < 3; i++) q[i] = p[i] + way[i] * length;
    }
    double fp = field(k, p, borders ? &cells_p : NULL);
    double fq = field(k, q, borders ? &cells_q : NULL);
    check_pair(k, p, q, fp, fq);
    if (borders && cells_p != cells_q) check_border(k, p, q, cells_p);
}

/* Fractals have no Lipschitz constant. The march requires that no solid is closer than f / L; an
 * estimate may violate this for one point in 200. */
static void check_estimate(checker *k) {
    double p[3], way[3], q[3];
    any_point(k, p);
    double fp = field(k, p, NULL);
    if (!(fp > 0)) return;
    double length = fp / k->facts->lipschitz * cbrt(unit(k));
    direction(k, way);
    for (int i = 0; i < 3; i++) q[i] = p[i] + way[i] * length;
    k->tried++;
    if (field(k, q, NULL) > 0 || (++k->broken) * 200 <= k->tried + 1000) return;
    sdfc_fail(k->c, k->part->token,
              "part %s: the distance estimate exceeds the distance in %d of %d cases, last "
              "(%.17g, %.17g, %.17g) from (%.17g, %.17g, %.17g) at time %.17g",
              k->part->name, k->broken, k->tried, q[0], q[1], q[2], p[0], p[1], p[2], k->time);
}

static void check_bounds(checker *k) {
    const sdfc_facts *f = k->facts;
    double p[3], out = 0, tiny = k->tiny;
    any_point(k, p);
    for (int i = 0; i < 3; i++) {
        double d = fmax(f->box.low[i] - p[i], p[i] - f->box.high[i]);
        if (d > 0) out += d * d;
    }
    out = sqrt(out);
    if (isfinite(f->radius)) out = fmax(out, distance(p, f->center) - f->radius);
    if (k->part->moves) {
        double center[3];
        for (int i = 0; i < 3; i++) center[i] = k->c->values[k->part->moving_center[i]];
        out = fmax(out, distance(p, center) - k->part->moving_radius);
    }
    if (!(out > tiny)) return;
    double fp = field(k, p, NULL);
    if (fp >= f->growth * out * (1 - 1e-9) - tiny * fmax(f->lipschitz, 1)) return;
    sdfc_fail(k->c, k->part->token,
              "part %s: the field is %.17g at (%.17g, %.17g, %.17g), %.9g outside of its bounds, "
              "at time %.17g",
              k->part->name, fp, p[0], p[1], p[2], out, k->time);
}

/* ---- all parts ---- */

static void set_shape(checker *k, const sdfc_part *part, int shape) {
    k->part = part;
    k->facts = &k->c->shapes[shape].facts;
    k->size = 0;
    k->tried = k->broken = 0;
    double furthest = 0;
    for (int i = 0; i < 3; i++) {
        double from = k->facts->box.low[i], to = k->facts->box.high[i];
        bool ends = isfinite(from) && isfinite(to);
        k->center[i] = ends ? (from + to) / 2 : isfinite(from) ? from : isfinite(to) ? to : 0;
        k->half[i] = ends ? (to - from) / 2 : FAR_AWAY;
        k->size = fmax(k->size, k->half[i]);
        furthest = fmax(furthest, fabs(k->center[i]));
    }
    k->size = fmax(k->size, 1e-6);
    k->tiny = 1e-11 * (k->size + furthest);
}

static void set_environment(checker *k, int environment) {
    for (int i = 0; i < k->c->param_count; i++) {
        const masu_sdfc_param *p = &k->c->params[i];
        double t = unit(k);
        k->params[i] = environment == 0   ? p->value
                       : environment == 1 ? p->minimum
                       : environment == 2 ? p->maximum
                                          : p->minimum * (1 - t) + p->maximum * t;
    }
    k->time = environment == 0 ? 0 : 100 * unit(k);
    sdfc_evaluate(k->c, k->params, k->time, k->c->values);
}

/* Tests one shape; its part has been lowered successfully, so lowering this subtree cannot fail. */
static void check_mirror(sdfc *c, const sdfc_part *part, int shape) {
    checker k = {.c = c, .random = 0x6D617375};
    set_shape(&k, part, shape);
    const int instrs = c->instrs, before = c->at;
    const bool anchored = c->anchored;
    sdfc_part alone = {.shape = shape, .token = part->token};
    c->anchored = false;
    c->any_cell = true;
    sdfc_lower(c, &alone);
    c->any_cell = false;
    c->anchored = anchored;
    c->instrs = instrs;
    c->at = before;
    c->variables = sdfc_take(c, (size_t)alone.program.variable_count, sizeof *c->variables);
    c->values = sdfc_take(c, (size_t)c->expr_count, sizeof *c->values);
    double p[3], d = 0, other = 0;
    bool same = true;
    for (int n = 0; n < 256 && same; n++) {
        if (n % 64 == 0) set_environment(&k, n / 64);
        any_point(&k, p);
        const double mirrored[3] = {p[0], p[1], -p[2]};
        d = sdfc_run(c, &alone.program, p, NULL);
        other = sdfc_run(c, &alone.program, mirrored, NULL);
        same = fabs(d - other) <= 1e-9 * (1 + fabs(d));
    }
    free(c->variables);
    free(c->values);
    c->variables = c->values = NULL;
    sdfc_free_program(&alone.program);
    if (same) return;
    sdfc_fail(c, part->token,
              "part %s: polar mirrors a shape that is not symmetric: f(%.17g, %.17g, "
              "%.17g) = %.17g, f(.., -z) = %.17g",
              part->name, p[0], p[1], p[2], d, other);
}

static void check_mirrors(sdfc *c, const sdfc_part *part, int shape, bool *seen) {
    if (seen[shape]) return;
    seen[shape] = true;
    const sdfc_shape *s = &c->shapes[shape];
    if (s->facts.user) return;
    if (s->kind == SDFC_KIND_POLAR && s->extra[0] == 1) check_mirror(c, part, s->child[0]);
    for (int i = 0; i < s->children; i++) check_mirrors(c, part, c->shapes[shape].child[i], seen);
}

/* Room for the variables of each part's program, and for the expressions. */
static void take_room(sdfc *c) {
    int variables = 0;
    for (int i = 0; i < c->part_count; i++) {
        int own = c->parts[i].program.variable_count;
        if (own > variables) variables = own;
    }
    if (!c->variables) c->variables = sdfc_take(c, (size_t)variables, sizeof *c->variables);
    if (!c->values) c->values = sdfc_take(c, (size_t)c->expr_count, sizeof *c->values);
}

void sdfc_check_cameras(sdfc *c, const masu_sdfc_camera *cameras, uint32_t count) {
    checker k = {.c = c, .random = 0x6D617375};
    take_room(c);
    set_environment(&k, 0);
    for (int i = 0; i < c->part_count; i++) {
        const sdfc_part *part = &c->parts[i];
        if (c->shapes[part->shape].facts.user) continue; /* its text is GLSL */
        for (uint32_t n = 0; n < count; n++) {
            const double *p = cameras[n].position;
            sdfc_evaluate(c, k.params, cameras[n].time, c->values);
            uint64_t cells = 0;
            if (!(sdfc_run(c, &part->program, p, &cells) < 0)) continue;
            sdfc_warn(c, part->token, "the camera at (%g, %g, %g), %g s, is inside part \"%s\"",
                      p[0], p[1], p[2], cameras[n].time, part->name);
            break;
        }
    }
}

void sdfc_check(sdfc *c, uint32_t pairs) {
    free(c->scratch);
    c->scratch = NULL;
    bool *seen = c->scratch = sdfc_take(c, (size_t)c->shape_count, sizeof *seen);
    for (int i = 0; i < c->part_count; i++) check_mirrors(c, &c->parts[i], c->parts[i].shape, seen);
    free(seen);
    c->scratch = NULL;
    checker k = {.c = c, .random = 0x6D617375};
    double operations = 0;
    for (int i = 0; i < c->part_count; i++) {
        const sdfc_part *p = &c->parts[i];
        double share = fmax((double)pairs / c->groups[p->group].part_count, ENVIRONMENTS);
        operations += 3 * share * c->shapes[p->shape].facts.cost * 4;
    }
    double thin = operations > OPERATIONS_MAX ? OPERATIONS_MAX / operations : 1;
    take_room(c);
    int environments = c->dynamic_count ? ENVIRONMENTS : 1;
    if (c->cost * 8 * ENVIRONMENTS > OPERATIONS_MAX) environments = 1;
    for (int e = 0; e < environments; e++) {
        set_environment(&k, e);
        for (int i = 0; i < c->part_count; i++) {
            set_shape(&k, &c->parts[i], c->parts[i].shape);
            if (k.facts->user) continue;
            double share = (double)pairs * thin / c->groups[k.part->group].part_count;
            int rounds = (int)ceil(share / environments);
            for (int n = 0; n < rounds; n++) {
                if (k.facts->estimate)
                    check_estimate(&k);
                else
                    check_constant(&k, n % 4 == 0);
                check_bounds(&k);
            }
        }
    }
}

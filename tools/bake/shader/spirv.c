/* spirv.c: see spirv.h.
 *
 * Every value is a row of cells: components of a vector, columns of a matrix, members of an array
 * or struct. Rows and variables have fixed positions in one array of cells, because SPIR-V shaders
 * have no recursion; a pointer is an index. Instruction numbers are those in the specification. */
#include "bake/shader/spirv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CELLS_MAX ((size_t)1 << 22)
#define BUDGET 400000
#define CALLS_MAX 64

typedef masu_bake_cell cell;

typedef struct type {
    uint32_t op, element, count, cells; /* element: for vectors, matrices, arrays, pointers */
    const uint32_t *members;            /* for structs: their types */
} type;

struct masu_bake_machine {
    const uint32_t *words;
    size_t word_count, cell_count;
    uint32_t bound, main;
    type *types;     /* by id */
    uint32_t *of;    /* by id: its type */
    uint32_t *at;    /* by id: its first cell */
    uint32_t *where; /* by id: offset of a label or function in the module */
    uint32_t *binding;
    cell *cells;
    double *decisions; /* by id; NAN: no decision in this run */
    uint32_t *decided; /* the ids with a decision */
    size_t decided_count;
    char *error;
    size_t error_size;
    uint64_t steps; /* instructions in all runs */
};

enum {
    T_BOOL = 20,
    T_INT = 21,
    T_FLOAT = 22,
    T_VECTOR = 23,
    T_MATRIX = 24,
    T_ARRAY = 28,
    T_STRUCT = 30,
    T_POINTER = 32
};

static bool refuse(masu_bake_machine *m, const char *what, uint32_t number) {
    snprintf(m->error, m->error_size, "%s %u", what, number);
    return false;
}

/* ---- Loading --------------------------------------------------------------------------------- */

static bool place(masu_bake_machine *m, uint32_t id, uint32_t type_id, size_t cells) {
    if (m->cell_count + cells > CELLS_MAX) return refuse(m, "too many values: id", id);
    m->of[id] = type_id;
    m->at[id] = (uint32_t)m->cell_count;
    m->cell_count += cells;
    return true;
}

static bool take_type(masu_bake_machine *m, uint32_t op, const uint32_t *w, uint32_t count) {
    type *t = &m->types[w[1]];
    *t = (type){.op = op, .cells = 1};
    switch (op) {
    case 19: /* void */
    case 33: /* function */ t->cells = 0; return true;
    case T_BOOL:
    case T_INT: return true;
    case T_FLOAT: return w[2] == 32 || refuse(m, "a float of bits", w[2]);
    case T_VECTOR:
    case T_MATRIX:
        t->element = w[2];
        t->count = w[3];
        t->cells = w[3] * m->types[w[2]].cells;
        return true;
    case T_ARRAY:
        t->element = w[2];
        t->count = m->cells[m->at[w[3]]].u;
        if ((uint64_t)t->count * m->types[w[2]].cells > CELLS_MAX)
            return refuse(m, "too long an array: type", w[1]);
        t->cells = t->count * m->types[w[2]].cells;
        return true;
    case T_STRUCT:
        t->members = w + 2;
        t->count = count - 2;
        t->cells = 0;
        for (uint32_t i = 0; i < t->count; i++) t->cells += m->types[w[2 + i]].cells;
        return t->cells <= CELLS_MAX || refuse(m, "too large a struct: type", w[1]);
    case T_POINTER: t->element = w[3]; return true;
    default: return refuse(m, "a type of kind", op);
    }
}

static void constant(masu_bake_machine *m, uint32_t op, const uint32_t *w, uint32_t count) {
    const type *t = &m->types[w[1]];
    cell *to = m->cells + m->at[w[2]];
    if (op == 41 || op == 42) { /* true, false */
        to->u = op == 41;
    } else if (op == 43 && t->op == T_FLOAT) {
        float f;
        memcpy(&f, &w[3], sizeof f);
        to->f = (double)f;
    } else if (op == 43) {
        to->u = w[3];
    } else if (op == 44) { /* composite */
        for (uint32_t i = 3; i < count; i++) {
            uint32_t n = m->types[m->of[w[i]]].cells;
            memcpy(to, m->cells + m->at[w[i]], n * sizeof *to);
            to += n;
        }
    }
}

/* Loads types, constants and variables in the order of the module, in which each is declared before
 * its use; results of instructions get their cells. */
static bool load(masu_bake_machine *m) {
    bool inside = false; /* within a function */
    for (size_t i = 5; i < m->word_count;) {
        const uint32_t *w = m->words + i;
        uint32_t op = w[0] & 0xFFFF, count = w[0] >> 16;
        if (!count || i + count > m->word_count)
            return refuse(m, "a broken instruction at word", (uint32_t)i);
        if (op >= 19 && op <= 33) {
            if (!take_type(m, op, w, count)) return false;
        } else if (op == 59) { /* variable: its pointer, then its value */
            if (!place(m, w[2], w[1], 1)) return false;
            m->cells[m->at[w[2]]].u = (uint32_t)m->cell_count;
            m->cell_count += m->types[m->types[w[1]].element].cells;
            if (m->cell_count > CELLS_MAX) return refuse(m, "too large a variable", w[2]);
            if (count > 4)
                memcpy(m->cells + m->cells[m->at[w[2]]].u, m->cells + m->at[w[4]],
                       m->types[m->of[w[4]]].cells * sizeof(cell));
        } else if (op == 71 && w[2] == 33) { /* decorate, binding */
            m->binding[w[1]] = w[3] + 1;
        } else if (op == 15) { /* entry point */
            m->main = w[2];
        } else if (op == 54) {
            m->where[w[2]] = (uint32_t)i;
            if (!place(m, w[2], w[1], m->types[w[1]].cells)) return false;
            inside = true;
        } else if (op == 248) {
            m->where[w[1]] = (uint32_t)i;
        } else if ((op >= 41 && op <= 46) || op == 1 || op == 55 ||
                   (inside && count >= 3 && op != 62 && op != 63 && op != 246 && op != 247 &&
                    op < 249 && op != 12 && op != 56)) {
            if (w[1] >= m->bound || w[2] >= m->bound) return refuse(m, "instruction", op);
            if (!place(m, w[2], w[1], m->types[w[1]].cells)) return false;
            constant(m, op, w, count);
        } else if (op == 12) { /* extended instruction */
            if (!place(m, w[2], w[1], m->types[w[1]].cells)) return false;
        } else if (op >= 48 && op <= 52) {
            return refuse(m, "a specialisation constant: instruction", op);
        }
        i += count;
    }
    return m->where[m->main] || refuse(m, "no main function: id", m->main);
}

masu_bake_machine *masu_bake_machine_make(const uint32_t *words, size_t count, char *error,
                                          size_t error_size) {
    if (count < 5 || words[0] != 0x07230203u || words[3] < 1 || words[3] > 1u << 20) {
        snprintf(error, error_size, "no SPIR-V");
        return NULL;
    }
    masu_bake_machine *m = calloc(1, sizeof *m);
    size_t n = words[3];
    if (m) {
        *m = (masu_bake_machine){.words = words, .word_count = count, .bound = words[3]};
        m->error = error;
        m->error_size = error_size;
        m->types = calloc(n, sizeof *m->types);
        m->of = calloc(n, sizeof *m->of);
        m->at = calloc(n, sizeof *m->at);
        m->where = calloc(n, sizeof *m->where);
        m->binding = calloc(n, sizeof *m->binding);
        m->cells = calloc(CELLS_MAX, sizeof *m->cells);
        m->decisions = malloc(n * sizeof *m->decisions);
        m->decided = malloc(n * sizeof *m->decided);
        for (size_t i = 0; i < n && m->decisions; i++) m->decisions[i] = (double)NAN;
        m->cell_count = 1;
    }
    if (!m || !m->types || !m->of || !m->at || !m->where || !m->binding || !m->cells ||
        !m->decisions || !m->decided) {
        snprintf(error, error_size, "no memory");
    } else if (load(m)) {
        return m;
    }
    masu_bake_machine_free(m);
    return NULL;
}

void masu_bake_machine_free(masu_bake_machine *m) {
    if (!m) return;
    void *const all[] = {m->types, m->of,        m->at,      m->where, m->binding,
                         m->cells, m->decisions, m->decided, m};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}

cell *masu_bake_machine_buffer(masu_bake_machine *m, uint32_t binding, size_t *count) {
    for (uint32_t id = 0; id < m->bound; id++) {
        if (m->binding[id] != binding + 1) continue;
        *count = m->types[m->types[m->of[id]].element].cells;
        return m->cells + m->cells[m->at[id]].u;
    }
    *count = 0;
    return NULL;
}

const uint32_t *masu_bake_machine_decided(const masu_bake_machine *m, size_t *count) {
    *count = m->decided_count;
    return m->decided;
}

const double *masu_bake_machine_decisions(const masu_bake_machine *m, size_t *count) {
    *count = m->bound;
    return m->decisions;
}

/* For a vector, keeps the component closest to the opposite decision. */
static void decide(masu_bake_machine *m, uint32_t id, uint32_t i, double by) {
    if (isnan(m->decisions[id])) {
        m->decisions[id] = (double)INFINITY;
        m->decided[m->decided_count++] = id;
    }
    if (i == 0 || fabs(by) < fabs(m->decisions[id])) m->decisions[id] = by;
}

/* Positive if x is between a and b, negative outside. */
static double between(double x, double a, double b) { return fmin(x - fmin(a, b), fmax(a, b) - x); }

/* ---- GLSL.std.450 ---------------------------------------------------------------------------- */

static double dot(const cell *a, const cell *b, uint32_t n) {
    double sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += a[i].f * b[i].f;
    return sum;
}

static double smooth(double a, double b, double x) {
    double t = fmin(fmax((x - a) / (b - a), 0), 1);
    return t * t * (3 - 2 * t);
}

/* One component. False: unsupported. */
static bool component(uint32_t op, cell a, cell b, cell c, cell *r) {
    int32_t s = (int32_t)a.u, t = (int32_t)b.u;
    switch (op) {
    case 1:
    case 2: r->f = rint(a.f); return true;
    case 3: r->f = trunc(a.f); return true;
    case 4: r->f = fabs(a.f); return true;
    case 5: r->u = s < 0 ? 0u - a.u : a.u; return true;
    case 6: r->f = (a.f > 0) - (a.f < 0); return true;
    case 7: r->u = (uint32_t)((s > 0) - (s < 0)); return true;
    case 8: r->f = floor(a.f); return true;
    case 9: r->f = ceil(a.f); return true;
    case 10: r->f = a.f - floor(a.f); return true;
    case 11: r->f = a.f * (3.14159265358979324 / 180); return true;
    case 12: r->f = a.f * (180 / 3.14159265358979324); return true;
    case 13: r->f = sin(a.f); return true;
    case 14: r->f = cos(a.f); return true;
    case 15: r->f = tan(a.f); return true;
    case 16: r->f = asin(a.f); return true;
    case 17: r->f = acos(a.f); return true;
    case 18: r->f = atan(a.f); return true;
    case 19: r->f = sinh(a.f); return true;
    case 20: r->f = cosh(a.f); return true;
    case 21: r->f = tanh(a.f); return true;
    case 25: r->f = atan2(a.f, b.f); return true;
    case 26: r->f = pow(a.f, b.f); return true;
    case 27: r->f = exp(a.f); return true;
    case 28: r->f = log(a.f); return true;
    case 29: r->f = exp2(a.f); return true;
    case 30: r->f = log2(a.f); return true;
    case 31: r->f = sqrt(a.f); return true;
    case 32: r->f = 1 / sqrt(a.f); return true;
    case 37:
    case 79: r->f = fmin(a.f, b.f); return true;
    case 38: r->u = a.u < b.u ? a.u : b.u; return true;
    case 39: r->u = s < t ? a.u : b.u; return true;
    case 40:
    case 80: r->f = fmax(a.f, b.f); return true;
    case 41: r->u = a.u > b.u ? a.u : b.u; return true;
    case 42: r->u = s > t ? a.u : b.u; return true;
    case 43:
    case 81: r->f = fmin(fmax(a.f, b.f), c.f); return true;
    case 44: r->u = a.u < b.u ? b.u : a.u > c.u ? c.u : a.u; return true;
    case 45: r->u = s < t ? b.u : s > (int32_t)c.u ? c.u : a.u; return true;
    case 46: r->f = a.f * (1 - c.f) + b.f * c.f; return true;
    case 48: r->f = b.f < a.f ? 0 : 1; return true;
    case 49: r->f = smooth(a.f, b.f, c.f); return true;
    case 50: r->f = a.f * b.f + c.f; return true;
    default: return false;
    }
}

static bool extended(masu_bake_machine *m, const uint32_t *w, uint32_t count) {
    static const cell zero = {0};
    cell *r = m->cells + m->at[w[2]];
    const cell *a[3] = {&zero, &zero, &zero};
    uint32_t op = w[4], n = m->types[w[1]].cells, of = m->types[m->of[w[5]]].cells;
    for (uint32_t i = 0; i < 3 && 5 + i < count; i++) a[i] = m->cells + m->at[w[5 + i]];
    double k;
    switch (op) {
    case 66: r->f = sqrt(dot(a[0], a[0], of)); return true; /* length */
    case 67:                                                /* distance */
        k = 0;
        for (uint32_t i = 0; i < of; i++) k += (a[0][i].f - a[1][i].f) * (a[0][i].f - a[1][i].f);
        r->f = sqrt(k);
        return true;
    case 68: /* cross */
        for (int i = 0; i < 3; i++)
            r[i].f = a[0][(i + 1) % 3].f * a[1][(i + 2) % 3].f -
                     a[0][(i + 2) % 3].f * a[1][(i + 1) % 3].f;
        return true;
    case 69: /* normalize */
        k = sqrt(dot(a[0], a[0], of));
        for (uint32_t i = 0; i < n; i++) r[i].f = a[0][i].f / k;
        return true;
    case 71: /* reflect */
        k = 2 * dot(a[0], a[1], of);
        for (uint32_t i = 0; i < n; i++) r[i].f = a[0][i].f - k * a[1][i].f;
        return true;
    default:
        if (5 + 3 < count) return refuse(m, "GLSL.std.450 instruction", op);
        for (uint32_t i = 0; i < n; i++) {
            bool more[3] = {5 < count, 6 < count, 7 < count};
            if (!component(op, a[0][i], more[1] ? a[1][i] : zero, more[2] ? a[2][i] : zero, &r[i]))
                return refuse(m, "GLSL.std.450 instruction", op);
            double x = a[0][i].f, y = a[1][i].f;
            if (op == 37 || op == 79 || op == 40 || op == 80 || op == 48) decide(m, w[2], i, x - y);
            if (op == 27 || op == 29) decide(m, w[2], i, x + 1); /* a spike: 0 nearly everywhere */
            if (op == 43 || op == 81) decide(m, w[2], i, between(x, y, a[2][i].f));
            if (op == 49) decide(m, w[2], i, between(a[2][i].f, x, y));
        }
        return true;
    }
}

/* ---- Instructions ---------------------------------------------------------------------------- */

/* One component of an instruction with one or two operands. False: unsupported. */
static bool arithmetic(uint32_t op, cell a, cell b, cell *r) {
    int32_t s = (int32_t)a.u, t = (int32_t)b.u;
    bool none = isnan(a.f) || isnan(b.f); /* used for floats only */
    switch (op) {
    case 109: r->u = a.f > 0 ? a.f < 4294967296.0 ? (uint32_t)a.f : UINT32_MAX : 0; return true;
    case 110:
        r->u = a.f > -2147483649.0 && a.f < 2147483648.0 ? (uint32_t)(int32_t)a.f : 0x80000000u;
        return true;
    case 111: r->f = s; return true;
    case 112: r->f = a.u; return true;
    case 126: r->u = 0u - a.u; return true;
    case 127: r->f = -a.f; return true;
    case 128: r->u = a.u + b.u; return true;
    case 129: r->f = a.f + b.f; return true;
    case 130: r->u = a.u - b.u; return true;
    case 131: r->f = a.f - b.f; return true;
    case 132: r->u = a.u * b.u; return true;
    case 133: r->f = a.f * b.f; return true;
    case 134: r->u = b.u ? a.u / b.u : 0; return true;
    case 135: r->u = t && !(t == -1 && s == INT32_MIN) ? (uint32_t)(s / t) : 0; return true;
    case 136: r->f = a.f / b.f; return true;
    case 137: r->u = b.u ? a.u % b.u : 0; return true;
    case 138:
    case 139:
        if (!t || t == -1) {
            r->u = 0;
        } else {
            int32_t d = s % t;
            r->u = (uint32_t)(op == 139 && d && (d < 0) != (t < 0) ? d + t : d);
        }
        return true;
    case 140: r->f = fmod(a.f, b.f); return true;
    case 141: r->f = a.f - b.f * floor(a.f / b.f); return true;
    case 156: r->u = isnan(a.f); return true;
    case 157: r->u = isinf(a.f); return true;
    case 164:
    case 170: r->u = a.u == b.u; return true;
    case 165:
    case 171: r->u = a.u != b.u; return true;
    case 166: r->u = a.u | b.u; return true;
    case 167: r->u = a.u & b.u; return true;
    case 168: r->u = !a.u; return true;
    case 172: r->u = a.u > b.u; return true;
    case 173: r->u = s > t; return true;
    case 174: r->u = a.u >= b.u; return true;
    case 175: r->u = s >= t; return true;
    case 176: r->u = a.u < b.u; return true;
    case 177: r->u = s < t; return true;
    case 178: r->u = a.u <= b.u; return true;
    case 179: r->u = s <= t; return true;
    case 180: r->u = a.f == b.f; return true;
    case 181: r->u = none || a.f == b.f; return true;
    case 182: r->u = !none && a.f != b.f; return true;
    case 183: r->u = a.f != b.f; return true;
    case 184: r->u = a.f < b.f; return true;
    case 185: r->u = !(a.f >= b.f); return true;
    case 186: r->u = a.f > b.f; return true;
    case 187: r->u = !(a.f <= b.f); return true;
    case 188: r->u = a.f <= b.f; return true;
    case 189: r->u = !(a.f > b.f); return true;
    case 190: r->u = a.f >= b.f; return true;
    case 191: r->u = !(a.f < b.f); return true;
    case 194: r->u = a.u >> (b.u & 31); return true;
    case 195: r->u = s < 0 ? ~(~a.u >> (b.u & 31)) : a.u >> (b.u & 31); return true;
    case 196: r->u = a.u << (b.u & 31); return true;
    case 197: r->u = a.u | b.u; return true;
    case 198: r->u = a.u ^ b.u; return true;
    case 199: r->u = a.u & b.u; return true;
    case 200: r->u = ~a.u; return true;
    default: return false;
    }
}

static uint32_t component_type(const masu_bake_machine *m, uint32_t type_id) {
    const type *t = &m->types[type_id];
    return t->op == T_VECTOR ? m->types[t->element].op : t->op;
}

/* The bits have single precision, as on the GPU. */
static void bitcast(const masu_bake_machine *m, uint32_t to, uint32_t from, const cell *a,
                    cell *r) {
    bool was = component_type(m, from) == T_FLOAT, is = component_type(m, to) == T_FLOAT;
    for (uint32_t i = 0; i < m->types[to].cells; i++) {
        float f = 0;
        uint32_t u = a[i].u;
        if (was && !is) {
            f = (float)a[i].f;
            memcpy(&u, &f, sizeof u);
        }
        if (was == is)
            r[i] = a[i];
        else if (!is)
            r[i].u = u;
        else {
            memcpy(&f, &u, sizeof f);
            r[i].f = (double)f;
        }
    }
}

/* Steps from a composite to a component; false: out of range. */
static bool step_into(const masu_bake_machine *m, uint32_t *type_id, uint32_t index,
                      uint32_t *offset) {
    const type *t = &m->types[*type_id];
    if (index >= t->count) return false;
    if (t->op == T_STRUCT) {
        for (uint32_t i = 0; i < index; i++) *offset += m->types[t->members[i]].cells;
        *type_id = t->members[index];
    } else {
        *offset += index * m->types[t->element].cells;
        *type_id = t->element;
    }
    return true;
}

static bool access_chain(masu_bake_machine *m, const uint32_t *w, uint32_t count) {
    uint32_t type_id = m->types[m->of[w[3]]].element, offset = m->cells[m->at[w[3]]].u;
    for (uint32_t i = 4; i < count; i++) {
        uint32_t index = m->cells[m->at[w[i]]].u;
        if (!step_into(m, &type_id, index, &offset))
            return refuse(m, "it reads outside of an array, index", index);
    }
    m->cells[m->at[w[2]]].u = offset;
    return true;
}

static void multiply(const masu_bake_machine *m, uint32_t op, const uint32_t *w, cell *r,
                     const cell *a, const cell *b) {
    const type *t = &m->types[m->of[w[3]]], *u = &m->types[m->of[w[4]]];
    uint32_t n = m->types[w[1]].cells;
    if (op == 142 || op == 143) {
        for (uint32_t i = 0; i < n; i++) r[i].f = a[i].f * b->f;
    } else if (op == 144) { /* vector * matrix: a dot product with each column */
        for (uint32_t i = 0; i < n; i++) r[i].f = dot(a, b + i * t->count, t->count);
    } else { /* matrix * vector or matrix: column by column */
        uint32_t columns = op == 145 ? 1 : u->count, rows = m->types[t->element].count;
        for (uint32_t c = 0; c < columns; c++) {
            for (uint32_t i = 0; i < rows; i++) {
                double sum = 0;
                for (uint32_t k = 0; k < t->count; k++)
                    sum += a[k * rows + i].f * b[c * t->count + k].f;
                r[c * rows + i].f = sum;
            }
        }
    }
}

static bool composite(masu_bake_machine *m, uint32_t op, const uint32_t *w, uint32_t count) {
    cell *r = m->cells + m->at[w[2]];
    const cell *a = m->cells + m->at[w[3]];
    const type *t = &m->types[w[1]];
    uint32_t type_id = m->of[w[3]], offset = 0, n;
    switch (op) {
    case 77: /* extract, dynamic */
        offset = m->cells[m->at[w[4]]].u;
        if (offset >= m->types[type_id].count) return refuse(m, "outside of a vector:", offset);
        *r = a[offset];
        return true;
    case 78: /* insert, dynamic */
        offset = m->cells[m->at[w[5]]].u;
        if (offset >= t->count) return refuse(m, "outside of a vector:", offset);
        memmove(r, a, t->cells * sizeof *r);
        r[offset] = m->cells[m->at[w[4]]];
        return true;
    case 79: /* shuffle */
        n = m->types[type_id].count;
        for (uint32_t i = 5; i < count; i++) {
            const cell *b = m->cells + m->at[w[4]];
            r[i - 5] = w[i] == UINT32_MAX ? (cell){0} : w[i] < n ? a[w[i]] : b[w[i] - n];
        }
        return true;
    case 80: /* construct */
        for (uint32_t i = 3; i < count; i++) {
            n = m->types[m->of[w[i]]].cells;
            memmove(r, m->cells + m->at[w[i]], n * sizeof *r);
            r += n;
        }
        return true;
    case 81: /* extract */
        for (uint32_t i = 4; i < count; i++)
            if (!step_into(m, &type_id, w[i], &offset)) return refuse(m, "instruction", op);
        memmove(r, a + offset, t->cells * sizeof *r);
        return true;
    case 82: /* insert */
        type_id = w[1];
        for (uint32_t i = 5; i < count; i++)
            if (!step_into(m, &type_id, w[i], &offset)) return refuse(m, "instruction", op);
        memmove(r, m->cells + m->at[w[4]], t->cells * sizeof *r);
        memmove(r + offset, a, m->types[m->of[w[3]]].cells * sizeof *r);
        return true;
    default: /* transpose */
        n = m->types[t->element].count;
        for (uint32_t c = 0; c < t->count; c++)
            for (uint32_t i = 0; i < n; i++) r[c * n + i] = a[i * t->count + c];
        return true;
    }
}

/* Instructions that produce a value. */
static bool evaluate(masu_bake_machine *m, uint32_t op, const uint32_t *w, uint32_t count) {
    cell *r = m->cells + m->at[w[2]];
    const cell *a = count > 3 ? m->cells + m->at[w[3]] : NULL;
    const cell *b = count > 4 && op != 81 && op != 12 ? m->cells + m->at[w[4]] : NULL;
    uint32_t n = m->types[w[1]].cells;
    switch (op) {
    case 12: return extended(m, w, count);
    case 61: memmove(r, m->cells + a->u, n * sizeof *r); return true;
    case 65:
    case 66: return access_chain(m, w, count);
    case 77:
    case 78:
    case 79:
    case 80:
    case 81:
    case 82:
    case 84: return composite(m, op, w, count);
    case 83: memmove(r, a, n * sizeof *r); return true;
    case 124: bitcast(m, w[1], m->of[w[3]], a, r); return true;
    case 142:
    case 143:
    case 144:
    case 145:
    case 146: multiply(m, op, w, r, a, b); return true;
    case 148: r->f = dot(a, b, m->types[m->of[w[3]]].cells); return true;
    case 154:
    case 155: {
        uint32_t of = m->types[m->of[w[3]]].cells, ones = 0;
        for (uint32_t i = 0; i < of; i++) ones += a[i].u;
        r->u = op == 154 ? ones > 0 : ones == of;
        return true;
    }
    case 169: { /* select */
        const cell *c = m->cells + m->at[w[5]];
        bool each = m->types[m->of[w[3]]].cells > 1;
        for (uint32_t i = 0; i < n; i++) r[i] = a[each ? i : 0].u ? b[i] : c[i];
        return true;
    }
    default:
        for (uint32_t i = 0; i < n; i++) {
            if (op >= 180 && op <= 191 && a && b) decide(m, w[2], i, a[i].f - b[i].f);
            if (!a || !arithmetic(op, a[i], b ? b[i] : a[i], &r[i]))
                return refuse(m, "instruction", op);
        }
        return true;
    }
}

static size_t enter(masu_bake_machine *m, uint32_t function, const uint32_t *arguments) {
    size_t i = m->where[function] + (m->words[m->where[function]] >> 16);
    for (uint32_t k = 0; (m->words[i] & 0xFFFF) == 55; k++, i += m->words[i] >> 16)
        memcpy(m->cells + m->at[m->words[i + 2]], m->cells + m->at[arguments[k]],
               m->types[m->words[i + 1]].cells * sizeof(cell));
    return i;
}

/* The phis of a block take the values from before the block: all are read, then all written. */
static size_t enter_block(masu_bake_machine *m, uint32_t label, uint32_t from) {
    size_t first = m->where[label] + 2, i = first;
    cell waiting[256];
    for (int pass = 0; pass < 2; pass++) {
        uint32_t used = 0;
        for (i = first; (m->words[i] & 0xFFFF) == 245; i += m->words[i] >> 16) {
            const uint32_t *w = m->words + i;
            uint32_t n = m->types[w[1]].cells;
            if (used + n > 256) return 0;
            for (uint32_t k = 3; k + 1 < w[0] >> 16; k += 2) {
                if (w[k + 1] != from) continue;
                if (!pass) memcpy(waiting + used, m->cells + m->at[w[k]], n * sizeof(cell));
            }
            if (pass) memcpy(m->cells + m->at[w[2]], waiting + used, n * sizeof(cell));
            used += n;
        }
    }
    return i;
}

static uint32_t chosen(const masu_bake_machine *m, const uint32_t *w, uint32_t count) {
    uint32_t op = w[0] & 0xFFFF;
    if (op == 249) return w[1];
    uint32_t value = m->cells[m->at[w[1]]].u;
    if (op == 250) return value ? w[2] : w[3];
    for (uint32_t i = 3; i + 1 < count; i += 2)
        if (w[i] == value) return w[i + 1];
    return w[2];
}

uint64_t masu_bake_machine_steps(const masu_bake_machine *m) { return m->steps; }

bool masu_bake_machine_run(masu_bake_machine *m, char *error, size_t error_size) {
    struct {
        size_t back;
        uint32_t result, block;
    } calls[CALLS_MAX];
    uint32_t depth = 0, block = 0;
    size_t i = enter(m, m->main, NULL);
    m->error = error;
    m->error_size = error_size;
    while (m->decided_count) m->decisions[m->decided[--m->decided_count]] = (double)NAN;
    for (uint32_t budget = BUDGET; budget > 0; budget--, m->steps++) {
        const uint32_t *w = m->words + i;
        uint32_t op = w[0] & 0xFFFF, count = w[0] >> 16;
        i += count;
        switch (op) {
        case 59: /* variable */
            if (count > 4)
                memcpy(m->cells + m->cells[m->at[w[2]]].u, m->cells + m->at[w[4]],
                       m->types[m->of[w[4]]].cells * sizeof(cell));
            break;
        case 8: /* line */
        case 246:
        case 247:
        case 317: break;
        case 1: break; /* undef: the value is unchanged */
        case 248: block = w[1]; break;
        case 62:
            memmove(m->cells + m->cells[m->at[w[1]]].u, m->cells + m->at[w[2]],
                    m->types[m->of[w[2]]].cells * sizeof(cell));
            break;
        case 249:
        case 250:
        case 251: {
            uint32_t label = chosen(m, w, count);
            i = enter_block(m, label, block);
            block = label;
            if (!i) return refuse(m, "too many phis in block", label);
            break;
        }
        case 57:
            if (depth == CALLS_MAX) return refuse(m, "calls too deep:", depth);
            calls[depth].back = i;
            calls[depth].result = w[2];
            calls[depth++].block = block;
            i = enter(m, w[3], w + 4);
            break;
        case 253:
        case 254:
            if (!depth) return true;
            depth--;
            if (op == 254)
                memmove(m->cells + m->at[calls[depth].result], m->cells + m->at[w[1]],
                        m->types[m->of[w[1]]].cells * sizeof(cell));
            i = calls[depth].back;
            block = calls[depth].block;
            break;
        default:
            if (op == 63 || op >= 252 || op < 12 || count < 3) return refuse(m, "instruction", op);
            if (!evaluate(m, op, w, count)) return false;
        }
    }
    return refuse(m, "it does not end within", BUDGET);
}

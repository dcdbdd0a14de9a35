/* group.c: parts of the same form, that is of the same operations and perhaps other arguments,
 * share one function: they are found by a hash of their operations, compared, and put side by
 * side. */
#include "sdfc/internal.h"

#include <stdlib.h>
#include <string.h>

static bool same_user(const sdfc *c, int a, int b) {
    const sdfc_user *u = &c->users[a], *v = &c->users[b];
    return u->glsl_offset == v->glsl_offset && u->c_offset == v->c_offset;
}

static bool same_form(const sdfc *c, const sdfc_program *a, const sdfc_program *b) {
    if (a->function_count != b->function_count || a->arg_count != b->arg_count) return false;
    if (a->root_count != b->root_count || a->surface != b->surface) return false;
    if (memcmp(a->look, b->look, sizeof a->look) != 0) return false;
    if (a->root_count && memcmp(a->root, b->root, (size_t)a->root_count * sizeof *a->root)) {
        return false;
    }
    for (int i = 0; i < a->function_count; i++) {
        const sdfc_function *f = &a->functions[i], *g = &b->functions[i];
        if (f->count != g->count || f->result != g->result) return false;
        for (int k = 0; k < f->count; k++) {
            sdfc_instr x = f->instrs[k];
            const sdfc_instr *y = &g->instrs[k];
            if (x.op == SDFC_CALL_USER && y->op == SDFC_CALL_USER && same_user(c, x.aux, y->aux)) {
                x.aux = y->aux;
            }
            if (memcmp(&x, y, sizeof x) != 0) return false;
        }
    }
    return true;
}

static uint32_t form_hash(const sdfc_program *p) {
    uint32_t h = 2166136261u;
    for (int i = 0; i < p->function_count; i++) {
        for (int k = 0; k < p->functions[i].count; k++) {
            h = (h ^ (uint32_t)p->functions[i].instrs[k].op) * 16777619u;
        }
    }
    return (h ^ (uint32_t)p->arg_count) * 16777619u;
}

/* Whether the form's field is affine in the point: a half-space in any position. The march
 * intersects it in closed form. */
static bool is_flat(const sdfc_program *p) {
    if (p->function_count != (p->surface ? 2 : 1)) return false;
    const sdfc_function *f = &p->functions[0];
    for (int i = 0; i < f->count; i++) {
        const sdfc_instr *at = &f->instrs[i];
        int points = at->op == SDFC_dot3                                              ? 3
                     : at->op == SDFC_sub || at->op == SDFC_mul || at->op == SDFC_neg ? 1
                                                                                      : 0;
        if (!points) return false;
        for (int k = 0; k < sdfc_ops[at->op].operands; k++) {
            if ((at->operand[k] >= 0) != (k < points)) return false;
        }
    }
    return f->count > 0 && f->result >= 0;
}

/* Flat forms last: lists of parts never hold them. */
static void order_groups(sdfc *c) {
    int *place = sdfc_take(c, (size_t)c->group_count, sizeof *place), count = 0;
    free(c->scratch);
    c->scratch = place;
    sdfc_group *ordered = sdfc_take(c, (size_t)c->group_count, sizeof *ordered);
    for (int flat = 0; flat < 2; flat++) {
        for (int g = 0; g < c->group_count; g++) {
            if (c->groups[g].flat != (flat != 0)) continue;
            if (flat) c->flat_parts += c->groups[g].part_count;
            place[g] = count;
            ordered[count++] = c->groups[g];
        }
    }
    for (int i = 0; i < c->part_count; i++) c->parts[i].group = place[c->parts[i].group];
    free(c->groups);
    c->groups = ordered;
    c->group_capacity = c->group_count;
}

/* Parts of one form stand together, else in the order of the text: the march can then go through
 * the forms one after another. */
static void order_parts(sdfc *c) {
    sdfc_part *ordered = sdfc_take(c, (size_t)c->part_count, sizeof *ordered);
    int count = 0;
    for (int g = 0; g < c->group_count; g++) {
        int first = count;
        for (int i = c->groups[g].first_part; i < c->part_count; i++) {
            if (c->parts[i].group == g) ordered[count++] = c->parts[i];
        }
        c->groups[g].first_part = first;
    }
    free(c->parts);
    c->parts = ordered;
    c->part_capacity = c->part_count;
}

void sdfc_group_parts(sdfc *c) {
    uint32_t *hashes = sdfc_take(c, (size_t)c->part_count, sizeof *hashes);
    c->scratch = hashes;
    for (int i = 0; i < c->part_count; i++) {
        sdfc_part *p = &c->parts[i];
        hashes[i] = form_hash(&p->program);
        p->group = -1;
        for (int g = 0; g < c->group_count && p->group < 0; g++) {
            int first = c->groups[g].first_part;
            if (hashes[first] == hashes[i] && same_form(c, &c->parts[first].program, &p->program)) {
                p->group = g;
            }
        }
        if (p->group < 0) {
            c->groups = sdfc_grow(c, c->groups, c->group_count, &c->group_capacity,
                                  sizeof *c->groups, MASU_SDFC_PARTS_MAX, "forms");
            c->groups[c->group_count] = (sdfc_group){.first_part = i, .flat = is_flat(&p->program)};
            p->group = c->group_count++;
        }
        c->groups[p->group].part_count++;
        c->groups[p->group].moves = c->groups[p->group].moves || sdfc_root_moves(c, &p->program);
    }
    order_groups(c);
    order_parts(c);
}

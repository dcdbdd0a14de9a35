/* slots.c: layout and initial values of a scene's array of floats: a record per part, the
 * materials, and the arguments that differ between parts of one form. Slots that change are listed
 * with their expressions. In an anchored scene, slots that are sums of the anchor's coordinates
 * become data (sdfc_place). */
#include "sdfc/internal.h"

#include <stdlib.h>
#include <string.h>

/* An argument is a literal where all parts of the form agree on a constant. */
static void choose_slots(sdfc *c, int group) {
    sdfc_group *g = &c->groups[group];
    const sdfc_program *first = &c->parts[g->first_part].program;
    g->slot_of_arg = sdfc_take(c, (size_t)first->arg_count, sizeof(int));
    for (int a = 0; a < first->arg_count; a++) g->slot_of_arg[a] = -1;
    for (int i = g->first_part; i < c->part_count; i++) {
        if (c->parts[i].group != group) continue;
        const sdfc_program *p = &c->parts[i].program;
        for (int a = 0; a < p->arg_count; a++) {
            int e = p->args[a];
            if (!sdfc_constant(c, e) || c->exprs[e].value != c->exprs[first->args[a]].value) {
                g->slot_of_arg[a] = 0;
            }
        }
    }
    for (int a = 0; a < first->arg_count; a++) {
        if (g->slot_of_arg[a] == 0) g->slot_of_arg[a] = g->slot_count++;
    }
}

static void add_dynamic(sdfc *c, uint32_t slot, int expr) {
    c->dynamic_slots = sdfc_grow(c, c->dynamic_slots, c->dynamic_count, &c->dynamic_capacity,
                                 2 * sizeof *c->dynamic_slots, MASU_SDFC_SLOTS_MAX, "slots");
    c->dynamic_slots[2 * c->dynamic_count] = slot;
    c->dynamic_slots[2 * c->dynamic_count + 1] = (uint32_t)expr;
    c->dynamic_count++;
}

static void set_slot(sdfc *c, uint32_t slot, int expr) {
    c->initial[slot] = c->exprs[expr].value;
    if (c->exprs[expr].dynamic && !c->exprs[expr].local) add_dynamic(c, slot, expr);
}

/* ---- slots that depend only on the anchor ---- */

/* factor . anchor + term, folded into the period if that is not 0. */
typedef struct affine {
    sdfc_place sum;
    bool known;
} affine;

static affine affine_of(const sdfc *c, int e, const affine *all) {
    const sdfc_expr *x = &c->exprs[e];
    affine r = {.known = false}, a = all[x->a[0]], b = all[x->a[1]];
    bool sums = a.known && b.known && a.sum.period == 0 && b.sum.period == 0;
    switch (x->op) {
    case SDFC_CONST: return (affine){{.term = x->value}, true};
    case SDFC_ANCHOR:
        r.sum.factor[x->a[0]] = 1;
        r.known = true;
        return r;
    case SDFC_add:
    case SDFC_sub:
    case SDFC_neg: {
        double s = x->op == SDFC_add ? 1 : -1;
        if (x->op == SDFC_neg) b = a, a = (affine){.known = true}, sums = b.known;
        for (int i = 0; i < 3; i++) a.sum.factor[i] += s * b.sum.factor[i];
        a.sum.term += s * b.sum.term;
        if (x->op == SDFC_neg) a.sum.period = b.sum.period, a.sum.inverse = b.sum.inverse;
        a.known = sums;
        return a;
    }
    case SDFC_mul: {
        bool first = sdfc_constant(c, x->a[0]);
        double s = c->exprs[x->a[first ? 0 : 1]].value;
        if (first) a = b;
        for (int i = 0; i < 3; i++) a.sum.factor[i] *= s;
        a.sum.term *= s;
        a.known = sums && (first || sdfc_constant(c, x->a[1]));
        return a;
    }
    case SDFC_fold:
        a.known =
            a.known && a.sum.period == 0 && sdfc_constant(c, x->a[1]) && sdfc_constant(c, x->a[2]);
        a.sum.period = c->exprs[x->a[1]].value;
        a.sum.inverse = c->exprs[x->a[2]].value;
        return a;
    default: return r;
    }
}

/* A number as a float, and its rounding error. */
static void put_pair(double *to, double v) {
    to[0] = (double)(float)v;
    to[1] = v - to[0];
}

/* Takes them out of the code that the update runs, and lays them behind the slots. */
static void gather_places(sdfc *c) {
    affine *all = sdfc_take(c, (size_t)c->expr_count, sizeof *all);
    free(c->scratch);
    c->scratch = all;
    for (int i = 0; i < c->expr_count; i++) all[i] = affine_of(c, i, all);
    int kept = 0;
    for (int i = 0; i < c->dynamic_count; i++) {
        uint32_t slot = c->dynamic_slots[2 * i], e = c->dynamic_slots[2 * i + 1];
        if (all[e].known) {
            c->places = sdfc_grow(c, c->places, c->place_count, &c->place_capacity,
                                  sizeof *c->places, MASU_SDFC_SLOTS_MAX, "slots");
            c->places[c->place_count] = all[e].sum;
            c->places[c->place_count++].slot = slot;
        } else {
            c->dynamic_slots[2 * kept] = slot;
            c->dynamic_slots[2 * kept++ + 1] = e;
        }
    }
    c->dynamic_count = kept;
    long slots = (long)c->slot_count + (long)c->place_count * SDFC_PLACE_SLOTS;
    if (slots > MASU_SDFC_SLOTS_MAX) {
        sdfc_fail(c, c->parts[c->part_count - 1].token, "more than %d slots", MASU_SDFC_SLOTS_MAX);
    }
    double *initial = sdfc_take(c, (size_t)slots, sizeof *initial);
    memcpy(initial, c->initial, c->slot_count * sizeof *initial);
    free(c->initial);
    c->initial = initial;
    c->place_base = c->slot_count;
    for (int i = 0; i < c->place_count; i++) {
        const sdfc_place *p = &c->places[i];
        double *to = initial + c->place_base + i * SDFC_PLACE_SLOTS;
        to[0] = p->slot;
        for (int k = 0; k < 3; k++) put_pair(to + 1 + 2 * k, p->factor[k]);
        put_pair(to + 7, p->term);
        put_pair(to + 9, p->period);
        to[11] = p->inverse;
    }
    c->slot_count = (uint32_t)slots;
}

/* ---- records ---- */

/* A translation by something that changes, around all else. */
static void find_motion(sdfc *c, sdfc_part *p) {
    const sdfc_shape *s = &c->shapes[p->shape];
    if (s->kind != SDFC_KIND_TRANSLATE) return;
    const sdfc_facts f = c->shapes[s->child[0]].facts;
    int by[3] = {s->number[0], s->number[1], s->number[2]};
    bool dynamic = false;
    for (int i = 0; i < 3; i++) dynamic = dynamic || c->exprs[by[i]].dynamic;
    if (!dynamic || !isfinite(f.radius)) return;
    p->moves = true;
    p->moving_radius = f.radius;
    for (int i = 0; i < 3; i++) {
        p->moving_center[i] = sdfc_apply(c, SDFC_add, by[i], sdfc_number(c, f.center[i]), by[i]);
    }
}

static void fill_record(sdfc *c, int part) {
    sdfc_part *p = &c->parts[part];
    const sdfc_facts *f = &c->shapes[p->shape].facts;
    uint32_t at = (uint32_t)part * MASU_SDFC_PART_SLOTS;
    double *record = c->initial + at;
    find_motion(c, p);
    bool ends = p->moves || isfinite(f->radius);
    double slack = 0; /* fp32 rounds the centre with a relative error of up to 2^-24 */
    for (int i = 0; i < 3; i++) {
        double most = fabs(f->center[i]);
        record[i] = ends ? f->center[i] : 0;
        int center = -1;
        if (p->moves) {
            const sdfc_expr *e = &c->exprs[p->moving_center[i]];
            most = fmin(fmax(fabs(e->low), fabs(e->high)), 1e4);
            center = p->moving_center[i];
        }
        if (c->anchored && ends) {
            /* Rounded relative to the anchor, which classify allows for. */
            if (!p->moves) most = 0, center = sdfc_number(c, f->center[i]);
            center = sdfc_apply(c, SDFC_sub, center, c->anchor_expr[i], 0);
        }
        if (center >= 0) set_slot(c, at + (uint32_t)i, center);
        slack += ends ? most * 2.4e-7 : 0;
    }
    double radius = p->moves ? p->moving_radius : f->radius;
    record[3] = ends ? radius * (1 + 2.4e-7) + slack : -1;
    record[4] = 1 / f->lipschitz * (1 - 1.2e-7);
    if (f->lipschitz == 1) record[4] = 1;
    record[5] = p->group;
    record[6] = p->slot_base;
    record[7] = p->material;
}

/* ---- all slots ---- */

/* Numbers the slots: the parts' records, materials, arguments that differ between parts of a form,
 * changing sides of the box. */
static void number_slots(sdfc *c) {
    for (int g = 0; g < c->group_count; g++) choose_slots(c, g);
    long slots = (long)c->part_count * MASU_SDFC_PART_SLOTS +
                 (long)c->material_count * MASU_SDFC_MATERIAL_SLOTS;
    for (int i = 0; i < c->part_count; i++) {
        c->parts[i].slot_base = (uint32_t)slots;
        slots += c->groups[c->parts[i].group].slot_count;
        if (slots > MASU_SDFC_SLOTS_MAX) {
            sdfc_fail(c, c->parts[i].token, "more than %d slots", MASU_SDFC_SLOTS_MAX);
        }
    }
    for (int i = 0; i < 6; i++) {
        int side = c->box[i / 3][i % 3] = sdfc_box_side(c, i % 3, i >= 3);
        if (side >= 0 && c->exprs[side].dynamic) c->box_slot[i / 3][i % 3] = (uint32_t)slots++;
    }
    if (slots > MASU_SDFC_SLOTS_MAX) {
        sdfc_fail(c, c->parts[c->part_count - 1].token, "more than %d slots", MASU_SDFC_SLOTS_MAX);
    }
    c->slot_count = (uint32_t)slots;
}

void sdfc_assign_slots(sdfc *c) {
    number_slots(c);
    c->initial = sdfc_take(c, c->slot_count, sizeof *c->initial);
    for (int i = 0; i < 6; i++) {
        uint32_t slot = c->box_slot[i / 3][i % 3];
        if (slot) set_slot(c, slot, c->box[i / 3][i % 3]);
    }
    for (int m = 0; m < c->material_count; m++) {
        uint32_t base =
            (uint32_t)(c->part_count * MASU_SDFC_PART_SLOTS + m * MASU_SDFC_MATERIAL_SLOTS);
        for (uint32_t k = 0; k < 8; k++) set_slot(c, base + k, c->materials[m].value[k]);
    }
    for (int i = 0; i < c->part_count; i++) {
        const sdfc_part *p = &c->parts[i];
        const sdfc_group *g = &c->groups[p->group];
        fill_record(c, i);
        for (int a = 0; a < p->program.arg_count; a++) {
            if (g->slot_of_arg[a] < 0) continue;
            set_slot(c, p->slot_base + (uint32_t)g->slot_of_arg[a], p->program.args[a]);
        }
    }
    if (c->anchored) gather_places(c);
}

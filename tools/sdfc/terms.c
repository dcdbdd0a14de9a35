/* terms.c: which operands of unions, cuts and blends are terms: operations that a march skips if
 * their value does not affect the result.
 *
 * In a ball of radius r, two fields a and b of constant L keep a - b within 2 r L of its value at
 * the centre. So min(a, b) equals a throughout the ball if b exceeds a by more than that at the
 * centre; for a blend of radius k, if b exceeds a by k more (Barbier et al., "Lipschitz Pruning",
 * Eurographics 2025, section 4). Skipping b changes no value in the ball, bit for bit. After an
 * evaluation of the field with masu_margin = 2 r, masu_kept has the bits of the remaining operands.
 *
 * Bits: a scene of few parts has one for each part, followed by the bits of the terms, part by
 * part. A bit must save more than its test costs. */
#include "sdfc/internal.h"

enum { WORD = 32, LEAST_COST = 10 };

static int cost_of(const sdfc_instr *i) {
    if (i->op == SDFC_CALL_MIN || i->op == SDFC_CALL_NEAREST || i->op == SDFC_CALL_USER) return 60;
    return sdfc_ops[i->op].text ? 2 : 12;
}

static int cost_of_term(const sdfc_function *f, const sdfc_term *t) {
    int cost = 0;
    for (int k = t->first; k <= t->last; k++) cost += cost_of(&f->instrs[k]);
    return cost;
}

/* The bits of the same join's terms before term t: those that end where its other operand ends, and
 * the terms joined into that operand. */
static int bits_before(const sdfc_function *f, int t) {
    int bits = 0, end = f->terms[t].first - 1;
    if (f->terms[t].opens || f->terms[t].cap) return 0;
    for (int k = t; k-- > 0;) {
        if (f->terms[k].last != end || f->terms[k].cap) continue;
        if (f->terms[k].bit >= 0) bits |= 1 << f->terms[k].bit;
        if (f->terms[k].opens) break;
        end = f->terms[k].first - 1;
    }
    return bits;
}

static int number_terms(sdfc_program *p, int least) {
    int count = 0;
    for (int i = 0; i < p->function_count; i++) {
        sdfc_function *f = &p->functions[i];
        for (int t = 0; t < f->term_count; t++) {
            bool worth =
                !f->terms[t].cap && cost_of_term(f, &f->terms[t]) >= least && count < WORD - 1;
            f->terms[t].bit = worth ? count++ : -1;
        }
        for (int t = 0; t < f->term_count; t++) f->terms[t].before = bits_before(f, t);
    }
    return count;
}

/* All parts of a form share the first one's code: its terms know the largest constant of any. */
static void join_constants(sdfc *c, const sdfc_group *group) {
    sdfc_program *first = &c->parts[group->first_part].program;
    for (int k = 1; k < group->part_count; k++) {
        const sdfc_program *p = &c->parts[group->first_part + k].program;
        for (int i = 0; i < p->function_count; i++) {
            for (int t = 0; t < p->functions[i].term_count; t++) {
                sdfc_term *to = &first->functions[i].terms[t];
                to->lipschitz = fmax(to->lipschitz, p->functions[i].terms[t].lipschitz);
            }
        }
    }
}

static bool same_terms(const sdfc_program *p, const sdfc_program *q) {
    for (int i = 0; i < p->function_count; i++) {
        if (p->functions[i].term_count != q->functions[i].term_count) return false;
    }
    return true;
}

/* The position of the next `count` bits, all in the same 32-bit value. */
static int place_of(int next, int count) {
    return next % WORD + count > WORD ? (next + WORD - 1) / WORD * WORD : next;
}

void sdfc_assign_terms(sdfc *c) {
    if (c->part_count > MASU_SDFC_MASKED_MAX) return;
    int next = c->part_count;
    for (int g = 0; g < c->group_count; g++) {
        sdfc_group *group = &c->groups[g];
        sdfc_program *first = &c->parts[group->first_part].program;
        bool alike = !group->flat;
        for (int k = 1; k < group->part_count && alike; k++) {
            alike = same_terms(first, &c->parts[group->first_part + k].program);
        }
        int each = alike ? number_terms(first, LEAST_COST) : 0, all = each * group->part_count;
        if (all <= WORD && place_of(next, all) + all <= MASU_SDFC_BLOCK_WORDS_MAX * WORD &&
            all > 0) {
            group->term_count = each;
            group->first_term = place_of(next, all);
            next = group->first_term + all;
            join_constants(c, group);
        } else {
            number_terms(first, 1 << 30);
        }
    }
    c->term_bits = next - c->part_count;
}

uint32_t sdfc_block_words(const sdfc *c) {
    if (c->part_count - c->flat_parts < 2 && c->term_bits == 0) return 0;
    if (c->part_count > MASU_SDFC_MASKED_MAX) return MASU_SDFC_BLOCK_WORDS_MAX;
    return (uint32_t)(c->part_count + c->term_bits + WORD - 1) / WORD;
}

uint32_t sdfc_term_word(const sdfc *c, int word) {
    uint32_t bits = 0;
    for (int k = c->part_count; k < c->part_count + c->term_bits; k++)
        bits |= k / WORD == word ? 1u << k % WORD : 0;
    return bits;
}

static bool is_rough(const sdfc *c, int shape) {
    const sdfc_shape *s = &c->shapes[shape];
    switch (s->kind) {
    case SDFC_KIND_MENGER:
    case SDFC_KIND_SIERPINSKI:
    case SDFC_KIND_MANDELBULB:
    case SDFC_KIND_APOLLONIAN:
    case SDFC_KIND_MANDELBOX:
    case SDFC_KIND_JULIA:
    case SDFC_KIND_TERRAIN:
    case SDFC_KIND_KALEIDOSCOPE:
    case SDFC_KIND_USER: return true;
    default: break;
    }
    if (s->facts.lipschitz > 4) return true;
    for (int i = 0; i < s->children; i++) {
        if (is_rough(c, s->child[i])) return true;
    }
    return false;
}

bool sdfc_any_rough(const sdfc *c) {
    for (int i = 0; i < c->part_count; i++) {
        if (is_rough(c, c->parts[i].shape)) return true;
    }
    return false;
}

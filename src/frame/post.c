/* post.c: see post.h. */
#include "frame/post.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

_Static_assert(MASU_LUT_POINTS == MASU_LUT_MAX, "the shader accepts every table of the header");

void masu_post_alloc(masu_post_state *s, masu_arena *arena, const masu_frame_plan *plan) {
    memset(s, 0, sizeof *s);
    uint32_t size = plan->needs.post ? plan->desc.lut_size : 0;
    s->lut = masu_arena_alloc(arena, "colour table", masu_lut_points(size), sizeof *s->lut, 4);
}

/* ---- Colour table ---------------------------------------------------------------------------- */

static uint32_t ten_bits(float value) {
    return value > 0.0f ? (uint32_t)(fminf(value, 1.0f) * 1023.0f + 0.5f) : 0;
}

masu_result masu_post_set_lut(masu_post_state *s, const masu_frame_plan *plan, const float *colors,
                              uint32_t size, masu_detail *detail) {
    uint32_t most = plan->needs.post ? plan->desc.lut_size : 0;
    if (size == 1 || size > most) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "size", size == 1 ? 2 : most, size,
                         "size is %u, allowed are 0 and 2 to desc.lut_size, which is %u", size,
                         most);
    }
    if (size && !colors) return masu_fail_null(detail, "colors");
    for (uint64_t i = 0; i < masu_lut_points(size); i++) {
        const float *c = &colors[3 * i];
        s->lut[i] = ten_bits(c[0]) | ten_bits(c[1]) << 10 | ten_bits(c[2]) << 20;
    }
    s->size = size;
    s->lut_changes++;
    s->changes++;
    return MASU_OK;
}

/* ---- A frame --------------------------------------------------------------------------------- */

typedef struct range {
    const char *name;
    float value, low, high;
    uint32_t of; /* masu_post_bits that it requires; 0: none */
    const char *allowed;
} range;

masu_result masu_post_read(const masu_frame_data *f, masu_detail *detail) {
    const masu_post *p = &f->desc.post;
    const range ranges[] = {
        {"post.bloom", p->bloom, 0.0f, 1.0f, MASU_POST_BLOOM, "0 to 1"},
        {"post.aperture", p->aperture, 0.0f, 1e6f, MASU_POST_FOCUS, "0 to 1e6 m"},
        {"post.focus", p->focus, p->aperture > 0.0f ? 1e-6f : 0.0f, 1e9f, 0,
         "1e-6 to 1e9 m"},
        {"post.vignette", p->vignette, 0.0f, 1.0f, MASU_POST_GRADE, "0 to 1"},
        {"post.brightness", p->brightness, -8.0f, 8.0f, MASU_POST_GRADE, "-8 to 8 stops"},
        {"post.gamma", p->gamma, p->gamma != 0.0f ? 0.1f : 0.0f, 10.0f, MASU_POST_GRADE,
         "0 and 0.1 to 10"}};
    static const char *const names[] = {
        [MASU_POST_BLOOM] = "MASU_POST_BLOOM", [MASU_POST_FOCUS] = "MASU_POST_FOCUS",
        [MASU_POST_GRADE] = "MASU_POST_GRADE"};
    for (uint32_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        const range *r = &ranges[i];
        if (!(r->value >= r->low && r->value <= r->high))
            return masu_fail_number(detail, r->name, (double)r->value, r->allowed);
        if (r->of && r->value != 0.0f && !(f->plan->needs.post & r->of)) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, r->name, r->of, f->plan->needs.post,
                             "%s is %g, but desc.post does not have %s", r->name,
                             (double)r->value, names[r->of]);
        }
    }
    return MASU_OK;
}

void masu_post_write(masu_post_state *s, const masu_frame_data *f) {
    const masu_post *p = &f->desc.post;
    if (!f->plan->needs.post) return;
    const float values[] = {p->bloom,    p->aperture,   p->aperture > 0.0f ? p->focus : 0.0f,
                            p->vignette, p->brightness, p->gamma};
    _Static_assert(sizeof values == sizeof *p, "every member counts");
    if (memcmp(values, &s->last, sizeof values) != 0) s->changes++;
    memcpy(&s->last, values, sizeof values);

    struct masu_post_uniforms u = {{p->bloom, 0, 0, 0}, {p->vignette, 1, 1, (float)s->size}};
    u.grade[1] = exp2f(p->brightness);
    if (p->gamma > 0.0f) u.grade[2] = 1.0f / p->gamma;
    int graded = p->vignette > 0.0f || p->brightness != 0.0f || u.grade[2] != 1.0f || s->size;
    u.lens[3] = graded ? 1.0f : 0.0f;
    if (p->aperture > 0.0f) {
        double radius = (double)p->aperture / (4.0 * (double)p->focus * (double)f->u.up[3]);
        u.lens[1] = (float)radius;
        u.lens[2] = (float)(radius * (double)p->focus / (double)f->u.forward[3]);
    }
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_POST);
    memcpy(to, &u, sizeof u);
    if (!s->size || s->slot_changes[f->slot] == 1 + s->lut_changes) return;
    s->slot_changes[f->slot] = 1 + s->lut_changes;
    memcpy(to + sizeof u, s->lut, masu_lut_points(s->size) * sizeof *s->lut);
}

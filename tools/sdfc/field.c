/* field.c: the parts of a scene as functions of a point, with parameters at their defaults and
 * time 0: the list of operations that check.c tries, kept. */
#include "sdfc/internal.h"

#include <stdlib.h>
#include <string.h>

struct masu_sdfc_field {
    sdfc *c;
    size_t room;
    masu_sdfc_part *parts;
};

static void prepare(masu_sdfc_field *f) {
    sdfc *c = f->c;
    double params[MASU_SDFC_PARAMS_MAX] = {0};
    sdfc_lex(c);
    sdfc_parse(c);
    for (int i = 0; i < c->part_count; i++) sdfc_lower(c, &c->parts[i]);
    sdfc_group_parts(c);
    for (int i = 0; i < c->part_count; i++) {
        size_t own = (size_t)c->parts[i].program.variable_count;
        if (own > f->room) f->room = own;
    }
    for (int i = 0; i < c->param_count; i++) params[i] = c->params[i].value;
    c->values = sdfc_take(c, (size_t)c->expr_count, sizeof *c->values);
    sdfc_evaluate(c, params, 0, c->values);
    f->parts = sdfc_take(c, (size_t)c->part_count + 1, sizeof *f->parts);
    for (int i = 0; i < c->part_count; i++) sdfc_fill_part(c, i, &f->parts[i]);
}

static bool prepared(masu_sdfc_field *f) {
    if (setjmp(f->c->failed)) return false;
    prepare(f);
    return true;
}

masu_sdfc_field *masu_sdfc_field_open(const char *text, size_t bytes, const char *name) {
    masu_sdfc_field *f = calloc(1, sizeof *f);
    if (f) f->c = calloc(1, sizeof *f->c);
    if (!f || !f->c || bytes > MASU_SDFC_SOURCE_MAX) {
        if (f) free(f->c);
        free(f);
        return NULL;
    }
    sdfc_start(f->c);
    f->c->text = text;
    f->c->bytes = bytes;
    f->c->name = name;
    if (prepared(f)) return f;
    masu_sdfc_field_close(f);
    return NULL;
}

void masu_sdfc_field_close(masu_sdfc_field *f) {
    if (!f) return;
    sdfc_free(f->c);
    free(f->parts);
    free(f);
}

const masu_sdfc_part *masu_sdfc_field_parts(const masu_sdfc_field *f, uint32_t *count) {
    *count = (uint32_t)f->c->part_count;
    return f->parts;
}

size_t masu_sdfc_field_room(const masu_sdfc_field *f) { return f->room; }

double masu_sdfc_field_run(const masu_sdfc_field *f, uint32_t part, const double p[3],
                           double *room) {
    return sdfc_run_in(f->c, &f->c->parts[part].program, p, room);
}

void masu_sdfc_field_material(const masu_sdfc_field *f, uint32_t part, const double p[3],
                              const double n[3], double width, double *room,
                              double out[MASU_SDFC_MATERIAL_SLOTS]) {
    const sdfc_place_of at = {{n[0], n[1], n[2]}, width};
    sdfc_run_look(f->c, &f->c->parts[part], p, &at, room, out);
}

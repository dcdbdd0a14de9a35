/* field.c: see field.h. */
#include "support/field.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

bool field_start(field *r, const char *text) {
    sdfc *c = r->c = calloc(1, sizeof *c);
    assert_non_null(c);
    *c = (sdfc){.text = text, .bytes = strlen(text), .name = "x.sdf", .error = r->error, .error_size = sizeof r->error};
    sdfc_start(c);
    r->error[0] = '\0';
    r->room = NULL;
    r->at = (sdfc_place_of){{0}, 0};
    if (setjmp(c->failed)) {
        sdfc_free(r->c);
        return false;
    }
    sdfc_lex(c);
    sdfc_parse(c);
    int variables = 0;
    for (int i = 0; i < c->part_count; i++) {
        sdfc_lower(c, &c->parts[i]);
        if (c->parts[i].program.variable_count > variables)
            variables = c->parts[i].program.variable_count;
    }
    r->room = calloc((size_t)variables, sizeof *r->room);
    c->values = calloc((size_t)c->expr_count, sizeof *c->values);
    double params[MASU_SDFC_PARAMS_MAX] = {0};
    for (int i = 0; i < c->param_count; i++) params[i] = c->params[i].value;
    sdfc_evaluate(c, params, 0, c->values);
    return true;
}

void field_stop(field *r) {
    free(r->room);
    sdfc_free(r->c);
}

double field_value(const field *r, int part, const double p[3]) {
    return sdfc_run_in(r->c, &r->c->parts[part].program, p, r->room);
}

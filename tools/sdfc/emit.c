/* emit.c: all texts, and the table of the parts as JSON; see emit.h. */
#include "sdfc/emit.h"

static void put_json_number(sdfc_writer *w, double v) {
    if (isfinite(v))
        PUT(w, "%.17g", v);
    else
        PUT(w, "null");
}

static void put_json_vector(sdfc_writer *w, const char *name, const double v[3]) {
    PUT(w, "\"%s\": [", name);
    for (int i = 0; i < 3; i++) {
        put_json_number(w, v[i]);
        PUT(w, i < 2 ? ", " : "]");
    }
}

static void put_table(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w, "{\n  \"dynamic\": %s,\n  \"shapes\": %d,\n  \"slots\": %u,\n  \"params\": [",
        c->dynamic_count ? "true" : "false", c->group_count, c->slot_count);
    for (int i = 0; i < c->param_count; i++) {
        const masu_sdfc_param *p = &c->params[i];
        PUT(w, "%s\n    {\"name\": \"%s\", \"value\": %.17g, \"min\": %.17g, \"max\": %.17g}",
            i ? "," : "", p->name, p->value, p->minimum, p->maximum);
    }
    PUT(w, "%s],\n  \"materials\": [", c->param_count ? "\n  " : "");
    for (int i = 0; i < c->material_count; i++) {
        PUT(w, "%s\n    {\"name\": \"%s\", \"slot\": %d}", i ? "," : "", c->materials[i].name,
            c->part_count * MASU_SDFC_PART_SLOTS + i * MASU_SDFC_MATERIAL_SLOTS);
    }
    PUT(w, "\n  ],\n  \"parts\": [");
    for (int i = 0; i < c->part_count; i++) {
        const sdfc_part *p = &c->parts[i];
        const sdfc_facts *f = &c->shapes[p->shape].facts;
        PUT(w,
            "%s\n    {\"name\": \"%s\", \"shape\": %d, \"slot\": %u, \"slots\": %d, "
            "\"material\": %d, \"lipschitz\": %.17g, ",
            i ? "," : "", p->name, p->group, p->slot_base, c->groups[p->group].slot_count,
            p->material, f->lipschitz);
        put_json_vector(w, "center", f->center);
        PUT(w, ", \"radius\": ");
        put_json_number(w, isfinite(f->radius) ? f->radius : -1);
        PUT(w, ", ");
        put_json_vector(w, "low", f->box.low);
        PUT(w, ", ");
        put_json_vector(w, "high", f->box.high);
        PUT(w, ", \"operations\": %.9g, \"truth\": %s}", f->cost, f->truth ? "true" : "false");
    }
    PUT(w, "\n  ]\n}\n");
}

static void find_needed(sdfc *c) {
    c->needed = sdfc_take(c, (size_t)c->expr_count, sizeof *c->needed);
    for (int i = 0; i < c->dynamic_count; i++) c->needed[c->dynamic_slots[2 * i + 1]] = true;
    for (int i = c->expr_count; i-- > 0;) {
        if (!c->needed[i]) continue;
        int op = c->exprs[i].op;
        for (int k = 0; k < sdfc_ops[op].operands; k++) c->needed[c->exprs[i].a[k]] = true;
    }
}

void sdfc_emit(sdfc *c) {
    find_needed(c);
    for (int i = 0; i < c->part_count; i++) {
        if (c->shapes[c->parts[i].shape].facts.truth) continue;
        sdfc_warn(c, c->parts[i].token,
                  "part %s has GLSL without C: it is missing from the C reference",
                  c->parts[i].name);
    }
    sdfc_writer w = {c, &c->glsl, true};
    sdfc_put_glsl(&w);
    w = (sdfc_writer){c, &c->c, false};
    sdfc_put_c(&w);
    w = (sdfc_writer){c, &c->table, false};
    put_table(&w);
}

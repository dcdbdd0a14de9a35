/* compile.c: the steps of a compilation in order, and their results. Every step exits by longjmp on
 * an error; the sdfc structure owns all memory, which is freed here. */
#include "sdfc/internal.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void sdfc_free_program(sdfc_program *p) {
    for (int f = 0; f < p->function_count; f++) {
        free(p->functions[f].instrs);
        free(p->functions[f].terms);
    }
    free(p->functions);
    free(p->args);
    free(p->root);
}

void sdfc_free(sdfc *c) {
    for (int i = 0; i < c->shape_count; i++) free(c->shapes[i].child);
    for (int i = 0; i < c->part_count; i++) sdfc_free_program(&c->parts[i].program);
    for (int i = 0; i < c->group_count; i++) free(c->groups[i].slot_of_arg);
    free(c->joined);
    free(c->files);
    free(c->defs);
    free(c->tokens);
    free(c->exprs);
    free(c->shapes);
    free(c->users);
    free(c->symbols);
    free(c->params);
    free(c->materials);
    free(c->parts);
    free(c->groups);
    free(c->dynamic_slots);
    free(c->places);
    free(c->initial);
    free(c->scratch);
    free(c->needed);
    free(c->values);
    free(c->variables);
    free(c->glsl.data);
    free(c->c.data);
    free(c->table.data);
    free(c->warnings.data);
    free(c);
}

void sdfc_start(sdfc *c) { c->time_expr = c->open_kind = c->call_token = -1; }

static char *taken(sdfc_text *text) {
    char *data = text->data;
    text->data = NULL;
    return data;
}

void sdfc_fill_part(const sdfc *c, int i, masu_sdfc_part *out) {
    const sdfc_part *p = &c->parts[i];
    const sdfc_facts *f = &c->shapes[p->shape].facts;
    memcpy(out->name, p->name, sizeof out->name);
    out->shape = (uint32_t)p->group;
    out->slot_base = p->slot_base;
    out->material = (uint32_t)p->material;
    out->lipschitz = f->lipschitz;
    memcpy(out->center, f->center, sizeof out->center);
    memcpy(out->low, f->box.low, sizeof out->low);
    memcpy(out->high, f->box.high, sizeof out->high);
    out->radius = isfinite(f->radius) ? f->radius : -1;
    out->truth = f->truth;
    out->user = f->user;
    for (int a = 0; a < p->program.arg_count; a++) {
        out->dynamic = out->dynamic || c->exprs[p->program.args[a]].timed;
    }
}

/* Expressions of time or parameters can have any value; local expressions of a surface are within
 * their interval. */
static double roughness_of(const sdfc *c, int material) {
    const sdfc_expr *e = &c->exprs[c->materials[material].value[3]];
    return e->op == SDFC_CONST || (e->local && !e->timed) ? fmax(e->low, 0) : 0;
}

static void painted_roughness(const sdfc *c, int shape, double *least) {
    const sdfc_shape *s = &c->shapes[shape];
    if (s->kind == SDFC_KIND_PAINT) *least = fmin(*least, roughness_of(c, s->paint));
    for (int i = 0; i < s->children; i++) painted_roughness(c, s->child[i], least);
}

static double least_roughness(const sdfc *c) {
    double least = 1;
    for (int i = 0; i < c->part_count; i++) {
        least = fmin(least, roughness_of(c, c->parts[i].material));
        painted_roughness(c, c->parts[i].shape, &least);
    }
    return least;
}

static void fill_result(sdfc *c, masu_sdfc_result *out) {
    out->parts = sdfc_take(c, (size_t)c->part_count, sizeof *out->parts);
    for (int i = 0; i < c->part_count; i++) sdfc_fill_part(c, i, &out->parts[i]);
    out->slots = sdfc_take(c, c->slot_count, sizeof *out->slots);
    for (uint32_t i = 0; i < c->slot_count; i++) {
        out->slots[i] = (float)fmax(fmin(c->initial[i], 1e30), -1e30);
    }
    out->params = sdfc_take(c, (size_t)c->param_count, sizeof *out->params);
    if (c->param_count) {
        memcpy(out->params, c->params, (size_t)c->param_count * sizeof *out->params);
    }
    sdfc_put(c, &c->warnings, "%s", "");
    out->part_count = (uint32_t)c->part_count;
    out->shape_count = (uint32_t)c->group_count;
    out->material_count = (uint32_t)c->material_count;
    out->param_count = (uint32_t)c->param_count;
    out->slot_count = c->slot_count;
    out->block_words = sdfc_block_words(c);
    out->glossiest = least_roughness(c);
    out->timeless = c->time_expr < 0;
    out->anchored = c->place_count > 0;
    for (int i = 0; i < c->dynamic_count; i++) {
        const sdfc_expr *e = &c->exprs[c->dynamic_slots[2 * i + 1]];
        out->dynamic = out->dynamic || e->timed;
        out->anchored = out->anchored || e->anchored;
    }
    out->glsl = taken(&c->glsl);
    out->c = taken(&c->c);
    out->table = taken(&c->table);
    out->warnings = taken(&c->warnings);
}

static void compile(sdfc *c, const masu_sdfc_options *options, masu_sdfc_result *out) {
    uint32_t pairs = options ? options->pairs : 0;
    sdfc_lex(c);
    sdfc_parse(c);
    for (int i = 0; i < 3 && c->anchored; i++) c->anchor_expr[i] = sdfc_anchor_expr(c, i);
    for (int i = 0; i < c->part_count; i++) sdfc_lower(c, &c->parts[i]);
    sdfc_group_parts(c);
    sdfc_assign_slots(c);
    if (pairs != UINT32_MAX) sdfc_check(c, pairs ? pairs : 20000);
    if (options && options->camera_count)
        sdfc_check_cameras(c, options->cameras, options->camera_count);
    sdfc_assign_terms(c);
    sdfc_emit(c);
    fill_result(c, out);
}

bool masu_sdfc_compile_with(const char *text, size_t bytes, const char *name,
                            const masu_sdfc_options *options, masu_sdfc_result *out, char *error,
                            size_t error_size) {
    memset(out, 0, sizeof *out);
    if (error_size) error[0] = '\0';
    if (bytes > MASU_SDFC_SOURCE_MAX) {
        snprintf(error, error_size, "%s: expected at most %zu bytes, found %zu", name,
                 MASU_SDFC_SOURCE_MAX, bytes);
        return false;
    }
    sdfc *c = calloc(1, sizeof *c);
    if (!c) {
        snprintf(error, error_size, "%s: out of memory", name);
        return false;
    }
    sdfc_start(c);
    c->anchored = options && options->anchored;
    c->text = text;
    c->bytes = bytes;
    c->name = name;
    c->error = error;
    c->error_size = error_size;
    if (setjmp(c->failed)) {
        sdfc_free(c);
        masu_sdfc_release(out);
        return false;
    }
    compile(c, options, out);
    sdfc_free(c);
    return true;
}

bool masu_sdfc_compile(const char *text, size_t bytes, const char *name, masu_sdfc_result *out,
                       char *error, size_t error_size) {
    return masu_sdfc_compile_with(text, bytes, name, NULL, out, error, error_size);
}

void masu_sdfc_release(masu_sdfc_result *result) {
    free(result->glsl);
    free(result->c);
    free(result->table);
    free(result->warnings);
    free(result->parts);
    free(result->params);
    free(result->slots);
    memset(result, 0, sizeof *result);
}

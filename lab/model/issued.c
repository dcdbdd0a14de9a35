/* issued.c: see issued.h. */
#include "lab/model/issued.h"

#include <math.h>
#include <string.h>

/* The pass of a pipeline: "gbuffer, masks" belongs to gbuffer. MASU_PASS_COUNT: none. All cascades
 * share their pipelines, which are named "cascade_0" or "cascades, masks". */
static uint32_t pass_of(const char *pipeline) {
    size_t length = strcspn(pipeline, ",");
    if (length == strlen("cascades") && !strncmp(pipeline, "cascades", length))
        return MASU_PASS_CASCADE_0;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (strlen(masu_passes[p].name) == length &&
            !strncmp(masu_passes[p].name, pipeline, length))
            return masu_is_cascade(p) ? MASU_PASS_CASCADE_0 : p;
    }
    return MASU_PASS_COUNT;
}

static bool is_vertex(const masu_isa_row *r) {
    return strstr(r->stage, "ertex") || !strncmp(r->stage, "VS", 2);
}

/* Intel's compiler writes each instruction of 32 lanes as two of 16. */
enum { WIDEST = 16 };

/* Selects the widest waves of a pipeline and stage, which run if possible; excludes binning
 * variants, which repeat a part. */
static bool counts(const masu_isa_rows *rows, uint32_t i) {
    const masu_isa_row *r = &rows->row[i];
    if (strstr(r->stage, "inning")) return false;
    for (uint32_t k = 0; k < rows->count; k++) {
        const masu_isa_row *o = &rows->row[k];
        if (k == i || strcmp(o->pipeline, r->pipeline) || is_vertex(o) != is_vertex(r)) continue;
        if (strstr(o->stage, "inning")) continue;
        if (o->lanes > r->lanes || (o->lanes == r->lanes && k < i)) return false;
    }
    return true;
}

void masu_issued_make(const masu_isa_rows *rows, masu_issued *out) {
    memset(out, 0, sizeof *out);
    out->known = rows->count > 0;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) out->pass[p].waits = 1.0;
    for (uint32_t i = 0; i < rows->count; i++) {
        const double *v = rows->row[i].value;
        uint32_t p = pass_of(rows->row[i].pipeline);
        if (p == MASU_PASS_COUNT || !counts(rows, i) || isnan(v[MASU_ISA_INSTRUCTIONS])) continue;
        bool twice = rows->row[i].lanes > WIDEST && strstr(rows->row[i].stage, "SIMD");
        out->pass[p].instructions[is_vertex(&rows->row[i])] +=
            v[MASU_ISA_INSTRUCTIONS] * (twice ? 0.5 : 1.0);
        double waits = v[MASU_ISA_LATENCY] / (v[MASU_ISA_WAVES] * v[MASU_ISA_CYCLES]);
        if (waits > out->pass[p].waits) out->pass[p].waits = waits; /* NAN: not reported */
    }
}

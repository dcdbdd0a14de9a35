/* emit_c.c: the scene's field as C in double precision: the reference for the GPU results; see
 * emit.h. */
#include "sdfc/emit.h"

#include <string.h>

static void put_c_field(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w,
        "static double field(int part, const double p[3])\n{\n"
        "    uint base = (uint)slot[part * %u + 6];\n"
        "    switch ((int)slot[part * %u + 5]) {\n",
        MASU_SDFC_PART_SLOTS, MASU_SDFC_PART_SLOTS);
    for (int g = 0; g < c->group_count; g++) {
        if (!sdfc_group_truth(c, g)) continue;
        PUT(w, "    case %d: return masu_shape_%d(p[0], p[1], p[2], base);\n", g, g);
    }
    PUT(w, "    default: return INFINITY;\n    }\n}\n\n");
}

/* Forms whose material is not the same everywhere. */
static void put_c_look(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w,
        "static int looks(int part, const double p[3], double out[8])\n{\n"
        "    uint base = (uint)slot[part * %u + 6];\n    (void)base;\n    (void)p;\n    "
        "(void)out;\n"
        "    switch ((int)slot[part * %u + 5]) {\n",
        MASU_SDFC_PART_SLOTS, MASU_SDFC_PART_SLOTS);
    for (int g = 0; g < c->group_count; g++) {
        if (!sdfc_group_truth(c, g) || !c->parts[c->groups[g].first_part].program.surface) continue;
        PUT(w, "    case %d: masu_look_%d(p[0], p[1], p[2], base, out); return 1;\n", g, g);
    }
    PUT(w, "    default: return 0;\n    }\n}\n\n");
}

static const char c_api[] =
    "static int nearest(const double *params, double time, const double p[3], double *step,\n"
    "                   double *distance)\n"
    "{\n"
    "    int part = -1;\n"
    "    *step = *distance = INFINITY;\n"
    "    update(params, time);\n"
    "    for (int i = 0; i < PARTS; i++) {\n"
    "        double f = field(i, p);\n"
    "        if (f < *distance) *distance = f;\n"
    "        if (f / lipschitz[i] < *step) {\n"
    "            *step = f / lipschitz[i];\n"
    "            part = i;\n"
    "        }\n"
    "    }\n"
    "    return part;\n"
    "}\n\n"
    "const int masu_truth_part_count = PARTS;\n\n"
    "double masu_truth_distance(const double *params, double time, const double p[3])\n"
    "{\n"
    "    double step, distance;\n"
    "    nearest(params, time, p, &step, &distance);\n"
    "    return distance;\n"
    "}\n\n"
    "/* one part's field; INFINITY where it has no C */\n"
    "double masu_truth_part_distance(const double *params, double time, const double p[3],\n"
    "                                int part)\n"
    "{\n"
    "    if (part < 0 || part >= PARTS) return INFINITY;\n"
    "    update(params, time);\n"
    "    return field(part, p);\n"
    "}\n\n"
    "double masu_truth_step(const double *params, double time, const double p[3])\n"
    "{\n"
    "    double step, distance;\n"
    "    nearest(params, time, p, &step, &distance);\n"
    "    return step;\n"
    "}\n\n"
    "int masu_truth_part(const double *params, double time, const double p[3])\n"
    "{\n"
    "    double step, distance;\n"
    "    return nearest(params, time, p, &step, &distance);\n"
    "}\n\n"
    "/* a part's albedo, roughness, emissive, metallic at a point, with a normal and the width of "
    "a pixel there */\n"
    "void masu_truth_look(const double *params, double time, int part, const double p[3],\n"
    "                     const double n[3], double width, double out[8])\n"
    "{\n"
    "    if (part < 0 || part >= PARTS) part = 0;\n"
    "    update(params, time);\n"
    "    memcpy(masu_normal, n, sizeof masu_normal);\n"
    "    masu_footprint = width;\n"
    "    if (looks(part, p, out)) return;\n"
    "    memcpy(out, slot + MATERIALS + 8 * (int)slot[part * 8 + 7], 8 * sizeof *out);\n"
    "}\n\n"
    "/* albedo, roughness, emissive, metallic, as of the last call above in this thread */\n"
    "void masu_truth_material(int part, double out[8])\n"
    "{\n"
    "    if (part < 0 || part >= PARTS) part = 0;\n"
    "    if (!ready) memcpy(slot, initial, sizeof slot);\n"
    "    ready = 1;\n"
    "    memcpy(out, slot + MATERIALS + 8 * (int)slot[part * 8 + 7], 8 * sizeof *out);\n"
    "}\n";

void sdfc_put_c(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w, "/* Made by masu-sdfc: the distance in double precision. */\n"
           "#include <math.h>\n#include <stdint.h>\n#include <string.h>\n\n");
    PUT(w, "#define PARTS %d\n#define MATERIALS %d\n#define PARAMS %d\n\n", c->part_count,
        c->part_count * MASU_SDFC_PART_SLOTS, c->param_count);
    PUT(w, "static const double initial[%u] = {", c->slot_count);
    for (uint32_t i = 0; i < c->slot_count; i++) {
        PUT(w, i % 8 ? " " : "\n    ");
        sdfc_put_number(w, c->initial[i]);
        PUT(w, ",");
    }
    PUT(w, "\n};\nstatic const double lipschitz[PARTS] = {");
    for (int i = 0; i < c->part_count; i++) {
        PUT(w, i % 8 ? " " : "\n    ");
        sdfc_put_number(w, c->shapes[c->parts[i].shape].facts.lipschitz);
        PUT(w, ",");
    }
    PUT(w, "\n};\nstatic _Thread_local double slot[%u];\n", c->slot_count);
    PUT(w, "static _Thread_local double now[PARAMS + 1]; /* parameters and time of the slots */\n"
           "static _Thread_local int ready;\n\n"
           "static double masu_param(int i) { return i >= 0 && i < PARAMS ? now[i] : 0.0; }\n"
           "static double masu_time(void) { return now[PARAMS]; }\n"
           "static _Thread_local double masu_normal[3], masu_footprint;\n\n");
    sdfc_put_users(w);
    sdfc_put_bytes(c, w->out, sdfc_c_prelude, strlen(sdfc_c_prelude));
    PUT(w, "\ntypedef uint32_t uint;\n#define uint(x) ((uint32_t)(x))\n#define real(x) "
           "((real)(x))\n"
           "#define TO_INT(x) ((int32_t)((x) == (x) ? (x) : 0.0))\n"
           "#define min lib_min\n#define max lib_max\n#define mix lib_mix\n#define abs fabs\n\n");
    sdfc_put_library(w, true);
    PUT(w, "\n");
    sdfc_put_shapes(w);
    put_c_field(w);
    put_c_look(w);
    PUT(w, "static void update(const double *params, double time)\n{\n"
           "    (void)masu_param;\n    (void)masu_time;\n"
           "    if (ready && now[PARAMS] == time &&\n"
           "        (PARAMS == 0 || memcmp(now, params, PARAMS * sizeof *now) == 0)) {\n"
           "        return;\n    }\n"
           "    if (!ready) memcpy(slot, initial, sizeof slot);\n    ready = 1;\n"
           "    if (PARAMS > 0) memcpy(now, params, PARAMS * sizeof *now);\n"
           "    now[PARAMS] = time;\n");
    sdfc_put_update(w);
    PUT(w, "}\n\n");
    sdfc_put_bytes(c, w->out, c_api, sizeof c_api - 1);
}

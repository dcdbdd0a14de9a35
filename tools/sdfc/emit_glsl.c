/* emit_glsl.c: the scene's field as GLSL: parts by number, the closest part in any order or in
 * ascending order, half-spaces in closed form, surfaces, root transforms, the update; see
 * emit.h. */
#include "sdfc/emit.h"

static bool any_timed(const sdfc *c) {
    for (int i = 0; i < c->dynamic_count; i++) {
        if (c->exprs[c->dynamic_slots[2 * i + 1]].timed) return true;
    }
    return false;
}

/* Selects the terms of a part to be evaluated: its bits, from the first on. */
static void put_terms_on(sdfc_writer *w, const sdfc_group *group, bool several) {
    if (!group->term_count)
        PUT(w, "0xFFFFFFFFu");
    else if (several)
        PUT(w, "masu_term_bits(%d) >> (%uu + (part - %uu) * %uu)", group->first_term / 32,
            (unsigned)group->first_term % 32, (unsigned)group->first_part,
            (unsigned)group->term_count);
    else
        PUT(w, "masu_term_bits(%d) >> %uu", group->first_term / 32,
            (unsigned)group->first_term % 32);
}

/* The last slot at which the arguments of a part of group g can begin. The actual first slot is
 * read from data. */
static uint32_t last_base(const sdfc *c, int g) {
    return c->slot_count - (uint32_t)c->groups[g].slot_count;
}

/* "float NAME = f / L;" of a part of group g, whose number is in `part` where the group has
 * several. */
static void put_part_value(sdfc_writer *w, int g, const char *name, const char *point) {
    const sdfc *c = w->c;
    const sdfc_group *group = &c->groups[g];
    if (group->part_count == 1) {
        PUT(w, "        float %s = masu_shape_%d(%s.x, %s.y, %s.z, %uu, ", name, g, point, point,
            point, c->parts[group->first_part].slot_base);
        put_terms_on(w, group, false);
        PUT(w, ")");
        double safe = c->initial[group->first_part * MASU_SDFC_PART_SLOTS + 4];
        if (safe != 1) {
            PUT(w, " * ");
            sdfc_put_number(w, safe);
        }
        PUT(w, ";\n");
        return;
    }
    PUT(w, "        uint record = part * %uu;\n", MASU_SDFC_PART_SLOTS);
    PUT(w, "        uint base = min(uint(masu_slot(record + 6u)), %uu);\n", last_base(c, g));
    PUT(w, "        float %s = masu_shape_%d(%s.x, %s.y, %s.z, base, ", name, g, point, point,
        point);
    put_terms_on(w, group, true);
    PUT(w, ") * masu_slot(record + 4u);\n");
}

/* The derivative of a half-space's field along d: its operations without their constant terms. */
static void put_slope(sdfc_writer *w, int group) {
    const sdfc_group *g = &w->c->groups[group];
    const sdfc_program *p = &w->c->parts[g->first_part].program;
    const sdfc_function *f = &p->functions[0];
    PUT(w, "float masu_slope_%d(float x, float y, float z, uint base)\n{\n", group);
    for (int k = 0; k < f->count; k++) {
        const sdfc_instr *i = &f->instrs[k];
        if (i->op == SDFC_sub) {
            PUT(w, "    float v%d = ", 3 + k);
            sdfc_put_operand(w, g, p, i->operand[0]);
            PUT(w, ";\n");
        } else {
            sdfc_put_instr(w, group, p, i, 3 + k, false);
        }
    }
    PUT(w, "    return ");
    sdfc_put_operand(w, g, p, f->result);
    PUT(w, ";\n}\n\n");
}

static void put_slot_base(sdfc_writer *w, int g) {
    const sdfc_group *group = &w->c->groups[g];
    if (group->part_count == 1)
        PUT(w, "%uu", w->c->parts[group->first_part].slot_base);
    else
        PUT(w, "min(uint(masu_slot(part * %uu + 6u)), %uu)", MASU_SDFC_PART_SLOTS,
            last_base(w->c, g));
}

/* Half-spaces along a ray, and their normals. No part has a field that is not a number. */
static void put_flat(sdfc_writer *w) {
    const sdfc *c = w->c;
    for (int g = 0; g < c->group_count; g++) {
        if (c->groups[g].flat) put_slope(w, g);
    }
    PUT(w,
        "float masu_sdf_flat(vec3 o, vec3 d, float start, out uint nearest)\n{\n"
        "    float first = 1e30;\n    nearest = %uu;\n",
        (unsigned)(c->part_count - c->flat_parts));
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!group->flat) continue;
        PUT(w, "    for (uint part = %du; part < %du; part++) {\n", group->first_part,
            group->first_part + group->part_count);
        PUT(w, "        float h = masu_shape_%d(o.x, o.y, o.z, ", g);
        put_slot_base(w, g);
        PUT(w, ", 0u);\n        float slope = masu_slope_%d(d.x, d.y, d.z, ", g);
        put_slot_base(w, g);
        PUT(w, ");\n"
               "        float t = h + slope * start <= 0.0 ? start : slope < 0.0 ? -h / slope : "
               "1e30;\n"
               "        nearest = t < first ? part : nearest;\n"
               "        first = t < first ? t : first;\n    }\n");
    }
    PUT(w, "    return first;\n}\n\n"
           "vec3 masu_sdf_flat_normal(uint part)\n{\n    vec3 n = vec3(0.0);\n");
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!group->flat) continue;
        PUT(w, "    if (part >= %du) {\n        n = vec3(", group->first_part);
        for (int k = 0; k < 3; k++) {
            PUT(w, "masu_slope_%d(%d.0, %d.0, %d.0, ", g, k == 0, k == 1, k == 2);
            put_slot_base(w, g);
            PUT(w, k < 2 ? "), " : "));\n    }\n");
        }
    }
    PUT(w, "    return n;\n}\n\n");
}

/* The box around the listed parts. */
static void put_box(sdfc_writer *w) {
    const sdfc *c = w->c;
    PUT(w, "void masu_sdf_box(out vec3 low, out vec3 high)\n{\n");
    for (int side = 0; side < 2; side++) {
        PUT(w, side ? "    high = vec3(" : "    low = vec3(");
        for (int axis = 0; axis < 3; axis++) {
            int e = c->box[side][axis];
            if (axis) PUT(w, ", ");
            if (c->box_slot[side][axis])
                PUT(w, "masu_slot(%uu)", c->box_slot[side][axis]);
            else
                sdfc_put_number(w, e >= 0 ? c->exprs[e].value : side ? 1e30 : -1e30);
        }
        PUT(w, ");\n");
    }
    PUT(w, "}\n\n");
}

static void put_glsl_dispatch(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w, "float masu_sdf_part(uint part, vec3 p)\n{\n");
    if (c->part_count == 1) {
        PUT(w, "    return masu_shape_0(p.x, p.y, p.z, %uu, 0xFFFFFFFFu)", c->parts[0].slot_base);
        if (c->initial[4] != 1) {
            PUT(w, " * ");
            sdfc_put_number(w, c->initial[4]);
        }
        PUT(w, ";\n}\n\n");
        return;
    }
    PUT(w, "    uint record = part * %uu;\n", MASU_SDFC_PART_SLOTS);
    PUT(w, "    float safe = masu_slot(record + 4u);\n");
    PUT(w, "    uint base = uint(masu_slot(record + 6u));\n");
    if (c->group_count == 1) {
        PUT(w, "    return masu_shape_0(p.x, p.y, p.z, min(base, %uu), 0xFFFFFFFFu) * safe;\n}\n\n",
            last_base(c, 0));
        return;
    }
    PUT(w, "    float d = 1e30;\n    switch (uint(masu_slot(record + 5u))) {\n");
    for (int g = 0; g < c->group_count; g++) {
        PUT(w,
            "    case %du: d = masu_shape_%d(p.x, p.y, p.z, min(base, %uu), 0xFFFFFFFFu); break;\n",
            g, g, last_base(c, g));
    }
    PUT(w, "    }\n    return d * safe;\n}\n\n");
}

static void put_head(sdfc_writer *w) {
    PUT(w, "float masu_sdf_with(vec3 p, out uint nearest)\n{\n    float d = 1e30;\n"
           "    nearest = 0u;\n");
}

/* A part whose field is NaN is not there. */
static void put_least(sdfc_writer *w) {
    PUT(w, "        nearest = f < d ? part : nearest;\n        d = f < d ? f : d;\n");
}

static double least_growth(const sdfc *c, const sdfc_group *group) {
    double growth = 1;
    for (int k = 0; k < group->part_count; k++) {
        growth = fmin(growth, c->shapes[c->parts[group->first_part + k].shape].facts.growth);
    }
    return growth;
}

static bool is_estimate(const sdfc *c, const sdfc_group *group) {
    return c->shapes[c->parts[group->first_part].shape].facts.estimate;
}

/* For a scene of few parts: the bits of the current part that matter in the ball. An estimate can
 * matter wherever its sphere can. */
static void put_keep(sdfc_writer *w, const sdfc_group *group) {
    bool several = group->part_count > 1;
    if (is_estimate(w->c, group))
        PUT(w, "        MASU_KEEP_ESTIMATE(sure, part, masu_slot(part * %uu + 4u) * (%.9g))\n",
            MASU_SDFC_PART_SLOTS, least_growth(w->c, group));
    else if (several)
        PUT(w, "        MASU_KEEP_PART(d, f, part >> 5, 1u << (part & 31u))\n");
    else
        PUT(w, "        MASU_KEEP_PART(d, f, %uu, 0x%xu)\n", (unsigned)group->first_part / 32,
            1u << group->first_part % 32);
    if (!group->term_count) return;
    PUT(w, "        MASU_KEEP_TERMS(%d, ", group->first_term / 32);
    if (several)
        PUT(w, "%uu + (part - %uu) * %uu)\n", (unsigned)group->first_term % 32,
            (unsigned)group->first_part, (unsigned)group->term_count);
    else
        PUT(w, "%uu)\n", (unsigned)group->first_term % 32);
}

/* Half-spaces are always included, unless the includer intersects them in closed form. */
static void put_flat_least(sdfc_writer *w) {
    const sdfc *c = w->c;
    if (!c->flat_parts) return;
    PUT(w, "#ifndef MASU_SDF_NO_FLAT\n");
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!group->flat) continue;
        PUT(w, "    for (uint part = %du; part < %du; part++) {\n", group->first_part,
            group->first_part + group->part_count);
        put_part_value(w, g, "f", "p");
        put_least(w);
        PUT(w, "    }\n");
    }
    PUT(w, "#endif\n");
}

static void put_any_order(sdfc_writer *w) {
    if (w->c->part_count == 1 && !w->c->flat_parts) {
        PUT(w, "float masu_sdf_with(vec3 p, out uint nearest)\n{\n    nearest = 0u;\n"
               "    float f = masu_part_count() > 0u ? masu_sdf_part(0u, p) : 1e30;\n"
               "    return f < 1e30 ? f : 1e30;\n}\n");
        return;
    }
    put_head(w);
    PUT(w, "    uint count = masu_part_count();\n"
           "    MASU_LOOP for (uint i = 0u; i < uint(MASU_SDF_LISTED_COUNT); i++) {\n"
           "        if (i >= count) {\n            break;\n        }\n"
           "        uint part = masu_part_at(i);\n        float f = masu_sdf_part(part, p);\n");
    put_least(w);
    PUT(w, "    }\n");
    put_flat_least(w);
    PUT(w, "    return d;\n}\n");
}

/* A part that is the only one of its form. Rejected alternative: one common evaluation for all
 * parts that share a local space, so that an angle that they have in common is computed once. It
 * made sense while only tiles selected parts; blocks of pixels select a single part. */
static void put_only_part(sdfc_writer *w, int g) {
    const sdfc_group *group = &w->c->groups[g];
    bool alone = w->c->part_count - w->c->flat_parts == 1;
    if (alone)
        PUT(w, "    {\n");
    else
        PUT(w, "    if ((masu_part_bits(%d) & 0x%xu) != 0u) {\n", group->first_part / 32,
            1u << group->first_part % 32);
    PUT(w, "        const uint part = %du;\n", group->first_part);
    PUT(w, "        MASU_KEEP_BEGIN\n");
    put_part_value(w, g, "f", "p");
    put_keep(w, group);
    put_least(w);
    PUT(w, "    }\n");
}

/* The parts of a form with several parts are found bit by bit. Rejected alternative: lists of
 * numbers in memory also for few parts. On lavapipe each lane fetches separately, which cost more
 * than the parts' arithmetic. */
static void put_masked_group(sdfc_writer *w, int g) {
    const sdfc_group *group = &w->c->groups[g];
    int first = group->first_part, end = first + group->part_count;
    for (int word = first / 32; word * 32 < end; word++) {
        int low = first > word * 32 ? first - word * 32 : 0;
        int high = end < word * 32 + 32 ? end - word * 32 : 32;
        uint32_t own = (high == 32 ? 0xFFFFFFFFu : (1u << high) - 1u) & ~((1u << low) - 1u);
        PUT(w,
            "    MASU_LOOP for (uint n = 0u, bits = masu_part_bits(%d) & 0x%xu; n < %du; n++) {\n",
            word, own, high - low);
        PUT(w,
            "        if (bits == 0u) {\n            break;\n        }\n"
            "        uint part = %du + uint(findLSB(bits));\n        bits &= bits - 1u;\n",
            word * 32);
        PUT(w, "        MASU_KEEP_BEGIN\n");
        put_part_value(w, g, "f", "p");
        put_keep(w, group);
        put_least(w);
        PUT(w, "    }\n");
    }
}

static bool any_estimate(const sdfc *c) {
    for (int g = 0; g < c->group_count; g++) {
        if (is_estimate(c, &c->groups[g])) return true;
    }
    return false;
}

/* The current part is read once and kept across the ends of loops; after the last part it is
 * 0xFFFFFFFF. */
static void put_listed_group(sdfc_writer *w, int g) {
    const sdfc *c = w->c;
    const sdfc_group *group = &c->groups[g];
    int end = group->first_part + group->part_count;
    PUT(w, "    MASU_LOOP for (uint n = 0u; n < %du; n++) {\n", group->part_count);
    PUT(w, "        if (part >= %du) {\n            break;\n        }\n", end);
    put_part_value(w, g, "f", "p");
    PUT(w, any_estimate(c) ? "        MASU_KEEP_PART(0.0, 0.0, i >> 5, 1u << (i & 31u))\n"
                           : "        MASU_KEEP_PART(d, f, i >> 5, 1u << (i & 31u))\n");
    put_least(w);
    PUT(w, "        i = masu_next_place(i);\n        part = i < count ? masu_part_at(i) : "
           "0xFFFFFFFFu;\n    }\n");
}

/* One loop per form: on a driver that executes all arms of a switch and masks their writes, a part
 * then costs only its own form. Needs a list in ascending order, or bits. */
static void put_ascending(sdfc_writer *w) {
    const sdfc *c = w->c;
    bool masked = c->part_count <= MASU_SDFC_MASKED_MAX;
    put_head(w);
    PUT(w, "    MASU_KEEP_NONE\n");
    if (!masked) PUT(w, "    uint count = masu_part_count();\n    uint i = masu_first_place();\n"
                    "    uint part = i < count ? masu_part_at(i) : 0xFFFFFFFFu;\n");
    /* Estimates come last: they give no bound for other parts. */
    for (int late = 0; late < 2; late++) {
        if (late && any_estimate(c)) PUT(w, "    float sure = d;\n");
        for (int g = 0; g < c->group_count; g++) {
            bool turn = (masked && is_estimate(c, &c->groups[g])) == (late != 0);
            if (c->groups[g].flat || !turn) continue;
            if (!masked)
                put_listed_group(w, g);
            else if (c->groups[g].part_count > 1)
                put_masked_group(w, g);
            else
                put_only_part(w, g);
        }
    }
    put_flat_least(w);
    PUT(w, "    return d;\n}\n");
}

/* ---- root transforms ---- */

/* One step, inwards or outwards. The rows of a rotation are orthonormal, so its transpose is the
 * inverse. */
static void put_root_step(sdfc_writer *w, int group, const sdfc_root_step *step, bool out) {
    const sdfc_group *g = &w->c->groups[group];
    const sdfc_program *p = &w->c->parts[g->first_part].program;
    bool turn = step->kind == SDFC_KIND_ROTATE;
    PUT(w, "        p = ");
    if (!turn) PUT(w, step->kind == SDFC_KIND_SCALE ? "p * " : out ? "p + " : "p - ");
    PUT(w, "vec3(");
    for (int i = 0; i < 3; i++) {
        if (i) PUT(w, ", ");
        if (turn) {
            PUT(w, "dot(p, vec3(");
            for (int k = 0; k < 3; k++) {
                if (k) PUT(w, ", ");
                sdfc_put_operand(w, g, p, ~step->arg[out ? 3 * k + i : 3 * i + k]);
            }
            PUT(w, "))");
        } else {
            bool invert = step->kind == SDFC_KIND_SCALE && out;
            if (invert) PUT(w, "masu_rcp(");
            sdfc_put_operand(w, g, p, ~step->arg[i]);
            if (invert) PUT(w, ")");
        }
    }
    PUT(w, ");\n");
}

/* A user-defined GLSL field can use time and parameters anywhere. */
static bool part_moves(const sdfc *c, int part) {
    const sdfc_part *p = &c->parts[part];
    if (c->shapes[p->shape].facts.user) return true;
    for (int a = 0; a < p->program.arg_count; a++) {
        if (c->exprs[p->program.args[a]].timed) return true;
    }
    return false;
}

/* Which parts change with time or parameters: all other visible surfaces move only with the camera.
 * If the runs of part numbers are too many for a chain of comparisons, all parts. */
static void put_moving(sdfc_writer *w) {
    enum { RUNS = 16 };
    const sdfc *c = w->c;
    uint32_t bits[MASU_SDFC_MASKED_MAX / 32] = {0};
    int listed = c->part_count - c->flat_parts, runs = 0;
    bool some = false, flat = false;
    for (int i = 0; i < c->part_count; i++) {
        if (!part_moves(c, i)) continue;
        some = true;
        flat = flat || i >= listed;
        if (i < MASU_SDFC_MASKED_MAX) bits[i / 32] |= 1u << i % 32;
        runs += i == 0 || !part_moves(c, i - 1);
    }
    PUT(w, "#ifdef MASU_MOTION\n#define MASU_SDF_MOVING %d\n#define MASU_SDF_MOVING_FLAT %d\n",
        some, flat);
    PUT(w, "uint masu_sdf_moving_bits(int word)\n{\n    return word == 0 ? 0x%xu : 0x%xu;\n}\n\n",
        bits[0], bits[1]);
    PUT(w, "bool masu_sdf_part_moves(uint part)\n{\n    return ");
    for (int i = 0; i < c->part_count && runs && runs <= RUNS; i++) {
        if (!part_moves(c, i) || (i > 0 && part_moves(c, i - 1))) continue;
        int last = i;
        while (last + 1 < c->part_count && part_moves(c, last + 1)) last++;
        PUT(w, last > i ? "(part >= %du && part <= %du) || " : "part == %du || ", i, last);
    }
    PUT(w, runs > RUNS ? "true;\n}\n#endif\n\n" : "false;\n}\n#endif\n\n");
}

/* Transforms from world space to a part's local space, and back: the translations, rotations and
 * scalings at the root of the part. Nothing for parts whose root transform does not change. */
static void put_roots(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w, "#ifdef MASU_MOTION\nvec3 masu_sdf_root(uint part, vec3 p, bool out_of)\n{\n");
    PUT(w, "    uint record = part * %uu;\n", MASU_SDFC_PART_SLOTS);
    PUT(w, "    uint form = uint(masu_slot(record + 5u));\n");
    PUT(w, "    uint first = uint(masu_slot(record + 6u));\n");
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_program *p = &c->parts[c->groups[g].first_part].program;
        if (!c->groups[g].moves) continue;
        PUT(w, "    if (form == %du && !out_of) {\n        uint base = min(first, %uu);\n", g,
            last_base(c, g));
        for (int i = 0; i < p->root_count; i++) put_root_step(w, g, &p->root[i], false);
        PUT(w, "    }\n    if (form == %du && out_of) {\n        uint base = min(first, %uu);\n", g,
            last_base(c, g));
        for (int i = p->root_count; i-- > 0;) put_root_step(w, g, &p->root[i], true);
        PUT(w, "    }\n");
    }
    PUT(w, "    return p;\n}\n#endif\n\n");
}

/* One slot that depends only on the anchor; its constants are slots too. */
static void put_places(sdfc_writer *w) {
    PUT(w,
        "#define MASU_SDF_PLACES %d\n"
        "void masu_sdf_place(uint i)\n{\n"
        "    uint at = %uu + i * %uu;\n"
        "    vec2 v = vec2(masu_slot(at + 7u), masu_slot(at + 8u));\n"
        "    for (int k = 0; k < 3; k++) {\n"
        "        uint factor = at + 1u + 2u * uint(k);\n"
        "        vec2 m = vec2(masu_slot(factor), masu_slot(factor + 1u));\n"
        "        v = masu_wide_add(v, masu_wide_mul(m, vec2(masu_anchor(k), 0.0)));\n"
        "    }\n"
        "    if (masu_slot(at + 11u) != 0.0) {\n"
        "        vec2 period = vec2(masu_slot(at + 9u), masu_slot(at + 10u));\n"
        "        v = masu_wide_fold(v, period, vec2(masu_slot(at + 11u), 0.0));\n"
        "    }\n"
        "    masu_slot_write(min(uint(masu_slot(at)), %uu), v.x + v.y);\n}\n",
        w->c->place_count, w->c->place_base, SDFC_PLACE_SLOTS, w->c->slot_count - 1);
}

/* Forms whose material is not the same everywhere have a function for it. */
static void put_looks(sdfc_writer *w) {
    const sdfc *c = w->c;
    for (int g = 0; g < c->group_count; g++) {
        const sdfc_group *group = &c->groups[g];
        if (!c->parts[group->first_part].program.surface) continue;
        PUT(w,
            "    if (part >= %du && part < %du) {\n        float look[8];\n        "
            "masu_look_%d(p.x, p.y, p.z, ",
            group->first_part, group->first_part + group->part_count, g);
        put_slot_base(w, g);
        PUT(w, ", 0xFFFFFFFFu, look);\n"
               "        s.albedo = vec3(look[0], look[1], look[2]);\n"
               "        s.roughness = look[3];\n"
               "        s.emissive = vec3(look[4], look[5], look[6]);\n"
               "        s.metallic = look[7];\n    }\n");
    }
}

static bool any_looks(const sdfc *c) {
    for (int i = 0; i < c->part_count; i++) {
        if (c->parts[i].program.surface) return true;
    }
    return false;
}

static void put_surfaces(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w,
        "void masu_sdf_part_surface(uint part, vec3 p, inout masu_surface s)\n{\n"
        "    uint material = min(uint(masu_slot(part * %uu + 7u)), %uu);\n"
        "    uint at = %uu + material * %uu;\n"
        "    s.albedo = vec3(masu_slot(at), masu_slot(at + 1u), masu_slot(at + 2u));\n"
        "    s.roughness = masu_slot(at + 3u);\n"
        "    s.emissive = vec3(masu_slot(at + 4u), masu_slot(at + 5u), masu_slot(at + 6u));\n"
        "    s.metallic = masu_slot(at + 7u);\n",
        MASU_SDFC_PART_SLOTS, (unsigned)(c->material_count > 0 ? c->material_count - 1 : 0),
        (unsigned)c->part_count * MASU_SDFC_PART_SLOTS, MASU_SDFC_MATERIAL_SLOTS);
    put_looks(w);
    PUT(w, "}\n\n"
           "void masu_sdf_surface(vec3 p, inout masu_surface s)\n{\n"
           "    masu_sdf_part_surface(masu_sdf_nearest(p), p, s);\n}\n\n");
}

void sdfc_put_glsl(sdfc_writer *w) {
    sdfc *c = w->c;
    PUT(w, "/* Made by masu-sdfc: %d parts of %d forms. */\n", c->part_count, c->group_count);
    PUT(w, "#ifndef MASU_LOOP\n#define MASU_LOOP /* an includer's [[dont_unroll]] */\n#endif\n");
    PUT(w, "#define MASU_SDF_PART_COUNT %d\n", c->part_count);
    PUT(w, "#define MASU_SDF_LISTED_COUNT %d /* the rest are half-spaces */\n",
        c->part_count - c->flat_parts);
    PUT(w, "#define MASU_SDF_MASKED %d /* 1: lists of parts are bits */\n",
        c->part_count <= MASU_SDFC_MASKED_MAX);
    PUT(w,
        "#define MASU_SDF_BLOCK_WORDS %u /* of bits that say what matters in a block of pixels "
        "*/\n",
        sdfc_block_words(c));
    for (int word = 0; word < MASU_SDFC_BLOCK_WORDS_MAX; word++) {
        PUT(w, "#define MASU_SDF_TERM_BITS_%d 0x%xu\n", word, sdfc_term_word(c, word));
    }
    PUT(w,
        "#define MASU_SDF_ROUGH %d /* 1: it has detail of any size, or falls much slower than "
        "distances */\n",
        sdfc_any_rough(c));
    PUT(w, "#define MASU_SDF_SLOT_COUNT %u\n", c->slot_count);
    PUT(w, "#define MASU_SDF_DYNAMIC %d\n\n", any_timed(c));
    if (any_looks(c)) {
        PUT(w,
            "#define MASU_SDF_PAINTED 1 /* materials ask for masu_normal and a pixel's width */\n"
            "float masu_footprint = 0.0;\n\n");
    }
    sdfc_put_users(w);
    PUT(w, "#include \"sdf/terms.glsl\"\n#define real float\n#define TO_INT(x) int(x)\n");
    sdfc_put_library(w, false);
    PUT(w, "\n");
    sdfc_put_shapes(w);
    put_glsl_dispatch(w);
    PUT(w,
        "vec4 masu_sdf_bounds(uint part)\n{\n"
        "    uint record = part * %uu;\n"
        "    return vec4(masu_slot(record), masu_slot(record + 1u), masu_slot(record + 2u),\n"
        "                masu_slot(record + 3u));\n}\n\n",
        MASU_SDFC_PART_SLOTS);
    put_box(w);
    put_roots(w);
    put_moving(w);
    PUT(w, "#ifdef MASU_SDF_ASCENDING\n");
    put_ascending(w);
    PUT(w, "#else\n");
    put_any_order(w);
    PUT(w, "#endif\n\n"
           "float masu_sdf(vec3 p)\n{\n    uint part;\n    return masu_sdf_with(p, part);\n}\n\n"
           "uint masu_sdf_nearest(vec3 p)\n{\n    uint part;\n    masu_sdf_with(p, part);\n"
           "    return part;\n}\n\n");
    put_flat(w);
    put_surfaces(w);
    PUT(w, "#ifdef MASU_SDF_SETUP\n");
    sdfc_put_update_library(w);
    if (c->place_count) put_places(w);
    PUT(w, "void masu_sdf_update()\n{\n");
    sdfc_put_update(w);
    PUT(w, "}\n#endif\n#undef real\n#undef TO_INT\n");
}

/* check_sdf.c: validates the SDF: its numbers, its parameters and evaluated constants, and that its
 * SPIR-V is present (check_code.c validates the SPIR-V). */
#include "scene/check.h"

#include "shared/masu_shared.h"

masu_result masu_check_sdf(reader *r) {
    const masu_scene_view *v = &r->view;
    if (!v->sdf) {
        int more = v->sdf_params || v->slots;
        for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) more |= v->code[k].words != NULL;
        return more ? bad(r, "sdf", 0, "is missing, but parts of it are there") : MASU_OK;
    }
    const masu_blob_sdf *s = v->sdf;
    for (uint32_t k = 0; k < 3; k++) {
        if (!(s->bounds_min[k] <= s->bounds_max[k]) || !(s->bounds_min[k] >= -1e30f) ||
            !(s->bounds_max[k] <= 1e30f)) {
            return bad(r, "sdf", 0, "bounds are inverted or out of range");
        }
    }
    if (!within(&s->lipschitz, 1, 1e-3f, 1e6f))
        return bad(r, "sdf", 0, "Lipschitz constant is out of range");
    if (!within(&s->max_distance, 1, 1e-6f, 1e30f))
        return bad(r, "sdf", 0, "longest ray is out of range");
    if (s->has_raster != (r->counts[MASU_BLOB_INSTANCES] ? 1u : 0u)) {
        return bad(r, "sdf", 0, "code was compiled for other instances");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_SDF_PARAMS]; i++) {
        const masu_blob_sdf_param *p = &v->sdf_params[i];
        if (!finite_all(&p->value, 1) || !finite_all(&p->minimum, 1) ||
            !finite_all(&p->maximum, 1) || !(p->minimum <= p->value && p->value <= p->maximum)) {
            return bad(r, "sdf parameters", i, "value is outside its range");
        }
        if (!name_ok(r, p->name)) return bad(r, "sdf parameters", i, "name lies outside the names");
    }
    if (s->part_count < 1 || s->part_count > MASU_SDF_PARTS_MAX) {
        return bad(r, "sdf", 0, "part count is not 1 to 4096");
    }
    if (s->flags & ~(MASU_SDF_ANCHORED | MASU_SDF_TIMELESS))
        return bad(r, "sdf", 0, "flags has an unknown bit");
    if (s->block_words > MASU_BLOCK_WORDS_MAX)
        return bad(r, "sdf", 0, "words of a block are not 0 to 2");
    if (!v->slots) return bad(r, "slots", 0, "are missing");
    for (uint64_t i = 0; i < v->slot_count; i++) {
        if (!finite_all(&v->slots[i], 1)) return bad(r, "slots", i, "is not finite");
    }
    /* Form, first argument and material are integers stored as floats. The shaders clamp them; this
     * range keeps the conversion to an integer defined. */
    for (uint64_t i = 0;
         i < s->part_count && v->slot_count >= (uint64_t)s->part_count * MASU_BLOB_PART_SLOTS;
         i++) {
        uint64_t form = i * MASU_BLOB_PART_SLOTS + 5;
        if (!within(&v->slots[form], 3, 0.0f, 65536.0f))
            return bad(r, "slots", form, "is no number of a form, a slot and a material");
    }
    for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
        int needed = k == MASU_BLOB_MARCH_SPIRV || k == MASU_BLOB_CLASSIFY_SPIRV ||
                     k == MASU_BLOB_CONE8_SPIRV || k == MASU_BLOB_CONE4_SPIRV ||
                     k == MASU_BLOB_SILHOUETTES_SPIRV;
        /* The constants of an anchored SDF depend at least on the floating origin. */
        if (k == MASU_BLOB_UPDATE_SPIRV) {
            needed = s->flags & MASU_SDF_ANCHORED || v->code[MASU_BLOB_UPDATE_PREVIOUS_SPIRV].words;
        } else if (k == MASU_BLOB_UPDATE_PREVIOUS_SPIRV) {
            needed = !(s->flags & MASU_SDF_ANCHORED) && v->code[MASU_BLOB_UPDATE_SPIRV].words;
        }
        if (!v->code[k].words && !needed) continue;
        if (!v->code[k].words || v->code[k].count < 5 || v->code[k].words[0] != 0x07230203u) {
            return bad(r, masu_section_name(k), 0, "is missing or is no SPIR-V");
        }
    }
    return MASU_OK;
}

void masu_describe_sdf(const reader *r, masu_scene_data *out) {
    out->sdf_parts = r->view.sdf->part_count;
    out->sdf_block_words = r->view.sdf->block_words;
    out->sdf_slots = (uint32_t)r->counts[MASU_BLOB_SLOTS];
    out->sdf_dynamic = r->view.code[MASU_BLOB_UPDATE_PREVIOUS_SPIRV].words != NULL;
    out->sdf_timed = !(r->view.sdf->flags & MASU_SDF_TIMELESS);
    out->sdf_static = r->view.code[MASU_BLOB_VELOCITY_SPIRV].words == NULL;
    out->sdf_anchored = (r->view.sdf->flags & MASU_SDF_ANCHORED) != 0;
    out->sdf_occlusion = r->view.code[MASU_BLOB_OCCLUSION_SPIRV].words != NULL;
    out->sdf_casts = r->view.code[MASU_BLOB_LOCAL_SHADOW_SPIRV].words != NULL;
#ifdef MASU_LAB
    static const struct {
        uint32_t kind;
        masu_march march;
    } variants[] = {{MASU_BLOB_PLAIN_SPIRV, MASU_MARCH_PLAIN},
                    {MASU_BLOB_SEED_SPIRV, MASU_MARCH_SEED},
                    {MASU_BLOB_CHECKERBOARD_SPIRV, MASU_MARCH_CHECKERBOARD}};
    out->sdf_march = 1u << MASU_MARCH_AUTO;
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        if (r->view.code[variants[i].kind].words) out->sdf_march |= 1u << variants[i].march;
    }
#endif
}

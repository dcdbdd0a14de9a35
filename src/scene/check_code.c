/* check_code.c: validates the SPIR-V of a scene with an SDF. Each module must be well-formed
 * (code.h), use only the resources that its pass binds, and be compiled for the counts of the blob.
 * The table below repeats the resources of src/plan/passes.inc; tests/unit/test_code.c compares the
 * two. */
#include "scene/check.h"
#include "scene/code.h"

#include "shared/masu_shared.h"

#include <string.h>

#define COMPUTE 5u /* execution model GLCompute */

#define AT(name) ((uint64_t)1 << MASU_BIND_##name)
#define FIELD (AT(FRAME) | AT(COUNTERS) | AT(SLOTS) | AT(TILES))

#define PUSH(name) (uint8_t)(sizeof(struct masu_push) + sizeof(struct masu_push_##name))

/* columns, rows: workgroup size; the update passes may have 64x1 instead. reads: combined image
 * samplers of set 1, from binding 0 on; raster_reads: the same in scenes with polygons. writes:
 * storage images, in the bindings that follow. */
static const struct {
    uint8_t kind, columns, rows, reads, raster_reads, writes, push;
    uint64_t global; /* bindings of set 0 */
} rules[] = {
    {MASU_BLOB_MARCH_SPIRV, 8, 8, 1, 1, 4, PUSH(march), FIELD},
    {MASU_BLOB_CLASSIFY_SPIRV, 8, 8, 0, 1, 1, sizeof(struct masu_push), FIELD},
    {MASU_BLOB_CONE8_SPIRV, 8, 8, 0, 0, 1, PUSH(cone), FIELD},
    {MASU_BLOB_CONE4_SPIRV, 8, 8, 1, 1, 1, PUSH(cone), FIELD},
    {MASU_BLOB_UPDATE_SPIRV, 1, 1, 0, 0, 0, sizeof(struct masu_push), FIELD},
    {MASU_BLOB_UPDATE_PREVIOUS_SPIRV, 1, 1, 0, 0, 0, sizeof(struct masu_push),
     FIELD | AT(PREVIOUS)},
#ifdef MASU_LAB
    {MASU_BLOB_PLAIN_SPIRV, 8, 8, 0, 1, 4, PUSH(march_plain), FIELD},
    {MASU_BLOB_SEED_SPIRV, 4, 8, 0, 1, 4, PUSH(march_seed), FIELD},
    {MASU_BLOB_CHECKERBOARD_SPIRV, 8, 8, 1, 1, 4, PUSH(march_checkerboard), FIELD},
#endif
    {MASU_BLOB_VELOCITY_SPIRV, 8, 8, 1, 2, 1, PUSH(sdf_velocity), FIELD | AT(PREVIOUS)},
    {MASU_BLOB_SILHOUETTES_SPIRV, 8, 8, 4, 5, 1, PUSH(silhouettes),
     FIELD | AT(EXPOSURE) | AT(TABLES) | AT(SKY)},
    {MASU_BLOB_OCCLUSION_SPIRV, 8, 8, 2, 2, 1, PUSH(sdf_occlusion), FIELD},
    {MASU_BLOB_TRACE_SDF_SPIRV, 8, 8, 2, 2, 1, PUSH(specular_trace_sdf),
     FIELD | AT(SPECULAR_TILES) | AT(PREVIOUS)},
    {MASU_BLOB_BOUNCE_SDF_SPIRV, 8, 8, 0, 0, 0, PUSH(bounce_sdf),
     FIELD | AT(PROBES) | AT(BOUNCE) | AT(BOUNCE_RAYS)},
    {MASU_BLOB_LOCAL_SHADOW_SPIRV, 8, 8, 0, 0, 1, sizeof(struct masu_push),
     FIELD | AT(LOCAL_FACES)},
};
_Static_assert(MASU_BIND_COUNT <= 64, "a bit for each binding of set 0");

/* The resource class that the pass binds at (set, binding). */
static masu_module_class bound_at(uint32_t rule, uint32_t raster, uint32_t set, uint32_t binding) {
    if (set == MASU_SET_GLOBAL) {
        if (binding >= MASU_BIND_COUNT || !(rules[rule].global >> binding & 1u))
            return MASU_MODULE_NOTHING;
        const uint64_t uniforms = AT(FRAME) | AT(PREVIOUS) | AT(SKY) | AT(LOCAL_FACES);
        return uniforms >> binding & 1u ? MASU_MODULE_UNIFORMS : MASU_MODULE_STORAGE;
    }
    uint32_t reads = raster ? rules[rule].raster_reads : rules[rule].reads;
    if (set != MASU_SET_PASS) return MASU_MODULE_NOTHING;
    if (binding < reads) return MASU_MODULE_SAMPLED;
    return binding < reads + rules[rule].writes ? MASU_MODULE_IMAGE : MASU_MODULE_NOTHING;
}

static const char *check_interface(const masu_module *code, uint32_t rule, uint32_t raster) {
    if (code->model != COMPUTE) return "is for another stage than its pass";
    const uint32_t *size = code->local_size;
    int update = rules[rule].columns == 1 && size[0] == 64;
    if (!update && (size[0] != rules[rule].columns || size[1] != rules[rule].rows))
        return "has another local size than its pass";
    if (size[2] != 1 || (update && size[1] != 1)) return "has another local size than its pass";
    if (code->push_bytes > rules[rule].push) return "has more push constants than its pass";
    for (uint32_t k = 0; k < code->bound_count; k++) {
        const masu_module_bound *b = &code->bound[k];
        if (bound_at(rule, raster, b->set, b->binding) != (masu_module_class)b->class)
            return "asks for a resource that its pass does not bind";
    }
    return NULL;
}

static int readable(const char *text) {
    for (uint32_t k = 0; k + 1 < MASU_MODULE_RECORD_BYTES; k++) {
        if (text[k] < ' ' || text[k] > '~') return 0;
    }
    return 1;
}

static masu_result check_record(reader *r, uint32_t kind, const masu_module *code) {
    const masu_blob_sdf *s = r->view.sdf;
    const masu_module_counts counts = {
        .kind = kind,
        .parts = s->part_count,
        .slots = (uint32_t)r->view.slot_count,
        .block_words = s->block_words,
        .raster = s->has_raster,
        .anchored = s->flags & MASU_SDF_ANCHORED,
        .moves = r->view.code[MASU_BLOB_UPDATE_PREVIOUS_SPIRV].words != NULL};
    char wanted[MASU_MODULE_RECORD_BYTES], found[MASU_MODULE_RECORD_BYTES];
    masu_module_record(&counts, wanted);
    if (code->record_words != MASU_MODULE_RECORD_WORDS)
        return bad(r, masu_section_name(kind), 0, "does not say what it was compiled for");
    memcpy(found, code->record + 1, sizeof found);
    if (!memcmp(found, wanted, sizeof found)) return MASU_OK;
    found[sizeof found - 1] = '\0';
    return masu_fail(r->detail, MASU_ERROR_SCENE, masu_section_name(kind), 0, 0,
                     "scene blob: %s: made for '%s', the blob has '%s'", masu_section_name(kind),
                     readable(found) ? found + 5 : "?", wanted + 5);
}

masu_result masu_check_code(reader *r) {
    for (uint32_t rule = 0; rule < sizeof rules / sizeof *rules && r->view.sdf; rule++) {
        uint32_t kind = rules[rule].kind;
        if (!r->view.code[kind].words) continue;
        masu_module code;
        uint64_t at = 0;
        const char *problem =
            masu_module_read(r->view.code[kind].words, r->view.code[kind].count, &code, &at);
        if (!problem) problem = check_interface(&code, rule, r->view.sdf->has_raster);
        if (problem) return bad(r, masu_section_name(kind), at, problem);
        masu_result result = check_record(r, kind, &code);
        if (result) return result;
    }
    return MASU_OK;
}

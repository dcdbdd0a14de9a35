/* api_stats.c: see api_stats.h. */
#include "api_stats.h"

#include "plan/buffer_plan.h"
#include "plan/desc.h"

#include "device/bind.h"
#include "plan/desc.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

/* ---- Times ----------------------------------------------------------------------------------- */

static uint64_t *stamps_of(const masu_renderer *m, uint32_t slot) {
    unsigned char *from = masu_buffer_pointer(&m->device, MASU_BUFFER_READBACK, slot);
    return (uint64_t *)(void *)(from + m->plan.readback_times);
}

/* A value that no timestamp has: narrower counters are below it. The GPU overwrites it at the end
 * of the frame. */
#define NO_STAMP UINT64_MAX

void masu_slot_begin(masu_renderer *m, uint32_t slot) {
    if (m->device.queries) stamps_of(m, slot)[masu_stamps(&m->plan.desc) - 1] = NO_STAMP;
}

/* Whether the slot's frame has ended, as far as this is possible without calling the driver. */
static int has_ended(const masu_renderer *m, uint32_t slot) {
    return !m->device.queries ||
           stamps_of(m, slot)[masu_stamps(&m->plan.desc) - 1] != NO_STAMP;
}

static uint64_t stamp_ns(const masu_renderer *m, uint32_t slot, uint32_t from, uint32_t to) {
    const uint64_t *stamps = stamps_of(m, slot);
    uint32_t bits = m->device.vk.queue_family.timestampValidBits;
    uint64_t mask = bits >= 64 ? UINT64_MAX : ((uint64_t)1 << bits) - 1;
    /* The counter may wrap between two timestamps; the masked difference is correct
     * nevertheless. */
    return (uint64_t)((double)((stamps[to] - stamps[from]) & mask) *
                      (double)m->device.vk.properties.limits.timestampPeriod);
}

/* Whether the cost of a pass does not depend on the render size. */
static int is_fixed_pass(uint32_t pass) {
    switch (masu_passes[pass].extent) {
    case MASU_EXTENT_OUTPUT:
    case MASU_EXTENT_OUTPUT_PAIRS:
    case MASU_EXTENT_OUTPUT_ODD:
    case MASU_EXTENT_ONE:
    case MASU_EXTENT_ATLAS:
    case MASU_EXTENT_KEPT:
    case MASU_EXTENT_BATCHES:
    case MASU_EXTENT_PROBES:
    case MASU_EXTENT_RAYS:
    case MASU_EXTENT_TRACED_PROBES:
    case MASU_EXTENT_PICK:
    case MASU_EXTENT_SHADOW:
    case MASU_EXTENT_LOCAL_FACES:
    case MASU_EXTENT_LOCAL_ATLAS: return 1;
    default: return pass == MASU_PASS_PRESENT;
    }
}

int masu_slot_sample(const masu_renderer *m, uint32_t slot, masu_governor_sample *out) {
    uint32_t stamps = masu_stamps(&m->plan.desc);
    const masu_slot *held = &m->timeline.slots[slot];
    *out = (masu_governor_sample){.frame = held->frame,
                                  .rung = held->rung,
                                  .wall_ms = held->wall_ms,
                                  .cpu_ms = held->cpu_ms,
                                  .exclude_from_timing = held->exclude_from_timing};
    /* No frame, never submitted, or not of the first viewport, whose times the governor uses. */
    if (held->frame == UINT64_MAX || held->viewport || !has_ended(m, slot)) return 0;
    if (stamps) out->gpu_ms = (double)stamp_ns(m, slot, 0, stamps - 1) * 1e-6;
    for (uint32_t p = 0; p + 2 <= stamps && stamps > 2; p++) {
        if (is_fixed_pass(p) && masu_has_pass(&m->plan.rungs[held->rung].active, p))
            out->fixed_ms += (double)stamp_ns(m, slot, p, p + 1) * 1e-6;
    }
    return 1;
}

/* ---- Statistics ------------------------------------------------------------------------------ */

static uint64_t counter(const masu_renderer *m, uint32_t slot, uint32_t index) {
    const uint32_t *c =
        (const uint32_t *)(const void *)masu_buffer_pointer(&m->device, MASU_BUFFER_READBACK, slot);
    return c[2 * index] | (uint64_t)c[2 * index + 1] << 32;
}

static void read_times(const masu_renderer *m, uint32_t slot, masu_stats_info *out) {
    uint32_t stamps = masu_stamps(&m->plan.desc);
    for (uint32_t p = 0; p + 1 < stamps && stamps > 2; p++) {
        if (masu_has_pass(&m->plan.rungs[out->rung].active, p))
            out->pass_ns[p] = stamp_ns(m, slot, p, p + 1);
    }
    out->gpu_ns = stamp_ns(m, slot, 0, stamps - 1);
    out->timed = 1;
}

static void read_stage2(const masu_renderer *m, uint32_t slot, masu_stats_info *out) {
    out->occlusion_tests = counter(m, slot, MASU_COUNTER_OCCLUSION_TESTS);
    for (uint32_t v = 0; v < out->view_count; v++) {
        uint32_t c = MASU_COUNTER_VISIBLE + 2 * v;
        out->views[v].visible_instances = counter(m, slot, c);
        out->views[v].visible_triangles = counter(m, slot, c + 1);
    }
    out->triangles = out->views[0].visible_triangles;
}

static void read_counters(const masu_renderer *m, uint32_t slot, masu_stats_info *out) {
    if (m->plan.needs.smoothing) out->smaa_tiles = counter(m, slot, MASU_COUNTER_SMAA_TILES);
    if (!m->plan.needs.scene) return;
    out->sdf_evals = counter(m, slot, MASU_COUNTER_SDF_EVALS);
    out->sdf_hits = counter(m, slot, MASU_COUNTER_SDF_HITS);
    out->sdf_unconverged = counter(m, slot, MASU_COUNTER_SDF_UNCONVERGED);
    out->replaced = counter(m, slot, MASU_COUNTER_REPLACED);
    out->shadow_evals = counter(m, slot, MASU_COUNTER_SHADOW_EVALS);
    out->occlusion_evals = counter(m, slot, MASU_COUNTER_OCCLUSION_EVALS);
    out->shadow_unconverged = counter(m, slot, MASU_COUNTER_SHADOW_UNCONVERGED);
    out->light_tests = counter(m, slot, MASU_COUNTER_LIGHT_TESTS);
    out->light_shaded = counter(m, slot, MASU_COUNTER_LIGHT_SHADED);
    out->light_tiles_full = counter(m, slot, MASU_COUNTER_LIGHT_TILES_FULL);
    out->specular_tiles = counter(m, slot, MASU_COUNTER_SPECULAR_TILES);
    out->specular_rays = counter(m, slot, MASU_COUNTER_SPECULAR_RAYS);
    out->specular_hits = counter(m, slot, MASU_COUNTER_SPECULAR_HITS);
    out->specular_sdf_hits = counter(m, slot, MASU_COUNTER_SPECULAR_SDF_HITS);
    out->specular_nodes = counter(m, slot, MASU_COUNTER_SPECULAR_NODES);
    out->specular_evals = counter(m, slot, MASU_COUNTER_SPECULAR_EVALS);
    out->easu_tiles_early = counter(m, slot, MASU_COUNTER_EASU_TILES_EARLY);
    uint32_t exposure = (uint32_t)counter(m, slot, MASU_COUNTER_EXPOSURE);
    memcpy(&out->exposure, &exposure, sizeof exposure);
    if (masu_has_pass(&m->plan.rungs[out->rung].active, MASU_PASS_CULL)) read_stage2(m, slot, out);
}

/* Requirements that masu_stats, masu_readback and masu_pick share. */
static masu_result check_slot(const masu_renderer *m, uint32_t slot, const void *out,
                              masu_detail *detail) {
    masu_detail own;
    if (!m || !out) return masu_finish_null_const(m, "out", detail);
    uint32_t slots = m->plan.desc.frames_in_flight;
    if (slot < slots) return MASU_OK;
    masu_fail(&own, MASU_ERROR_ARGUMENT, "slot", slots - 1, slot,
              "slot %u does not exist, the last one is %u", slot, slots - 1);
    return masu_finish_desc(&m->plan.desc, own.result, &own, detail);
}

masu_result masu_stats(const masu_renderer *m, uint32_t slot, masu_stats_info *out,
                       masu_detail *detail) {
    masu_result result = check_slot(m, slot, out, detail);
    if (result) return result;
    memset(out, 0, sizeof *out);
    out->frame = m->timeline.slots[slot].frame;
    out->pass_count = MASU_PASS_COUNT;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) out->pass_names[p] = masu_passes[p].name;
    if (m->governor)
        masu_governor_report(m->governor, &out->governor);
    else
        out->governor.reason_text = masu_governor_reason_string(MASU_GOVERNOR_REASON_NONE);
    if (out->frame == UINT64_MAX) return MASU_INCOMPLETE;
    out->rung = m->timeline.slots[slot].rung;
    if (!has_ended(m, slot)) return MASU_INCOMPLETE;
    out->view_count = m->plan.needs.raster ? m->plan.views : 0;
    memcpy(out->views, m->visible.slot_views[slot], sizeof out->views);
    out->lights = 0;
    for (uint32_t i = 0; i < m->plan.scene.lights; i++)
        out->lights += masu_handle_lives(&m->lights.handles, i) != 0;
    out->lights_in_view = m->lights.slot_count[slot];
    out->local_shadow_lights = m->local_shadows.slots[slot].lights;
    out->local_shadow_faces = m->local_shadows.slots[slot].faces;
    out->local_shadow_waiting = m->local_shadows.slots[slot].waiting;
    int bounces = masu_has_pass(&m->plan.rungs[out->rung].active, MASU_PASS_BOUNCE_SUM);
    out->bounce_rounds_left = bounces ? m->bounce.slot_left[slot] : 0;
    out->draws = out->views[0].draws;
    out->triangles = out->views[0].triangles;
    out->transparents = m->transparents.slot_count[slot];
    out->particles = m->sprites.slots[slot].particles;
    out->decals = m->sprites.slots[slot].decals;
    out->lines = m->sprites.slots[slot].lines;
    out->trail_segments = m->sprites.slots[slot].segments;
    if (m->plan.desc.debug.counters) read_counters(m, slot, out);
    if (m->device.queries) read_times(m, slot, out);
    return MASU_OK;
}

void masu_peaks(const masu_renderer *m, masu_peak_info *out) {
    if (!out) return;
    *out = (masu_peak_info){0};
    if (!m) return;
    const masu_limits held = masu_limits_needed(&m->plan.desc);
#define PEAK(name, ...) .name = held.name,
    *out = (masu_peak_info){MASU_LIMITS(PEAK).host_bytes = m->arena.used};
#undef PEAK
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++)
        out->device_bytes += m->plan.blocks[role].bytes;
}

/* ---- Images ---------------------------------------------------------------------------------- */

masu_result masu_readback(const masu_renderer *m, uint32_t slot, masu_readback_bits which,
                          masu_readback_image *out, masu_detail *detail) {
    masu_detail own;
    masu_result result = check_slot(m, slot, out, detail);
    if (result) return result;
    uint32_t bit = 0;
    while (bit < MASU_READBACK_IMAGES && which != 1u << bit) bit++;
    if (bit == MASU_READBACK_IMAGES || !(m->plan.desc.readback & 1u << bit)) {
        masu_fail(&own, MASU_ERROR_ARGUMENT, "which", m->plan.desc.readback, (unsigned)which,
                  "which is %u: one bit of desc.readback, which is %u in this plan",
                  (unsigned)which, m->plan.desc.readback);
        return masu_finish_desc(&m->plan.desc, own.result, &own, detail);
    }
    if (m->timeline.slots[slot].frame == UINT64_MAX || !has_ended(m, slot)) return MASU_INCOMPLETE;
    uint32_t id = 1;
    while (masu_images[id].readback != (uint32_t)which) id++;
    VkFormat format = masu_images[id].format;
    if (format == VK_FORMAT_D32_SFLOAT)
        format = VK_FORMAT_R32_SFLOAT; /* the format in the readback buffer */
    VkExtent2D size = masu_plan_extent(&m->plan, masu_images[id].extent,
                                       m->timeline.slots[slot].render);
    *out = (masu_readback_image){
        masu_buffer_pointer(&m->device, MASU_BUFFER_READBACK, slot) + m->plan.readback_offset[bit],
        size.width, size.height, (uint64_t)size.width * masu_format_bytes(format), format};
    return MASU_OK;
}

/* The node of a model that has an instance. */
static uint32_t node_of(const masu_models *s, uint32_t model, uint32_t instance) {
    const masu_placed_model *of = &s->models[model];
    for (uint32_t n = 0; n < of->node_count; n++) {
        if (s->nodes[of->first_node + n].instance == instance) return n;
    }
    return MASU_NODE_NONE;
}

masu_result masu_pick(const masu_renderer *m, uint32_t slot, masu_pick_info *out,
                      masu_detail *detail) {
    masu_detail own;
    masu_result result = check_slot(m, slot, out, detail);
    if (result) return result;
    if (!m->plan.needs.picking) {
        masu_fail(&own, MASU_ERROR_ARGUMENT, "picking", 1, 0, "masu_pick requires desc.picking");
        return masu_finish_desc(&m->plan.desc, own.result, &own, detail);
    }
    *out = (masu_pick_info){.frame = m->timeline.slots[slot].frame, .node = MASU_NODE_NONE};
    if (out->frame == UINT64_MAX || !has_ended(m, slot)) return MASU_INCOMPLETE;
    const masu_picking_slot *asked = &m->picking.slots[slot];
    if (!asked->asked) return MASU_OK;
    uint32_t words[MASU_PICKED_WORDS];
    float told[4]; /* view depth */
    memcpy(words, masu_buffer_pointer(&m->device, MASU_BUFFER_PICKED, slot), sizeof words);
    memcpy(told, words + 2, sizeof told);
    out->kind = words[0] == MASU_PICKED_INSTANCE ? MASU_PICK_INSTANCE
                : words[0] == MASU_PICKED_SDF    ? MASU_PICK_SDF
                                                 : MASU_PICK_SKY;
    out->x = asked->x;
    out->y = asked->y;
    if (out->kind == MASU_PICK_SKY) return MASU_OK;
    out->depth = told[0];
    for (uint32_t k = 0; k < 3; k++) out->position[k] = asked->eye[k] + (double)told[1 + k];
    uint32_t i = words[1];
    if (out->kind != MASU_PICK_INSTANCE || i >= m->plan.scene.instances) return MASU_OK;
    uint32_t model = m->plan.scene.models ? m->models.of_instance[i] : MASU_BLOB_NONE;
    uint32_t scene_models = masu_own_models(&m->plan);
    /* The copy in the slot at that frame has been removed: the present copy was added later. */
    if (model != MASU_BLOB_NONE && model >= scene_models &&
        out->frame < m->picking.added[model - scene_models])
        return MASU_OK;
    out->instance = masu_instance_at(m, i);
    if (model == MASU_BLOB_NONE) return MASU_OK;
    out->model = masu_model_at(m, model);
    out->node = node_of(&m->models, model, i);
    return MASU_OK;
}

/* Octahedral decoding (Cigolle et al., JCGT 3-2, 2014, section 3.2), 13 bits per axis; the twin of
 * shaders/shared/pack.glsl. */
void masu_unpack_normal(uint32_t texel, float out[3]) {
    if (!out) return;
    float x = (float)(texel & 0x1FFFu) / 4095.0f - 1.0f;
    float y = (float)(texel >> 13 & 0x1FFFu) / 4095.0f - 1.0f;
    x = x > 1.0f ? 1.0f : x;
    y = y > 1.0f ? 1.0f : y;
    float z = 1.0f - fabsf(x) - fabsf(y);
    if (z < 0.0f) {
        float t = x;
        x = (1.0f - fabsf(y)) * (x < 0.0f ? -1.0f : 1.0f);
        y = (1.0f - fabsf(t)) * (y < 0.0f ? -1.0f : 1.0f);
    }
    float length = sqrtf(x * x + y * y + z * z); /* at least 1/sqrt(3) on an octahedron */
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
}

/* ---- Memory ---------------------------------------------------------------------------------- */

static masu_memory_row device_row(const masu_frame_plan *plan, const char *kind, const char *name,
                                  masu_role role, uint64_t count, uint64_t bytes,
                                  uint64_t alignment, uint64_t offset) {
    return (masu_memory_row){.name = name,
                             .kind = kind,
                             .role = plan->unified ? MASU_ROLE_DEVICE : role,
                             .count = count,
                             .bytes = bytes,
                             .alignment = alignment,
                             .offset = offset};
}

static const char *texture_name(VkFormat format) {
    switch (format) {
    case VK_FORMAT_BC1_RGB_SRGB_BLOCK: return "textures BC1";
    case VK_FORMAT_BC3_SRGB_BLOCK: return "textures BC3";
    case VK_FORMAT_BC4_UNORM_BLOCK: return "textures BC4";
    case VK_FORMAT_BC5_UNORM_BLOCK: return "textures BC5";
    case VK_FORMAT_R8_UNORM: return "textures R8";
    case VK_FORMAT_R8G8_UNORM: return "textures RG8";
    default: return "textures RGBA8";
    }
}

/* Rows of a report. Rows beyond the capacity are only counted. */
typedef struct report {
    masu_memory_row *rows;
    uint32_t capacity, count;
} report;

static void add_row(report *to, masu_memory_row row) {
    if (to->count < to->capacity) to->rows[to->count] = row;
    to->count++;
}

static void report_host(const masu_arena *arena, report *to) {
    for (uint32_t i = 0; i < arena->row_count; i++) {
        const masu_arena_row *a = &arena->rows[i];
        add_row(to, (masu_memory_row){.name = a->name,
                                      .kind = "host",
                                      .count = a->count,
                                      .bytes = a->count * a->element_bytes,
                                      .alignment = a->alignment,
                                      .offset = a->offset});
    }
}

static void report_buffers(const masu_frame_plan *plan, report *to) {
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        const masu_buffer_plan *p = &plan->buffers[b];
        if (!p->bytes || b == MASU_BUFFER_POISON) continue;
        masu_memory_row row = device_row(plan, "buffer", p->name, p->role, p->count,
                                         p->memory_bytes, p->alignment, p->offset);
        row.transient = (uint32_t)masu_buffers[b].of_loading;
        add_row(to, row);
    }
}

static void report_images(const masu_frame_plan *plan, report *to) {
    for (uint32_t i = 0; i < plan->scene.texture_arrays; i++) {
        const masu_texture_plan *t = &plan->textures[i];
        add_row(to, device_row(plan, "texture", texture_name(t->format), MASU_ROLE_DEVICE,
                               t->layers, t->bytes, t->alignment, t->offset));
    }
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        const masu_image_plan *p = &plan->images[i];
        if (!p->used) continue;
        masu_memory_row row =
            device_row(plan, "image", masu_images[i].name, MASU_ROLE_DEVICE,
                       (uint64_t)p->width * p->height, p->bytes, p->alignment, p->offset);
        row.transient = !p->persistent;
        row.first_pass = p->first;
        row.last_pass = p->last;
        add_row(to, row);
    }
}

uint32_t masu_memory_report(const masu_renderer *m, masu_memory_row *rows, uint32_t capacity) {
    report out = {rows, rows ? capacity : 0, 0};
    if (!m) return 0;
    report_host(&m->arena, &out);
    report_buffers(&m->plan, &out);
    report_images(&m->plan, &out);
    return out.count;
}

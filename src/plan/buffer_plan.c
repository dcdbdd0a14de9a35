/* buffer_plan.c: see buffer_plan.h. */
#include "plan/buffer_plan.h"

#include "plan/draws.h"
#include "scene/punctual_light.h"
#include "scene/trace_scene.h"

#include <string.h>

/* ---- The rows of buffers.inc ----------------------------------------------------------------- */

enum { LIFETIME_ALWAYS = 0, LIFETIME_LOADING = 1 };
typedef enum slot_kind { SLOTS_ONCE, SLOTS_FLIGHT, SLOTS_PREVIOUS } slot_kind;

#define NOTHING 0
#define LOADED(load) 1
const masu_buffer_row masu_buffers[MASU_BUFFER_COUNT] = {
#define BUFFER(ID, name, role, usage, slots, lifetime, loaded, ...)                                \
    [MASU_BUFFER_##ID] = {name, MASU_ROLE_##role, loaded, LIFETIME_##lifetime,                     \
                          SLOTS_##slots == SLOTS_PREVIOUS},
#include "plan/buffers.inc"
#undef BUFFER
};

/* ---- Sizes ----------------------------------------------------------------------------------- */

/* With velocities, each slot has a half for this frame and a half for the previous frame. */
static uint64_t masu_halves(const masu_frame_plan *plan) { return plan->needs.velocity ? 2 : 1; }

/* Transforms, then looks. Multiples of 8 are aligned for every device, so that looks begin in the
 * middle of the binding. */
static uint64_t masu_instance_bytes(const masu_frame_plan *plan) {
    uint64_t count = plan->scene.instances;
    if (plan->desc.instance_looks) count = 2 * masu_look_capacity(plan->scene.instances);
    return count * sizeof(struct masu_instance_data);
}

static uint64_t masu_counter_words(const masu_frame_plan *plan) {
    return plan->needs.scene || plan->needs.smoothing ? 2 * MASU_COUNTER_COUNT : 0;
}

static uint64_t masu_slot_count(const masu_frame_plan *plan) {
    if (!plan->needs.sdf) return 0;
    return (plan->needs.velocity && plan->needs.dynamic ? 2 : 1) * (uint64_t)plan->scene.sdf_slots;
}

static uint64_t masu_table_words(const masu_frame_plan *plan) {
    const masu_scene_data *s = &plan->scene;
    if (!plan->needs.scene) return 0;
    uint64_t words = plan->needs.raster && s->coats ? MASU_TABLE_WORDS_COAT : MASU_TABLE_WORDS;
    return (plan->needs.area_lights ? MASU_TABLE_WORDS_ALL : words) +
           masu_blob_environment_texels(s->environment_size, s->environment_mips);
}

static uint64_t masu_probe_bytes(const masu_frame_plan *plan) {
    const masu_scene_data *s = &plan->scene;
    if (!plan->needs.probes) return 0;
    uint64_t words = MASU_PROBE_LIT_WORDS + (plan->needs.bounce ? MASU_PROBE_LIVE_WORDS : 0);
    return sizeof(masu_blob_probes) +
           (masu_align_up(s->probe_words, 4) + s->probes * words) * sizeof(uint32_t);
}

static int masu_traces(const masu_needs *n) { return n->reflections || n->bounce; }

uint32_t masu_bounce_most(const masu_frame_plan *plan, uint32_t rung) {
    return plan->desc.rungs[rung].bounce_probes * MASU_BOUNCE_BURST;
}

/* Largest number of live probes per frame over all rungs. */
static uint64_t masu_bounce_probes(const masu_frame_plan *plan) {
    uint64_t most = 0;
    for (uint32_t r = 0; r < plan->desc.rung_count && plan->needs.bounce; r++) {
        uint64_t probes = masu_bounce_most(plan, r);
        if (most < probes) most = probes;
    }
    return most < plan->scene.probes ? most : plan->scene.probes;
}

static uint64_t masu_bounce_bytes(const masu_frame_plan *plan) {
    uint64_t probes = masu_bounce_probes(plan);
    return probes ? sizeof(struct masu_bounce_header) + probes * sizeof(uint32_t) : 0;
}

static uint64_t masu_bounce_rays(const masu_frame_plan *plan) {
    uint64_t most = 0, probes;
    for (uint32_t r = 0; r < plan->desc.rung_count && plan->needs.bounce; r++) {
        probes = masu_bounce_most(plan, r);
        if (probes > plan->scene.probes) probes = plan->scene.probes;
        probes *= plan->desc.rungs[r].bounce_rays;
        if (most < probes) most = probes;
    }
    return most;
}

/* Maximum of words(plan, rung, grid) over all rungs; grid: number of blocks of the extent. */
static uint64_t max_words(const masu_frame_plan *plan, masu_image_extent extent,
                          uint64_t (*words)(const masu_frame_plan *plan, uint32_t rung,
                                            VkExtent2D grid)) {
    uint64_t most = 0;
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        VkExtent2D render = {plan->rungs[r].render_width, plan->rungs[r].render_height};
        uint64_t needed = words(plan, r, masu_plan_extent(plan, extent, render));
        if (most < needed) most = needed;
    }
    return most;
}

static uint64_t tile_words(const masu_frame_plan *plan, uint32_t rung, VkExtent2D grid) {
    const masu_scene_data *s = &plan->scene;
    uint64_t list = s->sdf_parts <= MASU_TILE_MASKED_MAX ? (s->sdf_parts + 31) / 32
                                                         : 1 + MASU_TILE_PARTS_MAX;
    (void)rung;
    return MASU_TILES_HEADER + (uint64_t)grid.width * grid.height * (1 + list);
}

static uint64_t block_words(const masu_frame_plan *plan, uint32_t rung, VkExtent2D grid) {
    (void)rung;
    uint32_t words = plan->scene.sdf_block_words;
    return words ? (uint64_t)grid.width * grid.height * (1 + MASU_BLOCK_SPANS * words) : 0;
}

/* The term masks of blocks follow the tile lists. The sum of both maxima holds both in every
 * rung. */
static uint64_t masu_tile_words(const masu_frame_plan *plan) {
    if (!plan->needs.sdf) return 0;
    return max_words(plan, MASU_EXTENT_TILE, tile_words) +
           max_words(plan, MASU_EXTENT_BLOCK4, block_words);
}

static uint64_t light_words(const masu_frame_plan *plan, uint32_t rung, VkExtent2D grid) {
    if (plan->desc.rungs[rung].light_tiles == MASU_OFF) return 0;
    return (uint64_t)grid.width * grid.height * MASU_LIGHT_LIST_WORDS(plan->scene.lights);
}

/* At least one value: the buffer is bound even if all rungs disable light tiles. */
static uint64_t masu_light_tile_words(const masu_frame_plan *plan) {
    if (!plan->needs.lights) return 0;
    uint64_t words = max_words(plan, MASU_EXTENT_TILE, light_words);
    return words ? words : 1;
}

static uint64_t specular_words(const masu_frame_plan *plan, uint32_t rung, VkExtent2D traced) {
    (void)plan, (void)rung;
    return MASU_TILES_HEADER + (uint64_t)((traced.width + MASU_GROUP - 1) / MASU_GROUP) *
                                   ((traced.height + MASU_GROUP - 1) / MASU_GROUP);
}

static uint64_t masu_specular_tile_words(const masu_frame_plan *plan) {
    return plan->needs.reflections ? max_words(plan, MASU_EXTENT_TRACED, specular_words) : 0;
}

static uint64_t smaa_words(const masu_frame_plan *plan, uint32_t rung, VkExtent2D grid) {
    if (!masu_is_smaa(plan->desc.rungs[rung].aa)) return 0;
    return MASU_TILES_HEADER + (uint64_t)grid.width * grid.height * (1 + MASU_SMAA_WORDS);
}

static uint64_t masu_smaa_tile_words(const masu_frame_plan *plan) {
    return plan->needs.smoothing ? max_words(plan, MASU_EXTENT_TILE, smaa_words) : 0;
}

static uint64_t tiles_of(const masu_frame_plan *plan, uint32_t rung, VkExtent2D grid) {
    int smooths = masu_is_smaa(plan->desc.rungs[rung].aa);
    return plan->needs.sdf || smooths ? (uint64_t)grid.width * grid.height : 0;
}

uint64_t masu_most_tiles(const masu_frame_plan *plan) {
    uint64_t tiles = max_words(plan, MASU_EXTENT_TILE, tiles_of),
             glossy = masu_specular_tile_words(plan);
    glossy -= glossy ? MASU_TILES_HEADER : 0;
    return tiles > glossy ? tiles : glossy;
}

static void layout_drawn(masu_frame_plan *plan) {
    const masu_scene_data *s = &plan->scene;
    masu_drawn_plan *d = &plan->drawn;
    uint64_t lists = (uint64_t)plan->views * plan->listed, next = lists;
    uint64_t forms = s->meshes + (plan->lods ? (uint64_t)s->lods : 0);
    if (plan->occlusion) {
        const struct {
            uint64_t *offset, words;
        } rows[] = {{&d->header, MASU_CULL_HEADER + plan->views * MASU_CULL_VIEW_WORDS},
                    {&d->lists, lists},
                    {&d->kept, (uint64_t)plan->views * (s->instances + (uint64_t)1)},
                    {&d->batches, 4 * forms},
                    {&d->large, forms},
                    {&d->boxes, 6 * (uint64_t)s->instances},
                    {&d->occluders, 6 * (uint64_t)s->occluders},
                    {&d->pairs, 2 * (uint64_t)MASU_ATLAS_PARTS(plan) * s->placed_occluders}};
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            *rows[i].offset = next;
            next += rows[i].words;
        }
    }
    d->transparents = next;
    d->picks = next + masu_transparent_words(plan) * (uint64_t)s->transparents;
    d->faces = d->picks + (plan->needs.picking ? plan->listed : 0);
    d->words = d->faces + (uint64_t)plan->local_faces * plan->listed;
}

/* All 0 if the host reserves no sprites. */
static void layout_sprites(masu_frame_plan *plan) {
    const masu_needs *n = &plan->needs;
    const masu_reserve *r = &plan->desc.reserve;
    masu_sprites_plan *s = &plan->sprites;
    if (!n->sprites) return;
    uint64_t draws = n->particles ? plan->scene.transparents + (uint64_t)1 : 0;
    s->particles = MASU_SPRITE_DRAWS + draws;
    s->particle = n->textures ? MASU_TEXTURED_PARTICLE_VEC4S : MASU_PARTICLE_VEC4S;
    s->decal = n->textures ? MASU_TEXTURED_DECAL_VEC4S : MASU_DECAL_VEC4S;
    s->lines = s->particles + s->particle * ((uint64_t)r->particles + r->trail_points);
    s->decals = s->lines + MASU_LINE_VEC4S * (uint64_t)r->lines;
    s->end = s->decals + s->decal * (uint64_t)r->decals;
}

static uint64_t masu_texel_words(const masu_frame_plan *plan) {
    if (!plan->needs.texture_writes) return 0;
    return MASU_TEXELS_FIRST + (uint64_t)plan->desc.reserve.texture_bytes / sizeof(uint32_t);
}

static uint64_t masu_sprite_count(const masu_frame_plan *plan) {
    const masu_reserve *r = &plan->desc.reserve;
    if (!plan->needs.sprites) return 0;
    return (uint64_t)r->particles + r->trail_points + r->lines + r->decals;
}

/* Number of draws after frustum culling; with occlusion culling also those of its second stage and
 * of the occluders. The draws of transparent surfaces follow. */
static uint64_t own_draws(const masu_frame_plan *plan) {
    uint64_t draws = (uint64_t)plan->views * plan->draws;
    return plan->occlusion ? 2 * draws + MASU_ATLAS_PARTS(plan) : draws;
}

static uint64_t masu_draw_count(const masu_frame_plan *plan) {
    const masu_scene_data *s = &plan->scene;
    if (!s->instances) return 0;
    return own_draws(plan) + (uint64_t)s->transparents * s->transparent_sets +
           (plan->needs.picking ? plan->draws : 0) + (uint64_t)plan->local_faces * plan->draws;
}

/* One 32-bit value per view and instance; the receiver masks follow. */
static uint64_t seen_instances(const masu_frame_plan *plan) {
    return plan->occlusion ? (uint64_t)plan->views * plan->scene.instances : 0;
}

static uint64_t masu_seen_words(const masu_frame_plan *plan) {
    if (!plan->scene.instances) return 0;
    return seen_instances(plan) +
           (plan->receiver_mask ? (uint64_t)plan->cascades * MASU_RECEIVER_WORDS : 0);
}

/* ---- The readback slot ----------------------------------------------------------------------- */

typedef struct readback_slot {
    uint64_t times, images[MASU_READBACK_IMAGES], bytes;
} readback_slot;

/* Appends the images, each aligned to 16 bytes for vkCmdCopyImageToBuffer. */
static void layout_readback_images(const masu_frame_plan *plan, readback_slot *slot) {
    for (uint32_t i = 0; i < MASU_READBACK_IMAGES; i++) {
        if (!(plan->desc.readback & 1u << i)) continue;
        slot->images[i] = slot->bytes;
        uint64_t bytes = 0; /* depth may be in either of two images: uses the larger one */
        for (uint32_t id = 1; id < MASU_IMAGE_COUNT; id++) {
            if (!(masu_images[id].readback & 1u << i) || !plan->images[id].used) continue;
            uint64_t v = (uint64_t)plan->images[id].width * plan->images[id].height *
                         masu_format_bytes(masu_plan_format(plan, id));
            if (v > bytes) bytes = v;
        }
        slot->bytes = masu_align_up(slot->bytes + bytes, 16);
    }
}

/* Counters, timestamps, images. */
static readback_slot layout_readback(const masu_frame_plan *plan) {
    readback_slot slot = {0};
    if (plan->desc.debug.counters)
        slot.bytes = masu_align_up(masu_counter_words(plan) * sizeof(uint32_t), 16);
    if (masu_stamps(&plan->desc)) {
        slot.times = slot.bytes;
        slot.bytes = masu_align_up(slot.bytes + masu_stamps(&plan->desc) * sizeof(uint64_t), 16);
    }
    layout_readback_images(plan, &slot);
    return slot;
}

static uint64_t masu_readback_bytes(const masu_frame_plan *plan) {
    return layout_readback(plan).bytes;
}

/* ---- The plan of all buffers ----------------------------------------------------------------- */

#define VERTEX VK_BUFFER_USAGE_VERTEX_BUFFER_BIT
#define INDEX VK_BUFFER_USAGE_INDEX_BUFFER_BIT
#define UNIFORM VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT
#define STORAGE VK_BUFFER_USAGE_STORAGE_BUFFER_BIT
#define INDIRECT VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT
#define TO VK_BUFFER_USAGE_TRANSFER_DST_BIT
#define FROM VK_BUFFER_USAGE_TRANSFER_SRC_BIT
#define ADDRESS VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT
#define STRUCTURE (ADDRESS | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR)
#define INPUT (ADDRESS | VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR)
#define SCRATCH (ADDRESS | STORAGE)

/* Slots are aligned to the device's requirement for bindings. */
static void layout_slots(const masu_frame_plan *plan, masu_buffer_plan *b, slot_kind slots,
                         uint64_t bytes, uint64_t alignment) {
    b->bytes = bytes;
    if (slots == SLOTS_ONCE || !bytes) return;
    uint64_t halves = slots == SLOTS_PREVIOUS ? masu_halves(plan) : 1;
    b->stride = halves * masu_align_up(bytes, alignment);
    b->bytes = plan->desc.frames_in_flight * b->stride;
}

void masu_size_buffers(masu_frame_plan *plan, uint64_t uniform_alignment,
                       uint64_t storage_alignment) {
    const masu_needs *n = &plan->needs;
    const masu_scene_data *s = &plan->scene;
    masu_buffer_plan *buffer = plan->buffers;
    if (s->instances) {
        layout_drawn(plan);
        plan->transparent_draws = own_draws(plan);
        plan->pick_draws =
            plan->transparent_draws + (uint64_t)s->transparents * s->transparent_sets;
        plan->face_draws = plan->pick_draws + (plan->needs.picking ? plan->draws : 0);
        if (plan->receiver_mask) plan->receiver_mask = seen_instances(plan);
    }
    layout_sprites(plan);
    readback_slot slot = layout_readback(plan);
    plan->readback_times = slot.times;
    memcpy(plan->readback_offset, slot.images, sizeof slot.images);
    uint64_t alignment;
#define SIZE(elements, size) buffer->count = (elements), bytes = (size)
#define BUFFER(ID, title, part, use, slots, lifetime, loaded, sized, binds)                        \
    {                                                                                              \
        uint64_t bytes;                                                                            \
        buffer = &plan->buffers[MASU_BUFFER_##ID];                                                 \
        *buffer = (masu_buffer_plan){                                                              \
            .name = title, .role = MASU_ROLE_##part, .usage = (VkBufferUsageFlags)(use)};          \
        sized;                                                                                     \
        alignment = buffer->usage & UNIFORM ? uniform_alignment                                    \
                    : buffer->usage & STORAGE || buffer->role != MASU_ROLE_READBACK                \
                        ? storage_alignment                                                        \
                        : 1;                                                                       \
        layout_slots(plan, buffer, SLOTS_##slots, bytes, alignment);                               \
    }
#include "plan/buffers.inc"
#undef BUFFER
#undef SIZE
}

/* ---- Bindings -------------------------------------------------------------------------------- */

#define COMPUTE VK_SHADER_STAGE_COMPUTE_BIT
#define FRAGMENT VK_SHADER_STAGE_FRAGMENT_BIT
#define VERTEX_STAGE VK_SHADER_STAGE_VERTEX_BIT
#define ALL (COMPUTE | FRAGMENT | VERTEX_STAGE)

/* Size of a binding: of a uniform buffer its struct; of a storage buffer a slot, or half of one. */
static uint64_t range_of(const masu_frame_plan *plan, masu_buffer_id id, VkDescriptorType type,
                         uint64_t bytes) {
    const masu_buffer_plan *b = &plan->buffers[id];
    if (type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER) return bytes;
    if (!b->stride) return b->bytes;
    return masu_buffers[id].halved ? b->stride / masu_halves(plan) : b->stride;
}

void masu_bindings(const masu_frame_plan *plan, masu_binding out[]) {
    const masu_needs *n = &plan->needs;
    const masu_scene_data *s = &plan->scene;
    uint32_t count = 0;
#define SIZE(elements, size) bytes = (size)
#define ADD(NAME, stages, group, when, type, previous)                                             \
    out[count++] = (masu_binding){MASU_BIND_##NAME,                                                \
                                  buffer,                                                          \
                                  type,                                                            \
                                  (VkShaderStageFlags)(stages),                                    \
                                  range_of(plan, buffer, type, bytes),                             \
                                  group,                                                           \
                                  (when) != 0,                                                     \
                                  previous};
#define BIND(NAME, stages, group, when)                                                            \
    ADD(NAME, stages, MASU_BINDING_##group, when, type, 0)
#define BIND_PREVIOUS(NAME, stages, group, when)                                                   \
    ADD(NAME, stages, MASU_BINDING_##group, when, type, 1)
#define BIND_STRUCTURE(NAME, stages, when)                                                         \
    ADD(NAME, stages, MASU_BINDING_PLAIN, when, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 0)
#define BUFFER(ID, title, part, use, slots, lifetime, loaded, sized, binds)                        \
    {                                                                                              \
        const masu_buffer_id buffer = MASU_BUFFER_##ID;                                            \
        const VkDescriptorType type = (use)&UNIFORM ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER            \
                                                    : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;           \
        uint64_t bytes;                                                                            \
        sized;                                                                                     \
        (void)buffer, (void)type, (void)bytes;                                                     \
        binds                                                                                      \
    }
#include "plan/buffers.inc"
#undef BUFFER
#undef SIZE
}

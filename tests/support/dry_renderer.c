/* dry_renderer.c: see dry_renderer.h. */
#include "support/dry_renderer.h"
#include "plan/compile.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "device/bind.h"
#include "device/load.h"
#include "support/bind.h"
#include "support/desc.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

masu_renderer m;
masu_scene scene;
_Alignas(64) unsigned char memory[MASU_ROLE_COUNT][ROOM];
masu_blob_camera_key keys[4];

static support_blob blob;
static VkCommandBuffer frame_handles[2 * MASU_MAX_FLIGHT * MASU_MAX_RUNGS * MASU_MAX_TARGETS];
static uint8_t recorded[2 * MASU_MAX_FLIGHT * MASU_MAX_RUNGS * MASU_MAX_TARGETS];
static VkCommandBuffer load_handles[16384];
static struct masu_instance_data instances[4];
static uint64_t instance_names[4];
static uint8_t instance_flags[4];
static masu_placed_model placed_models[4];
static masu_node model_nodes[4];
static uint32_t models_of[4];
static _Alignas(64) unsigned char own[1 << 16]; /* for clips, skins and shadows of lights */
static struct masu_frame_uniforms history;
static struct masu_instance_data previous[4];
static masu_blob_sdf_param params[4];
static masu_batch batches[4];
static masu_cull_node groups[4];
static masu_placed_occluder occluders[4];
static masu_punctual_light_state lights[4];
static uint64_t light_names[4];
static masu_sky sky;
static masu_transparent transparents[8];
static masu_back_to_front order[16];
static masu_blob_lod lods[4];
static uint8_t levels[4];
static uint8_t group_states[4 * MASU_MAX_VIEWS], marks[4];
static float boxes[6 * (4 + MASU_BOX_PADDING)], mesh_bounds[4][6];
static uint32_t box_items[4], box_positions[4], moved[4], instance_meshes[4];

VkCommandBuffer *frames = frame_handles, *loads = load_handles;

/* Places the buffers of each role one after the other. */
void make_renderer(uint32_t parts, uint64_t staging) {
    make_renderer_with(parts, staging, NULL, 0);
}

void make_renderer_with(uint32_t parts, uint64_t staging, const masu_rung *rungs,
                        uint32_t count) {
    masu_detail detail;
    memset(&m, 0, sizeof m);
    memset(memory, NOISE, sizeof memory);
    support_blob_write(&blob, parts);
    support_accepted(&blob, &scene);
    masu_desc d = scene_desc(0, 1280, 720);
    d.scene = &scene;
    d.rung_count = count;
    for (uint32_t r = 0; r < count; r++) d.rungs[r] = rungs[r];
    if (masu_compile(&d, 64, 64, &m.plan, &detail)) fail_msg("%s", detail.text);
    m.plan.buffers[MASU_BUFFER_STAGING].bytes = staging;
    m.plan.staged = staging != 0;
    uint64_t used[MASU_ROLE_COUNT] = {0};
    for (uint32_t b = 0; b < MASU_BUFFER_POISON; b++) {
        masu_buffer_plan *buffer = &m.plan.buffers[b];
        buffer->offset = used[buffer->role];
        used[buffer->role] += (buffer->bytes + 63) / 64 * 64;
        assert_true(used[buffer->role] <= ROOM);
    }
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++) m.device.mapped[role] = memory[role];
    for (size_t i = 0; i < COUNT(frame_handles); i++) frames[i] = FAKE(VkCommandBuffer, i);
    for (size_t i = 0; i < COUNT(load_handles); i++) loads[i] = FAKE(VkCommandBuffer, 0x800 + i);
    masu_timeline_start(&m.timeline);
    m.device.plan = &m.plan;
    m.device.frames = frames;
    memset(recorded, 1, sizeof recorded);
    m.device.recorded = recorded;
    m.device.ready = (1u << MASU_MAX_RUNGS) - 1;
    m.device.loads = loads;
    m.instances.now = instances;
    m.instances.names = instance_names;
    m.instances.flags = instance_flags;
    m.models.models = placed_models;
    m.models.nodes = model_nodes;
    m.models.of_instance = models_of;
    masu_arena arena;
    masu_arena_begin(&arena, own, sizeof own);
    masu_animation_alloc(&m.models.animation, &arena, &m.plan);
    masu_skins_alloc(&m.models.skins, &arena, &m.plan);
    masu_local_shadows_alloc(&m.local_shadows, &arena, &m.plan);
    assert_true(arena.used <= sizeof own);
    m.history.previous = &history;
    m.instances.previous = previous;
    m.camera.keys = keys;
    m.sdf.params = params;
    m.draws.batches = batches;
    m.bounds.groups = groups;
    m.occlusion.occluders = occluders;
    m.visible.group_states = group_states;
    m.visible.marks = marks;
    m.visible.lods = lods;
    m.visible.levels = levels;
    m.bounds.boxes = boxes;
    m.bounds.meshes = mesh_bounds;
    m.bounds.items = box_items;
    m.bounds.positions = box_positions;
    m.bounds.moved = moved;
    m.instances.meshes = instance_meshes;
    m.lights.states = lights;
    m.lights.names = light_names;
    m.sun_sky.sky = &sky;
    m.transparents.things = transparents;
    m.transparents.order = order;
    m.device.load_count = masu_load_chunks(&m.plan);
    assert_true(m.device.load_count <= COUNT(load_handles));
    masu_copy_scene(&m);
    masu_write_scene(&m);
}

const unsigned char *slot_bytes(masu_buffer_id buffer, uint32_t slot) {
    return masu_buffer_pointer(&m.device, buffer, slot);
}

struct masu_frame_uniforms uniforms(uint32_t slot) {
    struct masu_frame_uniforms u;
    memcpy(&u, slot_bytes(MASU_BUFFER_FRAME, slot), sizeof u);
    return u;
}

masu_frame_data begin_frame(const masu_frame_desc *frame, uint32_t slot) {
    masu_frame_data f = masu_frame_begin(&m.plan, &m.device, &m.draws, &m.timeline, frame);
    f.slot = slot;
    return f;
}

masu_result write_frame(const masu_frame_desc *frame, uint32_t slot, masu_detail *detail) {
    masu_frame_data f = begin_frame(frame, slot);
    masu_result result = masu_write_frame(&m, &f);
    *detail = m.error;
    return result;
}

uint32_t write_good(const masu_frame_desc *frame, uint32_t slot) {
    masu_frame_data f = begin_frame(frame, slot);
    if (masu_write_frame(&m, &f)) fail_msg("rejected: %s", m.error.text);
    return f.cascades;
}

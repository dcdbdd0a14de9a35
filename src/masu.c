/* masu.c: the public functions: the layout walk of the host block, the steps of masu_init and their
 * unwinding, frames. */
#include "renderer.h"

#include "base/error.h"
#include "plan/buffers.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- The walk -------------------------------------------------------------------------------- */

/* The one walk that sizes and lays out the host block. m is NULL when only counting. */
static void layout_host(masu_arena *arena, const masu_frame_plan *plan, masu_renderer **m) {
    const masu_desc *d = &plan->desc;
    const masu_scene *s = &plan->scene;
    uint64_t frames = (uint64_t)d->frames_in_flight * plan->recordings;
    masu_renderer *r = masu_arena_take(arena, "renderer", 1, sizeof *r, MASU_ARENA_ALIGNMENT);
    masu_texture_plan *textures;
    masu_renderer scrap; /* takes the NULLs of a counting walk */
    masu_renderer *to = r ? r : &scrap;
    to->frames = masu_arena_take(arena, "command buffers", frames, sizeof *to->frames, 8);
    to->loads = masu_arena_take(arena, "load command buffers", masu_load_chunks(plan),
                                sizeof *to->loads, 8);
    to->pass_sets =
        masu_arena_take(arena, "descriptor sets", plan->pass_sets, sizeof *to->pass_sets, 8);
    to->instances =
        masu_arena_take(arena, "instance transforms", s->instances, sizeof *to->instances, 16);
    to->instance_names =
        masu_arena_take(arena, "instance names", s->instances, sizeof *to->instance_names, 8);
    to->instance_dirty =
        masu_arena_take(arena, "instance flags", s->instances, sizeof *to->instance_dirty, 1);
    to->camera_keys =
        masu_arena_take(arena, "camera keys", s->camera_keys, sizeof *to->camera_keys, 4);
    to->sdf_params =
        masu_arena_take(arena, "SDF parameters", s->sdf_params, sizeof *to->sdf_params, 4);
    textures = masu_arena_take(arena, "textures", s->texture_arrays, sizeof *textures, 8);
    if (r) {
        for (uint32_t i = 0; i < s->texture_arrays; i++) textures[i] = plan->textures[i];
    }
    to->plan.textures = textures;
    to->texture_sets =
        masu_arena_take(arena, "texture sets", s->texture_sets, sizeof *to->texture_sets, 8);
    uint64_t before = plan->needs.velocity ? 1 : 0;
    to->previous = masu_arena_take(arena, "previous frame", before, sizeof *to->previous, 16);
    to->previous_instances = masu_arena_take(arena, "previous transforms", before * s->instances,
                                             sizeof *to->previous_instances, 16);
    uint64_t lods = plan->lods ? s->lods : 0;
    to->batches = masu_arena_take(arena, "batches", s->meshes + lods, sizeof *to->batches, 8);
    to->lods = masu_arena_take(arena, "LODs", lods, sizeof *to->lods, 4);
    to->levels =
        masu_arena_take(arena, "instance LODs", lods ? s->instances : 0, sizeof *to->levels, 1);
    to->occluders = masu_arena_take(arena, "occluders", s->occluders, sizeof *to->occluders, 4);
    to->mesh_bounds = masu_arena_take(arena, "mesh bounds", s->meshes, sizeof *to->mesh_bounds, 4);
    to->groups = masu_arena_take(arena, "groups", s->groups, sizeof *to->groups, 4);
    to->group_states = masu_arena_take(arena, "group states", (uint64_t)plan->views * s->groups,
                                       sizeof *to->group_states, 1);
    to->boxes = masu_arena_take(arena, "boxes", 6 * ((uint64_t)s->instances + MASU_BOX_PADDING),
                                sizeof *to->boxes, 16);
    to->box_items = masu_arena_take(arena, "box owners", s->instances, sizeof *to->box_items, 4);
    to->box_positions =
        masu_arena_take(arena, "box positions", s->instances, sizeof *to->box_positions, 4);
    to->moved = masu_arena_take(arena, "moved boxes", s->instances, sizeof *to->moved, 4);
    to->instance_meshes =
        masu_arena_take(arena, "instance meshes", s->instances, sizeof *to->instance_meshes, 4);
    to->lights = masu_arena_take(arena, "local lights", s->lights, sizeof *to->lights, 8);
    to->light_names =
        masu_arena_take(arena, "light names", s->lights, sizeof *to->light_names, 8);
    to->marks = masu_arena_take(arena, "instance marks", s->instances, sizeof *to->marks, 1);
    to->sky = masu_arena_take(arena, "sky", plan->needs.sky ? 1 : 0, sizeof *to->sky, 16);
    uint64_t traced = plan->needs.traced ? s->trace_instances : 0;
    uint64_t own = traced && !plan->needs.query ? masu_trace_top_bytes((uint32_t)traced) : 0;
    to->trace_memory = masu_arena_take(arena, "traced instances", own, 1, 16);
    to->traced = masu_arena_take(arena, "their numbers", traced, sizeof *to->traced, 4);
    to->ray_live = masu_arena_take(arena, "their flags", plan->needs.query ? traced : 0,
                                   sizeof *to->ray_live, 1);
    to->ray_meshes = masu_arena_take(arena, "bottom levels", plan->needs.query ? s->meshes : 0,
                                     sizeof *to->ray_meshes, 8);
    to->transparents =
        masu_arena_take(arena, "transparents", s->transparents, sizeof *to->transparents, 4);
    to->far_first = masu_arena_take(arena, "their order", 2 * (uint64_t)s->transparents,
                                    sizeof *to->far_first, 4);
    to->governor = masu_arena_take(arena, "governor", d->governor.mode ? 1 : 0,
                                   sizeof *to->governor, 8);
    if (!d->governor.mode) to->governor = NULL;
    if (m) *m = r;
}

static masu_result check_host(const masu_frame_plan *plan, uint64_t needed, masu_detail *detail) {
    uint64_t budget = plan->desc.host_budget;
    if (!budget || needed <= budget) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_LIMIT, "host_budget", needed, budget,
                     "host_budget: the plan needs %llu bytes, the budget is %llu",
                     (unsigned long long)needed, (unsigned long long)budget);
}

/* ---- Plan and query -------------------------------------------------------------------------- */

/* What set 0 shows to compute shaders: counters, tiles, slots, tables; lights and their tiles; light
 * probes; of SMAA areas and tiles; the metered exposure; draws, drawn, seen; and what is traced, its instances, vertices, texture coordinates and
 * tiles. */
#define PLAIN_BUFFERS 4u
#define CULLING_BUFFERS 3u
#define TRACE_BUFFERS 5u

static uint32_t storage_buffers(const masu_frame_plan *plan) {
    return PLAIN_BUFFERS + (plan->needs.lights ? 2u : 0u) + (plan->needs.probes ? 1u : 0u) +
           (plan->needs.smoothing ? 2u : 0u) + (plan->needs.metered ? 1u : 0u);
}

/* The rungs as the host gave them, or those that the plan chose, to be looked at and changed. */
static void own_rungs(masu_desc *desc, const masu_frame_plan *plan) {
    if (desc->rung_count) return;
    desc->rung_count = plan->desc.rung_count;
    memcpy(desc->rungs, plan->desc.rungs, sizeof desc->rungs);
    memcpy(desc->flips, plan->desc.flips, sizeof desc->flips);
    memcpy(desc->governor.costs, plan->desc.governor.costs, sizeof desc->governor.costs);
}

/* Rungs that leave reflections to us go without where there are too few. */
static masu_result drop_specular(masu_desc *desc, const masu_frame_plan *plan,
                                 const VkPhysicalDeviceLimits *limits, masu_detail *detail) {
    uint32_t has = limits->maxPerStageDescriptorStorageBuffers;
    uint32_t needed = storage_buffers(plan) + TRACE_BUFFERS;
    if (!plan->needs.reflections || has >= needed) return MASU_OK;
    for (uint32_t r = 0; r < desc->rung_count; r++) {
        if (desc->rungs[r].specular == MASU_ON) {
            return masu_fail(detail, MASU_ERROR_DEVICE, "maxPerStageDescriptorStorageBuffers",
                             needed, has,
                             "rungs[%u].specular needs %u storage buffers in a stage, the device "
                             "has %u",
                             r, needed, has);
        }
        desc->rungs[r].specular = MASU_OFF;
    }
    return MASU_OK;
}

/* Whether any rung still may trace. */
static int desc_traces(const masu_desc *desc) {
    for (uint32_t r = 0; r < desc->rung_count; r++) {
        if (desc->rungs[r].specular != MASU_OFF) return 1;
    }
    return 0;
}

/* Whether the device's ray queries or our own tree finds what is reflected: the description is left
 * with ON or OFF. */
static masu_result choose_ray_query(masu_desc *desc, const masu_frame_plan *plan, const masu_vk *vk,
                                    masu_detail *detail) {
    VkPhysicalDeviceType type = vk->properties.deviceType;
    int gpu = type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
              type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    int forced = desc->ray_query == MASU_ON;
    int wished = forced || (desc->ray_query == MASU_AUTO && desc->vulkan.ray_query && gpu);
    desc->ray_query = MASU_OFF;
    if (!wished || !plan->needs.traced || !desc_traces(desc)) return MASU_OK;
    if (!desc->vulkan.ray_query) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "vulkan.ray_query", 1, 0,
                         "ray_query is MASU_ON, but vulkan.ray_query says that the device was created "
                         "without VK_KHR_ray_query");
    }
    masu_result result = masu_ray_check(&plan->scene, vk, detail);
    if (result) return forced ? result : MASU_OK;
    desc->ray_query = MASU_ON;
    return MASU_OK;
}

/* Whether fast EASU weighs texels in 16 bits: the description is left with ON or OFF. */
static masu_result choose_half_floats(masu_desc *desc, const masu_vk *vk, masu_detail *detail) {
    VkPhysicalDeviceType type = vk->properties.deviceType;
    int gpu = type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
              type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
    int forced = desc->half_floats == MASU_ON, used = 0;
    for (uint32_t r = 0; r < desc->rung_count; r++) used |= desc->rungs[r].easu == MASU_EASU_FAST;
    if (used && forced && !desc->vulkan.shader_float16) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "vulkan.shader_float16", 1, 0,
                         "half_floats is MASU_ON, but vulkan.shader_float16 says that the device was "
                         "created without shaderFloat16");
    }
    int wished = forced || (desc->half_floats == MASU_AUTO && desc->vulkan.shader_float16 && gpu);
    desc->half_floats = used && wished ? MASU_ON : MASU_OFF;
    return MASU_OK;
}

/* Vulkan promises four storage buffers in a stage: rungs that leave culling by occluders to us go
 * without it where there are no more. */
static masu_result drop_occlusion(masu_desc *desc, const masu_frame_plan *plan,
                                  const VkPhysicalDeviceLimits *limits, masu_detail *detail) {
    uint32_t has = limits->maxPerStageDescriptorStorageBuffers;
    uint32_t plain = storage_buffers(plan), needed = plain + CULLING_BUFFERS;
    if (has < plain) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxPerStageDescriptorStorageBuffers", plain, has,
                         "the scene's lights, probes or metered exposure, or SMAA, need %u storage buffers in a stage, the "
                         "device has %u",
                         plain, has);
    }
    if (plan->needs.reflections && desc_traces(desc)) needed += TRACE_BUFFERS;
    if (!plan->occlusion || has >= needed) return MASU_OK;
    for (uint32_t r = 0; r < desc->rung_count; r++) {
        if (desc->rungs[r].occlusion == MASU_ON) {
            return masu_fail(detail, MASU_ERROR_DEVICE, "maxPerStageDescriptorStorageBuffers",
                             needed, has,
                             "rungs[%u].occlusion needs %u storage buffers in a stage, the device "
                             "has %u",
                             r, needed, has);
        }
        desc->rungs[r].occlusion = MASU_OFF;
    }
    return MASU_OK;
}

/* What grows with the scene and is bound whole, and the widest dispatch over instances. */
static masu_result check_ranges(const masu_frame_plan *plan, const VkPhysicalDeviceLimits *limits,
                                masu_detail *detail) {
    static const masu_buffer_id ids[] = {MASU_BUFFER_INSTANCES, MASU_BUFFER_DRAWN,
                                         MASU_BUFFER_DRAWS, MASU_BUFFER_SEEN,
                                         MASU_BUFFER_PROBES,    MASU_BUFFER_LIGHT_TILES,
                                         MASU_BUFFER_TRACE,     MASU_BUFFER_TRACE_FRAME,
                                         MASU_BUFFER_SMAA_TILES,
                                         MASU_BUFFER_VERTICES,  MASU_BUFFER_TEXCOORDS};
    for (size_t i = 0; i < sizeof ids / sizeof *ids; i++) {
        const masu_buffer_plan *b = &plan->buffers[ids[i]];
        uint64_t bytes = b->stride ? b->stride : b->bytes;
        if (bytes <= limits->maxStorageBufferRange ||
            !(b->usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT))
            continue;
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxStorageBufferRange", bytes,
                         limits->maxStorageBufferRange,
                         "%s need a storage buffer of %llu bytes, the device has %u", b->name,
                         (unsigned long long)bytes, limits->maxStorageBufferRange);
    }
    uint32_t groups = (plan->scene.instances + 63) / 64;
    if (plan->occlusion && groups > limits->maxComputeWorkGroupCount[0]) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxComputeWorkGroupCount", groups,
                         limits->maxComputeWorkGroupCount[0],
                         "culling %u instances takes %u workgroups, the device has %u",
                         plan->scene.instances, groups, limits->maxComputeWorkGroupCount[0]);
    }
    return MASU_OK;
}

static masu_result bad_governor(masu_detail *detail, const char *what, double given, double low,
                                double high) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s is %g, allowed are %g to %g", what,
                     given, low, high);
}

static masu_result check_governor(const masu_desc *desc, uint32_t rungs, masu_detail *detail) {
    const masu_governor_desc *g = &desc->governor;
    if ((unsigned)g->mode > MASU_GOVERNOR_FIXED)
        return bad_governor(detail, "governor.mode", (unsigned)g->mode, 0, MASU_GOVERNOR_FIXED);
    for (uint32_t r = 0; r < rungs; r++) { /* also told by the plan, without a governor */
        if (!(g->costs[r] >= 0.0f && g->costs[r] <= 1e6f))
            return bad_governor(detail, "governor.costs", (double)g->costs[r], 0, 1e6);
    }
    if (g->mode == MASU_GOVERNOR_OFF) return MASU_OK;
    if (g->target_ms != 0.0f && !(g->target_ms >= 1.0f && g->target_ms <= 1000.0f))
        return bad_governor(detail, "governor.target_ms", (double)g->target_ms, 1, 1000);
    if (!(g->headroom <= 0.5f && g->headroom >= -1.0f))
        return bad_governor(detail, "governor.headroom", (double)g->headroom, -1, 0.5);
    if (g->worst_rung >= rungs)
        return bad_governor(detail, "governor.worst_rung", g->worst_rung, 0, rungs - 1);
    if (g->best_rung > (g->worst_rung ? g->worst_rung : rungs - 1))
        return bad_governor(detail, "governor.best_rung", g->best_rung, 0,
                            g->worst_rung ? g->worst_rung : rungs - 1);
    if (g->rung >= rungs) return bad_governor(detail, "governor.rung", g->rung, 0, rungs - 1);
    if (g->dwell > 600) return bad_governor(detail, "governor.dwell", g->dwell, 0, 600);
    return MASU_OK;
}

/* A plan needs the driver's sizes, so images and buffers are created; the caller keeps or destroys
 * them. */
static masu_result make_plan(const masu_desc *desc, masu_vk *vk, masu_frame_plan *plan,
                             masu_texture_plan textures[MASU_TEXTURE_ARRAYS_MAX],
                             masu_objects *objects, masu_detail *detail) {
    memset(objects, 0, sizeof *objects);
    memset(textures, 0, MASU_TEXTURE_ARRAYS_MAX * sizeof *textures);
    if (!desc) return masu_fail(detail, MASU_ERROR_ARGUMENT, "desc", 1, 0, "desc is NULL");
    if (desc->scene && !desc->scene->blob) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "scene", 1, 0,
                         "scene was not filled by masu_scene_bind");
    }
    masu_result result =
        masu_compile(desc, 1, 1, plan, detail); /* pure checks come before the first Vulkan call */
    if (!result) result = check_governor(desc, plan->desc.rung_count, detail);
    if (!result) result = masu_vk_load(desc, vk, detail);
    if (result) return result;
    const VkPhysicalDeviceLimits *limits = &vk->properties.limits;
    masu_desc possible = *desc;
    own_rungs(&possible, plan);
    if (vk->queue_family.timestampValidBits == 0) possible.governor.wall_only = 1;
    result = drop_specular(&possible, plan, limits, detail);
    if (!result) result = drop_occlusion(&possible, plan, limits, detail);
    if (!result) result = choose_ray_query(&possible, plan, vk, detail);
    if (!result) result = choose_half_floats(&possible, vk, detail);
    if (result) return result;
    result = masu_compile(
        &possible,
        limits->minUniformBufferOffsetAlignment ? limits->minUniformBufferOffsetAlignment : 1,
        limits->minStorageBufferOffsetAlignment ? limits->minStorageBufferOffsetAlignment : 1, plan,
        detail);
    if (result) return result;
    masu_ray_sizes(plan, vk);
    result = check_ranges(plan, limits, detail);
    if (result) return result;
    VkExtent2D map = masu_plan_extent(plan, MASU_EXTENT_SHADOW, plan->desc.output);
    uint32_t widest = map.width > map.height ? map.width : map.height;
    if (widest > limits->maxImageDimension2D || widest > limits->maxFramebufferWidth ||
        widest > limits->maxFramebufferHeight) {
        return masu_fail(
            detail, MASU_ERROR_DEVICE, "maxImageDimension2D", widest, limits->maxImageDimension2D,
            "the shadow map's %u cascades of %u texels make an image of %ux%u, the "
            "device's may be %u",
            plan->cascades, plan->cascade_size, map.width, map.height, limits->maxImageDimension2D);
    }
    plan->textures = textures;
    result = masu_objects_create(vk, plan, objects, detail);
    if (result) masu_objects_destroy(vk, plan, objects);
    return result;
}

static masu_result plan_and_forget(const masu_desc *desc, masu_frame_plan *plan,
                                   uint64_t *host_bytes, masu_detail *detail) {
    masu_vk vk;
    masu_objects objects;
    masu_texture_plan textures[MASU_TEXTURE_ARRAYS_MAX];
    masu_result result = make_plan(desc, &vk, plan, textures, &objects, detail);
    if (result) return result;
    masu_objects_destroy(&vk, plan, &objects);
    masu_arena arena;
    masu_arena_begin(&arena, NULL, 0);
    layout_host(&arena, plan, NULL);
    *host_bytes = arena.used;
    plan->textures = NULL; /* they were on this stack */
    return check_host(plan, arena.used, detail);
}

masu_result masu_memory_query(const masu_desc *desc, masu_memory *out, masu_detail *detail) {
    if (!out) return masu_fail(detail, MASU_ERROR_ARGUMENT, "out", 1, 0, "out is NULL");
    masu_frame_plan plan;
    uint64_t host_bytes = 0;
    masu_result result = plan_and_forget(desc, &plan, &host_bytes, detail);
    if (!result) masu_memory_export(&plan, host_bytes, out);
    return result;
}

masu_result masu_plan(const masu_desc *desc, masu_plan_info *out, masu_detail *detail) {
    if (!out) return masu_fail(detail, MASU_ERROR_ARGUMENT, "out", 1, 0, "out is NULL");
    masu_frame_plan plan;
    uint64_t host_bytes = 0;
    masu_result result = plan_and_forget(desc, &plan, &host_bytes, detail);
    if (result) return result;
    masu_plan_export(&plan, NULL, out);
    masu_memory_export(&plan, host_bytes, &out->memory);
    return MASU_OK;
}

void masu_plan_of(const masu_renderer *m, masu_plan_info *out) {
    masu_plan_export(&m->plan, m->pipeline_ns, out);
    masu_memory_export(&m->plan, m->arena.used, &out->memory);
}

/* ---- Init and destroy ------------------------------------------------------------------------ */

static masu_result build(masu_renderer *m, masu_detail *detail) {
    masu_result result = masu_bind_memory(m, detail);
    if (!result) result = masu_make_views(m, detail);
    if (!result) result = masu_ray_create(m, detail);
    if (!result) result = masu_make_pipelines(m, detail);
    if (!result) result = masu_record(m, detail);
    return result;
}

/* Rungs of a source image have no scale: what they cost has to be learnt. */
static void start_governor(masu_renderer *m) {
    const masu_desc *d = &m->plan.desc;
    masu_governor_rung rungs[MASU_MAX_RUNGS];
    for (uint32_t r = 0; r < d->rung_count; r++) {
        rungs[r].scale = d->source.view ? 1.0 : (double)d->rungs[r].scale;
        rungs[r].cost = (double)d->governor.costs[r];
    }
    masu_governor_init(m->governor, &d->governor, rungs, d->rung_count);
}

static masu_result init(const masu_desc *desc, void *block, uint64_t block_bytes,
                        masu_renderer **out, masu_detail *detail) {
    masu_vk vk;
    masu_frame_plan plan;
    masu_objects objects;
    masu_texture_plan textures[MASU_TEXTURE_ARRAYS_MAX];
    if (!block || (uintptr_t)block % MASU_ARENA_ALIGNMENT) {
        return masu_fail(detail, MASU_ERROR_MEMORY, "host block", MASU_ARENA_ALIGNMENT,
                         (uintptr_t)block, "host block is NULL or not %u-byte aligned",
                         MASU_ARENA_ALIGNMENT);
    }
    masu_result result = make_plan(desc, &vk, &plan, textures, &objects, detail);
    if (result) return result;
    masu_arena arena;
    masu_renderer *m = NULL;
    masu_arena_begin(&arena, NULL, 0);
    layout_host(&arena, &plan, NULL);
    result = check_host(&plan, arena.used, detail);
    if (!result && arena.used > block_bytes) {
        result = masu_fail(detail, MASU_ERROR_MEMORY, "host block", arena.used, block_bytes,
                           "host block: %llu bytes are needed, %llu are given",
                           (unsigned long long)arena.used, (unsigned long long)block_bytes);
    }
    if (result) {
        masu_objects_destroy(&vk, &plan, &objects);
        return result;
    }
    masu_arena_begin(&arena, block, block_bytes);
    layout_host(&arena, &plan, &m);
    m->cookie = MASU_RENDERER_COOKIE;
    m->vk = vk;
    plan.textures = m->plan.textures; /* the walk has put them into the block */
    m->plan = plan;
    m->plan.desc.scene = plan.desc.scene ? &m->plan.scene : NULL;
    m->arena = arena;
    m->objects = objects;
    m->load_count = masu_load_chunks(&m->plan);
    for (uint32_t f = 0; f < MASU_MAX_FLIGHT; f++) m->slot_frame[f] = UINT64_MAX;
    if (m->governor) start_governor(m);
    masu_keep_scene(m);
    result = build(m, detail);
    if (result) {
        masu_destroy(m);
        return result;
    }
    *out = m;
    return MASU_OK;
}

static void log_box(const masu_renderer *m) {
    char text[200];
    masu_peak_info peaks;
    masu_peaks(m, &peaks);
    snprintf(text, sizeof text, "renderer made: %llu bytes host, %llu bytes device%s, %u rungs",
             (unsigned long long)peaks.host_bytes, (unsigned long long)peaks.device_bytes,
             m->plan.unified ? " in one unified block" : "", m->plan.desc.rung_count);
    masu_log(&m->plan.desc, MASU_LOG_INFO, text);
    if (m->plan.desc.debug.labels && !m->vk.SetDebugUtilsObjectNameEXT) {
        masu_log(
            &m->plan.desc, MASU_LOG_WARNING,
            "debug.labels: VK_EXT_debug_utils is not enabled on the instance, there are no labels");
    }
}

masu_result masu_init(const masu_desc *desc, void *block, uint64_t block_bytes, masu_renderer **out,
                      masu_detail *detail) {
    masu_detail own;
    if (!out) return masu_fail(detail, MASU_ERROR_ARGUMENT, "out", 1, 0, "out is NULL");
    *out = NULL;
    masu_result result = init(desc, block, block_bytes, out, &own);
    if (!result) {
        log_box(*out);
        return MASU_OK;
    }
    if (detail) *detail = own;
    if (desc) masu_log(desc, MASU_LOG_ERROR, own.text);
    return result;
}

void masu_destroy(masu_renderer *m) {
    if (!m || m->cookie != MASU_RENDERER_COOKIE) return;
    const masu_vk *vk = &m->vk;
    VkDevice device = vk->device;
    vk->DestroyQueryPool(device, m->queries, vk->allocator);
    vk->DestroyCommandPool(device, m->command_pool, vk->allocator);
    vk->DestroyDescriptorPool(device, m->descriptor_pool, vk->allocator);
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        vk->DestroyPipeline(device, m->pipelines[p], vk->allocator);
        vk->DestroyFramebuffer(device, m->framebuffers[p], vk->allocator);
        vk->DestroyRenderPass(device, m->render_passes[p], vk->allocator);
        vk->DestroyPipelineLayout(device, m->layouts[p], vk->allocator);
        vk->DestroyDescriptorSetLayout(device, m->pass_layouts[p], vk->allocator);
    }
    vk->DestroyDescriptorSetLayout(device, m->global_layout, vk->allocator);
    vk->DestroySampler(device, m->sampler, vk->allocator);
    for (uint32_t i = 0; i < MASU_TEXTURED_COUNT; i++)
        vk->DestroyPipeline(device, m->textured[i], vk->allocator);
    vk->DestroyPipeline(device, m->masked_casters, vk->allocator);
    vk->DestroyDescriptorSetLayout(device, m->texture_layout, vk->allocator);
    for (uint32_t i = 0; i < MASU_SAMPLER_COUNT; i++)
        vk->DestroySampler(device, m->samplers[i], vk->allocator);
    for (uint32_t i = 0; i < m->plan.scene.texture_arrays; i++)
        vk->DestroyImageView(device, m->plan.textures[i].view, vk->allocator);
    for (uint32_t i = 0; i < MASU_IMAGE_SOURCE; i++)
        vk->DestroyImageView(device, m->views[i], vk->allocator);
    masu_ray_destroy(m);
    masu_objects_destroy(vk, &m->plan, &m->objects);
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++) {
        if (m->memory_owned[role])
            vk->FreeMemory(device, m->memory[role], vk->allocator); /* also unmaps */
    }
    m->cookie = 0;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static masu_result check_frame(masu_renderer *m, const masu_frame_desc *frame) {
    const masu_desc *d = &m->plan.desc;
    if (!m->loaded) {
        return masu_fail(&m->error, MASU_ERROR_STATE, "masu_load", 1, 0,
                         "masu_frame was called before masu_load had returned MASU_OK");
    }
    if (frame->rung == MASU_RUNG_AUTO && !m->governor) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "rung", d->rung_count - 1, frame->rung,
                         "rung is MASU_RUNG_AUTO, but governor.mode is MASU_GOVERNOR_OFF");
    }
    if (frame->rung >= d->rung_count && frame->rung != MASU_RUNG_AUTO) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "rung", d->rung_count - 1, frame->rung,
                         "rung %u does not exist, the last one is %u", frame->rung,
                         d->rung_count - 1);
    }
    if (frame->target >= d->targets.count) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "target", d->targets.count - 1,
                         frame->target, "target %u does not exist, the last one is %u",
                         frame->target, d->targets.count - 1);
    }
    return MASU_OK;
}

static uint64_t stamp_ns(const masu_renderer *m, uint32_t slot, uint32_t from, uint32_t to) {
    const uint64_t *stamps =
        (const uint64_t *)(const void *)(masu_buffer_pointer(m, MASU_BUFFER_READBACK, slot) +
                                         m->plan.readback_times);
    uint32_t bits = m->vk.queue_family.timestampValidBits;
    uint64_t mask = bits >= 64 ? UINT64_MAX : ((uint64_t)1 << bits) - 1;
    /* The counter may wrap between two stamps: the difference under the mask is right all the same. */
    return (uint64_t)((double)((stamps[to] - stamps[from]) & mask) *
                      (double)m->vk.properties.limits.timestampPeriod);
}

/* Whether the time of a pass does not depend on the render size. */
static int is_fixed_pass(uint32_t pass) {
    switch (masu_passes[pass].extent) {
    case MASU_EXTENT_OUTPUT:
    case MASU_EXTENT_OUTPUT32:
    case MASU_EXTENT_ONE:
    case MASU_EXTENT_ATLAS:
    case MASU_EXTENT_KEPT:
    case MASU_EXTENT_BATCHES:
    case MASU_EXTENT_PROBES:
    case MASU_EXTENT_SHADOW: return 1;
    default: return pass == MASU_PASS_PRESENT;
    }
}

/* What is known of the frame that the slot has held. */
static void tell_governor(masu_renderer *m, uint32_t slot) {
    uint32_t stamps = masu_stamps(&m->plan.desc);
    masu_governor_sample sample = {.frame = m->slot_frame[slot],
                                   .rung = m->slot_rung[slot],
                                   .wall_ms = m->slot_wall[slot]};
    if (sample.frame == UINT64_MAX) return;
    if (stamps) sample.gpu_ms = (double)stamp_ns(m, slot, 0, stamps - 1) * 1e-6;
    for (uint32_t p = 0; p + 2 <= stamps && stamps > 2; p++) {
        if (is_fixed_pass(p) && masu_has_pass(&m->plan.rungs[sample.rung].active, p))
            sample.fixed_ms += (double)stamp_ns(m, slot, p, p + 1) * 1e-6;
    }
    m->slot_wall[slot] = 0.0;
    masu_governor_sample_in(m->governor, &sample);
}

static masu_result draw_frame(masu_renderer *m, const masu_frame_desc *frame, uint32_t slot,
                              masu_commands *commands) {
    const masu_desc *d = &m->plan.desc;
    masu_result result = d->scene ? masu_write_frame(m, frame, slot, &m->error) : MASU_OK;
    if (result) return result;
    if (d->scene) {
        masu_write_trace(m, slot, masu_is_cut(m, frame));
        masu_write_instances(m, slot, masu_is_cut(m, frame));
        int culls = d->rungs[frame->rung].frustum != MASU_OFF;
        for (uint32_t v = 0; v < m->plan.views; v++) masu_write_visible(m, slot, v, culls);
        masu_write_transparents(m, slot);
        if (masu_has_pass(&m->plan.rungs[frame->rung].active, MASU_PASS_CULL))
            masu_write_stage2(m, slot, masu_is_cut(m, frame));
    }
    m->slot_frame[slot] = m->frame;
    m->slot_rung[slot] = frame->rung;
    const masu_rung_plan *rp = &m->plan.rungs[frame->rung];
    uint32_t recording =
        rp->first_recording + frame->target * rp->variants + masu_recording_variant(rp, m->drawn);
    *commands = (masu_commands){m->frames[slot * m->plan.recordings + recording], slot, frame->rung,
                                m->frame};
    m->frame++;
    return MASU_OK;
}

static masu_result governed_frame(masu_renderer *m, const masu_frame_desc *frame, uint32_t slot,
                                  masu_commands *commands) {
    masu_frame_desc chosen = *frame;
    uint64_t number = m->frame;
    tell_governor(m, slot);
    if (frame->rung == MASU_RUNG_AUTO) chosen.rung = masu_governor_pick(m->governor, number);
    masu_result result = draw_frame(m, &chosen, slot, commands);
    if (result) return result;
    if (frame->rung != MASU_RUNG_AUTO) masu_governor_override(m->governor, number, frame->rung);
    if (frame->cut) masu_governor_cut(m->governor, number);
    return MASU_OK;
}

masu_result masu_frame(masu_renderer *m, const masu_frame_desc *frame, masu_commands *commands) {
    if (!m || !frame || !commands) return MASU_ERROR_ARGUMENT;
    uint32_t slot = (uint32_t)(m->frame % m->plan.desc.frames_in_flight);
    masu_result result = check_frame(m, frame);
    if (!result) {
        result = m->governor ? governed_frame(m, frame, slot, commands)
                             : draw_frame(m, frame, slot, commands);
    }
    if (result) masu_log(&m->plan.desc, MASU_LOG_ERROR, m->error.text);
    return result;
}

void masu_frame_wall(masu_renderer *m, uint32_t slot, double wall_ms) {
    if (slot < m->plan.desc.frames_in_flight) m->slot_wall[slot] = wall_ms;
}

const masu_detail *masu_last_error(const masu_renderer *m) { return &m->error; }

/* ---- Looking --------------------------------------------------------------------------------- */

static uint64_t counter(const masu_renderer *m, uint32_t slot, uint32_t index) {
    const uint32_t *c =
        (const uint32_t *)(const void *)masu_buffer_pointer(m, MASU_BUFFER_READBACK, slot);
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

masu_result masu_stats(const masu_renderer *m, uint32_t slot, masu_stats_info *out) {
    if (!m || !out || slot >= m->plan.desc.frames_in_flight) return MASU_ERROR_ARGUMENT;
    memset(out, 0, sizeof *out);
    out->frame = m->slot_frame[slot];
    out->pass_count = MASU_PASS_COUNT;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) out->pass_names[p] = masu_passes[p].name;
    if (m->governor) masu_governor_report(m->governor, &out->governor);
    else out->governor.reason_text = masu_governor_reason_string(MASU_GOVERNOR_REASON_NONE);
    if (out->frame == UINT64_MAX) return MASU_INCOMPLETE;
    out->rung = m->slot_rung[slot];
    out->view_count = m->plan.needs.raster ? m->plan.views : 0;
    memcpy(out->views, m->slot_views[slot], sizeof out->views);
    out->lights = m->plan.scene.lights;
    out->lights_in_view = m->slot_lights[slot];
    out->draws = out->views[0].draws;
    out->triangles = out->views[0].triangles;
    out->transparents = m->slot_transparents[slot];
    if (m->plan.desc.debug.counters && m->plan.needs.smoothing)
        out->smaa_tiles = counter(m, slot, MASU_COUNTER_SMAA_TILES);
    if (m->plan.desc.debug.counters && m->plan.needs.scene) {
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
    if (m->queries) read_times(m, slot, out);
    return MASU_OK;
}

void masu_peaks(const masu_renderer *m, masu_peak_info *out) {
    const masu_scene *s = &m->plan.scene;
    *out = (masu_peak_info){.vertices = s->vertices,
                            .indices = s->indices,
                            .materials = s->materials,
                            .instances = s->instances,
                            .sdf_params = s->sdf_params,
                            .shadow_cascades = m->plan.cascades,
                            .shadow_resolution = m->plan.cascade_size,
                            .textures = s->textures,
                            .texture_bytes = masu_scene_texture_bytes(&m->plan.desc),
                            .transparents = s->transparents,
                            .lights = s->lights,
                            .trace_triangles = s->trace_triangles,
                            .trace_instances = s->trace_instances,
                            .host_bytes = m->arena.used};
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++)
        out->device_bytes += m->plan.blocks[role].bytes;
}

masu_result masu_readback(const masu_renderer *m, uint32_t slot, masu_readback_bits which,
                          masu_readback_image *out) {
    if (!m || !out || slot >= m->plan.desc.frames_in_flight) return MASU_ERROR_ARGUMENT;
    uint32_t bit = 0;
    while (bit < MASU_READBACK_IMAGES && which != 1u << bit) bit++;
    if (bit == MASU_READBACK_IMAGES || !(m->plan.desc.readback & 1u << bit))
        return MASU_ERROR_ARGUMENT;
    if (m->slot_frame[slot] == UINT64_MAX) return MASU_INCOMPLETE;
    const masu_rung_plan *rp = &m->plan.rungs[m->slot_rung[slot]];
    uint32_t id = 1;
    while (masu_images[id].readback != (uint32_t)which) id++;
    VkFormat format = masu_images[id].format;
    if (format == VK_FORMAT_D32_SFLOAT)
        format = VK_FORMAT_R32_SFLOAT; /* as it lies in the buffer */
    VkExtent2D size = masu_plan_extent(&m->plan, masu_images[id].extent,
                                       (VkExtent2D){rp->render_width, rp->render_height});
    *out = (masu_readback_image){
        masu_buffer_pointer(m, MASU_BUFFER_READBACK, slot) + m->plan.readback_offset[bit],
        size.width, size.height, (uint64_t)size.width * masu_format_bytes(format), format};
    return MASU_OK;
}

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

uint32_t masu_memory_report(const masu_renderer *m, masu_memory_row *rows, uint32_t capacity) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < m->arena.row_count; i++, n++) {
        const masu_arena_row *a = &m->arena.rows[i];
        masu_memory_row row = {.name = a->name,
                               .kind = "host",
                               .count = a->count,
                               .bytes = a->count * a->element_bytes,
                               .alignment = a->alignment,
                               .offset = a->offset};
        if (n < capacity) rows[n] = row;
    }
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        const masu_buffer_plan *p = &m->plan.buffers[b];
        if (!p->bytes || b == MASU_BUFFER_POISON) continue;
        if (n < capacity) {
            rows[n] = device_row(&m->plan, "buffer", p->name, p->role, p->count, p->memory_bytes,
                                 p->alignment, p->offset);
            rows[n].transient = (uint32_t)masu_buffers[b].of_loading;
        }
        n++;
    }
    for (uint32_t i = 0; i < m->plan.scene.texture_arrays; i++, n++) {
        const masu_texture_plan *t = &m->plan.textures[i];
        if (n < capacity) {
            rows[n] = device_row(&m->plan, "texture", texture_name(t->format), MASU_ROLE_DEVICE,
                                 t->layers, t->bytes, t->alignment, t->offset);
        }
    }
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        const masu_image_plan *p = &m->plan.images[i];
        if (!p->used) continue;
        if (n < capacity) {
            rows[n] = device_row(&m->plan, "image", masu_images[i].name, MASU_ROLE_DEVICE,
                                 (uint64_t)p->width * p->height, p->bytes, p->alignment, p->offset);
            rows[n].transient = !p->persistent;
            rows[n].first_pass = p->first;
            rows[n].last_pass = p->last;
        }
        n++;
    }
    return n;
}

/* Octahedral decoding (Cigolle et al., JCGT 3-2, 2014, section 3.2), 13 bits per axis; the twin of
 * shaders/shared/pack.glsl. */
void masu_unpack_normal(uint32_t texel, float out[3]) {
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
    float length = sqrtf(x * x + y * y + z * z); /* at least 1/sqrt(3) on the octahedron */
    out[0] = x / length;
    out[1] = y / length;
    out[2] = z / length;
}

/* api.c: the public functions for the lifetime of a renderer (masu_init, masu_load, masu_destroy)
 * and for its frames. The other api_*.c implement the rest of masu.h. */
#include "api_governor.h"
#include "api_stats.h"
#include "base/error.h"
#include "device/capabilities.h"
#include "device/device_objects.h"
#include "device/load.h"
#include "device/offers.h"
#include "device/prepare.h"
#include "device/ray_query.h"
#include "device/recordings.h"
#include "device/shaders.h"
#include "plan/compile.h"
#include "quality/governor_desc.h"
#include "renderer.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

/* ---- The host block -------------------------------------------------------------------------- */

/* The only sequence of allocations in the host memory block, for the size query and for init. m is
 * NULL when only counting. */
static void alloc_host(masu_arena *arena, const masu_frame_plan *plan, masu_renderer **m) {
    uint32_t arrays = plan->scene.texture_arrays;
    masu_renderer *r = masu_arena_alloc(arena, "renderer", 1, sizeof *r, MASU_ARENA_ALIGNMENT);
    masu_renderer scrap; /* receives the NULL results of counting */
    masu_renderer *to = r ? r : &scrap;
    masu_texture_plan *textures = masu_arena_alloc(arena, "textures", arrays, sizeof *textures, 8);
    if (r) {
        for (uint32_t i = 0; i < arrays; i++) textures[i] = plan->textures[i];
    }
    to->plan.textures = textures;
    masu_device_alloc(&to->device, arena, plan);
    masu_draws_alloc(&to->draws, arena, plan);
    masu_history_alloc(&to->history, arena, plan);
    masu_camera_path_alloc(&to->camera, arena, plan);
    masu_sun_sky_alloc(&to->sun_sky, arena, plan);
    masu_sdf_alloc(&to->sdf, arena, plan);
    masu_instances_alloc(&to->instances, arena, plan);
    masu_bounds_alloc(&to->bounds, arena, plan);
    masu_models_alloc(&to->models, arena, plan);
    masu_lights_alloc(&to->lights, arena, plan);
    masu_local_shadows_alloc(&to->local_shadows, arena, plan);
    masu_materials_alloc(&to->materials, arena, plan);
    masu_visible_alloc(&to->visible, arena, plan);
    masu_picking_alloc(&to->picking, arena, plan);
    masu_occlusion_alloc(&to->occlusion, arena, plan);
    masu_transparents_alloc(&to->transparents, arena, plan);
    masu_sprites_alloc(&to->sprites, arena, plan);
    masu_reflections_alloc(&to->reflections, arena, plan);
    masu_bounce_alloc(&to->bounce, arena, plan);
    masu_meshes_alloc(&to->meshes, arena, plan);
    masu_post_alloc(&to->post, arena, plan);
    int governed = plan->desc.governor.mode != MASU_GOVERNOR_OFF;
    to->governor = masu_arena_alloc(arena, "governor", governed, sizeof *to->governor, 8);
    if (!governed) to->governor = NULL;
    if (m) *m = r;
}

static masu_result check_host(const masu_frame_plan *plan, uint64_t needed, masu_detail *detail) {
    uint64_t budget = plan->desc.host_budget;
    if (!budget || needed <= budget) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_LIMIT, "host_budget", needed, budget,
                     "host_budget: the plan needs %llu bytes, the budget is %llu",
                     (unsigned long long)needed, (unsigned long long)budget);
}

void masu_copy_scene(masu_renderer *m) {
    const masu_frame_plan *plan = &m->plan;
    if (!plan->desc.scene) return;
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    masu_draws_build(&m->draws, plan, &v);
    masu_camera_path_copy_scene(&m->camera, plan, &v);
    masu_sun_sky_copy_scene(&m->sun_sky, &v);
    masu_sdf_copy_scene(&m->sdf, plan, &v);
    masu_instances_copy_scene(&m->instances, plan, &v);
    masu_bounds_copy_scene(&m->bounds, plan, &m->instances, &v);
    masu_models_copy_scene(&m->models, &m->instances, plan, &v);
    masu_lights_copy_scene(&m->lights, plan, &v);
    masu_materials_copy_scene(&m->materials, plan, &v);
    masu_visible_copy_scene(&m->visible, plan, &v);
    masu_occlusion_copy_scene(&m->occlusion, plan, &v);
    masu_transparents_copy_scene(&m->transparents, plan, &m->draws, &v);
    masu_reflections_copy_scene(&m->reflections, plan, &v);
    masu_bounce_copy_scene(&m->bounce, plan, &v);
    masu_meshes_copy_scene(&m->meshes, plan, &v);
}

void masu_write_scene(masu_renderer *m) {
    if (!m->plan.desc.scene) return;
    masu_scene_view v = masu_scene_data_view(&m->plan.scene);
    masu_visible_write_scene(&m->device, &m->draws, &v);
    masu_picking_write_scene(&m->device, &m->draws, &v);
    masu_local_shadows_write_scene(&m->device, &m->draws, &v);
    masu_occlusion_write_scene(&m->device, &m->draws, &v);
}

/* ---- Plan and query -------------------------------------------------------------------------- */

static masu_result check_desc(const masu_desc *desc, masu_detail *detail) {
    if (!desc) return masu_fail_null(detail, "desc");
    if (desc->bytes != sizeof *desc)
        return masu_fail_bytes(detail, "masu_desc", sizeof *desc, desc->bytes);
    if (desc->scene && !masu_scene_data_of(desc->scene)->blob) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "scene", 1, 0,
                         "scene was not filled by masu_scene_bind");
    }
    return MASU_OK;
}

/* Replaces `plan`, that of `desc` for any device, by the plan that this device can run. */
static masu_result fit_plan(const masu_desc *desc, const masu_vk *vk, masu_frame_plan *plan,
                            masu_detail *detail) {
    const VkPhysicalDeviceLimits *limits = &vk->properties.limits;
    masu_desc possible = *desc;
    const char *computed_for;
    masu_result result = masu_capabilities_fit(&possible, plan, vk, &computed_for, detail);
    if (result) return result;
    result = masu_compile(
        &possible,
        limits->minUniformBufferOffsetAlignment ? limits->minUniformBufferOffsetAlignment : 1,
        limits->minStorageBufferOffsetAlignment ? limits->minStorageBufferOffsetAlignment : 1, plan,
        detail);
    if (!result) plan->computed_for = computed_for;
    return result;
}

/* A plan needs sizes from the driver, so images and buffers are created. The caller keeps or
 * destroys them. */
static masu_result create_plan(const masu_desc *desc, masu_vk *vk, masu_frame_plan *plan,
                               masu_texture_plan textures[MASU_TEXTURE_ARRAYS_MAX],
                               masu_objects *objects, masu_detail *detail) {
    memset(objects, 0, sizeof *objects);
    memset(textures, 0, MASU_TEXTURE_ARRAYS_MAX * sizeof *textures);
    masu_result result = check_desc(desc, detail);
    /* checks without the driver precede the first Vulkan call */
    if (!result) result = masu_compile(desc, 1, 1, plan, detail);
    if (!result) result = masu_governor_check(&desc->governor, plan->desc.rung_count, detail);
    if (!result) result = masu_vk_load(desc, vk, detail);
    if (!result) result = fit_plan(desc, vk, plan, detail);
    if (result) return result;
    masu_ray_sizes(plan, vk);
    result = masu_capabilities_check(plan, vk, detail);
    if (!result) result = masu_code_check(plan, detail);
    if (result) return result;
    plan->textures = textures;
    result = masu_objects_create(vk, plan, objects, detail);
    if (result) masu_objects_destroy(vk, plan, objects);
    return result;
}

/* The features of `supported` that a renderer of `desc` uses. */
static masu_result features_used(const masu_desc *desc, masu_vk *vk, uint32_t supported,
                                 uint32_t *used, masu_detail *detail) {
    VkImage images[MASU_MAX_TARGETS]; /* stand in for images that do not exist yet */
    VkImageView views[MASU_MAX_TARGETS];
    for (uint32_t i = 0; i < MASU_MAX_TARGETS; i++) {
        images[i] = (VkImage)(uintptr_t)1;
        views[i] = (VkImageView)(uintptr_t)1;
    }
    masu_frame_plan plan;
    masu_desc d = *desc;
    d.targets.images = images;
    d.targets.views = views;
    if (!d.targets.count) d.targets.count = 1;
    d.vulkan.texture_compression_bc = (supported & MASU_FEATURE_TEXTURE_COMPRESSION_BC) != 0;
    d.vulkan.ray_query = (supported & MASU_FEATURE_RAY_QUERY) != 0;
    d.vulkan.shader_float16 = (supported & MASU_FEATURE_SHADER_FLOAT16) != 0;
    masu_result result = masu_compile(&d, 1, 1, &plan, detail);
    if (!result) result = masu_governor_check(&d.governor, plan.desc.rung_count, detail);
    if (!result && d.vulkan.ray_query) result = masu_vk_load_ray_limits(&d, vk, detail);
    if (!result) result = fit_plan(&d, vk, &plan, detail);
    if (!result) result = masu_capabilities_check(&plan, vk, detail);
    if (!result) result = masu_code_check(&plan, detail);
    if (result) return result;
    if (!plan.scene.textures) supported &= ~(uint32_t)MASU_FEATURE_SAMPLER_ANISOTROPY;
    if (!plan.scene.textures || !plan.compressed)
        supported &= ~(uint32_t)MASU_FEATURE_TEXTURE_COMPRESSION_BC;
    if (!plan.needs.query) supported &= ~(uint32_t)MASU_FEATURE_RAY_QUERY;
    if (plan.desc.half_floats == MASU_OFF) supported &= ~(uint32_t)MASU_FEATURE_SHADER_FLOAT16;
    *used = supported;
    return MASU_OK;
}

static masu_result query_device(const masu_desc *desc, masu_device_info *out,
                                masu_detail *detail) {
    masu_vk vk;
    masu_device_info found = {0};
    masu_result result = check_desc(desc, detail);
    if (!result) result = masu_vk_load_physical(desc, &vk, detail);
    if (result) return result;
    found.supported = masu_query_offers(&vk, desc->vulkan.get_instance_proc_addr);
    found.used = found.supported;
    if (desc->ray_query == MASU_OFF) found.used &= ~(uint32_t)MASU_FEATURE_RAY_QUERY;
    if (desc->half_floats == MASU_OFF) found.used &= ~(uint32_t)MASU_FEATURE_SHADER_FLOAT16;
    if (desc->scene) result = features_used(desc, &vk, found.supported, &found.used, detail);
    if (result) return result;
    if (found.supported & MASU_FEATURE_SAMPLER_ANISOTROPY)
        found.max_anisotropy = vk.properties.limits.maxSamplerAnisotropy;
    masu_list_extensions(&vk, &found);
    *out = found;
    return MASU_OK;
}

masu_result masu_device_query(const masu_desc *desc, masu_device_info *out, masu_detail *detail) {
    masu_detail own;
    masu_result result = out ? query_device(desc, out, &own) : masu_fail_null(&own, "out");
    return masu_finish_desc(desc, result, &own, detail);
}

static masu_result plan_and_forget(const masu_desc *desc, masu_frame_plan *plan,
                                   uint64_t *host_bytes, masu_detail *detail) {
    masu_vk vk;
    masu_objects objects;
    masu_texture_plan textures[MASU_TEXTURE_ARRAYS_MAX];
    masu_result result = create_plan(desc, &vk, plan, textures, &objects, detail);
    if (result) return result;
    masu_objects_destroy(&vk, plan, &objects);
    masu_arena arena;
    masu_arena_begin(&arena, NULL, 0);
    alloc_host(&arena, plan, NULL);
    *host_bytes = arena.used;
    plan->textures = NULL; /* pointed to this stack frame */
    return check_host(plan, arena.used, detail);
}

masu_result masu_memory_query(const masu_desc *desc, masu_memory *out, masu_detail *detail) {
    masu_detail own;
    masu_frame_plan plan;
    uint64_t host_bytes = 0;
    masu_result result =
        out ? plan_and_forget(desc, &plan, &host_bytes, &own) : masu_fail_null(&own, "out");
    if (!result) masu_memory_export(&plan, host_bytes, out);
    return masu_finish_desc(desc, result, &own, detail);
}

masu_result masu_plan(const masu_desc *desc, masu_plan_info *out, masu_detail *detail) {
    masu_detail own;
    masu_frame_plan plan;
    uint64_t host_bytes = 0;
    masu_result result =
        out ? plan_and_forget(desc, &plan, &host_bytes, &own) : masu_fail_null(&own, "out");
    if (result) return masu_finish_desc(desc, result, &own, detail);
    masu_plan_export(&plan, NULL, out);
    masu_memory_export(&plan, host_bytes, &out->memory);
    return MASU_OK;
}

void masu_plan_of(const masu_renderer *m, masu_plan_info *out) {
    if (!out) return;
    memset(out, 0, sizeof *out);
    if (!m) return;
    masu_plan_export(&m->plan, m->device.pipeline_ns, out);
    masu_memory_export(&m->plan, m->arena.used, &out->memory);
}

/* ---- Life ------------------------------------------------------------------------------------ */

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
    masu_result result = create_plan(desc, &vk, &plan, textures, &objects, detail);
    if (result) return result;
    masu_arena arena;
    masu_renderer *m = NULL;
    masu_arena_begin(&arena, NULL, 0);
    alloc_host(&arena, &plan, NULL);
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
    alloc_host(&arena, &plan, &m);
    m->cookie = MASU_RENDERER_COOKIE;
    m->arena = arena;
    plan.textures = m->plan.textures; /* the allocation above has set it */
    m->plan = plan;
    m->plan.desc.scene = plan.desc.scene ? masu_scene_of(&m->plan.scene) : NULL;
    m->device.vk = vk;
    m->device.plan = &m->plan;
    m->device.objects = objects;
    masu_set_targets(&m->device, &plan.desc.targets);
    masu_timeline_start(&m->timeline);
    if (m->governor) masu_governed_start(m);
    masu_copy_scene(m);
    result = masu_device_create(&m->device, &m->draws, detail);
    if (result) {
        masu_destroy(m);
        return result;
    }
    masu_write_scene(m);
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
    masu_report_offers(&m->device);
    if (m->plan.desc.debug.labels && !m->device.vk.SetDebugUtilsObjectNameEXT) {
        masu_log(
            &m->plan.desc, MASU_LOG_WARNING,
            "debug.labels: VK_EXT_debug_utils is not enabled on the instance, there are no labels");
    }
    uint32_t few = m->plan.desc.deny.storage_buffers, dropped = few & MASU_DROPPED_ANY;
    if (!few) return;
    static const struct {
        uint32_t bit;
        const char *name;
    } features[] = {{MASU_DROPPED_SPECULAR, "traced reflections"},
                    {MASU_DROPPED_BOUNCE, "live bounce"},
                    {MASU_DROPPED_OCCLUSION, "occlusion culling"}};
    for (size_t i = 0; i < sizeof features / sizeof *features; i++) {
        if (!(dropped & features[i].bit)) continue;
        snprintf(text, sizeof text,
                 "maxPerStageDescriptorStorageBuffers is %u, too few for a pass of %s: rungs with "
                 "AUTO lack it",
                 few & ~MASU_DROPPED_ANY, features[i].name);
        masu_log(&m->plan.desc, MASU_LOG_WARNING, text);
    }
}

masu_result masu_init(const masu_desc *desc, void *block, uint64_t block_bytes, masu_renderer **out,
                      masu_detail *detail) {
    masu_detail own;
    if (out) *out = NULL;
    masu_result result =
        out ? init(desc, block, block_bytes, out, &own) : masu_fail_null(&own, "out");
    if (!result) log_box(*out);
    return masu_finish_desc(desc, result, &own, detail);
}

uint32_t masu_version(void) { return MASU_VERSION; }

void masu_destroy(masu_renderer *m) {
    if (!m || m->cookie != MASU_RENDERER_COOKIE) return;
    masu_device_destroy(&m->device);
    m->cookie = 0;
}

masu_result masu_check_lost(const masu_renderer *m, masu_detail *detail) {
    if (!m->lost) return MASU_OK;
    masu_result result =
        masu_fail(detail, MASU_ERROR_DEVICE_LOST, "device", 0, 0,
                  "the device was lost in an earlier call: only masu_destroy is of use");
    if (detail) detail->vulkan = VK_ERROR_DEVICE_LOST;
    return result;
}

static int is_prepared(const masu_renderer *m) { return m->device.steps_done == m->device.steps; }

/* The host may free the blob after the last step of masu_init_step and masu_load. */
static void forget_blob(masu_renderer *m) {
    if (m->loaded && is_prepared(m)) m->plan.scene.blob = NULL;
}

static masu_result check_prepared(masu_renderer *m) {
    if (!m->broken) return masu_check_lost(m, &m->error);
    return masu_fail(&m->error, MASU_ERROR_STATE, "masu_init_step", m->device.steps,
                     m->device.steps_done,
                     "masu_init_step has failed: only masu_destroy is of use");
}

masu_result masu_init_step(masu_renderer *m, masu_progress *progress, masu_detail *detail) {
    if (!m) return masu_finish_null(m, "renderer", detail);
    masu_result result = check_prepared(m);
    if (!result && !is_prepared(m)) {
        result = masu_prepare_step(&m->device, &m->draws, &m->error);
        m->lost |= result == MASU_ERROR_DEVICE_LOST;
        m->broken = result < 0;
        forget_blob(m);
    }
    if (progress)
        *progress = (masu_progress){m->device.steps_done, m->device.steps, m->device.ready};
    return result == MASU_INCOMPLETE ? result : masu_finish(m, result, detail);
}

masu_result masu_load(masu_renderer *m, masu_commands *commands, masu_detail *detail) {
    if (!m || !commands) return masu_finish_null(m, "commands", detail);
    memset(commands, 0, sizeof *commands);
    masu_result result = masu_check_lost(m, &m->error);
    if (result) return masu_finish(m, result, detail);
    if (m->loaded) return MASU_OK;
    masu_load_step step = masu_load_next(&m->device);
    commands->buffer = commands->parts[0] = step.commands;
    commands->part_count = step.commands ? 1 : 0;
    commands->load_bytes = step.bytes;
    commands->load_left = masu_load_bytes(&m->device) - m->device.load_done;
    if (step.more) return MASU_INCOMPLETE;
    m->loaded = 1;
    forget_blob(m);
    return MASU_OK;
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static masu_result check_frame(masu_renderer *m, const masu_frame_desc *frame) {
    const masu_desc *d = &m->plan.desc;
    masu_result result = check_prepared(m);
    if (result) return result;
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
    uint32_t rung = frame->rung == MASU_RUNG_AUTO ? 0 : frame->rung;
    uint32_t ready = masu_ready_rung(&m->device, rung);
    if (ready == UINT32_MAX || (frame->rung != MASU_RUNG_AUTO && ready != rung)) {
        return masu_fail(&m->error, MASU_ERROR_STATE, "masu_init_step", m->device.steps,
                         m->device.steps_done,
                         "rung %u is not ready: masu_init_step has completed %u of %u steps", rung,
                         m->device.steps_done, m->device.steps);
    }
    uint32_t viewports = d->viewport_count ? d->viewport_count : 1;
    if (frame->viewport >= viewports) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "viewport", viewports - 1, frame->viewport,
                         "viewport %u does not exist, the last one is %u", frame->viewport,
                         viewports - 1);
    }
    if (frame->viewport && frame->rung == MASU_RUNG_AUTO) {
        return masu_fail(
            &m->error, MASU_ERROR_ARGUMENT, "rung", d->rung_count - 1, frame->rung,
            "rung is MASU_RUNG_AUTO for viewport %u: the governor's is the first alone",
            frame->viewport);
    }
    if (frame->target >= d->targets.count) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "target", d->targets.count - 1,
                         frame->target, "target %u does not exist, the last one is %u",
                         frame->target, d->targets.count - 1);
    }
    return masu_sprites_check(d, frame, &m->error);
}

/* Each step reads the results of the previous ones, so the order matters. */
masu_result masu_write_frame(masu_renderer *m, masu_frame_data *f) {
    masu_result result = masu_frame_read_time(f, &m->error);
    if (!result) result = masu_camera_read(&m->camera, f, &m->error);
    if (!result) result = masu_sun_sky_read(&m->sun_sky, f, &m->error);
    if (!result) result = masu_sdf_read(&m->sdf, f, &m->error);
    if (!result) result = masu_picking_read(f, &m->error);
    if (!result) result = masu_post_read(f, &m->error);
    if (result) return result;

    masu_sun_sky_write(&m->sun_sky, f);
    masu_history_rebase(&m->history, f);
    masu_reflections_read(&m->reflections, f);
    masu_lights_cast(&m->lights, &m->local_shadows, &m->instances, &m->bounds, f);
    masu_post_write(&m->post, f);
    masu_temporal_read(&m->temporal, &m->history, &m->instances, &m->lights, &m->materials,
                       &m->textures, &m->post, f);
    masu_frame_write_uniforms(&m->history, f);

    masu_shadow_write(&m->shadow, &m->bounds, f);
    masu_views_set(&m->views, &m->bounds, &m->shadow, f);
    masu_lights_write(&m->lights, &m->instances, &m->local_shadows, f);
    masu_materials_write(&m->materials, f);
    masu_bounce_write(&m->bounce, &m->lights, &m->instances, &m->materials, f);

    /* First the readers of which instances have moved, then the instances themselves. */
    masu_reflections_write_instances(&m->reflections, &m->instances, &m->bounds, f);
    masu_occlusion_write_boxes(&m->bounds, &m->instances, f);
    masu_skins_write(&m->models.skins, &m->instances, f);
    masu_meshes_write(&m->meshes, f);
    masu_instances_write(&m->instances, f);

    masu_visible_write(&m->visible, &m->bounds, &m->instances, &m->views, f);
    masu_picking_write(&m->picking, &m->visible, &m->bounds, &m->instances, f);
    masu_transparents_write(&m->transparents, &m->instances, &m->visible, f);
    masu_sprites_write(&m->sprites, &m->transparents, f);
    masu_textures_write_frame(&m->textures, f);
    masu_occlusion_write(&m->occlusion, &m->visible, &m->instances, &m->views, f);
    return MASU_OK;
}

static masu_recording_id recording_id(const masu_frame_data *f) {
    return (masu_recording_id){f->slot, f->desc.viewport, f->desc.rung, f->desc.target};
}

/* The command buffers to submit: of the recording for the frame's slot, rung and target that
 * renders the cascades due. */
static const VkCommandBuffer *pick_recording(const masu_renderer *m, const masu_frame_data *f) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    uint32_t first = masu_recording_of(&m->plan, recording_id(f));
    return &m->device.frames[(first + masu_recording_variant(
                                          rp, f->cascades | f->faces << MASU_DRAWN_FACES)) *
                             m->plan.parts];
}

/* After masu_resize, recordings may be missing. Nothing has been written to the slot yet, so a
 * failing frame has changed nothing. */
static masu_result record_missing(masu_renderer *m, const masu_frame_data *f) {
    masu_result result = masu_record_missing(&m->device, &m->draws, recording_id(f), &m->error);
    m->lost |= result == MASU_ERROR_DEVICE_LOST;
    return result;
}

/* A frame without a scene ignores these members, but they must be valid. */
static masu_result check_plain_frame(masu_renderer *m, masu_frame_data *f) {
    masu_result result = masu_frame_read_time(f, &m->error);
    if (!result) result = masu_sdf_read(&m->sdf, f, &m->error);
    return result ? result : masu_picking_read(f, &m->error);
}

masu_result masu_frame(masu_renderer *m, const masu_frame_desc *frame, masu_commands *commands,
                       masu_detail *detail) {
    if (!m || !frame || !commands) return masu_finish_null(m, frame ? "commands" : "frame", detail);
    if (frame->bytes != sizeof *frame) {
        masu_fail_bytes(&m->error, "masu_frame_desc", sizeof *frame, frame->bytes);
        return masu_finish(m, MASU_ERROR_ARGUMENT, detail);
    }
    if (frame->viewport < m->plan.desc.viewport_count)
        masu_plan_select_viewport(&m->plan, frame->viewport);
    masu_frame_data f = masu_frame_begin(&m->plan, &m->device, &m->draws, &m->timeline, frame);
    masu_timeline timeline = m->timeline;
    masu_governor governor = {0};
    if (m->governor) governor = *m->governor;
    masu_result result = check_frame(m, frame);
    if (!result && m->governor) masu_governed_pick(m, &f);
    uint32_t given = frame->rung;
    if (!result && !is_prepared(m)) { /* as if the host had selected a rung that is ready */
        uint32_t ready = masu_ready_rung(&m->device, f.desc.rung);
        if (ready != f.desc.rung) f.desc.rung = given = ready;
    }
    if (!result) result = record_missing(m, &f);
    if (!result) result = m->plan.desc.scene ? masu_write_frame(m, &f) : check_plain_frame(m, &f);
    if (result) { /* the next attempt needs the times of this slot again */
        m->timeline = timeline;
        if (m->governor) *m->governor = governor;
        return masu_finish(m, result, detail);
    }
    m->rung = f.desc.rung;
    const masu_rung_plan *rp = &m->plan.rungs[f.desc.rung];
    masu_slot_begin(m, f.slot);
    masu_timeline_begin(&m->timeline, f.slot,
                        &(masu_slot){.rung = f.desc.rung,
                                     .viewport = f.desc.viewport,
                                     .render = {rp->render_width, rp->render_height},
                                     .exclude_from_timing = f.desc.exclude_from_timing != 0});
    if (m->governor) masu_governed_begin(m, &f, given);
    if (m->plan.desc.scene) masu_frame_view_write(&m->view, &f);
    const VkCommandBuffer *parts = pick_recording(m, &f);
    *commands = (masu_commands){.buffer = parts[0],
                                .slot = f.slot,
                                .rung = f.desc.rung,
                                .frame = f.number,
                                .part_count = m->plan.parts};
    memcpy(commands->parts, parts, m->plan.parts * sizeof *parts);
    return MASU_OK;
}

/* ---- Queries and changes by the host --------------------------------------------------------- */

masu_result masu_camera_at(const masu_renderer *m, double time, masu_camera *out,
                           masu_detail *detail) {
    masu_detail own;
    if (!m || !out) return masu_finish_null_const(m, "out", detail);
    masu_result result = masu_camera_path_at(&m->camera, &m->plan, time, out);
    if (result == MASU_ERROR_STATE)
        masu_fail(&own, result, "scene", 1, 0, "the scene has no camera path");
    else if (result)
        masu_fail_number(&own, "time", time, "finite numbers of seconds");
    return masu_finish_desc(&m->plan.desc, result, &own, detail);
}

masu_result masu_light_of(const masu_renderer *m, masu_light *out, masu_detail *detail) {
    masu_detail own;
    if (!m || !out) return masu_finish_null_const(m, "out", detail);
    if (!m->plan.needs.scene) {
        masu_fail(&own, MASU_ERROR_STATE, "scene", 1, 0, "there is no scene that has a light");
        return masu_finish_desc(&m->plan.desc, own.result, &own, detail);
    }
    *out = masu_sun_sky_light(&m->sun_sky);
    return MASU_OK;
}

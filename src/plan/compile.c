/* compile.c: see compile.h. */
#include "plan/compile.h"

#include "scene/blob.h"
#include "base/error.h"
#include "plan/buffer_plan.h"
#include "plan/desc.h"
#include "plan/output.h"

#include <math.h>
#include <string.h>

/* ---- One rung -------------------------------------------------------------------------------- */

static void resolve_upscaling(const masu_desc *d, uint32_t r, const masu_rung_plan *rp,
                              masu_needs *needs) {
    const masu_rung *rung = &d->rungs[r];
    int same = rp->render_width == d->output.width && rp->render_height == d->output.height;
    needs->resolve = masu_rung_resolves(d, r);
    needs->upscale = !needs->resolve && (needs->on.upscale || !same);
    needs->easu = rung->easu;
    needs->sharpen = needs->on.sharpen;
    needs->fxaa = !needs->resolve && rung->aa == MASU_AA_FXAA;
    needs->smaa = !needs->resolve && rung->aa >= MASU_AA_SMAA_LOW;
    /* A rung of half size keeps its ratio when the output is resized. */
    int half = d->scene ? rung->scale == 0.5f
                        : 2 * rp->render_width == d->output.width &&
                              2 * rp->render_height == d->output.height;
    needs->twice = half && needs->upscale && needs->easu == MASU_EASU_FULL && !d->debug.exact &&
                   !d->deny.easu_twice && d->half_floats != MASU_ON;
    /* If a resizable output becomes odd, the last pixels of a 2x rung would be offset by one from
     * those of other rungs, whose history it continues. */
    int doubles =
        2 * rp->render_width == d->output.width && 2 * rp->render_height == d->output.height;
    int sized = !d->resizable && !d->viewport_count;
    needs->resolve_twice = needs->resolve && doubles && sized && !d->debug.exact;
    /* Upscaling at ratio 1 with all other effects off: the upscaler runs nevertheless, because
     * some pass must write the target. */
    int writes = needs->scene || needs->upscale || needs->sharpen || needs->fxaa || needs->smaa;
    if (!writes) needs->upscale = 1;
}

static void resolve_shadow(masu_frame_plan *plan, uint32_t r) {
    masu_rung_plan *rp = &plan->rungs[r];
    const masu_rung *rung = &plan->desc.rungs[r];
    rp->variants = 1;
    if (plan->needs.shadow) {
        rp->cascades = masu_at_most(rung->shadow_cascades, plan->scene.shadow_cascades);
        rp->cascade_size = masu_at_most(rung->shadow_resolution, plan->scene.shadow_resolution);
    }
    for (uint32_t k = 0; k < rp->cascades; k++) {
        if (rung->shadow_refresh[k] == 1) continue;
        rp->slow |= 1u << k;
        rp->variants *= 2;
    }
    rp->faces = plan->needs.on.local_shadows;
    if (rp->faces) rp->variants *= 2;
    plan->images[MASU_IMAGE_SHADOW_MAP].persistent |= rp->slow != 0;
    plan->needs.cascades = rp->cascades;
    rp->first_recording = plan->recordings;
    plan->recordings += rp->variants * plan->targets_max;
}

/* The most recently written image of each class, and the one before. resolve() replaces a stand-in
 * by these. 0: there is none. */
typedef struct latest {
    uint8_t image[MASU_CLASS_COUNT], before[MASU_CLASS_COUNT];
} latest;

static uint8_t resolve(uint8_t resource, const latest *l) {
    if (resource < MASU_RESOURCE_END) return resource;
    if (resource < MASU_BEFORE(0)) return l->image[resource - MASU_LATEST(0)];
    return l->before[resource - MASU_BEFORE(0)];
}

/* Whether desc.split gives an image to the host's commands at this split point; 1 for all other
 * accesses. */
static int is_given(const masu_frame_plan *plan, uint32_t pass, uint8_t resource,
                    masu_usage usage) {
    uint32_t split = plan->desc.split;
    if (usage != MASU_READ_HOST && usage != MASU_HOST_DEPTH) return 1;
    if (pass == MASU_PASS_SPLIT_OUTPUT && !(split & MASU_SPLIT_KEEP)) return 0;
    if (resource == MASU_IMAGE_VELOCITY) return (split & MASU_SPLIT_VELOCITY) != 0;
    return 1;
}

/* The velocities of reflections are accessed only if a rung reprojects reflections. */
static int is_composed(const masu_needs *n, uint8_t resource) {
    return n->any_resolved ||
           (resource != MASU_IMAGE_SPECULAR_LENGTH && resource != MASU_IMAGE_VELOCITY);
}

/* Whether the rung has the resource of an access: an image, or a buffer that a pass (not the host)
 * writes. */
static int keeps_access(const masu_frame_plan *plan, uint32_t pass, uint8_t resource,
                        masu_usage usage) {
    const masu_needs *n = &plan->needs;
    switch (resource) {
    case MASU_IMAGE_NONE: return 0;
    case MASU_RESOURCE(MASU_BUFFER_DRAWS): return n->occlusion;
    case MASU_RESOURCE(MASU_BUFFER_VERTICES): return n->skins || n->meshes;
    case MASU_RESOURCE(MASU_BUFFER_TRACE):
        return (n->skins || n->meshes) && n->traced && !n->query;
    case MASU_RESOURCE(MASU_BUFFER_PREVIOUS_VERTICES):
        return (n->skins || n->meshes) && n->velocity;
    case MASU_RESOURCE(MASU_BUFFER_MESH_INDICES): return n->meshes;
    case MASU_RESOURCE(MASU_BUFFER_PROBES): return n->probes;
    case MASU_RESOURCE(MASU_BUFFER_EXPOSURE): return n->metered;
    case MASU_RESOURCE(MASU_BUFFER_LIGHT_TILES): return n->on.light_tiles;
    default: break;
    }
    if (masu_is_buffer(resource)) return 1;
    if (usage == MASU_READ_BACK && !(masu_images[resource].readback & plan->desc.readback))
        return 0;
    if (!is_given(plan, pass, resource, usage)) return 0;
    if (usage == MASU_UPDATE_COLOR) return n->emissive;
    if (pass == MASU_PASS_SPECULAR_COMPOSITE && !is_composed(n, resource)) return 0;
    return masu_has_image(n, resource);
}

static void write_latest(latest *l, uint8_t image) {
    masu_image_class class_of = masu_images[image].class_of;
    if (l->image[class_of] == image) return;
    l->before[class_of] = l->image[class_of];
    l->image[class_of] = image;
}

static void compile_rung(masu_frame_plan *plan, uint32_t r) {
    masu_rung_plan *rp = &plan->rungs[r];
    latest l = {{0}, {0}};
    if (!plan->needs.scene) l.image[MASU_CLASS_COLOR] = MASU_IMAGE_SOURCE;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        const masu_pass_row *row = &masu_passes[p];
        const char *why = "";
        int runs = row->decide(&plan->needs, &why);
        if (r == 0 || (runs && !masu_has_pass(&plan->rungs[0].active, p))) plan->why[p] = why;
        if (!runs) continue;
        masu_add_pass(&rp->active, p);
        for (uint32_t a = 0; a < MASU_PASS_ACCESSES && row->access[a].image; a++) {
            masu_usage usage = (masu_usage)row->access[a].usage;
            uint8_t resource = resolve(row->access[a].image, &l);
            /* Without rough or refracting glass the shader does not read the background, but the
             * binding must be valid. */
            if (p == MASU_PASS_TRANSPARENTS && resource == MASU_IMAGE_BACKGROUND &&
                !plan->needs.rough_glass && !plan->needs.refraction) {
                resource = l.image[MASU_CLASS_DEPTH];
                usage = MASU_READ;
            }
            /* Nor does grading alone read the scattered light. */
            if (p == MASU_PASS_TONEMAP && resource == MASU_IMAGE_BLOOM &&
                plan->needs.post & MASU_POST_GRADE && !(plan->needs.post & MASU_POST_BLOOM))
                resource = MASU_IMAGE_HDR;
            if (!keeps_access(plan, p, resource, usage)) continue;
            rp->access[p][rp->access_count[p]++] = (masu_access){resource, (uint8_t)usage};
            if (masu_usage_writes(usage) && !masu_is_buffer(resource)) write_latest(&l, resource);
        }
    }
    /* The last colour pass writes the target, or the image that is blitted to the target. All
     * accesses to its image are replaced. */
    int blit = l.image[MASU_CLASS_COLOR] == MASU_IMAGE_TARGET;
    uint8_t last = blit ? l.before[MASU_CLASS_COLOR] : l.image[MASU_CLASS_COLOR];
    for (uint32_t p = 0; p < MASU_PASS_COUNT && last != MASU_IMAGE_SOURCE; p++) {
        for (uint32_t a = 0; a < rp->access_count[p]; a++) {
            if (rp->access[p][a].image == last)
                rp->access[p][a].image = blit ? MASU_IMAGE_FINAL : MASU_IMAGE_TARGET;
        }
    }
}

/* ---- All rungs ------------------------------------------------------------------------------- */

#define HOST_READS (VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT)

static VkImageUsageFlags usage_flag(masu_usage usage) {
    switch (usage) {
    case MASU_READ:
    case MASU_READ_LINEAR:
    case MASU_READ_MAP: return VK_IMAGE_USAGE_SAMPLED_BIT;
    case MASU_READ_COPY:
    case MASU_READ_BACK: return VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    case MASU_READ_HOST: return HOST_READS;
    case MASU_HOST_COLOR: return HOST_READS | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    case MASU_HOST_DEPTH: return HOST_READS | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    case MASU_WRITE:
    case MASU_UPDATE: return VK_IMAGE_USAGE_STORAGE_BIT;
    case MASU_PING_PONG: return VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
    case MASU_WRITE_COLOR:
    case MASU_UPDATE_COLOR:
    case MASU_BLEND_COLOR: return VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    case MASU_WRITE_DEPTH:
    case MASU_UPDATE_DEPTH:
    case MASU_KEEP_DEPTH: return VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    case MASU_WRITE_COPY: return VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    case MASU_READ_BUFFER:
    case MASU_READ_VERTICES:
    case MASU_WRITE_BUFFER:
    case MASU_READ_STRUCTURE:
    case MASU_WRITE_STRUCTURE:
    case MASU_USE_NONE: break;
    }
    return 0;
}

static void gather_images(masu_frame_plan *plan) {
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &plan->rungs[r];
        for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
            int writes_target = 0;
            for (uint32_t a = 0; a < rp->access_count[p]; a++) {
                masu_image_id id = (masu_image_id)rp->access[p][a].image;
                writes_target |= id == MASU_IMAGE_TARGET;
                if (id >= MASU_IMAGE_SOURCE) continue; /* owned by the host, or a buffer */
                masu_image_plan *image = &plan->images[id];
                VkExtent2D render = {rp->render_width, rp->render_height};
                VkExtent2D size = masu_plan_extent(plan, masu_images[id].extent, render);
                image->persistent |= masu_images[id].kept;
                if (!image->used) image->first = p;
                if (image->first > p) image->first = p;
                if (image->last < p) image->last = p;
                image->used = 1;
                if (image->width < size.width) image->width = size.width;
                if (image->height < size.height) image->height = size.height;
                image->usage |= usage_flag((masu_usage)rp->access[p][a].usage);
                /* cleared by masu_load */
                if (masu_images[id].layers != 1) image->usage |= VK_IMAGE_USAGE_TRANSFER_DST_BIT;
                if (id == MASU_IMAGE_TEXTURES) /* the host may render into it and copy from it */
                    image->usage |=
                        VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
            }
            if (!masu_has_pass(&rp->active, p) || !masu_has_set(p)) continue;
            plan->pass_sets += writes_target ? plan->targets_max : 1;
        }
    }
}

/* Whether a knob can have an effect in the scene: evaluates the column `use` of its row. Knobs of
 * upscaling are decided per rung. */
static int has_effect(const masu_desc *d, uint32_t r, masu_knob_use use) {
    const masu_scene_data *s = masu_scene_data_of(d->scene);
    switch (use) {
    case MASU_USE_SDF: return s && s->sdf;
    case MASU_USE_POLYGONS: return s && s->instances;
    case MASU_USE_OCCLUDERS: return s && s->placed_occluders;
    case MASU_USE_LODS: return s && s->lods;
    case MASU_USE_AO: return s && s->occlusion_radius > 0.0f;
    case MASU_USE_SHADOWS: return s && s->shadow_cascades;
    case MASU_USE_LIGHTS: return s && s->lights;
    case MASU_USE_LOCAL_SHADOWS: return s && s->shadow_lights && (s->instances || s->sdf_casts);
    case MASU_USE_SPECULAR: return masu_could_trace(d->scene, &d->rungs[r]);
    case MASU_USE_BOUNCE: return s && s->bounce;
    case MASU_USE_ALWAYS:
    case MASU_USE_UPSCALED:
    case MASU_USE_SHARPEN:
    case MASU_USE_SHARPENED: break;
    }
    return 1;
}

/* The switches that a rung has on and that have an effect. `any` accumulates them over the
 * rungs. */
static masu_switches switches_of(const masu_desc *d, uint32_t r, masu_switches *any) {
    masu_switches on;
#define SET_masu_switch(name, use)                                                                 \
    on.name = d->rungs[r].name != MASU_OFF && has_effect(d, r, MASU_USE_##use);                    \
    if (any) any->name |= on.name;
#define SET_masu_easu(name, use)
#define SET_masu_aa(name, use)
#define SET_masu_march(name, use)
#define SET_NUMBER(...)
#define SET_WORD(type, name, zero, use, ...) SET_##type(name, use)
    MASU_KNOBS(SET_NUMBER, SET_WORD)
    return on;
}

static int rung_has_specular(const masu_desc *d, uint32_t r) {
    return switches_of(d, r, NULL).specular;
}

static int rung_has_taa(const masu_desc *d, uint32_t r) {
    return rung_has_specular(d, r) && !d->debug.reference &&
           d->rungs[r].specular_temporal != MASU_OFF && d->rungs[r].specular_taa != MASU_OFF;
}

static int rung_has_fine(const masu_desc *d, uint32_t r) {
    return rung_has_specular(d, r) && !d->debug.reference &&
           d->rungs[r].specular_temporal != MASU_OFF && d->rungs[r].specular_fine != MASU_OFF;
}

/* Whether temporal upscaling reprojects reflections by the motion of the reflected surface. */
static int rung_has_resolved(const masu_desc *d, uint32_t r) {
    return rung_has_fine(d, r) && masu_rung_resolves(d, r);
}

static int any_rung(const masu_desc *d, int (*has)(const masu_desc *d, uint32_t r)) {
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (has(d, r)) return 1;
    }
    return 0;
}

/* Size of the local shadow atlas: room for the maximum number of shadow-casting lights at a time,
 * with one tile of the largest size per spot light and six per point light, but at most
 * rung.local_shadow_atlas. If that is too small, the lights get smaller tiles. */
static void resolve_local_shadows(masu_frame_plan *plan) {
    const masu_desc *d = &plan->desc;
    uint32_t lights = 0, most = MASU_LOCAL_TILE_LEAST,
             viewports = d->viewport_count ? d->viewport_count : 1;
    for (uint32_t r = 0; r < d->rung_count; r++) {
        const masu_rung *rung = &d->rungs[r];
        if (rung->local_shadows == MASU_OFF) continue;
        if (plan->local_faces < rung->local_shadow_faces)
            plan->local_faces = rung->local_shadow_faces;
        if (lights < rung->local_shadow_lights) lights = rung->local_shadow_lights;
        if (most < rung->local_shadow_atlas) most = rung->local_shadow_atlas;
    }
    lights *= viewports;
    if (lights > plan->scene.shadow_lights) lights = plan->scene.shadow_lights;
    uint32_t points = plan->scene.shadow_lights - plan->scene.shadow_spots;
    if (points > lights) points = lights;
    uint64_t tile = MASU_LOCAL_TILE_MOST, area = (points * 6 + (lights - points)) * tile * tile;
    plan->local_lights = lights;
    plan->local_atlas = MASU_LOCAL_TILE_LEAST;
    while (2 * plan->local_atlas <= most && (uint64_t)plan->local_atlas * plan->local_atlas < area)
        plan->local_atlas *= 2;
    plan->local_tile =
        plan->local_atlas < MASU_LOCAL_TILE_MOST ? plan->local_atlas : MASU_LOCAL_TILE_MOST;
}

masu_result masu_compile(const masu_desc *desc, uint64_t uniform_alignment,
                         uint64_t storage_alignment, masu_frame_plan *plan, masu_detail *detail) {
    memset(plan, 0, sizeof *plan);
    plan->computed_for = "";
    plan->desc = masu_desc_resolved(desc);
    masu_desc *d = &plan->desc;
    masu_result result = desc ? masu_desc_check_given(desc, detail) : MASU_OK;
    if (!result) result = masu_desc_check(d, detail);
    if (result) return result;
    if (d->scene) {
        plan->scene = *masu_scene_data_of(d->scene);
        d->scene = masu_scene_of(&plan->scene);
        result = masu_reserve_add(&d->reserve, &plan->scene, &plan->reserve, detail);
    }
    if (!result) result = masu_limits_check(d, detail);
    if (result) return result;
    masu_switches any = {0};
    for (uint32_t r = 0; r < d->rung_count; r++) (void)switches_of(d, r, &any);
    if (d->scene) {
        if (!plan->scene.sdf_occlusion && !plan->scene.shadow_cascades && !any.ao)
            d->readback &= ~(uint32_t)MASU_READBACK_OCCLUSION;
        if (!plan->scene.shadow_cascades) d->readback &= ~(uint32_t)MASU_READBACK_SHADOW_MAP;
        plan->compressed = masu_keeps_blocks(d);
    } else {
        d->readback = 0; /* only a scene has images to read back */
    }
    plan->needs = (masu_needs){
        .scene = d->scene != NULL,
        .raster = d->scene && plan->scene.instances,
        .skins = d->scene && plan->scene.skins,
        .meshes = d->scene && plan->scene.host_meshes,
        .sdf = d->scene && plan->scene.sdf,
        .dynamic = d->scene && plan->scene.sdf_dynamic,
        .timed = d->scene && plan->scene.sdf_timed,
        .moving = d->scene && plan->scene.sdf && !plan->scene.sdf_static,
        .anchored = d->scene && plan->scene.sdf_anchored,
        .sdf_occlusion = d->scene && plan->scene.sdf_occlusion,
        .probes = d->scene && plan->scene.probes && (!plan->scene.probes_unlit || any.bounce),
        .shadow = d->scene && plan->scene.shadow_cascades,
        .transparents = d->scene && plan->scene.transparents,
        .rough_glass = d->scene && plan->scene.transparents && plan->scene.tints & MASU_TINTS_ROUGH,
        .refraction =
            d->scene && plan->scene.transparents && plan->scene.tints & MASU_TINTS_REFRACTED,
        .lights = d->scene && plan->scene.lights,
        .local_shadows = d->scene && any.local_shadows,
        .area_lights =
            d->scene && plan->scene.lights && (plan->scene.area_lights || d->area_lights),
        .shared_lights =
            d->scene && plan->scene.lights && (plan->scene.surface_lights || d->area_lights),
        .sdf_casts = d->scene && any.local_shadows && plan->scene.sdf_casts,
        .surface = d->scene && plan->scene.instances && plan->scene.surfaces,
        .environment = d->scene && plan->scene.environment_size,
        .looks = d->scene && d->instance_looks && plan->scene.instances,
        .sky = d->scene && (plan->scene.analytic_sky || d->analytic_sky),
        .readback = d->readback,
        .split = d->split,
        .reflections = any.specular,
        .traced = (any.specular || any.bounce) && plan->scene.trace_instances,
        .traced_sdf = any.specular && plan->scene.trace_sdf,
        .bounce = any.bounce,
        .bounce_sdf = any.bounce && plan->scene.bounce_sdf,
        .query =
            any.specular && !any.bounce && plan->scene.trace_instances && d->ray_query == MASU_ON,
        .accumulate = d->debug.reference != 0,
        .any_taa = any_rung(d, rung_has_taa),
        .any_fine = any_rung(d, rung_has_fine),
        .any = any,
        .any_resolved = any_rung(d, rung_has_resolved),
        .picking = d->scene && d->picking,
        .post = d->scene ? d->post : 0,
        .metered = d->scene && d->exposure.metered == MASU_ON,
        .velocity = (d->readback & MASU_READBACK_VELOCITY) != 0 ||
                    (d->split & MASU_SPLIT_VELOCITY) != 0 || any.specular ||
                    any_rung(d, masu_rung_resolves),
        .dropped = d->deny.storage_buffers & MASU_DROPPED_ANY,
        .particles = d->scene && (d->reserve.particles || d->reserve.trail_points),
        .decals = d->scene && d->reserve.decals,
        .lines = d->scene && d->reserve.lines,
        .textures = d->scene && (d->reserve.textures || d->reserve.trail_points),
        .texture_writes = d->scene && d->reserve.textures,
        .texture_maps = d->scene && d->reserve.textures && d->mutable_materials &&
                        plan->scene.texture_arrays,
        .blit = !d->targets.storage};
    int emits = plan->needs.raster && (plan->scene.emissions || d->mutable_materials);
    uint32_t attachments = 3u + (plan->needs.surface != 0) + (plan->needs.velocity != 0);
    plan->needs.emission_packed =
        emits && d->deny.color_attachments && attachments > d->deny.color_attachments;
    plan->needs.emissive = emits && !plan->needs.emission_packed;
    plan->needs.sprites = plan->needs.particles || plan->needs.decals || plan->needs.lines;
    for (uint32_t r = 0; r < d->rung_count; r++)
        plan->needs.smoothing |= masu_is_smaa(d->rungs[r].aa);
    plan->parts = 1 + ((d->split & MASU_SPLIT_BEFORE_TONE) != 0) +
                  ((d->split & MASU_SPLIT_AFTER_UPSCALE) != 0);
    plan->most = plan->whole = d->output;
    plan->targets_max = d->resizable && d->scene ? MASU_MAX_TARGETS : d->targets.count;
    masu_output_plan(plan);
    if (plan->needs.query) plan->scene.trace_nodes = 0; /* the driver builds its own BVHs */
    if (!plan->needs.traced) {
        plan->scene.trace_nodes -= plan->scene.host_nodes;
        plan->scene.trace_triangles -= plan->scene.host_nodes ? plan->scene.host_triangles : 0;
        plan->scene.host_nodes = 0;
    }
    masu_shadow_peak(d, &plan->cascades, &plan->cascade_size);
    if (plan->needs.local_shadows) resolve_local_shadows(plan);
    /* Views of the sun: one per cascade, else one for the whole scene. */
    uint32_t suns = plan->needs.shadow ? plan->cascades : d->debug.casters ? 1 : 0;
    plan->views = plan->needs.raster ? 1 + suns : 1;
    plan->needs.occluders = d->scene && plan->scene.placed_occluders > 0;
    for (uint32_t r = 0; r < d->rung_count; r++) {
        plan->lods |= d->scene && plan->scene.lods && d->rungs[r].lod_error > 0.0f;
    }
    if (d->scene) {
        plan->draws = plan->scene.draws + (plan->lods ? plan->scene.lod_draws : 0);
        plan->listed = masu_own_instances(plan) + plan->reserve.listed;
        if (plan->lods) plan->listed += plan->scene.lod_instances + plan->reserve.lod_listed;
    }
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_rung_plan *rp = &plan->rungs[r];
        VkExtent2D size = masu_render_size(d, r);
        rp->render_width = size.width;
        rp->render_height = size.height;
        int same = rp->render_width == d->output.width && rp->render_height == d->output.height;
        if (d->rungs[r].upscale == MASU_OFF && !same) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].upscale", 0, 0,
                             "rungs[%u].upscale is MASU_OFF, but it renders %ux%u for an output of "
                             "%ux%u",
                             r, rp->render_width, rp->render_height, d->output.width,
                             d->output.height);
        }
        plan->needs.rung = &d->rungs[r];
#ifdef MASU_LAB
        plan->needs.march = d->rungs[r].march;
        if (plan->needs.sdf && !(plan->scene.sdf_march & 1u << plan->needs.march)) {
            return masu_fail(detail, MASU_ERROR_SCENE, "rungs[].march", plan->needs.march, 0,
                             "rungs[%u].march is %d, for which the blob has no code (bake with "
                             "--variants)",
                             r, (int)plan->needs.march);
        }
#endif
        plan->needs.on = switches_of(d, r, NULL);
        resolve_upscaling(d, r, rp, &plan->needs);
        const masu_switches *on = &plan->needs.on;
        plan->needs.specular = on->specular;
        int filtered = plan->needs.specular && !plan->needs.accumulate;
        plan->needs.reuse = filtered && on->specular_reuse;
        plan->needs.temporal = filtered && on->specular_temporal;
        plan->needs.filter = filtered && on->specular_filter;
        plan->needs.taa = rung_has_taa(d, r);
        plan->needs.fine = rung_has_fine(d, r);
        plan->needs.occlusion = on->occlusion;
        plan->needs.unculled = d->scene && (plan->scene.max_primitives > MASU_CULL_ROUNDS ||
                                            plan->scene.max_instances > 64 * MASU_CULL_ROUNDS);
        if (plan->needs.occlusion && plan->needs.unculled) {
            if (d->rungs[r].occlusion == MASU_ON) {
                return masu_fail(detail, MASU_ERROR_LIMIT, "rungs[].occlusion",
                                 plan->scene.max_instances, 64 * MASU_CULL_ROUNDS,
                                 "rungs[%u].occlusion takes meshes of at most %d primitives and %d "
                                 "instances, the scene has one of %u or %u",
                                 r, MASU_CULL_ROUNDS, 64 * MASU_CULL_ROUNDS,
                                 plan->scene.max_primitives, plan->scene.max_instances);
            }
            plan->needs.occlusion = 0;
        }
        plan->occlusion |= plan->needs.occlusion;
        resolve_shadow(plan, r);
        plan->needs.casters = plan->needs.occlusion && plan->views > 1;
        plan->needs.receiver_mask = plan->needs.casters && plan->needs.shadow &&
                                rp->slow != (1u << rp->cascades) - 1u;
        if (plan->needs.receiver_mask) plan->receiver_mask = 1;
        compile_rung(plan, r);
    }
    plan->needs.rung = NULL;
    plan->viewport_recordings = plan->recordings;
    if (d->viewport_count) plan->recordings *= d->viewport_count;
    gather_images(plan);
    masu_size_buffers(plan, uniform_alignment, storage_alignment);
    return MASU_OK;
}

/* A rung that upscales keeps doing so, even if a small output makes both sizes equal: the images of
 * both sizes grow with the output, so the allocated memory is always sufficient. */
void masu_plan_resize(masu_frame_plan *plan, VkExtent2D output) {
    plan->desc.output = output;
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        VkExtent2D size = masu_render_size(&plan->desc, r);
        plan->rungs[r].render_width = size.width;
        plan->rungs[r].render_height = size.height;
    }
}

void masu_plan_select_viewport(masu_frame_plan *plan, uint32_t viewport) {
    const masu_viewport *v = &plan->desc.viewports[viewport];
    masu_plan_resize(plan,
                     plan->desc.viewport_count ? (VkExtent2D){v->width, v->height} : plan->whole);
}

/* ---- Export ---------------------------------------------------------------------------------- */

static const char *resource_name(uint8_t resource) {
    if (masu_is_buffer(resource)) return masu_buffers[resource - MASU_RESOURCE(0)].name;
    return masu_images[resource].name;
}

void masu_memory_export(const masu_frame_plan *plan, uint64_t host_bytes, masu_memory *out) {
    memset(out, 0, sizeof *out);
    out->host_bytes = host_bytes;
    out->host_alignment = 64;
    out->unified = (uint32_t)plan->unified;
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) {
        const masu_block_plan *b = &plan->blocks[r];
        if (!b->bytes) continue;
        out->roles[r] = (masu_role_need){b->bytes, b->alignment, b->type_bits, b->type,
                                         (uint32_t)b->host_visible, (uint32_t)b->address};
        out->device_bytes += b->bytes;
    }
    out->transient_unaliased = plan->transient_unaliased;
    out->transient_aliased = plan->transient_aliased;
    out->transient_lower_bound = plan->transient_lower_bound;
}

/* Bytes of the images in the table that this plan omits, at their size in this plan. */
static uint64_t saved_bytes(const masu_frame_plan *plan) {
    VkExtent2D render = {0, 0};
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &plan->rungs[r];
        if (rp->render_width > render.width) render.width = rp->render_width;
        if (rp->render_height > render.height) render.height = rp->render_height;
    }
    uint64_t bytes = 0;
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        if (plan->images[i].used) continue;
        VkExtent2D size = masu_plan_extent(plan, masu_images[i].extent, render);
        bytes += (uint64_t)masu_images[i].layers * size.width * size.height *
                 masu_format_bytes(masu_plan_format(plan, i));
    }
    return bytes;
}

void masu_plan_export(const masu_frame_plan *plan, const uint64_t *pipeline_ns,
                      masu_plan_info *out) {
    memset(out, 0, sizeof *out);
    out->pass_count = MASU_PASS_COUNT;
    out->rung_count = plan->desc.rung_count;
    out->computed_for = plan->computed_for;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        masu_plan_pass *pass = &out->passes[p];
        pass->name = masu_passes[p].name;
        pass->why = plan->why[p];
        if (pipeline_ns) pass->pipeline_ns = pipeline_ns[p];
        int named = 0;
        for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
            const masu_rung_plan *rp = &plan->rungs[r];
            if (!masu_has_pass(&rp->active, p)) continue;
            pass->active |= 1u << r;
            if (masu_passes[p].kind != MASU_PASS_HOST) out->rungs[r].dispatches++;
            if (named) continue;
            named = 1;
            uint32_t reads = 0, writes = 0;
            for (uint32_t a = 0; a < rp->access_count[p]; a++) {
                const char *name = resource_name(rp->access[p][a].image);
                masu_usage usage = (masu_usage)rp->access[p][a].usage;
                if (masu_usage_writes(usage) && writes < 6) pass->writes[writes++] = name;
                if ((!masu_usage_writes(usage) || usage == MASU_PING_PONG) && reads < 12)
                    pass->reads[reads++] = name;
            }
        }
    }
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        out->rungs[r].render_width = plan->rungs[r].render_width;
        out->rungs[r].render_height = plan->rungs[r].render_height;
        out->rungs[r].barriers = plan->rungs[r].barriers;
        out->rungs[r].ratio = plan->desc.governor.costs[r];
        out->rungs[r].flip = plan->desc.flips[r];
    }
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        const masu_image_plan *image = &plan->images[i];
        out->images[out->image_count++] =
            (masu_plan_image){masu_images[i].name, masu_plan_format(plan, i), image->width,
                              image->height,       (uint32_t)image->used,     image->bytes,
                              image->offset,       image->first,              image->last,
                              masu_plan_layers(plan, i)};
    }
    out->saved_bytes = saved_bytes(plan);
}

/* desc.c: see desc.h. */
#include "plan/desc.h"

#include "base/error.h"
#include "plan/output.h"
#include "plan/reserve.h"
#include "quality/governor_desc.h"
#include "quality/knobs.h"
#include "quality/ladder.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

/* For all live textures in total, and for all textures written per frame. */
#define TEXTURE_TEXELS_MAX ((uint64_t)1 << 28)
#define TEXTURE_BYTES_MAX ((uint32_t)1 << 28)

/* ---- Defaults -------------------------------------------------------------------------------- */

/* Render size for a scale: rounded to nearest, at least 1. 1080 lines give 864 at 0.8 and 432 at
 * 0.4. */
static uint32_t scaled(uint32_t size, float scale) {
    double v = floor((double)size * (double)scale + 0.5);
    if (!(v >= 1.0)) return 1u; /* NaN too; the check rejects it later */
    return v > (double)size ? size : (uint32_t)v;
}

VkExtent2D masu_render_size(const masu_desc *d, uint32_t r) {
    if (!d->scene) return (VkExtent2D){d->source.width, d->source.height};
    float scale = d->rungs[r].scale;
    return (VkExtent2D){scaled(d->output.width, scale), scaled(d->output.height, scale)};
}

/* Not with debug.reference, which averages rays at a fixed position in each pixel. */
int masu_rung_resolves(const masu_desc *d, uint32_t r) {
    return d->scene && !d->debug.reference && d->rungs[r].temporal == MASU_ON;
}

int masu_could_trace(const masu_scene *scene, const masu_rung *rung) {
    if (!scene) return 0;
    const masu_scene_data *s = masu_scene_data_of(scene);
    return s->reflections && s->glossiest < rung->specular_cutoff;
}

static void fill(masu_switch *word, masu_switch with) {
    if (*word == MASU_AUTO) *word = with;
}

/* Each change of viewport invalidates the history. Images that the host draws before the tone curve
 * have no velocities and would leave trails. A host that reads velocities may have its own temporal
 * filter. */
static int is_history_interrupted(const masu_desc *d) {
    return d->viewport_count > 1 || (d->split & ~(uint32_t)MASU_SPLIT_AFTER_UPSCALE) != 0;
}

/* Whether consecutive frames are likely to be rendered, as temporal upscaling requires: assumed if
 * there is a governor. */
static int are_frames_consecutive(const masu_desc *d) {
    return d->scene && d->governor.mode != MASU_GOVERNOR_OFF && !d->debug.reference &&
           !is_history_interrupted(d);
}

/* Default of `temporal`: off if the rung sets another upscaler or anti-aliasing. */
static masu_switch temporal_of(const masu_desc *d, const masu_rung *rung) {
    int silent = rung->upscale == MASU_AUTO && rung->easu == MASU_EASU_AUTO &&
                 rung->sharpen == MASU_AUTO && rung->aa == MASU_AA_AUTO;
    return are_frames_consecutive(d) && silent ? MASU_ON : MASU_OFF;
}

/* With temporal upscaling, a longer accumulation of reflections would blur them and add lag:
 * docs/design/17-temporal-upscaling.md. */
#define SPECULAR_FRAMES_RESOLVED 8u

/* Defaults that depend on other knobs. */
static void resolve_dependent_knobs(masu_rung *rung) {
    /* With temporal upscaling, accumulated samples average better than the hits of neighbouring
     * pixels, and a second temporal filter blurs: docs/design/17-temporal-upscaling.md. */
    masu_switch alone = rung->temporal == MASU_ON ? MASU_OFF : MASU_ON;
    fill(&rung->specular_reuse, alone);
    fill(&rung->specular_taa, alone);
}

/* Defaults that depend on the sizes and on the enum values. RCAS cannot restore detail after
 * bilinear upscaling. */
static void resolve_sizes(masu_desc *d, uint32_t r) {
    masu_rung *rung = &d->rungs[r];
    VkExtent2D size = masu_render_size(d, r);
    int same = size.width == d->output.width && size.height == d->output.height;
    fill(&rung->upscale, same ? MASU_OFF : MASU_ON);
    int upscales = !masu_rung_resolves(d, r) && (rung->upscale == MASU_ON || !same);
    fill(&rung->sharpen, upscales && rung->easu != MASU_EASU_BILINEAR ? MASU_ON : MASU_OFF);
}

/* Features for which a device may have too few storage buffers remain AUTO, which drops them on
 * such a device; ON is an error there. Features that the scene cannot use are OFF. */
static void resolve_scene(const masu_desc *d, masu_rung *rung) {
    if (!masu_scene_data_of(d->scene)->placed_occluders) fill(&rung->occlusion, MASU_OFF);
    if (!masu_could_trace(d->scene, rung)) fill(&rung->specular, MASU_OFF);
    if (!masu_scene_data_of(d->scene)->bounce) fill(&rung->bounce, MASU_OFF);
}

masu_desc masu_desc_resolved(const masu_desc *desc) {
    masu_desc d;
    memset(&d, 0, sizeof d);
    if (desc) d = *desc;
    if (d.frames_in_flight == 0) d.frames_in_flight = 2;
    int given = d.rung_count != 0;
    masu_ladder_defaults(&d);
    int smooth =
        d.scene && masu_scene_data_of(d.scene)->smooth_edges && !are_frames_consecutive(&d);
    /* The default rungs follow the rules of MASU_AUTO. */
    for (uint32_t r = 0; !given && is_history_interrupted(&d) && r < d.rung_count; r++) {
        if (d.rungs[r].temporal != MASU_ON) continue;
        d.rungs[r].temporal = MASU_OFF;
        if (smooth) d.rungs[r].aa = MASU_AA_SMAA_HIGH;
    }
    if (d.rung_count == 0) {
        d.rung_count = 3;
        d.rungs[0] = (masu_rung){.scale = 1.0f};
        d.rungs[1] = (masu_rung){.scale = 0.8f};
        d.rungs[2] = (masu_rung){.scale = 0.4f};
        for (uint32_t r = 0; smooth && r < d.rung_count; r++) d.rungs[r].aa = MASU_AA_SMAA_HIGH;
    }
    for (uint32_t r = 0; r < d.rung_count && r < MASU_MAX_RUNGS; r++) {
        fill(&d.rungs[r].temporal, temporal_of(&d, &d.rungs[r]));
        if (d.rungs[r].temporal == MASU_ON && d.rungs[r].specular_frames == 0)
            d.rungs[r].specular_frames = SPECULAR_FRAMES_RESOLVED;
        masu_rung_defaults(&d.rungs[r]);
        if (d.rungs[r].specular_cutoff == 0.0f && d.scene)
            d.rungs[r].specular_cutoff = masu_scene_specular_cutoff(d.scene);
        resolve_dependent_knobs(&d.rungs[r]);
        if (d.scene) resolve_scene(&d, &d.rungs[r]);
        if ((d.scene || d.source.view) && d.output.width && d.output.height) resolve_sizes(&d, r);
    }
    if (!d.scene) {
        d.reserve.particles = d.reserve.decals = d.reserve.lines = 0;
        d.reserve.trail_points = d.reserve.textures = 0;
    }
    if (d.reserve.textures) {
        VkExtent2D *size = &d.reserve.texture_size;
        if (!size->width) size->width = 256;
        if (!size->height) size->height = 256;
        uint64_t bytes = 4 * (uint64_t)size->width * size->height;
        if (!d.reserve.texture_bytes && bytes <= TEXTURE_BYTES_MAX)
            d.reserve.texture_bytes = (uint32_t)bytes;
    }
    masu_governor_defaults(&d.governor, d.rung_count);
    if (d.targets.format == VK_FORMAT_UNDEFINED) d.targets.format = VK_FORMAT_R8G8B8A8_UNORM;
    if (d.targets.final_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
        d.targets.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    }
    masu_output_defaults(&d);
    return d;
}

masu_result masu_desc_resolve(const masu_desc *desc, masu_desc *out, masu_detail *detail) {
    masu_detail own;
    masu_result result = MASU_OK;
    if (!desc || !out)
        result = masu_fail_null(&own, desc ? "out" : "desc");
    else if (desc->bytes != sizeof *desc)
        result = masu_fail_bytes(&own, "masu_desc", sizeof *desc, desc->bytes);
    else
        *out = masu_desc_resolved(desc);
    return masu_finish_desc(desc, result, &own, detail);
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static masu_result bad_range(masu_detail *detail, const char *what, uint64_t given, uint64_t low,
                             uint64_t high) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, given < low ? low : high, given,
                     "%s is %llu, allowed are %llu to %llu", what, (unsigned long long)given,
                     (unsigned long long)low, (unsigned long long)high);
}

static int final_layout_known(VkImageLayout layout) {
    return layout == VK_IMAGE_LAYOUT_GENERAL || layout == VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL ||
           layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL ||
           layout == VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL ||
           layout == VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
}

static masu_result check_viewports(const masu_desc *d, masu_detail *detail) {
    if (d->viewport_count > MASU_MAX_VIEWPORTS)
        return bad_range(detail, "viewport_count", d->viewport_count, 0, MASU_MAX_VIEWPORTS);
    if (d->viewport_count && !d->scene) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "viewport_count", 0, d->viewport_count,
                         "viewport_count is %u, without a scene there are none", d->viewport_count);
    }
    for (uint32_t i = 0; i < d->viewport_count; i++) {
        const masu_viewport *v = &d->viewports[i];
        int inside = v->width >= 1 && v->height >= 1 && v->width <= d->output.width &&
                     v->height <= d->output.height && v->x <= d->output.width - v->width &&
                     v->y <= d->output.height - v->height;
        if (!inside) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "viewports", d->output.width, v->width,
                             "viewports[%u] is %ux%u at %u, %u: not within the output of %ux%u", i,
                             v->width, v->height, v->x, v->y, d->output.width, d->output.height);
        }
        if (!d->targets.storage || (!v->x && !v->y)) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "viewports", 0, v->x ? v->x : v->y,
                         "viewports[%u] is at %u, %u: of storage targets they begin at 0, 0", i,
                         v->x, v->y);
    }
    return MASU_OK;
}

static masu_result check_reserve(const masu_desc *d, masu_detail *detail) {
    const masu_reserve *r = &d->reserve;
    if (r->models > MASU_RESERVE_MODELS_MAX)
        return bad_range(detail, "reserve.models", r->models, 0, MASU_RESERVE_MODELS_MAX);
    if (r->lights > MASU_RESERVE_LIGHTS_MAX)
        return bad_range(detail, "reserve.lights", r->lights, 0, MASU_RESERVE_LIGHTS_MAX);
    if (r->particles > MASU_PARTICLES_MAX)
        return bad_range(detail, "reserve.particles", r->particles, 0, MASU_PARTICLES_MAX);
    if (r->decals > MASU_DECALS_MAX)
        return bad_range(detail, "reserve.decals", r->decals, 0, MASU_DECALS_MAX);
    if (r->lines > MASU_LINES_MAX)
        return bad_range(detail, "reserve.lines", r->lines, 0, MASU_LINES_MAX);
    if (r->mesh_upload > MASU_MESH_UPLOAD_MAX)
        return bad_range(detail, "reserve.mesh_upload", r->mesh_upload, 0, MASU_MESH_UPLOAD_MAX);
    uint64_t meshes = 0;
    for (uint32_t k = 0; k < MASU_MAX_MESH_KINDS; k++) {
        const masu_mesh_kind *kind = &r->meshes[k];
        meshes += kind->meshes;
        if (!kind->meshes) continue;
        if (kind->vertices < 3 || kind->vertices > MASU_MESH_VERTICES_MAX)
            return bad_range(detail, "reserve.meshes[].vertices", kind->vertices, 3,
                             MASU_MESH_VERTICES_MAX);
        if (kind->triangles < 1 || kind->triangles > MASU_MESH_TRIANGLES_MAX)
            return bad_range(detail, "reserve.meshes[].triangles", kind->triangles, 1,
                             MASU_MESH_TRIANGLES_MAX);
    }
    if (meshes > MASU_RESERVE_MESHES_MAX)
        return bad_range(detail, "reserve.meshes[].meshes",
                         (uint32_t)(meshes < UINT32_MAX ? meshes : UINT32_MAX), 0,
                         MASU_RESERVE_MESHES_MAX);
    if (r->trail_points > MASU_PARTICLES_MAX)
        return bad_range(detail, "reserve.trail_points", r->trail_points, 0, MASU_PARTICLES_MAX);
    if (r->textures > MASU_LIVE_TEXTURES_MAX)
        return bad_range(detail, "reserve.textures", r->textures, 0, MASU_LIVE_TEXTURES_MAX);
    if (!r->textures) return MASU_OK;
    const VkExtent2D size = r->texture_size;
    if (size.width > MASU_TEXTURE_SIZE_MAX)
        return bad_range(detail, "reserve.texture_size.width", size.width, 1,
                         MASU_TEXTURE_SIZE_MAX);
    if (size.height > MASU_TEXTURE_SIZE_MAX)
        return bad_range(detail, "reserve.texture_size.height", size.height, 1,
                         MASU_TEXTURE_SIZE_MAX);
    uint64_t texels = (uint64_t)r->textures * size.width * size.height;
    if (texels > TEXTURE_TEXELS_MAX) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.textures", texels, TEXTURE_TEXELS_MAX,
                         "reserve.textures: %u of %ux%u texels are %llu, the limit is %llu",
                         r->textures, size.width, size.height, (unsigned long long)texels,
                         (unsigned long long)TEXTURE_TEXELS_MAX);
    }
    if (r->texture_bytes < 4 || r->texture_bytes > TEXTURE_BYTES_MAX)
        return bad_range(detail, "reserve.texture_bytes", r->texture_bytes, 4, TEXTURE_BYTES_MAX);
    return MASU_OK;
}

static masu_result check_post(const masu_desc *d, masu_detail *detail) {
    if (!d->scene) return MASU_OK;
    if (d->post & ~(uint32_t)MASU_POST_ALL)
        return bad_range(detail, "post", d->post, 0, MASU_POST_ALL);
    if (d->lut_size && (d->lut_size < 2 || d->lut_size > MASU_LUT_MAX))
        return bad_range(detail, "lut_size", d->lut_size, 2, MASU_LUT_MAX);
    if (d->lut_size && !(d->post & MASU_POST_GRADE)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "lut_size", 0, d->lut_size,
                         "lut_size is %u, but desc.post does not have MASU_POST_GRADE",
                         d->lut_size);
    }
    return MASU_OK;
}

static masu_result bad_split(const masu_desc *d, uint32_t needed, const char *problem,
                             masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, "split", needed, d->split, "split is %u: %s",
                     d->split, problem);
}

static masu_result check_split(const masu_desc *d, masu_detail *detail) {
    uint32_t split = d->split;
    if (split & ~(uint32_t)MASU_SPLIT_ALL)
        return bad_range(detail, "split", split, 0, MASU_SPLIT_ALL);
    if (!d->scene && (split & ~(uint32_t)MASU_SPLIT_AFTER_UPSCALE))
        return bad_split(d, MASU_SPLIT_AFTER_UPSCALE,
                         "without a scene there is MASU_SPLIT_AFTER_UPSCALE alone", detail);
    if ((split & MASU_SPLIT_KEEP) && !(split & MASU_SPLIT_AFTER_UPSCALE))
        return bad_split(d, MASU_SPLIT_AFTER_UPSCALE,
                         "MASU_SPLIT_KEEP keeps for MASU_SPLIT_AFTER_UPSCALE", detail);
    if ((split & MASU_SPLIT_VELOCITY) && !(split & (MASU_SPLIT_BEFORE_TONE | MASU_SPLIT_KEEP)))
        return bad_split(d, MASU_SPLIT_BEFORE_TONE,
                         "MASU_SPLIT_VELOCITY takes MASU_SPLIT_BEFORE_TONE or MASU_SPLIT_KEEP",
                         detail);
    return MASU_OK;
}

static masu_result without_effect(const char *what, uint32_t count, const char *counted,
                                  masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 1, count,
                     "%s is %u, but %s[0] is not zero: count it, or leave it zero", what, count,
                     counted);
}

masu_result masu_desc_check_given(const masu_desc *given, masu_detail *detail) {
    static const masu_rung no_rung;
    static const masu_viewport no_viewport;
    const masu_source *s = &given->source;
    if (!given->rung_count && memcmp(&given->rungs[0], &no_rung, sizeof no_rung) != 0)
        return without_effect("rung_count", 0, "rungs", detail);
    if (!given->viewport_count &&
        memcmp(&given->viewports[0], &no_viewport, sizeof no_viewport) != 0)
        return without_effect("viewport_count", 0, "viewports", detail);
    if (given->scene && !s->view && (s->width || s->height || s->format)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "source", 0, s->width,
                         "scene and source exclude each other: source is %ux%u, format %d",
                         s->width, s->height, (int)s->format);
    }
    return MASU_OK;
}

/* Reflections are OFF in every resolved rung if the scene cannot have them. */
static masu_result check_keep(const masu_desc *d, masu_detail *detail) {
    uint32_t keep = d->governor.keep;
    if (keep & ~MASU_KEEP_ALL) return bad_range(detail, "governor.keep", keep, 0, MASU_KEEP_ALL);
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (!masu_could_trace(d->scene, &d->rungs[r])) keep &= ~MASU_KEEP_REFLECTIONS;
        uint32_t off = masu_rung_drops(&d->rungs[r], keep);
        if (!off) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "governor.keep", 0, keep,
                         "rungs[%u].%s is OFF, but governor.keep has %s", r,
                         off & MASU_KEEP_REFLECTIONS ? "specular" : "ao",
                         off & MASU_KEEP_REFLECTIONS ? "MASU_KEEP_REFLECTIONS"
                                                     : "MASU_KEEP_OCCLUSION");
    }
    return MASU_OK;
}

masu_result masu_desc_check(const masu_desc *d, masu_detail *detail) {
    const masu_targets *t = &d->targets;
    if (d->rung_count > MASU_MAX_RUNGS) {
        return bad_range(detail, "rung_count", d->rung_count, 1, MASU_MAX_RUNGS);
    }
    if (d->frames_in_flight > MASU_MAX_FLIGHT) {
        return bad_range(detail, "frames_in_flight", d->frames_in_flight, 1, MASU_MAX_FLIGHT);
    }
    if (d->output.width < 1 || d->output.width > 16384) {
        return bad_range(detail, "output.width", d->output.width, 1, 16384);
    }
    if (d->output.height < 1 || d->output.height > 16384) {
        return bad_range(detail, "output.height", d->output.height, 1, 16384);
    }
    if (t->count < 1 || t->count > MASU_MAX_TARGETS) {
        return bad_range(detail, "targets.count", t->count, 1, MASU_MAX_TARGETS);
    }
    for (uint32_t i = 0; i < t->count; i++) {
        if (!t->images || !t->images[i] || (t->storage && (!t->views || !t->views[i]))) {
            const char *what = t->images && t->images[i] ? "targets.views" : "targets.images";
            return masu_fail(detail, MASU_ERROR_ARGUMENT, what, t->count, i, "%s[%u] is NULL", what,
                             i);
        }
    }
    if (!final_layout_known(t->final_layout)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "targets.final_layout",
                         VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, (uint64_t)t->final_layout,
                         "targets.final_layout %d is none that a picture is used in",
                         (int)t->final_layout);
    }
    if (!d->scene && !d->source.view) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "scene", 1, 0,
                         "neither scene nor source.view is given: nothing to draw");
    }
    if (d->scene && d->source.view) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "source.view", 0, 1,
                         "scene and source.view exclude each other");
    }
    if (d->source.view) {
        if (d->source.width < 1 || d->source.width > 16384) {
            return bad_range(detail, "source.width", d->source.width, 1, 16384);
        }
        if (d->source.height < 1 || d->source.height > 16384) {
            return bad_range(detail, "source.height", d->source.height, 1, 16384);
        }
    }
    if (d->vulkan.max_anisotropy != 0.0f &&
        !(d->vulkan.max_anisotropy >= 1.0f && d->vulkan.max_anisotropy <= 64.0f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "vulkan.max_anisotropy", 1, 0,
                         "vulkan.max_anisotropy is %g, allowed are 0 and 1 to 64",
                         (double)d->vulkan.max_anisotropy);
    }
    if (!(fabsf(d->debug.mip_bias) <= 16.0f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "debug.mip_bias", 0, 0,
                         "debug.mip_bias is %g levels, allowed are -16 to 16",
                         (double)d->debug.mip_bias);
    }
    if ((unsigned)d->ladder > MASU_ON)
        return bad_range(detail, "ladder", (unsigned)d->ladder, MASU_AUTO, MASU_ON);
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (d->flips[r] >= 0.0f && d->flips[r] <= 1.0f) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "flips", 0, 0,
                         "flips[%u] is %g, allowed are 0 to 1", r, (double)d->flips[r]);
    }
    if ((unsigned)d->debug.share_rays > MASU_ON)
        return bad_range(detail, "debug.share_rays", (unsigned)d->debug.share_rays, MASU_AUTO,
                         MASU_ON);
    if ((unsigned)d->half_floats > MASU_ON)
        return bad_range(detail, "half_floats", (unsigned)d->half_floats, MASU_AUTO, MASU_ON);
    if ((unsigned)d->ray_query > MASU_ON)
        return bad_range(detail, "ray_query", (unsigned)d->ray_query, MASU_AUTO, MASU_ON);
    if (d->readback & ~(uint32_t)MASU_READBACK_ALL) {
        return bad_range(detail, "readback", d->readback, 0, MASU_READBACK_ALL);
    }
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_result result = masu_rung_check(&d->rungs[r], r, detail);
        if (result) return result;
    }
    if (d->first_rung >= d->rung_count) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "first_rung", d->rung_count - 1,
                         d->first_rung, "first_rung %u does not exist, the last one is %u",
                         d->first_rung, d->rung_count - 1);
    }
    if (d->load_step && d->load_step < MASU_LOAD_STEP_MIN) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "load_step", MASU_LOAD_STEP_MIN, d->load_step,
                         "load_step is %llu bytes, allowed are 0 and %u or more",
                         (unsigned long long)d->load_step, MASU_LOAD_STEP_MIN);
    }
    masu_result result = check_keep(d, detail);
    if (!result) result = check_split(d, detail);
    if (!result) result = check_viewports(d, detail);
    if (!result) result = check_reserve(d, detail);
    if (!result) result = check_post(d, detail);
    return result ? result : masu_output_check(d, detail);
}

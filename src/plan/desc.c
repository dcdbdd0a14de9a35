/* desc.c: see desc.h. */
#include "plan/desc.h"

#include "scene/blob.h"
#include "base/error.h"
#include "quality/governor.h"
#include "quality/ladder.h"
#include "frame/transparents.h"
#include "scene/lod.h"
#include "plan/output.h"

#include <math.h>
#include <string.h>

/* Of ambient occlusion: where more samples stop to pay (docs/DESIGN.md). */
#define MASU_AO_SLICES 2
#define MASU_AO_STEPS 8

/* Of reflections: neighbours of the two filters, and how far back the mean over frames reaches. */
#define MASU_REUSE_TAPS 8
#define MASU_FILTER_TAPS 12
#define MASU_SPECULAR_FRAMES 32

/* ---- Defaults -------------------------------------------------------------------------------- */

masu_desc masu_desc_resolved(const masu_desc *desc) {
    masu_desc d;
    memset(&d, 0, sizeof d);
    if (desc) d = *desc;
    if (d.frames_in_flight == 0) d.frames_in_flight = 2;
    masu_ladder_defaults(&d);
    if (d.rung_count == 0) {
        d.rung_count = 3;
        d.rungs[0] = (masu_rung){.scale = 1.0f};
        d.rungs[1] = (masu_rung){.scale = 0.8f, .sharpness = 0.2f};
        d.rungs[2] = (masu_rung){.scale = 0.4f, .sharpness = 0.2f};
    }
    for (uint32_t r = 0; r < d.rung_count && r < MASU_MAX_RUNGS; r++) {
        if (d.rungs[r].scale == 0.0f) d.rungs[r].scale = 1.0f;
        if (d.rungs[r].march_steps == 0) d.rungs[r].march_steps = MASU_MARCH_STEPS_MAX;
        for (uint32_t k = 0; k < MASU_MAX_CASCADES; k++) {
            if (d.rungs[r].shadow_refresh[k] == 0) d.rungs[r].shadow_refresh[k] = 1;
        }
        if (d.rungs[r].ao_slices == 0) d.rungs[r].ao_slices = MASU_AO_SLICES;
        if (d.rungs[r].ao_steps == 0) d.rungs[r].ao_steps = MASU_AO_STEPS;
        if (d.rungs[r].lod_error == 0.0f) d.rungs[r].lod_error = MASU_LOD_PIXELS;
        if (d.rungs[r].specular_cutoff == 0.0f && d.scene)
            d.rungs[r].specular_cutoff = d.scene->specular_cutoff;
        if (d.rungs[r].specular_reuse_taps == 0) d.rungs[r].specular_reuse_taps = MASU_REUSE_TAPS;
        if (d.rungs[r].specular_filter_taps == 0) d.rungs[r].specular_filter_taps = MASU_FILTER_TAPS;
        if (d.rungs[r].specular_frames == 0) d.rungs[r].specular_frames = MASU_SPECULAR_FRAMES;
    }
    masu_governor_defaults(&d.governor, d.rung_count);
    if (d.targets.format == VK_FORMAT_UNDEFINED) d.targets.format = VK_FORMAT_R8G8B8A8_UNORM;
    if (d.targets.final_layout == VK_IMAGE_LAYOUT_UNDEFINED) {
        d.targets.final_layout = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    }
    masu_output_defaults(&d);
    return d;
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static masu_result bad_range(masu_detail *detail, const char *what, uint64_t given, uint64_t low,
                             uint64_t high) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, given < low ? low : high, given,
                     "%s is %llu, allowed are %llu to %llu", what, (unsigned long long)given,
                     (unsigned long long)low, (unsigned long long)high);
}

static masu_result check_rung(const masu_desc *d, uint32_t r, masu_detail *detail) {
    const masu_rung *rung = &d->rungs[r];
    if (!(rung->scale > 0.0f && rung->scale <= 1.0f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].scale", 1, 0,
                         "rungs[%u].scale is %g, allowed are 0 < scale <= 1", r,
                         (double)rung->scale);
    }
    if (!(rung->sharpness >= 0.0f && rung->sharpness <= 64.0f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].sharpness", 0, 0,
                         "rungs[%u].sharpness is %g stops, allowed are 0 to 64", r,
                         (double)rung->sharpness);
    }
    if (!(rung->lod_error >= -1e9f && rung->lod_error <= 1e9f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].lod_error", 1, 0,
                         "rungs[%u].lod_error is %g pixels, allowed are -1e9 to 1e9", r,
                         (double)rung->lod_error);
    }
    if (rung->march_steps > MASU_MARCH_STEPS_MAX) {
        return bad_range(detail, "rungs[].march_steps", rung->march_steps, 1, MASU_MARCH_STEPS_MAX);
    }
    if ((unsigned)rung->march > MASU_MARCH_UNPRUNED) {
        return bad_range(detail, "rungs[].march", (unsigned)rung->march, 0, MASU_MARCH_UNPRUNED);
    }
    if ((unsigned)rung->easu > MASU_EASU_BILINEAR) {
        return bad_range(detail, "rungs[].easu", (unsigned)rung->easu, 0, MASU_EASU_BILINEAR);
    }
    if (rung->shadow_cascades > MASU_MAX_CASCADES) {
        return bad_range(detail, "rungs[].shadow_cascades", rung->shadow_cascades, 0,
                         MASU_MAX_CASCADES);
    }
    if (rung->shadow_resolution && (rung->shadow_resolution < MASU_SHADOW_SIZE_MIN ||
                                    rung->shadow_resolution > MASU_SHADOW_SIZE_MAX)) {
        return bad_range(detail, "rungs[].shadow_resolution", rung->shadow_resolution,
                         MASU_SHADOW_SIZE_MIN, MASU_SHADOW_SIZE_MAX);
    }
    if (!(rung->shadow_distance >= 0.0f && rung->shadow_distance <= 1e30f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].shadow_distance", 0, 0,
                         "rungs[%u].shadow_distance is %g m, allowed are 0 to 1e30", r,
                         (double)rung->shadow_distance);
    }
    for (uint32_t k = 0; k < MASU_MAX_CASCADES; k++) {
        if (rung->shadow_refresh[k] <= MASU_MAX_REFRESH) continue;
        return bad_range(detail, "rungs[].shadow_refresh", rung->shadow_refresh[k], 0,
                         MASU_MAX_REFRESH);
    }
    if (!(rung->specular_cutoff >= 0.0f && rung->specular_cutoff <= 1.0f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].specular_cutoff", 0, 0,
                         "rungs[%u].specular_cutoff is %g, allowed are 0 to 1", r,
                         (double)rung->specular_cutoff);
    }
    if (rung->ao_slices > MASU_AO_SLICES_MAX)
        return bad_range(detail, "rungs[].ao_slices", rung->ao_slices, 0, MASU_AO_SLICES_MAX);
    if (rung->ao_steps > MASU_AO_STEPS_MAX)
        return bad_range(detail, "rungs[].ao_steps", rung->ao_steps, 0, MASU_AO_STEPS_MAX);
    const struct {
        const char *name;
        uint32_t value, most;
    } counts[] = {{"rungs[].specular_reuse_taps", rung->specular_reuse_taps, MASU_REUSE_TAPS_MAX},
                  {"rungs[].specular_filter_taps", rung->specular_filter_taps, MASU_FILTER_TAPS_MAX},
                  {"rungs[].specular_frames", rung->specular_frames, MASU_SPECULAR_FRAMES_MAX}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        if (counts[i].value > counts[i].most)
            return bad_range(detail, counts[i].name, counts[i].value, 0, counts[i].most);
    }
    if ((unsigned)rung->aa > MASU_AA_SMAA_ULTRA)
        return bad_range(detail, "rungs[].aa", (unsigned)rung->aa, 0, MASU_AA_SMAA_ULTRA);
    const masu_switch switches[] = {rung->upscale,   rung->sharpen,     rung->frustum,
                                    rung->occlusion, rung->light_tiles, rung->ao,
                                    rung->specular,  rung->specular_reuse,
                                    rung->specular_temporal, rung->specular_filter,
                                    rung->specular_taa, rung->specular_fine,
                                    rung->fuse};
    static const char *const names[] = {"rungs[].upscale",   "rungs[].sharpen",
                                        "rungs[].frustum",   "rungs[].occlusion",
                                        "rungs[].light_tiles", "rungs[].ao",
                                        "rungs[].specular",  "rungs[].specular_reuse",
                                        "rungs[].specular_temporal", "rungs[].specular_filter",
                                        "rungs[].specular_taa", "rungs[].specular_fine",
                                        "rungs[].fuse"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if ((unsigned)switches[i] <= MASU_ON) continue;
        return bad_range(detail, names[i], (unsigned)switches[i], MASU_AUTO, MASU_ON);
    }
    return MASU_OK;
}

static int final_layout_known(VkImageLayout layout) {
    return layout == VK_IMAGE_LAYOUT_GENERAL || layout == VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL ||
           layout == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL ||
           layout == VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL ||
           layout == VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
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
    if ((unsigned)d->half_floats > MASU_ON)
        return bad_range(detail, "half_floats", (unsigned)d->half_floats, MASU_AUTO, MASU_ON);
    if ((unsigned)d->ray_query > MASU_ON)
        return bad_range(detail, "ray_query", (unsigned)d->ray_query, MASU_AUTO, MASU_ON);
    if (d->readback & ~(uint32_t)MASU_READBACK_ALL) {
        return bad_range(detail, "readback", d->readback, 0, MASU_READBACK_ALL);
    }
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_result result = check_rung(d, r, detail);
        if (result) return result;
    }
    return masu_output_check(d, detail);
}

void masu_shadow_peak(const masu_desc *d, uint32_t *cascades, uint32_t *size) {
    *cascades = *size = 0;
    for (uint32_t r = 0; r < d->rung_count && d->scene && d->scene->shadow_cascades; r++) {
        uint32_t n = masu_at_most(d->rungs[r].shadow_cascades, d->scene->shadow_cascades);
        uint32_t s = masu_at_most(d->rungs[r].shadow_resolution, d->scene->shadow_resolution);
        if (*cascades < n) *cascades = n;
        if (*size < s) *size = s;
    }
}

int masu_takes_blocks(const masu_desc *d) {
    return d->vulkan.texture_compression_bc && !d->deny.compressed_textures;
}

uint64_t masu_scene_texture_bytes(const masu_desc *d) {
    if (!d->scene) return 0;
    return masu_takes_blocks(d) ? d->scene->texture_bytes : d->scene->texture_bytes_decoded;
}

masu_result masu_limits_check(const masu_desc *d, masu_detail *detail) {
    const masu_scene *s = d->scene;
    uint32_t cascades, cascade_size;
    masu_shadow_peak(d, &cascades, &cascade_size);
    if (!s) return MASU_OK;
    const struct {
        const char *name;
        uint64_t limit, needed;
    } rows[] = {{"limits.vertices", d->limits.vertices, s->vertices},
                {"limits.indices", d->limits.indices, s->indices},
                {"limits.materials", d->limits.materials, s->materials},
                {"limits.instances", d->limits.instances, s->instances},
                {"limits.sdf_params", d->limits.sdf_params, s->sdf_params},
                {"limits.probes", d->limits.probes, s->probes},
                {"limits.shadow_cascades", d->limits.shadow_cascades, cascades},
                {"limits.shadow_resolution", d->limits.shadow_resolution, cascade_size},
                {"limits.textures", d->limits.textures, s->textures},
                {"limits.texture_bytes", d->limits.texture_bytes, masu_scene_texture_bytes(d)},
                {"limits.lights", d->limits.lights, s->lights},
                {"limits.transparents", d->limits.transparents, s->transparents},
                {"limits.trace_triangles", d->limits.trace_triangles, s->trace_triangles},
                {"limits.trace_instances", d->limits.trace_instances, s->trace_instances},
                {"limits.transparents", MASU_TRANSPARENTS_MAX, s->transparents},
                {"transparent texture sets", MASU_TRANSPARENT_SETS_MAX, s->transparent_sets},
                {"transparents times their texture sets", MASU_TRANSPARENT_DRAWS_MAX,
                 (uint64_t)s->transparents * s->transparent_sets}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (rows[i].limit && rows[i].needed > rows[i].limit) {
            return masu_fail(detail, MASU_ERROR_LIMIT, rows[i].name, rows[i].needed, rows[i].limit,
                             "%s: the scene needs %llu, the limit is %llu", rows[i].name,
                             (unsigned long long)rows[i].needed, (unsigned long long)rows[i].limit);
        }
    }
    return MASU_OK;
}

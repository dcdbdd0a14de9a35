/* pipelines.c: descriptor set layouts derived from the rows of the frame table, shader modules,
 * pipelines, and the render passes of graphics rows. Modules live only while their pipeline is
 * built. */
#include "device/pipelines.h"

#include "base/error.h"
#include "device/bind.h"
#include "plan/ray_buffers.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"

#include "ao_comp.spv.h"
#include "ao_upsample_comp.spv.h"
#include "bilinear_comp.spv.h"
#include "bilinear_deep_comp.spv.h"
#include "bilinear_scene_comp.spv.h"
#include "cascade_frag.spv.h"
#include "cascade_masked_vert.spv.h"
#include "cascade_vert.spv.h"
#include "compact_comp.spv.h"
#include "cull_comp.spv.h"
#include "easu_bytes_comp.spv.h"
#include "easu_comp.spv.h"
#include "easu_deep_comp.spv.h"
#include "easu_fast_bytes_comp.spv.h"
#include "easu_fast_bytes_half_comp.spv.h"
#include "easu_fast_comp.spv.h"
#include "easu_fast_deep_comp.spv.h"
#include "easu_fast_deep_counted_comp.spv.h"
#include "easu_fast_deep_half_comp.spv.h"
#include "easu_fast_deep_half_counted_comp.spv.h"
#include "easu_fast_half_comp.spv.h"
#include "easu_fast_scene_comp.spv.h"
#include "easu_fast_scene_counted_comp.spv.h"
#include "easu_fast_scene_half_comp.spv.h"
#include "easu_fast_scene_half_counted_comp.spv.h"
#include "easu_scene_comp.spv.h"
#include "expose_comp.spv.h"
#include "fsr1_bytes_comp.spv.h"
#include "fsr1_comp.spv.h"
#include "fsr1_scene_comp.spv.h"
#include "fullscreen_vert.spv.h"
#include "fxaa_comp.spv.h"
#include "fxaa_deep_comp.spv.h"
#include "fxaa_scene_comp.spv.h"
#include "gbuffer_frag.spv.h"
#include "gbuffer_surface_frag.spv.h"
#include "gbuffer_textured_frag.spv.h"
#include "gbuffer_textured_surface_frag.spv.h"
#include "gbuffer_textured_velocity_frag.spv.h"
#include "gbuffer_textured_velocity_surface_frag.spv.h"
#include "gbuffer_textured_velocity_vert.spv.h"
#include "gbuffer_textured_vert.spv.h"
#include "gbuffer_velocity_frag.spv.h"
#include "gbuffer_velocity_surface_frag.spv.h"
#include "gbuffer_velocity_vert.spv.h"
#include "gbuffer_vert.spv.h"
#include "light_comp.spv.h"
#include "light_lights_comp.spv.h"
#include "light_lights_probes_comp.spv.h"
#include "light_lights_probes_surface_comp.spv.h"
#include "light_lights_surface_comp.spv.h"
#include "light_occluded_comp.spv.h"
#include "light_occluded_lights_comp.spv.h"
#include "light_occluded_lights_probes_comp.spv.h"
#include "light_occluded_lights_probes_surface_comp.spv.h"
#include "light_occluded_lights_surface_comp.spv.h"
#include "light_occluded_probes_comp.spv.h"
#include "light_occluded_probes_surface_comp.spv.h"
#include "light_occluded_surface_comp.spv.h"
#include "light_probes_comp.spv.h"
#include "light_probes_surface_comp.spv.h"
#include "light_surface_comp.spv.h"
#include "light_tiles_comp.spv.h"
#include "meter_comp.spv.h"
#include "occluders_frag.spv.h"
#include "occluders_vert.spv.h"
#include "probes_comp.spv.h"
#include "rcas_bytes_comp.spv.h"
#include "rcas_comp.spv.h"
#include "rcas_deep_comp.spv.h"
#include "rcas_scene_comp.spv.h"
#include "receivers_comp.spv.h"
#include "shadow_comp.spv.h"
#include "smaa_blend_comp.spv.h"
#include "smaa_blend_deep_comp.spv.h"
#include "smaa_blend_scene_comp.spv.h"
#include "smaa_edges_comp.spv.h"
#include "smaa_edges_deep_comp.spv.h"
#include "smaa_edges_scene_comp.spv.h"
#include "specular_accumulate_comp.spv.h"
#include "specular_composite_comp.spv.h"
#include "specular_composite_fine_comp.spv.h"
#include "specular_composite_fine_surface_comp.spv.h"
#include "specular_composite_surface_comp.spv.h"
#include "specular_filter_comp.spv.h"
#include "specular_fine_comp.spv.h"
#include "specular_guide_comp.spv.h"
#include "specular_guide_surface_comp.spv.h"
#include "specular_keep_comp.spv.h"
#include "specular_keep_fine_comp.spv.h"
#include "specular_keep_steady_comp.spv.h"
#include "specular_query_comp.spv.h"
#include "specular_query_masks_comp.spv.h"
#include "specular_rays_comp.spv.h"
#include "specular_rays_surface_comp.spv.h"
#include "specular_reuse_comp.spv.h"
#include "specular_shade_comp.spv.h"
#include "specular_shade_lights_comp.spv.h"
#include "specular_shade_lights_probes_comp.spv.h"
#include "specular_shade_lights_probes_sun_comp.spv.h"
#include "specular_shade_lights_sun_comp.spv.h"
#include "specular_shade_probes_comp.spv.h"
#include "specular_shade_probes_sun_comp.spv.h"
#include "specular_shade_sdf_comp.spv.h"
#include "specular_shade_sdf_lights_comp.spv.h"
#include "specular_shade_sdf_lights_probes_comp.spv.h"
#include "specular_shade_sdf_lights_probes_sun_comp.spv.h"
#include "specular_shade_sdf_lights_sun_comp.spv.h"
#include "specular_shade_sdf_probes_comp.spv.h"
#include "specular_shade_sdf_probes_sun_comp.spv.h"
#include "specular_shade_sdf_sun_comp.spv.h"
#include "specular_shade_sun_comp.spv.h"
#include "specular_shade_textures_comp.spv.h"
#include "specular_shade_textures_lights_comp.spv.h"
#include "specular_shade_textures_lights_probes_comp.spv.h"
#include "specular_shade_textures_lights_probes_sun_comp.spv.h"
#include "specular_shade_textures_lights_sun_comp.spv.h"
#include "specular_shade_textures_probes_comp.spv.h"
#include "specular_shade_textures_probes_sun_comp.spv.h"
#include "specular_shade_textures_sun_comp.spv.h"
#include "specular_taa_comp.spv.h"
#include "specular_temporal_comp.spv.h"
#include "specular_trace_comp.spv.h"
#include "specular_trace_masks_comp.spv.h"
#include "tonemap_comp.spv.h"
#include "tonemap_deep_comp.spv.h"
#include "tonemap_deep_metered_comp.spv.h"
#include "tonemap_metered_comp.spv.h"
#include "transparents_frag.spv.h"
#include "transparents_sun_frag.spv.h"
#include "transparents_textured_frag.spv.h"
#include "transparents_textured_sun_frag.spv.h"
#include "transparents_textured_vert.spv.h"
#include "transparents_vert.spv.h"
#include "velocity_comp.spv.h"

#include <string.h>

typedef struct spirv {
    const uint32_t *words;
    uint64_t bytes;
} spirv;

static spirv scene_code(const masu_device *m, uint32_t pass) {
    masu_scene_view v = masu_scene_look(m->plan->desc.scene);
    return (spirv){v.code[masu_passes[pass].code].words,
                   v.code[masu_passes[pass].code].count * sizeof(uint32_t)};
}

#define SPIRV(name) {masu_spv_##name, sizeof masu_spv_##name}

/* The builds of what draws polygons, and of what lights, by what they do: bits that add up. */
enum { GBUFFER_TEXTURED = 1, GBUFFER_VELOCITY = 2, GBUFFER_SURFACE = 4, GBUFFER_BUILDS = 8 };
enum {
    LIGHT_OCCLUDED = 1,
    LIGHT_SURFACE = 2,
    LIGHT_LIGHTS = 4,
    LIGHT_PROBES = 8,
    LIGHT_BUILDS = 16
};

static const spirv gbuffer_vertex[GBUFFER_SURFACE] = {
    [0] = SPIRV(gbuffer_vert),
    [GBUFFER_TEXTURED] = SPIRV(gbuffer_textured_vert),
    [GBUFFER_VELOCITY] = SPIRV(gbuffer_velocity_vert),
    [GBUFFER_TEXTURED | GBUFFER_VELOCITY] = SPIRV(gbuffer_textured_velocity_vert)};

static const spirv gbuffer_fragment[GBUFFER_BUILDS] = {
    [0] = SPIRV(gbuffer_frag),
    [GBUFFER_TEXTURED] = SPIRV(gbuffer_textured_frag),
    [GBUFFER_VELOCITY] = SPIRV(gbuffer_velocity_frag),
    [GBUFFER_TEXTURED | GBUFFER_VELOCITY] = SPIRV(gbuffer_textured_velocity_frag),
    [GBUFFER_SURFACE] = SPIRV(gbuffer_surface_frag),
    [GBUFFER_SURFACE | GBUFFER_TEXTURED] = SPIRV(gbuffer_textured_surface_frag),
    [GBUFFER_SURFACE | GBUFFER_VELOCITY] = SPIRV(gbuffer_velocity_surface_frag),
    [GBUFFER_SURFACE | GBUFFER_TEXTURED | GBUFFER_VELOCITY] =
        SPIRV(gbuffer_textured_velocity_surface_frag)};

static const spirv light_builds[LIGHT_BUILDS] = {
    [0] = SPIRV(light_comp),
    [LIGHT_SURFACE] = SPIRV(light_surface_comp),
    [LIGHT_PROBES] = SPIRV(light_probes_comp),
    [LIGHT_PROBES | LIGHT_SURFACE] = SPIRV(light_probes_surface_comp),
    [LIGHT_LIGHTS] = SPIRV(light_lights_comp),
    [LIGHT_LIGHTS | LIGHT_SURFACE] = SPIRV(light_lights_surface_comp),
    [LIGHT_LIGHTS | LIGHT_PROBES] = SPIRV(light_lights_probes_comp),
    [LIGHT_LIGHTS | LIGHT_PROBES | LIGHT_SURFACE] = SPIRV(light_lights_probes_surface_comp),
    [LIGHT_OCCLUDED] = SPIRV(light_occluded_comp),
    [LIGHT_OCCLUDED | LIGHT_SURFACE] = SPIRV(light_occluded_surface_comp),
    [LIGHT_OCCLUDED | LIGHT_PROBES] = SPIRV(light_occluded_probes_comp),
    [LIGHT_OCCLUDED | LIGHT_PROBES | LIGHT_SURFACE] = SPIRV(light_occluded_probes_surface_comp),
    [LIGHT_OCCLUDED | LIGHT_LIGHTS] = SPIRV(light_occluded_lights_comp),
    [LIGHT_OCCLUDED | LIGHT_LIGHTS | LIGHT_SURFACE] = SPIRV(light_occluded_lights_surface_comp),
    [LIGHT_OCCLUDED | LIGHT_LIGHTS | LIGHT_PROBES] = SPIRV(light_occluded_lights_probes_comp),
    [LIGHT_OCCLUDED | LIGHT_LIGHTS | LIGHT_PROBES | LIGHT_SURFACE] = SPIRV(light_occluded_lights_probes_surface_comp)};

static spirv light_code(const masu_device *m, uint32_t pass) {
    uint32_t build = pass == MASU_PASS_LIGHT_OCCLUDED ? LIGHT_OCCLUDED : 0;
    if (m->plan->needs.surface) build |= LIGHT_SURFACE;
    if (m->plan->needs.probes) build |= LIGHT_PROBES;
    if (m->plan->needs.lights) build |= LIGHT_LIGHTS;
    return light_builds[build];
}

/* Those that look at surfaces; and what shades hits, by what it looks up. */
static const spirv specular_guide_builds[] = {SPIRV(specular_guide_comp),
                                              SPIRV(specular_guide_surface_comp)};
static const spirv specular_rays_builds[] = {SPIRV(specular_rays_comp),
                                             SPIRV(specular_rays_surface_comp)};
static const spirv specular_composite_builds[] = {SPIRV(specular_composite_comp),
                                                  SPIRV(specular_composite_surface_comp),
                                                  SPIRV(specular_composite_fine_comp),
                                                  SPIRV(specular_composite_fine_surface_comp)};

static const spirv specular_keep_builds[] = {SPIRV(specular_keep_comp),
                                             SPIRV(specular_keep_steady_comp)};


static spirv specular_code(const masu_device *m, const spirv builds[2]) {
    return builds[m->plan->needs.surface ? 1 : 0];
}

/* With holes of masks, or without. */
static const spirv trace_builds[] = {SPIRV(specular_trace_comp), SPIRV(specular_trace_masks_comp)};
static const spirv query_builds[] = {SPIRV(specular_query_comp), SPIRV(specular_query_masks_comp)};

enum { SHADE_SUN = 1, SHADE_LIGHTS = 2, SHADE_PROBES = 4, SHADE_TEXTURES = 8, SHADE_BUILDS = 16 };
static const spirv shade_builds[SHADE_BUILDS] = {
    SPIRV(specular_shade_comp),
    SPIRV(specular_shade_sun_comp),
    SPIRV(specular_shade_lights_comp),
    SPIRV(specular_shade_lights_sun_comp),
    SPIRV(specular_shade_probes_comp),
    SPIRV(specular_shade_probes_sun_comp),
    SPIRV(specular_shade_lights_probes_comp),
    SPIRV(specular_shade_lights_probes_sun_comp),
    SPIRV(specular_shade_textures_comp),
    SPIRV(specular_shade_textures_sun_comp),
    SPIRV(specular_shade_textures_lights_comp),
    SPIRV(specular_shade_textures_lights_sun_comp),
    SPIRV(specular_shade_textures_probes_comp),
    SPIRV(specular_shade_textures_probes_sun_comp),
    SPIRV(specular_shade_textures_lights_probes_comp),
    SPIRV(specular_shade_textures_lights_probes_sun_comp)};

/* The same where rays meet nothing but the SDF. */
static const spirv shade_sdf_builds[SHADE_TEXTURES] = {
    SPIRV(specular_shade_sdf_comp),
    SPIRV(specular_shade_sdf_sun_comp),
    SPIRV(specular_shade_sdf_lights_comp),
    SPIRV(specular_shade_sdf_lights_sun_comp),
    SPIRV(specular_shade_sdf_probes_comp),
    SPIRV(specular_shade_sdf_probes_sun_comp),
    SPIRV(specular_shade_sdf_lights_probes_comp),
    SPIRV(specular_shade_sdf_lights_probes_sun_comp)};

static spirv shade_code(const masu_device *m) {
    const spirv *builds = m->plan->needs.traced ? shade_builds : shade_sdf_builds;
    return builds[(m->plan->needs.shadow ? SHADE_SUN : 0) |
                        (m->plan->needs.lights ? SHADE_LIGHTS : 0) |
                        (m->plan->scene.trace_colors ? SHADE_TEXTURES : 0) |
                        (m->plan->needs.probes ? SHADE_PROBES : 0)];
}

static uint32_t gbuffer_build(const masu_device *m) {
    return (m->plan->needs.velocity ? GBUFFER_VELOCITY : 0u) |
           (m->plan->needs.surface ? GBUFFER_SURFACE : 0u);
}

/* Of display-encoded colour: of a source image in any format; in 8 bits; of a scene in 8 bits; in 16-bit
 * floats. */
enum { COLOR_SOURCE, COLOR_BYTES, COLOR_SCENE, COLOR_DEEP, COLOR_BUILDS };
static const spirv easu_builds[COLOR_BUILDS] = {SPIRV(easu_comp), SPIRV(easu_bytes_comp),
                                                SPIRV(easu_scene_comp), SPIRV(easu_deep_comp)};
static const spirv rcas_builds[COLOR_BUILDS] = {SPIRV(rcas_comp), SPIRV(rcas_bytes_comp),
                                                SPIRV(rcas_scene_comp), SPIRV(rcas_deep_comp)};
/* Not in floats: what it has between the two is 8 bits. */
static const spirv fsr1_builds[COLOR_DEEP] = {SPIRV(fsr1_comp), SPIRV(fsr1_bytes_comp),
                                              SPIRV(fsr1_scene_comp)};
/* The same in halves; of scenes each with counters, too. */
static const spirv easu_fast_builds[2][COLOR_BUILDS + 2] = {
    {SPIRV(easu_fast_comp), SPIRV(easu_fast_bytes_comp), SPIRV(easu_fast_scene_comp),
     SPIRV(easu_fast_deep_comp), SPIRV(easu_fast_scene_counted_comp),
     SPIRV(easu_fast_deep_counted_comp)},
    {SPIRV(easu_fast_half_comp), SPIRV(easu_fast_bytes_half_comp), SPIRV(easu_fast_scene_half_comp),
     SPIRV(easu_fast_deep_half_comp), SPIRV(easu_fast_scene_half_counted_comp),
     SPIRV(easu_fast_deep_half_counted_comp)}};

/* Of what does not ask whether its source has 8 bits. */
static const spirv bilinear_builds[] = {SPIRV(bilinear_comp), SPIRV(bilinear_scene_comp),
                                        SPIRV(bilinear_deep_comp)};
static const spirv fxaa_builds[] = {SPIRV(fxaa_comp), SPIRV(fxaa_scene_comp), SPIRV(fxaa_deep_comp)};
static const spirv smaa_edges_builds[] = {SPIRV(smaa_edges_comp), SPIRV(smaa_edges_scene_comp),
                                          SPIRV(smaa_edges_deep_comp)};
static const spirv smaa_blend_builds[] = {SPIRV(smaa_blend_comp), SPIRV(smaa_blend_scene_comp),
                                          SPIRV(smaa_blend_deep_comp)};
static const spirv tonemap_builds[] = {SPIRV(tonemap_comp), SPIRV(tonemap_deep_comp),
                                       SPIRV(tonemap_metered_comp),
                                       SPIRV(tonemap_deep_metered_comp)};

/* Whether all that a pass samples, in any rung, is colour of 8 bits. */
static int reads_bytes(const masu_device *m, uint32_t pass) {
    for (uint32_t r = 0; r < m->plan->desc.rung_count; r++) {
        const masu_rung_plan *rp = &m->plan->rungs[r];
        if (!(rp->active & MASU_PASS_BIT(pass))) continue;
        for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
            masu_access access = rp->access[pass][a];
            if (access.usage != MASU_READ) continue;
            VkFormat format = access.image == MASU_IMAGE_SOURCE ? m->plan->desc.source.format
                                                                : masu_plan_format(m->plan, access.image);
            if (format != VK_FORMAT_R8G8B8A8_UNORM && format != VK_FORMAT_B8G8R8A8_UNORM &&
                format != VK_FORMAT_A8B8G8R8_UNORM_PACK32)
                return 0;
        }
    }
    return 1;
}

static uint32_t color_build(const masu_device *m) {
    return !m->plan->needs.scene ? 0 : m->plan->deep ? 2 : 1;
}

static uint32_t color_bytes_build(const masu_device *m, uint32_t pass) {
    if (m->plan->needs.scene) return m->plan->deep ? COLOR_DEEP : COLOR_SCENE;
    return reads_bytes(m, pass) ? COLOR_BYTES : COLOR_SOURCE;
}

static spirv easu_fast_code(const masu_device *m) {
    uint32_t build = color_bytes_build(m, MASU_PASS_EASU_FAST);
    /* Without a scene there are no counters. */
    if (m->plan->desc.debug.counters && m->plan->needs.scene) build += COLOR_BUILDS - COLOR_SCENE;
    return easu_fast_builds[m->plan->desc.half_floats == MASU_ON][build];
}

/* Compute code by pass: the scene's own where the row names a section of the blob. */
static spirv compute_code(const masu_device *m, uint32_t pass) {
    if (masu_passes[pass].code) return scene_code(m, pass);
    switch (pass) {
    case MASU_PASS_CULL:
    case MASU_PASS_CULL_CASTERS: return (spirv){masu_spv_cull_comp, sizeof masu_spv_cull_comp};
    case MASU_PASS_COMPACT:
    case MASU_PASS_COMPACT_CASTERS: return (spirv){masu_spv_compact_comp, sizeof masu_spv_compact_comp};
    case MASU_PASS_VELOCITY: return (spirv){masu_spv_velocity_comp, sizeof masu_spv_velocity_comp};
    case MASU_PASS_RECEIVERS:
        return (spirv){masu_spv_receivers_comp, sizeof masu_spv_receivers_comp};
    case MASU_PASS_PROBES: return (spirv){masu_spv_probes_comp, sizeof masu_spv_probes_comp};
    case MASU_PASS_LIGHT_TILES:
        return (spirv){masu_spv_light_tiles_comp, sizeof masu_spv_light_tiles_comp};
    case MASU_PASS_SHADOW: return (spirv){masu_spv_shadow_comp, sizeof masu_spv_shadow_comp};
    case MASU_PASS_AO: return (spirv){masu_spv_ao_comp, sizeof masu_spv_ao_comp};
    case MASU_PASS_AO_UPSAMPLE:
        return (spirv){masu_spv_ao_upsample_comp, sizeof masu_spv_ao_upsample_comp};
    case MASU_PASS_LIGHT:
    case MASU_PASS_LIGHT_OCCLUDED: return light_code(m, pass);
    case MASU_PASS_SPECULAR_GUIDE: return specular_code(m, specular_guide_builds);
    case MASU_PASS_SPECULAR_RAYS: return specular_code(m, specular_rays_builds);
    case MASU_PASS_SPECULAR_COMPOSITE: 
        return specular_code(m, specular_composite_builds + (m->plan->needs.finest ? 2 : 0));
    case MASU_PASS_SPECULAR_TRACE:
        return trace_builds[masu_ray_masks(&m->plan->scene)];
    case MASU_PASS_SPECULAR_QUERY: return query_builds[masu_ray_masks(&m->plan->scene)];
    case MASU_PASS_SPECULAR_SHADE: return shade_code(m);
    case MASU_PASS_SPECULAR_REUSE:
        return (spirv){masu_spv_specular_reuse_comp, sizeof masu_spv_specular_reuse_comp};
    case MASU_PASS_SPECULAR_TEMPORAL:
        return (spirv){masu_spv_specular_temporal_comp, sizeof masu_spv_specular_temporal_comp};
    case MASU_PASS_SPECULAR_FINE:
        return (spirv){masu_spv_specular_fine_comp, sizeof masu_spv_specular_fine_comp};
    case MASU_PASS_SPECULAR_KEEP_FINE:
        return (spirv){masu_spv_specular_keep_fine_comp, sizeof masu_spv_specular_keep_fine_comp};
    case MASU_PASS_SPECULAR_FILTER:
        return (spirv){masu_spv_specular_filter_comp, sizeof masu_spv_specular_filter_comp};
    case MASU_PASS_SPECULAR_TAA:
        return (spirv){masu_spv_specular_taa_comp, sizeof masu_spv_specular_taa_comp};
    case MASU_PASS_SPECULAR_KEEP: return specular_keep_builds[m->plan->needs.steady ? 1 : 0];
    case MASU_PASS_SPECULAR_ACCUMULATE:
        return (spirv){masu_spv_specular_accumulate_comp, sizeof masu_spv_specular_accumulate_comp};
    case MASU_PASS_METER: return (spirv){masu_spv_meter_comp, sizeof masu_spv_meter_comp};
    case MASU_PASS_EXPOSE: return (spirv){masu_spv_expose_comp, sizeof masu_spv_expose_comp};
    case MASU_PASS_TONEMAP:
        return tonemap_builds[(m->plan->deep ? 1 : 0) | (m->plan->needs.metered ? 2 : 0)];
    case MASU_PASS_FXAA: return fxaa_builds[color_build(m)];
    case MASU_PASS_SMAA_EDGES: return smaa_edges_builds[color_build(m)];
    case MASU_PASS_SMAA_BLEND: return smaa_blend_builds[color_build(m)];
    case MASU_PASS_EASU: return easu_builds[color_bytes_build(m, pass)];
    case MASU_PASS_EASU_FAST: return easu_fast_code(m);
    case MASU_PASS_BILINEAR: return bilinear_builds[color_build(m)];
    case MASU_PASS_FSR1: return fsr1_builds[color_bytes_build(m, pass)];
    case MASU_PASS_RCAS: return rcas_builds[color_bytes_build(m, pass)];
    default: return (spirv){NULL, 0};
    }
}

static masu_result make_module(masu_device *m, spirv code, VkShaderModule *module,
                               masu_detail *detail) {
    VkShaderModuleCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                     .codeSize = (size_t)code.bytes,
                                     .pCode = code.words};
    VkResult r = m->vk.CreateShaderModule(m->vk.device, &info, m->vk.allocator, module);
    return MASU_FAILED(r, *module) ? masu_fail_vulkan(detail, r, "vkCreateShaderModule") : MASU_OK;
}

static uint64_t now(const masu_device *m) {
    return m->plan->desc.clock_ns ? m->plan->desc.clock_ns(m->plan->desc.clock_user) : 0;
}

/* Constants 0 to 7 of all shaders, of which each has those it declares: of compute shaders whether counters
 * are kept, of others whether masks are cut; whether the sky may be the analytic one; whether there is fog;
 * whether the sky is from a picture; whether reflections are traced; the tone curve; the target's
 * encoding; whether the last pass rounds to its steps or changes the order of its channels. */
enum { SPECIAL_COUNT = 8 };

static VkSpecializationInfo specialise(const masu_device *m, VkBool32 first,
                                       VkBool32 constants[SPECIAL_COUNT]) {
    static const VkSpecializationMapEntry entries[SPECIAL_COUNT] = {
        {0, 0, sizeof *constants},
        {1, sizeof *constants, sizeof *constants},
        {2, 2 * sizeof *constants, sizeof *constants},
        {3, 3 * sizeof *constants, sizeof *constants},
        {4, 4 * sizeof *constants, sizeof *constants},
        {5, 5 * sizeof *constants, sizeof *constants},
        {6, 6 * sizeof *constants, sizeof *constants},
        {7, 7 * sizeof *constants, sizeof *constants}};
    constants[0] = first;
    constants[1] = m->plan->needs.sky != 0;
    constants[2] = m->plan->scene.fog != 0;
    constants[3] = m->plan->needs.environment != 0;
    constants[4] = m->plan->needs.reflections != 0;
    constants[5] = (uint32_t)m->plan->desc.tone;
    masu_encoding encoding = m->plan->desc.targets.encoding;
    constants[6] = encoding == MASU_ENCODING_LINEAR ? MASU_OUTPUT_LINEAR
                   : encoding == MASU_ENCODING_PQ   ? MASU_OUTPUT_PQ
                                                    : MASU_OUTPUT_SRGB;
    constants[7] = m->plan->output.steps[0] || (m->plan->output.flags & MASU_OUTPUT_SWAP);
    return (VkSpecializationInfo){SPECIAL_COUNT, entries, SPECIAL_COUNT * sizeof *constants,
                                  constants};
}

/* ---- Layouts --------------------------------------------------------------------------------- */

/* What a plan has no buffer for takes no binding: devices need to have no more than four storage buffers
 * in a stage. */
static masu_result make_global_layout(masu_device *m, masu_detail *detail) {
    const VkShaderStageFlags compute = VK_SHADER_STAGE_COMPUTE_BIT;
    const VkShaderStageFlags fragment = VK_SHADER_STAGE_FRAGMENT_BIT;
    const VkShaderStageFlags vertex = VK_SHADER_STAGE_VERTEX_BIT, all = compute | fragment | vertex;
    const int stage2 = m->plan->occlusion;
    const struct {
        uint32_t binding;
        int uniform, needed;
        VkShaderStageFlags stages;
    } rows[] = {{MASU_BIND_FRAME, 1, 1, all},
                {MASU_BIND_INSTANCES, 0, 1, vertex},
                {MASU_BIND_MATERIALS, 0, 1, fragment},
                {MASU_BIND_COUNTERS, 0, 1, compute},
                {MASU_BIND_TILES, 0, 1, compute | fragment},
                {MASU_BIND_SLOTS, 0, 1, compute | fragment},
                {MASU_BIND_PREVIOUS, 1, 1, all},
                {MASU_BIND_PREVIOUS_INSTANCES, 0, 1, vertex},
                {MASU_BIND_SHADOW, 1, 1, all},
                {MASU_BIND_DRAWN, 0, 1, stage2 ? vertex | compute : vertex},
                {MASU_BIND_DRAWS, 0, stage2, compute},
                {MASU_BIND_SEEN, 0, stage2, compute},
                {MASU_BIND_TABLES, 0, 1, compute | fragment},
                {MASU_BIND_SKY, 1, 1, compute | fragment},
                {MASU_BIND_PROBES, 0, m->plan->needs.probes, compute},
                {MASU_BIND_LIGHTS, 0, m->plan->needs.lights, compute},
                {MASU_BIND_LIGHT_TILES, 0, m->plan->needs.lights, compute},
                {MASU_BIND_TRACE, 0, m->plan->needs.reflections, compute},
                {MASU_BIND_TRACE_FRAME, 0, m->plan->needs.traced, compute},
                {MASU_BIND_TRACE_VERTICES, 0, m->plan->needs.traced, compute},
                {MASU_BIND_TRACE_TEXCOORDS, 0, m->plan->needs.traced && m->plan->scene.trace_colors,
                 compute},
                {MASU_BIND_SPECULAR_TILES, 0, m->plan->needs.reflections, compute},
                {MASU_BIND_SMAA_AREA, 0, m->plan->needs.smoothing, compute},
                {MASU_BIND_SMAA_TILES, 0, m->plan->needs.smoothing, compute},
                {MASU_BIND_EXPOSURE, 0, m->plan->needs.metered, compute}};
    VkDescriptorSetLayoutBinding bindings[sizeof rows / sizeof *rows + 1];
    uint32_t count = 0;
    for (uint32_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!rows[i].needed) continue;
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            rows[i].binding,
            rows[i].uniform ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER : VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
            1, rows[i].stages, NULL};
    }
    if (m->plan->needs.query) {
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            MASU_BIND_TOP_LEVEL, VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR, 1, compute, NULL};
    }
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = count,
                                            .pBindings = bindings};
    VkResult r =
        m->vk.CreateDescriptorSetLayout(m->vk.device, &info, m->vk.allocator, &m->global_layout);
    if (MASU_FAILED(r, m->global_layout))
        return masu_fail_vulkan(detail, r, "vkCreateDescriptorSetLayout");
    return MASU_OK;
}

static int draws_polygons(uint32_t pass) {
    return pass == MASU_PASS_GBUFFER || pass == MASU_PASS_TRANSPARENTS || masu_is_cascade(pass);
}

/* Set 2: the textures of a draw. */
static masu_result make_texture_layout(masu_device *m, masu_detail *detail) {
    if (!m->plan->scene.texture_arrays) return MASU_OK;
    VkDescriptorSetLayoutBinding bindings[MASU_SLOT_COUNT];
    for (uint32_t i = 0; i < MASU_SLOT_COUNT; i++) {
        bindings[i] =
            (VkDescriptorSetLayoutBinding){i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
                                           VK_SHADER_STAGE_FRAGMENT_BIT, NULL};
    }
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = MASU_SLOT_COUNT,
                                            .pBindings = bindings};
    VkResult r =
        m->vk.CreateDescriptorSetLayout(m->vk.device, &info, m->vk.allocator, &m->texture_layout);
    return MASU_FAILED(r, m->texture_layout)
               ? masu_fail_vulkan(detail, r, "vkCreateDescriptorSetLayout")
               : MASU_OK;
}

/* Set 1: reads first, then writes, in the order of the row. Which images stand behind the bindings
 * may differ from rung to rung, their number and kind do not: the first rung that runs the pass
 * speaks for all. */
static const masu_rung_plan *first_rung(const masu_device *m, uint32_t pass) {
    for (uint32_t r = 0; r < m->plan->desc.rung_count; r++) {
        if (m->plan->rungs[r].active & MASU_PASS_BIT(pass)) return &m->plan->rungs[r];
    }
    return NULL;
}

static masu_result make_pass_layout(masu_device *m, uint32_t pass, masu_detail *detail) {
    const masu_rung_plan *rp = first_rung(m, pass);
    if (!rp) return MASU_OK;
    VkDescriptorSetLayoutBinding bindings[MASU_PASS_ACCESSES];
    uint32_t n = 0;
    int compute = masu_passes[pass].kind == MASU_PASS_COMPUTE;
    for (int writes = 0; writes < 2 && masu_has_set(pass); writes++) {
        for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
            if (!masu_access_binds(rp->access[pass][a], writes)) continue;
            bindings[n] = (VkDescriptorSetLayoutBinding){
                n,
                writes ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                       : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                1, compute ? VK_SHADER_STAGE_COMPUTE_BIT : VK_SHADER_STAGE_FRAGMENT_BIT,
                writes ? NULL : &m->sampler};
            n++;
        }
    }
    VkDescriptorSetLayoutCreateInfo info = {.sType =
                                                VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                            .bindingCount = n,
                                            .pBindings = bindings};
    VkResult r = m->vk.CreateDescriptorSetLayout(m->vk.device, &info, m->vk.allocator,
                                                 &m->pass_layouts[pass]);
    if (MASU_FAILED(r, m->pass_layouts[pass]))
        return masu_fail_vulkan(detail, r, "vkCreateDescriptorSetLayout");
    VkDescriptorSetLayout sets[] = {m->global_layout, m->pass_layouts[pass], m->texture_layout};
    VkPushConstantRange push = {VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(struct masu_push)};
    if (!compute) push.stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                         .setLayoutCount =
                                             draws_polygons(pass) && m->texture_layout ? 3 : 2,
                                         .pSetLayouts = sets,
                                         .pushConstantRangeCount = 1,
                                         .pPushConstantRanges = &push};
    r = m->vk.CreatePipelineLayout(m->vk.device, &layout, m->vk.allocator, &m->layouts[pass]);
    if (MASU_FAILED(r, m->layouts[pass]))
        return masu_fail_vulkan(detail, r, "vkCreatePipelineLayout");
    masu_name(m, VK_OBJECT_TYPE_PIPELINE_LAYOUT, MASU_HANDLE(m->layouts[pass]),
              masu_passes[pass].name);
    return MASU_OK;
}

/* ---- Compute --------------------------------------------------------------------------------- */

static masu_result make_compute(masu_device *m, uint32_t pass, masu_detail *detail) {
    VkShaderModule module = VK_NULL_HANDLE;
    masu_result result = make_module(m, compute_code(m, pass), &module, detail);
    if (result) return result;
    VkBool32 constants[SPECIAL_COUNT];
    VkSpecializationInfo special = specialise(m, m->plan->desc.debug.counters != 0, constants);
    VkComputePipelineCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = module,
                  .pName = "main",
                  .pSpecializationInfo = &special},
        .layout = m->layouts[pass]};
    uint64_t start = now(m);
    VkResult r = m->vk.CreateComputePipelines(m->vk.device, m->plan->desc.vulkan.pipeline_cache, 1,
                                              &info, m->vk.allocator, &m->pipelines[pass]);
    m->pipeline_ns[pass] = now(m) - start;
    m->vk.DestroyShaderModule(m->vk.device, module, m->vk.allocator);
    if (MASU_FAILED(r, m->pipelines[pass]))
        return masu_fail_vulkan(detail, r, "vkCreateComputePipelines");
    return MASU_OK;
}

/* ---- Graphics -------------------------------------------------------------------------------- */

/* Attachments come in the layouts that the row's barriers put them in, and stay there: the render
 * pass itself does no transition, so that record.c remains the only place that thinks about them.
 * Only the render area is cleared: a cascade of the shadow map leaves the others alone. */
static masu_result make_render_pass(masu_device *m, uint32_t pass, masu_detail *detail) {
    VkAttachmentDescription attachments[MASU_PASS_ACCESSES];
    VkAttachmentReference colors[MASU_PASS_ACCESSES], depth = {0, VK_IMAGE_LAYOUT_UNDEFINED};
    VkImageView views[MASU_PASS_ACCESSES];
    uint32_t n = 0, color_count = 0, width = 0, height = 0;
    const masu_rung_plan *rp = first_rung(m, pass);
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        masu_access access = rp->access[pass][a];
        int is_depth = access.usage == MASU_WRITE_DEPTH || access.usage == MASU_UPDATE_DEPTH;
        int blended = access.usage == MASU_BLEND_COLOR;
        if (!is_depth && !blended && access.usage != MASU_WRITE_COLOR) continue;
        VkImageLayout layout = is_depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL
                                        : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        if (is_depth) {
            depth = (VkAttachmentReference){n, layout};
        } else {
            colors[color_count++] = (VkAttachmentReference){n, layout};
        }
        attachments[n] =
            (VkAttachmentDescription){.format = masu_images[access.image].format,
                                      .samples = VK_SAMPLE_COUNT_1_BIT,
                                      .loadOp = blended ? VK_ATTACHMENT_LOAD_OP_LOAD
                                                        : VK_ATTACHMENT_LOAD_OP_CLEAR,
                                      .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                      .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                      .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                      .initialLayout = layout,
                                      .finalLayout = layout};
        views[n++] = m->views[access.image];
        width = m->plan->images[access.image].width;
        height = m->plan->images[access.image].height;
    }
    VkSubpassDescription subpass = {.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    .colorAttachmentCount = color_count,
                                    .pColorAttachments = colors,
                                    .pDepthStencilAttachment =
                                        depth.layout == VK_IMAGE_LAYOUT_UNDEFINED ? NULL : &depth};
    VkRenderPassCreateInfo info = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                   .attachmentCount = n,
                                   .pAttachments = attachments,
                                   .subpassCount = 1,
                                   .pSubpasses = &subpass};
    VkResult r =
        m->vk.CreateRenderPass(m->vk.device, &info, m->vk.allocator, &m->render_passes[pass]);
    if (MASU_FAILED(r, m->render_passes[pass]))
        return masu_fail_vulkan(detail, r, "vkCreateRenderPass");
    VkFramebufferCreateInfo frame = {.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                     .renderPass = m->render_passes[pass],
                                     .attachmentCount = n,
                                     .pAttachments = views,
                                     .width = width,
                                     .height = height,
                                     .layers = 1};
    r = m->vk.CreateFramebuffer(m->vk.device, &frame, m->vk.allocator, &m->framebuffers[pass]);
    return MASU_FAILED(r, m->framebuffers[pass])
               ? masu_fail_vulkan(detail, r, "vkCreateFramebuffer")
               : MASU_OK;
}

/* textured: with texture coordinates; masked: with the discard of masks. */
static VkResult create_graphics_pipeline(masu_device *m, uint32_t pass,
                                         const VkShaderModule modules[2], int textured,
                                         VkBool32 masked, VkPipeline *out) {
    int cascade = masu_is_cascade(pass);                 /* no colour */
    int polygons = draws_polygons(pass);                 /* else what the vertex shader makes up */
    int boxes = pass == MASU_PASS_OCCLUDERS;             /* no colour; else one triangle, no depth */
    int blends = pass == MASU_PASS_TRANSPARENTS;         /* no depth */
    VkBool32 constants[SPECIAL_COUNT];
    VkSpecializationInfo special = specialise(m, masked, constants);
    VkPipelineShaderStageCreateInfo stages[2];
    for (uint32_t i = 0; i < 2; i++) {
        stages[i] = (VkPipelineShaderStageCreateInfo){
            .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
            .stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT,
            .module = modules[i],
            .pName = "main",
            .pSpecializationInfo = (textured || blends) && i ? &special : NULL};
    }
    VkVertexInputBindingDescription bindings[] = {
        {0, sizeof(masu_blob_vertex), VK_VERTEX_INPUT_RATE_VERTEX},
        {1, 2 * sizeof(float), VK_VERTEX_INPUT_RATE_VERTEX}};
    VkVertexInputAttributeDescription attributes[] = {
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(masu_blob_vertex, position)},
        {1, 0, VK_FORMAT_R16G16_SNORM, offsetof(masu_blob_vertex, normal)},
        {2, 1, VK_FORMAT_R32G32_SFLOAT, 0}};
    VkPipelineVertexInputStateCreateInfo input = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
        .vertexBindingDescriptionCount = textured ? 2 : polygons ? 1 : 0,
        .pVertexBindingDescriptions = bindings,
        .vertexAttributeDescriptionCount = textured ? 3 : polygons ? 2 : 0,
        .pVertexAttributeDescriptions = attributes};
    VkPipelineInputAssemblyStateCreateInfo assembly = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
        .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
    VkPipelineViewportStateCreateInfo viewport = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO,
        .viewportCount = 1,
        .scissorCount = 1};
    /* No back-face culling: CAD data is not consistently wound, and the normal is turned towards
     * the viewer. */
    VkPipelineRasterizationStateCreateInfo raster = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
        .polygonMode = VK_POLYGON_MODE_FILL,
        .cullMode = VK_CULL_MODE_NONE,
        .lineWidth = 1.0f};
    VkPipelineMultisampleStateCreateInfo samples = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
        .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
    VkPipelineDepthStencilStateCreateInfo depth = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
        .depthTestEnable = (polygons && !blends) || boxes ? VK_TRUE : VK_FALSE,
        .depthWriteEnable = (polygons && !blends) || boxes ? VK_TRUE : VK_FALSE,
        .depthCompareOp = VK_COMPARE_OP_GREATER};
    VkPipelineColorBlendAttachmentState blend[4];
    memset(blend, 0, sizeof blend);
    for (uint32_t i = 0; i < 4; i++) {
        blend[i].colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                  VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    }
    if (blends) { /* the colour is multiplied by its alpha already; that of the picture stays */
        blend[0].blendEnable = VK_TRUE;
        blend[0].srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
        blend[0].dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
        blend[0].srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
        blend[0].dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    }
    VkPipelineColorBlendStateCreateInfo blending = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
        .attachmentCount = boxes || cascade ? 0
                           : blends            ? 1
                           : polygons          ? 2u + (m->plan->needs.velocity ? 1u : 0u) +
                                            (m->plan->needs.surface ? 1u : 0u)
                                               : 3,
        .pAttachments = blend};
    VkDynamicState dynamic[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamics = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
        .dynamicStateCount = 2,
        .pDynamicStates = dynamic};
    VkGraphicsPipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                         .stageCount = modules[1] ? 2 : 1,
                                         .pStages = stages,
                                         .pVertexInputState = &input,
                                         .pInputAssemblyState = &assembly,
                                         .pViewportState = &viewport,
                                         .pRasterizationState = &raster,
                                         .pMultisampleState = &samples,
                                         .pDepthStencilState = &depth,
                                         .pColorBlendState = &blending,
                                         .pDynamicState = &dynamics,
                                         .layout = m->layouts[pass],
                                         .renderPass = m->render_passes[pass]};
    return m->vk.CreateGraphicsPipelines(m->vk.device, m->plan->desc.vulkan.pipeline_cache, 1, &info,
                                         m->vk.allocator, out);
}

/* fragment.words NULL: depth alone. Times are added up per pass. */
static masu_result make_pipeline(masu_device *m, uint32_t pass, spirv vertex, spirv fragment,
                                 int textured, VkBool32 masked, VkPipeline *out,
                                 masu_detail *detail) {
    VkShaderModule modules[2] = {VK_NULL_HANDLE, VK_NULL_HANDLE};
    masu_result result = make_module(m, vertex, &modules[0], detail);
    if (!result && fragment.words) result = make_module(m, fragment, &modules[1], detail);
    if (!result) {
        uint64_t start = now(m);
        VkResult r = create_graphics_pipeline(m, pass, modules, textured, masked, out);
        m->pipeline_ns[pass] += now(m) - start;
        if (MASU_FAILED(r, *out)) result = masu_fail_vulkan(detail, r, "vkCreateGraphicsPipelines");
    }
    for (uint32_t i = 0; i < 2; i++)
        m->vk.DestroyShaderModule(m->vk.device, modules[i], m->vk.allocator);
    return result;
}

static masu_result make_textured(masu_device *m, masu_detail *detail) {
    uint32_t build = gbuffer_build(m) | GBUFFER_TEXTURED;
    spirv vertex = gbuffer_vertex[build & ~(uint32_t)GBUFFER_SURFACE];
    spirv fragment = gbuffer_fragment[build];
    masu_result result = MASU_OK;
    for (uint32_t i = 0; i < MASU_TEXTURED_COUNT && !result; i++) {
        if (i == MASU_TEXTURED_MASK && !m->plan->scene.masks) continue;
        result = make_pipeline(m, MASU_PASS_GBUFFER, vertex, fragment, 1, i == MASU_TEXTURED_MASK,
                               &m->textured[i], detail);
        masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->textured[i]),
                  i == MASU_TEXTURED_MASK ? "gbuffer, masks" : "gbuffer, textured");
    }
    return result;
}

/* Through the holes of a mask the sun shines. */
static masu_result make_masked_casters(masu_device *m, masu_detail *detail) {
    spirv vertex = {masu_spv_cascade_masked_vert, sizeof masu_spv_cascade_masked_vert};
    spirv fragment = {masu_spv_cascade_frag, sizeof masu_spv_cascade_frag};
    if (!m->plan->scene.masks) return MASU_OK;
    masu_result result = make_pipeline(m, MASU_PASS_CASCADE_0, vertex, fragment, 1, VK_TRUE,
                                       &m->masked_casters, detail);
    masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->masked_casters), "cascades, masks");
    return result;
}

/* One pipeline for all: in scenes with textures what has none passes by them. */
static masu_result make_transparents(masu_device *m, masu_detail *detail) {
    static const spirv fragments[] = {SPIRV(transparents_frag), SPIRV(transparents_textured_frag),
                                      SPIRV(transparents_sun_frag),
                                      SPIRV(transparents_textured_sun_frag)};
    static const spirv vertices[] = {SPIRV(transparents_vert), SPIRV(transparents_textured_vert)};
    int textured = m->texture_layout != VK_NULL_HANDLE;
    return make_pipeline(m, MASU_PASS_TRANSPARENTS, vertices[textured],
                         fragments[textured + (m->plan->needs.shadow ? 2 : 0)], textured, VK_FALSE,
                         &m->pipelines[MASU_PASS_TRANSPARENTS], detail);
}

static masu_result make_graphics(masu_device *m, uint32_t pass, masu_detail *detail) {
    if (masu_is_cascade(pass) && pass != MASU_PASS_CASCADE_0) return MASU_OK;
    masu_result result = make_render_pass(m, pass, detail);
    int cascade = masu_is_cascade(pass), polygons = pass == MASU_PASS_GBUFFER;
    if (result || (polygons && !m->plan->needs.raster)) return result; /* an empty scene clears */
    if (pass == MASU_PASS_TRANSPARENTS) return make_transparents(m, detail);
    spirv vertex = gbuffer_vertex[gbuffer_build(m) & ~(uint32_t)GBUFFER_SURFACE];
    spirv fragment = gbuffer_fragment[gbuffer_build(m)];
    if (pass == MASU_PASS_OCCLUDERS) {
        vertex = (spirv){masu_spv_occluders_vert, sizeof masu_spv_occluders_vert};
        fragment = (spirv){masu_spv_occluders_frag, sizeof masu_spv_occluders_frag};
    } else if (cascade) {
        vertex = (spirv){masu_spv_cascade_vert, sizeof masu_spv_cascade_vert};
        fragment = (spirv){NULL, 0};
    } else if (!polygons) {
        vertex = (spirv){masu_spv_fullscreen_vert, sizeof masu_spv_fullscreen_vert};
        fragment = scene_code(m, pass);
    }
    result = make_pipeline(m, pass, vertex, fragment, 0, VK_FALSE, &m->pipelines[pass], detail);
    if (!result && polygons && m->texture_layout) result = make_textured(m, detail);
    if (!result && cascade && m->texture_layout) result = make_masked_casters(m, detail);
    return result;
}

/* Those that the scene's texture sets ask for: trilinear, and along the longer axis of a pixel's
 * footprint where the device was created for it. */
static masu_result make_samplers(masu_device *m, masu_detail *detail) {
    static const VkSamplerAddressMode modes[] = {VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                                 VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                                 VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT};
    if (!m->plan->scene.texture_sets) return MASU_OK;
    masu_scene_view v = masu_scene_look(&m->plan->scene);
    float most = m->vk.properties.limits.maxSamplerAnisotropy;
    float anisotropy = m->plan->desc.vulkan.max_anisotropy;
    for (uint32_t i = 0; i < m->plan->scene.texture_sets; i++) {
        const uint32_t *wrap = v.texture_sets[i].wrap;
        VkSampler *sampler = &m->samplers[wrap[0] + 3 * wrap[1]];
        if (*sampler) continue;
        VkSamplerCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                    .magFilter = VK_FILTER_LINEAR,
                                    .minFilter = VK_FILTER_LINEAR,
                                    .mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR,
                                    .addressModeU = modes[wrap[0]],
                                    .addressModeV = modes[wrap[1]],
                                    .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                    .anisotropyEnable = anisotropy > 1.0f,
                                    .maxAnisotropy = anisotropy < most ? anisotropy : most,
                                    .maxLod = VK_LOD_CLAMP_NONE};
        VkResult r = m->vk.CreateSampler(m->vk.device, &info, m->vk.allocator, sampler);
        if (MASU_FAILED(r, *sampler)) return masu_fail_vulkan(detail, r, "vkCreateSampler");
    }
    return MASU_OK;
}

masu_result masu_make_pipelines(masu_device *m, masu_detail *detail) {
    VkSamplerCreateInfo nearest = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                   .magFilter = VK_FILTER_NEAREST,
                                   .minFilter = VK_FILTER_NEAREST,
                                   .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                   .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    VkResult r = m->vk.CreateSampler(m->vk.device, &nearest, m->vk.allocator, &m->sampler);
    if (MASU_FAILED(r, m->sampler)) return masu_fail_vulkan(detail, r, "vkCreateSampler");
    masu_result result = make_global_layout(m, detail);
    if (!result) result = make_texture_layout(m, detail);
    if (!result) result = make_samplers(m, detail);
    for (uint32_t p = 0; p < MASU_PASS_COUNT && !result; p++) {
        if (masu_passes[p].kind == MASU_PASS_TRANSFER || masu_passes[p].kind == MASU_PASS_BUILD)
            continue;
        result = make_pass_layout(m, p, detail);
        if (result || !m->layouts[p]) continue;
        int graphics = masu_passes[p].kind == MASU_PASS_GRAPHICS;
        result = graphics ? make_graphics(m, p, detail) : make_compute(m, p, detail);
        if (!result)
            masu_name(m, VK_OBJECT_TYPE_PIPELINE, MASU_HANDLE(m->pipelines[p]),
                      masu_passes[p].name);
    }
    return result;
}

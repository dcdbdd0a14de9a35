/* frame.c: THE TABLE. The frame, in order: what each pass reads, what it writes, and when it is
 * needed.
 *
 * Adding a pass is adding a row here, its id in frame.h and a shader of the same name in shaders/. */
#include "plan/frame.h"

#include <math.h>

const masu_image_row masu_images[MASU_IMAGE_COUNT] = {
    [MASU_IMAGE_ALBEDO] = {"albedo", VK_FORMAT_R8G8B8A8_UNORM, MASU_EXTENT_RENDER, MASU_CLASS_OTHER,
                           MASU_READBACK_ALBEDO, 0},
    [MASU_IMAGE_NORMAL] = {"normal", VK_FORMAT_R32_UINT, MASU_EXTENT_RENDER, MASU_CLASS_OTHER,
                           MASU_READBACK_NORMAL, 0},
    [MASU_IMAGE_DEPTH] = {"depth", VK_FORMAT_D32_SFLOAT, MASU_EXTENT_RENDER, MASU_CLASS_DEPTH,
                          MASU_READBACK_DEPTH, 0},
    [MASU_IMAGE_SCENE_DEPTH] = {"scene_depth", VK_FORMAT_R32_SFLOAT, MASU_EXTENT_RENDER,
                                MASU_CLASS_DEPTH, MASU_READBACK_DEPTH, 0},
    [MASU_IMAGE_OCCLUDERS] = {"occluders", VK_FORMAT_D32_SFLOAT, MASU_EXTENT_ATLAS,
                              MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_CONE8] = {"cone8", VK_FORMAT_R32_SFLOAT, MASU_EXTENT_BLOCK8, MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_CONE4] = {"cone4", VK_FORMAT_R32_SFLOAT, MASU_EXTENT_BLOCK4, MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SURFACE] = {"surface", VK_FORMAT_R8G8B8A8_UNORM, MASU_EXTENT_RENDER, MASU_CLASS_OTHER,
                            0, 0},
    /* rgba16f: of the formats that hold a signed motion, the smallest that every device takes both
     * as colour attachment and as storage image. */
    [MASU_IMAGE_VELOCITY] = {"velocity", VK_FORMAT_R16G16B16A16_SFLOAT, MASU_EXTENT_RENDER,
                             MASU_CLASS_OTHER, MASU_READBACK_VELOCITY, 0},
    [MASU_IMAGE_SHADOW_MAP] = {"shadow_map", VK_FORMAT_D32_SFLOAT, MASU_EXTENT_SHADOW,
                               MASU_CLASS_OTHER, MASU_READBACK_SHADOW_MAP, 0},
    [MASU_IMAGE_AO] = {"ao", VK_FORMAT_R32_UINT, MASU_EXTENT_HALF, MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_OCCLUSION] = {"occlusion", VK_FORMAT_R32_UINT, MASU_EXTENT_RENDER, MASU_CLASS_OTHER,
                              MASU_READBACK_OCCLUSION, 0},
    [MASU_IMAGE_SPECULAR_GUIDE] = {"specular_guide", VK_FORMAT_R32G32_UINT, MASU_EXTENT_TRACED,
                                   MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SPECULAR_RAY] = {"specular_ray", VK_FORMAT_R32G32_UINT, MASU_EXTENT_TRACED,
                                 MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SPECULAR_HIT] = {"specular_hit", VK_FORMAT_R32G32B32A32_UINT, MASU_EXTENT_TRACED,
                                 MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SPECULAR_LIGHT] = {"specular_light", VK_FORMAT_R16G16B16A16_SFLOAT,
                                   MASU_EXTENT_TRACED, MASU_CLASS_SPECULAR, 0, 0},
    [MASU_IMAGE_SPECULAR_MOTION] = {"specular_motion", VK_FORMAT_R32_UINT, MASU_EXTENT_TRACED,
                                    MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SPECULAR_REUSED] = {"specular_reused", VK_FORMAT_R16G16B16A16_SFLOAT,
                                    MASU_EXTENT_TRACED, MASU_CLASS_SPECULAR, 0, 0},
    [MASU_IMAGE_SPECULAR_MEAN] = {"specular_mean", VK_FORMAT_R16G16B16A16_SFLOAT,
                                  MASU_EXTENT_TRACED, MASU_CLASS_SPECULAR, 0, 0},
    [MASU_IMAGE_SPECULAR_AGE] = {"specular_age", VK_FORMAT_R32G32_UINT, MASU_EXTENT_TRACED,
                                 MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SPECULAR_FINE] = {"specular_fine", VK_FORMAT_R32G32B32A32_UINT, MASU_EXTENT_TRACED,
                                  MASU_CLASS_OTHER, 0, 0},
    [MASU_IMAGE_SPECULAR_OLD_FINE] = {"specular_old_fine", VK_FORMAT_R32G32B32A32_UINT,
                                      MASU_EXTENT_TRACED, MASU_CLASS_OTHER, 0, 1},
    [MASU_IMAGE_SPECULAR_SMOOTH] = {"specular_smooth", VK_FORMAT_R16G16B16A16_SFLOAT,
                                    MASU_EXTENT_TRACED, MASU_CLASS_SPECULAR, 0, 0},
    [MASU_IMAGE_SPECULAR_STEADY] = {"specular_steady", VK_FORMAT_R16G16B16A16_SFLOAT,
                                    MASU_EXTENT_TRACED, MASU_CLASS_SPECULAR, 0, 0},
    [MASU_IMAGE_SPECULAR_OLD_GUIDE] = {"specular_old_guide", VK_FORMAT_R32G32_UINT,
                                       MASU_EXTENT_TRACED, MASU_CLASS_OTHER, 0, 1},
    [MASU_IMAGE_SPECULAR_OLD_MEAN] = {"specular_old_mean", VK_FORMAT_R16G16B16A16_SFLOAT,
                                      MASU_EXTENT_TRACED, MASU_CLASS_OTHER, 0, 1},
    [MASU_IMAGE_SPECULAR_OLD_AGE] = {"specular_old_age", VK_FORMAT_R32_UINT, MASU_EXTENT_TRACED,
                                     MASU_CLASS_OTHER, 0, 1},
    [MASU_IMAGE_SPECULAR_OLD_STEADY] = {"specular_old_steady", VK_FORMAT_R16G16B16A16_SFLOAT,
                                        MASU_EXTENT_TRACED, MASU_CLASS_OTHER, 0, 1},
    [MASU_IMAGE_SPECULAR_SUM] = {"specular_sum", VK_FORMAT_R32G32B32A32_SFLOAT, MASU_EXTENT_TRACED,
                                 MASU_CLASS_SPECULAR, 0, 1},
    [MASU_IMAGE_HDR] = {"hdr", VK_FORMAT_R16G16B16A16_SFLOAT, MASU_EXTENT_RENDER, MASU_CLASS_OTHER,
                        MASU_READBACK_HDR, 0},
    [MASU_IMAGE_LDR] = {"ldr", VK_FORMAT_R8G8B8A8_UNORM, MASU_EXTENT_RENDER, MASU_CLASS_COLOR, 0, 0},
    [MASU_IMAGE_SMOOTH] = {"smooth", VK_FORMAT_R8G8B8A8_UNORM, MASU_EXTENT_RENDER, MASU_CLASS_COLOR,
                           0, 0},
    [MASU_IMAGE_UPSCALED] = {"upscaled", VK_FORMAT_R8G8B8A8_UNORM, MASU_EXTENT_OUTPUT,
                             MASU_CLASS_COLOR, 0, 0},
    [MASU_IMAGE_FINAL] = {"final", VK_FORMAT_R8G8B8A8_UNORM, MASU_EXTENT_OUTPUT, MASU_CLASS_COLOR,
                          0, 0},
    [MASU_IMAGE_SOURCE] = {"source", VK_FORMAT_UNDEFINED, MASU_EXTENT_RENDER, MASU_CLASS_COLOR, 0, 0},
    [MASU_IMAGE_TARGET] = {"target", VK_FORMAT_UNDEFINED, MASU_EXTENT_OUTPUT, MASU_CLASS_COLOR, 0, 0},
};

static int decided(int runs, const char *yes, const char *no, const char **why) {
    *why = runs ? yes : no;
    return runs;
}

static int needs_gbuffer(const masu_needs *n, const char **why) {
    if (n->raster) return decided(1, "the scene has instances", NULL, why);
    if (n->sdf) return decided(0, NULL, "no instances; the march writes every pixel", why);
    return decided(n->scene, "clears: the scene is empty but for its sky",
                   "no scene: a source image is upscaled", why);
}

static int needs_occlusion(const masu_needs *n, const char **why) {
    return decided(n->occlusion, "the scene has occluders",
                   !n->occluders  ? "the scene has no occluders"
                   : n->unculled  ? "a mesh has too many primitives or instances"
                                  : "rung.occlusion is off, or the device has too few storage buffers",
                   why);
}

static int needs_casters(const masu_needs *n, const char **why) {
    return decided(n->casters, "occluders hide things from the sun",
                   n->occlusion ? "nothing draws what the sun sees" : "no culling by occluders", why);
}

static int needs_receivers(const masu_needs *n, const char **why) {
    return decided(n->receivers, "shadows that fall on nothing in the picture are left out",
                   n->casters ? "no cascade is drawn in every frame" : "no casters are culled", why);
}

static int has_tiles(masu_march march) {
    return march != MASU_MARCH_PLAIN && march != MASU_MARCH_SEED && march != MASU_MARCH_FRAGMENT;
}

static int uses_tiles(const masu_needs *n) { return n->sdf && has_tiles(n->march); }

/* Why a pass of the SDF does not run: there is none, or the rung marches it in another way. */
static const char *no_march(const masu_needs *n) {
    return n->sdf ? "rung.march asks for another way" : "the scene has no SDF";
}

static int needs_update(const masu_needs *n, const char **why) {
    if (n->sdf && n->anchored) {
        return decided(1, "the SDF reaches far from the origin: its space follows the eye", NULL,
                       why);
    }
    return decided(n->sdf && n->dynamic, "the SDF depends on parameters or time",
                   n->sdf ? "the SDF's slots are constant" : "the scene has no SDF", why);
}

/* Why no pass of velocities runs, or of two kinds the other one. */
static const char *no_velocity(const masu_needs *n, const char *other) {
    return n->velocity ? other : "nothing reads velocities";
}

static int needs_update_previous(const masu_needs *n, const char **why) {
    return decided(n->velocity && n->sdf && n->dynamic,
                   "velocities compare the SDF with the frame before",
                   no_velocity(n, n->sdf ? "the SDF's slots are constant" : "the scene has no SDF"),
                   why);
}

static int needs_velocity(const masu_needs *n, const char **why) {
    return decided(n->velocity && !n->sdf, "reflections or desc.readback ask for velocities",
                   no_velocity(n, "sdf_velocity does it"), why);
}

static int needs_sdf_velocity(const masu_needs *n, const char **why) {
    return decided(n->velocity && n->sdf,
                   "reflections or desc.readback ask for velocities, the scene has an SDF",
                   no_velocity(n, "the scene has no SDF"), why);
}

static int needs_tiles(const masu_needs *n, const char **why) {
    return decided(uses_tiles(n), "the scene has an SDF", no_march(n), why);
}

static int needs_cone4(const masu_needs *n, const char **why) {
    return decided(uses_tiles(n) && n->march != MASU_MARCH_CHECKERBOARD, "the scene has an SDF",
                   no_march(n), why);
}

static int needs_march(const masu_needs *n, const char **why) { return needs_cone4(n, why); }

static int needs_variant(const masu_needs *n, masu_march march, const char **why) {
    return decided(n->sdf && n->march == march, "rung.march asks for it",
                   n->sdf ? "rung.march does not ask for it" : "the scene has no SDF", why);
}

static int needs_checkerboard(const masu_needs *n, const char **why) {
    return needs_variant(n, MASU_MARCH_CHECKERBOARD, why);
}

static int needs_plain(const masu_needs *n, const char **why) {
    return needs_variant(n, MASU_MARCH_PLAIN, why);
}

static int needs_seed(const masu_needs *n, const char **why) {
    return needs_variant(n, MASU_MARCH_SEED, why);
}

static int needs_fragment(const masu_needs *n, const char **why) {
    return needs_variant(n, MASU_MARCH_FRAGMENT, why);
}

static int needs_sdf_occlusion(const masu_needs *n, const char **why) {
    return decided(n->sdf_occlusion, "the scene asks for SDF shadows or SDF ambient occlusion",
                   n->sdf ? "the scene asks for no SDF shadows or SDF ambient occlusion"
                          : "the scene has no SDF",
                   why);
}

static const char *no_shadow_map(const masu_needs *n) {
    return n->raster ? "the scene asks for no shadows of its polygons"
                     : "the scene has no instances";
}

static int needs_cascade(const masu_needs *n, uint32_t cascade, const char **why) {
    return decided(n->shadow && n->cascades > cascade, "polygons cast shadows",
                   n->shadow ? "fewer cascades are asked for" : no_shadow_map(n), why);
}

static int needs_cascade_0(const masu_needs *n, const char **why) {
    return needs_cascade(n, 0, why);
}

static int needs_cascade_1(const masu_needs *n, const char **why) {
    return needs_cascade(n, 1, why);
}

static int needs_cascade_2(const masu_needs *n, const char **why) {
    return needs_cascade(n, 2, why);
}

static int needs_cascade_3(const masu_needs *n, const char **why) {
    return needs_cascade(n, 3, why);
}

static int needs_shadow(const masu_needs *n, const char **why) {
    return decided(n->shadow, "polygons cast shadows", no_shadow_map(n), why);
}

static int needs_probes(const masu_needs *n, const char **why) {
    return decided(n->probes, "the scene has light probes", "the scene has no light probes", why);
}

static int needs_light_tiles(const masu_needs *n, const char **why) {
    return decided(n->light_tiles, "the scene has local lights",
                   n->lights ? "rung.light_tiles is off" : "the scene has no local lights", why);
}

static int needs_ao(const masu_needs *n, const char **why) {
    return decided(n->ao, "the scene asks for ambient occlusion",
                   "the scene asks for no ambient occlusion, or rung.ao is off", why);
}

/* Whether something says how much light arrives. */
static int occluded(const masu_needs *n) { return n->sdf_occlusion || n->shadow || n->ao; }

static int needs_light(const masu_needs *n, const char **why) {
    return decided(n->scene && !occluded(n), "a scene is lit",
                   n->scene ? "light_occluded does it" : "no scene: a source image is upscaled", why);
}

static int needs_light_occluded(const masu_needs *n, const char **why) {
    return decided(occluded(n),
                   n->sdf_occlusion
                       ? "a scene is lit, and sdf_occlusion says how much arrives"
                   : n->shadow ? "a scene is lit, and shadow says how much arrives"
                               : "a scene is lit, and ao_upsample says how much arrives",
                   n->scene ? "light does it" : "no scene: a source image is upscaled", why);
}

static int needs_shading(const masu_needs *n, const char **why) {
    return decided(n->scene, "a scene is lit", "no scene: a source image is upscaled", why);
}

static const char *no_specular(const masu_needs *n) {
    return n->scene ? "nothing is glossy enough to trace, or rung.specular is off"
                    : "no scene: a source image is upscaled";
}

static int needs_specular(const masu_needs *n, const char **why) {
    return decided(n->specular, "reflections are traced", no_specular(n), why);
}

static int needs_specular_trace(const masu_needs *n, const char **why) {
    return decided(n->specular && n->traced && !n->query, "polygons are reflected",
                   !n->specular ? no_specular(n)
                   : n->query   ? "specular_query does it"
                                : "no instance is traced",
                   why);
}

static int needs_specular_query(const masu_needs *n, const char **why) {
    return decided(n->specular && n->query, "polygons are reflected, and the device has ray queries",
                   !n->specular ? no_specular(n)
                   : n->traced  ? "no ray queries, or desc.ray_query does not take them"
                                : "no instance is traced",
                   why);
}

static int needs_specular_trace_sdf(const masu_needs *n, const char **why) {
    return decided(n->specular && n->traced_sdf, "the SDF is reflected",
                   n->specular ? "no SDF is traced" : no_specular(n), why);
}

/* Why a filter of them does not run. */
static const char *no_filter(const masu_needs *n, const char *off) {
    return !n->specular    ? no_specular(n)
           : n->accumulate ? "debug.reference: nothing is filtered"
                           : off;
}

static int needs_specular_reuse(const masu_needs *n, const char **why) {
    return decided(n->reuse, "a ray's hit tells its neighbours something, too",
                   no_filter(n, "rung.specular_reuse is off"), why);
}

static int needs_specular_temporal(const masu_needs *n, const char **why) {
    return decided(n->temporal, "the mean over frames",
                   no_filter(n, "rung.specular_temporal is off"), why);
}

static int needs_specular_fine(const masu_needs *n, const char **why) {
    return decided(n->fine, "smooth surfaces show more than a mean over 2x2 pixels has",
                   no_filter(n, n->temporal ? "rung.specular_fine is off"
                                            : "without specular_temporal nothing is kept"),
                   why);
}

static int needs_specular_filter(const masu_needs *n, const char **why) {
    return decided(n->filter, "the mean over neighbours, where noise is left",
                   no_filter(n, "rung.specular_filter is off"), why);
}

static int needs_specular_taa(const masu_needs *n, const char **why) {
    return decided(n->taa, "what flickers is evened out",
                   no_filter(n, n->temporal ? "rung.specular_taa is off"
                                            : "without specular_temporal nothing is kept"),
                   why);
}

static int needs_specular_keep(const masu_needs *n, const char **why) {
    return decided(n->temporal, "the next frame's specular_temporal reads it",
                   no_filter(n, "rung.specular_temporal is off"), why);
}

static int needs_specular_accumulate(const masu_needs *n, const char **why) {
    return decided(n->specular && n->accumulate, "debug.reference: for comparison",
                   n->specular ? "debug.reference is off" : no_specular(n), why);
}

static int needs_transparents(const masu_needs *n, const char **why) {
    return decided(n->transparents, "some materials are blended",
                   n->scene ? "no material is blended" : "no scene: a source image is upscaled", why);
}

static int needs_readback(const masu_needs *n, const char **why) {
    return decided(n->scene && n->readback, "desc.readback asks for images",
                   "desc.readback asks for no image", why);
}

static int needs_upscale(const masu_needs *n, masu_easu way, const char **why) {
    return decided(n->upscale && !n->fused && n->easu == way,
                   "render size differs from output size, or rung.upscale is on",
                   n->fused     ? "fsr1 does it"
                   : n->upscale ? "rung.easu asks for another way"
                                : "render size is output size",
                   why);
}

static int needs_fxaa(const masu_needs *n, const char **why) {
    return decided(n->fxaa, "rung.aa asks for it", "rung.aa does not ask for it", why);
}

static int needs_smaa(const masu_needs *n, const char **why) {
    return decided(n->smaa, "rung.aa asks for it", "rung.aa does not ask for it", why);
}

static int needs_meter(const masu_needs *n, const char **why) {
    return decided(n->metered, "the exposure follows the picture",
                   n->scene ? "the exposure is given" : "no scene: a source image is upscaled", why);
}

static int needs_easu(const masu_needs *n, const char **why) {
    return needs_upscale(n, MASU_EASU_FULL, why);
}

static int needs_easu_fast(const masu_needs *n, const char **why) {
    return needs_upscale(n, MASU_EASU_FAST, why);
}

static int needs_bilinear(const masu_needs *n, const char **why) {
    return needs_upscale(n, MASU_EASU_BILINEAR, why);
}

static int needs_fsr1(const masu_needs *n, const char **why) {
    return decided(n->fused, "rung.fuse is on: what is upscaled is sharpened",
                   n->upscale && n->sharpen ? "rung.fuse is not on, or rung.easu is not full"
                                            : "render size is output size, or rung.sharpen is off",
                   why);
}

static int needs_rcas(const masu_needs *n, const char **why) {
    return decided(n->sharpen && !n->fused, "sharpens what EASU made, or rung.sharpen is on",
                   n->fused ? "fsr1 does it" : "nothing was upscaled, or rung.sharpen is off", why);
}

static int needs_present(const masu_needs *n, const char **why) {
    return decided(n->blit, "targets are no storage images",
                   "the last pass writes the target itself", why);
}

/* index.x: most SDF steps per ray or cone. */
static void march_params(const masu_rung *rung, struct masu_push *push) {
    push->index[0] = rung->march_steps;
}

/* Cones of 8x8 alone: those of 4x4 make no step and hand on what they got. */
static void cone4_params(const masu_rung *rung, struct masu_push *push) {
    push->index[0] = rung->march == MASU_MARCH_CONE8 ? 0 : rung->march_steps;
}

/* index.y: not 0: every tile gets all parts. */
static void classify_params(const masu_rung *rung, struct masu_push *push) {
    push->index[1] = rung->march == MASU_MARCH_UNPRUNED;
}

/* index.x: not 0: the tiles' lists of parts are there. */
static void sdf_velocity_params(const masu_rung *rung, struct masu_push *push) {
    push->index[0] = has_tiles(rung->march);
}

/* index.x: most SDF steps per shadow ray or reflected one; index.y: not 0: every block of pixels, or ray, gets
 * all parts. */
static void occlusion_params(const masu_rung *rung, struct masu_push *push) {
    push->index[0] = rung->march_steps;
    push->index[1] = rung->march == MASU_MARCH_UNPRUNED;
}

/* param.x: roughness from which reflections are not traced. 0: none are. */
static void specular_params(const masu_rung *rung, struct masu_push *push) {
    push->param[0] = rung->specular == MASU_OFF ? 0.0f : rung->specular_cutoff;
}

/* index.x: neighbours. */
static void reuse_params(const masu_rung *rung, struct masu_push *push) {
    specular_params(rung, push);
    push->index[0] = rung->specular_reuse_taps;
}

/* index.x: how far back the mean reaches, 1/60 s. */
static void temporal_params(const masu_rung *rung, struct masu_push *push) {
    specular_params(rung, push);
    push->index[0] = rung->specular_frames;
}

/* index.x: not 0: smooth surfaces have a mean for each pixel. */
static void composite_params(const masu_rung *rung, struct masu_push *push) {
    specular_params(rung, push);
    push->index[0] = rung->specular_fine != MASU_OFF && rung->specular_temporal != MASU_OFF;
}

/* index.x: neighbours; index.y: not 0: there is a mean over frames. */
static void filter_params(const masu_rung *rung, struct masu_push *push) {
    specular_params(rung, push);
    push->index[0] = rung->specular_filter_taps;
    push->index[1] = rung->specular_temporal != MASU_OFF;
}

/* index.x: not 0: tiles have lists of lights; else each pixel asks them all. */
static void light_params(const masu_rung *rung, struct masu_push *push) {
    push->index[0] = rung->light_tiles != MASU_OFF;
    specular_params(rung, push);
}

/* index.x: slices; index.y: samples on either side of each; record.c has the rest. */
static void ao_params(const masu_rung *rung, struct masu_push *push) {
    push->index[0] = rung->ao_slices;
    push->index[1] = rung->ao_steps;
}

/* param.x: threshold of luma in the steps of smaa/color.glsl. */
static void smaa_edges_params(const masu_rung *rung, struct masu_push *push) {
    static const float thresholds[] = {0.15f, 0.1f, 0.1f, 0.05f};
    push->param[0] = 2550000.0f * thresholds[rung->aa - MASU_AA_SMAA_LOW];
}

/* index.x: steps of a search; index.y: of one along a diagonal; param.x: not 0: corners. */
static void smaa_blend_params(const masu_rung *rung, struct masu_push *push) {
    static const uint32_t steps[] = {4, 8, 16, MASU_SMAA_STEPS_MAX};
    static const uint32_t diagonal_steps[] = {0, 0, 8, MASU_SMAA_DIAGONAL_STEPS_MAX};
    push->index[0] = steps[rung->aa - MASU_AA_SMAA_LOW];
    push->index[1] = diagonal_steps[rung->aa - MASU_AA_SMAA_LOW];
    push->param[0] = rung->aa >= MASU_AA_SMAA_HIGH ? 1.0f : 0.0f;
}

/* param.x: RCAS lobe scale. One stop halves the strength (AMD: con = exp2(-sharpness)). */
static void rcas_params(const masu_rung *rung, struct masu_push *push) {
    push->param[0] = exp2f(-rung->sharpness);
}

const masu_pass_row masu_passes[MASU_PASS_COUNT] = {
    /* clang-format off */
    [MASU_PASS_OCCLUDERS] = {
        "occluders", "depth of what hides much, at low resolution, for the camera and the sun",
        MASU_PASS_GRAPHICS, MASU_EXTENT_ATLAS, needs_occlusion, NULL,
        {{MASU_IMAGE_OCCLUDERS, MASU_WRITE_DEPTH}}, 0},
    [MASU_PASS_CULL] = {
        "cull", "which of the instances in view the occluders hide from the camera",
        MASU_PASS_COMPUTE, MASU_EXTENT_KEPT, needs_occlusion, NULL,
        {{MASU_IMAGE_OCCLUDERS, MASU_READ}, {MASU_RESOURCE_SEEN, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_COMPACT] = {
        "compact", "lists and counts of the rest, for the indirect draws of the camera",
        MASU_PASS_COMPUTE, MASU_EXTENT_BATCHES, needs_occlusion, NULL,
        {{MASU_RESOURCE_SEEN, MASU_READ_BUFFER}, {MASU_RESOURCE_DRAWS, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_GBUFFER] = {
        "gbuffer", "polygons: albedo, normal, roughness, metallic, depth, velocity where it is read",
        MASU_PASS_GRAPHICS, MASU_EXTENT_RENDER, needs_gbuffer, NULL,
        {{MASU_RESOURCE_DRAWS, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_WRITE_COLOR}, {MASU_IMAGE_NORMAL, MASU_WRITE_COLOR},
         {MASU_IMAGE_SURFACE, MASU_WRITE_COLOR}, {MASU_IMAGE_VELOCITY, MASU_WRITE_COLOR},
         {MASU_IMAGE_DEPTH, MASU_WRITE_DEPTH}}, 0},
    [MASU_PASS_UPDATE] = {
        "update", "SDF: slots that depend on parameters, time or the anchor",
        MASU_PASS_COMPUTE, MASU_EXTENT_ONE, needs_update, NULL,
        {{MASU_RESOURCE_SLOTS, MASU_WRITE_BUFFER}}, MASU_BLOB_UPDATE_SPIRV},
    [MASU_PASS_UPDATE_PREVIOUS] = {
        "update_previous", "the same slots with the parameters and the time of the frame before",
        MASU_PASS_COMPUTE, MASU_EXTENT_ONE, needs_update_previous, NULL,
        {{MASU_RESOURCE_SLOTS, MASU_WRITE_BUFFER}}, MASU_BLOB_UPDATE_PREVIOUS_SPIRV},
    [MASU_PASS_CLASSIFY] = {
        "classify", "SDF: parts that matter per 16x16 tile, list of tiles that have any",
        MASU_PASS_COMPUTE, MASU_EXTENT_TILE, needs_tiles, classify_params,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_RESOURCE_SLOTS, MASU_READ_BUFFER},
         {MASU_IMAGE_SCENE_DEPTH, MASU_WRITE}, {MASU_RESOURCE_TILES, MASU_WRITE_BUFFER}}, MASU_BLOB_CLASSIFY_SPIRV},
    [MASU_PASS_CONE8] = {
        "cone8", "SDF: one cone per 8x8 block, marched while all of the cone is free",
        MASU_PASS_COMPUTE, MASU_EXTENT_BLOCK8, needs_tiles, march_params,
        {{MASU_RESOURCE_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_CONE8, MASU_WRITE}}, MASU_BLOB_CONE8_SPIRV},
    [MASU_PASS_CONE4] = {
        "cone4", "the same per 4x4 block, from where its 8x8 block stopped",
        MASU_PASS_COMPUTE, MASU_EXTENT_BLOCK4, needs_cone4, cone4_params,
        {{MASU_IMAGE_CONE8, MASU_READ}, {MASU_RESOURCE_TILES, MASU_READ_BUFFER},
         {MASU_IMAGE_CONE4, MASU_WRITE}}, MASU_BLOB_CONE4_SPIRV},
    [MASU_PASS_MARCH] = {
        "march", "SDF: sphere tracing up to the raster depth; hits become G-buffer texels",
        MASU_PASS_COMPUTE, MASU_EXTENT_TILES, needs_march, march_params,
        {{MASU_IMAGE_CONE4, MASU_READ}, {MASU_RESOURCE_TILES, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_UPDATE},
         {MASU_IMAGE_NORMAL, MASU_UPDATE}, {MASU_IMAGE_SCENE_DEPTH, MASU_UPDATE}}, MASU_BLOB_MARCH_SPIRV},
    [MASU_PASS_MARCH_CHECKERBOARD] = {
        "march_checkerboard", "for comparison: 8x8 cones, then two phases with safe restarts",
        MASU_PASS_COMPUTE, MASU_EXTENT_TILES, needs_checkerboard, march_params,
        {{MASU_IMAGE_CONE8, MASU_READ}, {MASU_RESOURCE_TILES, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_UPDATE},
         {MASU_IMAGE_NORMAL, MASU_UPDATE}, {MASU_IMAGE_SCENE_DEPTH, MASU_UPDATE}}, MASU_BLOB_CHECKERBOARD_SPIRV},
    [MASU_PASS_MARCH_PLAIN] = {
        "march_plain", "for comparison: each pixel by itself",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_plain, march_params,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_RESOURCE_SLOTS, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_UPDATE},
         {MASU_IMAGE_NORMAL, MASU_UPDATE}, {MASU_IMAGE_SCENE_DEPTH, MASU_WRITE}}, MASU_BLOB_PLAIN_SPIRV},
    [MASU_PASS_MARCH_SEED] = {
        "march_seed", "for comparison: two phases with capped, unchecked restarts",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_seed, march_params,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_RESOURCE_SLOTS, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_UPDATE},
         {MASU_IMAGE_NORMAL, MASU_UPDATE}, {MASU_IMAGE_SCENE_DEPTH, MASU_WRITE}}, MASU_BLOB_SEED_SPIRV},
    [MASU_PASS_MARCH_FRAGMENT] = {
        "march_fragment", "for comparison: each pixel by itself, as a fragment shader",
        MASU_PASS_GRAPHICS, MASU_EXTENT_RENDER, needs_fragment, march_params,
        {{MASU_RESOURCE_SLOTS, MASU_READ_BUFFER}, {MASU_IMAGE_ALBEDO, MASU_WRITE_COLOR},
         {MASU_IMAGE_NORMAL, MASU_WRITE_COLOR}, {MASU_IMAGE_SCENE_DEPTH, MASU_WRITE_COLOR}}, MASU_BLOB_FRAGMENT_SPIRV},
    [MASU_PASS_VELOCITY] = {
        "velocity", "the sky's, where no polygon is",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_velocity, NULL,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_VELOCITY, MASU_UPDATE}}, 0},
    [MASU_PASS_SDF_VELOCITY] = {
        "sdf_velocity", "the SDF's and the sky's: where the part under the pixel was",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_sdf_velocity, sdf_velocity_params,
        {{MASU_IMAGE_DEPTH, MASU_READ}, {MASU_LATEST_DEPTH, MASU_READ},
         {MASU_RESOURCE_TILES, MASU_READ_BUFFER}, {MASU_RESOURCE_SLOTS, MASU_READ_BUFFER},
         {MASU_IMAGE_VELOCITY, MASU_UPDATE}}, MASU_BLOB_VELOCITY_SPIRV},
    [MASU_PASS_RECEIVERS] = {
        "receivers", "where the picture has surfaces, as the sun sees them",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_receivers, NULL,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ},
         {MASU_RESOURCE_SEEN, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_CULL_CASTERS] = {
        "cull_casters", "which casters the occluders hide from the sun, or shadow nothing in the picture",
        MASU_PASS_COMPUTE, MASU_EXTENT_KEPT, needs_casters, NULL,
        {{MASU_IMAGE_OCCLUDERS, MASU_READ}, {MASU_RESOURCE_SEEN, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_COMPACT_CASTERS] = {
        "compact_casters", "lists and counts of the rest, for the cascades",
        MASU_PASS_COMPUTE, MASU_EXTENT_BATCHES, needs_casters, NULL,
        {{MASU_RESOURCE_SEEN, MASU_READ_BUFFER}, {MASU_RESOURCE_DRAWS, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_CASCADE_0] = {
        "cascade_0", "what of the polygons the sun sees, nearest to the eye",
        MASU_PASS_GRAPHICS, MASU_EXTENT_SHADOW, needs_cascade_0, NULL,
        {{MASU_RESOURCE_DRAWS, MASU_READ_BUFFER}, {MASU_IMAGE_SHADOW_MAP, MASU_UPDATE_DEPTH}}, 0},
    [MASU_PASS_CASCADE_1] = {
        "cascade_1", "the same, farther",
        MASU_PASS_GRAPHICS, MASU_EXTENT_SHADOW, needs_cascade_1, NULL,
        {{MASU_RESOURCE_DRAWS, MASU_READ_BUFFER}, {MASU_IMAGE_SHADOW_MAP, MASU_UPDATE_DEPTH}}, 0},
    [MASU_PASS_CASCADE_2] = {
        "cascade_2", "the same, farther",
        MASU_PASS_GRAPHICS, MASU_EXTENT_SHADOW, needs_cascade_2, NULL,
        {{MASU_RESOURCE_DRAWS, MASU_READ_BUFFER}, {MASU_IMAGE_SHADOW_MAP, MASU_UPDATE_DEPTH}}, 0},
    [MASU_PASS_CASCADE_3] = {
        "cascade_3", "the same, farthest",
        MASU_PASS_GRAPHICS, MASU_EXTENT_SHADOW, needs_cascade_3, NULL,
        {{MASU_RESOURCE_DRAWS, MASU_READ_BUFFER}, {MASU_IMAGE_SHADOW_MAP, MASU_UPDATE_DEPTH}}, 0},
    [MASU_PASS_SDF_OCCLUSION] = {
        "sdf_occlusion", "SDF: seen part of the sun and of the ambient light, per surface",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_sdf_occlusion, occlusion_params,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ},
         {MASU_RESOURCE_SLOTS, MASU_READ_BUFFER}, {MASU_IMAGE_OCCLUSION, MASU_WRITE}}, MASU_BLOB_OCCLUSION_SPIRV},
    [MASU_PASS_SHADOW] = {
        "shadow", "seen part of the sun per surface, by the shadow map and what the SDF leaves",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_shadow, NULL,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_IMAGE_SHADOW_MAP, MASU_READ},
         {MASU_IMAGE_OCCLUSION, MASU_UPDATE}}, 0},
    [MASU_PASS_PROBES] = {
        "probes", "the frame's light at every light probe, of what was baked",
        MASU_PASS_COMPUTE, MASU_EXTENT_PROBES, needs_probes, NULL,
        {{MASU_RESOURCE_PROBES, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_LIGHT_TILES] = {
        "light_tiles", "which points and spots reach a surface of each 16x16 tile",
        MASU_PASS_COMPUTE, MASU_EXTENT_TILE, needs_light_tiles, NULL,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_RESOURCE_LIGHT_TILES, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_AO] = {
        "ao", "seen part of the ambient light past what the picture shows, at half size",
        MASU_PASS_COMPUTE, MASU_EXTENT_HALF, needs_ao, ao_params,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_IMAGE_AO, MASU_WRITE}}, 0},
    [MASU_PASS_AO_UPSAMPLE] = {
        "ao_upsample", "the same per surface, with what sdf_occlusion and shadow have found",
        MASU_PASS_COMPUTE, MASU_EXTENT_HALF, needs_ao, NULL,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_IMAGE_AO, MASU_READ},
         {MASU_IMAGE_OCCLUSION, MASU_UPDATE}}, 0},
    [MASU_PASS_LIGHT] = {
        "light", "sun, local lights, ambient light, sky",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_light, light_params,
        {{MASU_RESOURCE_LIGHT_TILES, MASU_READ_BUFFER}, {MASU_RESOURCE_PROBES, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_LATEST_DEPTH, MASU_READ},
         {MASU_IMAGE_SURFACE, MASU_READ}, {MASU_IMAGE_HDR, MASU_WRITE}}, 0},
    [MASU_PASS_LIGHT_OCCLUDED] = {
        "light_occluded", "the same, as far as sdf_occlusion, shadow and ao let it through",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_light_occluded, light_params,
        {{MASU_RESOURCE_LIGHT_TILES, MASU_READ_BUFFER},
         {MASU_IMAGE_ALBEDO, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_LATEST_DEPTH, MASU_READ},
         {MASU_IMAGE_OCCLUSION, MASU_READ}, {MASU_IMAGE_SURFACE, MASU_READ},
         {MASU_RESOURCE_PROBES, MASU_READ_BUFFER}, {MASU_IMAGE_HDR, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_GUIDE] = {
        "specular_guide", "reflections: the pixel of each 2x2 that is traced, tiles that have any",
        MASU_PASS_COMPUTE, MASU_EXTENT_TRACED, needs_specular, specular_params,
        {{MASU_IMAGE_ALBEDO, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_LATEST_DEPTH, MASU_READ},
         {MASU_IMAGE_SURFACE, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_WRITE_BUFFER}, {MASU_IMAGE_SPECULAR_GUIDE, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_RAYS] = {
        "specular_rays", "a direction for each, as the surface scatters",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular, specular_params,
        {{MASU_IMAGE_ALBEDO, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_LATEST_DEPTH, MASU_READ},
         {MASU_IMAGE_SURFACE, MASU_READ}, {MASU_IMAGE_SPECULAR_GUIDE, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_RAY, MASU_WRITE},
         {MASU_IMAGE_SPECULAR_HIT, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_TRACE] = {
        "specular_trace", "the polygon that each ray meets first",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_trace, NULL,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_RAY, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_HIT, MASU_UPDATE}}, 0},
    [MASU_PASS_SPECULAR_STRUCTURE] = {
        "specular_structure", "ray queries: the tree over the frame's instances",
        MASU_PASS_BUILD, MASU_EXTENT_ONE, needs_specular_query, NULL,
        {{MASU_RESOURCE_TOP_LEVEL, MASU_WRITE_STRUCTURE}}, 0},
    [MASU_PASS_SPECULAR_QUERY] = {
        "specular_query", "the polygon that each ray meets first, asked of the device",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_query, NULL,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_RAY, MASU_READ},
         {MASU_RESOURCE_TOP_LEVEL, MASU_READ_STRUCTURE},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_HIT, MASU_UPDATE}}, 0},
    [MASU_PASS_SPECULAR_TRACE_SDF] = {
        "specular_trace_sdf", "the SDF, where it is nearer",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_trace_sdf, occlusion_params,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_RAY, MASU_READ},
         {MASU_RESOURCE_SLOTS, MASU_READ_BUFFER},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_HIT, MASU_UPDATE}},
        MASU_BLOB_TRACE_SDF_SPIRV},
    [MASU_PASS_SPECULAR_SHADE] = {
        "specular_shade", "the light that comes from there, the sky's where nothing is",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular, light_params,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ},
         {MASU_IMAGE_SPECULAR_RAY, MASU_READ}, {MASU_IMAGE_SPECULAR_HIT, MASU_READ},
         {MASU_IMAGE_VELOCITY, MASU_READ}, {MASU_IMAGE_SHADOW_MAP, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_RESOURCE_PROBES, MASU_READ_BUFFER},
         {MASU_IMAGE_SPECULAR_LIGHT, MASU_WRITE}, {MASU_IMAGE_SPECULAR_MOTION, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_REUSE] = {
        "specular_reuse", "with what the neighbours' rays have met, weighed by the texel's own lobe",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_reuse, reuse_params,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_RAY, MASU_READ},
         {MASU_IMAGE_SPECULAR_LIGHT, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_REUSED, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_TEMPORAL] = {
        "specular_temporal", "the mean over frames, found again by the motion of surface and mirrored thing",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_temporal, temporal_params,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_LATEST_SPECULAR, MASU_READ},
         {MASU_IMAGE_SPECULAR_MOTION, MASU_READ}, {MASU_IMAGE_VELOCITY, MASU_READ},
         {MASU_IMAGE_SPECULAR_OLD_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_OLD_MEAN, MASU_READ},
         {MASU_IMAGE_SPECULAR_OLD_AGE, MASU_READ}, {MASU_IMAGE_SPECULAR_LIGHT, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER},
         {MASU_IMAGE_SPECULAR_MEAN, MASU_WRITE}, {MASU_IMAGE_SPECULAR_AGE, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_FINE] = {
        "specular_fine", "smooth surfaces: the mean over frames of each pixel's own rays",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_fine, temporal_params,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_LIGHT, MASU_READ},
         {MASU_IMAGE_SPECULAR_MEAN, MASU_READ}, {MASU_IMAGE_SPECULAR_AGE, MASU_READ}, {MASU_IMAGE_VELOCITY, MASU_READ},
         {MASU_IMAGE_SPECULAR_OLD_GUIDE, MASU_READ},
         {MASU_IMAGE_SPECULAR_OLD_FINE, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_FINE, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_FILTER] = {
        "specular_filter", "the mean over neighbours of the same surface, as far as noise is left",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_filter, filter_params,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_LATEST_SPECULAR, MASU_READ},
         {MASU_IMAGE_SPECULAR_AGE, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_SMOOTH, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_TAA] = {
        "specular_taa", "a second, short mean over frames of what is shown",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_taa, NULL,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_LATEST_SPECULAR, MASU_READ},
         {MASU_IMAGE_SPECULAR_AGE, MASU_READ}, {MASU_IMAGE_SPECULAR_OLD_STEADY, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_STEADY, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_KEEP] = {
        "specular_keep", "what the next frame reads of this one",
        MASU_PASS_COMPUTE, MASU_EXTENT_TRACED, needs_specular_keep, NULL,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_MEAN, MASU_READ},
         {MASU_IMAGE_SPECULAR_AGE, MASU_READ}, {MASU_LATEST_SPECULAR, MASU_READ},
         {MASU_IMAGE_SPECULAR_OLD_GUIDE, MASU_WRITE}, {MASU_IMAGE_SPECULAR_OLD_MEAN, MASU_WRITE},
         {MASU_IMAGE_SPECULAR_OLD_AGE, MASU_WRITE}, {MASU_IMAGE_SPECULAR_OLD_STEADY, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_KEEP_FINE] = {
        "specular_keep_fine", "the same of the means of pixels",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_fine, NULL,
        {{MASU_IMAGE_SPECULAR_FINE, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_OLD_FINE, MASU_WRITE}}, 0},
    [MASU_PASS_SPECULAR_ACCUMULATE] = {
        "specular_accumulate", "for comparison: the sum over frames, of every pixel",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular_accumulate, NULL,
        {{MASU_IMAGE_SPECULAR_GUIDE, MASU_READ}, {MASU_IMAGE_SPECULAR_LIGHT, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_SPECULAR_SUM, MASU_UPDATE}}, 0},
    [MASU_PASS_SPECULAR_COMPOSITE] = {
        "specular_composite", "what is reflected, at full size, added to what is lit",
        MASU_PASS_COMPUTE, MASU_EXTENT_GLOSSY, needs_specular, composite_params,
        {{MASU_IMAGE_ALBEDO, MASU_READ}, {MASU_IMAGE_NORMAL, MASU_READ}, {MASU_LATEST_DEPTH, MASU_READ},
         {MASU_IMAGE_SURFACE, MASU_READ}, {MASU_IMAGE_SPECULAR_GUIDE, MASU_READ},
         {MASU_LATEST_SPECULAR, MASU_READ}, {MASU_IMAGE_SPECULAR_FINE, MASU_READ},
         {MASU_RESOURCE_SPECULAR_TILES, MASU_READ_BUFFER}, {MASU_IMAGE_HDR, MASU_UPDATE}}, 0},
    [MASU_PASS_TRANSPARENTS] = {
        "transparents", "glass, smoke: the farthest first, over what is lit",
        MASU_PASS_GRAPHICS, MASU_EXTENT_RENDER, needs_transparents, NULL,
        {{MASU_LATEST_DEPTH, MASU_READ}, {MASU_IMAGE_SHADOW_MAP, MASU_READ},
         {MASU_IMAGE_HDR, MASU_BLEND_COLOR}}, 0},
    [MASU_PASS_READBACK] = {
        "readback", "copies the images the host asked for",
        MASU_PASS_TRANSFER, MASU_EXTENT_RENDER, needs_readback, NULL,
        {{MASU_IMAGE_ALBEDO, MASU_READ_COPY}, {MASU_IMAGE_NORMAL, MASU_READ_COPY},
         {MASU_LATEST_DEPTH, MASU_READ_COPY}, {MASU_IMAGE_HDR, MASU_READ_COPY},
         {MASU_IMAGE_VELOCITY, MASU_READ_COPY}, {MASU_IMAGE_OCCLUSION, MASU_READ_COPY},
         {MASU_IMAGE_SHADOW_MAP, MASU_READ_COPY}}, 0},
    [MASU_PASS_METER] = {
        "meter", "how many pixels of each luminance the picture has",
        MASU_PASS_COMPUTE, MASU_EXTENT_BLOCK4, needs_meter, NULL,
        {{MASU_IMAGE_HDR, MASU_READ}, {MASU_RESOURCE_EXPOSURE, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_EXPOSE] = {
        "expose", "the exposure that they ask for, as far as time lets it adapt",
        MASU_PASS_COMPUTE, MASU_EXTENT_ONE, needs_meter, NULL,
        {{MASU_RESOURCE_EXPOSURE, MASU_WRITE_BUFFER}}, 0},
    [MASU_PASS_TONEMAP] = {
        "tonemap", "exposure, tone curve, encoding",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_shading, NULL,
        {{MASU_RESOURCE_EXPOSURE, MASU_READ_BUFFER}, {MASU_IMAGE_HDR, MASU_READ},
         {MASU_IMAGE_LDR, MASU_WRITE}}, 0},
    [MASU_PASS_FXAA] = {
        "fxaa", "edges blurred along their direction",
        MASU_PASS_COMPUTE, MASU_EXTENT_RENDER, needs_fxaa, NULL,
        {{MASU_UNSMOOTHED, MASU_READ}, {MASU_IMAGE_SMOOTH, MASU_WRITE}}, 0},
    [MASU_PASS_SMAA_EDGES] = {
        "smaa_edges", "SMAA: edges of luma, list of tiles that have any, a copy of the picture",
        MASU_PASS_COMPUTE, MASU_EXTENT_TILE, needs_smaa, smaa_edges_params,
        {{MASU_UNSMOOTHED, MASU_READ}, {MASU_RESOURCE_SMAA_TILES, MASU_WRITE_BUFFER},
         {MASU_IMAGE_SMOOTH, MASU_WRITE}}, 0},
    [MASU_PASS_SMAA_BLEND] = {
        "smaa_blend", "SMAA: lines behind the edges, what they cover; pixels blended by it",
        MASU_PASS_COMPUTE, MASU_EXTENT_EDGED, needs_smaa, smaa_blend_params,
        {{MASU_UNSMOOTHED, MASU_READ}, {MASU_RESOURCE_SMAA_TILES, MASU_READ_BUFFER},
         {MASU_IMAGE_SMOOTH, MASU_UPDATE}}, 0},
    [MASU_PASS_EASU] = {
        "easu", "FSR1 edge-adaptive spatial upsampling",
        MASU_PASS_COMPUTE, MASU_EXTENT_OUTPUT, needs_easu, NULL,
        {{MASU_LATEST_COLOR, MASU_READ}, {MASU_IMAGE_UPSCALED, MASU_WRITE}}, 0},
    [MASU_PASS_EASU_FAST] = {
        "easu_fast", "the same for less: flat places left out, edges looked at once",
        MASU_PASS_COMPUTE, MASU_EXTENT_OUTPUT, needs_easu_fast, NULL,
        {{MASU_LATEST_COLOR, MASU_READ}, {MASU_IMAGE_UPSCALED, MASU_WRITE}}, 0},
    [MASU_PASS_BILINEAR] = {
        "bilinear", "upsampling by the four texels around, for comparison",
        MASU_PASS_COMPUTE, MASU_EXTENT_OUTPUT, needs_bilinear, NULL,
        {{MASU_LATEST_COLOR, MASU_READ}, {MASU_IMAGE_UPSCALED, MASU_WRITE}}, 0},
    [MASU_PASS_FSR1] = {
        "fsr1", "EASU and RCAS in one",
        MASU_PASS_COMPUTE, MASU_EXTENT_OUTPUT, needs_fsr1, rcas_params,
        {{MASU_LATEST_COLOR, MASU_READ}, {MASU_IMAGE_FINAL, MASU_WRITE}}, 0},
    [MASU_PASS_RCAS] = {
        "rcas", "FSR1 robust contrast-adaptive sharpening",
        MASU_PASS_COMPUTE, MASU_EXTENT_OUTPUT, needs_rcas, rcas_params,
        {{MASU_LATEST_COLOR, MASU_READ}, {MASU_IMAGE_FINAL, MASU_WRITE}}, 0},
    [MASU_PASS_PRESENT] = {
        "present", "blit or copy to a target that is no storage image",
        MASU_PASS_TRANSFER, MASU_EXTENT_OUTPUT, needs_present, NULL,
        {{MASU_LATEST_COLOR, MASU_READ_COPY}, {MASU_IMAGE_TARGET, MASU_WRITE_COPY}}, 0},
    /* clang-format on */
};

int masu_usage_writes(masu_usage usage) { return usage >= MASU_WRITE; }

int masu_is_cascade(uint32_t pass) {
    return pass >= MASU_PASS_CASCADE_0 && pass <= MASU_PASS_CASCADE_3;
}

int masu_has_set(uint32_t pass) {
    return masu_passes[pass].kind == MASU_PASS_COMPUTE || pass == MASU_PASS_TRANSPARENTS;
}

int masu_access_binds(masu_access access, int writes) {
    if (!writes) return access.usage == MASU_READ;
    return access.usage == MASU_WRITE || access.usage == MASU_UPDATE;
}

VkExtent2D masu_extent_of(masu_image_extent extent, VkExtent2D render, VkExtent2D output) {
    uint32_t block = extent == MASU_EXTENT_HALF || extent == MASU_EXTENT_TRACED ||
                             extent == MASU_EXTENT_GLOSSY
                         ? 2
                     : extent == MASU_EXTENT_BLOCK8 ? 8
                     : extent == MASU_EXTENT_BLOCK4 ? 4
                     : extent == MASU_EXTENT_TILE || extent == MASU_EXTENT_EDGED ? MASU_TILE
                                                    : 1;
    if (extent == MASU_EXTENT_ATLAS)
        return (VkExtent2D){MASU_ATLAS_WIDTH, MASU_ATLAS_HEIGHT};
    if (extent == MASU_EXTENT_ONE || extent == MASU_EXTENT_KEPT || extent == MASU_EXTENT_BATCHES ||
        extent == MASU_EXTENT_PROBES)
        return (VkExtent2D){1, 1};
    if (extent == MASU_EXTENT_SHADOW) return (VkExtent2D){0, 0};
    VkExtent2D size = extent == MASU_EXTENT_OUTPUT ? output : render;
    return (VkExtent2D){(size.width + block - 1) / block, (size.height + block - 1) / block};
}

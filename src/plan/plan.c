/* plan.c: see plan.h. */
#include "plan/plan.h"

#include "scene/blob.h"
#include "base/error.h"
#include "plan/desc.h"
#include "frame/lights.h"
#include "plan/output.h"
#include "device/ray_query.h"
#include "frame/specular.h"
#include "frame/transparents.h"

#include <math.h>
#include <string.h>

uint32_t masu_format_bytes(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R32G32_UINT: return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT: return 16;
    default: return 4;
    }
}

/* ---- One rung -------------------------------------------------------------------------------- */

/* Render size of a scale: at least one pixel, rounded to nearest. 1080 lines give 864 at 0.8 and
 * 432 at 0.4. */
static uint32_t scaled(uint32_t size, float scale) {
    double v = floor((double)size * (double)scale + 0.5);
    return v < 1.0 ? 1u : v > (double)size ? size : (uint32_t)v;
}

static void resolve_switches(const masu_desc *d, masu_rung_plan *rp, const masu_rung *rung,
                             masu_needs *needs) {
    int same = rp->render_width == d->output.width && rp->render_height == d->output.height;
    needs->upscale = rung->upscale == MASU_ON || !same;
    needs->easu = rung->easu == MASU_EASU_AUTO ? MASU_EASU_FULL : rung->easu;
    int plain = needs->easu == MASU_EASU_BILINEAR; /* what it blurs, RCAS would not bring back */
    needs->sharpen =
        rung->sharpen == MASU_ON || (rung->sharpen == MASU_AUTO && needs->upscale && !plain);
    needs->fxaa = rung->aa == MASU_AA_FXAA;
    needs->smaa = rung->aa >= MASU_AA_SMAA_LOW;
    needs->fused = needs->upscale && needs->sharpen && needs->easu == MASU_EASU_FULL &&
                   rung->fuse == MASU_ON && !(d->scene && d->deep_color == MASU_ON);
    /* Upscaling only, at ratio 1, with everything off: something has to write the target. */
    int writes = needs->scene || needs->upscale || needs->sharpen || needs->fxaa || needs->smaa;
    if (!writes) needs->upscale = 1;
}

/* ---- The shadow map -------------------------------------------------------------------------- */

/* One below the other, but for four: up to 2048 a square is within the size that every device
 * has. */
static uint32_t cascade_columns(const masu_frame_plan *plan) { return plan->cascades == 4 ? 2 : 1; }

VkOffset2D masu_cascade_place(const masu_frame_plan *plan, uint32_t cascade) {
    uint32_t columns = cascade_columns(plan);
    return (VkOffset2D){(int32_t)(cascade % columns * plan->cascade_size),
                        (int32_t)(cascade / columns * plan->cascade_size)};
}

VkExtent2D masu_plan_extent(const masu_frame_plan *plan, masu_image_extent extent,
                            VkExtent2D render) {
    uint32_t columns = cascade_columns(plan);
    if (extent == MASU_EXTENT_HALF && plan->desc.debug.ao_full) return render;
    int traced = extent == MASU_EXTENT_TRACED || extent == MASU_EXTENT_GLOSSY;
    if (traced && plan->desc.debug.reference) return render;
    if (extent != MASU_EXTENT_SHADOW) return masu_extent_of(extent, render, plan->desc.output);
    return (VkExtent2D){columns * plan->cascade_size,
                        (plan->cascades + columns - 1) / columns * plan->cascade_size};
}

uint32_t masu_recording_variant(const masu_rung_plan *rung, uint32_t drawn) {
    uint32_t variant = 0, bit = 0;
    for (uint32_t k = 0; k < rung->cascades; k++) {
        if (rung->slow & 1u << k) variant |= (drawn >> k & 1u) << bit++;
    }
    return variant;
}

int masu_variant_draws(const masu_rung_plan *rung, uint32_t variant, uint32_t cascade) {
    uint32_t only = 1u << cascade;
    if (cascade >= rung->cascades) return 0;
    return !(rung->slow & only) || (masu_recording_variant(rung, only) & variant) != 0;
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
    plan->images[MASU_IMAGE_SHADOW_MAP].persistent |= rp->slow != 0;
    plan->needs.cascades = rp->cascades;
    rp->first_recording = plan->recordings;
    plan->recordings += rp->variants * plan->desc.targets.count;
}

/* Which concrete image an access of the table means in this rung, or NONE if there is no such image
 * in this plan. */
static masu_image_id resolve(uint8_t image, const masu_image_id latest[MASU_CLASS_COUNT]) {
    if (image == MASU_LATEST_DEPTH) return latest[MASU_CLASS_DEPTH];
    if (image == MASU_LATEST_COLOR) return latest[MASU_CLASS_COLOR];
    if (image == MASU_LATEST_SPECULAR) return latest[MASU_CLASS_SPECULAR];
    return (masu_image_id)image;
}

static int keeps_access(const masu_frame_plan *plan, masu_pass_id pass, masu_image_id image) {
    if (image == MASU_IMAGE_NONE) return 0;
    if (image == MASU_IMAGE_VELOCITY && !plan->needs.velocity) return 0;
    if (image == MASU_IMAGE_SURFACE && !plan->needs.surface) return 0;
    if (image == MASU_IMAGE_SPECULAR_OLD_STEADY && !plan->needs.steady) return 0;
    if (image == MASU_IMAGE_SPECULAR_FINE && !plan->needs.finest) return 0;
    if (pass != MASU_PASS_SHADOW && pass != MASU_PASS_READBACK && !masu_is_cascade(pass) &&
        image == MASU_IMAGE_SHADOW_MAP) {
        return plan->needs.shadow;
    }
    /* It asks which pixels are polygons; without polygons nobody has written that depth. */
    if (pass == MASU_PASS_SDF_VELOCITY && image == MASU_IMAGE_DEPTH) return plan->needs.raster;
    if (pass == MASU_PASS_READBACK && image == MASU_IMAGE_OCCLUSION && !plan->needs.sdf_occlusion &&
        !plan->needs.shadow && !plan->needs.ao) {
        return 0; /* nothing of this rung writes it */
    }
    if (pass == MASU_PASS_READBACK) {
        return (masu_images[image].readback & plan->desc.readback) != 0;
    }
    return 1;
}

static void compile_rung(masu_frame_plan *plan, uint32_t r) {
    masu_rung_plan *rp = &plan->rungs[r];
    masu_image_id latest[MASU_CLASS_COUNT] = {MASU_IMAGE_NONE};
    if (!plan->needs.scene) latest[MASU_CLASS_COLOR] = MASU_IMAGE_SOURCE;
    int last_color_pass = -1, last_color_access = 0;
    for (int p = 0; p < MASU_PASS_COUNT; p++) {
        const masu_pass_row *row = &masu_passes[p];
        const char *why = "";
        int runs = row->decide(&plan->needs, &why);
        if (r == 0 || (runs && !(plan->rungs[0].active & MASU_PASS_BIT(p)))) plan->why[p] = why;
        if (!runs) continue;
        rp->active |= MASU_PASS_BIT(p);
        for (uint32_t a = 0; a < MASU_PASS_ACCESSES && row->access[a].image; a++) {
            masu_image_id image = resolve(row->access[a].image, latest);
            if (row->access[a].image == MASU_UNSMOOTHED)
                image = plan->needs.scene ? MASU_IMAGE_LDR : MASU_IMAGE_SOURCE;
            if (image == (masu_image_id)MASU_RESOURCE_DRAWS && !plan->needs.occlusion) {
                continue; /* the host has written them */
            }
            if (image == MASU_RESOURCE_PROBES && !plan->needs.probes) continue;
            if (image == (masu_image_id)MASU_RESOURCE_EXPOSURE && !plan->needs.metered) continue;
            if (image == (masu_image_id)MASU_RESOURCE_LIGHT_TILES && !plan->needs.light_tiles)
                continue;
            if (image < MASU_IMAGE_COUNT && !keeps_access(plan, (masu_pass_id)p, image)) continue;
            rp->access[p][rp->access_count[p]++] =
                (masu_access){(uint8_t)image, row->access[a].usage};
            if (!masu_usage_writes((masu_usage)row->access[a].usage)) continue;
            if (image > MASU_IMAGE_COUNT) continue;
            latest[masu_images[image].class_of] = image;
            if (masu_images[image].class_of == MASU_CLASS_COLOR) {
                last_color_pass = p;
                last_color_access = (int)rp->access_count[p] - 1;
            }
        }
    }
    /* The last colour pass writes the target itself (a blit, where there is one, does so anyway), and so do
     * those before it whose image it only completes. */
    if (last_color_pass < 0) return;
    uint8_t last = rp->access[last_color_pass][last_color_access].image;
    for (int p = 0; p <= last_color_pass; p++) {
        for (uint32_t a = 0; a < rp->access_count[p]; a++) {
            if (rp->access[p][a].image == last) rp->access[p][a].image = MASU_IMAGE_TARGET;
        }
    }
}

/* ---- All rungs ------------------------------------------------------------------------------- */

static VkImageUsageFlags usage_flag(masu_usage usage) {
    switch (usage) {
    case MASU_READ: return VK_IMAGE_USAGE_SAMPLED_BIT;
    case MASU_READ_COPY: return VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    case MASU_WRITE:
    case MASU_UPDATE: return VK_IMAGE_USAGE_STORAGE_BIT;
    case MASU_WRITE_COLOR:
    case MASU_BLEND_COLOR: return VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    case MASU_WRITE_DEPTH:
    case MASU_UPDATE_DEPTH: return VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    case MASU_WRITE_COPY: return VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    case MASU_READ_BUFFER:
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
                if (id >= MASU_IMAGE_SOURCE) continue; /* the host's, or a buffer */
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
            }
            if (!(rp->active & MASU_PASS_BIT(p)) || !masu_has_set(p)) continue;
            plan->pass_sets += writes_target ? plan->desc.targets.count : 1;
        }
    }
}

static void lay_drawn(masu_frame_plan *plan) {
    const masu_scene *s = plan->desc.scene;
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
    d->words = next + MASU_TRANSPARENT_WORDS * (uint64_t)s->transparents;
}

static void size_light_buffers(masu_frame_plan *plan, uint64_t storage_alignment) {
    masu_buffer_plan *lights = &plan->buffers[MASU_BUFFER_LIGHTS];
    masu_buffer_plan *tiles = &plan->buffers[MASU_BUFFER_LIGHT_TILES];
    lights->count = plan->scene.lights;
    lights->stride = masu_align_up(
        sizeof(masu_light_header) + lights->count * sizeof(struct masu_local_light_data),
        storage_alignment);
    lights->bytes = plan->desc.frames_in_flight * lights->stride;
    tiles->count = 1; /* it is bound even where all rungs go without */
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        VkExtent2D render = {plan->rungs[r].render_width, plan->rungs[r].render_height};
        VkExtent2D grid = masu_extent_of(MASU_EXTENT_TILE, render, plan->desc.output);
        uint64_t words = (uint64_t)grid.width * grid.height *
                         MASU_LIGHT_LIST_WORDS(plan->scene.lights);
        if (plan->desc.rungs[r].light_tiles != MASU_OFF && words > tiles->count)
            tiles->count = words;
    }
    tiles->bytes = tiles->count * sizeof(uint32_t);
}

/* The scene that rays meet: what stays, and of each frame in flight what moves. */
static void size_trace_buffers(masu_frame_plan *plan, uint64_t storage_alignment) {
    masu_buffer_plan *b = plan->buffers;
    const masu_scene *s = plan->desc.scene;
    b[MASU_BUFFER_TRACE].count = masu_trace_scene_bytes(s) / 16;
    b[MASU_BUFFER_TRACE].bytes = 16 * b[MASU_BUFFER_TRACE].count;
    if (plan->needs.traced) {
        b[MASU_BUFFER_TRACE_FRAME].count = s->trace_instances;
        b[MASU_BUFFER_TRACE_FRAME].stride =
            masu_align_up(masu_trace_slot_bytes(s, plan->needs.query), storage_alignment);
        b[MASU_BUFFER_TRACE_FRAME].bytes =
            plan->desc.frames_in_flight * b[MASU_BUFFER_TRACE_FRAME].stride;
    }
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        VkExtent2D render = {plan->rungs[r].render_width, plan->rungs[r].render_height};
        VkExtent2D traced = masu_plan_extent(plan, MASU_EXTENT_TRACED, render);
        uint64_t words = MASU_TILES_HEADER + (uint64_t)((traced.width + MASU_GROUP - 1) / MASU_GROUP) *
                                                 ((traced.height + MASU_GROUP - 1) / MASU_GROUP);
        if (words > b[MASU_BUFFER_SPECULAR_TILES].count) b[MASU_BUFFER_SPECULAR_TILES].count = words;
    }
    b[MASU_BUFFER_SPECULAR_TILES].bytes =
        b[MASU_BUFFER_SPECULAR_TILES].count * sizeof(uint32_t);
}

/* Returns the bytes of one readback slot that counters take. */
static uint64_t size_counters(masu_frame_plan *plan) {
    masu_buffer_plan *counters = &plan->buffers[MASU_BUFFER_COUNTERS];
    counters->count = 2 * MASU_COUNTER_COUNT;
    counters->bytes = 2 * MASU_COUNTER_COUNT * sizeof(uint32_t);
    return plan->desc.debug.counters ? masu_align_up(counters->bytes, 16) : 0;
}

static int has_smaa(const masu_rung *rung) { return rung->aa >= MASU_AA_SMAA_LOW; }

static void size_smaa_buffers(masu_frame_plan *plan) {
    masu_buffer_plan *area = &plan->buffers[MASU_BUFFER_SMAA_AREA];
    masu_buffer_plan *tiles = &plan->buffers[MASU_BUFFER_SMAA_TILES];
    area->count = MASU_SMAA_AREA_WORDS;
    area->bytes = area->count * sizeof(uint32_t);
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        VkExtent2D render = {plan->rungs[r].render_width, plan->rungs[r].render_height};
        VkExtent2D grid = masu_extent_of(MASU_EXTENT_TILE, render, plan->desc.output);
        uint64_t words =
            MASU_TILES_HEADER + (uint64_t)grid.width * grid.height * (1 + MASU_SMAA_WORDS);
        if (has_smaa(&plan->desc.rungs[r]) && words > tiles->count) tiles->count = words;
    }
    tiles->bytes = tiles->count * sizeof(uint32_t);
}

/* What only a scene needs. Returns the bytes of one readback slot that its counters take. */
static uint64_t size_scene_buffers(masu_frame_plan *plan, uint64_t uniform_alignment,
                                   uint64_t storage_alignment) {
    masu_buffer_plan *b = plan->buffers;
    const masu_scene *s = plan->desc.scene;
    uint64_t flights = plan->desc.frames_in_flight;
    b[MASU_BUFFER_TABLES].count =
        plan->needs.raster && s->coats ? MASU_TABLE_WORDS_ALL : MASU_TABLE_WORDS;
    b[MASU_BUFFER_TABLES].count +=
        masu_blob_environment_texels(s->environment_size, s->environment_mips);
    b[MASU_BUFFER_TABLES].bytes = b[MASU_BUFFER_TABLES].count * sizeof(uint32_t);
    /* With the frame before: each slot has two halves, its own and that of the frame before it. */
    uint64_t halves = plan->needs.velocity ? 2 : 1;
    b[MASU_BUFFER_FRAME].count = halves * flights;
    b[MASU_BUFFER_FRAME].stride =
        halves * masu_align_up(sizeof(struct masu_frame_uniforms), uniform_alignment);
    b[MASU_BUFFER_FRAME].bytes = flights * b[MASU_BUFFER_FRAME].stride;
    if (plan->needs.shadow) {
        b[MASU_BUFFER_SHADOW].count = flights;
        b[MASU_BUFFER_SHADOW].stride =
            masu_align_up(sizeof(struct masu_shadow_uniforms), uniform_alignment);
        b[MASU_BUFFER_SHADOW].bytes = flights * b[MASU_BUFFER_SHADOW].stride;
    }
    if (plan->needs.sky) {
        b[MASU_BUFFER_SKY].count = flights;
        b[MASU_BUFFER_SKY].stride =
            masu_align_up(sizeof(struct masu_sky_uniforms), uniform_alignment);
        b[MASU_BUFFER_SKY].bytes = flights * b[MASU_BUFFER_SKY].stride;
    }
    for (uint32_t r = 0; r < plan->desc.rung_count && s->sdf; r++) {
        VkExtent2D render = {plan->rungs[r].render_width, plan->rungs[r].render_height};
        VkExtent2D tiles = masu_extent_of(MASU_EXTENT_TILE, render, plan->desc.output);
        uint64_t list = s->sdf_parts <= MASU_TILE_MASKED_MAX ? (s->sdf_parts + 31) / 32
                                                             : 1 + MASU_TILE_PARTS_MAX;
        uint64_t words = MASU_TILES_HEADER + (uint64_t)tiles.width * tiles.height * (1 + list);
        if (words > b[MASU_BUFFER_TILES].count) b[MASU_BUFFER_TILES].count = words;
    }
    b[MASU_BUFFER_TILES].bytes = b[MASU_BUFFER_TILES].count * sizeof(uint32_t);
    if (plan->needs.reflections) size_trace_buffers(plan, storage_alignment);
    if (s->lights) size_light_buffers(plan, storage_alignment);
    if (s->instances) {
        b[MASU_BUFFER_INSTANCES].count *= halves;
        b[MASU_BUFFER_INSTANCES].stride =
            halves * masu_align_up((uint64_t)s->instances * sizeof(struct masu_instance_data),
                                   storage_alignment);
        b[MASU_BUFFER_INSTANCES].bytes = flights * b[MASU_BUFFER_INSTANCES].stride;
        lay_drawn(plan);
        b[MASU_BUFFER_DRAWS].count = (uint64_t)plan->views * plan->draws;
        if (plan->occlusion)
            b[MASU_BUFFER_DRAWS].count = 2 * b[MASU_BUFFER_DRAWS].count + MASU_ATLAS_PARTS(plan);
        plan->transparent_draws = b[MASU_BUFFER_DRAWS].count;
        b[MASU_BUFFER_DRAWS].count += (uint64_t)s->transparents * s->transparent_sets;
        b[MASU_BUFFER_DRAWS].stride =
            masu_align_up(b[MASU_BUFFER_DRAWS].count * MASU_DRAW_BYTES, storage_alignment);
        b[MASU_BUFFER_DRAWS].bytes = flights * b[MASU_BUFFER_DRAWS].stride;
        if (plan->occlusion) b[MASU_BUFFER_SEEN].count = (uint64_t)plan->views * s->instances;
        if (plan->receivers) {
            plan->receivers = b[MASU_BUFFER_SEEN].count;
            b[MASU_BUFFER_SEEN].count += (uint64_t)plan->cascades * MASU_RECEIVER_WORDS;
        }
        b[MASU_BUFFER_SEEN].bytes = b[MASU_BUFFER_SEEN].count * sizeof(uint32_t);
        b[MASU_BUFFER_DRAWN].count = plan->drawn.words;
        b[MASU_BUFFER_DRAWN].stride =
            masu_align_up(b[MASU_BUFFER_DRAWN].count * sizeof(uint32_t), storage_alignment);
        b[MASU_BUFFER_DRAWN].bytes = flights * b[MASU_BUFFER_DRAWN].stride;
    }
    return size_counters(plan);
}

/* Images of a readback slot from `slot` on, each 16-byte aligned for vkCmdCopyImageToBuffer.
 * Returns the end. */
static uint64_t lay_readback_images(masu_frame_plan *plan, uint64_t slot) {
    for (uint32_t i = 0; i < MASU_READBACK_IMAGES; i++) {
        if (!(plan->desc.readback & 1u << i)) continue;
        plan->readback_offset[i] = slot;
        uint64_t bytes = 0; /* the depth may live in either of two images: the larger counts */
        for (uint32_t id = 1; id < MASU_IMAGE_COUNT; id++) {
            if (!(masu_images[id].readback & 1u << i) || !plan->images[id].used) continue;
            uint64_t v = (uint64_t)plan->images[id].width * plan->images[id].height *
                         masu_format_bytes(masu_plan_format(plan, id));
            if (v > bytes) bytes = v;
        }
        slot = masu_align_up(slot + bytes, 16);
    }
    return slot;
}

static void size_buffers(masu_frame_plan *plan, uint64_t uniform_alignment,
                         uint64_t storage_alignment) {
    masu_buffer_plan *b = plan->buffers;
    const masu_scene *s = plan->desc.scene;
    uint64_t flights = plan->desc.frames_in_flight;
    VkBufferUsageFlags dst = VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                       storage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    b[MASU_BUFFER_VERTICES] = (masu_buffer_plan){.name = "vertices",
                                                 .usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | dst,
                                                 .count = s ? s->vertices : 0};
    b[MASU_BUFFER_VERTICES].bytes = b[MASU_BUFFER_VERTICES].count * sizeof(masu_blob_vertex);
    b[MASU_BUFFER_INDICES] = (masu_buffer_plan){.name = "indices",
                                                .usage = VK_BUFFER_USAGE_INDEX_BUFFER_BIT | dst,
                                                .count = s ? s->indices : 0};
    b[MASU_BUFFER_INDICES].bytes = b[MASU_BUFFER_INDICES].count * sizeof(uint32_t);
    b[MASU_BUFFER_TEXCOORDS] =
        (masu_buffer_plan){.name = "texture coordinates",
                           .usage = VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | dst,
                           .count = s && s->texture_arrays ? s->vertices : 0};
    b[MASU_BUFFER_TEXCOORDS].bytes = b[MASU_BUFFER_TEXCOORDS].count * 2 * sizeof(float);
    b[MASU_BUFFER_MATERIALS] = (masu_buffer_plan){
        .name = "materials", .usage = storage | dst, .count = s ? s->materials : 0};
    b[MASU_BUFFER_MATERIALS].bytes =
        b[MASU_BUFFER_MATERIALS].count * sizeof(struct masu_material_data);
    /* The curves of small reliefs lie behind the materials, two elements each. */
    if (s) b[MASU_BUFFER_MATERIALS].bytes += s->meso * sizeof(masu_blob_meso);
    b[MASU_BUFFER_COUNTERS] = (masu_buffer_plan){
        .name = "counters", .usage = storage | dst | VK_BUFFER_USAGE_TRANSFER_SRC_BIT};
    b[MASU_BUFFER_SLOTS] = (masu_buffer_plan){
        .name = "slots", .usage = storage | dst, .count = s && s->sdf ? s->sdf_slots : 0};
    /* A second set, as of the frame before. */
    if (plan->needs.velocity && plan->needs.dynamic) b[MASU_BUFFER_SLOTS].count *= 2;
    b[MASU_BUFFER_SLOTS].bytes = b[MASU_BUFFER_SLOTS].count * sizeof(float);
    b[MASU_BUFFER_TABLES] = (masu_buffer_plan){.name = "tables", .usage = storage | dst};
    b[MASU_BUFFER_PROBES] = (masu_buffer_plan){
        .name = "light probes", .usage = storage | dst, .count = s ? s->probes : 0};
    if (s && s->probes) {
        b[MASU_BUFFER_PROBES].bytes =
            sizeof(masu_blob_probes) +
            (masu_align_up(s->probe_words, 4) + (uint64_t)s->probes * MASU_PROBE_LIT_WORDS) *
                sizeof(uint32_t);
    }
    b[MASU_BUFFER_EXPOSURE] = (masu_buffer_plan){
        .name = "exposure",
        .usage = storage | dst,
        .count = plan->needs.metered ? MASU_EXPOSURE_HEADER + MASU_EXPOSURE_BINS : 0};
    b[MASU_BUFFER_EXPOSURE].bytes = b[MASU_BUFFER_EXPOSURE].count * sizeof(uint32_t);
    b[MASU_BUFFER_TILES] = (masu_buffer_plan){
        .name = "tiles", .usage = storage | dst | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT};
    b[MASU_BUFFER_FRAME] = (masu_buffer_plan){.name = "frame uniforms",
                                              .role = MASU_ROLE_UPLOAD,
                                              .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
    b[MASU_BUFFER_SHADOW] = (masu_buffer_plan){.name = "shadow uniforms",
                                               .role = MASU_ROLE_UPLOAD,
                                               .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
    b[MASU_BUFFER_SKY] = (masu_buffer_plan){.name = "sky uniforms",
                                            .role = MASU_ROLE_UPLOAD,
                                            .usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT};
    b[MASU_BUFFER_TRACE] = (masu_buffer_plan){.name = "traced scene", .usage = storage | dst};
    b[MASU_BUFFER_TRACE_FRAME] = (masu_buffer_plan){
        .name = "traced instances", .role = MASU_ROLE_UPLOAD, .usage = storage};
    b[MASU_BUFFER_SPECULAR_TILES] =
        (masu_buffer_plan){.name = "specular tiles",
                           .usage = storage | dst | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT};
    b[MASU_BUFFER_SMAA_AREA] = (masu_buffer_plan){.name = "SMAA areas", .usage = storage | dst};
    b[MASU_BUFFER_SMAA_TILES] =
        (masu_buffer_plan){.name = "SMAA tiles",
                           .usage = storage | dst | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT};
    masu_ray_buffers(plan);
    if (plan->needs.traced) {
        b[MASU_BUFFER_VERTICES].usage |= storage;
        if (s->trace_colors) b[MASU_BUFFER_TEXCOORDS].usage |= storage;
    }
    b[MASU_BUFFER_LIGHTS] =
        (masu_buffer_plan){.name = "lights", .role = MASU_ROLE_UPLOAD, .usage = storage};
    b[MASU_BUFFER_LIGHT_TILES] = (masu_buffer_plan){.name = "light tiles", .usage = storage};
    b[MASU_BUFFER_INSTANCES] = (masu_buffer_plan){.name = "instances",
                                                  .role = MASU_ROLE_UPLOAD,
                                                  .usage = storage,
                                                  .count = s ? s->instances : 0};
    b[MASU_BUFFER_DRAWS] = (masu_buffer_plan){.name = "draw commands",
                                              .role = MASU_ROLE_UPLOAD,
                                              .usage = VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT};
    if (plan->occlusion) b[MASU_BUFFER_DRAWS].usage |= storage;
    b[MASU_BUFFER_SEEN] = (masu_buffer_plan){.name = "seen", .usage = storage | dst};
    b[MASU_BUFFER_DRAWN] =
        (masu_buffer_plan){.name = "drawn instances", .role = MASU_ROLE_UPLOAD, .usage = storage};
    b[MASU_BUFFER_STAGING] = (masu_buffer_plan){
        .name = "staging", .role = MASU_ROLE_UPLOAD, .usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT};
    b[MASU_BUFFER_READBACK] =
        (masu_buffer_plan){.name = "readback", .role = MASU_ROLE_READBACK, .usage = dst};
    b[MASU_BUFFER_POISON] = (masu_buffer_plan){.name = "poison", .usage = dst};
    uint64_t slot = 0;
    if (s) slot = size_scene_buffers(plan, uniform_alignment, storage_alignment);
    if (plan->needs.smoothing) {
        slot = size_counters(plan);
        size_smaa_buffers(plan);
    }
    if (masu_stamps(&plan->desc)) {
        plan->readback_times = slot;
        slot = masu_align_up(slot + masu_stamps(&plan->desc) * sizeof(uint64_t), 16);
    }
    slot = lay_readback_images(plan, slot);
    b[MASU_BUFFER_READBACK].stride = slot;
    b[MASU_BUFFER_READBACK].bytes = flights * slot;
    b[MASU_BUFFER_READBACK].count = flights;
}

/* Whether a rung has ambient occlusion in screen space, and whether any has. */
static int rung_has_ao(const masu_desc *d, uint32_t r) {
    return d->scene && d->scene->occlusion_radius > 0.0f && d->rungs[r].ao != MASU_OFF;
}

static int wants_ao(const masu_desc *d) {
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (rung_has_ao(d, r)) return 1;
    }
    return 0;
}

/* The same of traced reflections. */
static int rung_has_specular(const masu_desc *d, uint32_t r) {
    return d->scene && d->scene->reflections && d->rungs[r].specular != MASU_OFF &&
           d->scene->glossiest < d->rungs[r].specular_cutoff;
}

static int rung_has_taa(const masu_desc *d, uint32_t r) {
    return rung_has_specular(d, r) && !d->debug.reference &&
           d->rungs[r].specular_temporal != MASU_OFF && d->rungs[r].specular_taa != MASU_OFF;
}

static int rung_has_fine(const masu_desc *d, uint32_t r) {
    return rung_has_specular(d, r) && !d->debug.reference &&
           d->rungs[r].specular_temporal != MASU_OFF && d->rungs[r].specular_fine != MASU_OFF;
}

static int wants(const masu_desc *d, int (*has)(const masu_desc *d, uint32_t r)) {
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (has(d, r)) return 1;
    }
    return 0;
}

static int wants_specular(const masu_desc *d) {
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (rung_has_specular(d, r)) return 1;
    }
    return 0;
}

masu_result masu_compile(const masu_desc *desc, uint64_t uniform_alignment,
                         uint64_t storage_alignment, masu_frame_plan *plan, masu_detail *detail) {
    memset(plan, 0, sizeof *plan);
    plan->desc = masu_desc_resolved(desc);
    masu_desc *d = &plan->desc;
    masu_result result = masu_desc_check(d, detail);
    if (!result) result = masu_limits_check(d, detail);
    if (result) return result;
    if (d->scene) {
        plan->scene = *d->scene;
        d->scene = &plan->scene;
        if (!d->scene->sdf_occlusion && !d->scene->shadow_cascades && !wants_ao(d))
            d->readback &= ~(uint32_t)MASU_READBACK_OCCLUSION;
        if (!d->scene->shadow_cascades) d->readback &= ~(uint32_t)MASU_READBACK_SHADOW_MAP;
        plan->compressed = masu_takes_blocks(d);
    } else {
        d->readback = 0; /* the images that could be asked for are the scene's */
    }
    plan->needs = (masu_needs){.scene = d->scene != NULL,
                               .raster = d->scene && d->scene->instances,
                               .sdf = d->scene && d->scene->sdf,
                               .dynamic = d->scene && d->scene->sdf_dynamic,
                               .anchored = d->scene && d->scene->sdf_anchored,
                               .sdf_occlusion = d->scene && d->scene->sdf_occlusion,
                               .probes = d->scene && d->scene->probes,
                               .shadow = d->scene && d->scene->shadow_cascades,
                               .transparents = d->scene && d->scene->transparents,
                               .lights = d->scene && d->scene->lights,
                               .surface = d->scene && d->scene->instances && d->scene->surfaces,
                               .environment = d->scene && d->scene->environment_size,
                               .sky = d->scene && (d->scene->analytic_sky || d->analytic_sky),
                               .readback = d->readback,
                               .reflections = wants_specular(d),
                               .traced = wants_specular(d) && d->scene->trace_instances,
                               .traced_sdf = wants_specular(d) && d->scene->trace_sdf,
                               .query = wants_specular(d) && d->scene->trace_instances &&
                                        d->ray_query == MASU_ON,
                               .accumulate = d->debug.reference != 0,
                               .steady = wants(d, rung_has_taa),
                               .finest = wants(d, rung_has_fine),
                               .metered = d->scene && d->exposure.metered == MASU_ON,
                               .velocity = (d->readback & MASU_READBACK_VELOCITY) != 0 || wants_specular(d),
                               .blit = !d->targets.storage};
    for (uint32_t r = 0; r < d->rung_count; r++) plan->needs.smoothing |= has_smaa(&d->rungs[r]);
    masu_output_plan(plan);
    if (plan->needs.query) plan->scene.trace_nodes = 0; /* the device has trees of its own */
    masu_shadow_peak(d, &plan->cascades, &plan->cascade_size);
    /* The sun's: each cascade, else all of the scene. */
    uint32_t suns = plan->needs.shadow ? plan->cascades : d->debug.casters ? 1 : 0;
    plan->views = plan->needs.raster ? 1 + suns : 1;
    plan->needs.occluders = d->scene && d->scene->placed_occluders > 0;
    for (uint32_t r = 0; r < d->rung_count; r++) {
        plan->lods |= d->scene && d->scene->lods && d->rungs[r].lod_error > 0.0f;
    }
    if (d->scene) {
        plan->draws = d->scene->draws + (plan->lods ? d->scene->lod_draws : 0);
        plan->listed = d->scene->instances + (plan->lods ? d->scene->lod_instances : 0);
    }
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_rung_plan *rp = &plan->rungs[r];
        rp->render_width = d->scene ? scaled(d->output.width, d->rungs[r].scale) : d->source.width;
        rp->render_height =
            d->scene ? scaled(d->output.height, d->rungs[r].scale) : d->source.height;
        int same = rp->render_width == d->output.width && rp->render_height == d->output.height;
        if (d->rungs[r].upscale == MASU_OFF && !same) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "rungs[].upscale", 0, 0,
                             "rungs[%u].upscale is MASU_OFF, but it renders %ux%u for an output of "
                             "%ux%u",
                             r, rp->render_width, rp->render_height, d->output.width,
                             d->output.height);
        }
        plan->needs.march = d->rungs[r].march;
        if (plan->needs.sdf && plan->needs.raster && plan->needs.march == MASU_MARCH_FRAGMENT) {
            return masu_fail(detail, MASU_ERROR_SCENE, "rungs[].march", plan->needs.march, 0,
                             "rungs[%u].march is MASU_MARCH_FRAGMENT, which erases polygons: the "
                             "scene has %u instances",
                             r, d->scene->instances);
        }
        if (plan->needs.sdf && !(d->scene->sdf_march & 1u << plan->needs.march)) {
            return masu_fail(detail, MASU_ERROR_SCENE, "rungs[].march", plan->needs.march, 0,
                             "rungs[%u].march is %d, for which the blob has no code (bake with "
                             "--variants)",
                             r, (int)plan->needs.march);
        }
        resolve_switches(d, rp, &d->rungs[r], &plan->needs);
        plan->needs.ao = rung_has_ao(d, r);
        plan->needs.specular = rung_has_specular(d, r);
        int filtered = plan->needs.specular && !plan->needs.accumulate;
        plan->needs.reuse = filtered && d->rungs[r].specular_reuse != MASU_OFF;
        plan->needs.temporal = filtered && d->rungs[r].specular_temporal != MASU_OFF;
        plan->needs.filter = filtered && d->rungs[r].specular_filter != MASU_OFF;
        plan->needs.taa = rung_has_taa(d, r);
        plan->needs.fine = rung_has_fine(d, r);
        plan->needs.occlusion = plan->needs.occluders && d->rungs[r].occlusion != MASU_OFF;
        plan->needs.unculled = d->scene && (d->scene->most_primitives > MASU_CULL_ROUNDS ||
                                            d->scene->most_instances > 64 * MASU_CULL_ROUNDS);
        if (plan->needs.occlusion && plan->needs.unculled) {
            if (d->rungs[r].occlusion == MASU_ON) {
                return masu_fail(detail, MASU_ERROR_LIMIT, "rungs[].occlusion",
                                 d->scene->most_instances, 64 * MASU_CULL_ROUNDS,
                                 "rungs[%u].occlusion takes meshes of at most %d primitives and %d "
                                 "instances, the scene has one of %u or %u",
                                 r, MASU_CULL_ROUNDS, 64 * MASU_CULL_ROUNDS,
                                 d->scene->most_primitives, d->scene->most_instances);
            }
            plan->needs.occlusion = 0;
        }
        plan->occlusion |= plan->needs.occlusion;
        plan->needs.light_tiles = plan->needs.lights && d->rungs[r].light_tiles != MASU_OFF;
        resolve_shadow(plan, r);
        plan->needs.casters = plan->needs.occlusion && plan->views > 1;
        plan->needs.receivers = plan->needs.casters && plan->needs.shadow &&
                                rp->slow != (1u << rp->cascades) - 1u;
        if (plan->needs.receivers) plan->receivers = 1;
        compile_rung(plan, r);
    }
    gather_images(plan);
    size_buffers(plan, uniform_alignment, storage_alignment);
    return MASU_OK;
}

/* ---- Export ---------------------------------------------------------------------------------- */

static const char *image_name(uint8_t image) {
    if (image == MASU_RESOURCE_TILES) return "tiles";
    if (image == MASU_RESOURCE_SLOTS) return "slots";
    if (image == MASU_RESOURCE_SEEN) return "seen";
    if (image == MASU_RESOURCE_DRAWS) return "draws";
    if (image == MASU_RESOURCE_PROBES) return "light probes";
    if (image == MASU_RESOURCE_LIGHT_TILES) return "light tiles";
    if (image == MASU_RESOURCE_SPECULAR_TILES) return "specular tiles";
    if (image == MASU_RESOURCE_TOP_LEVEL) return "top level";
    if (image == MASU_RESOURCE_SMAA_TILES) return "SMAA tiles";
    if (image == MASU_RESOURCE_EXPOSURE) return "exposure";
    return image < MASU_IMAGE_COUNT ? masu_images[image].name : NULL;
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

/* Bytes of the table's images that this plan does not have, at their size in this plan. */
static uint64_t left_out_bytes(const masu_frame_plan *plan) {
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
        bytes += (uint64_t)size.width * size.height * masu_format_bytes(masu_plan_format(plan, i));
    }
    return bytes;
}

void masu_plan_export(const masu_frame_plan *plan, const uint64_t *pipeline_ns,
                      masu_plan_info *out) {
    memset(out, 0, sizeof *out);
    out->pass_count = MASU_PASS_COUNT;
    out->rung_count = plan->desc.rung_count;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        masu_plan_pass *pass = &out->passes[p];
        pass->name = masu_passes[p].name;
        pass->why = plan->why[p];
        if (pipeline_ns) pass->pipeline_ns = pipeline_ns[p];
        int named = 0;
        for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
            const masu_rung_plan *rp = &plan->rungs[r];
            if (!(rp->active & MASU_PASS_BIT(p))) continue;
            pass->active |= 1u << r;
            out->rungs[r].dispatches++;
            if (named) continue;
            named = 1;
            uint32_t reads = 0, writes = 0;
            for (uint32_t a = 0; a < rp->access_count[p]; a++) {
                const char *name = image_name(rp->access[p][a].image);
                if (masu_usage_writes((masu_usage)rp->access[p][a].usage)) {
                    if (writes < 6) pass->writes[writes++] = name;
                } else if (reads < 12) {
                    pass->reads[reads++] = name;
                }
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
                              image->offset,       image->first,              image->last};
    }
    out->left_out_bytes = left_out_bytes(plan);
}

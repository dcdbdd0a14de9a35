/* record.c: records the passes of a frame into command buffers: one per recording, plus one for
 * each row of the pass table at which desc.split inserts the host's own commands. recordings.c
 * lists the recordings. Over 700 lines: all kinds of passes share the helpers that bind and
 * draw. */
#include "device/record.h"

#include "base/error.h"
#include "device/barriers.h"
#include "device/descriptors.h"
#include "device/ray_query.h"
#include "plan/push.h"
#include "scene/material.h"
#include "scene/scene.h"
#include "scene/trace_scene.h"
#include "shared/masu_shared.h"

#include <string.h>

/* ---- Passes ---------------------------------------------------------------------------------- */

static uint32_t few_groups(const masu_recorder *rec) { return (rec->draws->batch_count + 63) / 64; }

static masu_push_block push_of(const masu_recorder *rec, uint32_t pass) {
    return masu_push_of(rec->m->plan, rec->rung, pass, few_groups(rec));
}

/* The tile list of an indirect pass, or MASU_BUFFER_COUNT for a direct one. */
static masu_buffer_id tiles_of(masu_image_extent extent) {
    switch (extent) {
    case MASU_EXTENT_TILES: return MASU_BUFFER_TILES;
    case MASU_EXTENT_GLOSSY: return MASU_BUFFER_SPECULAR_TILES;
    case MASU_EXTENT_EDGED: return MASU_BUFFER_SMAA_TILES;
    default: return MASU_BUFFER_COUNT;
    }
}

/* Workgroups of a direct dispatch. */
static VkExtent2D groups_of(const masu_recorder *rec, uint32_t pass, const masu_push_block *push) {
    const masu_frame_plan *plan = rec->m->plan;
    uint32_t few = few_groups(rec), edge = MASU_GROUP, width = 0;
    /* The y axis of culling is the view: one for the camera, plan->views - 1 for the sun's
     * cascades. */
    uint32_t views =
        push->own.word[offsetof(struct masu_push_cull, view) / 4] ? plan->views - 1 : 1;
    switch (masu_passes[pass].extent) {
    case MASU_EXTENT_PROBES: return (VkExtent2D){(plan->scene.probes + 63) / 64, 1};
    case MASU_EXTENT_SKINS:
        return (VkExtent2D){(plan->scene.max_skinned + 63) / 64, plan->scene.skins};
    case MASU_EXTENT_SKIN_TREES:
        return (VkExtent2D){plan->scene.skins + plan->scene.host_meshes, 1};
    case MASU_EXTENT_KEPT: return (VkExtent2D){(plan->scene.instances + 63) / 64, views};
    case MASU_EXTENT_BATCHES: return (VkExtent2D){few + rec->draws->large_count, views};
    /* One workgroup per tile. Other extents have one invocation per pixel or block. */
    case MASU_EXTENT_TILE:
    case MASU_EXTENT_ONE: edge = 1; break;
    case MASU_EXTENT_OUTPUT_PAIRS: width = 2 * edge; break;
    case MASU_EXTENT_OUTPUT_ODD:
        return (VkExtent2D){push->sizes.render_width / edge + 1,
                            push->sizes.render_height / edge + 1};
    default: break;
    }
    width = width ? width : edge;
    return (VkExtent2D){(push->sizes.output_width + width - 1) / width,
                        (push->sizes.output_height + edge - 1) / edge};
}

/* Offset in MASU_BUFFER_SPRITES of this frame's element `vec4`. */
static VkDeviceSize sprites_at(const masu_recorder *rec, uint64_t vec4) {
    return rec->flight * rec->m->plan->buffers[MASU_BUFFER_SPRITES].stride +
           vec4 * sizeof(masu_vec4);
}

static void record_compute(masu_recorder *rec, uint32_t pass, VkDescriptorSet set) {
    const masu_vk *vk = &rec->m->vk;
    masu_push_block push = push_of(rec, pass);
    VkPipelineLayout layout = rec->m->layouts[pass];
    VkPipeline pipeline =
        masu_comes_last(rec->rp, pass) ? rec->m->last[pass] : rec->m->pipelines[pass];
    vk->CmdBindPipeline(rec->cmd, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline);
    if (masu_has_global_sets(rec->m->plan)) {
        vk->CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout, MASU_SET_GLOBAL,
                                  1, &rec->m->global_sets[rec->flight][pass], 0, NULL);
    }
    vk->CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_COMPUTE, layout, MASU_SET_PASS, 1,
                              &set, 0, NULL);
    vk->CmdPushConstants(rec->cmd, layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push, &push);
    masu_buffer_id tiles = tiles_of(masu_passes[pass].extent);
    if (masu_passes[pass].extent == MASU_EXTENT_DECALS) {
        vk->CmdDispatchIndirect(rec->cmd, rec->m->objects.buffers[MASU_BUFFER_SPRITES],
                                sprites_at(rec, MASU_SPRITE_DISPATCH));
    } else if (masu_passes[pass].extent == MASU_EXTENT_RAYS ||
               masu_passes[pass].extent == MASU_EXTENT_TRACED_PROBES) {
        int rays = masu_passes[pass].extent == MASU_EXTENT_RAYS;
        vk->CmdDispatchIndirect(rec->cmd, rec->m->objects.buffers[MASU_BUFFER_BOUNCE],
                                rec->flight * rec->m->plan->buffers[MASU_BUFFER_BOUNCE].stride +
                                    (rays ? offsetof(struct masu_bounce_header, rays)
                                          : offsetof(struct masu_bounce_header, probes)));
    } else if (masu_passes[pass].extent == MASU_EXTENT_TEXTURES) {
        vk->CmdDispatchIndirect(rec->cmd, rec->m->objects.buffers[MASU_BUFFER_TEXELS],
                                rec->flight * rec->m->plan->buffers[MASU_BUFFER_TEXELS].stride);
    } else if (masu_passes[pass].extent == MASU_EXTENT_LOCAL_SDF) {
        VkDeviceSize slot = rec->flight * rec->m->plan->buffers[MASU_BUFFER_LOCAL_FACES].stride;
        vk->CmdDispatchIndirect(rec->cmd, rec->m->objects.buffers[MASU_BUFFER_LOCAL_FACES],
                                slot + offsetof(struct masu_local_face_uniforms, groups));
    } else if (masu_passes[pass].extent == MASU_EXTENT_MESHES) {
        vk->CmdDispatchIndirect(rec->cmd, rec->m->objects.buffers[MASU_BUFFER_MESH_UPLOAD],
                                rec->flight *
                                    rec->m->plan->buffers[MASU_BUFFER_MESH_UPLOAD].stride);
    } else if (tiles != MASU_BUFFER_COUNT) {
        vk->CmdDispatchIndirect(rec->cmd, rec->m->objects.buffers[tiles], 0);
    } else {
        VkExtent2D groups = groups_of(rec, pass, &push);
        vk->CmdDispatch(rec->cmd, groups.width, groups.height, 1);
    }
}

#define SAME_PLACE(member)                                                                         \
    _Static_assert(offsetof(struct masu_push_cascade, member) ==                                   \
                       offsetof(struct masu_push_gbuffer, member),                                 \
                   "cascades are drawn as polygons are: " #member)
SAME_PLACE(flags);
SAME_PLACE(layers);
SAME_PLACE(detail_u);
SAME_PLACE(detail_v);
SAME_PLACE(instances);
_Static_assert(sizeof(struct masu_push_cascade) == sizeof(struct masu_push_local_shadow) &&
                   offsetof(struct masu_push_cascade, cascade) ==
                       offsetof(struct masu_push_local_shadow, face) &&
                   offsetof(struct masu_push_cascade, rise) ==
                       offsetof(struct masu_push_local_shadow, rise),
               "faces of lamps are drawn as cascades are");
_Static_assert(offsetof(struct masu_push_cascade, cascade) ==
                   offsetof(struct masu_push_gbuffer, material),
               "a cascade has its number in the place of the material");
_Static_assert(offsetof(struct masu_push_cascade, rise) == offsetof(struct masu_push_gbuffer, meso),
               "a cascade has no meso, and a rise there");
#undef SAME_PLACE
#define SAME_PLACE(member, of_pick)                                                                \
    _Static_assert(offsetof(struct masu_push_pick, of_pick) ==                                     \
                       offsetof(struct masu_push_gbuffer, member),                                 \
                   "what is picked is drawn as polygons are: " #member)
SAME_PLACE(flags, flags);
SAME_PLACE(layers, layers);
SAME_PLACE(mip_bias, mip_bias);
SAME_PLACE(detail_u, detail_u);
SAME_PLACE(detail_v, detail_v);
SAME_PLACE(instances, instances);
SAME_PLACE(material, blended);
_Static_assert(offsetof(struct masu_push_pick, nearer) == offsetof(struct masu_push_gbuffer, meso),
               "what is picked has no meso, and its depth bias there");

#define GRAPHICS_STAGES (VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT)

/* The sweep that draws a material: a masu_draw_kind (draws.h), UINT32_MAX for none. Shadow casters
 * use textures only for the alpha test. */
static uint32_t sweep_of(const masu_draw_material *material, int casts) {
    /* drawn by transparents.c; casts no shadow */
    if (material->flags & MASU_MATERIAL_IS_BLEND) return UINT32_MAX;
    if (casts && material->flags & MASU_MATERIAL_NO_SHADOW) return UINT32_MAX;
    uint32_t kind = masu_draw_kind(material->flags);
    return casts && kind == 1 + MASU_TEXTURED_OPAQUE ? 0 : kind;
}

/* The sweep that draws a material for picking. Transparent and alpha-tested materials use their
 * map. A transparent surface can be picked where its opacity is at least one half. */
#define HALF_THERE (128u << MASU_MAP_CUTOFF_SHIFT)

static uint32_t pick_sweep_of(masu_draw_material *material) {
    int blended = (material->flags & MASU_MATERIAL_IS_BLEND) != 0;
    int holes = blended || (material->flags & MASU_MATERIAL_IS_MASK);
    if (blended)
        material->flags = (material->flags & ~(0xFFu << MASU_MAP_CUTOFF_SHIFT)) | HALF_THERE;
    return holes && (material->flags & MASU_MATERIAL_HAS_MAPS) ? 1 + MASU_TEXTURED_MASK : 0;
}

/* Binds the first texture coordinates and, in scenes that have them, the second ones and the vertex
 * colours. */
static void bind_texcoords(masu_recorder *rec) {
    const masu_texcoord_layout_of at = masu_texcoord_layout(&rec->m->plan->scene);
    VkBuffer buffer = rec->m->objects.buffers[MASU_BUFFER_TEXCOORDS];
    const VkBuffer buffers[] = {buffer, buffer, buffer};
    const VkDeviceSize places[] = {0, at.second, at.colors};
    rec->m->vk.CmdBindVertexBuffers(rec->cmd, 1, masu_has_attributes(&rec->m->plan->scene) ? 3 : 1,
                                    buffers, places);
}

/* Sets a material's flags and layers in the push constants, and binds its textures if they differ
 * from the previous draw's. */
static void bind_maps(masu_recorder *rec, VkPipelineLayout layout,
                      const masu_draw_material *material, struct masu_push_gbuffer *push,
                      uint32_t *bound) {
    push->flags = (material->flags & 0xFFFFFFu) | material->more_layers << MASU_MAP_OCCLUSION_SHIFT;
    /* and bits: which maps use the second texture coordinates */
    push->coat_layer = material->more_layers >> 8 & 0x3FFFu;
    push->layers = material->layers;
    push->detail_u = material->detail[0];
    push->detail_v = material->detail[1];
    if (*bound == material->texture_set) return;
    *bound = material->texture_set;
    rec->m->vk.CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout,
                                     MASU_SET_TEXTURES, 1, &rec->m->texture_sets[*bound], 0, NULL);
}

/* Draws, for one view, each primitive of each level of detail of the instantiated meshes. Instances
 * of a mesh are contiguous, so one indirect draw covers all of them. visible.c writes the instance
 * counts into draw commands, which are in batch order independent of the drawing order. A sweep
 * draws the materials that share a pipeline: without textures, with textures, and alpha-tested
 * last, so that the depth test rejects most of their fragments. If emitting materials have a
 * subpass, they have separate sweeps. */
static void record_sweep(masu_recorder *rec, uint32_t pass, uint32_t sweep, int culled,
                         int emitting, uint32_t face) {
    const masu_device *m = rec->m;
    const masu_vk *vk = &m->vk;
    int kept = m->plan->desc.resizable != 0; /* the blob may be freed by then */
    masu_scene_view v = {0};
    if (!kept) v = masu_scene_data_view(&m->plan->scene);
    VkPipelineLayout layout = m->layouts[pass];
    VkDeviceSize zero = 0;
    int lamp = pass == MASU_PASS_LOCAL_SHADOW, sun = masu_is_cascade(pass),
        pick = pass == MASU_PASS_PICK;
    int casters = sun || lamp;
    uint32_t bound = MASU_BLOB_NONE, view = sun ? 1 + pass - MASU_PASS_CASCADE_0 : 0;
    int apart = pass == MASU_PASS_GBUFFER && masu_has_emission_subpass(m->plan);
    VkPipeline pipeline = emitting ? m->emitting[(culled ? MASU_CULLED_COUNT : 0) + sweep]
                          : culled ? m->culled[sweep]
                          : !sweep ? m->pipelines[sun ? MASU_PASS_CASCADE_0 : pass]
                          : sun  ? m->masked_casters
                          : lamp ? m->masked_faces
                          : pick ? m->masked_picks
                                 : m->textured[sweep - 1];
    /* No material uses this pipeline. */
    if (!pipeline || ((casters || pick) && sweep == 1 + MASU_TEXTURED_OPAQUE)) return;
    vk->CmdBindPipeline(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    vk->CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, MASU_SET_GLOBAL, 1,
                              &m->global_sets[rec->flight][pass], 0, NULL);
    vk->CmdBindVertexBuffers(rec->cmd, 0, 1, &m->objects.buffers[MASU_BUFFER_VERTICES], &zero);
    if (sweep) bind_texcoords(rec);
    vk->CmdBindIndexBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_INDICES], 0,
                           VK_INDEX_TYPE_UINT32);
    int occlusion = !lamp && masu_has_pass(&rec->rp->active, MASU_PASS_CULL);
    uint32_t lists = view * m->plan->listed;
    if (occlusion) lists += (uint32_t)m->plan->drawn.lists;
    VkDeviceSize commands = rec->flight * m->plan->buffers[MASU_BUFFER_DRAWS].stride;
    commands +=
        pick ? m->plan->pick_draws * MASU_DRAW_BYTES : MASU_DRAWS_OF(m->plan, view, occlusion);
    if (pick) lists = (uint32_t)m->plan->drawn.picks;
    if (lamp) {
        lists = (uint32_t)m->plan->drawn.faces + face * m->plan->listed;
        commands = rec->flight * m->plan->buffers[MASU_BUFFER_DRAWS].stride +
                   (m->plan->face_draws + (uint64_t)face * m->plan->draws) * MASU_DRAW_BYTES;
    }
    masu_push_block block = push_of(rec, pass);
    struct masu_push_gbuffer push; /* cascades: same layout, cascade index for material */
    memcpy(&push, &block.own, sizeof push);
    if (lamp) push.material = face;
    for (uint32_t b = 0; b < rec->draws->batch_count; b++) {
        const masu_batch *batch = &rec->draws->batches[b];
        if (b == rec->draws->batch_count - m->plan->reserve.meshes)
            vk->CmdBindIndexBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_MESH_INDICES], 0,
                                   VK_INDEX_TYPE_UINT32);
        push.instances = lists + batch->first_listed;
        for (uint32_t d = 0; d < batch->draw_count; d++) {
            masu_draw_material drawn = kept ? rec->draws->materials[batch->first_draw + d]
                                            : masu_draw_material_of(&v, batch, d);
            int blended = (drawn.flags & MASU_MATERIAL_IS_BLEND) != 0;
            if (batch->mirrored) drawn.flags &= ~(uint32_t)MASU_MATERIAL_IS_SINGLE;
            if ((pick ? pick_sweep_of(&drawn) : sweep_of(&drawn, casters)) != sweep) continue;
            if (apart && emitting != (drawn.emits != 0)) continue;
            if (!casters && !pick && culled != ((drawn.flags & MASU_MATERIAL_IS_SINGLE) != 0))
                continue;
            if (casters) {
                /* a cascade reads `rise` there */
                memcpy(&push.meso, &drawn.rise, sizeof push.meso);
            } else if (pick) {
                float nearer = 1.0f + drawn.depth_bias;
                push.material = blended ? 1 : 0;
                push.flags = drawn.flags;
                memcpy(&push.meso, &nearer, sizeof push.meso); /* `nearer` of a pick */
            } else {
                push.material = drawn.material;
                push.meso = drawn.meso;
                push.nearer = 1.0f + drawn.depth_bias;
            }
            if (sweep) bind_maps(rec, layout, &drawn, &push, &bound);
            memcpy(&block.own, &push, sizeof push);
            vk->CmdPushConstants(rec->cmd, layout, GRAPHICS_STAGES, 0, sizeof block, &block);
            vk->CmdDrawIndexedIndirect(rec->cmd, m->objects.buffers[MASU_BUFFER_DRAWS],
                                       commands +
                                           (VkDeviceSize)MASU_DRAW_BYTES * (batch->first_draw + d),
                                       1, MASU_DRAW_BYTES);
        }
    }
}

static void record_polygons(masu_recorder *rec, uint32_t pass) {
    uint32_t sweeps = rec->m->texture_layout ? 1 + MASU_TEXTURED_COUNT : 1;
    int sides =
        rec->m->plan->scene.singles && masu_passes[pass].geometry == MASU_GEOMETRY_POLYGONS ? 2 : 1;
    int subpasses = pass == MASU_PASS_GBUFFER && masu_has_emission_subpass(rec->m->plan) ? 2 : 1;
    for (int emitting = 0; emitting < subpasses; emitting++) {
        if (emitting) rec->m->vk.CmdNextSubpass(rec->cmd, VK_SUBPASS_CONTENTS_INLINE);
        for (uint32_t sweep = 0; sweep < sweeps; sweep++)
            for (int side = 0; side < sides; side++)
                record_sweep(rec, pass, sweep, side, emitting, 0);
    }
}

/* Draws the local shadow faces that a frame of this rung may render, each into its atlas square. */
static void record_faces(masu_recorder *rec, uint32_t pass) {
    const masu_device *m = rec->m;
    uint32_t sweeps = m->texture_layout ? 1 + MASU_TEXTURED_COUNT : 1, edge = m->plan->local_tile;
    for (uint32_t face = 0; face < m->plan->desc.rungs[rec->rung].local_shadow_faces; face++) {
        VkRect2D area = {masu_local_face_place(m->plan, face), {edge, edge}};
        VkViewport viewport = {
            (float)area.offset.x, (float)area.offset.y, (float)edge, (float)edge, 0.0f, 1.0f};
        m->vk.CmdSetViewport(rec->cmd, 0, 1, &viewport);
        m->vk.CmdSetScissor(rec->cmd, 0, 1, &area);
        for (uint32_t sweep = 0; sweep < sweeps; sweep++)
            record_sweep(rec, pass, sweep, 0, 0, face);
    }
}

/* One indirect draw of vertices generated from MASU_BUFFER_SPRITES; the frame writes the count. */
static void record_sprites(masu_recorder *rec, uint32_t pass, VkDescriptorSet set,
                           uint64_t command) {
    const masu_device *m = rec->m;
    const VkDescriptorSet sets[] = {m->global_sets[rec->flight][pass], set};
    masu_push_block push = push_of(rec, pass);
    m->vk.CmdBindPipeline(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, m->pipelines[pass]);
    m->vk.CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, m->layouts[pass],
                                MASU_SET_GLOBAL, 2, sets, 0, NULL);
    m->vk.CmdPushConstants(rec->cmd, m->layouts[pass], GRAPHICS_STAGES, 0, sizeof push, &push);
    m->vk.CmdDrawIndirect(rec->cmd, m->objects.buffers[MASU_BUFFER_SPRITES],
                          sprites_at(rec, command), 1, sizeof(masu_vec4));
}

static void bind_transparents(masu_recorder *rec, VkDescriptorSet set, int tints) {
    const VkDescriptorSet sets[] = {rec->m->global_sets[rec->flight][MASU_PASS_TRANSPARENTS], set};
    VkPipeline pipeline = tints ? rec->m->tints : rec->m->pipelines[MASU_PASS_TRANSPARENTS];
    rec->m->vk.CmdBindPipeline(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
    rec->m->vk.CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                     rec->m->layouts[MASU_PASS_TRANSPARENTS], MASU_SET_GLOBAL, 2,
                                     sets, 0, NULL);
}

/* Draws the commands of a slot, which begin at offset `at`. */
static void draw_slot(masu_recorder *rec, VkDeviceSize at, int bind) {
    const masu_device *m = rec->m;
    for (uint32_t c = 0; c < m->plan->scene.transparent_sets; c++) {
        if (m->texture_layout && (bind || m->plan->scene.transparent_sets > 1))
            m->vk.CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                        m->layouts[MASU_PASS_TRANSPARENTS], MASU_SET_TEXTURES, 1,
                                        &m->texture_sets[rec->draws->transparent_sets[c]], 0, NULL);
        m->vk.CmdDrawIndexedIndirect(rec->cmd, m->objects.buffers[MASU_BUFFER_DRAWS],
                                     at + c * MASU_DRAW_BYTES, 1, MASU_DRAW_BYTES);
    }
}

/* Draws the transparent slots back to front. A slot has one command per texture set, of which
 * transparents.c fills one. Before each slot the particles behind it are drawn; the render passes
 * of both are compatible. In scenes with coloured transmission each slot is drawn twice: first the
 * pass that multiplies the image by the transmitted colour. */
static void record_transparents(masu_recorder *rec, const VkDescriptorSet *sets) {
    const masu_device *m = rec->m;
    const masu_vk *vk = &m->vk;
    VkPipelineLayout layout = m->layouts[MASU_PASS_TRANSPARENTS];
    VkDeviceSize zero = 0;
    VkDeviceSize at = rec->flight * m->plan->buffers[MASU_BUFFER_DRAWS].stride +
                      m->plan->transparent_draws * MASU_DRAW_BYTES;
    int among = m->plan->needs.particles, tints = m->plan->scene.tints != 0;
    masu_push_block block = push_of(rec, MASU_PASS_TRANSPARENTS);
    struct masu_push_transparents push;
    memcpy(&push, &block.own, sizeof push);
    if (!among && !tints) bind_transparents(rec, sets[MASU_PASS_TRANSPARENTS], 0);
    vk->CmdBindVertexBuffers(rec->cmd, 0, 1, &m->objects.buffers[MASU_BUFFER_VERTICES], &zero);
    if (m->texture_layout) bind_texcoords(rec);
    vk->CmdBindIndexBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_INDICES], 0,
                           VK_INDEX_TYPE_UINT32);
    for (uint32_t k = 0; k < rec->draws->transparent_count; k++) {
        if (among)
            record_sprites(rec, MASU_PASS_PARTICLES, sets[MASU_PASS_PARTICLES],
                           MASU_SPRITE_DRAWS + k);
        if (among || tints) bind_transparents(rec, sets[MASU_PASS_TRANSPARENTS], tints);
        push.instances =
            (uint32_t)m->plan->drawn.transparents + masu_transparent_words(m->plan) * k;
        memcpy(&block.own, &push, sizeof push);
        vk->CmdPushConstants(rec->cmd, layout, GRAPHICS_STAGES, 0, sizeof block, &block);
        draw_slot(rec, at, k == 0 || among);
        if (tints) {
            bind_transparents(rec, sets[MASU_PASS_TRANSPARENTS], 0);
            draw_slot(rec, at, 0);
        }
        at += m->plan->scene.transparent_sets * MASU_DRAW_BYTES;
    }
}

/* Each part of the occluder atlas has its own viewport and indirect draw. */
static void record_occluders(masu_recorder *rec) {
    const masu_device *m = rec->m;
    VkPipelineLayout layout = m->layouts[MASU_PASS_OCCLUDERS];
    m->vk.CmdBindPipeline(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS,
                          m->pipelines[MASU_PASS_OCCLUDERS]);
    m->vk.CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, layout, MASU_SET_GLOBAL,
                                1, &m->global_sets[rec->flight][MASU_PASS_OCCLUDERS], 0, NULL);
    masu_push_block block = push_of(rec, MASU_PASS_OCCLUDERS);
    struct masu_push_occluders push;
    memcpy(&push, &block.own, sizeof push);
    for (uint32_t part = 0; part < MASU_ATLAS_PARTS(m->plan); part++) {
        VkRect2D area = masu_atlas_part(part);
        VkViewport viewport = {(float)area.offset.x, (float)area.offset.y, (float)area.extent.width,
                               (float)area.extent.height, 0.0f, 1.0f};
        push.view = part;
        memcpy(&block.own, &push, sizeof push);
        m->vk.CmdSetViewport(rec->cmd, 0, 1, &viewport);
        m->vk.CmdSetScissor(rec->cmd, 0, 1, &area);
        m->vk.CmdPushConstants(rec->cmd, layout, GRAPHICS_STAGES, 0, sizeof block, &block);
        m->vk.CmdDrawIndirect(rec->cmd, m->objects.buffers[MASU_BUFFER_DRAWS],
                              rec->flight * m->plan->buffers[MASU_BUFFER_DRAWS].stride +
                                  MASU_OCCLUDER_DRAW(m->plan, part),
                              1, MASU_DRAW_BYTES);
    }
}

/* Draws `vertices` vertices that the vertex shader generates: a triangle that covers the render
 * area, or squares. */
static void record_generated_vertices(masu_recorder *rec, uint32_t pass, VkDescriptorSet set,
                                      uint32_t vertices) {
    const masu_vk *vk = &rec->m->vk;
    masu_push_block push = push_of(rec, pass);
    vk->CmdBindPipeline(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, rec->m->pipelines[pass]);
    const VkDescriptorSet sets[] = {rec->m->global_sets[rec->flight][pass], set};
    vk->CmdBindDescriptorSets(rec->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, rec->m->layouts[pass],
                              MASU_SET_GLOBAL, set ? 2 : 1, sets, 0, NULL);
    vk->CmdPushConstants(rec->cmd, rec->m->layouts[pass], GRAPHICS_STAGES, 0, sizeof push, &push);
    vk->CmdDraw(rec->cmd, vertices, 1, 0, 0);
}

/* The part of its attachments that a graphics pass clears and draws. */
static VkRect2D render_area(const masu_recorder *rec, uint32_t pass) {
    if (pass == MASU_PASS_OCCLUDERS)
        return (VkRect2D){{0, 0}, {MASU_ATLAS_WIDTH, MASU_ATLAS_HEIGHT}};
    if (pass == MASU_PASS_PICK) return (VkRect2D){{0, 0}, {2, 2}};
    if (!masu_is_cascade(pass))
        return (VkRect2D){
            {0, 0},
            masu_plan_extent(rec->m->plan, masu_passes[pass].extent,
                             (VkExtent2D){rec->rp->render_width, rec->rp->render_height})};
    return (VkRect2D){masu_cascade_place(rec->m->plan, pass - MASU_PASS_CASCADE_0),
                      {rec->rp->cascade_size, rec->rp->cascade_size}};
}

static void record_graphics(masu_recorder *rec, uint32_t pass, const VkDescriptorSet *sets) {
    const masu_vk *vk = &rec->m->vk;
    uint32_t objects = masu_is_cascade(pass) ? MASU_PASS_CASCADE_0 : pass;
    VkClearValue clear[6];
    memset(clear, 0, sizeof clear); /* depth 0 is infinitely far (reversed z) */
    VkRect2D area = render_area(rec, pass);
    VkViewport viewport = {(float)area.offset.x,
                           (float)area.offset.y,
                           (float)area.extent.width,
                           (float)area.extent.height,
                           0.0f,
                           1.0f};
    VkRenderPassBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                   .renderPass = rec->m->render_passes[objects],
                                   .framebuffer = rec->m->framebuffers[objects],
                                   .renderArea = area,
                                   .clearValueCount = 6,
                                   .pClearValues = clear};
    vk->CmdBeginRenderPass(rec->cmd, &begin, VK_SUBPASS_CONTENTS_INLINE);
    if (rec->m->pipelines[objects]) { /* without a pipeline the pass only clears */
        vk->CmdSetViewport(rec->cmd, 0, 1, &viewport);
        vk->CmdSetScissor(rec->cmd, 0, 1, &area);
        if (pass == MASU_PASS_GBUFFER || pass == MASU_PASS_PICK || masu_is_cascade(pass))
            record_polygons(rec, pass);
        if (pass == MASU_PASS_OCCLUDERS) record_occluders(rec);
        if (pass == MASU_PASS_TRANSPARENTS) record_transparents(rec, sets);
        if (pass == MASU_PASS_PARTICLES) /* the particles in front of all transparent surfaces */
            record_sprites(rec, pass, sets[pass],
                           MASU_SPRITE_DRAWS + rec->m->plan->scene.transparents);
        if (pass == MASU_PASS_LINES) record_sprites(rec, pass, sets[pass], MASU_SPRITE_LINES);
        if (pass == MASU_PASS_SPLIT_DEPTH) record_generated_vertices(rec, pass, sets[pass], 3);
        if (pass == MASU_PASS_LOCAL_SHADOW) record_faces(rec, pass);
        if (pass == MASU_PASS_LOCAL_SHADOW_KEEP)
            record_generated_vertices(rec, pass, sets[pass],
                                      6 * rec->m->plan->desc.rungs[rec->rung].local_shadow_faces);
    }
    vk->CmdEndRenderPass(rec->cmd);
}

static void record_readback(masu_recorder *rec, uint32_t pass) {
    const masu_buffer_plan *buffer = &rec->m->plan->buffers[MASU_BUFFER_READBACK];
    for (uint32_t a = 0; a < rec->rp->access_count[pass]; a++) {
        masu_image_id id = (masu_image_id)rec->rp->access[pass][a].image;
        VkExtent2D size =
            masu_plan_extent(rec->m->plan, masu_images[id].extent,
                             (VkExtent2D){rec->rp->render_width, rec->rp->render_height});
        uint32_t bit = 0;
        while (masu_images[id].readback >> bit != 1u) bit++;
        VkBufferImageCopy copy = {
            .bufferOffset = rec->flight * buffer->stride + rec->m->plan->readback_offset[bit],
            .imageSubresource = {.aspectMask = masu_is_depth(masu_images[id].format)
                                                   ? VK_IMAGE_ASPECT_DEPTH_BIT
                                                   : VK_IMAGE_ASPECT_COLOR_BIT,
                                 .layerCount = 1},
            .imageExtent = {size.width, size.height, 1}};
        rec->m->vk.CmdCopyImageToBuffer(rec->cmd, rec->m->objects.images[id],
                                        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        rec->m->objects.buffers[MASU_BUFFER_READBACK], 1, &copy);
    }
}

static void record_present(masu_recorder *rec, uint32_t pass) {
    const VkExtent2D size = rec->m->plan->desc.output;
    /* all 0 without viewports */
    const masu_viewport *v = &rec->m->plan->desc.viewports[rec->viewport];
    const VkOffset3D at = {(int32_t)v->x, (int32_t)v->y, 0};
    masu_image_id from = (masu_image_id)rec->rp->access[pass][0].image;
    if (rec->m->plan->copies) {
        VkImageCopy copy = {
            .srcSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .dstSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
            .dstOffset = at,
            .extent = {size.width, size.height, 1}};
        rec->m->vk.CmdCopyImage(rec->cmd, masu_recorded_image(rec, from),
                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                masu_recorded_image(rec, MASU_IMAGE_TARGET),
                                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
        return;
    }
    VkImageBlit blit = {
        .srcSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
        .srcOffsets = {{0, 0, 0}, {(int32_t)size.width, (int32_t)size.height, 1}},
        .dstSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1},
        .dstOffsets = {{at.x, at.y, 0},
                       {at.x + (int32_t)size.width, at.y + (int32_t)size.height, 1}}};
    rec->m->vk.CmdBlitImage(rec->cmd, masu_recorded_image(rec, from),
                            VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                            masu_recorded_image(rec, MASU_IMAGE_TARGET),
                            VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_NEAREST);
}

/* ---- A frame --------------------------------------------------------------------------------- */

static void begin_label(const masu_recorder *rec, const char *name) {
    if (!rec->m->vk.CmdBeginDebugUtilsLabelEXT || !rec->m->vk.CmdEndDebugUtilsLabelEXT) return;
    VkDebugUtilsLabelEXT label = {.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT,
                                  .pLabelName = name};
    rec->m->vk.CmdBeginDebugUtilsLabelEXT(rec->cmd, &label);
}

static void end_label(const masu_recorder *rec) {
    if (!rec->m->vk.CmdBeginDebugUtilsLabelEXT || !rec->m->vk.CmdEndDebugUtilsLabelEXT) return;
    rec->m->vk.CmdEndDebugUtilsLabelEXT(rec->cmd);
}

/* Writes timestamp `index` of this frame in flight. The full barrier keeps later work from starting
 * before the timestamp, and earlier work from ending after it. Without the barrier a driver may
 * overlap passes, and the times of single passes would be meaningless. */
static void timestamp(masu_recorder *rec, uint32_t index) {
    if (!rec->m->queries) return;
    if (!rec->m->plan->desc.debug.timestamps) { /* the governor's two timestamps need no barrier */
        if (index != 0 && index != MASU_PASS_COUNT) return;
        rec->m->vk.CmdWriteTimestamp(rec->cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                                     rec->m->queries,
                                     rec->flight * (MASU_PASS_COUNT + 1) + (index ? 1 : 0));
        return;
    }
    masu_memory_barrier(rec, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_WRITE_BIT,
                        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
    rec->m->vk.CmdWriteTimestamp(rec->cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, rec->m->queries,
                                 rec->flight * (MASU_PASS_COUNT + 1) + index);
}

/* Kind 1: NaN, kind 2: infinity, both as fp32 and as fp16 (unorm: not 0). Kind 3: NaN, 1, NaN, 1 as
 * fp16 and 0.0078 as fp32, which passes as content if a shader tests only one component. */
static uint32_t poison_word(uint32_t kind) {
    return kind == 3 ? 0x3C007FC0u : kind == 2 ? 0x7C007C00u : 0x7FC07FC0u;
}

/* Copies the mutable materials from this frame's slot to the buffers that shaders and rays read. */
static void copy_materials(masu_recorder *rec) {
    const masu_device *m = rec->m;
    const masu_scene_data *scene = &m->plan->scene;
    VkBuffer from = m->objects.buffers[MASU_BUFFER_LIVE_MATERIALS];
    VkDeviceSize at = rec->flight * m->plan->buffers[MASU_BUFFER_LIVE_MATERIALS].stride;
    VkBufferCopy plain = {at, 0, scene->materials * sizeof(struct masu_material_data)};
    m->vk.CmdCopyBuffer(rec->cmd, from, m->objects.buffers[MASU_BUFFER_MATERIALS], 1, &plain);
    if (!m->plan->needs.traced) return;
    VkBufferCopy traced = {at + plain.size, 16 * masu_trace_layout(scene).materials,
                           scene->materials * sizeof(struct masu_trace_material)};
    m->vk.CmdCopyBuffer(rec->cmd, from, m->objects.buffers[MASU_BUFFER_TRACE], 1, &traced);
}

static void record_prologue(masu_recorder *rec) {
    const masu_device *m = rec->m;
    int counters = m->plan->desc.debug.counters && m->plan->buffers[MASU_BUFFER_COUNTERS].bytes;
    masu_memory_barrier(rec, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_WRITE_BIT,
                        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
    if (counters) {
        m->vk.CmdFillBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_COUNTERS], 0, VK_WHOLE_SIZE,
                            0);
    }
    if (m->plan->buffers[MASU_BUFFER_POISON].bytes) {
        m->vk.CmdFillBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_POISON], 0, VK_WHOLE_SIZE,
                            poison_word(m->plan->desc.debug.poison));
    }
    static const masu_buffer_id tiles[] = {MASU_BUFFER_TILES, MASU_BUFFER_SPECULAR_TILES,
                                           MASU_BUFFER_SMAA_TILES};
    int tiled = 0;
    for (uint32_t t = 0; t < sizeof tiles / sizeof *tiles; t++) {
        if (!m->plan->buffers[tiles[t]].bytes) continue;
        /* Indirect dispatch arguments: no tiles yet, one row, one layer. */
        static const uint32_t arguments[3] = {0, 1, 1};
        tiled = 1;
        for (uint32_t i = 0; i < 3; i++)
            m->vk.CmdFillBuffer(rec->cmd, m->objects.buffers[tiles[t]], 4 * i, 4, arguments[i]);
    }
    if (m->plan->needs.metered) { /* clears the histogram bins, keeps the header */
        m->vk.CmdFillBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_EXPOSURE],
                            MASU_EXPOSURE_HEADER * sizeof(uint32_t), VK_WHOLE_SIZE, 0);
    }
    int live = m->plan->buffers[MASU_BUFFER_LIVE_MATERIALS].bytes != 0;
    if (live) copy_materials(rec);
    int receivers = masu_has_pass(&rec->rp->active, MASU_PASS_RECEIVER_MASK);
    if (receivers) { /* no receiver yet: the initial minimum is the depth farthest from the sun */
        m->vk.CmdFillBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_SEEN],
                            m->plan->receiver_mask * sizeof(uint32_t), VK_WHOLE_SIZE, UINT32_MAX);
    }
    if (counters || receivers || tiled || live || m->plan->needs.metered ||
        m->plan->buffers[MASU_BUFFER_POISON].bytes) {
        masu_memory_barrier(rec, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                            VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                            VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
    }
    if (m->queries) {
        m->vk.CmdResetQueryPool(rec->cmd, m->queries, rec->flight * (MASU_PASS_COUNT + 1),
                                MASU_PASS_COUNT + 1);
    }
}

static void record_epilogue(masu_recorder *rec) {
    const masu_device *m = rec->m;
    const masu_buffer_plan *readback = &m->plan->buffers[MASU_BUFFER_READBACK];
    if (m->plan->desc.debug.counters && m->plan->buffers[MASU_BUFFER_COUNTERS].bytes) {
        masu_memory_barrier(rec, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                            VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT);
        VkBufferCopy copy = {0, rec->flight * readback->stride,
                             m->plan->buffers[MASU_BUFFER_COUNTERS].bytes};
        m->vk.CmdCopyBuffer(rec->cmd, m->objects.buffers[MASU_BUFFER_COUNTERS],
                            m->objects.buffers[MASU_BUFFER_READBACK], 1, &copy);
    }
    if (m->queries) {
        /* The GPU copies the results, so that masu_stats reads memory and does not call the
         * driver. */
        m->vk.CmdCopyQueryPoolResults(
            rec->cmd, m->queries, rec->flight * (MASU_PASS_COUNT + 1), masu_stamps(&m->plan->desc),
            m->objects.buffers[MASU_BUFFER_READBACK],
            rec->flight * readback->stride + m->plan->readback_times, sizeof(uint64_t),
            VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT);
    }
    if (readback->bytes) {
        masu_memory_barrier(rec, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                            VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    }
    if (m->plan->buffers[MASU_BUFFER_PICKED].bytes) {
        masu_memory_barrier(rec, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                            VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    }
    /* Leaves the target in the layout that the host expects, visible to any later access. */
    const masu_use *target = &rec->states[MASU_IMAGE_TARGET];
    masu_use last = {1, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT,
                     m->plan->desc.targets.final_layout, 0};
    VkImageMemoryBarrier b =
        masu_image_barrier(rec, MASU_IMAGE_TARGET, target->access, &last, target->layout);
    m->vk.CmdPipelineBarrier(rec->cmd, target->stages, last.stages, 0, 0, NULL, 0, NULL, 1, &b);
    rec->barriers++;
}

static masu_result begin_part(masu_recorder *rec, uint32_t part, masu_detail *detail) {
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    rec->cmd = rec->parts[part];
    VkResult r = rec->m->vk.BeginCommandBuffer(rec->cmd, &begin);
    return r ? masu_fail_vulkan(detail, r, "vkBeginCommandBuffer") : MASU_OK;
}

static masu_result end_part(masu_recorder *rec, masu_detail *detail) {
    VkResult r = rec->m->vk.EndCommandBuffer(rec->cmd);
    return r ? masu_fail_vulkan(detail, r, "vkEndCommandBuffer") : MASU_OK;
}

/* Ends a part: the host inserts its commands here. It gets images in their documented layouts and
 * must leave them in these. */
static masu_result record_split(masu_recorder *rec, uint32_t *part, masu_detail *detail) {
    masu_result result = end_part(rec, detail);
    if (!result) result = begin_part(rec, ++*part, detail);
    if (result) return result;
    masu_memory_barrier(rec, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_WRITE_BIT,
                        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
    return MASU_OK;
}

/* Whether this variant runs a pass that not every frame runs. */
static int is_drawn(const masu_recorder *rec, uint32_t pass) {
    if (masu_is_cascade(pass))
        return masu_variant_draws(rec->rp, rec->variant, pass - MASU_PASS_CASCADE_0);
    if (!masu_is_of_faces(pass)) return 1;
    return masu_variant_draws(rec->rp, rec->variant, MASU_DRAWN_FACES);
}

masu_result masu_record_frame(masu_recorder *rec, const VkDescriptorSet *sets,
                              masu_detail *detail) {
    const masu_device *m = rec->m;
    uint32_t part = 0;
    masu_result result = begin_part(rec, part, detail);
    if (result) return result;
    record_prologue(rec);
    if (rec->viewport) { /* keeps the image of the first viewport */
        rec->states[MASU_IMAGE_TARGET] =
            (masu_use){1, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_WRITE_BIT,
                       m->plan->desc.targets.final_layout, 1};
    }
    masu_find_persistent(rec);
    timestamp(rec, 0);
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (masu_has_pass(&rec->rp->active, p) && is_drawn(rec, p)) {
            begin_label(rec, masu_passes[p].name);
            masu_barrier_before(rec, p);
            if (masu_passes[p].kind == MASU_PASS_GRAPHICS) record_graphics(rec, p, sets);
            if (p == MASU_PASS_READBACK) record_readback(rec, p);
            if (p == MASU_PASS_PRESENT) record_present(rec, p);
            if (masu_passes[p].kind == MASU_PASS_BUILD)
                masu_ray_record_top(rec->m, rec->cmd, rec->flight);
            if (masu_passes[p].kind == MASU_PASS_COMPUTE) record_compute(rec, p, sets[p]);
            end_label(rec);
            if (masu_passes[p].kind == MASU_PASS_HOST) result = record_split(rec, &part, detail);
            if (result) return result;
        }
        timestamp(rec, p + 1);
    }
    masu_leave_persistent(rec);
    record_epilogue(rec);
    return end_part(rec, detail);
}

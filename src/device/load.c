/* load.c: see load.h. */
#include "device/load.h"

#include "base/error.h"
#include "device/barriers.h"
#include "device/bind.h"
#include "device/ray_query.h"
#include "plan/buffer_plan.h"
#include "scene/material.h"
#include "scene/scene.h"
#include "scene/trace_scene.h"
#include "shared/masu_shared.h"
#include "smaa_area.h"
#include "split_sum.h"

#include <string.h>

_Static_assert(MASU_LOAD_STEP_MIN >= MASU_TEXTURE_ROW_MAX, "a step holds a row of texels");

/* ---- Chunks ---------------------------------------------------------------------------------- */

/* Number of chunks for resident buffers: 0 if the host can write their memory directly. */
static uint32_t buffer_chunks(const masu_frame_plan *plan) {
    uint64_t step = plan->buffers[MASU_BUFFER_STAGING].bytes;
    uint32_t chunks = 0;
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT && plan->staged; b++) {
        if (masu_buffers[b].loaded)
            chunks += (uint32_t)((plan->buffers[b].bytes + step - 1) / step);
    }
    return chunks;
}

/* Whether any image persists between frames. The last chunk then sets the layouts of these
 * images. */
static int has_persistent_images(const masu_frame_plan *plan) {
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        if (plan->images[i].used && masu_images[i].kept) return 1;
    }
    return 0;
}

uint32_t masu_load_chunks(const masu_frame_plan *plan) {
    uint32_t chunks =
        buffer_chunks(plan) + (has_persistent_images(plan) ? 1 : 0) + masu_ray_build_steps(plan);
    if (!plan->scene.texture_arrays) return chunks;
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    return chunks + masu_texture_chunks(v.textures, plan->scene.texture_arrays, plan->compressed,
                                        plan->buffers[MASU_BUFFER_STAGING].bytes);
}

/* Number of chunks that copy. The chunks after them build acceleration structures. */
static uint32_t copy_chunks(const masu_frame_plan *plan, uint32_t chunks) {
    return chunks - (has_persistent_images(plan) ? 1 : 0) - masu_ray_build_steps(plan);
}

masu_chunk masu_load_chunk(const masu_frame_plan *plan, uint32_t index) {
    uint64_t step = plan->buffers[MASU_BUFFER_STAGING].bytes;
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        uint64_t bytes = masu_buffers[b].loaded ? plan->buffers[b].bytes : 0;
        uint32_t chunks = (uint32_t)((bytes + step - 1) / step);
        if (index < chunks) {
            uint64_t offset = index * step, left = bytes - offset;
            return (masu_chunk){(masu_buffer_id)b, offset, left < step ? left : step, bytes};
        }
        index -= chunks;
    }
    return (masu_chunk){MASU_BUFFER_COUNT, 0, 0, 0};
}

/* ---- Recording ------------------------------------------------------------------------------- */

/* Transitions all layers and mips of a texture to the transfer layout, or from it to the
 * shader-read layout. */
static void transition_texture(masu_device *m, VkCommandBuffer cmd, VkImage image, int to_shader) {
    VkImageMemoryBarrier b = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = to_shader ? VK_ACCESS_TRANSFER_WRITE_BIT : 0,
        .dstAccessMask = to_shader ? VK_ACCESS_SHADER_READ_BIT : VK_ACCESS_TRANSFER_WRITE_BIT,
        .oldLayout = to_shader ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : VK_IMAGE_LAYOUT_UNDEFINED,
        .newLayout = to_shader ? VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL
                               : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0,
                             VK_REMAINING_ARRAY_LAYERS}};
    m->vk.CmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_TRANSFER_BIT,
                             to_shader ? VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT
                                       : VK_PIPELINE_STAGE_TRANSFER_BIT,
                             0, 0, NULL, 0, NULL, 1, &b);
}

/* Records one chunk of textures, from `next` on. Two chunks never copy the same rows of a texture,
 * so they need no barrier between them. */
static void record_textures(masu_device *m, VkCommandBuffer cmd, masu_texture_cursor *next) {
    masu_scene_view v = masu_scene_data_view(&m->plan->scene);
    masu_texture_region r;
    uint64_t used = 0, room = m->plan->buffers[MASU_BUFFER_STAGING].bytes;
    while (masu_texture_next(v.textures, m->plan->scene.texture_arrays, m->plan->compressed, room,
                             next, &used, &r)) {
        VkImage image = m->plan->textures[r.texture].image;
        if (r.first) transition_texture(m, cmd, image, 0);
        VkBufferImageCopy copy = {
            .bufferOffset = r.offset,
            .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, r.mip, r.layer, 1},
            .imageOffset = {0, (int32_t)r.y, 0},
            .imageExtent = {r.width, r.height, 1}};
        m->vk.CmdCopyBufferToImage(cmd, m->objects.buffers[MASU_BUFFER_STAGING], image,
                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
        if (r.last) transition_texture(m, cmd, image, 1);
    }
}

/* Clears an image to 0, from UNDEFINED; leaves the image in the layout of `to`. */
static void clear_image(const masu_recorder *rec, masu_image_id image, const masu_use *to) {
    VkImageMemoryBarrier b = masu_image_barrier(rec, image, 0, to, VK_IMAGE_LAYOUT_UNDEFINED);
    VkClearColorValue zero = {.float32 = {0.0f}};
    rec->m->vk.CmdPipelineBarrier(rec->cmd, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, to->stages, 0, 0,
                                  NULL, 0, NULL, 1, &b);
    rec->m->vk.CmdClearColorImage(rec->cmd, b.image, to->layout, &zero, 1, &b.subresourceRange);
}

/* Puts persistent images into the layout that the first frame expects. Their content is not read,
 * except in ping-pong images and live textures, which are cleared: if a host skips a frame without
 * setting frame.cut, the next frame reads a layer that was never written, and 0 means "no
 * samples". */
static void record_persistent_images(masu_device *m, VkCommandBuffer cmd) {
    masu_use rest = masu_use_of(MASU_READ, MASU_PASS_COMPUTE),
             copy = masu_use_of(MASU_WRITE_COPY, MASU_PASS_TRANSFER);
    masu_recorder rec = {.m = m, .cmd = cmd};
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        if (!m->plan->images[i].used || !masu_images[i].kept) continue;
        masu_use from = {.stages = VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                         .layout = VK_IMAGE_LAYOUT_UNDEFINED};
        if (masu_images[i].layers != 1) {
            clear_image(&rec, (masu_image_id)i, &copy);
            from = copy;
        }
        VkImageMemoryBarrier b =
            masu_image_barrier(&rec, (masu_image_id)i, from.access, &rest, from.layout);
        m->vk.CmdPipelineBarrier(cmd, from.stages, rest.stages, 0, 0, NULL, 0, NULL, 1, &b);
    }
}

static masu_result record_load(masu_device *m, uint32_t index, masu_texture_cursor *next,
                               uint32_t *mesh, masu_detail *detail) {
    VkCommandBuffer cmd = m->loads[index];
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkResult r = m->vk.BeginCommandBuffer(cmd, &begin);
    if (r) return masu_fail_vulkan(detail, r, "vkBeginCommandBuffer");
    if (has_persistent_images(m->plan) && index + 1 == m->load_count) {
        record_persistent_images(m, cmd);
    } else if (index >= copy_chunks(m->plan, m->load_count)) {
        masu_ray_record_bottoms(m, cmd, mesh);
    } else if (index < buffer_chunks(m->plan)) {
        masu_chunk chunk = masu_load_chunk(m->plan, index);
        VkBufferCopy copy = {0, chunk.offset, chunk.bytes};
        m->vk.CmdCopyBuffer(cmd, m->objects.buffers[MASU_BUFFER_STAGING],
                            m->objects.buffers[chunk.buffer], 1, &copy);
    } else {
        record_textures(m, cmd, next);
    }
    r = m->vk.EndCommandBuffer(cmd);
    return r ? masu_fail_vulkan(detail, r, "vkEndCommandBuffer") : MASU_OK;
}

masu_result masu_load_record(masu_device *m, masu_detail *detail) {
    masu_texture_cursor texture = {0};
    uint32_t mesh = 0;
    masu_result result = MASU_OK;
    for (uint32_t i = 0; i < m->load_count && !result; i++)
        result = record_load(m, i, &texture, &mesh, detail);
    return result;
}

/* ---- Source data ----------------------------------------------------------------------------- */

_Static_assert(sizeof(masu_blob_meso) == 2 * sizeof(struct masu_material_data),
               "curves lie in the buffer of materials");

/* Element i of the materials buffer: a material, or half of a mesoscale detail entry
 * (masu_blob_meso). */
static struct masu_material_data material_element(const masu_scene_view *v, uint64_t i) {
    struct masu_material_data d;
    if (i < v->material_count) return masu_material_data_of(&v->materials[i]);
    memcpy(&d, (const unsigned char *)v->meso + (i - v->material_count) * sizeof d, sizeof d);
    return d;
}

_Static_assert(sizeof(masu_blob_probes) == sizeof(struct masu_probe_grid), "probes");

/* The probe grid's header and data; the remainder, which the GPU fills, is 0. */
static void write_probes(const masu_scene_view *v, masu_chunk chunk, unsigned char *to) {
    const struct {
        const void *from;
        uint64_t bytes;
    } parts[] = {{v->probes, sizeof *v->probes},
                 {v->probe_data, v->probe_words * sizeof(uint32_t)}};
    uint64_t start = 0;
    memset(to, 0, (size_t)chunk.bytes);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        uint64_t end = start + parts[i].bytes, last = chunk.offset + chunk.bytes;
        uint64_t low = start > chunk.offset ? start : chunk.offset, high = end < last ? end : last;
        if (low < high) {
            memcpy(to + (low - chunk.offset), (const unsigned char *)parts[i].from + (low - start),
                   (size_t)(high - low));
        }
        start = end;
    }
}

/* The library's split-sum tables, then the scene's environment map. */
static void write_tables(const masu_scene_view *v, masu_chunk chunk, unsigned char *to) {
    const masu_blob_environment_map *map = v->environment_map;
    uint64_t texels = map ? masu_blob_environment_texels(map->size, map->mips) : 0;
    uint64_t own = chunk.whole - texels * sizeof(uint32_t), from = 0;
    if (chunk.offset < own) {
        from = own - chunk.offset < chunk.bytes ? own - chunk.offset : chunk.bytes;
        memcpy(to, (const unsigned char *)masu_split_sum + chunk.offset, (size_t)from);
    }
    if (from < chunk.bytes) {
        memcpy(to + from,
               (const unsigned char *)v->environment_texels + (chunk.offset + from - own),
               (size_t)(chunk.bytes - from));
    }
}

/* ---- One function per LOADED row of buffers.inc; each writes one chunk ----------------------- */

typedef struct source {
    const masu_scene_data *scene;
    const masu_scene_view *v;
} source;

static void copy(const void *from, masu_chunk chunk, unsigned char *to) {
    memcpy(to, (const unsigned char *)from + chunk.offset, (size_t)chunk.bytes);
}

/* Copies the part of a range that falls into the chunk. The range has `bytes` bytes and begins at
 * offset `at` of the buffer. */
static void copy_part(const void *from, uint64_t at, uint64_t bytes, masu_chunk chunk,
                      unsigned char *to) {
    uint64_t first = at > chunk.offset ? at : chunk.offset, end = chunk.offset + chunk.bytes;
    if (at + bytes < end) end = at + bytes;
    if (first < end)
        memcpy(to + (first - chunk.offset), (const unsigned char *)from + (first - at),
               (size_t)(end - first));
}

/* The vertices of the blob, then those of desc.reserve.meshes. */
static void load_vertices(const source *s, masu_chunk chunk, unsigned char *to) {
    uint64_t own = s->scene->vertices - s->scene->host_vertices;
    memset(to, 0, s->scene->host_vertices ? (size_t)chunk.bytes : 0);
    copy_part(s->v->vertices, 0, own * sizeof(masu_blob_vertex), chunk, to);
}

/* Bind-pose vertices, then the deltas of their morph targets. */
static void load_skin_vertices(const source *s, masu_chunk chunk, unsigned char *to) {
    uint64_t own = s->scene->skin_vertices * sizeof(masu_blob_skin_vertex);
    copy_part(s->v->skin_vertices, 0, own, chunk, to);
    copy_part(s->v->morph_deltas, own, s->scene->morph_deltas * sizeof(masu_blob_morph_delta),
              chunk, to);
}

static void load_indices(const source *s, masu_chunk chunk, unsigned char *to) {
    copy(s->v->indices, chunk, to);
}

static void load_texcoords(const source *s, masu_chunk chunk, unsigned char *to) {
    static const uint32_t white = MASU_BLOB_WHITE;
    static const float zero[2] = {0.0f, 0.0f};
    const masu_texcoord_layout_of at = masu_texcoord_layout(s->scene);
    const uint64_t host = s->scene->host_vertices; /* at the end of each part */
    uint64_t second = at.colors - at.second, colors = at.bytes - at.colors;
    if (s->scene->second_texcoords) second -= 8 * host;
    if (s->scene->vertex_colors) colors -= 4 * host;
    memset(to, 0, host ? (size_t)chunk.bytes : 0);
    copy_part(s->v->texcoords, 0, at.second - 8 * host, chunk, to);
    copy_part(s->v->texcoords_1 ? s->v->texcoords_1 : zero, at.second, second, chunk, to);
    copy_part(s->v->colors ? s->v->colors : &white, at.colors, colors, chunk, to);
}

static void load_smaa_area(const source *s, masu_chunk chunk, unsigned char *to) {
    (void)s;
    copy(masu_smaa_area, chunk, to);
}

static void load_tables(const source *s, masu_chunk chunk, unsigned char *to) {
    write_tables(s->v, chunk, to);
}

static void load_probes(const source *s, masu_chunk chunk, unsigned char *to) {
    write_probes(s->v, chunk, to);
}

static void load_trace(const source *s, masu_chunk chunk, unsigned char *to) {
    masu_trace_write(s->scene, s->v, chunk.offset, chunk.bytes, to);
}

static void load_ray_indices(const source *s, masu_chunk chunk, unsigned char *to) {
    masu_ray_write_indices(s->v, chunk.offset, chunk.bytes, to);
}

/* The buffer may hold two sets of SDF parameters; both start with the values of the blob. */
static void load_slots(const source *s, masu_chunk chunk, unsigned char *to) {
    uint64_t size = s->v->slot_count * sizeof(float), at = chunk.offset, end = at + chunk.bytes;
    while (at < end) {
        uint64_t skip = at % size, part = size - skip < end - at ? size - skip : end - at;
        memcpy(to + (at - chunk.offset), (const unsigned char *)s->v->slots + skip, (size_t)part);
        at += part;
    }
}

/* With a small staging buffer a chunk may end within a material: converts the material and copies
 * the part. */
static void load_materials(const source *s, masu_chunk chunk, unsigned char *to) {
    uint64_t size = sizeof(struct masu_material_data), at = chunk.offset, end = at + chunk.bytes;
    while (at < end) {
        struct masu_material_data d = material_element(s->v, at / size);
        uint64_t skip = at % size, part = size - skip < end - at ? size - skip : end - at;
        memcpy(to + (at - chunk.offset), (const unsigned char *)&d + skip, (size_t)part);
        at += part;
    }
}

#define NOTHING NULL
#define LOADED(name) load_##name
static void (*const loads[MASU_BUFFER_COUNT])(const source *s, masu_chunk chunk,
                                              unsigned char *to) = {
#define BUFFER(ID, name, role, usage, slots, lifetime, loaded, ...) [MASU_BUFFER_##ID] = loaded,
#include "plan/buffers.inc"
#undef BUFFER
};

static void write_resident(const masu_scene_data *scene, const masu_scene_view *v, masu_chunk chunk,
                           unsigned char *to) {
    const source s = {scene, v};
    loads[chunk.buffer](&s, chunk, to);
}

/* Fills the staging buffer with one chunk. Returns the bytes written, without padding between
 * regions. */
static uint64_t write_textures(masu_device *m, const masu_scene_view *v, unsigned char *to) {
    uint64_t used = 0, bytes = 0, room = m->plan->buffers[MASU_BUFFER_STAGING].bytes;
    masu_texture_region region;
    while (masu_texture_next(v->textures, m->plan->scene.texture_arrays, m->plan->compressed, room,
                             &m->texture_next, &used, &region)) {
        masu_texture_write_region(&v->textures[region.texture], v->texels, m->plan->compressed,
                                  &region, to);
        bytes += used - region.offset;
    }
    return bytes;
}

/* Bytes of a buffer that are loaded; without a scene only the library's own tables. */
static uint64_t loaded_bytes(const masu_frame_plan *plan, uint32_t b) {
    if (!masu_buffers[b].loaded || (!plan->desc.scene && loads[b] != load_smaa_area)) return 0;
    return plan->buffers[b].bytes;
}

/* Writes up to `room` bytes, from m->load_place on, to buffers that the host can write directly.
 * Returns the number of bytes. */
static uint64_t write_in_place(masu_device *m, const masu_scene_view *v, uint64_t room) {
    uint64_t start = 0, written = 0;
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT && written < room; b++) {
        uint64_t whole = loaded_bytes(m->plan, b), from = m->load_place - start;
        if (from < whole) {
            uint64_t bytes = whole - from < room - written ? whole - from : room - written;
            masu_chunk part = {(masu_buffer_id)b, from, bytes, whole};
            write_resident(&m->plan->scene, v, part, masu_buffer_pointer(m, part.buffer, 0) + from);
            m->load_place += bytes;
            written += bytes;
        }
        start += whole;
    }
    return written;
}

uint64_t masu_load_bytes(const masu_device *m) {
    const masu_frame_plan *plan = m->plan;
    uint64_t bytes = 0;
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) bytes += loaded_bytes(plan, b);
    return bytes + masu_desc_texture_bytes(&plan->desc);
}

masu_load_step masu_load_next(masu_device *m) {
    masu_load_step step = {0};
    masu_scene_view v = {0}; /* some tables are loaded even without a scene */
    uint64_t most = m->plan->desc.load_step;
    if (m->plan->desc.scene) v = masu_scene_data_view(&m->plan->scene);
    if (!m->plan->staged) step.bytes = write_in_place(m, &v, most ? most : UINT64_MAX);
    int full = most && step.bytes; /* the step is used up: copies follow in the next */
    if (!full && m->load_next < m->load_count) {
        unsigned char *to = masu_buffer_pointer(m, MASU_BUFFER_STAGING, 0);
        if (m->load_next < buffer_chunks(m->plan)) {
            masu_chunk chunk = masu_load_chunk(m->plan, m->load_next);
            write_resident(&m->plan->scene, &v, chunk, to);
            step.bytes += chunk.bytes;
        } else if (m->load_next < copy_chunks(m->plan, m->load_count)) {
            step.bytes += write_textures(m, &v, to);
        }
        step.commands = m->loads[m->load_next++];
    }
    m->load_done += step.bytes;
    step.more = step.commands || m->load_next < m->load_count || (most && step.bytes == most);
    return step;
}

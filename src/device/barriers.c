/* barriers.c: pipeline barriers. Walks the accesses of a rung's passes and keeps the stage, access
 * and layout of each image's last use:
 * - A read after a write, any write, a layout change, or the first read by another stage needs a
 *   barrier.
 * - The first use of a transient image in a frame has the old layout UNDEFINED. It waits for all
 *   images that share memory with it and were used earlier in the frame.
 * - A full barrier at the start of the frame waits for the previous frame, so no state is carried
 *   from frame to frame. Exception: a persistent image is in the shader-read layout between frames.
 *   If the recording renders all contents that its rung reads, the image starts from UNDEFINED too.
 * - The host's own commands (desc.split) are a use by all stages. The part of the recording
 *   after them begins with a full barrier.
 *
 * Each pass has at most one vkCmdPipelineBarrier. */
#include "device/barriers.h"

masu_use masu_use_of(masu_usage usage, masu_pass_kind kind) {
    VkPipelineStageFlags shader = kind == MASU_PASS_GRAPHICS ? VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT
                                                             : VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
    VkPipelineStageFlags vertex =
        kind == MASU_PASS_GRAPHICS ? VK_PIPELINE_STAGE_VERTEX_SHADER_BIT : 0;
    switch (usage) {
    case MASU_READ:
    case MASU_READ_LINEAR:
    case MASU_READ_MAP:
        return (masu_use){1, shader, VK_ACCESS_SHADER_READ_BIT,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0};
    case MASU_READ_VERTICES:
        return (masu_use){1, VK_PIPELINE_STAGE_VERTEX_INPUT_BIT,
                          VK_ACCESS_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_INDEX_READ_BIT,
                          VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case MASU_READ_COPY:
    case MASU_READ_BACK:
        return (masu_use){1, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT,
                          VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, 0};
    case MASU_WRITE:
    case MASU_UPDATE:
    case MASU_PING_PONG:
        return (masu_use){1, shader, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
                          VK_IMAGE_LAYOUT_GENERAL, 1};
    case MASU_READ_BUFFER:
        return (masu_use){1, shader | vertex | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT,
                          VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT,
                          VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case MASU_WRITE_BUFFER:
        return (masu_use){1, shader, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT,
                          VK_IMAGE_LAYOUT_UNDEFINED, 1};
    case MASU_WRITE_COLOR:
    case MASU_UPDATE_COLOR:
        return (masu_use){1, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, 1};
    case MASU_BLEND_COLOR:
        return (masu_use){1, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_ACCESS_COLOR_ATTACHMENT_READ_BIT |
                              VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, 1};
    case MASU_WRITE_DEPTH:
    case MASU_UPDATE_DEPTH:
    case MASU_KEEP_DEPTH:
        return (masu_use){1,
                          VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                              VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT,
                          VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                              VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT,
                          VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, 1};
    case MASU_WRITE_COPY:
        return (masu_use){1, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                          VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1};
    case MASU_READ_STRUCTURE:
        return (masu_use){1, shader, VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR,
                          VK_IMAGE_LAYOUT_UNDEFINED, 0};
    case MASU_WRITE_STRUCTURE:
        return (masu_use){1, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR,
                          VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR |
                              VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR,
                          VK_IMAGE_LAYOUT_UNDEFINED, 1};
    case MASU_READ_HOST:
        return (masu_use){1, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT,
                          VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, 0};
    case MASU_HOST_COLOR:
    case MASU_HOST_DEPTH:
        return (masu_use){1, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                          VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                          usage == MASU_HOST_DEPTH ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_READ_ONLY_OPTIMAL
                                                   : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                          1};
    case MASU_USE_NONE: break;
    }
    return (masu_use){0, 0, 0, VK_IMAGE_LAYOUT_UNDEFINED, 0};
}

VkImage masu_recorded_image(const masu_recorder *rec, masu_image_id id) {
    return id == MASU_IMAGE_TARGET ? rec->m->plan->desc.targets.images[rec->target]
                                   : rec->m->objects.images[id];
}

static int share_bytes(const masu_image_plan *a, const masu_image_plan *b) {
    return a->offset < b->offset + b->bytes && b->offset < a->offset + a->bytes;
}

/* Adds the stages and writes that the first use of image `id` must wait for: all earlier users of
 * the same memory. If there are none, the caller's own stage chains with the barrier at the start
 * of the frame. TOP_OF_PIPE would not: it chains with nothing before it. */
static void add_tenants(const masu_recorder *rec, masu_image_id id, VkPipelineStageFlags *stages,
                        VkAccessFlags *access) {
    const masu_image_plan *images = rec->m->plan->images;
    for (uint32_t j = 1; j < MASU_IMAGE_SOURCE; j++) {
        if (j == (uint32_t)id || !rec->states[j].used || !images[id].used ||
            !share_bytes(&images[id], &images[j])) {
            continue;
        }
        *stages |= rec->states[j].stages;
        if (rec->states[j].writes) *access |= rec->states[j].access;
    }
}

VkImageMemoryBarrier masu_image_barrier(const masu_recorder *rec, masu_image_id id,
                                        VkAccessFlags from, const masu_use *to,
                                        VkImageLayout old_layout) {
    int depth = id < MASU_IMAGE_SOURCE && masu_is_depth(masu_images[id].format);
    return (VkImageMemoryBarrier){
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = from,
        .dstAccessMask = to->access,
        .oldLayout = old_layout,
        .newLayout = to->layout,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = masu_recorded_image(rec, id),
        .subresourceRange = {.aspectMask =
                                 depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT,
                             .levelCount = 1,
                             .layerCount = VK_REMAINING_ARRAY_LAYERS}};
}

void masu_barrier_before(masu_recorder *rec, uint32_t pass) {
    VkImageMemoryBarrier barriers[MASU_PASS_ACCESSES];
    VkMemoryBarrier memory = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    uint32_t n = 0;
    VkPipelineStageFlags from = 0, to = 0;
    for (uint32_t a = 0; a < rec->rp->access_count[pass]; a++) {
        masu_image_id id = (masu_image_id)rec->rp->access[pass][a].image;
        masu_usage usage = (masu_usage)rec->rp->access[pass][a].usage;
        if (id == MASU_IMAGE_SOURCE) continue; /* the host supplies it in a readable layout */
        masu_use next = masu_use_of(usage, masu_passes[pass].kind), *now = &rec->states[id];
        /* The vertex shader of particles samples images too: it computes the lighting at each
         * particle's centre. */
        if (usage == MASU_READ && masu_passes[pass].kind == MASU_PASS_GRAPHICS &&
            rec->m->plan->needs.particles)
            next.stages |= VK_PIPELINE_STAGE_VERTEX_SHADER_BIT;
        /* A target with storage usage may lack attachment usage, which only the host can check.
         * GENERAL is valid for both. */
        if (id == MASU_IMAGE_TARGET && usage == MASU_HOST_COLOR)
            next.layout = VK_IMAGE_LAYOUT_GENERAL;
        if (masu_is_buffer(id)) {
            /* Buffers. The barrier at the start of the frame covers the first use. A second
             * reader of data written in this frame may be a stage for which the write is not
             * visible yet. */
            int unseen = rec->written[id] && (next.stages & ~now->stages) != 0;
            if (next.writes) rec->written[id] = 1;
            if (now->used && (now->writes || next.writes || unseen)) {
                from |= now->stages;
                to |= next.stages;
                memory.srcAccessMask |= now->writes ? now->access : 0;
                memory.dstAccessMask |= next.access;
                if (!now->writes && !next.writes) next.stages |= now->stages;
            } else {
                next.stages |= now->stages;
            }
        } else if (!now->used) {
            VkAccessFlags access = 0;
            from |= next.stages;
            add_tenants(rec, id, &from, &access);
            barriers[n++] = masu_image_barrier(rec, id, access, &next, VK_IMAGE_LAYOUT_UNDEFINED);
            to |= next.stages;
        } else if (now->layout != next.layout || now->writes || next.writes ||
                   /* a stage for which the write is not visible yet */
                   next.stages & ~now->stages) {
            from |= now->stages;
            barriers[n++] =
                masu_image_barrier(rec, id, now->writes ? now->access : 0, &next, now->layout);
            to |= next.stages;
            /* Both uses are reads: a later writer waits for both stages. */
            if (!now->writes && !next.writes && now->layout == next.layout)
                next.stages |= now->stages;
        } else {
            next.stages |= now->stages; /* one more reader: a later writer waits for all */
        }
        *now = next;
    }
    if (masu_passes[pass].kind == MASU_PASS_HOST) { /* the host's commands may access anything */
        from = to = VK_PIPELINE_STAGE_ALL_COMMANDS_BIT;
        memory.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
        memory.dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    }
    if (!to) return;
    rec->m->vk.CmdPipelineBarrier(rec->cmd, from, to, 0, memory.dstAccessMask != 0, &memory, 0,
                                  NULL, n, barriers);
    rec->barriers++;
}

void masu_memory_barrier(masu_recorder *rec, VkPipelineStageFlags from, VkAccessFlags from_access,
                         VkPipelineStageFlags to, VkAccessFlags to_access) {
    VkMemoryBarrier b = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                         .srcAccessMask = from_access,
                         .dstAccessMask = to_access};
    rec->m->vk.CmdPipelineBarrier(rec->cmd, from, to, 0, 1, &b, 0, NULL, 0, NULL);
    rec->barriers++;
}

/* Persistent images keep the state in which the previous frame left them. Exception: if this
 * recording renders all cascades, images that need not be kept start from UNDEFINED. */
void masu_find_persistent(masu_recorder *rec) {
    int all = 1;
    for (uint32_t k = 0; k < rec->rp->cascades; k++)
        all = all && masu_variant_draws(rec->rp, rec->variant, k);
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        if (!rec->m->plan->images[i].persistent || (all && !masu_images[i].kept)) continue;
        rec->states[i] = masu_use_of(MASU_READ, MASU_PASS_COMPUTE);
    }
}

void masu_leave_persistent(masu_recorder *rec) {
    masu_use rest = masu_use_of(MASU_READ, MASU_PASS_COMPUTE);
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        const masu_use *now = &rec->states[i];
        if (!rec->m->plan->images[i].persistent || now->layout == rest.layout) continue;
        VkImageMemoryBarrier b = masu_image_barrier(
            rec, (masu_image_id)i, now->writes ? now->access : 0, &rest, now->layout);
        rec->m->vk.CmdPipelineBarrier(rec->cmd, now->stages, rest.stages, 0, 0, NULL, 0, NULL, 1,
                                      &b);
        rec->barriers++;
    }
}

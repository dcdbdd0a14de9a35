/* memory.c: see memory.h. */
#include "device/memory.h"

#include "device/shaders.h"

#include "base/error.h"
#include "plan/buffer_plan.h"
#include "scene/scene.h"
#include "scene/texture.h"

#include <string.h>

#define STAGING_BYTES ((uint64_t)4 << 20) /* if desc.load_step is 0 */

/* ---- Placement ------------------------------------------------------------------------------- */

static int alive_together(const masu_placement *a, const masu_placement *b) {
    return a->first <= b->last && b->first <= a->last;
}

static int overlaps(const masu_placement *a, const masu_placement *b) {
    return a->offset < b->offset + b->bytes && b->offset < a->offset + a->bytes;
}

/* First fit: places item `k` of `order` at the lowest offset at which it overlaps no item placed
 * before it. Only the ends of placed items, rounded up, need to be tried, and offset 0. */
static void place_one(masu_placement *items, const uint32_t *order, uint32_t k) {
    masu_placement *item = &items[order[k]];
    uint64_t best = UINT64_MAX;
    for (uint32_t c = 0; c <= k; c++) {
        uint64_t start = c == k ? 0 : items[order[c]].offset + items[order[c]].bytes;
        item->offset = masu_align_up(start, item->alignment);
        if (item->offset >= best) continue;
        int fits = 1;
        for (uint32_t j = 0; j < k && fits; j++) {
            fits = !(alive_together(item, &items[order[j]]) && overlaps(item, &items[order[j]]));
        }
        if (fits) best = item->offset;
    }
    item->offset = best;
}

static uint64_t place_in_order(masu_placement *items, const uint32_t *order, uint32_t n) {
    uint64_t end = 0;
    for (uint32_t k = 0; k < n; k++) {
        place_one(items, order, k);
        uint64_t e = items[order[k]].offset + items[order[k]].bytes;
        if (e > end) end = e;
    }
    return end;
}

/* Sort key of an item for each of the placement orders; larger keys are placed first. */
static uint64_t order_key(const masu_placement *item, uint32_t rule) {
    uint64_t life = item->last - item->first + 1;
    switch (rule) {
    case 0: return item->bytes;
    case 1: return item->bytes * life;
    case 2: return UINT32_MAX - item->first;
    default: return life;
    }
}

#define ORDER_RULES 4u

static void build_order(const masu_placement *items, uint32_t n, uint32_t rule, uint32_t *order) {
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = i;
        while (j > 0 && order_key(&items[order[j - 1]], rule) < order_key(&items[i], rule)) {
            order[j] = order[j - 1];
            j--;
        }
        order[j] = i;
    }
}

uint64_t masu_place(masu_placement *items, uint32_t n) {
    uint32_t order[MASU_MAX_RESOURCES];
    uint32_t best_rule = 0;
    uint64_t best = UINT64_MAX;
    for (uint32_t rule = 0; rule < ORDER_RULES; rule++) {
        build_order(items, n, rule, order);
        uint64_t end = place_in_order(items, order, n);
        if (end < best) {
            best = end;
            best_rule = rule;
        }
    }
    build_order(items, n, best_rule, order);
    return place_in_order(items, order, n);
}

uint64_t masu_place_lower_bound(const masu_placement *items, uint32_t n) {
    uint64_t most = 0;
    for (uint32_t i = 0; i < n; i++) {
        /* The live set only grows at the first row of some item, so only these rows need to be
         * tested. */
        uint64_t sum = 0;
        for (uint32_t j = 0; j < n; j++) {
            if (items[j].first <= items[i].first && items[i].first <= items[j].last) {
                sum += items[j].bytes;
            }
        }
        if (sum > most) most = sum;
    }
    return most;
}

/* ---- Memory types ---------------------------------------------------------------------------- */

#define LOCAL VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT
#define VISIBLE (VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT)
#define CACHED VK_MEMORY_PROPERTY_HOST_CACHED_BIT
/* Protected and lazily allocated memory cannot hold these resources. */
#define UNFIT (VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT | VK_MEMORY_PROPERTY_PROTECTED_BIT)

/* Finds the first memory type in `bits` that has all properties in `wanted` and whose heap holds
 * `bytes`. */
static int find_type(const masu_vk *vk, uint32_t bits, VkMemoryPropertyFlags wanted, uint64_t bytes,
                     uint32_t *type) {
    for (uint32_t i = 0; i < vk->memory.memoryTypeCount; i++) {
        const VkMemoryType *t = &vk->memory.memoryTypes[i];
        if (!(bits & 1u << i) || (t->propertyFlags & wanted) != wanted) continue;
        if ((t->propertyFlags & UNFIT) || vk->memory.memoryHeaps[t->heapIndex].size < bytes)
            continue;
        *type = i;
        return 1;
    }
    return 0;
}

/* In order of preference; the last entry is the minimum. */
static const VkMemoryPropertyFlags preferences[MASU_ROLE_COUNT][3] = {
    [MASU_ROLE_DEVICE] = {LOCAL, 0, 0},
    [MASU_ROLE_UPLOAD] = {VISIBLE | LOCAL, VISIBLE, VISIBLE},
    [MASU_ROLE_READBACK] = {VISIBLE | CACHED, VISIBLE, VISIBLE},
};

/* Chooses a block's memory type: the host's if it provides the block, else the preferred type that
 * fits. On unified memory the single block needs the properties of all roles. */
static masu_result choose_type(const masu_vk *vk, masu_frame_plan *plan, uint32_t role,
                               masu_detail *detail) {
    static const char *const names[] = {"device memory", "upload memory", "readback memory"};
    masu_block_plan *block = &plan->blocks[role];
    const masu_device_block *given = &plan->desc.device_blocks[role];
    if (!block->bytes) return MASU_OK;
    int found = 0;
    for (uint32_t i = 0; i < 3 && !found; i++) {
        VkMemoryPropertyFlags wanted = plan->unified ? LOCAL | VISIBLE : preferences[role][i];
        found = find_type(vk, block->type_bits, wanted, block->bytes, &block->type);
    }
    if (!found) {
        return masu_fail(detail, MASU_ERROR_DEVICE, names[role], block->bytes, 0,
                         "no memory type of '%s' can hold %llu bytes of %s (type bits 0x%x)",
                         vk->properties.deviceName, (unsigned long long)block->bytes, names[role],
                         block->type_bits);
    }
    if (given->memory) {
        if (given->memory_type >= vk->memory.memoryTypeCount ||
            !(block->type_bits & 1u << given->memory_type)) {
            return masu_fail(detail, MASU_ERROR_MEMORY, "device_blocks[].memory_type",
                             block->type_bits, given->memory_type,
                             "device_blocks[%u].memory_type is %u, allowed are the bits 0x%x", role,
                             given->memory_type, block->type_bits);
        }
        block->type = given->memory_type;
    }
    VkMemoryPropertyFlags flags = vk->memory.memoryTypes[block->type].propertyFlags;
    block->host_visible = plan->unified || role != MASU_ROLE_DEVICE || (flags & VISIBLE) == VISIBLE;
    return MASU_OK;
}

/* ---- Objects --------------------------------------------------------------------------------- */

static masu_result create_buffer(const masu_vk *vk, masu_frame_plan *plan, uint32_t b,
                                 masu_objects *objects, masu_detail *detail) {
    masu_buffer_plan *buffer = &plan->buffers[b];
    if (!buffer->bytes) return MASU_OK;
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = buffer->bytes,
                               .usage = buffer->usage};
    VkResult r = vk->CreateBuffer(vk->device, &info, vk->allocator, &objects->buffers[b]);
    if (MASU_FAILED(r, objects->buffers[b])) return masu_fail_vulkan(detail, r, "vkCreateBuffer");
    VkMemoryRequirements need;
    vk->GetBufferMemoryRequirements(vk->device, objects->buffers[b], &need);
    buffer->memory_bytes = need.size;
    /* The plan may require a larger alignment. Both are powers of two, so the larger one satisfies
     * both. */
    if (buffer->alignment < need.alignment) buffer->alignment = need.alignment;
    buffer->type_bits = need.memoryTypeBits;
    return MASU_OK;
}

static masu_result create_image(const masu_vk *vk, masu_frame_plan *plan, uint32_t i,
                                masu_objects *objects, masu_detail *detail) {
    masu_image_plan *image = &plan->images[i];
    if (!image->used) return MASU_OK;
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .flags = masu_plan_store_format(plan, i) == masu_plan_format(plan, i)
                                           ? 0
                                           : VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT |
                                                 VK_IMAGE_CREATE_EXTENDED_USAGE_BIT,
                              .format = masu_plan_format(plan, i),
                              .extent = {image->width, image->height, 1},
                              .mipLevels = 1,
                              .arrayLayers = masu_plan_layers(plan, i),
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .tiling = VK_IMAGE_TILING_OPTIMAL,
                              .usage = image->usage,
                              .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    VkResult r = vk->CreateImage(vk->device, &info, vk->allocator, &objects->images[i]);
    if (MASU_FAILED(r, objects->images[i])) return masu_fail_vulkan(detail, r, "vkCreateImage");
    VkMemoryRequirements need;
    vk->GetImageMemoryRequirements(vk->device, objects->images[i], &need);
    image->bytes = need.size;
    image->alignment = need.alignment;
    image->type_bits = need.memoryTypeBits;
    return MASU_OK;
}

static masu_result create_texture(const masu_vk *vk, const masu_blob_texture *t, int compressed,
                                  masu_texture_plan *texture, masu_detail *detail) {
    texture->format = masu_texture_form_of(t->format, compressed).format;
    texture->layers = t->layers;
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = texture->format,
                              .extent = {t->width, t->height, 1},
                              .mipLevels = t->mips,
                              .arrayLayers = t->layers,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .tiling = VK_IMAGE_TILING_OPTIMAL,
                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                              .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    VkResult r = vk->CreateImage(vk->device, &info, vk->allocator, &texture->image);
    if (MASU_FAILED(r, texture->image)) return masu_fail_vulkan(detail, r, "vkCreateImage");
    VkMemoryRequirements need;
    vk->GetImageMemoryRequirements(vk->device, texture->image, &need);
    texture->bytes = need.size;
    texture->alignment = need.alignment;
    texture->type_bits = need.memoryTypeBits;
    return MASU_OK;
}

static masu_result create_textures(const masu_vk *vk, masu_frame_plan *plan, masu_detail *detail) {
    if (!plan->scene.texture_arrays) return MASU_OK;
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    for (uint32_t i = 0; i < plan->scene.texture_arrays; i++) {
        masu_result result =
            create_texture(vk, &v.textures[i], plan->compressed, &plan->textures[i], detail);
        if (result) return result;
    }
    return MASU_OK;
}

void masu_objects_destroy(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects) {
    for (uint32_t i = 0; i < plan->scene.texture_arrays; i++) {
        vk->DestroyImage(vk->device, plan->textures[i].image, vk->allocator);
        plan->textures[i].image = VK_NULL_HANDLE;
    }
    for (uint32_t i = 0; i < MASU_IMAGE_COUNT; i++) {
        vk->DestroyImage(vk->device, objects->images[i], vk->allocator);
        objects->images[i] = VK_NULL_HANDLE;
    }
    for (uint32_t i = 0; i < MASU_BUFFER_COUNT; i++) {
        vk->DestroyBuffer(vk->device, objects->buffers[i], vk->allocator);
        objects->buffers[i] = VK_NULL_HANDLE;
    }
}

/* ---- Layout ---------------------------------------------------------------------------------- */

static void add_to_block(masu_block_plan *block, uint64_t alignment, uint32_t type_bits) {
    /* 0 if two resources have no memory type in common; choose_type reports it. */
    block->type_bits = block->alignment ? block->type_bits & type_bits : type_bits;
    if (block->alignment < alignment) block->alignment = alignment;
}

/* Appends the buffers of one role to a block. The staging and poison buffers are created and placed
 * later. */
static void place_buffers(masu_frame_plan *plan, masu_role role, masu_block_plan *block) {
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        masu_buffer_plan *buffer = &plan->buffers[b];
        if (!buffer->bytes || buffer->role != role || b == MASU_BUFFER_POISON) continue;
        block->address |= (buffer->usage & VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT) != 0;
        if (masu_buffers[b].of_loading) continue; /* by place_loading */
        buffer->offset = masu_align_up(block->bytes, buffer->alignment);
        block->bytes = buffer->offset + buffer->memory_bytes;
        add_to_block(block, buffer->alignment, buffer->type_bits);
    }
}

/* Resources that only masu_load uses share memory with the frames' transient images. Returns their
 * end. */
static uint64_t place_loading(masu_frame_plan *plan, uint64_t start, masu_block_plan *block) {
    uint64_t end = start;
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        masu_buffer_plan *buffer = &plan->buffers[b];
        if (!buffer->bytes || !masu_buffers[b].of_loading) continue;
        buffer->offset = masu_align_up(end, buffer->alignment);
        end = buffer->offset + buffer->memory_bytes;
        add_to_block(block, buffer->alignment, buffer->type_bits);
    }
    return end;
}

/* Textures live as long as the renderer: placed one after another, separated from buffers by
 * bufferImageGranularity. */
static void place_textures(const masu_vk *vk, masu_frame_plan *plan, masu_block_plan *block) {
    uint64_t granularity = vk->properties.limits.bufferImageGranularity;
    if (!plan->scene.texture_arrays) return;
    if (!granularity) granularity = 1;
    block->bytes = masu_align_up(block->bytes, granularity);
    for (uint32_t i = 0; i < plan->scene.texture_arrays; i++) {
        masu_texture_plan *t = &plan->textures[i];
        t->offset = masu_align_up(block->bytes, t->alignment);
        block->bytes = t->offset + t->bytes;
        add_to_block(block, t->alignment, t->type_bits);
    }
    block->bytes = masu_align_up(block->bytes, granularity);
}

static void place_images(const masu_vk *vk, masu_frame_plan *plan, masu_block_plan *block) {
    masu_placement items[MASU_IMAGE_COUNT];
    uint32_t ids[MASU_IMAGE_COUNT], n = 0;
    uint64_t granularity = vk->properties.limits.bufferImageGranularity;
    uint64_t start_alignment = granularity ? granularity : 1;
    for (uint32_t i = 0; i < MASU_IMAGE_COUNT; i++) {
        masu_image_plan *image = &plan->images[i];
        if (!image->used) continue;
        if (image->persistent) {
            /* Persistent images precede the transient ones and are outside the range that is
             * poisoned. */
            uint64_t apart = image->alignment > granularity ? image->alignment : granularity;
            image->offset = masu_align_up(block->bytes, apart ? apart : 1);
            block->bytes = image->offset + image->bytes;
            add_to_block(block, image->alignment, image->type_bits);
            continue;
        }
        items[n] = (masu_placement){image->bytes, image->alignment, image->first, image->last, 0};
        ids[n++] = i;
        if (image->alignment > start_alignment) start_alignment = image->alignment;
        plan->transient_unaliased += image->bytes;
        add_to_block(block, image->alignment, image->type_bits);
    }
    if (!n) return;
    plan->transient_aliased = masu_place(items, n);
    plan->transient_lower_bound = masu_place_lower_bound(items, n);
    plan->transient_offset = masu_align_up(block->bytes, start_alignment);
    if (block->alignment < start_alignment) block->alignment = start_alignment;
    for (uint32_t k = 0; k < n; k++) {
        plan->images[ids[k]].offset = plan->transient_offset + items[k].offset;
    }
    uint64_t end = plan->transient_offset + plan->transient_aliased;
    uint64_t loading = place_loading(plan, plan->transient_offset, block);
    /* The next resource (a buffer of another role, on unified memory) must not share a
     * bufferImageGranularity page with an image. */
    block->bytes = masu_align_up(end > loading ? end : loading, start_alignment);
}

static void layout_blocks(const masu_vk *vk, masu_frame_plan *plan) {
    memset(plan->blocks, 0, sizeof plan->blocks);
    plan->transient_unaliased = 0;
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++) {
        masu_block_plan *block = &plan->blocks[plan->unified ? MASU_ROLE_DEVICE : role];
        place_buffers(plan, (masu_role)role, block);
        if (role == MASU_ROLE_DEVICE) place_textures(vk, plan, block);
        if (role == MASU_ROLE_DEVICE) place_images(vk, plan, block);
    }
    masu_block_plan *block = &plan->blocks[masu_code_role(plan)];
    uint64_t room = plan->desc.init_in_steps ? 0 : masu_code_room(plan);
    if (!block->bytes && room) add_to_block(block, sizeof(uint32_t), UINT32_MAX);
    if (block->bytes < room) block->bytes = room;
}

static int is_unified(const masu_vk *vk, masu_frame_plan *plan) {
    VkPhysicalDeviceType type = vk->properties.deviceType;
    if (plan->desc.deny.unified_memory || type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU) return 0;
    plan->unified = 1;
    layout_blocks(vk, plan);
    const masu_block_plan *block = &plan->blocks[MASU_ROLE_DEVICE];
    uint32_t unused;
    return block->bytes && find_type(vk, block->type_bits, LOCAL | VISIBLE, block->bytes, &unused);
}

/* Staging bytes that hold all textures at once. Images have optimal tiling, so they need staging
 * even if the host can write their memory. */
static uint64_t texture_staging(const masu_frame_plan *plan) {
    if (!plan->scene.texture_arrays) return 0;
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    uint64_t bytes = masu_desc_texture_bytes(&plan->desc);
    for (uint32_t i = 0; i < plan->scene.texture_arrays; i++) {
        bytes += (uint64_t)v.textures[i].layers * v.textures[i].mips * MASU_BLOB_ALIGN;
    }
    return bytes;
}

/* Resident buffers need staging exactly if the host cannot write their memory. */
static masu_result create_staging(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects,
                                  masu_detail *detail) {
    uint64_t resident = 0;
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        if (masu_buffers[b].loaded) resident += plan->buffers[b].bytes;
    }
    uint64_t textures = texture_staging(plan);
    masu_buffer_plan *staging = &plan->buffers[MASU_BUFFER_STAGING];
    plan->staged = resident && !plan->blocks[MASU_ROLE_DEVICE].host_visible;
    if (!plan->staged) resident = 0;
    if (resident < textures) resident = textures;
    if (!resident) return MASU_OK;
    uint64_t most = plan->desc.load_step ? plan->desc.load_step : STAGING_BYTES;
    staging->bytes = resident < most ? resident : most;
    masu_result result = create_buffer(vk, plan, MASU_BUFFER_STAGING, objects, detail);
    if (!result) layout_blocks(vk, plan);
    return result;
}

static masu_result create_poison(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects,
                                 masu_detail *detail) {
    masu_buffer_plan *poison = &plan->buffers[MASU_BUFFER_POISON];
    if (!plan->desc.debug.poison || !plan->transient_aliased) return MASU_OK;
    /* vkCmdFillBuffer does not write a last partial 4-byte unit, so the size is rounded down. */
    poison->bytes = plan->transient_aliased & ~(uint64_t)3;
    masu_result result = create_buffer(vk, plan, MASU_BUFFER_POISON, objects, detail);
    if (result) return result;
    poison->offset = plan->transient_offset;
    masu_block_plan *block = &plan->blocks[MASU_ROLE_DEVICE];
    uint64_t end = poison->offset + poison->memory_bytes;
    if (poison->offset % poison->alignment || !(poison->type_bits & block->type_bits)) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "debug.poison", poison->alignment,
                         poison->offset,
                         "this device cannot lay a buffer over its images; leave "
                         "debug.poison at 0");
    }
    block->type_bits &= poison->type_bits;
    if (block->bytes < end) block->bytes = end;
    return MASU_OK;
}

masu_result masu_objects_create(const masu_vk *vk, masu_frame_plan *plan, masu_objects *objects,
                                masu_detail *detail) {
    memset(objects, 0, sizeof *objects);
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        masu_result result = create_buffer(vk, plan, b, objects, detail);
        if (result) return result;
    }
    for (uint32_t i = 0; i < MASU_IMAGE_COUNT; i++) {
        masu_result result = create_image(vk, plan, i, objects, detail);
        if (result) return result;
    }
    masu_result result = create_textures(vk, plan, detail);
    if (result) return result;
    plan->unified = is_unified(vk, plan);
    layout_blocks(vk, plan);
    result = choose_type(vk, plan, MASU_ROLE_DEVICE, detail);
    if (!result) result = create_staging(vk, plan, objects, detail);
    if (!result) result = create_poison(vk, plan, objects, detail);
    if (result) return result;
    uint64_t total = 0;
    for (uint32_t role = 0; role < MASU_ROLE_COUNT; role++) {
        result = choose_type(vk, plan, role, detail);
        if (result) return result;
        total += plan->blocks[role].bytes;
    }
    if (plan->desc.device_budget && total > plan->desc.device_budget) {
        return masu_fail(detail, MASU_ERROR_LIMIT, "device_budget", total, plan->desc.device_budget,
                         "device_budget: the plan needs %llu bytes, the budget is %llu",
                         (unsigned long long)total, (unsigned long long)plan->desc.device_budget);
    }
    return MASU_OK;
}

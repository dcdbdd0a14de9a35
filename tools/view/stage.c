/* stage.c: see stage.h. */
#include "view/stage.h"

#include "clock.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool said(masu_stage *s, char *error, size_t size) {
    snprintf(error, size, "%s", s->detail.text);
    return false;
}

/* ---- Device blocks --------------------------------------------------------------------------- */

static void free_block(masu_stage *s, masu_device_block *b) {
    vkFreeMemory(s->host->device, b->memory, NULL);
    memset(b, 0, sizeof *b);
}

static bool make_block(masu_stage *s, const masu_role_need *need, masu_device_block *b, char *error,
                       size_t size) {
    VkMemoryAllocateFlagsInfo flags = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_FLAGS_INFO,
                                       .flags = VK_MEMORY_ALLOCATE_DEVICE_ADDRESS_BIT};
    VkMemoryAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                 .pNext = need->device_address ? &flags : NULL,
                                 .allocationSize = need->bytes,
                                 .memoryTypeIndex = need->type};
    *b = (masu_device_block){.bytes = need->bytes, .memory_type = need->type};
    VkResult r = vkAllocateMemory(s->host->device, &info, NULL, &b->memory);
    if (r) return masu_headless_fail(error, size, "vkAllocateMemory", r);
    if (need->host_visible) {
        r = vkMapMemory(s->host->device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped);
        if (r) return masu_headless_fail(error, size, "vkMapMemory", r);
    }
    return true;
}

/* Ray queries need memory with a flag that an older block may lack. */
static bool block_serves(const masu_device_block *b, const masu_role_need *need) {
    return b->memory && b->bytes >= need->bytes && need->type_bits >> b->memory_type & 1u &&
           (!need->host_visible || b->mapped) && !need->device_address;
}

static bool fit_blocks(masu_stage *s, const masu_memory *need, char *error, size_t size) {
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) {
        const masu_role_need *role = &need->roles[r];
        if (!role->bytes || block_serves(&s->blocks[r], role)) continue;
        s->in_place = false;
        free_block(s, &s->blocks[r]);
        if (!make_block(s, role, &s->blocks[r], error, size)) {
            free_block(s, &s->blocks[r]);
            return false;
        }
    }
    if (s->block_bytes >= need->host_bytes) return true;
    s->in_place = false;
    free(s->block);
    uint64_t align = need->host_alignment;
    s->block_bytes = (need->host_bytes + align - 1) / align * align;
    s->block = aligned_alloc((size_t)align, (size_t)s->block_bytes);
    if (s->block) return true;
    snprintf(error, size, "out of memory for a host block of %llu bytes",
             (unsigned long long)s->block_bytes);
    s->block_bytes = 0;
    return false;
}

/* ---- Starting -------------------------------------------------------------------------------- */

static bool fit_target(masu_stage *s, VkExtent2D output, char *error, size_t size) {
    if (s->target.image && s->target.width == output.width && s->target.height == output.height)
        return true;
    masu_headless_target_destroy(s->host, &s->target);
    return masu_headless_target_create(s->host, output.width, output.height,
                                       VK_FORMAT_R8G8B8A8_UNORM, true, &s->target, error, size);
}

static void point_to_target(masu_stage *s, masu_desc *d) {
    d->targets = (masu_targets){
        .images = &s->target.image, .views = &s->target.view, .count = 1, .storage = 1};
}

static bool load(masu_stage *s, char *error, size_t size) {
    masu_commands commands;
    masu_result result;
    while ((result = masu_load(s->m, &commands, &s->detail)) == MASU_INCOMPLETE) {
        if (!masu_headless_run(s->host, commands.buffer, error, size)) return false;
    }
    return !result || said(s, error, size);
}

bool masu_stage_start(masu_stage *s, masu_headless *host, const masu_desc *desc, char *error,
                      size_t size) {
    uint64_t begin = masu_clock_ns(NULL);
    masu_desc d = *desc;
    masu_memory need;
    s->host = host;
    memset(d.device_blocks, 0, sizeof d.device_blocks);
    /* The plan does not depend on the image itself: a target of another size is enough for the
     * query. */
    if (!s->target.image && !fit_target(s, d.output, error, size)) return false;
    point_to_target(s, &d);
    if (masu_memory_query(&d, &need, &s->detail)) return said(s, error, size);
    /* From here on the previous renderer cannot be restored. */
    masu_destroy(s->m);
    s->m = NULL;
    s->frames = 0;
    s->in_place = true;
    if (!fit_target(s, d.output, error, size) || !fit_blocks(s, &need, error, size)) return false;
    point_to_target(s, &d);
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) {
        if (need.roles[r].bytes) d.device_blocks[r] = s->blocks[r];
    }
    if (masu_memory_query(&d, &need, &s->detail)) return said(s, error, size);
    uint64_t init = masu_clock_ns(NULL);
    if (masu_init(&d, s->block, s->block_bytes, &s->m, &s->detail)) return said(s, error, size);
    s->init_ms = (double)(masu_clock_ns(NULL) - init) / 1e6;
    if (!load(s, error, size)) {
        masu_destroy(s->m);
        s->m = NULL;
        return false;
    }
    s->desc = d;
    s->need = need;
    s->start_ms = (double)(masu_clock_ns(NULL) - begin) / 1e6;
    return true;
}

bool masu_stage_resize(masu_stage *s, VkExtent2D output, char *error, size_t size) {
    uint64_t begin = masu_clock_ns(NULL);
    masu_headless_target old = s->target;
    if (!s->m || output.width > s->desc.output.width || output.height > s->desc.output.height) {
        snprintf(error, size, "output size %ux%u is larger than planned", output.width,
                 output.height);
        return false;
    }
    /* The old target is destroyed when nothing refers to it. */
    memset(&s->target, 0, sizeof s->target);
    bool good =
        masu_headless_target_create(s->host, output.width, output.height, VK_FORMAT_R8G8B8A8_UNORM,
                                    true, &s->target, error, size);
    masu_targets targets = {
        .images = &s->target.image, .views = &s->target.view, .count = 1, .storage = 1};
    if (good && masu_resize(s->m, output, &targets, NULL, &s->detail)) {
        good = said(s, error, size);
        masu_headless_target_destroy(s->host, &s->target);
        if (s->detail.result == MASU_ERROR_VULKAN || s->detail.result == MASU_ERROR_DEVICE_LOST) {
            masu_destroy(s->m);
            s->m = NULL;
        }
    }
    if (!good) {
        s->target = old;
        return false;
    }
    masu_headless_target_destroy(s->host, &old);
    s->in_place = true;
    s->start_ms = (double)(masu_clock_ns(NULL) - begin) / 1e6;
    return true;
}

void masu_stage_close(masu_stage *s) {
    if (!s->host) return;
    masu_destroy(s->m);
    masu_headless_target_destroy(s->host, &s->target);
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) free_block(s, &s->blocks[r]);
    free(s->block);
    memset(s, 0, sizeof *s);
}

/* pool.c: see pool.h. */
#include "device/pool.h"

#include "base/error.h"
#include "plan/buffer_plan.h"
#include "device/vk.h"

#include <string.h>

_Static_assert(sizeof(masu_pool) <= sizeof(masu_pipelines), "a pool fits into what the host has");

static masu_pool *pool_in(masu_pipelines *pipelines) { return (masu_pool *)(void *)pipelines; }

static masu_pool *pool_of(const masu_device *m) { return pool_in(m->plan->desc.vulkan.pipelines); }

/* ---- Keys ------------------------------------------------------------------------------------ */

/* FNV-1a over 64-bit values. */
static uint64_t add(uint64_t key, uint64_t word) {
    for (uint32_t k = 0; k < 8; k++) key = (key ^ (word >> 8 * k & 255u)) * 0x100000001B3u;
    return key;
}

static uint64_t add_code(uint64_t key, const masu_code *code) {
    key = add(key, code->bytes);
    if (!code->words) return add(add(key, code->packed.run), code->packed.own);
    for (uint64_t i = 0; i < code->bytes / sizeof *code->words; i++) key = add(key, code->words[i]);
    return key;
}

uint64_t masu_pool_key(const masu_device *m, uint32_t pass, const masu_code codes[2], uint32_t form,
                       const uint32_t *constants, uint32_t constant_count) {
    uint64_t key = 0xCBF29CE484222325u;
    uint32_t declared =
        masu_code_interface(&codes[0]).constants | masu_code_interface(&codes[1]).constants;
    key = add_code(add_code(add(add(key, pass), form), &codes[0]), &codes[1]);
    for (uint32_t i = 0; i < constant_count; i++) {
        if (declared >> i & 1u) key = add(add(key, i), constants[i]);
    }
    VkDescriptorSetLayoutBinding global[MASU_BIND_COUNT];
    uint32_t count = masu_global_bindings(m->plan, pass, global);
    for (uint32_t i = 0; i < count; i++)
        key = add(add(add(key, global[i].binding), (uint64_t)global[i].descriptorType),
                  global[i].stageFlags);
    const masu_rung_plan *rp = masu_first_rung(m->plan, pass);
    for (uint32_t a = 0; a < rp->access_count[pass]; a++) {
        masu_access access = rp->access[pass][a];
        int bound =
            masu_has_set(pass) && (masu_access_binds(access, 0) || masu_access_binds(access, 1));
        int attached = access.usage == MASU_WRITE_COLOR || access.usage == MASU_BLEND_COLOR ||
                       access.usage == MASU_UPDATE_COLOR || access.usage == MASU_WRITE_DEPTH ||
                       access.usage == MASU_UPDATE_DEPTH || access.usage == MASU_KEEP_DEPTH;
        if (bound || attached) key = add(key, access.usage);
        /* The image format is part of a shader's storage image declaration. */
        if (attached) key = add(key, (uint64_t)masu_images[access.image].format);
    }
    return key ? key : 1;
}

/* ---- Acquiring and adding pipelines ---------------------------------------------------------- */

/* The i-th pipeline of the device, for 0 <= i < MASU_POOL_KEYS. */
static VkPipeline *place(masu_device *m, uint32_t i) {
    if (i < MASU_PASS_COUNT) return &m->pipelines[i];
    if (i < 2 * MASU_PASS_COUNT) return &m->last[i - MASU_PASS_COUNT];
    i -= 2 * MASU_PASS_COUNT;
    if (i < MASU_TEXTURED_COUNT) return &m->textured[i];
    i -= MASU_TEXTURED_COUNT;
    if (i < MASU_CULLED_COUNT) return &m->culled[i];
    i -= MASU_CULLED_COUNT;
    if (i < 2 * MASU_CULLED_COUNT) return &m->emitting[i];
    i -= 2 * MASU_CULLED_COUNT;
    return i == 0   ? &m->masked_casters
           : i == 1 ? &m->masked_faces
           : i == 2 ? &m->masked_picks
                    : &m->tints;
}

/* Notes the key of a pipeline, for masu_pool_release. */
static void note(masu_device *m, const VkPipeline *at, uint64_t key) {
    for (uint32_t i = 0; i < MASU_POOL_KEYS; i++) {
        if (place(m, i) == at) m->pool_keys[i] = key;
    }
}

int masu_pool_acquire(masu_device *m, uint64_t key, VkPipeline *out) {
    masu_pool *pool = pool_of(m);
    for (uint32_t i = 0; pool && i < pool->info.count; i++) {
        masu_pool_row *row = &pool->rows[i];
        if (row->key != key) continue;
        *out = row->pipeline;
        row->users++;
        row->used = ++pool->clock;
        pool->info.reused++;
        note(m, out, key);
        return 1;
    }
    return 0;
}

/* Returns a free row, or frees the row of the pipeline that has been unused for the longest time.
 * NULL if all are in use. */
static masu_pool_row *make_room(const masu_device *m, masu_pool *pool) {
    masu_pool_row *oldest = NULL;
    if (pool->info.count < MASU_MAX_PIPELINES) return &pool->rows[pool->info.count++];
    for (uint32_t i = 0; i < pool->info.count; i++) {
        masu_pool_row *row = &pool->rows[i];
        if (!row->users && (!oldest || pool->clock - row->used > pool->clock - oldest->used))
            oldest = row;
    }
    if (!oldest) return NULL;
    m->vk.DestroyPipeline(m->vk.device, oldest->pipeline, m->vk.allocator);
    pool->info.evicted++;
    return oldest;
}

void masu_pool_add(masu_device *m, const VkPipeline *at, uint64_t key) {
    masu_pool *pool = pool_of(m);
    if (!pool) return;
    pool->info.created++;
    masu_pool_row *row = make_room(m, pool);
    if (!row) return;
    *row = (masu_pool_row){key, *at, 1, ++pool->clock};
    note(m, at, key);
}

void masu_pool_release(masu_device *m) {
    masu_pool *pool = pool_of(m);
    if (!pool) return;
    for (uint32_t i = 0; i < MASU_POOL_KEYS; i++) {
        VkPipeline *from = place(m, i);
        for (uint32_t r = 0; r < pool->info.count && *from && m->pool_keys[i]; r++) {
            masu_pool_row *row = &pool->rows[r];
            if (row->pipeline != *from) continue;
            row->users--;
            row->used = ++pool->clock;
            *from = VK_NULL_HANDLE;
        }
    }
    m->sampler = m->linear = VK_NULL_HANDLE; /* the pool owns them */
}

VkSampler masu_pool_sampler(const masu_device *m, uint32_t number) {
    const masu_pool *pool = pool_of(m);
    return pool ? pool->samplers[number] : VK_NULL_HANDLE;
}

void masu_pool_add_sampler(masu_device *m, uint32_t number, VkSampler sampler) {
    masu_pool *pool = pool_of(m);
    if (pool) pool->samplers[number] = sampler;
}

/* ---- Public functions ------------------------------------------------------------------------ */

void masu_pipelines_info_of(const masu_pipelines *pipelines, masu_pipelines_info *out) {
    const masu_pool *pool = (const masu_pool *)(const void *)pipelines;
    if (!out) return;
    *out = pool ? pool->info : (masu_pipelines_info){0};
    for (uint32_t i = 0; i < out->count; i++) out->used += pool->rows[i].users != 0;
}

void masu_pipelines_destroy(const masu_vulkan *vulkan, masu_pipelines *pipelines) {
    masu_pool *pool = pool_in(pipelines);
    if (!vulkan || !pool || !vulkan->get_instance_proc_addr || !vulkan->device) return;
    PFN_vkGetDeviceProcAddr device_proc = (PFN_vkGetDeviceProcAddr)vulkan->get_instance_proc_addr(
        vulkan->instance, "vkGetDeviceProcAddr");
    if (!device_proc) return;
    PFN_vkDestroyPipeline destroy =
        (PFN_vkDestroyPipeline)device_proc(vulkan->device, "vkDestroyPipeline");
    PFN_vkDestroySampler destroy_sampler =
        (PFN_vkDestroySampler)device_proc(vulkan->device, "vkDestroySampler");
    for (uint32_t i = 0; destroy && i < pool->info.count; i++)
        destroy(vulkan->device, pool->rows[i].pipeline, vulkan->allocator);
    for (uint32_t i = 0; destroy_sampler && i < 2; i++)
        destroy_sampler(vulkan->device, pool->samplers[i], vulkan->allocator);
    memset(pipelines, 0, sizeof *pipelines);
}

/* pool.h: pipelines that outlive their renderer (masu_pipelines in masu.h). masu_init takes the
 * pipelines that match and adds those that it had to create; masu_destroy releases them. The host
 * owns the pool, and the pool owns its pipelines. Several renderers may share a pool, but must not
 * call it at the same time.
 *
 * A key is a hash of everything that a pipeline is created from: pass and code, the constants and
 * bindings that the code declares, and the attachments. Scenes may differ in anything else. Each
 * renderer has its own layouts and render passes, which are compatible if the keys are equal
 * (specification, "Pipeline Layout Compatibility", "Render Pass Compatibility"). Samplers are part
 * of layouts, so the pool owns them too. */
#ifndef MASU_POOL_H
#define MASU_POOL_H

#include "device/device.h"
#include "device/shaders.h"
#include "scene/scene_data.h"

/* MASU_MAY_ALIAS: the host's memory has the type masu_pipelines. */
typedef struct MASU_MAY_ALIAS masu_pool_row {
    uint64_t key; /* hash of everything that the pipeline was created from */
    VkPipeline pipeline;
    uint32_t users; /* number of renderers that use the pipeline */
    uint32_t used;  /* `clock` at the last acquire or release */
} masu_pool_row;

/* The content of the host's masu_pipelines. */
typedef struct MASU_MAY_ALIAS masu_pool {
    masu_pipelines_info info; /* `used` is computed on request */
    uint32_t clock;
    VkSampler samplers[2];
    masu_pool_row rows[MASU_MAX_PIPELINES];
} masu_pool;

/* Largest number of pipelines of a renderer: two forms per pass, and the textured, culled,
 * emitting, masked and tinted variants. */
#define MASU_POOL_KEYS (2 * MASU_PASS_COUNT + MASU_TEXTURED_COUNT + 3 * MASU_CULLED_COUNT + 4)

/* codes: both stages; the second is empty for a compute pass. form: vertex input, culling and
 * blending of a graphics pass. constants: only those that the code declares contribute. Everything
 * else follows from plan and pass. */
uint64_t masu_pool_key(const masu_device *m, uint32_t pass, const masu_code codes[2], uint32_t form,
                       const uint32_t *constants, uint32_t constant_count);

/* Sets *out, a member of the device, to the pipeline with this key. Returns 0 if there is none. */
int masu_pool_acquire(masu_device *m, uint64_t key, VkPipeline *out);
/* Adds a pipeline that the device had to create. If the pool is full and all its pipelines are in
 * use, the renderer keeps ownership. */
void masu_pool_add(masu_device *m, const VkPipeline *at, uint64_t key);
/* The renderer releases all its pipelines and samplers of the pool. */
void masu_pool_release(masu_device *m);
/* Sampler 0 or 1 of the pool. VK_NULL_HANDLE if the pool has none yet, or without a pool. */
VkSampler masu_pool_sampler(const masu_device *m, uint32_t number);
/* Transfers ownership of a sampler to the pool, if there is one. */
void masu_pool_add_sampler(masu_device *m, uint32_t number, VkSampler sampler);

#endif

/* pool.h: pipelines that outlive their renderer, masu_pipelines of the public header: masu_init
 * uses what is there and adds what it had to make, masu_destroy uses it no more. The host owns
 * the pool, the pool its pipelines; several renderers may use one at a time.
 *
 * A key says what a pipeline was made of: its pass and code, the constants and bindings that the
 * code declares, what it is drawn to. Other differences between scenes do not count. Layouts
 * and render passes are each renderer's own, and compatible where the keys agree (specification,
 * "Pipeline Layout Compatibility", "Render Pass Compatibility"); samplers stand in layouts, so
 * they are the pool's too. */
#ifndef MASU_POOL_H
#define MASU_POOL_H

#include "device/device.h"
#include "device/shaders.h"
#include "scene/scene_data.h"

/* The host's memory has another type (masu_pipelines). */
typedef struct MASU_MAY_ALIAS masu_pool_row {
    uint64_t key; /* hash of everything that the pipeline was created from */
    VkPipeline pipeline;
    uint32_t users; /* references from existing renderers */
    uint32_t used;  /* `clock` when it was last taken or given back */
} masu_pool_row;

/* The content of a masu_pipelines. */
typedef struct MASU_MAY_ALIAS masu_pool {
    masu_pipelines_info info; /* `used` is counted when it is asked for */
    uint32_t clock;
    VkSampler samplers[2];
    masu_pool_row rows[MASU_MAX_PIPELINES];
} masu_pool;

/* Most pipelines of a renderer: each pass's two forms, and those of textures. */
#define MASU_POOL_KEYS (2 * MASU_PASS_COUNT + MASU_TEXTURED_COUNT + 3 * MASU_CULLED_COUNT + 4)

/* codes: of both stages; the second none of a compute pass. form: the vertex input, culling and
 * blending of a graphics pass. Of the constants those count that the code declares. The rest
 * follows from plan and pass. */
uint64_t masu_pool_key(const masu_device *m, uint32_t pass, const masu_code codes[2], uint32_t form,
                       const uint32_t *constants, uint32_t constant_count);

/* Into *out, a pipeline of the device, if there is one of that key. */
int masu_pool_acquire(masu_device *m, uint64_t key, VkPipeline *out);
/* Adds a pipeline of the device that had to be made; if all of a full pool are in use, it stays
 * the renderer's. */
void masu_pool_add(masu_device *m, const VkPipeline *at, uint64_t key);
/* The renderer uses none of the pool's pipelines and samplers any more. */
void masu_pool_release(masu_device *m);
/* Sampler 0 or 1 of the pool: VK_NULL_HANDLE: it has none yet, or there is no pool. */
VkSampler masu_pool_sampler(const masu_device *m, uint32_t number);
/* Gives the pool a sampler, if there is one. */
void masu_pool_add_sampler(masu_device *m, uint32_t number, VkSampler sampler);

#endif

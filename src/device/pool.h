/* pool.h: pipelines that outlive their renderer, masu_pipelines of the public header: masu_init uses what is there
 * and adds what it had to make, masu_destroy uses it no more. The host owns the pool, the pool its pipelines; several
 * renderers may use one at a time.
 *
 * A key says what a pipeline was made of: its pass and code, its constants, what is bound to it, what it is
 * drawn to. Layouts and render passes are each renderer's own, and compatible where the keys agree
 * (specification, "Pipeline Layout Compatibility", "Render Pass Compatibility"); samplers stand in layouts,
 * so they are the pool's too. */
#ifndef MASU_POOL_H
#define MASU_POOL_H

#include "device/device.h"
#include "device/shaders.h"

/* Most pipelines of a renderer: each pass's two forms, and those of textures. */
#define MASU_POOL_KEYS (2 * MASU_PASS_COUNT + MASU_TEXTURED_COUNT + MASU_CULLED_COUNT + 3)

/* codes: of both stages; the second none of a compute pass. The rest of what a key says follows from plan and
 * pass. */
uint64_t masu_pool_key(const masu_device *m, uint32_t pass, const masu_code codes[2], int textured,
                       const uint32_t *constants, uint32_t constant_count);

/* Into *out, a pipeline of the device, if there is one of that key. */
int masu_pool_acquire(masu_device *m, uint64_t key, VkPipeline *out);
/* Adds a pipeline of the device that had to be made; if all of a full pool are in use, it stays the renderer's. */
void masu_pool_add(masu_device *m, const VkPipeline *at, uint64_t key);
/* The renderer uses none of the pool's pipelines and samplers any more. */
void masu_pool_release(masu_device *m);
/* The place of a sampler, 0 or 1, which may not exist yet; NULL without a pool. */
VkSampler *masu_pool_sampler(masu_device *m, uint32_t number);

#endif

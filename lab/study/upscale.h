/* upscale.h: a chain of compute shaders from one image to another, bound like the passes of a
 * frame but outside the library: `masu-lab study upscale` compares it with the library's rungs.
 *
 * A stage reads binding 0 of set 1 (the output of the stage before, clamped to its edge, nearest
 * texel) and writes binding 1; set 0 has only the counters; push constants are as in a frame. The
 * chain owns its objects; the caller owns the host, the source and the target. Functions that can
 * fail return false and write one line to `error`. */
#ifndef MASU_BENCH_UPSCALE_H
#define MASU_BENCH_UPSCALE_H

#include "headless.h"
#include "shared/masu_shared.h"

#define MASU_BENCH_STAGES 2u

typedef struct masu_bench_stage {
    const uint32_t *words; /* SPIR-V; NULL: the end of the chain */
    size_t bytes;
    uint32_t block; /* pixels along an edge of a workgroup; 0: MASU_GROUP */
    float lobe;     /* RCAS's push constant */
} masu_bench_stage;

typedef struct masu_bench_chain {
    masu_headless *host;
    masu_headless_target middle; /* between two stages */
    VkSampler sampler;
    VkDescriptorSetLayout empty, images;
    VkPipelineLayout layout;
    VkPipeline pipelines[MASU_BENCH_STAGES];
    VkDescriptorPool pool;
    VkDescriptorSet counters_set, sets[MASU_BENCH_STAGES];
    masu_headless_buffer counters;
    VkQueryPool queries;
    VkCommandBuffer commands;
} masu_bench_chain;

/* Records the chain. counting: constant 0 of its shaders. */
bool masu_bench_chain_open(masu_headless *host, const masu_bench_stage stages[MASU_BENCH_STAGES],
                           const masu_headless_source *source, VkExtent2D from,
                           const masu_headless_target *target, bool counting,
                           masu_bench_chain *chain, char *error, size_t error_size);
void masu_bench_chain_close(masu_bench_chain *chain);

/* Runs it and waits. wall: seconds from submit to fence; gpu: between two timestamps; 0: no
 * timestamps. */
bool masu_bench_chain_run(masu_bench_chain *chain, double *wall, double *gpu, char *error,
                          size_t error_size);
uint64_t masu_bench_chain_count(const masu_bench_chain *chain, uint32_t counter);

#endif

/* hook.h: a vkGetInstanceProcAddr that puts counters (spirv_tally.h) into every shader
 * that a renderer makes pipelines of, binds the buffer that they count in, and knows which row
 * of the frame table each belongs to.
 *
 * Vulkan's functions carry no pointer of the host's, so the state is this process's: one
 * renderer at a time. Device and renderer are the caller's; what is made here goes with
 * masu_hook_end, which comes after the renderer is destroyed. */
#ifndef MASU_MODEL_HOOK_H
#define MASU_MODEL_HOOK_H

#include "headless.h"
#include "lab/model/spirv_tally.h"

#define MASU_HOOK_SHADERS 192u

typedef struct masu_hook_shader {
    uint32_t pass; /* row of the frame table */
    masu_tally tally;
    const uint32_t *counts; /* MASU_TALLY_WORDS of the last frame */
    uint32_t straight;      /* plain operations of all instructions once that its constants leave */
} masu_hook_shader;

/* What the renderer is to use. */
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_hook_get_instance_proc_addr(VkInstance instance,
                                                                          const char *name);

/* Before masu_init. `passes`: the rows that get a pipeline layout, in order (src/device/pipelines.c
 * makes one of each row that some rung runs and that is no copy and no build). */
bool masu_hook_begin(masu_headless *host, const uint32_t *passes, uint32_t count, char *error,
                     size_t error_size);
void masu_hook_end(void);

/* Sets all counts to 0; nothing may be running. */
void masu_hook_clear(void);

/* After the frame has finished: makes its counts visible here. */
bool masu_hook_read(char *error, size_t error_size);

/* All shaders that pipelines were made of. */
const masu_hook_shader *masu_hook_shaders(uint32_t *count);

/* After masu_init. False: a shader could not be taken apart, or the pipeline layouts are not
 * those of `passes`: what would be counted is not the frame. */
bool masu_hook_good(char *error, size_t error_size);

#endif

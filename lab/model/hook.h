/* hook.h: a vkGetInstanceProcAddr that inserts counters (spirv_tally.h) into every shader of a
 * renderer's pipelines, binds the counter buffer, and maps each shader to its row of the frame
 * table.
 *
 * Vulkan functions have no user pointer, so the state is global: one renderer at a time. The caller
 * owns device and renderer; masu_hook_end destroys the objects created here, after the renderer is
 * destroyed. */
#ifndef MASU_MODEL_HOOK_H
#define MASU_MODEL_HOOK_H

#include "headless.h"
#include "lab/model/spirv_tally.h"

#define MASU_HOOK_SHADERS 192u

typedef struct masu_hook_shader {
    uint32_t pass; /* row of the frame table */
    masu_tally tally;
    const uint32_t *counts; /* MASU_TALLY_WORDS of the last frame */
    uint32_t straight;      /* plain operations with each instruction once that its constants leave
                             * reachable */
} masu_hook_shader;

/* The vkGetInstanceProcAddr for the renderer. */
VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL masu_hook_get_instance_proc_addr(VkInstance instance,
                                                                          const char *name);

/* Call it before masu_init. `passes`: the rows with a pipeline layout, in order
 * (src/device/pipelines.c creates one for each row that some rung runs, except copies and
 * acceleration structure builds). */
bool masu_hook_begin(masu_headless *host, const uint32_t *passes, uint32_t count, char *error,
                     size_t error_size);
void masu_hook_end(void);

/* Sets all counts to 0; nothing may be running. */
void masu_hook_clear(void);

/* After the frame has finished: makes its counts visible here. */
bool masu_hook_read(char *error, size_t error_size);

/* All shaders of the created pipelines. */
const masu_hook_shader *masu_hook_shaders(uint32_t *count);

/* Call it after masu_init. Returns false if a shader could not be parsed, or if the pipeline
 * layouts differ from `passes`: the counts would not describe the frame. */
bool masu_hook_good(char *error, size_t error_size);

#endif

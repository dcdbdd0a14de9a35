/* count.h: counts the work of a scene's passes while they run: operations, texels and bytes of
 * buffers, per pass and rung.
 *
 * A separate renderer renders each rung with counters in all shaders (hook.h), on any device: the
 * number of executions of an instruction is the same everywhere except for rounding. Counts are for
 * the rendered size; sheet.h scales them. */
#ifndef MASU_MODEL_COUNT_H
#define MASU_MODEL_COUNT_H

#include "plan/frame_plan.h"
#include "headless.h"
#include "plan/plan.h"
#include "lab/model/spirv_tally.h"

#define MASU_COUNT_NUMBERS 48u

/* Sums are 32-bit values, to which an invocation adds up to 1023: 4.1 million invocations fit,
 * including those of groups beyond the image's edge. */
#define MASU_COUNT_PIXELS_MAX 3800000u

typedef struct masu_count_number {
    masu_tally_kind kind; /* bytes or texels */
    uint32_t set, binding;
    double amount;
} masu_count_number;

/* Counts of one pass in one rung, per frame. */
typedef struct masu_pass_count {
    double vertices, invocations; /* of vertex shaders; of fragment or compute shaders */
    double vertex_plain, vertex_weighted, plain, weighted; /* operations */
    double most; /* largest number of plain operations of a fragment or compute invocation */
    bool late;   /* a shader discards: occluded fragments are counted, too */
    uint32_t number_count;
    masu_count_number numbers[MASU_COUNT_NUMBERS];
} masu_pass_count;

typedef struct masu_count_desc {
    const char *scene_path;
    VkExtent2D size;     /* of the counted frames */
    VkExtent2D sheet;    /* of the sheet's plan */
    double time;         /* of the scene and its camera */
    uint32_t rung_count; /* 0: the default rungs */
    masu_rung rungs[MASU_MAX_RUNGS];
    masu_headless_desc host;
} masu_count_desc;

typedef struct masu_count {
    uint32_t rung_count;
    char driver[1024];
    masu_frame_plan drawn, sheet; /* `scene` must not be read in either */
    masu_pass_count passes[MASU_MAX_RUNGS][MASU_PASS_COUNT];
    /* For the camera, for the cascades; before occlusion culling. */
    double triangles[MASU_MAX_RUNGS][2];
    double texture_bytes; /* of materials, on the device */
    /* Plain operations of a pass's shaders with each instruction once: fragment and compute
     * shaders; vertex shaders. The first cascade contains all cascades. */
    double straight[MASU_PASS_COUNT][2];
    uint32_t messages;    /* of the validation layer */
} masu_count;

/* Passes with a pipeline layout, in order (src/device/pipelines.c, masu_create_pipelines). */
uint32_t masu_count_passes(const masu_frame_plan *plan, uint32_t out[MASU_PASS_COUNT]);

/* Halves the size until it is allowed. */
VkExtent2D masu_count_size(VkExtent2D size);

/* `out` is large: do not put it on the stack. `progress` may be NULL. On false `error` holds one
 * line. */
bool masu_count_run(const masu_count_desc *desc, void (*progress)(const char *text),
                    masu_count *out, char *error, size_t error_size);

#endif

/* count.h: what the passes of a scene do, counted while they run: operations, texels,
 * bytes of buffers, of each pass in each rung.
 *
 * A renderer of its own draws each rung with counters in all shaders (hook.h), on any
 * device: how often an instruction runs is the same everywhere but for rounding. Counts are of
 * the size that was drawn; sheet.h scales them. */
#ifndef MASU_MODEL_COUNT_H
#define MASU_MODEL_COUNT_H

#include "plan/frame_plan.h"
#include "headless.h"
#include "plan/plan.h"
#include "lab/model/spirv_tally.h"

#define MASU_COUNT_NUMBERS 48u

/* Sums are words of 32 bits, to which an invocation adds up to 1023: 4.1 million fit, of which
 * some are groups that reach over the picture's edge. */
#define MASU_COUNT_PIXELS_MAX 3800000u

typedef struct masu_count_number {
    masu_tally_kind kind; /* bytes or texels */
    uint32_t set, binding;
    double amount;
} masu_count_number;

/* Of one pass in one rung, a frame. */
typedef struct masu_pass_count {
    double vertices, invocations; /* of vertex shaders; of fragment or compute shaders */
    double vertex_plain, vertex_weighted, plain, weighted; /* operations */
    double most; /* plain operations of the busiest fragment or compute invocation */
    bool late;   /* a shader discards: fragments that are hidden are counted, too */
    uint32_t number_count;
    masu_count_number numbers[MASU_COUNT_NUMBERS];
} masu_pass_count;

typedef struct masu_count_desc {
    const char *scene_path;
    VkExtent2D size;     /* that is drawn */
    VkExtent2D sheet;    /* whose plan is made */
    double time;         /* of the scene and its camera */
    uint32_t rung_count; /* 0: the library's own */
    masu_rung rungs[MASU_MAX_RUNGS];
    masu_headless_desc host;
} masu_count_desc;

typedef struct masu_count {
    uint32_t rung_count;
    char driver[1024];
    masu_frame_plan drawn, sheet; /* `scene` of neither may be read */
    masu_pass_count passes[MASU_MAX_RUNGS][MASU_PASS_COUNT];
    /* Of the camera's draws, of the cascades'; before occlusion. */
    double triangles[MASU_MAX_RUNGS][2];
    double texture_bytes; /* of materials, on the device */
    /* Plain operations of a pass's shaders once: of fragment and compute shaders, of vertex shaders. Of cascades: the
     * first has all. */
    double straight[MASU_PASS_COUNT][2];
    uint32_t messages;    /* of the validation layer */
} masu_count;

/* Rows that get a pipeline layout, in order (src/device/pipelines.c, masu_create_pipelines). */
uint32_t masu_count_passes(const masu_frame_plan *plan, uint32_t out[MASU_PASS_COUNT]);

/* Halved until it may be drawn. */
VkExtent2D masu_count_size(VkExtent2D size);

/* `out` is large: not for the stack. `progress` may be NULL. False: `error` holds one line. */
bool masu_count_run(const masu_count_desc *desc, void (*progress)(const char *text),
                    masu_count *out, char *error, size_t error_size);

#endif

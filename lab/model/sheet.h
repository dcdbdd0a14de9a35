/* sheet.h: the model sheet: a lower bound of the time of each pass and rung on five classes of GPU,
 * computed from bytes and operations.
 *
 * The lower bound of a pass is the larger of two times: its compulsory bytes (each image and buffer
 * read once and written once, but not more than requested) at the class's bandwidth, and its
 * operations at the class's peak. The realistic time is 1.3 times the bound if bytes dominate, 2.5
 * times if operations do (ray traversal kernels are 1.5 to 2.5 times slower than their bound: Aila
 * and Laine 2009). If the class's compiler was queried (issued.h), operations are its instructions,
 * one per lane and clock, and the realistic time is 1.5 times the bound, because of lanes that wait
 * for others, times the factor for too few waves. Nothing is measured on a GPU. Pure functions;
 * nothing allocates. */
#ifndef MASU_MODEL_SHEET_H
#define MASU_MODEL_SHEET_H

#include "lab/model/count.h"
#include "lab/model/issued.h"

#define MASU_MODEL_CLASSES 5u
#define MASU_MODEL_BUDGETS 2u
#define MASU_MODEL_NAME 192u

/* Peak of single precision: an addition is one operation, a fused multiply-add two; memory
 * bandwidth. */
typedef struct masu_model_class {
    const char *name, *what, *gpu; /* gpu: whose compiler represents it (isa/gpu.h) */
    double tflops, gigabytes;
} masu_model_class;

extern const masu_model_class masu_model_classes[MASU_MODEL_CLASSES];
extern const double masu_model_budgets[MASU_MODEL_BUDGETS]; /* ms: of 60 and 30 frames per second */

/* Accuracy of a number; a sum has the worst of its parts. */
typedef enum masu_model_sure {
    MASU_MODEL_EXACT,    /* follows from sizes: every pixel takes the same path */
    MASU_MODEL_MEASURED, /* depends on the scene: counted while rendering */
    MASU_MODEL_ESTIMATED /* contains an assumed constant */
} masu_model_sure;

typedef struct masu_model_row {
    bool runs;
    double bytes;           /* compulsory */
    double asked;           /* of storage buffers, by shaders: load on the caches */
    double weighted, plain; /* operations, see spirv_cost.h */
    double invocations;     /* of fragment or compute shaders */
    double issued[MASU_MODEL_CLASSES]; /* instructions of lanes; 0: its compiler was not queried */
    double waits[MASU_MODEL_CLASSES];
    masu_model_sure bytes_sure, weighted_sure;
} masu_model_row;

typedef struct masu_model_rung {
    char name[MASU_MODEL_NAME];
    uint32_t width, height; /* render size */
    double measured;        /* time relative to the base, from ladder.json; NAN: not given */
    masu_model_row rows[MASU_PASS_COUNT], sum;
    double floor[MASU_MODEL_CLASSES], realistic[MASU_MODEL_CLASSES]; /* ms */
} masu_model_rung;

typedef struct masu_model_sheet {
    char scene[128], driver[1024];
    VkExtent2D drawn, sheet;
    uint32_t rung_count;
    masu_model_rung rungs[MASU_MAX_RUNGS];
    bool issued[MASU_MODEL_CLASSES]; /* its compiler was queried */
    int chosen[MASU_MODEL_CLASSES][MASU_MODEL_BUDGETS]; /* first rung that fits; -1: none */
} masu_model_sheet;

/* issued: one per class; NULL: none. Does not change names and measured ratios of rungs. */
void masu_model_make(const masu_count *count, const masu_issued *issued, masu_model_sheet *out);

/* ms; `by_bytes` may be NULL. */
double masu_model_floor(const masu_model_row *row, uint32_t class_of, bool *by_bytes);
double masu_model_realistic(const masu_model_row *row, uint32_t class_of);

/* All cascades share their pipelines and one row. */
const char *masu_model_pass_name(uint32_t pass);
const char *masu_model_sure_name(masu_model_sure sure);

#endif

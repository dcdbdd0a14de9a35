/* sheet.h: the model sheet: what each pass of each rung would take at least on five
 * classes of GPU, computed from bytes and operations.
 *
 * The floor of a pass is the longer of two: its compulsory bytes (each image and buffer read
 * once and written once, no more than was asked for) at the class's bandwidth, and its
 * operations at the class's peak. What is realistic is 1.3 times that where bytes decide, 2.5
 * times where operations do (kernels of ray traversal are 1.5 to 2.5 times off their bound: Aila
 * and Laine 2009). Where the class's own compiler has been asked (issued.h), operations are its
 * instructions, one for a lane and clock, and what is realistic 1.5 times that: what is left are lanes that
 * wait for others; and as many times more as too few waves make the pass wait. Nothing of it is measured on a GPU. Pure functions; nothing allocates. */
#ifndef MASU_MODEL_SHEET_H
#define MASU_MODEL_SHEET_H

#include "lab/model/count.h"
#include "lab/model/issued.h"

#define MASU_MODEL_CLASSES 5u
#define MASU_MODEL_BUDGETS 2u
#define MASU_MODEL_NAME 192u

/* Peak of single precision, an addition as one and a fused multiply-add as two; memory
 * bandwidth. */
typedef struct masu_model_class {
    const char *name, *what, *gpu; /* gpu: whose compiler speaks for it (isa/gpu.h) */
    double tflops, gigabytes;
} masu_model_class;

extern const masu_model_class masu_model_classes[MASU_MODEL_CLASSES];
extern const double masu_model_budgets[MASU_MODEL_BUDGETS]; /* ms: of 60 and 30 frames a second */

/* How well a number is known. Of a sum: the worst of its parts. */
typedef enum masu_model_sure {
    MASU_MODEL_EXACT,    /* follows from sizes: every pixel goes the same way */
    MASU_MODEL_MEASURED, /* hangs on the scene: counted while it was drawn here */
    MASU_MODEL_ESTIMATED /* has a constant of ours in it */
} masu_model_sure;

typedef struct masu_model_row {
    bool runs;
    double bytes;           /* compulsory */
    double asked;           /* of storage buffers, by shaders: what caches have to swallow */
    double weighted, plain; /* operations, see spirv_cost.h */
    double invocations;     /* of fragment or compute shaders */
    double issued[MASU_MODEL_CLASSES]; /* instructions of lanes; 0: its compiler was not asked */
    double waits[MASU_MODEL_CLASSES];
    masu_model_sure bytes_sure, weighted_sure;
} masu_model_row;

typedef struct masu_model_rung {
    char name[MASU_MODEL_NAME];
    uint32_t width, height; /* that is rendered */
    double measured;        /* time as a part of the base's, of ladder.json; NAN: not given */
    masu_model_row rows[MASU_PASS_COUNT], sum;
    double floor[MASU_MODEL_CLASSES], realistic[MASU_MODEL_CLASSES]; /* ms */
} masu_model_rung;

typedef struct masu_model_sheet {
    char scene[128], driver[1024];
    VkExtent2D drawn, sheet;
    uint32_t rung_count;
    masu_model_rung rungs[MASU_MAX_RUNGS];
    bool issued[MASU_MODEL_CLASSES]; /* its compiler was asked */
    int chosen[MASU_MODEL_CLASSES][MASU_MODEL_BUDGETS]; /* first rung that fits; -1: none */
} masu_model_sheet;

/* issued: of each class; NULL: none. Names and measured ratios of rungs are left as they are. */
void masu_model_make(const masu_count *count, const masu_issued *issued, masu_model_sheet *out);

/* ms; `by_bytes` may be NULL. */
double masu_model_floor(const masu_model_row *row, uint32_t class_of, bool *by_bytes);
double masu_model_realistic(const masu_model_row *row, uint32_t class_of);

/* All cascades share their pipelines, and one row. */
const char *masu_model_pass_name(uint32_t pass);
const char *masu_model_sure_name(masu_model_sure sure);

#endif

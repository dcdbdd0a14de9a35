/* plan.h: what `masu plan` is given; plan.c prints the compiled frame, plan_model.c the model sheet,
 * plan_isa.c what compilers make of the pipelines. */
#ifndef MASU_CMD_PLAN_H
#define MASU_CMD_PLAN_H

#include "masu/cmd.h"
#include "masu/options.h"

#include "isa/isa.h"

typedef struct masu_plan_options {
    masu_session_desc d;
    const char *ladder; /* as given; NULL: not at all */
    uint32_t rays;
    bool json, model;
    /* Of the model sheet. */
    VkExtent2D drawn;
    double time;
    const char *csv, *fragment;
    const char *isa; /* names of GPUs; NULL: not that */
} masu_plan_options;

/* Exit codes. */
int masu_plan_model(const masu_plan_options *o, char **arguments);
int masu_plan_isa(masu_plan_options *o, char **arguments);

/* Whether this process was started to compile for one GPU. */
bool masu_plan_is_isa_child(void);
/* GPUs of a list "raven,tgl"; 0: one of them is not known, which has been reported. */
enum { MASU_PLAN_GPUS = 16 };
uint32_t masu_plan_gpus(const char *list, const masu_isa_gpu *out[MASU_PLAN_GPUS]);
/* Starts such a process with these arguments. False: it has been reported why there are no rows. */
bool masu_plan_ask(const masu_isa_gpu *gpu, char **arguments, masu_isa_rows *rows);

#endif

/* plan.h: what `masu plan` is given; plan.c prints the compiled frame, plan_model.c the model sheet,
 * plan_isa.c what compilers make of the pipelines. */
#ifndef MASU_CMD_PLAN_H
#define MASU_CMD_PLAN_H

#include "masu/cmd.h"
#include "masu/options.h"

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
int masu_plan_model(const masu_plan_options *o);
int masu_plan_isa(masu_plan_options *o, char **arguments);

#endif

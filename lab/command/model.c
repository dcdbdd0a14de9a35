/* plan_model.c: `masu plan --model`: the command line of model/write.h. */
#include "masu/plan.h"

#include "model/write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The compilers of the classes that --isa names. Returns an exit code. */
static int ask_compilers(const masu_plan_options *o, char **arguments, masu_issued issued[MASU_MODEL_CLASSES]) {
    static masu_isa_rows rows;
    const masu_isa_gpu *gpus[MASU_PLAN_GPUS];
    uint32_t n = masu_plan_gpus(o->isa, gpus);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = 0;
        while (k < MASU_MODEL_CLASSES && strcmp(masu_model_classes[k].gpu, gpus[i]->name)) k++;
        if (k == MASU_MODEL_CLASSES) {
            return masu_cli_usage_error("--model has no class for %s: tgl, kbl, raven, vangogh or a630",
                                        gpus[i]->name);
        }
        if (!masu_plan_ask(gpus[i], arguments, &rows)) return MASU_CLI_FAILURE;
        masu_issued_make(&rows, &issued[k]);
    }
    return n ? MASU_CLI_OK : MASU_CLI_USAGE;
}

int masu_plan_model(const masu_plan_options *o, char **arguments) {
    static masu_issued issued[MASU_MODEL_CLASSES];
    masu_model_desc d = {.scene_path = o->d.scene_path,
                         .ladder_path = o->ladder,
                         .size = o->d.desc.output,
                         .drawn = o->drawn,
                         .time = o->time,
                         .host = o->d.host,
                         .progress = masu_cli_progress_text};
    if (o->ladder && !strcmp(o->ladder, "auto"))
        return masu_cli_usage_error("--model takes the rungs of a file, or off");
    if (o->ladder && !strcmp(o->ladder, "off")) d.ladder_path = NULL;
    if (!d.drawn.width) { /* a quarter of the pixels: a CPU takes its time */
        d.drawn = masu_count_size((VkExtent2D){(d.size.width + 1) / 2, (d.size.height + 1) / 2});
    }
    int code = o->isa ? ask_compilers(o, arguments, issued) : MASU_CLI_OK;
    if (code) return code;
    d.issued = issued;
    masu_model_sheet *m = malloc(sizeof *m);
    uint32_t messages = 0;
    char error[4096];
    if (!m) return masu_cli_error("out of memory");
    bool good = masu_model_run(&d, m, &messages, error, sizeof error);
    masu_cli_progress_clear();
    good = good && (!o->csv || masu_model_save(m, masu_model_csv, o->csv, error, sizeof error));
    good = good &&
           (!o->fragment || masu_model_save(m, masu_model_xhtml, o->fragment, error, sizeof error));
    if (good && !masu_cli_quiet()) (void)masu_model_print(m, stdout);
    free(m);
    if (!good) return masu_cli_error("%s", error);
    if (messages) return masu_cli_error("the validation layer has reported %u messages", messages);
    return MASU_CLI_OK;
}

/* plan_model.c: `masu plan --model`: the command line of model/write.h. */
#include "masu/plan.h"

#include "model/write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int masu_plan_model(const masu_plan_options *o) {
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
    masu_model *m = malloc(sizeof *m);
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

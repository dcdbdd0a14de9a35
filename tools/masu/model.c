/* model.c: `masu model`: the command line of model/write.h. */
#include "masu/cmd.h"

#include "model/write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_SIZE = 1,
    OPTION_DRAWN,
    OPTION_LADDER,
    OPTION_RUNGS,
    OPTION_TIME,
    OPTION_CSV,
    OPTION_FRAGMENT
};

typedef struct options {
    masu_model_desc d;
    const char *csv, *fragment;
    bool own_rungs;
} options;

static int model(const options *o) {
    masu_model *m = malloc(sizeof *m);
    uint32_t messages = 0;
    char error[4096];
    if (!m) return masu_cli_error("out of memory");
    bool good = masu_model_run(&o->d, m, &messages, error, sizeof error);
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

static bool read_option(const masu_cli *cli, int id, options *o) {
    static const char *const rungs[] = {"default", NULL};
    uint32_t which;
    switch (id) {
    case OPTION_SIZE: return masu_output_size(cli, &o->d.size);
    case OPTION_DRAWN: return masu_output_size(cli, &o->d.drawn);
    case OPTION_LADDER: o->d.ladder_path = cli->value; return true;
    case OPTION_RUNGS: o->own_rungs = true; return masu_cli_choice(cli, rungs, &which);
    case OPTION_TIME: return masu_cli_double(cli, -1e9, 1e9, &o->d.time);
    case MASU_CLI_ARGUMENT:
        if (o->d.scene_path) {
            masu_cli_usage_error("one scene at a time: '%s'", cli->value);
            return false;
        }
        o->d.scene_path = cli->value;
        return true;
    default: return false;
    }
}

static int run(masu_cli *cli) {
    options o = {.d = {.size = {1920, 1080},
                       .time = 1.0,
                       .host = {.message = masu_print_message},
                       .progress = masu_cli_progress_text}};
    for (;;) {
        int id = masu_cli_next(cli);
        if (id == MASU_CLI_EXIT) return cli->exit_code;
        if (id == MASU_CLI_END) break;
        if (masu_device_option(cli, id, &o.d.host)) continue;
        if (id == OPTION_CSV || id == OPTION_FRAGMENT) {
            if (!masu_output_file(cli, id == OPTION_CSV ? &o.csv : &o.fragment))
                return cli->exit_code;
            continue;
        }
        if (!read_option(cli, id, &o)) return MASU_CLI_USAGE;
    }
    if (!o.d.scene_path) return masu_cli_usage_error("no scene is given");
    if (o.d.ladder_path && o.own_rungs)
        return masu_cli_usage_error("--ladder and --rungs exclude each other");
    if (!o.d.drawn.width) { /* a quarter of the pixels: a CPU takes its time */
        o.d.drawn = masu_count_size(
            (VkExtent2D){(o.d.size.width + 1) / 2, (o.d.size.height + 1) / 2});
    }
    return model(&o);
}

static const masu_cli_option list[] = {
    {"size", "WxH", "output size of the sheet (default 1920x1080)", OPTION_SIZE, 0},
    {"drawn", "WxH", "size of the frames that are counted (default: half of it)", OPTION_DRAWN, 0},
    {"ladder", "FILE", "rungs of a ladder.json of `masu bench`", OPTION_LADDER, 0},
    {"rungs", "default", "the library's own rungs (the default)", OPTION_RUNGS, 0},
    {"time", "SECONDS", "of the scene and its camera (default 1)", OPTION_TIME, 0},
    {"csv", "FILE", "write every pass of every rung", OPTION_CSV, 0},
    {"html-fragment", "FILE", "write the tables as one <section> of XHTML", OPTION_FRAGMENT, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_model = {
    .name = "model",
    .arguments = "SCENE.masu [options]",
    .summary = "compute each pass's bytes, operations, and least time on five classes of GPU",
    .options = list,
    .details = "Draws each rung with counters in all shaders, and divides what is counted by what "
               "GPUs of\n"
               "five classes can do. All times are computed: no GPU of these classes is needed or "
               "asked.\n",
    .run = run};

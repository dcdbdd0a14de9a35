/* model.c: `masu-lab model`: the command line of lab/model/write.h. */
#include "lab/command/commands.h"
#include "lab/model/ask.h"
#include "lab/model/write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    VkExtent2D size, drawn;
    const char *ladder, *isa, *csv, *fragment;
    double time;
    masu_headless_desc host;
} options;

static const masu_option rows[] = {
    MASU_OUTPUT_SIZE_ROW(options, size),
    MASU_TEXT(options, ladder, "ladder", "FILE|off",
              "the rungs: those of a ladder.json of masu bench; off, 1, 0.8 and 0.4 of the size "
              "(default off)"),
    MASU_SIZE(options, drawn, "drawn",
              "size of the frames that are rendered and counted (default: half of --size)"),
    MASU_REAL(options, time, "time", "SECONDS", -1e9, 1e9, "moment of the scene and its camera"),
    MASU_TEXT(options, isa, "isa", "GPU[,GPU...]",
              "use instruction counts from the compilers of GPUs (masu-lab isa): tgl, kbl, raven,\n"
              "vangogh, a630"),
    MASU_FILE(options, csv, "csv", "FILE", "write every pass of every rung as CSV"),
    MASU_FILE(options, fragment, "html-fragment", "FILE",
              "write the tables as one <section> of XHTML"),
    MASU_DEVICE_ROWS(options, host),
    {.name = NULL}};

static int run_model(const options *o, const char *scene) {
    static masu_issued issued[MASU_MODEL_CLASSES];
    masu_model_desc d = {.scene_path = scene,
                         .ladder_path = o->ladder,
                         .size = o->size,
                         .drawn = o->drawn,
                         .time = o->time,
                         .host = o->host,
                         .issued = issued,
                         .progress = masu_cli_progress_text};
    if (o->ladder && !strcmp(o->ladder, "auto"))
        return masu_cli_usage_error("--ladder takes the rungs of a file, or off");
    if (o->ladder && !strcmp(o->ladder, "off")) d.ladder_path = NULL;
    if (!d.drawn.width) d.drawn = masu_model_drawn(d.size);
    int code = o->isa ? masu_model_ask(o->isa, scene, d.ladder_path, d.size, issued) : MASU_CLI_OK;
    if (code) return code;
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

static int run(masu_cli *cli) {
    options o = {.size = {1920, 1080}, .time = 1.0, .host = {.message = masu_print_message}};
    masu_given given = {.most = 1, .excess = "expected one scene"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (!given.count) return masu_cli_usage_error("no scene given: expected SCENE.masu");
    return run_model(&o, given.arguments[0]);
}

const masu_cli_command lab_model = {
    .name = "model",
    .arguments = "SCENE.masu [options]",
    .summary = "compute each pass's bytes, operations, and least time on five classes of GPU",
    .details = "Renders each rung with counters in all shaders, and divides the counts by the peak "
               "rates of five\n"
               "classes of GPU. All times are computed; no GPU is needed.\n",
    .run = run};

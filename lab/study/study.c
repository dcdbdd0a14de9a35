/* study.c: `masu-lab study`: the table of studies and their common command line; see study.h. */
#include "lab/study/study.h"

#include "lab/command/commands.h"

#include "image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const masu_study *const studies[] = {
    &masu_study_march,   &masu_study_rays,     &masu_study_reflections, &masu_study_image,
    &masu_study_upscale, &masu_study_temporal, &masu_study_baseline,    &masu_study_light,
    &masu_study_rest,    &masu_study_bounce};
enum { STUDIES = sizeof studies / sizeof *studies };

static const masu_study *study_of(const masu_cli_command *command) {
    uint32_t i = 0;
    while (strcmp(studies[i]->name, command->name) != 0) i++;
    return studies[i];
}

static int run_study(masu_cli *cli) {
    const masu_study *study = study_of(cli->command);
    masu_study_options *o = study->given;
    int code;
    o->given.most = study->scenes_max;
    o->given.excess = study->scenes_max == 0   ? "expected no scene"
                      : study->scenes_max == 1 ? "expected one"
                                               : "expected at most 64 scenes";
    if (!masu_options_read(cli, study->options, o, &o->given, &code)) return code;
    if (o->given.count < study->scenes_min)
        return masu_cli_usage_error("no scene given: expected SCENE.masu");
    o->scene = o->given.arguments[0];
    o->stride |= 1; /* an even stride would only compare pixels of one parity */
    o->host.message = masu_print_message;
    bool hidden = o->csv && !strcmp(o->csv, "-");
    o->text = hidden ? fopen("/dev/null", "w") : stdout;
    if (!o->text) return masu_cli_error("/dev/null cannot be written");
    code = study->run();
    masu_cli_progress_clear();
    if (hidden) fclose(o->text);
    return code;
}

/* The studies, as commands of `masu-lab study`. */
static int run(masu_cli *cli) {
    static masu_cli_command commands[STUDIES];
    static const masu_cli_command *list[STUDIES + 1];
    for (uint32_t i = 0; i < STUDIES; i++) {
        commands[i] = (masu_cli_command){.name = studies[i]->name,
                                         .arguments = studies[i]->arguments,
                                         .summary = studies[i]->purpose,
                                         .details = studies[i]->details,
                                         .run = run_study};
        list[i] = &commands[i];
    }
    return masu_cli_commands(cli, lab_study.summary, list);
}

bool masu_study_read_scales(masu_cli *cli, uint32_t most, double *scales, uint32_t *count) {
    const char *at = cli->value;
    for (*count = 0; *count < most; at++) {
        char *end;
        double scale = strtod(at, &end);
        if (end == at || !(scale > 0.0 && scale <= 1.0)) break;
        scales[(*count)++] = scale;
        if (!*end) return true;
        if (*end != ',') break;
        at = end;
    }
    masu_cli_usage_error(
        "%s: expected 1 to %u numbers above 0 and at most 1, for example 1,0.8,0.4; found '%s'",
        cli->option, most, cli->value);
    return false;
}

void masu_study_scene_name(const char *path, char *name, size_t size) {
    const char *last = strrchr(path, '/');
    const char *file = last ? last + 1 : path;
    snprintf(name, size, "%.*s", (int)strcspn(file, "."), file);
}

bool masu_study_save_grey(const char *path, const float *values, VkExtent2D size, char *error,
                          size_t error_size) {
    size_t pixels = (size_t)size.width * size.height;
    uint8_t *rgba = malloc(4 * pixels);
    if (!rgba) {
        snprintf(error, error_size, "%s: out of memory", path);
        return false;
    }
    for (size_t i = 0; i < pixels; i++) {
        memset(rgba + 4 * i, (int)(255.0f * fminf(fmaxf(values[i], 0.0f), 1.0f) + 0.5f), 3);
        rgba[4 * i + 3] = 255;
    }
    bool good = masu_image_save_png(path, rgba, size.width, size.height, 0, error, error_size);
    free(rgba);
    return good;
}

const masu_cli_command lab_study = {
    .name = "study",
    .arguments = "STUDY SCENE.masu [options]",
    .summary = "measure one part of the renderer against alternatives or against ground truth",
    .run = run};

/* study_temporal.c: `masu-lab study temporal`: the command line of lab/study/temporal.h, and its
 * table. */
#include "lab/study/study.h"

#include "measure/picture.h"
#include "lab/study/temporal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct options {
    masu_study_options study;
    uint32_t fast_frames, starts;
    double scales[MASU_PAST_SCALES];
    uint32_t scale_count;
} options;

static options given = {.study = {.size = {640, 360},
                                  .time = 1.0,
                                  .frames = 32,
                                  .truth = {NULL, MASU_PICTURE_POSITIONS, MASU_PICTURE_RAYS}},
                        .fast_frames = 7,
                        .starts = 4,
                        .scales = {1.0, 0.5},
                        .scale_count = 2};
static const masu_study_options *const o = &given.study;

static const masu_column columns[] = {
    {"scene", NULL, NULL, NULL},
    {"width", "%.0f", NULL, NULL},
    {"height", "%.0f", NULL, NULL},
    {"time", "%g", NULL, NULL},
    {"positions", "%.0f", NULL, NULL},
    {"rays", "%.0f", NULL, NULL},
    {"frames", "%.0f", NULL, NULL},
    {"fast_frames", "%.0f", NULL, NULL},
    {"scale", "%g", "scale", "%g"},
    {"way", NULL, "way", NULL},
    {"render_width", "%.0f", NULL, NULL},
    {"render_height", "%.0f", NULL, NULL},
#define MOTION(name)                                                                               \
    {name "_flip", "%.6f", name, "%.4f"}, {name "_ratio", "%.4f", "of without", "%.2f"}
    MOTION("rest"),
    MOTION("slow"),
    MOTION("fast"),
#undef MOTION
    {"rest_flicker", "%.4f", "flicker", "%.2f"},
    {"slow_flicker", "%.4f", "in motion", "%.2f"},
    {"starts", "%.0f", NULL, NULL},
    {"driver", "\"", NULL, NULL},
    {NULL, NULL, NULL, NULL}};

/* The row of that scale without history; NULL: not requested. */
static const masu_past_row *without(const masu_past *w, double scale) {
    for (uint32_t i = 0; i < w->row_count; i++) {
        if (w->rows[i].way == MASU_PAST_NONE && !(fabs(w->rows[i].scale - scale) > 0.0))
            return &w->rows[i];
    }
    return NULL;
}

static void add_row(masu_table *t, const masu_past *w, const char *scene,
                    const masu_past_row *row) {
    const masu_past_row *beside = without(w, row->scale);
    const double asked[] = {o->size.width, o->size.height, o->time,           o->truth.positions,
                            o->truth.rays, o->frames,      given.fast_frames, row->scale};
    masu_table_text(t, scene);
    masu_table_numbers(t, asked, sizeof asked / sizeof *asked);
    masu_table_text(t, masu_past_ways[row->way]);
    masu_table_number(t, row->render_width);
    masu_table_number(t, row->render_height);
    for (int m = 0; m < MASU_PAST_MOTIONS; m++) {
        masu_table_number(t, row->flip[m]);
        masu_table_number(t, beside && beside->flip[m] > 0.0 ? row->flip[m] / beside->flip[m]
                                                             : (double)NAN);
    }
    masu_table_numbers(t, row->flicker, MASU_PAST_FAST);
    masu_table_number(t, given.starts);
    masu_table_text(t, w->driver);
}

static int run(void) {
    static masu_past w;
    char error[4096], scene[128];
    masu_past_desc d = {.scene_path = o->scene,
                        .truth_path = o->truth.path,
                        .image_dir = o->images,
                        .size = o->size,
                        .time = o->time,
                        .positions = o->truth.positions,
                        .rays = o->truth.rays,
                        .frames = o->frames,
                        .fast_frames = given.fast_frames,
                        .starts = given.starts,
                        .scale_count = given.scale_count,
                        .host = o->host,
                        .progress = masu_cli_progress_text};
    if (o->only && !masu_read_names("--only", o->only, masu_past_ways, MASU_PAST_WAYS, &d.only))
        return MASU_CLI_USAGE;
    memcpy(d.scales, given.scales, sizeof d.scales);
    bool good = masu_past_run(&d, &w, error, sizeof error);
    masu_cli_progress_clear();
    if (!good) return masu_cli_error("%s", error);
    masu_table t;
    masu_study_scene_name(o->scene, scene, sizeof scene);
    masu_table_open(&t, columns, "");
    for (uint32_t i = 0; i < w.row_count; i++) add_row(&t, &w, scene, &w.rows[i]);
    fprintf(o->text, "%s at %ux%u, %.4g s, ground truth of %u positions and %u rays; %s\n", scene,
            o->size.width, o->size.height, o->time, o->truth.positions, o->truth.rays, w.driver);
    masu_table_print(&t, o->text);
    int code = masu_table_close(&t, o->csv);
    return w.messages ? masu_cli_error("the validation layer has reported %u messages", w.messages)
                      : code;
}

static bool read_scales(masu_cli *cli, void *options_) {
    options *to = options_;
    return masu_study_read_scales(cli, MASU_PAST_SCALES, to->scales, &to->scale_count);
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_TIME,
    MASU_STUDY_TRUTH,
    MASU_UINT(options, study.frames, "frames", 2, 10000,
              "with still camera and in slow motion, 1/60 s apart, before an image is measured"),
    MASU_UINT(options, fast_frames, "fast-frames", 1, 10000,
              "the same in fast motion, 1/8 s apart"),
    MASU_UINT(options, starts, "starts", 1, 100,
              "figures are means over this many images, each 5 frames longer than the last"),
    MASU_OWN("scales", "S,...", read_scales, "of the render size (default 1,0.5)"),
    MASU_STUDY_ONLY,
    MASU_STUDY_IMAGES("the ground truth and the images as PNG"),
    MASU_STUDY_CSV,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_temporal = {
    .name = "temporal",
    .purpose =
        "error and flicker with and without temporal upscaling, of a still and a moving camera",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details = "Ways: without, a rung that sets nothing but its scale; temporal, the same rung "
               "with temporal=on.\n"
               "The table shows FLIP of the last frame against the ground truth of masu render "
               "--truth. The camera\n"
               "follows the scene's path and ends at the time of the still frame. Flicker is the "
               "mean difference of\n"
               "the last two frames, of 255; in slow motion less that of the two ground truths. "
               "Figures are means of\n"
               "several images whose jitter sequences start at different positions, because a "
               "single image is off\n"
               "by up to 4 %.\n"};

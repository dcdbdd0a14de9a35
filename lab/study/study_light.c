/* study_light.c: `masu-lab study light`: the command line of lab/study/light.h, and its table. */
#include "lab/study/study.h"

#include "lab/study/light.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct options {
    masu_study_options study;
    const char *sdf;
    uint32_t lights, rays;
} options;

static options given = {
    .study = {.size = {640, 360}, .time = 0.0, .frames = 64}, .lights = 12, .rays = 16};
static const masu_study_options *const o = &given.study;

static const masu_column columns[] = {{"scene", NULL, NULL, NULL},
                                      {"width", "%.0f", NULL, NULL},
                                      {"height", "%.0f", NULL, NULL},
                                      {"light", NULL, "light", NULL},
                                      {"lit", "%.0f", "lit pixels", "%.0f"},
                                      {"compared", "%.0f", "outside penumbrae", "%.0f"},
                                      {"bright", "%.6f", "too bright, %", "%.2f"},
                                      {"dark", "%.6f", "too dark, %", "%.2f"},
                                      {"leak", "%.4f", "leak, texels", "%.1f"},
                                      {"driver", "\"", NULL, NULL},
                                      {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, const char *scene, const char *name, const masu_seen_row *row,
                    const char *driver) {
    const double size[] = {o->size.width, o->size.height};
    const double all = row->compared ? (double)row->compared : (double)NAN;
    const double values[] = {(double)row->lit, (double)row->compared,
                             100 * (double)row->bright / all, 100 * (double)row->dark / all,
                             row->leak};
    masu_table_text(t, scene);
    masu_table_numbers(t, size, 2);
    masu_table_text(t, name);
    masu_table_numbers(t, values, 5);
    masu_table_text(t, driver);
}

static int run(void) {
    static masu_seen found;
    char error[4096], scene[128], name[64];
    masu_seen_row all = {0};
    masu_seen_desc d = {.scene_path = o->scene,
                        .field_path = given.sdf,
                        .size = o->size,
                        .time = o->time,
                        .lights = given.lights,
                        .rays = given.rays,
                        .frames = o->frames,
                        .image_dir = o->images,
                        .host = o->host,
                        .progress = masu_cli_progress_text};
    bool good = masu_seen_run(&d, &found, error, sizeof error);
    masu_cli_progress_clear();
    if (!good) return masu_cli_error("%s", error);
    masu_table t;
    masu_study_scene_name(o->scene, scene, sizeof scene);
    masu_table_open(&t, columns, "");
    for (uint32_t i = 0; i < found.row_count; i++) {
        const masu_seen_row *row = &found.rows[i];
        snprintf(name, sizeof name, "%u, %s", row->light, row->spot ? "spot" : "point");
        add_row(&t, scene, name, row, found.driver);
        all.lit += row->lit;
        all.compared += row->compared;
        all.bright += row->bright;
        all.dark += row->dark;
        all.leak = fmax(all.leak, row->leak);
    }
    add_row(&t, scene, "all", &all, found.driver);
    fprintf(o->text, "%s at %ux%u, %.4g s; %s\n", scene, o->size.width, o->size.height, o->time,
            found.driver);
    masu_table_print(&t, o->text);
    int code = masu_table_close(&t, o->csv);
    return found.messages
               ? masu_cli_error("the validation layer has reported %u messages", found.messages)
               : code;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_TIME,
    MASU_TEXT(options, sdf, "sdf", "FILE", "source of the scene's signed distance field"),
    MASU_UINT(options, lights, "lights", 1, MASU_SEEN_LIGHTS,
              "lights to measure, those that add most to the image"),
    MASU_UINT(options, rays, "points", 1, 4096, "points of a source"),
    MASU_STUDY_FRAMES(10000, "frames of one light until its shadow is complete"),
    MASU_STUDY_IMAGES(
        "an image of each light as PNG: red is too bright, blue too dark, dark grey not compared"),
    MASU_STUDY_CSV,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_light = {
    .name = "light",
    .purpose = "visibility of point and spot lights, compared with rays to their source",
    .arguments = "SCENE.masu [--sdf FILE] [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details = "Each light is drawn alone, with and without shadows. Pixels that it would light by "
               "over 1/255 of white\n"
               "are compared with rays from their centre to points of the source, where all of "
               "these agree. Pixels\n"
               "behind transparent surfaces, capsules and rectangles are not compared. Too "
               "bright\n"
               "and too dark: by over 0.1 of the light. Leak: 99th percentile of the distance "
               "of pixels that should\n"
               "be dark from those that may be lit, in texels of a shadow map of 512.\n"};

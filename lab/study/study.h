/* study.h: `masu-lab study NAME`: each study answers one question about the renderer by measuring.
 * A study is a masu_study (name, purpose, options, function) in a file study_NAME.c. This header
 * has the parts that studies share: options, command line, tables. A study only reports, except
 * that some check for identical images. */
#ifndef LAB_STUDY_H
#define LAB_STUDY_H

#include "command/options.h"
#include "command/output.h"
#include "lab/study/table.h"

/* The options of all studies; each study uses some. A study with more options makes a struct that
 * begins with this one. The values before the command line is read are the defaults. */
typedef struct masu_study_options {
    masu_given given;
    const char *scene; /* the first argument, or NULL */
    VkExtent2D size;
    uint32_t runs, frames, stride;
    double time;
    const char *csv, *images, *only;
    const char *field; /* the SDF in double precision, a shared library */
    masu_truth_options truth;
    bool json;
    masu_headless_desc host;
    FILE *text; /* for tables: stdout, or nothing if the CSV goes there */
} masu_study_options;

typedef struct masu_study {
    const char *name, *purpose;
    const char *arguments; /* of the usage line */
    uint32_t scenes_min, scenes_max;
    const masu_option *options;
    masu_study_options *given;
    int (*run)(void); /* returns an exit code; the options are static in the study's file */
    const char *details;
} masu_study;

/* Rows that studies share. */
#define MASU_STUDY_SIZE MASU_SIZE(masu_study_options, size, "size", "size in pixels")
#define MASU_STUDY_CSV                                                                             \
    MASU_OUTPUT(masu_study_options, csv, "csv", "FILE",                                            \
                "the rows as CSV, with more columns; - for stdout, and no table")
#define MASU_STUDY_RUNS(min, max)                                                                  \
    MASU_UINT(masu_study_options, runs, "runs", min, max,                                          \
              min ? "times that each is measured; the least counts"                                \
                  : "times that each is measured; the least counts; 0: not at all")
#define MASU_STUDY_FRAMES(max, help) MASU_UINT(masu_study_options, frames, "frames", 1, max, help)
#define MASU_STUDY_STRIDE                                                                          \
    MASU_UINT(masu_study_options, stride, "stride", 1, 1023,                                       \
              "compare every N-th pixel of every N-th row; an even N is raised by one")
#define MASU_STUDY_TIME MASU_MOMENT_ROW(masu_study_options, time)
#define MASU_STUDY_IMAGES(help) MASU_TEXT(masu_study_options, images, "images", "DIR", help)
#define MASU_STUDY_ONLY MASU_TEXT(masu_study_options, only, "only", "NAME,...", "only these rows")
#define MASU_STUDY_FIELD                                                                           \
    MASU_TEXT(masu_study_options, field, "truth", "FILE.so",                                       \
              "the SDF in double precision (default: SCENE.truth.so, if it is there)")
#define MASU_STUDY_TRUTH MASU_TRUTH_ROWS(masu_study_options, truth)
#define MASU_STUDY_JSON MASU_FLAG(masu_study_options, json, "json", "print JSON")
#define MASU_STUDY_DEVICE MASU_DEVICE_ROWS(masu_study_options, host)
#define MASU_STUDY_END                                                                             \
    { .name = NULL }

extern const masu_study masu_study_march, masu_study_rays, masu_study_reflections, masu_study_image,
    masu_study_upscale, masu_study_temporal, masu_study_baseline, masu_study_light, masu_study_rest,
    masu_study_bounce;

/* The name of the scene's file, without its folder and everything after its first dot. */
void masu_study_scene_name(const char *path, char *name, size_t size);

/* Reads an option like "1,0.8,0.4", at most `most` scales; on false a mistake has been reported. */
bool masu_study_read_scales(masu_cli *cli, uint32_t most, double *scales, uint32_t *count);

/* Writes a grey PNG: one value per pixel, clamped to 0..1. */
bool masu_study_save_grey(const char *path, const float *values, VkExtent2D size, char *error,
                          size_t error_size);

#endif

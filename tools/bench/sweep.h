/* sweep.h: the measurements of `masu bench`: for every setting of a scene the error of its image
 * against the ground truth, and its time relative to the base setting.
 *
 * Times. A renderer has twelve rungs: the base setting and eleven others. Its rungs are rendered
 * alternately, and the first round is dropped. Each time is divided by the base's time in the same
 * renderer, so that other load of the machine affects both. A sample is one frame of a static
 * scene, waited for, with a full barrier around each pass; if a cascade of the shadow map is
 * rendered only every n-th frame, it is the mean of n frames. If frames depend on previous ones,
 * untimed frames precede each sample. Both clocks are stored: wall time from masu_frame to the
 * fence, and device timestamps. Timestamps outside of 0.5 to 1.05 of the wall time are implausible
 * (lavapipe of Mesa 22.3 has such).
 *
 * Images. If a setting depends on previous frames, its image is the last of a number of frames
 * along the camera path that end at the time of the ground truth, because late shadows and trails
 * of reflections are errors too. Each setting then has a separate renderer, since the noise of
 * reflections depends on the frame number. Flicker is the difference of successive frames of a
 * static scene.
 *
 * Rungs are the settings with the best error for their time, and noise favours settings whose time
 * was measured too low. So rungs are timed again, for longer (masu_sweep_steady), and their rows
 * get these times.
 *
 * Depth and radiance come from separate sessions that read them back: depth.h, radiance.h.
 *
 * Files of the folder. Each is written completely or not at all, except the last row.
 *   sweep.json    the measured settings and the method; a run is only resumed if it is equal
 *   machine.json  machine and date, see machine.h
 *   results.csv   a row for each finished setting
 *   steady.csv    rows of rungs with the times of the second measurement
 *   pictures/     SETTING.png; SETTING.rest.png if the static image differs
 *   truth.png     ground truth; radiance in truth.pfm, reflections in truth.specular.pfm */
#ifndef MASU_BENCH_SWEEP_H
#define MASU_BENCH_SWEEP_H

#include "measure/samples.h"
#include "bench/settings.h"
#include "bench/table.h"
#include "session.h"

#define MASU_SWEEP_RESULTS "results.csv"
#define MASU_SWEEP_STEADY "steady.csv"
#define MASU_SWEEP_REST ".rest"

/* Names of settings, as the rungs of a ladder. */
typedef struct masu_setting_list {
    char id[MASU_MAX_RUNGS][MASU_SETTING_ID];
    uint32_t count;
} masu_setting_list;

typedef struct masu_sweep_desc {
    const char *scene_path, *folder;
    /* NULL: truth.png in the folder. Read if it exists, else written, as are its .pfm files. */
    const char *truth_path;
    VkExtent2D size;
    double time;
    uint32_t positions, rays; /* of the ground truth */
    uint32_t frames;          /* along the path; the last is the image */
    uint32_t runs;            /* timed samples of each setting, at least 1 */
    double steady;            /* seconds for eleven rungs in masu_sweep_steady */
    uint32_t shard, shards;   /* settings shard, shard + shards, ... */
    const masu_setting_list *only; /* NULL or empty: all settings; else these and the base */
    const char *like;              /* NULL, or a folder whose sweep must equal this one */
    bool quick;
    masu_headless_desc host;
    void (*progress)(const char *text); /* or NULL */
} masu_sweep_desc;

#define MASU_SWEEP_RUNS_MAX MASU_SAMPLES_MAX

typedef struct masu_sweep_result {
    uint32_t settings, dropped; /* settings: to measure, in all shards */
    uint32_t measured, there;   /* in this run, and before */
    uint32_t messages;          /* of the validation layer */
} masu_sweep_result;

/* False: `error` holds one line. Finished measurements remain in the folder. */
bool masu_sweep_run(const masu_sweep_desc *desc, masu_sweep_result *out, char *error,
                    size_t error_size);

/* Times the settings of the list again that have a row, but no times of this kind: in groups of
 * eleven with the base, for the longer of desc->steady seconds and desc->runs rounds, at most
 * MASU_SWEEP_RUNS_MAX rounds. out->measured: their number. */
bool masu_sweep_steady(const masu_sweep_desc *desc, const masu_setting_list *list,
                       masu_sweep_result *out, char *error, size_t error_size);

/* Joins the rows and images of folders that hold parts of the same sweep. */
bool masu_sweep_merge(const char *folder, const char *const *parts, uint32_t part_count,
                      char *error, size_t error_size);

/* The rows of a folder, with steady times if they exist. NULL: `error` holds the reason; a folder
 * without rows is no error. Release the result by free(). */
masu_row *masu_sweep_rows(const char *folder, uint32_t *count, char *error, size_t error_size);

/* Only the rows of steady.csv. */
masu_row *masu_sweep_steady_rows(const char *folder, uint32_t *count, char *error,
                                 size_t error_size);

/* FOLDER/NAME, or FOLDER/pictures/NAME. False: too long, or not the name of a setting. */
bool masu_sweep_path(const char *folder, const char *name, char out[4096]);
bool masu_sweep_picture(const char *folder, const char *setting, const char *suffix,
                        char out[4096]);

#endif

/* sweep.h: `masu bench`'s measuring: every setting of one scene, its picture beside the truth
 * and its time beside the base setting's.
 *
 * HOW. Settings are measured by elevens: a renderer has twelve rungs, of which the first is always
 * the base setting. All of its rungs take turns, the first round is dropped, and a setting's time
 * is given beside the base's of the same renderer: what the machine does meanwhile hits both. A
 * sample is a frame of the scene at rest, waited for, with a full barrier around each pass; where
 * a cascade of the shadow map is drawn in each n-th frame only it is the mean of n frames. Where
 * frames depend on those before, each turn begins with frames that are not timed. Both clocks are
 * kept: the wall's from masu_frame to the fence, and the device's timestamps; a sample whose
 * timestamps are not 0.5 to 1.05 of the wall is not plausible (Mesa 22.3's lavapipe gets them
 * wrong).
 *
 * The picture is that of a scene in motion, which has followed its camera's path for so many frames
 * up to the time of the truth, where anything depends on previous frames: old shadows and trails of
 * reflections are errors too. There each setting has a renderer of its own, since the noise of
 * reflections goes by the number of the frame. Flicker is what then changes from frame to frame of
 * the scene at rest.
 *
 * The rungs of the ladder are the settings that look best for their time, and of a hundred noisy times the
 * luckiest look best. So they are timed again, longer (masu_sweep_steady), and it is those times that
 * their rows then have.
 *
 * What a picture does not show (surfaces, radiance, reflections) comes from sessions of their own
 * that read it back: depth.h, radiance.h.
 *
 * THE FOLDER. sweep.json: what is measured, and how; a run is only resumed if it is the same.
 * machine.json: on what and when, see machine.h.
 * results.csv: a row as soon as it is known. steady.csv: rows of rungs, with the times measured
 * again. pictures/SETTING.png, and SETTING.rest.png if it is another at rest. truth.png; its
 * radiance in truth.pfm, the reference of reflections in truth.specular.pfm. All is written whole
 * or not at all, but for the last row. */
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
    /* NULL: truth.png in the folder. Read if it is there, else written; so are the .pfm beside it. */
    const char *truth_path;
    VkExtent2D size;
    double time;
    uint32_t positions, rays; /* of the truth */
    uint32_t frames;          /* in motion before a picture is taken */
    uint32_t runs;            /* timed ones of each setting, at least 1 */
    double steady;            /* seconds that eleven rungs are timed again, see masu_sweep_steady */
    uint32_t shard, shards;   /* settings shard, shard + shards, ... */
    const masu_setting_list *only; /* NULL or empty: all settings; else these and the base */
    const char *like;              /* NULL, or a folder whose sweep must be one with this */
    bool quick;
    masu_headless_desc host;
    void (*progress)(const char *text); /* or NULL */
} masu_sweep_desc;

#define MASU_SWEEP_RUNS_MAX MASU_SAMPLES_MAX

typedef struct masu_sweep_result {
    uint32_t settings, dropped; /* settings: to be measured, in all shards */
    uint32_t measured, there;   /* now, and already in the folder */
    uint32_t messages;          /* of the validation layer */
} masu_sweep_result;

/* False: `error` holds one line. What has been measured until then stays in the folder. */
bool masu_sweep_run(const masu_sweep_desc *desc, masu_sweep_result *out, char *error,
                    size_t error_size);

/* Times those settings again that have a row, but no times of this kind yet: by elevens, with the
 * base, for desc->steady seconds or desc->runs rounds, whichever is more, but not more than
 * MASU_SWEEP_RUNS_MAX rounds. out->measured: how many. */
bool masu_sweep_steady(const masu_sweep_desc *desc, const masu_setting_list *list,
                       masu_sweep_result *out, char *error, size_t error_size);

/* The rows and pictures of folders that hold parts of the same sweep, into one. */
bool masu_sweep_merge(const char *folder, const char *const *parts, uint32_t part_count,
                      char *error, size_t error_size);

/* The rows of a folder, with the steady times of those that have them. NULL: `error` says why; a folder
 * without rows has none and is no error.
 * Freed by free(). */
masu_row *masu_sweep_rows(const char *folder, uint32_t *count, char *error, size_t error_size);

/* Those of steady.csv alone. */
masu_row *masu_sweep_steady_rows(const char *folder, uint32_t *count, char *error,
                                 size_t error_size);

/* FOLDER/NAME, or FOLDER/pictures/NAME. False: too long, or the setting is no name. */
bool masu_sweep_path(const char *folder, const char *name, char out[4096]);
bool masu_sweep_picture(const char *folder, const char *setting, const char *suffix,
                        char out[4096]);

#endif

/* marches.h: draws and measures the marches of an SDF on one scene.
 *
 * A run opens a session without a renderer and makes its own renderers: for each variant one that
 * counts and reads images back, then one that is timed, all of the latter at once. A march that the
 * blob does not have is skipped (MASU_ERROR_SCENE); any other failure ends the run. */
#ifndef LAB_MARCHES_H
#define LAB_MARCHES_H

#include "measure/truth.h"
#include "metric/flip.h"
#include "metric/march.h"
#include "session.h"

enum {
    MASU_BENCH_PLAIN,
    MASU_BENCH_SEED,
    MASU_BENCH_MASU,
    MASU_BENCH_CHECKERBOARD,
    MASU_BENCH_VARIANTS
};

/* "plain", "seed", "masu", "checkerboard" */
extern const char *const masu_bench_names[MASU_BENCH_VARIANTS];

typedef struct masu_bench_desc {
    const char *scene_path;
    const char *truth_path; /* NULL: next to the scene, if there is one */
    const char *image_dir;  /* NULL: none; else SCENE.VARIANT.png and SCENE.truth.png are saved
                             * there */
    uint32_t width, height, stride;
    uint32_t runs;  /* timed frames of each variant; 0: counts and errors only */
    uint32_t only;  /* bits 1 << MASU_BENCH_...: the variants to draw; 0: all */
    double time;
    masu_headless_desc host;
} masu_bench_desc;

typedef struct masu_bench_row {
    bool there;
    uint64_t evals, hits, unconverged;
    double wall_ms;     /* least of a whole frame, with timestamps, from submit to fence */
    double gpu_ms;      /* least sum of the SDF passes by timestamps; 0: none */
    double ms;          /* of the SDF passes, see masu_bench.by_timestamps; NAN: lost in the rest */
    double spread;      /* median / least of the wall times: how busy the machine was */
    uint32_t plausible; /* frames whose timestamps fit the wall clock */
    masu_march_errors errors; /* from here only with a ground truth */
    /* The frame's G-buffer compared with the ground truth, both shaded by measure/shade.h. */
    double rmse, ssim;
    masu_flip flip;
    masu_flip shown; /* of the GPU's image: includes the driver's rounding */
} masu_bench_row;

typedef struct masu_bench {
    char scene[128];   /* the file's name without folder and .masu */
    char driver[1024]; /* of the device */
    masu_bench_row rows[MASU_BENCH_VARIANTS];
    double rest_wall_ms; /* least time of a frame whose march takes one step */
    bool by_timestamps;  /* ms is gpu_ms; else wall_ms - rest_wall_ms */
    bool compared;       /* there is a ground truth */
    uint64_t truth_samples, truth_unsure;
    double truth_seconds, truth_evals; /* evaluations per ray */
} masu_bench;

/* `progress` may be NULL. On false `error` holds one line. */
bool masu_bench_run(const masu_bench_desc *desc, masu_bench *out,
                    void (*progress)(const char *text), char *error, size_t error_size);

#endif

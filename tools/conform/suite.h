/* suite.h: the input of `masu conform`: suites of cases in JSON (docs/conform.md), and the limits
 * that determine verdicts.
 *
 * The parser needs no device, prints nothing and opens no files, so that it can be tested on its
 * own. A suite owns the parsed JSON that its names point into, and its array of cases. */
#ifndef MASU_CONFORM_SUITE_H
#define MASU_CONFORM_SUITE_H

#include "conform/extreme.h"
#include "masu.h"

#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* From best to worst: the worst finding is the case's verdict. */
typedef enum masu_verdict {
    MASU_VERDICT_PASS = 0,
    MASU_VERDICT_WARNING = 1,     /* between a warn and a fail limit */
    MASU_VERDICT_UNSUPPORTED = 2, /* a feature or the size is unsupported: not judged */
    MASU_VERDICT_RESOURCE = 3,    /* a memory budget is too small, or allocation failed */
    MASU_VERDICT_FAIL = 4,
    MASU_VERDICT_NOT_RUN = 5, /* the run ended before or during this case */
    MASU_VERDICT_COUNT = 6
} masu_verdict;

const char *masu_verdict_name(masu_verdict verdict); /* "pass", "resource error" */
bool masu_verdict_failed(masu_verdict verdict);      /* exit code 1 */

/* ---- Measures -------------------------------------------------------------------------------- */

/* Name in the suite, its group, whether more is better. Measures of `counts` are also allowed in
 * `at_least`. */
#define MASU_MEASURES(X)                                                                           \
    X(HOST_BYTES, host_bytes, "budget", 0)                                                         \
    X(DEVICE_BYTES, device_bytes, "budget", 0)                                                     \
    X(ALLOCATIONS, allocations, "budget", 0) /* of the library's thread, in all frames */          \
    X(MESSAGES, messages, "budget", 0)       /* of the validation layer */                         \
    X(MS_RATIO, ms_ratio, "budget", 0)       /* fastest frame / fastest calibration */             \
    X(SDF_EVALS, sdf_evals, "counts", 0)                                                           \
    X(SDF_HITS, sdf_hits, "counts", 0)                                                             \
    X(SDF_UNCONVERGED, sdf_unconverged, "counts", 0)                                               \
    X(SHADOW_EVALS, shadow_evals, "counts", 0)                                                     \
    X(OCCLUSION_EVALS, occlusion_evals, "counts", 0)                                               \
    X(SHADOW_UNCONVERGED, shadow_unconverged, "counts", 0)                                         \
    X(REPLACED, replaced, "counts", 0)                                                             \
    X(DRAWS, draws, "counts", 0)                                                                   \
    X(TRIANGLES, triangles, "counts", 0)                                                           \
    X(TRANSPARENTS, transparents, "counts", 0)                                                     \
    X(OCCLUSION_TESTS, occlusion_tests, "counts", 0)                                               \
    X(LIGHT_TESTS, light_tests, "counts", 0)                                                       \
    X(LIGHT_SHADED, light_shaded, "counts", 0)                                                     \
    X(SPECULAR_TILES, specular_tiles, "counts", 0)                                                 \
    X(SPECULAR_RAYS, specular_rays, "counts", 0)                                                   \
    X(SPECULAR_HITS, specular_hits, "counts", 0)                                                   \
    X(SPECULAR_SDF_HITS, specular_sdf_hits, "counts", 0)                                           \
    X(SPECULAR_NODES, specular_nodes, "counts", 0)                                                 \
    X(SPECULAR_EVALS, specular_evals, "counts", 0)                                                 \
    X(SMAA_TILES, smaa_tiles, "counts", 0)                                                         \
    X(NON_FINITE, non_finite, "counts", 0) /* in depth, radiance, velocity, of all frames */       \
    X(RMSE, rmse, "error", 0) /* steps of 8 bits */                                                \
    X(PSNR, psnr, "error", 1)                                                                      \
    X(SSIM, ssim, "error", 1)                                                                      \
    X(FLIP, flip, "error", 0)                                                                      \
    X(FLIP_P99, flip_p99, "error", 0)                                                              \
    X(STEPS, steps, "error", 0)   /* largest difference of a channel */                            \
    X(PIXELS, pixels, "error", 0) /* pixels that differ */                                         \
    /* The next three need a reference. MEAN_OFF: |ratio of the means - 1| */                      \
    X(MEAN_OFF, mean_off, "error", 0)                                                              \
    X(PATCH_P95, patch_p95, "error", 0) /* measure/patches.h */                                    \
    X(PATCH_Z2, patch_z2, "error", 0)                                                              \
    X(HITMISS_PCT, hitmiss_pct, "field", 0) /* the march against its field: docs/conform.md */      \
    X(LOST_PCT, lost_pct, "field", 0)                                                              \
    X(DEPTH_P50, depth_p50, "field", 0)                                                            \
    X(DEPTH_P99, depth_p99, "field", 0)                                                            \
    X(CHANGES, changes, "governed", 0)

typedef enum masu_measure {
#define MASU_MEASURE_ENUM(name, key, group, more) MASU_MEASURE_##name,
    MASU_MEASURES(MASU_MEASURE_ENUM)
#undef MASU_MEASURE_ENUM
        MASU_MEASURE_COUNT
} masu_measure;

const char *masu_measure_name(masu_measure measure);
bool masu_measure_counted(masu_measure measure); /* is in the group `counts` */
bool masu_measure_more(masu_measure measure);    /* more is better: its limits are lower limits */

/* Not measured, or no limit. A double, because NAN is a float. */
#define MASU_UNKNOWN ((double)NAN)

/* A limit, inclusive. MASU_UNKNOWN: no limit. */
typedef struct masu_bound {
    double warn, fail;
} masu_bound;

/* The worse verdict of the two limits. NaN exceeds every limit: a value that could not be measured
 * does not pass. `least`: it is a lower limit. */
masu_verdict masu_bound_judge(const masu_bound *bound, double value, bool least);
bool masu_bound_is_set(const masu_bound *bound);

/* ---- Cases ----------------------------------------------------------------------------------- */

/* Variants that must render a bit-identical image. */
typedef enum masu_same {
    MASU_SAME_AGAIN = 1,      /* another renderer, the same frames */
    MASU_SAME_POISON = 2,     /* transient images are filled with NaN before each frame */
    MASU_SAME_INFINITIES = 4, /* or of infinities */
    MASU_SAME_SPLIT = 8,      /* memory in one block per role */
    MASU_SAME_UNCULLED = 16,  /* without culling */
    MASU_SAME_FLIGHT = 32     /* 1 and 3 frames in flight */
} masu_same;
#define MASU_SAME_NAMES                                                                            \
    { "again", "poison", "infinities", "split-memory", "unculled", "frames-in-flight", NULL }

/* Device features that a case requires. */
#define MASU_NEEDS_NAMES                                                                           \
    { "ray-query", "compressed-textures", "float16", "anisotropy", NULL }
enum { MASU_NEEDS_RAY_QUERY = 1, MASU_NEEDS_BC = 2, MASU_NEEDS_FLOAT16 = 4, MASU_NEEDS_ANISO = 8 };

typedef struct masu_governed {
    bool on;
    double target_ms;
    uint32_t frames;
    uint32_t best, worst;     /* allowed rungs; worst 0: up to the end of a measured ladder */
    bool told;                /* the governor receives simulated times, not the clock's: */
    /* fixed + load * cost of the rung: its measured ratio on a measured ladder, otherwise
     * scale^2 */
    double fixed_ms, load_ms;
    int32_t settles[2];       /* range of the last rung; -1: any */
} masu_governed;

typedef struct masu_case {
    const char *name, *scene;
    uint32_t width, height;
    double time, move; /* of the first frame, and the increment per frame, s */
    uint32_t frames;
    uint32_t rung_count; /* of the ladder; 1 without `governed`; 0: */
    bool measured;       /* uses the ladder measured for the scene's class */
    masu_rung rungs[MASU_MAX_RUNGS];
    masu_governed governed;
    bool validate;
    bool exact_memory; /* the exact requirement is accepted, and one byte less is rejected */
    uint32_t same;     /* masu_same */
    uint32_t needs;
    uint32_t flight;
    masu_bound bounds[MASU_MEASURE_COUNT], least[MASU_MEASURE_COUNT];
    const char *against;      /* "truth", "reference", or the name of a case */
    const char *golden;       /* file of "reference", from the suite's folder; NULL: none */
    int32_t other;            /* index of that case; -1: none */
    uint32_t positions, rays; /* of the ground truth */
    masu_extreme extreme;
} masu_case;

/* Whether the golden file is linear light, which is compared by patches; otherwise it is a PNG. */
bool masu_case_linear(const masu_case *c);

/* Whether the case has a limit of the group `field`. */
bool masu_case_field(const masu_case *c);

typedef struct masu_suite {
    const char *file; /* as given; owned by the caller */
    uint32_t hash;    /* of the file's bytes */
    json_t *root;
    masu_case *cases;
    uint32_t count;
} masu_suite;

/* On false `error` holds one line: file, case, key, the expected and the given value. */
bool masu_suite_parse(const char *file, const char *text, size_t bytes, masu_suite *suite,
                      char *error, size_t error_size);
void masu_suite_free(masu_suite *suite);

/* ---- Selection ------------------------------------------------------------------------------- */

/* Identifies one case of a suite at one size: "1f00ba42:rungs.city:96x64". */
bool masu_replay_token(const masu_suite *suite, const masu_case *c, char *out, size_t size);

/* Index of the case of a token, or -1 with one line in `error`. */
int32_t masu_replay_find(const masu_suite *suite, const char *token, char *error,
                         size_t error_size);

/* Selects the cases whose names match `glob` (NULL: all), and of these each `of`-th from `first`
 * on, so that the parts 0 .. of-1 divide the suite. Fills marks[count]; returns the number of
 * marks. */
uint32_t masu_suite_select(const masu_suite *suite, const char *glob, uint32_t first, uint32_t of,
                           bool *marks);

#endif

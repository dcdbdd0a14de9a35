/* extreme.h: extreme inputs of a test case: camera, light, time step, cuts, a second camera for odd
 * frames, alternating rungs, an unusual transform or material. Also measures the results: counts of
 * non-finite values, and the error of the SDF march.
 *
 * Cases are parsed once and hold all inputs; a masu_view belongs to one run of a case. */
#ifndef MASU_CONFORM_EXTREME_H
#define MASU_CONFORM_EXTREME_H

#include "measure/truth.h"
#include "session.h"

#include <jansson.h>

struct masu_suite_place;
struct masu_case;

typedef struct masu_extreme {
    const char *input;            /* description for the table; owned by the JSON */
    bool given;                   /* any of the following */
    bool has_camera, has_other, has_light, has_step, has_transform, has_material, has_emissive;
    bool cut;                     /* every frame is a cut */
    bool cycle;                   /* frame i uses rung i % rung_count */
    masu_camera camera, other;    /* other: for odd frames */
    masu_light light;
    float step;                   /* s; default 1/60 */
    uint32_t settle;              /* number of last frames without cuts, with the first camera and
                                   * rung 0 */
    uint32_t instance;
    float transform[12];
    uint32_t material;
    double roughness[2];          /* of frame 0, and the increment per frame */
    double emissive;
} masu_extreme;

/* Parses the object `extreme`. On false the error of `at` is written. */
bool masu_extreme_read(const struct masu_suite_place *at, const json_t *value, masu_extreme *out);

/* Requests the features that the case needs. */
void masu_extreme_describe(const struct masu_case *of, masu_desc *desc);

/* Changes the frame and the scene for frame `number`. On false `error` holds one line. */
bool masu_extreme_frame(masu_session *s, const struct masu_case *of, uint32_t number,
                        masu_frame_desc *frame, char *error, size_t error_size);

/* Counts non-finite values of an image of four halves per texel, or depths outside 0..1. */
double masu_extreme_count(const masu_readback_image *image, bool depth);

/* Counts the non-finite values of a frame and depths outside 0..1: in depth, radiance and
 * velocity. */
bool masu_extreme_non_finite(const masu_session *s, uint32_t slot, double *count, char *error,
                             size_t error_size);

/* ---- The march against the SDF in double precision ------------------------------------------- */

typedef struct masu_field_figures {
    double hitmiss_pct, lost_pct; /* of pixels: hit and miss disagree; hits that the image lacks */
    double depth_p50, depth_p99;  /* |t - truth| / truth, if both hit */
} masu_field_figures;

/* Call it between masu_session_open (no_renderer) and masu_session_start, while the blob exists. */
bool masu_field_look(const masu_session *s, const struct masu_case *of, masu_view *view,
                     char *error, size_t error_size);

/* Compares the frame's depth with the ground-truth library of the scene. */
bool masu_field_compare(const masu_session *s, uint32_t slot, const char *scene_path,
                        const masu_view *view, masu_field_figures *out, char *error,
                        size_t error_size);

#endif

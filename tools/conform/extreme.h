/* extreme.h: what a case of a suite may ask beyond a picture of its scene: a view, a light, a time step, cuts, a
 * second view that odd frames jump to, a rung after the other, a transform or a material without measure. And
 * what such frames leave: numbers that are not finite, a march that is not at its surface.
 *
 * Cases are read once and hold it all; a masu_field_view belongs to one run of a case. */
#ifndef MASU_CONFORM_EXTREME_H
#define MASU_CONFORM_EXTREME_H

#include "measure/truth.h"
#include "session.h"

#include <jansson.h>

struct masu_suite_place;
struct masu_case;

typedef struct masu_extreme {
    const char *input;            /* for readers of the table: what is extreme; the JSON's */
    bool given;                   /* any of what follows */
    bool has_camera, has_other, has_light, has_step, has_transform, has_material, has_emissive;
    bool cut;                     /* each frame is one */
    bool cycle;                   /* frame i is of rung i % rung_count */
    masu_camera camera, other;    /* other: of odd frames */
    masu_light light;
    float step;                   /* s; else 1/60 */
    uint32_t settle;              /* the last frames: neither cut, nor other view, nor another rung than 0 */
    uint32_t instance;
    float transform[12];
    uint32_t material;
    double roughness[2];          /* of frame 0, and how much each adds */
    double emissive;
} masu_extreme;

/* The object `extreme`. False: the place's error is written. */
bool masu_extreme_read(const struct masu_suite_place *at, const json_t *value, masu_extreme *out);

/* What has to be planned for it. */
void masu_extreme_describe(const struct masu_case *of, masu_desc *desc);

/* Changes the frame and the scene for frame `number`. False: `error` has a line. */
bool masu_extreme_frame(masu_session *s, const struct masu_case *of, uint32_t number,
                        masu_frame_desc *frame, char *error, size_t error_size);

/* Values of an image that are not finite, of four halves a texel, or depths that are none. */
double masu_extreme_count(const masu_readback_image *image, bool depth);

/* Values of a frame that are not finite, or depths outside of 0..1: in depth, radiance and velocity. */
bool masu_extreme_non_finite(const masu_session *s, uint32_t slot, double *count, char *error,
                             size_t error_size);

/* ---- The march against its field in double precision ------------------------------------------ */

typedef struct masu_field_figures {
    double hitmiss_pct, lost_pct; /* of pixels: one hits and the other does not; of which the picture has nothing */
    double depth_p50, depth_p99;  /* |t - truth| / truth, where both hit */
} masu_field_figures;

/* Between masu_session_open (no_renderer) and masu_session_start: the blob must still be there. */
bool masu_field_look(const masu_session *s, const struct masu_case *of, masu_view *view, char *error,
                     size_t error_size);

/* The frame's depth against the truth beside the scene. */
bool masu_field_compare(const masu_session *s, uint32_t slot, const char *scene_path,
                        const masu_view *view, masu_field_figures *out, char *error,
                        size_t error_size);

#endif

/* cameras.h: the views that a frame is culled for: the camera and the sun's view of each cascade
 * (without a shadow map, for the statistics only, of the whole scene). */
#ifndef MASU_CAMERAS_H
#define MASU_CAMERAS_H

#include "frame/shadow.h"
#include "scene/cull.h"

/* What LODs are chosen by: lod.h. */
typedef struct masu_lod_view {
    double eye[3], forward[3];
    double widest; /* cosine of the angle between the view direction and the image corners */
    float pixels, threshold;
} masu_lod_view;

/* Occlusion culling parameters of a view in the GPU's layout: MASU_CULL_VIEW_*. */
typedef struct masu_occlusion_view {
    float clip[16], eye[4], atlas[4], near_distance, margin, blind, bias;
    uint32_t turn, trimmed;
    float reach, reserved;
} masu_occlusion_view;
_Static_assert(sizeof(masu_occlusion_view) == 4 * MASU_CULL_VIEW_WORDS, "stage 2 view");

typedef struct masu_views {
    masu_cull_view planes[MASU_MAX_VIEWS]; /* of frustum culling */
    masu_occlusion_view stage2[MASU_MAX_VIEWS];
    masu_lod_view lod; /* the camera's */
} masu_views;

/* Whether a frame draws a view: the camera's always, of the cascades those that are due. */
int masu_view_draws(const masu_frame_data *f, uint32_t view);

/* Sets up the views of a frame; after its cascades. */
void masu_views_set(masu_views *v, const masu_bounds *bounds, const masu_shadow *s,
                    const masu_frame_data *f);

#endif

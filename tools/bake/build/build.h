/* build.h: the second step of baking: what a description says becomes the blob's sections.
 *
 *   build.c    all steps, in order
 *   models.c   models imported, made, placed; their groups and occluders
 *   lights.c   the scene's own lights
 *   look.c     camera path, shadow map, environment
 *
 * The content is the caller's to release, whatever is returned. */
#ifndef MASU_BAKE_BUILD_H
#define MASU_BAKE_BUILD_H

#include "bake/description/description.h"
#include "bake/mesh/detail.h"
#include "bake/mesh/occluders.h"

/* Results, for statistics. */
typedef struct masu_bake_report {
    masu_bake_lod_report lods;
    masu_bake_occluder_report occluders;
    masu_bake_bvh_report reflections;
    bool reflected; /* the description requests reflections */
    masu_bake_box bounds; /* of the models, without the ground of a first look */
    masu_bake_buffer warnings; /* the texts of all, each with its NUL */
} masu_bake_report;

/* False after reporting. Adds to the description the values that depend on the models' shapes:
 * the camera of a model without a scene, the sun of a file. With options->describe it stops
 * there, and the content has geometry and camera only. */
bool masu_bake_build(masu_bake_description *d, const masu_bake_options *options,
                     masu_bake_content *content, masu_bake_report *report);

#endif

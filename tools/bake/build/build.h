/* build.h: the second step of baking: converts a description to the blob's sections.
 *
 *   build.c    all steps, in order
 *   models.c   imports, makes and places models; their groups and occluders
 *   lights.c   the scene's own lights
 *   look.c     camera path, shadow map, environment
 *
 * The caller releases the content, also after a failure. */
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
    masu_bake_buffer warnings; /* all texts, each with its NUL */
} masu_bake_report;

/* Returns false after reporting. Adds the values that depend on the models' shapes to the
 * description: the camera of a model without a scene, the sun of a file. With options->describe it
 * stops there, and the content has geometry and camera only. */
bool masu_bake_build(masu_bake_description *d, const masu_bake_options *options,
                     masu_bake_content *content, masu_bake_report *report);

#endif

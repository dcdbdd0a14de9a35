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

/* What came of it, for statistics. */
typedef struct masu_bake_report {
    masu_bake_lod_report lods;
    masu_bake_occluder_report occluders;
    masu_bake_bvh_report reflections;
    bool reflected; /* reflections were asked for */
    masu_bake_box bounds; /* of the models, without the ground of a first look */
    masu_bake_buffer warnings; /* the texts of all, each with its NUL */
} masu_bake_report;

/* False after reporting. It completes the description by what depends on the models' shapes: the
 * view of a model without a scene, the sun of a file. With options->describe that is all, and the
 * content has geometry and view alone. */
bool masu_bake_build(masu_bake_description *d, const masu_bake_options *options,
                     masu_bake_content *content, masu_bake_report *report);

#endif

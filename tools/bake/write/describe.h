/* describe.h: the scene description of a model or a .sdf file that came without one: what
 * --describe writes. */
#ifndef MASU_BAKE_DESCRIBE_H
#define MASU_BAKE_DESCRIBE_H

#include "bake/build/build.h"

/* To options->output, or to stdout. Baked in its folder it gives the blob that the input gives
 * alone. `content`: as masu_bake_build leaves it with options->describe. False after reporting. */
bool masu_bake_write_scene(const masu_bake_options *options, const masu_bake_description *d,
                           const masu_bake_content *content);

#endif

/* describe.h: the scene description of a model or a .sdf file that came without one: what
 * --describe writes. */
#ifndef MASU_BAKE_DESCRIBE_H
#define MASU_BAKE_DESCRIBE_H

#include "bake/build/build.h"

/* Writes to options->output, or to stdout. Baking the result in its folder gives the same blob as
 * baking the input directly. `content`: from masu_bake_build with options->describe. False after
 * reporting. */
bool masu_bake_write_scene(const masu_bake_options *options, const masu_bake_description *d,
                           const masu_bake_content *content);

#endif

/* check.h: the checks of what is in the sections of a blob, a family in each check_*.c, and what
 * masu_scene tells of them. They build on each other, and masu_scene_bind calls them in this order. */
#ifndef MASU_SCENE_CHECK_H
#define MASU_SCENE_CHECK_H

#include "masu.h"
#include "scene/reader.h"
#include "scene/scene_data.h"

/* Vertices, primitives, meshes, their LODs, instances. */
masu_result masu_check_geometry(reader *r);
/* Models that move, and their nodes. */
masu_result masu_check_models(reader *r);
/* Their clips, and the skins that their nodes bend; after occluders and LODs, which what bends has none of. */
masu_result masu_check_clips(reader *r);
masu_result masu_check_skins(reader *r);
/* The trees of such meshes; after masu_check_trace. */
masu_result masu_check_skin_trees(reader *r);
void masu_look_at_skins(const reader *r, masu_scene_data *out);
/* What culling believes: groups of instances, occluders. pairs: of an occluder and an instance of its
 * mesh. */
masu_result masu_check_groups(reader *r);
masu_result masu_check_occluders(reader *r, uint64_t *pairs);
/* Materials but for their textures, the camera path, sun, shadow, lights, probes, sky and fog. */
masu_result masu_check_looks(reader *r);
void masu_look_at_looks(const reader *r, masu_scene_data *out);
/* Textures, and what materials say of them. */
masu_result masu_check_textures(reader *r);
/* The SDF: its numbers, and that its code is there; then the code. */
masu_result masu_check_sdf(reader *r);
masu_result masu_check_code(reader *r);
void masu_look_at_sdf(const reader *r, masu_scene_data *out);
/* What rays are traced through. */
masu_result masu_check_trace(reader *r);
void masu_look_at_trace(const reader *r, masu_scene_data *out);

#endif

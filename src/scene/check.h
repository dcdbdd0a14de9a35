/* check.h: validation of the contents of sections, one family of sections per check_*.c, and the
 * functions that fill the masu_scene queries from them. The checks depend on each other;
 * masu_scene_bind calls them in this order. */
#ifndef MASU_SCENE_CHECK_H
#define MASU_SCENE_CHECK_H

#include "masu.h"
#include "scene/reader.h"
#include "scene/scene_data.h"

/* Vertices, primitives, meshes, their LODs, instances. */
masu_result masu_check_geometry(reader *r);
/* Movable models and their nodes. */
masu_result masu_check_models(reader *r);
/* Clips, and the skins of the nodes. After occluders and LODs, which skinned meshes must not
 * have. */
masu_result masu_check_clips(reader *r);
masu_result masu_check_skins(reader *r);
/* BVHs of skinned meshes; after masu_check_trace. */
masu_result masu_check_skin_trees(reader *r);
void masu_describe_skins(const reader *r, masu_scene_data *out);
/* Culling data: groups of instances, and occluders. *pairs: number of pairs of an occluder and an
 * instance of its mesh. */
masu_result masu_check_groups(reader *r);
masu_result masu_check_occluders(reader *r, uint64_t *pairs);
/* Materials without their textures, the camera path, sun, shadow, lights, probes, sky and fog. */
masu_result masu_check_looks(reader *r);
void masu_describe_looks(const reader *r, masu_scene_data *out);
/* Textures, and the references of materials to them. */
masu_result masu_check_textures(reader *r);
/* The SDF: its numbers and that its SPIR-V is present; then the SPIR-V. */
masu_result masu_check_sdf(reader *r);
masu_result masu_check_code(reader *r);
void masu_describe_sdf(const reader *r, masu_scene_data *out);
/* BVHs and other ray tracing data. */
masu_result masu_check_trace(reader *r);
void masu_describe_trace(const reader *r, masu_scene_data *out);

#endif

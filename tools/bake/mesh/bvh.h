/* bvh.h: what rays of reflections are traced through: a tree over the triangles of each mesh
 * that a traced instance has (src/scene/trace_tree.h), as the TRACE sections of the blob.
 *
 * A scene asks for it with "reflections" (docs/scene.md). Traced is what is large enough to be told
 * in a reflection, or says so itself; blended materials are not, and neither are triangles without
 * area. */
#ifndef MASU_BAKE_BVH_H
#define MASU_BAKE_BVH_H

#include "bake/scene/content.h"

enum { MASU_BAKE_TRACED_AUTO, MASU_BAKE_TRACED_YES, MASU_BAKE_TRACED_NO };

/* Of the diagonal of all instances: smaller ones are not traced, unless the scene says how
 * small. */
#define MASU_BAKE_TRACED_SHARE 5e-4

typedef struct masu_bake_reflections {
    bool wanted;
    double smallest; /* diagonal of an instance's box, metres; below 0: by MASU_BAKE_TRACED_SHARE */
    double cutoff;   /* roughness from which nothing is traced */
    double distance; /* longest ray, metres */
    uint32_t texture_size; /* of the pictures of textures: bake/texture/trace_texture.h */
} masu_bake_reflections;

typedef struct masu_bake_bvh_report {
    uint64_t meshes, instances, nodes, triangles, bytes;
    uint64_t flat;  /* triangles left out: no area */
    uint64_t small; /* instances left out: too small */
    uint32_t depth; /* of the deepest tree */
    double cost;    /* by the surface area heuristic, mean over the triangles */
    double seconds;
} masu_bake_bvh_report;

masu_bake_reflections masu_bake_reflection_defaults(void); /* none are wanted */

/* What the scene says of the instances from `first` on, the last that there are: one of
 * MASU_BAKE_TRACED_*. */
void masu_bake_mark_traced(masu_bake_content *content, uint64_t first, int traced);

/* After masu_bake_sort_instances. False after reporting: more nodes than a blob may have. */
bool masu_bake_make_bvh(masu_bake_content *content, const masu_bake_reflections *wanted,
                        masu_bake_bvh_report *report);

#endif

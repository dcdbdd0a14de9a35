/* bvh.h: ray tracing data for reflections: a BVH over the triangles of each mesh that has a traced
 * instance (src/scene/trace_tree.h), written as the TRACE sections of the blob.
 *
 * A scene requests it with "reflections" (docs/scene.md). Instances are traced if they are large
 * enough to be recognisable in a reflection, or if the scene requests it. Blended materials and
 * triangles without area are not traced. */
#ifndef MASU_BAKE_BVH_H
#define MASU_BAKE_BVH_H

#include "bake/scene/content.h"

enum { MASU_BAKE_TRACED_AUTO, MASU_BAKE_TRACED_YES, MASU_BAKE_TRACED_NO };

/* Fraction of the diagonal of all instances. Smaller instances are not traced, unless the scene
 * gives another limit. */
#define MASU_BAKE_TRACED_SHARE 5e-4

typedef struct masu_bake_reflections {
    bool wanted;
    double smallest; /* diagonal of an instance's box, metres; below 0: by MASU_BAKE_TRACED_SHARE */
    double cutoff;   /* roughness from which nothing is traced */
    double distance; /* longest ray, metres */
    uint32_t texture_size; /* size of the images of textures: bake/texture/trace_texture.h */
} masu_bake_reflections;

typedef struct masu_bake_bvh_report {
    uint64_t meshes, instances, nodes, triangles, bytes;
    uint64_t flat;  /* triangles skipped because they have no area */
    uint64_t small; /* instances skipped because they are too small */
    uint32_t depth; /* of the deepest tree */
    double cost;    /* by the surface area heuristic, mean over the triangles */
    double seconds;
} masu_bake_bvh_report;

masu_bake_reflections masu_bake_reflection_defaults(void); /* none are wanted */

/* Sets the scene's choice for the instances from `first` to the last one: one of
 * MASU_BAKE_TRACED_*. */
void masu_bake_mark_traced(masu_bake_content *content, uint64_t first, int traced);

/* After masu_bake_sort_instances. False after reporting: more nodes than a blob may have. */
bool masu_bake_make_bvh(masu_bake_content *content, const masu_bake_reflections *wanted,
                        masu_bake_bvh_report *report);

#endif

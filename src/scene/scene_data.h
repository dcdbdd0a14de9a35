/* scene_data.h: the content of a masu_scene: counts and flags of a validated scene. scene.c fills
 * it, scene_query.c implements the public queries. */
#ifndef MASU_SCENE_DATA_H
#define MASU_SCENE_DATA_H

#include "masu.h"

/* The content of a masu_scene. It is smaller: never copy a masu_scene from it. A host declares its
 * object as masu_scene, so accesses through this type must not be optimised by type. */
#if defined(__GNUC__)
#define MASU_MAY_ALIAS __attribute__((may_alias))
#else
#define MASU_MAY_ALIAS
#endif

#define MASU_FLAT_LENS 0.01 /* radians, vertical */

/* Numbers of elements unless stated otherwise; flags are 0 or 1. In a masu_frame_plan the numbers
 * include what desc.reserve adds (reserve.h). */
typedef struct MASU_MAY_ALIAS masu_scene_data {
    const void *blob; /* the caller's; NULL: not filled by masu_scene_bind */
    uint64_t blob_bytes;

    /* Geometry. */
    uint32_t vertices, indices, primitives, meshes, instances, materials, camera_keys;
    uint32_t lods;                          /* of all meshes, without the finest levels */
    uint32_t lod_draws, lod_instances;      /* their draws; instances, once per LOD of their mesh */
    uint32_t occluders, placed_occluders;   /* boxes of meshes; the same, once per instance */
    uint32_t groups, group_items;           /* nodes of the culling hierarchy; instances in them */
    uint32_t max_instances, max_primitives; /* of any one mesh */
    uint32_t draws;                         /* of one G-buffer pass, without LODs */
    uint64_t triangles;                     /* of all instances at their finest level */
    /* How many of these are slots of desc.reserve.meshes; nodes: 0 unless rays trace them.
     * All 0 outside of a masu_frame_plan. */
    uint32_t host_meshes, host_vertices, host_triangles, host_nodes;

    /* Movable models, their animations and skins. */
    uint32_t models, model_nodes;              /* models; nodes of all models */
    uint32_t clips, channels, keys;            /* of all animations */
    uint32_t max_nodes;                        /* of any one model */
    uint32_t skins;                            /* skinned meshes */
    uint32_t skin_vertices, joints;            /* of the shared skins in the blob */
    uint32_t morph_targets, morph_deltas;      /* the same */
    uint32_t skin_targets; /* of all skinned meshes; shared targets count once per mesh */
    uint32_t skinned_vertices, skinned_joints; /* of all skinned meshes */
    uint32_t skinned_nodes;                    /* of their BVHs */
    uint32_t first_skinned, max_skinned; /* first skinned vertex; most vertices of any one mesh */

    /* Flag: a camera key is narrower than MASU_FLAT_LENS, as orthographic cameras are. */
    uint32_t flat_lens;

    /* Exposure. */
    uint32_t metered;       /* flag: metered by default */
    float brighten, darken; /* adaptation speeds, 1/s; 0: the default */

    /* SDF. */
    uint32_t sdf;        /* flag */
    uint32_t sdf_params; /* run-time parameters */
    uint32_t sdf_parts, sdf_slots, sdf_block_words;
    uint32_t sdf_dynamic;  /* flag: slots depend on parameters or time */
    uint32_t sdf_timed;    /* flag: the field or its surfaces depend on time */
    uint32_t sdf_static;   /* flag: the field never changes; its surfaces may */
    uint32_t sdf_anchored; /* flag: precise far from the origin (docs/sdf.md) */
#ifdef MASU_LAB
    uint32_t sdf_march; /* bit per masu_march that the blob has code for */
#endif
    uint32_t sdf_occlusion; /* flag: casts shadows or occludes ambient light */
    uint32_t sdf_casts;     /* flag: casts shadows of punctual lights */

    /* Shadow map of the sun; all 0 without one or without instances. */
    uint32_t shadow_cascades;
    uint32_t shadow_resolution; /* texels along an edge of a cascade */
    float shadow_distance;      /* metres */
    float shadow_lambda;        /* 0: cascades split evenly, 1: logarithmically */

    /* Materials and textures. */
    uint32_t textures; /* layers of all texture arrays */
    uint32_t texture_arrays, texture_sets;
    uint32_t vertex_colors;         /* flag: vertices have colours */
    uint32_t second_texcoords;      /* flag: vertices have a second set of coordinates */
    uint64_t texture_bytes;         /* of texels as compressed blocks */
    uint64_t texture_bytes_decoded; /* of the same texels decoded */
    uint32_t masks;                 /* flag: a material is alpha-tested */
    uint32_t singles;               /* flag: a material is single-sided */
    uint32_t emissions; /* bit per masu_draw_kind (material.h) of which an opaque material emits */
    uint32_t surfaces;  /* opaque materials with a specular factor, a coat, mesoscale detail or an
                         * occlusion map */
    uint32_t coats;     /* materials with a clear coat */
    uint32_t own_coats; /* flag: a coat has a map, or a normal other than the base's */
    uint32_t lobes;     /* bit 1 << MASU_LOBE_*: a material has one */
    uint32_t meso;      /* tables of mesoscale detail */
    uint32_t reliefs;   /* flag: an opaque material has a normal map */
    uint32_t blends;    /* transparent materials */
    /* A transparent material has coloured transmission; MASU_TINTS_ROUGH: a rough one,
     * MASU_TINTS_MAPPED: one with a map of its transmission; MASU_TINTS_REFRACTED: one with a
     * thickness. */
    uint32_t tints;
    uint32_t transparents;     /* transparent primitives, once per instance */
    uint32_t transparent_sets; /* their texture sets, at least 1 if there are any */

    /* Light. */
    uint32_t lights; /* local lights */
    uint32_t area_lights;    /* capsules and rectangles among them */
    uint32_t surface_lights; /* those of a surface of the scene */
    uint32_t shadow_lights;  /* those that cast shadows */
    uint32_t shadow_spots;   /* among those, spots that have one face */
    uint32_t probes, probe_sets;
    uint64_t probe_words;                        /* 32-bit values of all sets of all probes */
    uint32_t probes_unlit;                       /* flag: they have no baked light */
    uint32_t bounce;                             /* flag: and rays of the frame add to it */
    uint32_t bounce_sdf;                         /* flag: which also trace the SDF */
    uint32_t depth_biases;                       /* flag: some material has one */
    uint32_t environment_size, environment_mips; /* texels along an edge of the map; 0: none */
    uint32_t analytic_sky;                       /* flag: the sky follows from the sun */
    uint32_t fog;                                /* flag */
    float occlusion_radius; /* of screen-space ambient occlusion, metres; 0: none */
    uint32_t smooth_edges;  /* flag: default rungs use MASU_AA_SMAA_HIGH, with a governor temporal
                             * upscaling */

    /* Traced reflections; all 0 without them. */
    uint32_t reflections;                  /* flag */
    uint32_t trace_sdf;                    /* flag: of the SDF too */
    uint32_t trace_nodes, trace_triangles; /* of the BVHs; 0: none */
    uint32_t trace_instances;              /* that rays can hit */
    uint32_t trace_levels;                 /* of the deepest BVH; 0: none */
    uint32_t trace_textures;               /* low-resolution copies of textures for hits */
    uint32_t trace_colors; /* those that hits sample; the others only provide mean roughness */
    uint64_t trace_texels; /* 4 bytes each */
    float specular_cutoff; /* perceptual roughness from which on nothing is traced */
    float glossiest;       /* lowest perceptual roughness of any surface */
    float trace_distance;  /* of the longest ray, metres */
} masu_scene_data;
_Static_assert(sizeof(masu_scene_data) <= sizeof(masu_scene), "masu_scene.opaque is too small");
_Static_assert(_Alignof(masu_scene_data) <= _Alignof(masu_scene), "masu_scene is misaligned");

/* Layout of the buffer of texture coordinates: the first set for all vertices; then, in scenes that
 * have a second set or vertex colours, both. If one of the two is missing, it has a single element,
 * which all vertices share. */
typedef struct masu_texcoord_layout_of {
    uint64_t second, colors, bytes; /* byte offsets, and the total */
} masu_texcoord_layout_of;

static inline int masu_has_attributes(const masu_scene_data *s) {
    return s->vertex_colors || s->second_texcoords;
}

static inline masu_texcoord_layout_of masu_texcoord_layout(const masu_scene_data *s) {
    uint64_t n = s->vertices;
    masu_texcoord_layout_of at = {8 * n, 8 * n, 8 * n};
    if (!masu_has_attributes(s)) return at;
    at.colors = at.second + (s->second_texcoords ? 8 * n : 8);
    at.bytes = at.colors + (s->vertex_colors ? 4 * n : 4);
    return at;
}

/* Casts between a scene and its content. NULL for NULL. */
static inline const masu_scene_data *masu_scene_data_of(const masu_scene *scene) {
    return (const masu_scene_data *)(const void *)scene;
}
static inline const masu_scene *masu_scene_of(const masu_scene_data *data) {
    return (const masu_scene *)(const void *)data;
}

#endif

/* blob_section.h: pointers to the sections of a validated blob, and look-ups in them. Nothing is
 * checked here: reader.c and check_*.c have validated everything. */
#ifndef MASU_BLOB_SECTION_H
#define MASU_BLOB_SECTION_H

#include "scene/blob.h"
#include "scene/cull.h"

#include <stddef.h>

/* Sections of a validated blob. Absent sections are NULL with count 0. */
typedef struct masu_scene_view {
    uint64_t hash; /* of the blob */
    const masu_blob_vertex *vertices;
    const uint32_t *indices;
    const masu_blob_primitive *primitives;
    const masu_blob_mesh *meshes;
    const masu_blob_instance *instances;
    const masu_blob_group *groups;
    const uint32_t *group_items;
    const masu_blob_lod *lods;
    const masu_blob_occluder *occluders;
    const masu_blob_material *materials;
    uint64_t material_count;
    const masu_blob_camera_key *camera_keys;
    const masu_blob_environment *environment;
    const masu_blob_shadow *shadow; /* NULL if absent; the same for the pointers below */
    const masu_blob_sdf *sdf;
    const masu_blob_sdf_param *sdf_params;
    const float *slots;
    uint64_t slot_count;
    const float *texcoords;
    const uint32_t *colors; /* one per vertex */
    const float *texcoords_1;
    const masu_blob_texture *textures;
    const masu_blob_texture_set *texture_sets;
    const unsigned char *texels;
    const masu_blob_meso *meso;
    const masu_blob_light *lights;
    const masu_blob_probes *probes;
    const uint32_t *probe_data;
    uint64_t probe_words;
    const masu_blob_environment_map *environment_map;
    const uint32_t *environment_texels;
    const masu_blob_reflections *reflections;
    const masu_blob_trace_texture *trace_textures;
    const uint32_t *trace_texels;
    const masu_blob_trace_node *trace_nodes; /* NULL without ray tracing, like the next three */
    const masu_blob_trace_triangle *trace_triangles;
    const masu_blob_trace_mesh *trace_meshes;
    const uint32_t *trace_instances;
    const masu_blob_model *models;
    const masu_blob_model_node *model_nodes;
    const masu_blob_clip *clips;
    const masu_blob_channel *channels;
    const masu_blob_key *keys;
    const masu_blob_skin *skins;
    const masu_blob_joint *joints;
    const masu_blob_skin_vertex *skin_vertices;
    const masu_blob_morph_target *morph_targets;
    const masu_blob_morph_delta *morph_deltas;
    struct {
        const uint32_t *words; /* NULL if absent */
        uint64_t count;
    } code[MASU_BLOB_KIND_COUNT]; /* the SPIR-V sections, by kind */
    const char *names;
    uint64_t name_bytes;
} masu_scene_view;

/* World-space box of an instance, as placed in the scene. */
masu_cull_box masu_scene_box(const masu_scene_view *view, uint32_t instance);

/* Binary search in `count` elements of `stride` bytes that are sorted by a 32-bit key; `numbers`
 * points to the key of the first element. Sets *first to the first element with the key `wanted`.
 * Returns the number of such elements. */
uint32_t masu_scene_range(const uint32_t *numbers, size_t stride, uint32_t count, uint32_t wanted,
                          uint32_t *first);

/* FNV-1a 64 of a name; 0 without a name. */
uint64_t masu_scene_name_hash(const masu_scene_view *view, uint32_t name);

/* The LODs of a mesh, finest first. Sets *first to the index of the first one in view->lods.
 * Returns their number (0 to MASU_BLOB_LODS_MAX). */
uint32_t masu_scene_mesh_lods(const masu_scene_view *view, uint32_t lod_count, uint32_t mesh,
                              uint32_t *first);

/* Range [*first, result) of the instances of mesh `mesh`; instances are sorted by mesh. The search
 * starts at `from`. */
uint32_t masu_scene_mesh_instances(const masu_scene_view *view, uint32_t instance_count,
                                   uint32_t mesh, uint32_t from, uint32_t *first);

#endif

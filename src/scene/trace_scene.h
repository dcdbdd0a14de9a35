/* trace_scene.h: the buffers for tracing reflections.
 *
 *   traced scene, once:     header, nodes and triangles (trace.h), then the data that
 *                           shaders/trace/scene.glsl finds after the header's last value: its own
 *                           header, the blue noise tile, materials, texture copies, their texels
 *   traced instances,       the top-level BVH (trace.h), then six rows per traced instance: its
 *   per frame in flight:    current and its previous transform (src/frame/reflections.c)
 *
 * No allocation. */
#ifndef MASU_TRACE_SCENE_H
#define MASU_TRACE_SCENE_H

#include "masu.h"
#include "scene/blob_section.h"
#include "scene/scene_data.h"
#include "shared/masu_shared.h"

#define MASU_TRACE_ROWS 6u /* of four floats, per traced instance */
#define MASU_TRACE_LOOK_ROWS 2u /* with looks: tint and emission; texture coordinates */

/* Start of each part, in units of 16 bytes. */
typedef struct masu_trace_plan {
    uint64_t nodes, triangles, more, noise, materials, pictures, texels, end;
} masu_trace_plan;

masu_trace_plan masu_trace_layout(const masu_scene_data *scene);

/* Bytes of the first buffer, and of a slot of the second. With ray queries (ray_query.h) neither
 * has a BVH: the plan's copy of the scene has no nodes, and the rows follow the header. Looks of
 * instances follow the rows. */
uint64_t masu_trace_scene_bytes(const masu_scene_data *scene);
uint64_t masu_trace_slot_bytes(const masu_scene_data *scene, int query, int looks);
/* Byte offset of the rows in a slot. */
uint64_t masu_trace_rows_at(const masu_scene_data *scene, int query);

/* Writes bytes [offset, offset + bytes) of the first buffer; both are multiples of 16, except at
 * the end. */
void masu_trace_write(const masu_scene_data *scene, const masu_scene_view *v, uint64_t offset,
                      uint64_t bytes, unsigned char *to);

/* A material in the layout for ray hits: one of the scene's, or one that differs from it in its
 * factors. */
struct masu_trace_material masu_trace_material_of(const masu_scene_data *scene,
                                                  const masu_scene_view *v,
                                                  const masu_blob_material *m);

/* The material of a triangle for ray hits, with its flags (shaders/shared/trace.h). */
uint32_t masu_trace_word_of(const masu_scene_data *scene, const masu_scene_view *v,
                            uint32_t material);

/* 1: some traced surface is alpha-tested. Selects the shader permutation that tests alpha at
 * hits. */
uint32_t masu_ray_masks(const masu_scene_data *scene);

#endif

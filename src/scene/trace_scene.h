/* trace_scene.h: the buffers of what reflections are traced through.
 *
 *   traced scene, once:     header, nodes, triangles as trace.h lays them, then what shaders/trace/scene.glsl
 *                           finds behind the header's last word: a header of its own, the tile of blue noise,
 *                           materials, small pictures, their texels
 *   traced instances, per frame in flight: the top level of trace.h, then six rows for each traced
 *                           instance: where it is, and where it was (src/frame/reflections.c)
 *
 * Nothing here allocates. */
#ifndef MASU_TRACE_SCENE_H
#define MASU_TRACE_SCENE_H

#include "masu.h"
#include "scene/blob_section.h"
#include "scene/scene_data.h"
#include "shared/masu_shared.h"

#define MASU_TRACE_ROWS 6u /* of four floats, of each traced instance */

/* Where things begin, in units of 16 bytes. */
typedef struct masu_trace_plan {
    uint64_t nodes, triangles, more, noise, materials, pictures, texels, end;
} masu_trace_plan;

masu_trace_plan masu_trace_lay(const masu_scene_data *scene);

/* Bytes of the first buffer, and of a slot of the second. With ray queries (ray_query.h) neither
 * has a tree: the plan's copy of the scene says that it has no nodes, and the header is followed by
 * the rows. */
uint64_t masu_trace_scene_bytes(const masu_scene_data *scene);
uint64_t masu_trace_slot_bytes(const masu_scene_data *scene, int query);
/* Where in a slot the rows begin. */
uint64_t masu_trace_rows_at(const masu_scene_data *scene, int query);

/* Bytes [offset, offset + bytes) of the first buffer; both multiples of 16, but for the end. */
void masu_trace_write(const masu_scene_data *scene, const masu_scene_view *v, uint64_t offset,
                      uint64_t bytes, unsigned char *to);

/* A material of the scene, or one that differs from it in its factors, as rays know it. */
struct masu_trace_material masu_trace_material_of(const masu_scene_data *scene,
                                                  const masu_scene_view *v,
                                                  const masu_blob_material *m);

/* 1: some of what is traced has holes: the permutation of the shader that looks them up. */
uint32_t masu_ray_masks(const masu_scene_data *scene);

#endif

/* ray_query.h: polygons for VK_KHR_ray_query: where the host offers it, the device's own structures
 * stand in for the trees of trace.h, and shaders/trace/query.glsl for bvh.glsl.
 *
 *   bottom levels   one structure for each traced mesh, all in one buffer; built while the scene is
 *                   loaded, of the vertices as they are and of the triangles in the order of
 *                   TRACE_TRIANGLES, so that the first triangle of a mesh plus the number of the
 *                   primitive is what specular_shade looks up
 *   top level       over the traced instances in their order, so that the number of the instance is
 *                   what specular_shade looks up; built in every frame, of a buffer that the host
 *                   writes
 *   loading         the triangles as an index buffer, and the scratch memory of the bottom levels:
 *                   needed in masu_load alone, so they lie where the transient images of frames will
 *
 * SIZES are the driver's for the geometry at hand, asked for while planning: nothing grows.
 * Structures are not compacted: how small one can be is known after it has been built, and the box
 * is sized before. Bottom levels are built one after the other, each in the same scratch memory:
 * the largest counts, not the sum.
 *
 * What fails: a limit of the device (masu_ray_check), and vkCreateAccelerationStructureKHR. */
#ifndef MASU_RAY_QUERY_H
#define MASU_RAY_QUERY_H

#include "device/device.h"
#include "scene/blob_section.h"

/* Whether the device's limits suffice. */
masu_result masu_ray_check(const masu_scene_data *scene, const masu_vk *vk, masu_detail *detail);

/* Sizes of the buffers that only the driver knows. */
void masu_ray_sizes(masu_frame_plan *plan, const masu_vk *vk);

/* Structures in the buffers, which have their memory. */
masu_result masu_ray_create(masu_device *m, masu_detail *detail);
void masu_ray_destroy(masu_device *m);
void masu_ray_bind(masu_device *m, VkDescriptorSet set);

/* Bytes [offset, offset + bytes) of the index buffer. */
void masu_ray_write_indices(const masu_scene_view *v, uint64_t offset, uint64_t bytes,
                            unsigned char *to);
/* In how many steps of desc.load_step bytes bottom levels are built; without ray queries in none. */
uint32_t masu_ray_build_steps(const masu_frame_plan *plan);
/* Builds those of one step, from mesh *next on, which becomes the first of the next step. */
void masu_ray_record_bottoms(masu_device *m, VkCommandBuffer cmd, uint32_t *next);
void masu_ray_record_top(masu_device *m, VkCommandBuffer cmd, uint32_t slot);

/* Traced instance `traced`, which places `mesh`, to a slot; rows: object to world minus anchor. One that
 * is not live (trace.h) gets a mask that no ray has. */
void masu_ray_write_instance(const masu_device *m, uint32_t slot, uint32_t traced, uint32_t mesh,
                             int live, float rows[3][4]);

#endif

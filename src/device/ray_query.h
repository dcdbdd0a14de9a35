/* ray_query.h: acceleration structures for VK_KHR_ray_query. If the host enables the extension,
 * they replace the BVHs of trace.h, and shaders/trace/query.glsl replaces bvh.glsl.
 *
 *   bottom level   one structure per traced mesh, all in one buffer. Built during loading from the
 *                  static vertices and the triangles in the order of TRACE_TRIANGLES:
 *                  specular_shade finds a triangle as first triangle of the mesh + primitive index
 *   top level      over the traced instances in their order: specular_shade finds an instance by
 *                  the instance index. Built every frame from a buffer that the host writes
 *   loading        triangles as an index buffer, and the scratch memory of the bottom-level builds.
 *                  Only masu_load needs them, so they share memory with the transient images
 *
 * The driver reports all SIZES for the actual geometry during planning; nothing grows later.
 * Structures are not compacted: a compacted size is known only after the build, but the memory
 * block is sized before. Bottom levels are built one after another in the same scratch memory, so
 * its size is the largest requirement, not the sum.
 *
 * Errors: a limit of the device (masu_ray_check), or vkCreateAccelerationStructureKHR fails. */
#ifndef MASU_RAY_QUERY_H
#define MASU_RAY_QUERY_H

#include "device/device.h"
#include "scene/blob_section.h"

/* Checks the numbers of traced triangles and instances against the limits of the device. */
masu_result masu_ray_check(const masu_scene_data *scene, const masu_vk *vk, masu_detail *detail);

/* Sets the sizes of the buffers that only the driver can compute. */
void masu_ray_sizes(masu_frame_plan *plan, const masu_vk *vk);

/* Creates the structures in their buffers, which must have memory. */
masu_result masu_ray_create(masu_device *m, masu_detail *detail);
void masu_ray_destroy(masu_device *m);
void masu_ray_bind(masu_device *m, VkDescriptorSet set);

/* Writes bytes [offset, offset + bytes) of the index buffer. */
void masu_ray_write_indices(const masu_scene_view *v, uint64_t offset, uint64_t bytes,
                            unsigned char *to);
/* Number of steps of desc.load_step bytes in which bottom levels are built; 0 without ray
 * queries. */
uint32_t masu_ray_build_steps(const masu_frame_plan *plan);
/* Records the builds of one step from mesh *next on, and sets *next to the first mesh of the next
 * step. */
void masu_ray_record_bottoms(masu_device *m, VkCommandBuffer cmd, uint32_t *next);
void masu_ray_record_top(masu_device *m, VkCommandBuffer cmd, uint32_t slot);

/* Writes traced instance `traced`, of mesh `mesh`, into slot `slot`. rows: object to world minus
 * the floating origin. An instance that is not live (trace.h) gets mask 0, which no ray matches. */
void masu_ray_write_instance(const masu_device *m, uint32_t slot, uint32_t traced, uint32_t mesh,
                             int live, float rows[3][4]);

#endif

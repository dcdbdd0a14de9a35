/* ray_query.c: see ray_query.h. */
#include "device/ray_query.h"

#include "base/error.h"
#include "device/bind.h"
#include "scene/scene.h"
#include "scene/trace_scene.h"
#include "shared/masu_shared.h"

#include <string.h>

/* Limit: instanceCustomIndex, the first triangle of a mesh, has 24 bits. */
#define TRIANGLES_MAX (1u << 24)
#define STRUCTURE_ALIGNMENT 256u /* of an offset in a buffer: VUID 03734 */
#define INDEX_BYTES (3 * sizeof(uint32_t))
#define TRIANGLE_BYTES (INDEX_BYTES + 9 * sizeof(float)) /* read by a build */
#define ALL_RAYS 0xFFu

_Static_assert(sizeof(VkAccelerationStructureInstanceKHR) == 64, "instances of the top level");

/* ---- Build descriptions ---------------------------------------------------------------------- */

/* Parameters of one build. `info` points to `geometry`, so a build must not be copied. */
typedef struct build {
    VkAccelerationStructureGeometryKHR geometry;
    VkAccelerationStructureBuildGeometryInfoKHR info;
    VkAccelerationStructureBuildRangeInfoKHR range;
} build;

/* Whether a ray may pass through a part of the mesh. A mesh is a single geometry, because its
 * triangles are in the order of the BVH. If one of its materials is alpha-tested or single-sided,
 * the geometry is not opaque and the shader tests each candidate triangle. */
static int has_holes(const masu_scene_data *scene, const masu_scene_view *v, uint32_t mesh) {
    const masu_blob_mesh *m = &v->meshes[mesh];
    uint32_t holes = MASU_MATERIAL_IS_SINGLE | (masu_ray_masks(scene) ? MASU_MATERIAL_IS_MASK : 0);
    for (uint32_t p = 0; p < m->primitive_count; p++) {
        uint32_t material = v->primitives[m->first_primitive + p].material;
        if (v->materials[material].flags & holes) return 1;
    }
    return 0;
}

/* Describes the bottom-level structure of a mesh, without its addresses. */
static void describe_bottom(const masu_scene_data *scene, const masu_scene_view *v, uint32_t mesh,
                            build *b) {
    const masu_blob_mesh *m = &v->meshes[mesh];
    uint32_t last = 0;
    for (uint32_t p = 0; p < m->primitive_count; p++) {
        const masu_blob_primitive *primitive = &v->primitives[m->first_primitive + p];
        uint32_t end = primitive->first_vertex + primitive->vertex_count;
        if (end > last + 1) last = end - 1;
    }
    memset(b, 0, sizeof *b);
    b->geometry = (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_TRIANGLES_KHR,
        .flags = has_holes(scene, v, mesh) ? 0 : VK_GEOMETRY_OPAQUE_BIT_KHR,
        .geometry.triangles = {
            .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR,
            .vertexFormat = VK_FORMAT_R32G32B32_SFLOAT,
            .vertexStride = sizeof(masu_blob_vertex),
            .maxVertex = last,
            .indexType = VK_INDEX_TYPE_UINT32}};
    b->range.primitiveCount = v->trace_meshes[mesh].triangle_count;
    b->range.primitiveOffset = (uint32_t)(v->trace_meshes[mesh].first_triangle * INDEX_BYTES);
    b->info = (VkAccelerationStructureBuildGeometryInfoKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR,
        .flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR,
        .geometryCount = 1,
        .pGeometries = &b->geometry};
}

static void describe_top(const masu_scene_data *scene, build *b) {
    memset(b, 0, sizeof *b);
    b->geometry = (VkAccelerationStructureGeometryKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR,
        .geometryType = VK_GEOMETRY_TYPE_INSTANCES_KHR,
        .geometry.instances = {
            .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR}};
    b->range.primitiveCount = scene->trace_instances;
    b->info = (VkAccelerationStructureBuildGeometryInfoKHR){
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR,
        .type = VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR,
        .flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR,
        .geometryCount = 1,
        .pGeometries = &b->geometry};
}

static VkAccelerationStructureBuildSizesInfoKHR sizes_of(const masu_vk *vk, const build *b) {
    VkAccelerationStructureBuildSizesInfoKHR out = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR};
    vk->GetAccelerationStructureBuildSizesKHR(vk->device,
                                              VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR,
                                              &b->info, &b->range.primitiveCount, &out);
    return out;
}

/* ---- The plan -------------------------------------------------------------------------------- */

masu_result masu_ray_check(const masu_scene_data *scene, const masu_vk *vk, masu_detail *detail) {
    uint64_t triangles = TRIANGLES_MAX, instances = vk->rays.maxInstanceCount;
    if (vk->rays.maxPrimitiveCount < triangles) triangles = vk->rays.maxPrimitiveCount;
    if (scene->trace_triangles > triangles) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "traced triangles", scene->trace_triangles,
                         triangles, "ray_query: the scene traces %u triangles, possible are %llu",
                         scene->trace_triangles, (unsigned long long)triangles);
    }
    if (scene->trace_instances > instances) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxInstanceCount", scene->trace_instances,
                         instances,
                         "ray_query: the scene traces %u instances, the device takes %llu",
                         scene->trace_instances, (unsigned long long)instances);
    }
    return MASU_OK;
}

static void set_row(masu_buffer_plan *row, uint64_t count, uint64_t bytes, uint64_t alignment) {
    row->count = count;
    row->bytes = bytes;
    row->alignment = alignment ? alignment : 1;
}

void masu_ray_sizes(masu_frame_plan *plan, const masu_vk *vk) {
    masu_buffer_plan *b = plan->buffers, *instances = &b[MASU_BUFFER_RAY_INSTANCES];
    uint64_t apart = vk->rays.minAccelerationStructureScratchOffsetAlignment;
    uint64_t bytes = 0, scratch = 0, count = 0;
    build one;
    if (!plan->needs.query) return;
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    for (uint32_t mesh = 0; mesh < plan->scene.meshes; mesh++) {
        if (!v.trace_meshes[mesh].node_count) continue;
        describe_bottom(&plan->scene, &v, mesh, &one);
        VkAccelerationStructureBuildSizesInfoKHR s = sizes_of(vk, &one);
        bytes += masu_align_up(s.accelerationStructureSize, STRUCTURE_ALIGNMENT);
        if (scratch < s.buildScratchSize) scratch = s.buildScratchSize;
        count++;
    }
    set_row(&b[MASU_BUFFER_BOTTOM_LEVELS], count, bytes, STRUCTURE_ALIGNMENT);
    set_row(&b[MASU_BUFFER_RAY_SCRATCH], 1, scratch ? scratch : 4, apart);
    set_row(&b[MASU_BUFFER_RAY_INDICES], 3 * (uint64_t)plan->scene.trace_triangles,
            INDEX_BYTES * plan->scene.trace_triangles, sizeof(uint32_t));
    describe_top(&plan->scene, &one);
    VkAccelerationStructureBuildSizesInfoKHR s = sizes_of(vk, &one);
    set_row(&b[MASU_BUFFER_TOP_LEVEL], 1, s.accelerationStructureSize, STRUCTURE_ALIGNMENT);
    set_row(&b[MASU_BUFFER_TOP_SCRATCH], 1, s.buildScratchSize ? s.buildScratchSize : 4, apart);
    instances->stride =
        plan->scene.trace_instances * sizeof(VkAccelerationStructureInstanceKHR);
    set_row(instances, plan->scene.trace_instances,
            plan->desc.frames_in_flight * instances->stride, 16);
}

/* ---- Structures ------------------------------------------------------------------------------ */

static masu_result create(masu_device *m, masu_buffer_id buffer, uint64_t offset, const build *b,
                          uint64_t *bytes, VkAccelerationStructureKHR *out, masu_detail *detail) {
    VkAccelerationStructureCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR,
        .buffer = m->objects.buffers[buffer],
        .offset = offset,
        .size = sizes_of(&m->vk, b).accelerationStructureSize,
        .type = b->info.type};
    VkResult r = m->vk.CreateAccelerationStructureKHR(m->vk.device, &info, m->vk.allocator, out);
    if (MASU_FAILED(r, *out))
        return masu_fail_vulkan(detail, r, "vkCreateAccelerationStructureKHR");
    masu_name(m, VK_OBJECT_TYPE_ACCELERATION_STRUCTURE_KHR, MASU_HANDLE(*out),
              m->plan->buffers[buffer].name);
    *bytes = info.size;
    return MASU_OK;
}

masu_result masu_ray_create(masu_device *m, masu_detail *detail) {
    uint64_t offset = 0, bytes = 0;
    build b;
    if (!m->plan->needs.query) return MASU_OK;
    masu_scene_view v = masu_scene_data_view(&m->plan->scene);
    for (uint32_t mesh = 0; mesh < m->plan->scene.meshes; mesh++) {
        masu_ray_mesh *to = &m->ray_meshes[mesh];
        if (!v.trace_meshes[mesh].node_count) continue;
        describe_bottom(&m->plan->scene, &v, mesh, &b);
        masu_result result =
            create(m, MASU_BUFFER_BOTTOM_LEVELS, offset, &b, &bytes, &to->structure, detail);
        if (result) return result;
        VkAccelerationStructureDeviceAddressInfoKHR info = {
            .sType = VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR,
            .accelerationStructure = to->structure};
        to->address = m->vk.GetAccelerationStructureDeviceAddressKHR(m->vk.device, &info);
        to->first_triangle = v.trace_meshes[mesh].first_triangle;
        offset += masu_align_up(bytes, STRUCTURE_ALIGNMENT);
    }
    describe_top(&m->plan->scene, &b);
    return create(m, MASU_BUFFER_TOP_LEVEL, 0, &b, &bytes, &m->ray_top, detail);
}

void masu_ray_destroy(masu_device *m) {
    if (!m->plan->needs.query) return;
    m->vk.DestroyAccelerationStructureKHR(m->vk.device, m->ray_top, m->vk.allocator);
    for (uint32_t mesh = 0; mesh < m->plan->scene.meshes; mesh++) {
        m->vk.DestroyAccelerationStructureKHR(m->vk.device, m->ray_meshes[mesh].structure,
                                              m->vk.allocator);
    }
}

void masu_ray_bind(masu_device *m, VkDescriptorSet set) {
    VkWriteDescriptorSetAccelerationStructureKHR top = {
        .sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR,
        .accelerationStructureCount = 1,
        .pAccelerationStructures = &m->ray_top};
    VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                  .pNext = &top,
                                  .dstSet = set,
                                  .dstBinding = MASU_BIND_TOP_LEVEL,
                                  .descriptorCount = 1,
                                  .descriptorType = VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR};
    m->vk.UpdateDescriptorSets(m->vk.device, 1, &write, 0, NULL);
}

/* ---- Builds ---------------------------------------------------------------------------------- */

void masu_ray_write_indices(const masu_scene_view *v, uint64_t offset, uint64_t bytes,
                            unsigned char *to) {
    for (uint64_t at = offset; at < offset + bytes;) {
        uint64_t skip = at % INDEX_BYTES, part = INDEX_BYTES - skip;
        if (part > offset + bytes - at) part = offset + bytes - at;
        const masu_blob_trace_triangle *t = &v->trace_triangles[at / INDEX_BYTES];
        memcpy(to + (at - offset), (const unsigned char *)t->vertex + skip, (size_t)part);
        at += part;
    }
}

static uint64_t address_of(const masu_device *m, masu_buffer_id buffer) {
    VkBufferDeviceAddressInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO,
                                      .buffer = m->objects.buffers[buffer]};
    return m->vk.GetBufferDeviceAddressKHR(m->vk.device, &info);
}

static void record_build(masu_device *m, VkCommandBuffer cmd, build *b,
                         VkAccelerationStructureKHR to, masu_buffer_id scratch) {
    const VkAccelerationStructureBuildRangeInfoKHR *range = &b->range;
    b->info.dstAccelerationStructure = to;
    b->info.scratchData.deviceAddress = address_of(m, scratch);
    m->vk.CmdBuildAccelerationStructuresKHR(cmd, 1, &b->info, &range);
}

/* A build waits for earlier copies, and for earlier builds that use the same scratch memory. */
static void wait_before_build(masu_device *m, VkCommandBuffer cmd, VkPipelineStageFlags from,
                              VkAccessFlags access) {
    VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                               .srcAccessMask = access,
                               .dstAccessMask = VK_ACCESS_SHADER_READ_BIT |
                                                VK_ACCESS_ACCELERATION_STRUCTURE_READ_BIT_KHR |
                                                VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR};
    m->vk.CmdPipelineBarrier(cmd, from, VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR, 0,
                             1, &barrier, 0, NULL, 0, NULL);
}

/* One step builds the meshes from `mesh` on, within desc.load_step bytes, but at least one. Returns
 * the first mesh of the next step. */
static uint32_t end_of_step(const masu_frame_plan *plan, const masu_scene_view *v, uint32_t mesh) {
    uint64_t room = plan->desc.load_step, used = 0;
    for (; mesh < plan->scene.meshes; mesh++) {
        uint64_t bytes = v->trace_meshes[mesh].triangle_count * TRIANGLE_BYTES;
        if (!v->trace_meshes[mesh].node_count) continue;
        if (room && used && used + bytes > room) break;
        used += bytes;
    }
    return mesh;
}

uint32_t masu_ray_build_steps(const masu_frame_plan *plan) {
    uint32_t steps = 0, mesh = 0;
    if (!plan->needs.query) return 0;
    masu_scene_view v = masu_scene_data_view(&plan->scene);
    do {
        mesh = end_of_step(plan, &v, mesh);
        steps++;
    } while (mesh < plan->scene.meshes);
    return steps;
}

void masu_ray_record_bottoms(masu_device *m, VkCommandBuffer cmd, uint32_t *next) {
    masu_scene_view v = masu_scene_data_view(&m->plan->scene);
    uint32_t mesh = *next;
    /* Includes the builds of earlier steps. */
    VkPipelineStageFlags from =
        VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
    VkAccessFlags access =
        VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
    *next = end_of_step(m->plan, &v, mesh);
    for (; mesh < *next; mesh++) {
        build b;
        if (!m->ray_meshes[mesh].structure) continue;
        describe_bottom(&m->plan->scene, &v, mesh, &b);
        VkAccelerationStructureGeometryTrianglesDataKHR *t = &b.geometry.geometry.triangles;
        t->vertexData.deviceAddress = address_of(m, MASU_BUFFER_VERTICES);
        t->indexData.deviceAddress = address_of(m, MASU_BUFFER_RAY_INDICES);
        wait_before_build(m, cmd, from, access);
        record_build(m, cmd, &b, m->ray_meshes[mesh].structure, MASU_BUFFER_RAY_SCRATCH);
        from = VK_PIPELINE_STAGE_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
        access = VK_ACCESS_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;
    }
}

/* The barrier at the start of the frame orders the build after the previous frame's accesses. */
void masu_ray_record_top(masu_device *m, VkCommandBuffer cmd, uint32_t slot) {
    build b;
    describe_top(&m->plan->scene, &b);
    b.geometry.geometry.instances.data.deviceAddress =
        address_of(m, MASU_BUFFER_RAY_INSTANCES) +
        slot * m->plan->buffers[MASU_BUFFER_RAY_INSTANCES].stride;
    record_build(m, cmd, &b, m->ray_top, MASU_BUFFER_TOP_SCRATCH);
}

/* ---- Instances ------------------------------------------------------------------------------- */

void masu_ray_write_instance(const masu_device *m, uint32_t slot, uint32_t traced, uint32_t mesh,
                             int live, float rows[3][4]) {
    static const float identity[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    VkAccelerationStructureInstanceKHR to = {
        .instanceCustomIndex = m->ray_meshes[mesh].first_triangle & (TRIANGLES_MAX - 1),
        .mask = live ? ALL_RAYS : 0,
        .accelerationStructureReference = m->ray_meshes[mesh].address};
    if (live)
        memcpy(to.transform.matrix, rows, sizeof to.transform.matrix);
    else
        memcpy(to.transform.matrix, identity, sizeof to.transform.matrix);
    memcpy(masu_buffer_pointer(m, MASU_BUFFER_RAY_INSTANCES, slot) + traced * sizeof to, &to,
           sizeof to);
}

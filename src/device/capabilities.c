/* capabilities.c: see capabilities.h. */
#include "device/capabilities.h"

#include "base/error.h"
#include "device/ray_query.h"
#include "device/shaders.h"
#include "plan/buffer_plan.h"
#include "quality/device_class.h"
#include "quality/ladder.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* ---- Storage buffers ------------------------------------------------------------------------- */

static uint32_t buffers_of(const masu_desc *desc, const VkPhysicalDeviceLimits *limits) {
    uint32_t has = limits->maxPerStageDescriptorStorageBuffers, most = desc->deny.storage_buffers;
    return most && most < has ? most : has;
}

typedef struct masu_most {
    uint32_t buffers;
    const char *pass;
} masu_most;

/* The largest number of storage buffers in one stage, over the passes that bind a buffer of
 * `group`, and the pass that has it. PLAIN: over the passes that bind no buffer of an optional
 * group; no rung can omit those. Probe rays bind the buffers of reflections too, but count only as
 * BOUNCING. */
static masu_most most_buffers(const masu_frame_plan *plan, masu_binding_group group) {
    const uint32_t bouncing = 1u << MASU_BINDING_BOUNCING;
    const uint32_t optional = 1u << MASU_BINDING_TRACING | 1u << MASU_BINDING_CULLING | bouncing;
    masu_most most = {0, ""};
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (!masu_first_rung(plan, p)) continue;
        masu_stage_needs needs = masu_stage_needs_of(plan, p);
        uint32_t groups = needs.groups, count = needs.storage_buffers;
        if (groups & bouncing) groups = bouncing;
        if (group == MASU_BINDING_PLAIN ? groups & optional : !(groups >> group & 1)) continue;
        if (count > most.buffers) most = (masu_most){count, masu_passes[p].name};
    }
    return most;
}

static masu_result too_few(const char *what, masu_most most, uint32_t has, masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_DEVICE, "maxPerStageDescriptorStorageBuffers", most.buffers,
                     has,
                     "%s needs %u storage buffers in a stage of the pass %s, the device has %u",
                     what, most.buffers, most.pass, has);
}

/* Sets a MASU_AUTO feature to OFF in rungs for which the device has too few storage buffers, and
 * sets `bit` in *dropped. MASU_ON is an error. */
static masu_result drop(masu_desc *desc, size_t member, const char *name, masu_most most,
                        uint32_t has, uint32_t bit, uint32_t *dropped, masu_detail *detail) {
    for (uint32_t r = 0; r < desc->rung_count && has < most.buffers; r++) {
        masu_switch *is = (masu_switch *)(void *)((unsigned char *)&desc->rungs[r] + member);
        char what[48];
        snprintf(what, sizeof what, "rungs[%u].%s", r, name);
        if (*is == MASU_ON) return too_few(what, most, has, detail);
        if (*is != MASU_OFF) *dropped |= bit;
        *is = MASU_OFF;
    }
    return MASU_OK;
}

/* Whether any rung may still trace rays. */
static int desc_traces(const masu_desc *desc) {
    for (uint32_t r = 0; r < desc->rung_count; r++) {
        if (desc->rungs[r].specular != MASU_OFF) return 1;
    }
    return 0;
}

static int is_gpu(const masu_vk *vk) {
    VkPhysicalDeviceType type = vk->properties.deviceType;
    return type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
           type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
}

/* Chooses between VK_KHR_ray_query and the built-in BVH for reflections: sets the field to ON or
 * OFF. */
static masu_result choose_ray_query(masu_desc *desc, const masu_frame_plan *plan, const masu_vk *vk,
                                    masu_detail *detail) {
    int forced = desc->ray_query == MASU_ON;
    int wished = forced || (desc->ray_query == MASU_AUTO && desc->vulkan.ray_query && is_gpu(vk));
    desc->ray_query = MASU_OFF;
    if (!wished || !plan->needs.traced || !desc_traces(desc)) return MASU_OK;
    if (plan->needs.bounce && forced) {
        return masu_fail(
            detail, MASU_ERROR_SCENE, "ray_query", 0, 1,
            "ray_query is MASU_ON, but rays of the scene's live bounce walk the library's own "
            "tree, and reflections with them: leave it to MASU_AUTO, or turn rung.bounce off");
    }
    if (plan->needs.bounce) return MASU_OK;
    if (!desc->vulkan.ray_query) {
        return masu_fail(
            detail, MASU_ERROR_DEVICE, "vulkan.ray_query", 1, 0, "ray_query is MASU_ON, but %s",
            vk->device ? "vulkan.ray_query says that the device was created without "
                         "VK_KHR_ray_query"
                       : "the device does not offer VK_KHR_ray_query");
    }
    if (plan->scene.host_meshes && forced) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "ray_query", 0, plan->scene.host_meshes,
                         "ray_query is MASU_ON, but reserve.meshes has %u meshes, which are traced "
                         "by the built-in BVH: use MASU_AUTO or MASU_OFF",
                         plan->scene.host_meshes);
    }
    if (plan->scene.skins && forced) {
        return masu_fail(
            detail, MASU_ERROR_SCENE, "ray_query", 0, plan->scene.skins,
            "ray_query is MASU_ON, but structures of the device do not bend: the scene "
            "has %u skins",
            plan->scene.skins);
    }
    if (plan->scene.skins || plan->scene.host_meshes) return MASU_OK;
    masu_result result = masu_ray_check(&plan->scene, vk, detail);
    if (result) return forced ? result : MASU_OK;
    desc->ray_query = MASU_ON;
    return MASU_OK;
}

/* Chooses 16-bit arithmetic in EASU: ON, AUTO (only in fast EASU) or OFF. */
static masu_result choose_half_floats(masu_desc *desc, const masu_vk *vk, masu_detail *detail) {
    int forced = desc->half_floats == MASU_ON, used = 0;
    for (uint32_t r = 0; r < desc->rung_count; r++) {
        masu_easu easu = desc->rungs[r].easu;
        used |= easu == MASU_EASU_FAST || (forced && easu != MASU_EASU_BILINEAR);
    }
    if (used && forced && !desc->vulkan.shader_float16) {
        return masu_fail(
            detail, MASU_ERROR_DEVICE, "vulkan.shader_float16", 1, 0,
            "half_floats is MASU_ON, but %s",
            vk->device ? "vulkan.shader_float16 says that the device was created without "
                         "shaderFloat16"
                       : "the device does not offer shaderFloat16");
    }
    int wished =
        forced || (desc->half_floats == MASU_AUTO && desc->vulkan.shader_float16 && is_gpu(vk));
    if (!used || !wished) desc->half_floats = MASU_OFF;
    return MASU_OK;
}

/* Linear filtering of 16-bit unorm is optional in Vulkan 1.1, although few devices lack it. */
static int filters_unorm16(const masu_vk *vk) {
    VkFormatFeatureFlags wanted =
        VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    VkFormatProperties p;
    memset(&p, 0, sizeof p);
    vk->GetPhysicalDeviceFormatProperties(vk->physical, VK_FORMAT_R16G16B16A16_UNORM, &p);
    return (p.optimalTilingFeatures & wanted) == wanted;
}

/* Vulkan guarantees four storage buffers per stage. If a feature needs more than the device has,
 * rungs with MASU_AUTO omit the feature. */
static masu_result fit_buffers(masu_desc *desc, const masu_frame_plan *plan, uint32_t has,
                               uint32_t *dropped, masu_detail *detail) {
    masu_most plain = most_buffers(plan, MASU_BINDING_PLAIN);
    if (has < plain.buffers) return too_few("the scene", plain, has, detail);
    masu_result result = MASU_OK;
    if (plan->needs.bounce) {
        result = drop(desc, offsetof(masu_rung, bounce), "bounce",
                      most_buffers(plan, MASU_BINDING_BOUNCING), has, MASU_DROPPED_BOUNCE, dropped,
                      detail);
    }
    if (!result && plan->needs.reflections) {
        result = drop(desc, offsetof(masu_rung, specular), "specular",
                      most_buffers(plan, MASU_BINDING_TRACING), has, MASU_DROPPED_SPECULAR, dropped,
                      detail);
    }
    if (!result && plan->occlusion) {
        result = drop(desc, offsetof(masu_rung, occlusion), "occlusion",
                      most_buffers(plan, MASU_BINDING_CULLING), has, MASU_DROPPED_OCCLUSION,
                      dropped, detail);
    }
    return result;
}

/* Checks the ranges of storage buffers, which grow with the scene, and the largest dispatches. */
static masu_result check_ranges(const masu_frame_plan *plan, const VkPhysicalDeviceLimits *limits,
                                masu_detail *detail) {
    for (uint32_t i = 0; i < MASU_BUFFER_COUNT; i++) {
        const masu_buffer_plan *b = &plan->buffers[i];
        uint64_t bytes = b->stride ? b->stride : b->bytes;
        if (bytes <= limits->maxStorageBufferRange ||
            !(b->usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT))
            continue;
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxStorageBufferRange", bytes,
                         limits->maxStorageBufferRange,
                         "%s need a storage buffer of %llu bytes, the device has %u", b->name,
                         (unsigned long long)bytes, limits->maxStorageBufferRange);
    }
    /* Indirect dispatches put all tiles of a list along x. vk.c checks the dispatches over both
     * axes of an image. */
    uint64_t tiles = masu_most_tiles(plan);
    if (tiles > limits->maxComputeWorkGroupCount[0]) {
        return masu_fail(
            detail, MASU_ERROR_DEVICE, "maxComputeWorkGroupCount", tiles,
            limits->maxComputeWorkGroupCount[0],
            "output %ux%u has up to %llu tiles, a workgroup each, the device has %u workgroups",
            plan->desc.output.width, plan->desc.output.height, (unsigned long long)tiles,
            limits->maxComputeWorkGroupCount[0]);
    }
    uint32_t groups = (plan->scene.instances + 63) / 64;
    if (plan->occlusion && groups > limits->maxComputeWorkGroupCount[0]) {
        return masu_fail(detail, MASU_ERROR_DEVICE, "maxComputeWorkGroupCount", groups,
                         limits->maxComputeWorkGroupCount[0],
                         "culling %u instances takes %u workgroups, the device has %u",
                         plan->scene.instances, groups, limits->maxComputeWorkGroupCount[0]);
    }
    return MASU_OK;
}

/* Largest width and height that a shadow map may have. */
static uint32_t widest_map(const VkPhysicalDeviceLimits *limits) {
    uint32_t most = limits->maxImageDimension2D;
    if (most > limits->maxFramebufferWidth) most = limits->maxFramebufferWidth;
    return most < limits->maxFramebufferHeight ? most : limits->maxFramebufferHeight;
}

static masu_result check_shadow_map(const masu_frame_plan *plan, masu_detail *detail) {
    VkExtent2D map = masu_plan_extent(plan, MASU_EXTENT_SHADOW, plan->desc.output);
    uint32_t widest = map.width > map.height ? map.width : map.height;
    uint32_t most = plan->desc.deny.image_size;
    if (widest > most) {
        return masu_fail(
            detail, MASU_ERROR_DEVICE, "maxImageDimension2D", widest, most,
            "the shadow map's %u cascades of %u texels make an image of %ux%u, the "
            "device's may be %u",
            plan->cascades, plan->cascade_size, map.width, map.height, most);
    }
    return MASU_OK;
}

static masu_result too_many(const char *limit, const char *what, const char *pass, uint32_t needed,
                            uint32_t has, masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_DEVICE, limit, needed, has,
                     "the pass %s needs %u %s in a stage, the device has %u (%s)", pass, needed,
                     what, has, limit);
}

/* Every layout stays below the minima of the specification (tests/unit/test_needs.c), except for
 * storage buffers, which fit_buffers counts. A device below a minimum is rejected by name. */
static masu_result check_layouts(const masu_frame_plan *plan, const VkPhysicalDeviceLimits *limits,
                                 masu_detail *detail) {
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (!masu_first_rung(plan, p)) continue;
        masu_stage_needs n = masu_stage_needs_of(plan, p);
        const struct {
            const char *limit, *what;
            uint32_t needed, has;
        } rows[] = {
            {"maxPerStageDescriptorUniformBuffers", "uniform buffers", n.uniform_buffers,
             limits->maxPerStageDescriptorUniformBuffers},
            {"maxPerStageDescriptorSampledImages", "sampled images", n.sampled_images,
             limits->maxPerStageDescriptorSampledImages},
            {"maxPerStageDescriptorSamplers", "samplers", n.sampled_images,
             limits->maxPerStageDescriptorSamplers},
            {"maxPerStageDescriptorStorageImages", "storage images", n.storage_images,
             limits->maxPerStageDescriptorStorageImages},
            {"maxPerStageResources", "resources",
             n.uniform_buffers + n.storage_buffers + n.sampled_images + n.storage_images +
                 n.attachments,
             limits->maxPerStageResources}};
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            if (rows[i].needed > rows[i].has)
                return too_many(rows[i].limit, rows[i].what, masu_passes[p].name, rows[i].needed,
                                rows[i].has, detail);
        }
    }
    return MASU_OK;
}

static masu_result check_images(const masu_frame_plan *plan, const VkPhysicalDeviceLimits *limits,
                                masu_detail *detail) {
    for (uint32_t i = 1; i < MASU_IMAGE_COUNT; i++) {
        const masu_image_plan *image = &plan->images[i];
        uint32_t widest = image->width > image->height ? image->width : image->height;
        if (image->used && widest > limits->maxImageDimension2D) {
            return masu_fail(detail, MASU_ERROR_DEVICE, "maxImageDimension2D", widest,
                             limits->maxImageDimension2D,
                             "the image %s is %ux%u texels, the device's may be %u",
                             masu_images[i].name, image->width, image->height,
                             limits->maxImageDimension2D);
        }
    }
    return MASU_OK;
}

masu_result masu_capabilities_check(const masu_frame_plan *plan, const masu_vk *vk,
                                    masu_detail *detail) {
    const VkPhysicalDeviceLimits *limits = &vk->properties.limits;
    masu_result result = check_ranges(plan, limits, detail);
    if (!result) result = check_shadow_map(plan, detail);
    if (!result) result = check_images(plan, limits, detail);
    return result ? result : check_layouts(plan, limits, detail);
}

/* ---- Open choices ---------------------------------------------------------------------------- */

/* Copies the default rungs of the plan into `desc` if the host gave none, so that they can be
 * changed. If the costs of the rungs come from a measured ladder, costs that the host left at 0 are
 * replaced by those of this device class. Returns the name of the class in that case, else "". */
static const char *own_rungs(masu_desc *desc, const masu_frame_plan *plan,
                             masu_device_class device_class) {
    if (desc->rung_count) return "";
    const masu_governor_desc given = desc->governor;
    const masu_scene *scene = plan->desc.scene;
    const float *costs =
        plan->desc.ladder == MASU_ON ? masu_ladder_costs_on(scene, device_class) : NULL;
    const char *computed_for = "";
    desc->rung_count = plan->desc.rung_count;
    memcpy(desc->rungs, plan->desc.rungs, sizeof desc->rungs);
    memcpy(desc->flips, plan->desc.flips, sizeof desc->flips);
    memcpy(desc->governor.costs, plan->desc.governor.costs, sizeof desc->governor.costs);
    for (uint32_t r = 0; r < desc->rung_count && costs; r++) {
        if (given.costs[r] != 0.0f) continue;
        /* In the unit of the measured costs that the host sees. */
        const masu_ladder *l = masu_ladder_for(scene);
        desc->governor.costs[r] = costs[masu_ladder_kept(l, given.keep, r)] * l->ratios[0];
        computed_for = masu_device_class_name(device_class);
    }
    return computed_for;
}

int masu_few_registers(const VkPhysicalDeviceProperties *d) {
    return d->vendorID == MASU_VENDOR_ARM || d->vendorID == MASU_VENDOR_BROADCOM;
}

masu_result masu_capabilities_fit(masu_desc *desc, const masu_frame_plan *plan, const masu_vk *vk,
                                  const char **computed_for, masu_detail *detail) {
    const VkPhysicalDeviceLimits *limits = &vk->properties.limits;
    *computed_for = own_rungs(desc, plan, masu_device_class_of(&vk->properties));
    if (vk->queue_family.timestampValidBits == 0) desc->governor.wall_only = 1;
    uint32_t has = buffers_of(desc, limits);
    uint32_t dropped = 0;
    masu_result result = fit_buffers(desc, plan, has, &dropped, detail);
    desc->deny.storage_buffers = dropped ? has | dropped : 0; /* the plan prints it as the reason */
    uint32_t widest = widest_map(limits);
    if (!desc->deny.image_size || desc->deny.image_size > widest) desc->deny.image_size = widest;
    /* Fragment shaders store to no buffers or images, so their only outputs are attachments. */
    uint32_t attachments = limits->maxColorAttachments;
    if (attachments > limits->maxFragmentOutputAttachments)
        attachments = limits->maxFragmentOutputAttachments;
    if (attachments > limits->maxFragmentCombinedOutputResources)
        attachments = limits->maxFragmentCombinedOutputResources;
    if (!desc->deny.color_attachments || desc->deny.color_attachments > attachments)
        desc->deny.color_attachments = attachments;
    if (!result) result = choose_ray_query(desc, plan, vk, detail);
    if (!result) result = choose_half_floats(desc, vk, detail);
    if (!filters_unorm16(vk)) desc->deny.unorm16 = 1;
    /* The pass has 54 values for each thread to keep: 576 bytes or more of scratch on Mali and the
     * Raspberry Pi, at 5.7 times the cycles of EASU a pixel on a Mali-G610 (design/15-fsr1.md). */
    if (masu_few_registers(&vk->properties)) desc->deny.easu_twice = 1;
    if (desc->debug.share_rays == MASU_AUTO)
        desc->debug.share_rays = is_gpu(vk) ? MASU_ON : MASU_OFF;
    return result;
}

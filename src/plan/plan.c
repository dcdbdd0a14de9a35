/* plan.c: queries of a plan; see plan.h. compile.c creates plans. */
#include "plan/plan.h"

uint32_t masu_format_bytes(VkFormat format) {
    switch (format) {
    case VK_FORMAT_R16G16B16A16_SFLOAT:
    case VK_FORMAT_R16G16B16A16_UNORM:
    case VK_FORMAT_R32G32_UINT: return 8;
    case VK_FORMAT_R32G32B32A32_UINT:
    case VK_FORMAT_R32G32B32A32_SFLOAT: return 16;
    case VK_FORMAT_D16_UNORM: return 2;
    default: return 4;
    }
}

int masu_reads(const masu_frame_plan *plan, uint32_t pass, masu_image_id image) {
    const masu_rung_plan *rp = masu_first_rung(plan, pass);
    for (uint32_t a = 0; rp && a < rp->access_count[pass]; a++) {
        if (rp->access[pass][a].image == image && rp->access[pass][a].usage == MASU_READ) return 1;
    }
    return 0;
}

const masu_rung_plan *masu_first_rung(const masu_frame_plan *plan, uint32_t pass) {
    for (uint32_t r = 0; r < plan->desc.rung_count; r++) {
        if (masu_has_pass(&plan->rungs[r].active, pass)) return &plan->rungs[r];
    }
    return NULL;
}

/* ---- The shadow map -------------------------------------------------------------------------- */

/* Four cascades are arranged in a square, fewer in a column. If a column of three is too high for
 * the device, it becomes a square with an empty quarter. */
static uint32_t cascade_columns(const masu_frame_plan *plan) {
    uint32_t most = plan->desc.deny.image_size;
    int is_high = plan->cascades == 3 && most && 3 * plan->cascade_size > most;
    return plan->cascades == 4 || is_high ? 2 : 1;
}

VkOffset2D masu_cascade_place(const masu_frame_plan *plan, uint32_t cascade) {
    uint32_t columns = cascade_columns(plan);
    return (VkOffset2D){(int32_t)(cascade % columns * plan->cascade_size),
                        (int32_t)(cascade / columns * plan->cascade_size)};
}

/* ---- Shadows of local lights ----------------------------------------------------------------- */

#define FACES_ACROSS 4u

VkOffset2D masu_local_face_place(const masu_frame_plan *plan, uint32_t face) {
    return (VkOffset2D){(int32_t)(face % FACES_ACROSS * plan->local_tile),
                        (int32_t)(face / FACES_ACROSS * plan->local_tile)};
}

VkExtent2D masu_plan_extent(const masu_frame_plan *plan, masu_image_extent extent,
                            VkExtent2D render) {
    uint32_t columns = cascade_columns(plan);
    if (extent == MASU_EXTENT_HALF && plan->desc.debug.ao_full) return render;
    int traced = extent == MASU_EXTENT_TRACED || extent == MASU_EXTENT_GLOSSY;
    if (traced && plan->desc.debug.reference) return render;
    if (extent == MASU_EXTENT_TEXTURES)
        return plan->needs.texture_writes ? plan->desc.reserve.texture_size : (VkExtent2D){1, 1};
    if (extent == MASU_EXTENT_LOCAL_ATLAS)
        return (VkExtent2D){plan->local_atlas, plan->local_atlas};
    if (extent == MASU_EXTENT_LOCAL_PAIRS)
        return (VkExtent2D){plan->local_atlas / 2, plan->local_atlas};
    if (extent == MASU_EXTENT_LOCAL_FACES) {
        uint32_t across = plan->local_faces < FACES_ACROSS ? plan->local_faces : FACES_ACROSS;
        return (VkExtent2D){across * plan->local_tile, (plan->local_faces + FACES_ACROSS - 1) /
                                                           FACES_ACROSS * plan->local_tile};
    }
    if (extent != MASU_EXTENT_SHADOW) return masu_extent_of(extent, render, plan->desc.output);
    return (VkExtent2D){columns * plan->cascade_size,
                        (plan->cascades + columns - 1) / columns * plan->cascade_size};
}

uint32_t masu_recording_variant(const masu_rung_plan *rung, uint32_t drawn) {
    uint32_t variant = 0, bit = 0;
    for (uint32_t k = 0; k < rung->cascades; k++) {
        if (rung->slow & 1u << k) variant |= (drawn >> k & 1u) << bit++;
    }
    return rung->faces ? variant | (drawn >> MASU_DRAWN_FACES & 1u) << bit : variant;
}

int masu_variant_draws(const masu_rung_plan *rung, uint32_t variant, uint32_t what) {
    uint32_t only = 1u << what;
    if (what == MASU_DRAWN_FACES)
        return rung->faces && (masu_recording_variant(rung, only) & variant) != 0;
    if (what >= rung->cascades) return 0;
    return !(rung->slow & only) || (masu_recording_variant(rung, only) & variant) != 0;
}

int masu_has_half_means(const masu_frame_plan *plan) {
    return plan->desc.deny.unorm16 || plan->desc.targets.encoding != MASU_ENCODING_SRGB;
}

VkFormat masu_plan_format(const masu_frame_plan *plan, uint32_t image) {
    const masu_image_row *row = &masu_images[image];
    int color = row->class_of == MASU_CLASS_COLOR && row->format != VK_FORMAT_UNDEFINED;
    if (row->format == VK_FORMAT_R16G16B16A16_UNORM && masu_has_half_means(plan))
        return VK_FORMAT_R16G16B16A16_SFLOAT;
    return color && plan->deep ? VK_FORMAT_R16G16B16A16_SFLOAT : row->format;
}

VkFormat masu_plan_store_format(const masu_frame_plan *plan, uint32_t image) {
    VkFormat format = masu_plan_format(plan, image);
    if (masu_images[image].format == VK_FORMAT_R16G16B16A16_UNORM) return VK_FORMAT_R32G32_UINT;
    return format == VK_FORMAT_A2B10G10R10_UNORM_PACK32 || format == VK_FORMAT_R8G8B8A8_SRGB
               ? VK_FORMAT_R32_UINT
               : format;
}

uint32_t masu_plan_layers(const masu_frame_plan *plan, uint32_t image) {
    uint32_t layers = masu_images[image].layers, textures = plan->desc.reserve.textures;
    return layers ? layers : textures ? textures : 1;
}

int masu_comes_last(const masu_rung_plan *rung, uint32_t pass) {
    for (uint32_t a = 0; a < rung->access_count[pass]; a++) {
        masu_access access = rung->access[pass][a];
        int ends = access.image == MASU_IMAGE_TARGET || access.image == MASU_IMAGE_FINAL;
        if (ends && (access.usage == MASU_WRITE || access.usage == MASU_UPDATE)) return 1;
    }
    return 0;
}

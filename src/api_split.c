/* api_split.c: masu_split_of and masu_frame_view_of: images, layouts and matrices for commands that
 * the host submits between the parts of a frame. The split points are rows of passes.inc, whose
 * accesses list the images. */
#include "base/error.h"
#include "device/barriers.h"
#include "plan/desc.h"
#include "renderer.h"

#include <string.h>

/* An image with the layout in which its row passes it to the host. */
static masu_split_image image_of(const masu_device *m, masu_access access, VkExtent2D render,
                                 VkExtent2D output) {
    const masu_frame_plan *plan = m->plan;
    uint32_t id = access.image;
    if (id == MASU_IMAGE_TARGET) { /* owned by the host: see barriers.c */
        return (masu_split_image){.format = plan->desc.targets.format,
                                  .layout = VK_IMAGE_LAYOUT_GENERAL,
                                  .image_width = plan->whole.width,
                                  .image_height = plan->whole.height,
                                  .width = output.width,
                                  .height = output.height};
    }
    const masu_image_plan *image = &plan->images[id];
    VkExtent2D size = masu_extent_of(masu_images[id].extent, render, output);
    return (masu_split_image){.image = m->objects.images[id],
                              .view = m->views[id],
                              .format = masu_plan_format(plan, id),
                              .usage = image->usage,
                              .layout =
                                  masu_use_of((masu_usage)access.usage, MASU_PASS_HOST).layout,
                              .image_width = image->width,
                              .image_height = image->height,
                              .width = size.width,
                              .height = size.height};
}

static masu_split_image *place_of(masu_split *split, masu_access access) {
    if (access.usage == MASU_HOST_DEPTH) return &split->depth;
    if (access.usage == MASU_HOST_COLOR) return &split->color;
    return access.image == MASU_IMAGE_HDR ? &split->hdr : &split->velocity;
}

static masu_result check(masu_renderer *m, masu_split_bits which, uint32_t rung,
                         uint32_t viewport) {
    const masu_desc *d = &m->plan.desc;
    uint32_t viewports = d->viewport_count ? d->viewport_count : 1;
    int point = which == MASU_SPLIT_BEFORE_TONE || which == MASU_SPLIT_AFTER_UPSCALE;
    if (!point || !(d->split & (uint32_t)which)) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "which", d->split, (unsigned)which,
                         "which is %u: one of MASU_SPLIT_BEFORE_TONE (1), MASU_SPLIT_AFTER_UPSCALE "
                         "(2) that is in "
                         "desc.split, which is %u",
                         (unsigned)which, d->split);
    }
    if (rung >= d->rung_count) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "rung", d->rung_count - 1, rung,
                         "rung %u does not exist, the last one is %u", rung, d->rung_count - 1);
    }
    if (viewport < viewports) return MASU_OK;
    return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "viewport", viewports - 1, viewport,
                     "viewport %u does not exist, the last one is %u", viewport, viewports - 1);
}

masu_result masu_split_of(masu_renderer *m, masu_split_bits which, uint32_t rung, uint32_t viewport,
                          masu_split *out, masu_detail *detail) {
    if (!m || !out) return masu_finish_null(m, "out", detail);
    masu_result result = check(m, which, rung, viewport);
    if (result) return masu_finish(m, result, detail);
    masu_desc d = m->plan.desc;
    d.output = m->plan.whole;
    if (d.viewport_count)
        d.output = (VkExtent2D){d.viewports[viewport].width, d.viewports[viewport].height};
    VkExtent2D render = masu_render_size(&d, rung);
    uint32_t pass = which == MASU_SPLIT_BEFORE_TONE ? MASU_PASS_SPLIT_TONE : MASU_PASS_SPLIT_OUTPUT;
    const masu_rung_plan *rp = &m->plan.rungs[rung];
    memset(out, 0, sizeof *out);
    out->part = which == MASU_SPLIT_AFTER_UPSCALE && (d.split & MASU_SPLIT_BEFORE_TONE);
    for (uint32_t a = 0; a < rp->access_count[pass]; a++)
        *place_of(out, rp->access[pass][a]) =
            image_of(&m->device, rp->access[pass][a], render, d.output);
    out->swapped =
        which == MASU_SPLIT_AFTER_UPSCALE && (m->plan.output.flags & MASU_OUTPUT_SWAP) != 0;
    return MASU_OK;
}

masu_result masu_frame_view_of(const masu_renderer *m, masu_frame_view *out, masu_detail *detail) {
    masu_detail own;
    if (!m || !out) return masu_finish_null_const(m, "out", detail);
    if (!m->view.render_width) {
        masu_fail(&own, MASU_ERROR_STATE, "frame", 1, 0, "there is no frame of a scene yet");
        return masu_finish_desc(&m->plan.desc, own.result, &own, detail);
    }
    *out = m->view;
    return MASU_OK;
}

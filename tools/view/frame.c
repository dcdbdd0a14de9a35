/* frame.c: renders one frame to the window: acquire an image, record and submit, present. Two
 * frames are in flight; a slot's fence is waited for before the slot is reused. */
#include "view/viewer.h"

#include "clock.h"
#include "image.h"
#include "measure/linear.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool vulkan_failed(masu_viewer *v, const char *call, VkResult r) {
    if (r == VK_ERROR_DEVICE_LOST) v->lost = true;
    return masu_headless_fail(v->error, sizeof v->error, call, r);
}

static bool masu_failed(masu_viewer *v) {
    if (v->detail.result == MASU_ERROR_DEVICE_LOST) v->lost = true;
    snprintf(v->error, sizeof v->error, "%s", v->detail.text);
    return false;
}

/* The governor receives a wall-clock time only if this call observed the end of the frame. A fence
 * that was already signalled does not reveal when the frame ended. */
static bool wait_for_slot(masu_viewer *v, uint32_t slot) {
    if (!v->pending[slot]) return true;
    bool seen = vkGetFenceStatus(v->host.device, v->fences[slot]) == VK_NOT_READY;
    VkResult r = masu_headless_wait_fence(&v->host, v->fences[slot]);
    uint64_t now = masu_clock_ns(NULL);
    if (r == VK_TIMEOUT) masu_viewer_give_up(v);
    if (r) return vulkan_failed(v, "vkWaitForFences", r);
    r = vkResetFences(v->host.device, 1, &v->fences[slot]);
    if (r) return vulkan_failed(v, "vkResetFences", r);
    v->pending[slot] = false;
    v->losses = 0;
    if (v->slot_known[slot]) {
        uint64_t begin =
            v->submitted_ns[slot] > v->finished_ns ? v->submitted_ns[slot] : v->finished_ns;
        if (seen && v->show == MASU_SHOW_A && !v->scripted)
            masu_frame_wall(v->a.m, v->slot_of_a[slot], (double)(now - begin) / 1e6);
        (void)masu_stats(v->a.m, v->slot_of_a[slot], &v->stats, NULL);
        masu_pick_take(v, slot);
    }
    v->finished_ns = now;
    return true;
}

static bool let_draw(masu_viewer *v, uint32_t slot) {
    masu_camera camera;
    masu_viewer_camera(v, &camera);
    masu_frame_desc frame = {MASU_FRAME_DESC,
                             .camera = &camera,
                             .time = v->time,
                             .time_step = v->time_step,
                             .rung = v->governed ? MASU_RUNG_AUTO : v->rung,
                             .cut = v->cut};
    masu_pick_ask(v, &frame);
    if (!masu_look_apply(v, v->a.m, &frame)) return masu_failed(v);
    if (masu_frame(v->a.m, &frame, &v->a.last, &v->detail)) return masu_failed(v);
    v->slot_of_a[slot] = v->a.last.slot;
    v->slot_known[slot] = true;
    masu_pick_asked(v, slot);
    if (v->governed) v->rung = v->a.last.rung;
    if (v->show == MASU_SHOW_A) return true;
    frame.rung = 0;
    frame.pick = 0;
    if (!masu_look_apply(v, v->b.m, &frame)) return masu_failed(v);
    return masu_frame(v->b.m, &frame, &v->b.last, &v->detail) == MASU_OK || masu_failed(v);
}

static void draw_ui(masu_viewer *v) {
    masu_ui_begin(v->turn_seconds);
    masu_panels_draw(v);
    masu_ui_end();
}

static bool submit(masu_viewer *v, uint32_t slot, uint32_t image) {
    const masu_composition what = {.a = v->a.m ? &v->a.target : NULL,
                                   .b = v->show == MASU_SHOW_SPLIT ? &v->b.target : NULL,
                                   .split = (uint32_t)(v->split * v->a.target.width + 0.5),
                                   .map = v->show == MASU_SHOW_MAP && v->difference.known};
    if (!masu_compose_record(&v->compose, slot, &what, v->window.images[image], v->window.extent,
                             v->error, sizeof v->error)) {
        return false;
    }
    VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    VkCommandBuffer drawn[2] = {v->a.last.buffer, v->b.last.buffer};
    VkSubmitInfo submits[2] = {{.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                .commandBufferCount = !v->a.m ? 0 : v->show == MASU_SHOW_A ? 1 : 2,
                                .pCommandBuffers = drawn},
                               {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO,
                                .waitSemaphoreCount = 1,
                                .pWaitSemaphores = &v->window.acquired[slot],
                                .pWaitDstStageMask = &stage,
                                .commandBufferCount = 1,
                                .pCommandBuffers = &v->compose.commands[slot],
                                .signalSemaphoreCount = 1,
                                .pSignalSemaphores = &v->window.finished[image]}};
    v->submitted_ns[slot] = masu_clock_ns(NULL);
    VkResult r = v->lose ? VK_ERROR_DEVICE_LOST
                         : vkQueueSubmit(v->host.queue, 2, submits, v->fences[slot]);
    v->lose = false;
    if (r) return vulkan_failed(v, "vkQueueSubmit", r);
    v->pending[slot] = true;
    return true;
}

bool masu_viewer_frame(masu_viewer *v) {
    uint32_t slot = (uint32_t)(v->frames % MASU_WINDOW_FLIGHT), image = 0;
    if (!wait_for_slot(v, slot)) return false;
    VkResult r = masu_window_acquire(&v->window, slot, &image);
    if (r == VK_TIMEOUT || r == VK_NOT_READY || r == VK_ERROR_OUT_OF_DATE_KHR) {
        v->window.stale = true; /* nothing was drawn; the next iteration recreates the swapchain */
        return true;
    }
    if (r) return vulkan_failed(v, "vkAcquireNextImageKHR", r);
    v->slot_known[slot] = false;
    if (v->a.m && !let_draw(v, slot)) return false;
    draw_ui(v);
    if (!submit(v, slot, image)) return false;
    v->cut = false;
    v->frames++;
    r = masu_window_present(&v->window, image);
    return !r || r == VK_ERROR_OUT_OF_DATE_KHR || vulkan_failed(v, "vkQueuePresentKHR", r);
}

/* Saves the HDR image of A's last frame, without the viewer's overlay. */
static bool save_linear(masu_viewer *v, const char *path) {
    const masu_plan_rung *rung = &v->plan.rungs[v->a.last.rung];
    VkExtent2D size = {rung->render_width, rung->render_height};
    float *linear = malloc(3 * sizeof *linear * size.width * size.height);
    masu_viewer_settle(v);
    bool good = linear && masu_linear_read(v->a.m, v->a.last.slot, size, linear);
    if (!good) snprintf(v->error, sizeof v->error, "%s: no linear light to read back", path);
    good = good &&
           masu_image_save_linear(path, linear, size.width, size.height, v->error, sizeof v->error);
    free(linear);
    return good;
}

bool masu_viewer_screenshot(masu_viewer *v, const char *path, bool clean) {
    masu_headless_target *t = clean && v->a.m ? &v->a.target : &v->compose.shown;
    if (!v->frames) {
        snprintf(v->error, sizeof v->error, "%s: no frame is rendered yet", path);
        return false;
    }
    if (masu_image_is_linear(path)) return save_linear(v, path);
    return masu_headless_target_read(&v->host, t, v->error, sizeof v->error) &&
           masu_image_save_png(path, t->mapped, t->width, t->height, 0, v->error, sizeof v->error);
}

/* viewer.c: see viewer.h. Creates and destroys the viewer's objects, and loads scenes. */
#include "view/viewer.h"

#include "cli/cli.h"
#include "settings/setting.h"
#include "clock.h"
#include "file_kind.h"
#include "image.h"
#include "session.h"
#include "view/stage.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SCENE_BYTES_MAX ((size_t)2 << 30)

void masu_viewer_note(masu_viewer *v, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(v->note, sizeof v->note, format, arguments);
    va_end(arguments);
    v->note_turn = v->turns;
}

/* Ends the process: objects that the GPU still uses cannot be destroyed, and it may never
 * finish. */
void masu_viewer_give_up(const masu_viewer *v) {
    (void)masu_cli_error("the GPU did not finish within %u s",
                         (unsigned)(v->host.wait_ns / 1000000000u));
    fflush(NULL);
    _Exit(MASU_CLI_FAILURE);
}

void masu_viewer_settle(masu_viewer *v) {
    if (!v->host.device) return;
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++)
        if (v->pending[i] && masu_headless_wait_fence(&v->host, v->fences[i]) == VK_TIMEOUT)
            masu_viewer_give_up(v);
    if (vkDeviceWaitIdle(v->host.device) == VK_ERROR_DEVICE_LOST) v->lost = true;
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++) v->slot_known[i] = false;
}

/* ---- Scene ----------------------------------------------------------------------------------- */

static bool read_scene(masu_viewer *v, const char *path, void **blob, masu_scene *scene) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    masu_detail detail = {0};
    if (!masu_file_read(path, SCENE_BYTES_MAX, &bytes, &count, v->error, sizeof v->error))
        return false;
    if (masu_scene_bind(bytes, count, scene, &detail)) {
        snprintf(v->error, sizeof v->error, "%s: %s%s", path, detail.text,
                 masu_file_hint(path, bytes, count, MASU_FILE_BLOB));
        free(bytes);
        return false;
    }
    *blob = bytes;
    return true;
}

/* Uses the camera path if there is one, else a camera a few metres from the origin, facing it. */
static void place_camera(masu_viewer *v) {
    v->time = v->o->time;
    v->path_end = masu_fly_path_end(v->a.m);
    masu_camera camera = {
        .position = {0.0, 1.7, 6.0}, .forward = {0.0f, -0.1f, -1.0f}, .fov_y = 1.0f};
    bool has = masu_scene_count(&v->scene, MASU_SCENE_CAMERA_KEY) &&
               masu_camera_at(v->a.m, v->time, &camera, NULL) == MASU_OK;
    masu_fly_from(&v->fly, &camera);
    v->on_path = has;
}

/* The name that masu bench uses, without knobs that have no effect, such as the sharpness of an
 * unscaled rung. */
void masu_viewer_setting(const masu_viewer *v, const masu_rung *rung, char out[MASU_SETTING_ID]) {
    char error[256];
    masu_rung base, shown = *rung;
    if (!(shown.scale > 0.0f)) shown.scale = 1.0f;
    if (masu_setting_parse("base", &base, error, sizeof error)) {
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            if (masu_knob_useless(k, &shown, &v->scene, &v->plan)) masu_knob_copy(k, &shown, &base);
        }
    }
    masu_setting_name(&shown, out);
}

/* ---- Stages ---------------------------------------------------------------------------------- */

/* Fills in the members that depend on device and window. */
static void complete(masu_viewer *v, masu_desc *d) {
    const masu_headless *h = &v->host;
    d->vulkan = (masu_vulkan){.get_instance_proc_addr = h->desc.get_instance_proc_addr,
                              .instance = h->instance,
                              .physical_device = h->physical,
                              .device = h->device,
                              .queue_family = h->family,
                              .pipeline_cache = v->cache,
                              .pipelines = &v->pools[0],
                              .texture_compression_bc = h->compressed,
                              .max_anisotropy = h->usual_anisotropy,
                              .ray_query = h->ray_query,
                              .shader_float16 = h->float16};
    d->scene = &v->scene;
    d->output = v->window.extent;
    if (!d->output.width) /* minimised: keep the last size */
        d->output = (VkExtent2D){v->a.target.width, v->a.target.height};
    d->resizable = 1;
    d->frames_in_flight = MASU_WINDOW_FLIGHT;
    d->debug.labels = h->labels;
    d->clock_ns = masu_clock_ns;
    for (uint32_t r = 0; r < d->rung_count; r++) { /* unnamed knobs are off, with the governor
                                                    * too */
        if (d->rungs[r].temporal == MASU_AUTO) d->rungs[r].temporal = MASU_OFF;
    }
}

static bool stage_failed(masu_viewer *v, const masu_stage *s) {
    bool gone =
        s->detail.result == MASU_ERROR_DEVICE_LOST || s->detail.vulkan == VK_ERROR_DEVICE_LOST;
    if (gone || v->host.lost) v->lost = true;
    return false;
}

static bool start_b(masu_viewer *v) {
    masu_desc d = v->want;
    complete(v, &d);
    d.vulkan.pipelines = &v->pools[1];
    d.rung_count = 1;
    d.rungs[0] = v->reference;
    memset(&d.governor, 0, sizeof d.governor);
    v->cut = true;
    v->difference.known = false;
    return masu_stage_start(&v->b, &v->host, &d, v->error, sizeof v->error) ||
           stage_failed(v, &v->b);
}

static bool start_a(masu_viewer *v) {
    masu_desc d = v->want;
    complete(v, &d);
    d.picking = 1;
    if (v->o->screenshot && masu_image_is_linear(v->o->screenshot)) d.readback = MASU_READBACK_HDR;
    v->cut = true;
    v->difference.known = false;
    v->picked.text[0] = '\0';
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT; i++) v->slot_known[i] = false;
    if (!masu_stage_start(&v->a, &v->host, &d, v->error, sizeof v->error))
        return stage_failed(v, &v->a);
    masu_plan_of(v->a.m, &v->plan);
    memset(&v->stats, 0, sizeof v->stats);
    if (v->rung >= d.rung_count) v->rung = d.rung_count - 1;
    return true;
}

bool masu_viewer_restart(masu_viewer *v) {
    masu_desc before = v->a.desc;
    masu_viewer_settle(v);
    if (start_a(v)) return v->show == MASU_SHOW_A || start_b(v);
    if (v->lost) return false;
    /* The new setting was rejected, or failed midway: return to the previous one, which works. */
    snprintf(v->trouble, sizeof v->trouble, "%s", v->error);
    memcpy(v->want.rungs, before.rungs, sizeof before.rungs);
    v->want.governor = before.governor;
    return v->a.m ? true : start_a(v);
}

bool masu_viewer_show(masu_viewer *v, uint32_t show) {
    uint32_t before = v->show;
    v->show = show;
    if ((before == MASU_SHOW_A) == (show == MASU_SHOW_A)) return true;
    masu_viewer_settle(v);
    if (show == MASU_SHOW_A) {
        masu_stage_close(&v->b);
        return true;
    }
    if (start_b(v)) return true;
    if (v->lost) return false;
    snprintf(v->trouble, sizeof v->trouble, "B: %.1000s", v->error);
    masu_stage_close(&v->b);
    v->show = MASU_SHOW_A;
    return true;
}

/* Resizes in place if the planned size allows it, else restarts. */
static bool resize_stages(masu_viewer *v, VkExtent2D now) {
    v->cut = true;
    v->difference.known = false;
    bool kept = masu_stage_resize(&v->a, now, v->error, sizeof v->error);
    if (kept) masu_plan_of(v->a.m, &v->plan);
    if (!kept && !start_a(v)) return false;
    masu_viewer_note(v, "%ux%u in %.0f ms, %s", now.width, now.height, v->a.start_ms,
                     kept            ? "no pipeline rebuilt"
                     : v->a.in_place ? "rebuilt in the same blocks"
                                     : "rebuilt in larger blocks");
    if (v->show == MASU_SHOW_A) return true;
    return masu_stage_resize(&v->b, now, v->error, sizeof v->error) || start_b(v);
}

bool masu_viewer_resize(masu_viewer *v) {
    masu_viewer_settle(v);
    if (!masu_window_swapchain(&v->window, !v->o->no_vsync, v->error, sizeof v->error)) {
        v->lost = v->lost || strstr(v->error, "device lost");
        return false;
    }
    VkExtent2D now = v->window.extent;
    const masu_headless_target *is = &v->compose.shown;
    if (!now.width || (is->width == now.width && is->height == now.height)) return true;
    if (!masu_compose_resize(&v->compose, now, v->error, sizeof v->error) ||
        !masu_viewer_attach_ui(v))
        return false;
    return !v->blob || (v->a.m ? resize_stages(v, now) : start_a(v));
}

bool masu_viewer_attach_ui(masu_viewer *v) {
    const masu_headless *h = &v->host;
    const masu_ui_device d = {.instance = h->instance,
                              .physical = h->physical,
                              .device = h->device,
                              .family = h->family,
                              .queue = h->queue,
                              .pool = h->pool,
                              .view = v->compose.shown.view,
                              .extent = v->window.extent,
                              .flight = MASU_WINDOW_FLIGHT};
    v->gallery.stale = false;
    return masu_ui_attach(&d, (const uint8_t *const *)v->gallery.pictures, v->gallery.count,
                          v->error, sizeof v->error);
}

/* Sets v->want from the command line, or the ladder of the scene. A value equal to the default
 * becomes 0, as in the base of setting names. Exception: scale, which is 1 in the base. */
static void want_given(masu_viewer *v) {
    v->want = v->given;
    v->want.scene = &v->scene;
    v->want = masu_session_resolved(&v->want);
    for (uint32_t r = 0; r < v->want.rung_count; r++) {
        masu_desc plain = v->want; /* the defaults of a rung of this scale */
        plain.rung_count = 1;
        plain.rungs[0] = (masu_rung){.scale = v->want.rungs[r].scale};
        plain.governor.mode = MASU_GOVERNOR_OFF; /* setting names are those of masu bench, which
                                                  * measures without */
        plain = masu_session_resolved(&plain);
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            if (!strcmp(k->name, "scale")) continue;
            for (uint32_t i = 0; i < k->values; i++) {
                if (masu_knob_get(k, &v->want.rungs[r], i) == masu_knob_get(k, &plain.rungs[0], i))
                    masu_knob_set(k, &v->want.rungs[r], i, 0.0);
            }
        }
    }
}

/* Resets the viewer's state for a newly opened scene. */
static void begin_scene(masu_viewer *v) {
    char title[300];
    v->rung = v->o->rung_given ? v->o->rung : 0;
    if (v->rung >= v->want.rung_count) v->rung = v->want.rung_count - 1;
    v->governed = !v->o->rung_given && v->want.governor.mode != MASU_GOVERNOR_OFF;
    v->reference = v->want.rungs[0];
    v->recorder.count = 0;
    v->recorder.records = v->recorder.plays = false;
    place_camera(v);
    masu_look_reset(v);
    snprintf(title, sizeof title, "masu: %.290s",
             *v->baker.source ? v->baker.source : v->baker.blob);
    SDL_SetWindowTitle(v->window.sdl, title);
}

bool masu_viewer_load(masu_viewer *v, const char *path, bool fresh) {
    void *blob = NULL;
    masu_scene scene;
    if (!read_scene(v, path, &blob, &scene)) {
        snprintf(v->trouble, sizeof v->trouble, "%s", v->error);
        return true;
    }
    void *old_blob = v->blob;
    masu_scene old = v->scene;
    masu_desc old_want = v->want;
    bool same_class = old_blob && masu_scene_class_of(&scene) == masu_scene_class_of(&old);
    v->blob = blob;
    v->scene = scene;
    if (!same_class || fresh) want_given(v); /* rungs are measured per class */
    if (!v->host.device) return true;        /* the program's first scene */
    if (v->rung >= v->want.rung_count) v->rung = v->want.rung_count - 1;
    masu_viewer_settle(v);
    if (start_a(v)) {
        free(old_blob);
        v->trouble[0] = '\0';
        if (fresh) {
            begin_scene(v);
            return v->show == MASU_SHOW_A || start_b(v);
        }
        masu_look_keep(v);
        v->path_end = masu_fly_path_end(v->a.m);
        if (!masu_scene_count(&scene, MASU_SCENE_CAMERA_KEY)) v->on_path = false;
        masu_viewer_note(v, "reloaded in %.0f ms %s", v->a.start_ms,
                         v->a.in_place ? "in the same blocks" : "in larger blocks");
        return v->show == MASU_SHOW_A || start_b(v);
    }
    free(blob);
    v->blob = old_blob;
    v->scene = old;
    v->want = old_want;
    if (v->lost) return false;
    snprintf(v->trouble, sizeof v->trouble, "%s", v->error);
    return v->a.m || !v->blob ? true : start_a(v);
}

/* ---- Device ---------------------------------------------------------------------------------- */

static bool open_device(masu_viewer *v) {
    if (!masu_window_attach(&v->window, &v->o->host, &v->host, v->error, sizeof v->error))
        return false;
    VkPipelineCacheCreateInfo cache = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO};
    VkResult r = vkCreatePipelineCache(v->host.device, &cache, NULL, &v->cache);
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT && !r; i++) {
        VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        r = vkCreateFence(v->host.device, &fence, NULL, &v->fences[i]);
        v->pending[i] = false;
    }
    if (r) return masu_headless_fail(v->error, sizeof v->error, "vkCreateFence", r);
    if (!masu_compose_open(&v->compose, &v->host, v->cache, v->error, sizeof v->error))
        return false;
    /* A window that opens minimised has no size yet. */
    for (int i = 0; i < 100; i++) {
        if (!masu_viewer_resize(v)) return false;
        if (v->window.extent.width) return true;
        SDL_PumpEvents();
        SDL_Delay(50);
    }
    snprintf(v->error, sizeof v->error, "no window: its size is 0");
    return false;
}

static void close_device(masu_viewer *v) {
    masu_viewer_settle(v);
    masu_desc d = {.rung_count = 0};
    complete(v, &d);
    masu_stage_close(&v->a);
    masu_stage_close(&v->b);
    for (int i = 0; i < 2 && v->host.device; i++) masu_pipelines_destroy(&d.vulkan, &v->pools[i]);
    masu_ui_detach();
    masu_compose_close(&v->compose);
    for (uint32_t i = 0; i < MASU_WINDOW_FLIGHT && v->host.device; i++) {
        vkDestroyFence(v->host.device, v->fences[i], NULL);
        v->fences[i] = VK_NULL_HANDLE;
    }
    if (v->host.device) vkDestroyPipelineCache(v->host.device, v->cache, NULL);
    v->cache = VK_NULL_HANDLE;
    masu_window_detach(&v->window);
    masu_headless_close(&v->host);
}

bool masu_viewer_recover(masu_viewer *v) {
    uint32_t messages = v->host.messages;
    close_device(v);
    v->lost = false;
    if (!open_device(v)) return false;
    v->host.messages += messages;
    return v->show == MASU_SHOW_A || start_b(v);
}

/* Files are loaded first, so that their errors are reported before a window opens. */
bool masu_viewer_open(masu_viewer *v) {
    masu_ui_open();
    if (!masu_baker_start(v)) return false;
    if (*v->trouble) {
        snprintf(v->error, sizeof v->error, "%s", v->trouble);
        return false;
    }
    if (v->blob && v->o->rung >= v->want.rung_count) {
        snprintf(v->error, sizeof v->error, "--rung: expected 0 to %u, found %u",
                 v->want.rung_count - 1, v->o->rung);
        return false;
    }
    v->rung = v->o->rung;
    if (!masu_window_open(&v->window, "masu", v->o->size, v->error, sizeof v->error) ||
        !open_device(v))
        return false;
    if (v->a.m) begin_scene(v);
    return true;
}

void masu_viewer_close(masu_viewer *v) {
    masu_difference_close(&v->difference);
    masu_baker_close(&v->baker);
    masu_capture_close(v);
    close_device(v);
    masu_gallery_close(&v->gallery);
    masu_ui_close();
    free(v->blob);
    v->blob = NULL;
    masu_window_close(&v->window);
}

void masu_viewer_camera(const masu_viewer *v, masu_camera *out) {
    if (masu_capture_camera(v, out)) return;
    if (!v->on_path || masu_camera_at(v->a.m, v->time, out, NULL)) masu_fly_camera(&v->fly, out);
}

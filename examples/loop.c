/* loop.c SCENE.masu [SCRIPT]: a scene in a window, at the rung that keeps 16.7 ms. For a new window
 * size it calls masu_resize if the size is within the plan, otherwise masu_destroy and masu_init in
 * a larger block. With a script (shared/script.h) the validation layer is enabled. LOOP_SURFACE in
 * the environment may contain "srgb" (an sRGB swapchain) and "unpaced" (MAILBOX or IMMEDIATE). */
#include "masu.h"
#include "overlay.h"
#include "script.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct view {
    window window;
    overlay overlay;
    masu_scene scene;
    void *blob, *block;
    masu_renderer *m;
    uint64_t frame; /* since masu_init, which resets the slots */
    script script;
    uint32_t frames, rungs; /* total; one bit per rung that was used */
    int resizes, inits;
} view;

static bool failed(const masu_detail *detail) {
    return fprintf(stderr, "loop: %s\n", detail->text), false;
}

static bool read_scene(view *v, const char *path) {
    masu_detail detail = {0};
    size_t bytes = 0;
    v->blob = SDL_LoadFile(path, &bytes);
    if (!v->blob) return fprintf(stderr, "loop: %s\n", SDL_GetError()), false;
    return masu_scene_bind(v->blob, bytes, &v->scene, &detail) == MASU_OK || failed(&detail);
}

static masu_desc describe(view *v) {
    return (masu_desc){MASU_DESC,
                       .vulkan = window_vulkan(&v->window),
                       .scene = &v->scene,
                       .output = v->window.size,
                       .targets = window_targets(&v->window),
                       .frames_in_flight = WINDOW_SLOTS,
                       .ladder = MASU_ON, /* the rungs measured for scenes of this class */
                       .resizable = 1,
                       .governor = {.mode = MASU_GOVERNOR_ON}};
}

/* Creates a renderer for the current size of the window. It inherits the previous renderer's
 * governor state. */
static bool build(view *v) {
    masu_governor_state learnt;
    masu_detail detail = {0};
    masu_memory need;
    masu_commands load;
    masu_result result;
    masu_desc desc = describe(v);
    bool knows = v->m && masu_governor_save(v->m, &learnt, NULL) == MASU_OK;
    masu_destroy(v->m);
    free(v->block);
    v->m = NULL, v->block = NULL, v->frame = 0, v->inits++;
    if (masu_memory_query(&desc, &need, &detail)) return failed(&detail);
    v->block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    if (!v->block)
        return fprintf(stderr, "loop: out of memory for %llu bytes\n",
                       (unsigned long long)need.host_bytes),
               false;
    if (masu_init(&desc, v->block, need.host_bytes, &v->m, &detail)) return failed(&detail);
    while ((result = masu_load(v->m, &load, &detail)) == MASU_INCOMPLETE) {
        if (!window_run(&v->window, load.buffer)) return false;
    }
    if (!result && knows) result = masu_governor_restore(v->m, &learnt, &detail);
    return !result || failed(&detail);
}

/* Returns true with *outdated unchanged if the window has no size at present, for example when
 * minimised. */
static bool follow_window(view *v, bool *outdated) {
    vkDeviceWaitIdle(v->window.device);
    if (!window_swapchain(&v->window)) return SDL_Delay(20), true;
    masu_desc desc = describe(v);
    bool fits = masu_resize(v->m, desc.output, &desc.targets, NULL, NULL) == MASU_OK;
    bool good = fits || build(v);
    window_drop(&v->window); /* the old images are no longer used */
    v->resizes++;
    *outdated = false;
    return good;
}

static bool draw(view *v, const char *picture, bool *outdated) {
    window *w = &v->window;
    uint32_t slot = (uint32_t)(v->frame % WINDOW_SLOTS), image;
    masu_commands commands;
    masu_detail detail;
    VkResult got = window_begin(w, slot, &image); /* waits until the slot is free */
    if (got) return *outdated = got == VK_ERROR_OUT_OF_DATE_KHR;
    if (w->submit_ns[slot]) masu_frame_times(v->m, slot, w->submit_ns[slot], w->done_ns[slot], 0);
    masu_frame_desc frame = {MASU_FRAME_DESC, .time = SDL_GetTicks() / 1e3, .rung = MASU_RUNG_AUTO,
                             .target = image};
    if (masu_frame(v->m, &frame, &commands, &detail)) return failed(&detail);
    overlay_line l = {8, 8, 2, ""};
    snprintf(l.text, sizeof l.text, "%uX%u  RUNG %u", w->size.width, w->size.height, commands.rung);
    v->frame++, v->frames++, v->rungs |= 1u << commands.rung;
    if (!overlay_record(&v->overlay, slot, image, &l, 1, picture[0])) return false;
    got = window_end(w, slot, image, (VkCommandBuffer[2]){commands.buffer, w->commands[slot]}, 2);
    *outdated = got == VK_ERROR_OUT_OF_DATE_KHR || got == VK_SUBOPTIMAL_KHR;
    return (got >= 0 || *outdated) && (!picture[0] || overlay_save(&v->overlay, picture));
}

/* resize WxH, screenshot FILE, quit */
static bool follow_script(view *v, unsigned frame, char *picture, bool *quit) {
    for (script_line line; script_next(&v->script, frame, &line);) {
        if (!strcmp(line.verb, "screenshot")) strcpy(picture, line.value);
        else if (!strcmp(line.verb, "quit")) *quit = true;
        else if (!script_resize(&line, &v->window)) return script_unknown(&line);
    }
    return true;
}

int main(int argc, char **argv) {
    static view v;
    bool quit = false, outdated = false;
    if (argc != 2 && argc != 3) return fprintf(stderr, "usage: loop SCENE.masu [SCRIPT]\n"), 2;
    const char *wish = getenv("LOOP_SURFACE") ? getenv("LOOP_SURFACE") : "";
    v.window.srgb = strstr(wish, "srgb"), v.window.unpaced = strstr(wish, "unpaced");
    bool good = script_open(&v.script, argv[2]) && read_scene(&v, argv[1]) &&
                window_open(&v.window, "Masu: loop", 640, 360, v.script.text) &&
                overlay_open(&v.overlay, &v.window) && build(&v);
    while (good && !quit) {
        char picture[256] = "";
        good = follow_script(&v, v.frames, picture, &quit);
        for (SDL_Event e; SDL_PollEvent(&e);) {
            if (e.type == SDL_QUIT) quit = true;
            if (e.type == SDL_KEYDOWN && e.key.keysym.sym == SDLK_ESCAPE) quit = true;
            outdated |= e.type == SDL_WINDOWEVENT && e.window.event == SDL_WINDOWEVENT_SIZE_CHANGED;
        }
        if (good && outdated) good = follow_window(&v, &outdated);
        if (good && !outdated && !quit) good = draw(&v, picture, &outdated);
    }
    if (v.m) printf("frames %u rungs 0x%02x resizes %d inits %d format %d validation %d\n",
                    v.frames, v.rungs, v.resizes, v.inits, (int)v.window.format, v.window.messages);
    if (v.window.device) vkDeviceWaitIdle(v.window.device);
    masu_destroy(v.m);
    overlay_close(&v.overlay);
    window_close(&v.window);
    script_close(&v.script);
    SDL_free(v.blob);
    free(v.block);
    return !good || v.window.messages;
}

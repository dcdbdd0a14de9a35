/* main.c: drive SCENE.masu: a race for one, and an example of a game on Masu. docs/drive.md says how to play
 * it, and what each file shows.
 *
 * All of its memory is asked for before the first frame; then heap_closed is set, and whatever asks for more
 * ends the program. With --script the clock is not looked at: each frame is 1/60 s, and the same script gives
 * the same drive, at a fixed rung (--rung) the same pictures. */
#include "camera.h"
#include "heap.h"
#include "render.h"
#include "script.h"

#include <SDL_vulkan.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STEPS 4 /* of the cars in each frame */

typedef struct options {
    const char *scene, *track, *script;
    int width, height, rung, player;
    double target_ms;
    bool validate, dusk, allocate;
} options;

typedef struct game {
    options options;
    window window;
    render render;
    track track;
    race race;
    camera camera;
    script script;
    render_view view;
    SDL_GameController *pad;
    bool keys[SDL_NUM_SCANCODES];
    bool quit, outdated;
    int resizes, photos;
    char photo[256];
} game;

static const char usage[] =
    "usage: drive SCENE.masu [options]\n"
    "  --track FILE    the road (SCENE.track)\n"
    "  --size WxH      of the window (1280x720)\n"
    "  --target MS     a frame's time, which the governor keeps (33)\n"
    "  --rung N        always this rung instead\n"
    "  --car N         which car is yours (0)\n"
    "  --dusk          the sun is low, the head lights are on\n"
    "  --script FILE   keys, resizes, screenshots frame by frame; 1/60 s each\n"
    "  --validate      under the Khronos validation layer\n"
    "  --allocate      asks for memory in the first frame, which ends the program: a test\n"
    "keys: arrows or WASD, space handbrake; C camera, L lights, N dusk, P pause, F12 photo, Escape\n";

static bool read_options(options *o, int argc, char **argv) {
    *o = (options){.width = 1280, .height = 720, .rung = -1, .target_ms = 33};
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : "";
        char more;
        bool taken = true; /* the value */
        if (strcmp(name, "--track") == 0 && *value) o->track = value;
        else if (strcmp(name, "--script") == 0 && *value) o->script = value;
        else if (strcmp(name, "--size") == 0 && sscanf(value, "%dx%d%c", &o->width, &o->height, &more) == 2) {
            if (o->width < 64 || o->height < 64 || o->width > 8192 || o->height > 8192) return false;
        } else if (strcmp(name, "--target") == 0 && sscanf(value, "%lf%c", &o->target_ms, &more) == 1) {
            if (!(o->target_ms >= 1 && o->target_ms <= 1000)) return false;
        } else if (strcmp(name, "--rung") == 0 && sscanf(value, "%d%c", &o->rung, &more) == 1) {
            if (o->rung < 0 || o->rung >= (int)MASU_MAX_RUNGS) return false;
        } else if (strcmp(name, "--car") == 0 && sscanf(value, "%d%c", &o->player, &more) == 1) {
            if (o->player < 0 || o->player >= TRACK_CARS) return false;
        } else {
            taken = false;
            if (strcmp(name, "--dusk") == 0) o->dusk = true;
            else if (strcmp(name, "--validate") == 0) o->validate = true;
            else if (strcmp(name, "--allocate") == 0) o->allocate = true;
            else if (name[0] != '-' && !o->scene) o->scene = name;
            else return false;
        }
        i += taken;
    }
    return o->scene;
}

/* ---- input ---- */

static void key(game *g, SDL_Scancode code, bool down) {
    bool pressed = down && !g->keys[code]; /* not held down, which the system repeats */
    g->keys[code] = down;
    if (!pressed) return;
    switch ((int)code) {
    case SDL_SCANCODE_ESCAPE: g->quit = true; break;
    case SDL_SCANCODE_P: g->view.paused = !g->view.paused; break;
    case SDL_SCANCODE_N: /* eyes need not get used to it */
        g->view.lamps = g->view.dusk = !g->view.dusk, g->view.cut = true;
        break;
    case SDL_SCANCODE_L: g->view.lamps = !g->view.lamps; break;
    case SDL_SCANCODE_C:
        g->camera.view = (g->camera.view + 1) % CAMERA_VIEWS;
        g->camera.placed = false, g->view.cut = true;
        break;
    case SDL_SCANCODE_F12:
        snprintf(g->photo, sizeof g->photo, "drive-%03d.png", g->photos++);
        g->view.photo = g->photo;
        break;
    }
}

static void pump_events(game *g) {
    SDL_Event e;
    while (SDL_PollEvent(&e)) {
        bool live = !g->options.script; /* a script has the keys to itself */
        if (e.type == SDL_QUIT) g->quit = true;
        if (e.type == SDL_WINDOWEVENT && e.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) g->outdated = true;
        if (live && (e.type == SDL_KEYDOWN || e.type == SDL_KEYUP))
            key(g, e.key.keysym.scancode, e.type == SDL_KEYDOWN);
        if (live && e.type == SDL_CONTROLLERDEVICEADDED && !g->pad) g->pad = SDL_GameControllerOpen(e.cdevice.which);
        if (live && e.type == SDL_CONTROLLERBUTTONDOWN)
            key(g, e.cbutton.button == SDL_CONTROLLER_BUTTON_START ? SDL_SCANCODE_P : SDL_SCANCODE_C, true);
        if (live && e.type == SDL_CONTROLLERBUTTONUP)
            key(g, e.cbutton.button == SDL_CONTROLLER_BUTTON_START ? SDL_SCANCODE_P : SDL_SCANCODE_C, false);
    }
}

/* The window is as large as a script says before the frame goes on. */
static void resize(game *g, int width, int height) {
    VkSurfaceCapabilitiesKHR is;
    SDL_SetWindowSize(g->window.sdl, width, height);
    for (int i = 0; i < 200; i++, SDL_Delay(10)) {
        pump_events(g);
        if (vkGetPhysicalDeviceSurfaceCapabilitiesKHR(g->window.gpu, g->window.surface, &is)) return;
        if (is.currentExtent.width == (uint32_t)width && is.currentExtent.height == (uint32_t)height) break;
    }
    g->outdated = true;
}

static void follow_script(game *g, unsigned frame) {
    const script_line *line;
    while ((line = script_next(&g->script, frame))) {
        switch (line->kind) {
        case SCRIPT_KEY:
            if (line->down) key(g, line->key, true);
            if (line->up) key(g, line->key, false);
            break;
        case SCRIPT_RESIZE: resize(g, line->width, line->height); break;
        case SCRIPT_SCREENSHOT: g->view.photo = line->file; break;
        case SCRIPT_QUIT: g->quit = true; break;
        }
    }
}

static double axis(game *g, SDL_GameControllerAxis which) {
    double x = g->pad ? SDL_GameControllerGetAxis(g->pad, which) / 32767.0 : 0;
    return fabs(x) < 0.1 ? 0 : x;
}

static car_input pedals(game *g) {
    const bool *k = g->keys;
    double steer = (k[SDL_SCANCODE_RIGHT] || k[SDL_SCANCODE_D]) - (k[SDL_SCANCODE_LEFT] || k[SDL_SCANCODE_A]);
    double throttle = k[SDL_SCANCODE_UP] || k[SDL_SCANCODE_W], brake = k[SDL_SCANCODE_DOWN] || k[SDL_SCANCODE_S];
    return (car_input){.steer = clamp(steer + axis(g, SDL_CONTROLLER_AXIS_LEFTX), -1, 1),
                       .throttle = clamp(throttle + axis(g, SDL_CONTROLLER_AXIS_TRIGGERRIGHT), 0, 1),
                       .brake = clamp(brake + axis(g, SDL_CONTROLLER_AXIS_TRIGGERLEFT), 0, 1),
                       .handbrake = k[SDL_SCANCODE_SPACE]};
}

/* ---- the game ---- */

/* All that a window of another size takes. Where it has no size, hidden or rolled up, nothing is drawn. */
static bool follow_window(game *g) {
    int width, height;
    SDL_Vulkan_GetDrawableSize(g->window.sdl, &width, &height);
    if (width <= 0 || height <= 0) return SDL_Delay(20), true;
    vkDeviceWaitIdle(g->window.device);
    if (!window_swapchain(&g->window) || !render_resize(&g->render, &g->track)) return false;
    window_drop(&g->window);
    g->resizes++;
    g->outdated = false;
    return true;
}

static bool play(game *g) {
    Uint64 before = SDL_GetPerformanceCounter();
    for (unsigned frame = 0; !g->quit; frame++) {
        Uint64 now = SDL_GetPerformanceCounter();
        double passed = clamp((double)(now - before) / (double)SDL_GetPerformanceFrequency(), 0, 0.1);
        before = now;
        pump_events(g);
        follow_script(g, frame);
        if (g->quit) break;
        if (g->outdated && !follow_window(g)) return false;
        if (g->outdated) continue;
        double dt = g->view.paused ? 0 : g->options.script ? 1.0 / 60 : passed;
        car_input input = pedals(g);
        for (int i = 0; dt > 0 && i < STEPS; i++) race_step(&g->race, &input, dt / STEPS);
        camera_step(&g->camera, &g->track, &g->race.cars[g->race.player], dt, &g->view.camera);
        g->view.time += dt, g->view.step = (float)dt;
        if (!render_frame(&g->render, &g->race, &g->view, &g->outdated)) return false;
        if (g->options.allocate) {
            void *volatile block = malloc(1); /* else the compiler leaves it out */
            free(block);
        }
        g->view.cut = false, g->view.photo = NULL;
    }
    return true;
}

static bool start(game *g) {
    const options *o = &g->options;
    char beside[4096];
    size_t stem = strlen(o->scene) > 5 ? strlen(o->scene) - 5 : 0; /* without ".masu" */
    snprintf(beside, sizeof beside, "%.*s.track", (int)stem, o->scene);
    if (!track_read(&g->track, o->track ? o->track : beside)) return false;
    if (o->player >= g->track.cars)
        return fprintf(stderr, "drive: --car %d: the track has %d\n", o->player, g->track.cars), false;
    if (o->script && !script_read(&g->script, o->script)) return false;
    g->render.target_ms = (float)o->target_ms, g->render.fixed_rung = o->rung;
    g->view.dusk = g->view.lamps = o->dusk;
    race_start(&g->race, &g->track, o->player);
    return window_open(&g->window, o->width, o->height, o->validate) &&
           render_open(&g->render, &g->window, o->scene) && render_build(&g->render, &g->track);
}

int main(int argc, char **argv) {
    static game g; /* 600 KB: not for the stack */
    if (!read_options(&g.options, argc, argv)) return fputs(usage, stderr), 2;
    bool good = start(&g);
    heap_closed = true;
    good = good && play(&g);
    render_close(&g.render);
    int messages = g.window.messages;
    window_close(&g.window);
    if (good) {
        printf("frames %llu rungs 0x%02x missed %llu laps %d distance %.1f hits %d resizes %d validation %d\n",
               (unsigned long long)g.render.frames, g.render.rungs,
               (unsigned long long)(g.render.missed + g.render.missed_now), g.race.laps, g.race.distance,
               g.race.hits, g.resizes, messages);
    }
    return !good || messages;
}

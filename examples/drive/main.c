/* main.c: drive SCENE.masu TRACK: a racing game for one player, and an example of a game on Masu.
 * docs/drive.md explains the controls, and what each file demonstrates.
 *
 * All memory is allocated before the first frame; then heap_closed is set, and any later
 * allocation ends the program. With a script the clock is not used: the same script gives the
 * same drive, and at a fixed rung the same images. */
#include "render.h"
#include "script.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STEP (1.0 / 240) /* at most, of the cars, seconds */
extern bool heap_closed;

typedef struct game {
    window window;
    render render;
    track track;
    race race;
    render_view view;
    script script;
    SDL_GameController *pad;
    bool keys[SDL_NUM_SCANCODES];
    bool quit, outdated, autopilot, validates;
    int width, height, resizes;
    double step; /* seconds of a script's frame */
} game;

static const char usage[] =
    "usage: drive [options] SCENE.masu TRACK\n"
    "  -s WxH   of the window (1280x720)\n"
    "  -t MS    a frame's time, which the governor keeps (33)\n"
    "  -r N     always this rung instead\n"
    "  -f FILE  a script: keys, resizes, screenshots frame by frame\n"
    "  -v       under the Khronos validation layer\n"
    "keys: arrows or WASD, Space handbrake; L lights, N dusk, R rain, B bloom, O autopilot,\n"
    "      P pause, F12 photo, Escape\n";

static void key(game *g, SDL_Scancode code, bool down) {
    g->keys[code] = down;
    if (!down) return;
    if (code == SDL_SCANCODE_ESCAPE) g->quit = true;
    if (code == SDL_SCANCODE_P) g->view.paused = !g->view.paused;
    if (code == SDL_SCANCODE_O) g->autopilot = !g->autopilot;
    if (code == SDL_SCANCODE_L) g->view.lamps = !g->view.lamps;
    if (code == SDL_SCANCODE_N) g->view.lamps = g->view.dusk = !g->view.dusk, g->view.cut = true;
    if (code == SDL_SCANCODE_R) g->view.rain = !g->view.rain;
    if (code == SDL_SCANCODE_B) g->view.bloom = !g->view.bloom;
    if (code == SDL_SCANCODE_F12) strcpy(g->view.photo, "drive.bmp");
}

static void pump_events(game *g) {
    SDL_Event e;
    while (SDL_PollEvent(&e)) {
        bool sized = e.type == SDL_WINDOWEVENT && e.window.event == SDL_WINDOWEVENT_SIZE_CHANGED;
        g->quit = g->quit || e.type == SDL_QUIT;
        g->outdated = g->outdated || sized;
        if ((e.type == SDL_KEYDOWN && !e.key.repeat) || e.type == SDL_KEYUP)
            key(g, e.key.keysym.scancode, e.type == SDL_KEYDOWN);
        if (e.type == SDL_CONTROLLERDEVICEADDED && !g->pad)
            g->pad = SDL_GameControllerOpen(e.cdevice.which);
        if (e.type == SDL_CONTROLLERBUTTONDOWN || e.type == SDL_CONTROLLERBUTTONUP)
            key(g, e.cbutton.button == SDL_CONTROLLER_BUTTON_START ? SDL_SCANCODE_P :
                   e.cbutton.button == SDL_CONTROLLER_BUTTON_A     ? SDL_SCANCODE_L :
                   e.cbutton.button == SDL_CONTROLLER_BUTTON_X     ? SDL_SCANCODE_R :
                                                                     SDL_SCANCODE_SPACE,
                e.type == SDL_CONTROLLERBUTTONDOWN);
    }
}

/* Value of a key or of one half of a stick's axis: 0..1, negative for the other half. */
static double pedal(game *g, SDL_Scancode arrow, SDL_Scancode letter,
                    SDL_GameControllerAxis axis, int way) {
    double stick = g->pad ? way * SDL_GameControllerGetAxis(g->pad, axis) / 32767.0 : 0;
    return g->keys[arrow] || g->keys[letter] ? 1 : stick > 0.1 ? fmin(stick, 1) : 0;
}

static car_input pedals(game *g) {
    return (car_input){
        .steer = pedal(g, SDL_SCANCODE_RIGHT, SDL_SCANCODE_D, SDL_CONTROLLER_AXIS_LEFTX, 1) -
                 pedal(g, SDL_SCANCODE_LEFT, SDL_SCANCODE_A, SDL_CONTROLLER_AXIS_LEFTX, -1),
        .throttle = pedal(g, SDL_SCANCODE_UP, SDL_SCANCODE_W, SDL_CONTROLLER_AXIS_TRIGGERRIGHT, 1),
        .brake = pedal(g, SDL_SCANCODE_DOWN, SDL_SCANCODE_S, SDL_CONTROLLER_AXIS_TRIGGERLEFT, 1),
        .hand = g->keys[SDL_SCANCODE_SPACE]};
}

static bool follow_script(game *g, unsigned frame) {
    for (script_line line; script_next(&g->script, frame, &line);) {
        SDL_Scancode code = SDL_GetScancodeFromName(line.value);
        if (!strcmp(line.verb, "key") && code) {
            if (strcmp(line.how, "up")) key(g, code, true);
            if (strcmp(line.how, "down")) key(g, code, false);
        } else if (!strcmp(line.verb, "step") && atof(line.value) > 0) {
            g->step = fmin(atof(line.value), 0.1);
        } else if (!strcmp(line.verb, "screenshot")) {
            strcpy(g->view.photo, line.value);
        } else if (!strcmp(line.verb, "allocate")) { /* to see that it ends the program */
            void *volatile block = malloc(1);        /* else the compiler leaves it out */
            free(block);
        } else if (!strcmp(line.verb, "quit")) {
            g->quit = true;
        } else if (!script_resize(&line, &g->window)) {
            return script_unknown(&line);
        }
    }
    return true;
}

/* Rebuilds for a new window size. Nothing is drawn while the window is hidden or minimized. */
static bool follow_window(game *g) {
    vkDeviceWaitIdle(g->window.device);
    if (!window_swapchain(&g->window)) return SDL_Delay(20), true;
    bool good = render_resize(&g->render, &g->track);
    window_drop(&g->window);
    g->resizes++, g->outdated = false;
    return good;
}

static bool play(game *g) {
    Uint64 before = SDL_GetPerformanceCounter();
    for (unsigned frame = 0; !g->quit; frame++) {
        Uint64 now = SDL_GetPerformanceCounter();
        double passed = fmin((double)(now - before) / (double)SDL_GetPerformanceFrequency(), 0.1);
        before = now;
        if (!follow_script(g, frame)) return false;
        pump_events(g);
        if (g->quit) break;
        if (g->outdated && !follow_window(g)) return false;
        if (g->outdated) continue;
        double dt = g->view.paused ? 0 : g->script.text ? g->step : passed, steps = ceil(dt / STEP);
        for (int i = 0; i < (int)steps; i++) {
            car_input input = g->autopilot ? race_autopilot(&g->race, 0) : pedals(g);
            race_step(&g->race, &input, dt / steps);
        }
        effects_step(&g->render.effects, &g->race, dt, g->view.rain);
        g->view.time += dt, g->view.step = (float)dt;
        if (!render_frame(&g->render, &g->race, &g->view, &g->outdated)) return false;
        g->view.cut = false, g->view.photo[0] = 0;
    }
    return true;
}

static bool read_options(game *g, int argc, char **argv) {
    char more;
    g->width = 1280, g->height = 720, g->step = 1.0 / 60, g->view.bloom = true;
    g->render.fixed_rung = -1, g->render.target_ms = 33;
    for (int c; (c = getopt(argc, argv, "s:t:r:f:v")) != -1;) {
        if (c == 's' && sscanf(optarg, "%dx%d%c", &g->width, &g->height, &more) == 2) continue;
        if (c == 't' && sscanf(optarg, "%f%c", &g->render.target_ms, &more) == 1) continue;
        if (c == 'r' && sscanf(optarg, "%d%c", &g->render.fixed_rung, &more) == 1) continue;
        if (c == 'f' && !g->script.text && script_open(&g->script, optarg)) continue;
        if (c != 'v') return false;
        g->validates = true;
    }
    return argc == optind + 2;
}

int main(int argc, char **argv) {
    static game g; /* 1.2 MB: not for the stack */
    if (!read_options(&g, argc, argv)) return fputs(usage, stderr), 2;
    bool good = track_read(&g.track, argv[optind + 1]) &&
                window_open(&g.window, "Masu: drive", g.width, g.height, g.validates) &&
                render_open(&g.render, &g.window, argv[optind]);
    if (good) race_start(&g.race, &g.track);
    heap_closed = true;
    good = good && render_load(&g.render, &g.track) && play(&g);
    const render *r = &g.render;
    if (good)
        printf("frames %u rungs 0x%02x changes %u over %u laps %d best %.2f distance %.1f "
               "resizes %d bars %u late %u\n",
               r->frames, r->rungs, r->changes, r->over, g.race.laps, g.race.best, g.race.distance,
               g.resizes, r->bars, r->late);
    render_close(&g.render);
    window_close(&g.window);
    script_close(&g.script);
    return !good || g.window.messages;
}

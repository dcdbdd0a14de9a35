/* loop.c: the main loop: events, time, camera, files, one frame. It follows the clock; with a
 * script or --frames each iteration is 1/60 s long. */
#include "view/script.h"

#include "cli/cli.h"
#include "clock.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#define STEP_MAX 0.25     /* s: a pause of the machine must not make the camera jump */
#define WAIT_HIDDEN 250   /* ms between checks while the window is hidden */
#define RETRY 10          /* ms, while the swapchain is out of date */

/* Blocks while there is nothing to draw, to avoid a busy loop. */
static void take_events(masu_viewer *v, masu_hands *hands, bool *good) {
    SDL_Event e;
    bool idle = (v->hidden || !v->window.extent.width) && !v->scripted;
    bool first = idle && SDL_WaitEventTimeout(&e, WAIT_HIDDEN);
    while (first || SDL_PollEvent(&e)) {
        first = false;
        if (!masu_hands_event(hands, v, &e)) *good = false;
    }
}

static void pass_time(masu_viewer *v, masu_hands *hands, double seconds) {
    double step = v->paused ? 0.0 : seconds;
    masu_hands_move(hands, v, seconds);
    v->turn_seconds = seconds;
    masu_capture_step(v, seconds);
    masu_look_advance(v, step);
    v->time_step = (float)step;
    v->time += step;
    if (v->on_path && v->path_end > 0.0 && v->time > v->path_end) {
        v->time = fmod(v->time, v->path_end);
        v->cut = true;
    }
}

static void restart(masu_viewer *v, bool *good) {
    v->changed = false;
    v->trouble[0] = '\0';
    *good = masu_viewer_restart(v);
    v->moved = v->frames;
    if (!*good || v->trouble[0]) return;
    masu_viewer_note(v, "%s: renderer rebuilt in %.0f ms %s", v->change, v->a.start_ms,
                     v->a.in_place ? "in the same blocks" : "in larger blocks");
}

/* One loop iteration. On false v->error has the reason, or v->lost is set. */
static bool turn(masu_viewer *v, masu_script *script, masu_hands *hands, double seconds) {
    bool good = true;
    if (!masu_script_play(script, v)) return false;
    take_events(v, hands, &good);
    if (!good || v->quit) return good;
    if (!masu_baker_poll(v) || !masu_gallery_poll(v)) return false;
    if (v->changed && v->a.m) restart(v, &good);
    if (!good) return false;
    if (v->window.stale && !v->hidden && !masu_viewer_resize(v)) return false;
    bool drawable = !v->hidden && v->window.extent.width;
    if (!drawable) {
        if (v->scripted) SDL_Delay(1);
        return true;
    }
    pass_time(v, hands, seconds);
    uint64_t before = v->frames;
    if (!masu_viewer_frame(v) || !masu_difference_step(v)) return false;
    if (v->frames == before) {
        SDL_Delay(RETRY);
        return true;
    }
    if (!masu_capture_frame(v)) return false;
    bool shoot = v->shoot;
    v->shoot = false;
    return !shoot || masu_capture_still(v);
}

/* Returns true if the device was recreated. */
static bool recover(masu_viewer *v) {
    if (++v->losses > 1) {
        snprintf(v->error, sizeof v->error, "the Vulkan device was lost twice in a row");
        return false;
    }
    masu_cli_warn("the Vulkan device was lost (%s); it was recreated", v->error);
    masu_viewer_note(v, "the device was lost and recreated");
    return masu_viewer_recover(v);
}

static volatile sig_atomic_t told_to_end;

static void note_signal(int number) {
    (void)number;
    told_to_end = 1;
}

void masu_viewer_catch_signals(void) {
    static const int ending[] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction action = {.sa_handler = note_signal,
                               .sa_flags = (int)SA_RESETHAND | SA_RESTART};
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof ending / sizeof *ending; i++)
        (void)sigaction(ending[i], &action, NULL);
}

int masu_viewer_run(masu_viewer *v, masu_script *script) {
    masu_hands hands = {0};
    const masu_viewer_options *o = v->o;
    uint64_t last = masu_clock_ns(NULL), drawn = last;
    bool good = true;
    while (good && !v->quit && !told_to_end) {
        uint64_t now = masu_clock_ns(NULL), frames = v->frames;
        double seconds = v->recorder.films ? MASU_VIEWER_FILM_STEP
                         : v->scripted    ? MASU_VIEWER_STEP
                                          : fmin((double)(now - last) / 1e9, STEP_MAX);
        last = now;
        good = turn(v, script, &hands, seconds);
        if (!good && v->lost) good = recover(v);
        if (v->frames != frames) {
            now = masu_clock_ns(NULL);
            double ms = (double)(now - drawn) / 1e6;
            v->wall_ms += (ms - v->wall_ms) * (v->wall_ms > 0.0 ? 0.1 : 1.0);
            drawn = now;
        }
        v->turns++;
        if (good && o->frames && v->turns == o->frames) {
            if (o->screenshot) good = masu_viewer_screenshot(v, o->screenshot, false);
            v->quit = v->quit || o->quit;
        }
    }
    masu_hands_close(&hands);
    return good ? MASU_CLI_OK : masu_cli_error("%s", v->error);
}

/* keys.c: actions of key presses. input.c handles held keys; keys that the user interface consumes
 * do not arrive here. */
#include "view/viewer.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const float targets[] = {2.0f,   4.0f,   6.94f,  8.33f,  11.11f, 13.89f,
                                16.67f, 20.0f,  22.22f, 33.33f, 50.0f,  66.67f,
                                100.0f, 200.0f, 300.0f, 500.0f, 700.0f, 1000.0f};
enum { TARGETS = sizeof targets / sizeof *targets };

static void take_rung(masu_viewer *v, uint32_t rung) {
    if (rung >= v->want.rung_count) {
        masu_viewer_note(v, "rung %u does not exist: expected 0 to %u", rung,
                         v->want.rung_count - 1);
        return;
    }
    v->rung = rung;
    v->governed = false;
    masu_viewer_note(v, "rung %u", rung);
}

static void govern(masu_viewer *v, bool on) {
    if (on && v->want.governor.mode == MASU_GOVERNOR_OFF) {
        masu_viewer_note(v, "the governor needs more than one rung");
        return;
    }
    v->governed = on;
    masu_viewer_note(v, on ? "governor on" : "rung %u, governor off", v->rung);
}

/* Selects the next target of the list, up or down. */
static void change_target(masu_viewer *v, int way) {
    float now = v->want.governor.target_ms, next = now;
    if (v->want.governor.mode == MASU_GOVERNOR_OFF) {
        govern(v, true); /* reports why it cannot */
        return;
    }
    for (int i = 0; i < TARGETS; i++) {
        float t = targets[way > 0 ? i : TARGETS - 1 - i];
        if (way > 0 ? t > now * 1.001f : t < now * 0.999f) {
            next = t;
            break;
        }
    }
    if (next == now) return;
    v->want.governor.target_ms = next;
    v->changed = true;
    snprintf(v->change, sizeof v->change, "target %.2f ms", (double)next);
}

static void scrub(masu_viewer *v, double seconds) {
    v->time = fmax(v->time + seconds, 0.0);
    if (v->on_path && v->path_end > 0.0) v->time = fmin(v->time, v->path_end);
    v->cut = true;
    v->moved = v->frames;
    masu_viewer_note(v, "time %.2f s", v->time);
}

static void toggle_path(masu_viewer *v) {
    if (!masu_scene_count(&v->scene, MASU_SCENE_CAMERA_KEY)) {
        masu_viewer_note(v, "the scene has no camera path");
        return;
    }
    if (v->on_path) {
        masu_camera camera;
        masu_viewer_camera(v, &camera);
        masu_fly_from(&v->fly, &camera);
    }
    v->on_path = !v->on_path;
    v->cut = true;
    v->moved = v->frames;
    masu_viewer_note(v, v->on_path ? "camera path" : "free camera");
}

static void store_reference(masu_viewer *v) {
    char name[MASU_SETTING_ID];
    v->reference = v->want.rungs[v->rung];
    masu_viewer_setting(v, &v->reference, name);
    masu_viewer_note(v, "B is now %s", name);
    if (v->show == MASU_SHOW_A) return;
    v->changed = true;
    snprintf(v->change, sizeof v->change, "B is now %.100s", name);
}

/* Keys that also work without a scene. */
static bool always(masu_viewer *v, SDL_Keycode key) {
    bool full;
    switch (key) {
    case SDLK_ESCAPE:
        if (v->gallery.open && v->a.m) v->gallery.open = false;
        else if (v->panels.open) v->panels.open = false;
        else v->quit = true;
        return true;
    case SDLK_F1: v->hud = (v->hud + 1) % MASU_HUD_LEVELS; return true;
    case SDLK_F4:
        if (v->gallery.open && v->a.m) v->gallery.open = false;
        else masu_gallery_open(v), v->panels.focus = true;
        return true;
    case SDLK_F11:
        full = (SDL_GetWindowFlags(v->window.sdl) & SDL_WINDOW_FULLSCREEN_DESKTOP) != 0;
        SDL_SetWindowFullscreen(v->window.sdl, full ? 0 : SDL_WINDOW_FULLSCREEN_DESKTOP);
        return true;
    case SDLK_F12: v->shoot = true; return true;
    default: return false;
    }
}

bool masu_key_pressed(masu_viewer *v, SDL_Keycode key, uint16_t modifiers) {
    double far = modifiers & KMOD_SHIFT ? 10.0 : 1.0;
    v->moved = v->frames; /* any key may change the image: compute the difference again */
    if (always(v, key) || !v->a.m) return true;
    if (key >= SDLK_1 && key <= SDLK_8) return take_rung(v, (uint32_t)(key - SDLK_1)), true;
    switch (key) {
    case SDLK_PAGEUP: return take_rung(v, v->rung > 0 ? v->rung - 1 : 0), true;
    case SDLK_PAGEDOWN: return take_rung(v, v->rung + 1), true;
    case SDLK_0: govern(v, true); return true;
    case SDLK_g: govern(v, !v->governed); return true;
    case SDLK_PLUS:
    case SDLK_EQUALS:
    case SDLK_KP_PLUS: change_target(v, 1); return true;
    case SDLK_MINUS:
    case SDLK_KP_MINUS: change_target(v, -1); return true;
    case SDLK_p: toggle_path(v); return true;
    case SDLK_SPACE:
        v->paused = !v->paused;
        masu_viewer_note(v, v->paused ? "paused" : "running");
        return true;
    case SDLK_LEFT: scrub(v, -0.1 * far); return true;
    case SDLK_RIGHT: scrub(v, 0.1 * far); return true;
    case SDLK_HOME: scrub(v, -v->time); return true;
    case SDLK_TAB:
    case SDLK_m: masu_panels_show(v, v->panels.tab); return true;
    case SDLK_F5:
    case SDLK_F6:
    case SDLK_F7:
    case SDLK_F8: masu_panels_show(v, MASU_TAB_SCENE + (uint32_t)(key - SDLK_F5)); return true;
    case SDLK_F10: masu_panels_show(v, MASU_TAB_CAPTURE); return true;
    case SDLK_F9: masu_capture_film(v, !v->recorder.films); return true;
    case SDLK_F2:
        return masu_viewer_show(v, v->show == MASU_SHOW_SPLIT ? MASU_SHOW_A : MASU_SHOW_SPLIT);
    case SDLK_F3:
        return masu_viewer_show(v, v->show == MASU_SHOW_MAP ? MASU_SHOW_A : MASU_SHOW_MAP);
    case SDLK_b: store_reference(v); return true;
    case SDLK_LEFTBRACKET: v->split = fmax(v->split - 0.02 * far, 0.0); return true;
    case SDLK_RIGHTBRACKET: v->split = fmin(v->split + 0.02 * far, 1.0); return true;
    default: return true;
    }
}

void masu_pad_pressed(masu_viewer *v, uint8_t button) {
    static const SDL_Keycode keys[SDL_CONTROLLER_BUTTON_MAX] = {
        [SDL_CONTROLLER_BUTTON_A] = SDLK_SPACE,
        [SDL_CONTROLLER_BUTTON_B] = SDLK_p,
        [SDL_CONTROLLER_BUTTON_X] = SDLK_F2,
        [SDL_CONTROLLER_BUTTON_Y] = SDLK_F1,
        [SDL_CONTROLLER_BUTTON_START] = SDLK_TAB,
        [SDL_CONTROLLER_BUTTON_BACK] = SDLK_g,
        [SDL_CONTROLLER_BUTTON_DPAD_UP] = SDLK_UP,
        [SDL_CONTROLLER_BUTTON_DPAD_DOWN] = SDLK_DOWN,
        [SDL_CONTROLLER_BUTTON_DPAD_LEFT] = SDLK_LEFT,
        [SDL_CONTROLLER_BUTTON_DPAD_RIGHT] = SDLK_RIGHT};
    if (button == SDL_CONTROLLER_BUTTON_LEFTSHOULDER) masu_fly_faster(&v->fly, -1.0);
    if (button == SDL_CONTROLLER_BUTTON_RIGHTSHOULDER) masu_fly_faster(&v->fly, 1.0);
    if (button >= SDL_CONTROLLER_BUTTON_MAX || !keys[button]) return;
    SDL_Event e = {.key = {.type = SDL_KEYDOWN, .keysym = {.sym = keys[button]}}};
    SDL_PushEvent(&e);
}

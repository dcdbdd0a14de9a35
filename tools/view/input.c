/* input.c: SDL events. Held keys, mouse and sticks move the camera; key presses are handled by
 * keys.c. The held state is tracked only from events, so that events of a script work like real
 * ones. */
#include "view/viewer.h"

#include <math.h>
#include <string.h>

#define LOOK 0.0025      /* radians per pixel */
#define STICK_TURN 2.2   /* radians per second at full deflection */
#define STICK_IDLE 0.18  /* dead zone, as a fraction of the travel */

enum { FORWARD, BACK, LEFT, RIGHT, UP, DOWN, FAST, TURN };

static int held_by(SDL_Keycode key) {
    switch (key) {
    case SDLK_w: return FORWARD;
    case SDLK_s: return BACK;
    case SDLK_a: return LEFT;
    case SDLK_d: return RIGHT;
    case SDLK_e: return UP;
    case SDLK_q: return DOWN;
    case SDLK_LSHIFT:
    case SDLK_RSHIFT: return FAST;
    default: return -1;
    }
}

static void look(masu_hands *h, bool on) {
    h->held[TURN] = on;
    SDL_SetRelativeMouseMode(on ? SDL_TRUE : SDL_FALSE);
}

static void drag(masu_viewer *v, int x) {
    int width = 0, height = 0;
    SDL_GetWindowSize(v->window.sdl, &width, &height);
    if (width < 1) return;
    v->split = fmin(fmax((double)x / width, 0.0), 1.0);
}

static bool window_event(masu_viewer *v, masu_hands *h, const SDL_WindowEvent *e) {
    switch (e->event) {
    case SDL_WINDOWEVENT_SIZE_CHANGED: v->window.stale = true; break;
    case SDL_WINDOWEVENT_MINIMIZED:
    case SDL_WINDOWEVENT_HIDDEN: v->hidden = true; break;
    case SDL_WINDOWEVENT_RESTORED:
    case SDL_WINDOWEVENT_MAXIMIZED:
    case SDL_WINDOWEVENT_SHOWN: v->hidden = false; break;
    case SDL_WINDOWEVENT_FOCUS_LOST: /* releases outside the window are not reported */
        memset(h->held, 0, sizeof h->held);
        h->dragging = false;
        break;
    default: break;
    }
    return true;
}

/* Image pixels per window point: above 1 on high-density displays. */
static double scale(const masu_viewer *v) {
    int width = 0;
    SDL_GetWindowSize(v->window.sdl, &width, NULL);
    return width > 0 ? (double)v->window.extent.width / width : 1.0;
}

bool masu_hands_event(masu_hands *h, masu_viewer *v, const SDL_Event *e) {
    if (!h->held[TURN] && masu_ui_event(e, scale(v))) return true;
    switch (e->type) {
    case SDL_DROPFILE:
        masu_baker_open(v, e->drop.file);
        SDL_free(e->drop.file);
        return !v->lost;
    case SDL_QUIT: v->quit = true; return true;
    case SDL_WINDOWEVENT: return window_event(v, h, &e->window);
    case SDL_KEYDOWN:
    case SDL_KEYUP: {
        int held = held_by(e->key.keysym.sym);
        bool down = e->type == SDL_KEYDOWN;
        bool command = (e->key.keysym.mod & (KMOD_CTRL | KMOD_ALT | KMOD_GUI)) != 0;
        if (held >= 0 && (!down || !command)) return h->held[held] = down, true;
        return !down || masu_key_pressed(v, e->key.keysym.sym, e->key.keysym.mod);
    }
    case SDL_MOUSEBUTTONDOWN:
    case SDL_MOUSEBUTTONUP: {
        bool down = e->type == SDL_MOUSEBUTTONDOWN;
        if (e->button.button == SDL_BUTTON_RIGHT) look(h, down);
        if (!v->a.m) return true;
        if (e->button.button == SDL_BUTTON_LEFT) h->dragging = down && v->show == MASU_SHOW_SPLIT;
        if (h->dragging) drag(v, e->button.x);
        else if (down && e->button.button == SDL_BUTTON_LEFT)
            masu_pick_click(v, e->button.x, e->button.y);
        return true;
    }
    case SDL_MOUSEMOTION:
        if (h->held[TURN]) {
            h->yaw -= LOOK * e->motion.xrel;
            h->pitch -= LOOK * e->motion.yrel;
        } else if (h->dragging) {
            drag(v, e->motion.x);
        }
        return true;
    case SDL_MOUSEWHEEL:
        masu_fly_faster(&v->fly, e->wheel.y);
        masu_viewer_note(v, "speed %.3g m/s", v->fly.speed);
        return true;
    case SDL_CONTROLLERDEVICEADDED:
        if (!h->pad) h->pad = SDL_GameControllerOpen(e->cdevice.which);
        return true;
    case SDL_CONTROLLERDEVICEREMOVED:
        if (h->pad && SDL_GameControllerFromInstanceID(e->cdevice.which) == h->pad)
            masu_hands_close(h);
        return true;
    case SDL_CONTROLLERBUTTONDOWN: masu_pad_pressed(v, e->cbutton.button); return true;
    default: return true;
    }
}

static double axis(SDL_GameController *pad, SDL_GameControllerAxis which) {
    double a = SDL_GameControllerGetAxis(pad, which) / 32767.0;
    double beyond = fabs(a) - STICK_IDLE;
    return beyond > 0.0 ? copysign(fmin(beyond / (1.0 - STICK_IDLE), 1.0), a) : 0.0;
}

static void add_pad(SDL_GameController *pad, masu_fly_wish *w, double seconds) {
    w->right += axis(pad, SDL_CONTROLLER_AXIS_LEFTX);
    w->forward -= axis(pad, SDL_CONTROLLER_AXIS_LEFTY);
    w->yaw -= STICK_TURN * seconds * axis(pad, SDL_CONTROLLER_AXIS_RIGHTX);
    w->pitch -= STICK_TURN * seconds * axis(pad, SDL_CONTROLLER_AXIS_RIGHTY);
    w->up +=
        axis(pad, SDL_CONTROLLER_AXIS_TRIGGERRIGHT) - axis(pad, SDL_CONTROLLER_AXIS_TRIGGERLEFT);
    if (SDL_GameControllerGetButton(pad, SDL_CONTROLLER_BUTTON_LEFTSTICK)) w->fast = true;
}

void masu_hands_move(masu_hands *h, masu_viewer *v, double seconds) {
    masu_fly_wish w = {.right = h->held[RIGHT] - h->held[LEFT],
                       .up = h->held[UP] - h->held[DOWN],
                       .forward = h->held[FORWARD] - h->held[BACK],
                       .yaw = h->yaw,
                       .pitch = h->pitch,
                       .fast = h->held[FAST]};
    if (h->pad) add_pad(h->pad, &w, seconds);
    h->yaw = h->pitch = 0.0;
    bool moves =
        w.right != 0.0 || w.up != 0.0 || w.forward != 0.0 || w.yaw != 0.0 || w.pitch != 0.0;
    if (!moves || !v->a.m) return;
    v->recorder.plays = false;
    if (v->on_path) { /* manual control leaves the path at the current camera */
        masu_camera camera;
        masu_viewer_camera(v, &camera);
        masu_fly_from(&v->fly, &camera);
        v->on_path = false;
    }
    (void)masu_fly_move(&v->fly, &w, seconds);
    v->moved = v->frames;
}

void masu_hands_close(masu_hands *h) {
    if (h->pad) SDL_GameControllerClose(h->pad);
    h->pad = NULL;
}

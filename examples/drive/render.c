/* render.c: see render.h.
 *
 * Memory: one static block of host memory, and one block of device memory for each role, large
 * enough for the largest window. masu_memory_query returns a plan's requirements; a plan that
 * does not fit is rejected before anything is created. On unified memory the first role is all. */
#include "render.h"

#include <stdio.h>
#include <string.h>

#define HOST_BYTES (4u << 20)
static const VkDeviceSize device_bytes[MASU_ROLE_COUNT] = {320u << 20, 64u << 20, 4u << 20};
static _Alignas(64) unsigned char host_block[HOST_BYTES];

static bool failed(const masu_detail *detail) {
    const char *text = detail->text[0] ? detail->text : masu_result_string(detail->result);
    return fprintf(stderr, "drive: %s\n", text), false;
}

static masu_desc describe(const render *r) {
    masu_desc d = {
        MASU_DESC, .vulkan = window_vulkan(r->window),
        .scene = &r->scene,
        .output = r->window->size,
        .targets = window_targets(r->window),
        .frames_in_flight = WINDOW_SLOTS,
        .ladder = MASU_ON,
        .analytic_sky = 1, .resizable = 1,
        .exposure = {.metered = MASU_ON},
        .live_environment = 1, .instance_looks = 1,
        .post = MASU_POST_BLOOM,
        .init_in_steps = 1, .first_rung = r->fixed_rung < 0 ? 0 : (uint32_t)r->fixed_rung,
        .governor = {.mode = r->fixed_rung < 0 ? MASU_GOVERNOR_ON : MASU_GOVERNOR_FIXED,
                     .rung = r->fixed_rung < 0 ? 0 : (uint32_t)r->fixed_rung,
                     .target_ms = r->target_ms}};
    memcpy(d.device_blocks, r->blocks, sizeof d.device_blocks);
    effects_reserve(&r->scene, &d.reserve);
    return d;
}

/* Shows how many steps are done, at most ten times a second. */
static bool show_progress(render *r, const masu_progress *p) {
    window *w = r->window;
    uint32_t slot = r->bars % WINDOW_SLOTS, image;
    int dot = w->size.height < 400 ? 1 : (int)w->size.height / 200, x = (int)w->size.width / 2;
    overlay_line lines[2] = {{x - 42 * dot, (int)w->size.height / 2 - 8 * dot, dot, ""},
                             {x - 42 * dot, (int)w->size.height / 2, dot, "--------------------"}};
    if (r->bars && SDL_GetTicks() - r->shown_ms < 100) return true;
    r->shown_ms = SDL_GetTicks();
    snprintf(lines[0].text, 64, "LOADING %u/%u", p->done, p->total);
    lines[1].text[20 * p->done / (p->total ? p->total : 1)] = 0;
    if (window_begin(w, slot, &image)) return true; /* resized: the first frame follows it */
    r->bars++, r->overlay.blank = true;
    bool good = overlay_record(&r->overlay, slot, image, lines, 2, false) &&
                window_end(w, slot, image, &w->commands[slot], 1) >= VK_ERROR_OUT_OF_DATE_KHR;
    r->overlay.blank = false;
    return good;
}

/* Creates a renderer for the window's present size, in the blocks. */
static bool build(render *r) {
    masu_desc desc = describe(r);
    effects_reset(&r->effects, &r->scene);
    return !masu_init(&desc, host_block, sizeof host_block, &r->masu, &r->detail) ||
           failed(&r->detail);
}

/* Finds the brake lights of a car in the scene, relative to the car. */
static void find_brakes(render *r, int car, const track_car *start) {
    masu_model_state body, brake;
    if (masu_model_get(r->masu, r->bodies[car], &body, NULL)) return;
    for (int k = 0; k < 2; k++) {
        char name[48];
        snprintf(name, sizeof name, "%s/brake%d", start->name, k);
        r->brakes[car][k] = masu_model_find(r->masu, name);
        if (masu_model_get(r->masu, r->brakes[car][k], &brake, NULL)) continue;
        vec from = {brake.position[0] - body.position[0], brake.position[1] - body.position[1],
                    brake.position[2] - body.position[2]};
        r->brake_at[car][k] = (vec){dot(from, start->ahead), dot(from, start->up),
                                    dot(from, cross(start->ahead, start->up))};
    }
}

/* The other rungs follow in render_frame, so the game starts early. */
bool render_load(render *r, const track *t) {
    masu_result loaded = MASU_INCOMPLETE, stepped;
    masu_commands load;
    masu_progress progress;
    uint32_t first = r->fixed_rung < 0 ? 0 : (uint32_t)r->fixed_rung;
    do {
        if (loaded) loaded = masu_load(r->masu, &load, &r->detail);
        if (loaded == MASU_INCOMPLETE && !window_run(r->window, load.buffer)) return false;
        stepped = masu_init_step(r->masu, &progress, &r->detail);
        if (loaded < 0 || stepped < 0) return failed(&r->detail);
        if (!show_progress(r, &progress)) return false;
    } while (loaded || !(progress.rungs >> first & 1));
    r->stepping = stepped == MASU_INCOMPLETE;
    memset(r->window->submit_ns, 0, sizeof r->window->submit_ns); /* the bar is no frame */
    for (int i = 0; i < t->cars; i++) {
        r->bodies[i] = masu_model_find(r->masu, t->car[i].name);
        find_brakes(r, i, &t->car[i]);
        for (int k = 0; k < t->car[i].wheels; k++)
            r->wheels[i][k] = masu_model_find(r->masu, t->car[i].wheel[k].name);
    }
    r->lamps[0] = masu_punctual_light_find(r->masu, "head0");
    r->lamps[1] = masu_punctual_light_find(r->masu, "head1");
    return true;
}

bool render_open(render *r, window *w, const char *path) {
    masu_memory need;
    size_t bytes = 0;
    r->window = w;
    void *blob = r->blob = SDL_LoadFile(path, &bytes);
    if (!blob) return fprintf(stderr, "drive: %s\n", SDL_GetError()), false;
    if (masu_scene_bind(blob, bytes, &r->scene, &r->detail)) return failed(&r->detail);
    masu_desc desc = describe(r); /* the blocks are to be of the types that it would take itself */
    if (masu_memory_query(&desc, &need, &r->detail)) return failed(&r->detail);
    effects_open(&r->effects);
    return window_blocks(w, &need, device_bytes, r->blocks) && overlay_open(&r->overlay, w) &&
           build(r);
}

bool render_resize(render *r, const track *t) {
    masu_desc desc = describe(r);
    masu_governor_state learnt;
    if (masu_resize(r->masu, desc.output, &desc.targets, NULL, NULL) == MASU_OK) return true;
    /* The window is larger than planned, or has another number of images. */
    if (masu_governor_save(r->masu, &learnt, NULL)) return false;
    masu_destroy(r->masu);
    r->masu = NULL, r->frame = 0;
    return build(r) && render_load(r, t) &&
           masu_governor_restore(r->masu, &learnt, NULL) == MASU_OK;
}

void render_close(render *r) {
    window *w = r->window;
    if (!w || !w->device) return;
    vkDeviceWaitIdle(w->device);
    masu_destroy(r->masu);
    for (int i = 0; i < MASU_ROLE_COUNT; i++) vkFreeMemory(w->device, r->blocks[i].memory, NULL);
    overlay_close(&r->overlay);
    SDL_free(r->blob);
}

/* The model stands at `at`, its axes turned to these. The scene has turned its models already, by
 * how the cars stand at the start: that is taken back first. */
static masu_result place(render *r, masu_model model, const vec now[3], vec at,
                         const track_car *start) {
    const vec first[3] = {start->ahead, start->up, cross(start->ahead, start->up)};
    vec row[3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (int k = 0; k < 3; k++) {
        row[0] = add(row[0], first[k], now[k].x), row[1] = add(row[1], first[k], now[k].y);
        row[2] = add(row[2], first[k], now[k].z);
    }
    float rows[12] = {(float)row[0].x, (float)row[0].y, (float)row[0].z, (float)at.x,
                      (float)row[1].x, (float)row[1].y, (float)row[1].z, (float)at.y,
                      (float)row[2].x, (float)row[2].y, (float)row[2].z, (float)at.z};
    return model.id ? masu_model_set_transform(r->masu, model, rows, &r->detail) : MASU_OK;
}

static masu_result place_car(render *r, int i, const car *c, const track_car *start, bool dusk) {
    vec road[3] = {c->ahead, c->up, cross(c->ahead, c->up)}, none = {0, 0, 0};
    masu_result result = place(r, r->bodies[i], road, add(c->at, c->up, start->clearance), start);
    for (int k = 0; !result && k < start->wheels; k++) {
        const track_wheel *w = &start->wheel[k];
        double yaw = w->steers ? c->steer : 0, roll = c->roll / w->radius;
        vec ahead = add(add(none, road[0], cos(yaw)), road[2], sin(yaw));
        vec front = add(add(none, ahead, cos(roll)), road[1], -sin(roll)); /* so far it rolled */
        vec right = cross(ahead, road[1]);
        vec at = add(add(add(c->at, road[0], w->ahead), road[2], w->right), road[1], w->radius);
        result = place(r, r->wheels[i][k], (vec[3]){front, cross(right, front), right}, at, start);
    }
    /* The scene has the emission of a braking car. At dusk its tail lights are on. */
    const masu_look look = {.emission = c->braking ? 1 : dusk ? 0.1f : -1};
    for (int k = 0; !result && k < 2 && r->brakes[i][k].id; k++) {
        vec from = r->brake_at[i][k], at = add(add(c->at, road[0], from.x), road[2], from.z);
        at = add(at, c->up, start->clearance + from.y);
        result = place(r, r->brakes[i][k], road, at, start);
        if (!result) result = masu_model_set_look(r->masu, r->brakes[i][k], &look, &r->detail);
    }
    return result;
}

/* A spot without an instance is in world space: head lights are updated in each frame. */
static masu_result set_lamps(render *r, const car *c, float on) {
    vec right = cross(c->ahead, c->up), to = add(c->ahead, c->up, -0.06);
    masu_result result = MASU_OK;
    for (int i = 0; !result && i < 2; i++) {
        vec at = add(add(add(c->at, c->ahead, 2.0), right, i ? 0.6 : -0.6), c->up, 0.65);
        masu_punctual_light_state s = {.position = {at.x, at.y, at.z},
                                       .direction = {(float)to.x, (float)to.y, (float)to.z},
                                       .color = {40 * on, 36 * on, 28 * on},
                                       .range = 90, .radius = 0.05f,
                                       .spot = 1, .inner = 0.1f, .outer = 0.5f};
        if (r->lamps[i].id) result = masu_punctual_light_set(r->masu, r->lamps[i], &s, &r->detail);
    }
    return result;
}

static masu_result set_light(render *r, const render_view *view, masu_light *light) {
    masu_result result = masu_light_of(r->masu, light, &r->detail);
    if (view->dusk) {
        light->turbidity = 4;
        light->exposure = 0.3f; /* metered: a third of the brightness of a day */
        memcpy(light->sun_direction, (float[3]){-0.95f, 0.05f, 0.3f}, sizeof light->sun_direction);
        memset(light->sun_color, 0, sizeof light->sun_color); /* the sun's behind so much air */
    }
    if (view->rain) { /* clouds: little sun, a gray background */
        float gray = view->dusk ? 0.02f : 0.2f, sun = view->dusk ? 0.01f : 0.25f;
        light->exposure *= 0.6f, light->turbidity = 9;
        light->environment.background_intensity = 0.3f;
        for (int k = 0; k < 3; k++)
            light->environment.background_color[k] = gray, light->sun_color[k] = sun;
    }
    return result;
}

static bool record_hud(render *r, uint32_t slot, uint32_t image, const race *race,
                       const render_view *view) {
    const VkExtent2D size = r->window->size;
    int dot = size.height < 400 ? 1 : size.height < 1800 ? (int)size.height / 200 : 9;
    int bottom = (int)size.height - 11 * dot;
    overlay_line lines[3] = {{4 * dot, 4 * dot, dot, ""}, {4 * dot, bottom, dot, ""},
                             {(int)size.width / 2 - 25 * dot, bottom / 3, 2 * dot, "PAUSED"}};
    double now = race->time, best = race->best, speed = fabs(car_speed(&race->cars[0]));
    snprintf(lines[0].text, 64, "LAP %d  %d:%05.2f  BEST %d:%05.2f", race->laps + 1,
             (int)(now / 60), fmod(now, 60), (int)(best / 60), fmod(best, 60));
    snprintf(lines[1].text, 64, "%.0f KM/H  RUNG %u", speed * 3.6, r->rung);
    return overlay_record(&r->overlay, slot, image, lines, view->paused ? 3 : 2, view->photo[0]);
}

bool render_frame(render *r, const race *race, const render_view *view, bool *outdated) {
    window *w = r->window;
    masu_light light;
    masu_commands commands;
    masu_result result = MASU_OK;
    uint32_t slot = (uint32_t)(r->frame % WINDOW_SLOTS), image;
    VkResult got = window_begin(w, slot, &image);
    *outdated = got == VK_ERROR_OUT_OF_DATE_KHR;
    if (got) return *outdated;
    if (w->submit_ns[slot]) {
        masu_frame_times(r->masu, slot, w->submit_ns[slot], w->done_ns[slot], 0);
        r->over += w->frame_ms > (double)r->target_ms;
    }
    for (int i = 0; !result && i < race->track->cars; i++)
        result = place_car(r, i, &race->cars[i], &race->track->car[i], view->dusk);
    if (!result) result = set_lamps(r, &race->cars[0], view->lamps);
    if (!result) result = set_light(r, view, &light);
    vec forward = add(race->target, race->eye, -1);
    double speed = fmin(fabs(car_speed(&race->cars[0])), 70);
    masu_camera camera = {.position = {race->eye.x, race->eye.y, race->eye.z},
                          .forward = {(float)forward.x, (float)forward.y, (float)forward.z},
                          .fov_y = 1.05f + 0.0022f * (float)speed,
                          .near_distance = 0.2f};
    masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .light = &light, .target = image,
                             .cut = view->cut, .time = view->time, .time_step = view->step,
                             .post.bloom = view->dusk && view->bloom ? 0.1f : 0,
                             .exclude_from_timing = r->stepping,
                             .rung = MASU_RUNG_AUTO};
    if (!result) result = effects_frame(&r->effects, r->masu, race, view->rain, &frame, &r->detail);
    for (Uint32 from = SDL_GetTicks(); !result && r->stepping;) {
        masu_result step = masu_init_step(r->masu, NULL, &r->detail);
        r->stepping = step == MASU_INCOMPLETE, result = step < 0 ? step : MASU_OK, r->late++;
        if ((float)(SDL_GetTicks() - from) > r->target_ms / 2) break;
    }
    if (result || masu_frame(r->masu, &frame, &commands, &r->detail)) return failed(&r->detail);
    r->changes += r->frames && commands.rung != r->rung;
    r->frame++, r->frames++, r->rungs |= 1u << commands.rung, r->rung = commands.rung;
    if (!record_hud(r, slot, image, race, view)) return false;
    got = window_end(w, slot, image, (VkCommandBuffer[2]){commands.buffer, w->commands[slot]}, 2);
    *outdated = got == VK_ERROR_OUT_OF_DATE_KHR || got == VK_SUBOPTIMAL_KHR;
    return (got >= 0 || *outdated) && (!view->photo[0] || overlay_save(&r->overlay, view->photo));
}

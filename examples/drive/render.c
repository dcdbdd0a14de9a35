/* render.c: see render.h.
 *
 * The box: one static block of the host's memory and one of the device's for each role, as large as the
 * largest window that the game is for needs. masu_memory_query says what a plan needs; what does not fit is
 * refused before anything is made. On unified memory the first role is all there is. */
#include "render.h"

#include "hud.h"
#include "png.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define HOST_BYTES (4u << 20)
#define SCENE_BYTES (64u << 20)
static const VkDeviceSize device_bytes[MASU_ROLE_COUNT] = {320u << 20, 64u << 20, 4u << 20};
static _Alignas(64) unsigned char host_block[HOST_BYTES];

static bool failed(const masu_detail *detail) {
    fprintf(stderr, "drive: %s\n", detail->text[0] ? detail->text : masu_result_string(detail->result));
    return false;
}

bool render_open(render *r, window *w, const char *path) {
    masu_detail detail = {0};
    r->window = w;
    FILE *in = fopen(path, "rb");
    void *blob = in ? malloc(SCENE_BYTES) : NULL;
    size_t bytes = blob ? fread(blob, 1, SCENE_BYTES, in) : 0;
    bool whole = bytes && bytes < SCENE_BYTES && !ferror(in);
    if (in) fclose(in);
    if (whole && masu_scene_bind(blob, bytes, &r->scene, &detail) == MASU_OK) return true;
    free(blob);
    if (whole) return failed(&detail);
    return fprintf(stderr, "drive: cannot read %s (of at most %u bytes)\n", path, SCENE_BYTES), false;
}

static masu_desc describe(const render *r) {
    const window *w = r->window;
    masu_desc d = {
        .vulkan = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                   .instance = w->instance,
                   .physical_device = w->gpu,
                   .device = w->device,
                   .queue_family = w->family,
                   .texture_compression_bc = w->features.textureCompressionBC,
                   .max_anisotropy = w->anisotropy},
        .scene = &r->scene,
        .output = w->size,
        .targets = {.images = w->images,
                    .count = w->count,
                    .format = w->format,
                    .final_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL}, /* for the HUD */
        .frames_in_flight = WINDOW_SLOTS,
        .ladder = MASU_ON,
        .analytic_sky = 1,
        .resizable = 1,
        .exposure = {.metered = MASU_ON},
        .governor = {.mode = MASU_GOVERNOR_ON, .target_ms = r->target_ms}};
    if (r->fixed_rung >= 0) d.governor.mode = MASU_GOVERNOR_FIXED, d.governor.rung = (uint32_t)r->fixed_rung;
    memcpy(d.device_blocks, r->blocks, sizeof d.device_blocks);
    return d;
}

/* Before the first renderer: the device's blocks, of the types that it would take itself. */
static bool take_blocks(render *r) {
    masu_desc desc = describe(r);
    masu_memory need;
    masu_detail detail = {0};
    if (masu_memory_query(&desc, &need, &detail)) return failed(&detail);
    for (int i = 0; i < MASU_ROLE_COUNT; i++) {
        masu_device_block *b = &r->blocks[i];
        if (!need.roles[i].bytes) continue;
        if (!window_allocate(r->window, need.roles[i].type, device_bytes[i], &b->memory)) return false;
        b->bytes = device_bytes[i];
        b->memory_type = need.roles[i].type;
        if (need.roles[i].host_visible &&
            vkMapMemory(r->window->device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped))
            return fprintf(stderr, "drive: the device's memory cannot be mapped\n"), false;
    }
    return true;
}

static void find_models(render *r, const track *t) {
    for (int i = 0; i < t->cars; i++) {
        r->bodies[i] = masu_model_find(r->masu, t->car[i].name);
        for (int k = 0; k < t->car[i].wheels; k++)
            r->wheels[i][k] = masu_model_find(r->masu, t->car[i].wheel[k].name);
    }
    r->lamps[0] = masu_punctual_light_find(r->masu, "head0");
    r->lamps[1] = masu_punctual_light_find(r->masu, "head1");
}

static void leave(render *r) {
    vkDeviceWaitIdle(r->window->device);
    masu_destroy(r->masu);
    r->masu = NULL, r->frame = 0;
    r->missed += r->missed_now, r->missed_now = 0; /* a new governor counts anew */
}

bool render_build(render *r, const track *t) {
    masu_detail detail = {0};
    masu_memory need;
    masu_commands load;
    masu_result result;
    if (!r->blocks[MASU_ROLE_DEVICE].memory && !take_blocks(r)) return false;
    masu_desc desc = describe(r);
    if (masu_memory_query(&desc, &need, &detail)) return failed(&detail);
    for (int i = 0; i < MASU_ROLE_COUNT; i++) {
        if (need.roles[i].bytes <= r->blocks[i].bytes) continue;
        fprintf(stderr, "drive: %ux%u needs %llu bytes of device memory in role %d; the game has %llu\n",
                desc.output.width, desc.output.height, (unsigned long long)need.roles[i].bytes, i,
                (unsigned long long)r->blocks[i].bytes);
        return false;
    }
    if (masu_init(&desc, host_block, sizeof host_block, &r->masu, &detail)) return failed(&detail);
    while ((result = masu_load(r->masu, &load)) == MASU_INCOMPLETE) {
        if (!window_run(r->window, load.buffer)) return false;
    }
    if (result) return failed(masu_last_error(r->masu));
    find_models(r, t);
    return true;
}

bool render_resize(render *r, const track *t) {
    masu_desc desc = describe(r);
    memset(r->submitted, 0, sizeof r->submitted); /* what is between two sizes is no frame's time */
    if (masu_resize(r->masu, desc.output, &desc.targets, NULL, NULL) == MASU_OK) return true;
    leave(r); /* it is larger than what was planned for, or has another number of images */
    return render_build(r, t);
}

/* ---- a frame ---- */

typedef struct pose {
    vec ahead, up, right, at;
} pose;

/* `turned` is turned about its own axes first: by `yaw` to the right, by `roll` forwards. */
static pose turn(pose p, double yaw, double roll) {
    vec ahead = add(mix((vec){0, 0, 0}, p.ahead, cos(yaw)), p.right, sin(yaw));
    vec right = cross(ahead, p.up);
    vec front = add(mix((vec){0, 0, 0}, ahead, cos(roll)), p.up, -sin(roll));
    return (pose){front, cross(right, front), right, p.at};
}

/* The scene has turned its models already, by how the cars stand at the start: that is taken back first. */
static void rows_of(const pose *now, const pose *start, float rows[12]) {
    const double n[3][4] = {{now->ahead.x, now->up.x, now->right.x, now->at.x},
                            {now->ahead.y, now->up.y, now->right.y, now->at.y},
                            {now->ahead.z, now->up.z, now->right.z, now->at.z}};
    const vec s[3] = {start->ahead, start->up, start->right};
    for (int i = 0; i < 3; i++) {
        vec row = {0, 0, 0};
        for (int k = 0; k < 3; k++) row = add(row, s[k], n[i][k]);
        rows[4 * i] = (float)row.x, rows[4 * i + 1] = (float)row.y, rows[4 * i + 2] = (float)row.z;
        rows[4 * i + 3] = (float)n[i][3];
    }
}

static bool place_car(render *r, int i, const car *c, const track_car *start) {
    float rows[12];
    pose road = {c->ahead, c->up, cross(c->ahead, c->up), c->at};
    pose first = {start->ahead, start->up, cross(start->ahead, start->up), start->at};
    pose body = turn(road, 0, -c->pitch);
    body.up = unit(add(body.up, body.right, -c->lean)), body.right = cross(body.ahead, body.up);
    body.at = add(road.at, road.up, start->clearance);
    rows_of(&body, &first, rows);
    if (r->bodies[i].id && masu_model_set_transform(r->masu, r->bodies[i], rows)) return false;
    for (int k = 0; k < start->wheels; k++) {
        pose wheel = turn(road, start->wheel[k].steers ? c->steer : 0, c->roll / start->wheel[k].radius);
        wheel.at = add(add(add(road.at, road.ahead, start->wheel[k].ahead), road.right, start->wheel[k].right),
                       road.up, start->wheel[k].radius);
        rows_of(&wheel, &first, rows);
        if (r->wheels[i][k].id && masu_model_set_transform(r->masu, r->wheels[i][k], rows)) return false;
    }
    return true;
}

/* Into the space of an instance that is neither scaled nor sheared. */
static vec into(const float m[12], vec v, bool is_place) {
    if (is_place) v = add(v, (vec){(double)m[3], (double)m[7], (double)m[11]}, -1);
    return (vec){dot(v, (vec){(double)m[0], (double)m[4], (double)m[8]}),
                 dot(v, (vec){(double)m[1], (double)m[5], (double)m[9]}),
                 dot(v, (vec){(double)m[2], (double)m[6], (double)m[10]})};
}

/* The head lights ride on the first instance of the car's model, whatever that is a part of. */
static bool set_lamps(render *r, const race *race, bool on) {
    const car *c = &race->cars[race->player];
    masu_node_state node = {.instance = {0}};
    masu_instance_state carrier;
    for (uint32_t i = 0; !node.instance.id; i++) {
        if (masu_model_node_get(r->masu, r->bodies[race->player], i, &node)) return true; /* nothing to ride on */
    }
    if (masu_instance_get(r->masu, node.instance, &carrier)) return false;
    for (int i = 0; i < 2; i++) {
        masu_punctual_light_state s;
        if (!r->lamps[i].id || masu_punctual_light_get(r->masu, r->lamps[i], &s)) continue;
        vec at = add(add(c->at, c->ahead, 2.0), cross(c->ahead, c->up), i ? 0.6 : -0.6);
        at = into(carrier.rows, add(at, c->up, 0.65), true);
        vec to = into(carrier.rows, add(c->ahead, c->up, -0.06), false);
        s = (masu_punctual_light_state){.position = {at.x, at.y, at.z},
                                        .direction = {(float)to.x, (float)to.y, (float)to.z},
                                        .color = {on ? 40 : 0, on ? 36 : 0, on ? 28 : 0},
                                        .range = 90, .radius = 0.05f, .spot = 1, .inner = 0.1f, .outer = 0.5f,
                                        .instance = node.instance};
        if (masu_punctual_light_set(r->masu, r->lamps[i], &s)) return false;
    }
    return true;
}

static bool set_light(render *r, const render_view *view, masu_light *light) {
    if (masu_light_of(r->masu, light)) return false;
    if (!view->dusk) return true;
    light->turbidity = 4;
    light->exposure = 0.3f; /* metered: a third of the brightness of a day */
    memcpy(light->sun_direction, (float[3]){-0.95f, 0.05f, 0.3f}, sizeof light->sun_direction);
    memset(light->sun_color, 0, sizeof light->sun_color); /* the sun's behind so much air */
    return true;
}

/* The slot is free again: what its last frame took goes to the governor. */
static bool finish(render *r, uint32_t slot) {
    static Uint64 end;
    masu_stats_info stats;
    if (!window_wait(r->window, slot)) return false;
    Uint64 now = SDL_GetPerformanceCounter(), from = r->submitted[slot] > end ? r->submitted[slot] : end;
    if (r->submitted[slot])
        masu_frame_wall(r->masu, slot, 1e3 * (double)(now - from) / (double)SDL_GetPerformanceFrequency());
    end = now;
    if (masu_stats(r->masu, slot, &stats) == MASU_OK) r->missed_now = stats.governor.missed;
    return true;
}

bool render_frame(render *r, const race *race, const render_view *view, bool *outdated) {
    window *w = r->window;
    masu_light light;
    masu_commands commands;
    uint32_t slot = (uint32_t)(r->frame % WINDOW_SLOTS), image;
    bool good = finish(r, slot);
    VkResult got = good ? window_acquire(w, slot, &image) : VK_ERROR_UNKNOWN;
    *outdated = got == VK_ERROR_OUT_OF_DATE_KHR;
    if (got) return *outdated;
    for (int i = 0; good && i < race->track->cars; i++)
        good = place_car(r, i, &race->cars[i], &race->track->car[i]);
    good = good && set_lamps(r, race, view->lamps) && set_light(r, view, &light);
    masu_frame_desc frame = {.camera = &view->camera, .light = &light, .time = view->time, .time_step = view->step,
                             .rung = MASU_RUNG_AUTO, .target = image, .cut = view->cut};
    if (!good || masu_frame(r->masu, &frame, &commands)) return failed(masu_last_error(r->masu));
    r->frame++, r->frames++, r->rungs |= 1u << commands.rung;
    VkCommandBuffer own = w->commands[slot];
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                      .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    bool photo = view->photo && (VkDeviceSize)w->size.width * w->size.height * 4 <= PHOTO_BYTES;
    if (view->photo && !photo) fprintf(stderr, "drive: the window is too large for a photo\n");
    if (vkBeginCommandBuffer(own, &begin)) return false;
    hud_record(w, own, image, race, view->paused, commands.rung);
    if (photo) window_copy_photo(w, own, image);
    if (vkEndCommandBuffer(own)) return false;
    r->submitted[slot] = SDL_GetPerformanceCounter();
    got = window_show(w, slot, image, commands.buffer);
    *outdated = got == VK_ERROR_OUT_OF_DATE_KHR || got == VK_SUBOPTIMAL_KHR;
    if (got < 0 && !*outdated) return fprintf(stderr, "drive: the frame cannot be shown: VkResult %d\n", got), false;
    return !photo || (window_wait(w, slot) && png_write(view->photo, w->photo_pixels, w->size.width, w->size.height,
                                                        w->format == VK_FORMAT_B8G8R8A8_UNORM));
}

void render_close(render *r) {
    if (!r->window || !r->window->device) return;
    leave(r);
    for (int i = 0; i < MASU_ROLE_COUNT; i++) vkFreeMemory(r->window->device, r->blocks[i].memory, NULL);
    free((void *)r->scene.blob);
}

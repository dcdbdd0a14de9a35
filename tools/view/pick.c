/* pick.c: picking by mouse click. The next frame requests the pixel; when its slot has finished,
 * the result is shown for a while next to a cross. Names point into the blob, which remains in
 * memory. */
#include "view/viewer.h"

#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

#define SHOWN_TURNS 240u /* as a note */

void masu_pick_click(masu_viewer *v, int x, int y) {
    int width = 0, height = 0;
    SDL_GetWindowSize(v->window.sdl, &width, &height);
    VkExtent2D e = v->window.extent;
    if (width < 1 || height < 1 || x < 0 || y < 0 || x >= width || y >= height) return;
    /* Window points differ from pixels on high-density displays. */
    v->picked.x = (uint32_t)((uint64_t)x * e.width / (uint64_t)width);
    v->picked.y = (uint32_t)((uint64_t)y * e.height / (uint64_t)height);
    v->picked.asked = true;
}

void masu_pick_ask(masu_viewer *v, masu_frame_desc *frame) {
    /* The window may have shrunk since the click. */
    if (v->picked.x >= v->a.target.width || v->picked.y >= v->a.target.height)
        v->picked.asked = false;
    frame->pick = v->picked.asked;
    frame->pick_x = v->picked.x;
    frame->pick_y = v->picked.y;
}

void masu_pick_asked(masu_viewer *v, uint32_t slot) {
    masu_frame_view view;
    v->picked.of_slot[slot] = v->picked.asked;
    if (v->picked.asked && !masu_frame_view_of(v->a.m, &view, NULL))
        v->picked.near_distance = (double)view.near_distance;
    v->picked.asked = false;
}

/* "instance 'door'"; for a movable model preceded by "node 3 of model 'car'". */
static void name_it(const masu_viewer *v, const masu_pick_info *p, char *out, size_t size) {
    masu_instance_state instance;
    masu_model_state model;
    int used = 0;
    if (p->kind != MASU_PICK_INSTANCE) {
        snprintf(out, size, "%s", p->kind == MASU_PICK_SDF ? "the SDF" : "the sky");
        return;
    }
    if (p->model.id && !masu_model_get(v->a.m, p->model, &model, NULL)) {
        used = snprintf(out, size, "node %u of model '%.60s', ", p->node,
                        masu_scene_name(&v->scene, MASU_SCENE_MODEL, model.index));
    }
    if (!p->instance.id || masu_instance_get(v->a.m, p->instance, &instance, NULL)) {
        snprintf(out + used, size - (size_t)used, "an edge of an instance");
        return;
    }
    snprintf(out + used, size - (size_t)used, "instance '%.60s'",
             masu_scene_name(&v->scene, MASU_SCENE_INSTANCE, instance.index));
}

void masu_pick_take(masu_viewer *v, uint32_t slot) {
    masu_pick_info p;
    char name[200];
    if (!v->picked.of_slot[slot]) return;
    v->picked.of_slot[slot] = false;
    if (masu_pick(v->a.m, v->slot_of_a[slot], &p, NULL) || p.kind == MASU_PICK_NOTHING) return;
    name_it(v, &p, name, sizeof name);
    if (p.depth > 0.0f)
        snprintf(v->picked.text, sizeof v->picked.text, "%s, depth %.3f m, at %.3f %.3f %.3f", name,
                 v->picked.near_distance / (double)p.depth, p.position[0], p.position[1],
                 p.position[2]);
    else
        snprintf(v->picked.text, sizeof v->picked.text, "%s", name);
    masu_cli_plain(v->picked.text);
    v->picked.at[0] = (int)p.x;
    v->picked.at[1] = (int)p.y;
    v->picked.turn = v->turns;
    if (v->scripted && !masu_cli_quiet()) printf("%u %u: %s\n", p.x, p.y, v->picked.text);
}

void masu_pick_draw(masu_viewer *v) {
    if (!v->picked.text[0] || v->turns - v->picked.turn >= SHOWN_TURNS) return;
    float x = (float)v->picked.at[0], y = (float)v->picked.at[1], h = masu_ui_line_height();
    masu_ui_fill(x - h / 2, y, h, 1.0f, 0xFFFFFF, 1.0f);
    masu_ui_fill(x, y - h / 2, 1.0f, h, 0xFFFFFF, 1.0f);
    masu_ui_label(x + h, y < 3.0f * h ? y + h : y - 2.5f * h, 0.0f, 0.0f, MASU_INK_GOOD,
                  v->picked.text);
}

/* panels.c: the user interface of a frame: the start page, progress of a bake, tabbed panels, and
 * messages. */
#include "view/viewer.h"

#include <stdio.h>

#define NOTE_TURNS 240u /* iterations for which a note is shown */

static const struct {
    const char *name;
    void (*draw)(masu_viewer *v);
} tabs[MASU_TABS] = {{"Scene", masu_panel_scene},
                     {"Light", masu_panel_light},
                     {"Quality", masu_panel_quality},
                     {"Camera", masu_panel_camera},
                     {"Capture", masu_panel_capture}};

void masu_panels_show(masu_viewer *v, uint32_t tab) {
    masu_panels *p = &v->panels;
    if (p->open && tab == p->tab) {
        p->open = false;
        return;
    }
    p->open = p->focus = p->select = true;
    p->tab = tab;
}

static void draw_tabs(masu_viewer *v) {
    masu_panels *p = &v->panels;
    masu_ui_window("panels", MASU_UI_RIGHT, p->focus);
    p->focus = false;
    masu_ui_tabs();
    for (uint32_t t = 0; t < MASU_TABS; t++) {
        if (!masu_ui_tab(tabs[t].name, p->select && t == p->tab)) continue;
        if (!p->select) p->tab = t;
        tabs[t].draw(v);
        masu_ui_tab_end();
    }
    p->select = false;
    masu_ui_tabs_end();
    masu_ui_window_end();
}

static void draw_progress(const masu_viewer *v) {
    char text[400];
    float fraction;
    masu_baker_progress(v, &fraction, text, sizeof text);
    masu_ui_window("progress", v->a.m ? MASU_UI_BOTTOM : MASU_UI_MIDDLE, false);
    masu_ui_progress(fraction, text);
    masu_ui_window_end();
}

static void draw_messages(const masu_viewer *v) {
    bool noted = *v->note && v->turns - v->note_turn < NOTE_TURNS, keys = v->hud != MASU_HUD_OFF;
    if (!*v->trouble && !noted && !keys && !v->recorder.films && !v->recorder.records) return;
    masu_ui_window("messages", MASU_UI_BOTTOM, false);
    if (*v->trouble)
        masu_ui_text(MASU_INK_BAD, "%s", v->trouble);
    else if (noted)
        masu_ui_text(MASU_INK_GOOD, "%s", v->note);
    if (v->recorder.films)
        masu_ui_text(MASU_INK_WARN, "video: %llu frames (F9 ends it)",
                     (unsigned long long)v->recorder.filmed);
    if (v->recorder.records) masu_ui_text(MASU_INK_WARN, "camera path: %.1f s", v->recorder.time);
    if (keys && (v->gallery.open || !v->a.m))
        masu_ui_text(MASU_INK_DIM, "F1 text  F4 start page  F11 full screen  Esc exit");
    else if (keys)
        masu_ui_text(MASU_INK_DIM,
                     "F1 text  Tab panels  F4 start page  F5 scene  F6 light  F7 quality  F8 "
                     "camera  F10 capture  F9 video  "
                     "F2 split  F3 difference  P path  Space pause  F12 screenshot  Esc exit");
    masu_ui_window_end();
}

void masu_panels_draw(masu_viewer *v) {
    if (v->gallery.open)
        masu_gallery_draw(v);
    else if (v->a.m)
        masu_hud_draw(v);
    if (v->panels.open && v->a.m && !v->gallery.open) draw_tabs(v);
    if (v->baker.child) draw_progress(v);
    draw_messages(v);
}

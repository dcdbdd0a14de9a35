/* menu.c: the knobs of the rung that is shown, as a list to change. A row is a value of a knob
 * (masu_knob_table), those without use in this scene left out; a change goes into v->want and takes
 * effect at the end of the turn, when the renderer is made anew. */
#include "view/viewer.h"

#include "settings/setting.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROWS_MAX = 128, NAME = 20, VALUE = 12, COLUMNS = NAME + VALUE + 4 };

typedef struct masu_menu_row {
    const masu_knob *knob;
    uint32_t value;
} masu_menu_row;

static uint32_t list_rows(const masu_viewer *v, masu_menu_row rows[ROWS_MAX]) {
    uint32_t count = 0;
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        if (masu_knob_useless(k, &v->want.rungs[v->rung], &v->scene, &v->plan)) continue;
        for (uint32_t i = 0; i < k->values && count < ROWS_MAX; i++) rows[count++] = (masu_menu_row){k, i};
    }
    return count;
}

/* ---- Changing -------------------------------------------------------------------------------- */

/* What 0 stands for: where the row says "the scene's", that; else what it is resolved to, beside a past or without. */
static double of_scene(const masu_viewer *v, const masu_knob *k) {
    uint32_t resolution, cascades = masu_scene_shadow_cascades(&v->scene, &resolution);
    if (!strcmp(k->name, "shadow_distance")) return (double)masu_scene_shadow_distance(&v->scene);
    if (!strcmp(k->name, "shadow_resolution")) return resolution;
    if (!strcmp(k->name, "shadow_cascades")) return cascades;
    if (!strcmp(k->name, "specular_cutoff")) return (double)masu_scene_specular_cutoff(&v->scene);
    masu_desc plain = {.rung_count = 1, .rungs = {{.temporal = v->want.rungs[v->rung].temporal}}};
    plain = masu_desc_resolved(&plain);
    return masu_knob_get(k, &plain.rungs[0], 0);
}

/* One step of the arrow keys. Small counts and fractions are added to, what spans decades is multiplied. */
static double stepped(const masu_viewer *v, const masu_knob *k, double now, int way) {
    if (k->kind == MASU_KNOB_WORD) {
        int count = (int)k->word_count;
        return ((int)now + way + count) % count;
    }
    double from = now == 0.0 ? of_scene(v, k) : now, span = k->max - k->min, to;
    if (k->kind == MASU_KNOB_COUNT) {
        bool wide = span > 300.0;
        to = wide ? (way > 0 ? from * 2.0 : floor(from / 2.0)) : from + way;
    } else if (k->min < 0.0) {
        to = from + 0.5 * way;
    } else if (span <= 64.0) {
        double step = span <= 1.0 ? 0.05 : 0.25;
        to = step * round(from / step + way);
        if (to <= 0.0) to = k->zero == 0.0 ? 0.0 : step; /* 0 would mean the default */
    } else {
        to = way > 0 ? fmax(from, 1.0) * 1.25 : from / 1.25;
    }
    return fmin(fmax(to, k->min), k->max);
}

static void put(masu_viewer *v, const masu_menu_row *row, double to) {
    masu_rung *rung = &v->want.rungs[v->rung];
    char text[32];
    if (to == masu_knob_get(row->knob, rung, row->value) || !masu_knob_accepts(row->knob, to))
        return;
    masu_knob_set(row->knob, rung, row->value, to);
    masu_knob_text(row->knob, rung, text, sizeof text);
    v->want.flips[v->rung] = 0.0f; /* it was measured of another setting */
    v->governed = false;
    v->changed = true;
    snprintf(v->change, sizeof v->change, "%s=%s", row->knob->name, text);
}

bool masu_menu_key(masu_viewer *v, SDL_Keycode key) {
    masu_menu_row rows[ROWS_MAX];
    uint32_t count = list_rows(v, rows);
    if (v->menu.row >= count) v->menu.row = count - 1;
    const masu_menu_row *row = &rows[v->menu.row];
    double now = masu_knob_get(row->knob, &v->want.rungs[v->rung], row->value);
    switch (key) {
    case SDLK_UP: v->menu.row = (v->menu.row + count - 1) % count; return true;
    case SDLK_DOWN: v->menu.row = (v->menu.row + 1) % count; return true;
    case SDLK_LEFT: put(v, row, stepped(v, row->knob, now, -1)); return true;
    case SDLK_RIGHT: put(v, row, stepped(v, row->knob, now, 1)); return true;
    case SDLK_BACKSPACE:
    case SDLK_DELETE: put(v, row, 0.0); return true;
    case SDLK_ESCAPE: v->menu.open = false; return true;
    default: return false;
    }
}

/* ---- Drawing --------------------------------------------------------------------------------- */

/* As the row's value is written; what 0 means beside it. */
static void value_text(const masu_viewer *v, const masu_menu_row *row, char *out, size_t size) {
    const masu_knob *k = row->knob;
    double now = masu_knob_get(k, &v->want.rungs[v->rung], row->value);
    if (k->kind == MASU_KNOB_WORD) {
        snprintf(out, size, "%s", k->words[(uint32_t)now].word);
    } else if (now == 0.0 && of_scene(v, k) != 0.0) {
        snprintf(out, size, "(%.4g)", of_scene(v, k));
    } else {
        snprintf(out, size, "%.4g", now);
    }
}

/* Text in lines of at most `width` characters, broken at spaces; returns the y below. Measures alone
 * where `draw` is false. */
static int wrapped(masu_canvas *c, int x, int y, int width, uint32_t color, const char *text, bool draw) {
    char line[160];
    while (*text) {
        size_t n = strlen(text);
        if (n > (size_t)width) {
            n = (size_t)width;
            while (n > 0 && text[n] != ' ') n--;
            if (!n) n = (size_t)width;
        }
        snprintf(line, sizeof line, "%.*s", (int)n, text);
        if (draw) (void)masu_canvas_text(c, x, y, color, line);
        y += c->font->height;
        text += n;
        while (*text == ' ') text++;
    }
    return y;
}

void masu_menu_draw(masu_viewer *v) {
    if (!v->menu.open) return;
    masu_canvas *c = &v->canvas;
    masu_menu_row rows[ROWS_MAX];
    uint32_t count = list_rows(v, rows);
    if (v->menu.row >= count) v->menu.row = count - 1;
    int w = c->font->width, h = c->font->height, pad = h / 2;
    int lines = (c->height - 2 * pad) / h - 18; /* beside title and the text below */
    if (lines < 3) lines = 3;
    int first = (int)v->menu.row - lines / 2;
    if (first > (int)count - lines) first = (int)count - lines;
    if (first < 0) first = 0;
    int shown = (int)count - first < lines ? (int)count - first : lines;
    int x = c->width - COLUMNS * w - pad, y = pad;
    char text[256], value[48], range[200];
    const masu_knob *chosen = rows[v->menu.row].knob;
    masu_knob_range(chosen, range, sizeof range);
    if (*chosen->unit) snprintf(range + strlen(range), sizeof range - strlen(range), ", %s", chosen->unit);
    int below = wrapped(c, 0, 0, COLUMNS, 0, chosen->text, false) +
                wrapped(c, 0, 0, COLUMNS, 0, chosen->cost, false) +
                wrapped(c, 0, 0, COLUMNS, 0, range, false);
    masu_canvas_fill(c, x - pad, 0, COLUMNS * w + 2 * pad, (shown + 3) * h + below + pad, 0x0B1016, 205);
    snprintf(text, sizeof text, "Knobs of rung %u", v->rung);
    (void)masu_canvas_text(c, x, y, MASU_INK_TITLE, text);
    y += h + h / 2;
    for (int i = first; i < first + shown; i++, y += h) {
        const masu_knob *k = rows[i].knob;
        bool selected = (uint32_t)i == v->menu.row;
        double now = masu_knob_get(k, &v->want.rungs[v->rung], rows[i].value);
        bool set = now != 0.0 && now != k->zero;
        if (selected) masu_canvas_fill(c, x - pad / 2, y, COLUMNS * w + pad, h, 0x2F6EA8, 190);
        if (k->values > 1) {
            snprintf(text, sizeof text, "%.16s %u", k->name, rows[i].value + 1);
        } else {
            snprintf(text, sizeof text, "%s", k->name);
        }
        (void)masu_canvas_text(c, x, y, set ? MASU_INK : MASU_INK_DIM, text);
        value_text(v, &rows[i], value, sizeof value);
        snprintf(text, sizeof text, "%*s", VALUE, value);
        (void)masu_canvas_text(c, x + (NAME + 2) * w, y, set ? MASU_INK_WARN : MASU_INK_DIM, text);
    }
    y += h / 2;
    y = wrapped(c, x, y, COLUMNS, MASU_INK, chosen->text, true);
    y = wrapped(c, x, y, COLUMNS, MASU_INK_DIM, range, true) + h / 2;
    (void)wrapped(c, x, y, COLUMNS, MASU_INK_DIM, chosen->cost, true);
}

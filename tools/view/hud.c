/* hud.c: the overlay's numbers: F1 has it off, short or full. All of it comes from masu_stats of a frame
 * that has finished, from the plan and from the memory that was asked for; nothing is measured here. */
#include "view/viewer.h"

#include "settings/setting.h"
#include "clock.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define NOTE_TURNS 240u /* how long a note stays */
enum { WIDTH = 58, BAR = 14 };

/* A column of lines; the panel behind it is drawn first, as high as the lines turn out to be. */
typedef struct masu_lines {
    struct {
        char text[200];
        uint32_t color;
        float bar; /* 0..1: drawn at the line's end; below 0: none */
    } line[160];
    int count;
} masu_lines;

__attribute__((format(printf, 3, 4))) static void say(masu_lines *l, uint32_t color, const char *format, ...) {
    if (l->count == (int)(sizeof l->line / sizeof *l->line)) return;
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(l->line[l->count].text, sizeof l->line[0].text, format, arguments);
    va_end(arguments);
    l->line[l->count].color = color;
    l->line[l->count++].bar = -1.0f;
}

static const char *bytes_text(uint64_t bytes, char *out, size_t size) {
    if (bytes < 1000000) {
        char digits[32];
        snprintf(digits, sizeof digits, "%llu", (unsigned long long)bytes);
        int n = (int)strlen(digits);
        if (n > 3) snprintf(out, size, "%.*s,%s B", n - 3, digits, digits + n - 3);
        else snprintf(out, size, "%s B", digits);
    } else {
        snprintf(out, size, "%.1f MiB", (double)bytes / 1048576.0);
    }
    return out;
}

static void frame_lines(const masu_viewer *v, masu_lines *l) {
    char name[MASU_SETTING_ID], host[32], device[32];
    const masu_governor_info *g = &v->stats.governor;
    const masu_plan_rung *r = &v->plan.rungs[v->rung];
    double gpu = (double)v->stats.gpu_ns / 1e6;
    char gpu_text[32] = "-"; /* not known yet */
    if (v->stats.gpu_ns) snprintf(gpu_text, sizeof gpu_text, "%.2f ms", gpu);
    if (v->wall_ms > 0.0 && !v->scripted)
        say(l, MASU_INK, "%.1f fps   %.2f ms/frame   GPU %s", 1000.0 / v->wall_ms, v->wall_ms,
            gpu_text);
    else
        say(l, MASU_INK, "frame %llu   GPU %s", (unsigned long long)v->frames, gpu_text);
    VkExtent2D o = {v->a.target.width, v->a.target.height};
    if (r->render_width == o.width && r->render_height == o.height)
        say(l, MASU_INK, "%ux%u   rung %u (0-%u)%s", o.width, o.height, v->rung, v->want.rung_count - 1,
            v->governed ? ", governor" : "");
    else
        say(l, MASU_INK, "%ux%u of %ux%u   rung %u (0-%u)%s", r->render_width, r->render_height, o.width,
            o.height, v->rung, v->want.rung_count - 1, v->governed ? ", governor" : "");
    masu_viewer_setting(v, &v->want.rungs[v->rung], name);
    size_t at = 0, length = strlen(name);
    while (at < length) { /* broken at '+' */
        size_t n = length - at;
        if (n > WIDTH - 2) {
            n = WIDTH - 2;
            while (n > 1 && name[at + n] != '+') n--;
        }
        say(l, MASU_INK_WARN, "%s%.*s", at ? "  " : "", (int)n, name + at);
        at += n;
    }
    if (v->governed) {
        float predicted = v->rung < MASU_MAX_RUNGS ? g->predicted_ms[v->rung] : 0.0f;
        say(l, gpu > (double)v->want.governor.target_ms ? MASU_INK_WARN : MASU_INK_GOOD,
            "target %.2f ms   predicted %.2f   actual %s", (double)v->want.governor.target_ms,
            (double)predicted, gpu_text);
        say(l, MASU_INK_DIM, "%s", g->reason_text ? g->reason_text : "");
    }
    say(l, MASU_INK, "host %s   device %s", bytes_text(v->a.need.host_bytes, host, sizeof host),
        bytes_text(v->a.need.device_bytes, device, sizeof device));
    if (v->path_end > 0.0)
        say(l, MASU_INK, "time %.2f of %.2f s%s%s", v->time, v->path_end, v->on_path ? ", path" : "",
            v->paused ? ", paused" : "");
    else
        say(l, MASU_INK, "time %.2f s%s", v->time, v->paused ? ", paused" : "");
}

static void polygon_lines(const masu_viewer *v, masu_lines *l) {
    say(l, MASU_INK_TITLE, "%-14s%10s%10s%12s", "rendered", "instances", "draws", "triangles");
    for (uint32_t i = 0; i < v->stats.view_count && i < MASU_MAX_VIEWS; i++) {
        const masu_view_stats *s = &v->stats.views[i];
        char name[24] = "camera";
        if (i) snprintf(name, sizeof name, "cascade %u", i - 1);
        say(l, MASU_INK, "%-14s%10llu%10llu%12llu", name, (unsigned long long)s->instances,
            (unsigned long long)s->draws, (unsigned long long)s->triangles);
    }
    say(l, MASU_INK_DIM, "of %u instances, %llu triangles%s",
        masu_scene_count(&v->scene, MASU_SCENE_INSTANCE),
        (unsigned long long)masu_scene_triangles(&v->scene),
        (masu_scene_features(&v->scene) & MASU_SCENE_HAS_SDF) ? " and an SDF" : "");
}

static void culling_lines(const masu_viewer *v, masu_lines *l) {
    if (masu_scene_count(&v->scene, MASU_SCENE_INSTANCE)) {
        polygon_lines(v, l);
    } else {
        say(l, MASU_INK_DIM, "no polygons%s",
            (masu_scene_features(&v->scene) & MASU_SCENE_HAS_SDF) ? ", only an SDF" : "");
    }
    if (v->stats.lights)
        say(l, MASU_INK, "lights %u, in view %u", v->stats.lights, v->stats.lights_in_view);
    if (v->want.debug.counters) {
        say(l, MASU_INK, "SDF evaluations %.2f M, hits %llu, unconverged %llu",
            (double)v->stats.sdf_evals / 1e6, (unsigned long long)v->stats.sdf_hits,
            (unsigned long long)v->stats.sdf_unconverged);
    }
}

/* In the frame's order; what takes less than its part goes into one line, when there are too many. */
static void pass_lines(const masu_viewer *v, masu_lines *l, int room) {
    const masu_stats_info *s = &v->stats;
    uint64_t total = 0, most = 1, least = 0, rest = 0;
    for (uint32_t p = 0; p < s->pass_count; p++) {
        total += s->pass_ns[p];
        if (s->pass_ns[p] > most) most = s->pass_ns[p];
    }
    if (room < 4) return; /* of a small window */
    say(l, MASU_INK_TITLE, "%-26s%10s", "passes", "ms");
    if (!total) {
        say(l, MASU_INK_DIM, v->o->no_timestamps ? "no timestamps (--no-timestamps)" : "not measured yet");
        return;
    }
    for (int shown = 1 << 20; shown > room - 2 && least < most; least += most / 400 + 1) {
        shown = 0;
        for (uint32_t p = 0; p < s->pass_count; p++) shown += s->pass_ns[p] > least;
    }
    for (uint32_t p = 0; p < s->pass_count; p++) {
        if (!s->pass_ns[p]) continue;
        if (s->pass_ns[p] <= least && least > 1) {
            rest += s->pass_ns[p];
            continue;
        }
        say(l, MASU_INK, "%-26.26s%10.3f", s->pass_names[p], (double)s->pass_ns[p] / 1e6);
        l->line[l->count - 1].bar = (float)((double)s->pass_ns[p] / (double)most);
    }
    if (rest) say(l, MASU_INK_DIM, "%-26s%10.3f", "other passes", (double)rest / 1e6);
}

static void draw_lines(masu_canvas *c, const masu_lines *l) {
    int w = c->font->width, h = c->font->height, pad = h / 2;
    masu_canvas_fill(c, 0, 0, WIDTH * w + 2 * pad, l->count * h + 2 * pad, 0x0B1016, 190);
    for (int i = 0; i < l->count; i++) {
        int y = pad + i * h;
        if (l->line[i].bar >= 0.0f) {
            int long_ = (int)((float)(BAR * w) * l->line[i].bar);
            masu_canvas_fill(c, pad + 39 * w, y + h / 4, long_ < 1 ? 1 : long_, h / 2, 0x4FA3E0, 220);
        }
        (void)masu_canvas_text(c, pad, y, l->line[i].color, l->line[i].text);
    }
}

/* One line on a dark band. */
static void banner(masu_canvas *c, int y, uint32_t color, const char *text) {
    int w = c->font->width, h = c->font->height;
    char line[512];
    snprintf(line, sizeof line, "%.*s", c->width / w - 2 < 500 ? c->width / w - 2 : 500, text);
    masu_canvas_fill(c, 0, y - h / 8, w * ((int)strlen(line) + 2), h + h / 4, 0x0B1016, 215);
    (void)masu_canvas_text(c, w, y, color, line);
}

static void label(masu_canvas *c, int x, int y, const char *text) {
    int w = c->font->width, h = c->font->height;
    masu_canvas_fill(c, x, y, w * ((int)strlen(text) + 2), h + h / 2, 0x0B1016, 205);
    (void)masu_canvas_text(c, x + w, y + h / 4, MASU_INK, text);
}

/* The line, and whose side is which, at the bottom where no panel is. */
static void draw_split(masu_viewer *v) {
    masu_canvas *c = &v->canvas;
    char name[MASU_SETTING_ID], text[MASU_SETTING_ID + 16];
    int x = (int)(v->split * c->width + 0.5), w = c->font->width, h = c->font->height;
    int y = c->height - 5 * h, left = x / w - 4, right = (c->width - x) / w - 4;
    masu_canvas_fill(c, x - 1, 0, 2, c->height, 0xFFFFFF, 200);
    masu_viewer_setting(v, &v->want.rungs[v->rung], name);
    snprintf(text, sizeof text, "A: rung %u, %s", v->rung, name);
    if (left > 0) {
        if ((int)strlen(text) > left) text[left] = '\0';
        label(c, x - w * ((int)strlen(text) + 3), y, text);
    }
    masu_viewer_setting(v, &v->reference, name);
    snprintf(text, sizeof text, "B: %s", name);
    if (right > 0) {
        if ((int)strlen(text) > right) text[right] = '\0';
        label(c, x + w, y, text);
    }
}

static void draw_difference(masu_viewer *v) {
    const masu_difference *d = &v->difference;
    masu_canvas *c = &v->canvas;
    char name[MASU_SETTING_ID], text[MASU_SETTING_ID + 128];
    int h = c->font->height;
    masu_viewer_setting(v, &v->reference, name);
    if (d->failed)
        snprintf(text, sizeof text, "out of memory for FLIP at %ux%u", c->width, c->height);
    else if (!d->known) snprintf(text, sizeof text, "FLIP of rung %u against B (%.80s): computing", v->rung, name);
    else
        snprintf(text, sizeof text, "FLIP of rung %u against B (%.80s): mean %.4f, 99 %% below %.3f, max %.3f",
                 v->rung, name, d->mean, d->p99, d->max);
    banner(c, c->height - 5 * h, MASU_INK, text);
    /* The scale of the map, at the right edge. */
    int w = c->font->width, bar = c->height / 3 < 10 * h ? c->height / 3 : 10 * h, x = c->width - 8 * w, y = c->height - 6 * h - bar;
    masu_canvas_fill(c, x - w, y - h, 8 * w, bar + 2 * h, 0x0B1016, 205);
    for (int i = 0; i < bar; i++) {
        uint32_t rgba = masu_difference_color(1.0f - (float)i / (float)(bar - 1));
        uint32_t rgb = (rgba & 255u) << 16 | (rgba & 0xFF00u) | (rgba >> 16 & 255u);
        masu_canvas_fill(c, x, y + i, 2 * w, 1, rgb, 255);
    }
    (void)masu_canvas_text(c, x + 3 * w, y - h / 2, MASU_INK, "1");
    (void)masu_canvas_text(c, x + 3 * w, y + bar / 2 - h / 2, MASU_INK, "0.5");
    (void)masu_canvas_text(c, x + 3 * w, y + bar - h / 2, MASU_INK, "0");
}

void masu_hud_draw(masu_viewer *v) {
    masu_canvas *c = &v->canvas;
    int h = c->font->height;
    if (v->hud != MASU_HUD_OFF) {
        static masu_lines lines;
        lines.count = 0;
        frame_lines(v, &lines);
        if (v->hud == MASU_HUD_FULL) {
            culling_lines(v, &lines);
            pass_lines(v, &lines, c->height / h - lines.count - 7);
        }
        draw_lines(c, &lines);
        banner(c, c->height - h - h / 2, MASU_INK_DIM,
               "F1 overlay  Tab knobs  1-8 PgUp PgDn rung  0 governor  F2 split  B store B  "
               "F3 difference  P path  Space pause  F12 screenshot  Esc exit");
    }
    if (v->show == MASU_SHOW_SPLIT) draw_split(v);
    if (v->show == MASU_SHOW_MAP) draw_difference(v);
    masu_pick_draw(v);
    if (*v->trouble) {
        banner(c, c->height - 3 * h, MASU_INK_BAD, v->trouble);
    } else if (*v->note && v->turns - v->note_turn < NOTE_TURNS) {
        banner(c, c->height - 3 * h, MASU_INK_GOOD, v->note);
    }
}

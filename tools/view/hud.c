/* hud.c: the statistics at the upper left (F1: off, short or full) and the overlay on the image.
 * All numbers are from masu_stats of a finished frame, the plan and the memory query; nothing is
 * measured here. */
#include "view/viewer.h"

#include "settings/setting.h"

#include <stdio.h>
#include <string.h>

static const char *bytes_text(uint64_t bytes, char *out, size_t size) {
    if (bytes < 1000000) {
        char digits[32];
        snprintf(digits, sizeof digits, "%llu", (unsigned long long)bytes);
        int n = (int)strlen(digits);
        if (n > 3)
            snprintf(out, size, "%.*s,%s B", n - 3, digits, digits + n - 3);
        else
            snprintf(out, size, "%s B", digits);
    } else {
        snprintf(out, size, "%.1f MiB", (double)bytes / 1048576.0);
    }
    return out;
}

/* The setting's name with spaces at which lines may break. */
static void spaced_setting(const masu_viewer *v, const masu_rung *rung,
                           char out[2 * MASU_SETTING_ID]) {
    char name[MASU_SETTING_ID];
    size_t n = 0;
    masu_viewer_setting(v, rung, name);
    for (const char *c = name; *c; c++) {
        if (*c == '+') out[n++] = ' ';
        out[n++] = *c;
    }
    out[n] = '\0';
}

static void frame_lines(const masu_viewer *v) {
    char name[2 * MASU_SETTING_ID], host[32], device[32];
    const masu_governor_info *g = &v->stats.governor;
    const masu_plan_rung *r = &v->plan.rungs[v->rung];
    double gpu = (double)v->stats.gpu_ns / 1e6;
    char gpu_text[32] = "-"; /* not measured yet */
    if (v->stats.gpu_ns) snprintf(gpu_text, sizeof gpu_text, "%.2f ms", gpu);
    if (v->wall_ms > 0.0 && !v->scripted)
        masu_ui_text(MASU_INK, "%.1f fps   %.2f ms/frame   GPU %s", 1000.0 / v->wall_ms, v->wall_ms,
                     gpu_text);
    else
        masu_ui_text(MASU_INK, "frame %llu   GPU %s", (unsigned long long)v->frames, gpu_text);
    VkExtent2D o = {v->a.target.width, v->a.target.height};
    if (r->render_width == o.width && r->render_height == o.height)
        masu_ui_text(MASU_INK, "%ux%u   rung %u (0-%u)%s", o.width, o.height, v->rung,
                     v->want.rung_count - 1, v->governed ? ", governor" : "");
    else
        masu_ui_text(MASU_INK, "%ux%u of %ux%u   rung %u (0-%u)%s", r->render_width,
                     r->render_height, o.width, o.height, v->rung, v->want.rung_count - 1,
                     v->governed ? ", governor" : "");
    spaced_setting(v, &v->want.rungs[v->rung], name);
    masu_ui_text(MASU_INK_WARN, "%s", name);
    if (v->governed) {
        float predicted = v->rung < MASU_MAX_RUNGS ? g->predicted_ms[v->rung] : 0.0f;
        masu_ui_text(gpu > (double)v->want.governor.target_ms ? MASU_INK_WARN : MASU_INK_GOOD,
                     "target %.2f ms   predicted %.2f   actual %s",
                     (double)v->want.governor.target_ms, (double)predicted, gpu_text);
        masu_ui_text(MASU_INK_DIM, "%s", g->reason_text ? g->reason_text : "");
    }
    masu_ui_text(MASU_INK, "host %s   device %s",
                 bytes_text(v->a.need.host_bytes, host, sizeof host),
                 bytes_text(v->a.need.device_bytes, device, sizeof device));
    if (v->path_end > 0.0)
        masu_ui_text(MASU_INK, "time %.2f of %.2f s%s%s", v->time, v->path_end,
                     v->on_path ? ", path" : "", v->paused ? ", paused" : "");
    else
        masu_ui_text(MASU_INK, "time %.2f s%s", v->time, v->paused ? ", paused" : "");
}

static void row(uint32_t color, const char *name, const uint64_t numbers[3]) {
    char text[3][24];
    for (int i = 0; i < 3; i++)
        snprintf(text[i], sizeof text[i], "%llu", (unsigned long long)numbers[i]);
    masu_ui_row(color, (const char *[]){name, text[0], text[1], text[2]}, 4, -1.0f);
}

static void polygon_lines(const masu_viewer *v) {
    masu_ui_row(MASU_INK_TITLE, (const char *[]){"rendered", "instances", "draws", "triangles"}, 4,
                -1.0f);
    for (uint32_t i = 0; i < v->stats.view_count && i < MASU_MAX_VIEWS; i++) {
        const masu_view_stats *s = &v->stats.views[i];
        char name[24] = "camera";
        if (i) snprintf(name, sizeof name, "cascade %u", i - 1);
        row(MASU_INK, name, (const uint64_t[]){s->instances, s->draws, s->triangles});
    }
    masu_ui_text(MASU_INK_DIM, "of %u instances, %llu triangles%s",
                 masu_scene_count(&v->scene, MASU_SCENE_INSTANCE),
                 (unsigned long long)masu_scene_triangles(&v->scene),
                 (masu_scene_features(&v->scene) & MASU_SCENE_HAS_SDF) ? " and an SDF" : "");
}

static void culling_lines(const masu_viewer *v) {
    if (masu_scene_count(&v->scene, MASU_SCENE_INSTANCE)) {
        polygon_lines(v);
    } else {
        masu_ui_text(MASU_INK_DIM, "no polygons%s",
                     (masu_scene_features(&v->scene) & MASU_SCENE_HAS_SDF) ? ", only an SDF" : "");
    }
    if (v->stats.lights)
        masu_ui_text(MASU_INK, "lights %u, in view %u", v->stats.lights, v->stats.lights_in_view);
    if (v->want.debug.counters) {
        masu_ui_text(MASU_INK, "SDF evaluations %.2f M, hits %llu, unconverged %llu",
                     (double)v->stats.sdf_evals / 1e6, (unsigned long long)v->stats.sdf_hits,
                     (unsigned long long)v->stats.sdf_unconverged);
    }
}

/* Passes in frame order. If there are too many, the shortest share one line. */
static void pass_lines(const masu_viewer *v) {
    const masu_stats_info *s = &v->stats;
    uint64_t total = 0, most = 1, least = 0, rest = 0;
    uint32_t room = masu_ui_room();
    char ms[32];
    for (uint32_t p = 0; p < s->pass_count; p++) {
        total += s->pass_ns[p];
        if (s->pass_ns[p] > most) most = s->pass_ns[p];
    }
    if (room < 5) return; /* the window is too small */
    masu_ui_row(MASU_INK_TITLE, (const char *[]){"passes", "ms"}, 2, 0.0f);
    if (!total) {
        masu_ui_text(MASU_INK_DIM,
                     v->o->no_timestamps ? "no timestamps (--no-timestamps)" : "not measured yet");
        return;
    }
    for (uint32_t shown = UINT32_MAX; shown > room - 3 && least < most; least += most / 400 + 1) {
        shown = 0;
        for (uint32_t p = 0; p < s->pass_count; p++) shown += s->pass_ns[p] > least;
    }
    for (uint32_t p = 0; p < s->pass_count; p++) {
        if (s->pass_ns[p] <= least) {
            rest += s->pass_ns[p];
            continue;
        }
        snprintf(ms, sizeof ms, "%.3f", (double)s->pass_ns[p] / 1e6);
        masu_ui_row(MASU_INK, (const char *[]){s->pass_names[p], ms}, 2,
                    (float)((double)s->pass_ns[p] / (double)most));
    }
    if (!rest) return;
    snprintf(ms, sizeof ms, "%.3f", (double)rest / 1e6);
    masu_ui_row(MASU_INK_DIM, (const char *[]){"other passes", ms}, 2, 0.0f);
}

/* The dividing line and the labels of both sides, at the lower edge. */
static void draw_split(const masu_viewer *v) {
    char name[2 * MASU_SETTING_ID], text[2 * MASU_SETTING_ID + 32];
    float width = (float)v->compose.shown.width, height = (float)v->compose.shown.height,
          h = masu_ui_line_height();
    float x = (float)v->split * width, y = height;
    masu_ui_fill(x - 1.0f, 0.0f, 2.0f, height, 0xFFFFFF, 0.8f);
    spaced_setting(v, &v->want.rungs[v->rung], name);
    snprintf(text, sizeof text, "A: rung %u, %s", v->rung, name);
    masu_ui_label(x - h, y, 0.0f, x - h, MASU_INK, text);
    spaced_setting(v, &v->reference, name);
    snprintf(text, sizeof text, "B: %s", name);
    masu_ui_label(x + h, y, x + h, width, MASU_INK, text);
}

static void draw_difference(const masu_viewer *v) {
    const masu_difference *d = &v->difference;
    char name[2 * MASU_SETTING_ID], text[2 * MASU_SETTING_ID + 160];
    float width = (float)v->compose.shown.width, height = (float)v->compose.shown.height,
          h = masu_ui_line_height();
    spaced_setting(v, &v->reference, name);
    if (d->failed)
        snprintf(text, sizeof text, "out of memory for FLIP at %.0fx%.0f", (double)width,
                 (double)height);
    else if (!d->known)
        snprintf(text, sizeof text, "FLIP of rung %u against B (%s): computing", v->rung, name);
    else
        snprintf(text, sizeof text,
                 "FLIP of rung %u against B (%s): mean %.4f, 99 %% below %.3f, max %.3f", v->rung,
                 name, d->mean, d->p99, d->max);
    masu_ui_label(0.0f, height, 0.0f, 0.0f, MASU_INK, text);
    /* Colour scale of the map, at the centre. */
    float bar = 0.3f * height, x = 0.5f * width, y = 0.5f * height;
    for (int i = 0; i < 32; i++) {
        uint32_t rgba = masu_difference_color(1.0f - (float)i / 31.0f);
        uint32_t rgb = (rgba & 255u) << 16 | (rgba & 0xFF00u) | (rgba >> 16 & 255u);
        masu_ui_fill(x, y + bar * (float)i / 32.0f, 2.0f * h, bar / 32.0f + 1.0f, rgb, 1.0f);
    }
    masu_ui_label(x + 2.5f * h, y - h, 0.0f, 0.0f, MASU_INK, "1");
    masu_ui_label(x + 2.5f * h, y + bar - h, 0.0f, 0.0f, MASU_INK, "0");
}

void masu_hud_draw(masu_viewer *v) {
    if (v->hud != MASU_HUD_OFF) {
        masu_ui_window("numbers", MASU_UI_LEFT, false);
        frame_lines(v);
        if (v->hud == MASU_HUD_FULL) {
            culling_lines(v);
            pass_lines(v);
        }
        masu_ui_window_end();
    }
    if (v->show == MASU_SHOW_SPLIT) draw_split(v);
    if (v->show == MASU_SHOW_MAP) draw_difference(v);
    masu_pick_draw(v);
}

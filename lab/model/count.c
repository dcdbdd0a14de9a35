/* count.c: see count.h. */
#include "lab/model/count.h"
#include "plan/compile.h"

#include "settings/setting.h"
#include "lab/model/hook.h"
#include "session.h"
#include "shared/lights.h"

#include <stdio.h>
#include <string.h>

/* Temporal accumulation has its usual length by then: work that it omits in its first frames is not
 * counted. Cascades with refresh periods above eight, or that do not divide eight, are counted for
 * only a part of their period. */
enum { WARM_UP = 3, PERIOD_MOST = 8 };

static void add_number(masu_pass_count *c, const masu_tally_number *n, double amount) {
    uint32_t i = 0;
    while (i < c->number_count && (c->numbers[i].kind != n->kind || c->numbers[i].set != n->set ||
                                   c->numbers[i].binding != n->binding))
        i++;
    if (i == MASU_COUNT_NUMBERS) return; /* exceeds the number of bindings of sets 0, 1 and 2 */
    if (i == c->number_count)
        c->numbers[c->number_count++] = (masu_count_number){n->kind, n->set, n->binding, 0.0};
    c->numbers[i].amount += amount;
}

/* Adds the buffer's counts to the passes of a rung; `share`: 1 / number of frames. */
static void add_counts(masu_pass_count *passes, double share) {
    uint32_t shaders;
    const masu_hook_shader *list = masu_hook_shaders(&shaders);
    for (uint32_t s = 0; s < shaders; s++) {
        masu_pass_count *c = &passes[list[s].pass];
        const uint32_t *words = list[s].counts;
        bool vertex = list[s].tally.model == 0;
        double plain = (double)masu_tally_sum(words, 0) * share;
        double weighted = (double)masu_tally_sum(words, 1) * share;
        if (!words[0]) continue;
        *(vertex ? &c->vertices : &c->invocations) += (double)words[0] * share;
        *(vertex ? &c->vertex_plain : &c->plain) += plain;
        *(vertex ? &c->vertex_weighted : &c->weighted) += weighted;
        if (!vertex && (double)words[1] > c->most) c->most = (double)words[1];
        if (!vertex && list[s].tally.late) c->late = true;
        for (uint32_t n = 2; n < list[s].tally.count; n++)
            add_number(c, &list[s].tally.numbers[n], (double)masu_tally_sum(words, n) * share);
    }
}

/* Frames rendered before counting. By then all shadow faces of lights are rendered and faded in, as
 * in a static scene. */
static uint32_t warm_up(const masu_frame_plan *plan, uint32_t rung) {
    const masu_rung *r = &plan->desc.rungs[rung];
    if (!plan->needs.local_shadows || r->local_shadows == MASU_OFF) return WARM_UP;
    uint32_t lights = r->local_shadow_lights, faces = r->local_shadow_faces;
    if (lights > plan->scene.lights) lights = plan->scene.lights;
    return WARM_UP + MASU_LOCAL_FADE + (6 * lights + faces - 1) / faces;
}

static bool draw_rung(masu_session *s, const masu_count_desc *d, uint32_t rung, masu_count *out,
                      char *error, size_t error_size) {
    uint32_t period = masu_setting_period(&out->drawn.desc.rungs[rung]);
    if (period > PERIOD_MOST) period = PERIOD_MOST;
    const uint32_t warm = warm_up(&out->drawn, rung);
    for (uint32_t i = 0; i < warm + period; i++) {
        masu_frame_desc frame = {
            .time = d->time, .time_step = 1.0f / 60.0f, .rung = rung, .cut = i == 0};
        masu_commands commands;
        masu_stats_info stats;
        masu_hook_clear();
        if (!masu_session_frame(s, &frame, true, &commands, error, error_size) ||
            !masu_hook_read(error, error_size))
            return false;
        if (i < warm) continue;
        add_counts(out->passes[rung], 1.0 / period);
        if (masu_stats(s->m, commands.slot, &stats, NULL)) continue;
        for (uint32_t v = 0; v < stats.view_count; v++)
            out->triangles[rung][v != 0] += (double)stats.views[v].triangles / period;
    }
    return true;
}

uint32_t masu_count_passes(const masu_frame_plan *plan, uint32_t out[MASU_PASS_COUNT]) {
    uint32_t n = 0;
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        bool shades =
            masu_passes[p].kind == MASU_PASS_GRAPHICS || masu_passes[p].kind == MASU_PASS_COMPUTE;
        if (shades && masu_first_rung(plan, p)) out[n++] = p;
    }
    return n;
}

static bool compile(masu_session *s, VkExtent2D size, masu_frame_plan *plan, char *error,
                    size_t error_size) {
    masu_desc desc = s->desc;
    masu_detail detail;
    desc.output.width = size.width;
    desc.output.height = size.height;
    if (!masu_compile(&desc, 256, 64, plan, &detail)) return true;
    snprintf(error, error_size, "%s", detail.text);
    return false;
}

static bool count(masu_session *s, const masu_count_desc *d, void (*progress)(const char *text),
                  masu_count *out, char *error, size_t error_size) {
    uint32_t passes[MASU_PASS_COUNT];
    if (!s->host.stores) {
        snprintf(error, error_size,
                 "the device has no stores of vertex and fragment shaders: nothing can be counted");
        return false;
    }
    if (!compile(s, d->size, &out->drawn, error, error_size) ||
        !compile(s, d->sheet, &out->sheet, error, error_size))
        return false;
    out->rung_count = out->drawn.desc.rung_count;
    out->texture_bytes = (double)masu_desc_texture_bytes(&out->drawn.desc);
    snprintf(out->driver, sizeof out->driver, "%s", s->host.driver);
    uint32_t n = masu_count_passes(&out->drawn, passes);
    if (!masu_hook_begin(&s->host, passes, n, error, error_size)) return false;
    bool good = masu_session_start(s, error, error_size) && masu_hook_good(error, error_size);
    uint32_t shaders;
    const masu_hook_shader *list = masu_hook_shaders(&shaders);
    for (uint32_t i = 0; i < shaders && good; i++) {
        uint32_t p = masu_is_cascade(list[i].pass) ? MASU_PASS_CASCADE_0 : list[i].pass;
        out->straight[p][list[i].tally.model == 0] += list[i].straight;
    }
    for (uint32_t r = 0; r < out->rung_count && good; r++) {
        char text[64];
        snprintf(text, sizeof text, "model: counting rung %u of %u", r + 1, out->rung_count);
        if (progress) progress(text);
        good = draw_rung(s, d, r, out, error, error_size);
    }
    masu_headless_settle(&s->host);
    masu_destroy(s->m);
    s->m = NULL;
    masu_hook_end();
    return good;
}

VkExtent2D masu_count_size(VkExtent2D size) {
    while ((uint64_t)size.width * size.height > MASU_COUNT_PIXELS_MAX)
        size = (VkExtent2D){(size.width + 1) / 2, (size.height + 1) / 2};
    return size;
}

bool masu_count_run(const masu_count_desc *d, void (*progress)(const char *text), masu_count *out,
                    char *error, size_t error_size) {
    masu_session s;
    uint64_t pixels = (uint64_t)d->size.width * d->size.height;
    memset(out, 0, sizeof *out);
    if (pixels > MASU_COUNT_PIXELS_MAX) {
        snprintf(error, error_size, "drawn and counted are at most %u pixels, %ux%u are %llu",
                 MASU_COUNT_PIXELS_MAX, d->size.width, d->size.height, (unsigned long long)pixels);
        return false;
    }
    masu_session_desc session = {.scene_path = d->scene_path,
                                 .desc = {.output = {d->size.width, d->size.height},
                                          .targets.storage = 1,
                                          .ray_query = MASU_OFF,
                                          .rung_count = d->rung_count,
                                          .frames_in_flight = 1},
                                 .host = d->host,
                                 .no_renderer = true};
    memcpy(session.desc.rungs, d->rungs, sizeof d->rungs);
    session.host.stores = true;
    session.host.ray_query = false;
    session.host.get_instance_proc_addr = masu_hook_get_instance_proc_addr;
    if (!masu_session_open(&session, &s, error, error_size)) return false;
    bool good = count(&s, d, progress, out, error, error_size);
    out->messages = s.host.messages;
    masu_session_close(&s);
    out->drawn.desc.scene = out->sheet.desc.scene = NULL;
    return good;
}

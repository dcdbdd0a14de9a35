/* study_lights.c: `masu study lights`: one view of a scene with so many of its punctual lights on, with
 * lists by tile and with every pixel asking all of them: the pictures must be the same in every bit,
 * and times and counts stand beside each other. All measurements take turns, and of the runs the least
 * time counts. Times are judged by nobody; pictures are: where they differ, the exit code is 1. */
#include "masu/study.h"

#include "clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TILES, ALL, WAYS }; /* rungs */
static const char *const names[WAYS] = {"tiles", "all"};
#define STEPS 5u
static const uint32_t steps[STEPS] = {0, 8, 64, 256, 1024};

static masu_study_options given = {.size = {960, 540}, .runs = 5};
static const masu_study_options *const o = &given;

typedef struct measure {
    double light_ms, tiles_ms;  /* least */
    double tests, shaded, full; /* per pixel; tiles */
    uint32_t in_view;
    uint64_t hash; /* of the picture */
} measure;

typedef struct bench {
    masu_session s;
    masu_punctual_light_state *states;
    uint32_t counts[STEPS], step_count;
    measure results[STEPS][WAYS];
    bool different;
    char error[1024];
} bench;

/* `count` of them, evenly from first to last; the others off. */
static bool switch_lights(bench *b, uint32_t count) {
    uint32_t all = masu_scene_count(&b->s.scene, MASU_SCENE_LIGHT);
    for (uint32_t i = 0; i < all; i++) {
        masu_punctual_light_state s = b->states[i];
        uint64_t before = (uint64_t)i * count / all, after = (uint64_t)(i + 1) * count / all;
        if (before == after) memset(s.color, 0, sizeof s.color);
        if (masu_punctual_light_set(b->s.m, masu_punctual_light_at(b->s.m, i), &s) != MASU_OK) return false;
    }
    return true;
}

static double pass_ms(const masu_stats_info *stats, const char *name) {
    double ms = 0.0;
    for (uint32_t p = 0; p < stats->pass_count; p++) {
        if (strcmp(stats->pass_names[p], name) == 0) ms += (double)stats->pass_ns[p] / 1e6;
    }
    return ms;
}

static bool draw(bench *b, uint32_t step, uint32_t way, bool first) {
    masu_frame_desc f = {.rung = way, .time = o->time};
    masu_commands commands;
    masu_stats_info stats;
    measure *m = &b->results[step][way];
    if (!masu_session_frame(&b->s, &f, true, &commands, b->error, sizeof b->error)) return false;
    (void)masu_stats(b->s.m, commands.slot, &stats);
    double light = pass_ms(&stats, "light") + pass_ms(&stats, "light_occluded");
    double tiles = pass_ms(&stats, "light_tiles");
    double pixels = (double)o->size.width * o->size.height;
    if (!first) {
        m->light_ms = fmin(m->light_ms, light);
        m->tiles_ms = fmin(m->tiles_ms, tiles);
        return true;
    }
    m->light_ms = m->tiles_ms = 1e30;
    m->tests = (double)stats.light_tests / pixels;
    m->shaded = (double)stats.light_shaded / pixels;
    m->full = (double)stats.light_tiles_full;
    m->in_view = stats.lights_in_view;
    masu_headless_target *t = &b->s.targets[0];
    if (!masu_headless_target_read(&b->s.host, t, b->error, sizeof b->error)) return false;
    const uint8_t *pixel = t->mapped;
    m->hash = 0xCBF29CE484222325u;
    for (size_t i = 0; i < (size_t)t->width * t->height * 4; i++)
        m->hash = (m->hash ^ pixel[i]) * 0x100000001B3u;
    return true;
}

static bool draw_all(bench *b, uint32_t rounds, bool counts) {
    uint32_t ways = b->step_count * WAYS;
    for (uint32_t r = 0; r < rounds; r++) {
        if (!counts) masu_cli_progress("round %u of %u", r + 1, rounds);
        for (uint32_t i = 0; i < ways; i++) {
            uint32_t at = (i + r) % ways, step = at / WAYS;
            if (!switch_lights(b, b->counts[step])) return false;
            if (!draw(b, step, at % WAYS, counts)) return false;
        }
    }
    for (uint32_t i = 0; i < b->step_count; i++)
        b->different |= b->results[i][TILES].hash != b->results[i][ALL].hash;
    masu_cli_progress_clear();
    return true;
}

static json_t *row_json(const bench *b, uint32_t i) {
    const measure *m = &b->results[i / WAYS][i % WAYS];
    return json_pack("{s:i, s:i, s:s, s:f, s:f, s:f, s:f, s:f}", "lights",
                     (int)b->counts[i / WAYS], "in_view", (int)m->in_view, "lists", names[i % WAYS],
                     "light_ms", m->light_ms, "tiles_ms", m->tiles_ms, "asked_per_pixel", m->tests,
                     "lit_per_pixel", m->shaded, "full_tiles", m->full);
}

static const masu_column columns[] = {
    {"lights", "%.0f", "lights", "%.0f"},
    {"in_view", "%.0f", "in view", "%.0f"},
    {"lists", NULL, "lists", NULL},
    {"light_ms", "%.4f", "light ms", "%.2f"},
    {"tiles_ms", "%.4f", "tiles ms", "%.2f"},
    {"asked_per_pixel", "%.4f", "asked/pixel", "%.2f"},
    {"lit_per_pixel", "%.4f", "lit/pixel", "%.2f"},
    {"full_tiles", "%.0f", "full", "%.0f"},
    {NULL, NULL, NULL, NULL}};

static int print(const bench *b) {
    if (o->json) {
        json_t *rows = json_array();
        for (uint32_t i = 0; i < b->step_count * WAYS; i++)
            json_array_append_new(rows, row_json(b, i));
        return masu_json_write(json_pack("{s:s, s:o, s:b, s:o}", "scene", o->scene, "device",
                                         masu_json_device(&b->s.host), "different",
                                         (int)b->different, "rows", rows),
                               "-");
    }
    masu_table t;
    masu_table_open(&t, columns, "");
    for (uint32_t i = 0; i < b->step_count * WAYS; i++) {
        const measure *m = &b->results[i / WAYS][i % WAYS];
        masu_table_number(&t, b->counts[i / WAYS]);
        masu_table_number(&t, m->in_view);
        masu_table_text(&t, names[i % WAYS]);
        masu_table_number(&t, m->light_ms);
        masu_table_number(&t, m->tiles_ms);
        masu_table_number(&t, m->tests);
        masu_table_number(&t, m->shaded);
        masu_table_number(&t, m->full);
    }
    fprintf(o->text, "%s, %ux%u, least of %u\n", o->scene, o->size.width, o->size.height, o->runs);
    masu_table_print(&t, o->text);
    fprintf(o->text, "  pictures %s\n", b->different ? "differ" : "are the same");
    return masu_table_close(&t, o->csv);
}

static bool keep_lights(bench *b) {
    uint32_t all = masu_scene_count(&b->s.scene, MASU_SCENE_LIGHT);
    if (b->states) return true;
    b->states = malloc((all ? all : 1) * sizeof *b->states);
    if (!b->states) return false;
    for (uint32_t i = 0; i < all; i++) {
        if (masu_punctual_light_get(b->s.m, masu_punctual_light_at(b->s.m, i), &b->states[i]) != MASU_OK)
            return false;
    }
    for (uint32_t i = 0; i < STEPS && steps[i] <= all; i++) b->counts[b->step_count++] = steps[i];
    if (b->counts[b->step_count - 1] < all && b->step_count < STEPS)
        b->counts[b->step_count++] = all;
    return true;
}

/* Counting costs time: first a round that counts and compares, then those that are timed. */
static bool measure_scene(bench *b, bool counts, int *code) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = o->scene;
    d.host = o->host;
    d.desc.output = o->size;
    d.desc.targets.storage = 1;
    d.desc.debug = (masu_debug){.counters = counts, .timestamps = !counts};
    d.desc.rung_count = WAYS;
    d.desc.rungs[ALL].light_tiles = MASU_OFF;
    if (!masu_session_open(&d, &b->s, b->error, sizeof b->error)) return false;
    bool good = false;
    if (!masu_scene_count(&b->s.scene, MASU_SCENE_LIGHT) ||
        !masu_scene_count(&b->s.scene, MASU_SCENE_CAMERA_KEY)) {
        snprintf(b->error, sizeof b->error, "%s: has no lights or no camera path", o->scene);
    } else if (!keep_lights(b)) {
        snprintf(b->error, sizeof b->error, "out of memory");
    } else {
        good = draw_all(b, counts ? 1 : o->runs, counts);
    }
    if (good && !counts) *code = print(b);
    masu_session_close(&b->s);
    *code = masu_finish_validation(&b->s.host, *code);
    return good;
}

static int run(void) {
    static bench b;
    int code = MASU_CLI_OK;
    memset(&b, 0, sizeof b);
    if (!measure_scene(&b, true, &code) || !measure_scene(&b, false, &code)) {
        code = masu_cli_error("%s", b.error);
    } else if (b.different) {
        code = masu_cli_error("%s: tiles change the picture", o->scene);
    }
    free(b.states);
    return code;
}

static const masu_option rows[] = {MASU_STUDY_SIZE, MASU_STUDY_RUNS(1, 1000), MASU_STUDY_TIME,
                                   MASU_STUDY_CSV,  MASU_STUDY_JSON,          MASU_STUDY_DEVICE,
                                   MASU_STUDY_END};

const masu_study masu_study_lights = {
    .name = "lights",
    .purpose = "a view with more and more of its punctual lights, with tiles and without",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given,
    .run = run};

/* light_bench.c: `masu light-bench`: one view of a scene with so many of its local lights on, with
 * lists by tile and with every pixel asking all of them: the pictures must be the same in every bit,
 * and times and counts stand beside each other. All measurements take turns, and of the repetitions
 * the least time counts. Times are judged by nobody; pictures are: where they differ, the exit code
 * is 1. */
#include "masu/cmd.h"

#include "clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OPTION_SIZE = 1, OPTION_REPEAT, OPTION_TIME, OPTION_JSON };

enum { TILES, ALL, WAYS }; /* rungs */
#define STEPS 5u
static const uint32_t steps[STEPS] = {0, 8, 64, 256, 1024};

typedef struct options {
    const char *path;
    VkExtent2D size;
    uint32_t repeat;
    double time;
    bool json;
} options;

typedef struct measure {
    double light_ms, tiles_ms;  /* least */
    double tests, shaded, full; /* per pixel; tiles */
    uint32_t in_view;
    uint64_t hash; /* of the picture */
} measure;

typedef struct bench {
    const options *o;
    masu_session s;
    masu_local_light_state *states;
    uint32_t counts[STEPS], step_count;
    measure results[STEPS][WAYS];
    bool different;
    char error[1024];
} bench;

/* `count` of them, evenly from first to last; the others off. */
static bool switch_lights(bench *b, uint32_t count) {
    uint32_t all = b->s.scene.lights;
    for (uint32_t i = 0; i < all; i++) {
        masu_local_light_state s = b->states[i];
        uint64_t before = (uint64_t)i * count / all, after = (uint64_t)(i + 1) * count / all;
        if (before == after) memset(s.color, 0, sizeof s.color);
        if (masu_local_light_set(b->s.m, (masu_local_light){i + 1}, &s) != MASU_OK) return false;
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
    masu_frame_desc f = {.rung = way, .time = b->o->time};
    masu_commands commands;
    masu_stats_info stats;
    measure *m = &b->results[step][way];
    if (!masu_session_frame(&b->s, &f, true, &commands, b->error, sizeof b->error)) return false;
    (void)masu_stats(b->s.m, commands.slot, &stats);
    double light = pass_ms(&stats, "light") + pass_ms(&stats, "light_occluded");
    double tiles = pass_ms(&stats, "light_tiles");
    double pixels = (double)b->o->size.width * b->o->size.height;
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

static int print(const bench *b) {
    static const char *const names[WAYS] = {"tiles", "all"};
    json_t *rows = json_array();
    if (!b->o->json) {
        printf("%s, %ux%u, least of %u\n  %6s %7s %-5s %9s %9s %11s %11s %6s\n", b->o->path,
               b->o->size.width, b->o->size.height, b->o->repeat, "lights", "in view", "",
               "light ms", "tiles ms", "asked/pixel", "lit/pixel", "full");
    }
    for (uint32_t i = 0; i < b->step_count * WAYS; i++) {
        const measure *m = &b->results[i / WAYS][i % WAYS];
        if (!b->o->json) {
            printf("  %6u %7u %-5s %9.2f %9.2f %11.2f %11.2f %6.0f\n", b->counts[i / WAYS],
                   m->in_view, names[i % WAYS], m->light_ms, m->tiles_ms, m->tests, m->shaded,
                   m->full);
        }
        json_array_append_new(rows, json_pack("{s:i, s:i, s:s, s:f, s:f, s:f, s:f, s:f}", "lights",
                                              (int)b->counts[i / WAYS], "in_view", (int)m->in_view,
                                              "lists", names[i % WAYS], "light_ms", m->light_ms,
                                              "tiles_ms", m->tiles_ms, "asked_per_pixel", m->tests,
                                              "lit_per_pixel", m->shaded, "full_tiles", m->full));
    }
    if (b->o->json) {
        return masu_json_write(json_pack("{s:s, s:o, s:b, s:o}", "scene", b->o->path, "device",
                                         masu_json_device(&b->s.host), "different",
                                         (int)b->different, "rows", rows),
                               "-");
    }
    json_decref(rows);
    printf("  pictures %s\n", b->different ? "differ" : "are the same");
    return MASU_CLI_OK;
}

static bool keep_lights(bench *b) {
    uint32_t all = b->s.scene.lights;
    if (b->states) return true;
    b->states = malloc((all ? all : 1) * sizeof *b->states);
    if (!b->states) return false;
    for (uint32_t i = 0; i < all; i++) {
        if (masu_local_light_get(b->s.m, (masu_local_light){i + 1}, &b->states[i]) != MASU_OK)
            return false;
    }
    for (uint32_t i = 0; i < STEPS && steps[i] <= all; i++) b->counts[b->step_count++] = steps[i];
    if (b->counts[b->step_count - 1] < all && b->step_count < STEPS)
        b->counts[b->step_count++] = all;
    return true;
}

/* Counting costs time: first a round that counts and compares, then those that are timed. */
static bool measure_scene(bench *b, const masu_headless_desc *host, bool counts, int *code) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = b->o->path;
    d.host = *host;
    d.desc.output = b->o->size;
    d.desc.targets.storage = 1;
    d.desc.debug = (masu_debug){.counters = counts, .timestamps = !counts};
    d.desc.rung_count = WAYS;
    d.desc.rungs[ALL].light_tiles = MASU_OFF;
    if (!masu_session_open(&d, &b->s, b->error, sizeof b->error)) return false;
    bool good = false;
    if (!b->s.scene.lights || !b->s.scene.camera_keys) {
        snprintf(b->error, sizeof b->error, "%s: has no lights or no camera path", b->o->path);
    } else if (!keep_lights(b)) {
        snprintf(b->error, sizeof b->error, "out of memory");
    } else {
        good = draw_all(b, counts ? 1 : b->o->repeat, counts);
    }
    if (good && !counts) *code = print(b);
    masu_session_close(&b->s);
    *code = masu_finish_validation(&b->s.host, *code);
    return good;
}

static int bench_scene(const options *o, const masu_headless_desc *host) {
    static bench b;
    int code = MASU_CLI_OK;
    memset(&b, 0, sizeof b);
    b.o = o;
    if (!measure_scene(&b, host, true, &code) || !measure_scene(&b, host, false, &code)) {
        code = masu_cli_error("%s", b.error);
    } else if (b.different) {
        code = masu_cli_error("%s: tiles change the picture", o->path);
    }
    free(b.states);
    return code;
}

static int run(masu_cli *cli) {
    options o = {.size = {960, 540}, .repeat = 5};
    masu_headless_desc host = {.message = masu_print_message};
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &host)) continue;
        switch (id) {
        case OPTION_SIZE:
            if (!masu_output_size(cli, &o.size)) return MASU_CLI_USAGE;
            continue;
        case OPTION_REPEAT:
            if (!masu_cli_uint(cli, 1, 1000, &o.repeat)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TIME:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.time)) return MASU_CLI_USAGE;
            continue;
        case OPTION_JSON: o.json = true; continue;
        case MASU_CLI_ARGUMENT:
            if (o.path) return masu_cli_usage_error("one scene at a time: '%s'", cli->value);
            o.path = cli->value;
            continue;
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (!o.path) return masu_cli_usage_error("no scene is given");
    return bench_scene(&o, &host);
}

static const masu_cli_option list[] = {
    {"size", "WxH", "size in pixels (default 960x540)", OPTION_SIZE, 0},
    {"repeat", "N", "times that each is drawn; the least time counts (default 5)", OPTION_REPEAT,
     0},
    {"time", "SECONDS", "where on the camera's path (default 0)", OPTION_TIME, 0},
    {"json", NULL, "print JSON", OPTION_JSON, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_light_bench = {
    .name = "light-bench",
    .arguments = "SCENE.masu [options]",
    .summary = "a view with more and more of its local lights, with tiles and without: times",
    .options = list,
    .run = run};

/* draw_bench.c: `masu draw-bench`: a scene's path drawn with both stages of culling, with the
 * frustum alone and with none, all three in every frame: the pictures must be the same in every bit,
 * and times and triangles stand beside each other. The ways take turns in going first, and of the
 * repetitions of a frame the least time counts. Times are judged by nobody; pictures are: where they
 * differ, the exit code is 1. */
#include "masu/cmd.h"

#include "clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OPTION_SIZE = 1,
    OPTION_FRAMES,
    OPTION_REPEAT,
    OPTION_FROM,
    OPTION_TO,
    OPTION_TURN,
    OPTION_JSON
};

enum { BOTH, FRUSTUM, NEITHER, WAYS };
static const char *const names[WAYS] = {"both stages", "frustum", "neither"};

typedef struct options {
    const char *path;
    VkExtent2D size;
    uint32_t frames, repeat;
    double from, to, turn;
    bool json;
} options;

typedef struct way {
    uint64_t views, kept[MASU_MAX_VIEWS],
        visible[MASU_MAX_VIEWS];  /* triangles by stage 1, stage 2 */
    double gpu_ms, wall_ms;       /* sums of the least of each frame */
    double least_gpu, least_wall; /* of the frame at hand */
} way;

typedef struct bench {
    const options *o;
    masu_session s;
    way ways[WAYS];
    uint8_t *pixels[WAYS];
    uint32_t different, first_different;
    char error[1024];
} bench;

/* The scene's camera, turned about the vertical. */
static masu_camera camera_of(const bench *b, uint32_t frame) {
    double share = b->o->frames > 1 ? (double)frame / (b->o->frames - 1) : 0.0;
    double angle = frame * b->o->turn * (3.14159265358979323846 / 180.0);
    masu_camera c;
    memset(&c, 0, sizeof c);
    if (masu_camera_at(b->s.m, b->o->from + share * (b->o->to - b->o->from), &c)) return c;
    double x = (double)c.forward[0], z = (double)c.forward[2];
    c.forward[0] = (float)(x * cos(angle) + z * sin(angle));
    c.forward[2] = (float)(z * cos(angle) - x * sin(angle));
    return c;
}

static bool draw(bench *b, uint32_t frame, uint32_t rung, bool counts) {
    masu_camera c = camera_of(b, frame);
    masu_frame_desc f = {.camera = &c, .rung = rung, .time = b->o->from};
    masu_commands commands;
    masu_stats_info stats;
    way *w = &b->ways[rung];
    uint64_t start = masu_clock_ns(NULL);
    if (!masu_session_frame(&b->s, &f, true, &commands, b->error, sizeof b->error)) return false;
    double wall = (double)(masu_clock_ns(NULL) - start) / 1e6;
    (void)masu_stats(b->s.m, commands.slot, &stats);
    w->least_gpu = fmin(w->least_gpu, (double)stats.gpu_ns / 1e6);
    w->least_wall = fmin(w->least_wall, wall);
    if (!counts) return true;
    w->views = stats.view_count;
    for (uint32_t v = 0; v < stats.view_count; v++) {
        w->kept[v] += stats.views[v].triangles;
        w->visible[v] += rung == BOTH && stats.occlusion_tests ? stats.views[v].visible_triangles
                                                               : stats.views[v].triangles;
    }
    masu_headless_target *t = &b->s.targets[0];
    if (!masu_headless_target_read(&b->s.host, t, b->error, sizeof b->error)) return false;
    memcpy(b->pixels[rung], t->mapped, (size_t)t->width * t->height * 4);
    return true;
}

static bool draw_all(bench *b) {
    size_t bytes = (size_t)b->o->size.width * b->o->size.height * 4;
    for (uint32_t frame = 0; frame < b->o->frames; frame++) {
        masu_cli_progress("frame %u of %u", frame + 1, b->o->frames);
        for (uint32_t i = 0; i < WAYS; i++) b->ways[i].least_gpu = b->ways[i].least_wall = 1e30;
        for (uint32_t r = 0; r < b->o->repeat; r++) {
            for (uint32_t i = 0; i < WAYS; i++) {
                if (!draw(b, frame, (frame + r + i) % WAYS, r == 0)) return false;
            }
        }
        for (uint32_t i = 0; i < WAYS; i++) {
            b->ways[i].gpu_ms += b->ways[i].least_gpu;
            b->ways[i].wall_ms += b->ways[i].least_wall;
        }
        if (memcmp(b->pixels[BOTH], b->pixels[NEITHER], bytes) != 0 ||
            memcmp(b->pixels[FRUSTUM], b->pixels[NEITHER], bytes) != 0) {
            if (!b->different++) b->first_different = frame;
        }
    }
    masu_cli_progress_clear();
    return true;
}

static json_t *way_json(const bench *b, uint32_t rung) {
    const way *w = &b->ways[rung];
    json_t *views = json_array();
    for (uint32_t v = 0; v < w->views; v++) {
        json_array_append_new(views,
                              json_pack("{s:s, s:f, s:f}", "view", v ? "sun" : "camera",
                                        "triangles_stage1", (double)w->kept[v] / b->o->frames,
                                        "triangles", (double)w->visible[v] / b->o->frames));
    }
    return json_pack("{s:s, s:f, s:f, s:f, s:f, s:o}", "stages", names[rung], "gpu_ms",
                     w->gpu_ms / b->o->frames, "wall_ms", w->wall_ms / b->o->frames, "gpu_ratio",
                     b->ways[NEITHER].gpu_ms / w->gpu_ms, "wall_ratio",
                     b->ways[NEITHER].wall_ms / w->wall_ms, "views", views);
}

static int print(const bench *b) {
    if (b->o->json) {
        json_t *ways = json_array();
        for (uint32_t i = 0; i < WAYS; i++) json_array_append_new(ways, way_json(b, i));
        return masu_json_write(json_pack("{s:s, s:o, s:I, s:I, s:o}", "scene", b->o->path, "device",
                                         masu_json_device(&b->s.host), "frames",
                                         (json_int_t)b->o->frames, "different_frames",
                                         (json_int_t)b->different, "ways", ways),
                               "-");
    }
    printf("%s, %ux%u, %u frames, least of %u; per frame:\n", b->o->path, b->o->size.width,
           b->o->size.height, b->o->frames, b->o->repeat);
    printf("  %-12s %9s %9s %7s %7s  %s\n", "", "gpu ms", "wall ms", "gpu", "wall",
           "triangles of the camera, of each of the sun's views");
    for (uint32_t i = 0; i < WAYS; i++) {
        const way *w = &b->ways[i];
        printf("  %-12s %9.2f %9.2f %6.2fx %6.2fx ", names[i], w->gpu_ms / b->o->frames,
               w->wall_ms / b->o->frames, b->ways[NEITHER].gpu_ms / w->gpu_ms,
               b->ways[NEITHER].wall_ms / w->wall_ms);
        for (uint32_t v = 0; v < w->views; v++)
            printf(" %.0f", (double)w->visible[v] / b->o->frames);
        printf("\n");
    }
    printf("  pictures: %u of %u frames differ\n", b->different, b->o->frames);
    return MASU_CLI_OK;
}

static int bench_scene(const options *o, const masu_headless_desc *host) {
    static bench b;
    masu_session_desc d;
    memset(&b, 0, sizeof b);
    memset(&d, 0, sizeof d);
    b.o = o;
    d.scene_path = o->path;
    d.host = *host;
    d.desc.output = o->size;
    d.desc.targets.storage = 1;
    d.desc.debug = (masu_debug){.counters = 1, .timestamps = 1};
    d.desc.rung_count = WAYS;
    d.desc.rungs[FRUSTUM].occlusion = d.desc.rungs[NEITHER].occlusion = MASU_OFF;
    d.desc.rungs[NEITHER].frustum = MASU_OFF;
    if (!masu_session_open(&d, &b.s, b.error, sizeof b.error)) return masu_cli_error("%s", b.error);
    int code = MASU_CLI_FAILURE;
    for (uint32_t i = 0; i < WAYS; i++)
        b.pixels[i] = malloc((size_t)o->size.width * o->size.height * 4);
    if (!b.s.scene.instances || !b.s.scene.camera_keys) {
        masu_cli_error("%s: has no instances or no camera path", o->path);
    } else if (!b.pixels[BOTH] || !b.pixels[FRUSTUM] || !b.pixels[NEITHER]) {
        masu_cli_error("out of memory");
    } else if (!draw_all(&b)) {
        masu_cli_error("%s", b.error);
    } else {
        code = print(&b);
        if (b.different)
            code = masu_cli_error("%s: frame %u is not the same without culling", o->path,
                                  b.first_different);
    }
    for (uint32_t i = 0; i < WAYS; i++) free(b.pixels[i]);
    masu_session_close(&b.s);
    return masu_finish_validation(&b.s.host, code);
}

static int run(masu_cli *cli) {
    options o = {.size = {960, 540}, .frames = 60, .repeat = 1, .to = 10.0};
    masu_headless_desc host = {.message = masu_print_message};
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &host)) continue;
        switch (id) {
        case OPTION_SIZE:
            if (!masu_output_size(cli, &o.size)) return MASU_CLI_USAGE;
            continue;
        case OPTION_FRAMES:
            if (!masu_cli_uint(cli, 1, 100000, &o.frames)) return MASU_CLI_USAGE;
            continue;
        case OPTION_REPEAT:
            if (!masu_cli_uint(cli, 1, 1000, &o.repeat)) return MASU_CLI_USAGE;
            continue;
        case OPTION_FROM:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.from)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TO:
            if (!masu_cli_double(cli, -1e9, 1e9, &o.to)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TURN:
            if (!masu_cli_double(cli, -360, 360, &o.turn)) return MASU_CLI_USAGE;
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
    {"frames", "N", "frames along the path (default 60)", OPTION_FRAMES, 0},
    {"repeat", "N", "times that each is drawn; the least time counts (default 1)", OPTION_REPEAT,
     0},
    {"from", "SECONDS", "where on the camera's path to begin (default 0)", OPTION_FROM, 0},
    {"to", "SECONDS", "and where to end (default 10)", OPTION_TO, 0},
    {"turn", "DEGREES", "turn the camera by so many degrees a frame (default 0)", OPTION_TURN, 0},
    {"json", NULL, "print JSON", OPTION_JSON, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_draw_bench = {
    .name = "draw-bench",
    .arguments = "SCENE.masu [options]",
    .summary = "draw a scene's path with and without culling: same pictures, triangles, times",
    .options = list,
    .run = run};

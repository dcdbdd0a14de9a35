/* study_draw.c: `masu study draw`: a scene's path drawn with frustum and occlusion culling, with the frustum
 * alone and with none, all three in every frame: the pictures must be the same in every bit, and times
 * and triangles stand beside each other. The ways take turns in going first, and of the runs of a frame
 * the least time counts. Times are judged by nobody; pictures are: where they differ, the exit code is
 * 1. */
#include "masu/study.h"

#include "clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BOTH, FRUSTUM, NEITHER, WAYS };
static const char *const names[WAYS] = {"both stages", "frustum", "neither"};

typedef struct options {
    masu_study_options study;
    double to, turn; /* --time is where the path begins */
} options;

static options given = {.study = {.size = {960, 540}, .frames = 60, .runs = 1}, .to = 10.0};
static const masu_study_options *const o = &given.study;

typedef struct way {
    uint64_t views, kept[MASU_MAX_VIEWS],
        visible[MASU_MAX_VIEWS];  /* triangles by stage 1, stage 2 */
    double gpu_ms, wall_ms;       /* sums of the least of each frame */
    double least_gpu, least_wall; /* of the frame at hand */
} way;

typedef struct bench {
    masu_session s;
    way ways[WAYS];
    uint8_t *pixels[WAYS];
    uint32_t different, first_different;
    char error[1024];
} bench;

/* The scene's camera, turned about the vertical. */
static masu_camera camera_of(const bench *b, uint32_t frame) {
    double share = o->frames > 1 ? (double)frame / (o->frames - 1) : 0.0;
    double angle = frame * given.turn * (3.14159265358979323846 / 180.0);
    masu_camera c;
    memset(&c, 0, sizeof c);
    if (masu_camera_at(b->s.m, o->time + share * (given.to - o->time), &c)) return c;
    double x = (double)c.forward[0], z = (double)c.forward[2];
    c.forward[0] = (float)(x * cos(angle) + z * sin(angle));
    c.forward[2] = (float)(z * cos(angle) - x * sin(angle));
    return c;
}

static bool draw(bench *b, uint32_t frame, uint32_t rung, bool counts) {
    masu_camera c = camera_of(b, frame);
    masu_frame_desc f = {.camera = &c, .rung = rung, .time = o->time};
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
    size_t bytes = (size_t)o->size.width * o->size.height * 4;
    for (uint32_t frame = 0; frame < o->frames; frame++) {
        masu_cli_progress("frame %u of %u", frame + 1, o->frames);
        for (uint32_t i = 0; i < WAYS; i++) b->ways[i].least_gpu = b->ways[i].least_wall = 1e30;
        for (uint32_t r = 0; r < o->runs; r++) {
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
                                        "triangles_stage1", (double)w->kept[v] / o->frames,
                                        "triangles", (double)w->visible[v] / o->frames));
    }
    return json_pack("{s:s, s:f, s:f, s:f, s:f, s:o}", "stages", names[rung], "gpu_ms",
                     w->gpu_ms / o->frames, "wall_ms", w->wall_ms / o->frames, "gpu_ratio",
                     b->ways[NEITHER].gpu_ms / w->gpu_ms, "wall_ratio",
                     b->ways[NEITHER].wall_ms / w->wall_ms, "views", views);
}

static const masu_column columns[] = {
    {NULL, NULL, "stages", NULL},
    {NULL, NULL, "gpu ms", "%.2f"},
    {NULL, NULL, "wall ms", "%.2f"},
    {NULL, NULL, "gpu", "%.2fx"},
    {NULL, NULL, "wall", "%.2fx"},
    {NULL, NULL, "triangles of the camera, of each of the sun's views", NULL},
    {NULL, NULL, NULL, NULL}};

static int print(const bench *b) {
    if (o->json) {
        json_t *ways = json_array();
        for (uint32_t i = 0; i < WAYS; i++) json_array_append_new(ways, way_json(b, i));
        return masu_json_write(json_pack("{s:s, s:o, s:I, s:I, s:o}", "scene", o->scene, "device",
                                         masu_json_device(&b->s.host), "frames",
                                         (json_int_t)o->frames, "different_frames",
                                         (json_int_t)b->different, "ways", ways),
                               "-");
    }
    fprintf(o->text, "%s, %ux%u, %u frames, least of %u; per frame:\n", o->scene, o->size.width,
            o->size.height, o->frames, o->runs);
    masu_table t;
    masu_table_open(&t, columns, "");
    for (uint32_t i = 0; i < WAYS; i++) {
        const way *w = &b->ways[i];
        char triangles[MASU_TABLE_CELL] = "";
        for (uint32_t v = 0, used = 0; v < w->views && used < sizeof triangles; v++) {
            used += (uint32_t)snprintf(triangles + used, sizeof triangles - used, "%s%.0f",
                                       v ? " " : "", (double)w->visible[v] / o->frames);
        }
        masu_table_text(&t, names[i]);
        masu_table_number(&t, w->gpu_ms / o->frames);
        masu_table_number(&t, w->wall_ms / o->frames);
        masu_table_number(&t, b->ways[NEITHER].gpu_ms / w->gpu_ms);
        masu_table_number(&t, b->ways[NEITHER].wall_ms / w->wall_ms);
        masu_table_text(&t, triangles);
    }
    masu_table_print(&t, o->text);
    fprintf(o->text, "  pictures: %u of %u frames differ\n", b->different, o->frames);
    return masu_table_close(&t, NULL);
}

static int run(void) {
    static bench b;
    masu_session_desc d;
    memset(&b, 0, sizeof b);
    memset(&d, 0, sizeof d);
    d.scene_path = o->scene;
    d.host = o->host;
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
    if (!masu_scene_count(&b.s.scene, MASU_SCENE_INSTANCE) ||
        !masu_scene_count(&b.s.scene, MASU_SCENE_CAMERA_KEY)) {
        masu_cli_error("%s: has no instances or no camera path", o->scene);
    } else if (!b.pixels[BOTH] || !b.pixels[FRUSTUM] || !b.pixels[NEITHER]) {
        masu_cli_error("out of memory");
    } else if (!draw_all(&b)) {
        masu_cli_error("%s", b.error);
    } else {
        code = print(&b);
        if (b.different)
            code = masu_cli_error("%s: frame %u is not the same without culling", o->scene,
                                  b.first_different);
    }
    for (uint32_t i = 0; i < WAYS; i++) free(b.pixels[i]);
    masu_session_close(&b.s);
    return masu_finish_validation(&b.s.host, code);
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_FRAMES(100000, "frames along the path"),
    MASU_STUDY_RUNS(1, 1000),
    MASU_REAL(options, study.time, "from", "SECONDS", -1e9, 1e9,
              "where on the camera's path to begin, instead of at 0"),
    MASU_REAL(options, to, "to", "SECONDS", -1e9, 1e9, "and where to end"),
    MASU_REAL(options, turn, "turn", "DEGREES", -360, 360,
              "turn the camera by so many degrees a frame"),
    MASU_STUDY_JSON,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_draw = {
    .name = "draw",
    .purpose = "a scene's path with and without culling: same pictures, triangles, times",
    .arguments = "SCENE.masu [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run};

/* study_cull.c: `masu study cull`: what frustum culling costs on one core, and how many plane tests the
 * tree saves, on a path through a scene or through a town of boxes made up here. No device is opened.
 * Times are printed and judged by nobody: machines differ. */
#include "masu/study.h"

#include "bake/scene/groups.h"
#include "clock.h"
#include "scene/cull.h"
#include "image.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct options {
    masu_study_options study;
    uint32_t boxes;
} options;

static options given = {.study = {.frames = 600}, .boxes = 8000};

/* What is culled, in plain memory. */
typedef struct field {
    uint32_t count, groups, grouped;
    float *arrays; /* [6][count + 3] */
    uint32_t *items;
    masu_cull_node *nodes;
    uint8_t *states, *marks;
    masu_cull_set set;
} field;

typedef struct figures {
    double median_us, worst_us, plain_us, alone_us;
    double groups, tests, alone_tests, kept;
} figures;

static void put(field *f, uint32_t at, const float rows[12], const float low[3],
                const float high[3]) {
    masu_cull_box box = masu_cull_place(rows, low, high);
    box = masu_cull_widen(&box, 1.0f);
    for (uint32_t k = 0; k < 3; k++) {
        f->arrays[k * (f->count + 3) + at] = box.center[k];
        f->arrays[(3 + k) * (f->count + 3) + at] = box.half[k];
    }
}

/* The same as src/frame/visible.c does at the start. */
static void fill(field *f, const masu_blob_instance *instances, const masu_blob_mesh *meshes,
                 const masu_blob_group *groups, const uint32_t *items) {
    f->arrays = calloc(6 * ((size_t)f->count + 3), sizeof *f->arrays);
    f->items = calloc(f->count + 1, sizeof *f->items);
    f->nodes = calloc(f->groups + 1, sizeof *f->nodes);
    f->states = calloc(f->groups + 1, 1);
    f->marks = calloc(f->count + 1, 1);
    if (!f->arrays || !f->items || !f->nodes || !f->states || !f->marks) {
        masu_cli_error("out of memory");
        exit(MASU_CLI_FAILURE);
    }
    for (uint32_t g = 0; g < f->groups; g++) {
        masu_cull_box box;
        memcpy(box.center, groups[g].center, sizeof box.center);
        memcpy(box.half, groups[g].half, sizeof box.half);
        f->nodes[g] =
            (masu_cull_node){masu_cull_widen(&box, 4.0f), groups[g].first_child,
                             groups[g].child_count, groups[g].first_item, groups[g].item_count};
    }
    uint32_t behind = f->grouped;
    for (uint32_t i = 0; i < f->grouped; i++) f->items[i] = items[i];
    for (uint32_t i = 0; i < f->count; i++) {
        if (instances[i].group == MASU_BLOB_NONE) f->items[behind++] = i;
    }
    for (uint32_t p = 0; p < f->count; p++) {
        const masu_blob_instance *n = &instances[f->items[p]];
        put(f, p, n->transform, meshes[n->mesh].aabb_min, meshes[n->mesh].aabb_max);
    }
    f->set = (masu_cull_set){.nodes = f->nodes,
                             .node_count = f->groups,
                             .items = f->items,
                             .tree_count = f->grouped,
                             .count = f->count};
    for (uint32_t k = 0; k < 6; k++) f->set.boxes[k] = f->arrays + k * ((size_t)f->count + 3);
}

static void release(field *f) {
    free(f->arrays);
    free(f->items);
    free(f->nodes);
    free(f->states);
    free(f->marks);
}

/* ---- A town ---------------------------------------------------------------------------------- */

static double uniform(uint64_t *state, double low, double high) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u; /* splitmix64 */
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return low + (high - low) * ((double)((z ^ z >> 31) >> 11) * 0x1p-53);
}

/* Boxes of 0.4 to 16 m in a square of 1 km. */
static void make_town(uint32_t boxes, field *f) {
    static masu_bake_content content;
    masu_blob_mesh mesh = {.aabb_min = {-0.5f, 0.0f, -0.5f}, .aabb_max = {0.5f, 1.0f, 0.5f}};
    masu_bake_append(&content.section[MASU_BLOB_MESHES], &mesh, sizeof mesh);
    uint64_t seed = 1;
    for (uint32_t i = 0; i < boxes; i++) {
        masu_bake_affine at = masu_bake_identity();
        for (int k = 0; k < 3; k++) {
            at.m[5 * k] = exp(uniform(&seed, log(0.4), log(16.0)));
            at.m[4 * k + 3] = k == 1 ? uniform(&seed, 0.0, 60.0) : uniform(&seed, -500.0, 500.0);
        }
        masu_bake_instance(&content, &at, 0, MASU_BLOB_NONE, MASU_BLOB_NONE);
    }
    masu_bake_groups(&content);
    f->count = boxes;
    f->groups = (uint32_t)masu_bake_count(&content, MASU_BLOB_GROUPS);
    f->grouped = (uint32_t)masu_bake_count(&content, MASU_BLOB_GROUP_ITEMS);
    fill(f, MASU_BAKE_INSTANCES(&content), MASU_BAKE_MESHES(&content),
         MASU_BAKE_ARRAY(&content, MASU_BLOB_GROUPS, const masu_blob_group),
         MASU_BAKE_ARRAY(&content, MASU_BLOB_GROUP_ITEMS, const uint32_t));
    masu_bake_content_release(&content);
}

/* ---- Views ----------------------------------------------------------------------------------- */

static void look(const double eye[3], const double forward[3], double fov_y, masu_cull_view *view) {
    double length = sqrt(forward[0] * forward[0] + forward[1] * forward[1] +
                         forward[2] * forward[2]);
    double flat = sqrt(forward[0] * forward[0] + forward[2] * forward[2]);
    double f[3], r[3] = {1, 0, 0};
    for (int k = 0; k < 3; k++) f[k] = forward[k] / length;
    if (flat > 0.0) r[0] = -forward[2] / flat, r[2] = forward[0] / flat;
    double u[3] = {r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2],
                   r[0] * f[1] - r[1] * f[0]};
    double tan_y = tan(fov_y / 2), tan_x = tan_y * 16.0 / 9.0;
    float clip[16] = {0};
    for (int k = 0; k < 3; k++) {
        clip[4 * k] = (float)(r[k] / tan_x);
        clip[4 * k + 1] = (float)(-u[k] / tan_y);
        clip[4 * k + 3] = (float)f[k];
    }
    masu_cull_camera(view, clip, eye, 0.1f);
}

static void street(uint32_t frame, masu_cull_view *view) {
    double t = frame;
    const double eye[3] = {400.0 * cos(t * 0.01), 2.0, 400.0 * sin(t * 0.013)};
    const double forward[3] = {cos(t * 0.021), 0.1 * sin(t * 0.05), sin(t * 0.021)};
    look(eye, forward, 1.0, view);
}

/* The scene's camera path from its first key to its last. */
static void along(const masu_blob_camera_key *keys, uint32_t count, double part,
                  masu_cull_view *view) {
    double time = (double)keys[0].time +
                  part * ((double)keys[count - 1].time - (double)keys[0].time);
    uint32_t k = 0;
    while (k + 2 < count && time >= (double)keys[k + 1].time) k++;
    const masu_blob_camera_key *a = &keys[k], *b = &keys[count > 1 ? k + 1 : k];
    double span = (double)b->time - (double)a->time;
    double u = span > 0.0 ? (time - (double)a->time) / span : 0.0, eye[3], forward[3];
    for (int i = 0; i < 3; i++) {
        eye[i] = (double)a->position[i] + u * ((double)b->position[i] - (double)a->position[i]);
        forward[i] =
            (double)a->target[i] + u * ((double)b->target[i] - (double)a->target[i]) - eye[i];
    }
    look(eye, forward, (double)a->fov_y, view);
}

/* ---- Measuring ------------------------------------------------------------------------------- */

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double timed(field *f, const masu_cull_set *set, const masu_cull_view *view, int plain,
                    masu_cull_counts *counts) {
    uint64_t start = masu_clock_ns(NULL);
    (plain ? masu_cull_plain : masu_cull)(set, view, f->states, f->marks, 1, counts);
    return (double)(masu_clock_ns(NULL) - start) * 1e-3;
}

static figures measure(field *f, const masu_blob_camera_key *keys, uint32_t key_count,
                       uint32_t frames) {
    double *times = calloc(4 * (size_t)frames, sizeof *times);
    figures out = {0};
    if (!times) return out;
    masu_cull_set alone = f->set; /* without the tree */
    alone.node_count = alone.tree_count = 0;
    masu_cull_counts tree = {0, 0}, single = {0, 0}, ignored = {0, 0};
    uint64_t kept = 0;
    for (uint32_t i = 0; i < frames; i++) {
        masu_cull_view view;
        if (keys) {
            along(keys, key_count, (double)i / frames, &view);
        } else {
            street(i, &view);
        }
        times[frames + i] = timed(f, &alone, &view, 0, &single);
        times[2 * (size_t)frames + i] = timed(f, &f->set, &view, 1, &ignored);
        times[i] = timed(f, &f->set, &view, 0, &tree);
        for (uint32_t n = 0; n < f->count; n++) kept += f->marks[n];
    }
    for (uint32_t i = 0; i < 3; i++) qsort(times + i * frames, frames, sizeof *times, by_value);
    out = (figures){.median_us = times[frames / 2],
                    .worst_us = times[frames - 1],
                    .alone_us = times[frames + frames / 2],
                    .plain_us = times[2 * (size_t)frames + frames / 2],
                    .groups = (double)tree.nodes / frames,
                    .tests = (double)tree.plane_tests / frames,
                    .alone_tests = (double)single.plane_tests / frames,
                    .kept = (double)kept / frames};
    free(times);
    return out;
}

static int print(const field *f, const figures *r) {
    uint32_t frames = given.study.frames;
    if (given.study.json) {
        return masu_json_write(
            json_pack("{s:I, s:I, s:I, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "boxes",
                      (json_int_t)f->count, "groups", (json_int_t)f->groups, "frames",
                      (json_int_t)frames, "median_us", r->median_us, "worst_us", r->worst_us,
                      "plain_c_us", r->plain_us, "one_by_one_us", r->alone_us, "groups_visited",
                      r->groups, "plane_tests", r->tests, "plane_tests_one_by_one", r->alone_tests,
                      "kept", r->kept),
            "-");
    }
    printf("%u boxes in %u groups, %u frames, per frame:\n", f->count, f->groups, frames);
    printf("  tree         %8.1f us median, %.1f worst; %.1f in plain C\n", r->median_us,
           r->worst_us, r->plain_us);
    printf("  one by one   %8.1f us median\n", r->alone_us);
    printf("  plane tests  %8.0f, %.0f one by one; %.0f groups looked at\n", r->tests,
           r->alone_tests, r->groups);
    printf("  kept         %8.0f\n", r->kept);
    return MASU_CLI_OK;
}

static int cull_scene(const char *path) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    char error[1024];
    masu_scene scene;
    masu_detail detail;
    if (!masu_file_read(path, (size_t)2 << 30, &bytes, &count, error, sizeof error))
        return masu_cli_error("%s", error);
    int code = MASU_CLI_FAILURE;
    if (masu_scene_bind(bytes, count, &scene, &detail)) {
        masu_cli_error("%s: %s", path, detail.text);
    } else if (!masu_scene_count(&scene, MASU_SCENE_INSTANCE) ||
               !masu_scene_count(&scene, MASU_SCENE_CAMERA_KEY)) {
        masu_cli_error("%s: has no instances or no camera path", path);
    } else {
        masu_scene_view v = masu_scene_look(&scene);
        field f = {.count = masu_scene_count(&scene, MASU_SCENE_INSTANCE),
                   .groups = masu_scene_data_of(&scene)->groups,
                   .grouped = masu_scene_data_of(&scene)->group_items};
        fill(&f, v.instances, v.meshes, v.groups, v.group_items);
        figures r = measure(&f, v.camera_keys, masu_scene_count(&scene, MASU_SCENE_CAMERA_KEY),
                            given.study.frames);
        code = print(&f, &r);
        release(&f);
    }
    free(bytes);
    return code;
}

static int run(void) {
    if (given.study.scene) return cull_scene(given.study.scene);
    field f = {0};
    make_town(given.boxes, &f);
    figures r = measure(&f, NULL, 0, given.study.frames);
    int code = print(&f, &r);
    release(&f);
    return code;
}

static const masu_option rows[] = {
    MASU_UINT(options, boxes, "boxes", 1, 1000000, "boxes of the town"),
    MASU_STUDY_FRAMES(100000, "views along the path"), MASU_STUDY_JSON, MASU_STUDY_END};

const masu_study masu_study_cull = {
    .name = "cull",
    .purpose = "frustum culling on one core: a scene's path, or a town of boxes",
    .arguments = "[SCENE.masu] [options]",
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run};

/* main.c: masu-bake turns a model or a scene description into one .masu blob.
 *
 *   bake/scene/scene.c, bake/scene/place.c, bake/scene/look.c   what the scene says          (bake/scene/json.c reads it)
 *   bake/scene/import.c, bake/mesh/model.c               a model, read in a child     (bake/scene/process.c)
 *   bake/mesh/mesh.c, bake/scene/shape.c                 triangles, given or made
 *   bake/mesh/merge.c, bake/mesh/lod.c                  less to draw                 (bake/mesh/surface.c judges)
 *   bake/scene/content.c, bake/scene/check.c              the scene being put together
 *   bake/scene/groups.c, bake/mesh/occluders.c           what is culled together, and what hides it
 *   bake/mesh/inside.c                             boxes inside of meshes
 *   bake/texture/image.c, bake/texture/texel.c, bake/texture/texture.c   pictures to texels, mips, blocks
 *   bake/mesh/trace.c, bake/light/path.c                 rays and paths of light through the scene
 *   bake/light/probes.c, bake/light/probe_report.c        light probes, and what they are off by
 *   bake/mesh/bvh.c, bake/texture/trace_texture.c          trees for rays of reflections, and pictures for them
 *   bake/shader/sdf.c                                the scene's march shader, by the shader tools
 *   bake/scene/blob.c, bake/scene/file.c                  bytes, and files that are written whole
 *
 * The runtime trusts nothing and reads no other format; all parsing of foreign files is here. */
#include "bake/scene/blob.h"
#include "bake/scene/file.h"
#include "bake/scene/groups.h"
#include "bake/mesh/occluders.h"
#include "bake/scene/process.h"
#include "bake/scene/scene.h"
#include "bake/texture/texture.h"
#include "bake/texture/trace_texture.h"
#include "cli/cli.h"
#include "masu.h"
#include "scene/blob.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

#define TEXT(x) #x
#define NUMBER(x) TEXT(x)
#define VERSION                                                                                    \
    NUMBER(MASU_VERSION_MAJOR) "." NUMBER(MASU_VERSION_MINOR) "." NUMBER(MASU_VERSION_PATCH)

#define ASSIMP_MODELS "/usr/share/assimp/models"

enum {
    OPTION_OUTPUT = 1,
    OPTION_STATS,
    OPTION_MODELS,
    OPTION_VARIANTS,
    OPTION_NO_TEXTURES,
    OPTION_TEXTURE_PATH,
    OPTION_PROBES,
    OPTION_PROBE_REPORT,
    OPTION_THREADS
};

typedef struct totals {
    uint64_t triangles;       /* stored */
    uint64_t drawn_triangles; /* over all instances */
} totals;

static totals sum_triangles(const masu_bake_content *content) {
    totals t = {0};
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_PRIMITIVES); i++) {
        t.triangles += MASU_BAKE_PRIMITIVES(content)[i].index_count / 3;
    }
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_mesh *mesh =
            &MASU_BAKE_MESHES(content)[MASU_BAKE_INSTANCES(content)[i].mesh];
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            t.drawn_triangles +=
                MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive + j].index_count / 3;
        }
    }
    return t;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* The largest that this process or one of its children has been, bytes. */
static double peak_memory(void) {
    struct rusage own, children;
    if (getrusage(RUSAGE_SELF, &own) || getrusage(RUSAGE_CHILDREN, &children)) return 0;
    long most = own.ru_maxrss > children.ru_maxrss ? own.ru_maxrss : children.ru_maxrss;
    return (double)most * 1024;
}

static json_t *detail_json(const masu_bake_detail *d) {
    return json_pack("{s:{s:I, s:I, s:I, s:I}, s:{s:I, s:I, s:I, s:I, s:I}}", "lods", "meshes",
                     (json_int_t)d->lods.meshes, "levels", (json_int_t)d->lods.levels, "too_small",
                     (json_int_t)d->lods.too_small, "refused", (json_int_t)d->lods.refused,
                     "occluders", "given", (json_int_t)d->occluders.given, "whole",
                     (json_int_t)d->occluders.whole, "inside", (json_int_t)d->occluders.inside,
                     "dropped", (json_int_t)d->occluders.dropped, "too_small",
                     (json_int_t)d->occluders.too_small);
}

static json_t *reflections_json(const masu_bake_bvh_report *r) {
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:f, s:f}", "meshes",
                     (json_int_t)r->meshes, "instances", (json_int_t)r->instances, "nodes",
                     (json_int_t)r->nodes, "triangles", (json_int_t)r->triangles, "bytes",
                     (json_int_t)r->bytes, "depth", (json_int_t)r->depth, "without_area",
                     (json_int_t)r->flat, "too_small", (json_int_t)r->small, "sah_cost", r->cost,
                     "seconds", r->seconds);
}

static bool write_stats(const char *path, const masu_bake_request *request,
                        const masu_bake_content *content, const masu_bake_buffer *blob,
                        const masu_bake_bvh_report *bvh, double started) {
    const char *input = request->input;
    masu_blob_header header;
    memcpy(&header, blob->data, sizeof header);
    totals t = sum_triangles(content);
    char hash[20];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)header.hash);
    json_t *sections = json_object();
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        if (!masu_bake_kind_name(kind)) continue;
        json_object_set_new(sections, masu_bake_kind_name(kind),
                            json_pack("{s:I, s:I}", "count",
                                      (json_int_t)masu_bake_count(content, kind), "bytes",
                                      (json_int_t)content->section[kind].bytes));
    }
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box b = masu_bake_bounds(content, &identity);
    json_t *bounds = json_null();
    if (!masu_bake_box_is_empty(&b)) {
        bounds =
            json_pack("[[f,f,f],[f,f,f]]", b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z);
    }
    json_t *root =
        json_pack("{s:s, s:I, s:I, s:s, s:I, s:I, s:I, s:o, s:o, s:o, s:f, s:I}", "input", input,
                  "version", (json_int_t)header.version, "bytes", (json_int_t)header.bytes, "hash",
                  hash, "triangles", (json_int_t)t.triangles, "drawn_triangles",
                  (json_int_t)t.drawn_triangles, "warnings", (json_int_t)masu_cli_warnings(),
                  "bounds", bounds, "sections", sections, "detail", detail_json(request->detail),
                  "seconds", now() - started, "peak_bytes", (json_int_t)peak_memory());
    if (root && request->reflections->wanted)
        json_object_set_new(root, "reflections", reflections_json(bvh));
    char *text = root ? json_dumps(root, JSON_INDENT(2)) : NULL;
    json_decref(root);
    if (!text) { /* the input's name is not UTF-8 */
        masu_cli_error("cannot write %s: a name is not UTF-8", path);
        return false;
    }
    masu_bake_buffer out = {0};
    masu_bake_append_text(&out, text);
    masu_bake_append_text(&out, "\n");
    bool good = masu_bake_write_file(path, out.data, out.bytes);
    masu_bake_release(&out);
    free(text);
    return good;
}

static void print_summary(const char *path, const masu_bake_content *content, size_t bytes) {
    totals t = sum_triangles(content);
    printf("%s: %zu bytes, %llu vertices, %llu triangles (%llu drawn), %llu meshes, "
           "%llu instances, %llu materials",
           path, bytes, (unsigned long long)masu_bake_count(content, MASU_BLOB_VERTICES),
           (unsigned long long)t.triangles, (unsigned long long)t.drawn_triangles,
           (unsigned long long)masu_bake_count(content, MASU_BLOB_MESHES),
           (unsigned long long)masu_bake_count(content, MASU_BLOB_INSTANCES),
           (unsigned long long)masu_bake_count(content, MASU_BLOB_MATERIALS));
    size_t spirv = content->section[MASU_BLOB_MARCH_SPIRV].bytes;
    if (spirv) printf(", %zu bytes of SPIR-V", spirv);
    uint64_t textures = 0;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_TEXTURES); i++) {
        textures += MASU_BAKE_ARRAY(content, MASU_BLOB_TEXTURES, masu_blob_texture)[i].layers;
    }
    if (textures) {
        printf(", %llu textures (%zu bytes)", (unsigned long long)textures,
               content->section[MASU_BLOB_TEXELS].bytes);
    }
    putchar('\n');
}

static bool is_scene(const char *path) {
    size_t length = strlen(path);
    return length > 5 && strcmp(path + length - 5, ".json") == 0;
}

/* The reader that will meet the blob is its judge: nothing is written that it, or every renderer,
 * would refuse. */
static bool accepted(const char *input, const masu_bake_buffer *blob) {
    masu_scene scene;
    masu_detail detail = {0};
    if (masu_scene_bind(blob->data, blob->bytes, &scene, &detail) != MASU_OK)
        return masu_cli_error("%s: %s", input, detail.text), false;
    uint64_t draws = (uint64_t)scene.transparents * scene.transparent_sets;
    if (scene.transparents > MASU_TRANSPARENTS_MAX) {
        masu_cli_error("%s: %u blended things, at most %u", input, scene.transparents,
                       MASU_TRANSPARENTS_MAX);
        return false;
    }
    if (scene.transparent_sets > MASU_TRANSPARENT_SETS_MAX) {
        masu_cli_error("%s: blended things use more than %u texture sets", input,
                       MASU_TRANSPARENT_SETS_MAX);
        return false;
    }
    if (draws <= MASU_TRANSPARENT_DRAWS_MAX) return true;
    masu_cli_error("%s: %u blended things times %u texture sets are %llu, at most %u", input,
                   scene.transparents, scene.transparent_sets, (unsigned long long)draws,
                   MASU_TRANSPARENT_DRAWS_MAX);
    return false;
}

#define REPORT_POINTS 1024u
#define REPORT_RAYS 4096u

static bool add_probes(const masu_bake_probe_settings *probes, bool report,
                       masu_bake_content *content) {
    if (!probes->wanted) return true;
    masu_bake_trace *trace = masu_bake_trace_make(content);
    masu_bake_probe_report done = {0};
    bool good = trace && masu_bake_make_probes(content, probes, trace, &done);
    masu_cli_progress_clear();
    if (good && !masu_cli_quiet()) {
        printf("%llu light probes (%llu inside of things), %llu bytes, %llu rays at %llu triangles "
               "in %.2f s: %.2f million a second\n",
               (unsigned long long)done.probes, (unsigned long long)done.invalid,
               (unsigned long long)done.bytes, (unsigned long long)done.rays,
               (unsigned long long)done.triangles, done.seconds,
               (double)done.rays / done.seconds * 1e-6);
    }
    if (good && report) {
        masu_bake_report_probes(content, probes, trace, REPORT_POINTS, REPORT_RAYS);
    }
    masu_bake_trace_release(trace);
    return good;
}

static bool bake(const masu_bake_request *request, const char *output, const char *stats,
                 bool report, masu_bake_content *content) {
    double started = now();
    bool good = is_scene(request->input) ? masu_bake_read_scene(request, content)
                                         : masu_bake_bare_model(request, content);
    if (!good) return false;
    content->pictures_wanted = request->reflections->wanted;
    content->picture_side = request->reflections->texture_size;
    good = masu_bake_make_textures(content, request->texture_path);
    if (!good) return false;
    masu_bake_sort_instances(content);
    masu_bake_groups(content);
    masu_bake_sort_occluders(content);
    masu_bake_drop_occluders(content);
    masu_bake_bvh_report bvh;
    if (!masu_bake_make_bvh(content, request->reflections, &bvh)) return false;
    masu_bake_trace_textures(content);
    if (!add_probes(request->probes, report, content)) return false;
    if (!output) return true;
    masu_bake_buffer blob = {0};
    masu_bake_make_blob(content, &blob);
    masu_cli_progress("writing %s", output);
    good = accepted(request->input, &blob) && masu_bake_write_file(output, blob.data, blob.bytes) &&
           (!stats || write_stats(stats, request, content, &blob, &bvh, started));
    masu_cli_progress_clear();
    if (good && !masu_cli_quiet()) print_summary(output, content, blob.bytes);
    masu_bake_release(&blob);
    return good;
}

static int run(masu_cli *cli) {
    masu_bake_detail detail = {.levels = 0};
    masu_bake_probe_settings probes = masu_bake_probe_defaults();
    masu_bake_reflections reflections = {0};
    masu_bake_request request = {
        .models_directory = ASSIMP_MODELS, .detail = &detail, .probes = &probes,
        .reflections = &reflections};
    bool report = false;
    const char *output = NULL, *stats = NULL;
    for (;;) {
        switch (masu_cli_next(cli)) {
        case OPTION_OUTPUT: output = cli->value; break;
        case OPTION_STATS: stats = cli->value; break;
        case OPTION_MODELS: request.models_directory = cli->value; break;
        case OPTION_TEXTURE_PATH: request.texture_path = cli->value; break;
        case OPTION_NO_TEXTURES: request.textures = MASU_BAKE_TEXTURES_OFF; break;
        case OPTION_PROBES: probes.wanted = true; break;
        case OPTION_PROBE_REPORT: probes.wanted = report = true; break;
        case OPTION_THREADS:
            if (!masu_cli_uint(cli, 1, 64, &probes.threads)) return MASU_CLI_USAGE;
            break;
        case OPTION_VARIANTS: request.variants = true; break;
        case MASU_CLI_ARGUMENT:
            if (request.input) return masu_cli_usage_error("more than one input: %s", cli->value);
            request.input = cli->value;
            break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END: {
            if (!request.input) return masu_cli_usage_error("no MODEL or SCENE.json given");
            if (!output && !report) return masu_cli_usage_error("no output given; add -o X.masu");
            masu_bake_content content = {0};
            bool good = bake(&request, output, stats, report, &content);
            masu_bake_content_release(&content);
            return good ? MASU_CLI_OK : MASU_CLI_FAILURE;
        }
        }
    }
}

int main(int argc, char **argv) {
    static const masu_cli_option options[] = {
        {"output", "FILE", "where the blob goes; replaced only by a complete one", OPTION_OUTPUT,
         'o'},
        {"variants", NULL, "add the other ways to march the SDF, for masu study march",
         OPTION_VARIANTS, 0},
        {"no-textures", NULL, "leave textures out; the materials' factors stay", OPTION_NO_TEXTURES,
         0},
        {"texture-path", "DIR:...", "where to look for textures that are not where models say",
         OPTION_TEXTURE_PATH, 0},
        {"probes", NULL, "bake light probes, also if the scene asks for none", OPTION_PROBES, 0},
        {"probe-report", NULL,
         "bake them and print what they are off by from path-traced truth;\nneeds no -o",
         OPTION_PROBE_REPORT, 0},
        {"threads", "N", "threads that trace light probes; default: all processors",
         OPTION_THREADS, 0},
        {"stats", "FILE", "write counts, bytes, bounds, seconds and peak memory as JSON",
         OPTION_STATS, 0},
        {"models", "DIR", "what \"@assimp/\" in a scene stands for\n(" ASSIMP_MODELS ")",
         OPTION_MODELS, 0},
        {NULL, NULL, NULL, 0, 0},
    };
    static const masu_cli_command command = {
        .arguments = "MODEL|SCENE.json -o X.masu [options]",
        .summary = "turns a model or a scene description into a .masu blob",
        .options = options,
        .details =
            "A MODEL is any file that Assimp reads (.glb, .gltf, .obj, .ac, ...); it gets a "
            "camera\n"
            "that frames it, a sun and a sky. A SCENE.json places models, a camera path, light "
            "and\n"
            "an SDF; docs/scene.md describes it. An SDF needs glslangValidator, spirv-val and\n"
            "spirv-opt. The same input gives the same bytes.\n\n"
            "Exit code: 0 done, 1 failed (one line says why), 2 wrong usage.\n",
        .run = run,
    };
    static const masu_cli_command *const commands[] = {&command, NULL};
    static const masu_cli_program program = {
        .name = "masu-bake", .version = VERSION, .commands = commands};
    masu_bake_catch_signals();
    return masu_cli_main(&program, argc, argv);
}

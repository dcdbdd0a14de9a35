/* stats.c: see stats.h. */
#include "bake/write/stats.h"
#include "bake/base/file.h"
#include "bake/scene/camera.h"
#include "bake/write/blob.h"
#include "cli/cli.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

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

/* The largest that this process or one of its children has been, bytes. */
static double peak_memory(void) {
    struct rusage own, children;
    if (getrusage(RUSAGE_SELF, &own) || getrusage(RUSAGE_CHILDREN, &children)) return 0;
    long most = own.ru_maxrss > children.ru_maxrss ? own.ru_maxrss : children.ru_maxrss;
    return (double)most * 1024;
}

static json_t *detail_json(const masu_bake_report *d) {
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

static json_t *warnings_json(const masu_bake_report *r) {
    json_t *all = json_array();
    for (size_t at = 0; at < r->warnings.bytes;) {
        const char *text = (const char *)r->warnings.data + at;
        json_t *line = json_string(text);
        json_array_append_new(all, line ? line : json_string("(not UTF-8)"));
        at += strlen(text) + 1;
    }
    return all;
}

static json_t *cameras_json(const masu_bake_content *content) {
    json_t *all = json_array();
    for (uint32_t i = 0; i < masu_bake_camera_count(content); i++) {
        json_t *name = json_string(MASU_BAKE_CAMERAS(content)[i].name);
        json_array_append_new(all, name ? name : json_string("(not UTF-8)"));
    }
    return all;
}

bool masu_bake_write_stats(const masu_bake_options *options, const masu_bake_content *content,
                           const masu_bake_buffer *blob, const masu_bake_report *report,
                           double seconds) {
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
    masu_bake_box b = report->bounds;
    json_t *bounds = json_null();
    if (!masu_bake_box_is_empty(&b)) {
        bounds =
            json_pack("[[f,f,f],[f,f,f]]", b.low.x, b.low.y, b.low.z, b.high.x, b.high.y, b.high.z);
    }
    json_t *root = json_pack(
        "{s:s, s:I, s:I, s:s, s:I, s:I, s:I, s:o, s:o, s:o, s:f, s:I}", "input", options->input,
        "version", (json_int_t)header.version, "bytes", (json_int_t)header.bytes, "hash", hash,
        "triangles", (json_int_t)t.triangles, "drawn_triangles", (json_int_t)t.drawn_triangles,
        "warnings", (json_int_t)masu_cli_warnings(), "bounds", bounds, "sections", sections,
        "detail", detail_json(report), "seconds", seconds, "peak_bytes", (json_int_t)peak_memory());
    if (root) json_object_set_new(root, "warning_lines", warnings_json(report));
    if (root) json_object_set_new(root, "cameras", cameras_json(content));
    if (root && report->reflected)
        json_object_set_new(root, "reflections", reflections_json(&report->reflections));
    char *text = root ? json_dumps(root, JSON_INDENT(2)) : NULL;
    json_decref(root);
    if (!text) { /* the input's name is not UTF-8 */
        masu_cli_error("cannot write %s: a name is not UTF-8", options->stats);
        return false;
    }
    masu_bake_buffer out = {0};
    masu_bake_append_text(&out, text);
    masu_bake_append_text(&out, "\n");
    bool good = masu_bake_write_file(options->stats, out.data, out.bytes);
    masu_bake_release(&out);
    free(text);
    return good;
}

void masu_bake_print_summary(const char *path, const masu_bake_content *content, size_t bytes) {
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

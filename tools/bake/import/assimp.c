/* assimp.c: reads a file by Assimp, or by Masu's glTF reader; see assimp.h. */
#include "bake/import/assimp.h"
#include "bake/import/assimp_file.h"
#include "bake/base/file.h"
#include "bake/import/acc.h"
#include "bake/import/gltf.h"
#include "bake/import/stl.h"
#include "bake/import/vertex_color.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <string.h>

#define DIALECT_MAX ((size_t)512 << 20)

static void report(masu_import *m) {
    masu_bake_buffer *w = m->warnings;
    masu_import_report_losses(m);
    if (m->bad_nodes) {
        masu_import_format(w, "%u nodes dropped: their transform is not finite\n", m->bad_nodes);
    }
    if (m->texture_count) {
        m->textures.bytes -= 2; /* the last ", " */
        masu_bake_append(&m->textures, "", 1);
        masu_import_format(w, "unsupported textures: %s%s\n",
                           (const char *)m->textures.data,
                           m->texture_count > MASU_IMPORT_NAMES_MAX ? ", ..." : "");
    }
    if (m->clamped)
        masu_import_format(w, "%llu " MASU_IMPORT_COLORS_CLAMPED "\n",
                           (unsigned long long)m->clamped);
    if (m->translucent) {
        masu_import_format(w, "%u meshes have vertex colours with alpha: the alpha is ignored\n",
                           m->translucent);
    }
    if (m->phong) {
        masu_import_format(
            w,
            "%u materials have Phong highlights: the exponent becomes the roughness, the specular "
            "colour is ignored\n",
            m->phong);
    }
    if (m->invisible) {
        masu_import_format(w, "%u materials have an opacity of 0: treated as opaque\n",
                           m->invisible);
    }
    if (m->turned) {
        masu_import_format(w, "%u meshes have rotated textures: the rotation is ignored\n",
                           m->turned);
    }
    if (m->unmapped) {
        masu_import_format(
            w,
            "%u meshes have textures but no texture coordinates: one texel colours "
            "the whole mesh\n",
            m->unmapped);
    }
    if (m->other_lights) {
        masu_import_format(w, "%u lights have a transform that is not finite: ignored\n",
                           m->other_lights);
    }
    if (!m->given && m->source->mNumLights) {
        masu_import_format(w, "%u lights: ignored, since their units are not known\n",
                           m->source->mNumLights);
    }
    if (!m->moving && !m->plays && (m->skins || m->source->mNumAnimations)) {
        masu_bake_append_text(w,
                              "only \"moving\" models are animated: this one has its rest pose\n");
    }
}

static void *allocate_zeroed(size_t count, size_t size) {
    void *memory = masu_bake_allocate(count * size);
    memset(memory, 0, count * size);
    return memory;
}

static void convert(masu_import *m, masu_bake_buffer *error) {
    const struct aiScene *s = m->source;
    unsigned meshes = s->mMeshes ? s->mNumMeshes : 0;
    m->mesh_parts = allocate_zeroed(meshes, sizeof *m->mesh_parts);
    m->mesh_done = allocate_zeroed(meshes, sizeof *m->mesh_done);
    m->mesh_used = allocate_zeroed(meshes, sizeof *m->mesh_used);
    m->sets = allocate_zeroed(meshes, sizeof *m->sets);
    m->material = allocate_zeroed((size_t)s->mNumMaterials + 1, sizeof *m->material);
    bool finished = true;
    if (s->mRootNode)
        finished = masu_import_walk(m, true);
    else
        for (unsigned i = 0; i < meshes; i++) masu_import_mesh(m, i);
    masu_bake_buffer parts = m->piece->section[MASU_BLOB_PRIMITIVES];
    m->piece->section[MASU_BLOB_PRIMITIVES] = (masu_bake_buffer){0};
    m->parts = (masu_blob_primitive *)(void *)parts.data;
    if (!finished) {
        masu_bake_append_text(error, "its nodes form a cycle, or are more than 4 million");
    } else if (m->full) {
        masu_bake_append_text(error, "more than 2^31 - 1 vertices or indices");
    } else if (parts.bytes == 0 && masu_bake_count(&m->bent, MASU_BLOB_PRIMITIVES) == 0) {
        masu_bake_append_text(error, "no triangles to draw");
        masu_import_report_losses(m);
        if (m->warnings->bytes) { /* the error is reported in one line */
            masu_bake_append_text(error, "; ");
            const char *end = memchr(m->warnings->data, '\n', m->warnings->bytes);
            size_t length = end ? (size_t)(end - (const char *)m->warnings->data) : 0;
            masu_bake_append(error, m->warnings->data, length);
        }
    } else {
        if (s->mRootNode)
            masu_import_walk(m, false);
        else
            masu_import_show_all(m);
        if (m->live) masu_import_live(m);
        if (m->plays) m->moving = masu_bake_count(m->piece, MASU_BLOB_CLIPS) > 0;
        if (!m->moving) masu_import_forget(m);
        report(m);
        if (masu_bake_count(m->piece, MASU_BLOB_INSTANCES) == 0) {
            masu_bake_append_text(error, "no node shows its meshes with a finite transform");
        }
    }
    masu_bake_release(&parts);
}

/* Assimp drops some broken data itself and reports that only in its log. Messages about lost data
 * are passed on, each once, a few at most. */
static void note_remark(const char *text, char *user) {
    static const char *const losses[] = {"dropped", "out-of-range", "out of range", "discard"};
    masu_bake_buffer *remarks = (masu_bake_buffer *)(void *)user;
    const char *colon = strstr(text, ": "); /* after "Warn,  T0" */
    if (strncmp(text, "Warn", 4) != 0 || !colon) return;
    bool lost = false;
    for (size_t i = 0; i < sizeof losses / sizeof losses[0]; i++) {
        lost = lost || strstr(colon, losses[i]);
    }
    int length = (int)strcspn(colon + 2, "\n");
    masu_bake_buffer line = {0};
    masu_bake_append_text(&line, "importer: ");
    masu_import_name(&line, colon + 2, length < 200 ? length : 200);
    masu_bake_append(&line, "\n", 2); /* with its NUL */
    masu_bake_append(remarks, "", 1);
    remarks->bytes--;
    if (lost && remarks->bytes < 1000 &&
        !strstr((const char *)remarks->data, (const char *)line.data)) {
        masu_bake_append_text(remarks, (const char *)line.data);
    }
    masu_bake_release(&line);
}

static const struct aiScene *read_assimp(const char *path, masu_bake_buffer *warnings,
                                         masu_bake_buffer *error) {
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    if (properties) {
        aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    }
    /* This directory welds vertices, drops bad triangles and so on itself, with every index
     * checked: each processing step of Assimp is another one that hostile data can break. */
    unsigned flags = aiProcess_Triangulate | aiProcess_GenUVCoords;
    struct aiLogStream log = {note_remark, (char *)(void *)warnings};
    aiAttachLogStream(&log);
    const struct aiScene *scene;
    masu_bake_buffer whole = {0}, text = {0};
    const char *dialect = NULL; /* converted to text of a format that Assimp reads */
    if ((masu_bake_is_acc(path) || masu_bake_is_stl(path)) &&
        masu_bake_read_file(path, DIALECT_MAX, &whole)) {
        if (masu_bake_is_acc(path)) {
            masu_bake_strip_acc((const char *)whole.data, whole.bytes, &text);
            dialect = "ac";
        } else if (masu_bake_lower_stl((const char *)whole.data, whole.bytes, &text)) {
            dialect = "stl";
        }
    }
    if (dialect) {
        scene = aiImportFileFromMemoryWithProperties((const char *)text.data, (unsigned)text.bytes,
                                                     flags, dialect, properties);
    } else {
        static masu_import_files files; /* Assimp keeps the pointer */
        files.model = path;
        files.warnings = warnings;
        masu_import_use_files(&files);
        scene = aiImportFileExWithProperties(path, flags, &files.io, properties);
    }
    if (!scene) {
        const char *why = aiGetErrorString();
        masu_bake_append_text(error, why && *why ? why : "the importer gave no reason");
    }
    return scene;
}

/* The process ends after this function: releasing memory has no use. */
void masu_bake_read_model(const char *path, const masu_bake_wanted *wanted,
                          masu_bake_content *piece, masu_bake_buffer *warnings,
                          masu_bake_buffer *error) {
    masu_gltf g = {.path = path,
                   .variant = wanted->variant,
                   .wanted = wanted->textures,
                   .piece = piece,
                   .moving = wanted->moving,
                   .plays = wanted->plays,
                   .warnings = warnings,
                   .error = error};
    bool ours = masu_gltf_is_file(path);
    const struct aiScene *scene = &g.scene;
    if (ours && !masu_gltf_read(&g)) return;
    if (!ours && wanted->variant) masu_bake_append_text(warnings, "variants need a glTF 2 file\n");
    if (!ours && !(scene = read_assimp(path, warnings, error))) return;
    bool moving = wanted->moving || (wanted->plays && scene->mNumAnimations);
    masu_import m = {.source = scene,
                     .given = (const masu_import_given *)(const void *)g.given.data,
                     .ranges = (const float *)(const void *)g.ranges.data,
                     .path = path,
                     .wanted = wanted->textures,
                     .piece = piece,
                     .moving = moving,
                     .plays = wanted->plays && !wanted->moving,
                     .live = scene->mRootNode && masu_import_is_live(scene, moving),
                     .warnings = warnings};
    convert(&m, error);
}

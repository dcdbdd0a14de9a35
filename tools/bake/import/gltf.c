/* gltf.c: opens a glTF file: containers, buffers, required extensions, and notes of unsupported
 * features; see gltf.h. */
#include "bake/import/gltf.h"
#include "bake/import/picture_path.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#define FILE_MAX_BYTES ((uint64_t)4 << 30)
#define GLB_HEAD 12u
#define CHUNK_HEAD 8u

/* ---- errors and notes ---- */

bool masu_gltf_failed(const masu_gltf *g) { return g->error->bytes != 0; }

bool masu_gltf_fail(masu_gltf *g, const char *format, ...) {
    char text[512];
    va_list arguments;
    if (masu_gltf_failed(g)) return false;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    if (*g->where) masu_bake_append_text(g->error, g->where);
    if (*g->where) masu_bake_append_text(g->error, ": ");
    masu_import_name(g->error, text, (int)strlen(text));
    return false;
}

void masu_gltf_note_many(masu_gltf *g, uint64_t count, const char *what, const char *first) {
    masu_gltf_note **at = &g->notes;
    while (*at && strcmp((*at)->what, what) != 0) at = &(*at)->next;
    if (!*at) {
        *at = masu_gltf_take(g, 1, sizeof **at);
        (*at)->what = masu_bake_take_text(&g->pool, what);
        (*at)->first = masu_bake_take_text(&g->pool, first);
    }
    (*at)->count += count;
}

void masu_gltf_note_one(masu_gltf *g, const char *what, const char *first) {
    masu_gltf_note_many(g, 1, what, first);
}

static void report_notes(masu_gltf *g) {
    for (const masu_gltf_note *n = g->notes; n; n = n->next) {
        masu_import_format(g->warnings, "%llu %s (first: ", (unsigned long long)n->count, n->what);
        masu_import_name(g->warnings, n->first, (int)strnlen(n->first, 200));
        masu_bake_append_text(g->warnings, ")\n");
    }
}

const char *masu_gltf_name_of(masu_gltf *g, const char *array, size_t index, const json_t *object) {
    char text[64];
    const char *name = json_string_value(json_object_get(object, "name"));
    snprintf(text, sizeof text, "%s[%zu]", array, index);
    return masu_bake_take_text(&g->pool, name && *name ? name : text);
}

void masu_gltf_at(masu_gltf *g, const char *array, size_t index, const json_t *object) {
    const char *name = json_string_value(json_object_get(object, "name"));
    if (name && *name)
        snprintf(g->where, sizeof g->where, "%s[%zu] \"%.100s\"", array, index, name);
    else
        snprintf(g->where, sizeof g->where, "%s[%zu]", array, index);
    for (char *c = g->where; *c; c++) {
        if ((unsigned char)*c < 0x20) *c = '?';
    }
}

void *masu_gltf_take(masu_gltf *g, size_t count, size_t size) {
    return masu_bake_take(&g->pool, count > SIZE_MAX / 2 / size ? SIZE_MAX / 2 : count * size);
}

/* ---- files and data: URIs ---- */

bool masu_gltf_is_data(const char *uri) { return strncasecmp(uri, "data:", 5) == 0; }

/* True if a URI can name a file: its scheme is file, or it has none. One letter before a colon is a
 * drive (C:\). */
static bool is_file(const char *uri) {
    size_t n = strspn(uri, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-.");
    return *uri && (n < 2 || uri[n] != ':' || strncasecmp(uri, "file:", 5) == 0);
}

const char *masu_gltf_path(masu_gltf *g, const char *uri, bool *outside) {
    masu_bake_buffer path = {0};
    if (!g->path || !is_file(uri)) return NULL;
    *outside = !masu_bake_picture_path(g->path, uri, &path);
    const char *kept = masu_bake_take_text(&g->pool, (const char *)path.data);
    masu_bake_release(&path);
    return kept;
}

static bool read_whole(masu_gltf *g, const char *path, masu_gltf_bytes *out) {
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
        return masu_gltf_fail(g, "there is no file %s", path);
    if ((uint64_t)about.st_size > FILE_MAX_BYTES)
        return masu_gltf_fail(g, "%s is larger than 4 GiB", path);
    FILE *file = fopen(path, "rb");
    unsigned char *data = masu_gltf_take(g, (size_t)about.st_size + 1, 1);
    size_t bytes = file ? fread(data, 1, (size_t)about.st_size, file) : 0;
    if (file) fclose(file);
    if (bytes != (size_t)about.st_size) return masu_gltf_fail(g, "%s cannot be read", path);
    *out = (masu_gltf_bytes){data, bytes};
    return true;
}

static int digit64(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

/* The bytes after the comma may have %-escapes (RFC 2397), in base64 too. Line breaks in base64 are
 * skipped. */
static bool decode_data(masu_gltf *g, const char *uri, masu_gltf_bytes *out) {
    const char *comma = strchr(uri, ',');
    if (!comma) return masu_gltf_fail(g, "a data: URI without a comma");
    bool base64 = comma - uri >= 7 && strncasecmp(comma - 7, ";base64", 7) == 0;
    unsigned char *data = masu_gltf_take(g, strlen(comma) + 1, 1);
    size_t length = masu_bake_resolve_escapes(data, comma + 1), bytes = 0;
    unsigned bits = 0, held = 0;
    /* In place: four characters become three. */
    for (size_t i = 0; base64 && i < length && data[i] != '='; i++) {
        if (strchr(" \t\r\n", data[i]) && data[i]) continue;
        int digit = digit64((char)data[i]);
        if (digit < 0) return masu_gltf_fail(g, "a data: URI with a '%c'", data[i]);
        held = held << 6 | (unsigned)digit;
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        data[bytes++] = (unsigned char)(held >> bits);
    }
    *out = (masu_gltf_bytes){data, base64 ? bytes : length};
    return true;
}

bool masu_gltf_fetch(masu_gltf *g, const char *uri, masu_gltf_bytes *out) {
    bool outside = false;
    if (masu_gltf_is_data(uri)) return decode_data(g, uri, out);
    const char *path = masu_gltf_path(g, uri, &outside);
    if (!path) return masu_gltf_fail(g, "%.100s is not a file in the model's folder", uri);
    if (outside)
        return masu_gltf_fail(
            g, "%.100s is outside of the model's folder (--texture-path adds folders)", uri);
    return read_whole(g, path, out);
}

static bool read_buffers(masu_gltf *g) {
    g->buffer_count = masu_gltf_count(g, "buffers");
    g->view_count = masu_gltf_count(g, "bufferViews");
    g->buffers = masu_gltf_take(g, g->buffer_count, sizeof *g->buffers);
    g->views = masu_gltf_take(g, g->view_count, sizeof *g->views);
    for (size_t i = 0; i < g->buffer_count; i++) {
        const json_t *buffer = masu_gltf_element(g, "buffers", (json_int_t)i);
        uint64_t bytes = 0;
        if (!buffer) return false;
        masu_gltf_at(g, "buffers", i, buffer);
        const char *uri = masu_gltf_string(g, buffer, "uri");
        if (!masu_gltf_size(g, buffer, "byteLength", &bytes)) return false;
        if (uri && !masu_gltf_fetch(g, uri, &g->buffers[i])) return false;
        if (!uri && i == 0) g->buffers[i] = g->chunk;
        if (masu_gltf_failed(g)) return false;
        if (!g->buffers[i].data) continue; /* a buffer for decompressed data */
        if (g->buffers[i].bytes < bytes) {
            return masu_gltf_fail(g, "\"byteLength\" is %llu, and there are %zu bytes",
                                  (unsigned long long)bytes, g->buffers[i].bytes);
        }
        g->buffers[i].bytes = (size_t)bytes;
    }
    g->where[0] = '\0';
    return true;
}

/* ---- containers ---- */

static uint32_t word_at(const unsigned char *p) {
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static bool refuse_first(masu_gltf *g) {
    return masu_gltf_fail(g, "a glTF 1 file, expected glTF 2: convert it");
}

/* Reads the chunks of a .glb: JSON, then binary data. */
static bool open_glb(masu_gltf *g, masu_gltf_bytes *text) {
    const unsigned char *data = g->file.data;
    size_t bytes = g->file.bytes;
    if (bytes < GLB_HEAD + CHUNK_HEAD) return masu_gltf_fail(g, "the file ends in its header");
    if (word_at(data + 4) == 1) return refuse_first(g);
    if (word_at(data + 4) != 2)
        return masu_gltf_fail(g, "container: found version %u, expected 2", word_at(data + 4));
    if (word_at(data + 8) > bytes)
        return masu_gltf_fail(g, "it says that it has %u bytes, and has %zu", word_at(data + 8),
                              bytes);
    if (word_at(data + 8) >= GLB_HEAD) bytes = word_at(data + 8);
    for (size_t at = GLB_HEAD; bytes - at >= CHUNK_HEAD;) {
        uint32_t length = word_at(data + at), kind = word_at(data + at + 4);
        at += CHUNK_HEAD;
        if (length > bytes - at)
            return masu_gltf_fail(g, "a chunk of %u bytes, where %zu are left", length, bytes - at);
        if (kind == 0x4E4F534Au && !text->data) *text = (masu_gltf_bytes){data + at, length};
        if (kind == 0x004E4942u && !g->chunk.data) g->chunk = (masu_gltf_bytes){data + at, length};
        at += length;
    }
    return text->data || masu_gltf_fail(g, "there is no JSON in it");
}

static bool parse(masu_gltf *g) {
    masu_gltf_bytes text = {0};
    json_error_t error;
    if (g->file.bytes >= 4 && memcmp(g->file.data, "glTF", 4) == 0) {
        if (!open_glb(g, &text)) return false;
    } else {
        text = g->file;
        if (text.bytes >= 3 && memcmp(text.data, "\xEF\xBB\xBF", 3) == 0) {
            text.data += 3;
            text.bytes -= 3;
        }
    }
    while (text.bytes && (text.data[text.bytes - 1] == ' ' || text.data[text.bytes - 1] == '\0'))
        text.bytes--;
    g->root = json_loadb((const char *)text.data, text.bytes, JSON_ALLOW_NUL, &error);
    if (!g->root)
        return masu_gltf_fail(g, "line %d, column %d: %s", error.line, error.column, error.text);
    return json_is_object(g->root) || masu_gltf_fail(g, "its JSON is not an object");
}

/* ---- extensions ---- */

static bool is_read(const char *extension) {
#define FEATURE(what, read, dropped)
#define EXTENSION(name, read, dropped) name,
    static const char *const names[] = {
#include "bake/import/gltf_features.inc"
    };
#undef FEATURE
#undef EXTENSION
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(extension, names[i]) == 0) return true;
    }
    return false;
}

static bool check_required(masu_gltf *g) {
    const json_t *required = masu_gltf_array(g, g->root, "extensionsRequired");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (!name || !is_read(name))
            return masu_gltf_fail(g, "it requires %s, which is not supported",
                                  name ? name : "something");
    }
    return !masu_gltf_failed(g);
}

/* Notes all uses of unsupported extensions in the file. */
static void note_extensions(masu_gltf *g, const json_t *in, const char *name, int depth) {
    const char *key, *own = json_string_value(json_object_get(in, "name"));
    json_t *value;
    size_t i;
    if (depth > 64) return;
    if (own && *own) name = own;
    if (json_is_array(in)) {
        json_array_foreach(in, i, value) note_extensions(g, value, name, depth + 1);
    } else if (json_is_object(in)) {
        json_object_foreach((json_t *)(uintptr_t)in, key, value) {
            if (strcmp(key, "extras") == 0) continue;
            if (strcmp(key, "extensions") == 0) {
                const char *extension;
                json_t *about;
                json_object_foreach(value, extension, about) {
                    char what[128];
                    snprintf(what, sizeof what, "times %.64s, which is not supported", extension);
                    if (!is_read(extension)) masu_gltf_note_one(g, what, name);
                }
            }
            note_extensions(g, value, depth ? name : key, depth + 1);
        }
    }
}

/* ---- the file ---- */

static bool check_version(masu_gltf *g) {
    const json_t *asset = masu_gltf_object(g, g->root, "asset");
    const json_t *number = json_object_get(asset, "version");
    /* In glTF 1 the version is a number or absent; its elements are members of objects. */
    if (json_is_number(number) ? json_number_value(number) < 2
                               : !number && json_is_object(json_object_get(g->root, "meshes")))
        return refuse_first(g);
    const char *version = asset ? masu_gltf_string(g, asset, "version") : NULL;
    const char *least = asset ? masu_gltf_string(g, asset, "minVersion") : NULL;
    if (masu_gltf_failed(g)) return false;
    if (version && strncmp(version, "1.", 2) == 0) return refuse_first(g);
    if (!version || strncmp(version, "2.", 2) != 0)
        return masu_gltf_fail(g, "found glTF version \"%s\", expected 2.0", version ? version : "");
    return !least || strcmp(least, "2.0") == 0 ||
           masu_gltf_fail(g, "it needs glTF version \"%s\", expected 2.0", least);
}

static bool check_arrays(masu_gltf *g) {
    static const char *const names[] = {
        "accessors", "animations", "bufferViews", "buffers", "images",   "materials", "meshes",
        "nodes",     "samplers",   "scenes",      "skins",   "textures", "cameras"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)masu_gltf_array(g, g->root, names[i]);
        if (masu_gltf_count(g, names[i]) > 4000000u)
            return masu_gltf_fail(g, "more than 4 million of \"%s\"", names[i]);
    }
    return !masu_gltf_failed(g);
}

static bool find_variant(masu_gltf *g) {
    const json_t *about = masu_gltf_extension(g, g->root, "KHR_materials_variants");
    const json_t *all = about ? masu_gltf_array(g, about, "variants") : NULL;
    masu_bake_buffer names = {0};
    g->variant_index = -1;
    for (size_t i = 0; i < json_array_size(all); i++) {
        const char *name = json_string_value(json_object_get(json_array_get(all, i), "name"));
        if (!name) continue;
        if (g->variant && g->variant_index < 0 && strcmp(name, g->variant) == 0)
            g->variant_index = (json_int_t)i;
        masu_bake_append_text(&names, names.bytes ? ", \"" : "\"");
        masu_bake_append_text(&names, name);
        masu_bake_append_text(&names, "\"");
    }
    masu_bake_append(&names, "", 1);
    bool good = !masu_gltf_failed(g);
    if (good && g->variant && g->variant_index < 0) {
        good = masu_gltf_fail(g, "it has no variant \"%s\"; available: %.300s", g->variant,
                              names.bytes > 1 ? (const char *)names.data : "none");
    }
    masu_bake_release(&names);
    return good;
}

static bool read_all(masu_gltf *g) {
    if (!parse(g) || !check_version(g) || !check_required(g) || !check_arrays(g) ||
        !find_variant(g) || !read_buffers(g) || !masu_gltf_read_materials(g) ||
        !masu_gltf_read_nodes(g) || !masu_gltf_read_clips(g))
        return false;
    g->scene.mMeshes = (struct aiMesh **)(void *)g->meshes.data;
    g->scene.mNumMeshes = (unsigned)(g->meshes.bytes / sizeof(struct aiMesh *));
    g->scene.mLights = (struct aiLight **)(void *)g->lights.data;
    g->scene.mNumLights = (unsigned)(g->lights.bytes / sizeof(struct aiLight *));
    g->scene.mCameras = (struct aiCamera **)(void *)g->cameras.data;
    g->scene.mNumCameras = (unsigned)(g->cameras.bytes / sizeof(struct aiCamera *));
    note_extensions(g, g->root, "the file", 0);
    report_notes(g);
    return !masu_gltf_failed(g);
}

bool masu_gltf_is_file(const char *path) {
    const char *dot = strrchr(path, '.');
    char head[4] = {0};
    if (dot && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0)) return true;
    FILE *file = fopen(path, "rb");
    bool is_glb =
        file && fread(head, 1, sizeof head, file) == sizeof head && memcmp(head, "glTF", 4) == 0;
    if (file) fclose(file);
    return is_glb;
}

bool masu_gltf_read_bytes(masu_gltf *g, const unsigned char *data, size_t bytes) {
    g->file = (masu_gltf_bytes){data, bytes};
    return read_all(g);
}

bool masu_gltf_read(masu_gltf *g) { return read_whole(g, g->path, &g->file) && read_all(g); }

void masu_gltf_release(masu_gltf *g) {
    json_decref(g->root);
    masu_bake_release(&g->given);
    masu_bake_release(&g->meshes);
    masu_bake_release(&g->lights);
    masu_bake_release(&g->ranges);
    masu_bake_release(&g->cameras);
    masu_bake_pool_release(&g->pool);
}

/* file_kind.c: see file_kind.h. */
#define _POSIX_C_SOURCE 200809L
#include "file_kind.h"

#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { START_BYTES = 1 << 14 }; /* enough of a JSON file to see its first members */

static const struct {
    const char *end;
    masu_file_kind kind;
} ends[] = {
    {".masu", MASU_FILE_BLOB},  {".json", MASU_FILE_DESCRIPTION}, {".sdf", MASU_FILE_SDF},
    {".glsl", MASU_FILE_GLSL},  {".comp", MASU_FILE_GLSL},        {".gltf", MASU_FILE_MODEL},
    {".glb", MASU_FILE_MODEL},  {".obj", MASU_FILE_MODEL},        {".ply", MASU_FILE_MODEL},
    {".stl", MASU_FILE_MODEL},  {".fbx", MASU_FILE_MODEL},        {".dae", MASU_FILE_MODEL},
    {".3ds", MASU_FILE_MODEL},  {".ac", MASU_FILE_MODEL},         {".off", MASU_FILE_MODEL},
    {".x", MASU_FILE_MODEL},    {".blend", MASU_FILE_MODEL},      {".png", MASU_FILE_IMAGE},
    {".pfm", MASU_FILE_IMAGE},  {".jpg", MASU_FILE_IMAGE},        {".jpeg", MASU_FILE_IMAGE},
    {".exr", MASU_FILE_IMAGE},  {".hdr", MASU_FILE_IMAGE},        {".webp", MASU_FILE_IMAGE},
    {".bmp", MASU_FILE_IMAGE},  {".tga", MASU_FILE_IMAGE},        {".tif", MASU_FILE_IMAGE},
    {".tiff", MASU_FILE_IMAGE}, {".gif", MASU_FILE_IMAGE}};

static masu_file_kind kind_of_name(const char *path) {
    size_t length = strlen(path);
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        size_t n = strlen(ends[i].end);
        if (length > n && !strcasecmp(path + length - n, ends[i].end)) return ends[i].kind;
    }
    return MASU_FILE_UNKNOWN;
}

static bool starts(const char *text, size_t count, const char *with) {
    return count >= strlen(with) && !memcmp(text, with, strlen(with));
}

/* Whether a member of this name opens an object or an array: a string of that text does not. */
static bool has_member(const char *text, const char *name, char opens) {
    for (const char *at = text; (at = strstr(at, name));) {
        at += strlen(name);
        const char *colon = at + strspn(at, " \t\r\n");
        if (*colon == ':' && colon[1 + strspn(colon + 1, " \t\r\n")] == opens) return true;
    }
    return false;
}

/* `text` ends with a NUL. Only suites, ladders and glTF have these members. */
static masu_file_kind kind_of_content(const char *text, size_t count) {
    if (starts(text, count, "MASU")) return MASU_FILE_BLOB;
    if (starts(text, count, "\x89PNG") || starts(text, count, "\xFF\xD8\xFF") ||
        starts(text, count, "GIF8"))
        return MASU_FILE_IMAGE;
    if (starts(text, count, "v/1\x01")) return MASU_FILE_IMAGE; /* OpenEXR */
    if (starts(text, count, "glTF")) return MASU_FILE_MODEL;
    if (text[strspn(text, " \t\r\n\xEF\xBB\xBF")] != '{') return MASU_FILE_UNKNOWN;
    if (has_member(text, "\"asset\"", '{')) return MASU_FILE_MODEL;
    if (has_member(text, "\"cases\"", '[')) return MASU_FILE_SUITE;
    if (has_member(text, "\"rungs\"", '[')) return MASU_FILE_LADDER;
    return MASU_FILE_DESCRIPTION;
}

/* -1: no such regular file. */
static ssize_t read_start(const char *path, char *text) {
    struct stat about;
    int file = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    if (file < 0) return -1;
    ssize_t got =
        fstat(file, &about) == 0 && S_ISREG(about.st_mode) ? read(file, text, START_BYTES) : -1;
    (void)close(file);
    return got;
}

masu_file_kind masu_file_kind_of(const char *path, const void *bytes, size_t count) {
    char text[START_BYTES + 1];
    ssize_t got = (ssize_t)(count < START_BYTES ? count : START_BYTES);
    if (bytes) memcpy(text, bytes, (size_t)got);
    else got = read_start(path, text);
    if (got < 0) return MASU_FILE_UNKNOWN;
    text[got] = '\0';
    masu_file_kind kind = kind_of_content(text, (size_t)got);
    return kind ? kind : kind_of_name(path);
}

const char *masu_file_hint(const char *path, const void *bytes, size_t count,
                           masu_file_kind expected) {
    masu_file_kind kind = masu_file_kind_of(path, bytes, count);
    if (kind == expected) return "";
    switch (kind) {
    case MASU_FILE_BLOB: return "; a baked scene, for `masu render`, `masu plan` and `masu-view`";
    case MASU_FILE_DESCRIPTION:
        return "; a scene description: `masu-bake FILE.json -o X.masu` bakes it, `masu-view` shows "
               "it";
    case MASU_FILE_SDF:
        return "; an SDF: `masu-bake FILE.sdf -o X.masu` bakes it, `masu-sdfc` checks it, "
               "`masu-view` shows it";
    case MASU_FILE_GLSL: return "; GLSL: a scene description names it as the source of its SDF";
    case MASU_FILE_MODEL:
        return "; a model: `masu-bake MODEL -o X.masu` bakes it, `masu-view` shows it";
    case MASU_FILE_IMAGE:
        return "; an image, for `masu compare` (PNG, PFM, OpenEXR) and `masu upscale` (PNG)";
    case MASU_FILE_SUITE: return "; a suite, for `masu conform --suite FILE.json`";
    case MASU_FILE_LADDER: return "; a quality ladder, for --ladder FILE.json";
    case MASU_FILE_UNKNOWN: break;
    }
    return "";
}

/* Whether `dot` is one of the space-separated ends. */
static bool is_one_of(const char *dot, const char *ends_of) {
    size_t n = strlen(dot);
    for (const char *at = ends_of; *at;) {
        size_t length = strcspn(at, " ");
        if (length == n && !strncasecmp(at, dot, n)) return true;
        at += length + (at[length] == ' ');
    }
    return false;
}

bool masu_file_named(const char *path, const char *ends_of, char *error, size_t error_size) {
    struct stat about;
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    const char *dot = strrchr(name, '.');
    bool special = stat(path, &about) == 0 && !S_ISREG(about.st_mode);
    if (special || !dot || dot == name || is_one_of(dot, ends_of)) return true;
    char list[64] = "";
    for (const char *at = ends_of; *at;) {
        size_t length = strcspn(at, " "), used = strlen(list);
        const char *between = !used ? "" : at[length] ? ", " : " or ";
        snprintf(list + used, sizeof list - used, "%s%.*s", between, (int)length, at);
        at += length + (at[length] == ' ');
    }
    snprintf(
        error, error_size,
        "%s: found a name that ends in %s, expected one that ends in %s, the only format%s that "
        "can be written",
        path, dot, list, strchr(ends_of, ' ') ? "s" : "");
    return false;
}

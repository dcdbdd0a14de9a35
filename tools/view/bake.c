/* bake.c: opens files and watches them for changes. Files other than blobs are baked first.
 *
 * A baked scene is watched itself. Any other file is watched together with every file that it
 * names. When one of them changes, a child process bakes the scene into a temporary folder. If the
 * bake succeeds, the result is loaded; otherwise the baker's error is shown and the old scene
 * remains.
 *
 * Files are checked twice a second by time and size. A script checks in every frame and waits for
 * the baker, except for a file that is opened while it runs. Only the scene with its .sdf or .glsl
 * can be reloaded: the library's shaders are part of the program. */
#include "view/viewer.h"

#include "bake/base/process.h"
#include "cli/cli.h"
#include "clock.h"
#include "file_kind.h"
#include "image.h"

#include <ctype.h>
#include <errno.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define LOOK_NS 500000000u
#define COUNT(array) (sizeof(array) / sizeof *(array))

/* ---- Watching -------------------------------------------------------------------------------- */

static void look_at(masu_watch *w) {
    struct stat s;
    w->seconds = w->nanoseconds = w->bytes = 0;
    if (stat(w->path, &s) || !S_ISREG(s.st_mode)) return;
    w->seconds = (int64_t)s.st_mtim.tv_sec;
    w->nanoseconds = (int64_t)s.st_mtim.tv_nsec;
    w->bytes = (int64_t)s.st_size;
}

static void watch_contents(masu_baker *b, const char *path);

/* Watches a regular file and the files that it names. */
static void watch(masu_baker *b, const char *path) {
    if (b->count == MASU_WATCHES_MAX || strlen(path) >= sizeof b->watches[0].path) return;
    for (uint32_t i = 0; i < b->count; i++) {
        if (!strcmp(b->watches[i].path, path)) return;
    }
    masu_watch *w = &b->watches[b->count++];
    snprintf(w->path, sizeof w->path, "%s", path);
    look_at(w);
    if (masu_file_is_regular(path)) watch_contents(b, path);
}

/* Watches `name`, relative to the file `from`, if that file exists. */
static void watch_named(masu_baker *b, const char *from, const char *name) {
    char path[1100];
    struct stat s;
    const char *slash = *name == '/' ? NULL : strrchr(from, '/');
    int n = snprintf(path, sizeof path, "%.*s%s", slash ? (int)(slash - from) + 1 : 0, from, name);
    if (*name && n > 0 && n < (int)sizeof path && !stat(path, &s) && S_ISREG(s.st_mode))
        watch(b, path);
}

static void watch_strings(masu_baker *b, const char *from, const json_t *value) {
    const char *key;
    json_t *child;
    size_t i;
    if (json_is_string(value)) {
        watch_named(b, from, json_string_value(value));
    } else if (json_is_object(value)) {
        json_object_foreach((json_t *)value, key, child) watch_strings(b, from, child);
    } else if (json_is_array(value)) {
        json_array_foreach(value, i, child) watch_strings(b, from, child);
    }
}

/* Watches the files that a line of an SDF (include "NAME"), an OBJ (mtllib NAME) or an MTL (map_Kd
 * -s 1 1 1 NAME) names. It tries the rest of the line after the keyword, and its last part. */
static void watch_line(masu_baker *b, const char *from, char *line) {
    static const char *const words[] = {"include", "mtllib", "map_", "bump", "norm", "disp"};
    size_t at = 0;
    line += strspn(line, " \t");
    while (at < COUNT(words) && strncmp(line, words[at], strlen(words[at]))) at++;
    if (at == COUNT(words)) return;
    line += strcspn(line, " \t\"");
    line += strspn(line, " \t\"");
    line[strcspn(line, at ? "\r\n" : "\"\r\n")] = '\0';
    watch_named(b, from, line);
    char *last = strrchr(line, ' ');
    if (last) watch_named(b, from, last + 1);
}

/* Reads file names from the strings of a JSON file or a .gltf, and from the first 64 KiB of other
 * text files. An unreadable file yields no names; the baker reports the error. */
static void watch_contents(masu_baker *b, const char *path) {
    const char *dot = strrchr(path, '.');
    char line[1024];
    long read = 0;
    if (!dot) return;
    if (!strcmp(dot, ".json") || !strcmp(dot, ".gltf")) {
        json_t *root = json_load_file(path, 0, NULL);
        watch_strings(b, path, root);
        json_decref(root);
    } else if (!strcmp(dot, ".sdf") || !strcmp(dot, ".obj") || !strcmp(dot, ".mtl")) {
        FILE *f = fopen(path, "r");
        while (f && read < 65536 && fgets(line, sizeof line, f)) {
            read += (long)strlen(line);
            watch_line(b, path, line);
        }
        if (f) fclose(f);
    }
}

/* A missing file is ignored: it is probably being written. */
static bool has_changed(masu_baker *b) {
    bool changed = false;
    for (uint32_t i = 0; i < b->count; i++) {
        masu_watch now = b->watches[i], *was = &b->watches[i];
        look_at(&now);
        if (!now.seconds && !now.bytes) continue;
        changed = changed || now.seconds != was->seconds || now.nanoseconds != was->nanoseconds ||
                  now.bytes != was->bytes;
        *was = now;
    }
    return changed;
}

/* ---- Processes ------------------------------------------------------------------------------- */

void masu_program_beside(char *out, size_t size, const char *name) {
    char path[1024];
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    path[n > 0 ? n : 0] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) slash[1] = '\0';
    snprintf(out, size, "%s%s", slash ? path : "", name);
}

long masu_child_start(masu_viewer *v, const char *words, const char *log, char *const arguments[]) {
    char *argv[16] = {"sh", "-c", (char *)words, "sh"};
    for (int i = 0; arguments[i] && i < 11; i++) argv[4 + i] = arguments[i];
    fflush(NULL);
    pid_t parent = getpid(), child = fork();
    if (child < 0) {
        snprintf(v->error, sizeof v->error, "cannot start a process: %s", strerror(errno));
        return 0;
    }
    if (!child) {
        masu_bake_end_with_parent(parent, SIGTERM);
        if (!freopen(log, "w", stderr) || !freopen("/dev/null", "w", stdout)) _exit(126);
        (void)setenv("MASU_PROGRESS", "1", 1);
        execv("/bin/sh", argv);
        _exit(127);
    }
    return child;
}

bool masu_child_ended(long child, bool wait, int *status) {
    pid_t r;
    *status = -1;
    do {
        r = waitpid((pid_t)child, status, wait ? 0 : WNOHANG);
    } while (r < 0 && errno == EINTR);
    if (r < 0) *status = -1;
    return r != 0;
}

void masu_child_end(long child) {
    int status;
    if (!child) return;
    kill((pid_t)child, SIGTERM);
    (void)masu_child_ended(child, true, &status);
}

/* ---- Baking ---------------------------------------------------------------------------------- */

static bool make_folder(masu_viewer *v) {
    masu_baker *b = &v->baker;
    if (b->folder[0]) return true;
    const char *root = getenv("TMPDIR");
    snprintf(b->folder, sizeof b->folder, "%.900s/masu-view-XXXXXX", root && *root ? root : "/tmp");
    if (!mkdtemp(b->folder)) {
        snprintf(v->error, sizeof v->error, "%.900s: cannot create the folder: %.80s", b->folder,
                 strerror(errno));
        b->folder[0] = '\0';
        return false;
    }
    snprintf(b->output, sizeof b->output, "%s/scene.masu", b->folder);
    snprintf(b->log, sizeof b->log, "%s/baker.log", b->folder);
    return true;
}

/* Runs `COMMAND SOURCE -o OUTPUT ...` with stderr in the log. */
static bool begin(masu_viewer *v) {
    masu_baker *b = &v->baker;
    char program[1100], words[4096], turn[32];
    char *arguments[9] = {b->source, "-o", b->output};
    int count = 3;
    if (!make_folder(v)) return false;
    if (v->o->bake) {
        snprintf(words, sizeof words, "exec %s \"$@\"", v->o->bake);
    } else {
        masu_program_beside(program, sizeof program, "masu-bake");
        snprintf(words, sizeof words, "exec '%s' \"$@\"", program);
    }
    if (b->turn != 0.0f) {
        snprintf(turn, sizeof turn, "%.1f", (double)b->turn);
        arguments[count++] = "--turn";
        arguments[count++] = turn;
    }
    if (*b->variant) {
        arguments[count++] = "--variant";
        arguments[count++] = b->variant;
    }
    b->again = false;
    b->begun_ns = masu_clock_ns(NULL);
    b->child = masu_child_start(v, words, b->log, arguments);
    return b->child != 0;
}

/* Finds the first line that is not a warning, or the first line if all are warnings. */
static void read_complaint(const char *log, char *out, size_t size) {
    char line[512];
    bool found = false;
    FILE *f = fopen(log, "r");
    out[0] = '\0';
    while (f && !found && fgets(line, sizeof line, f)) {
        line[strcspn(line, "\n")] = '\0';
        char *wiped = strrchr(line, '\033'); /* skip the progress text before it */
        if (wiped && strlen(wiped) > 2) memmove(line, wiped + 3, strlen(wiped + 3) + 1);
        if (!*line) continue;
        found = !strstr(line, ": warning: ");
        if (found || !*out) snprintf(out, size, "%s", line);
    }
    if (f) fclose(f);
}

/* Returns true if the process has ended; *good is its success. */
static bool ended(masu_viewer *v, bool wait, bool *good) {
    masu_baker *b = &v->baker;
    int status;
    if (!masu_child_ended(b->child, wait, &status)) return false;
    b->child = 0;
    *good = WIFEXITED(status) && !WEXITSTATUS(status);
    if (*good) return true;
    read_complaint(b->log, v->error, sizeof v->error);
    if (!*v->error)
        snprintf(v->error, sizeof v->error, "the baker failed: %s", masu_cli_status(status));
    return true;
}

/* The current step of the bake, and the fraction done if the step reports "N of M". */
void masu_baker_progress(const masu_viewer *v, float *fraction, char *text, size_t size) {
    const masu_baker *b = &v->baker;
    char log[2048] = "", *last;
    unsigned done, all;
    const char *slash = strrchr(b->source, '/'), *of;
    FILE *f = fopen(b->log, "r");
    if (f && !fseek(f, 0, SEEK_END) && ftell(f) > (long)sizeof log)
        (void)fseek(f, 1 - (long)sizeof log, SEEK_END);
    else if (f)
        rewind(f);
    size_t n = f ? fread(log, 1, sizeof log - 1, f) : 0;
    if (f) fclose(f);
    log[n] = '\0';
    last = strrchr(log, '\033');
    snprintf(text, size, "baking %s, %.0f s%s%.200s", slash ? slash + 1 : b->source,
             (double)(masu_clock_ns(NULL) - b->begun_ns) / 1e9,
             last && last[1] && last[2] && last[3] ? ": " : "",
             last && strlen(last) > 3 ? last + 3 : "");
    *fraction = -1.0f;
    of = last ? strstr(last, " of ") : NULL;
    while (of && of > last && isdigit((unsigned char)of[-1])) of--;
    if (of && sscanf(of, "%u of %u", &done, &all) == 2 && all) *fraction = (float)done / (float)all;
}

/* ---- Opening --------------------------------------------------------------------------------- */

static void fail(masu_viewer *v) { snprintf(v->trouble, sizeof v->trouble, "%s", v->error); }

static bool finish(masu_viewer *v, bool good) {
    masu_baker *b = &v->baker;
    bool fresh = b->opens;
    b->count = 0; /* the source may name different files now */
    watch(b, b->source);
    if (!good) return fail(v), true;
    b->opens = false;
    snprintf(b->blob, sizeof b->blob, "%s", b->output);
    return masu_viewer_load(v, b->blob, fresh);
}

/* Returns false only if the device is lost. */
static bool open_it(masu_viewer *v, const char *path) {
    masu_baker *b = &v->baker;
    if (!masu_file_is_regular(path)) {
        snprintf(v->error, sizeof v->error, "%.900s: no such file", path);
        return fail(v), true;
    }
    masu_child_end(b->child);
    b->child = 0;
    b->count = 0;
    b->turn = 0.0f;
    b->variant_count = 0;
    b->variant[0] = b->source[0] = '\0';
    b->opens = true;
    v->trouble[0] = '\0';
    v->gallery.open = false;
    masu_file_kind kind = masu_file_kind_of(path, NULL, 0);
    if (kind == MASU_FILE_BLOB) {
        snprintf(b->blob, sizeof b->blob, "%s", path);
        watch(b, path);
        b->opens = false;
        return masu_viewer_load(v, path, true);
    }
    snprintf(b->source, sizeof b->source, "%s", path);
    watch(b, path);
    masu_baker_read_variants(v);
    if (!begin(v)) fail(v);
    return true;
}

void masu_baker_open(masu_viewer *v, const char *path) {
    if (!open_it(v, path)) v->lost = true;
}

bool masu_baker_start(masu_viewer *v) {
    masu_baker *b = &v->baker;
    const char *json = v->o->json, *scene = v->o->scene;
    b->looked_ns = masu_clock_ns(NULL);
    if (scene && json) { /* baked already: watch the description for changes */
        snprintf(b->source, sizeof b->source, "%s", json);
        snprintf(b->blob, sizeof b->blob, "%s", scene);
        watch(b, json);
        return masu_viewer_load(v, scene, true);
    }
    if (!scene && !json) return masu_gallery_open(v), true;
    return open_it(v, scene ? scene : json) && (!v->scripted || masu_baker_wait(v));
}

bool masu_baker_wait(masu_viewer *v) {
    bool good;
    if (!v->baker.child) return true;
    (void)ended(v, true, &good);
    return finish(v, good);
}

void masu_baker_again(masu_viewer *v) {
    if (!*v->baker.source) return;
    if (v->baker.child)
        v->baker.again = true;
    else if (!begin(v))
        fail(v);
}

bool masu_baker_poll(masu_viewer *v) {
    masu_baker *b = &v->baker;
    uint64_t now = masu_clock_ns(NULL);
    bool good;
    if (b->child && ended(v, false, &good)) {
        if (!b->again) return finish(v, good);
        return begin(v) || (fail(v), true);
    }
    if (!v->scripted && now - b->looked_ns < LOOK_NS) return true;
    b->looked_ns = now;
    if (!has_changed(b)) return true;
    if (!*b->source) return masu_viewer_load(v, b->blob, false);
    if (b->child) {
        b->again = true;
        return true;
    }
    if (!begin(v)) return fail(v), true;
    return !v->scripted || masu_baker_wait(v);
}

void masu_baker_close(masu_baker *b) {
    masu_child_end(b->child);
    b->child = 0;
    if (!b->folder[0]) return;
    (void)remove(b->output);
    (void)remove(b->log);
    (void)rmdir(b->folder);
    b->folder[0] = '\0';
}

/* bake.c: files that change while the scene is looked at.
 *
 * Without --json the baked scene itself is watched. With it, the description and every file that it
 * names: when one of them changes, a process bakes the scene into a folder of ours, and what comes out
 * is loaded if it succeeds; if not, the line that it has said is shown and the old scene stays. Files
 * are looked at twice a second, by time and size; a script looks at every frame and waits for the baker.
 * Shaders of the library are part of the program: what can be reloaded is the scene with its .sdf or
 * .glsl. */
#include "view/viewer.h"

#include "cli/cli.h"
#include "clock.h"
#include "image.h"

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

/* ---- Watching -------------------------------------------------------------------------------- */

static void look_at(masu_watch *w) {
    struct stat s;
    w->seconds = w->nanoseconds = w->bytes = 0;
    if (stat(w->path, &s) || !S_ISREG(s.st_mode)) return;
    w->seconds = (int64_t)s.st_mtim.tv_sec;
    w->nanoseconds = (int64_t)s.st_mtim.tv_nsec;
    w->bytes = (int64_t)s.st_size;
}

static void watch(masu_baker *b, const char *path) {
    if (b->count == MASU_WATCHES_MAX || strlen(path) >= sizeof b->watches[0].path) return;
    for (uint32_t i = 0; i < b->count; i++) {
        if (!strcmp(b->watches[i].path, path)) return;
    }
    masu_watch *w = &b->watches[b->count++];
    snprintf(w->path, sizeof w->path, "%s", path);
    look_at(w);
}

/* Any text of the description that is the path of a file beside it. */
static void watch_named(masu_baker *b, const char *folder, const json_t *value) {
    const char *key;
    json_t *child;
    size_t i;
    if (json_is_string(value)) {
        char path[1100];
        struct stat s;
        const char *text = json_string_value(value);
        int n = snprintf(path, sizeof path, "%s%s", *text == '/' ? "" : folder, text);
        if (*text && n > 0 && n < (int)sizeof path && !stat(path, &s) && S_ISREG(s.st_mode)) watch(b, path);
    } else if (json_is_object(value)) {
        json_object_foreach((json_t *)value, key, child) watch_named(b, folder, child);
    } else if (json_is_array(value)) {
        json_array_foreach(value, i, child) watch_named(b, folder, child);
    }
}

/* A description that cannot be read is watched by itself; the baker says what is wrong with it. */
static void watch_description(masu_baker *b, const char *json) {
    char folder[1024] = "";
    const char *slash = strrchr(json, '/');
    if (slash && (size_t)(slash - json) + 2 < sizeof folder)
        snprintf(folder, sizeof folder, "%.*s", (int)(slash - json) + 1, json);
    watch(b, json);
    json_t *root = masu_file_is_regular(json) ? json_load_file(json, 0, NULL) : NULL;
    watch_named(b, folder, root);
    json_decref(root);
}

/* What is not there at the moment is being written. */
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

/* ---- Baking ---------------------------------------------------------------------------------- */

static void program_beside(char *out, size_t size, const char *name) {
    char path[1024];
    ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
    path[n > 0 ? n : 0] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) slash[1] = '\0';
    snprintf(out, size, "%s%s", slash ? path : "", name);
}

/* `COMMAND JSON -o OUTPUT --quiet`, what it says into a file. */
static bool begin(masu_viewer *v) {
    masu_baker *b = &v->baker;
    char program[1100], words[4096];
    program_beside(program, sizeof program, "masu-bake");
    snprintf(words, sizeof words, "exec %s \"$@\"", v->o->bake ? v->o->bake : "\"$0\"");
    b->again = false;
    fflush(NULL);
    pid_t child = fork();
    if (child < 0) {
        snprintf(v->error, sizeof v->error, "cannot start the baker: %s", strerror(errno));
        return false;
    }
    if (!child) {
        if (!freopen(b->log, "w", stderr) || !freopen("/dev/null", "w", stdout)) _exit(126);
        execl("/bin/sh", "sh", "-c", words, program, v->o->json, "-o", b->output, "--quiet", (char *)NULL);
        _exit(127);
    }
    b->child = child;
    return true;
}

/* The first line that is no warning, else the first there is. */
static void read_complaint(const char *log, char *out, size_t size) {
    char line[512];
    bool found = false;
    FILE *f = fopen(log, "r");
    out[0] = '\0';
    while (f && !found && fgets(line, sizeof line, f)) {
        line[strcspn(line, "\n")] = '\0';
        if (!*line) continue;
        found = !strstr(line, ": warning: ");
        if (found || !*out) snprintf(out, size, "%s", line);
    }
    if (f) fclose(f);
}

/* True: it has ended; *good says how. */
static bool ended(masu_viewer *v, bool wait, bool *good) {
    masu_baker *b = &v->baker;
    int status = 0;
    pid_t r;
    do {
        r = waitpid((pid_t)b->child, &status, wait ? 0 : WNOHANG);
    } while (r < 0 && errno == EINTR);
    if (!r) return false;
    b->child = 0;
    *good = r > 0 && WIFEXITED(status) && !WEXITSTATUS(status);
    if (*good) return true;
    read_complaint(b->log, v->error, sizeof v->error);
    if (!*v->error)
        snprintf(v->error, sizeof v->error, "the baker failed: %s", masu_cli_status(status));
    return true;
}

static bool make_folder(masu_viewer *v) {
    masu_baker *b = &v->baker;
    const char *root = getenv("TMPDIR");
    snprintf(b->folder, sizeof b->folder, "%.900s/masu-view-XXXXXX", root && *root ? root : "/tmp");
    if (!mkdtemp(b->folder)) {
        snprintf(v->error, sizeof v->error, "%s: cannot create the folder: %s", b->folder,
                 strerror(errno));
        b->folder[0] = '\0';
        return false;
    }
    snprintf(b->output, sizeof b->output, "%s/scene.masu", b->folder);
    snprintf(b->log, sizeof b->log, "%s/baker.log", b->folder);
    return true;
}

bool masu_baker_open(masu_viewer *v) {
    masu_baker *b = &v->baker;
    bool good = false;
    b->looked_ns = masu_clock_ns(NULL);
    if (!v->o->json) {
        watch(b, v->o->scene);
        return true;
    }
    watch_description(b, v->o->json);
    if (!make_folder(v)) return false;
    if (v->o->scene) return true;
    if (!begin(v)) return false;
    (void)ended(v, true, &good);
    return good;
}

static bool finish(masu_viewer *v, bool good) {
    masu_baker *b = &v->baker;
    if (!good) {
        snprintf(v->trouble, sizeof v->trouble, "%s", v->error);
        v->stale_overlay = true;
        return true;
    }
    b->count = 0; /* it may name other files now */
    watch_description(b, v->o->json);
    return masu_viewer_load(v, b->output);
}

bool masu_baker_poll(masu_viewer *v) {
    masu_baker *b = &v->baker;
    uint64_t now = masu_clock_ns(NULL);
    bool good;
    if (b->child && ended(v, false, &good)) {
        if (!b->again) return finish(v, good);
        return begin(v) || (snprintf(v->trouble, sizeof v->trouble, "%s", v->error), true);
    }
    if (!v->scripted && now - b->looked_ns < LOOK_NS) return true;
    b->looked_ns = now;
    if (!has_changed(b)) return true;
    if (!v->o->json) return masu_viewer_load(v, v->o->scene);
    if (b->child) {
        b->again = true;
        return true;
    }
    masu_viewer_note(v, "baking %.200s", v->o->json);
    if (!begin(v)) {
        snprintf(v->trouble, sizeof v->trouble, "%s", v->error);
        return true;
    }
    if (!v->scripted) return true;
    (void)ended(v, true, &good);
    return finish(v, good);
}

void masu_baker_close(masu_baker *b) {
    if (b->child) {
        kill((pid_t)b->child, SIGTERM);
        (void)waitpid((pid_t)b->child, NULL, 0);
        b->child = 0;
    }
    if (!b->folder[0]) return;
    (void)remove(b->output);
    (void)remove(b->log);
    (void)rmdir(b->folder);
    b->folder[0] = '\0';
}

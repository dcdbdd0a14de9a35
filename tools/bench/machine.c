/* machine.c: see machine.h. */
#define _GNU_SOURCE /* sched_getaffinity */
#include "bench/machine.h"

#include "bench/sweep.h"
#include "image.h"

#include <inttypes.h>
#include <jansson.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define TEXT(x) #x
#define VERSION(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

bool masu_machine_cpu(const char *cpuinfo, char *out, size_t size) {
    const char *line = strstr(cpuinfo, "model name");
    const char *value = line ? line + strcspn(line, ":\n") : "";
    snprintf(out, size, "unknown");
    if (*value != ':') return false;
    value += 1 + strspn(value + 1, " \t");
    size_t n = strcspn(value, "\n");
    if (!n) return false;
    snprintf(out, size, "%.*s", (int)n, value);
    return true;
}

void masu_machine_here(const char *driver, masu_machine *out) {
    char text[4096] = "";
    memset(out, 0, sizeof *out);
    FILE *f = fopen("/proc/cpuinfo", "r"); /* the lines of the first processor are enough */
    if (f) {
        text[fread(text, 1, sizeof text - 1, f)] = 0;
        fclose(f);
    }
    masu_machine_cpu(text, out->cpu, sizeof out->cpu);
    cpu_set_t set;
    out->threads = sched_getaffinity(0, sizeof set, &set) ? 0 : (uint32_t)CPU_COUNT(&set);
    snprintf(out->driver, sizeof out->driver, "%.255s", driver);
    snprintf(out->masu, sizeof out->masu, "%s",
             VERSION(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH));
    time_t seconds = time(NULL);
    struct tm utc;
    if (gmtime_r(&seconds, &utc)) strftime(out->date, sizeof out->date, "%Y-%m-%d %H:%M UTC", &utc);
}

void masu_machine_build(char out[17]) {
    uint8_t *program;
    size_t bytes;
    uint64_t hash = 14695981039346656037u; /* FNV-1a */
    out[0] = '\0';
    if (!masu_file_read("/proc/self/exe", (size_t)1 << 30, &program, &bytes, NULL, 0)) return;
    for (size_t i = 0; i < bytes; i++) hash = (hash ^ program[i]) * 1099511628211u;
    free(program);
    snprintf(out, 17, "%016" PRIx64, hash);
}

#define MACHINE_BYTES_MAX ((size_t)16 << 20)

/* Returns an empty array if the file does not exist, and NULL if it has other contents. */
static json_t *load(const char *folder, char path[4096], char *error, size_t error_size) {
    json_error_t why;
    if (!masu_sweep_path(folder, "machine.json", path)) {
        snprintf(error, error_size, "%.2000s: the path is too long", folder);
        return NULL;
    }
    uint8_t *text = NULL;
    size_t bytes = 0;
    if (!masu_file_exists(path)) return json_array();
    if (!masu_file_read(path, MACHINE_BYTES_MAX, &text, &bytes, error, error_size)) return NULL;
    json_t *list = json_loadb((const char *)text, bytes, 0, &why);
    free(text);
    if (json_is_array(list)) return list;
    json_decref(list);
    snprintf(error, error_size, "%.2000s: expected a list of runs", path);
    return NULL;
}

static bool save(const char *path, json_t *list, char *error, size_t error_size) {
    char *text = json_dumps(list, JSON_INDENT(1));
    bool good = text && masu_file_write(path, text, strlen(text), error, error_size);
    if (!text) snprintf(error, error_size, "%.2000s: out of memory", path);
    free(text);
    return good;
}

static const char *day_of(const json_t *run) {
    const char *date = json_string_value(json_object_get(run, "date"));
    return date ? date : "";
}

static bool same_but_time(const json_t *a, const json_t *b) {
    static const char *const keys[] = {"cpu", "threads", "driver", "masu"};
    bool same = !strncmp(day_of(a), day_of(b), 10);
    for (size_t i = 0; i < sizeof keys / sizeof *keys && same; i++)
        same = json_equal(json_object_get(a, keys[i]), json_object_get(b, keys[i]));
    return same;
}

bool masu_machine_append(const char *folder, const masu_machine *m, char *error,
                         size_t error_size) {
    char path[4096];
    json_t *list = load(folder, path, error, error_size);
    if (!list) return false;
    json_t *run = json_pack("{s:s, s:i, s:s, s:s, s:s}", "cpu", m->cpu, "threads", (int)m->threads,
                            "driver", m->driver, "masu", m->masu, "date", m->date);
    size_t count = json_array_size(list);
    bool there = count && same_but_time(json_array_get(list, count - 1), run);
    json_array_append_new(list, run);
    bool good = there || save(path, list, error, error_size);
    json_decref(list);
    return good;
}

void masu_machine_forget(const char *folder) {
    char path[4096];
    if (masu_sweep_path(folder, "machine.json", path)) (void)remove(path);
}

static bool among(const json_t *list, const json_t *one) {
    for (size_t i = 0; i < json_array_size(list); i++) {
        if (json_equal(json_array_get(list, i), one)) return true;
    }
    return false;
}

bool masu_machine_merge(const char *folder, const char *part, char *error, size_t error_size) {
    char path[4096], from[4096];
    json_t *more = load(part, from, error, error_size);
    json_t *list = more ? load(folder, path, error, error_size) : NULL;
    bool good = list != NULL;
    size_t before = json_array_size(list);
    for (size_t i = 0; i < json_array_size(more) && good; i++) {
        json_t *one = json_array_get(more, i);
        if (!among(list, one)) json_array_append(list, one);
    }
    if (good && json_array_size(list) > before) good = save(path, list, error, error_size);
    json_decref(more);
    json_decref(list);
    return good;
}

static void copy(const json_t *from, const char *key, char *out, size_t size) {
    const char *text = json_string_value(json_object_get(from, key));
    snprintf(out, size, "%s", text ? text : "unknown");
}

bool masu_machine_read(const char *folder, uint32_t i, masu_machine *out) {
    char path[4096], error[256];
    json_t *list = load(folder, path, error, sizeof error);
    const json_t *one = json_array_get(list, i);
    memset(out, 0, sizeof *out);
    if (one) {
        copy(one, "cpu", out->cpu, sizeof out->cpu);
        copy(one, "driver", out->driver, sizeof out->driver);
        copy(one, "masu", out->masu, sizeof out->masu);
        copy(one, "date", out->date, sizeof out->date);
        out->threads = (uint32_t)json_integer_value(json_object_get(one, "threads"));
    }
    json_decref(list);
    return one != NULL;
}

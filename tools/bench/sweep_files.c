/* sweep_files.c: see sweep_files.h. */
#include "bench/sweep_files.h"

#include "bench/machine.h"
#include "image.h"

#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#define TEXT_MAX ((size_t)64 << 20)

static bool fail(char *error, size_t size, const char *subject, const char *text) {
    snprintf(error, size, "%.2000s: %.500s", subject, text);
    return false;
}

bool masu_sweep_path(const char *folder, const char *name, char out[4096]) {
    return snprintf(out, 4096, "%s/%s", folder, name) < 4096;
}

bool masu_sweep_picture(const char *folder, const char *setting, const char *suffix,
                        char out[4096]) {
    return masu_setting_is_name(setting) &&
           snprintf(out, 4096, "%s/pictures/%s%s.png", folder, setting, suffix) < 4096;
}

/* ---- sweep.json ------------------------------------------------------------------------------ */

/* A whole file as text; NULL if it does not exist or cannot be read. */
static char *read_text(const char *path) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    if (!masu_file_read(path, TEXT_MAX, &bytes, &count, NULL, 0)) return NULL;
    char *text = malloc(count + 1);
    if (text) {
        if (count) memcpy(text, bytes, count);
        text[count] = 0;
    }
    free(bytes);
    return text;
}

static json_t *knobs_json(const masu_rung *rung) {
    json_t *knobs = json_object();
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        char text[64];
        masu_knob_json(k, rung, text, sizeof text);
        json_object_set_new(knobs, k->name, json_loads(text, JSON_DECODE_ANY, NULL));
    }
    return knobs;
}

/* Everything that two parts of one sweep must have in common, which excludes the shard. */
static char *describe(const masu_sweep_desc *d, const masu_sweep_about *about) {
    char hex[32];
    const char *last = strrchr(d->scene_path, '/');
    json_t *there = json_array(), *dropped = json_array();
    snprintf(hex, sizeof hex, "%016llx", (unsigned long long)about->hash);
    for (uint32_t i = 0; i < about->count; i++) {
        const masu_setting *s = &about->settings[i];
        if (s->dropped[0]) {
            json_array_append_new(dropped,
                                  json_pack("{s:s, s:s}", "setting", s->id, "why", s->dropped));
        } else {
            json_array_append_new(there,
                                  json_pack("{s:s, s:s, s:s, s:b, s:o}", "setting", s->id, "parent",
                                            s->parent, "technique", s->technique, "same_picture",
                                            (int)s->same_picture, "knobs", knobs_json(&s->rung)));
        }
    }
    json_t *root = json_pack(
        "{s:s, s:s, s:s, s:s, s:i, s:i, s:f, s:i, s:i, s:i, s:i, s:b, s:o, s:o}", "scene",
        last ? last + 1 : d->scene_path, "hash", hex, "driver", about->driver, "depth",
        about->depth, "width", (int)d->size.width, "height", (int)d->size.height, "time", d->time,
        "positions", (int)d->positions, "rays", (int)d->rays, "frames", (int)d->frames, "runs",
        (int)d->runs, "quick", d->quick, "settings", there, "dropped", dropped);
    char *text = root ? json_dumps(root, JSON_INDENT(1)) : NULL;
    json_decref(root);
    return text;
}

static bool begin_with(const char *folder, const char *text, char *error, size_t error_size) {
    char json[4096], csv[4096], pictures[4096];
    if (!masu_sweep_path(folder, "pictures", pictures) ||
        !masu_sweep_path(folder, "results.csv", csv) ||
        !masu_sweep_path(folder, "sweep.json", json)) {
        return fail(error, error_size, folder, "the path is too long");
    }
    if (!masu_folder_make(folder, error, error_size) ||
        !masu_folder_make(pictures, error, error_size))
        return false;
    char *old = read_text(json);
    bool same = old && !strcmp(old, text), other = old && !same;
    free(old);
    if (other) {
        return fail(
            error, error_size, folder,
            "contains another sweep (scene, size, time, runs, driver or settings differ, see "
            "sweep.json): use another folder, or remove this one");
    }
    return same || masu_file_write(json, text, strlen(text), error, error_size);
}

bool masu_sweep_begin(const masu_sweep_desc *d, const masu_sweep_about *about, char *error,
                      size_t error_size) {
    char *text = describe(d, about);
    if (!text) return fail(error, error_size, d->folder, "out of memory for sweep.json");
    bool good = begin_with(d->folder, text, error, error_size);
    free(text);
    return good;
}

/* ---- One program ----------------------------------------------------------------------------- */

bool masu_sweep_one_build(const masu_row *rows, uint32_t count, const char *build, const char *path,
                          char *error, size_t error_size) {
    for (uint32_t i = 0; i < count; i++) {
        if (!strcmp(rows[i].build, build)) continue;
        snprintf(
            error, error_size,
            "%.2000s: %s was measured by another build of the program: found %s, expected %s; use "
            "another folder, or remove this one",
            path, rows[i].setting, *rows[i].build ? rows[i].build : "an unknown one",
            *build ? build : "an unknown one");
        return false;
    }
    return true;
}

int masu_sweep_lock(const char *folder, char *error, size_t error_size) {
    if (!masu_folder_make(folder, error, error_size)) return -1;
    int file = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file >= 0 && (flock(file, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)) return file;
    bool busy = file >= 0;
    fail(error, error_size, folder,
         busy ? "another masu bench is writing to this folder" : strerror(errno));
    if (busy) (void)close(file);
    return -1;
}

/* ---- results.csv, steady.csv ----------------------------------------------------------------- */

static masu_row *rows_of(const char *folder, const char *name, uint32_t *count, char *error,
                         size_t error_size) {
    char path[4096], why[256];
    *count = 0;
    if (!masu_sweep_path(folder, name, path)) {
        fail(error, error_size, folder, "the path is too long");
        return NULL;
    }
    char *text = read_text(path);
    masu_row *rows = text ? masu_rows_read(text, count, why, sizeof why) : calloc(1, sizeof *rows);
    if (!rows) fail(error, error_size, path, text ? why : "out of memory");
    free(text);
    if (rows && *count &&
        !masu_sweep_one_build(rows, *count, rows[0].build, path, error, error_size)) {
        free(rows);
        return NULL;
    }
    return rows;
}

masu_row *masu_sweep_steady_rows(const char *folder, uint32_t *count, char *error,
                                 size_t error_size) {
    return rows_of(folder, MASU_SWEEP_STEADY, count, error, error_size);
}

static void take_times(masu_row *row, const masu_row *from) {
    row->wall_min = from->wall_min;
    row->wall_p50 = from->wall_p50;
    row->wall_p95 = from->wall_p95;
    row->wall_p99 = from->wall_p99;
    row->gpu_min = from->gpu_min;
    row->gpu_p50 = from->gpu_p50;
    row->plausible = from->plausible;
    row->base_wall_min = from->base_wall_min;
    row->base_gpu_min = from->base_gpu_min;
    row->ratio = from->ratio;
    row->gpu_ratio = from->gpu_ratio;
    row->least_ratio = from->least_ratio;
    row->gpu_least_ratio = from->gpu_least_ratio;
}

masu_row *masu_sweep_rows(const char *folder, uint32_t *count, char *error, size_t error_size) {
    uint32_t again_count = 0;
    masu_row *rows = rows_of(folder, MASU_SWEEP_RESULTS, count, error, error_size);
    masu_row *again =
        rows ? masu_sweep_steady_rows(folder, &again_count, error, error_size) : NULL;
    if (!again) {
        free(rows);
        return NULL;
    }
    bool good = !again_count || !*count ||
                masu_sweep_one_build(again, again_count, rows[0].build, folder, error, error_size);
    for (uint32_t i = 0; i < *count && good; i++) {
        const masu_row *row = masu_rows_find(again, again_count, rows[i].setting);
        if (row) take_times(&rows[i], row);
    }
    free(again);
    if (good) return rows;
    free(rows);
    return NULL;
}

static bool write_rows(const char *folder, const char *name, const masu_row *rows, uint32_t count,
                       char *error, size_t error_size) {
    char path[4096], *text = NULL;
    size_t bytes = 0;
    if (!masu_sweep_path(folder, name, path))
        return fail(error, error_size, folder, "the path is too long");
    FILE *f = open_memstream(&text, &bytes);
    bool good = f && masu_rows_header(f) > 0;
    for (uint32_t i = 0; i < count && good; i++) good = masu_rows_write(f, &rows[i]) > 0;
    good = (!f || !fclose(f)) && good;
    if (good) {
        good = masu_file_write(path, text, bytes, error, error_size);
    } else {
        fail(error, error_size, path, "out of memory");
    }
    free(text);
    return good;
}

/* A clone of the project has the rows of its reports, but not their images. */
static uint32_t keep_drawn(const char *folder, masu_row *rows, uint32_t count) {
    char path[4096];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (masu_sweep_picture(folder, rows[i].setting, "", path) && masu_file_exists(path))
            rows[kept++] = rows[i];
    }
    return kept;
}

/* Steady times of rows that will be measured again are dropped. */
static uint32_t keep_known(const masu_row *known, uint32_t known_count, masu_row *rows,
                           uint32_t count) {
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (masu_rows_find(known, known_count, rows[i].setting)) rows[kept++] = rows[i];
    }
    return kept;
}

/* A file that does not exist is not created. */
static bool rewrite(const char *folder, const char *name, const masu_row *rows, uint32_t count,
                    char *error, size_t error_size) {
    char path[4096];
    return (masu_sweep_path(folder, name, path) && !masu_file_exists(path)) ||
           write_rows(folder, name, rows, count, error, error_size);
}

masu_row *masu_sweep_resume(const char *folder, uint32_t *count, char *error, size_t error_size) {
    uint32_t again_count = 0;
    masu_row *rows = rows_of(folder, MASU_SWEEP_RESULTS, count, error, error_size);
    masu_row *again =
        rows ? masu_sweep_steady_rows(folder, &again_count, error, error_size) : NULL;
    bool good = again != NULL;
    if (good) {
        *count = keep_drawn(folder, rows, *count);
        again_count = keep_known(rows, *count, again, again_count);
        good = rewrite(folder, MASU_SWEEP_RESULTS, rows, *count, error, error_size) &&
               rewrite(folder, MASU_SWEEP_STEADY, again, again_count, error, error_size);
    }
    free(again);
    if (good) return rows;
    free(rows);
    return NULL;
}

bool masu_sweep_append(const char *folder, const char *name, const masu_row *row, char *error,
                       size_t error_size) {
    char path[4096];
    if (!masu_sweep_path(folder, name, path))
        return fail(error, error_size, folder, "the path is too long");
    /* O_NONBLOCK avoids waiting for the reader of a FIFO. */
    int file = open(path, O_WRONLY | O_APPEND | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0666);
    FILE *f = file >= 0 ? fdopen(file, "a") : NULL;
    if (!f && file >= 0) (void)close(file);
    if (!f) return fail(error, error_size, path, strerror(errno));
    bool good = !fseek(f, 0, SEEK_END) && (ftell(f) > 0 || masu_rows_header(f) > 0) &&
                masu_rows_write(f, row) > 0;
    good = !fclose(f) && good;
    return good || fail(error, error_size, path, "cannot write");
}

/* ---- Merging --------------------------------------------------------------------------------- */

/* Images are decoded before they are copied, since they may come from another machine. */
static bool copy(const char *from, const char *to, char *error, size_t error_size) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    struct masu_image picture = {0};
    const char *end = strrchr(from, '.');
    bool good =
        end && (!strcmp(end, ".png") ? masu_image_load_png(from, &picture, error, error_size)
                                     : masu_image_load_pfm(from, &picture, error, error_size));
    masu_image_free(&picture);
    good = good &&
           masu_file_read(from, MASU_IMAGE_FILE_BYTES_MAX, &bytes, &count, error, error_size) &&
           masu_file_write(to, bytes, count, error, error_size);
    free(bytes);
    return good;
}

typedef struct merged {
    masu_row rows[MASU_SETTINGS_MOST], steady[MASU_SETTINGS_MOST];
    uint32_t count, steady_count; /* if two parts have a setting, the first one is used */
} merged;

/* Adds the rows that `all` lacks, with their images, and the files of the ground truth. */
static bool merge_part(const char *folder, const char *part, merged *all, char *error,
                       size_t error_size) {
    char from[4096], to[4096];
    uint32_t n = 0, steady_count = 0;
    masu_row *rows = rows_of(part, MASU_SWEEP_RESULTS, &n, error, error_size);
    masu_row *steady =
        rows ? masu_sweep_steady_rows(part, &steady_count, error, error_size) : NULL;
    bool good = steady != NULL;
    good = good && (!all->count ||
                    masu_sweep_one_build(rows, n, all->rows[0].build, part, error, error_size));
    for (uint32_t i = 0; i < n && good; i++) {
        if (masu_rows_find(all->rows, all->count, rows[i].setting)) continue;
        if (all->count == MASU_SETTINGS_MOST)
            good = fail(error, error_size, part, "too many settings");
        for (int k = 0; k < 2 && good; k++) { /* not every setting has a separate static image */
            const char *suffix = k ? MASU_SWEEP_REST : "";
            if (!masu_sweep_picture(part, rows[i].setting, suffix, from) ||
                !masu_sweep_picture(folder, rows[i].setting, suffix, to))
                good = fail(error, error_size, part, "the path of an image is too long");
            else if (strcmp(from, to) != 0 && (!k || masu_file_exists(from)))
                good = copy(from, to, error, error_size);
        }
        if (!good) break;
        const masu_row *again = masu_rows_find(steady, steady_count, rows[i].setting);
        all->rows[all->count++] = rows[i];
        if (again) all->steady[all->steady_count++] = *again;
    }
    free(rows);
    free(steady);
    static const char *const truths[] = {"truth.png", "truth.pfm", "truth.specular.pfm"};
    for (size_t i = 0; i < sizeof truths / sizeof *truths && good; i++) {
        good =
            masu_sweep_path(part, truths[i], from) && masu_sweep_path(folder, truths[i], to) &&
            (masu_file_exists(to) || !masu_file_exists(from) || copy(from, to, error, error_size));
    }
    return good;
}

/* The order of sweep.json, independent of the parts. */
static uint32_t in_order(const char *text, const masu_row *all, uint32_t count, masu_row *out) {
    json_t *root = json_loads(text, 0, NULL), *one;
    uint32_t n = 0;
    size_t i;
    json_array_foreach(json_object_get(root, "settings"), i, one) {
        const char *id = json_string_value(json_object_get(one, "setting"));
        const masu_row *row = id ? masu_rows_find(all, count, id) : NULL;
        if (row && n < MASU_SETTINGS_MOST) out[n++] = *row;
    }
    json_decref(root);
    return n;
}

bool masu_sweep_merge(const char *folder, const char *const *parts, uint32_t part_count,
                      char *error, size_t error_size) {
    static masu_row ordered[MASU_SETTINGS_MOST];
    static merged all;
    bool good = true;
    char *text = NULL, path[4096];
    all.count = all.steady_count = 0;
    for (uint32_t i = 0; i < part_count && good; i++) {
        good = masu_sweep_path(parts[i], "sweep.json", path);
        char *own = good ? read_text(path) : NULL;
        if (!own) {
            good =
                fail(error, error_size, parts[i], "no sweep.json: expected a folder of masu bench");
        } else if (text && strcmp(text, own) != 0) {
            good =
                fail(error, error_size, parts[i], "contains another sweep than the first folder");
        }
        if (!good || text) {
            free(own);
        } else {
            text = own;
            good = begin_with(folder, text, error, error_size);
        }
        good = good && merge_part(folder, parts[i], &all, error, error_size) &&
               masu_machine_merge(folder, parts[i], error, error_size);
    }
    good = good && merge_part(folder, folder, &all, error, error_size);
    good = good &&
           write_rows(folder, MASU_SWEEP_RESULTS, ordered,
                      in_order(text, all.rows, all.count, ordered), error, error_size) &&
           (all.steady_count
                ? write_rows(folder, MASU_SWEEP_STEADY, all.steady, all.steady_count, error,
                             error_size)
                : rewrite(folder, MASU_SWEEP_STEADY, all.steady, 0, error, error_size));
    free(text);
    return good;
}

/* ladder_file.c: see ladder_file.h. */
#include "settings/ladder_file.h"

#include "settings/knobs.h"
#include "cli/cli.h"
#include "file_kind.h"
#include "image.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct place {
    const char *file;
    int rung; /* below 0: none */
    char *error;
    size_t error_size;
} place;

/* Text from the file may contain any characters except line ends. */
static bool wrong(const place *at, const char *format, ...) {
    char text[400], rung[24] = "";
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    if (at->rung >= 0) snprintf(rung, sizeof rung, "rungs[%d]: ", at->rung);
    snprintf(at->error, at->error_size, "%s: %s%s", at->file, rung, text);
    masu_cli_plain(at->error);
    return false;
}

/* The strings are used in C comments and constants: characters that could end these, or start a
 * trigraph, become dots. */
static bool read_text(const place *at, const json_t *object, const char *key, char *out,
                      size_t size) {
    char is[80];
    const json_t *value = json_object_get(object, key);
    if (!json_is_string(value) || !json_string_length(value))
        return wrong(at, "%s: expected a string, found %s", key,
                     masu_json_given(value, is, sizeof is));
    snprintf(out, size, "%s", json_string_value(value));
    for (char *c = out; *c; c++) {
        if (*c < ' ' || *c == 127 || strchr("\"\\*?", *c)) *c = '.';
    }
    return true;
}

static bool read_number(const place *at, const json_t *object, const char *key, double low,
                        double high, double *out) {
    char is[80];
    const json_t *value = json_object_get(object, key);
    double v = json_number_value(value);
    if (json_is_number(value) && v >= low && v <= high) {
        *out = v;
        return true;
    }
    return wrong(at, "%s: expected a number from %.4g to %.4g, found %s", key, low, high,
                 masu_json_given(value, is, sizeof is));
}

/* Every key must be in the list, which ends with NULL. */
static bool known_keys(const place *at, const json_t *object, const char *const *keys) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)(uintptr_t)object, key, value) {
        const char *const *k = keys;
        while (*k && strcmp(*k, key)) k++;
        if (!*k) return wrong(at, "%.60s: unknown key", key);
    }
    return true;
}

static bool read_knobs(const place *at, const json_t *knobs, masu_rung *rung) {
    const char *key;
    json_t *value;
    char error[300], is[80];
    if (!json_is_object(knobs))
        return wrong(at, "knobs: expected an object, found %s",
                     masu_json_given(knobs, is, sizeof is));
    json_object_foreach((json_t *)(uintptr_t)knobs, key, value) {
        const masu_knob *k = masu_knob_find(key, strlen(key));
        if (!k) return wrong(at, "%.60s: unknown knob", key);
        if (!masu_knob_from_json(k, value, rung, error, sizeof error))
            return wrong(at, "%s: %s", k->name, error);
    }
    return true;
}

static bool read_rung(const place *at, const json_t *value, masu_ladder_file *out) {
    static const char *const keys[] = {"setting", "ratio", "wall_ms", "gpu_ms",
                                       "flip",    "rmse",  "step",    "knobs", NULL};
    int r = at->rung;
    char is[80];
    if (!json_is_object(value))
        return wrong(at, "expected an object, found %s", masu_json_given(value, is, sizeof is));
    out->rmses[r] = out->steps[r] = -1.0;
    if (!known_keys(at, value, keys) ||
        !read_text(at, value, "setting", out->settings[r], sizeof out->settings[r]) ||
        !read_number(at, value, "ratio", 1e-6, 1e6, &out->ratios[r]) ||
        !read_number(at, value, "flip", 0, 1, &out->flips[r]) ||
        (json_object_get(value, "rmse") &&
         !read_number(at, value, "rmse", 0, 255, &out->rmses[r])) ||
        (json_object_get(value, "step") &&
         !read_number(at, value, "step", 0, 255, &out->steps[r])) ||
        !read_knobs(at, json_object_get(value, "knobs"), &out->rungs[r])) {
        return false;
    }
    /* Compared as floats, as they will be stored. */
    if (r && !((float)out->ratios[r] < (float)out->ratios[r - 1])) {
        return wrong(at, "ratio: expected less than the previous rung, %.6g, found %.6g",
                     out->ratios[r - 1], out->ratios[r]);
    }
    return true;
}

static bool read_ladder(place *at, const json_t *root, masu_ladder_file *out) {
    static const char *const keys[] = {"scene", "hash",  "driver", "width", "height", "time",
                                       "clock", "error", "date",   "rungs", NULL};
    double width = 0, height = 0;
    char is[80];
    if (!json_is_object(root))
        return wrong(at, "expected an object, found %s", masu_json_given(root, is, sizeof is));
    const json_t *rungs = json_object_get(root, "rungs"), *error = json_object_get(root, "error");
    if (!known_keys(at, root, keys) ||
        !read_text(at, root, "scene", out->scene, sizeof out->scene) ||
        !read_text(at, root, "driver", out->driver, sizeof out->driver) ||
        !read_text(at, root, "clock", out->clock, sizeof out->clock) ||
        !read_number(at, root, "width", 1, 16384, &width) ||
        !read_number(at, root, "height", 1, 16384, &height)) {
        return false;
    }
    if (json_object_get(root, "date") &&
        !read_text(at, root, "date", out->date, sizeof out->date)) {
        return false;
    }
    if (!json_is_string(error) || strcmp(json_string_value(error), "flip") != 0)
        return wrong(at, "error: expected 'flip', found %s", masu_json_given(error, is, sizeof is));
    out->width = (uint32_t)width;
    out->height = (uint32_t)height;
    size_t n = json_array_size(rungs);
    if (!json_is_array(rungs) || !n || n > MASU_MAX_RUNGS) {
        return wrong(at, "rungs: expected an array of 1 to %u rungs, found %zu", MASU_MAX_RUNGS, n);
    }
    out->count = (uint32_t)n;
    for (size_t r = 0; r < n; r++) {
        at->rung = (int)r;
        if (!read_rung(at, json_array_get(rungs, r), out)) return false;
    }
    return true;
}

bool masu_ladder_parse(const char *name, const char *text, size_t bytes, masu_ladder_file *out,
                       char *error, size_t error_size) {
    place at = {name, -1, error, error_size};
    json_error_t where;
    memset(out, 0, sizeof *out);
    json_t *root = json_loadb(text, bytes, JSON_REJECT_DUPLICATES, &where);
    if (!root) return wrong(&at, "line %d: %s", where.line, where.text);
    bool good = read_ladder(&at, root, out);
    json_decref(root);
    return good;
}

bool masu_ladder_read(const char *path, masu_ladder_file *out, char *error, size_t error_size) {
    uint8_t *text = NULL;
    size_t bytes = 0;
    if (!masu_file_read(path, 1u << 20, &text, &bytes, error, error_size)) return false;
    bool good = masu_ladder_parse(path, (const char *)text, bytes, out, error, error_size);
    size_t used = good ? 0 : strlen(error);
    if (!good && used < error_size)
        snprintf(error + used, error_size - used, "%s",
                 masu_file_hint(path, text, bytes, MASU_FILE_LADDER));
    free(text);
    return good;
}

void masu_ladder_give(const masu_ladder_file *ladder, masu_desc *desc) {
    desc->rung_count = ladder->count;
    memset(desc->rungs, 0, sizeof desc->rungs);
    memset(desc->flips, 0, sizeof desc->flips);
    memset(desc->governor.costs, 0, sizeof desc->governor.costs);
    for (uint32_t r = 0; r < ladder->count; r++) {
        desc->rungs[r] = ladder->rungs[r];
        /* Measured without a governor, which would change the meaning of AUTO. */
        if (desc->rungs[r].temporal == MASU_AUTO) desc->rungs[r].temporal = MASU_OFF;
        desc->flips[r] = (float)ladder->flips[r];
        desc->governor.costs[r] = (float)ladder->ratios[r];
    }
}

/* against.c: see against.h. */
#include "bench/against.h"

#include "bench/sweep.h"
#include "image.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Keys that must be equal for two runs to be comparable. The driver may differ. */
static const char *const same_keys[] = {"hash",      "width", "height", "time",
                                        "positions", "rays",  "frames"};

/* Limits within which a rung counts as reproduced. */
static const double flip_within = 0.02, time_within = 0.15;

static bool fail(char *error, size_t size, const char *folder, const char *text) {
    snprintf(error, size, "%.2000s: %s", folder, text);
    return false;
}

static json_t *load(const char *folder, const char *name, char *error, size_t error_size) {
    char path[4096];
    bool regular = masu_sweep_path(folder, name, path) && masu_file_is_regular(path);
    json_t *root = regular ? json_load_file(path, 0, NULL) : NULL;
    if (json_is_object(root)) return root;
    json_decref(root);
    snprintf(error, error_size, "%.2000s: cannot read %s: expected a finished folder of masu bench",
             folder, name);
    return NULL;
}

/* The description of a folder. A folder of docs/report has no sweep.json (keep.sh); its ladder.json
 * has fewer keys. */
static json_t *about(const char *folder, bool *whole, char *error, size_t error_size) {
    json_t *sweep = load(folder, "sweep.json", error, error_size);
    *whole = sweep != NULL;
    return sweep ? sweep : load(folder, "ladder.json", NULL, 0);
}

bool masu_against_same(const char *here, const char *there, char *error, size_t error_size) {
    bool whole_a, whole_b = false;
    json_t *a = about(here, &whole_a, error, error_size);
    json_t *b = a ? about(there, &whole_b, error, error_size) : NULL;
    bool good = b != NULL;
    for (size_t i = 0; i < sizeof same_keys / sizeof *same_keys && good; i++) {
        const json_t *of_a = json_object_get(a, same_keys[i]),
                     *of_b = json_object_get(b, same_keys[i]);
        if (json_equal(of_a, of_b) || (!of_a && !whole_a) || (!of_b && !whole_b)) continue;
        snprintf(error, error_size, "%.2000s: \"%s\" in %s differs from %.2000s", there,
                 same_keys[i], whole_b ? "sweep.json" : "ladder.json", here);
        good = false;
    }
    json_decref(a);
    json_decref(b);
    return good;
}

double masu_against_off(double here, double there) {
    if (!(here > 0.0 || here < 0.0) && !(there > 0.0 || there < 0.0)) return 0.0;
    return here / there - 1.0;
}

static bool stamped(const json_t *ladder) {
    const char *clock = json_string_value(json_object_get(ladder, "clock"));
    return clock && !strcmp(clock, "timestamps");
}

static void compare(masu_against *a, const masu_row *here, const masu_row *there, uint32_t i) {
    masu_against_rung *r = &a->rungs[i];
    r->here = here;
    r->there = there;
    a->missing += !here || !there;
    if (!here || !there) return;
    const masu_row *rows[2] = {here, there};
    for (int k = 0; k < 2; k++) {
        r->flip[k] = masu_row_error(rows[k]);
        r->ratio[k] = a->by_timestamps ? rows[k]->gpu_ratio : rows[k]->ratio;
    }
    r->flip_off = masu_against_off(r->flip[0], r->flip[1]);
    r->time_off = masu_against_off(r->ratio[0], r->ratio[1]);
    if (a->worst_flip == a->count || !(fabs(r->flip_off) <= fabs(a->rungs[a->worst_flip].flip_off)))
        a->worst_flip = i;
    if (a->worst_time == a->count || !(fabs(r->time_off) <= fabs(a->rungs[a->worst_time].time_off)))
        a->worst_time = i;
}

static bool compare_rungs(const json_t *ladder, const char *here, const char *there,
                          masu_against *out, char *error, size_t error_size) {
    uint32_t counts[2] = {0, 0};
    const json_t *rungs = json_object_get(ladder, "rungs");
    masu_row *a = masu_sweep_rows(here, &counts[0], error, error_size);
    masu_row *b = a ? masu_sweep_rows(there, &counts[1], error, error_size) : NULL;
    bool good = b != NULL;
    size_t count = json_array_size(rungs);
    if (good && (!count || count > MASU_MAX_RUNGS))
        good = fail(error, error_size, here, "ladder.json has no rungs or too many");
    out->count = out->worst_flip = out->worst_time = good ? (uint32_t)count : 0;
    for (uint32_t i = 0; i < out->count && good; i++) {
        const char *id = json_string_value(json_object_get(json_array_get(rungs, i), "setting"));
        if (!id) {
            good = fail(error, error_size, here, "a rung of ladder.json has no setting");
            break;
        }
        snprintf(out->rungs[i].setting, sizeof out->rungs[i].setting, "%s", id);
        compare(out, masu_rows_find(a, counts[0], id), masu_rows_find(b, counts[1], id), i);
    }
    free(a);
    free(b);
    return good;
}

bool masu_against_compare(const char *here, const char *there, masu_against *out, char *error,
                          size_t error_size) {
    memset(out, 0, sizeof *out);
    if (!masu_against_same(here, there, error, error_size)) return false;
    json_t *a = load(here, "ladder.json", error, error_size);
    json_t *b = a ? load(there, "ladder.json", error, error_size) : NULL;
    out->by_timestamps = stamped(a) && stamped(b);
    bool good = b && compare_rungs(a, here, there, out, error, error_size);
    json_decref(a);
    json_decref(b);
    return good;
}

/* ---- Printing -------------------------------------------------------------------------------- */

static int print_csv(FILE *f, const masu_against *a) {
    int n = fprintf(f, "rung,setting,flip_here,flip_there,flip_off,ratio_here,ratio_there,"
                       "ratio_off\n");
    for (uint32_t i = 0; i < a->count && n >= 0; i++) {
        const masu_against_rung *r = &a->rungs[i];
        if (!r->here || !r->there) {
            n = fprintf(f, "%u,%s,nan,nan,nan,nan,nan,nan\n", i, r->setting);
            continue;
        }
        n = fprintf(f, "%u,%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", i, r->setting, r->flip[0],
                    r->flip[1], r->flip_off, r->ratio[0], r->ratio[1], r->time_off);
    }
    return n;
}

static int print_rung(FILE *f, const masu_against_rung *r, uint32_t i) {
    if (!r->here || !r->there)
        return fprintf(f, "%4u  no row %s  %s\n", i, r->here ? "there" : "here", r->setting);
    return fprintf(f, "%4u  %10.4f %8.4f %+7.2f %%  %10.3f %8.3f %+7.2f %%  %s\n", i, r->flip[0],
                   r->flip[1], 100.0 * r->flip_off, r->ratio[0], r->ratio[1], 100.0 * r->time_off,
                   r->setting);
}

int masu_against_print(FILE *f, const masu_against *a, bool csv) {
    if (csv) return print_csv(f, a);
    uint32_t within = 0;
    int n = fprintf(f,
                    "rung   FLIP here    there     change   time here    there     change  "
                    "setting (times by %s)\n",
                    a->by_timestamps ? "timestamps" : "the wall clock");
    for (uint32_t i = 0; i < a->count && n >= 0; i++) {
        const masu_against_rung *r = &a->rungs[i];
        within += r->here && r->there && fabs(r->flip_off) <= flip_within &&
                  fabs(r->time_off) <= time_within;
        n = print_rung(f, r, i);
    }
    if (n >= 0 && a->missing < a->count) {
        n = fprintf(f, "worst: FLIP %+.2f %% (rung %u), time %+.2f %% (rung %u)\n",
                    100.0 * a->rungs[a->worst_flip].flip_off, a->worst_flip,
                    100.0 * a->rungs[a->worst_time].time_off, a->worst_time);
    }
    return n < 0 ? n
                 : fprintf(f,
                           "%u of %u rungs within %.0f %% of error and %.0f %% of time, %u "
                           "without a row\n",
                           within, a->count, 100 * flip_within, 100 * time_within, a->missing);
}

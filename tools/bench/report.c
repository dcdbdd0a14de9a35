/* report.c: see report.h. page.c: what its page shares with the index. */
#include "bench/report.h"

#include "settings/ladder.h"
#include "bench/costs.h"
#include "bench/machine.h"
#include "bench/page.h"
#include "measure/picture.h"
#include "bench/plot.h"
#include "bench/sweep.h"
#include "bench/sweep_files.h"
#include "cli/markup.h"
#include "image.h"
#include "metric/flip.h"
#include "metric/image.h"
#include "settings/ladder_file.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct report {
    const char *folder;
    masu_report_result *out;
    json_t *sweep; /* sweep.json */
    masu_row *rows, *steady; /* of both files; only of steady.csv */
    uint32_t count, rung_count, front_count, steady_count;
    double *ratios; /* in the clock of the ladder */
    masu_ladder_point *points;
    uint32_t *front, *rungs;
    /* Mean difference of the static image from the previous rung, of 255; NAN: unknown. */
    double steps[MASU_MAX_RUNGS];
    VkExtent2D size;
    FILE *page;
    size_t image_bytes; /* at most, of each image in the page */
    char *error;
    size_t error_size;
} report;

static bool failed(report *r, const char *text) {
    snprintf(r->error, r->error_size, "%.2000s: %s", r->folder, text);
    return false;
}

/* ---- Reading --------------------------------------------------------------------------------- */

static double number_of(const report *r, const char *key) {
    return json_number_value(json_object_get(r->sweep, key));
}

static const char *text_of(const json_t *from, const char *key) {
    const char *text = json_string_value(json_object_get(from, key));
    return text ? text : "";
}

static const json_t *setting_of(const report *r, const char *id) {
    json_t *one;
    size_t i;
    json_array_foreach(json_object_get(r->sweep, "settings"), i, one) {
        if (!strcmp(text_of(one, "setting"), id)) return one;
    }
    return NULL;
}

/* 0 if the value is not a valid width or height. */
static uint32_t side_of(const report *r, const char *key) {
    double side = number_of(r, key);
    return side >= 1.0 && side <= MASU_IMAGE_SIDE_MAX ? (uint32_t)side : 0;
}

/* Drops rows that sweep.json does not list: their knobs are unknown. */
static bool read_all(report *r) {
    char path[4096];
    uint32_t kept = 0;
    if (!masu_sweep_path(r->folder, "sweep.json", path)) return failed(r, "the path is too long");
    r->sweep = masu_file_is_regular(path) ? json_load_file(path, 0, NULL) : NULL;
    if (!r->sweep) return failed(r, "cannot read sweep.json");
    r->rows = masu_sweep_rows(r->folder, &r->count, r->error, r->error_size);
    if (!r->rows) return false;
    r->steady = masu_sweep_steady_rows(r->folder, &r->steady_count, r->error, r->error_size);
    if (!r->steady) return false;
    for (uint32_t i = 0; i < r->count; i++) {
        if (setting_of(r, r->rows[i].setting)) r->rows[kept++] = r->rows[i];
    }
    r->count = kept;
    r->size = (VkExtent2D){side_of(r, "width"), side_of(r, "height")};
    r->out->rows = kept;
    r->out->settings = (uint32_t)json_array_size(json_object_get(r->sweep, "settings"));
    uint64_t pixels = (uint64_t)r->size.width * r->size.height;
    if (!kept) return failed(r, "no setting is measured");
    return (pixels && pixels <= MASU_IMAGE_PIXELS_MAX) || failed(r, "sweep.json has no size");
}

static const char *clock_of(const masu_report_result *result) {
    return result->by_costs ? "computed costs" : result->by_timestamps ? "timestamps" : "wall";
}

static double least_ratio(const report *r, const masu_row *row) {
    return r->out->by_timestamps ? row->gpu_least_ratio : row->least_ratio;
}

/* Flicker is an error that a single image does not show: such a setting cannot be a rung. */
static bool flickers(const report *r, const masu_row *row) {
    const masu_row *base = masu_rows_find(r->rows, r->count, "base");
    return row->flicker > MASU_LADDER_FLICKER + (base ? base->flicker : 0.0);
}

static bool load_rest(const report *r, uint32_t row, uint8_t *out) {
    static const char *const suffixes[] = {MASU_SWEEP_REST, ""};
    char path[4096], error[4096];
    for (int i = 0; i < 2; i++) {
        /* Without reflections and temporal passes the static image equals the image in motion. */
        if (i && r->rows[row].rest_flip != r->rows[row].flip) return false;
        if (masu_sweep_picture(r->folder, r->rows[row].setting, suffixes[i], path) &&
            masu_file_exists(path))
            return masu_picture_load(path, r->size, out, error, sizeof error);
    }
    return false;
}

/* Drops rungs that differ too much from the previous one. Folders without images keep all rungs. */
static bool limit_steps(report *r) {
    const size_t bytes = 4 * (size_t)r->size.width * r->size.height;
    uint8_t *before = malloc(bytes), *shown = malloc(bytes);
    uint32_t kept = 0;
    bool good = (before && shown) || failed(r, "out of memory"), known = false;
    for (uint32_t i = 0; i < r->rung_count && good; i++) {
        const bool there = load_rest(r, r->rungs[i], shown);
        const double step =
            i && known && there
                ? masu_metric_difference(shown, before, r->size.width, r->size.height)
                : (double)NAN;
        if (step > MASU_LADDER_STEP) continue;
        r->steps[kept] = step;
        r->rungs[kept++] = r->rungs[i];
        known = there;
        if (there) memcpy(before, shown, bytes);
    }
    r->rung_count = kept;
    free(before);
    free(shown);
    return good;
}

static bool find_rungs(report *r) {
    r->front_count = masu_ladder_front(r->points, r->count, r->front);
    r->rung_count = masu_ladder_rungs(r->points, r->count, MASU_LADDER_APART, MASU_LADDER_BETTER,
                                      MASU_MAX_RUNGS, r->rungs);
    return limit_steps(r);
}

/* If costs on classes of GPUs exist, they select the settings. Their geometric mean over the
 * classes, relative to the base's, replaces the measured time. */
static bool go_by_costs(report *r) {
    const uint32_t n = MASU_COSTS_CLASSES;
    double *costs = calloc(r->count, sizeof *costs * n);
    bool good = costs || failed(r, "out of memory");
    good = good && masu_costs_read(r->folder, r->rows, r->count, costs, &r->out->by_costs, r->error,
                                   r->error_size);
    const masu_row *base = masu_rows_find(r->rows, r->count, "base");
    const double *of_base = good && base ? &costs[n * (size_t)(base - r->rows)] : NULL;
    if (good && r->out->by_costs && (!of_base || !(of_base[0] > 0.0)))
        good = failed(r, MASU_COSTS " has no costs of the base");
    for (uint32_t i = 0; i < r->count && good && r->out->by_costs; i++) {
        double sum = 0.0;
        for (uint32_t c = 0; c < n; c++) sum += log(costs[n * i + c] / of_base[c]);
        r->ratios[i] = exp(sum / n);
        if (r->points[i].time > 0.0) r->points[i].time = r->ratios[i];
    }
    if (good && r->out->by_costs) masu_ladder_exclude(r->points, r->count, costs, n);
    free(costs);
    return good;
}

/* Timestamps are used if they agree with the wall clock in all rows; times of two clocks are never
 * mixed. */
static bool find_ladder(report *r) {
    r->points = calloc(r->count, sizeof *r->points);
    r->ratios = calloc(r->count, sizeof *r->ratios);
    r->front = calloc(r->count, sizeof *r->front);
    r->rungs = calloc(r->count, sizeof *r->rungs);
    if (!r->points || !r->ratios || !r->front || !r->rungs) return failed(r, "out of memory");
    bool stamps = true;
    for (uint32_t i = 0; i < r->count; i++) stamps = stamps && r->rows[i].plausible >= 0.9;
    for (uint32_t i = 0; i < r->count; i++) {
        r->ratios[i] = stamps ? r->rows[i].gpu_ratio : r->rows[i].ratio;
        r->points[i] = (masu_ladder_point){r->ratios[i], masu_row_error(&r->rows[i])};
        /* Disabled culling is faster only by measurement noise. */
        const json_t *same = json_object_get(setting_of(r, r->rows[i].setting), "same_picture");
        if (json_is_true(same) || flickers(r, &r->rows[i])) r->points[i].time = 0.0;
    }
    r->out->by_timestamps = stamps;
    for (uint32_t i = 0; i < r->count; i++)
        r->out->unsteady += !(fabs(least_ratio(r, &r->rows[i]) / r->ratios[i] - 1.0) <= 0.1);
    if (!go_by_costs(r) || !find_rungs(r)) return false;
    r->out->rungs = r->rung_count;
    return true;
}

/* ---- ladder.json ----------------------------------------------------------------------------- */

static bool write_ladder(report *r) {
    char path[4096];
    json_t *rungs = json_array();
    for (uint32_t i = 0; i < r->rung_count; i++) {
        const masu_row *row = &r->rows[r->rungs[i]];
        json_t *knobs = json_object_get(setting_of(r, row->setting), "knobs");
        json_t *rung =
            json_pack("{s:s, s:f, s:f, s:f, s:f, s:f, s:O}", "setting", row->setting, "ratio",
                      r->ratios[r->rungs[i]], "wall_ms", row->wall_min, "gpu_ms", row->gpu_min,
                      "flip", masu_row_error(row), "rmse", row->rmse, "knobs", knobs);
        if (isfinite(r->steps[i])) json_object_set_new(rung, "step", json_real(r->steps[i]));
        json_array_append_new(rungs, rung);
    }
    char date[32] = "unknown"; /* of the last run that added rows */
    masu_machine machine;
    for (uint32_t i = 0; masu_machine_read(r->folder, i, &machine); i++)
        snprintf(date, sizeof date, "%.10s", machine.date);
    json_t *root = json_pack("{s:s, s:s, s:s, s:s, s:i, s:i, s:f, s:s, s:s, s:o}", "date", date,
                             "scene", text_of(r->sweep, "scene"), "hash", text_of(r->sweep, "hash"),
                             "driver", text_of(r->sweep, "driver"), "width", (int)r->size.width,
                             "height", (int)r->size.height, "time", number_of(r, "time"), "clock",
                             clock_of(r->out), "error", "flip", "rungs", rungs);
    char *text = root ? json_dumps(root, JSON_INDENT(2)) : NULL;
    bool good = text && masu_sweep_path(r->folder, "ladder.json", path);
    if (!good) failed(r, "out of memory");
    good = good && masu_file_write(path, text, strlen(text), r->error, r->error_size);
    free(text);
    json_decref(root);
    return good;
}

/* ---- The page -------------------------------------------------------------------------------- */

static bool put_plot(report *r, const char *path, const char *text) {
    uint8_t *bytes = NULL;
    size_t count = 0;
    if (!masu_file_read(path, MASU_IMAGE_FILE_BYTES_MAX, &bytes, &count, r->error, r->error_size))
        return false;
    masu_markup(r->page, "<p class=\"wide\"><img class=\"plot\" alt=\"%s\" "
                         "src=\"data:image/svg+xml;base64,", text);
    masu_page_base64(r->page, bytes, count);
    fputs("\"/></p>\n", r->page);
    free(bytes);
    return true;
}

static bool put_image(report *r, const uint8_t *rgba, const char *kind, const char *text) {
    return masu_page_image(r->page, rgba, r->size.width, r->size.height, r->image_bytes, kind,
                           text) ||
           failed(r, "out of memory");
}

/* Black, violet, red, orange, white, by the square root, since most errors are below 0.1. */
static void heat(float value, uint8_t rgba[4]) {
    static const float ramp[5][3] = {
        {0, 0, 0}, {70, 20, 120}, {190, 45, 90}, {250, 150, 40}, {255, 250, 220}};
    float at = 4.0f * sqrtf(fminf(fmaxf(value, 0.0f), 1.0f));
    int low = at < 3.0f ? (int)at : 3;
    for (int k = 0; k < 3; k++) {
        float mixed = ramp[low][k] + (at - (float)low) * (ramp[low + 1][k] - ramp[low][k]);
        rgba[k] = (uint8_t)(mixed + 0.5f);
    }
    rgba[3] = 255;
}

/* Image and FLIP map of a rung. */
static bool put_rung(report *r, uint32_t rung, const uint8_t *truth, uint8_t *shown, float *map) {
    const char *setting = r->rows[r->rungs[rung]].setting;
    const size_t pixels = (size_t)r->size.width * r->size.height;
    char path[4096], text[MASU_SETTING_ID + 32];
    masu_flip flip;
    snprintf(text, sizeof text, "rung %u: %s", rung, setting);
    if (!masu_sweep_picture(r->folder, setting, "", path))
        return failed(r, "the path is too long");
    if (!masu_picture_load(path, r->size, shown, r->error, r->error_size) ||
        !put_image(r, shown, "shot", text))
        return false;
    if (!masu_metric_flip(truth, shown, r->size.width, r->size.height, 0, map, &flip))
        return failed(r, "out of memory");
    for (size_t i = 0; i < pixels; i++) heat(map[i], shown + 4 * i);
    snprintf(text, sizeof text, "map of FLIP of rung %u", rung);
    return put_image(r, shown, "map", text);
}

/* Machine and date: one line for each run that added rows. */
static void put_machines(report *r) {
    masu_machine m;
    fputs("<p>", r->page);
    for (uint32_t i = 0; masu_machine_read(r->folder, i, &m); i++) {
        fputs(i ? "<br/>\n" : "", r->page);
        masu_markup(r->page, "%s: %s, %u thread%s; %s; Masu %s", m.date, m.cpu, m.threads,
                    m.threads == 1 ? "" : "s", m.driver, m.masu);
    }
    fputs("</p>\n", r->page);
}

/* Explains the tables. */
static void put_note(report *r) {
    FILE *f = r->page;
    masu_markup(
        f,
        "<ul>\n<li>The <b>base</b> setting has all knobs at their defaults, at full size. The name "
        "of a setting lists the knobs that differ. Ratios are times divided by the time of the "
        "base.</li>\n");
    masu_markup(
        f,
        "<li>The <b>ground truth</b> is the average of %.0f full-size frames with jittered samples "
        "and the most exact settings (masu render --truth). The image of a setting is the last of "
        "at most %.0f frames in motion.</li>\n",
        number_of(r, "positions"), number_of(r, "frames"));
    fputs(
        "<li><b>FLIP</b> is the perceived difference from the ground truth at 67 pixels per "
        "degree: 0 is "
        "none, 1 is the maximum. The table has its mean and 99th percentile in motion along the "
        "path, its "
        "mean with a stationary camera, and its mean for frames an eighth of a second apart. The "
        "<b>error</b>, which orders the ladder, is the mean of FLIP in motion and stationary, if "
        "both are "
        "measured. HDR-FLIP is the maximum over all exposures, before the tone curve.</li>\n"
        "<li><b>RMSE</b> and flicker are out of 255. Flicker is the mean difference of successive "
        "frames with a stationary camera.</li>\n<li><b>hit/miss</b> and <b>depth</b> compare "
        "surfaces with ",
        f);
    masu_markup(r->page, "%s", text_of(r->sweep, "depth"));
    fputs(" at the same size: pixels where only one of the two shows the sky, and the distance of "
          "all other "
          "surfaces in pixel widths at that depth. <b>relMSE</b> compares pixels with traced "
          "reflections "
          "with many rays. A dash: the setting has no such value.</li>\n",
          f);
    masu_markup(
        f,
        "<li><b>Times</b>: %.0f runs of each setting, interleaved with the base; the first round "
        "is dropped. The ratio is the median of the ratios per round; the ratio of minima is next "
        "to "
        "it. If the two differ a lot, the machine was busy: they differ by more than 10 %% in %u "
        "of %u rows.</li>\n",
        number_of(r, "runs"), r->out->unsteady, r->out->rows);
    if (r->steady_count) {
        masu_markup(
            f,
            "<li>The best of many noisy times is biased. So %u settings, including the rungs, were "
            "timed again separately and for longer (steady.csv). Their rows show these "
            "times.</li>\n",
            r->steady_count);
    }
    masu_markup(f, "<li>The ladder uses %s.</li>\n",
                r->out->by_costs ? "the mean of the costs that are computed for classes of GPUs "
                                   "(costs.csv); so does every "
                                   "ratio here but that of minima"
                : r->out->by_timestamps ? "the device's timestamps, which agree with the wall clock"
                                        : "the wall clock: some timestamps disagree with it");
    fputs("<li><b>How to read it</b>: find the rung with an acceptable error, and the time that it "
          "saves; then "
          "the technique that saves the most time for the least FLIP. Differences below 0.001 are "
          "noise if reflections are traced.</li>\n</ul>\n",
          f);
}

static void put_head(report *r) {
    FILE *f = r->page;
    const char *scene = text_of(r->sweep, "scene");
    const masu_row *rungs[MASU_MAX_RUNGS];
    for (uint32_t i = 0; i < r->rung_count; i++) rungs[i] = &r->rows[r->rungs[i]];
    masu_page_begin(f, "Error against run time: ", scene);
    masu_page_verdict(f, rungs, r->rung_count);
    masu_markup(f, "<p>%ux%u at %.6g s; %s; scene %s.</p>\n", r->size.width, r->size.height,
                number_of(r, "time"), text_of(r->sweep, "driver"), text_of(r->sweep, "hash"));
    put_machines(r);
    if (r->out->rows < r->out->settings)
        masu_markup(f, "<p><b>%u of %u settings are measured.</b></p>\n", r->out->rows,
                r->out->settings);
}

/* Columns of the long table; `brief`: also in the short one. */
static const struct {
    const char *name, *format;
    bool brief;
} columns[] = {{"ratio", "%.3f", true},
               {"error", "%.4f", true},
               {"FLIP", "%.4f", true},
               {"p99", "%.4f", true},
               {"stationary", "%.4f", true},
               {"fast", "%.4f", true},
               {"HDR-FLIP", "%.4f", false},
               {"RMSE", "%.2f", true},
               {"PSNR", "%.2f", true},
               {"SSIM", "%.4f", true},
               {"flicker", "%.3f", true},
               {"hit/miss %", "%.3f", false},
               {"depth px", "%.4f", false},
               {"p99", "%.4f", false},
               {"relMSE", "%.4f", false},
               {"ratio of minima", "%.3f", false},
               {"wall ms", "%.2f", true},
               {"p50", "%.2f", false},
               {"p95", "%.2f", false},
               {"p99", "%.2f", false},
               {"gpu ms", "%.2f", true},
               {"MiB", "%.1f", true}};

enum { COLUMNS = sizeof columns / sizeof *columns };

static void put_columns(FILE *f, bool brief) {
    fputs("<tr><th>setting</th><th>render size</th>", f);
    for (size_t k = 0; k < COLUMNS; k++) {
        if (!brief || columns[k].brief) masu_markup(f, "<th>%s</th>", columns[k].name);
    }
    fputs("</tr>\n", f);
}

/* NaN is printed as a dash. */
static void put_cell(FILE *f, const char *format, double value) {
    char text[64];
    if (isnan(value)) {
        snprintf(text, sizeof text, "-");
    } else {
        snprintf(text, sizeof text, format, value);
    }
    masu_markup(f, "<td>%s</td>", text);
}

static void put_row(report *r, uint32_t i, const char *label, bool brief, bool marked) {
    const masu_row *row = &r->rows[i];
    FILE *f = r->page;
    fputs(marked ? "<tr class=\"rung\">" : "<tr>", f);
    masu_markup(f, "<td>%s%s</td><td>%.0fx%.0f</td>", label, row->setting, row->render_width,
                row->render_height);
    const double values[COLUMNS] = {r->ratios[i],
                                    masu_row_error(row),
                                    row->flip,
                                    row->flip_p99,
                                    row->rest_flip,
                                    row->fast_flip,
                                    row->hdr_flip,
                                    row->rmse,
                                    row->psnr_db,
                                    row->ssim,
                                    row->flicker,
                                    row->hitmiss_pct,
                                    row->depth_mean_px,
                                    row->depth_p99_px,
                                    row->specular_relmse,
                                    least_ratio(r, row),
                                    row->wall_min,
                                    row->wall_p50,
                                    row->wall_p95,
                                    row->wall_p99,
                                    row->gpu_min,
                                    row->device_bytes / 1048576.0};
    for (size_t k = 0; k < COLUMNS; k++) {
        bool doubted = !strcmp(columns[k].name, "gpu ms") && row->plausible < 0.9;
        if (!brief || columns[k].brief)
            put_cell(f, doubted ? "%.2f (?)" : columns[k].format, values[k]);
    }
    fputs("</tr>\n", f);
}

static void put_ladder(report *r) {
    FILE *f = r->page;
    fputs("<h2>The ladder</h2>\n<p>Rungs from the Pareto front in falling quality; neighbours "
          "differ in time by at least 4 %, and with a stationary camera by at most 3 of 255 on "
          "average. "
          "ladder.json has all their knobs; the table of all settings has all columns.</p>\n<div "
          "class=\"wide\"><table class=\"sort\">\n",
          f);
    put_columns(f, true);
    for (uint32_t i = 0; i < r->rung_count; i++) {
        char label[16];
        snprintf(label, sizeof label, "%u: ", i);
        put_row(r, r->rungs[i], label, true, false);
    }
    fputs("</table></div>\n", f);
}

static bool put_plots(report *r) {
    static const char *const names[][2] = {{"plots/front.svg", "error against time, all settings"},
                                           {"plots/techniques.svg", "effect of each technique"}};
    char path[4096];
    for (size_t i = 0; i < 2 && r->out->plots; i++) {
        if (!masu_sweep_path(r->folder, names[i][0], path) || !put_plot(r, path, names[i][1]))
            return false;
    }
    return true;
}

/* The effect of one knob, compared with the setting that differs only by this knob. */
static void put_techniques(report *r) {
    FILE *f = r->page;
    fputs("<h2>Techniques</h2>\n<p>Every technique compared with the setting without it: the ratio "
          "of their "
          "times, and the change in error (FLIP), RMSE and device memory.</p>\n"
          "<div class=\"wide\"><table "
          "class=\"sort\">\n<tr><th>technique</th><th>from</th><th>time</th><th>error</th>"
          "<th>RMSE</th><th>KiB</th></tr>\n",
          f);
    for (uint32_t i = 0; i < r->count; i++) {
        const masu_row *row = &r->rows[i], *parent = masu_rows_find(r->rows, r->count, row->parent);
        if (!parent || parent == row) continue;
        masu_markup(f, "<tr><td>%s</td><td>%s</td>", row->setting, row->parent);
        masu_markup(f, "<td>%.3f</td><td>%+.4f</td><td>%+.2f</td><td>%+.0f</td></tr>\n",
                    r->ratios[i] / r->ratios[parent - r->rows],
                    masu_row_error(row) - masu_row_error(parent), row->rmse - parent->rmse,
                    (row->device_bytes - parent->device_bytes) / 1024.0);
    }
    fputs("</table></div>\n", f);
}

static bool is_rung(const report *r, uint32_t row) {
    for (uint32_t i = 0; i < r->rung_count; i++) {
        if (r->rungs[i] == row) return true;
    }
    return false;
}

static void put_all(report *r) {
    json_t *one;
    size_t k;
    fputs("<h2>All settings</h2>\n<div class=\"wide\"><table class=\"sort\">\n", r->page);
    put_columns(r->page, false);
    for (uint32_t i = 0; i < r->count; i++) put_row(r, i, "", false, is_rung(r, i));
    fputs("</table></div>\n<h2>Skipped settings</h2>\n<div class=\"wide\"><table class=\"sort\">\n"
          "<tr><th>setting</th><th class=\"text\">reason</th></tr>\n",
          r->page);
    json_array_foreach(json_object_get(r->sweep, "dropped"), k, one) {
        masu_markup(r->page, "<tr><td>%s</td><td class=\"text\">%s</td></tr>\n",
                    text_of(one, "setting"), text_of(one, "why"));
    }
    fputs("</table></div>\n", r->page);
}

static bool put_pictures(report *r) {
    const size_t pixels = (size_t)r->size.width * r->size.height;
    uint8_t *truth = malloc(4 * pixels), *shown = malloc(4 * pixels);
    float *map = malloc(sizeof *map * pixels);
    char path[4096];
    fputs("<h2>Images</h2>\n<p>JPEG; pictures/ has the images without loss.</p>\n"
          "<h3>Ground truth</h3>\n<p class=\"pair\">",
          r->page);
    bool good = (truth && shown && map) || failed(r, "out of memory");
    good = good && masu_sweep_path(r->folder, "truth.png", path) &&
           masu_picture_load(path, r->size, truth, r->error, r->error_size) &&
           put_image(r, truth, "shot", "ground truth");
    fputs("</p>\n", r->page);
    for (uint32_t i = 0; i < r->rung_count && good; i++) {
        const masu_row *row = &r->rows[r->rungs[i]];
        masu_markup(r->page, "<h3>Rung %u: %s", i, row->setting);
        masu_markup(r->page,
                "</h3>\n<p>%.3f of the base's time, FLIP %.4f; beside it the map of FLIP: "
                "violet 0.06, red 0.25, orange 0.56, white 1."
                "</p>\n<p class=\"pair\">",
                r->ratios[r->rungs[i]], row->flip);
        good = put_rung(r, i, truth, shown, map);
        fputs("</p>\n", r->page);
    }
    free(truth);
    free(shown);
    free(map);
    return good;
}

/* The page with images of at most r->image_bytes each; free() it. NULL: r->error says why. */
static char *make_page(report *r, size_t *bytes) {
    char *text = NULL;
    *bytes = 0;
    r->page = open_memstream(&text, bytes);
    if (!r->page) {
        failed(r, "out of memory");
        return NULL;
    }
    put_head(r);
    masu_page_slider(r->page);
    put_ladder(r);
    bool good = put_plots(r);
    put_techniques(r);
    good = good && put_pictures(r);
    put_all(r);
    fputs("<h2>Explanations</h2>\n", r->page);
    put_note(r);
    masu_page_end(r->page);
    if (fclose(r->page) && good) good = failed(r, "out of memory");
    if (good) return text;
    free(text);
    return NULL;
}

/* Three quarters of the page are for images at first. More text or larger plots halve the
 * images. */
static bool write_page(report *r) {
    char path[4096];
    if (!masu_sweep_path(r->folder, "index.html", path)) return failed(r, "the path is too long");
    r->image_bytes = MASU_PAGE_BYTES * 9 / 16 / (1 + 2 * r->rung_count); /* base64: 3/4 of them */
    for (; r->image_bytes >= 1024; r->image_bytes /= 2) {
        size_t bytes;
        char *text = make_page(r, &bytes);
        if (!text) return false;
        const bool fits = bytes <= MASU_PAGE_BYTES;
        const bool good = fits && masu_file_write(path, text, bytes, r->error, r->error_size);
        free(text);
        if (fits) return good;
    }
    return failed(r, "the text of the page exceeds its limit of 1500000 bytes");
}

static void release(report *r) {
    json_decref(r->sweep);
    free(r->rows);
    free(r->steady);
    free(r->ratios);
    free(r->points);
    free(r->front);
    free(r->rungs);
}

/* Reads the rungs of ladder.json for a folder without sweep.json (docs/report). */
static bool kept_rungs(const char *folder, masu_setting_list *out, char *error, size_t error_size) {
    char path[4096];
    masu_ladder_file ladder;
    if (!masu_sweep_path(folder, "ladder.json", path) ||
        !masu_ladder_read(path, &ladder, error, error_size))
        return false;
    out->count = ladder.count;
    for (uint32_t i = 0; i < ladder.count; i++)
        memcpy(out->id[i], ladder.settings[i], MASU_SETTING_ID);
    return true;
}

bool masu_report_rungs(const char *folder, masu_setting_list *out, char *error, size_t error_size) {
    char path[4096];
    masu_report_result result = {0};
    report r = {.folder = folder, .out = &result, .error = error, .error_size = error_size};
    memset(out, 0, sizeof *out);
    if (masu_sweep_path(folder, "sweep.json", path) && access(path, F_OK) &&
        masu_sweep_path(folder, "ladder.json", path) && !access(path, F_OK))
        return kept_rungs(folder, out, error, error_size);
    bool good = read_all(&r) && find_ladder(&r);
    for (uint32_t i = 0; i < r.rung_count && good; i++)
        memcpy(out->id[out->count++], r.rows[r.rungs[i]].setting, MASU_SETTING_ID);
    release(&r);
    return good;
}

/* Each round excludes the rungs that it has found; there are at most `count` rungs. */
static bool find_unsteady(report *r, masu_setting_list *out) {
    const uint32_t most = MASU_MAX_RUNGS - 1;
    for (;;) {
        uint32_t before = out->count;
        for (uint32_t i = 0; i < r->rung_count && out->count < most; i++) {
            const char *id = r->rows[r->rungs[i]].setting;
            if (!strcmp(id, "base") || masu_rows_find(r->steady, r->steady_count, id)) continue;
            memcpy(out->id[out->count++], id, MASU_SETTING_ID);
            r->points[r->rungs[i]].time = 0.0;
        }
        if (out->count == before) return true;
        if (!find_rungs(r)) return false;
    }
}

bool masu_report_unsteady(const char *folder, masu_setting_list *out, char *error,
                          size_t error_size) {
    masu_report_result result = {0};
    report r = {.folder = folder, .out = &result, .error = error, .error_size = error_size};
    memset(out, 0, sizeof *out);
    bool good = read_all(&r) && find_ladder(&r);
    good = good && (result.by_costs || find_unsteady(&r, out));
    release(&r);
    return good;
}

bool masu_report_write(const char *folder, masu_report_result *out, char *error,
                       size_t error_size) {
    report r = {.folder = folder, .out = out, .error = error, .error_size = error_size};
    memset(out, 0, sizeof *out);
    bool good = read_all(&r) && find_ladder(&r) && write_ladder(&r);
    if (good) {
        masu_plot plot = {.folder = folder,
                          .title = text_of(r.sweep, "scene"),
                          .clock = clock_of(out),
                          .rows = r.rows,
                          .ratios = r.ratios,
                          .row_count = r.count,
                          .rungs = r.rungs,
                          .front = r.front,
                          .rung_count = r.rung_count,
                          .front_count = r.front_count};
        good = masu_plot_draw(&plot, &out->plots, error, error_size) && write_page(&r);
    }
    release(&r);
    return good;
}

/* simulate.c: `masu-lab simulate`: runs the governor and the rules of other engines on simulated
 * GPUs, and prints tables, CSV and plots. Needs no device. */
#include "command/options.h"
#include "lab/simulate/record.h"
#include "lab/study/table.h"

#include "cli/gnuplot.h"
#include "lab/simulate/controllers.h"
#include "lab/simulate/trace.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define TRACES_MOST 8u
#define CONTROLLERS_MOST 8u

typedef struct options {
    const char *csv, *plots, *model, *controller;
    uint32_t seeds;
    masu_simulate_record record;
    uint32_t trace_count;
    sim_trace traces[TRACES_MOST];
} options;

/* Means over the seeds. */
typedef struct row {
    double over, changes, late, scale, settle;
    uint32_t unsettled; /* seeds for which it never settled */
    uint32_t invalid;
} row;

static row measure(const sim_model *p, const sim_controller *c, uint32_t seeds) {
    row out = {0};
    double n = seeds;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        sim_result r = sim_run(p, c, seed, NULL, NULL);
        out.over += r.over / n;
        out.changes += r.changes / n;
        out.late += r.late_changes / n;
        out.scale += r.mean_scale / n;
        if (r.settle < 0)
            out.unsettled++;
        else
            out.settle += r.settle;
        out.invalid += r.invalid;
    }
    if (out.unsettled < seeds) out.settle /= seeds - out.unsettled;
    return out;
}

/* ---- Plots ----------------------------------------------------------------------------------- */

/* Times above, scales below, one line per controller. All data are inline, so that gnuplot reads no
 * file. */
static void plot(FILE *to, const sim_model *p, const sim_controller *const *list,
                 uint32_t count) {
    static sim_frame frames[CONTROLLERS_MOST][SIM_FRAMES_MOST];
    for (uint32_t c = 0; c < count; c++) sim_run(p, list[c], 1, frames[c], NULL);
    char file[80], title[256];
    snprintf(file, sizeof file, "%s.svg", p->name);
    snprintf(title, sizeof title, "%s: %s", p->name, p->what);
    fprintf(to, "set output ");
    masu_gnuplot_quote(to, file);
    fprintf(to, "\nset multiplot layout 2,1 title ");
    masu_gnuplot_quote(to, title);
    fprintf(to, " noenhanced\n");
    for (uint32_t half = 0; half < 2; half++) {
        fprintf(to, "unset arrow\nset xrange [0:%" PRIu32 "]\n", p->frames);
        if (!half) {
            fprintf(to, "set arrow from graph 0, first %.3f to graph 1, first %.3f nohead dt 2\n",
                    sim_budget(p), sim_budget(p));
        }
        fprintf(to, "set ylabel \"%s\"\nset yrange [%s]\nplot ",
                half ? "scale" : "ms (dashed: budget)", half ? "0.35:1.05" : "0:*");
        for (uint32_t c = 0; c < count; c++) {
            uint32_t line = count - c; /* ours on top */
            fprintf(to, "'-' with lines lw %s lt %" PRIu32 " title ", line == 1 ? "2" : "0.7",
                    line);
            masu_gnuplot_quote(to, list[line - 1]->name);
            fprintf(to, " noenhanced%s", line > 1 ? ", " : "\n");
        }
        for (uint32_t c = 0; c < count; c++) {
            const sim_frame *of = frames[count - 1 - c];
            for (uint32_t f = 0; f < p->frames; f++)
                fprintf(to, "%" PRIu32 " %.3f\n", f, half ? of[f].scale : of[f].ms);
            fprintf(to, "e\n");
        }
    }
    fprintf(to, "unset multiplot\n");
}

typedef struct script {
    FILE *f; /* NULL: no plots requested */
    char *text;
    size_t bytes;
} script;

static bool open_script(const options *o, script *s) {
    if (mkdir(o->plots, 0777) && errno != EEXIST) {
        masu_cli_error("%s: cannot be made: %s", o->plots, strerror(errno));
        return false;
    }
    s->f = open_memstream(&s->text, &s->bytes);
    if (!s->f) return masu_cli_error("out of memory"), false;
    fprintf(s->f, "set terminal svg size 1000,560\nset key outside\nset xlabel 'frame'\n");
    return true;
}

static int draw_script(script *s, const options *o) {
    masu_gnuplot_end end = MASU_GNUPLOT_FAILED;
    if (!fclose(s->f)) end = masu_gnuplot_run(o->plots, s->text, s->bytes);
    free(s->text);
    if (end == MASU_GNUPLOT_MISSING)
        masu_cli_warn("no plots: there is no gnuplot (package gnuplot-nox)");
    return end == MASU_GNUPLOT_FAILED
               ? masu_cli_error("gnuplot could not write the plots to %s", o->plots)
               : MASU_CLI_OK;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static const masu_column columns[] = {
    {"model", NULL, "model", NULL},
    {"controller", NULL, "controller", NULL},
    {"frames", "%.0f", NULL, NULL},
    {"over_budget", "%.2f", "over", "%.1f"},
    {"changes", "%.2f", "changes", "%.1f"},
    {NULL, NULL, "late", "%.1f"},
    {"mean_scale", "%.4f", "scale", "%.4f"},
    {"settle_frames", NULL, "settle", NULL},
    {"late_changes", "%.2f", NULL, NULL},
    {"never_settled", "%.0f", NULL, NULL},
    {"invalid", "%.0f", NULL, NULL},
    {NULL, NULL, "", NULL},
    {NULL, NULL, NULL, NULL}};

static void add_row(masu_table *t, const sim_model *p, const char *name, const row *r,
                    uint32_t seeds) {
    char settle[32] = "never";
    if (r->unsettled < seeds) snprintf(settle, sizeof settle, "%.1f", r->settle);
    const double numbers[] = {p->frames, r->over, r->changes, r->late, r->scale};
    const double last[] = {r->late, r->unsettled, r->invalid};
    masu_table_text(t, p->name);
    masu_table_text(t, name);
    masu_table_numbers(t, numbers, sizeof numbers / sizeof *numbers);
    masu_table_text(t, settle);
    masu_table_numbers(t, last, sizeof last / sizeof *last);
    masu_table_text(t, r->unsettled && r->unsettled < seeds ? "(not always)" : "");
}

/* The table is printed model by model; the best constant scale is below each. */
static void run_model(const sim_model *p, const options *o, masu_table *t, FILE *plots) {
    const sim_controller *list[CONTROLLERS_MOST];
    uint32_t count = 0;
    for (uint32_t c = 0; c < sim_controller_count; c++) {
        if (o->controller && strcmp(o->controller, sim_controllers[c]->name) != 0) continue;
        list[count++] = sim_controllers[c];
        row r = measure(p, sim_controllers[c], o->seeds);
        add_row(t, p, sim_controllers[c]->name, &r, o->seeds);
    }
    if (!masu_cli_quiet()) {
        masu_table_print(t, stdout);
        printf("  oracle: %.4f\n", sim_oracle(p));
    }
    if (plots) plot(plots, p, list, count);
}

static int run_all(const options *o) {
    script plots = {0};
    masu_table t;
    if (o->plots && !open_script(o, &plots)) return MASU_CLI_FAILURE;
    masu_table_open(&t, columns, "");
    if (!masu_cli_quiet()) {
        printf("Means of %" PRIu32 " seeds. late: changes from %u frames after the event on.\n",
               o->seeds, SIM_SETTLED);
    }
    for (uint32_t i = 0; i < sim_model_count; i++) {
        if (!o->model || !strcmp(o->model, sim_models[i].name))
            run_model(&sim_models[i], o, &t, plots.f);
    }
    for (uint32_t i = 0; i < o->trace_count; i++) {
        sim_model p = sim_of_trace(&o->traces[i]);
        if (!o->model || !strcmp(o->model, p.name)) run_model(&p, o, &t, plots.f);
    }
    int code = plots.f ? draw_script(&plots, o) : MASU_CLI_OK;
    return masu_table_close(&t, o->csv) | code;
}

/* ---- Command line ---------------------------------------------------------------------------- */

static bool is_known(const options *o) {
    if (!o->model || sim_find(o->model)) return true;
    for (uint32_t i = 0; i < o->trace_count; i++) {
        if (!strcmp(o->model, o->traces[i].name)) return true;
    }
    return false;
}

static bool read_controller(masu_cli *cli, void *to) {
    const char *names[CONTROLLERS_MOST + 1] = {NULL};
    uint32_t controller = 0;
    for (uint32_t c = 0; c < sim_controller_count; c++) names[c] = sim_controllers[c]->name;
    if (!masu_cli_choice(cli, names, &controller)) return false;
    ((options *)to)->controller = names[controller];
    return true;
}

static const masu_option rows[] = {
    MASU_OUTPUT(options, csv, "csv", "FILE", "the table as CSV; - for stdout"),
    MASU_TEXT(options, plots, "plots", "DIR",
              "times and scales of each model as DIR/MODEL.svg, with gnuplot"),
    MASU_UINT(options, seeds, "seeds", 1, 10000, "runs of each, with other noise"),
    MASU_TEXT(options, model, "model", "NAME", "only this one"),
    MASU_OWN("controller", "NAME", read_controller, "only this one"),
    MASU_TEXT(options, record.scene, "record", "SCENE.masu",
              "draw the scene along its path at four scales and write the times to TRACE.csv\n"
              "instead"),
    MASU_SIZE(options, record.size, "size", "of the recording"),
    MASU_UINT(options, record.frames, "frames", 2, SIM_FRAMES_MOST, "of the recording"),
    MASU_REAL(options, record.time_step, "time-step", "SECONDS", 0.0, 1e6, "of the recording"),
    MASU_DEVICE_ROWS(options, record.host),
    {.name = NULL}};

static int run(masu_cli *cli) {
    static options o = {.seeds = 20,
                        .record = {.size = {240, 136}, .frames = 300, .time_step = 1.0 / 30.0}};
    masu_given given = {.most = TRACES_MOST, .excess = "more than 8 traces"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (o.record.scene) {
        if (given.count != 1) return masu_cli_usage_error("--record needs the file to write");
        o.record.name = given.arguments[0];
        return masu_simulate_record_run(&o.record);
    }
    for (; o.trace_count < given.count; o.trace_count++) {
        char error[512];
        if (!sim_trace_read(given.arguments[o.trace_count], &o.traces[o.trace_count], error,
                              sizeof error))
            return masu_cli_error("%s", error);
    }
    if (!is_known(&o)) return masu_cli_usage_error("there is no model '%s'", o.model);
    return run_all(&o);
}

const masu_cli_command lab_simulate = {
    .name = "simulate",
    .arguments = "[TRACE.csv...] [options], or --record SCENE.masu TRACE.csv [options]",
    .summary = "run the governor and other engines' controllers on simulated GPUs",
    .details = "over: frames longer than the budget. changes: of the scale. settle: frames from "
               "the model's\n"
               "event until 30 in a row keep the budget and the scale does not fall. oracle: the "
               "mean scale\n"
               "with all times known in advance. Traces are times of a recorded scene: a line "
               "\"frame,SCALE,...\",\n"
               "then a line per frame (lab/simulate/traces).\n",
    .run = run};

/* plant.c: `masu plant`: the governor and rules of others on simulated GPUs (tools/simulate), as a
 * table, as CSV, as plots. Needs no device. */
#include "masu/cmd.h"
#include "masu/plant_record.h"

#include "simulate/plant.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#define TRACES_MOST 8u
#define CONTROLLERS_MOST 8u

enum {
    OPTION_CSV = 1,
    OPTION_PLOTS,
    OPTION_SEEDS,
    OPTION_PLANT,
    OPTION_CONTROLLER,
    OPTION_RECORD,
    OPTION_SIZE,
    OPTION_FRAMES,
    OPTION_TIME_STEP
};

typedef struct plant_options {
    const char *csv, *plots, *plant, *controller;
    uint32_t seeds;
    plant_trace *traces;
    uint32_t trace_count;
} plant_options;

/* Means over the seeds. */
typedef struct row {
    double over, changes, late, scale, settle;
    uint32_t unsettled; /* seeds after which it never did */
    uint32_t invalid;
} row;

static row measure(const plant *p, const plant_controller *c, uint32_t seeds) {
    row out = {0};
    double n = seeds;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        plant_result r = plant_run(p, c, seed, NULL, NULL);
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

/* ---- Plots
 * ------------------------------------------------------------------------------------- */

/* Times above, scales below, a line for each controller; all data inline, so that gnuplot reads no
 * file of ours. */
static void plot(FILE *to, const char *folder, const plant *p, const plant_controller *const *list,
                 uint32_t count) {
    static plant_frame frames[CONTROLLERS_MOST][PLANT_FRAMES_MOST];
    for (uint32_t c = 0; c < count; c++) plant_run(p, list[c], 1, frames[c], NULL);
    fprintf(to, "set output \"%s/%s.svg\"\nset multiplot layout 2,1 title \"%s: %s\" noenhanced\n",
            folder, p->name, p->name, p->what);
    for (uint32_t half = 0; half < 2; half++) {
        fprintf(to, "unset arrow\nset xrange [0:%" PRIu32 "]\n", p->frames);
        if (!half) {
            fprintf(to, "set arrow from graph 0, first %.3f to graph 1, first %.3f nohead dt 2\n",
                    plant_budget(p), plant_budget(p));
        }
        fprintf(to, "set ylabel \"%s\"\nset yrange [%s]\nplot ",
                half ? "scale" : "ms (dashed: budget)", half ? "0.35:1.05" : "0:*");
        for (uint32_t c = 0; c < count; c++) {
            uint32_t line = count - c; /* ours on top */
            fprintf(to, "'-' with lines lw %s lt %" PRIu32 " title \"%s\" noenhanced%s",
                    line == 1 ? "2" : "0.7", line, list[line - 1]->name, line > 1 ? ", " : "\n");
        }
        for (uint32_t c = 0; c < count; c++) {
            const plant_frame *of = frames[count - 1 - c];
            for (uint32_t f = 0; f < p->frames; f++)
                fprintf(to, "%" PRIu32 " %.3f\n", f, half ? of[f].scale : of[f].ms);
            fprintf(to, "e\n");
        }
    }
    fprintf(to, "unset multiplot\n");
}

static FILE *open_gnuplot(const plant_options *o) {
    if (mkdir(o->plots, 0777) && errno != EEXIST) {
        masu_cli_error("%s: cannot be made: %s", o->plots, strerror(errno));
        return NULL;
    }
    if (strpbrk(o->plots, "\"\\\n")) {
        masu_cli_error("--plots: no quotes or backslashes in the name");
        return NULL;
    }
    FILE *to =
        popen("command -v gnuplot > /dev/null || exit 127; exec gnuplot > /dev/null 2>&1", "w");
    if (!to)
        masu_cli_error("gnuplot cannot be started");
    else
        fprintf(to, "set terminal svg size 1000,560\nset key outside\nset xlabel \"frame\"\n");
    return to;
}

static int close_gnuplot(FILE *to, const plant_options *o) {
    int status = pclose(to);
    if (status == 0) return MASU_CLI_OK;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127) {
        masu_cli_warn("no plots: there is no gnuplot (package gnuplot-nox)");
        return MASU_CLI_OK;
    }
    return masu_cli_error("gnuplot could not write the plots to %s", o->plots);
}

/* ---- The command
 * ------------------------------------------------------------------------------- */

static void print_row(FILE *csv, const plant *p, const char *name, const row *r, uint32_t seeds) {
    char settle[32] = "never";
    if (r->unsettled < seeds) snprintf(settle, sizeof settle, "%.1f", r->settle);
    if (!masu_cli_quiet()) {
        printf("%-17s %-12s %8.1f %8.1f %8.1f   %.4f %8s%s\n", p->name, name, r->over, r->changes,
               r->late, r->scale, settle,
               r->unsettled && r->unsettled < seeds ? " (not always)" : "");
    }
    if (!csv) return;
    fprintf(csv, "%s,%s,%" PRIu32 ",%.2f,%.2f,%.4f,%s,%.2f,%" PRIu32 ",%" PRIu32 "\n", p->name,
            name, p->frames, r->over, r->changes, r->scale, settle, r->late, r->unsettled,
            r->invalid);
}

static void run_plant(const plant *p, const plant_options *o, FILE *csv, FILE *plots) {
    const plant_controller *list[CONTROLLERS_MOST];
    uint32_t count = 0;
    row oracle = {.scale = plant_oracle(p)};
    for (uint32_t c = 0; c < plant_controller_count; c++) {
        if (o->controller && strcmp(o->controller, plant_controllers[c].name) != 0) continue;
        list[count++] = &plant_controllers[c];
        row r = measure(p, &plant_controllers[c], o->seeds);
        print_row(csv, p, plant_controllers[c].name, &r, o->seeds);
    }
    if (!masu_cli_quiet()) printf("%-17s %-12s %35.4f\n", p->name, "(oracle)", oracle.scale);
    if (plots) plot(plots, o->plots, p, list, count);
}

static int run_all(const plant_options *o) {
    FILE *csv = NULL, *plots = NULL;
    int code = MASU_CLI_OK;
    if (o->csv && !(csv = strcmp(o->csv, "-") ? fopen(o->csv, "w") : stdout))
        return masu_cli_error("%s: %s", o->csv, strerror(errno));
    if (csv) {
        fprintf(csv, "plant,controller,frames,over_budget,changes,mean_scale,settle_frames,"
                     "late_changes,never_settled,invalid\n");
    }
    if (o->plots && !(plots = open_gnuplot(o))) code = MASU_CLI_FAILURE;
    if (!masu_cli_quiet() && !code) {
        printf("Means of %" PRIu32 " seeds. late: changes from %u frames after the event on.\n",
               o->seeds, PLANT_SETTLED);
        printf("%-17s %-12s %8s %8s %8s   %6s %8s\n", "plant", "controller", "over", "changes",
               "late", "scale", "settle");
    }
    for (uint32_t i = 0; i < plant_count && !code; i++) {
        if (!o->plant || !strcmp(o->plant, plant_list[i].name))
            run_plant(&plant_list[i], o, csv, plots);
    }
    for (uint32_t i = 0; i < o->trace_count && !code; i++) {
        plant p = plant_of_trace(&o->traces[i]);
        if (!o->plant || !strcmp(o->plant, p.name)) run_plant(&p, o, csv, plots);
    }
    if (plots) {
        int closed = close_gnuplot(plots, o);
        if (!code) code = closed;
    }
    if (csv && csv != stdout && fclose(csv))
        code = masu_cli_error("%s: %s", o->csv, strerror(errno));
    return code;
}

static bool is_known(const plant_options *o) {
    if (!o->plant || plant_find(o->plant)) return true;
    for (uint32_t i = 0; i < o->trace_count; i++) {
        if (!strcmp(o->plant, o->traces[i].name)) return true;
    }
    return false;
}

static int run(masu_cli *cli) {
    static plant_trace traces[TRACES_MOST];
    plant_options o = {.seeds = 20, .traces = traces};
    masu_plant_record record = {.size = {240, 136}, .frames = 300, .time_step = 1.0 / 30.0};
    uint32_t controller = 0;
    const char *names[CONTROLLERS_MOST + 1] = {NULL};
    for (uint32_t c = 0; c < plant_controller_count; c++) names[c] = plant_controllers[c].name;
    for (;;) {
        int id = masu_cli_next(cli);
        if (masu_device_option(cli, id, &record.host)) continue;
        switch (id) {
        case OPTION_RECORD: record.scene = cli->value; continue;
        case OPTION_SIZE:
            if (!masu_output_size(cli, &record.size)) return MASU_CLI_USAGE;
            continue;
        case OPTION_FRAMES:
            if (!masu_cli_uint(cli, 2, PLANT_FRAMES_MOST, &record.frames)) return MASU_CLI_USAGE;
            continue;
        case OPTION_TIME_STEP:
            if (!masu_cli_double(cli, 0.0, 1e6, &record.time_step)) return MASU_CLI_USAGE;
            continue;
        case OPTION_CSV:
            if (!masu_output_file_or_stdout(cli, &o.csv)) return cli->exit_code;
            continue;
        case OPTION_PLOTS: o.plots = cli->value; continue;
        case OPTION_PLANT: o.plant = cli->value; continue;
        case OPTION_SEEDS:
            if (!masu_cli_uint(cli, 1, 10000, &o.seeds)) return MASU_CLI_USAGE;
            continue;
        case OPTION_CONTROLLER:
            if (!masu_cli_choice(cli, names, &controller)) return MASU_CLI_USAGE;
            o.controller = names[controller];
            continue;
        case MASU_CLI_ARGUMENT: {
            char error[512];
            record.name = cli->value;
            if (record.scene) continue;
            if (o.trace_count == TRACES_MOST)
                return masu_cli_usage_error("more than %u traces", TRACES_MOST);
            if (!plant_trace_read(cli->value, &traces[o.trace_count], error, sizeof error))
                return masu_cli_error("%s", error);
            o.trace_count++;
            continue;
        }
        case MASU_CLI_EXIT: return cli->exit_code;
        default: break;
        }
        break;
    }
    if (record.scene) {
        if (!record.name) return masu_cli_usage_error("--record needs the file to write");
        return masu_plant_record_run(&record);
    }
    if (!is_known(&o)) return masu_cli_usage_error("there is no plant '%s'", o.plant);
    signal(SIGPIPE, SIG_IGN); /* gnuplot may not be there to read */
    return run_all(&o);
}

static const masu_cli_option options[] = {
    {"csv", "FILE", "the table as CSV; - for stdout", OPTION_CSV, 0},
    {"plots", "DIR", "times and scales of each plant as DIR/PLANT.svg, with gnuplot", OPTION_PLOTS,
     0},
    {"seeds", "N", "runs of each, with other noise (default 20)", OPTION_SEEDS, 0},
    {"plant", "NAME", "this one alone", OPTION_PLANT, 0},
    {"controller", "NAME", "this one alone", OPTION_CONTROLLER, 0},
    {"record", "SCENE.masu",
     "draw the scene along its path at four scales and write the times to TRACE.csv instead; the\n"
     "option comes before it",
     OPTION_RECORD, 0},
    {"size", "WxH", "of the recording (default 240x136)", OPTION_SIZE, 0},
    {"frames", "N", "of the recording (default 300)", OPTION_FRAMES, 0},
    {"time-step", "SECONDS", "of the recording (default 1/30)", OPTION_TIME_STEP, 0},
    MASU_DEVICE_OPTIONS,
    {NULL, NULL, NULL, 0, 0}};

const masu_cli_command masu_cmd_plant = {
    .name = "plant",
    .arguments = "[TRACE.csv...] [options]",
    .summary = "the governor and rules of others on simulated GPUs",
    .options = options,
    .details =
        "over: frames longer than the budget. changes: of the scale. settle: frames from the "
        "plant's\n"
        "event until 30 in a row keep the budget and the scale does not fall. Traces are times of "
        "a\n"
        "recorded scene: a line \"frame,SCALE,...\", then a line per frame (tools/simulate/traces).\n",
    .run = run};

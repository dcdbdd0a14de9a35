/* plot.c: see plot.h. */
#include "bench/plot.h"

#include "bench/labels.h"
#include "bench/sweep.h"
#include "cli/gnuplot.h"
#include "image.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Zero errors also need a position on a logarithmic axis. */
#define LEAST_ERROR 1e-5

static double shown_error(const masu_row *row) { return fmax(masu_row_error(row), LEAST_ERROR); }

static bool drawable(const masu_plot *p, uint32_t i) {
    return isfinite(p->ratios[i]) && p->ratios[i] > 0.0 && isfinite(p->rows[i].flip);
}

/* Series of points: the base, sizes and bundles have one series each, single knobs share one. */
static const char *const series[] = {"base", "scale", "cheap",   "lean",
                                     "full", "soft",  "soft aa", "soft steps",
                                     "soft cascades", "temporal"};
enum { SERIES = sizeof series / sizeof *series };

static uint32_t series_of(const masu_row *row) {
    uint32_t k = 0;
    while (k < SERIES && strcmp(series[k], row->technique) != 0) k++;
    return k;
}

static void write_points(FILE *f, const masu_plot *p) {
    for (uint32_t k = 0; k <= SERIES; k++) {
        fprintf(f, "$series%u << EOD\n", k);
        for (uint32_t i = 0; i < p->row_count; i++) {
            if (drawable(p, i) && series_of(&p->rows[i]) == k)
                fprintf(f, "%.9g %.9g\n", p->ratios[i], shown_error(&p->rows[i]));
        }
        fprintf(f, "nan nan\nEOD\n"); /* a series without points is not an error */
    }
}

static void write_list(FILE *f, const char *name, const masu_plot *p, const uint32_t *list,
                       uint32_t count) {
    fprintf(f, "$%s << EOD\n", name);
    for (uint32_t i = 0; i < count; i++)
        fprintf(f, "%.9g %.9g %u\n", p->ratios[list[i]], shown_error(&p->rows[list[i]]), i);
    fprintf(f, "EOD\n");
}

/* Labels of very short arrows would overlap. */
static bool is_far(double from_time, double from_error, double time, double error) {
    return hypot(log(time / from_time), log(error / from_error)) > 0.12;
}

/* x, y and text of a label, if there is room for it. Returns whether there is. */
static bool write_label(FILE *f, masu_labels *labels, const double at[2], const char *text,
                        double font) {
    double place[2];
    if (!masu_labels_place(labels, at, text, font, place)) return false;
    fprintf(f, "%.9g %.9g ", place[0], place[1]);
    masu_gnuplot_label(f, text);
    fprintf(f, "\n");
    return true;
}

/* Numbers of the rungs, beside their rings and the front. Returns how many have room. */
static uint32_t write_numbers(FILE *f, const masu_plot *p, masu_labels *labels) {
    uint32_t count = 0;
    for (uint32_t k = 1; k < p->front_count; k++) {
        const uint32_t a = p->front[k - 1], b = p->front[k];
        masu_labels_line(labels, (const double[]){p->ratios[a], shown_error(&p->rows[a])},
                         (const double[]){p->ratios[b], shown_error(&p->rows[b])});
    }
    for (uint32_t r = 0; r < p->rung_count; r++) {
        const uint32_t i = p->rungs[r];
        masu_labels_mark(labels, (const double[]){p->ratios[i], shown_error(&p->rows[i])}, 6);
    }
    fprintf(f, "$numbers << EOD\n");
    for (uint32_t r = 0; r < p->rung_count; r++) {
        const uint32_t i = p->rungs[r];
        char number[16];
        snprintf(number, sizeof number, "%u", r);
        count += write_label(f, labels, (const double[]){p->ratios[i], shown_error(&p->rows[i])},
                             number, 13);
    }
    fprintf(f, "EOD\n");
    return count;
}

/* The row where the arrow of a single technique begins; false: row i has none. */
static bool arrow_of(const masu_plot *p, uint32_t i, uint32_t *from) {
    const masu_row *parent = masu_rows_find(p->rows, p->row_count, p->rows[i].parent);
    if (series_of(&p->rows[i]) < SERIES || !parent || !drawable(p, i)) return false;
    *from = (uint32_t)(parent - p->rows);
    return drawable(p, *from);
}

/* Arrows from the parent to each single technique, then the names that have room beside all arrows.
 * Returns the number of arrows; *named: that of names. */
static uint32_t write_arrows(FILE *f, const masu_plot *p, masu_labels *labels, uint32_t *named) {
    uint32_t count = 0, from;
    *named = 0;
    fprintf(f, "$arrows << EOD\n");
    for (uint32_t i = 0; i < p->row_count; i++) {
        if (!arrow_of(p, i, &from)) continue;
        const double tail[2] = {p->ratios[from], shown_error(&p->rows[from])},
                     head[2] = {p->ratios[i], shown_error(&p->rows[i])};
        fprintf(f, "%.9g %.9g %.9g %.9g\n", tail[0], tail[1], head[0], head[1]);
        masu_labels_line(labels, tail, head);
        masu_labels_mark(labels, head, 4);
        count++;
    }
    fprintf(f, "nan nan nan nan\nEOD\n$names << EOD\n");
    for (uint32_t i = 0; i < p->row_count; i++) {
        if (!arrow_of(p, i, &from)) continue;
        const char *setting = p->rows[i].setting,
                   *name = strncmp(setting, "scale=", 6) ? setting : strchr(setting, '+');
        const double at[2] = {p->ratios[i], shown_error(&p->rows[i])};
        if (is_far(p->ratios[from], shown_error(&p->rows[from]), at[0], at[1]))
            *named += write_label(f, labels, at, name ? name + (*name == '+') : setting, 9);
    }
    fprintf(f, "EOD\n");
    return count;
}

static const char style[] =
    "set terminal svg size 960,640 dynamic background '#ffffff' font 'sans-serif,13'\n"
    "set logscale xy\n"
    "set grid xtics ytics mxtics mytics lc rgb '#dddddd', lc rgb '#eeeeee'\n"
    "set border 3 lc rgb '#444444'\n"
    "set margins screen 0.09, screen 0.965, screen 0.11, screen 0.9225\n"
    "set xtics nomirror (0.05,0.1,0.15,0.2,0.3,0.4,0.5,0.6,0.8,1,1.2,1.5,2,3,4,6,8)\n"
    "set ytics nomirror format '%g' add (0.002,0.005,0.02,0.05,0.2,0.5)\n"
    "set ylabel 'mean FLIP against the ground truth, in motion and stationary'\n";

/* What the margins leave of 960x640 pixels; the legend of the ladder is beside its chart. */
static const double area[2] = {840, 520}, ladder_width = 700.8;

/* Explicit ranges, because gnuplot would extend them to powers of ten. The right side has space for
 * names. */
static masu_labels ranges_of(const masu_plot *p) {
    double low[2] = {HUGE_VAL, HUGE_VAL}, high[2] = {0.0, 0.0};
    for (uint32_t i = 0; i < p->row_count; i++) {
        if (!drawable(p, i)) continue;
        const double at[2] = {p->ratios[i], shown_error(&p->rows[i])};
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], at[k]);
            high[k] = fmax(high[k], at[k]);
        }
    }
    if (!(high[0] > 0.0)) low[0] = high[0] = low[1] = high[1] = 1;
    return (masu_labels){.low = {low[0] / 1.08, low[1] / 1.15},
                         .high = {1.4 * high[0], 1.25 * high[1]},
                         .size = {area[0], area[1]}};
}

static void write_title(FILE *f, const masu_plot *p, const char *what) {
    char title[512];
    snprintf(title, sizeof title, "%.400s: %s", p->title, what);
    fprintf(f, "set title ");
    masu_gnuplot_quote(f, title);
    fprintf(f, " noenhanced\n");
}

static void write_commands(FILE *f, const masu_plot *p) {
    write_points(f, p);
    write_list(f, "front", p, p->front, p->front_count);
    write_list(f, "rungs", p, p->rungs, p->rung_count);
    masu_labels labels = ranges_of(p);
    labels.size[0] = ladder_width;
    uint32_t named, numbers = write_numbers(f, p, &labels);
    labels.count = labels.line_count = 0; /* of the other chart */
    labels.size[0] = area[0];
    uint32_t arrows = write_arrows(f, p, &labels, &named);
    fputs(style, f);
    fprintf(f, "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", labels.low[0], labels.high[0],
            labels.low[1], labels.high[1]);
    fprintf(f, "set xlabel 'time / time of the base setting (%s)'\n", p->clock);
    fprintf(f, "set output 'front.svg'\nset key outside right top\n");
    fprintf(f, "set rmargin at screen 0.82\n");
    write_title(f, p, "error against time, and the ladder");
    fprintf(f, "plot $front using 1:2 with lines lw 2 lc rgb '#222222' title 'Pareto front', \\\n");
    static const char *const colors[] = {"#000000", "#0072b2", "#e69f00", "#009e73",
                                         "#cc79a7", "#56b4e9", "#56b4e9", "#56b4e9",
                                         "#8c510a", "#d4a017", "#999999"};
    static const char *const names[] = {
        "base", "render size only", "cheap",           "lean",    "full",
        "soft", "soft, SMAA",        "soft, 128 steps", "soft, 2 cascades", "temporal", "one knob"};
    static const int marks[] = {7, 7, 9, 5, 13, 11, 10, 12, 8, 15, 6};
    for (uint32_t k = 0; k <= SERIES; k++)
        fprintf(f, "  $series%u using 1:2 with points pt %d ps 0.8 lc rgb '%s' title '%s', \\\n", k,
                marks[k], colors[k], names[k]);
    fprintf(f, "  $rungs using 1:2 with points pt 6 ps 2 lw 2 lc rgb '#d55e00' title 'rungs'");
    /* gnuplot 5.4 crashes if there are no labels. */
    if (numbers) {
        fprintf(f, ", \\\n  $numbers using 1:2:3 with labels left textcolor rgb '#d55e00' notitle");
    }
    fprintf(f, "\n");
    fprintf(f, "set output 'techniques.svg'\nset key off\n");
    fprintf(f, "set rmargin at screen 0.965\n");
    write_title(f, p, "effect of each technique, from the setting without it");
    fprintf(f, "plot $front using 1:2 with lines lw 1 dt 2 lc rgb '#888888'");
    if (arrows) {
        fprintf(f,
                ", \\\n  $arrows using 1:2:($3-$1):($4-$2) with vectors head size screen 0.01,20 "
                "filled lw 1.2 lc rgb '#0072b2'");
    }
    if (named) fprintf(f, ", \\\n  $names using 1:2:3 with labels font ',9' left noenhanced");
    fprintf(f, "\n");
}

/* The commands are stored with the plots, so that they can be changed. */
static bool write_file(const masu_plot *p, const char *text, size_t bytes, char folder[4096],
                       char *error, size_t error_size) {
    char path[4096];
    if (masu_sweep_path(p->folder, "plots", folder) && (!mkdir(folder, 0777) || errno == EEXIST) &&
        masu_sweep_path(p->folder, "plots/plots.gp", path))
        return masu_file_write(path, text, bytes, error, error_size);
    snprintf(error, error_size, "%.500s: cannot create a folder for plots", p->folder);
    return false;
}

bool masu_plot_draw(const masu_plot *plot, bool *drawn, char *error, size_t error_size) {
    char folder[4096], *text = NULL;
    size_t bytes = 0;
    masu_gnuplot_end end = MASU_GNUPLOT_FAILED;
    FILE *f = open_memstream(&text, &bytes);
    if (f) write_commands(f, plot);
    bool good = f && !fclose(f);
    if (!good) snprintf(error, error_size, "out of memory");
    good = good && write_file(plot, text, bytes, folder, error, error_size);
    if (good) end = masu_gnuplot_run(folder, text, bytes);
    free(text);
    *drawn = end == MASU_GNUPLOT_DRAWN;
    if (!good || end != MASU_GNUPLOT_FAILED) return good;
    snprintf(error, error_size, "%.500s/plots.gp: gnuplot failed", folder);
    return false;
}

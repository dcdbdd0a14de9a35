/* report.c: see report.h. */
#include "lab/meso/report.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/texture/texel.h"
#include "cli/cli.h"
#include "cli/gnuplot.h"
#include "image.h"

#define DEGREES (180 / MASU_BAKE_PI)

/* ---- text ------------------------------------------------------------------------------------ */

typedef struct text {
    char *data;
    size_t bytes, room;
} text;

MASU_CLI_PRINTF(2, 3) static void add(text *t, const char *format, ...) {
    if (t->room - t->bytes < 1024) {
        t->room = t->room * 2 + 8192;
        t->data = realloc(t->data, t->room);
        if (!t->data) exit(masu_cli_error("out of memory"));
    }
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(t->data + t->bytes, t->room - t->bytes, format, arguments);
    va_end(arguments);
    if (n > 0) t->bytes += (size_t)n < 1024 ? (size_t)n : 1023;
}

static const char *path_of(const char *name, const char *end) {
    static char path[4352];
    snprintf(path, sizeof path, "%s%s", name, end);
    return path;
}

static bool save(const char *path, text *t) {
    char error[1024];
    bool good = masu_file_write(path, t->data, t->bytes, error, sizeof error);
    if (!good) masu_cli_error("%s", error);
    free(t->data);
    *t = (text){0};
    return good;
}

/* ---- numbers --------------------------------------------------------------------------------- */

masu_meso_pair masu_meso_compare(const masu_meso_study *study, uint32_t view) {
    const masu_meso_view *m = &study->made.views[view];
    const masu_meso_curves *c = &study->made.curves;
    masu_meso_vec3 v = masu_meso_from_above(m->angle, 0);
    masu_meso_surface s = {
        {study->made.mean.normal[0], study->made.mean.normal[1], study->made.mean.normal[2]},
        {1, 1, 1},
        study->made.mean.roughness,
        study->made.mean.ao,
        1,
        1};
    masu_meso_bend(c, v, masu_bake_v3(0, 1, 0), &s);
    double y = 1 - v.y, open = y * (c->ao[0] + y * (c->ao[1] + y * c->ao[2]));
    masu_meso_pair p = {.x = v.y};
    p.tilt[0] = atan2(m->toward, m->up) * DEGREES;
    p.tilt[1] = atan2(s.normal.x, s.normal.y) * DEGREES;
    p.rough[0] = (double)masu_texel_rougher((float)c->facet, (float)m->length);
    p.rough[1] = s.roughness;
    p.ao[0] = m->ao;
    p.ao[1] = fmin(fmax(study->made.mean.ao + (1 - study->made.mean.ao) * open, 0), 1);
    return p;
}

static double fitted_shadow(uint32_t bin) { return fmin(fmax(masu_meso_bin_value(bin), 0), 1); }

bool masu_meso_write_csv(const char *name, const masu_meso_study *study) {
    text t = {0};
    add(&t, "angle,x,tilt_measured,tilt_fitted,roughness_measured,roughness_fitted,"
            "ao_measured,ao_fitted,albedo_r,albedo_g,albedo_b\n");
    for (uint32_t i = 0; i < study->made.setup.view_count; i++) {
        masu_meso_pair p = masu_meso_compare(study, i);
        const masu_meso_view *m = &study->made.views[i];
        add(&t, "%g,%.5f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f\n", m->angle, p.x, p.tilt[0],
            p.tilt[1], p.rough[0], p.rough[1], p.ao[0], p.ao[1], m->color[0], m->color[1],
            m->color[2]);
    }
    add(&t, "\nshadow,texels_and_lights,lit_measured,lit_fitted\n");
    for (uint32_t i = 0; i < MASU_MESO_BINS; i++) {
        if (!(study->bins[i].count > 0)) continue;
        add(&t, "%.4f,%.0f,%.4f,%.4f\n", masu_meso_bin_value(i), study->bins[i].count,
            study->bins[i].lit, fitted_shadow(i));
    }
    add(&t, "\nangle,plain,plain_and_ao,curves,plain_over_curves,filtered_plain,filtered_curves,"
            "filtered_curves_diffuse,filtered_mean_plain,filtered_mean_curves\n");
    for (uint32_t i = 0; i < MASU_MESO_JUDGED; i++) {
        const masu_meso_verdict *v = &study->verdict[i];
        add(&t, "%g,%.4f,%.4f,%.4f,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f\n", masu_meso_judged[i],
            v->far[MASU_MESO_PLAIN], v->far[MASU_MESO_OCCLUDED], v->far[MASU_MESO_CURVES],
            v->far[MASU_MESO_PLAIN] / v->far[MASU_MESO_CURVES], v->filtered[MASU_MESO_PLAIN],
            v->filtered[MASU_MESO_CURVES], v->filtered_diffuse, v->filtered_mean[MASU_MESO_PLAIN],
            v->filtered_mean[MASU_MESO_CURVES]);
    }
    add(&t, "\nangle,texels_of_an_edge,plain,plain_and_ao,curves\n");
    for (uint32_t i = 0; i < MASU_MESO_JUDGED; i++) {
        for (uint32_t m = 0; m < MASU_MESO_LEVELS; m++) {
            const double *e = study->verdict[i].texel[m];
            add(&t, "%g,%u,%.4f,%.4f,%.4f\n", masu_meso_judged[i], masu_meso_level_size[m],
                e[MASU_MESO_PLAIN], e[MASU_MESO_OCCLUDED], e[MASU_MESO_CURVES]);
        }
    }
    return save(path_of(name, ".csv"), &t);
}

void masu_meso_print(const char *name, const masu_meso_study *study) {
    printf("%s: relative error of radiance (RMS over lights) against ray tracing\n", name);
    printf("  angle  plain  plain+AO  curves  times better | single texels: plain  curves | "
           "a mip's mean: 16 x 16   4 x 4   1 x 1  each light\n");
    for (uint32_t i = 0; i < MASU_MESO_JUDGED; i++) {
        const masu_meso_verdict *v = &study->verdict[i];
        printf("  %5g  %5.3f  %8.3f  %6.3f  %12.2f | %20.3f  %6.3f | %+21.3f  %+6.3f  %+6.3f  "
               "%10.3f\n",
               masu_meso_judged[i], v->far[MASU_MESO_PLAIN], v->far[MASU_MESO_OCCLUDED],
               v->far[MASU_MESO_CURVES], v->far[MASU_MESO_PLAIN] / v->far[MASU_MESO_CURVES],
               v->texel[0][MASU_MESO_PLAIN], v->texel[0][MASU_MESO_CURVES], v->mip_mean[0],
               v->mip_mean[1], v->mip_mean[2], v->filtered[MASU_MESO_CURVES]);
    }
}

/* ---- plots ----------------------------------------------------------------------------------- */

static void add_data(FILE *f, const masu_meso_study *study) {
    fprintf(f, "$curves << end\n");
    for (uint32_t i = 0; i < study->made.setup.view_count; i++) {
        masu_meso_pair p = masu_meso_compare(study, i);
        fprintf(f, "%.5f %.3f %.3f %.4f %.4f %.4f %.4f\n", p.x, p.tilt[0], p.tilt[1], p.rough[0],
            p.rough[1], p.ao[0], p.ao[1]);
    }
    fprintf(f, "end\n$shadow << end\n");
    for (uint32_t i = 0; i < MASU_MESO_BINS; i++) {
        if (!(study->bins[i].count > 100)) continue;
        fprintf(f, "%.4f %.4f %.4f\n", masu_meso_bin_value(i), study->bins[i].lit,
                fitted_shadow(i));
    }
    fprintf(f, "end\n$error << end\n");
    for (uint32_t i = 0; i < MASU_MESO_JUDGED; i++) {
        const double *e = study->verdict[i].far;
        fprintf(f, "%g %.4f %.4f %.4f\n", masu_meso_judged[i], e[MASU_MESO_PLAIN],
            e[MASU_MESO_OCCLUDED], e[MASU_MESO_CURVES]);
    }
    fprintf(f, "end\n");
}

bool masu_meso_write_plots(const char *name, const masu_meso_study *study) {
    static const struct {
        const char *end, *title, *y, *plot;
    } plots[] = {
        {"_tilt.svg", "mean visible normal", "degrees towards the viewer",
         "$curves using 1:2 with linespoints title 'measured', '' using 1:3 with linespoints title "
         "'fitted to radiance'"},
        {"_rough.svg", "roughness of the visible surface", "perceptual roughness",
         "$curves using 1:4 with linespoints title 'measured', '' using 1:5 with linespoints title "
         "'fitted to radiance'"},
        {"_ao.svg", "ambient occlusion of the visible surface", "share of the sky",
         "$curves using 1:6 with linespoints title 'measured', '' using 1:7 with linespoints title "
         "'fitted to radiance'"},
        {"_shadow.svg", "local shadow", "share lit",
         "$shadow using 1:2 with linespoints title 'measured', '' using 1:3 with lines title 'f'"},
        {"_error.svg", "radiance against ray tracing", "relative RMS error",
         "$error using 1:2 with linespoints title 'plain', '' using 1:3 with linespoints title "
         "'plain and AO', '' using 1:4 with linespoints title 'curves'"}};
    char *commands = NULL;
    size_t bytes = 0;
    FILE *f = masu_gnuplot_can_name(name) ? open_memstream(&commands, &bytes) : NULL;
    if (!f) {
        masu_cli_error("no plots: gnuplot takes no name with control characters");
        return false;
    }
    fprintf(f, "set terminal svg size 560,360\nset grid\nset key top left\n");
    add_data(f, study);
    for (size_t i = 0; i < sizeof plots / sizeof *plots; i++) {
        fprintf(f, "set output ");
        masu_gnuplot_quote(f, path_of(name, plots[i].end));
        fprintf(f, "\nset title '%s'\nset ylabel '%s'\nset yrange [%s]\n", plots[i].title,
                plots[i].y, i == 1 || i == 2 ? "0:1.05" : "*:*");
        fprintf(f, "set xlabel '%s'\n",
                i < 3    ? "cosine between view and polygon"
                : i == 3 ? "offset - alpha (1 - AO)"
                         : "view angle, degrees");
        fprintf(f, "plot %s\n", plots[i].plot);
    }
    masu_gnuplot_end end = MASU_GNUPLOT_FAILED;
    if (!fclose(f)) end = masu_gnuplot_run(NULL, commands, bytes);
    free(commands);
    if (end == MASU_GNUPLOT_MISSING)
        masu_cli_warn("no plots: there is no gnuplot (package gnuplot-nox)");
    if (end == MASU_GNUPLOT_FAILED) masu_cli_error("gnuplot could not write %s_*.svg", name);
    return end != MASU_GNUPLOT_FAILED;
}

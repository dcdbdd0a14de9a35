/* render_stats.c: prints the measurements of `masu render` as JSON, CSV and text; see render.h. */
#include "masu/render.h"

#include "alloc_count.h"

#include <inttypes.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Numbers --------------------------------------------------------------------------------- */

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* Nearest-rank percentile of one field over the samples. */
static double percentile(const masu_sample *samples, uint32_t n, size_t field, double p,
                         double *scratch) {
    for (uint32_t i = 0; i < n; i++)
        memcpy(&scratch[i], (const char *)&samples[i] + field, sizeof(double));
    qsort(scratch, n, sizeof *scratch, compare);
    uint32_t rank = (uint32_t)(p * (double)(n - 1) + 0.5);
    return scratch[rank];
}

static json_t *times_json(const masu_sample *samples, uint32_t n, size_t field, double *scratch) {
    return json_pack("{s:f, s:f, s:f}", "min", percentile(samples, n, field, 0.0, scratch),
                     "median", percentile(samples, n, field, 0.5, scratch), "p95",
                     percentile(samples, n, field, 0.95, scratch));
}

/* Mesa 22.3's lavapipe reports 0.1 ms instead of 100 ms after graphics work has run in the process.
 * GPU times are printed only if they agree with the wall clock. */
static bool plausible(const masu_sample *samples, uint32_t n) {
    uint32_t good = 0;
    for (uint32_t i = 0; i < n; i++) {
        good += samples[i].gpu_ms >= 0.5 * samples[i].wall_ms &&
                samples[i].gpu_ms <= 1.05 * samples[i].wall_ms;
    }
    return 2 * good > n;
}

static json_t *governor_json(const masu_governor_info *g) {
    static const char *const sources[] = {"none", "timestamps", "wall"};
    json_t *predicted = json_array();
    for (uint32_t r = 0; r < g->rung_count; r++)
        json_array_append_new(predicted, json_real((double)g->predicted_ms[r]));
    return json_pack("{s:f, s:I, s:I, s:I, s:I, s:i, s:s, s:i, s:s, s:f, s:f, s:f, s:f, s:f, s:o}",
                     "target_ms", (double)g->target_ms, "samples", (json_int_t)g->samples,
                     "rejected", (json_int_t)g->rejected, "missed", (json_int_t)g->missed,
                     "changes", (json_int_t)g->changes, "rung", (int)g->rung, "reason",
                     g->reason_text, "locked", (int)g->locked, "source", sources[g->source],
                     "fixed_ms", (double)g->fixed_ms, "load_ms", (double)g->load_ms, "noise",
                     (double)g->noise, "start_delay_ms", (double)g->start_delay_ms, "vsync_ms",
                     (double)g->vsync_ms, "predicted_ms", predicted);
}

static json_t *passes_json(const masu_sample *samples, uint32_t n, const masu_plan_info *plan,
                           const masu_stats_info *last, double *scratch) {
    json_t *passes = json_array();
    for (uint32_t p = 0; p < last->pass_count; p++) {
        if (!(plan->passes[p].active & 1u << last->rung)) continue;
        json_t *row = json_pack("{s:s, s:f}", "name", last->pass_names[p], "pipeline_ms",
                                (double)plan->passes[p].pipeline_ns / 1e6);
        if (last->timed) {
            size_t field = offsetof(masu_sample, pass_ms) + p * sizeof(double);
            json_object_set_new(row, "gpu_ms", times_json(samples, n, field, scratch));
        }
        json_array_append_new(passes, row);
    }
    return passes;
}

static json_t *counts_json(const masu_stats_info *last, double pixels) {
    json_t *counts = json_object();
#define COUNT(name) json_object_set_new(counts, #name, json_integer((json_int_t)last->name))
#define PER_PIXEL(name, count)                                                                     \
    json_object_set_new(counts, name "_per_pixel", json_real((double)last->count / pixels))
    COUNT(smaa_tiles);
    COUNT(draws);
    COUNT(triangles);
    COUNT(sdf_evals);
    COUNT(sdf_hits);
    PER_PIXEL("sdf_evals", sdf_evals);
    COUNT(sdf_unconverged);
    COUNT(replaced);
    COUNT(easu_tiles_early);
    PER_PIXEL("shadow_evals", shadow_evals);
    PER_PIXEL("occlusion_evals", occlusion_evals);
    COUNT(shadow_unconverged);
    COUNT(specular_tiles);
    COUNT(specular_rays);
    COUNT(specular_hits);
    COUNT(specular_sdf_hits);
    COUNT(specular_nodes);
    COUNT(specular_evals);
#undef COUNT
#undef PER_PIXEL
    return counts;
}

static json_t *views_json(const masu_stats_info *last) {
    json_t *views = json_array();
    for (uint32_t v = 0; v < last->view_count; v++) {
        const masu_view_stats *view = &last->views[v];
        char name[16] = "camera";
        if (v) snprintf(name, sizeof name, "sun %u", v - 1);
        json_array_append_new(
            views, json_pack("{s:s, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "view", name, "groups",
                             (json_int_t)view->groups, "plane_tests", (json_int_t)view->plane_tests,
                             "instances_in_view", (json_int_t)view->instances, "triangles_in_view",
                             (json_int_t)view->triangles, "occluders",
                             (json_int_t)view->occluders, "visible_instances",
                             (json_int_t)view->visible_instances, "visible_triangles",
                             (json_int_t)view->visible_triangles));
    }
    return views;
}

static json_t *allocations_json(const masu_sample *samples, uint32_t n) {
    uint64_t library = 0, driver = 0, callbacks = 0;
    for (uint32_t i = 0; i < n; i++) {
        library += samples[i].library_allocs;
        driver += samples[i].driver_allocs;
        callbacks += samples[i].driver_callbacks;
    }
    return json_pack("{s:f, s:f, s:f}", "library", (double)library / (double)n, "driver_heap",
                     (double)driver / (double)n, "driver_vulkan_callbacks",
                     (double)callbacks / (double)n);
}

int masu_render_stats(const masu_session *s, const masu_render_options *o,
                      const masu_sample *samples, uint32_t n, const masu_stats_info *last) {
    double *scratch = malloc(n * sizeof *scratch);
    if (!scratch) return masu_cli_error("out of memory for %u samples", n);
    masu_plan_info plan;
    masu_plan_of(s->m, &plan);
    uint32_t rung = last->rung;
    uint32_t width = plan.rungs[rung].render_width, height = plan.rungs[rung].render_height;
    json_t *root = json_pack(
        "{s:s, s:o, s:{s:i, s:i}, s:{s:i, s:i}, s:i, s:i, s:o}", "scene", o->d.scene_path, "device",
        masu_json_device(&s->host), "output", "width", (int)s->desc.output.width, "height",
        (int)s->desc.output.height, "render", "width", (int)width, "height", (int)height, "rung",
        (int)rung, "frames_measured", (int)n, "memory", masu_json_memory(&plan.memory));
    json_object_set_new(root, "wall_ms",
                        times_json(samples, n, offsetof(masu_sample, wall_ms), scratch));
    if (last->timed) {
        json_object_set_new(root, "gpu_ms",
                            times_json(samples, n, offsetof(masu_sample, gpu_ms), scratch));
        json_object_set_new(root, "timestamps_plausible", json_boolean(plausible(samples, n)));
    }
    json_object_set_new(root, "passes", passes_json(samples, n, &plan, last, scratch));
    if (last->exposure > 0.0f)
        json_object_set_new(root, "exposure", json_real((double)last->exposure));
    if (o->target_ms > 0.0) json_object_set_new(root, "governor", governor_json(&last->governor));
    json_object_set_new(root, "counts", counts_json(last, (double)width * (double)height));
    json_object_set_new(root, "views", views_json(last));
    if (masu_alloc_counting())
        json_object_set_new(root, "allocations_per_frame", allocations_json(samples, n));
    free(scratch);
    return masu_json_write(root, o->stats);
}

/* ---- The governor ---------------------------------------------------------------------------- */

int masu_render_times(const masu_session *s, const masu_render_options *o,
                      const masu_sample *samples) {
    char *text = NULL;
    size_t bytes = 0;
    FILE *f = open_memstream(&text, &bytes);
    if (!f) return masu_cli_error("%s: out of memory", o->times);
    fprintf(f, "frame,time,rung,scale,gpu_ms,wall_ms,reason\n");
    for (uint32_t i = 0; i < o->frames; i++) {
        fprintf(f, "%" PRIu32 ",%.4f,%" PRIu32 ",%.4f,%.4f,%.4f,\"%s\"\n", i,
                o->time + i * o->time_step, samples[i].rung,
                (double)s->desc.rungs[samples[i].rung].scale, samples[i].gpu_ms, samples[i].wall_ms,
                samples[i].reason);
    }
    int code = fclose(f) ? masu_cli_error("%s: out of memory", o->times)
                         : masu_text_write(o->times, text, bytes);
    free(text);
    return code;
}

void masu_render_governor(const masu_session *s, const masu_render_options *o,
                          const masu_sample *samples, const masu_governor_info *g) {
    static const char *const sources[] = {"nothing", "timestamps", "the wall clock"};
    double scale = 0.0;
    uint32_t over = 0;
    for (uint32_t i = 0; i < o->frames; i++) {
        scale += (double)s->desc.rungs[samples[i].rung].scale / o->frames;
        over += samples[i].wall_ms > o->target_ms;
    }
    if (masu_cli_quiet()) return;
    masu_cli_progress_clear();
    printf("governor: target %.2f ms, %" PRIu32 " of %" PRIu32
           " frames over it in wall time, %" PRIu64 " rung changes, mean scale %.3f\n",
           o->target_ms, over, o->frames, g->changes, scale);
    printf(
        "  times from %s; model: %.2f ms fixed, %.2f ms that depend on the rung, noise %.1f %%\n",
        sources[g->source], (double)g->fixed_ms, (double)g->load_ms, 100.0 * (double)g->noise);
    for (uint32_t r = 0; r < g->rung_count; r++) {
        uint32_t frames = 0;
        for (uint32_t i = 0; i < o->frames; i++) frames += samples[i].rung == r;
        printf("  rung %" PRIu32 ", scale %.3f: %5" PRIu32 " frames, predicted %.2f ms%s\n", r,
               (double)s->desc.rungs[r].scale, frames, (double)g->predicted_ms[r],
               r == g->rung ? " <" : "");
    }
    if (g->vsync_ms > 0.0f)
        printf("  times are multiples of %.2f ms: they include the wait for the display\n",
               (double)g->vsync_ms);
    printf("  last: rung %" PRIu32 ": %s%s\n", g->rung, g->reason_text,
           g->locked ? " (locked: it cannot change to the rung that it wants)" : "");
}

/* test_controllers.c: the governor compared with the rules of other engines, on simulated GPUs and
 * on recorded scenes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "lab/simulate/controllers.h"
#include "lab/simulate/trace.h"

static const sim_controller *const ours = &sim_masu;

static const sim_model *named(const char *name) {
    const sim_model *p = sim_find(name);
    if (!p) fail_msg("there is no model '%s'", name);
    return p;
}

/* No rival misses fewer frames by more than four (these come from a slow drift, which is followed
 * with the smallest margin), or changes less often by more than four. */
static void it_misses_fewer_frames_than_its_rivals(void **state) {
    static const char *const models[] = {
        "standard", "latency_1", "latency_2", "constant", "step_4x",    "step_1.8x", "sine_50",
        "sine_100", "sine_200",  "sine_400",  "burst",    "scenes",     "walk",      "noise_10",
        "noise_20", "noise_30",  "spikes",    "thermal",  "clock_flips"};
    (void)state;
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        double over, changes;
        sim_mean(named(models[i]), ours, 6, &over, &changes);
        for (uint32_t k = 1; k < sim_controller_count; k++) {
            double rival, rival_changes;
            sim_mean(named(models[i]), sim_controllers[k], 6, &rival, &rival_changes);
            if (over > rival + 4.0 || changes > rival_changes + 4.0) {
                fail_msg("%s: %.1f over and %.1f changes, %s has %.1f and %.1f", models[i], over,
                         changes, sim_controllers[k]->name, rival, rival_changes);
            }
        }
    }
}

/* ---- Recorded scenes ------------------------------------------------------------------------- */

/* Recorded on a machine with shared processors: times change by a fifth for about ten frames. */
static void it_misses_least_on_recorded_scenes(void **state) {
    static const char *const paths[] = {"lab/simulate/traces/engine.csv",
                                        "lab/simulate/traces/city.csv"};
    static sim_trace trace;
    (void)state;
    for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
        char error[256];
        if (!sim_trace_read(paths[i], &trace, error, sizeof error)) fail_msg("%s", error);
        sim_model p = sim_of_trace(&trace);
        sim_result r = sim_run(&p, ours, 1, NULL, NULL), unreal = {0};
        for (uint32_t k = 1; k < sim_controller_count; k++) {
            if (!strcmp(sim_controllers[k]->name, "unreal"))
                unreal = sim_run(&p, sim_controllers[k], 1, NULL, NULL);
        }
        if (4 * r.over > 3 * unreal.over || 2 * r.changes > unreal.changes ||
            r.mean_scale < 0.55 * sim_oracle(&p)) {
            fail_msg(
                "%s: %u of %u frames over, %u changes, mean scale %.3f of %.3f; unreal: %u, %u",
                paths[i], r.over, r.frames, r.changes, r.mean_scale, sim_oracle(&p), unreal.over,
                unreal.changes);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_misses_fewer_frames_than_its_rivals),
        cmocka_unit_test(it_misses_least_on_recorded_scenes),
    };
    return cmocka_run_group_tests_name("controllers", tests, NULL, NULL);
}

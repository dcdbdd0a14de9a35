/* controllers.c: the rules of other engines, written from their descriptions. As in those engines,
 * they get a time per frame, but not the scale at which it was measured. Their scales are
 * continuous and are snapped to the ladder, so that the number of changes is comparable. */
#include "lab/simulate/controllers.h"

#include <math.h>
#include <string.h>

/* ---- Others ---------------------------------------------------------------------------------- */

#define OWN_SCALE UINT32_MAX

static void rival_init(sim_state *s, const masu_governor_rung *ladder, uint32_t rungs,
                       double budget) {
    (void)ladder, (void)rungs;
    memset(s, 0, sizeof *s);
    s->rival.scale = 1.0;
    s->rival.budget = budget;
}

/* The time of a sample, for a rule that does not check it. */
static double plain_time(const masu_governor_sample *k) { return k->gpu_ms; }

static double snap(double scale) {
    double r = floor(log(scale) / log(0.4) * 15.0 + 0.5);
    return pow(0.4, (r < 0.0 ? 0.0 : r > 15.0 ? 15.0 : r) / 15.0);
}

/* Three scales. Every third frame the last time decides: over 16.67 ms one down, below 11.11 ms one
 * up (the rule of the seed's F0V2, which starts at 0.8). */
static void three_init(sim_state *s, const masu_governor_rung *ladder, uint32_t rungs,
                       double budget) {
    rival_init(s, ladder, rungs, budget);
    s->rival.settings = 1;
}
static void three_take(sim_state *s, const masu_governor_sample *k) {
    s->rival.level = plain_time(k);
    s->rival.count++;
}
static uint32_t three_choose(sim_state *s, uint64_t frame, double *scale) {
    static const double scales[] = {1.0, 0.8, 0.4};
    if (frame % 3 == 0 && s->rival.count) {
        if (s->rival.level > s->rival.budget && s->rival.settings < 2)
            s->rival.settings++;
        else if (s->rival.level < s->rival.budget * (2.0 / 3.0) && s->rival.settings > 0)
            s->rival.settings--;
    }
    *scale = scales[s->rival.settings];
    return OWN_SCALE;
}

static double median(const double *values, uint32_t n) {
    double sorted[16];
    for (uint32_t i = 0; i < n; i++) {
        uint32_t j = i;
        for (; j && sorted[j - 1] > values[i]; j--) sorted[j] = sorted[j - 1];
        sorted[j] = values[i];
    }
    return n % 2 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

/* Filament: median of 15 times, then a PID with a dead band whose output changes the area
 * (constants: View.cpp, FrameInfo.cpp). Its scale is at least 0.5 in Filament, 0.4 here. */
static void filament_take(sim_state *s, const masu_governor_sample *k, double headroom) {
    double ms = plain_time(k);
    if (!(ms > 0.0)) return;
    s->rival.history[s->rival.count++ % 15] = ms;
    uint32_t n = s->rival.count < 15 ? s->rival.count : 15;
    if (n < 3) return;
    double error = 1.0 - median(s->rival.history, n) / (s->rival.budget * (1.0 - headroom));
    s->rival.integral += error;
    s->rival.integral = fmax(fmin(s->rival.integral, 100.0), -100.0);
    double out = (1.0 - exp(-1.0 / 8.0)) * error + 0.002 * s->rival.integral;
    if (out > -0.01 && out < 0.05) out = 0.0;
    double area = s->rival.scale * s->rival.scale * (out < 0.0 ? 1.0 / (1.0 - out) : 1.0 + out);
    double scale = sqrt(area);
    if (scale < 0.4 || scale > 1.0) s->rival.integral -= error; /* frozen at the ends */
    s->rival.scale = fmax(fmin(scale, 1.0), 0.4);
}
static void filament_take_0(sim_state *s, const masu_governor_sample *k) {
    filament_take(s, k, 0.0);
}
static void filament_take_10(sim_state *s, const masu_governor_sample *k) {
    filament_take(s, k, 0.1);
}
static uint32_t rival_choose(sim_state *s, uint64_t frame, double *scale) {
    (void)frame;
    *scale = snap(s->rival.scale);
    return OWN_SCALE;
}

/* Unreal: mean of 16 times with weights 0.9^age, 10 % headroom, at least 8 frames between changes,
 * no changes under 2 %, rises by 0.9 of the difference, panic after two frames over the budget
 * (constants: DynamicResolution.cpp, DynamicRenderScaling.h). The model is time ~ area. */
static void unreal_take(sim_state *s, const masu_governor_sample *k) {
    double ms = plain_time(k);
    if (!(ms > 0.0)) return;
    s->rival.history[s->rival.count++ % 16] = ms;
    s->rival.over = ms > s->rival.budget ? s->rival.over + 1 : 0;
    s->rival.held++;
    uint32_t n = s->rival.count < 16 ? s->rival.count : 16;
    bool panic = s->rival.over >= 2;
    if (s->rival.held < 8 && !panic) return;
    double sum = 0.0, weights = 0.0, weight = 1.0;
    for (uint32_t i = 0; i < n; i++, weight *= 0.9) {
        sum += weight * s->rival.history[(s->rival.count - 1 - i) % 16];
        weights += weight;
        if (panic && i == 1) break; /* only the last two */
    }
    double target = s->rival.budget * 0.9, now = s->rival.scale;
    double area = now * now * target / (sum / weights), scale = sqrt(area);
    if (scale > now) scale = now + 0.9 * (scale - now);
    scale = fmax(fmin(scale, 1.0), 0.4);
    if (fabs(scale / now - 1.0) < 0.02) return;
    s->rival.scale = scale;
    s->rival.held = s->rival.count = s->rival.over = 0; /* times of the old scale are dropped */
}

static const sim_controller three_state = {"three_state", three_init, three_take, three_choose};
static const sim_controller filament = {"filament", rival_init, filament_take_0, rival_choose};
static const sim_controller filament_10 = {"filament_10", rival_init, filament_take_10,
                                           rival_choose};
static const sim_controller unreal = {"unreal", rival_init, unreal_take, rival_choose};

const sim_controller *const sim_controllers[] = {&sim_masu, &three_state, &filament, &filament_10,
                                                 &unreal};
const uint32_t sim_controller_count = sizeof sim_controllers / sizeof *sim_controllers;

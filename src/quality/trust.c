/* trust.c: see trust.h. */
#include "quality/trust.h"

#include <math.h>
#include <string.h>

#define NEAREST 0.5 /* of the wall-clock time: GPU times in between are accepted */
#define FARTHEST 1.05
#define BUSY 0.8 /* below it the wall clock is used: its excess depends on the rung */
/* GPU times contradicted by the wall clock, after which only the latter is used */
#define DISTRUST_MOST 30.0
#define UNIT_SAMPLES 16u  /* consecutive samples that agree on a factor of the clock's unit */
#define FROZEN_SAMPLES 4u /* bit-identical GPU times while the wall-clock time changes */
/* of the host's own work: a shorter wall-clock time means that the host was late */
#define LATE 1.1
#define VSYNC_RANGE 0.015 /* of a refresh: tolerance for whole multiples */
#define VSYNC_STEPS 32u   /* times that must fit, */
#define VSYNC_TURNS 4u    /* with this many changes of the multiple */
#define VSYNC_ODD 2u      /* consecutive times that do not fit end the detection */
#define VSYNC_WEIGHT 0.05 /* of a new time in the refresh interval */
#define VSYNC_MOST 16.0   /* largest multiple */
#define CPU_WEIGHT 0.25   /* weight of a new time of the host's work in the estimate, */
#define CPU_STEP 0.1      /* and its maximum relative distance from the estimate */

void masu_trust_start(masu_trust *t) {
    memset(t, 0, sizeof *t);
    t->unit = 1.0;
}

static int agrees(double gpu, double wall) {
    return gpu >= NEAREST * wall && gpu <= FARTHEST * wall;
}

/* A clock with a wrong unit has a constant factor of thousands. An unreliable timer may come close
 * to such a factor by chance, but not this often in a row. The wall clock is assumed to be correct
 * if its time is plausible for this target. */
static void find_unit(masu_trust *t, double target, double raw, double wall) {
    static const double units[] = {1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9};
    double unit = 0.0;
    if (!(raw > 0.0 && raw < 1e19) || !masu_is_time(wall) || wall > MASU_TRUST_RANGE * target ||
        wall < target / MASU_TRUST_RANGE)
        return;
    for (uint32_t i = 0; i < sizeof units / sizeof *units; i++) {
        if (agrees(raw * units[i], wall)) unit = units[i];
    }
    t->unit_count = unit > 0.0 && unit == t->unit_try ? t->unit_count + 1 : 1;
    t->unit_try = unit;
    if (unit > 0.0 && t->unit_count >= UNIT_SAMPLES) t->unit = unit;
}

/* Whether the GPU clock stands still while the wall clock or the rung changes. */
static int is_frozen(masu_trust *t, double gpu, double wall, uint32_t rung) {
    if (gpu == t->frozen_gpu && rung != t->frozen_rung) {
        t->frozen = FROZEN_SAMPLES;
    } else if (gpu != t->frozen_gpu) {
        t->frozen = 0;
        t->frozen_rung = rung;
        t->frozen_gpu = gpu;
        t->frozen_wall = wall;
    } else if (masu_is_time(wall) && fabs(wall - t->frozen_wall) > 0.02 * wall) {
        if (t->frozen < FROZEN_SAMPLES) t->frozen++;
    }
    return t->frozen >= FROZEN_SAMPLES;
}

static void follow_cpu(masu_trust *t, double target, double cpu) {
    if (!masu_is_time(cpu)) return;
    double most = CPU_STEP * (t->cpu + target);
    t->cpu = t->cpu > 0.0 ? t->cpu + CPU_WEIGHT * masu_within(cpu - t->cpu, -most, most) : cpu;
}

/* If wall clock and GPU agree: follows the excess of the wall clock slowly, because it is
 * scheduling with spikes. */
static void follow_overhead(masu_trust *t, double target, double gpu, double wall) {
    double step = wall - gpu - t->overhead, most = 0.02 * target;
    t->overhead =
        t->overhead_known ? t->overhead + masu_within(step, -most, most) / 8.0 : wall - gpu;
    t->overhead = masu_within(t->overhead, 0.0, wall);
    t->overhead_known = 1;
}

/* A single multiple could be any constant load, so the multiple must change. */
static void find_vsync(masu_trust *t, double wall) {
    double k = t->step > 0.0 ? floor(wall / t->step + 0.5) : 0.0;
    double parts = wall < t->step ? floor(t->step / wall + 0.5) : 0.0;
    if (k < 1.0 && parts <= VSYNC_MOST && fabs(t->step - parts * wall) <= VSYNC_RANGE * wall) {
        t->step = wall; /* the candidate was several refreshes */
        t->multiple = 0;
        k = 1.0;
    }
    if (!(k >= 1.0 && k <= VSYNC_MOST && fabs(wall - k * t->step) <= VSYNC_RANGE * t->step)) {
        if (t->step > 0.0 && ++t->odd < VSYNC_ODD) return;
        t->step = wall;
        t->steps = t->turns = t->odd = 0;
        t->multiple = 1;
        t->vsync = 0.0;
        return;
    }
    t->odd = 0;
    t->step += VSYNC_WEIGHT * (wall / k - t->step);
    t->turns += t->multiple != (uint32_t)k && t->turns < VSYNC_TURNS;
    t->multiple = (uint32_t)k;
    if (t->steps < VSYNC_STEPS) t->steps++;
    t->vsync = t->steps >= VSYNC_STEPS && t->turns >= VSYNC_TURNS ? t->step : 0.0;
}

double masu_trust_time(masu_trust *t, double target, const masu_governor_sample *s, int *sure) {
    double wall = masu_is_time(s->wall_ms) ? s->wall_ms : 0.0;
    /* If the host is busy longer than the GPU, the fence was signalled before the host waits. The
     * wall-clock time is then the host's own work: it is only an upper bound of the GPU time, and
     * is not used to find units. */
    int late = wall > 0.0 && masu_is_time(s->cpu_ms) && wall <= LATE * s->cpu_ms;
    follow_cpu(t, target, s->cpu_ms);
    if (!late) find_unit(t, target, s->gpu_ms, wall);
    if (wall > 0.0) find_vsync(t, wall);
    double gpu = s->gpu_ms * t->unit;
    if (!masu_is_time(gpu)) gpu = 0.0;
    int frozen = is_frozen(t, s->gpu_ms, wall, s->rung);
    *sure = 0;
    if (late) {
        if (gpu > 0.0 && gpu <= FARTHEST * wall && !frozen && !t->wall_only) {
            t->source = MASU_GOVERNOR_SOURCE_GPU;
            return gpu + t->overhead;
        }
        if (s->cpu_ms > target) return 0.0;
        t->source = MASU_GOVERNOR_SOURCE_WALL;
        return wall;
    }
    if (wall > 0.0 && gpu > 0.0 && agrees(gpu, wall) && !frozen) {
        t->distrust = masu_largest(t->distrust - 0.1, 0.0);
        follow_overhead(t, target, gpu, wall);
        *sure = 1;
        if (!t->wall_only && gpu >= BUSY * wall) {
            t->source = MASU_GOVERNOR_SOURCE_GPU;
            return gpu + t->overhead;
        }
    } else if (wall > 0.0 && (s->gpu_ms > 0.0 || s->gpu_ms < 0.0)) {
        t->distrust += 1.0;
        if (t->distrust >= DISTRUST_MOST) t->wall_only = 1;
    }
    if (wall > 0.0) {
        t->source = MASU_GOVERNOR_SOURCE_WALL;
        *sure = 1;
        return wall;
    }
    if (gpu > 0.0 && !t->wall_only && !frozen) {
        t->source = MASU_GOVERNOR_SOURCE_GPU;
        return gpu + t->overhead;
    }
    return 0.0;
}

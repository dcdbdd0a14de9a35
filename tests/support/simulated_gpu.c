/* simulated_gpu.c: the list of models, and a run of a controller on one. See simulated_gpu.h. */
#include "support/simulated_gpu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- Random numbers: splitmix64 (S. Vigna)
 * ----------------------------------------------------- */

static uint64_t next(uint64_t *state) {
    uint64_t z = *state += 0x9E3779B97F4A7C15u;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9u;
    z = (z ^ z >> 27) * 0x94D049BB133111EBu;
    return z ^ z >> 31;
}

static double uniform(uint64_t *state) { return (double)(next(state) >> 11) * 0x1p-53; }

/* ---- Loads: ms of the pixel part at scale 1
 * ---------------------------------------------------- */

static double standard(const sim_model *p, uint32_t f) {
    (void)p;
    return f < 300 ? 10 : f < 600 ? 30 : f < 900 ? 60 : f < 1200 ? 18 : 40 + 30 * sin(0.05 * f);
}
static double step(const sim_model *p, uint32_t f) { return f < p->event ? p->a : p->b; }
static double ramp(const sim_model *p, uint32_t f) {
    double t = fabs(fmod((double)f / p->period, 2.0) - 1.0); /* 1 .. 0 .. 1 */
    return p->b + (p->a - p->b) * t;
}
static double sine(const sim_model *p, uint32_t f) {
    return p->a + p->b * sin(6.283185307179586 * f / p->period);
}
static double burst(const sim_model *p, uint32_t f) {
    return f % (uint32_t)p->period < 20 && f >= (uint32_t)p->period ? p->b : p->a;
}
/* Steps at unpredictable frames, by a factor of 0.6 to 1.8, with a slope in between. */
static double scenes(const sim_model *p, uint32_t f) {
    double load = p->a, slope = 0.0;
    uint64_t random = 7;
    for (uint32_t i = 0; i <= f; i++) {
        double u = uniform(&random), v = uniform(&random), w = uniform(&random);
        if (u < 0.006) load *= 0.6 + 1.2 * v;
        if (w < 0.02) slope = 0.01 * (v - 0.5);
        load *= 1.0 + slope;
        load = load < 8.0 ? 8.0 : load > 75.0 ? 75.0 : load;
    }
    return load;
}
/* A random walk that is pulled back to its mean, smoothed over ten frames. */
static double walk(const sim_model *p, uint32_t f) {
    double x = 0.0, y = 0.0;
    uint64_t random = 11;
    for (uint32_t i = 0; i <= f; i++) {
        double n = 2.0 * (uniform(&random) + uniform(&random) + uniform(&random) - 1.5);
        x += n * sqrt(2.0 / p->period) - x / p->period;
        y += (x - y) / 10.0;
    }
    return p->a * exp(p->b * y);
}

static double thermal(uint32_t f) {
    return f < 300 ? 1.0 : 1.0 + 0.6 * (1.0 - exp(-(f - 300.0) / 500.0));
}
static double flips(uint32_t f) { return f / 200 % 2 ? 1040.0 / 200.0 : 1.0; }

/* One of a handheld, with values of SteamOS; two of Linux's devfreq on a phone. */
static const sim_dvfs handheld = {200, 1040, 0.9, 0.7, 1.15, 4};
static const sim_dvfs ondemand = {200, 1040, 0.9, 0.85, 0, 3};
static const sim_dvfs slow_ondemand = {200, 1040, 0.9, 0.85, 0, 12};

#define STEADY .frames = 1500
const sim_model sim_models[] = {
    {"standard", "steps, then a sine of 40 +- 30 ms", .frames = 1800, .event = 600,
     .load = standard},
    {"constant", "the same load for ever", STEADY, .a = 30},
    {"step_4x", "the load steps to four times", STEADY, .event = 300, .load = step, .a = 10,
     .b = 40},
    {"step_1.8x", "4 + 16 s^2 ms, the load steps to 1.8 times", STEADY, .event = 300, .load = step,
     .a = 16, .b = 28.8, .fixed = 4, .noise = 0.1},
    {"step_down", "the load steps to a quarter", STEADY, .event = 300, .load = step, .a = 40,
     .b = 10},
    {"ramp", "10 to 70 ms in ten seconds and back", STEADY, .load = ramp, .a = 10, .b = 70,
     .period = 600},
    {"sine_50", "a sine of 50 frames", STEADY, .load = sine, .a = 40, .b = 30, .period = 50},
    {"sine_100", "a sine of 100 frames", STEADY, .load = sine, .a = 40, .b = 30, .period = 100},
    {"sine_200", "a sine of 200 frames", STEADY, .load = sine, .a = 40, .b = 30, .period = 200},
    {"sine_400", "a sine of 400 frames", STEADY, .load = sine, .a = 40, .b = 30, .period = 400},
    {"burst", "20 frames of three times the load, every 150", STEADY, .load = burst, .a = 15,
     .b = 45, .period = 150},
    {"scenes", "jumps and slopes at random", STEADY, .load = scenes, .a = 20},
    {"walk", "a random walk around 30 ms", STEADY, .load = walk, .a = 30, .b = 0.3, .period = 100},
    {"noise_10", "noise of 10 %", STEADY, .a = 30, .noise = 0.10},
    {"noise_20", "noise of 20 %", STEADY, .a = 30, .noise = 0.20},
    {"noise_30", "noise of 30 %", STEADY, .a = 30, .noise = 0.30},
    {"spikes", "one frame in a hundred takes three times as long", STEADY, .a = 30, .spikes = 0.01},
    {"thermal", "clocks sink to 62 % in some seconds", STEADY, .event = 300, .a = 20,
     .clock = thermal},
    {"clock_flips", "1040 and 200 MHz alternately, 200 frames each", STEADY, .event = 200, .a = 4,
     .fixed = 0.5, .clock = flips},
    {"dvfs_steps", "the clock steps up above 90 % busy, down below 70 %; the load steps",
     .frames = 4000, .event = 300, .load = step, .a = 8, .b = 20, .dvfs = &handheld},
    {"dvfs_ondemand", "to the highest clock above 90 %, else as low as 87 % busy; the load steps",
     .frames = 4000, .event = 300, .load = step, .a = 8, .b = 20, .dvfs = &ondemand},
    {"dvfs_slow", "the same, looking every 12 frames", .frames = 4000, .event = 300, .load = step,
     .a = 8, .b = 20, .dvfs = &slow_ondemand},
    {"dvfs_light", "the best rung always fits at the highest clock", .frames = 4000, .event = 300,
     .load = step, .a = 4, .b = 10, .dvfs = &ondemand},
    {"dvfs_peak", "a load that no clock carries at scale 1 for 100 frames", .frames = 4000,
     .event = 400, .load = burst, .a = 9, .b = 40, .period = 300, .dvfs = &handheld},
    {"dvfs_fixed", "three rungs and 5 ms of fixed cost", .frames = 4000, .event = 300, .load = step,
     .a = 6, .b = 15, .fixed = 5, .rungs = 3, .dvfs = &ondemand},
    {"latency_1", "the standard model, samples a frame late", .frames = 1800, .event = 600,
     .load = standard, .latency = 1},
    {"latency_2", "two frames late", .frames = 1800, .event = 600, .load = standard, .latency = 2},
    {"quantised", "timestamps in steps of 1 ms", STEADY, .event = 300, .load = step, .a = 16,
     .b = 30, .quantum = 1},
    {"missing_5", "5 % of samples missing, a step", STEADY, .event = 300, .load = step, .a = 16,
     .b = 28.8, .fixed = 4, .missing = 0.05},
    {"missing_50", "50 % of samples missing, a step", STEADY, .event = 300, .load = step, .a = 16,
     .b = 28.8, .fixed = 4, .missing = 0.5},
    {"wall_only", "no timestamps, a step", STEADY, .event = 300, .load = step, .a = 16, .b = 28.8,
     .lie = SIM_ZERO, .lie_until = 1500, .wall = 1},
    {"lies_tenth", "0.1 ms for 60 frames; wall clock", STEADY, .event = 300, .a = 30,
     .lie = SIM_TENTH, .lie_from = 300, .lie_until = 360, .wall = 1},
    {"lies_tenth_blind", "0.1 ms for 60 frames; no wall clock", STEADY, .event = 300, .a = 30,
     .lie = SIM_TENTH, .lie_from = 300, .lie_until = 360},
    {"lies_lavapipe", "about 0.1 ms always; wall clock", STEADY, .event = 300, .load = step,
     .a = 16, .b = 30, .lie = SIM_LAVAPIPE, .lie_until = 1500, .wall = 1},
    {"lies_low", "60 % of the true time; wall clock", STEADY, .event = 300, .load = step, .a = 16,
     .b = 30, .lie = SIM_LOW, .lie_until = 1500, .wall = 1},
    {"lies_frozen", "timestamps stand still for 300 frames; wall clock", STEADY, .event = 400,
     .load = step, .a = 16, .b = 30, .lie = SIM_FROZEN, .lie_from = 300, .lie_until = 600,
     .wall = 1},
    {"lies_huge", "2^64 - 1 for 60 frames", STEADY, .event = 300, .a = 30, .lie = SIM_HUGE,
     .lie_from = 300, .lie_until = 360},
    {"lies_negative", "negative for 60 frames", STEADY, .event = 300, .a = 30, .lie = SIM_NEGATIVE,
     .lie_from = 300, .lie_until = 360},
    {"lies_nan", "not a number for 60 frames", STEADY, .event = 300, .a = 30, .lie = SIM_NAN,
     .lie_from = 300, .lie_until = 360},
    {"unit_us", "microseconds for milliseconds; wall clock", STEADY, .event = 300, .load = step,
     .a = 16, .b = 30, .lie = SIM_MICRO, .lie_until = 1500, .wall = 1},
    {"unit_ns", "nanoseconds for milliseconds; wall clock", STEADY, .event = 300, .load = step,
     .a = 16, .b = 30, .lie = SIM_NANO, .lie_until = 1500, .wall = 1},
    {"unit_s", "seconds for milliseconds; wall clock", STEADY, .event = 300, .load = step, .a = 16,
     .b = 30, .lie = SIM_SECONDS, .lie_until = 1500, .wall = 1},
    {"garbage", "any bits for timestamps; wall clock", STEADY, .event = 300, .load = step, .a = 16,
     .b = 30, .lie = SIM_GARBAGE, .lie_until = 1500, .wall = 1},
    {"garbage_blind", "any bits in a tenth of the frames, and no wall", STEADY, .event = 300,
     .load = step, .a = 16, .b = 30, .lie = SIM_GARBAGE, .lie_from = 1, .lie_until = 0},
    {"pause", "10 s in one frame, then 200 frames without samples", STEADY, .event = 500, .a = 30,
     .pause = 500},
    {"prior_flat", "cost grows with s^1.4, not s^2", STEADY, .event = 300, .load = step, .a = 10,
     .b = 40, .exponent = 1.4},
    {"prior_steep", "cost grows with s^3", STEADY, .event = 300, .load = step, .a = 10, .b = 40,
     .exponent = 3},
    {"fixed_heavy", "10 ms of 16.67 are fixed", STEADY, .event = 300, .load = step, .a = 8, .b = 24,
     .fixed = 10},
    {"three_rungs", "the ladder is 1, 0.8, 0.4", STEADY, .event = 300, .load = step, .a = 10,
     .b = 25, .rungs = 3},
    {"overload", "no rung keeps the budget, until the load drops at 1000", STEADY, .event = 1000,
     .load = step, .a = 200, .b = 12},
    {"cpu_bound", "40 ms at every rung", STEADY, .a = 0.2, .fixed = 40},
};
const uint32_t sim_model_count = sizeof sim_models / sizeof *sim_models;

const sim_model *sim_find(const char *name) {
    for (uint32_t i = 0; i < sim_model_count; i++) {
        if (!strcmp(sim_models[i].name, name)) return &sim_models[i];
    }
    return NULL;
}

/* ---- A run
 * ------------------------------------------------------------------------------------- */

double sim_budget(const sim_model *p) { return p->trace ? p->trace->budget_ms : SIM_BUDGET; }

uint32_t sim_ladder(const sim_model *p, masu_governor_rung out[SIM_RUNGS]) {
    static const double three[] = {1.0, 0.8, 0.4};
    uint32_t n = p->rungs ? p->rungs : SIM_RUNGS;
    for (uint32_t r = 0; r < n; r++)
        out[r] = (masu_governor_rung){.scale = n == 3 ? three[r] : pow(0.4, r / (n - 1.0))};
    return n;
}

/* Between two recorded scales a time is linear in the number of pixels. */
static double trace_ms(const sim_trace *t, uint32_t f, double s) {
    const double *row = t->ms[f % t->frames];
    uint32_t i = 0;
    while (i + 2 < t->columns && s < t->scale[i + 1]) i++;
    double high = t->scale[i] * t->scale[i], low = t->scale[i + 1] * t->scale[i + 1];
    double ms = row[i + 1] + (row[i] - row[i + 1]) * (s * s - low) / (high - low);
    return ms > 0.01 ? ms : 0.01;
}

static double fixed_of(const sim_model *p) { return p->fixed > 0.0 ? p->fixed : 2.0; }
static double noise_of(const sim_model *p) {
    return p->noise > 0.0 ? p->noise : p->trace ? 0.0 : 0.04;
}

/* Without noise. */
static double mean_ms(const sim_model *p, uint32_t f, double s) {
    if (p->trace) return trace_ms(p->trace, f, s);
    double load = p->load ? p->load(p, f) : p->a, clock = p->clock ? p->clock(f) : 1.0;
    return clock * (fixed_of(p) + load * pow(s, p->exponent > 0.0 ? p->exponent : 2.0));
}

static double lie(sim_lie kind, double ms, double honest, uint64_t *random) {
    double u = uniform(random);
    uint64_t bits = next(random);
    switch (kind) {
    case SIM_TENTH: return 0.1;
    case SIM_LAVAPIPE: return 0.06 + 0.11 * u;
    case SIM_LOW: return 0.6 * ms;
    case SIM_FROZEN: return honest;
    case SIM_ZERO: return 0.0;
    case SIM_NEGATIVE: return -ms;
    case SIM_HUGE: return 18446744073709551615.0;
    case SIM_NAN: return (double)NAN;
    case SIM_MICRO: return 1e3 * ms;
    case SIM_NANO: return 1e6 * ms;
    case SIM_SECONDS: return 1e-3 * ms;
    case SIM_GARBAGE: {
        sim_lie any = (sim_lie)(bits % SIM_GARBAGE);
        double garbage;
        if (u < 0.7) return lie(any, ms, honest, random);
        memcpy(&garbage, &bits, sizeof garbage);
        return garbage;
    }
    default: return ms;
    }
}

static sim_result judge(const sim_model *p, const sim_frame *frames) {
    sim_result out = {.frames = p->frames, .settle = -1};
    uint32_t good = 0, window = 0;
    for (uint32_t f = 0; f < p->frames; f++) {
        bool over = frames[f].ms > sim_budget(p);
        bool changed = f && frames[f].scale != frames[f - 1].scale;
        out.over += over;
        out.changes += changed;
        out.late_changes += changed && f >= p->event + SIM_SETTLED;
        out.mean_scale += frames[f].scale / p->frames;
        window += changed;
        if (f >= 150) window -= f > 150 && frames[f - 150].scale != frames[f - 151].scale;
        if (window > out.most_changes_150) out.most_changes_150 = window;
        if (f < p->event || out.settle >= 0) continue;
        good = over || (f && frames[f].scale < frames[f - 1].scale) ? 0 : good + 1;
        /* A frame that lowers the scale and is within the budget is the first good one. */
        if (!over && !good) good = 1;
        if (good == 30) out.settle = (int32_t)(f + 1 - 30 - p->event);
    }
    return out;
}

/* The clock for the next frame, after one of `ms`. */
typedef struct dvfs_state {
    double mhz, busy, time;
    uint32_t frames;
} dvfs_state;

static void follow_load(const sim_dvfs *d, dvfs_state *s, double ms) {
    s->busy += ms;
    s->time += ms > SIM_BUDGET ? ms : SIM_BUDGET;
    if (++s->frames < d->period) return;
    double busy = s->busy / s->time, mhz = s->mhz;
    if (d->step > 0.0)
        mhz *= busy > d->up ? d->step : busy < d->down ? 1.0 / d->step : 1.0;
    else if (busy > d->up)
        mhz = d->high;
    else if (busy < d->down)
        mhz *= busy / (0.5 * (d->up + d->down));
    *s = (dvfs_state){.mhz = mhz < d->low ? d->low : mhz > d->high ? d->high : mhz};
}

sim_result sim_run(const sim_model *p, const sim_controller *c, uint64_t seed,
                       sim_frame *frames, sim_state *state) {
    static sim_frame own_frames[SIM_FRAMES_MOST];
    static masu_governor_sample samples[SIM_FRAMES_MOST];
    masu_governor_rung ladder[SIM_RUNGS];
    sim_state own_state;
    sim_frame *out = frames ? frames : own_frames;
    sim_state *s = state ? state : &own_state;
    uint32_t rungs = sim_ladder(p, ladder), latency = p->latency ? p->latency : 3, invalid = 0;
    uint64_t random = seed * 0x632BE59BD9B4E019u + 1;
    double honest = 0.0;
    dvfs_state clock = {.mhz = p->dvfs ? p->dvfs->high : 1.0};
    c->init(s, ladder, rungs, sim_budget(p));
    for (uint32_t f = 0; f < p->frames; f++) {
        if (f >= latency && samples[f - latency].frame == f - latency)
            c->sample(s, &samples[f - latency]);
        double scale = 0.0;
        uint32_t rung = c->pick(s, f, &scale);
        if (rung < rungs) scale = ladder[rung].scale;
        if (!(scale >= 0.01 && scale <= 1.0)) invalid++, scale = 1.0;
        double u = uniform(&random), ms = mean_ms(p, f, scale) * (1.0 + noise_of(p) * (u - 0.5));
        if (uniform(&random) < p->spikes) ms *= 3.0;
        if (p->dvfs) ms *= p->dvfs->high / clock.mhz;
        out[f] = (sim_frame){ms, scale, clock.mhz, rung};
        if (p->dvfs) follow_load(p->dvfs, &clock, ms);
        masu_governor_sample *k = &samples[f];
        *k = (masu_governor_sample){.frame = f, .rung = rung, .gpu_ms = ms};
        if (p->quantum > 0.0) k->gpu_ms = p->quantum * floor(ms / p->quantum + 0.5);
        if (p->wall) k->wall_ms = (ms + 0.3) * (1.0 + 0.02 * (uniform(&random) - 0.5));
        bool lies = f >= p->lie_from && f < p->lie_until;
        if (p->lie == SIM_GARBAGE && !p->lie_until) lies = uniform(&random) < 0.1;
        if (p->lie && lies)
            k->gpu_ms = lie(p->lie, k->gpu_ms, honest, &random);
        else
            honest = k->gpu_ms;
        if (uniform(&random) < p->missing) k->frame = UINT64_MAX;
        if (p->pause && f == p->pause) k->gpu_ms = 1e4;
        if (p->pause && f > p->pause && f <= p->pause + 200) k->frame = UINT64_MAX;
    }
    sim_result result = judge(p, out);
    result.invalid = invalid;
    return result;
}

double sim_oracle(const sim_model *p) {
    masu_governor_rung ladder[SIM_RUNGS];
    uint32_t rungs = sim_ladder(p, ladder);
    double sum = 0.0;
    for (uint32_t f = 0; f < p->frames; f++) {
        uint32_t r = 0;
        while (r + 1 < rungs &&
               mean_ms(p, f, ladder[r].scale) * (1.0 + 0.5 * noise_of(p)) > sim_budget(p))
            r++;
        sum += ladder[r].scale / p->frames;
    }
    return sum;
}

/* ---- The governor as a controller ------------------------------------------------------------ */

static void masu_init_state(sim_state *s, const masu_governor_rung *ladder, uint32_t rungs,
                            double budget) {
    const masu_governor_desc desc = {.mode = MASU_GOVERNOR_ON, .target_ms = (float)budget};
    masu_governor_init(&s->governor, &desc, ladder, rungs);
}
static void masu_take(sim_state *s, const masu_governor_sample *k) {
    masu_governor_sample_in(&s->governor, k);
}
static uint32_t masu_choose(sim_state *s, uint64_t frame, double *scale) {
    (void)scale;
    return masu_governor_pick(&s->governor, frame);
}

const sim_controller sim_masu = {"masu", masu_init_state, masu_take, masu_choose};

sim_result sim_mean(const sim_model *p, const sim_controller *c, uint32_t seeds, double *over,
                    double *changes) {
    sim_result sum = {0};
    *over = *changes = 0.0;
    for (uint32_t seed = 1; seed <= seeds; seed++) {
        sim_result r = sim_run(p, c, seed, NULL, NULL);
        *over += (double)r.over / seeds;
        *changes += (double)r.changes / seeds;
        sum.mean_scale += r.mean_scale / seeds;
        sum.invalid += r.invalid;
    }
    return sum;
}

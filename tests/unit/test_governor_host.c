/* test_governor_host.c: how a game uses the governor between frames: another target, excluded
 * frames, state that is kept for a new renderer, times of overlapping frames, the host's own work,
 * the display's refresh, a clock that follows its load. Simulated: the results are counts, no times
 * of this machine. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "frame/timeline.h"
#include "quality/governor_state.h"
#include "support/simulated_gpu.h"
#include "support/random.h"

#define RUNGS 8u

static const VkExtent2D hd = {1280, 720};

static void ladder_of(masu_governor_rung out[RUNGS]) {
    for (uint32_t r = 0; r < RUNGS; r++) out[r] = (masu_governor_rung){1.0 - 0.08 * r, 0.0};
}

static void start(masu_governor *g, masu_governor_desc d) {
    masu_governor_rung ladder[RUNGS];
    ladder_of(ladder);
    if (!d.mode) d.mode = MASU_GOVERNOR_ON;
    masu_governor_init(g, &d, ladder, RUNGS);
}

static masu_governor_info report(const masu_governor *g) {
    masu_governor_info info;
    masu_governor_report(g, &info);
    return info;
}

/* A GPU of 2 ms and `load` ms of pixels at scale 1, each sample two frames late. */
typedef struct gpu {
    uint64_t frame, random;
    double load, fixed;
    masu_governor_sample flying[2];
    uint32_t missed, changes, rung;
    double ms;
} gpu;

static gpu gpu_of(double load, uint64_t seed) {
    return (gpu){.random = seed * 77 + 1, .load = load, .fixed = 2.0};
}

static uint32_t frame(masu_governor *g, gpu *p) {
    masu_governor_sample *slot = &p->flying[p->frame % 2];
    if (p->frame >= 2) masu_governor_sample_in(g, slot);
    uint32_t rung = masu_governor_pick(g, p->frame);
    double s = g->scale[rung], noise = (double)(support_random(&p->random) % 1000) * 1e-3 - 0.5;
    p->ms = (p->fixed + p->load * s * s) * (1.0 + 0.02 * noise);
    *slot = (masu_governor_sample){.frame = p->frame, .rung = rung, .gpu_ms = p->ms};
    p->missed += p->ms > g->target;
    p->changes += p->frame && rung != p->rung;
    p->rung = rung;
    p->frame++;
    return rung;
}

static void frames(masu_governor *g, gpu *p, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) frame(g, p);
}

/* ---- Settings -------------------------------------------------------------------------------- */

static void a_setting_counts_from_the_next_frame_on(void **state) {
    (void)state;
    masu_governor g;
    masu_governor_desc d = {.mode = MASU_GOVERNOR_ON};
    start(&g, d);
    gpu p = gpu_of(25.0, 1);
    frames(&g, &p, 200);
    uint32_t before = p.rung;
    double load = g.load, fixed = g.fixed;
    assert_true(before >= 2);
    d.target_ms = 33.3f;
    masu_governor_adjust(&g, &d);
    assert_true(g.load == load && g.fixed == fixed); /* the model does not depend on the target */
    assert_int_equal(frame(&g, &p), 0);
    assert_int_equal(report(&g).reason, MASU_GOVERNOR_REASON_UP);
    frames(&g, &p, 60);
    d.target_ms = 16.67f;
    masu_governor_adjust(&g, &d);
    p.missed = 0;
    assert_int_equal(frame(&g, &p), before); /* and back at once, before frames are missed */
    frames(&g, &p, 100);
    assert_true(p.missed <= 1);

    d.best_rung = before + 1;
    masu_governor_adjust(&g, &d);
    assert_int_equal(frame(&g, &p), before + 1);
    d.best_rung = 0;
    d.worst_rung = before + 2;
    masu_governor_adjust(&g, &d);
    frames(&g, &p, 60);
    assert_int_equal(p.rung, before);
    p.load = 100.0;
    frames(&g, &p, 60);
    assert_int_equal(p.rung, before + 2);
    d.mode = MASU_GOVERNOR_FIXED;
    d.rung = 1;
    masu_governor_adjust(&g, &d);
    assert_int_equal(frame(&g, &p), 1);
    frames(&g, &p, 30);
    assert_int_equal(p.rung, 1);
    assert_int_equal(report(&g).reason, MASU_GOVERNOR_REASON_FIXED);
    d.mode = MASU_GOVERNOR_ON;
    masu_governor_adjust(&g, &d);
    assert_int_equal(frame(&g, &p), before + 2);
}

/* A host that keeps changing the limits: it rises only every 8 frames. The same setting again has
 * no effect. */
static void a_rung_is_held_for_eight_frames(void **state) {
    (void)state;
    masu_governor g;
    start(&g, (masu_governor_desc){.dwell = 1});
    gpu p = gpu_of(25.0, 2);
    frames(&g, &p, 200);
    uint32_t held = 8, last = p.rung, rises = 0;
    for (uint32_t i = 0; i < 400; i++) {
        masu_governor_desc d = {.mode = MASU_GOVERNOR_ON,
                                .dwell = 1,
                                .target_ms = i % 5 < 2 ? 16.67f : 25.0f};
        masu_governor_adjust(&g, &d);
        uint32_t rung = frame(&g, &p);
        if (rung < last && held < 8) fail_msg("frame %u: rung %u after %u frames", i, rung, held);
        rises += rung < last;
        held = rung == last ? held + 1 : 1;
        last = rung;
    }
    assert_true(rises > 10 && rises <= 50);
    masu_governor settled = g;
    settled.settled_load = 7.0;
    settled.urged = 0;
    masu_governor_adjust(&settled, &(masu_governor_desc){
                                       .mode = MASU_GOVERNOR_ON, .dwell = 1, .target_ms = 25.0f});
    assert_true(settled.settled_load == 7.0 && !settled.urged);
}

/* ---- Excluded frames ------------------------------------------------------------------------- */

static void unusual_frames_say_nothing(void **state) {
    (void)state;
    for (uint32_t told = 0; told < 2; told++) {
        masu_governor g;
        start(&g, (masu_governor_desc){.dwell = 24});
        gpu p = gpu_of(10.0, 3);
        frames(&g, &p, 200);
        assert_int_equal(p.rung, 0);
        masu_governor_info before = report(&g);
        uint32_t worst = 0;
        for (uint32_t i = 0; i < 50; i++, p.frame++) { /* a level is being loaded */
            uint32_t rung =
                told ? masu_governor_hold(&g, p.frame) : masu_governor_pick(&g, p.frame);
            worst = rung > worst ? rung : worst;
            masu_governor_sample k = {.frame = p.frame,
                                      .rung = rung,
                                      .gpu_ms = 300.0 + i,
                                      .exclude_from_timing = (int)told};
            masu_governor_sample_in(&g, &k);
        }
        masu_governor_info after = report(&g);
        if (told) {
            assert_int_equal(worst, 0);
            assert_int_equal(after.reason, MASU_GOVERNOR_REASON_EXCLUDED);
            assert_int_equal(after.rejected, before.rejected + 50);
            assert_int_equal(after.missed, before.missed);
            assert_true(after.load_ms == before.load_ms);
            frames(&g, &p, 100);
            assert_int_equal(p.changes, 0);
        } else {
            assert_int_equal(worst, RUNGS - 1); /* without the exclusion it does fall */
        }
    }
}

/* ---- State ----------------------------------------------------------------------------------- */

/* Runs 300 frames at hd, then 120 in a new renderer, with `pixels` times the pixels. */
typedef struct handed {
    uint32_t next, first, missed;
} handed;

static handed hand_over(double load, uint64_t seed, VkExtent2D size, int with) {
    masu_governor old, g;
    masu_governor_state s;
    double pixels = (double)size.width * size.height / ((double)hd.width * hd.height);
    start(&old, (masu_governor_desc){.dwell = 24});
    gpu p = gpu_of(load, seed);
    frames(&old, &p, 300);
    masu_governor_export_state(&old, hd, &s);
    assert_int_equal(masu_governor_state_check(&s, NULL), MASU_OK);
    start(&g, (masu_governor_desc){.dwell = 24});
    if (with) masu_governor_import_state(&g, &s, size, 0);
    handed out = {.next = masu_governor_pick(&old, p.frame)};
    gpu q = gpu_of(load * pixels, seed + 1);
    q.fixed = 2.0 * 0.5 * (1.0 + pixels);
    out.first = frame(&g, &q);
    frames(&g, &q, 119);
    out.missed = q.missed;
    return out;
}

static void a_new_renderer_begins_where_the_old_one_was(void **state) {
    (void)state;
    uint32_t with = 0, without = 0, runs = 0;
    for (double load = 6.0; load < 45.0; load += 1.3) {
        for (uint64_t seed = 1; seed <= 5; seed++, runs++) {
            handed a = hand_over(load, seed, hd, 1), b = hand_over(load, seed, hd, 0);
            if (a.first != a.next)
                fail_msg("load %.1f, seed %u: rung %u, the old one's next was %u", load,
                         (unsigned)seed, a.first, a.next);
            with += a.missed;
            without += b.missed;
        }
    }
    if (with * 20 > without || without < 2 * runs)
        fail_msg("%u frames missed with a state, %u without, %u runs", with, without, runs);
}

static void it_is_scaled_by_pixels(void **state) {
    static const VkExtent2D sizes[] = {{1920, 1080}, {2560, 1440}, {960, 540}, {640, 360}};
    (void)state;
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t with = 0, without = 0, runs = 0;
        double wide = sizes[i].width / 1280.0;
        for (double load = 6.0; load < 40.0 / (wide * wide) && load < 40.0; load += 0.7, runs++) {
            with += hand_over(load, i + 1, sizes[i], 1).missed;
            without += hand_over(load, i + 1, sizes[i], 0).missed;
        }
        if (with > 4 || (i < 2 && without < 2 * runs))
            fail_msg("%u x %u: %u missed with a state, %u without", sizes[i].width, sizes[i].height,
                     with, without);
    }
    /* In one renderer: masu_resize. Frames of the old size that arrive later have no effect. */
    masu_governor g;
    start(&g, (masu_governor_desc){.dwell = 24});
    gpu p = gpu_of(10.0, 9);
    frames(&g, &p, 200);
    masu_governor_scale(&g, 4.0, p.frame);
    uint64_t rejected = g.rejected;
    p.load = 40.0;
    p.fixed = 5.0;
    p.missed = 0;
    frames(&g, &p, 100);
    assert_true(p.missed <= 1);
    assert_int_equal(g.rejected, rejected + 2);
}

/* The two best rungs are removed, one is new, one is different. */
static void other_rungs_take_what_is_theirs(void **state) {
    (void)state;
    masu_governor old, g;
    masu_governor_state s;
    start(&old, (masu_governor_desc){.dwell = 24});
    gpu p = gpu_of(22.0, 4);
    frames(&old, &p, 300);
    old.cost[4] *= 1.1;
    masu_governor_export_state(&old, hd, &s);
    masu_governor_rung ladder[RUNGS], other[RUNGS];
    ladder_of(ladder);
    memcpy(other, ladder + 2, 6 * sizeof *other);
    other[4].scale = 0.53;
    masu_governor_init(&g, &(masu_governor_desc){.mode = MASU_GOVERNOR_ON}, other, 6);
    masu_governor_import_state(&g, &s, hd, 0);
    assert_true(g.cost[2] == old.cost[4]);
    assert_true(fabs(g.cost[4] - 0.53 * 0.53) < 1e-12);
    uint32_t first = masu_governor_pick(&g, 0);
    assert_true(masu_governor_predict(&g, first) <= 16.67);
    assert_true(!first || masu_governor_predict(&g, first - 1) > 0.9 * 16.67);
    /* A governor without measurements saves nothing. */
    start(&old, (masu_governor_desc){.dwell = 24});
    masu_governor_export_state(&old, hd, &s);
    assert_int_equal(masu_governor_state_check(&s, NULL), MASU_OK);
    start(&g, (masu_governor_desc){.dwell = 24});
    masu_governor_import_state(&g, &s, hd, 0);
    assert_int_equal(g.known, 0);
}

static void garbage_is_no_state(void **state) {
    (void)state;
    masu_governor old;
    masu_governor_state good, s;
    masu_detail detail = {0};
    uint64_t random = 5;
    start(&old, (masu_governor_desc){.dwell = 24});
    gpu p = gpu_of(22.0, 4);
    frames(&old, &p, 300);
    masu_governor_export_state(&old, hd, &good);
    s = good;
    s.version++;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_VERSION);
    assert_string_equal(detail.what, "state.version");
    s = good;
    s.bytes -= 8;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_VERSION);
    s = good;
    s.load_ms = (double)NAN;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "state.load_ms");
    s = good;
    s.covariance = 1e6;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_ARGUMENT);
    s = good;
    s.rungs[2].cost = -1.0;
    assert_int_equal(masu_governor_state_check(&s, &detail), MASU_ERROR_ARGUMENT);
    uint32_t taken = 0;
    for (uint32_t i = 0; i < 200000; i++) { /* a few changed bits; then arbitrary bytes */
        s = good;
        unsigned char *bytes = (unsigned char *)&s;
        uint32_t flips = i % 100 ? 1 + i % 4 : sizeof s;
        for (uint32_t k = 0; k < flips; k++) {
            uint64_t at = support_random(&random);
            bytes[flips == sizeof s ? k : at % sizeof s] = (unsigned char)(at >> 40);
        }
        if (masu_governor_state_check(&s, &detail)) {
            assert_true(detail.text[0]);
            continue;
        }
        taken++;
        masu_governor g;
        start(&g, (masu_governor_desc){.best_rung = 1, .worst_rung = 5});
        masu_governor_import_state(&g, &s, hd, 0);
        gpu q = gpu_of(22.0, i);
        for (uint32_t f = 0; f < 8; f++) {
            uint32_t rung = frame(&g, &q);
            assert_true(rung >= 1 && rung <= 5);
        }
        masu_governor_info info = report(&g);
        assert_true(isfinite(info.load_ms) && isfinite(info.fixed_ms) &&
                    isfinite(info.start_delay_ms));
    }
    assert_true(taken > 1000);
}

/* ---- Overlapping frames ---------------------------------------------------------------------- */

/* A GPU that renders one frame after another, with `flight` frames submitted ahead. */
static void frames_in_flight_are_told_apart(void **state) {
    (void)state;
    for (uint32_t flight = 1; flight <= 3; flight++) {
        for (uint32_t reverse = 0; reverse < 2; reverse++) {
            masu_timeline t = {0};
            uint64_t now = 1000000, done[64] = {0}, submit[64], took[64];
            double twice = 0.0, whole = 0.0;
            masu_timeline_start(&t);
            for (uint32_t f = 0; f < 64; f++) {
                uint32_t slot = f % flight;
                if (f >= flight && done[f - flight] > now) now = done[f - flight]; /* the fence */
                for (uint32_t k = 0; f >= flight && k < flight; k++) { /* in any order, or again */
                    uint64_t of = f - flight + (reverse ? flight - 1 - k : k);
                    if (of > f - flight && done[of] > now) continue; /* not signalled yet */
                    t.slots[of % flight].submit_ns = submit[of];
                    t.slots[of % flight].done_ns = done[of];
                }
                if (f >= flight) {
                    double ms = masu_timeline_wall(&t, slot, flight);
                    double truth = (double)took[f - flight] * 1e-6;
                    if (fabs(ms - truth) > 1e-9)
                        fail_msg("flight %u, frame %u: %.3f ms, not %.3f", flight, f - flight, ms,
                                 truth);
                    twice += (double)(done[f - flight] - submit[f - flight]) * 1e-6;
                    whole += truth;
                }
                masu_timeline_begin(&t, slot, &(masu_slot){.rung = 0});
                submit[f] = now += 300000 + (f % 7) * 20000;
                took[f] = 9000000 + (f * 37 % 11) * 500000;
                uint64_t from = f && done[f - 1] > submit[f] ? done[f - 1] : submit[f];
                done[f] = from + took[f];
            }
            if (flight > 1) assert_true(twice > 1.8 * whole); /* the time from submission to end */
        }
    }
}

static void an_unknown_end_is_no_time(void **state) {
    (void)state;
    masu_timeline t = {0};
    masu_timeline_start(&t);
    for (uint32_t f = 0; f < 6; f++) {
        double ms = f < 2 ? 0.0 : masu_timeline_wall(&t, f % 2, 2);
        /* of frame f - 2; 1 was not reported, and neither was 2 */
        static const double truth[] = {0, 0, 10, 0, 0, 10};
        assert_true(fabs(ms - truth[f]) < 1e-9);
        masu_timeline_begin(&t, f % 2, &(masu_slot){.rung = 0});
        if (f == 1) continue;
        t.slots[f % 2].submit_ns = 1 + f * 10000000u;
        t.slots[f % 2].done_ns = 1 + (f + 1) * 10000000u;
    }
    t.slots[0] = (masu_slot){.frame = 6, .wall_ms = 7.0}; /* only masu_frame_wall still works */
    assert_true(masu_timeline_wall(&t, 0, 2) == 7.0);
    assert_true(masu_timeline_wall(&t, 0, 2) == 0.0);
}

/* ---- The host's own work --------------------------------------------------------------------- */

typedef struct cpu_case {
    double cpu, load; /* ms of the host, of pixels at scale 1 */
    int stamps, told;
} cpu_case;

static masu_governor_info run_cpu(const cpu_case *c) {
    masu_governor g;
    start(&g, (masu_governor_desc){.dwell = 24});
    for (uint64_t f = 0; f < 400; f++) {
        uint32_t rung = masu_governor_pick(&g, f);
        double s = g.scale[rung], ms = (2.0 + c->load * s * s) * (1.0 + 0.004 * (double)(f % 3));
        double cpu = c->cpu * (1.0 + 0.003 * (double)(f % 4));
        masu_governor_sample k = {.frame = f,
                                  .rung = rung,
                                  .gpu_ms = c->stamps ? ms : 0.0,
                                  /* the fence is checked when the host arrives */
                                  .wall_ms = ms > cpu ? ms : cpu,
                                  .cpu_ms = c->told ? cpu : 0.0};
        masu_governor_sample_in(&g, &k);
    }
    return report(&g);
}

static void the_hosts_work_drives_no_rung_down(void **state) {
    (void)state;
    for (int stamps = 0; stamps < 2; stamps++) {
        masu_governor_info info = run_cpu(&(cpu_case){30.0, 8.0, stamps, 1});
        assert_int_equal(info.rung, 0);
        assert_int_equal(info.changes, 0);
        assert_int_equal(info.missed, 0);
        assert_int_equal(info.locked, MASU_GOVERNOR_LOCKED_CPU);
        assert_true(fabsf(info.cpu_ms - 30.0f) < 0.3f);
        info = run_cpu(&(cpu_case){30.0, 8.0, stamps, 0}); /* the feature is needed */
        assert_true(info.changes > 0);
        /* With a slower GPU it works as before, as it does with a fast host. */
        info = run_cpu(&(cpu_case){30.0, 100.0, stamps, 1});
        assert_true(info.rung > 3);
        info = run_cpu(&(cpu_case){5.0, 24.0, stamps, 1});
        assert_true(info.rung > 1 && info.locked == MASU_GOVERNOR_FREE);
    }
    masu_governor_info info = run_cpu(&(cpu_case){30.0, 8.0, 1, 1});
    assert_int_equal(info.source, MASU_GOVERNOR_SOURCE_GPU); /* not caused by timestamps */
}

/* ---- The display ----------------------------------------------------------------------------- */

#define HZ60 16666667u

/* Shows each frame at the first refresh after it is ready. Returns the number of changes of the
 * refresh count. */
static uint32_t show(masu_governor *g, gpu *p, uint64_t refresh, uint64_t *at, uint32_t count,
                     double wave) {
    uint32_t last = g->pacing.refreshes, changes = 0;
    double load = p->load;
    for (uint32_t i = 0; i < count; i++) {
        p->load = load * (p->frame / 40 % 2 ? 1.0 + wave : 1.0 - wave);
        frame(g, p);
        uint32_t due = g->pacing.refreshes ? g->pacing.refreshes : 1;
        uint32_t needs = (uint32_t)ceil(p->ms * 1e6 / (double)refresh - 1e-9);
        *at += (needs > due ? needs : due) * refresh;
        /* The frame's own time is the refresh count of the previous one: close enough for a
         * simulated display. */
        masu_governor_shown(g, p->frame - 1, *at, refresh);
        changes += last && g->pacing.refreshes != last;
        last = g->pacing.refreshes;
    }
    p->load = load;
    return changes;
}

static void frames_are_shown_for_whole_refreshes(void **state) {
    static const struct {
        float target;
        uint32_t refresh, refreshes;
        double load;
    } cases[] = {{16.67f, HZ60, 1, 12.0},     {16.67f, 8333333, 2, 12.0}, {33.3f, HZ60, 2, 12.0},
                 {50.0f, HZ60, 3, 12.0},      {16.67f, HZ60, 2, 90.0},    {8.0f, HZ60, 1, 12.0},
                 {16.67f, 15800000, 2, 12.0}, {16.67f, 16000000, 1, 24.0}};
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_governor g;
        start(&g, (masu_governor_desc){.target_ms = cases[i].target});
        gpu p = gpu_of(cases[i].load, i);
        uint64_t at = 0;
        assert_int_equal(report(&g).refreshes, 0);
        show(&g, &p, cases[i].refresh, &at, 300, 0.0);
        masu_governor_info info = report(&g);
        if (info.refreshes != cases[i].refreshes)
            fail_msg("case %u: %u refreshes", (unsigned)i, info.refreshes);
        double interval = info.refreshes * cases[i].refresh * 1e-6;
        double delay = interval - (double)info.predicted_ms[info.rung];
        assert_true((double)info.start_delay_ms <= delay &&
                    (double)info.start_delay_ms > delay - 2.0);
        masu_governor_shown(&g, p.frame - 1, at + 1, 0); /* no longer available */
        frame(&g, &p);
        assert_int_equal(report(&g).refreshes, 0);
    }
}

/* At the worst rung, a load that crosses one refresh every 40 frames, up and down. */
static void refreshes_do_not_alternate(void **state) {
    (void)state;
    masu_governor g;
    start(&g, (masu_governor_desc){.best_rung = RUNGS - 1});
    gpu p = gpu_of(14.5 / (0.44 * 0.44), 3);
    uint64_t at = 0;
    show(&g, &p, HZ60, &at, 100, 0.2);
    uint32_t changes = show(&g, &p, HZ60, &at, 3000, 0.2);
    assert_int_equal(changes, 0);
    assert_int_equal(report(&g).refreshes, 2);
    p.load *= 0.6;
    changes = show(&g, &p, HZ60, &at, 400, 0.0);
    assert_int_equal(changes, 1);
    assert_int_equal(report(&g).refreshes, 1);
}

static void missed_frames_are_those_shown_late(void **state) {
    (void)state;
    masu_governor g;
    start(&g, (masu_governor_desc){.dwell = 24});
    gpu p = gpu_of(8.0, 5);
    uint64_t at = 0;
    show(&g, &p, HZ60, &at, 50, 0.0);
    uint64_t missed = report(&g).missed;
    for (uint32_t i = 0; i < 100; i++) {
        frame(&g, &p);
        at += HZ60 * (i % 20 == 7 ? 2 : 1) + i % 3 * 100000;
        masu_governor_shown(&g, p.frame - 1, at, HZ60);
    }
    assert_int_equal(report(&g).missed, missed + 5);
    for (uint32_t i = 0; i < 5; i++) frame(&g, &p); /* five frames without a report */
    masu_governor_shown(&g, p.frame - 1, at + 5 * (uint64_t)HZ60, HZ60);
    assert_int_equal(report(&g).missed, missed + 5);
    masu_governor_shown(&g, p.frame - 1, at + 50 * (uint64_t)HZ60, HZ60); /* reported twice */
    masu_governor_shown(&g, p.frame - 3, at + 50 * (uint64_t)HZ60, HZ60); /* out of order */
    assert_int_equal(report(&g).missed, missed + 5);
    p.load = 60.0; /* with a display, only its reports add misses */
    frames(&g, &p, 3);
    assert_int_equal(report(&g).missed, missed + 5);
}

/* ---- Clocks ---------------------------------------------------------------------------------- */

static void it_is_not_kept_low_by_a_low_clock(void **state) {
    static const char *const models[] = {"dvfs_steps", "dvfs_ondemand", "dvfs_slow", "dvfs_light"};
    static sim_frame out[SIM_FRAMES_MOST];
    (void)state;
    for (uint32_t i = 0; i < 4; i++) {
        for (uint64_t seed = 1; seed <= 20; seed++) {
            const sim_model *p = sim_find(models[i]);
            sim_model late = *p;
            late.load = NULL;
            late.a = p->b;
            double best = sim_oracle(&late), scale = 0.0;
            sim_result r = sim_run(p, &sim_masu, seed, out, NULL);
            uint32_t changes = 0;
            for (uint32_t f = 3000; f < 4000; f++) {
                scale += out[f].scale / 1000.0;
                changes += out[f].rung != out[f - 1].rung;
            }
            if (scale < 0.93 * best || changes > 2 || r.over > 40)
                fail_msg("%s, seed %u: scale %.3f of %.3f, %u changes, %u over", models[i],
                         (unsigned)seed, scale, best, changes, r.over);
        }
    }
}

/* If the clock does not follow, a trial is undone, and trials become rarer. */
static void trials_are_few(void **state) {
    (void)state;
    uint32_t tried = 0;
    for (uint32_t i = 0; i < 60; i++) {
        for (int steady = 0; steady < 2; steady++) {
            masu_governor g;
            start(&g, (masu_governor_desc){.steady_clock = (uint32_t)steady});
            gpu p = gpu_of(16.0 + 0.4 * i, i + 1);
            frames(&g, &p, 1000);
            p.changes = p.missed = 0;
            frames(&g, &p, 19000);
            if (p.changes > (steady ? 0 : 6) || p.missed > p.changes / 2 * 16)
                fail_msg("load %.1f: %u changes, %u missed", p.load, p.changes, p.missed);
            tried += p.changes / 2;
        }
    }
    assert_true(tried > 30);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_setting_counts_from_the_next_frame_on),
        cmocka_unit_test(a_rung_is_held_for_eight_frames),
        cmocka_unit_test(unusual_frames_say_nothing),
        cmocka_unit_test(a_new_renderer_begins_where_the_old_one_was),
        cmocka_unit_test(it_is_scaled_by_pixels),
        cmocka_unit_test(other_rungs_take_what_is_theirs),
        cmocka_unit_test(garbage_is_no_state),
        cmocka_unit_test(frames_in_flight_are_told_apart),
        cmocka_unit_test(an_unknown_end_is_no_time),
        cmocka_unit_test(the_hosts_work_drives_no_rung_down),
        cmocka_unit_test(frames_are_shown_for_whole_refreshes),
        cmocka_unit_test(refreshes_do_not_alternate),
        cmocka_unit_test(missed_frames_are_those_shown_late),
        cmocka_unit_test(it_is_not_kept_low_by_a_low_clock),
        cmocka_unit_test(trials_are_few),
    };
    return cmocka_run_group_tests_name("governor_host", tests, NULL, NULL);
}

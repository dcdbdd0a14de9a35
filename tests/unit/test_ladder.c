/* test_ladder.c: measured ladders: the built-in tables, the ladder of each scene class, the rungs
 * of a description, and files of masu bench read back, complete and damaged. No test depends on the
 * measured numbers. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <glob.h>

#include "settings/knobs.h"
#include "settings/ladder.h"
#include "settings/ladder_file.h"
#include "bench/costs.h"
#include "bench/settings.h"
#include "bench/sweep.h"
#include "image.h"
#include "quality/ladder.h"
#include "plan/compile.h"
#include "plan/desc.h"
#include "support/desc.h"
#include "support/files.h"
#include "support/random.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static masu_frame_plan plan; /* large */

static void compile(const masu_desc *d) {
    masu_detail detail;
    if (masu_compile(d, 256, 64, &plan, &detail)) fail_msg("rejected: %s", detail.text);
}

/* ---- Classes and tables ---------------------------------------------------------------------- */

static void scenes_have_the_class_of_what_they_are_made_of(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        assert_int_equal(masu_scene_class_of(masu_scene_of(&s)), c);
        const char *name = masu_scene_class_name((masu_scene_class)c);
        for (uint32_t k = 0; k < c; k++)
            assert_string_not_equal(name, masu_scene_class_name((masu_scene_class)k));
        /* Only additional LODs or occluders make no world, and neither do both with an SDF. */
        if (c % 4 == MASU_SCENE_WORLD) {
            s.lods = 0;
            assert_int_equal(masu_scene_class_of(masu_scene_of(&s)), c - 1);
            s.lods = 1, s.placed_occluders = 0;
            assert_int_equal(masu_scene_class_of(masu_scene_of(&s)), c - 1);
            s.placed_occluders = 1, s.sdf = 1;
            assert_int_equal(masu_scene_class_of(masu_scene_of(&s)), c + 2);
        }
        if (c >= 4) { /* nothing is glossy enough: the plan traces nothing either */
            s = scene_of_class(c);
            s.glossiest = s.specular_cutoff;
            assert_int_equal(masu_scene_class_of(masu_scene_of(&s)), c - 4);
        }
    }
    assert_int_equal(masu_scene_class_of(NULL), MASU_SCENE_POLYGONS);
    assert_non_null(masu_scene_class_name((masu_scene_class)99));
}

static void tables_are_well_formed(void **state) {
    (void)state;
    static const masu_rung zero;
    uint32_t measured = 0;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        const masu_ladder *l = masu_ladder_of_class((masu_scene_class)c);
        masu_scene_data s = scene_of_class(c);
        s.shadow_cascades = 4, s.shadow_resolution = 512, s.shadow_distance = 50.0f;
        s.occlusion_radius = 1.0f;
        measured += l->count > 0;
        assert_true(l->count <= MASU_MAX_RUNGS);
        assert_true(!l->count || (l->from && strlen(l->from) > 20));
        masu_desc d = scene_desc(RASTER, 640, 360);
        d.scene = masu_scene_of(&s);
        d.rung_count = l->count;
        for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++) {
            const masu_rung *rung = &l->rungs[r];
            if (r >= l->count) {
                for (const masu_knob *k = masu_knob_table(); k->name; k++)
                    assert_false(masu_knob_differs(k, rung, &zero));
                continue;
            }
            assert_true(l->ratios[r] > 0 && l->flips[r] >= 0 && l->flips[r] <= 1);
            if (r)
                assert_true((double)l->ratios[r - 1] >=
                            MASU_LADDER_APART * (double)l->ratios[r] * (1 - 1e-5));
            if (r) assert_true(l->flips[r] > l->flips[r - 1]);
            /* Features that some devices or blobs lack are not built in. */
            assert_true(rung->specular != MASU_ON && rung->occlusion != MASU_ON);
            assert_true(rung->scale > 0 && rung->upscale != MASU_OFF);
            assert_true(rung->shadow_distance <= 0 && rung->specular_cutoff <= 0);
            d.rungs[r] = *rung;
        }
        if (l->count) compile(&d); /* every knob is in its range */
    }
    assert_true(measured >= 1);
}

/* On a class of GPUs a worse rung that is not cheaper is useless. */
static void on_every_class_of_gpus_a_worse_rung_is_cheaper(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        const masu_ladder *l = masu_ladder_of_class((masu_scene_class)c);
        for (int k = MASU_DEVICE_OTHER + 1; k < MASU_DEVICE_CLASSES && l->count; k++) {
            const float *costs = masu_ladder_costs_on(masu_scene_of(&s), (masu_device_class)k);
            assert_non_null(costs);
            for (uint32_t r = 1; r < l->count; r++) {
                if (!(costs[r] < costs[r - 1]))
                    fail_msg("%s on %s: rung %u costs %.4f, rung %u %.4f",
                             masu_scene_class_name((masu_scene_class)c),
                             masu_device_class_name((masu_device_class)k), r - 1,
                             (double)costs[r - 1], r, (double)costs[r]);
            }
        }
    }
}

/* docs/report/NAME of a ladder, whose `from` begins with NAME.masu. */
static void report_of(const masu_ladder *l, const char *file, char out[512]) {
    size_t n = strcspn(l->from, ".");
    assert_true(n > 0 && n < 64);
    snprintf(out, 512, "docs/report/%.*s%s%s", (int)n, l->from, *file ? "/" : "", file);
}

/* Compared with all measured settings, not only with the ladder: none has a lower error than a rung
 * and is cheaper on one of the classes. */
static void no_setting_dominates_a_rung_on_a_class_of_gpus(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        const masu_ladder *l = masu_ladder_of_class((masu_scene_class)c);
        char path[512], error[1024] = "";
        uint32_t count = 0, compared = 0;
        static masu_ladder_file f;
        bool there = false;
        if (!l->count) continue;
        report_of(l, "ladder.json", path);
        if (!masu_ladder_read(path, &f, error, sizeof error)) fail_msg("%s", error);
        assert_int_equal(f.count, l->count);
        report_of(l, "", path);
        masu_row *rows = masu_sweep_rows(path, &count, error, sizeof error);
        if (!rows) fail_msg("%s", error);
        double *costs = calloc(count + 1, sizeof *costs * MASU_COSTS_CLASSES);
        assert_non_null(costs);
        if (!masu_costs_read(path, rows, count, costs, &there, error, sizeof error))
            fail_msg("%s", error);
        if (!there) fail_msg("%s: no " MASU_COSTS, path);
        for (uint32_t r = 0; r < f.count; r++) {
            const masu_row *rung = masu_rows_find(rows, count, f.settings[r]);
            if (!rung) fail_msg("%s: rung %u has no row", path, r);
            for (uint32_t i = 0; i < count; i++) {
                for (uint32_t k = 0; k < MASU_COSTS_CLASSES; k++) {
                    const double own = costs[MASU_COSTS_CLASSES * (size_t)(rung - rows) + k],
                                 other = costs[MASU_COSTS_CLASSES * i + k];
                    assert_true(own > 0.0);
                    compared += other > 0.0;
                    if (masu_ladder_dominates((masu_ladder_point){other, masu_row_error(&rows[i])},
                                              (masu_ladder_point){own, masu_row_error(rung)}))
                        fail_msg("%s: rung %u, %s, is dominated by %s on class %u", path, r,
                                 f.settings[r], rows[i].setting, k);
                }
            }
        }
        assert_true(compared > MASU_COSTS_CLASSES * f.count * f.count);
        free(costs);
        free(rows);
    }
}

static void no_step_between_rungs_is_a_jump(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        const masu_ladder *l = masu_ladder_of_class((masu_scene_class)c);
        char path[512], error[1024];
        static masu_ladder_file f;
        if (!l->count) continue;
        report_of(l, "ladder.json", path);
        if (!masu_ladder_read(path, &f, error, sizeof error)) fail_msg("%s", error);
        for (uint32_t r = 1; r < f.count; r++) {
            if (!(f.steps[r] > 0.0)) fail_msg("%s: rung %u has no step", path, r);
            if (f.steps[r] > MASU_LADDER_STEP)
                fail_msg("%s: rung %u changes %.2f of 255", path, r, f.steps[r]);
        }
    }
}

static void every_class_has_the_nearest_ladder(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        const masu_ladder *l = masu_ladder_for(masu_scene_of(&s)),
                          *own = masu_ladder_of_class((masu_scene_class)c);
        assert_true(l && l->count >= 1);
        if (own->count) assert_ptr_equal(l, own);
        /* From a class with the same reflections, if there is one. */
        uint32_t alike = 0, taken = 0;
        for (uint32_t k = c / 4 * 4; k < c / 4 * 4 + 4; k++) {
            const masu_ladder *o = masu_ladder_of_class((masu_scene_class)k);
            alike |= o->count > 0;
            taken |= o == l;
        }
        assert_int_equal(alike, taken);
    }
}

/* ---- Descriptions ---------------------------------------------------------------------------- */

static void assert_ladder(const masu_desc *d, const masu_ladder *l) {
    assert_int_equal(d->rung_count, l->count);
    for (uint32_t r = 0; r < l->count; r++) {
        const masu_rung *is = &d->rungs[r], *row = &l->rungs[r]; /* which has enum values at AUTO */
        assert_true(is->scale == row->scale && is->sharpness == row->sharpness);
        assert_true(is->easu == row->easu || (!row->easu && is->easu == MASU_EASU_FULL));
        if (row->specular) assert_int_equal(is->specular, row->specular);
        assert_int_not_equal(is->specular, MASU_ON);
        assert_true(d->flips[r] == l->flips[r] && d->governor.costs[r] == l->ratios[r]);
    }
}

static void assert_three(const masu_desc *d) {
    assert_int_equal(d->rung_count, 3);
    assert_true(d->rungs[0].scale == 1.0f && d->rungs[1].scale == 0.8f &&
                d->rungs[2].scale == 0.4f);
    for (uint32_t r = 0; r < MASU_MAX_RUNGS; r++)
        assert_true(d->flips[r] == 0.0f && d->governor.costs[r] == 0.0f);
}

static void the_switch_says_which_rungs(void **state) {
    (void)state;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        const masu_ladder *l = masu_ladder_for(masu_scene_of(&s));
        masu_desc d = scene_desc(RASTER, 640, 360), is;
        d.scene = masu_scene_of(&s);
        is = masu_desc_resolved(&d);
        assert_three(&is);
        assert_int_equal(is.ladder, MASU_OFF);
        d.ladder = MASU_ON;
        is = masu_desc_resolved(&d);
        assert_ladder(&is, l);
        is = masu_desc_resolved(&is); /* once more changes nothing */
        assert_ladder(&is, l);
        assert_int_equal(is.ladder, MASU_ON);
        d.ladder = MASU_AUTO;
        d.governor.mode = MASU_GOVERNOR_ON;
        is = masu_desc_resolved(&d);
        assert_ladder(&is, l);
        assert_int_equal(is.governor.worst_rung, l->count - 1);
        compile(&d);
        assert_ladder(&plan.desc, l);
        static masu_plan_info info;
        masu_plan_export(&plan, NULL, &info);
        for (uint32_t r = 0; r < l->count; r++) {
            assert_true(info.rungs[r].ratio == l->ratios[r] && info.rungs[r].flip == l->flips[r]);
        }
        /* Like `temporal` at AUTO: not with several views, or host passes. */
        for (uint32_t k = 0; k < 2; k++) {
            d.split = k ? MASU_SPLIT_BEFORE_TONE : 0;
            d.viewport_count = k ? 0 : 2;
            is = masu_desc_resolved(&d);
            assert_ladder(&is, l);
            for (uint32_t r = 0; r < l->count; r++)
                assert_int_equal(is.rungs[r].temporal, MASU_OFF);
        }
        d.viewport_count = 0;
        d.split = MASU_SPLIT_AFTER_UPSCALE;
        is = masu_desc_resolved(&d);
        for (uint32_t r = 0; r < l->count; r++)
            assert_int_equal(is.rungs[r].temporal == MASU_ON, l->rungs[r].temporal == MASU_ON);
        d.split = 0;
        d.governor.mode = MASU_GOVERNOR_FIXED;
        is = masu_desc_resolved(&d);
        assert_ladder(&is, l);
        d.ladder = MASU_OFF;
        is = masu_desc_resolved(&d);
        assert_three(&is);
    }
    masu_desc d = source_desc(640, 360);
    d.rung_count = 0;
    d.ladder = MASU_ON;
    masu_desc is = masu_desc_resolved(&d);
    assert_three(&is);
}

static void what_the_host_gives_wins(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER | SDF, 640, 360);
    masu_ladder l = *masu_ladder_for(d.scene);
    d.ladder = MASU_ON;
    d.governor.costs[0] = l.ratios[0] = 3.5f;
    masu_desc is = masu_desc_resolved(&d);
    assert_ladder(&is, &l); /* that cost, and the table's others */
    d.rung_count = 2;
    d.rungs[1].scale = 0.7f;
    d.flips[1] = 0.25f;
    compile(&d);
    assert_int_equal(plan.desc.rung_count, 2);
    assert_true(plan.desc.rungs[1].scale == 0.7f && plan.desc.governor.costs[0] == 3.5f);
    assert_true(plan.desc.governor.costs[1] == 0.0f && plan.desc.flips[0] == 0.0f);
    static masu_plan_info info;
    masu_plan_export(&plan, NULL, &info);
    assert_true(info.rungs[0].ratio == 3.5f && info.rungs[1].flip == 0.25f);
    assert_true(info.rungs[1].ratio == 0.0f && info.rungs[0].flip == 0.0f);

    masu_detail detail;
    static const float bad[] = {-0.1f, 1.5f, NAN, INFINITY};
    for (size_t i = 0; i < COUNT(bad); i++) {
        d.flips[1] = bad[i];
        assert_int_equal(masu_compile(&d, 256, 64, &plan, &detail), MASU_ERROR_ARGUMENT);
        assert_string_equal(detail.what, "flips");
    }
    d.flips[1] = 0;
    d.ladder = (masu_switch)3;
    assert_int_equal(masu_compile(&d, 256, 64, &plan, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "ladder");
}

static void a_host_may_take_it_and_change_it(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER | SDF, 640, 360), own = d;
    const char *from = NULL;
    assert_int_equal(masu_ladder_of(NULL, &own, &from, NULL), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_ladder_of(d.scene, NULL, &from, NULL), MASU_ERROR_ARGUMENT);
    assert_null(from);
    own.governor.costs[0] = 9.0f; /* for another ladder */
    own.rungs[7].scale = 0.1f;
    assert_int_equal(masu_ladder_of(d.scene, &own, &from, NULL), MASU_OK);
    assert_ladder(&own, masu_ladder_for(d.scene));
    assert_non_null(from);
    assert_int_equal(masu_ladder_of(d.scene, &own, NULL, NULL), MASU_OK);
    own.rungs[0].aa = MASU_AA_SMAA_HIGH;
    compile(&own);
    assert_int_equal(plan.desc.rungs[0].aa, MASU_AA_SMAA_HIGH);
    /* Unchanged, it is the ladder that ON uses. */
    d.ladder = MASU_ON;
    masu_desc is = masu_desc_resolved(&d);
    assert_int_equal(masu_ladder_of(d.scene, &own, NULL, NULL), MASU_OK);
    own = masu_desc_resolved(&own);
    for (uint32_t r = 0; r < is.rung_count; r++) {
        for (const masu_knob *k = masu_knob_table(); k->name; k++)
            assert_false(masu_knob_differs(k, &own.rungs[r], &is.rungs[r]));
    }
}

static void no_rung_drops_a_feature_to_keep(void **state) {
    (void)state;
    static const masu_ladder made = {.count = 4,
                                     .rungs = {{.scale = 1.0f},
                                               {.scale = 0.75f, .specular = MASU_OFF},
                                               {.scale = 0.5f, .ao = MASU_OFF},
                                               {.scale = 0.4f}}};
    static const uint32_t kept[MASU_KEEP_ALL + 1][5] = {
        [0] = {0, 1, 2, 3, 4},
        [MASU_KEEP_REFLECTIONS] = {0, 2, 3, 4, 4},
        [MASU_KEEP_OCCLUSION] = {0, 1, 3, 4, 4},
        [MASU_KEEP_ALL] = {0, 3, 4, 4, 4},
    };
    for (uint32_t keep = 0; keep <= MASU_KEEP_ALL; keep++) {
        for (uint32_t n = 0; n < 5; n++)
            assert_int_equal(masu_ladder_kept(&made, keep, n), kept[keep][n]);
    }
    uint32_t omitted = 0;
    for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
        masu_scene_data s = scene_of_class(c);
        const masu_ladder *l = masu_ladder_for(masu_scene_of(&s));
        for (uint32_t keep = 0; keep <= MASU_KEEP_ALL; keep++) {
            masu_desc d = scene_desc(RASTER, 640, 360);
            d.scene = masu_scene_of(&s);
            d.ladder = MASU_ON;
            d.governor.keep = keep;
            masu_desc is = masu_desc_resolved(&d);
            uint32_t n = 0;
            for (uint32_t r = 0; r < l->count; r++) {
                const masu_rung *rung = &l->rungs[r];
                if ((keep & MASU_KEEP_REFLECTIONS && rung->specular == MASU_OFF) ||
                    (keep & MASU_KEEP_OCCLUSION && rung->ao == MASU_OFF)) {
                    omitted++;
                    continue;
                }
                assert_true(is.rungs[n].scale == rung->scale && is.flips[n] == l->flips[r]);
                assert_true(is.governor.costs[n] == l->ratios[r]);
                n++;
            }
            assert_true(n > 0 && n == is.rung_count);
            assert_true(n == MASU_MAX_RUNGS || is.governor.costs[n] == 0.0f);
            compile(&d);
            /* And the host's own rungs. */
            d.rung_count = 2;
            d.rungs[1].ao = keep & MASU_KEEP_OCCLUSION ? MASU_OFF : MASU_AUTO;
            d.rungs[1].specular = keep == MASU_KEEP_REFLECTIONS ? MASU_OFF : MASU_AUTO;
            masu_detail detail;
            int wrong = keep & MASU_KEEP_OCCLUSION || (keep && c >= 4);
            assert_int_equal(masu_compile(&d, 256, 64, &plan, &detail),
                             wrong ? MASU_ERROR_ARGUMENT : MASU_OK);
            if (wrong) assert_string_equal(detail.what, "governor.keep");
            if (wrong)
                assert_non_null(strstr(
                    detail.text, keep & MASU_KEEP_OCCLUSION ? "rungs[1].ao" : "rungs[1].specular"));
        }
    }
    /* Dropping all reflections at once would be a jump: no built-in ladder does it. */
    assert_int_equal(omitted, 0);
    masu_desc d = scene_desc(RASTER, 640, 360);
    masu_detail detail;
    d.governor.keep = MASU_KEEP_ALL + 1;
    assert_int_equal(masu_compile(&d, 256, 64, &plan, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "governor.keep");
}

/* ---- Every scene, every ladder --------------------------------------------------------------- */

/* In a plan of the whole ladder each image has the largest size that a rung needs, not the sum. */
static void check_shared(const masu_desc *whole) {
    static struct {
        uint32_t width, height;
        int used;
    } most[MASU_IMAGE_COUNT];
    memset(most, 0, sizeof most);
    masu_desc is = masu_desc_resolved(whole);
    for (uint32_t r = 0; r < is.rung_count; r++) {
        masu_desc one = is;
        one.rung_count = 1;
        one.rungs[0] = is.rungs[r];
        one.governor = (masu_governor_desc){0};
        compile(&one);
        for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
            const masu_image_plan *p = &plan.images[i];
            most[i].used |= p->used;
            if (most[i].width < p->width) most[i].width = p->width;
            if (most[i].height < p->height) most[i].height = p->height;
        }
    }
    compile(whole);
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        assert_int_equal(plan.images[i].used, most[i].used);
        /* Images kept for the next frame have the size of the largest rung that traces, whichever
         * rung reads them. */
        const uint32_t k = masu_images[i].kept ? MASU_IMAGE_SPECULAR_HISTORY_GUIDE : i;
        assert_true(plan.images[i].width >= most[i].width &&
                    plan.images[i].height >= most[i].height);
        assert_true(plan.images[i].width <= most[k].width || plan.images[i].width == most[i].width);
        assert_true(plan.images[i].height <= most[k].height ||
                    plan.images[i].height == most[i].height);
    }
}

static void every_ladder_fits_every_baked_scene(void **state) {
    (void)state;
    char pattern[512], error[1024];
    glob_t found;
    uint32_t scenes = 0, classes = 0;
    snprintf(pattern, sizeof pattern, "%s/scenes/*.masu", made_dir());
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        uint8_t *bytes;
        size_t size;
        masu_scene s;
        masu_detail detail;
        if (!masu_file_read(found.gl_pathv[i], 64u << 20, &bytes, &size, error, sizeof error))
            fail_msg("%s", error);
        if (masu_scene_bind(bytes, size, &s, &detail))
            fail_msg("%s: %s", found.gl_pathv[i], detail.text);
        scenes++;
        classes |= 1u << masu_scene_class_of(&s);
        for (uint32_t c = 0; c < MASU_SCENE_CLASSES; c++) {
            const masu_ladder *l = masu_ladder_of_class((masu_scene_class)c);
            masu_desc d = scene_desc(RASTER, 320, 180);
            d.scene = &s;
            d.rung_count = l->count;
            memcpy(d.rungs, l->rungs, sizeof d.rungs);
            if (l->count) compile(&d);
        }
        masu_desc own = scene_desc(RASTER, 320, 180);
        own.scene = &s;
        own.ladder = MASU_ON;
        check_shared(&own);
        free(bytes);
    }
    globfree(&found);
    assert_true(scenes >= 20);
    assert_int_equal(classes &
                         (1u << MASU_SCENE_POLYGONS | 1u << MASU_SCENE_SDF | 1u << MASU_SCENE_BOTH),
                     1u << MASU_SCENE_POLYGONS | 1u << MASU_SCENE_SDF | 1u << MASU_SCENE_BOTH);
}

/* A rung that sets every knob that a scene of only walls, or only a field, does not use. */
static void what_a_scene_lacks_is_ignored(void **state) {
    (void)state;
    static const masu_rung wish = {.scale = 0.5f,
                                   .occlusion = MASU_ON,
                                   .lod_error = 3.0f,
                                   .ao = MASU_ON,
                                   .ao_slices = 1,
                                   .ao_steps = 4,
                                   .shadow_cascades = 2,
                                   .shadow_resolution = 256,
                                   .shadow_distance = 10.0f,
                                   .shadow_refresh = {2, 4, 8, 8},
                                   .light_tiles = MASU_ON,
                                   .local_shadows = MASU_ON,
                                   .local_shadow_atlas = 2048,
                                   .local_shadow_lights = 16,
                                   .local_shadow_faces = 4,
                                   .specular = MASU_ON,
                                   .specular_cutoff = 0.9f,
                                   .specular_reuse = MASU_ON,
                                   .specular_temporal = MASU_ON,
                                   .specular_fine = MASU_ON,
                                   .specular_filter = MASU_ON,
                                   .specular_taa = MASU_ON,
                                   .specular_reuse_taps = 4,
                                   .specular_filter_taps = 6,
                                   .specular_frames = 16};
    for (uint32_t parts = RASTER; parts <= (RASTER | SDF); parts++) {
        masu_desc d = scene_desc(parts, 640, 360);
        static masu_frame_plan plain;
        d.rung_count = 1;
        d.rungs[0].scale = 0.5f;
        compile(&d);
        plain = plan;
        d.rungs[0] = wish;
        if (!(parts & SDF)) d.rungs[0].march_steps = 64;
        compile(&d);
        assert_memory_equal(&plan.rungs[0].active, &plain.rungs[0].active,
                            sizeof plan.rungs[0].active);
        assert_int_equal(plan.recordings, plain.recordings);
        for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
            assert_int_equal(plan.images[i].used, plain.images[i].used);
            assert_int_equal(plan.images[i].width, plain.images[i].width);
            assert_int_equal(plan.images[i].persistent, plain.images[i].persistent);
        }
    }
}

/* ---- Files ----------------------------------------------------------------------------------- */

enum { TEXT_ROOM = 32768 };
static char text[TEXT_ROOM];

/* A ladder.json as masu bench writes it. */
static size_t written(const masu_rung *rungs, uint32_t count) {
    size_t n = (size_t)snprintf(
        text, sizeof text,
        "{\"scene\": \"a.masu\", \"hash\": \"00\", \"driver\": \"D 1.0\", \"width\": 320, "
        "\"height\": 180, \"time\": 1.0, \"clock\": \"wall\", \"error\": \"flip\", \"rungs\": [");
    for (uint32_t r = 0; r < count; r++) {
        n += (size_t)snprintf(text + n, sizeof text - n,
                              "%s{\"setting\": \"s%u\", \"ratio\": %.3f, \"wall_ms\": 5.0, "
                              "\"gpu_ms\": 0.0, \"flip\": %.3f, \"rmse\": %u.5, \"knobs\": {",
                              r ? ", " : "", r, r < 8 ? 1.0 - 0.1 * r : 0.3 - 0.02 * r,
                              r < 8 ? 0.1 + 0.1 * r : 0.8 + 0.01 * r, r);
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            char value[64];
            masu_knob_json(k, &rungs[r], value, sizeof value);
            n += (size_t)snprintf(text + n, sizeof text - n, "%s\"%s\": %s",
                                  k > masu_knob_table() ? ", " : "", k->name, value);
        }
        n += (size_t)snprintf(text + n, sizeof text - n, "}}");
    }
    n += (size_t)snprintf(text + n, sizeof text - n, "]}");
    assert_true(n < sizeof text);
    return n;
}

static void check_round_trip(const masu_rung *rungs, uint32_t count) {
    static masu_ladder_file f;
    char error[1024] = "";
    size_t n = written(rungs, count);
    if (!masu_ladder_parse("l.json", text, n, &f, error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(f.count, count);
    for (uint32_t r = 0; r < count; r++) {
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            if (masu_knob_differs(k, &rungs[r], &f.rungs[r]))
                fail_msg("rung %u: %s is not read back", r, k->name);
        }
    }
}

static masu_rung any_rung(uint64_t *random) {
    masu_rung rung;
    memset(&rung, 0, sizeof rung);
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        for (uint32_t i = 0; i < k->values; i++) {
            double share = (double)(support_random(random) >> 11) * 0x1p-53;
            double value = k->kind == MASU_KNOB_FLOAT
                               ? k->min + (k->max - k->min) * share
                               : (double)support_random_in(random, 0, (uint64_t)k->max);
            masu_knob_set(k, &rung, i, masu_knob_accepts(k, value) ? value : 0.0);
        }
    }
    return rung;
}

static void what_is_written_reads_back_knob_for_knob(void **state) {
    (void)state;
    static masu_setting settings[MASU_SETTINGS_MOST];
    masu_rung rungs[MASU_MAX_RUNGS];
    uint32_t n = masu_settings_make(false, settings);
    for (uint32_t i = 0; i < n; i++) check_round_trip(&settings[i].rung, 1);
    for (uint32_t i = 0; i < 8; i++) rungs[i] = settings[n - 1 - i].rung;
    check_round_trip(rungs, 8);
    uint64_t random = 1;
    for (uint32_t i = 0; i < 500; i++) {
        uint32_t count = 1 + i % 8;
        for (uint32_t r = 0; r < count; r++) rungs[r] = any_rung(&random);
        check_round_trip(rungs, count);
    }
    masu_ladder_file f;
    char error[1024];
    size_t bytes = written(rungs, 4);
    assert_true(masu_ladder_parse("l.json", text, bytes, &f, error, sizeof error));
    masu_desc d = scene_desc(RASTER, 64, 48);
    d.rungs[6].scale = 0.5f, d.governor.costs[6] = 2.0f;
    masu_ladder_give(&f, &d);
    assert_int_equal(d.rung_count, 4);
    assert_true(fabsf(d.governor.costs[3] - 0.7f) < 1e-6f && fabsf(d.flips[3] - 0.4f) < 1e-6f);
    assert_true(d.governor.costs[6] == 0.0f && d.rungs[6].scale == 0.0f);
    assert_string_equal(f.settings[3], "s3");
    assert_true(fabs(f.rmses[2] - 2.5) < 1e-9 && f.width == 320 && f.height == 180);
    /* Accepted here means accepted by masu_init. */
    for (uint32_t r = 0; r < 4; r++) d.rungs[r].upscale = MASU_AUTO;
    compile(&d);
}

static void expect_error(const char *find, const char *replace, const char *says) {
    static masu_ladder_file f;
    static char changed[TEXT_ROOM + 1024];
    char error[1024] = "";
    char *at = strstr(text, find);
    if (!at) fail_msg("there is no %s", find);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, replace,
             at + strlen(find));
    if (masu_ladder_parse("l.json", changed, strlen(changed), &f, error, sizeof error))
        fail_msg("%s is accepted", replace);
    if (!strstr(error, says) || strncmp(error, "l.json: ", 8) || strchr(error, '\n'))
        fail_msg("'%s' does not contain '%s'", error, says);
}

static void mistakes_are_named_in_one_line(void **state) {
    (void)state;
    static const masu_rung rungs[MASU_MAX_RUNGS + 1] = {{.scale = 1.0f}, {.scale = 0.5f}};
    static const struct {
        const char *find, *replace, *says;
    } rows[] = {
        {"\"ao\"", "\"a\\no\"", "rungs[0]: a?o: unknown knob"},
        {"\"scale\": 1", "\"scale\": 1.5", "scale: expected a number from 0 to 1, found 1.5"},
        {"\"scale\": 1", "\"scale\": \"1\"", "found '1'"},
        {"\"scale\": 1", "\"scale\": null", "found null"},
        {"\"scale\": 1", "\"scale\": NaN", "line 1"},
        {"\"scale\": 1", "\"scale\": 1e999", "line 1"},
        {"\"scale\": 1", "\"scale\": 1, \"scale\": 1", "line 1"},
        {"\"easu\": \"auto\"", "\"easu\": \"best\"",
         "easu: expected one of auto, full, fast, bilinear, found 'best'"},
        {"\"march_steps\": 0", "\"march_steps\": 2049",
         "march_steps: expected a whole number from "
         "0 to 2048, found 2049"},
        {"\"march_steps\": 0", "\"march_steps\": 1.5", "found 1.5"},
        {"\"march_steps\": 0", "\"march_steps\": -1", "found -1"},
        {"\"shadow_resolution\": 0", "\"shadow_resolution\": 8",
         "expected 0 or a whole number from 16 to 8192, found 8"},
        {"[0, 0, 0, 0]", "[0, 0, 0]", "shadow_refresh: expected an array of 4"},
        {"[0, 0, 0, 0]", "[0, 0, 0, 65]", "shadow_refresh"},
        {"\"ratio\": 0.900", "\"ratio\": 1.0",
         "rungs[1]: ratio: expected less than the "
         "previous rung, 1, found 1"},
        {"\"ratio\": 0.900", "\"ratio\": 0", "rungs[1]: ratio: expected a number"},
        {"\"ratio\": 0.900, ", "",
         "rungs[1]: ratio: expected a number from 1e-06 to 1e+06, found "
         "nothing"},
        {"\"ratio\": 0.900", "\"ratio\": 0.99999999999", "rungs[1]: ratio"},
        {"\"flip\": 0.200", "\"flip\": 1.2", "rungs[1]: flip"},
        {"\"rmse\": 1.5", "\"rmse\": false", "rungs[1]: rmse"},
        {"\"wall_ms\"", "\"walls\"", "rungs[0]: walls: unknown key"},
        {"\"setting\": \"s1\"", "\"setting\": 3", "setting: expected a string, found 3"},
        {"\"error\": \"flip\"", "\"error\": \"rmse\"", "error: expected 'flip', found 'rmse'"},
        {"\"hash\"", "\"hush\"", "hush: unknown key"},
        {"\"width\": 320", "\"width\": 0", "width: expected a number from 1 to"},
        {"\"rungs\": [", "\"rungs\": 3, \"hash2\": [", "unknown key"},
    };
    written(rungs, 2);
    for (size_t i = 0; i < COUNT(rows); i++)
        expect_error(rows[i].find, rows[i].replace, rows[i].says);
    written(rungs, MASU_MAX_RUNGS + 1);
    expect_error("s8", "s8", "rungs: expected an array of 1 to 12 rungs, found 13");
    written(rungs, 0);
    expect_error("[]", "[]", "found 0");
    static masu_ladder_file f;
    char error[1024] = "";
    assert_false(masu_ladder_parse("l.json", "[]", 2, &f, error, sizeof error));
    assert_non_null(strstr(error, "expected an object, found an array"));
    assert_false(masu_ladder_read("there/is/none.json", &f, error, sizeof error));
    assert_non_null(strstr(error, "there/is/none.json"));
    /* Texts are written to comments and constants of C. */
    written(rungs, 1);
    char *at = strstr(text, "D 1.0");
    memcpy(at, "*/ ?\b", 5);
    assert_false(masu_ladder_parse("l.json", text, strlen(text), &f, error, sizeof error));
    memcpy(at, "*/ ?\x7f", 5);
    assert_true(masu_ladder_parse("l.json", text, strlen(text), &f, error, sizeof error));
    assert_string_equal(f.driver, "./ ..");
}

/* For any bytes: no crash, one line, and a scene can use what is accepted. */
static void damaged_files_are_refused_or_good(void **state) {
    (void)state;
    static const masu_rung rungs[2] = {{.scale = 1.0f}, {.scale = 0.5f, .march_steps = 64}};
    static masu_ladder_file f;
    static char damaged[TEXT_ROOM];
    char error[1024];
    uint64_t random = 3;
    uint32_t accepted = 0;
    size_t n = written(rungs, 2);
    for (size_t i = 0; i < n; i++)
        assert_false(masu_ladder_parse("l.json", text, i, &f, error, sizeof error));
    for (uint32_t i = 0; i < 20000; i++) {
        memcpy(damaged, text, n);
        for (uint64_t k = support_random_in(&random, 1, 3); k; k--) {
            uint64_t at = support_random_in(&random, 0, n - 1);
            damaged[at] = i % 2 ? (char)support_random(&random)
                                : "0123456789-.e\",:[]{} "[support_random(&random) % 21];
        }
        error[0] = '\0';
        if (masu_ladder_parse("l.json", damaged, n, &f, error, sizeof error)) {
            masu_desc d = scene_desc(RASTER, 64, 48);
            masu_ladder_give(&f, &d);
            assert_in_range(d.rung_count, 1, MASU_MAX_RUNGS);
            compile(&d);
            accepted++;
        } else {
            assert_true(!strncmp(error, "l.json: ", 8) && !strchr(error, '\n'));
        }
    }
    assert_in_range(accepted, 1, 19999);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_have_the_class_of_what_they_are_made_of),
        cmocka_unit_test(tables_are_well_formed),
        cmocka_unit_test(on_every_class_of_gpus_a_worse_rung_is_cheaper),
        cmocka_unit_test(no_setting_dominates_a_rung_on_a_class_of_gpus),
        cmocka_unit_test(no_step_between_rungs_is_a_jump),
        cmocka_unit_test(every_class_has_the_nearest_ladder),
        cmocka_unit_test(the_switch_says_which_rungs),
        cmocka_unit_test(what_the_host_gives_wins),
        cmocka_unit_test(a_host_may_take_it_and_change_it),
        cmocka_unit_test(no_rung_drops_a_feature_to_keep),
        cmocka_unit_test(every_ladder_fits_every_baked_scene),
        cmocka_unit_test(what_a_scene_lacks_is_ignored),
        cmocka_unit_test(what_is_written_reads_back_knob_for_knob),
        cmocka_unit_test(mistakes_are_named_in_one_line),
        cmocka_unit_test(damaged_files_are_refused_or_good),
    };
    return cmocka_run_group_tests_name("ladder", tests, NULL, NULL);
}

/* ladder.c: see ladder.h. */
#include "quality/ladder.h"

#include "base/error.h"
#include "quality/ladder_devices.h"
#include "quality/ladder_tables.h"
#include "scene/scene.h"

#include <string.h>

/* ---- Classes --------------------------------------------------------------------------------- */

/* Number of classes without traced reflections, which are first in the enum. */
enum { KINDS = MASU_SCENE_POLYGONS_TRACED };

masu_scene_class masu_scene_class_of(const masu_scene *scene) {
    if (!scene) return MASU_SCENE_POLYGONS;
    const masu_scene_data *s = masu_scene_data_of(scene);
    uint32_t kind = s->sdf ? s->instances ? MASU_SCENE_BOTH : MASU_SCENE_SDF
                    : s->lods && s->placed_occluders ? MASU_SCENE_WORLD
                                                     : MASU_SCENE_POLYGONS;
    /* A scene may request reflections but have no surface that is glossy enough. */
    uint32_t traced = s->reflections && s->glossiest < s->specular_cutoff;
    return (masu_scene_class)(kind + (traced ? KINDS : 0));
}

const char *masu_scene_class_name(masu_scene_class scene_class) {
    static const char *const names[MASU_SCENE_CLASSES] = {
        "polygons",        "world",        "sdf",        "both",
        "polygons-traced", "world-traced", "sdf-traced", "both-traced"};
    return (unsigned)scene_class < MASU_SCENE_CLASSES ? names[scene_class] : "unknown class";
}

/* ---- Tables ---------------------------------------------------------------------------------- */

const masu_ladder *masu_ladder_of_class(masu_scene_class scene_class) {
    return &measured[scene_class];
}

const masu_ladder *masu_ladder_for(const masu_scene *scene) {
    /* Similar kinds of scenes, most similar first. Tracing a kind
 * of geometry costs more than rasterising it, so a class with the same traced geometry precedes one
 * with the same rasterised geometry. */
    static const uint8_t nearest[KINDS][KINDS] = {
        [MASU_SCENE_POLYGONS] = {MASU_SCENE_POLYGONS, MASU_SCENE_WORLD, MASU_SCENE_BOTH,
                                 MASU_SCENE_SDF},
        [MASU_SCENE_WORLD] = {MASU_SCENE_WORLD, MASU_SCENE_POLYGONS, MASU_SCENE_BOTH,
                              MASU_SCENE_SDF},
        [MASU_SCENE_SDF] = {MASU_SCENE_SDF, MASU_SCENE_BOTH, MASU_SCENE_POLYGONS, MASU_SCENE_WORLD},
        [MASU_SCENE_BOTH] = {MASU_SCENE_BOTH, MASU_SCENE_SDF, MASU_SCENE_POLYGONS,
                             MASU_SCENE_WORLD}};
    uint32_t own = (uint32_t)masu_scene_class_of(scene), kind = own % KINDS, traced = own / KINDS;
    for (uint32_t i = 0; i < 2 * KINDS; i++) {
        uint32_t traces = i < KINDS ? traced : 1 - traced;
        const masu_ladder *l = &measured[nearest[kind][i % KINDS] + traces * KINDS];
        if (l->count) return l;
    }
    return NULL;
}

const float *masu_ladder_costs_on(const masu_scene *scene, masu_device_class device_class) {
    const masu_ladder *l = masu_ladder_for(scene);
    if (!l || (unsigned)device_class >= MASU_DEVICE_CLASSES) return NULL;
    const float *costs = computed[l - measured][device_class];
    return costs[0] > 0.0f ? costs : NULL;
}

uint32_t masu_rung_drops(const masu_rung *rung, uint32_t keep) {
    uint32_t off = (rung->specular == MASU_OFF ? MASU_KEEP_REFLECTIONS : 0) |
                   (rung->ao == MASU_OFF ? MASU_KEEP_OCCLUSION : 0);
    return off & keep;
}

uint32_t masu_ladder_kept(const masu_ladder *l, uint32_t keep, uint32_t nth) {
    uint32_t r = 0;
    for (; r < l->count; r++) {
        if (!masu_rung_drops(&l->rungs[r], keep) && !nth--) break;
    }
    return r;
}

/* Uses the rungs of a ladder, which were measured without a governor (with one, AUTO of `temporal`
 * differs). costs: set to the rungs' costs. */
static void give(const masu_ladder *l, masu_desc *desc, float costs[MASU_MAX_RUNGS]) {
    uint32_t r = 0;
    memset(desc->rungs, 0, sizeof desc->rungs);
    memset(desc->flips, 0, sizeof desc->flips);
    memset(costs, 0, MASU_MAX_RUNGS * sizeof *costs);
    for (desc->rung_count = 0;
         (r = masu_ladder_kept(l, desc->governor.keep, desc->rung_count)) < l->count;
         desc->rung_count++) {
        masu_rung *to = &desc->rungs[desc->rung_count];
        *to = l->rungs[r];
        if (to->temporal == MASU_AUTO) to->temporal = MASU_OFF;
        desc->flips[desc->rung_count] = l->flips[r];
        costs[desc->rung_count] = l->ratios[r];
    }
}

masu_result masu_ladder_of(const masu_scene *scene, masu_desc *desc, const char **from,
                           masu_detail *detail) {
    masu_detail own;
    const masu_ladder *l = masu_ladder_for(scene);
    if (!scene || !desc) {
        masu_result result = masu_fail_null(&own, scene ? "desc" : "scene");
        return masu_finish_desc(desc, result, &own, detail);
    }
    if (desc->bytes != sizeof *desc)
        return masu_fail_bytes(detail, "masu_desc", sizeof *desc, desc->bytes);
    if (!l) {
        masu_fail(&own, MASU_ERROR_ARGUMENT, "scene", 1, 0, "there is no ladder for the scene");
        return masu_finish_desc(desc, own.result, &own, detail);
    }
    give(l, desc, desc->governor.costs);
    if (from) *from = l->from;
    return MASU_OK;
}

void masu_ladder_defaults(masu_desc *desc) {
    if (desc->ladder == MASU_AUTO)
        desc->ladder = desc->governor.mode && !desc->rung_count ? MASU_ON : MASU_OFF;
    if (desc->rung_count || desc->ladder != MASU_ON) return;
    const masu_ladder *l = masu_ladder_for(desc->scene);
    if (!desc->scene || desc->source.view || !l) return;
    float costs[MASU_MAX_RUNGS];
    give(l, desc, costs);
    for (uint32_t r = 0; r < desc->rung_count; r++) {
        if (desc->governor.costs[r] == 0.0f) desc->governor.costs[r] = costs[r];
    }
}

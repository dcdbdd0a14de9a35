/* settings.h: the settings that `masu bench` measures: a table of techniques,
 * and bundles of them over all render sizes.
 *
 * A setting is named by the knobs that differ from the base, so that its name is the same whatever
 * the scene, the table's order or the machine. Owns nothing; nothing allocates. */
#ifndef MASU_BENCH_SETTINGS_H
#define MASU_BENCH_SETTINGS_H

#include "settings/setting.h"

#include <stdbool.h>

#include "masu.h"

#define MASU_SETTINGS_MOST 160u

typedef struct masu_setting {
    char id[MASU_SETTING_ID];
    char parent[MASU_SETTING_ID]; /* what it differs from by its technique alone */
    char technique[32];           /* "base", "scale", a bundle, or the knob that is turned */
    uint32_t structural;          /* 1: without effect if the plan is that of the parent */
    uint32_t
        same_picture; /* 1: the knob changes time alone, and is there for comparison: no rung */
    masu_rung rung;
    char dropped[160]; /* why it is not measured; empty: it is */
} masu_setting;

/* All settings, the base first, every parent before its children. `quick`: a few, for tests. */
uint32_t masu_settings_make(bool quick, masu_setting out[MASU_SETTINGS_MOST]);

/* Turns back the knobs that the scene has no use for, and drops settings that then equal an earlier
 * one. `base` is the plan of the base setting. */
void masu_settings_fit(masu_setting *settings, uint32_t count, const masu_scene *scene,
                       const masu_plan_info *base);

/* The plans of one rung each have the same passes, sizes and bytes. */
bool masu_settings_same_plan(const masu_plan_info *a, const masu_plan_info *b);

#endif

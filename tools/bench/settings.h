/* settings.h: the settings that `masu bench` measures: a table of techniques, and bundles of knobs
 * over all render sizes.
 *
 * A setting is named by the knobs that differ from the base, so that its name does not depend on
 * the scene, the table's order or the machine. Owns nothing; nothing allocates. */
#ifndef MASU_BENCH_SETTINGS_H
#define MASU_BENCH_SETTINGS_H

#include "settings/setting.h"

#include <stdbool.h>

#include "masu.h"

#define MASU_SETTINGS_MOST 160u

typedef struct masu_setting {
    char id[MASU_SETTING_ID];
    char parent[MASU_SETTING_ID]; /* differs from it only by the technique */
    char technique[32];           /* "base", "scale", a bundle, or the changed knob */
    uint32_t structural;          /* 1: no effect if the plan equals the parent's */
    uint32_t
        same_picture; /* 1: the knob changes only time; for comparison, not a rung */
    masu_rung rung;
    char dropped[160]; /* why it is not measured; empty: measured */
} masu_setting;

/* All settings, the base first, every parent before its children. `quick`: a few, for tests. */
uint32_t masu_settings_make(bool quick, masu_setting out[MASU_SETTINGS_MOST]);

/* Resets knobs that have no effect in the scene, and drops settings that then equal an earlier one.
 * `base` is the plan of the base setting. */
void masu_settings_fit(masu_setting *settings, uint32_t count, const masu_scene *scene,
                       const masu_plan_info *base);

/* Whether two plans of one rung each have the same passes, sizes and bytes. */
bool masu_settings_same_plan(const masu_plan_info *a, const masu_plan_info *b);

#endif

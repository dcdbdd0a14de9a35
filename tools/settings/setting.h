/* setting.h: a setting is one rung as text. Its name lists the knobs that differ from the base
 * rung, "scale=0.5+sharpen=off", and "base" is the base rung itself, so a setting has the same name
 * for every scene and on every machine. Start with masu_setting_parse, which reads the value of
 * --setting.
 *
 * Owns nothing; nothing allocates. */
#ifndef MASU_SETTING_H
#define MASU_SETTING_H

#include "settings/knobs.h"

#include <stdbool.h>
#include <stddef.h>

#include "masu.h"

#define MASU_SETTING_ID 192u /* bytes of a name, with its terminator */

/* The rung that names are relative to: full size, defaults, and AMD's sharpness for its "quality"
 * mode. */
extern const masu_rung masu_setting_base;

/* The knobs that differ from the base, in the order of masu_knob_table. */
void masu_setting_name(const masu_rung *rung, char out[MASU_SETTING_ID]);

/* Reads a name, with the knobs in any order. On false, `error` names in one line the part that is
 * not a knob with a value or that is given twice, or the values that the knob accepts and the value
 * that was given. */
bool masu_setting_parse(const char *name, masu_rung *out, char *error, size_t error_size);

/* Frames after which the slowest shadow cascade has been rendered again. */
uint32_t masu_setting_period(const masu_rung *rung);
/* Whether a frame depends on previous frames, for any scene. */
bool masu_setting_remembers(const masu_rung *rung);

/* Why the knob changes nothing in that rung of that scene, or NULL. `base` is the plan of the base
 * rung. */
const char *masu_knob_useless(const masu_knob *k, const masu_rung *rung, const masu_scene *scene,
                              const masu_plan_info *base);

#endif

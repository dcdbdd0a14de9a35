/* ladder_file.h: ladder.json, as `masu bench` writes it, read back into rungs.
 *
 * Strict: unknown members, values out of range and rungs out of order are errors of one line, so
 * that masu_init accepts every ladder that was read. A knob that is not named is 0. Nothing of the
 * file's text is kept. */
#ifndef MASU_SETTINGS_LADDER_FILE_H
#define MASU_SETTINGS_LADDER_FILE_H

#include "settings/setting.h"

#include "masu.h"

typedef struct masu_ladder_file {
    char scene[80], driver[200], clock[16];
    char date[12]; /* "2026-11-22"; empty: unknown */
    uint32_t width, height;
    uint32_t count; /* at least 1 */
    char settings[MASU_MAX_RUNGS][MASU_SETTING_ID];
    masu_rung rungs[MASU_MAX_RUNGS];
    double ratios[MASU_MAX_RUNGS]; /* falling */
    double flips[MASU_MAX_RUNGS];
    double rmses[MASU_MAX_RUNGS]; /* below 0: unknown */
    /* Mean change of a static image from the previous rung, of 255; below 0: unknown. */
    double steps[MASU_MAX_RUNGS];
} masu_ladder_file;

/* `name` is the file's, for messages. On false `error` holds one line, and *out is undefined. */
bool masu_ladder_parse(const char *name, const char *text, size_t bytes, masu_ladder_file *out,
                       char *error, size_t error_size);
bool masu_ladder_read(const char *path, masu_ladder_file *out, char *error, size_t error_size);

/* Rungs, flips, and ratios as the governor's costs. */
void masu_ladder_give(const masu_ladder_file *ladder, masu_desc *desc);

#endif

/* table.h: the rows of `masu bench` as CSV: written row by row, read again whole.
 *
 * A file begins with the one header line; text has neither commas nor quotes nor line ends, numbers
 * are C's (inf and nan too). What was being written when a run was stopped, a last line without its
 * end, is no row. Allocates nothing but what masu_rows_read hands out. */
#ifndef MASU_BENCH_TABLE_H
#define MASU_BENCH_TABLE_H

#include "settings/setting.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Columns in order: what each is, its name. Of the base are the samples of the same renderer, in
 * turns with the setting's. The ratio is the median over the rounds of that round's own; the
 * least ratio is wall_min / base_wall_min. Where the two are far apart the machine was busy. */
#define MASU_ROW_TEXTS(X)                                                                          \
    X(setting) /* the knobs that differ from the defaults, "scale=0.5+ao=off"; "base": none */     \
    X(parent)  /* what it is to be compared with */                                                \
    X(technique)
#define MASU_ROW_NUMBERS(X)                                                                        \
    X(render_width)                                                                                \
    X(render_height)                                                                               \
    X(passes)                                                                                      \
    X(device_bytes) /* of a renderer with this rung alone, the scene's own among them */           \
    X(wall_min)                                                                                    \
    X(wall_p50)                                                                                    \
    X(wall_p95)                                                                                    \
    X(wall_p99) /* ms, masu_frame to fence */                                                      \
    X(gpu_min)                                                                                     \
    X(gpu_p50)       /* ms, first to last timestamp */                                             \
        X(plausible) /* share of the samples whose timestamps fit the wall clock */                \
        X(base_wall_min) X(base_gpu_min) X(ratio) X(gpu_ratio) X(least_ratio) X(gpu_least_ratio)   \
            X(rmse) X(psnr_db) X(ssim) X(flip) X(flip_p99) X(flicker) /* rmse, flicker: of 255 */  \
        X(hdr_flip)    /* nan: upscaled, or something is done to the image after the tone curve */ \
        X(hitmiss_pct) /* depth.h; nan: the scene has no surfaces */                         \
        X(depth_mean_px) X(depth_p99_px)                                                           \
            X(specular_relmse) /* of pixels that trace; nan: upscaled, or the scene traces none */ \
        X(rest_flip)       /* FLIP when all has come to rest */                                    \
        X(fast_flip)       /* in frames an eighth of a second apart; both nan: by a version without them */

typedef struct masu_row {
#define MASU_ROW_TEXT(name) char name[MASU_SETTING_ID];
#define MASU_ROW_NUMBER(name) double name;
    MASU_ROW_TEXTS(MASU_ROW_TEXT) MASU_ROW_NUMBERS(MASU_ROW_NUMBER)
    /* The last column: of the program that measured (masu_machine_build); "": not known. */
    char build[17];
#undef MASU_ROW_TEXT
#undef MASU_ROW_NUMBER
} masu_row;

/* Both with the line's end. Return what fprintf does: below 0 on failure. */
int masu_rows_header(FILE *f);
int masu_rows_write(FILE *f, const masu_row *row);

/* Whether it may be a setting's name, which is a file's, too: letters, digits, `_=+.-` and spaces, no dot in front,
 * fewer than MASU_SETTING_ID. */
bool masu_setting_is_name(const char *text);

/* What a ladder goes by: the mean of FLIP in motion along the path and at rest, where both are known. */
double masu_row_error(const masu_row *row);

/* All rows of `text`, of which the last line may be torn; a header and rows may lack the last
 * column, or the last three. NULL and an `error` of one line: another header, a bad row before the
 * last, or no memory. Freed by free(). No row is no error. */
masu_row *masu_rows_read(const char *text, uint32_t *count, char *error, size_t error_size);

/* The row of that setting, or NULL. */
const masu_row *masu_rows_find(const masu_row *rows, uint32_t count, const char *setting);

#endif

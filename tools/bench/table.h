/* table.h: the rows of `masu bench` as CSV: written row by row, read as a whole.
 *
 * A file starts with one header line; text has no commas, quotes or line ends, numbers are in C's
 * format (including inf and nan). A last line without its line end, left by an interrupted run, is
 * not a row. Only masu_rows_read allocates. */
#ifndef MASU_BENCH_TABLE_H
#define MASU_BENCH_TABLE_H

#include "settings/setting.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Columns in order: description, name. base_* are samples of the base in the same renderer, which
 * alternate with the setting's. ratio is the median of the ratios per round; least_ratio is
 * wall_min / base_wall_min. If the two differ a lot, the machine was busy. */
#define MASU_ROW_TEXTS(X)                                                                          \
    X(setting) /* the knobs that differ from the defaults, "scale=0.5+ao=off"; "base": none */     \
    X(parent)  /* the setting to compare with */                                                   \
    X(technique)
#define MASU_ROW_NUMBERS(X)                                                                        \
    X(render_width)                                                                                \
    X(render_height)                                                                               \
    X(passes)                                                                                      \
    X(device_bytes) /* of a renderer with only this rung, with the scene */                        \
    X(wall_min)                                                                                    \
    X(wall_p50)                                                                                    \
    X(wall_p95)                                                                                    \
    X(wall_p99) /* ms, masu_frame to fence */                                                      \
    X(gpu_min)                                                                                     \
    X(gpu_p50)       /* ms, first to last timestamp */                                             \
        X(plausible) /* fraction of samples whose timestamps fit the clock */                      \
        X(base_wall_min) X(base_gpu_min) X(ratio) X(gpu_ratio) X(least_ratio) X(gpu_least_ratio)   \
            X(rmse) X(psnr_db) X(ssim) X(flip) X(flip_p99) X(flicker) /* rmse, flicker: of 255 */  \
        X(hdr_flip)    /* nan: upscaled, or the image is changed after the tone curve */           \
        X(hitmiss_pct) /* depth.h; nan: the scene has no surfaces */                         \
        X(depth_mean_px) X(depth_p99_px)                                                           \
            X(specular_relmse) /* of pixels that trace; nan: upscaled, or none trace */            \
        X(rest_flip)       /* FLIP of the static image */                                          \
        X(fast_flip)       /* in frames an eighth of a second apart; both nan: written by an older
                            * version */

typedef struct masu_row {
#define MASU_ROW_TEXT(name) char name[MASU_SETTING_ID];
#define MASU_ROW_NUMBER(name) double name;
    MASU_ROW_TEXTS(MASU_ROW_TEXT) MASU_ROW_NUMBERS(MASU_ROW_NUMBER)
    /* The last column: the program that measured (masu_machine_build); "": unknown. */
    char build[17];
#undef MASU_ROW_TEXT
#undef MASU_ROW_NUMBER
} masu_row;

/* Both write a line. They return the result of fprintf: negative on failure. */
int masu_rows_header(FILE *f);
int masu_rows_write(FILE *f, const masu_row *row);

/* Whether the text is a valid name of a setting, which is also a file name: letters, digits,
 * `_=+.-` and spaces, no leading dot, shorter than MASU_SETTING_ID. */
bool masu_setting_is_name(const char *text);

/* The error that orders a ladder: the mean of FLIP in motion and stationary, if both are
 * measured. */
double masu_row_error(const masu_row *row);

/* Reads all rows of `text`. The last line may be incomplete; header and rows may lack the last
 * column, or the last three. NULL with one line in `error`: another header, a bad row before the
 * last, or no memory. Release the result by free(). No rows is not an error. */
masu_row *masu_rows_read(const char *text, uint32_t *count, char *error, size_t error_size);

/* The row of that setting, or NULL. */
const masu_row *masu_rows_find(const masu_row *rows, uint32_t count, const char *setting);

#endif

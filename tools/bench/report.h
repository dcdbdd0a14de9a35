/* report.h: what `masu bench` makes of its rows: ladder.json, plots, and one page that
 * needs no other file.
 *
 * Everything is read from the folder (sweep.h), so that parts of a sweep that were merged,
 * or a folder from elsewhere, give the same. Needs no device. */
#ifndef MASU_BENCH_REPORT_H
#define MASU_BENCH_REPORT_H

#include "bench/sweep.h"

typedef struct masu_report_result {
    uint32_t rows, settings, rungs; /* rows there are of settings there should be */
    uint32_t unsteady;  /* rows whose ratios of rounds and of least times differ by more than 0.1 */
    bool plots;         /* gnuplot has drawn them */
    bool by_timestamps; /* times of the ladder; else the wall clock's */
    bool by_costs;      /* instead of times the costs of costs.h */
} masu_report_result;

/* The rungs that ladder.json has or would have now, in order. Of a folder without sweep.json
 * (docs/report) those of its ladder.json. False: `error` holds one line. */
bool masu_report_rungs(const char *folder, masu_setting_list *out, char *error, size_t error_size);

/* What to time again, where the ladder goes by times: the first eleven rungs that have no times in
 * steady.csv. Where there are fewer, those follow that would take their places if they were not as
 * quick as they look. None: the ladder is steady. */
bool masu_report_unsteady(const char *folder, masu_setting_list *out, char *error,
                          size_t error_size);

/* Writes ladder.json, plots/ and index.html. False: `error` holds one line. */
bool masu_report_write(const char *folder, masu_report_result *out, char *error, size_t error_size);

#endif

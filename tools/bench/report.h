/* report.h: the output of `masu bench`: ladder.json, plots, and one page that needs no other
 * file.
 *
 * Everything is read from the folder (sweep.h), so that parts of a sweep that were merged,
 * or a folder from elsewhere, give the same. Needs no device. */
#ifndef MASU_BENCH_REPORT_H
#define MASU_BENCH_REPORT_H

#include "bench/sweep.h"

typedef struct masu_report_result {
    uint32_t rows, settings, rungs; /* rows: finished settings */
    uint32_t unsteady;  /* rows whose ratios of rounds and of least times differ by more than 0.1 */
    bool plots;         /* gnuplot has drawn them */
    bool by_timestamps; /* times of the ladder; else wall clock */
    bool by_costs;      /* the costs of costs.h instead of times */
} masu_report_result;

/* The rungs that ladder.json has or would have, in order. A folder without sweep.json (docs/report)
 * has the rungs of its ladder.json. False: `error` holds one line. */
bool masu_report_rungs(const char *folder, masu_setting_list *out, char *error, size_t error_size);

/* The settings to time again, if the ladder is chosen by times: the first eleven rungs without
 * times in steady.csv. If there are fewer, the settings follow that would replace them if they were
 * slower than measured. None: the ladder is steady. */
bool masu_report_unsteady(const char *folder, masu_setting_list *out, char *error,
                          size_t error_size);

/* Writes ladder.json, plots/ and index.html. False: `error` holds one line. */
bool masu_report_write(const char *folder, masu_report_result *out, char *error, size_t error_size);

#endif

/* sweep_files.h: creates, resumes, extends and merges the folder of `masu bench` (sweep.h).
 * Functions that can fail return false (NULL) and write one line to `error`. */
#ifndef MASU_BENCH_SWEEP_FILES_H
#define MASU_BENCH_SWEEP_FILES_H

#include "bench/sweep.h"

/* Content of sweep.json besides the description. */
typedef struct masu_sweep_about {
    const char *driver;
    const char *depth; /* reference for surfaces */
    uint64_t hash;     /* of the scene */
    const masu_setting *settings;
    uint32_t count;
} masu_sweep_about;

/* Creates the folder and writes sweep.json. An existing one must be equal. */
bool masu_sweep_begin(const masu_sweep_desc *desc, const masu_sweep_about *about, char *error,
                      size_t error_size);

/* Makes the folder and locks it for this process until the result, a file, is closed. -1: another
 * process holds it. */
int masu_sweep_lock(const char *folder, char *error, size_t error_size);

/* Whether all rows were measured by that build of the program. */
bool masu_sweep_one_build(const masu_row *rows, uint32_t count, const char *build, const char *path,
                          char *error, size_t error_size);

/* The rows of results.csv that have an image in the folder. Removes other and incomplete rows from
 * results.csv and steady.csv. A missing file is no error. Release the result by free(). */
masu_row *masu_sweep_resume(const char *folder, uint32_t *count, char *error, size_t error_size);

/* Appends a row and flushes it; a new file starts with the header. `name`: MASU_SWEEP_RESULTS or
 * MASU_SWEEP_STEADY. */
bool masu_sweep_append(const char *folder, const char *name, const masu_row *row, char *error,
                       size_t error_size);

#endif

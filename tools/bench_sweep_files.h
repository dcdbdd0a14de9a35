/* bench_sweep_files.h: the folder of `masu bench`, see bench_sweep.h: what is in it, begun,
 * resumed, appended to, merged. Functions that can fail return false (NULL) and write one line to
 * `error`. */
#ifndef MASU_BENCH_SWEEP_FILES_H
#define MASU_BENCH_SWEEP_FILES_H

#include "bench_sweep.h"

/* Makes the folder and writes sweep.json. If there is one already it must say the same. */
bool masu_sweep_begin(const masu_sweep_desc *desc, const char *driver, uint64_t hash,
                      const masu_setting *settings, uint32_t count, char *error, size_t error_size);

/* The rows that are there, and results.csv without what was torn. Freed by free(). */
masu_row *masu_sweep_resume(const char *folder, uint32_t *count, char *error, size_t error_size);

/* On the disk when it returns. */
bool masu_sweep_append(const char *folder, const masu_row *row, char *error, size_t error_size);

/* A PNG of that size. rgba: 4 * width * height bytes. */
bool masu_sweep_load(const char *path, VkExtent2D size, uint8_t *rgba, char *error,
                     size_t error_size);

#endif

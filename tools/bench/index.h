/* index.h: the page that links the reports of all scenes of a folder (`masu bench --index`). */
#ifndef MASU_BENCH_INDEX_H
#define MASU_BENCH_INDEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Writes FOLDER/index.html: a row for each subfolder that has ladder.json and results.csv, at most
 * 1024. It links the subfolder's page, or its ladder.json if it has none (docs/report). False:
 * `error` holds one line; also if there is no such subfolder. */
bool masu_bench_index(const char *folder, uint32_t *count, char *error, size_t error_size);

#endif

/* stats.h: statistics of a bake: one line for a person, a JSON file for programs. */
#ifndef MASU_BAKE_STATS_H
#define MASU_BAKE_STATS_H

#include "bake/build/build.h"

/* To options->stats. False after reporting. seconds: since masu-bake began. */
bool masu_bake_write_stats(const masu_bake_options *options, const masu_bake_content *content,
                           const masu_bake_buffer *blob, const masu_bake_report *report,
                           double seconds);

void masu_bake_print_summary(const char *path, const masu_bake_content *content, size_t bytes);

#endif

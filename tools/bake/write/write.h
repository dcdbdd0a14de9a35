/* write.h: the third step of baking: the sections become a blob, the blob a file.
 *
 *   write.c   judges the blob by the runtime's own reader, and writes it
 *   blob.c    sections to bytes
 *   stats.c   what has been baked, in numbers
 *
 * Can fail: the reader refuses the blob, or a file cannot be written; nothing is left behind then. */
#ifndef MASU_BAKE_WRITE_H
#define MASU_BAKE_WRITE_H

#include "bake/build/build.h"

/* Nothing is written without options->output. False after reporting. started: what
 * masu_bake_seconds said when masu-bake began. */
bool masu_bake_write(const masu_bake_options *options, const masu_bake_content *content,
                     const masu_bake_report *report, double started);

#endif

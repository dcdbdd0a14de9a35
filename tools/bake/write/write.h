/* write.h: the third step of baking: sections to blob, blob to file.
 *
 *   write.c   validates the blob with the runtime's own reader, and writes it
 *   blob.c    sections to bytes
 *   stats.c   statistics of a bake
 *
 * Errors: the reader rejects the blob, or a file cannot be written; no partial file remains. */
#ifndef MASU_BAKE_WRITE_H
#define MASU_BAKE_WRITE_H

#include "bake/build/build.h"

/* Writes nothing without options->output. False after reporting. started: masu_bake_seconds() at
 * the start of masu-bake. */
bool masu_bake_write(const masu_bake_options *options, const masu_bake_content *content,
                     const masu_bake_report *report, double started);

#endif

/* file.h: reading and writing whole files, and cleanup of temporary files.
 *
 * Output is written to a temporary file next to its final name and renamed: a reader sees the
 * old file or the new one, never a part. exit() removes all temporary files. Functions that can
 * fail report the error themselves. */
#ifndef MASU_BAKE_FILE_H
#define MASU_BAKE_FILE_H

#include "bake/base/buffer.h"

#include <stdbool.h>

/* Reads a regular file of at most `limit` bytes; adds a NUL that is not counted. */
bool masu_bake_read_file(const char *path, size_t limit, masu_bake_buffer *out);

/* Replaces `path`; a device or pipe (/dev/null, /dev/stdout) is written straight into. */
bool masu_bake_write_file(const char *path, const void *data, size_t bytes);

/* A new empty directory; removed with all it holds at exit, or by the next call in any process
 * if this one cannot any more. NULL after an error. */
const char *masu_bake_temporary_directory(void);
/* Those whose makers are dead. */
void masu_bake_sweep_temporary(void);

/* "DIRECTORY/NAME"; free() it. */
char *masu_bake_join(const char *directory, const char *name);
/* Appends `name`, a relative path, to `path`, a folder with its '/' or empty, with the spelling
 * on disk: if no file has that name, letters may differ in case (Windows), and of several
 * matches the first in byte order is used. Adds a NUL that is not part of the size. False: there
 * is no match, and the path is unchanged. */
bool masu_bake_append_spelling(masu_bake_buffer *path, const char *name);
/* The directory of a path, "." if it has none; free() it. */
char *masu_bake_directory_of(const char *path);

#endif

/* atomic_file.h: writes a file so that readers see the old contents or the new ones, never a part.
 * The bytes go to a temporary file next to the target, which is renamed to the target at the end.
 * Start with masu_atomic_file_open.
 *
 * The temporary file of X is X.PID-N.part, and its writer holds a lock on it (flock) until it is
 * renamed or removed. A writer that dies, by kill -9 or with the machine, leaves a stale file
 * without a lock: the next writer of X removes it. A locked file belongs to a running writer and
 * stays. On a file system without such locks nothing is removed. The caller owns the struct. */
#ifndef MASU_PLATFORM_ATOMIC_FILE_H
#define MASU_PLATFORM_ATOMIC_FILE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct masu_atomic_file {
    int file;   /* open for writing; -1: none */
    char *name; /* of the temporary file, for a signal handler that removes it */
} masu_atomic_file;

/* Removes stale files of `target`, then creates one. Returns 0, or errno. */
int masu_atomic_file_open(masu_atomic_file *draft, const char *target);
/* Writes all bytes. Returns 0, or errno. */
int masu_atomic_file_write(masu_atomic_file *draft, const void *bytes, size_t count);
/* Flushes the file to disk and renames it to the target. Returns 0, or errno, and then removes the
 * temporary file. */
int masu_atomic_file_commit(masu_atomic_file *draft, const char *target);
void masu_atomic_file_discard(masu_atomic_file *draft);
/* Call it at the start of a program: SIGINT, SIGTERM and SIGHUP then remove the temporary files of
 * this process and end it. Signals that are ignored or already handled are unchanged. A file beyond
 * the size limit of the process makes the write fail instead of ending the process by SIGXFSZ. */
void masu_atomic_file_catch_signals(void);
/* Removes only the stale files of `target`. */
void masu_atomic_file_remove_stale(const char *target);

/* The lock itself, also for folders. lock: locks a file that was just created; false: another
 * process has removed it. lock_stale: an open file that now holds the lock of a stale file or
 * folder, or -1. */
bool masu_atomic_file_lock(int file, const char *path);
int masu_atomic_file_lock_stale(const char *path, bool folder);

#endif

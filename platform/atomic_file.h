/* draft.h: a file that is written beside its place and renamed, so that readers see the old one or the new one, and that
 * nobody has to clean up after.
 *
 * The draft of X is X.PID-N.part; its maker holds a lock on it (flock) until it is renamed or dropped. A maker that dies,
 * by kill -9 or with the machine, leaves its draft and loses its lock: the next one that writes X finds it so and removes
 * it. A draft whose lock is held is a running maker's, and stays. Where a file system knows no such locks nothing is
 * removed. A struct is its caller's. */
#ifndef MASU_PLATFORM_DRAFT_H
#define MASU_PLATFORM_DRAFT_H

#include <stdbool.h>
#include <stddef.h>

typedef struct masu_draft {
    int file;   /* open for writing; -1: none */
    char *name; /* to be removed if its maker is ended by a signal that it hears */
} masu_draft;

/* Removes dead drafts of `target`, then makes one. 0, or errno. */
int masu_draft_open(masu_draft *draft, const char *target);
/* All bytes. 0, or errno. */
int masu_draft_write(masu_draft *draft, const void *bytes, size_t count);
/* Makes it durable and the target. 0, or errno, and then there is neither. */
int masu_draft_finish(masu_draft *draft, const char *target);
void masu_draft_drop(masu_draft *draft);
/* Dead drafts of `target` alone. */
void masu_draft_sweep(const char *target);

/* The lock itself, for folders too. hold: of something just made; false: a sweeper was faster, and it is gone. take_dead:
 * what is there and nobody holds: an open file that holds it now, else -1. */
bool masu_draft_hold(int file, const char *path);
int masu_draft_take_dead(const char *path, bool folder);

#endif

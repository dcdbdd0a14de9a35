/* supervise.h: the whole of baking in a child process with a limit of memory and one of time. A model, a picture or a
 * shader may make any library ask for anything, and what starts masu-bake (a build, an editor) must go on.
 *
 * The parent does nothing but wait. It passes on signals that should end masu-bake, ends the child when its time is over,
 * and ends with its exit code; a parent that is killed takes the child with it (Linux). */
#ifndef MASU_BAKE_SUPERVISE_H
#define MASU_BAKE_SUPERVISE_H

#include <stdbool.h>
#include <stdint.h>

/* Half of the machine's memory, at least 4 GiB, in MiB. */
uint32_t masu_bake_memory_default(void);
#define MASU_BAKE_SECONDS_DEFAULT 3600u

typedef struct masu_bake_supervised {
    int (*body)(const void *argument); /* returns an exit code */
    const void *argument;
    const char *about;  /* what is baked, for messages */
    const char *output; /* a draft of it that the child leaves is removed; or NULL */
    uint32_t memory_mib, seconds; /* 0: no limit */
} masu_bake_supervised;

/* An exit code. */
int masu_bake_supervise(const masu_bake_supervised *what);

#endif

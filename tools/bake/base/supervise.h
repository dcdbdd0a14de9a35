/* supervise.h: runs the baker in a child process with a memory limit and a time limit. A model, an
 * image or a shader may make any library allocate without bound, and the caller of masu-bake (a
 * build, an editor) must survive.
 *
 * The parent only waits. It forwards signals that should end masu-bake, ends the child when its
 * time is over, and returns its exit code; a killed parent takes the child with it (Linux). */
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
    const char *about;  /* name of the input, for messages */
    /* output file whose temporary file is removed if the child leaves one; or NULL */
    const char *output;
    uint32_t memory_mib, seconds; /* 0: no limit */
} masu_bake_supervised;

/* An exit code. */
int masu_bake_supervise(const masu_bake_supervised *what);

#endif

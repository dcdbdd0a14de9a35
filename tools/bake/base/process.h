/* process.h: runs work in a child process, because it may crash, hang or exhaust memory: importing
 * a model (a library that parses hostile files) and running the shader tools.
 *
 * The child's output is read from a pipe with a time limit. A signal that should end masu-bake
 * (Ctrl-C, TERM, HUP) ends the child first and then calls exit(), so that temporary files are
 * removed. */
#ifndef MASU_BAKE_PROCESS_H
#define MASU_BAKE_PROCESS_H

#include "bake/base/buffer.h"

#include <stdbool.h>

enum masu_bake_end {
    MASU_BAKE_EXITED,   /* code: the exit status */
    MASU_BAKE_SIGNALED, /* code: the signal */
    MASU_BAKE_TIMEOUT,  /* killed after its time; code: the seconds */
    MASU_BAKE_NO_CHILD  /* fork or pipe failed; code: errno */
};

typedef struct masu_bake_result {
    enum masu_bake_end end;
    int code;
} masu_bake_result;

/* 1: built with the address or thread sanitizer, whose shadow memory needs many TiB of address
 * space. gcc and clang define different macros. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MASU_BAKE_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MASU_BAKE_SANITIZED 1
#endif
#endif
#ifndef MASU_BAKE_SANITIZED
#define MASU_BAKE_SANITIZED 0
#endif

/* Monotonic clock. */
double masu_bake_seconds(void);

/* Called once at the start of main. */
void masu_bake_catch_signals(void);
/* The signal that should end this process; 0: none has come. */
int masu_bake_heard(void);
/* For a child: the signal is sent to it when its parent ends, if the system supports that
 * (Linux). */
void masu_bake_end_with_parent(long parent, int number);

/* Runs body(argument, fd) in a forked child; data written to fd is appended to `output`. The
 * child ends with status 0 when body returns. Its standard output and, outside sanitizer builds,
 * its standard error are discarded. */
masu_bake_result masu_bake_fork(void (*body)(void *argument, int fd), void *argument,
                                unsigned seconds, masu_bake_buffer *output);

/* Runs a program found in PATH, never through a shell; both its output streams land in `output`.
 * A program that cannot be started exits with MASU_BAKE_CANNOT_START. */
masu_bake_result masu_bake_run(const char *const *arguments, unsigned seconds,
                               masu_bake_buffer *output);
#define MASU_BAKE_CANNOT_START 127

/* For bodies: writes all data, or ends the child if the parent has ended. */
void masu_bake_send(int fd, const void *data, size_t bytes);

#endif

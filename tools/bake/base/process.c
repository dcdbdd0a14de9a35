/* process.c: children with a clock; see process.h. */
#define _POSIX_C_SOURCE 200809L
#include "bake/base/process.h"
#include "cli/cli.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* A run-away child must not take the machine with it. */
#define OUTPUT_MAX ((size_t)8 << 30)
#define LEAST_MEMORY ((rlim_t)2 << 30)

static const int ending_signals[] = {SIGINT, SIGTERM, SIGHUP};
static volatile sig_atomic_t ending;

static void note_signal(int number) { ending = number; }

static void set_handlers(void (*handler)(int)) {
    struct sigaction action = {.sa_handler = handler}; /* no SA_RESTART: poll must return */
    sigemptyset(&action.sa_mask);
    for (size_t i = 0; i < sizeof ending_signals / sizeof ending_signals[0]; i++) {
        sigaction(ending_signals[i], &action, NULL);
    }
}

void masu_bake_catch_signals(void) { set_handlers(note_signal); }

int masu_bake_heard(void) { return ending; }

void masu_bake_end_with_parent(long parent, int number) {
#ifdef __linux__
    prctl(PR_SET_PDEATHSIG, number);
#endif
    if (getppid() != (pid_t)parent) raise(number); /* it has ended meanwhile */
}

double masu_bake_seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + (double)t.tv_nsec * 1e-9;
}

/* ---- the child's side ---- */

void masu_bake_send(int fd, const void *data, size_t bytes) {
    const char *at = data;
    while (bytes > 0) {
        ssize_t wrote = write(fd, at, bytes);
        if (wrote < 0 && errno == EINTR) continue;
        if (wrote <= 0) _exit(1);
        at += wrote;
        bytes -= (size_t)wrote;
    }
}

static void point_at_null(int fd, int mode) {
    int null = open("/dev/null", mode);
    if (null < 0) _exit(1);
    if (null != fd) {
        dup2(null, fd);
        close(null);
    }
}

static void limit(int resource, rlim_t value) {
    struct rlimit old;
    if (getrlimit(resource, &old) != 0) return;
    if (old.rlim_max != RLIM_INFINITY && value > old.rlim_max) value = old.rlim_max;
    setrlimit(resource, &(struct rlimit){.rlim_cur = value, .rlim_max = old.rlim_max});
}

/* Half of the machine's memory, CPU time a little over the wall clock's limit, no core file. */
static void limit_child(unsigned seconds) {
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, seconds + 5);
    if (MASU_BAKE_SANITIZED) return;
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    rlim_t half = pages > 0 && page > 0 ? (rlim_t)pages / 2 * (rlim_t)page : LEAST_MEMORY;
    limit(RLIMIT_AS, half > LEAST_MEMORY ? half : LEAST_MEMORY);
}

/* ---- the parent's side ---- */

static masu_bake_result collect(pid_t child, int fd, unsigned seconds, masu_bake_buffer *output) {
    double deadline = masu_bake_seconds() + seconds;
    bool timed_out = false, flooded = false;
    for (;;) {
        double left = deadline - masu_bake_seconds();
        if (ending || !(left > 0)) {
            timed_out = !ending;
            break;
        }
        struct pollfd ready = {.fd = fd, .events = POLLIN};
        int count = poll(&ready, 1, left < 1 ? (int)(left * 1000) + 1 : 1000);
        if (count <= 0) continue; /* a second has passed, or a signal came */
        static unsigned char chunk[65536];
        ssize_t got = read(fd, chunk, sizeof chunk);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        if (output->bytes + (size_t)got > OUTPUT_MAX) {
            flooded = true;
            break;
        }
        masu_bake_append(output, chunk, (size_t)got);
    }
    close(fd);
    /* The pipe is closed: a child that still runs has lost its purpose or its way. */
    int status = 0;
    for (;;) {
        if (ending || timed_out || flooded || masu_bake_seconds() > deadline) kill(child, SIGKILL);
        pid_t done = waitpid(child, &status, ending || timed_out || flooded ? 0 : WNOHANG);
        if (done == child || (done < 0 && errno != EINTR)) break;
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    if (ending) {
        int number = ending;
        masu_cli_error("interrupted by %s", masu_cli_signal(number));
        exit(128 + number);
    }
    if (timed_out) return (masu_bake_result){MASU_BAKE_TIMEOUT, (int)seconds};
    if (WIFSIGNALED(status)) return (masu_bake_result){MASU_BAKE_SIGNALED, WTERMSIG(status)};
    return (masu_bake_result){MASU_BAKE_EXITED, WEXITSTATUS(status)};
}

static masu_bake_result start(void (*body)(void *argument, int fd), void *argument,
                              unsigned seconds, masu_bake_buffer *output) {
    int ends[2];
    if (pipe(ends) != 0) return (masu_bake_result){MASU_BAKE_NO_CHILD, errno};
    fflush(NULL); /* or the child would write our buffered text a second time */
    pid_t parent = getpid(), child = fork();
    if (child < 0) {
        int cause = errno;
        close(ends[0]);
        close(ends[1]);
        return (masu_bake_result){MASU_BAKE_NO_CHILD, cause};
    }
    if (child == 0) {
        close(ends[0]);
        set_handlers(SIG_DFL);
        masu_bake_end_with_parent(parent, SIGKILL);
        point_at_null(STDIN_FILENO, O_RDONLY);
        limit_child(seconds);
        body(argument, ends[1]);
        _exit(0);
    }
    close(ends[1]);
    return collect(child, ends[0], seconds, output);
}

/* ---- the two uses ---- */

struct call {
    void (*body)(void *argument, int fd);
    void *argument;
};

static void call_quietly(void *argument, int fd) {
    struct call *call = argument;
    point_at_null(STDOUT_FILENO, O_WRONLY);
    if (!MASU_BAKE_SANITIZED) point_at_null(STDERR_FILENO, O_WRONLY);
    call->body(call->argument, fd);
}

masu_bake_result masu_bake_fork(void (*body)(void *argument, int fd), void *argument,
                                unsigned seconds, masu_bake_buffer *output) {
    struct call call = {body, argument};
    return start(call_quietly, &call, seconds, output);
}

static void execute(void *argument, int fd) {
    char *const *arguments = argument;
    dup2(fd, STDOUT_FILENO);
    dup2(fd, STDERR_FILENO);
    if (fd > STDERR_FILENO) close(fd);
    execvp(arguments[0], arguments);
    _exit(MASU_BAKE_CANNOT_START);
}

masu_bake_result masu_bake_run(const char *const *arguments, unsigned seconds,
                               masu_bake_buffer *output) {
    /* execvp takes char *const[] for historical reasons and changes nothing. */
    return start(execute, (void *)(uintptr_t)arguments, seconds, output);
}

/* supervise.c: see supervise.h. */
#define _POSIX_C_SOURCE 200809L
#include "bake/base/supervise.h"
#include "bake/base/file.h"
#include "bake/base/process.h"
#include "cli/cli.h"
#include "atomic_file.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define LEAST_MIB 4096u
#define GRACE_SECONDS 2.0 /* that the child has to end by itself */

uint32_t masu_bake_memory_default(void) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    uint64_t half = pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page >> 21 : 0;
    return half < LEAST_MIB ? LEAST_MIB : half > INT32_MAX ? INT32_MAX : (uint32_t)half;
}

/* Address space, since that is what a limit can be set on: threads and pools of libraries count
 * as well. */
static void limit_memory(uint32_t mib) {
    struct rlimit old;
    rlim_t most = (rlim_t)mib << 20;
    if (!mib || MASU_BAKE_SANITIZED || getrlimit(RLIMIT_AS, &old) != 0) return;
    if (old.rlim_max != RLIM_INFINITY && most > old.rlim_max) most = old.rlim_max;
    if (old.rlim_cur != RLIM_INFINITY && most > old.rlim_cur) return;
    setrlimit(RLIMIT_AS, &(struct rlimit){.rlim_cur = most, .rlim_max = old.rlim_max});
}

static int report(const masu_bake_supervised *w, int status, bool timed_out, int heard) {
    if (WIFEXITED(status) && !timed_out) return WEXITSTATUS(status);
    masu_cli_progress_clear();
    masu_atomic_file_remove_stale(w->output ? w->output : "");
    masu_bake_sweep_temporary();
    if (heard) {
        masu_cli_error("interrupted by %s", masu_cli_signal(heard));
        return 128 + heard;
    }
    if (timed_out)
        masu_cli_error("%s: took more than %u seconds (--time-limit)", w->about, w->seconds);
    else if (w->memory_mib && !MASU_BAKE_SANITIZED)
        masu_cli_error("%s: baking was ended by %s, with %u MiB to use (--memory-limit)", w->about,
                       masu_cli_signal(WTERMSIG(status)), w->memory_mib);
    else
        masu_cli_error("%s: baking was ended by %s", w->about, masu_cli_signal(WTERMSIG(status)));
    return MASU_CLI_FAILURE;
}

/* SIGCHLD need not be caught: a twentieth of a second is no time for who waits for a bake. */
static int wait_for(const masu_bake_supervised *w, pid_t child) {
    double began = masu_bake_seconds(), asked = 0;
    bool timed_out = false, killed = false;
    int heard = 0, status = 0;
    for (long pause = 200000;;) {
        pid_t done = waitpid(child, &status, WNOHANG);
        if (done == child || (done < 0 && errno != EINTR)) break;
        double now = masu_bake_seconds();
        if (!asked && w->seconds && now - began > w->seconds) timed_out = true;
        if (!heard) heard = masu_bake_heard();
        if ((timed_out || heard) && !asked) {
            kill(child, SIGTERM);
            asked = now;
        } else if (asked > 0 && !killed && now - asked > GRACE_SECONDS) {
            kill(child, SIGKILL);
            killed = true;
        }
        nanosleep(&(struct timespec){.tv_nsec = pause}, NULL);
        if (pause < 50000000) pause += pause / 4;
    }
    return report(w, status, timed_out, heard);
}

int masu_bake_supervise(const masu_bake_supervised *what) {
    fflush(NULL);
    pid_t parent = getpid(), child = fork();
    if (child < 0) {
        masu_cli_error("cannot start a process: %s", strerror(errno));
        return MASU_CLI_FAILURE;
    }
    if (child > 0) return wait_for(what, child);
    masu_bake_end_with_parent(parent, SIGTERM);
    limit_memory(what->memory_mib);
    exit(masu_cli_end(what->body(what->argument)));
}

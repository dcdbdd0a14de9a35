/* clock.c: see clock.h. */
#define _POSIX_C_SOURCE 200809L
#include "clock.h"

#include <time.h>

uint64_t masu_clock_ns(void *user) {
    (void)user;
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (uint64_t)t.tv_sec * 1000000000u + (uint64_t)t.tv_nsec;
}

bool masu_clock_advances(void) {
    uint64_t start = masu_clock_ns(NULL);
    for (int i = 0; i < 100; i++) {
        if (masu_clock_ns(NULL) > start) return true;
        (void)nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    return masu_clock_ns(NULL) > start;
}

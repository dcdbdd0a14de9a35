/* clock.h: monotonic time. */
#ifndef MASU_PLATFORM_CLOCK_H
#define MASU_PLATFORM_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Nanoseconds since an arbitrary start, monotonic. `user` is ignored: the type matches
 * masu_desc.clock_ns. */
uint64_t masu_clock_ns(void *user);

/* Whether the clock advances, which a replaced or virtual clock may not: waits at most 0.1 s. If
 * not, print MASU_CLOCK_STOPPED. */
bool masu_clock_advances(void);
#define MASU_CLOCK_STOPPED "the clock (CLOCK_MONOTONIC) does not advance: nothing can be timed"

#endif

/* clock.h: monotonic time. */
#ifndef MASU_PLATFORM_CLOCK_H
#define MASU_PLATFORM_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

/* Nanoseconds since some fixed moment, never running backwards. `user` is ignored: the type is that
 * of masu_desc.clock_ns. */
uint64_t masu_clock_ns(void *user);

/* Whether it advances at all, which a replaced or virtual clock may not: looks for at most 0.1 s.
 * If not, nothing can be timed, and MASU_CLOCK_STOPPED says so. */
bool masu_clock_advances(void);
#define MASU_CLOCK_STOPPED "the clock (CLOCK_MONOTONIC) does not advance: nothing can be timed"

#endif

/* clock.h: monotonic time. */
#ifndef MASU_PLATFORM_CLOCK_H
#define MASU_PLATFORM_CLOCK_H

#include <stdint.h>

/* Nanoseconds since some fixed moment, never running backwards. `user` is ignored: the type is that
 * of masu_desc.clock_ns. */
uint64_t masu_clock_ns(void *user);

#endif

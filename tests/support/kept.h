/* kept.h: a cache of Vulkan objects for a test program. Devices, and objects compiled on them,
 * outlive the sessions that created them; a later session with the same requests gets them again.
 *
 * A test program opens dozens of sessions with mostly the same shaders, and a software driver
 * spends more time on compilation than on frames (SwiftShader: two thirds). Programs of tests/gpu
 * are linked with --wrap for the functions of KEPT_FUNCTIONS in tests.mk; no other code depends on
 * the cache. The wrappers of wrap.h, which count calls and make them fail, are called first.
 *
 * Cached until the process ends: instances, devices, shader modules, samplers, layouts, render
 * passes and pipelines, each by its complete description. Calls with an allocator or an unknown
 * extension of the description pass through. All other objects are counted; if a device is
 * destroyed before them, the program ends with a message, because the validation layer cannot
 * report this for cached devices. */
#ifndef SUPPORT_KEPT_H
#define SUPPORT_KEPT_H

#include <stdint.h>

/* Number of pipelines requested, and of those compiled. */
typedef struct kept_counts {
    uint32_t asked, compiled;
} kept_counts;

extern kept_counts kept;

/* The next session gets a new device, for decisions that a driver makes at device creation. If a
 * session is open, the program ends with a message. */
void kept_forget(void);

#endif

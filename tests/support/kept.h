/* kept.h: Vulkan of a test program, in which devices and what is compiled on them outlive the sessions
 * that ask for them: the next session that asks for the same gets the same.
 *
 * A test program opens dozens of sessions whose shaders are mostly the same, and a software driver spends
 * more time on compiling them than on the frames (of SwiftShader's time two thirds). Programs of tests/gpu
 * are linked with --wrap for the functions of KEPT_FUNCTIONS in tests.mk; nobody else knows of this, and
 * the wrappers of wrap.h, which count and fail calls, stand before it.
 *
 * Kept until the process ends: instances, devices, shader modules, samplers, layouts, render passes and
 * pipelines, each by everything that its description says; what has an allocator or an extension of its
 * description that is not known here is passed on. What else renderers make is counted, and a device that is
 * destroyed before it ends the process with a line: the validation layer says so of no device any more. */
#ifndef SUPPORT_KEPT_H
#define SUPPORT_KEPT_H

#include <stdint.h>

/* How many pipelines were asked for, and how many of them were compiled. */
typedef struct kept_counts {
    uint32_t asked, compiled;
} kept_counts;

extern kept_counts kept;

/* The next session gets a device of its own: for what a driver decides when a device is made. The program ends with a
 * line if a session is open. */
void kept_forget(void);

#endif

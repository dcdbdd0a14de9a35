/* error.h: fills a masu_detail and writes to the host's log. No state, no allocation; text is
 * truncated to the size of the detail. */
#ifndef MASU_ERROR_H
#define MASU_ERROR_H

#include "masu.h"

/* Fills `detail` (may be NULL) and returns `result`: `return masu_fail(...)`. `what` must be a
 * string constant. */
#if defined(__GNUC__)
__attribute__((format(printf, 6, 7)))
#endif
masu_result
masu_fail(masu_detail *detail, masu_result result, const char *what, uint64_t needed,
          uint64_t given, const char *format, ...);

/* The argument named `what` is NULL. */
masu_result masu_fail_null(masu_detail *detail, const char *what);

/* A number is out of range: "camera.fov_y is 0, allowed are 0.0005 to 3.1 radians". */
masu_result masu_fail_number(masu_detail *detail, const char *what, double given,
                             const char *allowed);
/* The same for an array element: "camera.position[1] is nan, allowed are ...". */
masu_result masu_fail_element(masu_detail *detail, const char *what, uint32_t index, double given,
                              const char *allowed);

/* A Vulkan call returned `vk` < 0: MASU_ERROR_DEVICE_LOST or MASU_ERROR_VULKAN; names the call. */
masu_result masu_fail_vulkan(masu_detail *detail, VkResult vk, const char *call);

/* True if creation failed; sets the handle to null. A failing call may leave its output undefined
 * (specification, "Return Codes"), and cleanup must not destroy such a handle. */
#define MASU_FAILED(r, handle) ((r) != VK_SUCCESS && ((handle) = VK_NULL_HANDLE, 1))

/* The member `bytes` of a host's description differs from `needed`. `type`: "masu_desc". */
masu_result masu_fail_bytes(masu_detail *detail, const char *type, size_t needed, uint32_t given);

/* Writes one line to the host's log, if there is one. */
void masu_log(const masu_desc *desc, masu_log_level level, const char *text);

/* The result of a public function: logs the error `own` and copies it to `detail`, which may be
 * NULL. A `desc` that is NULL or of another size has no log. */
masu_result masu_finish_desc(const masu_desc *desc, masu_result result, const masu_detail *own,
                             masu_detail *detail);

#endif

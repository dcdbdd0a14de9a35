/* error.c: see error.h. */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

const char *masu_result_string(masu_result result) {
    switch (result) {
    case MASU_OK: return "success";
    case MASU_INCOMPLETE: return "not finished: call again";
    case MASU_ERROR_ARGUMENT: return "an argument is missing, out of range or not finite";
    case MASU_ERROR_MEMORY: return "a memory block is missing, misaligned or too small";
    case MASU_ERROR_LIMIT: return "a limit or budget of the description is exceeded";
    case MASU_ERROR_DEVICE: return "the device lacks a required feature";
    case MASU_ERROR_SCENE: return "the scene blob is corrupt";
    case MASU_ERROR_VERSION: return "the scene blob has another format version: bake it again";
    case MASU_ERROR_VULKAN: return "a Vulkan call failed";
    case MASU_ERROR_DEVICE_LOST: return "the Vulkan device was lost";
    case MASU_ERROR_STATE: return "called out of order";
    case MASU_RESULT_FORCE_32: break;
    }
    return "unknown result";
}

masu_result masu_fail(masu_detail *detail, masu_result result, const char *what, uint64_t needed,
                      uint64_t given, const char *format, ...) {
    if (detail) {
        detail->result = result;
        detail->vulkan = VK_SUCCESS;
        detail->what = what;
        detail->needed = needed;
        detail->given = given;
        va_list args;
        va_start(args, format);
        vsnprintf(detail->text, sizeof detail->text, format, args);
        va_end(args);
    }
    return result;
}

masu_result masu_fail_null(masu_detail *detail, const char *what) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 1, 0, "%s is NULL", what);
}

masu_result masu_fail_number(masu_detail *detail, const char *what, double given,
                             const char *allowed) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s is %.9g, allowed are %s", what,
                     given, allowed);
}

masu_result masu_fail_element(masu_detail *detail, const char *what, uint32_t index, double given,
                              const char *allowed) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s[%u] is %.9g, allowed are %s",
                     what, index, given, allowed);
}

masu_result masu_fail_vulkan(masu_detail *detail, VkResult vk, const char *call) {
    masu_result result = vk == VK_ERROR_DEVICE_LOST ? MASU_ERROR_DEVICE_LOST : MASU_ERROR_VULKAN;
    masu_fail(detail, result, call, 0, 0, "%s failed with VkResult %d", call, (int)vk);
    if (detail) detail->vulkan = vk;
    return result;
}

masu_result masu_fail_bytes(masu_detail *detail, const char *type, size_t needed, uint32_t given) {
    return masu_fail(
        detail, MASU_ERROR_ARGUMENT, "bytes", needed, given,
        "%s.bytes is %u, this library (%d.%d.%d) needs %u: compile with its masu.h, and "
        "set it to sizeof(%s)",
        type, given, MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH, (unsigned)needed,
        type);
}

masu_result masu_finish_desc(const masu_desc *desc, masu_result result, const masu_detail *own,
                             masu_detail *detail) {
    if (result >= 0) return result;
    if (desc && desc->bytes == sizeof *desc) masu_log(desc, MASU_LOG_ERROR, own->text);
    if (detail) *detail = *own;
    return result;
}

void masu_log(const masu_desc *desc, masu_log_level level, const char *text) {
    if (desc->log) desc->log(desc->log_user, level, text);
}

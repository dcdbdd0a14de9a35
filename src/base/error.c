/* error.c: see error.h. */
#include "base/error.h"

#include <stdarg.h>
#include <stdio.h>

const char *masu_result_string(masu_result result) {
    switch (result) {
#define MASU_RESULT_TEXT(name, value, text)                                                        \
    case name: return text;
        MASU_RESULTS(MASU_RESULT_TEXT)
#undef MASU_RESULT_TEXT
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

void masu_log(const masu_desc *desc, masu_log_level level, const char *text) {
    if (desc->log) desc->log(desc->log_user, level, text);
}

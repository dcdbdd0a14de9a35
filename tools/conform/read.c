/* read.c: see read.h. */
#include "conform/read.h"

#include "settings/knobs.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool masu_suite_wrong(const masu_suite_place *at, const char *key, const char *format, ...) {
    char text[400];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    snprintf(at->error, at->error_size, "%s: %s%s%s%s%s: %s", at->suite->file,
             at->case_name ? "case '" : "", at->case_name ? at->case_name : "",
             at->case_name ? "'" : "", at->case_name && key ? ": " : "", key ? key : "", text);
    return false;
}

bool masu_suite_number(const masu_suite_place *at, const char *key, const json_t *value, double low,
                       double high, bool whole, double *out) {
    char text[80];
    double v = json_number_value(value);
    if (json_is_number(value) && v >= low && v <= high && (!whole || v == floor(v))) {
        *out = v;
        return true;
    }
    return masu_suite_wrong(at, key, "expected a %snumber from %.10g to %.10g, found %s",
                            whole ? "whole " : "", low, high,
                            masu_json_given(value, text, sizeof text));
}

bool masu_suite_count(const masu_suite_place *at, const char *key, const json_t *value,
                      uint32_t low, uint32_t high, uint32_t *out) {
    double v = 0.0;
    if (!masu_suite_number(at, key, value, low, high, true, &v)) return false;
    *out = (uint32_t)v;
    return true;
}

bool masu_suite_flag(const masu_suite_place *at, const char *key, const json_t *value, bool *out) {
    char text[80];
    if (!json_is_boolean(value))
        return masu_suite_wrong(at, key, "expected true or false, found %s",
                                masu_json_given(value, text, sizeof text));
    *out = json_is_true(value);
    return true;
}

bool masu_suite_string(const masu_suite_place *at, const char *key, const json_t *value,
                       const char **out) {
    char text[80];
    if (!json_is_string(value) || !json_string_length(value)) {
        return masu_suite_wrong(at, key, "expected a non-empty string, found %s",
                                masu_json_given(value, text, sizeof text));
    }
    *out = json_string_value(value);
    return true;
}

bool masu_suite_object(const masu_suite_place *at, const char *key, const json_t *value) {
    char text[80];
    return json_is_object(value) || masu_suite_wrong(at, key, "expected an object, found %s",
                                                     masu_json_given(value, text, sizeof text));
}

/* Matches one of the names; *out is its index. */
bool masu_suite_choice(const masu_suite_place *at, const char *key, const json_t *value,
                       const char *const *names, uint32_t *out) {
    char text[80], list[200] = "";
    for (uint32_t i = 0; names[i]; i++) {
        if (json_is_string(value) && !strcmp(names[i], json_string_value(value))) {
            *out = i;
            return true;
        }
        size_t n = strlen(list);
        snprintf(list + n, sizeof list - n, "%s%s", i ? ", " : "", names[i]);
    }
    return masu_suite_wrong(at, key, "expected one of %s, found %s", list,
                            masu_json_given(value, text, sizeof text));
}

/* An array of names; *out has one bit per name. */
bool masu_suite_names(const masu_suite_place *at, const char *key, const json_t *value,
                      const char *const *names, uint32_t *out) {
    char text[80];
    if (!json_is_array(value))
        return masu_suite_wrong(at, key, "expected an array, found %s",
                                masu_json_given(value, text, sizeof text));
    *out = 0;
    for (size_t i = 0; i < json_array_size(value); i++) {
        uint32_t bit = 0;
        if (!masu_suite_choice(at, key, json_array_get(value, i), names, &bit)) return false;
        *out |= 1u << bit;
    }
    return true;
}

bool masu_suite_unknown(const masu_suite_place *at, const char *group, const char *key) {
    char text[160];
    snprintf(text, sizeof text, "%s%s%.100s", group, group[0] ? "." : "", key);
    return masu_suite_wrong(at, text, "unknown key");
}

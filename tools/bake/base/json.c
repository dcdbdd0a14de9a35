/* json.c: strict JSON; see json.h. */
#include "bake/base/json.h"
#include "bake/base/file.h"
#include "cli/cli.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define FILE_MAX ((size_t)16 << 20)

bool masu_bake_json_load(const char *path, json_t **root) {
    masu_bake_buffer text = {0};
    json_error_t error;
    *root = NULL;
    bool good = masu_bake_read_file(path, FILE_MAX, &text);
    if (good) {
        *root = json_loadb((const char *)text.data, text.bytes, JSON_REJECT_DUPLICATES, &error);
        if (!*root) masu_cli_error("%s:%d:%d: %s", path, error.line, error.column, error.text);
        good = *root != NULL;
    }
    masu_bake_release(&text);
    return good;
}

bool masu_bake_json_wrong(const masu_bake_json *at, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(text, sizeof text, format, arguments) < 0) text[0] = '\0';
    va_end(arguments);
    if (at->where[0])
        masu_cli_error("%s: %s: %s", at->file, at->where, text);
    else
        masu_cli_error("%s: %s", at->file, text);
    return false;
}

static bool wrong_type(const masu_bake_json *at, const char *wanted) {
    static const char *const names[] = {"an object", "an array", "a string", "a number",
                                        "a number",  "true",     "false",    "null"};
    if (!at->value) return masu_bake_json_wrong(at, "is missing, expected %s", wanted);
    return masu_bake_json_wrong(at, "expected %s, found %s", wanted, names[json_typeof(at->value)]);
}

/* A name of more than the room there is loses its end. */
static void set_where(masu_bake_json *at, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    if (vsnprintf(at->where, sizeof at->where, format, arguments) < 0) at->where[0] = '\0';
    va_end(arguments);
}

masu_bake_json masu_bake_json_member(const masu_bake_json *at, const char *name) {
    masu_bake_json member = {at->file, json_object_get(at->value, name), ""};
    set_where(&member, "%s%s%s", at->where, at->where[0] ? "." : "", name);
    return member;
}

masu_bake_json masu_bake_json_element(const masu_bake_json *at, size_t index) {
    masu_bake_json element = {at->file, json_array_get(at->value, index), ""};
    set_where(&element, "%s[%zu]", at->where, index);
    return element;
}

bool masu_bake_json_has(const masu_bake_json *at, const char *name) {
    return json_object_get(at->value, name) != NULL;
}

bool masu_bake_json_object(const masu_bake_json *at, const char *const *members) {
    if (!json_is_object(at->value)) return wrong_type(at, "an object");
    const char *key;
    json_t *value;
    json_object_foreach(at->value, key, value) {
        const char *const *known = members;
        while (*known && strcmp(*known, key) != 0) known++;
        if (*known) continue;
        masu_bake_json member = masu_bake_json_member(at, key);
        return masu_bake_json_wrong(&member, "unknown key");
    }
    return true;
}

bool masu_bake_json_array(const masu_bake_json *at, size_t least) {
    if (!json_is_array(at->value)) return wrong_type(at, "an array");
    size_t size = json_array_size(at->value);
    if (size >= least) return true;
    return masu_bake_json_wrong(at, "expected at least %zu elements, found %zu", least, size);
}

static bool read_number(const masu_bake_json *at, double low, double high, double *out) {
    if (!json_is_number(at->value)) return wrong_type(at, "a number");
    double number = json_number_value(at->value);
    if (!(number >= low && number <= high)) {
        return masu_bake_json_wrong(at, "expected a number from %g to %g, found %g", low, high,
                                    number);
    }
    *out = number;
    return true;
}

bool masu_bake_json_number(const masu_bake_json *at, const char *name, double low, double high,
                           double *out) {
    masu_bake_json member = masu_bake_json_member(at, name);
    return !member.value || read_number(&member, low, high, out);
}

bool masu_bake_json_whole(const masu_bake_json *at, const char *name, uint32_t low, uint32_t high,
                          uint32_t *out) {
    double value = *out;
    if (!masu_bake_json_number(at, name, low, high, &value)) return false;
    if (value != floor(value)) {
        masu_bake_json where = masu_bake_json_member(at, name);
        return masu_bake_json_wrong(&where, "expected a whole number");
    }
    *out = (uint32_t)value;
    return true;
}

bool masu_bake_json_vec3(const masu_bake_json *at, const char *name, double low, double high,
                         masu_bake_vec3 *out) {
    masu_bake_json member = name ? masu_bake_json_member(at, name) : *at;
    if (!member.value && name) return true;
    if (!json_is_array(member.value)) return wrong_type(&member, "three numbers in an array");
    if (json_array_size(member.value) != 3) {
        return masu_bake_json_wrong(&member, "expected three numbers, found %zu",
                                    json_array_size(member.value));
    }
    double numbers[3];
    for (size_t i = 0; i < 3; i++) {
        masu_bake_json element = masu_bake_json_element(&member, i);
        if (!read_number(&element, low, high, &numbers[i])) return false;
    }
    *out = masu_bake_v3(numbers[0], numbers[1], numbers[2]);
    return true;
}

bool masu_bake_json_box(const masu_bake_json *at, masu_bake_box *out) {
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!masu_bake_json_array(at, 2)) return false;
    if (json_array_size(at->value) != 2) return masu_bake_json_wrong(at, "expected two corners");
    masu_bake_json low = masu_bake_json_element(at, 0), high = masu_bake_json_element(at, 1);
    if (!masu_bake_json_vec3(&low, NULL, -most, most, &out->low) ||
        !masu_bake_json_vec3(&high, NULL, -most, most, &out->high)) {
        return false;
    }
    if (out->low.x < out->high.x && out->low.y < out->high.y && out->low.z < out->high.z)
        return true;
    return masu_bake_json_wrong(at, "the first corner must be the lower one");
}

bool masu_bake_json_boolean(const masu_bake_json *at, const char *name, bool *out) {
    masu_bake_json member = masu_bake_json_member(at, name);
    if (!member.value) return true;
    if (!json_is_boolean(member.value)) return wrong_type(&member, "true or false");
    *out = json_is_true(member.value);
    return true;
}

bool masu_bake_json_feature(const masu_bake_json *at, const char *name, masu_bake_json *out,
                            bool *wanted) {
    masu_bake_json member = masu_bake_json_member(at, name);
    *out = (masu_bake_json){0};
    if (!member.value) return true;
    if (json_is_boolean(member.value)) return masu_bake_json_boolean(at, name, wanted);
    if (!json_is_object(member.value)) return wrong_type(&member, "an object, true or false");
    *out = member;
    return *wanted = true;
}

bool masu_bake_json_string(const masu_bake_json *at, const char *name, const char **out) {
    masu_bake_json member = masu_bake_json_member(at, name);
    if (!member.value) return true;
    if (!json_is_string(member.value)) return wrong_type(&member, "a string");
    *out = json_string_value(member.value);
    return true;
}

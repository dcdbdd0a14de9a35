/* xml.c: reads values of TORCS's parameter files by searching for tags: sections that hold no
 * sections, and single values. It is not a parser: the files have entities and a DTD, but none near
 * the values that are read. Values are in the file's units, which are not checked. */
#include "lab/world/world.h"

#include <stdlib.h>
#include <string.h>

/* The start of the value of <KIND name="NAME" ... val="V"/> between two pointers, or NULL. */
static const char *value_of(const char *from, const char *to, const char *kind, const char *name) {
    char pattern[96];
    snprintf(pattern, sizeof pattern, "<%s name=\"%s\"", kind, name);
    const char *at = strstr(from, pattern);
    if (!at || at >= to) return NULL;
    const char *value = strstr(at, " val=\""), *end = strchr(at, '>');
    return value && end && value < end ? value + strlen(" val=\"") : NULL;
}

double masu_world_number(const char *from, const char *to, const char *name, double otherwise) {
    const char *value = value_of(from, to, "attnum", name);
    return value ? strtod(value, NULL) : otherwise;
}

bool masu_world_string(const char *from, const char *to, const char *name, char *out,
                       size_t capacity) {
    const char *value = value_of(from, to, "attstr", name);
    size_t length = value ? strcspn(value, "\"") : 0;
    if (length == 0 || length >= capacity) return false;
    memcpy(out, value, length);
    out[length] = 0;
    return true;
}

const char *masu_world_section(const char *text, const char *name, const char **end) {
    char pattern[96];
    snprintf(pattern, sizeof pattern, "<section name=\"%s\"", name);
    const char *at = strstr(text, pattern);
    *end = at ? strstr(at, "</section") : NULL;
    return *end ? at : NULL;
}

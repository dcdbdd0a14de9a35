/* json.h: reading JSON strictly. Every value that is read has a place in the file, and every
 * mistake is one line that names it:
 *
 *   scenes/engine.json: models[0].scael: unknown key
 *   scenes/engine.json: camera.fov_y: expected a number from 1 to 170, found 200
 *
 * All readers return false after reporting; the caller returns false in turn. An absent optional
 * member leaves the output as it was. */
#ifndef MASU_BAKE_JSON_H
#define MASU_BAKE_JSON_H

#include "bake/base/math.h"

#include <jansson.h>
#include <stdint.h>

typedef struct masu_bake_json {
    const char *file;
    json_t *value;   /* borrowed; NULL: absent */
    char where[160]; /* "models[0].fit"; "" at the top */
} masu_bake_json;

/* Parses a file. False: not readable or no JSON (with the line). Release `*root` by json_decref. */
bool masu_bake_json_load(const char *path, json_t **root);

/* Reports "file: where: message". Always false. */
bool masu_bake_json_wrong(const masu_bake_json *at, const char *format, ...);

/* `at` is an object with no other members than these; NULL ends the list. */
bool masu_bake_json_object(const masu_bake_json *at, const char *const *members);
/* `at` is an array of at least `least` elements. */
bool masu_bake_json_array(const masu_bake_json *at, size_t least);

masu_bake_json masu_bake_json_member(const masu_bake_json *at, const char *name);
masu_bake_json masu_bake_json_element(const masu_bake_json *at, size_t index);

/* Members of the object `at`. */
bool masu_bake_json_number(const masu_bake_json *at, const char *name, double low, double high,
                           double *out);
/* A number without a fraction; *out is the value in its absence. */
bool masu_bake_json_whole(const masu_bake_json *at, const char *name, uint32_t low, uint32_t high,
                          uint32_t *out);
/* `name` NULL: `at` itself. */
bool masu_bake_json_vec3(const masu_bake_json *at, const char *name, double low, double high,
                         masu_bake_vec3 *out);
/* Two corners, the lower one first; `at` is the array itself. */
bool masu_bake_json_box(const masu_bake_json *at, masu_bake_box *out);
bool masu_bake_json_boolean(const masu_bake_json *at, const char *name, bool *out);
bool masu_bake_json_string(const masu_bake_json *at, const char *name, const char **out);
/* A feature given as an object with its settings, or as true or false. *out: the object, or
 * null; *wanted is unchanged if the member is absent. */
bool masu_bake_json_feature(const masu_bake_json *at, const char *name, masu_bake_json *out,
                            bool *wanted);
bool masu_bake_json_has(const masu_bake_json *at, const char *name);

#endif

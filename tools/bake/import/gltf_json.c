/* gltf_json.c: members of a glTF file's JSON, each of the type that it must have; see gltf.h. */
#include "bake/import/gltf.h"

#include <math.h>

const json_t *masu_gltf_object(masu_gltf *g, const json_t *of, const char *name) {
    const json_t *value = json_object_get(of, name);
    if (value && !json_is_object(value)) masu_gltf_fail(g, "\"%s\": expected an object", name);
    return json_is_object(value) ? value : NULL;
}

const json_t *masu_gltf_array(masu_gltf *g, const json_t *of, const char *name) {
    const json_t *value = json_object_get(of, name);
    if (value && !json_is_array(value)) masu_gltf_fail(g, "\"%s\": expected an array", name);
    return json_is_array(value) ? value : NULL;
}

const char *masu_gltf_string(masu_gltf *g, const json_t *of, const char *name) {
    const json_t *value = json_object_get(of, name);
    if (value && !json_is_string(value)) masu_gltf_fail(g, "\"%s\": expected a string", name);
    return json_string_value(value);
}

bool masu_gltf_number(masu_gltf *g, const json_t *of, const char *name, double *out) {
    const json_t *value = json_object_get(of, name);
    if (!value) return true;
    if (!json_is_number(value)) return masu_gltf_fail(g, "\"%s\": expected a number", name);
    *out = json_number_value(value);
    return true;
}

bool masu_gltf_numbers(masu_gltf *g, const json_t *of, const char *name, size_t count,
                       double *out) {
    const json_t *value = json_object_get(of, name);
    if (!value) return true;
    bool good = json_is_array(value) && json_array_size(value) == count;
    for (size_t i = 0; good && i < count; i++) good = json_is_number(json_array_get(value, i));
    if (!good) return masu_gltf_fail(g, "\"%s\": expected %zu numbers", name, count);
    for (size_t i = 0; i < count; i++) out[i] = json_number_value(json_array_get(value, i));
    return true;
}

bool masu_gltf_flag(masu_gltf *g, const json_t *of, const char *name, bool *out) {
    const json_t *value = json_object_get(of, name);
    if (!value) return true;
    if (!json_is_boolean(value)) return masu_gltf_fail(g, "\"%s\": expected true or false", name);
    *out = json_is_true(value);
    return true;
}

bool masu_gltf_size(masu_gltf *g, const json_t *of, const char *name, uint64_t *out) {
    const json_t *value = json_object_get(of, name);
    double number = json_number_value(value);
    if (!value) return true;
    if (!json_is_number(value) || !(number >= 0 && number <= 0x1p53) || number != floor(number))
        return masu_gltf_fail(g, "\"%s\": expected an unsigned integer", name);
    *out = (uint64_t)number;
    return true;
}

bool masu_gltf_index(masu_gltf *g, const json_t *of, const char *name, size_t count,
                     json_int_t *out) {
    uint64_t index = UINT64_MAX;
    *out = -1;
    if (!masu_gltf_size(g, of, name, &index)) return false;
    if (index == UINT64_MAX) return true;
    if (index >= count) {
        return masu_gltf_fail(g, "\"%s\": index %llu of %zu elements", name,
                              (unsigned long long)index, count);
    }
    *out = (json_int_t)index;
    return true;
}

const json_t *masu_gltf_extension(masu_gltf *g, const json_t *of, const char *name) {
    const json_t *all = masu_gltf_object(g, of, "extensions");
    return all ? masu_gltf_object(g, all, name) : NULL;
}

const json_t *masu_gltf_element(masu_gltf *g, const char *array, json_int_t index) {
    const json_t *value = json_array_get(json_object_get(g->root, array), (size_t)index);
    if (!json_is_object(value))
        masu_gltf_fail(g, "%s[%lld]: expected an object", array, (long long)index);
    return json_is_object(value) ? value : NULL;
}

size_t masu_gltf_count(const masu_gltf *g, const char *array) {
    return json_array_size(json_object_get(g->root, array)); /* 0 if it is not an array */
}

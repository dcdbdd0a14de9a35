/* lights.c: the scene's own punctual lights, after those of its models; see build.h. Fails if an
 * instance of that name is missing, or if there are too many lights in total. */
#include "bake/build/parts.h"

#include <stdio.h>
#include <string.h>

/* The first instance of that name. */
static bool find_instance(const masu_bake_content *content, const char *name, uint32_t *found) {
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES) && *name; i++) {
        if (strcmp(masu_bake_name_text(content, MASU_BAKE_INSTANCES(content)[i].name), name))
            continue;
        *found = (uint32_t)i;
        return true;
    }
    return false;
}

bool masu_bake_build_lights(const masu_bake_description *d, masu_bake_content *content) {
    for (size_t i = 0; i < d->light_count; i++) {
        const masu_bake_light *from = &d->lights[i];
        masu_blob_light light = from->value;
        if (from->instance && !find_instance(content, from->instance, &light.parent)) {
            char where[160];
            snprintf(where, sizeof where, "%s.instance", from->where);
            return masu_bake_wrong(d, where, "no instance is named \"%s\"", from->instance);
        }
        if (from->name) light.name = masu_bake_name(content, from->name, strlen(from->name));
        masu_bake_append(&content->section[MASU_BLOB_LIGHTS], &light, sizeof light);
    }
    uint64_t all = masu_bake_count(content, MASU_BLOB_LIGHTS);
    if (all <= MASU_BLOB_LIGHTS_MAX) return true;
    return masu_bake_wrong(d, "", "%llu lights, including those of models; expected at most %u",
                           (unsigned long long)all, MASU_BLOB_LIGHTS_MAX);
}

/* variants.c: reads the names of the material variants of a glTF file (KHR_materials_variants) for
 * the panel "Scene". */
#include "view/viewer.h"

#include "image.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BYTES_MAX ((size_t)1 << 30)
#define BINARY_HEAD                                                                                \
    20u /* of a .glb: magic, version, length, length of the first chunk, its type: JSON */

void masu_baker_read_variants(masu_viewer *v) {
    masu_baker *b = &v->baker;
    uint8_t *bytes = NULL;
    size_t count = 0, from = 0, length;
    const char *dot = strrchr(b->source, '.');
    b->variant_count = 0;
    if (!dot || (strcmp(dot, ".glb") != 0 && strcmp(dot, ".gltf") != 0)) return;
    if (!masu_file_read(b->source, BYTES_MAX, &bytes, &count, NULL, 0)) return;
    length = count;
    if (count > BINARY_HEAD && !memcmp(bytes, "glTF", 4)) {
        from = BINARY_HEAD;
        length =
            bytes[12] | (size_t)bytes[13] << 8 | (size_t)bytes[14] << 16 | (size_t)bytes[15] << 24;
        if (length > count - from) length = count - from;
    }
    json_t *root = json_loadb((const char *)bytes + from, length, 0, NULL);
    const json_t *extension =
        json_object_get(json_object_get(root, "extensions"), "KHR_materials_variants");
    const json_t *list = json_object_get(extension, "variants"), *each;
    size_t i;
    json_array_foreach(list, i, each) {
        const char *name = json_string_value(json_object_get(each, "name"));
        if (!name || b->variant_count == MASU_VARIANTS_MAX) continue;
        snprintf(b->variants[b->variant_count++], sizeof b->variants[0], "%s", name);
    }
    json_decref(root);
    free(bytes);
}

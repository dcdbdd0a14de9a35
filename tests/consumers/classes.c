/* classes.c: classes CLASS BLOB...: whether a library of one class takes each scene, without a device. Linked by
 * tests/scripts/sizes.sh with the object that differs between libraries, so it looks inside: the plan is that
 * of masu_init, up to where a device would be asked. A line for each: "CLASS takes FILE" or "CLASS refuses FILE: why". */
#include "device/shaders.h"
#include "masu.h"
#include "plan/compile.h"

#include <stdio.h>
#include <stdlib.h>

static void *read_whole(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    if (!f || fseek(f, 0, SEEK_END)) return NULL;
    *size = (size_t)ftell(f);
    rewind(f);
    void *bytes = aligned_alloc(64, (*size + 63) / 64 * 64);
    int whole = bytes && fread(bytes, 1, *size, f) == *size;
    fclose(f);
    return whole ? bytes : NULL;
}

int main(int argc, char **argv) {
    static masu_frame_plan plan;
    static const masu_aa ways[] = {MASU_AA_AUTO, MASU_AA_FXAA, MASU_AA_SMAA_HIGH, MASU_AA_OFF};
    for (int i = 2; i < argc; i++) {
        masu_scene scene;
        masu_detail detail = {0};
        size_t size;
        void *blob = read_whole(argv[i], &size);
        if (!blob || masu_scene_bind(blob, size, &scene, &detail)) {
            fprintf(stderr, "%s: %s\n", argv[i], blob ? detail.text : "cannot be read");
            return 1;
        }
        masu_desc desc = {MASU_DESC, .scene = &scene, .output = {640, 360},
                          .targets = {.count = 1, .storage = 1}, .rung_count = 4};
        for (uint32_t r = 0; r < desc.rung_count; r++) {
            desc.rungs[r].scale = r ? 0.5f : 1.0f;
            desc.rungs[r].aa = ways[r];
        }
        desc.rungs[3].temporal = MASU_ON;
        /* Handles that nobody uses: a plan asks whether there are some. */
        VkImage image = (VkImage)(uintptr_t)1;
        VkImageView view = (VkImageView)(uintptr_t)1;
        desc.targets.images = &image;
        desc.targets.views = &view;
        masu_result result = masu_compile(&desc, 256, 64, &plan, &detail);
        if (result) {
            fprintf(stderr, "%s: %s\n", argv[i], detail.text);
            return 1;
        }
        result = masu_code_check(&plan, &detail);
        const char *of = masu_scene_class_name(masu_scene_class_of(&scene));
        if (result) printf("%s refuses %s (%s): %s\n", argv[1], argv[i], of, detail.text);
        else printf("%s takes %s (%s)\n", argv[1], argv[i], of);
        free(blob);
    }
    return 0;
}

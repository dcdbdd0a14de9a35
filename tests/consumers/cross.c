/* cross.c: cross SCENE...: what the library computes without a device, as text that is the same on every machine:
 * a hash of all shaders unpacked, and of each scene's plan the passes, images and buffers. For cross.sh; looks inside. */
#include "device/shaders.h"
#include "masu.h"
#include "plan/compile.h"

#include "packed.h"

#include <stdio.h>
#include <stdlib.h>

static const masu_packed all[] = {
#define EACH(name) MASU_PACKED_##name,
    MASU_PACKED_EACH(EACH)
#undef EACH
};

static uint64_t h = 0xCBF29CE484222325u;

static void hash(uint64_t value) {
    for (int i = 0; i < 8; i++, value >>= 8) h = (h ^ (value & 255)) * 0x100000001B3u;
}

static void *read_whole(const char *path, size_t *size) {
    FILE *f = fopen(path, "rb");
    if (!f || fseek(f, 0, SEEK_END)) return NULL;
    *size = (size_t)ftell(f);
    rewind(f);
    char *bytes = malloc(*size + 64);
    if (!bytes) return NULL;
    bytes += 64 - (uintptr_t)bytes % 64; /* kept to the end of the program */
    int whole = fread(bytes, 1, *size, f) == *size;
    fclose(f);
    return whole ? bytes : NULL;
}

int main(int argc, char **argv) {
    static masu_frame_plan plan;
    static uint32_t words[1 << 16];
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        if (all[i].words > sizeof words / sizeof *words ||
            !masu_unpack(&masu_pack_of_all, &all[i], words))
            return 1;
        for (uint32_t k = 0; k < all[i].words; k++) hash(words[k]);
    }
    printf("shaders %08lx%08lx\n", (unsigned long)(h >> 32), (unsigned long)(h & 0xFFFFFFFFu));
    for (int i = 1; i < argc; i++) {
        masu_scene scene;
        masu_detail detail = {0};
        size_t size;
        void *blob = read_whole(argv[i], &size);
        VkImage image = (VkImage)(uintptr_t)1;
        VkImageView view = (VkImageView)(uintptr_t)1;
        if (!blob || masu_scene_bind(blob, size, &scene, &detail)) {
            printf("%s: %s\n", argv[i], blob ? detail.text : "cannot be read");
            continue;
        }
        masu_desc desc = {MASU_DESC, .scene = &scene, .output = {1280, 720},
                          .targets = {&image, &view, 1, .storage = 1}};
        if (masu_compile(&desc, 256, 64, &plan, &detail)) {
            printf("%s: %s\n", argv[i], detail.text);
            continue;
        }
        h = 0xCBF29CE484222325u;
        for (uint32_t k = 0; k < MASU_IMAGE_COUNT; k++) {
            const masu_image_plan *p = &plan.images[k];
            hash(p->used ? (uint64_t)p->width << 32 | p->height : 0);
            hash(p->used ? (uint64_t)p->first << 32 | p->last : 0);
        }
        for (uint32_t k = 0; k < MASU_BUFFER_COUNT; k++) hash(plan.buffers[k].bytes);
        for (uint32_t r = 0; r < plan.desc.rung_count; r++)
            for (uint32_t p = 0; p < MASU_PASS_COUNT; p++)
                hash((uint64_t)masu_has_pass(&plan.rungs[r].active, p));
        printf("%s %s %08lx%08lx\n", argv[i], masu_scene_class_name(masu_scene_class_of(&scene)),
               (unsigned long)(h >> 32), (unsigned long)(h & 0xFFFFFFFFu));
    }
    return 0;
}

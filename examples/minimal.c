/* minimal.c SCENE.masu OUT.png: the least a port does. Its own device and image come from platform/headless.h here. */
#include "headless.h"
#include "image.h"
#include "masu.h"

#include <stdio.h>
#include <stdlib.h>

#define CHECK(call) do { if (!(call)) { fprintf(stderr, "%s%s\n", error, detail.text); return 1; } } while (0)

int main(int argc, char **argv) {
    masu_headless host;
    masu_headless_target image;
    masu_detail detail = {0};
    char error[512] = "";
    uint8_t *blob;
    size_t blob_bytes;
    CHECK(argc == 3 && masu_file_read(argv[1], 1 << 30, &blob, &blob_bytes, error, sizeof error));
    CHECK(masu_headless_open(&(masu_headless_desc){0}, &host, error, sizeof error));
    CHECK(masu_headless_target_create(&host, 1280, 720, VK_FORMAT_R8G8B8A8_UNORM, true, &image, error, sizeof error));

    masu_scene scene;
    CHECK(masu_scene_bind(blob, blob_bytes, &scene, &detail) == MASU_OK);
    masu_desc desc = {
        .vulkan = {vkGetInstanceProcAddr, host.instance, host.physical, host.device, host.family},
        .scene = &scene,
        .output = {1280, 720},
        .targets = {.images = &image.image, .views = &image.view, .count = 1, .storage = 1},
    };
    masu_memory need;
    CHECK(masu_memory_query(&desc, &need, &detail) == MASU_OK);
    printf("the box: %llu bytes host, %llu bytes device\n", (unsigned long long)need.host_bytes,
           (unsigned long long)need.device_bytes);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    masu_renderer *m;
    CHECK(masu_init(&desc, block, need.host_bytes, &m, &detail) == MASU_OK);
    masu_commands commands;
    while (masu_load(m, &commands) == MASU_INCOMPLETE) CHECK(masu_headless_run(&host, commands.buffer, error, sizeof error));

    for (int i = 0; i < 10; i++) { /* nothing is allocated from here on; rung 2 renders 512x288 and upscales */
        masu_frame_desc frame = {.time = i / 60.0, .rung = i < 9 ? 2 : 0};
        CHECK(masu_frame(m, &frame, &commands) == MASU_OK);
        CHECK(masu_headless_run(&host, commands.buffer, error, sizeof error));
    }
    CHECK(masu_headless_target_read(&host, &image, error, sizeof error));
    CHECK(masu_image_save_png(argv[2], image.mapped, 1280, 720, 0, error, sizeof error));
    masu_destroy(m);
    free(block);
    free(blob);
    masu_headless_target_destroy(&host, &image);
    masu_headless_close(&host);
    return 0;
}

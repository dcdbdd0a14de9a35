/* minimal.c SCENE.masu OUT.png: a minimal port: renders ten frames and saves the last one. A real
 * port has its own device and target images; here platform/headless.h creates them. */
#include "headless.h"
#include "image.h"
#include "masu.h"

#include <stdio.h>
#include <stdlib.h>

#define CHECK(call)                                                                                \
    if (!(call)) return fprintf(stderr, "%s%s\n", error, detail.text), 1

int main(int argc, char **argv) {
    masu_headless host;
    masu_headless_target image;
    masu_detail detail = {0};
    char error[512] = "";
    uint8_t *blob;
    size_t size, room = sizeof error;
    if (argc != 3) return fprintf(stderr, "usage: minimal SCENE.masu OUT.png\n"), 2;
    CHECK(masu_file_read(argv[1], 1 << 30, &blob, &size, error, room));
    CHECK(masu_headless_open(&(masu_headless_desc){0}, &host, error, room));
    CHECK(masu_headless_target_create(&host, 1280, 720, VK_FORMAT_R8G8B8A8_UNORM, true, &image,
                                      error, room));
    masu_scene scene;
    CHECK(masu_scene_bind(blob, size, &scene, &detail) == MASU_OK);
    masu_desc desc = {
        MASU_DESC,
        .vulkan = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                   .instance = host.instance,
                   .physical_device = host.physical,
                   .device = host.device,
                   .queue_family = host.family},
        .scene = &scene, .output = {1280, 720},
        .targets = {.images = &image.image, .views = &image.view, .count = 1, .storage = 1}};
    masu_memory need;
    CHECK(masu_memory_query(&desc, &need, &detail) == MASU_OK);
    printf("memory: %llu bytes host, %llu bytes device\n", (unsigned long long)need.host_bytes,
           (unsigned long long)need.device_bytes);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    masu_renderer *m;
    masu_commands commands;
    CHECK(masu_init(&desc, block, need.host_bytes, &m, &detail) == MASU_OK);
    while (masu_load(m, &commands, &detail) == MASU_INCOMPLETE) {
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    for (int i = 0; i < 10; i++) { /* no allocation from here on */
        masu_frame_desc frame = {MASU_FRAME_DESC, .time = i / 60.0, .rung = i < 9 ? 2 : 0};
        CHECK(masu_frame(m, &frame, &commands, &detail) == MASU_OK);
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    CHECK(masu_headless_target_read(&host, &image, error, room));
    CHECK(masu_image_save_png(argv[2], image.mapped, 1280, 720, 0, error, room));
    masu_destroy(m);
    masu_headless_target_destroy(&host, &image);
    masu_headless_close(&host);
    free(block);
    free(blob);
    return 0;
}

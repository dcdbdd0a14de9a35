/* split_screen.c SCENE.masu OUT.png: two views of one scene in one image, each with its own camera,
 * as for two players. One renderer: memory for the scene once, images as large as the larger view.
 * As in minimal.c, platform/headless.h provides the device and the image. */
#include "headless.h"
#include "image.h"
#include "masu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(call)                                                                                \
    if (!(call)) return fprintf(stderr, "%s%s\n", error, detail.text), 1

enum { WIDTH = 640, HEIGHT = 360, FRAMES = 4 };

/* The second player is two metres to the right of the first, and a metre higher. */
static masu_camera beside(const masu_camera *first) {
    masu_camera second = *first;
    double level = hypot((double)first->forward[0], (double)first->forward[2]);
    second.position[0] -= 2 * (double)first->forward[2] / fmax(level, 1e-6);
    second.position[1] += 1;
    second.position[2] += 2 * (double)first->forward[0] / fmax(level, 1e-6);
    return second;
}

int main(int argc, char **argv) {
    masu_headless host;
    masu_headless_target image;
    masu_detail detail = {0};
    char error[512] = "";
    uint8_t *blob;
    size_t size, room = sizeof error;
    if (argc != 3) return fprintf(stderr, "usage: split_screen SCENE.masu OUT.png\n"), 2;
    CHECK(masu_file_read(argv[1], 1 << 30, &blob, &size, error, room));
    CHECK(masu_headless_open(&(masu_headless_desc){.validate = true}, &host, error, room));
    CHECK(masu_headless_target_create(&host, WIDTH, HEIGHT, VK_FORMAT_R8G8B8A8_UNORM, false, &image,
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
        .scene = &scene,
        .output = {WIDTH, HEIGHT},
        .targets = {.images = &image.image, .count = 1}, /* storage targets only support a view at
                                                          * 0, 0 */
        .viewport_count = 2,
        .viewports = {{0, 0, WIDTH / 2, HEIGHT}, {WIDTH / 2, 0, WIDTH - WIDTH / 2, HEIGHT}}};
    masu_memory need;
    CHECK(masu_memory_query(&desc, &need, &detail) == MASU_OK);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    masu_renderer *m;
    masu_commands commands;
    CHECK(masu_init(&desc, block, need.host_bytes, &m, &detail) == MASU_OK);
    while (masu_load(m, &commands, &detail) == MASU_INCOMPLETE) {
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    for (int i = 0; i < FRAMES; i++) {
        double time = i / 60.0;
        masu_camera cameras[2];
        CHECK(masu_camera_at(m, time, &cameras[0], &detail) == MASU_OK);
        cameras[1] = beside(&cameras[0]);
        for (uint32_t k = 0; k < 2; k++) { /* the first view discards the image's contents, the
                                            * second keeps them */
            masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &cameras[k], .time = time,
                                     .time_step = 1 / 60.0f, .viewport = k};
            CHECK(masu_frame(m, &frame, &commands, &detail) == MASU_OK);
            CHECK(masu_headless_run(&host, commands.buffer, error, room));
        }
    }
    CHECK(masu_headless_target_read(&host, &image, error, room));
    CHECK(masu_image_save_png(argv[2], image.mapped, WIDTH, HEIGHT, 0, error, room));
    printf("two views: %llu bytes host, %llu bytes device; validation %u\n",
           (unsigned long long)need.host_bytes, (unsigned long long)need.device_bytes,
           host.messages);
    masu_destroy(m);
    masu_headless_target_destroy(&host, &image);
    masu_headless_close(&host);
    free(block);
    free(blob);
    return host.messages > 0;
}

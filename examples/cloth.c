/* cloth.c SCENE.masu MATERIAL OUT.png: a flag that waves before the camera: a mesh of the host,
 * created once and deformed in each frame. It has shadows, reflections and velocities like any
 * mesh of the scene. The device and the image are those of platform/headless.h, as in minimal.c. */
#include "headless.h"
#include "image.h"
#include "masu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(call)                                                                                \
    if (!(call)) return fprintf(stderr, "%s%s\n", error, detail.text), 1

enum {
    WIDTH = 640,
    HEIGHT = 360,
    FRAMES = 8,
    X = 25,
    Y = 17,
    VERTICES = X * Y,
    TRIANGLES = 2 * (X - 1) * (Y - 1)
};

static float positions[VERTICES][3], normals[VERTICES][3];
static uint32_t indices[TRIANGLES][3];

/* z = a sin(k x - w t), more the farther from the pole. */
static void wave(double time) {
    for (int i = 0; i < VERTICES; i++) {
        double x = (i % X) / (X - 1.0), y = (double)(i / X) / (Y - 1.0);
        double phase = 9 * x + 2 * y - 8 * time, slope = 0.12 * (sin(phase) + 9 * x * cos(phase));
        positions[i][0] = (float)(1.5 * x);
        positions[i][1] = (float)y;
        positions[i][2] = (float)(0.12 * x * sin(phase));
        normals[i][0] = (float)(-slope / 1.5);
        normals[i][1] = (float)(-0.12 * x * 2 * cos(phase));
        normals[i][2] = 1;
    }
}

static void weave(void) {
    for (uint32_t q = 0, t = 0; q < (X - 1) * (Y - 1); q++) {
        uint32_t a = q / (X - 1) * X + q % (X - 1),
                 corner[2][3] = {{a, a + 1, a + X + 1}, {a, a + X + 1, a + X}};
        for (uint32_t k = 0; k < 2; k++, t++)
            for (uint32_t c = 0; c < 3; c++) indices[t][c] = corner[k][c];
    }
}

int main(int argc, char **argv) {
    masu_headless host;
    masu_headless_target image;
    masu_detail detail = {0};
    char error[512] = "";
    uint8_t *blob;
    size_t size, room = sizeof error;
    if (argc != 4) return fprintf(stderr, "usage: cloth SCENE.masu MATERIAL OUT.png\n"), 2;
    CHECK(masu_file_read(argv[1], 1 << 30, &blob, &size, error, room));
    CHECK(masu_headless_open(&(masu_headless_desc){.validate = true}, &host, error, room));
    CHECK(masu_headless_target_create(&host, WIDTH, HEIGHT, VK_FORMAT_R8G8B8A8_UNORM, false, &image,
                                      error, room));
    masu_scene scene;
    CHECK(masu_scene_bind(blob, size, &scene, &detail) == MASU_OK);
    masu_desc desc = {MASU_DESC,
                      .vulkan = {.get_instance_proc_addr = vkGetInstanceProcAddr,
                                 .instance = host.instance,
                                 .physical_device = host.physical,
                                 .device = host.device,
                                 .queue_family = host.family},
                      .scene = &scene,
                      .output = {WIDTH, HEIGHT},
                      .targets = {.images = &image.image, .count = 1}};
    /* UINT32_MAX for an unknown name: masu_memory_query rejects it. */
    desc.reserve.meshes[0] = (masu_mesh_kind){
        .meshes = 1,
        .material = (uint32_t)masu_scene_find(&scene, MASU_SCENE_MATERIAL, argv[2]),
        .vertices = VERTICES,
        .triangles = TRIANGLES};
    masu_memory need;
    CHECK(masu_memory_query(&desc, &need, &detail) == MASU_OK);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    masu_renderer *m;
    masu_commands commands;
    CHECK(masu_init(&desc, block, need.host_bytes, &m, &detail) == MASU_OK);
    while (masu_load(m, &commands, &detail) == MASU_INCOMPLETE) {
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    masu_camera camera;
    masu_model flag;
    CHECK(masu_camera_at(m, 0, &camera, &detail) == MASU_OK);
    const float ahead = 4 / hypotf(hypotf(camera.forward[0], camera.forward[1]), camera.forward[2]);
    const float at[12] = {1, 0, 0, (float)camera.position[0] + ahead * camera.forward[0] - 0.75f,
                          0, 1, 0, (float)camera.position[1] + ahead * camera.forward[1] - 0.5f,
                          0, 0, 1, (float)camera.position[2] + ahead * camera.forward[2]};
    weave();
    wave(0);
    const masu_mesh_data data = {.positions = positions[0],
                                 .normals = normals[0],
                                 .indices = indices[0],
                                 .vertex_count = VERTICES,
                                 .triangle_count = TRIANGLES};
    CHECK(masu_mesh_create(m, 0, &data, at, &flag, &detail) == MASU_OK);
    for (int i = 0; i < FRAMES; i++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .time = i / 16.0,
                                 .time_step = 1 / 16.0f};
        wave(frame.time);
        if (i)
            CHECK(masu_mesh_deform(m, flag, positions[0], normals[0], VERTICES, &detail) ==
                  MASU_OK);
        CHECK(masu_frame(m, &frame, &commands, &detail) == MASU_OK);
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    CHECK(masu_headless_target_read(&host, &image, error, room));
    CHECK(masu_image_save_png(argv[3], image.mapped, WIDTH, HEIGHT, 0, error, room));
    printf("a flag of %u triangles: %llu bytes host, %llu bytes device; validation %u\n",
           (unsigned)TRIANGLES, (unsigned long long)need.host_bytes,
           (unsigned long long)need.device_bytes, host.messages);
    masu_destroy(m);
    masu_headless_target_destroy(&host, &image);
    masu_headless_close(&host);
    free(block);
    free(blob);
    return host.messages > 0;
}

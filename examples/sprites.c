/* sprites.c SCENE.masu OUT.png: textures that a program makes at run time: puffs of smoke from
 * an atlas, a sign as a decal, the trail of a spark, all in front of the scene's camera. The
 * device and the image are those of platform/headless.h, as in minimal.c. */
#include "headless.h"
#include "image.h"
#include "masu.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(call)                                                                                \
    if (!(call)) return fprintf(stderr, "%s%s\n", error, detail.text), 1

enum {
    WIDTH = 960,
    HEIGHT = 540,
    SIDE = 256,
    CELL = SIDE / 4,
    PUFFS = 60,
    POINTS = 64,
    FRAMES = 4
};
enum { SMOKE = 1, SIGN = 2, STREAK = 3 };

static uint8_t smoke[4 * SIDE * SIDE], sign[4 * SIDE * SIDE], streak[4 * SIDE * SIDE];

static double noise(uint32_t x, uint32_t y) {
    uint32_t h = x * 374761393u + y * 668265263u;
    h = (h ^ h >> 13) * 1274126177u;
    return (double)((h ^ h >> 16) & 0xFFFF) / 65535;
}

static double smooth_noise(double x, double y) {
    double fx = x - floor(x), fy = y - floor(y);
    uint32_t ix = (uint32_t)floor(x), iy = (uint32_t)floor(y);
    double a = noise(ix, iy) * (1 - fx) + noise(ix + 1, iy) * fx;
    return a * (1 - fy) + (noise(ix, iy + 1) * (1 - fx) + noise(ix + 1, iy + 1) * fx) * fy;
}

static void set(uint8_t *texture, int i, double gray, double alpha) {
    for (int k = 0; k < 3; k++) texture[4 * i + k] = (uint8_t)(255 * fmin(gray, 1));
    texture[4 * i + 3] = (uint8_t)(255 * fmax(0, fmin(alpha, 1)));
}

/* An atlas of 4x4 puffs, a ring with a cross, a streak that is bright in its middle. */
static void paint(void) {
    for (int i = 0; i < SIDE * SIDE; i++) {
        int x = i % SIDE, y = i / SIDE;
        double u = (x % CELL + 0.5) / CELL * 2 - 1, v = (y % CELL + 0.5) / CELL * 2 - 1, cloud = 0;
        for (int octave = 0; octave < 4; octave++)
            cloud += smooth_noise((x + 1000.0 * (y / CELL)) * (1 << octave) / 24,
                                  y * (1 << octave) / 24.0) /
                     (2 << octave);
        set(smoke, i, 0.3 + 0.9 * cloud, fmax(0, 3 * (1 - hypot(u, v)) * (cloud - 0.1)));
        double a = (x + 0.5) / SIDE * 2 - 1, b = (y + 0.5) / SIDE * 2 - 1, r = hypot(a, b);
        int ring = r < 0.95 && r > 0.75, bar = r < 0.75 && (fabs(a - b) < 0.16);
        set(sign, i, 1, ring || bar);
        set(streak, i, 1, pow(1 - fabs(b), 2) * (0.6 + 0.4 * sin(3.14159265 * 4 * a)));
    }
}

/* A point of the camera's view: right, up and ahead of it, metres. */
static void place(const masu_camera *c, double right, double up, double ahead, double out[3]) {
    double f[3], r[3], length = 0, level = hypot((double)c->forward[0], (double)c->forward[2]);
    for (int k = 0; k < 3; k++) length += (double)c->forward[k] * (double)c->forward[k];
    for (int k = 0; k < 3; k++) f[k] = (double)c->forward[k] / sqrt(length);
    r[0] = -(double)c->forward[2] / level, r[1] = 0, r[2] = (double)c->forward[0] / level;
    const double u[3] = {r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2],
                         r[0] * f[1] - r[1] * f[0]};
    for (int k = 0; k < 3; k++) out[k] = c->position[k] + r[k] * right + u[k] * up + f[k] * ahead;
}

int main(int argc, char **argv) {
    masu_headless host;
    masu_headless_target image;
    masu_detail detail = {0};
    char error[512] = "";
    uint8_t *blob;
    size_t size, room = sizeof error;
    if (argc != 3) return fprintf(stderr, "usage: sprites SCENE.masu OUT.png\n"), 2;
    CHECK(masu_file_read(argv[1], 1 << 30, &blob, &size, error, room));
    CHECK(masu_headless_open(&(masu_headless_desc){.validate = true}, &host, error, room));
    CHECK(masu_headless_target_create(&host, WIDTH, HEIGHT, VK_FORMAT_R8G8B8A8_UNORM, true, &image,
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
        .targets = {.images = &image.image, .views = &image.view, .count = 1, .storage = 1},
        .reserve = {.particles = PUFFS,
                    .decals = 1,
                    .trail_points = POINTS,
                    .textures = 3,
                    .texture_size = {SIDE, SIDE}}}; /* one texture per frame */
    masu_memory need;
    CHECK(masu_memory_query(&desc, &need, &detail) == MASU_OK);
    void *block = aligned_alloc(64, (need.host_bytes + 63) / 64 * 64);
    masu_renderer *m;
    masu_commands commands;
    CHECK(masu_init(&desc, block, need.host_bytes, &m, &detail) == MASU_OK);
    while (masu_load(m, &commands, &detail) == MASU_INCOMPLETE) {
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    static masu_particle puffs[PUFFS];
    static masu_trail_point points[POINTS];
    const void *textures[] = {smoke, sign, streak};
    paint();
    for (uint32_t i = 0; i < FRAMES; i++) {
        masu_camera camera;
        CHECK(masu_camera_at(m, 0, &camera, &detail) == MASU_OK);
        for (uint32_t k = 0; k < PUFFS; k++) { /* older ones are larger, higher and fainter */
            float age = (float)k / PUFFS, u = 0.25f * (float)(k % 4),
                  v = 0.25f * (float)(k / 4 % 4);
            puffs[k] = (masu_particle){.half_width = 0.12f + 0.3f * age,
                                       .rotation = (float)k,
                                       .color = {0.7f, 0.7f, 0.75f},
                                       .opacity = 0.9f * (1 - age),
                                       .soft = 0.3f,
                                       .flags = MASU_PARTICLE_LIT,
                                       .texture = SMOKE,
                                       .uv = {u, v, u + 0.25f, v + 0.25f}};
            place(&camera, -1 + 0.4 * (double)age * sin(k), -0.7 + 1.4 * (double)age,
                  3 + 0.2 * cos(k), puffs[k].position);
        }
        for (uint32_t k = 0; k < POINTS; k++) { /* a spiral, brightest at its head */
            double along = (double)k / (POINTS - 1);
            points[k] = (masu_trail_point){.half_width = (float)(0.01 + 0.09 * along),
                                           .color = {6, 2.5f, 0.6f},
                                           .opacity = (float)along};
            place(&camera, 0.7 + 0.5 * cos(12 * along), -0.6 + 1.2 * along,
                  2.5 + 0.5 * sin(12 * along), points[k].position);
        }
        const masu_trail trail = {.points = points,
                                  .point_count = POINTS,
                                  .flags = MASU_PARTICLE_ADDITIVE,
                                  .texture = STREAK,
                                  .repeat = 1};
        masu_decal decal = {
            .rows = {0.9f, 0, 0, 0, 0, 0, 4, 0, 0, -0.9f, 0, 0}, /* on the ground ahead */
            .color = {0.9f, 0.1f, 0.05f},
            .opacity = 0.9f,
            .roughness = 0.6f,
            .texture = SIGN};
        place(&camera, 0, -1, 4, decal.position);
        if (i < 3) CHECK(masu_texture_write(m, i + 1, NULL, textures[i], 0, &detail) == MASU_OK);
        masu_frame_desc frame = {MASU_FRAME_DESC,    .camera = &camera,       .time = i / 60.0,
                                 .particles = puffs, .particle_count = PUFFS, .trails = &trail,
                                 .trail_count = 1,   .decals = &decal,        .decal_count = 1};
        CHECK(masu_frame(m, &frame, &commands, &detail) == MASU_OK);
        CHECK(masu_headless_run(&host, commands.buffer, error, room));
    }
    CHECK(masu_headless_target_read(&host, &image, error, room));
    CHECK(masu_image_save_png(argv[2], image.mapped, WIDTH, HEIGHT, 0, error, room));
    printf("sprites: %llu bytes host, %llu bytes device; validation %u\n",
           (unsigned long long)need.host_bytes, (unsigned long long)need.device_bytes,
           host.messages);
    masu_destroy(m);
    masu_headless_target_destroy(&host, &image);
    masu_headless_close(&host);
    free(block);
    free(blob);
    return host.messages > 0;
}

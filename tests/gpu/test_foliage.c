/* test_foliage.c: alpha-tested textures over distance. A plane of repeating needles, or leaves,
 * fills the image. Its coverage is compared with the first mip's alpha sampled at 64 positions in
 * each pixel, in double precision. For comparison: plain mips, sampled as the device does. */
#include "support/support.h"

#include "scene/blob.h"
#include "image.h"
#include "scene/scene.h"
#include "scene/texture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 128, PIXELS = SIDE * SIDE, TEXELS = 128, MIPS = 8, TILES = 32 };

static masu_session s;
static uint8_t *blob; /* the reference's own copy */
static masu_scene look;
static double mips[MIPS][TEXELS * TEXELS]; /* alpha; plain averages of the first */

/* Reads mip 0 of a layer of the scene's alpha-tested textures from the blob. */
static void read_mask(uint32_t layer) {
    masu_scene_view v = masu_scene_view_of(&look);
    const masu_blob_texture *t = v.textures;
    while (t->format != MASU_TEXTURE_BC3_SRGB) t++;
    assert_true(t->width == TEXELS && t->height == TEXELS && layer < t->layers);
    uint64_t bytes = masu_blob_texture_bytes(t) / t->layers;
    for (uint32_t i = 0; i < TEXELS * TEXELS; i++) {
        uint32_t x = i % TEXELS, y = i / TEXELS;
        uint8_t block[64];
        masu_texture_decode(
            t->format, v.texels + t->offset + layer * bytes + 16 * (y / 4 * (TEXELS / 4) + x / 4),
            block);
        mips[0][i] = block[4 * (y % 4 * 4 + x % 4) + 3] / 255.0;
    }
    for (uint32_t m = 1; m < MIPS; m++) {
        uint32_t side = TEXELS >> m;
        for (uint32_t i = 0; i < side * side; i++) {
            const double *from = mips[m - 1] + i / side * 2 * 2 * side + i % side * 2;
            mips[m][i] = (from[0] + from[1] + from[2 * side] + from[2 * side + 1]) / 4;
        }
    }
}

static double sample(uint32_t m, double u, double v) {
    uint32_t side = TEXELS >> m;
    double x = (u - floor(u)) * side + side - 0.5, y = (v - floor(v)) * side + side - 0.5;
    uint32_t ix = (uint32_t)x, iy = (uint32_t)y;
    double fx = x - ix, fy = y - iy;
    const double *row[2] = {mips[m] + iy % side * side, mips[m] + (iy + 1) % side * side};
    uint32_t left = ix % side, right = (ix + 1) % side;
    return (1 - fy) * ((1 - fx) * row[0][left] + fx * row[0][right]) +
           fy * ((1 - fx) * row[1][left] + fx * row[1][right]);
}

/* The camera is rolled. Otherwise, along the rows of a texture, every pixel would sample the same
 * position in a texel, such as its centre, and nothing in between would be tested. */
#define ROLL 0.4

/* Alpha of a mip at a position of the image, at `texels` of mip 0 per pixel. */
static double alpha_at(uint32_t m, double x, double y, double texels) {
    double right = (x - SIDE / 2.0) * texels / TEXELS, down = (y - SIDE / 2.0) * texels / TEXELS;
    return sample(m, TILES / 2.0 + cos(ROLL) * right - sin(ROLL) * down,
                  TILES / 2.0 + sin(ROLL) * right + cos(ROLL) * down);
}

static double truth(double texels) {
    uint32_t there = 0;
    for (uint32_t i = 0; i < 64 * PIXELS; i++) {
        double x = i % (8 * SIDE) / 8.0 + 0.0625, y = i / (8 * SIDE) / 8.0 + 0.0625;
        there += alpha_at(0, x, y, texels) >= 128 / 255.0;
    }
    return (double)there / (64 * PIXELS);
}

static double plain(double texels) {
    double lod = fmax(log2(texels), 0);
    uint32_t m = (uint32_t)lod, there = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double x = i % SIDE + 0.5, y = i / SIDE + 0.5, a = alpha_at(m, x, y, texels);
        if (lod > m) a += (lod - m) * (alpha_at(m + 1, x, y, texels) - a);
        there += a >= 128 / 255.0;
    }
    return (double)there / PIXELS;
}

static double drawn(double texels, double x) {
    double height = texels * SIDE * 2 / (TEXELS * TILES); /* of the image, in world units */
    masu_camera camera = {.position = {x, 0, height / (2 * tan(0.35))},
                          .forward = {0, 0, -1},
                          .up = {(float)sin(ROLL), (float)cos(ROLL), 0},
                          .fov_y = 0.7f};
    masu_frame_desc frame = {.camera = &camera};
    const float *depth = draw_image(&s, &frame, MASU_READBACK_DEPTH, NULL);
    uint32_t there = 0;
    for (uint32_t i = 0; i < PIXELS; i++) there += depth[i] > 0;
    return (double)there / PIXELS;
}

static void foliage_covers_the_same_at_any_distance(void **state) {
    (void)state;
    static const char *const names[] = {"needles", "leaves"};
    static const double steps[] = {0.5, 1, 1.5, 2, 3, 4, 6, 8, 11, 16};
    char error[ERROR_SIZE];
    size_t size;
    masu_detail detail;
    masu_session_desc d = test_desc("test_foliage", SIDE, SIDE);
    assert_ok(
        masu_file_read(scene_path("test_foliage"), 1 << 30, &blob, &size, error, sizeof error));
    assert_int_equal(masu_scene_bind(blob, size, &look, &detail), MASU_OK);
    d.desc.readback = MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    for (uint32_t which = 0; which < 2; which++) {
        masu_scene_view v = masu_scene_view_of(&look);
        masu_instance instance = masu_instance_find(s.m, names[which]);
        masu_instance_state placed;
        assert_int_equal(masu_instance_get(s.m, instance, &placed, NULL), MASU_OK);
        const masu_blob_mesh *mesh = &v.meshes[placed.mesh];
        uint32_t material = v.primitives[mesh->first_primitive].material;
        read_mask(v.materials[material].layers & 0xFF);
        double worst = 0, lost = 0;
        for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
            double want = truth(steps[i]), got = drawn(steps[i], 3 * which);
            double without = plain(steps[i]);
            print_message(
                "%s, %4.1f texels a pixel: %.4f there, %.4f drawn, %.4f with plain mips\n",
                names[which], steps[i], want, got, without);
            if (fabs(got - want) > worst) worst = fabs(got - want);
            if (fabs(without - want) > lost) lost = fabs(without - want);
        }
        print_message("%s: error %.4f at most, %.4f with plain mips\n", names[which], worst, lost);
        assert_true(worst < 0.025);
        assert_true(which || lost > 4 * worst);
    }
    close_session(&s);
    free(blob);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(foliage_covers_the_same_at_any_distance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

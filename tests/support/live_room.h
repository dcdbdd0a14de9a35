/* live_room.h: a room for the tests of live textures and trails: a square with a map, memory for
 * sprites and textures of random blocks, and a bilinear filter in double precision. */
#ifndef SUPPORT_LIVE_ROOM_H
#define SUPPORT_LIVE_ROOM_H

#include "support/floats.h"
#include "support/random.h"
#include "support/support.h"

#include <math.h>
#include <string.h>

enum { SIDE = 96, PIXELS = SIDE * SIDE, TEXELS = 16, COUNT = 3, POINTS = 16, ROOM = 32 };

static masu_detail failure;
static masu_session s;
static float base[4 * PIXELS], picture[4 * PIXELS];
static uint8_t texels[COUNT][4 * 64 * 64];

/* LIVE_SCENE, which the test defines so that it is baked: a square of 2 m with a map, at z = 0. */
static const masu_camera camera = {
    .position = {0, 0, 3}, .forward = {0, 0, -1}, .fov_y = 0.6981317f, .near_distance = 0.05f};
static const double tan_y = 0.36397023;

static inline masu_session_desc room_desc(uint32_t side) {
    masu_session_desc d = test_desc(LIVE_SCENE, SIDE, SIDE);
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_ALBEDO | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    d.desc.mutable_materials = 1;
    d.desc.frames_in_flight = 2;
    d.desc.reserve = (masu_reserve){.particles = ROOM,
                                    .decals = ROOM,
                                    .trail_points = POINTS,
                                    .textures = COUNT,
                                    .texture_size = {side, side},
                                    .texture_bytes = 2 * 4 * side * side};
    return d;
}

static inline void open_room(uint32_t side) {
    masu_session_desc d = room_desc(side);
    open_session(&s, &d);
}

static inline masu_stats_info render(masu_frame_desc frame, float *hdr) {
    masu_commands commands;
    frame.bytes = sizeof frame;
    frame.camera = &camera;
    draw(&s, &frame, &commands, NULL);
    floats_of_halves(read_image(&s, commands.slot, MASU_READBACK_HDR), hdr, 4 * PIXELS);
    masu_stats_info stats = stats_of(&s, commands.slot);
    assert_int_equal(stats.replaced, 0);
    return stats;
}

static inline void render_albedo(masu_frame_desc frame, uint8_t *albedo) {
    masu_commands commands;
    frame.bytes = sizeof frame;
    frame.camera = &camera;
    draw(&s, &frame, &commands, NULL);
    memcpy(albedo, read_image(&s, commands.slot, MASU_READBACK_ALBEDO), 4 * PIXELS);
}

static inline void write_whole(uint32_t texture) {
    assert_int_equal(masu_texture_write(s.m, texture, NULL, texels[texture - 1], 0, &failure),
                     MASU_OK);
}

/* Blocks of 2x2 texels of any colour; alpha of any value from `alpha` on. */
static inline void fill(uint32_t texture, uint32_t side, uint32_t block, uint32_t alpha,
                        uint64_t seed) {
    for (uint32_t i = 0; i < side * side; i++) {
        uint32_t x = i % side / block, y = i / side / block;
        uint64_t own = seed + 977 * (y * side + x);
        for (uint32_t k = 0; k < 4; k++)
            texels[texture - 1][4 * i + k] = (uint8_t)(random_word(&own) >> 8 & 255);
        uint8_t *a = &texels[texture - 1][4 * i + 3];
        *a = (uint8_t)(alpha + *a % (256 - alpha));
    }
}

static inline double linear(uint8_t v) {
    double x = v / 255.0;
    return x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
}

/* A bilinear sample within a cell, colour times alpha. u, v: in the cell. */
static inline void sample(uint32_t texture, uint32_t side, const float cell[4], double u, double v,
                          double out[4]) {
    double at[2] = {u, v}, f[2];
    int first[2];
    for (uint32_t k = 0; k < 2; k++) {
        double a = (double)cell[k], b = (double)cell[k + 2];
        double p = (a + (b - a) * at[k]) * side;
        p = fmin(fmax(p, fmin(a, b) * side + 0.5), fmax(a, b) * side - 0.5) - 0.5;
        first[k] = (int)floor(p);
        f[k] = p - floor(p);
    }
    double color[4] = {0};
    for (int n = 0; n < 4; n++) {
        int x = first[0] + (n & 1), y = first[1] + (n >> 1), last = (int)side - 1;
        x = x > last ? last : x, y = y > last ? last : y;
        const uint8_t *t = &texels[texture - 1][4 * (y * (int)side + x)];
        double w = (n & 1 ? f[0] : 1 - f[0]) * (n >> 1 ? f[1] : 1 - f[1]);
        for (uint32_t k = 0; k < 4; k++) color[k] += w * (k < 3 ? linear(t[k]) : t[3] / 255.0);
    }
    for (uint32_t k = 0; k < 3; k++) out[k] += color[k] * color[3];
    out[3] += color[3];
}

#endif

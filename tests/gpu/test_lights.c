/* test_lights.c: punctual lights. A light without a size lights a pixel like a sun with the
 * direction and colour of the double-precision reference (tests/reference/lights.h); tile lists
 * give bit-identical images; no access is out of bounds; valid and invalid values of the host.
 * Panes and particles are lit as well. */
#include "support/files.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/shadow.h"

#include "scene/blob.h"
#include "reference/lights.h"
#include "reference/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

#define PI 3.14159265358979323846
#define LIGHTS_MOST 1024

static char json[1 << 19];
static size_t used;

static void add(const char *format, ...) {
    va_list args;
    va_start(args, format);
    used += (size_t)vsnprintf(json + used, sizeof json - used, format, args);
    va_end(args);
    assert_true(used < sizeof json);
}

static uint64_t seed;
static int blends; /* scenes have panes and bubbles, frames have particles */
static masu_particle sparks[8];
static uint64_t blend_seed;

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* The ground, boxes and balls of several materials, and balls of an SDF among them. */
static void begin_scene(double size) {
    used = 0;
    add("{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": %g, \"size_z\": %g}}, "
        "\"material\": {\"roughness\": 0.9}}",
        60 * size, 60 * size);
    seed = 11;
    for (int i = 0; i < 24; i++) {
        double at[3] = {random_between(&seed, -9, 9), random_between(&seed, 0.2, 2),
                        random_between(&seed, -9, 9)},
               s = random_between(&seed, 0.3, 1.4);
        add(", {\"mesh\": {\"%s}, \"name\": \"thing%d\", \"scale\": %g, "
            "\"translate\": [%g, %g, %g], \"material\": {\"base_color\": [%g, %g, %g], "
            "\"roughness\": %g, \"metallic\": %d}}",
            i % 2 ? "box\": {\"size\": [1, 1.5, 1]}" : "sphere\": {\"subdivisions\": 3}", i,
            s * size, at[0] * size, at[1] * size, at[2] * size, random_between(&seed, 0, 1),
            random_between(&seed, 0, 1), random_between(&seed, 0, 1), random_between(&seed, 0, 1),
            i % 5 == 0);
    }
    for (int i = 0; i < 6 * blends; i++) {
        add(", {\"mesh\": {\"%s}, \"scale\": %g, \"translate\": [%g, %g, %g], "
            "\"material\": {\"roughness\": %g, \"opacity\": %g}}",
            i % 2 ? "box\": {\"size\": [3, 3, 0.1]}" : "sphere\": {\"subdivisions\": 2}",
            random_between(&blend_seed, 0.5, 1.5) * size, random_between(&blend_seed, -9, 9) * size,
            random_between(&blend_seed, 1, 5) * size, random_between(&blend_seed, -9, 9) * size,
            random_between(&blend_seed, 0.1, 1), random_between(&blend_seed, 0, 0.9));
    }
    add("], \"ambient\": [0, 0, 0], \"sun\": {\"intensity\": 0}, "
        "\"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]}, ");
}

static void add_sdf(void) {
    write_text("balls.sdf",
               "part a = translate((1.5, 1, 1), sphere(0.8));\n"
               "part b = translate((-2, 0.7, 3), box((0.6, 0.7, 0.5)));\n");
    add("\"sdf\": {\"source\": \"balls.sdf\", \"bounds\": [[-6, -1, -6], [6, 4, 6]]}, ");
}

/* Points and spots of all sizes, in the scene and around it. */
static void add_lights(uint32_t count, double size, double low, double high) {
    add("\"lights\": [");
    for (uint32_t i = 0; i < count; i++) {
        double range = random_spread(&seed, low, high) * size,
               outer = i % 7 ? random_between(&seed, 2, 80) : random_between(&seed, 80, 180);
        if (count >= 20 && size >= 1 && i % 11 < 2) { /* area lights among them */
            double half = range / 13;
            add("%s{\"type\": \"%s\", \"name\": \"l%u\", \"position\": [%.9g, %.9g, %.9g], "
                "\"range\": %.9g, "
                "\"half_u\": [%.9g, 0, %.9g], %s%.9g%s}",
                i ? ", " : "", i % 11 ? "capsule" : "rectangle", i,
                random_between(&seed, -12, 12) * size, random_between(&seed, -1, 5) * size,
                random_between(&seed, -12, 12) * size, range, half, half / 2,
                i % 11 ? "\"radius\": " : "\"half_v\": [0, ", half / 4, i % 11 ? "" : ", 0]");
            continue;
        }
        add("%s{\"type\": \"%s\", \"name\": \"l%u\", \"position\": [%.9g, %.9g, %.9g], "
            "\"color\": [%g, %g, %g], \"intensity\": %g, \"range\": %.9g, \"radius\": %g",
            i ? ", " : "", i % 3 ? "point" : "spot", i, random_between(&seed, -12, 12) * size,
            random_between(&seed, -1, 5) * size, random_between(&seed, -12, 12) * size,
            random_between(&seed, 0, 1), random_between(&seed, 0, 1), random_between(&seed, 0, 1),
            fmin(random_between(&seed, 0.1, 2) * range * range / 4, 1e9), range, 0.01 * size);
        if (i % 3 == 0)
            add(", \"direction\": [%g, %g, %g], \"outer\": %g, \"inner\": %g",
                random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                random_between(&seed, -1, 1) + 0.01, outer, outer * random_between(&seed, 0, 1));
        add("}");
    }
    add("]}");
}

/* ---- Images ---------------------------------------------------------------------------------- */

typedef struct pictures {
    masu_session s;
    uint32_t width, height;
} pictures;

enum { TILES, ALL_LIGHTS, UNCULLED, WAYS }; /* rungs */

static void open_pictures(pictures *p, const char *scene, uint32_t width, uint32_t height,
                          int validate) {
    memset(p, 0, sizeof *p);
    p->width = width;
    p->height = height;
    masu_session_desc d = test_desc(NULL, width, height);
    d.scene_path = baked_scene(scene);
    d.host.validate = validate;
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH | MASU_READBACK_NORMAL;
    d.desc.frames_in_flight = 1;
    d.desc.rung_count = WAYS;
    d.desc.rungs[ALL_LIGHTS].light_tiles = MASU_OFF;
    d.desc.rungs[UNCULLED].frustum = MASU_OFF;
    for (uint32_t way = 0; way < WAYS; way++)
        d.desc.rungs[way].local_shadows = MASU_OFF; /* test_local_shadows.c */
    d.desc.debug.poison = 1;
    d.desc.reserve.particles = blends ? 8 : 0;
    open_session(&p->s, &d);
}

static const uint16_t *take(pictures *p, const masu_camera *camera, const masu_light *sun,
                            uint32_t rung, masu_stats_info *stats) {
    masu_frame_desc frame = {.camera = camera,
                             .light = sun,
                             .rung = rung,
                             .particles = sparks,
                             .particle_count = blends ? 8 : 0};
    masu_commands commands;
    draw(&p->s, &frame, &commands, NULL);
    masu_stats_info own = stats_of(&p->s, commands.slot);
    assert_int_equal(own.replaced, 0);
    if (stats) *stats = own;
    return read_image(&p->s, commands.slot, MASU_READBACK_HDR);
}

static uint64_t lit_pixels(const uint16_t *hdr, uint64_t pixels) {
    uint64_t lit = 0;
    for (uint64_t i = 0; i < pixels; i++) {
        lit +=
            half_float(hdr[4 * i]) + half_float(hdr[4 * i + 1]) + half_float(hdr[4 * i + 2]) > 1e-4;
        for (int k = 0; k < 3; k++) assert_true((hdr[4 * i + (uint64_t)k] & 0x7C00u) != 0x7C00u);
    }
    return lit;
}

static masu_camera look(double x, double y, double z, double fx, double fy, double fz, double fov) {
    return (masu_camera){.position = {x, y, z},
                         .forward = {(float)fx, (float)fy, (float)fz},
                         .fov_y = (float)fov,
                         .near_distance = 0.05f};
}

/* ---- Tiles ----------------------------------------------------------------------------------- */

static void set_random(pictures *p, uint32_t lights, double size) {
    for (uint32_t i = 0; i < 8 && lights; i++) {
        masu_punctual_light handle =
            masu_punctual_light_at(p->s.m, (uint32_t)random_between(&seed, 0, lights - 0.01));
        masu_punctual_light_state state;
        assert_int_equal(masu_punctual_light_get(p->s.m, handle, &state, &failure), MASU_OK);
        for (int k = 0; k < 3; k++) state.position[k] = random_between(&seed, -12, 12) * size;
        state.position[1] *= 0.3;
        state.range = (float)(random_spread(&seed, 0.01, 30) * size);
        assert_int_equal(masu_punctual_light_set(p->s.m, handle, &state, &failure), MASU_OK);
    }
}

typedef struct totals {
    uint64_t lit, tests[WAYS], shaded, full, in_view, of;
} totals;

static void compare_ways(pictures *p, uint32_t lights, uint32_t frames, double size, double near,
                         totals *sum) {
    static uint16_t first[WAYS][4 * 256 * 256];
    uint64_t pixels = (uint64_t)p->width * p->height;
    for (uint32_t f = 0; f < frames; f++) {
        masu_camera c =
            look(random_between(&seed, -10, 10) * size, random_between(&seed, 0.3, 6) * size,
                 random_between(&seed, -10, 10) * size, random_between(&seed, -1, 1),
                 random_between(&seed, -1, 0.2), random_between(&seed, -1, 1),
                 f % 4 ? random_between(&seed, 0.3, 1.6) : random_between(&seed, 0.01, 3.05));
        masu_stats_info stats[WAYS];
        c.near_distance = (float)near;
        set_random(p, lights, size);
        for (int i = 0; i < 8 * blends; i++) {
            sparks[i] =
                (masu_particle){.half_width = (float)(random_between(&blend_seed, 0.1, 2) * size),
                                .color = {1, 1, 1},
                                .opacity = 0.5f,
                                .flags = MASU_PARTICLE_LIT};
            for (int k = 0; k < 3; k++)
                sparks[i].position[k] = c.position[k] + 4 * size * (double)c.forward[k] +
                                        random_between(&blend_seed, -3, 3) * size;
        }
        for (uint32_t way = 0; way < WAYS; way++) {
            memcpy(first[way], take(p, &c, NULL, way, &stats[way]), pixels * 8);
            if (memcmp(first[way], first[0], pixels * 8))
                fail_msg("%ux%u, %u lights, frame %u: way %u differs", p->width, p->height, lights,
                         f, way);
            /* Every list has the lights that reach a pixel. */
            assert_int_equal(stats[way].light_shaded, stats[0].light_shaded);
            sum->tests[way] += stats[way].light_tests;
        }
        assert_int_equal(stats[UNCULLED].lights_in_view, stats[UNCULLED].lights);
        assert_true(stats[TILES].lights_in_view <= lights);
        assert_int_equal(stats[ALL_LIGHTS].light_tiles_full, 0);
        sum->full += stats[TILES].light_tiles_full;
        sum->shaded += stats[0].light_shaded;
        sum->in_view += stats[0].lights_in_view;
        sum->of += stats[0].lights;
        sum->lit += lit_pixels(first[0], pixels);
    }
}

static void bake_many(const char *name, uint32_t lights, double size, double low, double high) {
    begin_scene(size);
    if (size == 1 && lights >= 200) add_sdf(); /* takes longer to bake than the rest */
    add_lights(lights, size, low, high);
    bake_scene(name, json);
}

/* A light closer than every surface of a tile, or before the sky, lights the pane in between. */
static void tiles_begin_at_the_near_plane(void **state) {
    (void)state;
    static uint16_t by_tiles[4 * 96 * 66];
    pictures p;
    used = 0;
    add("{\"models\": [{\"mesh\": {\"box\": {\"size\": [8, 4, 1]}}, \"translate\": [0, -3, -20]}, "
        "{\"mesh\": {\"box\": {\"size\": [9, 6, 0.01]}}, \"material\": {\"roughness\": 0.5, "
        "\"opacity\": 0.5}}], "
        "\"ambient\": [0, 0, 0], \"sun\": {\"intensity\": 0}, "
        "\"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]}, "
        "\"lights\": [{\"type\": \"point\", \"position\": [0, 0, 1], \"intensity\": 20, \"range\": "
        "6}]}");
    bake_scene("before", json);
    open_pictures(&p, "before", 96, 66, 1);
    masu_camera c = look(0, 0, 6, 0, 0, -1, 0.9);
    memcpy(by_tiles, take(&p, &c, NULL, TILES, NULL), sizeof by_tiles);
    assert_memory_equal(by_tiles, take(&p, &c, NULL, ALL_LIGHTS, NULL), sizeof by_tiles);
    assert_true(lit_pixels(by_tiles, 96 * 66) > 96 * 66 * 3 / 4);
    close_session(&p.s);
}

static void tiles_change_no_bit(void **state) {
    (void)state;
    static const struct {
        uint32_t lights, width, height, frames;
        double size, low, high, near; /* of the scene, ranges of lights in it, metres */
    } cases[] = {
        {1, 66, 40, 10, 1, 2, 30, 0.05},         {20, 66, 40, 20, 1, 0.05, 20, 0.05},
        {63, 81, 47, 8, 1, 0.05, 10, 0.01},      {64, 97, 33, 8, 1, 0.05, 10, 1},
        {200, 1, 1, 30, 1, 0.3, 20, 0.05},       {200, 17, 5, 20, 1, 0.3, 20, 0.05},
        {200, 15, 33, 20, 1, 0.01, 5, 0.001},    {200, 80, 48, 3, 1, 10, 40, 0.05},
        {1024, 80, 66, 4, 1, 0.05, 4, 0.05},     {256, 48, 48, 12, 1e4, 0.02, 20, 1e-2},
        {256, 48, 48, 12, 1e-3, 0.02, 20, 1e-6},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        totals sum = {0};
        pictures p;
        const uint32_t frames = long_run() ? cases[i].frames : (cases[i].frames + 1) / 2;
        blends = i % 2 == 0;
        blend_seed = 5;
        bake_many("many", cases[i].lights, cases[i].size, cases[i].low, cases[i].high);
        open_pictures(&p, "many", cases[i].width, cases[i].height, i == 1);
        seed = 100 + (uint32_t)i;
        compare_ways(&p, cases[i].lights, frames, cases[i].size, cases[i].near, &sum);
        close_session(&p.s);
        double pixels = (double)cases[i].width * cases[i].height * frames;
        print_message(
            "%4u lights %3ux%-3u: in view %4.0f %%, lit %3.0f %% of pixels; tests per pixel "
            "%6.2f by tiles, %7.2f without, shaded %5.2f; full tiles %llu\n",
            cases[i].lights, cases[i].width, cases[i].height,
            100.0 * (double)sum.in_view / (double)sum.of, 100 * (double)sum.lit / pixels,
            (double)sum.tests[TILES] / pixels, (double)sum.tests[ALL_LIGHTS] / pixels,
            (double)sum.shaded / pixels, (unsigned long long)sum.full);
        assert_true(sum.lit > 0 && sum.shaded > 0);
        assert_true(sum.shaded <= sum.tests[TILES] && sum.tests[TILES] <= sum.tests[ALL_LIGHTS]);
        assert_true(sum.tests[TILES] <= sum.tests[UNCULLED]);
        if (cases[i].lights < 64) assert_int_equal(sum.full, 0);
        if (cases[i].lights == 200 && cases[i].low >= 10) assert_true(sum.full > 0);
        if (cases[i].lights == 1024) assert_true(sum.tests[TILES] * 4 < sum.tests[ALL_LIGHTS]);
    }
    blends = 0;
}

/* ---- Comparison with the reference ----------------------------------------------------------- */

/* The point under a pixel, by its depth; 0: none. */
static int point_at(const pictures *p, const masu_camera *c, const float *depths, uint32_t x,
                    uint32_t y, double out[3]) {
    double f[3], r[3], u[3], up[3] = {0, 1, 0};
    float depth = depths[y * p->width + x];
    if (!(depth > 0.0f)) return 0;
    for (int k = 0; k < 3; k++) f[k] = (double)c->forward[k];
    unit3(f);
    cross3(f, up, r);
    unit3(r);
    cross3(r, f, u);
    double z = (double)c->near_distance / (double)depth, tan_y = tan((double)c->fov_y / 2);
    double a = ((x + 0.5) / p->width * 2 - 1) * tan_y * p->width / p->height;
    double b = ((y + 0.5) / p->height * 2 - 1) * tan_y;
    for (int k = 0; k < 3; k++) out[k] = c->position[k] + z * (f[k] + r[k] * a - u[k] * b);
    return 1;
}

static masu_ref_light reference_of(const masu_punctual_light_state *s) {
    masu_ref_light r = {.range = (double)s->range,
                        .radius = (double)s->radius,
                        .inner = s->spot ? (double)s->inner : PI,
                        .outer = s->spot ? (double)s->outer : PI};
    for (int k = 0; k < 3; k++) {
        r.position[k] = s->position[k];
        r.color[k] = (double)s->color[k];
        r.axis[k] = (double)s->direction[k];
    }
    return r;
}

static masu_light no_sun(void) { return (masu_light){.sun_direction = {0, 1, 0}, .exposure = 1}; }

typedef struct error {
    double most; /* relative, for values of at least a thousandth of the case's maximum */
    uint32_t compared, lit;
} error_info;

/* One light, compared pixel by pixel with a sun. pane not 0: the surface is a pane on z = 0, which
 * is in no depth image. */
static error_info compare_light(pictures *p, const masu_camera *c,
                                const masu_punctual_light_state *state, int pane) {
    static uint16_t local[4 * 256 * 256];
    static float depths[256 * 256];
    masu_punctual_light one = masu_punctual_light_at(p->s.m, 0), off = one;
    masu_punctual_light_state dark = *state;
    masu_ref_light ref = reference_of(state);
    masu_light sun = no_sun();
    error_info e = {0};
    memset(dark.color, 0, sizeof dark.color);
    assert_int_equal(masu_punctual_light_set(p->s.m, one, state, &failure), MASU_OK);
    memcpy(local, take(p, c, &sun, TILES, NULL), (size_t)p->width * p->height * 8);
    memcpy(depths, read_image(&p->s, 0, MASU_READBACK_DEPTH), (size_t)p->width * p->height * 4);
    for (uint32_t i = 0; i < p->width * p->height && pane; i++)
        depths[i] = (float)((double)c->near_distance / c->position[2]);
    assert_int_equal(masu_punctual_light_set(p->s.m, off, &dark, &failure), MASU_OK);
    for (uint32_t n = 0; n < 30; n++) {
        uint32_t x = (uint32_t)random_between(&seed, 0, p->width - 0.01),
                 y = (uint32_t)random_between(&seed, 0, p->height - 0.01);
        double at[3], l[3], color[3];
        if (!point_at(p, c, depths, x, y, at)) continue;
        int reached = masu_ref_light_reaches(&ref, at, l, color);
        const uint16_t *is = local + 4 * ((size_t)y * p->width + x);
        e.compared++;
        for (int k = 0; k < 3; k++) {
            sun.sun_direction[k] = reached ? (float)l[k] : (k == 1 ? 1.0f : 0.0f);
            sun.sun_color[k] = (float)fmin(color[k], 1e9);
        }
        const uint16_t *should = take(p, c, &sun, TILES, NULL) + 4 * ((size_t)y * p->width + x);
        for (int k = 0; k < 3; k++) {
            double a = half_float(is[k]), b = half_float(should[k]);
            if (!reached && a != 0.0)
                fail_msg("%u %u is lit by a light that does not reach it: %g", x, y, a);
            if (b > 1e-3) e.most = worst_of(e.most, fabs(a - b) / b);
            if (b <= 1e-3 && fabs(a - b) > 2e-5) fail_msg("%u %u: %g should be %g", x, y, a, b);
            e.lit += b > 1e-3;
        }
    }
    return e;
}

/* The tolerance: halves have 11 bits; depth and normal are the same in both. Near the range and the
 * edge of a cone the falloff is steep, and fp32 positions matter. */
static void a_light_is_a_sun_of_its_direction(void **state) {
    (void)state;
    static const struct {
        const char *what;
        double position[3], color, range, radius, direction[3], inner, outer, tolerance;
    } cases[] = {
        {"point, above", {0, 4, 0}, 20, 30, 1e-6, {0}, -1, -1, 2e-3},
        {"point, its range ends here", {1, 2, 1}, 5, 4, 1e-6, {0}, -1, -1, 2e-3},
        {"point, tiny and bright", {-1, 0.4, 3}, 1e4, 1e9, 1e-6, {0}, -1, -1, 2e-3},
        {"point, far", {4000, 9000, 2000}, 9e7, 1e5, 1e-6, {0}, -1, -1, 2e-3},
        {"spot, down", {0, 5, 1}, 40, 30, 1e-6, {0, -1, 0}, 0.3, 0.7, 3e-3},
        {"spot, slanted and wide", {-4, 3, 4}, 40, 30, 1e-6, {3, -2, -4}, 0.1, 1.5, 3e-3},
        {"spot, soft from its axis on", {0, 5, 1}, 40, 30, 1e-6, {0.2, -1, 0}, 0, 1.2, 3e-3},
        {"spot, beyond a half-space", {0, 1.2, 0.3}, 10, 30, 1e-6, {0, 1, 0}, 1.4, 2.6, 3e-3},
        {"spot, narrow", {-30, 20, 30}, 2000, 100, 1e-6, {30, -19.5, -29}, 0.03, 0.05, 2e-2},
        {"spot, all around", {0, 4, 0}, 20, 30, 1e-6, {1, 0, 0}, PI, PI, 2e-3},
    };
    pictures p;
    uint32_t lit = 0;
    begin_scene(1);
    add_sdf();
    add_lights(1, 1, 1, 2);
    bake_scene("one", json);
    open_pictures(&p, "one", 96, 66, 1);
    masu_camera c = look(3, 3.5, 9, -3, -3, -9, 0.9);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        masu_punctual_light_state s = {.range = (float)cases[i].range,
                                    .radius = (float)cases[i].radius,
                                    .spot = cases[i].outer >= 0};
        if (s.spot) s.inner = (float)cases[i].inner, s.outer = (float)cases[i].outer;
        for (int k = 0; k < 3; k++) {
            s.position[k] = cases[i].position[k];
            s.direction[k] = (float)cases[i].direction[k];
            s.color[k] = (float)(cases[i].color * (1 - 0.3 * k));
        }
        seed = 7 + (uint32_t)i;
        error_info e = compare_light(&p, &c, &s, 0);
        print_message("%-28s largest error %.2e of %u components lit, %u pixels\n", cases[i].what,
                      e.most, e.lit, e.compared);
        assert_true(e.compared > 10);
        assert_true(e.most <= cases[i].tolerance);
        lit += e.lit;
    }
    assert_true(lit > 200);
    close_session(&p.s);
}

/* ---- Extremes -------------------------------------------------------------------------------- */

static uint64_t picture_hash(pictures *p, const masu_camera *c, uint64_t *lit) {
    masu_light sun = no_sun();
    const uint16_t *hdr = take(p, c, &sun, TILES, NULL);
    uint64_t n = lit_pixels(hdr, (uint64_t)p->width * p->height);
    if (lit) *lit = n;
    return masu_fnv1a64(hdr, (uint64_t)p->width * p->height * 8);
}

static masu_punctual_light_state lamp_at(double x, double y, double z, float color, float range) {
    return (masu_punctual_light_state){.position = {x, y, z},
                                       .color = {color, 0.5f * color, 0.25f * color},
                                       .range = range,
                                       .radius = 0.01f};
}

static void a_pane_is_lit_as_by_a_sun_of_the_lights_direction(void **state) {
    (void)state;
    static const char *const kinds[] = {"\"opacity\": 0.5",
                                        "\"opacity\": 0.25, \"blend\": \"additive\"",
                                        "\"opacity\": 0.5, \"metallic\": 1, \"coat\": 1"};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        pictures p;
        used = 0;
        add("{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 40, \"size_z\": 40}}, \"rotate\": "
            "[90, 0, 0], "
            "\"material\": {\"roughness\": 0.4, \"base_color\": [0.8, 0.6, 0.4], %s}}], "
            "\"ambient\": [0, 0, 0], \"sun\": {\"intensity\": 0}, \"reflections\": false, "
            "\"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]}, ",
            kinds[i]);
        add_lights(1, 1, 1, 2);
        bake_scene("pane", json);
        open_pictures(&p, "pane", 96, 66, 1);
        masu_camera c = look(0.5, 0.25, 4, 0, 0, -1, 0.9);
        masu_punctual_light_state near = lamp_at(1, -0.5, 1, 8, 3),
                                  spot = lamp_at(-2, 1, 3, 30, 20);
        spot.spot = 1, spot.inner = 0.2f, spot.outer = 0.5f;
        spot.direction[0] = 2, spot.direction[1] = -1, spot.direction[2] = -3;
        seed = 3;
        error_info a = compare_light(&p, &c, &near, 1), b = compare_light(&p, &c, &spot, 1);
        print_message("pane {%s}: error of %.1e and %.1e, %u and %u lit\n",
                      kinds[i], a.most, b.most, a.lit, b.lit);
        assert_true(a.lit > 20 && b.lit > 20 && a.most < 3e-3 && b.most < 3e-3);
        close_session(&p.s);
    }
}

/* The mean over all directions n of max(n.l, 0) is 1/4. The light is that at the centre, also if
 * the centre is out of view. */
static void a_particle_scatters_a_quarter_of_each_light(void **state) {
    (void)state;
    static uint16_t culled[4 * 96 * 66];
    pictures p;
    blends = 1;
    used = 0;
    add("{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 1, \"size_z\": 1}}, \"translate\": [0, "
        "-9, 0]}], "
        "\"ambient\": [0, 0, 0], \"sun\": {\"intensity\": 0}, "
        "\"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]}, ");
    add_lights(2, 1, 1, 2);
    bake_scene("spark", json);
    open_pictures(&p, "spark", 96, 66, 1);
    masu_camera c = look(0, 0, 6, 0, 0, -1, 0.9);
    masu_punctual_light_state lights[2] = {lamp_at(1, 0.5, 0.25, 6, 4), lamp_at(-2, 1, 2, 20, 9)};
    lights[1].spot = 1, lights[1].inner = 0.2f, lights[1].outer = 0.6f;
    lights[1].direction[0] = 2, lights[1].direction[1] = -1, lights[1].direction[2] = -2;
    for (uint32_t i = 0; i < 2; i++)
        assert_int_equal(
            masu_punctual_light_set(p.s.m, masu_punctual_light_at(p.s.m, i), &lights[i], &failure),
            MASU_OK);
    memset(sparks, 0, sizeof sparks);
    for (int far = 0; far < 2; far++) {
        masu_particle spark = {.half_width = far ? 3 : 0.5f,
                               .color = {0.5f, 1, 0.75f},
                               .opacity = 1,
                               .edge = 1,
                               .flags = MASU_PARTICLE_LIT};
        spark.position[0] = far ? 6.5 : 0.2; /* the right side is at 4.2 */
        sparks[0] = spark;
        double want[3] = {0};
        for (uint32_t i = 0; i < 2; i++) {
            masu_ref_light r = reference_of(&lights[i]);
            double l[3], color[3];
            /* behind the particle */
            if (far) lights[i].position[0] = 7.5 + i, r.position[0] = 7.5 + i;
            if (far)
                assert_int_equal(masu_punctual_light_set(p.s.m, masu_punctual_light_at(p.s.m, i),
                                                         &lights[i], &failure),
                                 MASU_OK);
            masu_ref_light_reaches(&r, spark.position, l, color);
            for (int k = 0; k < 3; k++) want[k] += 0.25 * (double)spark.color[k] * color[k];
        }
        memcpy(culled, take(&p, &c, NULL, TILES, NULL), sizeof culled);
        assert_memory_equal(culled, take(&p, &c, NULL, ALL_LIGHTS, NULL), sizeof culled);
        assert_memory_equal(culled, take(&p, &c, NULL, UNCULLED, NULL), sizeof culled);
        const uint16_t *is = culled + 4 * (33 * 96 + (far ? 94 : 49));
        for (int k = 0; k < 3; k++) {
            if (!(want[k] > 0.01) || fabs(half_float(is[k]) - want[k]) > 2e-3 * want[k])
                fail_msg("%d, channel %d: %g, not %g", far, k, half_float(is[k]), want[k]);
        }
    }
    close_session(&p.s);
    blends = 0;
}

static void extremes_are_finite_and_mean_what_they_say(void **state) {
    (void)state;
    pictures p;
    uint64_t lit;
    begin_scene(1);
    add_sdf();
    add_lights(1, 1, 1, 2);
    bake_scene("one", json);
    open_pictures(&p, "one", 66, 48, 1);
    masu_camera c = look(3, 3.5, 9, -3, -3, -9, 0.9);
    masu_punctual_light one = masu_punctual_light_at(p.s.m, 0);
    const masu_punctual_light_state plain = {
        .position = {0, 4, 0}, .color = {20, 20, 20}, .range = 30, .radius = 0.01f};
    masu_punctual_light_state s = plain;
    s.color[0] = s.color[1] = s.color[2] = 0;
    assert_int_equal(masu_punctual_light_set(p.s.m, one, &s, &failure), MASU_OK);
    uint64_t dark = picture_hash(&p, &c, &lit);
    assert_int_equal(lit, 0);
    assert_int_equal(masu_punctual_light_set(p.s.m, one, &plain, &failure), MASU_OK);
    uint64_t bright = picture_hash(&p, &c, &lit);
    assert_true(lit > 500);
    enum { DARK, SAME, FINITE, LIT };
    static const struct {
        const char *what;
        int expected;
        double position[3], color;
        float range, radius, inner, outer;
    } cases[] = {
        {"range 0", DARK, {0, 4, 0}, 20, 0, 0.01f, -1, -1},
        {"range 1e-30", DARK, {0, 4, 0}, 20, 1e-30f, 0.01f, -1, -1},
        {"range 1e-6", FINITE, {0, 0, 0}, 20, 1e-6f, 0.01f, -1, -1},
        {"range 1e9", LIT, {0, 4, 0}, 20, 1e9f, 0.01f, -1, -1},
        {"range 1e15", LIT, {0, 4, 0}, 20, 1e15f, 0.01f, -1, -1},
        {"the brightest there is, on the ground", LIT, {0, 0, 0}, 1e9, 1e9f, 1e-6f, -1, -1},
        {"inside the near plane", LIT, {2.999, 3.499, 8.997}, 20, 30, 0.01f, -1, -1},
        {"at the camera", LIT, {3, 3.5, 9}, 20, 30, 0.01f, -1, -1},
        {"behind the camera", LIT, {5, 5, 14}, 20, 30, 0.01f, -1, -1},
        {"behind the camera, out of reach", DARK, {6, 7, 18}, 20, 3, 0.01f, -1, -1},
        {"as far as may be", FINITE, {1e15, -1e15, 1e15}, 1e9, 1e15f, 0.01f, -1, -1},
        {"below the ground", FINITE, {0, -1, 0}, 20, 30, 0.01f, -1, -1},
        {"spot of 0", DARK, {0, 4, 0}, 20, 30, 0.01f, 0, 0},
        {"spot of 1e-4", FINITE, {0, 4, 0}, 20, 30, 0.01f, 0, 1e-4f},
        {"spot with a hard edge", LIT, {0, 4, 0}, 20, 30, 0.01f, 0.8f, 0.8f},
        {"spot of 180", SAME, {0, 4, 0}, 20, 30, 0.01f, 3.14159274f, 3.14159274f},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        s = (masu_punctual_light_state){.range = cases[i].range,
                                     .radius = cases[i].radius,
                                     .direction = {0, -1, 0},
                                     .spot = cases[i].outer >= 0};
        if (s.spot) s.inner = cases[i].inner, s.outer = cases[i].outer;
        for (int k = 0; k < 3; k++) {
            s.position[k] = cases[i].position[k];
            s.color[k] = (float)cases[i].color;
        }
        assert_int_equal(masu_punctual_light_set(p.s.m, one, &s, &failure), MASU_OK);
        uint64_t is = picture_hash(&p, &c, &lit);
        int right = cases[i].expected == DARK   ? is == dark
                    : cases[i].expected == SAME ? is == bright
                    : cases[i].expected == LIT  ? lit > 20
                                                : 1;
        if (!right) fail_msg("%s: %llu pixels are lit", cases[i].what, (unsigned long long)lit);
    }
    close_session(&p.s);
}

/* ---- Values set by the host ------------------------------------------------------------------ */

static void bad_values_are_refused_with_a_line(void **state) {
    (void)state;
    pictures p;
    begin_scene(1);
    add_lights(2, 1, 1, 2);
    bake_scene("two", json);
    open_pictures(&p, "two", 18, 18, 1);
    masu_punctual_light light = masu_punctual_light_find(p.s.m, "l0");
    masu_punctual_light_state good, is;
    assert_int_equal(light.id, masu_punctual_light_at(p.s.m, 0).id);
    assert_int_equal(masu_punctual_light_find(p.s.m, "l2").id, 0);
    assert_int_equal(masu_punctual_light_find(p.s.m, "").id, 0);
    assert_int_equal(masu_punctual_light_find(NULL, "l0").id, 0);
    assert_int_equal(masu_punctual_light_get(p.s.m, light, &good, &failure), MASU_OK);
    assert_int_equal(good.spot, 1);
    static const float wrong[] = {NAN, INFINITY, -INFINITY, -1.0f, 1e16f};
    for (size_t i = 0; i < 5; i++) {
        masu_punctual_light_state s[9];
        for (int k = 0; k < 9; k++) s[k] = good;
        s[0].position[1] = i == 3 ? -1e16 : (double)wrong[i];
        s[1].color[2] = wrong[i];
        s[2].range = wrong[i];
        s[3].radius = wrong[i];
        s[4].outer = wrong[i];
        s[5].inner = wrong[i];
        s[6].direction[0] = i == 3 ? -2e15f : wrong[i];
        s[7].spot = 2 + (uint32_t)i;
        s[8].instance.id = 1000 + (uint32_t)i;
        static const char *const names[] = {"position", "color",     "range", "radius",  "outer",
                                            "inner",    "direction", "spot",  "instance"};
        for (int k = 0; k < 9; k++) {
            assert_int_equal(masu_punctual_light_set(p.s.m, light, &s[k], &failure),
                             MASU_ERROR_ARGUMENT);
            const masu_detail *d = (&failure);
            if (!strstr(d->text, names[k]) || !strstr(d->text, "light 0:") || strchr(d->text, '\n'))
                fail_msg("%s %g: %s", names[k], (double)wrong[i], d->text);
        }
    }
    masu_punctual_light_state shaped[4] = {good, good, good, good};
    static const char *const shapes[] = {"shape", "spot", "area_lights", "has_surface"};
    for (int k = 0; k < 4; k++) {
        shaped[k].spot = k == 1;
        shaped[k].shape = (masu_light_shape[]){(masu_light_shape)4, MASU_SHAPE_SPHERE,
                                               MASU_SHAPE_CAPSULE, MASU_SHAPE_SPHERE}[k];
        shaped[k].has_surface = k == 3;
        assert_int_equal(masu_punctual_light_set(p.s.m, light, &shaped[k], &failure),
                         MASU_ERROR_ARGUMENT);
        if (!strstr(failure.text, shapes[k]))
            fail_msg("%s: %s", shapes[k], failure.text);
    }
    masu_punctual_light_state none = good;
    memset(none.direction, 0, sizeof none.direction);
    assert_int_equal(masu_punctual_light_set(p.s.m, light, &none, &failure), MASU_ERROR_ARGUMENT);
    none = good;
    none.radius = 0;
    assert_int_equal(masu_punctual_light_set(p.s.m, light, &none, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(
        masu_punctual_light_set(p.s.m, (masu_punctual_light){light.id + 2}, &good, &failure),
        MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_set(p.s.m, (masu_punctual_light){0}, &good, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_set(NULL, light, &good, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_set(p.s.m, light, NULL, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_get(p.s.m, (masu_punctual_light){9}, &is, &failure),
                     MASU_ERROR_ARGUMENT);
    /* The call had no effect. */
    assert_int_equal(masu_punctual_light_get(p.s.m, light, &is, &failure), MASU_OK);
    assert_memory_equal(&is, &good, offsetof(masu_punctual_light_state, outer) + sizeof is.outer);
    close_session(&p.s);
}

/* A headlight follows its instance, bit-identical to a light that is set there. */
static void a_light_moves_with_its_instance(void **state) {
    (void)state;
    pictures p;
    begin_scene(1);
    add("\"lights\": [{\"type\": \"spot\", \"position\": [0, 0.5, 2], \"direction\": [0, -0.5, 1], "
        "\"outer\": 40, \"intensity\": 30, \"instance\": \"thing3\", \"name\": \"lamp\"}]}");
    bake_scene("lamp", json);
    open_pictures(&p, "lamp", 66, 48, 1);
    masu_camera c = look(3, 6, 9, -3, -6, -9, 1.2);
    masu_instance car = masu_instance_find(p.s.m, "thing3");
    masu_punctual_light lamp = masu_punctual_light_find(p.s.m, "lamp");
    masu_punctual_light_state carried, placed;
    assert_int_equal(masu_punctual_light_get(p.s.m, lamp, &carried, &failure), MASU_OK);
    assert_int_equal(carried.instance.id, car.id);
    uint64_t before = 0, lit;
    for (int i = 0; i < 6; i++) {
        /* Rotations by 90 degrees, and halves: nothing is rounded. */
        float x = (float)(i - 3) * 0.5f, c4 = i % 2 ? 0.0f : 1.0f, s4 = i % 2 ? 1.0f : 0.0f;
        const float rows[12] = {c4, 0, s4, x, 0, 1, 0, 0.25f, -s4, 0, c4, 1};
        assert_int_equal(masu_instance_set_transform(p.s.m, car, rows, &failure), MASU_OK);
        assert_int_equal(masu_punctual_light_set(p.s.m, lamp, &carried, &failure), MASU_OK);
        uint64_t moved = picture_hash(&p, &c, &lit);
        assert_true(lit > 20 && moved != before);
        before = moved;
        placed = carried;
        placed.instance.id = 0;
        for (int k = 0; k < 3; k++) {
            double at = (double)rows[4 * k + 3], d = 0;
            for (int j = 0; j < 3; j++) {
                at += (double)rows[4 * k + j] * carried.position[j];
                d += (double)rows[4 * k + j] * (double)carried.direction[j];
            }
            placed.position[k] = at;
            placed.direction[k] = (float)d;
        }
        assert_int_equal(masu_punctual_light_set(p.s.m, lamp, &placed, &failure), MASU_OK);
        assert_int_equal(picture_hash(&p, &c, NULL), moved);
    }
    close_session(&p.s);
}

static void a_scene_without_lights_has_no_pass_for_them(void **state) {
    (void)state;
    for (uint32_t lights = 0; lights < 2; lights++) {
        pictures p;
        masu_plan_info plan;
        masu_memory_row rows[MEMORY_ROWS];
        begin_scene(1);
        add_lights(lights, 1, 1, 2);
        bake_scene("few", json);
        open_pictures(&p, "few", 18, 18, 1);
        masu_plan_of(p.s.m, &plan);
        uint32_t passes = 0, buffers = 0, n = memory_rows(p.s.m, rows);
        for (uint32_t i = 0; i < plan.pass_count; i++) {
            if (strcmp(plan.passes[i].name, "light_tiles")) continue;
            assert_int_equal(plan.passes[i].active, lights ? 1u << TILES | 1u << UNCULLED : 0);
            passes++;
        }
        for (uint32_t i = 0; i < n; i++) {
            static const char *const names[] = {"lights", "light tiles", "punctual lights",
                                                "light names"};
            for (int k = 0; k < 4; k++) buffers += !strcmp(rows[i].name, names[k]) && rows[i].bytes;
        }
        assert_int_equal(passes, 1);
        assert_int_equal(buffers, lights ? 4 : 0); /* two on the device, two in the host block */
        assert_int_equal(masu_punctual_light_find(p.s.m, "l0").id != 0, lights);
        close_session(&p.s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_light_is_a_sun_of_its_direction),
        cmocka_unit_test(a_pane_is_lit_as_by_a_sun_of_the_lights_direction),
        cmocka_unit_test(a_particle_scatters_a_quarter_of_each_light),
        cmocka_unit_test(tiles_begin_at_the_near_plane),
        cmocka_unit_test(tiles_change_no_bit),
        cmocka_unit_test(extremes_are_finite_and_mean_what_they_say),
        cmocka_unit_test(bad_values_are_refused_with_a_line),
        cmocka_unit_test(a_light_moves_with_its_instance),
        cmocka_unit_test(a_scene_without_lights_has_no_pass_for_them),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

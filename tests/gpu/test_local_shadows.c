/* test_local_shadows.c: shadows of punctual lights: a light's visibility per pixel compared with
 * exact rays; planes do not shadow themselves; cached faces are bit-identical to re-rendered ones;
 * number of faces rendered per frame; shadows fade in and out in steps. */
#include "support/files.h"
#include "support/floats.h"
#include "support/random.h"
#include "support/support.h"

#include "frame/local_shadows.h"
#include "reference/triangles.h"
#include "reference/vec.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PIXELS_MOST (200 * 125)

static char json[1 << 16];
static size_t used;

static void add(const char *format, ...) {
    va_list args;
    va_start(args, format);
    used += (size_t)vsnprintf(json + used, sizeof json - used, format, args);
    va_end(args);
    assert_true(used < sizeof json);
}

static void begin_scene(double ground) {
    used = 0;
    add("{\"ambient\": [0, 0, 0], \"sun\": {\"intensity\": 0}, \"sky\": {\"zenith\": [0, 0, 0], "
        "\"horizon\": [0, 0, 0]}, \"ambient_occlusion\": false, \"reflections\": false, "
        "\"models\": [{\"mesh\": {\"plane\": {\"size_x\": %g, \"size_z\": %g}}, "
        "\"material\": {\"roughness\": 1}}", ground, ground);
}

static void add_box(const char *name, double x, double y, double z, double sx, double sy, double sz,
                    double turn) {
    add(", {\"mesh\": {\"box\": {\"size\": [%g, %g, %g]}}, \"name\": \"%s\", \"translate\": [%g, "
        "%g, %g], "
        "\"rotate_y\": %g, \"material\": {\"roughness\": 1}}",
        sx, sy, sz, name, x, y, z, turn);
}

static void add_lights(const char *lights) { add("], \"lights\": [%s]}", lights); }

static masu_camera look(double x, double y, double z, double fx, double fy, double fz, double fov) {
    return (masu_camera){.position = {x, y, z},
                         .forward = {(float)fx, (float)fy, (float)fz},
                         .fov_y = (float)fov,
                         .near_distance = 0.05f};
}

/* ---- Sessions -------------------------------------------------------------------------------- */

typedef struct lamps {
    masu_session s;
    uint32_t width, height;
    masu_ref_triangles world;
    masu_stats_info stats; /* of the last frame */
} lamps;

enum { SHADOWED, PLAIN, RUNGS };

static void open_lamps(lamps *l, const char *scene, uint32_t width, uint32_t height,
                       const masu_rung *rung, uint32_t reserve) {
    size_t bytes;
    masu_scene bound;
    memset(l, 0, sizeof *l);
    l->width = width;
    l->height = height;
    assert_true(width * height <= PIXELS_MOST);
    masu_session_desc d = test_desc(NULL, width, height);
    d.scene_path = baked_scene(scene);
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.reserve.lights = reserve;
    d.desc.rung_count = RUNGS;
    if (rung) d.desc.rungs[SHADOWED] = *rung;
    d.desc.rungs[PLAIN].local_shadows = MASU_OFF;
    d.desc.debug.poison = 1;
    open_session(&l->s, &d);
    void *blob = read_file(baked_scene(scene), &bytes);
    assert_int_equal(masu_scene_bind(blob, bytes, &bound, NULL), MASU_OK);
    assert_true(masu_ref_triangles_open(&bound, &l->world));
    free(blob);
}

static void close_lamps(lamps *l) {
    masu_ref_triangles_close(&l->world);
    close_session(&l->s);
}

static const uint16_t *take(lamps *l, const masu_camera *camera, uint32_t rung) {
    masu_light dark = {.sun_direction = {0, 1, 0}, .exposure = 1};
    masu_frame_desc frame = {.camera = camera, .light = &dark, .rung = rung};
    masu_commands commands;
    draw(&l->s, &frame, &commands, NULL);
    l->stats = stats_of(&l->s, commands.slot);
    assert_int_equal(l->stats.replaced, 0);
    return read_image(&l->s, commands.slot, MASU_READBACK_HDR);
}

/* Renders until nothing changes any more. */
static const uint16_t *settle(lamps *l, const masu_camera *camera) {
    const uint16_t *hdr = NULL;
    for (uint32_t f = 0, still = 0; still < 10; f++) {
        hdr = take(l, camera, SHADOWED);
        still = l->stats.local_shadow_waiting || l->stats.local_shadow_faces ? 0 : still + 1;
        assert_true(f < 200);
    }
    return hdr;
}

static double luma(const uint16_t *texel) {
    return half_float(texel[0]) + half_float(texel[1]) + half_float(texel[2]);
}

/* ---- Comparison with exact rays -------------------------------------------------------------- */

static masu_punctual_light_state state_of(const lamps *l, uint32_t light) {
    masu_punctual_light_state s;
    assert_int_equal(
        masu_punctual_light_get(l->s.m, masu_punctual_light_at(l->s.m, light), &s, NULL), MASU_OK);
    return s;
}

typedef struct hit_point {
    double at[3], normal[3]; /* on the light's side */
    uint32_t triangle;
} hit_point;

static int point_under(const lamps *l, const masu_camera *c, const double light[3], uint32_t x,
                       uint32_t y, hit_point *out) {
    double f[3], r[3], u[3], up[3] = {0, 1, 0}, d[3], towards[3], t;
    for (int k = 0; k < 3; k++) f[k] = (double)c->forward[k];
    unit3(f);
    cross3(f, up, r);
    unit3(r);
    cross3(r, f, u);
    double tan_y = tan((double)c->fov_y / 2),
           a = ((x + 0.5) / l->width * 2 - 1) * tan_y * l->width / l->height;
    double b = ((y + 0.5) / l->height * 2 - 1) * tan_y;
    for (int k = 0; k < 3; k++) d[k] = f[k] + r[k] * a - u[k] * b;
    int64_t hit = masu_ref_hit(&l->world, c->position, d, 0.05, HUGE_VAL, &t);
    if (hit < 0) return 0;
    for (int k = 0; k < 3; k++) {
        out->at[k] = c->position[k] + d[k] * t;
        towards[k] = light[k] - out->at[k];
    }
    out->triangle = (uint32_t)hit;
    return masu_ref_normal(&l->world.triangles[hit], towards, out->normal);
}

static int sees(const lamps *l, const double at[3], const double normal[3], const double light[3],
                double near) {
    double from[3], d[3], t;
    for (int k = 0; k < 3; k++) {
        from[k] = at[k] + normal[k] * 1e-4;
        d[k] = light[k] - from[k];
    }
    double length = sqrt(dot3(d, d));
    return masu_ref_hit(&l->world, from, d, 0, 1 - near / length, &t) < 0;
}

/* Whether the light's visibility is the same on the point's plane within this number of texels of
 * its face. */
static int is_clear(const lamps *l, const hit_point *p, const double light[3], double texel,
                    double texels, int seen, double near) {
    double d[3], major = 0;
    for (int k = 0; k < 3; k++) {
        d[k] = p->at[k] - light[k];
        major = fmax(major, fabs(d[k]));
    }
    for (int i = 0; i < 16; i++) {
        double turn = i * (6.28318530718 / 8), far = texels * texel * major * (i < 8 ? 1 : 0.5),
               to[3], at[3];
        double across[3] = {1, 0, 0}, u[3], v[3];
        if (fabs(d[0]) > 0.7 * major) across[0] = 0, across[1] = 1;
        cross3(d, across, u);
        unit3(u);
        cross3(d, u, v);
        unit3(v);
        for (int k = 0; k < 3; k++) to[k] = d[k] + far * (cos(turn) * u[k] + sin(turn) * v[k]);
        double along = dot3(to, p->normal), t = along < -1e-9 ? dot3(d, p->normal) / along : 0;
        if (!(t > 0) || t > 20) return 0;
        for (int k = 0; k < 3; k++) at[k] = light[k] + to[k] * t;
        if (sees(l, at, p->normal, light, near) != seen) return 0;
    }
    return 1;
}

typedef struct comparison {
    /* pixels; wrong_near: within two texels of an edge */
    uint32_t lit, wrong, wrong_near, seam, seam_wrong;
} comparison;

/* Texel width of the light's faces for this camera; now: their previous size, and the new one. */
static double texel_of(const lamps *l, const masu_camera *c, double tangent, uint32_t most,
                       uint32_t *now) {
    masu_punctual_light_state s = state_of(l, 0);
    double d[3], pixels = 0.5 * l->height / tan((double)c->fov_y / 2);
    for (int k = 0; k < 3; k++) d[k] = s.position[k] - c->position[k];
    *now = masu_local_face_size(
        masu_local_face_wish((double)s.range, tangent, sqrt(dot3(d, d)), pixels), *now, most);
    return 2 * tangent / (*now - 4);
}

static comparison compare_rays(lamps *l, const masu_camera *c, double texel, const char *what) {
    static uint16_t plain[4 * PIXELS_MOST];
    comparison sum = {0};
    masu_punctual_light_state s = state_of(l, 0);
    double near = fmax(0.05, (double)s.radius);
    memcpy(plain, take(l, c, PLAIN), (size_t)l->width * l->height * 8);
    const uint16_t *hdr = settle(l, c);
    for (uint32_t i = 0; i < l->width * l->height; i++) {
        hit_point p;
        double without = luma(plain + 4 * i);
        if (!(without > 1e-3) || !point_under(l, c, s.position, i % l->width, i / l->width, &p))
            continue;
        double seen = luma(hdr + 4 * i) / without;
        int truth = sees(l, p.at, p.normal, s.position, near);
        sum.lit++;
        int off = fabs(seen - truth) > 0.1;
        double d[3], size[3];
        for (int k = 0; k < 3; k++) size[k] = fabs(d[k] = p.at[k] - s.position[k]);
        double most = fmax(size[0], fmax(size[1], size[2]));
        int seam = 0;
        for (int k = 0; k < 3; k++) {
            double second = fmin(size[k], size[(k + 1) % 3]) > size[(k + 2) % 3]
                                ? fabs(size[k] - size[(k + 1) % 3])
                                : 9;
            seam |= second < 2 * texel * most;
        }
        sum.seam += seam != 0;
        if (!off) continue;
        sum.wrong += is_clear(l, &p, s.position, texel, 2, truth, near);
        sum.seam_wrong += seam && is_clear(l, &p, s.position, texel, 2, truth, near);
        sum.wrong_near++;
    }
    print_message("%-24s %6u lit, error over 0.1: %5u, beyond 2 texels of an edge %4u (%.2f %%); "
                  "at seams %u, off %u\n",
                  what, sum.lit, sum.wrong_near, sum.wrong, 100.0 * sum.wrong / sum.lit, sum.seam,
                  sum.seam_wrong);
    return sum;
}

static void add_room(void) {
    uint64_t seed = 5;
    for (int i = 0; i < 14; i++) {
        char name[16];
        snprintf(name, sizeof name, "box%d", i);
        double turn = i * 2.399963, far = 1.2 + 0.28 * i, high = random_between(&seed, 0.3, 2.2);
        add_box(name, far * cos(turn), high / 2 + (i % 5 == 0 ? 0.4 : 0), far * sin(turn),
                random_between(&seed, 0.2, 1), high, random_between(&seed, 0.2, 1),
                random_between(&seed, 0, 90));
    }
    for (int i = 0; i < 3; i++) {
        add(", {\"mesh\": {\"sphere\": {\"subdivisions\": %d}}, \"scale\": 0.6, \"translate\": "
            "[%g, 0.6, %g], "
            "\"material\": {\"roughness\": 1}}",
            3 + i, 1.5 * i - 2.5, 2.5 - i);
    }
    add_box("wall", 0, 2, -7, 16, 4, 0.3, 0);
    add_box("side", -7, 2, 0, 0.3, 4, 16, 0);
    add_box("roof", 1, 3.6, 1, 3, 0.1, 2, 20);
}

static void visibility_is_that_of_rays(void **state) {
    (void)state;
    static const struct {
        const char *what, *light;
        double tangent;
        uint32_t most; /* texels of a face */
    } cases[] = {
        {"point",
         "{\"type\": \"point\", \"position\": [0, 2.1, 0.2], \"intensity\": 9, \"range\": 14}", 1,
         256},
        {"spot of 40",
         "{\"type\": \"spot\", \"position\": [4, 4, 5], \"direction\": [-1, -0.8, -1.1], "
         "\"outer\": 40, "
         "\"intensity\": 30, \"range\": 20}",
         0.8391, 512},
        {"spot of 75, cube",
         "{\"type\": \"spot\", \"position\": [0.3, 3, 0], \"direction\": [0.2, -1, 0], \"outer\": "
         "75, "
         "\"intensity\": 12, \"range\": 14}",
         1, 256},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lamps l;
        if (i && is_slow_driver()) continue;
        begin_scene(30);
        add_room();
        add_lights(cases[i].light);
        bake_scene("lamp_room", json);
        open_lamps(&l, "lamp_room", 200, 125, NULL, 0);
        masu_camera views[] = {look(4.5, 4.5, 6, -4, -4.2, -6, 1.1),
                               look(-5, 2, 5, 5, -1.5, -6, 1.2)};
        uint32_t size = 0;
        for (size_t v = 0; v < (i == 1 ? 2 : 1); v++) {
            double texel = texel_of(&l, &views[v], cases[i].tangent, cases[i].most, &size);
            comparison c = compare_rays(&l, &views[v], texel, cases[i].what);
            assert_true(c.lit > 3000);
            assert_true(c.wrong * 100 <= c.lit);
            assert_true(c.wrong_near * 40 <= c.lit); /* an edge as wide as the filter: 6 % */
            assert_true(c.seam_wrong * 100 <= c.seam);
        }
        close_lamps(&l);
    }
}

/* ---- Planes ---------------------------------------------------------------------------------- */

typedef struct plane_case {
    const char *what;
    uint32_t atlas;
    double height;
    int spot;
    int tiles; /* the ground is many small triangles, and the camera is near; else two triangles */
} plane_case;

/* Only the ground, under a lamp close above: it is lit at all angles, and fills the lamp's
 * faces. */
static void expect_no_acne(const plane_case *p) {
    static uint16_t plain[4 * PIXELS_MOST];
    lamps l;
    masu_rung rung = {.local_shadow_atlas = p->atlas};
    char text[300];
    begin_scene(p->tiles ? 2 : 60);
    for (int i = 0; i < 17 * 17 && p->tiles; i++) {
        int x = i % 17 - 8, z = i / 17 - 8;
        if (x || z)
            add(", {\"mesh\": {\"plane\": {\"size_x\": 2, \"size_z\": 2}}, \"translate\": [%d, 0, "
                "%d], "
                "\"material\": {\"roughness\": 1}}",
                2 * x, 2 * z);
    }
    snprintf(text, sizeof text,
             "{\"type\": \"%s\", \"position\": [0.1, %g, 0.2], \"intensity\": 40, \"range\": 25%s}",
             p->spot ? "spot" : "point", p->height,
             p->spot ? ", \"direction\": [1, -0.5, 0.3], \"outer\": 55" : "");
    add_lights(text);
    bake_scene("lamp_plane", json);
    open_lamps(&l, "lamp_plane", 200, 125, &rung, 0);
    masu_camera c =
        p->tiles ? look(-1.5, 1.2, 1, 1.6, -0.9, -0.8, 1.3) : look(-8, 5, 3, 8, -4.4, -3, 1.2);
    memcpy(plain, take(&l, &c, PLAIN), sizeof plain);
    const uint16_t *hdr = settle(&l, &c);
    assert_int_equal(l.stats.local_shadow_lights, 1);
    masu_punctual_light_state s = state_of(&l, 0);
    uint32_t lit = 0, dark = 0;
    double least = 1, angles[2] = {90, 0};
    for (uint32_t i = 0; i < l.width * l.height; i++) {
        hit_point at;
        if (!(luma(plain + 4 * i) > 1e-4) ||
            !point_under(&l, &c, s.position, i % l.width, i / l.width, &at))
            continue;
        double d[3] = {at.at[0] - s.position[0], at.at[1] - s.position[1],
                       at.at[2] - s.position[2]};
        double angle = acos(fabs(d[1]) / sqrt(dot3(d, d))) * (180 / 3.14159265358979);
        if (angle > 89.0) continue;
        double seen = luma(hdr + 4 * i) / luma(plain + 4 * i);
        angles[0] = fmin(angles[0], angle), angles[1] = fmax(angles[1], angle);
        lit++, dark += seen < 0.99;
        least = fmin(least, seen);
    }
    print_message("%-18s %u lit pixels at %.1f to %.1f degrees, below 0.99: %u, the least %.3f\n",
                  p->what, lit, angles[0], angles[1], dark, least);
    assert_true(lit > 1500 && angles[1] > 80);
    assert_int_equal(dark, 0);
    close_lamps(&l);
}

static void planes_do_not_shadow_themselves(void **state) {
    (void)state;
    expect_no_acne(&(plane_case){"point, 512", 2048, 0.3, 0, 1});
    if (is_slow_driver()) return;
    expect_no_acne(&(plane_case){"point, 128", 512, 0.3, 0, 1});
    expect_no_acne(&(plane_case){"spot, 512", 2048, 1.5, 1, 1});
}

/* Clipped to a hundredth of their size, and farther from the camera than from the lamp, whose
 * texels are a twentieth of a pixel: with few subpixel bits, the camera's rasteriser changes their
 * depth by more than a texel. */
static void large_triangles_do_not_shadow_themselves(void **state) {
    (void)state;
    expect_no_acne(&(plane_case){"two triangles", 2048, 0.3, 0, 0});
}

/* Two lamps behind the plane of a box's face with normals tilted towards one of the lamps by 30
 * degrees: both are dark there. */
static void faces_that_look_away_are_dark(void **state) {
    (void)state;
    static uint16_t plain[4 * PIXELS_MOST];
    lamps l;
    masu_camera c = look(0, 1, 3, 0, 0, -1, 0.5);
    begin_scene(0.1);
    add(", {\"mesh\": {\"box\": {\"size\": [1, 1, 0.2]}}, \"translate\": [0, 1, 0], \"material\": "
        "{\"roughness\": 1, "
        "\"normal_map\": \"lean_right.png\"}}");
    assert_int_equal(
        shell("cp %s/textures/lean_right.png %s", build_dir(), in_scratch("lean_right.png")), 0);
    add_lights(
        "{\"type\": \"point\", \"position\": [3, 1, -0.4], \"intensity\": 40, \"range\": 9}, "
        "{\"type\": \"point\", \"position\": [-3, 1, -0.4], \"intensity\": 40, \"range\": 9}");
    bake_scene("lamp_behind", json);
    open_lamps(&l, "lamp_behind", 64, 40, NULL, 0);
    memcpy(plain, take(&l, &c, PLAIN), (size_t)l.width * l.height * 8);
    const uint16_t *hdr = settle(&l, &c);
    uint32_t lit = 0, bright = 0;
    for (uint32_t i = 0; i < l.width * l.height; i++) {
        if (!(luma(plain + 4 * i) > 1e-3)) continue;
        lit++, bright += luma(hdr + 4 * i) > 0.1 * luma(plain + 4 * i);
    }
    print_message("%u pixels are lit from behind without shadows, %u with them\n", lit, bright);
    assert_true(lit > 300);
    assert_true(bright * 100 <= lit); /* SwiftShader: 3 at the edge of the face */
    close_lamps(&l);
}

/* ---- Cache ----------------------------------------------------------------------------------- */

static void bake_street(void) {
    begin_scene(60);
    add_room();
    add_box("car", 0, 0.5, 3, 1, 1, 2, 0);
    add_lights(
        "{\"type\": \"point\", \"position\": [0, 2.1, 0.2], \"intensity\": 9, \"range\": 9}, "
        "{\"type\": \"spot\", \"position\": [4, 4, 5], \"direction\": [-1, -0.8, -1.1], \"outer\": "
        "40, "
        "\"intensity\": 30, \"range\": 20}, "
        "{\"type\": \"point\", \"position\": [-4, 1.5, 3], \"intensity\": 6, \"range\": 8}, "
        "{\"type\": \"spot\", \"position\": [0, 0.1, 1.2], \"direction\": [0, -0.1, 1], \"outer\": "
        "25, "
        "\"instance\": \"car\", \"intensity\": 20, \"range\": 15}");
    bake_scene("lamp_street", json);
}

static void expect_kept(uint32_t atlas) {
    static uint16_t kept[4 * PIXELS_MOST];
    lamps l;
    masu_rung rung = {.local_shadow_atlas = atlas};
    masu_camera end = look(5, 4.5, 7, -4, -3, -6, 1.1);
    bake_street();
    open_lamps(&l, "lamp_street", 96, 60, &rung, 0);
    uint32_t most = 0, rendered = 0;
    for (int f = 0; f < 90; f++) {
        double t = f / 90.0;
        masu_camera c = look(5 * t, 4.5, 7, -4 + 3 * sin(20 * t), -3, -6, 1.1);
        if (f % 3 && f < 70)
            move_instance(&l.s, "car", (float)(6 * t - 3), 0.5f, (float)(3 + sin(9 * t)), 1);
        if (f % 20 < 5)
            move_instance(&l.s, "box3", (float)(2 * cos(f)), 0.5f, (float)(2 * sin(f)), 1);
        take(&l, &c, SHADOWED);
        assert_true(l.stats.local_shadow_faces <= 4);
        if (most < l.stats.local_shadow_faces) most = l.stats.local_shadow_faces;
        rendered += l.stats.local_shadow_faces;
    }
    move_instance(&l.s, "car", 1, 0.5f, 3.5f, 1);
    memcpy(kept, settle(&l, &end), (size_t)l.width * l.height * 8);
    assert_int_equal(most, 4);
    print_message("%u faces rendered in 90 frames\n", rendered);
    /* Nothing is rendered in a static scene. */
    for (int f = 0; f < 8; f++) {
        assert_memory_equal(take(&l, &end, SHADOWED), kept, (size_t)l.width * l.height * 8);
        assert_int_equal(l.stats.local_shadow_faces, 0);
        assert_int_equal(l.stats.local_shadow_lights, 4);
    }
    close_lamps(&l);
    lamps fresh;
    open_lamps(&fresh, "lamp_street", 96, 60, &rung, 0);
    move_instance(&fresh.s, "car", 1, 0.5f, 3.5f, 1);
    move_instance(&fresh.s, "box3", (float)(2 * cos(84)), 0.5f, (float)(2 * sin(84)), 1);
    const uint16_t *again = settle(&fresh, &end);
    uint32_t other = 0;
    for (uint32_t i = 0; i < 4 * fresh.width * fresh.height; i++) other += again[i] != kept[i];
    print_message("%u components differ from those of a new renderer\n", other);
    assert_int_equal(other, 0);
    close_lamps(&fresh);
}

/* Also in an atlas without room for the preferred sizes of its 14 faces. */
static void what_is_kept_is_what_would_be_rendered(void **state) {
    (void)state;
    if (is_slow_driver()) return; /* the host decides it */
    expect_kept(2048);
    expect_kept(1024);
}

/* Two lights and one slot: a third light, brighter and out of view, takes it. */
static void shadows_come_and_go_by_steps(void **state) {
    (void)state;
    if (is_slow_driver()) return; /* the host decides it */
    static uint16_t plain[4 * PIXELS_MOST], before[4 * PIXELS_MOST];
    lamps l;
    masu_rung rung = {.local_shadow_lights = 1};
    masu_camera c = look(5, 4.5, 7, -4, -3, -6, 1.1);
    begin_scene(60);
    add_room();
    add_lights(
        "{\"type\": \"point\", \"position\": [0, 2.1, 0.2], \"intensity\": 9, \"range\": 14}, "
        "{\"type\": \"point\", \"position\": [20, 2, 30], \"intensity\": 9, \"range\": 5}");
    bake_scene("lamp_pair", json);
    open_lamps(&l, "lamp_pair", 96, 60, &rung, 0);
    memcpy(plain, take(&l, &c, PLAIN), (size_t)l.width * l.height * 8);
    memcpy(before, plain, (size_t)l.width * l.height * 8);
    masu_punctual_light_state away = state_of(&l, 1);
    double most = 0;
    uint32_t shadowed = 0, changes = 0;
    for (int f = 0; f < 125; f++) {
        if (f == 35 || f == 80) {
            away.color[0] = f == 35 ? 1e6f : 1.0f;
            assert_int_equal(
                masu_punctual_light_set(l.s.m, masu_punctual_light_at(l.s.m, 1), &away, NULL),
                MASU_OK);
        }
        const uint16_t *hdr = take(&l, &c, SHADOWED);
        assert_int_equal(l.stats.local_shadow_lights <= 1, 1);
        uint32_t now = 0, changed = 0;
        for (uint32_t i = 0; i < l.width * l.height; i++) {
            double without = luma(plain + 4 * i);
            if (!(without > 1e-3)) continue;
            now += luma(hdr + 4 * i) < 0.05 * without;
            double step = fabs(luma(hdr + 4 * i) - luma(before + 4 * i)) / without;
            if (f < 20) continue; /* after a cut they appear at once */
            most = fmax(most, step);
            changed |= step > 0.01;
        }
        changes += changed;
        if (f == 30 || f == 120) shadowed += now > 150;
        if (f == 75) assert_int_equal(now, 0);
        memcpy(before, hdr, (size_t)l.width * l.height * 8);
    }
    print_message("largest step %.4f of the light in a frame, %u frames with any\n", most, changes);
    assert_int_equal(shadowed, 2);
    assert_int_equal(changes, 16);
    assert_true(most <= 1.0 / 8 + 2e-3);
    close_lamps(&l);
}

/* Inside a closed box six faces of the point light need rendering in each frame, two more than
 * allowed: no pixel outside is lit in any frame. */
static void a_point_that_moves_keeps_its_walls(void **state) {
    (void)state;
    static uint16_t plain[4 * PIXELS_MOST];
    lamps l;
    masu_rung rung = {.local_shadow_faces = 4};
    masu_camera c = look(0, 9, 7, 0, -9, -7, 1.0);
    uint32_t lit = 0, leaks = 0, waited = 0;
    begin_scene(24);
    for (int k = 0; k < 2; k++) {
        add_box(k ? "right" : "left", 2.2 * k - 1.1, 1.1, 0, 0.2, 2.2, 2.4, 0);
        add_box(k ? "front" : "back", 0, 1.1, 2.2 * k - 1.1, 2.4, 2.2, 0.2, 0);
    }
    add_box("lid", 0, 2.3, 0, 2.4, 0.2, 2.4, 0);
    add_lights("{\"type\": \"point\", \"position\": [0, 1.1, 0], \"intensity\": 9, \"range\": 14}");
    bake_scene("lamp_shut", json);
    open_lamps(&l, "lamp_shut", 96, 60, &rung, 0);
    memcpy(plain, take(&l, &c, PLAIN), (size_t)l.width * l.height * 8);
    settle(&l, &c);
    masu_punctual_light_state lamp = state_of(&l, 0);
    for (int f = 0; f < 24; f++) {
        lamp.position[0] = 0.6 * sin(0.3 * f);
        lamp.position[2] = 0.4 * sin(0.5 * f);
        assert_int_equal(
            masu_punctual_light_set(l.s.m, masu_punctual_light_at(l.s.m, 0), &lamp, NULL), MASU_OK);
        const uint16_t *hdr = take(&l, &c, SHADOWED);
        assert_true(l.stats.local_shadow_faces <= 4);
        waited += l.stats.local_shadow_waiting != 0;
        for (uint32_t i = 0; i < l.width * l.height; i++) {
            double without = luma(plain + 4 * i);
            if (!(without > 1e-2)) continue;
            lit++;
            leaks += luma(hdr + 4 * i) > 0.05 * without;
        }
    }
    print_message("%u of %u pixels lit outside, faces waited in %u of 24 frames\n",
                  leaks, lit, waited);
    assert_true(lit > 24 * 1000 && waited > 8);
    assert_int_equal(leaks, 0);
    settle(&l, &c); /* after the light stops, no face waits */
    close_lamps(&l);
}

/* ---- Changes at run time --------------------------------------------------------------------- */

static void lights_come_and_go(void **state) {
    (void)state;
    enum { ROOM = 40 };
    const uint32_t changes = trials(1000, 400, 120);
    lamps l;
    masu_camera c = look(5, 4.5, 7, -4, -3, -6, 1.1);
    masu_punctual_light handles[ROOM] = {{0}};
    uint64_t seed = 3;
    bake_street();
    open_lamps(&l, "lamp_street", 64, 40, NULL, ROOM);
    for (uint32_t n = 0; n < changes; n++) {
        uint32_t at = (uint32_t)random_between(&seed, 0, ROOM - 0.01);
        if (handles[at].id)
            assert_int_equal(masu_punctual_light_remove(l.s.m, handles[at], NULL), MASU_OK);
        masu_punctual_light_state s = {.range = (float)random_between(&seed, 1, 12),
                                       .radius = 0.01f,
                                       .spot = n % 3 == 0,
                                       .no_shadow = n % 7 == 0,
                                       .direction = {0.3f, -1, 0.2f},
                                       .inner = 0.2f,
                                       .outer = (float)random_between(&seed, 0.2, 3.1)};
        for (int k = 0; k < 3; k++) {
            s.position[k] = random_between(&seed, -4, 4) + (k == 1 ? 3 : 0);
            s.color[k] = (float)random_between(&seed, 0, 20);
        }
        assert_int_equal(masu_punctual_light_add(l.s.m, &s, &handles[at], NULL), MASU_OK);
        if (n % 4) continue;
        take(&l, &c, n % 100 == 48 ? PLAIN : SHADOWED);
        assert_true(l.stats.local_shadow_faces <= 4 && l.stats.local_shadow_lights <= 16);
    }
    close_lamps(&l);
}

static void nothing_is_planned_where_no_light_casts(void **state) {
    (void)state;
    if (is_slow_driver()) return; /* the host decides it */
    for (uint32_t casts = 0; casts < 2; casts++) {
        lamps l;
        masu_plan_info plan;
        char text[200];
        begin_scene(20);
        snprintf(
            text, sizeof text,
            "{\"type\": \"point\", \"position\": [0, 2, 0], \"intensity\": 5, \"shadows\": %s}",
            casts ? "true" : "false");
        add_lights(text);
        bake_scene("lamp_off", json);
        open_lamps(&l, "lamp_off", 16, 16, NULL, 0);
        masu_plan_of(l.s.m, &plan);
        for (uint32_t i = 0; i < plan.pass_count; i++) {
            if (strncmp(plan.passes[i].name, "local_shadow", 12) == 0 &&
                strcmp(plan.passes[i].name, "local_shadow_sdf") != 0)
                assert_int_equal(plan.passes[i].active, casts ? 1u << SHADOWED : 0);
        }
        uint64_t bytes = 0;
        for (uint32_t i = 0; i < plan.image_count; i++) {
            if (strcmp(plan.images[i].name, "local_shadow_atlas") == 0 && plan.images[i].used)
                bytes = plan.images[i].bytes;
        }
        /* One point light: six faces of 512 fit into 2048. */
        if (!casts) assert_int_equal(bytes, 0);
        if (casts) assert_true(bytes >= 8 * 1024 * 1024 && bytes < 9 * 1024 * 1024);
        close_lamps(&l);
    }
}

/* ---- GPUs with few registers ----------------------------------------------------------------- */

static PFN_vkGetInstanceProcAddr real_proc;

static VKAPI_ATTR void VKAPI_CALL pretend_mali(VkPhysicalDevice physical,
                                               VkPhysicalDeviceProperties *out) {
    vkGetPhysicalDeviceProperties(physical, out);
    out->vendorID = 0x13B5;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL mali_proc(VkInstance instance, const char *name) {
    if (!strcmp(name, "vkGetPhysicalDeviceProperties")) return (PFN_vkVoidFunction)pretend_mali;
    return real_proc(instance, name);
}

/* Their shaders load and unpack values again, some as half floats (masu_few_registers). */
static void few_registers_change_only_rounding(void **state) {
    (void)state;
    enum { WIDTH = 96, HEIGHT = 60, VALUES = WIDTH * HEIGHT * 4 };
    static uint16_t first[VALUES];
    masu_camera view = look(4.5, 4.5, 6, -4, -4.2, -6, 1.1);
    begin_scene(30);
    add_room();
    add_lights("{\"type\": \"point\", \"position\": [0, 2.1, 0.2], \"intensity\": 9, "
               "\"range\": 14}, {\"type\": \"rectangle\", \"position\": [1, 3, 1], "
               "\"half_u\": [0.5, 0, 0], \"half_v\": [0, 0, 0.25], \"intensity\": 4, "
               "\"range\": 14}");
    bake_scene("lamp_registers", json);
    uint32_t bright = 0, different = 0;
    double worst = 0;
    for (int pass = 0; pass < 2; pass++) {
        lamps l = {.width = WIDTH, .height = HEIGHT};
        char error[256];
        masu_session_desc d = test_desc(NULL, WIDTH, HEIGHT);
        d.scene_path = baked_scene("lamp_registers");
        d.desc.readback = MASU_READBACK_HDR;
        d.desc.rung_count = 1;
        d.no_renderer = true;
        open_session(&l.s, &d);
        real_proc = l.s.desc.vulkan.get_instance_proc_addr;
        if (pass) l.s.desc.vulkan.get_instance_proc_addr = mali_proc;
        assert_true(masu_session_start(&l.s, error, sizeof error));
        const uint16_t *hdr = settle(&l, &view);
        for (uint32_t i = 0; i < VALUES; i++) {
            if (!pass) {
                first[i] = hdr[i];
                continue;
            }
            double a = half_float(first[i]), b = half_float(hdr[i]);
            bright += a > 0.01;
            different += a != b;
            if (fabs(a - b) > worst * fmax(a, 1e-3)) worst = fabs(a - b) / fmax(a, 1e-3);
        }
        close_session(&l.s);
    }
    print_message("few registers: %u of %u values differ, by %.2e at most\n", different, bright,
                  worst);
    assert_true(bright > VALUES / 4);
    assert_true(different > 0); /* the other form ran */
    assert_true(worst < 2e-3);  /* two steps of a half float */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(visibility_is_that_of_rays),
        cmocka_unit_test(planes_do_not_shadow_themselves),
        cmocka_unit_test(large_triangles_do_not_shadow_themselves),
        cmocka_unit_test(faces_that_look_away_are_dark),
        cmocka_unit_test(what_is_kept_is_what_would_be_rendered),
        cmocka_unit_test(shadows_come_and_go_by_steps),
        cmocka_unit_test(a_point_that_moves_keeps_its_walls),
        cmocka_unit_test(lights_come_and_go),
        cmocka_unit_test(few_registers_change_only_rounding),
        cmocka_unit_test(nothing_is_planned_where_no_light_casts),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

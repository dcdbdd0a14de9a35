/* test_sprites.c: particles, decals and debug lines against scalar references: blending of a
 * particle, its order relative to transparent surfaces, its fade in front of a surface, its
 * lighting; a decal's effect on the G-buffer of a polygon ball and an SDF ball, and on nothing
 * around them; the pixels of a line. Also: arbitrary numbers are safe, unused capacity changes
 * nothing, and no trail remains in a history. */
#include "support/support.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { SIDE = 96, PIXELS = SIDE * SIDE, ROOM = 64 };

static masu_session s;
static float base[4 * PIXELS], picture[4 * PIXELS], depths[PIXELS];
static uint8_t plain[4 * PIXELS], shown[4 * PIXELS];

/* test_pane: an SDF ball on the left, a polygon ball on the right, a pane of opacity 0.5. */
static const masu_camera camera = {
    .position = {0, 0, 6}, .forward = {0, 0, -1}, .fov_y = 0.8726646f, .near_distance = 0.1f};

static masu_session_desc room_desc(const char *scene) {
    masu_session_desc d = test_desc(scene, SIDE, SIDE);
    d.desc.readback =
        MASU_READBACK_HDR | MASU_READBACK_DEPTH | MASU_READBACK_ALBEDO | MASU_READBACK_NORMAL;
    d.desc.rung_count = 1;
    d.desc.reserve = (masu_reserve){.particles = ROOM, .decals = ROOM, .lines = ROOM};
    return d;
}

static void pane_at(double z) {
    const float rows[12] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, (float)z};
    place_instance(&s, "pane", rows);
}

static void open_room(const char *scene) {
    masu_session_desc d = room_desc(scene);
    open_session(&s, &d);
    if (!strcmp(scene, "test_pane")) pane_at(100); /* out of the way */
}

static masu_stats_info render(masu_frame_desc frame, float *hdr) {
    masu_commands commands;
    draw(&s, &frame, &commands, shown);
    floats_of_halves(read_image(&s, commands.slot, MASU_READBACK_HDR), hdr, 4 * PIXELS);
    masu_stats_info stats = stats_of(&s, commands.slot);
    assert_int_equal(stats.replaced, 0);
    return stats;
}

static masu_frame_desc with_particles(const masu_particle *p, uint32_t count) {
    return (masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .particles = p,
                             .particle_count = count};
}

/* ---- Particles ------------------------------------------------------------------------------- */

/* A particle's coverage of a pixel, with a surface at view depth z behind it, 0: the sky. Below 0:
 * at its rim. */
static double cover_of(const masu_particle *p, uint32_t pixel, double z) {
    double tan_y = tan((double)camera.fov_y / 2), depth = camera.position[2] - p->position[2];
    double x =
        ((pixel % SIDE + 0.5) / SIDE * 2 - 1) * tan_y * depth + camera.position[0] - p->position[0];
    double y =
        (1 - (pixel / SIDE + 0.5) / SIDE * 2) * tan_y * depth + camera.position[1] - p->position[1];
    double c = cos((double)p->rotation), n = sin((double)p->rotation), room = 1;
    double u = (c * x + n * y) / (double)p->half_width,
           v = (c * y - n * x) / (double)p->half_height;
    double rest = 1 - sqrt(u * u + v * v);
    if (z > 0 && z < depth) return 0;
    if (fabs(rest) < 0.02 || (z > 0 && fabs(z - depth) < 0.01)) return -1;
    if (rest < 0) return 0;
    double t = fmin(1, rest / fmax(1 - (double)p->edge, 1e-3));
    if (p->soft > 0) {
        if (z > 0) room = fmin(room, (z - depth) / (double)p->soft);
        room = fmax(0, fmin(room, (depth - 0.1) / (double)p->soft));
    }
    return t * t * (3 - 2 * t) * room;
}

/* The largest difference of `picture` from particles blended over `base`, in the given order. */
static double compare(const masu_particle *p, uint32_t count, uint32_t *covered) {
    double worst = 0;
    *covered = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double want[3] = {(double)base[4 * i], (double)base[4 * i + 1], (double)base[4 * i + 2]};
        int rim = 0, any = 0;
        for (uint32_t n = 0; n < count; n++) {
            double cover = cover_of(&p[n], i, (double)depths[i]), a = (double)p[n].opacity * cover;
            rim |= cover < 0;
            any |= cover > 0;
            for (uint32_t k = 0; k < 3; k++)
                want[k] = (double)p[n].color[k] * a +
                          (p[n].flags & MASU_PARTICLE_ADDITIVE ? 1 : 1 - a) * want[k];
        }
        if (rim) continue;
        *covered += any;
        for (uint32_t k = 0; k < 3; k++)
            worst = worst_of(worst, fabs(want[k] - (double)picture[4 * i + k]) / fmax(1, want[k]));
    }
    return worst;
}

static void read_base(const masu_frame_desc *frame) {
    masu_commands commands;
    draw(&s, frame, &commands, plain);
    floats_of_halves(read_image(&s, commands.slot, MASU_READBACK_HDR), base, 4 * PIXELS);
    view_depths(read_image(&s, commands.slot, MASU_READBACK_DEPTH), &camera, depths, PIXELS);
}

static const masu_particle disc = {.position = {0.2, -0.1, 2},
                                   .half_width = 0.9f,
                                   .half_height = 0.5f,
                                   .rotation = 0.4f,
                                   .color = {2, 0.5f, 0.25f},
                                   .opacity = 0.75f,
                                   .edge = 1};

static void a_particle_is_blended_in_linear_light(void **state) {
    (void)state;
    const masu_frame_desc none = {MASU_FRAME_DESC, .camera = &camera};
    open_room("test_pane");
    read_base(&none);
    for (uint32_t form = 0; form < 6; form++) {
        masu_particle p = disc;
        if (form == 1) p.flags = MASU_PARTICLE_ADDITIVE;
        if (form == 2) p.edge = 0;
        if (form == 3) p.edge = 0.5f, p.soft = 3;
        if (form == 4)
            p.position[2] = 0, p.half_width = p.half_height = 2, p.soft = 1; /* cuts both balls */
        if (form == 5) p.position[2] = 5.4, p.soft = 1; /* fades out in front of the camera */
        masu_stats_info stats = render(with_particles(&p, 1), picture);
        assert_int_equal(stats.particles, 1);
        uint32_t covered;
        double worst = compare(&p, 1, &covered);
        print_message("form %u: %u pixels, error of %.2f of 255 at most\n",
                      form, covered, 255 * worst);
        assert_true(covered > 300 && worst <= 2.0 / 255);
    }
    close_session(&s);
}

static void hides_and_is_hidden(masu_particle *p, uint32_t count, double pane_z) {
    /* Far to near: the reference blends them, with the pane as a particle without an edge. */
    masu_particle all[8];
    uint32_t n = 0, covered;
    int pane_done = 0;
    for (uint32_t i = 0; i <= count; i++) { /* p is from far to near */
        if (!pane_done && (i == count || p[i].position[2] > pane_z)) {
            all[n++] = (masu_particle){.position = {0, 0, pane_z},
                                       .half_width = 1000,
                                       .half_height = 1000,
                                       .color = {0.25f, 1, 0.25f},
                                       .opacity = 0.5f,
                                       .edge = 1};
            pane_done = 1;
        }
        if (i < count) all[n++] = p[i];
    }
    pane_at(pane_z);
    for (uint32_t turn = 0; turn < 2; turn++) { /* in either order of the array */
        masu_particle given[8];
        for (uint32_t i = 0; i < count; i++) given[i] = p[turn ? i : count - 1 - i];
        masu_stats_info stats = render(with_particles(given, count), picture);
        assert_int_equal(stats.particles, count);
        assert_int_equal(stats.transparents, 1);
        double worst = compare(all, n, &covered);
        print_message("pane at %g, order %u: error of %.2f of 255 at most\n",
                      pane_z, turn, 255 * worst);
        assert_true(covered > PIXELS / 2 && worst <= 2.0 / 255);
    }
}

static void particles_and_transparents_are_sorted_as_one(void **state) {
    (void)state;
    const masu_frame_desc none = {MASU_FRAME_DESC, .camera = &camera};
    masu_particle p[4];
    open_room("test_pane");
    read_base(&none);
    for (uint32_t i = 0; i < 4; i++) {
        p[i] = disc;
        p[i].position[0] = p[i].position[1] = 0;
        p[i].position[2] = -3 + 1.6 * i;
        p[i].half_width = p[i].half_height = 1.0f + 0.1f * (float)i;
        for (uint32_t k = 0; k < 3; k++) p[i].color[k] = (i + k) % 3 ? 0.25f : 2;
    }
    static const double planes[] = {-4, -2.2, -0.6, 1, 3};
    for (size_t i = 0; i < sizeof planes / sizeof *planes; i++)
        hides_and_is_hidden(p, 4, planes[i]);
    close_session(&s);
}

/* One particle in the sun and one in the shadow of the tower, under a given light. */
static void a_lit_particle_has_sun_shadow_and_ambient_light(void **state) {
    (void)state;
    const masu_light light = {
        .sun_direction = {1, 1, 0}, .sun_color = {4, 2, 1}, .ambient = {0.25f, 0.5f, 0.125f}};
    const masu_camera above = {.position = {-7, 6, -2}, .forward = {0, -0.3f, -1}, .fov_y = 1.2f};
    open_room("test_shadows");
    for (int shaded = 0; shaded < 2; shaded++) {
        masu_particle p = {.position = {shaded ? -10 : -4, 1.5, -9},
                           .half_width = 0.5f,
                           .color = {1, 0.5f, 1},
                           .opacity = 1,
                           .edge = 1,
                           .flags = MASU_PARTICLE_LIT};
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &above, .light = &light,
                                 .particles = &p, .particle_count = 1};
        render(frame, picture);
        /* Its centre, by the same camera. */
        double len = sqrt(1.09), f[3] = {0, -0.3 / len, -1 / len}, up[3] = {0, 1 / len, -0.3 / len};
        double d[3] = {p.position[0] + 7, p.position[1] - 6, p.position[2] + 2};
        double z = d[1] * f[1] + d[2] * f[2], y = d[1] * up[1] + d[2] * up[2], t = tan(0.6);
        uint32_t px = (uint32_t)((d[0] / (z * t) + 1) * 0.5 * SIDE),
                 py = (uint32_t)((1 - y / (z * t)) * 0.5 * SIDE);
        for (uint32_t k = 0; k < 3; k++) {
            double want = (double)p.color[k] * ((shaded ? 0 : 0.25) * (double)light.sun_color[k] +
                                                (double)light.ambient[k]);
            double is = (double)picture[4 * (py * SIDE + px) + k];
            if (fabs(is - want) > 2e-3 * fmax(1, want))
                fail_msg("%s, channel %u: %g, not %g", shaded ? "shadow" : "sun", k, is, want);
        }
    }
    close_session(&s);
}

/* Fog in front: a part of 1 - e^-depth is the fog's own colour. */
static void fog_lies_over_particles(void **state) {
    (void)state;
    masu_light light;
    const masu_camera level = {.position = {0, 5, 0}, .forward = {0, 0, -1}, .fov_y = 0.8f};
    open_room("test_fog");
    assert_int_equal(masu_light_of(s.m, &light, &failure), MASU_OK);
    light.fog_density = 0.05f;
    light.fog_falloff = 0;
    light.fog_start = 2;
    light.fog_color[0] = 0.5f, light.fog_color[1] = 0.25f, light.fog_color[2] = 1;
    masu_particle p = {
        .position = {0, 5, -12}, .half_width = 2, .color = {3, 0, 1}, .opacity = 1, .edge = 1};
    render((masu_frame_desc){MASU_FRAME_DESC, .camera = &level, .light = &light, .particles = &p,
                             .particle_count = 1},
           picture);
    double left = exp(-0.05 * 10);
    for (uint32_t k = 0; k < 3; k++) {
        double want = (double)p.color[k] * left + (double)light.fog_color[k] * (1 - left);
        double is = (double)picture[4 * (SIDE / 2 * SIDE + SIDE / 2) + k];
        if (fabs(is - want) > 0.01) fail_msg("channel %u: %g, not %g", k, is, want);
    }
    close_session(&s);
}

/* ---- Decals ---------------------------------------------------------------------------------- */

typedef struct buffers {
    uint8_t albedo[4 * PIXELS];
    uint32_t normal[PIXELS];
} buffers;

static void read_buffers(const masu_frame_desc *frame, buffers *out, masu_stats_info *stats) {
    masu_commands commands;
    draw(&s, frame, &commands, shown);
    memcpy(out->albedo, read_image(&s, commands.slot, MASU_READBACK_ALBEDO), sizeof out->albedo);
    memcpy(out->normal, read_image(&s, commands.slot, MASU_READBACK_NORMAL), sizeof out->normal);
    if (stats) *stats = stats_of(&s, commands.slot);
}

/* Coverage at a point by a decal with axis-aligned bounds; below 0: at a limit. */
static double painted(const masu_decal *d, const double at[3], const float n[3]) {
    double p[3], slack = 0.01;
    for (uint32_t k = 0; k < 3; k++)
        p[k] = (at[k] - (double)d->rows[4 * k + 3]) / (double)d->rows[5 * k];
    double far = d->flags & MASU_DECAL_ROUND ? hypot(p[0], p[1]) : fmax(fabs(p[0]), fabs(p[1]));
    if (fabs(far - 1) < slack || fabs(fabs(p[2]) - 1) < slack) return -1;
    if (far > 1 || fabs(p[2]) > 1) return 0;
    double edge = d->edge > 0 ? fmin(1, (1 - far) / (double)d->edge) : 1;
    double inner = d->outer > 0 ? (double)d->inner : 1.05,
           outer = d->outer > 0 ? (double)d->outer : 1.4;
    double facing = ((double)n[2] - cos(outer)) / fmax(cos(inner) - cos(outer), 1e-4);
    return edge * fmax(0, fmin(1, facing));
}

/* Blends a decal into a surface: colour and metallic such that diffuse light is mixed, and likewise
 * the sum of diffuse and specular light. */
static void cover(const masu_decal *d, double share, double surface[5]) {
    double own = fmax(surface[0], fmax(surface[1], surface[2])) + 1 / 256.0;
    double other =
        fmax((double)d->color[0], fmax((double)d->color[1], (double)d->color[2])) + 1 / 256.0;
    double to = d->metallic < 0 ? surface[4] : (double)d->metallic,
           before = surface[4] + (to - surface[4]) * share;
    own *= 1 - share, other *= share;
    surface[4] = (own * surface[4] + other * to) / (own + other);
    for (uint32_t c = 0; c < 3; c++)
        surface[c] += ((double)d->color[c] - surface[c]) * share + 0.04 * (surface[4] - before);
}

static void compare_decals(const masu_decal *decals, uint32_t count, uint32_t touched[2]) {
    static buffers before, after;
    const masu_frame_desc none = {MASU_FRAME_DESC, .camera = &camera};
    masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .decals = decals,
                             .decal_count = count};
    masu_stats_info stats;
    read_base(&none);
    read_buffers(&none, &before, NULL);
    read_buffers(&frame, &after, &stats);
    assert_int_equal(stats.decals, count);
    double tan_y = tan((double)camera.fov_y / 2);
    touched[0] = touched[1] = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double z = (double)depths[i], share = 0;
        const double at[3] = {((i % SIDE + 0.5) / SIDE * 2 - 1) * tan_y * z,
                              (1 - (i / SIDE + 0.5) / SIDE * 2) * tan_y * z, 6 - z};
        double want[5]; /* colour, roughness, metal */
        for (uint32_t k = 0; k < 3; k++) want[k] = pow(before.albedo[4 * i + k] / 255.0, 2);
        want[3] = before.albedo[4 * i + 3] / 255.0;
        want[4] = (before.normal[i] >> 26 & 15) / 15.0;
        float n[3];
        masu_unpack_normal(before.normal[i], n);
        int limit = 0;
        for (uint32_t k = 0; k < count && z > 0; k++) {
            const masu_decal *d = &decals[k];
            double a = painted(d, at, n);
            limit |= a < 0;
            a *= (double)d->opacity;
            share = fmax(share, a);
            if (!(d->flags & MASU_DECAL_KEEP_COLOR)) cover(d, a, want);
            if (d->roughness > 0) want[3] += ((double)d->roughness - want[3]) * a;
        }
        if (limit) continue;
        int same = !memcmp(&before.albedo[4 * i], &after.albedo[4 * i], 4) &&
                   before.normal[i] == after.normal[i];
        if (share == 0 && !same) fail_msg("pixel %u is outside, and changed", i);
        if (share == 0) continue;
        touched[i % SIDE >= SIDE / 2] += share > 0.1;
        assert_int_equal(before.normal[i] & ~(15u << 26), after.normal[i] & ~(15u << 26));
        double metal = (after.normal[i] >> 26 & 15) / 15.0;
        assert_true(fabs(metal - want[4]) <= 0.51 / 15);
        for (uint32_t c = 0; c < 3; c++)
            want[c] = fmax(0, fmin(1, want[c] + 0.04 * (metal - want[4])));
        for (uint32_t c = 0; c < 4; c++) {
            double is = after.albedo[4 * i + c] / 255.0, ought = c < 3 ? sqrt(want[c]) : want[c];
            if (fabs(is - ought) > 2.6 / 255)
                fail_msg("pixel %u, channel %u: %g, not %g", i, c, is, ought);
        }
    }
}

static void a_decal_paints_polygons_and_the_sdf_alike(void **state) {
    (void)state;
    open_room("test_pane");
    for (uint32_t form = 0; form < 8; form++) {
        masu_decal d = {.rows = {2, 0, 0, 0.1f, 0, 0.5f, 0, 0.15f, 0, 0, 1.5f, 0.2f},
                        .color = {0.8f, 0.1f, 0.3f},
                        .opacity = 1,
                        .roughness = 0.25f,
                        .metallic = 0.6f};
        if (form == 1) d.opacity = 0.5f, d.edge = 0.5f;
        if (form == 2) d.flags = MASU_DECAL_ROUND, d.edge = 0.3f;
        if (form == 3) d.flags = MASU_DECAL_KEEP_COLOR;
        if (form == 4) d.roughness = 0, d.inner = 0.2f, d.outer = 0.9f;
        if (form == 5) d.rows[10] = 8, d.rows[11] = 2; /* through the near plane */
        /* a slice in front of the centres */
        if (form == 6) d.rows[10] = 0.2f, d.rows[11] = 0.6f, d.rows[5] = 2;
        if (form == 7) d.metallic = -1, d.opacity = 0.5f;
        uint32_t touched[2];
        compare_decals(&d, 1, touched);
        print_message("form %u: %u pixels of the SDF, %u of polygons\n", form, touched[0],
                      touched[1]);
        assert_true(touched[0] > 100 && touched[1] > 100);
    }
    /* Small ones, whose last pixels are the first of a workgroup at some positions. */
    uint32_t small = 0;
    for (uint32_t place = 0; place < 8; place++) {
        float by = 0.06f * (float)place;
        masu_decal d = {.rows = {0.5f, 0, 0, 0.6f + by, 0, 0.3f, 0, by - 0.1f, 0, 0, 1.5f, 0.2f},
                        .color = {1, 0, 0},
                        .opacity = 1};
        uint32_t touched[2];
        compare_decals(&d, 1, touched);
        small += touched[0] + touched[1];
    }
    print_message("small ones: %u pixels\n", small);
    assert_true(small > 200);
    close_session(&s);
}

static void later_decals_lie_over_earlier_ones(void **state) {
    (void)state;
    masu_decal d[40];
    uint32_t touched[2];
    open_room("test_pane");
    for (uint32_t i = 0; i < 40; i++) {
        d[i] = (masu_decal){.rows = {0.5f, 0, 0, -2 + 0.1f * (float)i, 0, 0.6f, 0, 0, 0, 0, 2, 0},
                            .color = {i % 2 ? 1 : 0, i % 3 ? 0 : 1, i % 5 ? 0.5f : 0},
                            .opacity = 0.7f};
    }
    compare_decals(d, 40, touched);
    assert_true(touched[0] > 100 && touched[1] > 100);
    close_session(&s);
}

/* sRGB of linear light, 0..255. */
static double display(double x) {
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * pow(fmin(x, 1), 1 / 2.4) - 0.055);
}

/* Towards the centre of soft dark paint on polished metal, the fraction of the bare metal's light
 * only falls: a rise would be a ring. */
static void soft_edges_on_metal_have_no_rings(void **state) {
    (void)state;
    bake_scene(
        "metal_floor",
        "{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 40, \"size_z\": 40}}, \"rotate\": [90, "
        "0, 0], "
        "\"material\": {\"base_color\": [0.7, 0.7, 0.7], \"roughness\": 0.6, \"metallic\": 0.8}}], "
        "\"sun\": {\"azimuth\": 30, \"elevation\": 50, \"intensity\": 2}, \"ambient\": [0.3, 0.35, "
        "0.45]}");
    masu_session_desc d = room_desc(NULL);
    d.scene_path = baked_scene("metal_floor");
    open_session(&s, &d);
    const float colors[] = {0, 0.25f};
    double rings = 0;
    static float bare[4 * PIXELS];
    render((masu_frame_desc){MASU_FRAME_DESC, .camera = &camera}, bare);
    for (uint32_t form = 0; form < 4; form++) {
        const float color = colors[form % 2];
        masu_decal soft = {.rows = {2.2f, 0, 0, 0, 0, 9, 0, 0, 0, 0, 9, 0},
                           .color = {color, color, color},
                           .opacity = 0.7f,
                           .edge = 1,
                           .outer = 3.2f,
                           .inner = 3.1f};
        if (form / 2) soft.metallic = -1;
        render((masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .decals = &soft,
                                 .decal_count = 1},
               picture);
        double least = 1, ring = 0;
        for (uint32_t x = 4; x < SIDE / 2; x++) {
            uint32_t at = 4 * (SIDE * (SIDE / 2) + x) + 1;
            double is = display((double)picture[at]), was = display((double)bare[at]);
            ring = fmax(ring, is - least * was);
            least = fmin(least, is / was);
        }
        print_message("colour %g, %s: rings of %.2f / 255\n", (double)color,
                      form / 2 ? "metal kept" : "no metal", ring);
        rings = fmax(rings, ring);
    }
    close_session(&s);
    assert_true(rings < 1);
}

/* Painted surfaces are lit: the image of a painted ball equals that of a ball with the paint's
 * material. */
static void what_is_painted_is_lit(void **state) {
    (void)state;
    const masu_light dark = {
        .sun_direction = {0, 0, 1}, .ambient = {0, 0, 0}, .sun_color = {1, 1, 1}};
    const masu_decal black = {.rows = {9, 0, 0, 0, 0, 9, 0, 0, 0, 0, 9, 0},
                              .opacity = 1,
                              .roughness = 1,
                              .outer = 3.2f,
                              .inner = 3.1f};
    masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .light = &dark};
    double sum[2] = {0};
    open_room("test_pane");
    for (int there = 0; there < 2; there++) {
        frame.decals = there ? &black : NULL;
        frame.decal_count = (uint32_t)there;
        render(frame, picture);
        for (uint32_t i = 0; i < PIXELS; i++) sum[there] += (double)picture[4 * i];
    }
    assert_true(sum[1] < 0.5 * sum[0]);
    close_session(&s);
}

/* Paint covers emission: on a black wall the covered fraction of its light is removed. */
static void what_is_painted_shines_no_more(void **state) {
    (void)state;
    const masu_light dark = {.sun_direction = {0, 0, 1}};
    bake_scene("shining", "{\"models\": [{\"mesh\": {\"plane\": {\"size_x\": 20, \"size_z\": 20}}, "
                          "\"rotate\": [90, 0, 0], "
                          "\"material\": {\"base_color\": [0, 0, 0], \"roughness\": 0.5, "
                          "\"specular\": 0, \"emissive\": [2, 1, 0.5]}}]}");
    masu_session_desc d = room_desc(NULL);
    d.scene_path = baked_scene("shining");
    open_session(&s, &d);
    for (int half = 0; half < 3; half++) {
        const masu_decal black = {.rows = {1, 0, 0, 0, 0, 9, 0, 0, 0, 0, 9, 0},
                                  .opacity = half ? 0.5f * (float)half : 0.0f,
                                  .roughness = 1,
                                  .outer = 3.2f,
                                  .inner = 3.1f};
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .light = &dark,
                                 .decals = &black, .decal_count = 1};
        render(frame, picture);
        for (uint32_t k = 0; k < 3; k++) {
            double middle = (double)picture[4 * (SIDE / 2 * SIDE + SIDE / 2) + k],
                   edge = (double)picture[4 * (SIDE / 2 * SIDE + 2) + k];
            double shines = 2.0 / (1u << k);
            assert_true(fabs(edge - shines) < 0.001 * shines); /* next to it */
            if (fabs(middle - (1 - 0.5 * half) * shines) > 0.001 * shines)
                fail_msg("half %d, channel %u: %g of %g", half, k, middle, shines);
        }
    }
    close_session(&s);
}

/* ---- Lines ----------------------------------------------------------------------------------- */

/* The point at the centre of an output pixel, at a view depth. */
static void point_at(double px, double py, double z, double out[3]) {
    double t = tan((double)camera.fov_y / 2) * z;
    out[0] = ((px + 0.5) / SIDE * 2 - 1) * t;
    out[1] = (1 - (py + 0.5) / SIDE * 2) * t;
    out[2] = 6 - z;
}

static masu_line line_between(double x0, double y0, double z0, double x1, double y1, double z1,
                              uint32_t flags) {
    masu_line l = {.from_color = {255, 0, 128}, .to_color = {255, 0, 128}, .flags = flags};
    point_at(x0, y0, z0, l.from);
    point_at(x1, y1, z1, l.to);
    return l;
}

static void draw_lines(const masu_line *l, uint32_t count, uint32_t rung) {
    masu_frame_desc none = {MASU_FRAME_DESC, .camera = &camera, .rung = rung, .cut = 1},
                    frame = none;
    masu_commands commands;
    draw(&s, &none, &commands, plain);
    frame.lines = l;
    frame.line_count = count;
    draw(&s, &frame, &commands, shown);
}

static int is_pixel(uint32_t x, uint32_t y, const uint8_t color[3]) {
    return !memcmp(shown + 4 * (y * SIDE + x), color, 3);
}

static uint32_t pixels_of(const uint8_t color[3]) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < PIXELS; i++) n += !memcmp(shown + 4 * i, color, 3);
    return n;
}

static void expect_line(uint32_t rung, uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) {
    static const uint8_t pink[3] = {255, 0, 128};
    masu_line l = line_between(x0, y0, 3, x1, y1, 3, 0);
    draw_lines(&l, 1, rung);
    int dx = (int)x1 - (int)x0, dy = (int)y1 - (int)y0, n = abs(dx) > abs(dy) ? abs(dx) : abs(dy);
    for (uint32_t i = 0; i < PIXELS; i++) {
        int x = (int)(i % SIDE), y = (int)(i / SIDE), steep = abs(dy) > abs(dx);
        int k = n == 0  ? 0
                : steep ? (y - (int)y0) * (dy < 0 ? -1 : 1)
                        : (x - (int)x0) * (dx < 0 ? -1 : 1);
        double off = n == 0 ? abs(x - (int)x0) + abs(y - (int)y0)
                     : steep ? x - (x0 + dx * (double)k / n)
                             : y - (y0 + dy * (double)k / n);
        /* drivers guarantee only 1/16 pixel */
        int on = k >= 0 && k <= n && fabs(off) < 0.42, beside = k < 0 || k > n || fabs(off) > 0.58;
        if (on && !is_pixel((uint32_t)x, (uint32_t)y, pink))
            fail_msg("%d, %d is not of the line", x, y);
        /* Temporal rungs sample off the pixel's centre, at a different position in each frame. */
        int changed = rung == 2 ? is_pixel((uint32_t)x, (uint32_t)y, pink)
                                : memcmp(shown + 4 * i, plain + 4 * i, 4) != 0;
        if (beside && changed) fail_msg("%d, %d is outside the line", x, y);
    }
}

static void a_line_has_its_pixels_and_no_others(void **state) {
    (void)state;
    masu_session_desc d = room_desc("test_pane");
    d.desc.rung_count = 3;
    d.desc.rungs[0] = (masu_rung){.scale = 1};
    d.desc.rungs[1] = (masu_rung){.scale = 0.5f};
    d.desc.rungs[2] = (masu_rung){.scale = 1, .temporal = MASU_ON};
    open_session(&s, &d);
    pane_at(100);
    for (uint32_t rung = 0; rung < 3; rung++) {
        expect_line(rung, 10, 20, 80, 20);
        expect_line(rung, 80, 5, 10, 62);
        expect_line(rung, 30, 90, 31, 3);
        expect_line(rung, 47, 47, 47, 47);
        expect_line(rung, 0, 0, 95, 95);
    }
    close_session(&s);
}

static void lines_are_hidden_cut_and_coloured(void **state) {
    (void)state;
    static const uint8_t pink[3] = {255, 0, 128}, blue[3] = {0, 0, 255}, red[3] = {255, 0, 0};
    open_room("test_pane");
    /* Behind the polygon ball, whose centre is 6 m away; the SDF ball; and on top. */
    for (uint32_t ball = 0; ball < 2; ball++) {
        uint32_t y = SIDE / 2, x0 = ball ? 48 : 2, x1 = ball ? 93 : 47;
        for (uint32_t top = 0; top < 2; top++) {
            masu_line l = line_between(x0, y, 6.5, x1, y, 6.5, top ? MASU_LINE_ON_TOP : 0);
            draw_lines(&l, 1, 0);
            uint32_t n = pixels_of(pink);
            print_message("ball %u, %s: %u pixels\n", ball, top ? "on top" : "behind", n);
            if (top) assert_int_equal(n, x1 - x0 + 1);
            if (!top) assert_true(n > 5 && n < 30);
        }
    }
    /* From behind the camera to far away, through the image's centre: clipped, no artefacts. */
    masu_line l = {.from = {0.3, 0.2, 20},
                   .to = {-0.3, -0.2, 2},
                   .from_color = {255, 0, 128},
                   .to_color = {255, 0, 128}};
    draw_lines(&l, 1, 0);
    uint32_t n = pixels_of(pink);
    assert_true(n > 3 && n < SIDE);
    l = (masu_line){.from = {-1e15, 0.01, 3},
                    .to = {1e15, 0.01, 3},
                    .from_color = {255, 0, 128},
                    .to_color = {255, 0, 128}};
    draw_lines(&l, 1, 0);
    assert_int_equal(pixels_of(pink), SIDE);
    l.from[2] = l.to[2] = 7; /* behind the camera */
    draw_lines(&l, 1, 0);
    assert_memory_equal(shown, plain, sizeof shown);
    /* Each end has its colour; at crossings the later line wins. */
    masu_line two[2] = {line_between(10, 30, 3, 90, 30, 3, 0),
                        line_between(50, 20, 3, 50, 80, 3, 0)};
    memcpy(two[0].from_color, red, 3);
    memcpy(two[0].to_color, blue, 3);
    draw_lines(two, 2, 0);
    const uint8_t *a = shown + 4 * (30 * SIDE + 10), *b = shown + 4 * (30 * SIDE + 90),
                  *m = shown + 4 * (30 * SIDE + 49);
    assert_true(a[0] >= 253 && a[2] <= 2 && b[0] <= 2 && b[2] >= 253 && abs(m[0] - m[2]) < 12);
    assert_true(is_pixel(50, 30, pink));
    close_session(&s);
}

/* ---- Limits, arbitrary numbers, unused capacity ---------------------------------------------- */

static void more_than_was_reserved_is_refused(void **state) {
    (void)state;
    static const masu_particle particles[ROOM + 1];
    static const masu_decal decals[ROOM + 1];
    static const masu_line lines[ROOM + 1];
    masu_commands commands;
    open_room("test_pane");
    for (uint32_t kind = 0; kind < 3; kind++) {
        static const char *const names[] = {"reserve.particles", "reserve.decals", "reserve.lines"};
        for (uint32_t null = 0; null < 2; null++) {
            uint32_t count = null ? 1 : ROOM + 1;
            masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera};
            if (kind == 0) f.particles = null ? NULL : particles, f.particle_count = count;
            if (kind == 1) f.decals = null ? NULL : decals, f.decal_count = count;
            if (kind == 2) f.lines = null ? NULL : lines, f.line_count = count;
            assert_int_equal(masu_frame(s.m, &f, &commands, &failure),
                             null ? MASU_ERROR_ARGUMENT : MASU_ERROR_LIMIT);
            const masu_detail *e = (&failure);
            assert_string_equal(e->what, null ? names[kind] + 8 : names[kind]);
            assert_int_equal(e->needed, count);
            assert_int_equal(e->given, null ? 0 : ROOM);
        }
    }
    /* The failed calls have not advanced the frame's number; as many as the capacity are
     * accepted. */
    masu_frame_desc f = {MASU_FRAME_DESC,        .camera = &camera, .particles = particles,
                         .particle_count = ROOM, .decals = decals,  .decal_count = ROOM,
                         .lines = lines,         .line_count = ROOM};
    draw(&s, &f, &commands, NULL);
    assert_int_equal(commands.frame, 0);
    close_session(&s);
}

/* A float with arbitrary bits, or a plausible one. */
static float any_float(uint64_t *seed) {
    uint32_t kind = random_word(seed) % 8;
    static const float odd[] = {0, -1, 1e-30f, 1e9f, 3e38f, -3e38f};
    return kind == 0   ? float_of_bits(random_word(seed))
           : kind == 1 ? odd[random_word(seed) % 6]
                       : random_float(seed) * 4 - 1;
}

static double any_double(uint64_t *seed) {
    uint32_t kind = random_word(seed) % 8;
    static const double odd[] = {0, 1e300, -1e300, 1e15, 5.9, 1e-300};
    if (kind == 0) return (double)float_of_bits(random_word(seed));
    return kind == 1 ? odd[random_word(seed) % 6] : random_between(seed, -4, 5);
}

static void any_numbers_give_a_finite_picture(void **state) {
    (void)state;
    static masu_particle p[ROOM];
    static masu_decal d[ROOM];
    static masu_line l[ROOM];
    uint64_t seed = 7, drawn[3] = {0};
    open_room("test_pane");
    pane_at(0.5);
    for (uint32_t turn = 0; turn < 60; turn++) {
        for (uint32_t i = 0; i < ROOM; i++) {
            for (uint32_t k = 0; k < 3; k++) {
                p[i].position[k] = any_double(&seed);
                l[i].from[k] = any_double(&seed);
                l[i].to[k] = any_double(&seed);
                p[i].color[k] = any_float(&seed);
                d[i].color[k] = any_float(&seed);
            }
            for (uint32_t k = 0; k < 12; k++) d[i].rows[k] = any_float(&seed);
            p[i].half_width = any_float(&seed), p[i].half_height = any_float(&seed);
            p[i].rotation = any_float(&seed), p[i].opacity = any_float(&seed);
            p[i].edge = any_float(&seed), p[i].soft = any_float(&seed);
            d[i].opacity = any_float(&seed), d[i].roughness = any_float(&seed);
            d[i].metallic = any_float(&seed), d[i].edge = any_float(&seed);
            d[i].inner = any_float(&seed), d[i].outer = any_float(&seed);
            p[i].flags = random_word(&seed), d[i].flags = random_word(&seed),
            l[i].flags = random_word(&seed);
        }
        masu_stats_info stats =
            render((masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .particles = p,
                                     .particle_count = ROOM, .decals = d, .decal_count = ROOM,
                                     .lines = l, .line_count = ROOM},
                   picture);
        for (uint32_t i = 0; i < 4 * PIXELS; i++) assert_true(isfinite(picture[i]));
        drawn[0] += stats.particles, drawn[1] += stats.decals, drawn[2] += stats.lines;
    }
    print_message("drawn: %llu particles, %llu decals, %llu lines\n", (unsigned long long)drawn[0],
                  (unsigned long long)drawn[1], (unsigned long long)drawn[2]);
    for (uint32_t k = 0; k < 3; k++) assert_true(drawn[k] > 100 && drawn[k] < 60 * ROOM);
    close_session(&s);
}

/* One bad number in a good entry: only this entry is skipped. */
static void what_is_no_number_is_left_out(void **state) {
    (void)state;
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    open_room("test_pane");
    draw_lines(NULL, 0, 0);
    for (uint32_t b = 0; b < 3; b++) {
        for (uint32_t field = whole_run() ? 0 : b; field < 12; field += whole_run() ? 1 : 3) {
            masu_particle p = disc;
            float *const fields[] = {&p.half_width, &p.half_height, &p.rotation,
                                     &p.color[0],   &p.color[1],    &p.color[2],
                                     &p.opacity,    &p.edge,        &p.soft};
            if (field < 9) *fields[field] = bad[b];
            if (field >= 9) p.position[field - 9] = (double)bad[b];
            masu_stats_info stats = render(with_particles(&p, 1), picture);
            assert_int_equal(stats.particles, 0);
            assert_memory_equal(shown, plain, sizeof shown);
        }
        masu_decal d = {.rows = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, .opacity = 1};
        for (uint32_t field = whole_run() ? 0 : b; field < 21; field += whole_run() ? 1 : 3) {
            masu_decal x = d;
            float *const fields[] = {&x.color[0], &x.color[1],  &x.color[2],
                                     &x.opacity,  &x.roughness, &x.metallic,
                                     &x.edge,     &x.inner,     &x.outer};
            *(field < 12 ? &x.rows[field] : fields[field - 12]) = bad[b];
            masu_stats_info stats = render((masu_frame_desc){MASU_FRAME_DESC, .camera = &camera,
                                                             .decals = &x, .decal_count = 1},
                                           picture);
            assert_int_equal(stats.decals, 0);
            assert_memory_equal(shown, plain, sizeof shown);
        }
        for (uint32_t field = 0; field < 6; field++) {
            masu_line x = line_between(10, 10, 3, 80, 80, 3, 0);
            (field < 3 ? x.from : x.to)[field % 3] = (double)bad[b];
            masu_stats_info stats = render(
                (masu_frame_desc){MASU_FRAME_DESC, .camera = &camera, .lines = &x, .line_count = 1},
                picture);
            assert_int_equal(stats.lines, 0);
            assert_memory_equal(shown, plain, sizeof shown);
        }
    }
    close_session(&s);
}

/* With unused capacity the image is the same as without, and memory is as requested. */
static void room_alone_changes_nothing(void **state) {
    (void)state;
    static uint8_t without[4 * PIXELS];
    uint64_t device[2];
    for (int room = 0; room < 2; room++) {
        masu_session_desc d = room_desc("test_pane");
        if (!room) d.desc.reserve = (masu_reserve){0};
        d.desc.frames_in_flight = 2;
        open_session(&s, &d);
        pane_at(0.5);
        masu_plan_info plan;
        masu_plan_of(s.m, &plan);
        static const char *const names[] = {"particles", "decals", "lines", "lines_show"};
        for (uint32_t k = 0; k < 4; k++)
            assert_int_equal(pass_of(&plan, names[k])->active, (uint32_t)room);
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera};
        masu_commands commands;
        draw(&s, &frame, &commands, room ? shown : without);
        /* The buffer has the size of its three kinds: the report lists it, and without capacity
         * there is none. */
        masu_memory_row rows[MEMORY_ROWS];
        uint32_t count = memory_rows(s.m, rows), found = 0;
        for (uint32_t i = 0; i < count && i < 200; i++) {
            if (strcmp(rows[i].name, "particles, lines, decals")) continue;
            found++;
            uint64_t slot = 16 * (3 + 2) + ROOM * (64 + 32 + 112);
            assert_int_equal(rows[i].count, 3 * ROOM);
            assert_in_range(rows[i].bytes, 2 * slot, 2 * slot + 1024);
        }
        assert_int_equal(found, (uint32_t)room);
        masu_memory need;
        masu_desc own = s.desc;
        own.scene = &s.scene;
        assert_int_equal(masu_memory_query(&own, &need, NULL), MASU_OK);
        masu_peak_info peaks;
        masu_peaks(s.m, &peaks);
        assert_int_equal(peaks.host_bytes, need.host_bytes);
        assert_int_equal(peaks.device_bytes, need.device_bytes);
        device[room] = need.device_bytes;
        close_session(&s);
    }
    assert_memory_equal(shown, without, sizeof shown);
    assert_true(device[1] > device[0]);
}

/* ---- Frames ---------------------------------------------------------------------------------- */

/* Slots alternate: content of one frame does not appear in the next. */
static void each_frame_has_its_own(void **state) {
    (void)state;
    static uint8_t first[4 * PIXELS];
    const masu_decal d = {.rows = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0}, .opacity = 1};
    const masu_line l = line_between(10, 10, 3, 80, 80, 3, 0);
    const masu_frame_desc none = {MASU_FRAME_DESC, .camera = &camera};
    const masu_frame_desc all = {MASU_FRAME_DESC,     .camera = &camera, .particles = &disc,
                                 .particle_count = 1, .decals = &d,      .decal_count = 1,
                                 .lines = &l,         .line_count = 1};
    masu_commands commands;
    masu_session_desc desc = room_desc("test_pane");
    desc.desc.frames_in_flight = 3;
    open_session(&s, &desc);
    pane_at(100);
    draw(&s, &none, &commands, plain);
    draw(&s, &all, &commands, first);
    assert_true(max_difference(first, plain, sizeof first) > 50);
    for (uint32_t i = 0; i < 7; i++) {
        draw(&s, i % 2 ? &all : &none, &commands, shown);
        assert_memory_equal(shown, i % 2 ? first : plain, sizeof shown);
    }
    close_session(&s);
}

/* No edge within two pixels: next to one, samples missing from the jitter are missing for
 * longer. */
static int is_flat(const uint8_t *p, uint32_t x, uint32_t y) {
    if (x < 2 || y < 2 || x + 2 >= SIDE || y + 2 >= SIDE) return 0;
    for (uint32_t i = 0; i < 25; i++) {
        const uint8_t *q = p + 4 * ((y + i / 5 - 2) * SIDE + x + i % 5 - 2);
        for (uint32_t k = 0; k < 3; k++) {
            if (abs(q[k] - p[4 * (y * SIDE + x) + k]) > 16) return 0;
        }
    }
    return 1;
}

static int is_off(const uint8_t *a, const uint8_t *b, int most) {
    return abs(a[0] - b[0]) > most || abs(a[1] - b[1]) > most || abs(a[2] - b[2]) > most;
}

/* Particles and decals that end, or move while their number is constant, leave no trail in a
 * history: AFTER frames later, at most a hundredth of the covered pixels differ by more than 3 of
 * 255 from an image without them. */
static void no_trail_stays(void **state) {
    (void)state;
    enum { AFTER = 16, WARM = 40 };
    static uint8_t never[WARM + AFTER][4 * PIXELS], covered[PIXELS];
    masu_particle smoke = disc;
    smoke.edge = 0.2f;
    const masu_decal d = {
        .rows = {2, 0, 0, 0, 0, 0.4f, 0, 0, 0, 0, 2, 0}, .color = {1, 0, 0}, .opacity = 1};
    masu_particle smoke_away = smoke;
    masu_decal d_away = d;
    smoke_away.position[1] = 1000;
    d_away.rows[7] = 1000;
    masu_session_desc desc = room_desc("test_pane");
    desc.desc.rungs[0] = (masu_rung){.scale = 0.75f, .temporal = MASU_ON};
    masu_commands commands;
    /* on other drivers those that end, not those that move away */
    for (uint32_t kind = 0; kind < trials(5, 5, 3); kind++) {
        open_session(&s, &desc);
        pane_at(100);
        uint32_t seen = 0, gone = AFTER;
        for (uint32_t i = 0; i < WARM + AFTER; i++) {
            masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .time_step = 1.0f / 60};
            f.particles = i < WARM ? &smoke : &smoke_away;
            f.decals = i < WARM ? &d : &d_away;
            f.particle_count = kind == 3 || (kind == 1 && i < WARM);
            f.decal_count = kind == 4 || (kind == 2 && i < WARM);
            draw(&s, &f, &commands, kind ? shown : never[i]);
            if (!kind || i + 1 < WARM) continue;
            uint32_t left = 0;
            for (uint32_t p = 0; p < PIXELS; p++) {
                int off = is_off(shown + 4 * p, never[i] + 4 * p, i < WARM ? 8 : 3);
                if (i < WARM) seen += covered[p] = off && is_flat(never[i], p % SIDE, p / SIDE);
                left += i >= WARM && covered[p] && off;
            }
            if (i >= WARM && left * 100 <= seen && gone == AFTER) gone = i - WARM;
            if (i >= WARM && left * 100 > seen) gone = AFTER;
        }
        close_session(&s);
        if (!kind) continue;
        print_message("%s: %u pixels, clear after %u frames\n",
                      kind % 2 ? "particle" : "decal", seen, gone);
        assert_true(seen > 150 && gone <= 4);
    }
}

static uint8_t other[4 * PIXELS];

static void run_own(own_renderer *x, masu_frame_desc frame, uint8_t *out) {
    char error[ERROR_SIZE];
    masu_commands commands;
    assert_int_equal(masu_frame(x->m, &frame, &commands, &failure), MASU_OK);
    assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
    assert_ok(masu_headless_target_read(&s.host, &x->target, error, sizeof error));
    memcpy(out, x->target.mapped, (size_t)x->target.width * x->target.height * 4);
}

/* A viewport and a resized renderer give the image of a renderer of that size. */
static void viewports_and_sizes_are_right(void **state) {
    (void)state;
    enum { W = 61, H = 43 };
    const masu_decal d = {
        .rows = {0.3f, 0, 0, 1.5f, 0, 0.4f, 0, 0, 0, 0, 2, 0}, .color = {1, 0, 0}, .opacity = 1};
    const masu_line l = {.from = {-2, -1, 1},
                         .to = {2, 1, 1},
                         .from_color = {255, 255, 0},
                         .to_color = {0, 255, 255}};
    masu_frame_desc frame = {MASU_FRAME_DESC,    .camera = &camera,   .cut = 1,
                             .particles = &disc, .particle_count = 1, .decals = &d,
                             .decal_count = 1,   .lines = &l,         .line_count = 1};
    masu_session_desc session = room_desc("test_pane");
    session.no_renderer = true;
    open_session(&s, &session);
    masu_desc own = s.desc;
    own.scene = &s.scene;
    own.readback = 0;
    own.rungs[0] = (masu_rung){.scale = 0.7f};
    own.output = (VkExtent2D){W, H};
    own_renderer fresh, whole, parts;
    make_own(&s, &fresh, &own);
    run_own(&fresh, frame, plain);
    frame.particle_count = frame.decal_count = frame.line_count = 0;
    run_own(&fresh, frame, other);
    assert_true(max_difference(plain, other, W * H * 4) > 50); /* the image has content */
    frame.particle_count = frame.decal_count = frame.line_count = 1;
    unmake_own(&s, &fresh);

    own.output = (VkExtent2D){SIDE, SIDE};
    own.resizable = 1;
    make_own(&s, &whole, &own);
    masu_headless_target_destroy(&s.host, &whole.target);
    make_target(&s, &whole, W, H, 1);
    masu_targets t = {
        .images = &whole.target.image, .views = &whole.target.view, .count = 1, .storage = 1};
    masu_detail detail;
    if (masu_resize(whole.m, (VkExtent2D){W, H}, &t, NULL, &detail)) fail_msg("%s", detail.text);
    run_own(&whole, frame, shown);
    assert_memory_equal(shown, plain, W * H * 4);
    unmake_own(&s, &whole);

    own.resizable = 0;
    own.targets.storage = 0;
    own.dither = MASU_OFF;
    own.viewport_count = 2;
    own.viewports[0] = (masu_viewport){0, 0, SIDE, SIDE};
    own.viewports[1] = (masu_viewport){20, 30, W, H};
    make_own(&s, &parts, &own);
    run_own(&parts, (masu_frame_desc){MASU_FRAME_DESC, .camera = &camera}, other);
    frame.viewport = 1;
    run_own(&parts, frame, shown);
    for (uint32_t y = 0; y < SIDE; y++) {
        for (uint32_t x = 0; x < SIDE; x++) {
            int in = x >= 20 && x < 20 + W && y >= 30 && y < 30 + H;
            const uint8_t *want =
                in ? plain + 4 * ((y - 30) * W + x - 20) : other + 4 * (y * SIDE + x);
            for (uint32_t k = 0; k < 3; k++) {
                int off = abs(want[k] - shown[4 * (y * SIDE + x) + k]);
                if (off > 0) fail_msg("%u, %u has an error of %d", x, y, off);
            }
        }
    }
    unmake_own(&s, &parts);
    close_session(&s);
}

/* Targets of floats and of nits, and a dithered one: the requested colour, in each encoding. */
static void lines_have_their_colour_in_every_encoding(void **state) {
    (void)state;
    masu_line l = line_between(10, 20, 3, 80, 20, 3, MASU_LINE_ON_TOP);
    l.from_color[2] = l.to_color[2] = 188;
    double linear[3] = {1, 0, pow((188 / 255.0 + 0.055) / 1.055, 2.4)};
    for (int form = 0; form < 4; form++) {
        masu_session_desc d = room_desc("test_pane");
        d.desc.targets.storage = form == 1;
        if (form == 1 || form == 2) d.desc.targets.format = VK_FORMAT_R16G16B16A16_SFLOAT;
        if (form == 3)
            d.desc.targets.format = VK_FORMAT_A2B10G10R10_UNORM_PACK32,
            d.desc.targets.encoding = MASU_ENCODING_PQ;
        d.desc.targets.white = 160; /* in floats 1 is 80 */
        open_session(&s, &d);
        pane_at(100);
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &camera, .lines = &l, .line_count = 1};
        masu_commands commands;
        char error[ERROR_SIZE];
        draw(&s, &frame, &commands, NULL);
        assert_ok(masu_headless_target_read(&s.host, &s.targets[0], error, sizeof error));
        const uint8_t *at = (const uint8_t *)s.targets[0].mapped +
                            (form == 0 || form == 3 ? 4 : 8) * (20 * SIDE + 40);
        double got[3], want[3];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t word;
            uint16_t half;
            memcpy(&word, at, 4);
            memcpy(&half, at + 2 * k, 2);
            got[k] = form == 0   ? at[k]
                     : form == 3 ? (word >> 10 * k & 1023) / 1023.0
                                 : half_float(half);
            want[k] = form == 0 ? l.from_color[k] : 2 * linear[k];
        }
        if (form == 3) { /* BT.2020, nits, ST 2084 */
            const double rows[3][3] = {
                {0.6274, 0.3293, 0.0433}, {0.0691, 0.9195, 0.0114}, {0.0164, 0.0880, 0.8956}};
            for (uint32_t k = 0; k < 3; k++) {
                double nits = 0;
                for (uint32_t j = 0; j < 3; j++) nits += rows[k][j] * linear[j] * 160;
                double y = pow(nits / 1e4, 0.1593017578125);
                want[k] = pow((0.8359375 + 18.8515625 * y) / (1 + 18.6875 * y), 78.84375);
            }
        }
        for (uint32_t k = 0; k < 3; k++) {
            if (fabs(got[k] - want[k]) > (form ? 0.004 : 0))
                fail_msg("form %d, channel %u: %g, not %g", form, k, got[k], want[k]);
        }
        close_session(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_is_blended_in_linear_light),
        cmocka_unit_test(particles_and_transparents_are_sorted_as_one),
        cmocka_unit_test(a_lit_particle_has_sun_shadow_and_ambient_light),
        cmocka_unit_test(fog_lies_over_particles),
        cmocka_unit_test(a_decal_paints_polygons_and_the_sdf_alike),
        cmocka_unit_test(later_decals_lie_over_earlier_ones),
        cmocka_unit_test(soft_edges_on_metal_have_no_rings),
        cmocka_unit_test(what_is_painted_is_lit),
        cmocka_unit_test(what_is_painted_shines_no_more),
        cmocka_unit_test(a_line_has_its_pixels_and_no_others),
        cmocka_unit_test(lines_are_hidden_cut_and_coloured),
        cmocka_unit_test(lines_have_their_colour_in_every_encoding),
        cmocka_unit_test(more_than_was_reserved_is_refused),
        cmocka_unit_test(any_numbers_give_a_finite_picture),
        cmocka_unit_test(what_is_no_number_is_left_out),
        cmocka_unit_test(room_alone_changes_nothing),
        cmocka_unit_test(each_frame_has_its_own),
        cmocka_unit_test(no_trail_stays),
        cmocka_unit_test(viewports_and_sizes_are_right),
    };
    return cmocka_run_group_tests_name("sprites", tests, make_scratch, remove_scratch);
}

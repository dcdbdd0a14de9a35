/* test_gltf_pictures.c: rendered glTF files, each with one feature of glTF. The expected image
 * follows from how a file was made: parallelograms in world space, intersected and shaded here ray
 * by ray in double precision (measure/shade.h), independent of the baked geometry and materials.
 *
 * The lit image before exposure is compared. Pixels near an edge, with a neighbourhood on two
 * faces, are skipped. */
#include "support/support.h"
#include "support/floats.h"
#include "support/gltf_file.h"
#include "reference/brdf.h"
#include "split_sum.h"

#include "measure/shade.h"
#include "image.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>

enum { SIDE = 66, FACES = 8 };

/* ---- Expected images ------------------------------------------------------------------------- */

typedef struct face {
    double at[3], u[3], v[3]; /* a corner, and the two edges from it */
    double look[8];           /* albedo, roughness, emissive, metallic */
    bool single;              /* invisible from behind, the side away from u x v */
    const brdf_surface *coat; /* replaces look; normals of coat and base, relative to the face's (0,
                                 0, 1) */
    double over[3], below[3];
    bool leans;               /* normal = over, flipped towards the camera, limited at grazing
                                 angles */
    bool glass;               /* fully transmitting: the faces behind, times the colour of look */
} face;

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* The nearest face along a ray, or -1; its normal, towards the camera. */
static int face_at(const face *faces, int count, const double eye[3], const double direction[3], double normal[3]) {
    double nearest = 1e30;
    int found = -1;
    for (int i = 0; i < count; i++) {
        const face *f = &faces[i];
        double n[3], from[3], on[3], across[3];
        cross(f->u, f->v, n);
        double facing = dot(n, direction), area = dot(n, n);
        if (fabs(facing) < 1e-12 || (f->single && facing > 0)) continue;
        for (int k = 0; k < 3; k++) from[k] = f->at[k] - eye[k];
        double t = dot(from, n) / facing;
        for (int k = 0; k < 3; k++) on[k] = eye[k] + t * direction[k] - f->at[k];
        cross(on, f->v, across);
        double u = dot(across, n) / area;
        cross(f->u, on, across);
        double v = dot(across, n) / area;
        if (!(t > 0 && t < nearest && u >= 0 && u <= 1 && v >= 0 && v <= 1)) continue;
        nearest = t;
        found = i;
        for (int k = 0; k < 3; k++) normal[k] = (facing > 0 ? -n[k] : n[k]) / sqrt(area);
    }
    return found;
}

/* ---- Rendered images ------------------------------------------------------------------------- */

typedef struct shot {
    double from[3], to[3];
} shot;

static const shot ahead = {{1, 0.5, 3}, {1, 0.5, 0}};
/* the sun is reflected in the centre */
static const shot in_the_glare = {{-0.23, -1.22, 2.13}, {1, 0.5, 0}};
static const shot behind = {{1, 0.5, -3}, {1, 0.5, 0}};

static bool few_attachments; /* as on a device with four colour attachments */

static const uint16_t *photograph(masu_session *s, const char *path, shot p, masu_view *view) {
    static unsigned made;
    char json[1024], name[32], error[ERROR_SIZE];
    masu_scene scene;
    masu_detail detail;
    masu_camera camera;
    uint8_t *blob = NULL;
    size_t bytes = 0;
    snprintf(name, sizeof name, "picture%u", made++);
    path = strrchr(path, '/') + 1;
    snprintf(json, sizeof json,
             "{\"models\": [{\"file\": \"%s\"}], \"camera\": {\"fov_y\": 50, \"near\": 0.05, \"keys\": [{\"position\": [%g, %g, %g], "
             "\"target\": [%g, %g, %g]}]}, \"sun\": {\"azimuth\": 30, \"elevation\": 35, \"intensity\": 1.5}, "
             "\"ambient\": [0.3, 0.35, 0.45], \"sky\": {\"zenith\": [0.25, 0.4, 0.8], \"horizon\": [0.7, 0.75, 0.85]}}",
             path, p.from[0], p.from[1], p.from[2], p.to[0], p.to[1], p.to[2]);
    bake_scene(name, json);
    masu_session_desc d = test_desc(NULL, SIDE, SIDE);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.picking = 1;
    d.desc.rung_count = 1;
    if (few_attachments)
        d.desc.readback |= MASU_READBACK_VELOCITY, d.desc.deny.color_attachments = 4;
    open_session(s, &d);
    assert_ok(masu_file_read(baked_scene(name), 1u << 30, &blob, &bytes, error, sizeof error));
    assert_int_equal(masu_scene_bind(blob, bytes, &scene, &detail), MASU_OK);
    assert_int_equal(masu_camera_at(s->m, 0, &camera, NULL), MASU_OK);
    assert_ok(masu_view_seen(&scene, &camera, SIDE, SIDE, view, error, sizeof error));
    free(blob);
    masu_frame_desc frame = {0};
    return draw_image(s, &frame, MASU_READBACK_HDR, NULL);
}

/* Light of a coated surface by the formulas; `toward` the camera, both normals unit. */
static void shade_coated(const masu_view *v, const double direction[3], const face *f, double out[3]) {
    double axes[3][3] = {{0, 0, 0}, {0, 0, 0}, {f->below[0], f->below[1], f->below[2]}}, size;
    const double aside[3] = {f->below[2], 0, -f->below[0]};
    double eye[3] = {0, 0, 0}, sun[3] = {0, 0, 0}, over[3] = {0, 0, 0}, sky[2][3], way[3], diffuse[3], mirrors[3], coat;
    size = sqrt(dot(aside, aside));
    for (int k = 0; k < 3; k++) axes[0][k] = aside[k] / size;
    cross(axes[2], axes[0], axes[1]);
    for (int k = 0; k < 3; k++) {
        eye[k] = -dot(axes[k], direction);
        sun[k] = dot(axes[k], v->sun_direction);
        over[k] = dot(axes[k], f->over);
    }
    for (int i = 0; i < 2; i++) { /* blurred by roughness, which is the weight of the ambient
                                     light */
        const double *n = i ? f->over : f->below;
        double rough = i ? f->coat->coat_roughness : f->coat->roughness;
        for (int k = 0; k < 3; k++) way[k] = direction[k] - 2 * dot(n, direction) * n[k];
        masu_shade_open_sky(v, way, sky[i]);
        for (int k = 0; k < 3; k++) sky[i][k] += (v->ambient[k] - sky[i][k]) * rough;
    }
    brdf_over(masu_split_sum, f->coat, over, eye, sun, out);
    brdf_ambient(masu_split_sum, f->coat, over, eye, diffuse, mirrors, &coat);
    for (int k = 0; k < 3; k++)
        out[k] = out[k] * v->sun_color[k] + diffuse[k] * v->ambient[k] + mirrors[k] * sky[0][k] + coat * sky[1][k];
}

/* The reflection of colourless glass, plus its transmission of `behind`. */
static void shade_glass(const masu_view *v, const double direction[3], const double n[3], const face *f, double out[3]) {
    face own = *f;
    const brdf_surface black = {.roughness = f->look[3], .specular = 0.5};
    double diffuse[3], mirrors[3], coat, up = -dot(n, direction);
    const double eye[3] = {sqrt(fmax(1 - up * up, 0)), 0, up}, upright[3] = {0, 0, 1};
    own.coat = &black;
    for (int k = 0; k < 3; k++) own.over[k] = own.below[k] = n[k];
    brdf_ambient(masu_split_sum, &black, upright, eye, diffuse, mirrors, &coat);
    double behind[3] = {out[0], out[1], out[2]};
    shade_coated(v, direction, &own, out);
    for (int k = 0; k < 3; k++) /* no diffuse light from a fully transmitting surface */
        out[k] += f->look[k] * (1 - mirrors[0]) * behind[k] - diffuse[k] * v->ambient[k];
}

/* Compares every pixel with the faces, each of which must be visible. loose: tolerance for
 * rounding. */
static void compare(const char *path, shot p, const face *faces, int count, double loose) {
    masu_session s;
    masu_view v;
    const uint16_t *hdr = photograph(&s, path, p, &v);
    uint32_t pixels[FACES + 1] = {0}, wrong = 0;
    char first[256] = "";
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        double want[3], normal[3], ignored[3];
        masu_view_ray ray = masu_view_ray_at(&v, i % SIDE, i / SIDE);
        int at = face_at(faces, count, v.eye, ray.direction, normal);
        bool rim = false;
        for (int k = 0; k < 4; k++) {
            double d[3], x = (k & 1 ? 1 : -1) * 5.0 / SIDE, y = (k & 2 ? 1 : -1) * 5.0 / SIDE;
            for (int c = 0; c < 3; c++) d[c] = ray.direction[c] * ray.z_scale + x * v.right[c] + y * v.up[c];
            rim = rim || face_at(faces, count, v.eye, d, ignored) != at;
        }
        if (rim) continue;
        if (at < 0) {
            masu_shade_sky(&v, ray.direction, want);
        } else if (faces[at].glass) { /* the first face hit; behind it is the second */
            masu_shade_surface(&v, ray.direction, normal, faces[at + 1].look, want);
            shade_glass(&v, ray.direction, normal, &faces[at], want);
        } else if (faces[at].leans) {
            const double *n = faces[at].over, away = fmax(dot(n, ray.direction), 0);
            double size = 0;
            for (int k = 0; k < 3; k++) normal[k] = n[k] - away * ray.direction[k];
            size = sqrt(dot(normal, normal));
            for (int k = 0; k < 3; k++) normal[k] /= size;
            masu_shade_surface(&v, ray.direction, normal, faces[at].look, want);
        } else if (faces[at].coat) {
            shade_coated(&v, ray.direction, &faces[at], want);
        } else if (loose > 0) {
            masu_shade_exact(&v, ray.direction, normal, faces[at].look, want, ignored);
            for (int c = 0; c < 3; c++) want[c] += ignored[c];
        } else {
            masu_shade_surface(&v, ray.direction, normal, faces[at].look, want);
        }
        pixels[at + 1]++;
        for (int c = 0; c < 3; c++) {
            double got = half_float(hdr[4 * i + (uint32_t)c]);
            if (fabs(got - want[c]) <= 0.004 + (0.006 + loose) * want[c]) continue;
            if (!wrong++)
                snprintf(first, sizeof first, "pixel %u, %u, face %d, channel %d: %g, not %g", i % SIDE, i / SIDE, at, c, got, want[c]);
        }
    }
    close_session(&s);
    if (wrong) fail_msg("%u values are wrong: %s", wrong, first);
    for (int k = 0; k <= count; k++) {
        if (k && faces[k - 1].single && pixels[k] == 0) continue;
        if (pixels[k] < 12) fail_msg("face %d: %u pixels", k - 1, pixels[k]);
    }
}

/* A rectangle in a plane of constant z. */
static face flat(double x, double y, double z, double width, double height, double red, double green, double blue, double roughness) {
    return (face){.at = {x, y, z}, .u = {width, 0, 0}, .v = {0, height, 0}, .look = {red, green, blue, roughness}};
}

static const char *quad_of(const char *material) {
    char rest[1024];
    begin_quad();
    snprintf(rest, sizeof rest, ",\"materials\":[{%s}]", material);
    return finish_quad("", ",\"material\":0", rest);
}

#define CLAY "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.4,0.3,1],\"metallicFactor\":0,\"roughnessFactor\":0.75}"

/* ---- Emission -------------------------------------------------------------------------------- */

static void emission_is_added(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.4, 0.3, 0.75);
    for (int c = 0; c < 3; c++) f.look[4 + c] = 0.06;
    const char *weak = CLAY ",\"emissiveFactor\":[0.06,0.06,0.06]";
    compare(quad_of(weak), ahead, &f, 1, 0);
    compare(quad_of(weak), ahead, &f, 1, 0.001); /* the base colour is as exact as without */
    const char *strong = CLAY ",\"emissiveFactor\":[1,0.5,0.025],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4}}";
    f.look[4] = 4, f.look[5] = 2, f.look[6] = 0.1;
    compare(quad_of(strong), ahead, &f, 1, 0);
    compare(quad_of(strong), ahead, &f, 1, 0.001);
    const char *bright = CLAY
        ",\"emissiveFactor\":[1,0.5,0.025],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4000}}";
    f.look[4] = 4000, f.look[5] = 2000, f.look[6] = 100;
    compare(quad_of(bright), ahead, &f, 1, 0.001);
}

/* With too few attachments emission shares the albedo texel, and both are rounded. */
static void emission_needs_no_fifth_attachment(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.4, 0.3, 0.75);
    f.look[4] = 4, f.look[5] = 2, f.look[6] = 0.1;
    few_attachments = true;
    compare(
        quad_of(
            CLAY
            ",\"emissiveFactor\":[1,0.5,0.025],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":4},"
            "\"KHR_materials_specular\":{\"specularFactor\":0.99}}"),
        ahead, &f, 1, 0.08);
    few_attachments = false;
}

/* A lamp behind black glass: the glass still reflects. And black chalk, which only emits. */
static void what_is_black_and_emits_still_mirrors(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 0, 0, 0, 0.25);
    f.look[4] = 0.5, f.look[5] = 0.25, f.look[6] = 0.02;
    const char *format = "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1],\"metallicFactor\":0,\"roughnessFactor\":%s},"
                         "\"emissiveFactor\":[0.5,0.25,0.02]";
    char about[512];
    snprintf(about, sizeof about, format, "0.25");
    compare(quad_of(about), ahead, &f, 1, 0);
    snprintf(about, sizeof about, format, "1");
    f.look[3] = 1;
    compare(quad_of(about), ahead, &f, 1, 0);
}

static void what_is_unlit_sends_its_colour(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 0, 0, 0, 1);
    f.look[4] = 0.5, f.look[5] = 0.4, f.look[6] = 0.3;
    compare(quad_of(CLAY ",\"extensions\":{\"KHR_materials_unlit\":{}}"), ahead, &f, 1, 0);
}

/* Four squares of one texture: sRGB bytes. */
static void write_squares(const char *name, const uint8_t colors[4][3]) {
    static uint8_t rgba[64 * 64 * 4];
    char error[ERROR_SIZE];
    for (int i = 0; i < 64 * 64; i++) {
        const uint8_t *c = colors[(i % 64 >= 32) + 2 * (i / 64 >= 32)];
        for (int k = 0; k < 3; k++) rgba[4 * i + k] = c[k];
        rgba[4 * i + 3] = 255;
    }
    assert_ok(masu_image_save_png(in_scratch(name), rgba, 64, 64, 0, error, sizeof error));
}

/* Two sets of coordinates: the first is constant. */
static const char *mapped(const char *picture, const char *about) {
    static const float first[8] = {9, 9, 9, 9, 9, 9, 9, 9}, second[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    char attributes[128], rest[1024];
    begin_quad();
    int a = floats(first, "VEC2", 4, 2), b = floats(second, "VEC2", 4, 2);
    snprintf(attributes, sizeof attributes, ",\"TEXCOORD_0\":%d,\"TEXCOORD_1\":%d", a, b);
    snprintf(rest, sizeof rest, ",\"images\":[{\"uri\":\"%s\"}],\"textures\":[{\"source\":0}],\"materials\":[{%s}]", picture, about);
    return finish_quad(attributes, ",\"material\":0", rest);
}

static double linear(int byte) { return byte <= 10 ? byte / 255.0 / 12.92 : pow((byte / 255.0 + 0.055) / 1.055, 2.4); }

/* The quad in four parts, in the order of the squares in the image. */
static void quarter(face *f) {
    for (int i = 0; i < 4; i++) f[i] = flat(i & 1, i & 2 ? 0 : 0.5, 0, 1, 0.5, 0.5, 0.4, 0.3, 0.75);
}

/* Weak emission, some less than a fifth, must not be rounded to black. */
static void weak_maps_of_emission_shine(void **state) {
    (void)state;
    static const uint8_t colors[4][3] = {{0, 0, 0}, {100, 100, 100}, {60, 60, 60}, {255, 255, 255}};
    face f[4];
    write_squares("glow.png", colors);
    quarter(f);
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) f[i].look[4 + c] = linear(colors[i][c]);
    compare(mapped("glow.png", CLAY
                   ",\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":0,\"texCoord\":1}"),
            ahead, f, 4, 0.001);
}

/* ---- Coats and glass ------------------------------------------------------------------------- */

#define COATED "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.4,0.3,1],\"metallicFactor\":0,\"roughnessFactor\":0.5}"
#define COAT(more) ",\"extensions\":{\"KHR_materials_clearcoat\":{\"clearcoatFactor\":1,\"clearcoatRoughnessFactor\":0.4" more "}}"
static const brdf_surface lacquered = {{0.5, 0.4, 0.3}, 0.5, 0, 0.5, 1, 0.4};

/* A normal map with one normal, 30 degrees to the right. */
static void a_coat_is_smooth_unless_it_names_a_picture(void **state) {
    (void)state;
    static const uint8_t leaning[4][3] = {{192, 128, 238}, {192, 128, 238}, {192, 128, 238}, {192, 128, 238}};
    const double even[3] = {0, 0, 1}, right[3] = {64 / 127.0, 0, sqrt(1 - 64 / 127.0 * 64 / 127.0)};
    face f = flat(0, 0, 0, 2, 1, 0, 0, 0, 0);
    write_squares("leaning.png", leaning);
    f.coat = &lacquered;
    memcpy(f.over, even, sizeof even), memcpy(f.below, right, sizeof right);
    compare(mapped("leaning.png", COATED ",\"normalTexture\":{\"index\":0,\"texCoord\":1}" COAT("")), ahead, &f, 1, 0.01);
    compare(mapped("leaning.png", COATED ",\"normalTexture\":{\"index\":0,\"texCoord\":1}" COAT("")), in_the_glare, &f, 1, 0.01);
    memcpy(f.over, right, sizeof right);
    compare(mapped("leaning.png", COATED ",\"normalTexture\":{\"index\":0,\"texCoord\":1}"
                                         COAT(",\"clearcoatNormalTexture\":{\"index\":0,\"texCoord\":1}")), ahead, &f, 1, 0.01);
    memcpy(f.below, even, sizeof even);
    compare(mapped("leaning.png", COATED COAT(",\"clearcoatNormalTexture\":{\"index\":0,\"texCoord\":1}")), ahead, &f, 1, 0.01);
}

/* The grain's direction is kept to 1/128 of half a turn: each of these steps moves the light. */
static void grain_turns_by_its_smallest_step(void **state) {
    (void)state;
    enum { STEPS = 4, HALVES = 4 * SIDE * SIDE };
    static uint16_t seen[STEPS][HALVES];
    static const uint8_t white[4][3] = {{255, 255, 255}, {255, 255, 255}, {255, 255, 255}, {255, 255, 255}};
    write_squares("white.png", white);
    for (int i = 0; i < STEPS; i++) {
        char material[512];
        masu_session s;
        masu_view view;
        snprintf(material, sizeof material,
                 "\"pbrMetallicRoughness\":{\"metallicFactor\":1,\"roughnessFactor\":0.4,"
                 "\"baseColorTexture\":{\"index\":0,\"texCoord\":1}},"
                 "\"extensions\":{\"KHR_materials_anisotropy\":{\"anisotropyStrength\":1,"
                 "\"anisotropyRotation\":%.9g}}",
                 (40 + i) * 3.14159265358979 / 128);
        memcpy(seen[i], photograph(&s, mapped("white.png", material), in_the_glare, &view), sizeof seen[i]);
        close_session(&s);
        int changed = 0;
        for (int k = 0; i && k < HALVES; k++) changed += seen[i][k] != seen[i - 1][k];
        assert_true(!i || changed > SIDE * SIDE / 8);
    }
}

static void coats_have_maps(void **state) {
    (void)state;
    static const uint8_t squares[4][3] = {{255, 255, 9}, {0, 255, 9}, {204, 128, 9}, {102, 255, 9}};
    brdf_surface each[4];
    face f[4];
    write_squares("coats.png", squares);
    quarter(f);
    for (int i = 0; i < 4; i++) {
        each[i] = lacquered;
        each[i].coat = squares[i][0] / 255.0;
        /* as rounded in the G-buffer */
        each[i].coat_roughness = rint(0.4 * 15 * squares[i][1] / 255.0) / 15;
        f[i].coat = &each[i];
        f[i].over[2] = f[i].below[2] = 1;
    }
    compare(mapped("coats.png", COATED COAT(",\"clearcoatTexture\":{\"index\":0,\"texCoord\":1},"
                                            "\"clearcoatRoughnessTexture\":{\"index\":0,\"texCoord\":1}")), in_the_glare, f, 4, 0.01);
}

/* A pane before a wall that emits three colours. */
static void glass_colours_what_is_behind(void **state) {
    (void)state;
    face f[2] = {flat(0, 0, 0, 2, 1, 0.8, 0.3, 0.1, 0.05), flat(-0.5, -0.5, -1, 3, 2, 0, 0, 0, 1)};
    const double wall[3] = {0.25, 0.5, 1};
    memcpy(f[1].look + 4, wall, sizeof wall);
    f[0].glass = true;
    begin_quad();
    compare(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"material\":0}]},"
                   "{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"material\":1}]}],"
                   "\"nodes\":[{\"mesh\":0},{\"mesh\":1,\"scale\":[1.5,2,1],\"translation\":[-0.5,-0.5,-1]}],\"materials\":["
                   "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.8,0.3,0.1,1],\"metallicFactor\":0,\"roughnessFactor\":0.05},"
                   "\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1}}},"
                   "{\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.25,0.5,1,1]},\"extensions\":{\"KHR_materials_unlit\":{}}}]",
                   quad_positions, quad_indices, quad_positions, quad_indices),
            (shot){{1, 0.5, 2.5}, {1, 0.5, 0}}, f, 2, 0.01);
}

/* Fractions of a face's edges at the nearest point of it along a ray; false if the ray misses it by more than `margin`. */
static bool along_edges(const face *f, const double eye[3], const double direction[3], double margin, double uv[2], double point[3]) {
    double n[3], from[3], on[3], across[3];
    cross(f->u, f->v, n);
    for (int k = 0; k < 3; k++) from[k] = f->at[k] - eye[k];
    double t = dot(from, n) / dot(n, direction);
    for (int k = 0; k < 3; k++) point[k] = eye[k] + t * direction[k];
    for (int k = 0; k < 3; k++) on[k] = point[k] - f->at[k];
    cross(on, f->v, across);
    uv[0] = dot(across, n) / dot(n, n);
    cross(f->u, on, across);
    uv[1] = dot(across, n) / dot(n, n);
    return uv[0] > margin && uv[0] < 1 - margin && uv[1] > margin && uv[1] < 1 - margin;
}

/* A pane that only transmits, before a wall whose colour tells the position on it. The wall is seen where the refracted
 * ray has gone the thickness (of the node's scale); error and shift in pixels of the picture. */
static void volumes_refract_what_is_behind(void **state) {
    (void)state;
    static const float colors[16] = {0, 0, 0.25f, 1, 1, 0, 0.25f, 1, 1, 1, 0.25f, 1, 0, 1, 0.25f, 1};
    static const struct {
        double thickness, ior, scale; /* ior 0: infinite */
    } cases[] = {{0, 1.5, 1}, {0.4, 1, 1}, {0.4, 1.5, 1}, {0.4, 2.4, 1}, {0.4, 0, 1}, {0.25, 1.5, 2}};
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        double scale = cases[c].scale, thickness = cases[c].thickness * scale, ior = cases[c].ior, mean = 0, most = 0, shift = 0;
        face pane = flat(0, 0, 0, 2 * scale, scale, 1, 1, 1, 0), wall = flat(-1, -1, -1.5, 4, 3, 0, 0, 0, 1);
        shot p = {{-0.8, 1.6, 2.5}, {scale, 0.5 * scale, 0}};
        char volume[512];
        masu_session s;
        masu_view v;
        uint32_t count = 0;
        begin_quad();
        int shades = floats(colors, "VEC4", 4, 4);
        snprintf(volume, sizeof volume,
                 "{\"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0},\"extensions\":{"
                 "\"KHR_materials_transmission\":{\"transmissionFactor\":1},\"KHR_materials_specular\":{\"specularFactor\":0},"
                 "\"KHR_materials_volume\":{\"thicknessFactor\":%g},\"KHR_materials_ior\":{\"ior\":%g}}}",
                 cases[c].thickness, ior);
        const char *path =
            finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"material\":0}]},"
                   "{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"COLOR_0\":%d},\"indices\":%d,\"material\":1}]}],"
                   "\"nodes\":[{\"mesh\":0,\"scale\":[%g,%g,%g]},{\"mesh\":1,\"scale\":[2,3,1],\"translation\":[-1,-1,-1.5]}],"
                   "\"materials\":[%s,{\"pbrMetallicRoughness\":{},\"extensions\":{\"KHR_materials_unlit\":{}}}]",
                   quad_positions, quad_indices, quad_positions, shades, quad_indices, scale, scale, scale, volume);
        const uint16_t *hdr = photograph(&s, path, p, &v);
        for (uint32_t i = 0; i < SIDE * SIDE; i++) {
            double d[3], at[3], exit[3], uv[2], seen[2], unbent[2], width = 0, off = 0, away = 0;
            masu_view_ray ray = masu_view_ray_at(&v, i % SIDE, i / SIDE);
            if (i % SIDE < 8 || i % SIDE >= SIDE - 8 || i / SIDE < 8 || i / SIDE >= SIDE - 8) continue; /* clamped there */
            if (!along_edges(&pane, v.eye, ray.direction, 0.03, uv, at)) continue;
            /* Snell's law at a surface of z: the tangential part is divided by the index. */
            for (int k = 0; k < 2; k++) d[k] = ior > 0 ? ray.direction[k] / ior : 0;
            d[2] = -sqrt(1 - d[0] * d[0] - d[1] * d[1]);
            for (int k = 0; k < 3; k++) exit[k] = at[k] + thickness * d[k] - v.eye[k];
            if (!along_edges(&wall, v.eye, ray.direction, 0.03, unbent, at) || !along_edges(&wall, v.eye, exit, 0.03, uv, at)) continue;
            for (int k = 0; k < 2; k++) seen[k] = half_float(hdr[4 * i + (uint32_t)k]);
            for (int k = 0; k < 3; k++) d[k] = ray.direction[k] * ray.z_scale + v.right[k] * (2.0 / SIDE);
            (void)along_edges(&wall, v.eye, d, 0, exit, at);
            width = (exit[0] - unbent[0]) * 4; /* of a pixel on the wall */
            off = hypot((seen[0] - uv[0]) * 4, (seen[1] - uv[1]) * 3) / width;
            away = hypot((unbent[0] - uv[0]) * 4, (unbent[1] - uv[1]) * 3) / width;
            mean += off, shift += away, count++;
            most = fmax(most, off);
        }
        close_session(&s);
        print_message("thickness %g, ior %g, scale %g: shifted by %.2f pixels in the mean, error %.3f, at most %.3f\n",
                      cases[c].thickness, ior, scale, shift / count, mean / count, most);
        assert_true(count > 200);
        assert_true(mean / count < 0.1 && most < 0.5);
        assert_true(thickness * (ior - 1) == 0 ? shift / count < 1e-9 : shift / count > 1);
    }
}

/* ---- Coordinates, textures, colours ---------------------------------------------------------- */

static void pictures_are_of_the_second_set_and_turned(void **state) {
    (void)state;
    static const uint8_t colors[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
    /* A rotation by 90 degrees moves (u, v) to (v, -u) + (0, 1): the upper left of the image has
     * the lower left of the texture. */
    static const int seen[4] = {2, 0, 3, 1};
    face f[4];
    write_squares("squares.png", colors);
    quarter(f);
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) f[i].look[c] = linear(colors[i][c]);
#define ROUGH "\"metallicFactor\":0,\"roughnessFactor\":0.75"
    compare(mapped("squares.png", "\"pbrMetallicRoughness\":{" ROUGH ",\"baseColorTexture\":{\"index\":0,\"texCoord\":1}}"), ahead, f, 4, 0);
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) f[i].look[c] = linear(colors[seen[i]][c]);
    compare(mapped("squares.png", "\"pbrMetallicRoughness\":{" ROUGH ",\"baseColorTexture\":{\"index\":0,\"texCoord\":0,\"extensions\":"
                                  "{\"KHR_texture_transform\":{\"texCoord\":1,\"rotation\":1.5707963267948966,\"offset\":[0,1]}}}}"),
            ahead, f, 4, 0);
}

/* With eight texels along a side: interpolated, the squares would be an eighth wider than they
 * are. */
static void pixels_of_a_picture_stay_sharp(void **state) {
    (void)state;
    static const uint8_t colors[4][3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {255, 255, 255}};
    static const float coordinates[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    static uint8_t rgba[8 * 8 * 4];
    char attributes[64], rest[512], error[ERROR_SIZE];
    face f[4];
    for (int i = 0; i < 64; i++) {
        memcpy(rgba + 4 * i, colors[(i % 8 >= 4) + 2 * (i / 8 >= 4)], 3);
        rgba[4 * i + 3] = 255;
    }
    assert_ok(masu_image_save_png(in_scratch("pixels.png"), rgba, 8, 8, 0, error, sizeof error));
    quarter(f);
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) f[i].look[c] = linear(colors[i][c]);
    begin_quad();
    snprintf(attributes, sizeof attributes, ",\"TEXCOORD_0\":%d", floats(coordinates, "VEC2", 4, 2));
    snprintf(rest, sizeof rest,
             ",\"images\":[{\"uri\":\"pixels.png\"}],\"textures\":[{\"source\":0,\"sampler\":0}],"
             "\"samplers\":[{\"magFilter\":9728}],\"materials\":[{\"pbrMetallicRoughness\":{" ROUGH
             ",\"baseColorTexture\":{\"index\":0}}}]");
    compare(finish_quad(attributes, ",\"material\":0", rest), ahead, f, 4, 0);
}

static void pictures_are_webp(void **state) {
    (void)state;
    static const float at[8] = {0, 1, 1, 1, 1, 0, 0, 0};
    char attributes[64], rest[1024];
    face f = flat(0, 0, 0, 2, 1, 1, 0, 0, 0.75);
    begin_quad();
    int v = view(webp, sizeof webp, 0);
    snprintf(attributes, sizeof attributes, ",\"TEXCOORD_0\":%d", floats(at, "VEC2", 4, 2));
    snprintf(rest, sizeof rest,
             ",\"images\":[{\"bufferView\":%d,\"mimeType\":\"image/webp\"}],\"textures\":[{\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}}],"
             "\"materials\":[{\"pbrMetallicRoughness\":{" ROUGH ",\"baseColorTexture\":{\"index\":0}}}]", v);
    compare(finish_quad(attributes, ",\"material\":0", rest), ahead, &f, 1, 0);
}

static void vertices_have_colours(void **state) {
    (void)state;
    static const float colors[16] = {1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 1, 1, 0.5f, 0.25f, 1};
    char attributes[64];
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.2, 0.075, 0.75);
    begin_quad();
    snprintf(attributes, sizeof attributes, ",\"COLOR_0\":%d", floats(colors, "VEC4", 4, 4));
    compare(finish_quad(attributes, ",\"material\":0", ",\"materials\":[{" CLAY "}]"), ahead, &f, 1, 0);
}

/* ---- Sides ----------------------------------------------------------------------------------- */

static void single_sided_materials_are_not_seen_from_behind(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.4, 0.3, 0.75);
    compare(quad_of(CLAY ",\"doubleSided\":true"), behind, &f, 1, 0); /* its normal is flipped */
    f.single = true;
    compare(quad_of(CLAY), ahead, &f, 1, 0);
    compare(quad_of(CLAY), behind, &f, 1, 0);
    /* A mirrored node is still visible from the same side; or from both sides. */
    begin_quad();
    compare(finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"material\":0}]}],"
                   "\"nodes\":[{\"mesh\":0,\"scale\":[-1,1,1],\"translation\":[2,0,0]}],\"materials\":[{" CLAY "}]",
                   quad_positions, quad_indices),
            ahead, &f, 1, 0);
}

/* Normals of a coarse mesh near its silhouette: half of the visible ones point away from the
 * camera. The facing side follows the triangle, so none is flipped. */
static void normals_may_lean_away(void **state) {
    (void)state;
    float normal[12];
    char attributes[64];
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.4, 0.3, 0.75);
    f.leans = true;
    f.over[0] = 12 / 13.0, f.over[2] = 5 / 13.0;
    for (int i = 0; i < 12; i++) normal[i] = (float)f.over[i % 3];
    begin_quad();
    snprintf(attributes, sizeof attributes, ",\"NORMAL\":%d", floats(normal, "VEC3", 4, 3));
    compare(finish_quad(attributes, ",\"material\":0", ",\"materials\":[{" CLAY ",\"doubleSided\":true}]"),
            (shot){{0.6, 0.5, 1.2}, {1, 0.5, 0}}, &f, 1, 0);
}

#define THIN "\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.5,0.4,0.3,0.5],\"metallicFactor\":0}"

static void nor_where_they_are_blended(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.4, 0.3, 1);
    f.single = true;
    compare(quad_of(THIN), behind, &f, 1, 0); /* only sky */
}

/* The result of picking in the centre. */
static uint32_t picked(const char *material, shot p) {
    masu_session s;
    masu_view v;
    masu_commands commands;
    masu_pick_info info;
    photograph(&s, quad_of(material), p, &v);
    masu_frame_desc frame = {.pick = 1, .pick_x = SIDE / 2, .pick_y = SIDE / 2};
    draw(&s, &frame, &commands, NULL);
    assert_int_equal(masu_pick(s.m, commands.slot, &info, NULL), MASU_OK);
    close_session(&s);
    return info.kind;
}

static void nor_by_a_click(void **state) {
    (void)state;
    static const char *const materials[] = {CLAY, THIN};
    for (int i = 0; i < 2; i++) {
        char both[512];
        snprintf(both, sizeof both, "%s,\"doubleSided\":true", materials[i]);
        assert_int_equal(picked(both, behind), MASU_PICK_INSTANCE);
        assert_int_equal(picked(materials[i], ahead), MASU_PICK_INSTANCE);
        assert_int_equal(picked(materials[i], behind), MASU_PICK_SKY);
    }
}

/* Number of pixels of a mirror, 2 behind a quad that emits red, that show the quad's back. */
static uint32_t seen_in_mirror(const char *material) {
    static unsigned made;
    char json[1024], name[32];
    uint32_t red = 0;
    masu_session s;
    snprintf(name, sizeof name, "mirror%u", made++);
    const char *path = strrchr(quad_of(material), '/') + 1;
    snprintf(json, sizeof json,
             "{\"models\": [{\"file\": \"%s\"}, {\"mesh\": {\"plane\": {\"size_x\": 9, \"size_z\": 9}}, \"rotate\": [90, 0, 0], "
             "\"translate\": [1, 0.5, -2], \"material\": {\"base_color\": [1, 1, 1], \"metallic\": 1, \"roughness\": 0}}], "
             "\"reflections\": {}, \"camera\": {\"fov_y\": 60, \"near\": 0.05, \"keys\": [{\"position\": [1, 3, 2], \"target\": [1, 0, -2]}]}}",
             path);
    bake_scene(name, json);
    masu_session_desc d = test_desc(NULL, SIDE, SIDE);
    d.scene_path = baked_scene(name);
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    masu_frame_desc frame = {0};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    const uint16_t *hdr = read_image(&s, commands.slot, MASU_READBACK_HDR);
    const float *depth = read_image(&s, commands.slot, MASU_READBACK_DEPTH);
    /* The quad itself is closer than 4. */
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        red += depth[i] > 0 && 0.05f / depth[i] > 4 && half_float(hdr[4 * i]) > 2;
    close_session(&s);
    return red;
}

static void nor_in_mirrors(void **state) {
    (void)state;
#define RED "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0,0,0,1]},\"emissiveFactor\":[1,0,0],\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":8}}"
    uint32_t both = seen_in_mirror(RED ",\"doubleSided\":true"), one = seen_in_mirror(RED);
    printf("  %u pixels of the mirror show the back of the two-sided quad\n", both);
    assert_true(both > 40);
    assert_int_equal(one, 0);
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

#define MATERIALS ",\"materials\":[{" CLAY "}]"

/* Shorts, in a cube of 2 that its node scales to 1 x 0.5 x 1; two of its faces are visible. */
static void a_quantized_cube(void **state) {
    (void)state;
    int16_t p[24][4] = {{0}};
    int8_t n[24][4] = {{0}};
    uint8_t order[36];
    for (int i = 0; i < 24; i++) {
        int axis = i / 8, side = i / 4 % 2, a = i & 1, b = i >> 1 & 1;
        p[i][axis] = side ? 32767 : -32767;
        p[i][(axis + 1) % 3] = a ? 32767 : -32767;
        p[i][(axis + 2) % 3] = b ? 32767 : -32767;
        n[i][axis] = side ? 127 : -127;
    }
    for (int i = 0; i < 6; i++) {
        static const uint8_t out[6] = {0, 1, 3, 0, 3, 2}, in[6] = {0, 3, 1, 0, 2, 3};
        for (int k = 0; k < 6; k++) order[6 * i + k] = (uint8_t)(4 * i + (i & 1 ? out[k] : in[k]));
    }
    begin();
    int positions = accessor(view(p, sizeof p, 8), SHORT, "VEC3", 24, ",\"normalized\":true");
    int normals = accessor(view(n, sizeof n, 4), BYTE, "VEC3", 24, ",\"normalized\":true");
    int indices = accessor(view(order, sizeof order, 0), UBYTE, "SCALAR", 36, "");
    const char *path = finish("\"extensionsRequired\":[\"KHR_mesh_quantization\"],\"meshes\":[{\"primitives\":[{\"attributes\":"
                              "{\"POSITION\":%d,\"NORMAL\":%d},\"indices\":%d,\"material\":0}]}],"
                              "\"nodes\":[{\"mesh\":0,\"scale\":[1,0.5,1],\"translation\":[1,0.5,0]}]" MATERIALS,
                              positions, normals, indices);
    face f[2] = {flat(0, 0, 1, 2, 1, 0.5, 0.4, 0.3, 0.75), flat(0, 0, 0, 0, 0, 0.5, 0.4, 0.3, 0.75)};
    f[1] = (face){.at = {2, 0, 1}, .u = {0, 0, -2}, .v = {0, 1, 0}, .look = {0.5, 0.4, 0.3, 0.75}};
    compare(path, (shot){{3.5, 0.5, 4}, {1.3, 0.5, 0.4}}, f, 2, 0);
}

static void draco_is_unpacked(void **state) {
    (void)state;
    face f = flat(0, 0, 0, 2, 1, 1, 1, 1, 1); /* glTF's own material: white metal, rough */
    f.look[7] = 1;
    compare(packed(sizeof packed_quad, "{\"POSITION\":0,\"TEXCOORD_0\":1}"), ahead, &f, 1, 0);
}

static void nodes_have_instances(void **state) {
    (void)state;
    static const float places[9] = {0, -1, 0, 0, 0.25f, 0, 0, 1.5f, -1}, sizes[9] = {1, 1, 1, 1, 1, 1, 0.5f, 0.5f, 1};
    face f[3] = {flat(0, -1, 0, 2, 1, 0.5, 0.4, 0.3, 0.75), flat(0, 0.25, 0, 2, 1, 0.5, 0.4, 0.3, 0.75),
                 flat(0, 1.5, -1, 1, 0.5, 0.5, 0.4, 0.3, 0.75)};
    begin_quad();
    int t = floats(places, "VEC3", 3, 3), s = floats(sizes, "VEC3", 3, 3);
    compare(finish("\"extensionsRequired\":[\"EXT_mesh_gpu_instancing\"],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},"
                   "\"indices\":%d,\"material\":0}]}],\"nodes\":[{\"mesh\":0,\"extensions\":{\"EXT_mesh_gpu_instancing\":"
                   "{\"attributes\":{\"TRANSLATION\":%d,\"SCALE\":%d}}}}]" MATERIALS,
                   quad_positions, quad_indices, t, s),
            (shot){{1, 0.5, 4}, {1, 0.5, 0}}, f, 3, 0);
}

static void morphs_have_their_weights(void **state) {
    (void)state;
    static const float away[12] = {0, 0, 0, 0, 0, 0, 0, 0, -4, 0, 0, -4};
    face f = flat(0, 0, 0, 2, 1, 0.5, 0.4, 0.3, 0.75);
    f.v[2] = -1; /* a quarter of the target */
    begin_quad();
    int target = floats(away, "VEC3", 4, 3);
    compare(finish("\"meshes\":[{\"weights\":[1],\"primitives\":[{\"attributes\":{\"POSITION\":%d},\"indices\":%d,\"material\":0,"
                   "\"targets\":[{\"POSITION\":%d}]}]}],\"nodes\":[{\"mesh\":0,\"weights\":[0.25]}]" MATERIALS,
                   quad_positions, quad_indices, target),
            ahead, &f, 1, 0);
}

static void skins_stand_as_their_joints_have_them(void **state) {
    (void)state;
    static const float moves[9] = {0, 0, 0, 3, 0, 0, 3, 4, 0};
    face f = flat(0, 0, 0, 2, 1, 1, 1, 1, 1);
    f.v[0] = 5; /* the upper joint is 5 to the right of its bind position */
    f.look[7] = 1;
    compare(skinned("STEP", moves, 3), (shot){{3.5, 0.5, 2.5}, {3.5, 0.5, 0}}, &f, 1, 0);
}

/* First of the pixels of a row that shine; last: one beyond. */
static uint32_t first_lit(const uint16_t *row, uint32_t count, uint32_t *last) {
    uint32_t first = count;
    for (uint32_t x = 0; x < count; x++) {
        if (half_float(row[4 * x]) <= 10) continue;
        first = first == count ? x : first;
        *last = x + 1;
    }
    return first;
}

/* Boxes at the edge of the picture, half a height before the target, at it and behind: where an exact orthographic
 * projection has their sides, in pixels of 1920 x 1080. The picture has 15360 columns of these 1920: a pixel is rounded
 * to an eighth. Upright or oblique; the depths and the nearness to the camera are no matter. */
static void an_orthographic_camera_sees_no_depth(void **state) {
    (void)state;
    enum { COLUMNS = 15360, ROWS = 18 };
    static const struct {
        double height, depth, turn, away; /* of the picture; of the box, in heights; of the camera, radians and metres */
    } cases[] = {{4, 0, 0, 10}, {4, 0.5, 0, 10}, {4, -0.5, 0, 10}, {4, 0.5, 0.6, 30}, {400, -0.5, 0.6, 1000}, {0.02, 0.5, -0.9, 0.1}};
    double most = 0;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double h = cases[i].height, turn = cases[i].turn, aspect = 1920.0 / 1080, side = 0.02 * h;
        /* A thin tall box, whose front is seen; its left and right side in heights from the middle. */
        double at = (aspect / 2 - 0.05) * h, z = cases[i].depth * h, error;
        double x = at * cos(turn) + z * sin(turn), y = -at * sin(turn) + z * cos(turn);
        char text[1024];
        masu_session s;
        snprintf(text, sizeof text,
                 "{\"models\": [{\"mesh\": {\"box\": {\"size\": [%.9g, %.9g, %.9g]}}, \"translate\": [%.9g, 0, %.9g], \"rotate\": [0, %.9g, 0], "
                 "\"material\": {\"emissive\": [50, 50, 50]}}], \"camera\": {\"height\": %.9g, \"keys\": [{\"position\": "
                 "[%.9g, 0, %.9g], \"target\": [0, 0, 0]}]}}",
                 side, h, side, x, y, turn * 57.29577951308232, h, cases[i].away * sin(turn), cases[i].away * cos(turn));
        bake_scene("flat", text);
        masu_session_desc d = test_desc(NULL, COLUMNS, ROWS);
        d.scene_path = baked_scene("flat");
        d.desc.readback = MASU_READBACK_HDR;
        d.desc.rung_count = 1;
        open_session(&s, &d);
        masu_frame_desc frame = {0};
        masu_camera camera;
        assert_int_equal(masu_camera_at(s.m, 0, &camera, NULL), MASU_OK);
        /* The window of the 1920 x 1080 picture. */
        camera.top = tanf(0.5f * camera.fov_y), camera.bottom = -camera.top;
        camera.right = (float)aspect * camera.top, camera.left = -camera.right;
        frame.camera = &camera;
        const uint16_t *seen = draw_image(&s, &frame, MASU_READBACK_HDR, NULL);
        uint32_t last = 0;
        double first = first_lit(seen + 4 * COLUMNS * (ROWS / 2), COLUMNS, &last) * 1920.0 / COLUMNS;
        double want = 960 + (at - side / 2) / h * 1080;
        error = fmax(fabs(first - want), fabs(last * 1920.0 / COLUMNS - want - side / h * 1080));
        close_session(&s);
        print_message("height %g, depth %g heights, turned by %g: %.3f pixels\n", h, cases[i].depth, turn, error);
        assert_true(last > 0 && error <= (cases[i].depth == 0 ? 0.2 : 0.5));
        most = fmax(most, error);
    }
    assert_true(most > 0.2); /* else the boxes are not where the test has them */
}

/* The camera stays as far away between keys whose directions are a quarter turn apart: no chord, which would bring what is
 * near behind the near plane. */
static void orthographic_cameras_turn_about_their_target(void **state) {
    (void)state;
    masu_session s;
    bake_scene("turns", "{\"models\": [{\"mesh\": {\"box\": {}}}], \"camera\": {\"height\": 4, \"keys\": ["
                        "{\"time\": 0, \"position\": [0, 0, 10], \"target\": [0, 0, 0]}, {\"time\": 2, \"position\": [10, 0, 0], \"target\": [0, 0, 0]}]}}");
    masu_session_desc d = test_desc(NULL, SIDE, SIDE);
    d.scene_path = baked_scene("turns");
    open_session(&s, &d);
    double far = 0;
    for (int i = 0; i <= 100; i++) {
        masu_camera c;
        assert_int_equal(masu_camera_at(s.m, 0.02 * i, &c, NULL), MASU_OK);
        double size = sqrt(dot(c.position, c.position)), want[3] = {0.1 * i, 0, 10 - 0.1 * i}, toward = 0;
        far = i ? far : size;
        assert_true(fabs(size - far) < 0.05 * 4);
        for (int k = 0; k < 3; k++) toward += want[k] * c.position[k];
        assert_true(toward / size / sqrt(dot(want, want)) > 1 - 1e-6);
    }
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(emission_needs_no_fifth_attachment),
        cmocka_unit_test(emission_is_added),
        cmocka_unit_test(what_is_black_and_emits_still_mirrors),
        cmocka_unit_test(what_is_unlit_sends_its_colour),
        cmocka_unit_test(weak_maps_of_emission_shine),
        cmocka_unit_test(a_coat_is_smooth_unless_it_names_a_picture),
        cmocka_unit_test(grain_turns_by_its_smallest_step),
        cmocka_unit_test(coats_have_maps),
        cmocka_unit_test(glass_colours_what_is_behind),
        cmocka_unit_test(volumes_refract_what_is_behind),
        cmocka_unit_test(pictures_are_of_the_second_set_and_turned),
        cmocka_unit_test(pixels_of_a_picture_stay_sharp),
        cmocka_unit_test(pictures_are_webp),
        cmocka_unit_test(vertices_have_colours),
        cmocka_unit_test(single_sided_materials_are_not_seen_from_behind),
        cmocka_unit_test(normals_may_lean_away),
        cmocka_unit_test(nor_where_they_are_blended),
        cmocka_unit_test(nor_by_a_click),
        cmocka_unit_test(nor_in_mirrors),
        cmocka_unit_test(a_quantized_cube),
        cmocka_unit_test(draco_is_unpacked),
        cmocka_unit_test(nodes_have_instances),
        cmocka_unit_test(morphs_have_their_weights),
        cmocka_unit_test(an_orthographic_camera_sees_no_depth),
        cmocka_unit_test(orthographic_cameras_turn_about_their_target),
        cmocka_unit_test(skins_stand_as_their_joints_have_them),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

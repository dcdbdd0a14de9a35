/* test_textures.c: textures from blob to pixel, against the same blob sampled on the CPU: mips and
 * their bias, blocks sampled by the device and blocks decoded on the host, alpha tests, normal
 * maps, light, grazing views, memory. */
#include "support/support.h"
#include "support/floats.h"

#include "scene/blob.h"
#include "image.h"
#include "reference/brdf.h"
#include "reference/tone.h"
#include "reference/vec.h"
#include "scene/scene.h"
#include "split_sum.h"
#include "scene/texture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 128, PIXELS = SIDE * SIDE };

static masu_session s;
static uint8_t *blob; /* the reference's own copy */
static masu_scene look;

static void read_blob(const char *scene) {
    char error[ERROR_SIZE];
    size_t size;
    masu_detail detail;
    free(blob);
    assert_ok(masu_file_read(scene_path(scene), 1 << 30, &blob, &size, error, sizeof error));
    assert_int_equal(masu_scene_bind(blob, size, &look, &detail), MASU_OK);
}

static void open_textured(const char *scene, int decoded, float scale) {
    masu_session_desc d = test_desc(scene, SIDE, SIDE);
    read_blob(scene);
    d.desc.readback = MASU_READBACK_ALL;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = scale};
    d.desc.deny.compressed_textures = (uint32_t)decoded;
    open_session(&s, &d);
}

/* ---- The reference: texels of the blob, in linear light -------------------------------------- */

typedef struct mip {
    uint32_t width, height;
    double *rgba;
} mip;

/* One mip of layer 0, decoded block by block; free .rgba. */
static mip mip_of(uint32_t texture, uint32_t level) {
    masu_scene_view v = masu_scene_view_of(&look);
    const masu_blob_texture *t = &v.textures[texture];
    const unsigned char *at = v.texels + t->offset;
    uint32_t block_bytes = masu_blob_block_bytes(t->format);
    int srgb = t->format == MASU_TEXTURE_BC1_SRGB || t->format == MASU_TEXTURE_BC3_SRGB;
    for (uint32_t m = 0; m < level; m++) {
        at += (size_t)((masu_blob_mip_size(t->width, m) + 3) / 4) *
              ((masu_blob_mip_size(t->height, m) + 3) / 4) * block_bytes;
    }
    mip out = {masu_blob_mip_size(t->width, level), masu_blob_mip_size(t->height, level), NULL};
    out.rgba = calloc((size_t)out.width * out.height * 4, sizeof *out.rgba);
    for (uint32_t y = 0; y < out.height; y++) {
        for (uint32_t x = 0; x < out.width; x++) {
            uint8_t block[64];
            masu_texture_decode(
                t->format, at + ((size_t)(y / 4) * ((out.width + 3) / 4) + x / 4) * block_bytes,
                block);
            for (uint32_t k = 0; k < 4 && srgb; k++) {
                uint8_t c = block[4 * (y % 4 * 4 + x % 4) + k];
                out.rgba[4 * ((size_t)y * out.width + x) + k] =
                    k < 3 ? masu_ref_srgb_decode(c / 255.0) : c / 255.0;
            }
        }
    }
    return out;
}

/* Bilinear, repeating. */
static double sample(const mip *m, double u, double v, uint32_t k) {
    double x = u * m->width - 0.5, y = v * m->height - 0.5, sum = 0;
    double fx = x - floor(x), fy = y - floor(y);
    for (int j = 0; j < 2; j++) {
        for (int i = 0; i < 2; i++) {
            int64_t px = ((int64_t)floor(x) + i) % m->width,
                    py = ((int64_t)floor(y) + j) % m->height;
            if (px < 0) px += m->width;
            if (py < 0) py += m->height;
            sum += (i ? fx : 1 - fx) * (j ? fy : 1 - fy) *
                   m->rgba[4 * ((size_t)py * m->width + (size_t)px) + k];
        }
    }
    return sum;
}

/* ---- Mips ------------------------------------------------------------------------------------ */

/* A quad of 2 x 2, viewed face-on from the distance at which one pixel of the render size covers
 * `texels` of its 256. */
static masu_camera face_on(double texels, uint32_t render) {
    double pixel = texels * 2 / 256, height = pixel * render; /* world units */
    return (masu_camera){
        .position = {0, 0, height / (2 * tan(0.35))}, .forward = {0, 0, -1}, .fov_y = 0.7f};
}

/* Renders, and compares sqrt of albedo, in bytes, with one mip. Returns the largest error. */
static double compare_face_on(double texels, uint32_t render, uint32_t level, uint32_t *compared,
                              double *mean) {
    masu_camera camera = face_on(texels, render);
    masu_frame_desc frame = {.camera = &camera};
    const uint8_t *got = draw_image(&s, &frame, MASU_READBACK_ALBEDO, NULL);
    mip m = mip_of(0, level);
    double worst = 0, sum = 0;
    *compared = 0;
    for (uint32_t y = 0; y < render; y++) {
        for (uint32_t x = 0; x < render; x++) {
            double u = 0.5 + (x + 0.5 - render / 2.0) * texels / 256;
            double v = 0.5 + (y + 0.5 - render / 2.0) * texels / 256;
            double rim = texels / 256 * 1.5; /* pixels at the rim may be uncovered */
            if (u < rim || u > 1 - rim || v < rim || v > 1 - rim) continue;
            for (uint32_t k = 0; k < 3; k++) {
                double want = 255 * sqrt(sample(&m, u, v, k));
                double error = fabs(want - got[4 * (y * render + x) + k]);
                if (error > worst) worst = error;
                sum += error;
            }
            (*compared)++;
        }
    }
    *mean = sum / (3.0 * *compared);
    free(m.rgba);
    return worst;
}

static void a_quad_shows_the_mip_of_its_distance(void **state) {
    (void)state;
    /* Texels per pixel and the resulting mip: trilinear filtering has nothing to mix. */
    static const struct {
        double texels;
        uint32_t level;
    } rows[] = {{0.25, 0}, {0.5, 0}, {1, 0}, {2, 1}, {4, 2}, {8, 3}, {16, 4}};
    for (int decoded = 0; decoded < 2; decoded++) {
        open_textured("test_texture_quad", decoded, 1.0f);
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            uint32_t compared;
            double mean,
                worst = compare_face_on(rows[i].texels, SIDE, rows[i].level, &compared, &mean);
            print_message("%s, %g texels a pixel: mip %u, error %.2f at most, %.3f in the mean "
                          "(of 255, %u pixels)\n",
                          decoded ? "decoded" : "blocks ", rows[i].texels, rows[i].level, worst,
                          mean, compared);
            assert_true(compared > (rows[i].texels < 8 ? 500 : 20));
            assert_true(worst <= 3.0);
            assert_true(mean <= 0.8);
            if (rows[i].level) { /* and not the previous mip */
                double other;
                assert_true(compare_face_on(rows[i].texels, SIDE, rows[i].level - 1, &compared,
                                            &other) > 8);
            }
        }
        close_session(&s);
    }
}

static void fewer_pixels_take_the_mip_of_the_output(void **state) {
    (void)state;
    /* At half size a pixel has twice the texels; the bias of -1 compensates. */
    uint32_t compared;
    double mean;
    open_textured("test_texture_quad", 0, 0.5f);
    assert_true(compare_face_on(4, SIDE / 2, 1, &compared, &mean) <= 3.0);
    assert_true(compare_face_on(4, SIDE / 2, 2, &compared, &mean) > 8);
    close_session(&s);
}

/* RMS difference, of 255, between images rendered at half size and at full size. */
static double upscaled_error(const char *scene, uint32_t no_bias) {
    static uint8_t pictures[2][4 * PIXELS];
    masu_session_desc d = test_desc(scene, SIDE, SIDE);
    d.desc.rung_count = 2;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.rungs[1] = (masu_rung){.scale = 0.5f, .sharpness = 0.2f};
    d.desc.debug.no_bias = no_bias;
    open_session(&s, &d);
    for (uint32_t r = 0; r < 2; r++) draw_rung(&s, r, pictures[r]);
    close_session(&s);
    double sum = 0;
    for (uint32_t i = 0; i < 4 * PIXELS; i++) {
        double error = pictures[0][i] - pictures[1][i];
        sum += error * error;
    }
    return sqrt(sum / (3 * PIXELS));
}

static void upscaled_textures_are_nearer_with_their_bias(void **state) {
    (void)state;
    /* The checker to the horizon behaves differently: its far fields are finer than any pixel, and
     * the bias passes more of them than half as many pixels can show. */
    static const char *const scenes[] = {"test_texture_quad", "test_texture_large",
                                         "test_texture_floor"};
    for (int i = 0; i < 3; i++) {
        double with = upscaled_error(scenes[i], 0), without = upscaled_error(scenes[i], 1);
        print_message("%s at half size: %.3f of 255 from full size, without bias %.3f\n", scenes[i],
                      with, without);
        if (i < 2) assert_true(with < 0.97 * without);
    }
}

static void blocks_and_decoded_texels_give_one_picture(void **state) {
    (void)state;
    static uint8_t pictures[2][4 * PIXELS];
    uint64_t bytes[2] = {0};
    /* 1200 x 1200 is more than a staging buffer: it arrives in chunks. */
    for (int decoded = 0; decoded < 2; decoded++) {
        masu_memory_row rows[MEMORY_ROWS];
        open_textured("test_texture_large", decoded, 1.0f);
        draw_rung(&s, 0, pictures[decoded]);
        uint32_t n = memory_rows(s.m, rows);
        for (uint32_t i = 0; i < n; i++) {
            if (!strcmp(rows[i].kind, "texture")) bytes[decoded] += rows[i].bytes;
            if (!strcmp(rows[i].name, "staging")) assert_true(rows[i].bytes < 5u << 20);
        }
        masu_peak_info peaks;
        masu_peaks(s.m, &peaks);
        assert_int_equal(peaks.textures, 3);
        assert_int_equal(peaks.texture_bytes, decoded || !s.host.compressed
                                                  ? masu_scene_texture_bytes(&s.scene, 0)
                                                  : masu_scene_texture_bytes(&s.scene, 1));
        assert_true(bytes[decoded] >= peaks.texture_bytes);
        close_session(&s);
    }
    uint32_t worst = max_difference(pictures[0], pictures[1], sizeof pictures[0]);
    print_message("blocks: %llu bytes, decoded: %llu; images differ by %u of 255\n",
                  (unsigned long long)bytes[0], (unsigned long long)bytes[1], worst);
    assert_true(worst <= 9); /* a step of the hue of lit and emissive surfaces; 3 without
                                emission */
    uint32_t colours = 0; /* the image has content */
    for (uint32_t i = 4; i < 4 * PIXELS; i += 4) {
        colours += memcmp(pictures[0] + i, pictures[0] + i - 4, 3) != 0;
    }
    assert_true(colours > PIXELS / 8);
}

/* ---- Grazing views --------------------------------------------------------------------------- */

static void a_floor_to_the_horizon_is_finite_and_grey(void **state) {
    (void)state;
    for (int decoded = 0; decoded < 2; decoded++) {
        masu_frame_desc frame = {0};
        open_textured("test_texture_floor", decoded, 1.0f);
        const uint8_t *albedo = draw_image(&s, &frame, MASU_READBACK_ALBEDO, NULL);
        double sum = 0;
        uint32_t count = 0;
        for (uint32_t y = SIDE * 3 / 4; y < SIDE; y++) {
            for (uint32_t x = 0; x < SIDE; x++) {
                double v = albedo[4 * (y * SIDE + x)] / 255.0;
                sum += v * v; /* 37 fields of an odd checker: half of the fields and half a field */
                count++;
            }
        }
        print_message("checker at a grazing angle: %.4f of 0.5\n", sum / count);
        assert_true(fabs(sum / count - 0.5) < 0.03);
        const uint16_t *hdr = draw_image(&s, &frame, MASU_READBACK_HDR, NULL);
        for (uint32_t i = 0; i < 4 * PIXELS; i++) {
            assert_true(isfinite(half_float(hdr[i])) && half_float(hdr[i]) >= 0);
        }
        masu_stats_info stats;
        assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
        assert_int_equal(stats.replaced, 0);
        close_session(&s);
    }
}

/* ---- Alpha tests ----------------------------------------------------------------------------- */

static void a_mask_has_the_silhouette_of_its_alpha(void **state) {
    (void)state;
    for (int decoded = 0; decoded < 2; decoded++) {
        masu_camera camera = {.position = {0, 0, 3.2}, .forward = {0, 0, -1}, .fov_y = 0.7f};
        masu_frame_desc frame = {.camera = &camera};
        open_textured("test_texture_mask", decoded, 1.0f);
        const float *depth = draw_image(&s, &frame, MASU_READBACK_DEPTH, NULL);
        masu_scene_view v = masu_scene_view_of(&look);
        uint32_t texture = 0;
        while (v.textures[texture].format != MASU_TEXTURE_BC3_SRGB) texture++;
        mip m = mip_of(texture, 0);
        uint32_t there = 0, wrong = 0, near = 0;
        double pixel = 2 * 3.2 * tan(0.35) / SIDE;
        for (uint32_t y = 0; y < SIDE; y++) {
            for (uint32_t x = 0; x < SIDE; x++) {
                double u = 0.5 + (x + 0.5 - SIDE / 2) * pixel / 2;
                double t = 0.5 + (y + 0.5 - SIDE / 2) * pixel / 2;
                double alpha = u > 0 && u < 1 && t > 0 && t < 1 ? sample(&m, u, t, 3) : 0;
                int want = alpha >= 0.5, got = depth[y * SIDE + x] > 0;
                there += (uint32_t)got;
                near += fabs(alpha - 0.5) < 0.05;
                wrong += want != got && fabs(alpha - 0.5) >= 0.05;
            }
        }
        free(m.rgba);
        double radius = 24.0 / 64 * 2 / pixel, area = 3.14159265 * radius * radius;
        print_message("alpha test: %u pixels of %.0f, %u wrong, %u ambiguous\n", there, area,
                      wrong, near);
        assert_int_equal(wrong, 0);
        assert_true(fabs(there - area) < 0.03 * area);
        /* The same image without its alpha is completely opaque. */
        camera.position[0] = 3;
        depth = draw_image(&s, &frame, MASU_READBACK_DEPTH, NULL);
        uint32_t whole = 0;
        for (uint32_t i = 0; i < PIXELS; i++) whole += depth[i] > 0;
        assert_true(fabs(whole - 4 / (pixel * pixel)) < 0.03 * whole);
        close_session(&s);
    }
}

/* An alpha-tested surface keeps its coverage with distance. */
static void a_mask_keeps_its_area_with_distance(void **state) {
    (void)state;
    open_textured("test_texture_mask", 0, 1.0f);
    for (double distance = 3; distance < 30; distance *= 1.5) {
        masu_camera camera = {.position = {0, 0, distance}, .forward = {0, 0, -1}, .fov_y = 0.7f};
        masu_frame_desc frame = {.camera = &camera};
        const float *depth = draw_image(&s, &frame, MASU_READBACK_DEPTH, NULL);
        double pixel = 2 * distance * tan(0.35) / SIDE;
        uint32_t there = 0;
        for (uint32_t y = 0; y < SIDE; y++) {
            for (uint32_t x = 0; x < SIDE; x++) {
                there += depth[y * SIDE + x] > 0 && fabs((x + 0.5 - SIDE / 2) * pixel) < 1;
            }
        }
        double area = 3.14159265 * 0.75 * 0.75 / (pixel * pixel);
        assert_true(fabs(there - area) < 0.08 * area + 4);
    }
    close_session(&s);
}

/* ---- Normal maps ----------------------------------------------------------------------------- */

/* Intersection of the pixel's ray from (0, 0, 8) with the unit sphere about (x, 0, 0); 0: none. */
static int hit(uint32_t px, uint32_t py, double center, vec *normal, vec *view) {
    double half_size = tan(0.25);
    vec ray = vec_unit((vec){(2 * (px + 0.5) / SIDE - 1) * half_size,
                         (1 - 2 * (py + 0.5) / SIDE) * half_size, -1});
    vec from = {-center, 0, 8};
    double b = vec_dot(ray, from), disc = b * b - vec_dot(from, from) + 1;
    if (disc < 0) return 0;
    *normal = vec_add(from, vec_scale(ray, -b - sqrt(disc)));
    *view = vec_scale(ray, -1);
    return 1;
}

/* The left sphere's normals are tilted by 30 degrees to its texture's right: east, viewed from
 * outside; the right one, which is mirrored, up. */
static vec bent(int right, vec n) {
    vec east = vec_unit((vec){n.z, 0, -n.x}),
        north = vec_unit((vec){-n.x * n.y, 1 - n.y * n.y, -n.z * n.y});
    return vec_add(vec_scale(right ? north : east, sin(3.14159265358979 / 6)),
                vec_scale(n, cos(3.14159265358979 / 6)));
}

/* light.comp in double precision: only the sun, no metal. The model has its normal along z. */
static double lit(vec n, vec v, vec l, double albedo, double roughness) {
    brdf_surface surface = {{albedo, albedo, albedo}, roughness, 0, 0.5, 0, 0};
    vec x = vec_unit((vec){n.z, 0, -n.x}), y = {n.y * x.z - n.z * x.y, n.z * x.x - n.x * x.z,
                                            n.x * x.y - n.y * x.x};
    const double towards_v[3] = {vec_dot(x, v), vec_dot(y, v), vec_dot(n, v)};
    const double towards_l[3] = {vec_dot(x, l), vec_dot(y, l), vec_dot(n, l)};
    double out[3];
    brdf_eval(masu_split_sum, &surface, towards_v, towards_l, out);
    return out[0];
}

static void normal_maps_lean_as_their_pictures_say(void **state) {
    (void)state;
    masu_camera camera = {.position = {0, 0, 8}, .forward = {0, 0, -1}, .fov_y = 0.5f};
    masu_light light = {.sun_direction = {0.4f, 0.5f, 0.77f}, .sun_color = {2, 2, 2}};
    masu_frame_desc frame = {.camera = &camera, .light = &light};
    vec sun = vec_unit((vec){0.4, 0.5, 0.77});
    open_textured("test_texture_normals", 0, 1.0f);
    static uint32_t normals[PIXELS];
    memcpy(normals, draw_image(&s, &frame, MASU_READBACK_NORMAL, NULL), sizeof normals);
    const uint16_t *hdr = draw_image(&s, &frame, MASU_READBACK_HDR, NULL);
    double worst = 0, sum = 0, dark = 0, dim = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        for (int right = 0; right < 2; right++) {
            vec n, view;
            float got[3];
            if (!hit(i % SIDE, i / SIDE, right ? 1.2 : -1.2, &n, &view)) continue;
            vec want = bent(right, n);
            /* The poles have no east; rims face the viewer, or are not covered. */
            if (fabs(n.y) > 0.85 || vec_dot(n, view) < 0.3 || vec_dot(want, view) < 0.2) continue;
            masu_unpack_normal(normals[i], got);
            vec g = {(double)got[0], (double)got[1], (double)got[2]};
            double degrees = acos(fmin(vec_dot(g, want), 1)) * 57.29578;
            if (degrees > worst) worst = degrees;
            sum += degrees;
            count++;
            double expected = 2 * lit(want, view, sun, 0.4, 0.5);
            double found = half_float(hdr[4 * i + 1]);
            dark = worst_of(dark, fabs(found - expected) / (0.05 + expected));
            dim += fabs(found - expected) / (0.05 + expected);
        }
    }
    print_message("normals of %u pixels: error of %.2f degrees at most, %.2f in the mean; light "
                  "error %.3f at most, %.4f in the mean\n",
                  count, worst, sum / count, dark, dim / count);
    assert_true(count > 2000);
    assert_true(worst < 2.0 && sum / count < 0.6);
    assert_true(dark < 0.15 && dim / count < 0.03);
    close_session(&s);
}

/* ---- Scenes without textures ----------------------------------------------------------------- */

static void a_scene_without_textures_has_nothing_of_them(void **state) {
    (void)state;
    static uint8_t pictures[2][4 * PIXELS];
    for (int denied = 0; denied < 2; denied++) {
        masu_memory_row rows[MEMORY_ROWS];
        masu_session_desc d = test_desc("test_both", SIDE, SIDE);
        d.desc.deny.compressed_textures = (uint32_t)denied;
        d.desc.vulkan.max_anisotropy = denied ? 0.0f : 4.0f;
        open_session(&s, &d);
        draw_rung(&s, 0, pictures[denied]);
        uint32_t n = memory_rows(s.m, rows);
        for (uint32_t i = 0; i < n; i++) {
            int of_textures = !strcmp(rows[i].kind, "texture") || strstr(rows[i].name, "texture");
            assert_true(!of_textures || rows[i].bytes == 0);
            if (!strcmp(rows[i].kind, "buffer")) {
                assert_true(!of_textures);
                if (s.need.unified) assert_string_not_equal(rows[i].name, "staging");
            }
        }
        masu_stats_info stats;
        assert_int_equal(masu_stats(s.m, 0, &stats, NULL), MASU_OK);
        assert_int_equal(stats.draws, 1);
        close_session(&s);
    }
    assert_int_equal(max_difference(pictures[0], pictures[1], sizeof pictures[0]), 0);
}

static void the_demo_draws_finite_pixels_at_every_rung(void **state) {
    (void)state;
    masu_session_desc d = test_desc("textures", 160, 90);
    d.desc.readback = MASU_READBACK_ALL; /* velocities too, for the other set of shaders */
    d.desc.debug.poison = 1;
    open_session(&s, &d);
    for (uint32_t rung = 0; rung < 3; rung++) {
        masu_commands commands;
        masu_readback_image image;
        masu_frame_desc frame = {.rung = rung, .time = rung};
        draw(&s, &frame, &commands, NULL);
        assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_HDR, &image, NULL),
                         MASU_OK);
        const uint16_t *hdr = image.pixels;
        for (uint32_t i = 0; i < 4 * image.width * image.height; i++) {
            assert_true(isfinite(half_float(hdr[i])));
        }
        masu_stats_info stats;
        assert_int_equal(masu_stats(s.m, commands.slot, &stats, NULL), MASU_OK);
        assert_int_equal(stats.replaced, 0);
        assert_int_equal(stats.draws, 6);
    }
    close_session(&s);
}

static void anisotropy_is_taken_and_checked(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_texture_floor", SIDE, SIDE);
    d.no_renderer = true;
    open_session(&s, &d);
    masu_detail detail;
    masu_memory need;
    s.desc.vulkan.max_anisotropy = 0.5f;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "vulkan.max_anisotropy");
    s.desc.vulkan.max_anisotropy = (float)NAN;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_ARGUMENT);
    s.desc.vulkan.max_anisotropy = s.host.most_anisotropy; /* 0 if there is none */
    s.desc.limits.textures = 1;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "limits.textures");
    assert_true(detail.needed == 2 && detail.given == 1);
    s.desc.limits.textures = 2;
    s.desc.limits.texture_bytes = 100;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "limits.texture_bytes");
    s.desc.limits.texture_bytes = 0;
    char error[ERROR_SIZE];
    assert_ok(masu_session_start(&s, error, sizeof error));
    draw_rung(&s, 0, NULL);
    close_session(&s);
}

/* ---- Failures that would be silent ----------------------------------------------------------- */

static char logged[4096];

static void collect(void *user, masu_log_level level, const char *text) {
    (void)user;
    size_t used = strlen(logged);
    snprintf(logged + used, sizeof logged - used, "%d %s\n", (int)level, text);
}

/* Every driver here has block compression and anisotropy; on a CPU, missing ray queries are not
 * reported. */
static void what_is_offered_and_not_enabled_is_told(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_texture_quad", 16, 16);
    char error[ERROR_SIZE];
    d.no_renderer = true;
    for (int given = 0; given < 3; given++) {
        logged[0] = 0;
        open_session(&s, &d);
        s.desc.log = collect;
        if (!s.host.compressed) skip();
        if (!given) s.desc.vulkan.texture_compression_bc = 0, s.desc.vulkan.max_anisotropy = 0.0f;
        if (given == 2)
            s.desc.vulkan.texture_compression_bc = 0, s.desc.deny.compressed_textures = 1;
        assert_ok(masu_session_start(&s, error, sizeof error));
        const char *blocks = strstr(logged, "1 vulkan.texture_compression_bc is 0");
        /* a denied feature is not reported as missing */
        assert_true((blocks != NULL) == (given == 0));
        if (blocks) {
            char numbers[80];
            snprintf(numbers, sizeof numbers, "textures take %llu bytes, compressed %llu",
                     (unsigned long long)masu_scene_texture_bytes(&s.scene, 0),
                     (unsigned long long)masu_scene_texture_bytes(&s.scene, 1));
            assert_non_null(strstr(blocks, numbers));
            assert_non_null(strstr(logged, "2 vulkan.max_anisotropy is 0"));
        }
        assert_null(strstr(logged, "ray_query"));
        close_session(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_quad_shows_the_mip_of_its_distance),
        cmocka_unit_test(fewer_pixels_take_the_mip_of_the_output),
        cmocka_unit_test(upscaled_textures_are_nearer_with_their_bias),
        cmocka_unit_test(blocks_and_decoded_texels_give_one_picture),
        cmocka_unit_test(a_floor_to_the_horizon_is_finite_and_grey),
        cmocka_unit_test(a_mask_has_the_silhouette_of_its_alpha),
        cmocka_unit_test(a_mask_keeps_its_area_with_distance),
        cmocka_unit_test(normal_maps_lean_as_their_pictures_say),
        cmocka_unit_test(a_scene_without_textures_has_nothing_of_them),
        cmocka_unit_test(the_demo_draws_finite_pixels_at_every_rung),
        cmocka_unit_test(anisotropy_is_taken_and_checked),
        cmocka_unit_test(what_is_offered_and_not_enabled_is_told),
    };
    return cmocka_run_group_tests_name("textures", tests, NULL, NULL);
}

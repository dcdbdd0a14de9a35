/* test_specular_textures.c: textures in reflections: ray look-ups against the same quads rendered
 * directly: images as large as the texture and smaller ones, wrap modes, emission, means of distant
 * textures, holes of alpha-tested surfaces; and a scene without trace textures has no cost.
 *
 * The mirror is the plane z = 0, the quads face it from z = 2. A camera at z = 1 sees one in the
 * mirror at distance 3, one at z = 0.5 sees it at distance 1.5 directly: with twice the tangent of
 * its field of view that is the same image flipped left to right. */
#include "support/support.h"
#include "support/files.h"
#include "support/floats.h"

#include "scene/blob.h"
#include "image.h"
#include "scene/scene.h"
#include "reference/tone.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 68, PIXELS = SIDE * SIDE };
#define SCENE "test_mirror_textures"

static masu_session s;
static float mirrored[PIXELS][3], direct[PIXELS][3];

static void open_scene(const char *path) {
    masu_session_desc d = test_desc(SCENE, SIDE, SIDE);
    if (path) d.scene_path = path;
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    d.desc.debug.reference = 1; /* one ray per pixel */
    open_session(&s, &d);
}

static void look(masu_camera camera, float out[PIXELS][3]) {
    masu_frame_desc frame = {.camera = &camera, .cut = 1};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    const uint16_t *hdr = read_image(&s, commands.slot, MASU_READBACK_HDR);
    for (uint32_t i = 0; i < PIXELS; i++) {
        for (uint32_t k = 0; k < 3; k++) out[i][k] = (float)half_float(hdr[4 * i + k]);
    }
}

/* The quad at x, of which 1.8 x 1.8 fill the image, reflected and directly. */
static void look_both(double x) {
    look((masu_camera){.position = {x, 0, 1}, .forward = {0, 0, -1}, .fov_y = 2 * atanf(0.3f)},
         mirrored);
    look((masu_camera){.position = {x, 0, 0.5}, .forward = {0, 0, 1}, .fov_y = 2 * atanf(0.6f)},
         direct);
}

/* Largest and mean difference, and the variance of the direct image, which shows that it has
 * content. */
static double compare(const char *what, double *mean) {
    double worst = 0, sum = 0, first = 0, second = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        uint32_t other = i / SIDE * SIDE + SIDE - 1 - i % SIDE;
        for (uint32_t k = 0; k < 3; k++) {
            double error = fabs((double)mirrored[i][k] - (double)direct[other][k]);
            if (!(error <= worst)) worst = error;
            sum += error;
        }
        first += (double)direct[i][0];
        second += (double)direct[i][0] * (double)direct[i][0];
    }
    *mean = sum / (3.0 * PIXELS);
    first /= PIXELS;
    second = second / PIXELS - first * first;
    print_message("%s: error %.4f at most, %.5f in the mean; variance %.4f\n", what, worst, *mean,
                  second);
    assert_true(second > 0.001);
    return worst;
}

/* ---- gradient.png: red and green rise along x and y ------------------------------------------- */

static int wrapped(int i, int size, uint32_t wrap) {
    if (wrap == 1) return i < 0 ? 0 : i >= size ? size - 1 : i;
    int period = wrap ? 2 * size : size, k = ((i % period) + period) % period;
    return k < size ? k : period - 1 - k;
}

/* Along one side; the image is separable. Mips are means of linear light. */
static double gradient(double at, uint32_t level, uint32_t wrap) {
    int size = 64 >> level;
    double x = at * size - 0.5, sum = 0;
    for (int k = 0; k < 2; k++) {
        int i = wrapped((int)floor(x) + k, size, wrap);
        double texel = 0, part = x - floor(x);
        for (int j = i << level; j < (i + 1) << level; j++)
            texel += masu_ref_srgb_decode(floor(j / 63.0 * 255 + 0.5) / 255);
        sum += texel / (1 << level) * (k ? part : 1 - part);
    }
    return sum;
}

/* The reflection of a quad, against the source of its texture. */
static double compare_source(const char *what, double tile, uint32_t level, const uint32_t wrap[2],
                             double *mean) {
    double worst = 0;
    *mean = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double u = tile * (0.5 + 0.9 * ((i % SIDE + 0.5) / SIDE - 0.5));
        double v = tile * (0.5 - 0.9 * ((i / SIDE + 0.5) / SIDE - 0.5));
        double want[3] = {gradient(u, level, wrap[0]), gradient(v, level, wrap[1]),
                          masu_ref_srgb_decode(128 / 255.0)};
        for (uint32_t k = 0; k < 3; k++) {
            double error = fabs(want[k] - (double)mirrored[i][k]);
            if (!(error <= worst)) worst = error;
            *mean += error / (3.0 * PIXELS);
        }
    }
    print_message("%s: off from the source by %.4f at most, %.5f in the mean\n", what, worst,
                  *mean);
    return worst;
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

static uint8_t *blob;
static size_t blob_bytes;
static masu_scene scene; /* as read by read_blob */
static masu_scene_view view;

static void read_blob(void) {
    masu_detail detail;
    free(blob);
    blob = read_file(scene_path(SCENE), &blob_bytes);
    assert_int_equal(masu_scene_bind(blob, blob_bytes, &scene, &detail), MASU_OK);
    view = masu_scene_view_of(&scene);
}

/* Opens the blob after direct changes. */
static void open_changed(void) {
    masu_blob_header h;
    memcpy(&h, blob, sizeof h);
    h.hash = masu_fnv1a64(blob + sizeof h, blob_bytes - sizeof h);
    memcpy(blob, &h, sizeof h);
    write_bytes("changed.masu", blob, blob_bytes);
    open_scene(in_scratch("changed.masu"));
}

static void *find(uint32_t kind) {
    masu_blob_header h;
    memcpy(&h, blob, sizeof h);
    for (uint32_t i = 0; i < h.section_count; i++) {
        masu_blob_section *row = (void *)(blob + sizeof h + i * sizeof *row);
        if (row->kind == kind) return blob + row->offset;
    }
    fail_msg("no section %u", kind);
    return NULL;
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void a_mirror_shows_textures_as_they_are(void **state) {
    (void)state;
    double mean;
    open_scene(NULL);
    double most = on_gpu(&s) ? 0.1 : 0.08; /* blocks are decoded within the errors that a format
                                              allows */
    assert_int_equal(masu_scene_data_of(&s.scene)->trace_colors, 4);
    assert_int_equal(masu_scene_data_of(&s.scene)->trace_textures, 5); /* and a mean of roughness */
    /* The trace texture has all texels of the texture, 8 bits each. The direct rendering uses
     * compressed blocks, which have a larger error. */
    static const uint32_t repeat[2] = {0, 0};
    look_both(-12);
    assert_true(compare_source("64 texels", 1, 0, repeat, &mean) < 0.01);
    assert_true(compare("64 texels", &mean) < most);
    assert_true(mean < 0.02);
    look_both(-6); /* 2.7 texels per pixel: the mip of two; direct rendering mixes it with the
                      next */
    /* At the seam from 1 to 0 the smallest error of a direction is visible. */
    assert_true(compare_source("three tiles", 3, 1, repeat, &mean) < 0.4);
    assert_true(mean < 0.01);
    (void)compare("three tiles", &mean);
    assert_true(mean < 0.05);
    look_both(0); /* radiance 2; as above, blocks have a larger error */
    for (uint32_t i = 0; i < PIXELS; i++) {
        for (uint32_t k = 0; k < 3; k++) mirrored[i][k] /= 2, direct[i][k] /= 2;
    }
    assert_true(compare_source("what glows", 1, 0, repeat, &mean) < 0.01);
    assert_true(compare("what glows", &mean) < most);
    assert_true(mean < 0.02);
    /* A quarter of the texels in each direction: the resolution of a pixel, and a quarter of that
     * close up. */
    look_both(12);
    assert_true(compare("256 texels by 64", &mean) < most);
    assert_true(mean < 0.012);
    look((masu_camera){.position = {12, 0, 1}, .forward = {0, 0, -1}, .fov_y = 2 * atanf(0.075f)},
         mirrored);
    look((masu_camera){.position = {12, 0, 0.5}, .forward = {0, 0, 1}, .fov_y = 2 * atanf(0.15f)},
         direct);
    (void)compare("the same close up", &mean);
    assert_true(mean < 0.05);
    close_session(&s);
}

static void textures_wrap_as_they_do_when_drawn(void **state) {
    (void)state;
    static float before[PIXELS][3];
    for (uint32_t wrap = 1; wrap < 3; wrap++) {
        double mean, moved = 0;
        char what[32];
        read_blob();
        masu_blob_texture_set *sets = find(MASU_BLOB_TEXTURE_SETS);
        for (uint32_t i = 0; i < masu_scene_data_of(&scene)->texture_sets; i++) {
            sets[i].wrap[0] = wrap;
            sets[i].wrap[1] = 3 - wrap;
        }
        open_changed();
        look_both(-6);
        snprintf(what, sizeof what, "wrap %u and %u", wrap, 3 - wrap);
        const uint32_t wraps[2] = {wrap, 3 - wrap};
        assert_true(compare_source(what, 3, 1, wraps, &mean) < 0.06);
        assert_true(mean < 0.01);
        (void)compare(what, &mean);
        assert_true(mean < 0.06);
        for (uint32_t i = 0; i < PIXELS; i++)
            moved += fabs((double)mirrored[i][0] - (double)before[i][0]) / PIXELS;
        assert_true(moved > 0.1); /* different from black, and from the other direction */
        memcpy(before, mirrored, sizeof before);
        close_session(&s);
    }
}

static void what_is_far_is_its_mean(void **state) {
    (void)state;
    /* A metre has a whole texture, and a pixel is half a metre. */
    read_blob();
    masu_blob_instance *instances = find(MASU_BLOB_INSTANCES);
    uint32_t far = 0;
    while (!(instances[far].transform[3] > 99)) far++;
    const masu_blob_mesh *mesh = &view.meshes[instances[far].mesh];
    const masu_blob_material *m = &view.materials[view.primitives[mesh->first_primitive].material];
    uint32_t texture = view.texture_sets[m->texture_set].texture[MASU_SLOT_BASE];
    const masu_blob_trace_texture *t = view.trace_textures;
    while (t->texture != texture || t->layer != (m->layers & 255u)) t++;
    uint32_t texel = view.trace_texels[t->first + masu_blob_trace_texels(t->width, t->height) - 1];
    double sum[3] = {0}, square[3] = {0};
    open_scene(NULL);
    look((masu_camera){.position = {100, 0, 1}, .forward = {0, 0, -1}, .fov_y = 2 * atanf(0.3f)},
         mirrored);
    for (uint32_t i = 0; i < PIXELS; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            sum[k] += (double)mirrored[i][k] / PIXELS;
            square[k] += (double)mirrored[i][k] * (double)mirrored[i][k] / PIXELS;
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        double root = (texel >> 8 * k & 255) / 255.0, want = root * root;
        double spread = sqrt(fmax(square[k] - sum[k] * sum[k], 0));
        print_message("far, channel %u: %.4f of %.4f, deviation %.4f\n", k, sum[k], want, spread);
        assert_true(fabs(sum[k] - want) < 0.03 * want);
        assert_true(spread < 0.1 * want);
    }
    close_session(&s);
}

static int is_panel(const float c[3]) { return c[0] > 1.5f && c[1] < 0.2f; }

static void through_holes_a_mirror_shows_what_is_behind(void **state) {
    (void)state;
    uint32_t holes = 0, discs = 0, differ = 0;
    open_scene(NULL);
    look_both(6);
    for (uint32_t i = 0; i < PIXELS; i++) {
        uint32_t other = i / SIDE * SIDE + SIDE - 1 - i % SIDE;
        holes += is_panel(mirrored[i]);
        discs += mirrored[i][1] > 0.1f && mirrored[i][0] < 1.5f;
        differ += is_panel(mirrored[i]) != is_panel(direct[other]);
    }
    /* The disc has a radius of 24 of 64 texels, of which 57.6 fill the image. */
    double want = 3.14159265 * 24 * 24 / (57.6 * 57.6);
    print_message("holes: %.4f, disc: %.4f of %.4f; %u pixels are not as drawn\n",
                  (double)holes / PIXELS, (double)discs / PIXELS, want, differ);
    assert_int_equal(holes + discs, PIXELS);
    assert_true(fabs((double)discs / PIXELS - want) < 0.02);
    assert_true(differ <= PIXELS / 100);
    close_session(&s);

    /* Without the flag for alpha testing there are none. */
    read_blob();
    masu_blob_material *materials = find(MASU_BLOB_MATERIALS);
    for (uint32_t i = 0; i < masu_scene_count(&scene, MASU_SCENE_MATERIAL); i++)
        materials[i].flags &= ~(uint32_t)MASU_MATERIAL_IS_MASK;
    open_changed();
    look_both(6);
    for (uint32_t i = 0; i < PIXELS; i++) assert_false(is_panel(mirrored[i]));
    close_session(&s);
}

static void without_pictures_factors_are_seen(void **state) {
    (void)state;
    open_scene(scene_path("test_mirror_plain"));
    assert_int_equal(masu_scene_data_of(&s.scene)->trace_colors, 0);
    assert_int_equal(masu_scene_data_of(&s.scene)->trace_textures,
                     1); /* a mean of roughness, which no ray looks up */
    look_both(-12);
    for (uint32_t i = 0; i < PIXELS; i++) {
        for (uint32_t k = 0; k < 3; k++)
            assert_true(fabsf(mirrored[i][k] - mirrored[0][0]) < 0.01f);
    }
    assert_true(mirrored[0][0] > 0.9f);
    close_session(&s);
}

/* A mirror's ray has no noise: with a ray for each fourth pixel, and each pixel's history kept from
 * frame to frame, the result is constant over any number of frames. */
static void a_mirror_looked_at_for_long_shows_the_same_to_the_bit(void **state) {
    (void)state;
    static uint16_t first[4 * PIXELS];
    masu_session_desc d = test_desc(SCENE, SIDE, SIDE);
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    uint32_t changed = 0, varied = 0;
    for (uint32_t k = 0; k < 64; k++) {
        masu_frame_desc frame = {.time_step = 1.0f / 60.0f, .cut = k == 0};
        masu_commands commands;
        draw(&s, &frame, &commands, NULL);
        const uint16_t *hdr = read_image(&s, commands.slot, MASU_READBACK_HDR);
        if (k == 24) memcpy(first, hdr, sizeof first);
        for (uint32_t i = 0; k > 24 && i < 4 * PIXELS; i++) changed += hdr[i] != first[i];
    }
    close_session(&s);
    for (uint32_t i = 4; i < 4 * PIXELS; i++) varied += first[i] != first[i - 4];
    print_message("%u values changed in 39 frames; %u differ from their neighbours'\n", changed,
                  varied);
    assert_int_equal(changed, 0);
    assert_true(varied > PIXELS / 4);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mirror_shows_textures_as_they_are),
        cmocka_unit_test(textures_wrap_as_they_do_when_drawn),
        cmocka_unit_test(what_is_far_is_its_mean),
        cmocka_unit_test(through_holes_a_mirror_shows_what_is_behind),
        cmocka_unit_test(without_pictures_factors_are_seen),
        cmocka_unit_test(a_mirror_looked_at_for_long_shows_the_same_to_the_bit),
    };
    return cmocka_run_group_tests_name("specular_textures", tests, make_scratch, remove_scratch);
}

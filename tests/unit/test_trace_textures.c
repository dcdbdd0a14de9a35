/* test_trace_textures.c: the small textures for rays: texels against the images that they were made
 * from, the means of roughness and metallic, omitted textures, the numbers in the runtime's buffer,
 * and the rules of their sections, each broken separately. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "bake/write/blob.h"
#include "bake/mesh/bvh.h"
#include "bake/build/look.h"
#include "bake/mesh/shape.h"
#include "bake/mesh/trace.h"
#include "bake/texture/texture.h"
#include "bake/texture/trace_texture.h"
#include "masu.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"
#include "scene/trace_scene.h"
#include "support/floats.h"
#include "support/random.h"

enum { NOISE, LEAF, ROUGH, GLOW, UNSEEN, PICTURES };
static const uint32_t sizes[PICTURES][2] = {{128, 64}, {64, 64}, {32, 32}, {16, 16}, {8, 8}};
static uint8_t pictures[PICTURES][128 * 64 * 4]; /* B G R A */

static void draw_pictures(void) {
    uint64_t seed = 11;
    for (uint32_t p = 0; p < PICTURES; p++) {
        for (uint32_t i = 0; i < sizes[p][0] * sizes[p][1]; i++) {
            uint8_t *t = &pictures[p][4 * i];
            for (uint32_t k = 0; k < 3; k++) t[k] = (uint8_t)support_random_in(&seed, 20, 235);
            double x = i % sizes[p][0] - 31.5, y = i / sizes[p][0] - 31.5;
            t[3] = p == LEAF && x * x + y * y > 400 ? 0 : 255;
        }
    }
}

/* A plane with these maps (NONE: none). */
static void add_plane(masu_bake_content *c, uint32_t base, uint32_t rough, uint32_t glow, float x,
                      bool traced) {
    masu_bake_content piece = {0};
    masu_bake_residence residence = {0};
    masu_bake_override o = {.roughness = true, .metallic = true, .emissive = true};
    masu_bake_overrides overrides = {&o, 1};
    o.value.roughness = 0.5f;
    o.value.metallic = 0.8f;
    for (int k = 0; k < 3; k++) o.value.emissive[k] = glow == MASU_BLOB_NONE ? 0.0f : 3.0f;
    o.maps = masu_bake_no_maps();
    o.maps.image[MASU_BAKE_BASE] = base;
    o.maps.image[MASU_BAKE_EMISSIVE] = glow;
    o.maps.image[MASU_BAKE_ROUGHNESS] = o.maps.image[MASU_BAKE_METALLIC] = rough;
    o.maps.channel[MASU_BAKE_ROUGHNESS] = 1; /* green; metallic in red */
    o.map[MASU_BAKE_BASE] = base != MASU_BLOB_NONE;
    o.map[MASU_BAKE_EMISSIVE] = glow != MASU_BLOB_NONE;
    o.map[MASU_BAKE_ROUGHNESS] = o.map[MASU_BAKE_METALLIC] = rough != MASU_BLOB_NONE;
    masu_bake_plane(&piece, 1, 1, 1);
    masu_bake_affine at = masu_bake_translation(masu_bake_v3((double)x, 0, 0));
    assert_null(masu_bake_place(c, &piece, &residence, &at, &overrides, NULL));
    masu_bake_content_release(&piece);
    uint8_t said = traced ? MASU_BAKE_TRACED_YES : MASU_BAKE_TRACED_NO;
    masu_bake_append(&c->traced, &said, 1);
}

static masu_bake_content make(uint32_t side) {
    masu_bake_content c = {.pictures_wanted = true, .picture_side = side};
    masu_bake_reflections wanted = {.wanted = true, .smallest = -1, .cutoff = 0.5, .distance = 100};
    masu_bake_bvh_report report;
    uint32_t image[PICTURES];
    draw_pictures();
    for (uint32_t p = 0; p < PICTURES; p++) {
        char name[8];
        snprintf(name, sizeof name, "p%u", p);
        masu_bake_image about = {.raw_width = sizes[p][0],
                                 .raw_height = sizes[p][1],
                                 .data_bytes = 4 * (uint64_t)sizes[p][0] * sizes[p][1]};
        image[p] = masu_bake_add_image(&c, name, &about, pictures[p]);
    }
    add_plane(&c, image[NOISE], MASU_BLOB_NONE, MASU_BLOB_NONE, 0, true);
    add_plane(&c, image[LEAF], image[ROUGH], MASU_BLOB_NONE, 2, true);
    add_plane(&c, MASU_BLOB_NONE, MASU_BLOB_NONE, image[GLOW], 4, true);
    add_plane(&c, image[UNSEEN], MASU_BLOB_NONE, MASU_BLOB_NONE, 6, false);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box bounds = masu_bake_bounds(&c, &identity);
    masu_bake_look look = masu_bake_default_look();
    masu_bake_build_look(&look, &bounds, &c);
    assert_true(masu_bake_make_textures(&c, NULL));
    masu_bake_sort_instances(&c);
    assert_true(masu_bake_make_bvh(&c, &wanted, &report));
    masu_bake_trace_textures(&c);
    return c;
}

static masu_bake_buffer blob;
static masu_scene scene;
static masu_scene_view view;

static void bind(const masu_bake_content *c) {
    masu_detail detail;
    blob.bytes = 0;
    masu_bake_make_blob(c, &blob);
    if (masu_scene_bind(blob.data, blob.bytes, &scene, &detail) != MASU_OK)
        fail_msg("%s", detail.text);
    view = masu_scene_view_of(&scene);
}

/* The trace texture of a material's map with these flags set, or NULL. */
static const masu_blob_trace_texture *picture_of(uint32_t slot, uint32_t width) {
    for (uint32_t i = 0; i < masu_scene_count(&scene, MASU_SCENE_MATERIAL); i++) {
        const masu_blob_material *m = &view.materials[i];
        if (!(m->flags & 1u << slot)) continue;
        uint32_t texture = view.texture_sets[m->texture_set].texture[slot];
        if (view.textures[texture].width != width) continue;
        for (uint32_t k = 0; k < masu_scene_data_of(&scene)->trace_textures; k++) {
            const masu_blob_trace_texture *t = &view.trace_textures[k];
            if (t->texture == texture && t->layer == (m->layers >> 8 * slot & 255u)) return t;
        }
    }
    return NULL;
}

static double linear(uint32_t byte) {
    double v = byte / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

static double stored(const masu_blob_trace_texture *t, uint64_t texel, uint32_t channel) {
    double root = (view.trace_texels[t->first + texel] >> 8 * channel & 255u) / 255.0;
    return channel < 3 ? root * root : root;
}

/* Every mip of an image against means of the source, in linear light. */
static void compare(const masu_blob_trace_texture *t, uint32_t p) {
    uint64_t at = 0;
    double worst = 0;
    for (uint32_t w = t->width, h = t->height;; w = w > 1 ? w / 2 : 1, h = h > 1 ? h / 2 : 1) {
        uint32_t across = sizes[p][0] / w, along = sizes[p][1] / h;
        for (uint32_t i = 0; i < w * h; i++, at++) {
            for (uint32_t k = 0; k < 3; k++) {
                double sum = 0;
                for (uint32_t j = 0; j < across * along; j++) {
                    uint32_t x = i % w * across + j % across, y = i / w * along + j / across;
                    sum += linear(pictures[p][4 * (y * sizes[p][0] + x) + 2 - k]);
                }
                double off = sqrt(sum / (across * along)) - sqrt(stored(t, at, k));
                worst = worst_of(worst, fabs(off) * 255);
            }
        }
        if (w == 1 && h == 1) break;
    }
    print_message("%ux%u of %ux%u: error %.3f of a step\n", t->width, t->height, sizes[p][0],
                  sizes[p][1], worst);
    assert_int_equal(at, masu_blob_trace_texels(t->width, t->height));
    assert_true(worst < 0.51);
}

static void pictures_are_their_textures_made_small(void **state) {
    (void)state;
    static const uint32_t sides[] = {1, 16, 64, 256};
    for (uint32_t n = 0; n < 4; n++) {
        uint32_t side = sides[n];
        masu_bake_content c = make(side);
        bind(&c);
        assert_int_equal(masu_scene_data_of(&scene)->trace_colors,
                         3); /* and none of the untraced plane */
        assert_int_equal(masu_scene_data_of(&scene)->trace_textures, 4);
        const masu_blob_trace_texture *noise = picture_of(MASU_SLOT_BASE, 128);
        const masu_blob_trace_texture *leaf = picture_of(MASU_SLOT_BASE, 64);
        const masu_blob_trace_texture *glow = picture_of(MASU_SLOT_EMISSIVE, 16);
        assert_null(picture_of(MASU_SLOT_BASE, 8));
        assert_non_null(noise);
        assert_non_null(leaf);
        assert_non_null(glow);
        assert_int_equal(noise->width, side < 128 ? side : 128);
        assert_int_equal(noise->height, side < 2 ? 1 : side < 128 ? side / 2 : 64);
        assert_int_equal(leaf->width, side < 64 ? side : 64);
        assert_int_equal(glow->width, side < 16 ? side : 16);
        compare(noise, NOISE);
        compare(glow, GLOW);
        /* A mask keeps its coverage: a disc with a radius of 20 of 64 texels. */
        double there = 0, texels = leaf->width * leaf->height;
        for (uint32_t i = 0; i < texels; i++) there += stored(leaf, i, 3) >= 0.5;
        print_message("mask: %.3f of %.3f\n", there / texels, 3.14159265 * 400 / 4096);
        if (side > 1) assert_true(fabs(there / texels - 3.14159265 * 400 / 4096) < 0.05);
        for (uint32_t i = 0; i < masu_blob_trace_texels(noise->width, noise->height); i++)
            assert_true(stored(noise, i, 3) == 1.0);
        masu_bake_content_release(&c);
    }
}

static void roughness_and_metallic_are_their_means(void **state) {
    (void)state;
    masu_bake_content c = make(16);
    bind(&c);
    double mean[2] = {0}, least = 1;
    for (uint32_t i = 0; i < 32 * 32; i++) {
        mean[0] += pictures[ROUGH][4 * i + 1] / 255.0 / 1024;
        mean[1] += pictures[ROUGH][4 * i + 2] / 255.0 / 1024;
        least = fmin(least, pictures[ROUGH][4 * i + 1] / 255.0);
    }
    const masu_blob_trace_texture *t = picture_of(MASU_SLOT_SURFACE, 32);
    assert_non_null(t);
    assert_int_equal(t->width * t->height, 1);
    assert_float_equal(stored(t, 0, 0), mean[0], 0.008);
    assert_float_equal(stored(t, 0, 1), mean[1], 0.008);
    /* The glossiest value is the minimum of the map. Other surfaces have a roughness of 0.5. */
    print_message("glossiest %.4f of %.4f\n", (double)masu_scene_data_of(&scene)->glossiest,
                  0.5 * least);
    assert_true(fabs((double)masu_scene_data_of(&scene)->glossiest - 0.5 * least) < 0.002);

    /* Materials in the buffer of the device. */
    masu_trace_plan plan = masu_trace_layout(masu_scene_data_of(&scene));
    uint32_t found[3] = {0};
    for (uint32_t i = 0; i < masu_scene_count(&scene, MASU_SCENE_MATERIAL); i++) {
        struct masu_trace_material m;
        masu_trace_write(masu_scene_data_of(&scene), &view, 16 * (plan.materials + 4 * i), sizeof m,
                         (void *)&m);
        int rough = view.materials[i].flags & 1u << MASU_SLOT_SURFACE;
        assert_float_equal(m.base_color[3], rough ? 0.5 * mean[0] : 0.5, 0.005);
        assert_float_equal(m.emissive[3], rough ? 0.8 * mean[1] : 0.8, 0.008);
        for (uint32_t k = 0; k < 2; k++) {
            uint32_t slot = k ? MASU_SLOT_EMISSIVE : MASU_SLOT_BASE, words[4];
            if (m.maps[k] == MASU_TRACE_NONE) continue;
            const masu_blob_trace_texture *p = &view.trace_textures[m.maps[k]];
            assert_int_equal(p->texture,
                             view.texture_sets[view.materials[i].texture_set].texture[slot]);
            masu_trace_write(masu_scene_data_of(&scene), &view, 16 * (plan.pictures + m.maps[k]),
                             16, (void *)words);
            assert_int_equal(words[0], p->first);
            assert_int_equal(words[1], p->width | p->height << 16);
            uint32_t last = p->first + (uint32_t)masu_blob_trace_texels(p->width, p->height) - 1;
            masu_trace_write(masu_scene_data_of(&scene), &view,
                             16 * plan.texels + 4 * (uint64_t)last, 4, (void *)words);
            assert_int_equal(words[0], view.trace_texels[last]);
            found[k]++;
        }
        found[2] += rough != 0;
    }
    assert_int_equal(found[0], 2);
    assert_int_equal(found[1], 1);
    assert_int_equal(found[2], 1);
    masu_bake_content_release(&c);
}

static void size_0_keeps_no_colours(void **state) {
    (void)state;
    masu_bake_content c = make(0);
    bind(&c);
    assert_int_equal(masu_scene_data_of(&scene)->trace_colors, 0);
    assert_int_equal(masu_scene_data_of(&scene)->trace_textures, 1);
    assert_int_equal(masu_scene_data_of(&scene)->trace_texels, 1);
    masu_bake_content_release(&c);
}

/* ---- Rules ----------------------------------------------------------------------------------- */

static masu_bake_content good;

static masu_blob_section *row_of(uint32_t kind) {
    masu_blob_header *h = (void *)blob.data;
    masu_blob_section *rows = (void *)(blob.data + sizeof *h);
    for (uint32_t i = 0; i < h->section_count; i++)
        if (rows[i].kind == kind) return &rows[i];
    fail_msg("no section %u", kind);
    return NULL;
}

static void assert_refused(const char *what, uint64_t element, int line) {
    masu_blob_header *h = (void *)blob.data;
    masu_detail detail;
    h->hash = masu_fnv1a64(blob.data + sizeof *h, blob.bytes - sizeof *h);
    masu_scene refused;
    if (masu_scene_bind(blob.data, blob.bytes, &refused, &detail) == MASU_OK)
        fail_msg("line %d: accepted", line);
    if (strcmp(detail.what, what) || detail.given != element)
        fail_msg("line %d: rejected as %s", line, detail.text);
}

#define ROW                                                                                        \
    ((masu_blob_trace_texture *)(void *)(blob.data + row_of(MASU_BLOB_TRACE_TEXTURES)->offset))
#define REFUSED(what, element, ...)                                                                \
    do {                                                                                           \
        bind(&good);                                                                               \
        __VA_ARGS__;                                                                               \
        assert_refused(what, element, __LINE__);                                                   \
    } while (0)

static void rules_of_pictures_hold(void **state) {
    (void)state;
    good = make(16);
    REFUSED("trace textures", 0, ROW[0].texture = masu_scene_data_of(&scene)->texture_arrays);
    REFUSED("trace textures", 3, ROW[3].texture = UINT32_MAX);
    REFUSED("trace textures", 1, ROW[1].layer = view.textures[ROW[1].texture].layers);
    REFUSED("trace textures", 1, ROW[1].layer = UINT32_MAX);
    REFUSED("trace textures", 1, ROW[1].texture = ROW[0].texture, ROW[1].layer = ROW[0].layer);
    REFUSED("trace textures", 1, ROW[0].texture = ROW[1].texture + 1, ROW[0].layer = 0);
    REFUSED("trace textures", 0, ROW[0].width = 0);
    REFUSED("trace textures", 2, ROW[2].height = 0);
    REFUSED("trace textures", 0, ROW[0].width = MASU_TRACE_TEXTURE_MAX + 1);
    REFUSED("trace textures", 0, ROW[0].height = UINT32_MAX);
    REFUSED("trace textures", 0, ROW[0].first = 1);
    REFUSED("trace textures", 1, ROW[0].width *= 2);
    REFUSED("trace textures", 2, ROW[2].first--);
    REFUSED("trace texels", masu_scene_data_of(&scene)->trace_texels,
            row_of(MASU_BLOB_TRACE_TEXELS)->count--);
    REFUSED("trace texels", ROW[3].first, row_of(MASU_BLOB_TRACE_TEXTURES)->count--);
    masu_bake_content_release(&good);

    good = make(16); /* without some of the sections */
    masu_bake_release(&good.section[MASU_BLOB_TRACE_TEXELS]);
    blob.bytes = 0;
    masu_bake_make_blob(&good, &blob);
    assert_refused("trace textures", 0, __LINE__);
    masu_bake_content_release(&good);
    good = make(16);
    for (uint32_t k = MASU_BLOB_TRACE_NODES; k <= MASU_BLOB_TRACE_INSTANCES; k++)
        masu_bake_release(&good.section[k]);
    blob.bytes = 0;
    masu_bake_make_blob(&good, &blob);
    assert_refused("trace textures", 0, __LINE__);
    masu_bake_content_release(&good);
    masu_bake_release(&blob);
}

static void base_at(const masu_bake_trace *trace, double u, float out[3]) {
    const float from[3] = {(float)(u - 0.5), 1, 0.11f}, down[3] = {0, -1, 0};
    masu_bake_hit hit;
    assert_true(masu_bake_trace_ray(trace, from, down, 10, &hit));
    memcpy(out, hit.albedo, sizeof hit.albedo);
}

/* Rays of masu-bake: addressing outside the image follows its texture set. The plane has it once,
 * then from -1 to 2. */
static void rays_see_textures_repeated_held_and_mirrored(void **state) {
    (void)state;
    masu_bake_content c = make(16);
    masu_bake_trace *once = masu_bake_trace_make(&c);
    assert_non_null(once);
    float *uv = MASU_BAKE_ARRAY(&c, MASU_BLOB_TEXCOORDS, float);
    uint64_t count = masu_bake_count(&c, MASU_BLOB_TEXCOORDS);
    for (uint64_t i = 0; i < count; i++) uv[2 * i] = 3.0f * uv[2 * i] - 1.0f;
    masu_blob_texture_set *sets =
        MASU_BAKE_ARRAY(&c, MASU_BLOB_TEXTURE_SETS, masu_blob_texture_set);
    for (uint32_t wrap = 0; wrap < 3; wrap++) {
        for (uint64_t i = 0; i < masu_bake_count(&c, MASU_BLOB_TEXTURE_SETS); i++)
            sets[i].wrap[0] = (uint8_t)wrap;
        masu_bake_trace *thrice = masu_bake_trace_make(&c);
        assert_non_null(thrice);
        for (int k = -64; k < 128; k++) { /* the centres of texels */
            double u = (k + 0.5) / 64, within = u - floor(u);
            if (wrap == 1) within = fmin(fmax(u, 0.5 / 64), 1 - 0.5 / 64);
            if (wrap == 2 && (u < 0 || u > 1)) within = 1 - within;
            float is[3], ought[3];
            base_at(thrice, (u + 1) / 3, is);
            base_at(once, within, ought);
            if (memcmp(is, ought, sizeof is)) fail_msg("wrap %u: texel %d is another", wrap, k);
        }
        masu_bake_trace_release(thrice);
    }
    masu_bake_trace_release(once);
    masu_bake_content_release(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_their_textures_made_small),
        cmocka_unit_test(roughness_and_metallic_are_their_means),
        cmocka_unit_test(size_0_keeps_no_colours),
        cmocka_unit_test(rules_of_pictures_hold),
        cmocka_unit_test(rays_see_textures_repeated_held_and_mirrored),
    };
    return cmocka_run_group_tests_name("trace_textures", tests, NULL, NULL);
}

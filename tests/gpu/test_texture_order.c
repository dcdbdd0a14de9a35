/* test_texture_order.c: polygons are drawn in sweeps (without textures, with textures,
 * alpha-tested), while the commands with the instance counts are in another order, mesh by mesh,
 * and exist twice with occlusion culling. A wrong command draws the wrong mesh.
 *
 * The scene has all three kinds side by side, also within one mesh. It is rendered unchanged, with
 * alpha tests that cut nothing away, and with its textures removed in memory: the last is one sweep
 * in the order of the commands, so its depth is the reference for the second. */
#include "support/files.h"
#include "support/support.h"

#include "scene/blob.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

enum { W = 96, H = 66, PIXELS = W * H, FRAMES = 36 };
enum { BOTH, FRUSTUM, OCCLUSION, NEITHER, WAYS }; /* rungs: stages of culling that are on */
enum { MAPPED, WHOLE, PLAIN, VARIANTS };

/* On drivers after the first a third of the frames, on the same path. */
static uint32_t frames(void) { return trials(FRAMES, FRAMES, FRAMES / 3); }

static uint32_t albedo[2][PIXELS];
static float depth[2][PIXELS], kept[VARIANTS][FRAMES][PIXELS];

static void change_materials(masu_session *s, int variant) {
    masu_blob_header *header = s->blob;
    masu_scene_view v = masu_scene_view_of(&s->scene);
    masu_blob_material *materials =
        (masu_blob_material *)(void *)((uint8_t *)s->blob +
                                       ((const uint8_t *)v.materials - (const uint8_t *)s->blob));
    uint32_t ways[3] = {0, 0, 0};
    for (uint32_t i = 0; i < masu_scene_count(&s->scene, MASU_SCENE_MATERIAL); i++) {
        masu_blob_material *m = &materials[i];
        int maps = (m->flags & MASU_MATERIAL_HAS_MAPS) != 0;
        ways[maps ? 1 + !!(m->flags & MASU_MATERIAL_IS_MASK) : 0]++;
        if (variant != MAPPED) m->flags &= (1u << MASU_MATERIAL_CUTOFF_SHIFT) - 1;
        if (variant == PLAIN) m->flags = m->layers = m->texture_set = 0;
    }
    assert_true(ways[0] && ways[1] && ways[2]);
    header->hash =
        masu_fnv1a64((const uint8_t *)s->blob + sizeof *header, header->bytes - sizeof *header);
    masu_detail detail;
    assert_int_equal(masu_scene_bind(s->blob, header->bytes, &s->scene, &detail), MASU_OK);
}

static void open_variant(masu_session *s, int variant, uint32_t readback) {
    char error[ERROR_SIZE];
    masu_session_desc d = test_desc("test_texture_order", W, H);
    d.no_renderer = true;
    d.desc.readback = MASU_READBACK_ALBEDO | MASU_READBACK_DEPTH | readback;
    d.desc.rung_count = WAYS;
    d.desc.rungs[OCCLUSION].frustum = d.desc.rungs[NEITHER].frustum = MASU_OFF;
    d.desc.rungs[FRUSTUM].occlusion = d.desc.rungs[NEITHER].occlusion = MASU_OFF;
    open_session(s, &d);
    change_materials(s, variant);
    assert_ok(masu_session_start(s, error, sizeof error));
}

/* All culling modes, along the camera's path; depth is stored in kept[variant]. */
static void draw_variant(int variant, uint32_t readback) {
    masu_session s;
    uint64_t drawn[WAYS] = {0};
    open_variant(&s, variant, readback);
    assert_int_equal(masu_scene_data_of(&s.scene)->masks, variant != PLAIN);
    for (uint32_t frame = 0; frame < frames(); frame++) {
        for (uint32_t way = WAYS; way-- > 0;) { /* the others are compared with NEITHER */
            masu_frame_desc f = {.rung = way, .time = 3.0 * frame / frames()};
            masu_commands commands;
            masu_stats_info stats;
            uint32_t to = way != NEITHER;
            draw(&s, &f, &commands, NULL);
            memcpy(albedo[to], read_image(&s, commands.slot, MASU_READBACK_ALBEDO),
                   sizeof albedo[to]);
            memcpy(depth[to], read_image(&s, commands.slot, MASU_READBACK_DEPTH), sizeof depth[to]);
            assert_int_equal(masu_stats(s.m, commands.slot, &stats, NULL), MASU_OK);
            drawn[way] += stats.triangles;
            if (memcmp(albedo[0], albedo[to], sizeof albedo[0]) ||
                memcmp(depth[0], depth[to], sizeof depth[0])) {
                fail_msg("frame %u differs, stages %u", frame, way);
            }
        }
        memcpy(kept[variant][frame], depth[0], sizeof depth[0]);
    }
    assert_true(drawn[FRUSTUM] < drawn[NEITHER]);
    assert_true(drawn[BOTH] < drawn[FRUSTUM]);
    assert_true(drawn[OCCLUSION] < drawn[NEITHER]);
    close_session(&s);
}

/* Number of pixels with different depths: two shaders may round differently. */
static uint32_t differing(int a, int b) {
    uint32_t count = 0;
    for (uint32_t f = 0; f < frames(); f++) {
        for (uint32_t i = 0; i < PIXELS; i++) {
            float p = kept[a][f][i], q = kept[b][f][i];
            count += !(fabsf(p - q) <= 1e-4f * fmaxf(p, q));
        }
    }
    return count;
}

static void sweeps_find_their_commands(void **state) {
    (void)state;
    for (int variant = 0; variant < VARIANTS; variant++) draw_variant(variant, 0);
    uint32_t wrong = differing(WHOLE, PLAIN), holes = differing(MAPPED, WHOLE);
    print_message("of %u pixels: %u are not as without textures, masks open %u\n",
                  frames() * (uint32_t)PIXELS, wrong, holes);
    assert_true(wrong < frames() * PIXELS / 2000);
    assert_true(holes > frames() * PIXELS / 500);
}

/* With the other set of shaders. */
static void sweeps_find_their_commands_with_velocities(void **state) {
    (void)state;
    draw_variant(WHOLE, MASU_READBACK_VELOCITY);
    draw_variant(PLAIN, MASU_READBACK_VELOCITY);
    assert_true(differing(WHOLE, PLAIN) < frames() * PIXELS / 2000);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sweeps_find_their_commands),
        cmocka_unit_test(sweeps_find_their_commands_with_velocities),
    };
    return cmocka_run_group_tests_name("texture_order", tests, NULL, NULL);
}

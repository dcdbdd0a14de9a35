/* test_bounce.c: live probes in whole frames, under the validation layer: a white furnace, two
 * rooms with a door and a lamp, a corner under baked daylight. The probes are read in device
 * memory. */
#include "support/support.h"
#include "support/files.h"
#include "support/gltf_file.h"
#include "support/random.h"

#include "reference/brdf.h"

#include "bake/light/probe_light.h"
#include "device/bind.h"
#include "renderer.h"
#include "scene/scene.h"
#include "shared/masu_shared.h"
#include "split_sum.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 24, H = 18, POINTS = 512, PROBES = 94 /* of a frame, by default */ };

typedef struct rooms {
    masu_session s;
    void *blob;
    masu_scene_view v;
    uint32_t probes;
    uint32_t *live, *sets; /* in device memory */
} rooms;

/* rays: of a probe in a round; 0: the default. */
static void open_rooms_at(rooms *r, const char *path, uint32_t rays) {
    masu_session_desc d = test_desc(NULL, W, H);
    size_t bytes;
    masu_scene bound;
    d.desc.rung_count = 1;
    /* No test here looks at shadows of the sun. */
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f, .shadow_resolution = 16, .bounce_rays = rays};
    d.desc.readback = MASU_READBACK_HDR;
    d.scene_path = path;
    skip_unless_host_sees_all_memory();
    memset(r, 0, sizeof *r);
    open_session(&r->s, &d);
    r->blob = read_file(path, &bytes);
    assert_int_equal(masu_scene_bind(r->blob, bytes, &bound, NULL), MASU_OK);
    r->v = masu_scene_view_of(&bound);
    const masu_blob_probes *p = r->v.probes;
    r->probes = p->counts[0] * p->counts[1] * p->counts[2];
    unsigned char *at = masu_buffer_pointer(&r->s.m->device, MASU_BUFFER_PROBES, 0);
    assert_non_null(at);
    uint64_t lit = (r->v.probe_words + 3) / 4 * 4;
    r->live =
        (uint32_t *)(void *)(at + sizeof *p) + lit + (uint64_t)r->probes * MASU_PROBE_LIT_WORDS;
    r->sets = r->live + (uint64_t)r->probes * MASU_PROBE_LIT_WORDS;
}

static void open_rooms(rooms *r, const char *scene) { open_rooms_at(r, scene_path(scene), 0); }

static void close_rooms(rooms *r) {
    close_session(&r->s);
    free(r->blob);
}

static uint64_t hash_of(const rooms *r) {
    return masu_fnv1a64(r->live, (size_t)r->probes * MASU_PROBE_LIVE_WORDS * 4);
}

static void frame(rooms *r) {
    masu_commands commands;
    draw(&r->s, &(masu_frame_desc){.time_step = 1.0f / 60}, &commands, NULL);
}

/* Renders frames until this number of rounds without a change has passed. */
static uint32_t settle(rooms *r, uint32_t rounds) {
    uint32_t frames = 0;
    do frame(r), frames++;
    while (r->s.m->bounce.quiet < rounds && frames < 2000);
    assert_int_equal(r->s.m->bounce.quiet, rounds);
    return frames;
}

static float half_at(const uint32_t *words, uint32_t i) {
    return masu_probe_half(words[i / 2] >> (i & 1 ? 16 : 0) & 0xFFFFu);
}

static int is_valid(const rooms *r, uint32_t probe) {
    return half_at(r->live + (size_t)probe * MASU_PROBE_LIT_WORDS, 3) > 0;
}

/* Mean irradiance / pi, green, of points on the floor from x to x + 1.6, by the shader's lookup. */
static double floor_at(const rooms *r, float x) {
    uint64_t random = 5;
    double sum = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        const float p[3] = {x + 1.6f * random_float(&random), 0,
                            0.2f + 2.6f * random_float(&random)};
        const float n[3] = {0, 1, 0};
        float out[3];
        (void)masu_probe_lookup(r->v.probes, r->v.probe_data, r->live, p, n, out);
        sum += (double)out[1];
    }
    return sum / POINTS;
}

static void light_up(rooms *r, float color) {
    masu_punctual_light lamp = masu_punctual_light_find(r->s.m, "lamp");
    masu_punctual_light_state state;
    assert_int_equal(masu_punctual_light_get(r->s.m, lamp, &state, NULL), MASU_OK);
    for (int k = 0; k < 3; k++) state.color[k] = color;
    assert_int_equal(masu_punctual_light_set(r->s.m, lamp, &state, NULL), MASU_OK);
}

/* ---- The furnace ----------------------------------------------------------------------------- */

/* Walls that emit 0.5 and reflect half, with a specular part of 0.0221 and a base colour of 0.4887:
 * the result is 1 everywhere. */
static void a_furnace_is_1_everywhere(void **state) {
    (void)state;
    rooms r;
    open_rooms(&r, "test_bounce_furnace");
    (void)settle(&r, 120);
    float low = 10, high = 0;
    for (uint32_t i = 0; i < r.probes; i++) {
        assert_true(is_valid(&r, i));
        for (uint32_t c = 0; c < 3; c++) {
            float e = half_at(r.live + (size_t)i * MASU_PROBE_LIT_WORDS, c) * 0.282095f;
            low = fminf(low, e), high = fmaxf(high, e);
        }
    }
    print_message("%u probes of a furnace: %.4f to %.4f\n", r.probes, (double)low, (double)high);
    assert_true(low > 0.99f && high < 1.01f);
    close_rooms(&r);
}

/* A room of 2 m, its walls seen from within, all of one glTF material. */
static void bake_room(const char *name, const char *material) {
    float at[24][3];
    uint16_t indices[36];
    for (int i = 0; i < 24; i++) { /* two walls across each axis, counterclockwise from within */
        int axis = i / 8, far = i / 4 % 2, corner = i % 4;
        at[i][axis] = far ? 2 : 0;
        at[i][(axis + 1) % 3] = corner == 1 || corner == 2 ? 2 : 0;
        at[i][(axis + 2) % 3] = (corner >= 2) != far ? 2 : 0;
    }
    for (int i = 0; i < 36; i++) indices[i] = (uint16_t)(i / 6 * 4 + two[i % 6]);
    begin();
    int positions = floats(at[0], "VEC3", 24, 3), triangles = shorts(indices, 36);
    (void)finish(
        "\"materials\":[{%s}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d},"
        "\"indices\":%d,\"material\":0}]}],\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]",
        material, positions, triangles);
    bake_scene(
        name,
        "{\"ambient_occlusion\": false, \"reflections\": false, \"models\": [{\"file\": "
        "\"x.glb\"}],"
        "\"camera\": {\"keys\": [{\"position\": [0.3, 1.5, 0.3], \"target\": [1.5, 1, 1.5]}]},"
        "\"sun\": {\"intensity\": 0}, \"ambient\": [0, 0, 0],"
        "\"sky\": {\"zenith\": [0, 0, 0], \"horizon\": [0, 0, 0]},"
        "\"bounce\": {\"box\": [[0, 0, 0], [2, 2, 2]]}}");
}

/* An f0 above 0.08 with a colour. A surface returns the reference's mean over all angles. The brightest
 * channel alone determines the share of the base colour and the multiple scattering. */
static void a_furnace_of_strong_dielectrics(void **state) {
    (void)state;
    enum { ANGLES = 32 };
    const double f0 = 0.25, hue[3] = {1, 0.5, 0.25}, base = 0.3;
    const brdf_surface black = {.roughness = 0.9, .specular = f0 / 0.08};
    double returned[3] = {0};
    for (int a = 0; a < ANGLES; a++) {
        double mu = sqrt((a + 0.5) / ANGLES), gray[3], part[BRDF_INTEGRALS];
        brdf_furnace(masu_split_sum, &black, mu, 32, gray);
        brdf_looked_up(masu_split_sum, black.roughness, mu, part);
        for (int c = 0; c < 3; c++) {
            double less = f0 * (1 - hue[c]) * (part[BRDF_WHITE] - part[BRDF_WEIGHT]);
            returned[c] += (gray[c] - less + base * (1 - gray[c])) / ANGLES;
        }
    }
    bake_room("strong",
              "\"pbrMetallicRoughness\":{\"baseColorFactor\":[0.3,0.3,0.3,1],"
              "\"metallicFactor\":0,\"roughnessFactor\":0.9},\"emissiveFactor\":[0.5,0.5,0.5],"
              "\"extensions\":{\"KHR_materials_ior\":{\"ior\":3},"
              "\"KHR_materials_specular\":{\"specularColorFactor\":[1,0.5,0.25]}}");
    rooms r;
    open_rooms_at(&r, baked_scene("strong"), 0);
    (void)settle(&r, 60);
    for (uint32_t c = 0; c < 3; c++) {
        double mean = 0, want = 0.5 / (1 - returned[c]);
        for (uint32_t i = 0; i < r.probes; i++)
            mean += (double)half_at(r.live + (size_t)i * MASU_PROBE_LIT_WORDS, c) * 0.282095;
        mean /= r.probes;
        print_message("channel %u: %.4f, by the reference %.4f\n", c, mean, want);
        if (!(fabs(mean - want) < 0.01 * want))
            fail_msg("channel %u: %.4f, not %.4f", c, mean, want);
    }
    close_rooms(&r);
}

/* NaN in a set disappears with the set, and never appears in the image. */
static void poison_is_gone_after_a_window(void **state) {
    (void)state;
    rooms r;
    open_rooms(&r, "test_bounce_furnace");
    (void)settle(&r, 8);
    for (uint32_t k = 0; k < MASU_PROBE_WORDS; k++)
        r.sets[3 * MASU_BOUNCE_SETS * MASU_PROBE_WORDS + k] = 0x7E007C00u;
    for (uint32_t k = 0; k < MASU_PROBE_LIT_WORDS; k++)
        r.live[7 * MASU_PROBE_LIT_WORDS + k] = 0xFFFFFFFFu;
    for (uint32_t f = 0; f < 4; f++) {
        const uint16_t *pixels =
            draw_image(&r.s, &(masu_frame_desc){.time_step = 0.01f}, MASU_READBACK_HDR, NULL);
        for (uint32_t i = 0; i < W * H * 4; i++) assert_true((pixels[i] & 0x7C00u) != 0x7C00u);
    }
    (void)settle(&r, 28); /* set 0 has been replaced */
    uint32_t words = r.probes * MASU_BOUNCE_SETS * MASU_PROBE_WORDS;
    for (uint32_t i = 0; i < words; i++)
        assert_true((r.sets[i] & 0x7C00u) != 0x7C00u && (r.sets[i] >> 16 & 0x7C00u) != 0x7C00u);
    (void)settle(&r, 120);
    for (uint32_t i = 0; i < r.probes; i++)
        assert_float_equal(half_at(r.live + (size_t)i * MASU_PROBE_LIT_WORDS, 1) * 0.282095f, 1,
                           0.01);
    close_rooms(&r);
}

/* ---- Rooms ----------------------------------------------------------------------------------- */

static void light_comes_rises_rests_and_stays_behind_a_door(void **state) {
    (void)state;
    rooms r;
    /* A third of the default: the number of rounds does not depend on it. */
    open_rooms_at(&r, scene_path("test_bounce"), 16);
    light_up(&r, 0);
    (void)settle(&r, 8);
    assert_true(floor_at(&r, 0.2f) == 0);
    /* Switched on: the light rises to its final value. */
    static double curve[4096];
    uint32_t frames = 0, at_90 = 0;
    masu_bounce *b = &r.s.m->bounce;
    uint64_t at_rest = 0;
    light_up(&r, 2);
    do {
        frame(&r);
        curve[frames++] = floor_at(&r, 0.2f);
        if (b->quiet == MASU_BOUNCE_REST - 3 * MASU_BOUNCE_WINDOW) at_rest = hash_of(&r);
    } while (b->quiet < MASU_BOUNCE_REST - MASU_BOUNCE_WINDOW && frames < 4096);
    double final = floor_at(&r, 0.2f), fall = 0, most = 0;
    while (at_90 < frames && curve[at_90] < 0.9 * final) at_90++;
    for (uint32_t f = 1; f < frames; f++) {
        fall = fmax(fall, (curve[f - 1] - curve[f]) / final);
        most = fmax(most, curve[f] / final);
    }
    uint32_t bound = 29 * 4 * b->valid / (10 * PROBES);
    print_message("%u probes: 90 %% after %u frames, at most %u; largest fall %.4f, most %.4f\n",
                  b->valid, at_90 + 1, bound, fall, most);
    assert_true(final > 0.01 && at_90 + 1 <= bound && fall < 0.01 && most < 1.02);
    /* Pausing loses nothing: the last two windows, each of which traces every set, changed no bit.
     * The test skips the rest of the wait (tests/unit/test_bounce.c has it whole). Then nothing is
     * traced. */
    assert_true(at_rest == hash_of(&r));
    b->quiet = MASU_BOUNCE_REST - 1;
    (void)settle(&r, MASU_BOUNCE_REST);
    assert_true(at_rest == hash_of(&r));
    memset(r.sets, 0xFF, 4);
    for (uint32_t f = 0; f < 3; f++) frame(&r);
    assert_int_equal(r.sets[0], 0xFFFFFFFFu);
    double behind = floor_at(&r, 3.3f) / final;
    print_message("behind the shut door %.5f of the light before it\n", behind);
    assert_true(behind <= 0.01);
    /* Opening the door is a change, and light passes. */
    masu_model door = masu_model_find(r.s.m, "door");
    const float away[12] = {1, 0, 0, 3.05f, 0, 1, 0, -20, 0, 0, 1, 1.5f};
    assert_int_equal(masu_model_set_transform(r.s.m, door, away, NULL), MASU_OK);
    frames = 0, at_90 = 0;
    do {
        frame(&r);
        curve[frames++] = floor_at(&r, 3.3f);
    } while (b->quiet < MASU_BOUNCE_SWIFT_ROUNDS && frames < 4096);
    while (curve[at_90] < 0.9 * curve[frames - 1]) at_90++;
    double open = curve[frames - 1] / floor_at(&r, 0.2f);
    print_message("behind the open door %.5f, 90 %% after %u frames of %u\n", open, at_90 + 1,
                  frames);
    assert_true(open > 0.03 && at_90 + 1 <= bound);
    close_rooms(&r);
}

/* ---- Daylight -------------------------------------------------------------------------------- */

/* Sky and sun are baked: rays add exactly nothing. */
static void baked_daylight_counts_once(void **state) {
    (void)state;
    rooms r;
    open_rooms(&r, "test_bounce_lit");
    (void)settle(&r, 5);
    uint32_t valid = 0;
    for (uint32_t i = 0; i < r.probes; i++) {
        valid += is_valid(&r, i) != 0;
        for (uint32_t k = 0; k < MASU_PROBE_LIT_WORDS; k++)
            if (k != 1) assert_int_equal(r.live[i * MASU_PROBE_LIT_WORDS + k], 0);
    }
    assert_true(valid > r.probes / 2); /* they have been traced */
    for (uint32_t i = 0; i < r.probes * MASU_BOUNCE_SETS * MASU_PROBE_WORDS; i++)
        assert_int_equal(r.sets[i], 0);
    /* A change of the sun is no change for them either. */
    uint32_t quiet = r.s.m->bounce.quiet;
    masu_light light = {
        .sun_direction = {0.2f, 0.6f, 0.75f}, .sun_color = {2, 2, 2}, .ambient = {1, 1, 1}};
    masu_commands commands;
    draw(&r.s, &(masu_frame_desc){.light = &light}, &commands, NULL);
    assert_true(r.s.m->bounce.quiet >= quiet);
    close_rooms(&r);
}

/* ---- Ray queries ----------------------------------------------------------------------------- */

/* Rays of probes traverse the library's own BVH. */
static void ray_queries_are_refused(void **state) {
    (void)state;
    masu_session_desc d = test_desc("test_bounce", W, H);
    masu_session s;
    masu_detail detail;
    masu_memory need;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.no_renderer = true;
    open_session(&s, &d);
    s.desc.ray_query = MASU_ON;
    assert_int_equal(masu_memory_query(&s.desc, &need, &detail), MASU_ERROR_SCENE);
    assert_string_equal(detail.what, "ray_query");
    assert_non_null(strstr(detail.text, "live bounce"));
    s.desc.ray_query = MASU_AUTO;
    assert_int_equal(masu_memory_query(&s.desc, &need, NULL), MASU_OK);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_furnace_is_1_everywhere),
        cmocka_unit_test(a_furnace_of_strong_dielectrics),
        cmocka_unit_test(poison_is_gone_after_a_window),
        cmocka_unit_test(light_comes_rises_rests_and_stays_behind_a_door),
        cmocka_unit_test(baked_daylight_counts_once),
        cmocka_unit_test(ray_queries_are_refused),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

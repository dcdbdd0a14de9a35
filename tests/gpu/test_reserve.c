/* test_reserve.c: objects added at run time give the image of a scene that was baked with them:
 * copies of models in the reserve, with their shadows, reflections, occlusion, transparency and
 * attached lights; lights; material factors. An unused reserve changes no bit; the memory is as
 * large as reported; a full reserve is an error; removed objects are rejected. */
#include "support/files.h"
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 160, H = 90, BYTES = W * H * 4, FRAMES = 6 };
enum { KINDS = 5 };

static uint8_t pictures[3][FRAMES][BYTES];

static const struct {
    const char *name;
    float at[3]; /* of the second copy, as in test_reserve_baked.json */
} kinds[KINDS] = {{"truck", {1.2f, 0.25f, -0.5f}},
                  {"lamp", {-1, 1, 1.2f}},
                  {"pane", {-2, 0.6f, 2.5f}},
                  {"block", {0.9f, 0.8f, 1.8f}},
                  {"ball", {0, 0.5f, -2}}};

static masu_session_desc desc_of(const char *scene, uint32_t models, uint32_t lights) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.rung_count = 1;
    /* which lights have shadows depends on earlier frames */
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f, .local_shadows = MASU_OFF};
    d.desc.reserve.models = models;
    d.desc.reserve.lights = lights;
    return d;
}

static masu_result add(masu_session *s, const char *name, const float at[3], masu_model *out) {
    const float rows[12] = {1, 0, 0, at[0], 0, 1, 0, at[1], 0, 0, 1, at[2]};
    return masu_model_add(s->m, masu_model_find(s->m, name), rows, out, &failure);
}

static const masu_punctual_light_state spot = {.position = {0, 3, 2},
                                               .direction = {0.2f, -1, -0.3f},
                                               .color = {2, 4, 6},
                                               .range = 8,
                                               .radius = 0.01f,
                                               .spot = 1,
                                               .inner = 0.2617994f,
                                               .outer = 0.5235988f};

/* Adds everything that the other scene has. */
static void add_all(masu_session *s, masu_model added[KINDS], masu_punctual_light *light) {
    for (uint32_t k = 0; k < KINDS; k++)
        assert_int_equal(add(s, kinds[k].name, kinds[k].at, &added[k]), MASU_OK);
    assert_int_equal(masu_punctual_light_add(s->m, &spot, light, &failure), MASU_OK);
}

/* Renders FRAMES frames after a cut: reflections accumulate. */
static void draw_frames(masu_session *s, uint8_t out[FRAMES][BYTES]) {
    for (uint32_t i = 0; i < FRAMES; i++) {
        masu_commands commands;
        draw(s, &(masu_frame_desc){.cut = i == 0, .time_step = 1.0f / 60}, &commands, out[i]);
    }
}

static uint32_t far_off(const uint8_t *a, const uint8_t *b) {
    uint32_t off = 0;
    for (uint32_t i = 0; i < BYTES; i++) off += abs(a[i] - b[i]) > 4;
    return off;
}

/* ---- Models and lights ----------------------------------------------------------------------- */

static void what_is_added_is_as_if_baked_so(void **state) {
    (void)state;
    masu_session live, baked;
    masu_model added[KINDS];
    masu_punctual_light light;
    masu_session_desc d = desc_of("test_reserve", KINDS, 2),
                      truth = desc_of("test_reserve_baked", 0, 0);
    masu_stats_info expected = {0}, is;
    for (uint32_t flight = 1; flight <= 3; flight++) {
        /* the number of frames in flight depends on the host only */
        if (flight != 2 && !whole_run()) continue;
        d.desc.frames_in_flight = flight;
        /* then the lists have no other LODs in between */
        if (flight == 3) d.desc.rungs[0].lod_error = -1.0f;
        truth.desc.rungs[0] = d.desc.rungs[0];
        if (flight != 2 || !whole_run()) { /* two has the rung and the image of one */
            open_session(&baked, &truth);
            draw_frames(&baked, pictures[1]);
            draw_frames(&baked, pictures[1]); /* with the same numbers, which determine the noise */
            expected = stats_of(&baked, 1);
            close_session(&baked);
        }
        open_session(&live, &d);
        draw_frames(&live, pictures[2]); /* and then, with frames in flight */
        add_all(&live, added, &light);
        draw_frames(&live, pictures[0]);
        uint32_t off = far_off(pictures[0][FRAMES - 1], pictures[1][FRAMES - 1]);
        uint32_t before = far_off(pictures[2][FRAMES - 1], pictures[1][FRAMES - 1]);
        printf("  %u in flight: %u of %u bytes differ by more than 4 from the scene baked so, "
               "before %u\n",
               flight, off, BYTES, before);
        assert_true(off < BYTES / 1000);
        assert_true(before > BYTES / 10);
        is = stats_of(&live, (2 * FRAMES - 1) % flight);
        assert_int_equal(is.lights, expected.lights);
        assert_int_equal(is.transparents, expected.transparents);
        assert_int_equal(is.views[0].triangles, expected.views[0].triangles);
        assert_int_equal(is.views[0].occluders, expected.views[0].occluders);
        assert_int_equal(is.views[0].visible_instances, expected.views[0].visible_instances);
        assert_true(is.views[0].occluders >= 2);
        close_session(&live);
    }
}

/* Removing models and lights restores the image; objects added to their slots are as the first
 * ones. */
static void what_is_removed_leaves_nothing(void **state) {
    (void)state;
    masu_session s, fresh;
    masu_model added[KINDS], other;
    masu_punctual_light light;
    masu_session_desc d = desc_of("test_reserve", KINDS, 2);
    open_session(&s, &d);
    open_session(&fresh, &d);
    add_all(&s, added, &light);
    draw_frames(&s, pictures[0]);
    for (uint32_t k = 0; k < KINDS; k++)
        assert_int_equal(masu_model_remove(s.m, added[k], &failure), MASU_OK);
    assert_int_equal(masu_punctual_light_remove(s.m, light, &failure), MASU_OK);
    draw_frames(&s, pictures[0]);
    draw_frames(&fresh, pictures[2]);
    draw_frames(&fresh, pictures[1]);
    assert_int_equal(stats_of(&s, 1).lights, 1);
    assert_int_equal(max_difference(pictures[0][0], pictures[1][0], sizeof pictures[0]), 0);
    /* Now all slots hold another object. */
    for (uint32_t k = 0; k < KINDS; k++) {
        uint32_t kind = (k + 2) % KINDS;
        const char *name = kinds[kind].name;
        assert_int_equal(add(&s, name, kinds[kind].at, &other), MASU_OK);
        assert_int_not_equal(other.id, added[k].id);
        assert_int_equal(add(&fresh, name, kinds[kind].at, &other), MASU_OK);
    }
    draw_frames(&s, pictures[0]);
    draw_frames(&fresh, pictures[1]);
    assert_int_equal(max_difference(pictures[0][0], pictures[1][0], sizeof pictures[0]), 0);
    close_session(&s);
    close_session(&fresh);
}

static void room_that_is_not_used_changes_no_bit(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_reserve", "test_skin", "test_both"};
    for (uint32_t i = 0; i < 3; i += whole_run() ? 1 : 2) { /* at least polygons, and an SDF */
        masu_session_desc with = desc_of(scenes[i], 3, i < 2 ? 4 : 0),
                          without = desc_of(scenes[i], 0, 0);
        masu_session s;
        with.desc.mutable_materials = 1;
        open_session(&s, &without);
        draw_frames(&s, pictures[0]);
        close_session(&s);
        open_session(&s, &with);
        draw_frames(&s, pictures[1]);
        close_session(&s);
        printf("  %s: %u\n", scenes[i],
               max_difference(pictures[0][0], pictures[1][0], sizeof pictures[0]));
        assert_int_equal(max_difference(pictures[0][0], pictures[1][0], sizeof pictures[0]), 0);
    }
}

static void at_the_limit_is_refused(void **state) {
    (void)state;
    masu_session s;
    masu_model added[3];
    masu_punctual_light light[2];
    masu_session_desc d = desc_of("test_reserve", 2, 1);
    open_session(&s, &d);
    assert_int_equal(add(&s, "lamp", kinds[0].at, &added[0]), MASU_OK); /* with its light */
    assert_int_equal(masu_punctual_light_add(s.m, &spot, &light[0], &failure), MASU_ERROR_LIMIT);
    assert_string_equal(failure.text, "reserve.lights: 2 are needed, 1 are given");
    assert_int_equal(add(&s, "lamp", kinds[1].at, &added[1]), MASU_ERROR_LIMIT);
    assert_string_equal(failure.what, "reserve.lights");
    assert_int_equal(added[1].id, 0);
    assert_int_equal(add(&s, "block", (const float[3]){NAN, 0, 0}, &added[1]), MASU_ERROR_ARGUMENT);
    assert_int_equal(add(&s, "block", kinds[1].at, &added[1]), MASU_OK);
    assert_int_equal(add(&s, "block", kinds[1].at, &added[2]), MASU_ERROR_LIMIT);
    assert_string_equal(failure.text, "reserve.models: 3 are needed, 2 are given");
    assert_int_equal(added[2].id, 0);
    assert_int_equal(masu_model_remove(s.m, added[0], &failure), MASU_OK);
    assert_int_equal(masu_model_remove(s.m, added[0], &failure), MASU_ERROR_ARGUMENT);
    masu_punctual_light_state bad = spot;
    bad.range = -1;
    assert_int_equal(masu_punctual_light_add(s.m, &bad, &light[0], &failure), MASU_ERROR_ARGUMENT);
    /* the lamp's light was removed */
    assert_int_equal(masu_punctual_light_add(s.m, &spot, &light[0], &failure), MASU_OK);
    assert_int_equal(
        masu_punctual_light_remove(s.m, masu_punctual_light_find(s.m, "glow"), &failure),
        MASU_ERROR_ARGUMENT);
    draw_rung(&s, 0, pictures[0][0]);
    close_session(&s);
}

/* A copy has its own clips and pose. Its nodes and its image equal those of the original in the
 * same position and pose, while the original remains in its bind pose. */
static void a_copy_is_animated_by_itself(void **state) {
    (void)state;
    masu_session own, copied;
    masu_model copy, swing;
    masu_node_state is, expected, rest, before;
    const float at[3] = {1, 0.1f, -0.4f};
    const float rows[12] = {1, 0, 0, at[0], 0, 1, 0, at[1], 0, 0, 1, at[2]};
    const masu_clip_use turned = {.clip = 0, .loop = 1, .time = 0.35, .weight = 1};
    masu_session_desc d = desc_of("test_swing", 1, 0);
    open_session(&own, &d);
    open_session(&copied, &d);
    swing = masu_model_find(own.m, "swing");
    assert_int_equal(masu_model_clips(own.m, swing), 1);
    assert_int_equal(masu_model_set_transform(own.m, swing, rows, &failure), MASU_OK);
    draw_frames(&own, pictures[2]); /* bind pose */
    assert_int_equal(masu_model_animate(own.m, swing, &turned, 1, &failure), MASU_OK);
    draw_frames(&own, pictures[1]);
    assert_int_equal(add(&copied, "swing", at, &copy), MASU_OK);
    assert_int_equal(masu_model_clips(copied.m, copy), 1);
    assert_true(masu_model_clip_duration(copied.m, copy, 0) ==
                masu_model_clip_duration(own.m, swing, 0));
    masu_model_state whole;
    assert_int_equal(masu_model_get(copied.m, copy, &whole, &failure), MASU_OK);
    uint32_t moved = 0;
    for (uint32_t turn = 0; turn < 2; turn++) {
        for (uint32_t n = 0; n < whole.nodes; n++) {
            assert_int_equal(masu_model_node_get(copied.m, copy, n, &is, &failure), MASU_OK);
            assert_int_equal(masu_model_node_get(own.m, swing, n, &expected, &failure), MASU_OK);
            assert_int_equal(masu_model_node_get(copied.m, masu_model_find(copied.m, "swing"), n,
                                                 &rest, &failure),
                             MASU_OK);
            if (turn) assert_memory_equal(is.world, expected.world, sizeof is.world);
            else moved += memcmp(is.world, expected.world, sizeof is.world) != 0;
            if (n == whole.nodes - 1 && !turn) before = rest;
            if (n == whole.nodes - 1)
                assert_memory_equal(rest.world, before.world, sizeof rest.world);
        }
        if (!turn)
            assert_int_equal(masu_model_animate(copied.m, copy, &turned, 1, &failure), MASU_OK);
    }
    assert_true(moved > 0);
    assert_int_equal(masu_model_show(copied.m, masu_model_find(copied.m, "swing"), 0, &failure),
                     MASU_OK);
    draw_frames(&copied, pictures[0]);
    draw_frames(&copied, pictures[0]); /* with the same numbers */
    uint32_t off = far_off(pictures[0][FRAMES - 1], pictures[1][FRAMES - 1]);
    uint32_t turned_off = far_off(pictures[2][FRAMES - 1], pictures[1][FRAMES - 1]);
    printf("  %u nodes moved by the clip; %u bytes differ by more than 4, in the bind pose %u\n",
           moved, off, turned_off);
    assert_int_equal(off, 0);
    assert_true(turned_off > 20);
    close_session(&own);
    close_session(&copied);
}

/* The device's ray queries find copies as the library's own BVHs do. test_ray_query covers drivers
 * without them. */
static void rays_of_the_device_meet_copies(void **state) {
    (void)state;
    masu_model added[KINDS];
    masu_punctual_light light;
    static const masu_switch ways[3] = {MASU_OFF, MASU_ON, MASU_ON};
    for (uint32_t i = 0; i < 3; i++) {
        masu_session s;
        masu_plan_info plan;
        masu_session_desc d = desc_of("test_reserve", KINDS, 2);
        d.host.ray_query = true;
        d.desc.ray_query = ways[i];
        d.no_renderer = true;
        open_session(&s, &d);
        bool offered = s.host.ray_query;
        if (!offered && ways[i] == MASU_ON) {
            close_session(&s);
            return;
        }
        char error[ERROR_SIZE];
        assert_ok(masu_session_start(&s, error, sizeof error));
        masu_plan_of(s.m, &plan);
        assert_int_equal(pass_of(&plan, "specular_query")->active, ways[i] == MASU_ON);
        if (i < 2) add_all(&s, added, &light); /* the third scene has no copies */
        draw_frames(&s, pictures[i]);
        close_session(&s);
    }
    uint32_t off = far_off(pictures[1][FRAMES - 1], pictures[0][FRAMES - 1]);
    uint32_t without = far_off(pictures[2][FRAMES - 1], pictures[0][FRAMES - 1]);
    printf("  %u bytes differ by more than 4 from those of the own trees, without copies %u\n", off,
           without);
    assert_true(off < BYTES / 1000);
    assert_true(without > BYTES / 10);
}

/* Skinned models cannot be copied; a scene of only such models pays nothing. */
static void what_bends_is_not_copied(void **state) {
    (void)state;
    masu_session s;
    masu_model added;
    masu_session_desc d = desc_of("test_skin", 2, 0), plain = desc_of("test_skin", 0, 0);
    masu_peak_info is[2];
    open_session(&s, &plain);
    masu_peaks(s.m, &is[0]);
    close_session(&s);
    open_session(&s, &d);
    masu_peaks(s.m, &is[1]);
    assert_int_equal(is[0].device_bytes, is[1].device_bytes);
    assert_int_equal(is[0].host_bytes, is[1].host_bytes);
    assert_int_equal(add(&s, "arm", kinds[0].at, &added), MASU_OK); /* its baked copy */
    assert_int_equal(add(&s, "arm", kinds[0].at, &added), MASU_ERROR_LIMIT);
    close_session(&s);
}

static void handles_of_what_is_gone_are_refused(void **state) {
    (void)state;
    masu_session s;
    masu_model added, again;
    masu_session_desc d = desc_of("test_reserve", 1, 1);
    open_session(&s, &d);
    assert_int_equal(masu_model_at(s.m, 5).id, 0);
    assert_int_equal(add(&s, "lamp", kinds[1].at, &added), MASU_OK);
    assert_int_equal(masu_model_at(s.m, 5).id, added.id);
    masu_instance bulb = masu_instance_at(s.m, masu_scene_count(&s.scene, MASU_SCENE_INSTANCE));
    masu_instance_state is;
    masu_punctual_light glow = masu_punctual_light_at(s.m, 1);
    masu_punctual_light_state light;
    assert_int_equal(masu_instance_get(s.m, bulb, &is, &failure), MASU_OK);
    assert_int_equal(is.model.id, added.id);
    assert_int_equal(masu_punctual_light_get(s.m, glow, &light, &failure), MASU_OK);
    assert_int_equal(light.instance.id, bulb.id);
    /* A light of the scene that is attached to the copy is switched off and detached. */
    masu_punctual_light own = masu_punctual_light_find(s.m, "glow");
    assert_int_equal(masu_punctual_light_set(s.m, own, &light, &failure), MASU_OK);
    assert_int_equal(masu_model_remove(s.m, added, &failure), MASU_OK);
    assert_int_equal(masu_punctual_light_get(s.m, own, &light, &failure), MASU_OK);
    assert_int_equal(light.instance.id, 0);
    assert_true(light.color[0] == 0.0f);
    for (uint32_t round = 0; round < 2; round++) {
        assert_int_equal(masu_model_show(s.m, added, 1, &failure), MASU_ERROR_ARGUMENT);
        assert_non_null(strstr(failure.text, "removed"));
        assert_int_equal(masu_instance_get(s.m, bulb, &is, &failure), MASU_ERROR_ARGUMENT);
        assert_int_equal(masu_punctual_light_set(s.m, glow, &light, &failure), MASU_ERROR_ARGUMENT);
        light.instance = bulb;
        assert_int_equal(masu_punctual_light_set(s.m, own, &light, &failure), MASU_ERROR_ARGUMENT);
        if (round) break;
        /* the new copy does not get that light */
        assert_int_equal(add(&s, "truck", kinds[0].at, &again), MASU_OK);
        assert_int_equal(masu_punctual_light_get(s.m, own, &light, &failure), MASU_OK);
        assert_int_equal(light.instance.id, 0);
    }
    /* hides it */
    assert_int_equal(masu_model_remove(s.m, masu_model_find(s.m, "block"), &failure), MASU_OK);
    assert_int_equal(add(&s, "block", kinds[0].at, &again), MASU_OK);
    assert_int_equal(again.id, masu_model_find(s.m, "block").id);
    close_session(&s);
}

/* Every call that takes a handle, with invalid ids: all return an error and change nothing. */
static void refuse_everywhere(masu_renderer *m, uint64_t instance, uint64_t model, uint64_t light,
                              uint64_t material) {
    static const float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const masu_clip_use use = {.weight = 1};
    masu_instance_state is;
    masu_model_state ms;
    masu_node_state ns;
    masu_model added = {.id = 1};
    masu_punctual_light_state carried = spot, ls;
    masu_material_state mat = {.roughness = 1};
    masu_instance i = {instance};
    masu_model o = {model};
    masu_punctual_light l = {light};
    assert_int_equal(masu_instance_get(m, i, &is, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_show(m, i, 1, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_instance_set_transform(m, i, rows, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_get(m, o, &ms, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_set_transform(m, o, rows, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_show(m, o, 1, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_add(m, o, rows, &added, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(added.id, 0);
    assert_int_equal(masu_model_remove(m, o, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_node_find(m, o, "arm"), MASU_NODE_NONE);
    assert_int_equal(masu_model_node_get(m, o, 0, &ns, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_node_set(m, o, 0, rows, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_clips(m, o), 0);
    assert_int_equal(masu_model_clip_find(m, o, "swing"), MASU_CLIP_NONE);
    assert_true(masu_model_clip_duration(m, o, 0) == 0.0);
    assert_int_equal(masu_model_animate(m, o, NULL, 0, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_animate(m, o, &use, 1, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_get(m, l, &ls, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_set(m, l, &spot, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_remove(m, l, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_material_get(m, (masu_material){material}, &mat, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_material_set(m, (masu_material){material}, &mat, &failure),
                     MASU_ERROR_ARGUMENT);
    if (!instance) return; /* a light without an instance */
    carried.instance = i;
    masu_punctual_light none;
    assert_int_equal(masu_punctual_light_set(m, masu_punctual_light_at(m, 0), &carried, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_punctual_light_add(m, &carried, &none, &failure), MASU_ERROR_ARGUMENT);
}

/* id 0 and removed ids, with and without a reserve, with slots that are free, used and reused. */
static void no_object_is_refused_by_every_call(void **state) {
    (void)state;
    for (uint32_t reserve = 0; reserve < 3; reserve++) {
        masu_session s;
        masu_session_desc d = desc_of("test_reserve", reserve, reserve);
        masu_model added;
        masu_punctual_light light;
        d.desc.mutable_materials = 1;
        open_session(&s, &d);
        refuse_everywhere(s.m, 0, 0, 0, 0);
        refuse_everywhere(s.m, 1ull << 32, 1ull << 32, 1ull << 32, 1ull << 32);
        for (uint32_t turn = 0; turn < 3 && reserve; turn++) {
            assert_int_equal(add(&s, "truck", kinds[0].at, &added), MASU_OK);
            masu_instance instance =
                masu_instance_at(s.m, masu_scene_count(&s.scene, MASU_SCENE_INSTANCE));
            assert_true(instance.id != 0);
            assert_int_equal(masu_punctual_light_add(s.m, &spot, &light, &failure), MASU_OK);
            assert_int_equal(masu_punctual_light_remove(s.m, light, &failure), MASU_OK);
            assert_int_equal(masu_model_remove(s.m, added, &failure), MASU_OK);
            refuse_everywhere(s.m, instance.id, added.id, light.id, UINT64_MAX);
        }
        draw_frames(&s, pictures[0]);
        close_session(&s);
    }
}

/* The memory block has the reported size, with and without a reserve; a smaller one is rejected. */
static void the_box_is_as_large_as_was_said(void **state) {
    (void)state;
    masu_session s;
    masu_memory need[2];
    masu_peak_info peaks;
    masu_detail detail;
    masu_session_desc d = desc_of("test_reserve", 8, 16);
    d.desc.mutable_materials = 1;
    d.no_renderer = true; /* planning a reserve reads the blob, which is freed after loading */
    open_session(&s, &d);
    masu_desc plain = s.desc;
    plain.reserve = (masu_reserve){.models = 0};
    plain.mutable_materials = 0;
    assert_int_equal(masu_memory_query(&s.desc, &need[1], NULL), MASU_OK);
    assert_int_equal(masu_memory_query(&plain, &need[0], NULL), MASU_OK);
    own_renderer made;
    make_own(&s, &made, &s.desc);
    masu_peaks(made.m, &peaks);
    assert_int_equal(peaks.host_bytes, need[1].host_bytes);
    assert_int_equal(peaks.device_bytes, need[1].device_bytes);
    assert_int_equal(peaks.lights, masu_scene_count(&s.scene, MASU_SCENE_LIGHT) + 16);
    assert_int_equal(peaks.models, masu_scene_count(&s.scene, MASU_SCENE_MODEL) + 8);
    printf("  8 models, 16 lights, live materials: %llu bytes host, %llu device\n",
           (unsigned long long)(need[1].host_bytes - need[0].host_bytes),
           (unsigned long long)(need[1].device_bytes - need[0].device_bytes));
    assert_true(need[1].device_bytes > need[0].device_bytes);
    static masu_memory_row rows[MEMORY_ROWS];
    uint32_t count = memory_rows(made.m, rows), named = 0;
    for (uint32_t i = 0; i < count; i++) {
        named |= !strcmp(rows[i].name, "reserve models") ? 1u : 0;
        named |= !strcmp(rows[i].name, "reserve lights") ? 2u : 0;
        named |= !strcmp(rows[i].name, "reserve instances") ? 4u : 0;
        named |=
            !strcmp(rows[i].name, "live materials") && !strcmp(rows[i].kind, "buffer") ? 8u : 0;
    }
    assert_int_equal(named, 15);
    masu_desc tight = s.desc;
    tight.limits.models = masu_scene_count(&s.scene, MASU_SCENE_MODEL) + 7;
    assert_int_equal(masu_memory_query(&tight, &need[0], &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "limits.models");
    tight = s.desc;
    tight.reserve.models = 16385;
    assert_int_equal(masu_memory_query(&tight, &need[0], &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "reserve.models");
    tight.reserve = (masu_reserve){.lights = 4097};
    assert_int_equal(masu_memory_query(&tight, &need[0], &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "reserve.lights");
    tight.reserve.lights = 4096; /* one too many, together with the scene's */
    assert_int_equal(masu_memory_query(&tight, &need[0], &detail), MASU_ERROR_LIMIT);
    assert_string_equal(detail.what, "limits.lights");
    unmake_own(&s, &made);
    close_session(&s);
}

/* ---- Materials ------------------------------------------------------------------------------- */

static masu_material_state material(masu_session *s, const char *model, masu_material *out) {
    masu_material_state state;
    *out = masu_material_find(s->m, model);
    assert_int_not_equal(out->id, 0);
    assert_int_equal(masu_material_get(s->m, *out, &state, &failure), MASU_OK);
    return state;
}

static void paint(masu_session *s) {
    masu_material of;
    masu_material_state to = material(s, "floor", &of);
    const float red[3] = {0.7f, 0.4f, 0.3f}, glow[3] = {0.2f, 0.4f, 0.1f},
                blue[3] = {0.2f, 0.4f, 0.9f};
    assert_true(to.roughness == 0.1f && to.metallic == 0.9f && to.base_color[1] == 0.5f);
    to.roughness = 0.3f;
    memcpy(to.base_color, red, sizeof red);
    assert_int_equal(masu_material_set(s->m, of, &to, &failure), MASU_OK);
    to = material(s, "wall", &of);
    memcpy(to.emissive, glow, sizeof glow);
    assert_int_equal(masu_material_set(s->m, of, &to, &failure), MASU_OK);
    to = material(s, "pane", &of);
    assert_int_equal(to.mode, MASU_MATERIAL_BLENDED);
    to.opacity = 0.8f;
    memcpy(to.base_color, blue, sizeof blue);
    assert_int_equal(masu_material_set(s->m, of, &to, &failure), MASU_OK);
    to = material(s, "ball", &of);
    to.metallic = 1;
    to.roughness = 0.25f;
    assert_int_equal(masu_material_set(s->m, of, &to, &failure), MASU_OK);
}

static void what_is_painted_is_as_if_baked_so(void **state) {
    (void)state;
    masu_session live, baked;
    masu_session_desc d = desc_of("test_reserve", 0, 0),
                      truth = desc_of("test_reserve_painted", 0, 0);
    d.desc.mutable_materials = 1;
    open_session(&baked, &truth);
    draw_frames(&baked, pictures[2]);
    draw_frames(&baked, pictures[1]);
    for (uint32_t flight = 1; flight <= 3; flight++) {
        if (flight != 2 && !whole_run()) continue;
        d.desc.frames_in_flight = flight;
        open_session(&live, &d);
        draw_frames(&live, pictures[2]);
        paint(&live);
        draw_frames(&live, pictures[0]); /* already in the first frame */
        uint32_t off = 0, before = far_off(pictures[2][0], pictures[1][0]);
        for (uint32_t i = 0; i < FRAMES; i++) off += far_off(pictures[0][i], pictures[1][i]);
        printf("  %u in flight: %u of %u bytes differ by more than 4 from the scene baked so, "
               "before %u\n",
               flight, off, FRAMES * BYTES, FRAMES * before);
        assert_true(off < FRAMES * BYTES / 500);
        assert_true(before > BYTES / 10);
        close_session(&live);
    }
    close_session(&baked);
}

/* With temporal upscaling, a change is detected as for a light. */
static void a_history_is_told(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    for (uint32_t baked = 0; baked <= 1; baked++) {
        masu_session_desc d = desc_of(baked ? "test_reserve_painted" : "test_reserve", 0, 0);
        d.desc.mutable_materials = !baked;
        d.desc.rungs[0] = (masu_rung){.scale = 0.5f, .temporal = MASU_ON, .specular = MASU_OFF};
        open_session(&s, &d);
        for (uint32_t i = 0; i < 40; i++) {
            if (i == 32 && !baked) paint(&s);
            draw(&s, &(masu_frame_desc){.cut = i == 0}, &commands, pictures[baked][0]);
        }
        close_session(&s);
    }
    uint32_t off = far_off(pictures[0][0], pictures[1][0]);
    printf("  8 frames later %u of %u bytes differ by more than 4 from the scene baked so\n", off,
           BYTES);
    assert_true(off < BYTES / 20);
}

static void what_would_change_a_pass_is_refused(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_reserve", 0, 0);
    open_session(&s, &d);
    masu_material of = {1};
    masu_material_state was, to;
    assert_int_equal(masu_material_find(s.m, "floor").id, 0);
    assert_int_equal(masu_material_get(s.m, of, &was, &failure), MASU_ERROR_STATE);
    close_session(&s);
    d.desc.mutable_materials = 1;
    open_session(&s, &d);
    was = material(&s, "wall", &of);
    assert_int_equal(masu_material_at(s.m, masu_scene_count(&s.scene, MASU_SCENE_MATERIAL)).id, 0);
#define REFUSED(field, value, name)                                                                \
    do {                                                                                           \
        to = was;                                                                                  \
        to.field = (value);                                                                        \
        assert_int_equal(masu_material_set(s.m, of, &to, &failure), MASU_ERROR_ARGUMENT);                    \
        assert_string_equal(failure.what, name);                                     \
    } while (0)
    REFUSED(mode, MASU_MATERIAL_BLENDED, "mode");
    REFUSED(cutoff, 0.5f, "cutoff");
    REFUSED(opacity, 0.5f, "opacity");
    REFUSED(specular, 0.9f, "specular");
    REFUSED(coat, 0.5f, "coat");
    REFUSED(roughness, 1.5f, "roughness");
    REFUSED(metallic, NAN, "metallic");
    REFUSED(base_color[2], -0.1f, "base_color");
    REFUSED(emissive[1], INFINITY, "emissive");
    assert_int_equal(masu_material_get(s.m, of, &to, &failure), MASU_OK);
    assert_memory_equal(&to, &was, sizeof to);
    assert_int_equal(masu_material_set(s.m, (masu_material){of.id + 100}, &was, &failure),
                     MASU_ERROR_ARGUMENT);
    close_session(&s);
}

/* A reflectance above 0.08, a sheen or an anisotropy is kept, while other factors change. */
static void lobes_are_kept(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("reference_materials", 0, 0);
    masu_material of;
    masu_material_state was, to;
    d.desc.mutable_materials = 1;
    open_session(&s, &d);
    was = material(&s, "sheen", &of);
    assert_true(was.specular == 0.5f);
    REFUSED(specular, 0.6f, "specular");
    was = material(&s, "ior 2.4", &of);
    if (!(fabsf(was.specular * 0.08f - 0.1696f) < 0.003f))
        fail_msg("specular is %g", (double)was.specular);
    REFUSED(specular, 0.5f, "specular");
    REFUSED(coat, 0.5f, "coat");
    to = was;
    to.base_color[0] = 0.25f;
    assert_int_equal(masu_material_set(s.m, of, &to, &failure), MASU_OK);
    assert_int_equal(masu_material_get(s.m, of, &was, &failure), MASU_OK);
    assert_memory_equal(&to, &was, sizeof to);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_added_is_as_if_baked_so),
        cmocka_unit_test(what_is_removed_leaves_nothing),
        cmocka_unit_test(room_that_is_not_used_changes_no_bit),
        cmocka_unit_test(at_the_limit_is_refused),
        cmocka_unit_test(a_copy_is_animated_by_itself),
        cmocka_unit_test(rays_of_the_device_meet_copies),
        cmocka_unit_test(what_bends_is_not_copied),
        cmocka_unit_test(handles_of_what_is_gone_are_refused),
        cmocka_unit_test(no_object_is_refused_by_every_call),
        cmocka_unit_test(the_box_is_as_large_as_was_said),
        cmocka_unit_test(what_is_painted_is_as_if_baked_so),
        cmocka_unit_test(a_history_is_told),
        cmocka_unit_test(what_would_change_a_pass_is_refused),
        cmocka_unit_test(lobes_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

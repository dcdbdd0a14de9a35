/* test_calls.c: random sequences of live calls with random arguments, valid and invalid: NaN,
 * infinities, stale and foreign handles. Checked against a simple model of the state: a call returns
 * MASU_OK, or a named error of one line and then changes nothing; a slot of the reserve is free or
 * has one object; a stale handle is refused for good; every frame is drawn, and all its pixels are
 * finite. The validation layer stays silent, and nothing of Vulkan is created after masu_load.
 *
 * LONG=1 makes 50 times as many calls. */
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/wrap.h"

enum { WIDTH = 36, HEIGHT = 22, RESERVE = 3, STALE = 16, SCENE = 5, CALLS = 4000 };

/* Ids of the objects in a reserve, and of some that were removed. */
typedef struct slots {
    uint64_t live[RESERVE], gone[STALE];
    uint32_t count, gone_count;
} slots;

typedef struct world {
    masu_session s;
    uint32_t random;
    slots models, lights; /* of the reserve */
    masu_model scene[SCENE]; /* its models, which are hidden instead of removed */
    uint32_t frames;
} world;

/* ---- Random arguments ------------------------------------------------------------------------ */

static uint32_t any(world *w, uint32_t below) {
    w->random = w->random * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)w->random * below >> 32);
}

/* Mostly usual values. */
static float number(world *w) {
    static const float odd[] = {0, -0.0f, 1, -1, 1e-30f, 1e30f, 3.4e38f, -3.4e38f, 1e9f, 1e-6f,
                                NAN, INFINITY, -INFINITY, 0.5f};
    if (any(w, 8) == 0) return odd[any(w, sizeof odd / sizeof *odd)];
    return (float)any(w, 2001) / 1000.0f - 0.5f;
}

static void numbers(world *w, float *out, uint32_t count) {
    /* Calls with many numbers are valid half of the time. */
    bool usual = any(w, 2);
    for (uint32_t i = 0; i < count; i++) out[i] = usual ? (float)any(w, 1001) / 1000.0f : number(w);
}

static void rows_of(world *w, float rows[12]) {
    numbers(w, rows, 12);
    if (any(w, 4) == 0) return;
    static const float unit[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    memcpy(rows, unit, sizeof unit);
    rows[3] = number(w), rows[7] = number(w), rows[11] = number(w);
}

static uint64_t one_of(world *w, const uint64_t *ids, uint32_t count) {
    return count ? ids[any(w, count)] : 0;
}

static masu_model any_model(world *w) {
    switch (any(w, 6)) {
        case 0: return (masu_model){(uint64_t)any(w, ~0u) << 32 | any(w, 64)};
        case 1: return (masu_model){one_of(w, w->models.gone, w->models.gone_count)};
        case 2: return (masu_model){one_of(w, w->models.live, w->models.count)};
        default: return masu_model_at(w->s.m, any(w, 8));
    }
}

static masu_instance any_instance(world *w) {
    if (any(w, 5) == 0) return (masu_instance){(uint64_t)any(w, ~0u) << 32 | any(w, 64)};
    return masu_instance_at(w->s.m, any(w, 12));
}

static masu_punctual_light any_light(world *w) {
    switch (any(w, 5)) {
        case 0: return (masu_punctual_light){(uint64_t)any(w, ~0u) << 32 | any(w, 64)};
        case 1: return (masu_punctual_light){one_of(w, w->lights.gone, w->lights.gone_count)};
        case 2: return (masu_punctual_light){one_of(w, w->lights.live, w->lights.count)};
        default: return masu_punctual_light_at(w->s.m, any(w, 3));
    }
}

/* A slot gets an object with a new id. */
static void take(slots *s, uint64_t id) {
    for (uint32_t i = 0; i < s->count; i++) assert_true(s->live[i] != id);
    for (uint32_t i = 0; i < s->gone_count; i++) assert_true(s->gone[i] != id);
    assert_true(s->count < RESERVE);
    s->live[s->count++] = id;
}

static bool has(const slots *s, uint64_t id) {
    for (uint32_t i = 0; i < s->count; i++)
        if (s->live[i] == id) return true;
    return false;
}

static void release(slots *s, uint64_t id) {
    uint32_t at = 0;
    while (s->live[at] != id) at++;
    s->live[at] = s->live[--s->count];
    if (s->gone_count < STALE) s->gone[s->gone_count++] = id;
}

/* ---- Calls ----------------------------------------------------------------------------------- */

static masu_result instance_transform(world *w, masu_detail *d) {
    float rows[12];
    masu_instance_state before, after;
    masu_instance i = any_instance(w);
    rows_of(w, rows);
    masu_result got = masu_instance_get(w->s.m, i, &before, NULL);
    masu_result result = masu_instance_set_transform(w->s.m, i, rows, d);
    if (got == MASU_OK && result != MASU_OK) {
        assert_int_equal(masu_instance_get(w->s.m, i, &after, NULL), MASU_OK);
        assert_memory_equal(&before, &after, sizeof before);
    }
    if (got != MASU_OK) assert_int_equal(result, MASU_ERROR_ARGUMENT);
    return result;
}

static masu_result instance_position(world *w, masu_detail *d) {
    double at[3];
    for (int k = 0; k < 3; k++) at[k] = (double)number(w) * (any(w, 9) ? 1.0 : 1e20);
    return masu_instance_set_position(w->s.m, any_instance(w), at, d);
}

static masu_result instance_shown(world *w, masu_detail *d) {
    return masu_instance_show(w->s.m, any_instance(w), any(w, 3), d);
}

static masu_result look(world *w, masu_detail *d) {
    masu_look before, after,
        l = {.flags = any(w, 9), .hidden_views = any(w, 3), .pick_mask = any(w, 3)};
    masu_instance i = any_instance(w);
    numbers(w, l.tint, 3);
    numbers(w, l.uv_scale, 2);
    l.emission = number(w), l.fade = number(w);
    masu_result got = masu_instance_get_look(w->s.m, i, &before, NULL);
    masu_result result = masu_instance_set_look(w->s.m, i, &l, d);
    if (got == MASU_OK) {
        assert_int_equal(masu_instance_get_look(w->s.m, i, &after, NULL), MASU_OK);
        assert_memory_equal(result == MASU_OK ? &l : &before, &after, sizeof l);
    }
    return result;
}

static masu_result model_transform(world *w, masu_detail *d) {
    float rows[12];
    rows_of(w, rows);
    return masu_model_set_transform(w->s.m, any_model(w), rows, d);
}

static masu_result model_shown(world *w, masu_detail *d) {
    return masu_model_show(w->s.m, any_model(w), any(w, 3), d);
}

static bool is_of_scene(const world *w, masu_model model) {
    for (uint32_t i = 0; i < SCENE; i++)
        if (w->scene[i].id == model.id) return true;
    return false;
}

static masu_result get_light(world *w, uint64_t id) {
    masu_punctual_light_state state;
    return masu_punctual_light_get(w->s.m, (masu_punctual_light){id}, &state, NULL);
}

static masu_result get_model(world *w, uint64_t id) {
    masu_model_state state;
    return masu_model_get(w->s.m, (masu_model){id}, &state, NULL);
}

static masu_result model_add(world *w, masu_detail *d) {
    float rows[12];
    masu_model out = {0};
    rows_of(w, rows);
    masu_result result = masu_model_add(w->s.m, any_model(w), rows, &out, d);
    if (result == MASU_OK && !is_of_scene(w, out)) {
        assert_int_equal(get_model(w, out.id), MASU_OK);
        take(&w->models, out.id);
    }
    return result;
}

static masu_result model_remove(world *w, masu_detail *d) {
    masu_model model = any_model(w);
    masu_result result = masu_model_remove(w->s.m, model, d);
    if (has(&w->models, model.id)) {
        assert_int_equal(result, MASU_OK);
        release(&w->models, model.id);
        /* Lights that were attached to it went with it. */
        for (uint32_t i = w->lights.count; i-- > 0;)
            if (get_light(w, w->lights.live[i]) != MASU_OK) release(&w->lights, w->lights.live[i]);
    }
    if (is_of_scene(w, model)) assert_int_equal(result, MASU_OK);
    for (uint32_t i = 0; i < w->models.gone_count; i++)
        assert_int_equal(get_model(w, w->models.gone[i]), MASU_ERROR_ARGUMENT);
    return result;
}

static masu_result node(world *w, masu_detail *d) {
    float rows[12];
    rows_of(w, rows);
    return masu_model_node_set(w->s.m, any_model(w), any(w, 5), rows, d);
}

static masu_punctual_light_state light_state(world *w) {
    masu_punctual_light_state l = {.range = 4,
                                   .radius = 0.05f,
                                   .spot = any(w, 3),
                                   .inner = 0.2f,
                                   .outer = 0.5f,
                                   .shape = (masu_light_shape)any(w, 4),
                                   .two_sided = any(w, 3)};
    if (any(w, 2))
        return (masu_punctual_light_state){.range = 4,
                                           .radius = 0.05f,
                                           .color = {1, (float)any(w, 5), 1},
                                           .position = {(double)any(w, 5), 1, 1},
                                           .no_shadow = any(w, 2)};
    for (int k = 0; k < 3; k++) l.position[k] = (double)number(w);
    numbers(w, l.direction, 3);
    numbers(w, l.color, 3);
    numbers(w, l.half_axis, 3);
    if (any(w, 4) == 0)
        l.range = number(w), l.radius = number(w), l.inner = number(w), l.outer = number(w);
    if (any(w, 3) == 0) l.instance = any_instance(w);
    return l;
}

static masu_result light_set(world *w, masu_detail *d) {
    masu_punctual_light light = any_light(w);
    masu_punctual_light_state before, after, l = light_state(w);
    masu_result got = masu_punctual_light_get(w->s.m, light, &before, NULL);
    masu_result result = masu_punctual_light_set(w->s.m, light, &l, d);
    if (got == MASU_OK && result != MASU_OK) {
        assert_int_equal(masu_punctual_light_get(w->s.m, light, &after, NULL), MASU_OK);
        assert_memory_equal(&before, &after, sizeof before);
    }
    if (got != MASU_OK) assert_int_equal(result, MASU_ERROR_ARGUMENT);
    return result;
}

static masu_result light_add(world *w, masu_detail *d) {
    masu_punctual_light out = {0};
    masu_punctual_light_state l = light_state(w);
    masu_result result = masu_punctual_light_add(w->s.m, &l, &out, d);
    if (result == MASU_OK) take(&w->lights, out.id);
    /* The reserve is full. A copy of a model with a light takes one of its slots, too. */
    if (result == MASU_ERROR_LIMIT) assert_true(w->lights.count + w->models.count >= RESERVE);
    return result;
}

static masu_result light_remove(world *w, masu_detail *d) {
    masu_punctual_light light = any_light(w);
    masu_result result = masu_punctual_light_remove(w->s.m, light, d);
    if (has(&w->lights, light.id)) {
        assert_int_equal(result, MASU_OK);
        release(&w->lights, light.id);
    }
    for (uint32_t i = 0; i < w->lights.gone_count; i++)
        assert_int_equal(get_light(w, w->lights.gone[i]), MASU_ERROR_ARGUMENT);
    return result;
}

static masu_result material(world *w, masu_detail *d) {
    masu_material m =
        any(w, 6) ? masu_material_at(w->s.m, any(w, 7)) : (masu_material){any(w, ~0u)};
    masu_material_state before, after;
    masu_result got = masu_material_get(w->s.m, m, &before, NULL);
    if (got != MASU_OK) before = (masu_material_state){.roughness = 0.5f};
    masu_material_state state = before;
    numbers(w, state.base_color, 3);
    if (any(w, 2)) numbers(w, state.emissive, 3);
    if (any(w, 4) == 0)
        state.roughness = number(w), state.metallic = number(w), state.opacity = number(w);
    if (any(w, 8) == 0) state.texture = any(w, 4);
    masu_result result = masu_material_set(w->s.m, m, &state, d);
    if (got == MASU_OK && result != MASU_OK) {
        assert_int_equal(masu_material_get(w->s.m, m, &after, NULL), MASU_OK);
        assert_memory_equal(&before, &after, sizeof before);
    }
    return result;
}

static masu_result texture(world *w, masu_detail *d) {
    static uint32_t texels[16 * 16];
    VkRect2D rect = {{(int32_t)any(w, 18) - 1, (int32_t)any(w, 18) - 1}, {any(w, 18), any(w, 18)}};
    for (uint32_t i = 0; i < 256; i++) texels[i] = any(w, ~0u);
    return masu_texture_write(w->s.m, any(w, 4), any(w, 3) ? NULL : &rect, texels,
                              any(w, 3) ? 0 : any(w, 80), d);
}

static masu_result governor(world *w, masu_detail *d) {
    masu_governor_setting g = {
        .mode = (masu_governor_mode)any(w, 4), .rung = any(w, 3), .target_ms = number(w) * 20};
    return masu_governor_set(w->s.m, &g, d);
}

static masu_result frame(world *w, masu_detail *d) {
    masu_particle particles[3];
    masu_frame_desc f = {MASU_FRAME_DESC, .time_step = 0.02f};
    masu_commands commands;
    uint32_t count = any(w, 4);
    memset(particles, 0, sizeof particles);
    for (uint32_t i = 0; i < count && i < 3; i++) {
        particles[i] =
            (masu_particle){.position = {(double)number(w), (double)number(w), (double)number(w)},
                            .half_width = 0.2f,
                            .color = {1, 1, 1},
                            .opacity = 0.5f,
                            .texture = any(w, 4)};
        if (any(w, 6) == 0) particles[i].half_width = number(w), particles[i].opacity = number(w);
    }
    f.particles = particles, f.particle_count = count;
    if (any(w, 3) == 0) f.rung = any(w, 3);
    f.cut = any(w, 4) == 0;
    if (any(w, 8) == 0) f.time_step = number(w);
    if (any(w, 2)) { /* else a frame that may be refused */
        f.particle_count = 0;
        f.time_step = 0.02f;
        f.rung = any(w, 2);
        const uint16_t *pixels = draw_image(&w->s, &f, MASU_READBACK_HDR, NULL);
        for (uint32_t i = 0; i < WIDTH * HEIGHT * 4; i++)
            assert_true((pixels[i] & 0x7C00u) != 0x7C00u);
        w->frames++;
        return MASU_OK;
    }
    masu_result result = masu_frame(w->s.m, &f, &commands, d);
    char error[ERROR_SIZE];
    if (result == MASU_OK)
        assert_ok(masu_headless_run(&w->s.host, commands.buffer, error, sizeof error));
    return result;
}

typedef struct call {
    const char *name;
    masu_result (*make)(world *, masu_detail *);
    uint32_t good, bad;
    char why[200]; /* the last refusal */
} call;

static void any_sequence_of_calls_is_obeyed_or_refused(void **state) {
    (void)state;
    static world w;
    static call calls[] = {{"instance_set_transform", instance_transform, 0, 0, ""},
                           {"instance_set_position", instance_position, 0, 0, ""},
                           {"instance_show", instance_shown, 0, 0, ""},
                           {"instance_set_look", look, 0, 0, ""},
                           {"model_set_transform", model_transform, 0, 0, ""},
                           {"model_show", model_shown, 0, 0, ""},
                           {"model_add", model_add, 0, 0, ""},
                           {"model_remove", model_remove, 0, 0, ""},
                           {"model_node_set", node, 0, 0, ""},
                           {"punctual_light_set", light_set, 0, 0, ""},
                           {"punctual_light_add", light_add, 0, 0, ""},
                           {"punctual_light_remove", light_remove, 0, 0, ""},
                           {"material_set", material, 0, 0, ""},
                           {"texture_write", texture, 0, 0, ""},
                           {"governor_set", governor, 0, 0, ""},
                           {"frame", frame, 0, 0, ""}};
    const uint32_t kinds = sizeof calls / sizeof *calls;
    const char *longer = getenv("LONG");
    const uint32_t count = longer && *longer ? 50 * CALLS : CALLS;
    masu_session_desc d = test_desc("test_reserve", WIDTH, HEIGHT);
    memset(&w, 0, sizeof w);
    w.random = 55;
    d.desc.rung_count = 2;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.rungs[1] = (masu_rung){.scale = 0.5f};
    d.desc.reserve = (masu_reserve){.models = RESERVE,
                                    .lights = RESERVE,
                                    .particles = 2,
                                    .textures = 2,
                                    .texture_size = {16, 16}};
    d.desc.instance_looks = d.desc.double_positions = d.desc.mutable_materials =
        d.desc.area_lights = 1;
    d.desc.governor = (masu_governor_desc){.mode = MASU_GOVERNOR_ON, .target_ms = 50};
    d.desc.readback = MASU_READBACK_HDR;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    wrap_reset();
    open_session(&w.s, &d);
    for (uint32_t i = 0; i < SCENE; i++) {
        w.scene[i] = masu_model_at(w.s.m, i);
        assert_true(w.scene[i].id != 0);
    }
    uint64_t made = wrap.setup_calls;
    for (uint32_t i = 0; i < count; i++) {
        /* Every tenth call is a frame. */
        call *c = &calls[i % 10 ? any(&w, kinds - 1) : kinds - 1];
        masu_detail detail;
        memset(&detail, 0, sizeof detail);
        masu_result result = c->make(&w, &detail);
        if (result == MASU_OK) {
            c->good++;
            continue;
        }
        c->bad++;
        if (result != MASU_ERROR_ARGUMENT && result != MASU_ERROR_LIMIT &&
            result != MASU_ERROR_STATE)
            fail_msg("call %u, %s: %s: %s", i, c->name, masu_result_string(result), detail.text);
        if (detail.result != result || !detail.what || !*detail.what || !*detail.text ||
            strchr(detail.text, '\n'))
            fail_msg("call %u, %s: %s without one line of reason: '%s'", i, c->name,
                     masu_result_string(result), detail.text);
        memcpy(c->why, detail.text, sizeof c->why);
    }
    assert_int_equal(wrap.setup_calls, made);
    assert_true(w.frames > count / 40);
    print_message("%u calls, %u frames drawn and read; obeyed, refused:\n", count, w.frames);
    for (uint32_t k = 0; k < kinds; k++) {
        print_message("  %-24s %6u %6u  %s\n", calls[k].name, calls[k].good, calls[k].bad,
                      calls[k].why);
    }
    for (uint32_t k = 0; k < kinds; k++) assert_true(calls[k].good > 0 && calls[k].bad > 0);
    close_session(&w.s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_sequence_of_calls_is_obeyed_or_refused)};
    return cmocka_run_group_tests_name("calls", tests, NULL, NULL);
}

/* test_bench_settings.c: the settings of `masu bench`: each has one name, and a parent that
 * precedes it and differs from it; settings without effect in a scene are dropped with a reason,
 * and no others. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "bench/settings.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

static masu_setting settings[MASU_SETTINGS_MOST];

static uint32_t find(uint32_t count, const char *id) {
    for (uint32_t i = 0; i < count; i++) {
        if (!settings[i].dropped[0] && !strcmp(settings[i].id, id)) return i;
    }
    return count;
}

static void check_names(uint32_t count) {
    /* allowed in file names */
    static const char good[] = "abcdefghijklmnopqrstuvwxyz0123456789_.=+-";
    assert_string_equal(settings[0].id, "base");
    for (uint32_t i = 0; i < count; i++) {
        const masu_setting *s = &settings[i];
        if (s->dropped[0]) continue;
        assert_int_equal(find(count, s->id), i);
        assert_true(find(count, s->parent) < i || i == 0);
        assert_int_equal(strspn(s->id, good), strlen(s->id));
        assert_true(strlen(s->id) + 1 < MASU_SETTING_ID);
        assert_true(s->rung.scale >= 0.2f && s->rung.scale <= 1.0f);
    }
}

static const masu_scene_data everything = {
    .sdf = 1, .lods = 1, .placed_occluders = 1, .instances = 1, .lights = 1,
    .shadow_lights = 1, .shadow_cascades = 4,
    .shadow_distance = 80};

static masu_plan_info plan_with(const char *const *passes, uint32_t count) {
    masu_plan_info plan;
    memset(&plan, 0, sizeof plan);
    plan.pass_count = count;
    for (uint32_t p = 0; p < count; p++)
        plan.passes[p] = (masu_plan_pass){.name = passes[p], .active = 1};
    return plan;
}

static void names_are_unique_and_parents_come_first(void **state) {
    (void)state;
    static const char *const passes[] = {"ao", "specular_guide", "cascade_0"};
    const masu_plan_info plan = plan_with(passes, 3);
    uint32_t few = masu_settings_make(true, settings);
    masu_settings_fit(settings, few, masu_scene_of(&everything), &plan);
    check_names(few);
    uint32_t all = masu_settings_make(false, settings);
    masu_settings_fit(settings, all, masu_scene_of(&everything), &plan);
    check_names(all);
    assert_true(few >= 8 && few < all && all <= MASU_SETTINGS_MOST);
    uint32_t scales = 0;
    for (uint32_t i = 0; i < all; i++) scales += !strcmp(settings[i].technique, "scale");
    assert_int_equal(scales, 16); /* 15/16 to 7/16, 0.4, and 0.35 to 0.2 */
    assert_true(find(all, "scale=0.4") < all);
    assert_true(find(all, "scale=0.5+easu=fast") < all);
    assert_true(find(all, "shadow_refresh=1-2-4-8") < all);
}

static void check_dropped(const char *id, uint32_t count, const char *why) {
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(settings[i].id, id) != 0 || !settings[i].dropped[0]) continue;
        if (!strstr(settings[i].dropped, why)) fail_msg("%s: %s", id, settings[i].dropped);
        return;
    }
    fail_msg("%s is not dropped", id);
}

static void a_scene_of_nothing_leaves_what_is_done_to_pictures(void **state) {
    (void)state;
    static const masu_scene scene;
    const masu_plan_info plan = plan_with(NULL, 0);
    uint32_t count = masu_settings_make(false, settings);
    masu_settings_fit(settings, count, &scene, &plan);
    check_names(count);
    check_dropped("march_steps=64", count, "no SDF");
    check_dropped("ao=off", count, "no screen-space ambient occlusion");
    check_dropped("specular=off", count, "no reflections");
    check_dropped("shadow_refresh=4-4-4-4", count, "no shadow map");
    check_dropped("lod_error=3", count, "no LODs");
    check_dropped("occlusion=off", count, "no occluders");
    check_dropped("frustum=off", count, "no polygons");
    check_dropped("light_tiles=off", count, "no punctual lights");
    check_dropped("shadow_distance=0.5", count, "no shadow map");
    check_dropped("specular_cutoff=0.25", count, "no reflections");
    check_dropped("specular_frames=64", count, "no reflections");
    /* The remaining bundles: the cheap one at 0.4 has fast EASU and no RCAS, the lean one is
     * temporal. */
    assert_true(find(count, "scale=0.4+easu=fast+sharpen=off") < count);
    check_dropped("scale=0.75+temporal=on+march_steps=128+lod_error=2+ao_slices=1+ao_steps=4+"
                  "shadow_refresh=2-4-8-8+"
                  "specular_reuse_taps=4+specular_filter_taps=6",
                  count, "");
    for (uint32_t i = 0; i < count; i++) {
        if (settings[i].dropped[0]) continue;
        const masu_rung *r = &settings[i].rung;
        assert_true(!r->march_steps && !r->ao && !r->specular && !r->shadow_refresh[0]);
        if (r->scale >= 1.0f) assert_int_equal(r->easu, MASU_EASU_AUTO);
    }
}

static void a_scene_of_everything_keeps_everything(void **state) {
    (void)state;
    static const char *const passes[] = {"ao", "specular_guide", "cascade_0", "bounce_sum"};
    const masu_plan_info plan = plan_with(passes, 4);
    uint32_t count = masu_settings_make(false, settings), dropped = 0;
    masu_settings_fit(settings, count, masu_scene_of(&everything), &plan);
    check_names(count);
    for (uint32_t i = 0; i < count; i++) dropped += settings[i].dropped[0] != 0;
    /* SMAA HIGH and temporal at 1 and 0.5 are both techniques and bundles, and so is sharpen=off.
     * At scale 1 nothing is sharpened, so the soft bundles there equal their other knob. */
    assert_int_equal(dropped, 9);
    check_dropped("sharpen=off", count, "nothing is sharpened");
    check_dropped("scale=0.5+sharpen=off", count, "equal to another setting");
    check_dropped("aa=smaa-high", count, "equal to another setting");
    check_dropped("scale=0.5+aa=smaa-high", count, "equal to another setting");
    check_dropped("temporal=on", count, "equal to another setting");
    check_dropped("scale=0.5+temporal=on", count, "equal to another setting");
    check_dropped("sharpen=off+aa=smaa-high", count, "nothing is sharpened");
    check_dropped("sharpen=off+march_steps=128", count, "nothing is sharpened");
    check_dropped("sharpen=off+shadow_cascades=2", count, "nothing is sharpened");
    if (count - dropped > 140) fail_msg("%u settings", count - dropped);
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        uint32_t turned = 0;
        for (uint32_t i = 1; i < count; i++)
            turned += masu_knob_differs(k, &settings[i].rung, &settings[0].rung);
        if (!turned && strcmp(k->name, "upscale") != 0) fail_msg("%s is never turned", k->name);
    }
    static const char *const there[] = {
        "specular_cutoff=0.25",
        "specular_cutoff=0.5",
        "specular_frames=16",
        "specular_frames=64",
        "scale=0.9375+sharpen=off",
        "scale=0.28+temporal=on",
        "scale=0.2+temporal=on",
        ("scale=0.22+temporal=on+march_steps=128+lod_error=2+ao_slices=1+ao_steps=4+"
         "shadow_refresh=2-4-8-8+specular_reuse_taps=4+specular_filter_taps=6"),
        "scale=0.4375+sharpen=off",
        "scale=0.4+sharpen=off+aa=smaa-high",
        "scale=0.625+sharpen=off+march_steps=128",
        "scale=0.625+sharpen=off+shadow_cascades=2"};
    for (size_t i = 0; i < sizeof there / sizeof *there; i++)
        assert_true(find(count, there[i]) < count);
    uint32_t half = find(count, "shadow_distance=40"); /* of the scene's 80 */
    assert_true(half < count && settings[half].rung.shadow_distance > 39.99f &&
                settings[half].rung.shadow_distance < 40.01f);
}

static void a_cutoff_that_is_the_scenes_own_is_the_base(void **state) {
    (void)state;
    static const char *const passes[] = {"specular_guide"};
    const masu_plan_info plan = plan_with(passes, 1);
    const masu_scene_data scene = {.specular_cutoff = 0.5f};
    uint32_t count = masu_settings_make(false, settings);
    masu_settings_fit(settings, count, masu_scene_of(&scene), &plan);
    check_names(count);
    check_dropped("specular_cutoff=0.5", count, "the scene's value");
    assert_true(find(count, "specular_cutoff=0.25") < count);
}

static void cascades_that_are_the_scenes_own_are_the_base(void **state) {
    (void)state;
    static const char *const passes[] = {"cascade_0"};
    const masu_plan_info plan = plan_with(passes, 1);
    for (uint32_t n = 1; n <= 3; n++) {
        const masu_scene_data scene = {.shadow_cascades = n, .shadow_distance = 80};
        uint32_t count = masu_settings_make(false, settings);
        masu_settings_fit(settings, count, masu_scene_of(&scene), &plan);
        check_names(count);
        if (n < 3)
            check_dropped("shadow_cascades=2", count, "does not have more");
        else
            assert_true(find(count, "shadow_cascades=2") < count);
    }
}

static void plans_are_compared_by_passes_sizes_and_bytes(void **state) {
    (void)state;
    static const char *const passes[] = {"gbuffer", "light"};
    const masu_plan_info a = plan_with(passes, 2);
    masu_plan_info b = a;
    assert_true(masu_settings_same_plan(&a, &b));
    b.passes[1].active = 0;
    assert_false(masu_settings_same_plan(&a, &b));
    b = a;
    b.memory.device_bytes++;
    assert_false(masu_settings_same_plan(&a, &b));
    b = a;
    b.rungs[0].render_height++;
    assert_false(masu_settings_same_plan(&a, &b));
}

static void knobs_are_printed_as_json(void **state) {
    (void)state;
    const masu_rung rung = {
        .scale = 0.5f, .aa = MASU_AA_FXAA, .ao_steps = 4, .shadow_refresh = {1, 2, 4, 8}};
    uint32_t seen = 0;
    for (const masu_knob *k = masu_knob_table(); k->name; k++) {
        static const char *const wanted[][2] = {{"scale", "0.5"},
                                                {"aa", "\"fxaa\""},
                                                {"ao_steps", "4"},
                                                {"easu", "\"auto\""},
                                                {"shadow_refresh", "[1, 2, 4, 8]"}};
        char text[64];
        masu_knob_json(k, &rung, text, sizeof text);
        for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
            if (strcmp(k->name, wanted[i][0]) != 0) continue;
            assert_string_equal(text, wanted[i][1]);
            seen++;
        }
    }
    assert_int_equal(seen, 5);
    assert_int_equal(masu_setting_period(&rung), 8);
}

static void check_names_read_again(uint32_t count) {
    char error[600], name[MASU_SETTING_ID];
    masu_rung rung;
    for (uint32_t i = 0; i < count; i++) {
        if (settings[i].dropped[0]) continue;
        if (!masu_setting_parse(settings[i].id, &rung, error, sizeof error)) fail_msg("%s", error);
        if (memcmp(&rung, &settings[i].rung, sizeof rung) != 0)
            fail_msg("%s is another rung", settings[i].id);
        masu_setting_name(&rung, name);
        assert_string_equal(name, settings[i].id);
    }
}

/* Names can be parsed back to the rung, for every measured setting: before and after they are
 * fitted to a scene with odd sizes. */
static void names_are_read_again(void **state) {
    (void)state;
    static const char *const passes[] = {"ao", "specular_guide", "cascade_0"};
    const masu_plan_info plan = plan_with(passes, 3);
    char error[600], name[MASU_SETTING_ID];
    masu_rung rung;
    masu_scene_data scene = everything;
    scene.shadow_distance = 81.2345f;
    for (int quick = 0; quick < 2; quick++) {
        uint32_t count = masu_settings_make(quick, settings);
        check_names_read_again(count);
        masu_settings_fit(settings, count, masu_scene_of(&scene), &plan);
        check_names_read_again(count);
    }
    /* In any order, with values of all kinds. */
    assert_true(masu_setting_parse("ao_steps=3+lod_error=-1+shadow_refresh=1-2-4-8+scale=0.625+"
                                   "shadow_distance=1e+09+frustum=off",
                                   &rung, error, sizeof error));
    masu_setting_name(&rung, name);
    assert_string_equal(name, "scale=0.625+lod_error=-1+ao_steps=3+shadow_distance=1e+09+"
                              "shadow_refresh=1-2-4-8+frustum=off");
}

/* Both ends and the centre of each knob, separately and all together. */
static void every_knob_has_its_part_of_a_name(void **state) {
    (void)state;
    char error[600], name[1024], part[64];
    for (int n = 0; n < 3; n++) {
        masu_rung all, rung, read;
        size_t used = 0;
        masu_setting_parse("base", &all, error, sizeof error);
        for (const masu_knob *k = masu_knob_table(); k->name; k++) {
            masu_setting_parse("base", &rung, error, sizeof error);
            double value = n == 0 ? k->min : n == 1 ? k->max : k->min + (k->max - k->min) / 3.0;
            if (k->kind != MASU_KNOB_FLOAT) value = (double)(uint32_t)value;
            for (uint32_t i = 0; i < k->values; i++) {
                masu_knob_set(k, &rung, i, value);
                masu_knob_set(k, &all, i, value);
            }
            masu_knob_text(k, &rung, part, sizeof part);
            used += (size_t)snprintf(name + used, sizeof name - used, "%s%s=%s", used ? "+" : "",
                                     k->name, part);
            const char *end = masu_knob_from_text(k, part, &read);
            assert_true(end && !*end);
            assert_false(masu_knob_differs(k, &read, &rung));
        }
        if (!masu_setting_parse(name, &read, error, sizeof error)) fail_msg("%s", error);
        assert_memory_equal(&read, &all, sizeof read);
    }
}

static void names_that_are_none_are_refused(void **state) {
    (void)state;
    static const char *const bad[][2] = {
        {"", "''"},
        {"scale", "'scale'"},
        {"scale=", "scale: expected a number from 0 to 1, found ''"},
        {"scale=half", "found 'half'"},
        {"scale=nan", "found 'nan'"},
        {"scale=inf", "found 'inf'"},
        {"scale=0.5x", "found '0.5x'"},
        {"scale=1.5", "found '1.5'"},
        {"scale=1e+09", "found '1e'"},
        {"aa=off+lod_error=1e+10", "lod_error: expected"},
        {"scale=0.5+", "''"},
        {"scale=0.5+scale=0.4", "'scale=0.4': the knob is already set"},
        {"aa=smaa", "found 'smaa'"},
        {"aa=high", "aa: expected one of auto, off, fxaa, smaa-low"},
        {"aa=smaa-high2", "found 'smaa-high2'"},
        {"base+aa=fxaa", "'base'"},
        {"speed=3", "'speed=3'"},
        {"ao_steps=-1", "found '-1'"},
        {"ao_steps= 1", "found ' 1'"},
        {"ao_steps=17", "ao_steps: expected a whole number from 0 to 16"},
        {"ao_steps=99999999999", "found '99999999999'"},
        {"shadow_resolution=8", "expected 0 or a whole number from 16 to 8192"},
        {"shadow_refresh=1-2-4", "4 whole numbers, each from 0 to 64"},
        {"shadow_refresh=1-2-4-65", "found '1-2-4-65'"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        char error[600] = "";
        masu_rung rung;
        if (masu_setting_parse(bad[i][0], &rung, error, sizeof error))
            fail_msg("'%s' is taken", bad[i][0]);
        if (!strstr(error, bad[i][1]) || strchr(error, '\n'))
            fail_msg("'%s': %s", bad[i][0], error);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_are_unique_and_parents_come_first),
        cmocka_unit_test(a_scene_of_nothing_leaves_what_is_done_to_pictures),
        cmocka_unit_test(a_scene_of_everything_keeps_everything),
        cmocka_unit_test(a_cutoff_that_is_the_scenes_own_is_the_base),
        cmocka_unit_test(cascades_that_are_the_scenes_own_are_the_base),
        cmocka_unit_test(plans_are_compared_by_passes_sizes_and_bytes),
        cmocka_unit_test(knobs_are_printed_as_json),
        cmocka_unit_test(names_are_read_again),
        cmocka_unit_test(every_knob_has_its_part_of_a_name),
        cmocka_unit_test(names_that_are_none_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

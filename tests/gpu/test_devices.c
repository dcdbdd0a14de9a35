/* test_devices.c: classes of scenes with the limits of real devices (platform/devices.inc). Each
 * device runs each class or lacks a named feature, with the same pixels as an unlimited device
 * without that feature; no layout exceeds a limit. docs/devices.md has the resulting tables. */
#include "support/support.h"
#include "support/files.h"
#include "support/wrap.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 66, H = 48, ROWS = 32, LINE = 1024 };

/* A feature that a plan may lack, found by one of its passes. */
typedef struct feature {
    const char *name, *pass;
} feature;

enum { REFLECTIONS, BOUNCE, CULLING, FEATURES, EMISSION = FEATURES };
static const feature features[FEATURES] = {{"reflections", "specular_composite"},
                                           {"live bounce", "bounce_sum"},
                                           {"occlusion culling", "cull"}};

typedef struct scene_class {
    const char *title, *scene;
    masu_rung rung;
} scene_class;

static const scene_class classes[] = {
    {"polygons", "test_lods", {.aa = MASU_AA_FXAA}},
    {"SDF, edges", "test_sdf_looks", {.silhouettes = MASU_ON}},
    {"lights", "small_lamps", {.specular = MASU_OFF}},
    {"shadow maps", "test_shadows", {.aa = MASU_AA_FXAA}},
    {"textures", "test_texture_mask", {.aa = MASU_AA_FXAA}},
    {"skins, temporal", "test_skin", {.temporal = MASU_ON, .scale = 0.5f, .specular = MASU_OFF}},
    {"transparent", "test_pane", {.aa = MASU_AA_AUTO}},
    {"occluders", "test_occluders", {.aa = MASU_AA_AUTO}},
    {"reflections", "test_reflections", {.aa = MASU_AA_AUTO}},
    {"textured reflections", "test_mirror_textures", {.aa = MASU_AA_AUTO}},
    {"reflections, lights", "test_reserve", {.aa = MASU_AA_AUTO}},
    {"live bounce", "test_bounce_lit", {.aa = MASU_AA_AUTO}},
    {"all at once", "test_lit_mirror", {.aa = MASU_AA_AUTO}},
};
enum { CLASSES = sizeof classes / sizeof *classes };

static uint32_t warnings; /* about maxPerStageDescriptorStorageBuffers */

static void count_warning(void *user, masu_log_level level, const char *text) {
    (void)user;
    warnings += level == MASU_LOG_WARNING &&
                strstr(text, "maxPerStageDescriptorStorageBuffers is ") != NULL;
}

static char cells[ROWS][CLASSES][128];
static wrap_most needs[CLASSES];

/* ---- Plans ----------------------------------------------------------------------------------- */

static int is_active(const masu_plan_info *plan, const char *name) {
    return pass_of(plan, name)->active != 0;
}

static int emits_apart(const masu_plan_info *plan) {
    const masu_plan_pass *gbuffer = pass_of(plan, "gbuffer");
    for (uint32_t i = 0; i < 6; i++) {
        if (gbuffer->writes[i] && !strcmp(gbuffer->writes[i], "hdr")) return 1;
    }
    return 0;
}

/* The features that `is` lacks and `whole` has, one bit each. */
static uint32_t lacks(const masu_plan_info *is, const masu_plan_info *whole) {
    uint32_t bits = 0;
    for (uint32_t f = 0; f < FEATURES; f++)
        bits |= (uint32_t)(is_active(whole, features[f].pass) && !is_active(is, features[f].pass))
                << f;
    return bits | (uint32_t)(emits_apart(whole) && !emits_apart(is)) << EMISSION;
}

static void turn_off(masu_desc *d, uint32_t bits) {
    for (uint32_t r = 0; r < d->rung_count; r++) {
        if (bits >> REFLECTIONS & 1) d->rungs[r].specular = MASU_OFF;
        if (bits >> BOUNCE & 1) d->rungs[r].bounce = MASU_OFF;
        if (bits >> CULLING & 1) d->rungs[r].occlusion = MASU_OFF;
    }
    if (bits >> EMISSION & 1) d->deny.color_attachments = 4;
}

static void assert_same_plan(const masu_plan_info *a, const masu_plan_info *b) {
    for (uint32_t p = 0; p < a->pass_count; p++) {
        if (a->passes[p].active != b->passes[p].active)
            fail_msg("pass %s: %u, %u", a->passes[p].name, a->passes[p].active,
                     b->passes[p].active);
    }
    for (uint32_t i = 0; i < a->image_count; i++) {
        const masu_plan_image *x = &a->images[i], *y = &b->images[i];
        if (x->used != y->used ||
            (x->used && (x->format != y->format || x->width != y->width || x->height != y->height)))
            fail_msg("image %s differs", x->name);
    }
}

/* ---- Images ---------------------------------------------------------------------------------- */

static uint8_t *render(masu_session *s, const masu_desc *d) {
    char error[ERROR_SIZE];
    own_renderer x;
    masu_commands commands;
    uint8_t *out = malloc((size_t)W * H * 4);
    assert_non_null(out);
    memset(&wrap.most, 0, sizeof wrap.most);
    make_own(s, &x, d);
    for (uint32_t f = 0; f < 3; f++) {
        masu_frame_desc frame = {MASU_FRAME_DESC};
        assert_int_equal(masu_frame(x.m, &frame, &commands, NULL), MASU_OK);
        assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
    }
    assert_ok(masu_headless_target_read(&s->host, &x.target, error, sizeof error));
    memcpy(out, x.target.mapped, (size_t)W * H * 4);
    unmake_own(s, &x);
    return out;
}

static void assert_within(const masu_device_row *row, const wrap_most *most) {
    VkPhysicalDeviceProperties p = {.apiVersion = UINT32_MAX};
    memset(&p.limits, 0xFF, sizeof p.limits);
    masu_device_row_limit(row, &p);
    const VkPhysicalDeviceLimits *l = &p.limits;
    assert_true(most->all > 0);
    assert_in_range(most->uniform_buffers, 0, l->maxPerStageDescriptorUniformBuffers);
    assert_in_range(most->storage_buffers, 0, l->maxPerStageDescriptorStorageBuffers);
    assert_in_range(2 * most->storage_buffers, 0, l->maxDescriptorSetStorageBuffers);
    assert_in_range(most->sampled_images, 0, l->maxPerStageDescriptorSampledImages);
    assert_in_range(most->sampled_images, 0, l->maxPerStageDescriptorSamplers);
    assert_in_range(most->storage_images, 0, l->maxPerStageDescriptorStorageImages);
    assert_in_range(most->all + most->attachments, 0, l->maxPerStageResources);
    assert_in_range(most->sets, 0, l->maxBoundDescriptorSets);
    assert_in_range(most->push_bytes, 0, l->maxPushConstantsSize);
    assert_in_range(most->attachments, 0, l->maxColorAttachments);
    assert_in_range(most->attachments, 0, l->maxFragmentOutputAttachments);
    assert_in_range(most->attachments, 0, l->maxFragmentCombinedOutputResources);
}

/* ---- One class ------------------------------------------------------------------------------- */

/* Writes "on", or what is off. */
static void describe(char *cell, size_t size, uint32_t lack) {
    size_t n = 0;
    snprintf(cell, size, "on");
    for (uint32_t f = 0; f < FEATURES; f++) {
        if (!(lack >> f & 1)) continue;
        n += (size_t)snprintf(cell + n, size - n, "%s%s", n ? ", " : "no ", features[f].name);
    }
    if (lack >> EMISSION & 1)
        snprintf(cell + n, size - n, "%semission shares albedo", n ? ", " : "");
}

static void run_class(uint32_t c) {
    static masu_plan_info whole, plan, expected;
    masu_session s;
    masu_detail detail;
    masu_session_desc d = test_desc(classes[c].scene, W, H);
    uint8_t *references[1 << (FEATURES + 1)] = {NULL};
    uint32_t drawn = 0;
    wrap_reset();
    d.no_renderer = true;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.desc.debug.counters = 0; /* as in a game: the layouts have no counters */
    d.desc.rung_count = 1;
    d.desc.rungs[0] = classes[c].rung;
    d.desc.log = count_warning;
    open_session(&s, &d);
    masu_desc desc = s.desc;
    if (masu_plan(&desc, &whole, &detail)) fail_msg("%s: %s", classes[c].scene, detail.text);
    references[0] = render(&s, &desc);
    needs[c] = wrap.most;
    for (uint32_t i = 0; masu_device_row_at(i); i++) {
        const masu_device_row *row = masu_device_row_at(i);
        wrap.row = row;
        if (masu_plan(&desc, &plan, &detail)) {
            assert_true(detail.text[0] && detail.what && detail.needed > detail.given);
            snprintf(cells[i][c], sizeof cells[i][c], "rejected: %s", detail.what);
            fail_msg("%s on %s: %s", classes[c].scene, row->title, detail.text);
        }
        uint32_t lack = lacks(&plan, &whole);
        describe(cells[i][c], sizeof cells[i][c], lack);
        masu_desc less = desc;
        turn_off(&less, lack);
        wrap.row = NULL;
        assert_int_equal(masu_plan(&less, &expected, NULL), MASU_OK);
        assert_same_plan(&plan, &expected);
        for (uint32_t k = 0; k < plan.image_count; k++) {
            if (plan.images[k].used)
                assert_in_range(plan.images[k].width > plan.images[k].height
                                    ? plan.images[k].width
                                    : plan.images[k].height,
                                1, row->limits[0]);
        }
        /* Of devices with the same plan, the one with the lowest limits is last in the table. */
        int last = !masu_device_row_at(i + 1);
        if ((drawn >> lack & 1) && !last) continue;
        drawn |= 1u << lack;
        if (!references[lack]) references[lack] = render(&s, &less);
        wrap.row = row;
        warnings = 0;
        uint8_t *image = render(&s, &desc);
        uint32_t dropped = 0; /* the log names each feature that storage buffers cost */
        for (uint32_t f = 0; f < FEATURES; f++) dropped += lack >> f & 1;
        assert_int_equal(warnings, dropped);
        assert_within(row, &wrap.most);
        uint32_t differs = max_difference(image, references[lack], (size_t)W * H * 4);
        free(image);
        if (differs) fail_msg("%s on %s differs by %u", classes[c].scene, row->title, differs);
    }
    wrap_reset();
    for (size_t i = 0; i < sizeof references / sizeof *references; i++) free(references[i]);
    close_session(&s);
}

static void each_class_runs_or_lacks_a_named_feature(void **state) {
    (void)state;
    for (uint32_t c = 0; c < CLASSES; c++) run_class(c);
}

/* Calls and SPIR-V of Vulkan 1.0 alone, which the validation layer checks: the same image. */
static void a_vulkan_1_0_device_draws_the_same(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_both", "test_reserve", "test_texture_mask"};
    for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
        uint8_t *images[2];
        for (int old = 0; old < 2; old++) {
            masu_session s;
            masu_session_desc d = test_desc(scenes[k], W, H);
            wrap_reset();
            wrap.row = old ? masu_device_row_of("g52") : masu_device_row_of("g610");
            d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
            d.host.vulkan_1_0 = old;
            d.desc.rung_count = 1;
            open_session(&s, &d);
            assert_int_equal(s.host.properties.apiVersion == VK_API_VERSION_1_0, old);
            images[old] = malloc((size_t)W * H * 4);
            assert_non_null(images[old]);
            draw_rung(&s, 0, images[old]);
            close_session(&s);
        }
        uint32_t differs = max_difference(images[0], images[1], (size_t)W * H * 4);
        if (differs) fail_msg("%s differs by %u", scenes[k], differs);
        free(images[0]);
        free(images[1]);
    }
    wrap_reset();
}

/* A limit below the minimum of the specification: enough, and one less, which is rejected by name. */
static void a_device_below_a_minimum_is_rejected_by_name(void **state) {
    (void)state;
    static masu_plan_info plan;
    masu_session s;
    masu_detail detail;
    masu_session_desc d = test_desc("test_reserve", W, H);
    wrap_reset();
    d.no_renderer = true;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    free(render(&s, &s.desc));
    wrap_most most = wrap.most;
    assert_int_equal(masu_plan(&s.desc, &plan, NULL), MASU_OK);
    uint32_t widest = 0;
    for (uint32_t i = 0; i < plan.image_count; i++) {
        if (plan.images[i].used && plan.images[i].width > widest) widest = plan.images[i].width;
        if (plan.images[i].used && plan.images[i].height > widest) widest = plan.images[i].height;
    }
    assert_true(widest > W);
    static const char *const names[MASU_DEVICE_LIMIT_COUNT] = {
#define NAME(member) #member,
        MASU_DEVICE_LIMITS(NAME)
#undef NAME
    };
    const struct {
        const char *limit;
        uint32_t needed;
    } rows[] = {{"maxImageDimension2D", widest},
                {"maxPerStageDescriptorUniformBuffers", most.uniform_buffers},
                {"maxPerStageDescriptorSampledImages", most.sampled_images},
                {"maxPerStageDescriptorSamplers", most.sampled_images},
                {"maxPerStageDescriptorStorageImages", most.storage_images}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        masu_device_row row = *masu_device_row_of("xe");
        uint32_t at = 0;
        while (strcmp(names[at], rows[i].limit)) at++;
        wrap.row = &row;
        row.limits[at] = rows[i].needed;
        if (masu_plan(&s.desc, &plan, &detail)) fail_msg("%s: %s", rows[i].limit, detail.text);
        row.limits[at]--;
        assert_int_equal(masu_plan(&s.desc, &plan, &detail), MASU_ERROR_DEVICE);
        print_message("  %s\n", detail.text);
        assert_string_equal(detail.what, rows[i].limit);
        assert_int_equal(detail.needed, rows[i].needed);
        assert_int_equal(detail.given, rows[i].needed - 1);
    }
    wrap_reset();
    close_session(&s);
}

/* ---- Tables ---------------------------------------------------------------------------------- */

static char *page;
static uint32_t missing;

static void expect_line(const char *line) {
    print_message("%s\n", line);
    if (!strstr(page, line)) missing++;
}

static void the_page_has_the_tables(void **state) {
    (void)state;
    char line[LINE];
    size_t bytes;
    uint32_t n = 0;
    if (!cells[0][0][0]) skip(); /* the first test did not run */
    char *file = read_file("docs/devices.md", &bytes);
    page = malloc(bytes + 1);
    assert_non_null(page);
    memcpy(page, file, bytes);
    page[bytes] = 0;
    free(file);
    size_t at = (size_t)snprintf(line, sizeof line, "| device |");
    for (uint32_t c = 0; c < CLASSES; c++)
        at += (size_t)snprintf(line + at, sizeof line - at, " %s |", classes[c].title);
    expect_line(line);
    at = (size_t)snprintf(line, sizeof line, "| *storage buffers needed* |");
    for (uint32_t c = 0; c < CLASSES; c++)
        at += (size_t)snprintf(line + at, sizeof line - at, " %u |", needs[c].storage_buffers);
    expect_line(line);
    for (uint32_t i = 0; masu_device_row_at(i); i++) {
        at = (size_t)snprintf(line, sizeof line, "| %s |", masu_device_row_at(i)->title);
        for (uint32_t c = 0; c < CLASSES; c++)
            at += (size_t)snprintf(line + at, sizeof line - at, " %s |", cells[i][c]);
        expect_line(line);
    }
    for (uint32_t i = 0; masu_device_row_at(i); i++, n++) {
        const masu_device_row *row = masu_device_row_at(i);
        VkPhysicalDeviceProperties p = {.apiVersion = UINT32_MAX};
        memset(&p.limits, 0xFF, sizeof p.limits);
        masu_device_row_limit(row, &p);
        const VkPhysicalDeviceLimits *l = &p.limits;
        snprintf(line, sizeof line,
                 "| %s | %s | 1.%u | %u | %u | %u | %u | %u | %u | %u | %s | %s |", row->title,
                 row->source, row->minor, l->maxPerStageDescriptorStorageBuffers,
                 l->maxPerStageDescriptorStorageImages, l->maxPerStageDescriptorSampledImages,
                 l->maxComputeWorkGroupInvocations, l->maxComputeSharedMemorySize / 1024,
                 l->maxImageDimension2D, l->maxColorAttachments, row->compressed ? "yes" : "no",
                 row->fragment_stores ? "yes" : "no");
        expect_line(line);
    }
    assert_true(n >= 10);
    free(page);
    if (missing) fail_msg("docs/devices.md lacks %u of these lines", missing);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_class_runs_or_lacks_a_named_feature),
        cmocka_unit_test(a_vulkan_1_0_device_draws_the_same),
        cmocka_unit_test(a_device_below_a_minimum_is_rejected_by_name),
        cmocka_unit_test(the_page_has_the_tables),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

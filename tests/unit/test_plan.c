/* test_plan.c: from a description to a compiled frame, without a device: which passes run and why,
 * their reads and writes, and size and lifetime of each image. (Rejected descriptions:
 * test_desc.c.)
 *
 * Frames are compared as text, one item per pass: light(r:albedo r:normal r:depth u:hdr). r
 * sampled, w written, u updated, c colour and d depth attachment, from and to of a copy; rb and wb
 * a buffer that is read or written. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "scene/blob.h"
#include "plan/output.h"
#include "plan/buffer_plan.h"
#include "plan/compile.h"
#include "device/ray_query.h"
#include "plan/push.h"
#include "support/desc.h"
#include "support/random.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

static void compile(const masu_desc *d, masu_frame_plan *plan) {
    masu_detail detail, before;
    memset(&detail, 0x5A, sizeof detail);
    before = detail;
    masu_result result = masu_compile(d, 256, 64, plan, &detail);
    if (result) fail_msg("rejected: %s", detail.text);
    assert_memory_equal(&detail, &before, sizeof detail); /* unchanged by success */
}

/* ---- Frames as text -------------------------------------------------------------------------- */

static const char *usage_text(uint8_t usage) {
    static const char *const texts[] = {
        [MASU_USE_NONE] = "?",        [MASU_READ] = "r",
        [MASU_READ_LINEAR] = "rl",    [MASU_READ_MAP] = "m",
        [MASU_READ_COPY] = "from",
        [MASU_READ_BACK] = "from",    [MASU_WRITE] = "w",
        [MASU_UPDATE] = "u",          [MASU_PING_PONG] = "rw",
        [MASU_WRITE_COLOR] = "c",     [MASU_WRITE_DEPTH] = "d",
        [MASU_WRITE_COPY] = "to",     [MASU_READ_BUFFER] = "rb",
        [MASU_WRITE_BUFFER] = "wb",   [MASU_UPDATE_DEPTH] = "ud",
        [MASU_BLEND_COLOR] = "b",     [MASU_UPDATE_COLOR] = "uc",
        [MASU_READ_STRUCTURE] = "rs", [MASU_WRITE_STRUCTURE] = "ws",
    };
    return texts[usage];
}

static const char *resource_text(uint8_t resource) {
    if (resource == MASU_RESOURCE(MASU_BUFFER_TILES)) return "tiles";
    if (resource == MASU_RESOURCE(MASU_BUFFER_SLOTS)) return "slots";
    if (resource == MASU_RESOURCE(MASU_BUFFER_PROBES)) return "probes";
    if (resource == MASU_RESOURCE(MASU_BUFFER_LIGHT_TILES)) return "lights";
    if (resource == MASU_RESOURCE(MASU_BUFFER_SPECULAR_TILES)) return "glossy";
    if (resource == MASU_RESOURCE(MASU_BUFFER_TOP_LEVEL)) return "top";
    if (resource == MASU_RESOURCE(MASU_BUFFER_SMAA_TILES)) return "edges";
    if (resource == MASU_RESOURCE(MASU_BUFFER_EXPOSURE)) return "exposure";
    assert_in_range(resource, 1, MASU_IMAGE_COUNT - 1);
    return masu_images[resource].name;
}

static const char *frame_text(const masu_frame_plan *plan, uint32_t rung) {
    static char text[8192];
    size_t at = 0;
    const masu_rung_plan *rp = &plan->rungs[rung];
    text[0] = '\0';
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (!masu_has_pass(&rp->active, p)) {
            assert_int_equal(rp->access_count[p], 0);
            continue;
        }
        at += (size_t)snprintf(text + at, sizeof text - at, "%s%s(", at ? " " : "",
                               masu_passes[p].name);
        for (uint32_t a = 0; a < rp->access_count[p]; a++) {
            const masu_access *access = &rp->access[p][a];
            at += (size_t)snprintf(text + at, sizeof text - at, "%s%s:%s", a ? " " : "",
                                   usage_text(access->usage), resource_text(access->image));
        }
        at += (size_t)snprintf(text + at, sizeof text - at, ")");
        assert_true(at < sizeof text);
    }
    return text;
}

static void assert_frame(const masu_desc *d, uint32_t rung, const char *expected) {
    static masu_frame_plan plan;
    compile(d, &plan);
    assert_string_equal(frame_text(&plan, rung), expected);
}

static const char *why_of(const masu_desc *d, masu_pass_id pass) {
    static masu_frame_plan plan;
    compile(d, &plan);
    return plan.why[pass];
}

/* ---- The table itself ------------------------------------------------------------------------ */

_Static_assert(MASU_PASS_COUNT <= MASU_MAX_PASSES, "the export has room for every pass");
_Static_assert(MASU_IMAGE_COUNT <= MASU_MAX_RESOURCES, "the export has room for every image");

/* The export has room for the accesses of each row; set 1 has the reads first, then the writes. */
static void every_row_of_the_table_fits_what_is_derived_from_it(void **state) {
    (void)state;
    const masu_plan_pass *room = NULL; /* only for its sizes */
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        const masu_pass_row *row = &masu_passes[p];
        uint32_t reads = 0, writes = 0;
        assert_true(row->name && *row->name && row->purpose && row->decide);
        for (uint32_t q = 0; q < p; q++) assert_string_not_equal(row->name, masu_passes[q].name);
        for (uint32_t a = 0; a < MASU_PASS_ACCESSES && row->access[a].image; a++) {
            if (masu_usage_writes((masu_usage)row->access[a].usage)) {
                writes++;
            } else {
                assert_int_equal(writes, 0);
                reads++;
            }
        }
        assert_true(reads <= sizeof room->reads / sizeof *room->reads);
        assert_true(writes <= sizeof room->writes / sizeof *room->writes);
        assert_true(reads + writes > 0);
    }
    for (uint32_t i = 1; i < MASU_IMAGE_COUNT; i++) {
        assert_non_null(masu_images[i].name);
        for (uint32_t j = 1; j < i; j++) {
            assert_string_not_equal(masu_images[i].name, masu_images[j].name);
        }
    }
}

#define GBUFFER "gbuffer(c:albedo c:normal d:depth) "
#define CLASSIFY_ON_RASTER "classify(r:depth rb:slots w:scene_depth wb:tiles) "
#define CLASSIFY_ALONE "classify(rb:slots w:scene_depth wb:tiles) "
#define CONE8 "cone8(rb:tiles w:cone8) "
#define CONE4 "cone4(r:cone8 wb:tiles w:cone4) "
#define MARCH "march(r:cone4 rb:tiles u:albedo u:normal u:scene_depth u:hdr) "
#define MARCH_ON_RASTER CLASSIFY_ON_RASTER CONE8 CONE4 MARCH
#define MARCH_ALONE CLASSIFY_ALONE CONE8 CONE4 MARCH
#define LIGHT_RASTER "light(r:albedo r:normal r:depth u:hdr) "
#define LIGHT_SDF "light(r:albedo r:normal r:scene_depth u:hdr) "
#define TONEMAP "tonemap(r:hdr w:target)"

/* ---- Sizes of rungs -------------------------------------------------------------------------- */

static void assert_rung_sizes(uint32_t width, uint32_t height, const uint32_t sizes[3][2]) {
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, width, height);
    compile(&d, &plan);
    assert_int_equal(plan.desc.rung_count, 3);
    for (uint32_t r = 0; r < 3; r++) {
        assert_int_equal(plan.rungs[r].render_width, sizes[r][0]);
        assert_int_equal(plan.rungs[r].render_height, sizes[r][1]);
    }
}

static void the_default_rungs_of_full_hd_are_these(void **state) {
    (void)state;
    const uint32_t sizes[3][2] = {{1920, 1080}, {1536, 864}, {768, 432}};
    assert_rung_sizes(1920, 1080, sizes);
}

static void odd_sizes_round_to_nearest_and_never_to_nothing(void **state) {
    (void)state;
    const uint32_t one[3][2] = {{1, 1}, {1, 1}, {1, 1}};
    const uint32_t small[3][2] = {{7, 5}, {6, 4}, {3, 2}};
    const uint32_t tall[3][2] = {{3, 16384}, {2, 13107}, {1, 6554}};
    assert_rung_sizes(1, 1, one);
    assert_rung_sizes(7, 5, small);
    assert_rung_sizes(3, 16384, tall);
}

static void any_scale_of_any_size_gives_a_size_within_half_a_pixel(void **state) {
    (void)state;
    static masu_frame_plan plan;
    uint64_t random = 1;
    for (int i = 0; i < 2000; i++) {
        masu_desc d = scene_desc(RASTER, (uint32_t)support_random_in(&random, 1, 16384),
                                 (uint32_t)support_random_in(&random, 1, 16384));
        float scale = (float)support_random_in(&random, 1, 1 << 20) / (float)(1 << 20);
        d.rung_count = 1;
        d.rungs[0].scale = scale;
        compile(&d, &plan);
        const uint32_t got[] = {plan.rungs[0].render_width, plan.rungs[0].render_height};
        const uint32_t of[] = {d.output.width, d.output.height};
        for (int k = 0; k < 2; k++) {
            double exact = (double)of[k] * (double)scale;
            assert_in_range(got[k], 1, of[k]);
            assert_true(fabs((double)got[k] - exact) <= 0.5 || (got[k] == 1 && exact < 0.5));
        }
    }
}

/* Upscaling an image to its own size would cost a pass for nothing. */
static void a_rung_that_rounds_to_the_output_size_is_not_upscaled(void **state) {
    (void)state;
    masu_desc d = scene_desc(SDF, 1, 1);
    assert_frame(&d, 2, MARCH_ALONE LIGHT_SDF "tonemap(r:hdr w:target)");
}

static void a_rung_that_differs_in_one_direction_alone_is_upscaled(void **state) {
    (void)state;
    masu_desc d = scene_desc(SDF, 1000, 1);
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.scale = 0.9f, .sharpen = MASU_OFF};
    assert_frame(&d, 0, MARCH_ALONE LIGHT_SDF "tonemap(r:hdr w:ldr) easu(r:ldr w:target)");
    d = source_desc(1920, 1000);
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
    d = source_desc(1900, 1080);
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
}

static void a_source_image_ignores_the_scales_of_the_rungs(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = source_desc(1000, 333);
    d.rung_count = 0;
    compile(&d, &plan);
    for (uint32_t r = 0; r < 3; r++) {
        assert_int_equal(plan.rungs[r].render_width, 1000);
        assert_int_equal(plan.rungs[r].render_height, 333);
    }
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static void polygons_and_sdf_make_the_whole_frame(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER | SDF, 1920, 1080);
    assert_frame(&d, 0, GBUFFER MARCH_ON_RASTER LIGHT_SDF "tonemap(r:hdr w:target)");
    for (uint32_t r = 1; r < 3; r++) {
        assert_frame(&d, r,
                     GBUFFER MARCH_ON_RASTER LIGHT_SDF
                     "tonemap(r:hdr w:ldr) easu(r:ldr w:upscaled) rcas(r:upscaled w:target)");
    }
}

static void without_an_sdf_nothing_is_marched(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 1920, 1080);
    assert_frame(&d, 0, GBUFFER LIGHT_RASTER "tonemap(r:hdr w:target)");
    assert_string_equal(why_of(&d, MASU_PASS_MARCH), "the scene has no SDF");
    assert_string_equal(why_of(&d, MASU_PASS_GBUFFER), "the scene has instances");
}

static void without_instances_nothing_is_rasterised(void **state) {
    (void)state;
    masu_desc d = scene_desc(SDF, 1920, 1080);
    assert_frame(&d, 0, MARCH_ALONE LIGHT_SDF "tonemap(r:hdr w:target)");
    assert_string_equal(why_of(&d, MASU_PASS_GBUFFER),
                        "no instances; the march writes every pixel");
    assert_string_equal(why_of(&d, MASU_PASS_MARCH), "the scene has an SDF");
}

/* Before any pass that reads the slots, by any kind of access. */
static void slots_are_updated_only_if_something_changes_them(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER | SDF, 64, 64);
    assert_string_equal(why_of(&d, MASU_PASS_UPDATE), "the SDF's slots are constant");
    support_scene.sdf_dynamic = 1;
    assert_frame(&d, 0, "update(wb:slots) " GBUFFER MARCH_ON_RASTER LIGHT_SDF TONEMAP);
    assert_string_equal(why_of(&d, MASU_PASS_UPDATE), "the SDF depends on parameters or time");
    d = scene_desc(SDF, 64, 64);
    support_scene.sdf_dynamic = 1;
    assert_frame(&d, 0, "update(wb:slots) " MARCH_ALONE LIGHT_SDF TONEMAP);
    d = scene_desc(RASTER, 64, 64);
    assert_string_equal(why_of(&d, MASU_PASS_UPDATE), "the scene has no SDF");
}

/* Light probes are a pass, a buffer and a permutation of light; scenes without them have none. */
static void light_probes_cost_only_scenes_that_have_them(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 64, 64);
    d.rung_count = 1;
    assert_frame(&d, 0, GBUFFER "light(r:albedo r:normal r:depth u:hdr) " TONEMAP);
    assert_string_equal(why_of(&d, MASU_PASS_PROBES), "the scene has no light probes");
    compile(&d, &plan);
    uint64_t sets = plan.pass_sets;
    assert_false(plan.needs.probes);
    assert_int_equal(plan.buffers[MASU_BUFFER_PROBES].bytes, 0);
    support_scene.probes = 6;
    support_scene.probe_sets = 2;
    support_scene.probe_words = 6 * 2 * MASU_PROBE_WORDS;
    assert_frame(&d, 0,
                 GBUFFER
                 "probes(wb:probes) light(rb:probes r:albedo r:normal r:depth u:hdr) " TONEMAP);
    assert_string_equal(why_of(&d, MASU_PASS_PROBES), "the scene has light probes");
    compile(&d, &plan);
    assert_true(plan.needs.probes);
    assert_int_equal(plan.pass_sets, sets + 1);
    assert_int_equal(plan.buffers[MASU_BUFFER_PROBES].bytes,
                     sizeof(masu_blob_probes) +
                         6 * (2 * MASU_PROBE_WORDS + MASU_PROBE_LIT_WORDS) * 4);
}

static void march_steps_reach_the_shaders(void **state) {
    (void)state;
    masu_frame_plan plan;
    masu_desc d = scene_desc(SDF, 640, 480);
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.march_steps = 77};
    compile(&d, &plan);
    assert_int_equal(masu_push_of(&plan, 0, MASU_PASS_CONE8, 0).own.word[0], 77);
    assert_int_equal(masu_push_of(&plan, 0, MASU_PASS_CONE4, 0).own.word[0], 77);
    assert_int_equal(masu_push_of(&plan, 0, MASU_PASS_MARCH, 0).own.word[0], 77);
}

static void an_empty_scene_is_cleared_and_lit(void **state) {
    (void)state;
    masu_desc d = scene_desc(0, 1920, 1080);
    assert_frame(&d, 0, GBUFFER LIGHT_RASTER "tonemap(r:hdr w:target)");
    assert_string_equal(why_of(&d, MASU_PASS_GBUFFER),
                        "clears only: the scene has no geometry");
}

static void a_source_image_alone_is_upscaled_and_sharpened(void **state) {
    (void)state;
    masu_desc d = source_desc(1280, 720);
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
    const masu_pass_id out[] = {MASU_PASS_GBUFFER, MASU_PASS_LIGHT, MASU_PASS_TONEMAP};
    for (size_t i = 0; i < COUNT(out); i++) {
        assert_string_equal(why_of(&d, out[i]), "no scene: a source image is upscaled");
    }
    d.rungs[0].sharpen = MASU_OFF;
    assert_frame(&d, 0, "easu(r:source w:target)");
}

static void a_source_image_of_the_output_size_is_written_all_the_same(void **state) {
    (void)state;
    masu_desc d = source_desc(1920, 1080);
    const masu_switch upscale[] = {MASU_AUTO, MASU_OFF};
    for (size_t i = 0; i < COUNT(upscale); i++) {
        d.rungs[0].upscale = upscale[i];
        d.rungs[0].sharpen = MASU_OFF;
        assert_frame(&d, 0, "easu(r:source w:target)");
        d.rungs[0].sharpen = MASU_ON;
        assert_frame(&d, 0, "rcas(r:source w:target)");
    }
}

static void switches_force_upscaling_and_sharpening_on_and_off(void **state) {
    (void)state;
    masu_desc d = scene_desc(SDF, 1920, 1080);
    d.rung_count = 6;
    d.rungs[0] = (masu_rung){.upscale = MASU_ON};
    d.rungs[1] = (masu_rung){.upscale = MASU_ON, .sharpen = MASU_OFF};
    d.rungs[2] = (masu_rung){.sharpen = MASU_ON};
    d.rungs[3] = (masu_rung){.upscale = MASU_OFF, .sharpen = MASU_OFF};
    d.rungs[4] = (masu_rung){.scale = 0.5f, .sharpen = MASU_OFF};
    d.rungs[5] = (masu_rung){.scale = 0.5f};
    static const char *const ends[] = {
        "tonemap(r:hdr w:ldr) easu(r:ldr w:upscaled) rcas(r:upscaled w:target)",
        "tonemap(r:hdr w:ldr) easu(r:ldr w:target)",
        "tonemap(r:hdr w:ldr) rcas(r:ldr w:target)",
        "tonemap(r:hdr w:target)",
        "tonemap(r:hdr w:ldr) easu_twice(r:ldr w:target)",
        "tonemap(r:hdr w:ldr) easu_twice(r:ldr w:upscaled) rcas(r:upscaled w:target)",
    };
    for (uint32_t r = 0; r < 6; r++) {
        char expected[512];
        (void)snprintf(expected, sizeof expected, MARCH_ALONE LIGHT_SDF "%s", ends[r]);
        assert_frame(&d, r, expected);
    }
}

/* Bilinear is the plain baseline: it is not sharpened by default. */
static void a_rung_says_how_it_is_upscaled(void **state) {
    (void)state;
    masu_desc d = scene_desc(SDF, 1920, 1080);
    d.rung_count = 5;
    d.rungs[0] = (masu_rung){.scale = 0.5f, .easu = MASU_EASU_FULL};
    d.rungs[1] = (masu_rung){.scale = 0.5f, .easu = MASU_EASU_FAST};
    d.rungs[2] = (masu_rung){.scale = 0.5f, .easu = MASU_EASU_BILINEAR};
    d.rungs[3] = (masu_rung){.scale = 0.5f, .easu = MASU_EASU_BILINEAR, .sharpen = MASU_ON};
    d.rungs[4] = (masu_rung){.easu = MASU_EASU_FAST}; /* nothing to upscale */
    static const char *const ends[] = {
        "tonemap(r:hdr w:ldr) easu_twice(r:ldr w:upscaled) rcas(r:upscaled w:target)",
        "tonemap(r:hdr w:ldr) easu_fast(r:ldr w:upscaled) rcas(r:upscaled w:target)",
        "tonemap(r:hdr w:ldr) bilinear(r:ldr w:target)",
        "tonemap(r:hdr w:ldr) bilinear(r:ldr w:upscaled) rcas(r:upscaled w:target)",
        "tonemap(r:hdr w:target)",
    };
    for (uint32_t r = 0; r < 5; r++) {
        char expected[512];
        (void)snprintf(expected, sizeof expected, MARCH_ALONE LIGHT_SDF "%s", ends[r]);
        assert_frame(&d, r, expected);
    }
    d.rung_count = 1;
    assert_string_equal(why_of(&d, MASU_PASS_EASU_FAST), "rung.easu selects another filter");
    d.rungs[0].scale = 1.0f;
    assert_string_equal(why_of(&d, MASU_PASS_BILINEAR), "render size is output size");
}

/* Four pixels share texels if the output is exactly twice as wide and high, and neither bit-exact
 * results nor half floats are requested. In a scene the rung's scale decides, at any output
 * size. */
static void twice_the_size_has_a_pass_of_its_own(void **state) {
    (void)state;
    masu_desc d = source_desc(960, 540);
    assert_frame(&d, 0, "easu_twice(r:source w:upscaled) rcas(r:upscaled w:target)");
    assert_string_equal(why_of(&d, MASU_PASS_EASU), "easu_twice runs instead");
    d.debug.exact = 1;
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
    assert_string_equal(
        why_of(&d, MASU_PASS_EASU_TWICE),
        "the output does not have twice the render size, or the device lacks registers");
    d.debug.exact = 0;
    d.deny.easu_twice = 1;
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
    d.deny.easu_twice = 0;
    d.half_floats = MASU_ON;
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
    d = source_desc(960, 541);
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
    d = scene_desc(SDF, 1281, 719);
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.scale = 0.5f};
    assert_frame(&d, 0,
                 MARCH_ALONE LIGHT_SDF
                 "tonemap(r:hdr w:ldr) easu_twice(r:ldr w:upscaled) rcas(r:upscaled w:target)");
}

static void a_target_that_is_no_storage_image_is_blitted_to(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 1920, 1080);
    d.targets.storage = 0;
    d.targets.views = NULL; /* not needed then */
    d.targets.format = VK_FORMAT_B8G8R8A8_UNORM;
    assert_frame(&d, 0,
                 GBUFFER LIGHT_RASTER "tonemap(r:hdr w:final) present(from:final to:target)");
    assert_frame(&d, 1,
                 GBUFFER LIGHT_RASTER "tonemap(r:hdr w:ldr) easu(r:ldr w:upscaled) "
                                      "rcas(r:upscaled w:final) present(from:final to:target)");
    assert_string_equal(why_of(&d, MASU_PASS_PRESENT), "the targets are not storage images");
    d.rungs[0] = (masu_rung){.scale = 0.5f, .sharpen = MASU_OFF};
    d.rung_count = 1;
    assert_frame(&d, 0,
                 GBUFFER LIGHT_RASTER "tonemap(r:hdr w:ldr) easu_twice(r:ldr w:final) "
                                      "present(from:final to:target)");
    d.targets.storage = 1;
    d.targets.views = support_views;
    d.targets.format = VK_FORMAT_UNDEFINED;
    assert_string_equal(why_of(&d, MASU_PASS_PRESENT), "the last pass writes the target itself");
}

/* Auto-exposure: two passes before tonemap, which reads their result. */
static void a_metered_exposure_is_two_passes(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 1920, 1080);
    assert_string_equal(why_of(&d, MASU_PASS_METER), "the exposure is fixed");
    d.exposure.metered = MASU_ON;
    assert_frame(&d, 0,
                 GBUFFER LIGHT_RASTER "meter(r:hdr wb:exposure) expose(wb:exposure) "
                                      "tonemap(rb:exposure r:hdr w:target)");
    assert_string_equal(why_of(&d, MASU_PASS_EXPOSE), "the exposure is metered");
    d = source_desc(640, 360); /* without exposure */
    d.exposure.metered = MASU_ON;
    assert_string_equal(why_of(&d, MASU_PASS_METER), "no scene: a source image is upscaled");
}

/* Only the last pass of a rung rounds and dithers. */
static void the_last_pass_of_a_rung_makes_the_output(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static const uint32_t last[] = {MASU_PASS_TONEMAP, MASU_PASS_RCAS, MASU_PASS_EASU_TWICE};
    for (uint32_t storage = 0; storage < 2; storage++) {
        masu_desc d = scene_desc(RASTER, 1920, 1080);
        d.targets.storage = storage;
        d.dither = MASU_ON;
        d.rung_count = 3;
        d.rungs[0] = (masu_rung){.scale = 1};
        d.rungs[1] = (masu_rung){.scale = 0.5f};
        d.rungs[2] = (masu_rung){.scale = 0.5f, .sharpen = MASU_OFF};
        compile(&d, &plan);
        for (uint32_t r = 0; r < 3; r++) {
            for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
                struct masu_push push;
                memset(&push, 0, sizeof push);
                masu_output_push(&plan, &plan.rungs[r], p, &push);
                if (!masu_has_pass(&plan.rungs[r].active, p)) continue;
                assert_int_equal(masu_comes_last(&plan.rungs[r], p), p == last[r]);
                assert_int_equal(push.output_flags,
                                 p == last[r] ? MASU_OUTPUT_LAST | MASU_OUTPUT_DITHER : 0);
                assert_int_equal(push.output_steps,
                                 p == last[r] ? 255u | 255u << 10 | 255u << 20 : 0);
            }
        }
    }
}

static void the_reason_of_a_pass_is_that_of_the_first_rung_that_runs_it(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 1920, 1080);
    assert_string_equal(why_of(&d, MASU_PASS_EASU),
                        "render size differs from output size, or rung.upscale is on");
    assert_string_equal(why_of(&d, MASU_PASS_RCAS),
                        "sharpens the upscaled image, or rung.sharpen is on");
    d.rung_count = 1; /* full size only */
    assert_string_equal(why_of(&d, MASU_PASS_EASU), "render size is output size");
    assert_string_equal(why_of(&d, MASU_PASS_RCAS), "nothing was upscaled, or rung.sharpen is off");
    d.rung_count = 3;
    d.rungs[1].scale = 0.5f; /* only in this one */
    assert_string_equal(why_of(&d, MASU_PASS_EASU_TWICE), "the output has twice the render size");
    assert_string_equal(why_of(&d, MASU_PASS_READBACK), "desc.readback requests no image");
    assert_string_equal(why_of(&d, MASU_PASS_LIGHT), "a scene is lit");
}

static void readback_copies_what_is_asked_for(void **state) {
    (void)state;
    static const struct {
        uint32_t parts, bits;
        const char *pass;
    } cases[] = {
        {RASTER | SDF, MASU_READBACK_ALL & ~(uint32_t)MASU_READBACK_VELOCITY,
         "readback(from:albedo from:normal from:scene_depth from:hdr) "},
        {RASTER, MASU_READBACK_DEPTH, "readback(from:depth) "},
        {SDF, MASU_READBACK_DEPTH | MASU_READBACK_HDR, "readback(from:scene_depth from:hdr) "},
        {RASTER, MASU_READBACK_NORMAL, "readback(from:normal) "},
        {RASTER, MASU_READBACK_ALBEDO, "readback(from:albedo) "},
    };
    for (size_t i = 0; i < COUNT(cases); i++) {
        masu_desc d = scene_desc(cases[i].parts, 64, 64);
        d.readback = cases[i].bits;
        char expected[512];
        (void)snprintf(expected, sizeof expected, "%s%s%s%stonemap(r:hdr w:target)",
                       cases[i].parts & RASTER ? GBUFFER : "",
                       !(cases[i].parts & SDF)   ? ""
                       : cases[i].parts & RASTER ? MARCH_ON_RASTER
                                                 : MARCH_ALONE,
                       cases[i].parts & SDF ? LIGHT_SDF : LIGHT_RASTER, cases[i].pass);
        assert_frame(&d, 0, expected);
        assert_string_equal(why_of(&d, MASU_PASS_READBACK), "desc.readback requests images");
    }
    masu_desc d = source_desc(64, 64); /* uses none of these images */
    d.readback = MASU_READBACK_ALL;
    assert_frame(&d, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
}

static void silhouettes_are_a_pass_where_a_rung_asks_for_them(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(SDF, 64, 64);
    assert_string_equal(why_of(&d, MASU_PASS_SILHOUETTES), "rung.silhouettes is not on");
    d.rung_count = 2;
    d.rungs[0] = (masu_rung){.silhouettes = MASU_ON};
    d.rungs[1] = (masu_rung){.silhouettes = MASU_OFF};
    assert_frame(
        &d, 0,
        MARCH_ALONE LIGHT_SDF
        "silhouettes(r:scene_depth r:albedo r:normal r:hdr rb:tiles rb:slots w:silhouettes) "
        "tonemap(r:hdr r:silhouettes w:target)");
    compile(&d, &plan);
    assert_int_equal(plan.images[MASU_IMAGE_SILHOUETTES].persistent, 0);
    assert_null(strstr(frame_text(&plan, 1), " silhouettes("));
    d = scene_desc(RASTER | SDF, 64, 64);
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.silhouettes = MASU_ON};
    compile(&d, &plan);
    assert_non_null(strstr(frame_text(&plan, 0),
                           "silhouettes(r:depth r:scene_depth r:albedo r:normal r:hdr rb:tiles "));
    d = scene_desc(RASTER, 64, 64); /* there are no edges to anti-alias */
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.silhouettes = MASU_ON};
    assert_string_equal(why_of(&d, MASU_PASS_SILHOUETTES), "the scene has no SDF");
    assert_frame(&d, 0, GBUFFER LIGHT_RASTER TONEMAP);
}

static void temporal_stands_in_for_anti_aliasing_and_upscaling(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 64, 64);
    assert_string_equal(why_of(&d, MASU_PASS_TEMPORAL), "rung.temporal is not on");
    d.rung_count = 2;
    d.rungs[0] = (masu_rung){.temporal = MASU_ON, .scale = 0.5f, .aa = MASU_AA_SMAA_HIGH};
    d.rungs[1] = (masu_rung){.temporal = MASU_ON, .sharpen = MASU_ON};
    assert_string_equal(why_of(&d, MASU_PASS_EASU), "temporal runs instead");
    compile(&d, &plan);
#define FOUND_BY(pass)                                                                               \
    "tonemap(r:hdr w:ldr) temporal_find(r:ldr r:depth rl:velocity r:history_depth rl:history w:found) " pass                \
    "(r:ldr r:found rl:velocity rw:history w:"
    assert_non_null(strstr(frame_text(&plan, 0), FOUND_BY("temporal_twice")));
    assert_non_null(strstr(frame_text(&plan, 0),
                           "w:target) temporal_keep(r:depth r:found r:velocity w:history_depth)"));
    assert_non_null(strstr(frame_text(&plan, 1), FOUND_BY("temporal")));
    assert_non_null(strstr(frame_text(&plan, 1), " rcas(r:upscaled w:target)"));
    assert_null(strstr(frame_text(&plan, 0), "smaa"));
    assert_null(strstr(frame_text(&plan, 0), "fsr1"));
    /* The 2x variant covers all pixels of an output with a fixed size. */
    d.rung_count = 1;
    assert_string_equal(why_of(&d, MASU_PASS_TEMPORAL), "temporal_twice runs instead");
    static const char other[] = "temporal runs instead: for any size, and with debug.exact";
    d.output.width = 65;
    assert_string_equal(why_of(&d, MASU_PASS_TEMPORAL_TWICE), other);
    d.output.width = 64, d.resizable = 1;
    assert_string_equal(why_of(&d, MASU_PASS_TEMPORAL_TWICE), other);
    d.resizable = 0, d.debug.exact = 1;
    assert_string_equal(why_of(&d, MASU_PASS_TEMPORAL_TWICE), other);
    compile(&d, &plan);
    assert_non_null(strstr(frame_text(&plan, 0), FOUND_BY("temporal")));
#undef FOUND_BY
    d.debug.exact = 0;
    d.rung_count = 2;
    compile(&d, &plan);
    /* At full size 2 * 8 + 4 bytes per pixel outlive the frame, 8 do not. */
    static const masu_image_id own[] = {MASU_IMAGE_HISTORY, MASU_IMAGE_HISTORY_DEPTH,
                                        MASU_IMAGE_FOUND};
    uint64_t bytes = 0;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
        const masu_image_plan *image = &plan.images[own[i]];
        assert_int_equal(image->persistent, i < 2);
        bytes += (uint64_t)masu_images[own[i]].layers * image->width * image->height *
                 masu_format_bytes(masu_plan_format(&plan, own[i]));
    }
    assert_int_equal(bytes, 28 * 64 * 64);
    /* Mips: stationary surfaces two levels finer than the output resolution, moving ones as at full
     * size. */
    const float half = -3.0f, full = -2.0f;
    const uint32_t bias = offsetof(struct masu_push_gbuffer, mip_bias) / 4,
                   moving = offsetof(struct masu_push_gbuffer, mip_moving) / 4;
    const masu_push_block first = masu_push_of(&plan, 0, MASU_PASS_GBUFFER, 0);
    const masu_push_block second = masu_push_of(&plan, 1, MASU_PASS_GBUFFER, 0);
    assert_true(first.own.real[bias] == half && first.own.real[moving] == full - half);
    assert_true(second.own.real[bias] == full && second.own.real[moving] == 0.0f);
    d.rungs[0].temporal = MASU_OFF;
    compile(&d, &plan);
    const masu_push_block without = masu_push_of(&plan, 0, MASU_PASS_GBUFFER, 0);
    assert_true(without.own.real[bias] == -1.0f && without.own.real[moving] == 0.0f);
    masu_desc source = source_desc(64, 64); /* has neither depth nor velocities */
    source.rungs[0] = (masu_rung){.temporal = MASU_ON};
    assert_frame(&source, 0, "easu(r:source w:upscaled) rcas(r:upscaled w:target)");
}

static void velocities_keep_the_frame_before_and_nothing_else_does(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static const char *const gbuffer = "gbuffer(c:albedo c:normal c:velocity d:depth) ";
    char expected[512];
    masu_desc d = scene_desc(RASTER, 64, 64);
    d.readback = MASU_READBACK_VELOCITY;
    (void)snprintf(
        expected, sizeof expected,
        "%svelocity(r:depth u:velocity) " LIGHT_RASTER "readback(from:velocity) " TONEMAP, gbuffer);
    assert_frame(&d, 0, expected);
    d = scene_desc(RASTER | SDF, 64, 64);
    d.readback = MASU_READBACK_VELOCITY;
    (void)snprintf(expected, sizeof expected,
                   "%s" MARCH_ON_RASTER
                   "sdf_velocity(r:depth r:scene_depth rb:tiles rb:slots u:velocity) " LIGHT_SDF
                   "readback(from:velocity) " TONEMAP,
                   gbuffer);
    assert_frame(&d, 0, expected);
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SLOTS].count, 7);
    assert_int_equal(plan.buffers[MASU_BUFFER_FRAME].count, 4);
    assert_int_equal(plan.buffers[MASU_BUFFER_INSTANCES].count, 6);
    support_scene.sdf_static = 1;
    (void)snprintf(expected, sizeof expected,
                   "%s" MARCH_ON_RASTER
                   "static_velocity(r:depth r:scene_depth u:velocity) " LIGHT_SDF
                   "readback(from:velocity) " TONEMAP,
                   gbuffer);
    assert_frame(&d, 0, expected);
    d = scene_desc(SDF, 64, 64);
    support_scene.sdf_static = 1;
    d.readback = MASU_READBACK_VELOCITY;
    assert_frame(&d, 0,
                 MARCH_ALONE LIGHT_SDF "static_velocity_alone(r:scene_depth w:velocity) "
                 "readback(from:velocity) " TONEMAP);
    d = scene_desc(SDF, 64, 64);
    support_scene.sdf_dynamic = 1;
    d.readback = MASU_READBACK_VELOCITY;
    assert_frame(&d, 0,
                 "update(wb:slots) update_previous(wb:slots) " MARCH_ALONE
                 LIGHT_SDF "sdf_velocity_alone(r:scene_depth rb:tiles rb:slots w:velocity) "
                 "readback(from:velocity) " TONEMAP);
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SLOTS].count, 14);
    uint64_t with = plan.buffers[MASU_BUFFER_FRAME].bytes;
    d.readback = MASU_READBACK_ALL & ~(uint32_t)MASU_READBACK_VELOCITY;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SLOTS].count, 7);
    assert_int_equal(plan.buffers[MASU_BUFFER_FRAME].bytes * 2, with);
    assert_int_equal(plan.images[MASU_IMAGE_VELOCITY].used, 0);
    assert_string_equal(plan.why[MASU_PASS_SDF_VELOCITY], "nothing reads velocities");
    assert_string_equal(plan.why[MASU_PASS_SDF_VELOCITY_ALONE], "nothing reads velocities");
    assert_string_equal(plan.why[MASU_PASS_VELOCITY], "nothing reads velocities");
    assert_string_equal(plan.why[MASU_PASS_UPDATE_PREVIOUS], "nothing reads velocities");
}

/* Picking: two small passes, 2x2 pixels and six 32-bit values if desc.picking is set; otherwise
 * nothing. */
static void picking_costs_nothing_unless_it_is_asked_for(void **state) {
    (void)state;
    static masu_frame_plan with, without;
    static const uint32_t parts[] = {RASTER, SDF, RASTER | SDF};
    for (size_t i = 0; i < COUNT(parts); i++) {
        masu_desc d = scene_desc(parts[i], 64, 64);
        compile(&d, &without);
        d.picking = 1;
        compile(&d, &with);
        assert_string_equal(without.why[MASU_PASS_PICK], "desc.picking does not request it");
        assert_string_equal(without.why[MASU_PASS_PICK_TELL], "desc.picking does not request it");
        assert_int_equal(without.buffers[MASU_BUFFER_PICKED].bytes, 0);
        assert_int_equal(without.images[MASU_IMAGE_PICK_ID].used +
                             without.images[MASU_IMAGE_PICK_DEPTH].used,
                         0);
        int raster = (parts[i] & RASTER) != 0;
        for (uint32_t r = 0; r < with.desc.rung_count; r++) {
            assert_int_equal(masu_has_pass(&without.rungs[r].active, MASU_PASS_PICK_TELL), 0);
            assert_int_equal(masu_has_pass(&with.rungs[r].active, MASU_PASS_PICK_TELL), 1);
            assert_int_equal(masu_has_pass(&with.rungs[r].active, MASU_PASS_PICK), raster);
        }
        assert_int_equal(with.buffers[MASU_BUFFER_PICKED].role, MASU_ROLE_READBACK);
        assert_int_equal(with.images[MASU_IMAGE_PICK_ID].width, raster ? 2 : 0);
        if (!raster) continue;
        assert_int_equal(with.buffers[MASU_BUFFER_DRAWS].count,
                         without.buffers[MASU_BUFFER_DRAWS].count + with.draws);
        assert_int_equal(with.pick_draws, without.buffers[MASU_BUFFER_DRAWS].count);
        assert_int_equal(with.drawn.words, without.drawn.words + with.listed);
    }
}

/* Transparent surfaces: a pass over the lit image, and memory by their number; nothing in scenes
 * without them. */
static void what_is_blended_comes_over_the_light_if_there_is_any(void **state) {
    (void)state;
    static masu_frame_plan with, without;
    masu_desc d = scene_desc(RASTER, 64, 64);
    compile(&d, &without);
    assert_int_equal(without.images[MASU_IMAGE_HDR].usage & VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT, 0);
    assert_string_equal(without.why[MASU_PASS_TRANSPARENTS],
                        "the scene has no transparent materials");
    d = scene_desc(RASTER, 64, 64);
    support_scene.blends = 2; /* materials that no instance has */
    compile(&d, &with);
    assert_string_equal(with.why[MASU_PASS_TRANSPARENTS], "the scene has no transparent materials");
    assert_int_equal(with.pass_sets, without.pass_sets);
    support_scene.transparents = 5, support_scene.transparent_sets = 2;
    assert_frame(
        &d, 0, GBUFFER LIGHT_RASTER "transparents(r:depth r:depth b:hdr) tonemap(r:hdr w:target)");
    compile(&d, &with);
    assert_string_equal(with.why[MASU_PASS_TRANSPARENTS], "the scene has transparent materials");
    assert_true(with.images[MASU_IMAGE_HDR].usage & VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
    assert_int_equal(with.pass_sets, without.pass_sets + 3); /* one per rung */
    const masu_buffer_plan *b = with.buffers, *other = without.buffers;
    assert_int_equal(b[MASU_BUFFER_DRAWS].count, other[MASU_BUFFER_DRAWS].count + 10);
    assert_int_equal(with.transparent_draws, other[MASU_BUFFER_DRAWS].count);
    assert_int_equal(b[MASU_BUFFER_DRAWN].count, other[MASU_BUFFER_DRAWN].count + 30);
    assert_int_equal(with.drawn.transparents, without.drawn.words);
    for (uint32_t i = 1; i < MASU_IMAGE_COUNT; i++) {
        assert_int_equal(with.images[i].used, without.images[i].used);
        assert_int_equal(with.images[i].bytes, without.images[i].bytes);
    }
    d = scene_desc(RASTER | SDF, 64, 64);
    support_scene.transparents = 1, support_scene.transparent_sets = 1;
    support_scene.shadow_cascades = 1, support_scene.shadow_resolution = 64;
    support_scene.shadow_distance = 50;
    compile(&d, &with); /* the smaller of both depths, and the sun's map */
    assert_non_null(
        strstr(frame_text(&with, 0),
               " transparents(r:scene_depth r:shadow_map r:scene_depth b:hdr) tonemap(r:hdr "));
}

/* Per-frame content: a pass for each kind with a reserve, one buffer for all, an image for lines.
 * Without a reserve nothing. */
static void what_is_reserved_has_passes_and_nothing_else_has(void **state) {
    (void)state;
    static masu_frame_plan plan, bare;
    masu_desc d = scene_desc(RASTER | SDF, 64, 64);
    d.rung_count = 1;
    compile(&d, &bare);
    assert_int_equal(bare.buffers[MASU_BUFFER_SPRITES].bytes, 0);
    assert_false(bare.images[MASU_IMAGE_OVERLAY].used);
    assert_string_equal(bare.why[MASU_PASS_DECALS], "desc.reserve has no decals");
    d.reserve.particles = 7;
    assert_frame(&d, 0,
                 GBUFFER MARCH_ON_RASTER LIGHT_SDF "particles(r:scene_depth b:hdr) " TONEMAP);
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SPRITES].stride,
                     64 * ((16 * (3 + 1 + 4 * 7) + 63) / 64));
    for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
        if (b != MASU_BUFFER_SPRITES)
            assert_int_equal(plan.buffers[b].bytes, bare.buffers[b].bytes);
    }
    d.reserve = (masu_reserve){.decals = 7};
    assert_frame(&d, 0,
                 GBUFFER MARCH_ON_RASTER
                 "decals(r:scene_depth u:albedo u:normal u:hdr) " LIGHT_SDF TONEMAP);
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SPRITES].stride, 64 * ((16 * (3 + 7 * 7) + 63) / 64));
    /* Textures, whether for sprites or not: a pass that writes them, larger sprites. */
    d.reserve = (masu_reserve){.textures = 2, .texture_size = {8, 16}};
    compile(&d, &plan);
    assert_non_null(
        strstr(frame_text(&plan, 0), "textures(u:textures) gbuffer(m:textures c:albedo "));
    assert_true(plan.images[MASU_IMAGE_TEXTURES].persistent);
    assert_int_equal(plan.images[MASU_IMAGE_TEXTURES].height, 16);
    assert_int_equal(masu_plan_layers(&plan, MASU_IMAGE_TEXTURES), 2);
    assert_int_equal(plan.buffers[MASU_BUFFER_TEXELS].stride, 64 * ((2064 + 4 * 8 * 16 + 63) / 64));
    d.reserve.decals = 7, d.reserve.trail_points = 5;
    compile(&d, &plan);
    assert_non_null(strstr(frame_text(&plan, 0), "decals(r:scene_depth rl:textures u:albedo "));
    assert_non_null(strstr(frame_text(&plan, 0), "particles(r:scene_depth rl:textures b:hdr)"));
    assert_int_equal(plan.buffers[MASU_BUFFER_SPRITES].stride,
                     64 * ((16 * (3 + 1 + 8 * 5 + 9 * 7) + 63) / 64));
    d.reserve = (masu_reserve){.trail_points = 5}; /* an image of one texel, which nothing writes */
    compile(&d, &plan);
    assert_null(strstr(frame_text(&plan, 0), "u:textures"));
    assert_int_equal(plan.images[MASU_IMAGE_TEXTURES].width, 1);
    assert_int_equal(plan.buffers[MASU_BUFFER_TEXELS].bytes, 0);
    d.reserve = (masu_reserve){.lines = 7};
    assert_frame(
        &d, 0,
        GBUFFER MARCH_ON_RASTER LIGHT_SDF
        "tonemap(r:hdr w:target) lines(r:scene_depth c:overlay) lines_show(r:overlay u:target)");
    compile(&d, &plan);
    assert_true(plan.images[MASU_IMAGE_OVERLAY].used);
    assert_int_equal(plan.buffers[MASU_BUFFER_SPRITES].stride, 64 * ((16 * (3 + 2 * 7) + 63) / 64));
    d.targets.storage = 0; /* they are in the image that is blitted */
    compile(&d, &plan);
    assert_non_null(strstr(frame_text(&plan, 0),
                           "lines_show(r:overlay u:final) present(from:final to:target)"));
    /* Draws among the transparent surfaces: one before each slot, one after. */
    d.reserve = (masu_reserve){.particles = 2};
    support_scene.blends = 1, support_scene.transparents = 5, support_scene.transparent_sets = 1;
    compile(&d, &plan);
    assert_int_equal(plan.sprites.particles, 3 + 6);
}

/* Shadows and ambient occlusion of the SDF: a pass and an image more, another permutation of light;
 * nothing in scenes that do not request them. */
static void sdf_occlusion_comes_between_march_and_light_if_asked(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static const char *const light =
        "light_occluded(r:albedo r:normal r:scene_depth r:occlusion u:hdr) ";
    char expected[512];
    masu_desc d = scene_desc(RASTER | SDF, 64, 64);
    d.readback = MASU_READBACK_OCCLUSION;
    assert_frame(&d, 0, GBUFFER MARCH_ON_RASTER LIGHT_SDF TONEMAP);
    assert_string_equal(why_of(&d, MASU_PASS_SDF_OCCLUSION),
                        "the scene has no SDF shadows or SDF ambient occlusion");
    compile(&d, &plan);
    assert_false(plan.images[MASU_IMAGE_OCCLUSION].used);
    support_scene.sdf_occlusion = 1;
    (void)snprintf(expected, sizeof expected, "%s%s%s%s%s%s", GBUFFER, MARCH_ON_RASTER,
                   "sdf_occlusion(r:scene_depth r:normal rb:slots w:occlusion) ", light,
                   "readback(from:occlusion) ", TONEMAP);
    assert_frame(&d, 0, expected);
    assert_string_equal(why_of(&d, MASU_PASS_LIGHT), "light_occluded runs instead");
    assert_string_equal(why_of(&d, MASU_PASS_LIGHT_OCCLUDED),
                        "a scene is lit, with the visibility from sdf_occlusion");
    d = scene_desc(RASTER, 64, 64);
    assert_string_equal(why_of(&d, MASU_PASS_SDF_OCCLUSION), "the scene has no SDF");
}

/* Ambient occlusion in screen space: two passes and two images in rungs that have it. */
static void ao_comes_after_all_that_writes_occlusion(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static const char ao[] =
        "ao(r:depth r:normal w:ao) ao_upsample(r:depth r:normal r:ao u:occlusion) ";
    static const char light[] = "light_occluded(r:albedo r:normal r:depth r:occlusion u:hdr) ";
    char expected[512];
    masu_desc d = scene_desc(RASTER, 101, 60);
    d.readback = MASU_READBACK_OCCLUSION;
    assert_string_equal(why_of(&d, MASU_PASS_AO),
                        "the scene has no ambient occlusion, or rung.ao is off");
    compile(&d, &plan);
    assert_false(plan.images[MASU_IMAGE_OCCLUSION].used || plan.images[MASU_IMAGE_AO].used);
    assert_int_equal(plan.desc.readback, 0);
    support_scene.occlusion_radius = 1;
    (void)snprintf(expected, sizeof expected, "%s%s%s%s%s", GBUFFER, ao, light,
                   "readback(from:occlusion) ", TONEMAP);
    assert_frame(&d, 0, expected);
    assert_string_equal(why_of(&d, MASU_PASS_LIGHT_OCCLUDED),
                        "a scene is lit, with the visibility from ao_upsample");
    compile(&d, &plan);
    assert_int_equal(plan.images[MASU_IMAGE_AO].width, 51);
    assert_int_equal(plan.images[MASU_IMAGE_AO].height, 30);
    assert_int_equal(plan.desc.rungs[0].ao_slices, 2);
    assert_int_equal(plan.desc.rungs[0].ao_steps, 8);
    d.debug.ao_full = 1;
    compile(&d, &plan);
    assert_int_equal(plan.images[MASU_IMAGE_AO].width, 101);
    d.debug.ao_full = 0;
    /* Off in one of two rungs: that rung reads and copies only images that it has written. */
    d.rung_count = 2;
    d.rungs[1].scale = 1;
    d.rungs[1].ao = MASU_OFF;
    (void)snprintf(expected, sizeof expected, "%s%s%s", GBUFFER,
                   "light(r:albedo r:normal r:depth u:hdr) readback() ", TONEMAP);
    assert_frame(&d, 1, expected);
    d.rungs[0].ao = MASU_OFF;
    compile(&d, &plan);
    assert_false(plan.images[MASU_IMAGE_OCCLUSION].used || plan.images[MASU_IMAGE_AO].used);
    assert_int_equal(plan.desc.readback, 0);
    d = scene_desc(RASTER | SDF, 64, 64);
    support_scene.occlusion_radius = 1;
    support_scene.sdf_occlusion = 1;
    (void)snprintf(expected, sizeof expected, "%s%s%s%s%s%s", GBUFFER, MARCH_ON_RASTER,
                   "sdf_occlusion(r:scene_depth r:normal rb:slots w:occlusion) ",
                   "ao(r:scene_depth r:normal w:ao) "
                   "ao_upsample(r:scene_depth r:normal r:ao u:occlusion) ",
                   "light_occluded(r:albedo r:normal r:scene_depth r:occlusion u:hdr) ", TONEMAP);
    assert_frame(&d, 0, expected);
}


/* Over all settings that shape a frame: the properties that every frame must have. */
static void in_every_frame_the_last_colour_writer_alone_writes_the_target(void **state) {
    (void)state;
    static masu_frame_plan plan;
    for (uint32_t c = 0; c < 2 * 2 * 4 * 3 * 3 * 3 * 2; c++) {
        uint32_t n = c, dynamic = n % 2;
        uint32_t storage = (n /= 2) % 2, parts = (n /= 2) % 4;
        masu_desc d = scene_desc(parts, 640, 480);
        d.rung_count = 1;
        if (parts & SDF) support_scene.sdf_dynamic = dynamic;
        d.rungs[0].upscale = (masu_switch)((n /= 4) % 3);
        d.rungs[0].sharpen = (masu_switch)((n /= 3) % 3);
        d.rungs[0].easu = (masu_easu)(c % 4);
        uint32_t size = (n /= 3) % 3, source = n / 3;
        d.rungs[0].scale = size ? 0.5f : 1.0f;
        if (d.rungs[0].upscale == MASU_OFF && size) continue; /* rejected */
        if (source) {
            d.scene = NULL;
            d.source = (masu_source){FAKE(VkImageView, 1), size ? 320 : 640, size ? 240 : 480,
                                     VK_FORMAT_UNDEFINED};
        }
        d.targets.storage = storage;
        compile(&d, &plan);
        const masu_rung_plan *rp = &plan.rungs[0];
        uint32_t writers = 0;
        int written[MASU_RESOURCE_END] = {
            [MASU_IMAGE_SOURCE] = 1, [MASU_RESOURCE(MASU_BUFFER_SLOTS)] = 1}; /* uploaded once */
        int last_pass = -1;
        for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
            if (masu_has_pass(&rp->active, p)) last_pass = (int)p;
            for (uint32_t a = 0; a < rp->access_count[p]; a++) {
                uint32_t image = rp->access[p][a].image, writes;
                writes = (uint32_t)masu_usage_writes((masu_usage)rp->access[p][a].usage);
                if (!writes && !written[image]) {
                    fail_msg("case %u: %s reads %s, which nothing has written", c,
                             masu_passes[p].name, resource_text((uint8_t)image));
                }
                if (writes) written[image] = 1;
                if (image != MASU_IMAGE_TARGET) continue;
                writers++;
                assert_true(writes);
                assert_int_equal(rp->access[p][a].usage, storage ? MASU_WRITE : MASU_WRITE_COPY);
            }
        }
        assert_int_equal(writers, 1);
        assert_true(last_pass >= 0);
        assert_int_equal(rp->access[last_pass][rp->access_count[last_pass] - 1].image,
                         MASU_IMAGE_TARGET);
        assert_true(source || written[MASU_IMAGE_HDR]);
    }
}

/* hdr is attached to the G-buffer pass if polygons can emit, unless that exceeds the number of
 * attachments. */
static void emission_goes_into_hdr(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 100, 50);
    support_scene.emissions = 1;
    assert_frame(&d, 0, "gbuffer(c:albedo c:normal uc:hdr d:depth) " LIGHT_RASTER TONEMAP);
    compile(&d, &plan);
    assert_int_equal(masu_has_emission_subpass(&plan), 1);
    support_scene.emissions = 0;
    d.mutable_materials = 1; /* a material can become emissive */
    assert_frame(&d, 0, "gbuffer(c:albedo c:normal uc:hdr d:depth) " LIGHT_RASTER TONEMAP);
    compile(&d, &plan);
    assert_int_equal(masu_has_emission_subpass(&plan), 0);
    d.mutable_materials = 0;
    support_scene.emissions = 1;
    support_scene.surfaces = 1;
    d.readback = MASU_READBACK_VELOCITY;
    for (uint32_t most = 4; most < 6; most++) {
        d.deny.color_attachments = most;
        compile(&d, &plan);
        assert_int_equal(plan.needs.emissive, most == 5);
        assert_int_equal(plan.needs.emission_packed, most == 4);
    }
    support_scene.emissions = support_scene.surfaces = 0;
}

/* ---- Images and buffers ---------------------------------------------------------------------- */

static void assert_image(const masu_frame_plan *plan, masu_image_id id, uint32_t first,
                         uint32_t last, uint32_t width, uint32_t height, VkImageUsageFlags usage) {
    const masu_image_plan *image = &plan->images[id];
    if (!image->used) fail_msg("%s is not used", masu_images[id].name);
    assert_int_equal(image->first, first);
    assert_int_equal(image->last, last);
    assert_int_equal(image->width, width);
    assert_int_equal(image->height, height);
    assert_int_equal(image->usage, usage);
}

#define SAMPLED VK_IMAGE_USAGE_SAMPLED_BIT
#define STORAGE VK_IMAGE_USAGE_STORAGE_BIT
#define COLOR VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT
#define DEPTH VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
#define SOURCE VK_IMAGE_USAGE_TRANSFER_SRC_BIT

static void images_live_from_their_first_to_their_last_pass(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 1920, 1080);
    compile(&d, &plan);
    assert_image(&plan, MASU_IMAGE_ALBEDO, MASU_PASS_GBUFFER, MASU_PASS_LIGHT, 1920, 1080,
                 COLOR | STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_NORMAL, MASU_PASS_GBUFFER, MASU_PASS_LIGHT, 1920, 1080,
                 COLOR | STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_DEPTH, MASU_PASS_GBUFFER, MASU_PASS_CLASSIFY, 1920, 1080,
                 DEPTH | SAMPLED);
    assert_image(&plan, MASU_IMAGE_SCENE_DEPTH, MASU_PASS_CLASSIFY, MASU_PASS_LIGHT, 1920, 1080,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_CONE8, MASU_PASS_CONE8, MASU_PASS_CONE4, 240, 135,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_CONE4, MASU_PASS_CONE4, MASU_PASS_MARCH, 480, 270,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_HDR, MASU_PASS_MARCH, MASU_PASS_TONEMAP, 1920, 1080,
                 STORAGE | SAMPLED);
    /* The first rung does not use the images: they have the size of the largest rung that does. */
    assert_image(&plan, MASU_IMAGE_LDR, MASU_PASS_TONEMAP, MASU_PASS_EASU, 1536, 864,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_UPSCALED, MASU_PASS_EASU, MASU_PASS_RCAS, 1920, 1080,
                 STORAGE | SAMPLED);
    assert_false(plan.images[MASU_IMAGE_FINAL].used);
    assert_false(plan.images[MASU_IMAGE_SOURCE].used); /* the host's */
    assert_false(plan.images[MASU_IMAGE_TARGET].used);
}

static void readback_and_blits_lengthen_lives(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 100, 50);
    d.readback = MASU_READBACK_DEPTH | MASU_READBACK_ALBEDO;
    d.targets.storage = 0;
    compile(&d, &plan);
    assert_image(&plan, MASU_IMAGE_ALBEDO, MASU_PASS_GBUFFER, MASU_PASS_READBACK, 100, 50,
                 COLOR | SAMPLED | SOURCE);
    assert_image(&plan, MASU_IMAGE_NORMAL, MASU_PASS_GBUFFER, MASU_PASS_LIGHT, 100, 50,
                 COLOR | SAMPLED);
    assert_image(&plan, MASU_IMAGE_DEPTH, MASU_PASS_GBUFFER, MASU_PASS_READBACK, 100, 50,
                 DEPTH | SAMPLED | SOURCE);
    assert_image(&plan, MASU_IMAGE_LDR, MASU_PASS_TONEMAP, MASU_PASS_EASU, 80, 40,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_FINAL, MASU_PASS_TONEMAP, MASU_PASS_PRESENT, 100, 50,
                 STORAGE | SOURCE);
    assert_false(plan.images[MASU_IMAGE_SCENE_DEPTH].used);
}

static void images_are_as_large_as_the_largest_rung_in_any_order(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(SDF, 1000, 10);
    d.rung_count = 3;
    d.rungs[0].scale = 0.3f;
    d.rungs[1].scale = 0.9f;
    d.rungs[2].scale = 0.5f;
    compile(&d, &plan);
    assert_image(&plan, MASU_IMAGE_HDR, MASU_PASS_MARCH, MASU_PASS_TONEMAP, 900, 9,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_UPSCALED, MASU_PASS_EASU, MASU_PASS_RCAS, 1000, 10,
                 STORAGE | SAMPLED);
    /* Numbers of blocks are rounded up: 900x9 has two rows of 8x8, three of 4x4. */
    assert_image(&plan, MASU_IMAGE_CONE8, MASU_PASS_CONE8, MASU_PASS_CONE4, 113, 2,
                 STORAGE | SAMPLED);
    assert_image(&plan, MASU_IMAGE_CONE4, MASU_PASS_CONE4, MASU_PASS_MARCH, 225, 3,
                 STORAGE | SAMPLED);
}

static void a_pass_that_writes_the_target_has_a_set_for_each_target(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 1920, 1080);
    d.targets.count = 3;
    compile(&d, &plan);
    /* classify, cone8, cone4, march, light, 3 x tonemap; then twice: these once, easu, 3 x rcas */
    assert_int_equal(plan.pass_sets, (5 + 3) + 2 * (7 + 3));
    d.targets.storage = 0; /* the blit needs none */
    compile(&d, &plan);
    assert_int_equal(plan.pass_sets, 6 + 2 * 8);
}

/* A coat adds its tables, except for SDF hits, which have none. */
static void only_what_is_coated_has_the_tables_of_coats(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 100, 100);
    masu_scene_data s = *masu_scene_data_of(d.scene);
    d.scene = masu_scene_of(&s);
    s.surfaces = 1;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_TABLES].bytes, 4 * MASU_TABLE_WORDS);
    s.coats = 1;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_TABLES].bytes, 4 * MASU_TABLE_WORDS_COAT);
    s.surfaces = 0; /* only transparent ones */
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_TABLES].bytes, 4 * MASU_TABLE_WORDS_COAT);
    assert_false(plan.needs.surface);
    d = scene_desc(SDF, 100, 100);
    s = *masu_scene_data_of(d.scene);
    d.scene = masu_scene_of(&s);
    s.surfaces = s.coats = 1;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_TABLES].bytes, 4 * MASU_TABLE_WORDS);
    d = source_desc(100, 100);
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_TABLES].bytes, 0);
}

static void buffers_are_sized_by_the_scene_and_the_frames_in_flight(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 1920, 1080);
    d.frames_in_flight = 3;
    compile(&d, &plan);
    const masu_buffer_plan *b = plan.buffers;
    uint64_t frame = (sizeof(struct masu_frame_uniforms) + 255) / 256 * 256;
    assert_int_equal(b[MASU_BUFFER_VERTICES].bytes, 11 * sizeof(masu_blob_vertex));
    assert_int_equal(b[MASU_BUFFER_INDICES].bytes, 15 * 4);
    assert_int_equal(b[MASU_BUFFER_MATERIALS].bytes, 2 * 48);
    assert_int_equal(b[MASU_BUFFER_TABLES].bytes, 4 * MASU_TABLE_WORDS);
    assert_int_equal(b[MASU_BUFFER_COUNTERS].bytes, 2 * 4 * MASU_COUNTER_COUNT);
    assert_int_equal(b[MASU_BUFFER_COUNTERS].count, 2 * MASU_COUNTER_COUNT);
    assert_int_equal(b[MASU_BUFFER_FRAME].stride, frame);
    assert_int_equal(b[MASU_BUFFER_FRAME].bytes, 3 * frame);
    /* 3 * 48, rounded up to a multiple of 64 */
    assert_int_equal(b[MASU_BUFFER_INSTANCES].stride, 192);
    assert_int_equal(b[MASU_BUFFER_INSTANCES].bytes, 3 * 192);
    assert_int_equal(b[MASU_BUFFER_SLOTS].bytes, 7 * 4);
    assert_int_equal(b[MASU_BUFFER_TILES].bytes, (8 + 120 * 68 * 2) * 4);
    assert_int_equal(b[MASU_BUFFER_READBACK].bytes, 0);
    assert_int_equal(b[MASU_BUFFER_STAGING].bytes, 0); /* computed with a device */
    assert_int_equal(b[MASU_BUFFER_FRAME].role, MASU_ROLE_UPLOAD);
    assert_int_equal(b[MASU_BUFFER_INSTANCES].role, MASU_ROLE_UPLOAD);
    assert_int_equal(b[MASU_BUFFER_READBACK].role, MASU_ROLE_READBACK);
    assert_int_equal(b[MASU_BUFFER_VERTICES].role, MASU_ROLE_DEVICE);

    d = source_desc(100, 100);
    compile(&d, &plan);
    for (uint32_t i = 0; i < MASU_BUFFER_COUNT; i++) {
        assert_non_null(b[i].name);
        assert_int_equal(b[i].bytes, 0);
    }
}

/* Passes, images and the other buffers are unchanged. */
static void a_sky_that_follows_from_the_sun_is_a_buffer_more(void **state) {
    (void)state;
    static masu_frame_plan without, with;
    masu_desc d = scene_desc(RASTER, 640, 360);
    d.frames_in_flight = 3;
    compile(&d, &without);
    for (int by_scene = 0; by_scene < 2; by_scene++) {
        d = scene_desc(RASTER, 640, 360);
        d.frames_in_flight = 3;
        support_scene.analytic_sky = (uint32_t)by_scene;
        d.analytic_sky = !by_scene;
        compile(&d, &with);
        uint64_t one = (sizeof(struct masu_sky_uniforms) + 255) / 256 * 256;
        for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
            uint64_t more = b == MASU_BUFFER_SKY ? 3 * one : 0;
            assert_int_equal(with.buffers[b].bytes, without.buffers[b].bytes + more);
        }
        assert_int_equal(without.buffers[MASU_BUFFER_SKY].bytes, 0);
        for (uint32_t r = 0; r < d.rung_count; r++)
            assert_memory_equal(&with.rungs[r].active, &without.rungs[r].active,
                                sizeof with.rungs[r].active);
        for (uint32_t i = 0; i < MASU_IMAGE_COUNT; i++) {
            assert_int_equal(with.images[i].used, without.images[i].used);
            assert_int_equal(with.images[i].usage, without.images[i].usage);
        }
    }
    d = source_desc(100, 100);
    d.analytic_sky = 1;
    compile(&d, &with);
    assert_int_equal(with.buffers[MASU_BUFFER_SKY].bytes, 0);
}

/* A scene without mesoscale detail has no images and no bytes for it. */
static void a_small_relief_costs_its_curves_and_the_surface_image(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 1920, 1080);
    compile(&d, &plan);
    assert_false(plan.needs.surface);
    assert_int_equal(plan.buffers[MASU_BUFFER_MATERIALS].bytes, 2 * 48);
    masu_scene_data scene = *masu_scene_data_of(d.scene);
    scene.surfaces = scene.meso = 1;
    d.scene = masu_scene_of(&scene);
    compile(&d, &plan);
    assert_true(plan.needs.surface);
    assert_int_equal(plan.buffers[MASU_BUFFER_MATERIALS].bytes, 2 * 48 + 96);
}

static void tiles_have_room_for_lists_at_the_largest_rung(void **state) {
    (void)state;
    static const struct {
        uint32_t parts, words, block_words;
    } cases[] = {{1, 2, 0},  {1, 2, 1},  {32, 2, 1},  {32, 2, 2},
                 {33, 3, 2}, {64, 3, 2}, {65, 65, 2}, {4096, 65, 2}};
    static masu_frame_plan plan;
    for (size_t i = 0; i < COUNT(cases); i++) {
        masu_desc d = scene_desc(SDF, 1000, 100);
        support_scene.sdf_parts = cases[i].parts;
        support_scene.sdf_block_words = cases[i].block_words;
        d.rung_count = 3;
        d.rungs[0].scale = 0.3f;
        d.rungs[1].scale = 0.5f; /* 500x50: 32x4 tiles */
        d.rungs[2].scale = 0.4f;
        compile(&d, &plan);
        const masu_buffer_plan *tiles = &plan.buffers[MASU_BUFFER_TILES];
        /* 125x13 blocks of 4x4 pixels: the cone's end distance, and four pieces */
        uint32_t block = cases[i].block_words ? 1 + 4 * cases[i].block_words : 0;
        assert_int_equal(tiles->count, 8 + 32 * 4 * cases[i].words + 125 * 13 * block);
        assert_int_equal(tiles->bytes, 4 * tiles->count);
        assert_int_equal(tiles->role, MASU_ROLE_DEVICE);
        assert_true(tiles->usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
        assert_true(tiles->usage & VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
    }
    masu_desc d = scene_desc(RASTER, 1000, 100); /* no SDF: neither */
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_TILES].bytes, 0);
    assert_int_equal(plan.buffers[MASU_BUFFER_SLOTS].bytes, 0);
}

static void readback_slots_hold_the_counters_and_then_the_images(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER | SDF, 7, 5); /* 35 texels: 140 bytes, 280 for hdr */
    d.debug.counters = 1;
    d.readback = MASU_READBACK_ALL;
    compile(&d, &plan);
    const masu_buffer_plan *b = &plan.buffers[MASU_BUFFER_READBACK];
    const uint64_t first = masu_align_up(2 * MASU_COUNTER_COUNT * sizeof(uint32_t), 16);
    const uint64_t offsets[MASU_READBACK_IMAGES] = {first, first + 144, first + 288, first + 432,
                                                    first + 432 + 288};
    for (uint32_t i = 0; i < MASU_READBACK_IMAGES - 1; i++) {
        assert_int_equal(plan.readback_offset[i], offsets[i]);
    }
    assert_int_equal(b->stride, first + 432 + 2 * 288);
    assert_int_equal(b->bytes, 2 * b->stride);
    d.debug.counters = 0;
    d.readback = MASU_READBACK_HDR;
    compile(&d, &plan);
    assert_int_equal(plan.readback_offset[3], 0);
    assert_int_equal(b->stride, 288);
    d.debug.timestamps = 1; /* one before each pass and one at the end */
    compile(&d, &plan);
    uint64_t times = (8 * (MASU_PASS_COUNT + 1) + 15) / 16 * 16;
    assert_int_equal(plan.readback_times, 0);
    assert_int_equal(plan.readback_offset[3], times);
    assert_int_equal(b->stride, times + 288);
}

/* ---- Export ---------------------------------------------------------------------------------- */

static void the_public_plan_tells_what_was_compiled(void **state) {
    (void)state;
    static masu_frame_plan plan;
    static masu_plan_info info;
    masu_desc d = scene_desc(RASTER, 1920, 1080);
    uint64_t times[MASU_PASS_COUNT];
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) times[p] = 100 + p;
    compile(&d, &plan);
    plan.rungs[1].barriers = 7;
    masu_plan_export(&plan, times, &info);
    assert_int_equal(info.pass_count, MASU_PASS_COUNT);
    assert_int_equal(info.rung_count, 3);
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        uint32_t active = 0;
        for (uint32_t r = 0; r < 3; r++)
            active |= (uint32_t)masu_has_pass(&plan.rungs[r].active, p) << r;
        assert_string_equal(info.passes[p].name, masu_passes[p].name);
        assert_string_equal(info.passes[p].why, plan.why[p]);
        assert_int_equal(info.passes[p].active, active);
        assert_int_equal(info.passes[p].pipeline_ns, 100 + p);
    }
    const masu_plan_pass *light = &info.passes[MASU_PASS_LIGHT];
    assert_string_equal(light->reads[0], "albedo");
    assert_string_equal(light->reads[1], "normal");
    assert_string_equal(light->reads[2], "depth");
    assert_null(light->reads[3]);
    assert_string_equal(light->writes[0], "hdr");
    assert_null(light->writes[1]);
    assert_null(info.passes[MASU_PASS_MARCH].reads[0]);
    assert_string_equal(info.passes[MASU_PASS_TONEMAP].writes[0], "target"); /* of rung 0 */
    assert_null(info.passes[MASU_PASS_TONEMAP].writes[1]);
    assert_int_equal(info.rungs[0].dispatches, 3);
    assert_int_equal(info.rungs[1].dispatches, 5);
    assert_int_equal(info.rungs[1].barriers, 7);
    assert_int_equal(info.rungs[0].render_width, 1920);
    assert_int_equal(info.rungs[2].render_width, 768);
    assert_int_equal(info.rungs[2].render_height, 432);
    assert_int_equal(info.image_count, MASU_IMAGE_SOURCE - 1);
    for (uint32_t i = 0; i < info.image_count; i++) {
        const masu_image_plan *image = &plan.images[i + 1];
        assert_string_equal(info.images[i].name, masu_images[i + 1].name);
        assert_int_equal(info.images[i].format, masu_images[i + 1].format);
        assert_int_equal(info.images[i].used, image->used);
        assert_int_equal(info.images[i].width, image->width);
        assert_int_equal(info.images[i].height, image->height);
        assert_int_equal(info.images[i].first_pass, image->first);
        assert_int_equal(info.images[i].last_pass, image->last);
    }
    masu_plan_export(&plan, NULL, &info);
    assert_int_equal(info.passes[MASU_PASS_LIGHT].pipeline_ns, 0);
}

/* Bytes of the images that a plan with these settings uses; *saved: of those that it omits. */
static uint64_t image_bytes(masu_desc d, masu_rung rung, uint64_t *saved) {
    static masu_frame_plan plan;
    static masu_plan_info info;
    uint64_t used = 0;
    d.rung_count = 1;
    d.rungs[0] = rung;
    compile(&d, &plan);
    masu_plan_export(&plan, NULL, &info);
    for (uint32_t i = 0; i < info.image_count; i++) {
        if (!info.images[i].used) continue;
        used += (uint64_t)info.images[i].width * info.images[i].height * masu_images[i + 1].layers *
                masu_format_bytes(info.images[i].format);
    }
    *saved = info.saved_bytes;
    return used;
}

static void images_that_are_used_and_those_left_out_are_all_images(void **state) {
    (void)state;
    uint64_t saved[2], all;
    masu_desc d = source_desc(1000, 500);
    all = image_bytes(d, (masu_rung){.sharpen = MASU_OFF}, &saved[0]) + saved[0];
    assert_int_equal(
        image_bytes(d, (masu_rung){.sharpen = MASU_OFF, .aa = MASU_AA_FXAA}, &saved[1]) + saved[1],
        all);
    assert_int_equal(saved[0] - saved[1], 4 * 1000 * 500); /* smooth */
    d = scene_desc(RASTER | SDF, 100, 100);
    all = image_bytes(d, (masu_rung){.scale = 1}, &saved[0]) + saved[0];
    assert_int_equal(
        image_bytes(d, (masu_rung){.silhouettes = MASU_ON, .aa = MASU_AA_FXAA}, &saved[1]) +
            saved[1],
        all);
    assert_int_equal(saved[0] - saved[1], 2 * 4 * 100 * 100); /* silhouettes, ldr */
    d = scene_desc(RASTER, 100, 100); /* neither scene_depth nor the two images of the march */
    assert_int_equal(image_bytes(d, (masu_rung){.scale = 1}, &saved[1]) + saved[1], all);
    assert_int_equal(saved[1] - saved[0], 4 * (100 * 100 + 25 * 25 + 13 * 13));
}

static void the_public_memory_sums_the_blocks(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_memory memory;
    memset(&plan, 0, sizeof plan);
    plan.blocks[MASU_ROLE_DEVICE] = (masu_block_plan){1000, 256, 6, 1, 0, 1};
    plan.blocks[MASU_ROLE_READBACK] = (masu_block_plan){24, 16, 4, 2, 1, 0};
    plan.blocks[MASU_ROLE_UPLOAD] = (masu_block_plan){0, 8, 2, 3, 1, 0}; /* not used */
    plan.transient_unaliased = 900, plan.transient_aliased = 600, plan.transient_lower_bound = 500;
    masu_memory_export(&plan, 777, &memory);
    assert_int_equal(memory.host_bytes, 777);
    assert_int_equal(memory.host_alignment, 64);
    assert_int_equal(memory.device_bytes, 1024);
    assert_int_equal(memory.unified, 0);
    assert_int_equal(memory.roles[MASU_ROLE_DEVICE].alignment, 256);
    assert_int_equal(memory.roles[MASU_ROLE_DEVICE].type_bits, 6);
    assert_int_equal(memory.roles[MASU_ROLE_DEVICE].type, 1);
    assert_int_equal(memory.roles[MASU_ROLE_DEVICE].host_visible, 0);
    assert_int_equal(memory.roles[MASU_ROLE_DEVICE].device_address, 1);
    assert_int_equal(memory.roles[MASU_ROLE_READBACK].device_address, 0);
    assert_int_equal(memory.roles[MASU_ROLE_UPLOAD].bytes, 0);
    assert_int_equal(memory.roles[MASU_ROLE_UPLOAD].alignment, 0);
    assert_int_equal(memory.roles[MASU_ROLE_UPLOAD].host_visible, 0);
    assert_int_equal(memory.roles[MASU_ROLE_READBACK].bytes, 24);
    assert_int_equal(memory.roles[MASU_ROLE_READBACK].host_visible, 1);
    assert_int_equal(memory.transient_unaliased, 900);
    assert_int_equal(memory.transient_aliased, 600);
    assert_int_equal(memory.transient_lower_bound, 500);
}

/* ---- Punctual lights ---------------------------------------------------------------------------- */

static void lights_add_a_pass_and_two_buffers(void **state) {
    (void)state;
    static masu_frame_plan plan, dark;
    masu_desc d = scene_desc(RASTER | SDF, 100, 50);
    d.rung_count = 2;
    d.rungs[1].light_tiles = MASU_OFF;
    compile(&d, &dark);
    assert_string_equal(frame_text(&dark, 0), GBUFFER MARCH_ON_RASTER LIGHT_SDF TONEMAP);
    assert_string_equal(dark.why[MASU_PASS_LIGHT_TILES], "the scene has no punctual lights");
    assert_int_equal(dark.buffers[MASU_BUFFER_LIGHTS].bytes, 0);
    assert_int_equal(dark.buffers[MASU_BUFFER_LIGHT_TILES].bytes, 0);
    static const struct {
        uint32_t lights, words; /* for a list */
    } cases[] = {{1, 2}, {62, 63}, {63, 64}, {64, 64}, {4096, 64}};
    for (size_t i = 0; i < COUNT(cases); i++) {
        support_scene.lights = cases[i].lights;
        compile(&d, &plan);
        assert_string_equal(frame_text(&plan, 0),
                            GBUFFER MARCH_ON_RASTER
                            "light_tiles(r:scene_depth wb:lights) "
                            "light(rb:lights r:albedo r:normal r:scene_depth u:hdr) " TONEMAP);
        assert_string_equal(frame_text(&plan, 1), GBUFFER MARCH_ON_RASTER LIGHT_SDF TONEMAP);
        assert_int_equal(
            plan.buffers[MASU_BUFFER_LIGHTS].stride,
            masu_align_up(16 + sizeof(struct masu_punctual_light_data) * cases[i].lights, 64));
        assert_int_equal(plan.buffers[MASU_BUFFER_LIGHTS].bytes,
                         2 * plan.buffers[MASU_BUFFER_LIGHTS].stride);
        assert_int_equal(plan.buffers[MASU_BUFFER_LIGHT_TILES].bytes, 7 * 4 * 4 * cases[i].words);
        /* Nothing else is different. */
        for (uint32_t b = 0; b < MASU_BUFFER_COUNT; b++) {
            if (b == MASU_BUFFER_LIGHTS || b == MASU_BUFFER_LIGHT_TILES) continue;
            assert_memory_equal(&plan.buffers[b], &dark.buffers[b], sizeof dark.buffers[b]);
        }
        for (uint32_t id = 1; id < MASU_IMAGE_SOURCE; id++) {
            assert_int_equal(plan.images[id].used, dark.images[id].used);
            assert_int_equal(plan.images[id].usage, dark.images[id].usage);
        }
    }
    d.rungs[0].light_tiles = MASU_OFF; /* the lists are still bound, but no pass reads them */
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_LIGHT_TILES].bytes, 4);
    assert_string_equal(plan.why[MASU_PASS_LIGHT_TILES], "rung.light_tiles is off");
    support_scene.lights = 0;
    compile(&d, &plan);
    dark.desc.rungs[0].light_tiles = MASU_OFF;
    assert_memory_equal(plan.buffers, dark.buffers, sizeof dark.buffers);
    assert_memory_equal(plan.images, dark.images, sizeof dark.images);
}

/* ---- Anti-aliasing --------------------------------------------------------------------------- */

#define EDGES(from, to)                                                                            \
    "smaa_edges(r:" from " wb:edges w:" to ") smaa_blend(r:" from " rb:edges u:" to ")"

/* SMAA runs between tone mapping and upscaling. If no pass follows, both of its passes write the
 * target. */
static void anti_aliasing_reads_what_is_shown_and_hands_it_on(void **state) {
    (void)state;
    masu_desc d = scene_desc(RASTER, 640, 480);
    d.rung_count = 4;
    d.rungs[0] = (masu_rung){.aa = MASU_AA_SMAA_LOW};
    d.rungs[1] = (masu_rung){.scale = 0.5f, .aa = MASU_AA_SMAA_ULTRA};
    d.rungs[2] = (masu_rung){.aa = MASU_AA_FXAA};
    d.rungs[3] = (masu_rung){.aa = MASU_AA_AUTO};
    assert_frame(&d, 0, GBUFFER LIGHT_RASTER "tonemap(r:hdr w:ldr) " EDGES("ldr", "target"));
    assert_frame(&d, 1, GBUFFER LIGHT_RASTER "tonemap(r:hdr w:ldr) " EDGES("ldr", "smooth")
                        " easu_twice(r:smooth w:upscaled) rcas(r:upscaled w:target)");
    assert_frame(&d, 2, GBUFFER LIGHT_RASTER "tonemap(r:hdr w:ldr) fxaa(r:ldr w:target)");
    assert_frame(&d, 3, GBUFFER LIGHT_RASTER TONEMAP);
    assert_string_equal(why_of(&d, MASU_PASS_SMAA_BLEND), "rung.aa selects it");
    d.targets.storage = 0;
    assert_frame(&d, 0, GBUFFER LIGHT_RASTER "tonemap(r:hdr w:ldr) " EDGES("ldr", "final")
                        " present(from:final to:target)");
    d = source_desc(320, 240); /* shown at 1920x1080 */
    d.rungs[0].aa = MASU_AA_SMAA_HIGH;
    assert_frame(&d, 0,
                 EDGES("source", "smooth") " easu(r:smooth w:upscaled) rcas(r:upscaled w:target)");
    d = source_desc(1920, 1080);
    d.rungs[0].aa = MASU_AA_SMAA_HIGH;
    assert_frame(&d, 0, EDGES("source", "target"));
    d.rungs[0].aa = MASU_AA_FXAA;
    assert_frame(&d, 0, "fxaa(r:source w:target)");
    d.rungs[0].aa = MASU_AA_OFF;
    assert_frame(&d, 0, "easu(r:source w:target)");
    assert_string_equal(why_of(&d, MASU_PASS_SMAA_EDGES), "rung.aa does not select it");
}

/* A rung without it uses none of its memory; the size is that of the largest rung with it. */
static void only_smaa_has_tables_and_tiles(void **state) {
    (void)state;
    static masu_frame_plan plan;
    masu_desc d = scene_desc(RASTER, 640, 480);
    d.rung_count = 3;
    d.rungs[0].aa = MASU_AA_OFF;
    d.rungs[1] = (masu_rung){.scale = 0.5f, .aa = MASU_AA_FXAA};
    d.rungs[2].aa = MASU_AA_AUTO;
    compile(&d, &plan);
    assert_false(plan.needs.smoothing);
    assert_int_equal(plan.buffers[MASU_BUFFER_SMAA_AREA].bytes, 0);
    assert_int_equal(plan.buffers[MASU_BUFFER_SMAA_TILES].bytes, 0);
    assert_int_equal(plan.images[MASU_IMAGE_SMOOTH].width, 320);
    d.rungs[1].aa = MASU_AA_SMAA_MEDIUM;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SMAA_AREA].bytes, 4 * MASU_SMAA_AREA_WORDS);
    assert_int_equal(plan.buffers[MASU_BUFFER_SMAA_TILES].bytes, 4 * (8 + 20 * 15 * 33));
    assert_int_equal(plan.images[MASU_IMAGE_SMOOTH].width, 320);
    assert_int_equal(plan.images[MASU_IMAGE_SMOOTH].height, 240);
    d = source_desc(17, 16);
    d.debug.counters = 1;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_COUNTERS].bytes, 0);
    d.rungs[0].aa = MASU_AA_SMAA_LOW;
    compile(&d, &plan);
    assert_int_equal(plan.buffers[MASU_BUFFER_SMAA_TILES].bytes, 4 * (8 + 2 * 33));
    assert_int_equal(plan.buffers[MASU_BUFFER_COUNTERS].bytes, 8 * MASU_COUNTER_COUNT);
}

/* ---- Reflections: ray-tracing backend -------------------------------------------------------- */

/* AUTO depends on the device, which this test does not have: the renderer replaces it by ON or
 * OFF. */
static void ray_queries_stand_in_for_the_own_tree(void **state) {
    (void)state;
    static masu_frame_plan plan, with;
    masu_desc d = scene_desc(RASTER, 100, 50);
    support_scene.reflections = 1;
    support_scene.specular_cutoff = 0.5f;
    support_scene.trace_nodes = 9;
    support_scene.trace_triangles = 20;
    support_scene.trace_instances = 3;
    d.rung_count = 2;
    d.rungs[1].specular = MASU_OFF;
    compile(&d, &plan);
    assert_non_null(strstr(frame_text(&plan, 0), "specular_trace(r:specular_guide r:specular_ray "
                                                 "rb:glossy u:specular_hit)"));
    assert_null(strstr(frame_text(&plan, 0), "specular_query"));
    d.ray_query = MASU_ON;
    compile(&d, &with);
    assert_non_null(strstr(frame_text(&with, 0),
                           "specular_structure(ws:top) specular_query(r:specular_guide "
                           "r:specular_ray rs:top rb:glossy u:specular_hit)"));
    assert_null(strstr(frame_text(&with, 0), "specular_trace"));
    assert_null(strstr(frame_text(&with, 1), "specular_"));
    assert_string_equal(with.why[MASU_PASS_SPECULAR_TRACE], "specular_query runs instead");
    assert_string_equal(plan.why[MASU_PASS_SPECULAR_QUERY],
                        "no ray queries, or desc.ray_query is off");
    /* Nodes of 48 bytes and the BVH over instances are omitted. */
    assert_int_equal(plan.buffers[MASU_BUFFER_TRACE].bytes - with.buffers[MASU_BUFFER_TRACE].bytes,
                     9 * 48);
    assert_int_equal(with.buffers[MASU_BUFFER_TRACE_FRAME].stride,
                     masu_align_up(16 + 3 * 6 * 16, 64));
    VkBufferUsageFlags input =
        VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
        VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;
    assert_int_equal(with.buffers[MASU_BUFFER_VERTICES].usage,
                     plan.buffers[MASU_BUFFER_VERTICES].usage | input);
    assert_int_equal(plan.buffers[MASU_BUFFER_VERTICES].usage & input, 0);
    support_scene.trace_instances = 0; /* nothing to trace: as without reflections */
    compile(&d, &with);
    assert_null(strstr(frame_text(&with, 0), "specular_query"));
    assert_string_equal(with.why[MASU_PASS_SPECULAR_QUERY], "no instance is traced");
    d.ray_query = (masu_switch)(MASU_ON + 1);
    masu_detail detail;
    assert_int_equal(masu_compile(&d, 256, 64, &with, &detail), MASU_ERROR_ARGUMENT);
    assert_string_equal(detail.what, "ray_query");
}

/* The limit of an instance's custom index or of the device, whichever is lower. */
static void ray_queries_have_limits(void **state) {
    (void)state;
    masu_scene_data s = {.trace_triangles = 1u << 24, .trace_instances = 7};
    masu_detail detail;
    masu_vk vk;
    memset(&vk, 0, sizeof vk);
    vk.rays.maxPrimitiveCount = 1u << 29;
    vk.rays.maxInstanceCount = 7;
    assert_int_equal(masu_ray_check(&s, &vk, &detail), MASU_OK);
    s.trace_triangles++;
    assert_int_equal(masu_ray_check(&s, &vk, &detail), MASU_ERROR_DEVICE);
    assert_string_equal(detail.text, "ray_query: the scene traces 16777217 triangles, possible are "
                                     "16777216");
    s.trace_triangles = 1000;
    vk.rays.maxPrimitiveCount = 999;
    assert_int_equal(masu_ray_check(&s, &vk, &detail), MASU_ERROR_DEVICE);
    assert_int_equal(detail.needed, 1000);
    assert_int_equal(detail.given, 999);
    vk.rays.maxPrimitiveCount = 1000;
    s.trace_instances = 8;
    assert_int_equal(masu_ray_check(&s, &vk, &detail), MASU_ERROR_DEVICE);
    assert_string_equal(detail.what, "maxInstanceCount");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_row_of_the_table_fits_what_is_derived_from_it),
        cmocka_unit_test(the_default_rungs_of_full_hd_are_these),
        cmocka_unit_test(odd_sizes_round_to_nearest_and_never_to_nothing),
        cmocka_unit_test(any_scale_of_any_size_gives_a_size_within_half_a_pixel),
        cmocka_unit_test(a_rung_that_rounds_to_the_output_size_is_not_upscaled),
        cmocka_unit_test(a_rung_that_differs_in_one_direction_alone_is_upscaled),
        cmocka_unit_test(a_source_image_ignores_the_scales_of_the_rungs),
        cmocka_unit_test(polygons_and_sdf_make_the_whole_frame),
        cmocka_unit_test(without_an_sdf_nothing_is_marched),
        cmocka_unit_test(without_instances_nothing_is_rasterised),
        cmocka_unit_test(slots_are_updated_only_if_something_changes_them),
        cmocka_unit_test(light_probes_cost_only_scenes_that_have_them),
        cmocka_unit_test(march_steps_reach_the_shaders),
        cmocka_unit_test(an_empty_scene_is_cleared_and_lit),
        cmocka_unit_test(a_source_image_alone_is_upscaled_and_sharpened),
        cmocka_unit_test(a_source_image_of_the_output_size_is_written_all_the_same),
        cmocka_unit_test(switches_force_upscaling_and_sharpening_on_and_off),
        cmocka_unit_test(a_rung_says_how_it_is_upscaled),
        cmocka_unit_test(twice_the_size_has_a_pass_of_its_own),
        cmocka_unit_test(a_target_that_is_no_storage_image_is_blitted_to),
        cmocka_unit_test(a_metered_exposure_is_two_passes),
        cmocka_unit_test(the_last_pass_of_a_rung_makes_the_output),
        cmocka_unit_test(the_reason_of_a_pass_is_that_of_the_first_rung_that_runs_it),
        cmocka_unit_test(readback_copies_what_is_asked_for),
        cmocka_unit_test(silhouettes_are_a_pass_where_a_rung_asks_for_them),
        cmocka_unit_test(temporal_stands_in_for_anti_aliasing_and_upscaling),
        cmocka_unit_test(velocities_keep_the_frame_before_and_nothing_else_does),
        cmocka_unit_test(picking_costs_nothing_unless_it_is_asked_for),
        cmocka_unit_test(what_is_blended_comes_over_the_light_if_there_is_any),
        cmocka_unit_test(what_is_reserved_has_passes_and_nothing_else_has),
        cmocka_unit_test(sdf_occlusion_comes_between_march_and_light_if_asked),
        cmocka_unit_test(ao_comes_after_all_that_writes_occlusion),
        cmocka_unit_test(in_every_frame_the_last_colour_writer_alone_writes_the_target),
        cmocka_unit_test(emission_goes_into_hdr),
        cmocka_unit_test(images_live_from_their_first_to_their_last_pass),
        cmocka_unit_test(readback_and_blits_lengthen_lives),
        cmocka_unit_test(images_are_as_large_as_the_largest_rung_in_any_order),
        cmocka_unit_test(a_pass_that_writes_the_target_has_a_set_for_each_target),
        cmocka_unit_test(only_what_is_coated_has_the_tables_of_coats),
        cmocka_unit_test(buffers_are_sized_by_the_scene_and_the_frames_in_flight),
        cmocka_unit_test(a_sky_that_follows_from_the_sun_is_a_buffer_more),
        cmocka_unit_test(a_small_relief_costs_its_curves_and_the_surface_image),
        cmocka_unit_test(tiles_have_room_for_lists_at_the_largest_rung),
        cmocka_unit_test(readback_slots_hold_the_counters_and_then_the_images),
        cmocka_unit_test(the_public_plan_tells_what_was_compiled),
        cmocka_unit_test(images_that_are_used_and_those_left_out_are_all_images),
        cmocka_unit_test(anti_aliasing_reads_what_is_shown_and_hands_it_on),
        cmocka_unit_test(only_smaa_has_tables_and_tiles),
        cmocka_unit_test(the_public_memory_sums_the_blocks),
        cmocka_unit_test(lights_add_a_pass_and_two_buffers),
        cmocka_unit_test(ray_queries_stand_in_for_the_own_tree),
        cmocka_unit_test(ray_queries_have_limits),
    };
    return cmocka_run_group_tests_name("plan", tests, NULL, NULL);
}

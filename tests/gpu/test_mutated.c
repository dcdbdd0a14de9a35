/* test_mutated.c: scenes with random bytes changed, and length and hash made to fit, as a faulty or
 * hostile tool would write them. Each is refused by one line, or loaded and drawn: then every pixel
 * is finite, the validation layer stays silent, and nothing dies. The words of SPIR-V are left as
 * they are: their meaning is the driver's to judge, not the reader's.
 *
 * MUTATED=N tries N of each scene, LONG=1 1,000; else a few of two scenes. MUTATED_FROM=I begins
 * with number I of each, to repeat one. */
#include "support/files.h"
#include "support/random.h"
#include "support/support.h"

#include "scene/blob.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 24, H = 18, FRAMES = 3, SECTIONS_MAX = 128 };

static const char *const scenes[] = {"test_both", "test_skin",  "test_lods",
                                     "test_live", "test_trace", "test_texture_quad"};
enum { SCENES = sizeof scenes / sizeof *scenes };

typedef struct counts {
    uint32_t refused, too_much, drawn;
} counts;

static masu_pipelines pool;
static const char *now_scene; /* what the test has come to, if it dies */
static uint32_t now_number;

static bool is_code(uint32_t kind) {
    static const uint32_t code[] = {MASU_BLOB_MARCH_SPIRV,       MASU_BLOB_CLASSIFY_SPIRV,
                                    MASU_BLOB_CONE8_SPIRV,       MASU_BLOB_CONE4_SPIRV,
                                    MASU_BLOB_UPDATE_SPIRV,      MASU_BLOB_PLAIN_SPIRV,
                                    MASU_BLOB_SEED_SPIRV,        MASU_BLOB_CHECKERBOARD_SPIRV,
                                    MASU_BLOB_UPDATE_PREVIOUS_SPIRV, MASU_BLOB_VELOCITY_SPIRV,
                                    MASU_BLOB_OCCLUSION_SPIRV,   MASU_BLOB_TRACE_SDF_SPIRV,
                                    MASU_BLOB_SILHOUETTES_SPIRV, MASU_BLOB_BOUNCE_SDF_SPIRV,
                                    MASU_BLOB_LOCAL_SHADOW_SPIRV};
    for (size_t i = 0; i < sizeof code / sizeof *code; i++)
        if (code[i] == kind) return true;
    return false;
}

/* One to four values of sections, any section being as likely as any other. */
static void mutate(uint8_t *blob, size_t bytes, uint64_t *random) {
    static const uint32_t awkward[] = {0,          1,          0x7FFFFFFF, 0x80000000,
                                       0xFFFFFFFF, 0x7F800000, 0xFF800000, 0x7FC00000,
                                       0x00000001, 0x7F7FFFFF, 0x00010000, 0x3F800000};
    masu_blob_header header;
    masu_blob_section sections[SECTIONS_MAX];
    memcpy(&header, blob, sizeof header);
    assert_in_range(header.section_count, 1, SECTIONS_MAX);
    memcpy(sections, blob + sizeof header, header.section_count * sizeof *sections);
    for (uint64_t changes = support_random_in(random, 1, 4); changes; changes--) {
        const masu_blob_section *s = &sections[random_word(random) % header.section_count];
        const uint64_t size = s->count * s->stride;
        if (!size || is_code(s->kind)) continue;
        /* Now and then the table of sections itself. */
        uint64_t at = random_word(random) % 16 ? s->offset + random_word(random) % size
                                               : sizeof header + random_word(random) %
                                                                     (header.section_count *
                                                                      sizeof *sections);
        const uint32_t value = awkward[random_word(random) % 12];
        switch (random_word(random) % 4) {
            case 0: blob[at] = (uint8_t)random_word(random); break;
            case 1: blob[at] ^= (uint8_t)(1u << random_word(random) % 8); break;
            case 2: blob[at] = (uint8_t)(blob[at] + (random_word(random) & 1 ? 1 : 255)); break;
            default:
                at &= ~(uint64_t)3;
                memcpy(blob + at, &value, bytes - at < 4 ? bytes - at : 4);
        }
    }
    header.hash = masu_fnv1a64(blob + sizeof header, bytes - sizeof header);
    memcpy(blob, &header, sizeof header);
}

static void one_line(masu_result result, const masu_detail *detail) {
    if (detail->result != result || !detail->what || !*detail->text || strchr(detail->text, '\n'))
        fail_msg("%s without one line of reason: '%s'", masu_result_string(result), detail->text);
}

static void draw_all(masu_session *s, own_renderer *x) {
    char error[ERROR_SIZE];
    for (uint32_t i = 0; i < FRAMES; i++) {
        const masu_frame_desc f = {MASU_FRAME_DESC, .time_step = 0.1f, .rung = i % 2};
        masu_commands commands;
        masu_readback_image image;
        masu_detail detail;
        if (masu_frame(x->m, &f, &commands, &detail)) fail_msg("%s", detail.text);
        assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
        assert_int_equal(masu_readback(x->m, commands.slot, MASU_READBACK_HDR, &image, NULL), 0);
        for (uint32_t y = 0; y < image.height; y++) {
            const uint16_t *row = (const uint16_t *)((const char *)image.pixels +
                                                     (size_t)y * image.row_bytes);
            for (uint32_t k = 0; k < image.width * 4; k++)
                if ((row[k] & 0x7C00u) == 0x7C00u) fail_msg("frame %u has 0x%04x", i, row[k]);
        }
    }
}

static void attempt(masu_session *s, const uint8_t *blob, size_t bytes, counts *n) {
    masu_scene scene;
    masu_detail detail;
    masu_memory need;
    masu_result result = masu_scene_bind(blob, bytes, &scene, &detail);
    if (result) {
        assert_true(result == MASU_ERROR_SCENE || result == MASU_ERROR_VERSION);
        one_line(result, &detail);
        n->refused++;
        return;
    }
    own_renderer x = {0};
    masu_desc d = s->desc;
    make_target(s, &x, W, H, 1);
    d.scene = &scene;
    d.vulkan.pipelines = &pool;
    d.targets = (masu_targets){
        .images = &x.target.image, .views = &x.target.view, .count = 1, .storage = 1};
    result = masu_memory_query(&d, &need, &detail);
    if (!result) {
        x.block = host_block(need.host_bytes);
        result = masu_init(&d, x.block, need.host_bytes, &x.m, &detail);
    }
    if (!result) {
        load_all(s, x.m);
        draw_all(s, &x);
        n->drawn++;
    } else { /* more than the device has */
        if (result != MASU_ERROR_LIMIT && result != MASU_ERROR_DEVICE &&
            result != MASU_ERROR_MEMORY)
            fail_msg("%s: %s", masu_result_string(result), detail.text);
        one_line(result, &detail);
        n->too_much++;
    }
    unmake_own(s, &x);
}

static uint32_t asked(const char *name, uint32_t otherwise) {
    const char *text = getenv(name);
    return text && *text ? (uint32_t)strtoul(text, NULL, 10) : otherwise;
}

static void mutated_scenes_are_refused_or_drawn(void **state) {
    (void)state;
    const uint32_t first = asked("MUTATED_FROM", 0);
    const uint32_t count = asked("MUTATED", long_run() ? 1000 : 10);
    for (uint32_t k = 0; k < (count > 10 || first ? SCENES : 2); k++) {
        size_t bytes;
        uint8_t *seed = read_file(scene_path(scenes[k]), &bytes);
        masu_session s;
        counts n = {0};
        masu_session_desc d = test_desc(NULL, W, H);
        d.no_renderer = true;
        d.desc.readback = MASU_READBACK_HDR;
        d.desc.rung_count = 2;
        d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
        d.desc.rungs[1] = (masu_rung){.scale = 0.5f, .temporal = MASU_ON};
        memset(&pool, 0, sizeof pool);
        open_session(&s, &d);
        now_scene = scenes[k];
        for (uint32_t i = first; i < first + count; i++) {
            uint8_t *blob = aligned_alloc(16, (bytes + 15) / 16 * 16);
            uint64_t random = (uint64_t)k << 32 | i;
            assert_non_null(blob);
            memcpy(blob, seed, bytes);
            now_number = i;
            if (i) mutate(blob, bytes, &random); /* number 0 is the scene itself */
            attempt(&s, blob, bytes, &n);
            free(blob);
            if (s.host.messages) fail_msg("%s", s.host.first_message);
        }
        print_message("%-20s %5u mutants: %u refused, %u beyond the device, %u drawn\n", now_scene,
                      count, n.refused, n.too_much, n.drawn);
        if (count > 1) assert_true(n.refused && n.drawn > 1); /* not only number 0 */
        masu_pipelines_destroy(&s.desc.vulkan, &pool);
        close_session(&s);
        free(seed);
    }
    now_scene = NULL;
}

static int say_which(void **state) {
    (void)state;
    if (now_scene) print_message("it was number %u of %s\n", now_number, now_scene);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(mutated_scenes_are_refused_or_drawn, say_which)};
    return cmocka_run_group_tests_name("mutated", tests, NULL, NULL);
}

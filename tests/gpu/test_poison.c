/* test_poison.c: passes are total. Each image and buffer that a pass reads, and that the GPU itself
 * has written, is filled with NaN, infinities, denormals, huge and negative numbers right before
 * the pass, one at a time: the frame's radiance, depth and velocity remain finite, and the image
 * recovers within a few frames.
 *
 * A command buffer is recorded for each case, with a fill at the pass's label. The fill uses a
 * buffer of the test that aliases the memory block, as debug.poison does. Data from the host
 * (uniforms, lists) and loaded data (meshes, materials) is checked on input, so it is not filled.
 * The first elements of lists are not filled either: they are arguments of an indirect dispatch.
 *
 * SwiftShader does not check bounds of buffers: a read outside ends the process, as with a tile
 * number from poisoned memory; a case in reflections still does. lavapipe reads 0 and hides it. */
#include "support/support.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/wrap.h"

#include "device/recordings.h"
#include "renderer.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 40, H = 24, BYTES = W * H * 4, WARM = 6, REST = 64 };

/* As fp32, as two fp16, and as bytes. */
static const struct {
    const char *name;
    uint32_t word;
} words[] = {
    {"NaN", 0x7FC07FC0u},      {"infinity", 0x7F807C00u}, {"minus infinity", 0xFF80FC00u},
    {"denormal", 0x00010001u}, {"huge", 0x7F7F7BFFu},     {"negative and huge", 0xFF7FFBFFu}};
enum { WORDS = sizeof words / sizeof *words };

static masu_session s;
static VkBuffer over;
static VkDeviceSize fill_at, fill_bytes;
static uint32_t fill_word, fills;
static uint32_t size[2] = {W, H};
static uint32_t halves; /* history in half floats, as on devices that do not filter unorm */
static float step_s = 1.0f / 60;
static const char *fill_pass; /* NULL: none */
static PFN_vkCmdFillBuffer fill;
static PFN_vkCmdPipelineBarrier barrier;

static void all_stops(VkCommandBuffer cmd) {
    const VkMemoryBarrier all = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                 .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                 .dstAccessMask =
                                     VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
    barrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &all,
            0, NULL, 0, NULL);
}

static void poison_at_label(VkCommandBuffer cmd, const char *name) {
    if (!fill_pass || strcmp(name, fill_pass)) return;
    all_stops(cmd);
    fill(cmd, over, fill_at, fill_bytes, fill_word);
    all_stops(cmd);
    fills++;
}

static void open_case(const char *scene, const masu_rung *rung) {
    masu_session_desc d = test_desc(scene, size[0], size[1]);
    wrap_reset();
    wrap.on_label = poison_at_label;
    fill_pass = NULL;
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    d.desc.debug.labels = 1;
    d.desc.deny.unorm16 = halves;
    d.desc.resizable = 1; /* the renderer keeps the data for recording again */
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_HDR | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = *rung;
    d.desc.frames_in_flight = 1;
    open_session(&s, &d);
    VkDevice device = s.desc.vulkan.device;
    fill = (PFN_vkCmdFillBuffer)vkGetDeviceProcAddr(device, "vkCmdFillBuffer");
    barrier = (PFN_vkCmdPipelineBarrier)vkGetDeviceProcAddr(device, "vkCmdPipelineBarrier");
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                               .size = s.m->plan.blocks[MASU_ROLE_DEVICE].bytes,
                               .usage = VK_BUFFER_USAGE_TRANSFER_DST_BIT};
    assert_int_equal(vkCreateBuffer(device, &info, NULL, &over), VK_SUCCESS);
    assert_int_equal(vkBindBufferMemory(device, over, s.m->device.memory[MASU_ROLE_DEVICE], 0),
                     VK_SUCCESS);
}

static void close_case(void) {
    masu_headless_settle(&s.host);
    vkDestroyBuffer(s.desc.vulkan.device, over, NULL);
    close_session(&s);
    wrap_reset();
}

static void record_again(const char *pass, uint32_t resource, uint32_t word) {
    masu_detail detail;
    fill_pass = pass;
    if (pass && masu_is_buffer(resource)) {
        const masu_buffer_plan *b = &s.m->plan.buffers[resource - MASU_RESOURCE(0)];
        uint32_t skip = b->usage & VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT ? 16 : 0;
        fill_at = b->offset + skip;
        fill_bytes = (b->bytes - skip) & ~(uint64_t)3;
    } else if (pass) {
        const masu_image_plan *i = &s.m->plan.images[resource];
        fill_at = i->offset;
        fill_bytes = i->bytes & ~(uint64_t)3;
    }
    fill_word = word;
    assert_int_equal(masu_record_again(&s.m->device, &s.m->draws, 0, &detail), MASU_OK);
}

static const char *name_of(uint32_t resource) {
    return masu_is_buffer(resource) ? s.m->plan.buffers[resource - MASU_RESOURCE(0)].name
                                    : masu_images[resource].name;
}

static void check_halves(const masu_readback_image *image, const char *what) {
    for (uint32_t y = 0; y < image->height; y++) {
        const uint16_t *row = (const void *)((const uint8_t *)image->pixels + y * image->row_bytes);
        for (uint32_t i = 0; i < 4 * image->width; i++) {
            if ((row[i] & 0x7C00) == 0x7C00)
                fail_msg("%s: pixel %u, %u is %04x", what, i / 4, y, row[i]);
        }
    }
}

/* A frame of a static view. Readback of the filled image itself is skipped. */
static void take(uint8_t *pixels, const char *what, uint32_t poisoned) {
    masu_commands commands;
    masu_readback_image depth, hdr, velocity;
    draw(&s, &(masu_frame_desc){.time_step = step_s}, &commands, pixels);
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_DEPTH, &depth, NULL), MASU_OK);
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_HDR, &hdr, NULL), MASU_OK);
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_VELOCITY, &velocity, NULL),
                     MASU_OK);
    bool image = poisoned && poisoned < MASU_IMAGE_COUNT;
    uint32_t own = image ? masu_images[poisoned].readback : 0;
    for (uint32_t y = 0; y < depth.height && !(own & MASU_READBACK_DEPTH); y++) {
        const float *row = (const void *)((const uint8_t *)depth.pixels + y * depth.row_bytes);
        for (uint32_t x = 0; x < depth.width; x++) {
            if (!(row[x] >= 0.0f && row[x] <= 1.0f))
                fail_msg("%s: depth of pixel %u, %u is %g", what, x, y, (double)row[x]);
        }
    }
    if (!(own & MASU_READBACK_HDR)) check_halves(&hdr, what);
    if (!(own & MASU_READBACK_VELOCITY)) check_halves(&velocity, what);
}

/* The GPU's data, except a depth attachment, whose bits the driver may have packed, and the shadow
 * faces of lights, which keep their content until a light or a caster moves. */
static bool is_poisoned(uint32_t resource) {
    if (resource == MASU_IMAGE_LOCAL_SHADOW_ATLAS) return false;
    static const uint32_t buffers[] = {MASU_BUFFER_TILES,       MASU_BUFFER_EXPOSURE,
                                       MASU_BUFFER_LIGHT_TILES, MASU_BUFFER_SPECULAR_TILES,
                                       MASU_BUFFER_SMAA_TILES,  MASU_BUFFER_PREVIOUS_VERTICES,
                                       MASU_BUFFER_SEEN};
    if (!masu_is_buffer(resource))
        return resource && resource < MASU_IMAGE_COUNT && s.m->plan.images[resource].bytes;
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
        if (resource == MASU_RESOURCE(buffers[i])) return s.m->plan.buffers[buffers[i]].bytes > 16;
    }
    return false;
}

static bool is_read(uint8_t usage) {
    return usage == MASU_READ || usage == MASU_READ_LINEAR || usage == MASU_READ_BUFFER ||
           usage == MASU_READ_VERTICES || usage == MASU_UPDATE || usage == MASU_PING_PONG;
}

static uint8_t kept[BYTES], now[BYTES];

static uint32_t difference(void) { return max_difference(kept, now, size[0] * size[1] * 4); }

/* Stores the image of the static view; returns how much it differs from itself. Without history it
 * does not flicker, and a few frames are enough. With history, a ray that has hit a lamp is visible
 * for a hundred frames: SwiftShader then tests only that the image remains finite and that no read
 * leaves its buffer. */
static uint32_t settle(bool gathers) {
    if (gathers && is_slow_driver()) {
        for (int i = 0; i < WARM; i++) take(kept, "static view", 0);
        return 255;
    }
    uint32_t steps = 0, rest = gathers ? REST : REST / 8;
    for (int i = 0; i < WARM + (gathers ? 200 : 0); i++) take(kept, "static view", 0);
    for (uint32_t i = 0; i < rest; i++) {
        take(now, "static view", 0);
        uint32_t d = difference();
        steps = d > steps ? d : steps;
    }
    return steps;
}

/* slack: allowed difference beyond that of the static view; heals: frames. Temporal accumulation
 * may start over, as after a cut; everything else is back in the next frame. */
static void poison_each(const char *scene, const masu_rung *rung, uint32_t slack, uint32_t heals) {
    /* In the scene of reflections. */
    static bool done[MASU_PASS_COUNT][MASU_RESOURCE(MASU_BUFFER_COUNT)];
    const bool reflects = strcmp(scene, "test_reflections") == 0;
    uint32_t cases = 0, longest = 0, pairs = 0;
    /* Every third value; only one if hundreds of frames follow, and on drivers after the first;
     * LONG=1 uses all. */
    uint32_t every = long_run() ? 1 : heals > 64 || !whole_run() ? WORDS : 3;
    open_case(scene, rung);
    /* an NVIDIA H200 takes about 16 frames where others take 8 */
    heals *= heals > 1 && on_gpu(&s) ? 3 : 1;
    /* And it has an error of 26 after 24 frames in one case; others are within 24. */
    uint32_t most = settle(heals > 1) + slack + (slack > 8 && on_gpu(&s) ? 8 : 0);
    const masu_rung_plan *rp = &s.m->plan.rungs[0];
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (!masu_has_pass(&rp->active, p) || p == MASU_PASS_READBACK) continue;
        for (uint32_t a = 0; a < rp->access_count[p]; a++) {
            masu_access access = rp->access[p][a];
            if (!is_read(access.usage) || !is_poisoned(access.image)) continue;
            pairs++;
            /* With temporal upscaling this takes longest: on drivers after the first, only the
             * inputs that no other case has. */
            if (reflects && done[p][access.image] && !whole_run()) continue;
            done[p][access.image] |= reflects;
            for (uint32_t w = (pairs + a) % every; w < WORDS; w += every) {
                char what[160];
                uint32_t frames = 0;
                snprintf(what, sizeof what, "%s: %s of %s, which %s reads", scene, words[w].name,
                         name_of(access.image), masu_passes[p].name);
                fills = 0;
                record_again(masu_passes[p].name, access.image, words[w].word);
                if (!fills) fail_msg("%s: nothing was filled", what);
                take(now, what, access.image);
                cases++;
                record_again(NULL, 0, 0);
                do take(now, what, 0);
                while (++frames < heals && difference() > most);
                if (difference() > most)
                    fail_msg("%s: after %u frames a byte still has an error of %u, at most %u",
                             what, frames, difference(), most);
                longest = frames > longest ? frames : longest;
            }
        }
    }
    assert_true(pairs > 3);
    printf("  %s: %u inputs of passes, %u poisoned frames, healed within %u frames\n", scene, pairs,
           cases, longest);
    close_case();
}

static void inputs_of_temporal_passes(void **state) {
    (void)state;
    /* `found` can contain light that a frame could have stored: it decays by one in 31 per frame,
     * and a dark pixel shows a thousandth of the difference. */
    poison_each("test_velocity", &(masu_rung){.scale = 0.7f, .temporal = MASU_ON}, 2, 256);
    halves = 1; /* half floats can hold NaN, unorm cannot */
    poison_each("test_velocity", &(masu_rung){.scale = 0.7f, .temporal = MASU_ON}, 2, 256);
    halves = 0;
}

/* More parts than bits: tiles have lists of part numbers. A step evaluates up to 300 parts, so the
 * image is small. */
static void inputs_of_lists_of_parts(void **state) {
    (void)state;
    size[0] = W / 2, size[1] = H / 2;
    poison_each("parts300", &(masu_rung){.scale = 1.0f, .march_steps = 16}, 0, 1);
    size[0] = W, size[1] = H;
}

static void inputs_of_upscaling_and_smaa(void **state) {
    (void)state;
    poison_each("test_both", &(masu_rung){.scale = 0.7f, .aa = MASU_AA_SMAA_HIGH}, 0, 1);
}

static void inputs_of_shadows_and_occlusion(void **state) {
    (void)state;
    poison_each("test_shadows", &(masu_rung){.scale = 1.0f, .aa = MASU_AA_FXAA}, 0, 1);
}

static void inputs_of_reflections(void **state) {
    (void)state;
    poison_each("test_reflections", &(masu_rung){.scale = 1.0f}, 24, 8);
}

/* Including their velocities, for a rung with temporal upscaling. */
static void inputs_of_reflections_with_a_past(void **state) {
    (void)state;
    poison_each("test_reflections", &(masu_rung){.scale = 0.7f, .temporal = MASU_ON}, 24, 256);
}

static void inputs_of_the_meter(void **state) {
    (void)state;
    step_s = 0.1f; /* it adapts over time, from any value in its range */
    poison_each("test_exposure", &(masu_rung){.scale = 1.0f}, 2, 64);
    step_s = 1.0f / 60;
}

static void inputs_of_lights(void **state) {
    (void)state;
    poison_each("night", &(masu_rung){.scale = 1.0f}, 0, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inputs_of_lists_of_parts),
        cmocka_unit_test(inputs_of_temporal_passes),
        cmocka_unit_test(inputs_of_reflections),
        cmocka_unit_test(inputs_of_reflections_with_a_past),
        cmocka_unit_test(inputs_of_upscaling_and_smaa),
        cmocka_unit_test(inputs_of_shadows_and_occlusion),
        cmocka_unit_test(inputs_of_the_meter),
        cmocka_unit_test(inputs_of_lights),
    };
    return cmocka_run_group_tests_name("poison", tests, NULL, NULL);
}

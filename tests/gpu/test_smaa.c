/* test_smaa.c: SMAA and FXAA on the GPU against the scalar implementation in
 * tests/reference/smaa.c, through the library's own frame: images that are hard in different ways,
 * all settings, with a scene and without; nothing changes away from edges; the cost of an image
 * without edges; invalid pixels. */
#include "support/support.h"
#include "support/wrap.h"

#include "reference/patterns.h"
#include "reference/smaa.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST ((size_t)160 * 120)
#define PRESETS 4
enum { WAYS = 5 }; /* FXAA and the presets: the maximum number of rungs */

static masu_session s; /* a device without a renderer; each job creates one */

static int open_group(void **state) {
    (void)state;
    open_device(&s);
    return 0;
}

static int close_group(void **state) {
    (void)state;
    close_session(&s);
    return 0;
}

/* ---- Running --------------------------------------------------------------------------------- */

/* One frame of a source image for each rung, into out[rung]; returns the number of tiles that each
 * has blended. */
static void run_view(VkImageView view, uint32_t width, uint32_t height, const masu_rung *rungs,
                     uint32_t count, uint32_t out_width, uint32_t out_height, uint8_t *const *out,
                     uint64_t *tiles) {
    masu_stats_info stats[WAYS];
    masu_desc d = s.desc;
    d.output = (VkExtent2D){out_width, out_height};
    d.source = (masu_source){.view = view, .width = width, .height = height};
    d.rung_count = count;
    memcpy(d.rungs, rungs, count * sizeof *rungs);
    d.debug.counters = 1;
    d.debug.poison = 1;
    draw_rungs_of(&s, &d, out, stats);
    for (uint32_t r = 0; r < count && tiles; r++) tiles[r] = stats[r].smaa_tiles;
}

/* The same for pixels in the corner of a larger image full of `beyond`. */
static void run_to(const uint8_t *rgba, uint32_t width, uint32_t height, uint32_t beyond,
                   const masu_rung *rungs, uint32_t count, uint32_t out_width, uint32_t out_height,
                   uint8_t *const *out, uint64_t *tiles) {
    char error[ERROR_SIZE];
    masu_headless_source source;
    assert_ok(masu_headless_source_create(&s.host, rgba, width, height, width + 9, height + 5,
                                          beyond, &source, error, sizeof error));
    run_view(source.view, width, height, rungs, count, out_width, out_height, out, tiles);
    masu_headless_source_destroy(&s.host, &source);
}

/* Returns the number of tiles. */
static uint64_t run(const uint8_t *rgba, uint32_t width, uint32_t height, masu_aa aa,
                    uint8_t *out) {
    masu_rung rung = {.aa = aa};
    uint64_t tiles;
    run_to(rgba, width, height, 0xFF00FFFFu, &rung, 1, width, height, &out, &tiles);
    return tiles;
}

/* All methods: FXAA, then SMAA from LOW to ULTRA. */
static const masu_rung ways[WAYS] = {{.aa = MASU_AA_FXAA},
                                     {.aa = MASU_AA_SMAA_LOW},
                                     {.aa = MASU_AA_SMAA_MEDIUM},
                                     {.aa = MASU_AA_SMAA_HIGH},
                                     {.aa = MASU_AA_SMAA_ULTRA}};
static uint8_t by_way[WAYS][4 * MOST], by_way_too[WAYS][4 * MOST];
static uint8_t *const all_ways[WAYS] = {by_way[0], by_way[1], by_way[2], by_way[3], by_way[4]};
static uint8_t *const all_ways_too[WAYS] = {by_way_too[0], by_way_too[1], by_way_too[2],
                                            by_way_too[3], by_way_too[4]};

/* ---- Images ---------------------------------------------------------------------------------- */

static void set_grey(uint8_t *rgba, size_t i, int v) {
    memset(rgba + 4 * i, v < 0 ? 0 : v > 255 ? 255 : v, 3);
    rgba[4 * i + 3] = 255;
}

/* Lines of one pixel at 24 angles, and half-planes: one side of a line through the centre. */
static void fill_fan(uint32_t width, uint32_t height, uint8_t *rgba) {
    for (uint32_t i = 0; i < width * height; i++) set_grey(rgba, i, 230);
    double cx = 0.5 * (double)width, cy = 0.5 * (double)height;
    for (int k = 0; k < 24; k++) {
        double angle = 3.14159265 * 2 * (k + 0.3) / 24;
        for (double r = 6; r < 0.48 * (double)height; r += 0.25) {
            uint32_t x = (uint32_t)(cx + r * cos(angle)), y = (uint32_t)(cy + r * sin(angle));
            set_grey(rgba, (size_t)y * width + x, 20);
        }
    }
}

static void fill_halves(uint32_t width, uint32_t height, uint8_t *rgba) {
    for (uint32_t i = 0; i < width * height; i++) {
        double x = i % width, y = i / width, band = floor(y / 24), slope = 0.02 + 0.19 * band;
        double edge = 24 * band + 4 + slope * fmod(x, 80);
        set_grey(rgba, i, y > edge ? 40 + 30 * (int)band : 240);
    }
}

/* Squares of one pixel in the left half, of five in the right one. */
static void fill_checker(uint32_t width, uint32_t height, uint8_t *rgba) {
    for (uint32_t i = 0; i < width * height; i++) {
        uint32_t x = i % width, y = i / width, side = x < width / 2 ? 1 : 5;
        set_grey(rgba, i, (x / side + y / side) % 2 ? 255 : 0);
    }
}

/* Stairs at 45 degrees of both directions, and boxes with corners. */
static void fill_stairs(uint32_t width, uint32_t height, uint8_t *rgba) {
    for (uint32_t i = 0; i < width * height; i++) {
        uint32_t x = i % width, y = i / width, u = x % 40, v = y % 40;
        int diamond = abs((int)u - 20) + abs((int)v - 20)<14, box = u> 33 && v > 30;
        set_grey(rgba, i, diamond ? 200 : box ? 128 : (x + y) / 40 % 2 ? 20 : 60);
    }
}

/* Edges that leave the image on all sides. */
static void fill_crossing(uint32_t width, uint32_t height, uint8_t *rgba) {
    for (uint32_t i = 0; i < width * height; i++) {
        uint32_t x = i % width, y = i / width;
        int wide = y > height / 3 + x / 60, high = x > width / 2 + y / 50;
        set_grey(rgba, i, 60 + 100 * wide + 70 * high);
    }
}

enum { FAN = MASU_PATTERN_COUNT, HALVES, CHECKER, STAIRS, CROSSING, PICTURES };

static const char *picture_name(uint32_t picture) {
    static const char *const names[] = {"fan", "halves", "checker", "stairs", "crossing"};
    return picture < FAN ? masu_pattern_name((enum masu_pattern)picture) : names[picture - FAN];
}

static void fill(uint32_t picture, uint32_t width, uint32_t height, uint8_t *rgba) {
    if (picture < FAN)
        masu_pattern_fill((enum masu_pattern)picture, 7, width, height, rgba);
    else if (picture == FAN)
        fill_fan(width, height, rgba);
    else if (picture == HALVES)
        fill_halves(width, height, rgba);
    else if (picture == CHECKER)
        fill_checker(width, height, rgba);
    else if (picture == STAIRS)
        fill_stairs(width, height, rgba);
    else
        fill_crossing(width, height, rgba);
}

/* ---- The reference --------------------------------------------------------------------------- */

static uint8_t ref_edges[2 * MOST], ref_weights[4 * MOST];

/* Keeps edges and weights. */
static void reference_smaa(const uint8_t *rgba, uint32_t width, uint32_t height, int preset,
                           uint8_t *out) {
    static float rgb[3 * MOST], result[3 * MOST];
    struct masu_ref_image in = {rgb, width, height, 0};
    struct masu_ref_smaa with = masu_ref_smaa_preset(preset);
    masu_ref_from_rgba8(rgba, width, height, 0, rgb);
    masu_ref_smaa_edges(&in, &with, ref_edges);
    masu_ref_smaa_weights(ref_edges, width, height, &with, ref_weights);
    masu_ref_smaa_blend(&in, ref_weights, result);
    masu_ref_to_rgba8(result, width, height, out);
}

/* Whether the pixel has no weight, and uses none from the right or from below. */
static int is_away(uint32_t i, uint32_t width, uint32_t height) {
    uint32_t x = i % width, y = i / width;
    const uint8_t *own = ref_weights + 4 * i;
    const uint8_t *right = own + (x + 1 < width ? 4 : 0),
                  *below = own + (y + 1 < height ? 4 * width : 0);
    return !(own[0] | own[2] | right[3] | below[1]);
}

/* rounded_before: steps by which an unblended pixel may differ. */
static uint32_t compare(const uint8_t *in, const uint8_t *gpu, const uint8_t *cpu, uint32_t width,
                        uint32_t height, uint32_t rounded_before) {
    uint32_t worst = 0;
    for (uint32_t i = 0; i < width * height; i++) {
        uint32_t d = max_difference(gpu + 4 * i, cpu + 4 * i, 4);
        if (d > worst) worst = d;
        if (is_away(i, width, height))
            assert_true(max_difference(gpu + 4 * i, in + 4 * i, 4) <= rounded_before);
    }
    return worst;
}

static const masu_aa presets[PRESETS] = {MASU_AA_SMAA_LOW, MASU_AA_SMAA_MEDIUM, MASU_AA_SMAA_HIGH,
                                         MASU_AA_SMAA_ULTRA};

/* FXAA has no weights that show unchanged pixels. */
static void check_fxaa(uint32_t picture, const uint8_t *in, uint32_t width, uint32_t height) {
    static float rgb[3 * MOST], result[3 * MOST];
    static uint8_t cpu[4 * MOST];
    uint32_t changed = 0;
    struct masu_ref_image image = {rgb, width, height, 0};
    masu_ref_from_rgba8(in, width, height, 0, rgb);
    masu_ref_fxaa(&image, result);
    masu_ref_to_rgba8(result, width, height, cpu);
    for (uint32_t i = 0; i < width * height; i++)
        changed += max_difference(by_way[0] + 4 * i, in + 4 * i, 4) > 0;
    uint32_t worst = max_difference(by_way[0], cpu, (size_t)4 * width * height);
    print_message("  %-12s %6u pixels blurred, worst %u/255\n", picture_name(picture), changed,
                  worst);
    assert_true(worst <= 2);
    assert_true((changed > 0) == (picture != MASU_PATTERN_RAMP && picture != MASU_PATTERN_FLAT));
}

static void both_are_the_scalar_reference_within_two_steps(void **state) {
    (void)state;
    static uint8_t in[4 * MOST], cpu[4 * MOST];
    for (uint32_t picture = 0; picture < PICTURES; picture++) {
        uint32_t worst[PRESETS], changed = 0, width = picture % 2 ? 147 : 160, height = 101;
        fill(picture, width, height, in);
        run_to(in, width, height, 0xFF00FFFFu, ways, WAYS, width, height, all_ways, NULL);
        for (uint32_t p = 0; p < PRESETS; p++) {
            reference_smaa(in, width, height, (int)p, cpu);
            worst[p] = compare(in, by_way[1 + p], cpu, width, height, 0);
            for (uint32_t i = 0; i < width * height; i++) changed += !is_away(i, width, height);
        }
        print_message("  %-12s %6u pixels blended, worst %u %u %u %u/255\n", picture_name(picture),
                      changed, worst[0], worst[1], worst[2], worst[3]);
        for (uint32_t p = 0; p < PRESETS; p++) assert_true(worst[p] <= 2);
        /* Every image is a test: all except the smooth ones have pixels to blend. */
        assert_true((changed > 0) ==
                    (picture != MASU_PATTERN_RAMP && picture != MASU_PATTERN_FLAT));
        check_fxaa(picture, in, width, height);
    }
}

static void sizes_that_no_tile_divides_are_right_to_the_last_pixel(void **state) {
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1},   {1, 40},  {40, 1}, {15, 17},
                                        {16, 16}, {17, 33}, {2, 2}};
    static uint8_t in[4 * MOST], gpu[4 * MOST], cpu[4 * MOST];
    for (uint32_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        uint32_t width = sizes[i][0], height = sizes[i][1];
        masu_pattern_fill(MASU_PATTERN_BINARY_NOISE, 3 + i, width, height, in);
        run(in, width, height, MASU_AA_SMAA_ULTRA, gpu);
        reference_smaa(in, width, height, 3, cpu);
        assert_true(compare(in, gpu, cpu, width, height, 0) <= 2);
    }
}

/* ---- Cost ------------------------------------------------------------------------------------ */

static void a_picture_without_edges_has_no_tile(void **state) {
    (void)state;
    static uint8_t in[4 * MOST], gpu[4 * MOST];
    for (uint32_t k = 0; k < 3; k++) {
        for (uint32_t i = 0; i < 160 * 100;
             i++) { /* flat; steps just below the threshold of ULTRA */
            uint32_t step = (k == 1 ? i % 160 : i / 160) / 8;
            set_grey(in, i, k == 0 ? 77 : (int)(step * 12));
        }
        assert_int_equal(run(in, 160, 100, MASU_AA_SMAA_ULTRA, gpu), 0);
        assert_memory_equal(gpu, in, 160 * 100 * 4);
    }
}

/* A dot has edges in its own tile, and in those to the right and below if it touches them; it
 * changes its neighbours, which may be in tiles to the left and above. */
static void only_tiles_at_edges_are_blended(void **state) {
    (void)state;
    static const uint32_t dots[][3] = {{40, 40, 1}, {47, 40, 2}, {48, 40, 2}, {40, 32, 2},
                                       {47, 47, 3}, {0, 0, 1},   {79, 79, 1}};
    static uint8_t in[4 * MOST], gpu[4 * MOST];
    for (uint32_t k = 0; k < sizeof dots / sizeof *dots; k++) {
        for (uint32_t i = 0; i < 80 * 80; i++) set_grey(in, i, 30);
        set_grey(in, dots[k][1] * 80 + dots[k][0], 220);
        assert_int_equal(run(in, 80, 80, MASU_AA_SMAA_HIGH, gpu), dots[k][2]);
    }
}

/* ---- Surroundings of the image --------------------------------------------------------------- */

static void what_lies_beyond_the_valid_rectangle_is_never_read(void **state) {
    (void)state;
    static uint8_t in[4 * MOST];
    fill(CROSSING, 50, 37, in);
    run_to(in, 50, 37, 0x00000000u, ways, WAYS, 50, 37, all_ways, NULL);
    run_to(in, 50, 37, 0xFFFFFFFFu, ways, WAYS, 50, 37, all_ways_too, NULL);
    for (uint32_t k = 0; k < WAYS; k++) assert_memory_equal(by_way[k], by_way_too[k], 50 * 37 * 4);
}

static void the_chain_is_smaa_then_easu_then_rcas(void **state) {
    (void)state;
    enum { WIDTH = 75, HEIGHT = 50, PIXELS = WIDTH * HEIGHT };
    static uint8_t in[4 * PIXELS], cpu[16 * PIXELS], gpu[16 * PIXELS];
    static float rgb[3 * PIXELS], smooth[3 * PIXELS], upscaled[12 * PIXELS], result[12 * PIXELS];
    uint8_t *const to = gpu;
    masu_rung rung = {.aa = MASU_AA_SMAA_HIGH, .sharpness = 0.2f};
    struct masu_ref_smaa with = masu_ref_smaa_preset(2);
    struct masu_ref_image of = {rgb, WIDTH, HEIGHT, 0}, small = {smooth, WIDTH, HEIGHT, 0},
                          large = {upscaled, 2 * WIDTH, 2 * HEIGHT, 0};
    fill(MASU_PATTERN_PHOTO, WIDTH, HEIGHT, in);
    masu_ref_from_rgba8(in, WIDTH, HEIGHT, 0, rgb);
    masu_ref_smaa_edges(&of, &with, ref_edges);
    masu_ref_smaa_weights(ref_edges, WIDTH, HEIGHT, &with, ref_weights);
    masu_ref_smaa_blend(&of, ref_weights, smooth);
    masu_ref_to_ten(smooth, 3 * PIXELS);
    masu_ref_easu(&small, 2 * WIDTH, 2 * HEIGHT, MASU_REF_BIT_TRICK, upscaled);
    masu_ref_to_ten(upscaled, 12 * PIXELS);
    masu_ref_rcas(&large, exp2f(-0.2f), result);
    masu_ref_to_rgba8(result, 2 * WIDTH, 2 * HEIGHT, cpu);
    s.desc.debug.exact = 1;
    run_to(in, WIDTH, HEIGHT, 0, &rung, 1, 2 * WIDTH, 2 * HEIGHT, &to, NULL);
    s.desc.debug.exact = 0;
    uint32_t off = 0;
    for (uint32_t i = 0; i < 16 * PIXELS; i++) off += abs(gpu[i] - cpu[i]) > 1;
    print_message("  %u of %u numbers with an error over 1/255\n", off, 12 * PIXELS);
    assert_true(off <= PIXELS / 100); /* a step in the source image can flip an edge */
}

/* ---- Invalid pixels -------------------------------------------------------------------------- */

typedef struct float_source {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
} float_source;

static uint32_t host_type(uint32_t bits) {
    VkMemoryPropertyFlags wanted =
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (uint32_t i = 0; i < s.host.memory.memoryTypeCount; i++) {
        if (bits >> i & 1u && (s.host.memory.memoryTypes[i].propertyFlags & wanted) == wanted)
            return i;
    }
    fail_msg("no memory that the host can write");
    return 0;
}

/* fp32, linear in memory, written by the host. */
static void make_float_source(const float *rgba, uint32_t width, uint32_t height,
                              float_source *out) {
    char error[ERROR_SIZE];
    VkDevice device = s.host.device;
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                              .extent = {width, height, 1},
                              .mipLevels = 1,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .tiling = VK_IMAGE_TILING_LINEAR,
                              .usage = VK_IMAGE_USAGE_SAMPLED_BIT,
                              .initialLayout = VK_IMAGE_LAYOUT_PREINITIALIZED};
    assert_int_equal(vkCreateImage(device, &info, NULL, &out->image), VK_SUCCESS);
    VkMemoryRequirements need;
    vkGetImageMemoryRequirements(device, out->image, &need);
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = need.size,
                                     .memoryTypeIndex = host_type(need.memoryTypeBits)};
    assert_int_equal(vkAllocateMemory(device, &allocate, NULL, &out->memory), VK_SUCCESS);
    assert_int_equal(vkBindImageMemory(device, out->image, out->memory, 0), VK_SUCCESS);
    VkImageSubresource part = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0};
    VkSubresourceLayout layout;
    vkGetImageSubresourceLayout(device, out->image, &part, &layout);
    void *mapped;
    assert_int_equal(vkMapMemory(device, out->memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
    for (uint32_t y = 0; y < height; y++) {
        memcpy((uint8_t *)mapped + layout.offset + y * layout.rowPitch,
               rgba + (size_t)4 * width * y, (size_t)16 * width);
    }
    vkUnmapMemory(device, out->memory);
    VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                  .image = out->image,
                                  .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                  .format = info.format,
                                  .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    assert_int_equal(vkCreateImageView(device, &view, NULL, &out->view), VK_SUCCESS);
    VkCommandBufferAllocateInfo buffer = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                          .commandPool = s.host.pool,
                                          .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                          .commandBufferCount = 1};
    VkCommandBuffer commands;
    assert_int_equal(vkAllocateCommandBuffers(device, &buffer, &commands), VK_SUCCESS);
    VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    assert_int_equal(vkBeginCommandBuffer(commands, &begin), VK_SUCCESS);
    VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .srcAccessMask = VK_ACCESS_HOST_WRITE_BIT,
                                    .dstAccessMask = VK_ACCESS_SHADER_READ_BIT,
                                    .oldLayout = VK_IMAGE_LAYOUT_PREINITIALIZED,
                                    .newLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = out->image,
                                    .subresourceRange = view.subresourceRange};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_HOST_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                         0, 0, NULL, 0, NULL, 1, &barrier);
    assert_int_equal(vkEndCommandBuffer(commands), VK_SUCCESS);
    assert_ok(masu_headless_run(&s.host, commands, error, sizeof error));
}

static void free_float_source(float_source *f) {
    vkDestroyImageView(s.host.device, f->view, NULL);
    vkDestroyImage(s.host.device, f->image, NULL);
    vkFreeMemory(s.host.device, f->memory, NULL);
}

/* Each invalid pixel acts like a black or a white one: it changes no pixels that such a pixel
 * would not change. */
static void broken_pixels_are_black_or_white_ones(void **state) {
    (void)state;
    enum { WIDTH = 48, HEIGHT = 40 };
    static const struct {
        uint32_t bits, stands_for;
    } bad[] = {{0x7FC00000u, 0}, {0x7F800000u, 0},   {0xFF800000u, 0},  {0xBF800000u, 0},
               {0x00000001u, 0}, {0x501502F9u, 255}, {0x7F7FFFFFu, 255}};
    static uint8_t in[WIDTH * HEIGHT * 4];
    static float pixels[WIDTH * HEIGHT * 4];
    fill(HALVES, WIDTH, HEIGHT, in);
    for (uint32_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        uint32_t at = (7 + 3 * k) * WIDTH + 5 + 5 * k;
        for (uint32_t i = 0; i < WIDTH * HEIGHT * 4; i++) pixels[i] = (float)in[i] / 255.0f;
        for (uint32_t c = 0; c < 3; c++) memcpy(&pixels[4 * at + c], &bad[k].bits, 4);
        uint8_t good[4], stands[4] = {0, 0, 0, 255};
        memset(stands, (int)bad[k].stands_for, 3);
        memcpy(good, in + 4 * at, 4);
        memcpy(in + 4 * at, stands, 4);
        float_source source;
        make_float_source(pixels, WIDTH, HEIGHT, &source);
        run_view(source.view, WIDTH, HEIGHT, ways, WAYS, WIDTH, HEIGHT, all_ways, NULL);
        run_to(in, WIDTH, HEIGHT, 0, ways, WAYS, WIDTH, HEIGHT, all_ways_too, NULL);
        for (uint32_t w = 0; w < WAYS; w++)
            assert_true(max_difference(by_way[w], by_way_too[w], sizeof in) <= 1);
        free_float_source(&source);
        memcpy(in + 4 * at, good, 4);
    }
}

/* ---- With a scene ---------------------------------------------------------------------------- */

/* The reference starts from the scene's image without anti-aliasing. Targets that are rendered to,
 * and targets that are blitted to; with poison in all images before each frame. */
static void a_scene_is_smoothed_as_its_picture_is(void **state) {
    (void)state;
    enum { WIDTH = 150, HEIGHT = 90 };
    static uint8_t plain[WIDTH * HEIGHT * 4], gpu[WIDTH * HEIGHT * 4], cpu[WIDTH * HEIGHT * 4];
    static masu_session scene;
    for (uint32_t storage = 0; storage < 2; storage++) {
        masu_session_desc d = test_desc("test_both", WIDTH, HEIGHT);
        d.desc.targets.storage = storage;
        d.desc.dither = MASU_OFF; /* the reference has none */
        d.desc.debug.poison = 1;
        d.desc.rung_count = 5;
        d.desc.rungs[0].aa = MASU_AA_OFF;
        for (uint32_t p = 0; p < PRESETS; p++) d.desc.rungs[1 + p].aa = presets[p];
        open_session(&scene, &d);
        masu_frame_desc frame = {.cut = 1};
        masu_commands commands;
        draw(&scene, &frame, &commands, plain);
        for (uint32_t p = 0; p < PRESETS; p++) {
            masu_stats_info stats;
            frame.rung = 1 + p;
            draw(&scene, &frame, &commands, gpu);
            reference_smaa(plain, WIDTH, HEIGHT, (int)p, cpu);
            assert_int_equal(masu_stats(scene.m, commands.slot, &stats, NULL), MASU_OK);
            assert_true(stats.smaa_tiles > 0 && stats.smaa_tiles <= 60);
            /* The input has 10 bits, the image 8. */
            assert_true(compare(plain, gpu, cpu, WIDTH, HEIGHT, 1) <= 2);
        }
        close_session(&scene);
    }
}

/* A lower rung uses a corner of images that a higher one has filled. */
static void a_smaller_rung_reads_nothing_of_a_larger_one(void **state) {
    (void)state;
    enum { WIDTH = 150, HEIGHT = 90 };
    static uint8_t first[WIDTH * HEIGHT * 4], again[WIDTH * HEIGHT * 4];
    static masu_session scene;
    masu_session_desc d = test_desc("test_both", WIDTH, HEIGHT);
    d.desc.rung_count = 2;
    d.desc.rungs[0] = (masu_rung){.aa = MASU_AA_SMAA_ULTRA};
    d.desc.rungs[1] = (masu_rung){.scale = 0.6f, .aa = MASU_AA_SMAA_ULTRA};
    open_session(&scene, &d);
    draw_rung(&scene, 1, first);
    draw_rung(&scene, 0, NULL);
    draw_rung(&scene, 1, again);
    assert_memory_equal(first, again, sizeof first);
    close_session(&scene);
}

/* ---- Memory ---------------------------------------------------------------------------------- */

/* Without a scene, too, the table has to reach memory that the host cannot write. */
static void a_discrete_device_gets_the_table_through_a_staging_buffer(void **state) {
    (void)state;
    skip_unless_host_sees_all_memory(); /* or the upload already uses one */
    static uint8_t in[4 * MOST], here[4 * MOST], there[4 * MOST];
    fill(MASU_PATTERN_TEXT, 80, 60, in);
    run(in, 80, 60, MASU_AA_SMAA_HIGH, here);
    close_session(&s);
    masu_session_desc d = test_desc(NULL, 8, 8);
    d.no_renderer = true;
    wrap_reset();
    d.host.get_instance_proc_addr = wrap_get_instance_proc_addr;
    wrap.fake_memory = 1;
    open_session(&s, &d);
    assert_true(run(in, 80, 60, MASU_AA_SMAA_HIGH, there) > 0);
    assert_memory_equal(here, there, 80 * 60 * 4);
    close_session(&s);
    wrap_reset();
    open_device(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_are_the_scalar_reference_within_two_steps),
        cmocka_unit_test(sizes_that_no_tile_divides_are_right_to_the_last_pixel),
        cmocka_unit_test(a_picture_without_edges_has_no_tile),
        cmocka_unit_test(only_tiles_at_edges_are_blended),
        cmocka_unit_test(what_lies_beyond_the_valid_rectangle_is_never_read),
        cmocka_unit_test(the_chain_is_smaa_then_easu_then_rcas),
        cmocka_unit_test(a_discrete_device_gets_the_table_through_a_staging_buffer),
        cmocka_unit_test(broken_pixels_are_black_or_white_ones),
        cmocka_unit_test(a_scene_is_smoothed_as_its_picture_is),
        cmocka_unit_test(a_smaller_rung_reads_nothing_of_a_larger_one),
    };
    return cmocka_run_group_tests_name("smaa", tests, open_group, close_group);
}

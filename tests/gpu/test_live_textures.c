/* test_live_textures.c: textures that the host fills at run time, on particles, decals and materials,
 * against a filter in doubles; cells of an atlas; commands of the host that copy into the image;
 * limits. test_trails.c has trails. */
#define LIVE_SCENE "test_texture_quad"
#include "support/live_room.h"

#include <stdlib.h>

/* Mean over a pixel of a texture on a rectangle with the given centre and half axes, all in view
 * space at distance z: colour times alpha, and alpha. Returns whether the pixel is inside. Of a
 * magnified texture the sample at the pixel's centre. */
typedef struct flat {
    double x, y, z, width, height, rotation;
} flat;

static int mean(const flat *f, uint32_t texture, uint32_t side, const float cell[4], uint32_t pixel,
                double out[4]) {
    const double pixel_size = 2 * tan_y * f->z / SIDE,
                 texel_size = 2 * fmin(f->width, f->height) / side;
    const uint32_t steps = texel_size > pixel_size ? 1 : 16;
    double c = cos(f->rotation), n = sin(f->rotation);
    memset(out, 0, 4 * sizeof *out);
    for (uint32_t i = 0; i < steps * steps; i++) {
        double px = pixel % SIDE + (i % steps + 0.5) / steps;
        double py = pixel / SIDE + (i / steps + 0.5) / steps;
        double x = (px / SIDE * 2 - 1) * tan_y * f->z - f->x;
        double y = (1 - py / SIDE * 2) * tan_y * f->z - f->y;
        double u = (c * x + n * y) / f->width, v = (c * y - n * x) / f->height;
        if (fabs(u) > 0.99 || fabs(v) > 0.99) return 0;
        sample(texture, side, cell, 0.5 + 0.5 * u, 0.5 - 0.5 * v, out);
    }
    for (uint32_t k = 0; k < 4; k++) out[k] /= steps * steps;
    return 1;
}

/* ---- Writes and particles -------------------------------------------------------------------- */

static const masu_particle sheet = {.position = {0.1, -0.05, 1},
                                    .half_width = 0.5f,
                                    .half_height = 0.4f,
                                    .rotation = 0.3f,
                                    .color = {2, 1, 0.5f},
                                    .opacity = 0.75f,
                                    .texture = 2};

static flat flat_of(const masu_particle *p) {
    return (flat){p->position[0],
                  p->position[1],
                  camera.position[2] - p->position[2],
                  (double)p->half_width,
                  p->half_height > 0 ? (double)p->half_height : (double)p->half_width,
                  (double)p->rotation};
}

/* Root mean square and largest difference of the picture from a textured particle over `base`. */
static double compare(const masu_particle *p, uint32_t side, double *worst) {
    static const float whole[4] = {0, 0, 1, 1};
    const flat f = flat_of(p);
    const float *cell = p->uv[2] > 0 || p->uv[0] > 0 ? p->uv : whole;
    double square = 0;
    uint32_t count = 0;
    *worst = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double t[4];
        if (!mean(&f, p->texture, side, cell, i, t)) continue;
        for (uint32_t k = 0; k < 3; k++) {
            double o = (double)p->opacity;
            double want = (double)p->color[k] * t[k] * o + (1 - t[3] * o) * (double)base[4 * i + k];
            double off = fabs(want - (double)picture[4 * i + k]);
            *worst = fmax(*worst, off);
            square += off * off;
            count++;
        }
    }
    assert_true(count > 60);
    return sqrt(square / count);
}

static void texels_are_shown_by_the_next_frame_and_stay(void **state) {
    (void)state;
    masu_frame_desc frame = {.particles = &sheet, .particle_count = 1};
    double worst;
    open_room(TEXELS);
    render((masu_frame_desc){0}, base);
    render(frame, picture);
    assert_memory_equal(picture, base, sizeof base); /* transparent until something is written */
    fill(2, TEXELS, 4, 100, 1);
    write_whole(2);
    for (uint32_t n = 0; n < 3; n++) { /* in either slot */
        render(frame, picture);
        compare(&sheet, TEXELS, &worst);
        print_message("frame %u: off by %.4f at most\n", n, worst);
        assert_true(worst < 0.02);
    }
    /* Part of it, with gaps between rows; of overlapping ones the later. */
    static uint8_t part[2][4 * 10 * 24];
    for (uint32_t w = 0; w < 2; w++) {
        const VkRect2D r = {{2 + 3 * (int)w, 1 + 4 * (int)w}, {9, 8}};
        for (uint32_t i = 0; i < sizeof part[w]; i++) part[w][i] = (uint8_t)(40 + 90 * w + i % 100);
        assert_int_equal(masu_texture_write(s.m, 2, &r, part[w], 4 * 24, &failure), MASU_OK);
        for (uint32_t y = 0; y < 8; y++)
            memcpy(&texels[1][4 * ((y + 1 + 4 * w) * TEXELS + 2 + 3 * w)], part[w] + 4 * 24 * y,
                   4 * 9);
    }
    for (uint32_t n = 0; n < 3; n++) {
        render(frame, picture);
        compare(&sheet, TEXELS, &worst);
        assert_true(worst < 0.02);
    }
    close_session(&s);
}

/* Up to four texels per pixel; then the error grows. */
static void small_ones_do_not_alias(void **state) {
    (void)state;
    enum { LARGE = 64 };
    static const float across[] = {0.5f, 1, 2, 3, 4, 8};
    static const double most[] = {0.005, 0.05, 0.02, 0.012, 0.01, 0.04};
    open_room(LARGE);
    render((masu_frame_desc){0}, base);
    fill(1, LARGE, 1, 30, 2);
    write_whole(1);
    for (uint32_t i = 0; i < sizeof across / sizeof *across; i++) {
        double worst;
        masu_particle p = {.position = {0, 0, 1},
                           .rotation = 0.4f,
                           .color = {1, 1, 1},
                           .opacity = 1,
                           .texture = 1};
        p.half_width = (float)(LARGE / (double)across[i] / SIDE * tan_y * 2);
        masu_frame_desc frame = {.particles = &p, .particle_count = 1};
        render(frame, picture);
        double off = compare(&p, LARGE, &worst);
        print_message("%g texels per pixel: rms error %.4f\n", (double)across[i], off);
        assert_true(off < most[i]);
    }
    close_session(&s);
}

static uint32_t texel_block(uint32_t i) {
    return (i % TEXELS >= TEXELS / 2) + 2 * (i / TEXELS >= TEXELS / 2);
}

static void cells_of_an_atlas_do_not_bleed(void **state) {
    (void)state;
    static const uint8_t colors[4][4] = {
        {255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {255, 255, 255, 255}};
    open_room(TEXELS);
    for (uint32_t i = 0; i < TEXELS * TEXELS; i++)
        memcpy(&texels[0][4 * i], colors[texel_block(i)], 4);
    write_whole(1);
    for (uint32_t cell = 0; cell < 3; cell++) {
        for (uint32_t size = 0; size < 5; size++) {
            float u = cell % 2 * 0.5f, v = cell / 2 * 0.5f;
            masu_particle p = {.position = {0.01, 0.02, 1},
                               .half_width = 0.6f / (float)(1u << size),
                               .rotation = 0.1f,
                               .color = {1, 1, 1},
                               .opacity = 1,
                               .texture = 1,
                               .uv = {u, v, u + 0.5f, v + 0.5f}};
            if (size % 2) p.uv[0] = u + 0.5f, p.uv[2] = u; /* mirrored */
            masu_frame_desc frame = {.particles = &p, .particle_count = 1};
            render((masu_frame_desc){0}, base);
            render(frame, picture);
            uint32_t covered = 0;
            for (uint32_t i = 0; i < PIXELS; i++) {
                if (!memcmp(&picture[4 * i], &base[4 * i], 12)) continue;
                covered++;
                for (uint32_t k = 0; k < 3; k++)
                    assert_true(fabsf(picture[4 * i + k] - (k == cell ? 1 : 0)) < 1e-3f);
            }
            assert_true(covered >= 4);
        }
    }
    /* Red, a quarter of it blue. */
    masu_particle p = {.position = {0, 0, 1},
                       .half_width = 0.5f,
                       .color = {1, 1, 1},
                       .opacity = 1,
                       .texture = 1,
                       .uv = {0, 0, 0.5f, 0.5f},
                       .uv_next = {0, 0.5f},
                       .blend = 0.25f};
    masu_frame_desc frame = {.particles = &p, .particle_count = 1};
    render(frame, picture);
    const float *center = &picture[4 * (SIDE / 2 * SIDE + SIDE / 2)];
    assert_true(fabsf(center[0] - 0.75f) < 2e-3f && center[1] < 1e-3f &&
                fabsf(center[2] - 0.25f) < 2e-3f);
    close_session(&s);
}

/* ---- Decals and materials -------------------------------------------------------------------- */

/* How far the square roots of albedo are off at most; f: where the texture is. */
static double albedo_off(const flat *f, uint32_t texture, uint32_t side, const float cell[4],
                         double opacity, const uint8_t *before, const uint8_t *after) {
    double worst = 0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double t[4];
        if (!mean(f, texture, side, cell, i, t)) continue;
        for (uint32_t k = 0; k < 3; k++) {
            double was = pow(before[4 * i + k] / 255.0, 2);
            double want = sqrt(t[k] * opacity + (1 - t[3] * opacity) * was);
            worst = fmax(worst, fabs(want - after[4 * i + k] / 255.0));
        }
        count++;
    }
    assert_true(count > 300);
    return worst;
}

static void a_decal_has_colour_and_alpha_of_its_cell(void **state) {
    (void)state;
    static uint8_t before[4 * PIXELS], after[4 * PIXELS];
    open_room(TEXELS);
    fill(3, TEXELS, 2, 0, 3);
    write_whole(3);
    render_albedo((masu_frame_desc){0}, before);
    for (uint32_t form = 0; form < 4; form++) {
        const float turn = form == 1 ? 0.7f : 0;
        const float c = 0.6f * cosf(turn), n = 0.6f * sinf(turn);
        masu_decal d = {.rows = {c, -n, 0, 0.1f, n, c, 0, -0.1f, 0, 0, 1, 0},
                        .color = {1, 1, 1},
                        .opacity = form == 3 ? 0.5f : 1,
                        .metallic = -1,
                        .texture = 3,
                        .uv = {0, 0, 1, 1}};
        if (form == 2) memcpy(d.uv, (float[4]){0.75f, 0.25f, 0.25f, 1}, sizeof d.uv);
        const flat f = {0.1, -0.1, 3, 0.6, 0.6, (double)turn};
        render_albedo((masu_frame_desc){.decals = &d, .decal_count = 1}, after);
        double worst = albedo_off(&f, 3, TEXELS, d.uv, (double)d.opacity, before, after);
        print_message("form %u: off by %.1f of 255 at most\n", form, 255 * worst);
        assert_true(worst < 4.0 / 255);
    }
    close_session(&s);
}

/* Paint that glows in the dark: half of it, on a square that does not emit. */
static void a_decal_emits_the_colour_of_its_cell(void **state) {
    (void)state;
    static const float whole[4] = {0, 0, 1, 1};
    const masu_light dark = {.exposure = 1, .sun_direction = {0, 0, 1}};
    const flat f = {0, 0, 3, 0.8, 0.8, 0};
    open_room(TEXELS);
    fill(2, TEXELS, 2, 255, 7);
    write_whole(2);
    masu_decal d = {.rows = {0.8f, 0, 0, 0, 0, 0.8f, 0, 0, 0, 0, 1, 0},
                    .color = {1, 0.5f, 0.25f},
                    .opacity = 0.5f,
                    .texture = 2,
                    .emission = 4};
    render((masu_frame_desc){.light = &dark}, base);
    render((masu_frame_desc){.light = &dark, .decals = &d, .decal_count = 1}, picture);
    double worst = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double t[4];
        if (!mean(&f, 2, TEXELS, whole, i, t)) continue;
        for (uint32_t k = 0; k < 3; k++) {
            double want = t[k] * (double)d.color[k] * 2;
            assert_true(base[4 * i + k] < 1e-3f);
            worst = fmax(worst, fabs(want - (double)picture[4 * i + k]));
        }
    }
    print_message("off by %.4f at most\n", worst);
    assert_true(worst < 0.03);
    close_session(&s);
}

/* A texture that changes stays in the history of a rung with temporal for a few frames only, even if
 * old and new colours are alike: inside the square, the picture becomes that of a material which
 * never showed the old texture. */
static void a_texture_that_changes_leaves_no_trail(void **state) {
    (void)state;
    enum { WARM = 40, AFTER = 24, LARGE = 64, RIM = 12 };
    static uint8_t shown[2][4 * PIXELS];
    uint32_t left[AFTER] = {0};
    masu_session_desc desc = room_desc(LARGE);
    desc.desc.rungs[0] = (masu_rung){.scale = 0.75f, .temporal = MASU_ON};
    masu_session other;
    open_session(&s, &desc);
    open_session(&other, &desc);
    masu_session *both[2] = {&s, &other};
    for (uint32_t i = 0; i < WARM + AFTER; i++) {
        for (uint32_t k = 0; k < 2; k++) {
            masu_frame_desc f = {MASU_FRAME_DESC, .camera = &camera, .time_step = 1.0f / 60};
            masu_commands commands;
            if (i == 0 || i == WARM) { /* the second one has the same texture from the start */
                masu_material_state state_of;
                masu_material material = masu_material_at(both[k]->m, 0);
                fill(1, LARGE, 1, 255, k == 0 && i == 0 ? 8 : 9);
                assert_int_equal(masu_texture_write(both[k]->m, 1, NULL, texels[0], 0, &failure),
                                 MASU_OK);
                assert_int_equal(masu_material_get(both[k]->m, material, &state_of, &failure),
                                 MASU_OK);
                state_of.texture = 1;
                assert_int_equal(masu_material_set(both[k]->m, material, &state_of, &failure),
                                 MASU_OK);
            }
            draw(both[k], &f, &commands, shown[k]);
        }
        if (i < WARM) continue;
        for (uint32_t p = 0; p < PIXELS; p++) {
            uint32_t x = p % SIDE, y = p / SIDE;
            if (x < RIM || y < RIM || x >= SIDE - RIM || y >= SIDE - RIM) continue;
            for (uint32_t k = 0; k < 3; k++)
                left[i - WARM] += (uint32_t)abs(shown[0][4 * p + k] - shown[1][4 * p + k]);
        }
    }
    const double count = 3.0 * (SIDE - 2 * RIM) * (SIDE - 2 * RIM);
    for (uint32_t i = 0; i < AFTER; i += 4)
        print_message("after %u frames: mean difference %.2f of 255\n", i, left[i] / count);
    assert_true(left[0] / count > 4 && 2 * left[8] < left[0] && 4 * left[20] < left[0]);
    close_session(&other);
    close_session(&s);
}

/* The square of the scene, 1 m around the origin. */
static void a_material_shows_a_live_texture(void **state) {
    (void)state;
    static uint8_t before[4 * PIXELS], after[4 * PIXELS];
    static const float whole[4] = {0, 0, 1, 1};
    const flat f = {0, 0, 3, 1, 1, 0};
    const masu_light dark = {.exposure = 1, .sun_direction = {0, 0, 1}};
    open_room(TEXELS);
    masu_material material = masu_material_at(s.m, 0);
    masu_material_state own, with;
    assert_int_equal(masu_material_get(s.m, material, &own, &failure), MASU_OK);
    assert_int_equal(own.texture, 0);
    fill(1, TEXELS, 2, 255, 4);
    write_whole(1);
    render_albedo((masu_frame_desc){0}, before);
    with = own;
    with.texture = 1;
    assert_int_equal(masu_material_set(s.m, material, &with, &failure), MASU_OK);
    render_albedo((masu_frame_desc){0}, after);
    double worst = albedo_off(&f, 1, TEXELS, whole, 1, before, after);
    print_message("base colour: off by %.1f of 255 at most\n", 255 * worst);
    assert_true(worst < 4.0 / 255);
    /* A screen: black, it emits. */
    for (uint32_t k = 0; k < 3; k++) with.base_color[k] = 0, with.emissive[k] = 3;
    with.specular = own.specular;
    assert_int_equal(masu_material_set(s.m, material, &with, &failure), MASU_OK);
    render((masu_frame_desc){.light = &dark}, picture);
    worst = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double t[4];
        if (!mean(&f, 1, TEXELS, whole, i, t)) continue;
        for (uint32_t k = 0; k < 3; k++)
            worst = fmax(worst, fabs(3 * t[k] - (double)picture[4 * i + k]));
    }
    print_message("emission: off by %.4f at most\n", worst);
    assert_true(worst < 0.05);
    assert_int_equal(masu_material_get(s.m, material, &with, &failure), MASU_OK);
    assert_int_equal(with.texture, 1);
    assert_true(with.opacity == 1.0f);
    with.texture = COUNT + 1;
    assert_int_equal(masu_material_set(s.m, material, &with, &failure), MASU_ERROR_LIMIT);
    assert_string_equal(failure.what, "texture");
    assert_int_equal(masu_material_set(s.m, material, &own, &failure), MASU_OK);
    render_albedo((masu_frame_desc){0}, after);
    assert_memory_equal(after, before, sizeof before);
    close_session(&s);
}

/* ---- Commands of the host -------------------------------------------------------------------- */

static VkImageMemoryBarrier of_layer(const masu_texture_image *t, uint32_t layer,
                                     VkImageLayout from, VkImageLayout to) {
    return (VkImageMemoryBarrier){.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                  .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                                  .dstAccessMask =
                                      VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                  .oldLayout = from,
                                  .newLayout = to,
                                  .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                  .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                  .image = t->image,
                                  .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, layer, 1}};
}

static void change(VkCommandBuffer cmd, const VkImageMemoryBarrier *b) {
    vkCmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                         VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL, 0, NULL, 1, b);
}

/* Clears layer 0, then blits its left half to all of layer 2. */
static void the_host_clears_and_blits_into_the_image(void **state) {
    (void)state;
    char error[ERROR_SIZE];
    masu_texture_image t;
    open_room(TEXELS);
    assert_int_equal(masu_texture_image_of(s.m, &t, &failure), MASU_OK);
    assert_true(t.width == TEXELS && t.height == TEXELS && t.layers == COUNT);
    assert_int_equal(t.usage & VK_IMAGE_USAGE_STORAGE_BIT, 0);
    const VkCommandBufferAllocateInfo info = {.sType =
                                                  VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                              .commandPool = s.host.pool,
                                              .commandBufferCount = 1};
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    VkCommandBuffer cmd;
    assert_int_equal(vkAllocateCommandBuffers(s.host.device, &info, &cmd), VK_SUCCESS);
    assert_int_equal(vkBeginCommandBuffer(cmd, &begin), VK_SUCCESS);
    const VkImageLayout to = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                        from = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL;
    const VkImageMemoryBarrier steps[] = {
        of_layer(&t, 0, t.layout, to), of_layer(&t, 0, to, from), of_layer(&t, 2, t.layout, to),
        of_layer(&t, 2, to, t.layout), of_layer(&t, 0, from, t.layout)};
    const VkClearColorValue color = {.float32 = {0.5f, 0.25f, 1, 1}};
    const VkImageBlit blit = {.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                              .srcOffsets = {{0, 0, 0}, {TEXELS / 2, TEXELS, 1}},
                              .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 2, 1},
                              .dstOffsets = {{0, 0, 0}, {TEXELS, TEXELS, 1}}};
    change(cmd, &steps[0]);
    vkCmdClearColorImage(cmd, t.image, to, &color, 1, &steps[0].subresourceRange);
    change(cmd, &steps[1]);
    change(cmd, &steps[2]);
    vkCmdBlitImage(cmd, t.image, from, t.image, to, 1, &blit, VK_FILTER_NEAREST);
    change(cmd, &steps[3]);
    change(cmd, &steps[4]);
    assert_int_equal(vkEndCommandBuffer(cmd), VK_SUCCESS);
    masu_particle p = sheet;
    p.texture = 3, p.opacity = 1, p.color[0] = p.color[1] = p.color[2] = 1;
    masu_frame_desc frame = {.particles = &p, .particle_count = 1};
    render(frame, picture);
    assert_ok(masu_headless_run(&s.host, cmd, error, sizeof error));
    for (uint32_t n = 0; n < 2; n++) {
        render(frame, picture);
        const float *center = &picture[4 * (SIDE / 2 * SIDE + SIDE / 2)];
        for (uint32_t k = 0; k < 3; k++) assert_true(fabsf(center[k] - color.float32[k]) < 0.01f);
    }
    vkFreeCommandBuffers(s.host.device, s.host.pool, 1, &cmd);
    close_session(&s);
}

/* ---- Limits, any numbers, memory ------------------------------------------------------------- */

static void refused(masu_result result, masu_result want, const char *what, uint64_t needed,
                    uint64_t given) {
    assert_int_equal(result, want);
    assert_string_equal(failure.what, what);
    assert_int_equal(failure.needed, needed);
    assert_int_equal(failure.given, given);
}

static void writes_have_limits(void **state) {
    (void)state;
    open_room(TEXELS);
    const VkRect2D out[] = {
        {{-1, 0}, {4, 4}}, {{0, 13}, {4, 4}}, {{0, 0}, {0, 4}}, {{0, 0}, {TEXELS + 1, 1}}};
    const VkRect2D one = {{TEXELS - 1, TEXELS - 1}, {1, 1}};
    for (uint32_t t = 0; t < 2; t++)
        refused(masu_texture_write(s.m, t ? COUNT + 1 : 0, NULL, texels[0], 0, &failure),
                MASU_ERROR_LIMIT, "reserve.textures", t ? COUNT + 1 : 0, COUNT);
    for (uint32_t i = 0; i < 4; i++)
        refused(masu_texture_write(s.m, 1, &out[i], texels[0], 0, &failure), MASU_ERROR_ARGUMENT,
                "rect", TEXELS, out[i].extent.width);
    refused(masu_texture_write(s.m, 1, NULL, texels[0], 4 * TEXELS - 4, &failure),
            MASU_ERROR_ARGUMENT, "row_bytes", 4 * TEXELS, 4 * TEXELS - 4);
    refused(masu_texture_write(s.m, 1, NULL, texels[0], 4 * TEXELS + 2, &failure),
            MASU_ERROR_ARGUMENT, "row_bytes", 4 * TEXELS, 4 * TEXELS + 2);
    assert_int_equal(masu_texture_write(s.m, 1, NULL, NULL, 0, &failure), MASU_ERROR_ARGUMENT);
    /* The bytes of two textures, and no texel more; then again in the next frame. */
    for (uint32_t frame = 0; frame < 2; frame++) {
        write_whole(1);
        write_whole(3);
        refused(masu_texture_write(s.m, 2, &one, texels[0], 0, &failure), MASU_ERROR_LIMIT,
                "reserve.texture_bytes", 8 * TEXELS * TEXELS + 4, 8 * TEXELS * TEXELS);
        render((masu_frame_desc){0}, picture);
    }
    for (uint32_t i = 0; i < MASU_MAX_TEXTURE_WRITES; i++)
        assert_int_equal(masu_texture_write(s.m, 2, &one, texels[0], 0, &failure), MASU_OK);
    refused(masu_texture_write(s.m, 2, &one, texels[0], 0, &failure), MASU_ERROR_LIMIT,
            "masu_texture_write", MASU_MAX_TEXTURE_WRITES + 1, MASU_MAX_TEXTURE_WRITES);
    /* A frame that fails keeps them. */
    masu_commands commands;
    masu_frame_desc bad = {MASU_FRAME_DESC, .camera = &camera, .rung = 9};
    assert_int_equal(masu_frame(s.m, &bad, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_texture_write(s.m, 2, &one, texels[0], 0, &failure), MASU_ERROR_LIMIT);
    render((masu_frame_desc){0}, picture);
    assert_int_equal(masu_texture_write(s.m, 2, &one, texels[0], 0, &failure), MASU_OK);
    close_session(&s);
}

static masu_result frame_of(masu_frame_desc frame) {
    masu_commands commands;
    frame.bytes = sizeof frame;
    frame.camera = &camera;
    return masu_frame(s.m, &frame, &commands, &failure);
}

static void frames_have_limits(void **state) {
    (void)state;
    static masu_trail_point points[POINTS + 1];
    const masu_decal glows = {.opacity = 1, .emission = 1};
    masu_session_desc none = room_desc(TEXELS);
    none.desc.reserve.textures = 0;
    open_session(&s, &none);
    refused(frame_of((masu_frame_desc){.decals = &glows, .decal_count = 1}), MASU_ERROR_ARGUMENT,
            "reserve.textures", 1, 0);
    close_session(&s);
    masu_trail t[2] = {{.points = points, .point_count = POINTS}, {.points = points}};
    masu_particle p = sheet;
    masu_decal d = {.texture = COUNT + 1};
    open_room(TEXELS);
    t[1].point_count = 1;
    refused(frame_of((masu_frame_desc){.trails = t, .trail_count = 2}), MASU_ERROR_LIMIT,
            "reserve.trail_points", POINTS + 1, POINTS);
    refused(frame_of((masu_frame_desc){.trail_count = 2}), MASU_ERROR_ARGUMENT, "trails", 2, 0);
    t[0].points = NULL;
    refused(frame_of((masu_frame_desc){.trails = t, .trail_count = 1}), MASU_ERROR_ARGUMENT,
            "trails", POINTS, 0);
    t[0].points = points, t[0].texture = p.texture = COUNT + 1;
    refused(frame_of((masu_frame_desc){.trails = t, .trail_count = 1}), MASU_ERROR_LIMIT,
            "reserve.textures", COUNT + 1, COUNT);
    refused(frame_of((masu_frame_desc){.particles = &p, .particle_count = 1}), MASU_ERROR_LIMIT,
            "reserve.textures", COUNT + 1, COUNT);
    refused(frame_of((masu_frame_desc){.decals = &d, .decal_count = 1}), MASU_ERROR_LIMIT,
            "reserve.textures", COUNT + 1, COUNT);
    t[0].texture = p.texture = d.texture = COUNT; /* the last ones are taken */
    render((masu_frame_desc){.trails = t,
                             .trail_count = 1,
                             .particles = &p,
                             .particle_count = 1,
                             .decals = &d,
                             .decal_count = 1},
           picture);
    close_session(&s);
}

static float any_float(uint64_t *seed) {
    static const float odd[] = {0, -1, 1e-30f, 1e9f, 3e38f, NAN, INFINITY, 0.5f};
    uint32_t kind = random_word(seed) % 4;
    return kind == 0   ? float_of_bits(random_word(seed))
           : kind == 1 ? odd[random_word(seed) % 8]
                       : random_float(seed) * 2 - 0.5f;
}

static void any_numbers_give_a_finite_picture(void **state) {
    (void)state;
    uint64_t seed = 11, segments = 0;
    open_room(TEXELS);
    for (uint32_t k = 1; k <= COUNT; k++) fill(k, TEXELS, 1, 0, k);
    write_whole(1), write_whole(3);
    for (uint32_t turn = 0; turn < 40; turn++) {
        masu_particle p[ROOM];
        masu_decal d[ROOM];
        masu_trail_point points[POINTS];
        masu_trail t[2] = {{.points = points, .point_count = POINTS / 2},
                           {.points = points + POINTS / 2, .point_count = POINTS / 2}};
        for (uint32_t i = 0; i < ROOM; i++) {
            p[i] = sheet;
            p[i].texture = random_word(&seed) % (COUNT + 1);
            d[i] = (masu_decal){.rows = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                .opacity = 1,
                                .texture = p[i].texture};
            for (uint32_t k = 0; k < 4; k++)
                p[i].uv[k] = any_float(&seed), d[i].uv[k] = any_float(&seed);
            if (i % 2) d[i].rows[random_word(&seed) % 12] = any_float(&seed);
            p[i].uv_next[i % 2] = any_float(&seed), p[i].blend = any_float(&seed);
            p[i].half_width = i % 4 ? p[i].half_width : any_float(&seed);
        }
        for (uint32_t i = 0; i < POINTS; i++) {
            points[i] =
                (masu_trail_point){.half_width = any_float(&seed), .opacity = any_float(&seed)};
            for (uint32_t k = 0; k < 3; k++) {
                points[i].position[k] = random_word(&seed) % 8 ? random_between(&seed, -1, 3.2)
                                                               : (double)any_float(&seed);
                points[i].color[k] = any_float(&seed);
            }
        }
        for (uint32_t i = 0; i < 2; i++) {
            if (random_word(&seed) % 2)
                t[i].repeat = any_float(&seed), t[i].offset = any_float(&seed);
            t[i].texture = random_word(&seed) % (COUNT + 1);
            t[i].flags = random_word(&seed);
            t[i].soft = random_word(&seed) % 2 ? any_float(&seed) : 0;
        }
        masu_stats_info stats = render((masu_frame_desc){.particles = p,
                                                         .particle_count = ROOM,
                                                         .decals = d,
                                                         .decal_count = ROOM,
                                                         .trails = t,
                                                         .trail_count = 2},
                                       picture);
        for (uint32_t i = 0; i < 4 * PIXELS; i++) assert_true(isfinite(picture[i]));
        segments += stats.trail_segments;
    }
    print_message("%llu segments\n", (unsigned long long)segments);
    assert_true(segments > 40);
    close_session(&s);
}

/* Rows of the memory report as masu.h states them; without a reserve there are none, and textures do
 * not change the picture. */
static void memory_is_as_stated(void **state) {
    (void)state;
    static float without[4 * PIXELS];
    for (uint32_t form = 0; form < 3; form++) { /* nothing, trails, all */
        masu_session_desc d = room_desc(TEXELS);
        if (form < 2) d.desc.reserve = (masu_reserve){.trail_points = form ? POINTS : 0};
        open_session(&s, &d);
        masu_memory_row rows[MEMORY_ROWS];
        uint32_t count = memory_rows(s.m, rows), sprites = 0, texels_found = 0, images = 0;
        for (uint32_t i = 0; i < count; i++) {
            uint64_t slot = 16 * (3 + 1) + POINTS * 128 + (form == 2 ? ROOM * (128 + 144) : 0);
            if (!strcmp(rows[i].name, "particles, lines, decals")) {
                sprites++;
                assert_in_range(rows[i].bytes, 2 * slot, 2 * slot + 1024);
            }
            slot = 8 * TEXELS * TEXELS + 2064;
            if (!strcmp(rows[i].name, "texels")) {
                texels_found++;
                assert_in_range(rows[i].bytes, 2 * slot, 2 * slot + 1024);
            }
            images += !strcmp(rows[i].name, "textures") && !strcmp(rows[i].kind, "image");
        }
        assert_int_equal(sprites, form > 0);
        assert_int_equal(images, form > 0);
        assert_int_equal(texels_found, form == 2);
        masu_texture_image image;
        assert_int_equal(masu_texture_image_of(s.m, &image, &failure),
                         form == 2 ? MASU_OK : MASU_ERROR_STATE);
        masu_plan_info plan;
        masu_plan_of(s.m, &plan);
        assert_int_equal(pass_of(&plan, "textures")->active, form == 2);
        render((masu_frame_desc){0}, form ? picture : without);
        if (form) assert_memory_equal(picture, without, sizeof without);
        close_session(&s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_are_shown_by_the_next_frame_and_stay),
        cmocka_unit_test(small_ones_do_not_alias),
        cmocka_unit_test(cells_of_an_atlas_do_not_bleed),
        cmocka_unit_test(a_decal_has_colour_and_alpha_of_its_cell),
        cmocka_unit_test(a_decal_emits_the_colour_of_its_cell),
        cmocka_unit_test(a_texture_that_changes_leaves_no_trail),
        cmocka_unit_test(a_material_shows_a_live_texture),
        cmocka_unit_test(the_host_clears_and_blits_into_the_image),
        cmocka_unit_test(writes_have_limits),
        cmocka_unit_test(frames_have_limits),
        cmocka_unit_test(any_numbers_give_a_finite_picture),
        cmocka_unit_test(memory_is_as_stated),
    };
    return cmocka_run_group_tests_name("live textures", tests, NULL, NULL);
}

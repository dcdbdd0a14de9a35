/* support.c: see support.h. */
#include "support/support.h"

#include "support/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *scene_path(const char *name) {
    static char paths[4][512];
    static uint32_t next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/scenes/%s.masu", made_dir(), name);
    return path;
}

static void show_message(void *user, const char *text) {
    (void)user;
    print_error("validation: %s\n", text);
}

masu_session_desc test_desc(const char *scene, uint32_t width, uint32_t height) {
    masu_session_desc d;
    memset(&d, 0, sizeof d);
    d.scene_path = scene ? scene_path(scene) : NULL;
    d.desc.output = (VkExtent2D){width, height};
    d.desc.targets.storage = 1;
    d.desc.debug.counters = 1;
    d.host.validate = true;
    d.host.message = show_message;
    return d;
}

void open_session(masu_session *s, const masu_session_desc *d) {
    char error[ERROR_SIZE];
    if (!masu_session_open(d, s, error, sizeof error)) fail_msg("masu_session_open: %s", error);
    if (d->host.validate || d->host.gpu_av) assert_true(s->host.validating);
}

void close_session(masu_session *s) {
    /* Destruction is validated too: count after it. */
    masu_session_close(s);
    if (s->host.messages)
        fail_msg("%u validation messages, first: %s", s->host.messages, s->host.first_message);
}

void draw(masu_session *s, const masu_frame_desc *frame, masu_commands *commands, uint8_t *pixels) {
    char error[ERROR_SIZE];
    assert_ok(masu_session_frame(s, frame, true, commands, error, sizeof error));
    if (!pixels) return;
    masu_headless_target *t = &s->targets[frame->target];
    assert_ok(masu_headless_target_read(&s->host, t, error, sizeof error));
    memcpy(pixels, t->mapped, (size_t)t->width * t->height * 4);
}

void draw_rung(masu_session *s, uint32_t rung, uint8_t *pixels) {
    masu_frame_desc frame = {MASU_FRAME_DESC, .rung = rung};
    masu_commands commands;
    draw(s, &frame, &commands, pixels);
}

uint32_t memory_rows(const masu_renderer *m, masu_memory_row rows[MEMORY_ROWS]) {
    uint32_t count = masu_memory_report(m, rows, MEMORY_ROWS);
    assert_true(count && count <= MEMORY_ROWS);
    return count;
}

const void *read_image(const masu_session *s, uint32_t slot, masu_readback_bits which) {
    masu_readback_image image;
    assert_int_equal(masu_readback(s->m, slot, which, &image, NULL), MASU_OK);
    uint32_t texel = image.format == VK_FORMAT_R16G16B16A16_SFLOAT ? 8 : 4;
    assert_int_equal(image.row_bytes, image.width * texel);
    return image.pixels;
}

const void *draw_image(masu_session *s, const masu_frame_desc *frame, masu_readback_bits which,
                       uint8_t *pixels) {
    masu_commands commands;
    draw(s, frame, &commands, pixels);
    return read_image(s, commands.slot, which);
}

void view_depths(const void *depth, const masu_camera *camera, float *out, size_t pixels) {
    for (size_t i = 0; i < pixels; i++) {
        float d = ((const float *)depth)[i];
        out[i] = d > 0.0f ? camera->near_distance / d : 0.0f;
    }
}

masu_stats_info stats_of(const masu_session *s, uint32_t slot) {
    masu_stats_info stats;
    assert_int_equal(masu_stats(s->m, slot, &stats, NULL), MASU_OK);
    return stats;
}

void place_instance(masu_session *s, const char *name, const float rows[12]) {
    masu_instance instance = masu_instance_find(s->m, name);
    assert_int_not_equal(instance.id, 0);
    assert_int_equal(masu_instance_set_transform(s->m, instance, rows, NULL), MASU_OK);
}

void move_instance(masu_session *s, const char *name, float x, float y, float z, float size) {
    const float rows[12] = {size, 0, 0, x, 0, size, 0, y, 0, 0, size, z};
    place_instance(s, name, rows);
}

const masu_plan_pass *pass_of(const masu_plan_info *plan, const char *name) {
    for (uint32_t p = 0; p < plan->pass_count; p++)
        if (!strcmp(plan->passes[p].name, name)) return &plan->passes[p];
    fail_msg("there is no pass %s", name);
    return NULL;
}

void open_device(masu_session *s) {
    masu_session_desc d = test_desc(NULL, 8, 8);
    d.no_renderer = true;
    open_session(s, &d);
}

bool on_gpu(const masu_session *s) {
    VkPhysicalDeviceType type = s->host.properties.deviceType;
    return type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ||
           type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU;
}

void skip_unless_host_sees_all_memory(void) {
    masu_session s;
    bool seen = true;
    open_device(&s);
    for (uint32_t i = 0; i < s.host.memory.memoryTypeCount; i++)
        seen = seen &&
               s.host.memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
    close_session(&s);
    if (!seen) skip();
}

uint32_t load_all(masu_session *s, masu_renderer *m) {
    char error[ERROR_SIZE];
    masu_commands commands;
    masu_result result;
    uint32_t parts = 0;
    while ((result = masu_load(m, &commands, NULL)) == MASU_INCOMPLETE) {
        if (!commands.part_count) continue; /* the block already contains the data */
        assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
        parts++;
    }
    assert_int_equal(result, MASU_OK);
    return parts;
}

void *host_block(uint64_t bytes) {
    void *block = aligned_alloc(64, (bytes + 63) / 64 * 64);
    assert_non_null(block);
    return block;
}

void make_target(masu_session *s, own_renderer *x, uint32_t width, uint32_t height, int storage) {
    char error[ERROR_SIZE];
    assert_ok(masu_headless_target_create(&s->host, width, height, VK_FORMAT_R8G8B8A8_UNORM,
                                          storage, &x->target, error, sizeof error));
}

void make_own(masu_session *s, own_renderer *x, const masu_desc *desc) {
    masu_desc d = *desc;
    masu_memory need;
    masu_detail detail;
    make_target(s, x, d.output.width, d.output.height, d.targets.storage != 0);
    d.targets.images = &x->target.image;
    d.targets.views = &x->target.view;
    d.targets.count = 1;
    if (masu_memory_query(&d, &need, &detail)) fail_msg("%s", detail.text);
    x->block = host_block(need.host_bytes);
    if (masu_init(&d, x->block, need.host_bytes, &x->m, &detail)) fail_msg("%s", detail.text);
    load_all(s, x->m);
}

void unmake_own(masu_session *s, own_renderer *x) {
    masu_destroy(x->m);
    free(x->block);
    masu_headless_target_destroy(&s->host, &x->target);
}

void draw_rungs_of(masu_session *s, const masu_desc *d, uint8_t *const *out,
                   masu_stats_info *stats) {
    char error[ERROR_SIZE];
    own_renderer x;
    masu_commands commands;
    make_own(s, &x, d);
    for (uint32_t r = 0; r < d->rung_count; r++) {
        masu_frame_desc frame = {MASU_FRAME_DESC, .rung = r};
        assert_int_equal(masu_frame(x.m, &frame, &commands, NULL), MASU_OK);
        assert_ok(masu_headless_run(&s->host, commands.buffer, error, sizeof error));
        if (stats) assert_int_equal(masu_stats(x.m, commands.slot, &stats[r], NULL), MASU_OK);
        assert_ok(masu_headless_target_read(&s->host, &x.target, error, sizeof error));
        memcpy(out[r], x.target.mapped, (size_t)x.target.width * x.target.height * 4);
    }
    unmake_own(s, &x);
}

uint32_t max_difference(const uint8_t *a, const uint8_t *b, size_t bytes) {
    uint32_t most = 0;
    for (size_t i = 0; i < bytes; i++) {
        uint32_t d = (uint32_t)abs((int)a[i] - (int)b[i]);
        if (d > most) most = d;
    }
    return most;
}

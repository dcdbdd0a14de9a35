/* test_sdf_looks.c: an image of every newer shape and of every way to colour one, pixel by pixel
 * against the same field in double precision: a hit is on the surface of a part, a miss misses
 * there too, and the albedo equals the material at the point, with the image's normal and the
 * width of a pixel. */
#include "support/files.h"
#include "support/support.h"

#include "sdfc/sdfc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SOURCE "tests/scenes/test_sdf_looks.sdf"

enum { W = 256, H = 208, PARTS = 64 };

typedef struct check {
    masu_sdfc_field *field;
    const masu_sdfc_part *parts;
    uint32_t count;
    double *room;
} check;

static double least(const check *c, const double p[3], uint32_t *nearest) {
    double d = 1e30;
    for (uint32_t i = 0; i < c->count; i++) {
        double f = masu_sdfc_field_run(c->field, i, p, c->room) / c->parts[i].lipschitz;
        if (f < d) *nearest = i;
        d = f < d ? f : d;
    }
    return d;
}

/* Whether a ray from the camera passes within `slack` of a surface, for pixels that report a
 * miss. */
static bool hits(const check *c, const double eye[3], const double way[3], double slack) {
    double t = 8, length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    for (int n = 0; n < 400 && t < 16; n++) {
        uint32_t part;
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = eye[k] + t * way[k] / length;
        double d = least(c, p, &part);
        if (d < -slack) return true;
        t += d > slack ? d : slack;
    }
    return false;
}

static void every_look_is_that_of_the_C(void **state) {
    (void)state;
    size_t bytes;
    char *text = read_file(SOURCE, &bytes);
    check c = {.field = masu_sdfc_field_open(text, bytes, SOURCE)};
    assert_non_null(c.field);
    c.parts = masu_sdfc_field_parts(c.field, &c.count);
    assert_true(c.count == 33);
    c.room = calloc(masu_sdfc_field_room(c.field), sizeof *c.room);
    const masu_camera camera = {
        .position = {0, 0, 12}, .forward = {0, 0, -1}, .fov_y = 0.95f, .near_distance = 0.1f};
    masu_session s;
    masu_session_desc d = test_desc("test_sdf_looks", W, H);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_NORMAL | MASU_READBACK_ALBEDO;
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = 1;
    open_session(&s, &d);
    masu_frame_desc frame = {.camera = &camera};
    masu_commands commands;
    static float depth[W * H];
    draw(&s, &frame, &commands, NULL);
    view_depths(read_image(&s, commands.slot, MASU_READBACK_DEPTH), &camera, depth, W * H);
    const uint32_t *normal = read_image(&s, commands.slot, MASU_READBACK_NORMAL);
    const uint8_t *albedo = read_image(&s, commands.slot, MASU_READBACK_ALBEDO);
    uint32_t seen[PARTS] = {0}, wrong[PARTS] = {0}, off = 0, holes = 0, missed = 0;
    double high = tan((double)camera.fov_y / 2), eye[3] = {0, 0, 12};
    for (int i = 0; i < W * H; i++) {
        double way[3] = {(2 * (i % W + 0.5) / W - 1) * high * W / H,
                         (1 - 2 * (i / W + 0.5) / H) * high, -1},
               p[3], look[8];
        uint32_t part = 0;
        double z = (double)depth[i];
        if (!(z > 0)) {
            missed++;
            if (i % 7 == 0) holes += hits(&c, eye, way, 2e-3);
            continue;
        }
        for (int k = 0; k < 3; k++) p[k] = eye[k] + z * way[k];
        if (fabs(least(&c, p, &part)) > 0.02) off++;
        float n[3];
        masu_unpack_normal(normal[i], n);
        const double unit[3] = {(double)n[0], (double)n[1], (double)n[2]};
        double far = z * sqrt(way[0] * way[0] + way[1] * way[1] + 1);
        masu_sdfc_field_material(c.field, part, p, unit, 2 * high / H * far, c.room, look);
        int worst = 0;
        for (int k = 0; k < 3; k++) {
            int should = (int)(255 * sqrt(fmin(fmax(look[k], 0), 1)) + 0.5);
            worst =
                abs(should - albedo[4 * i + k]) > worst ? abs(should - albedo[4 * i + k]) : worst;
        }
        seen[part]++;
        wrong[part] += worst > 12;
    }
    uint32_t hit = 0, bad = 0;
    for (uint32_t i = 0; i < c.count; i++) {
        hit += seen[i];
        if (seen[i] >= 100 && wrong[i] * 25 <= seen[i]) continue;
        print_message("part %s: %u of %u pixels have another colour\n", c.parts[i].name, wrong[i],
                      seen[i]);
        bad++;
    }
    assert_int_equal(bad, 0);
    print_message(
        "%u pixels hit, %u off the surface; %u miss, of which 1 in 7 looked at and %u hit in C\n",
        hit, off, missed, holes);
    assert_true(off * 500 < hit && holes * 500 < missed && hit > W * H / 10);
    close_session(&s);
    masu_sdfc_field_close(c.field);
    free(c.room);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_look_is_that_of_the_C)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}

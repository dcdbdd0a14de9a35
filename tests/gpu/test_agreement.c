/* test_agreement.c: polygons and SDF give the same image: a sphere as a fine mesh and as an SDF,
 * and a box that cuts through an SDF sphere, both against rays intersected in double precision. */
#include "support/support.h"
#include "support/floats.h"
#include "reference/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { W = 250, H = 192 };

/* ---- Rays in double precision ---------------------------------------------------------------- */

typedef struct eye {
    vec position, forward, right, up; /* right and up include the tangents of the field of view */
    double pixel;                     /* pixel size at view depth 1 */
} eye;

static eye make_eye(const masu_camera *c, uint32_t width, uint32_t height) {
    double tangent = tan((double)c->fov_y / 2);
    eye e = {.position = {c->position[0], c->position[1], c->position[2]},
             .forward =
                 vec_unit(vec_of(c->forward))};
    vec right = vec_unit(vec_cross(e.forward, (vec){0, 1, 0}));
    e.up = vec_scale(vec_cross(right, e.forward), tangent);
    e.right = vec_scale(right, tangent * width / height);
    e.pixel = 2 * tangent / height;
    return e;
}

/* Ray through pixel coordinates (x, y), with the centre of the first pixel at (0.5, 0.5); length 1
 * in view depth. */
static vec ray_through(const eye *e, double x, double y) {
    return vec_add(e->forward,
                   vec_add(vec_scale(e->right, 2 * x / W - 1), vec_scale(e->up, 1 - 2 * y / H)));
}

/* View depth of the first hit with a sphere around the origin, or -1. */
static double hit_sphere(const eye *e, vec d, double radius) {
    double a = vec_dot(d, d), b = vec_dot(e->position, d),
           c = vec_dot(e->position, e->position) - radius * radius;
    double root = b * b - a * c;
    return root < 0 ? -1 : (-b - sqrt(root)) / a;
}

/* The same with a box around the origin whose axes are the rows of an orthonormal matrix. */
static double hit_box(const eye *e, vec d, const vec axes[3], double half) {
    double enter = 0, leave = 1e30;
    for (int i = 0; i < 3; i++) {
        double o = vec_dot(e->position, axes[i]), v = vec_dot(d, axes[i]);
        double a = (-half - o) / v, b = (half - o) / v;
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    }
    return enter < leave ? enter : -1;
}

/* Signed distance of the ray from the sphere's silhouette, in pixels: positive outside. */
static double silhouette_pixels(const eye *e, vec d, double radius) {
    double along = -vec_dot(e->position, d) / vec_dot(d, d);
    vec nearest = vec_add(e->position, vec_scale(d, along));
    return (sqrt(vec_dot(nearest, nearest)) - radius) / (e->pixel * along);
}

/* ---- Images ---------------------------------------------------------------------------------- */

typedef struct picture {
    float depth[W * H]; /* view depth, 0: nothing */
    uint32_t normal[W * H];
    uint8_t albedo[W * H * 4];
} picture;

static void take_picture(masu_session *s, const masu_frame_desc *frame, picture *p) {
    masu_commands commands;
    masu_readback_image image;
    draw(s, frame, &commands, NULL);
    assert_int_equal(masu_readback(s->m, commands.slot, MASU_READBACK_DEPTH, &image, NULL),
                     MASU_OK);
    assert_int_equal(image.width, W);
    assert_int_equal(image.height, H);
    assert_int_equal(image.format, VK_FORMAT_R32_SFLOAT);
    view_depths(image.pixels, frame->camera, p->depth, W * H);
    memcpy(p->normal, read_image(s, commands.slot, MASU_READBACK_NORMAL), sizeof p->normal);
    memcpy(p->albedo, read_image(s, commands.slot, MASU_READBACK_ALBEDO), sizeof p->albedo);
}

static void open_for_pictures(masu_session *s, const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_NORMAL | MASU_READBACK_ALBEDO;
    d.desc.rung_count = 1;
    d.desc.rungs[0].scale = 1.0f;
    open_session(s, &d);
}

static const masu_camera cameras[] = {
    {.position = {1.2, 0.9, 3.2},
     .forward = {-1.2f, -0.9f, -3.2f},
     .fov_y = 0.7f,
     .near_distance = 0.1f},
    {.position = {0, 0, 1.05}, .forward = {0.2f, 0.1f, -1}, .fov_y = 1.5f, .near_distance = 0.001f},
    {.position = {8, 5, -12}, .forward = {-8, -5, 12}, .fov_y = 0.15f, .near_distance = 1},
    {.position = {1.6, 0.02, 1.1},
     .forward = {-0.5f, 0.1f, -1},
     .fov_y = 1.7f,
     .near_distance = 0.01f},
};

#define CAMERAS (sizeof cameras / sizeof *cameras)

/* ---- Tests ----------------------------------------------------------------------------------- */

/* Relative change of a pixel's depth when the surface moves by `grid` pixels across the screen: a
 * rasteriser snaps vertices to a grid (16 steps per pixel on one driver, 256 on another), which at
 * grazing angles is more than 1e-3. */
static double grid_slack(const eye *e, double x, double y, double truth, double radius,
                         double grid) {
    double most = 0;
    for (int n = 0; n < 4; n++) {
        double z = hit_sphere(
            e, ray_through(e, x + (n & 1 ? grid : -grid), y + (n & 2 ? grid : -grid)), radius);
        if (z > 0) most = worst_of(most, fabs(z / truth - 1));
    }
    return most;
}

/* grid: of the rasteriser, pixels; 0 for sphere tracing, which has no tolerance. */
static void compare_with_truth(const picture *p, const eye *e, double radius, double grid,
                               const char *what) {
    double worst_pixels = 0, worst_depth = 0, worst_beyond = 0, worst_angle = 0;
    uint32_t hits = 0;
    for (uint32_t y = 0; y < H; y++) {
        for (uint32_t x = 0; x < W; x++) {
            vec d = ray_through(e, x + 0.5, y + 0.5);
            double truth = hit_sphere(e, d, radius), got = (double)p->depth[y * W + x];
            double off = fabs(silhouette_pixels(e, d, radius));
            if ((truth > 0) != (got > 0)) {
                worst_pixels = worst_of(worst_pixels, off);
                continue;
            }
            if (!(got > 0) || off < 1)
                continue; /* at the rim, depth has no bounded change per pixel */
            hits++;
            worst_depth = worst_of(worst_depth, fabs(got / truth - 1));
            double slack = grid > 0 ? grid_slack(e, x + 0.5, y + 0.5, truth, radius, grid) : 0;
            worst_beyond = worst_of(worst_beyond, fabs(got / truth - 1) - slack);
            float n[3];
            masu_unpack_normal(p->normal[y * W + x], n);
            vec true_normal = vec_unit(vec_add(e->position, vec_scale(d, truth)));
            double cosine = vec_dot(true_normal, (vec){(double)n[0], (double)n[1], (double)n[2]});
            worst_angle = worst_of(worst_angle, acos(fmin(1, cosine)) * 57.29578);
        }
    }
    print_message(
        "  %s: %u pixels, silhouette error %.3f px, depth %.2e, normal %.3f degrees\n", what,
        hits, worst_pixels, worst_depth, worst_angle);
    assert_true(hits > 2000);
    assert_true(worst_pixels < 1.0);
    assert_true(worst_beyond < 1e-3);
    assert_true(worst_angle < 0.5);
}

static void a_sphere_is_the_same_as_mesh_as_sdf_and_in_double_precision(void **state) {
    (void)state;
    static picture mesh, sdf;
    masu_session a, b;
    open_for_pictures(&a, "test_sphere_mesh");
    open_for_pictures(&b, "test_sphere_sdf");
    double grid = exp2(-(double)a.host.properties.limits.subPixelPrecisionBits);
    for (size_t c = 0; c < CAMERAS; c++) {
        eye e = make_eye(&cameras[c], W, H);
        masu_frame_desc frame = {.camera = &cameras[c]};
        take_picture(&a, &frame, &mesh);
        take_picture(&b, &frame, &sdf);
        compare_with_truth(&mesh, &e, 1.0, grid, "mesh");
        compare_with_truth(&sdf, &e, 1.0, 0, "sdf ");
        uint32_t differ = 0;
        double worst = 0;
        for (uint32_t i = 0; i < W * H; i++) {
            double off =
                fabs(silhouette_pixels(&e, ray_through(&e, i % W + 0.5, i / W + 0.5), 1.0));
            if ((mesh.depth[i] > 0) != (sdf.depth[i] > 0)) {
                differ++;
                assert_true(off < 1.0);
            } else if (mesh.depth[i] > 0 && off > 1) {
                double x = i % W + 0.5, y = i / W + 0.5, z = (double)sdf.depth[i];
                worst = worst_of(worst, fabs((double)mesh.depth[i] / z - 1) -
                                        grid_slack(&e, x, y, z, 1.0, grid));
            }
        }
        print_message("  mesh against sdf: %u pixels of the silhouette differ, depth by %.2e\n",
                      differ, worst);
        assert_true(worst < 1e-3);
    }
    close_session(&a);
    close_session(&b);
}

static void a_parameter_sets_the_radius_and_is_clamped_to_its_range(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    open_for_pictures(&s, "test_sphere_sdf");
    eye e = make_eye(&cameras[0], W, H);
    static const float radii[] = {0.5f, 0.75f, 99.0f};
    for (size_t i = 0; i < 3; i++) {
        masu_frame_desc frame = {
            .camera = &cameras[0], .sdf_params = &radii[i], .sdf_param_count = 1};
        take_picture(&s, &frame, &p);
        compare_with_truth(&p, &e, i == 2 ? (double)1.4f : (double)radii[i], 0, "sdf ");
    }
    close_session(&s);
}

enum { NOTHING, BOX, SPHERE };

static int nearest(const eye *e, double x, double y, const vec axes[3]) {
    vec d = ray_through(e, x, y);
    double box = hit_box(e, d, axes, 0.65), sphere = hit_sphere(e, d, 0.8);
    if (box <= 0 && sphere <= 0) return NOTHING;
    return sphere > 0 && (box <= 0 || sphere < box) ? SPHERE : BOX;
}

static void the_nearer_of_polygon_and_sdf_wins_at_every_pixel(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    open_for_pictures(&s, "test_both");
    /* The test sets its own rotation: about (1, 2, 3) by 0.8. */
    vec k = vec_unit((vec){1, 2, 3});
    double cosine = cos(0.8), sine = sin(0.8);
    vec columns[3], unit_axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; i++) {
        vec v = unit_axes[i];
        columns[i] = vec_add(vec_add(vec_scale(v, cosine), vec_scale(vec_cross(k, v), sine)),
                         vec_scale(k, vec_dot(k, v) * (1 - cosine)));
    }
    float rows[12] = {(float)columns[0].x, (float)columns[1].x, (float)columns[2].x, 0,
                      (float)columns[0].y, (float)columns[1].y, (float)columns[2].y, 0,
                      (float)columns[0].z, (float)columns[1].z, (float)columns[2].z, 0};
    assert_int_equal(masu_instance_set_transform(s.m, masu_instance_find(s.m, "box"), rows, NULL),
                     MASU_OK);
    eye e = make_eye(&cameras[0], W, H);
    masu_frame_desc frame = {.camera = &cameras[0]};
    take_picture(&s, &frame, &p);
    take_picture(&s, &frame, &p); /* the other slot has the new transform too */
    uint32_t counts[3] = {0}, border = 0;
    for (uint32_t y = 0; y < H; y++) {
        for (uint32_t x = 0; x < W; x++) {
            /* Pixels within one pixel of a border may be either. */
            int want = nearest(&e, x + 0.5, y + 0.5, columns), same = 1;
            for (int n = 0; n < 9; n++)
                same &= nearest(&e, x + n % 3 - 0.5, y + n / 3 - 0.5, columns) == want;
            if (!same) {
                border++;
                continue;
            }
            const uint8_t *albedo = &p.albedo[4 * (y * W + x)];
            int got = p.depth[y * W + x] <= 0 ? NOTHING : albedo[2] > albedo[0] ? BOX : SPHERE;
            if (got != want) fail_msg("pixel %u,%u shows %d, the reference is %d", x, y, got, want);
            counts[want]++;
        }
    }
    print_message("  box %u, sphere %u, sky %u, borders %u pixels\n", counts[BOX], counts[SPHERE],
                  counts[NOTHING], border);
    assert_true(counts[BOX] > 1000 && counts[SPHERE] > 1000 && counts[NOTHING] > 1000);
    close_session(&s);
}

/* The camera is inside an SDF solid, which a ray hits at its start: at the near plane, depth 1. A
 * plate is exactly there, with numbers that floats represent exactly. */
static void at_the_same_depth_the_polygon_wins(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    open_for_pictures(&s, "test_tie");
    const masu_camera c = {.position = {0, 0.5, 0},
                           .forward = {0, -1, 0},
                           .up = {0, 0, -1},
                           .fov_y = 0.7f,
                           .near_distance = 0.5f};
    masu_frame_desc frame = {.camera = &c};
    uint32_t plate[3] = {0};
    for (int i = 0; i < 3; i++) {
        /* On the near plane; behind it; again on it. */
        const float rows[12] = {1, 0, 0, 0, 0, 1, 0, i == 1 ? -0.25f : 0, 0, 0, 1, 0};
        assert_int_equal(
            masu_instance_set_transform(s.m, masu_instance_find(s.m, "plate"), rows, NULL),
            MASU_OK);
        take_picture(&s, &frame, &p);
        for (uint32_t k = 0; k < W * H; k++) {
            /* view depth: near / 1; GPU divisions are slightly inexact */
            assert_true(p.depth[k] >= 0.5f && p.depth[k] < 0.500001f);
            plate[i] += p.albedo[4 * k + 2] > p.albedo[4 * k];
        }
    }
    /* A plate of 0.25 at 0.5, at which the image's height is 0.365. */
    print_message("  the plate has %u pixels on the near plane, %u behind it\n", plate[0],
                  plate[1]);
    assert_in_range(plate[0], 131 * 131, 133 * 133);
    assert_int_equal(plate[1], 0);
    assert_int_equal(plate[2], plate[0]);
    close_session(&s);
}

static void a_million_metres_from_the_origin_polygons_look_the_same(void **state) {
    (void)state;
    static picture here, there;
    masu_session s;
    open_for_pictures(&s, "test_sphere_mesh");
    masu_camera c = cameras[0];
    masu_frame_desc frame = {.camera = &c};
    take_picture(&s, &frame, &here);
    float rows[12] = {1, 0, 0, 1048576, 0, 1, 0, -2097152, 0, 0, 1, 524288};
    assert_int_equal(masu_instance_set_transform(s.m, masu_instance_at(s.m, 0), rows, NULL),
                     MASU_OK);
    c.position[0] += 1048576, c.position[1] -= 2097152, c.position[2] += 524288;
    take_picture(&s, &frame, &there);
    double worst = 0;
    uint32_t differ = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        differ += (here.depth[i] > 0) != (there.depth[i] > 0);
        if (here.depth[i] > 0 && there.depth[i] > 0) {
            worst = worst_of(worst, fabs((double)here.depth[i] / (double)there.depth[i] - 1));
        }
    }
    print_message("  %u pixels differ in coverage, depth by %.2e\n", differ, worst);
    assert_true(differ <= 4);
    assert_true(worst < 1e-4);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sphere_is_the_same_as_mesh_as_sdf_and_in_double_precision),
        cmocka_unit_test(a_parameter_sets_the_radius_and_is_clamped_to_its_range),
        cmocka_unit_test(the_nearer_of_polygon_and_sdf_wins_at_every_pixel),
        cmocka_unit_test(at_the_same_depth_the_polygon_wins),
        cmocka_unit_test(a_million_metres_from_the_origin_polygons_look_the_same),
    };
    return cmocka_run_group_tests_name("agreement", tests, NULL, NULL);
}

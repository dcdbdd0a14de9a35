/* test_velocity.c: the previous position of each pixel's surface, against double precision: the
 * point given by the depth is moved back by the same motions in plain C (for deforming parts by
 * masu-sdfc's C code of the scene, compiled here), projected by the previous camera, and compared
 * in pixels. tests/scenes/test_velocity.sdf documents the motion of its parts. */
#include "reference/vec.h"
#include "scene/scene.h"
#include "support/files.h"
#include "support/floats.h"
#include "support/support.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { W = 160, H = 120 };
enum { SKY, MOVER, GROWER, MORPHER, GROUND, BOX, KINDS }; /* parts in the compiler's order */
static const char *const kind_names[KINDS] = {"sky",     "mover",  "grower",
                                              "morpher", "ground", "polygon"};

static vec turned(vec p, vec axis, double angle) {
    vec k = vec_unit(axis);
    return vec_add(vec_add(vec_scale(p, cos(angle)), vec_scale(vec_cross(k, p), sin(angle))),
               vec_scale(k, vec_dot(k, p) * (1 - cos(angle))));
}

/* ---- The scene's fields in double precision -------------------------------------------------- */

static void *library;
static double (*part_distance)(const double *params, double time, const double p[3], int part);
static int (*nearest_part)(const double *params, double time, const double p[3]);

static int make_truth(void **state) {
    if (make_scratch(state)) return 1;
    if (shell("%s/bin/masu-sdfc tests/scenes/test_velocity.sdf --c %s/t.c --quiet --pairs 100",
              build_dir(), scratch) ||
        shell("%s -std=c11 -O3 -w -shared -fPIC -o %s/t.so %s/t.c -lm", c_compiler(), scratch,
              scratch)) {
        return 1;
    }
    library = dlopen(in_scratch("t.so"), RTLD_NOW | RTLD_LOCAL);
    if (!library) return 1;
    void *symbol = dlsym(library, "masu_truth_part_distance");
    memcpy(&part_distance, &symbol, sizeof symbol);
    symbol = dlsym(library, "masu_truth_part");
    memcpy(&nearest_part, &symbol, sizeof symbol);
    return !part_distance || !nearest_part;
}

static int remove_truth(void **state) {
    if (library) dlclose(library);
    return remove_scratch(state);
}

/* ---- One frame ------------------------------------------------------------------------------- */

typedef struct moment {
    masu_camera camera;
    double time;
    float radius;
    float rows[12]; /* of the polygon box */
    int rests;      /* no setter is called */
} moment;

/* The field of a part. In this scene, shapes have the order of the parts in the text. */
static double field(const moment *m, vec p, int kind) {
    double radius = (double)m->radius, at[3] = {p.x, p.y, p.z};
    return part_distance(&radius, m->time, at, kind - MOVER);
}

static vec gradient(const moment *m, vec p, int kind) {
    double h = 1e-6;
    return (vec){
        field(m, vec_add(p, (vec){h, 0, 0}), kind) - field(m, vec_add(p, (vec){-h, 0, 0}), kind),
        field(m, vec_add(p, (vec){0, h, 0}), kind) - field(m, vec_add(p, (vec){0, -h, 0}), kind),
        field(m, vec_add(p, (vec){0, 0, h}), kind) - field(m, vec_add(p, (vec){0, 0, -h}), kind)};
}

typedef struct eye {
    vec position, forward, right, up; /* right and up of unit length */
    double tan_x, tan_y;
} eye;

static eye eye_of(const masu_camera *c) {
    eye e = {.position = {c->position[0], c->position[1], c->position[2]},
             .forward =
                 vec_unit(vec_of(c->forward)),
             .tan_y = tan((double)c->fov_y / 2)};
    e.tan_x = e.tan_y * W / H;
    e.right = vec_unit(vec_cross(e.forward, (vec){0, 1, 0}));
    e.up = vec_cross(e.right, e.forward);
    return e;
}

static vec ray_through(const eye *e, double x, double y) {
    return vec_add(e->forward, vec_add(vec_scale(e->right, (2 * x / W - 1) * e->tan_x),
                               vec_scale(e->up, (1 - 2 * y / H) * e->tan_y)));
}

/* Pixel coordinates of a direction from the camera. */
static void project(const eye *e, vec rel, double *x, double *y, double *z) {
    *z = vec_dot(rel, e->forward);
    *x = (vec_dot(rel, e->right) / *z / e->tan_x + 1) * W / 2;
    *y = (1 - vec_dot(rel, e->up) / *z / e->tan_y) * H / 2;
}

/* ---- Previous positions ---------------------------------------------------------------------- */

static vec mover_in(double t, vec p) {
    vec q = vec_sub(p, (vec){-1.6 + 0.3 * t, 0.2 * t, 0.1 * t});
    return vec_scale(turned(q, (vec){0.3, 1, 0.2}, -0.5 * t), 1 / (1 + 0.1 * t));
}

static vec mover_out(double t, vec q) {
    return vec_add(turned(vec_scale(q, 1 + 0.1 * t), (vec){0.3, 1, 0.2}, 0.5 * t),
               (vec){-1.6 + 0.3 * t, 0.2 * t, 0.1 * t});
}

static vec row(const float *rows, int i) {
    return (vec){(double)rows[4 * i], (double)rows[4 * i + 1], (double)rows[4 * i + 2]};
}

/* The matrices of this test only rotate and translate. */
static vec box_before(const moment *now, const moment *was, vec p) {
    vec q = vec_sub(p, (vec){(double)now->rows[3], (double)now->rows[7], (double)now->rows[11]});
    vec own = vec_add(vec_scale(row(now->rows, 0), q.x),
                  vec_add(vec_scale(row(now->rows, 1), q.y), vec_scale(row(now->rows, 2), q.z)));
    return (vec){vec_dot(row(was->rows, 0), own) + (double)was->rows[3],
                 vec_dot(row(was->rows, 1), own) + (double)was->rows[7],
                 vec_dot(row(was->rows, 2), own) + (double)was->rows[11]};
}

/* The surface along the normal: steps of the field's change over its slope until the change is 0.
 * (Which normal, the present or the previous one, is a matter of definition and up to 0.04 pixels
 * here; it is the previous one.) */
static vec surface_before(const moment *now, const moment *was, vec p, int kind) {
    double level = field(now, p, kind);
    for (int i = 0; i < 30; i++) {
        vec g = vec_scale(gradient(was, p, kind), 1 / 2e-6);
        p = vec_sub(p, vec_scale(g, (field(was, p, kind) - level) / vec_dot(g, g)));
    }
    return p;
}

/* Within two pixels of an edge of a deforming surface, "along the normal" is undefined. */
static int at_crease(const moment *m, vec p, double reach) {
    vec n = vec_unit(gradient(m, p, MORPHER));
    for (int i = 0; i < 6; i++) {
        double s = i & 1 ? reach : -reach;
        vec o = i < 2 ? (vec){s, 0, 0} : i < 4 ? (vec){0, s, 0} : (vec){0, 0, s};
        if (vec_dot(n, vec_unit(gradient(m, vec_add(p, o), MORPHER))) < 0.9) return 1;
    }
    return 0;
}

static vec before(const moment *now, const moment *was, vec p, int kind) {
    switch (kind) {
    case MOVER: return mover_out(was->time, mover_in(now->time, p));
    case GROWER: {
        vec c = {0, 0.2, 0};
        return vec_add(
            p, vec_scale(vec_unit(vec_sub(p, c)), (double)was->radius - (double)now->radius));
    }
    case MORPHER: return surface_before(now, was, p, kind);
    case BOX: return box_before(now, was, p);
    default: return p;
    }
}

/* ---- Images ---------------------------------------------------------------------------------- */

typedef struct picture {
    float depth[W * H]; /* view depth, 0: nothing */
    double velocity[W * H][4];
} picture;

static void open_moving(masu_session *s, const char *scene, uint32_t flights) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    d.desc.frames_in_flight = flights;
    d.desc.debug.poison = 1;
    open_session(s, &d);
}

static void take(masu_session *s, const moment *m, uint32_t cut, picture *p) {
    masu_commands commands;
    masu_readback_image image;
    masu_frame_desc frame = {
        .camera = &m->camera, .time = m->time, .cut = cut, .sdf_params = &m->radius};
    frame.sdf_param_count = masu_scene_count(&s->scene, MASU_SCENE_SDF_PARAM);
    if (!m->rests) place_instance(s, "box", m->rows);
    draw(s, &frame, &commands, NULL);
    if (!p) return;
    view_depths(read_image(s, commands.slot, MASU_READBACK_DEPTH), &m->camera, p->depth, W * H);
    assert_int_equal(masu_readback(s->m, commands.slot, MASU_READBACK_VELOCITY, &image, NULL),
                     MASU_OK);
    assert_int_equal(image.format, VK_FORMAT_R16G16B16A16_SFLOAT);
    assert_int_equal(image.row_bytes, W * 8);
    const uint16_t *velocity = image.pixels;
    for (uint32_t i = 0; i < 4 * W * H; i++) p->velocity[i / 4][i % 4] = half_float(velocity[i]);
}

static int kind_at(const masu_session *s, const moment *m, vec p, double z) {
    double at[3] = {p.x, p.y, p.z}, radius = (double)m->radius;
    if (!masu_scene_data_of(&s->scene)->sdf) return BOX;
    int part = nearest_part(&radius, m->time, at);
    return fabs(field(m, p, part + MOVER)) > 2e-3 * z ? BOX : part + MOVER;
}

/* Largest error in pixels and of the depth ratio, by kind of surface. */
typedef struct errors {
    double pixels[KINDS], depth[KINDS], longest[KINDS];
    uint32_t count[KINDS], creases;
} errors;

static errors compare(const masu_session *s, const picture *p, const moment *now,
                      const moment *was) {
    errors e;
    memset(&e, 0, sizeof e);
    eye a = eye_of(&now->camera), b = eye_of(&was->camera);
    for (int i = 0; i < W * H; i++) {
        double x = i % W + 0.5, y = i / W + 0.5, px, py, pz, z = (double)p->depth[i];
        vec d = ray_through(&a, x, y), rel = d;
        int kind = SKY;
        if (z > 0) {
            vec at = vec_add(a.position, vec_scale(d, z));
            kind = kind_at(s, now, at, z);
            if (kind == MORPHER && was->time != now->time &&
                (at_crease(now, at, 4 * a.tan_y / H * z) ||
                 at_crease(was, at, 4 * a.tan_y / H * z))) {
                e.creases++;
                continue;
            }
            rel = vec_sub(before(now, was, at, kind), b.position);
        }
        project(&b, rel, &px, &py, &pz);
        assert_true(p->velocity[i][3] == 1.0);
        double off = hypot(p->velocity[i][0] - (px - x), p->velocity[i][1] - (py - y));
        double depth = z > 0 ? fabs(p->velocity[i][2] - (pz / z - 1)) : fabs(p->velocity[i][2]);
        e.pixels[kind] = worst_of(e.pixels[kind], off);
        e.depth[kind] = worst_of(e.depth[kind], depth);
        e.longest[kind] = fmax(e.longest[kind], hypot(px - x, py - y));
        e.count[kind]++;
    }
    return e;
}

static void assert_right(const errors *e, double limit, const char *what) {
    for (int k = 0; k < KINDS; k++) {
        if (!e->count[k]) continue;
        print_message("  %s, %s: %u pixels, longest motion %.2f px, error %.4f px, depth %.1e\n",
                      what, kind_names[k], e->count[k], e->longest[k], e->pixels[k], e->depth[k]);
    }
    if (e->creases) print_message("  %s, at edges of the morph: %u pixels\n", what, e->creases);
    assert_true(e->creases <= e->count[MORPHER]);
    for (int k = 0; k < KINDS; k++) {
        assert_true(e->pixels[k] < limit);
        assert_true(e->depth[k] < 1e-3);
    }
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static const moment start = {.camera = {.position = {0.6, 1.2, 4.5},
                                        .forward = {-0.6f, -1.0f, -4.5f},
                                        .fov_y = 0.87f,
                                        .near_distance = 0.1f},
                             .time = 0.7,
                             .radius = 0.5f,
                             .rows = {1, 0, 0, 0, 0, 1, 0, 1.4f, 0, 0, 1, -0.5f}};

static void move_camera(moment *m) {
    m->camera.position[0] += 0.06;
    m->camera.position[1] -= 0.03;
    m->camera.position[2] -= 0.15;
    m->camera.forward[0] += 0.13f;
    m->camera.forward[1] += 0.05f;
}

static void turn_box(moment *m, double angle) {
    vec axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int i = 0; i < 3; i++) {
        vec c = turned(axes[i], (vec){1, 2, 3}, angle);
        m->rows[i] = (float)c.x, m->rows[4 + i] = (float)c.y, m->rows[8 + i] = (float)c.z;
    }
    m->rows[3] += 0.05f, m->rows[11] += 0.1f;
}

static void a_moving_camera_moves_polygons_sdf_and_sky(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    moment now = start;
    now.camera.forward[1] = -0.7f; /* with some sky */
    moment was = now;
    move_camera(&now);
    open_moving(&s, "test_velocity", 2);
    take(&s, &was, 0, &p);
    errors e = compare(&s, &p, &was, &was);
    assert_right(&e, 1e-4, "first frame");
    take(&s, &now, 0, &p);
    e = compare(&s, &p, &now, &was);
    assert_right(&e, 0.01, "camera");
    for (int k = 0; k < KINDS; k++) assert_true(e.count[k] > 150 && e.longest[k] > 1);
    close_session(&s);
}

/* Every slot of the frames in flight, one after the other. */
static void what_moves_and_what_changes_is_followed(void **state) {
    (void)state;
    static picture p;
    for (uint32_t flights = 1; flights <= 3; flights++) {
        masu_session s;
        moment was = start;
        open_moving(&s, "test_velocity", flights);
        take(&s, &was, 0, NULL);
        for (int i = 0; i < 4; i++) {
            moment now = was;
            now.time += 0.06 + 0.02 * i;
            now.radius += 0.02f;
            turn_box(&now, 0.05 * i);
            if (i & 1) move_camera(&now);
            take(&s, &now, 0, &p);
            errors e = compare(&s, &p, &now, &was);
            if (flights < 3)
                assert_right(&e, 0.02, i & 1 ? "all moves" : "all but the camera");
            else
                for (int k = 0; k < KINDS; k++) assert_true(e.pixels[k] < 0.02);
            /* Not by coincidence: a reference with a different previous state has a large error. */
            moment wrong = was;
            wrong.time -= 0.1;
            wrong.radius -= 0.03f;
            wrong.rows[3] += 0.05f;
            errors f = compare(&s, &p, &now, &wrong);
            for (int k = MOVER; k < KINDS; k++) assert_true(k == GROUND || f.pixels[k] > 0.1);
            was = now;
        }
        /* In the next frame nothing moves, and no setter is called: every slot drops the previous
         * state. */
        was.rests = 1;
        for (uint32_t i = 0; i < flights + 1; i++) {
            take(&s, &was, 0, &p);
            /* A GPU may round one position differently in both frames. */
            for (int k = 0; k < 3 * W * H; k++) {
                double v = p.velocity[k / 3][k % 3];
                if (!(fabs(v) <= (on_gpu(&s) ? 1e-3 : 0.0)))
                    fail_msg("%u slots, static: %g of pixel %d, component %d",
                             flights, v, k / 3, k % 3);
            }
        }
        close_session(&s);
    }
}

static void polygons_alone_have_velocities(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    moment was = start, now = start;
    move_camera(&now);
    turn_box(&now, 0.2);
    open_moving(&s, "test_velocity_mesh", 2);
    take(&s, &was, 0, NULL);
    take(&s, &now, 0, &p);
    errors e = compare(&s, &p, &now, &was);
    assert_right(&e, 0.02, "polygons");
    assert_true(e.count[BOX] > 300 && e.count[SKY] > 500 && e.longest[BOX] > 2);
    close_session(&s);
}

static void a_cut_forgets_the_frame_before(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    moment was = start, now = start;
    move_camera(&now);
    turn_box(&now, 0.2);
    now.time += 5;
    now.radius = 0.9f;
    open_moving(&s, "test_velocity", 2);
    take(&s, &was, 0, NULL);
    take(&s, &was, 0, NULL);
    take(&s, &now, 1, &p);
    for (int i = 0; i < W * H; i++) {
        for (int c = 0; c < 3; c++) assert_true(p.velocity[i][c] == 0);
        assert_true(p.velocity[i][3] == 1);
    }
    close_session(&s);
}

/* A point that the camera has passed has no position in the previous image. */
static void a_point_that_was_behind_the_camera_says_so(void **state) {
    (void)state;
    static picture p;
    masu_session s;
    moment was = start, now = start;
    was.camera.position[2] = 0, was.camera.position[1] = 3;
    was.camera.forward[1] = 0;
    now.camera.position[2] = 5;
    now.camera.forward[1] = -2;
    open_moving(&s, "test_velocity", 2);
    take(&s, &was, 0, NULL);
    take(&s, &now, 0, &p);
    uint32_t untold = 0;
    for (int i = 0; i < W * H; i++) {
        if (p.velocity[i][3] == 1) continue;
        for (int c = 0; c < 4; c++) assert_true(p.velocity[i][c] == 0);
        untold++;
    }
    print_message("  %u pixels without history\n", untold);
    assert_true(untold > W * H / 10 && untold < W * H);
    close_session(&s);
}

/* A hand-written field has no moving parts, but its surface is followed along its normal. */
static void a_field_by_hand_is_followed_along_its_normal(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = test_desc("test_sphere_sdf", W, H);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    masu_commands commands;
    masu_readback_image image;
    masu_camera c = {.position = {0, 0, 4}, .forward = {0, 0, -1}, .fov_y = 0.8f};
    c.near_distance = 0.1f;
    float radius = 0.9f;
    masu_frame_desc frame = {.camera = &c, .sdf_params = &radius, .sdf_param_count = 1};
    draw(&s, &frame, &commands, NULL);
    radius = 1.0f;
    draw(&s, &frame, &commands, NULL);
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_DEPTH, &image, NULL), MASU_OK);
    const float *depth = image.pixels;
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_VELOCITY, &image, NULL),
                     MASU_OK);
    const uint16_t *texels = image.pixels;
    eye e = eye_of(&c);
    double worst = 0, longest = 0;
    for (int i = 0; i < W * H; i++) {
        if (!(depth[i] > 0)) continue;
        double x = i % W + 0.5, y = i / W + 0.5, px, py, pz;
        vec p = vec_add(e.position, vec_scale(ray_through(&e, x, y), 0.1 / (double)depth[i]));
        project(&e, vec_sub(vec_scale(vec_unit(p), sqrt(vec_dot(p, p)) - 0.1), e.position), &px,
                &py, &pz);
        worst = worst_of(worst, hypot(half_float(texels[4 * i]) - (px - x),
                                      half_float(texels[4 * i + 1]) - (py - y)));
        longest = fmax(longest, hypot(px - x, py - y));
    }
    print_message("  longest motion %.2f px, error %.4f px\n", longest, worst);
    assert_true(longest > 3 && worst < 0.02);
    close_session(&s);
}

/* The second of two frames with a moving camera: depths and half floats of velocities. */
static void take_static(const char *scene, float depth[W * H], uint16_t velocity[4 * W * H],
                        masu_camera cameras[2], const char *pass) {
    masu_session s;
    masu_commands commands;
    masu_readback_image image;
    masu_plan_info plan;
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_VELOCITY;
    d.desc.rung_count = 1;
    d.desc.debug.poison = 1;
    open_session(&s, &d);
    masu_plan_of(s.m, &plan);
    for (uint32_t i = 0; i < plan.pass_count; i++) {
        if (strstr(plan.passes[i].name, "velocity"))
            assert_int_equal(plan.passes[i].active, strcmp(plan.passes[i].name, pass) == 0);
    }
    for (uint32_t n = 0; n < 2; n++) {
        masu_frame_desc frame = {.camera = &cameras[n], .time = n};
        draw(&s, &frame, &commands, NULL);
    }
    view_depths(read_image(&s, commands.slot, MASU_READBACK_DEPTH), &cameras[1], depth, W * H);
    assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_VELOCITY, &image, NULL),
                     MASU_OK);
    memcpy(velocity, image.pixels, 4 * W * H * sizeof *velocity);
    close_session(&s);
}

/* A field that reads a parameter has the pass that evaluates it; one without has the pass that does
 * not, and the same velocities to the bit. With polygons, which rest too: by the formula. */
static void a_static_field_moves_by_the_camera_alone(void **state) {
    (void)state;
    static float depth[2][W * H];
    static uint16_t velocity[2][4 * W * H];
    masu_camera c[2] = {
        {.position = {0.3, 0.2, 3.2}, .forward = {0, 0, -1}, .fov_y = 0.8f},
        {.position = {0.1, 0.3, 3.0}, .forward = {0.05f, -0.02f, -1}, .fov_y = 0.8f}};
    c[0].near_distance = c[1].near_distance = 0.1f;
    take_static("test_sphere_sdf", depth[0], velocity[0], c, "sdf_velocity_alone");
    take_static("test_sphere_static", depth[1], velocity[1], c, "static_velocity_alone");
    assert_memory_equal(depth[0], depth[1], sizeof *depth);
    assert_memory_equal(velocity[0], velocity[1], sizeof *velocity);
    take_static("test_both", depth[0], velocity[0], c, "static_velocity");
    eye now = eye_of(&c[1]), was = eye_of(&c[0]);
    double worst = 0, longest = 0;
    uint32_t seen = 0;
    for (int i = 0; i < W * H; i++) {
        double x = i % W + 0.5, y = i / W + 0.5, px, py, pz, z = (double)depth[0][i];
        vec rel = ray_through(&now, x, y);
        if (z > 0) rel = vec_sub(vec_add(now.position, vec_scale(rel, z)), was.position);
        project(&was, rel, &px, &py, &pz);
        const uint16_t *v = &velocity[0][4 * i];
        worst = worst_of(worst, hypot(half_float(v[0]) - (px - x), half_float(v[1]) - (py - y)));
        worst = worst_of(worst, fabs(half_float(v[3]) - 1));
        longest = fmax(longest, hypot(px - x, py - y));
        seen += z > 0;
    }
    print_message("  longest motion %.2f px, error %.4f px\n", longest, worst);
    assert_true(seen > W * H / 10 && seen < W * H && longest > 3 && worst < 0.02);
}

static void who_does_not_ask_has_no_velocities(void **state) {
    (void)state;
    masu_session s;
    masu_plan_info plan;
    masu_session_desc d = test_desc("test_velocity", W, H);
    d.desc.readback = MASU_READBACK_DEPTH;
    open_session(&s, &d);
    masu_plan_of(s.m, &plan);
    uint32_t found = 0;
    for (uint32_t i = 0; i < plan.pass_count; i++) {
        if (!strstr(plan.passes[i].name, "velocity") && !strstr(plan.passes[i].name, "previous"))
            continue;
        found++;
        assert_int_equal(plan.passes[i].active, 0);
        assert_string_equal(plan.passes[i].why, "nothing reads velocities");
    }
    assert_int_equal(found, 7);
    for (uint32_t i = 0; i < plan.image_count; i++) {
        if (strcmp(plan.images[i].name, "velocity") != 0) continue;
        assert_int_equal(plan.images[i].used, 0);
        assert_int_equal(plan.images[i].bytes, 0);
    }
    uint64_t without = s.need.host_bytes;
    close_session(&s);
    d.desc.readback |= MASU_READBACK_VELOCITY;
    open_session(&s, &d);
    assert_true(s.need.host_bytes > without);
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_moving_camera_moves_polygons_sdf_and_sky),
        cmocka_unit_test(what_moves_and_what_changes_is_followed),
        cmocka_unit_test(polygons_alone_have_velocities),
        cmocka_unit_test(a_cut_forgets_the_frame_before),
        cmocka_unit_test(a_point_that_was_behind_the_camera_says_so),
        cmocka_unit_test(a_field_by_hand_is_followed_along_its_normal),
        cmocka_unit_test(a_static_field_moves_by_the_camera_alone),
        cmocka_unit_test(who_does_not_ask_has_no_velocities),
    };
    return cmocka_run_group_tests_name("velocity", tests, make_truth, remove_truth);
}

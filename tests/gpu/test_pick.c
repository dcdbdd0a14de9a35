/* test_pick.c: the results of desc.picking against rays that this file traces through every
 * triangle of every instance, at the transform of masu_instance_get; and picked positions against
 * the depth that is read back. A ray that passes an edge within a pixel may hit either side: such
 * pixels are counted. */
#include "support/support.h"
#include "support/files.h"
#include "reference/vec.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 160, H = 90, MOST = 128 };

/* ---- Rays ------------------------------------------------------------------------------------ */

typedef struct world {
    masu_scene_view v;
    uint32_t instances;
    masu_instance_state at[MOST];
} world;

/* The scene a second time: the session has freed its blob. */
static void *blob;
static masu_scene scene;

static world look_around(masu_session *s) {
    world w = {.v = masu_scene_view_of(&scene),
               .instances = masu_scene_count(&scene, MASU_SCENE_INSTANCE)};
    assert_in_range(w.instances, 0, MOST);
    for (uint32_t i = 0; i < w.instances; i++)
        assert_int_equal(masu_instance_get(s->m, masu_instance_at(s->m, i), &w.at[i], &failure),
                         MASU_OK);
    return w;
}

static vec placed(const float rows[12], const float p[3]) {
    double out[3];
    for (int k = 0; k < 3; k++) {
        out[k] = (double)rows[4 * k + 3];
        for (int j = 0; j < 3; j++) out[k] += (double)rows[4 * k + j] * (double)p[j];
    }
    return (vec){out[0], out[1], out[2]};
}

static int meets_box(const masu_instance_state *s, vec from, vec along) {
    const double o[3] = {from.x, from.y, from.z}, d[3] = {along.x, along.y, along.z};
    double in = 0, out = 1e30;
    for (int k = 0; k < 3; k++) {
        double a = ((double)s->box_low[k] - 1e-6 - o[k]) / d[k],
               b = ((double)s->box_high[k] + 1e-6 - o[k]) / d[k];
        in = fmax(in, fmin(a, b));
        out = fmin(out, fmax(a, b));
    }
    return in <= out;
}

/* Distance in units of `along`; 1e30: no hit. */
static double meets_triangle(const vec p[3], vec from, vec along) {
    vec e = vec_sub(p[1], p[0]), f = vec_sub(p[2], p[0]), q = vec_cross(along, f);
    double det = vec_dot(e, q);
    if (!(fabs(det) > 1e-300)) return 1e30;
    vec s = vec_sub(from, p[0]), r = vec_cross(s, e);
    double u = vec_dot(s, q) / det, v = vec_dot(along, r) / det, t = vec_dot(f, r) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 ? t : 1e30;
}

typedef struct hit {
    uint32_t instance; /* UINT32_MAX: none */
    int blended;
    double z;
} hit;

/* `along` has a view z of 1. */
static hit cast(const world *w, vec from, vec along, double near_distance) {
    hit best = {UINT32_MAX, 0, 1e30};
    for (uint32_t i = 0; i < w->instances; i++) {
        const masu_instance_state *at = &w->at[i];
        const masu_blob_mesh *mesh = &w->v.meshes[at->mesh];
        if (!at->shown || !meets_box(at, from, along)) continue;
        for (uint32_t k = 0; k < mesh->primitive_count; k++) {
            const masu_blob_primitive *p = &w->v.primitives[mesh->first_primitive + k];
            for (uint32_t n = 0; n < p->index_count; n += 3) {
                vec corner[3];
                for (uint32_t c = 0; c < 3; c++) {
                    uint32_t vertex = p->first_vertex + w->v.indices[p->first_index + n + c];
                    corner[c] = placed(at->rows, w->v.vertices[vertex].position);
                }
                double z = meets_triangle(corner, from, along);
                if (z < best.z && z >= near_distance)
                    best = (hit){
                        i, (w->v.materials[p->material].flags & MASU_MATERIAL_IS_BLEND) != 0, z};
            }
        }
    }
    return best;
}

typedef struct lens {
    vec eye, forward, right, up; /* right and up times the tangents */
    double width, height, near_distance;
} lens;

static lens lens_of(const masu_camera *c, double width, double height, double aspect) {
    vec f = vec_unit(vec_of(c->forward)), r = vec_unit(vec_cross(f, (vec){0, 1, 0})),
        u = vec_cross(r, f);
    double tangent = tan((double)c->fov_y / 2);
    return (lens){{c->position[0], c->position[1], c->position[2]},
                  f,
                  vec_scale(r, tangent * aspect),
                  vec_scale(u, tangent),
                  width,
                  height,
                  (double)c->near_distance};
}

/* Ray through a position at the render size, in pixels. */
static vec ray_of(const lens *l, double x, double y) {
    return vec_add(l->forward, vec_add(vec_scale(l->right, 2 * x / l->width - 1),
                                       vec_scale(l->up, 1 - 2 * y / l->height)));
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

typedef struct tally {
    uint32_t pixels, sky, sdf, instances, blended, edges;
    uint32_t of[MOST];
} tally;

static masu_pick_info pick_at(masu_session *s, masu_frame_desc frame, uint32_t x, uint32_t y,
                              masu_commands *commands) {
    masu_pick_info info;
    frame.pick = 1, frame.pick_x = x, frame.pick_y = y;
    draw(s, &frame, commands, NULL);
    assert_int_equal(masu_pick(s->m, commands->slot, &info, &failure), MASU_OK);
    assert_int_equal(info.frame, commands->frame);
    assert_int_equal(info.x, x);
    assert_int_equal(info.y, y);
    return info;
}

/* Whether a ray within a pixel of this one hits that instance (UINT32_MAX: none). */
static int is_near(const world *w, const lens *l, double x, double y, uint32_t instance) {
    for (int i = 0; i < 81; i++) {
        vec along = ray_of(l, x + (i % 9 - 4) / 4.0, y + (i / 9 - 4) / 4.0);
        if (cast(w, l->eye, along, l->near_distance).instance == instance) return 1;
    }
    return 0;
}

/* Compares one pixel of a frame with a ray. slack: relative depth difference allowed for the LOD,
 * and for the driver's vertex grid: SwiftShader's is a sixteenth of a pixel, which matters on the
 * ground. */
static void check_pixel(masu_session *s, const world *w, const lens *l,
                        const masu_frame_desc *frame, uint32_t x, uint32_t y, double scale,
                        double slack, tally *t) {
    masu_commands commands;
    masu_pick_info info = pick_at(s, *frame, x, y, &commands);
    masu_readback_image image;
    assert_int_equal(masu_readback(s->m, commands.slot, MASU_READBACK_DEPTH, &image, &failure),
                     MASU_OK);
    uint32_t px = (uint32_t)((x + 0.5) * scale), py = (uint32_t)((y + 0.5) * scale);
    float depth = ((const float *)image.pixels)[py * image.width + px];
    vec along = ray_of(l, px + 0.5, py + 0.5);
    hit truth = cast(w, l->eye, along, l->near_distance);
    double z = depth > 0 ? l->near_distance / (double)depth : 1e30;
    /* otherwise the SDF, or the sky */
    uint32_t expected = truth.z < z * (1 + slack) ? truth.instance : UINT32_MAX;
    uint32_t got = UINT32_MAX;
    for (uint32_t i = 0; i < w->instances && info.kind == MASU_PICK_INSTANCE; i++)
        if (masu_instance_at(s->m, i).id == info.instance.id) got = i;
    t->pixels++;
    t->sky += info.kind == MASU_PICK_SKY;
    t->sdf += info.kind == MASU_PICK_SDF;
    t->instances += info.kind == MASU_PICK_INSTANCE;
    if (got != UINT32_MAX) t->of[got]++;
    if (got != expected) {
        if (!is_near(w, l, px + 0.5, py + 0.5, got))
            fail_msg("pixel %u,%u: instance %d, expected %d", x, y, (int)got, (int)expected);
        t->edges++;
        return;
    }
    /* A sliver at an edge that only one of the two rasters has. */
    if (info.kind == MASU_PICK_INSTANCE && got == UINT32_MAX) {
        t->edges++;
        return;
    }
    if (got == UINT32_MAX) assert_int_equal(info.kind, depth > 0 ? MASU_PICK_SDF : MASU_PICK_SKY);
    if (got != UINT32_MAX && truth.blended) {
        t->blended++;
        assert_true(info.depth > depth);
    } else {
        assert_true(info.depth == depth); /* bit-identical */
    }
    if (info.kind == MASU_PICK_SKY) return;
    z = l->near_distance / (double)info.depth;
    vec p = vec_add(l->eye, vec_scale(along, z));
    vec off = vec_sub(p, (vec){info.position[0], info.position[1], info.position[2]});
    if (!(sqrt(vec_dot(off, off)) <= 1e-5 * z))
        fail_msg("pixel %u,%u: the point has an error of %g m", x, y, sqrt(vec_dot(off, off)));
    if (got != UINT32_MAX && !(fabs(z - truth.z) <= fmax(slack, whole_run() ? 1e-3 : 2e-3) * z))
        fail_msg("pixel %u,%u: depth %g, expected %g", x, y, z, truth.z);
}

/* A grid of pixels. */
static tally check_grid(masu_session *s, masu_frame_desc frame, double scale, double slack,
                        uint32_t step) {
    tally t;
    memset(&t, 0, sizeof t);
    world w = look_around(s);
    const VkExtent2D size = s->desc.output;
    masu_camera c;
    if (!frame.camera) {
        assert_int_equal(masu_camera_at(s->m, frame.time, &c, &failure), MASU_OK);
        c.near_distance = w.v.environment->near_distance;
        frame.camera = &c;
    }
    lens l = lens_of(frame.camera, round(size.width * scale), round(size.height * scale),
                     (double)size.width / size.height);
    for (uint32_t y = step / 2; y < size.height; y += step)
        for (uint32_t x = step / 2; x < size.width; x += step)
            check_pixel(s, &w, &l, &frame, x, y, scale, slack, &t);
    print_message("  %u pixels: %u sky, %u SDF, %u of instances, %u transparent; %u at edges\n",
                  t.pixels, t.sky, t.sdf, t.instances, t.blended, t.edges);
    assert_in_range(t.edges, 0, t.pixels / 20);
    return t;
}

/* Reflections take most of a frame and are not picked: only the second rung has them, and only on
 * the first driver. */
static void set_rungs(masu_session_desc *d) {
    masu_switch specular = whole_run() ? MASU_AUTO : MASU_OFF;
    d->desc.rung_count = 2;
    d->desc.rungs[0] = (masu_rung){.scale = 1, .specular = MASU_OFF};
    d->desc.rungs[1] = (masu_rung){.scale = 0.5f, .specular = specular};
}

static void open_reserve(masu_session *s, const char *name, uint32_t models) {
    masu_session_desc d = test_desc(name, W, H);
    masu_detail detail;
    size_t bytes;
    blob = read_file(scene_path(name), &bytes);
    if (masu_scene_bind(blob, bytes, &scene, &detail)) fail_msg("%s", detail.text);
    d.desc.picking = 1;
    d.desc.reserve.models = models;
    d.desc.readback = MASU_READBACK_DEPTH;
    set_rungs(&d);
    d.desc.debug.poison = 1;
    open_session(s, &d);
}

static void open_picking(masu_session *s, const char *name) { open_reserve(s, name, 0); }

static uint32_t index_of(masu_session *s, const char *name) {
    masu_instance_state state;
    assert_int_equal(masu_instance_get(s->m, masu_instance_find(s->m, name), &state, &failure),
                     MASU_OK);
    return state.index;
}

static void close_picking(masu_session *s) {
    free(blob);
    close_session(s);
}

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* Every eleventh pixel of a row and of a column; on drivers after the first every 17th, with some
 * of each kind. */
#define STEP trials(11, 11, 17)

static void polygons_sdf_and_sky_are_told_apart(void **state) {
    (void)state;
    masu_session s;
    open_picking(&s, "test_both");
    tally t =
        check_grid(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, 1, 1e-3, trials(11, 11, 15));
    assert_true(t.sky > 10 && t.sdf > 5 && t.instances > 5);
    close_picking(&s);
    open_picking(&s, "test_sphere_sdf"); /* no polygons at all */
    t = check_grid(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, 1, 1e-3, trials(11, 11, 15));
    assert_true(t.sky > 10 && t.sdf > 5 && !t.instances);
    close_picking(&s);
}

static void what_moves_hides_and_shines_through_is_found(void **state) {
    (void)state;
    masu_session s;
    open_picking(&s, "test_live");
    uint32_t pane = index_of(&s, "pane");
    tally t = check_grid(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, 1, 1e-3, STEP);
    assert_true(t.of[pane] > 0 && t.blended > 0 && t.instances > 20);
    masu_model truck = masu_model_find(s.m, "truck");
    const float rows[12] = {1, 0, 0, 0.5f, 0, 1, 0, 0.25f, 0, 0, 1, 1};
    assert_int_equal(masu_model_set_transform(s.m, truck, rows, &failure), MASU_OK);
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "pane"), 0, &failure), MASU_OK);
    assert_int_equal(masu_model_show(s.m, masu_model_find(s.m, "lamp"), 1, &failure), MASU_OK);
    t = check_grid(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, 1, 1e-3, STEP);
    assert_int_equal(t.of[pane], 0);
    assert_int_equal(t.blended, 0);
    close_picking(&s);
}

static void a_model_and_its_node_are_named(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    open_picking(&s, "test_live");
    masu_model truck = masu_model_find(s.m, "truck");
    masu_pick_info info =
        pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, 60, 38, &commands);
    assert_int_equal(info.kind, MASU_PICK_INSTANCE);
    assert_int_equal(info.model.id, truck.id);
    masu_node_state node;
    assert_int_equal(masu_model_node_get(s.m, truck, info.node, &node, &failure), MASU_OK);
    assert_int_equal(node.instance.id, info.instance.id);
    /* An instance outside all movable models has no node. */
    info = pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, 20, 80, &commands);
    assert_int_equal(info.instance.id, masu_instance_find(s.m, "floor").id);
    assert_int_equal(info.model.id, 0);
    assert_int_equal(info.node, MASU_NODE_NONE);
    close_picking(&s);
}

/* A copy added to another one's slot after the query is not the picked one. */
static void a_copy_that_came_later_is_not_named(void **state) {
    (void)state;
    const float far_off[12] = {1, 0, 0, 0, 0, 1, 0, 900, 0, 0, 1, 0};
    float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    masu_session s;
    masu_commands commands;
    masu_pick_info info;
    masu_model copies[3];
    masu_camera c;
    open_reserve(&s, "test_reserve", 2);
    masu_model block = masu_model_find(s.m, "block");
    assert_int_equal(masu_camera_at(s.m, 0, &c, &failure), MASU_OK);
    double length = sqrt((double)(c.forward[0] * c.forward[0] + c.forward[1] * c.forward[1] +
                                  c.forward[2] * c.forward[2]));
    for (uint32_t k = 0; k < 3; k++)
        rows[4 * k + 3] = (float)(c.position[k] + 3 * (double)c.forward[k] / length);
    assert_int_equal(masu_model_add(s.m, block, rows, &copies[0], &failure), MASU_OK);
    assert_int_equal(masu_model_add(s.m, block, far_off, &copies[1], &failure), MASU_OK);
    masu_model now =
        pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, W / 2, H / 2, &commands).model;
    assert_int_equal(now.id, copies[0].id);
    assert_int_equal(masu_model_remove(s.m, copies[1], &failure),
                     MASU_OK); /* another slot changes nothing */
    assert_int_equal(masu_model_add(s.m, block, far_off, &copies[1], &failure), MASU_OK);
    assert_int_equal(masu_pick(s.m, commands.slot, &info, &failure), MASU_OK);
    assert_int_equal(info.model.id, copies[0].id);
    assert_int_equal(masu_model_remove(s.m, copies[0], &failure), MASU_OK);
    assert_int_equal(masu_model_add(s.m, block, rows, &copies[2], &failure), MASU_OK);
    assert_int_equal(masu_pick(s.m, commands.slot, &info, &failure), MASU_OK);
    assert_int_equal(info.kind, MASU_PICK_INSTANCE);
    assert_int_equal(info.instance.id, 0);
    assert_int_equal(info.model.id, 0);
    now = pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .time = 0}, W / 2, H / 2, &commands).model;
    assert_int_equal(now.id, copies[2].id);
    close_picking(&s);
}

static void a_smaller_rung_picks_its_own_pixels(void **state) {
    (void)state;
    masu_session s;
    open_picking(&s, "test_live");
    (void)check_grid(&s, (masu_frame_desc){MASU_FRAME_DESC, .rung = 1}, 0.5, 0.02, 2 * STEP + 1);
    close_picking(&s);
}

static void lods_and_culling_change_nothing(void **state) {
    (void)state;
    masu_session s;
    open_picking(&s, "test_lods");
    masu_camera c = {
        .position = {0, 4, 20}, .forward = {0, -0.2f, -1}, .fov_y = 1, .near_distance = 0.1f};
    tally t = check_grid(&s, (masu_frame_desc){MASU_FRAME_DESC, .camera = &c}, 1, 0.05, 9 + 4);
    assert_true(t.instances > 20);
    close_picking(&s);
}

/* An alpha-tested surface is picked where it is opaque, not in its holes: where the image has
 * depth. */
static void holes_of_a_mask_are_not_picked(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    uint32_t there = 0, holes = 0;
    open_picking(&s, "test_foliage");
    masu_camera c = {
        .position = {1.5, 0, 4}, .forward = {0, 0, -1}, .fov_y = 0.7f, .near_distance = 0.005f};
    /* of the rows with alpha-tested surfaces, and some sky */
    for (uint32_t i = 0; i < trials(300, 300, 150); i++) {
        uint32_t x = i * 37 % W, y = 15 + i * 53 % 60;
        masu_pick_info info =
            pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .camera = &c}, x, y, &commands);
        float depth =
            ((const float *)read_image(&s, commands.slot, MASU_READBACK_DEPTH))[y * W + x];
        assert_true(info.depth == depth);
        assert_int_equal(info.kind, depth > 0 ? MASU_PICK_INSTANCE : MASU_PICK_SKY);
        double at = 1.5 + ((x + 0.5) / W * 2 - 1) * tan(0.35) * W / H * 4;
        holes += depth == 0 && fabs(at) < 1 && y > 25 && y < 65;
        if (depth == 0) continue;
        there++;
        assert_int_equal(info.instance.id,
                         masu_instance_find(s.m, at < 1.5 ? "needles" : "leaves").id);
    }
    print_message("  %u pixels of masks, %u holes\n", there, holes);
    assert_true(there > 10 && holes > 3);
    close_picking(&s);
}

/* Through the holes of an alpha-tested surface, the surface behind is picked. */
static void through_a_mask_what_is_behind_is_picked(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    uint32_t near = 0, behind = 0;
    const float rows[12] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, -1};
    open_picking(&s, "test_foliage");
    place_instance(&s, "leaves", rows); /* a metre behind the needles */
    masu_camera c = {
        .position = {0, 0, 4}, .forward = {0, 0, -1}, .fov_y = 0.5f, .near_distance = 0.005f};
    for (uint32_t i = 0; i < trials(400, 400, 200); i++) {
        uint32_t x = i * 37 % W, y = i * 53 % H;
        masu_pick_info info =
            pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .camera = &c}, x, y, &commands);
        float depth =
            ((const float *)read_image(&s, commands.slot, MASU_READBACK_DEPTH))[y * W + x];
        if (depth == 0) continue;
        int first = 0.005f / depth < 4.5f;
        near += first;
        behind += !first;
        assert_int_equal(info.instance.id,
                         masu_instance_find(s.m, first ? "needles" : "leaves").id);
    }
    print_message("  %u pixels of the first, %u behind it\n", near, behind);
    assert_true(near > 10 && behind > 3);
    close_picking(&s);
}

/* Skinned: the image shows skinned meshes next to the rigid floor and wall. */
static void what_bends_is_picked_where_it_is(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    uint32_t bent = 0, moved = 0;
    open_picking(&s, "test_skin");
    masu_model bear = masu_model_find(s.m, "bear");
    masu_clip_use use = {.clip = 0, .loop = 1, .time = 0.4, .weight = 1};
    assert_int_equal(masu_model_animate(s.m, bear, &use, 1, &failure), MASU_OK);
    world w = look_around(&s);
    masu_camera c;
    assert_int_equal(masu_camera_at(s.m, 0, &c, &failure), MASU_OK);
    c.near_distance = w.v.environment->near_distance;
    lens l = lens_of(&c, W, H, (double)W / H);
    for (uint32_t i = 0; i < w.instances; i++) w.at[i].shown = 0; /* only the rigid ones */
    uint32_t rigid[2] = {index_of(&s, "floor"), index_of(&s, "wall")};
    for (uint32_t i = 0; i < 2; i++) w.at[rigid[i]].shown = 1;
    for (uint32_t i = 0; i < trials(150, 150, 50); i++) { /* around the skinned meshes */
        uint32_t x = 56 + i * 37 % 54, y = 22 + i * 29 % 38;
        masu_pick_info info =
            pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .camera = &c}, x, y, &commands);
        float depth =
            ((const float *)read_image(&s, commands.slot, MASU_READBACK_DEPTH))[y * W + x];
        assert_true(info.depth == depth);
        if (depth == 0) continue;
        hit behind = cast(&w, l.eye, ray_of(&l, x + 0.5, y + 0.5), l.near_distance);
        double z = l.near_distance / (double)depth;
        if (behind.z < z * 1.001) {
            assert_int_equal(info.instance.id, masu_instance_at(s.m, behind.instance).id);
        } else {
            bent++;
            moved += info.model.id == bear.id;
            assert_int_equal(info.kind, MASU_PICK_INSTANCE);
            assert_true(info.instance.id != masu_instance_at(s.m, rigid[0]).id &&
                        info.instance.id != masu_instance_at(s.m, rigid[1]).id);
            assert_int_not_equal(info.model.id, 0);
        }
    }
    print_message("  %u pixels of skinned meshes, %u of the bear\n", bent, moved);
    assert_true(bent > 10 && moved > 3);
    close_picking(&s);
}

/* ---- Viewports and windows ------------------------------------------------------------------- */

static void a_part_of_the_output_has_pixels_of_its_own(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc session = test_desc("test_live", W, H);
    session.no_renderer = true;
    open_session(&s, &session);
    masu_desc d = s.desc;
    own_renderer x;
    char error[ERROR_SIZE];
    d.scene = &s.scene;
    d.targets.storage = 0;
    d.picking = 1;
    d.rung_count = 1;
    d.rungs[0] = (masu_rung){.scale = 1};
    d.viewport_count = 2;
    d.viewports[0] = (masu_viewport){0, 0, 80, 90};
    d.viewports[1] = (masu_viewport){80, 10, 60, 60};
    make_own(&s, &x, &d);
    masu_camera c = {
        .position = {-1.5, 1, 6}, .forward = {0, 0, -1}, .fov_y = 0.6f, .near_distance = 0.05f};
    masu_commands commands;
    masu_pick_info info[2];
    for (uint32_t v = 0; v < 2; v++) { /* in flight at once: each slot has its own answer */
        masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &c, .viewport = v,
                                 .pick = 1,       .pick_x = 30, .pick_y = v ? 12 : 55};
        assert_int_equal(masu_frame(x.m, &frame, &commands, &failure), MASU_OK);
        assert_ok(masu_headless_run(&s.host, commands.buffer, error, sizeof error));
        assert_int_equal(commands.slot, v);
    }
    for (uint32_t v = 0; v < 2; v++)
        assert_int_equal(masu_pick(x.m, v, &info[v], &failure), MASU_OK);
    assert_int_equal(info[0].model.id, masu_model_find(x.m, "truck").id);
    assert_int_equal(info[1].instance.id, masu_instance_find(x.m, "wall").id);
    assert_true(fabs(info[1].position[2] - -3.85) < 1e-3);
    masu_frame_desc frame = {MASU_FRAME_DESC, .camera = &c, .viewport = 1,
                             .pick = 1,       .pick_x = 60, .pick_y = 0};
    assert_int_equal(masu_frame(x.m, &frame, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(
        failure.text, "pick_x, pick_y is 60, 0, allowed are pixels of the output, which is 60x60");
    unmake_own(&s, &x);
    close_session(&s);
}

/* An off-centre window: the image's centre is not on the camera's axis. */
static void a_window_of_its_own_is_picked_through(void **state) {
    (void)state;
    masu_session s;
    masu_commands commands;
    open_picking(&s, "test_both");
    masu_camera c = {.position = {0, 0, 4}, .forward = {0, 0, -1}, .near_distance = 0.1f};
    for (int side = 0; side < 2; side++) {
        c.left = side ? 0.01f : -0.3f, c.right = side ? 0.61f : 0.3f, c.bottom = -0.2f,
        c.top = 0.2f;
        uint32_t x = side ? 0 : W / 2;
        masu_pick_info info =
            pick_at(&s, (masu_frame_desc){MASU_FRAME_DESC, .camera = &c}, x, H / 2, &commands);
        float depth =
            ((const float *)read_image(&s, commands.slot, MASU_READBACK_DEPTH))[H / 2 * W + x];
        assert_true(depth > 0 && info.depth == depth);
        double slope = (double)c.left + (x + 0.5) / W * 0.6;
        assert_true(fabs(info.position[0] - slope * (4 - info.position[2])) < 1e-4);
    }
    close_picking(&s);
}

static void what_is_not_asked_is_not_told(void **state) {
    (void)state;
    static uint8_t with[W * H * 4], without[W * H * 4];
    masu_session s;
    masu_commands commands;
    masu_pick_info info;
    open_picking(&s, "test_live");
    assert_int_equal(masu_pick(s.m, 0, &info, &failure), MASU_INCOMPLETE);
    draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .time = 0}, &commands, without);
    assert_int_equal(masu_pick(s.m, commands.slot, &info, &failure), MASU_OK);
    assert_int_equal(info.kind, MASU_PICK_NOTHING);
    assert_int_equal(info.instance.id, 0);
    assert_int_equal(masu_pick(s.m, 9, &info, &failure), MASU_ERROR_ARGUMENT);
    masu_frame_desc beyond = {MASU_FRAME_DESC, .pick = 1, .pick_x = 3, .pick_y = H};
    assert_int_equal(masu_frame(s.m, &beyond, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.what, "pick_x");
    close_picking(&s);
    /* Enabled picking changes no pixel; without it, a pick is an error. */
    masu_session_desc d = test_desc("test_live", W, H);
    d.desc.readback = MASU_READBACK_DEPTH;
    set_rungs(&d);
    open_session(&s, &d);
    draw(&s, &(masu_frame_desc){MASU_FRAME_DESC, .time = 0}, &commands, with);
    assert_memory_equal(with, without, sizeof with);
    assert_int_equal(masu_pick(s.m, commands.slot, &info, &failure), MASU_ERROR_ARGUMENT);
    masu_frame_desc asks = {MASU_FRAME_DESC, .pick = 1};
    assert_int_equal(masu_frame(s.m, &asks, &commands, &failure), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "pick is set, needed is desc.picking");
    close_session(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(polygons_sdf_and_sky_are_told_apart),
        cmocka_unit_test(what_moves_hides_and_shines_through_is_found),
        cmocka_unit_test(a_model_and_its_node_are_named),
        cmocka_unit_test(a_copy_that_came_later_is_not_named),
        cmocka_unit_test(a_smaller_rung_picks_its_own_pixels),
        cmocka_unit_test(lods_and_culling_change_nothing),
        cmocka_unit_test(holes_of_a_mask_are_not_picked),
        cmocka_unit_test(through_a_mask_what_is_behind_is_picked),
        cmocka_unit_test(what_bends_is_picked_where_it_is),
        cmocka_unit_test(a_part_of_the_output_has_pixels_of_its_own),
        cmocka_unit_test(a_window_of_its_own_is_picked_through),
        cmocka_unit_test(what_is_not_asked_is_not_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

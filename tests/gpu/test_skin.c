/* test_skin.c: skinned meshes: positions of their vertices against Assimp's bones and keys in
 * double precision; positions in the previous frame; pixel velocities, the difference of both; and
 * image, shadow and reflection, equal to those of a mesh baked in that pose. */
#include "support/files.h"
#include "support/floats.h"
#include "support/posed.h"
#include "support/support.h"

#include "device/bind.h"
#include "renderer.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 240, H = 136, PIXELS = W * H };

#define MODELS "/usr/share/assimp/models/"
#define ARM MODELS "glTF2/simple_skin/simple_skin.gltf"
#define BEAR MODELS "X/Testwuson.X"

static double length_of(vec v) { return sqrt(vec_dot(v, v)); }

static masu_session_desc desc_of(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f};
    d.desc.readback = MASU_READBACK_DEPTH | MASU_READBACK_VELOCITY | MASU_READBACK_OCCLUSION;
    return d;
}

static masu_model model_of(masu_session *s, const char *name) {
    masu_model model = masu_model_find(s->m, name);
    assert_int_not_equal(model.id, 0);
    return model;
}

static void pose(masu_session *s, const char *name, uint32_t clip, double time) {
    const masu_clip_use use = {.clip = clip, .time = time, .weight = 1.0f};
    if (masu_model_animate(s->m, model_of(s, name), &use, 1, &failure))
        fail_msg("%s", failure.text);
}

static masu_commands frame(masu_session *s, uint32_t cut, uint8_t *pixels) {
    masu_commands commands;
    draw(s, &(masu_frame_desc){.cut = cut, .time_step = 1.0f / 60}, &commands, pixels);
    return commands;
}

/* ---- Vertices as the device has them --------------------------------------------------------- */

/* The skin of a model: its first of SKINS. */
static const masu_skin *skin_of(masu_session *s, const char *name) {
    masu_model_state state;
    uint32_t first;
    assert_int_equal(masu_model_get(s->m, model_of(s, name), &state, &failure), MASU_OK);
    assert_int_equal(masu_skins_of(&s->m->models.skins, &s->m->plan, state.index, &first), 1);
    return &s->m->models.skins.skins[first];
}

/* Software drivers have one memory: the host reads the results of a finished frame. */
static const void *device_bytes(masu_session *s, masu_buffer_id buffer) {
    const void *bytes = masu_buffer_pointer(&s->m->device, buffer, 0);
    assert_non_null(bytes);
    return bytes;
}

static const masu_blob_vertex *bent(masu_session *s, const masu_skin *skin) {
    return (const masu_blob_vertex *)device_bytes(s, MASU_BUFFER_VERTICES) + skin->first_vertex;
}

static const masu_blob_skin_vertex *rest(masu_session *s, const masu_skin *skin) {
    return (const masu_blob_skin_vertex *)device_bytes(s, MASU_BUFFER_SKIN_VERTICES) +
           skin->first_skin_vertex;
}

static const float *earlier(masu_session *s, const masu_skin *skin) {
    return (const float *)device_bytes(s, MASU_BUFFER_PREVIOUS_VERTICES) +
           3 * (skin->first_vertex - s->m->plan.scene.first_skinned);
}

static vec decoded(const int16_t normal[2]) {
    double x = normal[0] / 32767.0, y = normal[1] / 32767.0, z = 1 - fabs(x) - fabs(y);
    if (z < 0) {
        double folded = (1 - fabs(y)) * (x < 0 ? -1 : 1);
        y = (1 - fabs(x)) * (y < 0 ? -1 : 1);
        x = folded;
    }
    return vec_unit((vec){x, y, z});
}

/* Size of a metre of the file in the scene. */
static double scale_of(masu_session *s, const masu_skin *skin) {
    float rows[12];
    masu_instance_rows(&s->m->instances.now[skin->instance], rows);
    return sqrt((double)rows[0] * (double)rows[0] + (double)rows[4] * (double)rows[4] +
                (double)rows[8] * (double)rows[8]);
}

/* The session has already freed its copy of the blob. */
static masu_scene_view blob_of(void **blob) {
    masu_scene scene;
    masu_detail detail;
    size_t bytes;
    *blob = read_file(scene_path("test_skin"), &bytes);
    assert_int_equal(masu_scene_bind(*blob, bytes, &scene, &detail), MASU_OK);
    return masu_scene_view_of(&scene);
}

static void check_pose(masu_session *s, const char *name, const char *path, uint32_t clip,
                       double time) {
    const masu_skin *skin = skin_of(s, name);
    const masu_blob_vertex *vertices = bent(s, skin);
    posed truth = posed_at(path, clip, time);
    double worst = 0, moved = 0, turned = 0;
    for (uint32_t i = 0; i < skin->vertex_count; i++) {
        const float *from = rest(s, skin)[i].rest.position;
        vec at = vec_of(vertices[i].position);
        const posed_vertex *v = posed_find(&truth, from, at, decoded(vertices[i].normal));
        assert_non_null(v);
        worst = fmax(worst, length_of(vec_sub(v->position, at)));
        moved = fmax(moved, length_of(vec_sub(v->position, vec_of(from))));
        if (vec_dot(v->normal, v->normal) > 0.5)
            turned = fmax(turned, acos(fmin(vec_dot(v->normal, decoded(vertices[i].normal)), 1)));
    }
    free(truth.vertices);
    double metres = scale_of(s, skin);
    printf("  %s, clip %u at %.2f s of %.2f: %u vertices, at most %.2g m off of %.2g m moved, "
           "normals %.2g rad\n",
           name, clip, time, truth.duration, skin->vertex_count, worst * metres, moved * metres,
           turned);
    assert_true(worst * metres < 1e-4);
    assert_true(moved * metres > 0.05);
    assert_true(turned < 2e-3);
}

static void vertices_are_where_their_bones_put_them(void **state) {
    (void)state;
    static const struct {
        const char *name, *path;
        uint32_t clip;
        double times[4];
    } rows[] = {{"arm", ARM, 0, {0.3, 0.7, 1.25, 2.6}}, {"bear", BEAR, 0, {0.1, 0.5, 0.77, 1.1}}};
    masu_session s;
    masu_session_desc d = desc_of("test_skin");
    open_session(&s, &d);
    if (s.m->plan.staged) skip();
    for (size_t r = 0; r < sizeof rows / sizeof *rows; r++) {
        for (int t = 0; t < 4; t++) {
            pose(&s, rows[r].name, rows[r].clip, rows[r].times[t]);
            frame(&s, 0, NULL);
            check_pose(&s, rows[r].name, rows[r].path, rows[r].clip, rows[r].times[t]);
        }
    }
    close_session(&s);
}

/* Two copies, each in its own pose; both are equal in the bind pose. */
static void a_copy_has_a_pose_of_its_own(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_skin");
    masu_model added;
    const float beside[12] = {1, 0, 0, -3, 0, 1, 0, 0, 0, 0, 1, 0};
    open_session(&s, &d);
    if (s.m->plan.staged) skip();
    assert_int_equal(masu_model_add(s.m, model_of(&s, "arm"), beside, &added, &failure), MASU_OK);
    pose(&s, "arm", 0, 0.7);
    pose(&s, "arm.1", 0, 3.3);
    frame(&s, 0, NULL);
    check_pose(&s, "arm", ARM, 0, 0.7);
    check_pose(&s, "arm.1", ARM, 0, 3.3);
    assert_int_equal(masu_model_animate(s.m, model_of(&s, "arm"), NULL, 0, &failure), MASU_OK);
    assert_int_equal(masu_model_animate(s.m, added, NULL, 0, &failure), MASU_OK);
    frame(&s, 0, NULL);
    const masu_skin *one = skin_of(&s, "arm"), *two = skin_of(&s, "arm.1");
    assert_memory_equal(bent(&s, one), bent(&s, two), one->vertex_count * sizeof(masu_blob_vertex));
    close_session(&s);
}

/* ---- The previous frame ---------------------------------------------------------------------- */

static void positions(masu_session *s, const masu_skin *skin, float *out) {
    for (uint32_t i = 0; i < skin->vertex_count; i++)
        memcpy(out + 3 * i, bent(s, skin)[i].position, 3 * sizeof *out);
}

static void the_frame_before_is_kept_to_the_bit(void **state) {
    (void)state;
    static float were[3 * 4096], are[3 * 4096];
    masu_session s;
    masu_session_desc d = desc_of("test_skin");
    open_session(&s, &d);
    if (s.m->plan.staged) skip();
    const masu_skin *skin = skin_of(&s, "bear");
    size_t bytes = 3 * skin->vertex_count * sizeof *were;
    for (uint32_t i = 0; i < 6; i++) {
        if (i != 3) pose(&s, "bear", 0, 0.2 + 0.05 * i); /* the fourth frame is stationary */
        frame(&s, i == 5, NULL);
        positions(&s, skin, are);
        if (i && i < 5) assert_memory_equal(earlier(&s, skin), were, bytes);
        /* and not after a cut */
        if (i == 3 || i == 5) assert_memory_equal(earlier(&s, skin), are, bytes);
        if (i && i != 3) assert_memory_not_equal(are, were, bytes);
        memcpy(were, are, bytes);
    }
    /* A model that is shown again has not moved, wherever it was. */
    assert_int_equal(masu_model_show(s.m, model_of(&s, "bear"), 0, &failure), MASU_OK);
    frame(&s, 0, NULL);
    pose(&s, "bear", 0, 0.9);
    assert_int_equal(masu_model_show(s.m, model_of(&s, "bear"), 1, &failure), MASU_OK);
    frame(&s, 0, NULL);
    positions(&s, skin, are);
    assert_memory_equal(earlier(&s, skin), are, bytes);
    close_session(&s);
}

/* ---- Velocity -------------------------------------------------------------------------------- */

static vec placed(masu_session *s, const masu_skin *skin, const float *p) {
    float rows[12];
    masu_instance_rows(&s->m->instances.now[skin->instance], rows);
    vec v = vec_of(p), out;
    double *to[3] = {&out.x, &out.y, &out.z};
    for (int k = 0; k < 3; k++) {
        *to[k] = (double)rows[4 * k] * v.x + (double)rows[4 * k + 1] * v.y +
                 (double)rows[4 * k + 2] * v.z + (double)rows[4 * k + 3];
    }
    return out;
}

typedef struct seen {
    vec eye, right, up, ahead;
    double tan_x, tan_y;
} seen;

static seen look(masu_session *s) {
    masu_camera c;
    assert_int_equal(masu_camera_at(s->m, 0, &c, &failure), MASU_OK);
    seen e = {.eye = {c.position[0], c.position[1], c.position[2]},
              .ahead = vec_unit(vec_of(c.forward)),
              .tan_y = tan((double)c.fov_y / 2)};
    e.tan_x = e.tan_y * W / H;
    e.right = vec_unit(vec_cross(e.ahead, (vec){0, 1, 0}));
    e.up = vec_cross(e.right, e.ahead);
    return e;
}

static void project(const seen *e, vec p, double out[3]) {
    vec rel = vec_sub(p, e->eye);
    out[2] = vec_dot(rel, e->ahead);
    out[0] = (vec_dot(rel, e->right) / out[2] / e->tan_x + 1) * W / 2;
    out[1] = (1 - vec_dot(rel, e->up) / out[2] / e->tan_y) * H / 2;
}

/* Perspective-correct barycentric coordinates at a pixel's centre; 0: outside the triangle. */
static int shares_at(const double c[3][3], double x, double y, double out[3]) {
    double area = (c[1][0] - c[0][0]) * (c[2][1] - c[0][1]) -
                  (c[2][0] - c[0][0]) * (c[1][1] - c[0][1]),
           sum = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = c[(k + 1) % 3], *b = c[(k + 2) % 3];
        double own = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area;
        if (!(own > 0.02)) return 0; /* rasterisers differ at edges */
        out[k] = own / c[k][2];
        sum += out[k];
    }
    for (int k = 0; k < 3; k++) out[k] /= sum;
    return 1;
}

static void a_velocity_is_the_difference_of_positions(void **state) {
    (void)state;
    masu_session s;
    masu_session_desc d = desc_of("test_skin");
    open_session(&s, &d);
    if (s.m->plan.staged) skip();
    const masu_skin *skin = skin_of(&s, "arm");
    seen e = look(&s);
    pose(&s, "arm", 0, 0.9);
    frame(&s, 1, NULL);
    pose(&s, "arm", 0, 0.8);
    masu_commands commands = frame(&s, 0, NULL);
    const uint16_t *velocity = read_image(&s, commands.slot, MASU_READBACK_VELOCITY);
    const float *depth = read_image(&s, commands.slot, MASU_READBACK_DEPTH);
    masu_camera camera;
    static float z[PIXELS];
    assert_int_equal(masu_camera_at(s.m, 0, &camera, &failure), MASU_OK);
    camera.near_distance = 0.1f; /* as in the scene */
    view_depths(depth, &camera, z, PIXELS);
    const uint32_t *indices = (const uint32_t *)device_bytes(&s, MASU_BUFFER_INDICES);
    void *blob;
    masu_scene_view v = blob_of(&blob);
    const masu_blob_mesh *mesh = &v.meshes[v.instances[skin->instance].mesh];
    const masu_blob_primitive *p = &v.primitives[mesh->first_primitive];
    double worst = 0, most = 0;
    uint32_t checked = 0;
    for (uint32_t t = 0; t < p->index_count; t += 3) {
        double now[3][3], share[3], was[3];
        vec before[3];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t vertex = indices[p->first_index + t + k];
            project(&e, placed(&s, skin, bent(&s, skin)[vertex].position), now[k]);
            before[k] = placed(&s, skin, earlier(&s, skin) + 3 * vertex);
        }
        for (uint32_t i = 0; i < PIXELS; i++) {
            if (!shares_at((const double(*)[3])now, i % W + 0.5, i / W + 0.5, share)) continue;
            double own = share[0] * now[0][2] + share[1] * now[1][2] + share[2] * now[2][2];
            if (fabs(own - (double)z[i]) > 1e-3 * own) continue; /* another surface is in front */
            project(
                &e,
                vec_add(vec_scale(before[0], share[0]),
                        vec_add(vec_scale(before[1], share[1]), vec_scale(before[2], share[2]))),
                was);
            double x = half_float(velocity[4 * i]), y = half_float(velocity[4 * i + 1]);
            worst = fmax(worst, hypot(x - (was[0] - (i % W + 0.5)), y - (was[1] - (i / W + 0.5))));
            most = fmax(most, hypot(x, y));
            checked++;
        }
    }
    free(blob);
    printf("  %u pixels, velocities up to %.2f pixels, at most %.4f off\n", checked, most, worst);
    assert_true(checked > 500);
    assert_true(most > 2.0);
    assert_true(worst < 0.03);
    /* Stationary surfaces have a velocity of 0. */
    commands = frame(&s, 0, NULL);
    velocity = read_image(&s, commands.slot, MASU_READBACK_VELOCITY);
    for (uint32_t i = 0; i < PIXELS; i++) assert_true(half_float(velocity[4 * i]) == 0.0);
    close_session(&s);
}

/* ---- Shadow and mirror ----------------------------------------------------------------------- */

/* Writes the pose of both skins as files to bake. */
static void write_pose(masu_session *s, const char *name, const char *file) {
    static char text[1 << 20];
    const masu_skin *skin = skin_of(s, name);
    const uint32_t *indices = (const uint32_t *)device_bytes(s, MASU_BUFFER_INDICES);
    void *blob;
    masu_scene_view v = blob_of(&blob);
    const masu_blob_mesh *mesh = &v.meshes[v.instances[skin->instance].mesh];
    size_t used = 0;
    for (uint32_t i = 0; i < skin->vertex_count; i++) {
        const masu_blob_vertex *at = &bent(s, skin)[i];
        vec p = placed(s, skin, at->position), n = decoded(at->normal);
        float rows[12];
        masu_instance_rows(&s->m->instances.now[skin->instance], rows);
        vec w = {(double)rows[0] * n.x + (double)rows[1] * n.y + (double)rows[2] * n.z,
                 (double)rows[4] * n.x + (double)rows[5] * n.y + (double)rows[6] * n.z,
                 (double)rows[8] * n.x + (double)rows[9] * n.y + (double)rows[10] * n.z};
        w = vec_unit(w); /* uniformly scaled */
        used +=
            (size_t)snprintf(text + used, sizeof text - used,
                             "v %.9g %.9g %.9g\nvn %.9g %.9g %.9g\n", p.x, p.y, p.z, w.x, w.y, w.z);
    }
    for (uint32_t k = 0; k < mesh->primitive_count; k++) {
        const masu_blob_primitive *p = &v.primitives[mesh->first_primitive + k];
        for (uint32_t t = 0; t < p->index_count; t += 3) {
            uint32_t c[3];
            for (int i = 0; i < 3; i++)
                c[i] = indices[p->first_index + t + (uint32_t)i] + p->first_vertex -
                       skin->first_vertex + 1;
            used += (size_t)snprintf(text + used, sizeof text - used, "f %u//%u %u//%u %u//%u\n",
                                     c[0], c[0], c[1], c[1], c[2], c[2]);
        }
    }
    free(blob);
    assert_true(used < sizeof text - 1);
    write_text(file, text);
}

typedef struct picture {
    uint8_t rgba[4 * PIXELS];
    float depth[PIXELS];
    uint32_t occlusion[PIXELS];
} picture;

static void take(masu_session *s, picture *out) {
    masu_commands commands = {0};
    for (uint32_t i = 0; i < 12; i++) commands = frame(s, i == 0, out->rgba);
    memcpy(out->depth, read_image(s, commands.slot, MASU_READBACK_DEPTH), sizeof out->depth);
    memcpy(out->occlusion, read_image(s, commands.slot, MASU_READBACK_OCCLUSION),
           sizeof out->occlusion);
}

/* Pixels whose depth, sunlight, and colour differ. */
static void compare(const picture *a, const picture *b, uint32_t off[3]) {
    memset(off, 0, 3 * sizeof *off);
    for (uint32_t i = 0; i < PIXELS; i++) {
        int colour = 0;
        for (uint32_t k = 0; k < 3; k++)
            colour |= abs(a->rgba[4 * i + k] - b->rgba[4 * i + k]) > 12;
        off[0] += fabsf(a->depth[i] - b->depth[i]) > 1e-3f * fmaxf(a->depth[i], b->depth[i]);
        off[1] += fabs(sun_share(a->occlusion, i) - sun_share(b->occlusion, i)) > 0.25;
        off[2] += (uint32_t)colour;
    }
}

static void a_pose_looks_like_a_mesh_baked_so(void **state) {
    (void)state;
    static picture live, still, baked;
    static char json[4096], copy[2][256];
    masu_session s, t;
    masu_session_desc d = desc_of("test_skin");
    uint32_t off[3];
    open_session(&s, &d);
    if (s.m->plan.staged) skip();
    take(&s, &still);
    pose(&s, "arm", 0, 1.6);
    pose(&s, "bear", 0, 0.6);
    take(&s, &live);
    write_pose(&s, "arm", "arm.obj");
    write_pose(&s, "bear", "bear.obj");
    snprintf(copy[0], sizeof copy[0], "%s", in_scratch("arm.obj"));
    snprintf(copy[1], sizeof copy[1], "%s", in_scratch("bear.obj"));
    snprintf(
        json, sizeof json,
        "{\"models\": ["
        "{\"mesh\": {\"plane\": {\"size_x\": 16, \"size_z\": 16}}, \"material\": {\"base_color\": "
        "[0.6, 0.6, 0.6], \"roughness\": 0, \"metallic\": 1}},"
        "{\"mesh\": {\"box\": {\"size\": [10, 4, 0.2]}}, \"translate\": [0, 2, -1.5], "
        "\"material\": {\"base_color\": [0.6, 0.6, 0.5], \"roughness\": 0.9}},"
        "{\"file\": \"%s\", \"material\": {\"base_color\": [0.8, 0.3, 0.1], \"roughness\": 0.6}},"
        "{\"file\": \"%s\", \"material\": {\"base_color\": [0.5, 0.4, 0.3], \"roughness\": 0.7}}],"
        "\"camera\": {\"fov_y\": 50, \"near\": 0.1, \"keys\": [{\"time\": 0, \"position\": [0.4, "
        "2.0, 5.5], \"target\": [0, 0.8, 0]}]},"
        "\"sun\": {\"azimuth\": 30, \"elevation\": 40, \"shadows\": {\"cascades\": 2, "
        "\"resolution\": 1024, \"distance\": 20}},"
        "\"lods\": 0, \"reflections\": {}}",
        copy[0], copy[1]);
    close_session(&s);
    bake_scene("posed", json);
    d = desc_of(NULL);
    d.scene_path = baked_scene("posed");
    open_session(&t, &d);
    take(&t, &baked);
    close_session(&t);
    compare(&live, &still, off);
    printf("  from the rest pose: %u pixels differ in depth, %u in sunlight, %u in colour\n",
           off[0], off[1], off[2]);
    assert_true(off[0] > PIXELS / 60);
    assert_true(off[1] > PIXELS / 200);
    assert_true(off[2] > PIXELS / 40);
    compare(&live, &baked, off);
    printf("  difference from the baked pose: %u, %u, %u\n", off[0], off[1], off[2]);
    assert_true(off[0] < PIXELS / 1000);
    assert_true(off[1] < PIXELS / 200);
    assert_true(off[2] < PIXELS / 200);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(vertices_are_where_their_bones_put_them),
        cmocka_unit_test(a_copy_has_a_pose_of_its_own),
        cmocka_unit_test(the_frame_before_is_kept_to_the_bit),
        cmocka_unit_test(a_velocity_is_the_difference_of_positions),
        cmocka_unit_test(a_pose_looks_like_a_mesh_baked_so),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

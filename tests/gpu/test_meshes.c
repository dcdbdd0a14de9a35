/* test_meshes.c: meshes that the host creates at run time are the image of the same meshes in the scene: shaded,
 * textured, alpha-tested, in shadows, in mirrors, culled, picked and with their velocities; replaced, deformed and
 * removed a thousand times. A reserve that is not used changes no bit; its memory is as large as was said; what does not
 * fit is refused by name. */
#include "alloc_count.h"
#include "scene/scene.h"
#include "support/files.h"
#include "support/random.h"
#include "support/support.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static masu_detail failure; /* of the last call that failed */

enum { W = 120, H = 68, BYTES = W * H * 4, FRAMES = 4, VERTICES = 4096, TRIANGLES = 8192 };

static uint8_t pictures[3][FRAMES][BYTES];

/* A mesh of the scene, as a host would give it. */
typedef struct given {
    masu_mesh_data data;
    float positions[VERTICES][3], normals[VERTICES][3], texcoords[VERTICES][2];
    uint32_t indices[3 * TRIANGLES];
    float rows[12];
    uint32_t material;
} given;

static given ball, block, quad;

static masu_session_desc desc_of(const char *scene) {
    masu_session_desc d = test_desc(scene, W, H);
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1.0f, .lod_error = -1.0f};
    return d;
}

static void reserve(masu_session_desc *d, uint32_t kind, const given *g, uint32_t meshes) {
    d->desc.reserve.meshes[kind] = (masu_mesh_kind){.meshes = meshes,
                                                    .material = g->material,
                                                    .vertices = g->data.vertex_count,
                                                    .triangles = g->data.triangle_count};
}

/* Not of unit length: the octahedron's own, so that encoding it again is exact. */
static void decode(const int16_t from[2], float to[3]) {
    double x = from[0] / 32767.0, y = from[1] / 32767.0, z = 1 - fabs(x) - fabs(y), t = x;
    if (z < 0) {
        x = (1 - fabs(y)) * (x < 0 ? -1 : 1);
        y = (1 - fabs(t)) * (y < 0 ? -1 : 1);
    }
    to[0] = (float)x;
    to[1] = (float)y;
    to[2] = (float)z;
}

static void take(const masu_session *s, const char *name, given *g) {
    masu_scene_view v = masu_scene_data_view(masu_scene_data_of(&s->scene));
    int32_t i = masu_scene_find(&s->scene, MASU_SCENE_INSTANCE, name);
    assert_true(i >= 0);
    const masu_blob_mesh *mesh = &v.meshes[v.instances[i].mesh];
    const masu_blob_primitive *p = &v.primitives[mesh->first_primitive];
    assert_int_equal(mesh->primitive_count, 1);
    assert_true(p->vertex_count <= VERTICES && p->index_count <= 3 * TRIANGLES);
    memset(g, 0, sizeof *g);
    memcpy(g->rows, v.instances[i].transform, sizeof g->rows);
    g->material = p->material;
    for (uint32_t k = 0; k < p->vertex_count; k++) {
        const masu_blob_vertex *from = &v.vertices[p->first_vertex + k];
        memcpy(g->positions[k], from->position, sizeof g->positions[k]);
        decode(from->normal, g->normals[k]);
        if (v.texcoords)
            memcpy(g->texcoords[k], (const float *)v.texcoords + 2 * (p->first_vertex + k), 8);
    }
    memcpy(g->indices, v.indices + p->first_index, p->index_count * sizeof *g->indices);
    g->data = (masu_mesh_data){.positions = g->positions[0],
                               .normals = g->normals[0],
                               .texcoords = v.texcoords ? g->texcoords[0] : NULL,
                               .indices = g->indices,
                               .vertex_count = p->vertex_count,
                               .triangle_count = p->index_count / 3};
}

static void take_from(const char *scene, const char *name, given *g) {
    masu_session s;
    masu_session_desc d = desc_of(scene);
    d.no_renderer = true; /* the blob is freed once it is loaded */
    open_session(&s, &d);
    take(&s, name, g);
    close_session(&s);
}

static masu_model create(masu_session *s, uint32_t kind, const given *g) {
    masu_model out;
    if (masu_mesh_create(s->m, kind, &g->data, g->rows, &out, &failure))
        fail_msg("%s", failure.text);
    assert_true(out.id != 0);
    return out;
}

static void hide(masu_session *s, const char *name) {
    assert_int_equal(masu_instance_show(s->m, masu_instance_find(s->m, name), 0, &failure),
                     MASU_OK);
}

/* So many frames after a cut: reflections gather. */
static void draw_frames(masu_session *s, uint8_t out[FRAMES][BYTES]) {
    for (uint32_t i = 0; i < FRAMES; i++) {
        masu_commands commands;
        draw(s, &(masu_frame_desc){.cut = i == 0, .time_step = 1.0f / 60}, &commands, out[i]);
    }
}

static uint32_t far_off(const uint8_t *a, const uint8_t *b) {
    uint32_t off = 0;
    for (uint32_t i = 0; i < BYTES; i++) off += abs(a[i] - b[i]) > 4;
    return off;
}

/* ---- The image ------------------------------------------------------------------------------- */

/* An instance is hidden, and a mesh of the host is where it was. */
static void compare(const char *scene, const char *name, given *g, uint32_t flight,
                    uint32_t limit) {
    masu_session s;
    masu_session_desc d = desc_of(scene);
    d.desc.frames_in_flight = flight;
    take_from(scene, name, g);
    open_session(&s, &d);
    draw_frames(&s, pictures[1]);
    draw_frames(&s, pictures[1]);
    masu_stats_info baked = stats_of(&s, (2 * FRAMES - 1) % flight);
    close_session(&s);
    reserve(&d, 3, g, 2);
    open_session(&s, &d);
    hide(&s, name);
    draw_frames(&s, pictures[2]);
    (void)create(&s, 3, g);
    draw_frames(&s, pictures[0]);
    masu_stats_info own = stats_of(&s, (2 * FRAMES - 1) % flight);
    uint32_t off = far_off(pictures[0][FRAMES - 1], pictures[1][FRAMES - 1]);
    uint32_t without = far_off(pictures[2][FRAMES - 1], pictures[1][FRAMES - 1]);
    printf("  %s, %s: %u of %u bytes differ by more than 4, at most by %u; without it %u\n", scene,
           name, off, BYTES,
           max_difference(pictures[0][FRAMES - 1], pictures[1][FRAMES - 1], BYTES), without);
    assert_true(off <= limit);
    assert_true(without > 200);
    assert_int_equal(own.views[0].triangles, baked.views[0].triangles);
    assert_int_equal(own.views[0].visible_triangles, baked.views[0].visible_triangles);
    assert_int_equal(own.specular_rays, baked.specular_rays);
    assert_int_equal(own.specular_hits, baked.specular_hits);
    close_session(&s);
}

static void a_mesh_is_as_if_baked(void **state) {
    (void)state;
    for (uint32_t flight = 1; flight <= 3; flight++) {
        if (flight == 2 || whole_run())
            compare("test_reserve", "ball", &ball, flight, BYTES / 1000);
    }
    compare("test_reserve", "block", &block, 2, BYTES / 1000);
}

static void maps_masks_and_emission_are_as_if_baked(void **state) {
    (void)state;
    static const char *const names[] = {"disc", "tiled", "glow"};
    for (uint32_t i = 0; i < (whole_run() ? 3 : 1); i++) {
        masu_session s;
        masu_session_desc d = desc_of("test_mirror_textures");
        /* between the mirror and the quads: frames look into it, the last one at the quads */
        const float x = i == 0 ? 6 : i == 1 ? -6 : 0;
        masu_camera in = {
            .position = {(double)x, 0.2, 1}, .forward = {0, -0.1f, -1}, .fov_y = 0.7f};
        masu_camera at = {
            .position = {(double)x, 0.2, 0.1}, .forward = {0, -0.1f, 1}, .fov_y = 0.7f};
        masu_commands commands;
        take_from("test_mirror_textures", names[i], &quad);
        open_session(&s, &d);
        for (uint32_t k = 0; k < 4; k++)
            draw(&s, &(masu_frame_desc){.camera = &in, .cut = !k}, &commands, pictures[1][0]);
        draw(&s, &(masu_frame_desc){.camera = &at, .cut = 1}, &commands, pictures[1][1]);
        close_session(&s);
        reserve(&d, 0, &quad, 1);
        open_session(&s, &d);
        hide(&s, names[i]);
        (void)create(&s, 0, &quad);
        for (uint32_t k = 0; k < 4; k++)
            draw(&s, &(masu_frame_desc){.camera = &in, .cut = !k}, &commands, pictures[0][0]);
        draw(&s, &(masu_frame_desc){.camera = &at, .cut = 1}, &commands, pictures[0][1]);
        uint32_t off =
            far_off(pictures[0][0], pictures[1][0]) + far_off(pictures[0][1], pictures[1][1]);
        quad.data.texcoords = NULL; /* all 0: another image */
        assert_int_equal(
            masu_mesh_replace(s.m, masu_model_at(s.m, masu_scene_count(&s.scene, MASU_SCENE_MODEL)),
                              &quad.data, &failure),
            MASU_OK);
        for (uint32_t k = 0; k < 4; k++)
            draw(&s, &(masu_frame_desc){.camera = &in, .cut = !k}, &commands, pictures[2][0]);
        draw(&s, &(masu_frame_desc){.camera = &at, .cut = 1}, &commands, pictures[2][1]);
        uint32_t mirrored = far_off(pictures[2][0], pictures[1][0]),
                 seen = far_off(pictures[2][1], pictures[1][1]);
        printf("  %s: %u of %u bytes differ by more than 4; without texture coordinates %u in the "
               "mirror, %u seen directly\n",
               names[i], off, 2 * BYTES, mirrored, seen);
        assert_true(off <= BYTES / 1000);
        assert_true(mirrored > 200 && seen > 200);
        close_session(&s);
    }
}

/* ---- Motion ---------------------------------------------------------------------------------- */

static float half_of(uint16_t h) {
    int e = h >> 10 & 31;
    double m = e ? ldexp(1024 + (h & 1023), e - 25) : ldexp(h & 1023, -24);
    return (float)(h & 0x8000 ? -m : m);
}

static double velocities_apart(const uint16_t *a, const uint16_t *b, double *most) {
    double apart = 0;
    *most = 0;
    for (uint32_t i = 0; i < W * H; i++) {
        for (uint32_t k = 0; k < 2; k++) {
            apart =
                fmax(apart, fabs((double)half_of(a[4 * i + k]) - (double)half_of(b[4 * i + k])));
            *most = fmax(*most, fabs((double)half_of(b[4 * i + k])));
        }
    }
    return apart;
}

/* Vertices that go along the x axis are where a model that goes there is, with its velocities and its reflection; and
 * those that stay have none. */
static void vertices_that_move_are_as_a_model_that_moves(void **state) {
    (void)state;
    enum { STEPS = 5 };
    static uint16_t velocities[2][STEPS][W * H * 4];
    static float moved[VERTICES][3];
    for (int deforms = 0; deforms < 2; deforms++) {
        masu_session s;
        masu_session_desc d = desc_of("test_reserve");
        d.desc.readback = MASU_READBACK_VELOCITY;
        reserve(&d, 0, &ball, 1);
        open_session(&s, &d);
        hide(&s, "ball");
        masu_model mesh = create(&s, 0, &ball);
        draw_rung(&s, 0, NULL);
        for (uint32_t step = 0; step < STEPS; step++) {
            float by = step < 3 ? -0.4f * (float)(step + 1) : -1.2f, rows[12]; /* then it rests */
            memcpy(rows, ball.rows, sizeof rows);
            rows[3] += by;
            for (uint32_t i = 0; i < ball.data.vertex_count; i++) {
                memcpy(moved[i], ball.positions[i], sizeof moved[i]);
                moved[i][0] += by; /* ball.rows does not turn or scale */
            }
            if (deforms && step < 3)
                assert_int_equal(masu_mesh_deform(s.m, mesh, moved[0], ball.normals[0],
                                                  ball.data.vertex_count, &failure),
                                 MASU_OK);
            else if (step < 3)
                assert_int_equal(masu_model_set_transform(s.m, mesh, rows, &failure), MASU_OK);
            memcpy(velocities[deforms][step],
                   draw_image(&s, &(masu_frame_desc){.time_step = 1.0f / 60},
                              MASU_READBACK_VELOCITY, NULL),
                   sizeof velocities[0][0]);
        }
        draw_frames(&s, pictures[deforms]);
        close_session(&s);
    }
    for (uint32_t step = 0; step < STEPS; step++) {
        double most, apart = velocities_apart(velocities[1][step], velocities[0][step], &most);
        printf("  step %u: velocities up to %.2f pixels, apart by %.4f\n", step, most, apart);
        assert_true(apart < 0.02);
        assert_true(step < 3 ? most > 1 : most == 0);
    }
    uint32_t off = far_off(pictures[1][FRAMES - 1], pictures[0][FRAMES - 1]);
    printf("  %u of %u bytes differ by more than 4\n", off, BYTES);
    assert_true(off < BYTES / 1000);
}

/* A frame in a rung that traces nothing keeps the refit for the next one that does. */
static void a_rung_without_rays_forgets_no_refit(void **state) {
    (void)state;
    static float moved[VERTICES][3];
    for (int plain = 0; plain < 2; plain++) {
        masu_session s;
        masu_session_desc d = desc_of("test_reserve");
        d.desc.rung_count = 2;
        d.desc.rungs[1] = d.desc.rungs[0];
        d.desc.rungs[1].specular = MASU_OFF;
        reserve(&d, 0, &ball, 1);
        open_session(&s, &d);
        hide(&s, "ball");
        masu_model mesh = create(&s, 0, &ball);
        draw_rung(&s, 0, NULL);
        for (uint32_t i = 0; i < ball.data.vertex_count; i++) {
            memcpy(moved[i], ball.positions[i], sizeof moved[i]);
            moved[i][0] -= 2.5f;
        }
        assert_int_equal(masu_mesh_deform(s.m, mesh, moved[0], ball.normals[0],
                                          ball.data.vertex_count, &failure),
                         MASU_OK);
        draw_rung(&s, plain ? 1 : 0, NULL);
        draw_frames(&s, pictures[plain]);
        close_session(&s);
    }
    assert_true(far_off(pictures[1][FRAMES - 1], pictures[0][FRAMES - 1]) < BYTES / 1000);
}

/* ---- Slots ----------------------------------------------------------------------------------- */

static double cpu_ms(void) { return 1e3 * (double)clock() / CLOCKS_PER_SEC; }

static void slots_are_reused(void **state) {
    (void)state;
    enum { KINDS = 2, SLOTS = 3, CHANGES = 600 };
    const given *of[KINDS] = {&ball, &block};
    masu_session s;
    masu_model mesh[KINDS][SLOTS] = {{{0}}}, gone = {0};
    masu_session_desc d = desc_of("test_reserve");
    uint64_t random = 7, heap = 0, refused = 0, items[2] = {0, 0};
    double spent[2] = {0, 0};
    for (uint32_t k = 0; k < KINDS; k++) reserve(&d, k, of[k], SLOTS);
    d.desc.picking = 1;
    d.desc.rungs[0].scale = 0.3f;
    open_session(&s, &d);
    for (uint32_t i = 0; i < CHANGES; i++) {
        uint32_t k = random_word(&random) % KINDS, j = random_word(&random) % SLOTS,
                 what = random_word(&random) % 4;
        given *g = k ? &block : &ball;
        float rows[12];
        masu_result result;
        memcpy(rows, g->rows, sizeof rows);
        rows[3] += random_float(&random) * 6 - 3;
        uint64_t before = masu_allocs_of_thread();
        if (!mesh[k][j].id) {
            result = masu_mesh_create(s.m, k, &g->data, rows, &mesh[k][j], &failure);
            assert_true(!mesh[k][j].id == (result != MASU_OK));
        } else if (what == 0) {
            gone = mesh[k][j];
            result = masu_model_remove(s.m, gone, &failure);
            mesh[k][j].id = 0;
            assert_int_equal(masu_mesh_replace(s.m, gone, &g->data, &failure), MASU_ERROR_ARGUMENT);
        } else if (what < 3) {
            double start = cpu_ms();
            if (what == 1)
                result = masu_mesh_replace(s.m, mesh[k][j], &g->data, &failure);
            else
                result = masu_mesh_deform(s.m, mesh[k][j], g->data.positions, g->data.normals,
                                          g->data.vertex_count, &failure);
            if (!result) {
                spent[what - 1] += cpu_ms() - start;
                items[what - 1] += what == 1 ? g->data.triangle_count : g->data.vertex_count;
            }
        } else {
            result = masu_model_set_transform(s.m, mesh[k][j], rows, &failure);
        }
        heap += masu_allocs_of_thread() - before;
        if (result) { /* more in one frame than one slot's worth */
            assert_int_equal(result, MASU_ERROR_LIMIT);
            assert_string_equal(failure.what, "reserve.mesh_upload");
            refused++;
        }
        if (i % 4 == 3) draw_rung(&s, 0, NULL);
    }
    assert_true(refused > 0 && refused < CHANGES);
    printf("  host: %.2f ms per 1,000 triangles replaced, %.3f ms per 1,000 vertices deformed\n",
           1e3 * spent[0] / (double)items[0], 1e3 * spent[1] / (double)items[1]);
    if (masu_alloc_counting()) assert_int_equal(heap, 0);
    for (uint32_t k = 0; k < KINDS * SLOTS; k++) {
        masu_model *m = &mesh[k / SLOTS][k % SLOTS];
        if (m->id) assert_int_equal(masu_model_remove(s.m, *m, &failure), MASU_OK);
    }
    draw_frames(&s, pictures[0]);
    close_session(&s);
    open_session(&s, &d); /* of the same numbers: noise goes by them */
    for (uint32_t i = 0; i < CHANGES / 4; i++) draw_rung(&s, 0, NULL);
    draw_frames(&s, pictures[1]);
    printf("  %llu of %u changes refused; %u bytes differ afterwards\n",
           (unsigned long long)refused, CHANGES, far_off(pictures[0][0], pictures[1][0]));
    assert_int_equal(max_difference(pictures[0][0], pictures[1][0], sizeof pictures[0]), 0);
    close_session(&s);
}

static void a_mesh_is_picked(void **state) {
    (void)state;
    masu_session s;
    masu_pick_info picked;
    masu_commands commands;
    masu_node_state node;
    masu_session_desc d = desc_of("test_reserve");
    d.desc.picking = 1;
    reserve(&d, 0, &ball, 2);
    open_session(&s, &d);
    given near = ball;
    near.data.positions = near.positions[0]; /* of the copy */
    near.rows[3] = 0, near.rows[7] = 1.73f, near.rows[11] = 4; /* on the axis of the camera */
    masu_model mesh = create(&s, 0, &near);
    draw(&s, &(masu_frame_desc){.pick = 1, .pick_x = W / 2, .pick_y = H / 2}, &commands, NULL);
    assert_int_equal(masu_pick(s.m, commands.slot, &picked, &failure), MASU_OK);
    assert_int_equal(picked.kind, MASU_PICK_INSTANCE);
    assert_true(picked.model.id == mesh.id && picked.node == 0);
    assert_int_equal(masu_model_node_get(s.m, mesh, 0, &node, &failure), MASU_OK);
    assert_true(node.instance.id == picked.instance.id);
    assert_int_equal(masu_model_remove(s.m, mesh, &failure), MASU_OK);
    assert_int_equal(masu_pick(s.m, commands.slot, &picked, &failure), MASU_OK);
    assert_true(picked.model.id == 0);
    close_session(&s);
}

/* ---- Limits ---------------------------------------------------------------------------------- */

static void a_reserve_that_is_not_used_changes_no_bit(void **state) {
    (void)state;
    static const char *const scenes[] = {"test_reserve", "test_skin", "test_mirror_textures"};
    for (uint32_t i = 0; i < (whole_run() ? 3 : 2); i++) {
        masu_session s;
        masu_session_desc d = desc_of(scenes[i]);
        masu_memory_row rows[MEMORY_ROWS];
        open_session(&s, &d);
        for (uint32_t k = memory_rows(s.m, rows); k--;)
            assert_null(strstr(rows[k].name, "mesh upload"));
        draw_frames(&s, pictures[0]);
        close_session(&s);
        d.desc.reserve.meshes[7] = (masu_mesh_kind){.meshes = 3, .vertices = 100, .triangles = 50};
        open_session(&s, &d);
        draw_frames(&s, pictures[1]);
        close_session(&s);
        assert_int_equal(max_difference(pictures[0][0], pictures[1][0], sizeof pictures[0]), 0);
    }
}

#define REFUSED(call, code, name)                                                                  \
    do {                                                                                           \
        memset(&failure, 0, sizeof failure);                                                       \
        assert_int_equal(call, code);                                                              \
        if (!failure.what || strcmp(failure.what, name)) fail_msg("%s: %s", name, failure.text);   \
    } while (0)

static void what_does_not_fit_is_refused(void **state) {
    (void)state;
    masu_session s;
    masu_model mesh, other;
    masu_session_desc d = desc_of("test_reserve");
    reserve(&d, 0, &block, 2);
    reserve(&d, 1, &ball, 1);
    open_session(&s, &d);
    static given bad;
#define BAD(member, value, code, name)                                                             \
    do {                                                                                           \
        bad = block;                                                                               \
        bad.data.positions = bad.positions[0];                                                     \
        bad.data.normals = bad.normals[0];                                                         \
        bad.data.indices = bad.indices;                                                            \
        bad.member = (value);                                                                      \
        REFUSED(masu_mesh_create(s.m, 0, &bad.data, bad.rows, &mesh, &failure), code, name);       \
    } while (0)
    BAD(positions[5][1], NAN, MASU_ERROR_ARGUMENT, "positions");
    BAD(positions[5][1], 2e15f, MASU_ERROR_ARGUMENT, "positions");
    BAD(normals[1][2], INFINITY, MASU_ERROR_ARGUMENT, "normals");
    BAD(indices[4], block.data.vertex_count, MASU_ERROR_ARGUMENT, "indices");
    BAD(data.vertex_count, 2, MASU_ERROR_ARGUMENT, "vertex_count");
    BAD(data.triangle_count, 0, MASU_ERROR_ARGUMENT, "triangle_count");
    BAD(data.vertex_count, block.data.vertex_count + 1, MASU_ERROR_LIMIT, "vertex_count");
    BAD(data.triangle_count, block.data.triangle_count + 1, MASU_ERROR_LIMIT, "triangle_count");
    BAD(data.colors, bad.normals[0], MASU_ERROR_ARGUMENT, "colors");
    BAD(data.positions, NULL, MASU_ERROR_ARGUMENT, "positions");
    BAD(data.normals, NULL, MASU_ERROR_ARGUMENT, "normals");
    BAD(data.indices, NULL, MASU_ERROR_ARGUMENT, "indices");
    BAD(rows[3], NAN, MASU_ERROR_ARGUMENT, "rows");
    REFUSED(masu_mesh_create(s.m, 2, &block.data, block.rows, &mesh, &failure), MASU_ERROR_ARGUMENT,
            "kind");
    REFUSED(masu_mesh_create(s.m, MASU_MAX_MESH_KINDS, &block.data, block.rows, &mesh, &failure),
            MASU_ERROR_ARGUMENT, "kind");
    assert_int_equal(mesh.id, 0);
    REFUSED(masu_mesh_replace(s.m, masu_model_find(s.m, "ball"), &block.data, &failure),
            MASU_ERROR_ARGUMENT, "mesh");
    draw_rung(&s, 0, NULL);
    mesh = create(&s, 1, &ball); /* all of the frame's bytes */
    assert_true(masu_mesh_bytes(s.m, ball.data.vertex_count, ball.data.triangle_count) >=
                16ull * ball.data.vertex_count + 12ull * ball.data.triangle_count);
    REFUSED(masu_mesh_create(s.m, 1, &ball.data, ball.rows, &other, &failure), MASU_ERROR_LIMIT,
            "reserve.meshes");
    assert_string_equal(failure.text, "reserve.meshes[1]: 2 are needed, 1 are given");
    REFUSED(masu_mesh_replace(s.m, mesh, &ball.data, &failure), MASU_ERROR_LIMIT,
            "reserve.mesh_upload");
    draw_rung(&s, 0, NULL);
    REFUSED(masu_mesh_deform(s.m, mesh, ball.positions[0], ball.normals[0],
                             ball.data.vertex_count - 1, &failure),
            MASU_ERROR_ARGUMENT, "vertex_count");
    assert_int_equal(masu_mesh_deform(s.m, mesh, ball.positions[0], ball.normals[0],
                                      ball.data.vertex_count, &failure),
                     MASU_OK);
    REFUSED(masu_model_add(s.m, mesh, ball.rows, &other, &failure), MASU_ERROR_LIMIT, "like");
    assert_int_equal(masu_model_remove(s.m, mesh, &failure), MASU_OK);
    REFUSED(masu_model_remove(s.m, mesh, &failure), MASU_ERROR_ARGUMENT, "model");
    draw_rung(&s, 0, NULL);
    close_session(&s);
}

static void wrong_reserves_are_refused(void **state) {
    (void)state;
    masu_session s;
    masu_memory need;
    masu_session_desc d = desc_of("test_reserve");
    d.no_renderer = true;
    open_session(&s, &d);
    const masu_desc plain = s.desc;
    masu_mesh_kind *kind = &s.desc.reserve.meshes[1];
#define WRONG(member, value, code, name)                                                           \
    do {                                                                                           \
        s.desc = plain;                                                                            \
        *kind = (masu_mesh_kind){.meshes = 1, .material = block.material, .vertices = 24, .triangles = 12}; \
        if (masu_memory_query(&s.desc, &need, &failure)) fail_msg("%s", failure.text);           \
        s.desc.member = (value);                                                                   \
        REFUSED(masu_memory_query(&s.desc, &need, &failure), code, name);                          \
    } while (0)
    uint32_t pane = (uint32_t)masu_scene_find(&s.scene, MASU_SCENE_MATERIAL, "pane");
    WRONG(reserve.meshes[1].material, masu_scene_count(&s.scene, MASU_SCENE_MATERIAL),
          MASU_ERROR_ARGUMENT, "reserve.meshes");
    WRONG(reserve.meshes[1].material, pane, MASU_ERROR_ARGUMENT, "reserve.meshes");
    assert_non_null(strstr(failure.text, "transparent"));
    WRONG(reserve.meshes[1].vertices, 2, MASU_ERROR_ARGUMENT, "reserve.meshes[].vertices");
    WRONG(reserve.meshes[1].vertices, 1048577, MASU_ERROR_ARGUMENT, "reserve.meshes[].vertices");
    WRONG(reserve.meshes[1].triangles, 0, MASU_ERROR_ARGUMENT, "reserve.meshes[].triangles");
    WRONG(reserve.meshes[1].triangles, 262145, MASU_ERROR_ARGUMENT, "reserve.meshes[].triangles");
    WRONG(reserve.meshes[1].meshes, 1025, MASU_ERROR_ARGUMENT, "reserve.meshes[].meshes");
    WRONG(reserve.mesh_upload, 24 * (16 + 8) + 12 * 12 + 8 * 48 - 1, MASU_ERROR_ARGUMENT,
          "reserve.mesh_upload");
    s.desc.reserve.mesh_upload++;
    assert_int_equal(masu_memory_query(&s.desc, &need, &failure), MASU_OK);
    WRONG(reserve.mesh_upload, (1u << 30) + 1, MASU_ERROR_ARGUMENT, "reserve.mesh_upload");
    s.desc = plain;
    *kind = (masu_mesh_kind){.meshes = 1024, .material = block.material, .vertices = 24, .triangles = 12};
    assert_int_equal(masu_memory_query(&s.desc, &need, &failure), MASU_OK);
    *kind = (masu_mesh_kind){.meshes = 17, .material = block.material, .vertices = 1048576, .triangles = 12};
    REFUSED(masu_memory_query(&s.desc, &need, &failure), MASU_ERROR_LIMIT, "reserve.meshes");
    close_session(&s);
}

/* Of devices that have them: MASU_ON is refused by name, MASU_AUTO uses the built-in BVH. */
static void ray_queries_are_not_used(void **state) {
    (void)state;
    masu_session s;
    static masu_plan_info plan;
    masu_session_desc d = desc_of("test_reserve");
    d.host.ray_query = true;
    d.no_renderer = true;
    reserve(&d, 0, &block, 1);
    open_session(&s, &d);
    assert_int_equal(masu_plan(&s.desc, &plan, &failure), MASU_OK);
    assert_int_equal(pass_of(&plan, "specular_query")->active, 0);
    assert_true(pass_of(&plan, "mesh_trees")->active != 0);
    s.desc.ray_query = MASU_ON;
    if (s.host.ray_query)
        REFUSED(masu_plan(&s.desc, &plan, &failure), MASU_ERROR_ARGUMENT, "ray_query");
    else
        assert_int_equal(masu_plan(&s.desc, &plan, &failure), MASU_ERROR_DEVICE);
    close_session(&s);
}

static void a_scene_without_polygons_has_no_room(void **state) {
    (void)state;
    masu_session s;
    masu_memory need;
    masu_session_desc d = desc_of("test_sphere_sdf");
    d.no_renderer = true;
    open_session(&s, &d);
    s.desc.reserve.meshes[0] = (masu_mesh_kind){.meshes = 1, .vertices = 3, .triangles = 1};
    REFUSED(masu_memory_query(&s.desc, &need, &failure), MASU_ERROR_ARGUMENT, "reserve.meshes");
    close_session(&s);
}

/* What masu.h says that a slot costs. */
static void the_memory_is_as_stated(void **state) {
    (void)state;
    masu_session s;
    masu_memory need[2];
    masu_session_desc d = desc_of("test_reserve");
    d.no_renderer = true;
    open_session(&s, &d);
    for (uint32_t i = 0; i < 2; i++) {
        s.desc.reserve.meshes[0] =
            (masu_mesh_kind){.meshes = 1 + i * 10, .vertices = 3000, .triangles = 4000};
        assert_int_equal(masu_memory_query(&s.desc, &need[i], &failure), MASU_OK);
    }
    double stated = 3000 * (16.0 + 12 + 8) + 4000 * (12.0 + 70);
    double is = (double)(need[1].device_bytes - need[0].device_bytes) / 10;
    printf("  a slot of 3000 vertices and 4000 triangles: %.0f bytes on the device, stated %.0f\n",
           is, stated);
    assert_true(is > 0.98 * stated && is < 1.02 * stated);
    close_session(&s);
}

static int take_meshes(void **state) {
    (void)state;
    take_from("test_reserve", "ball", &ball);
    take_from("test_reserve", "block", &block);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_mesh_is_as_if_baked),
        cmocka_unit_test(maps_masks_and_emission_are_as_if_baked),
        cmocka_unit_test(vertices_that_move_are_as_a_model_that_moves),
        cmocka_unit_test(a_rung_without_rays_forgets_no_refit),
        cmocka_unit_test(slots_are_reused),
        cmocka_unit_test(a_mesh_is_picked),
        cmocka_unit_test(a_reserve_that_is_not_used_changes_no_bit),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(wrong_reserves_are_refused),
        cmocka_unit_test(ray_queries_are_not_used),
        cmocka_unit_test(a_scene_without_polygons_has_no_room),
        cmocka_unit_test(the_memory_is_as_stated),
    };
    return cmocka_run_group_tests(tests, take_meshes, NULL);
}

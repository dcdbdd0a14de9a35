/* test_lods.c: LODs of meshes. The choice depends only on the camera: the image with and without
 * culling is bit-identical. The error is at most the one that the rung allows: no outline is
 * farther from that of the full meshes. And fewer triangles are drawn. */
#include "support/support.h"
#include "support/files.h"

#include "image.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { W = 96, H = 64, BYTES = W * H * 4, FRAMES = 200, PIXELS = W * H };

/* Rungs: culling stages that are on; then without culling: full meshes, and the coarsest. */
enum { BOTH, FRUSTUM, OCCLUSION, NEITHER, FINE, COARSE, WAYS };

static uint8_t pixels[WAYS][BYTES], covered[WAYS][PIXELS];

static masu_session_desc lods_desc(void) {
    masu_session_desc d = test_desc("test_lods", W, H);
    d.desc.rung_count = WAYS;
    d.desc.readback = MASU_READBACK_DEPTH;
    d.desc.debug.casters = 1;
    for (uint32_t way = OCCLUSION; way < WAYS; way++) d.desc.rungs[way].frustum = MASU_OFF;
    for (uint32_t way = FRUSTUM; way < WAYS; way++) {
        d.desc.rungs[way].occlusion = way == OCCLUSION ? MASU_ON : MASU_OFF;
    }
    d.desc.rungs[FINE].lod_error = -1.0f;
    d.desc.rungs[COARSE].lod_error = 1e9f;
    return d;
}

static masu_camera path(uint32_t frame) {
    double t = frame;
    return (masu_camera){
        .position = {36.0 * sin(t * 0.05), 1.5 + 14.0 * (frame % 50 > 40), 33.0 * sin(t * 0.031)},
        .forward = {(float)cos(t * 0.37), (float)(0.4 * sin(t * 0.23)) - 0.2f,
                    (float)sin(t * 0.37)},
        .fov_y = 0.4f + 1.2f * (float)(frame % 7) / 7.0f};
}

static masu_stats_info draw_frame(masu_session *s, const masu_camera *c, uint32_t way, int cut) {
    masu_frame_desc f = {.camera = c, .rung = way, .cut = (uint32_t)cut};
    masu_commands commands;
    draw(s, &f, &commands, pixels[way]);
    const float *depth = read_image(s, commands.slot, MASU_READBACK_DEPTH);
    for (uint32_t i = 0; i < W * H; i++) covered[way][i] = depth[i] > 0.0f;
    return stats_of(s, commands.slot);
}

/* Number of pixels missing in `b` that are at least 2 pixels inside `a`: an error of one pixel, and
 * one for the sample position in a pixel. */
static uint32_t astray(const uint8_t *a, const uint8_t *b) {
    uint32_t n = 0;
    for (int y = 2; y < H - 2; y++) {
        for (int x = 2; x < W - 2; x++) {
            int deep = 1;
            if (b[y * W + x]) continue;
            for (int v = -2; v <= 2; v++) {
                for (int u = -2; u <= 2; u++) deep &= a[(y + v) * W + x + u];
            }
            n += (uint32_t)deep;
        }
    }
    return n;
}

static void compare_path(masu_session *s, uint32_t frames, int moving) {
    uint64_t triangles[WAYS] = {0}, casters[WAYS] = {0};
    uint32_t changed = 0, coarse_astray = 0;
    for (uint32_t frame = 0; frame < frames; frame++) {
        masu_camera c = path(frame);
        if (moving) {
            float t = (float)frame;
            move_instance(s, "ball17", 20.0f * sinf(t * 0.2f), 1.0f, 30.0f * cosf(t * 0.13f), 1.0f);
            move_instance(s, "large2", 25.0f * cosf(t * 0.3f), 3.0f, 3.0f,
                          frame % 20 < 10 ? 1.5f : 0.1f);
            move_instance(s, "wall1", 20.0f * sinf(t * 0.11f), 0.0f, 20.0f, 2.0f);
        }
        for (uint32_t way = 0; way < WAYS; way++) {
            masu_stats_info stats = draw_frame(s, &c, way, frame % 60 == 0);
            int occlusion = way == BOTH || way == OCCLUSION;
            triangles[way] += stats.triangles;
            casters[way] +=
                occlusion ? stats.views[1].visible_triangles : stats.views[1].triangles;
            if (way >= OCCLUSION)
                assert_int_equal(stats.views[0].instances,
                                 masu_scene_count(&s->scene, MASU_SCENE_INSTANCE));
            if (way == FINE) assert_int_equal(stats.triangles, masu_scene_triangles(&s->scene));
            /* Both views draw the same LODs. */
            if (way >= NEITHER) assert_int_equal(stats.views[1].triangles, stats.triangles);
        }
        for (uint32_t way = 0; way < NEITHER; way++) {
            if (max_difference(pixels[way], pixels[NEITHER], BYTES))
                fail_msg("frame %u differs, stages %u", frame, way);
        }
        changed += max_difference(pixels[FINE], pixels[NEITHER], BYTES) > 0;
        uint32_t lost = astray(covered[FINE], covered[NEITHER]);
        uint32_t gained = astray(covered[NEITHER], covered[FINE]);
        if (lost || gained) fail_msg("frame %u: %u pixels lost, %u gained", frame, lost, gained);
        coarse_astray += astray(covered[FINE], covered[COARSE]);
    }
    static const char *const names[WAYS] = {"both stages", "frustum",  "occlusion",
                                            "neither",     "no LODs",  "coarsest"};
    for (uint32_t way = 0; way < WAYS; way++) {
        print_message("%-12s triangles %8.1f a frame, casters %8.1f\n", names[way],
                      (double)triangles[way] / frames, (double)casters[way] / frames);
    }
    assert_true(triangles[COARSE] < triangles[NEITHER]);
    assert_true(triangles[NEITHER] < triangles[FINE] * 3 / 4);
    assert_true(triangles[FRUSTUM] < triangles[NEITHER] / 2);
    assert_true(triangles[BOTH] < triangles[FRUSTUM]);
    assert_true(changed > frames / 2); /* LODs were visible */
    assert_true(coarse_astray > 0);    /* otherwise nothing shows that wrong outlines are
                                          detected */
}

static void the_picture_is_the_same_without_culling(void **state) {
    (void)state;
    masu_session_desc d = lods_desc();
    masu_session s;
    d.host.validate = false; /* the long path; the other test runs with the layers */
    open_session(&s, &d);
    compare_path(&s, trials(FRAMES, FRAMES, 30), 0);
    close_session(&s);
}

static void what_moves_is_drawn_by_where_it_is(void **state) {
    (void)state;
    masu_session_desc d = lods_desc();
    masu_session s;
    open_session(&s, &d);
    compare_path(&s, trials(FRAMES / 4, FRAMES / 4, FRAMES / 8), 1);
    close_session(&s);
}

/* From a distance, with any error allowed: the last LOD of each mesh. Only the occluders that the
 * LOD does not contain are omitted. */
static void the_coarsest_form_is_the_last_one(void **state) {
    (void)state;
    masu_session_desc d = lods_desc();
    masu_session s;
    d.desc.rungs[OCCLUSION].lod_error = 1e9f;
    open_session(&s, &d);
    uint8_t *bytes; /* the session frees its blob after loading */
    size_t size;
    char error[256];
    masu_scene scene;
    if (!masu_file_read(scene_path("test_lods"), (size_t)1 << 30, &bytes, &size, error,
                        sizeof error)) {
        fail_msg("%s", error);
    }
    assert_int_equal(masu_scene_bind(bytes, size, &scene, NULL), MASU_OK);
    masu_scene_view v = masu_scene_view_of(&scene);
    uint64_t least = 0, occluders = 0;
    for (uint32_t i = 0; i < masu_scene_count(&s.scene, MASU_SCENE_INSTANCE); i++) {
        const masu_blob_mesh *mesh = &v.meshes[v.instances[i].mesh];
        uint32_t first = mesh->first_primitive, lods = 0;
        for (uint32_t l = 0; l < masu_scene_data_of(&s.scene)->lods; l++) {
            if (v.lods[l].mesh != v.instances[i].mesh) continue;
            first = v.lods[l].first_primitive;
            lods++;
        }
        for (uint32_t o = 0; o < masu_scene_data_of(&s.scene)->occluders; o++)
            occluders += v.occluders[o].mesh == v.instances[i].mesh && v.occluders[o].lods >= lods;
        for (uint32_t p = 0; p < mesh->primitive_count; p++)
            least += v.primitives[first + p].index_count / 3;
    }
    free(bytes);
    masu_camera c = {.position = {0, 0, 1000}, .forward = {0, 0, -1}, .fov_y = 1.0f};
    masu_stats_info stats = draw_frame(&s, &c, COARSE, 0);
    assert_int_equal(stats.triangles, least);
    assert_true(least < masu_scene_triangles(&s.scene) / 4);
    assert_true(occluders > 0 && occluders < masu_scene_data_of(&s.scene)->placed_occluders);
    stats = draw_frame(&s, &c, OCCLUSION, 0);
    assert_int_equal(stats.views[0].occluders, occluders);
    /* Behind the camera too: they may cast shadows. */
    c.forward[2] = 1.0f;
    stats = draw_frame(&s, &c, COARSE, 0);
    assert_int_equal(stats.triangles, least);
    /* A mesh that contains the camera, large1, is drawn in full detail. */
    c.position[0] = -4.5;
    c.position[1] = 3.0;
    c.position[2] = 16.5;
    stats = draw_frame(&s, &c, COARSE, 0);
    assert_true(stats.triangles >= least + 1000 && stats.triangles < least + 2 * 1280);
    close_session(&s);
}

static const masu_memory_row *row_of(const masu_memory_row *rows, uint32_t n, const char *name) {
    for (uint32_t i = 0; i < n; i++) {
        if (!strcmp(rows[i].name, name)) return &rows[i];
    }
    return NULL;
}

/* A ladder without LODs has no draws, no lists and no bytes for them. */
static void a_ladder_without_lods_has_none_of_it(void **state) {
    (void)state;
    uint64_t bytes[2];
    for (uint32_t with = 0; with < 2; with++) {
        masu_session_desc d = test_desc("test_lods", W, H);
        masu_session s;
        masu_memory_row rows[MEMORY_ROWS];
        d.desc.rung_count = 2;
        d.desc.readback = MASU_READBACK_DEPTH;
        d.desc.rungs[0].lod_error = d.desc.rungs[1].lod_error = -1.0f;
        if (with) d.desc.rungs[1].lod_error = 0.5f;
        open_session(&s, &d);
        uint32_t n = memory_rows(s.m, rows);
        assert_true(n < MEMORY_ROWS);
        assert_int_equal(row_of(rows, n, "instance LODs")->count > 0, with);
        bytes[with] = row_of(rows, n, "draw commands")->bytes;
        masu_stats_info stats = draw_frame(&s, &(masu_camera){.position = {0, 0, 1000},
                                                              .forward = {0, 0, -1},
                                                              .fov_y = 1.0f},
                                           with, 0);
        assert_int_equal(stats.triangles < masu_scene_triangles(&s.scene), with);
        close_session(&s);
    }
    assert_true(bytes[0] < bytes[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_picture_is_the_same_without_culling),
        cmocka_unit_test(what_moves_is_drawn_by_where_it_is),
        cmocka_unit_test(the_coarsest_form_is_the_last_one),
        cmocka_unit_test(a_ladder_without_lods_has_none_of_it),
    };
    return cmocka_run_group_tests_name("lods", tests, NULL, NULL);
}

/* test_transparents.c: transparent panes against a reference in double precision that sorts and
 * blends them pixel by pixel; additive ones in any order; in front of and behind polygons and an
 * SDF; a camera that moves through the panes; none, one and 256 panes. The panes are emissive unlit
 * quads of z = const, so their colour is exact; their scenes are written here. */
#include "support/support.h"
#include "support/blob.h"
#include "support/files.h"
#include "support/random.h"
#include "support/floats.h"

#include "image.h"
#include "scene/blob.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 96, PIXELS = SIDE * SIDE, PANES_MAX = 256 };

typedef struct pane {
    double x, y, z, half; /* centre, half edge */
    float color[3], opacity;
    int additive, opaque;
} pane;

static masu_session s;
static pane panes[PANES_MAX + 1];
static uint32_t pane_count;
static uint64_t seed;
static float picture[4 * PIXELS], base[4 * PIXELS];

/* ---- Scenes ---------------------------------------------------------------------------------- */

/* A blob from its sections, in rising kind. */
typedef struct panes_blob {
    _Alignas(16) uint8_t bytes[1 << 19];
    uint64_t end;
} panes_blob;

static panes_blob blob;

static void begin_blob(void) {
    memset(&blob, 0, sizeof blob);
    blob.end = (sizeof(masu_blob_header) + 8 * sizeof(masu_blob_section) + 15) & ~(uint64_t)15;
}

static void add(uint32_t kind, uint32_t stride, uint64_t count, const void *data) {
    masu_blob_header *h = (masu_blob_header *)(void *)blob.bytes;
    masu_blob_section *section =
        (masu_blob_section *)(void *)(blob.bytes + sizeof *h) + h->section_count++;
    assert_true(blob.end + count * stride <= sizeof blob.bytes);
    *section = (masu_blob_section){kind, stride, blob.end, count};
    memcpy(blob.bytes + blob.end, data, count * stride);
    blob.end = (blob.end + count * stride + 15) & ~(uint64_t)15;
}

static void end_blob(const char *name) {
    masu_blob_header *h = (masu_blob_header *)(void *)blob.bytes;
    h->magic = MASU_BLOB_MAGIC;
    h->version = MASU_BLOB_VERSION;
    support_blob_seal(blob.bytes, blob.end);
    write_bytes(name, blob.bytes, blob.end);
}

/* A mesh of two triangles for each pane, with a separate material and instance. */
static void write_scene(const char *name) {
    static uint32_t indices[6 * (PANES_MAX + 1)];
    static masu_blob_primitive primitives[PANES_MAX + 1];
    static masu_blob_mesh meshes[PANES_MAX + 1];
    static masu_blob_instance instances[PANES_MAX + 1];
    static masu_blob_material materials[PANES_MAX + 1];
    static const uint32_t quad[6] = {0, 1, 2, 0, 2, 3};
    masu_blob_vertex vertices[4] = {
        {{-1, -1, 0}, {0, 0}}, {{1, -1, 0}, {0, 0}}, {{1, 1, 0}, {0, 0}}, {{-1, 1, 0}, {0, 0}}};
    for (uint32_t i = 0; i < pane_count; i++) {
        const pane *p = &panes[i];
        memcpy(indices + 6 * i, quad, sizeof quad);
        primitives[i] = (masu_blob_primitive){6 * i, 6, 0, 4, i, {-1, -1, 0}, {1, 1, 0}, 0};
        meshes[i] = (masu_blob_mesh){i, 1, {-1, -1, 0}, {1, 1, 0}, MASU_BLOB_NONE, 0};
        instances[i] =
            (masu_blob_instance){.transform = {(float)p->half, 0, 0, (float)p->x, 0, (float)p->half,
                                               0, (float)p->y, 0, 0, 1, (float)p->z},
                                 .mesh = i,
                                 .name = MASU_BLOB_NONE,
                                 .parent = MASU_BLOB_NONE,
                                 .group = MASU_BLOB_NONE};
        materials[i] = (masu_blob_material){
            .roughness = 1,
            .emissive = {p->color[0], p->color[1], p->color[2]},
            .name = MASU_BLOB_NONE,
            .flags = p->opaque ? 0
                               : (uint32_t)MASU_MATERIAL_IS_BLEND |
                                     (p->additive ? (uint32_t)MASU_MATERIAL_IS_ADDITIVE : 0),
            .specular = 0.5f,
            .opacity = p->opacity,
            .meso = MASU_BLOB_NONE,
            .detail = {1, 1}};
    }
    masu_blob_environment environment = {.sun_direction = {0, 1, 0},
                                         .exposure = 1,
                                         .near_distance = 0.1f,
                                         .sky_zenith = {0.5f, 0.5f, 0.5f},
                                         .sky_horizon = {0.5f, 0.5f, 0.5f}};
    masu_blob_camera_key key = {.position = {0, 0, 10}, .fov_y = 1};
    uint32_t n = pane_count;
    begin_blob();
    add(MASU_BLOB_VERTICES, sizeof *vertices, 4, vertices);
    add(MASU_BLOB_INDICES, sizeof *indices, 6 * n, indices);
    add(MASU_BLOB_PRIMITIVES, sizeof *primitives, n, primitives);
    add(MASU_BLOB_MESHES, sizeof *meshes, n, meshes);
    add(MASU_BLOB_INSTANCES, sizeof *instances, n, instances);
    add(MASU_BLOB_MATERIALS, sizeof *materials, n, materials);
    add(MASU_BLOB_CAMERA_KEYS, sizeof key, 1, &key);
    add(MASU_BLOB_ENVIRONMENT, sizeof environment, 1, &environment);
    end_blob(name);
}

static masu_session_desc panes_desc(const char *path) {
    masu_session_desc d = test_desc(NULL, SIDE, SIDE);
    d.scene_path = path;
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    return d;
}

static void open_panes(void) {
    write_scene("panes.masu");
    masu_session_desc d = panes_desc(in_scratch("panes.masu"));
    open_session(&s, &d);
}

static void move(uint32_t i) {
    const pane *p = &panes[i];
    const float rows[12] = {(float)p->half, 0, 0, (float)p->x, 0,          (float)p->half, 0,
                            (float)p->y,    0, 0, 1,           (float)p->z};
    assert_int_equal(masu_instance_set_transform(s.m, masu_instance_at(s.m, i), rows, NULL),
                     MASU_OK);
}

static masu_stats_info render(const masu_camera *camera, float *hdr) {
    masu_frame_desc frame = {.camera = camera};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    floats_of_halves(read_image(&s, commands.slot, MASU_READBACK_HDR), hdr, 4 * PIXELS);
    masu_stats_info stats = stats_of(&s, commands.slot);
    assert_int_equal(stats.replaced, 0);
    return stats;
}

/* Floats that are exact in their storage format: opacity and colour in 32nds. */
static void random_panes(uint32_t count) {
    pane_count = count;
    for (uint32_t i = 0; i < count; i++) {
        panes[i] = (pane){.x = 6 * random_unit(&seed) - 3,
                          .y = 6 * random_unit(&seed) - 3,
                          .z = 8 * random_unit(&seed) - 4,
                          .half = 0.4 + 1.6 * random_unit(&seed),
                          .opacity = (float)(1 + (int)(30 * random_unit(&seed))) / 32,
                          .additive = random_unit(&seed) < 0.2};
        for (uint32_t k = 0; k < 3; k++)
            panes[i].color[k] = (float)(1 + (int)(31 * random_unit(&seed))) / 32;
    }
}

/* ---- The reference --------------------------------------------------------------------------- */

static const double *eye_of_order;

static double distance_of(const pane *p) {
    double x = p->x - eye_of_order[0], y = p->y - eye_of_order[1], z = p->z - eye_of_order[2];
    return x * x + y * y + z * z;
}

static int farther(const void *a, const void *b) {
    double x = distance_of(&panes[*(const uint32_t *)a]),
           y = distance_of(&panes[*(const uint32_t *)b]);
    return x > y ? -1 : x < y;
}

/* The largest difference between the image and the blended `base`; pixels at the edge of a pane,
 * which can be on either side, are skipped. */
static double compare(const masu_camera *camera, uint32_t *compared) {
    uint32_t order[PANES_MAX + 1];
    for (uint32_t i = 0; i < pane_count; i++) order[i] = i;
    eye_of_order = camera->position;
    qsort(order, pane_count, sizeof *order, farther);
    double tan_y = tan((double)camera->fov_y / 2), worst = 0;
    *compared = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double ray[2] = {((i % SIDE + 0.5) / SIDE * 2 - 1) * tan_y,
                         (1 - (i / SIDE + 0.5) / SIDE * 2) * tan_y};
        double want[3] = {(double)base[4 * i], (double)base[4 * i + 1], (double)base[4 * i + 2]};
        int edge = 0;
        double wall = 1e30; /* the nearest opaque pane */
        for (int opaque = 1; opaque >= 0; opaque--) {
            for (uint32_t n = 0; n < pane_count; n++) {
                const pane *p = &panes[order[n]];
                double depth = camera->position[2] - p->z;
                double near = 0.1;
                if (p->opaque != opaque) continue;
                edge |= fabs(depth - near) < 0.01;
                if (depth < near || depth > wall) continue;
                double x = fabs(camera->position[0] + ray[0] * depth - p->x) - p->half;
                double y = fabs(camera->position[1] + ray[1] * depth - p->y) - p->half;
                double slack = 0.6 * depth * tan_y * 2 / SIDE, away = fmax(x, y);
                edge |= fabs(away) < slack;
                if (away > 0) continue;
                if (opaque) wall = depth;
                for (uint32_t k = 0; k < 3 && !opaque; k++) {
                    double o = (double)p->opacity;
                    want[k] = (double)p->color[k] * o + (p->additive ? 1 : 1 - o) * want[k];
                }
            }
        }
        if (edge) continue;
        (*compared)++;
        for (uint32_t k = 0; k < 3; k++) {
            double off = fabs(want[k] - (double)picture[4 * i + k]) / fmax(1, want[k]);
            worst = worst_of(worst, off);
        }
    }
    return worst;
}

static masu_camera camera_at(double x, double y, double z) {
    return (masu_camera){.position = {x, y, z}, .forward = {0, 0, -1}, .fov_y = 0.9f};
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static void panes_are_blended_the_farthest_first(void **state) {
    (void)state;
    seed = 1;
    for (uint32_t i = 0; i < PIXELS; i++)
        base[4 * i] = base[4 * i + 1] = base[4 * i + 2] = 0.5f; /* only sky, without a sun */
    static const uint32_t counts[] = {1, 2, 17, 64, 256};
    for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
        random_panes(counts[c]);
        open_panes();
        assert_int_equal(masu_scene_data_of(&s.scene)->transparents, counts[c]);
        double worst = 0;
        uint32_t compared, least = PIXELS;
        for (int turn = 0; turn < 4; turn++) {
            masu_camera camera =
                camera_at(2 * random_unit(&seed) - 1, 2 * random_unit(&seed) - 1, 9);
            masu_stats_info stats = render(&camera, picture);
            assert_true(stats.transparents <= counts[c] && stats.draws == 0);
            worst = worst_of(worst, compare(&camera, &compared));
            if (compared < least) least = compared;
            for (uint32_t i = 0; i < pane_count; i++) { /* another order from the next frame on */
                panes[i].z = 8 * random_unit(&seed) - 4;
                move(i);
            }
        }
        print_message("%u panes: error of %.2f of 255 at most, %u pixels at least\n", counts[c],
                      255 * worst, least);
        assert_true(worst <= 2.0 / 255);
        assert_true(least > (counts[c] < 100 ? PIXELS / 4 : 50));
        close_session(&s);
    }
}

static void what_adds_up_does_so_in_any_order(void **state) {
    (void)state;
    static float other[4 * PIXELS];
    seed = 2;
    random_panes(100);
    for (uint32_t i = 0; i < pane_count; i++) {
        panes[i].additive = 1;
        panes[i].half = 2 + random_unit(&seed);
        panes[i].opacity = 0.5f;
        for (uint32_t k = 0; k < 3; k++)
            panes[i].color[k] = (float)(int)(3 * random_unit(&seed)) / 32;
    }
    open_panes();
    masu_camera camera =
        camera_at(0, 0, 1e6); /* at this distance z only affects the order */
    camera.fov_y = 0.001f;
    for (uint32_t i = 0; i < pane_count; i++) panes[i].half *= 100;
    for (uint32_t i = 0; i < pane_count; i++) move(i);
    render(&camera, picture);
    for (int turn = 0; turn < 3; turn++) {
        for (uint32_t i = 0; i < pane_count; i++) {
            panes[i].z = -panes[i].z + (turn ? random_unit(&seed) : 0);
            move(i);
        }
        render(&camera, other);
        uint32_t differ = 0, bright = 0;
        for (uint32_t i = 0; i < 4 * PIXELS; i++) {
            differ += other[i] != picture[i];
            bright += picture[i] > 1;
        }
        assert_true(bright > PIXELS / 4);
        assert_int_equal(differ, 0);
    }
    close_session(&s);
}

static void a_camera_moves_through_them(void **state) {
    (void)state;
    seed = 3;
    random_panes(40);
    open_panes();
    double worst = 0;
    uint32_t compared, sum = 0, fewest = 40;
    for (double z = 6; z > -6; z -= 0.37) {
        masu_camera camera = camera_at(0.3, -0.2, z);
        masu_stats_info stats = render(&camera, picture);
        if (stats.transparents < fewest) fewest = (uint32_t)stats.transparents;
        worst = worst_of(worst, compare(&camera, &compared));
        sum += compared;
    }
    print_message("a camera through 40 panes: error of %.2f of 255 at most\n", 255 * worst);
    assert_true(worst <= 2.0 / 255);
    assert_true(sum > 10 * PIXELS);
    assert_int_equal(fewest, 0); /* panes behind the camera are not drawn */
    close_session(&s);
}

/* A wall among the panes: those behind it are occluded, and the wall itself is unchanged. */
static void walls_hide_what_is_behind_them(void **state) {
    (void)state;
    static float kept[4 * PIXELS];
    seed = 4;
    random_panes(30);
    panes[11] = (pane){.z = 0.25, .half = 1.7, .color = {0.25f, 1, 4}, .opacity = 1, .opaque = 1};
    open_panes();
    masu_camera camera = camera_at(0, 0, 9);
    for (uint32_t i = 0; i < 30; i++) { /* moves everything except the wall away */
        if (i == 11) continue;
        panes[i].z += 100;
        move(i);
    }
    masu_stats_info stats = render(&camera, base);
    assert_int_equal(stats.transparents, 0);
    assert_int_equal(stats.draws, 1);
    for (uint32_t i = 0; i < 30; i++) {
        if (i == 11) continue;
        panes[i].z -= 100;
        move(i);
    }
    render(&camera, picture);
    memcpy(kept, base, sizeof kept);
    uint32_t compared;
    double worst = compare(&camera, &compared);
    print_message("around a wall: error of %.2f of 255 at most\n", 255 * worst);
    assert_true(compared > PIXELS / 4 && worst <= 2.0 / 255);
    for (uint32_t i = 0; i < 30; i++) { /* all panes behind it */
        if (i == 11) continue;
        panes[i].z = -2 - random_unit(&seed);
        panes[i].x *= 0.2, panes[i].y *= 0.2, panes[i].half = 0.5;
        move(i);
    }
    render(&camera, picture);
    assert_memory_equal(picture, kept, sizeof kept);
    close_session(&s);
    for (uint32_t i = 0; i < PIXELS; i++) base[4 * i] = base[4 * i + 1] = base[4 * i + 2] = 0.5f;
}

/* A pane through the centre of an SDF ball and a polygon ball. */
static void a_pane_cuts_an_sdf_and_polygons_alike(void **state) {
    (void)state;
    static float depth[2][PIXELS];
    masu_session_desc d = test_desc("test_pane", SIDE, SIDE);
    d.desc.readback = MASU_READBACK_HDR | MASU_READBACK_DEPTH;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    masu_instance pane_handle = masu_instance_find(s.m, "pane");
    assert_true(pane_handle.id != 0);
    float rows[12] = {1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 100}; /* out of the way */
    masu_frame_desc frame = {0};
    masu_commands commands;
    masu_readback_image image;
    masu_stats_info stats;
    for (int there = 0; there < 2; there++) {
        rows[11] = there ? 0.5f : 100;
        assert_int_equal(masu_instance_set_transform(s.m, pane_handle, rows, NULL), MASU_OK);
        draw(&s, &frame, &commands, NULL);
        assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_HDR, &image, NULL),
                         MASU_OK);
        float *to = there ? picture : base;
        floats_of_halves(image.pixels, to, 4 * PIXELS);
        assert_int_equal(masu_readback(s.m, commands.slot, MASU_READBACK_DEPTH, &image, NULL),
                         MASU_OK);
        memcpy(depth[there], image.pixels, sizeof depth[there]);
        assert_int_equal(masu_stats(s.m, commands.slot, &stats, NULL), MASU_OK);
        assert_int_equal(stats.transparents, there);
    }
    assert_memory_equal(depth[0], depth[1], sizeof depth[0]); /* a pane is in no depth image */
    uint32_t before[2] = {0}, behind[2] = {0};
    for (uint32_t i = 0; i < PIXELS; i++) {
        /* The pane is at view depth 5.5, near 0.1; balls at x = -1.5 and 1.5. */
        double z = depth[0][i] > 0 ? 0.1 / (double)depth[0][i] : 1e9;
        if (fabs(z - 5.5) < 0.01) continue;
        int right = i % SIDE >= SIDE / 2, hidden = z < 5.5;
        for (uint32_t k = 0; k < 3; k++) {
            double was = (double)base[4 * i + k], is = (double)picture[4 * i + k];
            double want = hidden ? was : 0.5 * (k == 1 ? 1 : 0.25) + 0.5 * was;
            assert_true(fabs(is - want) <= 1.0 / 255 * fmax(1, want));
        }
        if (z < 20) (hidden ? before : behind)[right]++;
    }
    print_message("before and behind: %u and %u of the SDF, %u and %u of polygons\n", before[0],
                  behind[0], before[1], behind[1]);
    for (int k = 0; k < 2; k++) assert_true(before[k] > 100 && behind[k] > 20);
    close_session(&s);
}

/* ---- Maps, texture sets, the sun's map ------------------------------------------------------- */

static void place(const char *name, double x, double y, double z, float rows[12]) {
    const float all[12] = {1, 0, 0, (float)x, 0, 0, 1, (float)y, 0, -1, 0, (float)z};
    memcpy(rows, all, sizeof all);
    place_instance(&s, name, rows);
}

/* The image under a sky of that radiance; the sun is behind the camera. */
static void under_sky(float sky, float *hdr) {
    const masu_light light = {.sun_direction = {0, 1, 1},
                              .sun_color = {1, 1, 1},
                              .ambient = {0.2f, 0.2f, 0.2f},
                              .sky_zenith = {sky, sky, sky},
                              .sky_horizon = {sky, sky, sky}};
    masu_frame_desc frame = {.light = &light, .cut = 1};
    masu_commands commands;
    draw(&s, &frame, &commands, NULL);
    floats_of_halves(read_image(&s, commands.slot, MASU_READBACK_HDR), hdr, 4 * PIXELS);
}

/* Two panes with different texture sets: the colour and transmission of each follow from its image
 * in front of black and of white; from those, the image of both in either order. */
static void panes_of_different_sets_take_turns(void **state) {
    (void)state;
    static float adds[2][4 * PIXELS], keeps[2][4 * PIXELS];
    masu_session_desc d = test_desc("test_pane_maps", SIDE, SIDE);
    float rows[12];
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    open_session(&s, &d);
    assert_int_equal(masu_scene_data_of(&s.scene)->transparents, 2);
    assert_int_equal(masu_scene_data_of(&s.scene)->transparent_sets, 2);
    assert_int_equal(masu_scene_data_of(&s.scene)->masks, 0);
    for (int i = 0; i < 2; i++) {
        place("a", 0, 0, i ? 100 : 0, rows);
        place("b", 0, 0, i ? 0 : 100, rows);
        under_sky(0, adds[i]);
        under_sky(1, keeps[i]);
        for (uint32_t k = 0; k < 4 * PIXELS; k++) keeps[i][k] -= adds[i][k];
    }
    for (int front = 0; front < 2; front++) {
        /* The same size in the image: both at one depth, except for a tiny difference. */
        place("a", 0, 0, front ? 0 : 1e-4, rows);
        place("b", 0, 0, front ? 1e-4 : 0, rows);
        under_sky(0, picture);
        double worst = 0;
        uint32_t both = 0;
        for (uint32_t i = 0; i < 4 * PIXELS; i++) {
            if (i % 4 == 3) continue;
            double want =
                (double)adds[front][i] + (double)keeps[front][i] * (double)adds[!front][i];
            worst = worst_of(worst, fabs(want - (double)picture[i]));
            both += keeps[0][i] < 0.9f && keeps[1][i] < 0.9f;
        }
        print_message("%s in front: error of %.2f of 255 at most\n",
                      front ? "b" : "a", 255 * worst);
        assert_true(both > PIXELS / 16);
        assert_true(worst <= 2.0 / 255);
    }
    /* An object between the sun and a pane shadows the pane. */
    static float dark[4 * PIXELS];
    place("a", 0, 0, 0, rows);
    place("b", 0, 0, 100, rows);
    under_sky(0, dark);
    place("caster", 0, 100, -100, rows);
    under_sky(0, picture);
    uint32_t shaded = 0, lit = 0;
    for (uint32_t i = 0; i < PIXELS; i++) {
        double was = (double)picture[4 * i + 2], is = (double)dark[4 * i + 2];
        if (was < 0.05) continue;
        shaded += is < 0.5 * was;
        lit += is == was;
    }
    print_message("%u pixels in shadow, %u lit\n", shaded, lit);
    assert_true(shaded > 100 && lit > 500 && shaded < lit);
    close_session(&s);
}

/* Two faces of one mesh, the near one towards the viewer, the far one away from the viewer, in
 * either order. */
static void write_faces(const char *name, int near_first) {
    static const uint32_t orders[2][12] = {{0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7},
                                           {4, 5, 6, 4, 6, 7, 0, 2, 1, 0, 3, 2}};
    masu_blob_vertex vertices[8];
    for (int i = 0; i < 8; i++) {
        static const float corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
        int near = i / 4;
        vertices[i] = (masu_blob_vertex){
            {corners[i % 4][0], corners[i % 4][1], near ? 1.0f : -1.0f},
            {(int16_t)(near ? 14043 : 32767), (int16_t)(near ? 0 : 32767)}}; /* tilted; upright */
    }
    masu_blob_primitive primitive = {0, 12, 0, 8, 0, {-1, -1, -1}, {1, 1, 1}, 0};
    masu_blob_mesh mesh = {0, 1, {-1, -1, -1}, {1, 1, 1}, MASU_BLOB_NONE, 0};
    masu_blob_instance instance = {.transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0},
                                   .name = MASU_BLOB_NONE,
                                   .parent = MASU_BLOB_NONE,
                                   .group = MASU_BLOB_NONE};
    masu_blob_material material = {.base_color = {1, 1, 1},
                                   .roughness = 1,
                                   .name = MASU_BLOB_NONE,
                                   .flags = MASU_MATERIAL_IS_BLEND,
                                   .opacity = 0.5f,
                                   .meso = MASU_BLOB_NONE,
                                   .detail = {1, 1}};
    masu_blob_environment environment = {.sun_direction = {-0.8944272f, 0, 0.4472136f},
                                         .sun_color = {2, 2, 2},
                                         .exposure = 1,
                                         .near_distance = 0.1f};
    masu_blob_camera_key key = {.position = {0, 0, 10}, .fov_y = 0.5f};
    begin_blob();
    add(MASU_BLOB_VERTICES, sizeof *vertices, 8, vertices);
    add(MASU_BLOB_INDICES, sizeof **orders, 12, orders[near_first]);
    add(MASU_BLOB_PRIMITIVES, sizeof primitive, 1, &primitive);
    add(MASU_BLOB_MESHES, sizeof mesh, 1, &mesh);
    add(MASU_BLOB_INSTANCES, sizeof instance, 1, &instance);
    add(MASU_BLOB_MATERIALS, sizeof material, 1, &material);
    add(MASU_BLOB_CAMERA_KEYS, sizeof key, 1, &key);
    add(MASU_BLOB_ENVIRONMENT, sizeof environment, 1, &environment);
    end_blob(name);
}

/* A closed mesh is blended correctly in itself, in any order of its triangles. The sun is low: the
 * tilted face gets almost none of its light, the other one much. */
static void the_far_side_of_a_thing_comes_first(void **state) {
    (void)state;
    static float pictures[2][4 * PIXELS];
    for (int near_first = 0; near_first < 2; near_first++) {
        write_faces("faces.masu", near_first);
        masu_session_desc d = panes_desc(in_scratch("faces.masu"));
        open_session(&s, &d);
        render(NULL, pictures[near_first]);
        close_session(&s);
    }
    uint32_t differ = 0;
    for (uint32_t i = 0; i < 4 * PIXELS; i++)
        differ += memcmp(&pictures[0][i], &pictures[1][i], sizeof **pictures) != 0;
    /* Half of the far face through the near one, which adds nothing; behind both is black. */
    double seen = (double)pictures[0][4 * (PIXELS / 2 + SIDE / 2)], far = 2 * 0.447 * 0.5;
    print_message("%u values differ; %.4f in the image, %.4f emitted\n", differ, seen, far);
    assert_int_equal(differ, 0);
    assert_true(fabs(seen - 0.5 * far) < 0.02 * far);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(panes_are_blended_the_farthest_first),
        cmocka_unit_test(what_adds_up_does_so_in_any_order),
        cmocka_unit_test(a_camera_moves_through_them),
        cmocka_unit_test(walls_hide_what_is_behind_them),
        cmocka_unit_test(a_pane_cuts_an_sdf_and_polygons_alike),
        cmocka_unit_test(panes_of_different_sets_take_turns),
        cmocka_unit_test(the_far_side_of_a_thing_comes_first),
    };
    return cmocka_run_group_tests(tests, make_scratch, remove_scratch);
}

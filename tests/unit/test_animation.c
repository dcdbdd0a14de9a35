/* test_animation.c: clips of models and skins, without a device: each rule for them in a blob,
 * broken one at a time; poses at times of a clip against the clip's keys; blends, ends, loops;
 * rejected calls, which change nothing; matrices and bounds of joints; the data written to a
 * frame's slot. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "scene/scene.h"
#include "support/bind.h"
#include "support/dry_renderer.h"
#include "support/random.h"
#include "support/scene_data.h"

static masu_detail failure; /* of the last call that failed */

#define PARTS (SUPPORT_ALL | SUPPORT_LIVE | SUPPORT_SKIN)

/* ---- Rules of the blob ----------------------------------------------------------------------- */

static support_blob broken;

#define OF(kind, type) ((type *)support_blob_find(&broken, MASU_BLOB_##kind))
#define CLIP OF(CLIPS, masu_blob_clip)
#define CHANNEL OF(CHANNELS, masu_blob_channel)
#define KEY OF(KEYS, masu_blob_key)
#define SKIN OF(SKINS, masu_blob_skin)
#define JOINT OF(JOINTS, masu_blob_joint)
#define SKIN_VERTEX OF(SKIN_VERTICES, masu_blob_skin_vertex)
#define NODE OF(MODEL_NODES, masu_blob_model_node)

#define REFUSED(section, element, ...)                                                             \
    do {                                                                                           \
        masu_scene at;                                                                             \
        masu_detail detail;                                                                        \
        support_blob_write(&broken, PARTS);                                                        \
        __VA_ARGS__;                                                                               \
        support_blob_seal(broken.bytes, broken.size);                                              \
        if (!support_bind(broken.bytes, broken.size, &at, &detail))                                \
            fail_msg("%s was accepted", #__VA_ARGS__);                                             \
        assert_int_equal(detail.result, MASU_ERROR_SCENE);                                         \
        if (strcmp(detail.what, section) || detail.given != (element))                             \
            fail_msg("%s was rejected as %s", #__VA_ARGS__, detail.text);                          \
    } while (0)

static void a_blob_tells_its_clips_and_skins(void **state) {
    (void)state;
    masu_scene at;
    support_blob_write(&broken, PARTS);
    support_accepted(&broken, &at);
    support_scene_data(&at)->blob = broken.bytes;
    assert_int_equal(masu_scene_data_of(&at)->clips, 2);
    assert_int_equal(masu_scene_data_of(&at)->channels, 3);
    assert_int_equal(masu_scene_data_of(&at)->keys, 6);
    assert_int_equal(masu_scene_data_of(&at)->skins, 1);
    assert_int_equal(masu_scene_data_of(&at)->joints, 2);
    assert_int_equal(masu_scene_data_of(&at)->skin_vertices, 4);
    assert_int_equal(masu_scene_data_of(&at)->skinned_vertices, 4);
    assert_int_equal(masu_scene_data_of(&at)->skinned_joints, 2);
    assert_int_equal(masu_scene_data_of(&at)->first_skinned, 7);
    assert_int_equal(masu_scene_data_of(&at)->max_skinned, 4);
    assert_int_equal(masu_scene_data_of(&at)->max_nodes, 2);
    assert_string_equal(masu_scene_clip_name(&at, 2, 0), "bend");
    assert_string_equal(masu_scene_clip_name(&at, 2, 1), "glow");
    assert_string_equal(masu_scene_clip_name(&at, 2, 2), "");
    assert_string_equal(masu_scene_clip_name(&at, 0, 0), "");
    assert_string_equal(masu_scene_clip_name(&at, 9, 0), "");
}

static void clips_that_are_none_are_refused(void **state) {
    (void)state;
    REFUSED("clips", 0, support_blob_drop(&broken, MASU_BLOB_CHANNELS));
    REFUSED("clips", 0, support_blob_drop(&broken, MASU_BLOB_KEYS));
    REFUSED("clips", 0, support_blob_drop(&broken, MASU_BLOB_CLIPS));
    REFUSED("clips", 1, CLIP[1].model = 3);
    REFUSED("clips", 0, CLIP[0].model = 1); /* model 1 is a copy of model 0 */
    REFUSED("clips", 1, CLIP[1].model = 0);
    REFUSED("clips", 0, CLIP[0].name = 1u << 20);
    REFUSED("clips", 0, CLIP[0].duration = -1.0f);
    REFUSED("clips", 0, CLIP[0].duration = (float)NAN);
    REFUSED("clips", 0, CLIP[0].first_channel = 1);
    REFUSED("clips", 1, CLIP[1].channel_count = 2);
    REFUSED("clips", 1, CLIP[1].channel_count = UINT32_MAX);
    REFUSED("channels", 2, CLIP[1].channel_count = 0);
    REFUSED("channels", 1, CHANNEL[1].node = 2);
    REFUSED("channels", 1, CHANNEL[1].path = 3);
    REFUSED("channels", 1, CHANNEL[1].step = 2);
    REFUSED("channels", 1, CHANNEL[1].first_key = 1);
    REFUSED("channels", 1, CHANNEL[1].key_count = 0);
    REFUSED("channels", 2, CHANNEL[2].key_count = UINT32_MAX);
    /* the same node and path as channel 0 */
    REFUSED("channels", 1, CHANNEL[1].node = 0, CHANNEL[1].path = 0, KEY[2].value[0] = 0);
    REFUSED("keys", 5, CHANNEL[2].key_count = 1);
    REFUSED("channels", 0, KEY[1].time = 0.0f);
    REFUSED("channels", 0, KEY[1].time = (float)NAN);
    REFUSED("channels", 0, KEY[0].time = -0.5f);
    REFUSED("channels", 0, KEY[1].value[2] = INFINITY);
    REFUSED("channels", 1, KEY[2].value[3] = 0.5f); /* not of unit length */
}

static void skins_that_are_none_are_refused(void **state) {
    (void)state;
    REFUSED("skins", 0, support_blob_drop(&broken, MASU_BLOB_JOINTS));
    REFUSED("skins", 0, support_blob_drop(&broken, MASU_BLOB_SKIN_VERTICES));
    REFUSED("model nodes", 3, support_blob_drop(&broken, MASU_BLOB_SKINS));
    REFUSED("model nodes", 3, NODE[3].skin = 2);
    REFUSED("model nodes", 0, NODE[2].skin = 1);
    REFUSED("skins", 0, NODE[3].skin = 0);
    REFUSED("skins", 0, SKIN[0].model = 3);
    REFUSED("skins", 0, SKIN[0].model = 1);
    REFUSED("skins", 0, SKIN[0].node = 2);
    REFUSED("skins", 0, SKIN[0].node = UINT32_MAX);
    REFUSED("skins", 0, SKIN[0].like = 1);
    REFUSED("skins", 0, SKIN[0].first_vertex = 8);
    REFUSED("skins", 0, SKIN[0].first_vertex = UINT32_MAX);
    REFUSED("skins", 0, SKIN[0].vertex_count = 0);
    REFUSED("skins", 0, SKIN[0].vertex_count = 3);
    REFUSED("skins", 0, SKIN[0].vertex_count = UINT32_MAX);
    REFUSED("skins", 0, SKIN[0].first_vertex = 6); /* not the last vertices */
    REFUSED("skins", 0, SKIN[0].first_skin_vertex = 1);
    REFUSED("skins", 0, SKIN[0].first_joint = 1);
    REFUSED("skins", 0, SKIN[0].joint_count = 0);
    REFUSED("skins", 0, SKIN[0].joint_count = 3);
    REFUSED("skin vertices", 0, SKIN[0].joint_count = 1);
    REFUSED("joints", 1, JOINT[1].node = 2);
    REFUSED("joints", 0, JOINT[0].inverse_bind[3] = (float)NAN);
    REFUSED("joints", 0, JOINT[0].used = 2);
    REFUSED("joints", 0, JOINT[0].high[1] = INFINITY);
    REFUSED("joints", 0, JOINT[0].low[0] = 3.0f);
    REFUSED("skin vertices", 0, JOINT[0].used = 0);
    REFUSED("skin vertices", 2, JOINT[1].high[1] = 1.0f);
    REFUSED("skin vertices", 2, SKIN_VERTEX[2].joints[3] = 2);
    REFUSED("skin vertices", 1, SKIN_VERTEX[1].weights[0]++);
    REFUSED("skin vertices", 3, SKIN_VERTEX[3].rest.position[1] = (float)NAN);
    REFUSED("occluders", 0, OF(OCCLUDERS, masu_blob_occluder)[0].mesh = 1,
            OF(OCCLUDERS, masu_blob_occluder)[0] =
                (masu_blob_occluder){{-1, -1, 0}, {1, 2, 0}, 1, 0});
    /* the mesh has a second instance */
    REFUSED("skins", 0, OF(INSTANCES, masu_blob_instance)[1].mesh = 1,
            OF(MODELS, masu_blob_model)[1].like = 1, OF(OCCLUDERS, masu_blob_occluder)[0].mesh = 0);
}

/* ---- Poses ----------------------------------------------------------------------------------- */

static masu_model lid;

static void start(void) {
    make_renderer(PARTS, 0);
    lid = masu_model_find(&m, "lid");
    assert_int_not_equal(lid.id, 0);
}

static masu_result pose(const masu_clip_use *uses, uint32_t count) {
    return masu_model_animate(&m, lid, uses, count, &failure);
}

static void pose_at(uint32_t clip, double time, uint32_t loop) {
    const masu_clip_use use = {.clip = clip, .time = time, .weight = 1.0f, .loop = loop};
    assert_int_equal(pose(&use, 1), MASU_OK);
}

static void assert_node(uint32_t node, const double expected[12]) {
    masu_node_state is;
    assert_int_equal(masu_model_node_get(&m, lid, node, &is, &failure), MASU_OK);
    for (uint32_t k = 0; k < 12; k++) {
        if (fabs((double)is.rows[k] - expected[k]) > 1e-6)
            fail_msg("node %u: rows[%u] is %g, not %g", node, k, (double)is.rows[k], expected[k]);
    }
}

/* "bend" keeps its rotation about y and is moved. */
static void assert_bend(double x, double z) {
    const double rows[12] = {0, 0, 1, x, 0, 1, 0, 0, -1, 0, 0, z};
    assert_node(0, rows);
}

/* "lid" rotated about z by an angle, and scaled. */
static void assert_lid(double angle, double sx, double sy, double sz) {
    double c = cos(angle), s = sin(angle);
    const double rows[12] = {c * sx, -s * sy, 0, 0, s * sx, c * sy, 0, 0, 0, 0, sz, 0};
    assert_node(1, rows);
}

static void clips_are_found(void **state) {
    (void)state;
    start();
    masu_model plate = masu_model_at(&m, 0), none = {0}, beyond = {lid.id + 1};
    assert_int_equal(masu_model_clips(&m, lid), 2);
    assert_int_equal(masu_model_clips(&m, plate), 0);
    assert_int_equal(masu_model_clips(&m, none), 0);
    assert_int_equal(masu_model_clips(&m, beyond), 0);
    assert_int_equal(masu_model_clip_find(&m, lid, "glow"), 1);
    assert_int_equal(masu_model_clip_find(&m, lid, "lid"), MASU_CLIP_NONE);
    assert_int_equal(masu_model_clip_find(&m, plate, "bend"), MASU_CLIP_NONE);
    assert_int_equal(masu_model_clip_find(&m, lid, ""), MASU_CLIP_NONE);
    assert_true(masu_model_clip_duration(&m, lid, 0) == 2.0);
    assert_true(masu_model_clip_duration(&m, lid, 1) == 0.5);
    assert_true(masu_model_clip_duration(&m, lid, 2) == 0.0);
}

static void a_pose_is_what_the_keys_say(void **state) {
    (void)state;
    const double half = acos(-1.0) / 2;
    start();
    pose_at(0, 0.0, 0);
    assert_bend(0, 0);
    assert_lid(0, 1, 1, 1);
    pose_at(0, 0.75, 0); /* a quarter of 180 degrees */
    assert_bend(1.5, 0.75);
    assert_lid(0.25 * 2 * half, 1, 1, 1);
    pose_at(0, 1.0, 0);
    assert_bend(2, 1);
    assert_lid(half, 1, 1, 1);
    pose_at(0, 1.8, 0); /* after the last rotation key */
    assert_bend(3.6, 1.8);
    assert_lid(2 * half, 1, 1, 1);
    pose_at(1, 0.2, 0); /* a step holds until the next key; nodes without channels keep their bind
                           pose */
    assert_bend(0, 0);
    assert_lid(0, 1, 1, 1);
    pose_at(1, 0.25, 0);
    assert_lid(0, 2, 3, 4);
    assert_int_equal(pose(NULL, 0), MASU_OK);
    assert_lid(0, 1, 1, 1);
}

static void ends_hold_or_come_round(void **state) {
    (void)state;
    start();
    pose_at(0, 1e300, 0);
    assert_bend(4, 2);
    pose_at(0, -1e300, 0);
    assert_bend(0, 0);
    pose_at(0, 2.0 * 1024 + 0.5, 1);
    assert_bend(1, 0.5);
    pose_at(0, -0.5, 1);
    assert_bend(3, 1.5);
    pose_at(0, 1e300, 1); /* an arbitrary time in the clip */
    masu_node_state is;
    assert_int_equal(masu_model_node_get(&m, lid, 0, &is, &failure), MASU_OK);
    assert_true(is.rows[3] >= 0.0f && is.rows[3] <= 4.0f);
}

static void clips_are_blended_by_weight(void **state) {
    (void)state;
    const double half = acos(-1.0) / 2;
    start();
    masu_clip_use both[3] = {{.clip = 0, .time = 2.0, .weight = 3.0f},
                             {.clip = 1, .time = 0.5, .weight = 1.0f},
                             {.clip = 1, .time = 0.0, .weight = 0.0f}};
    assert_int_equal(pose(both, 3), MASU_OK);
    assert_bend(3, 1.5);
    /* Quaternions (0 0 1 0) and (0 0 0 1), 3 to 1: the angle whose half has the tangent 3. */
    assert_lid(2 * atan(3.0), 1.25, 1.5, 1.75);
    both[0].weight = both[1].weight = 0.0f; /* total weight 0: bind pose */
    assert_int_equal(pose(both, 3), MASU_OK);
    assert_bend(0, 0);
    assert_lid(0, 1, 1, 1);
    both[0].weight = 3e38f; /* the sum overflows a float */
    both[1].weight = 3e38f;
    both[0].time = 1.0;
    assert_int_equal(pose(both, 2), MASU_OK);
    assert_lid(half / 2, 1.5, 2, 2.5);
}

/* A quaternion and its negative are the same rotation: interpolation between keys and between clips
 * takes the shorter way. */
static void rotations_go_the_shorter_way(void **state) {
    (void)state;
    const double half = acos(-1.0) / 2, root = sqrt(0.5);
    start();
    /* a quarter of a full rotation, on the other side */
    float *key = m.models.animation.keys[3].value;
    key[0] = key[1] = 0.0f;
    key[2] = key[3] = (float)-root;
    pose_at(0, 1.0, 0);
    assert_lid(half / 2, 1, 1, 1);
    pose_at(0, 1.25, 0);
    assert_lid(0.75 * half, 1, 1, 1);
    const masu_clip_use both[2] = {{.clip = 0, .time = 0.0, .weight = 1.0f},
                                   {.clip = 0, .time = 1.9, .weight = 1.0f}};
    assert_int_equal(pose(both, 2), MASU_OK);
    assert_lid(half / 2, 1, 1, 1);
}

/* A matrix of any rotation and scales, mirrored too, and its pose are the same. */
static void a_pose_keeps_its_matrix(void **state) {
    (void)state;
    uint64_t seed = 3;
    uint32_t mirrored = 0;
    for (uint32_t n = 0; n < 400; n++) {
        masu_node_pose pose;
        double square = 0;
        for (uint32_t k = 0; k < 4; k++) pose.rotation[k] = random_between(&seed, -1, 1);
        if (n < 16) /* half turns and quarter turns about the axes, too */
            for (uint32_t k = 0; k < 4; k++) pose.rotation[k] = n >> k & 1 ? 1 : 0;
        if (!n) pose.rotation[3] = 1;
        for (uint32_t k = 0; k < 4; k++) square += pose.rotation[k] * pose.rotation[k];
        for (uint32_t k = 0; k < 4; k++) pose.rotation[k] /= sqrt(square);
        for (uint32_t k = 0; k < 3; k++) {
            pose.translation[k] = random_between(&seed, -9, 9);
            pose.scale[k] = random_between(&seed, 0.1, 3) * (random_between(&seed, 0, 1) < 0.3 ? -1 : 1);
        }
        mirrored += pose.scale[0] * pose.scale[1] * pose.scale[2] < 0;
        float rows[12], again[12];
        masu_pose_rows(&pose, rows);
        pose = masu_pose_of(rows);
        masu_pose_rows(&pose, again);
        for (uint32_t k = 0; k < 12; k++) {
            if (fabs((double)again[k] - (double)rows[k]) > 2e-6)
                fail_msg("%u: rows[%u] is %g, not %g", n, k, (double)again[k], (double)rows[k]);
        }
    }
    assert_true(mirrored > 100 && mirrored < 300);
}

static void what_cannot_be_posed_changes_nothing(void **state) {
    (void)state;
    start();
    masu_clip_use use = {.clip = 0, .time = 1.0, .weight = 1.0f}, many[17] = {{0}};
    const float grown[12] = {1.5e38f, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const struct {
        masu_clip_use use;
        const char *what;
    } rows[] = {{{.clip = 2, .weight = 1.0f}, "uses[0].clip is 2, it has 2 clips"},
                {{.time = (double)NAN, .weight = 1.0f}, "time is not finite"},
                {{.time = (double)INFINITY, .weight = 1.0f}, "time is not finite"},
                {{.weight = -1.0f}, "weight is -1"},
                {{.weight = INFINITY}, "weight is inf"},
                {{.weight = (float)NAN}, "weight is nan"}};
    assert_int_equal(pose(&use, 1), MASU_OK);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(pose(&rows[i].use, 1), MASU_ERROR_ARGUMENT);
        if (!strstr(failure.text, rows[i].what))
            fail_msg("\"%s\" has no \"%s\"", failure.text, rows[i].what);
        assert_bend(2, 1);
    }
    assert_int_equal(pose(many, 17), MASU_ERROR_ARGUMENT);
    assert_int_equal(pose(NULL, 1), MASU_ERROR_ARGUMENT);
    assert_string_equal(failure.text, "uses is NULL");
    assert_int_equal(masu_model_animate(&m, (masu_model){0}, &use, 1, &failure),
                     MASU_ERROR_ARGUMENT);
    use.time = 1.5;
    assert_int_equal(masu_model_set_transform(&m, lid, grown, &failure), MASU_OK);
    assert_int_equal(pose(&use, 1), MASU_ERROR_ARGUMENT); /* 3 times 1.5e38 overflows */
    assert_non_null(strstr(failure.text, "beyond what a float holds"));
    assert_bend(2, 1);
    /* A model without clips still has a pose: its own. */
    assert_int_equal(masu_model_animate(&m, masu_model_at(&m, 0), NULL, 0, &failure), MASU_OK);
}

/* ---- Joints ---------------------------------------------------------------------------------- */

/* Positions of the skin's vertices by the matrices in the slot. */
static void bend_all(const unsigned char *slot, double out[4][3]) {
    const masu_skin *skin = &m.models.skins.skins[0];
    support_blob_write(&broken, PARTS);
    for (uint32_t v = 0; v < 4; v++) {
        const masu_blob_skin_vertex *from = &SKIN_VERTEX[v];
        memset(out[v], 0, sizeof out[v]);
        for (uint32_t i = 0; i < 4; i++) {
            float rows[12];
            memcpy(rows, slot + 32 + 48 * (size_t)(skin->first_matrix + from->joints[i]),
                   sizeof rows);
            for (uint32_t k = 0; k < 3; k++) {
                double at = (double)rows[4 * k + 3];
                for (uint32_t c = 0; c < 3; c++)
                    at += (double)rows[4 * k + c] * (double)from->rest.position[c];
                out[v][k] += at * from->weights[i] / 65535.0;
            }
        }
    }
}

static void assert_in_box(double bent[4][3]) {
    masu_instance_state is;
    assert_int_equal(masu_instance_get(&m, masu_instance_find(&m, "lid"), &is, &failure), MASU_OK);
    for (uint32_t v = 0; v < 4; v++) {
        for (uint32_t k = 0; k < 3; k++) {
            const float *row = is.rows + 4 * k;
            double world = (double)row[3];
            for (uint32_t c = 0; c < 3; c++) world += (double)row[c] * bent[v][c];
            assert_true(world >= (double)is.box_low[k] && world <= (double)is.box_high[k]);
        }
    }
}

static void a_slot_has_matrices_of_both_frames(void **state) {
    (void)state;
    masu_rung rung = {.scale = 1.0f, .temporal = MASU_ON};
    make_renderer_with(PARTS, 0, &rung, 1);
    assert_true(m.plan.needs.velocity);
    lid = masu_model_find(&m, "lid");
    uint64_t half = masu_joints_bytes(&m.plan.scene);
    double now[4][3], before[4][3], first[4][3];
    masu_frame_desc frame = {.rung = 0};
    write_good(&frame, 0);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 0), first);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 0) + half, before);
    assert_memory_equal(first, before, sizeof first); /* nothing has moved */
    pose_at(0, 1.0, 0);
    m.timeline.frame = 1; /* the first is a cut */
    write_good(&frame, 1);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 1), now);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 1) + half, before);
    assert_memory_equal(before, first, sizeof first);
    assert_true(memcmp(now, first, sizeof now) != 0);
    assert_in_box(now);
    /* The next frame is unchanged: both halves of its slot are equal. */
    write_good(&frame, 0);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 0), first);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 0) + half, before);
    assert_memory_equal(first, now, sizeof now);
    assert_memory_equal(before, now, sizeof now);
    /* After a cut there are no previous positions. */
    pose_at(0, 2.0, 0);
    frame.cut = 1;
    write_good(&frame, 1);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 1), now);
    bend_all(slot_bytes(MASU_BUFFER_JOINTS, 1) + half, before);
    assert_memory_equal(before, now, sizeof now);
    /* Hidden models have no vertices to skin. */
    uint32_t header[4];
    memcpy(header, slot_bytes(MASU_BUFFER_JOINTS, 1), sizeof header);
    const uint32_t shown[4] = {0, 7, 4, 2};
    assert_memory_equal(header, shown, sizeof header);
    assert_int_equal(masu_model_show(&m, lid, 0, &failure), MASU_OK);
    write_good(&frame, 0);
    memcpy(header, slot_bytes(MASU_BUFFER_JOINTS, 0), sizeof header);
    assert_int_equal(header[2], 0);
}

/* The skin's position in the world follows only from its joints: moving the node that shows it has
 * no effect. */
static void a_skin_is_where_its_joints_are(void **state) {
    (void)state;
    start();
    masu_frame_desc frame = {.rung = 0};
    double bent[4][3], world[2][4][3];
    for (int turn = 0; turn < 2; turn++) {
        const float aside[12] = {0.5f, 0, 0, 3, 0, 2, 0, -1, 0, 0, 1, 7};
        masu_instance_state is;
        /* Joint 1 is the node itself, so only weights of joint 0 are used. */
        if (turn) assert_int_equal(masu_model_node_set(&m, lid, 1, aside, &failure), MASU_OK);
        write_good(&frame, (uint32_t)turn);
        const masu_skin *skin = &m.models.skins.skins[0];
        float (*matrix)[12] = &m.models.skins.now[skin->first_matrix];
        assert_int_equal(masu_instance_get(&m, masu_instance_find(&m, "lid"), &is, &failure),
                         MASU_OK);
        for (uint32_t v = 0; v < 4; v++) {
            const double p[3] = {v & 1 ? 2 : -2, v & 2 ? 2 : -2, 0.5};
            for (uint32_t k = 0; k < 3; k++) {
                bent[v][k] = (double)matrix[0][4 * k + 3];
                for (uint32_t c = 0; c < 3; c++) bent[v][k] += (double)matrix[0][4 * k + c] * p[c];
            }
            for (uint32_t k = 0; k < 3; k++) {
                world[turn][v][k] = (double)is.rows[4 * k + 3];
                for (uint32_t c = 0; c < 3; c++)
                    world[turn][v][k] += (double)is.rows[4 * k + c] * bent[v][c];
                if (turn && fabs(world[1][v][k] - world[0][v][k]) > 1e-5)
                    fail_msg("vertex %u is at %g, was at %g", v, world[1][v][k], world[0][v][k]);
            }
        }
    }
}

/* At many times of the clip no vertex leaves the bounds that culling uses. */
static void boxes_hold_what_bends(void **state) {
    (void)state;
    start();
    masu_frame_desc frame = {.rung = 0};
    double bent[4][3];
    for (uint32_t i = 0; i <= 40; i++) {
        pose_at(0, i * 0.05, 0);
        write_good(&frame, i % 2);
        bend_all(slot_bytes(MASU_BUFFER_JOINTS, i % 2), bent);
        assert_in_box(bent);
    }
}

static void without_skins_there_is_nothing_of_it(void **state) {
    (void)state;
    make_renderer(SUPPORT_ALL | SUPPORT_LIVE, 0);
    static const masu_buffer_id none[] = {MASU_BUFFER_SKIN_VERTICES, MASU_BUFFER_JOINTS,
                                          MASU_BUFFER_PREVIOUS_VERTICES};
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_int_equal(m.plan.buffers[none[i]].bytes, 0);
    assert_false(m.plan.buffers[MASU_BUFFER_VERTICES].usage & VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
    for (uint32_t r = 0; r < m.plan.desc.rung_count; r++) {
        assert_false(masu_has_pass(&m.plan.rungs[r].active, MASU_PASS_SKIN));
        assert_false(masu_has_pass(&m.plan.rungs[r].active, MASU_PASS_SKIN_PREVIOUS));
    }
    assert_int_equal(masu_model_clips(&m, masu_model_at(&m, 0)), 0);
    /* Also with skins, a rung that reads no velocities has only the first pass. */
    make_renderer(PARTS, 0);
    assert_true(masu_has_pass(&m.plan.rungs[0].active, MASU_PASS_SKIN));
    assert_false(masu_has_pass(&m.plan.rungs[0].active, MASU_PASS_SKIN_PREVIOUS));
    assert_int_equal(m.plan.buffers[MASU_BUFFER_PREVIOUS_VERTICES].bytes, 0);
    assert_int_equal(m.plan.buffers[MASU_BUFFER_SKIN_VERTICES].bytes, 4 * 32);
}

/* ---- Morph targets --------------------------------------------------------------------------- */

#define TARGET OF(MORPH_TARGETS, masu_blob_morph_target)
#define DELTA OF(MORPH_DELTAS, masu_blob_morph_delta)
#undef PARTS
#define PARTS (SUPPORT_ALL | SUPPORT_LIVE | SUPPORT_SKIN | SUPPORT_MORPH)

static void morphs_that_are_none_are_refused(void **state) {
    (void)state;
    REFUSED("skins", 0, support_blob_drop(&broken, MASU_BLOB_MORPH_TARGETS));
    REFUSED("skins", 0, support_blob_drop(&broken, MASU_BLOB_MORPH_DELTAS));
    REFUSED("channels", 2, SKIN[0].target_count = 0);
    REFUSED("skins", 0, SKIN[0].target_count = 3);
    REFUSED("morph targets", 1, SKIN[0].target_count = 1);
    REFUSED("skins", 0, SKIN[0].first_target = 1);
    REFUSED("skins", 0, SKIN[0].first_delta = 1);
    REFUSED("channels", 2, CHANNEL[2].target = 2);
    REFUSED("channels", 1, CHANNEL[1].target = 1);
    REFUSED("channels", 2, KEY[5].value[0] = 2e6f);
    REFUSED("morph targets", 1, TARGET[1].weight = (float)NAN);
    REFUSED("morph targets", 0, TARGET[0].high[1] = 0.5f);
    REFUSED("morph targets", 1, TARGET[1].low[0] = -INFINITY);
    REFUSED("morph targets", 0, TARGET[0].name = 1u << 20);
    REFUSED("morph targets", 1, DELTA[6].position[2] = (float)NAN);
}

static void start_morphs(void) {
    const masu_rung rung = {.temporal = MASU_ON};
    make_renderer_with(PARTS, 0, &rung, 1);
    lid = masu_model_find(&m, "lid");
    assert_int_not_equal(lid.id, 0);
}

/* The morph targets with an effect, as written to the slot: first delta and weight. */
static uint32_t told_morphs(const unsigned char *slot, uint32_t out[2][2]) {
    uint32_t header[8], count;
    memcpy(header, slot, sizeof header);
    assert_int_not_equal(header[7], 0);
    memcpy(&count, slot + (size_t)16 * header[7], sizeof count);
    assert_true(count <= 2);
    for (uint32_t i = 0; i < count; i++) memcpy(out[i], slot + (size_t)16 * (header[7] + 1 + i), 8);
    return count;
}

static float as_float(uint32_t bits) {
    float f;
    memcpy(&f, &bits, sizeof f);
    return f;
}

static void weights_are_those_of_clips_and_of_the_host(void **state) {
    (void)state;
    uint32_t told[2][2];
    float box[6], before[6];
    start_morphs();
    const masu_skins *s = &m.models.skins;
    assert_true(fabs((double)s->weights[0] - (0)) <= 0); /* default weight */
    assert_true(fabs((double)s->weights[1] - (0.5)) <= 0);
    pose_at(0, 0.5, 0);
    assert_true(fabs((double)s->weights[0] - (0.25)) <= 1e-6); /* a quarter of the way */
    assert_true(fabs((double)s->weights[1] - (0.5)) <= 0);      /* no clip changes it */
    /* Blended with an equal weight of a clip without this target: half of the value. */
    const masu_clip_use both[2] = {{.clip = 0, .time = 0.5, .weight = 1.0f},
                                   {.clip = 1, .weight = 1.0f}};
    assert_int_equal(pose(both, 2), MASU_OK);
    assert_true(fabs((double)s->weights[0] - (0.125)) <= 1e-6);
    memcpy(before, m.bounds.meshes[m.instances.meshes[s->skins[0].instance]], sizeof before);
    assert_int_equal(masu_model_morph_set(&m, lid, "glow", -2.0f, &failure), MASU_OK);
    memcpy(box, m.bounds.meshes[m.instances.meshes[s->skins[0].instance]], sizeof box);
    assert_true(box[3] - box[0] > before[3] - before[0] + 1.5f ||
                box[5] - box[2] > before[5] - before[2] + 1.5f);
    assert_int_equal(masu_model_morph_set(&m, lid, "none", 1.0f, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_morph_set(&m, lid, "bend", (float)NAN, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_morph_set(&m, lid, NULL, 1.0f, &failure), MASU_ERROR_ARGUMENT);
    assert_int_equal(masu_model_morph_set(&m, (masu_model){0}, "bend", 1.0f, &failure),
                     MASU_ERROR_ARGUMENT);
    assert_true(fabs((double)s->weights[1] - (-2)) <= 0);
    /* The slot has both this frame and the previous one. */
    masu_frame_desc frame = {.rung = 0};
    write_good(&frame, 0);
    assert_int_equal(told_morphs(slot_bytes(MASU_BUFFER_JOINTS, 0), told), 2);
    assert_int_equal(told[0][0], 8); /* after four vertices of two elements */
    assert_int_equal(told[1][0], 12);
    assert_true(fabs((double)as_float(told[1][1]) - (-2)) <= 0);
    assert_int_equal(masu_model_morph_set(&m, lid, "bend", 0.0f, &failure), MASU_OK);
    m.timeline.frame = 1; /* the first is a cut */
    write_good(&frame, 1);
    const unsigned char *slot = slot_bytes(MASU_BUFFER_JOINTS, 1);
    assert_int_equal(told_morphs(slot, told), 1);
    assert_int_equal(told[0][0], 12);
    /* the previous frame */
    assert_int_equal(told_morphs(slot + masu_joints_bytes(&m.plan.scene), told), 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_blob_tells_its_clips_and_skins),
        cmocka_unit_test(clips_that_are_none_are_refused),
        cmocka_unit_test(skins_that_are_none_are_refused),
        cmocka_unit_test(clips_are_found),
        cmocka_unit_test(a_pose_is_what_the_keys_say),
        cmocka_unit_test(ends_hold_or_come_round),
        cmocka_unit_test(clips_are_blended_by_weight),
        cmocka_unit_test(rotations_go_the_shorter_way),
        cmocka_unit_test(a_pose_keeps_its_matrix),
        cmocka_unit_test(what_cannot_be_posed_changes_nothing),
        cmocka_unit_test(a_slot_has_matrices_of_both_frames),
        cmocka_unit_test(a_skin_is_where_its_joints_are),
        cmocka_unit_test(boxes_hold_what_bends),
        cmocka_unit_test(without_skins_there_is_nothing_of_it),
        cmocka_unit_test(morphs_that_are_none_are_refused),
        cmocka_unit_test(weights_are_those_of_clips_and_of_the_host),
    };
    return cmocka_run_group_tests(tests, support_make_edge, NULL);
}

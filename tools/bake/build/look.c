/* look.c: camera path, shadow map and environment of the blob, as the scene specifies; defaults
 * depend on the bounds of the visible objects; see build.h. */
#include "bake/build/look.h"

/* Depth is n / z in a float: its relative precision is the float's for any near plane. */
#define NEAR 0.01

static double box_radius(const masu_bake_box *box) {
    if (masu_bake_box_is_empty(box)) return 1.0;
    masu_bake_vec3 extent = masu_bake_sub(box->high, box->low);
    double most = fmax(fabs(box->low.x), fabs(box->high.x));
    most = fmax(most, fmax(fabs(box->low.y), fabs(box->high.y)));
    most = fmax(most, fmax(fabs(box->low.z), fabs(box->high.z)));
    /* A scene of one distant point also needs a distance that its floats can represent. */
    return fmax(masu_bake_length(extent) / 2, fmax(most * 1e-5, 1e-3));
}

/* The bounding sphere fills the height of the frame. */
static masu_blob_camera_key framing_key(const masu_bake_box *box, double fov_y) {
    masu_bake_vec3 center = {0, 0, 0}, direction = {0.62, 0.42, 1.0};
    if (!masu_bake_box_is_empty(box)) {
        center = masu_bake_mad(box->low, masu_bake_sub(box->high, box->low), 0.5);
    }
    masu_bake_normalize(&direction);
    double distance = box_radius(box) / sin(fov_y * (MASU_BAKE_PI / 360.0));
    masu_blob_camera_key key = {.time = 0, .fov_y = (float)(fov_y * (MASU_BAKE_PI / 180.0))};
    masu_bake_store(masu_bake_mad(center, direction, distance), key.position);
    masu_bake_store(center, key.target);
    return key;
}

/* An orthographic camera is approximated by a narrow lens far behind the image plane, which becomes
 * the near plane. The size is exact at the target. At half an image height in front or behind, the
 * error is 0.035 %, 0.34 pixels at the edge of 1920 x 1080. The rounding of floats at that distance
 * costs 0.1 pixels, and more with a narrower lens. Returns the least distance by which the camera
 * has moved back. */
#define LENS 0.0007 /* radians */

static double flatten(double height, masu_blob_camera_key *keys, size_t count) {
    double least = HUGE_VAL;
    for (size_t i = 0; i < count; i++) {
        masu_bake_vec3 target = masu_bake_v3f(keys[i].target),
                       position = masu_bake_v3f(keys[i].position);
        masu_bake_vec3 back = masu_bake_sub(position, target);
        double own = masu_bake_length(back), distance = fmax(height / 2 / tan(LENS / 2), own);
        masu_bake_normalize(&back);
        masu_bake_store(masu_bake_mad(target, back, distance), keys[i].position);
        keys[i].fov_y = (float)(2 * atan(height / 2 / distance));
        least = fmin(least, distance - own);
    }
    return least;
}

/* Adds keys between those of a rotating path: at such distances positions are interpolated along a
 * chord. At TURN radians the chord is 0.04 of the frame's height closer than the arc. */
#define TURN 0.015
#define HALVINGS 12

static masu_bake_vec3 direction_of(const masu_blob_camera_key *key) {
    masu_bake_vec3 to = masu_bake_sub(masu_bake_v3f(key->position), masu_bake_v3f(key->target));
    masu_bake_normalize(&to);
    return to;
}

static void append_between(const masu_blob_camera_key *a, const masu_blob_camera_key *b,
                           int halvings, masu_bake_buffer *out) {
    masu_blob_camera_key middle = *a;
    if (halvings == 0 || masu_bake_length(masu_bake_sub(direction_of(b), direction_of(a))) <= TURN)
        return;
    middle.time = (float)(((double)a->time + (double)b->time) / 2);
    for (int k = 0; k < 3; k++) {
        middle.position[k] = (float)(((double)a->position[k] + (double)b->position[k]) / 2);
        middle.target[k] = (float)(((double)a->target[k] + (double)b->target[k]) / 2);
    }
    masu_bake_vec3 apart =
        masu_bake_sub(masu_bake_v3f(middle.position), masu_bake_v3f(middle.target));
    if (!(middle.time > a->time && middle.time < b->time && masu_bake_length(apart) > 0)) return;
    append_between(a, &middle, halvings - 1, out);
    masu_bake_append(out, &middle, sizeof middle);
    append_between(&middle, b, halvings - 1, out);
}

static void append_keys(const masu_blob_camera_key *keys, size_t count, masu_bake_buffer *out) {
    for (size_t i = 0; i < count; i++) {
        masu_bake_append(out, &keys[i], sizeof keys[i]);
        if (i + 1 < count) append_between(&keys[i], &keys[i + 1], HALVINGS, out);
    }
}

static double add_camera(const masu_bake_look *l, const masu_bake_box *bounds,
                         masu_bake_content *content) {
    masu_bake_buffer *keys = &content->section[MASU_BLOB_CAMERA_KEYS];
    masu_blob_camera_key key = framing_key(bounds, l->fov_y);
    if (l->key_count && l->height > 0)
        append_keys(l->keys, l->key_count, keys);
    else if (l->key_count)
        masu_bake_append(keys, l->keys, l->key_count * sizeof *l->keys);
    else
        masu_bake_append(keys, &key, sizeof key);
    return l->height > 0 ? flatten(l->height, (masu_blob_camera_key *)(void *)keys->data,
                                   keys->bytes / sizeof key)
                         : 0;
}

/* The sun's shadow map contains only polygons: it is omitted if there are none. */
static void add_shadow(const masu_bake_look *l, const masu_bake_box *bounds, double back,
                       masu_bake_content *content) {
    double distance =
        l->shadow_distance > 0 ? l->shadow_distance : fmin(6 * box_radius(bounds), 200);
    masu_blob_shadow out = l->shadow;
    out.distance = fmaxf((float)(distance + back), 1e-3f);
    if (l->shadows && masu_bake_count(content, MASU_BLOB_INSTANCES) > 0)
        masu_bake_append(&content->section[MASU_BLOB_SHADOW], &out, sizeof out);
}

static void add_environment(const masu_bake_look *l, const masu_bake_box *bounds, double back,
                            masu_bake_content *content) {
    double near = l->near > 0 ? l->near : fmax(fmin(box_radius(bounds) * 0.02, NEAR), 1e-6);
    masu_bake_vec3 sun = l->sun_color;
    if (l->turbidity > 0 && !l->own_sun_color) sun = masu_bake_v3(0, 0, 0);
    masu_blob_environment e = {.exposure = (float)l->exposure,
                               .metered = l->metered ? 1.0f : 0.0f,
                               .brighten = (float)l->brighten,
                               .darken = (float)l->darken,
                               .near_distance = (float)(near + back),
                               .fog_density = (float)l->fog_density,
                               .fog_height = (float)l->fog_height,
                               .fog_falloff = (float)l->fog_falloff,
                               .fog_start = (float)(l->fog_start + (l->fog_density > 0 ? back : 0)),
                               .smooth_edges = l->smooth_edges ? 1.0f : 0.0f};
    masu_bake_store(l->fog_color, e.fog_color);
    masu_bake_store(l->sun_direction, e.sun_direction);
    e.turbidity = (float)l->turbidity;
    if (l->turbidity > 0) masu_bake_store(l->ground, e.ground);
    masu_bake_store(
        masu_bake_v3(sun.x * l->sun_intensity, sun.y * l->sun_intensity, sun.z * l->sun_intensity),
        e.sun_color);
    double reach =
        l->occlusion_radius > 0 ? l->occlusion_radius : fmin(box_radius(bounds) * 0.2, 1);
    /* Rounded as in the check of the blob. */
    if (l->occlusion) e.occlusion_radius = fmaxf((float)reach, 1e-3f);
    masu_bake_store(l->ambient, e.ambient);
    masu_bake_store(l->zenith, e.sky_zenith);
    masu_bake_store(l->horizon, e.sky_horizon);
    masu_bake_append(&content->section[MASU_BLOB_ENVIRONMENT], &e, sizeof e);
}

void masu_bake_build_look(const masu_bake_look *look, const masu_bake_box *bounds,
                          masu_bake_content *content) {
    double back = add_camera(look, bounds, content);
    add_shadow(look, bounds, back, content);
    add_environment(look, bounds, back, content);
    if (back > 0 && content->section[MASU_BLOB_SDF].bytes)
        MASU_BAKE_ARRAY(content, MASU_BLOB_SDF, masu_blob_sdf)->max_distance += (float)back;
}

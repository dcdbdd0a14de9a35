/* look.c: camera path, sun and sky of a scene, and what they are when the scene says nothing:
 * a three-quarter view of the whole scene under a high sun. */
#include "bake/scene/scene.h"

#include <string.h>

#define FOV_Y_DEFAULT 40.0 /* degrees */
#define RADIANCE_MAX 1e6

static float radians(double degrees) { return (float)(degrees * (MASU_BAKE_PI / 180.0)); }

static void to_floats(masu_bake_vec3 v, float out[3]) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* ---- camera ---- */

static double box_radius(const masu_bake_box *box) {
    if (masu_bake_box_is_empty(box)) return 1.0;
    masu_bake_vec3 extent = masu_bake_sub(box->high, box->low);
    double most = fmax(fabs(box->low.x), fabs(box->high.x));
    most = fmax(most, fmax(fabs(box->low.y), fabs(box->high.y)));
    most = fmax(most, fmax(fabs(box->low.z), fabs(box->high.z)));
    /* A scene of one point far away still needs a distance that its floats can express. */
    return fmax(masu_bake_length(extent) / 2, fmax(most * 1e-5, 1e-3));
}

/* The sphere around the box fills the height of the picture. */
static masu_blob_camera_key framing_key(const masu_bake_box *box, double fov_y) {
    masu_bake_vec3 center = {0, 0, 0}, direction = {0.62, 0.42, 1.0};
    if (!masu_bake_box_is_empty(box)) {
        center = masu_bake_mad(box->low, masu_bake_sub(box->high, box->low), 0.5);
    }
    masu_bake_normalize(&direction);
    double distance = box_radius(box) / sin(fov_y * (MASU_BAKE_PI / 360.0));
    masu_blob_camera_key key = {.time = 0, .fov_y = radians(fov_y)};
    to_floats(masu_bake_mad(center, direction, distance), key.position);
    to_floats(center, key.target);
    return key;
}

static double default_near(const masu_bake_box *box) {
    return fmin(fmax(box_radius(box) * 0.02, 1e-6), 1e6);
}

static bool read_key(const masu_bake_json *at, double fov_y, masu_blob_camera_key *key) {
    static const char *const members[] = {"time", "position", "target", "fov_y", NULL};
    const double most = MASU_BAKE_COORDINATE_MAX;
    masu_bake_vec3 position = {0, 0, 0}, target = {0, 0, 0};
    double time = 0;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "time", -1e6, 1e6, &time) ||
        !masu_bake_json_vec3(at, "position", -most, most, &position) ||
        !masu_bake_json_vec3(at, "target", -most, most, &target) ||
        !masu_bake_json_number(at, "fov_y", 0.1, 170, &fov_y)) {
        return false;
    }
    if (!masu_bake_json_has(at, "position") || !masu_bake_json_has(at, "target")) {
        return masu_bake_json_wrong(at, "needs \"position\" and \"target\"");
    }
    *key = (masu_blob_camera_key){.time = (float)time, .fov_y = radians(fov_y)};
    to_floats(position, key->position);
    to_floats(target, key->target);
    if (memcmp(key->position, key->target, sizeof key->position) == 0) {
        return masu_bake_json_wrong(at, "position and target are the same point");
    }
    return true;
}

static bool read_keys(const masu_bake_json *keys, double fov_y, masu_bake_content *content) {
    if (!masu_bake_json_array(keys, 1)) return false;
    float last = 0;
    for (size_t i = 0; i < json_array_size(keys->value); i++) {
        masu_bake_json at = masu_bake_json_element(keys, i);
        masu_blob_camera_key key;
        if (!read_key(&at, fov_y, &key)) return false;
        if (i > 0 && !(key.time > last)) {
            return masu_bake_json_wrong(&at, "time must be later than that of the key before");
        }
        last = key.time;
        masu_bake_append(&content->section[MASU_BLOB_CAMERA_KEYS], &key, sizeof key);
    }
    return true;
}

static bool read_camera(const masu_bake_json *scene, const masu_bake_box *bounds,
                        masu_bake_content *content, double *near) {
    static const char *const members[] = {"fov_y", "near", "keys", NULL};
    masu_bake_json camera = masu_bake_json_member(scene, "camera");
    double fov_y = FOV_Y_DEFAULT;
    if (camera.value) {
        if (!masu_bake_json_object(&camera, members) ||
            !masu_bake_json_number(&camera, "fov_y", 0.1, 170, &fov_y) ||
            !masu_bake_json_number(&camera, "near", 1e-6, 1e6, near)) {
            return false;
        }
        masu_bake_json keys = masu_bake_json_member(&camera, "keys");
        if (keys.value) return read_keys(&keys, fov_y, content);
    }
    masu_blob_camera_key key = framing_key(bounds, fov_y);
    masu_bake_append(&content->section[MASU_BLOB_CAMERA_KEYS], &key, sizeof key);
    return true;
}

/* ---- light ---- */

typedef struct look {
    double occlusion_radius;
    masu_bake_vec3 sun_direction, sun_color, ambient, zenith, horizon;
    masu_bake_vec3 fog_color;
    double brighten, darken; /* of the exposure, 1/s; 0: the renderer's default */
    bool metered;
    double sun_intensity, exposure, near, fog_density, fog_height, fog_falloff, fog_start;
    double turbidity; /* 0: the two colours */
    masu_bake_vec3 ground;
    bool own_sun_color;
} look;

static masu_bake_vec3 direction_of(double azimuth, double elevation) {
    double a = azimuth * (MASU_BAKE_PI / 180.0), e = elevation * (MASU_BAKE_PI / 180.0);
    return masu_bake_v3(cos(e) * sin(a), sin(e), cos(e) * cos(a));
}

static look default_look(const masu_bake_box *bounds) {
    return (look){.sun_direction = direction_of(60, 50),
                  .sun_color = {1, 0.96, 0.9},
                  .sun_intensity = 1,
                  .ambient = {0.18, 0.2, 0.25},
                  .zenith = {0.16, 0.32, 0.62},
                  .horizon = {0.72, 0.8, 0.88},
                  .exposure = 1,
                  .ground = {0.2, 0.2, 0.2},
                  .near = default_near(bounds)};
}

static bool read_whole(const masu_bake_json *at, const char *name, uint32_t low, uint32_t high,
                       uint32_t *out) {
    double value = *out;
    if (!masu_bake_json_number(at, name, low, high, &value)) return false;
    if (value != floor(value)) {
        masu_bake_json where = masu_bake_json_member(at, name);
        return masu_bake_json_wrong(&where, "expected a whole number");
    }
    *out = (uint32_t)value;
    return true;
}

/* The sun's shadow map, for polygons: without any it is left out. */
static bool read_shadows(const masu_bake_json *sun, const masu_bake_box *bounds,
                         masu_bake_content *content) {
    static const char *const members[] = {"cascades", "resolution", "distance", "lambda", NULL};
    masu_bake_json shadows = masu_bake_json_member(sun, "shadows");
    if (!shadows.value) return true;
    masu_blob_shadow out = {.cascades = 3, .resolution = 1024};
    double distance = fmin(6 * box_radius(bounds), 200), lambda = 0.75;
    if (!masu_bake_json_object(&shadows, members) ||
        !read_whole(&shadows, "cascades", 1, MASU_SHADOW_CASCADES_MAX, &out.cascades) ||
        !read_whole(&shadows, "resolution", MASU_SHADOW_SIZE_MIN, MASU_SHADOW_SIZE_MAX,
                    &out.resolution) ||
        !masu_bake_json_number(&shadows, "distance", 1e-3, 1e9, &distance) ||
        !masu_bake_json_number(&shadows, "lambda", 0, 1, &lambda)) {
        return false;
    }
    out.distance = fmaxf((float)distance, 1e-3f);
    out.lambda = (float)lambda;
    if (masu_bake_count(content, MASU_BLOB_INSTANCES) > 0)
        masu_bake_append(&content->section[MASU_BLOB_SHADOW], &out, sizeof out);
    return true;
}

static bool read_sun(const masu_bake_json *scene, const masu_bake_box *bounds, look *l,
                     masu_bake_content *content) {
    static const char *const members[] = {"direction", "azimuth", "elevation", "color",
                                          "intensity", "shadows", NULL};
    masu_bake_json sun = masu_bake_json_member(scene, "sun");
    if (!sun.value) return true;
    double azimuth = 60, elevation = 50;
    masu_bake_vec3 direction = l->sun_direction;
    if (!masu_bake_json_object(&sun, members) ||
        !masu_bake_json_number(&sun, "azimuth", -360, 360, &azimuth) ||
        !masu_bake_json_number(&sun, "elevation", -90, 90, &elevation) ||
        !masu_bake_json_vec3(&sun, "direction", -1e6, 1e6, &direction) ||
        !masu_bake_json_vec3(&sun, "color", 0, RADIANCE_MAX, &l->sun_color) ||
        !masu_bake_json_number(&sun, "intensity", 0, 1000, &l->sun_intensity) ||
        !read_shadows(&sun, bounds, content)) {
        return false;
    }
    l->own_sun_color = masu_bake_json_has(&sun, "color") || masu_bake_json_has(&sun, "intensity");
    bool angles = masu_bake_json_has(&sun, "azimuth") || masu_bake_json_has(&sun, "elevation");
    if (masu_bake_json_has(&sun, "direction")) {
        if (angles) {
            return masu_bake_json_wrong(&sun, "give either \"direction\" or the two angles");
        }
        if (!masu_bake_normalize(&direction)) {
            masu_bake_json at = masu_bake_json_member(&sun, "direction");
            return masu_bake_json_wrong(&at, "has no length");
        }
        l->sun_direction = direction;
    } else if (angles) {
        l->sun_direction = direction_of(azimuth, elevation);
    }
    return true;
}

/* With a turbidity the sky follows from the sun: two colours, an ambient light of one's own and a
 * ground without turbidity would be said in vain. */
static bool read_sky(const masu_bake_json *scene, look *l) {
    static const char *const members[] = {"zenith", "horizon", "turbidity", "ground", NULL};
    masu_bake_json sky = masu_bake_json_member(scene, "sky");
    if (!sky.value) return true;
    if (!masu_bake_json_object(&sky, members) ||
        !masu_bake_json_vec3(&sky, "zenith", 0, RADIANCE_MAX, &l->zenith) ||
        !masu_bake_json_vec3(&sky, "horizon", 0, RADIANCE_MAX, &l->horizon) ||
        !masu_bake_json_number(&sky, "turbidity", 1.5, 10, &l->turbidity) ||
        !masu_bake_json_vec3(&sky, "ground", 0, 1, &l->ground)) {
        return false;
    }
    bool analytic = masu_bake_json_has(&sky, "turbidity");
    bool colors = masu_bake_json_has(&sky, "zenith") || masu_bake_json_has(&sky, "horizon");
    if (analytic && (colors || masu_bake_json_has(scene, "ambient"))) {
        return masu_bake_json_wrong(
            &sky, "with \"turbidity\" the colours of the sky and \"ambient\" follow from the sun");
    }
    if (!analytic && masu_bake_json_has(&sky, "ground"))
        return masu_bake_json_wrong(&sky, "\"ground\" is of a sky with \"turbidity\"");
    return true;
}

static bool read_occlusion(const masu_bake_json *scene, look *l) {
    static const char *const members[] = {"radius", NULL};
    masu_bake_json occlusion = masu_bake_json_member(scene, "ambient_occlusion");
    if (!occlusion.value) return true;
    l->occlusion_radius = 1;
    return masu_bake_json_object(&occlusion, members) &&
           masu_bake_json_number(&occlusion, "radius", 1e-3, 1e6, &l->occlusion_radius);
}

/* A number is the exposure; an object asks for a metered one. */
static bool read_exposure(const masu_bake_json *scene, look *l) {
    static const char *const members[] = {"factor", "brighten", "darken", NULL};
    masu_bake_json exposure = masu_bake_json_member(scene, "exposure");
    if (!exposure.value || !json_is_object(exposure.value))
        return masu_bake_json_number(scene, "exposure", 1e-6, 1e6, &l->exposure);
    l->metered = true;
    return masu_bake_json_object(&exposure, members) &&
           masu_bake_json_number(&exposure, "factor", 1e-6, 1e6, &l->exposure) &&
           masu_bake_json_number(&exposure, "brighten", 1e-6, 1e6, &l->brighten) &&
           masu_bake_json_number(&exposure, "darken", 1e-6, 1e6, &l->darken);
}

/* The density at a height, or how far one sees there: to where 0.02 of the contrast is left
 * (Koschmieder 1924). */
static bool read_fog(const masu_bake_json *scene, look *l) {
    static const char *const members[] = {"color",   "density", "visibility", "height",
                                          "falloff", "start",   NULL};
    masu_bake_json fog = masu_bake_json_member(scene, "fog");
    if (!fog.value) return true;
    double visibility = 0;
    l->fog_density = 0.01;
    if (!masu_bake_json_object(&fog, members) ||
        !masu_bake_json_vec3(&fog, "color", 0, RADIANCE_MAX, &l->fog_color) ||
        !masu_bake_json_number(&fog, "density", 0, 1e6, &l->fog_density) ||
        !masu_bake_json_number(&fog, "visibility", 1e-6, 1e9, &visibility) ||
        !masu_bake_json_number(&fog, "height", -1e9, 1e9, &l->fog_height) ||
        !masu_bake_json_number(&fog, "falloff", 0, 1e6, &l->fog_falloff) ||
        !masu_bake_json_number(&fog, "start", 0, 1e9, &l->fog_start)) {
        return false;
    }
    if (visibility > 0 && masu_bake_json_has(&fog, "density"))
        return masu_bake_json_wrong(&fog, "give either \"density\" or \"visibility\"");
    if (visibility > 0) l->fog_density = -log(0.02) / visibility;
    return true;
}

static void add_environment(look *l, masu_bake_content *content) {
    masu_blob_environment e = {.exposure = (float)l->exposure,
                               .metered = l->metered ? 1.0f : 0.0f,
                               .brighten = (float)l->brighten,
                               .darken = (float)l->darken,
                               .near_distance = (float)l->near,
                               .fog_density = (float)l->fog_density,
                               .fog_height = (float)l->fog_height,
                               .fog_falloff = (float)l->fog_falloff,
                               .fog_start = (float)l->fog_start};
    to_floats(l->fog_color, e.fog_color);
    to_floats(l->sun_direction, e.sun_direction);
    e.turbidity = (float)l->turbidity;
    if (l->turbidity > 0) to_floats(l->ground, e.ground);
    if (l->turbidity > 0 && !l->own_sun_color) l->sun_color = masu_bake_v3(0, 0, 0);
    to_floats(masu_bake_v3(l->sun_color.x * l->sun_intensity, l->sun_color.y * l->sun_intensity,
                           l->sun_color.z * l->sun_intensity),
              e.sun_color);
    if (l->occlusion_radius > 0)
        e.occlusion_radius = fmaxf((float)l->occlusion_radius, 1e-3f); /* as the blob's check rounds */
    to_floats(l->ambient, e.ambient);
    to_floats(l->zenith, e.sky_zenith);
    to_floats(l->horizon, e.sky_horizon);
    masu_bake_append(&content->section[MASU_BLOB_ENVIRONMENT], &e, sizeof e);
}

bool masu_bake_read_look(const masu_bake_json *scene, const masu_bake_box *bounds,
                         masu_bake_content *content) {
    look l = default_look(bounds);
    if (!read_camera(scene, bounds, content, &l.near) || !read_sun(scene, bounds, &l, content) ||
        !read_sky(scene, &l) || !read_fog(scene, &l) || !read_occlusion(scene, &l) ||
        !masu_bake_json_vec3(scene, "ambient", 0, RADIANCE_MAX, &l.ambient) ||
        !read_exposure(scene, &l)) {
        return false;
    }
    add_environment(&l, content);
    return true;
}

void masu_bake_default_look(const masu_bake_box *bounds, masu_bake_content *content) {
    look l = default_look(bounds);
    masu_blob_camera_key key = framing_key(bounds, FOV_Y_DEFAULT);
    masu_bake_append(&content->section[MASU_BLOB_CAMERA_KEYS], &key, sizeof key);
    add_environment(&l, content);
}

/* read_view.c: the camera path and the lighting of a scene: sun, sky, fog, ambient occlusion,
 * exposure, environment map. The default is a three-quarter view of the whole scene under a high
 * sun. */
#include "bake/description/reader.h"

#include <string.h>

#define RADIANCE_MAX 1e6
#define ENVIRONMENT_SIZE 256

masu_bake_look masu_bake_default_look(void) {
    return (masu_bake_look){.fov_y = MASU_BAKE_FOV_Y,
                            .sun_direction = masu_bake_direction(60, 50),
                            .sun_color = {1, 0.96, 0.9},
                            .sun_intensity = 1,
                            .ambient = {0.18, 0.2, 0.25},
                            .zenith = {0.16, 0.32, 0.62},
                            .horizon = {0.72, 0.8, 0.88},
                            .exposure = 1,
                            .ground = {0.2, 0.2, 0.2}};
}

/* ---- camera ---- */

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
    *key = (masu_blob_camera_key){.time = (float)time,
                                  .fov_y = (float)(fov_y * (MASU_BAKE_PI / 180.0))};
    masu_bake_store(position, key->position);
    masu_bake_store(target, key->target);
    if (memcmp(key->position, key->target, sizeof key->position) == 0) {
        return masu_bake_json_wrong(at, "position and target are the same point");
    }
    return true;
}

static bool read_keys(const masu_bake_json *keys, masu_bake_reader *r) {
    if (!masu_bake_json_array(keys, 1)) return false;
    masu_bake_look *l = &r->out->look;
    l->key_count = json_array_size(keys->value);
    l->keys = masu_bake_take(&r->out->pool, l->key_count * sizeof *l->keys);
    for (size_t i = 0; i < l->key_count; i++) {
        masu_bake_json at = masu_bake_json_element(keys, i);
        if (!read_key(&at, l->fov_y, &l->keys[i])) return false;
        if (i > 0 && !(l->keys[i].time > l->keys[i - 1].time)) {
            return masu_bake_json_wrong(&at, "time must be later than that of the key before");
        }
    }
    return true;
}

static bool read_camera(const masu_bake_json *scene, masu_bake_reader *r) {
    static const char *const members[] = {"fov_y", "height", "near", "keys", "from", NULL};
    const char *from = NULL;
    masu_bake_json camera = masu_bake_json_member(scene, "camera");
    if (!camera.value) return true;
    if (!masu_bake_json_object(&camera, members) ||
        !masu_bake_json_number(&camera, "fov_y", 0.1, 170, &r->out->look.fov_y) ||
        !masu_bake_json_number(&camera, "height", 1e-6, 1e9, &r->out->look.height) ||
        !masu_bake_json_number(&camera, "near", 1e-6, 1e6, &r->out->look.near) ||
        !masu_bake_json_string(&camera, "from", &from)) {
        return false;
    }
    r->out->look.own_fov_y = masu_bake_json_has(&camera, "fov_y");
    if (r->out->look.own_fov_y && r->out->look.height > 0)
        return masu_bake_json_wrong(&camera, "expected either \"fov_y\" or \"height\", found both");
    if (from && masu_bake_json_has(&camera, "keys"))
        return masu_bake_json_wrong(&camera, "expected either \"keys\" or \"from\", found both");
    if (from) r->out->look.camera = masu_bake_take_text(&r->out->pool, from);
    masu_bake_json keys = masu_bake_json_member(&camera, "keys");
    return !keys.value || read_keys(&keys, r);
}

/* ---- light ---- */

static bool read_shadows(const masu_bake_json *sun, masu_bake_look *l) {
    static const char *const members[] = {"cascades", "resolution", "distance", "lambda", NULL};
    masu_blob_shadow *out = &l->shadow;
    double lambda = 0.75;
    masu_bake_json shadows;
    if (!masu_bake_json_feature(sun, "shadows", &shadows, &l->shadows)) return false;
    *out = (masu_blob_shadow){.cascades = 3, .resolution = 1024, .lambda = (float)lambda};
    if (!shadows.value) return true;
    if (!masu_bake_json_object(&shadows, members) ||
        !masu_bake_json_whole(&shadows, "cascades", 1, MASU_SHADOW_CASCADES_MAX, &out->cascades) ||
        !masu_bake_json_whole(&shadows, "resolution", MASU_SHADOW_SIZE_MIN, MASU_SHADOW_SIZE_MAX,
                              &out->resolution) ||
        !masu_bake_json_number(&shadows, "distance", 1e-3, 1e9, &l->shadow_distance) ||
        !masu_bake_json_number(&shadows, "lambda", 0, 1, &lambda)) {
        return false;
    }
    out->lambda = (float)lambda;
    return true;
}

static bool read_sun(const masu_bake_json *scene, const masu_bake_reader *r) {
    masu_bake_look *l = &r->out->look;
    static const char *const members[] = {"direction", "azimuth", "elevation", "color",
                                          "intensity", "shadows", NULL};
    masu_bake_json sun = masu_bake_json_member(scene, "sun");
    l->shadows = !r->bare;
    if (!sun.value) return read_shadows(&sun, l);
    double azimuth = 60, elevation = 50;
    masu_bake_vec3 direction = l->sun_direction;
    if (!masu_bake_json_object(&sun, members) ||
        !masu_bake_json_number(&sun, "azimuth", -360, 360, &azimuth) ||
        !masu_bake_json_number(&sun, "elevation", -90, 90, &elevation) ||
        !masu_bake_json_vec3(&sun, "direction", -1e6, 1e6, &direction) ||
        !masu_bake_json_vec3(&sun, "color", 0, RADIANCE_MAX, &l->sun_color) ||
        !masu_bake_json_number(&sun, "intensity", 0, 1000, &l->sun_intensity) ||
        !read_shadows(&sun, l)) {
        return false;
    }
    l->own_sun = masu_bake_json_has(&sun, "direction") || masu_bake_json_has(&sun, "azimuth") ||
                 masu_bake_json_has(&sun, "elevation") || masu_bake_json_has(&sun, "color") ||
                 masu_bake_json_has(&sun, "intensity");
    l->own_sun_color = masu_bake_json_has(&sun, "color") || masu_bake_json_has(&sun, "intensity");
    bool angles = masu_bake_json_has(&sun, "azimuth") || masu_bake_json_has(&sun, "elevation");
    if (masu_bake_json_has(&sun, "direction")) {
        if (angles) {
            return masu_bake_json_wrong(
                &sun, "expected either \"direction\" or the two angles, found both");
        }
        if (!masu_bake_normalize(&direction)) {
            masu_bake_json at = masu_bake_json_member(&sun, "direction");
            return masu_bake_json_wrong(&at, "expected a vector that is not zero");
        }
        l->sun_direction = direction;
    } else if (angles) {
        l->sun_direction = masu_bake_direction(azimuth, elevation);
    }
    return true;
}

/* With a turbidity the sky follows from the sun: two colours, a separate ambient light or a ground
 * without turbidity would have no effect. */
static bool read_sky(const masu_bake_json *scene, masu_bake_look *l) {
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
        return masu_bake_json_wrong(&sky, "\"turbidity\" sets the colours of the sky: remove "
                                          "\"zenith\", \"horizon\" and \"ambient\"");
    }
    if (!analytic && masu_bake_json_has(&sky, "ground"))
        return masu_bake_json_wrong(&sky, "\"ground\" needs \"turbidity\"");
    return true;
}

static bool read_occlusion(const masu_bake_json *scene, masu_bake_look *l) {
    static const char *const members[] = {"radius", NULL};
    masu_bake_json occlusion;
    if (!masu_bake_json_feature(scene, "ambient_occlusion", &occlusion, &l->occlusion))
        return false;
    return !occlusion.value ||
           (masu_bake_json_object(&occlusion, members) &&
            masu_bake_json_number(&occlusion, "radius", 1e-3, 1e6, &l->occlusion_radius));
}

/* A number is the exposure; an object requests a metered one. Also reads whether edges are
 * smooth. */
static bool read_exposure(const masu_bake_json *scene, masu_bake_look *l) {
    static const char *const members[] = {"factor", "brighten", "darken", NULL};
    masu_bake_json exposure = masu_bake_json_member(scene, "exposure");
    if (!masu_bake_json_boolean(scene, "smooth_edges", &l->smooth_edges)) return false;
    if (!exposure.value || !json_is_object(exposure.value))
        return masu_bake_json_number(scene, "exposure", 1e-6, 1e6, &l->exposure);
    l->metered = true;
    return masu_bake_json_object(&exposure, members) &&
           masu_bake_json_number(&exposure, "factor", 1e-6, 1e6, &l->exposure) &&
           masu_bake_json_number(&exposure, "brighten", 1e-6, 1e6, &l->brighten) &&
           masu_bake_json_number(&exposure, "darken", 1e-6, 1e6, &l->darken);
}

/* The density at a height, or the visibility there: the distance at which 0.02 of the contrast is
 * left (Koschmieder 1924). */
static bool read_fog(const masu_bake_json *scene, masu_bake_look *l) {
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
        return masu_bake_json_wrong(&fog,
                                    "expected either \"density\" or \"visibility\", found both");
    if (visibility > 0) l->fog_density = -log(0.02) / visibility;
    return true;
}

bool masu_bake_read_look(const masu_bake_json *scene, masu_bake_reader *r) {
    masu_bake_look *l = &r->out->look;
    l->occlusion = !r->bare && r->out->model_count > 0; /* a field has its own, exact one */
    return read_camera(scene, r) && read_sun(scene, r) && read_sky(scene, l) &&
           read_fog(scene, l) && read_occlusion(scene, l) &&
           masu_bake_json_vec3(scene, "ambient", 0, RADIANCE_MAX, &l->ambient) &&
           read_exposure(scene, l);
}

bool masu_bake_read_environment(const masu_bake_json *scene, masu_bake_reader *r) {
    static const char *const members[] = {"file", "rotate", "scale", "size", NULL};
    masu_bake_json at = masu_bake_json_member(scene, "environment");
    const char *file = NULL;
    double rotate = 0, scale = 1, size = ENVIRONMENT_SIZE;
    if (!at.value) return true;
    if (!masu_bake_json_object(&at, members) || !masu_bake_json_string(&at, "file", &file) ||
        !masu_bake_json_number(&at, "rotate", -360, 360, &rotate) ||
        !masu_bake_json_number(&at, "scale", 1e-6, 1e6, &scale) ||
        !masu_bake_json_number(&at, "size", 8, 1024, &size)) {
        return false;
    }
    if (!file) return masu_bake_json_wrong(&at, "needs \"file\"");
    if (masu_bake_json_has(scene, "sky") || masu_bake_json_has(scene, "ambient"))
        return masu_bake_json_wrong(&at,
                                    "replaces the sky: remove \"sky\" and \"ambient\"");
    uint32_t edge = (uint32_t)size;
    if (edge != size || (edge & (edge - 1))) {
        masu_bake_json where = masu_bake_json_member(&at, "size");
        return masu_bake_json_wrong(&where, "expected a power of two");
    }
    r->out->environment = (masu_bake_environment){masu_bake_path(r, file), rotate, scale, edge};
    return true;
}

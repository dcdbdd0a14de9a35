/* sun_sky.c: see sun_sky.h. */
#include "frame/sun_sky.h"

#include "base/error.h"
#include "base/vec.h"

#include <string.h>

static masu_result bad(masu_detail *detail, const char *what, float given, const char *allowed) {
    return masu_fail_number(detail, what, (double)given, allowed);
}

static masu_result check_color(masu_detail *detail, const char *what, const float v[3], float most,
                               const char *allowed) {
    for (uint32_t i = 0; i < 3; i++) {
        if (!(v[i] >= 0.0f && v[i] <= most))
            return masu_fail_element(detail, what, i, (double)v[i], allowed);
    }
    return MASU_OK;
}

static masu_result check_sky(const masu_frame_plan *plan, const masu_light *light,
                             masu_detail *detail) {
    masu_result result = check_color(detail, "light.ground", light->ground, 1.0f, "0 to 1");
    if (result || light->turbidity == 0.0f) return result;
    if (!(light->turbidity >= MASU_SKY_TURBIDITY_MIN &&
          light->turbidity <= MASU_SKY_TURBIDITY_MAX)) {
        return bad(detail, "light.turbidity", light->turbidity, "0 and 1.5 to 10");
    }
    if (!plan->needs.sky) {
        return bad(
            detail, "light.turbidity", light->turbidity,
            "others than 0 only with a scene that has an analytic sky, or desc.analytic_sky");
    }
    return MASU_OK;
}

static masu_result check_fog(const masu_light *light, masu_detail *detail) {
    masu_result result = check_color(detail, "light.fog_color", light->fog_color, 1e9f, "0 to 1e9");
    if (result) return result;
    if (!(light->fog_density >= 0.0f && light->fog_density <= 1e6f))
        return bad(detail, "light.fog_density", light->fog_density, "0 to 1e6 per metre");
    if (!(light->fog_height >= -1e9f && light->fog_height <= 1e9f))
        return bad(detail, "light.fog_height", light->fog_height, "-1e9 to 1e9 m");
    if (!(light->fog_falloff >= 0.0f && light->fog_falloff <= 1e6f))
        return bad(detail, "light.fog_falloff", light->fog_falloff, "0 to 1e6 per metre");
    if (!(light->fog_start >= 0.0f && light->fog_start <= 1e9f))
        return bad(detail, "light.fog_start", light->fog_start, "0 to 1e9 m");
    return MASU_OK;
}

/* Members that have no effect in this scene: black, or as masu_light_of returns them. */
static masu_result check_unused(const masu_frame_plan *plan, const masu_blob_environment *scene,
                                const masu_light *light, masu_detail *detail) {
    const struct {
        const char *what;
        const float *given, *own;
    } colors[] = {{"light.ambient", light->ambient, scene->ambient},
                  {"light.sky_zenith", light->sky_zenith, scene->sky_zenith},
                  {"light.sky_horizon", light->sky_horizon, scene->sky_horizon}};
    for (uint32_t i = 0; plan->needs.environment && i < 9; i++) {
        uint32_t k = i % 3;
        float given = colors[i / 3].given[k];
        if (given == 0.0f || given == colors[i / 3].own[k]) continue;
        return masu_fail_element(detail, colors[i / 3].what, k, (double)given,
                                 "0 and the scene's own, whose environment map replaces it");
    }
    if (plan->needs.environment && light->turbidity != 0.0f && light->turbidity != scene->turbidity)
        return bad(detail, "light.turbidity", light->turbidity,
                   "0 with a scene whose environment map replaces the sky");
    if (light->fog_density > 0.0f && !plan->scene.fog)
        return bad(detail, "light.fog_density", light->fog_density,
                   "0 with a scene that has no fog");
    return MASU_OK;
}

/* The rotation from the axes of the map to the world; the identity for a quaternion of all zero.
 * Returns 0 if the quaternion is none. */
static int rotation_of(const float q[4], double r[3][3]) {
    double n[4], square = 0.0;
    for (uint32_t k = 0; k < 4; k++) n[k] = (double)q[k], square += n[k] * n[k];
    if (square == 0.0) n[3] = square = 1.0;
    if (!(square >= 1e-20 && square <= 1e20)) return 0;
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t j = (i + 1) % 3, k = (i + 2) % 3;
        r[i][i] = 1.0 - 2.0 * (n[j] * n[j] + n[k] * n[k]) / square;
        r[i][j] = 2.0 * (n[i] * n[j] - n[3] * n[k]) / square;
        r[j][i] = 2.0 * (n[i] * n[j] + n[3] * n[k]) / square;
    }
    return 1;
}

static int is_zero(const float *v, uint32_t count) {
    for (uint32_t k = 0; k < count; k++) {
        if (v[k] != 0.0f) return 0;
    }
    return 1;
}

static masu_result check_factor(masu_detail *detail, const char *what, float given) {
    if (given >= -1e6f && given <= 1e6f) return MASU_OK;
    return bad(detail, what, given, "-1e6 to 1e6");
}

static masu_result check_environment(const masu_frame_plan *plan, const masu_environment *e,
                                     masu_detail *detail) {
    double rotation[3][3];
    masu_result result = check_factor(detail, "light.environment.intensity", e->intensity);
    if (!result)
        result = check_color(detail, "light.environment.tint", e->tint, 1.0f, "0 to 1");
    if (!result)
        result = check_factor(detail, "light.environment.background_intensity",
                              e->background_intensity);
    if (!result)
        result = check_color(detail, "light.environment.background_color", e->background_color,
                             1e9f, "0 to 1e9");
    if (result) return result;
    if (!rotation_of(e->rotation, rotation))
        return masu_fail(
            detail, MASU_ERROR_ARGUMENT, "light.environment.rotation", 0, 0,
            "light.environment.rotation is (%g, %g, %g, %g), needed is a quaternion of "
            "a length from 1e-10 to 1e10, or all 0",
            (double)e->rotation[0], (double)e->rotation[1], (double)e->rotation[2],
            (double)e->rotation[3]);
    int map = e->intensity != 0.0f || !is_zero(e->tint, 3) || !is_zero(e->rotation, 4);
    int any = map || e->background_intensity != 0.0f || !is_zero(e->background_color, 3);
    if (any && !plan->desc.live_environment)
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "light.environment", 1, 0,
                         "light.environment is not all 0, needed is desc.live_environment");
    if (map && !plan->needs.environment)
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "light.environment", 1, 0,
                         "light.environment: intensity, tint and rotation are for a scene with an "
                         "environment map, this one has none");
    return MASU_OK;
}

static masu_result check_colors(const masu_light *light, masu_detail *detail) {
    masu_result result =
        check_color(detail, "light.sun_color", light->sun_color, 1e9f, "0 to 1e9");
    if (!result) result = check_color(detail, "light.ambient", light->ambient, 1e9f, "0 to 1e9");
    if (!result)
        result = check_color(detail, "light.sky_zenith", light->sky_zenith, 1e9f, "0 to 1e9");
    if (!result)
        result = check_color(detail, "light.sky_horizon", light->sky_horizon, 1e9f, "0 to 1e9");
    return result;
}

/* The camera's height above the fog's in double: at large heights a float resolves neither to a
 * metre. */
static void write_fog(const masu_light *light, double eye_y, struct masu_frame_uniforms *u) {
    memcpy(u->fog, light->fog_color, sizeof light->fog_color);
    u->fog[3] = light->fog_density;
    u->air[0] = (float)(eye_y - (double)light->fog_height);
    u->air[1] = light->fog_falloff;
    u->air[2] = light->fog_start;
    int bright =
        light->fog_color[0] > 0.0f || light->fog_color[1] > 0.0f || light->fog_color[2] > 0.0f;
    u->air[3] = (float)bright;
}

static masu_light scene_light(const masu_blob_environment *e) {
    masu_light light = {.exposure = e->exposure,
                        .turbidity = e->turbidity,
                        .fog_density = e->fog_density,
                        .fog_height = e->fog_height,
                        .fog_falloff = e->fog_falloff,
                        .fog_start = e->fog_start};
    memcpy(light.fog_color, e->fog_color, sizeof light.fog_color);
    memcpy(light.ground, e->ground, sizeof light.ground);
    memcpy(light.sun_direction, e->sun_direction, sizeof light.sun_direction);
    memcpy(light.sun_color, e->sun_color, sizeof light.sun_color);
    memcpy(light.ambient, e->ambient, sizeof light.ambient);
    memcpy(light.sky_zenith, e->sky_zenith, sizeof light.sky_zenith);
    memcpy(light.sky_horizon, e->sky_horizon, sizeof light.sky_horizon);
    return light;
}

masu_light masu_sun_sky_light(const masu_sun_sky *s) { return scene_light(&s->environment); }

void masu_sun_sky_alloc(masu_sun_sky *s, masu_arena *arena, const masu_frame_plan *plan) {
    s->sky = masu_arena_alloc(arena, "sky", plan->needs.sky ? 1 : 0, sizeof *s->sky, 16);
}

void masu_sun_sky_copy_scene(masu_sun_sky *s, const masu_scene_view *v) {
    s->environment = *v->environment;
    if (!v->environment_map) return;
    memcpy(s->environment_sh, v->environment_map->sh, sizeof s->environment_sh);
}

static float factor_of(float given) { return given == 0.0f ? 1.0f : given > 0.0f ? given : 0.0f; }

/* Coefficients 4 to 8 as a symmetric matrix m: the sum is n m n for a unit normal n. */
static void quadratic_of(masu_vec4 sh[9], uint32_t c, double m[3][3]) {
    m[0][1] = m[1][0] = 0.5 * (double)sh[4][c];
    m[1][2] = m[2][1] = 0.5 * (double)sh[5][c];
    m[2][0] = m[0][2] = 0.5 * (double)sh[6][c];
    m[0][0] = -(double)sh[7][c] + (double)sh[8][c];
    m[1][1] = 2.0 * (double)sh[7][c];
    m[2][2] = -(double)sh[7][c] - (double)sh[8][c];
}

/* Rotates the irradiance of a map. Orders 0 to 2 and the lobe are exact. P4 of y becomes, tilted, a
 * harmonic of order 4 whose projection on P4 of y is P4 of the cosine (addition theorem). */
static void rotate_irradiance(double r[3][3], masu_vec4 sh[9]) {
    masu_vec4 out[9];
    memcpy(out, sh, sizeof out);
    for (uint32_t c = 0; c < 4; c++) {
        uint32_t first = c < 3 ? 1 : 3; /* the lobe's direction */
        for (uint32_t i = 0; i < 3; i++) {
            double sum = 0.0;
            for (uint32_t k = 0; k < 3; k++) sum += r[i][k] * (double)sh[first + k][c];
            out[first + i][c] = (float)sum;
        }
    }
    for (uint32_t c = 0; c < 3; c++) {
        double m[3][3], half[3][3] = {{0}}, to[3][3] = {{0}};
        quadratic_of(sh, c, m);
        for (uint32_t i = 0; i < 27; i++)
            half[i / 9][i / 3 % 3] += r[i / 9][i % 3] * m[i % 3][i / 3 % 3];
        for (uint32_t i = 0; i < 27; i++)
            to[i / 9][i / 3 % 3] += half[i / 9][i % 3] * r[i / 3 % 3][i % 3];
        out[4][c] = (float)(2.0 * to[0][1]);
        out[5][c] = (float)(2.0 * to[1][2]);
        out[6][c] = (float)(2.0 * to[2][0]);
        out[7][c] = (float)(0.5 * to[1][1]);
        out[8][c] = (float)(0.5 * (to[0][0] - to[2][2]));
    }
    double y2 = r[1][1] * r[1][1], p4 = (35.0 * y2 * y2 - 30.0 * y2 + 3.0) * 0.125;
    for (uint32_t c = 0; c < 3; c++) out[6 + c][3] = (float)(p4 * (double)sh[6 + c][3]);
    memcpy(sh, out, sizeof out);
}

/* Applies light.environment to the irradiance in the uniforms, and writes the factors of the map
 * and the background. */
static void write_environment(const masu_environment *e, struct masu_frame_uniforms *u) {
    double r[3][3];
    const float tint[3] = {1.0f, 1.0f, 1.0f}, *hue = is_zero(e->tint, 3) ? tint : e->tint;
    (void)rotation_of(e->rotation, r);
    if (!is_zero(e->rotation, 4)) rotate_irradiance(r, u->irradiance);
    for (uint32_t c = 0; c < 3; c++) {
        float factor = factor_of(e->intensity) * hue[c];
        for (uint32_t k = 0; k < 9; k++) u->irradiance[k][c] *= factor;
        u->irradiance[c][3] *= factor;     /* colour of the lobe */
        u->irradiance[6 + c][3] *= factor; /* and of P4 */
        for (uint32_t k = 0; k < 3; k++) u->environment[c][k] = (float)r[k][c];
        u->environment[c][3] = factor;
    }
    memcpy(u->background, e->background_color, sizeof e->background_color);
    u->background[3] = factor_of(e->background_intensity);
}

/* Writes the masu_light, and the irradiance of a sky that is not analytic. */
static void write_light(const masu_sun_sky *s, masu_frame_data *f) {
    struct masu_frame_uniforms *u = &f->u;
    const masu_light *light = &f->light;
    u->sun_direction[3] = light->exposure;
    memcpy(u->sun_color, light->sun_color, sizeof light->sun_color);
    memcpy(u->ambient, light->ambient, sizeof light->ambient);
    memcpy(u->sky_zenith, light->sky_zenith, sizeof light->sky_zenith);
    memcpy(u->sky_horizon, light->sky_horizon, sizeof light->sky_horizon);
    memcpy(u->irradiance[0], light->ambient, sizeof light->ambient);
    if (f->plan->needs.environment)
        memcpy(u->irradiance, s->environment_sh, sizeof u->irradiance);
    if (f->plan->desc.live_environment) write_environment(&light->environment, u);
    if (f->plan->needs.environment) {
        /* The mean of all directions: band 0, which the lobe has too. */
        for (uint32_t k = 0; k < 3; k++)
            u->ambient[k] =
                u->irradiance[0][k] +
                u->irradiance[k][3] * (0.25f + MASU_SKY_ROUND * MASU_SKY_ROUND / 12.0f);
        u->sky_zenith[3] = (float)f->plan->scene.environment_size;
        u->sky_horizon[3] = (float)f->plan->scene.environment_mips;
    }
    write_fog(light, f->eye[1], u);
}

masu_result masu_sun_sky_read(const masu_sun_sky *s, masu_frame_data *f, masu_detail *detail) {
    masu_light light = f->desc.light ? *f->desc.light : scene_light(&s->environment);
    if (light.exposure == 0.0f) light.exposure = 1.0f;
    if (!(light.exposure >= 1e-9f && light.exposure <= 1e9f))
        return bad(detail, "light.exposure", light.exposure, "0 and 1e-9 to 1e9");
    if (!masu_unit(light.sun_direction, f->u.sun_direction)) {
        const float *v = light.sun_direction;
        return masu_fail(
            detail, MASU_ERROR_ARGUMENT, "light.sun_direction", 0, 0,
            "light.sun_direction is (%g, %g, %g), needed is a direction: finite, not zero",
            (double)v[0], (double)v[1], (double)v[2]);
    }
    masu_result result = check_colors(&light, detail);
    if (!result) result = check_sky(f->plan, &light, detail);
    if (!result) result = check_fog(&light, detail);
    if (!result) result = check_unused(f->plan, &s->environment, &light, detail);
    if (!result) result = check_environment(f->plan, &light.environment, detail);
    if (result) return result;
    f->light = light;
    write_light(s, f);
    return MASU_OK;
}

void masu_sun_sky_write(masu_sun_sky *s, masu_frame_data *f) {
    struct masu_frame_uniforms *u = &f->u;
    const masu_light *light = &f->light;
    if (!f->plan->needs.sky) return;
    struct masu_sky_uniforms *to =
        (struct masu_sky_uniforms *)(void *)masu_frame_slot(f, MASU_BUFFER_SKY);
    if (light->turbidity == 0.0f) {
        memset(to->azimuth, 0, sizeof to->azimuth);
        s->slot_updates[f->slot] = 0;
        return;
    }
    masu_sky *sky = s->sky;
    (void)masu_sky_update(sky, u->sun_direction, light->turbidity, light->ground);
    const masu_sky_irradiance *from = &sky->irradiance;
    for (uint32_t k = 0; k < 9; k++) memcpy(u->irradiance[k], from->sh[k], sizeof from->sh[k]);
    for (uint32_t k = 0; k < 3; k++) {
        u->irradiance[k][3] = from->glow[k];
        u->irradiance[3 + k][3] = from->direction[k];
        u->irradiance[6 + k][3] = from->ring[k];
        u->ambient[k] = from->sh[0][k];
    }
    if (u->sun_color[0] == 0.0f && u->sun_color[1] == 0.0f && u->sun_color[2] == 0.0f)
        memcpy(u->sun_color, sky->sun_color, sizeof sky->sun_color);
    if (s->slot_updates[f->slot] == sky->sun_updates) return;
    memcpy(to, &sky->uniforms, sizeof *to);
    s->slot_updates[f->slot] = sky->sun_updates;
}

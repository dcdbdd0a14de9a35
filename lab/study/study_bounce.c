/* study_bounce.c: `masu-lab study bounce`: compares the indirect light of a live bounce at points
 * of the image with paths of the reference, and measures how it follows a lamp that is switched
 * on. */
#include "lab/study/study.h"

#include "lab/reference/render.h"
#include "measure/linear.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS_MOST = 16384 };

typedef struct options {
    masu_study_options study;
    const char *sdf, *lamp, *door, *reference;
    uint32_t points, paths, probes, rays;
    double lamp_color, camera[6], window[6];
    bool night, diffuse;
} options;

static options given = {.study = {.size = {320, 180}, .time = 0.0, .frames = 400},
                        .points = 1024,
                        .paths = 256,
                        .lamp_color = 10};
static const masu_study_options *const o = &given.study;

static const masu_column columns[] = {{"scene", NULL, NULL, NULL},
                                      {"points", "%.0f", "points", "%.0f"},
                                      {"reference", "%.6f", "irradiance", "%.4f"},
                                      {"noise", "%.6f", "noise, %", "%.1f"},
                                      {"found", "%.6f", "found", "%.4f"},
                                      {"bias", "%.6f", "bias, %", "%+.1f"},
                                      {"rmse", "%.6f", "RMSE, %", "%.1f"},
                                      {"bare_bias", "%.6f", "bias, %: no AO", "%+.1f"},
                                      {"bare_rmse", "%.6f", "RMSE, %: no AO", "%.1f"},
                                      {"response", "%.0f", "frames to 90 %", "%.0f"},
                                      {"flicker", "%.6f", "flicker, %", "%.3f"},
                                      {"driver", "\"", NULL, NULL},
                                      {NULL, NULL, NULL, NULL}};

typedef struct point {
    size_t at;        /* pixel */
    double expected;  /* indirect irradiance */
    double halves[2]; /* the same from every second path */
    double variance;  /* of `expected` */
    ref_vec soft, all; /* diffusely reflected share of uniform light; the same including specular
                        * light */
} point;

typedef struct study {
    ref_scene scene;
    ref_field field;
    ref_world world;
    ref_sky sky;
    bool has_field;
    bool *direct_materials; /* whose emission reaches pixels like a light's */
    ref_camera camera;
    point *points;
    uint32_t count;
    float *image, *direct, *uniform; /* uniform: `direct` and light of radiance 1 from everywhere */
    double *series; /* mean irradiance after each frame */
    double reference, noise, found, bias, rmse, bare_bias, bare_rmse, response, flicker;
    char driver[1024];
    uint32_t messages;
    masu_session s;
} study;

static bool failed(char *error, size_t size, const char *text) {
    snprintf(error, size, "%s", text);
    return false;
}

/* ---- The reference --------------------------------------------------------------------------- */

static bool open_reference(study *w, char *error, size_t size) {
    const double *c = given.camera;
    if (!ref_scene_open(o->scene, o->time, false, &w->scene, error, size)) return false;
    if (!w->scene.probes) return failed(error, size, "the scene has no probes");
    if (w->scene.sdf && !given.sdf)
        return failed(error, size,
                      "the scene has a signed distance field: give its source by --sdf FILE");
    if (w->scene.sdf) {
        w->has_field = ref_field_open(given.sdf, &w->scene.blob, o->time, &w->field, error, size);
        if (!w->has_field) return false;
    }
    const masu_blob_environment *e = w->scene.environment;
    w->sky = (ref_sky){.zenith = ref_of(e->sky_zenith), .horizon = ref_of(e->sky_horizon)};
    if (given.night) w->sky.zenith = w->sky.horizon = ref_splat(0);
    w->camera = ref_camera_at(&w->scene.blob, o->time);
    if (c[0] != c[3] || c[1] != c[4] || c[2] != c[5]) {
        w->camera.eye = ref_v(c[0], c[1], c[2]);
        w->camera.forward = ref_unit(ref_sub(ref_v(c[3], c[4], c[5]), w->camera.eye));
        w->camera.right = ref_unit(ref_cross(w->camera.forward, ref_v(0, 1, 0)));
        w->camera.up = ref_cross(w->camera.right, w->camera.forward);
    }
    return ref_sky_prepare(&w->sky) && ref_world_open(&w->scene, w->has_field ? &w->field : NULL,
                                                      w->camera.eye, &w->world, error, size);
}

static void set_lamp(study *w) {
    const masu_blob_light *lights = w->scene.blob.section[MASU_BLOB_LIGHTS];
    const char *names = w->scene.blob.section[MASU_BLOB_NAMES];
    for (uint32_t i = 0; given.lamp && i < w->scene.light_count; i++) {
        if (lights[i].name == MASU_BLOB_NONE || strcmp(names + lights[i].name, given.lamp))
            continue;
        w->scene.lights[i].color = ref_splat(given.lamp_color);
    }
}

/* Whether a point is inside the grid of probes: outside, their light fades. */
static bool in_grid(const study *w, ref_vec at) {
    const masu_blob_probes *g = w->scene.blob.section[MASU_BLOB_PROBES];
    const double p[3] = {at.x, at.y, at.z};
    for (int k = 0; k < 3; k++) {
        double cell = (double)g->spacing[k], low = (double)g->origin[k] - 0.5 * cell;
        if (p[k] < low - 1e-3 || p[k] > low + cell * g->counts[k] + 1e-3) return false;
    }
    return true;
}

/* Whether an area light of the scene represents the light of a triangle. */
static bool is_of_light(const ref_scene *s, const ref_triangle *triangle) {
    ref_vec at = ref_splat(0);
    for (int k = 0; k < 3; k++)
        at = ref_add(at, ref_scale(s->positions[triangle->vertex[k]], 1.0 / 3));
    for (uint32_t i = 0; i < s->light_count; i++) {
        const ref_light *l = &s->lights[i];
        double reach = l->radius + (l->type >= MASU_LIGHT_CAPSULE ? ref_length(l->direction) : 0) +
                       (l->type == MASU_LIGHT_RECTANGLE ? ref_length(l->half_axis) : 0);
        if (l->surface && ref_length(ref_sub(at, l->position)) <= 1.1 * reach + 0.01) return true;
    }
    return false;
}

/* Materials whose emission lights pixels without a bounce. */
static bool find_emitters(study *w) {
    w->direct_materials =
        calloc((size_t)w->scene.blob.count[MASU_BLOB_MATERIALS] + 1, sizeof *w->direct_materials);
    if (!w->direct_materials) return false;
    for (uint32_t i = 0; i < w->scene.emitter_count; i++) {
        const ref_triangle *t = &w->scene.triangles[w->scene.emitters[i].triangle];
        if (is_of_light(&w->scene, t)) w->direct_materials[t->material] = true;
    }
    return true;
}

static ref_tracer tracer_of(const study *w) {
    const double *window = given.window;
    ref_ggx_tables();
    return (ref_tracer){.world = &w->world,
                        .sky = &w->sky,
                        .physics = true,
                        .full = true,
                        .polygons_shadow = true,
                        .field_shadows = true,
                        .sky_samples = true,
                        .light_samples = true,
                        .bsdf_samples = true,
                        .bounces = 16,
                        .direct = w->direct_materials,
                        .diffuse_hits = given.diffuse,
                        .sun_direction = ref_of(w->scene.environment->sun_direction),
                        .sun_color =
                            given.night ? ref_splat(0) : ref_of(w->scene.environment->sun_color),
                        .eye = w->camera.eye,
                        .window = {ref_v(window[0], window[1], window[2]),
                                   ref_v(window[3], window[4], window[5]), window[0] < window[3]},
                        .environment = w->scene.environment};
}

static double ratio(double a, double b) { return b > 0 ? a / b : 0; }

/* Matt surfaces that do not emit, spread over the image. */
static void find_points(study *w) {
    const size_t pixels = (size_t)o->size.width * o->size.height;
    ref_ggx_tables();
    ref_tracer all = tracer_of(w);
    for (size_t i = 0; i < pixels && w->count < given.points; i++) {
        size_t at = (size_t)(fmod((double)i * 0.6180339887498949, 1) * (double)pixels);
        ref_vec d = ref_camera_ray(&w->camera, ((double)(at % o->size.width) + 0.5) / o->size.width,
                                   ((double)(at / o->size.width) + 0.5) / o->size.height,
                                   (double)o->size.width / o->size.height);
        ref_hit hit;
        ref_look look;
        ref_bsdf b;
        if (!ref_world_trace(&w->world, w->camera.eye, d, HUGE_VAL, REF_RAY_ONE_SIDED, &hit) ||
            !in_grid(w, hit.p))
            continue;
        ref_world_look(&w->world, &hit, ref_scale(d, -1), &look);
        if (look.flags & MASU_MATERIAL_IS_BLEND || ref_max(look.s.emissive) > 0 ||
            look.s.roughness < 0.6 || look.s.metallic > 0)
            continue;
        ref_bsdf_make(&b, &look.s, ref_scale(d, -1), false);
        ref_lobes albedo = ref_bsdf_albedo(&b);
        double sum[2] = {0}, square = 0, n = given.paths;
        for (uint32_t k = 0; k < given.paths; k++) {
            ref_random r = ref_random_at(7, at, k);
            double value = ref_luminance(ref_irradiance(&all, &hit, &r));
            sum[k & 1] += value;
            square += value * value;
        }
        double mean = (sum[0] + sum[1]) / n;
        w->points[w->count++] =
            (point){.at = at,
                    .expected = mean,
                    .halves = {sum[0] / ((given.paths + 1) / 2), sum[1] / (given.paths / 2)},
                    .variance = fmax(square / n - mean * mean, 0) / (n - 1),
                    .soft = albedo.of[REF_SOFT],
                    .all = ref_lobes_sum(&albedo)};
    }
}

/* Reads the points from a file of an earlier run; otherwise computes them with paths and writes
 * them there. */
static bool read_points(study *w, char *error, size_t size) {
    FILE *file = given.reference ? fopen(given.reference, "rb") : NULL;
    if (file) {
        w->count = (uint32_t)fread(w->points, sizeof *w->points, given.points, file);
    } else {
        if (!find_emitters(w)) return failed(error, size, "out of memory");
        masu_cli_progress_text("paths of the reference");
        find_points(w);
        if (given.reference) file = fopen(given.reference, "wb");
        if (given.reference &&
            (!file || fwrite(w->points, sizeof *w->points, w->count, file) != w->count))
            snprintf(error, size, "%s: cannot be written", given.reference);
    }
    if (file) fclose(file);
    for (uint32_t i = 0; i < w->count; i++) {
        w->reference += w->points[i].expected / w->count;
        w->noise += w->points[i].variance / w->count;
    }
    w->noise = w->reference > 0 ? sqrt(w->noise) / w->reference : 0;
    return w->count > 0 || failed(error, size, "no matt polygon is in view");
}

/* ---- Frames ---------------------------------------------------------------------------------- */

static bool open_renderer(study *w, bool bounce, char *error, size_t size) {
    masu_session_desc d = {.scene_path = o->scene, .host = o->host};
    d.desc.output = o->size;
    d.desc.targets.storage = 1;
    d.desc.readback = MASU_READBACK_HDR;
    d.desc.rung_count = 1;
    d.desc.rungs[0] = (masu_rung){.scale = 1,
                                  .temporal = MASU_OFF,
                                  .specular = MASU_OFF,
                                  .bounce = bounce ? MASU_ON : MASU_OFF,
                                  .bounce_probes = bounce ? given.probes : 0,
                                  .bounce_rays = bounce ? given.rays : 0};
    if (!masu_session_open(&d, &w->s, error, size)) return false;
    snprintf(w->driver, sizeof w->driver, "%s", w->s.host.driver);
    return true;
}

static bool switch_lamp(study *w, bool on) {
    masu_punctual_light_state state;
    if (!given.lamp) return true;
    masu_punctual_light lamp = masu_punctual_light_find(w->s.m, given.lamp);
    if (masu_punctual_light_get(w->s.m, lamp, &state, NULL) != MASU_OK) return false;
    for (int k = 0; k < 3; k++) state.color[k] = on ? (float)given.lamp_color : 0.0f;
    return masu_punctual_light_set(w->s.m, lamp, &state, NULL) == MASU_OK;
}

/* Hides the door. */
static bool open_door(study *w, char *error, size_t size) {
    masu_model door = masu_model_find(w->s.m, given.door ? given.door : "");
    if (!given.door || masu_model_show(w->s.m, door, 0, NULL) == MASU_OK) return true;
    return failed(error, size, "the scene has no movable model of that name");
}

static bool draw(study *w, bool first, float ambient, float *rgb, char *error, size_t size) {
    masu_light light;
    masu_camera camera;
    masu_commands commands;
    if (masu_light_of(w->s.m, &light, NULL) != MASU_OK ||
        masu_camera_at(w->s.m, o->time, &camera, NULL) != MASU_OK)
        return failed(error, size, "the scene has no light or no camera");
    for (int k = 0; k < 3; k++) light.ambient[k] = ambient;
    if (given.night) {
        memset(light.sun_color, 0, sizeof light.sun_color);
        memset(light.sky_zenith, 0, sizeof light.sky_zenith);
        memset(light.sky_horizon, 0, sizeof light.sky_horizon);
    }
    const double eye[3] = {w->camera.eye.x, w->camera.eye.y, w->camera.eye.z},
                 forward[3] = {w->camera.forward.x, w->camera.forward.y, w->camera.forward.z};
    for (int k = 0; k < 3; k++) {
        camera.position[k] = eye[k];
        camera.forward[k] = (float)forward[k];
    }
    masu_frame_desc frame = {.camera = &camera,
                             .light = &light,
                             .time = o->time,
                             .time_step = first ? 0.0f : 1.0f / 60.0f,
                             .cut = first};
    return masu_session_frame(&w->s, &frame, true, &commands, error, size) &&
           (masu_linear_read(w->s.m, commands.slot, o->size, rgb) ||
            failed(error, size, "no image of linear light"));
}

static ref_vec added(const float *a, const float *b, size_t pixel) {
    const float *p = a + 3 * pixel, *q = b + 3 * pixel;
    return ref_v((double)(p[0] - q[0]), (double)(p[1] - q[1]), (double)(p[2] - q[2]));
}

/* Indirect irradiance at a pixel: the light added by the bounce, divided by the diffuse albedo.
 * bare: also divided by ambient occlusion, which is computed from the light that a uniform
 * environment adds to the pixel. */
static double irradiance_at(const study *w, const point *p, bool bare) {
    ref_vec light = added(w->image, w->direct, p->at), one = p->soft,
            uniform = added(w->uniform, w->direct, p->at);
    if (bare)
        one = ref_mul(one, ref_v(ratio(uniform.x, p->all.x), ratio(uniform.y, p->all.y),
                                 ratio(uniform.z, p->all.z)));
    return REF_PI * ref_luminance(
                        ref_v(ratio(light.x, one.x), ratio(light.y, one.y), ratio(light.z, one.z)));
}

static double mean_of(const study *w) {
    double sum = 0;
    for (uint32_t i = 0; i < w->count; i++)
        sum += irradiance_at(w, &w->points[i], false) / w->count;
    return sum;
}

/* The two halves of the paths have independent noise, so the mean of their products does not
 * include its square. */
static void compare(const study *w, bool bare, double *bias, double *rmse) {
    double sum = 0, off = 0, n = w->count;
    for (uint32_t i = 0; i < w->count; i++) {
        const point *p = &w->points[i];
        double found = irradiance_at(w, p, bare);
        sum += (found - p->halves[0]) * (found - p->halves[1]);
        off += found - p->expected;
    }
    *bias = w->reference > 0 ? off / n / w->reference : (double)NAN;
    *rmse = w->reference > 0 ? sqrt(fmax(sum / n, 0)) / w->reference : (double)NAN;
}

static bool measure(study *w, char *error, size_t size) {
    enum { SHADOWS = 24 }; /* frames until shadows are complete */
    if (!open_renderer(w, false, error, size)) return false;
    bool good = switch_lamp(w, true) || failed(error, size, "the scene has no lamp of that name");
    good = good && open_door(w, error, size);
    for (int i = 0; good && i < SHADOWS; i++) good = draw(w, !i, 0, w->direct, error, size);
    good = good && draw(w, false, 1, w->uniform, error, size);
    masu_session_close(&w->s);
    w->messages += w->s.host.messages;
    if (!good || !open_renderer(w, true, error, size)) return false;
    const bool changes = given.lamp || given.door;
    good = switch_lamp(w, given.door != NULL);
    for (uint32_t i = 0; good && changes && i < o->frames; i++)
        good = draw(w, !i, 0, w->image, error, size);
    good = good && switch_lamp(w, true) && open_door(w, error, size);
    double before = 0, previous = 0;
    for (uint32_t i = 0; good && i < o->frames; i++) {
        if (i + 1 == o->frames) previous = mean_of(w);
        good = draw(w, !changes && !i, 0, w->image, error, size);
        w->series[i] = mean_of(w);
    }
    masu_session_close(&w->s);
    w->messages += w->s.host.messages;
    if (!good) return false;
    w->found = w->series[o->frames - 1];
    w->flicker = w->found > 0 ? fabs(w->found - previous) / w->found : 0;
    /* The first frame still shows the previous state, except for the first probes. */
    before = changes ? w->series[0] : 0;
    for (uint32_t i = o->frames; i > 0; i--) {
        if (fabs(w->series[i - 1] - w->found) > 0.1 * fabs(w->found - before)) {
            w->response = i + 1;
            break;
        }
    }
    if (given.door) w->reference = w->noise = 0; /* the paths included the door */
    compare(w, false, &w->bias, &w->rmse);
    compare(w, true, &w->bare_bias, &w->bare_rmse);
    return true;
}

static int report(study *w) {
    char scene[128];
    masu_table t;
    masu_study_scene_name(o->scene, scene, sizeof scene);
    masu_table_open(&t, columns, "");
    const double values[] = {w->count,      w->reference, 100 * w->noise,  w->found,
                             100 * w->bias, 100 * w->rmse, 100 * w->bare_bias, 100 * w->bare_rmse,
                             w->response,   100 * w->flicker};
    masu_table_text(&t, scene);
    masu_table_numbers(&t, values, 10);
    masu_table_text(&t, w->driver);
    masu_table_print(&t, o->text);
    int code = masu_table_close(&t, o->csv);
    return w->messages
               ? masu_cli_error("the validation layer has reported %u messages", w->messages)
               : code;
}

static int run(void) {
    static study w; /* a session must not move, and is large */
    char error[4096];
    const size_t values = 3 * (size_t)o->size.width * o->size.height;
    w.points = calloc(POINTS_MOST, sizeof *w.points);
    w.image = calloc(3 * values, sizeof *w.image);
    w.series = calloc(o->frames, sizeof *w.series);
    bool good = w.points && w.image && w.series;
    if (!good) failed(error, sizeof error, "out of memory");
    if (good) w.direct = w.image + values, w.uniform = w.direct + values;
    good = good && open_reference(&w, error, sizeof error);
    if (good) {
        set_lamp(&w);
        good = read_points(&w, error, sizeof error);
    }
    if (good) {
        masu_cli_progress_text("frames");
        good = measure(&w, error, sizeof error);
    }
    masu_cli_progress_clear();
    int code = good ? report(&w) : masu_cli_error("%s", error);
    ref_world_close(&w.world);
    ref_sky_close(&w.sky);
    if (w.has_field) ref_field_close(&w.field);
    ref_scene_close(&w.scene);
    free(w.points);
    free(w.direct_materials);
    free(w.image);
    free(w.series);
    return code;
}

static bool read_camera(masu_cli *cli, void *to) {
    double *c = ((options *)to)->camera;
    if (sscanf(cli->value, "%lf,%lf,%lf,%lf,%lf,%lf", &c[0], &c[1], &c[2], &c[3], &c[4], &c[5]) ==
        6)
        return true;
    masu_cli_usage_error("--camera: expected X,Y,Z,X,Y,Z: position and target, not \"%s\"",
                         cli->value);
    return false;
}

static bool read_window(masu_cli *cli, void *to) {
    double *w = ((options *)to)->window;
    if (sscanf(cli->value, "%lf,%lf,%lf,%lf,%lf,%lf", &w[0], &w[1], &w[2], &w[3], &w[4], &w[5]) ==
            6 &&
        w[0] < w[3] && w[1] < w[4] && w[2] < w[5])
        return true;
    masu_cli_usage_error(
        "--window: expected two corners X,Y,Z,X,Y,Z, the lower one first, not \"%s\"", cli->value);
    return false;
}

static const masu_option rows[] = {
    MASU_STUDY_SIZE,
    MASU_STUDY_TIME,
    MASU_TEXT(options, sdf, "sdf", "FILE", "source of the scene's signed distance field"),
    MASU_UINT(options, points, "points", 1, POINTS_MOST, "points of matt polygons in view"),
    MASU_UINT(options, paths, "paths", 2, 1000000, "paths of the reference from each"),
    MASU_TEXT(options, reference, "reference", "FILE",
              "points and results of paths: read if it exists, else written"),
    MASU_OWN("window", "X,Y,Z,X,Y,Z", read_window,
             "box through which the sky is visible: fewer paths needed"),
    MASU_UINT(options, probes, "probes", 1, 2048, "rung.bounce_probes (default: the library's)"),
    MASU_UINT(options, rays, "rays", 8, 64, "rung.bounce_rays (default: the library's)"),
    MASU_OWN("camera", "X,Y,Z,X,Y,Z", read_camera, "position and target (default: the scene's)"),
    MASU_FLAG(options, night, "night", "without sun and sky"),
    MASU_FLAG(options, diffuse, "diffuse-hits",
              "paths reflect diffusely after the first surface, as probe rays do"),
    MASU_TEXT(options, lamp, "lamp", "NAME", "light that is switched on after --frames without it"),
    MASU_TEXT(options, door, "open", "MODEL",
              "door that opens after --frames, with the lamp on: the response to it"),
    MASU_REAL(options, lamp_color, "lamp-color", "VALUE", 0, 1e9, "its colour, grey"),
    MASU_STUDY_FRAMES(10000, "frames until the bounce has converged"),
    MASU_STUDY_CSV,
    MASU_STUDY_DEVICE,
    MASU_STUDY_END};

const masu_study masu_study_bounce = {
    .name = "bounce",
    .purpose = "indirect light of a live bounce, compared with paths of the reference",
    .arguments = "SCENE.masu [--sdf FILE] [options]",
    .scenes_min = 1,
    .scenes_max = 1,
    .options = rows,
    .given = &given.study,
    .run = run,
    .details =
        "Irradiance of points, less the direct light of sun and local lights: that of a frame is "
        "the light that the\n"
        "bounce adds to a pixel, over its diffuse albedo; also without ambient occlusion. Its mean "
        "in the reference and "
        "the noise of one\n"
        "point, its mean in the last frame, the RMSE relative to the reference's mean, frames "
        "until the mean stays\n"
        "within a tenth of its change, and the relative change of the mean in the last frame. "
        "Light straight from\n"
        "emissive surfaces is indirect, unless area lights stand for them.\n"};

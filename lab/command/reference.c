/* reference.c: `masu-lab reference`: renders an image of a scene by the path tracer of
 * lab/reference, which shares nothing with the renderer. */
#include "bake/light/environment.h"
#include "image.h"
#include "lab/command/commands.h"
#include "lab/reference/model_error.h"
#include "lab/reference/render.h"
#include "measure/linear.h"
#include "measure/patches.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct options {
    const char *output, *errors, *store, *sdf, *sky, *model_error;
    VkExtent2D size;
    uint32_t paths, threads, seed, bounces, transport, fields_shadow;
    double time, sun[2], sun_radius, turn, scale, occlusion[2], window[6];
    bool physics, at_rest, own_sun, progress, cycles;
} options;

static const char *const transports[] = {"auto", "direct", "full", NULL};

static bool read_sun(masu_cli *cli, void *to) {
    options *o = to;
    o->own_sun = true;
    return masu_cli_sun(cli, o->sun);
}

static bool read_animate(masu_cli *cli, void *to) {
    options *o = to;
    o->at_rest = cli->value && !strcmp(cli->value, "off");
    if (!cli->value || o->at_rest) return true;
    masu_cli_usage_error("--animate: expected off, found \"%s\"", cli->value);
    return false;
}

static bool read_window(masu_cli *cli, void *to) {
    options *o = to;
    double *w = o->window;
    if (sscanf(cli->value, "%lf,%lf,%lf,%lf,%lf,%lf", &w[0], &w[1], &w[2], &w[3], &w[4], &w[5]) ==
            6 &&
        w[0] < w[3] && w[1] < w[4] && w[2] < w[5])
        return true;
    masu_cli_usage_error(
        "--window: expected two corners X,Y,Z,X,Y,Z, the lower one first, not \"%s\"", cli->value);
    return false;
}

static const masu_option rows[] = {
    MASU_HEADING("Output"),
    {MASU_ROW(options, output, MASU_TAKE_IMAGE, "output", "FILE",
              "FILE.pfm, FILE.exr: linear image before exposure; FILE.png: 8 bits of sRGB, with "
              "the scene's\n"
              "exposure and the filmic tone curve"),
     .letter = 'o'},
    MASU_FILE(options, errors, "error", "FILE.pfm", "standard error of each value"),
    MASU_FILE(options, store, "store", "FILE.ref",
              "image as half floats with means and errors of 144 patches, for tests"),
    MASU_FILE(options, model_error, "model-error", "FILE.csv",
              "without a scene: light that the model of materials and --physics return"),
    MASU_OUTPUT_SIZE_ROW(options, size),
    MASU_FLAG(options, progress, "progress", "report the progress if stderr is no terminal, too"),
    MASU_HEADING("Scene"),
    MASU_REAL(options, time, "time", "SECONDS", -1e9, 1e9,
              "time in the scene and on its camera path"),
    MASU_OWN("animate", "[=off]", read_animate,
             "loop the first animation clip of every model (default); off: keep the rest pose"),
    MASU_OWN("sun", "AZIMUTH,ELEVATION", read_sun,
             "sun position in degrees (default: the scene's)"),
    MASU_TEXT(options, sdf, "sdf", "FILE",
              "source of the scene's signed distance field: .sdf or GLSL"),
    MASU_TEXT(
        options, sky, "sky", "FILE.hdr",
        "panorama (.hdr, .pfm) instead of the scene's sky: the file of an environment map, or\n"
        "an image of an analytic sky"),
    MASU_REAL(options, turn, "sky-rotate", "DEGREES", -360, 360,
              "azimuth of the panorama's centre"),
    MASU_REAL(options, scale, "sky-scale", "FACTOR", 1e-6, 1e6, "factor for its radiance"),
    MASU_OWN(
        "window", "X,Y,Z,X,Y,Z", read_window,
        "box through which the sky is sampled (full): less noise in a room, the same mean"),
    MASU_HEADING("Light"),
    MASU_FLAG(
        options, physics, "physics",
        "random walks between facets and shadows of all lights instead of Masu's closed model"),
    MASU_CHOICE(options, transport, "transport", "PATHS", transports,
                "direct: the light paths that Masu specifies; full: all paths; auto: full with\n"
                "--physics and with light probes\n"),
    MASU_UINT(options, bounces, "bounces", 0, 1000, "most bounces of a path (full)"),
    MASU_REAL(options, sun_radius, "sun-radius", "DEGREES", 0, 20,
              "radius of the sun's disc; 0: a point"),
    MASU_UINT(options, fields_shadow, "sdf-shadows", 0, 1,
              "1: the field casts shadows (default: if the scene has any)"),
    MASU_REAL(options, occlusion[0], "sdf-ambient", "METRES", 0, 1e6,
              "radius of the field's ambient occlusion; 0: none"),
    MASU_REAL(options, occlusion[1], "sdf-ambient-strength", "SHARE", 0, 1, "its strength"),
    MASU_FLAG(options, cycles, "cycles",
              "microfacets of Blender's Cycles: uncorrelated masking, one bounce between them"),
    MASU_HEADING("Samples"),
    MASU_UINT(options, paths, "paths", 1, 100000000, "paths per pixel"),
    MASU_UINT(options, seed, "seed", 0, UINT32_MAX, "another seed gives other noise"),
    MASU_UINT(options, threads, "threads", 1, 64,
              "threads; the image does not depend on them (default: all)"),
    {.name = NULL}};

static void report(double share) { masu_cli_progress("%.0f %% of the image", 100 * share); }

static void report_line(double share) {
    static int shown = -1;
    int tenth = (int)(share * 10);
    if (tenth == shown) return;
    shown = tenth;
    fprintf(stderr, "masu-lab reference: %d %%\n", 10 * tenth);
}

static void command_line(const options *o, const char *scene, char *text, size_t size) {
    const char *slash = strrchr(scene, '/'), *sdf = o->sdf ? strrchr(o->sdf, '/') : NULL;
    size_t at = (size_t)snprintf(
        text, size, "masu-lab reference %s --size %ux%u --paths %u --seed %u --time %g",
        slash ? slash + 1 : scene, o->size.width, o->size.height, o->paths, o->seed, o->time);
    if (o->sdf) at += (size_t)snprintf(text + at, size - at, " --sdf %s", sdf ? sdf + 1 : o->sdf);
    if (o->at_rest) at += (size_t)snprintf(text + at, size - at, " --animate=off");
    if (o->physics) at += (size_t)snprintf(text + at, size - at, " --physics");
    if (o->transport)
        at += (size_t)snprintf(text + at, size - at, " --transport %s", transports[o->transport]);
    if (o->sun_radius > 0)
        at += (size_t)snprintf(text + at, size - at, " --sun-radius %g", o->sun_radius);
    if (o->fields_shadow < 2)
        at += (size_t)snprintf(text + at, size - at, " --sdf-shadows %u", o->fields_shadow);
    if (o->occlusion[0] > 0)
        at += (size_t)snprintf(text + at, size - at, " --sdf-ambient %g", o->occlusion[0]);
    if (o->occlusion[1] < 1)
        snprintf(text + at, size - at, " --sdf-ambient-strength %g", o->occlusion[1]);
}

/* Uses the curve of shaders/shared/tone.glsl. */
static bool save_png(const char *path, const ref_image *image, double exposure, char *error,
                     size_t size) {
    const size_t pixels = (size_t)image->width * image->height;
    float *shown = malloc(3 * pixels * sizeof *shown);
    uint8_t *rgba = malloc(4 * pixels);
    bool good = shown && rgba;
    if (!good) snprintf(error, size, "out of memory for %s", path);
    for (size_t i = 0; good && i < 3 * pixels; i++) {
        double x = fmin(fmax((double)image->mean[i] * exposure, 0), 1e4);
        shown[i] = (float)fmin(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 1);
    }
    if (good) masu_srgb_encode(shown, pixels, rgba);
    good = good && masu_image_save_png(path, rgba, image->width, image->height, 0, error, size);
    free(rgba);
    free(shown);
    return good;
}

static bool save(const options *o, const char *scene, double exposure, const ref_image *image,
                 char *error, size_t size) {
    masu_reference *r = calloc(1, sizeof *r);
    bool good = r != NULL;
    if (o->output && masu_image_is_linear(o->output))
        good = good && masu_image_save_linear(o->output, image->mean, image->width, image->height,
                                              error, size);
    else if (o->output)
        good = good && save_png(o->output, image, exposure, error, size);
    if (o->errors)
        good = good && masu_image_save_pfm(o->errors, image->error, image->width, image->height, 3,
                                           error, size);
    if (good && o->store) {
        *r =
            (masu_reference){.width = image->width, .height = image->height, .pixels = image->mean};
        command_line(o, scene, r->command, sizeof r->command);
        masu_patches_of(image->mean, image->error, image->width, image->height, r->patches);
        good = masu_reference_save(o->store, r, error, size);
    }
    free(r);
    return good;
}

/* Warns about features of the scene that the reference does not check. */
static void warn(const options *o, const ref_scene *s) {
    if (s->blob.section[MASU_BLOB_OCCLUSION_SPIRV] && !(o->occlusion[0] > 0) && !o->physics)
        masu_cli_warn("the blob has no data on ambient occlusion by the field: give the "
                      "radius by --sdf-ambient");
    if (s->meso) masu_cli_warn("mesoscale detail of materials is ignored");
    if (o->output && !masu_image_is_linear(o->output) && (double)s->environment->metered > 0)
        masu_cli_warn("auto-exposure is ignored");
}

static int render(const options *o, const char *path, ref_scene *scene, const ref_field *field,
                  ref_sky *sky) {
    char error[1024];
    const masu_blob_environment *e = scene->environment;
    ref_world world;
    ref_tracer t = {.world = &world,
                    .sky = sky,
                    .physics = o->physics,
                    .full = o->transport ? o->transport == 2 : o->physics || scene->probes,
                    .polygons_shadow = scene->shadow || o->physics,
                    .sky_samples = true,
                    .light_samples = true,
                    .bsdf_samples = true,
                    .bounces = o->bounces,
                    .sun_radius = o->sun_radius * REF_PI / 180,
                    .sun_direction = ref_of(e->sun_direction),
                    .sun_color = ref_of(e->sun_color),
                    .occlusion_radius = (double)e->occlusion_radius,
                    .field_occlusion_radius = o->occlusion[0],
                    .field_occlusion_strength = o->occlusion[1],
                    .cutoff = scene->reflections ? (double)scene->reflections->cutoff : 0,
                    .window = {{o->window[0], o->window[1], o->window[2]},
                               {o->window[3], o->window[4], o->window[5]},
                               o->window[0] < o->window[3]},
                    .environment = e};
    t.field_shadows = o->fields_shadow == 1 || o->physics ||
                      (o->fields_shadow == 2 && scene->blob.section[MASU_BLOB_OCCLUSION_SPIRV]);
    if (o->own_sun) {
        double azimuth = o->sun[0] * REF_PI / 180, elevation = o->sun[1] * REF_PI / 180;
        t.sun_direction =
            ref_v(cos(elevation) * sin(azimuth), sin(elevation), cos(elevation) * cos(azimuth));
    }
    ref_render r = {.tracer = &t,
                    .camera = ref_camera_at(&scene->blob, o->time),
                    .paths = o->paths,
                    .threads = o->threads,
                    .seed = o->seed,
                    .progress = isatty(2)     ? report
                                : o->progress ? report_line
                                              : NULL};
    ref_image image = {o->size.width, o->size.height, NULL, NULL};
    t.eye = r.camera.eye;
    masu_cli_progress("building the tree of %llu triangles",
                      (unsigned long long)scene->triangle_count);
    if (!ref_world_open(scene, field, t.eye, &world, error, sizeof error))
        return masu_cli_error("%s", error);
    bool good = ref_render_image(&r, &image);
    if (!good)
        snprintf(error, sizeof error, "out of memory for an image of %ux%u", o->size.width,
                 o->size.height);
    masu_cli_progress_clear();
    good = good && save(o, path, (double)e->exposure, &image, error, sizeof error);
    ref_image_free(&image);
    ref_world_close(&world);
    return good ? MASU_CLI_OK : masu_cli_error("%s", error);
}

static int open_sky(const options *o, const ref_scene *scene, ref_sky *sky, float **pixels) {
    const masu_blob_environment_map *map = scene->blob.section[MASU_BLOB_ENVIRONMENT_MAP];
    const masu_blob_environment *e = scene->environment;
    *sky = (ref_sky){.zenith = ref_of(e->sky_zenith),
                     .horizon = ref_of(e->sky_horizon),
                     .ambient = ref_of(e->ambient)};
    if (map) {
        sky->octahedron = scene->blob.section[MASU_BLOB_ENVIRONMENT_TEXELS];
        sky->size = map->size;
    }
    if (o->sky) {
        masu_bake_panorama p = {.turn = 0, .factor = 1, .name = o->sky};
        if (!masu_bake_load_panorama(o->sky, &p))
            return MASU_CLI_FAILURE; /* already reported */
        sky->octahedron = NULL;
        sky->panorama = *pixels = p.rgb;
        sky->width = p.width;
        sky->height = p.height;
        sky->turn = o->turn * REF_PI / 180;
        sky->factor = o->scale;
    }
    return ref_sky_prepare(sky) ? MASU_CLI_OK : masu_cli_error("out of memory for the sky");
}

static int run_reference(const options *o, const char *path) {
    char error[4096];
    ref_scene scene;
    ref_field field;
    ref_sky sky;
    float *pixels = NULL;
    masu_cli_progress("reading %s", path);
    if (!ref_scene_open(path, o->time, !o->at_rest, &scene, error, sizeof error)) {
        ref_scene_close(&scene);
        return masu_cli_error("%s", error);
    }
    bool has_field = false;
    int code = MASU_CLI_OK;
    if (scene.sdf && !o->sdf)
        code = masu_cli_error(
            "%s: the scene has a signed distance field: give its source by --sdf FILE", path);
    if (!scene.sdf && o->sdf) code = masu_cli_error("--sdf: %s has no signed distance field", path);
    /* The analytic sky lights the scene and contains its sun: a comparison needs an image of it. */
    if (!code && (double)scene.environment->turbidity > 0 && !o->sky)
        code = masu_cli_error("%s: the scene has an analytic sky (turbidity %g): give an image of "
                              "it by --sky FILE",
                              path, (double)scene.environment->turbidity);
    if (!code && scene.sdf) {
        masu_cli_progress("compiling %s", o->sdf);
        has_field = ref_field_open(o->sdf, &scene.blob, o->time, &field, error, sizeof error);
        if (!has_field) code = masu_cli_error("%s", error);
    }
    memset(&sky, 0, sizeof sky);
    if (!code) code = open_sky(o, &scene, &sky, &pixels);
    if (!code) {
        warn(o, &scene);
        code = render(o, path, &scene, has_field ? &field : NULL, &sky);
    }
    ref_sky_close(&sky);
    free(pixels);
    if (has_field) ref_field_close(&field);
    ref_scene_close(&scene);
    return code;
}

static int write_model_error(const options *o) {
    FILE *file = fopen(o->model_error, "w");
    if (!file) return masu_cli_error("%s: %s", o->model_error, strerror(errno));
    fprintf(file, "# masu-lab reference --model-error FILE.csv --paths %u --seed %u\n", o->paths,
            o->seed);
    ref_model_error(file, o->paths, o->seed);
    if (fclose(file)) return masu_cli_error("%s: %s", o->model_error, strerror(errno));
    return MASU_CLI_OK;
}

static int run(masu_cli *cli) {
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    options o = {.size = {640, 360},
                 .paths = 64,
                 .bounces = 16,
                 .scale = 1,
                 .fields_shadow = 2,
                 .occlusion = {0, 1}};
    masu_given given = {.most = 1, .excess = "expected one scene"};
    int code;
    if (!masu_options_read(cli, rows, &o, &given, &code)) return code;
    if (o.model_error && !given.count) return write_model_error(&o);
    if (!given.count) return masu_cli_usage_error("no scene given: expected SCENE.masu");
    if (!o.output && !o.store && !o.errors)
        return masu_cli_usage_error("expected at least one of --output, --error, --store");
    if (!o.threads) o.threads = cores > 0 && cores < 64 ? (uint32_t)cores : 1;
    ref_ggx_use_cycles(o.cycles);
    return run_reference(&o, given.arguments[0]);
}

const masu_cli_command lab_reference = {
    .name = "reference",
    .arguments = "SCENE.masu -o X.pfm|X.exr|X.png [options]",
    .summary = "render a scene by a path tracer that shares nothing with the renderer",
    .details = "The default is the model that Masu specifies: a difference from `masu render` is a "
               "bug, or\n"
               "an approximation. --physics shows the difference of that model from physics.\n"
               "The result is the same for any number of threads.\n",
    .run = run};

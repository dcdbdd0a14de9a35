/* build.c: the steps of building; see build.h. The order matters:
 *   - occluders use the full meshes and are then matched with their LODs;
 *   - the bounds of all instances frame the camera;
 *   - the SDF's shader depends on whether there are polygons;
 *   - textures decide which materials are masked or blended, before occluders are dropped
 *     and BVHs built;
 *   - instances are sorted before their indices are stored. */
#include "bake/build/build.h"
#include "bake/build/first_look.h"
#include "bake/build/look.h"
#include "bake/build/parts.h"
#include "bake/light/environment.h"
#include "bake/light/field.h"
#include "bake/light/picture_sun.h"
#include "bake/mesh/rise.h"
#include "bake/scene/camera.h"
#include "bake/scene/groups.h"
#include "bake/scene/skin.h"
#include "bake/scene/sun.h"
#include "bake/texture/texture.h"
#include "bake/texture/trace_texture.h"
#include "cli/cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REPORT_POINTS 1024u
#define REPORT_RAYS 4096u
/* By default, larger scenes are not traced: their BVH takes seconds to bake, and an integrated GPU
 * is hardly fast enough to traverse it. */
#define TRACED_TRIANGLES_MAX 500000u
#define LARGE 1000 /* metres: longer models may have other units */

static void make_detail(const masu_bake_description *d, masu_bake_content *content,
                        masu_bake_report *report) {
    masu_cli_progress("making occluders and LODs");
    masu_bake_make_occluders(content, d->occluders, &report->occluders);
    masu_bake_make_lods(content, d->lods, &report->lods);
    masu_bake_prove_occluders(content);
}

/* Adds all of the SDF except its shader. */
static void add_sdf(const masu_bake_sdf *sdf, masu_bake_content *content) {
    for (size_t i = 0; i < sdf->param_count; i++) {
        const masu_bake_sdf_param *p = &sdf->params[i];
        masu_blob_sdf_param param = {p->value, p->low, p->high,
                                     masu_bake_name(content, p->name, strlen(p->name))};
        masu_bake_append(&content->section[MASU_BLOB_SDF_PARAMS], &param, sizeof param);
    }
    masu_blob_sdf out = {.lipschitz = (float)sdf->lipschitz,
                         .max_distance = (float)sdf->max_distance,
                         .has_raster = masu_bake_count(content, MASU_BLOB_INSTANCES) > 0,
                         .part_count = 1,
                         .flags = sdf->anchored ? MASU_SDF_ANCHORED : 0};
    masu_bake_store(sdf->bounds.low, out.bounds_min);
    masu_bake_store(sdf->bounds.high, out.bounds_max);
    masu_bake_append(&content->section[MASU_BLOB_SDF], &out, sizeof out);
}

static bool load_panorama(const masu_bake_environment *e, masu_bake_panorama *out) {
    if (!e->file) return true;
    if (!masu_bake_load_panorama(e->file, out)) return false;
    out->turn = e->rotate * (MASU_BAKE_PI / 180);
    out->factor = e->scale;
    return true;
}

/* Uses a model's camera as the camera key. */
static bool take_camera(masu_bake_description *d, const masu_bake_box *bounds,
                        const masu_bake_content *content, masu_blob_camera_key *key) {
    const masu_bake_camera *camera = masu_bake_find_camera(content, d->look.camera);
    if (!camera) {
        masu_bake_buffer names = {0};
        for (uint32_t i = 0; i < masu_bake_camera_count(content) && names.bytes < 300; i++) {
            masu_bake_append_text(&names, i ? ", \"" : "\"");
            masu_bake_append_text(&names, MASU_BAKE_CAMERAS(content)[i].name);
            masu_bake_append_text(&names, "\"");
        }
        masu_bake_append(&names, "", 1);
        (void)masu_bake_wrong(d, "camera.from", "no model has a camera \"%s\"; available: %s",
                              d->look.camera, names.bytes > 1 ? (const char *)names.data : "none");
        masu_bake_release(&names);
        return false;
    }
    masu_bake_vec3 at = masu_bake_v3f(camera->position);
    /* The distance must be resolvable in floats at large coordinates. */
    double ahead = fmax(1, masu_bake_length(at) * 1e-3);
    *key = (masu_blob_camera_key){
        .fov_y = d->look.own_fov_y ? (float)(d->look.fov_y * (MASU_BAKE_PI / 180)) : camera->fov_y};
    masu_bake_vec3 forward = masu_bake_v3f(camera->direction);
    if (camera->height > 0 && !(d->look.height > 0)) d->look.height = (double)camera->height;
    if (d->look.own_fov_y) d->look.height = 0;
    /* exact at the centre of the scene */
    if (d->look.height > 0 && !masu_bake_box_is_empty(bounds)) {
        masu_bake_vec3 middle =
            masu_bake_mad(bounds->low, masu_bake_sub(bounds->high, bounds->low), 0.5);
        ahead = fmax(ahead, masu_bake_dot(masu_bake_sub(middle, at), forward));
    }
    masu_bake_store(at, key->position);
    masu_bake_store(masu_bake_mad(at, forward, ahead), key->target);
    return true;
}

/* Uses the models' first directional light if the scene specifies no sun. */
static void take_sun(masu_bake_description *d, const masu_bake_content *content) {
    masu_bake_look *look = &d->look;
    for (uint32_t i = 0; i < masu_bake_sun_count(content); i++) {
        const masu_bake_sun *sun = &MASU_BAKE_SUNS(content)[i];
        if (i > 0 || d->look.own_sun) {
            masu_cli_warn("%s: directional light \"%s\": ignored, since the scene has %s", d->file,
                          sun->name, d->look.own_sun ? "a sun" : "another one");
            continue;
        }
        look->sun_direction = masu_bake_v3f(sun->direction);
        look->sun_color = masu_bake_v3f(sun->color);
        look->sun_intensity = 1;
        look->own_sun_color = look->sun_of_model = true;
    }
}

/* The sun of the environment map becomes the scene's sun. A sun of the description replaces it. If
 * that sun is black, or is a model's light, the map keeps its sun and is the only source of its
 * light. */
static void take_panorama_sun(const masu_bake_environment *e, masu_bake_panorama *p,
                              masu_bake_look *look) {
    const masu_bake_vec3 *own = &look->sun_color;
    bool black = !(look->sun_intensity > 0) || (own->x == 0 && own->y == 0 && own->z == 0);
    masu_bake_picture_sun sun;
    if (!p->rgb || look->sun_of_model || (look->own_sun && black)) return;
    bool found = masu_bake_cut_sun(p, &sun);
    if (found && !masu_cli_quiet()) {
        printf("%s: its sun, %.3g %.3g %.3g towards %.3f %.3f %.3f, is %s\n", e->file, sun.color[0],
               sun.color[1], sun.color[2], sun.direction[0], sun.direction[1], sun.direction[2],
               look->own_sun ? "replaced by the scene's" : "the scene's");
    }
    if (look->own_sun) return;
    look->sun_intensity = found ? 1 : 0;
    if (!found) return;
    look->sun_direction = masu_bake_v3(sun.direction[0], sun.direction[1], sun.direction[2]);
    look->sun_color = masu_bake_v3(sun.color[0], sun.color[1], sun.color[2]);
}

/* Units of a model without a scene are metres unless its file specifies others; few objects are
 * kilometres wide. */
static void hint_at_units(const masu_bake_description *d, const masu_bake_box *bounds) {
    if (masu_bake_box_is_empty(bounds) || !d->model_count || !d->models[0].plays ||
        masu_cli_quiet())
        return;
    masu_bake_vec3 e = masu_bake_sub(bounds->high, bounds->low);
    double longest = fmax(e.x, fmax(e.y, e.z));
    if (longest < LARGE) return;
    printf("%s: is %.3g m long; if its file is in centimetres or millimetres, use a scene with a "
           "\"scale\" of 0.01 or "
           "0.001 (--describe writes one)\n",
           d->models[0].file, longest);
}

/* Adds models, SDF, camera and light. Completes the members of the description that depend on the
 * models. */
static bool build_scene(masu_bake_description *d, const masu_bake_options *options,
                        masu_bake_content *content, masu_bake_report *report) {
    if (!masu_bake_build_models(d, 0, options->textures, content)) return false;
    make_detail(d, content, report);
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_box bounds = report->bounds = masu_bake_bounds(content, &identity);
    hint_at_units(d, &bounds);
    if (d->default_reflections &&
        masu_bake_count(content, MASU_BLOB_INDICES) / 3 > TRACED_TRIANGLES_MAX)
        d->reflections.wanted = false;
    if (!masu_bake_build_lights(d, content)) return false;
    if (d->sdf.source) {
        add_sdf(&d->sdf, content);
        /* The models' bounds frame the camera better than those of an endless world. */
        if (masu_bake_box_is_empty(&bounds)) bounds = d->sdf.framed;
    }
    if (d->first_look && !masu_bake_box_is_empty(&bounds)) {
        size_t placed = d->model_count;
        masu_bake_make_first_look(&bounds, content, d);
        if (!masu_bake_build_models(d, placed, options->textures, content)) return false;
    }
    if (d->look.camera) {
        d->look.keys = masu_bake_take(&d->pool, sizeof *d->look.keys);
        d->look.key_count = 1;
        if (!take_camera(d, &bounds, content, d->look.keys)) return false;
    }
    masu_bake_panorama panorama = {0};
    if (!load_panorama(&d->environment, &panorama)) return false;
    take_sun(d, content);
    take_panorama_sun(&d->environment, &panorama, &d->look);
    masu_bake_build_look(&d->look, &bounds, content);
    if (panorama.rgb) masu_bake_add_environment(&panorama, d->environment.size, content);
    free(panorama.rgb);
    if (options->describe) return true;
    return !d->sdf.source || masu_bake_compile_march(content, d->sdf.source, &d->sdf.occlusion,
                                                     d->sdf.is_static, d->reflections.wanted,
                                                     d->probes.live, options->variants);
}

static bool build_probes(const masu_bake_description *d, const masu_bake_options *options,
                         masu_bake_content *content) {
    masu_bake_probe_settings probes = d->probes;
    probes.wanted |= options->probes;
    if (!probes.wanted && !probes.live) return true;
    probes.threads = options->threads;
    masu_bake_trace *trace = masu_bake_trace_make(content);
    masu_bake_field *field = trace ? masu_bake_field_make(content, d->sdf.source) : NULL;
    if (field) masu_bake_trace_add(trace, field);
    masu_bake_probe_report done = {0};
    bool good = trace && masu_bake_make_probes(content, &probes, trace, &done);
    masu_cli_progress_clear();
    if (good && !masu_cli_quiet()) {
        printf("%llu light probes (%llu inside of things), %llu bytes, %llu rays at %llu triangles "
               "in %.2f s: %.2f million a second\n",
               (unsigned long long)done.probes, (unsigned long long)done.invalid,
               (unsigned long long)done.bytes, (unsigned long long)done.rays,
               (unsigned long long)done.triangles, done.seconds,
               done.seconds > 0 ? (double)done.rays / done.seconds * 1e-6 : 0.0);
    }
    if (good && options->probe_report)
        masu_bake_report_probes(content, &probes, trace, REPORT_POINTS, REPORT_RAYS);
    masu_bake_trace_release(trace);
    masu_bake_field_release(field);
    return good;
}

bool masu_bake_build(masu_bake_description *d, const masu_bake_options *options,
                     masu_bake_content *content, masu_bake_report *report) {
    if (!build_scene(d, options, content, report)) return false;
    if (options->describe) return true;
    /* rays are for probes only, not for reflections */
    if (d->probes.live && !d->reflections.wanted) {
        d->reflections.wanted = true;
        d->reflections.cutoff = 0;
    }
    content->pictures_wanted = report->reflected = d->reflections.wanted;
    content->picture_side = d->reflections.texture_size;
    if (!masu_bake_make_textures(content, options->texture_path)) return false;
    masu_bake_measure_rise(content);
    masu_bake_gather_skins(content);
    masu_bake_sort_instances(content);
    masu_bake_groups(content);
    masu_bake_sort_occluders(content);
    masu_bake_drop_occluders(content);
    if (!masu_bake_make_bvh(content, &d->reflections, &report->reflections)) return false;
    masu_bake_trace_textures(content);
    if (content->names_cut)
        masu_cli_warn("%u names of the scene are longer than %u bytes and were truncated",
                      content->names_cut, MASU_BLOB_NAME_MAX);
    return build_probes(d, options, content);
}

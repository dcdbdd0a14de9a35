/* first_look.c: a default presentation for a model without a scene: three-quarter view, the model
 * nearly fills the frame, a sky light from the side, a background dark enough for white objects, a
 * ground that receives shadow and a soft reflection; see first_look.h.
 *
 * The camera's direction is given; its position then has an exact solution. In camera axes, a point
 * (x, y, z) with z into the image is in the frame if |x - cx| <= a (z - cz) and |y - cy| <= b (z -
 * cz), where a and b are the tangents of the half angles. The four bounds are planes. One pass over
 * the vertices finds the extreme point for each plane, which gives the closest cz that satisfies
 * all. */
#include "bake/build/first_look.h"
#include "bake/mesh/shape.h"

#include <string.h>

/* of the frame's height or width, whichever the model reaches first */
#define FRAME_SHARE 0.89
#define MOVING_SHARE 0.75 /* for a model that plays clips, which is framed in its rest pose */
/* of the intended frame: narrower ones crop a wide model */
#define ASPECT (16.0 / 9)
/* height / the shorter side; below it, a model is a landscape: no ground, higher camera */
#define FLAT 0.12
#define STEEP 0.85        /* height / depth of the camera's direction for landscapes */
#define LOW 0.5           /* height / the longer side, for models that are viewed from above */
#define LOOK_DOWN 0.3     /* of its height: the camera's height above the top */
#define GROUND_RADII 60 /* half a side of the ground, in radii of the model: it ends in the haze */

typedef struct axes {
    masu_bake_vec3 right, up, forward;
} axes;

static axes axes_of(masu_bake_vec3 towards_camera) {
    const masu_bake_vec3 zero = {0, 0, 0};
    axes a = {.forward = masu_bake_mad(zero, towards_camera, -1)};
    masu_bake_normalize(&a.forward);
    a.right = masu_bake_cross(a.forward, masu_bake_v3(0, 1, 0));
    masu_bake_normalize(&a.right);
    a.up = masu_bake_cross(a.right, a.forward);
    return a;
}

/* Maximum extent of the vertices across the four planes that bound the frame. */
typedef struct reach {
    double right, left, above, below; /* maximum of x - a z, -x - a z, y - b z, -y - b z */
} reach;

static void reach_of(const masu_bake_content *c, const axes *at, double a, double b, reach *r) {
    *r = (reach){-HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *instance = &MASU_BAKE_INSTANCES(c)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(c)[instance->mesh];
        masu_bake_affine world = masu_bake_transform(instance);
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[mesh->first_primitive + j];
            for (uint32_t k = 0; k < p->vertex_count; k++) {
                const float *v = MASU_BAKE_VERTICES(c)[p->first_vertex + k].position;
                masu_bake_vec3 q = masu_bake_apply(&world, masu_bake_v3f(v));
                double x = masu_bake_dot(q, at->right), y = masu_bake_dot(q, at->up);
                double z = masu_bake_dot(q, at->forward);
                r->right = fmax(r->right, x - a * z);
                r->left = fmax(r->left, -x - a * z);
                r->above = fmax(r->above, y - b * z);
                r->below = fmax(r->below, -y - b * z);
            }
        }
    }
}

static masu_bake_vec3 extent_of(const masu_bake_box *box) {
    return masu_bake_sub(box->high, box->low);
}

static bool is_flat(const masu_bake_box *box) {
    masu_bake_vec3 e = extent_of(box);
    return e.y < FLAT * fmin(e.x, e.z);
}

/* The distance is at least the model's depth: otherwise a stick that points at the camera would
 * touch it. */
static masu_blob_camera_key frame(const masu_bake_content *c, const masu_bake_box *box,
                                  double fov_y, masu_bake_vec3 towards) {
    const masu_bake_vec3 zero = {0, 0, 0};
    axes at = axes_of(towards);
    double share = masu_bake_count(c, MASU_BLOB_CLIPS) ? MOVING_SHARE : FRAME_SHARE;
    double b = tan(fov_y * (MASU_BAKE_PI / 360)) * share, a = b * ASPECT;
    reach r;
    reach_of(c, &at, a, b, &r);
    masu_bake_vec3 center = masu_bake_mad(box->low, extent_of(box), 0.5);
    double middle = masu_bake_dot(center, at.forward);
    double radius = fmax(masu_bake_length(extent_of(box)) / 2, 1e-3);
    double z = fmin(-(r.right + r.left) / (2 * a), -(r.above + r.below) / (2 * b));
    z = fmin(z, middle - radius * 0.25);
    double x = (r.right - r.left) / 2, y = (r.above - r.below) / 2;
    masu_bake_vec3 across = masu_bake_mad(masu_bake_mad(zero, at.right, x), at.up, y);
    masu_blob_camera_key key = {.fov_y = (float)(fov_y * (MASU_BAKE_PI / 180))};
    masu_bake_store(masu_bake_mad(across, at.forward, z), key.position);
    masu_bake_store(masu_bake_mad(across, at.forward, fmax(middle, z + radius * 0.25)), key.target);
    return key;
}

/* For a long, low model, such as a table, the front fills the frame: the camera rises until the top
 * is visible. */
static masu_blob_camera_key frame_from_above(const masu_bake_content *c, const masu_bake_box *box,
                                             double fov_y, bool flat) {
    masu_bake_vec3 e = extent_of(box);
    double rise = flat ? STEEP : 0.38, seen = box->high.y + LOOK_DOWN * e.y;
    bool low = e.y < LOW * fmax(e.x, e.z);
    masu_blob_camera_key key = frame(c, box, fov_y, masu_bake_v3(0.62, rise, 1.0));
    while (low && rise < STEEP && !((double)key.position[1] > seen)) {
        rise += 0.1;
        key = frame(c, box, fov_y, masu_bake_v3(0.62, rise, 1.0));
    }
    return key;
}

/* Slightly below the model: faces at the bottom, such as soles and tyres, must not z-fight with
 * it. */
static void add_ground(const masu_bake_box *box, masu_bake_description *d) {
    masu_bake_vec3 e = extent_of(box);
    double radius = fmax(masu_bake_length(e) / 2, 1e-3), side = 2 * GROUND_RADII * radius;
    masu_bake_vec3 center = masu_bake_mad(box->low, e, 0.5);
    center.y = box->low.y - radius * 1e-3;
    masu_bake_model *models = masu_bake_take(&d->pool, (d->model_count + 1) * sizeof *models);
    masu_bake_shape *shapes = masu_bake_take(&d->pool, (d->shape_count + 1) * sizeof *shapes);
    masu_bake_material_change *grey = masu_bake_take(&d->pool, sizeof *grey);
    const float color[3] = {0.16f, 0.16f, 0.165f};
    grey->value = (masu_bake_override){
        .base_color = true, .roughness = true, .metallic = true, .specular = true};
    memcpy(grey->value.value.base_color, color, sizeof color);
    grey->value.value.roughness = 0.28f;
    grey->value.value.specular = 0.5f;
    if (d->model_count) memcpy(models, d->models, d->model_count * sizeof *models);
    if (d->shape_count) memcpy(shapes, d->shapes, d->shape_count * sizeof *shapes);
    shapes[d->shape_count] = (masu_bake_shape){MASU_BAKE_PLANE, {side, 0, side}, 0, 1};
    models[d->model_count] = (masu_bake_model){.where = "",
                                               .shape = (uint32_t)d->shape_count,
                                               .name = "ground",
                                               .lights = 1,
                                               .placement = masu_bake_identity(),
                                               .translation = center,
                                               .changes = grey,
                                               .change_count = 1};
    d->models = models;
    d->shapes = shapes;
    d->model_count++;
    d->shape_count++;
}

static void set_light(const masu_bake_box *box, bool flat, masu_bake_look *l) {
    const float *p = l->keys[0].position;
    masu_bake_vec3 e = extent_of(box), center = masu_bake_mad(box->low, e, 0.5);
    double radius = fmax(masu_bake_length(e) / 2, 1e-3);
    /* From the left of the camera and above it: shading shows the shape. */
    l->sun_direction = masu_bake_v3(-0.55, 1.0, 0.95);
    masu_bake_normalize(&l->sun_direction);
    l->sun_color = masu_bake_v3(1, 0.95, 0.87);
    l->sun_intensity = 1.5;
    l->ambient = masu_bake_v3(0.17, 0.19, 0.23);
    l->zenith = masu_bake_v3(0.05, 0.09, 0.17);
    l->horizon = masu_bake_v3(0.3, 0.35, 0.42);
    l->shadows = true;
    l->shadow = (masu_blob_shadow){.cascades = flat ? 3 : 2, .resolution = 2048, .lambda = 0.5f};
    l->shadow_distance = masu_bake_length(masu_bake_sub(center, masu_bake_v3f(p))) +
                         radius * (flat ? 1.0 : 2.5);
    l->occlusion = true;
    l->occlusion_radius = radius * 0.2;
    l->smooth_edges = true;
    if (flat) return;
    /* The far side of the ground becomes the horizon. */
    l->fog_color = l->horizon;
    l->fog_density = 3.9 / (GROUND_RADII * 0.8 * radius);
    l->fog_start = l->shadow_distance;
}

void masu_bake_make_first_look(const masu_bake_box *bounds, const masu_bake_content *content,
                               masu_bake_description *d) {
    bool flat = is_flat(bounds);
    double radius = fmax(masu_bake_length(extent_of(bounds)) / 2, 1e-3);
    d->look = masu_bake_default_look();
    d->look.keys = masu_bake_take(&d->pool, sizeof *d->look.keys);
    d->look.key_count = 1;
    d->look.keys[0] = frame_from_above(content, bounds, d->look.fov_y, flat);
    set_light(bounds, flat, &d->look);
    d->reflections.smallest = radius * 2 * MASU_BAKE_TRACED_SHARE; /* excludes the ground */
    if (!flat) add_ground(bounds, d);
}

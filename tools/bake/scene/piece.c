/* piece.c: see piece.h. */
#include "bake/scene/piece.h"

#include <fnmatch.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a scene's changes to materials ---- */

static bool same_override(const masu_bake_override *a, const masu_bake_override *b) {
    const masu_blob_material *x = &a->value, *y = &b->value;
    return a->base_color == b->base_color && a->roughness == b->roughness &&
           a->metallic == b->metallic && a->emissive == b->emissive && a->alpha == b->alpha &&
           a->single == b->single && a->shadowless == b->shadowless &&
           a->relief_of == b->relief_of && a->cutoff == b->cutoff &&
           memcmp(a->map, b->map, sizeof a->map) == 0 &&
           memcmp(&a->maps, &b->maps, sizeof a->maps) == 0 &&
           memcmp(x->base_color, y->base_color, sizeof x->base_color) == 0 &&
           memcmp(x->emissive, y->emissive, sizeof x->emissive) == 0 &&
           x->roughness == y->roughness && x->metallic == y->metallic &&
           a->specular == b->specular && a->coat == b->coat &&
           a->coat_roughness == b->coat_roughness && x->specular == y->specular &&
           x->coat == y->coat && x->coat_roughness == y->coat_roughness && a->meso == b->meso &&
           a->thickness == b->thickness && a->ior == b->ior && x->thickness == y->thickness &&
           x->ior == y->ior && x->meso == y->meso && a->opacity == b->opacity &&
           x->opacity == y->opacity && a->detail_color == b->detail_color &&
           a->color_repeats == b->color_repeats && a->detail == b->detail &&
           memcmp(x->detail, y->detail, sizeof x->detail) == 0 && a->unlit == b->unlit &&
           a->repeat == b->repeat && a->depth_bias == b->depth_bias &&
           x->depth_bias == y->depth_bias && strcmp(a->match, b->match) == 0;
}

bool masu_bake_overrides_equal(const masu_bake_overrides *a, const masu_bake_overrides *b) {
    if (a->count != b->count) return false;
    for (size_t i = 0; i < a->count; i++) {
        if (!same_override(&a->items[i], &b->items[i])) return false;
    }
    return true;
}

/* The file of a path, without folders. */
static const char *last_part(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

static bool matches(const masu_bake_content *piece, uint32_t index, const masu_bake_override *o) {
    uint32_t image = MASU_BAKE_MAPS_OF(piece)[index].image[MASU_BAKE_BASE];
    const char *name = masu_bake_name_text(piece, MASU_BAKE_MATERIALS(piece)[index].name);
    if (!*o->match || fnmatch(o->match, name, 0) == 0) return true;
    if (image == MASU_BLOB_NONE) return false;
    const char *path = (const char *)piece->image_text.data + MASU_BAKE_IMAGES(piece)[image].name;
    return fnmatch(o->match, last_part(path), 0) == 0;
}

bool masu_bake_override_matches(const masu_bake_content *piece,
                                const masu_bake_override *override) {
    for (uint32_t i = 0; i < masu_bake_count(piece, MASU_BLOB_MATERIALS); i++) {
        if (matches(piece, i, override)) return true;
    }
    return false;
}

/* A lobe that the scene specifies replaces the model's lobes: blob.h allows one, and none with a
 * coat. */
static void drop_lobes(const masu_bake_override *o, masu_blob_material *to, masu_bake_maps *maps) {
    if (!o->specular && !(to->coat > 0) && to->meso == MASU_BLOB_NONE) return;
    for (int k = 0; k < 3; k++) to->specular_color[k] = to->sheen_color[k] = 0;
    to->sheen_roughness = to->anisotropy = to->anisotropy_rotation = 0;
    if (to->specular > 1) to->specular = 1;
    maps->image[MASU_BAKE_LOBE_COLOR] = maps->image[MASU_BAKE_LOBE_STRENGTH] = MASU_BLOB_NONE;
}

/* The index of refraction also sets the reflectance, unless `specular` is given or a sheen fixes
 * it. */
static void set_ior(masu_blob_material *to, float ior, bool own_specular) {
    float root = (ior - 1) / (ior + 1);
    to->ior = ior;
    bool shines = to->sheen_color[0] > 0 || to->sheen_color[1] > 0 || to->sheen_color[2] > 0;
    if (!own_specular && !shines) to->specular = root * root / 0.08f;
}

/* The base colour becomes the emission of a black material of roughness 1, which shaders do not
 * light. */
static void make_unlit(masu_blob_material *to, masu_bake_maps *maps, bool own[MASU_BAKE_MAPS]) {
    const float *base = to->base_color;
    /* already unlit */
    if (maps->unlit && base[0] == 0.0f && base[1] == 0.0f && base[2] == 0.0f) return;
    memcpy(to->emissive, to->base_color, sizeof to->emissive);
    maps->image[MASU_BAKE_EMISSIVE] = maps->image[MASU_BAKE_BASE];
    maps->channel[MASU_BAKE_EMISSIVE] = maps->channel[MASU_BAKE_BASE];
    own[MASU_BAKE_EMISSIVE] = own[MASU_BAKE_BASE];
    for (int k = 0; k < 3; k++)
        to->base_color[k] = to->specular_color[k] = to->sheen_color[k] = 0;
    to->metallic = to->coat = 0;
    to->specular = 0.5f; /* the default needs no image */
    to->sheen_roughness = to->anisotropy = to->anisotropy_rotation = 0;
    to->roughness = 1;
    to->meso = MASU_BLOB_NONE;
    for (int i = 0; i < MASU_BAKE_MAPS; i++) {
        if (i != MASU_BAKE_BASE && i != MASU_BAKE_EMISSIVE && i != MASU_BAKE_OPACITY)
            maps->image[i] = MASU_BLOB_NONE;
    }
    maps->dark = 0;
    maps->unlit = 1;
}

static void apply_override(const masu_bake_override *o, masu_blob_material *to,
                           masu_bake_maps *maps, bool own[MASU_BAKE_MAPS]) {
    const masu_blob_material *v = &o->value;
    if (o->base_color) memcpy(to->base_color, v->base_color, sizeof v->base_color);
    if (o->roughness) to->roughness = v->roughness;
    if (o->metallic) to->metallic = v->metallic;
    if (o->specular) to->specular = v->specular;
    if (o->coat) to->coat = v->coat;
    if (o->coat_roughness) to->coat_roughness = v->coat_roughness;
    if (o->meso) to->meso = v->meso;
    if (o->detail) memcpy(to->detail, v->detail, sizeof v->detail);
    if (o->opacity) to->opacity = v->opacity;
    if (o->thickness) to->thickness = v->thickness;
    if (o->ior) set_ior(to, v->ior, o->specular);
    if (to->thickness > 0 && !(to->ior >= 1)) to->ior = v->ior; /* the default */
    if (!(to->thickness > 0)) to->ior = 0;
    if (o->emissive) {
        memcpy(to->emissive, v->emissive, sizeof v->emissive);
        maps->dark = 0;
    }
    for (int i = 0; i < MASU_BAKE_MAPS; i++) {
        if (!o->map[i]) continue;
        maps->image[i] = o->maps.image[i];
        maps->channel[i] = o->maps.channel[i];
        own[i] = true;
    }
    if (o->map[MASU_BAKE_ROUGHNESS]) maps->gloss = 0;
    if (o->map[MASU_BAKE_OCCLUSION]) maps->occlusion = 1;
    if (o->map[MASU_BAKE_NORMAL] && maps->relief) { /* the strength belonged to another image */
        maps->relief = 0;
        maps->normal_scale = 1;
    }
    if (o->alpha) {
        maps->alpha = o->maps.alpha;
        maps->additive = o->maps.additive;
        maps->tinted = o->maps.tinted;
    } else if (o->opacity && v->opacity < 1.0f) {
        maps->alpha = MASU_BAKE_ALPHA_BLEND;
    }
    if (o->cutoff) maps->cutoff = o->maps.cutoff;
    if (o->single) maps->single = o->maps.single;
    if (o->shadowless) maps->shadowless = 1;
    if (o->relief_of) maps->relief_of = o->maps.relief_of;
    if (o->depth_bias) to->depth_bias = v->depth_bias;
    if (o->repeat) maps->wrap[0] = maps->wrap[1] = MASU_BAKE_WRAP_REPEAT;
    if (o->unlit) make_unlit(to, maps, own);
    drop_lobes(o, to, maps);
}

/* If colour and emission repeat with the detail, the texture coordinates are scaled instead: rays
 * and lights then use the same, and drawing needs no scale. Returns the scale, 1 for none. */
static void scale_all(masu_blob_material *to, masu_bake_maps *maps, float scale[2]) {
    for (int k = 0; k < 2; k++) {
        scale[k] = to->detail[k];
        to->detail[k] = 1;
        /* clamped: would appear only once */
        if (scale[k] > 1 && maps->wrap[k] == 1) maps->wrap[k] = 0;
    }
}

static bool color_repeats(const masu_bake_content *piece, uint32_t index,
                          const masu_bake_overrides *overrides) {
    bool repeats = false;
    for (size_t i = 0; i < overrides->count; i++) {
        const masu_bake_override *o = &overrides->items[i];
        if (o->detail_color && matches(piece, index, o)) repeats = o->color_repeats;
    }
    return repeats;
}

static bool any_color_repeats(const masu_bake_content *piece,
                              const masu_bake_overrides *overrides) {
    for (uint32_t i = 0; i < masu_bake_count(piece, MASU_BLOB_MATERIALS); i++) {
        if (color_repeats(piece, i, overrides)) return true;
    }
    return false;
}

static uint32_t placed_material(masu_bake_content *scene, const masu_bake_content *piece,
                                uint32_t index, const masu_bake_overrides *overrides,
                                float scale[2]) {
    masu_blob_material material = MASU_BAKE_MATERIALS(piece)[index];
    const char *name = masu_bake_name_text(piece, material.name);
    masu_bake_maps maps = MASU_BAKE_MAPS_OF(piece)[index];
    bool own[MASU_BAKE_MAPS] = {false}; /* the image is the scene's, not the piece's */
    for (size_t i = 0; i < overrides->count; i++) {
        if (!matches(piece, index, &overrides->items[i])) continue;
        apply_override(&overrides->items[i], &material, &maps, own);
        if (*overrides->items[i].name) name = overrides->items[i].name;
    }
    scale[0] = scale[1] = 1;
    if (color_repeats(piece, index, overrides)) scale_all(&material, &maps, scale);
    for (int i = 0; i < MASU_BAKE_MAPS; i++) {
        if (own[i] || maps.image[i] == MASU_BLOB_NONE) continue;
        const masu_bake_image *from = &MASU_BAKE_IMAGES(piece)[maps.image[i]];
        maps.image[i] =
            masu_bake_add_image(scene, (const char *)piece->image_text.data + from->name, from,
                                from->data_bytes ? piece->image_data.data + from->data : NULL);
    }
    return masu_bake_mapped_material(scene, &material, &maps, name);
}

/* ---- names, meshes, instances ---- */

static uint32_t copied_name(masu_bake_content *scene, const masu_bake_content *piece, uint32_t name,
                            const char *prefix) {
    const char *own = masu_bake_name_text(piece, name);
    if (!prefix || !*prefix) return masu_bake_name(scene, own, strlen(own));
    masu_bake_buffer text = {0};
    masu_bake_append_text(&text, prefix);
    if (*own) {
        masu_bake_append_text(&text, "/");
        masu_bake_append_text(&text, own);
    }
    uint32_t offset = masu_bake_name(scene, (const char *)text.data, text.bytes);
    masu_bake_release(&text);
    return offset;
}

/* Scales the coordinates of a copied primitive. `by`: for each vertex of the piece, the material
 * that has scaled it, from 1. Returns NULL or the error. */
static const char *scale_coordinates(masu_bake_content *scene, const masu_blob_primitive *p,
                                     uint32_t first_vertex, uint32_t material, const float scale[2],
                                     uint32_t *by) {
    static const uint32_t kinds[2] = {MASU_BLOB_TEXCOORDS, MASU_BLOB_TEXCOORDS_1};
    for (uint32_t v = p->first_vertex; v < p->first_vertex + p->vertex_count; v++) {
        if (by[v] && by[v] != material + 1)
            return "vertices of two materials, which \"detail_color\" cannot scale";
        for (int set = 0; set < 2 && !by[v]; set++) {
            size_t vertex = (size_t)first_vertex + v;
            if (vertex >= masu_bake_count(scene, kinds[set])) continue;
            float *at = MASU_BAKE_ARRAY(scene, kinds[set], float) + 2 * vertex;
            for (int k = 0; k < 2; k++) {
                at[k] *= scale[k];
                if (!(fabsf(at[k]) <= MASU_TEXCOORD_MAX))
                    return "texture coordinates beyond 32768, by \"detail_color\"";
            }
        }
        by[v] = material + 1;
    }
    return NULL;
}

/* Copies primitives and meshes of the piece, with its materials as overridden. */
static const char *place_meshes(masu_bake_content *scene, const masu_bake_content *piece,
                                uint32_t first_vertex, uint32_t first_index,
                                const masu_bake_overrides *overrides, bool scaled) {
    const char *problem = NULL;
    uint32_t first_primitive = (uint32_t)masu_bake_count(scene, MASU_BLOB_PRIMITIVES);
    uint64_t materials = masu_bake_count(piece, MASU_BLOB_MATERIALS);
    uint32_t *material_map = masu_bake_allocate((size_t)materials * sizeof *material_map);
    float(*scale)[2] = masu_bake_allocate((size_t)materials * sizeof *scale);
    size_t vertices = (size_t)masu_bake_count(piece, MASU_BLOB_VERTICES) * sizeof(uint32_t);
    uint32_t *by = scaled ? masu_bake_allocate(vertices) : NULL;
    if (by) memset(by, 0, vertices);
    for (uint32_t i = 0; i < materials; i++) {
        material_map[i] = placed_material(scene, piece, i, overrides, scale[i]);
    }
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_PRIMITIVES); i++) {
        masu_blob_primitive p = MASU_BAKE_PRIMITIVES(piece)[i];
        if (by && !problem)
            problem = scale_coordinates(scene, &p, first_vertex, p.material, scale[p.material], by);
        p.first_index += first_index;
        p.first_vertex += first_vertex;
        p.material = material_map[p.material];
        masu_bake_append(&scene->section[MASU_BLOB_PRIMITIVES], &p, sizeof p);
    }
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_MESHES); i++) {
        masu_blob_mesh m = MASU_BAKE_MESHES(piece)[i];
        m.first_primitive += first_primitive;
        m.name = copied_name(scene, piece, m.name, NULL);
        masu_bake_append(&scene->section[MASU_BLOB_MESHES], &m, sizeof m);
    }
    free(material_map);
    free(scale);
    free(by);
    return problem;
}

/* Checks the runtime's largest counts for the scene plus the piece. */
static const char *room_for(const masu_bake_content *scene, const masu_bake_content *piece) {
    static const struct {
        uint32_t kind;
        const char *problem;
    } rows[] = {
        {MASU_BLOB_VERTICES, "more than 2^31 - 1 vertices"},
        {MASU_BLOB_INDICES, "more than 2^31 - 1 indices"},
        {MASU_BLOB_PRIMITIVES, "more than 2^31 - 1 primitives"},
        {MASU_BLOB_MESHES, "more than 2^31 - 1 meshes"},
        {MASU_BLOB_INSTANCES, "more than 2^31 - 1 instances"},
        {MASU_BLOB_MATERIALS, "more than 2^31 - 1 materials"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        uint64_t sum = masu_bake_count(scene, rows[i].kind) + masu_bake_count(piece, rows[i].kind);
        if (sum > INT32_MAX) return rows[i].problem;
    }
    return NULL;
}

static uint32_t copy_section(masu_bake_content *scene, const masu_bake_content *piece,
                             uint32_t kind) {
    uint32_t first = (uint32_t)masu_bake_count(scene, kind);
    masu_bake_append(&scene->section[kind], piece->section[kind].data, piece->section[kind].bytes);
    return first;
}

const char *masu_bake_place(masu_bake_content *scene, const masu_bake_content *piece,
                            masu_bake_residence *residence, const masu_bake_affine *placement,
                            const masu_bake_overrides *overrides, const char *prefix) {
    const char *problem = room_for(scene, piece);
    if (problem) return problem;
    bool scaled = !residence->has_meshes && any_color_repeats(piece, overrides);
    if (!residence->has_vertices || scaled) {
        residence->first_vertex = copy_section(scene, piece, MASU_BLOB_VERTICES);
        copy_section(scene, piece, MASU_BLOB_TEXCOORDS);
        masu_bake_copy_attributes(scene, piece, 0, masu_bake_count(piece, MASU_BLOB_VERTICES));
        residence->has_vertices = true;
        residence->scaled = scaled;
    }
    uint32_t first_mesh = residence->first_mesh;
    if (!residence->has_meshes) {
        /* Two primitives cannot share indices (src/scene/scene.c): other materials need other
         * indices. */
        uint32_t first_index = copy_section(scene, piece, MASU_BLOB_INDICES);
        first_mesh = (uint32_t)masu_bake_count(scene, MASU_BLOB_MESHES);
        problem =
            place_meshes(scene, piece, residence->first_vertex, first_index, overrides, scaled);
        if (problem) return problem;
        residence->first_mesh = first_mesh;
        residence->has_meshes = true;
    }
    uint32_t first_instance = (uint32_t)masu_bake_count(scene, MASU_BLOB_INSTANCES);
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *from = &MASU_BAKE_INSTANCES(piece)[i];
        masu_bake_affine own = masu_bake_transform(from);
        masu_bake_affine world = masu_bake_multiply(placement, &own);
        uint32_t parent = from->parent;
        if (parent != MASU_BLOB_NONE) parent += first_instance;
        uint32_t name = copied_name(scene, piece, from->name, prefix);
        if (masu_bake_instance(scene, &world, first_mesh + from->mesh, parent, name) ==
            MASU_BLOB_NONE) {
            return "a transform that is not finite or moves beyond 1e15";
        }
    }
    return NULL;
}

/* ---- lights ---- */

double masu_bake_light_range(masu_bake_vec3 color) {
    double most = fmax(color.x, fmax(color.y, color.z));
    return fmin(fmax(10.0 * sqrt(fmax(most, 0.0)), 1e-3), 1e9);
}

/* From the radiant intensity / pi of an area light along its normal, or of a capsule from the side.
 * Six times the range of a point light, because highlights are visible from farther away. At least
 * 8 times its size. */
double masu_bake_area_range(const masu_blob_light *light) {
    uint32_t type = light->type & MASU_LIGHT_TYPE;
    double r = (double)light->radius, area = 0, size = 0;
    masu_bake_vec3 u = masu_bake_v3f(light->direction), v = masu_bake_v3f(light->half_axis);
    if (type <= MASU_LIGHT_SPOT) return masu_bake_light_range(masu_bake_v3f(light->color));
    double length = sqrt(masu_bake_dot(u, u));
    masu_bake_vec3 side = masu_bake_cross(u, v);
    if (type == MASU_LIGHT_RECTANGLE) {
        area = 4 * sqrt(masu_bake_dot(side, side));
        size = sqrt(masu_bake_dot(u, u) + masu_bake_dot(v, v));
    } else {
        area = MASU_BAKE_PI * r * r;
        size = r;
    }
    if (type == MASU_LIGHT_CAPSULE) area += 4 * r * length, size += length;
    masu_bake_vec3 color = masu_bake_v3f(light->color), zero = {0, 0, 0};
    return fmax(6 * masu_bake_light_range(masu_bake_mad(zero, color, area / MASU_BAKE_PI)),
                8 * size);
}

/* Transforms a light to another space. False: its values are out of range. */
static bool move(masu_blob_light *light, const masu_bake_affine *to) {
    masu_bake_vec3 origin = {0, 0, 0}, zero = masu_bake_apply(to, origin);
    masu_bake_vec3 position = masu_bake_apply(to, masu_bake_v3f(light->position));
    masu_bake_vec3 direction =
        masu_bake_sub(masu_bake_apply(to, masu_bake_v3f(light->direction)), zero);
    if (!masu_bake_sane(position)) return false;
    uint32_t type = light->type & MASU_LIGHT_TYPE;
    masu_bake_store(position, light->position);
    if (type == MASU_LIGHT_POINT || type == MASU_LIGHT_SPHERE) return true;
    if (type == MASU_LIGHT_SPOT && !masu_bake_normalize(&direction)) return false;
    masu_bake_store(direction, light->direction);
    direction = masu_bake_sub(masu_bake_apply(to, masu_bake_v3f(light->half_axis)), zero);
    masu_bake_store(direction, light->half_axis);
    return true;
}

void masu_bake_detach_lights(masu_bake_content *piece) {
    masu_blob_light *lights = MASU_BAKE_LIGHTS(piece);
    uint64_t count = masu_bake_count(piece, MASU_BLOB_LIGHTS), kept = 0;
    for (uint64_t i = 0; i < count; i++) {
        masu_blob_light light = lights[i];
        masu_bake_affine to = masu_bake_identity();
        if (light.parent != MASU_BLOB_NONE)
            to = masu_bake_transform(&MASU_BAKE_INSTANCES(piece)[light.parent]);
        light.parent = MASU_BLOB_NONE;
        if (move(&light, &to)) lights[kept++] = light;
    }
    piece->section[MASU_BLOB_LIGHTS].bytes = (size_t)kept * sizeof *lights;
}

const char *masu_bake_place_lights(masu_bake_content *scene, const masu_bake_content *piece,
                                   const masu_bake_affine *placement, uint32_t first_instance,
                                   double factor, const char *prefix) {
    for (uint64_t i = 0; i < masu_bake_count(piece, MASU_BLOB_LIGHTS) && factor > 0; i++) {
        masu_blob_light light = MASU_BAKE_LIGHTS(piece)[i];
        light.name = copied_name(scene, piece, light.name, prefix);
        double color[3];
        for (int k = 0; k < 3; k++)
            color[k] = fmin((double)light.color[k] * factor, MASU_BAKE_LIGHT_COLOR_MAX);
        masu_bake_store(masu_bake_v3(color[0], color[1], color[2]), light.color);
        if (light.range == 0.0f)
            light.range = (float)masu_bake_light_range(masu_bake_v3f(light.color));
        if (light.parent != MASU_BLOB_NONE) {
            light.parent += first_instance;
        } else if (!move(&light, placement)) {
            return "a light beyond 1e15, or that shines nowhere";
        }
        masu_bake_append(&scene->section[MASU_BLOB_LIGHTS], &light, sizeof light);
    }
    return NULL;
}

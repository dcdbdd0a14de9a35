/* place.c: the "models" of a scene. A file is imported once however often it is placed; each
 * placement is   translate * fit * rotate * scale   of the model as its file has it. */
#include "bake/mesh/detail.h"
#include "bake/scene/file.h"
#include "bake/scene/groups.h"
#include "bake/scene/import.h"
#include "bake/texture/material.h"
#include "bake/mesh/occluders.h"
#include "bake/scene/scene.h"
#include "bake/scene/shape.h"
#include "cli/cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What a piece looks like in the scene with one set of overridden values: placed again with the
 * same values, it is the same meshes. */
typedef struct guise {
    masu_bake_overrides overrides;
    masu_bake_residence residence;
} guise;

/* Imported files, by resolved path and by how they are merged, and procedural meshes, by their
 * description. */
typedef struct shelf {
    struct shelf *next;
    char *path;                  /* NULL: procedural */
    const json_t *shape;         /* borrowed from the scene */
    double merge;                /* metres, 0: as the file has it */
    masu_bake_textures textures; /* as imported; of a shape FORCED: it has coordinates */
    masu_bake_content piece;
    masu_bake_residence residence; /* of the vertices: the first guise's */
    masu_bake_buffer guises;
} shelf;

static shelf *add_shelf(shelf **shelves, shelf made) {
    shelf *s = masu_bake_allocate(sizeof *s);
    *s = made;
    s->next = *shelves;
    return *shelves = s;
}

static void release_shelves(shelf *s) {
    while (s) {
        shelf *next = s->next;
        guise *guises = (guise *)(void *)s->guises.data;
        for (size_t i = 0; i < s->guises.bytes / sizeof *guises; i++)
            masu_bake_overrides_release(&guises[i].overrides);
        masu_bake_content_release(&s->piece);
        masu_bake_release(&s->guises);
        free(s->path);
        free(s);
        s = next;
    }
}

static shelf *fetch(const masu_bake_json *model, shelf **shelves, char *path, double merge,
                    masu_bake_textures textures) {
    for (shelf *s = *shelves; s; s = s->next) {
        if (s->path && strcmp(s->path, path) == 0 && s->merge == merge && s->textures == textures) {
            free(path);
            return s;
        }
    }
    shelf *s = add_shelf(shelves, (shelf){.path = path, .merge = merge, .textures = textures});
    masu_cli_progress("importing %s", path);
    if (!masu_bake_import(path, textures, &s->piece)) return NULL;
    const char *problem = merge > 0 ? masu_bake_merge(&s->piece, merge) : NULL;
    return !problem || masu_bake_json_wrong(model, "gives %s", problem) ? s : NULL;
}

/* ---- procedural meshes ---- */

/* `mapped`: with texture coordinates, since the material has textures. */
static bool read_sphere(const masu_bake_json *at, bool mapped, masu_bake_content *piece) {
    static const char *const members[] = {"radius", "subdivisions", "tile", NULL};
    double radius = 1, subdivisions = 5, tile = 1;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "radius", 1e-6, 1e6, &radius) ||
        !masu_bake_json_number(at, "tile", 1e-3, 1e3, &tile) ||
        !masu_bake_json_number(at, "subdivisions", 0, MASU_BAKE_SUBDIVISIONS_MAX, &subdivisions)) {
        return false;
    }
    if (subdivisions != floor(subdivisions)) {
        return masu_bake_json_wrong(at, "subdivisions must be a whole number");
    }
    masu_bake_sphere(piece, radius, (uint32_t)subdivisions, mapped ? tile : 0);
    return true;
}

static bool read_box(const masu_bake_json *at, bool mapped, masu_bake_content *piece) {
    static const char *const members[] = {"size", "tile", NULL};
    masu_bake_vec3 size = {1, 1, 1};
    double tile = 1;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "tile", 1e-3, 1e3, &tile) ||
        !masu_bake_json_vec3(at, "size", 1e-6, 1e6, &size)) {
        return false;
    }
    masu_bake_cuboid(piece, size, mapped ? tile : 0);
    return true;
}

static bool read_plane(const masu_bake_json *at, bool mapped, masu_bake_content *piece) {
    static const char *const members[] = {"size_x", "size_z", "tile", NULL};
    double x = 1, z = 1, tile = 1;
    if (!masu_bake_json_object(at, members) ||
        !masu_bake_json_number(at, "size_x", 1e-6, 1e6, &x) ||
        !masu_bake_json_number(at, "tile", 1e-3, 1e3, &tile) ||
        !masu_bake_json_number(at, "size_z", 1e-6, 1e6, &z)) {
        return false;
    }
    masu_bake_plane(piece, x, z, mapped ? tile : 0);
    return true;
}

static bool read_shape(const masu_bake_json *mesh, bool mapped, masu_bake_content *piece) {
    static const char *const members[] = {"sphere", "box", "plane", NULL};
    if (!masu_bake_json_object(mesh, members)) return false;
    if (json_object_size(mesh->value) != 1) {
        return masu_bake_json_wrong(mesh, "needs one of \"sphere\", \"box\", \"plane\"");
    }
    masu_bake_json sphere = masu_bake_json_member(mesh, "sphere");
    masu_bake_json box = masu_bake_json_member(mesh, "box");
    masu_bake_json plane = masu_bake_json_member(mesh, "plane");
    if (sphere.value) return read_sphere(&sphere, mapped, piece);
    return box.value ? read_box(&box, mapped, piece) : read_plane(&plane, mapped, piece);
}

/* ---- placement ---- */

static bool read_scale(const masu_bake_json *model, masu_bake_affine *out) {
    masu_bake_json at = masu_bake_json_member(model, "scale");
    masu_bake_vec3 scale = {1, 1, 1};
    if (json_is_number(at.value)) {
        if (!masu_bake_json_number(model, "scale", -1e9, 1e9, &scale.x)) return false;
        scale.y = scale.z = scale.x;
    } else if (!masu_bake_json_vec3(model, "scale", -1e9, 1e9, &scale)) {
        return false;
    }
    if (scale.x == 0 || scale.y == 0 || scale.z == 0) {
        return masu_bake_json_wrong(&at, "must not be zero");
    }
    *out = masu_bake_scaling(scale);
    return true;
}

static bool read_rotation(const masu_bake_json *model, masu_bake_affine *out) {
    masu_bake_vec3 angles = {0, 0, 0};
    if (masu_bake_json_has(model, "rotate") && masu_bake_json_has(model, "rotate_y")) {
        return masu_bake_json_wrong(model, "give either \"rotate\" or \"rotate_y\"");
    }
    if (!masu_bake_json_vec3(model, "rotate", -3600, 3600, &angles) ||
        !masu_bake_json_number(model, "rotate_y", -3600, 3600, &angles.y)) {
        return false;
    }
    masu_bake_affine x = masu_bake_rotation(0, angles.x), y = masu_bake_rotation(1, angles.y);
    masu_bake_affine z = masu_bake_rotation(2, angles.z), yx = masu_bake_multiply(&y, &x);
    *out = masu_bake_multiply(&z, &yx);
    return true;
}

/* Scales the longest side of the box of what is shown to "size", and moves the box by its centre
 * or the middle of its lower face. */
static bool read_fit(const masu_bake_json *fit, const masu_bake_content *piece,
                     masu_bake_affine *placement) {
    static const char *const members[] = {"size", "center", "base", NULL};
    double size = 0;
    masu_bake_vec3 at = {0, 0, 0};
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!masu_bake_json_object(fit, members) ||
        !masu_bake_json_number(fit, "size", 1e-6, 1e9, &size) ||
        !masu_bake_json_vec3(fit, "center", -most, most, &at) ||
        !masu_bake_json_vec3(fit, "base", -most, most, &at)) {
        return false;
    }
    bool center = masu_bake_json_has(fit, "center"), base = masu_bake_json_has(fit, "base");
    if (center && base) return masu_bake_json_wrong(fit, "give either \"center\" or \"base\"");
    masu_bake_box box = masu_bake_bounds(piece, placement);
    masu_bake_vec3 extent = masu_bake_sub(box.high, box.low);
    double longest = fmax(extent.x, fmax(extent.y, extent.z));
    double factor = 1;
    if (masu_bake_json_has(fit, "size")) {
        factor = size / longest;
        if (!(longest > 0) || !(factor <= MASU_BAKE_COORDINATE_MAX)) {
            return masu_bake_json_wrong(fit, "the model has no extent to scale");
        }
    }
    masu_bake_affine scale = masu_bake_scaling(masu_bake_v3(factor, factor, factor));
    *placement = masu_bake_multiply(&scale, placement);
    if (center || base) {
        masu_bake_vec3 from = masu_bake_mad(box.low, extent, 0.5);
        if (base) from.y = box.low.y;
        masu_bake_affine move = masu_bake_translation(masu_bake_mad(at, from, -factor));
        *placement = masu_bake_multiply(&move, placement);
    }
    return true;
}

static bool read_placement(const masu_bake_json *model, const masu_bake_content *piece,
                           masu_bake_affine *out) {
    masu_bake_affine scale, rotation;
    masu_bake_vec3 translation = {0, 0, 0};
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!read_scale(model, &scale) || !read_rotation(model, &rotation) ||
        !masu_bake_json_vec3(model, "translate", -most, most, &translation)) {
        return false;
    }
    *out = masu_bake_multiply(&rotation, &scale);
    masu_bake_json fit = masu_bake_json_member(model, "fit");
    if (fit.value && !read_fit(&fit, piece, out)) return false;
    masu_bake_affine move = masu_bake_translation(translation);
    *out = masu_bake_multiply(&move, out);
    return true;
}

/* Tags the instances from `first` on. */
static bool read_group(const masu_bake_json *model, masu_bake_content *content, uint64_t first) {
    const char *path = NULL;
    bool moving = false;
    if (!masu_bake_json_string(model, "group", &path) ||
        !masu_bake_json_boolean(model, "moving", &moving)) {
        return false;
    }
    if (moving && path) return masu_bake_json_wrong(model, "what is \"moving\" is in no \"group\"");
    uint32_t tag = moving ? MASU_BAKE_MOVING : MASU_BLOB_NONE;
    if (path && (tag = masu_bake_group(content, path)) == MASU_BLOB_NONE) {
        masu_bake_json at = masu_bake_json_member(model, "group");
        return masu_bake_json_wrong(&at, "must be 1 to %u names with / between them",
                                    MASU_BAKE_GROUP_LEVELS);
    }
    for (uint64_t i = first; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        MASU_BAKE_INSTANCES(content)[i].group = tag;
    }
    return true;
}

/* Two corners: a box in each mesh of the instances from `first` on; true: the mesh itself is one. */
static bool read_occluder(const masu_bake_json *model, masu_bake_content *content, uint64_t first) {
    masu_bake_json at = masu_bake_json_member(model, "occluder");
    masu_bake_box box = masu_bake_box_empty();
    const double most = MASU_BAKE_COORDINATE_MAX;
    if (!at.value || json_is_false(at.value)) return true;
    if (!json_is_true(at.value)) {
        if (!masu_bake_json_array(&at, 2)) return false;
        masu_bake_json low = masu_bake_json_element(&at, 0);
        masu_bake_json high = masu_bake_json_element(&at, 1);
        if (!masu_bake_json_vec3(&low, NULL, -most, most, &box.low) ||
            !masu_bake_json_vec3(&high, NULL, -most, most, &box.high)) {
            return false;
        }
        if (json_array_size(at.value) != 2 || !(box.low.x < box.high.x) ||
            !(box.low.y < box.high.y) || !(box.low.z < box.high.z)) {
            return masu_bake_json_wrong(&at, "expected true or two corners, the lower one first");
        }
    }
    uint32_t last = MASU_BLOB_NONE;
    for (uint64_t i = first; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        uint32_t mesh = MASU_BAKE_INSTANCES(content)[i].mesh;
        if (mesh == last) continue;
        last = mesh;
        if (json_is_true(at.value) && !masu_bake_is_box(content, mesh, &box)) {
            return masu_bake_json_wrong(&at, "the mesh \"%s\" is no box: give two corners",
                                        masu_bake_name_text(content,
                                                            MASU_BAKE_MESHES(content)[mesh].name));
        }
        (void)masu_bake_add_occluder(content, mesh, box); /* it may have it already */
    }
    return true;
}

/* The guise with these values, new if there is none: meshes are per guise, vertices shared. Takes the
 * values over. */
static guise *guise_of(shelf *s, masu_bake_overrides *overrides) {
    guise *guises = (guise *)(void *)s->guises.data;
    for (size_t i = 0; i < s->guises.bytes / sizeof *guises; i++) {
        if (!masu_bake_overrides_equal(&guises[i].overrides, overrides)) continue;
        masu_bake_overrides_release(overrides);
        return &guises[i];
    }
    guise made = {.overrides = *overrides, .residence = s->residence};
    made.residence.has_meshes = false;
    return masu_bake_append(&s->guises, &made, sizeof made);
}

static bool place(const masu_bake_json *model, const char *directory,
                  const masu_bake_request *request, shelf *s, masu_bake_content *content) {
    masu_bake_affine placement;
    masu_bake_overrides overrides;
    const char *name = NULL;
    double lights = 1;
    if (!read_placement(model, &s->piece, &placement) ||
        !masu_bake_json_string(model, "name", &name) ||
        !masu_bake_json_number(model, "lights", 0, 1e9, &lights) ||
        !masu_bake_read_overrides(model, directory, request, content, &overrides)) {
        return false;
    }
    uint64_t first = masu_bake_count(content, MASU_BLOB_INSTANCES);
    guise *g = guise_of(s, &overrides);
    const char *problem =
        masu_bake_place(content, &s->piece, &g->residence, &placement, &g->overrides, name);
    if (!problem) {
        problem =
            masu_bake_place_lights(content, &s->piece, &placement, (uint32_t)first, lights, name);
    }
    if (problem) return masu_bake_json_wrong(model, "gives %s", problem);
    s->residence = g->residence;
    return read_group(model, content, first) && read_occluder(model, content, first) &&
           masu_bake_read_traced(model, content, first);
}

static bool read_model(const masu_bake_json *model, const char *directory,
                       const masu_bake_request *request, shelf **shelves,
                       masu_bake_content *content) {
    static const char *const members[] = {"file",   "mesh",     "name",  "group", "moving",
                                          "translate", "rotate",   "rotate_y", "scale", "fit",
                                          "material",  "materials", "occluder", "merge",
                                          "lights",    "traced",   NULL};
    const char *file = NULL;
    double merge = 0;
    if (!masu_bake_json_object(model, members) || !masu_bake_json_string(model, "file", &file) ||
        !masu_bake_json_number(model, "merge", 1e-3, 1e9, &merge)) {
        return false;
    }
    masu_bake_json mesh = masu_bake_json_member(model, "mesh");
    if (merge > 0 && masu_bake_json_has(model, "occluder")) {
        return masu_bake_json_wrong(model, "what is \"merge\"d has no \"occluder\"");
    }
    if (!file == !mesh.value) {
        return masu_bake_json_wrong(model, "needs either \"file\" or \"mesh\"");
    }
    if (file) {
        masu_bake_textures textures = request->textures;
        if (textures == MASU_BAKE_TEXTURES_WANTED && masu_bake_overrides_map(model)) {
            textures = MASU_BAKE_TEXTURES_FORCED;
        }
        shelf *s = fetch(model, shelves, masu_bake_resolve(file, directory, request->models_directory), merge,
                         textures);
        return s && place(model, directory, request, s, content);
    }
    if (merge > 0) return masu_bake_json_wrong(model, "\"merge\" is for files");
    bool mapped = masu_bake_overrides_map(model) && request->textures != MASU_BAKE_TEXTURES_OFF;
    masu_bake_textures textures = mapped ? MASU_BAKE_TEXTURES_FORCED : MASU_BAKE_TEXTURES_OFF;
    for (shelf *s = *shelves; s; s = s->next) {
        if (s->shape && s->textures == textures && json_equal(s->shape, mesh.value))
            return place(model, directory, request, s, content);
    }
    shelf *s = add_shelf(shelves, (shelf){.shape = mesh.value, .textures = textures});
    return read_shape(&mesh, mapped, &s->piece) && place(model, directory, request, s, content);
}

bool masu_bake_read_models(const masu_bake_json *scene, const char *directory,
                           const masu_bake_request *request, masu_bake_content *content) {
    masu_bake_json models = masu_bake_json_member(scene, "models");
    if (!models.value) return true;
    if (!masu_bake_json_array(&models, 0)) return false;
    shelf *shelves = NULL;
    bool good = true;
    for (size_t i = 0; good && i < json_array_size(models.value); i++) {
        masu_bake_json model = masu_bake_json_element(&models, i);
        good = read_model(&model, directory, request, &shelves, content);
    }
    release_shelves(shelves);
    return good;
}

bool masu_bake_bare_model(const masu_bake_request *request, masu_bake_content *content) {
    masu_bake_content piece = {0};
    masu_bake_residence residence = {0};
    masu_bake_affine identity = masu_bake_identity();
    masu_bake_overrides none = {0};
    masu_cli_progress("importing %s", request->input);
    bool good = masu_bake_import(request->input, request->textures, &piece);
    if (good) {
        const char *problem = masu_bake_place(content, &piece, &residence, &identity, &none, NULL);
        if (!problem) problem = masu_bake_place_lights(content, &piece, &identity, 0, 1, NULL);
        if (problem) masu_cli_error("%s: gives %s", request->input, problem);
        good = !problem;
    }
    if (good) {
        masu_bake_box bounds = masu_bake_bounds(content, &identity);
        masu_bake_default_look(&bounds, content);
    }
    masu_bake_content_release(&piece);
    return good;
}

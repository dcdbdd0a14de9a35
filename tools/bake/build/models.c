/* models.c: imports or makes the models of a description, and places them; see build.h. A file is
 * imported once for all placements. Fails if a model cannot be read, has no extent to fit, exceeds
 * the coordinate limit, or is not a box although the scene declares one. */
#include "bake/base/file.h"
#include "bake/build/parts.h"
#include "bake/light/emitters.h"
#include "bake/mesh/detail.h"
#include "bake/mesh/drop.h"
#include "bake/mesh/occluders.h"
#include "bake/scene/camera.h"
#include "bake/scene/sun.h"
#include "bake/scene/groups.h"
#include "bake/scene/live.h"
#include "bake/scene/skin.h"
#include "cli/cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- imported and procedural models ---- */

/* A piece in the scene with one set of overridden values: another placement with the same values
 * uses the same meshes. */
typedef struct variant {
    struct variant *next;
    masu_bake_overrides overrides;
    masu_bake_residence residence;
} variant;

/* Imported files, by path and merge size, and procedural meshes. */
typedef struct loaded_model {
    struct loaded_model *next;
    const char *path;            /* NULL: procedural */
    uint32_t shape;              /* index into the description's shapes */
    double merge;                /* metres, 0: as in the file */
    bool moving;                 /* with its clips and skins */
    bool plays;                  /* the same if it has clips */
    const char *variant;         /* of its materials, or NULL */
    masu_bake_textures textures; /* as imported; of a shape FORCED: it has coordinates */
    masu_bake_content piece;
    masu_bake_residence residence; /* for the vertices: the first variant's */
    variant *variants;
} loaded_model;

typedef struct model_builder {
    const masu_bake_description *description;
    masu_bake_content *content; /* the scene */
    masu_bake_textures textures;
    loaded_model *loaded;
    masu_bake_pool pool; /* for loaded models, variants, overrides */
} model_builder;

static loaded_model *find_loaded(const model_builder *b, const loaded_model *wanted) {
    for (loaded_model *at = b->loaded; at; at = at->next) {
        bool same = wanted->path ? at->path && strcmp(at->path, wanted->path) == 0
                                 : !at->path && at->shape == wanted->shape;
        if (same && at->merge == wanted->merge && at->moving == wanted->moving &&
            at->plays == wanted->plays && at->textures == wanted->textures &&
            strcmp(at->variant ? at->variant : "", wanted->variant ? wanted->variant : "") == 0)
            return at;
    }
    return NULL;
}

static void release_loaded(model_builder *b) {
    for (loaded_model *at = b->loaded; at; at = at->next) masu_bake_content_release(&at->piece);
    masu_bake_pool_release(&b->pool);
}

/* Fills the piece of a new loaded model. */
static bool make_piece(const model_builder *b, const masu_bake_model *model, loaded_model *made) {
    if (!made->path) {
        bool mapped = made->textures == MASU_BAKE_TEXTURES_FORCED;
        masu_bake_make_shape(&b->description->shapes[made->shape], mapped, &made->piece);
        return true;
    }
    masu_cli_progress("importing %s", made->path);
    masu_bake_wanted wanted = {made->textures, made->moving, made->plays, made->variant};
    if (!masu_bake_import_as(made->path, &wanted, &made->piece)) return false;
    const char *problem = made->merge > 0 ? masu_bake_merge(&made->piece, made->merge) : NULL;
    return !problem || masu_bake_wrong(b->description, model->where, "gives %s", problem);
}

/* True if the scene gives it textures: it then needs texture coordinates. */
static bool is_mapped(const masu_bake_model *model) {
    for (size_t i = 0; i < model->change_count; i++) {
        for (int map = 0; map < MASU_BAKE_MAPS; map++) {
            if (model->changes[i].value.map[map]) return true;
        }
    }
    return false;
}

static loaded_model *fetch(model_builder *b, const masu_bake_model *model) {
    loaded_model wanted = {.path = model->file,
                           .shape = model->shape,
                           .merge = model->merge,
                           /* A merged model has no nodes. */
                           .moving = model->file && model->moving && !(model->merge > 0),
                           .plays = model->file && model->plays,
                           .variant = model->variant,
                           .textures = model->file ? b->textures : MASU_BAKE_TEXTURES_OFF};
    if (b->textures != MASU_BAKE_TEXTURES_OFF && is_mapped(model))
        wanted.textures = MASU_BAKE_TEXTURES_FORCED;
    loaded_model *found = find_loaded(b, &wanted);
    if (found) return found;
    loaded_model *made = masu_bake_take(&b->pool, sizeof *made);
    *made = wanted;
    made->next = b->loaded;
    b->loaded = made;
    return make_piece(b, model, made) ? made : NULL;
}

/* ---- materials ---- */

static uint32_t element_of(masu_bake_content *content, const masu_blob_meso *m) {
    masu_bake_buffer *all = &content->section[MASU_BLOB_MESO];
    size_t count = all->bytes / sizeof *m;
    for (size_t i = 0; i < count; i++) {
        if (memcmp(all->data + i * sizeof *m, m, sizeof *m) == 0) return (uint32_t)i;
    }
    masu_bake_append(all, m, sizeof *m);
    return (uint32_t)count;
}

/* The overrides, with the scene's indices of their images and curves. */
static masu_bake_overrides settle(model_builder *b, const masu_bake_model *model) {
    masu_bake_overrides out = {masu_bake_take(&b->pool, model->change_count * sizeof *out.items),
                               model->change_count};
    for (size_t i = 0; i < out.count; i++) {
        const masu_bake_material_change *change = &model->changes[i];
        masu_bake_override *o = &out.items[i];
        *o = change->value;
        if (o->meso) o->value.meso = element_of(b->content, &change->meso);
        for (int map = 0; map < MASU_BAKE_MAPS; map++) {
            if (!o->map[map]) continue;
            o->map[map] = b->textures != MASU_BAKE_TEXTURES_OFF;
            if (o->map[map])
                o->maps.image[map] =
                    masu_bake_add_image(b->content, change->picture[map], NULL, NULL);
            else
                o->maps.channel[map] = 0;
        }
    }
    return out;
}

/* The variant with these values, created if missing: meshes are per variant, vertices are
 * shared. */
static variant *variant_of(model_builder *b, loaded_model *of,
                           const masu_bake_overrides *overrides) {
    for (variant *v = of->variants; v; v = v->next) {
        if (masu_bake_overrides_equal(&v->overrides, overrides)) return v;
    }
    variant *made = masu_bake_take(&b->pool, sizeof *made);
    *made = (variant){of->variants, *overrides, of->residence};
    made->residence.has_meshes = false;
    return of->variants = made;
}

/* ---- placement ---- */

/* Scales the longest side of the model's bounds, and moves the bounds by their centre or the centre
 * of their lower face. */
static bool fit(const model_builder *b, const masu_bake_model *model,
                const masu_bake_content *piece, masu_bake_affine *placement) {
    const masu_bake_fit *f = &model->fit;
    if (!f->wanted) return true;
    masu_bake_box box = masu_bake_bounds(piece, placement);
    masu_bake_vec3 extent = masu_bake_sub(box.high, box.low);
    double longest = fmax(extent.x, fmax(extent.y, extent.z));
    double factor = f->size > 0 ? f->size / longest : 1;
    if (f->size > 0 && (!(longest > 0) || !(factor <= MASU_BAKE_COORDINATE_MAX))) {
        char where[160];
        snprintf(where, sizeof where, "%s.fit", model->where);
        return masu_bake_wrong(b->description, where, "the model has no extent to scale");
    }
    masu_bake_affine scale = masu_bake_scaling(masu_bake_v3(factor, factor, factor));
    *placement = masu_bake_multiply(&scale, placement);
    if (f->center || f->base) {
        masu_bake_vec3 from = masu_bake_mad(box.low, extent, 0.5);
        if (f->base) from.y = box.low.y;
        masu_bake_affine move = masu_bake_translation(masu_bake_mad(f->at, from, -factor));
        *placement = masu_bake_multiply(&move, placement);
    }
    return true;
}

/* Places it once, with a separate name. */
static bool place(model_builder *b, const masu_bake_model *model, const char *name, bool hidden,
                  loaded_model *from, uint32_t *like) {
    masu_bake_content *content = b->content;
    uint64_t lights = masu_bake_count(content, MASU_BLOB_LIGHTS);
    masu_bake_affine placement = model->placement;
    if (!fit(b, model, &from->piece, &placement)) return false;
    masu_bake_affine move = masu_bake_translation(model->translation);
    placement = masu_bake_multiply(&move, &placement);
    masu_bake_vec3 translation = model->translation;
    if (model->drop) {
        double fall = masu_bake_drop(content, &from->piece, &placement, model->ground);
        move = masu_bake_translation(masu_bake_v3(0, -fall, 0));
        placement = masu_bake_multiply(&move, &placement);
        translation.y -= fall;
    }
    uint32_t first = (uint32_t)masu_bake_count(content, MASU_BLOB_INSTANCES);
    masu_bake_overrides overrides = settle(b, model);
    variant *v = variant_of(b, from, &overrides);
    const char *problem = masu_bake_place(content, &from->piece, &v->residence, &placement,
                                          &v->overrides, name);
    if (!problem)
        problem = masu_bake_place_lights(content, &from->piece, &placement, first, model->lights,
                                         name);
    if (problem) return masu_bake_wrong(b->description, model->where, "gives %s", problem);
    masu_bake_place_cameras(content, &from->piece, &placement, name);
    if (*like == MASU_BLOB_NONE && model->lights > 0) /* not for pooled copies */
        masu_bake_place_suns(content, &from->piece, &placement, model->lights);
    if (!v->residence.scaled) from->residence = v->residence;
    if (!model->moving || masu_bake_count(content, MASU_BLOB_INSTANCES) == first) return true;
    uint32_t made = masu_bake_add_model(content, &from->piece, first, &placement, translation, name,
                                        hidden, *like);
    if (*like == MASU_BLOB_NONE) *like = made;
    masu_bake_carry_lights(content, lights, first);
    return true;
}

/* The host only finds the first model of a name. */
static void warn_of_namesake(const model_builder *b, const masu_bake_model *model) {
    const masu_bake_content *c = b->content;
    for (uint64_t i = 0; model->moving && model->name && i < masu_bake_count(c, MASU_BLOB_MODELS);
         i++) {
        uint32_t name = MASU_BAKE_ARRAY(c, MASU_BLOB_MODELS, masu_blob_model)[i].name;
        if (strcmp(masu_bake_name_text(c, name), model->name) != 0) continue;
        masu_cli_warn("%s: %s: another moving model is named \"%s\": programs find the first "
                         "one",
                         b->description->file, model->where, model->name);
        return;
    }
}

static void warn_of_changes(const model_builder *b, const masu_bake_model *model,
                            const loaded_model *from) {
    for (size_t i = 0; i < model->change_count; i++) {
        const masu_bake_override *o = &model->changes[i].value;
        if (!*o->match || masu_bake_override_matches(&from->piece, o)) continue;
        masu_cli_warn("%s: %s: no material matches \"%s\"", b->description->file, model->where,
                      o->match);
    }
}

/* Places the model and its pooled copies: "car", "car.1", "car.2". */
static bool place_all(model_builder *b, const masu_bake_model *model, loaded_model *from) {
    uint32_t like = MASU_BLOB_NONE;
    warn_of_namesake(b, model);
    warn_of_changes(b, model, from);
    if (!place(b, model, model->name, model->hidden, from, &like)) return false;
    for (uint32_t i = 1; i <= model->spare; i++) {
        char number[16];
        masu_bake_buffer name = {0};
        snprintf(number, sizeof number, ".%u", i);
        masu_bake_append_text(&name, model->name ? model->name : "spare");
        masu_bake_append_text(&name, number);
        masu_bake_append(&name, "", 1);
        bool good = place(b, model, masu_bake_take_text(&b->pool, (const char *)name.data), true,
                          from, &like);
        masu_bake_release(&name);
        if (!good) return false;
    }
    return true;
}

/* ---- settings for the new instances, those from `first` on ---- */

static void set_group(masu_bake_content *content, const masu_bake_model *model, uint64_t first) {
    uint32_t tag = model->moving ? MASU_BAKE_MOVING : MASU_BLOB_NONE;
    if (model->group) tag = masu_bake_group(content, model->group);
    for (uint64_t i = first; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        MASU_BAKE_INSTANCES(content)[i].group = tag;
    }
}

/* A box in each mesh. */
static bool add_occluder(const model_builder *b, const masu_bake_model *model, uint64_t first) {
    masu_bake_content *content = b->content;
    masu_bake_box box = model->occluder;
    if (model->hides == MASU_BAKE_HIDES_NOTHING) return true;
    uint32_t last = MASU_BLOB_NONE;
    for (uint64_t i = first; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        uint32_t mesh = MASU_BAKE_INSTANCES(content)[i].mesh;
        if (mesh == last || masu_bake_is_skinned(content, mesh)) continue;
        last = mesh;
        if (model->hides == MASU_BAKE_HIDES_WHOLE && !masu_bake_is_box(content, mesh, &box)) {
            char where[160];
            snprintf(where, sizeof where, "%s.occluder", model->where);
            return masu_bake_wrong(
                b->description, where, "the mesh \"%s\" is not a box: give two corners",
                masu_bake_name_text(content, MASU_BAKE_MESHES(content)[mesh].name));
        }
        (void)masu_bake_add_occluder(content, mesh, box); /* the mesh may already have it */
    }
    return true;
}

bool masu_bake_build_models(const masu_bake_description *d, size_t start,
                            masu_bake_textures textures, masu_bake_content *content) {
    model_builder b = {.description = d, .content = content, .textures = textures};
    bool good = true;
    for (size_t i = start; good && i < d->model_count; i++) {
        masu_bake_model *model = &d->models[i];
        uint64_t first = masu_bake_count(content, MASU_BLOB_INSTANCES);
        loaded_model *from = fetch(&b, model);
        if (from && from->plays) model->moving = masu_bake_count(&from->piece, MASU_BLOB_CLIPS) > 0;
        good = from && place_all(&b, model, from);
        if (!good) break;
        set_group(content, model, first);
        good = add_occluder(&b, model, first);
        masu_bake_mark_traced(content, first, model->traced);
        masu_bake_fit_emitters(content, first, model->area_light, model->where);
    }
    release_loaded(&b);
    return good;
}

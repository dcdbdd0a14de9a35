/* gltf_material.c: materials of a glTF file and the names of their images; see gltf.h.
 * Over 700 lines: a reader for each extension of materials, which share how they read textures.
 *
 * A mesh has one set of texture coordinates: those of the base colour, else of the first map, with
 * the texture transform applied (gltf_mesh.c). Opaque materials have a second set, that of the
 * first map with other coordinates. A map that uses neither set is dropped with a note. Exception:
 * if all maps except colour and emission are repeated by the same factor, it becomes the material's
 * detail.
 *
 * A clear coat without a normal map uses the mesh's normal. A surface has one normal map: base and
 * coat share it, or only one of them has it. If both have different maps, the coat's is dropped
 * with a note.
 *
 * Features without a counterpart are approximated, with a note. Glass of KHR_materials_transmission
 * is thin; its transmitted light is tinted by the base colour and attenuated by
 * KHR_materials_volume. Unlit surfaces emit their colour. Specular and glossiness become metallic
 * and roughness, by the formula in the appendix of that extension. */
#include "bake/import/gltf.h"

#include "scene/material.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct texture {
    uint32_t image;
    int set;
    double uv[6];
    uint8_t wrap[2], nearest; /* compared as bytes */
} texture;

/* ---- images ---- */

/* The piece's number for an image; NONE with a note. */
static uint32_t add_image(masu_gltf *g, json_int_t index) {
    const json_t *image = masu_gltf_element(g, "images", index);
    json_int_t view = -1;
    masu_bake_buffer name = {0};
    masu_bake_image about = {0};
    masu_gltf_bytes bytes = {0};
    size_t stride;
    if (!image) return MASU_BLOB_NONE;
    const char *uri = masu_gltf_string(g, image, "uri");
    if (!masu_gltf_index(g, image, "bufferView", g->view_count, &view)) return MASU_BLOB_NONE;
    const char *called = masu_gltf_name_of(g, "images", (size_t)index, image);
    if (uri && !masu_gltf_is_data(uri)) {
        bool outside = false;
        const char *path = masu_gltf_path(g, uri, &outside);
        if (!path) {
            masu_gltf_note_one(g, "images that are not files in the model's folder: ignored", uri);
            return MASU_BLOB_NONE;
        }
        about.outside = outside;
        return masu_bake_add_image(g->piece, path, &about, NULL);
    }
    if (uri ? !masu_gltf_fetch(g, uri, &bytes)
            : view >= 0 && !masu_gltf_view(g, view, &bytes, &stride))
        return MASU_BLOB_NONE;
    if (!bytes.bytes) {
        masu_gltf_note_one(g, "empty images: ignored", called);
        return MASU_BLOB_NONE;
    }
    masu_import_format(&name, "%s:%lld", g->path ? g->path : "", (long long)index);
    masu_bake_append(&name, "", 1);
    about.data_bytes = bytes.bytes;
    uint32_t made = masu_bake_add_image(g->piece, (const char *)name.data, &about, bytes.data);
    masu_bake_release(&name);
    return made;
}

/* The image of a texture that can be read: its own, else an extension's. */
static bool source_of(masu_gltf *g, const json_t *about, json_int_t *image) {
    static const char *const others[] = {"EXT_texture_webp", "MSFT_texture_dds",
                                         "KHR_texture_basisu"};
    size_t images = masu_gltf_count(g, "images");
    for (size_t i = 0; i < 2; i++) {
        const json_t *extension = masu_gltf_extension(g, about, others[i]);
        if (extension && !masu_gltf_index(g, extension, "source", images, image)) return false;
        if (extension && *image >= 0) return true;
    }
    if (!masu_gltf_index(g, about, "source", images, image)) return false;
    if (*image >= 0) return true;
    const json_t *basis = masu_gltf_extension(g, about, others[2]);
    return !basis || masu_gltf_index(g, basis, "source", images, image);
}

static bool read_sampler(masu_gltf *g, const json_t *about, texture *t) {
    json_int_t index = -1;
    uint64_t wrap[2] = {10497, 10497}, filter = 9729;
    if (!masu_gltf_index(g, about, "sampler", masu_gltf_count(g, "samplers"), &index)) return false;
    if (index < 0) return true;
    const json_t *sampler = masu_gltf_element(g, "samplers", index);
    if (!sampler || !masu_gltf_size(g, sampler, "wrapS", &wrap[0]) ||
        !masu_gltf_size(g, sampler, "wrapT", &wrap[1]) ||
        !masu_gltf_size(g, sampler, "magFilter", &filter))
        return false;
    for (int k = 0; k < 2; k++) t->wrap[k] = wrap[k] == 33071 ? 1 : wrap[k] == 33648 ? 2 : 0;
    t->nearest = filter == 9728;
    return true;
}

/* The texture coordinates are those of the set, scaled, then rotated, then translated. v points
 * down the image, and a positive angle is counter-clockwise in the image. */
static bool read_transform(masu_gltf *g, const json_t *info, texture *t) {
    const json_t *about = masu_gltf_extension(g, info, "KHR_texture_transform");
    double offset[2] = {0, 0}, scale[2] = {1, 1}, angle = 0, set = t->set;
    if (!about) return !masu_gltf_failed(g);
    if (!masu_gltf_numbers(g, about, "offset", 2, offset) ||
        !masu_gltf_numbers(g, about, "scale", 2, scale) ||
        !masu_gltf_number(g, about, "rotation", &angle) ||
        !masu_gltf_number(g, about, "texCoord", &set))
        return false;
    double c = cos(angle), s = sin(angle);
    const double uv[6] = {c * scale[0],  s * scale[1], offset[0],
                          -s * scale[0], c * scale[1], offset[1]};
    memcpy(t->uv, uv, sizeof uv);
    t->set = set >= 0 && set < 64 ? (int)set : 0;
    return true;
}

/* Reads a textureInfo; image NONE: absent. False: failed. */
static bool read_texture(masu_gltf *g, const json_t *of, const char *member, texture *t) {
    const json_t *info = of ? masu_gltf_object(g, of, member) : NULL;
    json_int_t index = -1, image = -1;
    uint64_t set = 0;
    *t = (texture){.image = MASU_BLOB_NONE, .uv = {1, 0, 0, 0, 1, 0}};
    if (!info) return !masu_gltf_failed(g);
    if (!masu_gltf_index(g, info, "index", masu_gltf_count(g, "textures"), &index) ||
        !masu_gltf_size(g, info, "texCoord", &set))
        return false;
    if (index < 0) return masu_gltf_fail(g, "\"%s\" has no \"index\"", member);
    const json_t *about = masu_gltf_element(g, "textures", index);
    t->set = set < 64 ? (int)set : 63;
    if (!about || !read_transform(g, info, t) || !read_sampler(g, about, t) ||
        !source_of(g, about, &image))
        return false;
    if (image < 0) {
        masu_gltf_note_one(g, "textures have no supported image",
                           masu_gltf_name_of(g, "textures", (size_t)index, about));
        return !masu_gltf_failed(g);
    }
    t->image = g->wanted == MASU_BAKE_TEXTURES_OFF ? MASU_BLOB_NONE : add_image(g, image);
    return !masu_gltf_failed(g);
}

/* ---- maps ---- */

typedef struct maps {
    texture all[MASU_BAKE_MAPS];
} maps;

static const int order[] = {MASU_BAKE_BASE,       MASU_BAKE_EMISSIVE,  MASU_BAKE_OPACITY,
                            MASU_BAKE_NORMAL,     MASU_BAKE_ROUGHNESS, MASU_BAKE_METALLIC,
                            MASU_BAKE_OCCLUSION,  MASU_BAKE_COAT,      MASU_BAKE_COAT_ROUGHNESS,
                            MASU_BAKE_LOBE_COLOR, MASU_BAKE_LOBE_STRENGTH, MASU_BAKE_COAT_NORMAL};
#define ORDER (sizeof order / sizeof *order)
#define ORDER_COLORS 3 /* the first of them: maps that a material's detail does not repeat */

static bool near(double a, double b) {
    return fabs(a - b) <= 1e-5 * fmax(1, fmax(fabs(a), fabs(b)));
}

/* True if b's transform is only a repetition of a's; times: the factors along u and v. */
static bool repeats(const texture *a, const texture *b, double times[2]) {
    if (a->set != b->set) return false;
    for (int k = 0; k < 2; k++) {
        const double *x = a->uv + 3 * k, *y = b->uv + 3 * k;
        int most = fabs(x[0]) > fabs(x[1]) ? 0 : 1;
        times[k] = x[most] != 0 ? y[most] / x[most] : 0;
        if (!(times[k] >= 0.001 && times[k] <= 10000)) return false;
        for (int i = 0; i < 3; i++) {
            if (!near(x[i] * times[k], y[i])) return false;
        }
    }
    return true;
}

static void leave_out(masu_gltf *g, texture *t, const char *why) {
    const masu_bake_image *image = &MASU_BAKE_IMAGES(g->piece)[t->image];
    masu_gltf_note_one(g, why, (const char *)g->piece->image_text.data + image->name);
    t->image = MASU_BLOB_NONE;
}

/* Maps that share a texture of a set (blob.h) have the same coordinates. */
static uint8_t slot_of(int map) {
    static const uint8_t slots[MASU_BAKE_MAPS] = {
        [MASU_BAKE_BASE] = MASU_SLOT_BASE,           [MASU_BAKE_OPACITY] = MASU_SLOT_BASE,
        [MASU_BAKE_NORMAL] = MASU_SLOT_NORMAL,       [MASU_BAKE_ROUGHNESS] = MASU_SLOT_SURFACE,
        [MASU_BAKE_METALLIC] = MASU_SLOT_SURFACE,    [MASU_BAKE_EMISSIVE] = MASU_SLOT_EMISSIVE,
        [MASU_BAKE_OCCLUSION] = MASU_SLOT_OCCLUSION, [MASU_BAKE_COAT] = MASU_SLOT_COAT,
        [MASU_BAKE_COAT_ROUGHNESS] = MASU_SLOT_COAT, [MASU_BAKE_LOBE_COLOR] = MASU_SLOT_COAT,
        [MASU_BAKE_LOBE_STRENGTH] = MASU_SLOT_COAT,  [MASU_BAKE_COAT_NORMAL] = MASU_SLOT_EMISSIVE};
    return slots[map];
}

/* Chooses a second set for the maps that do not use the first: the set of the first of them.
 * Blended materials have none. */
static void use_second(masu_gltf *g, const maps *m, int map, const texture **second,
                       masu_gltf_material *out, bool *used) {
    const texture *t = &m->all[map];
    double own[2];
    uint8_t slot = slot_of(map);
    *used = false;
    if (out->blends || out->unlit || (slot == MASU_SLOT_BASE)) return;
    if (*second && !(repeats(*second, t, own) && near(own[0], 1) && near(own[1], 1))) return;
    for (size_t i = 0; i < ORDER; i++) { /* maps of one texture: all or none */
        const texture *other = &m->all[order[i]];
        if (slot_of(order[i]) != slot || other->image == MASU_BLOB_NONE) continue;
        if (!(repeats(t, other, own) && near(own[0], 1) && near(own[1], 1))) return;
    }
    if (!*second) {
        out->second_set = t->set;
        memcpy(out->second_uv, t->uv, sizeof out->second_uv);
        *second = t;
    }
    out->given.maps.second |= (uint8_t)(1u << slot);
    *used = true;
    (void)g;
}

/* Chooses one set of coordinates for all maps; returns the map that has it, or NULL. */
static const texture *agree(masu_gltf *g, maps *m, masu_gltf_material *out) {
    float *detail = out->given.material.detail;
    const texture *first = NULL, *second = NULL;
    double times[2] = {1, 1};
    bool scaled = true;
    for (size_t i = 0; i < ORDER && !first; i++) {
        if (m->all[order[i]].image != MASU_BLOB_NONE) first = &m->all[order[i]];
    }
    if (!first) return NULL;
    /* all but colours, by the same factor */
    for (size_t i = ORDER_COLORS, seen = 0; i < ORDER && scaled; i++) {
        const texture *t = &m->all[order[i]];
        double own[2];
        if (t->image == MASU_BLOB_NONE) continue;
        scaled =
            repeats(first, t, own) && (!seen || (near(own[0], times[0]) && near(own[1], times[1])));
        memcpy(times, own, sizeof times);
        seen = 1;
    }
    if (!scaled) times[0] = times[1] = 1;
    bool whole = times[0] == 1 && times[1] == 1;
    for (size_t i = 0; i < ORDER; i++) {
        texture *t = &m->all[order[i]];
        double own[2] = {0, 0};
        if (t->image == MASU_BLOB_NONE) continue;
        bool same = repeats(first, t, own) && near(own[0], i < ORDER_COLORS ? 1 : times[0]) &&
                    near(own[1], i < ORDER_COLORS ? 1 : times[1]);
        bool used = false;
        if (!same && whole) use_second(g, m, order[i], &second, out, &used);
        if (!same && !used)
            leave_out(
                g, t,
                "textures use other coordinates than the base colour of their material: ignored");
        if (t->image != MASU_BLOB_NONE &&
            (memcmp(t->wrap, first->wrap, sizeof t->wrap) != 0 || t->nearest != first->nearest))
            masu_gltf_note_one(
                g,
                "textures have another wrap mode or filter than the base colour of their "
                "material, which is used",
                g->where);
    }
    detail[0] = (float)times[0];
    detail[1] = (float)times[1];
    return first;
}

static void settle(masu_gltf *g, maps *m, masu_gltf_material *out) {
    static const uint8_t channel[MASU_BAKE_MAPS] = {
        [MASU_BAKE_ROUGHNESS] = 1, [MASU_BAKE_METALLIC] = 2, [MASU_BAKE_COAT_ROUGHNESS] = 1,
        [MASU_BAKE_LOBE_STRENGTH] = 3};
    masu_bake_maps *to = &out->given.maps;
    const texture *first = agree(g, m, out);
    for (size_t i = 0; i < ORDER; i++) {
        int map = order[i];
        to->image[map] = m->all[map].image;
        to->channel[map] =
            m->all[map].image == MASU_BLOB_NONE || (to->gloss && map == MASU_BAKE_METALLIC)
                ? 0
                : channel[map];
    }
    if (to->gloss) to->channel[MASU_BAKE_ROUGHNESS] = 3;
    if (!first) return;
    memcpy(to->wrap, first->wrap, sizeof to->wrap);
    to->nearest = first->nearest;
    memcpy(out->uv, first->uv, sizeof out->uv);
    out->set = first->set;
}

/* ---- factors ---- */

static void note_texture(masu_gltf *g, const json_t *of, const char *member) {
    char what[128];
    if (!of || !json_object_get(of, member)) return;
    snprintf(what, sizeof what, "materials have a \"%s\", which is not supported", member);
    masu_gltf_note_one(g, what, g->where);
}

/* `name`: the factor's name, for the note. */
static float limited(masu_gltf *g, double value, double low, double high, const char *name) {
    char what[128];
    snprintf(what, sizeof what, "materials have a \"%s\" beyond %g to %g: clamped", name, low,
             high);
    if (!(value >= low && value <= high)) masu_gltf_note_one(g, what, g->where);
    return masu_import_clamped(value, low, high);
}

/* Limits the components of a colour, with one note. */
static void limit_all(masu_gltf *g, double *values, int count, double high, const char *name) {
    double least = 0, most = 0;
    for (int k = 0; k < count; k++) {
        least = fmin(least, values[k]);
        most = fmax(most, values[k]);
    }
    (void)limited(g, least < 0 ? least : most, 0, high, name);
    for (int k = 0; k < count; k++) values[k] = (double)masu_import_clamped(values[k], 0, high);
}

static bool read_metallic(masu_gltf *g, const json_t *about, masu_gltf_material *out, maps *m) {
    const json_t *pbr = masu_gltf_object(g, about, "pbrMetallicRoughness");
    double color[4] = {1, 1, 1, 1}, metallic = 1, roughness = 1;
    masu_blob_material *to = &out->given.material;
    if (!masu_gltf_numbers(g, pbr, "baseColorFactor", 4, color) ||
        !masu_gltf_number(g, pbr, "metallicFactor", &metallic) ||
        !masu_gltf_number(g, pbr, "roughnessFactor", &roughness) ||
        !read_texture(g, pbr, "baseColorTexture", &m->all[MASU_BAKE_BASE]) ||
        !read_texture(g, pbr, "metallicRoughnessTexture", &m->all[MASU_BAKE_ROUGHNESS]))
        return false;
    m->all[MASU_BAKE_METALLIC] = m->all[MASU_BAKE_ROUGHNESS];
    limit_all(g, color, 4, 1, "baseColorFactor");
    for (int k = 0; k < 3; k++) to->base_color[k] = (float)color[k];
    out->alpha = color[3];
    to->metallic = limited(g, metallic, 0, 1, "metallicFactor");
    to->roughness = limited(g, roughness, 0, 1, "roughnessFactor");
    return true;
}

#define APPROXIMATED 0.02 /* smaller differences of reflectance get no note */

static double brightness(const double c[3]) {
    return sqrt(0.299 * c[0] * c[0] + 0.587 * c[1] * c[1] + 0.114 * c[2] * c[2]);
}

/* The metallic value at which a mix of a dielectric of 0.04 and a metal of this colour has the
 * given diffuse and specular reflectance. */
static double solve_metallic(double diffuse, double specular, double rest) {
    const double plain = 0.04;
    if (specular < plain) return 0;
    double b = diffuse * rest / (1 - plain) + specular - 2 * plain, c = plain - specular;
    double d = fmax(b * b - 4 * plain * c, 0);
    return fmin(fmax((-b + sqrt(d)) / (2 * plain), 0), 1);
}

static bool read_glossiness(masu_gltf *g, const json_t *about, masu_gltf_material *out, maps *m) {
    const json_t *pbr = masu_gltf_extension(g, about, "KHR_materials_pbrSpecularGlossiness");
    double diffuse[4] = {1, 1, 1, 1}, specular[3] = {1, 1, 1}, gloss = 1;
    masu_blob_material *to = &out->given.material;
    if (!pbr) return !masu_gltf_failed(g);
    if (!masu_gltf_numbers(g, pbr, "diffuseFactor", 4, diffuse) ||
        !masu_gltf_numbers(g, pbr, "specularFactor", 3, specular) ||
        !masu_gltf_number(g, pbr, "glossinessFactor", &gloss) ||
        !read_texture(g, pbr, "diffuseTexture", &m->all[MASU_BAKE_BASE]) ||
        !read_texture(g, pbr, "specularGlossinessTexture", &m->all[MASU_BAKE_ROUGHNESS]))
        return false;
    m->all[MASU_BAKE_METALLIC].image = MASU_BLOB_NONE;
    limit_all(g, specular, 3, 1, "specularFactor");
    limit_all(g, diffuse, 4, 1, "diffuseFactor");
    double rest = 1 - fmax(specular[0], fmax(specular[1], specular[2])), metallic = 0, worst = 0;
    bool pictured = m->all[MASU_BAKE_ROUGHNESS].image != MASU_BLOB_NONE;
    if (pictured) { /* the factor scales a texture */
        masu_gltf_note_one(
            g, "materials have a specular colour texture: only its glossiness is used", g->where);
        rest = 1;
    } else {
        metallic = solve_metallic(brightness(diffuse), brightness(specular), rest);
    }
    for (int k = 0; k < 3; k++) {
        double from_diffuse =
            pictured ? diffuse[k] : diffuse[k] * rest / 0.96 / fmax(1 - metallic, 1e-6);
        double from_specular = (specular[k] - 0.04 * (1 - metallic)) / fmax(metallic, 1e-6);
        double share = metallic * metallic;
        to->base_color[k] =
            masu_import_clamped(from_diffuse * (1 - share) + from_specular * share, 0, 1);
        double got = (double)to->base_color[k] * (1 - metallic) * 0.96;
        double got_specular = 0.04 * (1 - metallic) + (double)to->base_color[k] * metallic;
        worst = fmax(worst, fmax(fabs(got - diffuse[k] * rest), fabs(got_specular - specular[k])));
    }
    if (worst > APPROXIMATED && !pictured)
        masu_gltf_note_one(
            g, "materials have a specular colour that metallic and roughness can only approximate",
            g->where);
    out->alpha = diffuse[3];
    to->metallic = (float)metallic;
    to->roughness = pictured ? 1 : 1 - limited(g, gloss, 0, 1, "glossinessFactor");
    out->given.maps.gloss = pictured;
    return true;
}

static bool read_alpha(masu_gltf *g, const json_t *about, masu_gltf_material *out) {
    const char *mode = masu_gltf_string(g, about, "alphaMode");
    double cutoff = 0.5;
    if (!masu_gltf_number(g, about, "alphaCutoff", &cutoff)) return false;
    masu_bake_maps *maps = &out->given.maps;
    out->blends = mode && strcmp(mode, "BLEND") == 0;
    maps->cutoff = limited(g, cutoff, 0, 1, "alphaCutoff");
    if (g->wanted == MASU_BAKE_TEXTURES_OFF) return !masu_gltf_failed(g);
    maps->alpha = mode && strcmp(mode, "MASK") == 0 ? MASU_BAKE_ALPHA_MASK
                  : out->blends                     ? MASU_BAKE_ALPHA_BLEND
                                                    : MASU_BAKE_ALPHA_OPAQUE;
    return !masu_gltf_failed(g);
}

static bool read_emission(masu_gltf *g, const json_t *about, masu_gltf_material *out, maps *m) {
    const json_t *strong = masu_gltf_extension(g, about, "KHR_materials_emissive_strength");
    double color[3] = {0, 0, 0}, strength = 1;
    if (!masu_gltf_numbers(g, about, "emissiveFactor", 3, color) ||
        !masu_gltf_number(g, strong, "emissiveStrength", &strength) ||
        !read_texture(g, about, "emissiveTexture", &m->all[MASU_BAKE_EMISSIVE]))
        return false;
    for (int k = 0; k < 3; k++) color[k] *= strength;
    limit_all(g, color, 3, 65504, "emissiveFactor");
    for (int k = 0; k < 3; k++) out->given.material.emissive[k] = (float)color[k];
    return true;
}

/* The reflectance of a dielectric at normal incidence: that of its index of refraction times the
 * specular colour, at most 1, times the specular factor. */
static bool read_specular(masu_gltf *g, const json_t *about, masu_blob_material *to, maps *m) {
    const json_t *specular = masu_gltf_extension(g, about, "KHR_materials_specular");
    const json_t *refraction = masu_gltf_extension(g, about, "KHR_materials_ior");
    double factor = 1, color[3] = {1, 1, 1}, index = 1.5, most = 0;
    if (!masu_gltf_number(g, specular, "specularFactor", &factor) ||
        !masu_gltf_numbers(g, specular, "specularColorFactor", 3, color) ||
        !masu_gltf_number(g, refraction, "ior", &index) ||
        !read_texture(g, specular, "specularTexture", &m->all[MASU_BAKE_LOBE_STRENGTH]) ||
        !read_texture(g, specular, "specularColorTexture", &m->all[MASU_BAKE_LOBE_COLOR]))
        return false;
    if (!specular && !refraction) return true;
    factor = (double)limited(g, factor, 0, 1, "specularFactor");
    /* 0 means infinity */
    double root = (index - 1) / (index + 1), reflectance = index > 0 ? root * root : 1;
    if (!(index == 0 || index >= 1)) {
        masu_gltf_note_one(g, "materials have an \"ior\" below 1: taken for 1", g->where);
        reflectance = 0;
    }
    for (int k = 0; k < 3; k++) {
        color[k] = fmin(fmax(color[k], 0) * reflectance, 1) * factor;
        most = fmax(most, color[k]);
    }
    to->specular = masu_import_clamped(most / 0.08, 0, 12.5);
    bool gray = near(color[0], color[1]) && near(color[1], color[2]);
    for (int k = 0; k < 3 && !gray; k++)
        to->specular_color[k] = masu_import_clamped(color[k] / most, 0, 1);
    return true;
}

static bool read_sheen(masu_gltf *g, const json_t *about, masu_blob_material *to, maps *m) {
    const json_t *sheen = masu_gltf_extension(g, about, "KHR_materials_sheen");
    double color[3] = {0, 0, 0}, roughness = 0;
    texture colors, strength;
    if (!masu_gltf_numbers(g, sheen, "sheenColorFactor", 3, color) ||
        !masu_gltf_number(g, sheen, "sheenRoughnessFactor", &roughness) ||
        !read_texture(g, sheen, "sheenColorTexture", &colors) ||
        !read_texture(g, sheen, "sheenRoughnessTexture", &strength))
        return false;
    limit_all(g, color, 3, 1, "sheenColorFactor");
    if (!(color[0] > 0 || color[1] > 0 || color[2] > 0)) return true;
    for (int k = 0; k < 3; k++) to->sheen_color[k] = (float)color[k];
    to->sheen_roughness = limited(g, roughness, 0, 1, "sheenRoughnessFactor");
    m->all[MASU_BAKE_LOBE_COLOR] = colors;
    m->all[MASU_BAKE_LOBE_STRENGTH] = strength;
    return true;
}

static bool read_anisotropy(masu_gltf *g, const json_t *about, masu_blob_material *to) {
    const json_t *grain = masu_gltf_extension(g, about, "KHR_materials_anisotropy");
    double strength = 0, rotation = 0;
    if (!masu_gltf_number(g, grain, "anisotropyStrength", &strength) ||
        !masu_gltf_number(g, grain, "anisotropyRotation", &rotation))
        return false;
    note_texture(g, grain, "anisotropyTexture");
    to->anisotropy = limited(g, strength, 0, 1, "anisotropyStrength");
    rotation = fmod(rotation, 6.283185307179586);
    to->anisotropy_rotation = (float)(rotation < 0 ? rotation + 6.283185307179586 : rotation);
    return true;
}

/* A material has one additional lobe (blob.h). The order of priority is coat, sheen, anisotropy,
 * colour. */
static void settle_lobes(masu_gltf *g, masu_blob_material *to, maps *m) {
    float *hue = to->specular_color, *sheen = to->sheen_color;
    texture *maps_of[2] = {&m->all[MASU_BAKE_LOBE_COLOR], &m->all[MASU_BAKE_LOBE_STRENGTH]};
    bool mapped = maps_of[0]->image != MASU_BLOB_NONE || maps_of[1]->image != MASU_BLOB_NONE;
    bool shines = sheen[0] > 0 || sheen[1] > 0 || sheen[2] > 0, grained = to->anisotropy > 0;
    bool metal = !(to->metallic < 1) && m->all[MASU_BAKE_METALLIC].image == MASU_BLOB_NONE;
    bool tinted = masu_is_colored(hue), colored = to->specular > 1 || tinted || (mapped && !shines);
    const char *first = to->coat > 0 ? "a clear coat" : shines ? "a sheen" : "an anisotropy";
    char what[128];
    if (metal && !shines) colored = false; /* metals reflect their base colour */
    if (shines && to->coat > 0) {
        masu_gltf_note_one(g, "materials have a clear coat and a sheen: the sheen is ignored",
                           g->where);
        shines = false;
        maps_of[0]->image = maps_of[1]->image = MASU_BLOB_NONE;
    }
    if (grained && (to->coat > 0 || shines)) {
        snprintf(what, sizeof what,
                 "materials have %s and an anisotropy: the anisotropy is ignored", first);
        masu_gltf_note_one(g, what, g->where);
        grained = false;
    }
    if (colored && (to->coat > 0 || shines || grained)) {
        snprintf(what, sizeof what,
                 "materials have %s and a specular colour, texture or reflectance above 0.08: "
                 "gray, at most 0.08",
                 first);
        masu_gltf_note_one(g, what, g->where);
        colored = false;
    }
    if (!colored && !shines) maps_of[0]->image = maps_of[1]->image = MASU_BLOB_NONE;
    if (!shines) sheen[0] = sheen[1] = sheen[2] = 0;
    if (!grained) to->anisotropy = to->anisotropy_rotation = 0;
    if (!colored) {
        float share = 0.2126f * hue[0] + 0.7152f * hue[1] + 0.0722f * hue[2];
        to->specular =
            masu_import_clamped((double)(tinted ? to->specular * share : to->specular), 0, 1);
        hue[0] = hue[1] = hue[2] = 0;
    }
    if (shines && !near((double)to->specular, 0.5)) {
        masu_gltf_note_one(
            g,
            "materials have a sheen and a specular factor or index of refraction, which is ignored",
            g->where);
    }
    if (shines) to->specular = 0.5f;
}

/* One normal map for both layers, with its strength; see above. */
static void settle_normals(masu_gltf *g, masu_gltf_material *out, maps *m, texture *coat,
                           double scale[2]) {
    texture *base = &m->all[MASU_BAKE_NORMAL];
    double times[2];
    if (!(out->given.material.coat > 0) ||
        (base->image == MASU_BLOB_NONE && coat->image == MASU_BLOB_NONE))
        return;
    out->given.maps.relief_of = MASU_BAKE_RELIEF_OF_BASE;
    if (coat->image == MASU_BLOB_NONE) return;
    if (base->image == MASU_BLOB_NONE) {
        out->given.maps.relief_of = MASU_BAKE_RELIEF_OF_COAT;
        *base = *coat;
        scale[0] = scale[1];
    } else if (base->image == coat->image && repeats(base, coat, times) && near(times[0], 1) &&
               near(times[1], 1) && near(scale[0], scale[1])) {
        out->given.maps.relief_of = MASU_BAKE_RELIEF_OF_BOTH;
    } else {
        out->given.maps.coat_scale = limited(g, scale[1], -16, 16, "clearcoatNormalTexture.scale");
        m->all[MASU_BAKE_COAT_NORMAL] = *coat;
        if (m->all[MASU_BAKE_EMISSIVE].image != MASU_BLOB_NONE || out->blends) {
            leave_out(g, &m->all[MASU_BAKE_COAT_NORMAL],
                      "clear coats have another normal map than the base layer, and the material "
                      "has emission or is "
                      "transparent: ignored, they are smooth");
        }
    }
}

static bool read_normals(masu_gltf *g, const json_t *about, masu_gltf_material *out, maps *m) {
    const json_t *above = masu_gltf_extension(g, about, "KHR_materials_clearcoat");
    double scale[2] = {1, 1};
    texture coat;
    if (!read_texture(g, about, "normalTexture", &m->all[MASU_BAKE_NORMAL]) ||
        !read_texture(g, above, "clearcoatNormalTexture", &coat) ||
        !masu_gltf_number(g, masu_gltf_object(g, about, "normalTexture"), "scale", &scale[0]) ||
        !masu_gltf_number(g, above ? masu_gltf_object(g, above, "clearcoatNormalTexture") : NULL,
                          "scale", &scale[1]))
        return false;
    settle_normals(g, out, m, &coat, scale);
    out->given.maps.normal_scale = limited(g, scale[0], -16, 16, "normalTexture.scale");
    return !masu_gltf_failed(g);
}

static bool read_coat(masu_gltf *g, const json_t *about, masu_blob_material *to, maps *m) {
    const json_t *coat = masu_gltf_extension(g, about, "KHR_materials_clearcoat");
    double factor = 0, roughness = 0;
    if (!masu_gltf_number(g, coat, "clearcoatFactor", &factor) ||
        !masu_gltf_number(g, coat, "clearcoatRoughnessFactor", &roughness))
        return false;
    to->coat = limited(g, factor, 0, 1, "clearcoatFactor");
    if (!(to->coat > 0)) return true;
    to->coat_roughness = limited(g, roughness, 0, 1, "clearcoatRoughnessFactor");
    return read_texture(g, coat, "clearcoatTexture", &m->all[MASU_BAKE_COAT]) &&
           read_texture(g, coat, "clearcoatRoughnessTexture", &m->all[MASU_BAKE_COAT_ROUGHNESS]);
}

/* KHR_materials_volume: the light that is left after the thickness, as a factor of each surface
 * that a ray crosses: one if back faces are culled, else two. Also sets its refraction. */
static bool read_volume(masu_gltf *g, const json_t *about, masu_blob_material *to) {
    const json_t *volume = masu_gltf_extension(g, about, "KHR_materials_volume");
    const json_t *refraction = masu_gltf_extension(g, about, "KHR_materials_ior");
    double share = json_is_true(json_object_get(about, "doubleSided")) ? 0.5 : 1;
    double thickness = 0, distance = 0, left[3] = {1, 1, 1}, index = 1.5;
    if (!masu_gltf_number(g, volume, "thicknessFactor", &thickness) ||
        !masu_gltf_number(g, volume, "attenuationDistance", &distance) ||
        !masu_gltf_numbers(g, volume, "attenuationColor", 3, left) ||
        !masu_gltf_number(g, refraction, "ior", &index))
        return false;
    note_texture(g, volume, "thicknessTexture");
    if (thickness > 0 && to->metallic > 0) {
        masu_gltf_note_one(
            g, "materials have a thickness and a metallic factor: they do not refract", g->where);
    } else if (thickness > 0) {
        to->thickness = limited(g, thickness, 0, 65504, "thicknessFactor");
        /* 0 means infinity */
        to->ior = index == 0 ? 1000 : limited(g, fmax(index, 1), 1, 1000, "ior");
    }
    if (!(thickness > 0 && distance > 0)) return true;
    limit_all(g, left, 3, 1, "attenuationColor");
    for (int k = 0; k < 3; k++)
        to->base_color[k] *= (float)pow(left[k], share * thickness / distance);
    return true;
}

/* A share of the transmitted light is tinted. The alpha of the base colour applies only to
 * materials that are blended anyway. */
static bool read_transmission(masu_gltf *g, const json_t *about, masu_gltf_material *out, maps *m) {
    const json_t *through = masu_gltf_extension(g, about, "KHR_materials_transmission");
    masu_blob_material *to = &out->given.material;
    double factor = 0;
    if (!masu_gltf_number(g, through, "transmissionFactor", &factor)) return false;
    if (!read_texture(g, through, "transmissionTexture", &m->all[MASU_BAKE_OPACITY])) return false;
    texture *map = &m->all[MASU_BAKE_OPACITY];
    factor = (double)limited(g, factor, 0, 1, "transmissionFactor") * (1 - (double)to->metallic);
    if (!(factor > 0) || out->given.maps.alpha == MASU_BAKE_ALPHA_MASK) map->image = MASU_BLOB_NONE;
    if (!(factor > 0)) return true;
    if (map->image != MASU_BLOB_NONE && out->blends) /* the alpha of the base colour is in use */
        leave_out(g, map,
                  "materials have a \"transmissionTexture\" and are alpha-blended: it is ignored");
    if (out->given.maps.alpha == MASU_BAKE_ALPHA_MASK) {
        masu_gltf_note_one(
            g, "materials transmit light and are alpha-tested: drawn without transmission",
            g->where);
        return true;
    }
    if (!read_volume(g, about, to)) return false;
    out->alpha = (out->blends ? out->alpha : 1) * (1 - factor);
    out->given.maps.tinted = 1;
    out->given.maps.transmission = map->image != MASU_BLOB_NONE;
    out->blends = true;
    out->given.maps.alpha = MASU_BAKE_ALPHA_BLEND;
    return true;
}

/* An unlit material emits its colour, independent of the lighting. */
static void make_unlit(masu_gltf_material *out, maps *m) {
    masu_blob_material *to = &out->given.material;
    memcpy(to->emissive, to->base_color, sizeof to->emissive);
    m->all[MASU_BAKE_EMISSIVE] = m->all[MASU_BAKE_BASE];
    to->metallic = to->specular = to->coat = to->anisotropy = to->thickness = to->ior = 0;
    to->roughness = 1;
    for (int k = 0; k < 3; k++) to->specular_color[k] = to->sheen_color[k] = 0;
    m->all[MASU_BAKE_LOBE_COLOR].image = m->all[MASU_BAKE_LOBE_STRENGTH].image = MASU_BLOB_NONE;
    m->all[MASU_BAKE_COAT_NORMAL].image = MASU_BLOB_NONE;
    out->unlit = true;
    out->given.maps.unlit = 1;
    m->all[MASU_BAKE_NORMAL].image = m->all[MASU_BAKE_ROUGHNESS].image = MASU_BLOB_NONE;
    m->all[MASU_BAKE_METALLIC].image = m->all[MASU_BAKE_OCCLUSION].image = MASU_BLOB_NONE;
    m->all[MASU_BAKE_COAT].image = m->all[MASU_BAKE_COAT_ROUGHNESS].image = MASU_BLOB_NONE;
}

static bool read_material(masu_gltf *g, const json_t *about, masu_gltf_material *out) {
    maps m;
    double strength = 1;
    for (int i = 0; i < MASU_BAKE_MAPS; i++) m.all[i] = (texture){.image = MASU_BLOB_NONE};
    (void)masu_gltf_string(g, about, "name");
    if (masu_gltf_failed(g) || !read_metallic(g, about, out, &m) ||
        !read_glossiness(g, about, out, &m) || !read_alpha(g, about, out) ||
        !read_emission(g, about, out, &m) || !read_specular(g, about, &out->given.material, &m) ||
        !read_coat(g, about, &out->given.material, &m) ||
        !read_sheen(g, about, &out->given.material, &m) ||
        !read_anisotropy(g, about, &out->given.material) || !read_transmission(g, about, out, &m) ||
        !read_normals(g, about, out, &m) ||
        !read_texture(g, about, "occlusionTexture", &m.all[MASU_BAKE_OCCLUSION]) ||
        !masu_gltf_number(g, masu_gltf_object(g, about, "occlusionTexture"), "strength", &strength))
        return false;
    settle_lobes(g, &out->given.material, &m);
    out->given.maps.occlusion = limited(g, strength, 0, 1, "occlusionTexture.strength");
    out->given.maps.single = !json_is_true(json_object_get(about, "doubleSided"));
    if (masu_gltf_extension(g, about, "KHR_materials_unlit")) make_unlit(out, &m);
    settle(g, &m, out);
    out->given.maps.dark = json_object_get(about, "emissiveTexture") &&
                           g->wanted != MASU_BAKE_TEXTURES_OFF &&
                           out->given.maps.image[MASU_BAKE_EMISSIVE] == MASU_BLOB_NONE;
    return !masu_gltf_failed(g);
}

/* Specular and glossiness become metallic and roughness by an inverse that is not exact. The same
 * surface may look different next to materials that use metallic and roughness directly. */
static void note_mixture(masu_gltf *g) {
    size_t count = masu_gltf_count(g, "materials"), glossy = 0;
    const char *first = NULL;
    char what[200];
    for (size_t i = 0; i < count; i++) {
        const json_t *about = masu_gltf_element(g, "materials", (json_int_t)i);
        if (!about || !masu_gltf_extension(g, about, "KHR_materials_pbrSpecularGlossiness"))
            continue;
        glossy++;
        if (!first) first = masu_gltf_name_of(g, "materials", i, about);
    }
    if (!glossy || glossy == count) return;
    snprintf(what, sizeof what,
             "of %zu materials have specular and glossiness, which become metallic and roughness, "
             "beside others that have "
             "these: convert the file to one of them, unless both look right",
             count);
    masu_gltf_note_many(g, glossy, what, first);
}

bool masu_gltf_read_materials(masu_gltf *g) {
    g->material_count = masu_gltf_count(g, "materials");
    g->materials = masu_gltf_take(g, g->material_count + 1, sizeof *g->materials);
    for (size_t i = 0; i <= g->material_count; i++) {
        masu_gltf_material *out = &g->materials[i];
        *out =
            (masu_gltf_material){.given = {masu_bake_default_material(), masu_bake_no_maps(), ""},
                                 .uv = {1, 0, 0, 0, 1, 0},
                                 .alpha = 1};
        if (i == g->material_count) { /* glTF's default if no material is named */
            masu_blob_material *to = &out->given.material;
            to->base_color[0] = to->base_color[1] = to->base_color[2] = 1;
            to->metallic = to->roughness = 1;
            break;
        }
        const json_t *about = masu_gltf_element(g, "materials", (json_int_t)i);
        if (!about) return false;
        masu_gltf_at(g, "materials", i, about);
        const char *name = json_string_value(json_object_get(about, "name"));
        out->given.name = masu_bake_take_text(&g->pool, name ? name : "");
        if (!read_material(g, about, out)) return false;
    }
    note_mixture(g);
    g->where[0] = '\0';
    return true;
}

unsigned masu_gltf_given(masu_gltf *g, json_int_t material, const double color[4], int colored) {
    const masu_gltf_material *from =
        &g->materials[material < 0 ? g->material_count : (size_t)material];
    masu_import_given made = from->given;
    masu_blob_material *to = &made.material;
    double alpha = from->alpha;
    for (int k = 0; k < 3; k++) {
        to->base_color[k] = masu_import_clamped((double)to->base_color[k] * color[k], 0, 1);
        if (!from->unlit) continue;
        /* black; with make_unlit's roughness, lights do not affect it */
        to->emissive[k] = to->base_color[k];
        to->base_color[k] = 0;
    }
    if (from->blends) alpha *= (double)masu_import_clamped(color[3], 0, 1);
    made.maps.colored = (uint8_t)(colored && from->blends ? colored : colored != 0);
    if (colored == MASU_BAKE_COLORED_ALPHA && made.maps.alpha == MASU_BAKE_ALPHA_MASK)
        masu_gltf_note_one(
            g, "materials are alpha-tested and have vertex colours with alpha, which is ignored",
            made.name);
    if (from->blends && (alpha < 0.999 || made.maps.colored == MASU_BAKE_COLORED_ALPHA)) {
        made.maps.alpha = MASU_BAKE_ALPHA_BLEND;
        to->opacity = masu_import_clamped(alpha, 0, 1);
    }
    size_t count = g->given.bytes / sizeof made;
    const masu_import_given *all = (const masu_import_given *)(const void *)g->given.data;
    /* the last few: the variants of one mesh */
    for (size_t i = count; i > 0 && i + 256 > count; i--) {
        if (all[i - 1].name == made.name &&
            memcmp(&all[i - 1].maps, &made.maps, sizeof made.maps) == 0 &&
            memcmp(&all[i - 1].material, to, sizeof *to) == 0)
            return (unsigned)(i - 1);
    }
    masu_bake_append(&g->given, &made, sizeof made);
    return (unsigned)count;
}

/* assimp_material.c: materials and the names of their images; see assimp.h.
 *
 * Not used for glTF (gltf_material.c). A base colour is linear. Colours of older formats (OBJ,
 * AC3D) were chosen on a screen and are decoded from sRGB. A specular exponent n becomes the
 * roughness (2 / (n + 2))^(1/4), at which GGX has the same lobe width. */
#include "bake/import/assimp.h"
#include "bake/import/picture_path.h"

#include <assimp/ObjMaterial.h>
#include <assimp/material.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

double masu_import_decode_srgb(double c) {
    return c <= 0.04045 ? c / 12.92 : pow((c + 0.055) / 1.055, 2.4);
}

static bool get_color(const struct aiMaterial *m, const char *key, double out[4]) {
    struct aiColor4D c = {0, 0, 0, 1};
    if (aiGetMaterialColor(m, key, 0, 0, &c) != aiReturn_SUCCESS) return false;
    const ai_real values[4] = {c.r, c.g, c.b, c.a};
    for (int i = 0; i < 4; i++) out[i] = (double)values[i];
    return true;
}

static bool get_factor(const struct aiMaterial *m, const char *key, double *out) {
    ai_real value = 0;
    unsigned count = 1;
    if (aiGetMaterialFloatArray(m, key, 0, 0, &value, &count) != aiReturn_SUCCESS || count < 1) {
        return false;
    }
    *out = (double)value;
    return true;
}

#define KEY(name) KEY_OF(name)       /* Assimp's macros are "key", type, index */
#define KEY_OF(key, type, index) key /* type and index are 0 for all of these */

/* ---- textures ---- */

/* The image at `path`: "*3" or the name of an embedded image, else a file next to the model. */
static uint32_t image_of(masu_import *m, const struct aiString *path) {
    char text[sizeof path->data + 1];
    int length = masu_import_length(path);
    memcpy(text, path->data, (size_t)length);
    text[length] = '\0';
    const struct aiScene *s = m->source;
    long number = -1;
    if (text[0] == '*') {
        char *end;
        number = strtol(text + 1, &end, 10);
        if (*end || end == text + 1) number = -1;
    }
    for (unsigned i = 0; i < s->mNumTextures && s->mTextures && number < 0; i++) {
        const struct aiTexture *t = s->mTextures[i];
        if (t && masu_import_length(&t->mFilename) == length && length &&
            memcmp(t->mFilename.data, text, (size_t)length) == 0) {
            number = (long)i;
        }
    }
    masu_bake_buffer name = {0};
    masu_bake_image about = {0};
    const void *data = NULL;
    if (number >= 0 && number < (long)s->mNumTextures && s->mTextures && s->mTextures[number] &&
        s->mTextures[number]->pcData) {
        const struct aiTexture *t = s->mTextures[number];
        masu_import_format(&name, "%s:%ld", m->path, number);
        data = t->pcData;
        about.data_bytes = t->mWidth;
        if (t->mHeight && t->mWidth <= 16384 && t->mHeight <= 16384) {
            about.raw_width = t->mWidth;
            about.raw_height = t->mHeight;
            about.data_bytes = (uint64_t)t->mWidth * t->mHeight * 4;
        }
        if (about.data_bytes > (uint64_t)1 << 30) about.data_bytes = 0;
    } else {
        about.outside = !masu_bake_picture_path(m->path, text, &name);
    }
    masu_bake_append(&name, "", 1);
    uint32_t image = masu_bake_add_image(m->piece, (const char *)name.data, &about, data);
    masu_bake_release(&name);
    return image;
}

typedef struct map_request {
    int map;
    enum aiTextureType type;
    uint8_t channel;
} map_request;

static uint8_t wrap_of(const struct aiMaterial *from, const char *key, unsigned type) {
    int mode = aiTextureMapMode_Wrap;
    unsigned count = 1;
    if (aiGetMaterialIntegerArray(from, key, type, 0, &mode, &count) != aiReturn_SUCCESS) return 0;
    return mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal ? 1
           : mode == aiTextureMapMode_Mirror                                ? 2
                                                                            : 0;
}

static bool take_map(masu_import *m, const struct aiMaterial *from, const map_request *wanted,
                     masu_bake_maps *to) {
    struct aiString path = {0};
    if (to->image[wanted->map] != MASU_BLOB_NONE ||
        aiGetMaterialTextureCount(from, wanted->type) == 0 ||
        aiGetMaterialTexture(from, wanted->type, 0, &path, NULL, NULL, NULL, NULL, NULL, NULL) !=
            aiReturn_SUCCESS ||
        masu_import_length(&path) == 0) {
        return false;
    }
    if (!masu_bake_has_maps(to)) { /* the first one decides for all */
        to->wrap[0] = wrap_of(from, _AI_MATKEY_MAPPINGMODE_U_BASE, wanted->type);
        to->wrap[1] = wrap_of(from, _AI_MATKEY_MAPPINGMODE_V_BASE, wanted->type);
    }
    to->image[wanted->map] = image_of(m, &path);
    to->channel[wanted->map] = wanted->channel;
    return true;
}

static bool same_texture(const struct aiMaterial *m, enum aiTextureType a, enum aiTextureType b) {
    struct aiString x = {0}, y = {0};
    return aiGetMaterialTextureCount(m, a) && aiGetMaterialTextureCount(m, b) &&
           aiGetMaterialTexture(m, a, 0, &x, NULL, NULL, NULL, NULL, NULL, NULL) ==
               aiReturn_SUCCESS &&
           aiGetMaterialTexture(m, b, 0, &y, NULL, NULL, NULL, NULL, NULL, NULL) ==
               aiReturn_SUCCESS &&
           masu_import_length(&x) == masu_import_length(&y) &&
           memcmp(x.data, y.data, (size_t)masu_import_length(&x)) == 0;
}

/* True if the format defines the alpha of a texture as coverage: AC3D, and formats for which Assimp
 * has a flag. */
static bool alpha_covers(const masu_import *m, const struct aiMaterial *from) {
    const char *dot = strrchr(m->path, '.');
    int flags = 0;
    unsigned count = 1;
    if (dot && (strcasecmp(dot, ".ac") == 0 || strcasecmp(dot, ".acc") == 0)) return true;
    return aiGetMaterialIntegerArray(from, AI_MATKEY_TEXFLAGS(aiTextureType_DIFFUSE, 0), &flags,
                                     &count) == aiReturn_SUCCESS &&
           flags & aiTextureFlags_UseAlpha;
}

static void convert_alpha(const masu_import *m, const struct aiMaterial *from,
                          masu_bake_maps *maps) {
    if (alpha_covers(m, from)) maps->alpha = MASU_BAKE_ALPHA_COVERS;
}

/* The height scale: OBJ's -bm, 3DS and FBX. */
static double bump_strength(const struct aiMaterial *from, enum aiTextureType type) {
    double scale = 1;
    ai_real value = 1;
    unsigned count = 1;
    get_factor(from, KEY(AI_MATKEY_BUMPSCALING), &scale);
    if (aiGetMaterialFloatArray(from, _AI_MATKEY_OBJ_BUMPMULT_BASE, type, 0, &value, &count) ==
            aiReturn_SUCCESS && count == 1)
        scale = (double)value;
    return scale;
}

static masu_bake_maps convert_maps(masu_import *m, const struct aiMaterial *from) {
    static const map_request requests[] = {
        {MASU_BAKE_BASE, aiTextureType_BASE_COLOR, 0},
        {MASU_BAKE_BASE, aiTextureType_DIFFUSE, 0},
        {MASU_BAKE_NORMAL, aiTextureType_NORMALS, 0},
        {MASU_BAKE_NORMAL, aiTextureType_NORMAL_CAMERA, 0},
        {MASU_BAKE_NORMAL, aiTextureType_HEIGHT, 0},
        {MASU_BAKE_EMISSIVE, aiTextureType_EMISSIVE, 0},
        {MASU_BAKE_EMISSIVE, aiTextureType_EMISSION_COLOR, 0},
        {MASU_BAKE_OPACITY, aiTextureType_OPACITY, 0},
        {MASU_BAKE_OCCLUSION, aiTextureType_AMBIENT_OCCLUSION, 0},
    };
    /* Both in one image: green and blue, as in glTF. */
    static const map_request packed[] = {{MASU_BAKE_ROUGHNESS, aiTextureType_DIFFUSE_ROUGHNESS, 1},
                                         {MASU_BAKE_METALLIC, aiTextureType_METALNESS, 2}};
    static const map_request apart[] = {{MASU_BAKE_ROUGHNESS, aiTextureType_DIFFUSE_ROUGHNESS, 0},
                                        {MASU_BAKE_METALLIC, aiTextureType_METALNESS, 0}};
    masu_bake_maps maps = masu_bake_no_maps();
    enum aiTextureType relief = aiTextureType_NONE;
    if (m->wanted == MASU_BAKE_TEXTURES_OFF) return maps;
    convert_alpha(m, from, &maps);
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
        if (take_map(m, from, &requests[i], &maps) && requests[i].map == MASU_BAKE_NORMAL)
            relief = requests[i].type;
    }
    bool both = same_texture(from, aiTextureType_DIFFUSE_ROUGHNESS, aiTextureType_METALNESS);
    for (size_t i = 0; i < 2; i++) take_map(m, from, both ? &packed[i] : &apart[i], &maps);
    if (relief != aiTextureType_NONE) {
        maps.relief = relief == aiTextureType_HEIGHT ? MASU_BAKE_RELIEF_NAMED_HEIGHTS
                                                     : MASU_BAKE_RELIEF_NAMED_NORMALS;
        maps.normal_scale = masu_import_clamped(bump_strength(from, relief), -16, 16);
    }
    return maps;
}

/* False for types of texture that are ignored. */
static bool is_used(const struct aiMaterial *m, int type) {
    switch (type) {
    case aiTextureType_HEIGHT: /* normals, if the material has any */
        return !aiGetMaterialTextureCount(m, aiTextureType_NORMALS) &&
               !aiGetMaterialTextureCount(m, aiTextureType_NORMAL_CAMERA);
    case aiTextureType_BASE_COLOR:
    case aiTextureType_DIFFUSE:
    case aiTextureType_NORMALS:
    case aiTextureType_NORMAL_CAMERA:
    case aiTextureType_EMISSIVE:
    case aiTextureType_EMISSION_COLOR:
    case aiTextureType_OPACITY:
    case aiTextureType_AMBIENT_OCCLUSION:
    case aiTextureType_DIFFUSE_ROUGHNESS:
    case aiTextureType_METALNESS: return true;
    default: return false;
    }
}

static void note_textures(masu_import *m, const struct aiMaterial *material) {
    for (int type = 1; type <= AI_TEXTURE_TYPE_MAX; type++) {
        unsigned count = aiGetMaterialTextureCount(material, (enum aiTextureType)type);
        if (is_used(material, type) && m->wanted != MASU_BAKE_TEXTURES_OFF) continue;
        for (unsigned i = 0; i < count && i < 16; i++) {
            struct aiString path = {0};
            if (aiGetMaterialTexture(material, (enum aiTextureType)type, i, &path, NULL, NULL, NULL,
                                     NULL, NULL, NULL) != aiReturn_SUCCESS) {
                continue;
            }
            int length = masu_import_length(&path);
            int skip = length > 60 ? length - 60 : 0; /* the end of a path is the most specific */
            masu_bake_buffer name = {0};
            masu_bake_append_text(&name, skip ? "..." : "");
            masu_import_name(&name, path.data + skip, length - skip);
            masu_bake_append(&name, ", ", 3);
            masu_bake_append(&m->textures, "", 1);
            m->textures.bytes--;
            if (!strstr((const char *)m->textures.data, (const char *)name.data) &&
                m->texture_count++ < MASU_IMPORT_NAMES_MAX) {
                masu_bake_append_text(&m->textures, (const char *)name.data);
            }
            masu_bake_release(&name);
        }
    }
}

static void convert_color(const struct aiMaterial *from, masu_blob_material *to, double *alpha) {
    double c[4], gloss;
    bool linear = get_color(from, KEY(AI_MATKEY_BASE_COLOR), c);
    if (get_factor(from, KEY(AI_MATKEY_GLOSSINESS_FACTOR), &gloss) &&
        get_color(from, KEY(AI_MATKEY_COLOR_DIFFUSE), c)) {
        linear = true; /* from a specular-glossiness material */
    }
    bool found = linear || get_color(from, KEY(AI_MATKEY_COLOR_DIFFUSE), c);
    for (int i = 0; found && i < 3; i++) {
        double value = (double)masu_import_clamped(c[i], 0, 1);
        to->base_color[i] =
            masu_import_clamped(linear ? value : masu_import_decode_srgb(value), 0, 1);
    }
    if (found) *alpha = c[3];
    double intensity = 1;
    get_factor(from, KEY(AI_MATKEY_EMISSIVE_INTENSITY), &intensity);
    if (get_color(from, KEY(AI_MATKEY_COLOR_EMISSIVE), c)) {
        /* In older formats, emission mostly brightens lit surfaces: the two were summed on the
         * screen. Only a surface that emits more than it reflects is a light. */
        double diffuse[4] = {0, 0, 0, 1};
        if (!linear && get_color(from, KEY(AI_MATKEY_COLOR_DIFFUSE), diffuse) &&
            fmax(c[0], fmax(c[1], c[2])) <= fmax(diffuse[0], fmax(diffuse[1], diffuse[2]))) {
            for (int i = 0; i < 3; i++) {
                to->base_color[i] = masu_import_clamped(
                    masu_import_decode_srgb((double)masu_import_clamped(c[i] + diffuse[i], 0, 1)),
                    0, 1);
            }
            return;
        }
        for (int i = 0; i < 3; i++) {
            double value =
                linear ? c[i] : masu_import_decode_srgb((double)masu_import_clamped(c[i], 0, 1));
            to->emissive[i] = masu_import_clamped(value * intensity, 0, 65504);
        }
    }
}

static void convert_shine(const struct aiMaterial *from, masu_blob_material *to) {
    double value;
    to->roughness = 1;
    if (get_factor(from, KEY(AI_MATKEY_ROUGHNESS_FACTOR), &value)) {
        to->roughness = masu_import_clamped(value, 0, 1);
    } else if (get_factor(from, KEY(AI_MATKEY_GLOSSINESS_FACTOR), &value)) {
        to->roughness = masu_import_clamped(1 - value, 0, 1);
    } else if (get_factor(from, KEY(AI_MATKEY_SHININESS), &value)) {
        double exponent = (double)masu_import_clamped(value, 0, 1e9);
        to->roughness = masu_import_clamped(pow(2 / (exponent + 2), 0.25), 0, 1);
    }
    to->metallic = 0;
    if (get_factor(from, KEY(AI_MATKEY_METALLIC_FACTOR), &value)) {
        to->metallic = masu_import_clamped(value, 0, 1);
    }
    if (get_factor(from, KEY(AI_MATKEY_CLEARCOAT_FACTOR), &value))
        to->coat = masu_import_clamped(value, 0, 1);
    if (to->coat > 0 && get_factor(from, KEY(AI_MATKEY_CLEARCOAT_ROUGHNESS_FACTOR), &value)) {
        to->coat_roughness = masu_import_clamped(value, 0, 1);
    }
}

/* True if a highlight of an older format loses its colour; its exponent becomes the roughness.
 * Materials that Assimp adds, with no name or with this one, have a specular colour too. */
static bool has_phong(const struct aiMaterial *from) {
    double c[4] = {0, 0, 0, 0}, value;
    struct aiString name = {0};
    aiGetMaterialString(from, AI_MATKEY_NAME, &name);
    int length = masu_import_length(&name);
    if (!length) return false;
    if (length == (int)strlen(AI_DEFAULT_MATERIAL_NAME) &&
        memcmp(name.data, AI_DEFAULT_MATERIAL_NAME, strlen(AI_DEFAULT_MATERIAL_NAME)) == 0)
        return false;
    if (get_factor(from, KEY(AI_MATKEY_ROUGHNESS_FACTOR), &value) ||
        get_factor(from, KEY(AI_MATKEY_GLOSSINESS_FACTOR), &value))
        return false;
    get_color(from, KEY(AI_MATKEY_COLOR_SPECULAR), c);
    return c[0] > 0 || c[1] > 0 || c[2] > 0;
}

const masu_import_given *masu_import_read_material(masu_import *m, unsigned index) {
    const struct aiScene *s = m->source;
    if (m->given) return &m->given[index];
    if (index >= s->mNumMaterials || !s->mMaterials || !s->mMaterials[index])
        index = s->mNumMaterials;
    if (m->material[index]) return m->material[index];
    masu_import_given *made = m->material[index] = masu_bake_allocate(sizeof *made);
    *made = (masu_import_given){masu_bake_default_material(), masu_bake_no_maps(), ""};
    if (index == s->mNumMaterials) return made;
    masu_blob_material *to = &made->material;
    const struct aiMaterial *from = s->mMaterials[index];
    double alpha = 1, opacity = 1;
    convert_color(from, to, &alpha);
    convert_shine(from, to);
    m->phong += has_phong(from);
    get_factor(from, KEY(AI_MATKEY_OPACITY), &opacity);
    /* Many Collada and 3DS files have 0 for opaque surfaces. */
    if (opacity <= 0 || alpha <= 0) {
        m->invisible++;
        opacity = opacity <= 0 ? 1 : opacity;
        alpha = alpha <= 0 ? 1 : alpha;
    }
    made->maps = convert_maps(m, from);
    /* Some formats store one number under two names, so the product would be wrong. */
    alpha = alpha < opacity ? alpha : opacity;
    if (made->maps.alpha != MASU_BAKE_ALPHA_OPAQUE && made->maps.alpha != MASU_BAKE_ALPHA_MASK &&
        alpha < 0.999) {
        made->maps.alpha = MASU_BAKE_ALPHA_BLEND;
        to->opacity = masu_import_clamped(alpha, 0, 1);
    }
    note_textures(m, from);
    struct aiString name = {0};
    aiGetMaterialString(from, AI_MATKEY_NAME, &name);
    size_t length = (size_t)masu_import_length(&name);
    char *text = masu_bake_allocate(length + 1);
    memcpy(text, name.data, length);
    text[length] = '\0';
    made->name = text;
    return made;
}

uint32_t masu_import_material(masu_import *m, unsigned index, const double *color, bool colored) {
    const masu_import_given *from = masu_import_read_material(m, index);
    masu_blob_material to = from->material;
    /* The file has no material: its colours are the only data. */
    bool none =
        (color || (colored && !m->given)) && strcmp(from->name, AI_DEFAULT_MATERIAL_NAME) == 0;
    masu_bake_maps maps = from->maps;
    for (int k = 0; k < 3 && (color || none); k++)
        to.base_color[k] = masu_import_clamped(
            (none ? 1 : (double)to.base_color[k]) * (color ? color[k] : 1), 0, 1);
    if (colored && !maps.colored) maps.colored = MASU_BAKE_COLORED;
    return masu_bake_mapped_material(m->piece, &to, &maps, from->name);
}

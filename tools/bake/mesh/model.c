/* model.c: Assimp's picture of a model becomes ours. Runs in a child process.
 *
 *   aiMesh      -> one or more primitives (mesh.c filters and welds)
 *   aiNode with meshes -> an instance; nodes that show the same set of meshes share one masu mesh
 *   aiLight, of glTF (KHR_lights_punctual) -> a light of the nearest node above that is an instance
 *   aiMaterial  -> factors and names of pictures, which bake/texture/texture.c reads. glTF factors are linear; the colours of older formats (OBJ, AC3D)
 *                  were chosen on a screen and are decoded from sRGB. A specular exponent n becomes
 *                  the roughness (2 / (n + 2))^(1/4), at which GGX has the same lobe width.
 *
 * Nothing that Assimp returns is believed: indices, counts of faces, strings and transforms are
 * checked here, and what cannot be shown is counted and named in a warning. */
#define _POSIX_C_SOURCE 200809L
#include "bake/scene/file.h"
#include "bake/scene/import.h"

#include <assimp/cimport.h>
#include <assimp/config.h>
#include <assimp/GltfMaterial.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Edges sharper than this stay sharp where normals have to be made. */
#define CREASE_DEGREES 60.0f
/* More nodes than any model has; a cycle among nodes ends here too. */
#define NODES_MAX 4000000u
#define ACC_MAX ((size_t)512 << 20)
#define LIGHTS_MAX 4096u /* looked for among the nodes */
#define NAMES_MAX 4 /* in one warning; the rest is counted */

typedef struct range {
    uint32_t first, count;
} range;

/* A set of aiMeshes that some node shows, and the masu mesh made for it. */
typedef struct group {
    const unsigned *meshes;
    unsigned count;
    uint32_t mesh;
    struct group *next; /* another set with the same first mesh */
} group;

/* What mesh.c could not use, over all meshes. */
enum { LOST_INDEX, LOST_POSITION, LOST_AREA, LOST_NORMAL, LOST_TEXCOORD, LOSSES };

typedef struct loss {
    uint64_t count;
    uint32_t meshes;
    masu_bake_buffer names; /* of the first few */
} loss;

typedef struct model {
    const struct aiScene *source;
    const char *path;
    masu_bake_textures wanted;
    masu_bake_content *piece;
    masu_bake_buffer *warnings;
    masu_blob_primitive *parts; /* primitives as converted, before meshes group them */
    range *mesh_parts;          /* by aiMesh: its range of parts */
    bool *mesh_done, *mesh_used;
    group **groups;     /* by aiMesh: sets that begin with it */
    uint32_t *material; /* by aiMaterial: index + 1, 0: not converted */
    masu_bake_buffer textures;
    loss losses[LOSSES];
    uint64_t triangles;
    uint32_t texture_count, bad_nodes, skins, unmapped, turned;
    uint32_t other_lights; /* neither points nor spots, or of no use */
    bool full, gltf;
} model;

static void append_format(masu_bake_buffer *buffer, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (length > 0) masu_bake_append_text(buffer, text);
}

static int string_length(const struct aiString *s) {
    size_t most = s->length < sizeof s->data ? s->length : sizeof s->data;
    return (int)strnlen(s->data, most);
}

/* Names end up in lines of text: a line break in one must not start another. */
static void append_name(masu_bake_buffer *buffer, const char *text, int length) {
    size_t from = buffer->bytes;
    masu_bake_append(buffer, text, (size_t)length);
    for (size_t i = from; i < buffer->bytes; i++) {
        if (buffer->data[i] < 0x20) buffer->data[i] = '?';
    }
}

/* ---- materials ---- */

static float clamped(double value, double low, double high) {
    if (!(value >= low)) value = low; /* NaN too */
    return (float)(value > high ? high : value) + 0.0f;
}

static double decode_srgb(double c) {
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
#define KEY_OF(key, type, index) key /* and type and index are 0 for all of these */

/* ---- textures ---- */

/* The picture at `path`: "*3" or a name that the file embeds, else a file beside the model. */
static uint32_t image_of(model *m, const struct aiString *path) {
    char text[sizeof path->data + 1];
    int length = string_length(path);
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
        if (t && string_length(&t->mFilename) == length && length &&
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
        append_format(&name, "%s:%ld", m->path, number);
        data = t->pcData;
        about.data_bytes = t->mWidth;
        if (t->mHeight && t->mWidth <= 16384 && t->mHeight <= 16384) {
            about.raw_width = t->mWidth;
            about.raw_height = t->mHeight;
            about.data_bytes = (uint64_t)t->mWidth * t->mHeight * 4;
        }
        if (about.data_bytes > (uint64_t)1 << 30) about.data_bytes = 0;
    } else {
        for (char *c = text; *c; c++) {
            if (*c == '\\') *c = '/'; /* written where that was the separator */
        }
        if (text[0] != '/') {
            const char *slash = strrchr(m->path, '/');
            if (slash) masu_bake_append(&name, m->path, (size_t)(slash - m->path) + 1);
        }
        const char *from = text;
        while (strncmp(from, "./", 2) == 0) from += 2;
        masu_bake_append_text(&name, from);
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

static bool take_map(model *m, const struct aiMaterial *from, const map_request *wanted,
                     masu_bake_maps *to) {
    struct aiString path = {0};
    if (to->image[wanted->map] != MASU_BLOB_NONE ||
        aiGetMaterialTextureCount(from, wanted->type) == 0 ||
        aiGetMaterialTexture(from, wanted->type, 0, &path, NULL, NULL, NULL, NULL, NULL, NULL) !=
            aiReturn_SUCCESS ||
        string_length(&path) == 0) {
        return false;
    }
    if (!masu_bake_has_maps(to)) { /* the first one speaks for all */
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
           string_length(&x) == string_length(&y) &&
           memcmp(x.data, y.data, (size_t)string_length(&x)) == 0;
}

static void convert_alpha(const struct aiMaterial *from, masu_bake_maps *maps) {
    struct aiString mode = {0};
    double cutoff = 0.5;
    if (aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS) {
        mode.data[string_length(&mode) < (int)sizeof mode.data ? string_length(&mode)
                                                               : (int)sizeof mode.data - 1] = 0;
        maps->alpha = strcmp(mode.data, "MASK") == 0    ? MASU_BAKE_ALPHA_MASK
                      : strcmp(mode.data, "BLEND") == 0 ? MASU_BAKE_ALPHA_BLEND
                                                        : MASU_BAKE_ALPHA_OPAQUE;
    }
    if (get_factor(from, KEY(AI_MATKEY_GLTF_ALPHACUTOFF), &cutoff)) {
        maps->cutoff = clamped(cutoff, 0, 1);
    }
}

static masu_bake_maps convert_maps(model *m, const struct aiMaterial *from) {
    static const map_request requests[] = {
        {MASU_BAKE_BASE, aiTextureType_BASE_COLOR, 0},
        {MASU_BAKE_BASE, aiTextureType_DIFFUSE, 0},
        {MASU_BAKE_NORMAL, aiTextureType_NORMALS, 0},
        {MASU_BAKE_NORMAL, aiTextureType_NORMAL_CAMERA, 0},
        {MASU_BAKE_EMISSIVE, aiTextureType_EMISSIVE, 0},
        {MASU_BAKE_EMISSIVE, aiTextureType_EMISSION_COLOR, 0},
        {MASU_BAKE_OPACITY, aiTextureType_OPACITY, 0},
        {MASU_BAKE_OCCLUSION, aiTextureType_AMBIENT_OCCLUSION, 0},
    };
    /* glTF has both in one picture: green and blue. */
    static const map_request packed[] = {{MASU_BAKE_ROUGHNESS, aiTextureType_UNKNOWN, 1},
                                         {MASU_BAKE_METALLIC, aiTextureType_UNKNOWN, 2},
                                         {MASU_BAKE_ROUGHNESS, aiTextureType_DIFFUSE_ROUGHNESS, 1},
                                         {MASU_BAKE_METALLIC, aiTextureType_METALNESS, 2}};
    static const map_request apart[] = {{MASU_BAKE_ROUGHNESS, aiTextureType_DIFFUSE_ROUGHNESS, 0},
                                        {MASU_BAKE_METALLIC, aiTextureType_METALNESS, 0}};
    masu_bake_maps maps = masu_bake_no_maps();
    if (m->wanted == MASU_BAKE_TEXTURES_OFF) return maps;
    convert_alpha(from, &maps);
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
        take_map(m, from, &requests[i], &maps);
    }
    struct aiString mode = {0};
    bool gltf = aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS;
    if (gltf || same_texture(from, aiTextureType_DIFFUSE_ROUGHNESS, aiTextureType_METALNESS)) {
        for (size_t i = 0; i < 4; i++) take_map(m, from, &packed[i], &maps);
        /* What Assimp calls a light map is glTF's occlusion; of other formats it is baked light. */
        static const map_request lightmap = {MASU_BAKE_OCCLUSION, aiTextureType_LIGHTMAP, 0};
        if (gltf) take_map(m, from, &lightmap, &maps);
    } else {
        for (size_t i = 0; i < 2; i++) take_map(m, from, &apart[i], &maps);
    }
    double scale = 1;
    ai_real value = 0;
    unsigned count = 1;
    if (aiGetMaterialFloatArray(from, _AI_MATKEY_GLTF_SCALE_BASE, aiTextureType_NORMALS, 0, &value,
                                &count) == aiReturn_SUCCESS &&
        count == 1) {
        scale = (double)value;
    }
    maps.normal_scale = clamped(scale, -16, 16);
    return maps;
}

/* Types of texture that nothing is made of. */
static bool is_used(int type) {
    switch (type) {
    case aiTextureType_BASE_COLOR:
    case aiTextureType_DIFFUSE:
    case aiTextureType_NORMALS:
    case aiTextureType_NORMAL_CAMERA:
    case aiTextureType_EMISSIVE:
    case aiTextureType_EMISSION_COLOR:
    case aiTextureType_OPACITY:
    case aiTextureType_AMBIENT_OCCLUSION:
    case aiTextureType_UNKNOWN:
    case aiTextureType_DIFFUSE_ROUGHNESS:
    case aiTextureType_METALNESS:
    case aiTextureType_LIGHTMAP: return true;
    default: return false;
    }
}

static void note_textures(model *m, const struct aiMaterial *material) {
    for (int type = 1; type <= AI_TEXTURE_TYPE_MAX; type++) {
        unsigned count = aiGetMaterialTextureCount(material, (enum aiTextureType)type);
        if (is_used(type) && m->wanted != MASU_BAKE_TEXTURES_OFF) continue;
        for (unsigned i = 0; i < count && i < 16; i++) {
            struct aiString path = {0};
            if (aiGetMaterialTexture(material, (enum aiTextureType)type, i, &path, NULL, NULL, NULL,
                                     NULL, NULL, NULL) != aiReturn_SUCCESS) {
                continue;
            }
            int length = string_length(&path);
            int skip = length > 60 ? length - 60 : 0; /* the end of a path says most */
            masu_bake_buffer name = {0};
            masu_bake_append_text(&name, skip ? "..." : "");
            append_name(&name, path.data + skip, length - skip);
            masu_bake_append(&name, ", ", 3);
            masu_bake_append(&m->textures, "", 1);
            m->textures.bytes--;
            if (!strstr((const char *)m->textures.data, (const char *)name.data) &&
                m->texture_count++ < NAMES_MAX) {
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
        linear = true; /* glTF's specular-glossiness extension keeps its colour there */
    }
    bool found = linear || get_color(from, KEY(AI_MATKEY_COLOR_DIFFUSE), c);
    for (int i = 0; found && i < 3; i++) {
        double value = (double)clamped(c[i], 0, 1);
        to->base_color[i] = clamped(linear ? value : decode_srgb(value), 0, 1);
    }
    if (found) *alpha = c[3];
    double intensity = 1;
    get_factor(from, KEY(AI_MATKEY_EMISSIVE_INTENSITY), &intensity);
    if (get_color(from, KEY(AI_MATKEY_COLOR_EMISSIVE), c)) {
        /* In older formats emission is mostly a way to brighten what is lit: the two were summed on the
         * screen. Only what emits more than it reflects is a light. */
        double diffuse[4] = {0, 0, 0, 1};
        if (!linear && get_color(from, KEY(AI_MATKEY_COLOR_DIFFUSE), diffuse) &&
            fmax(c[0], fmax(c[1], c[2])) <= fmax(diffuse[0], fmax(diffuse[1], diffuse[2]))) {
            for (int i = 0; i < 3; i++) {
                to->base_color[i] =
                    clamped(decode_srgb((double)clamped(c[i] + diffuse[i], 0, 1)), 0, 1);
            }
            return;
        }
        for (int i = 0; i < 3; i++) {
            double value = linear ? c[i] : decode_srgb((double)clamped(c[i], 0, 1));
            to->emissive[i] = clamped(value * intensity, 0, 65504);
        }
    }
}

static bool is_gltf(const struct aiMaterial *from) {
    struct aiString mode;
    return aiGetMaterialString(from, AI_MATKEY_GLTF_ALPHAMODE, &mode) == aiReturn_SUCCESS;
}

static void convert_shine(const struct aiMaterial *from, masu_blob_material *to) {
    double value;
    to->roughness = 1;
    if (get_factor(from, KEY(AI_MATKEY_ROUGHNESS_FACTOR), &value)) {
        to->roughness = clamped(value, 0, 1);
    } else if (get_factor(from, KEY(AI_MATKEY_GLOSSINESS_FACTOR), &value)) {
        to->roughness = clamped(1 - value, 0, 1);
    } else if (get_factor(from, KEY(AI_MATKEY_SHININESS), &value)) {
        double exponent = (double)clamped(value, 0, 1e9);
        to->roughness = clamped(pow(2 / (exponent + 2), 0.25), 0, 1);
    }
    to->metallic = 0;
    if (get_factor(from, KEY(AI_MATKEY_METALLIC_FACTOR), &value)) {
        to->metallic = clamped(value, 0, 1);
    }
    if (get_factor(from, KEY(AI_MATKEY_CLEARCOAT_FACTOR), &value)) to->coat = clamped(value, 0, 1);
    if (to->coat > 0 && get_factor(from, KEY(AI_MATKEY_CLEARCOAT_ROUGHNESS_FACTOR), &value)) {
        to->coat_roughness = clamped(value, 0, 1);
    }
    /* glTF's KHR_materials_specular: a share of the usual reflectance. What has a glossiness too is of the
     * older extension, and means a colour. */
    if (get_factor(from, KEY(AI_MATKEY_SPECULAR_FACTOR), &value) && is_gltf(from) &&
        !get_factor(from, KEY(AI_MATKEY_GLOSSINESS_FACTOR), &(double){0})) {
        to->specular = clamped(0.5 * value, 0, 1);
    }
}

static uint32_t material_of(model *m, unsigned index) {
    masu_blob_material to = masu_bake_default_material();
    const struct aiScene *s = m->source;
    if (index >= s->mNumMaterials || !s->mMaterials || !s->mMaterials[index]) {
        return masu_bake_material(m->piece, &to, "");
    }
    if (m->material[index]) return m->material[index] - 1;
    const struct aiMaterial *from = s->mMaterials[index];
    double alpha = 1, opacity = 1;
    convert_color(from, &to, &alpha);
    convert_shine(from, &to);
    get_factor(from, KEY(AI_MATKEY_OPACITY), &opacity);
    masu_bake_maps maps = convert_maps(m, from);
    /* One number under two names in some formats, so not their product. */
    alpha = alpha < opacity ? alpha : opacity;
    if (maps.alpha != MASU_BAKE_ALPHA_OPAQUE && maps.alpha != MASU_BAKE_ALPHA_MASK && alpha < 0.999) {
        maps.alpha = MASU_BAKE_ALPHA_BLEND;
        to.opacity = clamped(alpha, 0, 1);
    }
    note_textures(m, from);
    struct aiString name = {0};
    aiGetMaterialString(from, AI_MATKEY_NAME, &name);
    name.data[string_length(&name) < (int)sizeof name.data ? string_length(&name)
                                                           : (int)sizeof name.data - 1] = '\0';
    uint32_t result = masu_bake_mapped_material(m->piece, &to, &maps, name.data);
    m->material[index] = result + 1;
    return result;
}

/* ---- meshes ---- */

static void note_loss(model *m, int kind, uint64_t count, const struct aiMesh *mesh) {
    loss *l = &m->losses[kind];
    if (count == 0) return;
    l->count += count;
    if (l->meshes++ >= NAMES_MAX) return;
    masu_bake_append_text(&l->names, l->meshes > 1 ? ", \"" : "\"");
    append_name(&l->names, mesh->mName.data, string_length(&mesh->mName));
    masu_bake_append_text(&l->names, "\"");
}

static void note_losses(model *m, const struct aiMesh *mesh, const masu_bake_losses *lost) {
    m->triangles += lost->triangles;
    note_loss(m, LOST_INDEX, lost->bad_index, mesh);
    note_loss(m, LOST_POSITION, lost->bad_position, mesh);
    note_loss(m, LOST_AREA, lost->degenerate, mesh);
    note_loss(m, LOST_NORMAL, lost->bad_normals, mesh);
    note_loss(m, LOST_TEXCOORD, lost->bad_texcoords, mesh);
}

static void report_losses(model *m) {
    static const char *const what[LOSSES] = {
        [LOST_INDEX] = "triangles left out, an index is out of range",
        [LOST_POSITION] = "triangles left out, a vertex is not finite",
        [LOST_AREA] = "triangles left out, they have no area",
        [LOST_NORMAL] = "normals made new, they were not usable",
        [LOST_TEXCOORD] = "texture coordinates set to 0, they were not finite or beyond 16384",
    };
    for (int kind = 0; kind < LOSSES; kind++) {
        loss *l = &m->losses[kind];
        if (l->count == 0) continue;
        masu_bake_append(&l->names, "", 1);
        append_format(m->warnings, "%llu ", (unsigned long long)l->count);
        if (kind != LOST_NORMAL && kind != LOST_TEXCOORD) {
            append_format(m->warnings, "of %llu ", (unsigned long long)m->triangles);
        }
        append_format(m->warnings, "%s (in %u meshes: ", what[kind], l->meshes);
        masu_bake_append_text(m->warnings, (const char *)l->names.data);
        masu_bake_append_text(m->warnings, l->meshes > NAMES_MAX ? ", ...)\n" : ")\n");
        masu_bake_release(&l->names);
    }
}

/* KHR_texture_transform and its like: scale, then move; turns are warned of. Assimp's v grows
 * upwards. */
static bool texture_transform(const model *m, const struct aiMesh *mesh,
                              struct aiUVTransform *out) {
    const struct aiScene *s = m->source;
    if (mesh->mMaterialIndex >= s->mNumMaterials || !s->mMaterials[mesh->mMaterialIndex]) {
        return false;
    }
    static const enum aiTextureType types[] = {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE};
    for (int i = 0; i < 2; i++) {
        if (aiGetMaterialUVTransform(s->mMaterials[mesh->mMaterialIndex],
                                     AI_MATKEY_UVTRANSFORM(types[i], 0), out) == aiReturn_SUCCESS) {
            return true;
        }
    }
    return false;
}

/* Two floats per vertex, v down the picture, of the channel that the base colour uses; NULL if the
 * mesh has none. free() it. */
static float *texcoords_of(model *m, const struct aiMesh *mesh) {
    const struct aiScene *s = m->source;
    int channel = 0;
    unsigned count = 1;
    if (mesh->mMaterialIndex < s->mNumMaterials && s->mMaterials[mesh->mMaterialIndex]) {
        aiGetMaterialIntegerArray(s->mMaterials[mesh->mMaterialIndex],
                                  AI_MATKEY_UVWSRC(aiTextureType_BASE_COLOR, 0), &channel, &count);
    }
    if (channel < 0 || channel >= AI_MAX_NUMBER_OF_TEXTURECOORDS ||
        !mesh->mTextureCoords[channel]) {
        channel = 0;
    }
    const struct aiVector3D *from = mesh->mTextureCoords[channel];
    if (!from) {
        m->unmapped++;
        return NULL;
    }
    struct aiUVTransform transform;
    bool moved = texture_transform(m, mesh, &transform);
    if (moved && transform.mRotation != 0) m->turned++;
    float *out = masu_bake_allocate((size_t)mesh->mNumVertices * 2 * sizeof *out);
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        double u = (double)from[i].x, v = (double)from[i].y;
        if (moved) {
            u = u * (double)transform.mScaling.x + (double)transform.mTranslation.x;
            v = v * (double)transform.mScaling.y + (double)transform.mTranslation.y;
        }
        out[2 * i] = (float)u;
        out[2 * i + 1] = (float)(1 - v);
    }
    return out;
}

static void convert_mesh(model *m, unsigned index) {
    const struct aiMesh *mesh = m->source->mMeshes[index];
    if (m->mesh_done[index] || !mesh) return;
    m->mesh_done[index] = true;
    m->mesh_parts[index].first = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_PRIMITIVES);
    if (!mesh->mVertices || !mesh->mFaces || mesh->mNumVertices == 0 || m->full) return;
    masu_bake_buffer indices = {0};
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        if (face->mNumIndices != 3 || !face->mIndices) continue; /* points and lines */
        for (int k = 0; k < 3; k++) {
            uint32_t corner = face->mIndices[k];
            masu_bake_append(&indices, &corner, sizeof corner);
        }
    }
    _Static_assert(sizeof(struct aiVector3D) == 3 * sizeof(float), "Assimp built for double");
    uint32_t material = material_of(m, mesh->mMaterialIndex);
    const masu_bake_maps *maps = &MASU_BAKE_MAPS_OF(m->piece)[material];
    float *texcoords = NULL;
    if (m->wanted == MASU_BAKE_TEXTURES_FORCED || masu_bake_has_maps(maps)) {
        texcoords = texcoords_of(m, mesh);
    }
    masu_bake_triangles triangles = {
        .positions = &mesh->mVertices->x,
        .normals = mesh->mNormals ? &mesh->mNormals->x : NULL,
        .vertex_count = mesh->mNumVertices,
        .indices = (const uint32_t *)(const void *)indices.data,
        .index_count = indices.bytes / sizeof(uint32_t),
        .texcoords = texcoords,
        .repeats = !maps->wrap[0] && !maps->wrap[1],
        .material = material,
    };
    masu_bake_losses lost = {0};
    if (!masu_bake_add_triangles(m->piece, &triangles, &lost)) m->full = true;
    masu_bake_release(&indices);
    free(texcoords);
    note_losses(m, mesh, &lost);
    if (mesh->mNumBones) m->skins++;
    m->mesh_parts[index].count =
        (uint32_t)masu_bake_count(m->piece, MASU_BLOB_PRIMITIVES) - m->mesh_parts[index].first;
}

/* ---- nodes ---- */

static bool same_set(const group *g, const unsigned *meshes, unsigned count) {
    return g->count == count && memcmp(g->meshes, meshes, count * sizeof *meshes) == 0;
}

/* The primitives of an aiMesh, once more. Two primitives share no indices (src/scene/check_geometry.c): when a
 * mesh is part of a second set, its indices are copied. */
static void add_parts(model *m, unsigned mesh) {
    masu_bake_buffer *indices = &m->piece->section[MASU_BLOB_INDICES];
    for (uint32_t i = 0; i < m->mesh_parts[mesh].count; i++) {
        masu_blob_primitive part = m->parts[m->mesh_parts[mesh].first + i];
        if (m->mesh_used[mesh]) {
            size_t from = part.first_index * sizeof(uint32_t);
            size_t bytes = part.index_count * sizeof(uint32_t);
            part.first_index = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_INDICES);
            masu_bake_append(indices, NULL, bytes);
            memcpy(indices->data + indices->bytes - bytes, indices->data + from, bytes);
        }
        masu_bake_append(&m->piece->section[MASU_BLOB_PRIMITIVES], &part, sizeof part);
    }
    m->mesh_used[mesh] = true;
}

/* The masu mesh of a set of aiMeshes, or NONE if nothing of it can be drawn. */
static uint32_t mesh_of(model *m, const unsigned *meshes, unsigned count) {
    unsigned total = m->source->mNumMeshes, first = total;
    for (unsigned i = 0; i < count; i++) {
        if (meshes[i] < total && m->mesh_parts[meshes[i]].count && first == total) {
            first = meshes[i];
        }
    }
    if (first == total) return MASU_BLOB_NONE;
    for (const group *g = m->groups[first]; g; g = g->next) {
        if (same_set(g, meshes, count)) return g->mesh;
    }
    uint32_t from = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_PRIMITIVES);
    for (unsigned i = 0; i < count; i++) {
        if (meshes[i] < total) add_parts(m, meshes[i]);
    }
    const struct aiString *name = &m->source->mMeshes[first]->mName;
    group *g = masu_bake_allocate(sizeof *g);
    uint32_t to = (uint32_t)masu_bake_count(m->piece, MASU_BLOB_PRIMITIVES);
    *g = (group){meshes, count, 0, m->groups[first]};
    g->mesh = masu_bake_mesh(m->piece, from, to - from,
                             masu_bake_name(m->piece, name->data, (size_t)string_length(name)));
    m->groups[first] = g;
    return g->mesh;
}

typedef struct visit {
    const struct aiNode *node;
    masu_bake_affine parent; /* to world */
    masu_bake_affine space;  /* to the object space of the parent instance; without one to world */
    uint32_t parent_instance;
} visit;

static masu_bake_affine node_transform(const struct aiNode *node) {
    const struct aiMatrix4x4 *t = &node->mTransformation;
    const ai_real rows[12] = {t->a1, t->a2, t->a3, t->a4, t->b1, t->b2,
                              t->b3, t->b4, t->c1, t->c2, t->c3, t->c4};
    masu_bake_affine a;
    for (int i = 0; i < 12; i++) a.m[i] = (double)rows[i];
    return a;
}

/* glTF gives intensities; a white matt surface has the luminance of the intensity over pi and the
 * squared distance. A range that is not given stays 0 until the factor of the placement is known. */
static bool convert_light(const struct aiLight *from, const struct aiNode *node,
                          const masu_bake_affine *space, masu_blob_light *to) {
    const ai_real color[3] = {from->mColorDiffuse.r, from->mColorDiffuse.g, from->mColorDiffuse.b};
    masu_bake_vec3 own = {(double)from->mPosition.x, (double)from->mPosition.y,
                          (double)from->mPosition.z};
    masu_bake_vec3 ahead = {(double)from->mDirection.x, (double)from->mDirection.y,
                            (double)from->mDirection.z};
    masu_bake_vec3 at = masu_bake_apply(space, own);
    masu_bake_vec3 direction = masu_bake_sub(masu_bake_apply(space, masu_bake_mad(own, ahead, 1)), at);
    if (from->mType != aiLightSource_POINT && from->mType != aiLightSource_SPOT) return false;
    if (!masu_bake_sane(at)) return false;
    to->position[0] = (float)at.x, to->position[1] = (float)at.y, to->position[2] = (float)at.z;
    for (int k = 0; k < 3; k++) to->color[k] = clamped((double)color[k] / MASU_BAKE_PI, 0, 1e9);
    to->radius = 0.01f;
    const struct aiMetadata *about = node->mMetaData;
    for (unsigned i = 0; about && about->mKeys && about->mValues && i < about->mNumProperties; i++) {
        const struct aiMetadataEntry *e = &about->mValues[i];
        if (string_length(&about->mKeys[i]) != 14 || !e->mData ||
            memcmp(about->mKeys[i].data, "PBR_LightRange", 14) != 0) {
            continue;
        }
        if (e->mType == AI_FLOAT) to->range = clamped((double)*(const float *)e->mData, 0, 1e9);
    }
    if (from->mType == aiLightSource_POINT) return true;
    to->type = MASU_LIGHT_SPOT;
    if (!masu_bake_normalize(&direction)) return false;
    to->direction[0] = (float)direction.x;
    to->direction[1] = (float)direction.y;
    to->direction[2] = (float)direction.z;
    to->outer = clamped((double)from->mAngleOuterCone, 0, MASU_BAKE_PI / 2);
    to->inner = clamped((double)from->mAngleInnerCone, 0, (double)to->outer);
    return true;
}

/* Assimp ties a light to the node of its name. */
static void convert_lights(model *m, const struct aiNode *node, const masu_bake_affine *space,
                           uint32_t instance) {
    const struct aiScene *s = m->source;
    int length = string_length(&node->mName);
    if (!m->gltf || !s->mLights || length == 0) return;
    for (unsigned i = 0; i < s->mNumLights && i < LIGHTS_MAX; i++) {
        const struct aiLight *from = s->mLights[i];
        if (!from || string_length(&from->mName) != length ||
            memcmp(from->mName.data, node->mName.data, (size_t)length) != 0) {
            continue;
        }
        masu_blob_light light = {.parent = instance};
        if (!convert_light(from, node, space, &light)) {
            m->other_lights++;
            continue;
        }
        light.name = masu_bake_name(m->piece, from->mName.data, (size_t)length);
        masu_bake_append(&m->piece->section[MASU_BLOB_LIGHTS], &light, sizeof light);
    }
}

/* Depth first with a stack of our own: a deep chain of nodes must not use up the machine's. With
 * `convert`, the meshes of every node are converted; without, instances are made. */
static bool walk(model *m, bool convert) {
    masu_bake_buffer stack = {0};
    visit start = {m->source->mRootNode, masu_bake_identity(), masu_bake_identity(),
                   MASU_BLOB_NONE};
    masu_bake_append(&stack, &start, sizeof start);
    uint32_t visited = 0;
    while (stack.bytes && visited++ < NODES_MAX) {
        visit v;
        stack.bytes -= sizeof v;
        memcpy(&v, stack.data + stack.bytes, sizeof v);
        if (!v.node) continue;
        masu_bake_affine own = node_transform(v.node);
        masu_bake_affine world = masu_bake_multiply(&v.parent, &own);
        masu_bake_affine space = masu_bake_multiply(&v.space, &own);
        uint32_t instance = v.parent_instance;
        const unsigned *meshes = v.node->mMeshes;
        unsigned count = meshes ? v.node->mNumMeshes : 0;
        if (convert) {
            for (unsigned i = 0; i < count; i++) {
                if (meshes[i] < m->source->mNumMeshes) convert_mesh(m, meshes[i]);
            }
        } else {
            uint32_t mesh = count ? mesh_of(m, meshes, count) : MASU_BLOB_NONE;
            if (mesh != MASU_BLOB_NONE) {
                const struct aiString *name = &v.node->mName;
                uint32_t text = masu_bake_name(m->piece, name->data, (size_t)string_length(name));
                uint32_t made = masu_bake_instance(m->piece, &world, mesh, v.parent_instance, text);
                if (made == MASU_BLOB_NONE) {
                    m->bad_nodes++;
                } else {
                    instance = made;
                    space = masu_bake_identity();
                }
            }
            convert_lights(m, v.node, &space, instance);
        }
        unsigned children = v.node->mChildren ? v.node->mNumChildren : 0;
        if (children > NODES_MAX) break;
        for (unsigned i = children; i > 0; i--) { /* reversed: the first child is popped first */
            visit child = {v.node->mChildren[i - 1], world, space, instance};
            masu_bake_append(&stack, &child, sizeof child);
        }
    }
    bool finished = stack.bytes == 0;
    masu_bake_release(&stack);
    return finished;
}

/* A file may hold meshes and no nodes: each is then shown once, where it is. */
static void show_all(model *m) {
    masu_bake_append_text(m->warnings, "no nodes; every mesh is shown once\n");
    unsigned *order = masu_bake_allocate(m->source->mNumMeshes * sizeof *order);
    masu_bake_affine identity = masu_bake_identity();
    for (unsigned i = 0; i < m->source->mNumMeshes; i++) {
        order[i] = i;
        uint32_t mesh = mesh_of(m, &order[i], 1);
        if (mesh != MASU_BLOB_NONE) {
            masu_bake_instance(m->piece, &identity, mesh, MASU_BLOB_NONE, MASU_BLOB_NONE);
        }
    }
    for (unsigned i = 0; i < m->source->mNumMeshes; i++) { /* they point into `order` */
        while (m->groups[i]) {
            group *g = m->groups[i];
            m->groups[i] = g->next;
            free(g);
        }
    }
    free(order);
}

static void report(model *m) {
    masu_bake_buffer *w = m->warnings;
    report_losses(m);
    if (m->bad_nodes) {
        append_format(w, "%u nodes dropped: their transform is not finite\n", m->bad_nodes);
    }
    if (m->texture_count) {
        m->textures.bytes -= 2; /* the last ", " */
        masu_bake_append(&m->textures, "", 1);
        append_format(w, "textures that nothing is made of: %s%s\n", (const char *)m->textures.data,
                      m->texture_count > NAMES_MAX ? ", ..." : "");
    }
    if (m->turned) {
        append_format(w, "%u meshes have textures that are turned: they are not\n", m->turned);
    }
    if (m->unmapped) {
        append_format(w,
                      "%u meshes have textures but no texture coordinates: they get the colour "
                      "of one texel\n",
                      m->unmapped);
    }
    if (m->other_lights) {
        append_format(w, "%u lights are neither points nor spots: there is nothing of them\n",
                      m->other_lights);
    }
    if (m->skins || m->source->mNumAnimations) {
        masu_bake_append_text(w, "animation is not supported, the rest pose is used\n");
    }
}

static void *allocate_zeroed(size_t count, size_t size) {
    void *memory = masu_bake_allocate(count * size);
    memset(memory, 0, count * size);
    return memory;
}

static void convert(model *m, masu_bake_buffer *error) {
    const struct aiScene *s = m->source;
    unsigned meshes = s->mMeshes ? s->mNumMeshes : 0;
    m->mesh_parts = allocate_zeroed(meshes, sizeof *m->mesh_parts);
    m->mesh_done = allocate_zeroed(meshes, sizeof *m->mesh_done);
    m->mesh_used = allocate_zeroed(meshes, sizeof *m->mesh_used);
    m->groups = allocate_zeroed(meshes, sizeof *m->groups);
    m->material = allocate_zeroed(s->mNumMaterials, sizeof *m->material);
    bool finished = true;
    if (s->mRootNode)
        finished = walk(m, true);
    else
        for (unsigned i = 0; i < meshes; i++) convert_mesh(m, i);
    masu_bake_buffer parts = m->piece->section[MASU_BLOB_PRIMITIVES];
    m->piece->section[MASU_BLOB_PRIMITIVES] = (masu_bake_buffer){0};
    m->parts = (masu_blob_primitive *)(void *)parts.data;
    if (!finished) {
        masu_bake_append_text(error, "its nodes form a cycle, or are more than 4 million");
    } else if (m->full) {
        masu_bake_append_text(error, "more than 2^31 - 1 vertices or indices");
    } else if (parts.bytes == 0) {
        masu_bake_append_text(error, "it holds no triangles that could be drawn");
        report_losses(m);
        if (m->warnings->bytes) { /* one line says why */
            masu_bake_append_text(error, "; ");
            const char *end = memchr(m->warnings->data, '\n', m->warnings->bytes);
            size_t length = end ? (size_t)(end - (const char *)m->warnings->data) : 0;
            masu_bake_append(error, m->warnings->data, length);
        }
    } else {
        if (s->mRootNode)
            walk(m, false);
        else
            show_all(m);
        report(m);
        if (masu_bake_count(m->piece, MASU_BLOB_INSTANCES) == 0) {
            masu_bake_append_text(error, "no node shows its meshes with a finite transform");
        }
    }
    masu_bake_release(&parts);
}

/* The library drops some of what is broken before we see it and says so in its log alone. Of its
 * many remarks those are passed on that speak of lost data, each once, a few at most. */
static void note_remark(const char *text, char *user) {
    static const char *const losses[] = {"dropped", "out-of-range", "out of range", "discard"};
    masu_bake_buffer *remarks = (masu_bake_buffer *)(void *)user;
    const char *colon = strstr(text, ": "); /* behind "Warn,  T0" */
    if (strncmp(text, "Warn", 4) != 0 || !colon) return;
    bool lost = false;
    for (size_t i = 0; i < sizeof losses / sizeof losses[0]; i++) {
        lost = lost || strstr(colon, losses[i]);
    }
    int length = (int)strcspn(colon + 2, "\n");
    masu_bake_buffer line = {0};
    masu_bake_append_text(&line, "the importer says: ");
    append_name(&line, colon + 2, length < 200 ? length : 200);
    masu_bake_append(&line, "\n", 2); /* with its NUL */
    masu_bake_append(remarks, "", 1);
    remarks->bytes--;
    if (lost && remarks->bytes < 1000 &&
        !strstr((const char *)remarks->data, (const char *)line.data)) {
        masu_bake_append_text(remarks, (const char *)line.data);
    }
    masu_bake_release(&line);
}

void masu_bake_read_model(const char *path, masu_bake_textures textures, masu_bake_content *piece,
                          masu_bake_buffer *warnings, masu_bake_buffer *error) {
    struct aiPropertyStore *properties = aiCreatePropertyStore();
    if (properties) {
        aiSetImportPropertyFloat(properties, AI_CONFIG_PP_GSN_MAX_SMOOTHING_ANGLE, CREASE_DEGREES);
        aiSetImportPropertyInteger(properties, AI_CONFIG_IMPORT_NO_SKELETON_MESHES, 1);
    }
    /* Welding, dropping bad triangles and the like are done here, where every index is checked:
     * each step of the library is one more that hostile data can break. */
    unsigned flags = aiProcess_Triangulate | aiProcess_GenSmoothNormals;
    struct aiLogStream log = {note_remark, (char *)(void *)warnings};
    aiAttachLogStream(&log);
    const struct aiScene *scene;
    masu_bake_buffer whole = {0}, text = {0};
    if (masu_bake_is_acc(path) && masu_bake_read_file(path, ACC_MAX, &whole)) {
        masu_bake_strip_acc((const char *)whole.data, whole.bytes, &text);
        scene = aiImportFileFromMemoryWithProperties((const char *)text.data, (unsigned)text.bytes,
                                                     flags, "ac", properties);
    } else {
        scene = aiImportFileExWithProperties(path, flags, NULL, properties);
    }
    if (!scene) {
        const char *why = aiGetErrorString();
        masu_bake_append_text(error, why && *why ? why : "the importer gives no reason");
        return; /* this process ends now: nothing is worth releasing */
    }
    const char *dot = strrchr(path, '.');
    model m = {.source = scene,
               .path = path,
               .wanted = textures,
               .piece = piece,
               .gltf = dot && (!strcmp(dot, ".gltf") || !strcmp(dot, ".glb")),
               .warnings = warnings};
    convert(&m, error);
}

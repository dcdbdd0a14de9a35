/* content.c: the arrays of a scene during baking; see content.h. */
#define _POSIX_C_SOURCE 200809L
#include "bake/scene/content.h"

#include "bake/scene/live.h"

#include <stdlib.h>
#include <string.h>

static const uint32_t strides[MASU_BLOB_KIND_COUNT] = {
    [MASU_BLOB_VERTICES] = sizeof(masu_blob_vertex),
    [MASU_BLOB_INDICES] = sizeof(uint32_t),
    [MASU_BLOB_PRIMITIVES] = sizeof(masu_blob_primitive),
    [MASU_BLOB_MESHES] = sizeof(masu_blob_mesh),
    [MASU_BLOB_INSTANCES] = sizeof(masu_blob_instance),
    [MASU_BLOB_MATERIALS] = sizeof(masu_blob_material),
    [MASU_BLOB_CAMERA_KEYS] = sizeof(masu_blob_camera_key),
    [MASU_BLOB_ENVIRONMENT] = sizeof(masu_blob_environment),
    [MASU_BLOB_SDF] = sizeof(masu_blob_sdf),
    [MASU_BLOB_SDF_PARAMS] = sizeof(masu_blob_sdf_param),
    [MASU_BLOB_MARCH_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_CLASSIFY_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_CONE8_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_CONE4_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_UPDATE_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_PLAIN_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_SEED_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_CHECKERBOARD_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_UPDATE_PREVIOUS_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_VELOCITY_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_SILHOUETTES_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_OCCLUSION_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_TRACE_SDF_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_BOUNCE_SDF_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_LOCAL_SHADOW_SPIRV] = sizeof(uint32_t),
    [MASU_BLOB_SHADOW] = sizeof(masu_blob_shadow),
    [MASU_BLOB_SLOTS] = sizeof(float),
    [MASU_BLOB_GROUPS] = sizeof(masu_blob_group),
    [MASU_BLOB_GROUP_ITEMS] = sizeof(uint32_t),
    [MASU_BLOB_LODS] = sizeof(masu_blob_lod),
    [MASU_BLOB_OCCLUDERS] = sizeof(masu_blob_occluder),
    [MASU_BLOB_NAMES] = 1,
    [MASU_BLOB_TEXCOORDS] = 2 * sizeof(float),
    [MASU_BLOB_TEXTURES] = sizeof(masu_blob_texture),
    [MASU_BLOB_TEXTURE_SETS] = sizeof(masu_blob_texture_set),
    [MASU_BLOB_TEXELS] = MASU_BLOB_ALIGN,
    [MASU_BLOB_MESO] = sizeof(masu_blob_meso),
    [MASU_BLOB_LIGHTS] = sizeof(masu_blob_light),
    [MASU_BLOB_PROBES] = sizeof(masu_blob_probes),
    [MASU_BLOB_PROBE_DATA] = sizeof(uint32_t),
    [MASU_BLOB_ENVIRONMENT_MAP] = sizeof(masu_blob_environment_map),
    [MASU_BLOB_ENVIRONMENT_TEXELS] = sizeof(uint32_t),
    [MASU_BLOB_TRACE_NODES] = sizeof(masu_blob_trace_node),
    [MASU_BLOB_TRACE_TRIANGLES] = sizeof(masu_blob_trace_triangle),
    [MASU_BLOB_TRACE_MESHES] = sizeof(masu_blob_trace_mesh),
    [MASU_BLOB_TRACE_INSTANCES] = sizeof(uint32_t),
    [MASU_BLOB_MODELS] = sizeof(masu_blob_model),
    [MASU_BLOB_MODEL_NODES] = sizeof(masu_blob_model_node),
    [MASU_BLOB_CLIPS] = sizeof(masu_blob_clip),
    [MASU_BLOB_CHANNELS] = sizeof(masu_blob_channel),
    [MASU_BLOB_KEYS] = sizeof(masu_blob_key),
    [MASU_BLOB_SKINS] = sizeof(masu_blob_skin),
    [MASU_BLOB_JOINTS] = sizeof(masu_blob_joint),
    [MASU_BLOB_SKIN_VERTICES] = sizeof(masu_blob_skin_vertex),
    [MASU_BLOB_COLORS] = sizeof(uint32_t),
    [MASU_BLOB_TEXCOORDS_1] = 2 * sizeof(float),
    [MASU_BLOB_MORPH_TARGETS] = sizeof(masu_blob_morph_target),
    [MASU_BLOB_MORPH_DELTAS] = sizeof(masu_blob_morph_delta),
    [MASU_BLOB_REFLECTIONS] = sizeof(masu_blob_reflections),
    [MASU_BLOB_TRACE_TEXTURES] = sizeof(masu_blob_trace_texture),
    [MASU_BLOB_TRACE_TEXELS] = sizeof(uint32_t),
};

/* ---- sections ---- */

uint32_t masu_bake_stride(uint32_t kind) { return strides[kind]; }

uint64_t masu_bake_count(const masu_bake_content *content, uint32_t kind) {
    return masu_bake_stride(kind) ? content->section[kind].bytes / masu_bake_stride(kind) : 0;
}

void masu_bake_content_release(masu_bake_content *content) {
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        masu_bake_release(&content->section[kind]);
    }
    masu_bake_release(&content->maps);
    masu_bake_release(&content->images);
    masu_bake_release(&content->image_text);
    masu_bake_release(&content->image_data);
    masu_bake_release(&content->cameras);
    masu_bake_release(&content->suns);
    masu_bake_release(&content->traced);
    masu_bake_release(&content->pictures);
    masu_bake_release(&content->picture_texels);
}

/* ---- attributes of vertices ---- */

/* Extends a section to `count` elements; new ones are filled with `byte`. */
static void pad(masu_bake_content *content, uint32_t kind, uint64_t count, int byte) {
    masu_bake_buffer *section = &content->section[kind];
    size_t bytes = (size_t)count * strides[kind], old = section->bytes;
    if (old >= bytes) return;
    masu_bake_append(section, NULL, bytes - old);
    memset(section->data + old, byte, bytes - old);
}

void masu_bake_pad_attributes(masu_bake_content *content) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_VERTICES);
    if (content->section[MASU_BLOB_COLORS].bytes) pad(content, MASU_BLOB_COLORS, count, 0xFF);
    if (content->section[MASU_BLOB_TEXCOORDS_1].bytes)
        pad(content, MASU_BLOB_TEXCOORDS_1, count, 0);
}

static void set_attributes(masu_bake_content *content, uint64_t vertex,
                           const masu_bake_attributes *a) {
    if (a->color != MASU_BLOB_WHITE) {
        pad(content, MASU_BLOB_COLORS, vertex, 0xFF);
        masu_bake_append(&content->section[MASU_BLOB_COLORS], &a->color, sizeof a->color);
    }
    if (a->texcoord[0] != 0 || a->texcoord[1] != 0) {
        pad(content, MASU_BLOB_TEXCOORDS_1, vertex, 0);
        masu_bake_append(&content->section[MASU_BLOB_TEXCOORDS_1], a->texcoord, sizeof a->texcoord);
    }
}

void masu_bake_add_attributes(masu_bake_content *content, const masu_bake_attributes *attributes) {
    set_attributes(content, masu_bake_count(content, MASU_BLOB_VERTICES) - 1, attributes);
}

masu_bake_attributes masu_bake_attributes_of(const masu_bake_content *content, uint64_t vertex) {
    masu_bake_attributes a = {MASU_BLOB_WHITE, {0, 0}};
    if (vertex < masu_bake_count(content, MASU_BLOB_COLORS))
        a.color = MASU_BAKE_ARRAY(content, MASU_BLOB_COLORS, const uint32_t)[vertex];
    if (vertex < masu_bake_count(content, MASU_BLOB_TEXCOORDS_1))
        memcpy(a.texcoord,
               MASU_BAKE_ARRAY(content, MASU_BLOB_TEXCOORDS_1, const float) + 2 * vertex,
               sizeof a.texcoord);
    return a;
}

void masu_bake_copy_attributes(masu_bake_content *to, const masu_bake_content *from, uint64_t first,
                               uint64_t count) {
    if (!from->section[MASU_BLOB_COLORS].bytes && !from->section[MASU_BLOB_TEXCOORDS_1].bytes)
        return;
    uint64_t at = masu_bake_count(to, MASU_BLOB_VERTICES) - count;
    for (uint64_t i = 0; i < count; i++) {
        masu_bake_attributes a = masu_bake_attributes_of(from, first + i);
        set_attributes(to, at + i, &a);
    }
}

uint32_t masu_bake_encode_color(const float color[4]) {
    uint32_t out = 0;
    for (int k = 0; k < 4; k++) {
        double c = color[k] > 0 ? fmin((double)color[k], 1) : 0; /* NaN: 0 */
        out |= (uint32_t)((k < 3 ? sqrt(c) : c) * 255 + 0.5) << 8 * k;
    }
    return out;
}

/* ---- names ---- */

/* Bytes of the UTF-8 character at `text`, 0 if invalid (including overlong forms and
 * surrogates). */
static size_t utf8_length(const unsigned char *text, size_t left) {
    static const struct {
        unsigned char mask, lead;
        uint32_t least;
    } forms[4] = {{0x80, 0x00, 0}, {0xE0, 0xC0, 0x80}, {0xF0, 0xE0, 0x800}, {0xF8, 0xF0, 0x10000}};
    for (size_t n = 1; n <= 4 && n <= left; n++) {
        if ((text[0] & forms[n - 1].mask) != forms[n - 1].lead) continue;
        uint32_t code = text[0] & (unsigned char)~forms[n - 1].mask;
        for (size_t i = 1; i < n; i++) {
            if ((text[i] & 0xC0) != 0x80) return 0;
            code = code << 6 | (text[i] & 0x3Fu);
        }
        bool surrogate = code >= 0xD800 && code <= 0xDFFF;
        return code >= forms[n - 1].least && code <= 0x10FFFF && !surrogate ? n : 0;
    }
    return 0;
}

uint32_t masu_bake_name(masu_bake_content *content, const char *name, size_t length) {
    masu_bake_buffer *names = &content->section[MASU_BLOB_NAMES];
    const unsigned char *text = (const unsigned char *)name;
    length = strnlen(name, length);
    if (length > MASU_BLOB_NAME_MAX) {
        length = MASU_BLOB_NAME_MAX;
        while (length > 1 && (text[length] & 0xC0) == 0x80) length--; /* not within a character */
        content->names_cut++;
    }
    if (length == 0 || names->bytes + length + 1 >= MASU_BLOB_NONE) return MASU_BLOB_NONE;
    uint32_t offset = (uint32_t)names->bytes;
    unsigned char *out = masu_bake_append(names, name, length);
    masu_bake_append(names, "", 1);
    out = names->data + offset;
    for (size_t i = 0; i < length;) {
        size_t n = utf8_length(text + i, length - i);
        if (n == 0 || (n == 1 && (text[i] < 0x20 || text[i] == 0x7F))) {
            out[i] = '?';
            n = 1;
        }
        i += n;
    }
    return offset;
}

const char *masu_bake_name_text(const masu_bake_content *content, uint32_t name) {
    if (name == MASU_BLOB_NONE) return "";
    return (const char *)content->section[MASU_BLOB_NAMES].data + name;
}

/* ---- materials, meshes, instances ---- */

masu_blob_material masu_bake_default_material(void) {
    return (masu_blob_material){.base_color = {0.6f, 0.6f, 0.6f},
                                .roughness = 0.6f,
                                .name = MASU_BLOB_NONE,
                                .specular = 0.5f,
                                .opacity = 1.0f,
                                .detail = {1.0f, 1.0f},
                                .meso = MASU_BLOB_NONE};
}

masu_bake_maps masu_bake_no_maps(void) {
    masu_bake_maps maps;
    memset(&maps, 0, sizeof maps);
    for (int i = 0; i < MASU_BAKE_MAPS; i++) maps.image[i] = MASU_BLOB_NONE;
    maps.cutoff = 0.5f;
    maps.normal_scale = 1;
    maps.occlusion = 1;
    maps.coat_scale = 1;
    return maps;
}

bool masu_bake_has_maps(const masu_bake_maps *maps) {
    for (int i = 0; i < MASU_BAKE_MAPS; i++) {
        if (maps->image[i] != MASU_BLOB_NONE) return true;
    }
    return false;
}

uint32_t masu_bake_add_image(masu_bake_content *content, const char *name,
                             const masu_bake_image *about, const void *data) {
    size_t count = content->images.bytes / sizeof *about;
    for (size_t i = 0; i < count; i++) {
        const masu_bake_image *other = &MASU_BAKE_IMAGES(content)[i];
        if (strcmp((const char *)content->image_text.data + other->name, name) == 0) {
            return (uint32_t)i;
        }
    }
    masu_bake_image image = {0};
    if (about) image = *about;
    image.name = (uint32_t)content->image_text.bytes;
    image.data = content->image_data.bytes;
    masu_bake_append(&content->image_text, name, strlen(name) + 1);
    if (image.data_bytes) masu_bake_append(&content->image_data, data, (size_t)image.data_bytes);
    masu_bake_append(&content->images, &image, sizeof image);
    return (uint32_t)count;
}

uint32_t masu_bake_material(masu_bake_content *content, const masu_blob_material *material,
                            const char *name) {
    masu_bake_maps none = masu_bake_no_maps();
    return masu_bake_mapped_material(content, material, &none, name);
}

uint32_t masu_bake_mapped_material(masu_bake_content *content, const masu_blob_material *material,
                                   const masu_bake_maps *maps, const char *name) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_MATERIALS);
    masu_blob_material wanted = *material;
    for (uint64_t i = 0; i < count; i++) {
        const masu_blob_material *other = &MASU_BAKE_MATERIALS(content)[i];
        wanted.name = other->name;
        if (memcmp(other, &wanted, sizeof wanted) == 0 &&
            memcmp(&MASU_BAKE_MAPS_OF(content)[i], maps, sizeof *maps) == 0 &&
            strcmp(masu_bake_name_text(content, other->name), name) == 0) {
            return (uint32_t)i;
        }
    }
    wanted.name = masu_bake_name(content, name, strlen(name));
    masu_bake_append(&content->section[MASU_BLOB_MATERIALS], &wanted, sizeof wanted);
    masu_bake_append(&content->maps, maps, sizeof *maps);
    return (uint32_t)count;
}

uint32_t masu_bake_mesh(masu_bake_content *content, uint32_t first_primitive, uint32_t count,
                        uint32_t name) {
    masu_blob_mesh mesh = {
        .first_primitive = first_primitive, .primitive_count = count, .name = name};
    for (uint32_t i = 0; i < count; i++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[first_primitive + i];
        for (int k = 0; k < 3; k++) {
            float low = p->aabb_min[k], high = p->aabb_max[k];
            if (i == 0 || low < mesh.aabb_min[k]) mesh.aabb_min[k] = low;
            if (i == 0 || high > mesh.aabb_max[k]) mesh.aabb_max[k] = high;
        }
    }
    masu_bake_append(&content->section[MASU_BLOB_MESHES], &mesh, sizeof mesh);
    return (uint32_t)(masu_bake_count(content, MASU_BLOB_MESHES) - 1);
}

uint32_t masu_bake_instance(masu_bake_content *content, const masu_bake_affine *transform,
                            uint32_t mesh, uint32_t parent, uint32_t name) {
    if (!masu_bake_affine_sane(transform)) return MASU_BLOB_NONE;
    masu_blob_instance instance = {
        .mesh = mesh, .name = name, .parent = parent, .group = MASU_BLOB_NONE};
    for (int i = 0; i < 12; i++) instance.transform[i] = (float)transform->m[i];
    masu_bake_append(&content->section[MASU_BLOB_INSTANCES], &instance, sizeof instance);
    return (uint32_t)(masu_bake_count(content, MASU_BLOB_INSTANCES) - 1);
}

masu_bake_affine masu_bake_transform(const masu_blob_instance *instance) {
    masu_bake_affine a;
    for (int i = 0; i < 12; i++) a.m[i] = (double)instance->transform[i];
    return a;
}

masu_bake_box masu_bake_bounds(const masu_bake_content *content,
                               const masu_bake_affine *placement) {
    masu_bake_box box = masu_bake_box_empty();
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *instance = &MASU_BAKE_INSTANCES(content)[i];
        const masu_blob_mesh *mesh = &MASU_BAKE_MESHES(content)[instance->mesh];
        masu_bake_affine own = masu_bake_transform(instance);
        masu_bake_affine world = masu_bake_multiply(placement, &own);
        for (uint32_t j = 0; j < mesh->primitive_count; j++) {
            const masu_blob_primitive *p =
                &MASU_BAKE_PRIMITIVES(content)[mesh->first_primitive + j];
            for (uint32_t k = 0; k < p->vertex_count; k++) {
                const float *v = MASU_BAKE_VERTICES(content)[p->first_vertex + k].position;
                masu_bake_box_grow(&box, masu_bake_apply(&world, masu_bake_v3f(v)));
            }
        }
    }
    return box;
}

void masu_bake_sort_instances(masu_bake_content *content) {
    size_t count = (size_t)masu_bake_count(content, MASU_BLOB_INSTANCES);
    size_t meshes = (size_t)masu_bake_count(content, MASU_BLOB_MESHES);
    masu_blob_instance *instances = MASU_BAKE_INSTANCES(content);
    masu_blob_instance *sorted = masu_bake_allocate(count * sizeof *sorted);
    uint32_t *place = masu_bake_allocate(count * sizeof *place);
    size_t *next = masu_bake_allocate((meshes + 1) * sizeof *next);
    memset(next, 0, (meshes + 1) * sizeof *next);
    for (size_t i = 0; i < count; i++) next[instances[i].mesh + 1]++;
    for (size_t m = 0; m < meshes; m++) next[m + 1] += next[m];
    for (size_t i = 0; i < count; i++) place[i] = (uint32_t)next[instances[i].mesh]++;
    for (size_t i = 0; i < count; i++) {
        masu_blob_instance moved = instances[i];
        if (moved.parent != MASU_BLOB_NONE) moved.parent = place[moved.parent];
        sorted[place[i]] = moved;
    }
    if (count) memcpy(instances, sorted, count * sizeof *sorted);
    if (content->traced.bytes) {
        masu_bake_buffer traced = {0};
        masu_bake_append(&traced, NULL, count);
        for (size_t i = 0; i < content->traced.bytes; i++)
            traced.data[place[i]] = content->traced.data[i];
        masu_bake_release(&content->traced);
        content->traced = traced;
    }
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_LIGHTS); i++) {
        masu_blob_light *light = &MASU_BAKE_LIGHTS(content)[i];
        if (light->parent != MASU_BLOB_NONE) light->parent = place[light->parent];
    }
    masu_bake_renumber_models(content, place);
    free(next);
    free(place);
    free(sorted);
}

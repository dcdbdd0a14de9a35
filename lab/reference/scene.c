/* scene.c: see scene.h. */
#include "lab/reference/scene.h"
#include "lab/reference/texture.h"

#include "file_kind.h"
#include "image.h"
#include "masu.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>


static bool out_of_memory(char *error, size_t size) {
    snprintf(error, size, "out of memory for the scene of the reference");
    return false;
}

static bool read_blob(const char *path, ref_blob *blob, char *error, size_t size) {
    masu_scene scene;
    masu_detail detail = {.text = ""};
    if (!masu_file_read(path, (size_t)1 << 32, &blob->bytes, &blob->size, error, size))
        return false;
    if (masu_scene_bind(blob->bytes, blob->size, &scene, &detail)) {
        snprintf(error, size, "%s: %.400s%s", path, detail.text,
                 masu_file_hint(path, blob->bytes, blob->size, MASU_FILE_BLOB));
        return false;
    }
    const masu_blob_header *header = (const void *)blob->bytes;
    const masu_blob_section *table = (const void *)(blob->bytes + sizeof *header);
    for (uint32_t i = 0; i < header->section_count; i++) {
        blob->section[table[i].kind] = blob->bytes + table[i].offset;
        blob->count[table[i].kind] = table[i].count;
    }
    return true;
}

/* ---- Materials ------------------------------------------------------------------------------- */

static const ref_texture *texture_of(ref_scene *s, uint32_t texture, uint32_t layer,
                                     uint32_t *keys) {
    const masu_blob_texture *textures = s->blob.section[MASU_BLOB_TEXTURES];
    for (uint64_t i = 0; i < s->texture_count; i++) {
        if (keys[i] == (texture << 8 | layer)) return &s->textures[i];
    }
    ref_texture *t = &s->textures[s->texture_count];
    if (!ref_texture_decode(&textures[texture], s->blob.section[MASU_BLOB_TEXELS], layer, t))
        return NULL;
    keys[s->texture_count++] = texture << 8 | layer;
    return t;
}

static bool read_materials(ref_scene *s) {
    const masu_blob_material *from = s->blob.section[MASU_BLOB_MATERIALS];
    const masu_blob_texture_set *sets = s->blob.section[MASU_BLOB_TEXTURE_SETS];
    uint64_t count = s->blob.count[MASU_BLOB_MATERIALS];
    uint32_t *keys = calloc(count * MASU_SLOT_COUNT + 1, sizeof *keys);
    s->materials = calloc(count + 1, sizeof *s->materials);
    s->textures = calloc(count * MASU_SLOT_COUNT + 1, sizeof *s->textures);
    bool good = keys && s->materials && s->textures;
    for (uint64_t i = 0; good && i < count; i++) {
        const masu_blob_material *m = &from[i];
        s->materials[i] =
            (ref_material){.flags = m->flags,
                           .base = ref_of(m->base_color),
                           .emissive = ref_of(m->emissive),
                           .roughness = (double)m->roughness,
                           .metallic = (double)m->metallic,
                           .specular = (double)m->specular,
                           .coat = (double)m->coat,
                           .coat_roughness = (double)m->coat_roughness,
                           .opacity = (double)m->opacity,
                           .specular_color = ref_of(m->specular_color),
                           .sheen_color = ref_of(m->sheen_color),
                           .sheen_roughness = (double)m->sheen_roughness,
                           .anisotropy = (double)m->anisotropy,
                           .anisotropy_rotation = (double)m->anisotropy_rotation,
                           .cutoff = (m->flags >> MASU_MATERIAL_CUTOFF_SHIFT & 0xFF) / 255.0,
                           .detail = {(double)m->detail[0], (double)m->detail[1]}};
        s->blends = s->blends || (m->flags & MASU_MATERIAL_IS_BLEND);
        s->masks = s->masks || (m->flags & MASU_MATERIAL_IS_MASK);
        s->meso = s->meso || m->meso != MASU_BLOB_NONE;
        if (!(m->flags & MASU_MATERIAL_HAS_MAPS)) continue;
        const masu_blob_texture_set *set = &sets[m->texture_set];
        memcpy(s->materials[i].wrap, set->wrap, sizeof set->wrap);
        s->materials[i].second = m->more_layers >> 16;
        for (uint32_t slot = 0; good && slot < MASU_SLOT_COUNT; slot++) {
            bool relief = slot == MASU_SLOT_EMISSIVE && !(m->flags & MASU_MATERIAL_IS_BLEND) &&
                          m->flags & MASU_MATERIAL_COAT_RELIEF;
            if (!(m->flags & 1u << slot) && !relief) continue;
            uint32_t layer = slot < 4 ? m->layers >> 8 * slot : m->more_layers >> 8 * (slot - 4);
            s->materials[i].map[slot] = texture_of(s, set->texture[slot], layer & 0xFF, keys);
            good = s->materials[i].map[slot] != NULL;
        }
    }
    free(keys);
    return good;
}

/* ---- Triangles ------------------------------------------------------------------------------- */

static uint8_t *hidden_instances(const ref_blob *b) {
    const masu_blob_model *models = b->section[MASU_BLOB_MODELS];
    const masu_blob_model_node *nodes = b->section[MASU_BLOB_MODEL_NODES];
    uint8_t *hidden = calloc(b->count[MASU_BLOB_INSTANCES] + 1, 1);
    for (uint64_t i = 0; hidden && i < b->count[MASU_BLOB_MODELS]; i++) {
        if (!(models[i].flags & MASU_MODEL_HIDDEN)) continue;
        for (uint32_t n = 0; n < models[i].node_count; n++) {
            uint32_t instance = nodes[models[i].first_node + n].instance;
            if (instance != MASU_BLOB_NONE) hidden[instance] = 1;
        }
    }
    return hidden;
}

static uint32_t skin_of(const ref_blob *b, uint32_t instance) {
    const masu_blob_model_node *nodes = b->section[MASU_BLOB_MODEL_NODES];
    for (uint64_t n = 0; b->count[MASU_BLOB_SKINS] && n < b->count[MASU_BLOB_MODEL_NODES]; n++) {
        if (nodes[n].instance == instance) return nodes[n].skin;
    }
    return 0;
}

static bool add_primitive(ref_scene *s, const masu_blob_primitive *p, const double m[12],
                          const ref_vec *skinned, const ref_vec *skinned_normals,
                          uint32_t skin_first) {
    const masu_blob_vertex *vertices = s->blob.section[MASU_BLOB_VERTICES];
    const uint32_t *indices = s->blob.section[MASU_BLOB_INDICES];
    const float *texcoords = s->blob.section[MASU_BLOB_TEXCOORDS];
    const float *second = s->blob.section[MASU_BLOB_TEXCOORDS_1];
    const uint32_t *colors = s->blob.section[MASU_BLOB_COLORS];
    uint64_t first = s->vertex_count;
    if (first + p->vertex_count > UINT32_MAX) return false;
    for (uint32_t i = 0; i < p->vertex_count; i++) {
        const masu_blob_vertex *v = &vertices[p->first_vertex + i];
        uint64_t at = s->vertex_count++;
        double n[3];
        ref_octahedral(v->normal, n);
        s->positions[at] = skinned ? skinned[p->first_vertex - skin_first + i]
                                   : ref_transform(m, ref_of(v->position));
        s->normals[at] = skinned ? skinned_normals[p->first_vertex - skin_first + i]
                                 : ref_unit(ref_transform_normal(m, ref_v(n[0], n[1], n[2])));
        if (texcoords)
            memcpy(s->texcoords + 2 * at, texcoords + 2 * (size_t)(p->first_vertex + i),
                   2 * sizeof(float));
        if (s->texcoords_1)
            memcpy(s->texcoords_1 + 2 * at, second + 2 * (size_t)(p->first_vertex + i),
                   2 * sizeof(float));
        for (int k = 0; k < 4 && s->colors; k++) {
            float c = (float)(colors[p->first_vertex + i] >> 8 * k & 255u) / 255.0f;
            s->colors[4 * at + (uint64_t)k] = k < 3 ? c * c : c;
        }
    }
    for (uint32_t i = 0; i + 2 < p->index_count; i += 3) {
        ref_triangle *t = &s->triangles[s->triangle_count++];
        for (int k = 0; k < 3; k++)
            t->vertex[k] = (uint32_t)first + indices[p->first_index + i + (uint32_t)k];
        t->material = p->material;
    }
    return true;
}

static bool add_instance(ref_scene *s, uint32_t i, const double m[12], double time, bool animate) {
    const masu_blob_instance *instances = s->blob.section[MASU_BLOB_INSTANCES];
    const masu_blob_mesh *mesh =
        (const masu_blob_mesh *)s->blob.section[MASU_BLOB_MESHES] + instances[i].mesh;
    const masu_blob_primitive *primitives = s->blob.section[MASU_BLOB_PRIMITIVES];
    uint32_t skin = animate ? skin_of(&s->blob, i) : 0, first = 0;
    ref_vec *positions = NULL, *normals = NULL;
    bool good = true;
    if (skin) {
        const masu_blob_skin *k =
            (const masu_blob_skin *)s->blob.section[MASU_BLOB_SKINS] + (skin - 1);
        first = k->first_vertex;
        positions = calloc(k->vertex_count, sizeof *positions);
        normals = calloc(k->vertex_count, sizeof *normals);
        good = positions && normals &&
               ref_pose_skin(&s->blob, skin - 1, time, animate, positions, normals);
    }
    for (uint32_t p = 0; good && p < mesh->primitive_count; p++)
        good =
            add_primitive(s, &primitives[mesh->first_primitive + p], m, positions, normals, first);
    free(positions);
    free(normals);
    return good;
}

static bool read_triangles(ref_scene *s, const double *matrices, double time, bool animate) {
    const masu_blob_instance *instances = s->blob.section[MASU_BLOB_INSTANCES];
    const masu_blob_mesh *meshes = s->blob.section[MASU_BLOB_MESHES];
    const masu_blob_primitive *primitives = s->blob.section[MASU_BLOB_PRIMITIVES];
    uint64_t count = s->blob.count[MASU_BLOB_INSTANCES], vertices = 0, triangles = 0;
    uint8_t *hidden = hidden_instances(&s->blob);
    bool good = hidden != NULL;
    for (uint64_t i = 0; good && i < count; i++) {
        const masu_blob_mesh *mesh = &meshes[instances[i].mesh];
        for (uint32_t p = 0; !hidden[i] && p < mesh->primitive_count; p++) {
            vertices += primitives[mesh->first_primitive + p].vertex_count;
            triangles += primitives[mesh->first_primitive + p].index_count / 3;
        }
    }
    if (good) {
        s->positions = calloc(vertices + 1, sizeof *s->positions);
        s->normals = calloc(vertices + 1, sizeof *s->normals);
        s->triangles = calloc(triangles + 1, sizeof *s->triangles);
        if (s->blob.section[MASU_BLOB_TEXCOORDS])
            s->texcoords = calloc(vertices + 1, 2 * sizeof *s->texcoords);
        if (s->blob.section[MASU_BLOB_TEXCOORDS_1])
            s->texcoords_1 = calloc(vertices + 1, 2 * sizeof *s->texcoords_1);
        if (s->blob.section[MASU_BLOB_COLORS])
            s->colors = calloc(vertices + 1, 4 * sizeof *s->colors);
        good = s->positions && s->normals && s->triangles &&
               !s->texcoords_1 == !s->blob.section[MASU_BLOB_TEXCOORDS_1] &&
               !s->colors == !s->blob.section[MASU_BLOB_COLORS] &&
               (s->texcoords || !s->blob.section[MASU_BLOB_TEXCOORDS]);
    }
    for (uint64_t i = 0; good && i < count; i++) {
        if (!hidden[i]) good = add_instance(s, (uint32_t)i, matrices + 12 * i, time, animate);
    }
    free(hidden);
    return good;
}

/* ---- Lights ---------------------------------------------------------------------------------- */

static bool read_lights(ref_scene *s, const double *matrices) {
    const masu_blob_light *from = s->blob.section[MASU_BLOB_LIGHTS];
    uint8_t *hidden = hidden_instances(&s->blob);
    s->lights = calloc(s->blob.count[MASU_BLOB_LIGHTS] + 1, sizeof *s->lights);
    for (uint64_t i = 0; s->lights && hidden && i < s->blob.count[MASU_BLOB_LIGHTS]; i++) {
        uint32_t type = from[i].type & MASU_LIGHT_TYPE;
        bool spot = type == MASU_LIGHT_SPOT;
        if (from[i].parent != MASU_BLOB_NONE && hidden[from[i].parent]) continue;
        ref_light *l = &s->lights[s->light_count++];
        *l = (ref_light){ref_of(from[i].position),         ref_of(from[i].color),
                         ref_of(from[i].direction),        (double)from[i].range,
                         (double)from[i].radius,           (double)from[i].inner,
                         spot ? (double)from[i].outer : -1,
                         type,
                         ref_of(from[i].half_axis),
                         (from[i].type & MASU_LIGHT_TWO_SIDED) != 0,
                         (from[i].type & MASU_LIGHT_SURFACE) != 0};
        if (from[i].parent == MASU_BLOB_NONE) continue;
        const double *m = matrices + 12 * (size_t)from[i].parent;
        l->position = ref_transform(m, l->position);
        l->direction = ref_transform_direction(m, l->direction);
        if (spot) l->direction = ref_unit(l->direction);
        l->half_axis = ref_transform_direction(m, l->half_axis);
    }
    bool good = s->lights && hidden;
    free(hidden);
    return good;
}

/* Weighs triangles by their emitted light; an emission map is treated as white. */
static bool read_emitters(ref_scene *s) {
    double sum = 0;
    s->emitter_pdf = calloc(s->triangle_count + 1, sizeof *s->emitter_pdf);
    if (!s->emitter_pdf) return false;
    for (uint64_t i = 0; i < s->triangle_count; i++)
        s->emitter_count += ref_max(s->materials[s->triangles[i].material].emissive) > 0;
    s->emitters = calloc(s->emitter_count + 1, sizeof *s->emitters);
    if (!s->emitters) return false;
    s->emitter_count = 0;
    for (uint64_t i = 0; i < s->triangle_count; i++) {
        const ref_triangle *t = &s->triangles[i];
        double power = ref_luminance(s->materials[t->material].emissive);
        ref_vec a = s->positions[t->vertex[0]];
        ref_vec cross = ref_cross(ref_sub(s->positions[t->vertex[1]], a),
                                  ref_sub(s->positions[t->vertex[2]], a));
        double area = 0.5 * ref_length(cross);
        if (!(power > 0) || !(area > 0)) continue;
        sum += power * area;
        s->emitter_pdf[i] = power;
        s->emitters[s->emitter_count++] = (ref_emitter){(uint32_t)i, area, sum};
    }
    for (uint32_t i = 0; i < s->emitter_count; i++) {
        s->emitters[i].cumulative /= sum;
        s->emitter_pdf[s->emitters[i].triangle] /= sum;
    }
    return true;
}

bool ref_scene_open(const char *path, double time, bool animate, ref_scene *s, char *error,
                    size_t size) {
    memset(s, 0, sizeof *s);
    if (!read_blob(path, &s->blob, error, size)) return false;
    s->environment = s->blob.section[MASU_BLOB_ENVIRONMENT];
    s->shadow = s->blob.section[MASU_BLOB_SHADOW];
    s->reflections = s->blob.section[MASU_BLOB_REFLECTIONS];
    s->sdf = s->blob.section[MASU_BLOB_SDF];
    s->probes = s->blob.section[MASU_BLOB_PROBES] != NULL;
    double *matrices = calloc(s->blob.count[MASU_BLOB_INSTANCES] + 1, 12 * sizeof *matrices);
    if (matrices) ref_pose_instances(&s->blob, time, animate, matrices);
    bool good = matrices && read_materials(s) && read_triangles(s, matrices, time, animate) &&
                read_lights(s, matrices) && read_emitters(s);
    free(matrices);
    return good || out_of_memory(error, size);
}

void ref_scene_close(ref_scene *s) {
    for (uint64_t i = 0; i < s->texture_count; i++) free(s->textures[i].rgba);
    free(s->textures);
    free(s->materials);
    free(s->positions);
    free(s->normals);
    free(s->texcoords);
    free(s->texcoords_1);
    free(s->colors);
    free(s->triangles);
    free(s->lights);
    free(s->emitters);
    free(s->emitter_pdf);
    free(s->blob.bytes);
    memset(s, 0, sizeof *s);
}

/* trace_scene.c: see trace_scene.h. */
#include "scene/trace_scene.h"

#include "blue_noise.h"
#include "scene/material.h"
#include "scene/trace.h"

#include <string.h>

masu_trace_plan masu_trace_layout(const masu_scene_data *scene) {
    masu_trace_static s = masu_trace_static_layout(scene->trace_nodes, scene->trace_triangles);
    masu_trace_plan p = {
        .nodes = s.nodes / 16, .triangles = s.triangles / 16, .more = s.bytes / 16};
    p.noise = p.more + 1;
    p.materials = p.noise + MASU_BLUE_NOISE_WORDS / 4;
    p.pictures = p.materials;
    if (scene->trace_instances) p.pictures += 4 * (uint64_t)scene->materials;
    p.texels = p.pictures + scene->trace_textures;
    p.end = p.texels + (scene->trace_texels + 3) / 4;
    return p;
}

uint64_t masu_trace_scene_bytes(const masu_scene_data *scene) {
    return 16 * masu_trace_layout(scene).end;
}

uint64_t masu_trace_rows_at(const masu_scene_data *scene, int query) {
    return query ? 16 : masu_trace_frame_bytes(scene->trace_instances);
}

uint64_t masu_trace_slot_bytes(const masu_scene_data *scene, int query, int looks) {
    uint64_t rows = MASU_TRACE_ROWS + (looks ? MASU_TRACE_LOOK_ROWS : 0u);
    return masu_trace_rows_at(scene, query) + 16 * rows * scene->trace_instances;
}

/* Index of the ray tracing copy of a material's map, or MASU_TRACE_NONE. Binary search: the copies
 * are sorted. */
static uint32_t trace_texture_of(const masu_scene_data *scene, const masu_scene_view *v,
                                 const masu_blob_material *m, uint32_t slot) {
    if (!(m->flags & 1u << slot)) return MASU_TRACE_NONE;
    uint32_t texture = v->texture_sets[m->texture_set].texture[slot];
    uint32_t layer = m->layers >> 8 * slot & 255u, first = 0, end = scene->trace_textures;
    while (first < end) {
        uint32_t middle = first + (end - first) / 2;
        const masu_blob_trace_texture *t = &v->trace_textures[middle];
        if (t->texture == texture && t->layer == layer) return middle;
        if (t->texture < texture || (t->texture == texture && t->layer < layer))
            first = middle + 1;
        else
            end = middle;
    }
    return MASU_TRACE_NONE;
}

/* Ray hits do not sample roughness and metallic but use the mean of the map. It is the smallest mip
 * of the map's copy, which includes the effect of the normal map on the roughness. */
static void set_mean_surface(const masu_scene_data *scene, const masu_scene_view *v,
                             const masu_blob_material *m, struct masu_trace_material *out) {
    uint32_t i = trace_texture_of(scene, v, m, MASU_SLOT_SURFACE);
    if (i == MASU_TRACE_NONE) return;
    const masu_blob_trace_texture *t = &v->trace_textures[i];
    uint32_t mean = v->trace_texels[t->first + masu_blob_trace_texels(t->width, t->height) - 1];
    float roughness = (float)(mean & 255u) / 255.0f, metallic = (float)(mean >> 8 & 255u) / 255.0f;
    out->base_color[3] *= roughness * roughness;
    if (m->flags & MASU_MATERIAL_HAS_METAL) out->emissive[3] *= metallic * metallic;
}

struct masu_trace_material masu_trace_material_of(const masu_scene_data *scene,
                                                  const masu_scene_view *v,
                                                  const masu_blob_material *m) {
    struct masu_trace_material out = {
        {m->base_color[0], m->base_color[1], m->base_color[2], m->roughness},
        {m->emissive[0], m->emissive[1], m->emissive[2], m->metallic},
        {masu_specular_of(m), m->coat, m->coat_roughness, m->opacity},
        {MASU_TRACE_NONE, MASU_TRACE_NONE, m->flags, 0}};
    if (!(m->flags & MASU_MATERIAL_HAS_MAPS)) return out;
    const masu_blob_texture_set *set = &v->texture_sets[m->texture_set];
    out.maps[3] = (set->wrap[0] & 3u) | set->wrap[1] << 2;
    if (m->more_layers >> (16 + MASU_SLOT_EMISSIVE) & 1u) out.maps[3] |= MASU_TRACE_SECOND;
    out.maps[0] = trace_texture_of(scene, v, m, MASU_SLOT_BASE);
    out.maps[1] = trace_texture_of(scene, v, m, MASU_SLOT_EMISSIVE);
    set_mean_surface(scene, v, m, &out);
    return out;
}

uint32_t masu_trace_word_of(const masu_scene_data *scene, const masu_scene_view *v,
                            uint32_t material) {
    const masu_blob_material *m = &v->materials[material];
    uint32_t word = material;
    if (m->flags & MASU_MATERIAL_IS_MASK &&
        trace_texture_of(scene, v, m, MASU_SLOT_BASE) != MASU_TRACE_NONE)
        word |= MASU_TRACE_HOLES;
    if (m->flags & MASU_MATERIAL_IS_SINGLE) word |= MASU_TRACE_SINGLE;
    return word;
}

/* The i-th 16-byte element of the traced scene buffer. */
static void write_element(const masu_scene_data *scene, const masu_scene_view *v,
                          const masu_trace_plan *p, uint64_t i, uint32_t out[4]) {
    memset(out, 0, 16);
    if (i < p->nodes) {
        masu_trace_static s = masu_trace_static_layout(scene->trace_nodes, scene->trace_triangles);
        memcpy(out, s.header, 16);
        out[3] = (uint32_t)p->more;
    } else if (i < p->triangles) {
        uint32_t own = scene->trace_nodes - scene->host_nodes; /* the others follow at run time */
        if (i - p->nodes < own * (uint64_t)MASU_TRACE_NODE_UVEC4)
            memcpy(out, (const unsigned char *)v->trace_nodes + 16 * (i - p->nodes), 16);
    } else if (i < p->more) {
        uint32_t host = scene->host_nodes ? scene->host_triangles : 0;
        if (i - p->triangles >= scene->trace_triangles - host) return;
        const masu_blob_trace_triangle *t = &v->trace_triangles[i - p->triangles];
        memcpy(out, t->vertex, sizeof t->vertex);
        out[3] = masu_trace_word_of(scene, v, v->primitives[t->primitive].material);
    } else if (i < p->noise) {
        out[0] = (uint32_t)p->materials;
        out[1] = (uint32_t)p->pictures;
        out[2] = (uint32_t)p->texels;
        out[3] = (uint32_t)(masu_texcoord_layout(scene).colors / 4);
    } else if (i < p->materials) {
        memcpy(out, &masu_blue_noise[4 * (i - p->noise)], 16);
    } else if (i < p->pictures) {
        struct masu_trace_material m =
            masu_trace_material_of(scene, v, &v->materials[(i - p->materials) / 4]);
        memcpy(out, (const unsigned char *)&m + 16 * ((i - p->materials) % 4), 16);
    } else if (i < p->texels) {
        const masu_blob_trace_texture *t = &v->trace_textures[i - p->pictures];
        out[0] = t->first;
        out[1] = t->width | t->height << 16;
    } else {
        uint64_t first = 4 * (i - p->texels), left = scene->trace_texels - first;
        memcpy(out, v->trace_texels + first, (size_t)(4 * (left < 4 ? left : 4)));
    }
}

void masu_trace_write(const masu_scene_data *scene, const masu_scene_view *v, uint64_t offset,
                      uint64_t bytes, unsigned char *to) {
    masu_trace_plan p = masu_trace_layout(scene);
    for (uint64_t at = offset; at < offset + bytes;) {
        uint32_t words[4];
        uint64_t skip = at % 16, part = 16 - skip;
        if (part > offset + bytes - at) part = offset + bytes - at;
        write_element(scene, v, &p, at / 16, words);
        memcpy(to + (at - offset), (const unsigned char *)words + skip, (size_t)part);
        at += part;
    }
}

uint32_t masu_ray_masks(const masu_scene_data *scene) {
    return scene->trace_colors && scene->masks ? 1 : 0;
}

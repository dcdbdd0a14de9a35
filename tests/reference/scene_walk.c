/* scene_walk.c: see scene_walk.h. */
#include "reference/scene_walk.h"

#include "scene/cull.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

typedef struct walker {
    const masu_scene_data *scene;
    masu_scene_view view;
    const char *fault;
    uint32_t groups, items; /* reached by a traversal from the root */
} walker;

static void expect(walker *w, int good, const char *fault) {
    if (!good && !w->fault) w->fault = fault;
}

static int all_within(const float *v, uint32_t n, double low, double high) {
    for (uint32_t i = 0; i < n; i++) {
        if (!((double)v[i] >= low && (double)v[i] <= high)) return 0;
    }
    return 1;
}

#define ANY_FLOAT 3.5e38 /* finite */

/* A section is inside the blob. Each byte is read, which a sanitizer or a guard page checks. */
static void read_section(walker *w, const void *start, uint64_t count, uint64_t stride,
                         const char *fault) {
    const unsigned char *blob = w->scene->blob, *p = start;
    volatile unsigned char sink = 0;
    expect(w, (p != NULL) == (count > 0), fault);
    if (!p || w->fault) return;
    uint64_t offset = (uint64_t)(p - blob);
    expect(w, p >= blob && offset <= w->scene->blob_bytes, fault);
    expect(w, !w->fault && count <= (w->scene->blob_bytes - offset) / stride, fault);
    for (uint64_t i = 0; i < count * stride && !w->fault; i++) sink = (unsigned char)(sink ^ p[i]);
}

static void read_name(walker *w, uint32_t name) {
    if (name == MASU_BLOB_NONE) return;
    expect(w, w->view.names && name < w->view.name_bytes, "a name is outside the names");
    if (w->fault) return;
    expect(w, memchr(w->view.names + name, '\0', (size_t)(w->view.name_bytes - name)) != NULL,
           "a name does not end");
}

static uint32_t side(uint32_t size, uint32_t mip) {
    uint32_t v = size >> mip;
    return v < 1 ? 1 : v;
}

/* Bytes of a texture, by counting its blocks. */
static uint64_t count_blocks(const masu_blob_texture *t) {
    uint64_t bytes = 0;
    for (uint32_t m = 0; m < t->mips && m < 13; m++) {
        for (uint32_t y = 0; y < side(t->height, m); y += 4) {
            for (uint32_t x = 0; x < side(t->width, m); x += 4) {
                bytes += t->format == 1 || t->format == 3 ? 8 : 16;
            }
        }
    }
    return bytes * t->layers;
}

static void read_sections(walker *w) {
    const masu_scene_data *s = w->scene;
    const masu_scene_view *v = &w->view;
    read_section(w, v->vertices, s->vertices, sizeof *v->vertices, "vertices");
    read_section(w, v->indices, s->indices, sizeof *v->indices, "indices");
    read_section(w, v->primitives, s->primitives, sizeof *v->primitives, "primitives");
    read_section(w, v->meshes, s->meshes, sizeof *v->meshes, "meshes");
    read_section(w, v->instances, s->instances, sizeof *v->instances, "instances");
    read_section(w, v->groups, s->groups, sizeof *v->groups, "groups");
    read_section(w, v->group_items, s->group_items, sizeof *v->group_items, "group items");
    read_section(w, v->occluders, s->occluders, sizeof *v->occluders, "occluders");
    read_section(w, v->materials, s->materials, sizeof *v->materials, "materials");
    read_section(w, v->lods, s->lods, sizeof *v->lods, "lods");
    read_section(w, v->camera_keys, s->camera_keys, sizeof *v->camera_keys, "camera keys");
    read_section(w, v->environment, 1, sizeof *v->environment, "environment");
    read_section(w, v->shadow, v->shadow != NULL, sizeof *v->shadow, "shadow");
    read_section(w, v->sdf, s->sdf, sizeof *v->sdf, "sdf");
    read_section(w, v->sdf_params, s->sdf_params, sizeof *v->sdf_params, "sdf parameters");
    read_section(w, v->slots, v->slot_count, sizeof *v->slots, "slots");
    for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
        read_section(w, v->code[k].words, v->code[k].count, sizeof *v->code[k].words, "SPIR-V");
    }
    read_section(w, v->names, v->name_bytes, 1, "names");
    uint64_t texcoords = v->texcoords ? s->vertices : 0, texels = 0;
    read_section(w, v->texcoords, texcoords, 2 * sizeof(float), "texture coordinates");
    read_section(w, v->textures, s->texture_arrays, sizeof *v->textures, "textures");
    read_section(w, v->texture_sets, s->texture_sets, sizeof *v->texture_sets, "texture sets");
    for (uint32_t i = 0; i < s->texture_arrays && !w->fault; i++) {
        texels = v->textures[i].offset + count_blocks(&v->textures[i]);
    }
    read_section(w, v->texels, texels, 1, "texels");
    read_section(w, v->trace_nodes, s->trace_nodes, sizeof *v->trace_nodes, "trace nodes");
    read_section(w, v->trace_triangles, s->trace_triangles, sizeof *v->trace_triangles,
                 "trace triangles");
    read_section(w, v->trace_meshes, v->trace_meshes ? s->meshes : 0, sizeof *v->trace_meshes,
                 "trace meshes");
    read_section(w, v->trace_instances, s->trace_instances, sizeof *v->trace_instances,
                 "trace instances");
}

/* ---- Textures -------------------------------------------------------------------------------- */

static void read_map(walker *w, const masu_blob_material *m, uint32_t slot) {
    if (!(m->flags >> slot & 1)) return;
    expect(w, m->texture_set < w->scene->texture_sets, "a material's texture set");
    if (w->fault) return;
    uint32_t texture = w->view.texture_sets[m->texture_set].texture[slot];
    expect(w, texture < w->scene->texture_arrays, "a map has no texture");
    if (w->fault) return;
    const masu_blob_texture *t = &w->view.textures[texture];
    uint32_t layer = (slot < 4 ? m->layers >> 8 * slot : m->more_layers >> 8 * (slot - 4)) & 255;
    expect(w, layer < 256 && layer < t->layers, "a map has no layer");
    static const uint32_t formats[MASU_SLOT_COUNT] = {
        1u << 1 | 1u << 2, 1u << 4, 1u << 3 | 1u << 4,
        1u << 1,           1u << 3, 1u << 4}; /* allowed, by number */
    expect(w, formats[slot] >> t->format & 1, "a map's format");
    if (slot == MASU_SLOT_BASE && m->flags & MASU_MATERIAL_IS_MASK) {
        expect(w, t->format == MASU_TEXTURE_BC3_SRGB, "a mask has no alpha");
    }
    if (slot == MASU_SLOT_SURFACE && m->flags & MASU_MATERIAL_HAS_METAL) {
        expect(w, t->format == MASU_TEXTURE_BC5, "a map has no metallic");
    }
}

static void read_textures(walker *w) {
    const masu_scene_data *s = w->scene;
    const masu_scene_view *v = &w->view;
    uint64_t layers = 0, bytes = 0, decoded = 0;
    int masks = 0, singles = 0;
    expect(w, s->texture_arrays <= 64, "too many textures");
    expect(w, !s->texture_arrays == !v->texcoords, "texture coordinates without textures");
    for (uint32_t i = 0; i < s->texture_arrays && !w->fault; i++) {
        const masu_blob_texture *t = &v->textures[i];
        uint64_t end = t->offset + count_blocks(t);
        expect(w, t->width - 1 < 4096 && t->height - 1 < 4096, "a texture's size");
        expect(w, t->layers - 1 < 256, "a texture's layers");
        expect(w, t->offset % 16 == 0, "a texture begins between");
        if (i + 1 < s->texture_arrays) {
            expect(w, end <= v->textures[i + 1].offset, "textures overlap");
        }
        /* The last mip is one texel, or more could follow; no mip comes after a mip of one
         * texel. */
        expect(w, t->mips && (t->width >> (t->mips - 1) || t->height >> (t->mips - 1)),
               "a texture's mips");
        read_name(w, t->name);
        if (w->fault) return;
        layers += t->layers;
        bytes += count_blocks(t);
        uint64_t texels = 0;
        for (uint32_t m = 0; m < t->mips; m++)
            texels += (uint64_t)side(t->width, m) * side(t->height, m);
        decoded += texels * t->layers * (t->format == 3 ? 1 : t->format == 4 ? 2 : 4);
    }
    for (uint64_t i = 0; v->texcoords && i < 2 * (uint64_t)s->vertices; i++) {
        expect(w, fabsf(v->texcoords[i]) <= 32768.0f, "a texture coordinate");
    }
    for (uint32_t i = 0; i < s->texture_sets && !w->fault; i++) {
        const masu_blob_texture_set *set = &v->texture_sets[i];
        expect(w, set->wrap[0] < 3 && set->wrap[1] < 3, "a texture set's wrapping");
        uint32_t given = 0;
        for (uint32_t k = 0; k < MASU_SLOT_COUNT; k++) {
            if (set->texture[k] == MASU_BLOB_NONE) continue;
            given++;
            expect(w, set->texture[k] < s->texture_arrays, "a texture set's texture");
        }
        expect(w, given > 0, "a texture set is empty");
    }
    for (uint32_t i = 0; i < s->materials && !w->fault; i++) {
        masks |= (v->materials[i].flags & MASU_MATERIAL_IS_MASK) != 0;
        singles |= (v->materials[i].flags & MASU_MATERIAL_IS_SINGLE) != 0;
        for (uint32_t k = 0; k < MASU_SLOT_COUNT; k++) read_map(w, &v->materials[i], k);
    }
    expect(w, s->textures == layers, "textures were counted wrongly");
    expect(w, s->texture_bytes == bytes, "texture bytes were counted wrongly");
    expect(w, s->texture_bytes_decoded == decoded, "decoded bytes were counted wrongly");
    expect(w, s->masks == (uint32_t)masks, "masks");
    expect(w, s->singles == (uint32_t)singles, "single-sided materials");
}

static void read_primitive(walker *w, const masu_blob_primitive *p) {
    expect(w, p->index_count % 3 == 0, "a primitive has a part of a triangle");
    expect(w, (uint64_t)p->first_index + p->index_count <= w->scene->indices,
           "a primitive's indices are outside");
    expect(w, p->vertex_count > 0 && p->vertex_count <= 0xFFFFFF, "a primitive's vertex count");
    expect(w, (uint64_t)p->first_vertex + p->vertex_count <= w->scene->vertices,
           "a primitive's vertices are outside");
    expect(w, p->first_vertex <= INT32_MAX, "a first vertex is no int32");
    expect(w, p->material < w->scene->materials, "a primitive has no material");
    expect(w, all_within(p->aabb_min, 3, -ANY_FLOAT, ANY_FLOAT), "a primitive's lower bound");
    expect(w, all_within(p->aabb_max, 3, -ANY_FLOAT, ANY_FLOAT), "a primitive's upper bound");
    for (uint32_t k = 0; k < p->index_count && !w->fault; k++) {
        uint32_t index = w->view.indices[p->first_index + k];
        expect(w, index < p->vertex_count, "an index points outside its primitive");
        expect(w,
               !w->fault && all_within(w->view.vertices[p->first_vertex + index].position, 3,
                                       -ANY_FLOAT, ANY_FLOAT),
               "a drawn vertex is not finite");
    }
}

/* The draws of one G-buffer pass, by counting the instances of each mesh from the start. */
static void count_draws(walker *w) {
    uint64_t draws = 0, triangles = 0, lod_draws = 0, lod_instances = 0;
    for (uint32_t m = 0; m < w->scene->meshes && !w->fault; m++) {
        const masu_blob_mesh *mesh = &w->view.meshes[m];
        uint32_t first = w->scene->instances, placed = 0, from = 0, found_first;
        for (uint32_t i = 0; i < w->scene->instances; i++) {
            if (w->view.instances[i].mesh != m) continue;
            if (!placed) first = i;
            expect(w, i == first + placed, "instances of a mesh are apart");
            placed++;
        }
        uint32_t end =
            masu_scene_mesh_instances(&w->view, w->scene->instances, m, from, &found_first);
        expect(w, end - found_first == placed && (!placed || found_first == first),
               "masu_scene_mesh_instances disagrees");
        for (uint32_t i = 0; i < w->scene->lods; i++) {
            if (w->view.lods[i].mesh != m || !placed || !mesh->primitive_count) continue;
            lod_draws += mesh->primitive_count;
            lod_instances += placed;
        }
        for (uint32_t p = 0; p < mesh->primitive_count && placed && !w->fault; p++) {
            draws++;
            triangles +=
                (uint64_t)placed * (w->view.primitives[mesh->first_primitive + p].index_count / 3);
        }
    }
    expect(w, draws == w->scene->draws, "draws were counted wrongly");
    expect(w, lod_draws == w->scene->lod_draws, "draws of LODs were counted wrongly");
    expect(w, lod_instances == w->scene->lod_instances, "instances of LODs were counted wrongly");
    expect(w, triangles == w->scene->triangles, "triangles were counted wrongly");
}

/* From the root down: the groups and items that masu_cull visits, with the bounds it relies on. */
static void walk_group(walker *w, uint32_t i, uint32_t depth) {
    const masu_blob_group *g = &w->view.groups[i];
    w->groups++;
    expect(w, depth < MASU_CULL_DEPTH, "a group is too deep");
    expect(w, w->groups <= w->scene->groups, "a group is visited twice");
    read_name(w, g->name);
    for (uint32_t k = 0; k < 3; k++) {
        expect(w, fabsf(g->center[k]) <= 1e30f && g->half[k] >= 0.0f && g->half[k] <= 1e30f,
               "the bounds of a group");
    }
    for (uint32_t k = 0; k < g->item_count && !w->fault; k++) {
        expect(w, (uint64_t)g->first_item + k < w->scene->group_items, "an item is outside");
        if (w->fault) return;
        uint32_t item = w->view.group_items[g->first_item + k];
        expect(w, item < w->scene->instances, "an item is no instance");
        if (w->fault) return;
        expect(w, w->view.instances[item].group == i, "an instance of another group");
        expect(w, ++w->items <= w->scene->group_items, "an item is visited twice");
        const masu_blob_instance *n = &w->view.instances[item];
        const masu_blob_mesh *mesh = &w->view.meshes[n->mesh];
        for (uint32_t corner = 0; corner < 8; corner++) {
            for (uint32_t row = 0; row < 3; row++) {
                const float *t = n->transform + 4 * row;
                double x = (double)t[3];
                for (uint32_t c = 0; c < 3; c++) {
                    x += (double)t[c] * (double)(corner >> c & 1 ? mesh->aabb_max[c]
                                                                 : mesh->aabb_min[c]);
                }
                expect(w, fabs(x - (double)g->center[row]) <= (double)g->half[row],
                       "a group does not hold the corner of an instance");
            }
        }
    }
    for (uint32_t k = 0; k < g->child_count && !w->fault; k++) {
        expect(w, g->first_child > i && (uint64_t)g->first_child + k < w->scene->groups,
               "a child is outside");
        if (!w->fault) walk_group(w, g->first_child + k, depth + 1);
    }
}

/* Each mesh's LODs, found by a search from the start, and compared with the accessors. */
static void read_detail(walker *w) {
    uint64_t used = 0;
    for (uint32_t m = 0; m < w->scene->meshes && !w->fault; m++) {
        const masu_blob_mesh *mesh = &w->view.meshes[m];
        uint32_t seen = 0, first = 0, found_first;
        double last = 0.0;
        used += mesh->primitive_count;
        for (uint32_t i = 0; i < w->scene->lods && !w->fault; i++) {
            const masu_blob_lod *l = &w->view.lods[i];
            if (l->mesh != m) continue;
            if (!seen) first = i;
            expect(w, i == first + seen, "LODs of a mesh are apart");
            expect(w, all_within(&l->error, 1, last, 1e30), "an error of a LOD");
            last = (double)l->error;
            seen++;
            used += mesh->primitive_count;
            for (uint32_t p = 0; p < mesh->primitive_count && !w->fault; p++) {
                uint64_t at = (uint64_t)l->first_primitive + p;
                expect(w, at < w->scene->primitives, "a LOD's primitives are outside");
                if (w->fault) break;
                const masu_blob_primitive *fine = &w->view.primitives[mesh->first_primitive + p];
                expect(w, w->view.primitives[at].material == fine->material, "a LOD's material");
                expect(w, w->view.primitives[at].index_count <= fine->index_count,
                       "a LOD is finer than its mesh");
                for (uint32_t k = 0; k < 3; k++) {
                    expect(w,
                           w->view.primitives[at].aabb_min[k] >= mesh->aabb_min[k] &&
                               w->view.primitives[at].aabb_max[k] <= mesh->aabb_max[k],
                           "a LOD is larger than its mesh");
                }
            }
        }
        expect(w, seen <= 3, "a mesh has many LODs");
        expect(w,
               masu_scene_mesh_lods(&w->view, w->scene->lods, m, &found_first) == seen &&
                   (!seen || found_first == first),
               "masu_scene_mesh_lods disagrees");
    }
    expect(w, used <= w->scene->primitives, "primitives are shared");
    for (uint32_t i = 0; i < w->scene->lods && !w->fault; i++) {
        expect(w, w->view.lods[i].mesh < w->scene->meshes, "a LOD has no mesh");
    }
}

static void read_geometry(walker *w) {
    const masu_scene_view *v = &w->view;
    for (uint32_t i = 0; i < w->scene->primitives && !w->fault; i++) {
        read_primitive(w, &v->primitives[i]);
    }
    for (uint32_t i = 0; i < w->scene->meshes && !w->fault; i++) {
        const masu_blob_mesh *m = &v->meshes[i];
        expect(w, (uint64_t)m->first_primitive + m->primitive_count <= w->scene->primitives,
               "a mesh's primitives are outside");
        expect(w, all_within(m->aabb_min, 3, -ANY_FLOAT, ANY_FLOAT), "a mesh's lower bound");
        expect(w, all_within(m->aabb_max, 3, -ANY_FLOAT, ANY_FLOAT), "a mesh's upper bound");
        read_name(w, m->name);
    }
    for (uint32_t i = 0; i < w->scene->instances && !w->fault; i++) {
        const masu_blob_instance *n = &v->instances[i];
        expect(w, all_within(n->transform, 12, -ANY_FLOAT, ANY_FLOAT), "a transform is not finite");
        expect(w, n->mesh < w->scene->meshes, "an instance has no mesh");
        expect(w, n->parent == MASU_BLOB_NONE || n->parent < w->scene->instances,
               "an instance has no such parent");
        read_name(w, n->name);
    }
    if (!w->fault) count_draws(w);
    if (!w->fault && w->scene->groups) walk_group(w, 0, 0);
    uint64_t placed = 0;
    for (uint32_t i = 0; i < w->scene->occluders && !w->fault; i++) {
        const masu_blob_occluder *o = &v->occluders[i];
        expect(w, o->mesh < w->scene->meshes, "an occluder has no mesh");
        expect(w, o->lods <= 3, "an occluder of many LODs");
        if (w->fault) return;
        for (uint32_t k = 0; k < 3; k++) {
            expect(w,
                   v->meshes[o->mesh].aabb_min[k] <= o->low[k] && o->low[k] <= o->high[k] &&
                       o->high[k] <= v->meshes[o->mesh].aabb_max[k],
                   "an occluder is not in its mesh");
        }
        for (uint32_t n = 0; n < w->scene->instances; n++)
            placed += v->instances[n].mesh == o->mesh;
    }
    expect(w, placed == w->scene->placed_occluders, "placed_occluders");
    uint32_t grouped = 0;
    for (uint32_t i = 0; i < w->scene->instances && !w->fault; i++) {
        grouped += v->instances[i].group != MASU_BLOB_NONE;
    }
    expect(w, grouped == w->scene->group_items, "instances and items of groups");
    expect(w, w->groups == w->scene->groups && w->items == w->scene->group_items,
           "a traversal does not visit each group and item once");
    if (!w->fault) read_detail(w);
}

static void read_looks(walker *w) {
    const masu_scene_view *v = &w->view;
    for (uint32_t i = 0; i < w->scene->materials && !w->fault; i++) {
        const masu_blob_material *m = &v->materials[i];
        expect(w, all_within(m->base_color, 3, 0.0, 1.0), "a base colour is out of range");
        expect(w, all_within(&m->roughness, 1, 0.0, 1.0), "a roughness is out of range");
        expect(w, all_within(&m->metallic, 1, 0.0, 1.0), "a metallic is out of range");
        expect(w, all_within(m->emissive, 3, 0.0, ANY_FLOAT), "an emissive is out of range");
        read_name(w, m->name);
    }
    for (uint32_t i = 0; i < w->scene->camera_keys && !w->fault; i++) {
        const masu_blob_camera_key *k = &v->camera_keys[i];
        expect(w, all_within(&k->time, 1, -ANY_FLOAT, ANY_FLOAT), "a key's time is not finite");
        expect(w, all_within(k->position, 3, -ANY_FLOAT, ANY_FLOAT), "a key's position");
        expect(w, all_within(k->target, 3, -ANY_FLOAT, ANY_FLOAT), "a key's target");
        expect(w, all_within(&k->fov_y, 1, 0.00049, 3.1001), "a key's field of view");
        expect(w, !i || k->time > v->camera_keys[i - 1].time, "time does not rise");
    }
    const masu_blob_environment *e = v->environment;
    const float *d = e->sun_direction;
    double length = sqrt((double)d[0] * (double)d[0] + (double)d[1] * (double)d[1] +
                         (double)d[2] * (double)d[2]);
    expect(w, fabs(length - 1.0) < 0.011, "the sun's direction is no unit vector");
    expect(w, all_within(e->sun_color, 3, 0.0, ANY_FLOAT), "the sun's colour");
    expect(w, all_within(e->ambient, 3, 0.0, ANY_FLOAT), "the ambient light");
    expect(w, all_within(e->sky_zenith, 3, 0.0, ANY_FLOAT), "the zenith");
    expect(w, all_within(e->sky_horizon, 3, 0.0, ANY_FLOAT), "the horizon");
    expect(w, all_within(&e->exposure, 1, 1e-10, ANY_FLOAT), "the exposure");
    expect(w, all_within(&e->near_distance, 1, 1e-10, ANY_FLOAT), "the near distance");
}

static void read_shadow(walker *w) {
    const masu_blob_shadow *s = w->view.shadow;
    const masu_scene_data *out = w->scene;
    int there = s && out->instances;
    expect(w, out->shadow_cascades == (there ? s->cascades : 0), "shadow_cascades");
    expect(w, out->shadow_resolution == (there ? s->resolution : 0), "shadow_resolution");
    if (!s) return;
    expect(w, s->cascades >= 1 && s->cascades <= 4, "the cascades");
    expect(w, s->resolution >= 16 && s->resolution <= 8192, "a cascade's resolution");
    expect(w, all_within(&s->distance, 1, 0.00099, 1.001e9), "the shadows' distance");
    expect(w, all_within(&s->lambda, 1, 0.0, 1.0), "the split of the cascades");
}

/* What each kind of code allows, written a second time: 0 no such code, 1 optional, 2 required. */
static const struct {
    int code;
    uint32_t marches; /* march modes that need it and are available with it */
} kinds[MASU_BLOB_KIND_COUNT] = {
    [MASU_BLOB_MARCH_SPIRV] = {2, 0},
    [MASU_BLOB_CLASSIFY_SPIRV] = {2, 0},
    [MASU_BLOB_CONE8_SPIRV] = {2, 0},
    [MASU_BLOB_CONE4_SPIRV] = {2, 0},
    [MASU_BLOB_VELOCITY_SPIRV] = {1, 0},
    [MASU_BLOB_SILHOUETTES_SPIRV] = {2, 0},
    [MASU_BLOB_UPDATE_PREVIOUS_SPIRV] = {1, 0},
    [MASU_BLOB_UPDATE_SPIRV] = {1, 0},
#ifdef MASU_LAB
    [MASU_BLOB_PLAIN_SPIRV] = {1, 1u << MASU_MARCH_PLAIN},
    [MASU_BLOB_SEED_SPIRV] = {1, 1u << MASU_MARCH_SEED},
    [MASU_BLOB_CHECKERBOARD_SPIRV] = {1, 1u << MASU_MARCH_CHECKERBOARD},
#endif
    [MASU_BLOB_OCCLUSION_SPIRV] = {1, 0},
    [MASU_BLOB_TRACE_SDF_SPIRV] = {1, 0},
    [MASU_BLOB_LOCAL_SHADOW_SPIRV] = {1, 0},
    [MASU_BLOB_BOUNCE_SDF_SPIRV] = {1, 0},
};

static void read_code(walker *w) {
#ifdef MASU_LAB
    uint32_t marches = w->view.sdf ? 1u << MASU_MARCH_AUTO : 0;
#endif
    for (uint32_t k = 0; k < MASU_BLOB_KIND_COUNT; k++) {
        const uint32_t *words = w->view.code[k].words;
        if (!words) {
            expect(w, kinds[k].code < 2 || !w->view.sdf, "the SDF lacks code");
            continue;
        }
        expect(w, kinds[k].code && w->view.sdf, "code of no SDF");
        expect(w, w->view.code[k].count >= 5 && words[0] == 0x07230203u, "the SPIR-V");
#ifdef MASU_LAB
        marches |= kinds[k].marches;
#endif
    }
#ifdef MASU_LAB
    expect(w, w->scene->sdf_march == marches, "sdf_march");
#endif
    int timed = w->view.code[MASU_BLOB_UPDATE_PREVIOUS_SPIRV].words != NULL;
    int anchored = w->view.sdf && w->view.sdf->flags & MASU_SDF_ANCHORED;
    int timeless = w->view.sdf && w->view.sdf->flags & MASU_SDF_TIMELESS;
    expect(w, w->scene->sdf_dynamic == (uint32_t)timed, "sdf_dynamic");
    expect(w, w->scene->sdf_timed == (uint32_t)(w->view.sdf && !timeless), "sdf_timed");
    expect(w,
           w->scene->sdf_static ==
               (uint32_t)(w->view.sdf && !w->view.code[MASU_BLOB_VELOCITY_SPIRV].words),
           "sdf_static");
    expect(w, w->scene->sdf_anchored == (uint32_t)anchored, "sdf_anchored");
    expect(w, (w->view.code[MASU_BLOB_UPDATE_SPIRV].words != NULL) == (timed || anchored),
           "update SPIR-V");
    expect(w, w->scene->sdf_occlusion == (w->view.code[MASU_BLOB_OCCLUSION_SPIRV].words != NULL),
           "sdf_occlusion");
    expect(w, w->scene->sdf_casts == (w->view.code[MASU_BLOB_LOCAL_SHADOW_SPIRV].words != NULL),
           "sdf_casts");
    expect(w, w->scene->trace_sdf == (w->view.code[MASU_BLOB_TRACE_SDF_SPIRV].words != NULL),
           "trace_sdf");
}

static void read_sdf(walker *w) {
    const masu_blob_sdf *s = w->view.sdf;
    read_code(w);
    expect(w, w->scene->sdf_slots == w->view.slot_count, "sdf_slots");
    expect(w, w->scene->sdf_parts == (s ? s->part_count : 0), "sdf_parts");
    expect(w, w->scene->sdf_block_words == (s ? s->block_words : 0), "sdf_block_words");
    if (!s) {
        expect(w, !w->view.sdf_params && !w->view.slots, "an SDF has parts but is missing");
        return;
    }
    for (uint32_t k = 0; k < 3; k++) {
        expect(w,
               isfinite(s->bounds_min[k]) && isfinite(s->bounds_max[k]) &&
                   s->bounds_min[k] <= s->bounds_max[k],
               "the SDF's bounds");
    }
    expect(w, all_within(&s->lipschitz, 1, 0.00099, ANY_FLOAT), "the Lipschitz constant");
    expect(w, all_within(&s->max_distance, 1, 1e-10, ANY_FLOAT), "the longest ray");
    expect(w, s->has_raster == (w->scene->instances > 0), "has_raster");
    expect(w, s->part_count >= 1 && s->part_count <= 4096, "the number of parts");
    expect(w, s->block_words <= 2, "the masks of a block");
    expect(w, w->view.slot_count >= 1 && w->view.slot_count <= 65536, "the number of slots");
    for (uint64_t i = 0; i < w->view.slot_count && !w->fault; i++) {
        expect(w, isfinite(w->view.slots[i]), "a slot is not finite");
    }
    expect(w, w->scene->sdf_params <= MASU_MAX_SDF_PARAMS, "too many SDF parameters");
    for (uint32_t i = 0; i < w->scene->sdf_params && !w->fault; i++) {
        const masu_blob_sdf_param *p = &w->view.sdf_params[i];
        expect(w,
               isfinite(p->minimum) && isfinite(p->maximum) && p->minimum <= p->value &&
                   p->value <= p->maximum,
               "an SDF parameter is outside its range");
        read_name(w, p->name);
        if (w->fault || p->name == MASU_BLOB_NONE) continue;
        const char *name = w->view.names + p->name;
        if (!*name) continue; /* masu_scene_find finds no empty name */
        /* This parameter, or an earlier one with the same name. */
        int32_t found = masu_scene_find(masu_scene_of(w->scene), MASU_SCENE_SDF_PARAM, name);
        expect(w, found >= 0 && found <= (int32_t)i, "an SDF parameter is not found by its name");
        if (w->fault) return;
        expect(w, !strcmp(w->view.names + w->view.sdf_params[found].name, name),
               "another SDF parameter is found by its name");
    }
}

const char *masu_ref_walk_scene(const masu_scene *scene) {
    walker w = {.scene = masu_scene_data_of(scene), .view = masu_scene_view_of(scene)};
    read_sections(&w);
    if (!w.fault) read_geometry(&w);
    if (!w.fault) read_textures(&w);
    if (!w.fault) read_looks(&w);
    if (!w.fault) read_shadow(&w);
    if (!w.fault) read_sdf(&w);
    return w.fault;
}

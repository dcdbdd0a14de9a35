/* check_textures.c: validates textures, texture sets, and the references of materials to both. */
#include "scene/check.h"

static masu_result check_texture(reader *r, uint64_t i, uint64_t *end) {
    const masu_blob_texture *t = &r->view.textures[i];
    if (!masu_blob_block_bytes(t->format)) return bad(r, "textures", i, "no such format");
    if (t->width < 1 || t->width > MASU_TEXTURE_SIZE_MAX || t->height < 1 ||
        t->height > MASU_TEXTURE_SIZE_MAX) {
        return bad(r, "textures", i, "size is not 1 to 4096");
    }
    uint32_t larger = t->width > t->height ? t->width : t->height, most = 1;
    while (larger >> most) most++;
    if (t->mips < 1 || t->mips > most) return bad(r, "textures", i, "number of mips");
    if (t->layers < 1 || t->layers > MASU_TEXTURE_LAYERS_MAX) {
        return bad(r, "textures", i, "layers are not 1 to 256");
    }
    if (!name_ok(r, t->name)) return bad(r, "textures", i, "name lies outside the names");
    if (t->offset != *end) return bad(r, "textures", i, "does not begin where the last one ends");
    uint64_t bytes = masu_blob_texture_bytes(t); /* at most 2^33 */
    if (bytes > r->counts[MASU_BLOB_TEXELS] * MASU_BLOB_ALIGN - t->offset) {
        return bad(r, "textures", i, "lies outside the texels");
    }
    *end = (t->offset + bytes + MASU_BLOB_ALIGN - 1) / MASU_BLOB_ALIGN * MASU_BLOB_ALIGN;
    return MASU_OK;
}

static int slot_takes(uint32_t slot, uint32_t format) {
    switch (slot) {
    case MASU_SLOT_BASE: return format == MASU_TEXTURE_BC1_SRGB || format == MASU_TEXTURE_BC3_SRGB;
    case MASU_SLOT_NORMAL: return format == MASU_TEXTURE_BC5;
    case MASU_SLOT_SURFACE: return format == MASU_TEXTURE_BC4 || format == MASU_TEXTURE_BC5;
    case MASU_SLOT_OCCLUSION: return format == MASU_TEXTURE_BC4;
    case MASU_SLOT_COAT: return format == MASU_TEXTURE_BC5;
    default: return format == MASU_TEXTURE_BC1_SRGB;
    }
}

static masu_result check_texture_set(reader *r, uint64_t i) {
    const masu_blob_texture_set *set = &r->view.texture_sets[i];
    uint32_t given = 0;
    for (uint32_t slot = 0; slot < MASU_SLOT_COUNT; slot++) {
        if (set->texture[slot] == MASU_BLOB_NONE) continue;
        given++;
        if (set->texture[slot] >= r->counts[MASU_BLOB_TEXTURES]) {
            return bad(r, "texture sets", i, "no such texture");
        }
        if (!slot_takes(slot, r->view.textures[set->texture[slot]].format)) {
            return bad(r, "texture sets", i, "a texture's format is not that of its slot");
        }
    }
    if (!given) return bad(r, "texture sets", i, "is empty");
    if ((set->wrap[0] & ~4u) > 2 || set->wrap[1] > 2)
        return bad(r, "texture sets", i, "no such wrapping");
    return MASU_OK;
}

/* The textures of a material exist and have the layer. */
static masu_result check_maps(reader *r, uint64_t i) {
    const masu_blob_material *m = &r->view.materials[i];
    uint32_t maps = m->flags & MASU_MATERIAL_HAS_MAPS;
    uint32_t smooth = MASU_MATERIAL_COAT_SMOOTH | MASU_MATERIAL_BASE_SMOOTH;
    uint32_t alpha = MASU_MATERIAL_HAS_METAL | MASU_MATERIAL_IS_MASK | smooth;
    if (m->flags & ~(uint32_t)MASU_MATERIAL_KNOWN) return bad(r, "materials", i, "unknown flags");
    if (!maps) {
        if (m->texture_set || m->layers || m->more_layers || m->flags & alpha) {
            return bad(r, "materials", i, "has no textures, but speaks of them");
        }
        return MASU_OK;
    }
    if (m->texture_set >= r->counts[MASU_BLOB_TEXTURE_SETS]) {
        return bad(r, "materials", i, "no such texture set");
    }
    const masu_blob_texture_set *set = &r->view.texture_sets[m->texture_set];
    for (uint32_t slot = 0; slot < MASU_SLOT_COUNT; slot++) {
        if (!(maps & 1u << slot)) continue;
        if (set->texture[slot] == MASU_BLOB_NONE) {
            return bad(r, "materials", i, "its texture set lacks a texture");
        }
        uint32_t layer =
            (slot < MASU_SLOT_OCCLUSION ? m->layers >> 8 * slot
                                        : m->more_layers >> 8 * (slot - MASU_SLOT_OCCLUSION)) &
            0xFF;
        if (layer >= r->view.textures[set->texture[slot]].layers) {
            return bad(r, "materials", i, "no such layer");
        }
    }
    uint32_t second = m->more_layers >> 16;
    if (second & ~maps || (second && !r->view.texcoords_1))
        return bad(r, "materials", i, "no such layer, or a map of coordinates that there are not");
    uint32_t has_base = maps >> MASU_SLOT_BASE & 1, has_surface = maps >> MASU_SLOT_SURFACE & 1;
    if (m->flags & MASU_MATERIAL_IS_MASK &&
        (!has_base ||
         r->view.textures[set->texture[MASU_SLOT_BASE]].format != MASU_TEXTURE_BC3_SRGB)) {
        return bad(r, "materials", i, "is a mask without alpha");
    }
    if (m->flags & MASU_MATERIAL_HAS_METAL &&
        (!has_surface ||
         r->view.textures[set->texture[MASU_SLOT_SURFACE]].format != MASU_TEXTURE_BC5)) {
        return bad(r, "materials", i, "has no map of metallic");
    }
    if (m->flags & smooth && !(maps >> MASU_SLOT_NORMAL & 1))
        return bad(r, "materials", i, "has no relief that its coat or base could lack");
    return MASU_OK;
}

masu_result masu_check_textures(reader *r) {
    const masu_scene_view *v = &r->view;
    int some = v->texcoords || v->textures || v->texture_sets || v->texels;
    int all = v->texcoords && v->textures && v->texture_sets && v->texels;
    if (some && !all) return bad(r, "textures", 0, "are there in part");
    if (some && r->counts[MASU_BLOB_TEXCOORDS] != r->counts[MASU_BLOB_VERTICES]) {
        return bad(r, "texture coordinates", r->counts[MASU_BLOB_TEXCOORDS],
                   "are not as many as vertices");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TEXCOORDS]; i++) {
        if (!within(&v->texcoords[2 * i], 2, -MASU_TEXCOORD_MAX, MASU_TEXCOORD_MAX)) {
            return bad(r, "texture coordinates", i, "are not finite or beyond 32768");
        }
    }
    uint64_t colors = r->counts[MASU_BLOB_COLORS], second = r->counts[MASU_BLOB_TEXCOORDS_1];
    if (colors && (!some || colors != r->counts[MASU_BLOB_VERTICES]))
        return bad(r, "vertex colours", colors,
                   "are not as many as vertices with texture coordinates");
    if (second && (!some || second != r->counts[MASU_BLOB_VERTICES]))
        return bad(r, "second texture coordinates", second, "are not as many as the first ones");
    for (uint64_t i = 0; i < second; i++) {
        if (!within(&v->texcoords_1[2 * i], 2, -MASU_TEXCOORD_MAX, MASU_TEXCOORD_MAX))
            return bad(r, "second texture coordinates", i, "are not finite or beyond 32768");
    }
    uint64_t end = 0;
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TEXTURES]; i++) {
        masu_result result = check_texture(r, i, &end);
        if (result) return result;
    }
    if (end != r->counts[MASU_BLOB_TEXELS] * MASU_BLOB_ALIGN) {
        return bad(r, "texels", end / MASU_BLOB_ALIGN, "belong to no texture");
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_TEXTURE_SETS]; i++) {
        masu_result result = check_texture_set(r, i);
        if (result) return result;
    }
    for (uint64_t i = 0; i < r->counts[MASU_BLOB_MATERIALS]; i++) {
        masu_result result = check_maps(r, i);
        if (result) return result;
    }
    return MASU_OK;
}

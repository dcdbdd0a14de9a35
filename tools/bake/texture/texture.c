/* texture.c: see texture.h.
 * Over 700 lines: kinds of maps, requests and arrays, of one structure.
 *
 *   maps of a material -> requests (a texture to make from certain images), each made once
 *   request -> texture: images decoded, mips filtered, blocks compressed
 *   textures of one format and size -> one array of layers, the larger ones first
 *   arrays that a material uses together, and its wrapping -> a texture set
 *
 * Colour is filtered as linear light and weighted by alpha. Masks keep their coverage. Normals are
 * averaged as vectors, and a mean shorter than 1 increases the roughness. The roughness map is
 * therefore as large as the normal map; a material that has none gets one. */
#include "bake/texture/texture.h"
#include "bake/texture/bump.h"
#include "bake/texture/image.h"
#include "bake/texture/attributes.h"
#include "bake/texture/mask.h"
#include "bake/texture/texel.h"
#include "bake/texture/trace_texture.h"
#include "cli/cli.h"
#include "scene/material.h"

#include <stdlib.h>
#include <string.h>

#define SHOWN_ONCE_SLACK 0.001f /* exporters round coordinates */

/* A texture to make; compared as bytes. */
typedef struct request {
    uint32_t slot;
    /* base: colour, opacity. surface: roughness, metallic, normal. coat: both. Else one image */
    uint32_t image[3];
    uint8_t channel[2];
    uint8_t gloss, alpha;
    /* for a normal or height map; the behaviour at the edge matters for heights */
    uint8_t relief, clamped[2];
    /* alpha is not the opacity of the colour: base: transmission; coat: a lobe's strength */
    uint8_t apart;
    float cutoff, normal_scale, roughness, occlusion;
} request;

typedef struct texture {
    request wanted;
    bool made; /* false: its images could not be used */
    uint32_t format, width, height, mips;
    uint8_t alpha; /* the resolved AUTO */
    bool absolute; /* roughness already includes the material's factor */
    masu_bake_buffer blocks;
    bool traced; /* it keeps a small texture for rays */
    uint32_t traced_side;
    masu_bake_trace_picture picture;
    uint32_t array, layer;
} texture;

typedef struct maker {
    masu_bake_content *content;
    const char *directories;
    int sizes;
    bool *failed; /* by image: warned about once */
    bool *reduced;
    texture *textures;
    uint32_t count, capacity;
    uint32_t *order;
} maker;

static const char *name_of(const maker *m, uint32_t image) {
    const masu_bake_content *c = m->content;
    return (const char *)c->image_text.data + MASU_BAKE_IMAGES(c)[image].name;
}

static bool read_picture(maker *m, uint32_t image, masu_bake_picture *picture) {
    *picture = (masu_bake_picture){0};
    if (image == MASU_BLOB_NONE || m->failed[image]) return false;
    bool good = masu_bake_read_image(m->content, image, m->directories, m->sizes, picture);
    m->failed[image] = !good;
    if (!good || m->reduced[image]) return good;
    bool smaller = !m->sizes && picture->whole_width;
    m->reduced[image] = smaller || picture->bits;
    if (smaller) {
        masu_cli_warn("texture %s: %u x %u texels, reduced to %u x %u", name_of(m, image),
                      picture->whole_width, picture->whole_height, picture->width, picture->height);
    }
    if (picture->bits)
        masu_cli_warn("texture %s: %u bits per channel, reduced to 8", name_of(m, image),
                      picture->bits);
    return good;
}

/* Byte `channel` of the texel of `p` at (x, y) of an image of width x height. */
static uint8_t byte_at(const masu_bake_picture *p, uint32_t x, uint32_t y, uint32_t width,
                       uint32_t height, uint32_t channel) {
    size_t px = (size_t)x * p->width / width, py = (size_t)y * p->height / height;
    return p->rgba.data[4 * (py * p->width + px) + channel];
}

static float *allocate_level(uint32_t width, uint32_t height) {
    return masu_bake_allocate((size_t)width * height * 4 * sizeof(float));
}

/* ---- mips and blocks ---- */

static void begin(texture *t, uint32_t format, uint32_t width, uint32_t height) {
    t->format = format;
    t->width = width;
    t->height = height;
    t->mips = 1;
    while ((width > height ? width : height) >> t->mips) t->mips++;
}

static unsigned char *append_blocks(texture *t, const uint8_t *bytes, uint32_t w, uint32_t h) {
    size_t blocks = (size_t)((w + 3) / 4) * ((h + 3) / 4);
    unsigned char *to =
        masu_bake_append(&t->blocks, NULL, blocks * masu_blob_block_bytes(t->format));
    masu_texel_blocks(t->format, bytes, w, h, to);
    return to;
}

/* Replaces a level by the next one; `level` has room for the largest. */
static void step_down(float *level, float *scratch, uint32_t w, uint32_t h, bool by_alpha) {
    uint32_t nw = w > 1 ? w / 2 : 1, nh = h > 1 ? h / 2 : 1;
    masu_texel_halve(level, w, h, by_alpha, scratch);
    memcpy(level, scratch, (size_t)nw * nh * 4 * sizeof *level);
}

static void encode_color(const float *level, size_t texels, uint8_t *bytes) {
    for (size_t i = 0; i < texels; i++) {
        for (int k = 0; k < 3; k++) bytes[4 * i + k] = masu_texel_to_srgb(level[4 * i + k]);
        bytes[4 * i + 3] = masu_texel_to_unorm(level[4 * i + 3]);
    }
}

/* Encodes the alpha of a mask's mip. `wanted`: the coverage of mip 0, set when mip 0 is encoded. */
static void encode_mask(const texture *t, const float *level, uint32_t w, uint32_t h, uint32_t mip,
                        double *wanted, uint8_t *scratch, unsigned char *blocks) {
    uint8_t cutoff = masu_texel_to_unorm(t->wanted.cutoff);
    float scale = 1;
    if (mip && *wanted > 0 && *wanted < 1) {
        scale = masu_mask_scale(level, w, h, cutoff, *wanted, scratch);
    }
    masu_mask_encode(level, w, h, cutoff, scale, scratch, blocks);
    if (!mip) *wanted = masu_mask_coverage(scratch, w, h, cutoff);
}

static void encode_normal(const float *level, size_t texels, uint8_t *bytes) {
    for (size_t i = 0; i < texels; i++) {
        masu_bake_vec3 n = masu_bake_v3f(level + 4 * i);
        if (!masu_bake_normalize(&n)) n = masu_bake_v3(0, 0, 1);
        bytes[4 * i] = (uint8_t)(128.5 + 127 * n.x);
        bytes[4 * i + 1] = (uint8_t)(128.5 + 127 * n.y);
        bytes[4 * i + 2] = bytes[4 * i + 3] = 255;
    }
}

/* Roughness itself is averaged. The mean of alpha^2, which is a variance, would lose smooth parts,
 * and the lighting of a mixture would have a larger error (tests/unit/test_normal_filter.c). */
static void encode_surface(const float *level, const float *normals, size_t texels, float roughness,
                           uint8_t *bytes) {
    for (size_t i = 0; i < texels; i++) {
        float rough = level[4 * i];
        if (normals) {
            float length = (float)masu_bake_length(masu_bake_v3f(normals + 4 * i));
            rough = masu_texel_rougher(rough * roughness, length);
        }
        bytes[4 * i] = masu_texel_to_unorm(rough);
        bytes[4 * i + 1] = masu_texel_to_unorm(level[4 * i + 1]);
        bytes[4 * i + 2] = bytes[4 * i + 3] = 255;
    }
}

/* Adds a mip to the small texture for rays; `bytes`: the encoded texels, for masks their alpha.
 * Normals, occlusion and blended surfaces are skipped: rays do not use them. */
static void keep_picture(texture *t, const float *level, const uint8_t *bytes, uint32_t w,
                         uint32_t h, uint32_t mip) {
    bool mask = t->format == MASU_TEXTURE_BC3_SRGB;
    if (!t->traced) return;
    if (t->wanted.slot == MASU_SLOT_SURFACE) {
        masu_bake_trace_surface(&t->picture, bytes, (size_t)w * h, mip == 0, mip + 1 == t->mips);
    } else if (t->wanted.slot == MASU_SLOT_EMISSIVE ||
               (t->wanted.slot == MASU_SLOT_BASE && !(mask && t->alpha == MASU_BAKE_ALPHA_BLEND))) {
        masu_bake_trace_colors(&t->picture, t->traced_side, level, w, h, mask ? bytes : NULL);
    }
}

/* Makes all mips of `level` and overwrites it; `normals`, of the same size, may be NULL. */
static void finish(texture *t, float *level, float *normals) {
    size_t texels = (size_t)t->width * t->height;
    float *scratch = allocate_level(t->width, t->height);
    uint8_t *bytes = masu_bake_allocate(texels * 4);
    bool by_alpha = t->format == MASU_TEXTURE_BC3_SRGB && !t->wanted.apart;
    double wanted = 1;
    uint32_t w = t->width, h = t->height;
    for (uint32_t mip = 0; mip < t->mips; mip++) {
        texels = (size_t)w * h;
        if (t->wanted.slot == MASU_SLOT_NORMAL) {
            encode_normal(level, texels, bytes);
        } else if (t->wanted.slot == MASU_SLOT_SURFACE || t->wanted.slot == MASU_SLOT_OCCLUSION ||
                   (t->wanted.slot == MASU_SLOT_COAT && !t->wanted.apart)) {
            encode_surface(level, normals, texels, t->wanted.roughness, bytes);
        } else {
            encode_color(level, texels, bytes);
        }
        unsigned char *blocks = append_blocks(t, bytes, w, h);
        if (t->alpha == MASU_BAKE_ALPHA_MASK && by_alpha) {
            encode_mask(t, level, w, h, mip, &wanted, bytes, blocks);
        }
        keep_picture(t, level, bytes, w, h, mip);
        if (mip + 1 == t->mips) break;
        step_down(level, scratch, w, h, by_alpha);
        if (normals) step_down(normals, scratch, w, h, false);
        w = w > 1 ? w / 2 : 1;
        h = h > 1 ? h / 2 : 1;
    }
    t->made = true;
    free(bytes);
    free(scratch);
}

/* ---- the three kinds ---- */

/* The meaning of alpha if the model does not specify it: none if no texel is below the cut-off;
 * else a mask, if the texture looks like one. Never blending: it costs a draw per object and needs
 * an order, which meshes with many leaves do not have. */
static uint8_t judge_alpha(const maker *m, const request *wanted, const float *level,
                           size_t texels) {
    uint64_t below = 0, less = 0, histogram[256] = {0};
    uint8_t meant = wanted->alpha;
    for (size_t i = 0; i < texels; i++) {
        float a = level[4 * i + 3];
        less += a < 0.999f;
        below += a < wanted->cutoff;
        histogram[masu_texel_to_unorm(a)]++;
    }
    if (meant == MASU_BAKE_ALPHA_OPAQUE || !less) return MASU_BAKE_ALPHA_OPAQUE;
    if (meant == MASU_BAKE_ALPHA_MASK || meant == MASU_BAKE_ALPHA_BLEND) return meant;
    if (!below) return MASU_BAKE_ALPHA_OPAQUE;
    if (meant == MASU_BAKE_ALPHA_COVERS ||
        masu_mask_is_meant(histogram, masu_texel_to_unorm(wanted->cutoff)))
        return MASU_BAKE_ALPHA_MASK;
    if (!m->sizes) {
        masu_cli_warn("texture %s: its alpha is not a mask (%.0f %% of it is below the cut-off): "
                      "treated as opaque",
                      name_of(m, wanted->image[0]), 100 * (double)below / (double)texels);
    }
    return MASU_BAKE_ALPHA_OPAQUE;
}

/* The channel of an opacity image: its alpha if that is not all opaque, else its brightness. */
static uint32_t opacity_channel(const masu_bake_picture *p) {
    for (size_t i = 0; i < p->rgba.bytes; i += 4) {
        if (p->rgba.data[i + 3] != 255) return 3;
    }
    return 0;
}

static void make_color(maker *m, texture *t) {
    masu_bake_picture color, opacity;
    bool has_color = read_picture(m, t->wanted.image[0], &color);
    bool has_opacity = (t->wanted.slot == MASU_SLOT_BASE || t->wanted.apart) &&
                       read_picture(m, t->wanted.image[1], &opacity);
    if (has_color || has_opacity) {
        const masu_bake_picture *size = has_color ? &color : &opacity;
        uint32_t w = size->width, h = size->height;
        uint32_t channel = t->wanted.apart ? t->wanted.channel[1]
                           : has_opacity   ? opacity_channel(&opacity)
                                           : 0;
        float *level = allocate_level(w, h), linear[256];
        for (int i = 0; i < 256; i++) linear[i] = masu_texel_from_srgb((uint8_t)i);
        for (uint32_t y = 0; y < h; y++) {
            for (uint32_t x = 0; x < w; x++) {
                float *to = level + 4 * ((size_t)y * w + x);
                for (uint32_t k = 0; k < 3; k++) {
                    to[k] = has_color ? linear[byte_at(&color, x, y, w, h, k)] : 1;
                }
                to[3] = has_opacity ? (float)byte_at(&opacity, x, y, w, h, channel) / 255.0f
                        : has_color && !t->wanted.apart
                            ? (float)byte_at(&color, x, y, w, h, 3) / 255.0f
                            : 1;
            }
        }
        size_t texels = (size_t)w * h;
        request judged = t->wanted;
        /* A separate opacity image is meant as opacity. */
        if (has_opacity && judged.alpha == MASU_BAKE_ALPHA_AUTO)
            judged.alpha = MASU_BAKE_ALPHA_COVERS;
        /* Nothing uses the alpha of an emission map. */
        if (judged.slot != MASU_SLOT_BASE) judged.alpha = MASU_BAKE_ALPHA_OPAQUE;
        t->alpha = judge_alpha(m, &judged, level, texels);
        bool opaque =
            t->wanted.slot == MASU_SLOT_BASE ? t->alpha == MASU_BAKE_ALPHA_OPAQUE : !has_opacity;
        begin(t, opaque ? MASU_TEXTURE_BC1_SRGB : MASU_TEXTURE_BC3_SRGB, w, h);
        finish(t, level, NULL);
        free(level);
    }
    masu_bake_release(&color.rgba);
    if (has_opacity) masu_bake_release(&opacity.rgba);
}

/* Converts heights to the normals of a map of this size. */
static float *bump_level(const masu_bake_picture *p, const request *wanted, uint32_t w,
                         uint32_t h) {
    const bool clamped[2] = {wanted->clamped[0] != 0, wanted->clamped[1] != 0};
    float *own = allocate_level(p->width, p->height);
    masu_bump_normals(p->rgba.data, p->width, p->height, (double)wanted->normal_scale, clamped,
                      own);
    if (w == p->width && h == p->height) return own;
    float *level = allocate_level(w, h);
    for (size_t i = 0; i < (size_t)w * h; i++) {
        size_t x = i % w * p->width / w, y = i / w * p->height / h;
        memcpy(level + 4 * i, own + 4 * (y * p->width + x), 4 * sizeof *level);
    }
    free(own);
    return level;
}

/* Reads normals, or converts heights, for a map of this size. */
static float *normal_level(const masu_bake_picture *p, const request *wanted, uint32_t w,
                           uint32_t h) {
    float scale = wanted->normal_scale;
    if (masu_bump_is_height(p->rgba.data, p->width, p->height, wanted->relief))
        return bump_level(p, wanted, w, h);
    float *level = allocate_level(w, h);
    for (size_t i = 0; i < (size_t)w * h; i++) {
        size_t x = i % w * p->width / w, y = i / w * p->height / h;
        const uint8_t *from = p->rgba.data + 4 * (y * p->width + x);
        masu_bake_vec3 n = {(from[0] - 128) / 127.0 * (double)scale,
                            (from[1] - 128) / 127.0 * (double)scale, (from[2] - 128) / 127.0};
        if (n.z < 0 || !masu_bake_normalize(&n)) n = masu_bake_v3(0, 0, 1);
        level[4 * i] = (float)n.x;
        level[4 * i + 1] = (float)n.y;
        level[4 * i + 2] = (float)n.z;
        level[4 * i + 3] = 1;
    }
    return level;
}

static void make_normal(maker *m, texture *t) {
    masu_bake_picture p;
    if (!read_picture(m, t->wanted.image[0], &p)) return;
    float *level = normal_level(&p, &t->wanted, p.width, p.height);
    begin(t, MASU_TEXTURE_BC5, p.width, p.height);
    finish(t, level, NULL);
    free(level);
    masu_bake_release(&p.rgba);
}

static void make_surface(maker *m, texture *t) {
    masu_bake_picture p[3];
    bool has[3];
    for (int i = 0; i < 3; i++) has[i] = read_picture(m, t->wanted.image[i], &p[i]);
    if (has[0] || has[1] || has[2]) {
        const masu_bake_picture *size = has[0] ? &p[0] : has[1] ? &p[1] : &p[2];
        uint32_t w = size->width, h = size->height;
        /* At least the size of the normal map: a smaller roughness map would add the roughness of
         * filtered normals where the normals are still visible. */
        if (has[2] && w < p[2].width) w = p[2].width;
        if (has[2] && h < p[2].height) h = p[2].height;
        float *level = allocate_level(w, h), *normals = NULL;
        for (uint32_t y = 0; y < h; y++) {
            for (uint32_t x = 0; x < w; x++) {
                float *to = level + 4 * ((size_t)y * w + x);
                for (int i = 0; i < 2; i++) {
                    to[i] = has[i]
                                ? (float)byte_at(&p[i], x, y, w, h, t->wanted.channel[i]) / 255.0f
                                : 1;
                }
                if (has[0] && t->wanted.gloss) to[0] = 1 - to[0];
                if (t->wanted.slot == MASU_SLOT_OCCLUSION)
                    to[0] = 1 - t->wanted.occlusion * (1 - to[0]);
                to[2] = to[3] = 1;
            }
        }
        if (has[2]) {
            normals = normal_level(&p[2], &t->wanted, w, h);
            t->absolute = true;
        }
        begin(t, has[1] || t->wanted.slot == MASU_SLOT_COAT ? MASU_TEXTURE_BC5 : MASU_TEXTURE_BC4,
              w, h);
        finish(t, level, normals);
        free(normals);
        free(level);
    }
    for (int i = 0; i < 3; i++) masu_bake_release(&p[i].rgba);
}

/* ---- requests ---- */

static uint32_t obtain(maker *m, const request *wanted) {
    for (uint32_t i = 0; i < m->count; i++) {
        if (memcmp(&m->textures[i].wanted, wanted, sizeof *wanted) == 0) return i;
    }
    if (m->count == m->capacity) {
        m->capacity = m->capacity ? 2 * m->capacity : 64;
        texture *grown = masu_bake_allocate(m->capacity * sizeof *grown);
        if (m->count) memcpy(grown, m->textures, m->count * sizeof *grown);
        free(m->textures);
        m->textures = grown;
    }
    texture *t = &m->textures[m->count];
    *t = (texture){.wanted = *wanted,
                   .traced = m->content->pictures_wanted,
                   .traced_side = m->content->picture_side};
    masu_cli_progress("texture %u", m->count + 1);
    switch (wanted->slot) {
    case MASU_SLOT_NORMAL: make_normal(m, t); break;
    case MASU_SLOT_OCCLUSION: /* one channel, like roughness without metallic */
    case MASU_SLOT_COAT:
    case MASU_SLOT_SURFACE:
        if (wanted->apart)
            make_color(m, t);
        else
            make_surface(m, t);
        break;
    default: make_color(m, t); break;
    }
    return m->count++;
}

static void ask_for_normals(request *r, uint32_t which, const masu_bake_maps *maps) {
    r->image[which] = maps->image[MASU_BAKE_NORMAL];
    r->normal_scale = maps->normal_scale;
    r->relief = maps->relief;
    for (int i = 0; i < 2 && r->relief; i++) r->clamped[i] = maps->wrap[i] == 1;
}

/* base: its texture, or NONE. A material that may be blended but is opaque everywhere is not. */
static bool is_blended(const maker *m, const masu_bake_maps *maps,
                       const masu_blob_material *material, uint32_t base) {
    if (maps->alpha == MASU_BAKE_ALPHA_BLEND &&
        (maps->additive || material->opacity < 0.999f || maps->colored == MASU_BAKE_COLORED_ALPHA))
        return true;
    const texture *t = base != MASU_BLOB_NONE ? &m->textures[base] : NULL;
    return t && t->format == MASU_TEXTURE_BC3_SRGB && t->alpha == MASU_BAKE_ALPHA_BLEND;
}

/* A clear coat has a separate normal map, in addition to the base's, in the slot of an emission
 * map. */
static bool has_coat_relief(const maker *m, const masu_bake_maps *maps,
                            const masu_blob_material *material,
                            const uint32_t slots[MASU_SLOT_COUNT]) {
    return maps->image[MASU_BAKE_COAT_NORMAL] != MASU_BLOB_NONE &&
           maps->image[MASU_BAKE_EMISSIVE] == MASU_BLOB_NONE && material->coat > 0 &&
           slots[MASU_SLOT_NORMAL] != MASU_BLOB_NONE &&
           !is_blended(m, maps, material, slots[MASU_SLOT_BASE]);
}

/* The textures of a material by slot; NONE if a slot is empty. */
static void request_all(maker *m, const masu_bake_maps *maps, const masu_blob_material *material,
                        uint32_t out[MASU_SLOT_COUNT]) {
    for (uint32_t slot = 0; slot < MASU_SLOT_COUNT; slot++) {
        request r;
        memset(&r, 0, sizeof r);
        r.slot = slot;
        r.image[0] = r.image[1] = r.image[2] = MASU_BLOB_NONE;
        switch (slot) {
        case MASU_SLOT_BASE:
            r.image[0] = maps->image[MASU_BAKE_BASE];
            r.image[1] = maps->image[MASU_BAKE_OPACITY];
            r.alpha = maps->alpha;
            r.cutoff = maps->cutoff;
            r.apart = maps->transmission;
            break;
        case MASU_SLOT_NORMAL:
            ask_for_normals(&r, 0, maps);
            break;
        case MASU_SLOT_SURFACE:
            r.image[0] = maps->image[MASU_BAKE_ROUGHNESS];
            r.image[1] = maps->image[MASU_BAKE_METALLIC];
            r.channel[0] = maps->channel[MASU_BAKE_ROUGHNESS];
            r.channel[1] = maps->channel[MASU_BAKE_METALLIC];
            r.gloss = maps->gloss;
            /* A normal map without a roughness map also makes one, unless the roughness is 1. */
            if (maps->image[MASU_BAKE_NORMAL] != MASU_BLOB_NONE &&
                maps->relief_of != MASU_BAKE_RELIEF_OF_COAT &&
                (r.image[0] != MASU_BLOB_NONE || material->roughness < 0.99f)) {
                ask_for_normals(&r, 2, maps);
                r.roughness = material->roughness;
            }
            break;
        case MASU_SLOT_OCCLUSION:
            r.image[0] = maps->image[MASU_BAKE_OCCLUSION];
            r.channel[0] = maps->channel[MASU_BAKE_OCCLUSION];
            r.occlusion = maps->occlusion;
            break;
        case MASU_SLOT_COAT:
            if (!(material->coat > 0) && !masu_lobe_code(material)) break;
            if (is_blended(m, maps, material, out[MASU_SLOT_BASE])) {
                if (!m->sizes &&
                    (maps->image[MASU_BAKE_COAT] & maps->image[MASU_BAKE_COAT_ROUGHNESS] &
                     maps->image[MASU_BAKE_LOBE_COLOR] & maps->image[MASU_BAKE_LOBE_STRENGTH]) !=
                        MASU_BLOB_NONE)
                    masu_cli_warn("material \"%s\": transparent materials have no maps of coat, "
                                  "specular or sheen: ignored",
                                  masu_bake_name_text(m->content, material->name));
                break;
            }
            if (!(material->coat > 0)) {
                r.image[0] = maps->image[MASU_BAKE_LOBE_COLOR];
                r.image[1] = maps->image[MASU_BAKE_LOBE_STRENGTH];
                r.channel[1] = maps->channel[MASU_BAKE_LOBE_STRENGTH];
                r.apart = 1;
                break;
            }
            r.image[0] = maps->image[MASU_BAKE_COAT];
            r.image[1] = maps->image[MASU_BAKE_COAT_ROUGHNESS];
            r.channel[0] = maps->channel[MASU_BAKE_COAT];
            r.channel[1] = maps->channel[MASU_BAKE_COAT_ROUGHNESS];
            break;
        default:
            r.image[0] = maps->image[MASU_BAKE_EMISSIVE];
            if (has_coat_relief(m, maps, material, out)) {
                r.slot = MASU_SLOT_NORMAL;
                r.image[0] = maps->image[MASU_BAKE_COAT_NORMAL];
                r.normal_scale = maps->coat_scale;
            }
            break;
        }
        out[slot] = MASU_BLOB_NONE;
        if (r.image[0] == MASU_BLOB_NONE && r.image[1] == MASU_BLOB_NONE &&
            r.image[2] == MASU_BLOB_NONE) {
            continue;
        }
        uint32_t found = obtain(m, &r);
        if (m->textures[found].made) out[slot] = found;
    }
}

/* ---- arrays ---- */

static const texture *sorted; /* qsort cannot pass a context to its comparison */

static int compare(const void *a, const void *b) {
    const uint32_t i = *(const uint32_t *)a, j = *(const uint32_t *)b;
    const texture *x = &sorted[i], *y = &sorted[j];
    const uint64_t keys[2] = {(uint64_t)x->width * x->height, (uint64_t)y->width * y->height};
    if (keys[0] != keys[1]) return keys[0] > keys[1] ? -1 : 1;
    if (x->width != y->width) return x->width > y->width ? -1 : 1;
    if (x->format != y->format) return x->format < y->format ? -1 : 1;
    return i < j ? -1 : i > j;
}

static bool same_array(const texture *a, const texture *b) {
    return a->format == b->format && a->width == b->width && a->height == b->height;
}

/* Numbers the arrays; returns how many. `made`: the length of `order`. */
static uint32_t number_arrays(maker *m, uint32_t *made) {
    *made = 0;
    free(m->order);
    m->order = masu_bake_allocate(m->count * sizeof *m->order);
    for (uint32_t i = 0; i < m->count; i++) {
        if (m->textures[i].made) m->order[(*made)++] = i;
    }
    sorted = m->textures;
    if (*made) qsort(m->order, *made, sizeof *m->order, compare);
    uint32_t arrays = 0;
    for (uint32_t i = 0; i < *made; i++) {
        texture *t = &m->textures[m->order[i]];
        const texture *before = i ? &m->textures[m->order[i - 1]] : NULL;
        if (before && same_array(before, t) && before->layer + 1 < MASU_TEXTURE_LAYERS_MAX) {
            t->array = before->array;
            t->layer = before->layer + 1;
        } else {
            t->array = arrays++;
            t->layer = 0;
        }
    }
    return arrays;
}

static void write_arrays(maker *m, uint32_t made) {
    masu_bake_content *c = m->content;
    masu_bake_buffer *texels = &c->section[MASU_BLOB_TEXELS];
    for (uint32_t i = 0; i < made; i++) {
        const texture *t = &m->textures[m->order[i]];
        if (t->layer == 0) {
            uint32_t image = t->wanted.image[0];
            for (int k = 1; k < 3 && image == MASU_BLOB_NONE; k++) image = t->wanted.image[k];
            const char *name = name_of(m, image);
            const char *slash = strrchr(name, '/');
            if (slash) name = slash + 1;
            masu_bake_append(texels, NULL, (size_t)(-texels->bytes % MASU_BLOB_ALIGN));
            masu_blob_texture row = {.format = t->format,
                                     .width = t->width,
                                     .height = t->height,
                                     .mips = t->mips,
                                     .name = masu_bake_name(c, name, strlen(name)),
                                     .offset = texels->bytes};
            masu_bake_append(&c->section[MASU_BLOB_TEXTURES], &row, sizeof row);
        }
        MASU_BAKE_ARRAY(c, MASU_BLOB_TEXTURES, masu_blob_texture)[t->array].layers++;
        masu_bake_append(texels, t->blocks.data, t->blocks.bytes);
        masu_bake_trace_keep(c, t->array, t->layer, &t->picture);
    }
    masu_bake_append(texels, NULL, (size_t)(-texels->bytes % MASU_BLOB_ALIGN));
}

/* ---- materials ---- */

static uint32_t set_of(masu_bake_content *c, const masu_blob_texture_set *set) {
    uint64_t count = masu_bake_count(c, MASU_BLOB_TEXTURE_SETS);
    const masu_blob_texture_set *sets =
        MASU_BAKE_ARRAY(c, MASU_BLOB_TEXTURE_SETS, const masu_blob_texture_set);
    for (uint64_t i = 0; i < count; i++) {
        if (memcmp(&sets[i], set, sizeof *set) == 0) return (uint32_t)i;
    }
    masu_bake_append(&c->section[MASU_BLOB_TEXTURE_SETS], set, sizeof *set);
    return (uint32_t)count;
}

static void point(maker *m, masu_blob_material *material, const masu_bake_maps *maps,
                  const uint32_t slots[MASU_SLOT_COUNT]) {
    masu_blob_texture_set set = {.wrap = {maps->wrap[0] + 4u * maps->nearest, maps->wrap[1]}};
    uint32_t flags =
                 is_blended(m, maps, material, slots[MASU_SLOT_BASE]) ? MASU_MATERIAL_IS_BLEND : 0,
             layers = 0;
    for (uint32_t slot = 0; slot < MASU_SLOT_COUNT; slot++) {
        set.texture[slot] = MASU_BLOB_NONE;
        if (slots[slot] == MASU_BLOB_NONE) continue;
        const texture *t = &m->textures[slots[slot]];
        set.texture[slot] = t->array;
        if (slot >= MASU_SLOT_OCCLUSION)
            material->more_layers |= t->layer << 8 * (slot - MASU_SLOT_OCCLUSION);
        else
            layers |= t->layer << 8 * slot;
        bool relief = slot == MASU_SLOT_EMISSIVE && t->wanted.slot == MASU_SLOT_NORMAL;
        flags |= relief ? (uint32_t)MASU_MATERIAL_COAT_RELIEF : 1u << slot;
        if (slot == MASU_SLOT_COAT && t->wanted.apart) flags |= MASU_MATERIAL_LOBE_MAP;
        if (slot == MASU_SLOT_BASE && t->format == MASU_TEXTURE_BC3_SRGB) {
            if (t->wanted.apart) flags |= MASU_MATERIAL_TRANSMISSION_MAP;
            if (t->alpha != MASU_BAKE_ALPHA_BLEND) {
                flags |= MASU_MATERIAL_IS_MASK;
                flags |= (uint32_t)masu_texel_to_unorm(maps->cutoff) << MASU_MATERIAL_CUTOFF_SHIFT;
            }
        }
        if (slot == MASU_SLOT_SURFACE && t->format == MASU_TEXTURE_BC5) {
            flags |= MASU_MATERIAL_HAS_METAL;
        }
        if (t->absolute) material->roughness = 1;
    }
    /* An emissive factor is often white and only meant to scale its map: without the map, the
     * material would be a lamp. Only an unlit material keeps the factor, since it is its colour. */
    if ((maps->image[MASU_BAKE_EMISSIVE] != MASU_BLOB_NONE || maps->dark) && !maps->unlit &&
        !(flags & 1u << MASU_SLOT_EMISSIVE)) {
        memset(material->emissive, 0, sizeof material->emissive);
    }
    if (maps->additive && flags & MASU_MATERIAL_IS_BLEND) flags |= MASU_MATERIAL_IS_ADDITIVE;
    if (maps->tinted && flags & MASU_MATERIAL_IS_BLEND) flags |= MASU_MATERIAL_IS_TINTED;
    if (material->thickness > 0 && (!(flags & MASU_MATERIAL_IS_TINTED) ||
                                    flags & MASU_MATERIAL_HAS_METAL || material->metallic > 0)) {
        masu_cli_warn("material \"%s\": its thickness is ignored: it is metallic, or not blended "
                      "as \"tinted\"",
                      masu_bake_name_text(m->content, material->name));
        material->thickness = material->ior = 0;
    }
    if (maps->single) flags |= MASU_MATERIAL_IS_SINGLE;
    if (maps->shadowless) flags |= MASU_MATERIAL_NO_SHADOW;
    if (material->coat > 0 && flags & 1u << MASU_SLOT_NORMAL) {
        if (maps->relief_of == MASU_BAKE_RELIEF_OF_BASE) flags |= MASU_MATERIAL_COAT_SMOOTH;
        if (maps->relief_of == MASU_BAKE_RELIEF_OF_COAT) flags |= MASU_MATERIAL_BASE_SMOOTH;
    }
    if (!(flags & MASU_MATERIAL_IS_BLEND)) material->opacity = 1;
    material->flags = flags;
    if (!(flags & MASU_MATERIAL_HAS_MAPS)) return;
    material->layers = layers;
    /* Blended materials have no room for it, and no maps of the second coordinates
     * (gltf_material.c). */
    uint32_t second = flags & MASU_MATERIAL_HAS_MAPS;
    if (!(flags & MASU_MATERIAL_IS_BLEND) && flags & MASU_MATERIAL_COAT_RELIEF)
        second |= 1u << MASU_SLOT_EMISSIVE;
    material->more_layers |= (maps->second & second) << 16;
    material->texture_set = set_of(m->content, &set);
}

static void forget(maker *m) {
    for (uint32_t i = 0; i < m->count; i++) {
        masu_bake_release(&m->textures[i].blocks);
        masu_bake_release(&m->textures[i].picture.texels);
    }
    m->count = 0;
}

/* On an axis whose coordinates are all in 0..1 the texture appears once, so it is clamped: its edge
 * is then not filtered with the opposite one. Not if a detail texture repeats it more often. */
static void clamp_what_is_shown_once(masu_bake_content *content) {
    size_t materials = (size_t)masu_bake_count(content, MASU_BLOB_MATERIALS);
    const float *texcoords = MASU_BAKE_ARRAY(content, MASU_BLOB_TEXCOORDS, const float);
    if (!masu_bake_count(content, MASU_BLOB_TEXCOORDS)) return;
    bool(*repeats)[2] = masu_bake_allocate(materials * sizeof *repeats);
    memset(repeats, 0, materials * sizeof *repeats);
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_PRIMITIVES); i++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[i];
        for (uint32_t v = 0; v < p->vertex_count; v++) {
            for (int k = 0; k < 2; k++) {
                float at = texcoords[2 * ((size_t)p->first_vertex + v) + (size_t)k];
                if (!(at >= -SHOWN_ONCE_SLACK && at <= 1 + SHOWN_ONCE_SLACK))
                    repeats[p->material][k] = true;
            }
        }
    }
    for (size_t i = 0; i < materials; i++) {
        masu_bake_maps *maps = &MASU_BAKE_MAPS_OF(content)[i];
        for (int k = 0; k < 2; k++) {
            if (!repeats[i][k] && maps->wrap[k] == 0 && !maps->second &&
                MASU_BAKE_MATERIALS(content)[i].detail[k] == 1)
                maps->wrap[k] = 1;
        }
    }
    free(repeats);
}

bool masu_bake_make_textures(masu_bake_content *content, const char *directories) {
    masu_bake_whiten(content);
    size_t materials = (size_t)masu_bake_count(content, MASU_BLOB_MATERIALS);
    size_t images = content->images.bytes / sizeof(masu_bake_image);
    maker m = {.content = content, .directories = directories};
    clamp_what_is_shown_once(content);
    for (size_t i = 0; i < 2 * materials; i++) {
        uint8_t *wrap = &MASU_BAKE_MAPS_OF(content)[i / 2].wrap[i % 2];
        if (*wrap == MASU_BAKE_WRAP_REPEAT) *wrap = 0;
    }
    uint32_t(*slots)[MASU_SLOT_COUNT] = masu_bake_allocate(materials * sizeof *slots);
    m.failed = masu_bake_allocate(images);
    memset(m.failed, 0, images);
    m.reduced = masu_bake_allocate(images);
    memset(m.reduced, 0, images);
    uint32_t arrays = 0, made = 0;
    for (m.sizes = 0; m.sizes < MASU_BAKE_SIZES; m.sizes++) {
        forget(&m);
        for (size_t i = 0; i < materials; i++) {
            request_all(&m, &MASU_BAKE_MAPS_OF(content)[i], &MASU_BAKE_MATERIALS(content)[i],
                        slots[i]);
        }
        arrays = number_arrays(&m, &made);
        if (arrays <= MASU_TEXTURE_ARRAYS_MAX) break;
        masu_cli_warn("found %u combinations of texture size and format, expected at most %u: %s",
                      arrays, MASU_TEXTURE_ARRAYS_MAX,
                      m.sizes ? "images are resized to squares"
                              : "images are resized to powers of two");
    }
    masu_cli_progress_clear();
    bool good = arrays <= MASU_TEXTURE_ARRAYS_MAX;
    if (!good) {
        masu_cli_error("found %u combinations of texture size and format, expected at most %u",
                       arrays, MASU_TEXTURE_ARRAYS_MAX);
    } else {
        write_arrays(&m, made);
        for (size_t i = 0; i < materials; i++) {
            point(&m, &MASU_BAKE_MATERIALS(content)[i], &MASU_BAKE_MAPS_OF(content)[i], slots[i]);
        }
        masu_bake_finish_attributes(content);
        if (!made) masu_bake_release(&content->section[MASU_BLOB_TEXCOORDS]);
    }
    forget(&m);
    free(m.textures);
    free(m.order);
    free(m.failed);
    free(m.reduced);
    free(slots);
    return good;
}

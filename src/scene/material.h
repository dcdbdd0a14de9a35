/* material.h: conversion of a blob material to the layout of the shaders. */
#ifndef MASU_MATERIAL_H
#define MASU_MATERIAL_H

#include "scene/blob.h"
#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

static inline uint32_t masu_root_steps(float value, float steps) {
    return (uint32_t)(sqrtf(value < 0.0f ? 0.0f : value < 1.0f ? value : 1.0f) * steps + 0.5f);
}

/* Index of the brightest channel, and the square roots of the other two relative to it, in 26 steps
 * each. The same code as from masu_hue_code of pack.glsl. */
static inline uint32_t masu_hue_code(const float color[3]) {
    uint32_t most = color[0] >= color[1] && color[0] >= color[2] ? 0 : color[1] >= color[2] ? 1 : 2;
    const float scale = color[most] > 0.0f ? 1.0f / color[most] : 0.0f;
    return (most * 26 + masu_root_steps(color[(most + 1) % 3] * scale, 25.0f)) * 26 +
           masu_root_steps(color[(most + 2) % 3] * scale, 25.0f);
}

/* Whether the channels differ; 0, 0, 0 is treated as grey. */
static inline int masu_is_colored(const float hue[3]) {
    return hue[0] != hue[1] || hue[1] != hue[2];
}

/* The 23-bit code (pack.glsl) of a specular lobe other than GGX with a grey f0 of at most 0.08; 0
 * for that one. */
static inline uint32_t masu_lobe_code(const masu_blob_material *m) {
    const float pi = 3.14159265f, *sheen = m->sheen_color, *hue = m->specular_color;
    float most = sheen[0] > sheen[1] ? sheen[0] : sheen[1];
    most = most > sheen[2] ? most : sheen[2];
    if (most > 0.0f) {
        return MASU_LOBE_SHEEN << 21 | masu_hue_code(sheen) << 10 |
               masu_root_steps(most, 31.0f) << 5 | (uint32_t)(m->sheen_roughness * 31.0f + 0.5f);
    }
    if (m->anisotropy > 0.0f) {
        uint32_t angle = (uint32_t)(m->anisotropy_rotation / pi * 128.0f + 0.5f) & 127u;
        return MASU_LOBE_GRAIN << 21 | (uint32_t)(m->specular * 127.0f + 0.5f) << 14 | angle << 7 |
               (uint32_t)(m->anisotropy * 127.0f + 0.5f);
    }
    const float gray[3] = {1.0f, 1.0f, 1.0f};
    int colored = masu_is_colored(hue);
    if (!colored && m->specular <= 1.0f &&
        (m->flags & MASU_MATERIAL_IS_BLEND || !(m->flags & MASU_MATERIAL_LOBE_MAP)))
        return 0;
    return MASU_LOBE_COLORED << 21 | masu_hue_code(colored ? hue : gray) << 8 |
           masu_root_steps(m->specular * 0.08f, 255.0f);
}

/* The specular factor of the shaders; a negative value is a lobe code. */
static inline float masu_specular_of(const masu_blob_material *m) {
    uint32_t code = masu_lobe_code(m);
    return code ? -(float)(code + 1u) : m->specular;
}

/* The nearest half of a number from 0 to 65504; 0 below 2^-14. */
static inline uint32_t masu_half_of(float value) {
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return value >= 0x1p-14f ? (bits - (112u << 23) + (1u << 12)) >> 13 : 0u;
}

/* Metallic of the shaders; of a material that refracts the bits of two halves (materials.h). */
static inline float masu_metallic_of(const masu_blob_material *m) {
    if (!(m->thickness > 0.0f)) return m->metallic;
    uint32_t bits = (0x8000u | masu_half_of(m->ior)) << 16 | masu_half_of(m->thickness);
    float packed;
    memcpy(&packed, &bits, sizeof packed);
    return packed;
}

static inline struct masu_material_data masu_material_data_of(const masu_blob_material *m) {
    struct masu_material_data d = {
        {m->base_color[0], m->base_color[1], m->base_color[2], m->roughness},
        {m->emissive[0], m->emissive[1], m->emissive[2], masu_metallic_of(m)},
        {masu_specular_of(m), m->coat, m->coat_roughness, m->opacity}};
    return d;
}

/* Whether an opaque material emits at least the minimum that shaders treat as emission
 * (masu_emissive_least, pack.glsl). */
static inline int masu_material_emits(const masu_blob_material *m) {
    const float least = 1.0f / 1024.0f;
    if (m->flags & MASU_MATERIAL_IS_BLEND) return 0;
    return m->emissive[0] >= least || m->emissive[1] >= least || m->emissive[2] >= least;
}

/* Opaque materials of one kind share pipelines. 0: untextured, 1: textured, 2: alpha-tested. */
static inline uint32_t masu_draw_kind(uint32_t material_flags) {
    if (!(material_flags & MASU_MATERIAL_HAS_MAPS)) return 0;
    return material_flags & MASU_MATERIAL_IS_MASK ? 2 : 1;
}

#endif

/* material.h: conversion of a blob material to the layout of the shaders. */
#ifndef MASU_MATERIAL_H
#define MASU_MATERIAL_H

#include "scene/blob.h"
#include "shared/masu_shared.h"

static inline struct masu_material_data masu_material_data_of(const masu_blob_material *m) {
    struct masu_material_data d = {
        {m->base_color[0], m->base_color[1], m->base_color[2], m->roughness},
        {m->emissive[0], m->emissive[1], m->emissive[2], m->metallic},
        {m->specular, m->coat, m->coat_roughness, m->opacity}};
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

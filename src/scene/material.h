/* material.h: a material of the blob as shaders have it. */
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

#endif

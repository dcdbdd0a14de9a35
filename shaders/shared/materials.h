/* materials.h: instances, materials and their flags. */
#ifndef MASU_SHARED_MATERIALS_H
#define MASU_SHARED_MATERIALS_H

#include "shared/types.h"

/* Material flags of the G-buffer: two bits of the packed normal. */
#define MASU_SURFACE_EMISSIVE 1u
#define MASU_SURFACE_MORE 2u /* the surface image holds the remaining parameters */

/* Flags of a textured material; src/scene/blob.h defines the same bits. */
#define MASU_MAP_BASE 1u
#define MASU_MAP_NORMAL 2u
#define MASU_MAP_SURFACE 4u
#define MASU_MAP_EMISSIVE 8u
#define MASU_MAP_OCCLUSION 16u
#define MASU_MAP_COAT 32u
#define MASU_MAP_ADDITIVE 0x10000u
#define MASU_MAP_FAR_SIDE_FIRST 32u      /* transparent, no coat map: drawn twice, far side first */
#define MASU_MAP_TRANSMISSION 0x20000u   /* alpha of the base colour is transmission */
#define MASU_MAP_LOBE 0x10000u           /* opaque: the coat's map is the lobe's */
#define MASU_MAP_COAT_RELIEF 0x100000u   /* opaque: the map of emission has the coat's normals */
#define MASU_MAP_SINGLE 0x40000u         /* single-sided: culled from behind */
#define MASU_MAP_METAL 0x80000u
#define MASU_MAP_TINTED 0x100000u        /* transmission is tinted by the base colour */
#define MASU_MAP_COAT_SMOOTH 0x200000u
#define MASU_MAP_BASE_SMOOTH 0x400000u
#define MASU_MAP_CUTOFF_SHIFT 8
#define MASU_MAP_OCCLUSION_SHIFT 24 /* 8 bits: the layer of the occlusion map */

/* Transmission: of masu_scene_data.tints, and the roughness up to which glass does not blur. */
#define MASU_TINTS_ROUGH 2u
#define MASU_TINTS_MAPPED 4u /* and some with a map of it */
#define MASU_TINTS_REFRACTED 8u /* and some with a thickness, which refracts the background */
#define MASU_SHARP_GLASS 0.05

/* Kinds of lobes beyond GGX with a grey f0 up to 0.08 (pack.glsl, masu_lobe_code); bit 1 << kind of
 * masu_extra_lobes. */
#define MASU_LOBE_COLORED 1u /* f0 of any colour and strength */
#define MASU_LOBE_SHEEN 2u
#define MASU_LOBE_GRAIN 3u /* anisotropic */

/* Transform of an instance: the rows of the 3x4 matrix object -> world space. With looks of
 * instances (MASU_DRAWS_LOOKS) the second half of the buffer has them: row0 rgb factor on the base
 * colour, w on the emission; row1 texture coordinates: xy offset, zw scale; row2.x fraction of
 * pixels not drawn. */
struct masu_instance_data {
    masu_vec4 row0;
    masu_vec4 row1;
    masu_vec4 row2;
};

/* Parts that vertex shaders add to a draw: bits of specialisation constant 22. */
#define MASU_DRAWS_LOOKS 1u  /* looks of instances: tint, fade, texture coordinates */
#define MASU_DRAWS_BIASES 2u /* depth biases of materials */

struct masu_material_data {
    masu_vec4 base_color; /* rgb linear albedo; w perceptual roughness 0..1 */
    /* rgb linear radiance, 0: not emissive; w metallic 0..1. Materials that refract have none: w is
     * negative, the bits of two halves: thickness, then -index of refraction. */
    masu_vec4 emissive;
    /* specular (below 0: -1 - lobe), coat, coat roughness, opacity: each 0..1; opacity plus twice
     * the number of the live texture, 0: none */
    masu_vec4 more;
};

#endif

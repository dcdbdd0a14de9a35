/* texel.h: packs and unpacks the material in the two G-buffer texels of a surface, as
 * shaders/shared/pack.glsl does, in double precision. A material is albedo r g b, roughness,
 * emissive r g b, metallic. Pure functions. */
#ifndef MASU_MEASURE_TEXEL_H
#define MASU_MEASURE_TEXEL_H

#include <stdbool.h>
#include <stdint.h>

/* Emissive, black and fully rough: incident light has no visible effect. */
bool masu_texel_unlit(const double material[8]);
bool masu_texel_is_unlit(uint32_t normal);
/* Unpacks a texel of MASU_READBACK_ALBEDO and one of _NORMAL. They hold no emission, so it is 0. */
void masu_texel_unpack(const uint8_t albedo[4], uint32_t normal, double material[8]);
/* Packs a material. *normal receives the six bits that are not the direction. */
void masu_texel_pack(const double material[8], uint8_t albedo[4], uint32_t *normal);
/* The same for a ray hit, whose texels also hold emission. */
void masu_texel_unpack_met(const uint8_t albedo[4], uint32_t normal, double material[8]);
void masu_texel_pack_met(const double material[8], uint8_t albedo[4], uint32_t *normal);
/* Converts IEEE 754 binary16. */
float masu_texel_half(uint16_t bits);

#endif

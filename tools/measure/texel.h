/* texel.h: what the two texels of a surface in the G-buffer say of its look, as shaders/shared/pack.glsl has
 * it, in double precision. A material is albedo r g b, roughness, emissive r g b, metallic. Pure functions. */
#ifndef MASU_MEASURE_TEXEL_H
#define MASU_MEASURE_TEXEL_H

#include <stdbool.h>
#include <stdint.h>

/* It shines and has neither colour nor gloss: nothing of what falls on it is seen. */
bool masu_texel_unlit(const double material[8]);
bool masu_texel_is_unlit(uint32_t normal);
/* The surface of a texel of MASU_READBACK_ALBEDO and one of _NORMAL. They hold no emission, so it
 * is 0. */
void masu_texel_unpack(const uint8_t albedo[4], uint32_t normal, double material[8]);
/* To texels; of the normal the six bits that are not its direction. */
void masu_texel_pack(const double material[8], uint8_t albedo[4], uint32_t *normal);
/* The same of a ray hit, whose texels hold emission too. */
void masu_texel_unpack_met(const uint8_t albedo[4], uint32_t normal, double material[8]);
void masu_texel_pack_met(const double material[8], uint8_t albedo[4], uint32_t *normal);
/* Of 16 bits: IEEE 754 binary16. */
float masu_texel_half(uint16_t bits);

#endif

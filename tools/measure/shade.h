/* shade.h: the colour of a true surface: light.comp and tonemap.comp in double precision, so
 * that the truth is a picture too and pictures can be compared by what a viewer sees.
 *
 * The material is rounded as the G-buffer's texels are (texel.h): that is no error of the march. Normals, radiance and the tone curve are not.
 *
 * A frame's own G-buffer can be shaded too. Two pictures shaded here differ by what the march found
 * and by nothing else; the picture that the GPU shows also has the driver's rounding in it
 * (lavapipe of Mesa 22.3 cuts halves off instead of rounding them: one step of 255 on every eighth
 * pixel of a sphere, which FLIP counts as 0.005 there). Pure functions. */
#ifndef MASU_MEASURE_SHADE_H
#define MASU_MEASURE_SHADE_H

#include "measure/truth.h"

/* Radiance towards the eye along `direction` (unit), before exposure. */
void masu_shade_sky(const masu_view *view, const double direction[3], double out[3]);
/* material: as masu_truth.material gives it. */
void masu_shade_surface(const masu_view *view, const double direction[3], const double normal[3],
                        const double material[8], double out[3]);
/* The sky alone, without the glow around the sun: what surfaces mirror. */
void masu_shade_open_sky(const masu_view *view, const double direction[3], double out[3]);
/* A surface without the rounding, in two parts: what it mirrors of the open sky, by the lobe's albedo, and
 * the rest, sun and ambient light, and what it emits. */
void masu_shade_exact(const masu_view *view, const double direction[3], const double normal[3],
                      const double material[8], double lit[3], double mirrored[3]);
/* A texel of MASU_READBACK_ALBEDO and one of _NORMAL, and the emission beside them, as light.comp
 * reads them. */
void masu_shade_texel(const masu_view *view, const double direction[3], const uint8_t albedo[4],
                      uint32_t normal, const double emission[3], double out[3]);
/* Exposure, tone curve, sRGB encoding, 8 bits. */
void masu_shade_encode(const masu_view *view, const double radiance[3], uint8_t rgba[4]);

/* All samples of masu_truth_image to RGBA8, as many columns and rows. UNSURE is given the sky. */
void masu_shade_image(const masu_truth *truth, const masu_view *view, uint32_t stride,
                      const masu_truth_sample *samples, uint8_t *rgba);

#endif

/* shade.h: shades a surface in double precision like light.comp and tonemap.comp, so that the
 * ground truth becomes an image and can be compared by perceptual metrics.
 *
 * The material is rounded like the G-buffer's texels (texel.h), because that is not an error of the
 * march. Normals, radiance and the tone curve are not rounded.
 *
 * The G-buffer of a frame can be shaded, too. Two images shaded here differ only by their marches;
 * an image of the GPU also contains the driver's rounding. (lavapipe of Mesa 22.3 truncates halves:
 * one step of 255 on every eighth pixel of a sphere, a FLIP error of 0.005 there.) Pure
 * functions. */
#ifndef MASU_MEASURE_SHADE_H
#define MASU_MEASURE_SHADE_H

#include "measure/truth.h"

/* Radiance towards the camera along `direction` (unit), before exposure. */
void masu_shade_sky(const masu_view *view, const double direction[3], double out[3]);
/* material: the format of masu_truth.material. */
void masu_shade_surface(const masu_view *view, const double direction[3], const double normal[3],
                        const double material[8], double out[3]);
/* The sky without the glow around the sun, as reflected by surfaces. */
void masu_shade_open_sky(const masu_view *view, const double direction[3], double out[3]);
/* A surface without rounding, in two parts. mirrored: its reflection of the sky, weighted by the
 * lobe's albedo. lit: everything else, which is sun, ambient light and emission. */
void masu_shade_exact(const masu_view *view, const double direction[3], const double normal[3],
                      const double material[8], double lit[3], double mirrored[3]);
/* Shades a texel of MASU_READBACK_ALBEDO and one of _NORMAL with a separate emission, as light.comp
 * does. */
void masu_shade_texel(const masu_view *view, const double direction[3], const uint8_t albedo[4],
                      uint32_t normal, const double emission[3], double out[3]);
/* Exposure, tone curve, sRGB encoding, 8 bits. */
void masu_shade_encode(const masu_view *view, const double radiance[3], uint8_t rgba[4]);

/* Shades all samples of masu_truth_image to RGBA8, with the same columns and rows. UNSURE samples
 * show the sky. */
void masu_shade_image(const masu_truth *truth, const masu_view *view, uint32_t stride,
                      const masu_truth_sample *samples, uint8_t *rgba);

#endif

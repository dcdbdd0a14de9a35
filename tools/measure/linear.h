/* linear.h: images of linear light (MASU_READBACK_HDR): their mean, and what the tone curve makes
 * of it.
 *
 * Three floats a pixel, top row first. The curves are those of shaders/shared/tone.glsl for 8 bits
 * of sRGB; tests/gpu/test_truth.c compares them with the pass. */
#ifndef MASU_MEASURE_LINEAR_H
#define MASU_MEASURE_LINEAR_H

#include "session.h"

/* The HDR image of a slot's last frame; infinity is the largest half, NaN is 0. `size`: the render
 * size. False: the renderer does not read it back, or it has another size. */
bool masu_linear_read(const masu_renderer *m, uint32_t slot, VkExtent2D size, float *rgb);

/* Exposure of the slot's last frame: `light`'s, or the scene's if it is NULL; with auto-exposure
 * (metered) the factor that the frame was shown with, which needs debug.counters. */
double masu_linear_exposure(masu_session *s, uint32_t slot, const masu_light *light);
bool masu_linear_is_metered(const masu_session *s);

/* Display light, 3 floats a pixel from 0 to 1: exposure and the tone curve of the session. May be
 * in place. */
void masu_linear_show(const masu_session *s, const float *rgb, size_t pixels, double exposure,
                      float *shown);

/* sRGB of display light, 4 bytes a pixel; alpha is 255. */
void masu_srgb_encode(const float *shown, size_t pixels, uint8_t *rgba);

/* IEC 61966-2-1: 8 bits to 0..1, and to the nearest 8 bits. */
float masu_srgb_decoded(uint8_t encoded);
uint8_t masu_srgb_encoded(float linear);

#endif

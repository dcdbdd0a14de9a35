/* linear.h: images of linear light (MASU_READBACK_HDR) and their tone mapping on the CPU.
 *
 * Three floats per pixel, top row first. The curves match shaders/shared/tone.glsl with 8-bit sRGB
 * output; tests/gpu/test_truth.c compares them with the pass. */
#ifndef MASU_MEASURE_LINEAR_H
#define MASU_MEASURE_LINEAR_H

#include "session.h"

/* Reads the HDR image of a slot's last frame; infinity becomes the largest half, NaN becomes 0.
 * `size`: the render size. Returns false if the renderer does not read the image back, or if its
 * size differs. */
bool masu_linear_read(const masu_renderer *m, uint32_t slot, VkExtent2D size, float *rgb);

/* Exposure of the slot's last frame: `light`'s, or the scene's if `light` is NULL. With
 * auto-exposure (metered) it is the factor that the frame used, which needs debug.counters. */
double masu_linear_exposure(masu_session *s, uint32_t slot, const masu_light *light);
bool masu_linear_is_metered(const masu_session *s);

/* Applies the exposure and the session's tone curve. shown: display-linear colour, 3 floats per
 * pixel from 0 to 1. May be in place. */
void masu_linear_show(const masu_session *s, const float *rgb, size_t pixels, double exposure,
                      float *shown);

/* Encodes display-linear colour as sRGB, 4 bytes per pixel; alpha is 255. */
void masu_srgb_encode(const float *shown, size_t pixels, uint8_t *rgba);

/* IEC 61966-2-1: from 8 bits to 0..1, and to the nearest 8-bit value. */
float masu_srgb_decoded(uint8_t encoded);
uint8_t masu_srgb_encoded(float linear);

#endif

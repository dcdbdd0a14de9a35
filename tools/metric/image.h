/* image.h: differences of two 8-bit images: mean difference, RMSE, PSNR, SSIM; relative errors of
 * linear light.
 *
 * Images are RGBA8, tightly packed, top row first, display-encoded; alpha is ignored. Nothing here
 * keeps state; only masu_metric_ssim allocates, and frees before it returns. */
#ifndef MASU_METRIC_IMAGE_H
#define MASU_METRIC_IMAGE_H

#include <stdint.h>

/* Root of the mean squared difference over all pixels and the channels R, G, B, as a fraction of
 * 255. */
double masu_metric_rmse(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height);

/* Mean absolute difference over all pixels and the channels R, G, B, of 255; for two successive
 * frames this is their flicker. */
double masu_metric_difference(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height);

/* 20 log10(1 / rmse), dB; INFINITY for equal images. */
double masu_metric_psnr(double rmse);

/* Mean structural similarity of luma (Rec. 709 weights on the encoded values): Wang et al., "Image
 * quality assessment: from error visibility to structural similarity", IEEE TIP 13-4, 2004, with
 * their 11x11 Gaussian window of sigma 1.5 and K1 = 0.01, K2 = 0.03. The mean is over the windows
 * inside the image; an image smaller than a window has one window per pixel, with its edge
 * repeated. 1: equal. NAN: no memory. */
double masu_metric_ssim(const uint8_t *a, const uint8_t *b, uint32_t width, uint32_t height);

/* Linear light, 3 floats per pixel; pixels that are not finite in either image are excluded. */
typedef struct masu_relative_error {
    double rmse;   /* root of the mean squared difference, divided by the mean of the reference */
    double relmse; /* mean of (x - t)^2 / (t^2 + 0.01), as measure/specular.h */
    uint64_t left_out;
} masu_relative_error;
masu_relative_error masu_metric_relative(const float *reference, const float *test,
                                         uint32_t pixels);

#endif

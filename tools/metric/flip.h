/* flip.h: LDR-FLIP, the difference perceived when flipping between two images.
 *
 * P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild: "FLIP: A
 * Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3-2, 2020.
 *
 * Verification: tests/unit/test_metrics.c compares this file with a second, slow implementation of
 * the paper's formulas (2-D kernels, not separated) and with values computed by hand (black against
 * white, one grey against another). The constants were compared with the authors' published code by
 * reading. It has not been run side by side with that code. */
#ifndef MASU_METRIC_FLIP_H
#define MASU_METRIC_FLIP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The paper's default viewer: 0.7 m from a 0.7 m wide screen of 3840 pixels. */
#define MASU_FLIP_PPD (3840.0 * 3.14159265358979323846 / 180.0)

typedef struct masu_flip {
    double mean, p99, max; /* 0 (no difference) to 1 */
} masu_flip;

/* RGBA8, tightly packed, sRGB-encoded, alpha ignored. ppd: pixels per degree of vision; 0:
 * MASU_FLIP_PPD. map: width * height errors, or NULL. Returns false if there is no memory. */
bool masu_metric_flip(const uint8_t *reference, const uint8_t *test, uint32_t width,
                      uint32_t height, double ppd, float *map, masu_flip *out);

/* The same for linear light, 3 doubles per pixel, each 0..1. errors: width * height. */
bool masu_metric_flip_linear(const double *reference, const double *test, uint32_t width,
                             uint32_t height, double ppd, double *errors);

/* Statistics of n errors, at least one. Sorts them; map receives them unsorted, or is NULL. */
void masu_flip_summarise(double *errors, size_t n, float *map, masu_flip *out);

#endif

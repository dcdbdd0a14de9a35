/* model_error.h: the error of the closed-form model against random walks (bsdf.h). */
#ifndef LAB_REFERENCE_MODEL_ERROR_H
#define LAB_REFERENCE_MODEL_ERROR_H

#include <stdint.h>
#include <stdio.h>

/* Prints a table of materials by roughness and view angle: the light that each model reflects, and
 * the fraction that has another direction. paths: per entry. */
void ref_model_error(FILE *to, uint32_t paths, uint64_t seed);

#endif

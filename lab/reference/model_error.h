/* model_error.h: how far the closed model is from the walks that it stands for (bsdf.h). */
#ifndef LAB_REFERENCE_MODEL_ERROR_H
#define LAB_REFERENCE_MODEL_ERROR_H

#include <stdint.h>
#include <stdio.h>

/* A table of materials by roughness and angle of view: how much light each model returns, and the
 * part of it that goes elsewhere. paths: of each entry. */
void ref_model_error(FILE *to, uint32_t paths, uint64_t seed);

#endif

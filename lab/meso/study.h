/* study.h: compares a material made by masu-meso from a patch with ray tracing: with new rays,
 * under other lights than those of the fit. */
#ifndef LAB_MESO_STUDY_H
#define LAB_MESO_STUDY_H

#include "meso/author.h"

/* The view angles of the comparison. */
#define MASU_MESO_JUDGED 5u
extern const double masu_meso_judged[MASU_MESO_JUDGED];
/* Map sizes at which single texels are compared. */
#define MASU_MESO_LEVELS 3u
extern const uint32_t masu_meso_level_size[MASU_MESO_LEVELS];
/* Bins of the shadow's distribution, by offset - alpha (1 - AO) of the texel. */
#define MASU_MESO_BINS 24u

/* Map sizes of the mips whose mean is compared with that of the map. */
#define MASU_MESO_MIPS 3u
extern const uint32_t masu_meso_mip_size[MASU_MESO_MIPS];

/* Root mean square errors of radiance over lights, relative to the mean radiance. */
typedef struct masu_meso_verdict {
    double far[MASU_MESO_WAYS];
    double texel[MASU_MESO_LEVELS][MASU_MESO_WAYS];
    double filtered[MASU_MESO_WAYS]; /* the mean texel's radiance against the texels' mean
                                      * radiance */
    double filtered_mean[MASU_MESO_WAYS]; /* the same for the signed mean over all lights */
    /* The same for CURVES and each of masu_meso_mip_size. */
    double mip_mean[MASU_MESO_MIPS];
    double filtered_diffuse; /* the same for CURVES without the specular terms */
} masu_meso_verdict;

typedef struct masu_meso_bin {
    double count, lit; /* texels and lights; fraction lit in the reference */
} masu_meso_bin;

typedef struct masu_meso_study {
    masu_meso_material made;
    masu_meso_verdict verdict[MASU_MESO_JUDGED];
    masu_meso_bin bins[MASU_MESO_BINS];
} masu_meso_study;

/* Returns false after an error message. Free in both cases. */
bool masu_meso_study_run(const masu_meso_patch *patch, const masu_meso_options *options,
                         masu_meso_study *study);
void masu_meso_study_free(masu_meso_study *study);

/* The smallest ratio of the errors of PLAIN and CURVES over the compared angles, for distant
 * surfaces. */
double masu_meso_study_gain(const masu_meso_study *study, double *angle);

/* The value of f, before clamping, of a bin. */
double masu_meso_bin_value(uint32_t bin);

#endif

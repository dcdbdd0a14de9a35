/* study.h: how close the material that masu-meso makes of a patch comes to ray tracing: it is
 * compared with new rays, under other lights than those of the fit. */
#ifndef LAB_MESO_STUDY_H
#define LAB_MESO_STUDY_H

#include "meso/author.h"

/* The view angles of the comparison. */
#define MASU_MESO_JUDGED 5u
extern const double masu_meso_judged[MASU_MESO_JUDGED];
/* Texels of an edge at which single texels are compared. */
#define MASU_MESO_LEVELS 3u
extern const uint32_t masu_meso_level_size[MASU_MESO_LEVELS];
/* Bins of the shadow's distribution, by offset - alpha (1 - AO) of the texel. */
#define MASU_MESO_BINS 24u

/* Mips whose mean is held against that of the map: texels of an edge. */
#define MASU_MESO_MIPS 3u
extern const uint32_t masu_meso_mip_size[MASU_MESO_MIPS];

/* Root mean square errors of radiance over lights, relative to its mean over them. */
typedef struct masu_meso_verdict {
    double far[MASU_MESO_WAYS];
    double texel[MASU_MESO_LEVELS][MASU_MESO_WAYS];
    double filtered[MASU_MESO_WAYS]; /* the mean texel's radiance against the mean of the texels' */
    double filtered_mean[MASU_MESO_WAYS]; /* the same of the mean over all lights, signed */
    /* The same of CURVES for each of masu_meso_mip_size. */
    double mip_mean[MASU_MESO_MIPS];
    double filtered_diffuse; /* the same of CURVES without the specular terms */
} masu_meso_verdict;

typedef struct masu_meso_bin {
    double count, lit; /* texels and lights; share lit in the reference */
} masu_meso_bin;

typedef struct masu_meso_study {
    masu_meso_material made;
    masu_meso_verdict verdict[MASU_MESO_JUDGED];
    masu_meso_bin bins[MASU_MESO_BINS];
} masu_meso_study;

/* False after an error message. Free in both cases. */
bool masu_meso_study_run(const masu_meso_patch *patch, const masu_meso_options *options,
                         masu_meso_study *study);
void masu_meso_study_free(masu_meso_study *study);

/* The least quotient of plain and curves over the judged angles, of distant surfaces. */
double masu_meso_study_gain(const masu_meso_study *study, double *angle);

/* Value of f, before its clamps, that a bin stands for. */
double masu_meso_bin_value(uint32_t bin);

#endif

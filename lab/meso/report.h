/* report.h: writes the files and the table of `masu-lab meso`. File names start with NAME:
 *
 *   NAME.csv         measured and fitted curves, shadow distribution, errors
 *   NAME_*.svg       the same as plots, by gnuplot (package gnuplot-nox); without it a warning
 *
 * Functions return false after an error message. */
#ifndef LAB_MESO_REPORT_H
#define LAB_MESO_REPORT_H

#include "lab/meso/study.h"

bool masu_meso_write_csv(const char *name, const masu_meso_study *study);
bool masu_meso_write_plots(const char *name, const masu_meso_study *study);
/* Prints the table of errors to stdout. */
void masu_meso_print(const char *name, const masu_meso_study *study);

/* Values of a view in the plots, measured and from the curves. */
typedef struct masu_meso_pair {
    double x;                        /* cosine of the view angle */
    double tilt[2], rough[2], ao[2]; /* degrees towards the viewer; perceptual; fraction */
} masu_meso_pair;
masu_meso_pair masu_meso_compare(const masu_meso_study *study, uint32_t view);

#endif

/* report.h: the files and the table that `masu-lab meso` writes, whose names all begin with NAME:
 *
 *   NAME.csv         measured and fitted curves, shadow distribution, errors
 *   NAME_*.svg       the same as plots, by gnuplot (package gnuplot-nox); without it a warning
 *
 * False after an error message. */
#ifndef LAB_MESO_REPORT_H
#define LAB_MESO_REPORT_H

#include "lab/meso/study.h"

bool masu_meso_write_csv(const char *name, const masu_meso_study *study);
bool masu_meso_write_plots(const char *name, const masu_meso_study *study);
/* The table of errors on stdout. */
void masu_meso_print(const char *name, const masu_meso_study *study);

/* What the plots show of a view, measured and as the curves have it. */
typedef struct masu_meso_pair {
    double x;                        /* cosine of the view angle */
    double tilt[2], rough[2], ao[2]; /* degrees towards the viewer; perceptual; share */
} masu_meso_pair;
masu_meso_pair masu_meso_compare(const masu_meso_study *study, uint32_t view);

#endif

/* golden.h: compares images. A case may have a golden file ("against": "reference", "golden":
 * FILE): linear light, compared by the means of patches, or an 8-bit image. */
#ifndef MASU_CONFORM_GOLDEN_H
#define MASU_CONFORM_GOLDEN_H

#include "conform/suite.h"
#include "session.h"

/* Path of a case's golden file, relative to the suite's folder; NULL if it has none. */
const char *masu_golden_path(const masu_suite *suite, const masu_case *of, char path[4096]);

/* Call it after the frames of a case; `frame` is the last one. Renders of->positions frames of the
 * same moment and compares their mean with the golden file. Fills the measures mean_off, patch_p95
 * and patch_z2. */
bool masu_golden_judge(const char *path, const masu_case *of, masu_session *s,
                       const masu_frame_desc *frame, double values[MASU_MEASURE_COUNT], char *error,
                       size_t error_size);

/* Number of pixels that differ between two images of the case's size; *steps is the largest
 * difference. */
uint32_t masu_golden_differing(const uint8_t *a, const uint8_t *b, const masu_case *of,
                               uint32_t *steps);

/* Fills the measures of 8-bit images. */
void masu_golden_compare(const uint8_t *truth, const uint8_t *picture, const masu_case *of,
                         double values[MASU_MEASURE_COUNT]);

#endif

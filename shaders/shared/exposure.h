/* exposure.h: the buffer of the auto-exposure. */
#ifndef MASU_SHARED_EXPOSURE_H
#define MASU_SHARED_EXPOSURE_H

/* EXPOSURE_HEADER values (0: factor before the tone curve; 1: log2 of the metered factor), then a
 * luminance histogram: pixels per bin. A bin is an eighth of an octave from 2^EXPOSURE_LOG2 on,
 * computed from the bits of the float. Darker pixels are in no bin. */
#define MASU_EXPOSURE_HEADER 4
#define MASU_EXPOSURE_BINS 256
#define MASU_EXPOSURE_LOG2 (-16)
#define MASU_EXPOSURE_KEY 0.18 /* target of the mean luminance: a grey card */

#endif

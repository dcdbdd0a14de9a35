/* ao.h: bounds of screen-space ambient occlusion. */
#ifndef MASU_SHARED_AO_H
#define MASU_SHARED_AO_H

#define MASU_AO_SLICES_MAX 8
#define MASU_AO_STEPS_MAX 16 /* samples on one side of a slice */
/* Largest distance of a sample, as a fraction of the image height. */
#define MASU_AO_REACH 0.25

#endif

/* rest.h: renders a stationary view in linear light: the mean of several frames of one moment, as
 * patches. */
#ifndef MASU_MEASURE_REST_H
#define MASU_MEASURE_REST_H

#include "measure/patches.h"
#include "session.h"

/* Renders `count` frames of one moment, each with the projection shifted by a fraction of a pixel,
 * and averages their linear light. `frame` may have no camera (NULL), which selects the scene's.
 * The session reads back MASU_READBACK_HDR. On false `error` holds one line. */
bool masu_rest_patches(masu_session *s, masu_frame_desc frame, uint32_t count,
                       masu_patch out[MASU_PATCHES], char *error, size_t error_size);

/* Reads the patches of a file of linear light: a stored reference (.ref), with its standard errors,
 * or PFM or OpenEXR, without. */
bool masu_rest_load(const char *path, masu_patch out[MASU_PATCHES], char *error, size_t error_size);

#endif

/* specular.h: renders reflections, stationary and in motion, and measures their error.
 *
 * The error covers the pixels that trace rays: relMSE = mean over these pixels and r, g, b of (x -
 * t)^2 / (t^2 + 0.01), x the rendered and t the reference value, linear radiance before exposure.
 * Motion ends at the stationary view, so that one reference image serves all runs. Nothing here
 * owns a session or an image. */
#ifndef MASU_MEASURE_SPECULAR_H
#define MASU_MEASURE_SPECULAR_H

#include "session.h"

/* Classes of pixels by roughness; the last class contains all of them. */
enum { MASU_SPECULAR_MIRROR, MASU_SPECULAR_FILTERED, MASU_SPECULAR_SATIN, MASU_SPECULAR_ROUGH,
       MASU_SPECULAR_ALL, MASU_SPECULAR_CLASSES };

typedef enum masu_specular_motion {
    MASU_SPECULAR_REST,
    MASU_SPECULAR_CAMERA, /* along the camera path */
    MASU_SPECULAR_OBJECT, /* an object moves along x */
    MASU_SPECULAR_JUMP    /* an object is one metre aside, then `after` frames at its position */
} masu_specular_motion;

typedef struct masu_specular_run {
    uint32_t rung, frames, after;
    masu_specular_motion motion;
    double time; /* of the camera at the end */
    float step;  /* seconds between frames */
    masu_instance object;
    float rows[12];  /* the object's transform at the end */
    double distance; /* of a jump, m; of an object, m/s */
} masu_specular_run;

typedef struct masu_specular_error {
    double value[MASU_SPECULAR_CLASSES];
    uint32_t pixels[MASU_SPECULAR_CLASSES];
} masu_specular_error;

/* Renders a run, whose first frame is a cut. rgb: the last frame, 3 floats per pixel, or NULL.
 * flicker: mean absolute difference between successive output images, from frame 16 on, over pixels
 * with a class other than 0xFF, in 1/255; or NULL. The session reads back MASU_READBACK_HDR. */
bool masu_specular_draw(masu_session *s, const masu_specular_run *run, float *rgb,
                        const uint8_t *classes, double *flicker, char *error, size_t error_size);

/* The slot of the newest frame. */
uint32_t masu_specular_slot(const masu_session *s);

/* Reads the radiance of that frame, 3 floats per pixel. The render size is the output size. */
bool masu_specular_read(masu_session *s, float *rgb);

/* Classifies the pixels of the newest frame; 0xFF: no rays. The session reads back depth, normal
 * and albedo. A coated surface is classified by the roughness below its coat. */
bool masu_specular_classes(masu_session *s, float cutoff, uint8_t *classes);

masu_specular_error masu_specular_compare(const float *rgb, const float *truth,
                                          const uint8_t *classes, uint32_t pixels);

/* Transform of the named instance. Returns false if there is none. The blob must be readable. */
bool masu_specular_place(const masu_scene *scene, const char *name, float rows[12]);

#endif

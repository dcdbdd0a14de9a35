/* specular.h: frames of reflections, at rest and in motion, and how far they are from the truth.
 *
 * The error is that of pixels that trace: relMSE = mean over them and r, g, b of (x - t)^2 / (t^2 + 0.01),
 * x and t linear radiance before exposure. Motion ends where the frames at rest are, so that one truth serves
 * all. Nothing here owns a session or a picture. */
#ifndef MASU_MEASURE_SPECULAR_H
#define MASU_MEASURE_SPECULAR_H

#include "session.h"

/* Pixels by the roughness of what is traced; the last class is all of them. */
enum { MASU_SPECULAR_MIRROR, MASU_SPECULAR_FILTERED, MASU_SPECULAR_SATIN, MASU_SPECULAR_ROUGH,
       MASU_SPECULAR_ALL, MASU_SPECULAR_CLASSES };

typedef enum masu_specular_motion {
    MASU_SPECULAR_REST,
    MASU_SPECULAR_CAMERA, /* along the scene's path */
    MASU_SPECULAR_OBJECT, /* moves along x */
    MASU_SPECULAR_JUMP    /* rests a metre beside, then is at its place for `after` frames */
} masu_specular_motion;

typedef struct masu_specular_run {
    uint32_t rung, frames, after;
    masu_specular_motion motion;
    double time; /* of the camera at the end */
    float step;  /* seconds from frame to frame */
    masu_instance object;
    float rows[12];  /* its place at the end */
    double distance; /* of a jump, m; of an object, m/s */
} masu_specular_run;

typedef struct masu_specular_error {
    double value[MASU_SPECULAR_CLASSES];
    uint32_t pixels[MASU_SPECULAR_CLASSES];
} masu_specular_error;

/* Draws a run, the first frame of which is a cut. rgb: 3 floats a pixel of the last frame, or NULL.
 * flicker: mean absolute difference of the shown picture from one frame to the next, from frame 16 on, over
 * pixels of classes other than 0xFF, in 1/255; or NULL. The session reads back MASU_READBACK_HDR. */
bool masu_specular_draw(masu_session *s, const masu_specular_run *run, float *rgb,
                        const uint8_t *classes, double *flicker, char *error, size_t error_size);

/* Of the frame drawn last. */
uint32_t masu_specular_slot(const masu_session *s);

/* Its radiance, 3 floats a pixel. The render size is the output's. */
bool masu_specular_read(masu_session *s, float *rgb);

/* Class of each pixel, 0xFF: it traces nothing. Of what a session has drawn last, which reads back depth,
 * normal and albedo. What a coat covers counts by the roughness below it. */
bool masu_specular_classes(masu_session *s, float cutoff, uint8_t *classes);

masu_specular_error masu_specular_compare(const float *rgb, const float *truth,
                                          const uint8_t *classes, uint32_t pixels);

/* Where the scene puts the instance of that name. False: there is none. The blob must be readable. */
bool masu_specular_place(const masu_scene *scene, const char *name, float rows[12]);

#endif

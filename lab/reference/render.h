/* render.h: renders an image of the reference: camera, threads, means and their standard errors. */
#ifndef LAB_REFERENCE_RENDER_H
#define LAB_REFERENCE_RENDER_H

#include "lab/reference/tracer.h"

#include <stddef.h>

typedef struct ref_camera {
    ref_vec eye, right, up, forward; /* unit */
    double tangent;                  /* of half of the vertical field of view */
} ref_camera;

/* The camera of the scene's path at a time. */
ref_camera ref_camera_at(const ref_blob *blob, double time);
/* Unit direction through a point of the image; x to the right, y down, both 0..1. */
ref_vec ref_camera_ray(const ref_camera *c, double x, double y, double aspect);

typedef struct ref_image {
    uint32_t width, height;
    float *mean, *error; /* 3 per pixel: mean of all paths; standard error of the mean */
} ref_image;

typedef struct ref_render {
    const ref_tracer *tracer;
    ref_camera camera;
    uint32_t paths, threads;
    uint64_t seed;
    void (*progress)(double share); /* may be NULL; called by one thread */
} ref_render;

/* A box filter over each pixel. Bit-identical for any number of threads: one thread sums the paths
 * of a pixel in order. Returns false if out of memory. */
bool ref_render_image(const ref_render *r, ref_image *image);
void ref_image_free(ref_image *image);

#endif

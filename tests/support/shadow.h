/* shadow.h: what the tests of the shadow map share: scenes baked from a text, a frame of
 * them, and each pixel of it beside the truth (tests/reference/triangles.h). */
#ifndef MASU_SUPPORT_SHADOW_H
#define MASU_SUPPORT_SHADOW_H

#include "support/support.h"

#include "reference/triangles.h"
#include "frame/shadow.h"

typedef struct shadow_test {
    masu_session s;
    uint32_t width, height;
    masu_ref_triangles world;
    masu_scene scene; /* its blob is gone: the numbers alone */
    double sun[3];
    masu_light light;
    int own_light; /* else the scene's */
} shadow_test;

/* A session with all readbacks, one rung, and the truth's triangles. rung: NULL for defaults. */
void shadow_open(shadow_test *t, const char *name, uint32_t width, uint32_t height,
                 const masu_rung *rung);
void shadow_close(shadow_test *t);

/* One frame; camera NULL: that of the scene. */
void shadow_draw(shadow_test *t, const masu_camera *camera, uint32_t cut);
/* From here on the sun stands there, for the GPU and for the truth. Degrees. */
void shadow_sun(shadow_test *t, double azimuth, double elevation);
const void *shadow_image(shadow_test *t, masu_readback_bits which);

/* The surface under a pixel. */
typedef struct shadow_point {
    double at[3], normal[3]; /* the triangle's own, on the side of the sun */
    double n_l;              /* of that normal; below 0 cannot be */
    double z;                /* view depth */
    uint32_t triangle;
    int faces; /* the side that the camera sees is the one that the sun sees */
} shadow_point;

/* 0: nothing there, or the GPU drew something else. */
int shadow_point_at(const shadow_test *t, const masu_camera *camera, const float *depths,
                    uint32_t x, uint32_t y, shadow_point *out);

/* Width of a texel of the cascade that a point is looked up in, for a frame that draws them all; 0:
 * it is beyond all of them. */
double shadow_texel(const shadow_test *t, const masu_camera *camera, const shadow_point *p,
                    double near_distance, uint32_t *cascade);

/* Whether the sun's middle is seen, and the least distance across the sun's direction, in steps of
 * a quarter texel up to `most` texels, at which that changes on the point's plane; `most` + 1 if it
 * does not. */
int shadow_truth(const shadow_test *t, const shadow_point *p);
double shadow_edge(const shadow_test *t, const shadow_point *p, double texel, double most);

#endif

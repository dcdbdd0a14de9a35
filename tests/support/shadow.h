/* shadow.h: shared code of the shadow map tests: scenes baked from a text, a frame, and a
 * comparison of each pixel with a reference (tests/reference/triangles.h). */
#ifndef MASU_SUPPORT_SHADOW_H
#define MASU_SUPPORT_SHADOW_H

#include "support/support.h"

#include "reference/triangles.h"
#include "frame/shadow.h"

typedef struct shadow_test {
    masu_session s;
    uint32_t width, height;
    masu_ref_triangles world;
    masu_scene scene; /* its blob has been freed: only the counts are valid */
    double sun[3];
    masu_light light;
    int own_light; /* else the scene's */
} shadow_test;

/* Opens a session with all readbacks and one rung, and builds the reference triangles. rung: NULL
 * for the defaults. */
void shadow_open(shadow_test *t, const char *name, uint32_t width, uint32_t height,
                 const masu_rung *rung);
void shadow_close(shadow_test *t);

/* Renders one frame. camera NULL: the camera of the scene. */
void shadow_draw(shadow_test *t, const masu_camera *camera, uint32_t cut);
/* Sets the direction of the sun from here on, for the GPU and the reference. Degrees. */
void shadow_sun(shadow_test *t, double azimuth, double elevation);
const void *shadow_image(shadow_test *t, masu_readback_bits which);

/* The surface under a pixel. */
typedef struct shadow_point {
    double at[3], normal[3]; /* the geometric normal, on the side of the sun */
    double n_l;              /* for that normal; below 0 is impossible */
    double z;                /* view depth */
    uint32_t triangle;
    int faces; /* the camera sees the side that the sun lights */
} shadow_point;

/* 0: no surface there, or the GPU rendered another one. */
int shadow_point_at(const shadow_test *t, const masu_camera *camera, const float *depths,
                    uint32_t x, uint32_t y, shadow_point *out);

/* Width of a texel of the cascade that the point uses, in a frame that renders all cascades; 0:
 * beyond all cascades. */
double shadow_texel(const shadow_test *t, const masu_camera *camera, const shadow_point *p,
                    double near_distance, uint32_t *cascade);

/* Whether the sun's centre is visible, and the smallest distance across the sun's direction at
 * which that changes on the point's plane, in steps of a quarter texel up to `most` texels; `most`
 * + 1 if it does not change. */
int shadow_truth(const shadow_test *t, const shadow_point *p);
double shadow_edge(const shadow_test *t, const shadow_point *p, double texel, double most);

#endif

/* field.h: a scene's signed distance field in double precision: the C that masu-sdfc generates from
 * its .sdf source, or its GLSL as C++. It is compiled when opened, and sphere-traced. */
#ifndef LAB_REFERENCE_FIELD_H
#define LAB_REFERENCE_FIELD_H

#include "lab/reference/bsdf.h"
#include "lab/reference/compile.h"
#include "lab/reference/scene.h"
#include "sdfc/sdfc.h"

/* A part of the C and its bounds. */
typedef struct ref_field_box {
    ref_vec low, high;
    int part;
    double lipschitz;
} ref_field_box;

/* A light source: the box of an emissive part, or of a window. */
typedef struct ref_light_box {
    ref_vec low, high;
    double cumulative; /* probability up to and including this one */
} ref_light_box;

typedef struct ref_field {
    /* C: a .sdf source except its parts with GLSL. Handle NULL: the source is GLSL */
    ref_library c;
    double (*step)(const double *params, double time, const double p[3]);
    double (*distance)(const double *params, double time, const double p[3]);
    int (*part)(const double *params, double time, const double p[3]);
    double (*part_distance)(const double *params, double time, const double p[3], int part);
    void (*material)(int part, double out[8]);
    void (*look)(const double *params, double time, int part, const double p[3], const double n[3],
                 double width, double out[8]);
    /* A GLSL source, or the GLSL parts of a .sdf source */
    ref_library glsl;
    ref_glsl_run *run; /* NULL: no GLSL */
    ref_glsl_inputs *inputs;
    int *parts; /* indices of parts, and their Lipschitz constants; NULL: one source */
    double *steepness;
    uint32_t part_count;
    double lipschitz; /* of a GLSL source */
    double params[256], time;
    ref_vec low, high; /* nothing outside is visible */
    double longest;
    ref_field_box *boxes; /* of a .sdf source */
    uint32_t box_count;
    ref_light_box *emitters; /* bounded parts of a .sdf source; NULL: none */
    uint32_t emitter_count;
} ref_field;

/* source: a .sdf file, or GLSL. The parameters have their default values. */
bool ref_field_open(const char *source, const ref_blob *blob, double time, ref_field *out,
                    char *error, size_t error_size);
void ref_field_close(ref_field *f);

/* The smallest f of all parts. */
double ref_field_distance(const ref_field *f, ref_vec p);
/* Distance of the first surface within `far`; HUGE_VAL: none. `from` is outside of the surface. */
double ref_field_trace(const ref_field *f, ref_vec from, ref_vec direction, double far);
ref_vec ref_field_normal(const ref_field *f, ref_vec p);
/* p, on the surface, moved along n so that a ray can start there. */
ref_vec ref_field_leave(const ref_field *f, ref_vec p, ref_vec n);
/* n: from ref_field_normal. */
void ref_field_surface(const ref_field *f, ref_vec p, ref_vec n, ref_surface *out);

/* field_light.c. Finds bounded emissive parts of a .sdf source. */
bool ref_field_find_emitters(ref_field *f, const masu_sdfc_result *made);
/* A direction towards a point distributed uniformly in one of the boxes; and the density of such
 * directions over the solid angle. */
ref_vec ref_towards_box(const ref_light_box *boxes, uint32_t count, ref_vec from, ref_random *r);
double ref_box_pdf(const ref_light_box *boxes, uint32_t count, ref_vec from, ref_vec direction);

#endif

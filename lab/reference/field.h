/* field.h: a scene's signed distance field in double precision: the C that masu-sdfc generates
 * from its .sdf source, compiled by the system's compiler when it is opened, and sphere-traced. */
#ifndef LAB_REFERENCE_FIELD_H
#define LAB_REFERENCE_FIELD_H

#include "lab/reference/bsdf.h"
#include "scene/blob.h"

#include <stddef.h>

typedef struct ref_field {
    void *library; /* of dlopen; NULL: no field */
    double (*step)(const double *params, double time, const double p[3]);
    double (*distance)(const double *params, double time, const double p[3]);
    int (*part)(const double *params, double time, const double p[3]);
    void (*material)(int part, double out[8]);
    double params[256], time;
    ref_vec low, high; /* nothing outside of it is seen */
    double longest;
    char folder[64]; /* temporary, removed by ref_field_close */
} ref_field;

/* source: a .sdf file. sdf, params: of the blob; the parameters have their default values. */
bool ref_field_open(const char *source, const masu_blob_sdf *sdf, const masu_blob_sdf_param *params,
                    uint32_t param_count, double time, ref_field *out, char *error,
                    size_t error_size);
void ref_field_close(ref_field *f);

/* Distance of the first surface within `far`; HUGE_VAL: none. `from` is outside of the surface. */
double ref_field_trace(const ref_field *f, ref_vec from, ref_vec direction, double far);
ref_vec ref_field_normal(const ref_field *f, ref_vec p);
/* p, on the surface, lifted along n until a ray can start there. */
ref_vec ref_field_leave(const ref_field *f, ref_vec p, ref_vec n);
void ref_field_surface(const ref_field *f, ref_vec p, ref_surface *out);

#endif

/* render_post.c: the effects of `masu render` on the image: --bloom, --aperture and others, and the
 * colour table of --lut, a .cube file (Adobe, "Cube LUT Specification" 1.0). */
#include "masu/render.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lines of comments, titles and empty ones are skipped; the domain must be 0 to 1. */
static const char *read_cube(FILE *file, masu_render_options *o) {
    char line[512];
    uint64_t points = 0, count = 0;
    while (fgets(line, sizeof line, file)) {
        float c[3];
        unsigned size;
        if (sscanf(line, "LUT_3D_SIZE %u", &size) == 1) {
            if (size < 2 || size > MASU_LUT_MAX) return "expected a LUT_3D_SIZE of 2 to 33";
            o->lut_size = size;
            points = (uint64_t)size * size * size;
            free(o->lut);
            o->lut = malloc(points * sizeof c);
            if (!o->lut) return "out of memory";
        } else if (!strncmp(line, "LUT_1D_SIZE", 11)) {
            return "found LUT_1D_SIZE, expected LUT_3D_SIZE";
        } else if (sscanf(line, "DOMAIN_MIN %f %f %f", &c[0], &c[1], &c[2]) == 3 ||
                   sscanf(line, "DOMAIN_MAX %f %f %f", &c[0], &c[1], &c[2]) == 3) {
            float side = strncmp(line, "DOMAIN_MIN", 10) ? 1.0f : 0.0f;
            if (c[0] != side || c[1] != side || c[2] != side) return "expected a domain of 0 to 1";
        } else if (sscanf(line, "%f %f %f", &c[0], &c[1], &c[2]) == 3) {
            if (count >= points) return "found more colours than LUT_3D_SIZE has";
            memcpy(o->lut + 3 * count++, c, sizeof c);
        }
    }
    return points && count == points ? NULL : "found fewer colours than LUT_3D_SIZE has, or none";
}

bool masu_render_read_post(masu_render_options *o, char *error, size_t size) {
    masu_desc *d = &o->d.desc;
    if (o->lut_path) {
        FILE *file = fopen(o->lut_path, "r");
        const char *problem = file ? read_cube(file, o) : "cannot be read";
        if (file) fclose(file);
        if (problem) {
            snprintf(error, size, "--lut: %.500s: %s", o->lut_path, problem);
            return false;
        }
    }
    o->post = (masu_post){(float)o->bloom,    (float)o->aperture,   (float)o->focus,
                          (float)o->vignette, (float)o->brightness, (float)o->gamma};
    bool graded = o->lut_size || o->vignette > 0.0 || o->brightness < 0.0 || o->brightness > 0.0 ||
                  o->gamma > 0.0;
    d->post = (o->bloom > 0.0 ? MASU_POST_BLOOM : 0u) | (o->aperture > 0.0 ? MASU_POST_FOCUS : 0u) |
              (graded ? MASU_POST_GRADE : 0u);
    d->lut_size = o->lut_size;
    return true;
}

bool masu_render_set_lut(masu_session *s, const masu_render_options *o, char *error, size_t size) {
    if (!o->lut_size || !masu_lut_set(s->m, o->lut, o->lut_size, &s->detail)) return true;
    snprintf(error, size, "--lut: %s", s->detail.text);
    return false;
}

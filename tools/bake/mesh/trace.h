/* trace.h: the scene being baked as something that rays can be shot at: all triangles that the
 * instances show, in world space, with the colour that they send back. Embree does the rays.
 *
 * What it knows of a surface is what diffuse light needs: which way it faces, its base colour and
 * what it emits, both with their maps, read from a mip of at most 64 texels a side; a masked texel
 * is not there. Base colour stands for the share of light that comes back, of metals too. LODs are
 * left out. With an SDF (light/field.h), that too.
 *
 * Rays give the same answer in every run and on every thread: the tree is built by one thread,
 * and two surfaces at one place are told apart by their order in it. */
#ifndef MASU_BAKE_TRACE_H
#define MASU_BAKE_TRACE_H

#include "bake/scene/content.h"

typedef struct masu_bake_trace masu_bake_trace;

/* Most triangles over all instances: about 200 bytes each. */
#define MASU_BAKE_TRACE_TRIANGLES ((uint64_t)8 << 20)

typedef struct masu_bake_hit {
    float t;           /* along the direction, which need not be of unit length */
    float position[3]; /* lifted off the surface, towards where the ray came from */
    float normal[3];   /* of the triangle, unit length, against the ray */
    float albedo[3];   /* 0..1 */
    float emissive[3]; /* radiance */
    bool back;         /* hit from behind: against the vertices' normals */
} masu_bake_hit;

/* NULL after reporting: too many triangles, or Embree cannot. A scene without any is traced too:
 * every ray leaves it. */
masu_bake_trace *masu_bake_trace_make(const masu_bake_content *content);
void masu_bake_trace_release(masu_bake_trace *trace);
/* From here on rays meet this too; NULL: nothing. It is not released. */
struct masu_bake_field;
void masu_bake_trace_add(masu_bake_trace *trace, const struct masu_bake_field *field);

/* The nearest surface up to `far`. Threads may ask at the same time. */
bool masu_bake_trace_ray(const masu_bake_trace *trace, const float origin[3],
                         const float direction[3], float far, masu_bake_hit *hit);
/* Whether nothing is in between. */
bool masu_bake_trace_free(const masu_bake_trace *trace, const float origin[3],
                          const float direction[3], float far);

uint64_t masu_bake_trace_triangles(const masu_bake_trace *trace);

#endif

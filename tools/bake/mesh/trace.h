/* trace.h: ray queries against the scene being baked: all triangles of its instances, in world
 * space, with their reflected colour. Traversal is by Embree.
 *
 * A surface has only the data that diffuse light needs: facing, base colour and emission. Both
 * colours include their maps, read from a mip of at most 64 texels a side; masked texels are
 * skipped. Base colour is used as the reflected fraction of light, also for metals. LODs are
 * excluded. An SDF is included if there is one (light/field.h).
 *
 * Rays give the same result in every run and on every thread: one thread builds the tree, and its
 * order decides between two surfaces at the same position. */
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
/* From this call on, rays also hit this SDF; NULL: none. The caller keeps ownership. */
struct masu_bake_field;
void masu_bake_trace_add(masu_bake_trace *trace, const struct masu_bake_field *field);

/* The closest surface up to `far`. Thread-safe. */
bool masu_bake_trace_ray(const masu_bake_trace *trace, const float origin[3],
                         const float direction[3], float far, masu_bake_hit *hit);
/* Whether nothing is in between. */
bool masu_bake_trace_free(const masu_bake_trace *trace, const float origin[3],
                          const float direction[3], float far);

uint64_t masu_bake_trace_triangles(const masu_bake_trace *trace);

#endif

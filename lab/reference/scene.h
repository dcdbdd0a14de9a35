/* scene.h: a baked scene for the reference path tracer: world-space triangles at one moment,
 * materials with decoded textures, lights. Written from docs/blob.md; uses only the blob's layout
 * and its validation from the library. */
#ifndef LAB_REFERENCE_SCENE_H
#define LAB_REFERENCE_SCENE_H

#include "lab/reference/vec.h"
#include "scene/blob.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct ref_blob {
    uint8_t *bytes;
    size_t size;
    const void *section[MASU_BLOB_KIND_COUNT]; /* NULL: absent */
    uint64_t count[MASU_BLOB_KIND_COUNT];
} ref_blob;

/* One layer of a texture at full size, decoded from the blob's blocks. */
typedef struct ref_texture {
    uint32_t width, height;
    uint8_t *rgba;
    bool srgb;
} ref_texture;

typedef struct ref_material {
    uint32_t flags;
    ref_vec base, emissive;
    double roughness, metallic, specular, coat, coat_roughness, opacity, cutoff;
    ref_vec specular_color, sheen_color;
    double sheen_roughness, anisotropy, anisotropy_rotation;
    double detail[2];
    uint32_t wrap[2];
    uint32_t second;                         /* bit per slot: its map uses the second texture
                                              * coordinates */
    const ref_texture *map[MASU_SLOT_COUNT]; /* NULL: none */
} ref_material;

typedef struct ref_triangle {
    uint32_t vertex[3]; /* of the scene's */
    uint32_t material;
} ref_triangle;

typedef struct ref_light {
    ref_vec position, color, direction;
    double range, radius, inner, outer; /* outer < 0: not a spot */
    uint32_t type;                      /* masu_blob_light_type */
    ref_vec half_axis;                  /* of a rectangle; the first half axis is `direction` */
    bool two_sided, surface;            /* surface: triangles of the scene emit its light */
} ref_light;

typedef struct ref_emitter {
    uint32_t triangle;
    double area, cumulative; /* probability up to and including this one */
} ref_emitter;

typedef struct ref_scene {
    ref_blob blob;
    ref_vec *positions, *normals; /* world space */
    float *texcoords;             /* two per vertex, or NULL */
    float *texcoords_1, *colors;  /* two and four (linear) per vertex, or NULL */
    uint64_t vertex_count;
    ref_triangle *triangles;
    uint64_t triangle_count;
    ref_material *materials;
    ref_texture *textures;
    uint64_t texture_count;
    ref_light *lights;
    uint32_t light_count;
    ref_emitter *emitters;
    double *emitter_pdf; /* per triangle: density over its area; 0: not emissive */
    uint32_t emitter_count;
    const masu_blob_environment *environment;
    const masu_blob_shadow *shadow;           /* NULL: no shadows of polygons */
    const masu_blob_reflections *reflections; /* NULL: no traced reflections */
    const masu_blob_sdf *sdf;                 /* NULL: none */
    bool probes, masks, blends, meso;
} ref_scene;

/* `animate`: every model plays its first clip, looped, at `time`; otherwise the blob's pose. */
bool ref_scene_open(const char *path, double time, bool animate, ref_scene *out, char *error,
                    size_t error_size);
void ref_scene_close(ref_scene *scene);

/* rgba of a map, bilinear at full size; sRGB becomes linear before filtering. */
void ref_texture_at(const ref_texture *t, double u, double v, const uint32_t wrap[2],
                    double out[4]);

/* The rows of the 3x4 matrix of each instance at a moment, 12 doubles each; in pose.c. */
void ref_pose_instances(const ref_blob *blob, double time, bool animate, double *matrices);
/* Positions and normals of a skin, in the space of its model's transform. */
bool ref_pose_skin(const ref_blob *blob, uint32_t skin, double time, bool animate,
                   ref_vec *positions, ref_vec *normals);
void ref_octahedral(const int16_t packed[2], double out[3]);
ref_vec ref_transform(const double m[12], ref_vec p);
ref_vec ref_transform_direction(const double m[12], ref_vec d);
ref_vec ref_transform_normal(const double m[12], ref_vec n);

#endif

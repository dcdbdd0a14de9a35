/* rays.h: the traced triangles of a scene in three forms, for `masu-lab study rays`: the buffers of
 * shaders/trace/bvh.glsl, a compute program that traverses them, and Embree's scene.
 *
 * All in world space minus an anchor. Functions that can fail return false and write one line to
 * `error`. */
#ifndef MASU_BENCH_RAYS_H
#define MASU_BENCH_RAYS_H

#include "headless.h"
#include "scene/scene.h"
#include "scene/trace.h"

#include <embree3/rtcore.h>

typedef struct masu_bench_ray {
    float origin[3], t_min;
    float direction[3], t_max;
} masu_bench_ray;

typedef struct masu_bench_hit {
    float t; /* negative: none */
    uint32_t triangle, traced;
    uint32_t nodes; /* visited, if counted; all bits: given up */
    float barycentrics[2];
    uint32_t triangles; /* tested */
    uint32_t record;
} masu_bench_hit;

typedef struct masu_bench_rays {
    masu_scene_view view;
    masu_scene scene;
    double anchor[3];
    masu_trace_top top;
    void *top_memory;
    RTCDevice device;
    RTCScene embree, *meshes; /* of instances; one per traced mesh */
    bool flat;                /* embree has all triangles in one space instead of instances */
    uint32_t *flat_triangle;  /* per flat triangle: its triangle and its instance */
    float *flat_vertices;
} masu_bench_rays;

/* flat: Embree gets every triangle of every instance, transformed to world space, instead of
 * instances. */
bool masu_bench_rays_open(const masu_scene *scene, const double anchor[3], bool flat,
                          masu_bench_rays *rays, char *error, size_t error_size);
void masu_bench_rays_close(masu_bench_rays *rays);

/* Traces by rtcIntersect1 on `threads` threads. Returns the seconds. */
double masu_bench_rays_embree(const masu_bench_rays *rays, const masu_bench_ray *in, uint32_t count,
                              uint32_t threads, masu_bench_hit *out);

/* One ray per pixel of the camera's image, in tiles of 8x8 pixels, in blocks of 4x2 inside
 * them. */
void masu_bench_rays_primary(const masu_bench_rays *rays, const masu_blob_camera_key *camera,
                             uint32_t width, uint32_t height, masu_bench_ray *out);
/* Reflected rays from the hits of others, mirrored at a normal of the GGX distribution around the
 * triangle's normal. Returns their number. */
uint32_t masu_bench_rays_specular(const masu_bench_rays *rays, const masu_bench_ray *in,
                                  const masu_bench_hit *hits, uint32_t count, double roughness,
                                  masu_bench_ray *out);
/* The normal of the hit triangle in anchored space; not of unit length. */
void masu_bench_rays_normal(const masu_bench_rays *rays, const masu_bench_hit *hit, double out[3]);

/* The compute program and its buffers, with room for `most` rays. */
typedef struct masu_bench_gpu {
    masu_headless *host;
    masu_headless_buffer buffer[5];
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline pipeline[2]; /* 1: with counters */
    VkDescriptorPool pool;
    VkDescriptorSet set;
} masu_bench_gpu;

bool masu_bench_gpu_open(masu_headless *host, const masu_bench_rays *rays, uint32_t most,
                         masu_bench_gpu *gpu, char *error, size_t error_size);
void masu_bench_gpu_close(masu_bench_gpu *gpu);
void masu_bench_gpu_rays(masu_bench_gpu *gpu, const masu_bench_ray *in, uint32_t count);
/* Traces the rays of masu_bench_gpu_rays. seconds: from submit to fence. */
bool masu_bench_gpu_trace(masu_bench_gpu *gpu, uint32_t count, bool counted, double *seconds,
                          char *error, size_t error_size);
const masu_bench_hit *masu_bench_gpu_hits(const masu_bench_gpu *gpu);

#endif

/* trace.c: see trace.h. One Embree geometry holds all triangles, transformed; a triangle
 * keeps its material, a vertex its texture coordinates where the scene has any. */
#define _POSIX_C_SOURCE 200809L
#include "bake/mesh/trace.h"
#include "bake/light/field.h"
#include "bake/scene/live.h"
#include "cli/cli.h"
#include "scene/texture.h"

#include <embree3/rtcore.h>

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TEXELS_A_SIDE 64u
#define MASKS_MAX 32 /* masked texels that one ray passes; then it leaves the scene */

/* A mip of one layer of a texture, linear, and whether it has been requested. */
typedef struct picture {
    uint32_t width, height;
    float *rgba; /* NULL: none */
} picture;

typedef struct look {
    float albedo[3], emissive[3], cutoff; /* cutoff 0: no mask */
    uint32_t base, glow;                  /* indices of images, or MASU_BLOB_NONE */
    uint32_t wrap[2];
} look;

struct masu_bake_trace {
    RTCDevice device;
    RTCScene scene;
    const masu_bake_field *field; /* NULL: none */
    uint64_t triangles, vertices;
    float *positions;    /* 3 per vertex, and one more: Embree reads 16 bytes */
    float *texcoords;    /* 2 per vertex, or NULL */
    uint32_t *indices;   /* 3 per triangle */
    uint32_t *materials; /* of each triangle */
    look *looks;
    picture *pictures;
    uint32_t picture_count;
    bool masks;
};

/* ---- colours ---- */

static float linear_of(unsigned char byte) {
    float c = (float)byte / 255.0f;
    return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

/* Texels of the largest mip within TEXELS_A_SIDE. */
static picture read_picture(const masu_bake_content *content, uint32_t texture, uint32_t layer) {
    const masu_blob_texture *t =
        &MASU_BAKE_ARRAY(content, MASU_BLOB_TEXTURES, const masu_blob_texture)[texture];
    const unsigned char *texels = content->section[MASU_BLOB_TEXELS].data + t->offset;
    uint32_t bytes = masu_blob_block_bytes(t->format), mip = 0;
    texels += masu_blob_texture_bytes(t) / t->layers * layer;
    picture p = {t->width, t->height, NULL};
    while (mip + 1 < t->mips && (p.width > TEXELS_A_SIDE || p.height > TEXELS_A_SIDE)) {
        texels += (uint64_t)((p.width + 3) / 4) * ((p.height + 3) / 4) * bytes;
        mip++;
        p.width = masu_blob_mip_size(t->width, mip);
        p.height = masu_blob_mip_size(t->height, mip);
    }
    p.rgba = masu_bake_allocate((size_t)p.width * p.height * 4 * sizeof(float));
    uint32_t across = (p.width + 3) / 4;
    for (uint32_t y = 0; y < p.height; y++) {
        for (uint32_t x = 0; x < p.width; x++) {
            unsigned char block[64];
            masu_texture_decode(t->format, texels + ((uint64_t)(y / 4) * across + x / 4) * bytes,
                                block);
            const unsigned char *from = block + ((y % 4) * 4 + x % 4) * 4;
            float *to = p.rgba + ((size_t)y * p.width + x) * 4;
            for (int c = 0; c < 3; c++) to[c] = linear_of(from[c]);
            to[3] = (float)from[3] / 255.0f;
        }
    }
    return p;
}

static uint32_t picture_of(masu_bake_trace *trace, const masu_bake_content *content,
                           const masu_blob_material *m, uint32_t slot) {
    if (!(m->flags & 1u << slot)) return MASU_BLOB_NONE;
    const masu_blob_texture_set *set = &MASU_BAKE_ARRAY(
        content, MASU_BLOB_TEXTURE_SETS, const masu_blob_texture_set)[m->texture_set];
    trace->pictures[trace->picture_count] =
        read_picture(content, set->texture[slot], m->layers >> 8 * slot & 0xFFu);
    return trace->picture_count++;
}

static void read_looks(masu_bake_trace *trace, const masu_bake_content *content) {
    uint64_t count = masu_bake_count(content, MASU_BLOB_MATERIALS);
    trace->looks = masu_bake_allocate((size_t)count * sizeof *trace->looks);
    trace->pictures = masu_bake_allocate((size_t)count * 2 * sizeof *trace->pictures);
    for (uint64_t i = 0; i < count; i++) {
        const masu_blob_material *m = &MASU_BAKE_MATERIALS(content)[i];
        look *l = &trace->looks[i];
        memset(l, 0, sizeof *l);
        memcpy(l->albedo, m->base_color, sizeof l->albedo);
        memcpy(l->emissive, m->emissive, sizeof l->emissive);
        l->base = picture_of(trace, content, m, MASU_SLOT_BASE);
        l->glow = picture_of(trace, content, m, MASU_SLOT_EMISSIVE);
        if (m->flags & MASU_MATERIAL_HAS_MAPS) {
            memcpy(l->wrap,
                   MASU_BAKE_ARRAY(content, MASU_BLOB_TEXTURE_SETS,
                                   const masu_blob_texture_set)[m->texture_set]
                       .wrap,
                   sizeof l->wrap);
        }
        if (m->flags & MASU_MATERIAL_IS_MASK && l->base != MASU_BLOB_NONE) {
            l->cutoff = (float)(m->flags >> MASU_MATERIAL_CUTOFF_SHIFT & 0xFFu) / 255.0f;
            trace->masks = true;
        }
    }
}

static uint32_t wrapped(float u, uint32_t size, uint32_t wrap) {
    if (wrap == 1) u = fminf(fmaxf(u, 0.0f), 1.0f);
    if (wrap == 2) u = 1.0f - fabsf(u - 2.0f * floorf(u * 0.5f) - 1.0f);
    u -= floorf(u == 1.0f ? 0.0f : u);
    uint32_t x = (uint32_t)(u * (float)size);
    return x < size ? x : size - 1;
}

static const float *texel(const masu_bake_trace *trace, const look *l, uint32_t which, float u,
                          float v) {
    const picture *p = &trace->pictures[which];
    uint32_t x = wrapped(u, p->width, l->wrap[0]), y = wrapped(v, p->height, l->wrap[1]);
    return p->rgba + ((size_t)y * p->width + x) * 4;
}

/* ---- triangles ---- */

static uint64_t count_triangles(const masu_bake_content *content, const unsigned char *hidden,
                                uint64_t *vertices) {
    uint64_t triangles = 0;
    *vertices = 0;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        if (hidden[i]) continue;
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(content)[MASU_BAKE_INSTANCES(content)[i].mesh];
        for (uint32_t k = 0; k < m->primitive_count; k++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(content)[m->first_primitive + k];
            triangles += p->index_count / 3;
            *vertices += p->vertex_count;
        }
    }
    return triangles;
}

/* The direction that an octahedral normal stands for, of any length. */
static masu_bake_vec3 decoded(const int16_t n[2]) {
    double x = n[0] / 32767.0, y = n[1] / 32767.0, z = 1 - fabs(x) - fabs(y);
    if (z >= 0) return masu_bake_v3(x, y, z);
    return masu_bake_v3((1 - fabs(y)) * (x >= 0 ? 1 : -1), (1 - fabs(x)) * (y >= 0 ? 1 : -1), z);
}

/* Orients triangles so that they face like their vertices' normals: files use both windings, and
 * mirroring reverses them. */
static void turn(const masu_bake_content *content, const masu_blob_primitive *p,
                 const uint32_t *corner, uint32_t out[3]) {
    const masu_blob_vertex *v = MASU_BAKE_VERTICES(content) + p->first_vertex;
    masu_bake_vec3 a = masu_bake_v3f(v[corner[0]].position);
    masu_bake_vec3 face = masu_bake_cross(masu_bake_sub(masu_bake_v3f(v[corner[1]].position), a),
                                          masu_bake_sub(masu_bake_v3f(v[corner[2]].position), a));
    double towards = 0;
    for (int k = 0; k < 3; k++) {
        masu_bake_vec3 n = decoded(v[corner[k]].normal);
        if (masu_bake_normalize(&n)) towards += masu_bake_dot(n, face);
    }
    if (towards >= 0) return;
    uint32_t second = out[1];
    out[1] = out[2];
    out[2] = second;
}

static void add_primitive(masu_bake_trace *trace, const masu_bake_content *content,
                          const masu_blob_primitive *p, const masu_blob_instance *instance) {
    masu_bake_affine a = masu_bake_transform(instance);
    const double *m = a.m;
    bool mirror = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
                      m[2] * (m[4] * m[9] - m[5] * m[8]) <
                  0;
    uint32_t first = (uint32_t)trace->vertices;
    const float *coords = MASU_BAKE_ARRAY(content, MASU_BLOB_TEXCOORDS, const float);
    for (uint32_t i = 0; i < p->vertex_count; i++) {
        uint64_t from = (uint64_t)p->first_vertex + i;
        masu_bake_vec3 at =
            masu_bake_apply(&a, masu_bake_v3f(MASU_BAKE_VERTICES(content)[from].position));
        float *to = trace->positions + trace->vertices * 3;
        to[0] = (float)at.x;
        to[1] = (float)at.y;
        to[2] = (float)at.z;
        if (trace->texcoords) {
            memcpy(trace->texcoords + trace->vertices * 2, coords + from * 2, 2 * sizeof(float));
        }
        trace->vertices++;
    }
    for (uint32_t i = 0; i + 2 < p->index_count; i += 3) {
        const uint32_t *corner = MASU_BAKE_INDICES(content) + p->first_index + i;
        uint32_t *out = trace->indices + trace->triangles * 3;
        for (int k = 0; k < 3; k++) out[k] = first + corner[k];
        turn(content, p, corner, out);
        if (mirror) {
            uint32_t second = out[1];
            out[1] = out[2];
            out[2] = second;
        }
        trace->materials[trace->triangles++] = p->material;
    }
}

static void read_triangles(masu_bake_trace *trace, const masu_bake_content *content,
                           const unsigned char *hidden, uint64_t triangles, uint64_t vertices) {
    trace->positions = masu_bake_allocate((size_t)(vertices + 2) * 3 * sizeof(float));
    memset(trace->positions + vertices * 3, 0, 6 * sizeof(float));
    trace->indices = masu_bake_allocate((size_t)triangles * 3 * sizeof(uint32_t));
    trace->materials = masu_bake_allocate((size_t)triangles * sizeof(uint32_t));
    if (masu_bake_count(content, MASU_BLOB_TEXCOORDS)) {
        trace->texcoords = masu_bake_allocate((size_t)vertices * 2 * sizeof(float));
    }
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        const masu_blob_instance *instance = &MASU_BAKE_INSTANCES(content)[i];
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(content)[instance->mesh];
        if (hidden[i]) continue;
        for (uint32_t k = 0; k < m->primitive_count; k++) {
            add_primitive(trace, content, &MASU_BAKE_PRIMITIVES(content)[m->first_primitive + k],
                          instance);
        }
    }
}

/* threads=1: trees that several threads build may differ from run to run. */
static bool build(masu_bake_trace *trace) {
    trace->device = rtcNewDevice("threads=1");
    if (!trace->device) return false;
    trace->scene = rtcNewScene(trace->device);
    rtcSetSceneFlags(trace->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry g = rtcNewGeometry(trace->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, trace->positions, 0,
                               3 * sizeof(float), (size_t)trace->vertices);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, trace->indices, 0,
                               3 * sizeof(uint32_t), (size_t)trace->triangles);
    rtcCommitGeometry(g);
    rtcAttachGeometry(trace->scene, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(trace->scene);
    return rtcGetDeviceError(trace->device) == RTC_ERROR_NONE;
}

masu_bake_trace *masu_bake_trace_make(const masu_bake_content *content) {
    unsigned char *hidden = masu_bake_hidden(content); /* light does not know them */
    uint64_t vertices, triangles = count_triangles(content, hidden, &vertices);
    if (triangles > MASU_BAKE_TRACE_TRIANGLES || vertices >= UINT32_MAX / 2) {
        masu_cli_error("%llu triangles are drawn, at most %llu can be traced",
                       (unsigned long long)triangles,
                       (unsigned long long)MASU_BAKE_TRACE_TRIANGLES);
        free(hidden);
        return NULL;
    }
    masu_bake_trace *trace = masu_bake_allocate(sizeof *trace);
    memset(trace, 0, sizeof *trace);
    read_looks(trace, content);
    read_triangles(trace, content, hidden, triangles, vertices);
    free(hidden);
    if (trace->triangles && !build(trace)) {
        masu_cli_error("Embree cannot build a scene of %llu triangles",
                       (unsigned long long)triangles);
        masu_bake_trace_release(trace);
        return NULL;
    }
    return trace;
}

void masu_bake_trace_release(masu_bake_trace *trace) {
    if (!trace) return;
    if (trace->scene) rtcReleaseScene(trace->scene);
    if (trace->device) rtcReleaseDevice(trace->device);
    for (uint32_t i = 0; i < trace->picture_count; i++) free(trace->pictures[i].rgba);
    free(trace->pictures);
    free(trace->looks);
    free(trace->positions);
    free(trace->texcoords);
    free(trace->indices);
    free(trace->materials);
    free(trace);
}

void masu_bake_trace_add(masu_bake_trace *trace, const masu_bake_field *field) {
    trace->field = field;
}

uint64_t masu_bake_trace_triangles(const masu_bake_trace *trace) { return trace->triangles; }

/* ---- rays ---- */

/* Offset of points from a surface at p, for a ray that has travelled t: some units in the last
 * place of the coordinates from which p was computed. */
static float lift(const float p[3], float t) {
    float most = fmaxf(fabsf(p[0]), fmaxf(fabsf(p[1]), fabsf(p[2])));
    return 4e-6f * (most + t) + 1e-6f;
}

static void coords_at(const masu_bake_trace *trace, const uint32_t *corner, float u, float v,
                      float out[2]) {
    for (int k = 0; k < 2; k++) {
        float a = trace->texcoords[corner[0] * 2 + (uint32_t)k];
        float b = trace->texcoords[corner[1] * 2 + (uint32_t)k];
        float c = trace->texcoords[corner[2] * 2 + (uint32_t)k];
        out[k] = a + (b - a) * u + (c - a) * v;
    }
}

/* False: the texel is not there. */
static bool fill(const masu_bake_trace *trace, const struct RTCRayHit *r, masu_bake_hit *hit) {
    const uint32_t *corner = trace->indices + (size_t)r->hit.primID * 3;
    const look *l = &trace->looks[trace->materials[r->hit.primID]];
    memcpy(hit->albedo, l->albedo, sizeof hit->albedo);
    memcpy(hit->emissive, l->emissive, sizeof hit->emissive);
    if (trace->texcoords && (l->base != MASU_BLOB_NONE || l->glow != MASU_BLOB_NONE)) {
        float at[2];
        coords_at(trace, corner, r->hit.u, r->hit.v, at);
        if (l->base != MASU_BLOB_NONE) {
            const float *c = texel(trace, l, l->base, at[0], at[1]);
            if (c[3] < l->cutoff) return false;
            for (int k = 0; k < 3; k++) hit->albedo[k] *= c[k];
        }
        if (l->glow != MASU_BLOB_NONE) {
            const float *c = texel(trace, l, l->glow, at[0], at[1]);
            for (int k = 0; k < 3; k++) hit->emissive[k] *= c[k];
        }
    }
    masu_bake_vec3 a = masu_bake_v3f(trace->positions + (size_t)corner[0] * 3);
    masu_bake_vec3 n =
        masu_bake_cross(masu_bake_sub(masu_bake_v3f(trace->positions + (size_t)corner[1] * 3), a),
                        masu_bake_sub(masu_bake_v3f(trace->positions + (size_t)corner[2] * 3), a));
    const float d[3] = {r->ray.dir_x, r->ray.dir_y, r->ray.dir_z};
    if (!masu_bake_normalize(&n)) n = masu_bake_v3(0, 1, 0);
    hit->back = masu_bake_dot(n, masu_bake_v3f(d)) > 0;
    double side = hit->back ? -1 : 1;
    hit->t = r->ray.tfar;
    hit->normal[0] = (float)(n.x * side);
    hit->normal[1] = (float)(n.y * side);
    hit->normal[2] = (float)(n.z * side);
    const float o[3] = {r->ray.org_x, r->ray.org_y, r->ray.org_z};
    for (int k = 0; k < 3; k++) hit->position[k] = o[k] + hit->t * d[k];
    float up = lift(hit->position, hit->t);
    for (int k = 0; k < 3; k++) hit->position[k] += up * hit->normal[k];
    return true;
}

static struct RTCRay ray_of(const float o[3], const float d[3], float near, float far) {
    return (struct RTCRay){.org_x = o[0],
                           .org_y = o[1],
                           .org_z = o[2],
                           .tnear = near,
                           .dir_x = d[0],
                           .dir_y = d[1],
                           .dir_z = d[2],
                           .mask = 0xFFFFFFFFu,
                           .tfar = far};
}

static bool polygon_ray(const masu_bake_trace *trace, const float origin[3],
                        const float direction[3], float far, masu_bake_hit *hit) {
    float near = 0;
    if (!trace->triangles) return false;
    for (int passed = 0; passed < MASKS_MAX; passed++) {
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        struct RTCRayHit r = {.ray = ray_of(origin, direction, near, far)};
        r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(trace->scene, &context, &r);
        if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        if (fill(trace, &r, hit)) return true;
        near = r.ray.tfar + 4e-6f * r.ray.tfar + 1e-6f;
    }
    return false;
}

/* The field wants directions of unit length. */
static bool field_ray(const masu_bake_trace *trace, const float origin[3], const float direction[3],
                      float far, masu_bake_hit *hit) {
    if (!trace->field) return false;
    float length = sqrtf(direction[0] * direction[0] + direction[1] * direction[1] +
                         direction[2] * direction[2]);
    if (!(length > 0)) return false;
    const float d[3] = {direction[0] / length, direction[1] / length, direction[2] / length};
    if (!masu_bake_field_ray(trace->field, origin, d,
                             far < FLT_MAX / length ? far * length : FLT_MAX, hit))
        return false;
    if (hit) hit->t /= length;
    return true;
}

bool masu_bake_trace_ray(const masu_bake_trace *trace, const float origin[3],
                         const float direction[3], float far, masu_bake_hit *hit) {
    bool met = polygon_ray(trace, origin, direction, far, hit);
    return field_ray(trace, origin, direction, met ? hit->t : far, hit) || met;
}

static bool polygons_free(const masu_bake_trace *trace, const float origin[3],
                          const float direction[3], float far) {
    if (!trace->triangles) return true;
    if (trace->masks) {
        masu_bake_hit hit;
        return !polygon_ray(trace, origin, direction, far, &hit);
    }
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRay r = ray_of(origin, direction, 0, far);
    rtcOccluded1(trace->scene, &context, &r);
    return r.tfar > 0; /* -infinity where something is in between */
}

bool masu_bake_trace_free(const masu_bake_trace *trace, const float origin[3],
                          const float direction[3], float far) {
    return polygons_free(trace, origin, direction, far) &&
           !field_ray(trace, origin, direction, far, NULL);
}

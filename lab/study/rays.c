/* rays.c: rays, and their hits from Embree; see rays.h. */
#include "lab/study/rays.h"

#include "clock.h"
#include "scene/scene.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define THREADS_MAX 16u
#define CHUNK 1024u

/* ---- Scene ----------------------------------------------------------------------------------- */

static void transform_of(const masu_bench_rays *r, uint32_t traced, double m[12]) {
    const masu_blob_instance *n = &r->view.instances[r->view.trace_instances[traced]];
    for (uint32_t i = 0; i < 12; i++) m[i] = (double)n->transform[i];
    for (uint32_t k = 0; k < 3; k++) m[4 * k + 3] -= r->anchor[k];
}

static void moved(const double m[12], const float p[3], double out[3]) {
    for (uint32_t k = 0; k < 3; k++) {
        out[k] = m[4 * k] * (double)p[0] + m[4 * k + 1] * (double)p[1] +
                 m[4 * k + 2] * (double)p[2] + m[4 * k + 3];
    }
}

/* Shares the blob's vertices; Embree needs indices of 12 bytes, so they are copied. */
static RTCScene mesh_of(masu_bench_rays *r, uint32_t mesh) {
    const masu_blob_trace_mesh *m = &r->view.trace_meshes[mesh];
    RTCScene scene = rtcNewScene(r->device);
    RTCGeometry g = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, r->view.vertices, 0,
                               sizeof(masu_blob_vertex), masu_scene_data_of(&r->scene)->vertices);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               r->view.trace_triangles + m->first_triangle, 0,
                               sizeof(masu_blob_trace_triangle), m->triangle_count);
    rtcCommitGeometry(g);
    rtcAttachGeometry(scene, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(scene);
    return scene;
}

static void add_instances(masu_bench_rays *r) {
    for (uint32_t i = 0; i < masu_scene_data_of(&r->scene)->trace_instances; i++) {
        uint32_t mesh = r->view.instances[r->view.trace_instances[i]].mesh;
        double m[12];
        float columns[12];
        if (!r->meshes[mesh]) r->meshes[mesh] = mesh_of(r, mesh);
        RTCGeometry g = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_INSTANCE);
        transform_of(r, i, m);
        for (uint32_t k = 0; k < 12; k++) columns[k] = (float)m[k % 3 * 4 + k / 3];
        rtcSetGeometryInstancedScene(g, r->meshes[mesh]);
        rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        rtcCommitGeometry(g);
        rtcAttachGeometryByID(r->embree, g, i);
        rtcReleaseGeometry(g);
    }
}

static bool add_flat(masu_bench_rays *r) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < masu_scene_data_of(&r->scene)->trace_instances; i++) {
        count +=
            r->view.trace_meshes[r->view.instances[r->view.trace_instances[i]].mesh].triangle_count;
    }
    r->flat_vertices = malloc((count * 9 + 1) * sizeof(float));
    r->flat_triangle = malloc((count * 2 + 1) * sizeof(uint32_t));
    if (!r->flat_vertices || !r->flat_triangle) return false;
    RTCGeometry g = rtcNewGeometry(r->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_HIGH);
    uint32_t *index = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(uint32_t), count);
    uint64_t at = 0;
    for (uint32_t i = 0; i < masu_scene_data_of(&r->scene)->trace_instances; i++) {
        const masu_blob_trace_mesh *mesh =
            &r->view.trace_meshes[r->view.instances[r->view.trace_instances[i]].mesh];
        double m[12], p[3];
        transform_of(r, i, m);
        for (uint32_t t = mesh->first_triangle; t < mesh->first_triangle + mesh->triangle_count;
             t++) {
            for (uint32_t k = 0; k < 3; k++) {
                moved(m, r->view.vertices[r->view.trace_triangles[t].vertex[k]].position, p);
                for (uint32_t c = 0; c < 3; c++) r->flat_vertices[9 * at + 3 * k + c] = (float)p[c];
                index[3 * at + k] = (uint32_t)(3 * at + k);
            }
            r->flat_triangle[2 * at] = t;
            r->flat_triangle[2 * at++ + 1] = i;
        }
    }
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, r->flat_vertices, 0,
                               3 * sizeof(float), 3 * count);
    rtcCommitGeometry(g);
    rtcAttachGeometry(r->embree, g);
    rtcReleaseGeometry(g);
    return true;
}

bool masu_bench_rays_open(const masu_scene *scene, const double anchor[3], bool flat,
                          masu_bench_rays *r, char *error, size_t error_size) {
    *r = (masu_bench_rays){.view = masu_scene_view_of(scene), .scene = *scene, .flat = flat};
    memcpy(r->anchor, anchor, sizeof r->anchor);
    if (!masu_scene_data_of(scene)->trace_instances) {
        snprintf(error, error_size,
                 "nothing is traced: the scene was baked without \"reflections\"");
        return false;
    }
    r->top_memory = malloc(masu_trace_top_bytes(masu_scene_data_of(scene)->trace_instances));
    r->meshes = calloc(masu_scene_data_of(scene)->meshes, sizeof *r->meshes);
    r->device = rtcNewDevice(NULL);
    if (!r->top_memory || !r->meshes || !r->device) {
        snprintf(error, error_size, "out of memory, or Embree does not start");
        masu_bench_rays_close(r);
        return false;
    }
    masu_trace_top_init(&r->top, r->top_memory, masu_scene_data_of(scene)->trace_instances);
    for (uint32_t i = 0; i < masu_scene_data_of(scene)->trace_instances; i++) {
        masu_trace_root root = masu_trace_root_of(&r->view, i);
        masu_trace_top_set(&r->top, i, &root);
        (void)masu_trace_top_place(&r->top, i, r->view.instances[root.instance].transform);
    }
    (void)masu_trace_top_update(&r->top, anchor);
    r->embree = rtcNewScene(r->device);
    rtcSetSceneBuildQuality(r->embree, RTC_BUILD_QUALITY_HIGH);
    if (!flat) {
        add_instances(r);
    } else if (!add_flat(r)) {
        snprintf(error, error_size, "out of memory");
        masu_bench_rays_close(r);
        return false;
    }
    rtcCommitScene(r->embree);
    return true;
}

void masu_bench_rays_close(masu_bench_rays *r) {
    if (r->embree) rtcReleaseScene(r->embree);
    for (uint32_t i = 0; r->meshes && i < masu_scene_data_of(&r->scene)->meshes; i++) {
        if (r->meshes[i]) rtcReleaseScene(r->meshes[i]);
    }
    if (r->device) rtcReleaseDevice(r->device);
    free(r->flat_vertices);
    free(r->flat_triangle);
    free(r->meshes);
    free(r->top_memory);
    memset(r, 0, sizeof *r);
}

/* ---- Embree ---------------------------------------------------------------------------------- */

typedef struct job {
    const masu_bench_rays *rays;
    const masu_bench_ray *in;
    masu_bench_hit *out;
    uint32_t count, first, step;
} job;

static void ask(const job *j, uint32_t i) {
    const masu_bench_rays *rays = j->rays;
    const masu_bench_ray *in = &j->in[i];
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit r = {
        .ray = {.org_x = in->origin[0],
                .org_y = in->origin[1],
                .org_z = in->origin[2],
                .tnear = in->t_min,
                .dir_x = in->direction[0],
                .dir_y = in->direction[1],
                .dir_z = in->direction[2],
                .tfar = in->t_max,
                .mask = 0xFFFFFFFFu},
        .hit = {.geomID = RTC_INVALID_GEOMETRY_ID, .instID = {RTC_INVALID_GEOMETRY_ID}}};
    rtcIntersect1(rays->embree, &context, &r);
    masu_bench_hit *out = &j->out[i];
    out->t = -1.0f;
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    out->t = r.ray.tfar;
    out->barycentrics[0] = r.hit.u;
    out->barycentrics[1] = r.hit.v;
    if (rays->flat) {
        out->triangle = rays->flat_triangle[2 * r.hit.primID];
        out->traced = rays->flat_triangle[2 * r.hit.primID + 1];
    } else {
        out->traced = r.hit.instID[0];
        uint32_t mesh = rays->view.instances[rays->view.trace_instances[out->traced]].mesh;
        out->triangle = rays->view.trace_meshes[mesh].first_triangle + r.hit.primID;
    }
}

static void *work(void *argument) {
    const job *j = argument;
    for (uint32_t at = j->first * CHUNK; at < j->count; at += j->step * CHUNK) {
        for (uint32_t i = at; i < at + CHUNK && i < j->count; i++) ask(j, i);
    }
    return NULL;
}

double masu_bench_rays_embree(const masu_bench_rays *rays, const masu_bench_ray *in, uint32_t count,
                              uint32_t threads, masu_bench_hit *out) {
    pthread_t thread[THREADS_MAX];
    job jobs[THREADS_MAX];
    if (threads > THREADS_MAX) threads = THREADS_MAX;
    uint64_t from = masu_clock_ns(NULL);
    uint32_t started = 1;
    for (uint32_t i = 0; i < threads; i++) jobs[i] = (job){rays, in, out, count, i, threads};
    while (started < threads && !pthread_create(&thread[started], NULL, work, &jobs[started]))
        started++;
    for (uint32_t i = started; i < threads; i++) work(&jobs[i]);
    work(&jobs[0]);
    for (uint32_t i = 1; i < started; i++) pthread_join(thread[i], NULL);
    return (double)(masu_clock_ns(NULL) - from) * 1e-9;
}

/* ---- Rays ------------------------------------------------------------------------------------ */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (uint32_t k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void unit(double v[3]) {
    double length = sqrt(dot(v, v));
    for (uint32_t k = 0; k < 3; k++) v[k] = length > 0 ? v[k] / length : k == 1;
}

void masu_bench_rays_primary(const masu_bench_rays *rays, const masu_blob_camera_key *camera,
                             uint32_t width, uint32_t height, masu_bench_ray *out) {
    double forward[3], right[3], up[3] = {0, 1, 0}, fov = tan(0.5 * (double)camera->fov_y);
    for (uint32_t k = 0; k < 3; k++)
        forward[k] = (double)camera->target[k] - (double)camera->position[k];
    unit(forward);
    if (fabs(forward[1]) > 0.9999) up[1] = 0, up[2] = 1;
    cross(forward, up, right);
    unit(right);
    cross(right, forward, up);
    uint32_t at = 0;
    for (uint32_t tile = 0; tile < (width + 7) / 8 * ((height + 7) / 8); tile++) {
        for (uint32_t i = 0; i < 64; i++) {
            uint32_t x = tile % ((width + 7) / 8) * 8 + (i >> 3 & 1) * 4 + (i & 3);
            uint32_t y = tile / ((width + 7) / 8) * 8 + (i >> 4) * 2 + (i >> 2 & 1);
            if (x >= width || y >= height) continue;
            double u = (2 * (x + 0.5) / width - 1) * fov * width / height;
            double v = (1 - 2 * (y + 0.5) / height) * fov, d[3];
            for (uint32_t k = 0; k < 3; k++) d[k] = forward[k] + u * right[k] + v * up[k];
            unit(d);
            masu_bench_ray *r = &out[at++];
            *r = (masu_bench_ray){.t_max = 1e30f};
            for (uint32_t k = 0; k < 3; k++) {
                r->origin[k] = (float)((double)camera->position[k] - rays->anchor[k]);
                r->direction[k] = (float)d[k];
            }
        }
    }
}

void masu_bench_rays_normal(const masu_bench_rays *rays, const masu_bench_hit *hit, double out[3]) {
    const uint32_t *corner = rays->view.trace_triangles[hit->triangle].vertex;
    double m[12], p[3][3], a[3], b[3];
    transform_of(rays, hit->traced, m);
    for (uint32_t k = 0; k < 3; k++) moved(m, rays->view.vertices[corner[k]].position, p[k]);
    for (uint32_t k = 0; k < 3; k++) {
        a[k] = p[1][k] - p[0][k];
        b[k] = p[2][k] - p[0][k];
    }
    cross(a, b, out);
}

/* PCG-RXS-M-XS 32 (O'Neill 2014). */
static double random_of(uint32_t *state) {
    *state = *state * 747796405u + 2891336453u;
    uint32_t word = ((*state >> ((*state >> 28) + 4)) ^ *state) * 277803737u;
    return ((word >> 22) ^ word) * 0x1p-32;
}

uint32_t masu_bench_rays_specular(const masu_bench_rays *rays, const masu_bench_ray *in,
                                  const masu_bench_hit *hits, uint32_t count, double roughness,
                                  masu_bench_ray *out) {
    uint32_t state = 1, made = 0;
    double alpha = roughness * roughness;
    for (uint32_t i = 0; i < count; i++) {
        double n[3], d[3], h[3], s[3], t[3], u1 = random_of(&state), u2 = random_of(&state);
        if (!(hits[i].t >= 0)) continue;
        masu_bench_rays_normal(rays, &hits[i], n);
        unit(n);
        for (uint32_t k = 0; k < 3; k++) d[k] = (double)in[i].direction[k];
        if (dot(n, d) > 0)
            for (uint32_t k = 0; k < 3; k++) n[k] = -n[k];
        /* The half vector by GGX's density (Walter et al. 2007, equation 35). */
        double theta = atan(alpha * sqrt(u1 / (1 - u1))), phi = 2 * 3.14159265358979323846 * u2;
        const double any[3] = {fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0};
        cross(n, any, s);
        unit(s);
        cross(n, s, t);
        for (uint32_t k = 0; k < 3; k++) {
            h[k] = cos(theta) * n[k] + sin(theta) * (cos(phi) * s[k] + sin(phi) * t[k]);
        }
        double along = dot(d, h), most = 0;
        for (uint32_t k = 0; k < 3; k++) d[k] -= 2 * along * h[k];
        double below = dot(d, n);
        if (below < 0)
            for (uint32_t k = 0; k < 3; k++) d[k] -= 2 * below * n[k];
        unit(d);
        masu_bench_ray *r = &out[made++];
        *r = (masu_bench_ray){.t_max = 1e30f};
        double p[3];
        for (uint32_t k = 0; k < 3; k++) {
            p[k] = (double)in[i].origin[k] + (double)hits[i].t * (double)in[i].direction[k];
            most = fmax(most, fabs(p[k]) + (double)hits[i].t);
        }
        for (uint32_t k = 0; k < 3; k++) {
            r->origin[k] = (float)(p[k] + n[k] * (4e-6 * most + 1e-6));
            r->direction[k] = (float)d[k];
        }
    }
    return made;
}

/* ao.c: see ao.h. */
#include "support/ao.h"

#include "scene/scene.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { STEPS = 2000 };

static const double golden = 2.399963229728653;

/* ---- Polygons -------------------------------------------------------------------------------- */

/* One mesh as a separate Embree scene, for its instances. */
static RTCScene mesh_scene(RTCDevice device, const masu_scene_view *v, uint32_t mesh) {
    RTCScene scene = rtcNewScene(device);
    for (uint32_t p = 0; p < v->meshes[mesh].primitive_count; p++) {
        const masu_blob_primitive *part = &v->primitives[v->meshes[mesh].first_primitive + p];
        if (!part->index_count) continue;
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        float *to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            3 * sizeof(float), part->vertex_count);
        uint32_t *indices =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(uint32_t), part->index_count / 3);
        if (to && indices) {
            for (uint32_t i = 0; i < part->vertex_count; i++)
                memcpy(to + 3 * (size_t)i, v->vertices[part->first_vertex + i].position,
                       3 * sizeof(float));
            memcpy(indices, v->indices + part->first_index, part->index_count * sizeof(uint32_t));
            rtcCommitGeometry(geometry);
            rtcAttachGeometry(scene, geometry);
        }
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    return scene;
}

bool masu_ao_open(const masu_scene *scene, masu_ao_world *world, char *error, size_t error_size) {
    memset(world, 0, sizeof *world);
    if (!masu_scene_count(scene, MASU_SCENE_INSTANCE)) return true;
    masu_scene_view v = masu_scene_view_of(scene);
    RTCDevice device = rtcNewDevice("threads=1");
    if (!device) {
        snprintf(error, error_size, "Embree cannot be started");
        return false;
    }
    RTCScene all = rtcNewScene(device), of_mesh = NULL;
    uint32_t last = MASU_BLOB_NONE; /* instances are sorted by mesh */
    for (uint32_t i = 0; i < masu_scene_count(scene, MASU_SCENE_INSTANCE); i++) {
        const masu_blob_instance *placed = &v.instances[i];
        if (placed->mesh != last) {
            if (of_mesh) rtcReleaseScene(of_mesh);
            of_mesh = mesh_scene(device, &v, placed->mesh);
            last = placed->mesh;
        }
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(geometry, of_mesh);
        rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, placed->transform);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(all, geometry);
        rtcReleaseGeometry(geometry);
    }
    if (of_mesh) rtcReleaseScene(of_mesh);
    rtcCommitScene(all);
    world->device = device;
    world->scene = all;
    int code = (int)rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return true;
    snprintf(error, error_size, "Embree cannot take the scene (error %d)", code);
    masu_ao_close(world);
    return false;
}

void masu_ao_close(masu_ao_world *world) {
    if (world->scene) rtcReleaseScene(world->scene);
    if (world->device) rtcReleaseDevice(world->device);
    memset(world, 0, sizeof *world);
}

static double polygon_at(const masu_ao_world *w, const double from[3], const double d[3],
                         double limit) {
    struct RTCIntersectContext context;
    struct RTCRayHit ray;
    if (!w->scene) return limit;
    rtcInitIntersectContext(&context);
    memset(&ray, 0, sizeof ray);
    ray.ray.org_x = (float)from[0], ray.ray.org_y = (float)from[1], ray.ray.org_z = (float)from[2];
    ray.ray.dir_x = (float)d[0], ray.ray.dir_y = (float)d[1], ray.ray.dir_z = (float)d[2];
    ray.ray.tfar = (float)limit;
    ray.ray.mask = 0xFFFFFFFFu;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(w->scene, &context, &ray);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? limit : (double)ray.ray.tfar;
}

/* ---- The SDF --------------------------------------------------------------------------------- */

/* Only geometry inside the bounds is rendered or occludes. A ray that is still active after all
 * steps is creeping along a surface: it is treated as a hit there. */
static double field_at(const masu_ao_world *w, const double from[3], const double d[3],
                       double limit) {
    double end = limit, t = 0, size = 1;
    if (!w->field) return limit;
    for (int k = 0; k < 3; k++) {
        size = fmax(size, fabs(from[k]));
        if (fabs(d[k]) < 1e-300) continue;
        end = fmin(end, fmax((w->view->sdf_min[k] - from[k]) / d[k],
                             (w->view->sdf_max[k] - from[k]) / d[k]));
    }
    for (int i = 0; i < STEPS; i++) {
        double p[3] = {from[0] + d[0] * t, from[1] + d[1] * t, from[2] + d[2] * t};
        if (!(t < end)) return limit;
        double step = w->field->step(w->view->params, w->view->time, p);
        if (!isfinite(step)) return limit;
        if (step < 1e-7 * size) return t;
        t += step;
    }
    return t;
}

/* ---- A point --------------------------------------------------------------------------------- */

/* Two unit directions orthogonal to n and to each other. */
static void across(const double n[3], double u[3], double v[3]) {
    int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) < fabs(n[least])) least = 2;
    double length = 0;
    for (int k = 0; k < 3; k++) {
        u[k] = (k == least) - n[k] * n[least];
        length += u[k] * u[k];
    }
    for (int k = 0; k < 3; k++) u[k] /= sqrt(length);
    for (int k = 0; k < 3; k++)
        v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
}

static double turn_of(uint32_t number) {
    uint64_t z = (number + 1) * UINT64_C(0x9E3779B97F4A7C15); /* splitmix64 */
    z = (z ^ z >> 30) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ z >> 27) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53 * 6.283185307179586;
}

double masu_ao_seen(const masu_ao_world *world, const double point[3], const double normal[3],
                    double lift, double radius, uint32_t rays, uint32_t number) {
    double u[3], v[3], from[3], sum = 0, turn = turn_of(number);
    across(normal, u, v);
    for (int k = 0; k < 3; k++) from[k] = point[k] + normal[k] * lift;
    for (uint32_t i = 0; i < rays; i++) {
        double r2 = (i + 0.5) / rays, r = sqrt(r2), up = sqrt(1 - r2), d[3];
        double x = r * cos(golden * i + turn), y = r * sin(golden * i + turn);
        for (int k = 0; k < 3; k++) d[k] = u[k] * x + v[k] * y + normal[k] * up;
        double t = polygon_at(world, from, d, radius);
        sum += field_at(world, from, d, t) / radius;
    }
    return sum / rays;
}

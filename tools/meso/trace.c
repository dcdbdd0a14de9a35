/* trace.c: see trace.h. */
#include "meso/trace.h"

#include <embree3/rtcore.h>
#include <stdlib.h>
#include <string.h>

#include "cli/cli.h"

/* In periods: 20 times the rounding of a float near 1, a thousandth of a grain of asphalt. */
#define OFFSET 2e-6

struct masu_meso_tracer {
    RTCDevice device;
    RTCScene scene;
    float *vertex, *color;
    uint32_t *index;
    double low, high;
};

/* Vertices and triangles of the patch, and those of its eight neighbours that reach into the
 * period. */
typedef struct cell {
    float *vertex, *color;
    uint32_t *index;
    size_t triangles;
} cell;

static bool reaches_in(const masu_meso_patch *p, const uint32_t *t, float dx, float dz) {
    float low[2] = {1e30f, 1e30f}, high[2] = {-1e30f, -1e30f};
    for (int k = 0; k < 3; k++) {
        const float *v = p->position + 3 * (size_t)t[k];
        float at[2] = {v[0] + dx, v[2] + dz};
        for (int a = 0; a < 2; a++) {
            low[a] = at[a] < low[a] ? at[a] : low[a];
            high[a] = at[a] > high[a] ? at[a] : high[a];
        }
    }
    return high[0] >= 0 && low[0] <= 1 && high[1] >= 0 && low[1] <= 1;
}

static size_t count_reaching(const masu_meso_patch *p) {
    size_t n = 0;
    for (int s = 0; s < 9; s++) {
        for (size_t i = 0; i < p->triangle_count; i++) {
            n += reaches_in(p, p->index + 3 * i, (float)(s % 3 - 1), (float)(s / 3 - 1));
        }
    }
    return n;
}

static bool fill(masu_meso_tracer *t, const masu_meso_patch *p, size_t triangles) {
    /* Embree reads 16 bytes per vertex: one more float at the end. */
    t->vertex = malloc((triangles * 9 + 4) * sizeof(float));
    t->color = malloc((triangles * 9 + 4) * sizeof(float));
    t->index = malloc((triangles * 3 + 4) * sizeof(uint32_t));
    if (!t->vertex || !t->color || !t->index) return false;
    size_t n = 0;
    for (int s = 0; s < 9; s++) {
        float dx = (float)(s % 3 - 1), dz = (float)(s / 3 - 1);
        for (size_t i = 0; i < p->triangle_count; i++) {
            const uint32_t *tri = p->index + 3 * i;
            if (!reaches_in(p, tri, dx, dz)) continue;
            for (int k = 0; k < 3; k++) {
                const float *v = p->position + 3 * (size_t)tri[k];
                const float moved[3] = {v[0] + dx, v[1], v[2] + dz};
                memcpy(t->vertex + 9 * n + 3 * k, moved, sizeof moved);
                memcpy(t->color + 9 * n + 3 * k, p->color + 3 * (size_t)tri[k], sizeof moved);
                t->index[3 * n + (size_t)k] = (uint32_t)(3 * n + (size_t)k);
            }
            n++;
        }
    }
    return true;
}

masu_meso_tracer *masu_meso_tracer_create(const masu_meso_patch *patch) {
    masu_meso_tracer *t = calloc(1, sizeof *t);
    size_t triangles = count_reaching(patch);
    if (!t || !triangles || !fill(t, patch, triangles)) {
        masu_cli_error(triangles ? "out of memory: %zu triangles" : "the patch has no triangles",
                       triangles);
        masu_meso_tracer_free(t);
        return NULL;
    }
    t->low = patch->low - 1e-4;
    t->high = patch->high + 1e-4;
    t->device = rtcNewDevice("threads=1,set_affinity=0");
    if (!t->device) {
        masu_cli_error("cannot create an Embree device: error %d", (int)rtcGetDeviceError(NULL));
        masu_meso_tracer_free(t);
        return NULL;
    }
    t->scene = rtcNewScene(t->device);
    rtcSetSceneFlags(t->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry g = rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, t->vertex, 0,
                               3 * sizeof(float), 3 * triangles);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, t->index, 0,
                               3 * sizeof(uint32_t), triangles);
    rtcCommitGeometry(g);
    rtcAttachGeometry(t->scene, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(t->scene);
    if (rtcGetDeviceError(t->device) != RTC_ERROR_NONE) {
        masu_cli_error("Embree cannot build a BVH of %zu triangles", triangles);
        masu_meso_tracer_free(t);
        return NULL;
    }
    return t;
}

void masu_meso_tracer_free(masu_meso_tracer *tracer) {
    if (!tracer) return;
    if (tracer->scene) rtcReleaseScene(tracer->scene);
    if (tracer->device) rtcReleaseDevice(tracer->device);
    free(tracer->vertex);
    free(tracer->color);
    free(tracer->index);
    free(tracer);
}

/* Traversal of cells. `at` is within the period; distances are from `at`. */
typedef struct walk {
    double at[3], direction[3];
    double left;     /* distance to the end of the relief's slab */
    double shift[2]; /* periods crossed */
} walk;

static bool begin(const masu_meso_tracer *t, masu_meso_vec3 from, masu_meso_vec3 d, walk *w) {
    double p[3] = {from.x, from.y, from.z}, v[3] = {d.x, d.y, d.z};
    double enter = 0, leave = 1e9;
    if (fabs(v[1]) > 1e-12) {
        double a = (t->low - p[1]) / v[1], b = (t->high - p[1]) / v[1];
        enter = fmax(enter, fmin(a, b));
        leave = fmin(leave, fmax(a, b));
    } else if (p[1] < t->low || p[1] > t->high) {
        return false;
    }
    if (!(enter <= leave)) return false;
    for (int k = 0; k < 3; k++) {
        w->at[k] = p[k] + v[k] * enter;
        w->direction[k] = v[k];
    }
    w->left = leave - enter;
    for (int a = 0; a < 2; a++) {
        double cell = floor(w->at[2 * a]);
        w->at[2 * a] -= cell;
        w->shift[a] = cell;
    }
    return true;
}

/* Distance to the end of the cell; *axis of its wall: 0 or 2. */
static double to_wall(const walk *w, int *axis) {
    double nearest = 1e9;
    *axis = 0;
    for (int a = 0; a < 3; a += 2) {
        if (fabs(w->direction[a]) < 1e-12) continue;
        double s = ((w->direction[a] > 0 ? 1 : 0) - w->at[a]) / w->direction[a];
        s = s > 0 ? s : 0;
        if (s < nearest) {
            nearest = s;
            *axis = a;
        }
    }
    return nearest;
}

static void through_wall(walk *w, double distance, int axis) {
    for (int k = 0; k < 3; k++) w->at[k] += w->direction[k] * distance;
    double step = w->direction[axis] > 0 ? 1 : -1;
    w->at[axis] = step > 0 ? 0 : 1;
    w->shift[axis / 2] += step;
    w->left -= distance;
    int other = 2 - axis; /* rounding must not leave the cell on the other axis */
    w->at[other] = w->at[other] < 0 ? 0 : w->at[other] > 1 ? 1 : w->at[other];
}

static void set_ray(const walk *w, double reach, struct RTCRay *ray) {
    ray->org_x = (float)w->at[0];
    ray->org_y = (float)w->at[1];
    ray->org_z = (float)w->at[2];
    ray->dir_x = (float)w->direction[0];
    ray->dir_y = (float)w->direction[1];
    ray->dir_z = (float)w->direction[2];
    ray->tnear = 0;
    ray->tfar = (float)reach;
    ray->time = 0;
    ray->mask = 0xFFFFFFFFu;
    ray->id = 0;
    ray->flags = 0;
}

static void describe(const masu_meso_tracer *t, const walk *w, const struct RTCRayHit *h,
                     masu_meso_hit *hit) {
    double s = (double)h->ray.tfar;
    hit->position = masu_bake_v3(w->at[0] + s * w->direction[0], w->at[1] + s * w->direction[1],
                                 w->at[2] + s * w->direction[2]);
    masu_meso_vec3 n = masu_bake_v3((double)h->hit.Ng_x, (double)h->hit.Ng_y, (double)h->hit.Ng_z);
    if (!masu_bake_normalize(&n)) n = masu_bake_v3(0, 1, 0);
    double facing = n.x * w->direction[0] + n.y * w->direction[1] + n.z * w->direction[2];
    hit->normal = facing > 0 ? masu_bake_v3(-n.x, -n.y, -n.z) : n;
    const float *c = t->color + 9 * (size_t)h->hit.primID;
    double u = (double)h->hit.u, v = (double)h->hit.v;
    for (int k = 0; k < 3; k++) {
        hit->color[k] = (1 - u - v) * (double)c[k] + u * (double)c[3 + k] + v * (double)c[6 + k];
    }
    hit->shift[0] = w->shift[0];
    hit->shift[1] = w->shift[1];
}

bool masu_meso_trace(const masu_meso_tracer *tracer, masu_meso_vec3 from, masu_meso_vec3 direction,
                     masu_meso_hit *hit) {
    walk w;
    if (!begin(tracer, from, direction, &w)) return false;
    for (int i = 0; i < MASU_MESO_CELLS_MAX && w.left > 0; i++) {
        int axis;
        double wall = to_wall(&w, &axis);
        struct RTCIntersectContext context;
        struct RTCRayHit h;
        rtcInitIntersectContext(&context);
        set_ray(&w, fmin(wall, w.left), &h.ray);
        h.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        h.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(tracer->scene, &context, &h);
        if (h.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            describe(tracer, &w, &h, hit);
            return true;
        }
        through_wall(&w, wall, axis);
    }
    return false;
}

bool masu_meso_blocked(const masu_meso_tracer *tracer, masu_meso_vec3 from, masu_meso_vec3 normal,
                       masu_meso_vec3 direction) {
    walk w;
    double side = masu_bake_dot(normal, direction) > 0 ? OFFSET : -OFFSET;
    if (!begin(tracer, masu_bake_mad(from, normal, side), direction, &w)) return false;
    for (int i = 0; i < MASU_MESO_CELLS_MAX && w.left > 0; i++) {
        int axis;
        double wall = to_wall(&w, &axis);
        struct RTCIntersectContext context;
        struct RTCRay ray;
        rtcInitIntersectContext(&context);
        set_ray(&w, fmin(wall, w.left), &ray);
        rtcOccluded1(tracer->scene, &context, &ray);
        if (ray.tfar < 0) return true;
        through_wall(&w, wall, axis);
    }
    return false;
}

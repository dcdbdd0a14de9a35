/* test_trace.c: rays through shaders/trace/bvh.glsl against Embree 3 (its robust mode), with the
 * same triangles under the same transforms; and against single triangles in double precision if the
 * two differ.
 *
 * THE RULE. If hit or miss differs, or t by a relative 1e-4, double-precision arithmetic decides,
 * with each triangle enlarged and shrunk by a margin of MARGIN times the coordinates that went into
 * it: the uncertainty of fp32. A hit of the shader is accepted if an enlarged triangle is hit at
 * its t, and no shrunk triangle is hit closer; a miss is accepted if no shrunk triangle is hit. A t
 * may differ by a relative 1e-4, by the margin over the cosine at which the triangle is hit, and,
 * for a needle, by the rounding of its weights (for a needle 1e5 times as long as thin, the
 * watertight test decides the hit exactly, but the position only to a hundredth of its length).
 * Every other answer is an error; there may be none. A crack between triangles would be hidden by
 * that rule, so closed meshes have a separate test: no ray from inside escapes. */
#include "support/files.h"
#include "support/support.h"
#include "support/random.h"
#include "support/compute.h"

#include "shared/masu_shared.h"
#include "scene/trace.h"

#include "trace_mask_comp.spv.h"
#include "trace_rays_comp.spv.h"
#include "trace_rays_counted_comp.spv.h"
#include "reference/vec.h"

#include <embree3/rtcore.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define VERTICES_MAX 65536u
#define TRIANGLES_MAX 65536u
#define MESHES_MAX 8u
#define INSTANCES_MAX 5000u
#define MARGIN 2e-6

enum { ICOSPHERE, SOUP, NEEDLES, FAR, PLANES, CORNER, MESHES };

typedef struct ray {
    float origin[3], t_min, direction[3], t_max;
} ray;

typedef struct hit {
    float t;
    uint32_t triangle, instance, nodes;
    float weights[2];
    uint32_t triangles, record;
} hit;

typedef struct world {
    masu_blob_vertex vertices[VERTICES_MAX];
    masu_blob_trace_triangle triangles[TRIANGLES_MAX]; /* in the order of the BVHs, after build */
    masu_blob_trace_node nodes[TRIANGLES_MAX];
    uint32_t vertex_count, triangle_count, node_count;
    struct {
        uint32_t first_triangle, triangle_count, root;
        masu_trace_box box;
    } meshes[MESHES_MAX];
    uint32_t mesh_of[INSTANCES_MAX];
    float transforms[INSTANCES_MAX][12];
    uint32_t instance_count;
    masu_trace_top top;
    double anchor[3];
    void *top_memory;
    unsigned char *fixed, *frame;
    masu_trace_static layout;
    RTCDevice device;
    RTCScene scene, mesh_scenes[MESHES_MAX];
} world;

static world w;
static uint64_t seed = 1;

static float number(float low, float high) {
    return (float)random_between(&seed, (double)low, (double)high);
}

static uint32_t below(uint32_t n) { return (uint32_t)(number(0, 1) * (float)n) % n; }

/* ---- Meshes ---------------------------------------------------------------------------------- */

static uint32_t vertex(float x, float y, float z) {
    assert_true(w.vertex_count < VERTICES_MAX);
    w.vertices[w.vertex_count].position[0] = x;
    w.vertices[w.vertex_count].position[1] = y;
    w.vertices[w.vertex_count].position[2] = z;
    return w.vertex_count++;
}

static void triangle(uint32_t a, uint32_t b, uint32_t c) {
    assert_true(w.triangle_count < TRIANGLES_MAX);
    w.triangles[w.triangle_count++] = (masu_blob_trace_triangle){{a, b, c}, 0};
}

static uint32_t between(uint32_t a, uint32_t b, uint32_t first) {
    float m[3], length = 0;
    for (int k = 0; k < 3; k++) {
        m[k] = w.vertices[a].position[k] + w.vertices[b].position[k];
        length += m[k] * m[k];
    }
    for (int k = 0; k < 3; k++) m[k] /= sqrtf(length);
    for (uint32_t i = first; i < w.vertex_count; i++) {
        if (!memcmp(w.vertices[i].position, m, sizeof m)) return i;
    }
    return vertex(m[0], m[1], m[2]);
}

/* Closed: an octahedron with subdivided triangles. */
static void add_icosphere(uint32_t levels) {
    static const float corners[6][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                        {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    static const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    uint32_t first = w.vertex_count, from = w.triangle_count;
    for (int i = 0; i < 6; i++) vertex(corners[i][0], corners[i][1], corners[i][2]);
    for (int i = 0; i < 8; i++)
        triangle(first + faces[i][0], first + faces[i][1], first + faces[i][2]);
    for (uint32_t level = 0; level < levels; level++) {
        uint32_t end = w.triangle_count;
        for (uint32_t i = from; i < end; i++) {
            uint32_t *v = w.triangles[i].vertex, a = v[0], b = v[1], c = v[2];
            uint32_t ab = between(a, b, first), bc = between(b, c, first),
                     ca = between(c, a, first);
            triangle(a, ab, ca);
            triangle(b, bc, ab);
            triangle(c, ca, bc);
            memcpy(v, (uint32_t[3]){ab, bc, ca}, 3 * sizeof *v);
        }
    }
}

static void add_soup(uint32_t count, float size, float middle) {
    for (uint32_t i = 0; i < count; i++) {
        float at[3];
        uint32_t v[3];
        for (int k = 0; k < 3; k++) at[k] = number(-1, 1);
        for (int c = 0; c < 3; c++) {
            v[c] = vertex(middle + at[0] + number(-size, size), at[1] + number(-size, size),
                          at[2] + number(-size, size));
        }
        triangle(v[0], v[1], v[2]);
    }
}

/* 100,000 times as long as thin, in all directions. */
static void add_needles(uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        float a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = number(-1, 1);
            b[k] = number(-1, 1);
        }
        triangle(vertex(a[0], a[1], a[2]), vertex(b[0], b[1], b[2]),
                 vertex(b[0] + number(-1e-5f, 1e-5f), b[1] + 2e-5f, b[2]));
    }
}

/* Two squares of many triangles, one above the other. */
static void add_planes(uint32_t side) {
    for (int layer = 0; layer < 2; layer++) {
        uint32_t first = w.vertex_count;
        for (uint32_t i = 0; i < (side + 1) * (side + 1); i++) {
            vertex((float)(i % (side + 1)) / (float)side * 2 - 1, (float)layer * -0.5f,
                   (float)(i / (side + 1)) / (float)side * 2 - 1);
        }
        for (uint32_t i = 0; i < side * side; i++) {
            uint32_t v = first + i / side * (side + 1) + i % side;
            triangle(v, v + side + 1, v + 1);
            triangle(v + 1, v + side + 1, v + side + 2);
        }
    }
}

static void plant(uint32_t mesh, uint32_t from) {
    uint32_t count = w.triangle_count - from, room = masu_trace_tree_nodes(count);
    masu_trace_box *boxes = malloc(count * sizeof *boxes);
    masu_trace_below *all = malloc(room * sizeof *all);
    uint32_t *order = malloc(2 * count * sizeof *order);
    masu_blob_trace_triangle *old = malloc(count * sizeof *old);
    memcpy(old, &w.triangles[from], count * sizeof *old);
    for (uint32_t i = 0; i < count; i++) {
        const float *a = w.vertices[old[i].vertex[0]].position;
        const float *b = w.vertices[old[i].vertex[1]].position;
        const float *c = w.vertices[old[i].vertex[2]].position;
        for (int k = 0; k < 3; k++) {
            boxes[i].low[k] = fminf(a[k], fminf(b[k], c[k]));
            boxes[i].high[k] = fmaxf(a[k], fmaxf(b[k], c[k]));
        }
    }
    masu_blob_trace_node *nodes = &w.nodes[w.node_count];
    masu_trace_shape shape = masu_trace_tree_shape(boxes, count, 2, MASU_TRACE_DEPTH_MAX,
                                                   w.node_count, from, order, order + count, nodes);
    (void)masu_trace_tree_fit(nodes, shape.nodes, w.node_count, from, order, boxes, all);
    for (uint32_t i = 0; i < count; i++) w.triangles[from + i] = old[order[i]];
    w.meshes[mesh].first_triangle = from;
    w.meshes[mesh].triangle_count = count;
    w.meshes[mesh].root = w.node_count;
    w.meshes[mesh].box = all[0].box;
    w.node_count += shape.nodes;
    free(boxes);
    free(all);
    free(order);
    free(old);
}

static void make_meshes(void) {
    for (uint32_t mesh = 0; mesh < MESHES; mesh++) {
        uint32_t from = w.triangle_count;
        if (mesh == ICOSPHERE) add_icosphere(4);
        if (mesh == SOUP) add_soup(1500, 0.2f, 0);
        if (mesh == NEEDLES) add_needles(500);
        if (mesh == FAR) add_soup(500, 0.6f, 1e6f);
        if (mesh == PLANES) add_planes(16);
        if (mesh == CORNER) triangle(vertex(1, 0, 0), vertex(0, 1, 0), vertex(0, 0, 1));
        plant(mesh, from);
    }
    w.device = rtcNewDevice("threads=1");
    for (uint32_t mesh = 0; mesh < MESHES; mesh++) {
        RTCScene s = w.mesh_scenes[mesh] = rtcNewScene(w.device);
        RTCGeometry g = rtcNewGeometry(w.device, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSceneFlags(s, RTC_SCENE_FLAG_ROBUST);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, w.vertices, 0,
                                   sizeof *w.vertices, w.vertex_count);
        rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   &w.triangles[w.meshes[mesh].first_triangle], 0,
                                   sizeof *w.triangles, w.meshes[mesh].triangle_count);
        rtcCommitGeometry(g);
        rtcAttachGeometry(s, g);
        rtcReleaseGeometry(g);
        rtcCommitScene(s);
    }
}

/* ---- Instances ------------------------------------------------------------------------------- */

static void place(uint32_t mesh, const float m[12]) {
    w.mesh_of[w.instance_count] = mesh;
    memcpy(w.transforms[w.instance_count++], m, 12 * sizeof *m);
}

static void move_to(uint32_t mesh, float x, float y, float z) {
    place(mesh, (float[12]){1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z});
}

/* Rotated, stretched, some mirrored; at multiples of an eighth, so that a shift by a million is
 * exact. */
static void throw_in(uint32_t mesh) {
    double q[4], length = 0;
    float m[12];
    for (int k = 0; k < 4; k++) {
        q[k] = (double)number(-1, 1);
        length += q[k] * q[k];
    }
    for (int k = 0; k < 4; k++) q[k] /= sqrt(length);
    double x = q[0], y = q[1], z = q[2], r = q[3];
    const double turn[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - z * r),     2 * (x * z + y * r),
        2 * (x * y + z * r),     1 - 2 * (x * x + z * z), 2 * (y * z - x * r),
        2 * (x * z - y * r),     2 * (y * z + x * r),     1 - 2 * (x * x + y * y)};
    for (int c = 0; c < 3; c++) {
        double scale = exp((double)number(-1.5f, 1.5f)) * (below(3) ? 1 : -1);
        for (int k = 0; k < 3; k++) m[4 * k + c] = (float)(turn[3 * k + c] * scale);
        m[4 * c + 3] = 0.125f * rintf(8 * number(-12, 12));
    }
    place(mesh, m);
}

static void set_world(const double anchor[3]) {
    free(w.fixed);
    free(w.frame);
    free(w.top_memory);
    memcpy(w.anchor, anchor, sizeof w.anchor);
    w.layout = masu_trace_static_layout(w.node_count, w.triangle_count);
    w.fixed = malloc(w.layout.bytes);
    memcpy(w.fixed, w.layout.header, sizeof w.layout.header);
    memcpy(w.fixed + w.layout.nodes, w.nodes, w.node_count * sizeof *w.nodes);
    memcpy(w.fixed + w.layout.triangles, w.triangles, w.triangle_count * sizeof *w.triangles);
    w.frame = calloc(1, masu_trace_frame_bytes(w.instance_count) + 64);
    w.top_memory = aligned_alloc(16, masu_trace_top_bytes(w.instance_count) + 16);
    masu_trace_top_init(&w.top, w.top_memory, w.instance_count);
    for (uint32_t i = 0; i < w.instance_count; i++) {
        masu_trace_root root = {w.meshes[w.mesh_of[i]].box, w.meshes[w.mesh_of[i]].root, i};
        masu_trace_top_set(&w.top, i, &root);
        assert_int_equal(masu_trace_top_place(&w.top, i, w.transforms[i]), 1);
    }
    (void)masu_trace_top_update(&w.top, anchor);
    masu_trace_top_write(&w.top, w.frame);
}

static void set_embree(void) {
    if (w.scene) rtcReleaseScene(w.scene);
    w.scene = rtcNewScene(w.device);
    rtcSetSceneFlags(w.scene, RTC_SCENE_FLAG_ROBUST);
    for (uint32_t i = 0; i < w.instance_count; i++) {
        float columns[12];
        for (uint32_t k = 0; k < 12; k++) columns[k] = w.transforms[i][k % 3 * 4 + k / 3];
        RTCGeometry g = rtcNewGeometry(w.device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(g, w.mesh_scenes[w.mesh_of[i]]);
        rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
        rtcCommitGeometry(g);
        rtcAttachGeometryByID(w.scene, g, i);
        rtcReleaseGeometry(g);
    }
    rtcCommitScene(w.scene);
}

/* ---- Rays ------------------------------------------------------------------------------------ */

static bool on_swiftshader(void) {
    const char *driver = getenv("MASU_TEST_DRIVER");
    return driver && strstr(driver, "swiftshader");
}

static void world_point(uint32_t instance, const float p[3], double out[3]) {
    const float *m = w.transforms[instance];
    for (int k = 0; k < 3; k++) {
        out[k] = (double)m[4 * k] * (double)p[0] + (double)m[4 * k + 1] * (double)p[1] +
                 (double)m[4 * k + 2] * (double)p[2] + (double)m[4 * k + 3];
    }
}

static uint32_t triangle_of(uint32_t instance) {
    uint32_t mesh = w.mesh_of[instance];
    return w.meshes[mesh].first_triangle + below(w.meshes[mesh].triangle_count);
}

/* On a triangle: anywhere, on an edge, at a corner. */
static void point_on(uint32_t instance, uint32_t of, uint32_t where, double out[3]) {
    double p[3][3], u = (double)number(0, 1), v = (double)number(0, 1);
    for (int c = 0; c < 3; c++)
        world_point(instance, w.vertices[w.triangles[of].vertex[c]].position, p[c]);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    if (where > 0) v = 0;
    if (where > 1) u = 0;
    for (int k = 0; k < 3; k++)
        out[k] = p[0][k] + u * (p[1][k] - p[0][k]) + v * (p[2][k] - p[0][k]);
}

static float nudged(double x) {
    uint32_t how = below(3);
    return how == 0 ? (float)x : nextafterf((float)x, how == 1 ? INFINITY : -INFINITY);
}

static void aim(ray *r, const double at[3], int nudge) {
    for (int k = 0; k < 3; k++) {
        float target = nudge ? nudged(at[k]) : (float)at[k];
        r->direction[k] = target - r->origin[k];
    }
}

static void make_ray(ray *r, uint32_t i) {
    uint32_t instance = below(w.instance_count), of = triangle_of(instance), kind = i % 10;
    double at[3], other[3];
    *r = (ray){.t_max = 1e30f};
    point_on(instance, of, 0, at);
    for (int k = 0; k < 3; k++) r->origin[k] = (float)at[k] + number(-20, 20);
    if (kind < 3) { /* from anywhere to any object */
        aim(r, at, 0);
    } else if (kind < 5) { /* at corners and edges, and next to them by one unit in the last
                              digit */
        point_on(instance, of, kind - 2, at);
        aim(r, at, 1);
    } else if (kind == 5) { /* along an axis; the zeros have either sign */
        uint32_t axis = below(3);
        point_on(instance, of, below(3), at);
        for (uint32_t k = 0; k < 3; k++) {
            r->origin[k] = (float)at[k];
            r->direction[k] = below(2) ? 0.0f : -0.0f;
        }
        r->direction[axis] = below(2) ? 1.0f : -1.0f;
        r->origin[axis] -= r->direction[axis] * number(0, 30);
    } else if (kind < 8) { /* from a surface */
        point_on(instance, of, 0, at);
        for (int k = 0; k < 3; k++) {
            r->origin[k] = (float)at[k];
            r->direction[k] = number(-1, 1);
        }
        r->t_min = 1e-4f * (1 + fabsf(r->origin[0]));
    } else if (kind == 8) { /* grazing */
        point_on(instance, of, 1, at);
        point_on(instance, of, 0, other);
        for (int k = 0; k < 3; k++) r->origin[k] = (float)(at[k] + 5 * (at[k] - other[k]));
        aim(r, other, 1);
    } else { /* short ones */
        aim(r, at, 0);
        r->t_max = number(0.5f, 1.5f);
    }
    /* The shader's limits are not tested here. */
    float most =
        fmaxf(fabsf(r->direction[0]), fmaxf(fabsf(r->direction[1]), fabsf(r->direction[2])));
    if (!(most > 1e-5f)) r->direction[0] = 1;
}

static void trace(const uint32_t *code, size_t bytes, const ray *rays, hit *hits, uint32_t count,
                  uint32_t flag) {
    const uint32_t push[4] = {count, flag, 0, 0};
    compute_buffer buffers[5] = {{0, w.fixed, (size_t)w.layout.bytes},
                                 {1, w.frame, (size_t)masu_trace_frame_bytes(w.instance_count)},
                                 {2, w.vertices, w.vertex_count * sizeof *w.vertices},
                                 {3, (void *)(uintptr_t)rays, count * sizeof *rays},
                                 {4, hits, count * sizeof *hits}};
    memset(hits, 0xEE, count * sizeof *hits);
    compute_run(code, bytes, buffers, 5, push, (count + 63) / 64);
}

#define TRACE(code, rays, hits, count, flag) trace(code, sizeof code, rays, hits, count, flag)

static float embree(const ray *in) {
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    struct RTCRayHit r = {.ray = {.org_x = in->origin[0],
                                  .org_y = in->origin[1],
                                  .org_z = in->origin[2],
                                  .tnear = in->t_min,
                                  .dir_x = in->direction[0],
                                  .dir_y = in->direction[1],
                                  .dir_z = in->direction[2],
                                  .tfar = in->t_max,
                                  .mask = 0xFFFFFFFFu},
                          .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
    rtcIntersect1(w.scene, &context, &r);
    return r.hit.geomID == RTC_INVALID_GEOMETRY_ID ? -1.0f : r.ray.tfar;
}

/* ---- Double precision ------------------------------------------------------------------------ */

typedef struct verdict {
    double nearest_sure; /* t of the nearest shrunk triangle that is hit */
    bool found;          /* an enlarged triangle is hit at the t in question */
} verdict;

static void judge_triangle(const ray *r, uint32_t instance, uint32_t of, float t, verdict *v) {
    double d[3], p[3][3], n[3], e[3][3], size = 0, length = 0;
    for (int k = 0; k < 3; k++) d[k] = (double)r->direction[k];
    for (int c = 0; c < 3; c++) {
        const float *object = w.vertices[w.triangles[of].vertex[c]].position;
        world_point(instance, object, p[c]);
        for (int k = 0; k < 3; k++) {
            /* The uncertainty of products of a matrix grows with its entries. */
            double most = 0;
            for (int j = 0; j < 3; j++)
                most += fabs((double)w.transforms[instance][4 * k + j] * (double)object[j]);
            p[c][k] -= (double)r->origin[k];
            size = fmax(size, fmax(fabs(p[c][k]), fmax(most, fabs((double)r->origin[k]))));
        }
    }
    length = sqrt(dot3(d, d));
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) e[c][k] = p[(c + 1) % 3][k] - p[c][k];
    cross3(e[0], e[1], n);
    double slope = dot3(n, d), area = sqrt(dot3(n, n));
    if (!(area > 0)) return;
    double margin = MARGIN * size, cosine = fabs(slope) / (area * length);
    double at = dot3(n, p[0]) / slope, inside = (double)INFINITY;
    for (int c = 0; c < 3; c++) { /* distance of the ray's line from the edge's, inwards */
        double across[3];
        cross3(e[c], d, across);
        double s = -dot3(across, p[c]) / (sqrt(dot3(across, across)) + 1e-300);
        inside = fmin(inside, slope > 0 ? -s : s);
    }
    /* t is a mean of the corners' values, with weights whose error is that of an edge function over
     * the area. */
    double off = 0, first = (double)INFINITY, last = -(double)INFINITY;
    for (int c = 0; c < 3; c++) {
        double across[3], along = dot3(p[c], d) / (length * length);
        cross3(p[c], d, across);
        off = fmax(off, dot3(across, across) / (length * length));
        first = fmin(first, along);
        last = fmax(last, along);
    }
    double noise = fmin(1, 0x1p-20 * off * length / fabs(slope));
    if (cosine < 1e-9) { /* edge-on: undecidable, but the ray must be near the triangle */
        if (fabs(inside) <= margin && (double)t >= first - 1e-4 && (double)t <= last + 1e-4)
            v->found = true;
        return;
    }
    double loose = margin / (cosine * length) + 1e-4 * fabs(at) + noise * (last - first);
    if (inside > -margin && at > (double)r->t_min - loose && at < (double)r->t_max + loose &&
        fabs(at - (double)t) <= loose) {
        v->found = true;
    }
    if (inside > margin && at > (double)r->t_min + loose && at < (double)r->t_max - loose)
        v->nearest_sure = fmin(v->nearest_sure, at + loose);
}

/* Whether a ray's line passes near an instance: distant instances need no test of triangles. */
static bool comes_near(const ray *r, uint32_t instance) {
    const masu_trace_box *b = &w.meshes[w.mesh_of[instance]].box;
    double middle[3], corner[3], d[3], across[3], radius = 0;
    float p[3];
    for (int k = 0; k < 3; k++) p[k] = 0.5f * (b->low[k] + b->high[k]);
    world_point(instance, p, middle);
    for (int c = 0; c < 8; c++) {
        for (int k = 0; k < 3; k++) p[k] = c >> k & 1 ? b->high[k] : b->low[k];
        world_point(instance, p, corner);
        for (int k = 0; k < 3; k++) corner[k] -= middle[k];
        radius = fmax(radius, dot3(corner, corner));
    }
    for (int k = 0; k < 3; k++) {
        d[k] = (double)r->direction[k];
        middle[k] -= (double)r->origin[k];
    }
    cross3(middle, d, across);
    return dot3(across, across) <= 1.1 * radius * dot3(d, d);
}

/* Whether an answer is accepted, by the rule above. */
static bool stands(const ray *r, float t) {
    verdict v = {(double)INFINITY, false};
    for (uint32_t i = 0; i < w.instance_count; i++) {
        if (!comes_near(r, i)) continue;
        uint32_t first = w.meshes[w.mesh_of[i]].first_triangle;
        uint32_t count = w.meshes[w.mesh_of[i]].triangle_count;
        for (uint32_t k = first; k < first + count; k++) judge_triangle(r, i, k, t, &v);
    }
    if (!(t >= 0)) return isinf(v.nearest_sure) != 0;
    return v.found && (double)t <= v.nearest_sure;
}

static bool differ(float a, float b) {
    return (a >= 0) != (b >= 0) || (a >= 0 && !(fabsf(a - b) <= 1e-4f * fmaxf(a, b)));
}

/* ---- Tests ----------------------------------------------------------------------------------- */

static const double origin[3] = {0, 0, 0};

static void many_things(void) {
    w.instance_count = 0;
    move_to(ICOSPHERE, 0, 0, 0);
    move_to(SOUP, 3, 0, 0);
    move_to(NEEDLES, 0, 3, 0);
    move_to(PLANES, 0, -3, 0);
    for (int i = 0; i < 60; i++) throw_in((uint32_t)i % 3 == 2 ? PLANES : (uint32_t)i % 3);
}

static void rays_hit_what_embree_hits(void **state) {
    (void)state;
    uint32_t count = trials(200000, 60000, 20000);
    uint32_t met = 0, differing = 0, wrong = 0, checked = 0, unlike = 0, missed = 0;
    uint32_t by_kind[10] = {0};
    ray *rays = malloc(count * sizeof *rays);
    hit *hits = malloc(count * sizeof *hits), *others = malloc(count * sizeof *others);
    many_things();
    set_world(origin);
    set_embree();
    for (uint32_t i = 0; i < count; i++) make_ray(&rays[i], i);
    TRACE(masu_spv_trace_rays_counted_comp, rays, hits, count, 0);
    for (uint32_t i = 0; i < count; i++) {
        float t = embree(&rays[i]);
        assert_true(hits[i].nodes < MASU_TRACE_VISITS);
        met += hits[i].t >= 0;
        if (!differ(t, hits[i].t) && i % 997) continue;
        if (differ(t, hits[i].t)) {
            differing++;
            missed += (t >= 0) != (hits[i].t >= 0);
            by_kind[i % 10]++;
        }
        checked++;
        if (stands(&rays[i], hits[i].t)) continue;
        if (!wrong++) {
            print_message("ray %u from %a %a %a along %a %a %a: t %g, Embree %g\n", i,
                          (double)rays[i].origin[0], (double)rays[i].origin[1],
                          (double)rays[i].origin[2], (double)rays[i].direction[0],
                          (double)rays[i].direction[1], (double)rays[i].direction[2],
                          (double)hits[i].t, (double)t);
        }
    }
    print_message(
        "%u rays, %u hit; %u unlike Embree (%u hit or miss); %u in double: %u wrong\n", count,
        met, differing, missed, checked, wrong);
    print_message(
        "unlike by kind: anything %u, corners and edges %u, axes %u, from surfaces %u, grazing "
        "%u, short %u\n",
        by_kind[0] + by_kind[1] + by_kind[2], by_kind[3] + by_kind[4], by_kind[5],
        by_kind[6] + by_kind[7], by_kind[8], by_kind[9]);
    assert_true(met > count / 2);
    assert_int_equal(wrong, 0);
    assert_true(by_kind[0] + by_kind[1] + by_kind[2] <= count / 1000);

    /* An any-hit query hits exactly if the nearest-hit query does. */
    TRACE(masu_spv_trace_rays_comp, rays, others, count, 1);
    for (uint32_t i = 0; i < count; i++) unlike += (others[i].t >= 0) != (hits[i].t >= 0);
    assert_int_equal(unlike, 0);

    /* A million metres out, with the anchor there: bit-identical. */
    const double far_anchor[3] = {1e6, -1e6, 524288};
    for (uint32_t i = 0; i < w.instance_count; i++)
        for (int k = 0; k < 3; k++) w.transforms[i][4 * k + 3] += (float)far_anchor[k];
    set_world(far_anchor);
    TRACE(masu_spv_trace_rays_counted_comp, rays, others, count, 0);
    for (uint32_t i = 0; i < count; i++)
        unlike += memcmp(&hits[i].t, &others[i].t, sizeof hits[i].t) != 0;
    assert_int_equal(unlike, 0);
    free(rays);
    free(hits);
    free(others);
}

/* Vertices a million out, with a rounding of 6 cm. */
static void coordinates_may_be_large(void **state) {
    (void)state;
    uint32_t count = on_swiftshader() ? 2000 : 20000, wrong = 0, met = 0, differing = 0;
    ray *rays = malloc(count * sizeof *rays);
    hit *hits = malloc(count * sizeof *hits);
    w.instance_count = 0;
    move_to(FAR, 0, 0, 0);
    move_to(FAR, 8, 0, 0);
    set_world(origin);
    set_embree();
    for (uint32_t i = 0; i < count; i++) make_ray(&rays[i], i);
    TRACE(masu_spv_trace_rays_comp, rays, hits, count, 0);
    for (uint32_t i = 0; i < count; i++) {
        met += hits[i].t >= 0;
        if (!differ(embree(&rays[i]), hits[i].t)) continue;
        differing++;
        wrong += !stands(&rays[i], hits[i].t);
    }
    print_message("%u rays, %u hit; %u unlike Embree, %u wrong\n", count, met, differing, wrong);
    assert_true(met > count / 10);
    assert_int_equal(wrong, 0);
    free(rays);
    free(hits);
}

/* Through corners and edges too, and next to them by the smallest float step; under a transform as
 * well. */
static void no_ray_leaves_a_closed_mesh(void **state) {
    (void)state;
    uint32_t count = on_swiftshader() ? 20000 : 100000, leaks = 0;
    ray *rays = malloc(count * sizeof *rays);
    hit *hits = malloc(count * sizeof *hits);
    for (int turned = 0; turned < 2; turned++) {
        w.instance_count = 0;
        if (turned) {
            place(ICOSPHERE, (float[12]){0.3f, -2, 0.5f, 1000, 1, 0.25f, -0.125f, -2000, 0.1f, 0.2f,
                                         1.5f, 512});
        } else {
            move_to(ICOSPHERE, 0, 0, 0);
        }
        set_world(origin);
        for (uint32_t i = 0; i < count; i++) {
            double at[3], from[3];
            float inside[3] = {number(-0.5f, 0.5f), number(-0.5f, 0.5f), number(-0.5f, 0.5f)};
            rays[i] = (ray){.t_max = 1e30f};
            world_point(0, inside, from);
            point_on(0, triangle_of(0), i % 3, at);
            for (int k = 0; k < 3; k++) rays[i].origin[k] = (float)from[k];
            aim(&rays[i], at, 1);
            if (i % 7 == 0 && !turned) { /* along an axis through the centre: through a corner */
                memset(rays[i].origin, 0, sizeof rays[i].origin);
                for (uint32_t k = 0; k < 3; k++)
                    rays[i].direction[k] = k == i % 3 ? (i & 8 ? 1.0f : -1.0f) : -0.0f;
            }
        }
        TRACE(masu_spv_trace_rays_comp, rays, hits, count, 0);
        for (uint32_t i = 0; i < count; i++) leaks += !(hits[i].t >= 0);
    }
    print_message("%u of %u rays leave\n", leaks, 2 * count);
    assert_int_equal(leaks, 0);
    free(rays);
    free(hits);
}

static void what_is_no_ray_hits_nothing(void **state) {
    (void)state;
    static const float odd[] = {NAN,    INFINITY, -INFINITY, 0.0f,  -0.0f,
                                1e-40f, 3e38f,    -3e38f,    1e-30f};
    ray rays[9 * 8 + 3];
    hit hits[9 * 8 + 3];
    many_things();
    set_world(origin);
    for (int i = 0; i < 72; i++) {
        rays[i] = (ray){.origin = {0, 0, -20}, .direction = {0, 0, 1}, .t_max = 1e30f};
        ((float *)(void *)&rays[i])[i % 8] = odd[i / 8];
    }
    rays[72] = (ray){.origin = {0, 0, -20}, .t_max = 1e30f};
    rays[73] = (ray){.origin = {0, 0, -20}, .direction = {0, 0, 1}, .t_min = 3, .t_max = 2};
    rays[74] = (ray){.origin = {0, 0, -20}, .direction = {0, 0, 1}, .t_max = 1e30f};
    TRACE(masu_spv_trace_rays_counted_comp, rays, hits, 75, 0);
    for (int i = 0; i < 75; i++) {
        int which = i % 8;
        float value = i < 72 ? odd[i / 8] : 0;
        bool finite = isfinite(value);
        assert_true(hits[i].nodes <= MASU_TRACE_VISITS);
        if (i < 72 && (!finite || fabsf(value) > 1e30f) && which != 3 && which != 7) {
            assert_int_equal(hits[i].nodes, 0);
            assert_true(hits[i].t == -1.0f);
        }
    }
    assert_true(hits[72].t == -1.0f && hits[72].nodes == 0);
    assert_true(hits[73].t == -1.0f);
    assert_true(hits[74].t >= 0 && hits[74].nodes > 0);
    w.instance_count = 0;
    set_world(origin);
    TRACE(masu_spv_trace_rays_counted_comp, rays, hits, 75, 0);
    for (int i = 0; i < 75; i++) assert_true(hits[i].t == -1.0f && hits[i].nodes == 0);
}

/* Thousands of objects at one position, whose boxes a ray hits, but not their triangles. */
static void a_ray_that_sees_too_much_is_given_up(void **state) {
    (void)state;
    ray rays[2] = {{{0.9f, 0.9f, -5}, 0, {0, 0, 1}, 1e30f}, {{5, 5, -5}, 0, {0, 0, 1}, 1e30f}};
    hit hits[2];
    w.instance_count = 0;
    for (uint32_t i = 0; i < INSTANCES_MAX; i++) move_to(CORNER, 0, 0, 0);
    set_world(origin);
    TRACE(masu_spv_trace_rays_counted_comp, rays, hits, 2, 0);
    assert_int_equal(hits[0].nodes, UINT32_MAX);
    assert_true(hits[0].t == -1.0f);
    assert_int_equal(hits[1].nodes, 1);
    assert_true(hits[1].t == -1.0f);
}

static void a_hook_lets_rays_pass(void **state) {
    (void)state;
    enum { COUNT = 4096 };
    static ray rays[COUNT];
    static hit hits[COUNT], plain[COUNT];
    uint32_t passed = 0, stopped = 0;
    w.instance_count = 0;
    move_to(PLANES, 0, 0, 0);
    set_world(origin);
    for (uint32_t i = 0; i < COUNT; i++) {
        rays[i] = (ray){.origin = {number(-0.9f, 0.9f), 2, number(-0.9f, 0.9f)},
                        .direction = {0, i % 2 ? -1 : -0.5f, 0},
                        .t_max = 1e30f};
    }
    TRACE(masu_spv_trace_rays_comp, rays, plain, COUNT, 0);
    TRACE(masu_spv_trace_mask_comp, rays, hits, COUNT, 0xFFFFFFFFu);
    for (uint32_t i = 0; i < COUNT; i++) {
        float above = i % 2 ? 2.0f : 4.0f, under = i % 2 ? 2.5f : 5.0f;
        assert_true(fabsf(plain[i].t - above) < 1e-4f);
        assert_int_equal(plain[i].instance, 0);
        bool through = plain[i].weights[0] < 0.5f;
        passed += through;
        stopped += !through;
        if (!through) {
            assert_true(hits[i].t == plain[i].t);
            assert_int_equal(hits[i].triangle, plain[i].triangle);
        } else if (hits[i].t >= 0) {
            assert_true(fabsf(hits[i].t - under) < 1e-4f && hits[i].weights[0] >= 0.5f);
        }
        assert_int_equal(hits[i].nodes, hits[i].t >= 0);
    }
    assert_true(passed > 100 && stopped > 100);
}

/* The position of a hit: weights and triangle give the same point as t. */
static void weights_and_distance_say_the_same(void **state) {
    (void)state;
    uint32_t count = 5000, met = 0;
    ray *rays = malloc(count * sizeof *rays);
    hit *hits = malloc(count * sizeof *hits);
    w.instance_count = 0;
    for (int i = 0; i < 30; i++) throw_in(i % 2 ? SOUP : ICOSPHERE);
    set_world(origin);
    for (uint32_t i = 0; i < count; i++) make_ray(&rays[i], 10 * i); /* rays from anywhere */
    TRACE(masu_spv_trace_rays_comp, rays, hits, count, 0);
    for (uint32_t i = 0; i < count; i++) {
        if (!(hits[i].t >= 0)) continue;
        double p[3][3], u = (double)hits[i].weights[0], v = (double)hits[i].weights[1];
        masu_trace_record r;
        memcpy(&r,
               w.frame + 16 * (uint64_t)((uint32_t *)(void *)w.frame)[0] +
                   hits[i].record * sizeof r,
               sizeof r);
        assert_int_equal(r.traced, hits[i].instance);
        for (int c = 0; c < 3; c++)
            world_point(hits[i].instance,
                        w.vertices[w.triangles[hits[i].triangle].vertex[c]].position, p[c]);
        for (int k = 0; k < 3; k++) {
            double by_weights = p[0][k] + u * (p[1][k] - p[0][k]) + v * (p[2][k] - p[0][k]);
            double by_t =
                (double)rays[i].origin[k] + (double)hits[i].t * (double)rays[i].direction[k];
            assert_true(fabs(by_weights - by_t) < 2e-3);
        }
        met++;
    }
    assert_true(met > count / 2);
    free(rays);
    free(hits);
}

static int prepare(void **state) {
    (void)state;
    make_meshes();
    return 0;
}

static int tidy(void **state) {
    (void)state;
    if (w.scene) rtcReleaseScene(w.scene);
    for (uint32_t i = 0; i < MESHES; i++) rtcReleaseScene(w.mesh_scenes[i]);
    rtcReleaseDevice(w.device);
    free(w.fixed);
    free(w.frame);
    free(w.top_memory);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_hit_what_embree_hits),
        cmocka_unit_test(coordinates_may_be_large),
        cmocka_unit_test(no_ray_leaves_a_closed_mesh),
        cmocka_unit_test(what_is_no_ray_hits_nothing),
        cmocka_unit_test(a_ray_that_sees_too_much_is_given_up),
        cmocka_unit_test(a_hook_lets_rays_pass),
        cmocka_unit_test(weights_and_distance_say_the_same),
    };
    return cmocka_run_group_tests(tests, prepare, tidy);
}

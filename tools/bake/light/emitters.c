/* emitters.c: see emitters.h. A part is a set of connected triangles of one emissive material,
 * joined at equal positions. Its box along the principal axes of its surface, in world space,
 * decides its shape:
 *
 *   rectangle  flat; covers a sheet, or is at the centre of a flat body that emits to both sides
 *   sphere     the shortest side is over 0.6 of the longest
 *   capsule    the two shorter sides have similar lengths
 *
 * The light contains the whole part, so that a ray hit can be recognised as part of it. Its
 * radiance keeps the part's flux. A part that covers less than 0.4 of its light, such as a ring,
 * has no suitable shape. */
#include "bake/light/emitters.h"
#include "bake/scene/piece.h"
#include "cli/cli.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* AUTO: radiance, and radiant intensity / pi towards where the part looks largest. */
#define RADIANCE_LEAST 1.0
#define INTENSITY_LEAST 1e-3
#define COVER_LEAST 0.4
#define EDGES_TRIED 200u

typedef struct part {
    masu_bake_vec3 center, normal; /* means by area; of the normals, below 1 long */
    masu_bake_vec3 axis[3];        /* longest half side first */
    double half[3];
    double area;
} part;

typedef struct corners {
    masu_bake_vec3 *at; /* three a triangle, world space */
    uint32_t *part;     /* of each corner */
    size_t count;
} corners;

/* ---- Parts ----------------------------------------------------------------------------------- */

/* of qsort's comparison: this program has one thread here */
static const masu_bake_vec3 *sorted_at;

static int by_position(const void *a, const void *b) {
    return memcmp(&sorted_at[*(const uint32_t *)a], &sorted_at[*(const uint32_t *)b],
                  sizeof *sorted_at);
}

static uint32_t root_of(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

static void join_parts(corners *c) {
    uint32_t *order = malloc((c->count + 1) * sizeof *order);
    if (!order) abort();
    for (uint32_t i = 0; i < c->count; i++) {
        order[i] = i;
        c->part[i] = i - i % 3;
    }
    sorted_at = c->at;
    qsort(order, c->count, sizeof *order, by_position);
    for (size_t i = 1; i < c->count; i++) {
        if (memcmp(&c->at[order[i - 1]], &c->at[order[i]], sizeof *c->at)) continue;
        uint32_t a = root_of(c->part, order[i - 1]), b = root_of(c->part, order[i]);
        c->part[a < b ? b : a] = a < b ? a : b;
    }
    for (uint32_t i = 0; i < c->count; i++) c->part[i] = root_of(c->part, i);
    free(order);
}

/* ---- Its box --------------------------------------------------------------------------------- */

static masu_bake_vec3 along(const masu_bake_vec3 axis[2], double angle) {
    masu_bake_vec3 zero = {0, 0, 0};
    return masu_bake_mad(masu_bake_mad(zero, axis[0], cos(angle)), axis[1], sin(angle));
}

/* Half the extent of the part along an axis; its centre, relative to the part's centre. */
static double half_along(const corners *c, uint32_t part, masu_bake_vec3 center,
                         masu_bake_vec3 axis, double *middle) {
    double low = DBL_MAX, high = -DBL_MAX;
    for (size_t i = 0; i < c->count; i++) {
        if (c->part[i] != part) continue;
        double x = masu_bake_dot(masu_bake_sub(c->at[i], center), axis);
        low = fmin(low, x);
        high = fmax(high, x);
    }
    *middle = 0.5 * (low + high);
    return 0.5 * (high - low);
}

/* Eigenvectors of a symmetric matrix by Jacobi's rotations. */
static void principal_axes(double m[3][3], masu_bake_vec3 axis[3]) {
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int n = 0; n < 60; n++) {
        int p = n % 3, q = (p + 1) % 3;
        if (fabs(m[p][q]) < 1e-300) continue;
        double sign = m[q][q] < m[p][p] ? -1 : 1; /* at most 45 degrees: else it may never end */
        double angle = 0.5 * atan2(sign * 2 * m[p][q], sign * (m[q][q] - m[p][p]));
        double c = cos(angle), s = sin(angle);
        for (int k = 0; k < 3; k++) {
            double a = m[k][p], b = m[k][q];
            m[k][p] = c * a - s * b;
            m[k][q] = s * a + c * b;
        }
        for (int k = 0; k < 3; k++) {
            double a = m[p][k], b = m[q][k], d = v[k][p], e = v[k][q];
            m[p][k] = c * a - s * b;
            m[q][k] = s * a + c * b;
            v[k][p] = c * d - s * e;
            v[k][q] = s * d + c * e;
        }
    }
    for (int k = 0; k < 3; k++) axis[k] = masu_bake_v3(v[0][k], v[1][k], v[2][k]);
}

typedef struct box {
    masu_bake_vec3 axis[2];
    double size;
} box;

static void try_axes(const corners *c, uint32_t n, masu_bake_vec3 center,
                     const masu_bake_vec3 axis[2], box *best) {
    double unused;
    double size =
        half_along(c, n, center, axis[0], &unused) * half_along(c, n, center, axis[1], &unused);
    if (!(size < best->size * (1 - 1e-6))) return;
    *best = (box){{axis[0], axis[1]}, size};
}

/* Turns the other two axes about axis k to where the box is smallest. A side of that box is along
 * an edge of the part, of which many are not all tried. */
static void tighten(const corners *c, uint32_t n, part *p, int k) {
    masu_bake_vec3 *first = &p->axis[(k + 1) % 3], *second = &p->axis[(k + 2) % 3];
    const masu_bake_vec3 flat[2] = {*first, *second};
    box best = {.size = DBL_MAX};
    size_t tried = 0;
    try_axes(c, n, p->center, flat, &best);
    for (size_t i = 0; i < c->count && tried < EDGES_TRIED; i++) {
        if (c->part[i] != n) continue;
        masu_bake_vec3 edge = masu_bake_sub(c->at[i % 3 == 2 ? i - 2 : i + 1], c->at[i]);
        double x = masu_bake_dot(edge, flat[0]), y = masu_bake_dot(edge, flat[1]);
        if (!(x * x + y * y > 1e-6 * masu_bake_dot(edge, edge))) continue;
        double angle = atan2(y, x);
        masu_bake_vec3 axis[2] = {along(flat, angle), along(flat, angle + MASU_BAKE_PI / 2)};
        try_axes(c, n, p->center, axis, &best);
        tried++;
    }
    for (int i = 0; i < 45 && tried == EDGES_TRIED; i++) {
        double angle = MASU_BAKE_PI / 90 * i;
        masu_bake_vec3 axis[2] = {along(flat, angle), along(flat, angle + MASU_BAKE_PI / 2)};
        try_axes(c, n, p->center, axis, &best);
    }
    *first = best.axis[0];
    *second = best.axis[1];
}

static void measure(const corners *c, uint32_t n, part *p) {
    masu_bake_vec3 zero = {0, 0, 0};
    double m[3][3] = {{0}}, middle[3];
    *p = (part){.center = zero, .normal = zero};
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < c->count; i += 3) {
            if (c->part[i] != n) continue;
            masu_bake_vec3 a = c->at[i], b = c->at[i + 1], d = c->at[i + 2];
            masu_bake_vec3 cross = masu_bake_cross(masu_bake_sub(b, a), masu_bake_sub(d, a));
            double area = 0.5 * masu_bake_length(cross);
            masu_bake_vec3 corner[3] = {a, b, d};
            for (int k = 0; k < 3; k++) {
                if (!pass) {
                    p->center = masu_bake_mad(p->center, corner[k], area / 3);
                    continue;
                }
                masu_bake_vec3 r = masu_bake_sub(corner[k], p->center);
                double x[3] = {r.x, r.y, r.z};
                for (int j = 0; j < 9; j++) m[j / 3][j % 3] += area * x[j / 3] * x[j % 3];
            }
            if (pass) continue;
            p->area += area;
            p->normal = masu_bake_mad(p->normal, cross, 0.5);
        }
        if (!pass && p->area > 0) {
            p->center = masu_bake_mad(zero, p->center, 1 / p->area);
            p->normal = masu_bake_mad(zero, p->normal, 1 / p->area);
        }
    }
    principal_axes(m, p->axis);
    /* The principal axes of a square or a cube are arbitrary, and those of a box turn with the
     * diagonals of its triangles. */
    for (int k = 2; k >= 0; k--) tighten(c, n, p, k);
    for (int k = 0; k < 3; k++) p->half[k] = half_along(c, n, p->center, p->axis[k], &middle[k]);
    for (int k = 0; k < 3; k++) p->center = masu_bake_mad(p->center, p->axis[k], middle[k]);
    for (int k = 0; k < 2; k++) {
        if (p->half[0] >= p->half[k + 1]) continue;
        double size = p->half[0];
        masu_bake_vec3 axis = p->axis[0];
        p->half[0] = p->half[k + 1], p->axis[0] = p->axis[k + 1];
        p->half[k + 1] = size, p->axis[k + 1] = axis;
    }
    if (p->half[1] < p->half[2]) {
        double size = p->half[1];
        masu_bake_vec3 axis = p->axis[1];
        p->half[1] = p->half[2], p->axis[1] = p->axis[2];
        p->half[2] = size, p->axis[2] = axis;
    }
}

/* ---- Shapes ---------------------------------------------------------------------------------- */

/* The farthest corner from the segment centre +- ends. */
static double radius_about(const corners *c, uint32_t n, masu_bake_vec3 center, masu_bake_vec3 axis,
                           double ends) {
    double most = 0;
    for (size_t i = 0; i < c->count; i++) {
        if (c->part[i] != n) continue;
        masu_bake_vec3 r = masu_bake_sub(c->at[i], center);
        double x = fmin(fmax(masu_bake_dot(r, axis), -ends), ends);
        most = fmax(most, masu_bake_length(masu_bake_mad(r, axis, -x)));
    }
    return most;
}

/* The light in world space, with the part's flux; *cover: the part's area by the light's. */
static masu_blob_light shape_of(const corners *c, uint32_t n, const part *p, bool single,
                                const float color[3], double *cover) {
    masu_blob_light light = {.radius = 1e-6f, .parent = MASU_BLOB_NONE, .name = MASU_BLOB_NONE};
    masu_bake_vec3 zero = {0, 0, 0}, u = zero, v = zero;
    double shines = p->area, area; /* emitting areas of the part and of the light */
    bool sheet = masu_bake_length(p->normal) > 0.9;
    if (p->half[2] < 0.5 * p->half[1]) {
        u = masu_bake_mad(zero, p->axis[0], p->half[0]);
        v = masu_bake_mad(zero, p->axis[1], p->half[1]);
        if (masu_bake_dot(masu_bake_cross(u, v), p->normal) < 0) v = masu_bake_mad(zero, v, -1);
        light.type = MASU_LIGHT_RECTANGLE;
        area = 4 * p->half[0] * p->half[1];
        if (!sheet || !single) light.type |= MASU_LIGHT_TWO_SIDED, area *= 2;
        if (sheet && !single) shines *= 2;
        light.radius = (float)fmax(p->half[2], 1e-6);
    } else if (p->half[2] > 0.6 * p->half[0]) {
        double r = radius_about(c, n, p->center, p->axis[0], 0);
        light.type = MASU_LIGHT_SPHERE;
        light.radius = (float)r;
        area = 4 * MASU_BAKE_PI * r * r;
    } else {
        double r = radius_about(c, n, p->center, p->axis[0], 2 * p->half[0]);
        double ends = fmax(p->half[0] - 0.5 * r, 0.1 * p->half[0]);
        r = radius_about(c, n, p->center, p->axis[0], ends) / 1.04;
        u = masu_bake_mad(zero, p->axis[0], ends);
        light.type = MASU_LIGHT_CAPSULE;
        light.radius = (float)r;
        area = 4 * MASU_BAKE_PI * r * (r + ends);
    }
    *cover = shines / area;
    light.type |= MASU_LIGHT_SURFACE;
    for (int k = 0; k < 3; k++) light.color[k] = (float)((double)color[k] * *cover);
    masu_bake_store(p->center, light.position);
    masu_bake_store(u, light.direction);
    masu_bake_store(v, light.half_axis);
    return light;
}

static double brightest(const float color[3]) {
    return (double)fmaxf(color[0], fmaxf(color[1], color[2]));
}

static void report(const masu_blob_light *light, const char *where) {
    static const char *const names[] = {"sphere", "capsule", "rectangle"};
    uint32_t type = light->type & MASU_LIGHT_TYPE;
    masu_bake_vec3 u = masu_bake_v3f(light->direction), v = masu_bake_v3f(light->half_axis);
    if (masu_cli_quiet()) return;
    printf("%s: emission lights as a %s", where, names[type - MASU_LIGHT_SPHERE]);
    if (type == MASU_LIGHT_RECTANGLE)
        printf(" of %.3g x %.3g m%s", 2 * masu_bake_length(u), 2 * masu_bake_length(v),
               light->type & MASU_LIGHT_TWO_SIDED ? ", both sides" : "");
    else
        printf(" of radius %.3g m", (double)light->radius);
    if (type == MASU_LIGHT_CAPSULE) printf(", %.3g m long", 2 * masu_bake_length(u));
    printf(", radiance %.3g %.3g %.3g\n", (double)light->color[0], (double)light->color[1],
           (double)light->color[2]);
}

/* From world space to the instance's, and into the scene. */
static void add_light(masu_bake_content *content, masu_blob_light light, uint32_t instance) {
    const masu_blob_instance *of = &MASU_BAKE_INSTANCES(content)[instance];
    masu_bake_affine to = masu_bake_transform(of), back;
    masu_bake_vec3 zero = {0, 0, 0}, column[3];
    if (!masu_bake_invert(&to, &back)) return;
    masu_bake_vec3 origin = masu_bake_apply(&back, zero);
    for (int k = 0; k < 3; k++)
        column[k] =
            masu_bake_sub(masu_bake_apply(&back, masu_bake_v3(k == 0, k == 1, k == 2)), origin);
    double size = cbrt(fabs(masu_bake_dot(column[0], masu_bake_cross(column[1], column[2]))));
    light.range = (float)fmin(masu_bake_area_range(&light), 1e9);
    light.radius = (float)fmin(fmax((double)light.radius * size, 1e-6), 1e9);
    masu_bake_store(masu_bake_apply(&back, masu_bake_v3f(light.position)), light.position);
    masu_bake_store(masu_bake_sub(masu_bake_apply(&back, masu_bake_v3f(light.direction)), origin),
                    light.direction);
    masu_bake_store(masu_bake_sub(masu_bake_apply(&back, masu_bake_v3f(light.half_axis)), origin),
                    light.half_axis);
    light.parent = instance;
    light.name = of->name;
    masu_bake_append(&content->section[MASU_BLOB_LIGHTS], &light, sizeof light);
}

static uint64_t fits_so_far(const masu_bake_content *content) {
    uint64_t found = 0;
    for (uint64_t i = 0; i < masu_bake_count(content, MASU_BLOB_LIGHTS); i++)
        found += (MASU_BAKE_LIGHTS(content)[i].type & MASU_LIGHT_SURFACE) != 0;
    return found;
}

static void fit_part(masu_bake_content *content, uint32_t instance, const corners *c, uint32_t n,
                     const masu_blob_material *m, bool single, int wanted, const char *where) {
    part p;
    double cover;
    measure(c, n, &p);
    if (!(p.area > 0) || !(p.half[1] > 1e-6) || !(p.half[0] < 1e6)) return;
    masu_blob_light light = shape_of(c, n, &p, single, m->emissive, &cover);
    double intensity = brightest(m->emissive) * p.area / (4 * MASU_BAKE_PI);
    if (wanted == MASU_BAKE_AREA_AUTO &&
        (brightest(m->emissive) < RADIANCE_LEAST || intensity < INTENSITY_LEAST))
        return;
    if (cover < COVER_LEAST) {
        if (wanted == MASU_BAKE_AREA_YES)
            masu_cli_warn("%s: an emissive part of %.3g x %.3g x %.3g m fills %.0f %% of the shape "
                          "around it; "
                          "expected at least %.0f %%: it lights nothing",
                          where, 2 * p.half[0], 2 * p.half[1], 2 * p.half[2], 100 * cover,
                          100 * COVER_LEAST);
        return;
    }
    if (fits_so_far(content) >= MASU_BAKE_EMITTERS_MAX) {
        if (wanted == MASU_BAKE_AREA_YES)
            masu_cli_warn("%s: emission lights nothing: the scene has %u such lights already",
                          where, MASU_BAKE_EMITTERS_MAX);
        return;
    }
    report(&light, where);
    add_light(content, light, instance);
}

/* ---- Meshes ---------------------------------------------------------------------------------- */

static void fit_primitive(masu_bake_content *content, uint32_t instance,
                          const masu_blob_primitive *primitive, int wanted, const char *where) {
    masu_blob_material m = MASU_BAKE_MATERIALS(content)[primitive->material];
    masu_bake_maps maps = MASU_BAKE_MAPS_OF(content)[primitive->material];
    masu_bake_affine to = masu_bake_transform(&MASU_BAKE_INSTANCES(content)[instance]);
    if (!(brightest(m.emissive) > 0) || maps.unlit) return;
    bool plain = maps.image[MASU_BAKE_EMISSIVE] == MASU_BLOB_NONE;
    if (!plain || maps.alpha > MASU_BAKE_ALPHA_OPAQUE || maps.additive) {
        if (wanted == MASU_BAKE_AREA_YES)
            masu_cli_warn("%s: emission with %s lights nothing", where,
                          plain ? "transparency" : "a texture");
        return;
    }
    corners c = {.count = primitive->index_count};
    c.at = masu_bake_allocate(c.count * sizeof *c.at);
    c.part = masu_bake_allocate(c.count * sizeof *c.part);
    for (size_t i = 0; i < c.count; i++) {
        uint32_t index = MASU_BAKE_INDICES(content)[primitive->first_index + i];
        const masu_blob_vertex *vertex =
            &MASU_BAKE_VERTICES(content)[primitive->first_vertex + index];
        masu_bake_vec3 at = masu_bake_apply(&to, masu_bake_v3f(vertex->position));
        c.at[i] = masu_bake_v3(at.x + 0.0, at.y + 0.0, at.z + 0.0); /* -0 is 0 */
    }
    join_parts(&c);
    /* A part's number is its first corner. Beyond the most that a scene has, they are no lamps. */
    uint64_t parts = 0;
    for (uint32_t i = 0; i < c.count; i++) parts += c.part[i] == i;
    for (uint32_t i = 0; i < c.count && parts <= MASU_BAKE_EMITTERS_MAX; i++) {
        if (c.part[i] == i) fit_part(content, instance, &c, i, &m, maps.single == 1, wanted, where);
    }
    if (parts > MASU_BAKE_EMITTERS_MAX && wanted == MASU_BAKE_AREA_YES)
        masu_cli_warn("%s: %llu separate emissive parts light nothing; expected at most %u", where,
                      (unsigned long long)parts, MASU_BAKE_EMITTERS_MAX);
    free(c.at);
    free(c.part);
}

void masu_bake_fit_emitters(masu_bake_content *content, uint64_t first, int wanted,
                            const char *where) {
    if (wanted == MASU_BAKE_AREA_NO) return;
    for (uint64_t i = first; i < masu_bake_count(content, MASU_BLOB_INSTANCES); i++) {
        uint32_t number = MASU_BAKE_INSTANCES(content)[i].mesh;
        if (number >= masu_bake_count(content, MASU_BLOB_MESHES)) continue;
        masu_blob_mesh mesh = MASU_BAKE_MESHES(content)[number];
        for (uint32_t k = 0; k < mesh.primitive_count; k++) {
            masu_blob_primitive primitive = MASU_BAKE_PRIMITIVES(content)[mesh.first_primitive + k];
            fit_primitive(content, (uint32_t)i, &primitive, wanted, where);
        }
    }
}

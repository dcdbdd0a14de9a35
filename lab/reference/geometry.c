/* geometry.c: see geometry.h. */
#include "lab/reference/geometry.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct context {
    struct RTCIntersectContext base;
    const ref_world *world;
    unsigned flags;
} context;

static const ref_material *material_of(const ref_world *w, uint32_t triangle) {
    return &w->scene->materials[w->scene->triangles[triangle].material];
}

static const float *texcoords_of(const ref_scene *s, const ref_material *m, int slot) {
    return m->second >> slot & 1u ? s->texcoords_1 : s->texcoords;
}

static void texcoord_at(const float *texcoords, const ref_triangle *t, double u, double v,
                        double out[2]) {
    for (int k = 0; k < 2; k++) {
        double a = (double)texcoords[2 * (size_t)t->vertex[0] + (size_t)k];
        double b = (double)texcoords[2 * (size_t)t->vertex[1] + (size_t)k];
        double c = (double)texcoords[2 * (size_t)t->vertex[2] + (size_t)k];
        out[k] = a + u * (b - a) + v * (c - a);
    }
}

static void map_at(const ref_world *w, uint32_t triangle, int slot, double u, double v,
                   double out[4]) {
    const ref_material *m = material_of(w, triangle);
    double at[2];
    texcoord_at(texcoords_of(w->scene, m, slot), &w->scene->triangles[triangle], u, v, at);
    bool plain = slot == MASU_SLOT_BASE || slot == MASU_SLOT_EMISSIVE;
    ref_texture_at(m->map[slot], at[0] * (plain ? 1 : m->detail[0]),
                   at[1] * (plain ? 1 : m->detail[1]), m->wrap, out);
}

/* Called by Embree for each candidate: rejects surfaces that do not exist for this ray. */
static void filter(const struct RTCFilterFunctionNArguments *a) {
    const context *c = (const context *)a->context;
    if (a->valid[0] != -1) return;
    const struct RTCRay *ray = (const void *)a->ray; /* for one ray these are plain structs */
    const struct RTCHit *hit = (const void *)a->hit;
    uint32_t triangle = hit->primID;
    const ref_material *m = material_of(c->world, triangle);
    bool there = true;
    if (m->flags & MASU_MATERIAL_IS_BLEND && c->flags & REF_RAY_NO_BLENDS) there = false;
    if (m->flags & MASU_MATERIAL_IS_SINGLE && c->flags & REF_RAY_ONE_SIDED) {
        const ref_triangle *t = &c->world->scene->triangles[triangle];
        const ref_vec *p = c->world->scene->positions;
        ref_vec n = ref_cross(ref_sub(p[t->vertex[1]], p[t->vertex[0]]),
                              ref_sub(p[t->vertex[2]], p[t->vertex[0]]));
        ref_vec d = ref_v((double)ray->dir_x, (double)ray->dir_y, (double)ray->dir_z);
        if (ref_dot(n, d) > 0) there = false;
    }
    if (there && m->flags & MASU_MATERIAL_IS_MASK && m->map[MASU_SLOT_BASE]) {
        double texel[4];
        map_at(c->world, triangle, MASU_SLOT_BASE, (double)hit->u, (double)hit->v, texel);
        there = texel[3] >= m->cutoff;
    }
    if (!there) a->valid[0] = 0;
}

bool ref_world_open(const ref_scene *scene, const ref_field *field, ref_vec center, ref_world *w,
                    char *error, size_t size) {
    *w = (ref_world){.scene = scene, .field = field, .center = center};
    if (!scene->triangle_count) return true;
    w->positions = malloc((scene->vertex_count * 3 + 4) * sizeof(float));
    w->device = rtcNewDevice("threads=1");
    if (!w->positions || !w->device) {
        snprintf(error, size, "out of memory for the triangles of the reference");
        ref_world_close(w);
        return false;
    }
    for (uint64_t i = 0; i < scene->vertex_count; i++) {
        ref_vec p = ref_sub(scene->positions[i], center);
        w->positions[3 * i] = (float)p.x;
        w->positions[3 * i + 1] = (float)p.y;
        w->positions[3 * i + 2] = (float)p.z;
    }
    w->embree = rtcNewScene(w->device);
    rtcSetSceneFlags(w->embree, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    RTCGeometry g = rtcNewGeometry(w->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, w->positions, 0,
                               3 * sizeof(float), scene->vertex_count);
    rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene->triangles, 0,
                               sizeof(ref_triangle), scene->triangle_count);
    rtcCommitGeometry(g);
    rtcAttachGeometry(w->embree, g);
    rtcReleaseGeometry(g);
    rtcCommitScene(w->embree);
    if (rtcGetDeviceError(w->device) == RTC_ERROR_NONE) return true;
    snprintf(error, size, "Embree cannot build its tree of %llu triangles",
             (unsigned long long)scene->triangle_count);
    ref_world_close(w);
    return false;
}

void ref_world_close(ref_world *w) {
    if (w->embree) rtcReleaseScene(w->embree);
    if (w->device) rtcReleaseDevice(w->device);
    free(w->positions);
    memset(w, 0, sizeof *w);
}

static context context_of(const ref_world *w, unsigned flags) {
    context c = {.world = w, .flags = flags};
    rtcInitIntersectContext(&c.base);
    if (w->scene->masks || w->scene->blends || flags & REF_RAY_ONE_SIDED) c.base.filter = filter;
    return c;
}

static struct RTCRay ray_of(const ref_world *w, ref_vec from, ref_vec d, double far) {
    ref_vec o = ref_sub(from, w->center);
    return (struct RTCRay){.org_x = (float)o.x,
                           .org_y = (float)o.y,
                           .org_z = (float)o.z,
                           .dir_x = (float)d.x,
                           .dir_y = (float)d.y,
                           .dir_z = (float)d.z,
                           .tfar = far < 1e30 ? (float)far : 1e30f,
                           .mask = UINT32_MAX};
}

/* Recomputes distance and barycentric coordinates in doubles: Embree's are floats. */
static void refine(const ref_scene *s, ref_vec from, ref_vec d, ref_hit *hit) {
    const ref_triangle *t = &s->triangles[hit->triangle];
    ref_vec a = s->positions[t->vertex[0]];
    ref_vec e1 = ref_sub(s->positions[t->vertex[1]], a),
            e2 = ref_sub(s->positions[t->vertex[2]], a);
    ref_vec n = ref_cross(e1, e2), pv = ref_cross(d, e2), tv = ref_sub(from, a),
            qv = ref_cross(tv, e1);
    double det = ref_dot(e1, pv);
    hit->ng = ref_unit(n);
    hit->back = ref_dot(n, d) > 0;
    if (hit->back) hit->ng = ref_scale(hit->ng, -1);
    if (fabs(det) > 1e-300) {
        double far = ref_dot(e2, qv) / det;
        if (fabs(far - hit->t) < 1e-3 * (1 + hit->t)) {
            hit->t = far;
            hit->u = ref_clamp(ref_dot(tv, pv) / det, 0, 1);
            hit->v = ref_clamp(ref_dot(d, qv) / det, 0, 1 - hit->u);
        }
    }
}

bool ref_world_trace(const ref_world *w, ref_vec from, ref_vec d, double far, unsigned flags,
                     ref_hit *hit) {
    bool found = false;
    hit->t = far;
    if (w->embree && !(flags & REF_RAY_NO_TRIANGLES)) {
        context c = context_of(w, flags);
        struct RTCRayHit r = {.ray = ray_of(w, from, d, far)};
        r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(w->embree, &c.base, &r);
        if (r.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
            *hit = (ref_hit){.t = (double)r.ray.tfar,
                             .u = (double)r.hit.u,
                             .v = (double)r.hit.v,
                             .triangle = r.hit.primID};
            refine(w->scene, from, d, hit);
            found = true;
        }
    }
    if (w->field && !(flags & REF_RAY_NO_SDF)) {
        double t = ref_field_trace(w->field, from, d, hit->t);
        if (t < hit->t) {
            ref_vec p = ref_along(from, t, d), n = ref_field_normal(w->field, p);
            *hit = (ref_hit){.t = t, .ng = n, .triangle = REF_SDF};
            found = true;
        }
    }
    if (found) hit->p = ref_along(from, hit->t, d);
    return found;
}

bool ref_world_occluded(const ref_world *w, ref_vec from, ref_vec d, double far, unsigned flags) {
    if (w->embree && !(flags & REF_RAY_NO_TRIANGLES)) {
        context c = context_of(w, flags);
        struct RTCRay r = ray_of(w, from, d, far);
        rtcOccluded1(w->embree, &c.base, &r);
        if (r.tfar < 0) return true;
    }
    return w->field && !(flags & REF_RAY_NO_SDF) && ref_field_trace(w->field, from, d, far) < far;
}

ref_vec ref_world_leave(const ref_world *w, const ref_hit *hit, ref_vec d) {
    double side = ref_dot(hit->ng, d) >= 0 ? 1 : -1;
    if (hit->triangle == REF_SDF && side > 0) return ref_field_leave(w->field, hit->p, hit->ng);
    ref_vec o = ref_sub(hit->p, w->center);
    double most = fmax(fabs(o.x), fmax(fabs(o.y), fabs(o.z)));
    return ref_along(hit->p, side * (4e-6 * (most + hit->t) + 1e-6), hit->ng);
}

/* ---- Materials ------------------------------------------------------------------------------- */

/* The linear colour of vertices, with alpha. */
static void color_at(const ref_world *w, uint32_t triangle, double u, double v, double out[4]) {
    const ref_triangle *t = &w->scene->triangles[triangle];
    for (int k = 0; k < 4; k++) {
        const float *c = w->scene->colors ? w->scene->colors + k : NULL;
        out[k] = c ? (1 - u - v) * (double)c[4 * (size_t)t->vertex[0]] +
                         u * (double)c[4 * (size_t)t->vertex[1]] +
                         v * (double)c[4 * (size_t)t->vertex[2]]
                   : 1;
    }
}

/* It only emits its colour and reflects no light. */
static bool is_unlit(const ref_material *m) {
    return !(ref_dot(m->base, m->base) > 0) && m->roughness >= 1 && !(m->coat > 0);
}

ref_vec ref_world_emission(const ref_world *w, uint32_t triangle, double u, double v) {
    const ref_material *m = material_of(w, triangle);
    double texel[4] = {1, 1, 1, 1}, color[4] = {1, 1, 1, 1};
    if (m->flags & 1u << MASU_SLOT_EMISSIVE) map_at(w, triangle, MASU_SLOT_EMISSIVE, u, v, texel);
    if (is_unlit(m)) color_at(w, triangle, u, v, color);
    return ref_mul(m->emissive,
                   ref_v(texel[0] * color[0], texel[1] * color[1], texel[2] * color[2]));
}

/* n, rotated until it faces v: normals of coarse meshes and maps may point away. least: minimum
 * cosine. */
static ref_vec facing(ref_vec n, ref_vec v, double least) {
    double short_by = least - ref_dot(n, v);
    return short_by > 0 ? ref_unit(ref_along(n, short_by, v)) : n;
}

/* glTF's tangent space: unit gradients of u and v on the plane of n; +y of the map is up,
 * against v. */
static ref_vec from_tangents(const ref_world *w, const ref_hit *hit, ref_vec n, uint32_t slot,
                             double x, double y) {
    const ref_scene *s = w->scene;
    const ref_triangle *t = &s->triangles[hit->triangle];
    double uv[3][2], z = sqrt(fmax(1 - x * x - y * y, 0));
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            uv[i][k] = (double)texcoords_of(s, &s->materials[t->material],
                                            slot)[2 * (size_t)t->vertex[i] + (size_t)k];
    ref_vec a = s->positions[t->vertex[0]];
    ref_vec e1 = ref_sub(s->positions[t->vertex[1]], a),
            e2 = ref_sub(s->positions[t->vertex[2]], a);
    ref_vec p1 = ref_cross(e2, n), p2 = ref_cross(n, e1);
    double side = ref_dot(p1, e1) < 0 ? -1 : 1;
    ref_vec along_u =
        ref_add(ref_scale(p1, uv[1][0] - uv[0][0]), ref_scale(p2, uv[2][0] - uv[0][0]));
    ref_vec along_v =
        ref_add(ref_scale(p1, uv[1][1] - uv[0][1]), ref_scale(p2, uv[2][1] - uv[0][1]));
    double lu = ref_length(along_u), lv = ref_length(along_v);
    ref_vec out = ref_scale(n, z);
    if (lu > 0) out = ref_along(out, side * x / lu, along_u);
    if (lv > 0) out = ref_along(out, -side * y / lv, along_v);
    return ref_unit(out);
}

static ref_vec bent(const ref_world *w, const ref_hit *hit, ref_vec n, uint32_t slot) {
    double texel[4];
    map_at(w, hit->triangle, slot, hit->u, hit->v, texel);
    return from_tangents(w, hit, n, slot, ref_clamp((texel[0] * 255 - 128) / 127, -1, 1),
                         ref_clamp((texel[1] * 255 - 128) / 127, -1, 1));
}

/* Lobes of blob.h other than the basic ones. */
static void look_at_lobes(const ref_world *w, const ref_hit *hit, ref_vec n, const ref_material *m,
                          ref_surface *s) {
    double texel[4] = {1, 1, 1, 1}, opaque = !(m->flags & MASU_MATERIAL_IS_BLEND);
    if (opaque && m->flags & MASU_MATERIAL_LOBE_MAP)
        map_at(w, hit->triangle, MASU_SLOT_COAT, hit->u, hit->v, texel);
    s->sheen_roughness = m->sheen_roughness;
    s->anisotropy = m->anisotropy;
    if (ref_max(m->sheen_color) > 0) {
        s->sheen = ref_mul(m->sheen_color, ref_v(texel[0], texel[1], texel[2]));
        s->sheen_roughness *= texel[3];
    } else {
        ref_vec f0 =
            ref_scale(ref_mul(ref_max(m->specular_color) > 0 ? m->specular_color : ref_splat(1),
                              ref_v(texel[0], texel[1], texel[2])),
                      m->specular * texel[3]);
        s->specular = ref_max(f0);
        s->hue = ref_scale(f0, 1 / fmax(s->specular, 1e-9));
    }
    if (m->anisotropy > 0)
        s->grain = from_tangents(w, hit, n, MASU_SLOT_BASE, cos(m->anisotropy_rotation),
                                 sin(m->anisotropy_rotation));
}

void ref_world_look(const ref_world *w, const ref_hit *hit, ref_vec v, ref_look *out) {
    *out = (ref_look){.cover = 1, .opacity = 1};
    if (hit->triangle == REF_SDF) {
        ref_field_surface(w->field, hit->p, hit->ng, &out->s);
        out->s.normal = out->s.coat_normal = facing(hit->ng, v, 0);
        return;
    }
    const ref_scene *s = w->scene;
    const ref_triangle *t = &s->triangles[hit->triangle];
    const ref_material *m = &s->materials[t->material];
    double texel[4], weights[3] = {1 - hit->u - hit->v, hit->u, hit->v};
    ref_vec n = ref_splat(0);
    for (int i = 0; i < 3; i++) n = ref_along(n, weights[i], s->normals[t->vertex[i]]);
    n = ref_dot(n, n) > 0 ? ref_unit(n) : hit->ng;
    out->flags = m->flags;
    out->opacity = m->opacity;
    out->s = (ref_surface){.albedo = m->base,
                           .emissive = ref_world_emission(w, hit->triangle, hit->u, hit->v),
                           .roughness = m->roughness,
                           .metallic = m->metallic,
                           .specular = m->specular,
                           .coat = m->coat,
                           .coat_roughness = m->coat_roughness,
                           .occlusion = 1};
    if (m->map[MASU_SLOT_BASE]) {
        map_at(w, hit->triangle, MASU_SLOT_BASE, hit->u, hit->v, texel);
        out->s.albedo = ref_mul(m->base, ref_v(texel[0], texel[1], texel[2]));
        if (m->flags & MASU_MATERIAL_IS_BLEND) {
            bool passes = m->flags & MASU_MATERIAL_TRANSMISSION_MAP;
            out->cover = passes ? 1 : texel[3];
            if (passes) out->opacity = 1 - (1 - m->opacity) * texel[3];
        }
    }
    if (s->colors) {
        color_at(w, hit->triangle, hit->u, hit->v, texel);
        out->s.albedo = ref_mul(out->s.albedo, ref_v(texel[0], texel[1], texel[2]));
        if (m->flags & MASU_MATERIAL_IS_BLEND) out->cover *= texel[3];
    }
    if (m->map[MASU_SLOT_SURFACE]) {
        map_at(w, hit->triangle, MASU_SLOT_SURFACE, hit->u, hit->v, texel);
        out->s.roughness *= texel[0];
        if (m->flags & MASU_MATERIAL_HAS_METAL) out->s.metallic *= texel[1];
    }
    if (m->map[MASU_SLOT_OCCLUSION]) {
        map_at(w, hit->triangle, MASU_SLOT_OCCLUSION, hit->u, hit->v, texel);
        out->s.occlusion = texel[0];
    }
    if (m->map[MASU_SLOT_COAT] && !(m->flags & MASU_MATERIAL_LOBE_MAP)) {
        map_at(w, hit->triangle, MASU_SLOT_COAT, hit->u, hit->v, texel);
        out->s.coat *= texel[0];
        out->s.coat_roughness *= texel[1];
    }
    /* The side of the triangle decides, not its vertex order. */
    double turn = ref_dot(n, hit->ng) < 0 ? -1 : 1;
    look_at_lobes(w, hit, n, m, &out->s);
    ref_vec relief = m->map[MASU_SLOT_NORMAL] ? bent(w, hit, n, MASU_SLOT_NORMAL) : n, own = n;
    bool coat_bends = !(m->flags & MASU_MATERIAL_IS_BLEND) && m->flags & MASU_MATERIAL_COAT_RELIEF;
    if (coat_bends) own = facing(ref_scale(bent(w, hit, n, MASU_SLOT_EMISSIVE), turn), v, 0.1);
    n = facing(ref_scale(n, turn), v, 0);
    relief = m->map[MASU_SLOT_NORMAL] ? facing(ref_scale(relief, turn), v, 0.1) : n;
    out->s.normal = m->flags & MASU_MATERIAL_BASE_SMOOTH ? n : relief;
    out->s.coat_normal = coat_bends ? own : m->flags & MASU_MATERIAL_COAT_SMOOTH ? n : relief;
}

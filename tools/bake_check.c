/* bake_check.c: every rule that blob.h promises to a reader, checked on the arrays being baked.
 *
 * Two uses: on a piece that another process handed over, before any of its indices is followed; and
 * on the finished scene, so that masu-bake cannot write a blob that the runtime refuses. */
#include "bake_content.h"

#include <string.h>

static bool finite_all(const float *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i])) return false;
    }
    return true;
}

static bool in_range(const float *values, size_t count, float low, float high) {
    for (size_t i = 0; i < count; i++) {
        if (!(values[i] >= low && values[i] <= high)) return false;
    }
    return true;
}

static bool name_ok(const masu_bake_content *c, uint32_t name) {
    return name == MASU_BLOB_NONE || name < c->section[MASU_BLOB_NAMES].bytes;
}

/* [first, first + count) lies in [0, total), and is not empty. */
static bool range_ok(uint32_t first, uint32_t count, uint64_t total) {
    return count > 0 && (uint64_t)first + count <= total;
}

static const char *check_sections(const masu_bake_content *c) {
    for (uint32_t kind = 1; kind < MASU_BLOB_KIND_COUNT; kind++) {
        if (c->section[kind].bytes % masu_bake_stride(kind)) return "a section with half an element";
        if (masu_bake_count(c, kind) > INT32_MAX) return "a section of 2^31 elements or more";
    }
    const masu_bake_buffer *names = &c->section[MASU_BLOB_NAMES];
    if (names->bytes && names->data[names->bytes - 1] != 0) return "names that do not end";
    return NULL;
}

static const char *check_primitive(const masu_bake_content *c, const masu_blob_primitive *p) {
    if (!range_ok(p->first_index, p->index_count, masu_bake_count(c, MASU_BLOB_INDICES)) ||
        p->index_count % 3 ||
        !range_ok(p->first_vertex, p->vertex_count, masu_bake_count(c, MASU_BLOB_VERTICES)) ||
        p->vertex_count > 16777215u || p->material >= masu_bake_count(c, MASU_BLOB_MATERIALS)) {
        return "a primitive with a range outside the geometry";
    }
    for (uint32_t i = 0; i < p->index_count; i++) {
        if (MASU_BAKE_INDICES(c)[p->first_index + i] >= p->vertex_count) {
            return "an index beyond its primitive's vertices";
        }
    }
    for (uint32_t i = 0; i < p->vertex_count; i++) {
        const float *v = MASU_BAKE_VERTICES(c)[p->first_vertex + i].position;
        for (int k = 0; k < 3; k++) {
            if (!(v[k] >= p->aabb_min[k] && v[k] <= p->aabb_max[k])) {
                return "a vertex outside its primitive's box";
            }
        }
    }
    return NULL;
}

static const char *check_geometry(const masu_bake_content *c) {
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_VERTICES); i++) {
        const masu_blob_vertex *v = &MASU_BAKE_VERTICES(c)[i];
        if (!finite_all(v->position, 3)) return "a vertex that is not finite";
        if (v->normal[0] == INT16_MIN || v->normal[1] == INT16_MIN) return "a normal out of range";
    }
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_PRIMITIVES); i++) {
        const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[i];
        if (!finite_all(p->aabb_min, 3) || !finite_all(p->aabb_max, 3)) {
            return "a primitive whose box is not finite";
        }
        const char *problem = check_primitive(c, p);
        if (problem) return problem;
    }
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_MESHES); i++) {
        const masu_blob_mesh *m = &MASU_BAKE_MESHES(c)[i];
        if (!range_ok(m->first_primitive, m->primitive_count,
                      masu_bake_count(c, MASU_BLOB_PRIMITIVES))) {
            return "a mesh with a range outside the primitives";
        }
        if (!name_ok(c, m->name)) return "a name out of range";
        for (uint32_t j = 0; j < m->primitive_count; j++) {
            const masu_blob_primitive *p = &MASU_BAKE_PRIMITIVES(c)[m->first_primitive + j];
            for (int k = 0; k < 3; k++) {
                if (!(m->aabb_min[k] <= p->aabb_min[k] && m->aabb_max[k] >= p->aabb_max[k])) {
                    return "a primitive outside its mesh's box";
                }
            }
        }
    }
    return NULL;
}

static const char *check_instances(const masu_bake_content *c, bool sorted) {
    uint64_t count = masu_bake_count(c, MASU_BLOB_INSTANCES);
    for (uint64_t i = 0; i < count; i++) {
        const masu_blob_instance *n = &MASU_BAKE_INSTANCES(c)[i];
        if (!finite_all(n->transform, 12)) return "an instance whose transform is not finite";
        if (n->mesh >= masu_bake_count(c, MASU_BLOB_MESHES)) return "an instance of no mesh";
        if (n->parent != MASU_BLOB_NONE && n->parent >= count) return "a parent out of range";
        if (!name_ok(c, n->name)) return "a name out of range";
        if (sorted && i > 0 && n->mesh < n[-1].mesh) return "instances that are not in order";
    }
    return NULL;
}

static const char *check_materials(const masu_bake_content *c) {
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_MATERIALS); i++) {
        const masu_blob_material *m = &MASU_BAKE_MATERIALS(c)[i];
        if (!in_range(m->base_color, 3, 0, 1) || !in_range(&m->roughness, 1, 0, 1) ||
            !in_range(&m->metallic, 1, 0, 1) || !in_range(m->emissive, 3, 0, 1e9f)) {
            return "a material out of range";
        }
        if (!name_ok(c, m->name)) return "a name out of range";
    }
    return NULL;
}

static const char *check_camera(const masu_bake_content *c) {
    const masu_blob_camera_key *keys =
        MASU_BAKE_ARRAY(c, MASU_BLOB_CAMERA_KEYS, const masu_blob_camera_key);
    for (uint64_t i = 0; i < masu_bake_count(c, MASU_BLOB_CAMERA_KEYS); i++) {
        const masu_blob_camera_key *k = &keys[i];
        if (!isfinite(k->time) || !finite_all(k->position, 3) || !finite_all(k->target, 3)) {
            return "a camera key that is not finite";
        }
        if (memcmp(k->position, k->target, sizeof k->position) == 0) {
            return "a camera that looks at itself";
        }
        if (!in_range(&k->fov_y, 1, 0.001f, 3.1f)) return "a field of view out of range";
        if (i > 0 && !(k->time > k[-1].time)) return "camera keys out of order";
    }
    return NULL;
}

static const char *check_environment(const masu_bake_content *c) {
    if (masu_bake_count(c, MASU_BLOB_ENVIRONMENT) != 1) return "no environment";
    const masu_blob_environment *e =
        MASU_BAKE_ARRAY(c, MASU_BLOB_ENVIRONMENT, const masu_blob_environment);
    double length = masu_bake_length(masu_bake_v3f(e->sun_direction));
    if (!(fabs(length - 1.0) < 1e-5)) return "a sun direction that is not of unit length";
    if (!in_range(&e->exposure, 1, 1e-9f, 1e9f) || !in_range(&e->near_distance, 1, 1e-9f, 1e9f) ||
        !in_range(e->sun_color, 3, 0, 1e9f) || !in_range(e->ambient, 3, 0, 1e9f) ||
        !in_range(e->sky_zenith, 3, 0, 1e9f) || !in_range(e->sky_horizon, 3, 0, 1e9f)) {
        return "an environment out of range";
    }
    return NULL;
}

static const char *check_sdf(const masu_bake_content *c) {
    uint64_t sdfs = masu_bake_count(c, MASU_BLOB_SDF);
    uint64_t params = masu_bake_count(c, MASU_BLOB_SDF_PARAMS);
    uint64_t words = masu_bake_count(c, MASU_BLOB_MARCH_SPIRV);
    if (sdfs > 1 || (sdfs == 1) != (words > 0) || (params > 0 && sdfs == 0) || params > 256) {
        return "an incomplete SDF";
    }
    if (sdfs == 0) return NULL;
    const masu_blob_sdf *s = MASU_BAKE_ARRAY(c, MASU_BLOB_SDF, const masu_blob_sdf);
    for (int k = 0; k < 3; k++) {
        if (!(s->bounds_min[k] < s->bounds_max[k]) || !in_range(&s->bounds_min[k], 1, -1e30f, 1e30f) ||
            !in_range(&s->bounds_max[k], 1, -1e30f, 1e30f)) {
            return "SDF bounds that are empty or out of range";
        }
    }
    if (!in_range(&s->lipschitz, 1, 1e-3f, 1e6f) || !in_range(&s->max_distance, 1, 1e-6f, 1e30f)) {
        return "an SDF constant out of range";
    }
    if (s->has_raster != (masu_bake_count(c, MASU_BLOB_INSTANCES) > 0)) {
        return "an SDF shader for another kind of scene";
    }
    for (uint64_t i = 0; i < params; i++) {
        const masu_blob_sdf_param *p =
            &MASU_BAKE_ARRAY(c, MASU_BLOB_SDF_PARAMS, const masu_blob_sdf_param)[i];
        if (!finite_all(&p->value, 3) || !(p->minimum <= p->value && p->value <= p->maximum)) {
            return "an SDF parameter outside its range";
        }
        if (!name_ok(c, p->name)) return "a name out of range";
    }
    return NULL;
}

const char *masu_bake_check(const masu_bake_content *content, bool piece) {
    const char *problem = check_sections(content);
    if (!problem) problem = check_materials(content);
    if (!problem) problem = check_geometry(content);
    if (!problem) problem = check_instances(content, !piece);
    if (!problem) problem = check_camera(content);
    if (!problem && !piece) problem = check_environment(content);
    if (!problem) problem = check_sdf(content);
    return problem;
}

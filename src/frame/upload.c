/* upload.c: what the host writes for the GPU: the scene once, instance transforms when they move,
 * one block of uniforms per frame. Everything from outside is checked before the first byte is
 * written. */
#include "renderer.h"

#include "base/error.h"
#include "shared/masu_shared.h"
#include "smaa_area.h"
#include "split_sum.h"

#include <math.h>
#include <string.h>

/* ---- Scene ----------------------------------------------------------------------------------- */

static const masu_buffer_id resident[] = {MASU_BUFFER_VERTICES, MASU_BUFFER_INDICES,
                                          MASU_BUFFER_TEXCOORDS, MASU_BUFFER_MATERIALS,
                                          MASU_BUFFER_SLOTS, MASU_BUFFER_TABLES,
                                          MASU_BUFFER_PROBES, MASU_BUFFER_TRACE,
                                          MASU_BUFFER_RAY_INDICES, MASU_BUFFER_SMAA_AREA};

#define RESIDENT_COUNT (sizeof resident / sizeof *resident)

uint32_t masu_buffer_chunks(const masu_frame_plan *plan) {
    uint64_t step = plan->buffers[MASU_BUFFER_STAGING].bytes;
    uint32_t chunks = 0;
    for (size_t i = 0; i < RESIDENT_COUNT && plan->staged; i++) {
        chunks += (uint32_t)((plan->buffers[resident[i]].bytes + step - 1) / step);
    }
    return chunks;
}

int masu_keeps_images(const masu_frame_plan *plan) {
    for (uint32_t i = 1; i < MASU_IMAGE_SOURCE; i++) {
        if (plan->images[i].used && masu_images[i].kept) return 1;
    }
    return 0;
}

uint32_t masu_load_chunks(const masu_frame_plan *plan) {
    uint32_t chunks = masu_buffer_chunks(plan) + (masu_keeps_images(plan) ? 1 : 0);
    if (plan->needs.query) chunks++;
    if (!plan->scene.texture_arrays) return chunks;
    masu_scene_view v = masu_scene_look(&plan->scene);
    return chunks + masu_texture_chunks(v.textures, plan->scene.texture_arrays, plan->compressed,
                                        plan->buffers[MASU_BUFFER_STAGING].bytes);
}

/* Behind all that is copied. */
int masu_is_build_chunk(const masu_frame_plan *plan, uint32_t index, uint32_t chunks) {
    return plan->needs.query && index + 1 + (masu_keeps_images(plan) ? 1 : 0) == chunks;
}

masu_chunk masu_load_chunk(const masu_frame_plan *plan, uint32_t index) {
    uint64_t step = plan->buffers[MASU_BUFFER_STAGING].bytes;
    for (size_t i = 0; i < RESIDENT_COUNT; i++) {
        uint64_t bytes = plan->buffers[resident[i]].bytes;
        uint32_t chunks = (uint32_t)((bytes + step - 1) / step);
        if (index < chunks) {
            uint64_t offset = index * step, left = bytes - offset;
            return (masu_chunk){resident[i], offset, left < step ? left : step, bytes};
        }
        index -= chunks;
    }
    return (masu_chunk){MASU_BUFFER_COUNT, 0, 0, 0};
}

static struct masu_material_data device_material(const masu_blob_material *m) {
    struct masu_material_data d = {
        {m->base_color[0], m->base_color[1], m->base_color[2], m->roughness},
        {m->emissive[0], m->emissive[1], m->emissive[2], m->metallic},
        {m->specular, m->coat, m->coat_roughness, m->opacity}};
    return d;
}

_Static_assert(sizeof(masu_blob_meso) == 2 * sizeof(struct masu_material_data),
               "curves lie in the buffer of materials");

/* An element of the buffer of materials: a material, or half of the curves of a small relief. */
static struct masu_material_data material_element(const masu_scene_view *v, uint64_t i) {
    struct masu_material_data d;
    if (i < v->material_count) return device_material(&v->materials[i]);
    memcpy(&d, (const unsigned char *)v->meso + (i - v->material_count) * sizeof d, sizeof d);
    return d;
}

_Static_assert(sizeof(masu_blob_probes) == sizeof(struct masu_probe_grid), "probes");

/* The grid, its data, and room that the GPU fills. */
static void write_probes(const masu_scene_view *v, masu_chunk chunk, unsigned char *to) {
    const struct {
        const void *from;
        uint64_t bytes;
    } parts[] = {{v->probes, sizeof *v->probes},
                 {v->probe_data, v->probe_words * sizeof(uint32_t)}};
    uint64_t start = 0;
    memset(to, 0, (size_t)chunk.bytes);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        uint64_t end = start + parts[i].bytes, last = chunk.offset + chunk.bytes;
        uint64_t low = start > chunk.offset ? start : chunk.offset, high = end < last ? end : last;
        if (low < high) {
            memcpy(to + (low - chunk.offset), (const unsigned char *)parts[i].from + (low - start),
                   (size_t)(high - low));
        }
        start = end;
    }
}

/* The library's tables, then the scene's picture of a sky. */
static void write_tables(const masu_scene_view *v, masu_chunk chunk, unsigned char *to) {
    const masu_blob_environment_map *map = v->environment_map;
    uint64_t texels = map ? masu_blob_environment_texels(map->size, map->mips) : 0;
    uint64_t own = chunk.whole - texels * sizeof(uint32_t), from = 0;
    if (chunk.offset < own) {
        from = own - chunk.offset < chunk.bytes ? own - chunk.offset : chunk.bytes;
        memcpy(to, (const unsigned char *)masu_split_sum + chunk.offset, (size_t)from);
    }
    if (from < chunk.bytes) {
        memcpy(to + from,
               (const unsigned char *)v->environment_texels + (chunk.offset + from - own),
               (size_t)(chunk.bytes - from));
    }
}

static void write_resident(const masu_renderer *m, const masu_scene_view *v, masu_chunk chunk,
                           unsigned char *to) {
    if (chunk.buffer == MASU_BUFFER_VERTICES) {
        memcpy(to, (const unsigned char *)v->vertices + chunk.offset, (size_t)chunk.bytes);
    } else if (chunk.buffer == MASU_BUFFER_INDICES) {
        memcpy(to, (const unsigned char *)v->indices + chunk.offset, (size_t)chunk.bytes);
    } else if (chunk.buffer == MASU_BUFFER_TEXCOORDS) {
        memcpy(to, (const unsigned char *)v->texcoords + chunk.offset, (size_t)chunk.bytes);
    } else if (chunk.buffer == MASU_BUFFER_TABLES) {
        write_tables(v, chunk, to);
    } else if (chunk.buffer == MASU_BUFFER_SMAA_AREA) {
        memcpy(to, (const unsigned char *)masu_smaa_area + chunk.offset, (size_t)chunk.bytes);
    } else if (chunk.buffer == MASU_BUFFER_SLOTS) {
        /* The buffer may hold two sets; both begin as the blob has them. */
        uint64_t size = v->slot_count * sizeof(float), at = chunk.offset, end = at + chunk.bytes;
        while (at < end) {
            uint64_t skip = at % size, part = size - skip < end - at ? size - skip : end - at;
            memcpy(to + (at - chunk.offset), (const unsigned char *)v->slots + skip, (size_t)part);
            at += part;
        }
    } else if (chunk.buffer == MASU_BUFFER_PROBES) {
        write_probes(v, chunk, to);
    } else if (chunk.buffer == MASU_BUFFER_TRACE) {
        masu_trace_write(&m->plan.scene, v, chunk.offset, chunk.bytes, to);
    } else if (chunk.buffer == MASU_BUFFER_RAY_INDICES) {
        masu_ray_write_indices(v, chunk.offset, chunk.bytes, to);
    } else if (chunk.buffer == MASU_BUFFER_MATERIALS) {
        /* A chunk may cut a material in two when the staging buffer is small: convert whole, copy
         * the part. */
        uint64_t size = sizeof(struct masu_material_data), at = chunk.offset,
                 end = at + chunk.bytes;
        while (at < end) {
            struct masu_material_data d = material_element(v, at / size);
            uint64_t skip = at % size, part = size - skip < end - at ? size - skip : end - at;
            memcpy(to + (at - chunk.offset), (const unsigned char *)&d + skip, (size_t)part);
            at += part;
        }
    }
}

static void write_textures(masu_renderer *m, const masu_scene_view *v, unsigned char *to) {
    uint64_t used = 0, room = m->plan.buffers[MASU_BUFFER_STAGING].bytes;
    masu_texture_region region;
    while (masu_texture_next(v->textures, m->plan.scene.texture_arrays, m->plan.compressed, room,
                             &m->texture_next, &used, &region)) {
        masu_texture_write(&v->textures[region.texture], v->texels, m->plan.compressed, &region,
                           to);
    }
}

masu_result masu_load(masu_renderer *m, masu_commands *commands) {
    if (!m || !commands) return MASU_ERROR_ARGUMENT;
    memset(commands, 0, sizeof *commands);
    if (m->loaded) return MASU_OK;
    masu_scene_view v = {0}; /* without a scene there may still be tables */
    if (m->plan.desc.scene) v = masu_scene_look(m->plan.desc.scene);
    if (!m->load_next && !m->plan.staged) {
        for (size_t i = 0; i < RESIDENT_COUNT; i++) {
            uint64_t bytes = m->plan.buffers[resident[i]].bytes;
            masu_chunk all = {resident[i], 0, bytes, bytes};
            if (!m->plan.desc.scene && resident[i] != MASU_BUFFER_SMAA_AREA) continue;
            if (all.bytes) write_resident(m, &v, all, masu_buffer_pointer(m, resident[i], 0));
        }
    }
    if (m->load_next < m->load_count) {
        unsigned char *to = masu_buffer_pointer(m, MASU_BUFFER_STAGING, 0);
        if (masu_keeps_images(&m->plan) && m->load_next + 1 == m->load_count) {
            /* Nothing to copy: the images that frames leave to each other get their layout. */
        } else if (masu_is_build_chunk(&m->plan, m->load_next, m->load_count)) {
            /* Nor here: structures of ray queries are built. */
        } else if (m->load_next < masu_buffer_chunks(&m->plan)) {
            write_resident(m, &v, masu_load_chunk(&m->plan, m->load_next), to);
        } else {
            write_textures(m, &v, to);
        }
        commands->buffer = m->loads[m->load_next++];
        return MASU_INCOMPLETE;
    }
    if (m->plan.desc.scene) {
        masu_write_commands(m, &v);
        masu_write_occluders(m, &v);
    }
    m->loaded = 1;
    m->plan.scene.blob = NULL; /* from here on the host may free it */
    return MASU_OK;
}

/* A transform must reach every slot; with the frame before, once more: the slot of the frame that
 * moved it still says that it is moving. */
static uint8_t frames_to_write(const masu_renderer *m) {
    return (uint8_t)(m->plan.desc.frames_in_flight + (m->plan.needs.velocity ? 1 : 0));
}

void masu_keep_scene(masu_renderer *m) {
    const masu_scene *scene = m->plan.desc.scene;
    if (!scene) return;
    masu_scene_view v = masu_scene_look(scene);
    m->environment = *v.environment;
    if (v.environment_map) {
        for (uint32_t k = 0; k < 9; k++)
            memcpy(m->environment_sh[k], v.environment_map->sh[k], sizeof m->environment_sh[k]);
    }
    for (uint32_t i = 0; i < scene->instances; i++) {
        memcpy(&m->instances[i], v.instances[i].transform, sizeof m->instances[i]);
        if (m->plan.needs.velocity) m->previous_instances[i] = m->instances[i];
        uint32_t name = v.instances[i].name;
        m->instance_names[i] =
            name == MASU_BLOB_NONE ? 0 : masu_fnv1a64(v.names + name, strlen(v.names + name));
        m->instance_dirty[i] = frames_to_write(m);
    }
    m->dirty_count = scene->instances;
    masu_keep_lights(m, &v);
    masu_keep_visible(m, &v);
    masu_keep_occluders(m, &v);
    masu_keep_transparents(m, &v);
    masu_keep_trace(m, &v);
    if (scene->camera_keys)
        memcpy(m->camera_keys, v.camera_keys, scene->camera_keys * sizeof *v.camera_keys);
    if (scene->sdf_params)
        memcpy(m->sdf_params, v.sdf_params, scene->sdf_params * sizeof *v.sdf_params);
    if (!v.sdf) return;
    for (uint32_t k = 0; k < 3; k++) {
        m->sdf_bounds[0][k] = v.sdf->bounds_min[k];
        m->sdf_bounds[1][k] = v.sdf->bounds_max[k];
    }
    m->sdf_bounds[0][3] = 1.0f / v.sdf->lipschitz;
    m->sdf_bounds[1][3] = v.sdf->max_distance;
}

/* ---- Instances ------------------------------------------------------------------------------- */

/* The same transform must reach every slot, each when it is free. */
void masu_write_instances(masu_renderer *m, uint32_t slot, int cut) {
    if (!m->dirty_count) return;
    unsigned char *at = masu_buffer_pointer(m, MASU_BUFFER_INSTANCES, slot);
    struct masu_instance_data *to = (struct masu_instance_data *)(void *)at;
    struct masu_instance_data *before = (struct masu_instance_data *)(void *)(
        at + m->plan.buffers[MASU_BUFFER_INSTANCES].stride / 2);
    for (uint32_t i = 0; i < m->plan.scene.instances; i++) {
        if (!m->instance_dirty[i]) continue;
        to[i] = m->instances[i];
        masu_write_box(m, slot, i);
        if (m->plan.needs.velocity) {
            before[i] = cut ? m->instances[i] : m->previous_instances[i];
            m->previous_instances[i] = m->instances[i];
        }
        if (--m->instance_dirty[i] == 0) m->dirty_count--;
    }
}

masu_instance masu_instance_find(const masu_renderer *m, const char *name) {
    if (!m || !name || !*name) return (masu_instance){0};
    uint64_t hash = masu_fnv1a64(name, strlen(name));
    for (uint32_t i = 0; i < m->plan.scene.instances; i++) {
        if (m->instance_names[i] == hash) return (masu_instance){i + 1};
    }
    return (masu_instance){0};
}

masu_result masu_instance_set_transform(masu_renderer *m, masu_instance instance,
                                        const float rows[12]) {
    if (!m || !rows) return MASU_ERROR_ARGUMENT;
    if (instance.id == 0 || instance.id > m->plan.scene.instances) {
        return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "instance", m->plan.scene.instances,
                         instance.id, "instance handle %u: the scene has handles 1 to %u",
                         instance.id, m->plan.scene.instances);
    }
    for (uint32_t k = 0; k < 12; k++) {
        if (!isfinite(rows[k])) {
            return masu_fail(&m->error, MASU_ERROR_ARGUMENT, "rows", 12, k,
                             "instance %u: transform[%u] is not finite", instance.id, k);
        }
    }
    uint32_t i = instance.id - 1;
    memcpy(&m->instances[i], rows, sizeof m->instances[i]);
    if (!m->instance_dirty[i]) m->dirty_count++;
    m->instance_dirty[i] = frames_to_write(m);
    masu_move_box(m, i);
    return MASU_OK;
}

/* ---- Camera and light ------------------------------------------------------------------------ */

/* Unit vector of v, or 0 if it has none. The scale keeps 1e-30 and 1e+30 out of under- and
 * overflow. */
int masu_unit(const float v[3], float out[3]) {
    double x = (double)v[0], y = (double)v[1], z = (double)v[2];
    double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0.0) || !isfinite(length)) return 0;
    out[0] = (float)(x / length);
    out[1] = (float)(y / length);
    out[2] = (float)(z / length);
    return 1;
}

static void cross(const float a[3], const float b[3], float out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

masu_result masu_camera_at(const masu_renderer *m, double time, masu_camera *out) {
    uint32_t n = m ? m->plan.scene.camera_keys : 0;
    if (!m || !out || !isfinite(time)) return MASU_ERROR_ARGUMENT;
    if (!n) return MASU_ERROR_STATE;
    uint32_t k = 0;
    while (k + 2 < n && time >= (double)m->camera_keys[k + 1].time) k++;
    const masu_blob_camera_key *a = &m->camera_keys[k], *b = &m->camera_keys[n > 1 ? k + 1 : k];
    double span = (double)b->time - (double)a->time;
    double u = span > 0.0 ? (time - (double)a->time) / span : 0.0;
    u = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < 3; i++) {
        out->position[i] =
            (double)a->position[i] + ((double)b->position[i] - (double)a->position[i]) * u;
        double target = (double)a->target[i] + ((double)b->target[i] - (double)a->target[i]) * u;
        out->forward[i] = (float)(target - out->position[i]);
    }
    out->fov_y = (float)((double)a->fov_y + ((double)b->fov_y - (double)a->fov_y) * u);
    /* Two keys whose positions and targets cross over meet in a point half-way: look along the
     * first key's. */
    float ignored[3];
    if (!masu_unit(out->forward, ignored)) {
        for (uint32_t i = 0; i < 3; i++) out->forward[i] = a->target[i] - a->position[i];
    }
    return MASU_OK;
}

static masu_result bad_camera(masu_detail *detail, const char *what, const char *problem) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, 0, 0, "%s %s", what, problem);
}

static masu_result write_camera(masu_renderer *m, const masu_camera *c, uint32_t rung,
                                struct masu_frame_uniforms *u, masu_detail *detail) {
    float forward[3], right[3], up[3], wish[3] = {0.0f, 1.0f, 0.0f};
    for (uint32_t i = 0; i < 3; i++) {
        if (!(fabs(c->position[i]) <= 1e15)) {
            return bad_camera(detail, "camera.position", "is not finite or beyond 1e15 m");
        }
    }
    if (!masu_unit(c->forward, forward))
        return bad_camera(detail, "camera.forward", "is zero or not finite");
    int own_up = c->up[0] != 0.0f || c->up[1] != 0.0f || c->up[2] != 0.0f;
    if (own_up && !masu_unit(c->up, wish)) return bad_camera(detail, "camera.up", "is not finite");
    cross(forward, wish, right);
    if (!masu_unit(right, right)) {
        if (own_up) return bad_camera(detail, "camera.up", "is parallel to camera.forward");
        /* Looking straight up or down without an up of one's own: any right-hand side will do. */
        right[0] = 1.0f, right[1] = right[2] = 0.0f;
    }
    cross(right, forward, up);
    float near_distance =
        c->near_distance != 0.0f ? c->near_distance : m->environment.near_distance;
    if (!(near_distance >= 1e-9f && near_distance <= 1e9f)) {
        return bad_camera(detail, "camera.near_distance", "is not 1e-9 to 1e9 m");
    }
    if (!(c->fov_y >= 0.001f && c->fov_y <= 3.1f)) {
        return bad_camera(detail, "camera.fov_y", "is not 0.001 to 3.1 radians");
    }
    if (!(fabsf(c->jitter[0]) <= 1.0f && fabsf(c->jitter[1]) <= 1.0f))
        return bad_camera(detail, "camera.jitter", "is not -1 to 1 pixels");
    const masu_rung_plan *rp = &m->plan.rungs[rung];
    u->jitter[0] = 2.0f * c->jitter[0] / (float)rp->render_width;
    u->jitter[1] = 2.0f * c->jitter[1] / (float)rp->render_height;
    double tan_y = tan((double)c->fov_y * 0.5);
    double tan_x = tan_y * (double)m->plan.desc.output.width / (double)m->plan.desc.output.height;
    memset(u->clip_from_rel, 0, sizeof u->clip_from_rel);
    for (uint32_t i = 0; i < 3; i++) {
        float high = (float)c->position[i];
        u->eye_hi[i] = high;
        u->eye_lo[i] = (float)(c->position[i] - (double)high);
        u->right[i] = (float)((double)right[i] * tan_x);
        u->up[i] = (float)((double)up[i] * tan_y);
        u->forward[i] = forward[i];
        /* Reverse-Z with an infinite far plane: depth = near / view z, so that fp32 resolution is
         * relative at any distance (view z comes back as near / depth). Vulkan's clip y points
         * down. */
        u->clip_from_rel[i * 4 + 0] =
            (float)((double)right[i] / tan_x - (double)u->jitter[0] * (double)forward[i]);
        u->clip_from_rel[i * 4 + 1] =
            (float)(-(double)up[i] / tan_y - (double)u->jitter[1] * (double)forward[i]);
        u->clip_from_rel[i * 4 + 3] = forward[i];
    }
    u->clip_from_rel[14] = near_distance;
    u->right[3] = (float)tan_x;
    u->up[3] = (float)tan_y;
    u->forward[3] = near_distance;
    return MASU_OK;
}

/* The SDF's space. Where fp32 would resolve world coordinates too coarsely at the eye, and the
 * scene's code knows of anchors, the origin moves to a point near the eye. It lies on a grid, so that
 * it rarely moves: what the field rounds would otherwise differ from frame to frame. */
static void write_anchor(const masu_renderer *m, const masu_camera *c,
                         struct masu_frame_uniforms *u) {
    int far = 0;
    for (uint32_t i = 0; i < 3; i++) {
        far |= m->plan.scene.sdf_anchored && fabs(c->position[i]) >= MASU_ANCHOR_FROM;
    }
    for (uint32_t i = 0; i < 3; i++) {
        double steps = floor(c->position[i] / MASU_ANCHOR_GRID + 0.5);
        u->anchor[i] = far ? (float)(steps * MASU_ANCHOR_GRID) : 0.0f;
        double anchor = (double)u->anchor[i], eye = c->position[i] - anchor;
        u->sdf_eye_hi[i] = (float)eye;
        u->sdf_eye_lo[i] = (float)(eye - (double)u->sdf_eye_hi[i]);
        u->sdf_min[i] = (float)((double)m->sdf_bounds[0][i] - anchor);
        u->sdf_max[i] = (float)((double)m->sdf_bounds[1][i] - anchor);
    }
    u->sdf_min[3] = m->sdf_bounds[0][3];
    u->sdf_max[3] = m->sdf_bounds[1][3];
}

int masu_is_cut(const masu_renderer *m, const masu_frame_desc *f) {
    return f->cut || m->frame == 0;
}

masu_result masu_write_frame(masu_renderer *m, const masu_frame_desc *f, uint32_t slot,
                             masu_detail *detail) {
    struct masu_frame_uniforms u;
    memset(&u, 0, sizeof u);
    masu_camera camera;
    /* Beyond this a float has no seconds left; far beyond, it is infinite. */
    if (!(fabs(f->time) <= 1e15) || !(fabsf(f->time_step) <= 1e15f)) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "time", 0, 0,
                         "time or time_step is not finite or beyond 1e15 s");
    }
    if (f->camera) {
        camera = *f->camera;
    } else if (masu_camera_at(m, f->time, &camera) != MASU_OK) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "camera", 1, 0,
                         "camera is NULL and the scene has no camera path");
    }
    masu_result result = write_camera(m, &camera, f->rung, &u, detail);
    masu_light light;
    if (!result) result = masu_write_light(m, f->light, camera.position[1], &u, &light, detail);
    if (result) return result;
    uint32_t params = m->plan.scene.sdf_params, given = f->sdf_params ? f->sdf_param_count : 0;
    if (given > params) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "sdf_param_count", params, given,
                         "sdf_param_count is %u, the scene has %u", given, params);
    }
    for (uint32_t i = 0; i < params; i++) {
        const masu_blob_sdf_param *p = &m->sdf_params[i];
        float v = i < given ? f->sdf_params[i] : p->value;
        if (!isfinite(v)) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "sdf_params", 0, i,
                             "sdf_params[%u] is not finite", i);
        }
        u.sdf_params[i / 4][i % 4] = v < p->minimum ? p->minimum : v > p->maximum ? p->maximum : v;
    }
    write_anchor(m, &camera, &u);
    masu_write_sky(m, &light, slot, &u);
    masu_write_reflections(m, f, camera.position, &u);
    u.history[0] = (uint32_t)m->frame;
    if (masu_is_cut(m, f)) u.history[3] |= MASU_HISTORY_CUT;
    u.eye_hi[3] = (float)f->time;
    u.eye_lo[3] = f->time_step;
    unsigned char *to = masu_buffer_pointer(m, MASU_BUFFER_FRAME, slot);
    memcpy(to, &u, sizeof u);
    m->drawn = m->plan.needs.shadow ? masu_write_shadow(m, f, slot, &u, camera.position) : 0;
    masu_set_views(m, &u, camera.position, f->rung);
    masu_write_lights(m, slot, &u, camera.position,
                      m->plan.desc.rungs[f->rung].frustum != MASU_OFF && !m->plan.needs.reflections);
    if (m->plan.needs.velocity) {
        uint64_t half = m->plan.buffers[MASU_BUFFER_FRAME].stride / 2;
        memcpy(to + half, masu_is_cut(m, f) ? &u : m->previous, sizeof u);
        *m->previous = u;
    }
    return MASU_OK;
}

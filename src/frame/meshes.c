/* meshes.c: see meshes.h. */
#include "frame/meshes.h"

#include "base/error.h"
#include "device/bind.h"
#include "scene/trace_scene.h"

#include <math.h>
#include <string.h>

#define REACH 1e15f

void masu_meshes_alloc(masu_meshes *s, masu_arena *arena, const masu_frame_plan *plan) {
    uint64_t most = 0;
    memset(s, 0, sizeof *s);
    if (!plan->reserve.meshes) return;
    for (uint32_t k = 0; plan->scene.host_nodes && k < MASU_MAX_MESH_KINDS; k++) {
        const masu_mesh_kind *kind = &plan->desc.reserve.meshes[k];
        if (kind->meshes && most < kind->triangles) most = kind->triangles;
    }
    s->meshes = masu_arena_alloc(arena, "meshes", plan->reserve.meshes, sizeof *s->meshes, 8);
    s->staging = masu_arena_alloc(arena, "mesh upload", plan->reserve.mesh_upload, 1, 16);
    s->boxes = masu_arena_alloc(arena, "mesh build boxes", most, sizeof *s->boxes, 4);
    s->order = masu_arena_alloc(arena, "mesh build order", most, sizeof *s->order, 4);
    s->work = masu_arena_alloc(arena, "mesh build work", most, sizeof *s->work, 4);
    s->below = masu_arena_alloc(arena, "mesh build nodes", masu_trace_tree_nodes((uint32_t)most),
                                sizeof *s->below, 4);
}

void masu_meshes_copy_scene(masu_meshes *s, const masu_frame_plan *plan, const masu_scene_view *v) {
    for (uint32_t i = 0; i < plan->reserve.meshes; i++) s->meshes[i] = (masu_host_mesh){0};
    s->used = 0;
    for (uint32_t k = 0; plan->scene.host_nodes && k < MASU_MAX_MESH_KINDS; k++) {
        const masu_mesh_kind *kind = &plan->desc.reserve.meshes[k];
        if (kind->meshes) s->words[k] = masu_trace_word_of(&plan->scene, v, kind->material);
    }
}

static masu_mesh_slot slot_of(const masu_frame_plan *plan, uint32_t slot) {
    return masu_mesh_slot_of(&plan->desc.reserve, plan->scene.host_nodes != 0, slot);
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static masu_result check_numbers(uint32_t slot, const char *what, const float *numbers,
                                 uint32_t each, uint32_t count, float low, float high,
                                 masu_detail *detail) {
    for (uint64_t i = 0; numbers && i < each * (uint64_t)count; i++) {
        if (numbers[i] >= low && numbers[i] <= high) continue; /* NaN is not */
        return masu_fail(detail, MASU_ERROR_ARGUMENT, what, count, i / each,
                         "mesh %u: %s of vertex %u have a %g, not within %g..%g", slot, what,
                         (uint32_t)(i / each), (double)numbers[i], (double)low, (double)high);
    }
    return MASU_OK;
}

static masu_result check_count(uint32_t slot, const char *what, uint32_t count, uint32_t least,
                               uint32_t most, masu_detail *detail) {
    if (count > most)
        return masu_fail(detail, MASU_ERROR_LIMIT, what, count, most,
                         "mesh %u: %s is %u, its slot holds %u", slot, what, count, most);
    if (count >= least) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, least, count,
                     "mesh %u: %s is %u, at least %u are required", slot, what, count, least);
}

static masu_result check_upload(const masu_meshes *s, const masu_frame_plan *plan, uint32_t slot,
                                uint64_t bytes, masu_detail *detail) {
    uint64_t needed = s->used + bytes, most = plan->reserve.mesh_upload;
    if (needed <= most) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.mesh_upload", needed, most,
                     "mesh %u: reserve.mesh_upload: with it the next frame has %llu bytes, the "
                     "limit is %llu; call again after masu_frame",
                     slot, (unsigned long long)needed, (unsigned long long)most);
}

static masu_result check_vertices(uint32_t slot, const masu_mesh_data *data, masu_detail *detail) {
    masu_result result = check_numbers(slot, "positions", data->positions, 3, data->vertex_count,
                                       -REACH, REACH, detail);
    if (result) return result;
    return check_numbers(slot, "normals", data->normals, 3, data->vertex_count, -3.4e38f, 3.4e38f,
                         detail);
}

static masu_result check_indices(uint32_t slot, const masu_mesh_data *data, masu_detail *detail) {
    for (uint64_t i = 0; i < 3 * (uint64_t)data->triangle_count; i++) {
        if (data->indices[i] < data->vertex_count) continue;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "indices", data->vertex_count,
                         data->indices[i], "mesh %u: triangle %u has vertex %u, the mesh has %u",
                         slot, (uint32_t)(i / 3), data->indices[i], data->vertex_count);
    }
    return MASU_OK;
}

masu_result masu_meshes_check(const masu_meshes *s, const masu_frame_plan *plan, uint32_t slot,
                              const masu_mesh_data *data, masu_detail *detail) {
    const masu_scene_data *scene = &plan->scene;
    const masu_mesh_slot room = slot_of(plan, slot);
    if (!data->positions) return masu_fail_null(detail, "positions");
    if (!data->normals) return masu_fail_null(detail, "normals");
    if (!data->indices) return masu_fail_null(detail, "indices");
    if (data->colors && !(scene->vertex_colors && scene->texture_arrays))
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "colors", 0, 1,
                         "mesh %u: colors are given, the scene has no vertex colours", slot);
    masu_result result =
        check_count(slot, "vertex_count", data->vertex_count, 3, room.vertices, detail);
    if (!result)
        result =
            check_count(slot, "triangle_count", data->triangle_count, 1, room.triangles, detail);
    if (!result)
        result = check_upload(
            s, plan, slot,
            masu_mesh_upload_of(scene, data->vertex_count, data->triangle_count).bytes, detail);
    if (!result) result = check_vertices(slot, data, detail);
    if (!result && scene->texture_arrays)
        result = check_numbers(slot, "texcoords", data->texcoords, 2, data->vertex_count, -REACH,
                               REACH, detail);
    if (!result)
        result =
            check_numbers(slot, "colors", data->colors, 4, data->vertex_count, 0.0f, 1.0f, detail);
    return result ? result : check_indices(slot, data, detail);
}

masu_result masu_meshes_check_vertices(const masu_meshes *s, const masu_frame_plan *plan,
                                       uint32_t slot, const masu_mesh_data *data,
                                       masu_detail *detail) {
    uint32_t count = s->meshes[slot].vertices;
    if (data->vertex_count != count)
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "vertex_count", count, data->vertex_count,
                         "mesh %u: vertex_count is %u, the mesh has %u", slot, data->vertex_count,
                         count);
    masu_result result =
        check_upload(s, plan, slot, count * (uint64_t)sizeof(masu_blob_vertex), detail);
    return result ? result : check_vertices(slot, data, detail);
}

/* ---- Conversion ------------------------------------------------------------------------------ */

static int16_t snorm(double x) { return (int16_t)lrint(x * 32767.0); }

/* Octahedral encoding; a vector of length 0 becomes +Y. */
static void encode_normal(const float n[3], int16_t out[2]) {
    double x = (double)n[0], y = (double)n[1], z = (double)n[2], sum = fabs(x) + fabs(y) + fabs(z);
    if (!(sum > 0.0)) y = sum = 1.0;
    x /= sum;
    y /= sum;
    if (z < 0.0) {
        double fold = x;
        x = (1.0 - fabs(y)) * (x < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(fold)) * (y < 0.0 ? -1.0 : 1.0);
    }
    out[0] = snorm(x);
    out[1] = snorm(y);
}

/* Also writes the box, slightly enlarged because shaders transform boxes with rounding. */
static void write_vertices(unsigned char *to, float box[6], const masu_mesh_data *data) {
    float low[3], high[3];
    memcpy(low, data->positions, sizeof low);
    memcpy(high, data->positions, sizeof high);
    for (uint32_t i = 0; i < data->vertex_count; i++) {
        const float *position = data->positions + 3 * (size_t)i;
        masu_blob_vertex v;
        memcpy(v.position, position, sizeof v.position);
        encode_normal(data->normals + 3 * (size_t)i, v.normal);
        memcpy(to + sizeof v * i, &v, sizeof v);
        for (uint32_t k = 0; k < 3; k++) {
            low[k] = fminf(low[k], position[k]);
            high[k] = fmaxf(high[k], position[k]);
        }
    }
    for (uint32_t k = 0; k < 3; k++) {
        box[k] = low[k] - 2.4e-7f * fabsf(low[k]) - 1e-37f;
        box[3 + k] = high[k] + 2.4e-7f * fabsf(high[k]) + 1e-37f;
    }
}

/* As the blob stores colours: square roots of linear red, green and blue, then alpha. */
static void write_colors(unsigned char *to, const masu_mesh_data *data) {
    for (uint32_t i = 0; i < data->vertex_count; i++) {
        const float *c = data->colors + 4 * (size_t)i;
        for (uint32_t k = 0; k < 4; k++)
            to[4 * (size_t)i + k] =
                (unsigned char)((k < 3 ? sqrtf(c[k]) : c[k]) * 255.0f + 0.5f);
    }
}

/* Builds the BVH: nodes to `to`, the order of triangles to s->order. Returns the number of
 * nodes. */
static uint32_t build(masu_meshes *s, const masu_frame_plan *plan, const masu_mesh_slot *room,
                      const masu_mesh_data *data, unsigned char *to) {
    masu_blob_trace_node *nodes = (masu_blob_trace_node *)(void *)to;
    const masu_scene_data *scene = &plan->scene;
    uint32_t first_node = scene->trace_nodes - scene->host_nodes + room->first_node;
    uint32_t first_item = scene->trace_triangles - scene->host_triangles + room->first_triangle;
    for (uint32_t t = 0; t < data->triangle_count; t++) {
        masu_trace_box *box = &s->boxes[t];
        for (uint32_t c = 0; c < 3; c++) {
            const float *p = data->positions + 3 * (size_t)data->indices[3 * (size_t)t + c];
            for (uint32_t k = 0; k < 3; k++) {
                box->low[k] = c ? fminf(box->low[k], p[k]) : p[k];
                box->high[k] = c ? fmaxf(box->high[k], p[k]) : p[k];
            }
        }
    }
    masu_trace_shape shape =
        masu_trace_tree_shape(s->boxes, data->triangle_count, 2,
                              masu_trace_top_levels(room->triangles), first_node, first_item,
                              s->order, s->work, nodes);
    (void)masu_trace_tree_fit(nodes, shape.nodes, first_node, first_item, s->order, s->boxes,
                              s->below);
    return shape.nodes;
}

static void mesh_changed(masu_host_mesh *mesh, const masu_frame_plan *plan, masu_draws *draws,
                         uint32_t slot) {
    draws->batches[draws->batch_count - plan->reserve.meshes + slot].triangles = mesh->triangles;
    mesh->due = plan->desc.frames_in_flight;
}

void masu_meshes_set(masu_meshes *s, masu_bounds *b, masu_draws *draws, const masu_frame_plan *plan,
                     uint32_t slot, const masu_mesh_data *data) {
    const masu_mesh_slot room = slot_of(plan, slot);
    const masu_mesh_upload at =
        masu_mesh_upload_of(&plan->scene, data->vertex_count, data->triangle_count);
    masu_host_mesh *mesh = &s->meshes[slot];
    unsigned char *to = s->staging + s->used;
    *mesh = (masu_host_mesh){.vertices = data->vertex_count,
                             .triangles = data->triangle_count,
                             .change = MASU_MESH_NEW,
                             .vertices_at = s->used,
                             .shape_at = s->used,
                             .at = at,
                             .has_texcoords = data->texcoords && at.colors > at.texcoords,
                             .has_colors = data->colors != NULL};
    write_vertices(to, b->meshes[masu_own_meshes(plan) + slot], data);
    if (mesh->has_texcoords)
        memcpy(to + at.texcoords, data->texcoords, 8 * (size_t)data->vertex_count);
    if (mesh->has_colors) write_colors(to + at.colors, data);
    if (plan->scene.host_nodes) mesh->nodes = build(s, plan, &room, data, to + at.nodes);
    for (uint32_t t = 0; t < data->triangle_count; t++) {
        uint32_t from = mesh->nodes ? s->order[t] : t;
        memcpy(to + at.triangles + 12 * (size_t)t, data->indices + 3 * (size_t)from, 12);
    }
    s->used += at.nodes + mesh->nodes * (uint64_t)sizeof(masu_blob_trace_node);
    mesh_changed(mesh, plan, draws, slot);
}

void masu_meshes_set_vertices(masu_meshes *s, masu_bounds *b, const masu_frame_plan *plan,
                              uint32_t slot, const masu_mesh_data *data) {
    masu_host_mesh *mesh = &s->meshes[slot];
    write_vertices(s->staging + s->used, b->meshes[masu_own_meshes(plan) + slot], data);
    mesh->vertices_at = s->used;
    mesh->stale = 1;
    if (mesh->change == MASU_MESH_SAME) mesh->change = MASU_MESH_MOVED;
    s->used += data->vertex_count * (uint64_t)sizeof(masu_blob_vertex);
}

void masu_meshes_remove(masu_meshes *s, masu_models *models, masu_instances *in,
                        masu_reflections *r, const masu_frame_plan *plan, uint32_t model) {
    uint32_t slot = model - masu_mesh_models(plan), instance = masu_mesh_instances(plan) + slot;
    masu_models_show(models, in, plan, model, 0);
    masu_handle_turn(&models->handles, model);
    masu_handle_turn(&in->handles, instance);
    masu_reflections_clear_mesh(r, plan, slot);
    s->meshes[slot] = (masu_host_mesh){0};
}

/* ---- The frame ------------------------------------------------------------------------------- */

/* The number of triangles to all draws of the frame's slot. */
static void write_count(const masu_host_mesh *mesh, const masu_frame_data *f, uint32_t slot) {
    const masu_frame_plan *plan = f->plan;
    uint32_t b = f->draws->batch_count - plan->reserve.meshes + slot;
    uint32_t lists = plan->views * (plan->occlusion ? 2 : 1), count = 3 * mesh->triangles;
    VkDrawIndexedIndirectCommand *draws =
        (VkDrawIndexedIndirectCommand *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWS) +
        f->draws->batches[b].first_draw;
    for (uint32_t l = 0; l < lists; l++) draws[(uint64_t)l * plan->draws].indexCount = count;
    if (plan->needs.picking) draws[plan->pick_draws].indexCount = count;
    for (uint32_t face = 0; face < plan->local_faces; face++)
        draws[plan->face_draws + (uint64_t)face * plan->draws].indexCount = count;
    if (!plan->occlusion) return;
    uint32_t *words = (uint32_t *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWN);
    words[plan->drawn.batches + 4 * (uint64_t)b + 3] = mesh->triangles; /* for statistics */
}

static uint32_t element(const masu_frame_plan *plan, uint64_t offset) {
    return (uint32_t)((masu_mesh_data_at(&plan->scene) + offset) / 16);
}

/* Returns the number of invocations that the job needs. */
static uint32_t write_job(const masu_meshes *s, const masu_frame_data *f, uint32_t slot,
                          unsigned char *to) {
    const masu_scene_data *scene = &f->plan->scene;
    const masu_host_mesh *mesh = &s->meshes[slot];
    const masu_mesh_slot room = slot_of(f->plan, slot);
    uint32_t job[4 * MASU_MESH_JOB_UVEC4] = {scene->vertices - scene->host_vertices +
                                                 room.first_vertex,
                                             mesh->vertices};
    uint32_t most = mesh->vertices;
    if (mesh->change != MASU_MESH_SAME) job[2] = element(f->plan, mesh->vertices_at);
    job[3] = mesh->change == MASU_MESH_MOVED && !f->cut;
    if (mesh->change == MASU_MESH_NEW) {
        uint64_t at = mesh->shape_at;
        job[4] = room.first_triangle;
        job[5] = mesh->triangles;
        job[6] = element(f->plan, at + mesh->at.triangles);
        job[7] = mesh->has_texcoords ? element(f->plan, at + mesh->at.texcoords) : 0;
        job[8] = scene->trace_nodes - scene->host_nodes + room.first_node;
        job[9] = mesh->nodes;
        job[10] = element(f->plan, at + mesh->at.nodes);
        job[11] = s->words[room.kind];
        job[12] = mesh->has_colors ? element(f->plan, at + mesh->at.colors) : 0;
        job[13] = scene->trace_triangles - scene->host_triangles + room.first_triangle;
        if (most < mesh->triangles) most = mesh->triangles;
    }
    memcpy(to, job, sizeof job);
    return most > 3 * mesh->nodes ? most : 3 * mesh->nodes;
}

/* The header of a mesh among those of skins: which nodes skin_trace.comp refits. */
static void write_refit(masu_host_mesh *mesh, const masu_frame_data *f, uint32_t slot) {
    const masu_scene_data *scene = &f->plan->scene;
    const masu_mesh_slot room = slot_of(f->plan, slot);
    int refits =
        mesh->stale && masu_has_pass(&masu_frame_rung_plan(f)->active, MASU_PASS_SKIN_TRACE);
    const uint32_t header[MASU_SKIN_HEADER_BYTES / 4] = {
        0, 0, 0, 0, scene->trace_nodes - scene->host_nodes + room.first_node,
        refits ? mesh->nodes : 0, scene->skinned_nodes - scene->host_nodes + room.first_node, 0};
    memcpy(masu_frame_slot(f, MASU_BUFFER_JOINTS) +
               (scene->skins + (size_t)slot) * MASU_SKIN_HEADER_BYTES,
           header, sizeof header);
    if (refits) mesh->stale = 0;
}

void masu_meshes_write(masu_meshes *s, const masu_frame_data *f) {
    const masu_frame_plan *plan = f->plan;
    if (!plan->reserve.meshes) return;
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_MESH_UPLOAD);
    uint32_t most = 0, jobs = 0;
    for (uint32_t i = 0; i < plan->reserve.meshes; i++) {
        masu_host_mesh *mesh = &s->meshes[i];
        if (mesh->due) write_count(mesh, f, i), mesh->due--;
        if (plan->scene.host_nodes) write_refit(mesh, f, i);
        if (mesh->change == MASU_MESH_SAME && !mesh->settles) continue;
        uint32_t needs =
            write_job(s, f, i, to + 16 * (1 + (size_t)MASU_MESH_JOB_UVEC4 * jobs++));
        if (most < needs) most = needs;
        mesh->settles = mesh->change == MASU_MESH_MOVED && !f->cut && plan->needs.velocity;
        mesh->change = MASU_MESH_SAME;
    }
    const uint32_t header[4] = {(most + 63) / 64, jobs, 1, 0};
    memcpy(to, header, sizeof header);
    memcpy(to + masu_mesh_data_at(&plan->scene), s->staging, (size_t)s->used);
    s->used = 0;
}

/* local_shadows.c: see local_shadows.h. */
#include "frame/local_shadows.h"

#include "device/bind.h"
#include "frame/shadow.h"
#include "frame/visible.h"
#include "scene/punctual_light.h"

#include <math.h>
#include <string.h>

#define NEAR_LEAST 0.05 /* metres */
#define PI 3.14159265358979323846

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ---- Once ------------------------------------------------------------------------------------ */

void masu_local_shadows_alloc(masu_local_shadows *s, masu_arena *arena,
                              const masu_frame_plan *plan) {
    int needed = plan->needs.local_shadows;
    uint32_t capacity = plan->local_lights, lights = needed ? plan->scene.lights : 0;
    uint32_t instances = needed ? plan->scene.instances : 0;
    if (capacity > MASU_SHADOW_LIGHTS_MAX) capacity = MASU_SHADOW_LIGHTS_MAX;
    s->capacity = capacity;
    s->empty = 1;
    s->choice = masu_arena_alloc(arena, "shadow slots", capacity, sizeof *s->choice, 8);
    s->wish = masu_arena_alloc(arena, "shadow wishes", capacity != 0, sizeof *s->wish, 8);
    s->lights = masu_arena_alloc(arena, "shadow faces", capacity, sizeof *s->lights, 8);
    s->slot_of_light =
        masu_arena_alloc(arena, "shadows of lights", lights, sizeof *s->slot_of_light, 4);
    s->boxes = masu_arena_alloc(arena, "previous boxes", instances, sizeof *s->boxes, 4);
    s->group_states = masu_arena_alloc(arena, "group states of faces",
                                       needed ? plan->scene.groups : 0, sizeof *s->group_states, 1);
    s->marks = masu_arena_alloc(arena, "caster marks", instances, sizeof *s->marks, 1);
}

static VkDrawIndexedIndirectCommand *draws_of(const masu_device *device, uint32_t slot,
                                              uint32_t face) {
    const masu_frame_plan *plan = device->plan;
    uint64_t at = (plan->face_draws + (uint64_t)face * plan->draws) * MASU_DRAW_BYTES;
    return (VkDrawIndexedIndirectCommand *)(void *)(masu_buffer_pointer(device, MASU_BUFFER_DRAWS,
                                                                        slot) +
                                                    at);
}

void masu_local_shadows_write_scene(const masu_device *device, const masu_draws *draws,
                                    const masu_scene_view *v) {
    const masu_frame_plan *plan = device->plan;
    if (!plan->needs.local_shadows || !draws->batch_count) return;
    for (uint32_t slot = 0; slot < plan->desc.frames_in_flight; slot++) {
        for (uint32_t face = 0; face < plan->local_faces; face++)
            (void)masu_draws_write(draws, v, plan, draws_of(device, slot, face));
    }
}

/* ---- Faces of a light ------------------------------------------------------------------------ */

/* Axes of a cube's face as local_shadow.glsl has them: across, down, ahead. */
static void cube_axes(uint32_t face, double axis[3][3]) {
    memset(axis, 0, 9 * sizeof(double));
    uint32_t major = face / 2;
    axis[0][(major + 1) % 3] = 1.0;
    axis[1][(major + 2) % 3] = 1.0;
    axis[2][major] = face % 2 ? -1.0 : 1.0;
}

/* Those of a spot's: the shader gets the first, and the second by a cross product. */
static void spot_axes(const double direction[3], double axis[3][3]) {
    masu_shadow_axes(direction, axis);
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t i = (k + 1) % 3, j = (k + 2) % 3;
        axis[1][k] = axis[2][i] * axis[0][j] - axis[2][j] * axis[0][i];
    }
}

/* False only if the whole face, within 54.74 degrees around its centre, is outside of the cone. */
int masu_local_face_is_lit(const double axis[3], double angle, uint32_t face) {
    double cosine = face % 2 ? -axis[face / 2] : axis[face / 2];
    return acos(fmin(fmax(cosine, -1.0), 1.0)) < angle + 0.9554;
}

/* The planes of all that a face sees in its tile, and the light's range. */
static void set_planes(masu_local_light *light, masu_local_face *face) {
    double guard =
        (double)MASU_LOCAL_TILE_LEAST / (double)(MASU_LOCAL_TILE_LEAST - 2 * MASU_LOCAL_GUARD);
    double slope = (light->tangent > 0.0 ? light->tangent : 1.0) * guard;
    face->view.count = 0;
    for (uint32_t plane = 0; plane < 4; plane++) {
        double n[3], sign = plane % 2 ? -1.0 : 1.0;
        for (uint32_t k = 0; k < 3; k++)
            n[k] = slope * face->axis[2][k] + sign * face->axis[plane / 2][k];
        masu_cull_add_plane(&face->view, n, -dot(n, light->position));
    }
    double back[3] = {-face->axis[2][0], -face->axis[2][1], -face->axis[2][2]};
    masu_cull_add_plane(&face->view, back, light->range - dot(back, light->position));
}

/* Gives up the set of faces that was rendered before the one of now. */
static void drop_shown(masu_local_shadows *s, masu_local_light *light) {
    for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++)
        masu_shadow_tile_give(&s->tiles, &light->shown_tiles[i]);
    light->shown = 0;
}

static uint32_t faces_of(const masu_local_light *light, uint32_t *drawn) {
    uint32_t used = 0;
    *drawn = 0;
    for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
        used += light->faces[i].used;
        *drawn += light->faces[i].used && light->faces[i].drawn;
    }
    return used;
}

/* Shows the set of faces on until the next one is there. */
static void keep_shown(masu_local_light *light) {
    for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
        light->shown_tiles[i] = light->faces[i].tile;
        memset(&light->faces[i].tile, 0, sizeof light->faces[i].tile);
    }
    memcpy(light->shown_position, light->position, sizeof light->shown_position);
    light->shown = 1;
}

/* Updates a light; its faces are due if it has changed. Returns whether it has jumped, or is
 * another light. */
static int set_light(masu_local_shadows *s, masu_local_light *light,
                     const masu_punctual_light_state *state, const double position[3],
                     const double direction[3], uint64_t frame) {
    masu_local_light now;
    memset(&now, 0, sizeof now);
    double length = sqrt(dot(direction, direction));
    /* as masu_light_place has it */
    int cone = state->spot && (double)state->inner < PI - 1e-6 && length > 0.0;
    now.angle = cone ? fmin((double)state->outer, PI) : PI;
    for (uint32_t k = 0; k < 3; k++) {
        now.position[k] = position[k];
        now.axis[k] = cone ? direction[k] / length : 0.0;
    }
    now.range = (double)state->range;
    now.near_distance = fmax(NEAR_LEAST, masu_light_solid(state));
    now.tangent = now.angle <= (double)MASU_LOCAL_ANGLE_MOST ? fmax(tan(now.angle), 1e-3) : 0.0;
    light->behind = 0;
    if (!memcmp(&now, light, offsetof(masu_local_light, size))) {
        if (light->still < MASU_LOCAL_STILL) light->still++;
        return 0;
    }
    light->still = light->range > 0.0 ? 0 : MASU_LOCAL_STILL;
    size_t after = offsetof(masu_local_light, axis);
    int same = !memcmp(now.axis, light->axis, offsetof(masu_local_light, size) - after);
    double moved[3] = {position[0] - light->position[0], position[1] - light->position[1],
                       position[2] - light->position[2]};
    int jumped = dot(moved, moved) > 0.0625 * now.range * now.range;
    uint32_t drawn, used = faces_of(light, &drawn);
    if (light->shown && same && !jumped) {
        light->behind = 1;
        return 0;
    }
    if (light->shown) drop_shown(s, light);
    else if (same && !jumped && used > 1 && drawn == used) keep_shown(light);
    memcpy(light, &now, offsetof(masu_local_light, size));
    for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
        masu_local_face *face = &light->faces[i];
        face->drawn = face->marched = 0;
        if (light->tangent > 0.0) {
            face->used = i == 0;
            spot_axes(light->axis, face->axis);
        } else {
            face->used = !cone || masu_local_face_is_lit(light->axis, light->angle, i);
            cube_axes(i, face->axis);
        }
        face->due = face->used;
        face->since = frame;
        if (face->used) set_planes(light, face);
    }
    return jumped;
}

/* ---- Choice ---------------------------------------------------------------------------------- */

static void free_slot(void *user, uint32_t slot) {
    masu_local_shadows *s = user;
    s->slot_of_light[s->choice[slot].light - 1] = 0;
    for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++)
        masu_shadow_tile_give(&s->tiles, &s->lights[slot].faces[i].tile);
    drop_shown(s, &s->lights[slot]);
    memset(&s->lights[slot], 0, sizeof s->lights[slot]);
}

static void forget(masu_local_shadows *s, const masu_frame_plan *plan) {
    memset(s->choice, 0, s->capacity * sizeof *s->choice);
    memset(s->lights, 0, s->capacity * sizeof *s->lights);
    memset(s->slot_of_light, 0, plan->scene.lights * sizeof *s->slot_of_light);
    memset(s->group_states, 0, plan->scene.groups * sizeof *s->group_states);
    masu_shadow_tiles_clear(&s->tiles, plan->local_atlas);
}

void masu_local_shadows_begin(masu_local_shadows *s, const masu_frame_data *f) {
    const masu_rung *rung = masu_frame_rung(f);
    uint32_t viewports = f->plan->desc.viewport_count ? f->plan->desc.viewport_count : 1;
    s->most = rung->local_shadows == MASU_OFF ? 0 : rung->local_shadow_lights * viewports;
    if (s->most > s->capacity) s->most = s->capacity;
    /* Without faces, casters are not tracked. */
    if (s->empty || !s->most) forget(s, f->plan);
    for (uint32_t k = 0; s->empty && k < f->plan->scene.instances; k++) s->boxes[k][3] = -1.0f;
    s->since = f->desc.cut || s->empty ? 0 : s->since + (s->since < MASU_SHADOW_CUT);
    s->empty = 0;
    if (s->capacity) s->wish->count = 0;
    for (uint32_t slot = 0; slot < s->capacity; slot++) s->choice[slot].offered = 0;
}

double masu_local_face_wish(double range, double tangent, double distance, double pixels) {
    double third = range / 3.0;
    return fmax(256.0, 2.0 * third * tangent * pixels / (0.75 * fmax(distance, third)));
}

/* A size is kept for wishes from less than half to more than twice the size. */
uint32_t masu_local_face_size(double wish, uint32_t now, uint32_t most) {
    uint32_t size = MASU_LOCAL_TILE_LEAST;
    if (now && now <= most && (wish <= 2.2 * now || now == most) &&
        (wish >= 0.45 * now || now == size))
        return now;
    while (size < most && wish > 1.4142 * size) size *= 2;
    return size;
}

/* In a frame, unless it waits already. */
static void make_due(masu_local_face *face, uint64_t frame) {
    if (!face->used || face->due) return;
    face->due = 1;
    face->since = frame;
}

static void set_wish(masu_local_light *light, const masu_frame_data *f, double distance) {
    double tangent = light->tangent > 0.0 ? light->tangent : 1.0;
    double pixels = 0.5 * (double)masu_frame_rung_plan(f)->render_height / (double)f->u.up[3];
    double wish = masu_local_face_wish(light->range, tangent, distance, pixels);
    light->wish = masu_local_face_size(wish, light->wish, f->plan->local_tile);
}

void masu_local_shadows_offer(masu_local_shadows *s, const masu_frame_data *f, uint32_t light,
                              const masu_punctual_light_state *state, const double position[3],
                              const double direction[3]) {
    struct masu_punctual_light_data placed;
    double rel[3];
    uint32_t slot = s->slot_of_light[light];
    if (!s->most) return;
    for (uint32_t k = 0; k < 3; k++) rel[k] = position[k] - f->eye[k];
    /* a lamp that is off keeps its slot until another one needs it */
    masu_punctual_light_state lit = *state;
    if (slot) lit.color[0] = fmaxf(lit.color[0], 1e-30f);
    if (!masu_light_place(&lit, rel, direction, &placed)) return;
    double distance = sqrt(dot(rel, rel));
    double center[3] = {(double)placed.bound[0], (double)placed.bound[1], (double)placed.bound[2]};
    double score = masu_shadow_score(masu_light_intensity(state, direction),
                                     (double)placed.bound[3], sqrt(dot(center, center)));
    if (masu_light_outside(placed.bound, f->u.clip_from_rel)) score *= MASU_SHADOW_UNSEEN;
    if (slot) {
        score *= MASU_SHADOW_HYSTERESIS;
        s->choice[slot - 1].offered = 1;
        s->choice[slot - 1].score = score;
        if (set_light(s, &s->lights[slot - 1], state, position, direction, f->number))
            s->choice[slot - 1].fade = 0;
        set_wish(&s->lights[slot - 1], f, distance);
    }
    masu_shadow_wish_add(s->wish, s->most, light + 1, score);
}

/* ---- Moved casters --------------------------------------------------------------------------- */

static int touches(const masu_local_light *light, const masu_local_face *face, const float box[6]) {
    double outside = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        double apart = fmax(fabs((double)box[k] - light->position[k]) - (double)box[3 + k], 0.0);
        outside += apart * apart;
    }
    if (outside > light->range * light->range * 1.0001) return 0;
    for (uint32_t p = 0; p < face->view.count; p++) {
        const masu_cull_plane *plane = &face->view.planes[p];
        double m = (double)plane->d, r = (double)plane->slack[0];
        for (uint32_t k = 0; k < 3; k++) {
            m += (double)plane->n[k] * (double)box[k];
            r += (double)plane->a[k] * (double)box[3 + k];
        }
        if (m + r < 0.0) return 0;
    }
    return 1;
}

static void touch_faces(masu_local_shadows *s, const float box[6], uint64_t frame) {
    if (box[3] < 0.0f) return;
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        if (!s->choice[slot].light) continue;
        masu_local_light *light = &s->lights[slot];
        for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
            masu_local_face *face = &light->faces[i];
            if (face->used && !face->due && touches(light, face, box)) make_due(face, frame);
        }
    }
}

static int casts(const masu_instances *in, uint32_t i) {
    return !masu_instance_hidden(in, i) && !masu_look_shadowless(&in->looks, i);
}

static void follow_casters(masu_local_shadows *s, const masu_instances *in,
                           const masu_bounds *bounds, const masu_frame_data *f) {
    for (uint32_t i = 0; in->dirty_count && i < f->plan->scene.instances; i++) {
        if (!masu_instance_moved(in, f->plan, i)) continue;
        touch_faces(s, s->boxes[i], f->number);
        masu_bounds_of(bounds, i, s->boxes[i]);
        if (!casts(in, i)) s->boxes[i][3] = -1.0f;
        touch_faces(s, s->boxes[i], f->number);
    }
}

/* Treats the SDF as one caster that moves whenever its inputs change. */
static void follow_sdf(masu_local_shadows *s, const masu_frame_data *f) {
    s->sdf_box[3] = -1.0f;
    if (!f->plan->needs.sdf_casts) return;
    for (uint32_t k = 0; k < 3; k++) {
        double low = (double)f->u.sdf_low[k] + f->eye[k],
               high = (double)f->u.sdf_high[k] + f->eye[k];
        s->sdf_box[k] = (float)(0.5 * (low + high));
        s->sdf_box[3 + k] = (float)(0.5 * (high - low) * 1.0001);
    }
    uint64_t hash = masu_fnv1a64(f->u.anchor, 3 * sizeof *f->u.anchor);
    if (f->plan->needs.moving) {
        hash ^= masu_fnv1a64(f->u.sdf_params, sizeof f->u.sdf_params);
    }
    if (f->plan->needs.timed)
        hash = hash * 31 + masu_fnv1a64(&f->u.eye_hi[3], sizeof f->u.eye_hi[3]);
    for (uint32_t i = 0; hash != s->sdf_hash && i < s->capacity * MASU_LOCAL_FACES; i++)
        s->lights[i / MASU_LOCAL_FACES].faces[i % MASU_LOCAL_FACES].marched = 0;
    if (hash != s->sdf_hash) touch_faces(s, s->sdf_box, f->number);
    s->sdf_hash = hash;
}

static int sdf_reaches(const masu_local_shadows *s, const masu_local_light *light,
                       const masu_local_face *face) {
    return s->sdf_box[3] >= 0.0f && touches(light, face, s->sdf_box);
}

/* ---- Rendering ------------------------------------------------------------------------------- */

/* Writes the casters of a face, always the finest LOD, into the lists and counts of the frame's
 * slot. Returns their number. */
static uint32_t list_casters(masu_local_shadows *s, const masu_instances *in,
                             const masu_bounds *bounds, const masu_frame_data *f,
                             const masu_local_light *light, const masu_local_face *face,
                             uint32_t number) {
    const masu_scene_data *scene = &f->plan->scene;
    if (!f->plan->needs.raster) return 0;
    masu_cull_set set = masu_bounds_set(bounds, scene);
    masu_cull_counts counts = {0, 0};
    masu_cull(&set, &face->view, s->group_states, s->marks, 1, &counts);
    /* Never read: upload memory may be write-combined. */
    VkDrawIndexedIndirectCommand *draws = draws_of(f->device, f->slot, number);
    uint32_t *ids = (uint32_t *)(void *)masu_frame_slot(f, MASU_BUFFER_DRAWN) +
                    f->plan->drawn.faces + (uint64_t)number * f->plan->listed;
    uint32_t all = 0;
    for (uint32_t b = 0, forms; b < f->draws->batch_count; b += forms) {
        const masu_batch *mesh = &f->draws->batches[b];
        uint32_t kept = 0, end = mesh->first_instance + mesh->instance_count;
        forms = 1 + mesh->lod_count;
        for (uint32_t i = mesh->first_instance; i < end; i++) {
            if (s->marks[i] && touches(light, face, s->boxes[i]) && casts(in, i))
                ids[mesh->first_listed + kept++] = i;
        }
        for (uint32_t i = masu_instances_added(in, mesh->mesh); i != MASU_BLOB_NONE;
             i = masu_instances_next(in, i)) {
            if (s->marks[i] && touches(light, face, s->boxes[i]) && casts(in, i))
                ids[mesh->first_listed + kept++] = i;
        }
        for (uint32_t level = 0; level < forms; level++) {
            for (uint32_t d = 0; d < mesh[level].draw_count; d++)
                draws[mesh[level].first_draw + d].instanceCount = level ? 0 : kept;
        }
        if (mesh->blended < mesh->draw_count) all += kept;
    }
    return all;
}

static void clear_draws(const masu_frame_data *f, uint32_t number) {
    if (!f->plan->needs.raster) return;
    VkDrawIndexedIndirectCommand *draws = draws_of(f->device, f->slot, number);
    for (uint32_t d = 0; d < f->plan->draws; d++) draws[d].instanceCount = 0;
}

static void write_face(const masu_local_light *light, const masu_local_face *face,
                       const double origin[3], uint32_t square, uint32_t number,
                       struct masu_local_face_uniforms *u) {
    double edge = face->tile.size, slope = light->tangent > 0.0 ? light->tangent : 1.0;
    double part = edge / square, width = 2.0 * slope / (edge - 2.0 * MASU_LOCAL_GUARD);
    for (uint32_t k = 0; k < 3; k++) {
        u->row0[number][k] = (float)face->axis[0][k];
        u->row1[number][k] = (float)face->axis[1][k];
        u->row2[number][k] = (float)face->axis[2][k];
        masu_split_double(light->position[k] - origin[k], &u->origin_hi[number][k],
                          &u->origin_lo[number][k]);
    }
    u->row0[number][3] = (float)(2.0 / (width * square)); /* from slopes to -1..1 of the square */
    u->row1[number][3] = (float)(part - 1.0);
    u->row2[number][3] = (float)light->near_distance;
    u->origin_hi[number][3] = (float)width;
    u->origin_lo[number][3] = (float)light->range;
    u->tile[number][0] = face->tile.x;
    u->tile[number][1] = face->tile.y;
    u->tile[number][2] = face->tile.size;
}

/* Those of the pass that marches the SDF go over all such faces of the frame. */
static void take_groups(masu_local_face *face, uint32_t number,
                        struct masu_local_face_uniforms *u) {
    u->tile[number][3] = face->marched ? 1 : 2;
    if (face->marched) return;
    face->marched = 1;
    uint32_t across = (face->tile.size + MASU_GROUP - 1) / MASU_GROUP;
    if (u->groups[0] < across) u->groups[0] = u->groups[1] = across;
    u->groups[2] = number + 1;
}

/* Finds a tile of the wanted size or smaller; keeps the present tile if the size is unchanged.
 * 0: the atlas is full. */
static int find_tile(masu_local_shadows *s, masu_local_light *light, masu_local_face *face) {
    if (!face->moves && face->tile.size == light->size) return 1;
    face->marched = 0;
    if (face->moves) {
        masu_shadow_tile_move(&s->tiles, &face->tile);
        return 1;
    }
    /* Its own becomes free in the same frame, in which it is read no more. */
    masu_shadow_tile_give(&s->tiles, &face->tile);
    for (uint32_t size = light->size; size >= MASU_LOCAL_TILE_LEAST && !face->tile.size; size /= 2)
        face->tile = masu_shadow_tile_take(&s->tiles, size);
    if (face->tile.size || !light->shown) return face->tile.size != 0;
    drop_shown(s, light); /* no room for both sets */
    return find_tile(s, light, face);
}

/* Chooses sizes that fit the atlas together. Faces that have a size get a higher score, so that
 * lights of equal score do not swap. */
static void fit_sizes(masu_local_shadows *s, const masu_frame_data *f) {
    uint32_t sizes[MASU_SHADOW_LIGHTS_MAX], faces[MASU_SHADOW_LIGHTS_MAX];
    double scores[MASU_SHADOW_LIGHTS_MAX];
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        const masu_local_light *light = &s->lights[slot];
        sizes[slot] = light->wish;
        if (light->still < MASU_LOCAL_STILL && sizes[slot] > MASU_LOCAL_TILE_MOVES)
            sizes[slot] = MASU_LOCAL_TILE_MOVES;
        uint32_t drawn;
        faces[slot] = faces_of(light, &drawn);
        /* one set is shown, one rendered */
        if (light->still < MASU_LOCAL_STILL && faces[slot] > 1) faces[slot] *= 2;
        scores[slot] =
            s->choice[slot].score * (light->size >= light->wish ? MASU_SHADOW_HYSTERESIS : 1.0);
    }
    masu_shadow_sizes_fit(sizes, faces, scores, s->capacity, f->plan->local_atlas);
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        masu_local_light *light = &s->lights[slot];
        for (uint32_t i = 0; i < MASU_LOCAL_FACES && light->size != sizes[slot]; i++) {
            masu_local_face *face = &light->faces[i];
            if (face->tile.size && face->tile.size != sizes[slot]) make_due(face, f->number);
        }
        light->size = sizes[slot];
    }
}

/* When no face is due: a face with too small a tile gets one of its size, else the last tile
 * that can move is moved forward. Each move is towards the start of the atlas, so the moves
 * terminate. */
static void join_tiles(masu_local_shadows *s, const masu_frame_data *f) {
    masu_local_face *small = NULL, *last = NULL;
    uint32_t size = 0;
    for (uint32_t i = 0; i < s->capacity * MASU_LOCAL_FACES; i++) {
        masu_local_face *face = &s->lights[i / MASU_LOCAL_FACES].faces[i % MASU_LOCAL_FACES];
        uint32_t wanted = s->lights[i / MASU_LOCAL_FACES].size;
        if (face->due) return;
        if (!small && face->tile.size && face->tile.size < wanted) small = face, size = wanted;
    }
    if (!small) return;
    masu_shadow_tiles without = s->tiles;
    masu_shadow_tile own = small->tile;
    masu_shadow_tile_give(&without, &own);
    if (masu_shadow_tile_take(&without, size).size) {
        make_due(small, f->number);
        return;
    }
    for (uint32_t i = 0; i < s->capacity * MASU_LOCAL_FACES; i++) {
        masu_local_face *face = &s->lights[i / MASU_LOCAL_FACES].faces[i % MASU_LOCAL_FACES];
        if (last && masu_shadow_tile_order(face->tile) < masu_shadow_tile_order(last->tile))
            continue;
        if (masu_shadow_tile_before(&s->tiles, face->tile).size) last = face;
    }
    if (!last) return;
    make_due(last, f->number);
    last->moves = 1;
}

/* Tests the bounding sphere of a cube face's range: a moving point light may have more faces
 * than the budget. */
static void find_seen(masu_local_shadows *s, const masu_frame_data *f) {
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        const masu_local_light *light = &s->lights[slot];
        for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
            masu_local_face *face = &s->lights[slot].faces[i];
            float bound[4] = {0, 0, 0, (float)(0.8166 * light->range)};
            if (!face->due) continue;
            for (uint32_t k = 0; k < 3; k++)
                bound[k] = (float)(light->position[k] - f->eye[k] +
                                   0.5774 * light->range * face->axis[2][k]);
            face->seen =
                (uint8_t)(light->tangent > 0.0 || !masu_light_outside(bound, f->u.clip_from_rel));
        }
    }
}

/* The face that waits for longest; MASU_LOCAL_FACES * capacity: none is due. */
static uint32_t next_due(const masu_local_shadows *s, const uint8_t *skip) {
    uint32_t none = s->capacity * MASU_LOCAL_FACES, best = none;
    for (uint32_t i = 0; i < none; i++) {
        const masu_local_face *face = &s->lights[i / MASU_LOCAL_FACES].faces[i % MASU_LOCAL_FACES];
        if (!face->due || skip[i]) continue;
        if (best != none) {
            const masu_local_face *other =
                &s->lights[best / MASU_LOCAL_FACES].faces[best % MASU_LOCAL_FACES];
            double score = s->choice[i / MASU_LOCAL_FACES].score,
                   than = s->choice[best / MASU_LOCAL_FACES].score;
            if (face->since != other->since ? face->since > other->since
                : face->seen != other->seen ? face->seen < other->seen
                                            : score <= than)
                continue;
        }
        best = i;
    }
    return best;
}

/* Initializes new slots. */
static void place_lights(masu_local_shadows *s) {
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        if (s->choice[slot].light) s->slot_of_light[s->choice[slot].light - 1] = slot + 1;
    }
}

static void set_ready(masu_local_shadows *s, masu_local_slot *stats) {
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        int ready = s->choice[slot].light && s->lights[slot].size;
        for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
            const masu_local_face *face = &s->lights[slot].faces[i];
            ready = ready && (!face->used || face->drawn || s->lights[slot].shown);
            stats->waiting += face->due;
        }
        stats->waiting += s->lights[slot].behind;
        /* it has its slot since this frame */
        stats->waiting += s->choice[slot].light && !s->lights[slot].size;
        s->choice[slot].ready = ready;
        stats->lights += s->choice[slot].light != 0;
    }
}

/* A hash of the fade factors: differs as soon as one differs, except for collisions. */
static uint32_t faded(const masu_local_shadows *s) {
    uint32_t sum = 0;
    for (uint32_t slot = 0; slot < s->capacity; slot++) sum = 31 * sum + s->choice[slot].fade;
    return sum;
}

int masu_local_shadows_write(masu_local_shadows *s, const masu_instances *in,
                             const masu_bounds *bounds, masu_frame_data *f) {
    masu_local_slot *stats = &s->slots[f->slot];
    uint32_t budget = s->most ? masu_frame_rung(f)->local_shadow_faces : 0, number = 0;
    uint8_t skip[MASU_SHADOW_LIGHTS_MAX * MASU_LOCAL_FACES];
    struct masu_local_face_uniforms out;
    memset(stats, 0, sizeof *stats);
    memset(&out, 0, sizeof out);
    memset(skip, 0, sizeof skip);
    uint32_t before = faded(s), changed = 0;
    masu_shadow_choose(s->choice, s->capacity, s->most, s->wish, s->since, free_slot, s);
    place_lights(s);
    fit_sizes(s, f);
    follow_casters(s, in, bounds, f);
    follow_sdf(s, f);
    find_seen(s, f);
    join_tiles(s, f);
    /* Faces in which nothing is cost no rendering, but they have to be found out. */
    for (uint32_t looked = 0; number < budget && looked < 4 * budget; looked++) {
        uint32_t i = next_due(s, skip);
        if (i == s->capacity * MASU_LOCAL_FACES) break;
        masu_local_light *light = &s->lights[i / MASU_LOCAL_FACES];
        masu_local_face *face = &light->faces[i % MASU_LOCAL_FACES];
        skip[i] = 1;
        int reached = sdf_reaches(s, light, face);
        if (!list_casters(s, in, bounds, f, light, face, number) && !reached) {
            masu_shadow_tile_give(&s->tiles, &face->tile);
        } else if (find_tile(s, light, face)) {
            if (reached) take_groups(face, number, &out);
            write_face(light, face, f->origin, f->plan->local_tile, number++, &out);
        } else {
            face->drawn = 0;
            continue;
        }
        face->due = face->moves = 0;
        face->drawn = 1;
        changed = 1;
    }
    stats->faces = number;
    for (uint32_t slot = 0; slot < s->capacity; slot++) {
        uint32_t drawn, used = faces_of(&s->lights[slot], &drawn);
        if (s->lights[slot].shown && drawn == used) drop_shown(s, &s->lights[slot]);
    }
    set_ready(s, stats);
    f->faces = number != 0;
    changed |= faded(s) != before;
    if (!f->faces) return (int)changed; /* the recording without the passes that read the rest */
    for (uint32_t k = number; k < f->plan->local_faces; k++) clear_draws(f, k);
    out.square[0] = f->plan->local_tile;
    out.square[1] = f->plan->local_faces < 4 ? f->plan->local_faces : 4;
    out.square[2] = f->plan->local_atlas;
    out.square[3] = number;
    memcpy(masu_frame_slot(f, MASU_BUFFER_LOCAL_FACES), &out, sizeof out);
    return 1;
}

void masu_local_shadows_of(const masu_local_shadows *s, uint32_t light, const double eye[3],
                           struct masu_punctual_light_data *out) {
    uint32_t slot = s->slot_of_light[light];
    if (!slot || !s->choice[slot - 1].fade) return;
    const masu_local_light *of = &s->lights[slot - 1];
    uint32_t words[8] = {0};
    for (uint32_t i = 0; i < MASU_LOCAL_FACES; i++) {
        const masu_local_face *face = &of->faces[i];
        uint32_t log = 0;
        masu_shadow_tile tile = of->shown ? of->shown_tiles[i] : face->tile;
        if (!face->used || !(face->drawn || of->shown) || !tile.size) continue;
        while (1u << log < tile.size) log++;
        words[i] = log | s->choice[slot - 1].fade << MASU_LOCAL_FADE_SHIFT |
                   (uint32_t)(tile.y / 8) << MASU_LOCAL_Y_SHIFT |
                   (uint32_t)(tile.x / 8) << MASU_LOCAL_X_SHIFT;
    }
    float across[3] = {(float)of->faces[0].axis[0][0], (float)of->faces[0].axis[0][1],
                       (float)of->faces[0].axis[0][2]};
    if (of->tangent > 0.0 && words[0]) memcpy(&words[1], across, sizeof across);
    float near_distance = (float)of->near_distance, tangent = (float)of->tangent;
    memcpy(&words[6], &near_distance, sizeof near_distance);
    memcpy(&words[7], &tangent, sizeof tangent);
    memcpy(out->shadow, words, sizeof words);
    for (uint32_t k = 0; k < 3; k++)
        out->shadow_origin[k] =
            (float)((of->shown ? of->shown_position : of->position)[k] - eye[k]);
}

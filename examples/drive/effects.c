/* effects.c: see effects.h.
 *
 * All is deterministic: random numbers are hashes of counters, so the same script gives the same
 * images. */
#include "effects.h"

#define SKIDS 0.3       /* car.skid from which a tyre leaves a mark and smokes */
#define MARK_LENGTH 0.4 /* metres of a quad, at least */
#define MARK_HALF 0.1   /* half its width */
#define MARK_LIFT 0.012 /* metres above the road, which is not quite a plane */
#define SMOKE 45.0      /* puffs per second of a car that skids */
#define SPRAY 30.0      /* of one that drives fast in the rain */
#define NEAR 150.0      /* metres from the camera within which cars smoke */
#define RAIN_BOX 14.0   /* metres: edge of the cube around the camera that has the drops */
#define SHUTTER 0.014   /* seconds that a drop's streak lasts */

static double noise(uint32_t x, uint32_t y) {
    uint32_t h = x * 2654435761u ^ (y + 1) * 2246822519u;
    h = (h ^ h >> 15) * 739982445u;
    h = (h ^ h >> 12) * 695872825u;
    return (double)((h ^ h >> 15) & 0xFFFFFF) / 0xFFFFFF;
}

static double cloud(double x, double y, uint32_t seed) {
    double sum = 0;
    for (int octave = 0; octave < 4; octave++, x *= 2, y *= 2) {
        double fx = x - floor(x), fy = y - floor(y);
        uint32_t i = (uint32_t)floor(x) + 977 * seed, k = (uint32_t)floor(y);
        fx *= fx * (3 - 2 * fx), fy *= fy * (3 - 2 * fy);
        double top = noise(i, k) + fx * (noise(i + 1, k) - noise(i, k));
        double low = noise(i, k + 1) + fx * (noise(i + 1, k + 1) - noise(i, k + 1));
        sum += (top + fy * (low - top)) / (2 << octave);
    }
    return sum;
}

/* Cells 0 to 14 are puffs of smoke, cell 15 is the streak of a drop. */
static void paint(uint8_t *atlas) {
    const int side = ATLAS / 4;
    for (int i = 0; i < ATLAS * ATLAS; i++) {
        int x = i % ATLAS, y = i / ATLAS, cell = x / side + 4 * (y / side);
        double u = (x % side + 0.5) / side * 2 - 1, v = (y % side + 0.5) / side * 2 - 1;
        double gray = 1, alpha = (1 - u * u) * (1 - v * v);
        if (cell < 15) {
            double c = cloud(2 * u + 4, 2 * v + 4, (uint32_t)cell), edge = 1 - hypot(u, v);
            alpha = clamp(2.2 * edge * (0.35 + c), 0, 1) * clamp(8 * edge, 0, 1);
            gray = 0.75 + 0.4 * c;
        }
        for (int k = 0; k < 3; k++) atlas[4 * i + k] = (uint8_t)(255 * clamp(gray, 0, 1));
        atlas[4 * i + 3] = (uint8_t)(255 * alpha);
    }
}

void effects_open(effects *e) {
    static const uint32_t corners[6] = {0, 1, 2, 0, 2, 3};
    for (uint32_t i = 0; i < MARK_QUADS * 6; i++)
        e->indices[i / 6][i % 6] = i / 6 * 4 + corners[i % 6];
    paint(e->atlas);
}

void effects_reserve(const masu_scene *scene, masu_reserve *reserve) {
    int32_t material = masu_scene_find(scene, MASU_SCENE_MATERIAL, "skid");
    reserve->particles = PUFFS;
    reserve->trail_points = 2 * DROPS;
    reserve->textures = 1;
    reserve->texture_size = (VkExtent2D){ATLAS, ATLAS};
    if (material < 0) return;
    /* mesh_upload is 0: one mesh per frame is enough. */
    reserve->meshes[0] = (masu_mesh_kind){.meshes = MARK_CHUNKS,
                                          .material = (uint32_t)material,
                                          .vertices = 4 * MARK_QUADS,
                                          .triangles = 2 * MARK_QUADS};
}

void effects_reset(effects *e, const masu_scene *scene) {
    e->has_marks = masu_scene_find(scene, MASU_SCENE_MATERIAL, "skid") >= 0;
    e->atlas_written = false;
    for (int i = 0; i < MARK_CHUNKS; i++)
        e->marks[i].model.id = 0, e->marks[i].dirty = e->marks[i].quads > 0;
}

/* ---- skid marks ------------------------------------------------------------------------------ */

static void add_quad(effects *e, const mark_wheel *from, const mark_wheel *to) {
    mark_chunk *c = &e->marks[e->chunk];
    if (c->quads == MARK_QUADS) {
        e->chunk = (e->chunk + 1) % MARK_CHUNKS;
        c = &e->marks[e->chunk], c->quads = 0;
    }
    const vec corners[4] = {from->left, from->right, to->right, to->left};
    for (uint32_t k = 0; k < 4; k++) {
        vec at = corners[k], up = k < 2 ? from->up : to->up;
        float *p = c->positions[4 * c->quads + k], *n = c->normals[4 * c->quads + k];
        p[0] = (float)at.x, p[1] = (float)at.y, p[2] = (float)at.z;
        n[0] = (float)up.x, n[1] = (float)up.y, n[2] = (float)up.z;
    }
    c->quads++, c->dirty = true;
}

/* The tyre's contact with the road, and a line through it across the way that the car moves. */
static void extend_mark(effects *e, const car *c, const track_wheel *w, mark_wheel *m) {
    vec right = cross(c->ahead, c->up), at = add(c->at, c->ahead, w->ahead);
    vec way = add(c->velocity, c->up, -dot(c->velocity, c->up));
    at = add(add(at, right, w->right), c->up, MARK_LIFT);
    if (c->off || c->skid < SKIDS || dot(way, way) < 0.01) {
        m->on = false;
        return;
    }
    vec across = cross(unit(way), c->up);
    mark_wheel end = {true, add(at, across, -MARK_HALF), add(at, across, MARK_HALF), c->up};
    vec step = add(end.left, m->left, -1);
    if (m->on && dot(step, step) < MARK_LENGTH * MARK_LENGTH) return;
    if (m->on) add_quad(e, m, &end);
    *m = end;
}

/* Creates or replaces at most one mesh: desc.reserve.mesh_upload allows one per frame. Marks are
 * static, so they are replaced, not deformed: their velocity is always 0. */
static masu_result upload_marks(effects *e, masu_renderer *masu, masu_detail *detail) {
    static const float rows[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const masu_look look = {.flags = MASU_LOOK_NO_SHADOW | MASU_LOOK_NOT_TRACED};
    for (int i = 0; i < MARK_CHUNKS; i++) {
        mark_chunk *c = &e->marks[i];
        if (!c->dirty || !e->has_marks) continue;
        const masu_mesh_data data = {.positions = c->positions[0],
                                     .normals = c->normals[0],
                                     .indices = e->indices[0],
                                     .vertex_count = 4 * c->quads,
                                     .triangle_count = 2 * c->quads};
        c->dirty = false;
        if (c->model.id) return masu_mesh_replace(masu, c->model, &data, detail);
        masu_result result = masu_mesh_create(masu, 0, &data, rows, &c->model, detail);
        return result ? result : masu_model_set_look(masu, c->model, &look, detail);
    }
    return MASU_OK;
}

/* ---- smoke, spray and rain ------------------------------------------------------------------- */

static double chance(effects *e) { return noise(e->random++, 7); }

/* At a rear wheel, left or right. */
static void add_puff(effects *e, const car *c, const track_wheel *w, bool smoke) {
    puff *p = &e->puffs[e->next_puff++ % PUFFS];
    vec right = cross(c->ahead, c->up), at = add(c->at, c->ahead, w->ahead - 0.3 * chance(e));
    double side = (e->next_puff & 1 ? w->right : -w->right) + 0.3 * (chance(e) - 0.5);
    at = add(add(at, right, side), c->up, 0.15);
    vec drift = {chance(e) - 0.5, smoke ? 0.5 + 0.6 * chance(e) : 1.2, chance(e) - 0.5};
    *p = (puff){.at = at,
                .velocity = add(drift, c->velocity, smoke ? 0.25 : 0.55),
                .life = (float)((smoke ? 1.2 : 0.4) + 0.6 * chance(e)),
                .size = smoke ? 0.3f : 0.25f,
                .turn = (float)(2 * PI * chance(e)),
                .gray = c->off ? 0.35f : 0.8f,
                .opacity = smoke ? (float)(0.5 * c->skid) : 0.18f,
                .cell = (int)(14.99 * chance(e))};
}

void effects_step(effects *e, const race *r, double dt, bool rain) {
    for (int i = 0; i < PUFFS; i++) {
        puff *p = &e->puffs[i];
        p->at = add(p->at, p->velocity, dt), p->age += (float)dt;
        p->velocity = add(p->velocity, p->velocity, exp(-1.5 * dt) - 1);
    }
    for (int i = 0; i < r->track->cars; i++) {
        const car *c = &r->cars[i];
        const track_car *t = &r->track->car[i];
        vec from = add(c->at, r->eye, -1);
        bool near = dot(from, from) < NEAR * NEAR, smoke = c->skid >= SKIDS;
        double rate = smoke ? SMOKE : rain && car_speed(c) > 8 ? SPRAY : 0;
        e->due[i] = near ? fmin(e->due[i] + rate * dt, 12) : 0;
        for (int k = 0; k < t->wheels; k++)
            if (!t->wheel[k].steers) extend_mark(e, c, &t->wheel[k], &e->wheels[i][k]);
        for (; t->wheels && e->due[i] >= 1; e->due[i]--)
            add_puff(e, c, &t->wheel[t->wheels - 1], smoke);
    }
}

static void cell_of(int cell, float uv[4]) {
    uv[0] = 0.25f * (float)(cell % 4), uv[1] = 0.25f * (float)(cell / 4);
    uv[2] = uv[0] + 0.25f, uv[3] = uv[1] + 0.25f;
}

static uint32_t list_puffs(effects *e) {
    uint32_t count = 0;
    for (int i = 0; i < PUFFS; i++) {
        const puff *p = &e->puffs[i];
        float left = 1 - p->age / fmaxf(p->life, 1e-3f);
        if (p->life == 0 || left <= 0) continue;
        masu_particle *out = &e->particles[count++];
        *out = (masu_particle){.position = {p->at.x, p->at.y, p->at.z},
                               .half_width = p->size + 1.1f * p->age,
                               .rotation = p->turn + 0.4f * p->age,
                               .color = {p->gray, p->gray, p->gray},
                               .opacity = p->opacity * left * fminf(8 * p->age + 0.2f, 1),
                               .soft = 0.4f,
                               .flags = MASU_PARTICLE_LIT,
                               .texture = 1};
        cell_of(p->cell, out->uv);
    }
    return count;
}

/* Drops fall through a cube around the camera: a drop that leaves it enters on the other side. A
 * streak is as long as the drop moves relative to the camera during the exposure. */
static uint32_t list_drops(effects *e, const race *r, double time) {
    const vec fall = {1.2, -9, 0.6}, step = add(r->cars[0].velocity, fall, -1);
    for (uint32_t i = 0; i < DROPS; i++) {
        double at[3] = {fall.x * time - r->eye.x, fall.y * time - r->eye.y,
                        fall.z * time - r->eye.z};
        for (uint32_t k = 0; k < 3; k++)
            at[k] = remainder(at[k] + RAIN_BOX * noise(i, k), RAIN_BOX);
        vec far = {at[0], at[1], at[2]}, p = add(far, r->eye, 1), tail = add(p, step, SHUTTER);
        const masu_trail_point point = {.position = {p.x, p.y, p.z},
                                        .half_width = 0.01f,
                                        .color = {3, 3, 3}, /* drops show the sky behind you */
                                        .opacity = (float)clamp(dot(far, far) / 16 - 0.2, 0, 0.5)};
        e->points[i][0] = e->points[i][1] = point;
        double *end = e->points[i][1].position;
        end[0] = tail.x, end[1] = tail.y, end[2] = tail.z;
        e->trails[i] = (masu_trail){.points = e->points[i], .point_count = 2,
                                    .flags = MASU_PARTICLE_LIT, .soft = 0.1f, .texture = 1};
        cell_of(15, e->trails[i].uv);
    }
    return DROPS;
}

masu_result effects_frame(effects *e, masu_renderer *masu, const race *r, bool rain,
                          masu_frame_desc *frame, masu_detail *detail) {
    masu_result result = MASU_OK;
    if (!e->atlas_written) result = masu_texture_write(masu, 1, NULL, e->atlas, 0, detail);
    if (!result) result = upload_marks(e, masu, detail);
    e->atlas_written = true;
    frame->particles = e->particles, frame->particle_count = list_puffs(e);
    frame->trails = e->trails, frame->trail_count = rain ? list_drops(e, r, frame->time) : 0;
    return result;
}

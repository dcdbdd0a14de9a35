/* sprites.c: see sprites.h. */
#include "frame/sprites.h"

#include "frame/sprite_kinds.h"

#include "base/error.h"

#include <string.h>

_Static_assert(sizeof(VkDrawIndirectCommand) == sizeof(masu_vec4), "a command is a vec4");
_Static_assert(MASU_SPRITE_LIT == MASU_PARTICLE_LIT &&
                   MASU_SPRITE_ADDITIVE == MASU_PARTICLE_ADDITIVE &&
                   MASU_SPRITE_ROUND == MASU_DECAL_ROUND &&
                   MASU_SPRITE_KEEP_COLOR == MASU_DECAL_KEEP_COLOR &&
                   MASU_SPRITE_ON_TOP == MASU_LINE_ON_TOP,
               "shaders know them by other names");

void masu_sprites_alloc(masu_sprites *s, masu_arena *arena, const masu_frame_plan *plan) {
    const masu_reserve *r = &plan->desc.reserve;
    s->order =
        masu_arena_alloc(arena, "particles sorted", 2 * ((uint64_t)r->particles + r->trail_points),
                         sizeof *s->order, 4);
}

static masu_result too_many(const char *what, uint64_t count, uint32_t room, masu_detail *detail) {
    return masu_fail(detail, MASU_ERROR_LIMIT, what, count, room,
                     "%s: the frame needs %llu, the limit is %u", what, (unsigned long long)count,
                     room);
}

static masu_result check(const char *what, const void *array, uint32_t count, uint32_t room,
                         masu_detail *detail) {
    if (count > room) return too_many(what, count, room, detail);
    if (!count || array) return MASU_OK;
    const char *name = what + strlen("reserve.");
    return masu_fail(detail, MASU_ERROR_ARGUMENT, name, count, 0, "%s is NULL, but there are %u",
                     name, count);
}

static masu_result check_texture(const masu_desc *d, const char *what, uint32_t index,
                                 uint32_t texture, masu_detail *detail) {
    if (texture <= d->reserve.textures) return MASU_OK;
    return masu_fail(detail, MASU_ERROR_LIMIT, "reserve.textures", texture, d->reserve.textures,
                     "reserve.textures: %s[%u].texture is %u, the last texture is %u", what, index,
                     texture, d->reserve.textures);
}

static masu_result check_trails(const masu_desc *d, const masu_frame_desc *frame,
                                masu_detail *detail) {
    uint64_t points = 0;
    if (frame->trail_count && !frame->trails) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "trails", frame->trail_count, 0,
                         "trails is NULL, but there are %u", frame->trail_count);
    }
    for (uint32_t i = 0; i < frame->trail_count; i++) {
        const masu_trail *t = &frame->trails[i];
        points += t->point_count;
        if (points > d->reserve.trail_points)
            return too_many("reserve.trail_points", points, d->reserve.trail_points, detail);
        if (t->point_count && !t->points) {
            return masu_fail(detail, MASU_ERROR_ARGUMENT, "trails", t->point_count, 0,
                             "trails[%u].points is NULL, but there are %u", i, t->point_count);
        }
        masu_result result = check_texture(d, "trails", i, t->texture, detail);
        if (result) return result;
    }
    return MASU_OK;
}

masu_result masu_sprites_check(const masu_desc *d, const masu_frame_desc *frame,
                               masu_detail *detail) {
    const masu_reserve *r = &d->reserve;
    masu_result result =
        check("reserve.particles", frame->particles, frame->particle_count, r->particles, detail);
    if (!result)
        result = check("reserve.decals", frame->decals, frame->decal_count, r->decals, detail);
    if (!result) result = check("reserve.lines", frame->lines, frame->line_count, r->lines, detail);
    for (uint32_t i = 0; i < frame->particle_count && !result; i++)
        result = check_texture(d, "particles", i, frame->particles[i].texture, detail);
    for (uint32_t i = 0; i < frame->decal_count && !result; i++) {
        result = check_texture(d, "decals", i, frame->decals[i].texture, detail);
        if (!result && frame->decals[i].emission != 0.0f && !r->textures) {
            result = masu_fail(detail, MASU_ERROR_ARGUMENT, "reserve.textures", 1, 0,
                               "reserve.textures is 0, decals[%u].emission needs at least 1", i);
        }
    }
    if (!result) result = check_trails(d, frame, detail);
    return result;
}

static masu_sprite_eye eye_of(const masu_frame_data *f) {
    masu_sprite_eye e = {.tan_x = (double)f->u.right[3],
                         .tan_y = (double)f->u.up[3],
                         .near_distance = (double)f->u.forward[3]};
    for (uint32_t k = 0; k < 2; k++)
        e.middle[k] = (double)f->u.jitter[k] - (double)f->u.jitter[2 + k];
    for (uint32_t k = 0; k < 3; k++) {
        e.at[k] = f->eye[k];
        e.right[k] = (double)f->u.right[k] / e.tan_x;
        e.up[k] = (double)f->u.up[k] / e.tan_y;
        e.forward[k] = (double)f->u.forward[k];
    }
    return e;
}

void masu_sprites_write(masu_sprites *s, const masu_transparents *transparents,
                        const masu_frame_data *f) {
    const masu_needs *n = &f->plan->needs;
    const masu_sprites_plan *at = &f->plan->sprites;
    masu_sprite_counts *counts = &s->slots[f->slot];
    if (!n->sprites) return;
    /* Never read: upload memory may be write-combined. */
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_SPRITES);
    masu_sprite_eye eye = eye_of(f);
    uint32_t part[4] = {0};
    *counts = (masu_sprite_counts){0};
    if (n->particles) {
        VkDrawIndirectCommand *draws =
            (VkDrawIndirectCommand *)(void *)(to + MASU_SPRITE_DRAWS * sizeof(masu_vec4));
        counts->particles = masu_particles_write(
            f, &eye, s->order, transparents->sorted, transparents->slot_count[f->slot], draws,
            to + at->particles * sizeof(masu_vec4), &counts->segments);
        counts->particles -= counts->segments;
    }
    if (n->lines)
        counts->lines = masu_debug_lines_write(f, &eye, to + at->lines * sizeof(masu_vec4));
    if (n->decals)
        counts->decals = masu_decals_write(f, &eye, to + at->decals * sizeof(masu_vec4), part);
    const uint32_t dispatch[4] = {(part[2] + MASU_GROUP - 1) / MASU_GROUP,
                                  (part[3] + MASU_GROUP - 1) / MASU_GROUP, 1, counts->decals};
    const uint32_t place[4] = {part[0], part[1], 0, 0};
    const VkDrawIndirectCommand lines = {6 * counts->lines, 1, 0, 0};
    memcpy(to + MASU_SPRITE_DISPATCH * sizeof(masu_vec4), dispatch, sizeof dispatch);
    memcpy(to + MASU_SPRITE_PLACE * sizeof(masu_vec4), place, sizeof place);
    memcpy(to + MASU_SPRITE_LINES * sizeof(masu_vec4), &lines, sizeof lines);
}

/* looks.c: see looks.h. */
#include "frame/looks.h"

#include "base/error.h"

#include <math.h>
#include <string.h>

void masu_looks_alloc(masu_looks *s, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t count = plan->scene.instances;
    memset(s, 0, sizeof *s);
    if (!plan->needs.looks) return;
    s->now = masu_arena_alloc(arena, "looks", count, sizeof *s->now, 4);
    s->writes = masu_arena_alloc(arena, "look writes", count, sizeof *s->writes, 1);
}

void masu_looks_init(masu_looks *s, const masu_frame_plan *plan) {
    uint32_t count = s->now ? plan->scene.instances : 0;
    if (s->now) memset(s->now, 0, count * sizeof *s->now);
    if (s->now) memset(s->writes, (int)plan->desc.frames_in_flight, count);
    s->dirty_count = count;
    s->given = s->changes = 0;
}

typedef struct part {
    const char *name;
    const float *at;
    uint32_t count;
    float least, most;
} part;

masu_result masu_looks_check(const masu_frame_plan *plan, const masu_look *look,
                             masu_detail *detail) {
    const uint32_t known = MASU_LOOK_NO_SHADOW | MASU_LOOK_NOT_TRACED | MASU_LOOK_NOT_PICKED;
    const part parts[] = {{"look.tint", look->tint, 3, 0.0f, 1.0f},
                          {"look.emission", &look->emission, 1, -1e6f, 1e6f},
                          {"look.uv_offset", look->uv_offset, 2, -1e4f, 1e4f},
                          {"look.uv_scale", look->uv_scale, 2, -1e4f, 1e4f},
                          {"look.fade", &look->fade, 1, 0.0f, 1.0f}};
    if (!plan->desc.instance_looks)
        return masu_fail(detail, MASU_ERROR_STATE, "instance_looks", 1, 0,
                         "looks cannot be set: desc.instance_looks is 0");
    for (uint32_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const part *p = &parts[i];
        for (uint32_t k = 0; k < p->count; k++) {
            if (p->at[k] >= p->least && p->at[k] <= p->most) continue;
            return masu_fail(detail, MASU_ERROR_ARGUMENT, p->name, p->count, k,
                             "%s%s is %g, allowed are %g to %g", p->name,
                             p->count == 1 ? "" : k == 0 ? "[0]" : k == 1 ? "[1]" : "[2]",
                             (double)p->at[k], (double)p->least, (double)p->most);
        }
    }
    if (look->flags & ~known)
        return masu_fail(detail, MASU_ERROR_ARGUMENT, "look.flags", known, look->flags,
                         "look.flags is 0x%x, allowed are bits of 0x%x", look->flags, known);
    return MASU_OK;
}

static int is_plain(const masu_look *look) {
    static const masu_look plain = {.flags = 0};
    return memcmp(look, &plain, sizeof plain) == 0;
}

int masu_looks_set(masu_looks *s, const masu_frame_plan *plan, uint32_t i, const masu_look *look) {
    const masu_look before = s->now[i];
    if (memcmp(&before, look, sizeof before) == 0) return 0;
    int shadowless = masu_look_shadowless(s, i), untraced = masu_look_untraced(s, i);
    s->given += (uint32_t)is_plain(&before);
    s->given -= (uint32_t)is_plain(look);
    s->now[i] = *look;
    s->changes++;
    s->dirty_count += !s->writes[i];
    s->writes[i] = (uint8_t)plan->desc.frames_in_flight;
    return !shadowless != !masu_look_shadowless(s, i) || !untraced != !masu_look_untraced(s, i);
}

void masu_look_rows(const masu_look *look, float rows[8]) {
    int white = look->tint[0] == 0.0f && look->tint[1] == 0.0f && look->tint[2] == 0.0f;
    for (uint32_t k = 0; k < 3; k++) rows[k] = white ? 1.0f : look->tint[k];
    rows[3] = look->emission == 0.0f ? 1.0f : fmaxf(look->emission, 0.0f);
    for (uint32_t k = 0; k < 2; k++) {
        rows[4 + k] = look->uv_offset[k];
        rows[6 + k] = look->uv_scale[k] == 0.0f ? 1.0f : look->uv_scale[k];
    }
}

void masu_looks_write(masu_looks *s, const masu_frame_data *f) {
    uint32_t count = f->plan->scene.instances;
    if (!s->dirty_count) return;
    struct masu_instance_data *to =
        (struct masu_instance_data *)(void *)masu_frame_slot(f, MASU_BUFFER_INSTANCES) +
        masu_look_capacity(count);
    for (uint32_t i = 0; i < count; i++) {
        if (!s->writes[i]) continue;
        float rows[12] = {0};
        masu_look_rows(&s->now[i], rows);
        rows[8] = s->now[i].fade;
        memcpy(&to[i], rows, sizeof rows);
        s->dirty_count -= !--s->writes[i];
    }
}

/* bounce.c: see bounce.h. */
#include "frame/bounce.h"

#include "plan/buffer_plan.h"

#include <math.h>
#include <string.h>

_Static_assert(MASU_BOUNCE_WINDOW == MASU_BOUNCE_SETS, "sets of a live probe");
_Static_assert(MASU_PROBE_LIVE_WORDS == MASU_PROBE_LIT_WORDS + MASU_BOUNCE_SETS * MASU_PROBE_WORDS,
               "a live probe");

void masu_bounce_alloc(masu_bounce *b, masu_arena *arena, const masu_frame_plan *plan) {
    uint32_t count = plan->needs.bounce ? plan->scene.probes : 0;
    b->probes = masu_arena_alloc(arena, "live probes", count, sizeof *b->probes, 1);
}

/* The last half of a probe's first set holds the validity of the probe. */
void masu_bounce_copy_scene(masu_bounce *b, const masu_frame_plan *plan, const masu_scene_view *v) {
    if (!plan->needs.bounce) return;
    const masu_blob_probes *p = v->probes;
    b->count = plan->scene.probes;
    b->lit = !plan->scene.probes_unlit;
    b->valid = 0;
    memcpy(b->counts, p->counts, sizeof b->counts);
    memcpy(b->origin, p->origin, sizeof b->origin);
    memcpy(b->spacing, p->spacing, sizeof b->spacing);
    for (uint32_t i = 0; i < b->count; i++) {
        uint64_t set = (uint64_t)i * masu_probe_sets(p) * MASU_PROBE_WORDS;
        int off = !(v->probe_data[set + MASU_PROBE_WORDS - 1] >> 16 & 0x7FFFu);
        b->probes[i] = (struct masu_bounce_probe){off ? MASU_BOUNCE_OFF : 0, 0};
        b->valid += !off;
    }
    memset(&b->cause, 0, sizeof b->cause);
    b->round = 0;
    b->left = 0;
    b->quiet = MASU_BOUNCE_FIRST;
    b->burst = MASU_BOUNCE_BURST_ROUNDS;
    masu_bounce_restart(b);
}

/* ---- Order of the probes --------------------------------------------------------------------- */

static void next_round(masu_bounce *b) {
    b->round++;
    b->left = b->valid;
}

void masu_bounce_restart(masu_bounce *b) {
    int follows = b->quiet < MASU_BOUNCE_FIRST;
    b->quiet = 0;
    for (uint32_t i = 0; i < b->count; i++) {
        struct masu_bounce_probe *p = &b->probes[i];
        if (p->sets == MASU_BOUNCE_OFF) continue;
        if (!follows) p->sets = 0;
        else if (p->sets >= 2 * MASU_BOUNCE_FIRST) p->sets = MASU_BOUNCE_FIRST;
    }
    if (!follows) {
        b->swift = MASU_BOUNCE_SWIFT_ROUNDS;
        next_round(b);
    }
}

/* The next set of a probe: the first ones twice, since their first light lacks later bounces;
 * then the others; then all around. *count: how many of its sets count, with this one. */
static uint32_t next_set(struct masu_bounce_probe *p, uint32_t *count) {
    const uint32_t twice = 2 * MASU_BOUNCE_FIRST, all = MASU_BOUNCE_FIRST + MASU_BOUNCE_WINDOW,
                   at = p->sets++;
    if (p->sets == all + MASU_BOUNCE_WINDOW) p->sets = all;
    *count = at < MASU_BOUNCE_FIRST ? at + 1 : MASU_BOUNCE_FIRST;
    if (at < twice) return at % MASU_BOUNCE_FIRST;
    *count = at < all ? at - MASU_BOUNCE_FIRST + 1 : MASU_BOUNCE_WINDOW;
    return at < all ? at - MASU_BOUNCE_FIRST : at - all;
}

/* Whether a probe is within two cells of the camera, or in or close to its view. */
static int is_seen(const masu_bounce *b, const masu_bounce_view *view, uint32_t i) {
    const uint32_t at[3] = {i % b->counts[0], i / b->counts[0] % b->counts[1],
                            i / b->counts[0] / b->counts[1]};
    double to[3], cells = 0.0;
    for (uint32_t k = 0; k < 3; k++) {
        to[k] = (double)b->origin[k] + at[k] * (double)b->spacing[k] - view->eye[k];
        cells = fmax(cells, fabs(to[k]) / (double)b->spacing[k]);
    }
    if (cells < 2.0) return 1;
    const float *m = view->clip_from_rel;
    double clip[4];
    for (uint32_t k = 0; k < 4; k++) {
        clip[k] = (double)m[12 + k];
        for (uint32_t j = 0; j < 3; j++) clip[k] += (double)m[4 * j + k] * to[j];
    }
    return clip[3] > 0.0 && fabs(clip[0]) <= 1.2 * clip[3] && fabs(clip[1]) <= 1.2 * clip[3];
}

uint32_t masu_bounce_choose(masu_bounce *b, const masu_bounce_view *view, uint32_t most,
                            uint32_t *words) {
    uint32_t count = 0;
    if (!b->valid || b->quiet >= MASU_BOUNCE_REST) return 0;
    for (int rest = view ? 0 : 1; rest < 2 && count < most; rest++) {
        for (uint32_t i = 0; i < b->count && count < most; i++) {
            struct masu_bounce_probe *p = &b->probes[i];
            if (p->sets == MASU_BOUNCE_OFF || p->round == (uint8_t)b->round) continue;
            if (!rest && !is_seen(b, view, i)) continue;
            uint32_t counting, set = next_set(p, &counting);
            words[count++] = i | set << MASU_BOUNCE_SET_SHIFT | counting << MASU_BOUNCE_COUNT_SHIFT;
            p->round = (uint8_t)b->round;
            b->left--;
        }
    }
    if (!b->left) {
        next_round(b);
        b->quiet++;
        b->burst -= b->burst > 0;
        b->swift -= b->swift > 0;
    }
    return count;
}

/* ---- Changes --------------------------------------------------------------------------------- */

static masu_bounce_cause cause_of(const masu_bounce *b, const masu_lights *lights,
                                  const masu_instances *in, const masu_materials *materials,
                                  const masu_frame_data *f) {
    masu_bounce_cause c;
    const struct masu_frame_uniforms *u = &f->u;
    memset(&c, 0, sizeof c);
    c.lights = lights->changes;
    c.instances = in->changes + in->looks.changes;
    c.materials = materials->changes;
    memcpy(c.params, u->sdf_params, sizeof c.params);
    if (f->plan->needs.timed && f->plan->needs.bounce_sdf) c.time = u->eye_hi[3];
    if (b->lit) return c;
    memcpy(c.sun[0], u->sun_direction, sizeof c.sun[0]);
    memcpy(c.sun[1], u->sun_color, sizeof c.sun[1]);
    memcpy(c.sky[0], u->irradiance, sizeof u->irradiance);
    memcpy(c.sky[9], u->ambient, sizeof u->ambient);
    memcpy(c.sky[10], u->sky_zenith, sizeof u->sky_zenith);
    memcpy(c.sky[11], u->sky_horizon, sizeof u->sky_horizon);
    memcpy(c.sky[12], u->environment, sizeof u->environment);
    return c;
}

void masu_bounce_follow(masu_bounce *b, const masu_lights *lights, const masu_instances *in,
                        const masu_materials *materials, const masu_frame_data *f) {
    masu_bounce_cause cause = cause_of(b, lights, in, materials, f);
    if (memcmp(&cause, &b->cause, sizeof cause) != 0) masu_bounce_restart(b);
    b->cause = cause;
}

uint32_t masu_bounce_pace(const masu_bounce *b, uint32_t most) {
    return most / (b->burst ? 1 : b->swift ? MASU_BOUNCE_BURST / 2 : MASU_BOUNCE_BURST);
}

void masu_bounce_write(masu_bounce *b, const masu_lights *lights, const masu_instances *in,
                       const masu_materials *materials, const masu_frame_data *f) {
    if (!masu_has_pass(&masu_frame_rung_plan(f)->active, MASU_PASS_BOUNCE_SUM)) return;
    masu_bounce_follow(b, lights, in, materials, f);
    if (f->cut && b->quiet < MASU_BOUNCE_REST) b->burst = MASU_BOUNCE_BURST_ROUNDS;
    const masu_rung *rung = masu_frame_rung(f);
    uint32_t most = masu_bounce_pace(b, masu_bounce_most(f->plan, f->desc.rung));
    unsigned char *to = masu_frame_slot(f, MASU_BUFFER_BOUNCE);
    masu_bounce_view view = {f->u.clip_from_rel, {f->eye[0], f->eye[1], f->eye[2]}};
    uint32_t *words = (uint32_t *)(void *)(to + sizeof(struct masu_bounce_header));
    uint32_t probes = masu_bounce_choose(b, &view, most, words), rays = probes * rung->bounce_rays;
    const struct masu_bounce_header header = {{(rays + 63) / 64, 1, 1, rays},
                                              {probes, 1, 1, rung->bounce_rays}};
    memcpy(to, &header, sizeof header);
    b->slot_left[f->slot] = b->valid ? MASU_BOUNCE_REST - b->quiet : 0;
}

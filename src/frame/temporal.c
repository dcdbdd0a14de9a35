/* temporal.c: see temporal.h. */
#include "frame/temporal.h"

#include <math.h>

/* The digits of n, mirrored at the point (J. Halton, 1964). */
static float mirrored(uint32_t n, uint32_t base) {
    double value = 0.0, digit = 1.0;
    for (; n; n /= base) {
        digit /= base;
        value += digit * (n % base);
    }
    return (float)value;
}

static int has_resolve(const masu_frame_data *f) {
    return masu_has_pass(&masu_frame_rung_plan(f)->active, MASU_PASS_TEMPORAL_KEEP);
}

void masu_temporal_jitter(const masu_frame_data *f, float jitter[2]) {
    jitter[0] = jitter[1] = 0.0f;
    if (!has_resolve(f)) return;
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    const VkExtent2D shown = f->plan->desc.output;
    double pixels = (double)rp->render_width * rp->render_height;
    double phases = ceil(8.0 * shown.width * shown.height / pixels - 1e-6);
    uint32_t phase = (uint32_t)(f->number % (uint64_t)fmin(phases, 1024.0));
    jitter[0] = mirrored(phase + 1, 2) - 0.5f;
    jitter[1] = mirrored(phase + 1, 3) - 0.5f;
}

void masu_temporal_read(masu_temporal *t, masu_frame_data *f) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    if (has_resolve(f) && t->kept && !f->cut) {
        f->u.temporal[0] = t->size[0];
        f->u.temporal[1] = t->size[1];
    }
    t->kept = has_resolve(f);
    if (!t->kept) return;
    t->size[0] = rp->render_width;
    t->size[1] = rp->render_height;
}

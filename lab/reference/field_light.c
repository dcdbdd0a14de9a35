/* field_light.c: light sources that paths sample by a box: emissive parts of the field with any
 * shape, and windows to the sky. See field.h. */
#include "lab/reference/field.h"

#include <stdlib.h>
#include <string.h>

static double component(ref_vec v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; }

static bool is_bounded(const masu_sdfc_part *part) {
    for (int k = 0; k < 3; k++) {
        if (!isfinite(part->low[k]) || !isfinite(part->high[k]) || !(part->low[k] < part->high[k]))
            return false;
    }
    return true;
}

/* Power of a part whose material is in the C. Unbounded parts are only hit by chance. */
static double power_of(const ref_field *f, const masu_sdfc_part *part, int number) {
    double look[8], side[3];
    if (!part->truth || !is_bounded(part)) return 0;
    f->material(number, look);
    for (int k = 0; k < 3; k++) side[k] = part->high[k] - part->low[k];
    double area = side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
    return ref_luminance(ref_v(look[4], look[5], look[6])) * area;
}

bool ref_field_find_emitters(ref_field *f, const masu_sdfc_result *made) {
    double sum = 0, origin[3] = {0, 0, 0};
    f->emitters = calloc(made->part_count + 1, sizeof *f->emitters);
    if (!f->emitters) return false;
    f->step(f->params, f->time, origin); /* materials are evaluated for the last call */
    for (uint32_t i = 0; i < made->part_count; i++) {
        const masu_sdfc_part *part = &made->parts[i];
        double power = power_of(f, part, (int)i);
        if (!(power > 0)) continue;
        sum += power;
        f->emitters[f->emitter_count++] =
            (ref_light_box){ref_v(part->low[0], part->low[1], part->low[2]),
                            ref_v(part->high[0], part->high[1], part->high[2]), sum};
    }
    for (uint32_t i = 0; i < f->emitter_count; i++) f->emitters[i].cumulative /= sum;
    return true;
}

ref_vec ref_towards_box(const ref_light_box *boxes, uint32_t count, ref_vec from, ref_random *r) {
    double which = ref_draw(r);
    double u = ref_draw(r);
    double v = ref_draw(r);
    double w = ref_draw(r);
    uint32_t low = 0, high = count - 1;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (boxes[middle].cumulative > which)
            high = middle;
        else
            low = middle + 1;
    }
    const ref_light_box *e = &boxes[low];
    ref_vec side = ref_sub(e->high, e->low);
    ref_vec p = ref_add(e->low, ref_mul(side, ref_v(u, v, w)));
    return ref_unit(ref_sub(p, from));
}

/* Sum over all points of a ray within a box: t^2 dt / V is the solid angle's part of the volume. */
double ref_box_pdf(const ref_light_box *boxes, uint32_t count, ref_vec from, ref_vec d) {
    double sum = 0, before = 0;
    for (uint32_t i = 0; i < count; i++) {
        const ref_light_box *e = &boxes[i];
        double near = 0, far = HUGE_VAL, volume = 1;
        for (int k = 0; k < 3; k++) {
            double o = component(from, k), w = component(d, k), a = component(e->low, k),
                   b = component(e->high, k);
            volume *= b - a;
            if (w == 0) {
                if (o < a || o > b) far = 0;
                continue;
            }
            near = fmax(near, fmin((a - o) / w, (b - o) / w));
            far = fmin(far, fmax((a - o) / w, (b - o) / w));
        }
        if (near < far)
            sum += (e->cumulative - before) * (far * far * far - near * near * near) / (3 * volume);
        before = e->cumulative;
    }
    return sum;
}

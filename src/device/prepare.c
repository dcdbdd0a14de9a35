/* prepare.c: see prepare.h. Rungs become ready one after another: desc.first_rung, then the others
 * by number. A rung creates the pipelines that the rungs before it have not created. */
#include "device/prepare.h"

#include "device/pipelines.h"
#include "device/recordings.h"

/* Bits of masu_device.made: the two forms of a pass. */
enum { MADE = 1, MADE_LAST = 2 };

/* One form of a pass. */
typedef struct form {
    uint32_t pass;
    int last;
} form;

static uint8_t bit_of(form f) { return f.last ? MADE_LAST : MADE; }

static int is_drawn(uint32_t pass) {
    return masu_passes[pass].kind == MASU_PASS_GRAPHICS ||
           masu_passes[pass].kind == MASU_PASS_COMPUTE;
}

/* The form of a pass that a rung uses. All cascades share the objects of the first one. */
static form form_of(const masu_rung_plan *rp, uint32_t pass) {
    if (masu_passes[pass].kind == MASU_PASS_COMPUTE)
        return (form){pass, masu_comes_last(rp, pass) != 0};
    if (masu_passes[pass].geometry == MASU_GEOMETRY_CASCADE) return (form){MASU_PASS_CASCADE_0, 0};
    return (form){pass, 0};
}

/* Finds a form that the rung uses and that is not in `made`. */
static int find_missing(const masu_rung_plan *rp, const uint8_t made[MASU_PASS_COUNT],
                        form *missing) {
    for (uint32_t p = 0; p < MASU_PASS_COUNT; p++) {
        if (!is_drawn(p) || !masu_has_pass(&rp->active, p)) continue;
        *missing = form_of(rp, p);
        if (!(made[missing->pass] & bit_of(*missing))) return 1;
    }
    return 0;
}

void masu_prepare_begin(masu_device *m) {
    uint8_t made[MASU_PASS_COUNT] = {0};
    form missing;
    m->steps = m->plan->desc.rung_count;
    for (uint32_t r = 0; r < m->plan->desc.rung_count; r++) {
        while (find_missing(&m->plan->rungs[r], made, &missing)) {
            made[missing.pass] |= bit_of(missing);
            m->steps++;
        }
    }
}

static int is_ready(const masu_device *m, uint32_t rung) { return (int)(m->ready >> rung & 1u); }

masu_result masu_prepare_step(masu_device *m, const masu_draws *draws, masu_detail *detail) {
    uint32_t rung = m->plan->desc.first_rung;
    if (is_ready(m, rung)) {
        for (rung = 0; rung < m->plan->desc.rung_count && is_ready(m, rung);) rung++;
        if (rung == m->plan->desc.rung_count) return MASU_OK;
    }
    form next;
    masu_result result;
    if (find_missing(&m->plan->rungs[rung], m->made, &next)) {
        result = masu_create_pipelines(m, next.pass, next.last, detail);
        if (!result) m->made[next.pass] |= bit_of(next);
    } else {
        result = masu_record_rung(m, draws, rung, detail);
        if (!result) m->ready |= 1u << rung;
    }
    if (result) return result;
    m->steps_done++;
    return m->steps_done < m->steps ? MASU_INCOMPLETE : MASU_OK;
}

uint32_t masu_ready_rung(const masu_device *m, uint32_t rung) {
    for (uint32_t r = rung; r < m->plan->desc.rung_count; r++) {
        if (is_ready(m, r)) return r;
    }
    for (uint32_t r = rung; r-- > 0;) {
        if (is_ready(m, r)) return r;
    }
    return UINT32_MAX;
}

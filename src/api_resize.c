/* api_resize.c: masu_resize: a new output size and new targets for the existing images. Images are
 * allocated for the largest output; a smaller one uses their upper left part, like rungs with a
 * smaller scale. Only recordings depend on sizes: those of the current rung are recorded at once,
 * the others when a frame needs them. */
#include "api_governor.h"
#include "base/error.h"
#include "device/device_objects.h"
#include "device/recordings.h"
#include "plan/compile.h"
#include "plan/desc.h"
#include "quality/governor_state.h"
#include "renderer.h"

/* Fields that may be 0 keep their current value. */
static masu_targets filled_in(const masu_targets *given, const masu_targets *now) {
    masu_targets t = *given;
    if (t.format == VK_FORMAT_UNDEFINED) t.format = now->format;
    if (t.final_layout == VK_IMAGE_LAYOUT_UNDEFINED) t.final_layout = now->final_layout;
    if (t.encoding == MASU_ENCODING_AUTO) t.encoding = now->encoding;
    if (t.white == 0.0f) t.white = now->white;
    if (t.peak == 0.0f) t.peak = now->peak;
    return t;
}

static masu_result differs(masu_detail *detail, const char *what, uint64_t needed, uint64_t given) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, needed, given,
                     "masu_resize: %s is %llu, that of masu_init was %llu", what,
                     (unsigned long long)given, (unsigned long long)needed);
}

static masu_result check_targets(const masu_targets *now, const masu_targets *t,
                                 masu_detail *detail) {
    if (t->format != now->format)
        return differs(detail, "targets.format", (uint64_t)now->format, (uint64_t)t->format);
    if (!t->storage != !now->storage)
        return differs(detail, "targets.storage", now->storage, t->storage);
    if (t->final_layout != now->final_layout)
        return differs(detail, "targets.final_layout", (uint64_t)now->final_layout,
                       (uint64_t)t->final_layout);
    if (t->encoding != now->encoding)
        return differs(detail, "targets.encoding", (uint64_t)now->encoding, (uint64_t)t->encoding);
    if (t->white != now->white || t->peak != now->peak) {
        int white = t->white != now->white;
        return masu_fail(detail, MASU_ERROR_ARGUMENT, white ? "targets.white" : "targets.peak", 0,
                         0, "masu_resize: targets.%s is %g, masu_init was given %g",
                         white ? "white" : "peak", (double)(white ? t->white : t->peak),
                         (double)(white ? now->white : now->peak));
    }
    return MASU_OK;
}

static masu_result check(const masu_renderer *m, VkExtent2D output, masu_targets *t,
                         const masu_viewport *viewports, masu_detail *detail) {
    const masu_frame_plan *plan = &m->plan;
    if (!plan->desc.resizable || !plan->desc.scene) {
        return masu_fail(detail, MASU_ERROR_STATE, "resizable", 1, 0,
                         plan->desc.scene ? "masu_resize requires desc.resizable"
                                          : "masu_resize requires a scene");
    }
    *t = filled_in(t, &plan->desc.targets);
    masu_desc wanted = plan->desc;
    wanted.output = output;
    wanted.targets = *t;
    if (!viewports != !plan->desc.viewport_count)
        return differs(detail, "viewport_count", plan->desc.viewport_count, viewports ? 1 : 0);
    for (uint32_t i = 0; i < plan->desc.viewport_count; i++) wanted.viewports[i] = viewports[i];
    masu_result result = check_targets(&plan->desc.targets, t, detail);
    if (!result) result = masu_desc_check(&wanted, detail);
    if (result) return result;
    if (output.width <= plan->most.width && output.height <= plan->most.height) return MASU_OK;
    int wide = output.width > plan->most.width;
    return masu_fail(detail, MASU_ERROR_LIMIT, "output",
                     wide ? output.width : output.height,
                     wide ? plan->most.width : plan->most.height,
                     "output: %ux%u is larger than the %ux%u that masu_init has planned for",
                     output.width, output.height, plan->most.width, plan->most.height);
}

static masu_result resize(masu_renderer *m, VkExtent2D output, const masu_targets *targets,
                          const masu_viewport *viewports, masu_detail *detail) {
    if (!targets) return masu_fail_null(detail, "targets");
    masu_targets t = *targets;
    masu_result result = masu_check_lost(m, detail);
    if (!result) result = check(m, output, &t, viewports, detail);
    if (result) return result;
    VkExtent2D was = masu_governed_output(m);
    masu_set_targets(&m->device, &t);
    m->plan.whole = output;
    for (uint32_t i = 0; i < m->plan.desc.viewport_count; i++)
        m->plan.desc.viewports[i] = viewports[i];
    VkExtent2D is = masu_governed_output(m);
    if (m->governor) {
        double pixels = (double)is.width * is.height / ((double)was.width * was.height);
        masu_governor_scale(m->governor, pixels, m->timeline.frame);
    }
    m->timeline.cut = 1;
    result = masu_record_again(&m->device, &m->draws, m->rung, detail);
    m->lost |= result == MASU_ERROR_DEVICE_LOST;
    return result;
}

masu_result masu_resize(masu_renderer *m, VkExtent2D output, const masu_targets *targets,
                        const masu_viewport *viewports, masu_detail *detail) {
    if (!m) return masu_fail_null(detail, "renderer");
    masu_result result = resize(m, output, targets, viewports, &m->error);
    return masu_finish(m, result, detail);
}

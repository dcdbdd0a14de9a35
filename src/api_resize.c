/* api_resize.c: masu_resize: another output size and other targets for the existing images. Images are
 * allocated for the largest output; passes of a smaller one use their upper left part, as rungs of a
 * smaller scale do. Only recordings depend on sizes; they are recorded again. */
#include "base/error.h"
#include "api_governor.h"
#include "device/record.h"
#include "plan/compile.h"
#include "plan/desc.h"
#include "quality/governor_state.h"
#include "renderer.h"

/* What may stay 0 stays what it is. */
static masu_targets filled_in(const masu_targets *given, const masu_targets *now) {
    masu_targets t = *given;
    if (t.format == VK_FORMAT_UNDEFINED) t.format = now->format;
    if (t.final_layout == VK_IMAGE_LAYOUT_UNDEFINED) t.final_layout = now->final_layout;
    if (t.encoding == MASU_ENCODING_AUTO) t.encoding = now->encoding;
    t.white = now->white;
    t.peak = now->peak;
    return t;
}

static masu_result differs(masu_detail *detail, const char *what, uint64_t needed, uint64_t given) {
    return masu_fail(detail, MASU_ERROR_ARGUMENT, what, needed, given,
                     "masu_resize: %s is %llu, that of masu_init was %llu", what,
                     (unsigned long long)given, (unsigned long long)needed);
}

static masu_result check_targets(const masu_targets *now, const masu_targets *t,
                                 masu_detail *detail) {
    if (t->count != now->count) return differs(detail, "targets.count", now->count, t->count);
    if (t->format != now->format)
        return differs(detail, "targets.format", (uint64_t)now->format, (uint64_t)t->format);
    if (!t->storage != !now->storage)
        return differs(detail, "targets.storage", now->storage, t->storage);
    if (t->final_layout != now->final_layout)
        return differs(detail, "targets.final_layout", (uint64_t)now->final_layout,
                       (uint64_t)t->final_layout);
    if (t->encoding != now->encoding)
        return differs(detail, "targets.encoding", (uint64_t)now->encoding, (uint64_t)t->encoding);
    return MASU_OK;
}

static masu_result check(const masu_renderer *m, VkExtent2D output, masu_targets *t,
                         const masu_viewport *viewports, masu_detail *detail) {
    const masu_frame_plan *plan = &m->plan;
    if (!plan->desc.resizable || !plan->desc.scene) {
        return masu_fail(detail, MASU_ERROR_STATE, "resizable", 1, 0,
                         "masu_resize takes desc.resizable, and a scene");
    }
    if (!m->loaded) {
        return masu_fail(detail, MASU_ERROR_STATE, "masu_load", 1, 0,
                         "masu_resize was called before masu_load had returned MASU_OK");
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

masu_result masu_resize(masu_renderer *m, VkExtent2D output, const masu_targets *targets,
                        const masu_viewport *viewports, masu_detail *detail) {
    if (!m || !targets) {
        return masu_fail(detail, MASU_ERROR_ARGUMENT, m ? "targets" : "renderer", 1, 0,
                         "masu_resize: %s is NULL", m ? "targets" : "renderer");
    }
    masu_targets t = *targets;
    masu_result result = check(m, output, &t, viewports, detail);
    if (result) return result;
    VkExtent2D was = masu_governed_output(m);
    m->plan.desc.targets = t;
    m->plan.whole = output;
    for (uint32_t i = 0; i < m->plan.desc.viewport_count; i++)
        m->plan.desc.viewports[i] = viewports[i];
    VkExtent2D is = masu_governed_output(m);
    if (m->governor) {
        double pixels = (double)is.width * is.height / ((double)was.width * was.height);
        masu_governor_scale(m->governor, pixels, m->timeline.frame);
    }
    m->timeline.cut = 1;
    result = masu_record_again(&m->device, &m->draws, detail);
    if (result) m->loaded = 0; /* no frame is handed out any more */
    return result;
}

/* push.c: the push constants of a pass: sizes first, then what its shader asks for by name. */
#include "device/push.h"

#include "plan/output.h"

#include <math.h>
#include <string.h>

/* What the passes of ambient occlusion need of scene and description; the shaders name it. */
static void ao_push(const masu_recorder *rec, uint32_t pass, struct masu_push *push) {
    const masu_frame_plan *plan = rec->m->plan;
    push->param[0] = plan->scene.occlusion_radius;
    push->param[1] = (float)MASU_AO_REACH;
    push->index[2] = plan->desc.debug.ao_full ? 1 : 2;
    if (pass == MASU_PASS_AO) return;
    push->index[0] = plan->needs.sdf_occlusion || plan->needs.shadow;
    push->index[1] = plan->desc.debug.ao_nearest != 0;
}

static int is_specular(uint32_t pass) {
    return pass >= MASU_PASS_SPECULAR_GUIDE && pass <= MASU_PASS_SPECULAR_COMPOSITE;
}

/* Of what reflections are traced: index.z pixels along an edge of a traced texel, index.w 1: of every
 * pixel, for comparison. */
static void specular_push(const masu_recorder *rec, struct masu_push *push) {
    push->index[2] = rec->m->plan->desc.debug.reference ? 1 : 2;
    push->index[3] = rec->m->plan->needs.accumulate != 0;
    push->render_width = rec->rp->render_width;
    push->render_height = rec->rp->render_height;
}

struct masu_push masu_push_constants(const masu_recorder *rec, uint32_t pass) {
    const masu_desc *d = &rec->m->plan->desc;
    VkExtent2D render = {rec->rp->render_width, rec->rp->render_height};
    VkExtent2D output = masu_plan_extent(rec->m->plan, masu_passes[pass].extent, render);
    VkExtent2D input = render; /* of the first image read that is not of blocks */
    struct masu_push push;
    memset(&push, 0, sizeof push);
    for (uint32_t a = 0; a < rec->rp->access_count[pass]; a++) {
        masu_image_id id = (masu_image_id)rec->rp->access[pass][a].image;
        if (rec->rp->access[pass][a].usage != MASU_READ) continue;
        if (id == MASU_IMAGE_OCCLUDERS) continue;
        if (masu_images[id].extent == MASU_EXTENT_OUTPUT) input = d->output;
        break;
    }
    push.render_width = input.width;
    push.render_height = input.height;
    push.output_width = output.width;
    push.output_height = output.height;
    if (pass >= MASU_PASS_EASU && pass <= MASU_PASS_FSR1) { /* see upscale/place.glsl */
        push.param[2] = (float)input.width * (1.0f / (float)output.width);
        push.param[3] = (float)input.height * (1.0f / (float)output.height);
    }
    if (masu_passes[pass].params) masu_passes[pass].params(&d->rungs[rec->rung], &push);
    masu_output_push(rec->m->plan, rec->rp, pass, &push);
    masu_image_extent extent = masu_passes[pass].extent;
    int culling = extent == MASU_EXTENT_KEPT || extent == MASU_EXTENT_BATCHES;
    if (culling || pass == MASU_PASS_RECEIVERS) push.index[0] = (uint32_t)rec->m->plan->drawn.header;
    if (pass == MASU_PASS_AO || pass == MASU_PASS_AO_UPSAMPLE) ao_push(rec, pass, &push);
    if (is_specular(pass)) specular_push(rec, &push);
    if (pass == MASU_PASS_LIGHT || pass == MASU_PASS_LIGHT_OCCLUDED)
        push.index[3] = rec->m->plan->needs.accumulate != 0;
    return push;
}

static float mip_bias(const masu_recorder *rec) {
    const masu_desc *d = &rec->m->plan->desc;
    return (d->debug.no_bias ? 0.0f : log2f(d->rungs[rec->rung].scale)) + d->debug.mip_bias;
}

struct masu_push masu_push_draw(const masu_recorder *rec, int biased) {
    struct masu_push push;
    memset(&push, 0, sizeof push);
    push.output_width = push.render_width = rec->rp->render_width;
    push.output_height = push.render_height = rec->rp->render_height;
    if (biased) push.param[0] = mip_bias(rec);
    return push;
}

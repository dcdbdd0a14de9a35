/* cameras.c: the views that a frame is culled for: the camera and the sun's view of each cascade
 * (without a shadow map, for the statistics only, of the whole scene). Each has frustum planes and
 * the input of occlusion culling; the camera also has that of LOD selection. Computed in double
 * precision and world space up to the values that are stored. */
#include "frame/cameras.h"

#include <math.h>
#include <string.h>

int masu_view_draws(const masu_frame_data *f, uint32_t view) {
    return !view || !f->plan->needs.shadow || (f->cascades >> (view - 1) & 1u);
}

/* A box along the sun's direction, which is its last axis. It reaches from the centre `half`
 * across it, `behind` away from the sun and `ahead` towards it: how far that is may be more than
 * the position of a middle could bear. */
typedef struct sun_box {
    double axis[3][3], center[3], half[2], behind, ahead;
} sun_box;

static double along(const double axis[3], const double p[3]) {
    return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
}

/* The whole scene with its initial transforms. */
static sun_box around_scene(const masu_cull_box *scene, const float sun[3]) {
    sun_box b;
    double towards[3], half[3] = {1e-6, 1e-6, 1e-6};
    for (uint32_t i = 0; i < 3; i++) towards[i] = (double)sun[i];
    masu_shadow_axes(towards, b.axis);
    for (uint32_t i = 0; i < 3; i++) {
        b.center[i] = (double)scene->center[i];
        for (uint32_t j = 0; j < 3; j++)
            half[i] += fabs(b.axis[i][j]) * 1.001 * (double)scene->half[j];
    }
    b.half[0] = half[0];
    b.half[1] = half[1];
    b.behind = b.ahead = half[2];
    return b;
}

static sun_box around_cascade(const masu_cascade *c) {
    sun_box b;
    memcpy(b.axis, c->axis, sizeof b.axis);
    memcpy(b.center, c->center, sizeof b.center);
    b.half[0] = b.half[1] = c->half;
    b.behind = c->behind;
    b.ahead = c->ahead;
    return b;
}

/* Metres. */
static double texel_of(const masu_cascade *c) { return 2.0 * c->half / c->size; }

/* The least box around two of the same axes. */
static sun_box around_both(const sun_box *a, const sun_box *b) {
    sun_box both = *a;
    double apart[3];
    for (uint32_t i = 0; i < 3; i++) apart[i] = b->center[i] - a->center[i];
    for (uint32_t i = 0; i < 2; i++) {
        double at = along(a->axis[i], apart);
        double low = fmin(-a->half[i], at - b->half[i]), high = fmax(a->half[i], at + b->half[i]);
        both.half[i] = 0.5 * (high - low);
        for (uint32_t k = 0; k < 3; k++) both.center[k] += a->axis[i][k] * 0.5 * (high + low);
    }
    both.behind = fmax(a->behind, b->behind - along(a->axis[2], apart));
    both.ahead = fmax(a->ahead, b->ahead + along(a->axis[2], apart));
    return both;
}

/* The box's planes except the one towards the sun: casters may be at any distance there. */
static void set_box_planes(const sun_box *b, masu_cull_view *view) {
    view->count = 0;
    for (uint32_t plane = 0; plane < 5; plane++) {
        double n[3], sign = plane % 2 ? -1.0 : 1.0,
                     reach = plane < 4 ? b->half[plane / 2] : b->behind;
        for (uint32_t k = 0; k < 3; k++) n[k] = sign * b->axis[plane / 2][k];
        masu_cull_add_plane(view, n, reach - along(n, b->center));
    }
}

/* ---- Casters that matter --------------------------------------------------------------------- */

/* Light-space outline of the view: the camera and the image corners at the depth where shadows
 * end, in metres across the sun's direction from a box's centre. */
typedef struct outline {
    double at[5][2];
} outline;

static outline outline_of(const sun_box *b, double depth, const masu_frame_data *f) {
    const struct masu_frame_uniforms *u = &f->u;
    outline o;
    for (uint32_t i = 0; i < 5; i++) {
        double rel[3], x = i & 1 ? 1.0 : -1.0, y = i & 2 ? 1.0 : -1.0;
        for (uint32_t k = 0; k < 3; k++) {
            double corner = (double)u->forward[k] +
                            (x + (double)u->jitter[0]) * (double)u->right[k] +
                            (y - (double)u->jitter[1]) * (double)u->up[k];
            rel[k] = f->eye[k] - b->center[k] + (i < 4 ? depth * corner : 0.0);
        }
        o.at[i][0] = along(b->axis[0], rel);
        o.at[i][1] = along(b->axis[1], rel);
    }
    return o;
}

/* How far the box reaches outside of the half-plane on the left of i -> j, which contains the
 * whole outline; negative if it does not contain it. n: the inside normal. */
static double cut_of(const outline *o, uint32_t i, uint32_t j, const sun_box *b, double n[2]) {
    double x = o->at[j][0] - o->at[i][0], y = o->at[j][1] - o->at[i][1],
           length = sqrt(x * x + y * y);
    if (!(length > 0.0) || !(length <= 1e15)) return -1.0;
    n[0] = -y / length;
    n[1] = x / length;
    for (uint32_t k = 0; k < 5; k++) {
        double side = n[0] * (o->at[k][0] - o->at[i][0]) + n[1] * (o->at[k][1] - o->at[i][1]);
        if (side < -1e-9 * length) return -1.0;
    }
    double edge = n[0] * o->at[i][0] + n[1] * o->at[i][1];
    return edge + fabs(n[0]) * b->half[0] + fabs(n[1]) * b->half[1];
}

/* A map that only this frame reads may omit casters whose shadows are outside of the image: the
 * two edges of the outline that cut most of the box become planes, widened by `margin` metres.
 * The box is unchanged, because it describes the map. */
static void add_outline(const outline *o, const sun_box *b, double margin, masu_cull_view *view) {
    double most[2] = {margin, margin}, normal[2][2] = {{0, 0}, {0, 0}}, from[2] = {0, 0};
    for (uint32_t edge = 0; edge < 25; edge++) {
        double n[2], cut = cut_of(o, edge / 5, edge % 5, b, n);
        uint32_t less = most[0] < most[1] ? 0 : 1;
        if (!(cut > most[less])) continue;
        most[less] = cut;
        memcpy(normal[less], n, sizeof n);
        from[less] = n[0] * o->at[edge / 5][0] + n[1] * o->at[edge / 5][1] - margin;
    }
    for (uint32_t e = 0; e < 2; e++) {
        double n[3];
        for (uint32_t k = 0; k < 3; k++)
            n[k] = normal[e][0] * b->axis[0][k] + normal[e][1] * b->axis[1][k];
        if (most[e] > margin) masu_cull_add_plane(view, n, -from[e] - along(n, b->center));
    }
}

/* ---- Stage 2 --------------------------------------------------------------------------------- */

/* Depth is 1 at the side of the sun. */
static void set_sun_view(const sun_box *b, const double eye[3], masu_occlusion_view *v) {
    for (uint32_t row = 0; row < 3; row++) {
        double scale = 1.0 / (row == 2 ? b->behind + b->ahead : b->half[row]);
        double offset = row == 2 ? b->behind * scale : 0.0;
        for (uint32_t i = 0; i < 3; i++) {
            v->clip[4 * i + row] = (float)(scale * b->axis[row][i]);
            offset += scale * b->axis[row][i] * (eye[i] - b->center[i]);
        }
        v->clip[12 + row] = (float)offset;
    }
    v->clip[15] = 1.0f;
    for (uint32_t i = 0; i < 3; i++) v->eye[i] = (float)b->axis[2][i];
    v->blind = -1.0f;
}

static void set_atlas(masu_occlusion_view *v, uint32_t part) {
    VkRect2D area = masu_atlas_part(part);
    v->atlas[0] = (float)area.offset.x;
    v->atlas[1] = (float)area.offset.y;
    v->atlas[2] = (float)area.extent.width;
    v->atlas[3] = (float)area.extent.height;
}

/* Sets the light-space boxes and planes of each cascade, or of the whole scene. */
static void set_sun_boxes(masu_views *v, const masu_bounds *bounds, const masu_shadow *s,
                          const masu_frame_data *f, sun_box boxes[MASU_CASCADES_MAX]) {
    int shadow = f->plan->needs.shadow;
    for (uint32_t k = 0; k + 1 < f->plan->views; k++) {
        if (!masu_view_draws(f, 1 + k)) continue;
        boxes[k] = shadow ? around_cascade(&s->cascades[k])
                          : around_scene(&bounds->initial, f->u.sun_direction);
        set_box_planes(&boxes[k], &v->planes[1 + k]);
        if (shadow && !(masu_frame_rung_plan(f)->slow >> k & 1u)) {
            outline o = outline_of(&boxes[k], s->distance, f);
            add_outline(&o, &boxes[k], 4.0 * texel_of(&s->cascades[k]), &v->planes[1 + k]);
        }
    }
}

/* The cascades share one part of the atlas, a square around all casters of this frame. Cascades
 * are nested, so an occluder in the part is an occluder in each of them; but a cascade biases
 * surfaces away from the sun, and so a mesh may be slightly behind its occluder. */
static void set_suns(masu_views *v, const masu_bounds *bounds, const masu_shadow *s,
                     const masu_frame_data *f, float step) {
    sun_box boxes[MASU_CASCADES_MAX], all;
    uint32_t suns = f->plan->views - 1, any = 0;
    int shadow = f->plan->needs.shadow;
    set_sun_boxes(v, bounds, s, f, boxes);
    for (uint32_t k = 0; k < suns; k++) {
        if (!masu_view_draws(f, 1 + k)) continue;
        all = any ? around_both(&all, &boxes[k]) : boxes[k];
        any = 1;
    }
    if (!any || !f->plan->occlusion) return;
    all.half[0] = all.half[1] = fmax(all.half[0], all.half[1]);
    masu_occlusion_view shared = v->stage2[1];
    set_atlas(&shared, 1);
    set_sun_view(&all, f->eye, &shared);
    double texel = 2.0 * all.half[0] / MASU_ATLAS_SUN, coarsest = shadow ? 0.0 : texel;
    for (uint32_t k = 0; k < suns && shadow; k++) {
        if (masu_view_draws(f, 1 + k)) coarsest = fmax(coarsest, texel_of(&s->cascades[k]));
    }
    shared.margin = (float)((double)step * coarsest / texel);
    for (uint32_t k = 0; k < suns; k++) {
        double bias = shadow ? MASU_SHADOW_BIAS_MOST * texel_of(&s->cascades[k]) : 0.0;
        shared.bias = (float)(bias / (all.behind + all.ahead) + 2e-6);
        if (shadow) {
            shared.trimmed = !(masu_frame_rung_plan(f)->slow >> k & 1u);
            shared.reach = (float)(2.5 * texel_of(&s->cascades[k]) / texel) + 0.01f;
        }
        v->stage2[1 + k] = shared;
    }
}

/* ---- The camera ------------------------------------------------------------------------------ */

/* Lengths of one at depth one, in pixels: of the two axes the one of more. */
static void set_lods(masu_lod_view *lod, const masu_frame_data *f) {
    const struct masu_frame_uniforms *u = &f->u;
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    float x = 0.5f * (float)rp->render_width / u->right[3];
    float y = 0.5f * (float)rp->render_height / u->up[3];
    lod->pixels = x > y ? x : y;
    double side = (double)u->right[3] * (1.0 + fabs((double)u->jitter[0]));
    double edge = (double)u->up[3] * (1.0 + fabs((double)u->jitter[1]));
    lod->widest = 1.0 / sqrt(1.0 + side * side + edge * edge);
    lod->threshold = masu_frame_rung(f)->lod_error;
    for (uint32_t k = 0; k < 3; k++) {
        lod->eye[k] = f->eye[k];
        lod->forward[k] = (double)u->forward[k];
    }
}

static void set_camera(masu_occlusion_view *v, const masu_frame_data *f, float step) {
    const struct masu_frame_uniforms *u = &f->u;
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    set_atlas(v, 0);
    memcpy(v->clip, u->clip_from_rel, sizeof v->clip);
    float across = v->atlas[2] / (float)rp->render_width;
    float down = v->atlas[3] / (float)rp->render_height;
    v->margin = step * (across > down ? across : down);
    v->eye[3] = 1.0f;
    v->near_distance = u->forward[3];
    float side = u->right[3] * (1.0f + fabsf(u->jitter[0]));
    float edge = u->up[3] * (1.0f + fabsf(u->jitter[1]));
    v->blind = 1.001f * u->forward[3] * sqrtf(1.0f + side * side + edge * edge);
}

void masu_views_set(masu_views *v, const masu_bounds *bounds, const masu_shadow *s,
                    const masu_frame_data *f) {
    set_lods(&v->lod, f);
    masu_cull_camera(&v->planes[0], f->u.clip_from_rel, f->eye, f->u.forward[3]);
    memset(v->stage2, 0, sizeof v->stage2);
    /* How far the raster may move an edge, in its own texels. */
    float step = ldexpf(1.0f, -(int)f->device->vk.properties.limits.subPixelPrecisionBits);
    set_suns(v, bounds, s, f, step);
    set_camera(&v->stage2[0], f, step);
}

/* shadow.c: see shadow.h. */
#include "frame/shadow.h"

#include <math.h>
#include <string.h>

/* Slow cascades are larger by this factor: the view may move by this share of their radius
 * before they must be rendered out of order. */
#define SLACK 0.1
/* Shadows fade over the last tenth of their distance. */
#define FADE 0.1

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Duff et al., JCGT 6-1, 2017, with y and z exchanged. */
void masu_shadow_axes(const double sun[3], double axis[3][3]) {
    double x = sun[0], y = sun[1], z = sun[2];
    double s = y < 0.0 ? -1.0 : 1.0, a = -1.0 / (s + y), b = x * z * a;
    const double across[2][3] = {{1.0 + s * x * x * a, -s * x, s * b}, {b, -z, s + z * z * a}};
    memcpy(axis[0], across[0], sizeof across[0]);
    memcpy(axis[1], across[1], sizeof across[1]);
    memcpy(axis[2], sun, 3 * sizeof *sun);
}

double masu_shadow_begin(double near_distance, double distance) {
    return near_distance > 0.5 * distance ? fmin(near_distance, distance) : 0.0;
}

double masu_shadow_split(double near_distance, double distance, double lambda, uint32_t k,
                         uint32_t n) {
    double first = fmin(fmax(near_distance, distance / 256.0), distance);
    double share = (double)(k + 1) / (double)n;
    if (k + 1 >= n) return distance;
    return lambda * first * pow(distance / first, share) + (1.0 - lambda) * distance * share;
}

/* The smallest sphere around the pyramid from the camera to `depth` touches its tip and its
 * corners; for wide ones it is the sphere of the base only. For a frustum that begins later it
 * touches all corners. */
static void sphere_of(double begin, double depth, double tan2, double *along, double *radius) {
    double middle = 0.5 * (begin + depth) * (1.0 + tan2), beyond = depth - middle;
    int wide = middle >= depth;
    *along = wide ? depth : middle;
    *radius = wide          ? depth * sqrt(tan2)
              : begin > 0.0 ? sqrt(beyond * beyond + depth * depth * tan2)
                            : middle;
}

/* v rounded to a multiple of step. */
static double snap(double v, double step) { return floor(v / step + 0.5) * step; }

static double support(const masu_shadow_view *view, const double axis[3], const double center[3]) {
    double s = 0.0;
    for (uint32_t i = 0; i < 3; i++)
        s += axis[i] * (view->casters[axis[i] > 0.0 ? 1 : 0][i] - center[i]);
    return s;
}

masu_cascade masu_cascade_fit(const masu_shadow_view *view, double depth, double slack,
                              uint32_t size) {
    masu_cascade c;
    double along, middle[3], at[3];
    memset(&c, 0, sizeof c);
    c.size = size;
    masu_shadow_axes(view->sun, c.axis);
    sphere_of(view->begin, depth, view->tan2, &along, &c.radius);
    for (uint32_t i = 0; i < 3; i++) middle[i] = view->eye[i] + view->forward[i] * along;
    /* Two texels on each side for the filter, half of one for the snapping below. */
    c.half = c.radius * (1.0 + slack) / (1.0 - 4.0 / (double)size);
    double texel = 2.0 * c.half / (double)size, step = c.radius / 8.0;
    at[0] = snap(dot(c.axis[0], middle), texel);
    at[1] = snap(dot(c.axis[1], middle), texel);
    at[2] = snap(dot(c.axis[2], middle), step);
    for (uint32_t i = 0; i < 3; i++)
        c.center[i] = c.axis[0][i] * at[0] + c.axis[1][i] * at[1] + c.axis[2][i] * at[2];
    c.behind = c.radius * (1.0 + slack) + step;
    /* Grows by doubling, so that moving casters do not change the depth scale in every frame. */
    c.ahead = c.behind;
    int any = view->casters[0][0] <= view->casters[1][0];
    double reach = any ? fmin(support(view, c.axis[2], c.center), 1e30) : 0.0;
    while (c.ahead < reach) c.ahead *= 2.0;
    return c;
}

int masu_cascade_holds(const masu_cascade *drawn, const masu_cascade *wanted) {
    double d[3], usable = drawn->half * (1.0 - 3.0 / (double)drawn->size);
    if (drawn->trimmed || drawn->size != wanted->size || drawn->half != wanted->half) return 0;
    if (drawn->lod_error != wanted->lod_error) return 0;
    for (uint32_t i = 0; i < 3; i++) d[i] = wanted->center[i] - drawn->center[i];
    double z = dot(drawn->axis[2], d);
    return fabs(dot(drawn->axis[0], d)) + wanted->radius <= usable &&
           fabs(dot(drawn->axis[1], d)) + wanted->radius <= usable &&
           wanted->radius - z <= drawn->behind && wanted->radius + z <= drawn->ahead;
}

void masu_cascade_write(const masu_cascade *c, const double eye[3], const double origin[3],
                        const int32_t place[2], uint32_t k, struct masu_shadow_uniforms *u) {
    double to_eye[3], metre = 1.0 / (c->behind + c->ahead);
    for (uint32_t i = 0; i < 3; i++) {
        to_eye[i] = eye[i] - c->center[i];
        u->row0[k][i] = (float)(c->axis[0][i] / c->half);
        u->row1[k][i] = (float)(c->axis[1][i] / c->half);
        u->row2[k][i] = (float)(c->axis[2][i] * metre);
        masu_split_double(c->center[i] - origin[i], &u->origin_hi[k][i], &u->origin_lo[k][i]);
    }
    u->row0[k][3] = (float)(dot(c->axis[0], to_eye) / c->half);
    u->row1[k][3] = (float)(dot(c->axis[1], to_eye) / c->half);
    u->row2[k][3] = (float)((dot(c->axis[2], to_eye) + c->behind) * metre);
    u->origin_hi[k][3] = (float)(2.0 * c->half / (double)c->size);
    u->origin_lo[k][3] = (float)metre;
    u->rect[k][0] = (float)place[0];
    u->rect[k][1] = (float)place[1];
    u->rect[k][2] = (float)c->size;
    u->rect[k][3] = (float)(c->behind * metre);
}

/* ---- Of a frame ------------------------------------------------------------------------------ */

static masu_shadow_view shadow_view(const masu_bounds *bounds, const masu_frame_data *f) {
    const struct masu_frame_uniforms *u = &f->u;
    masu_shadow_view v;
    memset(&v, 0, sizeof v);
    double x = f->widest[0], y = f->widest[1], length = 0.0;
    v.tan2 = x * x + y * y;
    v.near_distance = (double)u->forward[3];
    memcpy(v.casters, bounds->swept, sizeof v.casters);
    for (uint32_t i = 0; i < 3; i++) {
        v.eye[i] = f->eye[i];
        v.forward[i] = (double)u->forward[i];
        v.sun[i] = (double)u->sun_direction[i];
        length += v.sun[i] * v.sun[i];
    }
    for (uint32_t i = 0; i < 3; i++) v.sun[i] /= sqrt(length); /* a unit vector of floats */
    return v;
}

void masu_shadow_write(masu_shadow *s, const masu_bounds *bounds, masu_frame_data *f) {
    const masu_rung_plan *rp = masu_frame_rung_plan(f);
    const masu_rung *rung = masu_frame_rung(f);
    const masu_scene_data *scene = &f->plan->scene;
    if (!f->plan->needs.shadow) return;
    masu_shadow_view view = shadow_view(bounds, f);
    struct masu_shadow_uniforms out;
    memset(&out, 0, sizeof out);
    double distance = (double)scene->shadow_distance, wish = (double)rung->shadow_distance;
    double begin = view.begin =
        masu_shadow_begin(view.near_distance, (double)scene->shadow_distance);
    if (wish > 0.0 && begin + wish < distance) distance = begin + wish;
    s->distance = distance;
    for (uint32_t k = 0; k < rp->cascades; k++) {
        masu_cascade *c = &s->cascades[k];
        uint32_t every = rung->shadow_refresh[k];
        int slow = (rp->slow >> k & 1u) != 0;
        double depth = begin + masu_shadow_split(view.near_distance - begin, distance - begin,
                                                 (double)scene->shadow_lambda, k, rp->cascades);
        masu_cascade wanted = masu_cascade_fit(&view, depth, slow ? SLACK : 0.0, rp->cascade_size);
        wanted.trimmed = !slow;
        wanted.lod_error = rung->lod_error;
        /* Offset by the cascade's index, so that two of the same period are rendered in
         * different frames. */
        int due = !slow || (f->number + k) % every == 0 || f->number - c->frame >= every;
        if (due || !c->drawn || f->cut || !masu_cascade_holds(c, &wanted)) {
            *c = wanted;
            c->drawn = 1;
            c->frame = f->number;
            f->cascades |= 1u << k;
        }
        VkOffset2D place = masu_cascade_place(f->plan, k);
        masu_cascade_write(c, f->eye, f->origin, (int32_t[2]){place.x, place.y}, k, &out);
    }
    /* A recording that draws all that its rung has does not keep the rest (record.c). */
    for (uint32_t k = rp->cascades; k < MASU_CASCADES_MAX; k++) {
        if (f->cascades + 1 == 1u << rp->cascades) s->cascades[k].drawn = 0;
    }
    out.reach[0] = (float)rp->cascades;
    out.reach[1] = (float)(begin + (distance - begin) * (1.0 - FADE));
    out.reach[2] = (float)(1.0 / fmax((distance - begin) * FADE, 1e-6));
    out.reach[3] = f->plan->needs.sdf_occlusion ? 1.0f : 0.0f;
    memcpy(masu_frame_slot(f, MASU_BUFFER_SHADOW), &out, sizeof out);
}

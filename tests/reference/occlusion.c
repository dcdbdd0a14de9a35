/* occlusion.c: see occlusion.h. Rays follow a sunflower spiral: the k-th of n at radius sqrt((k +
 * 1/2) / n), each rotated by the golden angle from the last. The same spiral on the unit disc,
 * projected up to the hemisphere, is cosine-weighted. */
#include "occlusion.h"

#include <math.h>

enum { STEPS = 20000 };

static const double golden = 2.399963229728653;

static double extent(const double p[3]) {
    return fmax(1, fmax(fabs(p[0]), fmax(fabs(p[1]), fabs(p[2]))));
}

/* Distance of the first hit before the limit, or -1. A ray that is still active after all steps is
 * creeping along a surface: it is treated as a hit there. */
static double hit(const masu_ref_field *f, const double from[3], const double d[3], double limit) {
    for (int k = 0; k < 3; k++) {
        if (fabs(d[k]) < 1e-300) continue;
        limit = fmin(limit, fmax((f->low[k] - from[k]) / d[k], (f->high[k] - from[k]) / d[k]));
    }
    double t = 0, near = 1e-9 * extent(from);
    for (int i = 0; i < STEPS; i++) {
        if (!(t < limit)) return -1;
        double p[3] = {from[0] + d[0] * t, from[1] + d[1] * t, from[2] + d[2] * t};
        double step = f->step(f->params, f->time, p);
        if (!isfinite(step)) return -1;
        if (step < near) return t;
        t += step;
    }
    return t;
}

/* Two unit directions orthogonal to n and to each other. */
static void across(const double n[3], double u[3], double v[3]) {
    int least = fabs(n[0]) < fabs(n[1]) ? 0 : 1;
    if (fabs(n[2]) < fabs(n[least])) least = 2;
    for (int k = 0; k < 3; k++) u[k] = (k == least) - n[k] * n[least];
    double length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int k = 0; k < 3; k++) u[k] /= length;
    for (int k = 0; k < 3; k++)
        v[k] = n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3];
}

/* The k-th of `rays` directions: n cos + a point on a disc of that radius, normalised. */
static void spread(const double n[3], double cosine, double radius, int k, double out[3]) {
    double u[3], v[3], length = 0;
    across(n, u, v);
    for (int i = 0; i < 3; i++) {
        out[i] = n[i] * cosine + radius * (u[i] * cos(golden * k) + v[i] * sin(golden * k));
        length += out[i] * out[i];
    }
    for (int i = 0; i < 3; i++) out[i] /= sqrt(length);
}

/* A point slightly off the surface, so that the ray does not hit it at once. */
static void lift(const double point[3], const double normal[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = point[k] + normal[k] * 1e-7 * extent(point);
}

double masu_ref_sun_seen(const masu_ref_field *field, const double point[3], const double normal[3],
                         const double sun[3], double tangent, double distance, int rays) {
    double from[3], d[3];
    int free_rays = 0;
    lift(point, normal, from);
    for (int k = 0; k < rays; k++) {
        spread(sun, 1, tangent * sqrt((k + 0.5) / rays), k, d);
        double cosine = d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2];
        free_rays += cosine > 0 && hit(field, from, d, distance) < 0;
    }
    return (double)free_rays / rays;
}

double masu_ref_ambient_seen(const masu_ref_field *field, const double point[3],
                             const double normal[3], double radius, int rays) {
    double from[3], d[3], sum = 0;
    lift(point, normal, from);
    for (int k = 0; k < rays; k++) {
        double r2 = (k + 0.5) / rays;
        spread(normal, sqrt(1 - r2), sqrt(r2), k, d);
        double t = hit(field, from, d, radius);
        sum += t < 0 ? 1 : t / radius;
    }
    return sum / rays;
}

/* truth.c: see truth.h. */
#include "measure/truth.h"

#include "image.h"

#include <dlfcn.h>
#include <float.h>
#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { STEPS = 4096, ROUNDS = 16, PROBES = 32, THREADS_MAX = 16 };

/* ---- The library ----------------------------------------------------------------------------- */

bool masu_truth_path(const char *scene, char *out, size_t size) {
    size_t n = strlen(scene), cut = n > 5 && !strcmp(scene + n - 5, ".masu") ? n - 5 : n;
    return (size_t)snprintf(out, size, "%.*s.truth.so", (int)cut, scene) < size;
}

/* ISO C has no conversion from object to function pointers; POSIX guarantees that it works. */
static bool find(void *library, const char *name, void *function_pointer) {
    void *symbol = dlsym(library, name);
    memcpy(function_pointer, &symbol, sizeof symbol);
    return symbol != NULL;
}

bool masu_truth_open(const char *path, masu_truth *t, char *error, size_t size) {
    memset(t, 0, sizeof *t);
    char name[4096]; /* dlopen searches the system for a name without a slash */
    snprintf(name, sizeof name, "%s%s", strchr(path, '/') ? "" : "./", path);
    if (!masu_file_is_regular(name)) { /* dlopen would block on a FIFO */
        snprintf(error, size, "%s: is not a regular file", path);
        return false;
    }
    t->library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (!t->library) {
        const char *why = dlerror();
        snprintf(error, size, "%s", why ? why : path);
        return false;
    }
    const char *missing = NULL;
    if (!find(t->library, "masu_truth_distance", &t->distance)) missing = "masu_truth_distance";
    if (!find(t->library, "masu_truth_step", &t->step)) missing = "masu_truth_step";
    if (!find(t->library, "masu_truth_part", &t->part)) missing = "masu_truth_part";
    if (!find(t->library, "masu_truth_material", &t->material)) missing = "masu_truth_material";
    if (missing) {
        snprintf(error, size, "%s: has no %s", path, missing);
        masu_truth_close(t);
        return false;
    }
    return true;
}

void masu_truth_close(masu_truth *t) {
    if (t->library) dlclose(t->library);
    memset(t, 0, sizeof *t);
}

/* ---- One ray --------------------------------------------------------------------------------- */

typedef struct walk {
    const masu_truth *truth;
    const masu_view *view;
    const masu_view_ray *ray;
    uint32_t evals;
} walk;

static void point_at(const walk *w, double t, double p[3]) {
    for (int i = 0; i < 3; i++) p[i] = w->view->eye[i] + w->ray->direction[i] * t;
}

static double field(walk *w, double t) {
    double p[3];
    point_at(w, t, p);
    w->evals++;
    return w->truth->distance(w->view->params, w->view->time, p);
}

static double extent_at(const walk *w, double t) {
    double most = t;
    for (int i = 0; i < 3; i++)
        most = fmax(most, fabs(w->view->eye[i]) + fabs(w->ray->direction[i] * t));
    return most;
}

static double tolerance(const walk *w, double t) {
    return fmax(1e-9 * t, 32 * DBL_EPSILON * extent_at(w, t));
}

/* Finds the zero crossing between a, where the field is fa > 0, and b, where it is fb <= 0: the
 * Illinois variant of the secant method, with a bisection in every third iteration. */
static double crossing(walk *w, double a, double fa, double b, double fb) {
    int side = 0;
    if (fb == 0) return b;
    for (int i = 0; i < 200 && b - a > 4 * DBL_EPSILON * b; i++) {
        double t = i % 3 == 2 ? 0.5 * (a + b) : (a * fb - b * fa) / (fb - fa);
        if (!(t > a && t < b)) t = 0.5 * (a + b);
        double f = field(w, t);
        if (!(f > 0)) {
            b = t;
            fb = f;
            if (side == 1) fa *= 0.5;
            side = 1;
        } else {
            a = t;
            fa = f;
            if (side == -1) fb *= 0.5;
            side = -1;
        }
    }
    return 0.5 * (a + b);
}

/* Searches for a crossing within `reach` of t. The field at t is f > 0 and falls by `slope` per
 * unit of distance. It must fall from probe to probe: otherwise a crossing before the found one is
 * possible. Returns the distance, or -1. */
static double leap(walk *w, double t, double f, double slope, double reach, int probes) {
    if (!(slope > 0)) return -1;
    double far = 2 * f / slope, a = t, fa = f;
    if (!(far <= reach)) return -1;
    for (int i = 1; i <= probes; i++) {
        double b = t + far * i / probes, fb = field(w, b);
        if (!(fb < fa)) return -1;
        if (fb <= 0) return crossing(w, a, fa, b, fb);
        a = b;
        fa = fb;
    }
    return -1;
}

static double settled(double t, const masu_view_ray *r) { return t < r->limit ? t : -1; }

/* Tests for a surface near t. The field is f at t and was above 0 at the previous sample. Returns
 * the distance of the hit, or -1 to continue. */
static double near_surface(walk *w, double before_t, double t, double f, double *tried) {
    bool there = f <= tolerance(w, t);
    if (!there && !(f < 1e-6 * t && f < 0.5 * *tried)) return -1;
    if (t == w->ray->start) return there ? t : -1;
    double before_f = field(w, before_t);
    if (f <= 0) return crossing(w, before_t, before_f, t, f);
    *tried = f;
    double slope = (before_f - f) / (t - before_t);
    double found = there ? leap(w, t, f, slope, 1e-3 * t, 2) : leap(w, t, f, slope, 1e-4 * t, 4);
    return found >= 0 || !there ? found : t;
}

/* Distance of the hit, or -1. *sure is false if the search gave up. */
static double march(walk *w, bool *sure) {
    const masu_view_ray *r = w->ray;
    double t = r->start, before_t = t, tried = HUGE_VAL, best_t = t, best = HUGE_VAL;
    *sure = true;
    for (int round = 0; round < ROUNDS; round++) {
        for (int i = 0; i < STEPS; i++) {
            if (!(t < r->limit)) return -1;
            double p[3];
            point_at(w, t, p);
            w->evals++;
            double step = w->truth->step(w->view->params, w->view->time, p);
            if (!isfinite(step)) return -1;
            if (step < 1e-5 * t || t == r->start) {
                double f = field(w, t);
                if (!isfinite(f)) return -1;
                double found = near_surface(w, before_t, t, f, &tried);
                if (found >= 0) return settled(found, r);
            }
            if (step / t < best) {
                best = step / t;
                best_t = t;
            }
            before_t = t;
            t += step;
            if (!(t > before_t)) t = nextafter(before_t, HUGE_VAL);
        }
        /* The ray may approach a surface at a grazing angle. */
        double f = field(w, before_t), next = field(w, t);
        double found = leap(w, t, next, (f - next) / (t - before_t), r->limit - t, PROBES);
        if (found >= 0) return settled(found, r);
    }
    *sure = false;
    return best_t;
}

static void normal_at(walk *w, double t, double out[3]) {
    double p[3], length = 0;
    point_at(w, t, p);
    /* The field's rounding error is a few ulp of the coordinates. The step must be thousands of
     * times larger even far from the origin. */
    double h = fmax(1e-7 * t, 32e3 * DBL_EPSILON * extent_at(w, t));
    for (int i = 0; i < 3; i++) {
        double a[3] = {p[0], p[1], p[2]}, b[3] = {p[0], p[1], p[2]};
        a[i] += h;
        b[i] -= h;
        out[i] = w->truth->distance(w->view->params, w->view->time, a) -
                 w->truth->distance(w->view->params, w->view->time, b);
        length += out[i] * out[i];
    }
    length = sqrt(length);
    w->evals += 6;
    for (int i = 0; i < 3; i++) {
        out[i] = length > 0 && isfinite(length) ? out[i] / length : -w->ray->direction[i];
    }
}

void masu_truth_march(const masu_truth *truth, const masu_view *view, const masu_view_ray *ray,
                      masu_truth_sample *out) {
    walk w = {truth, view, ray, 0};
    bool sure;
    memset(out, 0, sizeof *out);
    out->part = -1;
    out->t = march(&w, &sure);
    out->kind = !sure ? MASU_TRUTH_UNSURE : out->t >= 0 ? MASU_TRUTH_HIT : MASU_TRUTH_MISS;
    if (out->kind == MASU_TRUTH_HIT) {
        double p[3];
        point_at(&w, out->t, p);
        out->part = truth->part(view->params, view->time, p);
        normal_at(&w, out->t, out->normal);
    }
    out->evals = w.evals;
}

/* ---- Images ---------------------------------------------------------------------------------- */

typedef struct picture {
    const masu_truth *truth;
    const masu_view *view;
    uint32_t stride, columns, rows;
    masu_truth_sample *out;
    atomic_uint next_row;
} picture;

static void *work(void *user) {
    picture *p = user;
    for (;;) {
        uint32_t row = atomic_fetch_add(&p->next_row, 1);
        if (row >= p->rows) return NULL;
        for (uint32_t column = 0; column < p->columns; column++) {
            masu_view_ray ray = masu_view_ray_at(p->view, column * p->stride, row * p->stride);
            masu_truth_march(p->truth, p->view, &ray, &p->out[(size_t)row * p->columns + column]);
        }
    }
}

uint32_t masu_truth_columns(uint32_t size, uint32_t stride) { return (size + stride - 1) / stride; }

void masu_truth_image(const masu_truth *truth, const masu_view *view, uint32_t stride,
                      masu_truth_sample *out) {
    picture p = {truth,
                 view,
                 stride,
                 masu_truth_columns(view->width, stride),
                 masu_truth_columns(view->height, stride),
                 out,
                 0};
    pthread_t threads[THREADS_MAX];
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    int wanted = processors > THREADS_MAX ? THREADS_MAX : (int)processors, made = 0;
    /* This thread works too; a failure to create a thread only costs time. */
    while (made < wanted - 1 && !pthread_create(&threads[made], NULL, work, &p)) made++;
    work(&p);
    while (made > 0) pthread_join(threads[--made], NULL);
}

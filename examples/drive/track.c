/* track.c: see race.h. Between two points all is linear; the last is followed by the first. */
#include "race.h"

#include <stdio.h>
#include <string.h>

#define GRIP 9.0    /* m/s2 of lateral acceleration of the autopilot */
#define BRAKING 6.0 /* and brakes with */
#define FASTEST 58.0
#define REACH 12 /* points looked at before and behind the last one */

static bool read_row(FILE *in, track_point *p) {
    double *to[12] = {&p->at.x, &p->at.y, &p->at.z, &p->up.x, &p->up.y, &p->up.z, &p->edge[0],
                      &p->edge[1], &p->barrier[0], &p->barrier[1], &p->rise[0], &p->rise[1]};
    int read = 0;
    while (read < 12 && fscanf(in, "%lf", to[read]) == 1 && fabs(*to[read]) < 1e6) read++;
    return read == 12;
}

static bool read_cars(FILE *in, track *t) {
    char word[8];
    for (track_car *c = NULL; fscanf(in, "%7s", word) == 1;) {
        bool good = false;
        if (!strcmp(word, "car") && t->cars < TRACK_CARS) {
            c = &t->car[t->cars++];
            good = fscanf(in, "%31s %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", c->name, &c->at.x,
                          &c->at.y, &c->at.z, &c->ahead.x, &c->ahead.y, &c->ahead.z, &c->up.x,
                          &c->up.y, &c->up.z, &c->clearance) == 11;
        } else if (!strcmp(word, "wheel") && c && c->wheels < TRACK_WHEELS) {
            track_wheel *w = &c->wheel[c->wheels++];
            good = fscanf(in, "%31s %lf %lf %lf %d", w->name, &w->ahead, &w->right, &w->radius,
                          &w->steers) == 5;
        }
        if (!good) return false;
    }
    return t->cars > 0;
}

/* Computes direction, distance and speed limit of each point: first from curvature, then from
 * the braking distance to the next curve, in two laps. */
static void measure(track *t) {
    int n = t->count;
    for (int i = 0; i < n; i++) {
        track_point *p = &t->points[i], *next = &t->points[(i + 1) % n];
        vec step = add(next->at, p->at, -1);
        p->ahead = unit(add(next->at, t->points[(i + n - 1) % n].at, -1));
        p->along = t->length;
        t->length += sqrt(dot(step, step));
    }
    for (int i = 0; i < n; i++) {
        const track_point *a = &t->points[(i + n - 2) % n], *b = &t->points[(i + 2) % n];
        vec turn = add(b->ahead, a->ahead, -1), chord = add(b->at, a->at, -1);
        double bend = sqrt(dot(turn, turn) / fmax(dot(chord, chord), 1e-6));
        t->points[i].pace = fmin(FASTEST, sqrt(GRIP / fmax(bend, 1e-6)));
    }
    for (int i = 2 * n; i-- > 0;) {
        track_point *p = &t->points[i % n], *next = &t->points[(i + 1) % n];
        double step = fmod(next->along - p->along + t->length, t->length);
        p->pace = fmin(p->pace, sqrt(next->pace * next->pace + 2 * BRAKING * step));
    }
}

bool track_read(track *t, const char *path) {
    FILE *in = fopen(path, "r");
    if (!in) return fprintf(stderr, "drive: cannot open the track %s\n", path), false;
    memset(t, 0, sizeof *t);
    int version = 0;
    bool good = fscanf(in, "masu-track %d points %d", &version, &t->count) == 2 && version == 1 &&
                t->count >= 8 && t->count <= TRACK_POINTS;
    for (int i = 0; good && i < t->count; i++) good = read_row(in, &t->points[i]);
    good = good && read_cars(in, t);
    fclose(in);
    if (good) measure(t);
    if (good && t->length > 1 && t->length < 1e6) return true;
    fprintf(stderr, "drive: %s: expected a track of version 1, with at least 8 points\n", path);
    return false;
}

static track_place between(const track *t, int i, double share, double side) {
    const track_point *a = &t->points[i], *b = &t->points[(i + 1) % t->count];
    double step = (i + 1 < t->count ? b->along : t->length) - a->along;
    int k = side > 0;
    track_place p = {.point = i,
                     .along = a->along + share * step,
                     .side = side,
                     .ahead = unit(mix(a->ahead, b->ahead, share)),
                     .up = unit(mix(a->up, b->up, share)),
                     .edge = a->edge[k] + share * (b->edge[k] - a->edge[k]),
                     .barrier = a->barrier[k] + share * (b->barrier[k] - a->barrier[k]),
                     .pace = a->pace + share * (b->pace - a->pace)};
    p.right = unit(cross(p.ahead, p.up));
    double rise = a->rise[k] + share * (b->rise[k] - a->rise[k]); /* evenly, from the edge on */
    double beyond = clamp((fabs(side) - p.edge) / fmax(p.barrier - p.edge, 0.1), 0, 1);
    p.ground = add(add(mix(a->at, b->at, share), p.right, side), p.up, rise * beyond);
    return p;
}

track_place track_find(const track *t, vec at, int near) {
    int n = t->count, found = 0;
    int first = near < 0 ? 0 : near - REACH, many = near < 0 ? n : 2 * REACH + 1;
    double best = HUGE_VAL, best_share = 0;
    for (int k = 0; k < many; k++) {
        int i = ((first + k) % n + n) % n;
        vec from = t->points[i].at, to = add(at, from, -1);
        vec step = add(t->points[(i + 1) % n].at, from, -1);
        double share = clamp(dot(to, step) / fmax(dot(step, step), 1e-12), 0, 1);
        vec off = add(to, step, -share);
        if (dot(off, off) >= best) continue;
        best = dot(off, off), best_share = share, found = i;
    }
    track_place p = between(t, found, best_share, 0);
    return between(t, found, best_share, dot(add(at, p.ground, -1), p.right));
}

track_place track_along(const track *t, double along, double side) {
    int i = 0;
    along -= t->length * floor(along / t->length);
    while (i + 1 < t->count && t->points[i + 1].along <= along) i++;
    double end = i + 1 < t->count ? t->points[i + 1].along : t->length;
    return between(t, i, (along - t->points[i].along) / fmax(end - t->points[i].along, 1e-9), side);
}

/* car.c: see car.h.
 *
 * A car is a point with a heading. Its front wheels ask for a turn, of which the tyres give as much as
 * they hold; what its velocity has across its heading they take away by and by, and that lag is the
 * slip. Grass holds less and slows down. Numbers are those that felt right, not those of any car. */
#include "car.h"

#include <string.h>

#define BASE 2.7        /* metres between the axles */
#define PUSH 9.5        /* m/s2 of the motor at rest; it falls to 0 at TOP */
#define TOP 72.0
#define BACK 9.0        /* m/s backwards at most */
#define BRAKES 13.0     /* m/s2 */
#define AIR 0.0009      /* of drag: m/s2 for each (m/s)2 */
#define ROLLING 0.35    /* m/s2 */
#define GRASS 5.0       /* m/s2 more beside the road, at speed */
#define HOLD 15.0       /* m/s2 that the tyres hold across; on grass HOLD_GRASS */
#define HOLD_GRASS 6.0
#define STRAIGHTEN 7.0  /* 1/s: how fast slip is taken away, on grass and with the handbrake less */
#define WIDTH 1.0       /* half of a car's */
#define APART 3.4       /* metres between two cars that touch */

double car_speed(const car *c) { return dot(c->velocity, c->ahead); }

static void settle(car *c, vec forward) {
    c->up = c->place.up;
    c->ahead = unit(add(forward, c->up, -dot(forward, c->up)));
    c->at.y = c->place.ground.y;
}

static double wrapped(const track *t, double metres) {
    return metres > t->length / 2 ? metres - t->length : metres < -t->length / 2 ? metres + t->length : metres;
}

void race_start(race *r, const track *t, int player) {
    memset(r, 0, sizeof *r);
    r->track = t;
    r->player = player;
    for (int i = 0; i < t->cars; i++) {
        car *c = &r->cars[i];
        c->at = t->car[i].at;
        c->heading = atan2(-t->car[i].ahead.z, t->car[i].ahead.x);
        c->place = track_find(t, c->at, -1);
        c->travelled = c->place.along;
        c->lane = c->place.side;
        settle(c, t->car[i].ahead);
    }
}

static double toward(double from, double to, double most) { return from + clamp(to - from, -most, most); }

static void drive(race *r, car *c, const car_input *in, double dt) {
    vec forward = {cos(c->heading), 0, -sin(c->heading)}, right = {sin(c->heading), 0, cos(c->heading)};
    double speed = dot(c->velocity, forward), slip = dot(c->velocity, right), before = speed;
    double full = 0.6 / (1 + fabs(speed) / 14); /* the faster, the less the wheels turn */
    c->steer = toward(c->steer, in->steer * full, 1.8 * dt);
    speed += in->throttle * PUSH * (1 - speed / TOP) * dt;
    if (in->brake > 0 && speed <= 0.1) speed = fmax(speed - in->brake * PUSH / 2 * dt, -BACK);
    else speed = toward(speed, 0, in->brake * BRAKES * dt);
    double resists = ROLLING + AIR * speed * speed + (in->handbrake ? BRAKES / 2 : 0);
    if (c->off) resists += GRASS * fmin(fabs(speed) / 8, 1);
    speed = toward(speed, 0, resists * dt);
    double hold = c->off ? HOLD_GRASS : HOLD;
    double turn = speed * tan(c->steer) / BASE; /* radians/s, right */
    turn = clamp(turn, -hold / fmax(fabs(speed), 1), hold / fmax(fabs(speed), 1));
    if (in->handbrake) turn *= 1.5;
    slip *= exp(-(c->off || in->handbrake ? 0.3 : 1) * STRAIGHTEN * dt);
    c->velocity = add(add((vec){0, 0, 0}, forward, speed), right, slip);
    c->heading -= turn * dt;
    c->lean += (clamp(turn * speed * 0.0035, -0.06, 0.06) - c->lean) * fmin(6 * dt, 1);
    c->pitch += (clamp((speed - before) / dt * 0.0025, -0.04, 0.03) - c->pitch) * fmin(6 * dt, 1);
    c->roll += speed * dt;
    c->at = add(c->at, c->velocity, dt);
    r->distance += sqrt(dot(c->velocity, c->velocity)) * dt;
}

/* The barrier takes what runs into it, and some of what slides along. */
static void keep_in(race *r, car *c) {
    double most = fmax(c->place.barrier - WIDTH, 0), over = fabs(c->place.side) - most;
    if (over <= 0) return;
    vec across = cross(c->place.ahead, c->place.up);
    vec out = unit((vec){c->place.side > 0 ? across.x : -across.x, 0, c->place.side > 0 ? across.z : -across.z});
    double into = dot(c->velocity, out);
    c->at = add(c->at, out, -over);
    if (into <= 0) return;
    r->hits += into > 1;
    c->velocity = add(c->velocity, out, -1.3 * into);
    c->velocity = add(c->velocity, c->velocity, -clamp(0.04 * into, 0, 0.6));
}

static void keep_apart(race *r, car *c) {
    for (int i = 0; i < r->track->cars; i++) {
        vec from = add(c->at, r->cars[i].at, -1);
        double metres = sqrt(dot(from, from));
        if (i == r->player || metres >= APART) continue;
        vec out = unit((vec){from.x, 0, from.z});
        double into = -dot(add(c->velocity, r->cars[i].velocity, -1), out);
        c->at = add(c->at, out, APART - metres);
        if (into <= 0) continue;
        r->hits += into > 1;
        c->velocity = add(c->velocity, out, 1.2 * into);
    }
}

/* The others keep to the road's pace, each in its lane, and behind who is in front. */
static void follow(race *r, int i, double dt) {
    car *c = &r->cars[i];
    double speed = sqrt(dot(c->velocity, c->velocity)), wanted = c->place.pace * (0.82 + 0.02 * (i % 6));
    for (int k = 0; k < r->track->cars; k++) {
        double gap = wrapped(r->track, r->cars[k].place.along - c->place.along);
        bool beside = fabs(r->cars[k].place.side - c->place.side) > 2.2;
        if (k != i && gap > 0 && gap < 20 && !beside) wanted = fmin(wanted, fmax(gap - 7, 0) * 3);
    }
    speed = toward(speed, wanted, (wanted > speed ? 5 : BRAKES) * dt);
    vec old = c->ahead;
    c->travelled += speed * dt;
    c->place = track_along(r->track, c->travelled, c->lane);
    c->at = c->place.ground;
    settle(c, c->place.ahead);
    double turn = dot(cross(c->ahead, old), c->up) / dt;
    c->velocity = add((vec){0, 0, 0}, c->ahead, speed);
    c->steer += (atan(turn * BASE / fmax(speed, 3)) - c->steer) * fmin(8 * dt, 1);
    c->roll += speed * dt;
}

void race_step(race *r, const car_input *input, double dt) {
    car *c = &r->cars[r->player];
    for (int i = 0; i < r->track->cars; i++) {
        if (i != r->player) follow(r, i, dt);
    }
    double along = c->place.along;
    drive(r, c, input, dt);
    keep_apart(r, c);
    c->place = track_find(r->track, c->at, c->place.point);
    keep_in(r, c);
    c->place = track_find(r->track, c->at, c->place.point);
    c->off = fabs(c->place.side) > c->place.edge;
    settle(c, (vec){cos(c->heading), 0, -sin(c->heading)});
    c->travelled += wrapped(r->track, c->place.along - along);
    r->time += dt;
    if (floor(c->travelled / r->track->length) <= r->laps) return;
    r->laps++; /* who turns round and crosses the line again has won nothing */
    r->last = r->time;
    if (r->best == 0 || r->last < r->best) r->best = r->last;
    r->time = 0;
}

int race_position(const race *r) {
    int position = 1;
    for (int i = 0; i < r->track->cars; i++) position += r->cars[i].travelled > r->cars[r->player].travelled;
    return position;
}

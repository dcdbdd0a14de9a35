/* car.c: see race.h.
 *
 * A car is a point with a heading. The steering requests a yaw rate, limited by the tyres' grip.
 * The tyres reduce the sideways velocity gradually: this delay is the slip. Grass has less grip
 * and more drag. The constants are tuned by feel and model no real car. */
#include "race.h"

#include <string.h>

#define BASE 2.7       /* metres between the axles */
#define PUSH 9.5       /* m/s2 of the motor at standstill; it falls to 0 at TOP */
#define TOP 72.0
#define BACK 9.0       /* m/s backwards at most */
#define BRAKES 13.0    /* m/s2 */
#define AIR 0.0009     /* of drag: m/s2 for each (m/s)2 */
#define ROLLING 0.35   /* m/s2 */
#define GRASS 5.0      /* additional m/s2 of drag off the road, at speed */
#define HOLD 15.0      /* m/s2 that the tyres hold across; on grass HOLD_GRASS */
#define HOLD_GRASS 6.0
#define STRAIGHTEN 7.0 /* 1/s: how fast slip is taken away, on grass less */
#define SLIDE 0.1      /* of STRAIGHTEN while the handbrake is on */
#define SLIP 1.7       /* m/s across from which tyres skid */
#define WIDTH 1.0      /* half of a car's */
#define APART 3.4      /* metres between two cars that touch */
#define FOLLOW 7.0     /* 1/s: how fast the camera approaches its target */

double car_speed(const car *c) { return dot(c->velocity, c->ahead); }

static vec level(double heading) { return (vec){cos(heading), 0, -sin(heading)}; }

/* Onto the ground, wherever it has moved to. */
static void settle(const track *t, car *c, int near) {
    c->place = track_find(t, c->at, near);
    c->off = fabs(c->place.side) > c->place.edge;
    c->up = c->place.up;
    c->ahead = unit(add(level(c->heading), c->up, -dot(level(c->heading), c->up)));
    c->at.y = c->place.ground.y;
}

/* The camera approaches its position behind the car by a share of the remaining distance that
 * does not depend on the step, above the ground and inside the barriers. dt 0: at once. */
static void chase(race *r, double dt) {
    const car *c = &r->cars[0];
    double share = dt > 0 ? 1 - exp(-FOLLOW * dt) : 1;
    vec eye = add(add(c->at, c->ahead, -5.8), c->up, 1.9);
    vec to = add(add(c->at, c->ahead, 6), c->up, 0.9);
    /* Both first move with the car: only rotation lags behind, not straight motion. */
    r->eye = mix(add(r->eye, c->velocity, dt), eye, share);
    r->target = mix(add(r->target, c->velocity, dt), to, share);
    track_place p = track_find(r->track, r->eye, c->place.point);
    double over = fabs(p.side) - fmax(p.barrier - 0.7, 0);
    if (over > 0) r->eye = add(r->eye, p.right, p.side > 0 ? -over : over);
    r->eye.y = fmax(r->eye.y, p.ground.y + 0.6);
}

void race_start(race *r, const track *t) {
    memset(r, 0, sizeof *r);
    r->track = t;
    for (int i = 0; i < t->cars; i++) {
        car *c = &r->cars[i];
        c->at = t->car[i].at;
        c->heading = atan2(-t->car[i].ahead.z, t->car[i].ahead.x);
        settle(t, c, -1);
        c->travelled = c->place.along, c->lane = c->place.side;
    }
    chase(r, 0);
}

car_input race_autopilot(const race *r, int car_number) {
    const car *c = &r->cars[car_number];
    double speed = car_speed(c), wanted = c->place.pace * (0.82 + 0.02 * (car_number % 6));
    track_place aim = track_along(r->track, c->place.along + 6 + 0.35 * speed, c->lane);
    for (int i = 0; i < r->track->cars; i++) {
        const track_place *p = &r->cars[i].place;
        double gap = remainder(p->along - c->place.along, r->track->length);
        if (i != car_number && gap > 0 && gap < 25 && fabs(p->side - c->place.side) <= 2.2)
            wanted = fmin(wanted, fmax(gap - 7, 0) * 3);
    }
    double side = dot(unit(add(aim.ground, c->at, -1)), cross(c->ahead, c->up));
    return (car_input){.steer = clamp(4 * side, -1, 1), .throttle = clamp(wanted - speed, 0, 1),
                       .brake = speed > 0.5 ? clamp(0.5 * (speed - wanted), 0, 1) : 0};
}

static double toward(double from, double to, double most) {
    return from + clamp(to - from, -most, most);
}

static void drive(car *c, const car_input *in, double dt) {
    vec forward = level(c->heading), right = level(c->heading - PI / 2);
    double speed = dot(c->velocity, forward), slip = dot(c->velocity, right);
    double full = 0.6 / (1 + fabs(speed) / 14); /* less steering at higher speed */
    c->steer = toward(c->steer, in->steer * full, 1.8 * dt);
    speed += in->throttle * PUSH * (1 - speed / TOP) * dt;
    if (in->brake > 0 && speed <= 0.1) speed = fmax(speed - in->brake * PUSH / 2 * dt, -BACK);
    else speed = toward(speed, 0, in->brake * BRAKES * dt);
    double grass = c->off ? GRASS * fmin(fabs(speed) / 8, 1) : 0;
    speed = toward(speed, 0, (ROLLING + AIR * speed * speed + grass + 4 * in->hand) * dt);
    double most = (c->off ? HOLD_GRASS : HOLD) / fmax(fabs(speed), 1);
    double turn = clamp(speed * tan(c->steer) / BASE, -most, most); /* radians/s, right */
    slip *= exp(-(c->off ? 0.3 : 1) * (1 - (1 - SLIDE) * in->hand) * STRAIGHTEN * dt);
    c->velocity = add(add((vec){0, 0, 0}, forward, speed), right, slip);
    bool locked = (in->brake > 0.9 || in->hand > 0.5) && fabs(speed) > 4;
    bool spinning = in->throttle > 0.9 && speed > 0.2 && speed < 5;
    c->braking = in->brake > 0 && speed > -0.1;
    c->skid = fmax(clamp((fabs(slip) - SLIP) / SLIP, 0, 1), locked ? 0.8 : spinning ? 0.5 : 0);
    c->heading -= turn * dt;
    c->roll += speed * dt;
    c->at = add(c->at, c->velocity, dt);
}

/* Moves the car out of an obstacle. back: restitution of the normal velocity. */
static void push(car *c, vec out, double metres, double into, double back) {
    c->at = add(c->at, out, metres);
    if (into > 0) c->velocity = add(c->velocity, out, (1 + back) * into);
}

static void collide(const race *r, car *c) {
    for (int i = 0; i < r->track->cars; i++) {
        const car *o = &r->cars[i];
        vec from = add(c->at, o->at, -1), out = unit((vec){from.x, 0, from.z});
        double metres = sqrt(dot(from, from)), into = dot(add(o->velocity, c->velocity, -1), out);
        if (o != c && metres < APART) push(c, out, APART - metres, into, 0.2);
    }
    track_place p = track_find(r->track, c->at, c->place.point);
    double over = fabs(p.side) - fmax(p.barrier - WIDTH, 0), way = p.side > 0 ? -1 : 1;
    vec in = unit((vec){way * p.right.x, 0, way * p.right.z});
    if (over > 0) push(c, in, over, -dot(c->velocity, in), 0.3);
}

void race_step(race *r, const car_input *input, double dt) {
    car *mine = &r->cars[0];
    for (int i = 0; i < r->track->cars; i++) {
        car *c = &r->cars[i];
        car_input in = i ? race_autopilot(r, i) : *input;
        double along = c->place.along;
        drive(c, &in, dt);
        collide(r, c);
        settle(r->track, c, c->place.point);
        c->travelled += remainder(c->place.along - along, r->track->length);
    }
    r->distance += sqrt(dot(mine->velocity, mine->velocity)) * dt, r->time += dt;
    chase(r, dt);
    if (floor(mine->travelled / r->track->length) <= r->laps) return;
    r->laps++; /* crossing the line backwards and again gains no lap */
    if (r->best == 0 || r->time < r->best) r->best = r->time;
    r->time = 0;
}

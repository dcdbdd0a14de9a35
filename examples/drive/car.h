/* car.h: cars that drive: the player's by its pedals, the others along the road's middle. All of it is
 * arithmetic on the track: the same inputs and steps give the same drive. */
#ifndef DRIVE_CAR_H
#define DRIVE_CAR_H

#include "track.h"

typedef struct car_input {
    double steer;    /* -1 left .. 1 right */
    double throttle; /* 0..1 */
    double brake;    /* 0..1; standing still, it drives backwards */
    bool handbrake;
} car_input;

typedef struct car {
    vec at, ahead, up; /* on the road, between the wheels */
    vec velocity;      /* world, m/s; level */
    double heading;    /* radians about +Y, 0 is +X */
    double steer;      /* of the front wheels, radians, right */
    double roll;       /* of all wheels, metres since the start */
    double lean, pitch; /* of the body, radians: what the springs give */
    double travelled;  /* metres of road since the start line, laps and all */
    double lane;       /* of the others: metres right of the middle */
    track_place place;
    bool off; /* beside the road */
} car;

typedef struct race {
    const track *track;
    car cars[TRACK_CARS]; /* as the track has them */
    int player;
    int laps;                /* of the player, finished */
    double time, best, last; /* of the lap; 0: none yet */
    double distance;         /* driven, metres */
    int hits;                /* of barriers and of other cars */
} race;

void race_start(race *r, const track *t, int player);
void race_step(race *r, const car_input *input, double dt);
double car_speed(const car *c); /* m/s, below 0 backwards */
int race_position(const race *r); /* 1: ahead of all */

#endif

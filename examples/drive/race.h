/* race.h: the track, read from a file next to the scene (docs/drive.md), and the cars on it: the
 * player's, driven by pedals, and others by an autopilot. Independent of rendering; the same
 * inputs and steps give the same drive. */
#ifndef DRIVE_RACE_H
#define DRIVE_RACE_H

#include <math.h>
#include <stdbool.h>

#define PI 3.14159265358979323846
#define TRACK_POINTS 4096
#define TRACK_CARS 16
#define TRACK_WHEELS 4

typedef struct vec {
    double x, y, z; /* metres, +Y is up */
} vec;

static inline vec add(vec a, vec b, double times) {
    return (vec){a.x + b.x * times, a.y + b.y * times, a.z + b.z * times};
}
static inline vec mix(vec a, vec b, double t) { return add(add(a, a, -t), b, t); }
static inline double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec cross(vec a, vec b) {
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec unit(vec a) { return add(a, a, 1 / fmax(sqrt(dot(a, a)), 1e-12) - 1); }
static inline double clamp(double x, double low, double high) { return fmin(fmax(x, low), high); }

typedef struct track_point {
    vec at, up, ahead;
    double along; /* metres from the first point */
    /* Left, right: metres from the centre line to the edge of the road, and to the barrier, at
     * which the ground is `rise` above the plane of the road. */
    double edge[2], barrier[2], rise[2];
    double pace; /* m/s that a careful driver has here */
} track_point;

typedef struct track_wheel {
    char name[32];
    double ahead, right, radius; /* of its middle, from the car's; it is `radius` above the road */
    int steers;
} track_wheel;

/* A car as the scene has it: its model stands at `at`, turned to `ahead` and `up`. */
typedef struct track_car {
    char name[32]; /* of the model */
    vec at, ahead, up;
    double clearance; /* from the road to the origin of the model */
    int wheels;
    track_wheel wheel[TRACK_WHEELS];
} track_car;

typedef struct track {
    track_point points[TRACK_POINTS];
    int count, cars;
    double length; /* of a lap */
    track_car car[TRACK_CARS];
} track;

typedef struct track_place {
    int point;    /* behind it */
    double along; /* of the lap */
    double side;  /* metres right of the centre line */
    vec ground, up, ahead, right;
    double edge, barrier, pace; /* on this side */
} track_place;

/* False, with one line on stderr: it is not such a file, or has more than fits. */
bool track_read(track *t, const char *path);
/* The track point nearest to `at`. near: index of the last result, to search near it; -1: all. */
track_place track_find(const track *t, vec at, int near);
track_place track_along(const track *t, double along, double side);

typedef struct car_input {
    double steer;    /* -1 left .. 1 right */
    double throttle; /* 0..1 */
    double brake;    /* 0..1; standing still, it drives backwards */
    double hand;     /* 0..1: the handbrake locks the rear wheels */
} car_input;

typedef struct car {
    vec at, ahead, up;  /* on the road, between the wheels */
    vec velocity;       /* world, m/s; level */
    double heading;     /* radians about +Y, 0 is +X */
    double steer;       /* of the front wheels, radians, right */
    double roll;        /* of all wheels, metres since the start */
    double travelled;   /* metres of road since the start line, laps and all */
    double lane;        /* of the autopilot: metres right of the centre line */
    track_place place;
    bool off; /* off the road */
    bool braking; /* its brake lights are on */
    double skid; /* 0..1: of the rear tyres */
} car;

typedef struct race {
    const track *track;
    car cars[TRACK_CARS]; /* as the track has them; the first is yours */
    int laps;             /* of yours, finished */
    double time, best;    /* of the lap; 0: none yet */
    double distance;      /* driven, metres */
    vec eye, target;      /* the chase camera's */
} race;

void race_start(race *r, const track *t);
void race_step(race *r, const car_input *input, double dt);
/* Keeps to its lane at the pace of the road, and behind who is in front. */
car_input race_autopilot(const race *r, int car);
double car_speed(const car *c); /* m/s, below 0 backwards */

#endif

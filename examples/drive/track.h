/* track.h: the road in numbers, read from a file that lies beside the scene (docs/drive.md). Who drives
 * asks it where he is; nothing here knows of pictures. */
#ifndef DRIVE_TRACK_H
#define DRIVE_TRACK_H

#include "vec.h"

#include <stdbool.h>

#define TRACK_POINTS 4096
#define TRACK_CARS 16
#define TRACK_WHEELS 4

typedef struct track_point {
    vec at, up, ahead;
    double along;      /* metres from the first point */
    double edge[2];    /* left, right: from the middle to the edge of the road, */
    double barrier[2]; /* and to where no car gets through, */
    double rise[2];    /* where the ground lies so far above the plane of the road */
    double pace;       /* m/s that a careful driver has here */
} track_point;

/* A car as the scene has it: its model stands at `at`, turned to `ahead` and `up`. */
typedef struct track_car {
    char name[32]; /* of the model */
    vec at, ahead, up;
    double clearance; /* from the road to the origin of the model */
    int wheels;
    struct {
        char name[32];
        double ahead, right, radius; /* of its middle, from the car's; the middle is `radius` above the road */
        int steers;
    } wheel[TRACK_WHEELS];
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
    double side;  /* metres right of the middle */
    vec ground, up, ahead;
    double edge, barrier; /* on this side */
    double pace;
} track_place;

/* False, with one line on stderr: it is not such a file, or has more than fits. */
bool track_read(track *t, const char *path);
/* The place nearest to `at`. near: the point of the place before, which saves looking everywhere; -1. */
track_place track_find(const track *t, vec at, int near);
track_place track_along(const track *t, double along, double side);

#endif

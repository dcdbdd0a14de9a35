/* fly.h: the camera: flown by hand, or on the scene's own path.
 *
 * Plain state and mathematics: no window, no renderer, no clock. Angles are radians; yaw 0 looks along
 * -Z and grows to the left. */
#ifndef MASU_VIEW_FLY_H
#define MASU_VIEW_FLY_H

#include "masu.h"

#include <stdbool.h>

#define MASU_FLY_SPEED_MIN 0.01
#define MASU_FLY_SPEED_MAX 10000.0

/* What the hands ask for at the moment: -1..1 along each axis of the camera, radians of turning. */
typedef struct masu_fly_wish {
    double right, up, forward;
    double yaw, pitch; /* to be added at once */
    bool fast;         /* four times as fast */
} masu_fly_wish;

typedef struct masu_fly {
    double position[3];
    double yaw, pitch;
    double speed; /* m/s */
    float fov_y, near_distance;
} masu_fly;

/* Where that camera is; a roll of it is not kept. The speed stays. */
void masu_fly_from(masu_fly *fly, const masu_camera *camera);
/* Moves by what is wished for, for so many seconds. True: there was something to do. */
bool masu_fly_move(masu_fly *fly, const masu_fly_wish *wish, double seconds);
/* One notch of the wheel, up (1) or down (-1). */
void masu_fly_faster(masu_fly *fly, double notches);
void masu_fly_camera(const masu_fly *fly, masu_camera *out);

/* When the scene's path has come to its end: the time from which on its camera rests. 0: it has no
 * path, or one that never moves. */
double masu_fly_path_end(const masu_renderer *renderer);

#endif

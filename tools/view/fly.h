/* fly.h: the camera, flown by hand or on the scene's path.
 *
 * Plain state and mathematics: no window, renderer or clock. Angles are in radians; yaw 0 looks
 * along -Z, positive yaw turns left. */
#ifndef MASU_VIEW_FLY_H
#define MASU_VIEW_FLY_H

#include "masu.h"

#include <stdbool.h>

#define MASU_FLY_SPEED_MIN 0.01
#define MASU_FLY_SPEED_MAX 10000.0

/* Current input: -1..1 along each axis of the camera. */
typedef struct masu_fly_wish {
    double right, up, forward;
    double yaw, pitch; /* radians, added at once */
    bool fast;         /* four times as fast */
} masu_fly_wish;

typedef struct masu_fly {
    double position[3];
    double yaw, pitch;
    double speed; /* m/s */
    float fov_y, near_distance;
} masu_fly;

/* Copies that camera except its roll. Does not change the speed. */
void masu_fly_from(masu_fly *fly, const masu_camera *camera);
/* Moves by the input for a time. Returns true if the camera has changed. */
bool masu_fly_move(masu_fly *fly, const masu_fly_wish *wish, double seconds);
/* Changes the speed by notches of the mouse wheel: 1 up, -1 down. */
void masu_fly_faster(masu_fly *fly, double notches);
void masu_fly_camera(const masu_fly *fly, masu_camera *out);

/* End of the scene's camera path, in seconds: the camera is stationary from then on. 0: there is no
 * path, or the camera never moves. */
double masu_fly_path_end(const masu_renderer *renderer);

#endif

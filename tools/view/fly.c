/* fly.c: see fly.h. */
#include "view/fly.h"

#include <math.h>
#include <string.h>

#define STEEPEST 1.55  /* just below straight up, where yaw is undefined */
#define FOREVER 1e12   /* seconds, after the end of any path */
#define LONGEST 1e6    /* seconds, upper bound of the search for the end */

static double clamp(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

void masu_fly_from(masu_fly *fly, const masu_camera *camera) {
    const double f[3] = {(double)camera->forward[0], (double)camera->forward[1],
                         (double)camera->forward[2]};
    double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    memcpy(fly->position, camera->position, sizeof fly->position);
    fly->yaw = atan2(-f[0], -f[2]);
    fly->pitch =
        length > 0.0 ? clamp(asin(clamp(f[1] / length, -1.0, 1.0)), -STEEPEST, STEEPEST) : 0.0;
    fly->fov_y = camera->fov_y;
    fly->near_distance = camera->near_distance;
}

static void axes(const masu_fly *fly, double forward[3], double right[3]) {
    double c = cos(fly->pitch);
    forward[0] = -sin(fly->yaw) * c;
    forward[1] = sin(fly->pitch);
    forward[2] = -cos(fly->yaw) * c;
    right[0] = cos(fly->yaw);
    right[1] = 0.0;
    right[2] = -sin(fly->yaw);
}

bool masu_fly_move(masu_fly *fly, const masu_fly_wish *wish, double seconds) {
    bool turned = wish->yaw != 0.0 || wish->pitch != 0.0;
    double length =
        sqrt(wish->right * wish->right + wish->up * wish->up + wish->forward * wish->forward);
    fly->yaw = remainder(fly->yaw + wish->yaw, 2.0 * 3.14159265358979323846);
    fly->pitch = clamp(fly->pitch + wish->pitch, -STEEPEST, STEEPEST);
    if (!(length > 0.0)) return turned;
    /* Two keys at once are no faster than one; half a stick's travel is half as fast. */
    double step = fly->speed * seconds * (wish->fast ? 4.0 : 1.0) / (length > 1.0 ? length : 1.0);
    double forward[3], right[3];
    axes(fly, forward, right);
    for (int i = 0; i < 3; i++) {
        double up = i == 1 ? wish->up : 0.0;
        fly->position[i] += step * (forward[i] * wish->forward + right[i] * wish->right + up);
    }
    return true;
}

void masu_fly_faster(masu_fly *fly, double notches) {
    fly->speed = clamp(fly->speed * pow(1.25, notches), MASU_FLY_SPEED_MIN, MASU_FLY_SPEED_MAX);
}

void masu_fly_camera(const masu_fly *fly, masu_camera *out) {
    double forward[3], right[3];
    axes(fly, forward, right);
    memset(out, 0, sizeof *out);
    memcpy(out->position, fly->position, sizeof out->position);
    for (int i = 0; i < 3; i++) out->forward[i] = (float)forward[i];
    out->fov_y = fly->fov_y;
    out->near_distance = fly->near_distance;
}

static bool rests(const masu_renderer *m, double time, const masu_camera *end) {
    masu_camera at;
    return masu_camera_at(m, time, &at, NULL) == MASU_OK &&
           !memcmp(at.position, end->position, sizeof at.position) &&
           !memcmp(at.forward, end->forward, sizeof at.forward) &&
           !memcmp(at.up, end->up, sizeof at.up);
}

/* The library reports the camera at a time, not the end of the path. A camera stays at the last key
 * after the end, so a bisection finds the first time with the final camera. */
double masu_fly_path_end(const masu_renderer *m) {
    masu_camera end;
    if (masu_camera_at(m, FOREVER, &end, NULL) || rests(m, 0.0, &end) || !rests(m, LONGEST, &end))
        return 0.0;
    double moving = 0.0, resting = LONGEST;
    while (resting - moving > 1e-4) {
        double middle = 0.5 * (moving + resting);
        if (rests(m, middle, &end)) {
            resting = middle;
        } else {
            moving = middle;
        }
    }
    return resting;
}

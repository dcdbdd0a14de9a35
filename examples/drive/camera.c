/* camera.c: see camera.h. The eye follows its place behind the car by shares of the way that is left, the
 * same whatever the step; it stays above the ground and on this side of the barriers. */
#include "camera.h"

#define FOLLOW 7.0    /* 1/s */
#define LOWEST 0.6    /* metres above the road */
#define INSIDE 0.7    /* metres before a barrier */

void camera_step(camera *c, const track *t, const car *of, double dt, masu_camera *out) {
    static const struct {
        double behind, above, look_ahead, look_above, fov;
    } views[CAMERA_VIEWS] = {{5.8, 1.9, 6, 0.9, 1.05}, {11, 4.2, 6, 0.6, 0.95}, {-0.9, 1.16, 20, 0.8, 1.1}};
    double speed = fabs(car_speed(of));
    vec eye = add(add(of->at, of->ahead, -views[c->view].behind), of->up, views[c->view].above);
    vec target = add(add(of->at, of->ahead, views[c->view].look_ahead), of->up, views[c->view].look_above);
    bool stiff = !c->placed || c->view == CAMERA_COCKPIT;
    double share = stiff ? 1 : 1 - exp(-FOLLOW * dt);
    /* Both are carried along first: only what turns lags behind, not what drives straight on. */
    if (!stiff) c->eye = add(c->eye, of->velocity, dt), c->target = add(c->target, of->velocity, dt);
    c->eye = mix(c->eye, eye, share);
    c->target = mix(c->target, target, share);
    c->placed = true;
    if (c->view != CAMERA_COCKPIT) {
        track_place p = track_find(t, c->eye, of->place.point);
        double over = fabs(p.side) - fmax(p.barrier - INSIDE, 0);
        if (over > 0) c->eye = add(c->eye, cross(p.ahead, p.up), p.side > 0 ? -over : over);
        c->eye.y = fmax(c->eye.y, p.ground.y + LOWEST);
    }
    vec forward = add(c->target, c->eye, -1);
    *out = (masu_camera){.position = {c->eye.x, c->eye.y, c->eye.z},
                         .forward = {(float)forward.x, (float)forward.y, (float)forward.z},
                         .fov_y = (float)(views[c->view].fov + 0.0022 * fmin(speed, 70)),
                         .near_distance = 0.2f};
}

/* camera.h: three ways to look at a car: from behind, from far behind, from its bonnet. */
#ifndef DRIVE_CAMERA_H
#define DRIVE_CAMERA_H

#include "car.h"
#include "masu.h"

typedef enum camera_view { CAMERA_CHASE, CAMERA_FAR, CAMERA_COCKPIT, CAMERA_VIEWS } camera_view;

typedef struct camera {
    camera_view view;
    vec eye, target;
    bool placed; /* else the next step puts it where it belongs at once */
} camera;

void camera_step(camera *c, const track *t, const car *of, double dt, masu_camera *out);

#endif

/* lights.c: see lights.h. */
#include "reference/lights.h"
#include "reference/vec.h"

#include <math.h>

#define PI 3.14159265358979323846

/* Angle between two vectors by atan2: exact for small and for large angles. */
static double angle_between(const double a[3], const double b[3]) {
    double c[3];
    cross3(a, b, c);
    return atan2(sqrt(dot3(c, c)), dot3(a, b));
}

/* Intensity of a spot at an angle from its axis: KHR_lights_punctual, "Inner and Outer Cone
 * Angles". */
static double cone_share(const masu_ref_light *light, double angle) {
    if (light->outer >= PI) return 1.0;
    if (angle >= light->outer) return 0.0;
    if (angle <= light->inner) return 1.0;
    double t = (cos(angle) - cos(light->outer)) / (cos(light->inner) - cos(light->outer));
    return t * t;
}

int masu_ref_light_reaches(const masu_ref_light *light, const double at[3], double l[3],
                           double color[3]) {
    double to[3], away[3], distance;
    for (int k = 0; k < 3; k++) to[k] = light->position[k] - at[k];
    distance = sqrt(dot3(to, to));
    for (int k = 0; k < 3; k++) {
        l[k] = distance > 0.0 ? to[k] / distance : 0.0;
        away[k] = -to[k];
        color[k] = 0.0;
    }
    if (!(distance < light->range) || !(distance > 0.0)) return 0;
    /* KHR_lights_punctual, "Range Property". */
    double window = 1.0 - pow(distance / light->range, 4.0);
    double nearest = fmax(distance, light->radius);
    double share = cone_share(light, angle_between(away, light->axis));
    double strength = window * share / (nearest * nearest);
    for (int k = 0; k < 3; k++) color[k] = light->color[k] * strength;
    return strength > 0.0;
}

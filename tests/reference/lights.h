/* lights.h: punctual lights in double precision, by angles and cosines instead of the versines and
 * reciprocals of shaders/light/lights.glsl: the light that reaches a point. */
#ifndef MASU_REF_LIGHTS_H
#define MASU_REF_LIGHTS_H

typedef struct masu_ref_light {
    double position[3];
    double color[3]; /* radiant intensity / pi */
    double range;    /* metres; 0: the light is off */
    double radius;   /* smaller distances are raised to this, metres */
    double axis[3];  /* of a spot, of any length */
    double inner,
        outer; /* of a spot, radians from the axis; for a point light outer is pi or more */
} masu_ref_light;

/* l: unit vector towards the light. Returns 0 if no light arrives; color is 0 then. */
int masu_ref_light_reaches(const masu_ref_light *light, const double at[3], double l[3],
                           double color[3]);

#endif

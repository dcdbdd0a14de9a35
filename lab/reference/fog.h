/* fog.h: air with a density that decreases exponentially with height, and its transmittance along a
 * ray. */
#ifndef LAB_REFERENCE_FOG_H
#define LAB_REFERENCE_FOG_H

/* Transmittance of `length` metres, HUGE_VAL for a ray into the sky. density, falloff: per metre;
 * height: of the ray's origin above the fog's; climb: y of its unit direction; start: metres along
 * it without fog. */
double ref_fog_left(double density, double falloff, double height, double climb, double start,
                    double length);

#endif

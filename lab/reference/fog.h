/* fog.h: air whose density falls exponentially with height, and what it transmits along a ray. */
#ifndef LAB_REFERENCE_FOG_H
#define LAB_REFERENCE_FOG_H

/* Part of the light that `length` metres leave, HUGE_VAL for a ray into the sky. density,
 * falloff: per metre; height: of the ray's origin above the fog's; climb: y of its unit
 * direction; start: metres along it that are clear. */
double ref_fog_left(double density, double falloff, double height, double climb, double start,
                    double length);

#endif

/* sky_table.h: evaluates the analytic sky's table (struct masu_sky_uniforms; sky.c computes the
 * rows), and derives separate tables from the rows: the sky beyond fog, and the sky in rough
 * reflections. They save the nine powers of two of an evaluation by rows. shaders/light/sky.glsl
 * has the same functions.
 *
 * Nothing is allocated, nothing fails. */
#ifndef MASU_SKY_TABLE_H
#define MASU_SKY_TABLE_H

#include "shared/masu_shared.h"

/* Radiance towards a unit direction, without the sun's disc: the twin of masu_sky_light. */
void masu_sky_radiance(const struct masu_sky_uniforms *sky, const float direction[3], float out[3]);

/* Radiance at a sine of elevation, a cosine of azimuth from the sun, and a cosine to the sun,
 * all -1..1. */
void masu_sky_evaluate(const struct masu_sky_uniforms *sky, float y, float x, float cosine,
                       float out[3]);

/* Fills `horizon` and `rough` by all the rest, which is filled before. */
void masu_sky_tables(struct masu_sky_uniforms *sky);

#endif

/* sky_table.h: looking into the analytic sky's table (struct masu_sky_uniforms, of which sky.c computes the rows), and
 * what follows from the rows alone: the sky beyond fog and the sky as rough surfaces mirror it, in tables of their
 * own, for a look by the rows is nine powers of two. shaders/light/sky.glsl has the twins.
 *
 * Nothing is allocated, nothing fails. */
#ifndef MASU_SKY_TABLE_H
#define MASU_SKY_TABLE_H

#include "shared/masu_shared.h"

/* Radiance towards a unit direction, without the sun's disc: the twin of masu_sky_light. */
void masu_sky_radiance(const struct masu_sky_uniforms *sky, const float direction[3], float out[3]);

/* Radiance at a sine of elevation, a cosine of azimuth from the sun, and a cosine to the sun, all -1..1. */
void masu_sky_evaluate(const struct masu_sky_uniforms *sky, float y, float x, float cosine,
                       float out[3]);

/* Fills `horizon` and `rough` by all the rest, which is filled before. */
void masu_sky_tables(struct masu_sky_uniforms *sky);

#endif

/* vec.h: vectors of three. */
#ifndef MASU_VEC_H
#define MASU_VEC_H

/* Unit vector of v; 0: it has none. May be in place. */
int masu_unit(const float v[3], float out[3]);
void masu_cross(const float a[3], const float b[3], float out[3]);

#endif

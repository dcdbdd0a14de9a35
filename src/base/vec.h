/* vec.h: three-component vectors. */
#ifndef MASU_VEC_H
#define MASU_VEC_H

/* Writes the unit vector of v, or returns 0 if v has no direction. v and out may be the same. */
int masu_unit(const float v[3], float out[3]);
void masu_cross(const float a[3], const float b[3], float out[3]);

#endif

/* vec.c: see vec.h. */
#include "base/vec.h"

#include <math.h>

/* In double, so that 1e-30 and 1e+30 neither underflow nor overflow. */
int masu_unit(const float v[3], float out[3]) {
    double x = (double)v[0], y = (double)v[1], z = (double)v[2];
    double length = sqrt(x * x + y * y + z * z);
    if (!(length > 0.0) || !isfinite(length)) return 0;
    out[0] = (float)(x / length);
    out[1] = (float)(y / length);
    out[2] = (float)(z / length);
    return 1;
}

void masu_cross(const float a[3], const float b[3], float out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* fog.c: see fog.h. The optical depth of density * exp(-falloff * y) along a line is
 * density * exp(-falloff * y0) * (1 - exp(-k s)) / k with k = falloff * climb. */
#include "lab/reference/fog.h"

#include <math.h>

double ref_fog_left(double density, double falloff, double height, double climb, double start,
                    double length) {
    double s = length - start, k = falloff * climb;
    if (!(density > 0) || !(s > 0)) return 1;
    double first = density * exp(-falloff * (height + climb * start));
    if (isinf(s)) return k > 0 ? exp(-first / k) : 0;
    double path = fabs(k * s) > 1e-12 ? -expm1(-k * s) / k : s;
    return exp(-first * path);
}

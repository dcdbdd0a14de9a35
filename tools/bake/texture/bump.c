/* bump.c: see bump.h. */
#include "bake/texture/bump.h"

#include <math.h>
#include <stdlib.h>

/* the largest difference between the channels of a grey texel: JPEG makes grey nearly grey */
#define GREY 24
#define GREY_SHARE 0.98  /* least share of grey texels in a height map */
#define NORMAL_SHARE 0.9 /* least share of normals among the texels of a normal map */

static bool is_grey(const uint8_t *t) {
    int low = t[0] < t[1] ? t[0] : t[1], high = t[0] > t[1] ? t[0] : t[1];
    low = t[2] < low ? t[2] : low;
    high = t[2] > high ? t[2] : high;
    return high - low <= GREY;
}

/* True for vectors of about unit length with positive z. Few colours satisfy this, except blue
 * ones. */
static bool is_normal(const uint8_t *t) {
    double x = (t[0] - 128) / 127.0, y = (t[1] - 128) / 127.0, z = (t[2] - 128) / 127.0;
    double length = sqrt(x * x + y * y + z * z);
    return z > -0.05 && length > 0.75 && length < 1.3;
}

bool masu_bump_is_height(const uint8_t *rgba, uint32_t width, uint32_t height, int relief) {
    size_t texels = (size_t)width * height, grey = 0, normal = 0;
    if (relief == MASU_BAKE_RELIEF_NORMALS) return false;
    for (size_t i = 0; i < texels; i++) {
        grey += is_grey(rgba + 4 * i);
        normal += is_normal(rgba + 4 * i);
    }
    if ((double)grey >= GREY_SHARE * (double)texels) return true;
    return relief == MASU_BAKE_RELIEF_NAMED_HEIGHTS &&
           (double)normal < NORMAL_SHARE * (double)texels;
}

static double luminance(const uint8_t *t) {
    return (0.2126 * t[0] + 0.7152 * t[1] + 0.0722 * t[2]) / 255;
}

static uint32_t neighbour(uint32_t at, uint32_t size, int step, bool clamped) {
    if (step < 0) return at ? at - 1 : clamped ? 0 : size - 1;
    return at + 1 < size ? at + 1 : clamped ? at : 0;
}

/* Slopes by the Sobel operator: a difference in one direction, smoothed in the other, because 8-bit
 * heights have steps. */
void masu_bump_normals(const uint8_t *rgba, uint32_t width, uint32_t height, double strength,
                       const bool clamped[2], float *normals) {
    double scale = strength * MASU_BUMP_HEIGHT * (width > height ? width : height) / 8;
    for (uint32_t y = 0; y < height; y++) {
        const uint32_t rows[3] = {neighbour(y, height, -1, clamped[1]), y,
                                  neighbour(y, height, 1, clamped[1])};
        for (uint32_t x = 0; x < width; x++) {
            const uint32_t columns[3] = {neighbour(x, width, -1, clamped[0]), x,
                                         neighbour(x, width, 1, clamped[0])};
            double h[3][3];
            for (int j = 0; j < 3; j++) {
                for (int i = 0; i < 3; i++)
                    h[j][i] = luminance(rgba + 4 * ((size_t)rows[j] * width + columns[i]));
            }
            double u = (h[0][2] + 2 * h[1][2] + h[2][2] - h[0][0] - 2 * h[1][0] - h[2][0]) * scale;
            double up = (h[0][0] + 2 * h[0][1] + h[0][2] - h[2][0] - 2 * h[2][1] - h[2][2]) * scale;
            double steep = sqrt(u * u + up * up);
            if (steep > MASU_BUMP_SLOPE_MAX) {
                u *= MASU_BUMP_SLOPE_MAX / steep;
                up *= MASU_BUMP_SLOPE_MAX / steep;
            }
            double length = sqrt(u * u + up * up + 1);
            float *to = normals + 4 * ((size_t)y * width + x);
            to[0] = (float)(-u / length);
            to[1] = (float)(-up / length);
            to[2] = (float)(1 / length);
            to[3] = 1;
        }
    }
}

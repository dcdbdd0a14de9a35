/* shade.c: see shade.h. Names match the shaders. */
#include "measure/shade.h"

#include "measure/texel.h"

#include "shared/masu_shared.h"

#include "split_sum.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double clamped(double x, double low, double high) {
    return x < low ? low : x > high ? high : x;
}

static double mix(double a, double b, double u) { return a + (b - a) * u; }

/* ---- sky.glsl -------------------------------------------------------------------------------- */

void masu_shade_open_sky(const masu_view *v, const double direction[3], double out[3]) {
    double u = sqrt(clamped(direction[1], 0, 1));
    for (int c = 0; c < 3; c++) out[c] = mix(v->sky_horizon[c], v->sky_zenith[c], u);
}

void masu_shade_sky(const masu_view *v, const double direction[3], double out[3]) {
    double towards = clamped(dot(direction, v->sun_direction), 0, 1);
    double glow = 0.25 * pow(towards, 350) + 0.05 * pow(towards, 12);
    masu_shade_open_sky(v, direction, out);
    for (int c = 0; c < 3; c++) out[c] += v->sun_color[c] * glow;
}

static double specular_lobe(const double n[3], const double h[3], double alpha, double n_l,
                            double n_v) {
    double n_h = clamped(dot(n, h), 0, 1), a = n_h * alpha, a2 = alpha * alpha;
    double sine[3] = {n[1] * h[2] - n[2] * h[1], n[2] * h[0] - n[0] * h[2],
                      n[0] * h[1] - n[1] * h[0]};
    double k = alpha / (dot(sine, sine) + a * a);
    double g = n_l * sqrt(a2 + (1 - a2) * n_v * n_v) + n_v * sqrt(a2 + (1 - a2) * n_l * n_l);
    return k * k * 0.5 / fmax(g, 1e-12);
}

/* ---- bsdf.glsl, without a coat --------------------------------------------------------------- */

typedef struct albedo {
    double white, weight;
} albedo;

static uint32_t row_of(double roughness) {
    double at = (roughness - MASU_TABLE_SMOOTHEST) * (MASU_TABLE_ROWS - 1) /
                (1 - MASU_TABLE_SMOOTHEST);
    return (uint32_t)fmin(fmax(at, 0) + 0.5, MASU_TABLE_ROWS - 1);
}

static albedo albedo_of(uint32_t row, double cosine) {
    double at = sqrt(cosine) * (MASU_TABLE_SIZE - 1), left = fmin(floor(at), MASU_TABLE_SIZE - 2);
    const uint32_t *node =
        masu_split_sum + MASU_TABLE_LOSS + row * MASU_TABLE_SIZE + (uint32_t)left;
    double lost = mix(node[0] & 0xFFFF, node[1] & 0xFFFF, at - left) / 65535;
    return (albedo){1 - lost, mix(node[0] >> 16, node[1] >> 16, at - left) / 65535};
}

static albedo average_of(uint32_t row) {
    float floats[2];
    memcpy(floats, masu_split_sum + MASU_TABLE_AVERAGE + 2 * row, sizeof floats);
    return (albedo){1 - (double)floats[0], (double)floats[1]};
}

static double lost(albedo a) { return fmax(1 - a.white, 0); }

/* Colour of light that leaves after multiple bounces. */
static double rest_color(double f0, double f90, double average_lost) {
    double f = f0 + (f90 - f0) / 21;
    return f * f * (1.35 - 0.35 * f) * (1 - average_lost) / (1 - f * average_lost);
}

/* Light that the dielectric layer reflects before it reaches the base colour. */
static double matte(double f0, double f90, double rest, albedo a) {
    return f0 * a.white + (f90 - f0) * a.weight + rest * lost(a);
}

void masu_shade_exact(const masu_view *view, const double direction[3], const double n[3],
                      const double material[8], double lit[3], double mirrored[3]) {
    const double *color = material, *l = view->sun_direction;
    double v[3], h[3], mirror_way[3], reflected[3];
    for (int c = 0; c < 3; c++) lit[c] = material[4 + c], mirrored[c] = 0;
    if (masu_texel_unlit(material)) return;
    double roughness = material[3], metallic = material[7];
    for (int i = 0; i < 3; i++) v[i] = -direction[i];
    double n_v = clamped(dot(n, v), 1e-4, 1), n_l = clamped(dot(n, l), 0, 1);
    double alpha = fmax(roughness, MASU_TABLE_SMOOTHEST), toward = 2 * dot(n, direction);
    alpha *= alpha;
    uint32_t row = row_of(roughness);
    albedo seen = albedo_of(row, n_v), all = average_of(row), lit_by = albedo_of(row, n_l);
    double lobe = 0, f5 = 0, length = 0;
    for (int i = 0; i < 3; i++) {
        h[i] = l[i] + v[i];
        length += h[i] * h[i];
        mirror_way[i] = direction[i] - toward * n[i];
    }
    length = sqrt(length);
    if (n_l > 0) {
        for (int i = 0; i < 3; i++) h[i] = length > 1e-30 ? h[i] / length : n[i];
        lobe = specular_lobe(n, h, alpha, n_l, n_v);
        f5 = pow(clamped(1 - length / 2, 0, 1), 5);
    }
    masu_shade_open_sky(view, mirror_way, reflected);
    double brightest = fmax(color[0], fmax(color[1], color[2]));
    double metal_f90 = fmin(50 * brightest, 1), f90 = mix(1, metal_f90, metallic);
    double matte_rest = rest_color(0.04, 1, lost(all));
    double below = (1 - metallic) * (1 - matte(0.04, 1, matte_rest, seen));
    for (int c = 0; c < 3; c++) {
        double f0 = mix(0.04, color[c], metallic);
        double metal_rest = rest_color(color[c], metal_f90, lost(all));
        double rest = mix(matte_rest, metal_rest, metallic) * lost(seen);
        double f = (f0 + (f90 - f0) * f5) * lobe + rest * lost(lit_by) / fmax(lost(all), 1e-6) +
                   color[c] * below * (1 - matte(0.04, 1, matte_rest, lit_by)) /
                       fmax(1 - matte(0.04, 1, matte_rest, all), 1e-6);
        double mirror = f0 * seen.white + (f90 - f0) * seen.weight;
        lit[c] += view->sun_color[c] * f * n_l + view->ambient[c] * (rest + color[c] * below);
        mirrored[c] = mirror * mix(reflected[c], view->ambient[c], roughness);
    }
}

void masu_shade_surface(const masu_view *view, const double direction[3], const double n[3],
                        const double material[8], double out[3]) {
    double rounded[8], mirrored[3];
    uint8_t albedo[4];
    uint32_t look;
    masu_texel_pack(material, albedo, &look);
    masu_texel_unpack(albedo, look, rounded);
    for (int c = 4; c < 7; c++) rounded[c] = clamped(material[c], 0, 65504);
    masu_shade_exact(view, direction, n, rounded, out, mirrored);
    for (int c = 0; c < 3; c++) out[c] += mirrored[c];
}

void masu_shade_texel(const masu_view *view, const double direction[3], const uint8_t albedo[4],
                      uint32_t normal, const double emission[3], double out[3]) {
    double material[8], n[3], mirrored[3];
    float unpacked[3];
    masu_texel_unpack(albedo, normal, material);
    for (int c = 0; c < 3; c++) material[4 + c] = emission[c];
    masu_unpack_normal(normal, unpacked);
    for (int i = 0; i < 3; i++) n[i] = (double)unpacked[i];
    masu_shade_exact(view, direction, n, material, out, mirrored);
    for (int c = 0; c < 3; c++) out[c] += mirrored[c];
}

/* ---- tonemap.comp ---------------------------------------------------------------------------- */

void masu_shade_encode(const masu_view *view, const double radiance[3], uint8_t rgba[4]) {
    for (int c = 0; c < 3; c++) {
        double x = clamped(clamped(radiance[c], 0, 65504) * view->exposure, 0, 1e4);
        double y = clamped((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), 0, 1);
        double z = y <= 0.0031308 ? 12.92 * y : 1.055 * pow(y, 1 / 2.4) - 0.055;
        rgba[c] = (uint8_t)rint(clamped(z, 0, 1) * 255);
    }
    rgba[3] = 255;
}

void masu_shade_image(const masu_truth *truth, const masu_view *view, uint32_t stride,
                      const masu_truth_sample *samples, uint8_t *rgba) {
    uint32_t columns = masu_truth_columns(view->width, stride);
    uint32_t rows = masu_truth_columns(view->height, stride);
    (void)truth->step(view->params, view->time, view->eye); /* materials are evaluated at this
                                                             * time */
    for (uint32_t y = 0; y < rows; y++) {
        for (uint32_t x = 0; x < columns; x++) {
            size_t i = (size_t)y * columns + x;
            masu_view_ray ray = masu_view_ray_at(view, x * stride, y * stride);
            double radiance[3], material[8];
            if (samples[i].kind == MASU_TRUTH_HIT) {
                memset(material, 0, sizeof material);
                truth->material(samples[i].part, material);
                masu_shade_surface(view, ray.direction, samples[i].normal, material, radiance);
            } else {
                masu_shade_sky(view, ray.direction, radiance);
            }
            masu_shade_encode(view, radiance, &rgba[4 * i]);
        }
    }
}

/* probe_light.c: see probe_light.h. */
#include "bake/light/probe_light.h"

#include "shared/masu_shared.h"

#include <math.h>
#include <string.h>

/* ---- halfs ---- */

float masu_probe_half(uint32_t half) {
    uint32_t exponent = half >> 10 & 31, fraction = half & 0x3FFu;
    float value = exponent ? ldexpf((float)(fraction | 0x400u), (int)exponent - 25)
                           : ldexpf((float)fraction, -24);
    if (exponent == 31) value = 0; /* no such half is written */
    return half & 0x8000u ? -value : value;
}

/* To the nearest, ties to even. */
static uint32_t to_half(float value) {
    uint32_t sign = signbit(value) ? 0x8000u : 0;
    float a = fabsf(value);
    if (!(a > 0)) return 0; /* NaN too */
    if (a > 65504.0f) a = 65504.0f;
    int exponent;
    (void)frexpf(a, &exponent); /* a in [2^(e-1), 2^e) */
    int shift = exponent < -13 ? -13 : exponent;
    /* in units of the last place: 11 bits above 2^-14, fewer below */
    uint32_t units = (uint32_t)rintf(ldexpf(a, 11 - shift));
    if (exponent < -13) return sign | units;
    return sign | (((uint32_t)(shift + 13) << 10) + units);
}

uint32_t masu_probe_pack(float low, float high) { return to_half(low) | to_half(high) << 16; }

static float half_at(const uint32_t *words, uint32_t i) {
    return masu_probe_half(i & 1 ? words[i / 2] >> 16 : words[i / 2] & 0xFFFFu);
}

/* ---- light ---- */

/* Ramamoorthi and Hanrahan, An Efficient Representation for Irradiance Environment Maps (2001). */
void masu_probe_basis(const float d[3], float y[9]) {
    y[0] = 0.282095f;
    y[1] = 0.488603f * d[1];
    y[2] = 0.488603f * d[2];
    y[3] = 0.488603f * d[0];
    y[4] = 1.092548f * d[0] * d[1];
    y[5] = 1.092548f * d[1] * d[2];
    y[6] = 0.315392f * (3.0f * d[2] * d[2] - 1.0f);
    y[7] = 1.092548f * d[0] * d[2];
    y[8] = 0.546274f * (d[0] * d[0] - d[1] * d[1]);
}

/* Interpolates between the suns with the kernel 1 - angle / pi. It is positive definite on the
 * sphere, and linear from sun to sun along an arc. Negative weights away from the suns are set to
 * 0, then the sum is normalised to 1. */
void masu_probe_sun_weights(const masu_blob_probes *p, const float direction[3],
                            float weights[MASU_PROBE_SUNS_MAX]) {
    float near[MASU_PROBE_SUNS_MAX] = {0}, sum = 0;
    for (uint32_t k = 0; k < p->suns; k++) {
        const float *d = p->sun_direction[k];
        float c = d[0] * direction[0] + d[1] * direction[1] + d[2] * direction[2];
        near[k] = 1.0f - acosf(fminf(fmaxf(c, -1.0f), 1.0f)) * 0.318309886f;
    }
    for (uint32_t k = 0; k < MASU_PROBE_SUNS_MAX; k++) {
        weights[k] = 0;
        for (uint32_t j = 0; j < p->suns && k < p->suns; j++) {
            weights[k] += p->sun_inverse[k][j] * near[j];
        }
        weights[k] = fmaxf(weights[k], 0.0f);
        sum += weights[k];
    }
    float scale = 1.0f / fmaxf(sum, 0.25f);
    for (uint32_t k = 0; k < MASU_PROBE_SUNS_MAX; k++) weights[k] *= scale;
}

static float most(uint32_t k) {
    return k < 4 ? (float)MASU_PROBE_MOST_1 : (float)MASU_PROBE_MOST_2;
}

static float sane(float v, float most) { return isfinite(v) ? fminf(fmaxf(v, -most), most) : 0.0f; }

void masu_probe_light(const masu_blob_probes *p, const uint32_t *data, const masu_probe_sky *light,
                      uint32_t *lit) {
    float factor[MASU_PROBE_SETS_MAX][3], weights[MASU_PROBE_SUNS_MAX];
    uint32_t sets = masu_probe_sets(p);
    masu_probe_sun_weights(p, light->sun_direction, weights);
    for (uint32_t s = 0; s < sets; s++) {
        for (int c = 0; c < 3; c++) {
            uint32_t sun = s - p->sky_sets - p->emissive;
            factor[s][c] = s < p->sky_sets                 ? light->sky[s][c]
                           : s < p->sky_sets + p->emissive ? 1
                                                           : light->sun[c] * weights[sun];
        }
    }
    uint32_t count = p->counts[0] * p->counts[1] * p->counts[2];
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t *from = data + (uint64_t)i * sets * MASU_PROBE_WORDS;
        float sum[28] = {0};
        for (uint32_t s = 0; s < sets; s++) {
            for (uint32_t k = 0; k < 27; k++) {
                sum[k] += factor[s][k % 3] * half_at(from + s * MASU_PROBE_WORDS, k);
            }
        }
        uint32_t *to = lit + i * MASU_PROBE_LIT_WORDS;
        for (int c = 0; c < 3; c++) sum[c] = fminf(fmaxf(sum[c], 0.0f), 65504.0f);
        to[0] = masu_probe_pack(sum[0], sum[1]);
        to[1] = masu_probe_pack(sum[2], half_at(from, 27));
        to[10] = to[11] = 0;
        for (uint32_t k = 1; k < 9; k++) {
            to[1 + k] = 0;
            for (uint32_t c = 0; c < 3; c++) {
                float v = sum[c] > 1e-30f ? sum[3 * k + c] / sum[c] : 0;
                v = floorf(sane(v * 511.0f / most(k), 511.0f) + 0.5f);
                to[1 + k] |= ((uint32_t)(int32_t)v & 1023u) << 10 * c;
            }
        }
    }
}

/* ---- lookup ---- */

/* Mean and mean square of the distance from a probe along d, in units of a cell's diagonal:
 * bilinear in the probe's octahedral map, which has a border of one texel with the values across
 * the edge. */
static void distances(const masu_blob_probes *p, const uint32_t *map, const float d[3],
                      float out[2]) {
    uint32_t side = p->visibility + 2;
    float l1 = fabsf(d[0]) + fabsf(d[1]) + fabsf(d[2]);
    float x = d[0] / l1, y = d[1] / l1;
    if (d[2] < 0) {
        float fx = (1.0f - fabsf(y)) * (x >= 0 ? 1.0f : -1.0f);
        y = (1.0f - fabsf(x)) * (y >= 0 ? 1.0f : -1.0f);
        x = fx;
    }
    float u = (x * 0.5f + 0.5f) * (float)p->visibility + 0.5f;
    float v = (y * 0.5f + 0.5f) * (float)p->visibility + 0.5f;
    u = fminf(fmaxf(u, 0.0f), (float)side - 1.0f);
    v = fminf(fmaxf(v, 0.0f), (float)side - 1.0f);
    uint32_t i = (uint32_t)u, j = (uint32_t)v;
    if (i > side - 2) i = side - 2;
    if (j > side - 2) j = side - 2;
    float fu = u - (float)i, fv = v - (float)j;
    out[0] = out[1] = 0;
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t word = map[(j + (k >> 1)) * side + i + (k & 1)];
        float w = (k & 1 ? fu : 1 - fu) * (k >> 1 ? fv : 1 - fv);
        out[0] += w * (float)(word & 0xFFFFu) * (1.5f / 65535.0f);
        out[1] += w * (float)(word >> 16) * (2.25f / 65535.0f);
    }
}

/* Probability that a point at `distance` along d is visible from the probe: Chebyshev's bound over
 * the two moments (Donnelly and Lauritzen, Variance Shadow Maps, 2006; Majercik et al., JCGT 8-2,
 * 2019). */
static float seen(const masu_blob_probes *p, const uint32_t *map, const float d[3],
                  float distance) {
    float moments[2];
    distances(p, map, d, moments);
    float beyond = distance - moments[0];
    if (!(beyond > 0)) return 1;
    float variance = fabsf(moments[1] - moments[0] * moments[0]) + 1e-4f;
    float bound = variance / (variance + beyond * beyond);
    return bound * bound * bound;
}

float masu_probe_lookup(const masu_blob_probes *p, const uint32_t *data, const uint32_t *lit,
                        const float position[3], const float facing_to[3], float out[3]) {
    float normal[3], cell[3], fraction[3], point[3], outside = 0, diagonal = 0;
    uint32_t base[3];
    for (int k = 0; k < 3; k++) {
        normal[k] = sane(facing_to[k], 1);
        float from = sane(position[k] - p->origin[k], 1e15f), g = from / p->spacing[k];
        point[k] = from + normal[k] * p->bias;
        float last = (float)(p->counts[k] - 1);
        outside = fmaxf(outside, fmaxf(-0.5f - g, g - last - 0.5f));
        cell[k] = fminf(fmaxf(point[k] / p->spacing[k], 0.0f), last);
        base[k] = (uint32_t)cell[k];
        if (base[k] + 1 >= p->counts[k] && base[k] > 0) base[k]--;
        fraction[k] = cell[k] - (float)base[k];
        diagonal += p->spacing[k] * p->spacing[k];
    }
    diagonal = sqrtf(diagonal);
    uint32_t sets = masu_probe_sets(p), count = p->counts[0] * p->counts[1] * p->counts[2];
    uint32_t texels = (p->visibility + 2) * (p->visibility + 2);
    const uint32_t *maps = data + (uint64_t)count * sets * MASU_PROBE_WORDS;
    float y[9], sum[3] = {0}, total = 0, per_bias = 1.0f / fmaxf(p->bias, 1e-4f);
    masu_probe_basis(normal, y);
    for (uint32_t corner = 0; corner < 8; corner++) {
        uint32_t at[3];
        float w = 1, to[3], square = 0;
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t high = corner >> k & 1;
            at[k] = base[k] + high < p->counts[k] ? base[k] + high : p->counts[k] - 1;
            w *= fmaxf(high ? fraction[k] : 1.0f - fraction[k], 1e-3f);
            to[k] = (float)at[k] * p->spacing[k] - point[k];
            square += to[k] * to[k];
        }
        uint32_t probe = (at[2] * p->counts[1] + at[1]) * p->counts[0] + at[0];
        const uint32_t *words = lit + (uint64_t)probe * MASU_PROBE_LIT_WORDS;
        float distance = sqrtf(fmaxf(square, 1e-12f)), d[3];
        for (int k = 0; k < 3; k++) d[k] = to[k] / distance;
        float front = 2.0f + (to[0] * normal[0] + to[1] * normal[1] + to[2] * normal[2]) * per_bias;
        front = fminf(fmaxf(front, 0.0f), 1.0f);
        w *= front * front + 0.05f;
        if (p->visibility && square > 1e-12f) {
            float back[3] = {-d[0], -d[1], -d[2]};
            w *= fmaxf(seen(p, maps + (uint64_t)probe * texels, back, distance / diagonal), 1e-4f);
        }
        w *= fmaxf(half_at(words, 3), 1e-4f);
        for (uint32_t c = 0; c < 3; c++) {
            float e = y[0];
            for (uint32_t k = 1; k < 9; k++) {
                int32_t q = (int32_t)(words[1 + k] >> 10 * c & 1023u);
                e += (float)(q - (q & 512) * 2) * (most(k) / 511.0f) * y[k];
            }
            sum[c] += w * fmaxf(e * half_at(words, c), 0.0f);
        }
        total += w;
    }
    for (int c = 0; c < 3; c++) out[c] = sum[c] / fmaxf(total, 1e-20f);
    return fminf(fmaxf(1.0f - outside, 0.0f), 1.0f);
}

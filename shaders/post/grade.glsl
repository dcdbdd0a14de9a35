/*
 * grade.glsl: brightness, gamma and colour table of display-linear colour. After tone.glsl.
 */
#ifndef MASU_GRADE_GLSL
#define MASU_GRADE_GLSL

#include "post/post.glsl"

vec3 masu_lut_point(uint index)
{
    uint bits = lut[index];
    return vec3(bits & 1023u, bits >> 10 & 1023u, bits >> 20 & 1023u) * (1.0 / 1023.0);
}

/* Colour table at v, 0..1: linear in the tetrahedron of four points that contains v. */
vec3 masu_lut(vec3 v, uint size)
{
    vec3 place = v * float(size - 1u), from = min(floor(place), float(size) - 2.0),
         f = place - from;
    uvec3 strides = uvec3(1u, size, size * size), cell = uvec3(from);
    uint first = cell.r + size * (cell.g + size * cell.b),
         all_strides = strides.r + strides.g + strides.b;
    float high = max(f.r, max(f.g, f.b)), low = min(f.r, min(f.g, f.b)),
          between = f.r + f.g + f.b - high - low;
    uint to_high = f.r >= max(f.g, f.b) ? strides.r : f.g >= f.b ? strides.g : strides.b;
    uint to_low = f.b <= min(f.r, f.g) ? strides.b : f.g <= f.r ? strides.g : strides.r;
    return (1.0 - high) * masu_lut_point(first) +
           (high - between) * masu_lut_point(first + to_high) +
           (between - low) * masu_lut_point(first + all_strides - to_low) +
           low * masu_lut_point(first + all_strides);
}

/* y in whites, 0..peak. */
vec3 masu_graded(vec3 y, float peak)
{
    uint size = uint(masu_sane(post.grade.w, 0.0, float(MASU_LUT_POINTS)));
    y *= post.grade.y;
    if (post.grade.z == 1.0 && size < 2u) {
        return min(y, peak);
    }
    vec3 v = masu_sane_unit(y * masu_rcp(peak));
    v = vec3(masu_srgb_encode(v.r), masu_srgb_encode(v.g), masu_srgb_encode(v.b));
    if (post.grade.z != 1.0) {
        v = vec3(masu_pow(v.r, post.grade.z), masu_pow(v.g, post.grade.z),
                 masu_pow(v.b, post.grade.z));
    }
    v = size < 2u ? v : masu_lut(masu_sane_unit(v), size);
    return peak * vec3(masu_srgb_decode(v.r), masu_srgb_decode(v.g), masu_srgb_decode(v.b));
}

/* Vignette factor of a pixel. */
float masu_vignette(vec2 at, vec2 size)
{
    vec2 side = (at + 0.5) / size * 2.0 - 1.0;
    return max(1.0 - 0.5 * post.grade.x * dot(side, side), 0.0);
}

#endif

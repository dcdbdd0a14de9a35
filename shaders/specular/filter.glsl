/*
 * filter.glsl: shared by the filters of reflections: luma and chroma, the radius over which a
 * reflection is similar, and the packing of images.
 *
 *   specular_color, rgba16f    rgb mean radiance over frames; a mean square of its luma. As stored
 *                              for the next frame, a is below 0 if nothing is traced
 *   specular_length, rg32ui  x  low half: hit distance, a half float; high half: frames in the
 *                               mean, in 1/64
 *                            y  motion of the reflection since the previous frame in pixels, two
 *                               half floats; all bits: disoccluded
 */
#ifndef MASU_SPECULAR_FILTER_GLSL
#define MASU_SPECULAR_FILTER_GLSL

#include "specular/guide.glsl"
#include "specular/origin.glsl"

const uint masu_unmoved = 0xFFFFFFFFu; /* unavailable motion */

/* Squares of luma must fit into half floats. */
const float masu_most_radiance = 250.0;

/* Half a step of the guide's 63: mirrors have 0. Their rays are noise-free, and a spatial filter
 * would only blur them. */
const float masu_mirror_roughness = 0.5 / 63.0;

/* Offset of the k-th of 3x3 texels, 0..8: the quotient by 3 without a division of integers. */
ivec2 masu_ninth(int k)
{
    int row = k * 11 >> 5;
    return ivec2(k - 3 * row, row) - 1;
}

vec3 masu_tamed(vec3 radiance)
{
    return masu_sane(radiance, 0.0, masu_most_radiance);
}

/* Luma, chroma orange, chroma green (Malvar and Sullivan, "YCoCg-R", JVT-I014, 2003; the lossy
 * form). */
vec3 masu_ycocg(vec3 c)
{
    return vec3(0.25 * (c.r + c.b) + 0.5 * c.g, 0.5 * (c.r - c.b), 0.5 * c.g - 0.25 * (c.r + c.b));
}

vec3 masu_from_ycocg(vec3 v)
{
    float rest = v.x - v.z;
    return vec3(rest + v.y, v.x + v.z, rest - v.y);
}

float masu_luma(vec3 c)
{
    return 0.25 * (c.r + c.b) + 0.5 * c.g;
}

vec3 masu_no_brighter(vec3 color, float most)
{
    float y = masu_luma(color);
    return y > most ? color * (most / max(y, 1e-9)) : color;
}

/* moved: pixels. */
bool masu_is_moving(vec2 moved)
{
    return any(greaterThan(abs(moved), vec2(0.05)));
}

/* The low half of an age. */
uint masu_pack_far(float far)
{
    return packHalf2x16(vec2(masu_sane(far, 0.0, 65504.0), 0.0)) & 0xFFFFu;
}

uint masu_pack_age(float frames, uint far)
{
    uint age = uint(masu_sane(frames, 0.0, 1023.0) * 64.0 + 0.5);
    return age << 16 | far;
}

float masu_age_frames(uint word)
{
    return float(word >> 16) / 64.0;
}

float masu_age_far(uint word)
{
    return masu_sane(unpackHalf2x16(word).x, 0.0, 65504.0);
}

/* Whether a surface point is on the plane of another, for texels of width `width`: on a curved
 * surface the neighbour's point deviates from the plane by less than the width. */
bool masu_same_plane(vec3 away, vec3 normal, float width)
{
    return abs(dot(away, normal)) < width;
}

/* Width of a traced texel at a point. */
float masu_texel_width(masu_guide g)
{
    return masu_specular_width(g) * float(push.traced_size);
}

/* 1 / radius of the surface, 0 if flat or concave, from the normals of the neighbours. The mean of
 * both axes: a cylinder is treated as a sphere of twice its radius. A concave mirror reflects from
 * in front of it or magnifies, which would need its focus: it is treated as flat. */
float masu_guide_curvature(usampler2D guides, ivec2 texel, masu_guide g, vec3 point)
{
    ivec2 last = ivec2(pc.output_width, pc.output_height) - 1;
    float width = masu_texel_width(g);
    float sum = 0.0;
    float count = 0.0;
    for (int k = 0; k < 4; k++) {
        int side = (k & 1) * 2 - 1;
        ivec2 at = texel + (k < 2 ? ivec2(side, 0) : ivec2(0, side));
        if (any(lessThan(at, ivec2(0))) || any(greaterThan(at, last))) {
            continue;
        }
        masu_guide o = masu_unpack_guide(texelFetch(guides, at, 0).rg);
        if (!o.there) {
            continue;
        }
        vec3 away = masu_specular_point(uvec2(at), o) - point;
        float squared = dot(away, away);
        if (!(squared > 1e-12) || !masu_same_plane(away, g.normal, 2.0 * width)) {
            continue;
        }
        sum += dot(o.normal - g.normal, away) / squared;
        count += 1.0;
    }
    return count > 0.0 ? max(sum / count, 0.0) : 0.0;
}

/* Distance of the virtual image behind a convex mirror for an object at distance `far`: the mirror
 * equation, 1/image = 1/far + 2/radius. */
float masu_image_far(float far, float curvature)
{
    return far / (1.0 + 2.0 * curvature * far);
}

/* Radius, in texels, within which the lobes of neighbours see about the same: the width of the lobe
 * at the virtual image of the hit, projected from the camera onto the surface. */
float masu_specular_reach(masu_guide g, vec3 point, float far, float curvature)
{
    float image = masu_image_far(far, curvature);
    float eye = length(point);
    float seen = image * eye / max(image + eye, 1e-9);
    return g.roughness * g.roughness * seen / max(masu_texel_width(g), 1e-9);
}

/* Share of the previous frame in a mean over that number of sixtieths of a second, independent of
 * the frame rate. */
float masu_time_share(float sixtieths)
{
    float step = abs(masu_sane(frame.eye_lo.w, -1.0, 1.0));
    step = step > 0.0 ? step * 60.0 : 1.0;
    return 1.0 - masu_exp2(-1.442695 * step / max(sixtieths, 1.0));
}

#endif

/*
 * filter.glsl: what the filters of reflections share: luma and chroma, how far over a surface a reflection
 * stays the same, and words of images.
 *
 *   specular_color, rgba16f   rgb mean radiance over frames; a mean square of its luma. As kept for the next
 *                            frame a is below 0 where nothing is traced
 *   specular_length, rg32ui     x  low half: distance of what is met, a half; high half: frames in the mean,
 *                               in 1/64
 *                            y  by how many pixels what is seen has moved since the previous frame, two
 *                               halves; all bits: it was not there
 */
#ifndef MASU_SPECULAR_FILTER_GLSL
#define MASU_SPECULAR_FILTER_GLSL

#include "specular/guide.glsl"
#include "specular/origin.glsl"

const uint masu_unmoved = 0xFFFFFFFFu; /* there is no telling how it has moved */

/* Squares of luma have to fit into halfs. */
const float masu_most_radiance = 250.0;

/* Half a step of the guide's 63: mirrors have 0 there. Their rays hold no noise, and a spatial filter
 * would only blur them. */
const float masu_mirror_roughness = 0.5 / 63.0;

vec3 masu_tamed(vec3 radiance)
{
    return masu_sane(radiance, 0.0, masu_most_radiance);
}

/* Luma, chroma orange, chroma green (Malvar and Sullivan, "YCoCg-R", JVT-I014, 2003; the form that is
 * not lossless). */
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

uint masu_pack_age(float frames, float far)
{
    uint age = uint(masu_sane(frames, 0.0, 1023.0) * 64.0 + 0.5);
    return age << 16 | (packHalf2x16(vec2(masu_sane(far, 0.0, 65504.0), 0.0)) & 0xFFFFu);
}

float masu_age_frames(uint word)
{
    return float(word >> 16) / 64.0;
}

float masu_age_far(uint word)
{
    return masu_sane(unpackHalf2x16(word).x, 0.0, 65504.0);
}

/* Whether a surface point belongs to the plane of another, both seen by texels of a width of `width`: on
 * what is curved the neighbour's point lies off the plane by less than the texel is wide. */
bool masu_same_plane(vec3 away, vec3 normal, float width)
{
    return abs(dot(away, normal)) < width;
}

/* How wide a traced texel is at a point. */
float masu_texel_width(masu_guide g)
{
    return masu_specular_width(g) * float(push.traced_size);
}

/* 1 / radius of the surface, 0 of a flat or hollow one, by how the normals of the neighbours lean. The mean of
 * both axes: a cylinder counts as a sphere of twice its radius. A hollow mirror shows things before it or
 * magnified, which would need its focus: it counts as flat. */
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

/* Distance behind a convex mirror at which it shows what lies that far before it: the mirror equation,
 * 1/image = 1/far + 2/radius. */
float masu_image_far(float far, float curvature)
{
    return far / (1.0 + 2.0 * curvature * far);
}

/* Radius, in texels, within which neighbours see about the same through their lobes: the width that the lobe
 * has at the image of what is met, as the eye sees it on the surface. */
float masu_specular_reach(masu_guide g, vec3 point, float far, float curvature)
{
    float image = masu_image_far(far, curvature);
    float eye = length(point);
    float seen = image * eye / max(image + eye, 1e-9);
    return g.roughness * g.roughness * seen / max(masu_texel_width(g), 1e-9);
}

/* Share of the previous frame that a mean over so many sixtieths of a second keeps, whatever the frame
 * rate. */
float masu_time_share(float sixtieths)
{
    float step = abs(masu_sane(frame.eye_lo.w, -1.0, 1.0));
    step = step > 0.0 ? step * 60.0 : 1.0;
    return 1.0 - masu_exp2(-1.442695 * step / max(sixtieths, 1.0));
}

#endif

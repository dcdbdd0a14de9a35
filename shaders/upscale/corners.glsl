/*
 * corners.glsl: reads the 3x3 texels around a texel of a one-channel image by four gathers, one at
 * each corner of the texel. Outside of the used part of the image, the last row or column is
 * repeated; with a size of 1 all nine are the same texel.
 */
#ifndef MASU_CORNERS_GLSL
#define MASU_CORNERS_GLSL

struct masu_corners {
    float own, left, right, above, below;
    vec4 diagonal;
};

vec4 masu_corner(sampler2D image, vec2 corner, vec2 size, vec2 texel)
{
    return textureGather(image, min(corner, size - 1.0) * texel);
}

/* size: the used part of the image; texel: 1 / size of the image. A corner beyond the last column
 * or row is moved inwards by one, which repeats that column or row. */
masu_corners masu_corners_of(sampler2D image, vec2 at, vec2 size, vec2 texel)
{
    vec4 a = masu_corner(image, at, size, texel),
         b = masu_corner(image, at + vec2(1.0, 0.0), size, texel);
    vec4 c = masu_corner(image, at + vec2(0.0, 1.0), size, texel),
         d = masu_corner(image, at + 1.0, size, texel);
    return masu_corners(a.y, a.x, b.y, a.z, c.y, vec4(a.w, b.z, c.x, d.y));
}

float masu_least_of(vec4 v)
{
    return min(min(v.x, v.y), min(v.z, v.w));
}

float masu_most_of(vec4 v)
{
    return max(max(v.x, v.y), max(v.z, v.w));
}

float masu_most_of(masu_corners c)
{
    return max(max(masu_most_of(c.diagonal), masu_most_of(vec4(c.left, c.right, c.above, c.below))),
               c.own);
}

/* Offset of the texel with the depth `nearest`, as found.glsl stores it. If several have it, a
 * direct neighbour is preferred to a diagonal one. The result is never outside of the image,
 * because a repeated texel equals the pixel or a direct neighbour. */
uint masu_way_to(masu_corners c, float nearest)
{
    uint way = masu_found_way(1, 1);
    way = c.diagonal.z == nearest ? masu_found_way(-1, 1) : way;
    way = c.diagonal.y == nearest ? masu_found_way(1, -1) : way;
    way = c.diagonal.x == nearest ? masu_found_way(-1, -1) : way;
    way = c.below == nearest ? masu_found_way(0, 1) : way;
    way = c.above == nearest ? masu_found_way(0, -1) : way;
    way = c.right == nearest ? masu_found_way(1, 0) : way;
    way = c.left == nearest ? masu_found_way(-1, 0) : way;
    return c.own == nearest ? masu_found_way(0, 0) : way;
}

float masu_least_of(masu_corners c)
{
    return min(
        min(masu_least_of(c.diagonal), masu_least_of(vec4(c.left, c.right, c.above, c.below))),
        c.own);
}

#endif

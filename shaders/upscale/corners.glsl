/*
 * corners.glsl: the 3x3 texels around one, of an image of one channel, by four fetches: of the four corners of the texel.
 * Beyond the part of the image that holds a picture the last row or column is repeated; of a size of 1 it is the same
 * texel nine times.
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

/* size: of the part of the image that holds a picture; texel: 1 / size of the image. A corner that would lie beyond the last
 * column or row moves in by one: what of it lies outward is the same then. */
masu_corners masu_corners_of(sampler2D image, vec2 at, vec2 size, vec2 texel)
{
    vec4 a = masu_corner(image, at, size, texel), b = masu_corner(image, at + vec2(1.0, 0.0), size, texel);
    vec4 c = masu_corner(image, at + vec2(0.0, 1.0), size, texel), d = masu_corner(image, at + 1.0, size, texel);
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
    return max(max(masu_most_of(c.diagonal), masu_most_of(vec4(c.left, c.right, c.above, c.below))), c.own);
}

/* The way to the nearest, of found.glsl: of several the one that the pixel has a side in common
 * with. None lies beyond the picture: what is repeated there is the pixel, or has a side in common
 * with it. */
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
    return min(min(masu_least_of(c.diagonal), masu_least_of(vec4(c.left, c.right, c.above, c.below))), c.own);
}

#endif

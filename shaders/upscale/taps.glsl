/*
 * taps.glsl: the twelve texels that EASU reads, from the corner pc.render_* of an image, clamped to
 * its edge. f, the first of the central four, is between -1 and the last texel (place.glsl), so
 * each column and each row is clamped on one side: eight operations for all twelve.
 */
#ifndef MASU_TAPS_GLSL
#define MASU_TAPS_GLSL

vec3 masu_tap(sampler2D source, int x, int y)
{
    return masu_fetched_unorm(texelFetch(source, ivec2(x, y), 0).rgb);
}

/* Columns and rows, clamped. */
struct masu_cross {
    ivec2 c0, c1, c2, c3;
};

masu_cross masu_cross_of(ivec2 f)
{
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    return masu_cross(max(f - 1, 0), max(f, 0), min(f + 1, last), min(f + 2, last));
}

void masu_fetch_middle(sampler2D source, masu_cross c, inout masu_taps t)
{
    t.f = masu_tap(source, c.c1.x, c.c1.y);
    t.g = masu_tap(source, c.c2.x, c.c1.y);
    t.j = masu_tap(source, c.c1.x, c.c2.y);
    t.k = masu_tap(source, c.c2.x, c.c2.y);
}

void masu_fetch_around(sampler2D source, masu_cross c, inout masu_taps t)
{
    t.b = masu_tap(source, c.c1.x, c.c0.y);
    t.c = masu_tap(source, c.c2.x, c.c0.y);
    t.e = masu_tap(source, c.c0.x, c.c1.y);
    t.h = masu_tap(source, c.c3.x, c.c1.y);
    t.i = masu_tap(source, c.c0.x, c.c2.y);
    t.l = masu_tap(source, c.c3.x, c.c2.y);
    t.n = masu_tap(source, c.c1.x, c.c3.y);
    t.o = masu_tap(source, c.c2.x, c.c3.y);
}

masu_taps masu_fetch_taps(sampler2D source, ivec2 f)
{
    masu_cross c = masu_cross_of(f);
    masu_taps t;
    masu_fetch_middle(source, c, t);
    masu_fetch_around(source, c, t);
    return t;
}

#endif

/*
 * taps.glsl: the twelve texels that EASU reads, of the corner pc.render_* of an image: what lies beyond repeats its
 * edge. f, the first of the middle four, lies between -1 and the last texel (place.glsl), so each column and each
 * row is clamped on one side: eight operations for all twelve.
 */
#ifndef MASU_TAPS_GLSL
#define MASU_TAPS_GLSL

vec3 masu_tap(sampler2D source, int x, int y)
{
    return masu_fetched_unorm8(texelFetch(source, ivec2(x, y), 0).rgb);
}

masu_taps masu_fetch_taps(sampler2D source, ivec2 f)
{
    ivec2 last = ivec2(pc.render_width, pc.render_height) - 1;
    ivec2 c0 = max(f - 1, 0), c1 = max(f, 0), c2 = min(f + 1, last), c3 = min(f + 2, last);
    masu_taps t;
    t.b = masu_tap(source, c1.x, c0.y);
    t.c = masu_tap(source, c2.x, c0.y);
    t.e = masu_tap(source, c0.x, c1.y);
    t.f = masu_tap(source, c1.x, c1.y);
    t.g = masu_tap(source, c2.x, c1.y);
    t.h = masu_tap(source, c3.x, c1.y);
    t.i = masu_tap(source, c0.x, c2.y);
    t.j = masu_tap(source, c1.x, c2.y);
    t.k = masu_tap(source, c2.x, c2.y);
    t.l = masu_tap(source, c3.x, c2.y);
    t.n = masu_tap(source, c1.x, c3.y);
    t.o = masu_tap(source, c2.x, c3.y);
    return t;
}

#endif

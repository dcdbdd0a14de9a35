/* easu_gather.comp: EASU that reads its texels like AMD's shader, with four gathers per channel,
 * for comparison with easu.comp by `masu-lab study upscale`. It is not a pass of a frame. The input
 * must fill its image: at the border of a part, a gather would read texels outside it. */
#version 440
#extension GL_GOOGLE_include_directive : require
#include "push/easu.h"
#include "shared/types.h"
#include "shared/store.glsl"
#include "upscale/easu.glsl"
#include "upscale/place.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

#include "shared/push.glsl"

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D source; /* perceptual RGB in 0..1 */
layout(set = MASU_SET_PASS, binding = 1, rgba8) uniform writeonly image2D target;

/* The four texels around a corner: x lower left, y lower right, z upper right, w upper left. */
void gather(vec2 corner, out vec3 x, out vec3 y, out vec3 z, out vec3 w)
{
    vec4 r = textureGather(source, corner, 0);
    vec4 g = textureGather(source, corner, 1);
    vec4 b = textureGather(source, corner, 2);
    x = vec3(r.x, g.x, b.x);
    y = vec3(r.y, g.y, b.y);
    z = vec3(r.z, g.z, b.z);
    w = vec3(r.w, g.w, b.w);
}

void main()
{
    uvec2 to = uvec2(pc.output_width, pc.output_height);
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, to))) {
        return;
    }
    vec2 from = vec2(pc.render_width, pc.render_height);
    masu_place place = masu_place_of(at, vec2(push.scale_x, push.scale_y));
    vec2 f = vec2(place.texel);
    masu_taps t;
    vec3 unused_0, unused_1;
    gather((f + vec2(1.0, 0.0)) / from, unused_0, unused_1, t.c, t.b);
    gather((f + vec2(0.0, 1.0)) / from, t.i, t.j, t.f, t.e);
    gather((f + vec2(2.0, 1.0)) / from, t.k, t.l, t.h, t.g);
    gather((f + vec2(1.0, 2.0)) / from, t.n, t.o, unused_0, unused_1);
    vec3 result = masu_easu(t, masu_edge_of(t, place.p), place.p);
    MASU_STORE_UNORM(target, at, vec4(result, 1.0));
}

/*
 * cascade.vert: polygons as the sun sees them, for one cascade of the shadow map; a fragment shader
 * have only masks (MASU_TEXTURES). push.cascade is the cascade. Placed relative to the cascade's own centre, not to the
 * eye: while the cascade stays where it is, so does every bit of its texels.
 *
 * A surface that is steep to the sun changes its depth within a texel, and would shadow itself: it is
 * drawn farther from the sun by BIAS times what it changes. By its normal and here, not by the
 * rasteriser's slope bias, which has a bound only with an optional feature: culling by occluders must
 * know how far a mesh may lie behind its occluder (src/frame/occlusion.c), or what is culled would show.
 *
 * The triangles of a smooth mesh lie below its surface, by push.rise at most. Light that grazes the
 * surface is cut off by the triangles beside, in saw-teeth along the terminator: so vertices are
 * drawn below the surface by as much (the terminator of Hanika, "Hacking the Shadow Terminator",
 * Ray Tracing Gems II, 2021, from the caster's side: a shadow map does not know which triangle a
 * receiver is of). Shadows begin that much farther inside at contacts.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/cascade.h"
#include "shared/materials.h"
#include "shared/shadow.h"
#include "shared/polygons.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_SHADOW, std140) uniform Shadow
{
    masu_shadow_uniforms shadow;
};

#ifdef MASU_TEXTURES
layout(location = 2) in vec2 texcoord;
layout(location = 3) out vec2 out_texcoord;
#endif

/* Depth that a surface of that normal gains or loses along the edge of a texel. */
float slope_of(vec3 n, uint k)
{
    float texel = shadow.origin_hi[k].w;
    float metre = shadow.origin_lo[k].w;
    float half_width = 0.5 * texel * shadow.rect[k].z;
    float across = max(abs(dot(n, shadow.row0[k].xyz)), abs(dot(n, shadow.row1[k].xyz))) * half_width;
    float towards = abs(dot(n, shadow.row2[k].xyz)) / metre;
    bool flat_enough = across < MASU_SHADOW_STEEPEST * towards;
    return (flat_enough ? across / towards : MASU_SHADOW_STEEPEST) * texel * metre;
}

void main()
{
    uint id = masu_instance_id();
    masu_instance_data m = instances[id];
    uint k = min(push.cascade, uint(MASU_CASCADES_MAX - 1));
    vec3 thinner = position - push.rise * masu_oct_decode(oct_normal);
    precise vec3 at = masu_point_seen_from(m, thinner, shadow.origin_hi[k].xyz,
                                           shadow.origin_lo[k].xyz);
    precise float x = dot(shadow.row0[k].xyz, at);
    precise float y = dot(shadow.row1[k].xyz, at);
    precise float z = dot(shadow.row2[k].xyz, at) + shadow.rect[k].w;
    z -= MASU_SHADOW_BIAS * slope_of(masu_turned_normal(m), k);
#ifdef MASU_TEXTURES
    out_texcoord = masu_moved_texcoord(id, texcoord);
#endif
    /* What is nearer to the sun than the box is flattened onto its near side, not clipped. */
    gl_Position = vec4(x, y, min(z, 1.0), 1.0);
}

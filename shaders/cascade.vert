/*
 * cascade.vert: polygons in light space, for one cascade of the sun's shadow map; there is a
 * fragment shader only for masks (MASU_TEXTURES). push.cascade is the cascade. Positions are
 * relative to the cascade's centre, not to the camera: while the cascade does not move, its texels
 * are bit-identical.
 *
 * A surface that is steep to the sun changes its depth within a texel and would shadow itself: it
 * is drawn farther from the sun by BIAS times this change. The bias is computed here from the
 * normal. The rasteriser's slope bias is bounded only with an optional feature, and occlusion
 * culling needs the maximum distance of a mesh behind its occluder (src/frame/occlusion.c); else
 * culled meshes would be visible.
 *
 * The triangles of a smooth mesh are below its surface, by push.rise at most. Grazing light is
 * blocked by adjacent triangles, which gives a saw-tooth terminator. So vertices are drawn below
 * the surface by the same amount (the terminator fix of Hanika, "Hacking the Shadow Terminator",
 * Ray Tracing Gems II, 2021, applied to the caster: a shadow map does not store the receiver's
 * triangle). Contact shadows begin farther inside by the same distance.
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

/* Depth change of a surface with this normal over the width of a texel. */
float slope_of(vec3 n, uint k)
{
    float texel = shadow.origin_hi[k].w;
    float metre = shadow.origin_lo[k].w;
    float half_width = 0.5 * texel * shadow.rect[k].z;
    float across = max(abs(dot(n, shadow.row0[k].xyz)), abs(dot(n, shadow.row1[k].xyz))) *
                   half_width;
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
    /* Casters between the sun and the cascade's bounds are clamped to the near side, not
     * clipped. */
    gl_Position = vec4(x, y, min(z, 1.0), 1.0);
}

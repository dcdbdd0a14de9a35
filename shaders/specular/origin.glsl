/*
 * origin.glsl: where the ray of a traced texel begins: on the surface, lifted off it by what the depth image
 * and floats that far from the anchor cannot tell, and by a part of the pixel's width, so that a flat
 * triangle whose normals are those of something round does not meet itself.
 */
#ifndef MASU_SPECULAR_ORIGIN_GLSL
#define MASU_SPECULAR_ORIGIN_GLSL

#include "specular/guide.glsl"

/* Relative to the eye, without the lift. */
vec3 masu_specular_point(uvec2 texel, masu_guide g)
{
    return masu_guide_point(masu_guide_place(texel, g.pixel, push.traced_size), g.depth);
}

/* How far it lies off a plane, without where it is. */
float masu_specular_off(masu_flat f, uvec2 texel, masu_guide g)
{
    return masu_off(f, masu_guide_place(texel, g.pixel, push.traced_size), g.depth);
}

/* A pixel's width at a point. */
float masu_specular_width(masu_guide g)
{
    float z = frame.forward.w * masu_rcp(g.depth);
    return z * frame.up.w * 2.0 / float(pc.render_height);
}

/* Relative to the anchor of what is traced. */
vec3 masu_specular_origin(vec3 point, masu_guide g)
{
    vec3 at = point + frame.trace_eye.xyz;
    float far = max(max(abs(at.x), abs(at.y)), max(abs(at.z), length(point)));
    return at + g.normal * (0.125 * masu_specular_width(g) + 9.6e-7 * far);
}

#endif

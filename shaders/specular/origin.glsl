/*
 * origin.glsl: the start of a traced texel's ray: a surface point, lifted by the rounding of depth
 * and of coordinates that far from the anchor, and by a part of the pixel's width, so that a flat
 * triangle with the normals of a curved surface does not hit itself.
 */
#ifndef MASU_SPECULAR_ORIGIN_GLSL
#define MASU_SPECULAR_ORIGIN_GLSL

#include "specular/guide.glsl"

/* Relative to the camera, without the lift. */
vec3 masu_specular_point(uvec2 texel, masu_guide g)
{
    return masu_guide_point(masu_guide_place(texel, g.pixel, push.traced_size), g.depth);
}

/* Distance of the point from a plane, without computing the point. */
float masu_specular_off(masu_flat f, uvec2 texel, masu_guide g)
{
    return masu_off(f, masu_guide_place(texel, g.pixel, push.traced_size), g.depth);
}

/* Width of a pixel at a point. */
float masu_specular_width(masu_guide g)
{
    float z = frame.forward.w * masu_rcp(g.depth);
    return z * frame.up.w * 2.0 / float(pc.render_height);
}

/* Relative to the anchor of the traced scene, lifted. */
vec3 masu_specular_origin(vec3 point, masu_guide g)
{
    vec3 at = point + frame.trace_eye.xyz;
    float far = max(max(abs(at.x), abs(at.y)), max(abs(at.z), length(point)));
    return at + g.normal * (0.125 * masu_specular_width(g) + 9.6e-7 * far);
}

#endif

/*
 * ao_texel.glsl: shared by ao.comp and ao_upsample.comp: view space, and the texel format between
 * them.
 *
 * The upper 22 of the depth's 31 bits without the sign are stored: 14 of the mantissa, so a view z
 * has a relative error of at most 1 / 32768, a thirtieth of a pixel's width at 1080 lines. The
 * other ten hold the visibility in steps of 1 / 1023. An orthographic camera is a narrow lens far
 * behind its near plane; there 1 - depth is stored, and the error is that share of the distance
 * from the near plane.
 */
#ifndef MASU_AO_TEXEL_GLSL
#define MASU_AO_TEXEL_GLSL

layout(constant_id = 22) const bool masu_flat_lens = false;

/* No samples beyond this: the squares below remain within fp32. */
const float ao_farthest = 1e15;

struct ao_lens {
    vec2 size;   /* pixels */
    vec2 pixels; /* per unit of x / z and y / z */
    vec2 scale;  /* x / z and y / z of a pixel's width */
    vec2 corner; /* and of the image's upper left corner */
};

ao_lens ao_lens_of(uvec2 size)
{
    ao_lens lens;
    vec2 tangent = vec2(frame.right.w, frame.up.w);
    lens.size = vec2(size);
    lens.scale = 2.0 * tangent / lens.size;
    lens.pixels = 0.5 * lens.size / tangent;
    lens.corner = tangent * (frame.jitter.xy - 1.0);
    return lens;
}

/* View z of a depth, above 0; at least ao_farthest without a surface, or for NaN. */
float ao_view_z(float depth)
{
    float z = depth > 0.0 ? frame.forward.w / depth : ao_farthest;
    return z > 0.0 && z < ao_farthest ? z : ao_farthest;
}

vec3 ao_place(ao_lens lens, vec2 pixel, float z)
{
    return vec3((lens.corner + lens.scale * pixel) * z, z);
}

/* Right, down, away. */
vec3 ao_view_normal(uint texel)
{
    vec3 n = masu_unpack_normal(texel);
    return vec3(dot(n, frame.right.xyz) * masu_rcp(frame.right.w),
                -dot(n, frame.up.xyz) * masu_rcp(frame.up.w), dot(n, frame.forward.xyz));
}

uint ao_pack(float seen, float depth)
{
    float kept = masu_flat_lens ? 1.0 - depth : depth;
    uint bits = min(floatBitsToUint(max(kept, 0.0)), 0x7F7FFDFFu) + 0x100u;
    return uint(seen * 1023.0 + 0.5) | (bits >> 9) << 10;
}

float ao_unpack_seen(uint texel)
{
    return float(texel & 1023u) / 1023.0;
}

float ao_unpack_depth(uint texel)
{
    float kept = uintBitsToFloat(texel >> 10 << 9);
    return masu_flat_lens ? 1.0 - kept : kept;
}

#endif

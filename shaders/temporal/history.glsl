/*
 * history.glsl: what rung.temporal keeps of a pixel of the output, in two words:
 *
 *   x    12 bits each of red, green, and of blue the upper 8; y: the lower 4: roots of display light
 *   y    7 bits each: where the samples lie on average, beside the pixel's middle, -1 to 1 pixels; 8 bits: how many,
 *        in eighths; 6 bits unused
 */
#ifndef MASU_HISTORY_GLSL
#define MASU_HISTORY_GLSL

struct masu_history {
    vec3 light;
    vec2 beside;
    float count;
};

uvec2 masu_pack_history(masu_history h)
{
    uvec3 c = uvec3(clamp(sqrt(max(h.light, 0.0)), 0.0, 1.0) * 4095.0 + 0.5);
    uvec2 b = uvec2(clamp(h.beside, -1.0, 1.0) * 63.0 + 63.5);
    uint n = uint(clamp(h.count, 0.0, 31.875) * 8.0 + 0.5);
    return uvec2(c.r << 20 | c.g << 8 | c.b >> 4, (c.b & 15u) << 28 | b.x << 21 | b.y << 14 | n << 6);
}

masu_history masu_unpack_history(uvec2 w)
{
    vec3 root = vec3(uvec3(w.x >> 20, w.x >> 8 & 4095u, (w.x & 255u) << 4 | w.y >> 28)) * (1.0 / 4095.0);
    vec2 beside = vec2(uvec2(w.y >> 21 & 127u, w.y >> 14 & 127u)) * (1.0 / 63.0) - 1.0;
    return masu_history(root * root, beside, float(w.y >> 6 & 255u) * 0.125);
}

#endif

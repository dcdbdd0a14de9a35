/*
 * live_textures.glsl: samples of textures that the host writes at run time (desc.reserve.textures),
 * which have no mips. A pixel takes the mean of up to 4 x 4 bilinear samples, one per texel along
 * its x and y axis: without aliasing up to four texels per pixel, in any direction. Cells of an
 * atlas do not bleed, since each sample stays half a texel within.
 */
#ifndef MASU_LIVE_TEXTURES_GLSL
#define MASU_LIVE_TEXTURES_GLSL

#include "shared/guard.glsl"

/* What becomes of coordinates outside the cell. */
#define MASU_LIVE_CLAMP 0u
#define MASU_LIVE_REPEAT 1u /* along x, of trails */
#define MASU_LIVE_WRAP 2u   /* the sampler wraps them; the cell is the whole texture */

const int masu_live_taps = 4; /* along an axis of the pixel */

int masu_live_steps(vec2 texels)
{
    return int(clamp(ceil(masu_sqrt(dot(texels, texels)) - 0.01), 1.0, float(masu_live_taps)));
}

/* Mean colour and alpha over a pixel; colour is weighted by alpha. cell: two opposite corners in
 * the texture; at: in the cell, 0..1; dx, dy: its change to the next pixel. */
vec4 masu_live_mean(sampler2DArray image, float layer, vec4 cell, vec2 at, vec2 dx, vec2 dy,
                    uint outside)
{
    vec2 size = vec2(textureSize(image, 0).xy), extent = cell.zw - cell.xy;
    vec2 low = min(cell.xy, cell.zw) * size + 0.5, high = max(cell.xy, cell.zw) * size - 0.5;
    vec2 middle = 0.5 * (low + high); /* of a cell below a texel */
    low = min(low, middle);
    high = max(high, middle);
    ivec2 steps = ivec2(masu_live_steps(dx * extent * size), masu_live_steps(dy * extent * size));
    vec4 sum = vec4(0.0);
    for (int y = 0; y < masu_live_taps; y++) {
        if (y >= steps.y) {
            break;
        }
        for (int x = 0; x < masu_live_taps; x++) {
            if (x >= steps.x) {
                break;
            }
            vec2 step_at = (vec2(float(x), float(y)) + 0.5) / vec2(steps) - 0.5;
            vec2 p = at + dx * step_at.x + dy * step_at.y;
            p.x -= outside == MASU_LIVE_REPEAT ? floor(p.x) : 0.0;
            p = (cell.xy + p * extent) * size;
            p = outside == MASU_LIVE_WRAP ? p : clamp(p, low, high);
            vec4 texel = textureLod(image, vec3(p / size, layer), 0.0);
            sum += vec4(texel.rgb * texel.a, texel.a);
        }
    }
    return vec4(sum.rgb / max(sum.a, 1e-6), sum.a / float(steps.x * steps.y));
}

#endif

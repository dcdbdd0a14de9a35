/*
 * temporal.comp: temporal anti-aliasing and upscaling. For each output pixel it averages the
 * history and the nearest samples of this frame, weighted by the number of samples in each. Start
 * with docs/design/17-temporal-upscaling.md. temporal_find.comp has already found the position and
 * the weight of the history.
 *
 * The jitter moves the samples within their pixels every frame, so the history gathers samples from
 * the whole pixel. If the total weight is below 1, bilinear filtering of the four nearest texels
 * supplies the remainder.
 *
 * Colours are averaged in linear display light (docs/design/18-error-measurement.md); channel a
 * counts samples. upscale/mean.glsl defines how the history is stored, upscale/history.glsl how it
 * is read.
 *
 * Push constants: output_* = size to write; push.scale_* = input size * (1 / output size);
 * push.texel_*: 1 / size of the image of colour; history.glsl documents the rest.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#define MASU_OUTPUT
#include "push/temporal.h"
#include "shared/types.h"
#include "shared/output.glsl"
#include "upscale/found.glsl"
#include "upscale/history.glsl"
#include "upscale/roots.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image; /* square roots of
                                                                         * display-linear colour */

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (masu_is_outside(at)) {
        return;
    }
    vec2 scale = vec2(push.scale_x, push.scale_y), steps = 1.0 / scale;
    /* In texels of the render size, whose centres are whole numbers. place: position of the pixel;
     * inside: place clamped to the image, slightly before the centre of the last texel, because the
     * next texel is read even for a weight of 0; texel: the texel that contains it; corner: the
     * upper left of the four texels around it (the same texel for a size of 1). */
    vec2 place = (vec2(at) + 0.5) * scale - (frame.shifts.xy + 0.5);
    vec2 inside = min(max(place, vec2(0.0)), vec2(push.last_x, push.last_y));
    vec2 texel = floor(inside + 0.5), corner = floor(inside);
    vec2 f = place - corner;

    /* Read before `found`: these reads do not depend on it, all later ones do. */
    vec2 gather = (corner + 1.0) * vec2(push.texel_x, push.texel_y);
    vec4 red = textureGather(color_image, gather, 0), green = textureGather(color_image, gather, 1),
         blue = textureGather(color_image, gather, 2);
    green += masu_root_rest * textureGather(color_image, gather, 3);
    uvec2 found = texelFetch(found_image, ivec2(texel), 0).xy;
    masu_past old = masu_history(found, vec2(at) + 0.5, ivec2(texel), inside, steps);

    /* Stationary pixels of an unchanged scene: a sample contributes to the output pixel that
     * contains it, plus a small border. Other pixels have few samples, so they use a tent filter
     * two output pixels wide, 2.5 at half size (0.6 of that tent and 0.4 of the input's tent).
     * Without the extra width, rows that this frame's samples miss would differ from their
     * neighbours: dotted edges. */
    bool stays = masu_has_stayed(found);
    vec2 slope = stays ? 2.0 * steps : 0.6 * steps + 0.4;
    float top = stays ? 1.5 : 1.0;
    vec2 first = clamp(top - abs(f) * slope, 0.0, 1.0),
         second = clamp(top - abs(1.0 - f) * slope, 0.0, 1.0);
    vec2 both = first + second;
    float count = old.mean.a + both.x * both.y;
    float rest = max(1.0 - count, 0.0);
    f = clamp(f, 0.0, 1.0);
    vec4 around = vec4(1.0 - f.x, f.x, f.x, 1.0 - f.x) * vec4(f.y, f.y, 1.0 - f.y, 1.0 - f.y);
    vec4 weights = vec4(first.x, second.x, second.x, first.x) *
                   vec4(second.y, second.y, first.y, first.y);
    weights += rest * around;
    vec3 sum = old.mean.a * old.mean.rgb + vec3(dot(weights, red * red),
                                                dot(weights, green * green),
                                                dot(weights, blue * blue));
    vec3 light = sum * (1.0 / max(count, 1.0));
    masu_show(ivec2(at), light, count, old, stays, masu_chance(at));
}

/*
 * temporal.comp: prototype
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#define MASU_PUSH masu_push_temporal
#include "shared/masu_shared.h"
#include "shared/globals.glsl"
#include "shared/store.glsl"
#include "shared/motion.glsl"
#include "temporal/history.glsl"

layout(local_size_x = MASU_GROUP, local_size_y = MASU_GROUP) in;

layout(set = MASU_SET_PASS, binding = 0) uniform sampler2D color_image;
layout(set = MASU_SET_PASS, binding = 1) uniform sampler2D depth_image;
layout(set = MASU_SET_PASS, binding = 2) uniform sampler2D velocity_image;
layout(set = MASU_SET_PASS, binding = 3) uniform sampler2D history_depth;
layout(set = MASU_SET_PASS, binding = 4) uniform sampler2D history_image;
layout(set = MASU_SET_PASS, binding = 5, rgba16f) uniform writeonly image2D accumulated_image;

/*PAR*/
#define CAP 32.0
#define CAP_MOVE 2.0
#define SHARPEN 0.06
#define CLIP 1.0
#define WHERE true
/*END*/
/*DEF*/
#ifndef CAP
#define CAP 16.0
#endif
#ifndef SLOPES
#define SLOPES 2.0
#endif
#ifndef WIDE
#define WIDE 2.0
#endif
#ifndef LAMBDA
#define LAMBDA 1.0
#endif
#ifndef SHARP
#define SHARP 0.5
#endif
#ifndef CAP_MOVE
#define CAP_MOVE 6.0
#endif
#ifndef WHERE
#define WHERE doubt
#endif
#ifndef ZOOM
#define ZOOM 20.0
#endif
#ifndef KERNEL
#define KERNEL 1.0
#endif

vec3 decoded(vec3 c) { return c * c; }

/* cubic of the family B=0, C: weights of the four taps at t */
vec4 cubic(float t)
{
    const float c = SHARP;
    float t2 = t * t, t3 = t2 * t;
    return vec4(-c * t + 2.0 * c * t2 - c * t3, 1.0 + (c - 3.0) * t2 + (2.0 - c) * t3,
                c * t + (3.0 - 2.0 * c) * t2 + (c - 2.0) * t3, -c * t2 + c * t3);
}

bool doubt = false, told = false;
float least_expected = 0.0;

bool same_owner(ivec2 texel, float expected, float tolerance, vec2 old_size)
{
    vec2 size = vec2(pc.output_width, pc.output_height);
    vec2 place = (vec2(texel) + 0.5) / size * old_size - previous.jitter.xy * 0.5 * old_size;
    float depth = texelFetch(history_depth, clamp(ivec2(floor(place)), ivec2(0), ivec2(old_size) - 1), 0).r;
    bool nearer = depth > expected + tolerance;
    doubt = doubt || nearer;
    told = told || !nearer;
    return depth >= least_expected - tolerance;
}

void main()
{
    uvec2 at = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(at, uvec2(pc.output_width, pc.output_height)))) {
        return;
    }
    vec2 size = vec2(pc.output_width, pc.output_height), render = vec2(pc.render_width, pc.render_height);
    vec2 scale = vec2(push.scale_x, push.scale_y);
    vec2 q = (vec2(at) + 0.5) * scale - frame.jitter.xy * 0.5 * render;
    ivec2 base = clamp(ivec2(floor(q)), ivec2(0), ivec2(render) - 1);

    vec3 sum = vec3(0.0), wide = vec3(0.0), m1 = vec3(0.0), m2 = vec3(0.0);
    vec2 beside = vec2(0.0);
    float w = 0.0, wide_w = 0.0, near = -1.0, far = 1e30;
    ivec2 nearest = base;
    float depths[9];
    for (int i = 0; i < 9; i++) {
        ivec2 to = clamp(base + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), ivec2(render) - 1);
        float depth = texelFetch(depth_image, to, 0).r;
        depths[i] = depth;
        if (depth > near) {
            near = depth;
            nearest = to;
        }
        far = min(far, depth);
    }

    vec2 p4 = q - 0.5;
    ivec2 c0 = ivec2(floor(p4));
    vec2 f4 = p4 - floor(p4);
    vec4 v = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        ivec2 o = ivec2(i & 1, i >> 1);
        float k = (o.x == 1 ? f4.x : 1.0 - f4.x) * (o.y == 1 ? f4.y : 1.0 - f4.y);
        v += k * texelFetch(velocity_image, clamp(c0 + o, ivec2(0), ivec2(render) - 1), 0);
    }
    if (near - far > 0.1 * near || v.w < 0.99) {
        v = texelFetch(velocity_image, nearest, 0);
    }
    vec2 moved = v.xy + (previous.jitter.xy - frame.jitter.xy) * (0.5 * render);
    vec2 before = vec2(at) + 0.5 + moved / scale;
    vec2 old_size = vec2(frame.temporal.xy);
    bool valid = frame.temporal.x != 0u && v.w > 0.0 && all(greaterThanEqual(before, vec2(0.0))) && all(lessThanEqual(before, size));
    masu_history h = masu_history(vec3(0.0), vec2(0.0), 0.0);
    if (valid) {
        float c = depths[4];
        vec2 slope = vec2(min(abs(depths[3] - c), abs(depths[5] - c)), min(abs(depths[1] - c), abs(depths[7] - c)));
        float ratio = previous.forward.w / (frame.forward.w * (1.0 + v.z));
        float expected = near * ratio;
        least_expected = far * ratio;
        float tolerance = (0.01 * near + SLOPES * (slope.x + slope.y)) * ratio;
        vec2 b2 = floor(before - 0.5) + 0.5;
        vec2 t = before - b2;
        vec4 wx = cubic(t.x), wy = cubic(t.y);
        ivec2 last = ivec2(size) - 1;
        vec3 sum4 = vec3(0.0), lin = vec3(0.0);
        float n = 0.0, all_w = 0.0;
        bool whole = true;
        for (int y = 0; y < 4; y++) {
            for (int x = 0; x < 4; x++) {
                ivec2 to = clamp(ivec2(b2) + ivec2(x - 1, y - 1), ivec2(0), last);
                vec4 o = texelFetch(history_image, to, 0);
                sum4 += o.rgb * (wx[x] * wy[y]);
                if ((x == 1 || x == 2) && (y == 1 || y == 2)) {
                    float b = (x == 1 ? 1.0 - t.x : t.x) * (y == 1 ? 1.0 - t.y : t.y);
                    bool good = same_owner(to, expected, tolerance, old_size);
                    if (good) {
                        n += o.a * b;
                        lin += o.rgb * b;
                        all_w += b;
                    }
                    whole = whole && (good || b < 0.01);
                }
            }
        }
        h.light = whole ? max(sum4, 0.0) : lin / max(all_w, 1e-4);
        vec2 bl = 4.0 * t * (1.0 - t);
        float still = 1.0 - clamp(length(moved) * 4.0, 0.0, 1.0);
        float cap = mix(CAP_MOVE / (1.0 + ZOOM * abs(v.z) + 0.1 * length(moved)), CAP, still);
        h.count = told ? min(n, cap) : 0.0;
        doubt = doubt || near - far > 0.1 * near;
    }
    vec3 least = vec3(1e9), most = vec3(-1e9);
    vec2 middle = LAMBDA * h.beside * (h.count > 0.0 ? 1.0 : 0.0);
    for (int i = 0; i < 9; i++) {
        ivec2 to = clamp(base + ivec2(i % 3 - 1, i / 3 - 1), ivec2(0), ivec2(render) - 1);
        vec3 c = decoded(texelFetch(color_image, to, 0).rgb);
        vec2 d = vec2(to) + 0.5 - q;
        vec2 tent = max(1.0 - abs(d / scale - middle) * KERNEL, 0.0);
#ifdef BOX
        vec2 box = vec2(lessThan(abs(d / scale - middle), vec2(0.5)));
        float k = box.x * box.y;
#else
        float k = tent.x * tent.y;
#endif
        float g = exp(-WIDE * dot(d, d));
        sum += k * c;
        beside += k * d / scale;
        w += k;
        wide += g * c;
        wide_w += g;
        least = min(least, c);
        most = max(most, c);
        m1 += c * (1.0 / 9.0);
        m2 += c * c * (1.0 / 9.0);
    }
    wide /= wide_w;
#ifdef CLIP
    if (WHERE && dot(moved, moved) > 4e-4) {
        vec3 sigma = sqrt(max(m2 - m1 * m1, 0.0));
        h.light = clamp(h.light, max(least, m1 - CLIP * sigma), min(most, m1 + CLIP * sigma));
    }
#endif
    float total = h.count + w;
    vec3 mean = h.count * h.light + sum;
    float fill = max(1.0 - total, 0.0);
    vec3 result = (mean + fill * wide) / (total + fill);
    masu_history keep = masu_history(masu_sane(result, 0.0, 1.0), (h.count * h.beside + beside) / (total + fill), total);
    vec4 out4 = vec4(keep.light, min(total, 64.0));
    uint noise = at.x * 0xC13FA9A9u + at.y * 0x91E10DA5u + frame.history.x * 0x9E3779B9u;
    uvec4 bits = floatBitsToUint(out4) + (uvec4(noise, noise + 0x55555555u, noise + 0xAAAAAAAAu, 0x80000000u) >> 19);
    MASU_STORE_HALF(accumulated_image, at, uintBitsToFloat(bits & 0xFFFFE000u));
}

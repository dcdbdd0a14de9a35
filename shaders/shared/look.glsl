/*
 * look.glsl: the look of an instance between vertex and fragment shader: tint and emission, and the
 * fade with the number that its pattern starts from: the frame's in rungs with temporal upscaling,
 * which average the patterns, else 0. After polygons.glsl and `frame` in a vertex shader
 * (MASU_LOOK_OUT).
 */
#ifndef MASU_LOOK_GLSL
#define MASU_LOOK_GLSL

#define MASU_FADE_STEPS 16777216.0

#ifdef MASU_LOOK_OUT
layout(location = 6) flat out vec4 out_tint;
layout(location = 7) flat out uvec2 out_fade;

void masu_pass_look(uint id)
{
    if (masu_looks) {
        masu_instance_data look = masu_look_of(id);
        out_tint = look.row0;
        float fade = masu_sane(look.row2.x, 0.0, 1.0);
        out_fade = uvec2(uint(fade * MASU_FADE_STEPS),
                         frame.temporal.x != 0u ? frame.history.x : 0u);
    }
}
#else
layout(constant_id = 24) const uint masu_draws_more = 0u; /* MASU_DRAWS_* */
const bool masu_looks = (masu_draws_more & MASU_DRAWS_LOOKS) != 0u;
layout(location = 6) flat in vec4 in_tint;
layout(location = 7) flat in uvec2 in_fade;

/* Colour is what is lit; of an unlit surface, whose light it is, what it emits. */
void masu_tint(inout masu_surface s, vec3 color)
{
    s.emissive *= masu_is_unlit(s) ? color : vec3(1.0);
    s.albedo *= color;
}

void masu_take_look(inout masu_surface s)
{
    if (masu_looks) {
        masu_tint(s, in_tint.rgb);
        s.emissive *= in_tint.w;
    }
}

float masu_fade()
{
    return masu_looks ? float(in_fade.x) / MASU_FADE_STEPS : 0.0;
}

/* Whether the fade leaves a pixel out: by R2 (shared/dither.glsl), which is even at every scale. */
bool masu_faded(uvec2 at)
{
    uint noise = at.x * 0xC13FA9A9u + at.y * 0x91E10DA5u + in_fade.y * 0x9E3779B9u;
    return masu_looks && noise >> 8 < in_fade.x;
}
#endif

#endif

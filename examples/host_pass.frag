/*
 * host_pass.frag: one colour, multiplied by its alpha: linear radiance before the tone curve, an
 * encoded colour after it.
 */
#version 450

layout(push_constant) uniform Push
{
    layout(row_major) mat4 clip_from_world;
    vec4 corner, along, across;
    vec4 color;
} pc;

layout(location = 0) out vec4 out_color;

void main()
{
    out_color = pc.color;
}

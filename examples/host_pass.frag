/*
 * host_pass.frag: one colour: before the tone curve linear radiance, afterwards what is shown;
 * multiplied by its alpha.
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

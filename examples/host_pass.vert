/*
 * host_pass.vert: a parallelogram in the world: four corners as a strip, from a corner and two
 * edges. The matrix is given as masu_frame_view has it: row by row.
 */
#version 450

layout(push_constant) uniform Push
{
    layout(row_major) mat4 clip_from_world;
    vec4 corner, along, across;
    vec4 color;
} pc;

void main()
{
    vec4 at = pc.corner + float(gl_VertexIndex & 1) * pc.along +
              float(gl_VertexIndex >> 1) * pc.across;
    gl_Position = pc.clip_from_world * vec4(at.xyz, 1.0);
}

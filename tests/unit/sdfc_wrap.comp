#version 440
/* sdfc_wrap.comp: the minimal shader around the GLSL of masu-sdfc. For tests. */
#extension GL_GOOGLE_include_directive : require
#define MASU_SDF_SETUP 1
#include "shared/guard.glsl"
#include "shared/wide.glsl"
struct masu_surface { vec3 albedo; float roughness; vec3 emissive; float metallic; };
vec3 masu_normal = vec3(0.0, 1.0, 0.0);
layout(local_size_x = 64) in;
layout(set = 0, binding = 0, std430) buffer Slots { float slots[]; };
layout(set = 0, binding = 1, std430) buffer Params { float time; uint count; float params[256]; };
layout(set = 0, binding = 2, std430) readonly buffer Points { vec4 points[]; };
layout(set = 0, binding = 3, std430) buffer Result { vec4 result[]; };
float masu_param(int i) { return uint(i) < 256u ? params[i] : 0.0; }
float masu_time() { return time; }
float masu_anchor(int axis) { return 0.0; }
float masu_slot(uint i) { return slots[i]; }
void masu_slot_write(uint i, float v) { slots[i] = v; }
uint masu_part_count() { return count; }
uint masu_part_at(uint i) { return i; }
uint masu_part_bits(int word) { return 0xFFFFFFFFu; }
uint masu_first_place() { return 0u; }
uint masu_next_place(uint i) { return i + 1u; }
#include "sdf_scene.glsl"
void main() {
    if (gl_GlobalInvocationID.x == 0xFFFFFFFFu) masu_sdf_update();
    vec3 p = points[gl_GlobalInvocationID.x].xyz;
    masu_surface s = masu_surface(vec3(0.5), 0.5, vec3(0.0), 0.0);
    masu_sdf_surface(p, s);
    result[gl_GlobalInvocationID.x] = vec4(masu_sdf(p), float(masu_sdf_nearest(p)), s.albedo.x, masu_sdf_bounds(0u).w);
}

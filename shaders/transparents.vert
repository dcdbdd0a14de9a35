/*
 * transparents.vert: one transparent object. push.instances is its position in the buffer of drawn
 * instances, where src/frame/transparents.c writes six values for each frame: instance, material,
 * flags, layers of its maps and the detail (two values). With depth biases there is a seventh: the
 * factor on its depth. MASU_TEXTURES adds texture coordinates, MASU_ATTRIBUTES colours. If an
 * object is drawn twice, the first instance is for the sides that face away from the camera. With
 * `tints` (transparents.frag) objects that do not tint collapse to a point.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/transparents.h"
#include "shared/frame.h"
#include "shared/materials.h"
#include "shared/polygons.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_FRAME, std140) uniform Frame
{
    masu_frame_uniforms frame;
};

#ifdef MASU_TEXTURES
layout(location = 2) in vec2 texcoord;
layout(location = 3) out vec2 out_texcoord;
layout(location = 4) flat out vec2 out_detail;
#endif
#ifdef MASU_ATTRIBUTES
layout(location = 4) in vec4 color;
layout(location = 5) out vec4 out_color;
#endif

#define MASU_LOOK_OUT
#include "shared/look.glsl"

layout(constant_id = 0) const bool tints = false;
layout(constant_id = 12) const uint tinted_glass = 0u;

/* Meshes with and without textures share edges. */
invariant gl_Position;
layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec3 out_rel;
/* Material, flags, layers; instance index, with refraction the scale in the upper half. */
layout(location = 2) flat out uvec4 out_thing;

void main()
{
    uint id = drawn[push.instances];
    masu_instance_data m = instances[id];
    vec3 rel = masu_seen_from(m, frame.eye_hi.xyz, frame.eye_lo.xyz);
    out_normal = masu_turned_normal(m);
    out_rel = rel;
    masu_pass_look(id);
    out_thing = uvec4(drawn[push.instances + 1u], drawn[push.instances + 2u],
                      drawn[push.instances + 3u], uint(gl_InstanceIndex));
    if ((tinted_glass & MASU_TINTS_REFRACTED) != 0u) { /* thickness scale: RMS of directions */
        float squares = dot(m.row0.xyz, m.row0.xyz) + dot(m.row1.xyz, m.row1.xyz) +
                        dot(m.row2.xyz, m.row2.xyz);
        out_thing.w |= packHalf2x16(vec2(0.0, masu_sqrt(squares / 3.0)));
    }
#ifdef MASU_TEXTURES
    out_texcoord = masu_moved_texcoord(id, texcoord);
#ifdef MASU_ATTRIBUTES
    out_color = masu_vertex_color(color);
#endif
    out_detail = vec2(uintBitsToFloat(drawn[push.instances + 4u]),
                      uintBitsToFloat(drawn[push.instances + 5u]));
#endif
    gl_Position = frame.clip_from_rel * vec4(rel, 1.0);
    if (masu_depth_biases) {
        gl_Position.z *= uintBitsToFloat(drawn[push.instances + 6u]);
    }
    if (tints && (drawn[push.instances + 2u] & MASU_MAP_TINTED) == 0u) {
        gl_Position = vec4(2.0, 2.0, 0.0, 1.0);
    }
}

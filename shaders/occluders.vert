/*
 * occluders.vert: occluder boxes, for the atlas of occluder depth. An instance is a pair of an
 * occluder and a placed mesh. 18 vertices are the two triangles of each of three faces; back faces
 * are degenerate.
 *
 * The atlas may mark a texel as hidden only if all of its area is. Sampling its centre is not
 * enough, so each vertex passes the fragment shader data for a conservative test of the whole
 * texel: the lines of the box's outline (at most six), and the depth planes of the visible faces
 * (at most three). The outline is that of the whole box, not of a triangle or a face, so that no
 * texel is lost inside it.
 *
 * All values are homogeneous, (X, Y, W) = w * (texel x, texel y, 1): a line through two points is
 * their cross product even behind the camera, so clipping is not needed here. Every line and plane
 * has a bound of its rounding error: MASU_ROUND times the sum of the absolute terms.
 *
 * push.header: the header of src/frame/occlusion.c, push.view: the view.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#include "push/occluders.h"
#include "shared/culling.h"
#include "shared/materials.h"
#include "shared/globals.glsl"
#include "shared/culling.glsl"

layout(set = MASU_SET_GLOBAL, binding = MASU_BIND_INSTANCES, std430) readonly buffer Instances
{
    masu_instance_data instances[];
};

layout(location = 0) flat out vec4 out_lines[6];  /* inside: dot(xyz, (x, y, 1)) >= w */
layout(location = 6) flat out vec4 out_planes[3]; /* depth dot(xyz, (x, y, 1)), +- w in the texel */

#define MASU_ROUND 7.6e-6 /* 64 * 2^-23 */
#define MASU_NEVER vec4(0.0, 0.0, -1.0, 0.0)
#define MASU_ALWAYS vec4(0.0, 0.0, 1.0, 0.0)

vec3 abs_cross(vec3 a, vec3 b)
{
    return abs(a.yzx) * abs(b.zxy) + abs(a.zxy) * abs(b.yzx);
}

void main()
{
    uint view = push.view;
    uint at = masu_cull_view(view);
    mat4 clip = masu_cull_matrix(at + MASU_CULL_VIEW_CLIP);
    vec4 eye = masu_drawn_vec4(at + MASU_CULL_VIEW_EYE);
    vec4 atlas = masu_drawn_vec4(at + MASU_CULL_VIEW_ATLAS);
    float margin = 0.5 + masu_drawn_float(at + MASU_CULL_VIEW_MARGIN);
    float blind = masu_drawn_float(at + MASU_CULL_VIEW_BLIND);

    uint pairs = masu_cull_word(MASU_CULL_PAIRS) + 2u * view * masu_cull_word(MASU_CULL_PAIR_COUNT);
    uint occluder = drawn[pairs + 2u * uint(gl_InstanceIndex)];
    uint id = drawn[pairs + 2u * uint(gl_InstanceIndex) + 1u];
    vec3 low = masu_drawn_vec3(masu_cull_word(MASU_CULL_OCCLUDERS) + 6u * occluder);
    vec3 high = masu_drawn_vec3(masu_cull_word(MASU_CULL_OCCLUDERS) + 6u * occluder + 3u);

    /* Occluder box relative to the camera: its centre, and half of each edge. */
    masu_instance_data m = instances[id];
    vec3 middle = 0.5 * (low + high), size = 0.5 * (high - low);
    vec3 placed = vec3(m.row0.w, m.row1.w, m.row2.w);
    vec3 c = vec3(dot(m.row0.xyz, middle), dot(m.row1.xyz, middle), dot(m.row2.xyz, middle)) +
             ((placed - frame.eye_hi.xyz) - frame.eye_lo.xyz);
    vec3 axis[3];
    axis[0] = vec3(m.row0.x, m.row1.x, m.row2.x) * size.x;
    axis[1] = vec3(m.row0.y, m.row1.y, m.row2.y) * size.y;
    axis[2] = vec3(m.row0.z, m.row1.z, m.row2.z) * size.z;

    /* A mesh that the near plane intersects is not an occluder. */
    uint box = masu_cull_word(MASU_CULL_BOXES) + 6u * id;
    vec3 box_middle = (masu_drawn_vec3(box) - frame.eye_hi.xyz) - frame.eye_lo.xyz;
    vec3 beyond = max(abs(box_middle) - masu_drawn_vec3(box + 3u), vec3(0.0));
    bool good = blind < 0.0 || dot(beyond, beyond) > blind * blind;

    /* Texels: (x + w) / 2 * width + left * w, the same for y. */
    vec4 half_size = vec4(0.5 * atlas.zw, atlas.xy + 0.5 * atlas.zw);
    vec4 at_c = clip * vec4(c, 1.0);
    vec3 p = vec3(at_c.xy * half_size.xy + at_c.w * half_size.zw, at_c.w);
    vec3 p_abs = vec3(abs(at_c.xy) * half_size.xy + abs(at_c.w) * half_size.zw, abs(at_c.w));
    vec3 d[3], d_abs[3], normal[3];
    float z[3];
    int side[3];
    for (int i = 0; i < 3; i++) {
        vec4 v = clip * vec4(axis[i], 0.0);
        d[i] = vec3(v.xy * half_size.xy + v.w * half_size.zw, v.w);
        d_abs[i] = vec3(abs(v.xy) * half_size.xy + abs(v.w) * half_size.zw, abs(v.w));
        z[i] = v.z;
        vec3 n = cross(axis[(i + 1) % 3], axis[(i + 2) % 3]);
        n = dot(n, axis[i]) < 0.0 ? -n : n;
        normal[i] = n;
        float ahead = dot(n, eye.xyz - eye.w * (c + axis[i]));
        float behind = -dot(n, eye.xyz - eye.w * (c - axis[i]));
        side[i] = ahead > 0.0 ? 1 : behind > 0.0 ? -1 : 0;
    }

    /* The face at side s of axis i; j and k are the other two axes. */
    vec3 reach = vec3(atlas.xy + atlas.zw, 1.0); /* the largest texel coordinates */
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        vec3 f = p + float(side[i]) * d[i], f_abs = p_abs + d_abs[i];
        vec3 jk = cross(d[j], d[k]), kf = cross(d[k], f), fj = cross(f, d[j]);
        float det = dot(f, jk), det_abs = dot(f_abs, abs_cross(d_abs[j], d_abs[k]));
        float zf = at_c.z + float(side[i]) * z[i];
        vec3 plane = (zf * jk + z[j] * kf + z[k] * fj) / det;
        vec3 plane_abs = (abs(zf) * abs_cross(d_abs[j], d_abs[k]) +
                          abs(z[j]) * abs_cross(d_abs[k], f_abs) +
                          abs(z[k]) * abs_cross(f_abs, d_abs[j])) / abs(det);
        float loss = MASU_ROUND * det_abs / abs(det);
        float error = MASU_ROUND * dot(plane_abs, reach) + loss * dot(abs(plane), reach);
        bool seen = side[i] != 0;
        bool usable = loss < 0.25; /* else the face is edge-on */
        out_planes[i] = !seen     ? vec4(0.0, 0.0, 1e30, 0.0)
                        : !usable ? MASU_NEVER
                                  : vec4(plane, margin * (abs(plane.x) + abs(plane.y)) + error);
    }

    /* An edge along axis i is on the outline if exactly one of its two faces is visible. */
    for (int l = 0; l < 6; l++) {
        out_lines[l] = vec4(0.0, 0.0, 0.0, -1.0);
    }
    int lines = 0;
    for (int edge = 0; edge < 12; edge++) {
        int i = edge / 4, j = (i + 1) % 3, k = (i + 2) % 3;
        int sj = (edge & 1) * 2 - 1, sk = (edge & 2) - 1;
        if ((side[j] == sj) != (side[k] == sk)) {
            vec3 e = p + float(sj) * d[j] + float(sk) * d[k];
            vec3 e_abs = p_abs + d_abs[j] + d_abs[k];
            vec3 line = cross(e, d[i]), line_abs = abs_cross(e_abs, d_abs[i]);
            /* All of the box is on one side of the plane through the camera and the edge. */
            float where = dot(line, p);
            float unsure = MASU_ROUND * dot(line_abs, p_abs);
            line = where < 0.0 ? -line : line;
            vec4 whole = vec4(line, margin * (abs(line.x) + abs(line.y)) +
                                        MASU_ROUND * dot(line_abs, reach));
            if (lines < 6) {
                out_lines[lines] = abs(where) > unsure ? whole : vec4(0.0, 0.0, 0.0, 1.0);
            }
            lines++;
        }
    }

    int face = gl_VertexIndex / 6, corner = gl_VertexIndex % 6;
    int j = (face + 1) % 3, k = (face + 2) % 3;
    float along_j = corner == 1 || corner == 2 || corner == 4 ? 1.0 : -1.0;
    float along_k = corner == 2 || corner == 4 || corner == 5 ? 1.0 : -1.0;
    vec3 rel = c + float(side[face]) * axis[face] + along_j * axis[j] + along_k * axis[k];
    gl_Position = good && side[face] != 0 ? clip * vec4(rel, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}

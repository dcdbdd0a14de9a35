/*
 * occluders.frag: the farthest depth of an occluder over a whole texel, if the occluder covers all
 * of the texel. The front of a convex body is, at each point, the farthest of its planes.
 */
#version 440

layout(location = 0) flat in vec4 in_lines[6];
layout(location = 6) flat in vec4 in_planes[3];

void main()
{
    vec3 at = vec3(gl_FragCoord.xy, 1.0);
    bool whole = true;
    for (int i = 0; i < 6; i++) {
        whole = whole && dot(in_lines[i].xyz, at) >= in_lines[i].w;
    }
    float far = 1e30, near = 1e30;
    for (int i = 0; i < 3; i++) {
        float depth = dot(in_planes[i].xyz, at);
        far = min(far, depth - in_planes[i].w);
        near = min(near, depth + in_planes[i].w);
    }
    /* In front of the near plane the occluder is open. */
    whole = whole && far > 0.0 && near <= 1.0;
    if (!whole) {
        discard;
    }
    gl_FragDepth = far;
}

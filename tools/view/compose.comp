/* compose.comp: the image in the window of masu-view: A, A and B on both sides of a line, or a map
 * of their difference. One invocation per pixel. */
#version 440

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant) uniform Push
{
    ivec2 size;
    int split;   /* pixels to its right show B; size.x: no B */
    int map;     /* nonzero: show the map instead of A and B */
} push;

layout(set = 0, binding = 0, rgba8) uniform readonly image2D image_a;
layout(set = 0, binding = 1, rgba8) uniform readonly image2D image_b;
layout(set = 0, binding = 2, rgba8) uniform writeonly image2D shown;
layout(set = 0, binding = 3, std430) readonly buffer Map
{
    uint map[]; /* RGBA8; rows of size.x */
};

void main()
{
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, push.size))) {
        return;
    }
    int at = p.y * push.size.x + p.x;
    vec3 color;
    if (push.map != 0) {
        color = unpackUnorm4x8(map[at]).rgb;
    } else if (p.x < push.split) {
        color = imageLoad(image_a, p).rgb;
    } else {
        color = imageLoad(image_b, p).rgb;
    }
    imageStore(shown, p, vec4(color, 1.0));
}

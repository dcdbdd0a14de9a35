/*
 * roots.glsl: what tonemap.comp leaves for rung.temporal: roots of display light, 0 to 1, in the bits of A2B10G10R10_UNORM. Red
 * and blue have 10 bits; green, a step of which is seen soonest, has 12: the last two are alpha's. Who reads red, green and blue
 * alone has green cut off at 10. With deep_color they are halves, and alpha is 0.
 *
 * Rounded up or down by chance, another one in each frame: what is added up is light, and to the nearest step the mean of
 * a wall would lie as far off as each of its samples, up to a tenth of a step of 8 bits.
 */
#ifndef MASU_ROOTS_GLSL
#define MASU_ROOTS_GLSL

const float masu_root_rest = 3.0 / 4092.0; /* of alpha, as a sampler reads it: what green has beyond 10 bits */

/* root: 0 to 1; chance: 32 bits for each channel. */
uint masu_root_bits(vec3 root, uvec3 chance)
{
    vec3 up = vec3(chance >> 20) * (1.0 / 4096.0); /* of more bits 1023 and almost 1 would be 1024: red's would be green's */
#ifdef MASU_EXACT
    precise vec3 scaled = root * vec3(1023.0, 4092.0, 1023.0);
#else
    vec3 scaled = root * vec3(1023.0, 4092.0, 1023.0);
#endif
    uvec3 steps = uvec3(scaled + up);
    return steps.r | steps.g >> 2 << 10 | steps.b << 20 | steps.g << 30;
}

#endif

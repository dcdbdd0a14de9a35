/*
 * roots.glsl: the output of tonemap.comp for rung.temporal: square roots of display-linear colour,
 * 0 to 1, in the bits of A2B10G10R10_UNORM. Red and blue have 10 bits; green, whose steps are the
 * most visible, has 12: its last two are in alpha. Readers of only red, green and blue get green
 * cut off at 10 bits. With deep_color they are half floats, and alpha is 0.
 *
 * Rounded with dither that changes each frame: the accumulated values are averaged, and with
 * rounding to nearest the mean of a wall would have the same error as each of its samples, up to a
 * tenth of an 8-bit step.
 */
#ifndef MASU_ROOTS_GLSL
#define MASU_ROOTS_GLSL

const float masu_root_rest = 3.0 / 4092.0; /* alpha as a sampler reads it: the bits of green beyond
                                            * 10 */

/* root: 0 to 1; chance: 32 bits for each channel. */
uint masu_root_bits(vec3 root, uvec3 chance)
{
    vec3 up = vec3(chance >> 20) * (1.0 / 4096.0); /* with more bits 1023 and almost 1 would become
                                                    * 1024 and carry from red into green */
#ifdef MASU_EXACT
    precise vec3 scaled = root * vec3(1023.0, 4092.0, 1023.0);
#else
    vec3 scaled = root * vec3(1023.0, 4092.0, 1023.0);
#endif
    uvec3 steps = uvec3(scaled + up);
    return steps.r | steps.g >> 2 << 10 | steps.b << 20 | steps.g << 30;
}

#endif

/*
 * encode.glsl: encodes display-linear colour, white at 1, for the target of a scene. After
 * output.glsl with MASU_OUTPUT.
 */
#ifndef MASU_ENCODE_GLSL
#define MASU_ENCODE_GLSL

#include "shared/target.h"

vec3 masu_encoded(vec3 y, float white)
{
    if (masu_encoding == MASU_OUTPUT_SRGB) {
        return vec3(masu_srgb_encode(y.r), masu_srgb_encode(y.g), masu_srgb_encode(y.b));
    }
    vec3 nits = y * white;
    nits = masu_encoding == MASU_OUTPUT_PQ ? masu_bt2020(nits) : nits;
    return vec3(masu_pq_encode(nits.r), masu_pq_encode(nits.g), masu_pq_encode(nits.b));
}

/* masu_encoded() of light times peak, for a store that clamps: values below 0 or above 1 remain
 * outside. */
vec3 masu_encoded_open(vec3 y, float peak, float white)
{
    if (masu_encoding == MASU_OUTPUT_SRGB) {
        return vec3(masu_srgb_encode_open(y.r), masu_srgb_encode_open(y.g),
                    masu_srgb_encode_open(y.b));
    }
    return masu_encoded(y * peak, white);
}

#endif

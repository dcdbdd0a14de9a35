/*
 * update.comp: evaluates the slots of the SDF that depend on parameters or time once per frame,
 * instead of in each sample. Compiled by masu-bake together with the scene's field, only if there
 * are such slots. With MASU_MOTION it runs again as the pass update_previous, with the previous
 * frame's parameters and time. Copying the slots before they are overwritten would also work, but
 * would be state that crosses frames.
 *
 * Slots that depend only on the anchor (those of all static objects in a scene far from the origin)
 * are data and not code: 64 invocations share them.
 */
#version 440
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#define MASU_SDF_SETUP
#include "shared/wide.glsl"

#include "sdf/field.glsl"

#ifdef MASU_SDF_PLACES
#define INVOCATIONS 64
#else
#define INVOCATIONS 1
#endif
layout(local_size_x = INVOCATIONS) in;

void main()
{
#ifdef MASU_MOTION
    masu_before = true;
#endif
#ifdef MASU_SDF_PLACES
    for (int i = 0; i < (MASU_SDF_PLACES + INVOCATIONS - 1) / INVOCATIONS; i++) {
        uint place = uint(i * INVOCATIONS) + gl_LocalInvocationIndex;
        if (place < uint(MASU_SDF_PLACES)) {
            masu_sdf_place(place);
        }
    }
    if (gl_LocalInvocationIndex != 0u) {
        return;
    }
#endif
    masu_sdf_update();
}

/*
 * update.comp: slots of the SDF that depend on parameters or time, once per frame, so that no sample
 * of the field evaluates them again. Compiled by masu-bake together with the scene's field, and only
 * if there are such slots.
 */
#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shared/masu_shared.h"
#include "shared/counters.glsl"
#include "shared/globals.glsl"
#include "shared/pack.glsl"
#define MASU_SDF_SETUP

layout(local_size_x = 1) in;

#include "sdf/field.glsl"

void main()
{
    masu_sdf_update();
}

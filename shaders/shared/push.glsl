/*
 * push.glsl: the push constants of a pass: sizes, and where its row in src/plan/passes.inc tells it more, that:
 * whoever includes this says by MASU_PUSH which struct of tables.h it is.
 */
#ifndef MASU_PUSH_GLSL
#define MASU_PUSH_GLSL

#include "shared/masu_shared.h"

layout(push_constant) uniform Push
{
    masu_push pc;
#ifdef MASU_PUSH
    MASU_PUSH push;
#endif
};

#endif

/*
 * push.glsl: the push-constant block: `pc`, common to all passes, and `push`, of the pass itself. A
 * shader whose row in src/plan/passes.inc has PUSH(...) includes "push/NAME.h" first.
 */
#ifndef MASU_PUSH_GLSL
#define MASU_PUSH_GLSL

#include "shared/push.h"

layout(push_constant) uniform Push
{
    masu_push pc;
#ifdef MASU_PUSH
    MASU_PUSH push;
#endif
};

#endif

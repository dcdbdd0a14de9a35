/* floats.h: floats are computed as floats, and doubles as doubles. The coprocessor of old x86 computes both in
 * more digits and rounds where the compiler happens to store: tables come out wrong, and nothing is the same to
 * the bit on two machines. C alone: masu_shared.h includes it for the library and the generators. (16 is what
 * compilers call it where halves, too, are computed as halves.) */
#ifndef MASU_FLOATS_H
#define MASU_FLOATS_H

#include <float.h>

#if FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error "floats are computed in more digits than they have: on 32-bit x86 compile with -mfpmath=sse -msse2"
#endif

#endif

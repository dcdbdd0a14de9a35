/* floats.h: requires that floats are computed as floats, and doubles as doubles. The x87
 * coprocessor computes both with more digits and rounds at arbitrary stores: tables would be wrong,
 * and results would differ between machines. Only for C: masu_shared.h includes it for the library
 * and the generators. (16 is the value of compilers that also compute half floats as half
 * floats.) */
#ifndef MASU_FLOATS_H
#define MASU_FLOATS_H

#include <float.h>

#if FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16
#error "floats have excess precision: on 32-bit x86 compile with -mfpmath=sse -msse2"
#endif

#endif

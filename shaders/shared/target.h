/* target.h: encodings of the target, and flags of the pass that writes it (shared/output.glsl). */
#ifndef MASU_SHARED_TARGET_H
#define MASU_SHARED_TARGET_H

#define MASU_OUTPUT_SRGB 0u
#define MASU_OUTPUT_LINEAR 1u
#define MASU_OUTPUT_PQ 2u
#define MASU_OUTPUT_LAST 1u
#define MASU_OUTPUT_DITHER 2u
#define MASU_OUTPUT_SWAP 4u /* swaps red and blue */

#endif

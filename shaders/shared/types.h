/* types.h: types that C and GLSL share, and the constants that every pass needs.
 *
 * glslang defines VULKAN, C does not. The members of all shared structs have the size of a vec4,
 * uvec4 or mat4, so std140, std430 and C lay them out alike without scalarBlockLayout, which Vulkan
 * 1.1 does not have. tests/unit/test_shared_layout.c compares the offsets with the compiled SPIR-V.
 *
 * World space: right-handed, +Y up, metres. "rel" means camera-relative: world position minus
 * camera position. The camera position is split into two floats, so positions near the camera stay
 * precise in a world of a million units. */
#ifndef MASU_SHARED_TYPES_H
#define MASU_SHARED_TYPES_H

#ifdef VULKAN
#define masu_vec4 vec4
#define masu_uvec4 uvec4
#define masu_mat4 mat4
#define masu_uint uint
#else
#include "shared/floats.h"
#include <stdint.h>
typedef float masu_vec4[4];
typedef uint32_t masu_uvec4[4];
typedef uint32_t masu_uint;
typedef float masu_mat4[16]; /* column-major, as in GLSL */
#endif

/* Workgroup edge: 8x8 = 64 invocations, half of the smallest allowed
 * maxComputeWorkGroupInvocations. */
#define MASU_GROUP 8

/* Pixels along the edge of a screen tile: SDF term lists, light lists, reflections, SMAA. */
#define MASU_TILE 16
/* 32-bit values before the tile numbers in a buffer of tiles: 0..2 are the arguments of the
 * indirect dispatch (tiles, 1, 1). The numbers of the active tiles follow in no particular
 * order. */
#define MASU_TILES_HEADER 8

/* Descriptor sets. 0: the same for every pass; its bindings MASU_BIND_* (bindings.h) are derived
 * from the rows of src/plan/buffers.inc. 1: derived from the pass's row in src/plan/passes.inc.
 * 2, of gbuffer and the cascades: the textures of a draw, one binding per slot of a texture set
 * (src/scene/blob.h). That is 3 of the 4 sets, and at most 8 of the 16 sampled images of a stage,
 * that every device supports. */
#define MASU_SET_GLOBAL 0
#define MASU_SET_PASS 1
#define MASU_SET_TEXTURES 2

#include "bindings.h"

#endif

/* masu_shared.h: every struct and constant that C and GLSL both see.
 *
 * Included by the shaders (glslang defines VULKAN) and by src/. All members are vec4/uvec4/mat4
 * sized, so that std140, std430 and C agree without scalarBlockLayout, which is not in the Vulkan
 * 1.1 core; tests/unit/test_shared_layout.c checks the offsets against the compiled SPIR-V all the
 * same.
 *
 * World space: right-handed, +Y up, metres. "rel" means camera-relative: world position minus the
 * eye, computed from the eye split in two floats, so that a scene a million units from the origin
 * keeps its precision near the camera. */
#ifndef MASU_SHARED_H
#define MASU_SHARED_H

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
typedef float masu_mat4[16]; /* column-major, as GLSL stores it */
#endif

/* Workgroup edge. 8x8 = 64 invocations: half of the guaranteed maxComputeWorkGroupInvocations
 * (128). */
#define MASU_GROUP 8


/* Set 0, the same for every pass: MASU_BIND_* follow from the rows of src/plan/buffers.inc. Set 1 is derived
 * from the pass's row in src/plan/passes.inc. Set 2, of
 * gbuffer and the cascades: the textures of what is drawn, one binding per slot of blob.h's texture sets. With
 * three sets of the four that every device has, and 4 sampled images of 16 in a stage. */
#define MASU_SET_GLOBAL 0
#define MASU_SET_PASS 1
#define MASU_SET_TEXTURES 2

/* Directional albedos of the specular lobe (shaders/brdf/tables.glsl, tools/generate/make_split_sum.c). A table
 * has TABLE_SIZE nodes over sqrt(N.V) from 0 to 1, and TABLE_ROWS rows over perceptual roughness from
 * TABLE_SMOOTHEST to 1. In words, each two numbers of 16 bits from 0 to 1 unless said otherwise:
 *   TABLE_LOSS           what a white lobe loses, weight of (1 - h.v)^5
 *   TABLE_AVERAGE        of each row 2 floats: the averages of both
 *   TABLE_COAT           a white lobe times the larger (1 - N.w)^5 of both directions w, the same times
 *                        (1 - h.v)^5. From here on only scenes with clear coat have it
 *   TABLE_COAT_AVERAGE   of each row 4 floats: the averages of both; a and b of the coat */
#define MASU_TABLE_SIZE 64
#define MASU_TABLE_ROWS 256
#define MASU_TABLE_SMOOTHEST 0.045
#define MASU_TABLE_LOSS 0
#define MASU_TABLE_AVERAGE 16384
#define MASU_TABLE_COAT 16896
#define MASU_TABLE_COAT_AVERAGE 33280
#define MASU_TABLE_WORDS 16896 /* without coat */
#define MASU_TABLE_WORDS_ALL 34304

/* The tile of blue noise (shaders/noise/sequence.glsl, tools/generate/make_blue_noise.c): a square of words, row
 * after row. */
#define MASU_BLUE_NOISE_SIZE 64
#define MASU_BLUE_NOISE_WORDS 4096

/* The atlas of occluder depth: the camera's view, below it the sun's. */
#define MASU_ATLAS_WIDTH 256
#define MASU_ATLAS_HEIGHT 384
#define MASU_ATLAS_CAMERA_WIDTH 192
#define MASU_ATLAS_CAMERA_HEIGHT 128
#define MASU_ATLAS_SUN 256

/* Occlusion culling. The buffer of drawn instances begins with the lists of stage 1, MASU_CULL_LISTED
 * words for each view; behind them lies a header, whose words say where the rest is. */
#define MASU_CULL_CUT 0u         /* not 0: all are asked */
#define MASU_CULL_LISTED 1u      /* words of the lists of one view */
#define MASU_CULL_RECEIVERS 14u  /* of the words of what is seen, the first of receivers: */
#define MASU_RECEIVER_WORDS 65536u /* of each cascade, a word per texel of the sun's part */
#define MASU_CULL_VIEWS 2u       /* how many */
#define MASU_CULL_INSTANCES 3u   /* how many */
#define MASU_CULL_DRAWS 4u       /* how many of one view */
#define MASU_CULL_BATCH_COUNT 5u
#define MASU_CULL_LISTS 6u       /* lists of visible instances, as those of stage 1 */
#define MASU_CULL_KEPT 7u        /* of each view: how many stage 1 has kept, then all of them */
#define MASU_CULL_BATCHES 8u     /* of each: start of its list, first draw, draws, triangles */
#define MASU_CULL_LARGE 9u       /* numbers of batches with over 64 instances */
#define MASU_CULL_BOXES 10u      /* of each instance: middle and half extents, world */
#define MASU_CULL_OCCLUDERS 11u  /* of each: lower and upper corner, object space */
#define MASU_CULL_PAIRS 12u      /* of each view: occluder and instance */
#define MASU_CULL_PAIR_COUNT 13u /* most of one view */
#define MASU_CULL_HEADER 16u
/* Most primitives of a mesh, and most groups of 64 of its instances: bounds of loops. */
#define MASU_CULL_ROUNDS 4096
/* Then the numbers of each view: */
#define MASU_CULL_VIEW_CLIP 0u   /* mat4, from world relative to the eye */
#define MASU_CULL_VIEW_EYE 16u   /* vec4: (0, 0, 0, 1), or towards the sun and 0 */
#define MASU_CULL_VIEW_ATLAS 20u /* vec4: left, top, width, height */
#define MASU_CULL_VIEW_NEAR 24u  /* w of what is nearer than this cannot be divided by */
#define MASU_CULL_VIEW_MARGIN 25u /* texels that the raster may be off by */
#define MASU_CULL_VIEW_BLIND 26u /* meshes as near as this may be cut open by the near plane */
#define MASU_CULL_VIEW_BIAS 27u  /* depth by which the raster may have moved an occluder's mesh away */
#define MASU_CULL_VIEW_TURN 28u  /* frames that have drawn the view, modulo 5 */
#define MASU_CULL_VIEW_TRIMMED 29u /* not 0: what shadows nothing in the picture is left out */
#define MASU_CULL_VIEW_REACH 30u /* texels of the atlas that a shadow is looked up around a point */
#define MASU_CULL_VIEW_WORDS 32u

/* SDF tiles: TILE x TILE pixels share one list of parts. The tile buffer, in uints:
 *   0..2                  arguments of the indirect dispatch: active tiles, 1, 1
 *   TILES_HEADER + k      number of the k-th active tile, in no particular order
 *   TILES_HEADER + tiles  the lists, `stride` uints each: of a scene of at most TILE_MASKED_MAX parts
 *                         a bit for each part, else how many parts, then their numbers
 *   then                  of each 4x4 block of pixels, row by row, where its cone has stopped, a float, then what of the
 *                         field matters in each of BLOCK_SPANS pieces of its rays (shaders/sdf/spans.glsl): as many
 *                         words each as the scene says; nothing of a scene that is one whole
 * A list that would not fit says TILE_ALL: all parts then count. That is slower and just as right. */
#define MASU_TILE 16
#define MASU_TILES_HEADER 8
#define MASU_TILE_PARTS_MAX 63
#define MASU_TILE_MASKED_MAX 64
#define MASU_TILE_ALL 0xFFFFFFFFu
#define MASU_BLOCK_PIXELS 4
#define MASU_BLOCK_WORDS_MAX 2
#define MASU_BLOCK_SPANS 4
#define MASU_SDF_PARTS_MAX 4096

/* Punctual lights. Their tiles are those of the SDF, of MASU_TILE pixels; a list is one word that says
 * how many lights, or MASU_TILE_ALL where it would be longer, then their numbers, rising. */
#define MASU_LOCAL_LIGHTS_MAX 4096
#define MASU_TILE_LIGHTS_MAX 63

/* Tiles with pixels whose reflections are traced, in uints: 0..2 arguments of the indirect dispatch (tiles, 1, 1),
 * then from TILES_HEADER on the numbers of the tiles, in no particular order. */

/* SMAA (shaders/smaa): tiles of MASU_TILE pixels with an edge in or beside them, in uints:
 *   0..2                 arguments of the indirect dispatch: tiles, 1, 1
 *   TILES_HEADER + k     number of the k-th tile, in no particular order
 *   TILES_HEADER + tiles of every tile SMAA_WORDS: a word for each row of pixels, then for each column.
 *                        Bits 0..15 of a row: the edge above each pixel, 16..31 that to the left of
 *                        it; of a column the other way round
 * The table of areas (tools/generate/make_smaa_area.c), each texel two bytes: of straight edges 4x4 patterns, by the
 * code of the left end, then that of the right one; of each STRAIGHT rows (root of the distance to the
 * right) of STRAIGHT words, a texel and the one right of it; then of diagonals 4x4 patterns of DIAGONAL rows
 * of DIAGONAL texels, two to a word. */
#define MASU_SMAA_WORDS 32
#define MASU_SMAA_STRAIGHT 10
#define MASU_SMAA_STRAIGHT_WORDS 1600
#define MASU_SMAA_DIAGONAL 17
#define MASU_SMAA_AREA_WORDS 3912
/* Longest searches: twice as many pixels along an edge, as many along a diagonal. */
#define MASU_SMAA_STEPS_MAX 32
#define MASU_SMAA_DIAGONAL_STEPS_MAX 16

/* An SDF that reaches further than ANCHOR_FROM metres from the origin along an axis is compiled so
 * that its space can be anchored elsewhere; it is where the eye is that far out, at multiples of
 * ANCHOR_GRID. Below, fp32 resolves 0.5 mm or better. */
#define MASU_ANCHOR_FROM 4096
#define MASU_ANCHOR_GRID 64

/* Run-time SDF parameters: floats, packed four to a vec4. */
#define MASU_SDF_PARAM_VEC4S 64
#define MASU_SDF_PARAMS_MAX 256

/* Most sphere-tracing steps of one ray: the constant bound of the loop. A rung may ask for fewer.
 * */
#define MASU_MARCH_STEPS_MAX 2048
/* The same of a shadow ray. */
#define MASU_SHADOW_STEPS_MAX 128
/* And of a reflected one. */
#define MASU_REFLECTED_STEPS_MAX 256

/* Ambient occlusion in screen space: most slices of a texel, most samples on a side of one. */
#define MASU_AO_SLICES_MAX 8
#define MASU_AO_STEPS_MAX 16
/* No sample is farther away than this share of the picture's height. */
#define MASU_AO_REACH 0.25

/* Reflections: most neighbours of specular_reuse, of specular_filter; how far back a temporal accumulation may
 * reach, 1/60 s. */
#define MASU_REUSE_TAPS_MAX 16
#define MASU_FILTER_TAPS_MAX 32
#define MASU_SPECULAR_FRAMES_MAX 240

/* Rays through triangles: shaders/trace/bvh.glsl, src/scene/trace.h, src/scene/blob.h. All buffers are uvec4:
 *   static    header: first triangle, nodes, triangles, 0; from 1 on the nodes, NODE_UVEC4 each; triangles
 *   frame     header: first record, nodes, records, 0; from 1 on the nodes; records, RECORD_UVEC4 each
 *   vertices  as the blob has them: position, normal
 * The walk keeps a word for each level of the tree over instances and of one mesh's. A ray that has looked at
 * VISITS nodes hits nothing. */
#define MASU_TRACE_NODE_UVEC4 3
#define MASU_TRACE_RECORD_UVEC4 4
#define MASU_TRACE_TOP_DEPTH 20
#define MASU_SKIN_ROUNDS 4096 /* nodes of a skinned mesh's tree, at most 64 times as many: bound of a loop */
#define MASU_TRACE_LEVELS_MAX 28 /* of a mesh's tree: MASU_TRACE_DEPTH_MAX of blob.h */
#define MASU_TRACE_STACK 48
#define MASU_TRACE_VISITS 4096

/* Most cascades of the sun's shadow map. */
#define MASU_CASCADES_MAX 4
/* Share of a cascade's half width over which the next one takes over. */
#define MASU_CASCADE_BLEND 0.1
/* Surfaces are drawn into the shadow map farther from the sun by so many texels per texel of their
 * slope against it, steeper ones as if they had the steepest. */
#define MASU_SHADOW_BIAS 1.25
#define MASU_SHADOW_STEEPEST 4.0

/* Of a frame and the one before, for rung.temporal. */
#define MASU_TEMPORAL_MOVES 1u   /* the eye is elsewhere or looks elsewhere: what rests in the world moves in the picture */
#define MASU_TEMPORAL_CHANGES 2u /* something has changed of late, or the eye is elsewhere; the highest: it is asked for by >= */

/* Of a frame and the one before. */
#define MASU_HISTORY_CUT 1u     /* a cut: the exposure adapts at once */
#define MASU_HISTORY_NO_FINE 2u /* the previous frame has kept no full-resolution history: what is there is older */

/* Counters, uint32 pairs (low, high). Reset by each frame, read back by masu_stats. */
#define MASU_COUNTER_SDF_EVALS 0
#define MASU_COUNTER_SDF_HITS 1
#define MASU_COUNTER_SDF_UNCONVERGED 2
#define MASU_COUNTER_REPLACED 3
#define MASU_COUNTER_SHADOW_EVALS 4
#define MASU_COUNTER_OCCLUSION_EVALS 5
#define MASU_COUNTER_SHADOW_UNCONVERGED 6
#define MASU_COUNTER_OCCLUSION_TESTS 7
/* After occlusion culling, of each view: */
#define MASU_COUNTER_VISIBLE 8 /* instances, triangles */
/* Of punctual lights: pairs of light and pixel that were looked at, those where something arrives; tiles
 * that ask all lights. */
#define MASU_COUNTER_LIGHT_TESTS 18
#define MASU_COUNTER_LIGHT_SHADED 19
#define MASU_COUNTER_LIGHT_TILES_FULL 20
/* Of reflections: tiles that trace, rays, those that hit a polygon, the SDF, nodes visited. */
#define MASU_COUNTER_SPECULAR_TILES 21
#define MASU_COUNTER_SPECULAR_RAYS 22
#define MASU_COUNTER_SPECULAR_HITS 23
#define MASU_COUNTER_SPECULAR_SDF_HITS 24
#define MASU_COUNTER_SPECULAR_NODES 25
#define MASU_COUNTER_SPECULAR_EVALS 26
/* Of easu_fast: blocks of GROUP x GROUP pixels all of which left early. */
#define MASU_COUNTER_EASU_TILES_EARLY 27
/* Tiles that SMAA blends. */
#define MASU_COUNTER_SMAA_TILES 28
/* The metered exposure, a float. */
#define MASU_COUNTER_EXPOSURE 29
#define MASU_COUNTER_COUNT 30

/* The metered exposure: its buffer is EXPOSURE_HEADER words (0: factor before the tone curve; 1: log2 of
 * the metered part), then a word for each bin of luminance: how many pixels. A bin is an eighth of an
 * octave from 2^EXPOSURE_LOG2 on, along the bits of the float; what is darker is in none. */
#define MASU_EXPOSURE_HEADER 4
#define MASU_EXPOSURE_BINS 256
#define MASU_EXPOSURE_LOG2 (-16)
#define MASU_EXPOSURE_KEY 0.18 /* what the mean is brought to: a grey card */

/* Encodings of the target, and flags of the pass that writes it: shaders/shared/output.glsl. */
#define MASU_OUTPUT_SRGB 0u
#define MASU_OUTPUT_LINEAR 1u
#define MASU_OUTPUT_PQ 2u
#define MASU_OUTPUT_LAST 1u
#define MASU_OUTPUT_DITHER 2u
#define MASU_OUTPUT_SWAP 4u /* red and blue change places */

/* Particles, debug lines and decals of a frame, in one buffer of vec4:
 *   SPRITE_DISPATCH   arguments of the dispatch over the part of the picture that decals are in, as integers; w how many decals
 *   SPRITE_PLACE      xy first pixel of that part, as integers
 *   SPRITE_LINES      arguments of the lines' draw, as integers
 *   SPRITE_DRAWS + k  of the particles' draw before the k-th slot of what is blended, the last before none: six
 *                     vertices each
 *   then, where push constants say, of each particle: middle relative to the eye, m over which it is soft; half width
 *   and height, cosine and sine of its turn; colour, opacity; flags as an integer, edge, 0, 0
 *   of each line two: x and y in the picture, -1..1, depth, colour of 8 bits each and flags above, as an integer
 *   of each decal: three rows from relative to the eye into the box; colour, opacity; roughness, metallic, edge, flags as
 *   an integer; unit z axis, 0; first and last pixel that it may touch, 16 bits each, as integers, cosine of outer,
 *   1 / (cosine of inner - that) */
#define MASU_SPRITE_DISPATCH 0u
#define MASU_SPRITE_PLACE 1u
#define MASU_SPRITE_LINES 2u
#define MASU_SPRITE_DRAWS 3u
#define MASU_PARTICLE_VEC4S 4u
#define MASU_LINE_VEC4S 2u
#define MASU_DECAL_VEC4S 7u
#define MASU_PARTICLES_MAX 65536
#define MASU_LINES_MAX 65536
#define MASU_DECALS_MAX 1024
/* Flags, those of masu.h. */
#define MASU_SPRITE_LIT 1u
#define MASU_SPRITE_ADDITIVE 2u
#define MASU_SPRITE_ROUND 1u
#define MASU_SPRITE_KEEP_COLOR 2u
#define MASU_SPRITE_ON_TOP 1u

/* Rows of the analytic sky's table. Row r is the view whose sine of elevation is t |t|, with t from
 * -1 (down) to 1 (up); no row is the horizon itself, half of them lie above it. */
#define MASU_SKY_ROWS 48
/* Of each row: a term without direction, one with Rayleigh's phase function, one with the
 * aerosol's, each a polynomial of the cosine of the azimuth from the sun. */
#define MASU_SKY_TERMS 3
#define MASU_SKY_ROW 9
/* Cosines of the azimuth, from -1 to 1, at which the horizon's terms are tabled. */
#define MASU_SKY_AZIMUTHS 33
/* Sines of elevation and cosines of azimuth, both from -1 to 1, at which the sky is tabled as a surface of roughness
 * 0.4 mirrors it. */
#define MASU_SKY_ROUGH_ROWS 16
#define MASU_SKY_ROUGH_AZIMUTHS 9
/* Of the lobe that stands for the aureole in the sky's irradiance: src/frame/sky.c. */
#define MASU_SKY_ROUND (1.0f / 3.0f)

/* What pick_tell leaves for the host: what it is, number of the instance, depth (near / view z), xyz from the eye. */
#define MASU_PICKED_SKY 1u
#define MASU_PICKED_SDF 2u
#define MASU_PICKED_INSTANCE 3u
#define MASU_PICKED_WORDS 6
#define MASU_PICK_BLENDED 0x80000000u /* in PICK_ID */

/* G-buffer material flags: two bits of the packed normal word. */
#define MASU_SURFACE_EMISSIVE 1u
#define MASU_SURFACE_MORE 2u /* the surface image holds the rest of it */

/* Flags of a material with textures; src/scene/blob.h has them too. */
#define MASU_MAP_BASE 1u
#define MASU_MAP_NORMAL 2u
#define MASU_MAP_SURFACE 4u
#define MASU_MAP_EMISSIVE 8u
#define MASU_MAP_OCCLUSION 16u
#define MASU_MAP_COAT 32u
#define MASU_MAP_ADDITIVE 0x10000u
#define MASU_MAP_FAR_SIDE_FIRST 0x20000u /* of a blended thing that is drawn twice */
#define MASU_MAP_SINGLE 0x40000u /* not seen from behind */
#define MASU_MAP_METAL 0x80000u
#define MASU_MAP_TINTED 0x100000u /* what shines through has the base colour */
#define MASU_MAP_COAT_SMOOTH 0x200000u
#define MASU_MAP_BASE_SMOOTH 0x400000u
#define MASU_MAP_CUTOFF_SHIFT 8
#define MASU_MAP_OCCLUSION_SHIFT 24 /* 8 bits: the layer of the occlusion map */

struct masu_frame_uniforms {
    masu_mat4 clip_from_rel; /* rel position -> clip; reverse-Z, no far plane, depth = near / view z */
    masu_vec4 eye_hi;        /* xyz eye rounded to float; w time, seconds */
    masu_vec4 eye_lo;        /* xyz eye minus eye_hi; w time step, seconds */
    masu_vec4 right;         /* xyz camera right times tan(fov_x / 2); w tan(fov_x / 2) */
    masu_vec4 up;            /* xyz camera up times tan(fov_y / 2); w tan(fov_y / 2) */
    masu_vec4 forward;       /* xyz unit view direction; w near distance */
    masu_vec4 sun_direction; /* xyz unit vector towards the sun; w exposure (linear factor) */
    masu_vec4 sun_color;     /* rgb irradiance of the sun on a facing surface / pi; w unused */
    masu_vec4 ambient;       /* rgb radiance of the ambient light, its mean where it is a sky's */
    masu_vec4 sky_zenith;    /* rgb radiance straight up; w texels along an edge of a sky's picture */
    masu_vec4 sky_horizon;   /* rgb radiance at the horizon and below; w mips of that picture */
    /* Irradiance / pi of the ambient light by the normal: shaders/light/ambient.glsl. */
    masu_vec4 irradiance[9];
    masu_vec4 fog;           /* rgb radiance of thick fog; w its density at its height, 1/m */
    masu_vec4 air;           /* x height of the eye over the fog's; y 1/m by which it thins out upwards; z
                                where it begins; w not 0: its colour is its own, else the sky's */
    /* The SDF's space: world minus the anchor, which is zero or a point near the eye that stays the
     * same while the eye moves by less than MASU_ANCHOR_GRID. */
    masu_vec4 anchor;        /* xyz; w unused */
    masu_vec4 sdf_eye_hi;    /* xyz eye minus anchor, rounded to float; w unused */
    masu_vec4 sdf_eye_lo;    /* xyz the rest; w unused */
    masu_vec4 sdf_min;       /* xyz lower corner of the SDF's bounds, in its space; w 1 / Lipschitz
                                constant */
    masu_vec4 sdf_max;       /* xyz upper corner; w longest ray, world units */
    masu_vec4 sdf_low;       /* xyz both corners minus the eye, for rays that begin there; w unused */
    masu_vec4 sdf_high;
    /* x number of the frame, modulo 2^32; y and z render size of the previous frame, 0: nothing of it counts;
     * w bits of MASU_HISTORY_* */
    masu_uvec4 history;
    /* xyz anchor that traced geometry is relative to; w longest ray */
    masu_vec4 trace_anchor;
    masu_vec4 trace_eye; /* xyz eye minus that anchor; w unused */
    /* What is added to a place in the picture, whose sides are -1 and 1: xy by jitter and by a window whose middle
     * is not straight ahead, zw by jitter alone */
    masu_vec4 jitter;
    /* Of rung.temporal: x and y render size of the previous frame, 0: it has left nothing; z bits of
     * MASU_TEMPORAL_*; w the pixel to be picked: its x, and its y from bit 16 on */
    masu_uvec4 temporal;
    masu_vec4 sdf_params[MASU_SDF_PARAM_VEC4S];
    /* Of rung.temporal, in pixels of the render size: xy by how much this frame's samples lie off the middle of pixels; zw
     * what is added to a velocity to take out of it what the jitter of the two frames differs by. Behind what the shaders of
     * scenes read: they are baked. */
    masu_vec4 shifts;
    /* The same to twice the size, where each four texels have four pixels of the output between them, 2x2. Of the first four
     * texels: xy coordinates of their first pixel, and 2: 1 or 2; zw those of the upper left texel, as int: -3 to 0. */
    masu_uvec4 between;
    /* Of the left and right pixel between texels, and of the upper and lower one: x how far after the texel before it lies; y what
     * the nearer texel counts for it at rest; z and w what the one before and the one after count in motion. */
    masu_vec4 columns[2];
    masu_vec4 rows[2];
};

/* One placed mesh: rows of the 3x4 matrix from object to world space. */
struct masu_instance_data {
    masu_vec4 row0;
    masu_vec4 row1;
    masu_vec4 row2;
};

/* The analytic sky (src/frame/sky.c), read by shaders/light/sky.glsl. Radiance of a term is 2 to the power of
 * (c0 + c1 x + c2 x^2), x being the cosine of the azimuth from the sun: it is never negative. */
struct masu_sky_uniforms {
    masu_vec4 sun;  /* xyz unit vector towards the sun; w asymmetry of the aerosol's phase function */
    masu_vec4 disc; /* rgb radiance of the sun's disc as drawn; w unused */
    masu_vec4 azimuth; /* xy: x and z of the unit vector to below the sun; w not 0: this is the sky */
    masu_vec4 rows[MASU_SKY_ROWS * MASU_SKY_ROW]; /* rgb log2 of radiance; w unused */
    masu_vec4 horizon[MASU_SKY_AZIMUTHS * MASU_SKY_TERMS]; /* rgb radiance, term by term of a cosine; w unused */
    masu_vec4 rough[MASU_SKY_ROUGH_ROWS * MASU_SKY_ROUGH_AZIMUTHS]; /* rgb radiance, row by row; w unused */
};

/* A point or spot of this frame, relative to its eye; shaders/light/lights.glsl says how it lights. */
struct masu_punctual_light_data {
    masu_vec4 position; /* xyz; w 1 / range^2 */
    masu_vec4 color;    /* rgb radiant intensity / pi; w least squared distance */
    /* xyz unit vector along the middle of a spot, away from it; w 1 - cos(outer). Points: 0 0 0 4 */
    masu_vec4 axis;
    masu_vec4 cone;  /* x 1 / (cos(inner) - cos(outer)), points 1; yz sine and cosine of outer, points 0 */
    masu_vec4 bound; /* sphere around all that it lights: xyz, w radius, with room for rounding */
};

/* The sun's shadow map; an element of each array is a cascade as it was drawn, maybe some frames
 * ago: an orthographic box along the sun's direction. A point p has the coordinates row.xyz . (p -
 * origin), x and y in -1..1, and the depth row2.xyz . (p - origin) + rect.w, which is 1 nearest to
 * the sun and 0 farthest from it. The w of the rows serves points relative to the present eye:
 * row.xyz . rel + row.w. */
struct masu_shadow_uniforms {
    masu_vec4 row0[MASU_CASCADES_MAX];
    masu_vec4 row1[MASU_CASCADES_MAX];
    masu_vec4 row2[MASU_CASCADES_MAX];      /* w includes rect.w */
    masu_vec4 origin_hi[MASU_CASCADES_MAX]; /* xyz origin rounded to float; w a texel's width, m */
    masu_vec4 origin_lo[MASU_CASCADES_MAX]; /* xyz origin minus origin_hi; w depth of a metre */
    masu_vec4 rect[MASU_CASCADES_MAX]; /* xy first texel, z texels of an edge, w origin's depth */
    /* x cascades; y view depth from which they fade, z 1 / the depth over which they do; w not 0:
     * the occlusion image holds what the SDF leaves of the sun */
    masu_vec4 reach;
};

struct masu_material_data {
    masu_vec4 base_color; /* rgb linear albedo; w perceptual roughness 0..1 */
    masu_vec4 emissive;   /* rgb linear radiance, all zero: not emissive; w metallic 0..1 */
    masu_vec4 more;       /* specular, coat, coat_roughness, opacity: each 0..1 */
};

/* What rays know of a material. */
#define MASU_TRACE_NONE 0xFFFFFFFFu
#define MASU_TRACE_HOLES 0x80000000u /* in the word of a triangle's material: it may have holes, */
#define MASU_TRACE_SINGLE 0x40000000u /* it is not hit from behind */
#define MASU_TRACE_MATERIAL 0x3FFFFFFFu
#define MASU_TRACE_NOISE_WORDS 4096u
struct masu_trace_material {
    masu_vec4 base_color; /* as in masu_material_data: rgb; w roughness */
    masu_vec4 emissive;   /* rgb; w metallic */
    masu_vec4 more;       /* specular, coat, coat_roughness, opacity */
    /* x picture of the base colour, y of what shines, or TRACE_NONE; z flags of the material; w wrap along u
     * and v: 2 bits each, of blob.h's texture sets */
    masu_uvec4 maps;
};

/* Push constants of every pass. 48 bytes of the guaranteed 128. */
/* A grid of light probes, the head of their buffer; src/scene/blob.h has the same as masu_blob_probes. Then
 * words: what the blob has of each probe, then of each the light of the frame. */
#define MASU_PROBE_SUNS 16
#define MASU_PROBE_SETS 26
#define MASU_PROBE_SET_WORDS 14u
/* The light of the frame at a probe: the first coefficient as halfs, r g, b and how far the probe is to
 * be believed; then a word for each other one, 10 bits signed for r, g and b, in units of the first
 * times the most that light can have of it, over 511. Half as many loads as halfs for all, and integers
 * unpack in a third of the time where halfs have no instruction. The last two are padding: three loads
 * of four words. They begin at a multiple of four words. */
#define MASU_PROBE_LIT_WORDS 12u
#define MASU_PROBE_MOST_1 1.25  /* a light from one direction has 1.155 in band 1 */
#define MASU_PROBE_MOST_2 0.625 /* and 0.559 in band 2 */
struct masu_probe_grid {
    masu_vec4 origin;  /* xyz of the first probe; w metres that points are lifted along normals */
    masu_vec4 spacing; /* xyz */
    masu_uvec4 counts; /* xyz; w sets of the sky */
    masu_uvec4 more;   /* x suns, y 1: a set of emission, z texels along the edge of a map */
    masu_vec4 sun_direction[MASU_PROBE_SUNS];
    masu_vec4 sun_inverse[4 * MASU_PROBE_SUNS]; /* rows of 16 */
};

/* What every pass is told; behind it lies the struct of its own, which follows from its row in
 * src/plan/passes.inc. */
struct masu_push {
    masu_uint render_width; /* valid sub-rectangle of the pass's input images, texels from (0,0) */
    masu_uint render_height;
    masu_uint output_width; /* what the pass writes, texels from (0,0) */
    masu_uint output_height;
    masu_uint output_steps; /* of what writes the target: its steps, 10 bits each of red, green, blue; 0: as it is */
    masu_uint output_flags; /* MASU_OUTPUT_* of the pass that comes last in its rung, else 0 */
};

#include "tables.h"

#endif

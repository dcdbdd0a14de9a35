/* culling.h: occluder atlas and the buffer of occlusion culling. */
#ifndef MASU_SHARED_CULLING_H
#define MASU_SHARED_CULLING_H

/* The occluder depth atlas: the camera's view, and the sun's view below it. */
#define MASU_ATLAS_WIDTH 256
#define MASU_ATLAS_HEIGHT 384
#define MASU_ATLAS_CAMERA_WIDTH 192
#define MASU_ATLAS_CAMERA_HEIGHT 128
#define MASU_ATLAS_SUN 256

/* The buffer DRAWN of occlusion culling, in 32-bit values:
 *
 *   | instance lists of the frustum test, MASU_CULL_LISTED per view | header | the rest |
 *
 * The header holds counts, and the offsets of the arrays behind it. */
#define MASU_CULL_CUT 0u         /* not 0: tests every instance in this frame */
#define MASU_CULL_LISTED 1u      /* size of the lists of one view */
#define MASU_CULL_RECEIVERS 14u  /* offset in the visibility buffer: receiver masks, */
#define MASU_RECEIVER_WORDS 65536u /* one value per texel of the sun's part, per cascade */
#define MASU_CULL_VIEWS 2u       /* number of views */
#define MASU_CULL_INSTANCES 3u   /* number of instances */
#define MASU_CULL_DRAWS 4u       /* number of draws per view */
#define MASU_CULL_BATCH_COUNT 5u
#define MASU_CULL_LISTS 6u       /* lists of visible instances, as those of the frustum test */
#define MASU_CULL_KEPT 7u        /* per view: count of instances in the frustum, then instances */
#define MASU_CULL_BATCHES 8u     /* per batch: start of its list, first draw, draws, triangles */
#define MASU_CULL_LARGE 9u       /* numbers of the batches with more than 64 instances */
#define MASU_CULL_BOXES 10u      /* per instance: centre and half extents, world space */
#define MASU_CULL_OCCLUDERS 11u  /* per occluder: lower and upper corner, object space */
#define MASU_CULL_PAIRS 12u      /* per view: (occluder, instance) */
#define MASU_CULL_PAIR_COUNT 13u /* capacity per view */
#define MASU_CULL_HEADER 16u

/* Loop bounds: primitives of a mesh, and groups of 64 instances of a mesh. */
#define MASU_CULL_ROUNDS 4096

/* Members of a view, after the header: */
#define MASU_CULL_VIEW_CLIP 0u   /* mat4: camera-relative position -> clip space */
#define MASU_CULL_VIEW_EYE 16u   /* vec4: (0, 0, 0, 1), or (direction towards the sun, 0) */
#define MASU_CULL_VIEW_ATLAS 20u /* vec4: left, top, width, height */
#define MASU_CULL_VIEW_NEAR 24u  /* smallest clip-space w that may be divided by */
#define MASU_CULL_VIEW_MARGIN 25u /* texels: largest error of the rasterizer */
#define MASU_CULL_VIEW_BLIND 26u /* within this depth a mesh may be clipped by the near plane */
#define MASU_CULL_VIEW_BIAS 27u  /* depth by which the rasterizer may have moved an occluder */
#define MASU_CULL_VIEW_TURN 28u  /* frames that have drawn the view, modulo 5 */
#define MASU_CULL_VIEW_TRIMMED 29u /* not 0: culls casters that shadow no visible receiver */
#define MASU_CULL_VIEW_REACH 30u /* atlas texels: radius of a shadow lookup around a point */
#define MASU_CULL_VIEW_WORDS 32u

#endif

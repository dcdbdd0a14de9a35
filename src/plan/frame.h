/* frame.h: what a row of the frame table is. The table itself is in frame.c.
 *
 * A row names its images in order; barriers, layouts, descriptor bindings, image usage flags,
 * lifetimes, memory aliasing, labels, timestamps and the printed plan are all derived from it
 * (plan.c, record.c). The reads of a compute row become combined image samplers at bindings 0..R-1
 * of set 1, its writes storage images at R..R+W-1, in the row's order. */
#ifndef MASU_FRAME_H
#define MASU_FRAME_H

#include "scene/blob.h"
#include "masu.h"
#include "shared/masu_shared.h"

typedef enum masu_image_id {
    MASU_IMAGE_NONE = 0,
    MASU_IMAGE_ALBEDO,      /* sqrt of linear albedo; roughness */
    MASU_IMAGE_NORMAL,      /* packed octahedral normal, metallic, flags */
    MASU_IMAGE_DEPTH,       /* raster depth, reverse-Z */
    MASU_IMAGE_SCENE_DEPTH, /* the nearer of raster and SDF, same encoding */
    MASU_IMAGE_OCCLUDERS,   /* depth of occluders, the farthest of each texel */
    MASU_IMAGE_CONE8,       /* free distance along the rays of each 8x8 block */
    MASU_IMAGE_CONE4,       /* the same of each 4x4 block */
    MASU_IMAGE_SURFACE,     /* specular, coat, what small relief leaves; see pack.glsl */
    MASU_IMAGE_VELOCITY,    /* where the surface was in the frame before */
    MASU_IMAGE_SHADOW_MAP,  /* depth along the sun, the cascades side by side */
    MASU_IMAGE_AO,          /* seen part of the ambient light at half size, and depth: ao_texel.glsl */
    MASU_IMAGE_OCCLUSION,   /* 2 x 16 bit unorm: seen part of the sun, of the ambient light */
    MASU_IMAGE_SPECULAR_GUIDE,   /* of reflections, at half size: which pixel, its normal, depth */
    MASU_IMAGE_SPECULAR_RAY,     /* direction, density */
    MASU_IMAGE_SPECULAR_HIT,     /* what the ray meets */
    MASU_IMAGE_SPECULAR_LIGHT,   /* radiance along it, distance */
    MASU_IMAGE_SPECULAR_MOTION,  /* of what is seen in the mirror, pixels */
    MASU_IMAGE_SPECULAR_REUSED,  /* the same, with the neighbours' rays */
    MASU_IMAGE_SPECULAR_MEAN,    /* over frames: radiance, mean square of its luma */
    MASU_IMAGE_SPECULAR_AGE,     /* how many frames, distance, motion of what is seen: filter.glsl */
    MASU_IMAGE_SPECULAR_FINE,    /* of each of the 2x2 pixels: radiance over frames, smooth surfaces */
    MASU_IMAGE_SPECULAR_SMOOTH,  /* over neighbours: radiance */
    MASU_IMAGE_SPECULAR_STEADY,  /* what is shown: radiance */
    MASU_IMAGE_SPECULAR_OLD_GUIDE, /* as the frame before has left them */
    MASU_IMAGE_SPECULAR_OLD_MEAN,
    MASU_IMAGE_SPECULAR_OLD_AGE,
    MASU_IMAGE_SPECULAR_OLD_STEADY,
    MASU_IMAGE_SPECULAR_OLD_FINE,
    MASU_IMAGE_SPECULAR_SUM,     /* over frames, for comparison: radiance times weight, frames */
    MASU_IMAGE_HDR,         /* linear radiance */
    MASU_IMAGE_LDR,         /* display-encoded colour, render size */
    MASU_IMAGE_SMOOTH,      /* the same or the host's input, anti-aliased */
    MASU_IMAGE_UPSCALED,    /* display-encoded colour, output size */
    MASU_IMAGE_FINAL,       /* what a blit takes to a target that is no storage image */
    MASU_IMAGE_SOURCE,      /* the host's input, upscaling only */
    MASU_IMAGE_TARGET,      /* the host's output */
    MASU_IMAGE_COUNT,
    MASU_RESOURCE_TILES, /* not images: buffers of set 0, in rows for their barriers alone */
    MASU_RESOURCE_SLOTS,
    MASU_RESOURCE_SEEN,
    MASU_RESOURCE_DRAWS,
    MASU_RESOURCE_PROBES,
    MASU_RESOURCE_LIGHT_TILES,
    MASU_RESOURCE_SPECULAR_TILES,
    MASU_RESOURCE_TOP_LEVEL, /* of ray queries */
    MASU_RESOURCE_SMAA_TILES,
    MASU_RESOURCE_EXPOSURE,
    MASU_RESOURCE_END,
    /* Stand-ins that plan.c resolves per rung: the image of that class that the latest active row
     * has written. */
    MASU_LATEST_DEPTH = 64,
    MASU_LATEST_COLOR,
    MASU_LATEST_SPECULAR,
    MASU_UNSMOOTHED /* ldr, without a scene source */
} masu_image_id;

typedef enum masu_image_class {
    MASU_CLASS_OTHER,
    MASU_CLASS_DEPTH,
    MASU_CLASS_COLOR,
    MASU_CLASS_SPECULAR,
    MASU_CLASS_COUNT
} masu_image_class;
/* Render and output size, and one texel per block of 8x8 or 4x4 render pixels. */
typedef enum masu_image_extent {
    MASU_EXTENT_RENDER,
    MASU_EXTENT_OUTPUT,
    MASU_EXTENT_HALF, /* a texel per 2x2 render pixels */
    MASU_EXTENT_TRACED, /* the same, for reflections; per pixel with debug.reference */
    MASU_EXTENT_BLOCK8,
    MASU_EXTENT_BLOCK4,
    MASU_EXTENT_TILE,  /* one workgroup per tile of 16x16 */
    MASU_EXTENT_TILES, /* the same, for active tiles only: indirect */
    MASU_EXTENT_EDGED, /* one workgroup per tile of SMAA_TILES: indirect */
    MASU_EXTENT_GLOSSY, /* one workgroup per tile of SPECULAR_TILES, 8x8 texels of TRACED: indirect */
    MASU_EXTENT_ONE,   /* one workgroup */
    MASU_EXTENT_ATLAS, /* of occluders */
    MASU_EXTENT_KEPT,    /* an invocation per instance and view */
    MASU_EXTENT_BATCHES, /* see compact.comp */
    MASU_EXTENT_PROBES,  /* an invocation per light probe */
    MASU_EXTENT_SHADOW   /* all cascades of the shadow map; plan.c knows how large */
} masu_image_extent;

typedef struct masu_image_row {
    const char *name;
    VkFormat format;
    masu_image_extent extent;
    masu_image_class class_of;
    uint32_t readback; /* masu_readback_bits that asks for it */
    int kept;          /* the next frame reads what this one has left in it */
} masu_image_row;

typedef enum masu_usage {
    MASU_USE_NONE = 0,
    MASU_READ,        /* sampled */
    MASU_READ_BUFFER, /* storage buffer, or arguments of the row's indirect dispatch */
    MASU_READ_COPY,   /* transfer source */
    MASU_READ_STRUCTURE, /* of ray queries: binding of set 0 */
    MASU_WRITE,       /* storage, whole sub-rectangle, earlier content is lost */
    MASU_UPDATE,      /* storage, some texels, the rest is kept */
    MASU_WRITE_COLOR, /* colour attachment, cleared first */
    MASU_BLEND_COLOR, /* the same of which earlier content is kept, and blended with */
    MASU_WRITE_DEPTH, /* depth attachment, cleared to 0 (far) first */
    MASU_UPDATE_DEPTH, /* the same of a part of the image, the rest is kept */
    MASU_WRITE_BUFFER, /* storage buffer */
    MASU_WRITE_COPY,   /* transfer destination */
    MASU_WRITE_STRUCTURE /* built by the device, for ray queries */
} masu_usage;

typedef enum masu_pass_kind {
    MASU_PASS_GRAPHICS,
    MASU_PASS_COMPUTE,
    MASU_PASS_TRANSFER,
    MASU_PASS_BUILD /* of a structure for ray queries: src/device/ray_query.c */
} masu_pass_kind;

#define MASU_PASS_ACCESSES 12u

typedef struct masu_access {
    uint8_t image; /* masu_image_id or a stand-in */
    uint8_t usage; /* masu_usage */
} masu_access;

/* What the scene and the description need, computed once; the `decide` of each row looks at nothing
 * else. */
typedef struct masu_needs {
    int scene;         /* a scene is drawn (else: upscaling of a source image) */
    int raster;        /* it has instances */
    int sdf;           /* it has an SDF */
    uint32_t readback; /* masu_readback_bits */
    int blit;          /* targets are filled by a blit */
    int dynamic;       /* slots of the SDF depend on parameters or time */
    int anchored;      /* and on where the eye is: the SDF reaches far from the origin */
    int occluders;     /* the scene has some */
    int unculled;      /* and a mesh of too many primitives or instances for culling by them */
    int surface;       /* some material has more than the four numbers of albedo and normal image */
    int environment;   /* the sky is from a picture */
    int sky;           /* the sky may follow from the sun */
    int velocity;      /* something reads velocities: the frame before is kept */
    int sdf_occlusion; /* the SDF casts shadows or occludes ambient light */
    int probes;        /* it has light probes */
    int lights;        /* there are points and spots */
    int shadow;        /* polygons cast shadows of the sun: there is a shadow map */
    int transparents;  /* something is blended */
    int reflections;   /* a rung traces some */
    int traced;        /* there are polygons to trace */
    int traced_sdf;    /* there is an SDF to trace */
    int query;         /* polygons are found by ray queries of the device */
    int steady;        /* a rung has taa, */
    int finest;        /* fine */
    int smoothing;     /* smaa */
    int metered;       /* the exposure follows the picture */
    /* of one rung: */
    int upscale, sharpen, occlusion;
    int fxaa, smaa; /* at most one of them */
    int fused;     /* upscale and sharpen in one pass */
    int ao;        /* ambient occlusion in screen space */
    int casters;   /* occlusion, of a view of the sun too */
    int receivers; /* and of cascades that every frame draws anew */
    int light_tiles; /* lights are sorted into tiles */
    int specular;    /* reflections are traced */
    int reuse, temporal, fine, filter, taa; /* what is done to them */
    int accumulate;  /* for comparison: of all pixels, summed up over frames, unfiltered */
    masu_march march;
    masu_easu easu; /* never AUTO */
    uint32_t cascades; /* of the shadow map */
} masu_needs;

typedef struct masu_pass_row {
    const char *name; /* also the shader's file name; cascade_N are all of cascade.vert */
    const char *purpose;
    masu_pass_kind kind;
    masu_image_extent extent; /* size of the dispatch */
    /* Returns whether the pass runs, and why, in a few words. */
    int (*decide)(const masu_needs *needs, const char **why);
    /* Pass-specific push constants of a rung; NULL: none. */
    void (*params)(const masu_rung *rung, struct masu_push *push);
    masu_access access[MASU_PASS_ACCESSES];
    uint32_t code; /* masu_blob_kind of the scene's own SPIR-V; 0: the library's */
} masu_pass_row;

typedef enum masu_pass_id {
    MASU_PASS_OCCLUDERS,
    MASU_PASS_CULL,
    MASU_PASS_COMPACT,
    MASU_PASS_GBUFFER,
    MASU_PASS_UPDATE,
    MASU_PASS_UPDATE_PREVIOUS,
    MASU_PASS_CLASSIFY,
    MASU_PASS_CONE8,
    MASU_PASS_CONE4,
    MASU_PASS_MARCH,
    MASU_PASS_MARCH_CHECKERBOARD,
    MASU_PASS_MARCH_PLAIN,
    MASU_PASS_MARCH_SEED,
    MASU_PASS_MARCH_FRAGMENT,
    MASU_PASS_VELOCITY,
    MASU_PASS_SDF_VELOCITY,
    MASU_PASS_RECEIVERS,
    MASU_PASS_CULL_CASTERS,
    MASU_PASS_COMPACT_CASTERS,
    MASU_PASS_CASCADE_0, /* one after the other */
    MASU_PASS_CASCADE_1,
    MASU_PASS_CASCADE_2,
    MASU_PASS_CASCADE_3,
    MASU_PASS_SDF_OCCLUSION,
    MASU_PASS_SHADOW,
    MASU_PASS_PROBES,
    MASU_PASS_LIGHT_TILES,
    MASU_PASS_AO,
    MASU_PASS_AO_UPSAMPLE,
    MASU_PASS_LIGHT,
    MASU_PASS_LIGHT_OCCLUDED,
    MASU_PASS_SPECULAR_GUIDE,
    MASU_PASS_SPECULAR_RAYS,
    MASU_PASS_SPECULAR_TRACE,
    MASU_PASS_SPECULAR_STRUCTURE,
    MASU_PASS_SPECULAR_QUERY,
    MASU_PASS_SPECULAR_TRACE_SDF,
    MASU_PASS_SPECULAR_SHADE,
    MASU_PASS_SPECULAR_REUSE,
    MASU_PASS_SPECULAR_TEMPORAL,
    MASU_PASS_SPECULAR_FINE,
    MASU_PASS_SPECULAR_FILTER,
    MASU_PASS_SPECULAR_TAA,
    MASU_PASS_SPECULAR_KEEP,
    MASU_PASS_SPECULAR_KEEP_FINE,
    MASU_PASS_SPECULAR_ACCUMULATE,
    MASU_PASS_SPECULAR_COMPOSITE,
    MASU_PASS_TRANSPARENTS,
    MASU_PASS_READBACK,
    MASU_PASS_METER,
    MASU_PASS_EXPOSE,
    MASU_PASS_TONEMAP,
    MASU_PASS_FXAA,
    MASU_PASS_SMAA_EDGES,
    MASU_PASS_SMAA_BLEND,
    MASU_PASS_EASU,
    MASU_PASS_EASU_FAST,
    MASU_PASS_BILINEAR,
    MASU_PASS_FSR1,
    MASU_PASS_RCAS,
    MASU_PASS_PRESENT,
    MASU_PASS_COUNT
} masu_pass_id;

/* The bit of a pass in a mask of passes. */
#define MASU_PASS_BIT(pass) ((uint64_t)1 << (pass))

extern const masu_image_row masu_images[MASU_IMAGE_COUNT];
extern const masu_pass_row masu_passes[MASU_PASS_COUNT];

int masu_usage_writes(masu_usage usage);

/* Whether it is a cascade of the shadow map: it does not run in every frame. */
int masu_is_cascade(uint32_t pass);

/* Whether a row's images are bound as set 1: those of compute rows, and of what is drawn over them. */
int masu_has_set(uint32_t pass);

/* Whether an access of such a row takes a binding of set 1, as a read or as a write. */
int masu_access_binds(masu_access access, int writes);

/* Pixels of an extent in a frame of that render and output size. */
VkExtent2D masu_extent_of(masu_image_extent extent, VkExtent2D render, VkExtent2D output);

#endif

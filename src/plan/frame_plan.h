/* frame_plan.h: types for the rows of the frame's tables: passes.inc, images.inc, buffers.inc and
 * axes.inc, each with a description of its columns at its head. Here they become enums and constant
 * arrays; plan.c, buffer_plan.c, push.c and src/device derive the rest. */
#ifndef MASU_FRAME_PLAN_H
#define MASU_FRAME_PLAN_H

#include "scene/blob.h"
#include "masu.h"
#include "shared/masu_shared.h"

/* Images, and behind them the buffers, of which rows say what they read and write for barriers' sake. */
typedef enum masu_image_id {
    MASU_IMAGE_NONE = 0,
#define IMAGE(ID, ...) MASU_IMAGE_##ID,
#include "plan/images.inc"
#undef IMAGE
    MASU_IMAGE_COUNT
} masu_image_id;

typedef enum masu_buffer_id {
#define BUFFER(ID, ...) MASU_BUFFER_##ID,
#include "plan/buffers.inc"
#undef BUFFER
    MASU_BUFFER_COUNT
} masu_buffer_id;

/* What an access may name: an image, a buffer, or a stand-in, which plan.c resolves per rung: the image of
 * a class that the latest pass has written, or the one that was the latest before. */
#define MASU_RESOURCE(buffer) (MASU_IMAGE_COUNT + (buffer))
#define MASU_RESOURCE_END MASU_RESOURCE(MASU_BUFFER_COUNT)
#define MASU_LATEST(class_of) (MASU_RESOURCE_END + (class_of))
#define MASU_BEFORE(class_of) (MASU_RESOURCE_END + MASU_CLASS_COUNT + (class_of))

static inline int masu_is_buffer(uint32_t resource) {
    return resource >= MASU_RESOURCE(0) && resource < MASU_RESOURCE_END;
}

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
    MASU_EXTENT_OUTPUT_PAIRS, /* the same, an invocation for two pixels side by side */
    MASU_EXTENT_OUTPUT_ODD, /* the same, an invocation for the 2x2 pixels between four texels: one more each way than texels */
    MASU_EXTENT_HALF, /* a texel per 2x2 render pixels */
    MASU_EXTENT_TRACED, /* the same, for reflections; per pixel with debug.reference */
    MASU_EXTENT_LEVELS, /* 1/2 to 1/64 of the render size side by side: light/background.glsl */
    MASU_EXTENT_BLOCK8,
    MASU_EXTENT_BLOCK4,
    MASU_EXTENT_TILE,  /* one workgroup per tile of 16x16 */
    MASU_EXTENT_TILES, /* the same, for active tiles only: indirect */
    MASU_EXTENT_EDGED, /* one workgroup per tile of SMAA_TILES: indirect */
    MASU_EXTENT_GLOSSY, /* one workgroup per tile of SPECULAR_TILES, 8x8 texels of TRACED: indirect */
    MASU_EXTENT_DECALS, /* an invocation per render pixel, near decals only: indirect, by the host */
    MASU_EXTENT_ONE,   /* one workgroup */
    MASU_EXTENT_ATLAS, /* of occluders */
    MASU_EXTENT_KEPT,    /* an invocation per instance and view */
    MASU_EXTENT_BATCHES, /* see compact.comp */
    MASU_EXTENT_SKINS,   /* an invocation per vertex of the largest skin, for each skin */
    MASU_EXTENT_SKIN_TREES, /* a workgroup per skin */
    MASU_EXTENT_PROBES,  /* an invocation per light probe */
    MASU_EXTENT_RAYS,    /* an invocation per ray of the frame's live probes: indirect, by the host */
    MASU_EXTENT_TRACED_PROBES, /* a workgroup per probe that has such: indirect, by the host */
    MASU_EXTENT_PICK,    /* the 2x2 pixels with the one that is picked */
    MASU_EXTENT_SHADOW,  /* all cascades of the shadow map; plan.c knows how large */
    MASU_EXTENT_LOCAL_FACES, /* the local_shadow_faces squares that a frame renders; likewise */
    MASU_EXTENT_LOCAL_SDF,   /* an invocation per texel of the due faces that the SDF reaches: indirect, by the host */
    MASU_EXTENT_LOCAL_ATLAS, /* the atlas that keeps them; likewise */
    MASU_EXTENT_LOCAL_PAIRS  /* half as wide */
} masu_image_extent;

typedef struct masu_image_row {
    const char *name;
    VkFormat format;
    masu_image_extent extent;
    masu_image_class class_of;
    uint32_t readback; /* masu_readback_bits that asks for it */
    int kept;          /* the next frame reads what this one has left in it */
    uint32_t layers;   /* 2: of which this frame writes one, and reads what the frame before has left in the other */
    const char *content;
} masu_image_row;

typedef enum masu_usage {
    MASU_USE_NONE = 0,
    MASU_READ,        /* sampled, texel by texel */
    MASU_READ_LINEAR, /* sampled, with the mean of the texels around a place */
    MASU_READ_BUFFER, /* storage buffer, or arguments of the row's indirect dispatch */
    MASU_READ_VERTICES, /* vertex buffer */
    MASU_READ_COPY,   /* transfer source */
    MASU_READ_BACK,   /* the same, of what desc.readback asks for */
    MASU_READ_STRUCTURE, /* of ray queries: binding of set 0 */
    MASU_READ_HOST,      /* by the host's own commands, sampled or copied */
    MASU_WRITE,       /* storage, whole sub-rectangle, earlier content is lost */
    MASU_UPDATE,      /* storage, some texels, the rest is kept */
    MASU_PING_PONG,   /* of an image of two layers: one sampled, with the mean of the texels around a place, the other storage,
                       * whole sub-rectangle; two bindings */
    MASU_WRITE_COLOR, /* colour attachment, cleared first */
    MASU_UPDATE_COLOR, /* the same, not cleared: pixels that are not drawn are undefined */
    MASU_BLEND_COLOR, /* the same of which earlier content is kept, and blended with */
    MASU_WRITE_DEPTH, /* depth attachment, cleared to 0 (far) first */
    MASU_UPDATE_DEPTH, /* the same of a part of the image, the rest is kept */
    MASU_KEEP_DEPTH,   /* depth attachment that is not cleared: what is not drawn is kept */
    MASU_WRITE_BUFFER, /* storage buffer */
    MASU_WRITE_COPY,   /* transfer destination */
    MASU_WRITE_STRUCTURE, /* built by the device, for ray queries */
    MASU_HOST_COLOR, /* drawn over or otherwise changed by the host's own commands */
    MASU_HOST_DEPTH  /* the same of depth, which they test against */
} masu_usage;

typedef enum masu_pass_kind {
    MASU_PASS_GRAPHICS,
    MASU_PASS_COMPUTE,
    MASU_PASS_TRANSFER,
    MASU_PASS_BUILD, /* of a structure for ray queries: src/device/ray_query.c */
    MASU_PASS_HOST   /* nothing of ours: a recording ends, the host's commands go here */
} masu_pass_kind;

#define MASU_PASS_ACCESSES 12u

typedef struct masu_access {
    uint8_t image; /* masu_image_id, MASU_RESOURCE of a buffer, or a stand-in */
    uint8_t usage; /* masu_usage */
} masu_access;

_Static_assert(MASU_BEFORE(MASU_CLASS_COUNT) <= 256, "an access names its resource in 8 bits");

/* A flag for each switch among the knobs (masu_knobs.h). */
#define MASU_FLAG_masu_switch(name) int name;
#define MASU_FLAG_masu_easu(name)
#define MASU_FLAG_masu_aa(name)
#define MASU_FLAG_masu_march(name)
#define MASU_FLAG_OF_NUMBER(...)
#define MASU_FLAG_OF_WORD(type, name, ...) MASU_FLAG_##type(name)
typedef struct masu_switches {
    MASU_KNOBS(MASU_FLAG_OF_NUMBER, MASU_FLAG_OF_WORD)
} masu_switches;

/* What the scene and the description need, computed once; the `decide` of each row looks at nothing
 * else. */
/* Features that the device has too few storage buffers for. Until the plan is compiled again they
 * are added to desc.deny.storage_buffers, which is then less than 64. */
#define MASU_DROPPED_BOUNCE (1u << 29)
#define MASU_DROPPED_SPECULAR (1u << 30)
#define MASU_DROPPED_OCCLUSION (1u << 31)
#define MASU_DROPPED_ANY (MASU_DROPPED_BOUNCE | MASU_DROPPED_SPECULAR | MASU_DROPPED_OCCLUSION)

typedef struct masu_needs {
    int scene;         /* a scene is drawn (else: upscaling of a source image) */
    int raster;        /* it has instances */
    int skins;         /* joints bend some of them */
    int sdf;           /* it has an SDF */
    uint32_t readback; /* masu_readback_bits */
    uint32_t split;    /* masu_split_bits */
    int blit;          /* targets are filled by a blit */
    int dynamic;       /* slots of the SDF depend on parameters or time */
    int anchored;      /* and on where the eye is: the SDF reaches far from the origin */
    int timed;         /* `dynamic`, and some depend on time */
    int occluders;     /* the scene has some */
    int unculled;      /* and a mesh of too many primitives or instances for culling by them */
    int surface;       /* some material has more than the four numbers of albedo and normal image */
    int environment;   /* the sky is from a picture */
    int sky;           /* the sky may follow from the sun */
    int emissive;      /* polygons may emit: the G-buffer pass writes their radiance into hdr, */
    int emission_packed; /* into albedo (pack.glsl): the device has too few attachments */
    int velocity;      /* something reads velocities: the previous frame is kept */
    int sdf_occlusion; /* the SDF casts shadows or occludes ambient light */
    int probes;        /* it has light probes, baked or live */
    int lights;        /* there are local lights, */
    int area_lights;   /* among them perhaps capsules or rectangles, */
    int shared_lights; /* and perhaps some whose surfaces are in the scene */
    int sdf_casts;     /* the SDF casts their shadows */
    int local_shadows; /* and some cast shadows in some rung: there is an atlas */
    int shadow;        /* polygons cast shadows of the sun: there is a shadow map */
    int transparents;  /* something is blended, */
    int rough_glass;   /* and something behind it seen blurred */
    int reflections;   /* a rung traces some */
    int traced;        /* there are polygons to trace */
    int traced_sdf;    /* there is an SDF to trace */
    int bounce;        /* a rung traces rays of live probes; */
    int bounce_sdf;    /* they meet the SDF */
    int query;         /* polygons are found by ray queries of the device */
    int any_taa;        /* a rung has taa, */
    int any_fine;        /* fine */
    int any_resolved;    /* fine, and resolves over frames */
    int smoothing;     /* smaa */
    int picking;       /* the host may ask what is under a pixel */
    int metered;       /* the exposure follows the picture */
    uint32_t dropped;  /* MASU_DROPPED_*: what rungs with AUTO lack, for want of storage buffers */
    int sprites;       /* frames may bring some of these: */
    int particles, decals, lines;
    masu_switches any; /* a rung has the switch on, and the scene is one where that is of use */
    /* of one rung: */
    masu_switches on;  /* the same of this rung */
    int upscale, sharpen, occlusion;
    int fxaa, smaa; /* at most one of them */
    int resolve;   /* over frames */
    int resolve_twice; /* the same to twice the size */
    int twice;     /* upscale in full to twice the size */
    int casters;   /* occlusion, of a view of the sun too */
    int receiver_mask; /* and of cascades that every frame draws anew */
    int specular;    /* reflections are traced */
    int reuse, temporal, fine, filter, taa; /* what is done to them */
    int accumulate;  /* for comparison: of all pixels, summed up over frames, unfiltered */
    const masu_rung *rung; /* itself; only while the plan is compiled */
#ifdef MASU_LAB
    masu_march march;
#endif
    masu_easu easu; /* never AUTO */
    uint32_t cascades; /* of the shadow map */
} masu_needs;

/* What a graphics pass draws, and with it the state of its pipelines. */
typedef enum masu_geometry {
    MASU_GEOMETRY_NONE,
    MASU_GEOMETRY_POLYGONS, /* colour and depth */
    MASU_GEOMETRY_CASCADE,  /* depth alone */
    MASU_GEOMETRY_CASTERS,  /* the same, of each face of punctual lights that is due */
    MASU_GEOMETRY_PICK,     /* as polygons, what is blended too; numbers of instances */
    MASU_GEOMETRY_BLENDED,  /* over what is there, back to front */
    MASU_GEOMETRY_BOXES,    /* made up by the vertex shader; depth alone */
    MASU_GEOMETRY_SPRITES,  /* the same; colour, which is blended where the row says BLEND */
    MASU_GEOMETRY_SCREEN,   /* one triangle over everything */
    MASU_GEOMETRY_DEPTHS,   /* the same that writes depth, as an image has it */
    MASU_GEOMETRY_TILES     /* squares made up by the vertex shader, that write depth whatever was there */
} masu_geometry;

typedef struct masu_pass_row {
    const char *name;
    const char *purpose;
    masu_pass_kind kind;
    masu_image_extent extent; /* size of the dispatch */
    /* Returns whether the pass runs, and why, in a few words. */
    int (*decide)(const masu_needs *needs, const char **why);
    masu_geometry geometry;
    uint32_t code; /* masu_blob_kind of the scene's own SPIR-V; 0: the library's */
    masu_access access[MASU_PASS_ACCESSES];
} masu_pass_row;

typedef enum masu_pass_id {
#define PASS(ID, ...) MASU_PASS_##ID,
#include "plan/passes.inc"
#undef PASS
    MASU_PASS_COUNT
} masu_pass_id;

/* Passes as a set. */
#define MASU_PASS_WORDS ((MASU_PASS_COUNT + 63) / 64)
typedef struct masu_pass_set {
    uint64_t words[MASU_PASS_WORDS];
} masu_pass_set;

static inline int masu_has_pass(const masu_pass_set *set, uint32_t pass) {
    return (int)(set->words[pass / 64] >> pass % 64 & 1u);
}

static inline void masu_add_pass(masu_pass_set *set, uint32_t pass) {
    set->words[pass / 64] |= (uint64_t)1 << pass % 64;
}

_Static_assert(MASU_PASS_COUNT <= MASU_MAX_PASSES, "masu_plan_info holds every pass");
_Static_assert(MASU_IMAGE_COUNT <= MASU_MAX_RESOURCES, "masu_plan_info holds every image");

extern const masu_image_row masu_images[MASU_IMAGE_COUNT];
extern const masu_pass_row masu_passes[MASU_PASS_COUNT];

int masu_usage_writes(masu_usage usage);

/* Whether it is a cascade of the shadow map: it does not run in every frame. */
int masu_is_cascade(uint32_t pass);
/* The same of the passes that render shadow faces of punctual lights. */
int masu_is_of_faces(uint32_t pass);

/* Whether a rung of such needs has an image: the last column but one of images.inc. */
int masu_has_image(const masu_needs *needs, uint32_t image);

/* Whether the sun or the ambient light reaches surfaces only in part, and an image says how much. */
int masu_is_occluded(const masu_needs *needs);

static inline int masu_is_smaa(masu_aa aa) { return aa >= MASU_AA_SMAA_LOW; }

/* Whether the march of the SDF writes lists of parts per tile, and of the parts that matter per 4x4
 * block. Always so in the product: the lab build has other marches. */
int masu_march_has_tiles(const masu_needs *needs);
int masu_march_has_blocks(const masu_needs *needs);

/* Whether the host's own commands are given what is known of the scene at each pixel, depth above all. */
static inline int masu_split_shows_scene(uint32_t split) {
    return (split & (MASU_SPLIT_BEFORE_TONE | MASU_SPLIT_KEEP)) != 0;
}

/* Whether a row's images are bound as set 1: those of compute rows, and of what is drawn over them. */
int masu_has_set(uint32_t pass);

/* Whether an access of such a row takes a binding of set 1, as a read or as a write. */
int masu_access_binds(masu_access access, int writes);

/* Pixels of an extent in a frame of that render and output size. */
VkExtent2D masu_extent_of(masu_image_extent extent, VkExtent2D render, VkExtent2D output);

#endif

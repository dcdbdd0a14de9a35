/* frame_plan.h: types for the rows of the tables passes.inc, images.inc, buffers.inc and axes.inc,
 * each of which documents its columns. The rows become enums and constant arrays here; plan.c,
 * buffer_plan.c, push.c and src/device derive everything else. */
#ifndef MASU_FRAME_PLAN_H
#define MASU_FRAME_PLAN_H

#include "scene/blob.h"
#include "masu.h"
#include "shared/masu_shared.h"

/* Ids of images. Buffers follow (MASU_RESOURCE), because rows list their buffer accesses for
 * barriers. */
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

/* An access names an image, a buffer, or a stand-in. compile.c resolves a stand-in per rung: the
 * image of a class that was written most recently, or the one before that. */
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
    MASU_EXTENT_OUTPUT_PAIRS, /* the same, one invocation per two horizontal neighbours */
    /* the same, one invocation per 2x2 pixels between four texels: one more per axis than texels */
    MASU_EXTENT_OUTPUT_ODD,
    MASU_EXTENT_HALF,   /* one texel per 2x2 render pixels */
    MASU_EXTENT_TRACED, /* the same, for reflections; per pixel with debug.reference */
    MASU_EXTENT_LEVELS, /* 1/2 to 1/64 of the render size side by side: light/background.glsl */
    MASU_EXTENT_ALL_LEVELS, /* and the render size itself */
    MASU_EXTENT_FOCUS,  /* one texel per 2x2 render pixels, for depth of field */
    MASU_EXTENT_BLOOM_16,  /* 1/8 and 1/16 of the render size, one below the other */
    MASU_EXTENT_BLOOM_128, /* 1/32, 1/64 and 1/128 */
    MASU_EXTENT_BLOCK8,
    MASU_EXTENT_BLOCK4,
    MASU_EXTENT_TILE,  /* one workgroup per tile of 16x16 pixels */
    MASU_EXTENT_TILES, /* the same, for active tiles only: indirect */
    MASU_EXTENT_EDGED, /* one workgroup per tile of SMAA_TILES: indirect */
    /* one workgroup per tile of SPECULAR_TILES, 8x8 texels of TRACED: indirect */
    MASU_EXTENT_GLOSSY,
    /* one invocation per render pixel near decals: indirect, written by the host */
    MASU_EXTENT_DECALS,
    MASU_EXTENT_ONE,        /* one workgroup */
    MASU_EXTENT_ATLAS,      /* atlas of occluder depth */
    MASU_EXTENT_KEPT,       /* one invocation per instance and view */
    MASU_EXTENT_BATCHES,    /* see compact.comp */
    MASU_EXTENT_SKINS,      /* one invocation per vertex of the largest skin, for each skin */
    MASU_EXTENT_SKIN_TREES, /* one workgroup per skin, and per mesh of the host */
    /* one invocation per element of the frame's changed meshes: indirect, written by the host */
    MASU_EXTENT_MESHES,
    MASU_EXTENT_PROBES,     /* one invocation per light probe */
    /* one invocation per ray of the frame's live probes: indirect, written by the host */
    MASU_EXTENT_RAYS,
    /* one workgroup per live probe of the frame: indirect, written by the host */
    MASU_EXTENT_TRACED_PROBES,
    /* one live texture; passes: one invocation per texel written, indirect, by the host */
    MASU_EXTENT_TEXTURES,
    MASU_EXTENT_PICK,   /* the 2x2 pixels that contain the picked one */
    MASU_EXTENT_SHADOW, /* all cascades of the shadow map; size from plan.c */
    /* the local_shadow_faces squares that a frame renders; size from plan.c */
    MASU_EXTENT_LOCAL_FACES,
    /* one invocation per texel of the due faces with SDF shadows: indirect, written by the host */
    MASU_EXTENT_LOCAL_SDF,
    MASU_EXTENT_LOCAL_ATLAS, /* the persistent atlas of faces; size from plan.c */
    MASU_EXTENT_LOCAL_PAIRS  /* half as wide */
} masu_image_extent;

typedef struct masu_image_row {
    const char *name;
    VkFormat format;
    masu_image_extent extent;
    masu_image_class class_of;
    uint32_t readback; /* masu_readback_bits that requests it */
    int kept;          /* persistent: the next frame reads the content */
    /* 2: ping-pong: this frame writes one layer and reads the other; 0: one per live texture */
    uint32_t layers;
    const char *content;
} masu_image_row;

typedef enum masu_usage {
    MASU_USE_NONE = 0,
    MASU_READ,           /* sampled, nearest */
    MASU_READ_LINEAR,    /* sampled, linear filter */
    MASU_READ_MAP,       /* sampled as a texture of materials: binding of set 2 */
    MASU_READ_BUFFER,    /* storage buffer, or arguments of the pass's indirect dispatch */
    MASU_READ_VERTICES,  /* vertex buffer */
    MASU_READ_COPY,      /* transfer source */
    MASU_READ_BACK,      /* the same, for desc.readback */
    MASU_READ_STRUCTURE, /* ray queries: binding of set 0 */
    MASU_READ_HOST,      /* sampled or copied by the host's own commands */
    MASU_WRITE,          /* storage, whole sub-rectangle; discards earlier content */
    MASU_UPDATE,         /* storage, some texels; keeps the others */
    /* two layers: one sampled with a linear filter, the other storage, whole sub-rectangle; two
     * bindings */
    MASU_PING_PONG,
    MASU_WRITE_COLOR,     /* colour attachment, cleared first */
    MASU_UPDATE_COLOR,    /* the same, not cleared: pixels that no draw covers are undefined */
    MASU_BLEND_COLOR,     /* the same, keeps earlier content and blends with it */
    MASU_WRITE_DEPTH,     /* depth attachment, cleared to 0 (far) first */
    MASU_UPDATE_DEPTH,    /* the same for a part of the image; keeps the rest */
    MASU_KEEP_DEPTH,      /* depth attachment, not cleared */
    MASU_WRITE_BUFFER,    /* storage buffer */
    MASU_WRITE_COPY,      /* transfer destination */
    MASU_WRITE_STRUCTURE, /* built by the device, for ray queries */
    MASU_HOST_COLOR,      /* drawn to or otherwise changed by the host's own commands */
    MASU_HOST_DEPTH       /* depth that the host's own commands test against */
} masu_usage;

typedef enum masu_pass_kind {
    MASU_PASS_GRAPHICS,
    MASU_PASS_COMPUTE,
    MASU_PASS_TRANSFER,
    MASU_PASS_BUILD, /* builds a structure for ray queries: src/device/ray_query.c */
    MASU_PASS_HOST   /* split point: a recording ends, the host inserts commands */
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

/* The requirements of the scene and the description, computed once. The `decide` functions of rows
 * use nothing else. */
/* Features for which the device has too few storage buffers. Until the plan is compiled again,
 * these bits are combined with desc.deny.storage_buffers, which is then below 64. */
#define MASU_DROPPED_BOUNCE (1u << 29)
#define MASU_DROPPED_SPECULAR (1u << 30)
#define MASU_DROPPED_OCCLUSION (1u << 31)
#define MASU_DROPPED_ANY (MASU_DROPPED_BOUNCE | MASU_DROPPED_SPECULAR | MASU_DROPPED_OCCLUSION)

typedef struct masu_needs {
    int scene;         /* with a scene (else: upscaling of a source image) */
    int raster;        /* it has instances */
    int skins;         /* some of them are skinned */
    int meshes;        /* the host may create meshes */
    int sdf;           /* it has an SDF */
    uint32_t readback; /* masu_readback_bits */
    uint32_t split;    /* masu_split_bits */
    int blit;          /* targets are filled by a blit */
    int dynamic;       /* the SDF's evaluated constants depend on parameters or time */
    int anchored;      /* and on the camera position: the SDF has a floating origin */
    int timed;         /* the SDF or its surfaces depend on time */
    int moving;        /* the SDF may change: by time, or by parameters of the host */
    int occluders;     /* the scene has occluders */
    int unculled;      /* and a mesh with too many primitives or instances for occlusion culling */
    int surface;     /* some material has more parameters than the albedo and normal images hold */
    int environment; /* the sky is an environment map */
    int looks;       /* instances have looks */
    int sky;         /* the sky may be analytic */
    int emissive;    /* polygons may emit: the G-buffer pass writes their radiance to hdr, */
    int emission_packed; /* or to albedo (pack.glsl), if the device has too few attachments */
    int velocity;        /* some pass reads velocities: the previous frame's data is kept */
    int sdf_occlusion; /* the SDF casts shadows or occludes ambient light */
    int probes;        /* the scene has light probes, baked or live */
    int lights;        /* the scene has local lights, */
    int area_lights;   /* possibly capsules or rectangles, */
    int shared_lights; /* possibly lights whose surfaces are in the scene */
    int sdf_casts;     /* the SDF casts shadows of local lights */
    int local_shadows; /* a rung has local shadows: there is an atlas */
    int shadow;        /* polygons cast sun shadows: there is a shadow map */
    int transparents;  /* the scene has transparent surfaces, */
    int rough_glass;   /* and some show a blurred background, */
    int refraction;    /* or a refracted one */
    int reflections;   /* a rung traces reflections */
    int traced;        /* rays trace polygons */
    int traced_sdf;    /* rays trace the SDF */
    int bounce;        /* a rung traces rays of live probes; */
    int bounce_sdf;    /* these trace the SDF */
    int query;         /* polygons are traced by ray queries */
    int any_taa;       /* a rung has specular_taa, */
    int any_fine;      /* specular_fine */
    int any_resolved;  /* specular_fine with temporal upscaling */
    int smoothing;     /* SMAA */
    int picking;       /* the host may pick pixels */
    int metered;       /* auto-exposure */
    uint32_t post;     /* masu_post_bits */
    uint32_t dropped;  /* MASU_DROPPED_*: AUTO features that are off for lack of storage buffers */
    int sprites;       /* frames may have sprites of these kinds: */
    int particles, decals, lines;
    int textures;       /* sprites may have textures: there is an image of live textures, */
    int texture_writes; /* which the host may write, */
    int texture_maps;   /* and materials may show */
    masu_switches any; /* some rung has the switch on, and the scene can use it */
    /* For one rung: */
    masu_switches on; /* the same for this rung */
    int upscale, sharpen, occlusion;
    int fxaa, smaa; /* at most one is set */
    int resolve;    /* temporal upscaling */
    int resolve_twice; /* the same at exactly 2x */
    int twice;         /* EASU at exactly 2x */
    int casters;       /* occlusion culling also for a view of the sun */
    int receiver_mask; /* and for cascades that are re-rendered every frame */
    int specular;    /* reflections are traced */
    int reuse, temporal, fine, filter, taa; /* filters of reflections */
    int accumulate;        /* reference: all pixels, accumulated over frames, unfiltered */
    const masu_rung *rung; /* the rung; valid only during compilation */
#ifdef MASU_LAB
    masu_march march;
#endif
    masu_easu easu; /* never AUTO */
    uint32_t cascades; /* number of shadow map cascades */
} masu_needs;

/* Geometry that a graphics pass draws; determines the state of its pipelines. */
typedef enum masu_geometry {
    MASU_GEOMETRY_NONE,
    MASU_GEOMETRY_POLYGONS, /* colour and depth */
    MASU_GEOMETRY_CASCADE,  /* depth only */
    MASU_GEOMETRY_CASTERS,  /* depth only, for each face of local lights that is due */
    MASU_GEOMETRY_PICK,     /* like POLYGONS, with transparent ones; writes instance indices */
    MASU_GEOMETRY_BLENDED,  /* blended over the image, back to front */
    MASU_GEOMETRY_BOXES,    /* boxes generated by the vertex shader; depth only */
    /* sprites generated by the vertex shader; blended if the row has BLEND */
    MASU_GEOMETRY_SPRITES,
    MASU_GEOMETRY_SCREEN, /* a triangle that covers the render area */
    MASU_GEOMETRY_DEPTHS, /* the same, copies depth from an image */
    /* squares generated by the vertex shader, write depth without a depth test */
    MASU_GEOMETRY_TILES
} masu_geometry;

typedef struct masu_pass_row {
    const char *name;
    const char *purpose;
    masu_pass_kind kind;
    masu_image_extent extent; /* size of the dispatch */
    /* Returns whether the pass runs, and sets *why to a short reason. */
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

/* A set of passes. */
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

/* Whether a pass renders a cascade of the shadow map. Such passes do not run in every frame. */
int masu_is_cascade(uint32_t pass);
/* Whether a pass renders shadow faces of local lights. */
int masu_is_of_faces(uint32_t pass);

/* Whether a rung with these needs has an image: the column `when` of images.inc. */
int masu_has_image(const masu_needs *needs, uint32_t image);

/* Whether sunlight or ambient light is partly occluded, which an image stores per pixel. */
int masu_is_occluded(const masu_needs *needs);

static inline int masu_is_smaa(masu_aa aa) { return aa >= MASU_AA_SMAA_LOW; }

/* Whether the SDF march writes lists of primitives per tile, and term masks per 4x4 block. Always
 * true in the product; the lab build has other marches. */
int masu_march_has_tiles(const masu_needs *needs);
int masu_march_has_blocks(const masu_needs *needs);

/* Number of points of a colour table. */
static inline uint64_t masu_lut_points(uint32_t size) { return (uint64_t)size * size * size; }

/* Whether the host's own commands get the scene's per-pixel data, such as depth. */
static inline int masu_split_shows_scene(uint32_t split) {
    return (split & (MASU_SPLIT_BEFORE_TONE | MASU_SPLIT_KEEP)) != 0;
}

/* Whether the images of a pass are bound as set 1: for compute passes, and for draws over the
 * image. */
int masu_has_set(uint32_t pass);

/* Whether an access of such a pass has a binding of set 1, as a read or as a write. */
int masu_access_binds(masu_access access, int writes);

/* Size of an extent in pixels for a render and an output size. */
VkExtent2D masu_extent_of(masu_image_extent extent, VkExtent2D render, VkExtent2D output);

#endif

/* blob.h: the bytes of a baked scene (.masu), shared by the runtime that reads them and masu-bake
 * that writes them.
 *
 *   +--------+---------------+---------+---------+-----
 *   | header | section table | payload | payload | ...      little-endian; offsets count from the
 *   +--------+---------------+---------+---------+-----     first byte; no pointers
 *   0        64              16-byte aligned, in table order, gaps zero and < 16 bytes each
 *
 * Rules a reader may rely on after masu_scene_bind has passed a blob (reader.c and check_*.c check
 * each):
 *  - header.bytes is the exact length; hash is FNV-1a 64 over everything behind the header;
 *  - each section kind appears at most once; stride is the sizeof of its struct here;
 *  - every float is finite; every index is in range; instances are sorted by mesh;
 *  - the primitives together have no more indices, and meshes and LODs no more primitives,
 *    than there are (vertices may be shared): work stays linear in the blob's size;
 *  - SPIR-V holds together and asks for nothing that its pass does not bind (code.h), and was compiled
 *    for the counts that the blob has. It is code all the same: a blob is as trusted as the executable
 *    and comes from the port's own build. The hash finds damage, not malice.
 * World space: right-handed, +Y up, metres, linear colour. docs/blob.md is the prose form of this
 * file. */
#ifndef MASU_BLOB_H
#define MASU_BLOB_H

#include <stdint.h>

#define MASU_BLOB_MAGIC 0x5553414Du /* the bytes 'M' 'A' 'S' 'U' */
#define MASU_BLOB_VERSION 18u
/* layout of version 18: 2955733314 (kinds of sections and their elements, tests/scripts/scene_forms.sh) */
#define MASU_BLOB_ALIGN 16u
#define MASU_BLOB_NONE 0xFFFFFFFFu /* "no name", "no parent" */
#define MASU_BLOB_PART_SLOTS 8u    /* of an SDF's part, in front of all others: sphere, slope, form, first argument, material */
#define MASU_BLOB_NAME_MAX 255u    /* bytes of a name, without its NUL */

enum masu_blob_kind {
    MASU_BLOB_VERTICES = 1,
    MASU_BLOB_INDICES = 2, /* uint32, relative to the primitive's first vertex */
    MASU_BLOB_PRIMITIVES = 3,
    MASU_BLOB_MESHES = 4,
    MASU_BLOB_INSTANCES = 5,
    MASU_BLOB_MATERIALS = 6,
    MASU_BLOB_CAMERA_KEYS = 7,
    MASU_BLOB_ENVIRONMENT = 8, /* exactly one, always present */
    MASU_BLOB_SDF = 9,         /* at most one; then MARCH_SPIRV is present too */
    MASU_BLOB_SDF_PARAMS = 10,
    MASU_BLOB_MARCH_SPIRV = 11, /* uint32 words: the march pass specialised to this scene */
    MASU_BLOB_NAMES = 12,       /* NUL-terminated UTF-8 strings of at most MASU_BLOB_NAME_MAX bytes */
    MASU_BLOB_CLASSIFY_SPIRV = 13, /* these three are present exactly when MARCH_SPIRV is */
    MASU_BLOB_CONE8_SPIRV = 14,
    MASU_BLOB_CONE4_SPIRV = 15,
    MASU_BLOB_UPDATE_SPIRV = 16, /* present when slots depend on parameters, time or the anchor */
    MASU_BLOB_PLAIN_SPIRV = 17,  /* these three: only in blobs of the lab build, with --variants */
    MASU_BLOB_SEED_SPIRV = 18,
    MASU_BLOB_CHECKERBOARD_SPIRV = 19, /* 20 is not used */
    MASU_BLOB_SLOTS = 21,          /* float: initial values of the SDF's slots; at least one */
    MASU_BLOB_UPDATE_PREVIOUS_SPIRV = 22, /* present when slots depend on parameters or time */
    MASU_BLOB_VELOCITY_SPIRV = 23,        /* present exactly when MARCH_SPIRV is */
    MASU_BLOB_OCCLUSION_SPIRV = 24,       /* with SDF shadows or SDF ambient occlusion */
    MASU_BLOB_GROUPS = 25,      /* what is culled together; a tree, group 0 is its root */
    MASU_BLOB_GROUP_ITEMS = 26, /* uint32: instances, group after group; present with GROUPS */
    MASU_BLOB_OCCLUDERS = 27,   /* boxes inside of meshes, sorted by mesh */
    MASU_BLOB_SHADOW = 28,      /* at most one: the sun's shadow map */
    MASU_BLOB_TEXCOORDS = 29,   /* float pairs, one per vertex; these four come together */
    MASU_BLOB_TEXTURES = 30,
    MASU_BLOB_TEXTURE_SETS = 31,
    MASU_BLOB_TEXELS = 32, /* compressed blocks, in units of 16 bytes */
    MASU_BLOB_LODS = 33,   /* by mesh; of one mesh the finer first, at most MASU_BLOB_LODS_MAX */
    MASU_BLOB_MESO = 34,   /* small relief of materials: what the eye sees of it, by angle */
    MASU_BLOB_LIGHTS = 35, /* points and spots */
    MASU_BLOB_PROBES = 36, /* at most one: a grid of light probes; these two come together */
    MASU_BLOB_PROBE_DATA = 37,
    MASU_BLOB_ENVIRONMENT_MAP = 38, /* at most one: a sky from a picture; these two come together */
    MASU_BLOB_ENVIRONMENT_TEXELS = 39,
    MASU_BLOB_REFLECTIONS = 44,    /* at most one: reflections are traced */
    MASU_BLOB_TRACE_TEXTURES = 45, /* what rays see of the textures; these two come together */
    MASU_BLOB_TRACE_TEXELS = 46,   /* uint32 */
    MASU_BLOB_TRACE_SDF_SPIRV = 47, /* rays meet the SDF */
    MASU_BLOB_SILHOUETTES_SPIRV = 48, /* present exactly when MARCH_SPIRV is */
    MASU_BLOB_TRACE_NODES = 40, /* what rays are traced through; these four come together */
    MASU_BLOB_TRACE_TRIANGLES = 41,
    MASU_BLOB_TRACE_MESHES = 42,    /* as many as meshes, in their order */
    MASU_BLOB_TRACE_INSTANCES = 43, /* uint32, rising: those that rays meet */
    MASU_BLOB_MODELS = 49,      /* models that move, come and go as one; these two come together */
    MASU_BLOB_MODEL_NODES = 50, /* by model, each behind the one above it */
    MASU_BLOB_CLIPS = 51,    /* of models, by the first model of a kind; these three come together */
    MASU_BLOB_CHANNELS = 52, /* by clip */
    MASU_BLOB_KEYS = 53,     /* by channel, in rising time */
    MASU_BLOB_SKINS = 54,    /* meshes that joints bend; these three come together */
    MASU_BLOB_JOINTS = 55,   /* by skin; those of one kind share them */
    MASU_BLOB_SKIN_VERTICES = 56, /* the same */
    MASU_BLOB_BOUNCE_SDF_SPIRV = 57, /* rays of live probes meet the SDF */
    MASU_BLOB_LOCAL_SHADOW_SPIRV = 58, /* the SDF casts shadows of punctual lights */
    MASU_BLOB_COLORS = 59, /* uint32, one per vertex, with texture coordinates: masu_blob_color */
    MASU_BLOB_TEXCOORDS_1 = 60,  /* float pairs, one per vertex: what maps of the second set are read at */
    MASU_BLOB_MORPH_TARGETS = 61, /* of skins; these two come together */
    MASU_BLOB_MORPH_DELTAS = 62,
    MASU_BLOB_KIND_COUNT = 63
};

/* Four texels by four make a block. sRGB formats hold display-encoded colour. */
enum masu_blob_texture_format {
    MASU_TEXTURE_BC1_SRGB = 1, /* opaque colour, 8 bytes a block */
    MASU_TEXTURE_BC3_SRGB = 2, /* colour and alpha, 16 bytes */
    MASU_TEXTURE_BC4 = 3,      /* one channel, 8 bytes */
    MASU_TEXTURE_BC5 = 4       /* two channels, 16 bytes */
};

/* What a material may have a texture for: slots of a texture set, bits of a material's flags. */
enum masu_blob_texture_slot {
    MASU_SLOT_BASE = 0,    /* base colour, alpha in BC3 */
    MASU_SLOT_NORMAL = 1,  /* BC5: x and y of the tangent-space normal as 0..1, +y up the image */
    MASU_SLOT_SURFACE = 2, /* BC4: roughness; BC5: roughness, metallic */
    MASU_SLOT_EMISSIVE = 3,  /* with COAT_RELIEF: BC5, the normals of the coat */
    MASU_SLOT_OCCLUSION = 4, /* BC4: what of the light from everywhere arrives, by the relief */
    MASU_SLOT_COAT = 5,      /* BC5: clear coat, its roughness; with LOBE_MAP BC1 or BC3: what multiplies
                                colour (rgb) and strength (alpha) of the lobe; not of what is blended */
    MASU_SLOT_COUNT = 6
};

/* Flags of a material; shaders/shared/masu_shared.h has them too. Bit of a slot: the map is there,
 * and the material's factor is multiplied by it. */
enum masu_blob_material_flags {
    MASU_MATERIAL_HAS_MAPS = 0x3F,
    MASU_MATERIAL_IS_MASK = 0x40,   /* texels with alpha below the cut-off are not there */
    MASU_MATERIAL_IS_BLEND = 0x80,  /* transparent: blended with what is behind it */
    MASU_MATERIAL_CUTOFF_SHIFT = 8, /* 8 bits: cut-off times 255 */
    MASU_MATERIAL_IS_ADDITIVE = 0x10000, /* with IS_BLEND: adds its light, hides nothing */
    MASU_MATERIAL_IS_SINGLE = 0x40000,   /* not seen from behind: from where its triangles turn clockwise */
    MASU_MATERIAL_HAS_METAL = 0x80000,   /* the surface map holds metallic as well */
    MASU_MATERIAL_IS_TINTED = 0x100000,  /* with IS_BLEND: what shines through has its base colour */
    /* Whose relief the normal map is not: the mesh's own normal is the coat's, or what lies below it */
    MASU_MATERIAL_COAT_SMOOTH = 0x200000,
    MASU_MATERIAL_BASE_SMOOTH = 0x400000,
    MASU_MATERIAL_NO_SHADOW = 0x800000, /* casts no shadows, neither of the sun nor of other lights */
    MASU_MATERIAL_TRANSMISSION_MAP = 0x20000, /* with IS_TINTED: alpha of the base colour is the share that
                                                 is transmitted, not what the surface covers */
    /* Without IS_BLEND: */
    MASU_MATERIAL_LOBE_MAP = 0x10000,     /* with HAS_COAT's bit: it is a map of a specular colour or a sheen */
    MASU_MATERIAL_COAT_RELIEF = 0x100000, /* with COAT_SMOOTH: the coat has normals of its own, see EMISSIVE */
    MASU_MATERIAL_KNOWN = 0xFFFFFF
};

/* The guarantees of Vulkan 1.1 for maxImageDimension2D and maxImageArrayLayers. */
#define MASU_TEXTURE_SIZE_MAX 4096u
#define MASU_TEXTURE_LAYERS_MAX 256u
#define MASU_TEXTURE_ARRAYS_MAX 64u
#define MASU_TEXCOORD_MAX 32768.0f

typedef struct masu_blob_header {
    uint32_t magic;
    uint32_t version;
    uint64_t bytes; /* of the whole blob */
    uint64_t hash;  /* FNV-1a 64 of bytes [64, bytes) */
    uint32_t section_count;
    uint32_t reserved0;
    uint64_t reserved[4]; /* zero */
} masu_blob_header;

typedef struct masu_blob_section {
    uint32_t kind;
    uint32_t stride; /* bytes of one element */
    uint64_t offset; /* from the first byte of the blob, a multiple of 16 */
    uint64_t count;  /* elements */
} masu_blob_section;

typedef struct masu_blob_vertex {
    float position[3];
    int16_t normal[2]; /* octahedral, signed normalised (c / 32767) */
} masu_blob_vertex;

/* A colour of COLORS: square roots of linear red, green, blue, then alpha, 8 bits each from the lowest on. */
#define MASU_BLOB_WHITE 0xFFFFFFFFu

typedef struct masu_blob_primitive {
    uint32_t first_index;
    uint32_t index_count; /* a multiple of 3 */
    uint32_t first_vertex;
    uint32_t vertex_count; /* 1 .. 16,777,215: indices stay exact on devices without
                              fullDrawIndexUint32 */
    uint32_t material;
    float aabb_min[3]; /* object space */
    float aabb_max[3];
    /* Object space: most by which the smooth surface of the vertex normals rises above the
     * triangles; 0: faceted. The shadow map draws the primitive that much thinner. */
    float rise;
} masu_blob_primitive;

typedef struct masu_blob_mesh {
    uint32_t first_primitive;
    uint32_t primitive_count;
    float aabb_min[3];
    float aabb_max[3];
    uint32_t name; /* byte offset into NAMES, or MASU_BLOB_NONE */
    uint32_t reserved;
} masu_blob_mesh;

/* A LOD of a mesh: as many primitives as the mesh has, in its order, with its materials; of
 * no triangles where all of one have vanished. */
#define MASU_BLOB_LODS_MAX 3u
typedef struct masu_blob_lod {
    uint32_t mesh;
    uint32_t first_primitive;
    float error; /* object space: no point of either surface is farther from the other; it does not
                    fall from level to level */
    uint32_t reserved;
} masu_blob_lod;

typedef struct masu_blob_instance {
    float transform[12]; /* rows of the 3x4 matrix, object to world */
    uint32_t mesh;
    uint32_t name;
    uint32_t parent; /* instance index or MASU_BLOB_NONE; transforms are already composed */
    uint32_t group;  /* the group that has it as an item, or MASU_BLOB_NONE: culled by itself */
} masu_blob_instance;

enum masu_blob_model_flags { MASU_MODEL_HIDDEN = 1 /* until the host shows it */ };

/* A model that moves as one. Its nodes are the next of MODEL_NODES. */
typedef struct masu_blob_model {
    float transform[12]; /* its own space to world, as the scene places it */
    uint32_t first_node, node_count; /* at least one */
    uint32_t name;
    uint32_t flags; /* masu_blob_model_flags */
    uint32_t like;  /* the first model of its kind, at most this one: same meshes at the same nodes */
    uint32_t reserved[3];
} masu_blob_model;

/* The transform of its instance is that of all nodes above it and of the model, times its own. */
typedef struct masu_blob_model_node {
    float local[12];   /* to the node above it, or to the model */
    uint32_t parent;   /* of MODEL_NODES: of the same model, before this one; or MASU_BLOB_NONE */
    uint32_t instance; /* that shows it, of no other node; or MASU_BLOB_NONE */
    uint32_t name;
    uint32_t skin; /* 1 + of SKINS, that bends what the instance shows; 0: none */
} masu_blob_model_node;

/* What moves nodes of a model, and of all that are like it. */
typedef struct masu_blob_clip {
    uint32_t model; /* of MODELS, the first of its kind; clips are sorted by it */
    uint32_t first_channel, channel_count; /* the next of CHANNELS */
    float duration; /* seconds, 0..1e9 */
    uint32_t name;
    uint32_t reserved[3];
} masu_blob_clip;

enum masu_blob_channel_path {
    MASU_CHANNEL_TRANSLATION = 0, /* x, y, z */
    MASU_CHANNEL_ROTATION = 1,    /* a quaternion x, y, z, w of unit length */
    MASU_CHANNEL_SCALE = 2,       /* x, y, z */
    MASU_CHANNEL_WEIGHT = 3       /* of a morph target of the node's skin: x */
};

/* One of the three that make up a node's place: translation times rotation times scale. */
typedef struct masu_blob_channel {
    uint32_t node; /* of the model's nodes, counted from its first */
    uint32_t path; /* masu_blob_channel_path; no other channel of the clip has node, path and target */
    uint32_t step; /* 1: each key holds until the next; 0: in between is in between */
    uint32_t first_key, key_count; /* the next of KEYS, at least one; the ends hold */
    uint32_t target;               /* of CHANNEL_WEIGHT: of the skin's targets; else 0 */
    uint32_t reserved[2];
} masu_blob_channel;

typedef struct masu_blob_key {
    float time; /* seconds, 0..1e9 */
    float value[4];
} masu_blob_key;

/* A mesh that joints bend. It has vertices of its own, which the device writes in each frame, and one
 * instance; those of all skins lie side by side at the end of VERTICES, in this order. Sorted by model. */
#define MASU_BLOB_SKINS_MAX 16384u
#define MASU_BLOB_SKIN_JOINTS_MAX (1u << 20) /* of all skins, each counted for itself */
typedef struct masu_blob_skin {
    uint32_t model; /* that shows it, */
    uint32_t node;  /* of MODEL_NODES: by this node */
    uint32_t like;  /* the first skin with the same joints and vertices, at most this one */
    uint32_t first_vertex, vertex_count; /* of VERTICES: all of its primitives lie inside */
    uint32_t first_skin_vertex;          /* of SKIN_VERTICES, as many; the next ones, or those of `like` */
    uint32_t first_joint, joint_count;   /* of JOINTS, 1..65536: the same */
    uint32_t first_target, target_count; /* of MORPH_TARGETS: the same; 0: its vertices only bend */
    uint32_t first_delta;                /* of MORPH_DELTAS, vertex_count for each target: the same */
    uint32_t reserved;
} masu_blob_skin;

/* What is added to rest vertices, times a weight, before joints move them. The box holds all of its deltas. */
#define MASU_BLOB_MORPH_TARGETS_MAX 1024u /* of one skin */
typedef struct masu_blob_morph_target {
    float low[3], high[3];
    float weight; /* at rest, within +-MASU_MORPH_WEIGHT_MAX */
    uint32_t name;
} masu_blob_morph_target;
#define MASU_MORPH_WEIGHT_MAX 1e6f

typedef struct masu_blob_morph_delta {
    float position[3];
    uint32_t normal; /* signed normalised x, y, z of 11, 11, 10 bits, of +-2 */
} masu_blob_morph_delta;

/* A vertex is the weighted mean of where the joints put it: node in the model, times inverse bind. */
typedef struct masu_blob_joint {
    float inverse_bind[12];  /* from the rest vertices' space to the joint's */
    float low[3], high[3];   /* around all rest vertices that it moves; both 0 where that is nothing */
    uint32_t node;           /* of the model's nodes, counted from its first */
    uint32_t used;           /* 1: it moves something */
} masu_blob_joint;

/* The rest pose: VERTICES has its twin as the scene is baked. */
typedef struct masu_blob_skin_vertex {
    masu_blob_vertex rest;
    uint16_t joints[4];  /* of the skin's */
    uint16_t weights[4]; /* 65535 together */
} masu_blob_skin_vertex;

/* Members are other groups, instances, or both. Children come behind their parent and side by
 * side; each group but the first is a child exactly once. The box (world space) holds the boxes of
 * all members as src/scene/cull.h widens them. */
typedef struct masu_blob_group {
    float center[3];
    float half[3];
    uint32_t first_child, child_count;
    uint32_t first_item, item_count; /* of GROUP_ITEMS; instances in rising order */
    uint32_t name;
    uint32_t reserved;
} masu_blob_group;

#define MASU_BLOB_OCCLUDERS_MAX 64u /* of one mesh: each is looked at for each instance in each frame */

/* A box that the mesh hides as a whole, from every side: what is behind it is behind the mesh. */
typedef struct masu_blob_occluder {
    float low[3]; /* object space, inside of the mesh's bounds */
    float high[3];
    uint32_t mesh;
    uint32_t lods; /* of the mesh's LODs so many, the finest, hide it too */
} masu_blob_occluder;

typedef struct masu_blob_material {
    float base_color[3]; /* linear, 0..1 */
    float roughness;     /* perceptual, 0..1 */
    float emissive[3];   /* linear radiance, >= 0 */
    float metallic;      /* 0..1 */
    uint32_t name;
    uint32_t flags;       /* masu_blob_material_flags; 0: no textures, and the next two are 0 */
    uint32_t texture_set; /* element of TEXTURE_SETS */
    uint32_t layers;      /* of the set's textures, 8 bits per slot, of the first four */
    float specular;       /* 0..12.5: reflectance of a dielectric at normal incidence / 0.08; plain: 0.5 */
    float coat;           /* 0..1: how much of a clear coat lies on it */
    float coat_roughness; /* perceptual, 0..1 */
    float opacity;        /* 0..1, of blended materials; else 1 */
    uint32_t meso;        /* element of MESO, or MASU_BLOB_NONE */
    uint32_t more_layers; /* of the slots from OCCLUSION on, 8 bits each; from bit 16 on a bit for each
                             slot: its coordinates are TEXCOORDS_1 */
    float detail[2];          /* texture coordinates of all maps but colour and emissive are times it */
    /* At most one of the next three, without a coat and MESO: masu_lobe_code (material.h). */
    float specular_color[3];   /* 0..1, the largest 1: of the dielectric's reflectance; 0, 0, 0: gray */
    float sheen_color[3];      /* 0..1; 0: none. With specular 0.5 */
    float sheen_roughness;     /* perceptual, 0..1 */
    float anisotropy;          /* 0..1: roughness along the grain is mix(alpha, 1, anisotropy^2) */
    float anisotropy_rotation; /* of the grain from the direction of u towards +y of a normal map, 0..2 pi */
} masu_blob_material;

/* What a relief too small for polygons looks like from an angle: curves of shaders/brdf/meso.glsl, which
 * masu-meso finds. Three coefficients each; all numbers within +-1000. */
typedef struct masu_blob_meso {
    float tilt[3], facet;       /* the normal leans to the viewer; roughness of the facets, 0..1 */
    float roughness[3], spread; /* change of roughness; what lost normals take of diffuse light */
    float occlusion[3], alpha;  /* change of occlusion; alpha of the local shadow, 0..4 */
    float gain[3], offset;      /* change of diffuse light; offset of the local shadow, 0..4 */
    float tint[3], spread1;     /* change of colour; spread is spread + y spread1 + y^2 spread2 */
    float specular[3], spread2;
} masu_blob_meso;

enum masu_blob_light_type {
    MASU_LIGHT_POINT = 0,
    MASU_LIGHT_SPOT = 1,
    MASU_LIGHT_SPHERE = 2,
    MASU_LIGHT_CAPSULE = 3,
    MASU_LIGHT_RECTANGLE = 4,
    MASU_LIGHT_TYPE = 0xFF,
    /* Beside the type: */
    MASU_LIGHT_NO_SHADOW = 0x100,
    MASU_LIGHT_TWO_SIDED = 0x200, /* rectangle */
    MASU_LIGHT_SURFACE = 0x400    /* of a surface of the scene; not of points and spots */
};

/* Light of a place. At distance d a white surface that faces a point has the radiance
 * color / d^2, times a window that falls to 0 at range. */
typedef struct masu_blob_light {
    float position[3]; /* world, or object space of the parent */
    float range;       /* metres, 0..1e15; 0: it lights nothing */
    float color[3];    /* 0..1e9; points and spots: radiant intensity / pi, others: radiance */
    float radius;      /* of the source, 1e-6..1e9 metres */
    float direction[3]; /* of spots: where they shine, unit length; capsule, rectangle: half axis */
    uint32_t type;      /* masu_blob_light_type, and flags */
    float inner;        /* of spots: full light within this angle of the direction, radians, */
    float outer;        /* none beyond this one; 0 <= inner <= outer <= pi. Points: both 0 */
    uint32_t parent;    /* instance that carries it, or MASU_BLOB_NONE */
    uint32_t name;
    float half_axis[3]; /* rectangle */
    uint32_t reserved;  /* 0 */
} masu_blob_light;

#define MASU_BLOB_LIGHTS_MAX 4096u

/* What is blended is drawn one by one: a thing for each primitive of such a material and each instance of
 * its mesh. */
#define MASU_TRANSPARENTS_MAX 4096u       /* things of a scene */
#define MASU_TRANSPARENT_SETS_MAX 64u     /* texture sets that they use */
#define MASU_TRANSPARENT_DRAWS_MAX 65536u /* the product of both */
#define MASU_PROBE_SUNS_MAX 16u
#define MASU_PROBE_SETS_MAX 26u
#define MASU_PROBE_WORDS 14u /* of one set: 27 halfs, coefficient after coefficient, RGB in each; then
                                in the first set how far the probe is to be believed, 0..1 */
#define MASU_PROBE_LIT_WORDS 12u /* of a probe under the light of a frame; not in blobs */
/* Of a live probe, not in blobs either: its mean, as lit words are, and sixteen sums. */
#define MASU_PROBE_LIVE_WORDS (MASU_PROBE_LIT_WORDS + 16u * MASU_PROBE_WORDS)
#define MASU_PROBE_COUNT_MAX 262144u
#define MASU_PROBE_BYTES_MAX ((uint64_t)64 << 20)
#define MASU_PROBE_VISIBILITY_MAX 16u

/* A grid of light probes: how the irradiance at each, / pi, answers to the sky and to the sun. Data, in
 * words: of each probe (x first, z last) its sets; then of each its map of distances, (visibility +
 * 2)^2 words: mean and mean square as 16 bits each, of 1.5 and 2.25 cell diagonals.
 * Sets: sky_sets of them, for a sky whose radiance is a spherical harmonic; what emissive surfaces
 * send, if any do; then what comes back from surfaces under each of `suns` suns of irradiance pi. */
typedef struct masu_blob_probes {
    float origin[3]; /* of the first probe */
    float bias;      /* metres that points are lifted along their normal */
    float spacing[3]; /* metres */
    float reserved0;
    uint32_t counts[3];  /* together at most MASU_PROBE_COUNT_MAX */
    uint32_t sky_sets;   /* 1, 4 or 9; live: 0 too, then one set of emission alone, all 0 */
    uint32_t suns;       /* 0..MASU_PROBE_SUNS_MAX */
    uint32_t emissive;   /* 0 or 1 */
    uint32_t visibility; /* texels along the edge of a map of distances; 0: no maps */
    uint32_t live;       /* 1: rays of the frame add what is not baked */
    float sun_direction[MASU_PROBE_SUNS_MAX][4]; /* towards it, unit length; unused ones 0 */
    float sun_inverse[MASU_PROBE_SUNS_MAX][MASU_PROBE_SUNS_MAX]; /* of the matrix 1 - angle / pi */
} masu_blob_probes;

/* Words of PROBE_DATA for one probe. */
static inline uint32_t masu_probe_words(const masu_blob_probes *p) {
    uint32_t map = p->visibility ? (p->visibility + 2) * (p->visibility + 2) : 0;
    return (p->sky_sets + p->emissive + p->suns) * MASU_PROBE_WORDS + map;
}

static inline uint32_t masu_probe_sets(const masu_blob_probes *p) {
    return p->sky_sets + p->emissive + p->suns;
}

/* A sky of radiances over the octahedron of directions, +y at its middle: ENVIRONMENT_TEXELS holds
 * mips of size, size / 2, ... texels along an edge, row by row; each texel 9 bits each of r, g, b
 * and 5 of the exponent they share (VK_FORMAT_E5B9G9R9_UFLOAT_PACK32). Mip m is what a surface of
 * roughness m / (mips - 1) mirrors. */
typedef struct masu_blob_environment_map {
    uint32_t size; /* a power of two, 8..1024 */
    uint32_t mips; /* 2..8, the smallest no less than 4 texels */
    uint32_t reserved[2];
    float sh[9][4]; /* rgb: irradiance / pi by the normal, order 2. Fourth component: of 0 to 2 the
                       colour of a lobe (shared/sky.h), >= 0; of 3 to 5 its direction, of a length
                       up to 1; of 6 to 8 the colour of Legendre's P4 of y */
} masu_blob_environment_map;

/* An array of images of one format and size. Texels: layer after layer, each the whole mip chain
 * from large to small, each mip's blocks row by row; a mip has ceil(size / 4) blocks each way. */
typedef struct masu_blob_texture {
    uint32_t format; /* masu_blob_texture_format */
    uint32_t width;  /* 1..4096, of mip 0; mip m has max(1, width >> m) */
    uint32_t height;
    uint32_t mips;   /* 1..floor(log2(larger side)) + 1 */
    uint32_t layers; /* 1..256 */
    uint32_t name;
    uint64_t offset; /* bytes into TEXELS: the end of the texture before, rounded up to 16 */
} masu_blob_texture;

/* What a draw binds together: a texture per slot, or MASU_BLOB_NONE. */
typedef struct masu_blob_texture_set {
    uint32_t texture[MASU_SLOT_COUNT];
    uint32_t wrap[2]; /* along u and v: 0 repeat, 1 clamp, 2 mirror; the first plus 4: magnified without
                         interpolation */
} masu_blob_texture_set;

/* Traced reflections; present with TRACE_NODES, TRACE_SDF_SPIRV or both. */
typedef struct masu_blob_reflections {
    float cutoff;    /* perceptual roughness from which nothing is traced, 0..1 */
    float distance;  /* longest ray, metres, 1e-3..1e9 */
    float glossiest; /* the least roughness of any surface or coat, 0..1 */
    uint32_t reserved;
} masu_blob_reflections;

/* A picture that rays look up where they meet a surface: of a layer of TEXTURES, with a side of at most
 * MASU_TRACE_TEXTURE_MAX texels. Texels are sqrt of linear red, green, blue, then alpha, 8 bits each, the first the
 * lowest; mip after mip, row by row, each mip half as large, the last 1x1. Of roughness and metallic, as red and
 * green, the last texel alone counts: their mean. Sorted by texture, then layer. */
#define MASU_TRACE_TEXTURE_MAX 256u
typedef struct masu_blob_trace_texture {
    uint32_t texture, layer;
    uint32_t width, height;
    uint32_t first; /* of TRACE_TEXELS: where the one before ends */
    uint32_t reserved;
} masu_blob_trace_texture;

/* Texels of all mips. */
static inline uint64_t masu_blob_trace_texels(uint32_t width, uint32_t height) {
    uint64_t texels = 0;
    for (uint32_t m = 0; m < 9; m++) {
        uint32_t w = width >> m ? width >> m : 1, h = height >> m ? height >> m : 1;
        texels += (uint64_t)w * h;
        if (w == 1 && h == 1) break;
    }
    return texels;
}

/* A tree over the triangles of a mesh, or over the instances of a frame (src/scene/trace.h): boxes of up to
 * four children. Child i reaches along axis k from origin[k] + low[k] 2^(e - 127) to origin[k] +
 * high[k] 2^(e - 127), with byte i of low[k] and high[k] and e byte k of `packed`: a box around the child's
 * own. Byte 3 of `packed` is the children's types, 2 bits each: 0 none, 1 a node, 2 a leaf of one item, 3 a
 * leaf of two. First come the nodes, then the leaves. Nodes are side by side from `child`, items from
 * `item`. */
typedef struct masu_blob_trace_node {
    float origin[3];
    uint32_t packed;
    uint32_t low[3];
    uint32_t high[3];
    uint32_t child; /* of TRACE_NODES, all meshes counted */
    uint32_t item;  /* of TRACE_TRIANGLES, all meshes counted */
} masu_blob_trace_node;

typedef struct masu_blob_trace_triangle {
    uint32_t vertex[3]; /* of VERTICES */
    uint32_t primitive; /* of PRIMITIVES */
} masu_blob_trace_triangle;

/* No nodes: rays do not meet the mesh. A mesh's nodes are in the order of a depth-first walk that gives the
 * children of a node the next free places when it gets to the node; so are the triangles. */
typedef struct masu_blob_trace_mesh {
    uint32_t first_node, node_count;
    uint32_t first_triangle, triangle_count;
    uint32_t depth; /* levels of nodes, at most MASU_TRACE_DEPTH_MAX */
    uint32_t reserved;
} masu_blob_trace_mesh;

/* shaders/shared/masu_shared.h has these too. */
#define MASU_TRACE_DEPTH_MAX 28u
#define MASU_TRACE_NODES_MAX (1u << 24)
#define MASU_TRACE_INSTANCES_MAX (1u << 20)
#define MASU_TRACE_REACH 1e15f /* no corner of a box is farther out */

static inline uint32_t masu_trace_type(const masu_blob_trace_node *node, uint32_t slot) {
    return node->packed >> (24 + 2 * slot) & 3u;
}

/* Camera path: keys in rising time, linear in between (position and target), held at both ends. Up
 * is +Y. */
typedef struct masu_blob_camera_key {
    float time; /* seconds */
    float position[3];
    float target[3]; /* differs from position */
    float fov_y;     /* radians, (0, pi) */
} masu_blob_camera_key;

typedef struct masu_blob_environment {
    float sun_direction[3]; /* towards the sun, unit length */
    float exposure;         /* linear factor before the tone curve, > 0 */
    float sun_color[3];     /* irradiance on a facing surface / pi */
    float near_distance;    /* metres, > 0; there is no far plane */
    float ambient[3];
    float metered;          /* 1: exposure is times what the picture asks for; 0: it is not */
    float sky_zenith[3];
    float brighten; /* how fast that adapts, 0..1e6 1/s: when it is too dark, */
    float sky_horizon[3];
    float turbidity; /* 0: the two colours above; 1.5..10: an analytic sky */
    float ground[3]; /* albedo of what lies below the analytic sky, 0..1 */
    float occlusion_radius; /* of ambient occlusion in screen space, metres; 0: none */
    float fog_color[3]; /* radiance of thick fog; all zero: the sky's at the horizon */
    float fog_density;  /* at fog_height, 1/m; 0: no fog */
    float fog_height;   /* m */
    float fog_falloff;  /* >= 0, 1/m: the density falls by e over 1 / fog_falloff metres of height */
    float fog_start;    /* >= 0, m: nearer than this it is clear */
    float darken;       /* and too bright; 0: the default */
    float smooth_edges; /* 1: anti-aliased by SMAA where nobody says how; 0: not */
    float reserved[3];
} masu_blob_environment;

/* The sun's shadow map: of scenes that have instances too. Where it is absent nothing that has
 * polygons casts a shadow. */
typedef struct masu_blob_shadow {
    uint32_t cascades;   /* 1..MASU_SHADOW_CASCADES_MAX */
    uint32_t resolution; /* texels along the edge of one, MASU_SHADOW_SIZE_MIN.._MAX */
    float distance;      /* view depth where shadows end, metres, 1e-3..1e9 */
    float lambda;        /* of the cascades' ends: 0 evenly spaced, 1 by a constant factor */
} masu_blob_shadow;

#define MASU_SHADOW_CASCADES_MAX 4u
#define MASU_SHADOW_SIZE_MIN 16u
#define MASU_SHADOW_SIZE_MAX 8192u

typedef struct masu_blob_sdf {
    float bounds_min[3]; /* nothing of the SDF is drawn outside; world space */
    float lipschitz;     /* >= 1e-3: |f(p)-f(q)| <= lipschitz |p-q| */
    float bounds_max[3];
    float max_distance;  /* longest ray, > 0 */
    uint32_t has_raster; /* 1: the code was compiled to read a raster depth (there are instances) */
    uint32_t part_count; /* 1..4096 */
    uint32_t anchored;   /* 1: the update SPIR-V moves the SDF's space to frame.anchor */
    uint32_t block_words; /* of the tiles' buffer for each 4x4 block of pixels: 0..2 */
} masu_blob_sdf;

typedef struct masu_blob_sdf_param {
    float value; /* default */
    float minimum;
    float maximum;
    uint32_t name;
} masu_blob_sdf_param;

/* Blocks of one format. 0: no such format. */
static inline uint32_t masu_blob_block_bytes(uint32_t format) {
    if (format == MASU_TEXTURE_BC1_SRGB || format == MASU_TEXTURE_BC4) return 8;
    return format == MASU_TEXTURE_BC3_SRGB || format == MASU_TEXTURE_BC5 ? 16 : 0;
}

static inline uint32_t masu_blob_mip_size(uint32_t size, uint32_t mip) {
    return size >> mip ? size >> mip : 1;
}

/* Bytes of all layers and mips, without the padding behind. */
static inline uint64_t masu_blob_texture_bytes(const masu_blob_texture *t) {
    uint64_t blocks = 0;
    for (uint32_t m = 0; m < t->mips && m < 32; m++) {
        blocks += (uint64_t)((masu_blob_mip_size(t->width, m) + 3) / 4) *
                  ((masu_blob_mip_size(t->height, m) + 3) / 4);
    }
    return blocks * masu_blob_block_bytes(t->format) * t->layers;
}

/* Texels of all mips of an environment map. */
static inline uint64_t masu_blob_environment_texels(uint32_t size, uint32_t mips) {
    uint64_t texels = 0;
    for (uint32_t m = 0; m < mips && m < 32; m++) texels += (uint64_t)(size >> m) * (size >> m);
    return texels;
}

/* FNV-1a, 64 bit (Fowler, Noll, Vo): offset basis and prime of the reference. */
static inline uint64_t masu_fnv1a64(const void *data, uint64_t bytes) {
    const unsigned char *p = (const unsigned char *)data;
    uint64_t h = 0xCBF29CE484222325u;
    for (uint64_t i = 0; i < bytes; i++) h = (h ^ p[i]) * 0x100000001B3u;
    return h;
}

_Static_assert(sizeof(masu_blob_header) == 64, "blob header");
_Static_assert(sizeof(masu_blob_section) == 24, "blob section");
_Static_assert(sizeof(masu_blob_vertex) == 16, "blob vertex");
_Static_assert(sizeof(masu_blob_primitive) == 48, "blob primitive");
_Static_assert(sizeof(masu_blob_mesh) == 40, "blob mesh");
_Static_assert(sizeof(masu_blob_lod) == 16, "blob lod");
_Static_assert(sizeof(masu_blob_instance) == 64, "blob instance");
_Static_assert(sizeof(masu_blob_clip) == 32, "blob clip");
_Static_assert(sizeof(masu_blob_channel) == 32, "blob channel");
_Static_assert(sizeof(masu_blob_key) == 20, "blob key");
_Static_assert(sizeof(masu_blob_skin) == 48, "blob skin");
_Static_assert(sizeof(masu_blob_morph_target) == 32, "blob morph target");
_Static_assert(sizeof(masu_blob_morph_delta) == 16, "blob morph delta");
_Static_assert(sizeof(masu_blob_joint) == 80, "blob joint");
_Static_assert(sizeof(masu_blob_skin_vertex) == 32, "blob skin vertex");
_Static_assert(sizeof(masu_blob_group) == 48, "blob group");
_Static_assert(sizeof(masu_blob_occluder) == 32, "blob occluder");
_Static_assert(sizeof(masu_blob_material) == 116, "blob material");
_Static_assert(sizeof(masu_blob_texture) == 32, "blob texture");
_Static_assert(sizeof(masu_blob_texture_set) == 32, "blob texture set");
_Static_assert(sizeof(masu_blob_camera_key) == 32, "blob camera key");
_Static_assert(sizeof(masu_blob_environment) == 144, "blob environment");
_Static_assert(sizeof(masu_blob_meso) == 96, "blob meso");
_Static_assert(sizeof(masu_blob_light) == 80, "blob light");
_Static_assert(sizeof(masu_blob_probes) == 1344, "blob probes");
_Static_assert(sizeof(masu_blob_environment_map) == 160, "blob environment map");
_Static_assert(sizeof(masu_blob_shadow) == 16, "blob shadow");
_Static_assert(sizeof(masu_blob_sdf) == 48, "blob sdf");
_Static_assert(sizeof(masu_blob_reflections) == 16, "blob reflections");
_Static_assert(sizeof(masu_blob_trace_texture) == 24, "blob trace texture");
_Static_assert(sizeof(masu_blob_trace_node) == 48, "blob trace node");
_Static_assert(sizeof(masu_blob_trace_triangle) == 16, "blob trace triangle");
_Static_assert(sizeof(masu_blob_trace_mesh) == 24, "blob trace mesh");
_Static_assert(sizeof(masu_blob_sdf_param) == 16, "blob sdf parameter");

#endif

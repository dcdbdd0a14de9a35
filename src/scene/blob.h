/* blob.h: the binary format of a baked scene (.masu). masu-bake writes it, the runtime reads it.
 *
 *   +--------+---------------+---------+---------+-----
 *   | header | section table | payload | payload | ...      little-endian; offsets are relative to
 *   +--------+---------------+---------+---------+-----     the first byte; no pointers
 *   0        64              16-byte aligned, in table order, gaps zero and < 16 bytes each
 *
 * masu_scene_bind guarantees the following (reader.c and check_*.c check it):
 * - header.bytes is the exact length; hash is FNV-1a 64 over all bytes after the header.
 * - Each section kind appears at most once; stride is the sizeof of its struct here.
 * - Every float is finite, every index is in range, instances are sorted by mesh.
 * - The primitives together use no more indices, and meshes and LODs no more primitives, than there
 *   are (vertices may be shared). Work is therefore linear in the blob's size.
 * - SPIR-V is well-formed, uses no resource that its pass does not bind (code.h), and was compiled
 *   for the counts of the blob. It is executable code nevertheless: trust a blob like the
 *   executable, and take it from the port's own build. The hash detects corruption, not attacks.
 *
 * World space is right-handed, +Y up, in metres; colours are linear. docs/blob.md describes the
 * format in prose. */
#ifndef MASU_BLOB_H
#define MASU_BLOB_H

#include <stdint.h>

#define MASU_BLOB_MAGIC 0x5553414Du /* the bytes 'M' 'A' 'S' 'U' */
#define MASU_BLOB_VERSION 20u
/* layout of version 20: 873282246 (kinds and elements; tests/scripts/scene_forms.sh) */
#define MASU_BLOB_ALIGN 16u
#define MASU_BLOB_NONE 0xFFFFFFFFu /* "no name", "no parent" */
/* values per SDF primitive, first in SLOTS: sphere, slope, form, first argument, material */
#define MASU_BLOB_PART_SLOTS 8u
#define MASU_BLOB_NAME_MAX 255u    /* bytes of a name, without its NUL */

enum masu_blob_kind {
    MASU_BLOB_VERTICES = 1,
    MASU_BLOB_INDICES = 2, /* uint32, relative to first_vertex of the primitive */
    MASU_BLOB_PRIMITIVES = 3,
    MASU_BLOB_MESHES = 4,
    MASU_BLOB_INSTANCES = 5,
    MASU_BLOB_MATERIALS = 6,
    MASU_BLOB_CAMERA_KEYS = 7,
    MASU_BLOB_ENVIRONMENT = 8, /* exactly one, always present */
    MASU_BLOB_SDF = 9,         /* at most one; then MARCH_SPIRV is present too */
    MASU_BLOB_SDF_PARAMS = 10,
    MASU_BLOB_MARCH_SPIRV = 11, /* uint32: the march pass, specialised to this scene */
    MASU_BLOB_NAMES = 12, /* NUL-terminated UTF-8 strings of at most MASU_BLOB_NAME_MAX bytes */
    MASU_BLOB_CLASSIFY_SPIRV = 13, /* these three: present exactly if MARCH_SPIRV is */
    MASU_BLOB_CONE8_SPIRV = 14,
    MASU_BLOB_CONE4_SPIRV = 15,
    MASU_BLOB_UPDATE_SPIRV = 16, /* slots depend on parameters, time or the floating origin */
    MASU_BLOB_PLAIN_SPIRV = 17,  /* these three: only with masu-bake --variants, lab build */
    MASU_BLOB_SEED_SPIRV = 18,
    MASU_BLOB_CHECKERBOARD_SPIRV = 19, /* 20 is not used */
    MASU_BLOB_SLOTS = 21, /* float: initial values of the SDF's evaluated constants; at least one */
    MASU_BLOB_UPDATE_PREVIOUS_SPIRV = 22, /* present if slots depend on parameters or time */
    MASU_BLOB_VELOCITY_SPIRV = 23,        /* present exactly if MARCH_SPIRV is */
    MASU_BLOB_OCCLUSION_SPIRV = 24,       /* with SDF shadows or SDF ambient occlusion */
    MASU_BLOB_GROUPS = 25,                /* culling hierarchy; group 0 is the root */
    MASU_BLOB_GROUP_ITEMS = 26, /* uint32: instances, grouped by group; present with GROUPS */
    MASU_BLOB_OCCLUDERS = 27,   /* boxes inside meshes, sorted by mesh */
    MASU_BLOB_SHADOW = 28,      /* at most one: the sun's shadow map */
    MASU_BLOB_TEXCOORDS = 29,   /* float pairs, one per vertex; these four are present together */
    MASU_BLOB_TEXTURES = 30,
    MASU_BLOB_TEXTURE_SETS = 31,
    MASU_BLOB_TEXELS = 32, /* compressed blocks, in units of 16 bytes */
    MASU_BLOB_LODS = 33,   /* sorted by mesh, finest first; at most MASU_BLOB_LODS_MAX per mesh */
    MASU_BLOB_MESO = 34,   /* mesoscale detail of materials: appearance by viewing angle */
    MASU_BLOB_LIGHTS = 35, /* local lights */
    MASU_BLOB_PROBES = 36, /* at most one: light probe grid; these two are present together */
    MASU_BLOB_PROBE_DATA = 37,
    MASU_BLOB_ENVIRONMENT_MAP = 38, /* at most one: sky image; these two are present together */
    MASU_BLOB_ENVIRONMENT_TEXELS = 39,
    MASU_BLOB_REFLECTIONS = 44,    /* at most one: reflections are traced */
    MASU_BLOB_TRACE_TEXTURES = 45, /* texture copies for ray hits; these two are present together */
    MASU_BLOB_TRACE_TEXELS = 46,   /* uint32 */
    MASU_BLOB_TRACE_SDF_SPIRV = 47,   /* traces rays against the SDF */
    MASU_BLOB_SILHOUETTES_SPIRV = 48, /* present exactly if MARCH_SPIRV is */
    MASU_BLOB_TRACE_NODES = 40,       /* BVHs for ray tracing; these four are present together */
    MASU_BLOB_TRACE_TRIANGLES = 41,
    MASU_BLOB_TRACE_MESHES = 42,    /* one per mesh, in the same order */
    MASU_BLOB_TRACE_INSTANCES = 43, /* uint32, ascending: the traced instances */
    MASU_BLOB_MODELS = 49,          /* movable models; these two are present together */
    MASU_BLOB_MODEL_NODES = 50,     /* grouped by model, parents before children */
    MASU_BLOB_CLIPS = 51, /* by first model of a kind; these three are present together */
    MASU_BLOB_CHANNELS = 52,           /* grouped by clip */
    MASU_BLOB_KEYS = 53,               /* grouped by channel, by ascending time */
    MASU_BLOB_SKINS = 54,              /* skinned meshes; these three are present together */
    MASU_BLOB_JOINTS = 55,             /* grouped by skin; skins of one kind share joints */
    MASU_BLOB_SKIN_VERTICES = 56,      /* the same */
    MASU_BLOB_BOUNCE_SDF_SPIRV = 57,   /* traces rays of live probes against the SDF */
    MASU_BLOB_LOCAL_SHADOW_SPIRV = 58, /* SDF shadows of local lights */
    MASU_BLOB_COLORS = 59, /* uint32, one per vertex, with texture coordinates: masu_blob_color */
    MASU_BLOB_TEXCOORDS_1 = 60,   /* float pairs, one per vertex: the second texture coordinates */
    MASU_BLOB_MORPH_TARGETS = 61, /* of skins; these two are present together */
    MASU_BLOB_MORPH_DELTAS = 62,
    MASU_BLOB_KIND_COUNT = 63
};

/* Blocks have 4x4 texels. sRGB formats hold display-encoded colour. */
enum masu_blob_texture_format {
    MASU_TEXTURE_BC1_SRGB = 1, /* opaque colour, 8 bytes per block */
    MASU_TEXTURE_BC3_SRGB = 2, /* colour and alpha, 16 bytes */
    MASU_TEXTURE_BC4 = 3,      /* one channel, 8 bytes */
    MASU_TEXTURE_BC5 = 4       /* two channels, 16 bytes */
};

/* Textures of a material: slots of a texture set, and bits of a material's flags. */
enum masu_blob_texture_slot {
    MASU_SLOT_BASE = 0, /* base colour, alpha in BC3 */
    MASU_SLOT_NORMAL = 1, /* BC5: x, y of the tangent-space normal as 0..1, +y up the image */
    MASU_SLOT_SURFACE = 2, /* BC4: roughness; BC5: roughness, metallic */
    MASU_SLOT_EMISSIVE = 3,  /* with COAT_RELIEF: BC5, the normal map of the coat */
    MASU_SLOT_OCCLUSION = 4, /* BC4: ambient occlusion, 1: unoccluded */
    /* BC5: clear coat, its roughness; with LOBE_MAP BC1 or BC3: factors of the lobe's colour (rgb)
     * and strength (alpha); not for transparent materials */
    MASU_SLOT_COAT = 5,
    MASU_SLOT_COUNT = 6
};

/* Flags of a material; also in shaders/shared/masu_shared.h. The bit of a slot is set if the
 * material has that map, whose values are multiplied by the material's factor. */
enum masu_blob_material_flags {
    MASU_MATERIAL_HAS_MAPS = 0x3F,
    MASU_MATERIAL_IS_MASK = 0x40,        /* alpha-tested: discarded below the cut-off */
    MASU_MATERIAL_IS_BLEND = 0x80,       /* transparent: blended over the image */
    MASU_MATERIAL_CUTOFF_SHIFT = 8,      /* 8 bits: cut-off times 255 */
    MASU_MATERIAL_IS_ADDITIVE = 0x10000, /* with IS_BLEND: adds radiance, attenuates nothing */
    MASU_MATERIAL_IS_SINGLE = 0x40000,   /* back faces (clockwise triangles) are not drawn */
    MASU_MATERIAL_HAS_METAL = 0x80000,   /* the surface map also holds metallic */
    MASU_MATERIAL_IS_TINTED = 0x100000,  /* with IS_BLEND: base colour tints transmission */
    /* Layers that ignore the normal map and use the mesh normal: the coat, or the base below it. */
    MASU_MATERIAL_COAT_SMOOTH = 0x200000,
    MASU_MATERIAL_BASE_SMOOTH = 0x400000,
    MASU_MATERIAL_NO_SHADOW = 0x800000, /* casts no shadow of any light */
    /* With IS_TINTED: alpha of the base colour map is the transmission, not the coverage. */
    MASU_MATERIAL_TRANSMISSION_MAP = 0x20000,
    /* Without IS_BLEND: */
    MASU_MATERIAL_LOBE_MAP = 0x10000,     /* with the bit of COAT: its map is for the lobe */
    MASU_MATERIAL_COAT_RELIEF = 0x100000, /* with COAT_SMOOTH: the coat has a normal map */
    MASU_MATERIAL_KNOWN = 0xFFFFFF
};

/* The minimum limits of Vulkan 1.1 for maxImageDimension2D and maxImageArrayLayers. */
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

/* An element of COLORS: square roots of linear red, green and blue, then alpha, 8 bits each, red in
 * the lowest byte. */
#define MASU_BLOB_WHITE 0xFFFFFFFFu

typedef struct masu_blob_primitive {
    uint32_t first_index;
    uint32_t index_count; /* a multiple of 3 */
    uint32_t first_vertex;
    uint32_t vertex_count; /* 1 .. 16,777,215: exact without fullDrawIndexUint32 */
    uint32_t material;
    float aabb_min[3]; /* object space */
    float aabb_max[3];
    /* Object space: largest height of the smooth surface (by vertex normals) above the triangles;
     * 0: faceted. The shadow map shrinks the primitive by it, to avoid self-shadowing. */
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

/* A level of detail of a mesh. It has the primitives of the mesh in the same order, with the same
 * materials; a primitive that has vanished has 0 triangles. */
#define MASU_BLOB_LODS_MAX 3u
typedef struct masu_blob_lod {
    uint32_t mesh;
    uint32_t first_primitive;
    float error; /* object space: bound of the distance of both surfaces; never decreases */
    uint32_t reserved;
} masu_blob_lod;

typedef struct masu_blob_instance {
    float transform[12]; /* rows of the 3x4 matrix, object to world */
    uint32_t mesh;
    uint32_t name;
    uint32_t parent; /* instance index or MASU_BLOB_NONE; transforms are already composed */
    uint32_t group;  /* the group that has it as an item; MASU_BLOB_NONE: culled separately */
} masu_blob_instance;

enum masu_blob_model_flags { MASU_MODEL_HIDDEN = 1 /* until the host shows the model */ };

/* A model that is moved as one. Its nodes follow the previous model's in MODEL_NODES. */
typedef struct masu_blob_model {
    float transform[12];             /* model space to world, as placed in the scene */
    uint32_t first_node, node_count; /* at least one */
    uint32_t name;
    uint32_t flags; /* masu_blob_model_flags */
    uint32_t like;  /* first model with the same meshes at the same nodes; at most its own index */
    uint32_t reserved[3];
} masu_blob_model;

/* The transform of the node's instance is the product of the model's, all ancestors' and its
 * own. */
typedef struct masu_blob_model_node {
    float local[12];   /* node to parent node or model */
    uint32_t parent;   /* index into MODEL_NODES: an earlier node of the model; or MASU_BLOB_NONE */
    uint32_t instance; /* that the node moves, used by no other node; or MASU_BLOB_NONE */
    uint32_t name;
    uint32_t skin; /* 1 + index into SKINS of the skin that deforms the instance; 0: none */
} masu_blob_model_node;

/* An animation of the nodes of a model, valid for all models of its kind. */
typedef struct masu_blob_clip {
    uint32_t model; /* index into MODELS: the first of its kind; clips are sorted by it */
    uint32_t first_channel, channel_count; /* next range of CHANNELS */
    float duration; /* seconds, 0..1e9 */
    uint32_t name;
    uint32_t reserved[3];
} masu_blob_clip;

enum masu_blob_channel_path {
    MASU_CHANNEL_TRANSLATION = 0, /* x, y, z */
    MASU_CHANNEL_ROTATION = 1,    /* a quaternion x, y, z, w of unit length */
    MASU_CHANNEL_SCALE = 2,       /* x, y, z */
    MASU_CHANNEL_WEIGHT = 3       /* morph target weight of the node's skin: x */
};

/* Animates one of the three factors of a node's transform: translation * rotation * scale. */
typedef struct masu_blob_channel {
    uint32_t node; /* relative to the model's first node */
    uint32_t path; /* masu_blob_channel_path; (node, path, target) is unique in a clip */
    uint32_t step; /* 1: each key's value holds until the next key; 0: interpolated */
    uint32_t first_key, key_count; /* next range of KEYS, at least one; both ends hold */
    uint32_t target; /* CHANNEL_WEIGHT: index of the skin's target; else 0 */
    uint32_t reserved[2];
} masu_blob_channel;

typedef struct masu_blob_key {
    float time; /* seconds, 0..1e9 */
    float value[4];
} masu_blob_key;

/* A skinned mesh. It has its own vertices, which the GPU writes in every frame, and one instance.
 * The vertices of all skins are at the end of VERTICES, in this order. Sorted by model. */
#define MASU_BLOB_SKINS_MAX 16384u
#define MASU_BLOB_SKIN_JOINTS_MAX (1u << 20) /* sum over skins; shared ones once per skin */
typedef struct masu_blob_skin {
    uint32_t model; /* the model that shows it, */
    uint32_t node;  /* and the node of MODEL_NODES */
    uint32_t like;  /* the first skin with the same joints and vertices, at most this one */
    uint32_t first_vertex, vertex_count; /* range of VERTICES that contains all its primitives */
    uint32_t first_skin_vertex; /* vertex_count of SKIN_VERTICES: the next, or of `like` */
    uint32_t first_joint, joint_count; /* range of JOINTS, 1..65536: the next, or those of `like` */
    uint32_t first_target, target_count; /* range of MORPH_TARGETS: likewise; 0: no morph targets */
    uint32_t first_delta; /* index into MORPH_DELTAS, vertex_count per target: likewise */
    uint32_t reserved;
} masu_blob_skin;

/* Added to bind-pose vertices, times a weight, before skinning. The box contains all its deltas. */
#define MASU_BLOB_MORPH_TARGETS_MAX 1024u /* per skin */
typedef struct masu_blob_morph_target {
    float low[3], high[3];
    float weight; /* default weight, within +-MASU_MORPH_WEIGHT_MAX */
    uint32_t name;
} masu_blob_morph_target;
#define MASU_MORPH_WEIGHT_MAX 1e6f

typedef struct masu_blob_morph_delta {
    float position[3];
    uint32_t normal; /* signed normalised x, y, z of 11, 11 and 10 bits, scaled to +-2 */
} masu_blob_morph_delta;

/* A skinned vertex is the weighted mean of its joint transforms: node in the model times inverse
 * bind matrix. */
typedef struct masu_blob_joint {
    float inverse_bind[12]; /* from bind-pose space to the space of the joint */
    float low[3], high[3]; /* bounds of the bind-pose vertices that it moves; 0 if none */
    uint32_t node; /* relative to the model's first node */
    uint32_t used; /* 1: some vertex has a weight for it */
} masu_blob_joint;

/* The bind pose. VERTICES holds the same vertex in the pose of the baked scene. */
typedef struct masu_blob_skin_vertex {
    masu_blob_vertex rest;
    uint16_t joints[4];  /* relative to the skin's first joint */
    uint16_t weights[4]; /* the sum is 65535 */
} masu_blob_skin_vertex;

/* A node of the culling hierarchy. Members are child groups, instances, or both. Children follow
 * their parent and are contiguous; each group except the first is a child exactly once. The box
 * (world space) contains the boxes of all members as widened by src/scene/cull.h. */
typedef struct masu_blob_group {
    float center[3];
    float half[3];
    uint32_t first_child, child_count;
    uint32_t first_item, item_count; /* range of GROUP_ITEMS; instances in ascending order */
    uint32_t name;
    uint32_t reserved;
} masu_blob_group;

#define MASU_BLOB_OCCLUDERS_MAX 64u /* per mesh: each is processed per instance and frame */

/* A box inside a mesh. The mesh occludes the whole box from every direction, so everything behind
 * the box is behind the mesh. */
typedef struct masu_blob_occluder {
    float low[3]; /* object space, inside the bounds of the mesh */
    float high[3];
    uint32_t mesh;
    uint32_t lods; /* number of LODs, from the finest on, that contain this box too */
} masu_blob_occluder;

typedef struct masu_blob_material {
    float base_color[3]; /* linear, 0..1 */
    float roughness;     /* perceptual, 0..1 */
    float emissive[3];   /* linear radiance, >= 0 */
    float metallic;      /* 0..1 */
    uint32_t name;
    uint32_t flags;       /* masu_blob_material_flags; 0: no textures; the next two are 0 */
    uint32_t texture_set; /* element of TEXTURE_SETS */
    uint32_t layers;      /* of the first four slots' textures, 8 bits per slot */
    float specular; /* 0..12.5: dielectric reflectance at normal incidence / 0.08; default: 0.5 */
    float coat;     /* 0..1: weight of the clear coat */
    float coat_roughness; /* perceptual, 0..1 */
    float opacity;        /* 0..1 for transparent materials, else 1 */
    uint32_t meso;        /* element of MESO, or MASU_BLOB_NONE */
    uint32_t more_layers; /* slots from OCCLUSION on, 8 bits; from bit 16: TEXCOORDS_1 per slot */
    float detail[2]; /* scale of texture coordinates, except for base colour and emissive */
    /* At most one of the next three, only without coat and MESO: masu_lobe_code (material.h). */
    float specular_color[3]; /* hue of the dielectric reflectance: 0..1, maximum 1; 0, 0, 0: grey */
    float sheen_color[3];    /* 0..1; 0: no sheen. With specular 0.5 */
    float sheen_roughness;   /* perceptual, 0..1 */
    float anisotropy; /* 0..1: alpha along the grain is mix(alpha, 1, anisotropy^2) */
    float anisotropy_rotation; /* 0..2 pi: direction of the grain, from +u to +y of normal maps */
    /* With IS_TINTED, without metal: refraction of the background by a volume. */
    float thickness; /* of the volume below the surface, object space: 0..65504; 0: no refraction */
    float ior;       /* index of refraction, 1..1000; 0 if thickness is 0 */
    float depth_bias; /* -0.01..0.01: drawn nearer by this fraction of its view depth */
} masu_blob_material;

/* Appearance, by viewing angle, of surface detail too small for polygons: the curves of
 * shaders/brdf/meso.glsl, fitted by masu-meso. Each curve has three coefficients; all values are
 * within +-1000. */
typedef struct masu_blob_meso {
    float tilt[3], facet;       /* tilt of the normal towards the camera; facet roughness, 0..1 */
    float roughness[3], spread; /* change of roughness; diffuse loss by normal spread */
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
    /* Flags, in addition to the type. */
    MASU_LIGHT_NO_SHADOW = 0x100,
    MASU_LIGHT_TWO_SIDED = 0x200, /* rectangle */
    MASU_LIGHT_SURFACE = 0x400    /* emitted by a surface of the scene; not for points and spots */
};

/* A local light. At distance d, a white surface that faces a point light has the radiance color /
 * d^2, times a window function that falls to 0 at `range`. */
typedef struct masu_blob_light {
    float position[3]; /* world space, or object space of the parent */
    float range;       /* metres, 0..1e15; 0: the light is off */
    float color[3];    /* 0..1e9; points and spots: radiant intensity / pi, others: radiance */
    float radius;      /* of the source, 1e-6..1e9 metres */
    float direction[3]; /* spots: unit direction of the light; capsule, rectangle: half axis */
    uint32_t type;      /* masu_blob_light_type, and flags */
    float inner;        /* spots: full intensity within this angle, radians, */
    float outer;        /* 0 beyond this one; 0 <= inner <= outer <= pi. Points: both 0 */
    uint32_t parent;    /* instance that the light moves with, or MASU_BLOB_NONE */
    uint32_t name;
    float half_axis[3]; /* rectangle */
    uint32_t reserved;  /* 0 */
} masu_blob_light;

#define MASU_BLOB_LIGHTS_MAX 4096u

/* Transparent surfaces are drawn one by one: one item per primitive with a transparent material and
 * instance of its mesh. */
#define MASU_TRANSPARENTS_MAX 4096u       /* items of a scene */
#define MASU_TRANSPARENT_SETS_MAX 64u     /* texture sets that they use */
#define MASU_TRANSPARENT_DRAWS_MAX 65536u /* the product of both */
#define MASU_PROBE_SUNS_MAX 16u
#define MASU_PROBE_SETS_MAX 26u
/* 32-bit values of one set: 27 halfs, RGB of each coefficient; then, in the first set only,
 * the probe's confidence, 0..1 */
#define MASU_PROBE_WORDS 14u
#define MASU_PROBE_LIT_WORDS 12u /* of a probe lit for a frame; not in blobs */
/* Live probe, not in blobs either: its mean, laid out like a lit probe, and sixteen sums. */
#define MASU_PROBE_LIVE_WORDS (MASU_PROBE_LIT_WORDS + 16u * MASU_PROBE_WORDS)
#define MASU_PROBE_COUNT_MAX 262144u
#define MASU_PROBE_BYTES_MAX ((uint64_t)64 << 20)
#define MASU_PROBE_VISIBILITY_MAX 16u

/* A grid of light probes: the irradiance / pi at each probe as a linear response to the sky and the
 * sun. Layout of the data, in 32-bit values: for each probe (x fastest, z slowest) its sets; then
 * for each probe its distance map of (visibility + 2)^2 values: mean and mean square, 16 bits each,
 * in units of 1.5 and 2.25 cell diagonals. Sets: sky_sets sets, one per spherical harmonic of sky
 * radiance; one for emissive surfaces, if there are any; then one for the light reflected by
 * surfaces under each of `suns` suns of irradiance pi. */
typedef struct masu_blob_probes {
    float origin[3]; /* of the first probe */
    float bias;      /* metres by which shading points are offset along the normal */
    float spacing[3]; /* metres */
    float reserved0;
    uint32_t counts[3];  /* the product is at most MASU_PROBE_COUNT_MAX */
    uint32_t sky_sets;   /* 1, 4 or 9; with live also 0, then with one emission set, all 0 */
    uint32_t suns;       /* 0..MASU_PROBE_SUNS_MAX */
    uint32_t emissive;   /* 0 or 1 */
    uint32_t visibility; /* texels along an edge of a distance map; 0: no maps */
    uint32_t live;       /* 1: rays traced each frame add the light that is not baked */
    float sun_direction[MASU_PROBE_SUNS_MAX][4]; /* towards the sun, unit length; unused ones 0 */
    /* inverse of the matrix 1 - angle / pi */
    float sun_inverse[MASU_PROBE_SUNS_MAX][MASU_PROBE_SUNS_MAX];
} masu_blob_probes;

/* 32-bit values of PROBE_DATA for one probe. */
static inline uint32_t masu_probe_words(const masu_blob_probes *p) {
    uint32_t map = p->visibility ? (p->visibility + 2) * (p->visibility + 2) : 0;
    return (p->sky_sets + p->emissive + p->suns) * MASU_PROBE_WORDS + map;
}

static inline uint32_t masu_probe_sets(const masu_blob_probes *p) {
    return p->sky_sets + p->emissive + p->suns;
}

/* Sky radiance, octahedral mapping, +y at the centre. ENVIRONMENT_TEXELS holds mips of size, size /
 * 2, ... texels along an edge, row by row. A texel has 9 bits each of r, g, b and a shared 5-bit
 * exponent (VK_FORMAT_E5B9G9R9_UFLOAT_PACK32). Mip m is prefiltered for reflections of roughness m
 * / (mips - 1). */
typedef struct masu_blob_environment_map {
    uint32_t size; /* a power of two, 8..1024 */
    uint32_t mips; /* 2..8, the smallest at least 4 texels */
    uint32_t reserved[2];
    /* rgb: irradiance / pi as a function of the normal, order 2. Fourth component: 0 to 2: colour
     * of a lobe (shared/sky.h), >= 0; 3 to 5: its direction, of length up to 1; 6 to 8: colour of
     * the Legendre polynomial P4 of y */
    float sh[9][4];
} masu_blob_environment_map;

/* An array texture of one format and size. Texels: layer by layer, each with its mip chain from the
 * largest mip on, each mip's blocks row by row; a mip has ceil(size / 4) blocks per axis. */
typedef struct masu_blob_texture {
    uint32_t format; /* masu_blob_texture_format */
    uint32_t width;  /* 1..4096, of mip 0; mip m has max(1, width >> m) */
    uint32_t height;
    uint32_t mips;   /* 1..floor(log2(larger side)) + 1 */
    uint32_t layers; /* 1..256 */
    uint32_t name;
    uint64_t offset; /* bytes into TEXELS: the end of the previous texture, rounded up to 16 */
} masu_blob_texture;

/* The textures that a draw binds: one per slot, or MASU_BLOB_NONE. */
typedef struct masu_blob_texture_set {
    uint32_t texture[MASU_SLOT_COUNT];
    uint32_t wrap[2]; /* u, v: 0 repeat, 1 clamp, 2 mirror; first + 4: nearest magnification */
} masu_blob_texture_set;

/* Traced reflections; present with TRACE_NODES, TRACE_SDF_SPIRV or both. */
typedef struct masu_blob_reflections {
    float cutoff;    /* perceptual roughness from which on nothing is traced, 0..1 */
    float distance;  /* maximum ray length, metres, 1e-3..1e9 */
    float glossiest; /* lowest perceptual roughness of any surface or coat, 0..1 */
    uint32_t reserved;
} masu_blob_reflections;

/* A low-resolution texture that is sampled at ray hits: a copy of a layer of TEXTURES, with at most
 * MASU_TRACE_TEXTURE_MAX texels per side. A texel holds the square roots of linear red, green and
 * blue, then alpha, 8 bits each, red in the lowest byte. Mips follow one another, each half the
 * size, the last 1x1. For roughness (red) and metallic (green) only the last texel, the mean, is
 * used. Sorted by texture, then layer. */
#define MASU_TRACE_TEXTURE_MAX 256u
typedef struct masu_blob_trace_texture {
    uint32_t texture, layer;
    uint32_t width, height;
    uint32_t first; /* index into TRACE_TEXELS: the end of the previous one */
    uint32_t reserved;
} masu_blob_trace_texture;

/* Number of texels of all mips. */
static inline uint64_t masu_blob_trace_texels(uint32_t width, uint32_t height) {
    uint64_t texels = 0;
    for (uint32_t m = 0; m < 9; m++) {
        uint32_t w = width >> m ? width >> m : 1, h = height >> m ? height >> m : 1;
        texels += (uint64_t)w * h;
        if (w == 1 && h == 1) break;
    }
    return texels;
}

/* A node of a BVH over the triangles of a mesh, or over the instances of a frame
 * (src/scene/trace.h), with up to four children. Child i extends along axis k from origin[k] +
 * low[k] 2^(e - 127) to origin[k] + high[k] 2^(e - 127), with byte i of low[k] and high[k], and e
 * byte k of `packed`: a quantised box that contains the exact one. Byte 3 of `packed` holds the
 * children's types, 2 bits each: 0 none, 1 node, 2 leaf of one item, 3 leaf of two items. Nodes
 * precede leaves. Child nodes are contiguous from `child`, items from `item`. */
typedef struct masu_blob_trace_node {
    float origin[3];
    uint32_t packed;
    uint32_t low[3];
    uint32_t high[3];
    uint32_t child; /* index into TRACE_NODES, over all meshes */
    uint32_t item;  /* index into TRACE_TRIANGLES, over all meshes */
} masu_blob_trace_node;

typedef struct masu_blob_trace_triangle {
    uint32_t vertex[3]; /* of VERTICES */
    uint32_t primitive; /* of PRIMITIVES */
} masu_blob_trace_triangle;

/* The BVH of a mesh; without nodes the mesh is not traced. The nodes are in the order of a
 * depth-first traversal that allocates the children of a node contiguously when it visits the node;
 * so are the triangles. */
typedef struct masu_blob_trace_mesh {
    uint32_t first_node, node_count;
    uint32_t first_triangle, triangle_count;
    uint32_t depth; /* levels of nodes, at most MASU_TRACE_DEPTH_MAX */
    uint32_t reserved;
} masu_blob_trace_mesh;

/* Also in shaders/shared/masu_shared.h. */
#define MASU_TRACE_DEPTH_MAX 28u
#define MASU_TRACE_NODES_MAX (1u << 24)
#define MASU_TRACE_INSTANCES_MAX (1u << 20)
#define MASU_TRACE_REACH 1e15f /* largest absolute coordinate of a box */

static inline uint32_t masu_trace_type(const masu_blob_trace_node *node, uint32_t slot) {
    return node->packed >> (24 + 2 * slot) & 3u;
}

/* A key of the camera path. Keys have ascending times. Position and target are interpolated
 * linearly, and hold outside the first and last key. Up is +Y. */
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
    float metered; /* 1: exposure is a factor on the metered exposure; 0: it is the exposure */
    float sky_zenith[3];
    float brighten; /* adaptation speed to a darker image, 0..1e6 1/s, */
    float sky_horizon[3];
    float turbidity;        /* 0: constant sky, the two colours above; 1.5..10: analytic sky */
    float ground[3];        /* ground albedo of the analytic sky, 0..1 */
    float occlusion_radius; /* of screen-space ambient occlusion, metres; 0: none */
    float fog_color[3];     /* radiance of dense fog; all zero: that of the sky at the horizon */
    float fog_density;  /* at fog_height, 1/m; 0: no fog */
    float fog_height;   /* m */
    float fog_falloff; /* >= 0, 1/m: density falls by e over 1 / fog_falloff metres of height */
    float fog_start;    /* >= 0, m: distance without fog */
    float darken;       /* and to a brighter one; 0: the default */
    float smooth_edges; /* 1: the default anti-aliasing is SMAA; 0: none */
    float reserved[3];
} masu_blob_environment;

/* The sun's shadow map; only in scenes with instances. Without it, polygons cast no sun shadow. */
typedef struct masu_blob_shadow {
    uint32_t cascades;   /* 1..MASU_SHADOW_CASCADES_MAX */
    uint32_t resolution; /* texels along an edge of a cascade, MASU_SHADOW_SIZE_MIN.._MAX */
    float distance;      /* view depth where shadows end, metres, 1e-3..1e9 */
    float lambda;        /* split of the cascades: 0 uniform, 1 logarithmic */
} masu_blob_shadow;

#define MASU_SHADOW_CASCADES_MAX 4u
#define MASU_SHADOW_SIZE_MIN 16u
#define MASU_SHADOW_SIZE_MAX 8192u

#define MASU_SDF_ANCHORED 1u /* the update SPIR-V moves the SDF's space to frame.anchor */
#define MASU_SDF_TIMELESS 2u /* neither the field nor its surfaces depend on time */

typedef struct masu_blob_sdf {
    float bounds_min[3]; /* world space; the SDF has no surface outside */
    float lipschitz;     /* >= 1e-3: |f(p)-f(q)| <= lipschitz |p-q| */
    float bounds_max[3];
    float max_distance; /* maximum ray length, > 0 */
    uint32_t has_raster; /* 1: the code reads the raster depth (the scene has instances) */
    uint32_t part_count; /* 1..4096 */
    uint32_t flags;       /* MASU_SDF_ANCHORED, MASU_SDF_TIMELESS */
    uint32_t block_words; /* 32-bit term masks in the tile buffer, per 4x4 block of pixels: 0..2 */
} masu_blob_sdf;

typedef struct masu_blob_sdf_param {
    float value; /* default */
    float minimum;
    float maximum;
    uint32_t name;
} masu_blob_sdf_param;

/* Bytes per block of a format; 0: unknown format. */
static inline uint32_t masu_blob_block_bytes(uint32_t format) {
    if (format == MASU_TEXTURE_BC1_SRGB || format == MASU_TEXTURE_BC4) return 8;
    return format == MASU_TEXTURE_BC3_SRGB || format == MASU_TEXTURE_BC5 ? 16 : 0;
}

static inline uint32_t masu_blob_mip_size(uint32_t size, uint32_t mip) {
    return size >> mip ? size >> mip : 1;
}

/* Bytes of all layers and mips, without padding at the end. */
static inline uint64_t masu_blob_texture_bytes(const masu_blob_texture *t) {
    uint64_t blocks = 0;
    for (uint32_t m = 0; m < t->mips && m < 32; m++) {
        blocks += (uint64_t)((masu_blob_mip_size(t->width, m) + 3) / 4) *
                  ((masu_blob_mip_size(t->height, m) + 3) / 4);
    }
    return blocks * masu_blob_block_bytes(t->format) * t->layers;
}

/* Number of texels of all mips of an environment map. */
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
_Static_assert(sizeof(masu_blob_material) == 128, "blob material");
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

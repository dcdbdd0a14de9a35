/* masu_knobs.h: what can be turned and what is counted: the knobs of a rung and the limits of a scene, each a row of a
 * table that fields, files, the command line and docs/knobs.md are made of. A part of masu.h, which includes it; the
 * knobs that only studies and ladders turn are in masu_study.h. */
#ifndef MASU_H
#error "masu_knobs.h is a part of masu.h: include that"
#endif
#ifndef MASU_KNOBS_PART_H
#define MASU_KNOBS_PART_H

/* Words that a knob can be set to: enumerator, value, its name in ladder.json, in suites and on the
 * command line, what it means. */
#define MASU_SWITCH_WORDS(X)                                                                       \
    X(MASU_AUTO, 0, "auto", "as the knob says")                                                    \
    X(MASU_OFF, 1, "off", "")                                                                      \
    X(MASU_ON, 2, "on", "")

/* How the picture is upscaled. */
#define MASU_EASU_WORDS(X)                                                                         \
    X(MASU_EASU_AUTO, 0, "auto", "full")                                                           \
    X(MASU_EASU_FULL, 1, "full", "FSR1's EASU as AMD published it")                                \
    X(MASU_EASU_FAST, 2, "fast",                                                                   \
      "edges are looked for once instead of four times, and where the four texels around a pixel"  \
      " differ by at most 1/255 their bilinear mean is taken, which is within 1/255 of full"       \
      " (errors elsewhere: docs/design/29-fsr1.md)")                                                       \
    X(MASU_EASU_BILINEAR, 3, "bilinear", "the four texels around, for comparison")

/* Anti-aliasing of the shaded picture, before it is upscaled. All blend linear colour. */
#define MASU_AA_WORDS(X)                                                                           \
    X(MASU_AA_AUTO, 0, "auto", "off")                                                              \
    X(MASU_AA_OFF, 1, "off", "")                                                                   \
    X(MASU_AA_FXAA, 2, "fxaa", "one pass that looks at the nearest pixels alone")                  \
    X(MASU_AA_SMAA_LOW, 3, "smaa-low",                                                             \
      "SMAA 1x: edges from a contrast of 0.15 on, followed for 8 pixels")                          \
    X(MASU_AA_SMAA_MEDIUM, 4, "smaa-medium", "from 0.1 on, for 16 pixels")                         \
    X(MASU_AA_SMAA_HIGH, 5, "smaa-high", "from 0.1 on, for 32 pixels; diagonals and corners too")  \
    X(MASU_AA_SMAA_ULTRA, 6, "smaa-ultra", "from 0.05 on, for 64 pixels; diagonals and corners too")

#define MASU_WORD_ENUM(name, value, word, text) name = value,
typedef enum masu_switch { MASU_SWITCH_WORDS(MASU_WORD_ENUM) } masu_switch;
typedef enum masu_easu { MASU_EASU_WORDS(MASU_WORD_ENUM) } masu_easu;
typedef enum masu_aa { MASU_AA_WORDS(MASU_WORD_ENUM) } masu_aa;

/* A number for each cascade. */
typedef uint32_t masu_per_cascade[MASU_MAX_CASCADES];

/* What a knob takes to change anything: name, where it is so, and what is said where it is not. */
#define MASU_KNOB_USES(X)                                                                          \
    X(ALWAYS, "everywhere", "")                                                                    \
    X(UPSCALED, "rungs that upscale", "nothing is upscaled")                                       \
    X(SHARPEN, "rungs that would sharpen, or do", "nothing is sharpened")                          \
    X(SHARPENED, "rungs that sharpen", "nothing is sharpened")                                     \
    X(SDF, "scenes with an SDF", "the scene has no SDF")                                           \
    X(POLYGONS, "scenes with polygons", "the scene has no polygons")                               \
    X(OCCLUDERS, "scenes with occluders", "the scene has no occluders")                            \
    X(LODS, "scenes whose meshes have LODs", "the scene's meshes have no LODs")           \
    X(AO, "scenes with ambient occlusion in screen space",                                         \
      "the scene asks for no ambient occlusion")                                                   \
    X(SHADOWS, "scenes with a shadow map", "the scene has no shadow map")                          \
    X(LIGHTS, "scenes with punctual lights", "the scene has no punctual lights")                      \
    X(SPECULAR, "scenes with traced reflections", "no reflections are traced")

typedef enum masu_knob_use {
#define MASU_KNOB_USE_ENUM(name, where, missing) MASU_USE_##name,
    MASU_KNOB_USES(MASU_KNOB_USE_ENUM)
#undef MASU_KNOB_USE_ENUM
} masu_knob_use;

/* Every knob of a rung: a row each, in this order in masu_rung, in names of settings, in files and
 * tables. A row is all that a new knob takes; `make docs-tables` then writes docs/knobs.md anew.
 * Below its columns stand what the knob does and what it costs.
 *
 * 0 is always accepted. It becomes the value of its column; where that is 0 too, or the text says so, the text states the rule. All
 * other numbers are within min and max. WORD accepts the values of its enum, of which 0 is AUTO. A switch that is resolved by its column
 * and is of use wherever its `use` says so needs nothing but its row: passes read it as n->on.NAME and n->any.NAME (src/plan/frame.h).
 * The rules of other switches are in src/plan/desc.c. */
/* clang-format off */
#define MASU_PRODUCT_KNOBS(NUMBER, WORD)                                                           \
    /*     type              name                  min   max   0 is  of use in  unit          */   \
    /*     type              name                  AUTO is         of use in                  */   \
    /* Size and upscaling. Render size is in pixels per axis; all that is shaded has it. */        \
    NUMBER(float,            scale,                0,    1,    1,    ALWAYS,    "",                \
           "Render size / output size, per axis. Ignored with a source image.",                    \
           "Time of the passes before upscaling, and their images, grow with its square.")         \
    WORD(  masu_switch,      upscale,              MASU_AUTO,      UPSCALED,                       \
           "EASU. AUTO: where the render size differs from the output size. OFF is an error"       \
           " there.",                                                                              \
           "A pass of the output size.")                                                           \
    WORD(  masu_easu,        easu,                 MASU_EASU_FULL, UPSCALED,                       \
           "How the picture is upscaled. AUTO: full.",                                             \
           "Full takes the most time, then fast, then bilinear.")                                  \
    WORD(  masu_switch,      sharpen,              MASU_AUTO,      SHARPEN,                        \
           "RCAS. AUTO: where EASU runs, full or fast; not after bilinear.",                       \
           "A pass of the output size.")                                                           \
    NUMBER(float,            sharpness,            -1,   64,   0.2,  SHARPENED, "stops",           \
           "How much less RCAS sharpens: each stop halves it (AMD's definition). Below 0: no stop," \
           " the sharpest.",                                                                       \
           "None.")                                                                                \
    WORD(  masu_aa,          aa,                   MASU_AA_OFF,    ALWAYS,                         \
           "Anti-aliasing, before upscaling. AUTO: off.",                                          \
           "Device bytes per pixel of the render size: SMAA 4.5, FXAA 4, of which other images"    \
           " may share all but SMAA's last 0.5. SMAA takes two passes, of which a picture"         \
           " without edges costs the first; FXAA takes one.")                                      \
    WORD(  masu_switch,      temporal,             MASU_AUTO,      ALWAYS,                         \
           "Anti-aliasing and upscaling over frames, in place of aa, EASU and RCAS (RCAS where"    \
           " sharpen is on): each frame looks at another place in its pixels. Scenes alone. AUTO:" \
           " on with a governor, at most one viewport and no split but AFTER_UPSCALE, in rungs that" \
           " leave upscale, easu, sharpen and aa at AUTO; else off.",                        \
           "A pass of the output size, two of the render size. Device bytes that outlive the frame: 16 per" \
           " pixel of the output, 4 of the render size; that do not: 8 of the render size, and"    \
           " velocities, 8.")                                                                      \
    /* Geometry. */                                                                                \
    WORD(  masu_switch,      silhouettes,          MASU_OFF,       SDF,                            \
           "Smooth silhouettes of the SDF: pixels in which something of it ends are the mean of four" \
           " samples. AUTO: off.",                                                                 \
           "Up to three rays more at such pixels, at 1920x1080 a tenth to all of the march together;" \
           " 4 to 8 device bytes per pixel of the render size.")                                  \
    NUMBER(uint32_t,         march_steps,          1,    2048, 2048, SDF,       "steps",           \
           "Most SDF steps per ray. A ray that uses them up ends where it is.",                    \
           "Time of rays that graze surfaces: the more, the longer.")                              \
    NUMBER(float,            lod_error,            -1e9, 1e9,  1,    LODS,      "pixels",          \
           "How far, at the render size, a surface may be from its place where an LOD of its"      \
           " mesh is drawn. Below 0: the finest form alone.",                                      \
           "Triangles: the larger, the fewer.")                                                    \
    /* Ambient occlusion in screen space, at half the render size. */                              \
    WORD(  masu_switch,      ao,                   MASU_ON,        AO,                             \
           "Ambient occlusion in screen space. AUTO: on.",                                         \
           "2 * slices * steps samples per texel of half the render size.")                        \
    NUMBER(uint32_t,         ao_slices,            1,    8,    2,    AO,        "",                \
           "Directions that are looked along.",                                                    \
           "Samples grow with it.")                                                                \
    NUMBER(uint32_t,         ao_steps,             1,    16,   8,    AO,        "",                \
           "Samples on either side of a slice.",                                                   \
           "Samples grow with it.")                                                                \
    /* The sun's shadow map. A rung that asks for more than the scene has gets what it has. */     \
    NUMBER(uint32_t,         shadow_cascades,      1,    4,    0,    SHADOWS,   "",                \
           "Cascades. 0: the scene's.",                                                            \
           "A pass each, and its part of the map.")                                                \
    NUMBER(uint32_t,         shadow_resolution,    16,   8192, 0,    SHADOWS,   "texels",          \
           "Along an edge of a cascade. 0: the scene's.",                                          \
           "4 n^2 device bytes for each cascade.")                                                 \
    NUMBER(float,            shadow_distance,      0,    1e9,  0,    SHADOWS,   "m",               \
           "View depth where shadows end. 0: the scene's.",                                        \
           "Instances in the cascades: the farther, the more.")                                    \
    NUMBER(masu_per_cascade, shadow_refresh,       1,    64,   1,    SHADOWS,   "frames",          \
           "Each cascade is drawn anew every so many frames, and at once after a cut or when the"  \
           " view has left it. In between, what moves leaves its shadow behind.",                  \
           "Saves draws. Any above 1 keeps the map's memory from being shared with other images"   \
           " and doubles the rung's recordings.")                                                  \
    /* Traced reflections, at half the render size: one ray per 2x2 pixels, then filters. */       \
    WORD(  masu_switch,      specular,             MASU_AUTO,      SPECULAR,                       \
           "Traced reflections. AUTO: on, if a surface is glossy enough and the device has the"    \
           " storage buffers for it.",                                                             \
           "The rays, and the passes and images of all that follows.")                             \
    NUMBER(float,            specular_cutoff,      0,    1,    0,    SPECULAR,  "",                \
           "Perceptual roughness from which surfaces reflect the sky or the probes instead; both"  \
           " are blended from 3/4 of it on. 0: the scene's.",                                      \
           "Pixels that trace: the higher, the more.")                                             \
    NUMBER(uint32_t,         specular_frames,      1,    240,  32,   SPECULAR,  "frames",          \
           "How far back the reflections' own mean reaches, in frames of 1/60 s. 0: 32, or 8"       \
           " with temporal, which takes a mean over frames itself.",                               \
           "None.")
/* clang-format on */

#include "masu_study.h"
#undef MASU_WORD_ENUM

/* All of them, in order. */
#define MASU_KNOBS(NUMBER, WORD)                                                                   \
    MASU_PRODUCT_KNOBS(NUMBER, WORD)                                                               \
    MASU_STUDY_KNOBS(NUMBER, WORD)

/* One rung of the quality ladder: a setting of all knobs. Each is recorded once and may be chosen
 * freshly every frame. All zero: the size of the output, all that the scene has use for, no
 * anti-aliasing. */
typedef struct masu_rung {
#define MASU_KNOB_FIELD(type, name, ...) type name;
    MASU_KNOBS(MASU_KNOB_FIELD, MASU_KNOB_FIELD)
#undef MASU_KNOB_FIELD
} masu_rung;

/* The same as data, for settings menus and files. */
typedef struct masu_word {
    const char *word; /* "smaa-high" */
    const char *name; /* of the enumerator, "MASU_AA_SMAA_HIGH" */
    const char *text; /* may be empty */
    uint32_t value;
} masu_word;

typedef enum masu_knob_kind {
    MASU_KNOB_FLOAT = 0,
    MASU_KNOB_COUNT = 1, /* a uint32_t */
    MASU_KNOB_WORD = 2   /* an enum: its value is the place in `words` */
} masu_knob_kind;

typedef struct masu_knob {
    const char *name; /* of the field of masu_rung */
    masu_knob_kind kind;
    uint32_t offset;       /* of the field, bytes */
    uint32_t values;       /* of 4 bytes each: 1, or one for each cascade */
    double min, max, zero; /* the row's; of a WORD the first, the last, and what AUTO is: 0 where that depends */
    masu_knob_use use;
    const char *where;   /* "scenes with an SDF" */
    const char *missing; /* "the scene has no SDF" */
    const char *unit;    /* may be empty */
    const char *text, *cost;
    const masu_word *words; /* of a WORD, by value; else NULL */
    uint32_t word_count;
} masu_knob;

/* All of them, in order; behind the last one a row whose name is NULL. Constant. */
MASU_API const masu_knob *masu_knob_table(void);

/* One of a knob's values, 0 .. values - 1, and how it is changed, which checks no range. A value
 * that is not there is 0 and cannot be set. */
MASU_API double masu_knob_get(const masu_knob *knob, const masu_rung *rung, uint32_t value);
MASU_API void masu_knob_set(const masu_knob *knob, masu_rung *rung, uint32_t value, double to);

/* 1: masu_init takes it: 0, or within min and max; of a COUNT or WORD whole numbers alone. */
MASU_API int masu_knob_takes(const masu_knob *knob, double to);

/* How much of each thing a scene may have: a row each. Name, the maximum of any scene (0: what a
 * blob holds), what each costs.
 *
 * Memory is sized by what the scene has: a limit is a promise to the port that no scene of its own
 * will need more. masu_peaks() returns what is used under the same names. */
#define MASU_LIMITS(X)                                                                             \
    X(vertices, 0, "16 bytes each, device")                                                        \
    X(indices, 0, "4 bytes each, device")                                                          \
    X(materials, 0, "48 bytes each, device")                                                       \
    X(instances, 0,                                                                                \
      "52 bytes each per frame in flight, device, and 98 bytes each, host; with velocities 100"    \
      " and 146. With occlusion 32 more on the device, 4 once, and 8 for each of its occluders;"   \
      " with a shadow map for each cascade 4 more, with occlusion 12 and 4 once. With LODs 1 more" \
      " on the host, and on the device for each LOD of its mesh and each view 4 (8 with"           \
      " occlusion)")                                                                               \
    X(models, 0,                                                                                   \
      "that move as one, hidden and spare ones too: 72 bytes each, host, and 4 for each instance " \
      "of the scene")                                                                              \
    X(model_nodes, 0, "of all models: 112 bytes each, host")                                       \
    X(sdf_params, MASU_MAX_SDF_PARAMS, "16 bytes each, host")                                      \
    X(shadow_cascades, MASU_MAX_CASCADES, "of the shadow map, as the largest rung has it")         \
    X(shadow_resolution, 8192, "texels along an edge of a cascade; n take 4 n^2 bytes, device")    \
    X(probes, 0,                                                                                   \
      "light probes: 48 bytes each, 56 more for each set, and its map of distances; device")       \
    X(textures, 0, "pictures with their mip chains; texture_bytes has their cost")                 \
    X(texture_bytes, 0,                                                                            \
      "of texels on the device, as blocks or decoded, whichever is used; the device may add"       \
      " padding")                                                                                  \
    /* Nor more than 65536 times their texture sets, of which there are at most 64. */             \
    X(transparents, 4096,                                                                          \
      "blended primitives, counted for each instance: 76 bytes each, host; 24, and 20 for each"    \
      " texture set of theirs, per frame in flight, device")                                       \
    X(lights, 4096,                                                                                \
      "punctual lights: 80 bytes each per frame in flight, device, and 80 bytes each, host")       \
    X(trace_triangles, 0,                                                                          \
      "that rays meet: 16 bytes each, and for each about a quarter of a node of 48, device")       \
    X(trace_instances, 0,                                                                          \
      "that rays meet: 208 bytes each per frame in flight, device, and about 200 bytes each, host")

#define MASU_LIMIT_FIELD(name, ...) uint64_t name;

/* 0: no limit. A scene that needs more is refused with MASU_ERROR_LIMIT, which names the field. */
typedef struct masu_limits {
    MASU_LIMITS(MASU_LIMIT_FIELD)
} masu_limits;

typedef struct masu_peak_info {
    MASU_LIMITS(MASU_LIMIT_FIELD)
    uint64_t host_bytes;   /* of the host block */
    uint64_t device_bytes; /* of all device blocks */
} masu_peak_info;
#undef MASU_LIMIT_FIELD

/* The same as data. */
typedef struct masu_limit {
    const char *name; /* of the field of masu_limits and masu_peak_info */
    uint32_t offset;  /* in both, bytes */
    uint64_t max;     /* of any scene; 0: none */
    const char *text;
} masu_limit;

/* All of them, in order; behind the last one a row whose name is NULL. Constant. */
MASU_API const masu_limit *masu_limit_table(void);

#endif

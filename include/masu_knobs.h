/* masu_knobs.h: the quality settings (knobs) of a rung and the limits of a scene. Each one is a row
 * of a table, from which the struct members, the file formats, the command line and docs/knobs.md
 * are generated. Part of masu.h, which includes it. Settings for studies only are in masu_study.h.
 * */
#ifndef MASU_H
#error "masu_knobs.h is a part of masu.h: include that"
#endif
#ifndef MASU_KNOBS_PART_H
#define MASU_KNOBS_PART_H

/* Enum values of knobs. Columns: enumerator, value, name in ladder.json, in suites and on the
 * command line, meaning. */
#define MASU_SWITCH_WORDS(X)                                                                       \
    X(MASU_AUTO, 0, "auto", "the default of the knob")                                             \
    X(MASU_OFF, 1, "off", "")                                                                      \
    X(MASU_ON, 2, "on", "")

/* Upscaling filters. */
#define MASU_EASU_WORDS(X)                                                                         \
    X(MASU_EASU_AUTO, 0, "auto", "selects full")                                                   \
    X(MASU_EASU_FULL, 1, "full", "EASU of FSR1 as AMD published it")                               \
    X(MASU_EASU_FAST, 2, "fast",                                                                   \
      "EASU that detects edges once instead of four times; if the four texels around a pixel"      \
      " differ by at most 1/255, it uses their bilinear average, which is within 1/255 of full"    \
      " (errors elsewhere: docs/design/15-fsr1.md)")                                               \
    X(MASU_EASU_BILINEAR, 3, "bilinear", "bilinear filter, for comparison")

/* Anti-aliasing filters. They run after shading and before upscaling, and blend linear colour. */
#define MASU_AA_WORDS(X)                                                                           \
    X(MASU_AA_AUTO, 0, "auto", "selects off")                                                      \
    X(MASU_AA_OFF, 1, "off", "")                                                                   \
    X(MASU_AA_FXAA, 2, "fxaa", "FXAA: one pass that samples adjacent pixels only")                 \
    X(MASU_AA_SMAA_LOW, 3, "smaa-low",                                                             \
      "SMAA 1x: edges with a contrast of 0.15 or more, searched for 8 pixels")                     \
    X(MASU_AA_SMAA_MEDIUM, 4, "smaa-medium",                                                       \
      "SMAA 1x: edges with a contrast of 0.1 or more, searched for 16 pixels")                     \
    X(MASU_AA_SMAA_HIGH, 5, "smaa-high",                                                           \
      "SMAA 1x: edges with a contrast of 0.1 or more, searched for 32 pixels, with diagonals"      \
      " and corners")                                                                              \
    X(MASU_AA_SMAA_ULTRA, 6, "smaa-ultra",                                                         \
      "SMAA 1x: edges with a contrast of 0.05 or more, searched for 64 pixels, with diagonals"     \
      " and corners")

/* written by make_structs.c: enums */
typedef enum masu_switch {
    /* the default of the knob */
    MASU_AUTO = 0,
    MASU_OFF = 1,
    MASU_ON = 2,
} masu_switch;

typedef enum masu_easu {
    /* selects full */
    MASU_EASU_AUTO = 0,
    /* EASU of FSR1 as AMD published it */
    MASU_EASU_FULL = 1,
    /* EASU that detects edges once instead of four times; if the four texels around a pixel
     * differ by at most 1/255, it uses their bilinear average, which is within 1/255 of full
     * (errors elsewhere: docs/design/15-fsr1.md) */
    MASU_EASU_FAST = 2,
    /* bilinear filter, for comparison */
    MASU_EASU_BILINEAR = 3,
} masu_easu;

typedef enum masu_aa {
    /* selects off */
    MASU_AA_AUTO = 0,
    MASU_AA_OFF = 1,
    /* FXAA: one pass that samples adjacent pixels only */
    MASU_AA_FXAA = 2,
    /* SMAA 1x: edges with a contrast of 0.15 or more, searched for 8 pixels */
    MASU_AA_SMAA_LOW = 3,
    /* SMAA 1x: edges with a contrast of 0.1 or more, searched for 16 pixels */
    MASU_AA_SMAA_MEDIUM = 4,
    /* SMAA 1x: edges with a contrast of 0.1 or more, searched for 32 pixels, with diagonals and
     * corners */
    MASU_AA_SMAA_HIGH = 5,
    /* SMAA 1x: edges with a contrast of 0.05 or more, searched for 64 pixels, with diagonals and
     * corners */
    MASU_AA_SMAA_ULTRA = 6,
} masu_aa;
/* end of what make_structs.c wrote */

/* One value per shadow cascade, the closest cascade first. */
typedef uint32_t masu_per_cascade[MASU_MAX_CASCADES];

/* Conditions under which a knob has an effect. Columns: name, the condition, the message if it does
 * not hold. */
#define MASU_KNOB_USES(X)                                                                          \
    X(ALWAYS, "everywhere", "")                                                                    \
    X(UPSCALED, "rungs that upscale", "nothing is upscaled")                                       \
    X(SHARPEN, "rungs that upscale by EASU or sharpen", "nothing is sharpened")                    \
    X(SHARPENED, "rungs that sharpen", "nothing is sharpened")                                     \
    X(SDF, "scenes with an SDF", "the scene has no SDF")                                           \
    X(POLYGONS, "scenes with polygons", "the scene has no polygons")                               \
    X(OCCLUDERS, "scenes with occluders", "the scene has no occluders")                            \
    X(LODS, "scenes with LODs of meshes", "the scene's meshes have no LODs")                       \
    X(AO, "scenes with screen-space ambient occlusion",                                            \
      "the scene has no screen-space ambient occlusion")                                           \
    X(SHADOWS, "scenes with a shadow map", "the scene has no shadow map")                          \
    X(LIGHTS, "scenes with punctual lights", "the scene has no punctual lights")                   \
    X(LOCAL_SHADOWS, "scenes with punctual lights that cast shadows",                              \
      "no punctual light of the scene casts shadows")                                              \
    X(SPECULAR, "scenes with traced reflections", "no reflections are traced")                     \
    X(BOUNCE, "scenes with a live bounce", "the scene has no live bounce")

typedef enum masu_knob_use {
#define MASU_KNOB_USE_ENUM(name, where, missing) MASU_USE_##name,
    MASU_KNOB_USES(MASU_KNOB_USE_ENUM)
#undef MASU_KNOB_USE_ENUM
} masu_knob_use;

/* The knobs of a rung. One row per knob, in the order of the members of masu_rung, of setting
 * names, files and tables. To add a knob, add a row; `make docs-tables` then regenerates masu_rung
 * below and docs/knobs.md. The two strings of a row are its description and its cost.
 *
 * NUMBER: `min` and `max` bound the value. 0 is always valid: it selects the default in the column
 * "0 is" unless the description defines another default; if that column is 0 too, the description
 * defines the meaning. WORD: the value is an enumerator of the type, and 0 is AUTO, which selects
 * the value in the column "AUTO is"; if that is MASU_AUTO too, src/plan/desc.c has the rule. A
 * switch whose AUTO and use are in its row needs no other code: passes read it as n->on.NAME and
 * n->any.NAME (src/plan/frame_plan.h). */
/* clang-format off */
#define MASU_PRODUCT_KNOBS(NUMBER, WORD)                                                           \
    /*     type              name                  min   max   0 is  of use in  unit          */   \
    /*     type              name                  AUTO is         of use in                  */   \
    /* Size and upscaling. All passes before upscaling run at the render size. */                  \
    NUMBER(float,            scale,                0,    1,    1,    ALWAYS,    "",                \
           "Render size / output size, per axis. Ignored with a source image.",                    \
           "Time and images of the passes before upscaling grow with its square.")                 \
    WORD(  masu_switch,      upscale,              MASU_AUTO,      UPSCALED,                       \
           "Upscaling by EASU or bilinear filter. AUTO: on if the render size differs from the"    \
           " output size; OFF is an error then.",                                                  \
           "One pass at the output size.")                                                         \
    WORD(  masu_easu,        easu,                 MASU_EASU_FULL, UPSCALED,                       \
           "Upscaling filter. AUTO: full.",                                                        \
           "Full takes the most time, then fast, then bilinear.")                                  \
    WORD(  masu_switch,      sharpen,              MASU_AUTO,      SHARPEN,                        \
           "Sharpening by RCAS. AUTO: on after EASU (full or fast), off after bilinear.",          \
           "One pass at the output size.")                                                         \
    NUMBER(float,            sharpness,            -1,   64,   0.2,  SHARPENED, "stops",           \
           "Reduction of RCAS sharpening: each stop halves it (AMD's definition). Below 0: no"     \
           " reduction, the strongest sharpening.",                                                \
           "None.")                                                                                \
    WORD(  masu_aa,          aa,                   MASU_AA_OFF,    ALWAYS,                         \
           "Anti-aliasing filter before upscaling. AUTO: off.",                                    \
           "SMAA: two passes, only the first if the image has no edges. FXAA: one pass. Device"    \
           " bytes per pixel of the render size: SMAA 4.5, of which 4 can be shared with other"    \
           " images; FXAA 4, all shareable.")                                                      \
    WORD(  masu_switch,      temporal,             MASU_AUTO,      ALWAYS,                         \
           "Temporal anti-aliasing and upscaling with a jittered camera. Replaces aa and EASU,"    \
           " and RCAS unless sharpen is on. Scenes only. AUTO: on with a governor, at most one"    \
           " viewport and no split except AFTER_UPSCALE, in rungs with upscale, easu, sharpen and" \
           " aa at AUTO; else off.",                                                               \
           "One pass at the output size, two at the render size. Persistent device bytes: 16 per"  \
           " pixel of the output, 4 per pixel of the render size. Transient device bytes: 16 per"  \
           " pixel of the render size, 8 of them for velocities.")                                 \
    /* Geometry. */                                                                                \
    WORD(  masu_switch,      silhouettes,          MASU_OFF,       SDF,                            \
           "SDF edge anti-aliasing: averages four samples in pixels that contain an edge of the"   \
           " SDF. AUTO: off.",                                                                     \
           "Up to three more rays in each such pixel: at 1920x1080 they take 0.1 to 1 times as"    \
           " long as all other sphere tracing. 4 to 8 device bytes per pixel of the render size.") \
    NUMBER(uint32_t,         march_steps,          1,    2048, 2048, SDF,       "steps",           \
           "Largest number of sphere-tracing steps per ray. A ray that reaches it ends at its"     \
           " current position.",                                                                   \
           "Time of rays at grazing angles grows with it.")                                        \
    NUMBER(float,            lod_error,            -1e9, 1e9,  1,    LODS,      "pixels",          \
           "Largest geometric error of an LOD on the screen, in pixels of the render size."        \
           " Below 0: always the full mesh.",                                                      \
           "Triangles: fewer with a larger error.")                                                \
    /* Screen-space ambient occlusion, at half the render size. */                                 \
    WORD(  masu_switch,      ao,                   MASU_ON,        AO,                             \
           "Screen-space ambient occlusion. AUTO: on.",                                            \
           "2 * ao_slices * ao_steps samples per texel at half the render size.")                  \
    NUMBER(uint32_t,         ao_slices,            1,    8,    2,    AO,        "",                \
           "Slices (directions) per texel of the ambient occlusion.",                              \
           "Samples grow in proportion.")                                                          \
    NUMBER(uint32_t,         ao_steps,             1,    16,   8,    AO,        "",                \
           "Samples on each of the two sides of a slice.",                                         \
           "Samples grow in proportion.")                                                          \
    /* The sun's shadow map. Values above those of the scene are reduced to the scene's. */        \
    NUMBER(uint32_t,         shadow_cascades,      1,    4,    0,    SHADOWS,   "",                \
           "Number of shadow cascades. 0: the scene's.",                                           \
           "One pass per cascade, and its part of the shadow map.")                                \
    NUMBER(uint32_t,         shadow_resolution,    16,   8192, 0,    SHADOWS,   "texels",          \
           "Width and height of a shadow cascade. 0: the scene's.",                                \
           "4 n^2 device bytes per cascade.")                                                      \
    NUMBER(float,            shadow_distance,      0,    1e9,  0,    SHADOWS,   "m",               \
           "View depth at which shadows end. 0: the scene's.",                                     \
           "More instances in the cascades with a larger distance.")                               \
    NUMBER(masu_per_cascade, shadow_refresh,       1,    64,   1,    SHADOWS,   "frames",          \
           "Interval at which each cascade is re-rendered; also after a cut, and when the view"    \
           " has moved out of the cascade. In between, moving shadows lag.",                       \
           "Saves draws. A value above 1 keeps the shadow map from sharing memory with other"      \
           " images; each cascade with one doubles the number of recordings of the rung.")         \
    /* Shadows of punctual lights: a cache of faces in one atlas. */                               \
    WORD(  masu_switch,      local_shadows,        MASU_ON,        LOCAL_SHADOWS,                  \
           "Shadows of punctual lights. AUTO: on.",                                                \
           "Per pixel and shadowed light up to 200 instructions; the faces that are rendered.")    \
    NUMBER(uint32_t,         local_shadow_atlas,   128,  4096, 2048, LOCAL_SHADOWS, "texels",      \
           "Largest width and height of the atlas of shadow faces, rounded down to a power of two;"\
           " smaller for few shadows. All rungs share the largest.",                               \
           "2 n^2 persistent device bytes.")                                                       \
    NUMBER(uint32_t,         local_shadow_lights,  1,    64,   16,   LOCAL_SHADOWS, "",            \
           "Largest number of punctual lights with shadows at a time, the most important ones.",   \
           "More faces to render when they change; smaller faces where the atlas is full.")        \
    NUMBER(uint32_t,         local_shadow_faces,   1,    16,   4,    LOCAL_SHADOWS, "faces",       \
           "Largest number of shadow faces rendered per frame: 1 for a spot, up to 6 for a point"  \
           " light. Faces that have to wait show what they held.",                                 \
           "The draws of each face; 1 MiB of transient device memory each.")                       \
    /* Traced reflections at half the render size: one ray per 2x2 pixels, then filters. */        \
    WORD(  masu_switch,      specular,             MASU_AUTO,      SPECULAR,                       \
           "Traced reflections. AUTO: on if a surface is glossy enough and the device allows"      \
           " enough storage buffers.",                                                             \
           "The rays, and the passes and images of the filters.")                                  \
    NUMBER(float,            specular_cutoff,      0,    1,    0,    SPECULAR,  "",                \
           "Perceptual roughness from which on surfaces reflect the sky or light probes and trace" \
           " no rays; between 3/4 of it and it, both are blended. 0: the scene's.",                \
           "More pixels trace rays with a higher cutoff.")                                         \
    NUMBER(uint32_t,         specular_frames,      1,    240,  32,   SPECULAR,  "frames",          \
           "Length of the temporal accumulation of reflections, in frames of 1/60 s. 0: 32, or 8"  \
           " with temporal.",                                                                      \
           "None.")                                                                                \
    /* Live bounce of diffuse light, by irradiance probes. */                                      \
    WORD(  masu_switch,      bounce,               MASU_AUTO,      BOUNCE,                         \
           "Live bounce: rays of some probes per frame. OFF: probes keep what they have. AUTO: on" \
           " if the device allows enough storage buffers.",                                        \
           "The rays, until the light has been at rest for 256 rounds of all probes; then none.")  \
    NUMBER(uint32_t,         bounce_probes,        1,    2048, 94,   BOUNCE,    "probes",          \
           "Probes that trace rays per frame. In the first frames up to four times as many do.",   \
           "Time grows in proportion. 128 device bytes for each of their rays, which a scene with" \
           " fewer probes does not take.")                                                         \
    NUMBER(uint32_t,         bounce_rays,          8,    64,   48,   BOUNCE,    "rays",            \
           "Rays of a probe per frame. A probe shows the mean of up to sixteen sets of rays.",    \
           "Time grows in proportion.")
/* clang-format on */

#include "masu_study.h"

/* All knobs, in order. */
#define MASU_KNOBS(NUMBER, WORD)                                                                   \
    MASU_PRODUCT_KNOBS(NUMBER, WORD)                                                               \
    MASU_STUDY_KNOBS(NUMBER, WORD)

/* One rung (quality level) of the quality ladder: a value for every knob. masu_init records the
 * command buffers of each rung; masu_frame_desc.rung selects one per frame. All zero: output size,
 * every feature of the scene, no anti-aliasing. */
/* written by make_structs.c: masu_rung */
typedef struct masu_rung {
    /* Render size / output size, per axis. Ignored with a source image. Range 0..1; 0: 1. */
    float scale;
    /* Upscaling by EASU or bilinear filter. AUTO: on if the render size differs from the output
     * size; OFF is an error then. */
    masu_switch upscale;
    /* Upscaling filter. AUTO: full. */
    masu_easu easu;
    /* Sharpening by RCAS. AUTO: on after EASU (full or fast), off after bilinear. */
    masu_switch sharpen;
    /* Reduction of RCAS sharpening: each stop halves it (AMD's definition). Below 0: no
     * reduction, the strongest sharpening. Range -1..64 stops; 0: 0.2. */
    float sharpness;
    /* Anti-aliasing filter before upscaling. AUTO: off. */
    masu_aa aa;
    /* Temporal anti-aliasing and upscaling with a jittered camera. Replaces aa and EASU, and
     * RCAS unless sharpen is on. Scenes only. AUTO: on with a governor, at most one viewport and
     * no split except AFTER_UPSCALE, in rungs with upscale, easu, sharpen and aa at AUTO; else
     * off. */
    masu_switch temporal;
    /* SDF edge anti-aliasing: averages four samples in pixels that contain an edge of the SDF.
     * AUTO: off. */
    masu_switch silhouettes;
    /* Largest number of sphere-tracing steps per ray. A ray that reaches it ends at its current
     * position. Range 1..2048 steps; 0: 2048. */
    uint32_t march_steps;
    /* Largest geometric error of an LOD on the screen, in pixels of the render size. Below 0:
     * always the full mesh. Range -1000000000..1000000000 pixels; 0: 1. */
    float lod_error;
    /* Screen-space ambient occlusion. AUTO: on. */
    masu_switch ao;
    /* Slices (directions) per texel of the ambient occlusion. Range 1..8; 0: 2. */
    uint32_t ao_slices;
    /* Samples on each of the two sides of a slice. Range 1..16; 0: 8. */
    uint32_t ao_steps;
    /* Number of shadow cascades. 0: the scene's. Range 1..4. */
    uint32_t shadow_cascades;
    /* Width and height of a shadow cascade. 0: the scene's. Range 16..8192 texels. */
    uint32_t shadow_resolution;
    /* View depth at which shadows end. 0: the scene's. Range 0..1000000000 m. */
    float shadow_distance;
    /* Interval at which each cascade is re-rendered; also after a cut, and when the view has
     * moved out of the cascade. In between, moving shadows lag. Range 1..64 frames; 0: 1. */
    masu_per_cascade shadow_refresh;
    /* Shadows of punctual lights. AUTO: on. */
    masu_switch local_shadows;
    /* Largest width and height of the atlas of shadow faces, rounded down to a power of two;
     * smaller for few shadows. All rungs share the largest. Range 128..4096 texels; 0: 2048. */
    uint32_t local_shadow_atlas;
    /* Largest number of punctual lights with shadows at a time, the most important ones. Range
     * 1..64; 0: 16. */
    uint32_t local_shadow_lights;
    /* Largest number of shadow faces rendered per frame: 1 for a spot, up to 6 for a point
     * light. Faces that have to wait show what they held. Range 1..16 faces; 0: 4. */
    uint32_t local_shadow_faces;
    /* Traced reflections. AUTO: on if a surface is glossy enough and the device allows enough
     * storage buffers. */
    masu_switch specular;
    /* Perceptual roughness from which on surfaces reflect the sky or light probes and trace no
     * rays; between 3/4 of it and it, both are blended. 0: the scene's. Range 0..1. */
    float specular_cutoff;
    /* Length of the temporal accumulation of reflections, in frames of 1/60 s. 0: 32, or 8 with
     * temporal. Range 1..240 frames; 0: 32. */
    uint32_t specular_frames;
    /* Live bounce: rays of some probes per frame. OFF: probes keep what they have. AUTO: on if
     * the device allows enough storage buffers. */
    masu_switch bounce;
    /* Probes that trace rays per frame. In the first frames up to four times as many do. Range
     * 1..2048 probes; 0: 94. */
    uint32_t bounce_probes;
    /* Rays of a probe per frame. A probe shows the mean of up to sixteen sets of rays. Range
     * 8..64 rays; 0: 48. */
    uint32_t bounce_rays;
    /* Frustum culling of instances; the image is the same. AUTO: on. */
    masu_switch frustum;
    /* Occlusion culling of instances; the image is the same. AUTO: on if the scene has
     * occluders. */
    masu_switch occlusion;
    /* Tiled light culling: each pixel evaluates the punctual lights of its 16x16 tile only; the
     * image is the same. AUTO: on if the scene has punctual lights. */
    masu_switch light_tiles;
#ifdef MASU_LAB
    /* How the SDF is marched. AUTO: the product's march. */
    masu_march march;
#endif
    /* Spatial reuse: each texel also weighs the ray hits of its neighbours while its history is
     * short. AUTO: on; off with temporal. */
    masu_switch specular_reuse;
    /* Temporal accumulation of reflections. AUTO: on. */
    masu_switch specular_temporal;
    /* Full-resolution history for smooth surfaces, and for 2x2 pixels with more than one
     * surface; requires specular_temporal. AUTO: on. */
    masu_switch specular_fine;
    /* Spatial filter whose radius follows the remaining noise. AUTO: on. */
    masu_switch specular_filter;
    /* Second, short temporal accumulation against flicker; requires specular_temporal. AUTO: on;
     * off with temporal. */
    masu_switch specular_taa;
    /* Neighbours per texel in specular_reuse. Range 1..16; 0: 8. */
    uint32_t specular_reuse_taps;
    /* Neighbours per texel in specular_filter. Range 1..32; 0: 12. */
    uint32_t specular_filter_taps;
} masu_rung;
/* end of what make_structs.c wrote */

/* The tables above as data, for settings menus and files. An enum value of a knob: */
typedef struct masu_word {
    const char *word; /* name in files and settings: "smaa-high" */
    const char *name; /* enumerator: "MASU_AA_SMAA_HIGH" */
    const char *text; /* meaning; may be empty */
    uint32_t value;
} masu_word;

typedef enum masu_knob_kind {
    MASU_KNOB_FLOAT = 0,
    MASU_KNOB_COUNT = 1, /* uint32_t */
    MASU_KNOB_WORD = 2   /* enum: the value is an index into `words` */
} masu_knob_kind;

typedef struct masu_knob {
    const char *name; /* of the member of masu_rung */
    masu_knob_kind kind;
    uint32_t offset;       /* of the member in masu_rung, bytes */
    uint32_t values;       /* 4 bytes each: 1, or MASU_MAX_CASCADES for a value per cascade */
    double min, max, zero; /* range and default; WORD: first and last value, AUTO */
    masu_knob_use use;
    const char *where;   /* condition of use: "scenes with an SDF" */
    const char *missing; /* message if the condition does not hold: "the scene has no SDF" */
    const char *unit;    /* may be empty */
    const char *text, *cost;
    const masu_word *words; /* WORD: the enum values, indexed by value. Else NULL */
    uint32_t word_count;
} masu_knob;

/* All knobs in order, terminated by a row whose name is NULL. Static. */
MASU_API const masu_knob *masu_knob_table(void);

/* Read and write value number `value`, 0 .. values - 1, of a knob in a rung. masu_knob_get returns
 * 0 if there is no such value, and masu_knob_set ignores it. masu_knob_set does not check the
 * range. */
MASU_API double masu_knob_get(const masu_knob *knob, const masu_rung *rung, uint32_t value);
MASU_API void masu_knob_set(const masu_knob *knob, masu_rung *rung, uint32_t value, double to);

/* 1 if masu_init accepts the value: 0, or a number from min to max, which must be an integer for
 * COUNT and WORD. */
MASU_API int masu_knob_accepts(const masu_knob *knob, double to);

/* Limits of a scene. Columns: name, the maximum for any scene (0: bounded by the blob format only),
 * cost per item.
 *
 * Memory is sized by the scene and not by its limits. With a limit, a port makes sure that none of
 * its scenes exceeds a budget. masu_peaks() returns the actual numbers under the same names. */
#define MASU_LIMITS(X)                                                                             \
    X(vertices, 0, "16 bytes each, device")                                                        \
    X(indices, 0, "4 bytes each, device")                                                          \
    X(materials, 0, "48 bytes each, device")                                                       \
    X(instances, 0,                                                                                \
      "98 bytes each, host, and 52 bytes each per frame in flight, device; with velocities 146"    \
      " and 100. With occlusion culling, on the device: 32 more, and 8 for each occluder of the"   \
      " instance, per frame in flight, and 4 once. With a shadow map, per cascade: 4 more; with"   \
      " occlusion culling 12, and 4 once. With LODs: 1 more on the host, and on the device 4 for"  \
      " each LOD of the mesh and each view (8 with occlusion culling)")                            \
    X(models, 0,                                                                                   \
      "movable models, including hidden and pooled copies: 72 bytes each, host, and 4 for each"    \
      " instance of the scene")                                                                    \
    X(model_nodes, 0, "nodes of all movable models: 112 bytes each, host")                         \
    X(sdf_params, MASU_MAX_SDF_PARAMS, "16 bytes each, host")                                      \
    X(shadow_cascades, MASU_MAX_CASCADES, "cascades of the shadow map in the largest rung")        \
    X(shadow_resolution, 8192, "width and height n of a cascade in texels: 4 n^2 bytes, device")   \
    X(probes, 0,                                                                                   \
      "light probes: 48 bytes each, 56 more for each set, and the distance map of each probe,"     \
      " device; live ones 944 more, and 2 on the host")                                            \
    X(textures, 0, "textures with their mip chains; texture_bytes has their cost")                 \
    X(texture_bytes, 0,                                                                            \
      "bytes of all texels on the device, compressed or decoded as used; the device may add"       \
      " padding")                                                                                  \
    /* Also at most 65536 / (number of their texture sets, at most 64). */                         \
    X(transparents, 4096,                                                                          \
      "transparent primitives, summed over all instances: 76 bytes each, host; 24, and 20 for"     \
      " each texture set that they use, per frame in flight, device")                              \
    X(lights, 4096,                                                                                \
      "punctual lights: 128 bytes each per frame in flight, device, and 116 bytes each, host")     \
    X(trace_triangles, 0,                                                                          \
      "triangles in the BVHs for reflections: 16 bytes each, and about a quarter of a 48-byte"     \
      " node each, device")                                                                        \
    X(trace_instances, 0,                                                                          \
      "instances in the BVH for reflections: 208 bytes each per frame in flight, device, and"      \
      " about 200 bytes each, host")

/* 0: no limit. A scene above a limit is MASU_ERROR_LIMIT; the detail names the member. */
/* written by make_structs.c: masu_limits */
typedef struct masu_limits {
    /* 16 bytes each, device */
    uint64_t vertices;
    /* 4 bytes each, device */
    uint64_t indices;
    /* 48 bytes each, device */
    uint64_t materials;
    /* 98 bytes each, host, and 52 bytes each per frame in flight, device; with velocities 146
     * and 100. With occlusion culling, on the device: 32 more, and 8 for each occluder of the
     * instance, per frame in flight, and 4 once. With a shadow map, per cascade: 4 more; with
     * occlusion culling 12, and 4 once. With LODs: 1 more on the host, and on the device 4 for
     * each LOD of the mesh and each view (8 with occlusion culling) */
    uint64_t instances;
    /* movable models, including hidden and pooled copies: 72 bytes each, host, and 4 for each
     * instance of the scene */
    uint64_t models;
    /* nodes of all movable models: 112 bytes each, host */
    uint64_t model_nodes;
    /* 16 bytes each, host */
    uint64_t sdf_params;
    /* cascades of the shadow map in the largest rung */
    uint64_t shadow_cascades;
    /* width and height n of a cascade in texels: 4 n^2 bytes, device */
    uint64_t shadow_resolution;
    /* light probes: 48 bytes each, 56 more for each set, and the distance map of each probe,
     * device; live ones 944 more, and 2 on the host */
    uint64_t probes;
    /* textures with their mip chains; texture_bytes has their cost */
    uint64_t textures;
    /* bytes of all texels on the device, compressed or decoded as used; the device may add
     * padding */
    uint64_t texture_bytes;
    /* transparent primitives, summed over all instances: 76 bytes each, host; 24, and 20 for
     * each texture set that they use, per frame in flight, device */
    uint64_t transparents;
    /* punctual lights: 128 bytes each per frame in flight, device, and 116 bytes each, host */
    uint64_t lights;
    /* triangles in the BVHs for reflections: 16 bytes each, and about a quarter of a 48-byte
     * node each, device */
    uint64_t trace_triangles;
    /* instances in the BVH for reflections: 208 bytes each per frame in flight, device, and
     * about 200 bytes each, host */
    uint64_t trace_instances;
} masu_limits;
/* end of what make_structs.c wrote */

/* The largest numbers of a renderer (masu_peaks). */
/* written by make_structs.c: masu_peak_info */
typedef struct masu_peak_info {
    /* as in masu_limits */
    uint64_t vertices;
    uint64_t indices;
    uint64_t materials;
    uint64_t instances;
    uint64_t models;
    uint64_t model_nodes;
    uint64_t sdf_params;
    uint64_t shadow_cascades;
    uint64_t shadow_resolution;
    uint64_t probes;
    uint64_t textures;
    uint64_t texture_bytes;
    uint64_t transparents;
    uint64_t lights;
    uint64_t trace_triangles;
    uint64_t trace_instances;
    uint64_t host_bytes;   /* used in the host block */
    uint64_t device_bytes; /* in all device blocks */
} masu_peak_info;
/* end of what make_structs.c wrote */

/* A limit as data. */
typedef struct masu_limit {
    const char *name; /* of the member of masu_limits and masu_peak_info */
    uint32_t offset;  /* in both structs, bytes */
    uint64_t max;     /* for any scene; 0: none */
    const char *text;
} masu_limit;

/* All limits in order, terminated by a row whose name is NULL. Static. */
MASU_API const masu_limit *masu_limit_table(void);

#endif

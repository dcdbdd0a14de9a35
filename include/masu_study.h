/* masu_study.h: settings for tests, measurements and debugging, which a port leaves at zero. A setting is here because a test, `masu bench`,
 * a conformance suite or a reference image needs it; what only the lab needs exists only with MASU_LAB. A part of masu.h, which
 * includes it by masu_knobs.h. */
#ifndef MASU_H
#error "masu_study.h is a part of masu.h: include that"
#endif
#ifndef MASU_STUDY_PART_H
#define MASU_STUDY_PART_H

/* How the SDF is marched: a knob of the lab build, which defines MASU_LAB. Elsewhere the SDF is marched by AUTO. Those marked * need a
 * blob that the lab build's masu-bake has baked with --variants, else masu_init fails with MASU_ERROR_SCENE. */
#ifdef MASU_LAB
#define MASU_MARCH_WORDS(X)                                                                        \
    X(MASU_MARCH_AUTO, 0, "auto", "the product's: cones of 8x8, then of 4x4 pixels")               \
    X(MASU_MARCH_PLAIN, 1, "plain", "* plain sphere tracing, one ray per pixel: the baseline")     \
    X(MASU_MARCH_SEED, 2, "seed", "* two-phase checkerboard with capped, unchecked restarts")      \
    X(MASU_MARCH_CONES, 3, "cones", "the same as auto")                                            \
    X(MASU_MARCH_CHECKERBOARD, 4, "checkerboard",                                                  \
      "* cones of 8x8 pixels, then a two-phase checkerboard with safe restarts")

typedef enum masu_march { MASU_MARCH_WORDS(MASU_WORD_ENUM) } masu_march;

#define MASU_LAB_KNOBS(NUMBER, WORD)                                                               \
    WORD(  masu_march,       march,                MASU_MARCH_AUTO, SDF,                           \
           "How the SDF is marched. AUTO: the product's march.",                                   \
           "All others take longer (docs/design/05-sphere-tracing.md).")
#else
#define MASU_LAB_KNOBS(NUMBER, WORD)
#endif

/* Rows as in MASU_PRODUCT_KNOBS, behind which they come. */
/* clang-format off */
#define MASU_STUDY_KNOBS(NUMBER, WORD)                                                             \
    /*     type              name                  min   max   0 is  of use in  unit          */   \
    /* The picture is the same either way. */                                                      \
    WORD(  masu_switch,      frustum,              MASU_ON,        POLYGONS,                       \
           "Leaves out instances outside of the view; the picture is the same. AUTO: on.",         \
           "Tests on the host; saves draws.")                                                      \
    WORD(  masu_switch,      occlusion,            MASU_AUTO,      OCCLUDERS,                      \
           "Leaves out instances hidden by occluders; the picture is the same. AUTO: on, if the"   \
           " scene has occluders.",                                                                \
           "Passes that draw the occluders and test against them; memory: limits.instances.")      \
    WORD(  masu_switch,      light_tiles,          MASU_ON,        LIGHTS,                         \
           "Each pixel asks the lights of its 16x16 tile alone; the picture is the same. AUTO:"    \
           " on, if the scene has any.",                                                           \
           "A pass over the tiles; saves work at each pixel where lights are many.")               \
    MASU_LAB_KNOBS(NUMBER, WORD)                                                                   \
    /* Single stages of traced reflections, and how far they look. */                              \
    WORD(  masu_switch,      specular_reuse,       MASU_AUTO,      SPECULAR,                       \
           "Each texel weighs its neighbours' hits too, while its history is short. AUTO: on,"     \
           " off with temporal.",                                                                  \
           "A pass of specular_reuse_taps.")                                                       \
    WORD(  masu_switch,      specular_temporal,    MASU_ON,        SPECULAR,                       \
           "Temporal accumulation. AUTO: on.",                                                     \
           "A pass, and images that outlive the frame.")                                           \
    WORD(  masu_switch,      specular_fine,        MASU_ON,        SPECULAR,                       \
           "A full-resolution history for smooth surfaces, and for 2x2 pixels that are not one"    \
           " surface; only with specular_temporal. AUTO: on.",                                     \
           "A pass, and an image that outlives the frame.")                                        \
    WORD(  masu_switch,      specular_filter,      MASU_ON,        SPECULAR,                       \
           "The spatial filter, as wide as noise is left. AUTO: on.",                              \
           "A pass of specular_filter_taps.")                                                      \
    WORD(  masu_switch,      specular_taa,         MASU_AUTO,      SPECULAR,                       \
           "Evens out what still flickers; only with specular_temporal. AUTO: on, off with"        \
           " temporal.",                                                                           \
           "A pass, and an image that outlives the frame.")                                        \
    NUMBER(uint32_t,         specular_reuse_taps,  1,    16,   8,    SPECULAR,  "",                \
           "Neighbours that specular_reuse looks at.",                                             \
           "Time of its pass.")                                                                    \
    NUMBER(uint32_t,         specular_filter_taps, 1,    32,   12,   SPECULAR,  "",                \
           "Neighbours that specular_filter looks at.",                                            \
           "Time of its pass.")
/* clang-format on */

typedef struct masu_debug {
    uint32_t timestamps; /* not 0: GPU time of each pass in masu_stats, with a full barrier around
                            each pass */
    uint32_t counters;   /* not 0: SDF evaluations and the like in masu_stats; costs atomics */
    uint32_t labels; /* not 0: object names and pass labels, where VK_EXT_debug_utils is enabled on
                        the instance */
    uint32_t poison; /* not 0: fills all transient image memory with NaN patterns before each frame;
                        the picture must not change. 1: NaN; 2: infinities; 3: as half floats NaN and 1 in turn */
    uint32_t casters; /* not 0: culls for the sun as well, with all of the scene in its view, for the
                         numbers in masu_stats */
    uint32_t ao_full; /* not 0: ambient occlusion at each pixel instead of each fourth, for comparison */
    uint32_t all_terms;  /* not 0: a march asks for all of the SDF that its tile sees, not only for what
                            matters to its block: for comparison, the same to the bit */
    masu_switch share_rays; /* any invocation of a 16x16 tile may march any of its rays, so that none waits long for others;
                               the same picture. AUTO: on GPUs, where waiting costs more than sharing */
    uint32_t no_bias; /* not 0: rungs of fewer pixels take the mips of these: for comparison */
    uint32_t reference; /* not 0: reflections are traced at each pixel, summed up over frames of a
                           resting scene, weighted exactly and not filtered: the truth after many frames.
                           A cut begins a new sum */
    uint32_t exact; /* not 0: full EASU, RCAS and both in one give the same bits on every driver, where inputs have
                       8 or 10 bits: these become the nearest step, nothing is fused or reordered, divisions are
                       exact. Three to five times the instructions; without, a pixel in some ten thousands differs */
    float mip_bias; /* added to the level of detail of textures, -16..16; below 0: finer. What many places in a
                       pixel are averaged over wants finer ones; log2 of the size undoes a rung's own */
} masu_debug;

/* Switches off what would be used where the device offers it: to test the other path, or around a
 * driver's fault. */
typedef struct masu_deny {
    uint32_t
        unified_memory; /* not 0: separate blocks per role even where one type could serve all */
    uint32_t compressed_textures; /* not 0: textures are decoded even where the device takes them
                                     compressed */
    uint32_t unorm16; /* not 0: rung.temporal keeps its mean in 16-bit floats even where the device filters
                         R16G16B16A16_UNORM: a tenth of a step of 8 bits off where it is bright */
} masu_deny;

#endif

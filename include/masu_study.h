/* masu_study.h: settings for tests, measurements and debugging, which a port leaves at zero. A
 * setting is here because a test, `masu bench`, a conformance suite or a reference image needs it;
 * settings that only the laboratory needs require MASU_LAB. Part of masu.h, which includes it
 * through masu_knobs.h. */
#ifndef MASU_H
#error "masu_study.h is a part of masu.h: include that"
#endif
#ifndef MASU_STUDY_PART_H
#define MASU_STUDY_PART_H

/* Algorithms of sphere tracing, for the laboratory (MASU_LAB). All others use AUTO. Those marked *
 * need a blob of the laboratory's masu-bake --variants, else masu_init fails with
 * MASU_ERROR_SCENE. */
#ifdef MASU_LAB
#define MASU_MARCH_WORDS(X)                                                                        \
    X(MASU_MARCH_AUTO, 0, "auto", "the product's: cones of 8x8, then of 4x4 pixels")               \
    X(MASU_MARCH_PLAIN, 1, "plain", "* plain sphere tracing, one ray per pixel: the baseline")     \
    X(MASU_MARCH_SEED, 2, "seed", "* two-phase checkerboard with capped, unchecked restarts")      \
    X(MASU_MARCH_CHECKERBOARD, 3, "checkerboard",                                                  \
      "* cones of 8x8 pixels, then a two-phase checkerboard with safe restarts")

#define MASU_MARCH_ENUM(name, value, word, text) name = value,
typedef enum masu_march { MASU_MARCH_WORDS(MASU_MARCH_ENUM) } masu_march;
#undef MASU_MARCH_ENUM

#define MASU_LAB_KNOBS(NUMBER, WORD)                                                               \
    WORD(  masu_march,       march,                MASU_MARCH_AUTO, SDF,                           \
           "How the SDF is marched. AUTO: the product's march.",                                   \
           "All others take longer (docs/design/05-sphere-tracing.md).")
#else
#define MASU_LAB_KNOBS(NUMBER, WORD)
#endif

/* Rows as in MASU_PRODUCT_KNOBS. They follow those rows in masu_rung. */
/* clang-format off */
#define MASU_STUDY_KNOBS(NUMBER, WORD)                                                             \
    /*     type              name                  min   max   0 is  of use in  unit          */   \
    /* These do not change the image. */                                                           \
    WORD(  masu_switch,      frustum,              MASU_ON,        POLYGONS,                       \
           "Frustum culling of instances; the image is the same. AUTO: on.",                       \
           "Tests on the CPU; saves draws.")                                                       \
    WORD(  masu_switch,      occlusion,            MASU_AUTO,      OCCLUDERS,                      \
           "Occlusion culling of instances; the image is the same. AUTO: on if the scene has"      \
           " occluders.",                                                                          \
           "Passes that render the occluders and test against them; memory: limits.instances.")    \
    WORD(  masu_switch,      light_tiles,          MASU_ON,        LIGHTS,                         \
           "Tiled light culling: each pixel evaluates the punctual lights of its 16x16 tile only;" \
           " the image is the same. AUTO: on if the scene has punctual lights.",                   \
           "A pass over the tiles; saves shading time in scenes with many lights.")                \
    MASU_LAB_KNOBS(NUMBER, WORD)                                                                   \
    /* Stages of the reflection filter. */                                                         \
    WORD(  masu_switch,      specular_reuse,       MASU_AUTO,      SPECULAR,                       \
           "Spatial reuse: each texel also weighs the ray hits of its neighbours while its"        \
           " history is short. AUTO: on; off with temporal.",                                      \
           "A pass of specular_reuse_taps samples per texel.")                                     \
    WORD(  masu_switch,      specular_temporal,    MASU_ON,        SPECULAR,                       \
           "Temporal accumulation of reflections. AUTO: on.",                                      \
           "A pass, and persistent images.")                                                       \
    WORD(  masu_switch,      specular_fine,        MASU_ON,        SPECULAR,                       \
           "Full-resolution history for smooth surfaces, and for 2x2 pixels with more than one"    \
           " surface; requires specular_temporal. AUTO: on.",                                      \
           "A pass, and a persistent image.")                                                      \
    WORD(  masu_switch,      specular_filter,      MASU_ON,        SPECULAR,                       \
           "Spatial filter whose radius follows the remaining noise. AUTO: on.",                   \
           "A pass of specular_filter_taps samples per texel.")                                    \
    WORD(  masu_switch,      specular_taa,         MASU_AUTO,      SPECULAR,                       \
           "Second, short temporal accumulation against flicker; requires specular_temporal."      \
           " AUTO: on; off with temporal.",                                                        \
           "A pass, and a persistent image.")                                                      \
    NUMBER(uint32_t,         specular_reuse_taps,  1,    16,   8,    SPECULAR,  "",                \
           "Neighbours per texel in specular_reuse.",                                              \
           "Time of its pass grows in proportion.")                                                \
    NUMBER(uint32_t,         specular_filter_taps, 1,    32,   12,   SPECULAR,  "",                \
           "Neighbours per texel in specular_filter.",                                             \
           "Time of its pass grows in proportion.")
/* clang-format on */

/* For tests and studies. Flags: 0 or not 0. Members for a feature that the scene or the rung lacks
 * have no effect. */
typedef struct masu_debug {
    /* Flag. GPU time of each pass (masu_stats_info.pass_ns). A full barrier surrounds each pass. */
    uint32_t timestamps;
    /* Flag. Counts SDF evaluations, rays and more in masu_stats_info. Costs atomic operations. */
    uint32_t counters;
    /* Flag. Names objects and passes, if the instance has VK_EXT_debug_utils enabled. */
    uint32_t labels;
    /* NaN poisoning: fills all transient image memory before each frame, to detect reads of
     * undefined memory. The image must not change. 1: NaN; 2: infinities; 3: NaN and 1 alternate as
     * halves. */
    uint32_t poison;
    /* Flag. Without a shadow map, culls for one light-space view of the whole scene, for
     * masu_view_stats. */
    uint32_t casters;
    /* Flag. Screen-space ambient occlusion at full instead of half resolution, for comparison. */
    uint32_t ao_full;
    /* Flag. Evaluates all SDF primitives of a tile, not only the ones that the block needs. The
     * result is bit-identical. */
    uint32_t all_terms;
    /* Load balancing: any invocation of a 16x16 tile may trace any ray of the tile. The image is
     * the same. AUTO: on for GPUs, where idle invocations cost more than the sharing. */
    masu_switch share_rays;
    /* Flag. Disables the mip bias of rungs, which is log2(scale), with temporal log2(scale) - 2. */
    uint32_t no_bias;
    /* Flag. Reflection reference: traces a ray at each pixel, weights it exactly, does not filter,
     * and averages all frames of an unchanged scene. A cut restarts the average. Turns off
     * rung.temporal. */
    uint32_t reference;
    /* Flag. Full EASU and RCAS give the same bits on every driver for inputs of 8 or 10 bits:
     * inputs are rounded to the nearest step, no operation is contracted or reordered, divisions
     * are exact. Costs three to five times the instructions. Without it, one pixel in some ten
     * thousand differs. */
    uint32_t exact;
    /* Added to the level of detail of textures, -16..16; below 0 is sharper. Use a value below 0 if
     * many jittered samples per pixel are averaged. -log2(scale) cancels the bias of a rung without
     * temporal. */
    float mip_bias;
} masu_debug;

/* Leaves device features unused although they are available: to test the fallback, or to work
 * around a driver bug. Flags (0 or not 0), unless noted. */
typedef struct masu_deny {
    /* Separate device blocks per role, even if one memory type could serve all. */
    uint32_t unified_memory;
    /* Decodes textures, even if the device supports compressed formats. */
    uint32_t compressed_textures;
    /* Stores the history of rung.temporal in 16-bit floats, even if the device filters
     * R16G16B16A16_UNORM. Bright colours then have an error of a tenth of an 8-bit step. */
    uint32_t unorm16;
    /* Upscales to exactly twice the size by the EASU of other ratios, for the same image within an
     * 8-bit step. Set on GPUs of Arm and Broadcom: the faster form exceeds their registers. */
    uint32_t easu_twice;
    /* Numbers: largest width and height of the shadow map, most storage buffers per shader stage,
     * and most colour attachments (at least 4), even if the device has more. 0: the limits of the
     * device. */
    uint32_t image_size, storage_buffers, color_attachments;
} masu_deny;

#endif

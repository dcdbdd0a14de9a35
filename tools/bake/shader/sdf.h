/* sdf.h: the scene's GLSL, or its .sdf text (docs/sdf.md) by way of the SDF compiler, becomes the
 * march shader that travels in the blob.
 *
 * The march shader and its headers are part of masu-bake (scene_sources.h, made by the build).
 * They are laid out in a temporary directory together with sdf_scene.glsl, which holds one
 * #define per parameter and the scene's own text, and go through glslangValidator, spirv-val,
 * spirv-opt, whole_vectors.h and spirv-val again: the optimiser is a program like any other.
 * docs/scene.md states what the scene's GLSL must define. */
#ifndef MASU_BAKE_SDF_H
#define MASU_BAKE_SDF_H

#include "bake/scene/content.h"

#define MASU_BAKE_TOOL_SECONDS 120

/* What the SDF takes away from the light of surfaces; docs/scene.md. */
typedef struct masu_bake_occlusion {
    bool shadows, ambient;
    double sun_radius; /* radians */
    double distance;   /* longest shadow ray */
    double radius, strength;
} masu_bake_occlusion;

/* Reads the scene's GLSL and fills MARCH_SPIRV. The content's instances, lights and SDF parameters are
 * complete: they decide how the shader is compiled. A .sdf brings its own parameters, which are
 * added. reflected: rays of reflections meet it. is_static: the scene declares that the field never
 * changes; one that reads time, or a parameter that may change, is then an error. A field that does
 * neither is static without the declaration: the blob then has no VELOCITY_SPIRV.
 * Reports errors under the GLSL's own name and lines. */
bool masu_bake_compile_march(masu_bake_content *content, const char *glsl_path,
                             const masu_bake_occlusion *occlusion, bool is_static, bool reflected, bool bounced,
                             bool variants);

/* Whether a source is a file in the language of docs/sdf.md. */
bool masu_bake_is_sdf(const char *path);

/* Prints each line of the SDF compiler's messages as an error or a warning. */
void masu_bake_report_lines(const char *text, bool warnings);

/* "MASU_PARAM_" and the name in upper case, cut at `room`. */
void masu_bake_param_macro(const char *name, char *out, size_t room);

#endif

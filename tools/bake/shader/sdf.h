/* sdf.h: compiles the scene's GLSL, or its .sdf text (docs/sdf.md) through the SDF compiler, to the
 * march shader of the blob.
 *
 * The march shader and its headers are part of masu-bake (scene_sources.h, made by the build). They
 * are written to a temporary directory together with sdf_scene.glsl, which contains one #define per
 * parameter and the scene's own text. The steps are glslangValidator, spirv-opt,
 * whole_vectors.h and spirv-val, which checks the work of all three. docs/scene.md lists what the
 * GLSL must define. */
#ifndef MASU_BAKE_SDF_H
#define MASU_BAKE_SDF_H

#include "bake/scene/content.h"

#define MASU_BAKE_TOOL_SECONDS 120

/* How much the SDF occludes the light on surfaces; docs/scene.md. */
typedef struct masu_bake_occlusion {
    bool shadows, ambient;
    double sun_radius; /* radians */
    double distance;   /* the longest shadow ray */
    double radius, strength;
} masu_bake_occlusion;

/* Reads the scene's GLSL and fills MARCH_SPIRV. The content's instances, lights and SDF parameters
 * must be complete: they decide how the shader is compiled. The parameters of a .sdf are added.
 * reflected: reflection rays can hit it. is_static: the scene declares that the field never
 * changes; a field that reads time, or has a parameter that may change, is then an error. A field
 * that does neither is static without the declaration: the blob then has no VELOCITY_SPIRV. Errors
 * have the name and line numbers of the GLSL. */
bool masu_bake_compile_march(masu_bake_content *content, const char *glsl_path,
                             const masu_bake_occlusion *occlusion, bool is_static, bool reflected,
                             bool bounced, bool variants);

/* True if a source is a file in the language of docs/sdf.md. */
bool masu_bake_is_sdf(const char *path);

/* Prints each line of the SDF compiler's messages as an error or a warning. */
void masu_bake_report_lines(const char *text, bool warnings);

/* "MASU_PARAM_" and the name in upper case, cut at `room`. */
void masu_bake_param_macro(const char *name, char *out, size_t room);

#endif

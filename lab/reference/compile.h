/* compile.h: compiles source text to a library and loads it into this program: C by the system's
 * compiler, GLSL by glslangValidator, SPIRV-Cross's C++ and the system's compiler. */
#ifndef LAB_REFERENCE_COMPILE_H
#define LAB_REFERENCE_COMPILE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct ref_library {
    void *handle;    /* of dlopen; NULL: none */
    char folder[64]; /* temporary, removed by ref_library_close; "": none */
} ref_library;

bool ref_compile_c(const char *text, ref_library *out, char *error, size_t size);
void ref_library_close(ref_library *library);
/* Sets the function pointer at `to`. Returns false if there is no such name. */
bool ref_library_find(const ref_library *library, const char *name, void *to);

/* ---- GLSL ------------------------------------------------------------------------------------ */

/* Every float of the GLSL becomes a double; its literals keep their values as floats. Inputs and
 * outputs of a field's code: */
enum { REF_GLSL_SLOTS = 65536 };
typedef struct ref_glsl_inputs {
    double time, params[256], slots[REF_GLSL_SLOTS];
} ref_glsl_inputs;

typedef enum ref_glsl_what {
    REF_GLSL_FIELD,   /* value: masu_sdf(point), or masu_sdf_part(part, point) */
    REF_GLSL_SURFACE, /* look: albedo, roughness, emissive, metallic; of a complete source */
    REF_GLSL_UPDATE   /* the slots of the inputs; of parts */
} ref_glsl_what;

typedef struct ref_glsl_call {
    double what, part, point[3], normal[3], value, look[8];
} ref_glsl_call;

/* A function of the library; any number of threads may call it concurrently, except for
 * REF_GLSL_UPDATE. */
typedef void ref_glsl_run(ref_glsl_inputs *inputs, ref_glsl_call *call);

/* text: GLSL of docs/scene.md, or with `parts` the output of masu-sdfc. path: its file, for
 * messages and for #include in the same folder. */
bool ref_compile_glsl(const char *text, const char *path, bool parts, ref_library *out,
                      ref_glsl_run **run, char *error, size_t size);

#endif

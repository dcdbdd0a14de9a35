/* sdfc.h: the SDF compiler: the text of a scene (docs/sdf.md) becomes GLSL for the march, C in
 * double precision as the reference, and a table of parts with Lipschitz constants and bounds.
 *
 *   sdfc.c           the program masu-sdfc
 *   lex.c            text -> tokens, with included files
 *   message.c        error messages
 *   parse.c          statements
 *   expression.c     expressions in the text
 *   define.c         def, and the local variables of materials
 *   shape.c          shapes in the text; kinds.inc is their table
 *   expr.c           expressions: folding, intervals, values
 *   ops.c            the formulas of library.inc, as C and as text
 *   analyse.c        Lipschitz constant and bounds of each operator
 *   lower.c          a tree of shapes -> a straight list of operations
 *   terms.c          which operations can be skipped if they do not matter, and the bits for it
 *   emit.c           that list -> GLSL, C, JSON
 *   check.c          that list, run: constants and bounds tested on random points
 *   field.c          that list, kept for callers that evaluate the field
 *
 * Any bytes are valid input: the result is code or a message. Memory and time are bounded by the
 * limits below. There is no global state. */
#ifndef MASU_SDFC_H
#define MASU_SDFC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define MASU_SDFC_SOURCE_MAX ((size_t)1 << 20)
#define MASU_SDFC_PARTS_MAX 4096
#define MASU_SDFC_SLOTS_MAX 65536
#define MASU_SDFC_PARAMS_MAX 256
#define MASU_SDFC_MATERIALS_MAX 1024
#define MASU_SDFC_DEPTH_MAX 64
#define MASU_SDFC_NAME_MAX 64
#define MASU_SDFC_MASKED_MAX 64 /* parts of a scene whose tiles have bits instead of lists */
#define MASU_SDFC_BLOCK_WORDS_MAX 2

/* The slots: first one record of each part, then one of each material, then the arguments. A
 * number that is an index is stored as a float of that value. */
enum {
    MASU_SDFC_PART_SLOTS =
        8, /* centre x y z, radius (< 0: unbounded), 1 / L, shape, base, material */
    MASU_SDFC_MATERIAL_SLOTS = 8, /* albedo r g b, roughness, emissive r g b, metallic */
};

typedef struct masu_sdfc_part {
    char name[MASU_SDFC_NAME_MAX];
    uint32_t shape, slot_base, material;
    double lipschitz;
    double center[3], radius; /* radius < 0: unbounded */
    double low[3], high[3];   /* may be infinite */
    bool dynamic;             /* some of its slots depend on parameters or time */
    bool truth;               /* the C evaluates it */
    bool user;                /* holds a glsl block: not checked by the compiler */
} masu_sdfc_part;

typedef struct masu_sdfc_param {
    char name[MASU_SDFC_NAME_MAX];
    double value, minimum, maximum;
} masu_sdfc_param;

typedef struct masu_sdfc_result {
    char *glsl, *c, *table; /* NUL-terminated; table is JSON */
    char *warnings;         /* one line each; "" for none */
    masu_sdfc_part *parts;
    uint32_t part_count, shape_count, material_count;
    masu_sdfc_param *params;
    uint32_t param_count;
    float *slots; /* initial values: parameters at their defaults, time 0 */
    uint32_t slot_count;
    uint32_t block_words; /* that specify which parts of the field matter in a block of pixels, at
                           * most MASU_SDFC_BLOCK_WORDS_MAX; 0: the field is one whole */
    bool dynamic;     /* slots depend on parameters or time */
    bool timeless;    /* no expression uses time; GLSL of a block may */
    bool anchored;    /* slots depend on the anchor */
    double glossiest; /* lowest roughness of a part without emission; 1: all parts emit */
} masu_sdfc_result;

/* A point of a camera's path. */
typedef struct masu_sdfc_camera {
    double position[3], time;
} masu_sdfc_camera;

typedef struct masu_sdfc_options {
    uint32_t pairs; /* tried per distinct shape; 0: 20000. UINT32_MAX: none */
    bool anchored;  /* the GLSL takes points relative to masu_anchor() */
    /* A warning names each part that contains a camera, with parameters at their defaults. */
    const masu_sdfc_camera *cameras;
    uint32_t camera_count;
} masu_sdfc_options;

/* False: `error` holds "name:line:column: message", the line and a caret. The result is then empty.
 * Either way masu_sdfc_release may be called. `options` may be NULL. */
bool masu_sdfc_compile_with(const char *text, size_t bytes, const char *name,
                            const masu_sdfc_options *options, masu_sdfc_result *out, char *error,
                            size_t error_size);
bool masu_sdfc_compile(const char *text, size_t bytes, const char *name, masu_sdfc_result *out,
                       char *error, size_t error_size);
void masu_sdfc_release(masu_sdfc_result *result);

/* The table of shapes, as docs/sdf-shapes.md. */
bool masu_sdfc_put_shapes(FILE *to);

/* The same scene as a function of a point, with parameters at their defaults and time 0. NULL if
 * masu_sdfc_compile rejects the text. The text must outlive it. */
typedef struct masu_sdfc_field masu_sdfc_field;
masu_sdfc_field *masu_sdfc_field_open(const char *text, size_t bytes, const char *name);
void masu_sdfc_field_close(masu_sdfc_field *field);
const masu_sdfc_part *masu_sdfc_field_parts(const masu_sdfc_field *field, uint32_t *count);
/* Numbers that a thread brings for masu_sdfc_field_run to work in. */
size_t masu_sdfc_field_room(const masu_sdfc_field *field);
/* The field of one part, which must not be a glsl block (`user`): at most `lipschitz` times the
 * distance. */
double masu_sdfc_field_run(const masu_sdfc_field *field, uint32_t part, const double p[3],
                           double *room);
/* Its material at p, for a normal and the width of a pixel there: albedo, roughness, emissive,
 * metallic. */
void masu_sdfc_field_material(const masu_sdfc_field *field, uint32_t part, const double p[3],
                              const double n[3], double width, double *room,
                              double out[MASU_SDFC_MATERIAL_SLOTS]);

#endif

/* emit.h: writers of the compiler's output. GLSL and C differ in how a slot is read and in the code
 * around the functions; the functions themselves are the same lines.
 *
 *   emit.c        all texts, and the table of the parts as JSON
 *   emit_glsl.c   included by the march shader
 *   emit_c.c      the same field in double precision, as the source of a shared object
 *   emit_text.c   common to both languages: numbers, library, shapes, the update of slots
 *
 * Out of memory is handled as elsewhere in the compiler, by an error (internal.h). */
#ifndef MASU_SDFC_EMIT_H
#define MASU_SDFC_EMIT_H

#include "sdfc/internal.h"

typedef struct sdfc_writer {
    sdfc *c;
    sdfc_text *out;
    bool glsl;
} sdfc_writer;

#define PUT(w, ...) sdfc_put((w)->c, (w)->out, __VA_ARGS__)

/* ---- emit_text.c ---- */

void sdfc_put_number(sdfc_writer *w, double v);
/* An operand of an instruction in the group's program. */
void sdfc_put_operand(sdfc_writer *w, const sdfc_group *g, const sdfc_program *p, int operand);
void sdfc_put_instr(sdfc_writer *w, int group, const sdfc_program *p, const sdfc_instr *i,
                    int variable, bool declared);
/* Functions of the library that are used; with_expressions: by the update of slots too. */
void sdfc_put_library(sdfc_writer *w, bool with_expressions);
void sdfc_put_update_library(sdfc_writer *w); /* further functions for the update, in GLSL */
void sdfc_put_users(sdfc_writer *w);             /* blocks that the author wrote */
void sdfc_put_shapes(sdfc_writer *w);            /* a function for each form */
void sdfc_put_update(sdfc_writer *w);            /* statements that write the slots that change */
bool sdfc_group_truth(const sdfc *c, int group); /* whether all of its operations have C code */

/* ---- emit_glsl.c, emit_c.c ---- */

void sdfc_put_glsl(sdfc_writer *w);
void sdfc_put_c(sdfc_writer *w);

#endif

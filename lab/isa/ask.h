/* ask.h: queries the compilers of GPUs for the statistics of a scene's pipelines.
 *
 * This process loads no driver. For each GPU it starts `masu-lab isa` with that GPU's environment,
 * in which MASU_ISA_CHILD names the GPU. The child compiles and sends its rows through its standard
 * output, so a compiler that crashes or hangs only ends its own process. */
#ifndef MASU_ISA_ASK_H
#define MASU_ISA_ASK_H

#include "lab/isa/isa.h"

enum { MASU_ISA_GPUS = 16 };

/* Whether this process is a child, and the body of a child, which returns an exit code. `ladder`:
 * the value of --ladder, or NULL. */
bool masu_isa_is_child(void);
int masu_isa_child(const char *scene_path, const char *ladder, masu_desc *desc);

/* The GPUs of a list "raven,tgl"; 0: one is unknown, already reported. `option` is for messages. */
uint32_t masu_isa_list(const char *option, const char *list,
                       const masu_isa_gpu *out[MASU_ISA_GPUS]);

/* Starts a child: masu-lab with `arguments` (NULL ends them), the first of which is "isa". On false
 * there are no rows, and the reason has been reported. */
bool masu_isa_ask(const masu_isa_gpu *gpu, const char *const *arguments, masu_isa_rows *rows);

#endif

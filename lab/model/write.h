/* write.h: `masu-lab model`: computes the model sheet (count.h, sheet.h) and writes it as text,
 * CSV, and a section of an XHTML page. Each output states that its times are computed. */
#ifndef MASU_MODEL_WRITE_H
#define MASU_MODEL_WRITE_H

#include "lab/model/sheet.h"

#include <stdio.h>

typedef struct masu_model_desc {
    const char *scene_path;
    const char *ladder_path; /* ladder.json of `masu bench`; NULL: the default rungs */
    VkExtent2D size;         /* of the sheet */
    VkExtent2D drawn;        /* of the counted frames */
    double time;
    masu_headless_desc host;
    const masu_issued *issued; /* one per class; NULL: none */
    void (*progress)(const char *text); /* may be NULL */
} masu_model_desc;

/* The default size of the counted frames: a quarter of the pixels, because a CPU driver is slow. */
VkExtent2D masu_model_drawn(VkExtent2D size);

/* Renders, counts and computes. `messages`: of the validation layer; may be NULL. On false `error`
 * holds one line. */
bool masu_model_run(const masu_model_desc *desc, masu_model_sheet *out, uint32_t *messages,
                    char *error, size_t error_size);

/* All return false if writing failed. */
bool masu_model_print(const masu_model_sheet *model, FILE *f);
bool masu_model_csv(const masu_model_sheet *model, FILE *f);
bool masu_model_xhtml(const masu_model_sheet *model, FILE *f); /* one <section> */
bool masu_model_save(const masu_model_sheet *model, bool (*write)(const masu_model_sheet *, FILE *),
                     const char *path, char *error, size_t error_size);

#endif

/* write.h: `masu plan --model`: the sheet made (count.h, sheet.h) and written, as
 * text, as CSV, and as a part of an XHTML page. Each says that it is computed. */
#ifndef MASU_MODEL_WRITE_H
#define MASU_MODEL_WRITE_H

#include "model/sheet.h"

#include <stdio.h>

#define MASU_MODEL_FRAGMENT "model.xhtml" /* in the folder of `masu bench` */

typedef struct masu_model_desc {
    const char *scene_path;
    const char *ladder_path; /* ladder.json of `masu bench`; NULL: the library's own rungs */
    VkExtent2D size;         /* of the sheet */
    VkExtent2D drawn;        /* of the frames that are counted */
    double time;
    masu_headless_desc host;
    const masu_issued *issued; /* of each class; NULL: none */
    void (*progress)(const char *text); /* may be NULL */
} masu_model_desc;

/* Draws, counts, computes. `messages`: of the validation layer; may be NULL. False: `error`
 * holds one line. */
bool masu_model_run(const masu_model_desc *desc, masu_model_sheet *out, uint32_t *messages, char *error,
                    size_t error_size);

/* All return false if something could not be written. */
bool masu_model_print(const masu_model_sheet *model, FILE *f);
bool masu_model_csv(const masu_model_sheet *model, FILE *f);
bool masu_model_xhtml(const masu_model_sheet *model, FILE *f); /* one <section> */
bool masu_model_save(const masu_model_sheet *model, bool (*write)(const masu_model_sheet *, FILE *),
                     const char *path, char *error, size_t error_size);

/* For `masu bench`: the sheet of the folder's ladder.json, as model.csv and model.xhtml beside
 * it. */
bool masu_model_write(const masu_model_desc *desc, const char *folder, char *error,
                      size_t error_size);

#endif

/* ask.h: instruction counts of the model sheet, from the compilers of its classes
 * (lab/isa/ask.h). */
#ifndef MASU_MODEL_ASK_H
#define MASU_MODEL_ASK_H

#include "lab/model/sheet.h"

/* `gpus`: a list "tgl,kbl,raven,vangogh,a630"; scene, ladder (or NULL) and size as for the sheet.
 * Returns an exit code and reports failures. */
int masu_model_ask(const char *gpus, const char *scene, const char *ladder, VkExtent2D size,
                   masu_issued issued[MASU_MODEL_CLASSES]);

#endif

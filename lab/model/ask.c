/* ask.c: see ask.h. */
#include "lab/model/ask.h"

#include "cli/cli.h"
#include "lab/isa/ask.h"

#include <stdio.h>
#include <string.h>

int masu_model_ask(const char *gpus, const char *scene, const char *ladder, VkExtent2D size,
                   masu_issued issued[MASU_MODEL_CLASSES]) {
    static masu_isa_rows rows;
    const masu_isa_gpu *list[MASU_ISA_GPUS];
    char extent[32];
    snprintf(extent, sizeof extent, "%ux%u", size.width, size.height);
    const char *const arguments[] = {"isa",  scene, "--size", extent, ladder ? "--ladder" : NULL,
                                     ladder, NULL};
    uint32_t n = masu_isa_list("--isa", gpus, list);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t k = 0;
        while (k < MASU_MODEL_CLASSES && strcmp(masu_model_classes[k].gpu, list[i]->name)) k++;
        if (k == MASU_MODEL_CLASSES) {
            return masu_cli_usage_error(
                "--isa: the model has no class for %s: tgl, kbl, raven, vangogh or a630",
                list[i]->name);
        }
        if (!masu_isa_ask(list[i], arguments, &rows)) return MASU_CLI_FAILURE;
        masu_issued_make(&rows, &issued[k]);
    }
    return n ? MASU_CLI_OK : MASU_CLI_USAGE;
}

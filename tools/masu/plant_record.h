/* plant_record.h: records the times of a scene for `masu plant`. */
#ifndef MASU_CMD_PLANT_RECORD_H
#define MASU_CMD_PLANT_RECORD_H

#include "masu/cmd.h"

typedef struct masu_plant_record {
    const char *scene, *name; /* the blob; the CSV file to write */
    VkExtent2D size;
    uint32_t frames;
    double time_step;
    masu_headless_desc host;
} masu_plant_record;

/* An exit code. */
int masu_plant_record_run(const masu_plant_record *record);

#endif

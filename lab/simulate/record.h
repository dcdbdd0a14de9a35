/* simulate_record.h: `masu simulate --record`: records the times of a scene. */
#ifndef MASU_CMD_SIMULATE_RECORD_H
#define MASU_CMD_SIMULATE_RECORD_H

#include "masu/cmd.h"

typedef struct masu_simulate_record {
    const char *scene, *name; /* the blob; the CSV file to write */
    VkExtent2D size;
    uint32_t frames;
    double time_step;
    masu_headless_desc host;
} masu_simulate_record;

/* An exit code. */
int masu_simulate_record_run(const masu_simulate_record *record);

#endif

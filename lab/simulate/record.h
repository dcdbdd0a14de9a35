/* record.h: `masu-lab simulate --record`: records the frame times of a scene. */
#ifndef LAB_RECORD_H
#define LAB_RECORD_H

#include "command/output.h"

typedef struct masu_simulate_record {
    const char *scene, *name; /* the blob; the CSV file to write */
    VkExtent2D size;
    uint32_t frames;
    double time_step;
    masu_headless_desc host;
} masu_simulate_record;

/* Returns an exit code. */
int masu_simulate_record_run(const masu_simulate_record *record);

#endif

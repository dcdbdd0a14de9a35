/* request.h: the command line of masu-meso: the relief, the measurement, and the name of the
 * output. `masu-lab meso` reads the same options. */
#ifndef MASU_MESO_REQUEST_H
#define MASU_MESO_REQUEST_H

#include "cli/cli.h"
#include "meso/author.h"
#include "meso/input.h"

typedef struct masu_meso_request {
    /* A file or the name of a built-in relief; the output's name. */
    const char *input, *output, *make;
    masu_meso_input file;
    bool has_height;
    masu_meso_options options;
    uint32_t seed, detail;
    bool no_plots; /* for masu-lab meso */
    bool complete; /* the command line was read completely and is valid */
} masu_meso_request;

/* Without and with --no-plots; each ends with a NULL name. */
extern const masu_cli_option masu_meso_request_options[], masu_meso_study_options[];

/* Reads the whole command line. On false return *code. */
bool masu_meso_request_read(masu_cli *cli, masu_meso_request *r, int *code);

/* Reads or generates the relief. Returns false after an error message. */
bool masu_meso_request_patch(const masu_meso_request *r, masu_meso_patch *patch);

#endif

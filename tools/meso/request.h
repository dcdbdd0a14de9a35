/* request.h: the command line of masu-meso: which relief, how it is measured, and the name of the
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
    bool no_plots; /* of masu-lab meso */
    bool complete; /* the command line has been read to its end and is valid */
} masu_meso_request;

/* Without and with --no-plots; a NULL name ends each. */
extern const masu_cli_option masu_meso_request_options[], masu_meso_study_options[];

/* Reads the whole command line. On false nothing is left to do but to return *code. */
bool masu_meso_request_read(masu_cli *cli, masu_meso_request *r, int *code);

/* Reads or makes the relief. False after an error message. */
bool masu_meso_request_patch(const masu_meso_request *r, masu_meso_patch *patch);

#endif

/* meso.c: `masu-lab meso`: makes a material like masu-meso, and compares it with ray tracing under
 * other lights. */
#include "lab/command/commands.h"
#include "lab/meso/report.h"

#include "meso/request.h"

static int run(masu_cli *cli) {
    masu_meso_request r;
    masu_meso_patch patch = {0};
    masu_meso_study study = {0};
    int code;
    if (!masu_meso_request_read(cli, &r, &code)) return code;
    bool good = masu_meso_request_patch(&r, &patch) &&
                masu_meso_study_run(&patch, &r.options, &study) &&
                masu_meso_write_csv(r.output, &study) &&
                (r.no_plots || masu_meso_write_plots(r.output, &study));
    if (good && !masu_cli_quiet()) masu_meso_print(r.output, &study);
    masu_meso_patch_free(&patch);
    masu_meso_study_free(&study);
    return good ? MASU_CLI_OK : MASU_CLI_FAILURE;
}

const masu_cli_command lab_meso = {
    .name = "meso",
    .arguments = "(RELIEF.png --height H | RELIEF.obj | --make NAME) -o NAME [options]",
    .summary = "compare the material that masu-meso makes of a relief with ray tracing",
    .options = masu_meso_study_options,
    .details = "Writes NAME.csv and, with gnuplot, NAME_*.svg, and prints the error of radiance at "
               "five view\n"
               "angles: of plain normal mapping, with an ambient occlusion map, and with the "
               "fitted curves.\n",
    .run = run};

/* main.c: the program masu-meso: builds the maps and the angle-dependent curves of a material from
 * a patch of relief. docs/meso.md is its manual. */
#include <stdio.h>

#include "cli/cli.h"
#include "masu.h"
#include "meso/request.h"
#include "meso/write.h"

#define TEXT(x) #x
#define VERSION_TEXT(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

static int run(masu_cli *cli) {
    masu_meso_request r;
    masu_meso_patch patch = {0};
    masu_meso_material made = {0};
    int code;
    if (!masu_meso_request_read(cli, &r, &code)) return code;
    bool good = masu_meso_can_write(r.output) && masu_meso_request_patch(&r, &patch) &&
                masu_meso_author(&patch, &r.options, &made) &&
                masu_meso_write_curves(r.output, &made) && masu_meso_write_maps(r.output, &made);
    if (good && !masu_cli_quiet()) {
        printf("%s: error of the fit, relative to the mean radiance: mean texel %.3f, single "
               "texels %.3f, "
               "filtered texels %.3f\n",
               r.output, made.misfit.far, made.misfit.near, made.misfit.filtered);
    }
    masu_meso_patch_free(&patch);
    masu_meso_material_free(&made);
    return good ? MASU_CLI_OK : MASU_CLI_FAILURE;
}

int main(int argc, char **argv) {
    static const masu_cli_command command = {
        .arguments = "(RELIEF.png --height H | RELIEF.obj | --make NAME) -o NAME [options]",
        .summary =
            "measure a relief by ray tracing and fit the angle-dependent curves of a material",
        .options = masu_meso_request_options,
        .details =
            "Writes NAME.json, NAME_color.png, NAME_normal.png, NAME_rough.png and NAME_ao.png.\n"
            "docs/meso.md describes them.\n\n"
            "Exit codes:\n"
            "  0  success\n"
            "  1  the relief is not usable, or a file could not be read or written\n"
            "  2  the command line is wrong\n\n"
            "Examples:\n"
            "  masu-meso --make gravel -o gravel\n"
            "  masu-meso bricks.png --height 0.05 -o bricks\n",
        .run = run,
    };
    static const masu_cli_command *const commands[] = {&command, NULL};
    static const masu_cli_program program = {
        .name = "masu-meso",
        .version = VERSION_TEXT(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH),
        .commands = commands};
    return masu_cli_main(&program, argc, argv);
}

/* main.c: the program masu-meso: a patch of relief in, the curves of its look by angle, its maps and a
 * report out. docs/meso.md is its manual. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "cli/cli.h"
#include "masu.h"
#include "meso/input.h"
#include "meso/report.h"

#define TEXT(x) #x
#define VERSION_TEXT(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

enum {
    OPTION_OUTPUT = 1,
    OPTION_MAKE,
    OPTION_HEIGHT,
    OPTION_TILE,
    OPTION_ROUGHNESS,
    OPTION_ALBEDO,
    OPTION_SIZE,
    OPTION_RAYS,
    OPTION_SKY,
    OPTION_SEED,
    OPTION_DETAIL,
    OPTION_NO_PLOTS
};

typedef struct request {
    const char *input, *output, *make;
    masu_meso_input file;
    bool has_height;
    masu_meso_options study;
    uint32_t seed, detail;
    bool no_plots;
} request;

static bool has_end(const char *path, const char *end) {
    size_t n = strlen(path), m = strlen(end);
    return n > m && strcasecmp(path + n - m, end) == 0;
}

static bool get_patch(const request *r, masu_meso_patch *patch) {
    if (r->make) return masu_meso_make(r->make, r->detail, r->seed, patch);
    return has_end(r->input, ".png") ? masu_meso_read_heights(r->input, &r->file, patch)
                                     : masu_meso_read_model(r->input, &r->file, patch);
}

static int run_request(const request *r) {
    masu_meso_patch patch = {0};
    masu_meso_study study = {0};
    bool good = get_patch(r, &patch) && masu_meso_study_run(&patch, &r->study, &study);
    if (good) {
        good = masu_meso_write_curves(r->output, &study) &&
               masu_meso_write_maps(r->output, &study) && masu_meso_write_csv(r->output, &study) &&
               (r->no_plots || masu_meso_write_plots(r->output, &study));
    }
    if (good && !masu_cli_quiet()) masu_meso_print(r->output, &study);
    masu_meso_patch_free(&patch);
    masu_meso_study_free(&study);
    return good ? MASU_CLI_OK : MASU_CLI_FAILURE;
}

static int check(request *r) {
    if (r->make && r->input) return masu_cli_usage_error("give a file or --make, not both");
    if (!r->make && !r->input) return masu_cli_usage_error("no relief given: a file or --make");
    if (!r->output) return masu_cli_usage_error("no output given: -o NAME");
    if (r->input && has_end(r->input, ".png") && !r->has_height) {
        return masu_cli_usage_error(
            "a picture of heights needs --height: periods from black to white");
    }
    if (r->study.size & (r->study.size - 1)) {
        return masu_cli_usage_error("--size: expected a power of two, not %u", r->study.size);
    }
    r->study.seed = r->seed;
    return run_request(r);
}

static int run(masu_cli *cli) {
    request r = {.file = {.albedo = {0.5, 0.5, 0.5}, .roughness = 0.5},
                 .study = {.size = 256, .side = 96, .sky_rays = 16},
                 .seed = 1,
                 .detail = 2};
    uint32_t made = 0;
    for (;;) {
        switch (masu_cli_next(cli)) {
        case OPTION_OUTPUT: r.output = cli->value; break;
        case OPTION_MAKE:
            if (!masu_cli_choice(cli, masu_meso_made, &made)) return MASU_CLI_USAGE;
            r.make = masu_meso_made[made];
            break;
        case OPTION_HEIGHT:
            if (!masu_cli_double(cli, 0, MASU_MESO_HEIGHT_MAX, &r.file.height))
                return MASU_CLI_USAGE;
            r.has_height = true;
            break;
        case OPTION_TILE:
            if (!masu_cli_double(cli, 1e-6, 1e9, &r.file.tile)) return MASU_CLI_USAGE;
            break;
        case OPTION_ROUGHNESS:
            if (!masu_cli_double(cli, 0.05, 1, &r.file.roughness)) return MASU_CLI_USAGE;
            break;
        case OPTION_ALBEDO:
            if (!masu_cli_double(cli, 0.01, 1, &r.file.albedo[0])) return MASU_CLI_USAGE;
            r.file.albedo[1] = r.file.albedo[2] = r.file.albedo[0];
            break;
        case OPTION_SIZE:
            if (!masu_cli_uint(cli, 32, 2048, &r.study.size)) return MASU_CLI_USAGE;
            break;
        case OPTION_RAYS:
            if (!masu_cli_uint(cli, 8, 1024, &r.study.side)) return MASU_CLI_USAGE;
            break;
        case OPTION_SKY:
            if (!masu_cli_uint(cli, 1, 256, &r.study.sky_rays)) return MASU_CLI_USAGE;
            break;
        case OPTION_SEED:
            if (!masu_cli_uint(cli, 0, 1000000000, &r.seed)) return MASU_CLI_USAGE;
            break;
        case OPTION_DETAIL:
            if (!masu_cli_uint(cli, 1, 4, &r.detail)) return MASU_CLI_USAGE;
            break;
        case OPTION_NO_PLOTS: r.no_plots = true; break;
        case MASU_CLI_ARGUMENT:
            if (r.input) return masu_cli_usage_error("more than one input: %s", cli->value);
            r.input = cli->value;
            break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END: return check(&r);
        }
    }
}

int main(int argc, char **argv) {
    static const masu_cli_option options[] = {
        {"output", "NAME", "what the names of all files begin with", OPTION_OUTPUT, 'o'},
        {"make", "NAME", "no file: asphalt, gravel or grass", OPTION_MAKE, 0},
        {"height", "H", "of a picture: height of white over black, in periods", OPTION_HEIGHT, 0},
        {"tile", "W", "of a model: edge of its period (its extent in x)", OPTION_TILE, 0},
        {"roughness", "R", "of the facets of a file (0.5)", OPTION_ROUGHNESS, 0},
        {"albedo", "A", "of a picture's relief (0.5)", OPTION_ALBEDO, 0},
        {"size", "N", "texels of an edge of the maps, a power of two (256)", OPTION_SIZE, 0},
        {"rays", "N", "N x N rays per view angle (96)", OPTION_RAYS, 0},
        {"sky-rays", "N", "rays to the sky per hit (16)", OPTION_SKY, 0},
        {"seed", "N", "of all random numbers (1)", OPTION_SEED, 0},
        {"detail", "N", "of what --make makes, 1 to 4 (2)", OPTION_DETAIL, 0},
        {"no-plots", NULL, "do not call gnuplot", OPTION_NO_PLOTS, 0},
        {NULL, NULL, NULL, 0, 0},
    };
    static const masu_cli_command command = {
        .arguments = "(RELIEF.png --height H | RELIEF.obj | --make NAME) -o NAME [options]",
        .summary = "measures a relief by ray tracing and fits how a material shows it by angle",
        .options = options,
        .details =
            "Writes NAME.json, NAME_color.png, NAME_normal.png, NAME_rough.png, NAME_ao.png,\n"
            "NAME.csv and, with gnuplot, NAME_*.svg. docs/meso.md explains them.\n\n"
            "Exit code: 0 done, 1 failed, 2 wrong usage.\n",
        .run = run,
    };
    static const masu_cli_command *const commands[] = {&command, NULL};
    static const masu_cli_program program = {
        .name = "masu-meso",
        .version = VERSION_TEXT(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH),
        .commands = commands};
    return masu_cli_main(&program, argc, argv);
}

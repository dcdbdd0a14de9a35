/* request.c: see request.h. */
#include "meso/request.h"
#include "file_kind.h"

#include <string.h>
#include <strings.h>

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

#define COMMON_OPTIONS                                                                             \
    {"output", "NAME", "prefix of the names of all output files", OPTION_OUTPUT, 'o'}, \
    {"make", "NAME", "generate the relief: asphalt, gravel or grass", OPTION_MAKE, 0}, \
    {"height", "H", "with RELIEF.png: height of white above black, in periods", OPTION_HEIGHT, 0}, \
    {"tile", "W", "with a model: edge length of its period (default: its extent in x)",            \
     OPTION_TILE, 0},                                                                              \
    {"roughness", "R", "facet roughness of a relief file (default 0.5)", OPTION_ROUGHNESS, 0}, \
    {"albedo", "A", "with RELIEF.png: albedo of the relief (default 0.5)", OPTION_ALBEDO, 0}, \
    {"size", "N", "texels per edge of the maps, a power of two (default 256)", OPTION_SIZE, 0}, \
    {"rays", "N", "N x N rays per view angle (default 96)", OPTION_RAYS, 0}, \
    {"sky-rays", "N", "rays to the sky per hit (default 16)", OPTION_SKY, 0}, \
    {"seed", "N", "seed of all random numbers (default 1)", OPTION_SEED, 0}, \
    {"detail", "N", "with --make: level of detail, 1 to 4 (default 2)", OPTION_DETAIL, 0}

const masu_cli_option masu_meso_request_options[] = {COMMON_OPTIONS, {NULL, NULL, NULL, 0, 0}};
const masu_cli_option masu_meso_study_options[] = {
    COMMON_OPTIONS,
    {"no-plots", NULL, "do not call gnuplot", OPTION_NO_PLOTS, 0},
    {NULL, NULL, NULL, 0, 0}};

static bool has_end(const char *path, const char *end) {
    size_t n = strlen(path), m = strlen(end);
    return n > m && strcasecmp(path + n - m, end) == 0;
}

bool masu_meso_request_patch(const masu_meso_request *r, masu_meso_patch *patch) {
    if (r->make) return masu_meso_make(r->make, r->detail, r->seed, patch);
    masu_file_kind kind = masu_file_kind_of(r->input, NULL, 0);
    if (kind && kind != MASU_FILE_IMAGE && kind != MASU_FILE_MODEL) {
        masu_cli_error("%s: is no relief%s", r->input,
                       masu_file_hint(r->input, NULL, 0, MASU_FILE_UNKNOWN));
        return false;
    }
    return has_end(r->input, ".png") ? masu_meso_read_heights(r->input, &r->file, patch)
                                     : masu_meso_read_model(r->input, &r->file, patch);
}

static int check(masu_meso_request *r) {
    if (r->make && r->input)
        return masu_cli_usage_error("expected a relief file or --make, not both");
    if (!r->make && !r->input)
        return masu_cli_usage_error("no relief given: expected a file or --make NAME");
    if (!r->output) return masu_cli_usage_error("no output given: -o NAME");
    if (r->input && has_end(r->input, ".png") && !r->has_height) {
        return masu_cli_usage_error(
            "RELIEF.png needs --height H: the height of white above black, in periods");
    }
    if (r->options.size & (r->options.size - 1)) {
        return masu_cli_usage_error("--size: expected a power of two, found %u", r->options.size);
    }
    r->options.seed = r->seed;
    r->complete = true;
    return MASU_CLI_OK;
}

static int read_request(masu_cli *cli, masu_meso_request *r) {
    *r = (masu_meso_request){.file = {.albedo = {0.5, 0.5, 0.5}, .roughness = 0.5},
                             .options = {.size = 256, .side = 96, .sky_rays = 16},
                             .seed = 1,
                             .detail = 2};
    uint32_t made = 0;
    for (;;) {
        switch (masu_cli_next(cli)) {
        case OPTION_OUTPUT: r->output = cli->value; break;
        case OPTION_MAKE:
            if (!masu_cli_choice(cli, masu_meso_made, &made)) return MASU_CLI_USAGE;
            r->make = masu_meso_made[made];
            break;
        case OPTION_HEIGHT:
            if (!masu_cli_double(cli, 0, MASU_MESO_HEIGHT_MAX, &r->file.height))
                return MASU_CLI_USAGE;
            r->has_height = true;
            break;
        case OPTION_TILE:
            if (!masu_cli_double(cli, 1e-6, 1e9, &r->file.tile)) return MASU_CLI_USAGE;
            break;
        case OPTION_ROUGHNESS:
            if (!masu_cli_double(cli, 0.05, 1, &r->file.roughness)) return MASU_CLI_USAGE;
            break;
        case OPTION_ALBEDO:
            if (!masu_cli_double(cli, 0.01, 1, &r->file.albedo[0])) return MASU_CLI_USAGE;
            r->file.albedo[1] = r->file.albedo[2] = r->file.albedo[0];
            break;
        case OPTION_SIZE:
            if (!masu_cli_uint(cli, 32, 2048, &r->options.size)) return MASU_CLI_USAGE;
            break;
        case OPTION_RAYS:
            if (!masu_cli_uint(cli, 8, 1024, &r->options.side)) return MASU_CLI_USAGE;
            break;
        case OPTION_SKY:
            if (!masu_cli_uint(cli, 1, 256, &r->options.sky_rays)) return MASU_CLI_USAGE;
            break;
        case OPTION_SEED:
            if (!masu_cli_uint(cli, 0, 1000000000, &r->seed)) return MASU_CLI_USAGE;
            break;
        case OPTION_DETAIL:
            if (!masu_cli_uint(cli, 1, 4, &r->detail)) return MASU_CLI_USAGE;
            break;
        case OPTION_NO_PLOTS: r->no_plots = true; break;
        case MASU_CLI_ARGUMENT:
            if (r->input) return masu_cli_usage_error("more than one input: %s", cli->value);
            r->input = cli->value;
            break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END: return check(r);
        }
    }
}

bool masu_meso_request_read(masu_cli *cli, masu_meso_request *r, int *code) {
    *code = read_request(cli, r);
    return r->complete; /* false after --help */
}

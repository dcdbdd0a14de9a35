/* main.c: masu-bake turns a model or a scene description into one .masu blob, in three steps:
 *
 *   read    the description, completely: every member is checked, every file named, nothing built
 *   build   the content: models imported and placed, lights, textures, probes, trees, shaders
 *   write   the blob
 *
 * Mistakes in the description are therefore reported before any file that it names is opened. The
 * folders of tools/bake are layers; each includes what stands above it alone:
 *
 *   base         memory, mathematics, files, JSON, child processes: nothing of scenes
 *   scene        the scene being baked: one array per section of the blob; pieces placed in it
 *   import       a model file becomes a piece, in a child process
 *   texture      pictures to texels, mips, blocks
 *   mesh         triangles: welded, merged, simplified; occluders; trees and rays
 *   light        probes and the paths that light them; environment maps
 *   shader       the SDF's shaders, compiled and tried
 *   description  what a scene says, as plain values; reading them from JSON
 *   build        a description becomes content
 *   write        content becomes a file
 *
 * The runtime trusts nothing and reads no other format; all parsing of foreign files is here. */
#include "bake/base/inside.h"
#include "bake/base/process.h"
#include "bake/base/supervise.h"
#include "bake/build/build.h"
#include "bake/write/describe.h"
#include "bake/write/write.h"
#include "cli/cli.h"
#include "file_kind.h"
#include "image.h"
#include "masu.h"

#include <string.h>

#define TEXT(x) #x
#define NUMBER(x) TEXT(x)
#define VERSION                                                                                    \
    NUMBER(MASU_VERSION_MAJOR) "." NUMBER(MASU_VERSION_MINOR) "." NUMBER(MASU_VERSION_PATCH)

#define ASSIMP_MODELS "/usr/share/assimp/models"

enum {
    OPTION_OUTPUT = 1,
    OPTION_STATS,
    OPTION_MODELS,
#ifdef MASU_LAB
    OPTION_VARIANTS,
#endif
    OPTION_BARE,
    OPTION_VARIANT,
    OPTION_TURN,
    OPTION_DESCRIBE,
    OPTION_NO_TEXTURES,
    OPTION_TEXTURE_PATH,
    OPTION_PROBES,
    OPTION_PROBE_REPORT,
    OPTION_THREADS,
    OPTION_STRICT,
    OPTION_MEMORY_LIMIT,
    OPTION_TIME_LIMIT
};

/* For --stats, which lists them: each with its NUL. */
static void keep_warning(void *user, const char *text) {
    masu_bake_append(user, text, strlen(text) + 1);
}

static bool is_clean(const masu_bake_options *options) {
    uint32_t warnings = masu_cli_warnings();
    if (!options->strict || !warnings) return true;
    masu_cli_error("%s: %u warnings are errors with --strict", options->input, warnings);
    return false;
}

static bool bake(const masu_bake_options *options) {
    double started = masu_bake_seconds();
    masu_bake_description description;
    masu_bake_content content = {0};
    masu_bake_report report = {0};
    masu_cli_hear_warnings(keep_warning, &report.warnings);
    bool good = masu_bake_read(options, &description) &&
                masu_bake_build(&description, options, &content, &report) && is_clean(options) &&
                (options->describe ? masu_bake_write_scene(options, &description, &content)
                                   : masu_bake_write(options, &content, &report, started));
    masu_cli_hear_warnings(NULL, NULL);
    masu_bake_release(&report.warnings);
    masu_bake_content_release(&content);
    masu_bake_description_release(&description);
    return good;
}

static int bake_in_child(const void *options) {
    return bake(options) ? MASU_CLI_OK : MASU_CLI_FAILURE;
}

/* Found out before the work: *code is the exit code. */
static bool can_write(const masu_bake_options *o, int *code) {
    char error[4096];
    if (o->output &&
        !masu_file_named(o->output, o->describe ? ".json" : ".masu", error, sizeof error)) {
        *code = masu_cli_usage_error("--output: %s", error);
        return false;
    }
    for (int i = 0; i < 2; i++) {
        const char *path = i ? o->stats : o->output;
        if (!path || masu_file_writable(path, error, sizeof error)) continue;
        *code = masu_cli_error("%s", error);
        return false;
    }
    return true;
}

static int run(masu_cli *cli) {
    int code;
    masu_bake_options o = {.models_directory = ASSIMP_MODELS};
    masu_bake_supervised work = {.body = bake_in_child,
                                 .argument = &o,
                                 .memory_mib = masu_bake_memory_default(),
                                 .seconds = MASU_BAKE_SECONDS_DEFAULT};
    for (;;) {
        switch (masu_cli_next(cli)) {
        case OPTION_OUTPUT: o.output = cli->value; break;
        case OPTION_STATS: o.stats = cli->value; break;
        case OPTION_MODELS: o.models_directory = cli->value; break;
        case OPTION_TEXTURE_PATH: o.texture_path = cli->value; break;
        case OPTION_NO_TEXTURES: o.textures = MASU_BAKE_TEXTURES_OFF; break;
        case OPTION_PROBES: o.probes = true; break;
        case OPTION_PROBE_REPORT: o.probes = o.probe_report = true; break;
        case OPTION_THREADS:
            if (!masu_cli_uint(cli, 1, 64, &o.threads)) return MASU_CLI_USAGE;
            break;
        case OPTION_BARE: o.bare = true; break;
        case OPTION_VARIANT: o.variant = cli->value; break;
        case OPTION_TURN:
            if (!masu_cli_double(cli, -360.0, 360.0, &o.turn)) return MASU_CLI_USAGE;
            break;
        case OPTION_DESCRIBE: o.describe = true; break;
#ifdef MASU_LAB
        case OPTION_VARIANTS: o.variants = true; break;
#endif
        case OPTION_STRICT: o.strict = true; break;
        case OPTION_MEMORY_LIMIT:
            if (!masu_cli_uint(cli, 0, INT32_MAX, &work.memory_mib)) return MASU_CLI_USAGE;
            break;
        case OPTION_TIME_LIMIT:
            if (!masu_cli_uint(cli, 0, INT32_MAX, &work.seconds)) return MASU_CLI_USAGE;
            break;
        case MASU_CLI_ARGUMENT:
            if (o.input) return masu_cli_usage_error("more than one input: %s", cli->value);
            o.input = cli->value;
            break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END:
            if (!o.input) return masu_cli_usage_error("no MODEL, SCENE.json or FIELD.sdf given");
            if (o.describe && (o.stats || o.probes))
                return masu_cli_usage_error("--describe bakes nothing: remove %s",
                                            o.stats ? "--stats" : "--probes");
            if (!o.output && !o.probe_report && !o.describe)
                return masu_cli_usage_error("no output given; add -o X.masu");
            if (!can_write(&o, &code)) return code;
            work.about = o.input;
            masu_bake_inside_also(o.texture_path);
            work.output = o.output;
            return masu_bake_supervise(&work);
        }
    }
}

int main(int argc, char **argv) {
    static const masu_cli_option options[] = {
        {"output", "FILE", "where the blob goes; replaced only by a complete one", OPTION_OUTPUT,
         'o'},
#ifdef MASU_LAB
        {"variants", NULL, "add the baseline marches of the SDF, for masu-lab study march",
         OPTION_VARIANTS, 0},
#endif
        {"bare", NULL,
         "without the ground, shadows, ambient occlusion and reflections that the\n"
         "input does not ask for",
         OPTION_BARE, 0},
        {"variant", "NAME", "material variant of a glTF MODEL (KHR_materials_variants)",
         OPTION_VARIANT, 0},
        {"turn", "DEGREES", "turn the environment map of a scene by this much more", OPTION_TURN,
         0},
        {"describe", NULL,
         "write the scene description that a MODEL or FIELD.sdf gets, to -o SCENE.json or\n"
         "stdout, and bake nothing",
         OPTION_DESCRIBE, 0},
        {"no-textures", NULL, "ignore textures; materials keep their factors", OPTION_NO_TEXTURES,
         0},
        {"texture-path", "DIR:...",
         "folders to search for textures that are not at the model's path", OPTION_TEXTURE_PATH, 0},
        {"probes", NULL, "bake light probes even if the scene has none", OPTION_PROBES, 0},
        {"probe-report", NULL,
         "bake light probes and print their error against path tracing;\nneeds no -o",
         OPTION_PROBE_REPORT, 0},
        {"threads", "N", "threads that trace light probes; default: all processors", OPTION_THREADS,
         0},
        {"strict", NULL, "treat warnings as errors: no blob if any content of a file is ignored",
         OPTION_STRICT, 0},
        {"stats", "FILE", "write counts, bytes, bounds, warnings, seconds and peak memory as JSON",
         OPTION_STATS, 0},
        {"memory-limit", "MIB",
         "address space limit, 0: none; default: half of the machine's\n"
         "memory, at least 4096",
         OPTION_MEMORY_LIMIT, 0},
        {"time-limit", "SECONDS", "time limit, 0: none; default: 3600", OPTION_TIME_LIMIT, 0},
        {"models", "DIR", "folder that \"@assimp/\" in a scene stands for\n(" ASSIMP_MODELS ")",
         OPTION_MODELS, 0},
        {NULL, NULL, NULL, 0, 0},
    };
    static const masu_cli_command command = {
        .arguments = "MODEL|SCENE.json|FIELD.sdf -o X.masu [options]",
        .summary = "turns a model, a scene description or an SDF into a .masu blob",
        .options = options,
        .details =
            "A MODEL is a model file (.glb, .gltf, .obj, .ac, ...). It gets a "
            "camera\n"
            "that frames it, a ground, sun and sky, shadows and reflections. A FIELD.sdf "
            "(docs/sdf.md) gets a\n"
            "camera, sun and sky, shadows and ambient occlusion. A SCENE.json places models, a "
            "camera path, light "
            "and\n"
            "an SDF; docs/scene.md describes it. An SDF needs glslangValidator, spirv-val and\n"
            "spirv-opt. The same input gives the same bytes.\n\n"
            "MASU_PROGRESS in the environment prints progress even if stderr is not a terminal.\n\n"
            "Exit code: 0 success, 1 error (one line with the reason), 2 wrong usage.\n",
        .run = run,
    };
    static const masu_cli_command *const commands[] = {&command, NULL};
    static const masu_cli_program program = {
        .name = "masu-bake", .version = VERSION, .commands = commands};
    masu_bake_catch_signals();
    return masu_cli_main(&program, argc, argv);
}

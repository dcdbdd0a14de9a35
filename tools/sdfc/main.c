/* main.c: the program masu-sdfc: a .sdf file in, GLSL, C and the table of parts out; see sdfc.h and
 * docs/sdf.md. Without outputs it only checks. */
#include "cli/cli.h"
#include "sdfc/sdfc.h"
#include "file_kind.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "masu.h"

#define TEXT(x) #x
#define VERSION_TEXT(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

enum { OPTION_GLSL = 1, OPTION_C, OPTION_TABLE, OPTION_PAIRS, OPTION_ANCHORED, OPTION_SHAPES };

static bool read_text(const char *path, char **text, size_t *bytes) {
    char error[4096];
    uint8_t *read = NULL;
    bool good = masu_file_read(path, MASU_SDFC_SOURCE_MAX, &read, bytes, error, sizeof error);
    if (!good) masu_cli_error("%s", error);
    *text = (char *)read;
    const char *hint = good ? masu_file_hint(path, read, *bytes, MASU_FILE_SDF) : "";
    if (!*hint) return good;
    masu_cli_error("%s: is not an SDF%s", path, hint);
    return false;
}

/* Before the work. */
static bool is_writable(const char *path) {
    char error[4096];
    if (!path || masu_file_writable(path, error, sizeof error)) return true;
    masu_cli_error("%s", error);
    return false;
}

static bool write_text(const char *path, const char *text) {
    char error[4096];
    if (!path || masu_file_write(path, text, strlen(text), error, sizeof error)) return true;
    masu_cli_error("%s", error);
    return false;
}

/* Each line by itself, since a message of the command line is one line. */
static void report(const char *text, bool warning) {
    char line[1024];
    while (*text) {
        size_t length = strcspn(text, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, text);
        if (warning)
            masu_cli_warn("%s", line);
        else
            masu_cli_error("%s", line);
        text += length + (text[length] == '\n');
    }
}

static int compile(const char *input, const char *glsl, const char *c, const char *table,
                   const masu_sdfc_options *options) {
    char *text = NULL, error[4096];
    size_t bytes = 0;
    masu_sdfc_result result;
    bool good = read_text(input, &text, &bytes) && is_writable(glsl) && is_writable(c) &&
                is_writable(table);
    if (good) {
        masu_cli_progress("checking %s", input);
        good = masu_sdfc_compile_with(text, bytes, input, options, &result, error, sizeof error);
        masu_cli_progress_clear();
        if (good) {
            report(result.warnings, true);
            good = write_text(glsl, result.glsl) && write_text(c, result.c) &&
                   write_text(table, result.table);
            if (good && !masu_cli_quiet()) {
                printf("%s: %u parts of %u forms, %u slots%s, %zu bytes of GLSL\n", input,
                       result.part_count, result.shape_count, result.slot_count,
                       result.dynamic ? " (some change)" : "", strlen(result.glsl));
            }
        } else {
            report(error, false);
        }
        masu_sdfc_release(&result);
    }
    free(text);
    return good ? MASU_CLI_OK : MASU_CLI_FAILURE;
}

static int run(masu_cli *cli) {
    const char *input = NULL, *glsl = NULL, *c = NULL, *table = NULL;
    masu_sdfc_options options = {0};
    for (;;) {
        switch (masu_cli_next(cli)) {
        case OPTION_GLSL: glsl = cli->value; break;
        case OPTION_C: c = cli->value; break;
        case OPTION_TABLE: table = cli->value; break;
        case OPTION_PAIRS:
            if (!masu_cli_uint(cli, 1, 1000000000, &options.pairs)) return MASU_CLI_USAGE;
            break;
        case OPTION_ANCHORED: options.anchored = true; break;
        case OPTION_SHAPES: return masu_sdfc_put_shapes(stdout) ? MASU_CLI_OK : MASU_CLI_FAILURE;
        case MASU_CLI_ARGUMENT:
            if (input) return masu_cli_usage_error("more than one input: %s", cli->value);
            input = cli->value;
            break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END:
            if (!input) return masu_cli_usage_error("no IN.sdf given");
            return compile(input, glsl, c, table, &options);
        }
    }
}

int main(int argc, char **argv) {
    static const masu_cli_option options[] = {
        {"glsl", "FILE", "write the scene's GLSL", OPTION_GLSL, 0},
        {"c", "FILE", "write the reference in double precision as C11", OPTION_C, 0},
        {"table", "FILE", "write parts, bounds and parameters as JSON", OPTION_TABLE, 0},
        {"pairs", "N", "random point pairs tested per part form; default: 20000", OPTION_PAIRS, 0},
        {"anchored", NULL, "keep the precision of the GLSL far from the origin", OPTION_ANCHORED,
         0},
        {"shapes", NULL, "print the table of shapes as Markdown", OPTION_SHAPES, 0},
        {NULL, NULL, NULL, 0, 0},
    };
    static const masu_cli_command command = {
        .arguments = "IN.sdf [options]",
        .summary = "compiles an SDF scene and checks its constants and bounds",
        .options = options,
        .details = "docs/sdf.md describes the language.\n\n"
                   "Exit code: 0 success, 1 error (the message has file, line and column), 2 wrong "
                   "usage.\n",
        .run = run,
    };
    static const masu_cli_command *const commands[] = {&command, NULL};
    static const masu_cli_program program = {
        .name = "masu-sdfc",
        .version = VERSION_TEXT(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH),
        .commands = commands};
    return masu_cli_main(&program, argc, argv);
}

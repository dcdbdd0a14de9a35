/* world.c: `masu-lab world`: writes the folder of a world, ready for masu-bake; see
 * lab/world/world.h. */
#include "lab/command/commands.h"
#include "lab/world/world.h"
#include "image.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

#define TORCS "/usr/share/games/torcs"

enum { OPTION_TORCS = 1 };

static const char *path_of(const char *folder, const char *name) {
    static char path[4096];
    int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    if (length >= 0 && (size_t)length < sizeof path) return path;
    masu_cli_error("the name of the folder is too long");
    return NULL;
}

FILE *masu_world_create(const char *folder, const char *name) {
    const char *path = path_of(folder, name);
    bool regular = path && (!masu_file_exists(path) || masu_file_is_regular(path));
    if (path && !regular) errno = EINVAL;
    FILE *file = regular ? fopen(path, "w") : NULL;
    if (path && !file) masu_cli_error("cannot write %s: %s", path, strerror(errno));
    return file;
}

bool masu_world_close(FILE *file, const char *folder, const char *name) {
    bool bad = ferror(file) != 0;
    if (fclose(file) == 0 && !bad) return true;
    masu_cli_error("cannot write %s/%s: %s", folder, name, strerror(errno));
    return false;
}

static bool make_folder(const char *folder) {
    struct stat about;
    if (mkdir(folder, 0777) == 0 || (stat(folder, &about) == 0 && S_ISDIR(about.st_mode))) {
        return true;
    }
    masu_cli_error("cannot make the folder %s: %s", folder, strerror(errno));
    return false;
}

static int run_city(masu_cli *cli) {
    const char *folder = NULL;
    for (;;) {
        switch (masu_cli_next(cli)) {
        case MASU_CLI_ARGUMENT: folder = cli->value; break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END:
            if (!folder) return masu_cli_usage_error("no folder given");
            return make_folder(folder) && masu_world_city(folder) ? MASU_CLI_OK : MASU_CLI_FAILURE;
        }
    }
}

static int run_forza(masu_cli *cli) {
    const char *folder = NULL, *torcs = TORCS;
    for (;;) {
        switch (masu_cli_next(cli)) {
        case OPTION_TORCS: torcs = cli->value; break;
        case MASU_CLI_ARGUMENT: folder = cli->value; break;
        case MASU_CLI_EXIT: return cli->exit_code;
        case MASU_CLI_END:
            if (!folder) return masu_cli_usage_error("no folder given");
            return make_folder(folder) && masu_world_forza(folder, torcs) ? MASU_CLI_OK
                                                                          : MASU_CLI_FAILURE;
        }
    }
}

static int run(masu_cli *cli) {
    static const masu_cli_option options[] = {
        {"torcs", "DIR", "folder of TORCS's data\n(default " TORCS ")", OPTION_TORCS, 0},
        {NULL, NULL, NULL, 0, 0},
    };
    static const masu_cli_command city = {
        .name = "city",
        .arguments = "FOLDER",
        .summary = "write city.json and its parts: a city on four decks",
        .run = run_city,
    };
    static const masu_cli_command forza = {
        .name = "forza",
        .arguments = "FOLDER [options]",
        .summary = "write forza.json: the track forza of TORCS, ten cars, a lap",
        .options = options,
        .run = run_forza,
    };
    static const masu_cli_command *const commands[] = {&city, &forza, NULL};
    return masu_cli_commands(cli, lab_world.summary, commands);
}

const masu_cli_command lab_world = {.name = "world",
                                    .arguments = "WORLD FOLDER [options]",
                                    .summary = "write the scene of a whole world, for masu-bake",
                                    .run = run};

/* options.h: the options of every command of `masu` and `masu-lab` as rows of a table: the help
 * text, how the value is read, and its member in the command's struct. masu_options_read reads them
 * all. The help prints the defaults that it finds in that struct, so the two cannot disagree. Rows
 * shared by several commands are defined here. */
#ifndef MASU_OPTIONS_H
#define MASU_OPTIONS_H

#include "cli/cli.h"
#include "session.h"

#include <stddef.h>

typedef enum masu_take {
    MASU_TAKE_FLAG,   /* bool: true */
    MASU_TAKE_UINT,   /* uint32_t from min to max */
    MASU_TAKE_REAL,   /* double from min to max */
    MASU_TAKE_TEXT,   /* const char * */
    MASU_TAKE_SIZE,   /* VkExtent2D allowed for PNG: 16384 per side and 64 Mi pixels */
    MASU_TAKE_FILE,   /* const char *: a file to write; checked immediately */
    MASU_TAKE_PNG,    /* the same, with a name that ends in .png */
    MASU_TAKE_IMAGE,  /* the same, with a name that ends in one of MASU_IMAGE_ENDS */
    MASU_TAKE_OUTPUT, /* as MASU_TAKE_FILE, or "-" for stdout */
    MASU_TAKE_CHOICE, /* uint32_t: index of the name */
    MASU_TAKE_KNOB,   /* masu_rung: that knob, with the names and the range of MASU_KNOBS */
    MASU_TAKE_OWN     /* parsed by `read` */
} masu_take;

typedef struct masu_option {
    const char *name;  /* without dashes; "": a heading (MASU_HEADING); NULL ends the table */
    const char *value; /* as in masu_cli_option */
    const char *help;  /* without the default */
    masu_take take;
    char letter;
    size_t at; /* offset in the command's struct */
    double min, max;
    const char *const *names; /* NULL at the end */
    const char *knob;
    /* MASU_TAKE_OWN: parses cli->value into the command's struct. On false the command ends: an
     * error was reported, or cli->exit_code is MASU_CLI_OK because the option was the whole
     * task. */
    bool (*read)(masu_cli *cli, void *options);
} masu_option;

/* The rows: MASU_UINT(options, rays, "rays", 1, 1000000, "of each point") */
#define MASU_ROW(type, member, take_, name_, value_, help_)                                        \
    .name = (name_), .value = (value_), .help = (help_), .take = (take_),                          \
    .at = offsetof(type, member)
#define MASU_FLAG(type, member, name, help)                                                        \
    { MASU_ROW(type, member, MASU_TAKE_FLAG, name, NULL, help) }
#define MASU_UINT(type, member, name, min_, max_, help)                                            \
    { MASU_ROW(type, member, MASU_TAKE_UINT, name, "N", help), .min = (min_), .max = (max_) }
#define MASU_REAL(type, member, name, value, min_, max_, help)                                     \
    { MASU_ROW(type, member, MASU_TAKE_REAL, name, value, help), .min = (min_), .max = (max_) }
#define MASU_TEXT(type, member, name, value, help)                                                 \
    { MASU_ROW(type, member, MASU_TAKE_TEXT, name, value, help) }
#define MASU_SIZE(type, member, name, help)                                                        \
    { MASU_ROW(type, member, MASU_TAKE_SIZE, name, "WxH", help) }
#define MASU_FILE(type, member, name, value, help)                                                 \
    { MASU_ROW(type, member, MASU_TAKE_FILE, name, value, help) }
#define MASU_PNG(type, member, name, help)                                                         \
    { MASU_ROW(type, member, MASU_TAKE_PNG, name, "FILE.png", help) }
#define MASU_IMAGE(type, member, name, help)                                                       \
    { MASU_ROW(type, member, MASU_TAKE_IMAGE, name, "FILE", help) }
#define MASU_OUTPUT(type, member, name, value, help)                                               \
    { MASU_ROW(type, member, MASU_TAKE_OUTPUT, name, value, help) }
#define MASU_CHOICE(type, member, name, value, names_, help)                                       \
    { MASU_ROW(type, member, MASU_TAKE_CHOICE, name, value, help), .names = (names_) }
#define MASU_KNOB(type, member, name, value, knob_, help)                                          \
    { MASU_ROW(type, member, MASU_TAKE_KNOB, name, value, help), .knob = (knob_) }
#define MASU_OWN(name_, value_, read_, help_)                                                      \
    { .name = (name_), .value = (value_), .help = (help_), .take = MASU_TAKE_OWN, .read = (read_) }

/* A heading in the help: the rows up to the next heading are printed below it. */
#define MASU_HEADING(heading)                                                                      \
    { .name = "", .help = (heading), .take = MASU_TAKE_FLAG }

/* For every command that opens a device: `host` is a masu_headless_desc. */
#define MASU_DEVICE_ROWS(type, host)                                                               \
    MASU_TEXT(type, host.device, "device", "NAME|INDEX",                                           \
              "GPU by index or part of its name (default: the first suitable one)"),               \
        MASU_FLAG(type, host.validate, "validate",                                                 \
                  "enable the Khronos validation layer with synchronization checks; any\n"         \
                  "message makes the exit code 1"),                                                \
        MASU_FLAG(type, host.gpu_av, "gpu-av",                                                     \
                  "use the layer's GPU-assisted shader validation instead (slow)")

#define MASU_OUTPUT_SIZE_ROW(type, member)                                                         \
    MASU_SIZE(type, member, "size", "output size in pixels: at most 16384 per side, 64 Mi in all\n")

/* Ray-tracing backend for reflections of polygons; then masu_use_rays. */
extern const char *const masu_ray_ways[];
#define MASU_RAYS_ROW(type, member)                                                                \
    MASU_CHOICE(type, member, "rays", "BACKEND", masu_ray_ways,                                    \
                "ray-tracing backend for reflections of polygons: compute (built-in BVH),\n"       \
                "query (VK_KHR_ray_query), or auto: query on GPUs that support it\n")
/* Requests ray queries from the device unless `way` is `compute`. */
void masu_use_rays(uint32_t way, masu_switch *ray_query, masu_headless_desc *host);

/* A const char *; then masu_use_ladder. */
#define MASU_LADDER_ROW(type, member, off)                                                         \
    MASU_TEXT(type, member, "ladder", "FILE|auto|off",                                             \
              "source of the rungs:\n"                                                             \
              "  FILE  a ladder.json of `masu bench`\n"                                            \
              "  auto  the built-in ladder of the scene's class\n"                                 \
              "  off   " off)
/* NULL: not given. Sets the ladder, or the rungs from a file; returns an exit code. */
int masu_use_ladder(const char *given, masu_desc *desc);

#define MASU_MOMENT_ROW(type, member)                                                              \
    MASU_REAL(type, member, "time", "SECONDS", -1e9, 1e9,                                          \
              "time in the scene and on its camera path")

/* The values of a knob, for its help: MASU_AA_WORDS(MASU_WORD_LIST). */
#define MASU_WORD_LIST(name, value, word, text) " " word

/* The supersampled ground truth image that others are compared with. */
typedef struct masu_truth_options {
    const char *path;   /* PNG to read the image from, or to write it to; NULL: neither */
    uint32_t positions; /* samples per pixel */
    uint32_t rays;      /* reflection rays per pixel, in all */
} masu_truth_options;
#define MASU_TRUTH_ROWS(type, truth)                                                               \
    MASU_TEXT(type, truth.path, "truth", "FILE.png",                                           \
              "ground truth image: read if it exists, else written"),                              \
        MASU_UINT(type, truth.positions, "positions", 1, MASU_PICTURE_POSITIONS_MAX,               \
                  "samples per pixel of the ground truth"),                                        \
        MASU_UINT(type, truth.rays, "reference", 1, 1000000,                                       \
                  "reflection rays per pixel of the ground truth, in all")

/* ---- Reading --------------------------------------------------------------------------------- */

#define MASU_ARGUMENTS_MAX 64u

typedef struct masu_given {
    uint32_t most;      /* maximum number of arguments, at most MASU_ARGUMENTS_MAX */
    const char *excess; /* message for one more: "expected one scene" */
    uint32_t count;
    const char *arguments[MASU_ARGUMENTS_MAX];
    uint64_t options; /* bit i: the i-th row of the table */
} masu_given;

/* Reads the whole command line into *options and *given. On false return *code. */
bool masu_options_read(masu_cli *cli, const masu_option *rows, void *options, masu_given *given,
                       int *code);
bool masu_is_given(const masu_given *given, const masu_option *rows, const char *name);
/* The first of these names (NULL at the end) that is given; NULL: none. */
const char *masu_first_given(const masu_given *given, const masu_option *rows,
                             const char *const *names);

/* The value of --setting, which may be given once, as the only rung of the description. On false
 * the error is printed. */
bool masu_read_setting(masu_cli *cli, masu_desc *desc);

/* "one,two": bit i of the i-th name, of at most 32. */
bool masu_read_names(const char *option, const char *list, const char *const *names, uint32_t count,
                     uint32_t *bits);

#endif

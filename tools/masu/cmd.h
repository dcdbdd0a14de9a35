/* cmd.h: the commands of `masu`, and what they share: the options about the device, and JSON. */
#ifndef MASU_CMD_H
#define MASU_CMD_H

#include "cli/cli.h"
#include "session.h"

#include <jansson.h>

extern const masu_cli_command masu_cmd_render;
extern const masu_cli_command masu_cmd_upscale;
extern const masu_cli_command masu_cmd_plan;
extern const masu_cli_command masu_cmd_bench;
extern const masu_cli_command masu_cmd_model;
extern const masu_cli_command masu_cmd_march_bench;
extern const masu_cli_command masu_cmd_cull_bench;
extern const masu_cli_command masu_cmd_draw_bench;
extern const masu_cli_command masu_cmd_light_bench;
extern const masu_cli_command masu_cmd_ao_bench;
extern const masu_cli_command masu_cmd_specular_bench;
extern const masu_cli_command masu_cmd_trace_bench;
extern const masu_cli_command masu_cmd_bench_image;
extern const masu_cli_command masu_cmd_image_error;
extern const masu_cli_command masu_cmd_compare;
extern const masu_cli_command masu_cmd_whole_bench;
extern const masu_cli_command masu_cmd_plant;
extern const masu_cli_command masu_cmd_conform;
extern const masu_cli_command masu_cmd_ladder;

/* Options of every command that opens a device; ids from 900 on. */
enum { MASU_OPTION_DEVICE = 900, MASU_OPTION_VALIDATE, MASU_OPTION_GPU_AV };
#define MASU_DEVICE_OPTIONS                                                                        \
    {"device", "NAME|INDEX", "GPU by index or part of its name (default: the first that suits)",   \
     MASU_OPTION_DEVICE, 0},                                                                       \
        {"validate", NULL,                                                                         \
         "run under the Khronos validation layer, with synchronisation checks;\n"                  \
         "any message makes the exit code 1",                                                      \
         MASU_OPTION_VALIDATE, 0},                                                                 \
    {                                                                                              \
        "gpu-av", NULL, "run under the layer's GPU-assisted shader checks instead (slow)",         \
            MASU_OPTION_GPU_AV, 0                                                                  \
    }

/* Handles one of them; false if the id is another's. */
bool masu_device_option(masu_cli *cli, int id, masu_headless_desc *host);

/* --rays WAY: what finds the polygons in reflections. A device is asked for ray queries unless it
 * is `compute`; a session begins with auto. */
bool masu_rays_option(masu_cli *cli, masu_session_desc *d);
#define MASU_RAYS_OPTION(id)                                                                       \
    {                                                                                              \
        "rays", "WAY",                                                                             \
            "what finds polygons in reflections: compute; query, which takes a device with ray\n"  \
            "queries; auto, which takes them on GPUs (default auto)",                              \
            id, 0                                                                                  \
    }

/* Reads the option's value as that knob, with the words and the range of MASU_KNOBS. On false the
 * mistake has been reported. MASU_WORD_LIST: the words, for the help, MASU_AA_WORDS(MASU_WORD_LIST). */
bool masu_knob_option(const masu_cli *cli, const char *knob, masu_rung *rung);
#define MASU_WORD_LIST(name, value, word, text) " " word

/* --ladder FILE|auto|off; NULL: it was not given. Sets the ladder, or the rungs out of a file; returns
 * an exit code. */
int masu_ladder_option(const char *given, masu_desc *desc);

/* What commands that compare pictures with the truth have in common; ids from 910 on. `time` is the
 * default, as text. */
enum {
    MASU_OPTION_SIZE = 910,
    MASU_OPTION_TIME,
    MASU_OPTION_TRUTH,
    MASU_OPTION_POSITIONS,
    MASU_OPTION_REFERENCE
};
#define MASU_TRUTH_OPTIONS(time)                                                                   \
    {"size", "WxH", "output size (default 640x360)", MASU_OPTION_SIZE, 0},                         \
        {"time", "SECONDS", "of the scene and its camera (default " time ")", MASU_OPTION_TIME,    \
         0},                                                                                       \
        {"truth", "FILE.png", "read the truth from there, or write it there", MASU_OPTION_TRUTH,   \
         0},                                                                                       \
        {"positions", "N", "places in each pixel that the truth is the mean of (default 64)",      \
         MASU_OPTION_POSITIONS, 0},                                                                \
    {                                                                                              \
        "reference", "N", "rays of reflections from each of its pixels, in all (default 1024)",    \
            MASU_OPTION_REFERENCE, 0                                                               \
    }

/* Where they go. */
typedef struct masu_truth_places {
    VkExtent2D *size;
    double *time;
    const char **path;
    uint32_t *positions, *rays;
} masu_truth_places;

/* 1: it was one of them; 0: the id is another's; -1: a mistake, which has been reported: return
 * MASU_CLI_USAGE. */
int masu_truth_option(const masu_cli *cli, int id, const masu_truth_places *to);

/* --size WxH: what a PNG may hold, 16384 a side and 64 Mi pixels; said before the work is done. */
bool masu_output_size(const masu_cli *cli, VkExtent2D *size);

/* A file that will be written: whether it can be is found out before the work is done. On false the
 * mistake has been reported: return cli->exit_code. The second takes "-", too: stdout. */
bool masu_output_file(masu_cli *cli, const char **path);
bool masu_output_file_or_stdout(masu_cli *cli, const char **path);

/* Validation messages go to stderr as warnings; at the end they are a failure. */
void masu_print_message(void *user, const char *text);
int masu_finish_validation(const masu_headless *host, int code);

/* Driver, versions and memory of a session, as JSON objects (new references). */
json_t *masu_json_device(const masu_headless *host);
json_t *masu_json_memory(const masu_memory *memory);

/* Prints to a file atomically, or to stdout for "-". Returns an exit code, having reported a
 * failure. Takes the reference. */
int masu_json_write(json_t *json, const char *path);

#endif

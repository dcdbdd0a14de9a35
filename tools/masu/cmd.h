/* cmd.h: the commands of `masu`, and what they share: validation at the end, and JSON. Their options are
 * rows of options.h. */
#ifndef MASU_CMD_H
#define MASU_CMD_H

#include "cli/cli.h"
#include "session.h"

#include <jansson.h>

extern const masu_cli_command masu_cmd_render, masu_cmd_upscale, masu_cmd_compare, masu_cmd_plan,
    masu_cmd_bench, masu_cmd_study, masu_cmd_conform, masu_cmd_simulate;

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

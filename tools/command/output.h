/* output.h: output shared by the commands of `masu` and `masu-lab`: messages of the validation
 * layer, the device and its memory as JSON, JSON files. */
#ifndef MASU_COMMAND_OUTPUT_H
#define MASU_COMMAND_OUTPUT_H

#include "cli/cli.h"
#include "session.h"

#include <jansson.h>
#include <stddef.h>

/* Prints a validation message to stderr as a warning. A command that had any ends with
 * masu_finish_validation, which makes its exit code 1. */
void masu_print_message(void *user, const char *text);
int masu_finish_validation(const masu_headless *host, int code);

/* Driver, versions and memory of a session, as JSON objects (new references). */
json_t *masu_json_device(const masu_headless *host);
json_t *masu_json_memory(const masu_memory *memory);

/* Writes a file atomically, or to stdout for "-". Returns an exit code, having reported a
 * failure. */
int masu_text_write(const char *path, const char *text, size_t bytes);
/* Prints to a file atomically, or to stdout for "-". Returns an exit code, having reported a
 * failure. Takes the reference. */
int masu_json_write(json_t *json, const char *path);

#endif

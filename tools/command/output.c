/* output.c: see output.h. */
#include "command/output.h"

#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void masu_print_message(void *user, const char *text) {
    (void)user;
    masu_cli_warn("validation: %s", text);
}

int masu_finish_validation(const masu_headless *host, int code) {
    if (!host->messages || code) return code;
    return masu_cli_error("the validation layer reported %u message%s", host->messages,
                          host->messages == 1 ? "" : "s");
}

json_t *masu_json_device(const masu_headless *host) {
    return json_pack("{s:s, s:s, s:b}", "name", host->properties.deviceName, "driver", host->driver,
                     "validated", host->validating);
}

json_t *masu_json_memory(const masu_memory *m) {
    static const char *const names[MASU_ROLE_COUNT] = {"device", "upload", "readback"};
    json_t *roles = json_object();
    for (uint32_t r = 0; r < MASU_ROLE_COUNT; r++) {
        if (!m->roles[r].bytes) continue;
        json_object_set_new(roles, names[r],
                            json_pack("{s:I, s:I, s:i}", "bytes", (json_int_t)m->roles[r].bytes,
                                      "alignment", (json_int_t)m->roles[r].alignment, "type",
                                      (int)m->roles[r].type));
    }
    return json_pack("{s:I, s:I, s:b, s:I, s:I, s:I, s:o}", "host_bytes", (json_int_t)m->host_bytes,
                     "device_bytes", (json_int_t)m->device_bytes, "unified", m->unified != 0,
                     "transient_unaliased", (json_int_t)m->transient_unaliased, "transient_aliased",
                     (json_int_t)m->transient_aliased, "transient_lower_bound",
                     (json_int_t)m->transient_lower_bound, "roles", roles);
}

int masu_text_write(const char *path, const char *text, size_t bytes) {
    char error[4096];
    /* masu_cli_end reports a failure of stdout. */
    if (!strcmp(path, "-")) return fwrite(text, 1, bytes, stdout), MASU_CLI_OK;
    if (masu_file_write(path, text, bytes, error, sizeof error)) return MASU_CLI_OK;
    return masu_cli_error("%s", error);
}

int masu_json_write(json_t *json, const char *path) {
    char *text = json_dumps(json, JSON_INDENT(2));
    json_decref(json);
    if (!text) return masu_cli_error("%s: out of memory for the JSON text", path);
    size_t n = strlen(text);
    text[n] = '\n'; /* over the terminator: the file needs none */
    int code = masu_text_write(path, text, n + 1);
    free(text);
    return code;
}

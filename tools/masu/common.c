/* common.c: see cmd.h. */
#include "masu/cmd.h"

#include "bench/sweep/knobs.h"
#include "bench/sweep/ladder_file.h"
#include "bench/measure/picture.h"
#include "image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool masu_device_option(masu_cli *cli, int id, masu_headless_desc *host) {
    switch (id) {
    case MASU_OPTION_DEVICE: host->device = cli->value; return true;
    case MASU_OPTION_VALIDATE: host->validate = true; return true;
    case MASU_OPTION_GPU_AV: host->gpu_av = true; return true;
    default: return false;
    }
}

bool masu_rays_option(masu_cli *cli, masu_session_desc *d) {
    static const char *const ways[] = {"auto", "compute", "query", NULL};
    static const masu_switch switches[] = {MASU_AUTO, MASU_OFF, MASU_ON};
    uint32_t way = 0;
    if (!masu_cli_choice(cli, ways, &way)) return false;
    d->desc.ray_query = switches[way];
    d->host.ray_query = switches[way] != MASU_OFF;
    return true;
}

bool masu_knob_option(const masu_cli *cli, const char *knob, masu_rung *rung) {
    const masu_knob *k = masu_knob_find(knob, strlen(knob));
    masu_rung read = *rung;
    const char *end = masu_knob_from_text(k, cli->value, &read);
    if (end && !*end) {
        *rung = read;
        return true;
    }
    char range[200];
    masu_knob_range(k, range, sizeof range);
    masu_cli_usage_error("%s: needed is %s, given is '%s'", cli->option, range, cli->value);
    return false;
}

int masu_ladder_option(const char *given, masu_desc *desc) {
    static masu_ladder_file file;
    char error[1024];
    desc->ladder = !given ? MASU_AUTO : strcmp(given, "auto") ? MASU_OFF : MASU_ON;
    if (!given || !strcmp(given, "auto") || !strcmp(given, "off")) return MASU_CLI_OK;
    if (!masu_ladder_read(given, &file, error, sizeof error)) return masu_cli_error("%s", error);
    masu_ladder_give(&file, desc);
    return MASU_CLI_OK;
}

bool masu_output_size(const masu_cli *cli, VkExtent2D *size) {
    if (!masu_cli_extent(cli, MASU_IMAGE_SIDE_MAX, &size->width, &size->height)) return false;
    if ((uint64_t)size->width * size->height <= MASU_IMAGE_PIXELS_MAX) return true;
    masu_cli_usage_error("%s %s: more than %u pixels", cli->option, cli->value,
                         MASU_IMAGE_PIXELS_MAX);
    return false;
}

int masu_truth_option(const masu_cli *cli, int id, const masu_truth_places *to) {
    bool good = true;
    switch (id) {
    case MASU_OPTION_SIZE: good = masu_output_size(cli, to->size); break;
    case MASU_OPTION_TIME: good = masu_cli_double(cli, -1e9, 1e9, to->time); break;
    case MASU_OPTION_TRUTH: *to->path = cli->value; break;
    case MASU_OPTION_POSITIONS:
        good = masu_cli_uint(cli, 1, MASU_PICTURE_POSITIONS_MAX, to->positions);
        break;
    case MASU_OPTION_REFERENCE: good = masu_cli_uint(cli, 1, 1000000, to->rays); break;
    default: return 0;
    }
    return good ? 1 : -1;
}

bool masu_output_file(masu_cli *cli, const char **path) {
    char error[4096];
    *path = cli->value;
    if (masu_file_writable(cli->value, error, sizeof error)) return true;
    cli->exit_code = masu_cli_error("%s", error);
    return false;
}

bool masu_output_file_or_stdout(masu_cli *cli, const char **path) {
    *path = cli->value;
    return !strcmp(cli->value, "-") || masu_output_file(cli, path);
}

void masu_print_message(void *user, const char *text) {
    (void)user;
    masu_cli_warn("validation: %s", text);
}

int masu_finish_validation(const masu_headless *host, int code) {
    if (!host->messages || code) return code;
    return masu_cli_error("the validation layer has reported %u message%s", host->messages,
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

int masu_json_write(json_t *json, const char *path) {
    char *text = json_dumps(json, JSON_INDENT(2));
    json_decref(json);
    if (!text) return masu_cli_error("%s: no memory for the JSON text", path);
    int code = MASU_CLI_OK;
    if (!strcmp(path, "-")) {
        printf("%s\n", text);
    } else {
        char error[512];
        size_t n = strlen(text);
        text[n] = '\n'; /* over the terminator: the file needs none */
        if (!masu_file_write(path, text, n + 1, error, sizeof error))
            code = masu_cli_error("%s", error);
    }
    free(text);
    return code;
}

/* options.c: see options.h. */
#include "command/options.h"

#include "settings/knobs.h"
#include "settings/ladder_file.h"
#include "settings/setting.h"
#include "file_kind.h"
#include "image.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROWS_MAX = 64, HELP_MAX = 640 }; /* as many rows as masu_given has bits */

/* ---- Values ---------------------------------------------------------------------------------- */

/* Checked before the work starts. */
static bool read_size(const masu_cli *cli, VkExtent2D *size) {
    if (!masu_cli_extent(cli, MASU_IMAGE_SIDE_MAX, &size->width, &size->height)) return false;
    if ((uint64_t)size->width * size->height <= MASU_IMAGE_PIXELS_MAX) return true;
    masu_cli_usage_error("%s: expected at most %u pixels, found %s", cli->option,
                         MASU_IMAGE_PIXELS_MAX, cli->value);
    return false;
}

static bool read_file(masu_cli *cli, const char **path, const char *end) {
    char error[4096];
    *path = cli->value;
    if (end && !masu_file_named(cli->value, end, error, sizeof error)) {
        cli->exit_code = masu_cli_usage_error("%s: %s", cli->option, error);
        return false;
    }
    if (masu_file_writable(cli->value, error, sizeof error)) return true;
    cli->exit_code = masu_cli_error("%s", error);
    return false;
}

static bool read_knob(const masu_cli *cli, const char *name, masu_rung *rung) {
    const masu_knob *knob = masu_knob_find(name, strlen(name));
    masu_rung read = *rung;
    const char *end = masu_knob_from_text(knob, cli->value, &read);
    if (end && !*end) {
        *rung = read;
        return true;
    }
    char range[200];
    masu_knob_range(knob, range, sizeof range);
    masu_cli_usage_error("%s: expected %s, found '%s'", cli->option, range, cli->value);
    return false;
}

static bool read_row(masu_cli *cli, const masu_option *row, void *options) {
    void *to = (char *)options + row->at;
    switch (row->take) {
    case MASU_TAKE_FLAG: *(bool *)to = true; return true;
    case MASU_TAKE_UINT: return masu_cli_uint(cli, (uint32_t)row->min, (uint32_t)row->max, to);
    case MASU_TAKE_REAL: return masu_cli_double(cli, row->min, row->max, to);
    case MASU_TAKE_TEXT: *(const char **)to = cli->value; return true;
    case MASU_TAKE_SIZE: return read_size(cli, to);
    case MASU_TAKE_OUTPUT:
        if (!strcmp(cli->value, "-")) return *(const char **)to = cli->value, true;
        return read_file(cli, to, NULL);
    case MASU_TAKE_FILE: return read_file(cli, to, NULL);
    case MASU_TAKE_PNG: return read_file(cli, to, ".png");
    case MASU_TAKE_IMAGE: return read_file(cli, to, MASU_IMAGE_ENDS);
    case MASU_TAKE_CHOICE: return masu_cli_choice(cli, row->names, to);
    case MASU_TAKE_KNOB: return read_knob(cli, row->knob, to);
    case MASU_TAKE_OWN: return row->read(cli, options);
    }
    return false;
}

/* The default: the value in the struct before any option is read; "": no default to print. */
static void print_default(const masu_option *row, const void *options, char *text, size_t size) {
    const void *from = (const char *)options + row->at;
    text[0] = 0;
    switch (row->take) {
    case MASU_TAKE_UINT:
        if (*(const uint32_t *)from) snprintf(text, size, "%u", *(const uint32_t *)from);
        return;
    case MASU_TAKE_REAL:
        if (*(const double *)from != 0.0) snprintf(text, size, "%.4g", *(const double *)from);
        return;
    case MASU_TAKE_TEXT:
        if (*(const char *const *)from) snprintf(text, size, "%s", *(const char *const *)from);
        return;
    case MASU_TAKE_SIZE: {
        const VkExtent2D *extent = from;
        if (extent->width) snprintf(text, size, "%ux%u", extent->width, extent->height);
        return;
    }
    case MASU_TAKE_CHOICE: snprintf(text, size, "%s", row->names[*(const uint32_t *)from]); return;
    default: return;
    }
}

/* ---- The loop -------------------------------------------------------------------------------- */

bool masu_options_read(masu_cli *cli, const masu_option *rows, void *options, masu_given *given,
                       int *code) {
    masu_cli_option list[ROWS_MAX + 1];
    char help[ROWS_MAX][HELP_MAX];
    uint32_t count = 0;
    for (; rows[count].name && count < ROWS_MAX; count++) {
        const masu_option *row = &rows[count];
        char value[96];
        print_default(row, options, value, sizeof value);
        size_t length = strlen(row->help);
        bool broken = length && row->help[length - 1] == '\n';
        if (*value)
            snprintf(help[count], HELP_MAX, "%s%s(default %s)", row->help, broken ? "" : " ",
                     value);
        else
            snprintf(help[count], HELP_MAX, "%.*s", (int)(length - broken), row->help);
        list[count] =
            (masu_cli_option){row->name, row->value, help[count], (int)count + 1, row->letter};
    }
    list[count] = (masu_cli_option){NULL, NULL, NULL, 0, 0};
    const masu_cli_command *own = cli->command;
    masu_cli_command command = *own;
    command.options = list;
    cli->command = &command;
    bool good = false;
    for (;;) {
        int id = masu_cli_next(cli);
        if (id == MASU_CLI_EXIT) break;
        good = id == MASU_CLI_END;
        if (good) break;
        cli->exit_code = MASU_CLI_USAGE;
        if (id == MASU_CLI_ARGUMENT) {
            if (given->count == given->most) {
                masu_cli_usage_error("unexpected argument '%s': %s", cli->value, given->excess);
                break;
            }
            given->arguments[given->count++] = cli->value;
            continue;
        }
        if (!read_row(cli, &rows[id - 1], options)) break;
        given->options |= (uint64_t)1 << (id - 1);
    }
    cli->command = own;
    *code = good ? MASU_CLI_OK : cli->exit_code;
    return good;
}

bool masu_is_given(const masu_given *given, const masu_option *rows, const char *name) {
    for (uint32_t i = 0; rows[i].name; i++) {
        if (!strcmp(rows[i].name, name)) return given->options >> i & 1;
    }
    return false;
}

const char *masu_first_given(const masu_given *given, const masu_option *rows,
                             const char *const *names) {
    for (; *names; names++) {
        if (masu_is_given(given, rows, *names)) return *names;
    }
    return NULL;
}

/* ---- Values that several commands read ------------------------------------------------------- */

const char *const masu_ray_ways[] = {"auto", "compute", "query", NULL};

void masu_use_rays(uint32_t way, masu_switch *ray_query, masu_headless_desc *host) {
    static const masu_switch switches[] = {MASU_AUTO, MASU_OFF, MASU_ON};
    *ray_query = switches[way];
    host->ray_query = switches[way] != MASU_OFF;
}

int masu_use_ladder(const char *given, masu_desc *desc) {
    static masu_ladder_file file;
    char error[1024];
    desc->ladder = !given ? MASU_AUTO : strcmp(given, "auto") ? MASU_OFF : MASU_ON;
    if (!given || !strcmp(given, "auto") || !strcmp(given, "off")) return MASU_CLI_OK;
    if (!masu_ladder_read(given, &file, error, sizeof error)) return masu_cli_error("%s", error);
    masu_ladder_give(&file, desc);
    return MASU_CLI_OK;
}

bool masu_read_setting(masu_cli *cli, masu_desc *desc) {
    char error[600];
    if (desc->rung_count) {
        masu_cli_usage_error("--setting given twice: join the values by '+', as scale=0.5+aa=fxaa");
        return false;
    }
    desc->rung_count = 1;
    if (masu_setting_parse(cli->value, &desc->rungs[0], error, sizeof error)) return true;
    masu_cli_usage_error("%s", error);
    return false;
}

bool masu_read_names(const char *option, const char *list, const char *const *names, uint32_t count,
                     uint32_t *bits) {
    const char *at = list;
    *bits = 0;
    do {
        size_t length = strcspn(at, ",");
        uint32_t i = 0;
        while (i < count && (strlen(names[i]) != length || strncmp(names[i], at, length) != 0)) i++;
        if (i == count) {
            masu_cli_usage_error("%s: unknown name \"%.*s\"", option, (int)length, at);
            return false;
        }
        *bits |= 1u << i;
        at += length + (at[length] == ',');
    } while (*at);
    return true;
}

/* cmd.h: the commands of `masu`, one file NAME.c each. Their options are rows of
 * command/options.h. */
#ifndef MASU_CMD_H
#define MASU_CMD_H

#include "command/output.h"

extern const masu_cli_command masu_cmd_render, masu_cmd_upscale, masu_cmd_compare, masu_cmd_plan,
    masu_cmd_bench, masu_cmd_conform;

#endif

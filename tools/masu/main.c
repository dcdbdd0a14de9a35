/* main.c: the program `masu`; each command is a file NAME.c in this folder. */
#include "cli/cli.h"
#include "masu/cmd.h"

#include "masu.h"

#define TEXT(x) #x
#define VERSION_TEXT(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

int main(int argc, char **argv) {
    static const masu_cli_command *const commands[] = {
        &masu_cmd_render, &masu_cmd_upscale, &masu_cmd_compare, &masu_cmd_plan,
        &masu_cmd_bench,  &masu_cmd_conform, NULL};
    static const masu_cli_program program = {
        .name = "masu",
        .version = VERSION_TEXT(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH),
        .summary = "fixed-memory hybrid renderer: polygons and SDFs, FSR1, headless",
        .commands = commands};
    return masu_cli_main(&program, argc, argv);
}

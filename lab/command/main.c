/* main.c: the program `masu-lab`: studies of the renderer; see lab/README.md. */
#include "lab/command/commands.h"

#include "masu.h"

#define TEXT(x) #x
#define VERSION_TEXT(a, b, c) TEXT(a) "." TEXT(b) "." TEXT(c)

int main(int argc, char **argv) {
    static const masu_cli_command *const commands[] = {
        &lab_study, &lab_model, &lab_isa, &lab_simulate, &lab_meso, &lab_world, &lab_ladder,
        &lab_reference, NULL};
    static const masu_cli_program program = {
        .name = "masu-lab",
        .version = VERSION_TEXT(MASU_VERSION_MAJOR, MASU_VERSION_MINOR, MASU_VERSION_PATCH),
        .summary = "studies of the Masu renderer: comparisons, cost models, generated worlds",
        .commands = commands};
    return masu_cli_main(&program, argc, argv);
}

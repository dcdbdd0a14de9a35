/* commands.h: the commands of `masu-lab`, one file NAME.c each (study: lab/study/study.c). */
#ifndef LAB_COMMANDS_H
#define LAB_COMMANDS_H

#include "command/options.h"
#include "command/output.h"

extern const masu_cli_command lab_study, lab_model, lab_isa, lab_simulate, lab_meso, lab_world,
    lab_ladder, lab_reference;

#endif

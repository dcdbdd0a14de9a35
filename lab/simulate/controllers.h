/* controllers.h: the controllers that `masu-lab simulate` compares: the library's governor first,
 * then the rules of other engines. */
#ifndef LAB_CONTROLLERS_H
#define LAB_CONTROLLERS_H

#include "support/simulated_gpu.h"

/* masu, three_state, filament, filament_10, unreal */
extern const sim_controller *const sim_controllers[];
extern const uint32_t sim_controller_count;

#endif

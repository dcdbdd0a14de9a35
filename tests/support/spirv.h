/* spirv.h: SPIR-V modules compiled from GLSL sources. */
#ifndef SUPPORT_SPIRV_H
#define SUPPORT_SPIRV_H

#include "spirv/spirv.h"

/* Runs glslang on a source; 0 if it does not compile. `options` are added to its command line. */
int spirv_compile(const char *source_path, const char *options, spirv_module *out);

#endif

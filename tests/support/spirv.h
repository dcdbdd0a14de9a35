/* spirv.h: spirv.h, and modules made of sources. */
#ifndef SUPPORT_SPIRV_H
#define SUPPORT_SPIRV_H

#include "spirv/spirv.h"

/* Glslang on a source; 0 if it does not compile. `options` are put on its command line. */
int spirv_compile(const char *source_path, const char *options, spirv_module *out);

#endif

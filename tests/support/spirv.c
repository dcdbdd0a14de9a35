/* spirv.c: see spirv.h. */
#include "support/spirv.h"

#include <stdio.h>
#include <stdlib.h>

int spirv_compile(const char *source_path, const char *options, spirv_module *out) {
    char binary[64] = "/tmp/masu_spirv_XXXXXX", command[1024];
    int handle = mkstemp(binary);
    if (handle < 0) return 0;
    FILE *file = fdopen(handle, "w"); /* only the name is needed */
    if (file) (void)fclose(file);
    (void)snprintf(command, sizeof command,
                   "glslangValidator --quiet -V --target-env vulkan1.1 %s -o %s %s", options,
                   binary, source_path);
    int good = system(command) == 0 && spirv_from_file(binary, out);
    (void)remove(binary);
    return good;
}

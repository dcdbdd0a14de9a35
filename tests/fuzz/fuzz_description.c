/* fuzz_description.c: any bytes as a scene's JSON (docs/scene.md). A refusal is told in lines that name the file; what
 * is accepted has what the baker takes for granted. The files that it names are not opened here. */
#include "in_file.h"

#include "bake/description/description.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    masu_bake_options options = {.models_directory = "/nowhere"};
    masu_bake_description d;
    options.input = in_file("x.json", data, size, path);
    if (masu_bake_read(&options, &d)) {
        EXPECT(d.model_count || d.sdf.source);
        for (size_t i = 0; i < d.model_count; i++) {
            for (int k = 0; k < 12; k++)
                EXPECT(d.models[i].placement.m[k] - d.models[i].placement.m[k] == 0);
        }
    } else {
        EXPECT(strstr(in_file_said, "x.json"));
    }
    masu_bake_description_release(&d);
    return 0;
}

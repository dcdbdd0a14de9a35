/* fuzz_panorama.c: any bytes as a sky: a Radiance .hdr if they begin like one, else a .pfm. A refusal is a line that
 * names the file; what is accepted is light: finite, not negative. */
#include "in_file.h"

#include "bake/light/environment.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    masu_bake_panorama sky;
    in_file(size && *data == '#' ? "x.hdr" : "x.pfm", data, size, path);
    if (masu_bake_load_panorama(path, &sky)) {
        EXPECT(sky.rgb && sky.width && sky.height && !*in_file_said);
        for (size_t i = 0; i < 3 * (size_t)sky.width * sky.height; i++)
            EXPECT(sky.rgb[i] >= 0 && sky.rgb[i] - sky.rgb[i] == 0);
    } else {
        EXPECT(strstr(in_file_said, path));
    }
    free(sky.rgb);
    return 0;
}

/* video.c: see video.h. */
#include "command/video.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool failed(const masu_video *v, char *error, size_t size) {
    snprintf(error, size, "%s: cannot write: %s", v->path, strerror(errno));
    return false;
}

bool masu_video_open(masu_video *v, const char *path, uint32_t width, uint32_t height,
                     double seconds, char *error, size_t error_size) {
    const bool standard = !strcmp(path, "-");
    *v =
        (masu_video){.path = standard ? "standard output" : path, .width = width, .height = height};
    v->planes = malloc(3 * (size_t)width * height);
    if (!v->planes) {
        snprintf(error, error_size, "%s: out of memory for a frame of %ux%u", v->path, width,
                 height);
        return false;
    }
    v->file = standard ? stdout : fopen(path, "wb");
    if (!v->file) return failed(v, error, error_size);
    const double rate = 1.0 / seconds;
    const bool whole = fabs(rate - round(rate)) < 1e-6 * rate && rate < 1e6;
    const unsigned long above = whole ? (unsigned long)round(rate) : 1000000ul;
    const unsigned long below = whole ? 1ul : (unsigned long)fmax(round(seconds * 1e6), 1.0);
    return fprintf(v->file, "YUV4MPEG2 W%u H%u F%lu:%lu Ip A1:1 C444 XCOLORRANGE=LIMITED\n", width,
                   height, above, below) > 0 ||
           failed(v, error, error_size);
}

bool masu_video_frame(masu_video *v, const uint8_t *rgba, char *error, size_t error_size) {
    const size_t pixels = (size_t)v->width * v->height;
    for (size_t i = 0; i < pixels; i++, rgba += 4) {
        const double r = rgba[0] / 255.0, g = rgba[1] / 255.0, b = rgba[2] / 255.0;
        const double y = 0.2126 * r + 0.7152 * g + 0.0722 * b;
        v->planes[i] = (uint8_t)(16.5 + 219.0 * y);
        v->planes[pixels + i] = (uint8_t)(128.5 + 224.0 * (b - y) / 1.8556);
        v->planes[2 * pixels + i] = (uint8_t)(128.5 + 224.0 * (r - y) / 1.5748);
    }
    if (fputs("FRAME\n", v->file) < 0 || fwrite(v->planes, 1, 3 * pixels, v->file) != 3 * pixels)
        return failed(v, error, error_size);
    return true;
}

bool masu_video_close(masu_video *v, char *error, size_t error_size) {
    bool good = !v->file || (v->file == stdout ? fflush(v->file) : fclose(v->file)) == 0 ||
                failed(v, error, error_size);
    free(v->planes);
    *v = (masu_video){0};
    return good;
}

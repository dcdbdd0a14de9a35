/* write.c: see write.h. */
#include "meso/write.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "bake/texture/texel.h"
#include "cli/cli.h"
#include "image.h"

/* ---- text ---- */

typedef struct text {
    char *data;
    size_t bytes, room;
} text;

MASU_CLI_PRINTF(2, 3) static void add(text *t, const char *format, ...) {
    if (t->room - t->bytes < 1024) {
        t->room = t->room * 2 + 8192;
        t->data = realloc(t->data, t->room);
        if (!t->data) exit(masu_cli_error("out of memory"));
    }
    va_list arguments;
    va_start(arguments, format);
    int n = vsnprintf(t->data + t->bytes, t->room - t->bytes, format, arguments);
    va_end(arguments);
    if (n > 0) t->bytes += (size_t)n < 1024 ? (size_t)n : 1023;
}

static const char *path_of(const char *name, const char *end) {
    static char path[4352];
    snprintf(path, sizeof path, "%s%s", name, end);
    return path;
}

static bool save(const char *path, text *t) {
    char error[1024];
    bool good = masu_file_write(path, t->data, t->bytes, error, sizeof error);
    if (!good) masu_cli_error("%s", error);
    free(t->data);
    *t = (text){0};
    return good;
}

/* ---- curves ---- */

static void add_three(text *t, const char *name, const double v[3], const char *end) {
    add(t, "  \"%s\": [%.6g, %.6g, %.6g]%s\n", name, v[0], v[1], v[2], end);
}

bool masu_meso_write_curves(const char *name, const masu_meso_material *made) {
    const masu_meso_curves *c = &made->curves;
    text t = {0};
    add(&t, "{\n");
    add_three(&t, "tilt", c->tilt, ",");
    add_three(&t, "rough", c->rough, ",");
    add_three(&t, "open", c->ao, ",");
    add_three(&t, "gain", c->gain, ",");
    add_three(&t, "tint", c->tint, ",");
    add_three(&t, "specular", c->specular, ",");
    add(&t, "  \"facet_roughness\": %.6g,\n  \"spread\": [%.6g, %.6g, %.6g],\n", c->facet,
        c->spread, c->spread1, c->spread2);
    add(&t, "  \"alpha\": %.6g,\n  \"offset\": %.6g\n}\n", c->alpha, c->offset);
    return save(path_of(name, ".json"), &t);
}

/* ---- maps ---- */

enum { MAP_COLOR, MAP_NORMAL, MAP_ROUGH, MAP_AO, MAPS };
static const char *const ends[MAPS + 1] = {"_color.png", "_normal.png", "_rough.png", "_ao.png",
                                           ".json"};

bool masu_meso_can_write(const char *name) {
    char error[4096];
    for (int i = 0; i <= MAPS; i++) {
        if (masu_file_writable(path_of(name, ends[i]), error, sizeof error)) continue;
        masu_cli_error("%s", error);
        return false;
    }
    return true;
}

static void encode(const masu_meso_texel *t, int map, uint8_t rgba[4]) {
    for (int k = 0; k < 3; k++) {
        double n = k == 0 ? t->normal[0] : k == 1 ? -t->normal[2] : t->normal[1];
        switch (map) {
        case MAP_COLOR: rgba[k] = masu_texel_to_srgb((float)t->color[k]); break;
        case MAP_NORMAL: rgba[k] = (uint8_t)(128.5 + 127 * n); break;
        case MAP_ROUGH: rgba[k] = masu_texel_to_unorm((float)t->roughness); break;
        default: rgba[k] = masu_texel_to_unorm((float)t->ao); break;
        }
    }
    rgba[3] = 255;
}

bool masu_meso_write_maps(const char *name, const masu_meso_material *made) {
    size_t texels = (size_t)made->size * made->size;
    uint8_t *rgba = malloc(texels * 4);
    if (!rgba) exit(masu_cli_error("out of memory"));
    bool good = true;
    for (int map = 0; map < MAPS && good; map++) {
        char error[1024];
        for (size_t i = 0; i < texels; i++) encode(&made->texels[i], map, rgba + 4 * i);
        good = masu_image_save_png(path_of(name, ends[map]), rgba, made->size, made->size, 0,
                                   error, sizeof error);
        if (!good) masu_cli_error("%s", error);
    }
    free(rgba);
    return good;
}

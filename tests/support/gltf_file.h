/* gltf_file.h: writes small glTF files: buffer views and accessors one after the other, then the
 * rest of the JSON. One file at a time, in static storage. Included by the tests that read the
 * files (test_gltf.c) and those that render them (test_gltf_pictures.c,
 * test_bounce.c), after cmocka.h. Overflow fails the test. */
#ifndef SUPPORT_GLTF_FILE_H
#define SUPPORT_GLTF_FILE_H

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "support/files.h"

enum { BYTE = 5120, UBYTE, SHORT, USHORT, UINT = 5125, FLOAT };

/* ---- Files ----------------------------------------------------------------------------------- */

static struct {
    unsigned char data[16384];
    size_t bytes;
    char views[4096], accessors[8192];
    int view_count, accessor_count;
} file;

static inline void begin(void) { memset(&file, 0, sizeof file); }

static inline void add(char *to, size_t room, const char *format, ...) {
    size_t length = strlen(to);
    va_list arguments;
    va_start(arguments, format);
    int wrote = vsnprintf(to + length, room - length, format, arguments);
    va_end(arguments);
    assert_true(wrote >= 0 && (size_t)wrote < room - length);
}

static inline size_t put(const void *data, size_t bytes) {
    size_t at = file.bytes = (file.bytes + 3) & ~(size_t)3;
    assert_true(at + bytes <= sizeof file.data);
    memcpy(file.data + at, data, bytes);
    file.bytes = at + bytes;
    return at;
}

static inline int view(const void *data, size_t bytes, int stride) {
    size_t at = put(data, bytes);
    add(file.views, sizeof file.views, "%s{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":%zu",
        file.view_count ? "," : "", at, bytes);
    if (stride) add(file.views, sizeof file.views, ",\"byteStride\":%d", stride);
    add(file.views, sizeof file.views, "}");
    return file.view_count++;
}

static inline int accessor(int view_index, int type, const char *shape, unsigned count,
                           const char *more) {
    add(file.accessors, sizeof file.accessors,
        "%s{\"componentType\":%d,\"type\":\"%s\",\"count\":%u%s", file.accessor_count ? "," : "",
        type, shape, count, more);
    if (view_index >= 0)
        add(file.accessors, sizeof file.accessors, ",\"bufferView\":%d", view_index);
    add(file.accessors, sizeof file.accessors, "}");
    return file.accessor_count++;
}

static inline int floats(const float *values, const char *shape, unsigned count,
                         unsigned components) {
    return accessor(view(values, count * components * sizeof *values, 0), FLOAT, shape, count, "");
}

static inline int shorts(const uint16_t *indices, unsigned count) {
    return accessor(view(indices, count * sizeof *indices, 0), USHORT, "SCALAR", count, "");
}

/* Adds the rest of the file's members, writes it as a .glb and returns its path. */
static inline const char *finish(const char *format, ...) {
    static unsigned char out[65536];
    static char text[32768], rest[16384];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(rest, sizeof rest, format, arguments);
    va_end(arguments);
    while (file.bytes % 4) file.bytes++;
    size_t length = (size_t)snprintf(
        text, sizeof text,
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu},{\"byteLength\":4096}],"
        "\"bufferViews\":[%s],\"accessors\":[%s],%s}",
        file.bytes, file.views, file.accessors, rest);
    while (length % 4) text[length++] = ' ';
    uint32_t head[5] = {0x46546C67, 2, (uint32_t)(20 + length + 8 + file.bytes), (uint32_t)length,
                        0x4E4F534A};
    uint32_t chunk[2] = {(uint32_t)file.bytes, 0x004E4942};
    memcpy(out, head, 20);
    memcpy(out + 20, text, length);
    memcpy(out + 20 + length, chunk, 8);
    memcpy(out + 28 + length, file.data, file.bytes);
    return write_bytes("x.glb", out, 28 + length + file.bytes);
}

/* A quad in z = 0, with these additional members in its primitive. */
static const float corners[12] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};
static const uint16_t two[6] = {0, 1, 2, 0, 2, 3};
static int quad_positions, quad_indices;

static inline void begin_quad(void) {
    begin();
    quad_positions = floats(corners, "VEC3", 4, 3);
    quad_indices = shorts(two, 6);
}

static inline const char *finish_quad(const char *attributes, const char *primitive,
                                      const char *rest) {
    return finish("\"meshes\":[{\"name\":\"quad\",\"primitives\":[{\"attributes\":{\"POSITION\":%d%"
                  "s},\"indices\":%d%s}]}],"
                  "\"nodes\":[{\"mesh\":0}],\"scenes\":[{\"nodes\":[0]}]%s",
                  quad_positions, attributes, quad_indices, primitive, rest);
}

/* A quad of 2 x 1, with positions as attribute 0 and texture coordinates as 1, encoded by
 * draco::Encoder with 11 and 10 bits. */
static const unsigned char packed_quad[132] = {
    0x44, 0x52, 0x41, 0x43, 0x4F, 0x02, 0x02, 0x01, 0x01, 0x00, 0x00, 0x00, 0x04, 0x02, 0x01, 0x02,
    0x00, 0x00, 0x01, 0x1F, 0xFF, 0x01, 0x11, 0xFF, 0x01, 0x11, 0x02, 0xFF, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x01, 0x00, 0x09, 0x03, 0x00, 0x00, 0x02, 0x01, 0x03, 0x09, 0x02, 0x00, 0x01, 0x02, 0x01,
    0x01, 0x01, 0x00, 0x0C, 0x03, 0x01, 0x20, 0x01, 0x10, 0x1F, 0x01, 0x10, 0x03, 0x00, 0x14, 0x90,
    0x08, 0xC0, 0xFF, 0x01, 0x20, 0x00, 0x00, 0x00, 0x00, 0x00, 0xFF, 0x07, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x40, 0x0B, 0x01,
    0x01, 0x01, 0x00, 0x03, 0x03, 0x01, 0x20, 0x01, 0x20, 0x03, 0x00, 0xF0, 0x83, 0xA6, 0x00, 0x00,
    0x00, 0x00, 0x00, 0xFF, 0x03, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,
    0x00, 0x80, 0x3F, 0x0A};

static inline const char *packed(size_t bytes, const char *attributes) {
    begin();
    int v = view(packed_quad, bytes, 0);
    int p = accessor(-1, FLOAT, "VEC3", 4, ""), t = accessor(-1, FLOAT, "VEC2", 4, ""),
        i = accessor(-1, USHORT, "SCALAR", 6, "");
    return finish("\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"meshes\":[{"
                  "\"primitives\":[{\"attributes\":"
                  "{\"POSITION\":%d,\"TEXCOORD_0\":%d},\"indices\":%d,\"extensions\":{\"KHR_draco_"
                  "mesh_compression\":{\"bufferView\":%d,"
                  "\"attributes\":%s}}}]}],\"nodes\":[{\"mesh\":0}]",
                  p, t, i, v, attributes);
}

/* 4 x 4 red texels: a lossless WebP of 36 bytes. */
static const unsigned char webp[36] = {0x52, 0x49, 0x46, 0x46, 0x1c, 0x00, 0x00, 0x00, 0x57,
                                       0x45, 0x42, 0x50, 0x56, 0x50, 0x38, 0x4c, 0x0f, 0x00,
                                       0x00, 0x00, 0x2f, 0x03, 0xc0, 0x00, 0x00, 0x07, 0x10,
                                       0xfd, 0x8f, 0xfe, 0x07, 0x22, 0xa2, 0xff, 0x01, 0x00};

/* Two joints. The second, which the upper vertices follow, is 5 to the right of its bind position.
 * how: interpolation of an animation clip of that joint, with three keys of values `moves`. */
static inline const char *skinned(const char *how, const float *moves, unsigned count) {
    static const uint8_t joints[16] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const float weights[16] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
    static const float bind[32] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1};
    static const float times[3] = {0, 1, 2};
    begin_quad();
    int j = accessor(view(joints, 16, 4), UBYTE, "VEC4", 4, ""), w = floats(weights, "VEC4", 4, 4),
        b = floats(bind, "MAT4", 2, 16);
    int t = floats(times, "SCALAR", 3, 1), m = floats(moves, "VEC3", count, 3);
    return finish("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":%d,\"JOINTS_0\":%d,"
                  "\"WEIGHTS_0\":%d},\"indices\":%d}]}],"
                  "\"nodes\":[{\"name\":\"skin\",\"mesh\":0,\"skin\":0,\"translation\":[100,0,0]},{"
                  "\"name\":\"low\",\"children\":[2]},"
                  "{\"name\":\"high\",\"translation\":[6,0,0]}],\"scenes\":[{\"nodes\":[0,1]}],"
                  "\"skins\":[{\"joints\":[1,2],\"inverseBindMatrices\":%d}],"
                  "\"animations\":[{\"name\":\"go\",\"channels\":[{\"sampler\":0,\"target\":{"
                  "\"node\":2,\"path\":\"translation\"}}],"
                  "\"samplers\":[{\"input\":%d,\"output\":%d,\"interpolation\":\"%s\"}]}]",
                  quad_positions, j, w, quad_indices, b, t, m, how);
}

#endif

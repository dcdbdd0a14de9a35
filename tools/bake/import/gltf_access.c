/* gltf_access.c: converts buffer views and accessors of a glTF file to numbers; see gltf.h.
 *
 * Sizes in the file are at most 2^53 (gltf_json.c), so the sum of two does not overflow; products
 * are checked by division. */
#include "bake/import/gltf.h"

#include <meshoptimizer.h>
#include <string.h>

#define UNPACKED_MAX ((uint64_t)1 << 30) /* bytes of one compressed view */
#define ZEROS_MAX ((uint64_t)1 << 24)    /* elements of an accessor without a view */

enum { BYTE = 5120, UBYTE, SHORT, USHORT, UINT = 5125, FLOAT };

static bool slice(masu_gltf *g, uint64_t buffer, uint64_t offset, uint64_t bytes,
                  masu_gltf_bytes *out) {
    const masu_gltf_bytes *b = &g->buffers[buffer];
    if (!b->data)
        return masu_gltf_fail(g, "buffers[%llu] holds no bytes", (unsigned long long)buffer);
    if (offset > b->bytes || bytes > b->bytes - offset) {
        return masu_gltf_fail(g, "bytes %llu to %llu of buffers[%llu], which has %zu",
                              (unsigned long long)offset, (unsigned long long)(offset + bytes),
                              (unsigned long long)buffer, b->bytes);
    }
    out->data = b->data + offset;
    out->bytes = (size_t)bytes;
    return true;
}

static bool place_of(masu_gltf *g, const json_t *view, uint64_t *offset, uint64_t *bytes,
                     uint64_t *stride, json_int_t *buffer) {
    if (!masu_gltf_index(g, view, "buffer", g->buffer_count, buffer) ||
        !masu_gltf_size(g, view, "byteOffset", offset) ||
        !masu_gltf_size(g, view, "byteLength", bytes) ||
        !masu_gltf_size(g, view, "byteStride", stride))
        return false;
    return *buffer >= 0 || masu_gltf_fail(g, "\"buffer\" is missing");
}

/* ---- EXT_meshopt_compression ---- */

static bool unpack(masu_gltf *g, const json_t *about, masu_gltf_bytes *out, size_t *stride) {
    uint64_t offset = 0, bytes = 0, step = 0, count = 0;
    json_int_t buffer = -1;
    const char *mode = masu_gltf_string(g, about, "mode");
    const char *filter = masu_gltf_string(g, about, "filter");
    masu_gltf_bytes from;
    if (!place_of(g, about, &offset, &bytes, &step, &buffer) ||
        !masu_gltf_size(g, about, "count", &count) ||
        !slice(g, (uint64_t)buffer, offset, bytes, &from))
        return false;
    bool attributes = mode && strcmp(mode, "ATTRIBUTES") == 0;
    bool triangles = mode && strcmp(mode, "TRIANGLES") == 0;
    bool indices = mode && strcmp(mode, "INDICES") == 0;
    if (filter && strcmp(filter, "NONE") == 0) filter = NULL;
    if (!attributes && !triangles && !indices)
        return masu_gltf_fail(g, "EXT_meshopt_compression has no mode \"%s\"", mode ? mode : "");
    if (attributes ? step < 4 || step > 256 || step % 4 : step != 2 && step != 4)
        return masu_gltf_fail(g, "EXT_meshopt_compression has a byteStride of %llu",
                              (unsigned long long)step);
    if (count == 0 || count > UNPACKED_MAX / step || (triangles && count % 3))
        return masu_gltf_fail(g, "EXT_meshopt_compression has a count of %llu",
                              (unsigned long long)count);
    bool oct = filter && strcmp(filter, "OCTAHEDRAL") == 0;
    bool quat = filter && strcmp(filter, "QUATERNION") == 0;
    bool exponential = filter && strcmp(filter, "EXPONENTIAL") == 0;
    if (filter && (!attributes || !(oct || quat || exponential) ||
                   (oct && step != 4 && step != 8) || (quat && step != 8)))
        return masu_gltf_fail(g, "EXT_meshopt_compression has no filter \"%s\" here", filter);
    unsigned char *data = masu_gltf_take(g, count, step);
    int failed = attributes ? meshopt_decodeVertexBuffer(data, count, step, from.data, from.bytes)
                 : triangles
                     ? meshopt_decodeIndexBuffer(data, count, step, from.data, from.bytes)
                     : meshopt_decodeIndexSequence(data, count, step, from.data, from.bytes);
    if (failed) return masu_gltf_fail(g, "EXT_meshopt_compression: the bytes are damaged");
    if (oct) meshopt_decodeFilterOct(data, count, step);
    if (quat) meshopt_decodeFilterQuat(data, count, step);
    if (exponential) meshopt_decodeFilterExp(data, count, step);
    out->data = data;
    out->bytes = (size_t)(count * step);
    *stride = attributes ? (size_t)step : 0;
    return true;
}

bool masu_gltf_view(masu_gltf *g, json_int_t index, masu_gltf_bytes *out, size_t *stride) {
    const json_t *view = masu_gltf_element(g, "bufferViews", index);
    if (!view) return false;
    const json_t *packed = masu_gltf_extension(g, view, "EXT_meshopt_compression");
    uint64_t offset = 0, bytes = 0, step = 0;
    json_int_t buffer = -1;
    if (!place_of(g, view, &offset, &bytes, &step, &buffer)) return false;
    if (step > 4096)
        return masu_gltf_fail(g, "bufferViews[%d] has a byteStride over 4096", (int)index);
    *stride = (size_t)step;
    if (!packed) return slice(g, (uint64_t)buffer, offset, bytes, out);
    if (!g->views[index].data) {
        size_t own = 0;
        if (!unpack(g, packed, &g->views[index], &own)) return false;
        if (step && own && step != own)
            return masu_gltf_fail(g,
                                  "EXT_meshopt_compression has another byteStride than its view");
    }
    *out = g->views[index];
    if (!*stride) {
        uint64_t own = 0;
        if (!masu_gltf_size(g, packed, "byteStride", &own)) return false;
        *stride = (size_t)own;
    }
    return true;
}

/* ---- accessors ---- */

typedef struct accessor {
    const unsigned char *data; /* NULL: zeros */
    size_t stride;
    uint32_t count;
    unsigned components, size; /* of one component, bytes */
    unsigned type;
    bool normalized;
    uint32_t sparse; /* elements that are stored separately */
    const unsigned char *at, *values;
    unsigned at_type;
} accessor;

static unsigned size_of(uint64_t type) {
    switch (type) {
    case BYTE:
    case UBYTE: return 1;
    case SHORT:
    case USHORT: return 2;
    case UINT:
    case FLOAT: return 4;
    default: return 0;
    }
}

static unsigned components_of(const char *type) {
    static const struct {
        const char *name;
        unsigned count;
    } rows[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
    for (size_t i = 0; type && i < sizeof rows / sizeof *rows; i++) {
        if (strcmp(type, rows[i].name) == 0) return rows[i].count;
    }
    return 0;
}

/* Finds `count` elements of `element` bytes, `stride` apart, in a view from `offset` on. */
static bool elements(masu_gltf *g, const json_t *of, uint64_t count, size_t element, bool strided,
                     const unsigned char **data, size_t *stride) {
    json_int_t view = -1;
    uint64_t offset = 0;
    size_t step = 0;
    masu_gltf_bytes bytes;
    if (!masu_gltf_index(g, of, "bufferView", g->view_count, &view) ||
        !masu_gltf_size(g, of, "byteOffset", &offset))
        return false;
    if (view < 0) return true;
    if (!masu_gltf_view(g, view, &bytes, &step)) return false;
    if (!step || !strided) step = element;
    if (step < element)
        return masu_gltf_fail(g, "elements of %zu bytes are %zu bytes apart", element, step);
    if (offset > bytes.bytes || element > bytes.bytes - offset ||
        count - 1 > (bytes.bytes - offset - element) / step) {
        return masu_gltf_fail(g,
                              "%llu elements of %zu bytes, %zu apart, from byte %llu on: "
                              "bufferViews[%lld] has %zu bytes",
                              (unsigned long long)count, element, step, (unsigned long long)offset,
                              (long long)view, bytes.bytes);
    }
    *data = bytes.data + offset;
    *stride = step;
    return true;
}

static bool find_sparse(masu_gltf *g, const json_t *sparse, accessor *a) {
    uint64_t count = 0, type = 0;
    size_t stride;
    const json_t *indices = masu_gltf_object(g, sparse, "indices");
    const json_t *values = masu_gltf_object(g, sparse, "values");
    if (!masu_gltf_size(g, sparse, "count", &count) ||
        !masu_gltf_size(g, indices, "componentType", &type))
        return false;
    if (count == 0) return true;
    if (count > a->count || !indices || !values ||
        (type != UBYTE && type != USHORT && type != UINT))
        return masu_gltf_fail(g, "\"sparse\" is invalid");
    if (!elements(g, indices, count, size_of(type), false, &a->at, &stride) ||
        !elements(g, values, count, (size_t)a->size * a->components, false, &a->values, &stride))
        return false;
    if (!a->at || !a->values) return masu_gltf_fail(g, "\"sparse\" has no bufferView");
    a->sparse = (uint32_t)count;
    a->at_type = (unsigned)type;
    return true;
}

static bool find(masu_gltf *g, json_int_t index, unsigned components, accessor *a) {
    const json_t *about = masu_gltf_element(g, "accessors", index);
    if (!about) return false;
    uint64_t type = 0, count = 0;
    *a = (accessor){.data = NULL};
    const char *shape = masu_gltf_string(g, about, "type");
    const json_t *sparse = masu_gltf_object(g, about, "sparse");
    if (!masu_gltf_size(g, about, "componentType", &type) ||
        !masu_gltf_size(g, about, "count", &count) ||
        !masu_gltf_flag(g, about, "normalized", &a->normalized))
        return false;
    a->components = components_of(shape);
    a->size = size_of(type);
    a->type = (unsigned)type;
    if (!a->size || !a->components || (a->components == 16 && type != FLOAT))
        return masu_gltf_fail(g, "accessors[%lld] has an unknown type", (long long)index);
    if (components && a->components != components) {
        return masu_gltf_fail(g, "accessors[%lld] is \"%s\": %u numbers are needed",
                              (long long)index, shape, components);
    }
    if (count < 1 || count > INT32_MAX)
        return masu_gltf_fail(g, "accessors[%lld] has %llu elements", (long long)index,
                              (unsigned long long)count);
    a->count = (uint32_t)count;
    if (!elements(g, about, count, (size_t)a->size * a->components, true, &a->data, &a->stride))
        return false;
    if (!a->data && count > ZEROS_MAX)
        return masu_gltf_fail(g, "accessors[%lld] has %llu elements and no bufferView",
                              (long long)index, (unsigned long long)count);
    return !masu_gltf_failed(g) && (!sparse || find_sparse(g, sparse, a));
}

static uint32_t unsigned_at(const unsigned char *p, unsigned type) {
    uint16_t half;
    uint32_t whole;
    if (type == UBYTE || type == BYTE) return *p;
    if (type == UINT || type == FLOAT) return memcpy(&whole, p, sizeof whole), whole;
    return memcpy(&half, p, sizeof half), half;
}

static float number_at(const unsigned char *p, const accessor *a) {
    float number;
    uint32_t bits = unsigned_at(p, a->type);
    switch (a->type) {
    case FLOAT: return memcpy(&number, p, sizeof number), number;
    case BYTE: number = (float)(int8_t)bits; break;
    case SHORT: number = (float)(int16_t)bits; break;
    default: number = (float)bits; break;
    }
    if (!a->normalized) return number;
    static const float whole[] = {127, 255, 32767, 65535};
    if (a->type > USHORT) return (float)(bits / 4294967295.0);
    number /= whole[a->type - BYTE];
    return number < -1 ? -1 : number;
}

static bool sparse_index(masu_gltf *g, const accessor *a, uint32_t i, uint32_t *out) {
    *out = unsigned_at(a->at + (size_t)i * size_of(a->at_type), a->at_type);
    if (*out < a->count) return true;
    return masu_gltf_fail(g, "\"sparse\" changes element %u of %u", *out, a->count);
}

float *masu_gltf_floats(masu_gltf *g, json_int_t index, unsigned components, uint32_t *count,
                        unsigned *found) {
    accessor a;
    if (!find(g, index, components, &a)) return NULL;
    float *out = masu_gltf_take(g, a.count, a.components * sizeof *out);
    for (uint32_t i = 0; a.data && i < a.count; i++) {
        for (unsigned k = 0; k < a.components; k++)
            out[(size_t)i * a.components + k] = number_at(a.data + i * a.stride + k * a.size, &a);
    }
    for (uint32_t i = 0; i < a.sparse; i++) {
        uint32_t to;
        if (!sparse_index(g, &a, i, &to)) return NULL;
        for (unsigned k = 0; k < a.components; k++)
            out[(size_t)to * a.components + k] =
                number_at(a.values + ((size_t)i * a.components + k) * a.size, &a);
    }
    *count = a.count;
    if (found) *found = a.components;
    return out;
}

uint32_t *masu_gltf_integers(masu_gltf *g, json_int_t index, unsigned components, uint32_t *count) {
    accessor a;
    if (!find(g, index, components, &a)) return NULL;
    if (a.type != UBYTE && a.type != USHORT && a.type != UINT) {
        masu_gltf_fail(g, "accessors[%lld] must hold unsigned integers", (long long)index);
        return NULL;
    }
    uint32_t *out = masu_gltf_take(g, a.count, a.components * sizeof *out);
    for (uint32_t i = 0; a.data && i < a.count; i++) {
        for (unsigned k = 0; k < a.components; k++)
            out[(size_t)i * a.components + k] =
                unsigned_at(a.data + i * a.stride + k * a.size, a.type);
    }
    for (uint32_t i = 0; i < a.sparse; i++) {
        uint32_t to;
        if (!sparse_index(g, &a, i, &to)) return NULL;
        for (unsigned k = 0; k < a.components; k++)
            out[(size_t)to * a.components + k] =
                unsigned_at(a.values + ((size_t)i * a.components + k) * a.size, a.type);
    }
    *count = a.count;
    return out;
}

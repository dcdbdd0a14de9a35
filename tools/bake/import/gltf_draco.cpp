// gltf_draco.cpp: KHR_draco_mesh_compression, by libdraco, which has no interface for C; see gltf.h. Exceptions and
// running out of memory become a failure here.
#include <draco/compression/decode.h>

#include <cstdint>
#include <exception>
#include <memory>
#include <new>

// Of gltf.h, which C++ cannot read.
extern "C" {
struct masu_gltf_draco {
    void *mesh;
    uint32_t points, faces;
};
bool masu_gltf_draco_open(const unsigned char *data, size_t bytes, masu_gltf_draco *out);
void masu_gltf_draco_indices(const masu_gltf_draco *draco, uint32_t *out);
unsigned masu_gltf_draco_components(const masu_gltf_draco *draco, uint32_t id);
bool masu_gltf_draco_floats(const masu_gltf_draco *draco, uint32_t id, unsigned components, float *out);
void masu_gltf_draco_close(masu_gltf_draco *draco);
}

static const draco::Mesh *mesh_of(const masu_gltf_draco *d) {
    return static_cast<const draco::Mesh *>(d->mesh);
}

bool masu_gltf_draco_open(const unsigned char *data, size_t bytes, masu_gltf_draco *out) try {
    draco::DecoderBuffer buffer;
    draco::Decoder decoder;
    buffer.Init(reinterpret_cast<const char *>(data), bytes);
    auto kind = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (!kind.ok() || kind.value() != draco::TRIANGULAR_MESH) return false;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok()) return false;
    std::unique_ptr<draco::Mesh> mesh = std::move(result).value();
    if (!mesh || mesh->num_points() == 0 || mesh->num_points() > INT32_MAX || mesh->num_faces() > INT32_MAX)
        return false;
    for (uint32_t f = 0; f < mesh->num_faces(); f++) {
        for (int k = 0; k < 3; k++) {
            if (mesh->face(draco::FaceIndex(f))[k].value() >= mesh->num_points()) return false;
        }
    }
    out->points = mesh->num_points();
    out->faces = mesh->num_faces();
    out->mesh = mesh.release();
    return true;
} catch (const std::exception &) {
    return false;
}

void masu_gltf_draco_indices(const masu_gltf_draco *d, uint32_t *out) {
    for (uint32_t f = 0; f < d->faces; f++) {
        for (int k = 0; k < 3; k++) out[3 * size_t(f) + k] = mesh_of(d)->face(draco::FaceIndex(f))[k].value();
    }
}

unsigned masu_gltf_draco_components(const masu_gltf_draco *d, uint32_t id) {
    const draco::PointAttribute *a = mesh_of(d)->GetAttributeByUniqueId(id);
    return a && a->num_components() >= 1 && a->num_components() <= 4 ? unsigned(a->num_components()) : 0;
}

bool masu_gltf_draco_floats(const masu_gltf_draco *d, uint32_t id, unsigned components, float *out) {
    const draco::PointAttribute *a = mesh_of(d)->GetAttributeByUniqueId(id);
    for (uint32_t i = 0; i < d->points; i++) {
        draco::AttributeValueIndex at = a->mapped_index(draco::PointIndex(i));
        if (at.value() >= a->size() ||
            !a->ConvertValue<float>(at, int8_t(components), out + size_t(i) * components))
            return false;
    }
    return true;
}

void masu_gltf_draco_close(masu_gltf_draco *d) {
    delete static_cast<draco::Mesh *>(d->mesh);
    d->mesh = nullptr;
}

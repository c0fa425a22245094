/* Draco is C++: this is its only user. */
#include <draco/compression/decode.h>

#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
#include "io/decode/decode.h"
}

namespace
{

const uint32_t BYTE = 5120, UNSIGNED_BYTE = 5121, SHORT = 5122, UNSIGNED_SHORT = 5123,
               UNSIGNED_INT = 5125, FLOAT = 5126; /* numbers of the types in glTF */

/* Writes the values vertex by vertex, without padding. */
template <class T>
bool write_values(unsigned char *&at, const draco::Mesh &mesh, const draco::PointAttribute &source,
                  uint32_t component_count)
{
    T value[16];
    for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
        if (!source.ConvertValue<T>(source.mapped_index(point), (int8_t)component_count, value))
            return false;
        std::memcpy(at, value, component_count * sizeof(T));
        at += component_count * sizeof(T);
    }
    return true;
}

bool write_attribute(unsigned char *&at, const draco::Mesh &mesh, const decode_attribute &wanted)
{
    const draco::PointAttribute *source = mesh.GetAttributeByUniqueId(wanted.id);
    if (!source)
        return false;
    switch (wanted.component_type) {
    case BYTE:
        return write_values<int8_t>(at, mesh, *source, wanted.component_count);
    case UNSIGNED_BYTE:
        return write_values<uint8_t>(at, mesh, *source, wanted.component_count);
    case SHORT:
        return write_values<int16_t>(at, mesh, *source, wanted.component_count);
    case UNSIGNED_SHORT:
        return write_values<uint16_t>(at, mesh, *source, wanted.component_count);
    case UNSIGNED_INT:
        return write_values<uint32_t>(at, mesh, *source, wanted.component_count);
    case FLOAT:
        return write_values<float>(at, mesh, *source, wanted.component_count);
    default:
        return false;
    }
}

mrt_result write_mesh(unsigned char *out, const draco::Mesh &mesh, const decode_order &order,
                      error *err)
{
    for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face)
        for (int corner = 0; corner < 3; ++corner) {
            uint32_t vertex = mesh.face(face)[(size_t)corner].value();
            std::memcpy(out, &vertex, sizeof vertex);
            out += sizeof vertex;
        }
    for (uint32_t i = 0; i < order.attribute_count; ++i)
        if (!write_attribute(out, mesh, order.attribute[i]))
            return error_set(err, MRT_ERR_FORMAT, "attribute %u is not in the Draco data",
                             order.attribute[i].id);
    return MRT_OK;
}

mrt_result decode(unsigned char *out, const decode_order &order, const void *data, size_t size,
                  error *err)
{
    draco::DecoderBuffer buffer;
    buffer.Init(static_cast<const char *>(data), size);
    draco::Decoder decoder;
    draco::StatusOr<std::unique_ptr<draco::Mesh>> decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        return error_set(err, MRT_ERR_FORMAT, "the Draco data is damaged: %s",
                         decoded.status().error_msg());
    const draco::Mesh &mesh = *decoded.value();
    if (mesh.num_points() != order.count || (uint64_t)mesh.num_faces() * 3 != order.index_count)
        return error_set(err, MRT_ERR_FORMAT,
                         "the Draco data has %u vertices and %u triangles, the file says %u and %u",
                         mesh.num_points(), mesh.num_faces(), order.count, order.index_count / 3);
    return write_mesh(out, mesh, order, err);
}

} // namespace

mrt_result draco_decode(void **out_data, size_t *out_size, const decode_order *order,
                        const void *data, size_t size, error *err)
{
    *out_size = decode_answer_size(order);
    *out_data = *out_size ? malloc(*out_size) : nullptr;
    if (!*out_data)
        return error_set(err, MRT_ERR_MEMORY, "no memory for the Draco mesh");
    mrt_result result;
    try {
        result = decode(static_cast<unsigned char *>(*out_data), *order, data, size, err);
    } catch (const std::bad_alloc &) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the Draco mesh");
    } catch (...) {
        result = error_set(err, MRT_ERR_FORMAT, "the Draco data is damaged");
    }
    if (result < 0) {
        free(*out_data);
        *out_data = nullptr;
    }
    return result;
}

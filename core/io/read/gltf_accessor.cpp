#include "io/read/gltf_accessor.hpp"

#include <cmath>
#include <cstring>

namespace
{

/* Returns the size in bytes; 0: not a glTF type. */
size_t size_of(int component_type)
{
    switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

size_t components_of(int type)
{
    switch (type) {
    case TINYGLTF_TYPE_SCALAR:
        return 1;
    case TINYGLTF_TYPE_VEC2:
        return 2;
    case TINYGLTF_TYPE_VEC3:
        return 3;
    case TINYGLTF_TYPE_VEC4:
        return 4;
    case TINYGLTF_TYPE_MAT4:
        return 16;
    default:
        return 0;
    }
}

/* glTF is little-endian, like every machine that this program supports. */
template <class T> T load(const unsigned char *at)
{
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

uint32_t load_whole(const unsigned char *at, int component_type)
{
    switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return *at;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load<uint16_t>(at);
    default:
        return load<uint32_t>(at);
    }
}

bool is_index_type(int component_type)
{
    return component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
           component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

} // namespace

void gltf_accessor::fail(const char *what) const
{
    gltf_fail(MRT_ERR_FORMAT, "accessor %d: %s", index_, what);
}

gltf_accessor::gltf_accessor(const tinygltf::Model &model, int index)
    : model_(model), accessor_(gltf_accessor_at(model, index)), index_(index),
      component_size_(size_of(accessor_.componentType)),
      component_count_(components_of(accessor_.type)), dense_{nullptr, 0},
      sparse_indices_{nullptr, 0}, sparse_values_{nullptr, 0}
{
    if (component_size_ == 0)
        fail("its component type is not one of glTF's");
    if (component_count_ == 0)
        fail("small matrices are not read");
    if (accessor_.count == 0 || accessor_.count > GLTF_COUNT_MAX)
        fail("its count must be from 1 to 16777216");
    if (accessor_.bufferView >= 0)
        dense_ = find(accessor_.bufferView, accessor_.byteOffset,
                      component_size_ * component_count_, accessor_.count, component_size_);
    if (accessor_.sparse.isSparse)
        check_sparse();
}

/* Uses subtractions instead of additions, so that an overflow is impossible. */
gltf_array gltf_accessor::find(int view_index, size_t offset, size_t element_size, size_t count,
                               size_t component_size) const
{
    if (view_index < 0 || (size_t)view_index >= model_.bufferViews.size())
        fail("its bufferView does not exist");
    const tinygltf::BufferView &view = model_.bufferViews[(size_t)view_index];
    if (view.buffer < 0 || (size_t)view.buffer >= model_.buffers.size())
        fail("the buffer of its bufferView does not exist");
    const std::vector<unsigned char> &bytes = model_.buffers[(size_t)view.buffer].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
        fail("its bufferView goes past the end of the buffer");
    size_t stride = view.byteStride ? view.byteStride : element_size;
    if (stride < element_size)
        fail("the byteStride is less than an element");
    if ((view.byteOffset + offset) % component_size != 0 || stride % component_size != 0)
        fail("it is not aligned");
    if (offset > view.byteLength || element_size > view.byteLength - offset ||
        count - 1 > (view.byteLength - offset - element_size) / stride)
        fail("it goes past the end of its bufferView");
    return {bytes.data() + view.byteOffset + offset, stride};
}

void gltf_accessor::check_sparse()
{
    const auto &sparse = accessor_.sparse;
    if (sparse.count < 1 || (size_t)sparse.count > accessor_.count)
        fail("sparse.count must be from 1 to count");
    if (!is_index_type(sparse.indices.componentType))
        fail("the component type of sparse.indices must be unsigned");
    size_t count = (size_t)sparse.count, index_size = size_of(sparse.indices.componentType);
    sparse_values_ = find(sparse.values.bufferView, (size_t)sparse.values.byteOffset,
                          component_size_ * component_count_, count, component_size_);
    sparse_indices_ = find(sparse.indices.bufferView, (size_t)sparse.indices.byteOffset, index_size,
                           count, index_size);
}

/* Separate from the constructor because its time depends on the count. */
void gltf_accessor::check_sparse_indices() const
{
    for (size_t i = 0; sparse_indices_.at && i < (size_t)accessor_.sparse.count; ++i) {
        if (sparse_index(i) >= accessor_.count)
            fail("a sparse index is not below count");
        if (i > 0 && sparse_index(i) <= sparse_index(i - 1))
            fail("the sparse indices do not increase");
    }
}

uint32_t gltf_accessor::sparse_index(size_t i) const
{
    return load_whole(sparse_indices_.at + i * sparse_indices_.stride,
                      accessor_.sparse.indices.componentType);
}

/* glTF 2.0, section 3.11: normalised integers. */
float gltf_accessor::number(const unsigned char *at) const
{
    double value = 0.0, full = 1.0;
    switch (accessor_.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        value = load<int8_t>(at);
        full = 127.0;
        break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        value = *at;
        full = 255.0;
        break;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        value = load<int16_t>(at);
        full = 32767.0;
        break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        value = load<uint16_t>(at);
        full = 65535.0;
        break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        value = load<uint32_t>(at);
        full = 4294967295.0;
        break;
    default:
        return load<float>(at);
    }
    if (accessor_.normalized)
        value = value < -full ? -1.0 : value / full;
    return (float)value;
}

void gltf_accessor::read_element(const unsigned char *at, float *out) const
{
    for (size_t c = 0; c < component_count_; ++c)
        out[c] = number(at + c * component_size_);
}

void gltf_accessor::read_floats(float *out) const
{
    read_any_floats(out);
    for (size_t i = 0; i < accessor_.count * component_count_; ++i)
        if (!std::isfinite(out[i]))
            fail("a number in it is not finite");
}

void gltf_accessor::read_any_floats(float *out) const
{
    check_sparse_indices();
    for (size_t i = 0; dense_.at && i < accessor_.count; ++i)
        read_element(dense_.at + i * dense_.stride, out + i * component_count_);
    for (size_t i = 0; sparse_indices_.at && i < (size_t)accessor_.sparse.count; ++i)
        read_element(sparse_values_.at + i * sparse_values_.stride,
                     out + sparse_index(i) * component_count_);
}

std::vector<uint32_t> gltf_accessor::read_indices(size_t limit) const
{
    if (component_count_ != 1 || !is_index_type(accessor_.componentType))
        fail("indices must be unsigned scalars");
    check_sparse_indices();
    std::vector<uint32_t> out(accessor_.count, 0);
    for (size_t i = 0; dense_.at && i < out.size(); ++i)
        out[i] = load_whole(dense_.at + i * dense_.stride, accessor_.componentType);
    for (size_t i = 0; sparse_indices_.at && i < (size_t)accessor_.sparse.count; ++i)
        out[sparse_index(i)] =
            load_whole(sparse_values_.at + i * sparse_values_.stride, accessor_.componentType);
    for (uint32_t vertex : out)
        if (vertex >= limit)
            gltf_fail(MRT_ERR_FORMAT, "accessor %d: index %u, but the primitive has %zu vertices",
                      index_, vertex, limit);
    return out;
}

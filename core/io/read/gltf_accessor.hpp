/* io/read/gltf_accessor.hpp - the numbers of a glTF accessor. The constructor checks all ranges
 * that the accessor refers to, so that reads stay within the buffers. Private to the glTF reader;
 * failures are gltf_failure. */
#ifndef MAROTTE_IO_GLTF_ACCESSOR_HPP
#define MAROTTE_IO_GLTF_ACCESSOR_HPP
#include "io/read/gltf_load.hpp"

#include <cstdint>
#include <vector>

const size_t GLTF_COUNT_MAX = (size_t)1 << 24; /* maximum number of elements of an accessor */

struct gltf_array { /* elements in a buffer */
    const unsigned char *at;
    size_t stride; /* bytes */
};

class gltf_accessor
{
  public:
    /* `model` must outlive the accessor. */
    gltf_accessor(const tinygltf::Model &model, int index);

    size_t count() const
    {
        return accessor_.count;
    }
    size_t component_count() const
    {
        return component_count_;
    }
    int component_type() const
    {
        return accessor_.componentType;
    }
    /* Writes count by component_count finite numbers; `out` must be zeroed. */
    void read_floats(float *out) const;
    /* Likewise, but the numbers may be infinite or NaN. */
    void read_any_floats(float *out) const;
    /* Reads a SCALAR accessor of integers, each below `limit`. */
    std::vector<uint32_t> read_indices(size_t limit) const;

  private:
    gltf_array find(int view, size_t offset, size_t element_size, size_t count,
                    size_t component_size) const;
    float number(const unsigned char *at) const;
    void read_element(const unsigned char *at, float *out) const;
    void check_sparse();
    void check_sparse_indices() const;
    uint32_t sparse_index(size_t i) const;
    [[noreturn]] void fail(const char *what) const;

    const tinygltf::Model &model_;
    const tinygltf::Accessor &accessor_;
    int index_;
    size_t component_size_, component_count_;
    gltf_array dense_;          /* at == NULL: all zero */
    gltf_array sparse_indices_; /* at == NULL: not sparse */
    gltf_array sparse_values_;
};

#endif

/* io/write/gltf_output.hpp - builds a .glb: binary data in the order of its calls, the accessors
 * for it, and finally the file. tinygltf makes the JSON. The binary part is written without a copy.
 * Private to the glTF writer; failures are gltf_failure. */
#ifndef MAROTTE_IO_GLTF_OUTPUT_HPP
#define MAROTTE_IO_GLTF_OUTPUT_HPP
#include "io/read/gltf_load.hpp"

#include <cstring>
#include <new>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

using gltf_bytes = std::vector<unsigned char>;

struct gltf_output {
    tinygltf::Model model;         /* without its buffer */
    std::vector<gltf_bytes> chunk; /* the binary part, each padded to 4 bytes */
    size_t binary_size = 0;
};

/* The text with bytes that are no UTF-8 replaced: JSON cannot hold them. NULL gives "". */
std::string gltf_utf8(const char *text);

template <typename number> gltf_bytes gltf_bytes_of(const std::vector<number> &value)
{
    gltf_bytes data(value.size() * sizeof(number));
    if (!data.empty())
        std::memcpy(data.data(), value.data(), data.size());
    return data;
}

/* Of three numbers. */
bool gltf_is_zero(const float *v);

/* Fails if a value is not finite; the error names `what`. */
void gltf_output_check(const float *value, size_t count, const std::string &what);

/* Fails if `size` more bytes are too many for a .glb. */
void gltf_output_reserve(const gltf_output &out, size_t size);
/* Each returns the index of what it added. `target`: TINYGLTF_TARGET_* or 0. */
int gltf_output_view(gltf_output &out, gltf_bytes &&data, int target);
int gltf_output_accessor(gltf_output &out, tinygltf::Accessor &&accessor);
/* count by component_count floats, finite, count > 0, with their bounds. */
int gltf_output_floats(gltf_output &out, const float *value, size_t count, size_t component_count,
                       int target);
/* count by 3, of all vertices: only those that are not zero where that takes less room. */
int gltf_output_offsets(gltf_output &out, const float *value, size_t count);

/* An animation as JSON without channels; one more: of a node, and the accessors of its keys. */
nlohmann::ordered_json gltf_output_animation(const std::string &name);
void gltf_output_channel(nlohmann::ordered_json &animation, size_t node, const char *path,
                         int times, int values);

/* The model's JSON; gltf_output_write takes it, or another that describes the binary part. Returns
 * the size of the file. */
std::string gltf_output_json(gltf_output &out);
uint64_t gltf_output_write(const gltf_output &out, std::string json, const char *path);

/* The border of a writer: nothing but a result leaves. */
template <typename action> mrt_result gltf_guarded(const char *path, error *err, const action &run)
{
    try {
        run();
        return MRT_OK;
    } catch (const gltf_failure &failed) {
        (void)error_set(err, failed.code, "%s", failed.what());
        if (std::strncmp(failed.what(), path, std::strlen(path)) != 0)
            error_prefix(err, path);
        return failed.code;
    } catch (const std::bad_alloc &) {
        return error_set(err, MRT_ERR_MEMORY, "%s: no memory to write it", path);
    } catch (const std::exception &unexpected) {
        return error_set(err, MRT_ERR_UNSUPPORTED, "%s: cannot write: %s", path, unexpected.what());
    }
}

#endif

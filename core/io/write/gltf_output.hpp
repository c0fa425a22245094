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

/* Returns the text with invalid UTF-8 replaced, because JSON cannot contain it. NULL gives "". */
std::string gltf_utf8(const char *text);

template <typename number> gltf_bytes gltf_bytes_of(const std::vector<number> &value)
{
    gltf_bytes data(value.size() * sizeof(number));
    if (!data.empty())
        std::memcpy(data.data(), value.data(), data.size());
    return data;
}

/* Returns whether all three numbers are 0. */
bool gltf_is_zero(const float *v);

/* Fails if a value is not finite; the error names `what`. */
void gltf_output_check(const float *value, size_t count, const std::string &what);

/* Fails if a .glb cannot hold `size` more bytes. */
void gltf_output_reserve(const gltf_output &out, size_t size);
/* Each function below returns the index of the item that it added. `target`: TINYGLTF_TARGET_* or
 * 0. */
int gltf_output_view(gltf_output &out, gltf_bytes &&data, int target);
int gltf_output_accessor(gltf_output &out, tinygltf::Accessor &&accessor);
/* Adds count by component_count finite floats with their bounds; count > 0. */
int gltf_output_floats(gltf_output &out, const float *value, size_t count, size_t component_count,
                       int target);
/* Adds the offsets of all vertices, count by 3. Stores only those that are not zero if that is
 * smaller. */
int gltf_output_offsets(gltf_output &out, const float *value, size_t count);

/* Create an animation as JSON without channels; add a channel of a node, with the accessors of its
 * keys. */
nlohmann::ordered_json gltf_output_animation(const std::string &name);
void gltf_output_channel(nlohmann::ordered_json &animation, size_t node, const char *path,
                         int times, int values);

/* gltf_output_json returns the JSON of the model. gltf_output_write writes the file with this JSON,
 * or with another that describes the same binary part. It returns the size of the file. */
std::string gltf_output_json(gltf_output &out);
uint64_t gltf_output_write(const gltf_output &out, std::string json, const char *path);

/* Runs a writer and converts exceptions to a result. */
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

#include "io/write/gltf_output.hpp"

extern "C" {
#include "base/file.h"
}

#include <cerrno>
#include <cmath>
#include <sstream>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "glTF is little-endian: arrays are written without conversion"
#endif

namespace
{

/* A .glb counts its bytes with 32 bits; the rest is left for the JSON. */
constexpr size_t MAX_BINARY_BYTES = 0xFFFFFFFFu - (64u << 20);

tinygltf::Accessor float_accessor(size_t count, size_t component_count)
{
    static const int type[] = {TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3,
                               TINYGLTF_TYPE_VEC4};
    tinygltf::Accessor accessor;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.count = count;
    accessor.type = type[component_count - 1];
    return accessor;
}

void set_bounds(tinygltf::Accessor &accessor, const float *value, size_t count,
                size_t component_count)
{
    accessor.minValues.assign(value, value + component_count);
    accessor.maxValues = accessor.minValues;
    for (size_t i = component_count; i < count * component_count; ++i) {
        double at = static_cast<double>(value[i]);
        double &low = accessor.minValues[i % component_count];
        double &high = accessor.maxValues[i % component_count];
        low = at < low ? at : low;
        high = at > high ? at : high;
    }
}

void add_sparse_views(gltf_output &out, tinygltf::Accessor &accessor, const float *value,
                      const std::vector<uint32_t> &index)
{
    gltf_bytes values(index.size() * 3 * sizeof(float));
    for (size_t i = 0; i < index.size(); ++i)
        std::memcpy(values.data() + i * 3 * sizeof(float), value + size_t{index[i]} * 3,
                    3 * sizeof(float));
    bool is_short = accessor.count <= 65536;
    std::vector<uint16_t> short_index(is_short ? index.size() : 0);
    for (size_t i = 0; i < short_index.size(); ++i)
        short_index[i] = static_cast<uint16_t>(index[i]);
    accessor.sparse.isSparse = true;
    accessor.sparse.count = static_cast<int>(index.size());
    accessor.sparse.indices.byteOffset = 0;
    accessor.sparse.indices.componentType =
        is_short ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.sparse.indices.bufferView =
        gltf_output_view(out, is_short ? gltf_bytes_of(short_index) : gltf_bytes_of(index), 0);
    accessor.sparse.values.byteOffset = 0;
    accessor.sparse.values.bufferView = gltf_output_view(out, std::move(values), 0);
}

void put_u32(std::string &header, size_t value)
{
    for (int shift = 0; shift < 32; shift += 8)
        header += static_cast<char>(value >> shift & 0xFF);
}

struct open_writer {
    file_writer file{};
    ~open_writer()
    {
        file_writer_abandon(&file); /* no effect after a commit */
    }
};

void append(open_writer &writer, const void *data, size_t size)
{
    if (std::fwrite(data, 1, size, writer.file.stream) != size)
        gltf_fail(MRT_ERR_IO, "%s: cannot write: %s", writer.file.path, std::strerror(errno));
}

} // namespace

bool gltf_is_zero(const float *v)
{
    return v[0] == 0.0f && v[1] == 0.0f && v[2] == 0.0f;
}

std::string gltf_utf8(const char *text)
{
    std::string out;
    const auto *at = reinterpret_cast<const unsigned char *>(text ? text : "");
    while (*at) {
        static const unsigned smallest[] = {0, 0x80, 0x800, 0x10000};
        unsigned code = *at;
        unsigned more = code < 0x80         ? 0
                        : (code >> 5) == 6  ? 1
                        : (code >> 4) == 14 ? 2
                        : (code >> 3) == 30 ? 3
                                            : 4;
        code &= more ? 0x3Fu >> more : 0x7Fu;
        unsigned length = 1;
        while (more < 4 && length <= more && (at[length] & 0xC0u) == 0x80u)
            code = code << 6 | (at[length++] & 0x3Fu);
        bool good = more < 4 && length == more + 1 && code >= smallest[more] && code <= 0x10FFFF &&
                    !(code >= 0xD800 && code <= 0xDFFF);
        if (good)
            out.append(reinterpret_cast<const char *>(at), length);
        else
            out += '?';
        at += good ? length : 1;
    }
    return out;
}

void gltf_output_reserve(const gltf_output &out, size_t size)
{
    if (size > MAX_BINARY_BYTES - out.binary_size)
        gltf_fail(MRT_ERR_UNSUPPORTED, "more than 4 GB of shapes and weights: a .glb cannot hold "
                                       "them; export a vertex cache (.pc2) or a shorter part");
}

int gltf_output_view(gltf_output &out, gltf_bytes &&data, int target)
{
    gltf_output_reserve(out, data.size());
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = out.binary_size;
    view.byteLength = data.size();
    view.target = target;
    data.resize((data.size() + 3) & ~size_t{3});
    out.binary_size += data.size();
    out.chunk.push_back(std::move(data));
    out.model.bufferViews.push_back(std::move(view));
    return static_cast<int>(out.model.bufferViews.size() - 1);
}

int gltf_output_accessor(gltf_output &out, tinygltf::Accessor &&accessor)
{
    out.model.accessors.push_back(std::move(accessor));
    return static_cast<int>(out.model.accessors.size() - 1);
}

void gltf_output_check(const float *value, size_t count, const std::string &what)
{
    for (size_t i = 0; i < count; ++i)
        if (!std::isfinite(value[i]))
            gltf_fail(MRT_ERR_ARGUMENT, "%s: value %zu is not finite, nothing was written",
                      what.c_str(), i);
}

int gltf_output_floats(gltf_output &out, const float *value, size_t count, size_t component_count,
                       int target)
{
    gltf_bytes data(count * component_count * sizeof(float));
    std::memcpy(data.data(), value, data.size());
    tinygltf::Accessor accessor = float_accessor(count, component_count);
    set_bounds(accessor, value, count, component_count);
    accessor.bufferView = gltf_output_view(out, std::move(data), target);
    return gltf_output_accessor(out, std::move(accessor));
}

int gltf_output_offsets(gltf_output &out, const float *value, size_t count)
{
    std::vector<uint32_t> index;
    for (size_t v = 0; v < count; ++v)
        if (!gltf_is_zero(value + v * 3))
            index.push_back(static_cast<uint32_t>(v));
    if (index.empty())
        index.push_back(0); /* a sparse accessor cannot be empty */
    size_t index_size = count <= 65536 ? sizeof(uint16_t) : sizeof(uint32_t);
    if (index.size() * (index_size + 3 * sizeof(float)) >= count * 3 * sizeof(float))
        return gltf_output_floats(out, value, count, 3, TINYGLTF_TARGET_ARRAY_BUFFER);
    tinygltf::Accessor accessor = float_accessor(count, 3);
    set_bounds(accessor, value, count, 3);
    add_sparse_views(out, accessor, value, index);
    return gltf_output_accessor(out, std::move(accessor));
}

nlohmann::ordered_json gltf_output_animation(const std::string &name)
{
    return {{"name", name},
            {"channels", nlohmann::ordered_json::array()},
            {"samplers", nlohmann::ordered_json::array()}};
}

void gltf_output_channel(nlohmann::ordered_json &animation, size_t node, const char *path,
                         int times, int values)
{
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
    animation["samplers"].push_back(
        {{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
}

std::string gltf_output_json(gltf_output &out)
{
    std::ostringstream stream;
    tinygltf::TinyGLTF writer;
    if (!writer.WriteGltfSceneToStream(&out.model, stream, false, false))
        gltf_fail(MRT_ERR_MEMORY, "cannot create the JSON of the glTF file");
    nlohmann::json json = nlohmann::json::parse(stream.str());
    json["buffers"] = nlohmann::json::array({{{"byteLength", out.binary_size}}});
    for (auto &member : json.items())
        if (member.key() == "materials")
            for (auto &material : member.value())
                if (material.is_null()) /* tinygltf writes null for a material with only default
                                           values */
                    material = nlohmann::json::object();
    return json.dump();
}

uint64_t gltf_output_write(const gltf_output &out, std::string json, const char *path)
{
    json.resize((json.size() + 3) & ~size_t{3}, ' ');
    size_t total = 12 + 8 + json.size() + 8 + out.binary_size;
    if (total > 0xFFFFFFFFu)
        gltf_fail(MRT_ERR_UNSUPPORTED, "more than 4 GB: a .glb cannot hold it");
    std::string header = "glTF";
    put_u32(header, 2);
    put_u32(header, total);
    put_u32(header, json.size());
    header += "JSON";
    std::string binary_header;
    put_u32(binary_header, out.binary_size);
    binary_header.append("BIN\0", 4);
    error err;
    open_writer writer;
    mrt_result result = file_writer_open(&writer.file, path, &err);
    if (result < 0)
        gltf_fail(result, "%s", err.text);
    append(writer, header.data(), header.size());
    append(writer, json.data(), json.size());
    append(writer, binary_header.data(), binary_header.size());
    for (const gltf_bytes &chunk : out.chunk)
        append(writer, chunk.data(), chunk.size());
    result = file_writer_commit(&writer.file, &err);
    if (result < 0)
        gltf_fail(result, "%s", err.text);
    return total;
}

#include "io/read/gltf_load.hpp"

#include <cstdarg>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <set>

#include <sys/stat.h>

#include <nlohmann/json.hpp>

extern "C" {
#include "base/budget.h"
#include "base/file.h"
#include "io/decode/decode.h"
}

using nlohmann::json;

namespace
{

/* ---- before parsing: the chunks of a .glb, and limits on the JSON ----
 */

enum {
    NESTING_MAX = 64,
    VALUES_MAX = 500000,     /* commas and opening brackets outside strings */
    JSON_SIZE_MAX = 1 << 28, /* bytes; data URIs count */
};
enum { HEADER_SIZE = 12, CHUNK_HEADER_SIZE = 8 };
const uint32_t JSON_CHUNK = 0x4e4f534a, BINARY_CHUNK = 0x004e4942; /* "JSON" "BIN\0" */

uint32_t read_u32(const char *at)
{
    const unsigned char *b = reinterpret_cast<const unsigned char *>(at);
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

mrt_result check_header(text_view file, error *err)
{
    size_t size = (size_t)(file.end - file.at);
    if (size < HEADER_SIZE + CHUNK_HEADER_SIZE)
        return error_set(err, MRT_ERR_FORMAT, "the .glb ends within its header");
    if (read_u32(file.at + 4) != 2)
        return error_set(err, MRT_ERR_UNSUPPORTED, "glTF version %u: only version 2 is read",
                         read_u32(file.at + 4));
    if (read_u32(file.at + 8) > size)
        return error_set(err, MRT_ERR_FORMAT,
                         "it is cut off: the header says %u bytes, the file has %zu; get it again",
                         read_u32(file.at + 8), size);
    if (read_u32(file.at + 8) != size)
        return error_set(err, MRT_ERR_FORMAT, "the header says %u bytes, the file has %zu",
                         read_u32(file.at + 8), size);
    return MRT_OK;
}

mrt_result split_chunks(gltf_container *out, text_view file, error *err)
{
    mrt_result result = check_header(file, err);
    if (result < 0)
        return result;
    text_view rest = {file.at + HEADER_SIZE, file.end};
    for (int chunk = 0; rest.at < rest.end; ++chunk) {
        size_t left = (size_t)(rest.end - rest.at);
        if (left < CHUNK_HEADER_SIZE || read_u32(rest.at) > left - CHUNK_HEADER_SIZE)
            return error_set(err, MRT_ERR_FORMAT, "chunk %d goes past the end of the file", chunk);
        uint32_t length = read_u32(rest.at), type = read_u32(rest.at + 4);
        text_view content = {rest.at + CHUNK_HEADER_SIZE, rest.at + CHUNK_HEADER_SIZE + length};
        if ((chunk == 0) != (type == JSON_CHUNK))
            return error_set(err, MRT_ERR_FORMAT, "the first chunk, and no other, must be JSON");
        if (chunk == 0)
            out->json = content;
        else if (chunk == 1 && type == BINARY_CHUNK)
            out->binary = content;
        rest.at = content.end;
    }
    return MRT_OK;
}

/* Returns the end of the string that starts at `at`, its opening quote, or `end`. */
const char *skip_string(const char *at, const char *end)
{
    for (++at; at < end && *at != '"'; ++at)
        if (*at == '\\' && at + 1 < end)
            ++at;
    return at < end ? at + 1 : end;
}

mrt_result check_limits(text_view json, error *err)
{
    int nesting = 0, value_count = 0;
    if (json.end - json.at > JSON_SIZE_MAX)
        return error_set(err, MRT_ERR_UNSUPPORTED,
                         "the JSON is longer than %d bytes: export it as .glb", JSON_SIZE_MAX);
    for (const char *at = json.at; at < json.end;) {
        if (*at == '"') {
            at = skip_string(at, json.end);
            continue;
        }
        bool opens = *at == '{' || *at == '[';
        nesting += opens;
        nesting -= *at == '}' || *at == ']';
        value_count += opens || *at == ',';
        if (nesting > NESTING_MAX)
            return error_set(err, MRT_ERR_FORMAT, "the JSON is nested more than %d deep",
                             NESTING_MAX);
        if (value_count > VALUES_MAX)
            return error_set(err, MRT_ERR_UNSUPPORTED, "the JSON has more than %d values",
                             VALUES_MAX);
        at += 1;
    }
    return MRT_OK;
}

/* ---- checks of the document that tinygltf does not make ---- */

const char BINARY_CHUNK_NAME[] =
    "marotte:binary";                            /* cannot be a file name, because ':' is refused */
const size_t BUFFER_BYTES_MAX = (size_t)1 << 30; /* all buffers together */

/* Sources of bytes for tinygltf's file callbacks. */
struct buffer_files {
    text_view binary; /* cut to the length of the first buffer */
    const char *directory;
    std::set<std::pair<dev_t, ino_t>> files; /* files that were read */
    error failed;
};

/* Checks that a member is absent or an integer in [0, 2^31). tinygltf ignores other values or
 * truncates them to an int. */
void check_whole(const json &object, const std::string &where, const char *key)
{
    auto found = object.find(key);
    if (found == object.end())
        return;
    if (!found->is_number_unsigned() || found->get<uint64_t>() > INT32_MAX)
        gltf_fail(MRT_ERR_FORMAT, "%s.%s must be a whole number from 0 to 2147483647",
                  where.c_str(), key);
}

void check_whole(const json &object, const std::string &where,
                 std::initializer_list<const char *> keys)
{
    for (const char *key : keys)
        check_whole(object, where, key);
}

const json &object_at(const json &parent, const std::string &where, const char *key)
{
    static const json empty = json::object();
    auto found = parent.find(key);
    if (found == parent.end())
        return empty;
    if (!found->is_object())
        gltf_fail(MRT_ERR_FORMAT, "%s.%s must be an object", where.c_str(), key);
    return *found;
}

const json &array_at(const json &parent, const std::string &where, const char *key)
{
    static const json empty = json::array();
    auto found = parent.find(key);
    if (found == parent.end())
        return empty;
    if (!found->is_array())
        gltf_fail(MRT_ERR_FORMAT, "%s%s%s must be an array", where.c_str(),
                  where.empty() ? "" : ".", key);
    return *found;
}

void check_indices(const json &parent, const std::string &where, const char *key)
{
    for (const json &index : array_at(parent, where, key))
        if (!index.is_number_unsigned() || index.get<uint64_t>() > INT32_MAX)
            gltf_fail(MRT_ERR_FORMAT, "%s.%s must hold whole numbers", where.c_str(), key);
}

/* Checks that a member is absent or an array of `count` numbers. */
void check_numbers(const json &parent, const std::string &where, const char *key, size_t count)
{
    const json &numbers = array_at(parent, where, key);
    if (numbers.size() != count && parent.contains(key))
        gltf_fail(MRT_ERR_FORMAT, "%s.%s must have %zu numbers", where.c_str(), key, count);
    for (const json &number : numbers)
        if (!number.is_number())
            gltf_fail(MRT_ERR_FORMAT, "%s.%s must have %zu numbers", where.c_str(), key, count);
}

void check_attributes(const json &attributes, const std::string &where)
{
    if (!attributes.is_object())
        gltf_fail(MRT_ERR_FORMAT, "%s must be an object", where.c_str());
    for (auto it = attributes.begin(); it != attributes.end(); ++it)
        check_whole(attributes, where, it.key().c_str());
}

void check_accessor(const json &accessor, const std::string &where)
{
    const json &sparse = object_at(accessor, where, "sparse");
    check_whole(sparse, where + ".sparse", "count");
    check_whole(object_at(sparse, where + ".sparse", "indices"), where + ".sparse.indices",
                {"bufferView", "byteOffset", "componentType"});
    check_whole(object_at(sparse, where + ".sparse", "values"), where + ".sparse.values",
                {"bufferView", "byteOffset"});
    if (accessor.contains("normalized") && !accessor["normalized"].is_boolean())
        gltf_fail(MRT_ERR_FORMAT, "%s.normalized must be true or false", where.c_str());
}

void check_mesh(const json &mesh, const std::string &where)
{
    size_t index = 0;
    for (const json &primitive : array_at(mesh, where, "primitives")) {
        std::string name = where + ".primitives[" + std::to_string(index++) + "]";
        if (!primitive.is_object())
            gltf_fail(MRT_ERR_FORMAT, "%s must be an object", name.c_str());
        check_whole(primitive, name, {"indices", "material", "mode"});
        check_attributes(object_at(primitive, name, "attributes"), name + ".attributes");
        for (const json &target : array_at(primitive, name, "targets"))
            check_attributes(target, name + ".targets");
    }
}

void check_texture_info(const json &parent, const std::string &where, const char *key)
{
    const json &info = object_at(parent, where, key);
    check_whole(info, where + "." + key, {"index", "texCoord"});
}

void check_image(const json &image, const std::string &where)
{
    for (const char *key : {"uri", "name"})
        if (image.contains(key) && !image[key].is_string())
            gltf_fail(MRT_ERR_FORMAT, "%s.%s must be a string", where.c_str(), key);
}

void check_material(const json &material, const std::string &where)
{
    const json &rough = object_at(material, where, "pbrMetallicRoughness");
    check_numbers(rough, where + ".pbrMetallicRoughness", "baseColorFactor", 4);
    check_texture_info(rough, where + ".pbrMetallicRoughness", "baseColorTexture");
    check_texture_info(rough, where + ".pbrMetallicRoughness", "metallicRoughnessTexture");
    check_texture_info(material, where, "normalTexture");
    check_texture_info(material, where, "emissiveTexture");
    check_numbers(material, where, "emissiveFactor", 3);
}

/* Checked members of the items of one list of the document. Other members are ignored. */
struct section {
    const char *name;
    std::vector<const char *> whole,
        indices; /* members that are an integer, or a list of integers */
    std::vector<std::pair<const char *, size_t>>
        numbers; /* members that are arrays of this length */
    void (*check_more)(const json &, const std::string &);
};

void check_section(const json &document, const section &of)
{
    size_t index = 0;
    for (const json &item : array_at(document, "", of.name)) {
        std::string where = std::string(of.name) + "[" + std::to_string(index++) + "]";
        if (!item.is_object())
            gltf_fail(MRT_ERR_FORMAT, "%s must be an object", where.c_str());
        for (const char *key : of.whole)
            check_whole(item, where, key);
        for (const char *key : of.indices)
            check_indices(item, where, key);
        for (const auto &numbers : of.numbers)
            check_numbers(item, where, numbers.first, numbers.second);
        if (of.check_more)
            of.check_more(item, where);
    }
}

/* Returns whether an extension is supported, or does not affect the data that is read here. */
bool is_known(const std::string &extension)
{
    static const char *const known[] = {"KHR_mesh_quantization",
                                        "KHR_texture_transform",
                                        "KHR_texture_basisu",
                                        "KHR_lights_punctual",
                                        "EXT_texture_webp",
                                        "EXT_texture_avif",
                                        "EXT_mesh_gpu_instancing",
                                        "EXT_meshopt_compression",
                                        "KHR_meshopt_compression",
                                        "KHR_draco_mesh_compression",
                                        "VRM",
                                        "VRMC_vrm",
                                        "VRMC_springBone",
                                        "VRMC_node_constraint",
                                        "VRMC_materials_mtoon"};
    for (const char *name : known)
        if (extension == name)
            return true;
    return extension.rfind("KHR_materials_", 0) == 0;
}

void check_extensions(const json &document)
{
    for (const json &extension : array_at(document, "", "extensionsRequired")) {
        std::string name = extension.is_string() ? extension.get<std::string>() : "";
        if (!is_known(name))
            gltf_fail(MRT_ERR_UNSUPPORTED,
                      "the file needs the extension \"%s\", which is not read: export it without",
                      name.substr(0, 64).c_str());
    }
}

void check_version(const json &document)
{
    const json &asset = object_at(document, "document", "asset");
    auto version = asset.find("version");
    if (version == asset.end() || !version->is_string())
        gltf_fail(MRT_ERR_FORMAT, "asset.version is missing");
    std::string text = version->get<std::string>();
    if (text.rfind("2.", 0) != 0)
        gltf_fail(MRT_ERR_UNSUPPORTED, "glTF version %s: only version 2 is read",
                  text.substr(0, 16).c_str());
}

void check_document(const json &document)
{
    if (!document.is_object())
        gltf_fail(MRT_ERR_FORMAT, "the JSON is not an object");
    check_version(document);
    check_extensions(document);
    check_whole(document, "document", "scene");
    static const section sections[] = {
        {"accessors",
         {"bufferView", "byteOffset", "componentType", "count"},
         {},
         {},
         check_accessor},
        {"bufferViews", {"buffer", "byteOffset", "byteLength", "byteStride"}, {}, {}, nullptr},
        {"buffers", {"byteLength"}, {}, {}, nullptr},
        {"meshes", {}, {}, {}, check_mesh},
        {"nodes",
         {"mesh", "skin"},
         {"children"},
         {{"matrix", 16}, {"translation", 3}, {"rotation", 4}, {"scale", 3}},
         nullptr},
        {"scenes", {}, {"nodes"}, {}, nullptr},
        {"skins", {"inverseBindMatrices", "skeleton"}, {"joints"}, {}, nullptr},
        {"materials", {}, {}, {}, check_material},
        {"textures", {"sampler", "source"}, {}, {}, nullptr},
        {"images", {"bufferView"}, {}, {}, check_image},
    };
    for (const section &of : sections)
        check_section(document, of);
}

/* ---- buffers ---- */

/* tinygltf requires indices to be in a buffer. Moves the index accessor of a compressed primitive
 * into the extension until it is decoded. */
void set_aside_draco_indices(json &document)
{
    const json none = json::array();
    const json &accessors = document.contains("accessors") ? document["accessors"] : none;
    if (!document.contains("meshes"))
        return;
    for (json &mesh : document["meshes"]) {
        if (!mesh.contains("primitives"))
            continue;
        for (json &primitive : mesh["primitives"]) {
            auto indices = primitive.find("indices"), extensions = primitive.find("extensions");
            if (indices == primitive.end() || extensions == primitive.end() ||
                !extensions->is_object())
                continue;
            auto draco = extensions->find("KHR_draco_mesh_compression");
            size_t index = indices->get<size_t>();
            if (draco == extensions->end() || !draco->is_object() || index >= accessors.size() ||
                accessors[index].contains("bufferView"))
                continue;
            (*draco)["indices"] = *indices;
            primitive.erase("indices");
        }
    }
}

const json *meshopt_of(const json &object)
{
    auto extensions = object.find("extensions");
    if (extensions == object.end() || !extensions->is_object())
        return nullptr;
    for (const char *name : GLTF_MESHOPT_NAMES) {
        auto found = extensions->find(name);
        if (found != extensions->end())
            return &*found;
    }
    return nullptr;
}

/* Finds the buffers whose views are all compressed in another buffer. */
std::vector<bool> find_replaced(const json &document, size_t buffer_count)
{
    std::vector<bool> is_replaced(buffer_count, false), is_read(buffer_count, false);
    auto mark = [](std::vector<bool> &of, const json &view) {
        auto buffer = view.is_object() ? view.find("buffer") : view.end();
        if (buffer != view.end() && buffer->is_number_unsigned() &&
            buffer->get<uint64_t>() < of.size())
            of[buffer->get<size_t>()] = true;
    };
    for (const json &view : array_at(document, "", "bufferViews")) {
        const json *how = meshopt_of(view);
        mark(how ? is_replaced : is_read, view);
        if (how)
            mark(is_read, *how);
    }
    for (size_t i = 0; i < buffer_count; ++i)
        is_replaced[i] = is_replaced[i] && !is_read[i];
    return is_replaced;
}

/* Replaces a fallback buffer with one byte. Only readers without meshopt need it; its views are
 * decoded from another buffer. */
void make_empty(json &buffer)
{
    buffer["uri"] = "data:application/octet-stream;base64,AA==";
    buffer["byteLength"] = 1;
}

/* Points the first buffer of a .glb to the BIN chunk, and limits the total size of the buffers. */
void prepare_buffers(json &document, const gltf_container &container, buffer_files &source)
{
    auto buffers = document.find("buffers");
    size_t total = 0, index = 0;
    if (buffers == document.end())
        return;
    const std::vector<bool> is_replaced = find_replaced(document, buffers->size());
    const bool has_chunk = container.binary.at != container.binary.end;
    for (json &buffer : *buffers) {
        bool is_chunk = index == 0 && has_chunk;
        if (!buffer.contains("uri") && (meshopt_of(buffer) || (is_replaced[index] && !is_chunk)))
            make_empty(buffer);
        size_t length = buffer.value("byteLength", (size_t)0);
        total += length;
        if (length == 0 || total > BUFFER_BYTES_MAX)
            gltf_fail(MRT_ERR_UNSUPPORTED,
                      "buffers[%zu].byteLength: all buffers together must have 1 to %zu bytes",
                      index, BUFFER_BYTES_MAX);
        if (!buffer.contains("uri")) {
            if (!container.is_binary || index > 0)
                gltf_fail(MRT_ERR_FORMAT, "buffers[%zu] has no uri", index);
            if (length > (size_t)(container.binary.end - container.binary.at))
                gltf_fail(MRT_ERR_FORMAT, "buffers[0] has %zu bytes, the BIN chunk %zu", length,
                          (size_t)(container.binary.end - container.binary.at));
            source.binary = {container.binary.at, container.binary.at + length};
            buffer["uri"] = BINARY_CHUNK_NAME;
        } else if (!buffer["uri"].is_string()) {
            gltf_fail(MRT_ERR_FORMAT, "buffers[%zu].uri must be a string", index);
        }
        index += 1;
    }
}

bool is_plain_file_name(const std::string &name)
{
    if (name.empty() || name.size() > 255 || name[0] == '.')
        return false;
    for (char c : name)
        if (c == '/' || c == '\\' || c == ':' || (unsigned char)c < 32 || c == 127)
            return false;
    return true;
}

bool file_exists(const std::string &, void *)
{
    return true; /* read_buffer reports the error */
}

std::string same_path(const std::string &path, void *)
{
    return path;
}

bool read_buffer(std::vector<unsigned char> *out, std::string *, const std::string &uri, void *data)
{
    buffer_files *source = static_cast<buffer_files *>(data);
    if (uri == BINARY_CHUNK_NAME && source->binary.at) {
        out->assign(source->binary.at, source->binary.end);
        return true;
    }
    std::string shown = gltf_printable(uri);
    if (!source->directory || !is_plain_file_name(uri)) {
        (void)error_set(&source->failed, MRT_ERR_UNSUPPORTED,
                        "buffer \"%s\": only data URIs%s are read", shown.c_str(),
                        source->directory ? " and files beside the .gltf" : "");
        return false;
    }
    file_bytes bytes;
    std::string path = source->directory + uri;
    struct stat status;
    if (file_check_below(source->directory, path.c_str(), &source->failed) < 0)
        return false;
    /* If many buffers used the same file, a small file could fill all memory. */
    if (stat(path.c_str(), &status) == 0 &&
        !source->files.insert({status.st_dev, status.st_ino}).second) {
        (void)error_set(&source->failed, MRT_ERR_UNSUPPORTED,
                        "buffer \"%s\": another buffer already uses this file", shown.c_str());
        return false;
    }
    if (file_read(&bytes, path.c_str(), BUFFER_BYTES_MAX, &source->failed) < 0)
        return false;
    try {
        out->assign(bytes.data, bytes.data + bytes.size);
    } catch (...) {
        file_bytes_finish(&bytes);
        throw;
    }
    file_bytes_finish(&bytes);
    return true;
}

int hex_digit(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

std::string first_line(const std::string &text)
{
    std::string line = text.substr(0, std::min<size_t>(text.find('\n'), 200));
    std::string out(line.size() + 1, '\0');
    text_copy(&out[0], out.size(), text_view_of(line.data(), line.size()));
    return out.c_str();
}

/* Returns the message without the library's prefix: "[json.exception.parse_error.101] ". */
std::string sentence_of(const json::exception &caught)
{
    const std::string text = caught.what();
    const size_t end = text.find("] ");
    return first_line(end == std::string::npos ? text : text.substr(end + 2));
}

json parse_json(const text_view &text)
{
    try {
        return json::parse(text.at, text.end);
    } catch (const json::exception &caught) {
        gltf_fail(MRT_ERR_FORMAT, "the JSON is broken: %s", sentence_of(caught).c_str());
    }
}

/* ---- compressed data (KHR_draco_mesh_compression, EXT_meshopt_compression): decoded first, in one
 * call of the child process, into ordinary buffers ---- */

struct job_list {
    std::vector<decode_job> jobs;
    std::vector<std::string> names; /* name of the data of each job, for messages */

    job_list() = default;
    job_list(const job_list &) = delete;
    job_list &operator=(const job_list &) = delete;
    ~job_list()
    {
        for (decode_job &job : jobs)
            decode_job_finish(&job);
    }

    decode_order &add(decode_kind kind, const text_view &bytes, const std::string &name)
    {
        decode_job job = {};
        job.order.kind = kind;
        job.data = bytes.at;
        job.size = (size_t)(bytes.end - bytes.at);
        jobs.push_back(job);
        names.push_back(name);
        return jobs.back().order;
    }

    /* Runs all jobs. First deducts the sizes of the inputs and answers from the file's budget. An
     * input counts each time that it is used. */
    void run(size_t file_size)
    {
        error failed = {""};
        budget all = budget_of(BUDGET_MESH, file_size);
        for (size_t i = 0; i < jobs.size(); ++i) {
            size_t size = decode_answer_size(&jobs[i].order);
            if (size == 0)
                gltf_fail(MRT_ERR_FORMAT, "%s: its compression settings are invalid",
                          names[i].c_str());
            if (budget_spend_bytes(&all, size + jobs[i].size, &failed) < 0)
                gltf_fail(MRT_ERR_UNSUPPORTED, "%s: %s", names[i].c_str(), failed.text);
        }
        mrt_result result = decode_run(jobs.data(), (uint32_t)jobs.size(), &failed);
        if (result < 0)
            gltf_fail(result, "%s", failed.text);
        for (size_t i = 0; i < jobs.size(); ++i)
            if (!jobs[i].out)
                gltf_fail(MRT_ERR_FORMAT, "%s: %s", names[i].c_str(), jobs[i].failed.text);
    }
};

/* Returns `size` bytes of a buffer of the model, or fails. */
text_view bytes_of(const tinygltf::Model &model, int buffer, size_t offset, size_t size,
                   const std::string &name)
{
    if (buffer < 0 || (size_t)buffer >= model.buffers.size())
        gltf_fail(MRT_ERR_FORMAT, "%s: its buffer does not exist", name.c_str());
    const std::vector<unsigned char> &bytes = model.buffers[(size_t)buffer].data;
    if (offset > bytes.size() || size > bytes.size() - offset)
        gltf_fail(MRT_ERR_FORMAT, "%s: it goes past the end of its buffer", name.c_str());
    return text_view_of(bytes.data() + offset, size);
}

/* Adds a buffer with these bytes, and a view of the whole buffer. */
int add_view(tinygltf::Model &model, const unsigned char *at, size_t size, size_t stride)
{
    tinygltf::Buffer buffer;
    buffer.data.assign(at, at + size);
    model.buffers.push_back(std::move(buffer));
    tinygltf::BufferView view;
    view.buffer = (int)model.buffers.size() - 1;
    view.byteLength = size;
    view.byteStride = stride;
    model.bufferViews.push_back(std::move(view));
    return (int)model.bufferViews.size() - 1;
}

/* ---- meshopt ---- */

const tinygltf::Value *meshopt_of(const tinygltf::BufferView &view)
{
    for (const char *name : GLTF_MESHOPT_NAMES) {
        auto found = view.extensions.find(name);
        if (found != view.extensions.end())
            return &found->second;
    }
    return nullptr;
}

uint32_t word_of(const tinygltf::Value &value, const char *const *words, uint32_t count)
{
    for (uint32_t i = 0; i < count && value.IsString(); ++i)
        if (value.Get<std::string>() == words[i])
            return i + 1;
    return 0;
}

void add_meshopt(job_list &out, const tinygltf::Model &model, size_t index)
{
    static const char *const modes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
    static const char *const filters[] = {"OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
    std::string name = "bufferViews[" + std::to_string(index) + "]";
    const tinygltf::BufferView &view = model.bufferViews[index];
    const tinygltf::Value &how = *meshopt_of(view);
    int64_t offset = gltf_whole(gltf_member(how, "byteOffset"), 0);
    int64_t length = gltf_whole(gltf_member(how, "byteLength"), -1);
    int64_t stride = gltf_whole(gltf_member(how, "byteStride"), -1);
    int64_t count = gltf_whole(gltf_member(how, "count"), -1);
    if (offset < 0 || length <= 0 || stride <= 0 || count <= 0)
        gltf_fail(MRT_ERR_FORMAT, "%s: its compression settings are invalid", name.c_str());
    text_view bytes = bytes_of(model, (int)gltf_whole(gltf_member(how, "buffer"), -1),
                               (size_t)offset, (size_t)length, name);
    decode_order &order = out.add(DECODE_MESHOPT, bytes, name);
    order.count = (uint32_t)count;
    order.stride = (uint32_t)stride;
    order.mode = word_of(gltf_member(how, "mode"), modes, 3);
    order.filter = word_of(gltf_member(how, "filter"), filters, 3);
    if (decode_answer_size(&order) != view.byteLength)
        gltf_fail(MRT_ERR_FORMAT, "%s: %zu bytes, but %lld of %lld bytes are compressed in it",
                  name.c_str(), view.byteLength, (long long)count, (long long)stride);
}

void decode_meshopt(tinygltf::Model &model, size_t file_size)
{
    job_list list;
    std::vector<size_t> views;
    for (size_t i = 0; i < model.bufferViews.size(); ++i)
        if (meshopt_of(model.bufferViews[i]))
            views.push_back(i);
    if (views.empty())
        return;
    for (size_t view : views)
        add_meshopt(list, model, view);
    list.run(file_size);
    for (size_t i = 0; i < views.size(); ++i) {
        const decode_job &job = list.jobs[i];
        size_t stride = model.bufferViews[views[i]].byteStride;
        int made =
            add_view(model, static_cast<const unsigned char *>(job.out), job.out_size, stride);
        model.bufferViews[views[i]] = model.bufferViews[(size_t)made];
        model.bufferViews.pop_back();
    }
}

/* ---- Draco ---- */

struct draco_primitive {
    tinygltf::Primitive *primitive;
    int indices;                         /* accessor */
    std::vector<std::string> attributes; /* in the order of the attributes of the job */
};

uint32_t count_of(const tinygltf::Accessor &accessor, const std::string &name)
{
    const size_t count_max = (size_t)1 << 26;
    if (accessor.count == 0 || accessor.count > count_max)
        gltf_fail(MRT_ERR_FORMAT, "%s: its counts are invalid", name.c_str());
    return (uint32_t)accessor.count;
}

void add_draco(job_list &out, std::vector<draco_primitive> &patches, const tinygltf::Model &model,
               tinygltf::Primitive &primitive, const std::string &name)
{
    const tinygltf::Value &how = primitive.extensions.at("KHR_draco_mesh_compression");
    auto position = primitive.attributes.find("POSITION");
    int indices = (int)gltf_whole(gltf_member(how, "indices"),
                                  -1); /* moved there by set_aside_draco_indices */
    if (indices < 0)
        return; /* the file also has the uncompressed data */
    if (position == primitive.attributes.end() || primitive.mode != TINYGLTF_MODE_TRIANGLES)
        gltf_fail(MRT_ERR_UNSUPPORTED, "%s: only triangles are supported with Draco", name.c_str());
    int64_t view_index = gltf_whole(gltf_member(how, "bufferView"), -1);
    if (view_index < 0 || (size_t)view_index >= model.bufferViews.size())
        gltf_fail(MRT_ERR_FORMAT, "%s: its compressed data is missing", name.c_str());
    const tinygltf::BufferView &view = model.bufferViews[(size_t)view_index];
    text_view bytes = bytes_of(model, view.buffer, view.byteOffset, view.byteLength, name);
    decode_order &order = out.add(DECODE_DRACO, bytes, name);
    order.count = count_of(gltf_accessor_at(model, position->second), name);
    order.index_count = count_of(gltf_accessor_at(model, indices), name);
    draco_primitive patch = {&primitive, indices, {}};
    for (const auto &attribute : primitive.attributes) {
        int64_t id =
            gltf_whole(gltf_member(gltf_member(how, "attributes"), attribute.first.c_str()), -1);
        const tinygltf::Accessor &accessor = gltf_accessor_at(model, attribute.second);
        if (id < 0) /* this attribute is not compressed */
            continue;
        if (order.attribute_count == DECODE_ATTRIBUTES_MAX || accessor.count != order.count)
            gltf_fail(MRT_ERR_UNSUPPORTED, "%s: its compressed attributes are too many, or differ",
                      name.c_str());
        int components = tinygltf::GetNumComponentsInType((uint32_t)accessor.type);
        order.attribute[order.attribute_count++] = {(uint32_t)id, (uint32_t)accessor.componentType,
                                                    components > 0 ? (uint32_t)components : 0};
        patch.attributes.push_back(attribute.first);
    }
    patches.push_back(std::move(patch));
}

/* Adds a copy of accessor `like` that refers to these bytes. */
int add_accessor(tinygltf::Model &model, int like, const unsigned char *at, size_t size)
{
    tinygltf::Accessor accessor = model.accessors[(size_t)like];
    accessor.bufferView = add_view(model, at, size, 0);
    accessor.byteOffset = 0;
    model.accessors.push_back(std::move(accessor));
    return (int)model.accessors.size() - 1;
}

void patch_draco(tinygltf::Model &model, const draco_primitive &patch, const decode_job &job)
{
    const unsigned char *at = static_cast<const unsigned char *>(job.out);
    size_t size = (size_t)job.order.index_count * sizeof(uint32_t);
    int indices = add_accessor(model, patch.indices, at, size);
    model.accessors[(size_t)indices].componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    patch.primitive->indices = indices;
    at += size;
    for (size_t i = 0; i < patch.attributes.size(); ++i) {
        decode_order alone = {};
        alone.kind = DECODE_DRACO;
        alone.count = job.order.count;
        alone.attribute_count = 1;
        alone.attribute[0] = job.order.attribute[i];
        size = decode_answer_size(&alone);
        int &accessor = patch.primitive->attributes.at(patch.attributes[i]);
        accessor = add_accessor(model, accessor, at, size);
        at += size;
    }
}

void decode_draco(tinygltf::Model &model, size_t file_size)
{
    job_list list;
    std::vector<draco_primitive> patches;
    for (size_t m = 0; m < model.meshes.size(); ++m)
        for (size_t p = 0; p < model.meshes[m].primitives.size(); ++p) {
            tinygltf::Primitive &primitive = model.meshes[m].primitives[p];
            if (primitive.extensions.count("KHR_draco_mesh_compression"))
                add_draco(list, patches, model, primitive,
                          "meshes[" + std::to_string(m) + "].primitives[" + std::to_string(p) +
                              "]");
        }
    if (patches.empty())
        return;
    list.run(file_size);
    for (size_t i = 0; i < patches.size(); ++i)
        patch_draco(model, patches[i], list.jobs[i]);
}

} // namespace

void gltf_fail(mrt_result code, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_printable(text); /* the text contains names from the file */
    throw gltf_failure(code, text);
}

const tinygltf::Accessor &gltf_accessor_at(const tinygltf::Model &model, int index)
{
    if (index < 0 || (size_t)index >= model.accessors.size())
        gltf_fail(MRT_ERR_FORMAT, "accessor %d is used, but the file has %zu", index,
                  model.accessors.size());
    return model.accessors[(size_t)index];
}

const tinygltf::Value &gltf_member(const tinygltf::Value &of, const char *key)
{
    static const tinygltf::Value none;
    return of.IsObject() && of.Has(key) ? of.Get(key) : none;
}

int64_t gltf_whole(const tinygltf::Value &value, int64_t otherwise)
{
    if (value.IsInt())
        return value.GetNumberAsInt();
    double number = value.IsNumber() ? value.GetNumberAsDouble() : -0.5;
    return number >= INT32_MIN && number <= INT32_MAX && number == (double)(int64_t)number
               ? (int64_t)number
               : otherwise;
}

std::string gltf_percent_decoded(const std::string &uri)
{
    std::string out;
    for (size_t i = 0; i < uri.size(); ++i) {
        int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
        int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
        out += low >= 0 ? (char)(high * 16 + low) : uri[i];
        i += low >= 0 ? 2 : 0;
    }
    return out;
}

std::string gltf_printable(const std::string &text)
{
    std::string out(std::min<size_t>(text.size(), 64) + 1, '\0');
    text_copy(&out[0], out.size(), text_view_of(text.data(), text.size()));
    return out.c_str();
}

mrt_result gltf_container_parse(gltf_container *out, const void *data, size_t size, error *err)
{
    const text_view file = text_view_of(data, size);
    bool is_binary = size >= 4 && std::memcmp(data, "glTF", 4) == 0;
    *out = {file, {nullptr, nullptr}, is_binary};
    if (out->is_binary) {
        mrt_result result = split_chunks(out, file, err);
        if (result < 0)
            return result;
    }
    return check_limits(out->json, err);
}

gltf_document gltf_load(const gltf_container &container, const char *directory)
{
    gltf_document out;
    json document = parse_json(container.json);
    check_document(document);
    for (const json &image : array_at(document, "", "images"))
        out.images.push_back({image.value("name", ""), image.value("uri", ""),
                              (int)image.value("bufferView", (int64_t)-1)});
    for (const json &material : array_at(document, "", "materials"))
        out.has_roughness.push_back(
            object_at(material, "", "pbrMetallicRoughness").contains("roughnessFactor"));
    for (const char *section : {"animations", "cameras", "extras", "images"})
        document.erase(section);
    set_aside_draco_indices(document);
    if (document.contains("skins"))
        for (json &skin : document["skins"])
            if (!skin.contains("inverseBindMatrices"))
                skin["inverseBindMatrices"] = -1; /* required by tinygltf, optional in glTF */
    buffer_files source = {{nullptr, nullptr}, directory, {}, {""}};
    prepare_buffers(document, container, source);

    tinygltf::TinyGLTF loader;
    tinygltf::Model &model = out.model;
    std::string failed, warned, text = document.dump();
    document = nullptr;
    loader.SetFsCallbacks({file_exists, same_path, read_buffer, nullptr, &source});
    bool loaded = loader.LoadASCIIFromString(&model, &failed, &warned, text.data(),
                                             (unsigned int)text.size(), "");
    if (source.failed.text[0])
        gltf_fail(MRT_ERR_IO, "%s", source.failed.text);
    if (!loaded || !failed.empty())
        gltf_fail(MRT_ERR_FORMAT, "%s",
                  failed.empty() ? "the document is invalid" : first_line(failed).c_str());
    return out;
}

void gltf_decode(tinygltf::Model &model, size_t file_size)
{
    decode_meshopt(model, file_size);
    decode_draco(model, file_size);
}

#include "io/read/gltf_load.hpp"

#include <cstdarg>
#include <cstdint>
#include <initializer_list>
#include <set>

#include <sys/stat.h>

#include <nlohmann/json.hpp>

extern "C" {
#include "base/file.h"
}

using nlohmann::json;

namespace
{

const char BINARY_CHUNK_NAME[] = "marotte:binary"; /* no file can be called that: ':' is refused */
const size_t BUFFER_BYTES_MAX = (size_t)1 << 30;   /* all buffers together */

/* Where tinygltf's file callbacks find bytes. */
struct buffer_source {
    text_view binary; /* cut to the length of the first buffer */
    const char *directory;
    std::set<std::pair<dev_t, ino_t>> files; /* those that were read */
    error failed;
};

/* ---- checks of the document ---- */

/* Absent, or a whole number in [0, 2^31): tinygltf ignores other values or cuts them to an int. */
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

/* Absent, or `count` numbers. */
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
    check_whole(accessor, where, {"bufferView", "byteOffset", "componentType", "count"});
    const json &sparse = object_at(accessor, where, "sparse");
    check_whole(sparse, where + ".sparse", "count");
    check_whole(object_at(sparse, where + ".sparse", "indices"), where + ".sparse.indices",
                {"bufferView", "byteOffset", "componentType"});
    check_whole(object_at(sparse, where + ".sparse", "values"), where + ".sparse.values",
                {"bufferView", "byteOffset"});
    if (accessor.contains("normalized") && !accessor["normalized"].is_boolean())
        gltf_fail(MRT_ERR_FORMAT, "%s.normalized must be true or false", where.c_str());
}

void check_buffer_view(const json &view, const std::string &where)
{
    check_whole(view, where, {"buffer", "byteOffset", "byteLength", "byteStride"});
}

void check_buffer(const json &buffer, const std::string &where)
{
    check_whole(buffer, where, "byteLength");
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

void check_node(const json &node, const std::string &where)
{
    check_whole(node, where, {"mesh", "skin"});
    check_indices(node, where, "children");
    check_numbers(node, where, "matrix", 16);
    check_numbers(node, where, "translation", 3);
    check_numbers(node, where, "rotation", 4);
    check_numbers(node, where, "scale", 3);
}

void check_skin(const json &skin, const std::string &where)
{
    check_whole(skin, where, {"inverseBindMatrices", "skeleton"});
    check_indices(skin, where, "joints");
}

void check_scene(const json &scene, const std::string &where)
{
    check_indices(scene, where, "nodes");
}

void check_texture_info(const json &parent, const std::string &where, const char *key)
{
    const json &info = object_at(parent, where, key);
    check_whole(info, where + "." + key, {"index", "texCoord"});
}

void check_texture(const json &texture, const std::string &where)
{
    check_whole(texture, where, {"sampler", "source"});
}

void check_image(const json &image, const std::string &where)
{
    check_whole(image, where, "bufferView");
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

void check_section(const json &document, const char *key,
                   void (*check)(const json &, const std::string &))
{
    size_t index = 0;
    for (const json &item : array_at(document, "", key)) {
        std::string where = std::string(key) + "[" + std::to_string(index++) + "]";
        if (!item.is_object())
            gltf_fail(MRT_ERR_FORMAT, "%s must be an object", where.c_str());
        check(item, where);
    }
}

/* Extensions that are read, or change nothing of what is read here. */
bool is_known(const std::string &extension)
{
    static const char *const known[] = {"KHR_mesh_quantization",
                                        "KHR_texture_transform",
                                        "KHR_texture_basisu",
                                        "KHR_lights_punctual",
                                        "EXT_texture_webp",
                                        "EXT_texture_avif",
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
    check_section(document, "accessors", check_accessor);
    check_section(document, "bufferViews", check_buffer_view);
    check_section(document, "buffers", check_buffer);
    check_section(document, "meshes", check_mesh);
    check_section(document, "nodes", check_node);
    check_section(document, "scenes", check_scene);
    check_section(document, "skins", check_skin);
    check_section(document, "materials", check_material);
    check_section(document, "textures", check_texture);
    check_section(document, "images", check_image);
}

/* ---- buffers ---- */

/* tinygltf wants indices in a buffer: those that are compressed wait in the extension until they
 * are decoded. */
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

/* A buffer that only readers without meshopt would need (its views are decoded from another). */
void make_fallback_empty(json &buffer)
{
    const char *const names[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
    auto extensions = buffer.find("extensions");
    if (buffer.contains("uri") || extensions == buffer.end() || !extensions->is_object())
        return;
    for (const char *name : names)
        if (extensions->contains(name)) {
            buffer["uri"] = "data:application/octet-stream;base64,AA==";
            buffer["byteLength"] = 1;
        }
}

/* Points the first buffer of a .glb to the BIN chunk, and bounds what all buffers take. */
void prepare_buffers(json &document, const gltf_container &container, buffer_source &source)
{
    auto buffers = document.find("buffers");
    size_t total = 0, index = 0;
    if (buffers == document.end())
        return;
    for (json &buffer : *buffers) {
        make_fallback_empty(buffer);
        size_t length = buffer.value("byteLength", (size_t)0);
        total += length;
        if (length == 0 || total > BUFFER_BYTES_MAX)
            gltf_fail(MRT_ERR_UNSUPPORTED,
                      "buffers[%zu].byteLength: 1 to %zu bytes in all are accepted", index,
                      BUFFER_BYTES_MAX);
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
    return true; /* read_buffer says what is wrong */
}

std::string same_path(const std::string &path, void *)
{
    return path;
}

bool read_buffer(std::vector<unsigned char> *out, std::string *, const std::string &uri, void *data)
{
    buffer_source *source = static_cast<buffer_source *>(data);
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
    /* A small file would fill all memory, if it were as many buffers as one likes. */
    if (stat(path.c_str(), &status) == 0 &&
        !source->files.insert({status.st_dev, status.st_ino}).second) {
        (void)error_set(&source->failed, MRT_ERR_UNSUPPORTED,
                        "buffer \"%s\": its file is another buffer already", shown.c_str());
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

std::string first_line(const std::string &text)
{
    std::string line = text.substr(0, std::min<size_t>(text.find('\n'), 200));
    std::string out(line.size() + 1, '\0');
    text_copy(&out[0], out.size(), text_view_of(line.data(), line.size()));
    return out.c_str();
}

/* Without the library's name for what is wrong: "[json.exception.parse_error.101] ". */
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

} // namespace

void gltf_fail(mrt_result code, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_printable(text); /* names of the file are in it */
    throw gltf_failure(code, text);
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

std::string gltf_printable(const std::string &text)
{
    std::string out(std::min<size_t>(text.size(), 64) + 1, '\0');
    text_copy(&out[0], out.size(), text_view_of(text.data(), text.size()));
    return out.c_str();
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
        out.says_roughness.push_back(
            object_at(material, "", "pbrMetallicRoughness").contains("roughnessFactor"));
    for (const char *section : {"animations", "cameras", "extras", "images"})
        document.erase(section);
    set_aside_draco_indices(document);
    if (document.contains("skins"))
        for (json &skin : document["skins"])
            if (!skin.contains("inverseBindMatrices"))
                skin["inverseBindMatrices"] = -1; /* tinygltf asks for them; glTF does not */
    buffer_source source = {{nullptr, nullptr}, directory, {}, {""}};
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
                  failed.empty() ? "the document makes no sense" : first_line(failed).c_str());
    return out;
}

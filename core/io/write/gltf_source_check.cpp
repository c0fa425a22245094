#include "io/write/gltf_source_check.hpp"

#include <cfloat>
#include <cmath>
#include <cstring>

using nlohmann::ordered_json;

namespace
{

/* Place of a value. It is converted to a JSON pointer only for messages. */
struct place {
    const place *in; /* NULL: the document */
    const char *name;
    size_t index; /* index of the item if name is NULL */
};

const place DOCUMENT = {nullptr, nullptr, 0};

std::string pointer_to(const place &at)
{
    if (!at.in)
        return "";
    std::string name = at.name ? "" : std::to_string(at.index);
    for (const char *c = at.name; c && *c; ++c)
        name += *c == '~' ? "~0" : *c == '/' ? "~1" : std::string(1, *c);
    return pointer_to(*at.in) + "/" + name;
}

[[noreturn]] void refuse(const place &at, const std::string &why)
{
    gltf_fail(MRT_ERR_FORMAT, "%s %s", pointer_to(at).c_str(), why.c_str());
}

const ordered_json &list_at(const ordered_json &of, const char *key, const place &at)
{
    static const ordered_json none = ordered_json::array();
    auto found = of.find(key);
    if (found == of.end())
        return none;
    if (!found->is_array())
        refuse({&at, key, 0}, "is not a list");
    return *found;
}

/* Runs action(value, place) for all matches of a pattern, "/meshes/#/name": # is each item of a
 * list, * each member of an object. Missing values are skipped. */
template <class Action>
void for_each(const ordered_json &value, const char *pattern, const place &at, Action action)
{
    if (*pattern == '\0') {
        action(value, at);
        return;
    }
    const char *rest = pattern + 1 + std::strcspn(pattern + 1, "/");
    const std::string name(pattern + 1, rest);
    if (name == "#") {
        if (!value.is_array())
            refuse(at, "is not a list");
        for (size_t i = 0; i < value.size(); ++i)
            for_each(value[i], rest, {&at, nullptr, i}, action);
        return;
    }
    if (!value.is_object())
        refuse(at, "is not an object");
    for (auto member = value.begin(); member != value.end(); ++member)
        if (name == "*" || name == member.key())
            for_each(*member, rest, {&at, member.key().c_str(), 0}, action);
}

/* ---- indices ---- */

struct index_rule {
    const char *at, *list; /* of the document */
};

const index_rule INDICES[] = {
    {"/bufferViews/#/buffer", "buffers"},
    {"/bufferViews/#/extensions/EXT_meshopt_compression/buffer", "buffers"},
    {"/bufferViews/#/extensions/KHR_meshopt_compression/buffer", "buffers"},
    {"/accessors/#/bufferView", "bufferViews"},
    {"/accessors/#/sparse/indices/bufferView", "bufferViews"},
    {"/accessors/#/sparse/values/bufferView", "bufferViews"},
    {"/images/#/bufferView", "bufferViews"},
    {"/textures/#/source", "images"},
    {"/textures/#/extensions/*/source", "images"},
    {"/textures/#/sampler", "samplers"},
    {"/materials/#/pbrMetallicRoughness/baseColorTexture/index", "textures"},
    {"/materials/#/pbrMetallicRoughness/metallicRoughnessTexture/index", "textures"},
    {"/materials/#/normalTexture/index", "textures"},
    {"/materials/#/occlusionTexture/index", "textures"},
    {"/materials/#/emissiveTexture/index", "textures"},
    {"/meshes/#/primitives/#/attributes/*", "accessors"},
    {"/meshes/#/primitives/#/targets/#/*", "accessors"},
    {"/meshes/#/primitives/#/indices", "accessors"},
    {"/meshes/#/primitives/#/material", "materials"},
    {"/meshes/#/primitives/#/extensions/KHR_draco_mesh_compression/bufferView", "bufferViews"},
    {"/nodes/#/children/#", "nodes"},
    {"/nodes/#/mesh", "meshes"},
    {"/nodes/#/skin", "skins"},
    {"/nodes/#/camera", "cameras"},
    {"/nodes/#/extensions/EXT_mesh_gpu_instancing/attributes/*", "accessors"},
    {"/skins/#/joints/#", "nodes"},
    {"/skins/#/skeleton", "nodes"},
    {"/skins/#/inverseBindMatrices", "accessors"},
    {"/scenes/#/nodes/#", "nodes"},
    {"/scene", "scenes"},
    {"/animations/#/channels/#/target/node", "nodes"},
    {"/animations/#/samplers/#/input", "accessors"},
    {"/animations/#/samplers/#/output", "accessors"},
};

void check_index(const ordered_json &value, const place &at, const char *list, size_t count)
{
    if (!value.is_number_unsigned() || value.get<uint64_t>() >= count)
        refuse(at, "is " + value.dump().substr(0, 24) + ", but the file has " +
                       std::to_string(count) + " " + list);
}

void check_indices(const ordered_json &document)
{
    for (const index_rule &rule : INDICES) {
        const size_t count = list_at(document, rule.list, DOCUMENT).size();
        for_each(document, rule.at, DOCUMENT, [&](const ordered_json &value, const place &at) {
            check_index(value, at, rule.list, count);
        });
    }
    for_each(document, "/animations/#", DOCUMENT, [](const ordered_json &value, const place &at) {
        const size_t count = list_at(value, "samplers", at).size();
        for_each(value, "/channels/#/sampler", at,
                 [&](const ordered_json &sampler, const place &of) {
                     check_index(sampler, of, "samplers", count);
                 });
    });
}

/* ---- ranges ---- */

/* Returns a member. Fails if it is missing and has no default. */
size_t whole_at(const ordered_json &of, const char *key, const place &at,
                const size_t *otherwise = nullptr)
{
    auto found = of.find(key);
    if (found == of.end() && otherwise)
        return *otherwise;
    if (found == of.end() || !found->is_number_unsigned())
        refuse({&at, key, 0}, "is not a whole number");
    return found->get<size_t>();
}

size_t offset_at(const ordered_json &of, const place &at)
{
    const size_t none = 0;
    return whole_at(of, "byteOffset", at, &none);
}

/* Checks a range in a buffer that is given by its index. */
void check_range(const ordered_json &of, const place &at, const std::vector<size_t> &buffer_size)
{
    const size_t size = buffer_size[whole_at(of, "buffer", at)], offset = offset_at(of, at);
    if (offset > size || whole_at(of, "byteLength", at) > size - offset)
        refuse(at, "goes past the end of its buffer");
}

/* Returns the size in bytes; 0: not a glTF type. Columns of matrices begin at multiples of 4 bytes.
 */
size_t element_size(const ordered_json &accessor)
{
    static const struct {
        const char *name;
        size_t columns, rows;
    } shapes[] = {{"SCALAR", 1, 1}, {"VEC2", 1, 2}, {"VEC3", 1, 3}, {"VEC4", 1, 4},
                  {"MAT2", 2, 2},   {"MAT3", 3, 3}, {"MAT4", 4, 4}};
    static const size_t component_size[] = {1, 1, 2, 2, 0, 4, 4}; /* of 5120 to 5126 */
    auto type = accessor.find("type"), component = accessor.find("componentType");
    if (type == accessor.end() || component == accessor.end() || !component->is_number_unsigned() ||
        *component < 5120 || *component > 5126)
        return 0;
    for (const auto &shape : shapes)
        if (*type == shape.name) {
            size_t column = shape.rows * component_size[component->get<size_t>() - 5120];
            return shape.columns == 1 ? column : shape.columns * ((column + 3) & ~size_t{3});
        }
    return 0;
}

/* Checks that a buffer view contains the elements. An accessor without a buffer view stores no
 * data. */
void check_elements(const ordered_json &of, const place &at, const ordered_json &views, size_t size,
                    size_t count)
{
    auto index = of.find("bufferView");
    if (index == of.end())
        return;
    const ordered_json &view = views[index->get<size_t>()];
    const size_t length = whole_at(view, "byteLength", at), offset = offset_at(of, at),
                 stride = whole_at(view, "byteStride", at, &size);
    if (size == 0 || count == 0 || stride < size)
        refuse(at, "has no elements of a size that glTF has");
    if (offset > length || size > length - offset ||
        (count - 1) > (length - offset - size) / stride)
        refuse(at, "goes past the end of its buffer view");
}

void check_ranges(const ordered_json &document, const std::vector<size_t> &buffer_size)
{
    for (const char *pattern :
         {"/bufferViews/#", "/bufferViews/#/extensions/EXT_meshopt_compression",
          "/bufferViews/#/extensions/KHR_meshopt_compression"})
        for_each(document, pattern, DOCUMENT, [&](const ordered_json &value, const place &at) {
            if (!value.is_object())
                refuse(at, "is not an object");
            check_range(value, at, buffer_size);
        });
    const ordered_json &views = list_at(document, "bufferViews", DOCUMENT);
    for_each(document, "/accessors/#", DOCUMENT, [&](const ordered_json &value, const place &at) {
        const size_t size = element_size(value);
        check_elements(value, at, views, size, whole_at(value, "count", at));
        auto sparse = value.find("sparse");
        if (sparse == value.end())
            return;
        const place within = {&at, "sparse", 0};
        const size_t count = whole_at(*sparse, "count", within);
        for_each(*sparse, "/values", within, [&](const ordered_json &of, const place &there) {
            check_elements(of, there, views, size, count);
        });
        for_each(*sparse, "/indices", within, [&](const ordered_json &of, const place &there) {
            ordered_json index = of;
            index["type"] = "SCALAR";
            check_elements(of, there, views, element_size(index), count);
        });
    });
}

/* ---- lists that an export appends to: targets, their names and weights ---- */

void check_weights(const ordered_json &of, const place &at, size_t target_count)
{
    const ordered_json &weights = list_at(of, "weights", at);
    const place here = {&at, "weights", 0};
    if (weights.size() > target_count)
        refuse(here, "are " + std::to_string(weights.size()) + " of " +
                         std::to_string(target_count) + " targets");
    for (const ordered_json &weight : weights)
        if (!weight.is_number() || !(std::fabs(weight.get<double>()) <= double{FLT_MAX}))
            refuse(here, "are not all finite numbers");
}

size_t target_count_of(const ordered_json &mesh)
{
    const ordered_json &first = mesh["primitives"][0];
    auto targets = first.find("targets");
    return targets == first.end() ? 0 : targets->size();
}

void check_mesh(const ordered_json &mesh, const place &at)
{
    const ordered_json &primitives = list_at(mesh, "primitives", at);
    const place all = {&at, "primitives", 0};
    if (primitives.empty())
        refuse(all, "is missing or empty");
    const size_t target_count = target_count_of(mesh);
    for (size_t i = 0; i < primitives.size(); ++i) {
        const place here = {&all, nullptr, i};
        auto attributes = primitives[i].find("attributes");
        if (attributes == primitives[i].end() || !attributes->contains("POSITION"))
            refuse(here, "has no POSITION");
        if (list_at(primitives[i], "targets", here).size() != target_count)
            refuse(here, "does not have the same number of targets as the first primitive");
    }
    check_weights(mesh, at, target_count);
    auto extras = mesh.find("extras");
    const place of_extras = {&at, "extras", 0};
    if (extras != mesh.end() && !extras->is_object())
        refuse(of_extras, "is not an object, but it must contain the target names");
    if (extras != mesh.end())
        (void)list_at(*extras, "targetNames", of_extras);
}

void check_targets(const ordered_json &document)
{
    for_each(document, "/meshes/#", DOCUMENT, check_mesh);
    for_each(document, "/nodes/#", DOCUMENT, [&](const ordered_json &node, const place &at) {
        auto mesh = node.find("mesh");
        if (mesh != node.end())
            check_weights(node, at, target_count_of(document["meshes"][mesh->get<size_t>()]));
    });
}

} // namespace

void gltf_source_check(const ordered_json &document, const std::vector<size_t> &buffer_size)
{
    check_indices(document);
    check_ranges(document, buffer_size);
    check_targets(document);
}

#include "io/write/gltf_source.hpp"
#include "io/write/gltf_source_check.hpp"

extern "C" {
#include "base/file.h"
}

#include <algorithm>
#include <cmath>
#include <cstdlib>

using nlohmann::ordered_json;

namespace
{

constexpr size_t SOURCE_BYTES_MAX = size_t{1} << 30, IMAGE_BYTES_MAX = size_t{64} << 20;

/* The bytes of a file. */
struct open_file {
    file_bytes bytes{};
    ~open_file()
    {
        file_bytes_finish(&bytes);
    }
};

std::string directory_of(const std::string &path)
{
    size_t slash = path.rfind('/');
    return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

std::string member(const ordered_json &of, const char *key)
{
    return of.is_object() && of.contains(key) && of[key].is_string() ? of[key].get<std::string>()
                                                                     : "";
}

/* Returns an axis as a vector in file coordinates. */
void axis_of(double out[3], mesh_axis axis, mesh_axis otherwise)
{
    int which = (axis == MESH_AXIS_AUTO ? otherwise : axis) - MESH_AXIS_X;
    out[0] = out[1] = out[2] = 0.0;
    out[which % 3] = which < 3 ? 1.0 : -1.0;
}

/* Returns the transform from the mesh, in mm, to file coordinates. */
gltf_transform file_of_mesh(const mesh *m)
{
    double up[3], forward[3];
    axis_of(up, m->up, MESH_AXIS_Y);
    axis_of(forward, m->forward, MESH_AXIS_Z);
    gltf_transform out = GLTF_TRANSFORM_IDENTITY;
    for (int row = 0; row < 3; ++row) {
        int a = (row + 1) % 3, b = (row + 2) % 3;
        out.linear[row][0] = (up[a] * forward[b] - up[b] * forward[a]) / m->mm_per_unit;
        out.linear[row][1] = up[row] / m->mm_per_unit;
        out.linear[row][2] = forward[row] / m->mm_per_unit;
    }
    return out;
}

/* Inverts a matrix of three columns. Returns false if it is singular. */
bool invert(gltf_transform &out, const double column[3][3])
{
    const double *a = column[0], *b = column[1], *c = column[2];
    double cross[3][3];
    for (int i = 0; i < 3; ++i) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        cross[0][i] = b[j] * c[k] - b[k] * c[j];
        cross[1][i] = c[j] * a[k] - c[k] * a[j];
        cross[2][i] = a[j] * b[k] - a[k] * b[j];
    }
    double volume = a[0] * cross[0][0] + a[1] * cross[0][1] + a[2] * cross[0][2];
    out = GLTF_TRANSFORM_IDENTITY;
    if (!(std::fabs(volume) > 1e-30) || !std::isfinite(volume))
        return false;
    for (int row = 0; row < 3; ++row)
        for (int i = 0; i < 3; ++i)
            out.linear[row][i] = cross[row][i] / volume;
    return true;
}

void apply(float out[3], const gltf_transform &t, const float v[3])
{
    for (int row = 0; row < 3; ++row)
        out[row] = static_cast<float>(t.linear[row][0] * static_cast<double>(v[0]) +
                                      t.linear[row][1] * static_cast<double>(v[1]) +
                                      t.linear[row][2] * static_cast<double>(v[2]));
}

bool is_zero(const std::vector<float> &value, size_t first, size_t count)
{
    for (size_t i = first * 3; i < (first + count) * 3; ++i)
        if (value[i] != 0.0f)
            return false;
    return true;
}

const char *media_type(const file_bytes &image)
{
    const auto *byte = static_cast<const unsigned char *>(image.data);
    if (image.size > 8 && std::memcmp(byte, "\x89PNG", 4) == 0)
        return "image/png";
    if (image.size > 12 && std::memcmp(byte, "RIFF", 4) == 0 &&
        std::memcmp(byte + 8, "WEBP", 4) == 0)
        return "image/webp";
    return image.size > 3 && byte[0] == 0xFF && byte[1] == 0xD8 ? "image/jpeg" : nullptr;
}

/* Returns the path of a URI if it is below the folder of the document, else "". */
std::string path_below(const std::string &directory, const std::string &uri)
{
    const std::string path = gltf_percent_decoded(uri);
    bool is_outside = path.empty() || path[0] == '/' || path.find(':') != std::string::npos ||
                      path.find('\0') != std::string::npos ||
                      ("/" + path + "/").find("/../") != std::string::npos;
    return is_outside ? "" : directory + path;
}

ordered_json json_of(const tinygltf::BufferView &view)
{
    ordered_json out = {
        {"buffer", 0}, {"byteOffset", view.byteOffset}, {"byteLength", view.byteLength}};
    if (view.target)
        out["target"] = view.target;
    return out;
}

ordered_json json_of(const tinygltf::Accessor &accessor)
{
    ordered_json out;
    if (accessor.bufferView >= 0)
        out["bufferView"] = accessor.bufferView;
    out["componentType"] = accessor.componentType;
    out["count"] = accessor.count;
    out["type"] = accessor.type == TINYGLTF_TYPE_VEC4   ? "VEC4"
                  : accessor.type == TINYGLTF_TYPE_VEC3 ? "VEC3"
                                                        : "SCALAR";
    out["min"] = accessor.minValues;
    out["max"] = accessor.maxValues;
    if (accessor.sparse.isSparse)
        out["sparse"] = {{"count", accessor.sparse.count},
                         {"indices",
                          {{"bufferView", accessor.sparse.indices.bufferView},
                           {"componentType", accessor.sparse.indices.componentType}}},
                         {"values", {{"bufferView", accessor.sparse.values.bufferView}}}};
    return out;
}

} // namespace

gltf_source::gltf_source(const char *path, const mesh *m)
{
    open_file file;
    error failed = {""};
    mrt_result result = file_read(&file.bytes, path, SOURCE_BYTES_MAX, &failed);
    gltf_container container;
    if (result >= 0)
        result = gltf_container_parse(&container, file.bytes.data, file.bytes.size, &failed);
    if (result < 0)
        gltf_fail(result, "%s", failed.text);
    std::string directory = directory_of(path);
    tinygltf::Model model = gltf_load(container, directory.c_str()).model;
    document_ = ordered_json::parse(container.json.at, container.json.end);
    file_of_face_ = file_of_mesh(m);
    copies_ = budget_of(BUDGET_MESH, file.bytes.size);
    gltf_source_check(document_, buffer_sizes(model, container));
    join_buffers(model, container);
    embed_images(directory);
    gltf_decode(model, file.bytes.size);
    read_instances(model, gltf_plan_of(model, file.bytes.size), m);
}

/* Returns whether the bytes of a buffer are copied to the output. Other buffers exist only as the
 * decompressed data of their views. */
bool gltf_source::is_copied(size_t buffer, const gltf_container &container) const
{
    bool is_chunk =
        buffer == 0 && container.is_binary && container.binary.at != container.binary.end;
    return is_chunk || document_["buffers"][buffer].contains("uri");
}

std::vector<size_t> gltf_source::buffer_sizes(const tinygltf::Model &model,
                                              const gltf_container &container) const
{
    std::vector<size_t> size;
    for (size_t i = 0; i < model.buffers.size(); ++i)
        size.push_back(is_copied(i, container)
                           ? model.buffers[i].data.size()
                           : document_["buffers"][i].value("byteLength", size_t{0}));
    return size;
}

/* Joins all buffers with data into the single buffer of a .glb. New data follows it. */
void gltf_source::join_buffers(const tinygltf::Model &model, const gltf_container &container)
{
    ordered_json buffers = ordered_json::array({ordered_json::object()});
    std::vector<std::pair<size_t, size_t>> translation; /* new buffer and offset of each buffer */
    for (size_t i = 0; i < model.buffers.size(); ++i) {
        if (!is_copied(i, container)) {
            translation.push_back({buffers.size(), 0});
            buffers.push_back(document_["buffers"][i]);
            continue;
        }
        translation.push_back({0, out_.binary_size});
        gltf_bytes data = model.buffers[i].data;
        data.resize((data.size() + 7) & ~size_t{7});
        gltf_output_reserve(out_, data.size());
        out_.binary_size += data.size();
        out_.chunk.push_back(std::move(data));
    }
    auto move = [&](ordered_json &view) {
        const auto &to = translation[view["buffer"].get<size_t>()];
        view["buffer"] = to.first;
        if (to.second > 0)
            view["byteOffset"] = view.value("byteOffset", size_t{0}) + to.second;
    };
    if (!document_.contains("bufferViews"))
        document_["bufferViews"] = ordered_json::array();
    for (ordered_json &view : document_["bufferViews"]) {
        move(view);
        for (const char *extension : GLTF_MESHOPT_NAMES)
            if (view.contains("extensions") && view["extensions"].contains(extension))
                move(view["extensions"][extension]);
    }
    document_["buffers"] = std::move(buffers);
    first_view_ = document_["bufferViews"].size();
    first_accessor_ = document_.contains("accessors") ? document_["accessors"].size() : 0;
    out_.model.bufferViews.resize(first_view_);
    out_.model.accessors.resize(first_accessor_);
    for (const tinygltf::Accessor &accessor : model.accessors)
        vertex_counts_.push_back(accessor.count);
}

/* Embeds the pictures beside a .gltf, each once. A missing picture keeps its name. */
void gltf_source::embed_images(const std::string &directory)
{
    std::map<std::string, std::pair<int, const char *>> taken; /* view and media type, by path */
    if (!document_.contains("images"))
        return;
    for (ordered_json &image : document_["images"]) {
        std::string path = path_below(directory, member(image, "uri"));
        if (path.empty())
            continue;
        auto found = taken.find(path);
        if (found == taken.end())
            found = taken.insert({path, embed_image(directory, path)}).first;
        if (!found->second.second)
            continue;
        image.erase("uri");
        image["bufferView"] = found->second.first;
        image["mimeType"] = found->second.second;
    }
}

/* Embeds a picture. Returns its view and media type. NULL: it stays a separate file. */
std::pair<int, const char *> gltf_source::embed_image(const std::string &directory,
                                                      const std::string &path)
{
    open_file file;
    error ignored;
    if (file_check_below(directory.c_str(), path.c_str(), &ignored) < 0 ||
        file_read(&file.bytes, path.c_str(), IMAGE_BYTES_MAX, &ignored) < 0 ||
        !media_type(file.bytes))
        return {0, nullptr};
    const auto *byte = static_cast<const unsigned char *>(file.bytes.data);
    return {gltf_output_view(out_, gltf_bytes(byte, byte + file.bytes.size), 0),
            media_type(file.bytes)};
}

void gltf_source::place_group(group &out, const tinygltf::Model &model, const gltf_group_plan &plan,
                              gltf_skin &skin, const mesh *m)
{
    const gltf_transform file = file_of_mesh(m);
    std::vector<uint32_t> joint(plan.vertex_count * MESH_SKIN_WIDTH);
    std::vector<float> share(joint.size()), point(plan.vertex_count * 3), column[3];
    skin.read(*plan.source, plan.vertex_count, joint.data(), share.data());
    gltf_accessor(model, plan.source->attributes.at("POSITION")).read_floats(point.data());
    skin.transform_points(point.data(), plan.vertex_count);
    double size = 0.0, off = 0.0;
    for (size_t v = 0; v < plan.vertex_count; ++v) {
        float wanted[3];
        apply(wanted, file, m->position + (out.first + v) * 3);
        for (size_t i = 0; i < 3; ++i) {
            size = std::max(size, std::fabs(static_cast<double>(wanted[i])));
            off = std::max(off, std::fabs(static_cast<double>(point[v * 3 + i]) -
                                          static_cast<double>(wanted[i])));
        }
    }
    if (!(off <= 1e-4 * size))
        gltf_fail(MRT_ERR_UNSUPPORTED, "its surface differs from the performed mesh");
    for (size_t i = 0; i < 3; ++i) {
        column[i].assign(plan.vertex_count * 3, 0.0f);
        for (size_t v = 0; v < plan.vertex_count; ++v)
            column[i][v * 3 + i] = 1.0f;
        skin.transform_vectors(column[i].data(), plan.vertex_count);
    }
    for (size_t v = 0; v < plan.vertex_count; ++v) {
        double of[3][3];
        for (size_t i = 0; i < 3; ++i)
            for (size_t k = 0; k < 3; ++k)
                of[i][k] = static_cast<double>(column[i][v * 3 + k]);
        gltf_transform back;
        (void)invert(back, of); /* singular: no offset can move the vertex */
        out.back.push_back(gltf_transform_compose(back, file));
    }
    out.has_normals = plan.source->attributes.count("NORMAL") > 0;
}

/* Copies a mesh description for one more node. Copies of large descriptions may become much larger
 * than the file, so they have a budget. */
void gltf_source::copy_mesh(instance &of)
{
    constexpr size_t BYTES_A_LETTER = 16; /* memory per character of its JSON */
    ordered_json copy = document_["meshes"][of.mesh];
    error failed = {""};
    mrt_result result = budget_spend_bytes(&copies_, BYTES_A_LETTER * copy.dump().size(), &failed);
    if (result < 0)
        gltf_fail(result, "/meshes/%zu is shown by many nodes: %s", of.mesh, failed.text);
    of.mesh = document_["meshes"].size();
    document_["meshes"].push_back(std::move(copy));
    if (of.has_node)
        document_["nodes"][of.node]["mesh"] = of.mesh;
}

void gltf_source::read_instances(const tinygltf::Model &model, const gltf_plan &plan, const mesh *m)
{
    if (plan.vertex_count != m->vertex_count || plan.triangle_count != m->triangle_count)
        gltf_fail(MRT_ERR_UNSUPPORTED,
                  "it has %zu vertices and %zu triangles, but the performed mesh has %u and %u",
                  plan.vertex_count, plan.triangle_count, m->vertex_count, m->triangle_count);
    size_t vertex = 0;
    std::vector<bool> is_taken(model.meshes.size(), false);
    for (const gltf_instance &shown : plan.scene.instances) {
        const gltf_mesh_plan &of = plan.meshes.at(shown.mesh);
        gltf_skin skin(model, plan.skeleton, shown);
        instance to = {shown.mesh, shown.node, shown.has_node, {}, {}, {}, 0, {}, {}};
        for (const gltf_group_plan &from : of.groups) {
            group next = {vertex + from.first_vertex, from.vertex_count, {}, false};
            place_group(next, model, from, skin, m);
            to.groups.push_back(std::move(next));
        }
        vertex += of.vertex_count;
        const std::vector<tinygltf::Primitive> &primitives = model.meshes[shown.mesh].primitives;
        to.group_of.assign(primitives.size(), -1);
        for (const gltf_primitive_plan &surface : of.surfaces)
            to.group_of[static_cast<size_t>(surface.source - primitives.data())] =
                static_cast<int>(surface.group);
        if (is_taken[to.mesh]) /* each instance needs its own targets */
            copy_mesh(to);
        is_taken[shown.mesh] = true;
        const ordered_json &in_file = document_["meshes"][to.mesh];
        to.own_count = in_file["primitives"][0].contains("targets")
                           ? in_file["primitives"][0]["targets"].size()
                           : 0;
        to.own_weights = in_file.value("weights", ordered_json::array());
        if (to.has_node && document_["nodes"][to.node].contains("weights"))
            to.own_weights = document_["nodes"][to.node]["weights"];
        while (to.own_weights.size() < to.own_count)
            to.own_weights.push_back(0.0);
        instances_.push_back(std::move(to));
    }
}

/* Returns an accessor of zeros, for a target that does not move its primitive. */
int gltf_source::zeros(size_t count)
{
    auto found = zeros_.find(count);
    if (found != zeros_.end())
        return found->second;
    tinygltf::Accessor accessor;
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = TINYGLTF_TYPE_VEC3;
    accessor.count = count;
    accessor.minValues = accessor.maxValues = {0.0, 0.0, 0.0};
    return zeros_[count] = gltf_output_accessor(out_, std::move(accessor));
}

void gltf_source::add_to(instance &to, const std::string &name, const std::vector<float> &offset,
                         const std::vector<float> &rotation)
{
    ordered_json &in_file = document_["meshes"][to.mesh];
    std::vector<ordered_json> target_of;
    for (const group &g : to.groups) {
        bool is_still = is_zero(offset, g.first, g.count);
        ordered_json target;
        target["POSITION"] =
            is_still ? zeros(g.count) : gltf_output_offsets(out_, &offset[g.first * 3], g.count);
        if (g.has_normals)
            target["NORMAL"] = is_zero(rotation, g.first, g.count)
                                   ? zeros(g.count)
                                   : gltf_output_offsets(out_, &rotation[g.first * 3], g.count);
        target_of.push_back(std::move(target));
    }
    for (size_t i = 0; i < to.group_of.size(); ++i) {
        ordered_json &primitive = in_file["primitives"][i];
        size_t count = vertex_counts_[primitive["attributes"]["POSITION"].get<size_t>()];
        primitive["targets"].push_back(to.group_of[i] >= 0
                                           ? target_of[static_cast<size_t>(to.group_of[i])]
                                           : ordered_json{{"POSITION", zeros(count)}});
    }
    ordered_json &names = in_file["extras"]["targetNames"];
    while (names.size() < to.own_count + to.targets.size())
        names.push_back("target" + std::to_string(names.size()));
    names.push_back(name);
    to.targets.push_back(target_count_);
}

void gltf_source::add_target(const std::string &name, const float *offset, const float *rotation)
{
    for (instance &to : instances_) {
        size_t first = to.groups.empty() ? 0 : to.groups.front().first, end = first;
        for (const group &g : to.groups)
            end = g.first + g.count;
        if (std::all_of(offset + first * 3, offset + end * 3, [](float x) { return x == 0.0f; }))
            continue;
        std::vector<float> own(end * 3), own_turn(end * 3);
        for (const group &g : to.groups)
            for (size_t v = 0; v < g.count; ++v) {
                size_t at = (g.first + v) * 3;
                const gltf_transform &back = g.back[v];
                float mm[3];
                for (size_t i = 0; i < 3; ++i)
                    mm[i] = offset[at + i] * 1000.0f;
                apply(&own[at], back, mm);
                apply(&own_turn[at], back, rotation + at);
                double stretch = 0.0; /* scale of the transform, which must not scale normals */
                for (int row = 0; row < 3; ++row)
                    stretch += back.linear[row][0] * back.linear[row][0];
                for (size_t i = 0; i < 3 && stretch > 0.0; ++i)
                    own_turn[at + i] = static_cast<float>(static_cast<double>(own_turn[at + i]) /
                                                          std::sqrt(stretch));
            }
        add_to(to, name, own, own_turn);
    }
    ++target_count_;
}

bool gltf_source::add_own_target(const std::string &name)
{
    bool any = false;
    for (instance &to : instances_) {
        const ordered_json &in_file = document_["meshes"][to.mesh];
        if (!in_file.contains("extras") || !in_file["extras"].is_object() ||
            !in_file["extras"].contains("targetNames"))
            continue;
        const ordered_json &names = in_file["extras"]["targetNames"];
        for (size_t i = 0; i < names.size() && i < to.own_count; ++i)
            if (names[i] == name && !to.played.count(i) && to.own_weights[i] == 0.0) {
                to.played[i] = target_count_;
                any = true;
                break;
            }
    }
    target_count_ += any;
    return any;
}

/* Adds the bones as nodes below a separate root. The skeleton of the file is not animated, because
 * the targets already move the face. */
void gltf_source::add_bones(ordered_json &animation, int time, const std::vector<gltf_bone> &bones)
{
    auto is_empty = [&](const char *list) {
        return !document_.contains(list) || document_[list].empty();
    };
    if (bones.empty() || is_empty("nodes") || is_empty("scenes"))
        return;
    ordered_json &nodes = document_["nodes"];
    size_t root = nodes.size(), first = root + 1;
    ordered_json matrix = ordered_json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            matrix.push_back(row < 3 && column < 3 ? 1000.0 * file_of_face_.linear[row][column]
                             : row == column       ? 1.0
                                                   : 0.0);
    nodes.push_back({{"name", "marotte bones"}, {"matrix", matrix}});
    for (size_t i = 0; i < bones.size(); ++i) {
        nodes.push_back({{"name", "bone " + gltf_utf8(bones[i].name.c_str())},
                         {"translation", bones[i].rest_m}});
        nodes[bones[i].parent == SIZE_MAX ? root : first + bones[i].parent]["children"].push_back(
            first + i);
        auto add = [&](const char *path, const std::vector<float> &value, size_t width) {
            int output = gltf_output_floats(out_, value.data(), value.size() / width, width, 0);
            gltf_output_channel(animation, first + i, path, time, output);
        };
        add("rotation", bones[i].rotation, 4);
        add("translation", bones[i].translation, 3);
    }
    size_t scene = document_.value("scene", size_t{0});
    document_["scenes"][scene]["nodes"].push_back(root);
}

void gltf_source::animate(const std::string &name, const std::vector<float> &time_s,
                          const std::vector<float> &weight, const ordered_json &extras,
                          const std::vector<gltf_bone> &bones)
{
    ordered_json animation = gltf_output_animation(name);
    int time = gltf_output_floats(out_, time_s.data(), time_s.size(), 1, 0);
    for (instance &of : instances_) {
        if ((of.targets.empty() && of.played.empty()) || !of.has_node)
            continue;
        std::vector<float> own;
        for (size_t frame = 0; frame < time_s.size(); ++frame) {
            for (size_t i = 0; i < of.own_count; ++i) {
                auto played = of.played.find(i);
                own.push_back(played == of.played.end()
                                  ? of.own_weights[i].get<float>()
                                  : weight[frame * target_count_ + played->second]);
            }
            for (size_t target : of.targets)
                own.push_back(weight[frame * target_count_ + target]);
        }
        int output = gltf_output_floats(out_, own.data(), own.size(), 1, 0);
        gltf_output_channel(animation, of.node, "weights", time, output);
    }
    add_bones(animation, time, bones);
    animation["extras"] = extras;
    ordered_json all = ordered_json::array({std::move(animation)});
    if (document_.contains("animations"))
        for (ordered_json &other : document_["animations"])
            all.push_back(std::move(other));
    if (!all[0]["channels"].empty())
        document_["animations"] = std::move(all);
}

/* Writes the rest weights of all targets of each mesh, and of nodes that have their own weights. */
void gltf_source::finish_meshes()
{
    for (const instance &of : instances_) {
        if (of.targets.empty())
            continue;
        size_t count = of.own_count + of.targets.size();
        auto extend = [count](ordered_json &weights) {
            while (weights.size() < count)
                weights.push_back(0.0);
        };
        extend(document_["meshes"][of.mesh]["weights"]);
        if (of.has_node && document_["nodes"][of.node].contains("weights"))
            extend(document_["nodes"][of.node]["weights"]);
    }
}

void gltf_source::write_new_accessors()
{
    for (size_t i = first_view_; i < out_.model.bufferViews.size(); ++i)
        document_["bufferViews"].push_back(json_of(out_.model.bufferViews[i]));
    for (size_t i = first_accessor_; i < out_.model.accessors.size(); ++i)
        document_["accessors"].push_back(json_of(out_.model.accessors[i]));
    document_["buffers"][0] = {{"byteLength", out_.binary_size}};
}

uint64_t gltf_source::write(const char *path)
{
    finish_meshes();
    write_new_accessors();
    return gltf_output_write(out_, document_.dump(), path);
}

/* Converts glTF to a mesh: plans the scene and reads the accessors. Exceptions do not leave this
 * file. */
#include "io/read/gltf_material.hpp"
#include "io/read/gltf_plan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
#include "io/read/mesh_build.h"
#include "io/mesh_file.h"
}

namespace
{

/* Returns zeroed memory, which mesh_destroy frees. */
template <class T> T *zeroed(size_t count)
{
    void *memory = calloc(count ? count : 1, sizeof(T));
    if (!memory)
        throw std::bad_alloc();
    return static_cast<T *>(memory);
}

/* Returns the name of a primitive in the file, else that of its node. */
std::string part_name(const tinygltf::Primitive &primitive, const gltf_instance &instance)
{
    const tinygltf::Value &extras = primitive.extras;
    if (!extras.IsObject() || !extras.Has("name") || !extras.Get("name").IsString())
        return instance.name;
    const std::string &name = extras.Get("name").Get<std::string>();
    return name.empty() ? instance.name : name;
}

void make_parts(mesh &out, const tinygltf::Model &model, const gltf_plan &plan)
{
    free(out.part[0].name);
    free(out.part);
    out.part = nullptr;
    out.part_count = 0;
    out.part = zeroed<mesh_part>(plan.part_count);
    uint32_t first = 0;
    for (const gltf_instance &instance : plan.scene.instances)
        for (const gltf_primitive_plan &surface : plan.meshes.at(instance.mesh).surfaces) {
            mesh_part &part = out.part[out.part_count];
            int material = surface.source->material;
            part.name = gltf_clean_name(part_name(*surface.source, instance));
            part.material = (uint32_t)(material < 0 ? (int)model.materials.size() : material);
            part.first_triangle = first;
            part.triangle_count = (uint32_t)surface.triangle_count;
            first += part.triangle_count;
            out.part_count += 1;
        }
}

void make_targets(mesh &out, const gltf_plan &plan)
{
    out.target = zeroed<mesh_target>(plan.targets.size());
    for (const std::string &name : plan.targets) {
        mesh_target &target = out.target[out.target_count++];
        target.name = gltf_clean_name(name);
        target.offset = zeroed<float>(plan.vertex_count * 3);
    }
}

/* ---- expressions of VRM: blendShapeMaster of VRM 0 and VRMC_vrm.expressions of VRM 1, with the
 * names of VRM 1. Their effects on materials are ignored ---- */

/* Morph targets and their weights for each expression name of the standard. */
struct gltf_expressions {
    std::map<std::pair<std::string, size_t>, float>
        weight;        /* by expression name and target of the plan */
    size_t lost_count; /* number of named shapes that do not exist */
};

const size_t ROWS_MAX = 4096;

/* Presets of VRM 0 and their names in VRM 1. */
const char *const preset[][2] = {{"a", "aa"},
                                 {"i", "ih"},
                                 {"u", "ou"},
                                 {"e", "ee"},
                                 {"o", "oh"},
                                 {"joy", "happy"},
                                 {"sorrow", "sad"},
                                 {"fun", "relaxed"},
                                 {"angry", "angry"},
                                 {"surprised", "surprised"},
                                 {"blink", "blink"},
                                 {"blink_l", "blinkLeft"},
                                 {"blink_r", "blinkRight"},
                                 {"lookup", "lookUp"},
                                 {"lookdown", "lookDown"},
                                 {"lookleft", "lookLeft"},
                                 {"lookright", "lookRight"},
                                 {"neutral", "neutral"}};

std::string lower(std::string text)
{
    for (char &c : text)
        c = c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
    return text;
}

std::string text_of(const tinygltf::Value &value)
{
    return value.IsString() ? value.Get<std::string>() : "";
}

/* Returns the name in VRM 1. An expression without a preset may itself have the name of one. */
std::string word_of(const std::string &preset_name, const std::string &name)
{
    for (const std::string &given : {lower(preset_name), lower(name)})
        for (const auto &known : preset)
            if (given == known[0] || given == lower(known[1]))
                return known[1];
    return name;
}

class collector
{
  public:
    explicit collector(const gltf_plan &plan) : plan_(plan)
    {
    }

    /* `weight`: 0..1 */
    void add(const std::string &word, int64_t mesh, int64_t index, double weight)
    {
        auto shown = plan_.meshes.find(mesh < 0 ? SIZE_MAX : (size_t)mesh);
        if (shown == plan_.meshes.end() || index < 0 ||
            (size_t)index >= shown->second.target_slots.size()) {
            out_.lost_count += 1;
            return;
        }
        if (word.empty() || !(weight > 0.0) || out_.weight.size() == ROWS_MAX)
            return;
        float &part = out_.weight[{word, shown->second.target_slots[(size_t)index]}];
        part = std::max(part, (float)std::min(weight, 1.0));
    }

    const gltf_expressions &all() const
    {
        return out_;
    }

  private:
    const gltf_plan &plan_;
    gltf_expressions out_ = {{}, 0};
};

double number_of(const tinygltf::Value &value)
{
    return value.IsNumber() ? value.GetNumberAsDouble() : 0.0;
}

/* A list of {name, presetName, binds: [{mesh, index, weight: 0..100}]}. */
void read_old(collector &to, const tinygltf::Value &vrm)
{
    const tinygltf::Value &groups =
        gltf_member(gltf_member(vrm, "blendShapeMaster"), "blendShapeGroups");
    for (size_t i = 0; groups.IsArray() && i < groups.ArrayLen(); ++i) {
        const tinygltf::Value &group = groups.Get((int)i), &binds = gltf_member(group, "binds");
        std::string word =
            word_of(text_of(gltf_member(group, "presetName")), text_of(gltf_member(group, "name")));
        for (size_t b = 0; binds.IsArray() && b < binds.ArrayLen(); ++b) {
            const tinygltf::Value &bind = binds.Get((int)b);
            to.add(word, gltf_whole(gltf_member(bind, "mesh"), -1),
                   gltf_whole(gltf_member(bind, "index"), -1),
                   number_of(gltf_member(bind, "weight")) / 100.0);
        }
    }
}

/* {preset: {NAME: {morphTargetBinds: [{node, index, weight: 0..1}]}}, custom: likewise}. */
void read_now(collector &to, const tinygltf::Value &vrm, const tinygltf::Model &model)
{
    const tinygltf::Value &expressions = gltf_member(vrm, "expressions");
    for (const char *kind : {"preset", "custom"}) {
        const tinygltf::Value &named = gltf_member(expressions, kind);
        if (!named.IsObject())
            continue;
        for (const std::string &name : named.Keys()) {
            const tinygltf::Value &binds = gltf_member(named.Get(name), "morphTargetBinds");
            for (size_t b = 0; binds.IsArray() && b < binds.ArrayLen(); ++b) {
                const tinygltf::Value &bind = binds.Get((int)b);
                int64_t node = gltf_whole(gltf_member(bind, "node"), -1);
                bool is_node = node >= 0 && (size_t)node < model.nodes.size();
                to.add(word_of("", name), is_node ? model.nodes[(size_t)node].mesh : -1,
                       gltf_whole(gltf_member(bind, "index"), -1),
                       number_of(gltf_member(bind, "weight")));
            }
        }
    }
}

gltf_expressions gltf_expressions_of(const tinygltf::Model &model, const gltf_plan &plan)
{
    collector out(plan);
    auto old = model.extensions.find("VRM"), now = model.extensions.find("VRMC_vrm");
    if (now != model.extensions.end())
        read_now(out, now->second, model);
    else if (old != model.extensions.end())
        read_old(out, old->second);
    return out.all();
}

void make_expressions(mesh &out, const gltf_expressions &from)
{
    out.expression = zeroed<mesh_expression>(from.weight.size());
    for (const auto &row : from.weight) {
        mesh_expression &to = out.expression[out.expression_count++];
        to.name = gltf_clean_name(row.first.first);
        to.target = (uint32_t)row.first.second;
        to.weight = row.second;
    }
    if (from.lost_count)
        mesh_note(&out, "%zu shapes that its expressions name do not exist", from.lost_count);
}

/* ---- the mesh ---- */

void make_attributes(mesh &out, const gltf_plan &plan)
{
    out.attribute = zeroed<mesh_attribute>(plan.attributes.size());
    for (const gltf_attribute_plan &source : plan.attributes) {
        mesh_attribute &attribute = out.attribute[out.attribute_count++];
        attribute.name = gltf_clean_name(source.name);
        attribute.component_count = (uint32_t)source.component_count;
        attribute.value = zeroed<float>(plan.vertex_count * source.component_count);
    }
}

void make_joints(mesh &out, const tinygltf::Model &model, const gltf_plan &plan)
{
    const gltf_skeleton &skeleton = plan.skeleton;
    out.forward = skeleton.forward;
    if (skeleton.joints.empty())
        return;
    out.joint = zeroed<mesh_joint>(skeleton.joints.size());
    for (const gltf_joint &from : skeleton.joints) {
        mesh_joint &joint = out.joint[out.joint_count++];
        joint.name = gltf_clean_name(model.nodes[from.node].name);
        joint.role = gltf_clean_name(from.role);
        joint.parent = from.parent;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column)
                joint.rest[row * 4 + column] = (float)from.world.linear[row][column];
            joint.rest[row * 4 + 3] = (float)from.world.shift[row];
        }
    }
    out.skin_joint = zeroed<uint32_t>(plan.vertex_count * MESH_SKIN_WIDTH);
    out.skin_weight = zeroed<float>(plan.vertex_count * MESH_SKIN_WIDTH);
}

class geometry_reader
{
  public:
    geometry_reader(mesh &out, const tinygltf::Model &model, const gltf_plan &plan)
        : out_(out), model_(model), plan_(plan)
    {
    }

    void read()
    {
        size_t vertex = 0;
        uint32_t *triangle = out_.triangle;
        for (const gltf_instance &instance : plan_.scene.instances) {
            const gltf_mesh_plan &mesh = plan_.meshes.at(instance.mesh);
            gltf_skin skin(model_, plan_.skeleton, instance);
            for (const gltf_group_plan &group : mesh.groups)
                read_group(mesh, group, skin, vertex + group.first_vertex);
            unweighted_count_ += skin.unweighted_count();
            bool mirrors = skin.mirrors();
            for (const gltf_primitive_plan &surface : mesh.surfaces) {
                const gltf_group_plan &group = mesh.groups[surface.group];
                read_triangles(triangle, surface, group, (uint32_t)(vertex + group.first_vertex),
                               mirrors);
                triangle += surface.triangle_count * 3;
            }
            vertex += mesh.vertex_count;
        }
    }

    size_t misfit_count() const
    {
        return misfit_count_;
    }
    size_t unweighted_count() const
    {
        return unweighted_count_;
    }
    size_t white_count() const
    {
        return white_count_;
    }

  private:
    void read_group(const gltf_mesh_plan &mesh, const gltf_group_plan &group, gltf_skin &skin,
                    size_t first)
    {
        const tinygltf::Primitive &source = *group.source;
        if (out_.skin_joint)
            skin.read(source, group.vertex_count, out_.skin_joint + first * MESH_SKIN_WIDTH,
                      out_.skin_weight + first * MESH_SKIN_WIDTH);
        float *position = out_.position + first * 3;
        gltf_accessor(model_, source.attributes.at("POSITION")).read_floats(position);
        skin.transform_points(position, group.vertex_count);
        if (plan_.has_normals) {
            float *normal = out_.normal + first * 3;
            gltf_accessor(model_, source.attributes.at("NORMAL")).read_floats(normal);
            skin.transform_normals(normal, group.vertex_count);
        }
        read_looks(source, group.vertex_count, first);
        for (const auto &attribute : source.attributes)
            if (gltf_is_custom(attribute.first))
                read_attribute(attribute.first, attribute.second, first);
        for (size_t i = 0; i < source.targets.size(); ++i) {
            auto offsets = source.targets[i].find("POSITION");
            if (offsets == source.targets[i].end())
                continue;
            float *offset = out_.target[mesh.target_slots[i]].offset + first * 3;
            gltf_accessor(model_, offsets->second).read_floats(offset);
            skin.transform_vectors(offset, group.vertex_count);
        }
    }

    void read_looks(const tinygltf::Primitive &source, size_t count, size_t first)
    {
        int uv = gltf_uv_accessor(model_, source), colour = gltf_colour_accessor(source);
        if (uv >= 0)
            gltf_accessor(model_, uv).read_floats(out_.uv + first * 2);
        if (!out_.colour)
            return;
        float *to = out_.colour + first * 4;
        std::vector<float> value(count * 4, 1.0f);
        size_t width = 4;
        if (colour >= 0) {
            gltf_accessor accessor(model_, colour);
            width = accessor.component_count();
            std::fill(value.begin(), value.end(), 0.0f);
            accessor.read_any_floats(value.data());
        }
        for (size_t v = 0; v < count; ++v) {
            const float *row = &value[v * width];
            bool is_colour =
                std::all_of(row, row + width, [](float c) { return std::isfinite(c); });
            white_count_ += !is_colour;
            for (size_t c = 0; c < 4; ++c) {
                float number = c < width && is_colour ? row[c] : 1.0f;
                to[v * 4 + c] = number > 0.0f ? (number < 1.0f ? number : 1.0f) : 0.0f;
            }
        }
    }

    void read_attribute(const std::string &name, int index, size_t first)
    {
        gltf_accessor accessor(model_, index);
        int slot = gltf_plan_attribute(plan_, name, accessor.component_count());
        if (slot < 0) {
            misfit_count_ += 1;
            return;
        }
        accessor.read_floats(out_.attribute[slot].value + first * accessor.component_count());
    }

    void read_triangles(uint32_t *out, const gltf_primitive_plan &surface,
                        const gltf_group_plan &group, uint32_t first, bool mirrors) const
    {
        std::vector<uint32_t> index;
        if (surface.source->indices >= 0)
            index = gltf_accessor(model_, surface.source->indices).read_indices(group.vertex_count);
        else
            for (size_t i = 0; i < group.vertex_count; ++i)
                index.push_back((uint32_t)i);
        for (size_t t = 0; t < surface.triangle_count; ++t, out += 3) {
            size_t corner[3] = {t * 3, t * 3 + 1, t * 3 + 2};
            if (surface.source->mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
                corner[0] = t;
                corner[1] = t + 1 + t % 2; /* every second triangle of a strip is reversed */
                corner[2] = t + 2 - t % 2;
            } else if (surface.source->mode == TINYGLTF_MODE_TRIANGLE_FAN) {
                corner[0] = t + 1;
                corner[1] = t + 2;
                corner[2] = 0;
            }
            if (mirrors)
                std::swap(corner[1], corner[2]);
            for (size_t i = 0; i < 3; ++i)
                out[i] = first + index[corner[i]];
        }
    }

    mesh &out_;
    const tinygltf::Model &model_;
    const gltf_plan &plan_;
    size_t misfit_count_ = 0, unweighted_count_ = 0;
    size_t white_count_ = 0; /* vertices whose colour is not a number */
};

bool has_default_weights(const tinygltf::Model &model, const gltf_plan &plan)
{
    for (const auto &mesh : plan.meshes)
        for (double weight : model.meshes[mesh.first].weights)
            if (weight != 0.0)
                return true;
    return false;
}

void add_notes(mesh &out, const tinygltf::Model &model, const gltf_plan &plan,
               const geometry_reader &r)
{
    if (!plan.scene.has_nodes)
        mesh_note(&out, "the file has no nodes: its meshes are read without transforms");
    if (model.scenes.size() > 1)
        mesh_note(&out, "one of %zu scenes was read", model.scenes.size());
    if (plan.scene.repeated_count)
        mesh_note(&out,
                  "the scene lists %zu nodes twice, or also nodes above them: each is read once",
                  plan.scene.repeated_count);
    if (plan.scene.orphan_count)
        mesh_note(&out,
                  "%zu nodes of the scene have a parent outside it: its transform is not applied",
                  plan.scene.orphan_count);
    if (plan.scene.instanced_count)
        mesh_note(&out,
                  "%zu nodes repeat their mesh (EXT_mesh_gpu_instancing): each is read once, its "
                  "instances are not drawn",
                  plan.scene.instanced_count);
    if (plan.skeleton.ignored_skin_count)
        mesh_note(&out, "%zu skins were not applied: the scene does not show their joints",
                  plan.skeleton.ignored_skin_count);
    if (r.unweighted_count())
        mesh_note(&out, "%zu vertices of a skin follow none of its joints", r.unweighted_count());
    if (plan.skipped_count)
        mesh_note(&out, "%zu primitives of points or lines were skipped", plan.skipped_count);
    if (has_default_weights(model, plan))
        mesh_note(&out, "the default weights of the morph targets were not applied");
    if (r.misfit_count())
        mesh_note(&out, "%zu custom attributes were skipped: another primitive has another type",
                  r.misfit_count());
    mesh_build_note_colours(&out, r.white_count());
    mesh_build_note_degenerate(&out);
}

void parse(mesh &out, const void *data, size_t size, const char *directory)
{
    gltf_container container;
    error failed = {""};
    mrt_result result = gltf_container_parse(&container, data, size, &failed);
    if (result < 0)
        throw gltf_failure(result, failed.text);
    gltf_document document = gltf_load(container, directory);
    gltf_decode(document.model, size);
    const tinygltf::Model &model = document.model;
    const gltf_plan plan = gltf_plan_of(model, size);
    result = mesh_create(&out, (uint32_t)plan.vertex_count, (uint32_t)plan.triangle_count, &failed);
    if (result < 0)
        throw gltf_failure(result, failed.text);
    gltf_materials(out, document, plan.is_material_used,
                   plan.needs_default_material || model.materials.empty(), directory, size);
    make_parts(out, model, plan);
    make_targets(out, plan);
    make_expressions(out, gltf_expressions_of(model, plan));
    make_attributes(out, plan);
    make_joints(out, model, plan);
    out.uv = plan.has_uv ? zeroed<float>(plan.vertex_count * 2) : nullptr;
    out.colour = plan.has_colours ? zeroed<float>(plan.vertex_count * 4) : nullptr;
    if (plan.has_normals)
        out.normal = zeroed<float>(plan.vertex_count * 3);
    geometry_reader r(out, model, plan);
    r.read();
    mesh_build_unit_normals(&out);
    mesh_build_part_ranges(&out);
    add_notes(out, model, plan, r);
    result = mesh_validate(&out, &failed);
    if (result < 0)
        throw gltf_failure(result, failed.text);
}

} // namespace

mrt_result gltf_parse(mesh *out, const void *data, size_t size, const char *directory, error *err)
{
    *out = mesh{};
    mrt_result result;
    try {
        parse(*out, data, size, directory);
        return MRT_OK;
    } catch (const gltf_failure &caught) {
        result = error_set(err, caught.code, "%s", caught.what());
    } catch (const std::bad_alloc &) {
        result = error_set(err, MRT_ERR_MEMORY, "no memory for the glTF document");
    } catch (...) {
        result = error_set(err, MRT_ERR_FORMAT, "the glTF document is invalid");
    }
    mesh_destroy(out);
    return result;
}

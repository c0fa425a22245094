#include "io/read/gltf_plan.hpp"

#include "io/read/gltf_material.hpp"

#include <algorithm>
#include <set>

extern "C" {
#include "base/budget.h"
#include "io/read/mesh_build.h"
}

namespace
{

/* The accessors of the vertices of a primitive. Primitives with equal keys have the same vertices.
 */
typedef std::vector<std::pair<std::string, int>> group_key;

group_key key_of(const tinygltf::Model &model, const tinygltf::Primitive &primitive)
{
    group_key key = {{"uv", gltf_uv_accessor(model, primitive)},
                     {"colour", gltf_colour_accessor(primitive)}};
    for (const auto &attribute : primitive.attributes)
        if (attribute.first == "POSITION" || attribute.first == "NORMAL" ||
            attribute.first.rfind("JOINTS_", 0) == 0 || attribute.first.rfind("WEIGHTS_", 0) == 0 ||
            gltf_is_custom(attribute.first))
            key.push_back(attribute);
    for (const auto &target : primitive.targets) {
        auto position = target.find("POSITION");
        key.push_back({"", position == target.end() ? -1 : position->second});
    }
    return key;
}

class planner
{
  public:
    planner(const tinygltf::Model &model, size_t file_size) : model_(model), plan_()
    {
        size_t size = file_size;
        for (const tinygltf::Buffer &buffer : model.buffers)
            size += buffer.data.size();
        budget_ = budget_of(BUDGET_MESH, size);
        const auto &used = model.extensionsUsed;
        is_quantised_ = std::count(used.begin(), used.end(), "KHR_mesh_quantization") > 0;
    }

    gltf_plan make()
    {
        plan_.scene = gltf_scene_of(model_);
        for (const gltf_instance &instance : plan_.scene.instances)
            pay_for_skin(instance.skin);
        plan_.skeleton = gltf_skeleton_of(model_, plan_.scene);
        plan_.has_normals = true;
        plan_.is_material_used.assign(model_.materials.size(), false);
        for (const gltf_instance &instance : plan_.scene.instances) {
            if (plan_.meshes.count(instance.mesh) == 0)
                add_mesh(instance.mesh);
            add_instance(plan_.meshes[instance.mesh]);
        }
        if (plan_.triangle_count == 0)
            gltf_fail(MRT_ERR_FORMAT, "the scene shows no triangles: a surface is needed");
        return std::move(plan_);
    }

  private:
    void check_shape(int index, const char *what, size_t vertex_count) const
    {
        gltf_accessor accessor(model_, index);
        if (accessor.component_count() != 3)
            gltf_fail(MRT_ERR_FORMAT, "accessor %d: %s must be VEC3", index, what);
        if (accessor.component_type() != TINYGLTF_COMPONENT_TYPE_FLOAT && !is_quantised_)
            gltf_fail(MRT_ERR_FORMAT, "accessor %d: %s must be FLOAT", index, what);
        if (accessor.count() != vertex_count)
            gltf_fail(MRT_ERR_FORMAT, "accessor %d: %zu of %s for %zu vertices", index,
                      accessor.count(), what, vertex_count);
    }

    bool has_looks(int index, size_t least, size_t most, const char *what, size_t vertex_count)
    {
        if (index < 0)
            return false;
        gltf_accessor accessor(model_, index);
        if (accessor.component_count() < least || accessor.component_count() > most ||
            accessor.count() != vertex_count)
            gltf_fail(MRT_ERR_FORMAT, "accessor %d: %zu of %s for %zu vertices, or of another type",
                      index, accessor.count(), what, vertex_count);
        return true;
    }

    void add_attribute(const std::string &name, int index, size_t vertex_count)
    {
        gltf_accessor accessor(model_, index);
        if (accessor.count() != vertex_count)
            gltf_fail(MRT_ERR_FORMAT, "accessor %d: %zu of %s for %zu vertices", index,
                      accessor.count(), name.substr(0, 64).c_str(), vertex_count);
        for (const gltf_attribute_plan &known : plan_.attributes)
            if (known.name == name)
                return;
        if (plan_.attributes.size() == ATTRIBUTES_MAX)
            gltf_fail(MRT_ERR_UNSUPPORTED, "more than %zu custom attributes", ATTRIBUTES_MAX);
        plan_.attributes.push_back({name, accessor.component_count()});
    }

    gltf_group_plan group_of(const tinygltf::Primitive &primitive)
    {
        auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end())
            gltf_fail(MRT_ERR_FORMAT, "a primitive has no POSITION");
        size_t count = gltf_accessor(model_, position->second).count();
        check_shape(position->second, "POSITION", count);
        for (const auto &attribute : primitive.attributes)
            if (gltf_is_custom(attribute.first))
                add_attribute(attribute.first, attribute.second, count);
        auto normal = primitive.attributes.find("NORMAL");
        if (normal != primitive.attributes.end())
            check_shape(normal->second, "NORMAL", count);
        else
            plan_.has_normals = false;
        plan_.has_uv |= has_looks(gltf_uv_accessor(model_, primitive), 2, 2, "TEXCOORD", count);
        plan_.has_colours |= has_looks(gltf_colour_accessor(primitive), 3, 4, "COLOR_0", count);
        for (const auto &target : primitive.targets) {
            auto offset = target.find("POSITION");
            if (offset != target.end())
                check_shape(offset->second, "a target's POSITION", count);
        }
        return {&primitive, 0, count};
    }

    size_t triangles_of(const tinygltf::Primitive &primitive, size_t vertex_count) const
    {
        size_t count =
            primitive.indices < 0 ? vertex_count : gltf_accessor(model_, primitive.indices).count();
        if (primitive.mode == TINYGLTF_MODE_TRIANGLES && count % 3 != 0)
            gltf_fail(MRT_ERR_FORMAT, "a primitive has %zu indices: triangles need 3 each", count);
        if (count < 3)
            gltf_fail(MRT_ERR_FORMAT, "a primitive has %zu indices, at least 3 are needed", count);
        return primitive.mode == TINYGLTF_MODE_TRIANGLES ? count / 3 : count - 2;
    }

    void add_surface(gltf_mesh_plan &mesh, std::map<group_key, size_t> &groups,
                     const tinygltf::Primitive &primitive)
    {
        group_key key = key_of(model_, primitive);
        auto found = groups.find(key);
        if (found == groups.end()) {
            gltf_group_plan group = group_of(primitive);
            group.first_vertex = mesh.vertex_count;
            mesh.vertex_count += group.vertex_count;
            found = groups.insert({key, mesh.groups.size()}).first;
            mesh.groups.push_back(group);
        }
        size_t vertex_count = mesh.groups[found->second].vertex_count;
        size_t triangle_count = triangles_of(primitive, vertex_count);
        if (primitive.material >= (int)model_.materials.size())
            gltf_fail(MRT_ERR_FORMAT, "a primitive has material %d, but the file has %zu",
                      primitive.material, model_.materials.size());
        plan_.needs_default_material |= primitive.material < 0;
        if (primitive.material >= 0)
            plan_.is_material_used[(size_t)primitive.material] = true;
        mesh.surfaces.push_back({&primitive, found->second, triangle_count});
        mesh.triangle_count += triangle_count;
    }

    void add_mesh(size_t index)
    {
        const tinygltf::Mesh &mesh = model_.meshes[index];
        gltf_mesh_plan &out = plan_.meshes[index];
        std::map<group_key, size_t> groups;
        for (const tinygltf::Primitive &primitive : mesh.primitives) {
            if (primitive.mode < 0 || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
                gltf_fail(MRT_ERR_FORMAT, "mesh %zu: primitive mode %d is invalid", index,
                          primitive.mode);
            if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
                plan_.skipped_count += 1;
                continue;
            }
            add_surface(out, groups, primitive);
            if (primitive.targets.size() != out.surfaces[0].source->targets.size())
                gltf_fail(MRT_ERR_FORMAT, "mesh %zu: its primitives differ in their targets",
                          index);
        }
        if (!out.surfaces.empty())
            add_targets(out, index, out.surfaces[0].source->targets.size());
    }

    /* Merges targets with the same name in all meshes into one target, so that a smile moves the
     * teeth as well. */
    void add_targets(gltf_mesh_plan &out, size_t index, size_t target_count)
    {
        const tinygltf::Mesh &mesh = model_.meshes[index];
        const tinygltf::Value &extras = mesh.extras;
        bool has_names =
            extras.IsObject() && extras.Has("targetNames") && extras.Get("targetNames").IsArray();
        std::map<std::string, size_t> used; /* number of targets with this name in the mesh */
        for (size_t i = 0; i < target_count; ++i) {
            std::string name;
            if (has_names && i < extras.Get("targetNames").ArrayLen() &&
                extras.Get("targetNames").Get((int)i).IsString())
                name = extras.Get("targetNames").Get((int)i).Get<std::string>();
            std::string owner = name.empty() ? std::to_string(index) : "";
            if (name.empty())
                name = (mesh.name.empty() ? "target" : mesh.name) + "." + std::to_string(i);
            slot_key key = {name, owner, used[name]++};
            auto found = slots_.find(key);
            if (found == slots_.end()) {
                found = slots_.insert({key, plan_.targets.size()}).first;
                plan_.targets.push_back(name);
            }
            out.target_slots.push_back(found->second);
        }
    }

    void add_instance(const gltf_mesh_plan &mesh)
    {
        plan_.vertex_count += mesh.vertex_count;
        plan_.triangle_count += mesh.triangle_count;
        plan_.part_count += mesh.surfaces.size();
        if (plan_.part_count > MESH_BUILD_NAMES_MAX)
            gltf_fail(MRT_ERR_UNSUPPORTED, "the scene shows more than %d primitives",
                      MESH_BUILD_NAMES_MAX);
        size_t per_vertex = 6 + 3 * plan_.targets.size();
        if (!plan_.skeleton.joints.empty())
            per_vertex += 2 * MESH_SKIN_WIDTH;
        per_vertex += (plan_.has_uv ? 2u : 0u) + (plan_.has_colours ? 4u : 0u);
        for (const gltf_attribute_plan &attribute : plan_.attributes)
            per_vertex += attribute.component_count;
        check_budget(plan_.vertex_count * per_vertex + plan_.triangle_count * 3);
    }

    /* Checks the memory for the mesh. Sparse accessors and instances can make it much larger than
     * the file. */
    void check_budget(size_t number_count) const
    {
        budget all = budget_;
        error failed = {""};
        mrt_result result = budget_spend_bytes(&all, number_count * sizeof(float), &failed);
        if (result < 0)
            gltf_fail(result, "%zu vertices with %zu targets, and %zu triangles: %s",
                      plan_.vertex_count, plan_.targets.size(), plan_.triangle_count, failed.text);
    }

    /* Deducts the work to read the skin of one instance: its number of joints or matrices,
     * whichever is greater. Each instance reads its skin again. */
    void pay_for_skin(int index)
    {
        if (index < 0 || (size_t)index >= model_.skins.size())
            return;
        const tinygltf::Skin &skin = model_.skins[(size_t)index];
        size_t count = skin.joints.size();
        if (skin.inverseBindMatrices >= 0)
            count = std::max(count, gltf_accessor(model_, skin.inverseBindMatrices).count());
        error failed = {""};
        mrt_result result = budget_spend_work(&budget_, count * STEPS_A_JOINT, &failed);
        if (result < 0)
            gltf_fail(result, "%zu instances, with skin %d of %zu joints: %s",
                      plan_.scene.instances.size(), index, count, failed.text);
    }

    struct slot_key {
        std::string name, owner; /* owner: the mesh, if the target has no name */
        size_t occurrence;
        bool operator<(const slot_key &other) const
        {
            return std::tie(name, owner, occurrence) <
                   std::tie(other.name, other.owner, other.occurrence);
        }
    };

    static constexpr size_t ATTRIBUTES_MAX = 64;
    static constexpr size_t STEPS_A_JOINT = 20; /* units of work in base/budget.h */
    const tinygltf::Model &model_;
    gltf_plan plan_;
    budget budget_; /* shared by all instances */
    bool is_quantised_;
    std::map<slot_key, size_t> slots_;
};

} // namespace

gltf_plan gltf_plan_of(const tinygltf::Model &model, size_t file_size)
{
    return planner(model, file_size).make();
}

int gltf_uv_accessor(const tinygltf::Model &model, const tinygltf::Primitive &primitive)
{
    auto found = primitive.attributes.find(
        "TEXCOORD_" + std::to_string(gltf_material_uv_set(model, primitive.material)));
    return found == primitive.attributes.end() ? -1 : found->second;
}

int gltf_colour_accessor(const tinygltf::Primitive &primitive)
{
    auto found = primitive.attributes.find("COLOR_0");
    return found == primitive.attributes.end() ? -1 : found->second;
}

bool gltf_is_custom(const std::string &attribute)
{
    return attribute.size() > 1 && attribute[0] == '_';
}

int gltf_plan_attribute(const gltf_plan &plan, const std::string &name, size_t component_count)
{
    for (size_t i = 0; i < plan.attributes.size(); ++i)
        if (plan.attributes[i].name == name)
            return plan.attributes[i].component_count == component_count ? (int)i : -1;
    return -1;
}

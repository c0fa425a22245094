#include "io/write/gltf_surface.hpp"

extern "C" {
#include "io/write/morph.h"
}

#include <algorithm>
#include <cmath>

namespace
{

/* Returns the given normal as a unit vector. If it is missing, uses that of the area around the
 * vertex, else +z. */
void unit_normal(float *out, const float *wanted, const double *area)
{
    double n[3] = {area[0], area[1], area[2]};
    if (wanted && !gltf_is_zero(wanted))
        for (int axis = 0; axis < 3; ++axis)
            n[axis] = static_cast<double>(wanted[axis]);
    double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    bool good = length > 1e-30 && std::isfinite(length);
    for (int axis = 0; axis < 3; ++axis)
        out[axis] = good ? static_cast<float>(n[axis] / length) : (axis == 2 ? 1.0f : 0.0f);
}

/* Returns a unique name for a custom attribute. It must begin with an underscore. */
std::string attribute_name(const gltf_surface &s, const char *wanted)
{
    std::string name = gltf_utf8(wanted);
    if (name.empty() || name[0] != '_')
        name = "_" + name;
    std::string unique = name;
    for (int i = 2; s.attribute.count(unique); ++i)
        unique = name + "_" + std::to_string(i);
    return unique;
}

void add_attributes(gltf_output &out, gltf_surface &s)
{
    const mesh *m = s.source;
    s.attribute["POSITION"] = gltf_output_floats(out, s.position.data(), m->vertex_count, 3,
                                                 TINYGLTF_TARGET_ARRAY_BUFFER);
    s.attribute["NORMAL"] =
        gltf_output_floats(out, s.normal.data(), m->vertex_count, 3, TINYGLTF_TARGET_ARRAY_BUFFER);
    for (uint32_t i = 0; i < m->attribute_count; ++i) {
        const mesh_attribute &a = m->attribute[i];
        if (a.component_count < 1 || a.component_count > 4)
            gltf_fail(MRT_ERR_ARGUMENT, "attribute \"%s\" has %u components, expected 1 to 4",
                      a.name, a.component_count);
        s.attribute[attribute_name(s, a.name)] = gltf_output_floats(
            out, a.value, m->vertex_count, a.component_count, TINYGLTF_TARGET_ARRAY_BUFFER);
    }
}

double unit_range(float value)
{
    return value >= 0.0f ? (value <= 1.0f ? static_cast<double>(value) : 1.0) : 0.0;
}

void add_materials(gltf_output &out, const mesh *m)
{
    for (uint32_t i = 0; i < m->material_count; ++i) {
        const mesh_material &from = m->material[i];
        tinygltf::Material material;
        material.name = gltf_utf8(from.name);
        material.pbrMetallicRoughness.baseColorFactor = {
            unit_range(from.base_colour[0]), unit_range(from.base_colour[1]),
            unit_range(from.base_colour[2]), unit_range(from.base_colour[3])};
        material.pbrMetallicRoughness.roughnessFactor = unit_range(from.roughness);
        material.pbrMetallicRoughness.metallicFactor = unit_range(from.metallic);
        if (from.base_colour[3] < 1.0f)
            material.alphaMode = "BLEND";
        out.model.materials.push_back(std::move(material));
    }
}

tinygltf::Primitive make_primitive(const gltf_surface &s)
{
    tinygltf::Primitive primitive;
    primitive.attributes = s.attribute;
    primitive.mode = TINYGLTF_MODE_POINTS;
    for (const gltf_target &target : s.target) {
        primitive.targets.push_back({{"POSITION", target.position}});
        if (target.normal >= 0)
            primitive.targets.back()["NORMAL"] = target.normal;
    }
    return primitive;
}

tinygltf::Value named(const char *key, tinygltf::Value &&value)
{
    tinygltf::Value::Object object;
    object[key] = std::move(value);
    return tinygltf::Value(std::move(object));
}

/* Makes one primitive per part, all on the same vertices. A mesh without triangles becomes one
 * primitive of points. */
std::vector<tinygltf::Primitive> make_primitives(gltf_output &out, const gltf_surface &s)
{
    const mesh *m = s.source;
    std::vector<tinygltf::Primitive> primitives;
    if (m->triangle_count == 0)
        return {make_primitive(s)};
    std::vector<uint32_t> index(m->triangle, m->triangle + size_t{m->triangle_count} * 3);
    int view = gltf_output_view(out, gltf_bytes_of(index), TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    for (uint32_t i = 0; i < m->part_count; ++i) {
        const mesh_part &part = m->part[i];
        if (part.triangle_count == 0)
            continue;
        tinygltf::Accessor accessor;
        accessor.bufferView = view;
        accessor.byteOffset = size_t{part.first_triangle} * 3 * sizeof(uint32_t);
        accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        accessor.count = size_t{part.triangle_count} * 3;
        accessor.type = TINYGLTF_TYPE_SCALAR;
        tinygltf::Primitive primitive = make_primitive(s);
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        primitive.material = static_cast<int>(part.material);
        primitive.indices = gltf_output_accessor(out, std::move(accessor));
        std::string name = gltf_utf8(part.name);
        if (!name.empty())
            primitive.extras = named("name", tinygltf::Value(std::move(name)));
        primitives.push_back(std::move(primitive));
    }
    return primitives;
}

std::string scene_name(const mesh *m)
{
    std::string only = m->part_count == 1 ? gltf_utf8(m->part[0].name) : "";
    return only.empty() ? "face" : only;
}

gltf_surface make_surface(const mesh *m)
{
    gltf_surface s;
    s.source = m;
    s.position = gltf_in_metres(m->position, size_t{m->vertex_count} * 3);
    s.area.resize(s.position.size());
    s.work.resize(s.position.size());
    s.normal_offset.resize(s.position.size());
    s.normal.resize(s.position.size());
    morph_area(s.area.data(), s.position.data(), m->vertex_count, m->triangle, m->triangle_count);
    for (size_t i = 0; i < s.position.size(); i += 3)
        unit_normal(&s.normal[i], m->normal ? m->normal + i : nullptr, &s.area[i]);
    return s;
}

/* ---- bones ---- */

const double NO_TURN[4] = {0.0, 0.0, 0.0, 1.0};

/* Computes conjugate(parent) * own, with w >= 0. */
void rotation_from(double out[4], const double *own, const double *parent)
{
    double x = -parent[0], y = -parent[1], z = -parent[2], w = parent[3];
    out[0] = w * own[0] + x * own[3] + y * own[2] - z * own[1];
    out[1] = w * own[1] - x * own[2] + y * own[3] + z * own[0];
    out[2] = w * own[2] + x * own[1] - y * own[0] + z * own[3];
    out[3] = w * own[3] - x * own[0] - y * own[1] - z * own[2];
    if (out[3] < 0.0)
        std::for_each(out, out + 4, [](double &part) { part = -part; });
}

/* Computes the offset from the parent, in the parent's frame. */
void way_from(double out[3], const double *own, const double *parent, const double *rotation)
{
    double way[3] = {own[0] - parent[0], own[1] - parent[1], own[2] - parent[2]};
    double q[3] = {-rotation[0], -rotation[1], -rotation[2]}, cross[3];
    for (int i = 0; i < 3; ++i)
        cross[i] = 2.0 * (q[(i + 1) % 3] * way[(i + 2) % 3] - q[(i + 2) % 3] * way[(i + 1) % 3]);
    for (int i = 0; i < 3; ++i)
        out[i] = way[i] + rotation[3] * cross[i] + q[(i + 1) % 3] * cross[(i + 2) % 3] -
                 q[(i + 2) % 3] * cross[(i + 1) % 3];
}

gltf_bone bone_of(const clip *c, uint32_t index)
{
    const clip_bone *bone = clip_bone_at(c, index);
    const double origin[3] = {0.0, 0.0, 0.0};
    bool has_parent = bone->parent != CLIP_NO_BONE;
    const double *from = has_parent ? clip_bone_at(c, bone->parent)->centre_mm : origin;
    gltf_bone out = {bone->name, has_parent ? bone->parent : SIZE_MAX, {}, {}, {}};
    for (int i = 0; i < 3; ++i)
        out.rest_m[i] = (bone->centre_mm[i] - from[i]) * GLTF_METRES_PER_MM;
    for (uint32_t frame = 0; frame < clip_frame_count(c); ++frame) {
        const double *pose = clip_pose(c, frame);
        double rotation[4] = {0.0, 0.0, 0.0, 1.0}, translation[3];
        std::transform(out.rest_m, out.rest_m + 3, translation,
                       [](double m) { return m / GLTF_METRES_PER_MM; });
        if (pose) {
            const double *own = pose + size_t{index} * 7;
            const double *parent = has_parent ? pose + size_t{bone->parent} * 7 : nullptr;
            rotation_from(rotation, own, parent ? parent : NO_TURN);
            way_from(translation, own + 4, parent ? parent + 4 : origin, parent ? parent : NO_TURN);
        }
        for (double part : rotation)
            out.rotation.push_back(static_cast<float>(part));
        for (double mm : translation)
            out.translation.push_back(static_cast<float>(mm * GLTF_METRES_PER_MM));
    }
    return out;
}

} // namespace

gltf_surface gltf_surface_of(const mesh *m)
{
    error err;
    mrt_result result = mesh_validate(m, &err);
    if (result < 0)
        gltf_fail(result, "%s", err.text);
    return make_surface(m);
}

void gltf_surface_begin(gltf_output &out, gltf_surface &s)
{
    add_materials(out, s.source);
    add_attributes(out, s);
}

std::vector<float> gltf_in_metres(const float *value_mm, size_t count)
{
    std::vector<float> out(count);
    for (size_t i = 0; i < count; ++i)
        out[i] = static_cast<float>(static_cast<double>(value_mm[i]) * GLTF_METRES_PER_MM);
    return out;
}

void gltf_surface_bend_normals(gltf_surface &s, const std::string &name, const float *offset)
{
    const mesh *m = s.source;
    gltf_output_check(offset, s.position.size(), name);
    morph_surface rest = {s.position.data(), s.normal.data(), s.area.data(),
                          m->triangle,       m->vertex_count, m->triangle_count};
    morph_normal_offset(s.normal_offset.data(), s.work.data(), &rest, offset);
}

void gltf_surface_target(gltf_output &out, gltf_surface &s, const std::string &name,
                         const float *offset)
{
    gltf_target target;
    target.name = name;
    target.position = gltf_output_offsets(out, offset, s.source->vertex_count);
    if (s.source->triangle_count > 0)
        target.normal = gltf_output_offsets(out, s.normal_offset.data(), s.source->vertex_count);
    s.target.push_back(target);
}

void gltf_surface_scene(gltf_output &out, const gltf_surface &s)
{
    tinygltf::Mesh face;
    face.name = scene_name(s.source);
    face.primitives = make_primitives(out, s);
    face.weights.assign(s.target.size(), 0.0);
    if (!s.target.empty()) {
        tinygltf::Value::Array names;
        for (const gltf_target &target : s.target)
            names.emplace_back(target.name);
        face.extras = named("targetNames", tinygltf::Value(std::move(names)));
    }
    out.model.meshes.push_back(std::move(face));
    tinygltf::Node node;
    node.name = scene_name(s.source);
    node.mesh = 0;
    out.model.nodes.push_back(std::move(node));
    tinygltf::Scene scene;
    scene.nodes = {0};
    out.model.scenes.push_back(std::move(scene));
    out.model.defaultScene = 0;
    out.model.asset.version = "2.0";
    out.model.asset.generator = "marotte " MAROTTE_VERSION;
}

std::vector<gltf_bone> gltf_bones_of(const clip *c)
{
    std::vector<gltf_bone> out;
    for (uint32_t i = 0; i < clip_bone_count(c); ++i)
        out.push_back(bone_of(c, i));
    return out;
}

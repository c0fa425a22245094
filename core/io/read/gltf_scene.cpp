#include "io/read/gltf_scene.hpp"

#include <algorithm>
#include <cmath>

const gltf_transform GLTF_TRANSFORM_IDENTITY = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};

namespace
{

const gltf_transform &IDENTITY = GLTF_TRANSFORM_IDENTITY;

void multiply(const gltf_transform &t, double x, double y, double z, double out[3])
{
    for (int row = 0; row < 3; ++row)
        out[row] = t.linear[row][0] * x + t.linear[row][1] * y + t.linear[row][2] * z;
}

bool is_finite(const gltf_transform &t)
{
    for (int row = 0; row < 3; ++row)
        if (!std::isfinite(t.linear[row][0]) || !std::isfinite(t.linear[row][1]) ||
            !std::isfinite(t.linear[row][2]) || !std::isfinite(t.shift[row]))
            return false;
    return true;
}

gltf_transform transform_of_matrix(const std::vector<double> &m, int node) /* column-major */
{
    const double tolerance = 1e-6;
    if (std::fabs(m[3]) > tolerance || std::fabs(m[7]) > tolerance ||
        std::fabs(m[11]) > tolerance || std::fabs(m[15] - 1.0) > tolerance)
        gltf_fail(MRT_ERR_FORMAT, "node %d: its matrix is not an affine transform", node);
    gltf_transform out;
    for (size_t row = 0; row < 3; ++row) {
        for (size_t column = 0; column < 3; ++column)
            out.linear[row][column] = m[column * 4 + row];
        out.shift[row] = m[12 + row];
    }
    return out;
}

void set_rotation(gltf_transform &out, const std::vector<double> &xyzw, int node)
{
    double length =
        std::sqrt(xyzw[0] * xyzw[0] + xyzw[1] * xyzw[1] + xyzw[2] * xyzw[2] + xyzw[3] * xyzw[3]);
    if (!(length > 1e-12) || !std::isfinite(length))
        gltf_fail(MRT_ERR_FORMAT, "node %d: its rotation has no direction", node);
    double x = xyzw[0] / length, y = xyzw[1] / length, z = xyzw[2] / length, w = xyzw[3] / length;
    const double rotation[3][3] = {
        {1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
        {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
        {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            out.linear[row][column] = rotation[row][column];
}

gltf_transform transform_of_node(const tinygltf::Node &node, int index)
{
    gltf_transform out = IDENTITY;
    if (!node.matrix.empty())
        return transform_of_matrix(node.matrix, index);
    if (!node.rotation.empty())
        set_rotation(out, node.rotation, index);
    for (size_t row = 0; row < 3; ++row)
        for (size_t column = 0; column < 3 && !node.scale.empty(); ++column)
            out.linear[row][column] *= node.scale[column];
    for (size_t row = 0; row < 3 && !node.translation.empty(); ++row)
        out.shift[row] = node.translation[row];
    return out;
}

void check_node_index(const tinygltf::Model &model, int index, const char *where)
{
    if (index < 0 || (size_t)index >= model.nodes.size())
        gltf_fail(MRT_ERR_FORMAT, "%s names node %d, but the file has %zu", where, index,
                  model.nodes.size());
}

/* Counts the parents of each node. Each has at most one, so all nodes below a root form a tree. */
std::vector<int> count_parents(const tinygltf::Model &model)
{
    std::vector<int> parent_count(model.nodes.size(), 0);
    for (const tinygltf::Node &node : model.nodes)
        for (int child : node.children) {
            check_node_index(model, child, "a node");
            if (++parent_count[(size_t)child] > 1)
                gltf_fail(MRT_ERR_FORMAT, "node %d has two parents", child);
        }
    return parent_count;
}

/* Marks the nodes below a node, except those below a marked one. */
void mark_below(std::vector<bool> &is_below, const tinygltf::Model &model, int node)
{
    std::vector<int> stack = model.nodes[(size_t)node].children;
    while (!stack.empty()) {
        size_t next = (size_t)stack.back();
        stack.pop_back();
        if (is_below[next])
            continue;
        is_below[next] = true;
        const std::vector<int> &children = model.nodes[next].children;
        stack.insert(stack.end(), children.begin(), children.end());
    }
}

/* Returns the nodes that the chosen scene lists. */
const std::vector<int> &listed_nodes(const tinygltf::Model &model)
{
    size_t scene = model.defaultScene < 0 ? 0 : (size_t)model.defaultScene;
    if (scene >= model.scenes.size())
        gltf_fail(MRT_ERR_FORMAT, "scene %zu does not exist: the file has %zu", scene,
                  model.scenes.size());
    return model.scenes[scene].nodes;
}

/* Returns the nodes of the scene, without those that others of them already contain. Some exporters
 * list children too. */
std::vector<int> find_roots(gltf_scene &out, const tinygltf::Model &model)
{
    std::vector<int> parent_count = count_parents(model), roots;
    if (model.scenes.empty()) {
        for (size_t i = 0; i < parent_count.size(); ++i)
            if (parent_count[i] == 0)
                roots.push_back((int)i);
        return roots;
    }
    const std::vector<bool> none(model.nodes.size(), false);
    std::vector<bool> is_below = none, is_walked = none, is_listed = none;
    for (int node : listed_nodes(model)) {
        check_node_index(model, node, "the scene");
        if (!is_below[(size_t)node] && !is_walked[(size_t)node])
            mark_below(is_below, model, node);
        is_walked[(size_t)node] = true;
    }
    for (int node : listed_nodes(model)) {
        if (is_below[(size_t)node] || is_listed[(size_t)node]) {
            out.repeated_count += 1;
            continue;
        }
        is_listed[(size_t)node] = true;
        out.orphan_count += parent_count[(size_t)node] > 0;
        roots.push_back(node);
    }
    return roots;
}

struct pending_node {
    int index, parent_index;
    gltf_transform parent;
};

void push_reversed(std::vector<pending_node> &stack, const std::vector<int> &nodes,
                   int parent_index, const gltf_transform &parent)
{
    for (size_t i = nodes.size(); i-- > 0;)
        stack.push_back({nodes[i], parent_index, parent});
}

const std::string &mesh_name(const tinygltf::Model &model, int mesh)
{
    if ((size_t)mesh >= model.meshes.size())
        gltf_fail(MRT_ERR_FORMAT, "a node names mesh %d, but the file has %zu", mesh,
                  model.meshes.size());
    return model.meshes[(size_t)mesh].name;
}

void add_nodes(gltf_scene &out, const tinygltf::Model &model)
{
    std::vector<pending_node> stack;
    push_reversed(stack, find_roots(out, model), -1, IDENTITY);
    while (!stack.empty()) {
        pending_node next = stack.back();
        stack.pop_back();
        const tinygltf::Node &node = model.nodes[(size_t)next.index];
        gltf_transform world =
            gltf_transform_compose(next.parent, transform_of_node(node, next.index));
        if (!is_finite(world))
            gltf_fail(MRT_ERR_FORMAT, "node %d: its transform is too large", next.index);
        out.nodes.push_back({(size_t)next.index, next.parent_index, world});
        if (node.mesh >= 0) {
            const std::string &of_mesh = mesh_name(model, node.mesh);
            out.instances.push_back({(size_t)node.mesh, node.name.empty() ? of_mesh : node.name,
                                     world, (size_t)next.index, true, node.skin});
            out.instanced_count += node.extensions.count("EXT_mesh_gpu_instancing");
        }
        push_reversed(stack, node.children, next.index, world);
    }
}

/* A listed node that is not below a root is in a loop, or below one. */
void check_loops(const gltf_scene &of, const tinygltf::Model &model)
{
    std::vector<bool> is_placed(model.nodes.size(), false);
    for (const gltf_world_node &node : of.nodes)
        is_placed[node.node] = true;
    for (int node : listed_nodes(model))
        if (!is_placed[(size_t)node])
            gltf_fail(MRT_ERR_FORMAT, "node %d is below itself", node);
}

double determinant(const gltf_transform &t)
{
    const double(&m)[3][3] = t.linear;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

/* ---- skeleton and skins ---- */

const size_t INFLUENCE_SETS_MAX = 4; /* JOINTS_0 to JOINTS_3 */

void set_role(std::vector<std::string> &role, const tinygltf::Value &node, const std::string &name)
{
    int64_t index = gltf_whole(node, -1);
    if (index >= 0 && (size_t)index < role.size() && role[(size_t)index].empty())
        role[(size_t)index] = name;
}

/* The first joints of the chains that VRM swings: "boneGroups" of VRM 0, "springs" of VRM 1. */
void name_springs(std::vector<std::string> &role, const tinygltf::Model &model)
{
    auto old = model.extensions.find("VRM"), now = model.extensions.find("VRMC_springBone");
    if (now != model.extensions.end()) {
        const tinygltf::Value &springs = gltf_member(now->second, "springs");
        for (size_t i = 0; springs.IsArray() && i < springs.ArrayLen(); ++i) {
            const tinygltf::Value &joints = gltf_member(springs.Get((int)i), "joints");
            if (joints.IsArray() && joints.ArrayLen() > 0)
                set_role(role, gltf_member(joints.Get(0), "node"), "spring");
        }
    } else if (old != model.extensions.end()) {
        const tinygltf::Value &groups =
            gltf_member(gltf_member(old->second, "secondaryAnimation"), "boneGroups");
        for (size_t i = 0; groups.IsArray() && i < groups.ArrayLen(); ++i) {
            const tinygltf::Value &bones = gltf_member(groups.Get((int)i), "bones");
            for (size_t k = 0; bones.IsArray() && k < bones.ArrayLen(); ++k)
                set_role(role, bones.Get((int)k), "spring");
        }
    }
}

/* VRM 0: a list of {bone, node}; VRM 1: {bone: {node}}. */
std::vector<std::string> humanoid_roles(const tinygltf::Model &model)
{
    std::vector<std::string> role(model.nodes.size());
    auto old = model.extensions.find("VRM"), now = model.extensions.find("VRMC_vrm");
    if (now != model.extensions.end()) {
        const tinygltf::Value &bones =
            gltf_member(gltf_member(now->second, "humanoid"), "humanBones");
        if (bones.IsObject())
            for (const std::string &name : bones.Keys())
                set_role(role, gltf_member(bones.Get(name), "node"), name);
    } else if (old != model.extensions.end()) {
        const tinygltf::Value &bones =
            gltf_member(gltf_member(old->second, "humanoid"), "humanBones");
        for (size_t i = 0; bones.IsArray() && i < bones.ArrayLen(); ++i) {
            const tinygltf::Value &bone = bones.Get((int)i), &name = gltf_member(bone, "bone");
            if (name.IsString())
                set_role(role, gltf_member(bone, "node"), name.Get<std::string>());
        }
    }
    name_springs(role, model);
    return role;
}

const tinygltf::Skin &skin_at(const tinygltf::Model &model, int index)
{
    if ((size_t)index >= model.skins.size())
        gltf_fail(MRT_ERR_FORMAT, "a node names skin %d, but the file has %zu", index,
                  model.skins.size());
    const tinygltf::Skin &skin = model.skins[(size_t)index];
    if (skin.joints.empty())
        gltf_fail(MRT_ERR_FORMAT, "skin %d has no joints", index);
    for (int joint : skin.joints)
        if (joint < 0 || (size_t)joint >= model.nodes.size())
            gltf_fail(MRT_ERR_FORMAT, "skin %d names node %d, but the file has %zu", index, joint,
                      model.nodes.size());
    return skin;
}

bool is_shown(const tinygltf::Skin &skin, const std::vector<bool> &is_node_shown)
{
    for (int joint : skin.joints)
        if (!is_node_shown[(size_t)joint])
            return false;
    return true;
}

double size_of(const gltf_transform &t)
{
    return std::fabs(t.shift[0]) + std::fabs(t.shift[1]) + std::fabs(t.shift[2]);
}

bool is_near(const gltf_transform &a, const gltf_transform &b, double shift_tolerance)
{
    const double linear_tolerance = 1e-4;
    for (int row = 0; row < 3; ++row) {
        if (!(std::fabs(a.shift[row] - b.shift[row]) <= shift_tolerance))
            return false;
        for (int column = 0; column < 3; ++column)
            if (!(std::fabs(a.linear[row][column] - b.linear[row][column]) <= linear_tolerance))
                return false;
    }
    return true;
}

void add_scaled(gltf_transform &sum, const gltf_transform &t, double weight)
{
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
            sum.linear[row][column] += weight * t.linear[row][column];
        sum.shift[row] += weight * t.shift[row];
    }
}

} // namespace

gltf_scene gltf_scene_of(const tinygltf::Model &model)
{
    gltf_scene out = {{}, {}, !model.nodes.empty(), 0, 0, 0};
    if (out.has_nodes)
        add_nodes(out, model);
    if (out.repeated_count > 0)
        check_loops(out, model);
    if (!out.has_nodes)
        for (size_t i = 0; i < model.meshes.size(); ++i)
            out.instances.push_back({i, model.meshes[i].name, IDENTITY, 0, false, -1});
    return out;
}

gltf_transform gltf_transform_compose(const gltf_transform &a, const gltf_transform &b)
{
    gltf_transform out;
    for (int column = 0; column < 3; ++column) {
        double image[3];
        multiply(a, b.linear[0][column], b.linear[1][column], b.linear[2][column], image);
        for (int row = 0; row < 3; ++row)
            out.linear[row][column] = image[row];
    }
    multiply(a, b.shift[0], b.shift[1], b.shift[2], out.shift);
    for (int row = 0; row < 3; ++row)
        out.shift[row] += a.shift[row];
    return out;
}

bool gltf_transform_mirrors(const gltf_transform &t)
{
    return determinant(t) < 0.0;
}

bool gltf_transform_is_linear_identity(const gltf_transform &t)
{
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (t.linear[row][column] != IDENTITY.linear[row][column])
                return false;
    return true;
}

void gltf_transform_vectors(const gltf_transform &t, float *vector, size_t count)
{
    for (float *v = vector, *end = vector + count * 3; v < end; v += 3) {
        double image[3];
        multiply(t, (double)v[0], (double)v[1], (double)v[2], image);
        for (int axis = 0; axis < 3; ++axis)
            v[axis] = (float)image[axis];
    }
}

void gltf_transform_points(const gltf_transform &t, float *point, size_t count)
{
    for (float *p = point, *end = point + count * 3; p < end; p += 3) {
        double image[3];
        multiply(t, (double)p[0], (double)p[1], (double)p[2], image);
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = (float)(image[axis] + t.shift[axis]);
    }
}

/* Transforms by the inverse transpose, which is the cofactor matrix over the determinant. The
 * caller normalises the result. */
void gltf_transform_normals(const gltf_transform &t, float *normal, size_t count)
{
    const double(&m)[3][3] = t.linear;
    double sign = gltf_transform_mirrors(t) ? -1.0 : 1.0;
    gltf_transform cofactor = IDENTITY;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3,
                c2 = (column + 2) % 3;
            cofactor.linear[row][column] = sign * (m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]);
        }
    gltf_transform_vectors(cofactor, normal, count);
}

/* ---- skeleton and skins ---- */

gltf_skeleton gltf_skeleton_of(const tinygltf::Model &model, const gltf_scene &scene)
{
    gltf_skeleton out;
    out.ignored_skin_count = 0;
    out.forward = model.extensions.count("VRMC_vrm") ? MESH_AXIS_Z
                  : model.extensions.count("VRM")    ? MESH_AXIS_MINUS_Z
                                                     : MESH_AXIS_AUTO;
    out.joint_of_node.assign(model.nodes.size(), MESH_NO_JOINT);
    out.rides_on.assign(model.nodes.size(), MESH_NO_JOINT);
    std::vector<std::string> role = humanoid_roles(model);
    std::vector<bool> is_node_shown(model.nodes.size(), false), is_joint(model.nodes.size(), false);
    for (const gltf_world_node &placed : scene.nodes)
        is_node_shown[placed.node] = true;
    for (const gltf_instance &instance : scene.instances) {
        if (instance.skin < 0)
            continue;
        const tinygltf::Skin &skin = skin_at(model, instance.skin);
        bool is_usable = is_shown(skin, is_node_shown);
        out.ignored_skin_count += !is_usable;
        for (int joint : skin.joints)
            is_joint[(size_t)joint] = is_joint[(size_t)joint] || is_usable;
    }
    for (const gltf_world_node &placed : scene.nodes) {
        uint32_t above = placed.parent < 0 ? MESH_NO_JOINT : out.rides_on[(size_t)placed.parent];
        out.rides_on[placed.node] = above;
        if (!is_joint[placed.node] && role[placed.node].empty())
            continue;
        uint32_t joint = (uint32_t)out.joints.size();
        out.joints.push_back({placed.node, above, role[placed.node], placed.world});
        out.joint_of_node[placed.node] = out.rides_on[placed.node] = joint;
    }
    return out;
}

gltf_skin::gltf_skin(const tinygltf::Model &model, const gltf_skeleton &skeleton,
                     const gltf_instance &instance)
    : model_(model), skeleton_(skeleton), common_(instance.world), is_rigid_(true),
      rides_on_(MESH_NO_JOINT)
{
    if (instance.has_node)
        rides_on_ = skeleton.rides_on[instance.node];
    if (instance.skin < 0)
        return;
    const tinygltf::Skin &skin = skin_at(model, instance.skin);
    for (int node : skin.joints)
        joint_.push_back(skeleton.joint_of_node[(size_t)node]);
    if (std::count(joint_.begin(), joint_.end(), MESH_NO_JOINT) > 0) {
        joint_.clear(); /* an ignored skin */
        return;
    }
    read_matrices(skin);
    find_common();
}

void gltf_skin::read_matrices(const tinygltf::Skin &skin)
{
    std::vector<float> bind(joint_.size() * 16, 0.0f);
    if (skin.inverseBindMatrices >= 0) {
        gltf_accessor accessor(model_, skin.inverseBindMatrices);
        if (accessor.component_count() != 16 || accessor.count() < joint_.size())
            gltf_fail(MRT_ERR_FORMAT,
                      "accessor %d: the inverse bind matrices must be MAT4, one for each joint",
                      skin.inverseBindMatrices);
        bind.resize(accessor.count() * 16, 0.0f);
        accessor.read_floats(bind.data());
    } else {
        for (size_t i = 0; i < bind.size(); i += 16)
            bind[i] = bind[i + 5] = bind[i + 10] = bind[i + 15] = 1.0f;
    }
    for (size_t i = 0; i < joint_.size(); ++i) {
        const float *m = &bind[i * 16]; /* column-major */
        gltf_transform inverse;
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 3; ++column)
                inverse.linear[row][column] = (double)m[column * 4 + row];
            inverse.shift[row] = (double)m[12 + row];
        }
        matrix_.push_back(gltf_transform_compose(skeleton_.joints[joint_[i]].world, inverse));
    }
}

/* Finds out if the skeleton is in its bind pose. It then moves all vertices equally except for
 * rounding. One common transform is used instead, so that vertices at the same position stay
 * together to the bit. */
void gltf_skin::find_common()
{
    double size = 0.0;
    for (uint32_t joint : joint_)
        size = std::max(size, size_of(skeleton_.joints[joint].world));
    double tolerance = 1e-4 * size;
    is_rigid_ = true;
    for (const gltf_transform &matrix : matrix_)
        is_rigid_ = is_rigid_ && is_near(matrix, matrix_[0], tolerance);
    common_ = matrix_[0];
    if (is_near(common_, GLTF_TRANSFORM_IDENTITY, tolerance))
        common_ = GLTF_TRANSFORM_IDENTITY;
}

void gltf_skin::read_influences(const tinygltf::Primitive &source, size_t count)
{
    std::vector<float> joint, weight;
    width_ = 0;
    influence_.clear();
    for (size_t set = 0; set < INFLUENCE_SETS_MAX && !joint_.empty(); ++set) {
        auto joints = source.attributes.find("JOINTS_" + std::to_string(set));
        auto weights = source.attributes.find("WEIGHTS_" + std::to_string(set));
        if (joints == source.attributes.end() || weights == source.attributes.end())
            break;
        gltf_accessor joint_source(model_, joints->second), weight_source(model_, weights->second);
        if (joint_source.component_count() != 4 || weight_source.component_count() != 4 ||
            joint_source.count() != count || weight_source.count() != count)
            gltf_fail(MRT_ERR_FORMAT,
                      "JOINTS_%zu and WEIGHTS_%zu must be VEC4, one for each vertex", set, set);
        joint.assign(count * 4, 0.0f);
        weight.assign(count * 4, 0.0f);
        joint_source.read_floats(joint.data());
        weight_source.read_floats(weight.data());
        influence_.resize(count * 4 * (set + 1));
        for (size_t v = count; v-- > 0;) { /* backwards: the rows grow in place */
            influence *row = &influence_[v * 4 * (set + 1)];
            for (size_t i = 0; i < 4 * set; ++i)
                row[4 * set - 1 - i] = influence_[v * 4 * set + (4 * set - 1 - i)];
            for (size_t i = 0; i < 4; ++i) {
                float which = joint[v * 4 + i], share = weight[v * 4 + i];
                if (share > 0.0f && !(which >= 0.0f && which < (float)joint_.size()))
                    gltf_fail(MRT_ERR_FORMAT, "vertex %zu follows joint %g, but the skin has %zu",
                              v, (double)which, joint_.size());
                row[4 * set + i] = {share > 0.0f ? (uint32_t)which : 0,
                                    share > 0.0f ? (double)share : 0.0};
            }
        }
        width_ = 4 * (set + 1);
    }
    for (size_t v = 0; v < count && width_ > 0; ++v) {
        influence *row = &influence_[v * width_];
        std::stable_sort(row, row + width_, [](const influence &a, const influence &b) {
            return a.weight > b.weight;
        });
        double sum = 0.0;
        for (size_t i = 0; i < width_; ++i)
            sum += row[i].weight;
        for (size_t i = 0; i < width_ && sum > 0.0; ++i)
            row[i].weight /= sum;
        unweighted_count_ += sum > 0.0 ? 0 : 1;
    }
}

void gltf_skin::read(const tinygltf::Primitive &source, size_t count, uint32_t *joint,
                     float *weight)
{
    read_influences(source, count);
    for (size_t v = 0; v < count; ++v) {
        uint32_t *to = joint + v * MESH_SKIN_WIDTH;
        float *share = weight + v * MESH_SKIN_WIDTH;
        std::fill(to, to + MESH_SKIN_WIDTH, 0u);
        std::fill(share, share + MESH_SKIN_WIDTH, 0.0f);
        if (joint_.empty() && rides_on_ != MESH_NO_JOINT) {
            to[0] = rides_on_;
            share[0] = 1.0f;
        }
        double kept = 0.0;
        for (size_t i = 0; i < width_ && i < MESH_SKIN_WIDTH; ++i)
            kept += influence_[v * width_ + i].weight;
        for (size_t i = 0; i < width_ && i < MESH_SKIN_WIDTH && kept > 0.0; ++i) {
            const influence &from = influence_[v * width_ + i];
            to[i] = joint_[from.joint];
            share[i] = (float)(from.weight / kept);
        }
    }
}

/* Returns the transform of a vertex. Without weights it is that of the first joint of the skin. */
gltf_transform gltf_skin::blend(size_t vertex) const
{
    const influence *row = &influence_[vertex * width_];
    if (!(row[0].weight > 0.0))
        return matrix_[0];
    gltf_transform sum = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {0, 0, 0}};
    for (size_t i = 0; i < width_ && row[i].weight > 0.0; ++i)
        add_scaled(sum, matrix_[row[i].joint], row[i].weight);
    return sum;
}

template <class Apply> void gltf_skin::transform_each(float *value, size_t count, Apply apply) const
{
    if (is_rigid_ || width_ == 0) {
        apply(common_, value, count);
        return;
    }
    for (size_t v = 0; v < count; ++v)
        apply(blend(v), value + v * 3, (size_t)1);
}

void gltf_skin::transform_points(float *point, size_t count) const
{
    transform_each(point, count, gltf_transform_points);
}

void gltf_skin::transform_vectors(float *vector, size_t count) const
{
    if (is_rigid_ && gltf_transform_is_linear_identity(common_))
        return;
    transform_each(vector, count, gltf_transform_vectors);
}

void gltf_skin::transform_normals(float *normal, size_t count) const
{
    transform_each(normal, count, gltf_transform_normals);
}

bool gltf_skin::mirrors() const
{
    return gltf_transform_mirrors(common_);
}

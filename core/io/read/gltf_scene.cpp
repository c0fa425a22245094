#include "io/read/gltf_scene.hpp"

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
        gltf_fail(MRT_ERR_FORMAT, "node %d: its matrix is no affine transform", node);
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
        gltf_fail(MRT_ERR_FORMAT, "%s names node %d, but %zu are there", where, index,
                  model.nodes.size());
}

/* How many parents each node has: at most one, so whatever hangs on a root is a tree. */
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

std::vector<int> find_roots(const tinygltf::Model &model)
{
    std::vector<int> parent_count = count_parents(model), roots;
    if (model.scenes.empty()) {
        for (size_t i = 0; i < parent_count.size(); ++i)
            if (parent_count[i] == 0)
                roots.push_back((int)i);
        return roots;
    }
    size_t scene = model.defaultScene < 0 ? 0 : (size_t)model.defaultScene;
    if (scene >= model.scenes.size())
        gltf_fail(MRT_ERR_FORMAT, "scene %zu is to be shown, but %zu are there", scene,
                  model.scenes.size());
    for (int root : model.scenes[scene].nodes) {
        check_node_index(model, root, "the scene");
        if (++parent_count[(size_t)root] > 1)
            gltf_fail(MRT_ERR_FORMAT, "node %d is in the scene twice, or not a root", root);
        roots.push_back(root);
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
        gltf_fail(MRT_ERR_FORMAT, "a node names mesh %d, but %zu are there", mesh,
                  model.meshes.size());
    return model.meshes[(size_t)mesh].name;
}

void add_nodes(gltf_scene &out, const tinygltf::Model &model)
{
    std::vector<pending_node> stack;
    push_reversed(stack, find_roots(model), -1, IDENTITY);
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
        }
        push_reversed(stack, node.children, next.index, world);
    }
}

double determinant(const gltf_transform &t)
{
    const double(&m)[3][3] = t.linear;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

} // namespace

gltf_scene gltf_scene_of(const tinygltf::Model &model)
{
    gltf_scene out = {{}, {}, !model.nodes.empty()};
    if (out.has_nodes)
        add_nodes(out, model);
    else
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

/* By the inverse transpose, which is the cofactor matrix over the determinant; the length is left
 * to the caller. */
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

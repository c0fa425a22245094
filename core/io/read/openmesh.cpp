/* OpenMesh is C++: this is its only user. */
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

extern "C" {
#include "io/read/mesh_build.h"
#include "io/openmesh.h"
}

namespace
{

typedef OpenMesh::TriMesh_ArrayKernelT<> half_edges;
typedef OpenMesh::PolyMesh_ArrayKernelT<> polygons;

/* Turns off OpenMesh's messages about refused faces on std::cerr, for all threads.
 */
void silence()
{
    static const bool is_silent = (omerr().disable(), true);
    (void)is_silent;
}

/* Returns a copy that topology_destroy frees. */
template <class T> T *copied(const std::vector<T> &from)
{
    T *out = static_cast<T *>(malloc((from.size() + 1) * sizeof(T)));
    if (!out)
        throw std::bad_alloc();
    std::copy(from.begin(), from.end(), out);
    return out;
}

uint32_t index_of(const OpenMesh::BaseHandle &handle)
{
    return (uint32_t)handle.idx();
}

/* Adds all vertices, and the faces that a manifold can have. Returns the other faces. */
std::vector<uint32_t> build(half_edges &out, const mesh &m)
{
    std::vector<uint32_t> rejected;
    /* At a border there is one more edge for every two triangles. */
    out.reserve(m.vertex_count, (size_t)m.triangle_count * 13 / 8 + 64, m.triangle_count);
    for (size_t v = 0; v < m.vertex_count; ++v) {
        const float *p = m.position + v * 3;
        out.add_vertex(half_edges::Point(p[0], p[1], p[2]));
    }
    for (uint32_t t = 0; t < m.triangle_count; ++t) {
        uint32_t corner[3];
        for (size_t i = 0; i < 3; ++i)
            corner[i] = mesh_point(&m, m.triangle[(size_t)t * 3 + i]);
        bool degenerate =
            corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0];
        if (degenerate || !out.add_face(OpenMesh::VertexHandle((int)corner[0]),
                                        OpenMesh::VertexHandle((int)corner[1]),
                                        OpenMesh::VertexHandle((int)corner[2]))
                               .is_valid())
            rejected.push_back(t);
    }
    return rejected;
}

/* Writes the neighbours of each vertex, ascending. */
void write_neighbours(topology &out, const half_edges &mesh)
{
    std::vector<uint32_t> start(mesh.n_vertices() + 1, 0), next, neighbour(mesh.n_halfedges());
    for (auto he : mesh.halfedges())
        start[index_of(mesh.from_vertex_handle(he)) + 1] += 1;
    for (size_t v = 0; v < mesh.n_vertices(); ++v)
        start[v + 1] += start[v];
    next.assign(start.begin(), start.end() - 1);
    for (auto he : mesh.halfedges())
        neighbour[next[index_of(mesh.from_vertex_handle(he))]++] =
            index_of(mesh.to_vertex_handle(he));
    for (size_t v = 0; v < mesh.n_vertices(); ++v)
        std::sort(neighbour.begin() + start[v], neighbour.begin() + start[v + 1]);
    out.neighbour_start = copied(start);
    out.neighbour = copied(neighbour);
}

void write_borders(topology &out, const half_edges &mesh)
{
    std::vector<uint8_t> on_border(mesh.n_vertices(), 0);
    std::vector<uint32_t> loop_start(1, 0), loop_vertex;
    std::vector<bool> seen(mesh.n_halfedges(), false);
    for (auto first : mesh.halfedges()) {
        OpenMesh::HalfedgeHandle he = first;
        if (!mesh.is_boundary(he) || seen[index_of(he)])
            continue;
        for (; !seen[index_of(he)]; he = mesh.next_halfedge_handle(he)) {
            uint32_t vertex = index_of(mesh.from_vertex_handle(he));
            seen[index_of(he)] = true;
            on_border[vertex] = 1;
            loop_vertex.push_back(vertex);
        }
        loop_start.push_back((uint32_t)loop_vertex.size());
    }
    out.on_border = copied(on_border);
    out.border_vertex = copied(loop_vertex);
    out.border_loop_count = (uint32_t)loop_start.size() - 1;
    out.border_loop_start = copied(loop_start);
}

void count_components(topology &out)
{
    std::vector<bool> seen(out.vertex_count, false);
    std::vector<uint32_t> pending;
    for (uint32_t first = 0; first < out.vertex_count; ++first) {
        if (out.neighbour_start[first] == out.neighbour_start[first + 1]) {
            out.isolated_vertex_count += 1;
            continue;
        }
        if (seen[first])
            continue;
        out.component_count += 1;
        seen[first] = true;
        pending.push_back(first);
        while (!pending.empty()) {
            uint32_t v = pending.back();
            pending.pop_back();
            for (uint32_t i = out.neighbour_start[v]; i < out.neighbour_start[v + 1]; ++i)
                if (!seen[out.neighbour[i]]) {
                    seen[out.neighbour[i]] = true;
                    pending.push_back(out.neighbour[i]);
                }
        }
    }
}

void write_topology(topology &out, const mesh &m)
{
    half_edges half_edge_mesh;
    std::vector<uint32_t> rejected = build(half_edge_mesh, m);
    if (half_edge_mesh.n_vertices() != m.vertex_count)
        throw std::logic_error("the half-edge mesh has another number of vertices");
    out.vertex_count = m.vertex_count;
    out.rejected_count = (uint32_t)rejected.size();
    out.rejected_triangle = copied(rejected);
    write_neighbours(out, half_edge_mesh);
    write_borders(out, half_edge_mesh);
    count_components(out);
}

/* Collects the unchanged data of the readers. OpenMesh's own importer would duplicate the vertices
 * of faces that a manifold cannot have. Vertices are added to a mesh. So are the half-edges of .om
 * files, which have no lists of corners. */
class collector : public OpenMesh::IO::ImporterT<polygons>
{
  public:
    explicit collector(polygons &into) : OpenMesh::IO::ImporterT<polygons>(into), mesh_(into)
    {
    }

    using OpenMesh::IO::ImporterT<polygons>::add_face;

    OpenMesh::FaceHandle add_face(const VHandles &corners) override
    {
        for (const OpenMesh::VertexHandle &corner : corners)
            corners_.push_back(corner.idx());
        face_end_.push_back(corners_.size());
        return OpenMesh::FaceHandle((int)face_end_.size() - 1);
    }

    size_t n_faces() const override
    {
        return face_end_.size() + mesh_.n_faces();
    }

    mrt_result build(mesh_build &out, error &failed)
    {
        std::vector<OpenMesh::VertexHandle> corners;
        for (auto face : mesh_.faces()) {
            corners.clear();
            for (auto corner : mesh_.fv_range(face))
                corners.push_back(corner);
            (void)add_face(corners);
        }
        mrt_result result = MRT_OK;
        for (size_t v = 0; result == MRT_OK && v < mesh_.n_vertices(); ++v) {
            const polygons::Point &p = mesh_.point(OpenMesh::VertexHandle((int)v));
            const float position[3] = {p[0], p[1], p[2]};
            result = mesh_build_vertex(&out, position, &failed);
        }
        for (size_t face = 0, corner = 0; result == MRT_OK && face < face_end_.size(); ++face) {
            for (; result == MRT_OK && corner < face_end_[face]; ++corner)
                result = mesh_build_corner(&out, corners_[corner], &failed);
            if (result == MRT_OK)
                result = mesh_build_face(&out, &failed);
        }
        return result;
    }

  private:
    polygons &mesh_;
    std::vector<int> corners_;     /* corners of all faces */
    std::vector<size_t> face_end_; /* end of each face in corners_ */
};

mrt_result read_with_openmesh(mesh &out, const char *path, mesh_build &build, error &failed)
{
    polygons points;
    collector importer(points);
    OpenMesh::IO::Options options;
    if (!OpenMesh::IO::IOManager().read(path, importer, options))
        return error_set(&failed, MRT_ERR_FORMAT, "OpenMesh cannot read it");
    mrt_result result = importer.build(build, failed);
    if (result == MRT_OK)
        result = mesh_build_take(&build, &out, &failed);
    if (result == MRT_OK)
        result = mesh_validate(&out, &failed);
    return result;
}

/* Runs `work` so that no exception leaves it. */
template <class Work> mrt_result guarded(error *err, Work work)
{
    silence();
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return error_set(err, MRT_ERR_MEMORY, "no memory for the mesh");
    } catch (const std::exception &caught) {
        return error_set(err, MRT_ERR_FORMAT, "OpenMesh: %s", caught.what());
    } catch (...) {
        return error_set(err, MRT_ERR_FORMAT, "OpenMesh failed");
    }
}

} // namespace

mrt_result openmesh_topology(topology *out, const mesh *m, error *err)
{
    *out = topology{};
    mrt_result result = guarded(err, [&] {
        write_topology(*out, *m);
        return (mrt_result)MRT_OK;
    });
    if (result < 0)
        topology_destroy(out);
    return result;
}

mrt_result openmesh_read_unsafe(mesh *out, const char *path, error *err)
{
    mesh_build build;
    error failed = {""};
    *out = mesh{};
    mesh_build_init(&build);
    mrt_result result =
        guarded(&failed, [&] { return read_with_openmesh(*out, path, build, failed); });
    mesh_build_finish(&build);
    if (result < 0) {
        mesh_destroy(out);
        return error_set(err, result, "%s", failed.text);
    }
    return result;
}

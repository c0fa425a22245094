/* io/read/gltf_scene.hpp - the meshes of a glTF scene and their positions: flattened nodes, the
 * skeleton, and the skins that bind meshes to it. VRM's humanoid map gives the roles of the joints.
 * Leaves out animation. Private to the glTF reader and writer; failures are gltf_failure. */
#ifndef MAROTTE_IO_GLTF_SCENE_HPP
#define MAROTTE_IO_GLTF_SCENE_HPP
#include "io/read/gltf_accessor.hpp"

extern "C" {
#include "mesh/mesh.h"
}

#include <vector>

struct gltf_transform {  /* x -> linear x + shift */
    double linear[3][3]; /* rows */
    double shift[3];
};

extern const gltf_transform GLTF_TRANSFORM_IDENTITY;

struct gltf_instance {
    size_t mesh;
    std::string name; /* name of the node, else of the mesh */
    gltf_transform world;
    size_t node; /* index in the model, if has_node */
    bool has_node;
    int skin; /* -1: none */
};

struct gltf_world_node {
    size_t node;
    int parent; /* node; -1: a root */
    gltf_transform world;
};

struct gltf_scene {
    std::vector<gltf_instance> instances; /* in the order of the nodes */
    std::vector<gltf_world_node> nodes;   /* parents first */
    bool has_nodes;                       /* false: each mesh appears once, without a transform */
    size_t repeated_count;  /* entries of the scene that its other nodes already contain */
    size_t orphan_count;    /* nodes of the scene with a parent outside it */
    size_t instanced_count; /* nodes with instances, which are left out */
};

gltf_scene gltf_scene_of(const tinygltf::Model &model);

/* Returns the transform that applies b, then a. */
gltf_transform gltf_transform_compose(const gltf_transform &a, const gltf_transform &b);
bool gltf_transform_mirrors(const gltf_transform &t);
bool gltf_transform_is_linear_identity(const gltf_transform &t);
/* Transform `count` by 3 values in place: points, vectors such as offsets, or directions of
 * normals. */
void gltf_transform_points(const gltf_transform &t, float *point, size_t count);
void gltf_transform_vectors(const gltf_transform &t, float *vector, size_t count);
void gltf_transform_normals(const gltf_transform &t, float *normal, size_t count);

/* ---- skeleton and skins ---- */

struct gltf_joint {
    size_t node;
    uint32_t parent; /* among the joints; MESH_NO_JOINT: none */
    std::string role;
    gltf_transform world;
};

struct gltf_skeleton {
    std::vector<gltf_joint> joints;      /* nodes that a shown skin or the humanoid map names */
    std::vector<uint32_t> joint_of_node; /* MESH_NO_JOINT: the node is not a joint */
    std::vector<uint32_t>
        rides_on;              /* for each node: itself or its nearest ancestor that is a joint */
    size_t ignored_skin_count; /* number of skins with joints outside the scene */
    mesh_axis forward;         /* VRM 0: -z, VRM 1: +z; else MESH_AXIS_AUTO */
};

gltf_skeleton gltf_skeleton_of(const tinygltf::Model &model, const gltf_scene &scene);

/* The skin of one primitive: the joints of each vertex, and the transform that they give. */
class gltf_skin
{
  public:
    /* `instance` belongs to `scene`. Without a usable skin it follows a joint or does not move.
     */
    gltf_skin(const tinygltf::Model &model, const gltf_skeleton &skeleton,
              const gltf_instance &instance);

    /* Reads JOINTS_n and WEIGHTS_n: count by MESH_SKIN_WIDTH. */
    void read(const tinygltf::Primitive &source, size_t count, uint32_t *joint, float *weight);

    /* Transforms `count` by 3 values in place, for the vertices of the last read(). */
    void transform_points(float *point, size_t count) const;
    void transform_vectors(float *vector, size_t count) const;
    void transform_normals(float *normal, size_t count) const;
    bool mirrors() const;
    size_t unweighted_count() const
    {
        return unweighted_count_;
    }

  private:
    void read_matrices(const tinygltf::Skin &skin);
    void find_common();
    void read_influences(const tinygltf::Primitive &source, size_t count);
    gltf_transform blend(size_t vertex) const;
    template <class Apply> void transform_each(float *value, size_t count, Apply apply) const;

    struct influence {
        uint32_t joint; /* of the skin */
        double weight;
    };

    const tinygltf::Model &model_;
    const gltf_skeleton &skeleton_;
    std::vector<uint32_t> joint_; /* index in the skeleton, for each joint of the skin */
    std::vector<gltf_transform>
        matrix_;            /* for each joint of the skin: from file coordinates to rest */
    gltf_transform common_; /* transform of all vertices if is_rigid_ */
    bool is_rigid_;         /* the skin is in its bind pose, or is missing */
    uint32_t rides_on_;
    size_t width_ = 0; /* influences of a vertex */
    std::vector<influence> influence_;
    size_t unweighted_count_ = 0;
};

#endif

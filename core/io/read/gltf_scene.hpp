/* io/gltf_scene.hpp - which meshes a glTF scene shows, and where: the nodes flattened. Private to
 * the glTF reader; failures are gltf_failure. */
#ifndef MAROTTE_IO_GLTF_SCENE_HPP
#define MAROTTE_IO_GLTF_SCENE_HPP
#include "io/read/gltf_load.hpp"

#include <vector>

struct gltf_transform {  /* x -> linear x + shift */
    double linear[3][3]; /* rows */
    double shift[3];
};

extern const gltf_transform GLTF_TRANSFORM_IDENTITY;

struct gltf_instance {
    size_t mesh;
    std::string name; /* of the node, else of the mesh */
    gltf_transform world;
    size_t node; /* has_node: of the model */
    bool has_node;
    int skin; /* -1: none */
};

struct gltf_placed_node {
    size_t node;
    int parent; /* node; -1: a root */
    gltf_transform world;
};

struct gltf_scene {
    std::vector<gltf_instance> instances; /* in the order of the nodes */
    std::vector<gltf_placed_node> nodes;  /* parents first */
    bool has_nodes;                       /* false: every mesh once, as it is */
};

gltf_scene gltf_scene_of(const tinygltf::Model &model);

/* First b, then a. */
gltf_transform gltf_transform_compose(const gltf_transform &a, const gltf_transform &b);
bool gltf_transform_mirrors(const gltf_transform &t);
bool gltf_transform_is_linear_identity(const gltf_transform &t);
/* In place, `count` by 3: points; vectors such as offsets; directions of normals. */
void gltf_transform_points(const gltf_transform &t, float *point, size_t count);
void gltf_transform_vectors(const gltf_transform &t, float *vector, size_t count);
void gltf_transform_normals(const gltf_transform &t, float *normal, size_t count);

#endif

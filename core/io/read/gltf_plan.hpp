/* io/read/gltf_plan.hpp - plans one mesh from a glTF scene: its vertices, triangles, morph targets
 * and attributes, and their memory, before any of them is read. Private to the glTF reader;
 * failures are gltf_failure. */
#ifndef MAROTTE_IO_GLTF_PLAN_HPP
#define MAROTTE_IO_GLTF_PLAN_HPP
#include "io/read/gltf_scene.hpp"

#include <map>

struct gltf_group_plan { /* vertices that are shared by primitives of one mesh */
    const tinygltf::Primitive *source;
    size_t first_vertex, vertex_count; /* within the mesh */
};

struct gltf_primitive_plan { /* a primitive with triangles */
    const tinygltf::Primitive *source;
    size_t group, triangle_count;
};

struct gltf_mesh_plan {
    std::vector<gltf_group_plan> groups;
    std::vector<gltf_primitive_plan> surfaces;
    std::vector<size_t> target_slots; /* index of each of its targets in gltf_plan.targets */
    size_t vertex_count, triangle_count;
};

struct gltf_attribute_plan {
    std::string name;
    size_t component_count;
};

struct gltf_plan {
    gltf_scene scene;
    gltf_skeleton skeleton;
    std::map<size_t, gltf_mesh_plan> meshes; /* meshes that the scene shows */
    std::vector<std::string> targets;
    std::vector<gltf_attribute_plan> attributes;
    size_t vertex_count, triangle_count, part_count; /* of all instances */
    size_t skipped_count;                            /* primitives of points or lines */
    std::vector<bool> is_material_used;
    bool has_normals, has_uv, has_colours, needs_default_material;
};

/* `file_size` limits the memory of the plan. */
gltf_plan gltf_plan_of(const tinygltf::Model &model, size_t file_size);

/* Returns the accessor of the texture coordinates of the primitive; -1: none. */
int gltf_uv_accessor(const tinygltf::Model &model, const tinygltf::Primitive &primitive);
/* Returns the accessor of its vertex colours; -1: none. */
int gltf_colour_accessor(const tinygltf::Primitive &primitive);

bool gltf_is_custom(const std::string &attribute); /* "_NAME" */
/* Returns the index of a custom attribute, or -1 if its type differs from the plan. */
int gltf_plan_attribute(const gltf_plan &plan, const std::string &name, size_t component_count);

#endif

/* io/write/gltf_source.hpp - adds morph targets and an animation to the glTF or VRM file that a
 * face was read from. Nodes, names, skins, materials, images, extensions and its own targets are
 * unchanged. The output is always one .glb. Private to the glTF writer; failures are gltf_failure.
 * */
#ifndef MAROTTE_IO_GLTF_SOURCE_HPP
#define MAROTTE_IO_GLTF_SOURCE_HPP
#include "io/read/gltf_plan.hpp"
#include "io/write/gltf_surface.hpp"

extern "C" {
#include "base/budget.h"
}

#include <map>

#include <nlohmann/json.hpp>

class gltf_source
{
  public:
    /* Fails if the file cannot be read or copied completely (gltf_source_check.hpp), or if it
     * differs from `m`. It may have changed since, or `m` may be only a part of it. */
    gltf_source(const char *path, const mesh *m);

    /* offset, rotation: V by 3, of the mesh: metres and change of normal per unit of weight. Only
     * the meshes of the file that they move get the target. */
    void add_target(const std::string &name, const float *offset, const float *rotation);
    /* Uses the file's own target of that name instead of adding one. It gets the weights of the
     * next target. Returns false and adds nothing if no mesh has that target. */
    bool add_own_target(const std::string &name);
    /* weight: time_s.size() by the number of added targets. The file's own animations are kept,
     * after this one. */
    void animate(const std::string &name, const std::vector<float> &time_s,
                 const std::vector<float> &weight, const nlohmann::ordered_json &extras,
                 const std::vector<gltf_bone> &bones);
    uint64_t write(const char *path);

  private:
    struct group {           /* vertices shared by primitives of an instance */
        size_t first, count; /* in the mesh */
        /* For each vertex: transform of vectors from the mesh to the file. */
        std::vector<gltf_transform> back;
        bool has_normals;
    };
    struct instance {      /* a node that shows a mesh */
        size_t mesh, node; /* of the document */
        bool has_node;
        std::vector<group> groups;
        std::vector<int> group_of;   /* by primitive; -1: points or lines */
        std::vector<size_t> targets; /* indices of the added targets that move it */
        size_t own_count;            /* number of its targets in the file */
        nlohmann::ordered_json own_weights;
        std::map<size_t, size_t> played; /* added target that plays each of its own targets */
    };

    bool is_copied(size_t buffer, const gltf_container &container) const;
    std::vector<size_t> buffer_sizes(const tinygltf::Model &model,
                                     const gltf_container &container) const;
    void join_buffers(const tinygltf::Model &model, const gltf_container &container);
    void embed_images(const std::string &directory);
    std::pair<int, const char *> embed_image(const std::string &directory, const std::string &path);
    void copy_mesh(instance &of);
    void read_instances(const tinygltf::Model &model, const gltf_plan &plan, const mesh *m);
    void place_group(group &out, const tinygltf::Model &model, const gltf_group_plan &plan,
                     gltf_skin &skin, const mesh *m);
    int zeros(size_t count);
    void add_to(instance &to, const std::string &name, const std::vector<float> &offset,
                const std::vector<float> &rotation);
    void add_bones(nlohmann::ordered_json &animation, int time,
                   const std::vector<gltf_bone> &bones);
    void finish_meshes();
    void write_new_accessors();

    nlohmann::ordered_json document_;
    gltf_output out_;
    std::vector<instance> instances_;
    std::vector<size_t> vertex_counts_; /* of each accessor in the file */
    std::map<size_t, int> zeros_;
    gltf_transform file_of_face_;
    budget copies_; /* memory for copies of meshes */
    size_t target_count_ = 0, first_view_ = 0, first_accessor_ = 0;
};

#endif

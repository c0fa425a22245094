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
    /* Fails when the file cannot be read or carried over whole (gltf_source_check.hpp), or when `m`
     * is not what it shows: it has changed since, or the face has been cut out of it. */
    gltf_source(const char *path, const mesh *m);

    /* offset, turn: V by 3, of the mesh: metres and change of normal per unit of weight. What they
     * move gets the target; other meshes of the file do not. */
    void add_target(const std::string &name, const float *offset, const float *rotation);
    /* The file's own target of that name is played with the weights of the target that would be
     * added now; false: no mesh has it, and nothing is added. */
    bool add_own_target(const std::string &name);
    /* weight: time_s.size() by the number of targets added. The file's own animations stay, behind
     * this one. */
    void animate(const std::string &name, const std::vector<float> &time_s,
                 const std::vector<float> &weight, const nlohmann::ordered_json &extras,
                 const std::vector<gltf_bone> &bones);
    uint64_t write(const char *path);

  private:
    struct group {           /* vertices that primitives of an instance share */
        size_t first, count; /* in the mesh */
        /* Of each vertex: vectors of the mesh's frame to the file's. */
        std::vector<gltf_transform> back;
        bool has_normals;
    };
    struct instance {      /* a node that shows a mesh */
        size_t mesh, node; /* of the document */
        bool has_node;
        std::vector<group> groups;
        std::vector<int> group_of;   /* by primitive; -1: points or lines */
        std::vector<size_t> targets; /* which of those that were added move it */
        size_t own_count;            /* of targets in the file */
        nlohmann::ordered_json own_weights;
        std::map<size_t, size_t> played; /* of its own, with which of those that were added */
    };

    bool travels(size_t buffer, const gltf_container &container) const;
    std::vector<size_t> buffer_sizes(const tinygltf::Model &model,
                                     const gltf_container &container) const;
    void take_buffers(const tinygltf::Model &model, const gltf_container &container);
    void take_images(const std::string &directory);
    std::pair<int, const char *> take_image(const std::string &directory, const std::string &path);
    void copy_mesh(instance &of);
    void take_instances(const tinygltf::Model &model, const gltf_plan &plan, const mesh *m);
    void place_group(group &out, const tinygltf::Model &model, const gltf_group_plan &plan,
                     gltf_skin &skin, const mesh *m);
    int zeros(size_t count);
    void add_to(instance &to, const std::string &name, const std::vector<float> &offset,
                const std::vector<float> &rotation);
    void add_bones(nlohmann::ordered_json &animation, int time,
                   const std::vector<gltf_bone> &bones);
    void finish_meshes();
    void put_new_accessors();

    nlohmann::ordered_json document_;
    gltf_output out_;
    std::vector<instance> instances_;
    std::vector<size_t> vertex_counts_; /* of accessors in the file */
    std::map<size_t, int> zeros_;
    gltf_transform file_of_face_;
    budget copies_; /* what copies of meshes may take */
    size_t target_count_ = 0, first_view_ = 0, first_accessor_ = 0;
};

#endif

/* io/write/gltf_surface.hpp - a mesh and its morph targets as glTF: metres, one primitive per part,
 * all on the same vertices in the file's order, and the bones of a clip as rotating nodes. Private
 * to the writers of glTF; failures are gltf_failure. */
#ifndef MAROTTE_IO_GLTF_SURFACE_HPP
#define MAROTTE_IO_GLTF_SURFACE_HPP
#include "io/write/gltf_output.hpp"

extern "C" {
#include "io/clip.h"
#include "mesh/mesh.h"
}

#include <map>

constexpr double GLTF_METRES_PER_MM = 0.001;

struct gltf_target {
    std::string name;
    int position = -1, normal = -1; /* accessors; -1: no normals */
};

struct gltf_surface {
    const mesh *source;
    std::vector<float> position, normal; /* as written: V by 3; metres, unit vectors */
    std::vector<double> area;            /* morph_area of position */
    std::map<std::string, int> attribute;
    std::vector<gltf_target> target;
    std::vector<double> work;         /* V by 3: scratch */
    std::vector<float> normal_offset; /* V by 3: scratch */
};

/* Checks the mesh and prepares it. */
gltf_surface gltf_surface_of(const mesh *m);
/* Computes in s.normal_offset the change of the normals for an offset, to first order. offset: V by
 * 3, metres per unit of weight, finite. `name` is used in the error. */
void gltf_surface_bend_normals(gltf_surface &s, const std::string &name, const float *offset);
/* The first function adds the materials and attributes of the mesh. The second adds one target with
 * the normals of s.normal_offset. */
void gltf_surface_begin(gltf_output &out, gltf_surface &s);
void gltf_surface_target(gltf_output &out, gltf_surface &s, const std::string &name,
                         const float *offset);
/* Call after all targets are added. Adds mesh 0 on node 0. */
void gltf_surface_scene(gltf_output &out, const gltf_surface &s);

std::vector<float> gltf_in_metres(const float *value_mm, size_t count);

/* Positions and rotations of a bone relative to its parent. */
struct gltf_bone {
    std::string name;
    size_t parent;                  /* SIZE_MAX: none */
    double rest_m[3];               /* centre relative to that of the parent */
    std::vector<float> translation; /* 3 per frame, metres */
    std::vector<float> rotation;    /* 4 per frame, quaternion x y z w */
};

/* Returns the bones, parents first. Frames without a pose have the rest pose. */
std::vector<gltf_bone> gltf_bones_of(const clip *c);

#endif

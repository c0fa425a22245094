/* io/gltf_bones.hpp - the bones of a clip as nodes that turn: places and turns of each against its
 * parent's. Private to the writers of glTF. */
#ifndef MAROTTE_IO_GLTF_BONES_HPP
#define MAROTTE_IO_GLTF_BONES_HPP
extern "C" {
#include "io/clip.h"
}

#include <string>
#include <vector>

struct gltf_bone {
    std::string name;
    size_t parent;    /* SIZE_MAX: none */
    double rest_m[3]; /* its centre, from the parent's */
    std::vector<float> translation,
        rotation; /* of each frame: 3, metres; 4, a quaternion x y z w */
};

/* Parents first; of frames without a pose: as at rest. */
std::vector<gltf_bone> gltf_bones_of(const clip *c);

#endif

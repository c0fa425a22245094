/* io/gltf_expression.hpp - VRM's expressions: which morph targets, and how much of each, show what
 * its standard calls so. VRM 0's blendShapeMaster and VRM 1's VRMC_vrm.expressions, in VRM 1's
 * words. Leaves out what they do to materials. Private to the glTF reader. */
#ifndef MAROTTE_IO_GLTF_EXPRESSION_HPP
#define MAROTTE_IO_GLTF_EXPRESSION_HPP
#include "io/read/gltf_plan.hpp"

struct gltf_expressions {
    std::map<std::pair<std::string, size_t>, float> weight; /* of a word and a target of the plan */
    size_t lost_count; /* shapes that they name, and that are not there */
};

gltf_expressions gltf_expressions_of(const tinygltf::Model &model, const gltf_plan &plan);

#endif
